"""A run with its order of contacts held fixed: a smooth map from one node to the next, and its tangent map."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from flint import arb

from ...exact.numbers import ball
from ...exact.replay.contact import AtWall, Flight, Pair, Touch
from ...exact.replay.state import Go, Kick, ReplayState
from ..tangent.growth import Displacements, unit_displacements
from ..tangent.impacts import Impact, moving
from .record import Indices, Record

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ...scenarios.scene import Scene

Node = list[arb]
"""x, y, vx, vy of every circle that can move, one after the other: midpoints, without a radius."""


class Missed(ArithmeticError):
    """Two that are to meet do not: what leads to them passes by.

    Attributes:
        contact: which, by its place in the order.
    """

    def __init__(self, contact: int) -> None:
        super().__init__(f"contact {contact} is missed")
        self.contact = contact


@dataclass(frozen=True)
class Segment:
    """From one node to the next: contacts from number `first` on, and the two nodes' times."""

    first: int
    links: tuple[Indices, ...]
    begin: float
    end: float


def segments(record: Record) -> list[Segment]:
    """One for each instant: nodes stand half-way between instants, the first at time 0, the last at the last instant.

    Nothing is lost where two instants are so close that a contact falls on the other side of a node: a state is then
    flown back to it.
    """
    found: list[Segment] = []
    first, begin, count = 0, 0.0, len(record.links)
    while first < count:
        stop = first + 1
        while stop < count and record.events[stop] == record.events[first]:
            stop += 1
        last = record.times[stop - 1]
        end = last if stop == count else last + (record.times[stop] - last) / 2
        found.append(Segment(first, record.links[first:stop], begin, end))
        first, begin = stop, end
    return found


class FixedOrder:
    """The map of each segment, in balls at flint's working precision.

    Args:
        scene: what runs; of its start only walls, fixed circles, radii and masses count.
        chain: the segments.
    """

    def __init__(self, scene: Scene, chain: Sequence[Segment]) -> None:
        self.scene = scene
        self.chain = chain
        self.free = moving(scene)
        self._made = ReplayState(scene, ball.BALLS)
        self._bits = ball.bits_in_use()

    def image(self, k: int, node: Node) -> tuple[Node, list[Impact]]:
        """Where segment k leads from a node, and the impacts on the way.

        Raises:
            Missed: if two that are to meet do not.
        """
        segment = self.chain[k]
        state = self._state(segment, node)
        struck: list[Impact] = []
        for place, (i, j) in enumerate(segment.links):
            link = Pair(i, j) if j < state.n else AtWall(i, j - state.n)
            meets = link.approach(state) < 0
            state.do(Go(link, link.circles))
            if not meets or not state.instant.is_finite():
                raise Missed(segment.first + place)
            struck.append(_impact(state, link))
            state.do(Kick((link,), (link,)))
        end, told = arb(segment.end), []
        for i in self.free:
            flight = state.bodies[i].flight
            told += [flight.x + flight.vx * (end - flight.t), flight.y + flight.vy * (end - flight.t)]
            told += [flight.vx, flight.vy]
        return told, struck

    def _state(self, segment: Segment, node: Node) -> ReplayState[arb]:
        if self._bits != ball.bits_in_use():
            self._made, self._bits = ReplayState(self.scene, ball.BALLS), ball.bits_in_use()
        state, begin = self._made, arb(segment.begin)
        for body in state.bodies.values():
            body.flight = body.flight._replace(last=0)
        for row, i in enumerate(self.free):
            x, y, vx, vy = node[4 * row : 4 * row + 4]
            state.bodies[i].flight = Flight(x, y, vx, vy, begin, begin)
        state.steps_done, state.met = 0, None
        return state

    def tangent(self, k: int, struck: Sequence[Impact]) -> NDArray[np.float64]:
        """The tangent map of segment k, in doubles: shape (4 moving circles, the same)."""
        segment = self.chain[k]
        carried = Displacements(self.scene, unit_displacements(self.scene), segment.begin)
        carried.through(struck)
        carried.fly(segment.end)
        return carried.matrix * 2.0**carried.scale


def _impact(state: ReplayState[arb], link: Touch) -> Impact:
    """The impact that is about to push."""
    i = link.circles[0]
    flight = state.bodies[i].flight
    if isinstance(link, AtWall):
        line = state.line(link.circle, link.wall)
        return Impact(
            state.instant, i, None, line.nx, line.ny, flight.vx, flight.vy, line.length, state.zero, state.zero
        )
    (a, b), (dx, dy) = link.ends(state), state.span(link)
    vx, vy = b.flight.vx - flight.vx, b.flight.vy - flight.vy
    return Impact(state.instant, i, link.b, dx, dy, vx, vy, state.reach(a, b), a.w, b.w)
