"""Other runs at a divergence: the exact engine on the rounded scene, finer steps, and the numbers that decide."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from decimal import Decimal
from fractions import Fraction
from functools import cached_property
from typing import Any, TypeAlias

import numpy as np

from truebreak.compare.alignment.instants import Divergence, Kind
from truebreak.compare.candidate import Candidate
from truebreak.compare.comparison import studied
from truebreak.compare.deadline import Clock
from truebreak.compare.study import Study, run_or_unable
from truebreak.exact import ExactEngine
from truebreak.exact.numbers.system import Undecided
from truebreak.scenarios import (
    Circle,
    Declared,
    Pocket,
    Polygon,
    Quantity,
    Scene,
    SceneError,
    Segment,
    State,
    Trajectory,
    Wall,
)

DIGITS = 120
"""Decimal digits by which numbers with roots are rounded; a number this near to a rounding's edge would be missed."""

HALVINGS = 8
MOST_STEPS, FARTHER = 100_000, 8
"""How far finer steps are run: 1/256 of the step, and so many steps at most in one run; a few times as many where it is
claimed that a finer one passes."""

PAST = 3
"""Events past the one in question to which runs go."""


def rational(value: Quantity) -> Fraction:
    """A scene's number, or what agrees with it to `DIGITS` digits."""
    exact = value.fraction
    return Fraction(value.digits(DIGITS)) if exact is None else exact


PAIR = 106
"""Bits of a pair of doubles: the nearest double, and the nearest to what it leaves."""


def nearest(value: Fraction, bits: int) -> Fraction:
    """The nearest number of so many bits, ties to even; the exponent has no limits.

    >>> nearest(Fraction(1, 3), 4), nearest(Fraction(9, 2), 3)
    (Fraction(11, 32), Fraction(4, 1))
    """
    if not value:
        return value
    if bits == PAIR:
        high = nearest(value, PAIR // 2)
        return high + nearest(value - high, PAIR // 2)
    exponent = abs(value.numerator).bit_length() - value.denominator.bit_length()
    unit = Fraction(2) ** (exponent - bits)
    while abs(value) / unit >= 2**bits:
        unit *= 2
    return round(value / unit) * unit


def rounded_scene(scene: Scene, bits: int, part: Fraction = Fraction(1)) -> Scene:
    """The scene with every number replaced by the nearest of so many bits, or moved a part of the way there.

    Raises:
        SceneError: where that is no scene: circles overlap.
    """

    def number(value: Quantity) -> str:
        exact = rational(value)
        return str(exact + part * (nearest(exact, bits) - exact))

    circles = [
        Circle(
            *(number(getattr(c, key)) for key in ("x", "y", "r", "vx", "vy")),
            m="oo" if c.fixed else number(c.m),  # type: ignore[arg-type]
            id=c.id,
            point=c.point,
        )
        for c in scene.circles
    ]
    moving = ("x0", "y0", "x1", "y1", "vx", "vy")
    walls = [Wall(id=w.id, **{key: number(getattr(w, key)) for key in moving}) for w in scene.walls]
    pockets = [Pocket(*(number(getattr(p, key)) for key in ("x", "y", "r")), id=p.id) for p in scene.pockets]
    changes: dict[str, Any] = {} if scene.reverse_at is None else {"reverse_at": number(scene.reverse_at)}
    if scene.gravity is not None:
        changes["gravity"] = tuple(map(number, scene.gravity))
    if not scene.elastic:
        changes["restitution"] = number(scene.restitution)
    pace = ("r", "vx", "vy")
    if scene.segments:
        ends = ("x0", "y0", "x1", "y1")
        changes["segments"] = [
            Segment(
                *(number(getattr(s, key)) for key in ends), id=s.id, **{key: number(getattr(s, key)) for key in pace}
            )
            for s in scene.segments
        ]
    if scene.polygons:
        changes["polygons"] = [
            Polygon(
                [(number(x), number(y)) for x, y in p.points], id=p.id, **{key: number(getattr(p, key)) for key in pace}
            )
            for p in scene.polygons
        ]
    return scene.with_changes(circles=circles, walls=walls, pockets=pockets, **changes)


@dataclass(frozen=True)
class OnRounded(Declared):
    """The exact engine, which takes a scene for the one that is rounded to so many bits."""

    to: int
    name: str = "exact on the rounded scene"
    scene_keys: Any = ExactEngine().scene_keys

    def run(self, scene: Scene, **limits: Any) -> Trajectory:
        """The certified run of the rounded scene."""
        other = rounded_scene(scene, self.to)
        return replace(ExactEngine().run(other, **limits), scene=scene, engine=self.name)


SAME, PASSES, OTHER, EARLIER, OPEN, REFUSED = "same", "passes", "other", "earlier", "open", "refused"
"""What another run does at the decision: as the engine did; as the reference did; a third thing; it has left before;
not known; it cannot take the scene."""


def dear(engine: Any) -> float:
    """What a step of an engine costs, in fours of microseconds, as far as it says so."""
    return float(getattr(engine, "step_microseconds", 2.0)) / 4


class Runs:
    """Other runs of one divergence, each made when it is asked for."""

    def __init__(self, scene: Scene, engine: Any, candidate: Candidate) -> None:
        assert candidate.alignment.divergence is not None
        self.scene, self.engine, self.candidate = scene, engine, candidate
        self.at: Divergence = candidate.alignment.divergence
        self.events = max(self.at.event, self.at.expected_event) + PAST

    @cached_property
    def study(self) -> Study:
        """The certified run, a little past the decision."""
        return studied(self.scene, ExactEngine(), Clock(None), None, self.events)

    def does(self, engine: Any) -> str:
        """What another engine does at the decision."""
        try:
            _, alignment, unable = run_or_unable(self.study, engine, None)
        except SceneError:
            return REFUSED
        if unable:
            return REFUSED
        parted = alignment.divergence
        if parted is None:
            agreed = alignment.verdict == "agree" or alignment.agreed > max(self.at.event, self.at.expected_event)
            return PASSES if agreed else OPEN
        mine, theirs = ((d.body, d.kind, d.expected, d.got, d.own_event) for d in (self.at, parted))
        if mine == theirs:
            return SAME
        if parted.event != self.at.event:
            return PASSES if parted.event > self.at.event else EARLIER
        if mine[:4] == theirs[:4]:
            return SAME
        has = self.at.expected_event in {mine for mine, _ in alignment.walks[self.at.body].pairs}
        return PASSES if has and parted.expected_event > self.at.expected_event else OTHER

    @cached_property
    def input(self) -> str:
        """What the exact engine does on the scene rounded to the engine's bits."""
        if self.engine.bits is None or not self.engine.rounds_input:
            return PASSES  # there is no rounding of the input
        return REFUSED if self.given is None else self.does(OnRounded(self.engine.bits))

    @cached_property
    def given(self) -> Scene | None:
        """The scene as the engine is given it; None where that is no scene."""
        if self.engine.bits is None or not self.engine.rounds_input:
            return self.scene
        try:
            return rounded_scene(self.scene, self.engine.bits)
        except SceneError:
            return None

    @cached_property
    def finer(self) -> list[tuple[float, str]]:
        """What finer steps do, down to the second in a row that passes."""
        return self._finer(MOST_STEPS)

    @cached_property
    def finest(self) -> list[tuple[float, str]]:
        """The same, farther."""
        return self.finer if PASSES in [s for _, s in self.finer] else self._finer(MOST_STEPS * FARTHER)

    def _finer(self, most: int) -> list[tuple[float, str]]:
        done: list[tuple[float, str]] = []
        engine = self.engine
        end = max(t for t in (self.at.time, self.at.expected_time, self.at.got_time) if t is not None)
        for _ in range(HALVINGS):
            engine = engine.finer()
            if (
                engine is None
                or end / engine.step > most / max(1.0, dear(engine))
                or [s for _, s in done[-2:]] == [PASSES, PASSES]
            ):
                break
            done.append((engine.step, self.does(engine)))
        return done

    @property
    def step_passes(self) -> float | None:
        """The coarsest step from which on the finer ones that were run pass, two of them at least."""
        if [s for _, s in self.finer[-2:]] != [PASSES, PASSES]:
            return None
        engine = self.engine
        for _ in self.finer:
            engine = engine.finer()
        for _ in range(
            2
        ):  # two that pass may do so by chance, where rounding decides; what cannot be run refutes nothing
            engine = engine.finer()
            if engine is None or dear(engine) * self.at.time / engine.step > MOST_STEPS or self.does(engine) != PASSES:
                return None
        return self.finer[-2][0]

    @cached_property
    def firmer(self) -> list[str]:
        """What four and sixteen times the solver's iterations do."""
        done: list[str] = []
        engine = self.engine
        for k in range(4):
            engine = engine.firmer() if engine is not None else None
            if engine is None:
                break
            if k % 2:
                done.append(self.does(engine))
        return done

    @cached_property
    def broken(self) -> str | None:
        """The first law that the engine did not keep by then, by the audit; None where it is not known to break one."""
        laws = self.candidate.laws
        if laws is None or laws.kept is not False:
            return None
        early = [v for v in laws.violations if v.time <= self.at.time * (1 + 1e-9) and v.kind not in ("depth", "gap")]
        return str(early[0]) if early else None

    @cached_property
    def tied(self) -> bool:
        """Whether the exact run has several contacts of one instant in question, or some that lasted up to it."""
        if self.at.kind is Kind.TIE or self.scene.touching:
            return True
        run = ExactEngine().run(self.scene, events=self.events)
        return any(len(e.contacts) > 1 or e.ties for e in run.events[: self.at.expected_event + 1])

    @cached_property
    def got(self) -> tuple[float, float] | None:
        """Of the contact that the engine has too many: how far apart, and how fast the two come nearer, in its run."""
        if self.at.candidate_event is None or self.at.got is None:
            return None
        run = self.candidate.trajectory
        if len(run.events[self.at.candidate_event].impulses) > 1:
            return None  # what the two do between the impulses of one instant is not reported
        try:
            return approach(run, self.at.candidate_event, self.at.body, self.at.got)
        except (KeyError, IndexError, ValueError, StopIteration, ZeroDivisionError):
            return None

    @cached_property
    def least(self) -> float | None:
        """How near the expected two come in the engine's own flights, as a share of the sum of their radii."""
        if self.at.expected is None or self.at.expected_time is None or self.at.kind is Kind.TIE:
            return None
        try:
            return least_gap(self.candidate.trajectory, self.at.body, self.at.expected, self.at.expected_time)
        except (KeyError, ValueError, IndexError, StopIteration, ZeroDivisionError):
            return None


Row: TypeAlias = tuple[float, float, float, float]


def rows_of(state: State) -> dict[str, Row]:
    """x, y, vx, vy of every circle, as doubles."""
    return {c.id: (float(c.x), float(c.y), float(c.vx), float(c.vy)) for c in state.circles}


def apart(scene: Scene, rows: dict[str, Row], one: str, other: str, time: float) -> tuple[float, float, float, float]:
    """Of a circle and a circle or wall after so much free flight: the gap, and the speed with which it closes.

    Then the sum of the radii, and the time, from 0 to the given one, at which the gap is least.
    """
    radii = {str(c.id): float(c.r) for c in scene.circles}
    if one not in radii:
        one, other = other, one
    x, y, vx, vy = rows[one]
    if other in radii:
        p, q, u, w = rows[other]
        reach, dx, dy, ux, uy = radii[one] + radii[other], p - x, q - y, u - vx, w - vy
        speed = ux * ux + uy * uy
        nearest_at = -(dx * ux + dy * uy) / speed if speed else 0.0
    else:
        wall = next(w for w in scene.walls if w.id == other)
        x0, y0, x1, y1 = (float(getattr(wall, key)) for key in ("x0", "y0", "x1", "y1"))
        nx, ny = (y0 - y1) / math.hypot(x1 - x0, y1 - y0), (x1 - x0) / math.hypot(x1 - x0, y1 - y0)
        height, rise = nx * (x - x0) + ny * (y - y0), nx * vx + ny * vy
        reach, dx, dy, ux, uy = radii[one], height * nx, height * ny, rise * nx, rise * ny
        nearest_at = -height / rise if rise else 0.0
    dx, dy = dx + time * ux, dy + time * uy
    length = math.hypot(dx, dy)
    return length - reach, -(dx * ux + dy * uy) / length, reach, min(max(nearest_at, 0.0), time)


def approach(run: Trajectory, event: int, one: str, other: str) -> tuple[float, float]:
    """The gap of two at an event of a run, as a share of their radii, and the speed with which they come nearer.

    That is a share of the fastest circle's; both are by what the run reports of the event before.
    """
    before = run.after(event - 1) if event else run.at(0)
    rows = rows_of(before)
    gap, speed, reach, _ = apart(run.scene, rows, one, other, float(run.events[event].time) - float(before.time))
    return gap / reach, speed / max(math.hypot(*row[2:]) for row in rows.values())


def pushed(run: Trajectory, event: int) -> float:
    """By how much an event of a run changes a velocity; 0 under gravity, where it changes between events too."""
    if run.scene.gravity is not None:
        return 0.0
    before = rows_of(run.after(event - 1) if event else run.at(0))
    after, names = rows_of(run.after(event)), {name for pair in run.events[event].impulses for name in pair}
    return max((math.dist(before[name][2:], after[name][2:]) for name in names & after.keys()), default=0.0)


def met(run: Trajectory) -> dict[str, list[tuple[int, str]]]:
    """Whom each circle that can move meets at which event, in order; the contacts of one instant by name."""
    found: dict[str, list[tuple[int, str]]] = {str(c.id): [] for c in run.scene.circles if not c.fixed}
    for event in run.events:
        for name in found:
            partners = sorted(b if a == name else a for a, b in event.impulses if name in (a, b))
            found[name] += [(event.index, partner) for partner in partners]
    return found


def least_gap(run: Trajectory, one: str, other: str, time: float) -> float:
    """The least gap of two around a time, over the flights of the run that hold it and those beside them.

    As a share of the sum of their radii; flights are straight between the run's events.
    """
    times = sorted({0.0, float(run.final_time), *(float(e.time) for e in run.events)})
    near = [k for k, t in enumerate(times) if t <= time][-1]
    least = math.inf
    for k in range(max(0, near - 1), min(near + 2, len(times) - 1)):
        rows = rows_of(run.at(times[k]))
        at = apart(run.scene, rows, one, other, times[k + 1] - times[k])[3]
        gap, _, reach, _ = apart(run.scene, rows, one, other, at)
        least = min(least, gap / reach)
    return least


PRECISE = 110
"""Decimal digits in which decisions are computed."""

SMALL = Fraction(1, 2**150)
"""The part of a rounding by which the first order is found: its square is below everything."""


def decimal(value: Any) -> Decimal:
    """A number of a run: certified digits of an exact one, else its double; 0 where it is not told from 0."""
    try:
        return Decimal(value.digits(100))
    except Undecided:
        return Decimal(0)
    except (AttributeError, ValueError):
        return Decimal(value.numerator) / value.denominator if isinstance(value, Fraction) else Decimal(float(value))


def rows_after(run: Trajectory, event: int) -> dict[str, tuple[Decimal, ...]]:
    """x, y, vx, vy of every circle after an event; at the start for -1."""
    state = run.after(event) if event >= 0 else run.at(0)
    return {str(c.id): tuple(decimal(getattr(c, key)) for key in ("x", "y", "vx", "vy")) for c in state.circles}


def falls_by(
    row: tuple[Decimal, ...], place: tuple[Decimal, ...], gravity: tuple[Decimal, Decimal], reach: Decimal
) -> tuple[Decimal, Decimal | None]:
    """How near a circle that falls comes to a point, less a length, and when it first comes within that; else None.

    >>> ball, peg, gravity = tuple(map(Decimal, (0, 9, 0, 0))), (Decimal(0), Decimal(0)), (Decimal(0), Decimal(-2))
    >>> [round(number, 9) for number in falls_by(ball, peg, gravity, Decimal(5))]
    [Decimal('-5.000000000'), Decimal('2.000000000')]
    """
    (x, y, vx, vy), (px, py), (gx, gy) = row, place, gravity

    def square(s: Decimal) -> Decimal:
        return (x + vx * s + gx * s * s / 2 - px) ** 2 + (y + vy * s + gy * s * s / 2 - py) ** 2

    def rate(s: Decimal) -> Decimal:
        dx, dy = x + vx * s + gx * s * s / 2 - px, y + vy * s + gy * s * s / 2 - py
        return 2 * (dx * (vx + gx * s) + dy * (vy + gy * s))

    def curve(s: Decimal) -> Decimal:
        dx, dy = x + vx * s + gx * s * s / 2 - px, y + vy * s + gy * s * s / 2 - py
        return 2 * ((vx + gx * s) ** 2 + (vy + gy * s) ** 2 + dx * gx + dy * gy)

    def newton(f: Callable[[Decimal], Decimal], slope: Callable[[Decimal], Decimal], s: float) -> Decimal:
        at = Decimal(s)
        for _ in range(12):
            at -= f(at) / slope(at)
        return at

    a, b = np.array([float(gx) / 2, float(vx), float(x - px)]), np.array([float(gy) / 2, float(vy), float(y - py)])
    quartic = np.polyadd(np.polymul(a, a), np.polymul(b, b))
    minima = [newton(rate, curve, s) for s in real_roots(np.polyder(quartic)) if s > 0 and curve(Decimal(s)) > 0]
    least = min((square(s).sqrt() for s in minima), default=square(Decimal(0)).sqrt()) - reach
    quartic[-1] -= float(reach) ** 2
    enters = [s for s in real_roots(quartic) if s > 1e-9 and rate(Decimal(s)) < 0]
    wait = newton(lambda s: square(s) - reach * reach, rate, min(enters)) if enters else None
    return least, wait


def real_roots(coefficients: Any) -> list[float]:
    """The real roots of a polynomial, the highest power first, as doubles tell them."""
    return [float(root.real) for root in np.roots(coefficients) if abs(root.imag) <= 1e-7 * abs(root)]


Outline = Callable[[Any, Any], Any]
"""How far points are from a thing: of arrays of x and of y."""


def _from_line(x0: float, y0: float, x1: float, y1: float, r: float) -> Outline:
    ux, uy = x1 - x0, y1 - y0

    def far(x: Any, y: Any) -> Any:
        share = np.clip(((x - x0) * ux + (y - y0) * uy) / (ux * ux + uy * uy), 0, 1)
        return np.hypot(x - x0 - share * ux, y - y0 - share * uy) - r

    return far


def _from_arc(cx: float, cy: float, r: float, ends: Sequence[tuple[float, float]]) -> Outline:
    def far(x: Any, y: Any) -> Any:
        found = abs(np.hypot(x - cx, y - cy) - r)
        if not ends:
            return found
        first, last = (math.atan2(b - cy, a - cx) for a, b in ends)
        within = np.mod(np.arctan2(y - cy, x - cx) - first, 2 * math.pi) <= (last - first) % (2 * math.pi)
        return np.where(within, found, np.minimum(*(np.hypot(x - a, y - b) for a, b in ends)))

    return far


def outlines_of(scene: Scene) -> dict[str, Outline]:
    """The segments, polygons and arcs of a scene, by id."""
    found: dict[str, Outline] = {}
    for s in scene.segments:
        found[str(s.id)] = _from_line(*map(float, (s.x0, s.y0, s.x1, s.y1, s.r)))
    for g in scene.polygons:
        places = [(float(x), float(y)) for x, y in g.points]
        sides = [_from_line(*a, *b, float(g.r)) for a, b in zip(places, [*places[1:], places[0]], strict=True)]
        found[str(g.id)] = lambda x, y, sides=sides: np.min([far(x, y) for far in sides], axis=0)
    for a in scene.arcs:
        ends = [(float(x), float(y)) for x, y in a.ends]
        found[str(a.id)] = _from_arc(float(a.x), float(a.y), float(a.r), ends)
    return found


LONGEST, LOOKS = 8.0, 400_001
"""How long a flight is looked at, and at how many of its places."""


def comes_to(far: Outline, row: Sequence[Decimal], gravity: Any, radius: Decimal) -> tuple[float | None, float | None]:
    """How near a flight passes a thing, by looking at many places of it; and when it is there, by halving."""
    (x, y, vx, vy), (gx, gy), r = map(float, row), map(float, gravity), float(radius)

    def gap(t: Any) -> Any:
        return far(x + t * (vx + t * gx / 2), y + t * (vy + t * gy / 2)) - r

    times = np.linspace(0, LONGEST, LOOKS)
    gaps = gap(times)
    falls = np.flatnonzero((gaps[1:-1] > 0) & (gaps[2:] <= 0))
    if not falls.size:
        least = 1 + np.flatnonzero((gaps[:-2] > gaps[1:-1]) & (gaps[1:-1] <= gaps[2:]))
        if not least.size:
            return None, None
        k = least[np.argmin(gaps[least])]
        return float(gap(np.linspace(times[k - 1], times[k + 1], LOOKS)).min()), None
    low, high = times[falls[0] + 1], times[falls[0] + 2]
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if gap(middle) > 0 else (low, middle)
    return None, float(high)


def decisions(
    scene: Scene, run: Trajectory, event: int, at: Divergence, entries: Iterable[tuple[str, str]] = ()
) -> dict[str, Decimal]:
    """What may decide a divergence, in free flight from how the event before it leaves a run.

    The least gap of the body and each circle in question from the last contact of either on, the speed at which it
    leaves each wall in question, and the time between its two meetings, where it has two. The same of circles and the
    rims of pockets, where one run alone has an entry.
    """
    rows = rows_after(run, event - 1)
    radii = {str(c.id): decimal(c.r) for c in scene.circles}
    walls = {str(w.id): w for w in scene.walls}
    found: dict[str, Decimal] = {}
    waits: list[Decimal] = []
    x, y, vx, vy = rows[at.body]
    fixed = {str(c.id) for c in scene.circles if c.fixed}
    moving = {str(s.id): (s.vx, s.vy) for s in (*scene.segments, *scene.polygons) if s.moves}
    outlines = outlines_of(scene)
    if scene.gravity is None:
        outlines = {name: far for name, far in outlines.items() if name in moving}
    of: dict[str, Decimal] = {}
    for other in at.partners:
        count = len(waits)
        if other in outlines:
            last = max((e.index for e in run.events[:event] for pair in e.impulses if at.body in pair), default=-1)
            began = decimal(run.events[last].time) if last >= 0 else Decimal(0)
            now = decimal(run.events[event - 1].time) if event else Decimal(0)
            px, py, pvx, pvy = rows_after(run, last)[at.body]
            ux, uy = map(decimal, moving.get(other, (0, 0)))  # as seen from what moves
            row = px - ux * began, py - uy * began, pvx - ux, pvy - uy
            low, late = comes_to(outlines[other], row, scene.gravity or (0, 0), radii[at.body])
            if late is not None:
                waits.append(began + Decimal(late) - now)
            elif low is not None:
                found[f"gap to {other}"] = Decimal(low)
        if other in fixed and scene.gravity is not None:
            last = max((e.index for e in run.events[:event] for pair in e.impulses if at.body in pair), default=-1)
            began = decimal(run.events[last].time) if last >= 0 else Decimal(0)
            now = decimal(run.events[event - 1].time) if event else Decimal(0)
            then = rows_after(run, last)
            reach = radii[at.body] + radii[other]
            least, wait = falls_by(
                then[at.body], then[other][:2], (decimal(scene.gravity[0]), decimal(scene.gravity[1])), reach
            )
            found[f"gap to {other}"] = least
            waits += [] if wait is None else [began + wait - now]
        elif other in radii and other != at.body:
            dx, dy, ux, uy = (b - a for a, b in zip(rows[at.body], rows[other], strict=True))
            reach, speed, cross, near = (
                radii[at.body] + radii[other],
                ux * ux + uy * uy,
                dx * uy - dy * ux,
                dx * ux + dy * uy,
            )
            if speed:
                found[f"gap to {other}"] = abs(cross) / speed.sqrt() - reach
                last = max(
                    (e.index for e in run.events[:event] for pair in e.impulses if {at.body, other} & {*pair}),
                    default=-1,
                )
                then = rows_after(run, last)
                dx0, dy0 = (b - a for a, b in zip(then[at.body][:2], then[other][:2], strict=True))
                if dx0 * ux + dy0 * uy > 0:  # from there on they part
                    found[f"gap to {other}"] = (dx0 * dx0 + dy0 * dy0).sqrt() - reach
                root = speed * reach * reach - cross * cross
                if near < 0 < root:
                    waits.append((dx * dx + dy * dy - reach * reach) / (-near + root.sqrt()))
        elif other in walls:
            x0, y0, x1, y1 = (decimal(getattr(walls[other], key)) for key in ("x0", "y0", "x1", "y1"))
            length = ((x1 - x0) ** 2 + (y1 - y0) ** 2).sqrt()
            nx, ny = (y0 - y1) / length, (x1 - x0) / length
            now = decimal(run.events[event - 1].time) if event else Decimal(0)
            ux, uy = decimal(walls[other].vx), decimal(walls[other].vy)
            height = nx * (x - x0 - ux * now) + ny * (y - y0 - uy * now)
            rise = nx * (vx - ux) + ny * (vy - uy)
            gx, gy = (0, 0) if scene.gravity is None else map(decimal, scene.gravity)
            pull = nx * gx + ny * gy
            if height < 0:
                height, rise, pull = -height, -rise, -pull
            gap = height - radii[at.body]
            square = rise * rise - 2 * gap * pull  # of the speed at which it is there
            if pull > 0:
                found[f"gap to {other}"] = gap if rise >= 0 else -square / (2 * pull)
            elif pull < 0:
                found[f"speed from {other}"] = -max(square, Decimal(0)).sqrt()
            else:
                found[f"speed from {other}"] = rise
            if square >= 0 and (rise < 0 or pull < 0):
                root = square.sqrt()
                waits.append(2 * gap / (root - rise) if rise < 0 else (-rise - root) / pull)
        of.update({other: waits[-1]} if len(waits) > count else {})
    if len(waits) == 2:
        found["time between"] = waits[1] - waits[0]
    for name, pocket in entries:
        hole = next(p for p in scene.pockets if p.id == pocket)
        last = max((e.index for e in run.events[:event] for pair in e.impulses if name in pair), default=-1)
        began, now = (decimal(run.events[k].time) if k >= 0 else Decimal(0) for k in (last, event - 1))
        gx, gy = (Decimal(0), Decimal(0)) if scene.gravity is None else map(decimal, scene.gravity)
        place = (decimal(hole.x), decimal(hole.y))
        least, wait = falls_by(rows_after(run, last)[name], place, (gx, gy), decimal(hole.r))
        found[f"gap of {name} to {pocket}"] = least
        if wait is not None:
            found.update(
                {f"time from {name} in {pocket} to {k}": late - (began + wait - now) for k, late in of.items()}
            )
    return found
