"""Predictions of the exact engine at arcs, and at circles that stand under gravity: in doubles, else short balls."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Sequence
from math import inf, isfinite, sqrt
from typing import NamedTuple, TypeAlias, TypeGuard

from flint import arb

from ...scenarios.numbers.quantity import ZERO
from ...scenarios.scene import Scene
from ..compiled import Doubles, predictions
from ..numbers import ball
from ..numbers.system import Undecided
from ..question import Abreast, Approach, Beside, FallsStraight, Gap, Question
from ..replay.contact import AtArc, AtWall, Body, Entry, Link, Pair, Round, is_arc, is_flat, is_pair, name_of
from ..replay.landings import DoubleZero, Landing, face_gone_onto, grazes_of, landing, passes, within_arc
from ..replay.refinable import RefinableState
from ..replay.round_falls import DEEPEST, MOST_PARTS, Started, halves, sharpened_in_doubles, started
from ..replay.state import ReplayState
from ..simulation.arc_meetings import ArcSides, Predicting, face_contact, fall_to_face, predict_falls
from ..simulation.prediction import ArrivalQueue
from .filtered import (
    ACCURATE_BITS,
    BIG,
    QUICK_BITS,
    ROUND_DOWN,
    ROUND_UP,
    TINY,
    UNIT,
    DoubleFilter,
    FilteredPredictor,
)
from .filtered_falls import FallingPredictor, SeenFlight, as_times, seen_from, time_left

Answers: TypeAlias = tuple[Callable[[Question], int | None], Callable[[Question], int]]


class FloatArc(NamedTuple):
    """A side of an arc as circles of one radius meet it, in doubles: which it is, its centre, R, the normal of its
    chord, n.e |R| (see `formulas.arc_range`), and the normal's 1-norm, infinite where doubles do not tell all that."""

    side: int
    x: float
    y: float
    reach: float
    nx: float
    ny: float
    edge: float
    norm: float
    full: bool


def arcs_in_doubles(
    known: DoubleFilter, a: Body[arb], sides: Sequence[FloatArc]
) -> tuple[list[tuple[float, float, int]], list[int]]:
    """Which of several sides of arcs a circle hits: bounds of the time, and the side; the unclear.

    The bounds are those of `pairs`, with a circle at rest whose place is among what S bounds. The two times at
    which the path is at R lie `depth` before and after it is nearest to the centre; each is off by as much. One
    that surely lies before the instant at which the flight begins is none: so is the first of a circle that is
    within R, or flies away. Where the circle is at that time is off by what d is, by what v is over the wait, and
    by what the wait is, times v; products and sums are rounded by 16u of them, twice taken.
    """
    fa = a.f
    found: list[tuple[float, float, int]] = []
    unclear: list[int] = []
    if fa is None:
        return found, [side.side for side in sides]
    for _, x, y, *_ in sides:
        place = max(abs(x), abs(y))
        if place > known.largest:
            known.widen(place, 0.0, 0.0)
    near, slack, *_ = known.pair_bounds
    ax, ay, avx, avy, now, late = fa
    vx, vy = -avx, -avy
    square, wide = vx * vx + vy * vy, abs(vx) + abs(vy)
    loose = 6.0 * slack * wide
    for k, x, y, reach, nx, ny, edge, norm, full in sides:
        dx, dy = x - ax, y - ay
        approach, cross = dx * vx + dy * vy, abs(dx * vy - dy * vx)
        off = near * wide + 10.0 * slack * (abs(dx) + abs(dy))
        if not (square > 100.0 * loose and norm < BIG):
            unclear.append(k)
            continue
        if cross > off and (cross - off) * (cross - off) > (square + loose) * (reach * reach) * ROUND_UP:
            continue
        room = (square - loose) * (reach * reach) * ROUND_DOWN
        if (cross + off) * (cross + off) > room:
            unclear.append(k)
            continue
        speed = sqrt(square)
        doubt = loose / square + 8 * UNIT
        passing = cross / speed
        depth = sqrt(reach * reach - passing * passing)
        ahead = -approach / speed
        off /= speed
        off_passing = off + passing * doubt
        off_depth = (2.0 * passing * off_passing + off_passing * off_passing + 8 * UNIT * reach * reach) / depth
        wait = (ahead - depth if reach > 0.0 else ahead + depth) / speed
        off_wait = (off + off_depth + (abs(ahead) + depth) * (doubt + 4 * UNIT)) / speed + abs(wait) * doubt
        time = now + wait
        off_time = 2.0 * off_wait + 8 * UNIT * (now + abs(wait))
        if wait < -(off_time + late):
            continue
        if not (wait > off_time + late) or not isfinite(time):
            unclear.append(k)
            continue
        if not full:
            px, py = dx + vx * wait, dy + vy * wait
            within = -(nx * px + ny * py) - edge
            blur = norm * (near + wait * slack + wide * off_time)
            blur = 2.0 * blur + 64 * UNIT * (norm * (abs(dx) + abs(dy) + wide * wait) + abs(edge))
            if within < -blur:
                continue
            if not within > blur:
                unclear.append(k)
                continue
        found.append((time - off_time, time + off_time, k))
    return found, unclear


SideNumbers: TypeAlias = tuple[arb, arb, arb, arb, arb, arb, arb]
"""See `ArcSides.numbers`."""


class ShortArcSides(ArcSides[arb]):
    """The sides of arcs in short balls: the same for all circles of one radius."""

    def __init__(self, scene: Scene, state: ReplayState[arb], of: FilteredPredictor) -> None:
        super().__init__(scene, state)
        self._filter, self._queue, self._plan = of.filter, of.queue, of.plan
        self._known: dict[tuple[int, int], SideNumbers] = {}
        self._doubles: dict[tuple[int, int], FloatArc] = {}

    def meet(self, a: Body[arb], standing: Collection[Link], predictor: Predicting[arb]) -> None:
        """See `ArcSides.meet`."""
        found, unclear = arcs_in_doubles(self._filter, a, [self._in_doubles(a, k) for k in self.of(a, standing)])
        for low, high, k in found:
            self._queue.push(low, high, None, AtArc(a.index, k))
        if unclear:
            self._plan["unclear in doubles"] += len(unclear)
            predictor.prepare()
            for k in unclear:
                self.meet_one(a, AtArc(a.index, k), predictor)

    def _in_doubles(self, a: Body[arb], link: AtArc) -> FloatArc:
        key = a.kind, link.arc
        found = self._doubles.get(key)
        if found is None:
            found = self._doubles[key] = self.in_doubles(link)
        return found

    def numbers(self, link: AtArc) -> SideNumbers:
        """See `ArcSides.numbers`."""
        key = self.state.bodies[link.circle].kind, link.arc
        found = self._known.get(key)
        if found is None:
            side = self.scene.arc_sides[link.arc]
            reach = self.scene.circles[link.circle].r + side.r
            with ball.precision(QUICK_BITS):
                exact = (side.x, side.y, reach, side.r, side.nx, side.ny, side.h * abs(reach))
                x, y, far, r, nx, ny, edge = (ball.constant(number) for number in exact)
            found = self._known[key] = x, y, far, r, nx, ny, edge
        return found

    def in_doubles(self, link: AtArc) -> FloatArc:
        """A side in doubles; nothing is clear where these do not tell it to a few roundings."""
        numbers = self.numbers(link)
        x, y, reach, _, nx, ny, edge = (float(number) for number in numbers)
        sharp = all(number.is_zero() or number.rel_accuracy_bits() > ACCURATE_BITS for number in numbers)
        plain = all(number == 0.0 or TINY < abs(number) < BIG for number in (x, y, reach, nx, ny, edge))
        norm = abs(nx) + abs(ny) if sharp and plain and reach != 0.0 else inf
        return FloatArc(link.arc, x, y, reach, nx, ny, edge, norm, self.scene.arc_sides[link.arc].full)


# -- Arcs, and rims of pockets, as a circle that falls comes to them: see landings.py for which zero is a meeting.
#
# The gap is that of a circle that stands, with the bounds of filtered_falls.py; within R it is taken negatively. So
# many seconds s after the clock the circle is e + w s + h s^2 from the middle; as far as |R| away from it, it is within
# the range where n.(e + w s + h s^2) > n.e |R|. That is off by what e is, and s times what w is; by 2u of h s^2, of n
# and of the edge, and at most 12 roundings of the sizes of all these; and between two times from what it is in their
# middle by half of their distance, times |n| (|w| + 2 |h| s). All is taken twice.


class FallenSide(NamedTuple):
    """A side of an arc as circles of one radius meet it that fall, in doubles, or a rim: which it is, whether it goes
    all around, its middle, R, half of gravity, and as `FloatArc` has it the normal of its chord, n.e |R|, and the
    normal's 1-norm, infinite where doubles do not tell all that."""

    side: int
    full: bool
    x: float
    y: float
    reach: float
    hx: float
    hy: float
    nx: float
    ny: float
    edge: float
    norm: float


def within_in_doubles(seen: SeenFlight, side: FallenSide, low: float, high: float) -> bool | None:
    """Whether a circle, as far away as a side is, is within its range at all of some times; False: at none; or None."""
    if side.full:
        return True
    _, _, _, _, _, hx, hy, nx, ny, edge, norm = side
    s, spread = 0.5 * (low + high), 0.5 * (high - low) + 4 * UNIT * high
    x, y = seen.ex + (seen.ux + hx * s) * s, seen.ey + (seen.uy + hy * s) * s
    found = nx * x + ny * y - edge
    off = norm * (seen.off_e + high * seen.off_v)
    off += norm * (seen.fast + seen.off_v + 2.0 * seen.pull * high) * spread
    off += 32 * UNIT * (norm * (seen.near + (seen.fast + seen.pull * high) * high) + abs(edge))
    off *= 2.0
    return True if found > off else False if found < -off else None


def side_in_doubles(flight: Doubles, side: FallenSide, until: float, stood: bool) -> tuple[float, float] | bool:
    """When a circle falls onto a side of an arc, or through a rim; as `peg_in_doubles`."""
    if predictions is not None:
        return predictions.onto_side(flight, side, until, stood)
    end = time_left(flight, until)
    if end <= 0.0:
        return False
    if side.norm == inf:
        return True
    seen = seen_from(flight, *side[2:7])
    c, off = seen.c, seen.off
    if side.reach < 0.0:
        c = tuple(-value for value in c)
    if stood:
        c, off = c[1:], off[1:]
    if not (all(map(isfinite, c)) and all(map(isfinite, off))):
        return True
    begun = started(c, off, end)
    if not isinstance(begun, Started):
        return begun is not None
    stack, parts = [(0.0, begun.top, begun.b, 0)], 0
    while stack:
        low, high, b, depth = stack.pop()
        above = int(b[0] > 0.0)
        changes = begun.changes(b, depth, 1 if above else -1)
        if changes == 0 or (changes == 1 and not above):
            continue
        if changes == 1:
            zero = sharpened_in_doubles(c, off, low, high)
            within = within_in_doubles(seen, side, float(zero.low), float(zero.high))
            if within is False:
                continue
            return as_times(flight, zero) if within else True
        if within_in_doubles(seen, side, low, high) is False:
            continue
        parts += 1
        if depth >= DEEPEST or parts > MOST_PARTS:
            return True
        stack += halves(low, high, b, depth)
    return False


class ArcPredictor(FallingPredictor):
    """Predictions in doubles, then in short balls, of scenes with arcs. See `FilteredPredictor`."""

    def __init__(
        self,
        scene: Scene,
        refinable: RefinableState,
        queue: ArrivalQueue[arb],
        plan: Counter[str],
        unsure: Callable[[Link], None],
    ) -> None:
        super().__init__(scene, refinable, queue, plan, unsure)
        self.arcs = ShortArcSides(scene, refinable.balls, self)


class PegPredictor(FallingPredictor):
    """Predictions of scenes in which something round stands under gravity. See `FilteredPredictor`."""

    def __init__(
        self,
        scene: Scene,
        refinable: RefinableState,
        queue: ArrivalQueue[arb],
        plan: Counter[str],
        unsure: Callable[[Link], None],
    ) -> None:
        super().__init__(scene, refinable, queue, plan, unsure)
        self._sides: dict[tuple[int, int, bool], FallenSide] = {}

    def predict(self, moved: Sequence[Body[arb]], standing: Collection[Link], gone: Collection[int]) -> None:
        """See `Predictor.predict`; in one go where what stands at gap zero as flights begin is what was pushed."""
        pegs, on_peg = self.scene.pegs, self.state.on_peg
        known = {link for link in standing if on_peg(link)}
        plain = self.state.pegs == pegs and not pegs.intersection(a.index for a in moved)
        if plain and all(self._stood(a) == {link for link in known if a.index in link.circles} for a in moved):
            super().predict(moved, standing, gone)
        else:
            self.at_length(moved, standing, gone)

    def _stood(self, a: Body[arb]) -> set[Link]:
        """The contacts with circles that stand at which a circle's flight begins, by an impulse."""
        at, links = self.state.contacts.get(a.index, (-1, dict[Link, int]()))
        return {link for link in links if self.state.on_peg(link)} if at == a.flight.last else set()

    def at_length(self, moved: Sequence[Body[arb]], standing: Collection[Link], gone: Collection[int]) -> None:
        """See `FilteredPredictor.at_length`."""
        self.few = not self.state.pockets
        predict_falls(self, moved, standing, gone, self._walls_of)

    def face(self, a: Body[arb], wall: int, standing: Collection[Link]) -> None:
        """See `Predictor.face`."""
        if a.index in self.state.pegs:
            super().face(a, wall, standing)
        else:
            fall_to_face(self, a, wall, standing, rounded=False)

    def falls_to_face(self, link: Link) -> TypeGuard[AtWall]:
        """Whether a contact is with a face, of a circle that nothing carries."""
        return is_flat(link) and link.wall in self.faces and link.circle not in self.state.pegs

    def face_unsure(
        self,
        link: AtWall,
        sign: Callable[[Question], int | None],
        decide: Callable[[Question], int],
        overlap: Callable[[Link], None],
    ) -> int | None:
        """Whether a circle meets a face, where short balls do not tell: as `face_contact`, in full ones.

        Where gravity pulls along the face's line a circle at that line may slide along it, which is noted.

        Args:
            sign: the sign of a question in full balls.
            decide: the sign by whatever it takes.
            overlap: told of a circle that has come to a face unseen.
        """
        pull, approach, gap = self.state.sides.pull(*link[:2]), Approach(link), Gap(link)
        if not pull and not sign(approach) and not sign(gap) and decide(gap) == 0 == decide(approach):
            self.slides.append(link)
            return -1
        found = face_contact(link, pull, sign)
        at_line = found == -1 and sign(gap) == 0 and sign(approach) == -1
        if at_line and all(sign(Beside(link, far, None)) == 1 for far in (False, True)):
            overlap(link)
        return found

    def face_settled(
        self, link: AtWall, sign: Callable[[Question], int | None], decide: Callable[[Question], int]
    ) -> int | None:
        """As `face_unsure`, once it would come next: what full balls leave open is decided."""
        pull = self.state.sides.pull(*link[:2])
        found = face_contact(link, pull, sign)
        return face_contact(link, pull, decide) if found is None else found

    def fall_onto(self, a: Body[arb], peg: Body[arb], standing: Collection[Link]) -> None:
        """See `FallingPredictor.fall_onto`."""
        self.land(a, Pair(*sorted((a.index, peg.index))), standing)

    def land(self, a: Body[arb], link: Round, standing: Collection[Link]) -> None:
        """See `Predictor.land`."""
        state = self.refinable.balls
        stood = state.stood(link)
        if link in standing and not stood:
            raise Undecided(
                f"{name_of(self.scene, link)} touch at one instant with other contacts, and not by an impulse of their "
                "own: what comes then, under gravity, is not decided"
            )
        if a.f is not None and not is_pair(link) and stood < 2:
            times = side_in_doubles(a.f, self._side(a, link), a.until, bool(stood))
            if not isinstance(times, bool):
                self._land_at(a, link, *times, None)
                return
            if not times:
                return
            self.plan["unclear in doubles"] += 1
        self.prepare()
        flight = a.flight
        end = inf if a.until == inf else (a.until - ball.double_bounds(flight.instant)[0]) * (1 + 2.0**-40)
        if end <= 0.0:
            return
        found = landing(state, link, end)
        if isinstance(found, arb):
            time = flight.t + found
            self._land_at(a, link, *self.bounds(time), time)
        elif found is not None:
            self.plan["unclear in doubles"] += 1
            self.unsure(link)

    def _land_at(self, a: Body[arb], link: Round, low: float, high: float, time: arb | None) -> None:
        """Queues a landing between two times, which ends a flight where it pushes."""
        if low <= a.until:
            self.queue.push(low, high, time, link)
            a.until = min(a.until, high) if link.pushes else a.until

    def _side(self, a: Body[arb], link: AtArc | Entry) -> FallenSide:
        """A side of an arc, or a rim, as a circle meets it that falls."""
        key = (a.kind, link.arc, True) if is_arc(link) else (a.kind, link.pocket, False)
        found = self._sides.get(key)
        if found is None:
            found = self._sides[key] = self._as_side(link)
        return found

    def _as_side(self, link: AtArc | Entry) -> FallenSide:
        """The doubles of short balls; nothing is clear where these do not tell them to a few roundings."""
        scene, g = self.scene, self.scene.gravity or (ZERO, ZERO)
        half = g[0] / 2, g[1] / 2
        if is_arc(link):
            side = scene.arc_sides[link.arc]
            reach = scene.circles[link.circle].r + side.r
            exact = (side.x, side.y, reach, *half, side.nx, side.ny, side.h * abs(reach))
            name, full = link.arc, side.full
        else:
            rim = scene.pockets[link.pocket]
            exact, name, full = (rim.x, rim.y, rim.r, *half, ZERO, ZERO, ZERO), ~link.pocket, True
        with ball.precision(QUICK_BITS):
            numbers = [ball.constant(number) for number in exact]
        doubles = [float(number) for number in numbers]
        sharp = all(number.is_zero() or number.rel_accuracy_bits() > ACCURATE_BITS for number in numbers)
        plain = all(number == 0.0 or TINY < abs(number) < BIG for number in doubles) and doubles[2] != 0.0
        true = all((told == 0.0) == number.is_zero() for told, number in zip(doubles, numbers, strict=True))
        norm = abs(doubles[5]) + abs(doubles[6]) if sharp and plain and true else inf
        x, y, far, hx, hy, nx, ny, edge = doubles
        return FallenSide(name, full, x, y, far, hx, hy, nx, ny, edge, norm)

    def in_full(self, link: Round) -> Landing:
        """When a circle falls onto something round that stands, in full balls; what is known of it."""
        state = self.refinable
        ball.use_bits(state.bits)
        state.sync(link.circles)
        found = landing(state.balls, link, inf)
        return state.balls.faller(link).flight.t + found if isinstance(found, arb) else found

    def off_rim(self, link: Entry) -> bool:
        """Nothing is plain before it is asked: doubles are of the frame that falls."""
        return False

    def comes(self, link: Round, exactly: Answers | None) -> tuple[Landing, bool]:
        """When a circle comes to something round, and whether it grazes it; None where it does neither.

        Further grazes of one flight are queued.

        Args:
            link: the two.
            exactly: where it is asked whether the two graze: what answers questions where balls do, and in full.

        Raises:
            Undecided: where it grazes an end from which it may go onto a face.
        """
        state, found = self.refinable, self.in_full(link)
        if found is None or isinstance(found, arb) or exactly is None:
            return found, False
        if state.field is None or not all(state.exact[i] for i in link.circles if i not in self.scene.pegs):
            touched = None
        else:
            touched = passes(state.field, link)
        if touched is None:
            times = self.passes_straight(link, *exactly)
            return (found, False) if times is None else (self.grazed(link, times), True)
        if not touched or state.field is None:
            return None, False
        if (face := face_gone_onto(state.field, link)) is not None:
            circle = next(i for i in link.circles if i not in self.scene.ends)
            raise Undecided(
                f"whether {name_of(self.scene, AtWall(circle, face))} touch and stay so: the circle comes to an end of "
                "the face along its tangent, at a double zero of a quartic, after which no law of a blow tells more"
            )
        ball.use_bits(state.bits)
        return self.grazed(link, grazes_of(state.field, link)), True

    def passes_straight(
        self, link: Round, sign: Callable[[Question], int | None], decide: Callable[[Question], int]
    ) -> list[arb] | None:
        """When a circle that passes what is round along gravity, as far from it as at a contact, touches it; None where
        that is not proved.

        Its gap is then the square of how far it is from it along gravity, in whatever numbers.

        Args:
            link: the two.
            sign: answers a question where balls do.
            decide: answers it in full, or raises `Undecided`.
        """
        for question in FallsStraight(link), Abreast(link):
            if sign(question) not in (0, None):
                return None
            try:
                if decide(question):
                    return None
            except Undecided:
                return None
        state = self.refinable.balls
        ball.use_bits(self.refinable.bits)
        fall, begun = state.peg_fall(link), link.later(state).flight.instant
        along, speed, pull = (fall.hx * x + fall.hy * y for x, y in ((fall.dx, fall.dy), (fall.vx, fall.vy), fall[4:6]))
        square = speed * speed + 4 * pull * along
        if (real := ball.sign_of(square)) != 1:
            return [] if real == -1 else None
        clock, root = state.faller(link).flight.t, square.sqrt()
        times = [clock + (speed + turn * root) / (2 * pull) for turn in (-1, 1)]
        signs = [ball.sign_of(time - begun) for time in times]
        if {0, None} & {*signs}:
            return None
        left = [time for time, sign in zip(times, signs, strict=True) if sign == 1]
        if not link.hollow:
            return left
        beyond = is_arc(link) and all(self._grazes_within(link, time) == -1 for time in left)
        return [] if beyond else None  # its gap is minus that square: what is in the range, or at its end, is across

    def grazed(self, link: Round, zeros: Sequence[DoubleZero | arb]) -> Landing:
        """The first of the times at which two graze, none, or that it is unclear; the others are queued."""
        ranged = is_arc(link) and not self.scene.arc_sides[link.arc].full
        times: list[arb] = []
        for zero in zeros:
            within = self._grazes_within(link, zero) if ranged and is_arc(link) else 1
            if within is None:
                return self.in_full(link)
            times += [zero.in_ball() if isinstance(zero, DoubleZero) else zero] * (within == 1)
        for time in times[1:]:
            self.push(time, link, graze=True)
        return times[0] if times else None

    def _grazes_within(self, link: AtArc, zero: DoubleZero | arb) -> int | None:
        """Whether a side of an arc is grazed within its range, 1, or not; right at its end the end is grazed."""
        state, field = self.refinable, self.refinable.field
        if isinstance(zero, DoubleZero) and not zero.q and field is not None:
            then = field.peg_fall(link).after(zero.p - field.faller(link).flight.t)
            return ball.field_sign(within_arc(field, link, then.dx, then.dy))
        time = zero.in_ball() if isinstance(zero, DoubleZero) else zero
        then = state.balls.peg_fall(link).after(time - state.balls.faller(link).flight.t)
        return ball.sign_of(within_arc(state.balls, link, then.dx, then.dy))

    def push_unsure(self, link: Round) -> None:
        """Queues one that short balls leave open, as full ones have it."""
        found = self.in_full(link)
        if isinstance(found, arb):
            self.push(found, link)
        elif found is not None:
            begun = self.refinable.balls.faller(link).flight.instant
            self.queue.push_doubtful(ball.double_bounds(begun + arb(found.since))[0], link)


def predictor_of(
    scene: Scene, state: RefinableState, queue: ArrivalQueue[arb], plan: Counter[str], unsure: Callable[[Link], None]
) -> tuple[FilteredPredictor, PegPredictor | None]:
    """What predicts the meetings of a scene, and again, where circles fall onto what is round and stands.

    Args:
        scene, state, queue, plan, unsure: see `FilteredPredictor`.
    """
    given = scene, state, queue, plan, unsure
    if state.balls.stands:
        pegs = PegPredictor(*given)
        return pegs, pegs
    return ArcPredictor(*given) if scene.arc_sides else FallingPredictor(*given), None
