"""Settings of scenes and runs, checked: limits on time and on instants, truths."""

from __future__ import annotations

from typing import Any

from ..errors import SceneError
from ..numbers.quantity import Quantity, QuantityLike


def checked_truth(place: str, value: object) -> bool:
    """True or false.

    Raises:
        SceneError: for anything else; `place` says where.
    """
    if not isinstance(value, bool):
        raise SceneError(f"{place} = {value!r} is not true or false")
    return value


def positive_count(key: str, value: Any) -> int | None:
    """A limit on a number of instants.

    Raises:
        SceneError: unless it is None or a whole number from 1.
    """
    if value is None:
        return None
    if isinstance(value, bool) or not isinstance(value, int) or value < 1:
        raise SceneError(f"{key} = {value!r}: must be a whole number from 1")
    return value


def positive_time(key: str, value: QuantityLike | None) -> Quantity | None:
    """A time limit.

    Raises:
        SceneError: unless it is None or an exact number above zero.
    """
    if value is None:
        return None
    try:
        time = Quantity.of(value)
    except SceneError as error:
        raise SceneError(f"{key} = {error}") from None
    if time.sign() <= 0:
        raise SceneError(f"{key} = {time.brief()}: must be above zero")
    return time
