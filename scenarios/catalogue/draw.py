"""Whole numbers drawn from a seed: the same ones on every machine and in every version of Python."""

from __future__ import annotations

MASK = (1 << 64) - 1


class Draw:
    """A stream of pseudo-random whole numbers: SplitMix64.

    Source: Steele, Lea and Flood, *Fast splittable pseudorandom number generators* (OOPSLA 2014).

    >>> draw = Draw(1)
    >>> [draw.between(-5, 5) for _ in range(6)]
    [1, 3, 5, -1, -1, 3]
    """

    def __init__(self, seed: int) -> None:
        self._state = seed & MASK

    def _next(self) -> int:
        self._state = (self._state + 0x9E3779B97F4A7C15) & MASK
        z = self._state
        z = ((z ^ (z >> 30)) * 0xBF58476D1CE4E5B9) & MASK
        z = ((z ^ (z >> 27)) * 0x94D049BB133111EB) & MASK
        return z ^ (z >> 31)

    def between(self, low: int, high: int) -> int:
        """A whole number from `low` to `high`, both included."""
        return low + (self._next() * (high - low + 1) >> 64)
