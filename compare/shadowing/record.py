"""An engine's run as it tells it: the contacts in order, and where each circle is between them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from ..tangent.impacts import NoTangentMap, check_start, moving

if TYPE_CHECKING:
    from ...scenarios.trajectory import Trajectory

Indices = tuple[int, int]
"""A contact by index: two circles, or circle i and wall j - n, n the number of circles."""

DoubleFlight = tuple[float, float, float, float, float]
"""(t, x, y, vx, vy): from time t on a circle flies straight from (x, y) at (vx, vy)."""


@dataclass(frozen=True)
class Record:
    """The first events of a run in doubles.

    Attributes:
        links: the contacts, one after the other; those of one instant in the order of their impulses.
        events: for each contact the event that it belongs to.
        times: for each contact its time.
        flights: for each circle that can move, by its index, how it flew at the start and after each of its contacts.
    """

    links: tuple[Indices, ...]
    events: tuple[int, ...]
    times: tuple[float, ...]
    flights: dict[int, tuple[DoubleFlight, ...]]


def recorded(trajectory: Trajectory, events: int) -> Record:
    """The first events of a run.

    Raises:
        NoTangentMap: where nearby runs are not its image under a smooth map: circles that touch from the start on or
            go out of play, a reversal, and a circle that has several contacts at one instant.

    >>> from truebreak.floating import DoubleEngine
    >>> from truebreak.scenarios import Circle, Scene
    >>> told = recorded(DoubleEngine().run(Scene([Circle(0, 0, vx=1), Circle(4, 0)])), 1)
    >>> told.links, told.times, told.flights[1]
    (((0, 1),), (2.0,), ((0.0, 4.0, 0.0, 0.0, 0.0), (2.0, 4.0, 0.0, 1.0, 0.0)))
    """
    scene = trajectory.scene
    check_start(scene)
    if trajectory.reversal is not None and trajectory.reversal.after < events:
        raise NoTangentMap(f"the run turns back after {trajectory.reversal.after} events", trajectory.reversal.after)
    place = {name: k for k, name in enumerate(scene.ids)}
    flights: dict[int, list[DoubleFlight]] = {}
    for i in moving(scene):
        c = scene.circles[i]
        flights[i] = [(0.0, float(c.x), float(c.y), float(c.vx), float(c.vy))]
    links: list[Indices] = []
    owners: list[int] = []
    times: list[float] = []
    for event in trajectory.events[:events]:
        mine = [(place[first], place[second]) for first, second in event.impulses]
        met = [i for link in mine for i in link if i in flights]
        if len(set(met)) < len(met):
            twice = next(scene.ids[i] for i in met if met.count(i) > 1)
            raise NoTangentMap(f"event {event.index}: {twice} has several contacts at one instant", event.index)
        time, states = float(event.time), trajectory.motion.state(event.time)
        for i in met:
            x, y, vx, vy = (float(value) for value in states[i])
            flights[i].append((time, x, y, vx, vy))
        links += mine
        owners += [event.index] * len(mine)
        times += [time] * len(mine)
    return Record(tuple(links), tuple(owners), tuple(times), {i: tuple(rows) for i, rows in flights.items()})
