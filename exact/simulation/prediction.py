"""Predicts the next meetings of circles whose flights are new, in the state's own numbers."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Sequence
from math import inf, nextafter

from ...scenarios.scene import Scene
from ..laws.formulas import (
    advance,
    pair_approach,
    pair_discriminant,
    pair_gap,
    pair_hit_time,
    wall_approach,
    wall_gap,
    wall_hit_time,
)
from ..numbers.system import Number
from ..replay.body import Body
from ..replay.state import State
from ..replay.steps import Link
from .queue import ArrivalQueue

ROUNDED_DOWN = 1 - 2.0**-50
"""Makes a quotient of doubles a lower bound: its rounding, 2**-53, is less."""

Bounds = Callable[[Number], tuple[float, float]]


class Predictor:
    """Predictions in one number system; what its signs leave open goes to `unsure`.

    Args:
        scene: what runs.
        state: its state.
        queue: where arrivals go.
        plan: counts what is predicted and what is skipped.
        bounds: doubles that enclose a time.
        unsure: deals with a prediction whose signs were not all certain.
    """

    def __init__(
        self,
        scene: Scene,
        state: State,
        queue: ArrivalQueue,
        plan: Counter[str],
        bounds: Bounds,
        unsure: Callable[[Link], None],
    ) -> None:
        self.scene = scene
        self.state = state
        self.queue = queue
        self.plan = plan
        plan["pairs at rest skipped"] = 0
        self.bounds = bounds
        self.unsure = unsure
        self.n = len(scene.circles)
        self.wall_count = len(scene.walls)
        self.pockets = range(len(scene.pockets))
        self.points = frozenset(i for i, circle in enumerate(scene.circles) if circle.r.sign() == 0)
        self.zero = state.zero
        self.root = state.root

    def prepare(self) -> None:
        """Called before predictions, and after each that was unsure."""
        return

    def reach(self, a: Body, b: Body) -> Number:
        """The sum of two radii as predictions use it."""
        return self.state.reach(a, b)

    def line(self, body: Body, wall: int) -> tuple[Number, Number, Number, Number, Number]:
        """(x0, y0, nx, ny, r*|n|) of a wall as seen from a body, as predictions use them."""
        line = self.state.line(body, wall)
        return line.x0, line.y0, line.nx, line.ny, body.r * line.length

    def predict(self, moved: Sequence[Body], standing: Collection[Link], gone: Collection[int]) -> None:
        """Queues the next meetings of some circles with every other circle, wall and pocket.

        Args:
            moved: circles whose flights are new.
            standing: contacts and rims at gap zero that do not approach: nothing to predict until a flight changes.
            gone: circles out of play.
        """
        plan, count = self.plan, self.n
        self.prepare()
        others = self.state.bodies[:count]
        pockets = [self.state.bodies[-1 - k] for k in self.pockets]
        if gone:
            others = [b for b in others if b.index not in gone]
            moved = [a for a in moved if a.index not in gone]
        for done, a in enumerate(moved, start=1):
            others.remove(a)
            met = others
            if a.rest:
                met = [b for b in others if not b.rest]
                plan["pairs at rest skipped"] += len(others) - len(met)
            plan["pairs predicted"] += count - done - len(others) + len(met)
            self.pairs(a, [*met, *pockets] if pockets and not a.rest else met, standing)
            if not a.rest:
                plan["walls predicted"] += self.wall_count
                self.walls(a, standing)

    def pairs(self, a: Body, others: list[Body], standing: Collection[Link]) -> None:
        """Queues the next meetings of a, which has a new flight, with circles and pockets."""
        for b in others:
            self.pair(a, b, standing)

    def walls(self, a: Body, standing: Collection[Link]) -> None:
        """Queues the next hits of a, which has a new flight, with the walls."""
        for k in range(self.wall_count):
            self.wall(a, k, standing)

    def pair(self, a: Body, b: Body, standing: Collection[Link]) -> None:
        """Queues the next meeting of a, which has a new flight, with the circle or pocket b.

        That they are apart and come nearer is asked at the instant at which the flight begins; the time is reckoned
        from the clock (see `BallState`).
        """
        ax, ay, avx, avy, at = a.q
        bx, by, bvx, bvy, bt = b.q
        if b.rest:
            dx, dy, vx, vy = bx - ax, by - ay, -avx, -avy
        else:
            if bt is at:
                dx, dy = bx - ax, by - ay
            else:
                lag = at - bt
                dx, dy = advance(bx, bvx, lag) - ax, advance(by, bvy, lag) - ay
            vx, vy = bvx - avx, bvy - avy
        zero, late = self.zero, a.late
        gx, gy = (dx, dy) if late is None else (advance(dx, vx, late), advance(dy, vy, late))
        if pair_approach(gx, gy, vx, vy) >= zero:
            return
        link = (b.index, a.index) if 0 <= b.index < a.index else (a.index, b.index)
        if link in standing or (a.index in self.points and b.index in self.points):
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

    def wall(self, a: Body, wall: int, standing: Collection[Link]) -> None:
        """Queues the next hit of a, which has a new flight, with a wall."""
        x0, y0, nx, ny, offset = self.line(a, wall)
        ax, ay, avx, avy, at = a.q
        approach = wall_approach(avx, avy, nx, ny)
        if approach >= self.zero:
            return
        link = (a.index, self.n + wall)
        if link in standing:
            return
        gap = wall_gap(ax, ay, x0, y0, nx, ny, offset)
        late = a.late
        still = (
            gap if late is None else wall_gap(advance(ax, avx, late), advance(ay, avy, late), x0, y0, nx, ny, offset)
        )
        if approach < self.zero and still > self.zero:
            self.push(at + wall_hit_time(gap, approach), link)
        else:
            self.unsure(link)
            self.prepare()

    def push(self, time: Number, link: Link, graze: bool = False) -> None:
        """Queues a meeting that is certain to come if nothing else does first."""
        low, high = self.bounds(time)
        self.queue.push(low, high, time, link, graze)

    def push_doubtful(self, link: Link) -> None:
        """Queues a meeting that may not come at all, to be settled when its turn comes."""
        low = earliest_possible(self.state, link, self.bounds)
        if low < inf:
            self.queue.push(low, inf, None, link)


def earliest_possible(state: State, link: Link, bounds: Bounds) -> float:
    """A double before which a doubtful meeting cannot come: the gap over the greatest closing speed; inf: never."""
    if link[1] < state.n:
        _, dx, dy, vx, vy, reach = state.relation(*link)
        t = state.later(*link).instant
        distance = state.root(dx * dx + dy * dy)
        speed = state.root(vx * vx + vy * vy)
        gap = state.gap(link) / (distance + reach)
    else:
        t, gap, speed = state.bodies[link[0]].instant, state.gap(link), -state.approach(link)
    least_gap, top_speed = bounds(gap)[0], bounds(speed)[1]
    if top_speed <= 0.0:
        return inf
    if not least_gap > 0.0:
        return -inf
    wait = least_gap / top_speed * ROUNDED_DOWN
    return nextafter(bounds(t)[0] + wait, -inf)
