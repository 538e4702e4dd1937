"""How two runs part, number by number: the first difference, how it grows by body, and where it leaps."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from decimal import Decimal
from itertools import chain
from typing import Any

import numpy as np

from ..validation import EngineError
from .log_format import Log, LogRecord

NEVER = -math.inf
"""The size of no difference, in bits."""

SAMPLED = 2_000
"""Points of a curve that are kept; beyond that every other one is dropped, and so on."""

CURVES = 48
"""Bodies whose growth is kept by itself: those that differ first."""

EARLY = 4_000
"""Differences among which the first is looked for: in a log of events they come nearly in order."""

SPEEDS = ("v", "w", "spin", "omega", "ang_vel", "angular", "lin_vel", "linvel")
"""How names of velocities begin."""

LEAP_DOUBLE, LEAP_SINGLE = 16.0, 9.0
"""Bits by which a difference grows within one record at most: in the trials by 7 at a collision that is no graze."""

STEP_BITS = 6.0
"""Bits below the size of a scene of what a body goes in a step."""

RARE = 6.0
"""Bits of improbability from which chance is no explanation: one in 64."""

LEAST = 2.0**-6
"""What is far smaller than the largest numbers of a state, as a spin that is nothing but noise, is measured at this
share of them: it is reckoned from them."""

FAR = 5
"""Bits below the whole number at which a difference has grown as far as it can: a 32nd of the scene."""


@dataclass(frozen=True)
class Difference:
    """A number that is not the same in both runs.

    Attributes:
        number: its record, in the first log; `step`, `time` and `lines` say where that is.
        body, name: whose number, and which.
        a, b: the two.
        bits: log2 of their difference in ulps of the largest number of that name.
        fresh: whether this body had no record before that was the same in both.
        gap: records since the last one in which the body was the same in both; 0 if it is unknown.
        touching: whether it is in contact, in either run, at that record.
        before: bits by which it, and what it is in contact with, were off before; -inf for nothing.
        placed: whether the time and the numbers that say where it is are the same in both.
    """

    number: int
    step: int | None
    time: float | None
    lines: tuple[int, int]
    body: str
    name: str
    a: float
    b: float
    bits: float
    fresh: bool
    gap: int
    touching: bool
    before: float
    placed: bool


@dataclass
class ThinnedCurve:
    """Points (record, time, bits), thinned out as they become many."""

    points: list[tuple[int, float, float]] = field(default_factory=list)
    stride: int = 1
    seen: int = 0

    def add(self, number: int, time: float, bits: float) -> None:
        """One more point."""
        if self.seen % self.stride == 0:
            self.points.append((number, time, bits))
            if len(self.points) >= SAMPLED:
                self.points, self.stride = self.points[::2], self.stride * 2
        self.seen += 1


@dataclass(frozen=True)
class GrowthRate:
    """How fast a difference grew: bits a record, and bits a unit of time, each with its standard error."""

    bits_per_record: float
    record_error: float
    bits_per_time: float | None
    time_error: float | None
    points: int


@dataclass(frozen=True)
class LogDigits:
    """How many digits the numbers of a log have, where that is fewer than their type has.

    Attributes:
        digits, decimals: significant, or after the point; neither for numbers of 24 bits.
        side: whose numbers have fewer than the other's; None where those of both have no more.
    """

    digits: int | None
    decimals: int | None
    side: int | None = None

    @property
    def words(self) -> str:
        """What the numbers are."""
        if self.decimals is not None:
            return f"numbers of {self.decimals} digits after the point"
        return "numbers of 24 bits" if self.digits is None else f"numbers of {self.digits} digits"

    def last(self, value: float) -> float:
        """The size of the last digit of a number of such a size."""
        if self.decimals is not None:
            return 10.0**-self.decimals
        if self.digits is None:
            return 2.0**-23 * value
        return 10.0 ** (math.floor(math.log10(value)) + 1 - self.digits) if value else 0.0

    def explains(self, a: float, b: float) -> bool:
        """Whether two numbers are the same but for what was left out: by one of the last digit."""
        largest = max(abs(a), abs(b))
        return a == b or (largest < math.inf and abs(a - b) <= 1.01 * self.last(largest))


class Unit:
    """What one rounding is, of each number of a state: its type's ulp at the largest such number so far.

    Attributes:
        bits: 24 or 53, as declared or as the numbers show.
        coarse: the digits of the logs, or of one of them, where they are fewer than the type has: a difference that is
            seen first is then one of the log's.
    """

    def __init__(self, bits: int, coarse: LogDigits | None = None) -> None:
        self.bits, self.coarse = bits, coarse
        self.ulp = 2.0 ** (1 - bits)
        self._ulp_bits = 1.0 - bits
        self.scales: dict[Any, list[float]] = {}
        self.largest = 0.0

    def widen(self, row: Sequence[float], key: Any = None) -> None:
        """Takes a state into the largest numbers."""
        scales = self._scales(key, len(row))
        for j, value in enumerate(row):
            size = abs(value)
            if scales[j] < size < math.inf:
                scales[j] = size
                if key is None and size > self.largest:
                    self.largest = size

    def _scales(self, key: Any, width: int) -> list[float]:
        """The largest numbers so far of one kind of row."""
        scales = self.scales.get(key)
        if scales is None:
            scales = self.scales[key] = []
        if len(scales) < width:
            scales.extend([0.0] * (width - len(scales)))
        return scales

    def most_off(self, one: Sequence[float], other: Sequence[float], key: Any) -> tuple[float, int]:
        """log2 of the largest difference of two rows, in ulps at the largest such number, and which number it is of."""
        worst, place, j = 0.0, 0, -1
        scales = self.scales.get(key)
        if scales is None or len(scales) < len(one):
            scales = self._scales(key, len(one))
        least = self.largest * LEAST if key is None else 0.0
        for x, y in zip(one, other, strict=True):
            j += 1
            if x == y:
                continue
            off = x - y if x > y else y - x
            if not off < math.inf:
                if math.isnan(x) and math.isnan(y):
                    continue
                return math.inf, j
            scale = scales[j]
            if not (-scale <= x <= scale and -scale <= y <= scale):
                scale = scales[j] = max(x, y, -x, -y)
                if key is None and scale > self.largest:
                    self.largest, least = scale, scale * LEAST
            scale = max(scale, least)
            if off > worst * scale:
                worst, place = off / scale, j
        return (math.log2(worst) - self._ulp_bits if worst else NEVER), place

    @property
    def whole(self) -> float:
        """Bits of a difference as large as the largest number."""
        return float(self.bits - 1)


def unit_of(logs: Sequence[Log], heads: Sequence[Sequence[LogRecord]]) -> Unit:
    """The unit of two logs, by what they declare, by the digits of their first numbers, or by those of their times."""
    declared = {bits for log in logs if isinstance(bits := log.header.get("bits"), int)}
    strange = declared - {11, 24, 53, 64, 113}
    if strange:
        raise EngineError(f"file {logs[0].name!r}: bits = {min(strange)}; must be 24 for floats, 53 for doubles")
    each = [list(_numbers(head)) for head in heads]
    return _unit(each, declared) if any(each) else unit_of_times(heads, declared)


def unit_of_times(heads: Sequence[Sequence[LogRecord]], declared: Iterable[int] = ()) -> Unit:
    """The unit of the times of two logs."""
    return _unit([[t for r in head if (t := r.time) is not None and t != int(t)] for head in heads], set(declared))


def _unit(each: Sequence[Sequence[float]], declared: set[int]) -> Unit:
    """The unit of the numbers of two logs."""
    values = [*chain.from_iterable(each)]
    single = [len(numbers) >= 8 and all(map(_single, numbers)) for numbers in (*each, values)]
    written = [_written(numbers) for numbers in (*each, values)]
    bits = min(min(declared) if declared else 24 if single[2] else 53, 53)
    if single[2] or declared == {24}:
        few = [(d or SINGLE_DIGITS) < SINGLE_DIGITS or (n or SINGLE_DIGITS) < SINGLE_DIGITS for d, n in written[:2]]
        if few[0] != few[1]:
            side = few.index(True)
            return Unit(bits, LogDigits(*written[side], side))
    elif written[0] != written[1]:
        ranks = [(d is not None, d or 0, n is not None, n or 0) for n, d in written[:2]]
        short = [side for side in (0, 1) if written[side] != (None, None)]
        side = short[0] if len(short) == 1 else ranks.index(min(ranks))
        return Unit(bits, LogDigits(*written[side], side))
    if not declared and single[0] != single[1]:
        return Unit(bits, LogDigits(None, None, single.index(True)))
    few = written[2]
    if (bits <= 24 and (few[0] is None or few[0] >= 7)) or few == (None, None) or (few[0] or 0) > DOUBLE_DIGITS:
        return Unit(bits)
    return Unit(bits, LogDigits(*few))


SINGLE_DIGITS = 8
"""Digits of floats, as short as they can be, of which some in a log have as many: of floats one has 9."""

DOUBLE_DIGITS = 14
"""Digits of a log beyond which a difference that is seen first is one of the engine's; of doubles one has 17."""


def _numbers(head: Sequence[LogRecord]) -> Iterator[float]:
    """The first numbers of a log that have a fraction: whole ones do not tell their type."""
    count = 0
    for record in head:
        free = [v for v in record.fields.values() if isinstance(v, float)]
        for row in [*record.states.values(), free]:
            for value in row:
                if value != int(value) if math.isfinite(value) else False:
                    yield float(value)
                    count += 1
        if count > 1000:
            return


def _single(value: float) -> bool:
    """Whether a number is one of 24 bits, written to the end, or to 9 digits, or as shortly as it can be told."""
    if abs(value) > 3e38:
        return False
    with np.errstate(all="ignore"):
        near = np.float32(value)
    return float(near) == value or float(f"{float(near):.9g}") == value or float(str(near)) == value


def _written(values: Sequence[float]) -> tuple[int | None, int | None]:
    """Significant digits, or digits after the point, that all numbers keep to, where that is few; else None."""
    if len(values) < 50:
        return None, None
    digits = decimals = 0
    reached = [0, 0]  # numbers that have as many digits, and as many after the point
    for value in values:
        sign = Decimal(repr(value)).as_tuple()
        exponent = sign.exponent if isinstance(sign.exponent, int) else 0
        own = len("".join(map(str, sign.digits)).rstrip("0"))
        reached = [
            1 if mine > most else count + (mine == most)
            for mine, most, count in zip((own, -exponent), (digits, decimals), reached, strict=True)
        ]
        digits, decimals = max(digits, own), max(decimals, -exponent)
        if digits > 16 and decimals > 12:
            return None, None
    if digits <= 16 and (decimals > 12 or reached[0] > reached[1]):
        return digits, None
    return (None, decimals) if decimals <= 12 else (digits, None)


class Growing:
    """Takes what differs, record by record, and keeps what a verdict needs.

    Attributes:
        early: the first differences of all.
        whole: the largest difference of all bodies over the log.
        by_body: the same by body.
        leaps: differences that came from much less in one record, with no more than rounding before them.
        largest: bits by which any body was ever off.
        bodies: those that differed at any time.
        same_again: how many bodies were the same in both at their second record.
    """

    def __init__(self, unit: Unit, names: list[str] | None) -> None:
        self.unit, self.names = unit, names
        self._least = LEAP_SINGLE if unit.bits <= 24 else LEAP_DOUBLE
        self._most = unit.whole + 10
        self.early: list[Difference] = []
        self.whole = ThinnedCurve()
        self.by_body: dict[str, ThinnedCurve] = {}
        self.leaps: list[Difference] = []
        self.largest = NEVER
        self.bodies: set[str] = set()
        self.off: dict[str, float] = {}
        self.same_at: dict[str, int] = {}
        self.onsets = 0
        self.sated = False
        self.same_again = 0
        self._twice: set[str] = set()
        self.counted: list[tuple[int, int]] = []

    def name_of(self, j: int, width: int) -> str:
        """The name of the j-th number of a state."""
        if self.names is not None and j < len(self.names):
            return self.names[j]
        return ("x", "y", "vx", "vy")[j] if width == 4 else f"number {j + 1}"

    def same(self, body: str, number: int) -> None:
        """A body is the same in both at a record."""
        if body not in self._twice and body in self.same_at:
            self._twice.add(body)
            self.same_again += 1
        self.same_at[body] = number
        if self.off:
            self.off.pop(body, None)

    def before(self, body: str, partners: Iterable[str]) -> float:
        """Bits by which a body and others were off at their last records."""
        found = self.off.get(body, NEVER)
        for other in partners:
            found = max(found, self.off.get(other, NEVER))
        return found

    def differs(
        self, a: LogRecord, b: LogRecord, body: str, rows: tuple[Sequence[float], Sequence[float]], touching: bool,
        before: float, *, key: Any = None, name: str | None = None,
    ) -> float:  # fmt: skip
        """A body's numbers are not the same in both at a record; by how many bits at most."""
        one, other = rows
        if len(one) != len(other):
            raise EngineError(
                f"states of {body!r} have {len(one)} numbers at {a.place()}, and {len(other)} in the other log; "
                "log the same numbers, or name them (fields)"
            )
        worst, place = self.unit.most_off(one, other, key)
        if worst == NEVER:
            self.same(body, a.number)
            return NEVER
        placed = None  # the first differences alone are kept with all that is known of them
        if len(self.early) < EARLY:
            placed = a.time == b.time and all(one[j] == other[j] for j in self.places(len(one)))
        if not name and (placed is not None or worst - max(before, 0.0) > self._least):
            name = self.name_of(place, len(one))
        self.note(a, b, body, name or "", one[place], other[place], worst, touching, before, bool(placed))
        return worst

    def places(self, width: int) -> range | list[int]:
        """Which numbers of a state say where a body is: all but velocities and spins, as far as names tell."""
        if self.names is None:
            return range(width // 2 if width > 1 else 1)
        return [j for j, name in enumerate(self.names[:width]) if not name.lower().startswith(SPEEDS)]

    def note(
        self, a: LogRecord, b: LogRecord, body: str, name: str, x: float, y: float, bits: float, touching: bool,
        before: float, placed: bool = False,
    ) -> None:  # fmt: skip
        """One difference, already measured."""
        early = len(self.early) < EARLY
        if body not in self._twice and (body in self.same_at or body in self.bodies):
            self._twice.add(body)
        leap = bits - (before if before > 0.0 else 0.0) > self._least and self.leap_from(bits, before)
        if early or leap:
            if len(self.counted) < EARLY and (not self.counted or self.counted[-1][0] != a.number):
                self.counted.append((a.number, self.onsets))
            fresh = body not in self.same_at
            gap = a.number - self.same_at[body] if not fresh else 0
            found = Difference(
                a.number, a.step, a.time, (a.line, b.line), body, name, x, y, bits, fresh, gap, touching, before, placed
            )
            if early:
                self.early.append(found)
            if leap and len(self.leaps) < EARLY:
                self.leaps.append(found)
        if body not in self.bodies:
            self.bodies.add(body)
            if len(self.by_body) < CURVES:
                self.by_body[body] = ThinnedCurve()
        most = self._most
        shown = bits if bits < most else most
        for curve in (self.by_body.get(body), self.whole):
            if curve is None:
                continue
            if curve.seen % curve.stride:
                curve.seen += 1
            else:
                curve.add(a.number, a.clock or 0.0, shown)
        self.largest = max(self.largest, bits)
        self.off[body] = bits

    @property
    def known(self) -> int:
        """How many bodies were compared."""
        return len(self.same_at | dict.fromkeys(self.bodies))

    def contacts_before(self, number: int) -> int:
        """Contacts that there were in both runs before a record, as far as they were counted."""
        return next((count for at, count in reversed(self.counted) if at <= number), 0)

    def leap_from(self, bits: float, before: float) -> bool:
        """Whether a difference is far more than what was there before, and that less than could decide a contact.

        One contact the more or the less follows from a difference of so many bits about once in as many contacts as
        there are such differences in the way of a step, a few percent of the scene.
        """
        if bits - max(before, 0.0) <= self._least:
            return False
        chance = max(self.largest, 0.0) + math.log2(self.onsets + 1)
        self.sated = len(self.early) >= EARLY and chance > self.unit.whole
        return chance < self.unit.whole - STEP_BITS - RARE


def rate_of(curve: ThinnedCurve, unit: Unit) -> GrowthRate | None:
    """Least squares through the bits of a curve, up to where they first are as large as the scene.

    Points lie one after another along one history, so that the standard errors are of that history alone.

    >>> curve = ThinnedCurve()
    >>> for k in range(20):
    ...     curve.add(k, k / 2, 1.5 * k)
    >>> rate = rate_of(curve, Unit(53))
    >>> rate.bits_per_record, rate.bits_per_time
    (1.5, 3.0)
    """
    taken: list[tuple[int, float, float]] = []
    for point in curve.points:
        if point[2] > unit.whole - FAR:
            break
        taken.append(point)
    if len(taken) < 4 or len({number for number, _, _ in taken}) < 3:
        return None
    numbers, times, bits = np.array(taken).T
    by_record = _line(numbers, bits)
    by_time = _line(times, bits) if times[-1] > times[0] else (None, None)
    return GrowthRate(*by_record, *by_time, len(taken))


def _line(x: Any, y: Any) -> tuple[float, float]:
    """Slope of the least squares line, and its standard error."""
    x0, y0 = x - x.mean(), y - y.mean()
    square = float(x0 @ x0)
    slope = float(x0 @ y0) / square
    rest = y0 - slope * x0
    return slope, math.sqrt(float(rest @ rest) / max(1, len(x) - 2) / square)
