"""The event log: what happened, as steps without decisions, and which of them a number rests on.

Given the scene and the log, every number of a run can be computed again: to more bits, in nested square roots.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple, TypeAlias

from ...scenarios.numbers.quantity import Quantity
from ...scenarios.scene import Scene

Link: TypeAlias = tuple[int, int]
"""A contact by index: two circles (0 <= i < j < n), or circle i and wall j - n (j >= n).

With j < 0 it stands for the centre of circle i entering pocket -1 - j: no contact, but reckoned like one."""


class Go(NamedTuple):
    """Advance `bodies` to one instant.

    The instant is the hit time of `source` if that is a Link, the clock of a body if it is an int, the constant
    itself if it is a Quantity.
    """

    source: Link | int | Quantity
    bodies: tuple[int, ...]


class Kick(NamedTuple):
    """Apply, together, the impulses that make each of these contacts separate as fast as it approached.

    Attributes:
        links: the contacts that push.
        among: the contacts whose law this is: all that approach in a round of the policy `simultaneous`, of which
            `links` push; the contact alone where an order was chosen. The velocities that come out depend on the
            state and on `among` alone, so symmetric instants have symmetric `among`, whatever set of contacts was
            found to push.
    """

    links: tuple[Link, ...]
    among: tuple[Link, ...]


class Flip(NamedTuple):
    """Negate every velocity; all bodies stand at one instant."""


class Take(NamedTuple):
    """Take a body out of play: it rests where it is, and nothing meets it."""

    body: int


Step: TypeAlias = Go | Kick | Flip | Take


def causal_past(steps: Sequence[Step], bodies: Iterable[int], n: int) -> tuple[list[int], list[int]]:
    """The steps on which the states of some bodies depend, in order, and all bodies in them.

    Args:
        steps: the log.
        bodies: indices of the circles asked about.
        n: number of circles; greater indices in contacts are walls.
    """
    wanted = set(bodies)
    needed: list[int] = []
    for k in range(len(steps) - 1, -1, -1):
        step = steps[k]
        if isinstance(step, Go):
            touched = set(step.bodies)
            if wanted & touched:
                needed.append(k)
                if isinstance(step.source, tuple):
                    wanted.update(i for i in step.source if 0 <= i < n)
                elif isinstance(step.source, int) and not isinstance(step.source, Quantity):
                    wanted.add(step.source)
        elif isinstance(step, Kick):
            touched = {i for link in step.links for i in link if i < n}
            if wanted & touched:
                needed.append(k)
                wanted |= touched
        elif isinstance(step, Take):
            if step.body in wanted:
                needed.append(k)
        else:
            needed.append(k)
    needed.reverse()
    return needed, sorted(wanted)


def name_of(scene: Scene, link: Link) -> str:
    """A contact as a person reads it.

    >>> from truebreak.scenarios import Circle, Scene
    >>> name_of(Scene([Circle(0, 0, id="a"), Circle(4, 0, id="b")]), (0, 1))
    'a and b'
    """
    ids = scene.ids
    other = ids[link[1]] if link[1] >= 0 else f"pocket {scene.pockets[-1 - link[1]].id}"
    return f"{ids[link[0]]} and {other}"
