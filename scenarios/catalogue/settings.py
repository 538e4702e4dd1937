"""From the text of a setting to its value: one reader for each kind of setting."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeAlias

from ..errors import SceneError
from ..numbers.quantity import Quantity
from ..tie_policy import TiePolicy

ReadSetting: TypeAlias = Callable[[str], Any]


def whole(low: int, high: int) -> ReadSetting:
    """Reads a whole number from `low` to `high`.

    >>> whole(1, 5)("3")
    3
    """

    def read(text: str) -> int:
        digits = text.removeprefix("-")
        if digits.isascii() and digits.isdigit() and len(digits) <= len(str(max(abs(low), abs(high)))):
            value = int(text)
            if low <= value <= high:
                return value
        raise SceneError(f"must be a whole number from {low} to {high}")

    return read


def number(above: int | None = None, least: int | None = None) -> ReadSetting:
    """Reads an exact number, perhaps above a bound, or no less than one.

    >>> number(above=0)("sqrt(2)/2")
    Quantity('sqrt(2)/2')
    """

    def read(text: str) -> Quantity:
        value = Quantity.of(text)
        if above is not None and value <= above:
            raise SceneError(f"must be above {above}")
        if least is not None and value < least:
            raise SceneError(f"must be at least {least}")
        return value

    return read


def one_of(*choices: str) -> ReadSetting:
    """Reads one of some words.

    >>> one_of("left", "right")("left")
    'left'
    """

    def read(text: str) -> str:
        if text not in choices:
            raise SceneError(f"must be one of: {', '.join(choices)}")
        return text

    return read


def yes_no(text: str) -> bool:
    """Reads yes or no.

    >>> yes_no("yes")
    True
    """
    if text not in ("yes", "no"):
        raise SceneError("must be yes or no")
    return text == "yes"


def automatic(read: ReadSetting) -> ReadSetting:
    """Reads what `read` does, or the word auto, which is None.

    >>> automatic(whole(1, 9))("auto") is None
    True
    """

    def read_or_auto(text: str) -> Any:
        return None if text == "auto" else read(text)

    return read_or_auto


def tie_policy(text: str) -> TiePolicy:
    """Reads a tie policy.

    >>> tie_policy("sequential:seed=3")
    TiePolicy(name='sequential', seed=3)
    """
    return TiePolicy.parse(text)
