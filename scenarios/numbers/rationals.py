"""Roots of rationals that are rational."""

from __future__ import annotations

from flint import fmpq


def rational_root(q: fmpq) -> fmpq | None:
    """The square root of a non-negative rational if that is rational, else None.

    >>> from flint import fmpq
    >>> rational_root(fmpq(4, 9)), rational_root(fmpq(2))
    (2/3, None)
    """
    p, r = q.p, q.q
    if not p.is_square() or not r.is_square():
        return None
    return fmpq(p.isqrt(), r.isqrt())
