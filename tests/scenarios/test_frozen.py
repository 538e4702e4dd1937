"""`frozen` against what it stands for, `dataclass(frozen=True)`: the same class made by both."""

from __future__ import annotations

import copy
import inspect
import pickle
from collections.abc import Callable
from dataclasses import FrozenInstanceError, asdict, dataclass, field, fields, replace
from typing import Any

import pytest

from truebreak.exact.exact_engine import ExactEngine
from truebreak.scenarios.lazy import frozen
from truebreak.scenarios.trajectory import Event


def made_by(make: Callable[[type], type]) -> Any:
    """A class with a default, a made default, and fields that are not compared or not shown."""

    class Kick:
        """What a circle gets."""

        x: int
        y: float = 0.5
        note: str = field(default="", compare=False)
        rows: list[int] = field(default_factory=list, repr=False)

    return make(Kick)


BOTH = [made_by(frozen), made_by(dataclass(frozen=True))]

CALLS: list[tuple[tuple[Any, ...], dict[str, Any]]] = [
    ((1,), {}),
    ((1, 2.0, "a", [3]), {}),
    ((), {"x": 1}),
    ((1,), {"note": "b", "rows": [4]}),
]


@pytest.mark.parametrize("given, named", CALLS)
def test_it_is_made_compared_and_shown_alike(given: tuple[Any, ...], named: dict[str, Any]) -> None:
    mine, other = (kind(*given, **named) for kind in BOTH)
    assert (repr(mine), asdict(mine)) == (repr(other), asdict(other))
    assert repr(replace(mine, x=7)) == repr(replace(other, x=7))
    for again in (1, 2):
        for note in ("", "b"):
            assert (mine == BOTH[0](again, note=note)) is (other == BOTH[1](again, note=note))
    assert mine != other  # of another class
    assert mine == copy.deepcopy(mine)
    assert mine.rows is not BOTH[0](1).rows


@pytest.mark.parametrize("given, named", [((), {}), ((1, 2, "", [], 5), {}), ((1,), {"x": 2}), ((1,), {"z": 2})])
def test_what_is_no_call_is_refused(given: tuple[Any, ...], named: dict[str, Any]) -> None:
    for kind in BOTH:
        with pytest.raises(TypeError):
            kind(*given, **named)


def test_nothing_is_assigned_or_deleted() -> None:
    for kind in BOTH:
        thing = kind(1)
        for name in ("x", "strange"):
            with pytest.raises(FrozenInstanceError, match=f"cannot assign to field '{name}'"):
                setattr(thing, name, 2)
            with pytest.raises(FrozenInstanceError, match=f"cannot delete field '{name}'"):
                delattr(thing, name)
        assert thing.x == 1


def test_signatures_tell_the_same_parameters() -> None:
    shown = [
        [(one.name, one.kind, one.annotation) for one in inspect.signature(kind).parameters.values()] for kind in BOTH
    ]
    assert shown[0] == shown[1]
    assert [one.name for one in fields(BOTH[0])] == ["x", "y", "note", "rows"]
    assert BOTH[0].__match_args__ == BOTH[1].__match_args__


def test_hashes_go_by_what_is_compared() -> None:
    event = Event(1, 2, (), ())  # type: ignore[arg-type]
    assert hash(event) == hash(Event(1, 2, (), (), coupled=False))  # type: ignore[arg-type]
    assert len({event, replace(event, index=2), pickle.loads(pickle.dumps(event))}) == 2


def test_an_engine_may_be_built_upon() -> None:
    """As a frozen dataclass with more fields, and as a class with an `__init__` of its own."""

    @dataclass(frozen=True)
    class Patient(ExactEngine):
        patience: int = 3

    class Marked(ExactEngine):
        def __init__(self, mark: str) -> None:
            super().__init__(work=5)
            self.mark = mark

    assert replace(Patient(), patience=4) == Patient(patience=4) != Patient()
    assert list(inspect.signature(Patient).parameters)[-1] == "patience"
    assert (Marked("a").mark, Marked("a").work, list(inspect.signature(Marked).parameters)) == ("a", 5, ["mark"])
    with pytest.raises(FrozenInstanceError):
        Marked("a").work = 6  # type: ignore[misc]
