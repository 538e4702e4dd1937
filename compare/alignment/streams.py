"""Whom each body meets, in order: the form in which two histories are compared."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from ...scenarios.scene import Scene
    from ...scenarios.trajectory import Trajectory


class Meeting(NamedTuple):
    """The partners that one body meets at one instant, once for each impulse between them.

    Attributes:
        event: index of the event.
        partners: ids in the order of the impulses; a partner comes twice if two rounds of impulses passed.
    """

    event: int
    partners: tuple[str, ...]


@dataclass(frozen=True)
class Streams:
    """A trajectory seen body by body.

    Attributes:
        meetings: for each body that can move, its meetings in order. Walls and fixed circles are met, but
            have no history of their own: two balls that bounce off the same wall do not influence each other.
        times: the time of each event as a double.
    """

    meetings: dict[str, list[Meeting]]
    times: tuple[float, ...]


def bodies(scene: Scene) -> tuple[str, ...]:
    """Ids of the circles that can move, in scene order."""
    return tuple(str(circle.id) for circle in scene.circles if not circle.fixed)


def history(trajectory: Trajectory) -> Streams:
    """The meetings of every body, from the impulses of every event, in one pass.

    >>> from fractions import Fraction
    >>> from truebreak.scenarios import Contact, Event
    >>> from types import SimpleNamespace
    >>> from truebreak.scenarios import Circle, Scene, Wall
    >>> scene = Scene([Circle(0, 0, id="a"), Circle(3, 0, id="b")], [Wall(9, 0, 9, 1, id="w")])
    >>> ab, bw = Contact("a", "b"), Contact("b", "w")
    >>> events = (Event(0, 1.0, (ab,), (ab,)), Event(1, 2.0, (bw,), (bw,)))
    >>> history(SimpleNamespace(scene=scene, events=events)).meetings["b"]
    [Meeting(event=0, partners=('a',)), Meeting(event=1, partners=('w',))]
    """
    meetings: dict[str, list[Meeting]] = {name: [] for name in bodies(trajectory.scene)}
    for index, event in enumerate(trajectory.events):
        if len(event.impulses) == 1:
            first, second = event.impulses[0]
            if first in meetings:
                meetings[first].append(Meeting(index, (second,)))
            if second in meetings:
                meetings[second].append(Meeting(index, (first,)))
            continue
        met: dict[str, list[str]] = {}
        for first, second in event.impulses:
            if first in meetings:
                met.setdefault(first, []).append(second)
            if second in meetings:
                met.setdefault(second, []).append(first)
        for body, partners in met.items():
            meetings[body].append(Meeting(index, tuple(partners)))
    return Streams(meetings, tuple(float(event.time) for event in trajectory.events))
