"""Numbers, logs and whole results as JSON, and back, digit for digit: saved runs and comparisons are made of these."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import fields, is_dataclass
from enum import Enum
from functools import cached_property
from importlib import import_module
from typing import Annotated, Any, Literal, TypeAlias

import mpmath
import numpy as np
from flint import arb, fmpq, fmpz
from mpmath.ctx_iv import ivmpf
from mpmath.libmp import MPZ

from ...exact.exact_motion import Source
from ...exact.numbers.ball import Known, from_parts, parts_of
from ...exact.replay.contact import KINDS, Link, Touch, can_push
from ...exact.replay.state import Flip, Go, Kick, Leave, Lift, Settle, Step, Take
from ...exact.simulation.decider import PackedRows
from ...scenarios.disk import InSchema
from ...scenarios.errors import SceneError
from ...scenarios.files import dump_json, loads_json
from ...scenarios.lazy import Late
from ...scenarios.numbers.nested_roots import Tower
from ...scenarios.numbers.parsing import MAX_LENGTH
from ...scenarios.numbers.precision import Double
from ...scenarios.numbers.quantity import Quantity
from ...scenarios.numbers.tower_element import Element
from ...scenarios.scene import Scene

Written: TypeAlias = Any
"""What JSON holds: whole numbers, text, lists."""

Count: TypeAlias = Annotated[int, InSchema(minimum=0)]

NumberData: TypeAlias = Annotated[
    Annotated[str, InSchema(pattern="^-?[0-9]+(/[0-9]+)?$")]
    | tuple[str]
    | tuple[Annotated[str, InSchema(pattern="^-?[0-9a-f]+$")], int, int, int]
    | tuple[()],
    InSchema(
        "number", has_reader=True, title="An exact number as text, one with roots as [text], else a ball [m, e, r, f]"
    ),
]

LinkData: TypeAlias = Annotated[
    tuple[Count, Count] | tuple[Count, Count, Annotated[str, InSchema(enum=sorted(kind for kind in KINDS if kind))]],
    InSchema("link", has_reader=True, title="A contact by place: circle and circle; circle and wall, arc or pocket"),
]

SourceData: TypeAlias = Annotated[Count | LinkData | str, InSchema("source", has_reader=True)]

TimeData: TypeAlias = Annotated[
    str | tuple[Count, Count, SourceData, NumberData],
    InSchema("time", has_reader=True, title="A set time as text, else [instant, steps, source, number]"),
]

StepData: TypeAlias = Annotated[
    tuple[Literal["go"], SourceData, list[Count]]
    | tuple[Literal["kick"], list[LinkData], list[LinkData]]
    | tuple[Literal["flip"]]
    | tuple[Literal["take"], Count]
    | tuple[Literal["settle"], Count, Count, bool]
    | tuple[Literal["lift"], Count],
    InSchema("step", has_reader=True),
]

ELEMENT_BITS = 192
"""Accuracy of a number whose normal form is longer than the reader of numbers takes: the log has its exact value."""


class NumberWriter:
    """Writes numbers: exact ones as text, balls as four whole numbers, those with roots as ["text"].

    Attributes:
        roots: the roots that generate the field of those with roots, in their order.
    """

    def __init__(self) -> None:
        self._tower: Tower | None = None

    def __call__(self, number: Known) -> Written:
        """One number."""
        if isinstance(number, fmpq):
            return str(number)
        if isinstance(number, arb):
            return _ball_data(number)
        text = number.text()
        if len(text) > MAX_LENGTH:
            return _ball_data(number.ball(ELEMENT_BITS))
        assert self._tower in (None, number.tower), "the exact numbers of a run lie in one field"
        assert isinstance(number.tower, Tower)
        self._tower = number.tower
        return [text]

    @property
    def roots(self) -> list[str]:
        return [] if self._tower is None else [root.text() for root in self._tower.generators]


class NumberReader:
    """Reads what a `NumberWriter` wrote.

    Args:
        roots: its roots.
    """

    def __init__(self, roots: Sequence[str]) -> None:
        self._tower = Tower()
        self._known: dict[str, Element] = {}
        for root in roots:
            Quantity.of(root).in_tower(self._tower)
        if [root.text() for root in self._tower.generators] != list(roots):
            raise ValueError("the roots do not generate the field")

    def __call__(self, written: Written) -> Known:
        """One number.

        Raises:
            ValueError: if no writer wrote this.
        """
        if isinstance(written, str):
            return _rational(written)
        if len(written) != 1:
            return _ball_of(written)
        text = written[0]
        if text not in self._known:
            self._known[text] = Quantity.of(text).in_tower(self._tower)
            if self._known[text].text() != text:
                raise ValueError(f"{text} is not in normal form")
        return self._known[text]


def _rational(text: str) -> fmpq:
    p, _, q = text.partition("/")
    return fmpq(fmpz(p), fmpz(q or "1"))


def _ball_data(ball: arb) -> Written:
    """Its parts, the midpoint's digits in hexadecimal: of those Python reads and writes any number."""
    parts = parts_of(ball)
    return [f"{parts[0]:x}", *parts[1:]] if parts else []


def _ball_of(written: Written) -> arb:
    return from_parts(int(written[0], 16), *written[1:]) if written else from_parts()


# -- the log


def step_data(step: Step) -> Written:
    """A step of the log.

    >>> from truebreak.exact.replay.contact import Pair
    >>> step_data(Go(Pair(0, 1), (0, 1))), step_data(Flip())
    (['go', [0, 1], [0, 1]], ['flip'])
    """
    if isinstance(step, Go):
        return ["go", source_data(step.source), list(step.bodies)]
    if isinstance(step, Kick):
        return ["kick", links_data(step.links), links_data(step.among)]
    if isinstance(step, Settle):
        return ["settle", *step]
    if isinstance(step, Leave):
        return ["leave", *links_data((step.link,)), step.fold]
    return (
        ["take", step.body] if isinstance(step, Take) else ["lift", step.body] if isinstance(step, Lift) else ["flip"]
    )


def step_of(data: Written) -> Step:
    """What `step_data` wrote.

    Raises:
        ValueError: for what is no step.

    >>> step_of(["kick", [[0, 1]], [[0, 1]]])
    Kick(links=(Pair(a=0, b=1),), among=(Pair(a=0, b=1),))
    """
    match data:
        case ["go", str(text), bodies]:
            return Go(Quantity.of(text), tuple(bodies))
        case ["go", source, bodies]:
            clock = source_of(source)
            assert not isinstance(clock, str)
            return Go(clock, tuple(bodies))
        case ["kick", links, among]:
            return Kick(links_of(links), links_of(among))
        case ["take", int(body)]:
            return Take(body)
        case ["settle", int(body), int(wall), bool(slides)]:
            return Settle(body, wall, slides)
        case ["settle", int(body), int(wall), bool(slides), bool(bounces)]:
            return Settle(body, wall, slides, bounces)
        case ["settle", int(body), int(wall), bool(slides), bool(bounces), int(other)]:
            return Settle(body, wall, slides, bounces, other)
        case ["lift", int(body)]:
            return Lift(body)
        case ["leave", list(link), int(fold)]:
            return Leave(links_of([link])[0], fold)
        case ["flip"]:
            return Flip()
        case _:
            raise ValueError(f"{data} is no step")


def source_data(source: Source | Quantity) -> Written:
    """Whose time it is: a meeting as a list, a circle as a number, anything else as text."""
    if isinstance(source, Quantity):
        return set_time_data(source)
    return list(source) if isinstance(source, tuple) else source


def set_time_data(time: Quantity) -> Written:
    """A set time as text.

    Raises:
        SceneError: if the reader of numbers does not take that text.
    """
    text = time.text()
    Quantity.of(text)
    return text


def source_of(data: Written) -> Source:
    """What `source_data` wrote, a set time left as text."""
    return link_of(data) if isinstance(data, list) else data


def links_data(links: Sequence[Link]) -> Written:
    """Contacts by index."""
    return [list(link) for link in links]


def links_of(data: Written) -> tuple[Touch, ...]:
    """What `links_data` wrote."""
    return tuple(link for link in map(link_of, data) if can_push(link))


def link_of(data: Written) -> Link:
    """One contact: its indices, and, of a wall or a pocket, which it is.

    Raises:
        ValueError: for what is none.
    """
    match data:
        case [int(first), int(second)]:
            return KINDS[""](first, second)
        case [int(first), int(second), str(kind)] if kind and kind in KINDS:
            return KINDS[kind](first, second)
        case _:
            raise ValueError(f"{data} is no contact")


# -- Objects: values of the classes listed here, shared ones once.

STEPS = ("Flip", "Go", "Kick", "Take")

CLASSES = (
    "compare.alignment.align:Alignment",
    "compare.alignment.align:Wanted",
    "compare.alignment.instants:Divergence",
    "compare.alignment.instants:Kind",
    "compare.alignment.align:Separation",
    "compare.alignment.walk:Mismatch",
    "compare.alignment.walk:Walk",
    "compare.alternatives:Alternative",
    "compare.audit.audit:Audit",
    "compare.audit.residual:Violation",
    "compare.audit.fits:BounceRatios",
    "compare.audit.fits:Fit",
    "compare.audit.residual:Defect",
    "compare.candidate:Candidate",
    "compare.causes.diagnosis:CauseName",
    "compare.causes.diagnosis:Diagnosis",
    "compare.causes.diagnosis:Experiment",
    "compare.causes.diagnosis:Margin",
    "compare.certificate.certified:Certified",
    "compare.tangent.hazard:ErrorModel",
    "compare.comparison:Comparison",
    "compare.study:_Still",
    "compare.outcomes.permitted:Witness",
    "compare.outcomes.permitted:PermittedPatterns",
    "compare.outcomes.permitted:PatternRelation",
    "exact.replay.contact:AtArc",
    "exact.replay.contact:AtWall",
    "exact.replay.contact:Entry",
    "exact.replay.contact:Pair",
    "exact.replay.state:Constant",
    "exact.exact_motion:ExactMotion",
    "exact.flight_formulas:Bounced",
    "exact.flight_formulas:BounceTime",
    "exact.flight_formulas:Place",
    "exact.replay.state:Velocity",
    "exact.flight_formulas:FallSpeed",
    "exact.replay.contact:Gravity",
    "exact.simulation.decider:RunLog",
    "exact.simulation.policies:Accumulating",
    "exact.exact_motion:TimeFormula",
    "exact.exact_motion:ExactValue",
    "exact.simulation.instant:Instant",
    "exact.simulation.decider:Limits",
    "exact.simulation.loop:Reached",
    "exact.simulation.loop:Tape",
    "floating.quad:DoubleDouble",
    "floating.interval:IntervalMotion",
    "floating.interval:IntervalNumber",
    "floating.knots:DoubleMotion",
    "floating.knots:EventMotion",
    "floating.knots:FallingEvents",
    "floating.knots:FallingMotion",
    "floating.knots:SteppedEvents",
    "floating.knots:SteppedFall",
    "floating.knots:SteppedMotion",
    "floating.quad:QuadMotion",
    "floating.quad:QuadNumber",
    "floating.quad:QuadTime",
    "scenarios.trajectory:Assumption",
    "scenarios.trajectory:Contact",
    "scenarios.trajectory:Event",
    "scenarios.trajectory:Pocketing",
    "scenarios.trajectory:Reversal",
    "scenarios.trajectory:Tie",
    "scenarios.trajectory:TieProof",
    "scenarios.trajectory:CircleState",
    "scenarios.trajectory:State",
    "scenarios.trajectory:Stop",
    "scenarios.trajectory:StopReason",
    "scenarios.trajectory:Trajectory",
)
"""Every class that a comparison of truebreak's own engines, or of logs, holds. Nothing else is written or made."""

_HOMES = {kind: module for module, _, kind in (name.partition(":") for name in CLASSES)}

ROOT = str(__package__).partition(".compare")[0]


def _name_of(kind: type) -> str:
    return f"{kind.__module__.removeprefix(f'{ROOT}.')}:{kind.__qualname__}"


class Writer:
    """Writes objects.

    Attributes:
        roots: for each field of exact numbers, the roots that generate it.
    """

    def __init__(self) -> None:
        self._seen: dict[int, int] = {}
        self._kept: list[Any] = []
        self._fields: dict[int, tuple[int, NumberWriter]] = {}

    @property
    def roots(self) -> list[list[str]]:
        return [writer.roots for _, writer in self._fields.values()]

    def __call__(self, value: Any) -> Any:
        """One object.

        Raises:
            SceneError: for one of no class listed.
        """
        if value is None or isinstance(value, bool | str) or type(value) is int:
            return value
        if isinstance(value, Enum):
            return {"enum": self._listed(value), "name": value.name}
        if isinstance(value, float) and not getattr(value, "__dict__", None):
            return self._float(value)
        if type(value) is list or isinstance(value, PackedRows):
            return [self(item) for item in value]
        if type(value) is tuple or isinstance(value, Late):
            return {"tuple": [self(item) for item in value]}
        if isinstance(value, set | frozenset):
            return {
                "set": sorted((self(item) for item in value), key=json.dumps),
                "frozen": isinstance(value, frozenset),
            }
        if isinstance(value, Mapping):
            return {"dict": [[self(key), self(item)] for key, item in value.items()]}
        return self._number(value) or self._object(value)

    def _float(self, value: float) -> Any:
        told = float(value) if math.isfinite(value) else {"float": repr(float(value))}
        return {"double": told} if type(value) is Double else told

    def _number(self, value: Any) -> Any:
        if isinstance(value, np.ndarray):
            return {"array": self(value.tolist()), "type": value.dtype.str}
        if isinstance(value, np.generic):
            return self(value.item())
        if isinstance(value, Quantity):
            return {"exact": set_time_data(value)}
        if isinstance(value, fmpq):
            return {"rational": str(value)}
        if isinstance(value, arb):
            return {"ball": [f"{part:x}" for part in parts_of(value)]}
        if isinstance(value, Element):
            place, writer = self._fields.setdefault(id(value.tower), (len(self._fields), NumberWriter()))
            self._kept.append(value.tower)
            return {"field": place, "number": writer(value)}
        if isinstance(value, ivmpf):
            ends: Any = value
            return {"interval": [[int(s), f"{int(m):x}", int(e), int(b)] for s, m, e, b in ends._mpi_]}
        return None

    def _object(self, value: Any) -> Any:
        if id(value) in self._seen:
            return {"same": self._seen[id(value)]}
        kind = type(value)
        if kind.__name__ in STEPS and kind.__module__ == f"{ROOT}.exact.replay.state":
            return {"step": step_data(value)}
        self._seen[id(value)] = len(self._seen)
        self._kept.append(value)  # so that no other object gets its identity
        if isinstance(value, Scene):
            return {"scene": json.loads(dump_json(value))}
        named = {"is": self._listed(value)}
        if isinstance(value, tuple):
            return {**named, "of": [self(item) for item in value]}
        if isinstance(value, float):
            named["float"] = self._float(float(value))
        return {**named, "has": {key: self(item) for key, item in _parts(value).items()}}

    def _listed(self, value: Any) -> str:
        name = _name_of(type(value))
        if name not in CLASSES:
            raise SceneError(
                f"a {type(value).__qualname__} of {type(value).__module__} cannot be saved as JSON; pickle it"
            )
        return name


def _parts(value: Any) -> dict[str, Any]:
    """What makes an object: the fields of a dataclass, else its attributes."""
    if is_dataclass(value):
        return {field.name: getattr(value, field.name) for field in fields(value)}
    slots = getattr(type(value), "__slots__", None)
    if slots:
        return {name: getattr(value, name) for name in slots}
    kind = type(value)
    state: dict[str, Any] = value.__getstate__()
    return {name: part for name, part in state.items() if not isinstance(getattr(kind, name, None), cached_property)}


FORMS = frozenset(
    ("array", "ball", "dict", "double", "enum", "exact", "field", "float", "interval", "is", "rational", "same")
) | {"scene", "set", "step", "tuple"}
"""How an object begins, of those that are no lists and no plain values of JSON."""

ELEMENTS = re.compile(r"[<>|][biuf][1248]")
"""What arrays are of: truth values, whole numbers, floats."""


class Reader:
    """Reads what a `Writer` wrote.

    Args:
        roots: its roots.
    """

    def __init__(self, roots: list[list[str]]) -> None:
        self._seen: list[Any] = []
        self._numbers = [NumberReader(each) for each in roots]

    def __call__(self, data: Any) -> Any:
        """One object.

        Raises:
            ValueError, LookupError, TypeError: if no writer wrote this.
        """
        if isinstance(data, list):
            return [self(item) for item in data]
        if not isinstance(data, dict):
            return data
        form = next(iter(data), None)
        if form not in FORMS:
            raise ValueError("an object of none of the forms that are read")
        return getattr(self, f"_{form}")(**{f"{key}_": item for key, item in data.items()})

    def _enum(self, enum_: str, name_: str) -> Any:
        return _class(enum_)[name_]

    def _float(self, float_: str) -> float:
        return float(float_)

    def _double(self, double_: Any) -> Double:
        return Double(self(double_))

    def _tuple(self, tuple_: list[Any]) -> tuple[Any, ...]:
        return tuple([self(item) for item in tuple_])

    def _set(self, set_: list[Any], frozen_: bool) -> Any:
        found = {self(item) for item in set_}
        return frozenset(found) if frozen_ else found

    def _dict(self, dict_: list[Any]) -> dict[Any, Any]:
        return {self(key): self(item) for key, item in dict_}

    def _array(self, array_: Any, type_: str) -> Any:
        if not ELEMENTS.fullmatch(type_):
            raise ValueError("an array of what no writer writes")
        return np.array(self(array_), dtype=np.dtype(type_))

    def _exact(self, exact_: str) -> Quantity:
        return Quantity.of(exact_)

    def _rational(self, rational_: str) -> fmpq:
        return fmpq(*map(int, rational_.split("/")))

    def _ball(self, ball_: list[str]) -> arb:
        return from_parts(*(int(part, 16) for part in ball_))

    def _field(self, field_: int, number_: Any) -> Any:
        return self._numbers[field_](number_)

    def _interval(self, interval_: list[Any]) -> Any:
        return mpmath.iv.make_mpf(tuple((s, MPZ(int(m, 16)), e, b) for s, m, e, b in interval_))

    def _same(self, same_: int) -> Any:
        return self._seen[same_]

    def _step(self, step_: Any) -> Any:
        return step_of(step_)

    def _scene(self, scene_: Any) -> Scene:
        place = len(self._seen)
        self._seen.append(None)
        self._seen[place] = loads_json(json.dumps(scene_), "the scene")
        return self._seen[place]

    def _is(self, is_: str, of_: Any = None, has_: Any = None, float_: Any = None) -> Any:
        kind = _class(is_)
        place = len(self._seen)
        self._seen.append(None)
        if of_ is not None:
            self._seen[place] = kind(*(self(item) for item in of_))
            return self._seen[place]
        made = kind.__new__(kind) if float_ is None else kind.__new__(kind, self(float_))
        self._seen[place] = made
        for key, item in has_.items():
            if key.startswith("__"):
                raise ValueError(f"{key} is no part of an object")
            object.__setattr__(made, key, self(item))
        return made


def _class(name: str) -> Any:
    """The class of that name, in whatever room it was when the file was written."""
    module = _HOMES.get(kind := name.rpartition(":")[2])
    if module is None:
        raise ValueError(f"{name} is not among the classes that are read")
    return getattr(import_module(f"{ROOT}.{module}"), kind)
