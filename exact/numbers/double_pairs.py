"""Numbers as pairs of doubles, good to some 100 bits: sums and products whose errors are doubles too.

All functions take doubles and arrays of them alike.

Sources: T. J. Dekker, Numerische Mathematik 18 (1971); D. E. Knuth, The Art of
Computer Programming, volume 2, section 4.2.2.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    import numpy as np
    from flint import arb
    from numpy.typing import NDArray

F = TypeVar("F", float, "NDArray[np.float64]")

SPLITTER = 2.0**27 + 1.0
"""Veltkamp's factor for doubles of 53 bits."""


def two_sum(a: F, b: F) -> tuple[F, F]:
    """a + b as the nearest double and its exact error (Knuth).

    >>> two_sum(1.0, 2.0**-60)
    (1.0, 8.673617379884035e-19)
    """
    total = a + b
    part = total - a
    return total, (a - (total - part)) + (b - part)


def quick_two_sum(a: F, b: F) -> tuple[F, F]:
    """As `two_sum`, where |a| >= |b| (Dekker)."""
    total = a + b
    return total, b - (total - a)


def two_product(a: F, b: F) -> tuple[F, F]:
    """a * b as the nearest double and its exact error (Dekker, Veltkamp)."""
    product = a * b
    high_a, low_a = _split(a)
    high_b, low_b = _split(b)
    return product, ((high_a * high_b - product) + high_a * low_b + low_a * high_b) + low_a * low_b


def _split(a: F) -> tuple[F, F]:
    """A double as two of 26 bits each."""
    scaled = SPLITTER * a
    high = scaled - (scaled - a)
    return high, a - high


def pair_of(value: arb) -> tuple[float, float]:
    """The two doubles nearest the middle of a ball: the first, and the second nearest what is left."""
    high = float(value.mid())
    return high, float((value.mid() - high).mid())


def fallen_pairs(
    x: NDArray[np.float64],
    v: NDArray[np.float64],
    half: tuple[float, float],
    since: NDArray[np.float64],
    times: NDArray[np.float64],
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """x + v t + half t^2 and v + 2 half t as doubles, where t = times - since, and x, v, since and half are pairs.

    Args:
        x, v, since: shape (n, 2).
        times: shape (n,), exact doubles.

    >>> import numpy as np
    >>> zero = np.zeros((1, 2))
    >>> [float(row[0]) for row in fallen_pairs(zero, zero, (-5.0, 0.0), zero, np.array([2.0]))]
    [-20.0, -20.0]
    """
    total, error = two_sum(times, -since[:, 0])
    high, low = quick_two_sum(total, error - since[:, 1])
    way, lost = two_product(half[0] + 0.0 * high, high)
    lost = lost + (half[0] * low + half[1] * high)
    mean, rest = two_sum(v[:, 0], way)
    mean, more = quick_two_sum(mean, rest + (v[:, 1] + lost))
    step, off = two_product(mean, high)
    place, rest = two_sum(x[:, 0], step)
    speed, left = two_sum(v[:, 0], 2.0 * way)
    fast = speed + (left + (v[:, 1] + 2.0 * lost))
    return place + (rest + (x[:, 1] + (off + (mean * low + more * high)))), fast


def advanced_pairs(
    x: NDArray[np.float64], v: NDArray[np.float64], t: NDArray[np.float64], times: NDArray[np.float64]
) -> NDArray[np.float64]:
    """x + v (times - t) as doubles, where x, v and t are pairs.

    Args:
        x, v, t: shape (n, 2).
        times: shape (n,), exact doubles.

    >>> import numpy as np
    >>> third = np.array([[1 / 3, 1 / 3 * 2.0**-54]])
    >>> advanced_pairs(np.array([[-1.0, 0.0]]), third, np.array([[0.0, 0.0]]), np.array([3.0]))
    array([0.])
    """
    total, error = two_sum(times, -t[:, 0])
    high, low = quick_two_sum(total, error - t[:, 1])
    way, lost = two_product(v[:, 0], high)
    place, rest = two_sum(x[:, 0], way)
    return place + (rest + (x[:, 1] + (lost + (v[:, 0] * low + v[:, 1] * high))))
