"""An engine's numbers as doubles, as exact text and as bounds, whatever the engine counts in."""

from __future__ import annotations

import math
from collections.abc import Mapping
from enum import Enum
from typing import Any


def double(value: Any) -> float | None:
    """The nearest double; None where the number lies beyond the doubles.

    >>> double(1), double(10**400)
    (1.0, None)
    """
    try:
        number = float(value)
    except OverflowError:
        return None
    return number if math.isfinite(number) else None


def exact_text(value: Any) -> str | None:
    """The exact value as text, where the engine's number has one; a double is the dyadic rational that it is.

    >>> exact_text(0.375), exact_text(3)
    ('3/8', '3')
    """
    if hasattr(value, "text"):
        return value.text()
    if hasattr(value, "free_symbols"):
        return str(value)
    if isinstance(value, int):
        return str(value)
    if isinstance(value, float):
        if not math.isfinite(value):
            return None
        numerator, denominator = value.as_integer_ratio()
        return str(numerator) if denominator == 1 else f"{numerator}/{denominator}"
    return None


def bounds(value: Any) -> tuple[float, float] | None:
    """Doubles at or beyond the ends of an interval; None for a number that is not an interval.

    >>> from mpmath import iv
    >>> bounds(iv.mpf([1, 2])), bounds(1.5)
    ((1.0, 2.0), None)
    """
    if hasattr(value, "low") and hasattr(value, "high"):
        return value.low, value.high
    low, high = getattr(value, "a", None), getattr(value, "b", None)
    if low is None or high is None:
        return None
    down, up = float(low), float(high)
    if down > low:
        down = math.nextafter(down, -math.inf)
    if up < high:
        up = math.nextafter(up, math.inf)
    return down, up


def plain(value: Any) -> Any:
    """A value made of what JSON knows; other objects become their text.

    >>> from fractions import Fraction
    >>> plain({"dt": Fraction(1, 3), 2: (True, None, 1e300)})
    {'dt': '1/3', '2': [True, None, 1e+300]}
    """
    if value is None or isinstance(value, bool | int | str):
        return value
    if isinstance(value, float):
        return value if math.isfinite(value) else str(value)
    if isinstance(value, Enum):
        return value.name.lower()
    if isinstance(value, Mapping):
        return {str(plain(key)): plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple | set | frozenset):
        return [plain(item) for item in value]
    if hasattr(value, "item") and getattr(value, "ndim", None) == 0:
        return plain(value.item())
    return str(value)
