"""What costs nothing before it is asked for: the version, names, modules, properties, sequences."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import cached_property
from importlib import import_module
from typing import Any, TypeVar, overload

T = TypeVar("T")


# -- The version of this project: what `pyproject.toml` says, without looking among installed packages for it.

VERSION = "0.1.0"


# -- Names that a package hands on, whose modules are imported when they are asked for.


def handed_on(package: str, homes: Mapping[str, str]) -> tuple[Callable[[str], Any], Callable[[], list[str]]]:
    """`__getattr__` and `__dir__` for a package that hands on names of its modules.

    Args:
        homes: for each name, the module in the package that has it.

    >>> get, _ = handed_on("truebreak.scenarios", {"Circle": "things"})
    >>> get("Circle").__module__
    'truebreak.scenarios.things'
    """

    def get(name: str) -> Any:
        if name not in homes:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        value = getattr(import_module(f".{homes[name]}", package), name)
        setattr(sys.modules[package], name, value)
        return value

    def names() -> list[str]:
        return sorted({*vars(sys.modules[package]), *homes})

    return get, names


# -- A module that is imported when a name of it is first asked for.


class Later:
    """A module of another distribution: with what is imported at that moment, and nothing before.

    So whatever only some runs need may be missing where it is not needed: NumPy in a browser, say.

    Args:
        module: its name.

    >>> Later("math").sqrt(4.0)
    2.0
    """

    def __init__(self, module: str) -> None:
        self._module = module

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):  # a question about this object, as `inspect` asks it
            raise AttributeError(name)
        value = getattr(import_module(self._module), name)
        setattr(self, name, value)
        return value


# -- A property that is computed when it is first asked for, and then kept.


class kept(cached_property[T]):  # a decorator, as what it is made of
    """`functools.cached_property` without a lock, of which Python 3.11 has one for all instances.

    Whoever computes the property may wait for flint's precision (`precision.at_bits`), and whoever holds that may ask
    for the property: with two locks each might wait for the other. Without, two threads may compute it twice. A value
    that is the object itself is not kept: it would hold itself, and not be gone when nobody else does.

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
        value = self.func(instance)
        if value is not instance:
            instance.__dict__[self.attrname] = value
        return value


# -- A sequence that is made when it is first read.


class Late(Sequence[T]):
    """Items whose number is known and whose making waits until one is asked for; then it is as a tuple of them.

    Args:
        count: how many there are.
        make: makes all of them, once.

    >>> made = Late(2, lambda: [print("now"), 7])
    >>> len(made)
    2
    >>> made[1], made[1:]
    now
    (7, (7,))
    """

    __slots__ = ("_count", "_items", "_make")

    def __init__(self, count: int, make: Callable[[], Iterable[T]]) -> None:
        self._count = count
        self._make: Callable[[], Iterable[T]] | None = make
        self._items: tuple[T, ...] = ()

    def _all(self) -> tuple[T, ...]:
        if self._make is not None:
            self._items = tuple(self._make())
            self._make = None
        return self._items

    def __len__(self) -> int:
        return self._count

    @overload
    def __getitem__(self, place: int) -> T: ...
    @overload
    def __getitem__(self, place: slice) -> tuple[T, ...]: ...
    def __getitem__(self, place: int | slice) -> T | tuple[T, ...]:
        return self._all()[place]

    def __iter__(self) -> Iterator[T]:
        return iter(self._all())

    def __eq__(self, other: object) -> bool:
        if isinstance(other, Late):
            return self._all() == other._all()
        return self._all() == other if isinstance(other, tuple) else NotImplemented

    def __hash__(self) -> int:
        return hash(self._all())

    def __repr__(self) -> str:
        return repr(self._all())

    def __reduce__(self) -> tuple[Any, ...]:
        return tuple, (self._all(),)
