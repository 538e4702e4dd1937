"""Predictions of the exact engine: in doubles where their error bound leaves no doubt, else in short balls."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Iterable, Sequence
from math import inf, isfinite, nan, sqrt
from typing import Any, TypeAlias

from flint import arb

from ...scenarios.numbers.quantity import Quantity
from ...scenarios.scene import Scene
from ..compiled import predictions
from ..numbers import ball
from ..numbers.system import N
from ..replay.contact import FAINT, Body, Doubles, Entry, Landed, Link
from ..replay.refinable import RefinableState
from ..simulation.cells import FloatFlight
from ..simulation.prediction import ArrivalQueue, FloatLine, Outlook, Predictor, link_of

# -- The first rung: predictions in doubles, with a bound on every rounding, that answer only where sure.
#
# As the filters of exact geometry do (Bronnimann, Burnikel, Pion, *Interval arithmetic yields efficient dynamic
# filters*, 2001; Shewchuk, *Adaptive precision floating-point arithmetic*, 1997), a quantity is computed in doubles
# with a bound on its distance from the true value. A sign is told only beyond the bound; a time is told as two
# doubles that enclose it. Everything else is UNCLEAR, and goes to balls.
#
# Bounds. u = 2**-53 is the rounding unit. A state's doubles are off by at most 2u relatively: u by rounding the
# ball's middle, and less than u/50 by its radius (`admit` sees to that). With S the largest coordinate, V the largest
# speed component and T the latest clock that the run has seen:
#
# - a coordinate of d is off by less than E = 64 u (S + V T): 2u S twice from the positions, 2u T twice and a rounding
#   from the clocks, times V, 2u and a rounding from the product, three roundings of sums, together under
#   2u (4 S + 6 V T);
# - a component of v is off by less than F = 8 u V;
# - d.v and d x v are off by less than 2 E W + 5 F D, with W and D the 1-norms of v and d: E W + F D + E F from the
#   factors, and three roundings of at most 3 u D W <= 1.5 F D, as W <= 4 V;
# - |v|^2 is off by less than 3 F W.
#
# A flight begins at its instant, which its clock may miss by `late`; d.v there differs by at most |v|^2 times that,
# so a pair surely parts only beyond that, and a hit counts only if it comes later than `late` after the clock. Most
# pairs that part do so beyond one bound for all, with W <= 4 V, D <= 4 S + 2 V T and |v|^2 <= 8 V^2; most that miss
# each other do so beyond such bounds of d x v and |v|^2.
#
# All bounds are then taken at least twice as large as they come out, which covers the rounding of the bounds
# themselves.
#
# Where `compiled.predictions` is there, it does what `pairs`, `walls` and `faces` do here.

UNIT = 2.0**-53

ACCURATE_BITS = 60
"""A ball with this relative accuracy has a radius below 2**-58 of its middle: u/32 at most."""

BIG = 1e50
"""Beyond this, or its inverse, fourth powers and quotients of bounds might overflow or vanish: left to balls."""

TINY = 1 / BIG

AHEAD = 1.125
"""How far ahead of the latest clock bounds are taken, so that they hold for a while."""


def float_line(wall: int, x0: arb, y0: arb, nx: arb, ny: arb, offset: arb) -> FloatLine:
    """The doubles of a wall's short balls. Where these cannot tell the wall, its normal and its size are infinite, and
    nothing is ever clear: neither that a circle meets it nor that it flies away from it."""
    fx0, fy0, fnx, fny, fixed = (float(value) for value in (x0, y0, nx, ny, offset))
    norm = abs(fnx) + abs(fny)
    size = norm * (abs(fx0) + abs(fy0)) + abs(fixed)
    sharp = all(value.rel_accuracy_bits() > ACCURATE_BITS for value in (x0, y0, nx, ny, offset))
    if not (sharp and size < BIG and 1 / BIG < norm < BIG):
        norm = size = inf
    return FloatLine(wall, fx0, fy0, fnx, fny, fixed, norm, size)


PairBounds: TypeAlias = tuple[float, float, float, float, float]
"""4 E and F; of d.v and d x v, |v|^2 and what a `late` of 1 does to d.v: bounds that hold for any pair."""


class DoubleFilter:
    """Predictions in doubles.

    Attributes:
        largest: the largest coordinate seen (S).
        fastest: the largest speed component seen (V).
        latest: no less than the latest clock seen (T).
    """

    def __init__(self) -> None:
        self.largest = 0.0
        self.fastest = 0.0
        self.latest = 0.0
        self._clock: arb | None = None
        self._beside: arb | None = None
        self._at = self._late = 0.0
        self._bounds: PairBounds | None = None

    def admit(self, body: Body[arb], beside: arb | None) -> None:
        """Sets a body's doubles from its short balls and its `late`, or None if they are not accurate enough."""
        x, y, vx, vy, t = body.q
        if t is not self._clock or beside is not self._beside:
            self._stand(t, beside)
        ft, late = self._at, self._late
        if not (
            x.rel_accuracy_bits() > ACCURATE_BITS
            and y.rel_accuracy_bits() > ACCURATE_BITS
            and vx.rel_accuracy_bits() > ACCURATE_BITS
            and vy.rel_accuracy_bits() > ACCURATE_BITS
            and ft < BIG
        ):
            body.f = None
            return
        fx, fy, fvx, fvy = float(x), float(y), float(vx), float(vy)
        if not (fx and fy and fvx and fvy) and any(
            told == 0.0 and not ball.is_zero() for told, ball in ((fx, x), (fy, y), (fvx, vx), (fvy, vy))
        ):  # below all doubles, which is not at rest
            body.f = None
            return
        self.take(body, (fx, fy, fvx, fvy, ft, late))

    def take(self, body: Body[Any], doubles: Doubles) -> None:
        """Sets a body's doubles, which are off by at most 2u, or None if they are too large or too small."""
        fx, fy, fvx, fvy, ft, late = doubles
        px, py, sx, sy = abs(fx), abs(fy), abs(fvx), abs(fvy)
        place = px if px > py else py
        speed = sx if sx > sy else sy
        if not (place < BIG and speed < BIG) or (
            not (px > TINY and py > TINY and sx > TINY and sy > TINY)
            and (0.0 < px < TINY or 0.0 < py < TINY or 0.0 < sx < TINY or 0.0 < sy < TINY)
        ):
            body.f = None
            return
        if not (ft < BIG and late < BIG) or 0.0 < ft < TINY:
            body.f = None
            return
        if place > self.largest or speed > self.fastest or ft > self.latest:
            self.widen(place, speed, ft)
        body.f = (fx, fy, fvx, fvy, ft, late)

    def _stand(self, t: arb, beside: arb | None) -> None:
        """Keeps the double of a clock and a bound of `late`, which the two of a contact share; not a number where
        doubles do not tell them."""
        self._clock, self._beside = t, beside
        ft = float(t)
        late = 0.0 if beside is None else float(beside.abs_upper()) * ROUND_UP
        plain = not 0.0 < ft < TINY and (ft != 0.0 or t.is_zero()) and late < BIG
        told = t.rel_accuracy_bits() > ACCURATE_BITS and plain
        self._at, self._late = ft if told else nan, late

    def widen(self, place: float, speed: float, time: float) -> None:
        """Has the bounds cover what goes beyond them; clocks, which always do, by an eighth more than that."""
        self.largest = max(self.largest, place)
        self.fastest = max(self.fastest, speed)
        if time > self.latest:
            self.latest = time * AHEAD
        self._bounds = None

    @property
    def pair_bounds(self) -> PairBounds:
        """Those for all pairs, as things stand."""
        return self._bounds or self._bound()

    @property
    def wall_bounds(self) -> tuple[float, float]:
        """Bounds of what n.v, and n.x, is off by for a normal of 1."""
        return 16 * UNIT * self.fastest, 32 * UNIT * self.largest

    def _bound(self) -> PairBounds:
        fastest, latest = self.fastest, self.latest
        near = 4.0 * 64 * UNIT * (self.largest + fastest * latest)
        slack = 8 * UNIT * fastest
        largest = 4.0 * self.largest + 2.0 * fastest * latest
        any_off = 8.0 * near * fastest + 20.0 * slack * largest
        self._bounds = near, slack, any_off, 48.0 * slack * fastest, (32.0 * fastest + 96.0 * slack) * fastest
        return self._bounds

    def pairs(
        self, a: Body[N], others: list[Body[N]], reaches: list[float]
    ) -> tuple[list[tuple[float, float, Body[N]]], list[Body[N]]]:
        """Which of several bodies a hits, all keeping their velocities: bounds of the time, and the body; those that
        doubles cannot tell. A body that a surely misses is left out.

        All is reckoned at the later of two clocks. Where doubles do not tell which that is they differ by less than
        8u, which the bound of the time covers; then, as where b's is the later, a hit counts only if it is later than
        either `late`.

        Args:
            reaches: the sum of radii with a for each kind of body; not a number where doubles do not tell it.
        """
        fa = a.f
        found: list[tuple[float, float, Body[N]]] = []
        unclear: list[Body[N]] = []
        if fa is None:
            return found, list(others)
        if predictions is not None:
            return predictions.pairs(fa, others, reaches, self.pair_bounds)
        ax, ay, avx, avy, at, late = fa
        near, slack, any_off, any_loose, any_early = self.pair_bounds
        most = any_off + any_early * late
        close = 4 * UNIT * at
        for b in others:
            fb = b.f
            if fb is None:
                unclear.append(b)
                continue
            bx, by, bvx, bvy, bt, b_late = fb
            lag = at - bt
            if lag > close:
                now = at
                dx = bx + bvx * lag - ax
                dy = by + bvy * lag - ay
            else:
                now = bt
                dx = bx - (ax - avx * lag)
                dy = by - (ay - avy * lag)
                if b_late > late:
                    late = b_late
                    most = any_off + any_early * late
            vx = bvx - avx
            vy = bvy - avy
            approach = dx * vx + dy * vy
            if approach > most:
                continue
            cross = dx * vy - dy * vx
            if cross < 0.0:
                cross = -cross
            square = vx * vx + vy * vy
            reach = reaches[b.kind]
            clear = cross - any_off
            if clear > 0.0 and clear * clear > (square + any_loose) * (reach * reach) * ROUND_UP:
                continue
            wide = abs(vx) + abs(vy)
            off = near * wide + 10.0 * slack * (abs(dx) + abs(dy))
            loose = 6.0 * slack * wide
            early = off + 2.0 * (square + loose) * late
            if approach > early:
                continue
            if not (approach < -early and square > 100.0 * loose):
                unclear.append(b)
                continue
            if cross > off and (cross - off) * (cross - off) > (square + loose) * (reach * reach) * ROUND_UP:
                continue
            room = (square - loose) * (reach * reach) * ROUND_DOWN
            if (cross + off) * (cross + off) > room or reach == 0.0:
                unclear.append(b)
                continue
            speed = sqrt(square)
            doubt = loose / square + 8 * UNIT
            passing = cross / speed
            depth = sqrt(reach * reach - passing * passing)
            ahead = -approach / speed
            off /= speed
            off_passing = off + passing * doubt
            off_depth = (2.0 * passing * off_passing + off_passing * off_passing + 8 * UNIT * reach * reach) / depth
            wait = (ahead - depth) / speed
            off_wait = (off + off_depth + (ahead + depth) * (doubt + 4 * UNIT)) / speed + abs(wait) * doubt
            time = now + wait
            off_time = 2.0 * off_wait + 8 * UNIT * (now + abs(wait))
            if not (wait > off_time + late) or not isfinite(time):
                unclear.append(b)
            else:
                found.append((time - off_time, time + off_time, b))
        return found, unclear

    def apart(self, a: Body[arb], pocket: Body[arb], r: float) -> bool:
        """Whether a centre, at its clock, is surely not on the rim of a pocket of radius r.

        The clock may be `late` off the instant, by which a coordinate of d changes by V `late` at most.
        """
        fa, fb = a.f, pocket.f
        if fa is None or fb is None:
            return False
        dx, dy = fb[0] - fa[0], fb[1] - fa[1]
        near = 64 * UNIT * (self.largest + self.fastest * fa[4]) + self.fastest * fa[5]
        off = 8.0 * near * (abs(dx) + abs(dy) + near) + 32 * UNIT * r * r
        return abs(dx * dx + dy * dy - r * r) > off

    def faces(self, a: Body[Any], lines: Sequence[FloatLine]) -> tuple[list[tuple[float, float, int]], list[int]]:
        """As `walls`, of faces: those whose line is surely met beyond their ends, or from behind, are left out.

        Where the circle touches the line, its place along it is off by what its place now is, as the gap's without
        r |n|, which `blur_gap` bounds; by what the speed along it is off, as that of approach, over the wait; and by
        what the wait is off, over that speed; the products and sums are rounded by 8u of them.
        """
        fa = a.f
        found: list[tuple[float, float, int]] = []
        unclear: list[int] = []
        if fa is None:
            return found, [line.wall for line in lines]
        flat, far = self.wall_bounds
        if predictions is not None:
            return predictions.faces(fa, lines, flat, far)
        x, y, vx, vy, t, late = fa
        for k, x0, y0, nx, ny, offset, norm, size in lines:
            approach = nx * vx + ny * vy
            blur = norm * flat
            if approach > blur:
                continue
            gap = nx * (x - x0) + ny * (y - y0) - offset
            blur_gap = 32 * UNIT * size + norm * far
            early = blur_gap + 2.0 * (abs(approach) + blur) * late
            if gap < -early:
                continue
            if not (approach < -8.0 * blur and gap > blur_gap):
                unclear.append(k)
                continue
            wait = -gap / approach
            blur_wait = (blur_gap + wait * blur) / -approach + 8 * UNIT * wait
            time = t + wait
            blur_time = 2.0 * blur_wait + 8 * UNIT * (t + wait)
            if not (wait > blur_time + late) or not isfinite(time):
                unclear.append(k)
                continue
            along, slide = (x - x0) * ny - (y - y0) * nx, vx * ny - vy * nx
            foot, beyond = along + slide * wait, nx * nx + ny * ny
            blur_foot = blur_gap + wait * blur + (abs(slide) + blur) * 2.0 * blur_wait
            blur_foot = 2.0 * blur_foot + 16 * UNIT * (abs(along) + abs(slide) * wait + beyond)
            if foot < -blur_foot or foot > beyond + blur_foot:
                continue
            if foot > blur_foot and foot < beyond - blur_foot:
                found.append((time - blur_time, time + blur_time, k))
            else:
                unclear.append(k)
        return found, unclear

    def walls(self, a: Body[Any], lines: Sequence[FloatLine]) -> tuple[list[tuple[float, float, int]], list[int]]:
        """Which of several walls a circle hits, which has just moved: bounds of the time, and the wall; the unclear."""
        fa = a.f
        found: list[tuple[float, float, int]] = []
        unclear: list[int] = []
        if fa is None:
            return found, [line.wall for line in lines]
        flat, far = self.wall_bounds
        if predictions is not None:
            return predictions.walls(fa, lines, flat, far)
        x, y, vx, vy, t, late = fa
        for k, x0, y0, nx, ny, offset, norm, size in lines:
            approach = nx * vx + ny * vy
            off = norm * flat
            if approach > off:
                continue
            gap = nx * (x - x0) + ny * (y - y0) - offset
            off_gap = 32 * UNIT * size + norm * far
            if not (approach < -8.0 * off and gap > off_gap):
                unclear.append(k)
                continue
            wait = -gap / approach
            off_wait = (off_gap + wait * off) / -approach + 8 * UNIT * wait
            time = t + wait
            off_time = 2.0 * off_wait + 8 * UNIT * (t + wait)
            if not (wait > off_time + late) or not isfinite(time):
                unclear.append(k)
            else:
                found.append((time - off_time, time + off_time, k))
        return found, unclear


ROUND_UP = 1 + 64 * UNIT
"""Covers the roundings of a comparison of squares: under ten units on each side."""

ROUND_DOWN = 1 - 64 * UNIT
"""As `ROUND_UP`, from the other side."""


# -- Predictions of the exact engine: in doubles where their error bound leaves no doubt, else in short balls.

QUICK_BITS = 128
"""Precision of predictions: two machine words, the most that flint keeps without a call for memory."""

NEAR = arb(0, arb((1, FAINT)))
"""Holds all deviations that are at most 2**FAINT."""


def short_reaches(scene: Scene, bodies: Iterable[Body[arb]], pockets: Sequence[Body[arb]]) -> list[list[arb]]:
    """Sums of radii by kind of radius, and a pocket's own, in short balls; each body's `kind` indexes them."""
    radii: dict[Quantity, int] = {}
    for body, circle in zip(bodies, scene.circles, strict=True):
        body.kind = radii.setdefault(circle.r, len(radii))
    kinds = len(radii)
    with ball.precision(QUICK_BITS):
        reaches = [[ball.constant(r + s) for s in radii] for r in radii]
        for k, pocket in enumerate(scene.pockets):
            pockets[k].kind = kinds + k
            for row in reaches:
                row.append(ball.constant(pocket.r))
    return reaches


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
        self._reaches = short_reaches(scene, self.refinable.bodies.values(), self.state.pockets)
        self._lines: dict[tuple[int, int, bool], tuple[arb, arb, arb, arb, arb]] = {}
        self._float_reaches = [[ball.as_double(reach) for reach in row] for row in self._reaches]
        self._float_lines: dict[int, list[FloatLine]] = {}
        self._known_float_lines: dict[tuple[int, int, bool], FloatLine] = {}
        self._face_lines: dict[int, list[FloatLine]] = {}
        self._near_faces: dict[tuple[int, Sequence[int]], list[FloatLine]] = {}
        self.outlooks: dict[tuple[int, int], Outlook[arb]] = {}

    def prepare(self) -> None:
        """Short precision."""
        ball.use_bits(QUICK_BITS)

    def reach(self, a: Body[arb], b: Body[arb]) -> arb:
        """The sum of two radii, or a pocket's own, as a short ball."""
        return self._reaches[a.kind][b.kind]

    def line(self, body: Body[arb], wall: int) -> tuple[arb, arb, arb, arb, arb]:
        """A wall in short balls: the same for all circles of one radius on one side of it."""
        key = self.key(body, wall)
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
            x, y, vx, vy, clock, _, late, _, _ = body.flight
            if t is None or clock is not last:
                last, t = clock, +clock
            body.q = (+x, +y, +vx, +vy, t)
            admit(body, late)

    def take(self, landed: Iterable[Landed[arb]], clock: arb) -> None:
        """As `refresh`, of circles that are not exact, at one clock; see `LoneContacts`."""
        ball.use_bits(QUICK_BITS)
        t, take = +clock, self.filter.take
        for body, (x, y, vx, vy, *_), doubles in landed:
            if doubles is None:
                x, y, vx, vy, _, _, late, _, _ = body.flight
                body.q = (+x, +y, +vx, +vy, t)
                self.filter.admit(body, late)
            else:
                body.q = (x + NEAR, y + NEAR, vx + NEAR, vy + NEAR, t)
                take(body, doubles)

    def predict(self, moved: Sequence[Body[arb]], standing: Collection[Link], gone: Collection[int]) -> None:
        """See `Predictor.predict`; where doubles tell all, flights are not asked for."""
        if gone or not self.few or not 0 < len(moved) < 3:
            self.at_length(moved, standing, gone)
            return
        key = moved[0].index, moved[-1].index
        outlook, queue, find = self.outlooks.get(key) or self.outlook_of(key), self.queue, self.filter
        if not queue.push_all(moved, outlook, find.pair_bounds, find.wall_bounds, standing):
            for a in moved:
                if a.f is None or not (a.f[2] or a.f[3]):
                    self.at_length(moved, standing, gone)
                    return
            self._meet_surfaces(moved, standing)
            for a, others in zip(moved, outlook.others, strict=True):
                self.pairs(a, others, standing)
        if self.arcs is not None:
            for a in moved:
                self.arcs.meet(a, standing, self)
        plan = self.plan
        plan["walls predicted"] += len(moved) * self.wall_count
        plan["pairs predicted"] += outlook.pairs

    def at_length(self, moved: Sequence[Body[arb]], standing: Collection[Link], gone: Collection[int]) -> None:
        """As `predict`, of any circles, one after the other."""
        super().predict(moved, standing, gone)

    def _meet_surfaces(self, moved: Sequence[Body[arb]], standing: Collection[Link]) -> None:
        """Queues the next hits of circles that have doubles with all that ends a flight."""
        find = self.filter
        for a in moved:
            a.until = inf
            found, unclear = find.walls(a, self._float_lines.get(a.index) or self._as_seen_from(a))
            among, open_faces = find.faces(a, self._face_table(a))
            self.queue.push_walls(a, found + among, standing)
            self.unclear(a, unclear, standing)
            self.unclear(a, open_faces, standing)

    def outlook_of(self, key: tuple[int, int]) -> Outlook[arb]:
        """What two circles, or one, may meet: the second not the first."""
        i, j = key
        bodies = self.state.bodies
        moved = [bodies[i]] if i == j else [bodies[i], bodies[j]]
        others = [[b for b in bodies.values() if b.index not in out] for out in ((i,), key)[: len(moved)]]
        found = self.outlooks[key] = Outlook(
            others,
            [[*(self._float_lines.get(a.index) or self._as_seen_from(a)), *self._face_table(a)] for a in moved],
            [self._float_reaches[a.kind] for a in moved],
            [[] for _ in moved],
            sum(map(len, others)),
            self.wall_count,
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
        if walls and walls[-1] >= self.wall_count:
            key = a.kind, walls
            faces = self._near_faces.get(key)
            if faces is None:
                table, first = self._face_table(a), self.wall_count
                faces = self._near_faces[key] = [table[k - first] for k in walls if k >= first]
            self._meet(a, faces, standing)
            if len(faces) == len(walls):
                return
            walls = walls[: len(walls) - len(faces)]
        if self.falling is not None:
            self.prepare()
            for k in walls:
                self.wall(a, k, standing)
            return
        if len(walls) == self.wall_count:
            lines = self._float_lines.get(a.index) or self._as_seen_from(a)
        else:
            lines = [self.float_line(a, k) for k in walls]
        found, unclear = self.filter.walls(a, lines)
        self.queue.push_walls(a, found, standing)
        self.unclear(a, unclear, standing)

    def meet_faces(self, a: Body[arb], standing: Collection[Link]) -> None:
        """See `Predictor.meet_faces`."""
        self._meet(a, self._face_table(a), standing)

    def _face_table(self, a: Body[arb]) -> list[FloatLine]:
        """All faces as seen from a circle."""
        lines = self._face_lines.get(a.kind)
        if lines is None:
            lines = self._face_lines[a.kind] = [self.float_line(a, k) for k in self.faces]
        return lines

    def _meet(self, a: Body[arb], lines: Sequence[FloatLine], standing: Collection[Link]) -> None:
        """Queues the next hits of a circle with some faces."""
        found, unclear = self.filter.faces(a, lines)
        self.queue.push_walls(a, found, standing)
        self.unclear(a, unclear, standing)

    def unclear(self, a: Body[arb], walls: Sequence[int], standing: Collection[Link]) -> None:
        """Predicts a circle's next hits with walls and faces that doubles left open."""
        if walls:
            self.plan["unclear in doubles"] += len(walls)
            self.prepare()
            for k in walls:
                (self.wall if k < self.wall_count else self.face)(a, k, standing)

    def in_doubles(self, a: Body[arb]) -> FloatFlight | None:
        """See `Predictor.in_doubles`."""
        return None if a.f is None else a.f[:5]

    def _as_seen_from(self, a: Body[arb]) -> list[FloatLine]:
        lines = self._float_lines[a.index] = [self.float_line(a, k) for k in range(self.wall_count)]
        return lines

    def float_line(self, a: Body[arb], wall: int) -> FloatLine:
        key = self.key(a, wall)
        if key not in self._known_float_lines:
            self._known_float_lines[key] = float_line(wall, *self.line(a, wall))
        return self._known_float_lines[key]

    def key(self, a: Body[arb], wall: int) -> tuple[int, int, bool]:
        """A circle's radius, by kind, a wall, and the side of it."""
        return a.kind, wall, self.refinable.balls.sides.negative(a.index, wall)

    def off_rim(self, link: Entry) -> bool:
        """Whether doubles tell a centre at its clock from every point of a pocket's rim."""
        a, pocket = link.ends(self.state)
        return self.filter.apart(a, pocket, self._float_reaches[a.kind][pocket.kind])
