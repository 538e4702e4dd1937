"""Flint's working precision, which is one for the whole process; doubles, nearest to exact numbers and around balls."""

from __future__ import annotations

import os
from math import inf, isfinite, isnan, nextafter, ulp
from operator import index
from threading import Lock, get_ident
from types import TracebackType
from typing import SupportsIndex
from weakref import ReferenceType, ref

from flint import arb, ctx, fmpq

from ..errors import Disturbed, SceneError

# -- What exact numbers take from their surroundings: flint's working precision, which is one for the whole process
# and which no other file touches, and doubles that are rounded to the nearest.
#
# Whoever computes in balls holds the precision for as long as that takes, and other threads wait. Code of others that
# sets it meanwhile is found out: never is a number wrong for that, since balls hold what they are to hold at any
# precision, but what was computed may be less sharp than it should be, so it is refused.

LOOK_AGAIN_SECONDS = 0.5
"""How often whoever waits for the precision looks whether who holds it is still there."""


class _Holder:
    """Who holds the precision: a thread, and to how many bits it has set it; 0 for nobody.

    Attributes:
        claim: its outermost `at_bits`, in a list of its own. Where a recursion limit that was lowered meanwhile forbids
            even the call of `__exit__`, that is no more, and others take the precision.
        before: the bits that it has set aside.
    """

    __slots__ = ("before", "bits", "claim", "lock", "thread")

    def __init__(self) -> None:
        self.lock = Lock()
        self.claim: list[ReferenceType[at_bits]] = []
        self.thread = 0
        self.bits = self.before = 0

    def wait(self) -> None:
        """Takes the lock, once nobody holds it."""
        while not self.lock.acquire(timeout=LOOK_AGAIN_SECONDS):
            self.mend()

    def mend(self) -> None:
        """Gives the precision back for one who held it and is no more."""
        claim, bits, thread = self.claim, self.bits, self.thread
        if not thread or not claim or claim[0]() is not None:
            return
        try:
            owner = claim.pop()
        except IndexError:  # another, who waits as well, has just done so
            return
        try:
            if ctx.prec == bits:
                ctx.prec = self.before
            self.bits = self.thread = 0
            self.lock.release()
        except RecursionError:  # as long as the limit is that low; the next who waits does it
            self.bits, self.thread, self.claim = bits, thread, [owner]
            raise


_holder = _Holder()


def without_other_threads() -> None:
    """To be called in a copy of a process: the precision that another thread held is nobody's here, who has it not."""
    if _holder.thread != get_ident():
        _holder.lock, _holder.thread, _holder.bits = Lock(), 0, 0


class at_bits:  # a function to whoever calls it
    """`with at_bits(n)`: what is computed in balls inside is rounded to n bits; afterwards all is as it was.

    The outermost waits until no other thread is inside of one.

    Args:
        bits: at least 2.

    Raises:
        Disturbed: at its end, and inside whenever bits are set again, if other code has set the precision meanwhile.

    >>> before = ctx.prec
    >>> with at_bits(200):
    ...     ctx.prec
    200
    >>> ctx.prec == before
    True
    """

    __slots__ = ("__weakref__", "_before", "_bits", "_saved")

    def __init__(self, bits: int) -> None:
        self._bits = bits

    def __enter__(self) -> None:
        holder, bits, thread = _holder, self._bits, get_ident()
        if holder.thread == thread and (not holder.claim or holder.claim[0]() is None):
            holder.mend()
        if holder.thread == thread:
            saved, self._before = ctx.prec, holder.bits
            if saved != holder.bits:
                raise _disturbed(saved)
            ctx.prec = bits
        else:
            claim: list[ReferenceType[at_bits]] = [ref(self)]
            holder.wait()  # from here on nothing is called, which a recursion limit might forbid
            holder.claim, holder.thread = claim, thread
            saved, self._before = ctx.prec, 0
            holder.before = holder.bits = saved
            try:
                ctx.prec = bits
            except BaseException:
                holder.thread = 0
                try:
                    holder.lock.release()
                except RecursionError:
                    holder.thread = thread
                raise
        self._saved = saved
        holder.bits = bits

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, traceback: TracebackType | None, /
    ) -> None:
        holder, now = _holder, ctx.prec
        same = now == holder.bits
        if same:
            ctx.prec = self._saved  # else it stays as the other code wants it
        bits, thread, holder.bits = holder.bits, holder.thread, self._before
        if not self._before:
            holder.thread = 0
            try:
                holder.lock.release()
            except RecursionError:  # it is still held: `mend` gives it back
                holder.bits, holder.thread = bits, thread
                raise
        if not same and kind is None:
            raise _disturbed(now)


def use_bits(bits: int) -> None:
    """Sets the precision, until it is set again.

    Raises:
        Disturbed: inside of `at_bits`, if other code has set it since.
    """
    holder, now = _holder, ctx.prec
    if now == holder.bits:
        if now != bits:  # asking costs a tenth of setting
            ctx.prec = holder.bits = bits
    elif holder.thread == get_ident():
        raise _disturbed(now)
    else:
        ctx.prec = bits


def bits_in_use() -> int:
    """The precision."""
    return ctx.prec


def _disturbed(now: int) -> Disturbed:
    return Disturbed(
        f"flint's working precision was set to {now} bits by other code, in another thread or a callback, while exact "
        f"numbers were computed with {_holder.bits}; nothing was decided wrongly, but this run is dropped: run it "
        "again where nothing else sets flint.ctx.prec, such as in a process of its own"
    )


def _in_child() -> None:
    """A child of a fork has one thread, the one that forked: what another held there, nobody holds here."""
    if _holder.thread != get_ident():
        _holder.lock, _holder.thread, _holder.bits = Lock(), 0, 0


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_in_child)


# -- doubles

ONE, UNIT, LEAST_NORMAL, LEAST = 1.0, 2.0**-53, 2.0**-1022, 2.0**-1074
"""Of these, the sums and products below tell every rounding mode from the nearest, and every flushing to zero."""


def check_doubles() -> None:
    """Looks whether this thread's doubles are rounded to the nearest, and kept near zero.

    Every bound of the filters rests on that; the C function `fesetround` changes it, and libraries that are compiled
    with -ffast-math do when they are loaded.

    Raises:
        Disturbed: where that is not so.

    >>> check_doubles()
    """
    one, unit = ONE, UNIT
    if one + unit != one or -one - unit != -one or one + 3.0 * unit != one + 4.0 * unit:
        raise Disturbed(
            "doubles are not rounded to the nearest in this thread, as some code has set another rounding mode "
            "(fesetround); set FE_TONEAREST, or run in a process of its own"
        )
    if LEAST_NORMAL * 0.5 == 0.0 or LEAST * 2.0**100 == 0.0:
        raise Disturbed(
            "doubles near zero are flushed to zero in this thread, as a library compiled with -ffast-math has it; "
            "load none of these, or run in a process of its own"
        )


# -- Doubles: nearest to exact numbers, around balls, and as the numbers of a run.

GUARD_BITS = 64
"""Bits beyond those of a ball's middle with which its ends are found."""

BITS_PER_DIGIT = 3.3219280948873626
"""log2(10)."""


class Double(float):
    """A double as a number of a run: the binary fraction that it is (see `Real`).

    >>> x = Double(0.1)
    >>> x == 0.1, x.text(), x.digits(25)
    (True, '3602879701896397/36028797018963968', '0.1000000000000000055511151')
    """

    __slots__ = ()

    def bounds(self) -> tuple[float, float]:
        """Itself twice."""
        return float(self), float(self)

    def text(self) -> str | None:
        """The fraction; None for nan and infinities.

        >>> Double(0.375).text(), Double(3).text()
        ('3/8', '3')
        """
        if not isfinite(self):
            return None
        numerator, denominator = self.as_integer_ratio()
        return str(numerator) if denominator == 1 else f"{numerator}/{denominator}"

    def digits(self, count: int) -> str:
        """The fraction in decimals, rounded to so many digits."""
        return digits_of(self.ball(64), count)

    def ball(self, bits: int) -> arb:
        """The double itself, whatever the precision asked for."""
        return arb(float(self))


def nearest_double(q: fmpq) -> float:
    """The double nearest to a rational, ties to even.

    Raises:
        OverflowError: if the rational is beyond the doubles.

    >>> from flint import fmpq
    >>> nearest_double(fmpq(1, 10))
    0.1
    """
    return int(q.p) / int(q.q)


def certain_double(value: arb) -> float | None:
    """The double nearest to every number in a ball, or None where the ball leaves a choice.

    >>> certain_double(arb(1) / 4), certain_double(arb("1 +/- 1e-10"))
    (0.25, None)
    """
    low, high = _nearest_to_ends(value)[:2]
    return low + 0.0 if low == high else None  # + 0.0: zero has no sign


def even_double(value: arb) -> float:
    """Of the doubles nearest to the ends of a short ball the one whose last bit is 0: as if half-way between them.

    >>> from flint import ctx
    >>> with ctx.workprec(400):
    ...     even_double(1 + arb(2) ** -53 + arb("0 +/- 1e-99")), even_double(1 - arb(2) ** -54 + arb("0 +/- 1e-99"))
    (1.0, 1.0)
    """
    low, high = _nearest_to_ends(value)[:2]
    return low if low / ulp(low) % 2 == 0 else high


def bounds_of(value: arb) -> tuple[float, float]:
    """Doubles at or below, and at or above, every number in a ball; the nearest that are.

    >>> bounds_of(arb(1) / 4), bounds_of(arb(2**60 + 1))
    ((0.25, 0.25), (1.152921504606847e+18, 1.1529215046068472e+18))
    """
    down, up, low, high = _nearest_to_ends(value)
    if isnan(down) or isnan(up):
        return -inf, inf
    if not arb(down) <= low:
        down = nextafter(down, -inf)
    if not arb(up) >= high:
        up = nextafter(up, inf)
    return down, up


def _nearest_to_ends(value: arb) -> tuple[float, float, arb, arb]:
    with at_bits(max(value.bits(), GUARD_BITS) + GUARD_BITS):
        low, high = value.lower(), value.upper()
        return float(low), float(high), low, high


MOST_DIGITS, MOST_BITS = 1_000_000, 4_000_000
"""What may be asked for of one number: beyond that its replay takes more memory and time than anyone wants to give."""


def asked(what: str, count: object, most: int) -> int:
    """How many digits or bits are asked for, as a whole number.

    Raises:
        SceneError: where it is none from 1 to the most.

    >>> asked("digits", 30, MOST_DIGITS)
    30
    >>> asked("digits", 10**9, MOST_DIGITS)
    Traceback (most recent call last):
      ...
    truebreak.scenarios.errors.SceneError: digits(1000000000): must be a whole number from 1 to 1,000,000
    """
    whole = None if isinstance(count, bool) or not isinstance(count, SupportsIndex) else index(count)
    if whole is None or not 1 <= whole <= most:
        raise SceneError(f"{what}({str(count)[:60]}): must be a whole number from 1 to {most:,}")
    return whole


def digits_of(value: arb, count: int) -> str:
    """The digits of a ball that are sure (the last may be off by one), at most so many; "" if none is.

    >>> digits_of(arb("0.123456 +/- 1e-4"), 10), digits_of(arb(2), 10), digits_of(arb("1 +/- 2"), 10)
    ('0.123', '2.000000000', '')
    """
    count = asked("digits", count, MOST_DIGITS)
    with at_bits(int(count * BITS_PER_DIGIT) + GUARD_BITS):
        text = value.str(count, radius=False)
    known = value.is_zero() or (value.is_finite() and text.partition("e")[0].strip("-0."))
    return text if known else ""


def decimals_of(value: arb, count: int) -> str | None:
    """The decimals, so many, to which every number of a ball is rounded; None where they differ.

    Two balls around one number tell the same, or nothing.

    >>> decimals_of(arb("0.123456 +/- 1e-9"), 4), decimals_of(arb("0.12345 +/- 1e-9"), 4), decimals_of(arb(0), 4)
    ('0.1235', None, '0')
    """
    if not value.is_finite() or (value.contains(0) and not value.is_zero()):
        return None
    with at_bits(max(value.bits(), int(count * BITS_PER_DIGIT)) + GUARD_BITS):
        low, high = value.lower().str(count, radius=False), value.upper().str(count, radius=False)
    return low if low == high else None


def hull(low: arb, high: arb) -> arb:
    """A ball around all from one number to another.

    >>> hull(arb(1), arb(2))
    [+/- 2.01]
    """
    with at_bits(max(low.bits(), high.bits()) + GUARD_BITS):
        return low.union(high)
