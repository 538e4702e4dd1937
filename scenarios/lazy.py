"""What costs nothing before it is asked for: the version, names, properties, sequences, frozen dataclasses."""

from __future__ import annotations

import dataclasses
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import MISSING, FrozenInstanceError, field
from functools import cached_property
from importlib import import_module
from operator import attrgetter
from reprlib import recursive_repr
from typing import Any, TypeVar, dataclass_transform, overload

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


# -- A property that is computed when it is first asked for, and then kept.


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


# -- Frozen dataclasses that cost little to import: one method is compiled, and that when the first of them is made.
# `@dataclass(frozen=True)` writes and compiles six methods for each class at every start of the program, used or not:
# it was some 30 % of the instructions of a short run.


@dataclass_transform(frozen_default=True, field_specifiers=(field,))
def frozen(kind: type[T]) -> type[T]:
    """Makes of a class what `@dataclass(frozen=True)` makes of it.

    Raises:
        TypeError: for a field that the call must name, or that its class does not set though it is not in the call.

    >>> @frozen
    ... class Place:
    ...     x: int
    ...     y: int = 0
    >>> Place(1), Place(1) == Place(1, 0), dataclasses.replace(Place(1), y=2)
    (Place(x=1, y=0), True, Place(x=1, y=2))
    """
    if dataclasses.is_dataclass(kind):  # by what it inherits
        return dataclasses.dataclass(frozen=True)(kind)
    own = frozenset(vars(kind))
    made: Any = dataclasses.dataclass(init=False, repr=False, eq=False)(kind)
    made.__dataclass_params__.frozen = True
    fields = dataclasses.fields(made)
    if any(f.kw_only or not (f.init or "__init__" in own) for f in fields):
        raise TypeError(f"{kind.__name__}: has a field that @frozen cannot set; use @dataclass(frozen=True)")
    methods = {
        **_comparison(tuple(f.name for f in fields if f.compare)),
        **_guards(kind, frozenset(f.name for f in fields)),
        "__repr__": _shown(tuple(f.name for f in fields if f.repr)),
    }
    if "__init__" not in own:
        methods["__init__"] = _first_call(made, fields)
        made.__signature__ = _Signature(made, fields)
    for name, method in methods.items():
        if name not in own:
            setattr(made, name, method)
    return made


def _comparison(names: tuple[str, ...]) -> dict[str, Callable[..., Any]]:
    """By the values of the fields, as tuples: what is one and the same object is equal."""
    if len(names) == 1:
        (name,) = names
        values: Callable[[Any], tuple[Any, ...]] = lambda one: (getattr(one, name),)  # noqa: E731
    else:
        values = attrgetter(*names) if names else lambda one: ()

    def __eq__(self: Any, other: object) -> bool:
        return values(self) == values(other) if other.__class__ is self.__class__ else NotImplemented

    def __hash__(self: Any) -> int:
        return hash(values(self))

    return {"__eq__": __eq__, "__hash__": __hash__}


def _guards(kind: type, names: frozenset[str]) -> dict[str, Callable[..., Any]]:
    """Nothing is set, and nothing is deleted; a subclass may do so with what is not a field."""

    def __setattr__(self: Any, name: str, value: Any) -> None:
        if type(self) is kind or name in names:
            raise FrozenInstanceError(f"cannot assign to field {name!r}")
        super(kind, self).__setattr__(name, value)

    def __delattr__(self: Any, name: str) -> None:
        if type(self) is kind or name in names:
            raise FrozenInstanceError(f"cannot delete field {name!r}")
        super(kind, self).__delattr__(name)

    return {"__setattr__": __setattr__, "__delattr__": __delattr__}


def _shown(names: tuple[str, ...]) -> Callable[[Any], str]:
    @recursive_repr()
    def __repr__(self: Any) -> str:
        told = ", ".join(f"{name}={getattr(self, name)!r}" for name in names)
        return f"{self.__class__.__qualname__}({told})"

    return __repr__


def _first_call(kind: Any, fields: tuple[dataclasses.Field[Any], ...]) -> Callable[..., None]:
    """An `__init__` that puts the compiled one in its place."""

    def __init__(self: Any, *given: Any, **named: Any) -> None:
        kind.__init__ = _compiled(kind, fields)
        kind.__init__(self, *given, **named)

    return __init__


def _compiled(kind: Any, fields: tuple[dataclasses.Field[Any], ...]) -> Callable[..., None]:
    """The `__init__` of these fields, as text that is compiled: as quick as that of a dataclass."""
    scope: dict[str, Any] = {"_put": object.__setattr__, "_MISSING": MISSING}
    words, lines = ["self"], list[str]()
    for k, f in enumerate(fields):
        value, default = f.name, ""
        if f.default_factory is not MISSING:
            scope[f"_made{k}"] = f.default_factory
            value, default = f"_made{k}() if {f.name} is _MISSING else {f.name}", "=_MISSING"
        elif f.default is not MISSING:
            scope[f"_given{k}"] = f.default
            default = f"=_given{k}"
        words.append(f"{f.name}{default}")
        lines.append(f" _put(self, {f.name!r}, {value})")
    if hasattr(kind, "__post_init__"):
        lines.append(" self.__post_init__()")
    exec(f"def __init__({', '.join(words)}):\n" + "\n".join(lines or [" pass"]), scope)
    compiled = scope["__init__"]
    compiled.__qualname__ = f"{kind.__qualname__}.__init__"
    compiled.__annotations__ = {**{f.name: f.type for f in fields}, "return": None}
    return compiled


class _Signature:
    """The signature of a class, for who asks before one of it has been made."""

    def __init__(self, kind: Any, fields: tuple[dataclasses.Field[Any], ...]) -> None:
        self._kind, self._fields = kind, fields

    def __get__(self, instance: object, owner: type) -> Any:
        if instance is not None or owner is not self._kind:
            raise AttributeError("__signature__")
        import inspect

        found = inspect.signature(_compiled(self._kind, self._fields))
        return found.replace(parameters=list(found.parameters.values())[1:])
