"""The simplest change of the laws that explains what a run's impacts and flights miss."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

from flint import arb

from ...exact.numbers import ball
from .residuals import Laws, length_of

if TYPE_CHECKING:
    from .transcript import ReportedInstant, Transcript

SPREAD = 0.01
"""Values that differ among themselves by less than this share of what they differ from the law by are one value."""

SEEN = 2.0**12
"""Units in the last place of the speeds from which on an approach shows its restitution: to a 4,000th."""

NEAR = 16.0
"""How many times the rounding of a step a description may leave of it."""

FEWEST = 3
"""Impacts from which on one value for all of them is a description, and not a coincidence."""


class Sample(NamedTuple):
    """One contact by itself, in numbers that a law has a value for.

    Attributes:
        event: by the engine's own count.
        time: when.
        pair: who meets, by place.
        speed: how fast they approach along the line of centres.
        restitution: the ratio of the normal speeds, after to before, as a share of the scene's; 1 by the law.
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
        inherited: the gap, below 0, that there is already as the later of their flights begins; looked at under
            gravity, where circles come to rest on what they have sunk into before.
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
        sliding = 0.0 if math.isnan(self.sliding) else abs(self.aside)
        return max(abs(self.restitution - 1.0), sliding, abs(self.lost))


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


@dataclass(frozen=True)
class Fit:
    """A description that explains steps.

    Attributes:
        what: in words, such as `restitution 0.98`.
        explained, of: how many of the steps that miss a law it explains, and how many it was tried on.
        value, spread: the number in it, and how far single steps are from that; nan where there is none.
        kind: `restitution`, `mass`, `radius`, `wall`, `friction`, `damping`, `acceleration`, `correction`, `once`.
    """

    what: str
    explained: int
    of: int
    value: float = math.nan
    spread: float = math.nan
    kind: str = ""

    def __str__(self) -> str:
        return f"{self.what} fits {self.explained} of {self.of} {'flights' if self.kind in FLIGHTS else 'impacts'}"


FLIGHTS = ("damping", "acceleration", "correction")
"""Kinds of description that are of flights."""


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
    free = laws.moving[i] and not wall and laws.moving[j]
    kick = (1 + laws.restitution) * abs(float(opening.mid())) / (1.0 if wall else wa + wb)
    if not kick:
        return
    share = 1.0 if wall else wa
    pushed = [(ax, ay, share, a.speed + la.speed)] if laws.moving[i] else []
    if not wall and laws.moving[j]:
        pushed.append((bx, by, wb, b.speed + lb.speed))
    aside = max((float(length_of(nx * y - ny * x, 0 * x)) / (kick * w) for x, y, w, _ in pushed), default=0.0)
    masses, lost = math.nan, 0.0
    # a heavy circle's velocity hardly changes: its last bit is more of the change than of the speed
    heavy = NEAR * 64 * laws.unit * max((fast / w for _, _, w, fast in pushed), default=0.0) / kick
    if free:
        one = -float((nx * ax + ny * ay).mid())
        other = float((nx * bx + ny * by).mid())
        masses = (other / wb) / (one / wa) if one and wa and wb else math.nan
        lost = math.hypot(float((ax / wa + bx / wb).mid()), float((ay / wa + by / wb).mid())) / kick
        lost, masses = (lost if lost > heavy else 0.0), (1.0 if abs(masses - 1) <= heavy else masses)
    aside = aside if aside > heavy else 0.0
    speeds = a.speed + a.fallen + la.speed + (0.0 if wall else instant.before[j].speed + instant.before[j].fallen)
    room = (64 * laws.unit * speeds + met.bent) / (abs(closing) * min(1.0, laws.restitution))
    slid, ratio = then / across if across else math.nan, -after / closing / laws.restitution
    yield Sample(
        instant.events[0] if instant.events else events, instant.time, pair, -closing, ratio, slid, aside,
        masses, lost, float(met.gap.mid()), room, met.room, abs(across),
        laws.reach(pair), min(0.0, _began(laws, pair, instant)),
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
        end = instant.after[k].t if k in instant.after else instant.t
        way, gain = laws.fall.fallen(end - flight.t)
        off = way - gain * (end - flight.t)  # back to where it was, and on to the start of the later one
        way, _ = laws.fall.fallen(start - flight.t)
        x, y = flight.x - laws.fall.gx * off, flight.y - laws.fall.gy * off
        vx, vy = flight.vx - laws.fall.gx * gain, flight.vy - laws.fall.gy * gain
        span = start - flight.t
        places.append((x + vx * span + laws.fall.gx * way, y + vy * span + laws.fall.gy * way))
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


def fit_of(laws: Laws, samples: Sequence[Sample], flights: Sequence[Drift], ids: Sequence[str]) -> Fit | None:
    """The simplest description of what some contacts and flights miss; None if none explains half of them."""
    tried = [
        *(_accelerations(flights) if laws.fall is not None else ()),  # what is wrong with a fall shows at impacts, too
        *_restitutions(laws, samples, ids),
        *_masses(laws, samples, ids),
        *_frictions(samples),
        *_sizes(laws, samples, ids),
        *_flights(flights),
        *_once(laws, samples, ids),
    ]
    return next((fit for fit in tried if fit is not None), None) or _mostly(laws, samples)


def _mostly(laws: Laws, samples: Sequence[Sample]) -> Fit | None:
    """One restitution for most contacts, where none holds for all of a sort."""
    if len(samples) < FEWEST:
        return None
    value = sorted(s.restitution for s in samples)[len(samples) // 2]
    near = [s for s in samples if abs(s.restitution - value) <= SPREAD * abs(value - 1) + NEAR * s.room]
    off = max((NEAR * s.room for s in near), default=math.inf)
    if 2 * len(near) < len(samples) or abs(value - 1) <= off:
        return None
    spread = max(abs(s.restitution - value) for s in near)
    return Fit(f"restitution {_ratio(laws, value)}", len(near), len(samples), value, spread, "restitution")


def _ratio(laws: Laws, share: float) -> str:
    """A restitution that is a share of the scene's, in digits."""
    return _told(share * laws.restitution, laws.restitution)


def _one_value(values: Sequence[float], law: float, rooms: Sequence[float]) -> tuple[float, float] | None:
    """The mean and the spread of values that are one, and not the law's; None if they are several, or the law's."""
    if not values:
        return None
    if not all(map(math.isfinite, values)):
        return None
    mean = math.fsum(values) / len(values)
    spread = max(abs(value - mean) for value in values)
    off = abs(mean - law)
    if off <= NEAR * max(rooms) or spread > SPREAD * off + NEAR * max(rooms):
        return None
    return mean, spread


def _broken(samples: Sequence[Sample]) -> list[Sample]:
    return [s for s in samples if s.defect > NEAR * s.room]


def _restitutions(laws: Laws, samples: Sequence[Sample], ids: Sequence[str]) -> Iterable[Fit | None]:
    """One restitution for all contacts, or for all of a sort; the others keep the law."""
    bad = [s for s in samples if abs(s.restitution - 1) > NEAR * s.room and s.aside <= NEAR * s.room + SPREAD]
    if len(bad) < FEWEST:
        return
    walls = lambda s: s.pair[1] >= laws.count or s.pair[1] in laws.scene.ends  # noqa: E731
    sorts: list[tuple[str, Callable[[Sample], bool]]] = [
        ("", lambda s: True),
        (" at walls", walls),
        (" between circles", lambda s: not walls(s)),
    ]
    named = lambda s: (ids[s.pair[0]], ids[s.pair[1]])  # noqa: E731
    # faces and ends have the name of what they are of
    sorts += [(f" of {name}", lambda s, name=name: name in named(s)) for name in dict.fromkeys(ids)]
    sorts += [
        (f" between {pair[0]} and {pair[1]}", lambda s, pair=pair: named(s) == pair)
        for pair in dict.fromkeys(map(named, bad))
    ]
    slow = min(s.speed for s in bad)
    sorts.append((f" above a normal speed of {slow:.3g}", lambda s: s.speed >= slow))
    fast = max(s.speed for s in bad)
    sorts.append((f" below a normal speed of {fast:.3g}", lambda s: s.speed <= fast))
    for words, holds in sorts:
        mine, others = [s for s in samples if holds(s)], [s for s in bad if not holds(s)]
        found = _one_value([s.restitution for s in mine], 1.0, [s.room for s in mine])
        if found is None or others or len(mine) < FEWEST:
            continue
        what = f"restitution {_ratio(laws, found[0])}{words}"
        if laws.restitution == 1.0 and (
            words.startswith(" at walls") or (words.startswith(" of ") and all(map(walls, mine)))
        ):
            what += f" (an impulse {_percent((1 - found[0]) / 2)})"
        yield Fit(what, len(mine), len(mine), *found, "restitution")


def _masses(laws: Laws, samples: Sequence[Sample], ids: Sequence[str]) -> Iterable[Fit | None]:
    """Masses taken for others: the ratio of the two changes of velocity has them."""
    pairs = [s for s in samples if not math.isnan(s.masses)]
    bad = [s for s in pairs if abs(s.masses - 1) > NEAR * s.room or s.lost > NEAR * s.room]
    if not bad:
        return
    share = [thing.share for thing in laws.things]

    def equal(s: Sample) -> bool:
        return abs(s.masses * (share[s.pair[1]] / share[s.pair[0]]) - 1) <= NEAR * s.room + SPREAD * 1e-6

    unlike = len({share[k] for s in bad for k in s.pair}) > 1
    if unlike and all(map(equal, pairs)):
        yield Fit("masses taken for equal", len(pairs), len(pairs), 1.0, 0.0, "mass")

    def swapped(s: Sample) -> bool:
        return abs(s.masses * (share[s.pair[1]] / share[s.pair[0]]) ** 2 - 1) <= NEAR * s.room + SPREAD * 1e-6

    if unlike and all(map(swapped, pairs)):
        yield Fit("masses taken for their inverse", len(pairs), len(pairs), -1.0, 0.0, "mass")
    for k, name in enumerate(ids[: laws.count]):
        mine, others = [s for s in pairs if k in s.pair], [s for s in bad if k not in s.pair]
        if others or not mine or not laws.moving[k]:
            continue
        ratios = [s.masses if s.pair[0] == k else 1 / s.masses if s.masses else math.inf for s in mine]
        found = _one_value(ratios, 1.0, [s.room for s in mine])
        if found is not None:
            mass = found[0] / share[k]
            what = f"the mass of {name} taken for {_told(mass, 1 / share[k])}"
            yield Fit(what, len(mine), len(mine), *found, "mass")


def _frictions(samples: Sequence[Sample]) -> Iterable[Fit | None]:
    """The speed across the line of centres changes, always in one ratio."""
    bad = [s for s in samples if s.aside > NEAR * s.room and not math.isnan(s.sliding)]
    if len(bad) < FEWEST:
        return
    found = _one_value([s.sliding for s in bad], 1.0, [s.room * s.speed for s in bad])
    if found is not None:
        yield Fit(
            f"the speed across the contact becomes {_told(found[0], 1.0)} of what it was", len(bad), len(bad), *found,
            "friction",
        )  # fmt: skip


def _sizes(laws: Laws, samples: Sequence[Sample], ids: Sequence[str]) -> Iterable[Fit | None]:
    """A radius, or the place of a wall, taken for another: all gaps of one thing are the same."""
    bad = [s for s in samples if abs(s.gap) > s.loose]
    if not bad:
        return
    every = _one_value([s.gap for s in samples], 0.0, [s.loose / NEAR for s in samples])
    if every is not None and len(samples) >= FEWEST:
        words = "apart" if every[0] > 0 else "into each other"
        yield Fit(f"contacts {abs(every[0]):.3g} {words}", len(samples), len(samples), *every, "correction")
    several = {ids[k] for k in laws.parts_places}
    for name in dict.fromkeys(ids):
        mine = [s for s in samples if name in (ids[s.pair[0]], ids[s.pair[1]])]
        others = [s for s in bad if name not in (ids[s.pair[0]], ids[s.pair[1]])]
        if others:
            continue
        found = _one_value([s.gap for s in mine], 0.0, [s.loose / NEAR for s in mine])
        if found is None:
            continue
        if name in several:
            thick = "thicker" if found[0] > 0 else "thinner"
            what = f"{name} taken to be {abs(found[0]):.3g} {thick} on each side"
            yield Fit(what, len(mine), len(mine), *found, "radius")
        elif ids.index(name) >= laws.count:
            side = "nearer" if found[0] > 0 else "farther"
            yield Fit(f"wall {name} taken to be {abs(found[0]):.3g} {side}", len(mine), len(mine), *found, "wall")
        else:
            more = "more" if found[0] > 0 else "less"
            what = f"the radius of {name} taken for {abs(found[0]):.3g} {more}"
            yield Fit(what, len(mine), len(mine), *found, "radius")


def _flights(flights: Sequence[Drift]) -> Iterable[Fit | None]:
    """Velocities that decay, an acceleration, or places that are moved without a flight."""
    bad = [d for d in flights if math.hypot(d.x, d.y) > d.room]
    if len(bad) < FEWEST:
        return
    rooms = [d.room for d in bad]
    decay = [(d, -2 * d.along / (d.speed * d.span**2)) for d in bad if d.speed and d.span]
    found = _one_value([v for _, v in decay], 0.0, [d.room / (d.speed * d.span**2) / NEAR for d, _ in decay])
    if found is not None and len(decay) == len(bad):
        yield Fit(
            f"speeds that fall by {found[0]:.3g} of themselves a unit of time", len(bad), len(bad), *found, "damping"
        )
    share = [d.along / (d.speed * d.span) for d in bad if d.speed and d.span]
    found = _one_value(share, 0.0, [d.room / (d.speed * d.span) / NEAR for d in bad if d.speed and d.span])
    if found is not None and len(share) == len(bad):
        yield Fit(f"ways {_percent(-found[0])} than speed times time", len(bad), len(bad), *found, "damping")
    yield from _accelerations(flights)
    found = _one_value([math.hypot(d.x, d.y) for d in bad], 0.0, [room / NEAR for room in rooms])
    if found is not None:
        yield Fit(f"places moved by {found[0]:.3g}, without a flight", len(bad), len(bad), *found, "correction")


def _accelerations(flights: Sequence[Drift]) -> Iterable[Fit | None]:
    """One acceleration along an axis, beside that of the scene."""
    bad = [d for d in flights if math.hypot(d.x, d.y) > d.room]
    if len(bad) < FEWEST:
        return
    for axis, name in ((0, "x"), (1, "y")):
        pulls = [2 * (d.x, d.y)[axis] / d.span**2 for d in bad if d.span]
        found = _one_value(pulls, 0.0, [2 * d.room / d.span**2 / NEAR for d in bad if d.span])
        if found is not None:
            yield Fit(f"an acceleration of {found[0]:.3g} along {name}", len(bad), len(bad), *found, "acceleration")


def _once(laws: Laws, samples: Sequence[Sample], ids: Sequence[str]) -> Iterable[Fit | None]:
    """A single impact that is off."""
    bad = _broken(samples)
    if len(bad) != 1:
        return
    (only,) = bad
    if abs(only.restitution - 1) > SPREAD * only.defect:
        what = f"restitution {_ratio(laws, only.restitution)} at event {only.event} alone"
    else:
        what = f"an impulse {only.aside:.3g} off the line of centres at event {only.event} alone"
    yield Fit(f"{what} ({ids[only.pair[0]]} and {ids[only.pair[1]]})", 1, 1, only.restitution, 0.0, "once")


def _told(value: float, law: float) -> str:
    """A number to three digits of what it differs from the law by.

    >>> _told(0.98, 1.0), _told(0.9990000001, 1.0), _told(1.0000012, 1.0)
    ('0.98', '0.999', '1.0000012')
    """
    off = abs(value - law)
    digits = max(0, 2 - math.floor(math.log10(off))) if off else 0
    text = f"{value:.{min(digits, 17)}f}"
    return text.rstrip("0").rstrip(".") if "." in text else text


def _percent(share: float) -> str:
    """A share that is less, or more, in words.

    >>> _percent(0.03), _percent(-0.5)
    ('3 % less', '50 % more')
    """
    return f"{abs(100 * share):.3g} % {'less' if share > 0 else 'more'}"
