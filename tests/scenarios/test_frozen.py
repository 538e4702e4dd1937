"""`@frozen` makes of a class what `@dataclass(frozen=True)` makes of it."""

from __future__ import annotations

import copy
import dataclasses
import inspect
import pickle
from dataclasses import FrozenInstanceError, dataclass, field
from typing import Any

import pytest

from truebreak.scenarios.lazy import frozen
from truebreak.scenarios.trajectory import Contact, Event, Tie, TieProof


class One:
    """One field; nothing is given of itself."""

    put: object


class Many:
    """Defaults of all kinds."""

    a: int
    b: str = "x"
    c: list[int] = field(default_factory=list)
    d: object = field(default=None, repr=False, compare=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "told", [*self.__dict__])


class Empty:
    """No field at all."""


class Own:
    """Methods of its own stay."""

    a: int
    b: int = field(init=False, repr=False)

    def __init__(self, a: int) -> None:
        object.__setattr__(self, "a", a)
        object.__setattr__(self, "b", -a)

    def __repr__(self) -> str:
        return "own"

    def __hash__(self) -> int:
        return 7


def both(kind: type) -> tuple[Any, Any]:
    """Two classes as that one is written: `@frozen`, and a frozen dataclass."""

    def again() -> type:
        body = {name: value for name, value in vars(kind).items() if name not in ("__dict__", "__weakref__")}
        return type(kind.__name__, (), body)

    return frozen(again()), dataclass(frozen=True)(again())


def signature(kind: type) -> list[Any]:
    """All but which object stands for a default that is made."""
    found = inspect.signature(kind)
    return [found.return_annotation, *((p.name, p.kind, p.annotation) for p in found.parameters.values())]


def outcome(call: Any) -> Any:
    try:
        return call()
    except (TypeError, FrozenInstanceError) as error:
        return type(error), str(error)


@pytest.mark.parametrize(
    ("kind", "calls"),
    [
        (One, [((1,), {}), ((), {"put": 2}), ((), {}), ((1, 2), {}), ((float("nan"),), {})]),
        (Many, [((1,), {}), ((1, "y", [3], 4), {}), ((), {"a": 1, "c": [5]}), ((), {}), ((1,), {"e": 2})]),
        (Empty, [((), {}), ((1,), {})]),
        (Own, [((1,), {}), ((2,), {}), ((), {})]),
    ],
    ids=["one", "many", "empty", "own"],
)
def test_it_does_what_a_dataclass_does(kind: type, calls: list[tuple[tuple[Any, ...], dict[str, Any]]]) -> None:
    mine, theirs = both(kind)
    assert signature(mine) == signature(theirs)
    assert mine.__match_args__ == theirs.__match_args__
    made = []
    for given, named in calls:
        one, other = (outcome(lambda made=made, g=given, n=named: made(*g, **n)) for made in (mine, theirs))
        if not isinstance(one, mine):
            assert one == other
            continue
        assert (repr(one), vars(one)) == (repr(other), vars(other))
        assert outcome(lambda one=one: hash(one)) == outcome(lambda other=other: hash(other))
        assert one == copy.copy(one)
        assert one != other
        assert dataclasses.is_dataclass(one)
        assert [f.name for f in dataclasses.fields(one)] == [f.name for f in dataclasses.fields(other)]
        for name in ("a", "put", "new"):
            assert outcome(lambda one=one, name=name: setattr(one, name, 1)) == outcome(
                lambda other=other, name=name: setattr(other, name, 1)
            )
            assert outcome(lambda one=one, name=name: delattr(one, name)) == outcome(
                lambda other=other, name=name: delattr(other, name)
            )
        made.append((one, other))
    for one, other in made:
        assert [one == each for each, _ in made] == [other == each for _, each in made]
    assert signature(mine) == signature(theirs)


def test_what_inherits_is_a_class_of_its_own() -> None:
    mine, _ = both(Many)

    class Bare(mine):
        """No decorator: the same fields."""

    @dataclass(frozen=True)
    class Wider(mine):
        e: int = 5

    wider = frozen(type("Third", (mine,), {"__annotations__": {"e": int}, "e": 5}))
    assert Bare(1) == Bare(1) != mine(1)
    assert repr(Bare(1)).endswith("Bare(a=1, b='x', c=[])")
    for kind in (Wider, wider):
        assert (kind(1).e, kind(1, e=6).e, kind(1) == kind(1)) == (5, 6, True)
    one = Bare(1)
    one.extra = 3  # type: ignore[attr-defined]
    with pytest.raises(FrozenInstanceError, match="cannot assign to field 'a'"):
        one.a = 2
    assert list(inspect.signature(Wider).parameters)[-1] == "e"


def test_what_it_cannot_set_is_refused() -> None:
    for settings in ({"init": False}, {"kw_only": True}):
        kind = type("Odd", (), {"__annotations__": {"a": int}, "a": field(default=1, **settings)})
        with pytest.raises(TypeError, match="@frozen cannot set"):
            frozen(kind)


def test_a_pickled_one_is_equal_in_a_process_that_has_made_none() -> None:
    event = Event(0, 1.5, (Contact("a", "b"),), (), (Tie((), TieProof.FIELD),))  # type: ignore[arg-type]
    again = pickle.loads(pickle.dumps(event))
    assert (again, hash(again), repr(again)) == (event, hash(event), repr(event))
    assert dataclasses.replace(event, index=1).index == 1
