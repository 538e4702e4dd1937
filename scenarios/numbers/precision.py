"""What exact numbers take from their surroundings: flint's working precision, which is one for the whole process and
which no other file touches, and doubles that are rounded to the nearest.

Whoever computes in balls holds the precision for as long as that takes, and other threads wait. Code of others that
sets it meanwhile is found out: never is a number wrong for that, since balls hold what they are to hold at any
precision, but what was computed may be less sharp than it should be, so it is refused.
"""

from __future__ import annotations

import os
from threading import Lock, get_ident
from types import TracebackType

from flint import ctx

from ..errors import Disturbed


class _Holder:
    """Who holds the precision: a thread, and to how many bits it has set it; 0 for nobody."""

    __slots__ = ("bits", "lock", "thread")

    def __init__(self) -> None:
        self.lock = Lock()
        self.thread = 0
        self.bits = 0


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

    __slots__ = ("_before", "_bits", "_saved")

    def __init__(self, bits: int) -> None:
        self._bits = bits

    def __enter__(self) -> None:
        holder, bits = _holder, self._bits
        if holder.thread == get_ident():
            saved, self._before = ctx.prec, holder.bits
            if saved != holder.bits:
                raise _disturbed(saved)
            ctx.prec = bits
        else:
            holder.lock.acquire()
            try:
                saved, self._before = ctx.prec, 0
                ctx.prec = bits
            except BaseException:
                holder.lock.release()
                raise
            holder.thread = get_ident()
        self._saved = saved
        holder.bits = bits

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, traceback: TracebackType | None, /
    ) -> None:
        holder, now = _holder, ctx.prec
        same = now == holder.bits
        if same:
            ctx.prec = self._saved  # else it stays as the other code wants it
        holder.bits = self._before
        if not self._before:
            holder.thread = 0
            holder.lock.release()
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
