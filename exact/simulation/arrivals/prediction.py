"""Predicts the next meetings of circles whose flights are new, in the state's own numbers."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Sequence
from math import inf, nextafter
from typing import Generic

from ....scenarios.scene import Scene
from ...laws.formulas import (
    advance,
    pair_approach,
    pair_discriminant,
    pair_gap,
    pair_hit_time,
    wall_approach,
    wall_gap,
    wall_hit_time,
)
from ...numbers.system import M
from ...replay.body import Body
from ...replay.contact import AtWall, Entry, Link, Pair, Round
from ...replay.state import State
from . import grid as crowding
from .cells import FARTHEST
from .crowd import Crowd, cells_for
from .grid import FloatFlight
from .queue import ArrivalQueue

ROUNDED_DOWN = 1 - 2.0**-50
"""Makes a quotient of doubles a lower bound: its rounding, 2**-53, is less."""

SHARP = 2.0**-49
"""Most by which bounds of a number may differ, as a share of it, where a double tells it to a few roundings."""


class Predictor(Generic[M]):
    """Predictions in one number system; what its signs leave open goes to `unsure`.

    Args:
        scene: what runs.
        state: its state.
        queue: where arrivals go.
        plan: counts what is predicted and what is skipped.
        bounds: doubles that enclose a time.
        unsure: deals with a prediction whose signs were not all certain.

    Attributes:
        few: whether there is nothing but circles and walls, and every pair of circles is looked at; known once the
            first meetings are predicted.
    """

    def __init__(
        self,
        scene: Scene,
        state: State[M],
        queue: ArrivalQueue[M],
        plan: Counter[str],
        bounds: Callable[[M], tuple[float, float]],
        unsure: Callable[[Link], None],
    ) -> None:
        self.scene = scene
        self.state = state
        self.queue = queue
        self.plan = plan
        plan["pairs at rest skipped"] = 0
        self.bounds = bounds
        self.unsure = unsure
        self._count = len(scene.circles)
        self.wall_count = len(scene.walls)
        self.points = frozenset(i for i, circle in enumerate(scene.circles) if circle.r.sign() == 0)
        self._begun = False
        self._crowd: Crowd[M] | None = None
        self.few = False
        self.zero = state.zero
        self.root = state.root

    def prepare(self) -> None:
        """Called before predictions in the state's own numbers, and after each that was unsure."""
        return

    def reach(self, a: Body[M], b: Body[M]) -> M:
        """The sum of two radii as predictions use it."""
        return self.state.reach(a, b)

    def line(self, body: Body[M], wall: int) -> tuple[M, M, M, M, M]:
        """(x0, y0, nx, ny, r*|n|) of a wall as seen from a body, as predictions use them."""
        line = self.state.line(body.index, wall)
        return line.x0, line.y0, line.nx, line.ny, body.r * line.length

    def predict(self, moved: Sequence[Body[M]], standing: Collection[Link], gone: Collection[int]) -> None:
        """Queues the next meetings of some circles with every other circle, wall and pocket.

        Walls come first: what a flight would meet after a wall, it does not meet (see `ArrivalQueue`).

        Args:
            moved: circles whose flights are new.
            standing: contacts and rims at gap zero that do not approach: nothing to predict until a flight changes.
            gone: circles out of play.
        """
        plan, count = self.plan, self._count
        if gone:
            moved = [a for a in moved if a.index not in gone]
        if not self._begun:
            self._begun = True
            self._gather_crowd()
            self.few = self._crowd is None and not self.state.pockets
        if self._crowd is not None:
            self._crowd.predict(moved, standing, gone)
            return
        self._walls_of(moved, standing)
        others = (
            [b for b in self.state.bodies.values() if b.index not in gone] if gone else [*self.state.bodies.values()]
        )
        pockets = self.state.pockets
        predicted = 0
        for done, a in enumerate(moved, start=1):
            others.remove(a)
            met = others
            if a.flight.rest:
                met = [b for b in others if not b.flight.rest]
                plan["pairs at rest skipped"] += len(others) - len(met)
            predicted += count - done - len(others) + len(met)
            self.pairs(a, [*met, *pockets] if pockets and not a.flight.rest else met, standing)
        if moved:
            plan["pairs predicted"] += predicted

    def _gather_crowd(self) -> None:
        """Puts the circles in cells, if they are many."""
        state = self.state
        if self._count < crowding.FEWEST:
            return
        try:
            radii = [float(circle.r) for circle in self.scene.circles]
        except OverflowError:  # beyond doubles, as no grid is
            return
        cells = cells_for([self.in_doubles(body) for body in state.bodies.values()], radii, self.scene.walls)
        if cells is not None:
            self._crowd = self.queue.crossings = Crowd(cells, state.bodies, state.pockets, self.plan, self)

    def in_doubles(self, a: Body[M]) -> FloatFlight | None:
        """A flight in doubles; None where they do not tell it to a rounding."""
        numbers: list[float] = []
        for number in a.q:
            low, high = self.bounds(number)
            if not (high - low <= SHARP * abs(low) and abs(low) < FARTHEST):
                return None
            numbers.append(low)
        x, y, vx, vy, t = numbers
        return x, y, vx, vy, t

    def _walls_of(self, moved: Sequence[Body[M]], standing: Collection[Link]) -> None:
        flying, every = 0, range(self.wall_count)
        for a in moved:
            a.until = inf
            if not a.flight.rest:
                flying += 1
                self.walls(a, every, standing)
        if flying:
            self.plan["walls predicted"] += flying * self.wall_count

    def pairs(self, a: Body[M], others: list[Body[M]], standing: Collection[Link]) -> None:
        """Queues the next meetings of a circle with other circles and with pockets, those of older flights first."""
        last = a.flight.last
        for b in others:
            if b.flight.last <= last:
                self.pair(a, b, standing)
        for b in others:
            if b.flight.last > last:
                self.pair(b, a, standing)

    def walls(self, a: Body[M], walls: Sequence[int], standing: Collection[Link]) -> None:
        """Queues the next hits of a circle with some walls."""
        for k in walls:
            self.wall(a, k, standing)

    def pair(self, a: Body[M], b: Body[M], standing: Collection[Link]) -> None:
        """Queues the next meeting of a, which has a new flight, with the circle or pocket b.

        That they are apart and come nearer is asked at the instant at which the flight begins; the time is reckoned
        from the clock (see `BallState`).
        """
        ax, ay, avx, avy, at = a.q
        bx, by, bvx, bvy, bt = b.q
        if b.flight.rest:
            dx, dy, vx, vy = bx - ax, by - ay, -avx, -avy
        else:
            if bt is at:
                dx, dy = bx - ax, by - ay
            else:
                lag = at - bt
                dx, dy = advance(bx, bvx, lag) - ax, advance(by, bvy, lag) - ay
            vx, vy = bvx - avx, bvy - avy
        zero, late = self.zero, a.flight.late
        gx, gy = (dx, dy) if late is None else (advance(dx, vx, late), advance(dy, vy, late))
        if pair_approach(gx, gy, vx, vy) >= zero:
            return
        link = link_of(a, b)
        if link in standing or (isinstance(link, Pair) and a.index in self.points and b.index in self.points):
            return
        reach = self.reach(a, b)
        disc = pair_discriminant(dx, dy, vx, vy, reach)
        if disc < zero:
            return
        if disc > zero and pair_approach(gx, gy, vx, vy) < zero and pair_gap(gx, gy, reach) > zero:
            approach = pair_approach(dx, dy, vx, vy)
            self.push(at + pair_hit_time(pair_gap(dx, dy, reach), approach, self.root(disc)), link)
        else:
            self.unsure(link)
            self.prepare()

    def wall(self, a: Body[M], wall: int, standing: Collection[Link]) -> None:
        """Queues the next hit of a, which has a new flight, with a wall."""
        x0, y0, nx, ny, offset = self.line(a, wall)
        ax, ay, avx, avy, at = a.q
        approach = wall_approach(avx, avy, nx, ny)
        if approach >= self.zero:
            return
        link = AtWall(a.index, wall)
        if link in standing:
            return
        gap = wall_gap(ax, ay, x0, y0, nx, ny, offset)
        late = a.flight.late
        still = (
            gap if late is None else wall_gap(advance(ax, avx, late), advance(ay, avy, late), x0, y0, nx, ny, offset)
        )
        if approach < self.zero and still > self.zero:
            self.push(at + wall_hit_time(gap, approach), link)
        else:
            self.unsure(link)
            self.prepare()

    def push(self, time: M, link: Link, graze: bool = False) -> None:
        """Queues a meeting that is certain to come if nothing else does first."""
        low, high = self.bounds(time)
        self.queue.push(low, high, time, link, graze)

    def push_doubtful(self, link: Link) -> None:
        """Queues a meeting that may not come at all, to be settled when its turn comes."""
        low = earliest_possible(self.state, link, self.bounds)
        if low < inf:
            self.queue.push_doubtful(low, link)


def link_of(a: Body[M], b: Body[M]) -> Round:
    """The contact of two circles, or the entry of a circle into the pocket b.

    >>> from truebreak.exact.numbers.system import number_system
    >>> from truebreak.scenarios import Circle
    >>> two = State(Scene([Circle(0, 0), Circle(3, 0)]), number_system("double")).bodies
    >>> link_of(two[1], two[0])
    Pair(a=0, b=1)
    """
    if b.is_pocket:
        return Entry(a.index, b.index)
    return Pair(a.index, b.index) if a.index < b.index else Pair(b.index, a.index)


def earliest_possible(state: State[M], link: Link, bounds: Callable[[M], tuple[float, float]]) -> float:
    """A double before which a doubtful meeting cannot come: the gap over the greatest closing speed; inf: never."""
    t, gap = link.later(state).flight.instant, link.gap(state)
    if isinstance(link, AtWall):
        speed = -link.approach(state)
    else:
        _, dx, dy, vx, vy, reach = state.relation(link)
        gap = gap / (state.root(dx * dx + dy * dy) + reach)
        speed = state.root(vx * vx + vy * vy)
    least_gap, top_speed = bounds(gap)[0], bounds(speed)[1]
    if top_speed <= 0.0:
        return inf
    if not least_gap > 0.0:
        return -inf
    wait = least_gap / top_speed * ROUNDED_DOWN
    return nextafter(bounds(t)[0] + wait, -inf)
