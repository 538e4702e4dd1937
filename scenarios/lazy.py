"""What costs little before it is asked for: the version, frozen classes, names, modules, properties, sequences."""

from __future__ import annotations

import inspect
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import MISSING, Field, FrozenInstanceError, dataclass, field, fields
from functools import cache, cached_property
from importlib import import_module
from operator import attrgetter
from typing import Any, TypeVar, dataclass_transform, overload

T = TypeVar("T")


# -- The version of this project: what `pyproject.toml` says, without looking among installed packages for it.

VERSION = "0.1.0"


# -- A frozen dataclass for which nothing is compiled.


@dataclass_transform(frozen_default=True, field_specifiers=(field,))
def frozen(kind: type[T]) -> type[T]:
    """What `dataclass(frozen=True)` makes of a class, in a tenth of the time: a command makes dozens as it starts.

    Python compiles six functions for each class. Here all classes have the methods of `_Frozen`, where they have none
    of their own. `fields`, `replace`, `asdict` and `inspect.signature` take these classes as any dataclass; fields that
    are given by name alone, or hashed but not compared, are not provided for.

    >>> @frozen
    ... class Place:
    ...     x: int
    ...     y: int = 0
    >>> Place(1), Place(1) == Place(x=1), hash(Place(2)) == hash(Place(2, 0))
    (Place(x=1, y=0), True, True)
    >>> Place(1).x = 2
    Traceback (most recent call last):
      ...
    dataclasses.FrozenInstanceError: cannot assign to field 'x'
    >>> Place(y=1)
    Traceback (most recent call last):
      ...
    TypeError: Place(): missing a required argument: 'x'
    """
    inherits = hasattr(kind, "__dataclass_fields__")
    dataclass(init=False, repr=False, eq=False, frozen=inherits)(kind)  # a subclass has to be what its base is
    own = vars(kind)
    own["__dataclass_params__"].frozen = True
    for name in ("__signature__", "__init__", "__setattr__", "__delattr__", "__eq__", "__hash__", "__repr__"):
        if own.get(name) is None:  # where a class has an `__eq__` of its own, Python sets `__hash__` to None
            setattr(kind, name, _Frozen.__dict__[name])
    return kind


class _Form:
    """What objects of a class are made of.

    Attributes:
        names: of the fields.
        compared: gives the values by which objects are compared.
    """

    def __init__(self, kind: Any) -> None:
        self._kind = kind
        self._fields = fields(kind)
        self.names = tuple(one.name for one in self._fields)
        compared = [one.name for one in self._fields if one.compare]
        self.compared: Callable[[Any], tuple[Any, ...]]
        if len(compared) > 1:
            self.compared = attrgetter(*compared)
        else:
            self.compared = lambda each: tuple(getattr(each, name) for name in compared)

    def values(self, given: tuple[Any, ...], named: dict[str, Any]) -> list[Any]:
        """The values of all fields, of which some are given by place, some by name.

        Raises:
            TypeError: as a function with these parameters does.
        """
        rest = self._fields[len(given) :]
        values = [*given, *(named[one.name] if one.name in named else _default(one) for one in rest)]
        strange = len(given) > len(self.names) or not named.keys() <= {one.name for one in rest}
        if strange or any(value is MISSING for value in values):
            try:
                inspect.signature(self._kind).bind(*given, **named)
            except TypeError as error:
                raise TypeError(f"{self._kind.__name__}(): {error}") from None
        return values


_form = cache(_Form)


def _default(one: Field[Any]) -> Any:
    """The value of a field that is not given; MISSING where it has to be."""
    return one.default if one.default_factory is MISSING else one.default_factory()


class _Signature:
    """The signature of a class with the `__init__` of `_Frozen`, from its fields; None for others, as Python asks."""

    def __get__(self, instance: object, owner: Any) -> inspect.Signature | None:
        if owner.__init__ is not _Frozen.__init__:
            return None
        by = inspect.Parameter.POSITIONAL_OR_KEYWORD
        return inspect.Signature(
            [
                inspect.Parameter(
                    one.name,
                    by,
                    default=inspect.Parameter.empty if (value := _default(one)) is MISSING else value,
                    annotation=one.type,
                )
                for one in fields(owner)
            ]
        )


class _Frozen:
    """The methods that all frozen classes have in common."""

    __signature__ = _Signature()

    def __init__(self: Any, *given: Any, **named: Any) -> None:
        form, put = _form(self.__class__), object.__setattr__
        whole = not named and len(given) == len(form.names)
        for name, value in zip(form.names, given if whole else form.values(given, named), strict=True):
            put(self, name, value)
        if hasattr(self, "__post_init__"):
            self.__post_init__()

    def __setattr__(self: Any, name: str, value: Any) -> None:
        _refuse("assign to", self, name)
        object.__setattr__(self, name, value)

    def __delattr__(self: Any, name: str) -> None:
        _refuse("delete", self, name)
        object.__delattr__(self, name)

    def __eq__(self: Any, other: object) -> bool:
        if other.__class__ is not self.__class__:
            return NotImplemented
        values = _form(self.__class__).compared
        return values(self) == values(other)

    def __hash__(self: Any) -> int:
        return hash(_form(self.__class__).compared(self))

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
