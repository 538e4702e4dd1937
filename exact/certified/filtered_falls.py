"""What a circle meets as it falls, in doubles with a bound on every rounding: walls, faces, circles that stand."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Sequence
from math import inf, isfinite, sqrt
from typing import NamedTuple, cast

from flint import arb

from ...scenarios.numbers.quantity import ZERO
from ...scenarios.scene import Scene
from ..compiled import Doubles, predictions
from ..numbers import ball
from ..replay.contact import Body, Link, is_flat, is_pair
from ..replay.refinable import RefinableState
from ..replay.round_falls import Isolated, falling_zero
from ..simulation.prediction import ArrivalQueue, FloatLine, Outlook
from .filtered import ACCURATE_BITS, BIG, QUICK_BITS, TINY, UNIT, FilteredPredictor

# -- Walls that fall, or move, and faces under gravity.
#
# A state's doubles, and its walls', are off by at most 2u relatively: see filtered.py, which has u, S, V and the bounds
# of walls that stand. In the frame that falls, s after a circle's clock t, the gap is g + a s + k s^2, with k half of
# n.g, m = n.u, and
#
#     g = n.(x - p) - r |n| + (k t - m) t,    a = n.v + 2 k t - m
#
# - k t - m is off by 6u |k| t + 3u |m|: 2u from each number, a rounding of the product and one of the difference;
#   times t, and with the last sum, by 10u |k| t^2 + 6u |m| t. The rest of g is off by less than 9u of its terms. The
#   bound is 32u of all terms.
# - a is off by less than 7u of its terms, n.v, 2 k t and m, in the same way: the bound is 16u of them.
# - D = a^2 - 4 k g is off by 2 |a| times what a is, the square of that, 4 |k| times what g is, and under 4u of its two
#   terms: the bound is twice that, with 8u. Where D is more than four times its bound its root is off by less than
#   the bound over that root: by 1 / 1.8 of it, and a rounding.
# - D, the square of the speed at the line, is the same number at the instant as at the clock. The other of the two
#   zeros is of the other sign of that speed.
# - The zero at which the gap falls is 2 g / (sqrt(D) - a), or (-a - sqrt(D)) / (2 k), whichever does not cancel; in
#   each the numerator's and the denominator's bounds add up, over a denominator that is known to an eighth.
#
# The flight begins at its instant, `late` from its clock at most: a differs there by 2 |k| `late`, g by (|a| + |k|
# `late`) `late`; both are taken twice. A circle that touches the wall at the instant, and comes back to it by the pull
# alone, does so -a/k - `late` after its clock: the two zeros add up to -a/k, and the other is the instant.
#
# Which zero is to come, and what of the signs tells that there is none, is as in `Predictor._fall`, and of faces as in
# `arc_meetings.fall_to_face`. Where along a face the line is met is off by what the place and the speed along it are
# off, as above, and by what the wait is off, over the speed then; products and sums are rounded by 8u of them: twice
# taken.


class FloatFall(NamedTuple):
    """A wall that falls or moves, or a face under gravity, as seen from a circle, in doubles.

    Attributes:
        wall: which it is.
        other: the other side of a segment; -1 without.
        is_face: whether it ends.
        x0, y0, nx, ny, offset: a point at time 0, a normal, r*|n|.
        norm, size: the normal's 1-norm, and the size of the fixed terms of the gap; infinite where nothing is clear.
        half: half of n.g, whose sign is true: negative where gravity pulls towards it.
        drift: n.u, of its velocity.
        bend: half of gravity along it, in the scale of `formulas.face_along`.
    """

    wall: int
    other: int
    is_face: bool
    x0: float
    y0: float
    nx: float
    ny: float
    offset: float
    norm: float
    size: float
    half: float
    drift: float
    bend: float


def float_fall(
    line: FloatLine,
    other: int,
    is_face: bool,
    pulls: tuple[arb, arb, arb],
    zeros: tuple[bool, bool, bool],
    sign: int,
) -> FloatFall:
    """A wall that falls or moves, of its doubles as it stands.

    Args:
        line: as `float_line` gives it.
        other, is_face: see `FloatFall`.
        pulls: half of n.g, n.u, and half of gravity along the line.
        zeros: which of these are zero.
        sign: whether gravity pulls towards it (negative), along it (0), or away.
    """
    half, drift, bend = (0.0 if zero else float(value) for value, zero in zip(pulls, zeros, strict=True))
    norm, size = line.norm, line.size
    for value, told, zero in zip(pulls, (half, drift, bend), zeros, strict=True):
        if not (zero or (value.rel_accuracy_bits() > ACCURATE_BITS and TINY < abs(told) < BIG)):
            norm = size = inf
    if size == inf:
        norm, half = inf, float(sign)
    return FloatFall(line.wall, other, is_face, *line[1:6], norm, size, half, drift, bend)


def falls_in_doubles(
    flight: Doubles, lines: Sequence[FloatFall], flat: float, far: float, stands: Collection[int]
) -> tuple[list[tuple[float, float, int]], list[int]]:
    """Which of several walls that fall or move, or faces under gravity, a circle hits whose flight is new.

    Args:
        flight: its doubles.
        lines: the walls and faces.
        flat, far: see `DoubleFilter.wall_bounds`.
        stands: those that it touches as its flight begins, and does not approach.

    Returns:
        Bounds of the time, and the wall; and those that are unclear.
    """
    if predictions is not None:
        return predictions.falls(flight, lines, flat, far, tuple(stands))
    found: list[tuple[float, float, int]] = []
    unclear: list[int] = []
    for line in lines:
        if line.other in stands:
            continue
        told = fall_in_doubles(flight, line, flat, far, line.wall in stands)
        if isinstance(told, bool):
            if told:
                unclear.append(line.wall)
        else:
            found.append((*told, line.wall))
    return found, unclear


def fall_in_doubles(
    flight: Doubles, line: FloatFall, flat: float, far: float, stands: bool
) -> tuple[float, float] | bool:
    """When a circle meets a wall that falls or moves: bounds; False where it does not, True where that is unclear."""
    x, y, vx, vy, t, late = flight
    _, _, is_face, x0, y0, nx, ny, offset, norm, size, half, drift, bend = line
    lift = half * t
    gap = nx * (x - x0) + ny * (y - y0) - offset + (lift - drift) * t
    speed = nx * vx + ny * vy + (2.0 * lift - drift)
    grown = abs(lift) + abs(drift)
    blur = norm * flat + 32 * UNIT * grown
    blur_gap = 32 * UNIT * size + norm * far + 32 * UNIT * grown * t
    turn = blur + 4.0 * abs(half) * late
    if stands:
        if half >= 0.0:
            return False
        if not speed > 8.0 * turn:
            return True
        wait = speed / -half
        blur_wait = blur / -half + late + 8 * UNIT * wait
    else:
        early = blur_gap + 2.0 * (abs(speed) + turn) * late
        if half >= 0.0 and speed > turn:
            return False
        if is_face and gap < -early and (half >= 0.0 or speed < -turn):
            return False
        if half == 0.0:
            if not (speed < -8.0 * turn and gap > early):
                return True
            wait = gap / -speed
            blur_wait = (blur_gap + wait * blur) / -speed + 8 * UNIT * wait
        else:
            depth = 4.0 * half * gap
            square = speed * speed
            disc = square - depth
            blur_disc = (2.0 * abs(speed) + blur) * blur + 4.0 * abs(half) * blur_gap
            blur_disc = 2.0 * (blur_disc + 8 * UNIT * (square + abs(depth)))
            if disc < -blur_disc and (is_face or half > 0.0):
                return False
            if not disc > 4.0 * blur_disc:
                return True
            if not (gap > early and (half < 0.0 or speed < -turn)) and not (is_face and half < 0.0 and speed > turn):
                return True
            root = sqrt(disc)
            blur_root = blur_disc / root + 4 * UNIT * root
            if speed < 0.0:
                fast = root - speed
                blur_fast = blur_root + blur + 2 * UNIT * fast
                if not fast > 8.0 * blur_fast:
                    return True
                wait = 2.0 * gap / fast
                blur_wait = (2.0 * blur_gap + wait * blur_fast) / fast + 8 * UNIT * wait
            else:
                wait = (speed + root) / (-2.0 * half)
                blur_wait = (blur + blur_root) / (-2.0 * half) + 8 * UNIT * wait
    time = t + wait
    blur_time = 2.0 * blur_wait + 8 * UNIT * (t + wait)
    if not (wait > blur_time + late) or not isfinite(time):
        return True
    if is_face:
        along, slide = (x - x0) * ny - (y - y0) * nx + bend * t * t, vx * ny - vy * nx + 2.0 * bend * t
        arch = bend * wait
        foot, beyond = along + (slide + arch) * wait, nx * nx + ny * ny
        tilt = abs(bend) * t
        blur_slide = norm * flat + 32 * UNIT * tilt
        blur_foot = 32 * UNIT * (size + tilt * t) + norm * far + wait * blur_slide
        fast = abs(slide) + blur_slide + 2.0 * abs(arch) + 2.0 * abs(bend) * blur_time
        blur_foot += fast * 2.0 * blur_wait
        blur_foot = 2.0 * blur_foot + 16 * UNIT * (abs(along) + (abs(slide) + abs(arch)) * wait + beyond)
        if foot < -blur_foot or foot > beyond + blur_foot:
            return False
        if not (foot > blur_foot and foot < beyond - blur_foot):
            return True
    return time - blur_time, time + blur_time


# -- Circles that stand, as one that falls meets them: the first zero at which a quartic falls (see round_falls.py).
#
# With e the way from the peg to the circle, w its velocity, both in true coordinates at the clock, and h half of
# gravity, the gap is |e + w s + h s^2|^2 - R^2 a time s later.
#
# - A component of e is off by less than 4u of the two places and 9u of h t^2: the bound for both is 32u of all these.
# - A component of w is off by less than 3u of the speed and 6u of 2 h t: the bound for both is 16u.
# - At the instant, from which s is reckoned, e differs by |w| `late` + |h| `late`^2, w by 2 |h| `late`: taken twice.
# - So each coefficient is off by what its factors are: a product by |a| times what b is, |b| times what a is, and both
#   of these; R and h are off by 2u; roundings are under 6u of the terms' sizes, in the last but one 8u of 2 |w| |h|.
#   All is taken twice.
#
# The two touch at the instant: then the gap is zero there, and that zero is divided out. Else it must surely be above
# zero at the instant, and what is found is the first zero after that. The time is off by `late`, and by roundings.

NARROW = 2.0**-24
"""Most by which the ends of an interval with a zero may differ, as a share of it; a wider one goes to balls."""


class FloatPeg(NamedTuple):
    """A circle that stands under gravity, as one that falls meets it, in doubles: its body, where it is, the sum of
    radii, infinite where doubles do not tell all that; and half of gravity."""

    body: Body[arb]
    x: float
    y: float
    reach: float
    hx: float
    hy: float


def float_peg(body: Body[arb], x: arb, y: arb, reach: arb, hx: arb, hy: arb) -> FloatPeg:
    """The doubles of short balls; nothing is clear where these do not tell them to a few roundings."""
    numbers = x, y, reach, hx, hy
    px, py, far, gx, gy = (float(number) for number in numbers)
    sharp = all(number.is_zero() or number.rel_accuracy_bits() > ACCURATE_BITS for number in numbers)
    plain = all(number == 0.0 or TINY < abs(number) < BIG for number in (px, py, far, gx, gy))
    true = all((told == 0.0) == number.is_zero() for told, number in zip((px, py, far, gx, gy), numbers, strict=True))
    return FloatPeg(body, px, py, far if sharp and plain and true else inf, gx, gy)


def peg_in_doubles(flight: Doubles, peg: FloatPeg, until: float, stood: bool) -> tuple[float, float] | bool:
    """When a circle falls onto one that stands: bounds; False where it does not before `until`, True where unclear.

    Args:
        flight: its doubles.
        peg: what stands.
        until: a time by which the flight ends, or a little after it.
        stood: whether they touch as the flight begins.
    """
    if predictions is not None:
        return predictions.onto_peg(flight, peg, until, stood)
    end = time_left(flight, until)
    if end <= 0.0:
        return False
    if peg.reach == inf:  # which drops out where they touch as the flight begins
        return True
    seen = seen_from(flight, *peg[1:])
    found = falling_zero(seen.c[1:], seen.off[1:], end) if stood else falling_zero(seen.c, seen.off, end)
    return as_times(flight, found) if isinstance(found, Isolated) else found is not None


class SeenFlight(NamedTuple):
    """A flight as something round sees it that stands, from the flight's clock on.

    Attributes:
        c, off: the gap as a polynomial of the time, and bounds of how far its coefficients are off.
        ex, ey, ux, uy: where the circle is, and its velocity.
        near, fast, pull: the 1-norms of these, and of half of gravity.
        off_e, off_v: bounds of how far a component of the place, and of the velocity, is off.
    """

    c: Doubles
    off: Doubles
    ex: float
    ey: float
    ux: float
    uy: float
    near: float
    fast: float
    pull: float
    off_e: float
    off_v: float


def seen_from(flight: Doubles, px: float, py: float, reach: float, hx: float, hy: float) -> SeenFlight:
    """A flight in doubles, as seen from there; half of gravity is (hx, hy)."""
    x, y, vx, vy, t, late = flight
    wx, wy = hx * t, hy * t
    ex, ey = x - px + wx * t, y - py + wy * t
    ux, uy = vx + 2.0 * wx, vy + 2.0 * wy
    near, fast, pull = abs(ex) + abs(ey), abs(ux) + abs(uy), abs(hx) + abs(hy)
    sunk = abs(wx) + abs(wy)
    off_v = 16 * UNIT * (abs(vx) + abs(vy) + 2.0 * sunk)
    off_e = 32 * UNIT * (abs(x) + abs(y) + abs(px) + abs(py) + sunk * t)
    off_e += 2.0 * late * (fast + off_v + pull * late)
    off_v += 4.0 * pull * late
    c = (
        ex * ex + ey * ey - reach * reach,
        2.0 * (ex * ux + ey * uy),
        ux * ux + uy * uy + 2.0 * (ex * hx + ey * hy),
        2.0 * (ux * hx + uy * hy),
        hx * hx + hy * hy,
    )
    off = (
        4.0 * off_e * (near + off_e) + 16 * UNIT * (near * near + reach * reach),
        4.0 * (off_e * (fast + off_v) + near * off_v) + 16 * UNIT * near * fast,
        4.0 * off_v * (fast + off_v) + 4.0 * pull * off_e + 16 * UNIT * (fast * fast + 2.0 * near * pull),
        4.0 * pull * off_v + 16 * UNIT * fast * pull,
        16 * UNIT * pull * pull,
    )
    return SeenFlight(c, off, ex, ey, ux, uy, near, fast, pull, off_e, off_v)


def time_left(flight: Doubles, until: float) -> float:
    """What a flight can last for from its clock on, that ends by a time, or a little after."""
    t, late = flight[4:]
    return until - t + (late + 8 * UNIT * (until + t))


def as_times(flight: Doubles, zero: Isolated) -> tuple[float, float] | bool:
    """Bounds of a time, of what is reckoned from a flight's clock on; True where they are too far apart."""
    t, late = flight[4:]
    low, high = cast("tuple[float, float]", zero)
    if not high - low <= NARROW * high:
        return True
    low, high = t + low - (late + 8 * UNIT * (t + low)), t + high + (late + 8 * UNIT * (t + high))
    return (low, high) if isfinite(high) else True


class FallingPredictor(FilteredPredictor):
    """Predictions in doubles, then in short balls, under gravity and among walls that move. See `FilteredPredictor`."""

    def __init__(
        self,
        scene: Scene,
        refinable: RefinableState,
        queue: ArrivalQueue[arb],
        plan: Counter[str],
        unsure: Callable[[Link], None],
    ) -> None:
        super().__init__(scene, refinable, queue, plan, unsure)
        self._falls: dict[tuple[int, int, bool], FloatFall] = {}
        self._pegs: dict[int, list[FloatPeg]] = {}

    def at_length(self, moved: Sequence[Body[arb]], standing: Collection[Link], gone: Collection[int]) -> None:
        """See `FilteredPredictor.at_length`."""
        super().at_length(moved, standing, gone)
        self.few = self.few or (self.falling is not None and self.arcs is None and not self.state.pockets)

    def _meet_surfaces(self, moved: Sequence[Body[arb]], standing: Collection[Link]) -> None:
        if self.falling is None:
            super()._meet_surfaces(moved, standing)
            return
        for a in moved:
            a.until = inf
            self._meet_falling(a, range(len(self.scene.walls)), standing)
        for a in moved:
            self._meet_pegs(a, standing)

    def _meet_pegs(self, a: Body[arb], standing: Collection[Link]) -> None:
        """Queues the next meetings of a circle that falls with those that stand."""
        assert a.f is not None
        touched = {i for link in standing if is_pair(link) and a.index in link for i in link}
        for peg in self.pegs_of(a):
            found = peg_in_doubles(a.f, peg, a.until, peg.body.index in touched)
            if isinstance(found, bool):
                if found:
                    self.plan["unclear in doubles"] += 1
                    self.fall_onto(a, peg.body, standing)
            elif found[0] <= a.until:
                self.queue.push_pairs(a, [(*found, peg.body)], ())
                a.until = min(a.until, found[1])

    def fall_onto(self, a: Body[arb], peg: Body[arb], standing: Collection[Link]) -> None:
        """Queues the next meeting of a circle that falls with one that stands, in balls."""
        raise NotImplementedError

    def walls(self, a: Body[arb], walls: Sequence[int], standing: Collection[Link]) -> None:
        """See `Predictor.walls`."""
        if self.falling is None:
            super().walls(a, walls, standing)
        elif a.index in self.state.pegs:
            self.unclear(a, [k for k in walls if k < self.wall_count], standing)
        else:
            self._meet_falling(a, walls, standing)

    def meet_faces(self, a: Body[arb], standing: Collection[Link]) -> None:
        """See `Predictor.meet_faces`."""
        if self.falling is None:
            super().meet_faces(a, standing)
        elif a.index in self.state.pegs:
            self.unclear(a, self.faces, standing)
        else:
            self._meet_falling(a, self.faces, standing)

    def _meet_falling(self, a: Body[arb], walls: Sequence[int], standing: Collection[Link]) -> None:
        """Queues the next hits of a circle with walls that fall or move, and faces under gravity."""
        unclear = [*walls]
        if a.f is not None:
            stands = [link.wall for link in standing if is_flat(link) and link.circle == a.index]
            found, unclear = falls_in_doubles(a.f, self._as_they_fall(a, walls), *self.filter.wall_bounds, stands)
            self.queue.push_walls(a, found, ())
        self.unclear(a, unclear, standing)

    def outlook_of(self, key: tuple[int, int]) -> Outlook[arb]:
        """See `FilteredPredictor.outlook_of`: walls as they fall, and circles that stand aside."""
        found, every, pegs = super().outlook_of(key), range(len(self.scene.walls)), self.scene.pegs
        if self.falling is None:
            return found
        moved = [self.state.bodies[i] for i in dict.fromkeys(key)]
        self.outlooks[key] = found = found._replace(
            others=[[b for b in others if b.index not in pegs] for others in found.others],
            lines=[self._as_they_fall(a, every) for a in moved],
            pegs=[self.pegs_of(a) for a in moved],
        )
        return found

    def _as_they_fall(self, a: Body[arb], walls: Sequence[int]) -> list[FloatFall]:
        """Walls and faces in doubles, with their velocities and what gravity does."""
        keys = [self.key(a, k) for k in walls]
        for key, k in zip(keys, walls, strict=True):
            if key not in self._falls:
                self._falls[key] = self._as_it_falls(a, k, key[2])
        return [self._falls[key] for key in keys]

    def _as_it_falls(self, a: Body[arb], wall: int, negative: bool) -> FloatFall:
        exact, g, first = self.scene.walls[wall], self.scene.gravity or (ZERO, ZERO), self.two_sided.start
        nx, ny = exact.normal
        if negative:
            nx, ny = -nx, -ny
        half, drift, bend = (nx * g[0] + ny * g[1]) / 2, nx * exact.vx + ny * exact.vy, (ny * g[0] - nx * g[1]) / 2
        with ball.precision(QUICK_BITS):
            pulls = ball.constant(half), ball.constant(drift), ball.constant(bend)
        zeros = half.sign() == 0, drift.sign() == 0, bend.sign() == 0
        other = first + ((wall - first) ^ 1) if wall in self.two_sided else -1
        line = self.float_line(a, wall)
        if exact.is_face and exact.moves:  # where along it a circle is goes by its velocity too: not told in doubles
            line = line._replace(norm=inf, size=inf)
        return float_fall(line, other, exact.is_face, pulls, zeros, half.sign())

    def pegs_of(self, a: Body[arb]) -> Sequence[FloatPeg]:
        """The circles that stand under gravity, as one that falls meets them."""
        found = self._pegs.get(a.kind)
        if found is None:
            pegs: list[int] = sorted(self.scene.pegs)
            with ball.precision(QUICK_BITS):
                half = [ball.constant(g / 2) for g in self.scene.gravity or (ZERO, ZERO)]
                found = self._pegs[a.kind] = [self._as_it_stands(a, k, *half) for k in pegs]
        return found

    def _as_it_stands(self, a: Body[arb], peg: int, hx: arb, hy: arb) -> FloatPeg:
        circle, body = self.scene.circles[peg], self.state.bodies[peg]
        found = float_peg(body, ball.constant(circle.x), ball.constant(circle.y), self.reach(a, body), hx, hy)
        return found._replace(reach=inf) if peg in self.scene.moving_ends else found  # left to balls
