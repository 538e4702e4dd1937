"""Predictions of the exact engine: in doubles where their error bound leaves no doubt, else in short balls."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Iterable, Sequence
from math import inf

from flint import arb

from ...scenarios.numbers.quantity import Quantity
from ...scenarios.scene import Scene
from ..numbers import ball
from ..predicates.double_filter import DoubleFilter, FloatLine, float_line
from ..replay.body import FAINT, Body, Landed
from ..replay.contact import Entry, Link
from ..replay.refinable import RefinableState
from ..simulation.arrivals.grid import FloatFlight
from ..simulation.arrivals.prediction import Predictor, link_of
from ..simulation.arrivals.queue import ArrivalQueue, Outlook

QUICK_BITS = 128
"""Precision of predictions: two machine words, the most that flint keeps without a call for memory."""

NEAR = arb(0, arb((1, FAINT)))
"""Holds all deviations that are at most 2**FAINT."""


class FilteredPredictor(Predictor[arb]):
    """Predictions in doubles, then in short balls.

    Args:
        scene: what runs.
        refinable: its state.
        queue: where arrivals go.
        plan: counts what is predicted, what is skipped, and what doubles left open.
        unsure: deals with a prediction that short balls leave open.
    """

    def __init__(
        self,
        scene: Scene,
        refinable: RefinableState,
        queue: ArrivalQueue[arb],
        plan: Counter[str],
        unsure: Callable[[Link], None],
    ) -> None:
        super().__init__(scene, refinable.balls, queue, plan, ball.double_bounds, unsure)
        self.refinable = refinable
        self.zero = ball.ZERO
        self.root = arb.sqrt
        self.filter = DoubleFilter()
        self._reaches = self._quick_reaches()
        self._lines: dict[tuple[int, int, bool], tuple[arb, arb, arb, arb, arb]] = {}
        self._float_reaches = [[ball.as_double(reach) for reach in row] for row in self._reaches]
        self._float_lines: dict[int, list[FloatLine]] = {}
        self._known_float_lines: dict[tuple[int, int, bool], FloatLine] = {}
        self._outlooks: dict[tuple[int, int], Outlook[arb]] = {}

    def prepare(self) -> None:
        """Short precision."""
        ball.use_bits(QUICK_BITS)

    def _quick_reaches(self) -> list[list[arb]]:
        """Sums of radii by kind of radius, and a pocket's own; each body's `kind` indexes them."""
        radii: dict[Quantity, int] = {}
        for body, circle in zip(self.refinable.bodies.values(), self.scene.circles, strict=True):
            body.kind = radii.setdefault(circle.r, len(radii))
        kinds = len(radii)
        with ball.precision(QUICK_BITS):
            reaches = [[ball.constant(r + s) for s in radii] for r in radii]
            for k, pocket in enumerate(self.scene.pockets):
                self.state.pockets[k].kind = kinds + k
                for row in reaches:
                    row.append(ball.constant(pocket.r))
        return reaches

    def reach(self, a: Body[arb], b: Body[arb]) -> arb:
        """The sum of two radii, or a pocket's own, as a short ball."""
        return self._reaches[a.kind][b.kind]

    def line(self, body: Body[arb], wall: int) -> tuple[arb, arb, arb, arb, arb]:
        """A wall in short balls: the same for all circles of one radius on one side of it."""
        key = self._key(body, wall)
        found = self._lines.get(key)
        if found is None:
            with ball.precision(2 * QUICK_BITS):
                exact = self.scene.walls[wall]
                nx, ny = exact.normal
                length = (nx * nx + ny * ny).sqrt()
                if key[2]:
                    nx, ny = -nx, -ny
                offset = self.scene.circles[body.index].r * length
                x0, y0, mx, my, fixed = (ball.constant(q) for q in (exact.x0, exact.y0, nx, ny, offset))
            with ball.precision(QUICK_BITS):
                found = self._lines[key] = (+x0, +y0, +mx, +my, +fixed)
        return found

    def refresh(self, bodies: Iterable[Body[arb]]) -> None:
        """Short copies of the states."""
        self.refinable.sync_for(bodies)
        ball.use_bits(QUICK_BITS)
        admit, last, t = self.filter.admit, None, None
        for body in bodies:
            x, y, vx, vy, clock, *_ = body.flight
            if t is None or clock is not last:
                last, t = clock, +clock
            body.q = (+x, +y, +vx, +vy, t)
            admit(body)

    def take(self, landed: Iterable[Landed[arb]], clock: arb) -> None:
        """As `refresh`, of circles that are not exact, at one clock; see `LoneContacts`."""
        ball.use_bits(QUICK_BITS)
        t, take = +clock, self.filter.take
        for body, (x, y, vx, vy, *_), doubles in landed:
            if doubles is None:
                x, y, vx, vy, *_ = body.flight
                body.q = (+x, +y, +vx, +vy, t)
                self.filter.admit(body)
            else:
                body.q = (x + NEAR, y + NEAR, vx + NEAR, vy + NEAR, t)
                take(body, doubles)

    def predict(self, moved: Sequence[Body[arb]], standing: Collection[Link], gone: Collection[int]) -> None:
        """See `Predictor.predict`; where doubles tell all, flights are not asked for."""
        if gone or not self.few or not 0 < len(moved) < 3:
            super().predict(moved, standing, gone)
            return
        key = moved[0].index, moved[-1].index
        outlook, queue, find = self._outlooks.get(key) or self._outlook_of(key), self.queue, self.filter
        if not queue.push_all(moved, outlook, find.pair_bounds, find.wall_bounds, standing):
            for a in moved:
                if a.f is None or not (a.f[2] or a.f[3]):
                    super().predict(moved, standing, gone)
                    return
            for a, lines in zip(moved, outlook.lines, strict=True):
                a.until = inf
                found, unclear = find.walls(a, lines)
                queue.push_walls(a, found, standing)
                if unclear:
                    self._unclear_walls(a, unclear, standing)
            for a, others in zip(moved, outlook.others, strict=True):
                self.pairs(a, others, standing)
        plan = self.plan
        plan["walls predicted"] += len(moved) * self.wall_count
        plan["pairs predicted"] += outlook.pairs

    def _outlook_of(self, key: tuple[int, int]) -> Outlook[arb]:
        """What two circles, or one, may meet: the second not the first."""
        i, j = key
        bodies = self.state.bodies
        moved = [bodies[i]] if i == j else [bodies[i], bodies[j]]
        others = [[b for b in bodies.values() if b.index not in out] for out in ((i,), key)[: len(moved)]]
        found = self._outlooks[key] = Outlook(
            others,
            [self._float_lines.get(a.index) or self._as_seen_from(a) for a in moved],
            [self._float_reaches[a.kind] for a in moved],
            sum(map(len, others)),
        )
        return found

    def pairs(self, a: Body[arb], others: list[Body[arb]], standing: Collection[Link]) -> None:
        """See `Predictor.pairs`; the order is that of `others`."""
        found, unclear = self.filter.pairs(a, others, self._float_reaches[a.kind])
        if self.state.pockets:
            for low, high, b in found:
                if low <= a.until and (link := link_of(a, b)) not in standing:
                    self.queue.push(low, high, None, link)
        elif found:
            self.queue.push_pairs(a, found, standing)
        if unclear:
            self.plan["unclear in doubles"] += len(unclear)
            self.prepare()
            super().pairs(a, unclear, standing)

    def walls(self, a: Body[arb], walls: Sequence[int], standing: Collection[Link]) -> None:
        """See `Predictor.walls`."""
        if len(walls) == self.wall_count:
            lines = self._float_lines.get(a.index) or self._as_seen_from(a)
        else:
            lines = [self._float_line(a, k) for k in walls]
        found, unclear = self.filter.walls(a, lines)
        self.queue.push_walls(a, found, standing)
        if unclear:
            self._unclear_walls(a, unclear, standing)

    def _unclear_walls(self, a: Body[arb], unclear: list[int], standing: Collection[Link]) -> None:
        """Walls that doubles left open."""
        self.plan["unclear in doubles"] += len(unclear)
        self.prepare()
        for k in unclear:
            self.wall(a, k, standing)

    def in_doubles(self, a: Body[arb]) -> FloatFlight | None:
        """See `Predictor.in_doubles`."""
        return None if a.f is None else a.f[:5]

    def _as_seen_from(self, a: Body[arb]) -> list[FloatLine]:
        lines = self._float_lines[a.index] = [self._float_line(a, k) for k in range(self.wall_count)]
        return lines

    def _float_line(self, a: Body[arb], wall: int) -> FloatLine:
        key = self._key(a, wall)
        if key not in self._known_float_lines:
            self._known_float_lines[key] = float_line(wall, *self.line(a, wall))
        return self._known_float_lines[key]

    def _key(self, a: Body[arb], wall: int) -> tuple[int, int, bool]:
        """A circle's radius, by kind, a wall, and the side of it."""
        return a.kind, wall, self.refinable.balls.sides.negative(a.index, wall)

    def off_rim(self, link: Entry) -> bool:
        """Whether doubles tell a centre at its clock from every point of a pocket's rim."""
        a, pocket = link.ends(self.state)
        return self.filter.apart(a, pocket, self._float_reaches[a.kind][pocket.kind])
