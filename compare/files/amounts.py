"""An engine's numbers as doubles and as bounds, and values as plain data, whatever the engine counts in."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping
from enum import Enum
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ...scenarios.numbers.quantity import Real


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


def normal_form(value: Real) -> str | None:
    """A number in the grammar of scene files; None where it is not known, or has no short closed form.

    >>> from truebreak.scenarios import Quantity
    >>> normal_form(Quantity.of("sqrt(8)"))
    'sqrt(8)'
    """
    own: Callable[[], str | None] = getattr(value, "normal_form", value.text)  # of an exact run, whose text may be more
    return own()


FORMULA = re.compile(r"[=@\t\r]|[+-].*[^0-9a-z+*/(). -]", re.DOTALL)
"""What a spreadsheet would take for a formula that reaches beyond numbers: an exact number is none."""


def no_formula(cell: Any) -> Any:
    """A cell of CSV; text that is a formula to a spreadsheet has an apostrophe before it, as those read text.

    >>> [no_formula(cell) for cell in ("=HYPERLINK(1)", "a=b", "-sqrt(2)/2", "-2+cmd|' /C x'!A0", -0.5, None)]
    ["'=HYPERLINK(1)", 'a=b', '-sqrt(2)/2', "'-2+cmd|' /C x'!A0", -0.5, None]
    """
    return f"'{cell}" if isinstance(cell, str) and FORMULA.match(cell) else cell


def bounds(value: Real) -> tuple[float, float] | None:
    """Doubles at or beyond the ends of an interval; None for a number that is not an interval.

    >>> from truebreak.floating import IntervalEngine
    >>> from truebreak.scenarios import Circle, Quantity, Scene
    >>> run = IntervalEngine().run(Scene([Circle(0, 0, vx=1), Circle(4, 1)]))
    >>> bounds(run.final_time) == run.final_time.bounds(), bounds(Quantity.of("sqrt(2)"))
    (True, None)
    """
    low, high = getattr(value, "low", None), getattr(value, "high", None)
    return None if low is None or high is None else (low, high)


def plain(value: Any) -> Any:
    """A value made of what JSON knows; other objects become their text.

    >>> from fractions import Fraction
    >>> import numpy as np
    >>> plain({"dt": Fraction(1, 3), 2: (True, None, 1e300), "counts": np.array([1, 2])})
    {'dt': '1/3', '2': [True, None, 1e+300], 'counts': [1, 2]}
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
    if type(value).__module__ == "numpy":  # not imported for it: a value of numpy's is there only if numpy is
        return plain(value.tolist())
    return str(value)


def counted(number: int, noun: str) -> str:
    """A number with its noun.

    >>> counted(1, "event"), counted(1200, "event")
    ('1 event', '1,200 events')
    """
    return f"{number:,} {noun}{'' if number == 1 else 's'}"
