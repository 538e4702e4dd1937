"""What costs little before it is asked for: the version, frozen classes, names, modules, properties, sequences."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import MISSING, FrozenInstanceError, dataclass, field, fields
from functools import cache, cached_property
from importlib import import_module
from operator import attrgetter
from typing import Any, TypeVar, dataclass_transform, overload

T = TypeVar("T")


# -- The version of this project: what `pyproject.toml` says, without looking among installed packages for it.

VERSION = "0.1.0"


# -- A frozen dataclass that is made with one compiled function.


@dataclass_transform(frozen_default=True, field_specifiers=(field,))
def frozen(kind: type[T]) -> type[T]:
    """What `dataclass(frozen=True)` makes of a class, in a fifth of the time: a command makes dozens as it starts.

    Python compiles six functions for each class. Here `__init__` alone is compiled, where the class has none of its
    own; the other five are those of `_Frozen`. `fields`, `replace` and `asdict` take these classes as any dataclass;
    fields that are given by name alone are not provided for.

    >>> @frozen
    ... class Place:
    ...     x: int
    ...     y: int = 0
    >>> Place(1), Place(1) == Place(1, y=0), hash(Place(2)) == hash(Place(2))
    (Place(x=1, y=0), True, True)
    >>> Place(1).x = 2
    Traceback (most recent call last):
      ...
    dataclasses.FrozenInstanceError: cannot assign to field 'x'
    """
    inherits = hasattr(kind, "__dataclass_fields__")
    dataclass(init=False, repr=False, eq=False, frozen=inherits)(kind)  # a subclass has to be what its base is
    vars(kind)["__dataclass_params__"].frozen = True
    own = vars(kind)
    if "__init__" not in own:
        kind.__init__ = _initialiser(kind)
    for name in ("__setattr__", "__delattr__", "__eq__", "__hash__", "__repr__"):
        if own.get(name) is None:  # where a class has an `__eq__` of its own, Python sets `__hash__` to None
            setattr(kind, name, vars(_Frozen)[name])
    return kind


def _initialiser(kind: Any) -> Callable[..., None]:
    """`__init__`: takes the fields by place or by name."""
    names: dict[str, Any] = {"_put": object.__setattr__, "_missing": MISSING}
    taken, lines = ["self"], list[str]()
    for one in fields(kind):
        name = value = one.name
        if one.default_factory is not MISSING:
            names[f"_make_{name}"] = one.default_factory
            taken.append(f"{name}=_missing")
            value = f"_make_{name}() if {name} is _missing else {name}"
        elif one.default is not MISSING:
            names[f"_default_{name}"] = one.default
            taken.append(f"{name}=_default_{name}")
        else:
            taken.append(name)
        lines.append(f"_put(self, {name!r}, {value})")
    if hasattr(kind, "__post_init__"):
        lines.append("self.__post_init__()")
    exec(f"def __init__({', '.join(taken)}): {'; '.join(lines) or 'pass'}", names)
    made = names["__init__"]
    made.__qualname__, made.__module__ = f"{kind.__qualname__}.__init__", kind.__module__
    made.__annotations__ = {one.name: one.type for one in fields(kind)}
    return made


@cache
def _compared(kind: Any) -> Callable[[Any], tuple[Any, ...]]:
    """What gives the values by which objects of a class are compared."""
    names = [one.name for one in fields(kind) if one.compare]
    return attrgetter(*names) if len(names) > 1 else lambda each: tuple(getattr(each, name) for name in names)


class _Frozen:
    """The methods that all frozen classes have in common."""

    def __setattr__(self: Any, name: str, value: Any) -> None:
        _refuse("assign to", self, name)
        object.__setattr__(self, name, value)

    def __delattr__(self: Any, name: str) -> None:
        _refuse("delete", self, name)
        object.__delattr__(self, name)

    def __eq__(self: Any, other: object) -> bool:
        if other.__class__ is not self.__class__:
            return NotImplemented
        values = _compared(self.__class__)
        return values(self) == values(other)

    def __hash__(self: Any) -> int:
        return hash(_compared(self.__class__)(self))

    def __repr__(self: Any) -> str:
        shown = ", ".join(f"{one.name}={getattr(self, one.name)!r}" for one in fields(self) if one.repr)
        return f"{self.__class__.__qualname__}({shown})"


def _refuse(what: str, thing: Any, name: str) -> None:
    """Raises FrozenInstanceError, but for what a subclass that is no dataclass adds to the fields."""
    kind: Any = thing.__class__
    if name in thing.__dataclass_fields__ or "__dataclass_fields__" in vars(kind):
        raise FrozenInstanceError(f"cannot {what} field {name!r}")


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
