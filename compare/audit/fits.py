"""The simplest change of the laws that explains what a run's impacts and flights miss."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from itertools import zip_longest
from typing import TYPE_CHECKING, NamedTuple

from flint import arb

from ...exact.numbers import ball
from .residual import EXPLAINS, FLIGHTS, Violation, along, digits_known, digits_off, length_of, percent
from .residuals import Laws

if TYPE_CHECKING:
    from .transcript import ReportedFlight, ReportedInstant, Transcript

SPREAD = 0.01
"""Values that differ among themselves by less than this share of what they differ from the law by are one value."""

SEEN = 2.0**12
"""Units in the last place of the speeds from which on an approach shows its restitution: to a 4,000th."""

NEAR = 16.0
"""How many times the rounding of a step a description may leave of it."""

FEWEST = 3
"""Impacts from which on one value for all of them is a description, and not a coincidence."""

MOST_BOUNCES = 2_000
"""Bounces that are followed of those that nothing reports."""


class Sample(NamedTuple):
    """One contact by itself, in numbers that a law has a value for.

    Attributes:
        event: by the engine's own count.
        time: when.
        pair: who meets, by place.
        speed: how fast they approach along the line of centres.
        restitution: the ratio of the normal speeds, after to before, as a share of the scene's, or 1 more where that
            is 0; 1 by the law.
        sliding: the ratio of the speeds across it; 1 by the law. nan where there is none.
        aside: the part of the change across the line of centres, as a share of the impulse; 0 by the law.
        masses: the mass of the first over that of the second as the two changes of velocity have it, over what it is;
            1 by the law. nan for walls and fixed circles.
        lost: the momentum of the two that is lost, as a share of the impulse; 0 by the law.
        gap: between the surfaces at the contact; 0 by the law.
        room: what rounding may make of each ratio.
        loose: what it may make of the gap.
        slide: how fast they pass each other across the line of centres.
        reach: from centre to centre as they touch; infinite for a wall, below zero within an arc.
        inherited: the gap, below 0, that there is already as the later of their flights begins, under gravity alone.
        off: how far a velocity after it is from the law's.
    """

    event: int
    time: float
    pair: tuple[int, int]
    speed: float
    restitution: float
    sliding: float
    aside: float
    masses: float
    lost: float
    gap: float
    room: float
    loose: float
    slide: float = 0.0
    reach: float = math.inf
    inherited: float = 0.0
    off: float = 0.0

    @property
    def sunk(self) -> float:
        """The gap that has come of this flight; 0 where one was there before, and is less now: it is pushed out."""
        return min(0.0, self.gap - self.inherited) if self.inherited else self.gap

    @property
    def late(self) -> float:
        """How late the contact is told: how long before, in straight flight, the two touched.

        In a graze, overlaps grow with the square of the time: that time is far less than the gap over the speed.
        """
        if not self.speed:
            return 0.0
        if math.isfinite(self.reach):
            far, over = abs(self.reach + self.sunk), self.sunk * (2 * self.reach + self.sunk)
            square = (far * self.speed) ** 2 - over * (self.speed**2 + self.slide**2)
            if square >= 0:
                return -math.copysign(over, over * self.reach) / (far * self.speed + math.sqrt(square))
        return -self.sunk / self.speed

    @property
    def defect(self) -> float:
        """How far the impulse is from the law, as a share of itself."""
        return max(abs(self.restitution - 1.0), 0.0 if math.isnan(self.sliding) else abs(self.aside), abs(self.lost))


class Drift(NamedTuple):
    """One flight: how far from where it flew to a circle is.

    Attributes:
        event: by the engine's own count.
        time: at its end.
        circle: by place.
        span: how long it flew.
        along, across: the part in the direction of flight, and to the left of it.
        x, y: the same, by axes.
        speed: of the flight.
        room: what rounding may make of it.
    """

    event: int
    time: float
    circle: int
    span: float
    along: float
    across: float
    x: float
    y: float
    speed: float
    room: float

    @property
    def size(self) -> float:
        """How far off it is."""
        return math.hypot(self.x, self.y)


@dataclass(frozen=True)
class Fit:
    """A description that explains steps.

    Attributes:
        what: in words, such as `restitution 0.98`.
        explained, of: how many steps it explains, and how many it was tried on: all of its sort that were seen.
        value, spread: the number in it, and how far single steps are from that; nan where there is none.
        kind: one of `EXPLAINS`.
    """

    what: str
    explained: int
    of: int
    value: float = math.nan
    spread: float = math.nan
    kind: str = ""

    def __str__(self) -> str:
        return f"{self.what} fits {self.explained} of {self.of} {'flights' if self.kind in FLIGHTS else 'impacts'}"


def sampled(laws: Laws, instant: ReportedInstant, events: int, back: float = 0.0) -> list[Sample]:
    """The contacts of an instant that are by themselves: no circle of theirs takes part in another.

    Args:
        back: how long before the told places the impulse was applied, at the velocities that it leaves.
    """
    found: list[Sample] = []
    for pair in dict.fromkeys(instant.impulses):
        circles = [k for k in pair if k < laws.count]
        if sum(bool({*circles} & {*other}) for other in dict.fromkeys(instant.impulses)) > 1:
            continue
        if any(k not in instant.after and laws.moving[k] for k in circles):
            continue
        found += _sample(laws, pair, instant, events, back)
    return found


@dataclass(frozen=True)
class BounceRatios:
    """The restitution that a run's bounces have: the normal speed after one over that before, as the run reports them.

    Attributes:
        asked: that of the scene.
        mean, low, high: over all bounces.
        spread: their standard deviation.
        count: contacts alone at their instant whose approach is more than rounding.
    """

    asked: float
    mean: float
    low: float
    high: float
    count: int
    spread: float = 0.0

    def __str__(self) -> str:
        """In words.

        >>> str(BounceRatios(0.9, 0.89, 0.875, 0.9, 12, 0.008))
        'asked for restitution 0.9, its 12 bounces have 0.89 on average, 0.875 to 0.9 (spread 0.008)'
        """
        has = f"its {self.count:,} bounces have" if self.count > 1 else "its bounce has"
        spread = f" on average, {self.low:.4g} to {self.high:.4g} (spread {self.spread:.2g})" if self.count > 1 else ""
        return f"asked for restitution {self.asked:.4g}, {has} {self.mean:.4g}{spread}"


def bounces_of(transcript: Transcript, laws: Laws) -> BounceRatios | None:
    """The restitution of a run's bounces; None where it has none. To be used at `AUDIT_BITS`."""
    ratios: list[float] = []
    events = 0
    for instant in transcript.instants():
        shared = Counter(k for pair in instant.impulses for k in pair if k < laws.count and laws.moving[k])
        for pair in instant.impulses if not instant.turned else ():
            if any(shared[k] > 1 for k in pair):
                continue
            met = laws.meeting(pair, instant, events)
            ends = [(instant.before[k], instant.after.get(k, instant.before[k])) for k in pair if k < laws.count]
            (a, la), (b, lb) = ends[0], ends[-1]
            wx, wy = map(ball.constant, laws.drift(pair[1]))
            second = [(b.vx, b.vy), (lb.vx, lb.vy)] if len(ends) > 1 else [(wx, wy), (wx, wy)]
            before, after = (
                float((met.nx * (vx - first.vx) + met.ny * (vy - first.vy)).mid())
                for first, (vx, vy) in zip((a, la), second, strict=True)
            )
            if -before > SEEN * laws.unit * (met.speed + a.fallen):
                ratios.append(-after / before)
        events += len(instant.events)
    if not ratios:
        return None
    mean = math.fsum(ratios) / len(ratios)
    spread = math.sqrt(math.fsum((ratio - mean) ** 2 for ratio in ratios) / len(ratios))
    return BounceRatios(laws.restitution, mean, min(ratios), max(ratios), len(ratios), spread)


def with_bounces(laws: Laws, k: int, row: Sequence[ReportedFlight], end: float) -> Sequence[ReportedFlight]:
    """The flights of a circle, and its infinitely many bounces by the law, as far as they are higher than rounding.

    After the bounce with number n, from 0, with the normal speed v after the first and the pull a, it flies on at the
    time (2 v / a) (1 - e^n) / (1 - e) after that, with v e^n, and comes as high as (v e^n)^2 / (2 a).

    Args:
        end: up to when the last flight goes on.

    Raises:
        ValueError: where these are too many.
    """
    found: list[ReportedFlight] = []
    for flight, following in zip_longest(row, row[1:]):
        found.append(flight)
        if not flight.bounces or laws.fall is None:
            continue
        rest, pull, e = along(laws, k, flight), laws.fall.pull, laws.change - 1
        ux, uy = flight.vx - rest.vx, flight.vy - rest.vy
        span = 2 * (ux * ux + uy * uy).sqrt() / (pull * (1 - e))
        height = float(((ux * ux + uy * uy) / (2 * pull)).mid())
        faint = 2.0**-51 * (flight.place + flight.speed * flight.time)
        number = math.ceil(math.log(faint / height) / (2 * math.log(laws.restitution))) if height > faint > 0 else 0
        if number > MOST_BOUNCES:
            raise ValueError(f"it bounces {number:,} times that no event tells of, more than {MOST_BOUNCES:,}")
        last, share = end if following is None else following.time, arb(1)
        for _ in range(number):
            share *= e
            if float(t := flight.t + span * (1 - share)) >= last:
                break
            x, y = rest.at(t)
            vx, vy = rest.vx + ux * share, rest.vy + uy * share
            found.append(flight._replace(t=t, x=x, y=y, vx=vx, vy=vy, time=float(t), bounces=False))
        else:
            t = found[-1].t
            x, y = rest.at(t)
            found[-1] = rest._replace(t=t, x=x, y=y, time=float(t))
    return found


def _sample(laws: Laws, pair: tuple[int, int], instant: ReportedInstant, events: int, back: float) -> Iterable[Sample]:
    i, j = pair
    met = laws.meeting(pair, instant, events)
    a, la = instant.before[i], instant.after.get(i, instant.before[i])
    wall = j >= laws.count
    nx, ny, opening = met.nx, met.ny, met.opening
    ax, ay = la.vx - a.vx, la.vy - a.vy
    if wall:
        b = lb = a
        wx, wy = map(ball.constant, laws.drift(j))
        bx, by, vx, vy, ux, uy = 0 * ax, 0 * ay, wx - a.vx, wy - a.vy, wx - la.vx, wy - la.vy
        if back and j >= laws.first_side:
            side = laws.sides[j - laws.first_side]
            dx = side.inward * (side.x - la.x + la.vx * back)
            dy = side.inward * (side.y - la.y + la.vy * back)
            far = (dx * dx + dy * dy).sqrt()
            if not float(far.mid()):
                return
            nx, ny = dx / far, dy / far
            opening = nx * vx + ny * vy
    else:
        b = instant.before[j]
        lb = instant.after.get(j, b)
        bx, by = lb.vx - b.vx, lb.vy - b.vy
        vx, vy, ux, uy = b.vx - a.vx, b.vy - a.vy, lb.vx - la.vx, lb.vy - la.vy
        if back:
            dx, dy = lb.x - la.x - ux * back, lb.y - la.y - uy * back
            far = (dx * dx + dy * dy).sqrt()
            if not float(far.mid()):
                return
            nx, ny = dx / far, dy / far
            opening = nx * vx + ny * vy
    closing = float(opening.mid() if met.bounced is None else met.bounced.mid())
    if closing >= 0.0 or not met.speed:
        return
    after = float((nx * ux + ny * uy).mid())
    across, then = float((nx * vy - ny * vx).mid()), float((nx * uy - ny * ux).mid())
    wa, wb = laws.things[i].share, 0.0 if wall else laws.things[j].share
    kick = (1 + laws.restitution) * abs(float(opening.mid())) / (1.0 if wall else wa + wb)
    if not kick:
        return
    pushed = [(ax, ay, 1.0 if wall else wa, a.speed + la.speed)] if laws.moving[i] else []
    if not wall and laws.moving[j]:
        pushed.append((bx, by, wb, b.speed + lb.speed))
    both = zip((1, -1)[not laws.moving[i] :], pushed, strict=False)  # the law pushes the first back
    off = [length_of(x + sign * kick * w * nx, y + sign * kick * w * ny) for sign, (x, y, w, _) in both]
    aside = max((float(length_of(nx * y - ny * x, 0 * x)) / (kick * w) for x, y, w, _ in pushed), default=0.0)
    masses, lost = math.nan, 0.0
    # a heavy circle's velocity hardly changes: its last bit is more of the change than of the speed
    heavy = NEAR * 64 * laws.unit * max((fast / w for _, _, w, fast in pushed), default=0.0) / kick
    if laws.moving[i] and not wall and laws.moving[j]:
        one = -float((nx * ax + ny * ay).mid())
        other = float((nx * bx + ny * by).mid())
        masses = (other / wb) / (one / wa) if one and wa and wb else math.nan
        lost = math.hypot(float((ax / wa + bx / wb).mid()), float((ay / wa + by / wb).mid())) / kick
        lost, masses = (lost if lost > heavy else 0.0), (1.0 if abs(masses - 1) <= heavy else masses)
    speeds = a.speed + a.fallen + la.speed + (0.0 if wall else instant.before[j].speed + instant.before[j].fallen)
    closer = abs(closing) * (laws.restitution or 1.0)
    room = (64 * laws.unit * speeds + met.bent + met.grazed) / closer if closer else math.inf
    e, slid = laws.restitution, then / across if across else math.nan
    ratio = -after / closing / e if e else 1 - after / closing
    yield Sample(
        instant.events[0] if instant.events else events, instant.time, pair, -closing, ratio, slid,
        aside if aside > heavy else 0.0, masses, lost, float(met.gap.mid()), room, met.room, abs(across),
        laws.reach(pair), min(0.0, _began(laws, pair, instant)), max(off, default=0.0),
    )  # fmt: skip


def _began(laws: Laws, pair: tuple[int, int], instant: ReportedInstant) -> float:
    """The gap of two as the later of the flights begins that end at an instant; 0 without gravity."""
    if laws.fall is None:
        return 0.0
    i, j = pair
    flights = [instant.before[k] for k in pair if k < laws.count]
    start = max(flights, key=lambda flight: flight.time).t
    places: list[tuple[arb, arb]] = []
    for flight, k in zip(flights, pair, strict=False):
        if not laws.moving[k]:
            places.append((flight.x, flight.y))
            continue
        end = instant.after[k].t if k in instant.after else instant.t
        way, gain = laws.fall.fallen(end - flight.t)
        off = way - gain * (end - flight.t)  # back to where it was, and on to the start of the later one
        way, _ = laws.fall.fallen(start - flight.t)
        x, y = flight.x - laws.fall.gx * off, flight.y - laws.fall.gy * off
        vx, vy = flight.vx - laws.fall.gx * gain, flight.vy - laws.fall.gy * gain
        span = start - flight.t
        places.append((x + vx * span + laws.fall.gx * way, y + vy * span + laws.fall.gy * way))
    if j >= laws.first_side:
        side, ((x, y),) = laws.sides[j - laws.first_side], places
        apart = ((side.x - x) ** 2 + (side.y - y) ** 2).sqrt()
        return float((side.inward * (apart - side.r) - laws.things[i].r).mid())
    if j >= laws.count:
        line, ((x, y),) = laws.line(i, j - laws.count).at(start), places
        return float((line.nx * (line.x - x) + line.ny * (line.y - y) - laws.things[i].r).mid())
    (xa, ya), (xb, yb) = places
    dx, dy = xb - xa, yb - ya
    return float(((dx * dx + dy * dy).sqrt() - laws.things[i].r - laws.things[j].r).mid())


def drifts(laws: Laws, instant: ReportedInstant, events: int) -> list[Drift]:
    """Of each circle that an instant gives a new flight, how far it is from the end of its last."""
    found: list[Drift] = []
    for k, after in instant.after.items():
        before = instant.before[k]
        if not laws.moving[k]:
            continue
        span = after.t - before.t
        x = float((after.x - before.x - before.vx * span).mid())
        y = float((after.y - before.y - before.vy * span).mid())
        ex, ey = float(before.vx.mid()), float(before.vy.mid())
        speed = math.hypot(ex, ey)
        along, across = ((x * ex + y * ey) / speed, (y * ex - x * ey) / speed) if speed else (x, y)
        room = laws.flown_room(before, after, events)
        event = instant.events[0] if instant.events else events
        found.append(Drift(event, after.time, k, float(span.mid()), along, across, x, y, speed, room))
    return found


# -- descriptions


@dataclass(frozen=True)
class _Missed:
    """What of some contacts and flights is off by more than rounding: a description has to explain all of it.

    Attributes:
        samples, ids: what it is seen in, and the names of all.
        speeds, aside, momentum, gaps: the contacts of which the normal speeds are; of which the impulse has a part
            across the line of centres; of which the two changes do not have the ratio of the masses; that do not touch.
        flights: those that end elsewhere.
    """

    samples: Sequence[Sample]
    ids: Sequence[str]
    speeds: Sequence[Sample]
    aside: Sequence[Sample]
    momentum: Sequence[Sample]
    gaps: Sequence[Sample]
    flights: Sequence[Drift]

    @property
    def impulses(self) -> set[Sample]:
        """The contacts whose impulse is off in any way."""
        return {*self.speeds, *self.aside, *self.momentum}

    def names(self, s: Sample) -> tuple[str, str]:
        """Who meets; faces and ends have the name of what they are of."""
        return self.ids[s.pair[0]], self.ids[s.pair[1]]


def descriptions(laws: Laws, samples: Sequence[Sample], flights: Sequence[Drift], ids: Sequence[str]) -> list[Fit]:
    """The simplest descriptions that explain all that some contacts and flights miss; several are equally simple.

    There is none where what is off is off in more than one way, or not by one number.
    """
    off = lambda size, s: size > NEAR * s.room  # noqa: E731
    missed = _Missed(
        samples,
        ids,
        [s for s in samples if off(abs(s.restitution - 1), s)],
        [s for s in samples if off(s.aside, s) and not math.isnan(s.sliding)],
        [s for s in samples if not math.isnan(s.masses) and (off(abs(s.masses - 1), s) or off(s.lost, s))],
        [s for s in samples if abs(s.gap) > s.loose],
        [d for d in flights if d.size > d.room],
    )
    if missed.flights:
        return [fit for fit, shift, turn in _flights(missed) if _follows(laws, missed, shift, turn)]
    if missed.gaps:
        return [] if missed.impulses else _sizes(laws, missed)
    kinds = [bool(missed.speeds), bool(missed.aside), bool(missed.momentum)]
    if kinds == [False, False, True]:
        return _masses(laws, missed)
    if kinds == [True, False, False]:
        return [*_restitutions(laws, missed)][:1] or _once(laws, missed)
    return ([*_frictions(laws, missed)][:1] or _once(laws, missed)) if kinds == [False, True, False] else []


def _follows(laws: Laws, missed: _Missed, shift: float, turn: float) -> bool:
    """Whether what contacts miss is no more than follows from flights that end so far, or so fast, from what is said.

    Args:
        shift: by how much places are moved.
        turn: by how much velocities are.
    """
    for s in {*missed.impulses, *missed.gaps}:
        shares = [thing.share for thing in (laws.things[k] for k in s.pair if k < laws.count) if thing.share]
        uneven = 1 + max(shares, default=1.0) / min(shares, default=1.0)
        tilt = shift / abs(s.reach) * (s.speed + s.slide) if s.reach else math.inf
        size = max(s.defect, s.aside) * s.speed
        if size > 8 * uneven * (turn + tilt) + NEAR * s.room * s.speed or abs(s.gap) > 4 * shift + s.loose:
            return False
    return True


def _ratio(laws: Laws, share: float) -> str:
    """A restitution that is a share of the scene's, in digits; see `Sample.restitution`."""
    e = laws.restitution
    return digits_off(share * e if e else share - 1, e)


def _one_value(values: Sequence[float], law: float, rooms: Sequence[float]) -> tuple[float, float] | None:
    """The mean and the spread of values that are one, and not the law's; None if they are several, or the law's."""
    if not values or not all(map(math.isfinite, values)):
        return None
    mean = math.fsum(values) / len(values)
    spread = max(abs(value - mean) for value in values)
    off = abs(mean - law)
    if off <= NEAR * max(rooms) or spread > SPREAD * off + NEAR * max(rooms):
        return None
    return mean, spread


def _sorts(laws: Laws, missed: _Missed, bad: Sequence[Sample]) -> Iterable[tuple[str, list[Sample]]]:
    """Sorts of contacts that have all of the bad ones, the widest first, in words."""
    wall = lambda s: s.pair[1] >= laws.count or s.pair[1] in laws.scene.ends  # noqa: E731
    pairs = dict.fromkeys(map(missed.names, bad))
    slow, fast, sides = min(s.speed for s in bad), max(s.speed for s in bad), sorted({name for _, name in pairs})
    sorts: list[tuple[str, Callable[[Sample], bool]]] = [
        ("", lambda s: True),
        (" at walls", wall),
        (" between circles", lambda s: not wall(s)),
        *((f" of {name}", lambda s, name=name: name in missed.names(s)) for name in dict.fromkeys(missed.ids)),
        (f" at {' and '.join(sides)}", lambda s: wall(s) and missed.names(s)[1] in sides),
        *((f" between {one} and {two}", lambda s, pair=(one, two): missed.names(s) == pair) for one, two in pairs),
        (f" above a normal speed of {slow:.3g}", lambda s: s.speed >= slow),
        (f" below a normal speed of {fast:.3g}", lambda s: s.speed <= fast),
    ]  # fmt: skip
    for words, holds in sorts:
        if all(map(holds, bad)) and len(mine := [s for s in missed.samples if holds(s)]) >= FEWEST:
            yield words, mine


def _restitutions(laws: Laws, missed: _Missed) -> Iterable[Fit]:
    """One restitution for all contacts, or for all of a sort; the others keep the law."""
    least, off = min(abs(s.restitution - 1) for s in missed.speeds), {*missed.speeds}
    for words, sort in _sorts(laws, missed, missed.speeds):
        mine = [s for s in sort if 2 * NEAR * s.room < least or s in off]  # others are too slow to show it
        found = _one_value([s.restitution for s in mine], 1.0, [s.room for s in mine])
        if found is None:
            continue
        what = f"restitution {_ratio(laws, found[0])}{words}"
        walls = all(s.pair[1] >= laws.count or s.pair[1] in laws.scene.ends for s in mine)
        if laws.restitution == 1.0 and walls and words.startswith((" at walls", " of ")):
            what += f" (an impulse {percent((1 - found[0]) / 2)})"
        yield Fit(what, len(mine), len(mine), *found, "restitution")


def _frictions(laws: Laws, missed: _Missed) -> Iterable[Fit]:
    """The speed across the line of centres changes in one ratio, at all contacts or at all of a sort that slide."""
    mine = missed.aside
    one = _one_value([s.sliding for s in mine], 1.0, [s.room * s.speed for s in mine])
    if one is None or len(mine) < FEWEST:
        return
    for words, sort in _sorts(laws, missed, mine):
        if all(abs(one[0] - 1) * s.slide < 8 * NEAR * s.room * s.speed for s in {*sort} - {*mine}):  # too slow
            what = f"the speed across the contact becomes {digits_off(one[0], 1.0)} of what it was{words}"
            yield Fit(what, len(mine), len(mine), *one, "friction")


def _masses(laws: Laws, missed: _Missed) -> list[Fit]:
    """Masses taken for others: the ratio of the two changes of velocity has them."""
    pairs, bad = [s for s in missed.samples if not math.isnan(s.masses)], missed.momentum
    share = [thing.share for thing in laws.things]
    if len({share[k] for s in bad for k in s.pair}) > 1:
        for power, words in ((1, "equal"), (2, "their inverse")):
            times = [s.masses * (share[s.pair[1]] / share[s.pair[0]]) ** power for s in pairs]
            if all(abs(t - 1) <= NEAR * s.room for t, s in zip(times, pairs, strict=True)):
                return [Fit(f"masses taken for {words}", len(pairs), len(pairs), 3.0 - 2 * power, 0.0, "mass")]
    fits: list[Fit] = []
    for k, name in enumerate(missed.ids[: laws.count]):
        mine = [s for s in pairs if k in s.pair]
        if not mine or not laws.moving[k] or any(k not in s.pair for s in bad):
            continue
        ratios = [s.masses if s.pair[0] == k else 1 / s.masses if s.masses else math.inf for s in mine]
        found = _one_value(ratios, 1.0, [s.room for s in mine])
        if found is not None and found[0] > 0:
            what = f"the mass of {name} taken for {digits_off(found[0] / share[k], 1 / share[k])}"
            fits.append(Fit(what, len(mine), len(mine), *found, "mass"))
    return fits or _ratios(share, missed, pairs)


def _ratios(share: Sequence[float], missed: _Missed, pairs: Sequence[Sample]) -> list[Fit]:
    """Several masses taken for others, in one ratio to each other; there must be more impacts than masses."""
    first = missed.momentum[0].pair[0]
    times, loose = {first: 1.0}, {first: 0.0}  # what each is taken for, as a share of what it is, and within what
    if not all(0.0 < s.masses < math.inf for s in pairs):
        return []
    for s in sorted(pairs, key=lambda s: s.room) * len(share):
        i, j = s.pair
        if (i in times) is not (j in times):
            times.update({j: times[i] / s.masses} if i in times else {i: times[j] * s.masses})
            known = loose.get(i, 0.0) + loose.get(j, 0.0)
            loose |= {k: known + NEAR * s.room for k in (i, j) if k not in loose}
    mine = [s for s in pairs if s.pair[0] in times]
    off = [
        abs(times[i] / times[j] / s.masses - 1) - NEAR * s.room - loose[i] - loose[j] for s in mine for i, j in [s.pair]
    ]
    if len(mine) < max(FEWEST, len(times)) or max(off) > 0 or any(s.pair[0] not in times for s in missed.momentum):
        return []
    taken = {k: times[k] / share[k] for k in sorted(times)}
    least = min(taken, key=lambda k: taken[k])
    told = " to ".join(digits_known(mass / taken[least], loose[k] + loose[least]) for k, mass in taken.items())
    names = ", ".join(missed.ids[k] for k in taken)
    return [Fit(f"the masses of {names} taken to be as {told}", len(mine), len(mine), kind="mass")]


def _sizes(laws: Laws, missed: _Missed) -> list[Fit]:
    """A radius, or the place of a wall, taken for another: all gaps of one thing are the same."""
    samples, fits = missed.samples, list[Fit]()
    every = _one_value([s.gap for s in samples], 0.0, [s.loose / NEAR for s in samples])
    if every is not None and len(samples) >= FEWEST:
        words = "apart" if every[0] > 0 else "into each other"
        return [Fit(f"contacts {abs(every[0]):.3g} {words}", len(samples), len(samples), *every, "gap")]
    several = {missed.ids[k] for k in laws.parts_places}
    for name in dict.fromkeys(missed.ids):
        mine = [s for s in samples if name in missed.names(s)]
        found = _one_value([s.gap for s in mine], 0.0, [s.loose / NEAR for s in mine])
        if found is None or any(name not in missed.names(s) for s in missed.gaps):
            continue
        size, more = f"{abs(found[0]):.3g}", found[0] > 0
        hollow = {s.reach < 0 if s.pair[1] >= laws.first_side else None for s in mine} if name in several else {False}
        if hollow not in ({True}, {False}):  # of an arc met on one side only nothing is known of the other
            kind, what = "radius", f"{name} taken to be {size} {'thicker' if more else 'thinner'} on each side"
        elif name not in several and missed.ids.index(name) >= laws.count:
            kind, what = "wall", f"wall {name} taken to be {size} {'nearer' if more else 'farther'}"
        else:
            less = more is (hollow == {True})
            kind, what = "radius", f"the radius of {name} taken for {size} {'less' if less else 'more'}"
        fits.append(Fit(what, len(mine), len(mine), *found, kind))
    return fits


def _flights(missed: _Missed) -> Iterable[tuple[Fit, float, float]]:
    """Velocities that decay, an acceleration, or places that are moved without a flight.

    With each, by how much it moves a place at most, and by how much it changes a velocity.
    """
    bad, longest = missed.flights, max(d.span for d in missed.flights)
    if len(bad) < FEWEST:
        return
    fast, flown = max(d.speed for d in bad), [d for d in bad if d.span]
    moving = [d for d in flown if d.speed and abs(d.across) <= d.room]

    def tried(values: list[float], rooms: list[float], what: Callable[[float], str], kind: str) -> Iterable[Fit]:
        found = _one_value(values, 0.0, [room / NEAR for room in rooms])
        if found is not None and len(values) == len(bad):
            yield Fit(what(found[0]), len(bad), len(bad), *found, kind)

    for fit in tried(
        [-2 * d.along / (d.speed * d.span**2) for d in moving], [d.room / (d.speed * d.span**2) for d in moving],
        lambda value: f"speeds that fall by {value:.3g} of themselves a unit of time", "damping",
    ):  # fmt: skip
        yield fit, abs(fit.value) * longest**2 * fast, abs(fit.value) * longest * fast
    for fit in tried(
        [d.along / (d.speed * d.span) for d in moving], [d.room / (d.speed * d.span) for d in moving],
        lambda value: f"ways {percent(-value)} than speed times time", "damping",
    ):  # fmt: skip
        yield fit, abs(fit.value) * longest * fast, abs(fit.value) * fast
    for axis, name in ((0, "x"), (1, "y")):
        for fit in tried(
            [2 * (d.x, d.y)[axis] / d.span**2 for d in flown], [2 * d.room / d.span**2 for d in flown],
            lambda value, name=name: f"an acceleration of {value:.3g} along {name}", "acceleration",
        ):  # fmt: skip
            if all(abs((d.y, d.x)[axis]) <= d.room for d in flown):
                yield fit, abs(fit.value) * longest**2, abs(fit.value) * longest
    starts = [d for d in moving if d.span > d.time * (1 - 2.0**-40)]
    for fit in tried(
        [-d.along / d.speed for d in starts], [d.room / d.speed for d in starts],
        lambda value: f"times told {abs(value):.3g} too {'late' if value > 0 else 'early'}", "lag",
    ):  # fmt: skip
        yield fit, abs(fit.value) * fast, 0.0
    for fit in tried(
        [d.size for d in bad], [d.room for d in bad],
        lambda value: f"places moved by {value:.3g}, without a flight", "correction",
    ):  # fmt: skip
        yield fit, fit.value, 0.0


def _once(laws: Laws, missed: _Missed) -> list[Fit]:
    """A single impact that is off."""
    (only, *more), ids = tuple(missed.impulses), missed.ids
    if more:
        return []
    where = f"at event {only.event} alone" if len(missed.samples) > 1 else f"at event {only.event}, the only one seen"
    if missed.speeds:
        if only.restitution < 0:
            return []
        what = f"restitution {_ratio(laws, only.restitution)} {where}"
    else:
        what = f"an impulse {only.aside:.3g} off the line of centres {where}"
    return [Fit(f"{what} ({ids[only.pair[0]]} and {ids[only.pair[1]]})", 1, 1, only.restitution, 0.0, "once")]


def description_of(fits: Sequence[Fit], missed: Sequence[Violation]) -> Fit | None:
    """The one description that explains all steps that miss a law; None where there is none, or more than one."""
    able = [fit for fit in fits if all(_explains(fit, found) for found in missed)]
    return able[0] if len(able) == 1 and (able[0].kind != "once" or len(missed) == 1) else None


def _explains(fit: Fit, found: Violation) -> bool:
    """Whether a description is of a step's kind; a radius, or a wall's place, of who flies into another."""
    named = fit.kind not in ("radius", "wall") or any(f" {name} taken " in f" {fit.what}" for name in found.bodies)
    return found.kind in EXPLAINS[fit.kind] and named
