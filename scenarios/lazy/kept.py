"""A property that is computed when it is first asked for, and then kept."""

from __future__ import annotations

from functools import cached_property
from typing import Any, TypeVar

T = TypeVar("T")


class kept(cached_property[T]):  # a decorator, as what it is made of
    """`functools.cached_property` without a lock, of which Python 3.11 has one for all instances.

    Whoever computes the property may wait for flint's precision (`precision.at_bits`), and whoever holds that may ask
    for the property: with two locks each might wait for the other. Without, two threads may compute it twice.

    >>> class Square:
    ...     @kept
    ...     def area(self) -> int:
    ...         return print("computed") or 4
    >>> square = Square()
    >>> square.area, square.area
    computed
    (4, 4)
    """

    def __get__(self, instance: Any, owner: type[Any] | None = None) -> Any:
        if instance is None:
            return self
        value = instance.__dict__[self.attrname] = self.func(instance)
        return value
