"""The number that decides at a divergence: which meeting comes first, or whether two meet; and how a run has it."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from flint import arb

from ...exact.laws import formulas as law
from ...exact.laws.formulas import pair_discriminant, pair_gap
from ...exact.numbers import ball
from ...exact.replay.contact import WallFall
from ...exact.replay.landings import told_falling_zero
from ...exact.replay.parts import NearestPart, PartsNear
from ...exact.replay.round_falls import RoundFall
from ...exact.replay.wall_flights import fall_of
from ...floating.knots import DoubleMotion, SteppedFall
from ...scenarios.numbers.quantity import ZERO, Quantity, real
from ...scenarios.surfaces import ThingParts, parts_of
from ..tangent.flight_aside import middle as _middle
from ..tangent.flight_aside import out_of, stretches
from .free_flights import (
    FlightBalls,
    OwnFlight,
    Relative,
    Row,
    ThingFall,
    apart_at,
    exact_flight,
    fall_onto,
    fall_wait,
    fallen,
    flown,
    is_zero,
    last_step,
    meeting_time,
    nearest_fall,
    resting,
    risen,
    seen_from,
    sides_of,
    times_at,
    wall_margin,
    wall_wait,
)
from .given_scene import RoundedState, nearest

if TYPE_CHECKING:
    from ...scenarios.trajectory import State, Trajectory
    from ..alignment.walk import Walk


# -- what was decided


FIRST_BITS, MOST_BITS = 256, 1 << 14
"""Precision at which a decision is first looked at, and the most: beyond it is called zero to so many bits."""


@dataclass(frozen=True)
class Pairing:
    """A body and a partner, each as its last meeting before the decision left it.

    Attributes:
        body, partner: ids; the partner may be a wall, a fixed circle, or a pocket, whose rim the centre comes to.
        anchors: for each movable one of the two, the reference's event that is its last before; None: the start.
    """

    body: str
    partner: str
    anchors: Mapping[str, int | None]


@dataclass(frozen=True)
class DecidingNumber:
    """What was decided, as one number whose sign is the answer.

    Attributes:
        kind: `hit`: the least distance of the two surfaces in free flight, negative for the depth of a hit;
            `order`: the time of the second meeting less that of the first.
        first: the pairing whose hit is in question, or the meeting that comes first in the reference.
        second: for an order, the other meeting.
        rival: for a hit that one of the two runs has, the meeting that the other has instead: a hit that comes after
            that is as good as a miss.
        rival_time: when that comes, in the run that has it.
    """

    kind: Literal["hit", "order"]
    first: Pairing
    second: Pairing | None = None
    rival: Pairing | None = None
    rival_time: float = math.inf

    @property
    def pairings(self) -> list[Pairing]:
        """What it is between."""
        return [self.first] if self.second is None else [self.first, self.second]


def answer(decision: DecidingNumber, value: arb | None) -> int | None:
    """What a value decides: its sign; for a hit, a touch without depth is a miss. None if it is not known."""
    if value is None:
        return None
    sign = ball.sign_of(value)
    if decision.kind == "hit" and sign == 0:
        return 1
    return sign


# -- how one run has it


class RunReader:
    """Reads flights and decisions off one run.

    Under gravity, and where walls move, numbers are those of the frame that falls with the scene as the run has it.

    Args:
        run: the run.
        walks: how its meetings were matched with the reference's; None for the reference itself.
        rounds_to: to how many bits it rounds walls and radii; None: not at all.
        turned_after: number of the reference's events before its reversal, if that lies before the decision.
        until: when the decision comes: a flight is read as the run has it just before.
    """

    def __init__(
        self,
        run: Trajectory,
        walks: Mapping[str, Walk] | None = None,
        rounds_to: int | None = None,
        turned_after: int | None = None,
        until: float = 0.0,
    ) -> None:
        self.run = run
        self.scene = run.scene.surfaces
        more = len(run.scene.surfaces.ends)
        count = len(run.scene.circles)
        self.places = {str(name): k if k < count else k + more for k, name in enumerate(run.scene.ids)}
        self._parts = {str(run.scene.ids[place]): (place, parts) for place, parts in parts_of(run.scene).items()}
        self._walls = {str(wall.id) for wall in run.scene.walls}
        self.pockets = {str(pocket.id): k for k, pocket in enumerate(run.scene.pockets)}
        self._rounds_to = rounds_to
        self.turned_after, self._until = turned_after, until
        self._events = None if walks is None else {name: dict(walked.pairs) for name, walked in walks.items()}
        self._things: dict[int, RoundedState] = {}
        self._states: dict[int, State] = {}
        self._numbers: dict[tuple[str, int | None, bool, int], FlightBalls] = {}

    def follows(self, pairing: Pairing) -> bool:
        """Whether the run has every meeting that leads to a pairing."""
        return all(anchor is None or self._event(name, anchor) is not None for name, anchor in pairing.anchors.items())

    def _event(self, name: str, anchor: int) -> int | None:
        return anchor if self._events is None else self._events.get(name, {}).get(anchor)

    def flight(self, name: str, anchor: int | None, *, turned: bool) -> OwnFlight | None:
        """A circle as its last meeting left it; None if the run does not have that meeting.

        Args:
            turned: whether the velocities were negated since.
        """
        index = None if anchor is None else self._event(name, anchor)
        if anchor is not None and index is None:
            return None
        reversal = self.run.reversal
        if turned and reversal is not None:
            time, key = reversal.time, -2
        else:
            time, key = (Quantity.of(0), -1) if index is None else (self.run.events[index].time, index)
        if key not in self._states:
            self._states[key] = self.run.at(time) if index is None or key == -2 else self.run.after(index)
        state = self._states[key][name]
        if self._until and isinstance(self.run.motion, DoubleMotion):
            motion, k = self.run.motion, self.places[name]
            knots = motion.knots[k]
            last = max((n for n, knot in enumerate(knots) if float(time) < knot[0] < self._until), default=None)
            if isinstance(motion, SteppedFall):  # no step has it where the exact law does
                at = last_step(motion, float(time) if last is None else knots[last][0], self._until)
                if at is not None:
                    return OwnFlight(*map(real, (at, *motion.state(at)[k])))
            if last is not None:
                return OwnFlight(*map(real, knots[last][:5]))
        return OwnFlight(time, state.x, state.y, state.vx, state.vy)

    def value(self, decision: DecidingNumber, bits: int = FIRST_BITS) -> arb | None:
        """The number that decides, as a ball of a sign that is known if it can be; None if the run does not come to it.

        A hit that the other meeting's pair does not have at all leaves an order without a value.
        """
        while True:
            with ball.precision(2 * bits):
                found = self._value(decision, bits)
            if found is None or ball.sign_of(found) is not None or bits >= MOST_BITS:
                return found
            bits *= 4

    def _value(self, decision: DecidingNumber, bits: int) -> arb | None:
        if decision.kind == "hit":
            return self.least_gap(decision.first, bits)
        assert decision.second is not None
        one, other = self.hit_time(decision.first, bits), self.hit_time(decision.second, bits)
        return None if one is None or other is None else other - one

    # -- one pairing

    def read_ahead(self, found: Sequence[DecidingNumber], bits: int = FIRST_BITS) -> None:
        """Reads the flights of some decisions in the order of the log, which is then replayed once for all."""
        pairings = [pairing for d in found for pairing in (d.first, d.second) if pairing is not None]
        flights = [
            (-1 if anchor is None else anchor, k, name)
            for k, p in enumerate(pairings)
            for name, anchor in p.anchors.items()
        ]
        for _, k, name in sorted(flights):
            self.numbers(pairings[k], name, bits)

    def numbers(self, pairing: Pairing, name: str, bits: int) -> FlightBalls | None:
        """t, x, y, vx, vy of one of the two as its flight has them; None if the run does not have that flight."""
        key = name, pairing.anchors.get(name), self._turned(pairing), bits
        if key not in self._numbers:
            flight = self.flight(*key[:2], turned=key[2])
            if flight is None:
                return None
            t, x, y, vx, vy = (real(v).ball(bits) for v in (flight.t, flight.x, flight.y, flight.vx, flight.vy))
            with ball.precision(2 * bits):
                self._numbers[key] = fallen(self.things(bits).falling, (t, x, y, vx, vy))
        return self._numbers[key]

    def _relative(self, pairing: Pairing, bits: int, end: int | None = None) -> Relative | None:
        """t, d, v and R of two circles at the later of their flights' times; or of a circle and an end, or a pocket."""
        pocket = self.pockets.get(pairing.partner)
        if end is not None or pocket is not None:
            flight = self.numbers(pairing, pairing.body, bits)
            if flight is None:
                return None
            (t, x, y, vx, vy), things = flight, self.things(bits)
            other = things.bodies[end] if end is not None else things.pockets[pocket or 0]
            there, reach = other.flight, things.reach(things.bodies[self.places[pairing.body]], other)
            return t, there.x - x, there.y - y, -vx, -vy, reach
        one, other = self.numbers(pairing, pairing.body, bits), self.numbers(pairing, pairing.partner, bits)
        if one is None or other is None:
            return None
        (at, ax, ay, avx, avy), (bt, bx, by, bvx, bvy) = one, other
        later = at if ball.sign_of(at - bt) in (0, 1) else bt
        ax, ay = law.advance(ax, avx, later - at), law.advance(ay, avy, later - at)
        bx, by = law.advance(bx, bvx, later - bt), law.advance(by, bvy, later - bt)
        bodies = self.things(bits).bodies
        reach = bodies[self.places[pairing.body]].r + bodies[self.places[pairing.partner]].r
        return later, bx - ax, by - ay, bvx - avx, bvy - avy, reach

    def _turned(self, pairing: Pairing) -> bool:
        """Whether the reversal lies between the last meetings and the decision."""
        reversal = self.run.reversal
        if reversal is None or self.turned_after is None:
            return False
        return all(anchor is None or anchor < self.turned_after for anchor in pairing.anchors.values())

    def _wall(self, pairing: Pairing, bits: int, face: int | None = None) -> tuple[arb, WallFall[arb], arb] | None:
        """t, the gap to a wall, or to a face, the approach to it, half of the pull, and the length of the normal."""
        flight = self.numbers(pairing, pairing.body, bits)
        if flight is None:
            return None
        t, x, y, vx, vy = flight
        circle, things = self.places[pairing.body], self.things(bits)
        wall = self.places[pairing.partner] - len(self.scene.circles) if face is None else face
        line = things.line(circle, wall)
        offset = things.bodies[circle].r * line.length
        if things.falling is None:
            gap = law.wall_gap(x, y, line.x0, line.y0, line.nx, line.ny, offset)
            return t, WallFall(gap, law.wall_approach(vx, vy, line.nx, line.ny), arb(0)), line.length
        drift = things.drifts.get(wall)
        return t, fall_of(things.falling, (x, y, vx, vy, t), line, offset, drift, things.zero), line.length

    def things(self, bits: int) -> RoundedState:
        """Radii and walls as the run has them."""
        if bits not in self._things:
            with ball.precision(2 * bits):
                self._things[bits] = RoundedState(self.run.scene, self._rounds_to)
        return self._things[bits]

    def is_wall(self, pairing: Pairing) -> bool:
        """Whether the partner is a wall."""
        return pairing.partner in self._walls

    def hit_time(self, pairing: Pairing, bits: int = FIRST_BITS) -> arb | None:
        """When the two touch in free flight; None if they do not, or if it is not known."""
        parts = self.parts_of(pairing)
        if (thing := _thing_fall(self, pairing, bits)) is not None:
            late = thing.wait()
            return None if late is None else thing.row[0] + late
        if parts is not None:
            return min(self._part_times(pairing, parts, bits, leaving=False), key=_middle, default=None)
        if self.is_wall(pairing):
            told = self._wall(pairing, bits)
            wait = None if told is None else wall_wait(told[1], pull_of(self, pairing))
            return None if told is None or wait is None else told[0] + wait
        if _is_on_peg(self, pairing):
            fall = _fall_of(self, pairing, bits)
            late = None if fall is None else fall_wait(fall[1])
            return None if fall is None or late is None else fall[0] + late
        relative = self._relative(pairing, bits)
        return None if relative is None else meeting_time(relative)

    def parts_of(self, pairing: Pairing) -> ThingParts | None:
        """The faces and ends of the partner, if it has any."""
        known = self._parts.get(pairing.partner)
        return None if known is None else known[1]

    def _part_times(self, pairing: Pairing, parts: ThingParts, bits: int, *, leaving: bool) -> list[arb]:
        """When a circle touches each of the faces and ends that it comes to, or leaves them if neither pushes."""
        flight = self.numbers(pairing, pairing.body, bits)
        return (
            []
            if flight is None
            else times_at(self.things(bits), self.places[pairing.body], flight, parts, leaving=leaving)
        )

    def _nearest(self, pairing: Pairing, bits: int, time: arb | None = None) -> NearestPart[arb] | None:
        """The face or end of its partner that a circle is nearest to, as its flight begins or at a time."""
        flight = self.numbers(pairing, pairing.body, bits)
        if flight is None:
            return None
        if time is not None:
            flight = flown(flight, time)
        parts = self.parts_of(pairing)
        pace = None if parts is None else _pace_of(self.things(bits), parts)
        _, x, y, vx, vy = risen(self.things(bits).falling, seen_from(flight, pace))
        near = PartsNear(self.run.scene, ball.BALLS, self.things(bits))
        return near.part(self.places[pairing.body], self._parts[pairing.partner][0], x, y, vx, vy)

    def _beside(self, pairing: Pairing, parts: ThingParts, bits: int) -> arb | None:
        """How far aside a circle's straight flight passes a thing; negative: how far it has to be moved to do so.

        What the thing covers of a line across the flight goes from end to end; a point of the flight is within the
        circle's radius of that or beside it.
        """
        sides: list[tuple[arb, arb]] = []
        for end in parts.ends:
            relative = self._relative(pairing, bits, end)
            if relative is None:
                return None
            _, dx, dy, vx, vy, reach = relative
            offset = (dx * vy - dy * vx) / ball.root(vx * vx + vy * vy)
            sides.append((offset - reach, offset + reach))
        low, high = sides[0]
        for one, other in sides[1:]:
            low, high = low.min(one), high.max(other)
        aside = low.max(-high)
        if ball.sign_of(aside) is None:
            unclear = [
                end
                for end, (one, other) in zip(parts.ends, sides, strict=True)
                if ball.sign_of(one) is None or ball.sign_of(other) is None
            ]
            if all(self._proves(pair_discriminant, pairing, end) for end in unclear):
                return arb(0)
        return aside

    def _ahead(self, pairing: Pairing, parts: ThingParts, bits: int) -> arb | None:
        """As `_beside`, of a thing that is not convex: of what is ahead and approached; None where nothing is."""
        flight = self.numbers(pairing, pairing.body, bits)
        if flight is None or not (_middle(flight[3]) or _middle(flight[4])):
            return None
        things, circle = self.things(bits), self.places[pairing.body]
        bodies = things.bodies
        seen = stretches(
            flight[1:],
            bodies[circle].r,
            [things.line(circle, face) for face in parts.faces],
            [(end, *bodies[end].flight[:2], bodies[end].r) for end in parts.ends],
            sides_of(things, circle, parts),
        )
        passed = out_of(seen)
        if passed is None or ball.sign_of(passed.aside) is not None:
            return None if passed is None else passed.aside
        unclear = [s for s in seen if ball.sign_of(s.low) is None or ball.sign_of(s.high) is None]
        grazes = all(s.end is not None and self._proves(pair_discriminant, pairing, s.end) for s in unclear)
        return arb(0) if grazes else passed.aside

    def stay(self, pairing: Pairing) -> tuple[float, float] | None:
        """From when to when two circles, or a circle and a wall's line, would overlap if neither pushed."""
        if (thing := _thing_fall(self, pairing, FIRST_BITS)) is not None:
            over = thing.stay()
            return None if over is None else (float(over[0]), float(over[1]))
        enter, parts = self.hit_time(pairing), self.parts_of(pairing)
        if enter is not None and parts is not None:
            leave = max(self._part_times(pairing, parts, FIRST_BITS, leaving=True), key=_middle, default=enter)
            return float(enter), float(leave)
        if enter is None or self.is_wall(pairing):
            told = self._wall(pairing, FIRST_BITS) if enter is not None and pull_of(self, pairing) > 0 else None
            if told is None or enter is None:
                return None if enter is None else (float(enter), math.inf)
            _, (gap, approach, half), _ = told
            return float(enter), float(enter + ball.root(law.fall_discriminant(gap, approach, half)) / half)
        if _is_on_peg(self, pairing):
            fall = _fall_of(self, pairing, FIRST_BITS)
            assert fall is not None
            then = [-_middle(value) for value in fall[1].after(enter - fall[0]).polynomial(True)]
            out = told_falling_zero(then)
            return float(enter), float(enter) + (0.0 if out is None else out)
        relative = self._relative(pairing, FIRST_BITS)
        assert relative is not None
        _, dx, dy, vx, vy, reach = relative
        root = ball.root(law.pair_discriminant(dx, dy, vx, vy, reach))
        return float(enter), float(enter + (root + root) / (vx * vx + vy * vy))

    def parts(self, pairing: Pairing, bits: int = FIRST_BITS) -> bool:
        """Whether nothing in their free flights brings the two together: they part, or keep a distance."""
        if (thing := _thing_fall(self, pairing, bits)) is not None:
            return thing.margin() is None
        if (parts := self.parts_of(pairing)) is not None:
            near, flight = self._nearest(pairing, bits), self.numbers(pairing, pairing.body, bits)
            if near is None or flight is None:
                return False
            if not parts.convex:
                aside = self._ahead(pairing, parts, bits)
                return aside is None or ball.sign_of(aside) == 1
            gap, approach = near.gap, near.nx * flight[3] + near.ny * flight[4]
        elif self.is_wall(pairing):
            wall = self._wall(pairing, bits)
            if wall is None:
                return False
            _, (gap, approach, _), _ = wall
            if (pull := pull_of(self, pairing)) != 0:
                return pull > 0 and ball.sign_of(approach) in (0, 1)
        elif _is_on_peg(self, pairing):
            fall = _fall_of(self, pairing, bits)
            return fall is not None and ball.sign_of(fall[1].approach()) in (0, 1) and nearest_fall(fall[1]) is None
        else:
            relative = self._relative(pairing, bits)
            if relative is None:
                return False
            _, dx, dy, vx, vy, reach = relative
            gap, approach = law.pair_gap(dx, dy, reach), law.pair_approach(dx, dy, vx, vy)
        return ball.sign_of(approach) == 1 or (ball.sign_of(approach) == 0 and ball.sign_of(gap) == 1)

    def least_gap(self, pairing: Pairing, bits: int = FIRST_BITS) -> arb | None:
        """The least distance between two surfaces in free flight; negative: how deep they would sink in.

        For a wall, which every approaching circle hits, the speed at which the circle leaves it; of one to which it
        is pulled, at which it comes there. For a thing of faces and ends, how far aside of it the flight passes
        (`_beside`).
        """
        if (thing := _thing_fall(self, pairing, bits)) is not None:
            margin = thing.margin()
            if margin is None:
                near = self._nearest(pairing, bits)
                return None if near is None else near.gap
            return None if margin.is_nan() else margin
        parts = self.parts_of(pairing)
        if parts is not None:
            near, flight = self._nearest(pairing, bits), self.numbers(pairing, pairing.body, bits)
            if near is None or flight is None:
                return None
            if not parts.convex:
                aside = self._ahead(pairing, parts, bits)
                return near.gap if aside is None else aside
            if ball.sign_of(near.nx * flight[3] + near.ny * flight[4]) in (0, 1):
                return near.gap
            return self._beside(pairing, parts, bits)
        if self.is_wall(pairing):
            told = self._wall(pairing, bits)
            return None if told is None else wall_margin(told[1], pull_of(self, pairing)) / told[2]
        if _is_on_peg(self, pairing):
            fall = _fall_of(self, pairing, bits)
            if fall is None:
                return None
            (dx, dy, *_, reach), least = fall[1], nearest_fall(fall[1])
            goes = least is None and ball.sign_of(fall[1].approach()) in (0, 1)
            if goes:
                return ball.root(dx * dx + dy * dy) - reach
            return None if least is None or least.is_nan() else least
        relative = self._relative(pairing, bits)
        if relative is None:
            return None
        _, dx, dy, vx, vy, reach = relative
        if ball.sign_of(law.pair_approach(dx, dy, vx, vy)) in (0, 1):
            least, zero = ball.root(dx * dx + dy * dy) - reach, pair_gap
        else:
            least, zero = abs(dx * vy - dy * vx) / ball.root(vx * vx + vy * vy) - reach, pair_discriminant
        return arb(0) if ball.sign_of(least) is None and self._proves(zero, pairing) else least

    def gap_at(self, pairing: Pairing, time: arb, bits: int = FIRST_BITS) -> arb | None:
        """The distance between two surfaces at a time of their free flight."""
        if self.parts_of(pairing) is not None:
            near = self._nearest(pairing, bits, time)
            return None if near is None else near.gap
        if self.is_wall(pairing):
            told = self._wall(pairing, bits)
            return None if told is None else law.sag(*told[1], time - told[0]) / told[2]
        if _is_on_peg(self, pairing):
            fall = _fall_of(self, pairing, bits)
            if fall is None:
                return None
            then = fall[1].after(time - fall[0])
            return ball.root(then.dx * then.dx + then.dy * then.dy) - then.reach
        relative = self._relative(pairing, bits)
        if relative is None:
            return None
        t, dx, dy, vx, vy, reach = relative
        x, y = law.advance(dx, vx, time - t), law.advance(dy, vy, time - t)
        return ball.root(x * x + y * y) - reach

    def _proves(self, formula: Callable[..., Quantity], pairing: Pairing, end: int | None = None) -> bool:
        """Whether a gap, or a discriminant, is proved to be zero, where the flights' exact values are short."""
        gravity = self.scene.gravity
        if gravity is not None and self._rounds_to is not None:  # it falls otherwise
            return False
        if end is not None:
            anchor = pairing.anchors.get(pairing.body)
            own = exact_flight(self.flight(pairing.body, anchor, turned=self._turned(pairing)), gravity)
            circle, there = self.scene.circles[self.places[pairing.body]], self.scene.circles[end]
            if own is None or self._rounds_to is not None:
                return False
            apart = apart_at(own, resting(there))
            return is_zero(formula, *(apart[:2] if formula is pair_gap else apart), circle.r + there.r)
        names = pairing.body, pairing.partner
        if pairing.partner in self.pockets:
            hole = self.run.scene.pockets[self.pockets[pairing.partner]]
            own = self.flight(pairing.body, pairing.anchors[pairing.body], turned=self._turned(pairing))
            flight = exact_flight(own, gravity)
            if flight is None or self._rounds_to is not None:
                return False
            apart = apart_at(flight, (ZERO, hole.x, hole.y, ZERO, ZERO))
            return is_zero(formula, *(apart[:2] if formula is pair_gap else apart), hole.r)
        flights = [self.flight(n, pairing.anchors.get(n), turned=self._turned(pairing)) for n in names]
        exact = [own for own in (exact_flight(flight, gravity) for flight in flights) if own is not None]
        if len(exact) < 2:
            return False
        radii = [
            c.r if self._rounds_to is None else nearest(c.r, self._rounds_to)
            for c in self.scene.circles
            if c.id in names
        ]
        apart = apart_at(*exact)
        return is_zero(formula, *(apart[:2] if formula is pair_gap else apart), radii[0] + radii[1])


def pull_of(reader: RunReader, pairing: Pairing) -> int:
    """Whether gravity pulls a circle to a wall (-1), away from it (1), or neither."""
    wall = reader.places[pairing.partner] - len(reader.scene.circles)
    return reader.things(FIRST_BITS).sides.pull(reader.places[pairing.body], wall)


def decides_by_speed(reader: RunReader, pairing: Pairing) -> bool:
    """Whether the number that decides a hit is a speed, and no distance: see `RunReader.least_gap`."""
    return reader.is_wall(pairing) and pull_of(reader, pairing) <= 0


def _is_on_peg(reader: RunReader, pairing: Pairing) -> bool:
    """Whether one of the two falls and the other is a circle that stands, or a pocket."""
    pegs, places = reader.scene.pegs, reader.places
    if pairing.partner in reader.pockets:
        return reader.scene.gravity is not None
    return bool(pegs) and (places[pairing.body] in pegs) is not (places[pairing.partner] in pegs)


def _fall_of(reader: RunReader, pairing: Pairing, bits: int) -> tuple[arb, RoundFall[arb]] | None:
    """The clock of the one that falls, and both as they then are; None if the run does not have that flight.

    Of a pairing of which `_is_on_peg` holds.
    """
    names, pocket = (pairing.body, pairing.partner), reader.pockets.get(pairing.partner)
    faller, peg = names if pocket is not None or reader.places[names[1]] in reader.scene.pegs else names[::-1]
    row = reader.numbers(pairing, faller, bits)
    if row is None:
        return None
    things = reader.things(bits)
    stands = things.bodies[reader.places[peg]] if pocket is None else things.pockets[pocket]
    return row[0], fall_onto(things, reader.places[faller], row, stands)


def _thing_fall(reader: RunReader, pairing: Pairing, bits: int) -> ThingFall | None:
    """Of a partner with parts, under gravity: the two; None without it, or where the run lacks that flight."""
    parts = reader.parts_of(pairing)
    row = None if parts is None or reader.scene.gravity is None else reader.numbers(pairing, pairing.body, bits)
    if row is None or parts is None:
        return None
    things = reader.things(bits)
    return ThingFall(things, reader.places[pairing.body], seen_from(row, _pace_of(things, parts)), parts)


def _pace_of(things: RoundedState, parts: ThingParts) -> tuple[arb, arb] | None:
    """The velocity of a thing that moves."""
    return things.drifts.get(parts.faces[0]) if parts.faces else None


class CarriedReader(RunReader):
    """Reads a decision off carried flights."""

    def __init__(
        self,
        run: Trajectory,
        state: RoundedState,
        first: Mapping[int, Row],
        seen: Mapping[tuple[int, int], Row],
        turned: Mapping[int, Row],
        turned_after: int | None,
    ) -> None:
        super().__init__(run, turned_after=turned_after)
        self._state, self._first, self._seen, self._turned_rows = state, first, seen, turned

    def numbers(self, pairing: Pairing, name: str, bits: int) -> FlightBalls | None:
        """As `RunReader.numbers`."""
        k, anchor = self.places[name], pairing.anchors.get(name)
        if self._turned(pairing) and k in self._turned_rows:
            return self._turned_rows[k]
        return self._first[k] if anchor is None else self._seen.get((k, anchor), self._first[k])

    def things(self, bits: int) -> RoundedState:
        """As they are carried."""
        return self._state

    def value_once(self, decision: DecidingNumber, bits: int) -> arb | None:
        """The number that decides, at so many bits and no more."""
        found = self._value(decision, bits)
        return found if found is not None and found.is_finite() else None

    def comes_late(self, decision: DecidingNumber) -> bool | None:
        """Whether a hit comes after the meeting that the other run has instead; None where that is not known.

        Where that meeting's flights are not carried too, a hit is not late that comes before its time in that run.
        """
        rival, mine = decision.rival, self.hit_time(decision.first)
        assert rival is not None
        if not all(
            anchor is None or self._turned(rival) or (self.places[name], anchor) in self._seen
            for name, anchor in rival.anchors.items()
        ):
            return False if mine is not None and float(mine.mid()) < decision.rival_time else None
        theirs = self.hit_time(rival)
        sign = None if mine is None or theirs is None else ball.sign_of(theirs - mine)
        return False if theirs is None else None if sign is None else sign == -1

    def _proves(self, formula: Callable[..., Quantity], pairing: Pairing, end: int | None = None) -> bool:
        """No zero is proved of carried flights."""
        return False
