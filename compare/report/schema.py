"""JSON Schemas of what the command line prints: `python -m truebreak.compare.report.schema` writes `schemas/`.

They are made of the classes that `documents.py` encodes, and of the types of what is saved.
"""

from __future__ import annotations

import ast
import builtins
import collections.abc
import json
import re
import sys
from collections.abc import Callable, Mapping, Sequence
from enum import Enum
from functools import cache
from importlib import import_module
from inspect import getdoc
from pathlib import Path
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, NotRequired, Union, get_args, get_origin, is_typeddict

from ...scenarios.disk import InSchema
from ...scenarios.numbers.quantity import Real
from ..grids.row import Columns, Row
from .documents import BY_VALUE, COMPUTED, Key, keys_of

DOCUMENTS = {
    "trajectory-1": ("scenarios.trajectory:Trajectory", "A run, as `truebreak run --json` prints it"),
    "comparison-5": ("compare.comparison:Comparison", "A comparison, as `compare --json` and `judge --json` print it"),
    "orders-2": (
        "compare.orders.all_orders:OrderTree",
        "All orders of instants, as `orders --json` prints them",
    ),
    "chaos-2": (
        "compare.chaos.certified_chaos:Chaos",
        "Growth of errors along a run, as `truebreak chaos --json` prints it",
    ),
    "shadow-2": ("compare.shadowing.shadows:Shadow", "A shadow of a run, as `truebreak shadow --json` prints it"),
    "sweep-2": (
        "compare.report.documents:SweepDocument",
        "What the rows of a sweep say, as `truebreak sweep --json` prints it",
    ),
    "restitution-1": (
        "compare.grids.bounce_survey:BounceSurvey",
        "The restitution of engines' bounces, as `truebreak survey --restitution --json` prints it",
    ),
    "stress-2": (
        "compare.report.grid_tables:StressDocument",
        "Where on families of ever harder scenes each engine turns wrong, as `truebreak stress --json` prints it",
    ),
    "suite-2": (
        "compare.grids.suite_file:SuiteDocument",
        "Engines compared with the certified runs of many scenes, as `suite --json` and `survey --json` print it",
    ),
    "advice-2": (
        "compare.report.search_text:AdviceDocument",
        "The cheapest setting of an engine that gets what is asked for right, as `truebreak advise --json` prints it",
    ),
    "bench-5": (
        "compare.report.speed_report:BenchDocument",
        "Run time against error, as `truebreak bench --json` prints it",
    ),
    "diff-1": (
        "compare.logdiff.desync:DiffDocument",
        "Two or more logs compared, as `diff --json` prints it",
    ),
    "certificate-3": (
        "compare.certificate.writer:Certificate",
        "A certificate of a run of the exact engine (docs/certificates.md)",
    ),
    "run-1": ("compare.files.saved:SavedRun", "A saved run, as `truebreak run --save` writes it"),
    "saved-comparison-1": (
        "compare.saved_comparisons:SavedComparison",
        "A saved comparison, as `truebreak compare --save` writes it",
    ),
}
"""Of each schema, the class whose form it is, and the title."""

NAMES = tuple(DOCUMENTS)

FOLDER = Path(__file__).with_name("schemas")

ROOT = str(__package__).partition(".compare")[0]

PLAIN = {bool: "boolean", int: "integer", str: "string"}


def schema(name: str) -> dict[str, Any]:
    """The schema of `truebreak/NAME`.

    Raises:
        KeyError: if there is none of that name.

    >>> schema("trajectory-1")["$id"]
    'truebreak/trajectory-1'
    """
    if name not in NAMES:
        raise KeyError(name)
    return json.loads((FOLDER / f"{name}.json").read_text(encoding="utf-8"))


def text(name: str) -> str:
    """The text of a schema that is made of classes.

    >>> '"title": "A run, as `truebreak run --json` prints it"' in text("trajectory-1")
    True
    """
    place, title = DOCUMENTS[name]
    maker, kind = _Maker(), _class(place)
    whole = maker.typed(kind) if is_typeddict(kind) else maker.object_of(kind)
    properties, required = whole.pop("properties"), whole.pop("required")
    if "format" not in properties:  # a certificate calls it so
        properties = {"schema": None, **properties} | {"schema": {"const": f"truebreak/{name}"}}
        required = list(dict.fromkeys(["schema", *required]))
    head = {"$schema": "https://json-schema.org/draft/2020-12/schema", "$id": f"truebreak/{name}", "title": title}
    told = {**head, **whole, "required": required, "properties": properties, "$defs": maker.definitions}
    long = json.dumps(told, indent=1, ensure_ascii=False)
    return re.sub(r"\[[^][{}]*\]", lambda found: " ".join(found[0].split()), long) + "\n"  # a short list is one line


@cache
def _class(place: str) -> Any:
    module, _, kind = place.partition(":")
    return getattr(import_module(f"{ROOT}.{module}"), kind)


class _Names(dict[str, Any]):
    """What annotations of a module name: also what it imports for the checker of types alone."""

    def __init__(self, module: str) -> None:
        super().__init__({**vars(collections.abc), **vars(builtins), "Any": Any, **vars(sys.modules[module])})
        self._module = module

    def __missing__(self, name: str) -> Any:
        source = Path(str(sys.modules[self._module].__file__)).read_text(encoding="utf-8")
        for node in ast.walk(ast.parse(source)):
            if isinstance(node, ast.ImportFrom) and any(alias.name == name for alias in node.names):
                home = import_module("." * node.level + (node.module or ""), self._module.rpartition(".")[0])
                return getattr(home, name)
        raise KeyError(name)


def _hint(of: Any, name: str) -> Any:
    """The type that a class or a function notes for a name: that of the class nearest to it."""
    owner = next((kind for kind in getattr(of, "__mro__", (of,)) if name in getattr(kind, "__annotations__", {})), of)
    noted = getattr(owner.__annotations__[name], "__forward_arg__", owner.__annotations__[name])  # of a NamedTuple
    while isinstance(noted, str):
        noted = eval(noted, {}, _Names(owner.__module__))
    return noted


def _type_at(kind: Any, path: str) -> Any:
    """The type of an attribute, however deep, whether it is a field or a property."""
    for part in path.split("."):
        found = getattr(kind, part, None)
        getter = getattr(found, "fget", None) or getattr(found, "func", None) or getattr(found, "__wrapped__", None)
        kind = _hint(getter, "return") if getter is not None else _hint(kind, part)
    return kind


def _meaning(kind: Any, path: str) -> str:
    """What the docstring says of an attribute: its own, or the entry under `Attributes:` of its class."""
    *way, last = path.split(".")
    kind = _type_at(kind, ".".join(way)) if way else kind
    found = getattr(kind, last, None)
    getter = getattr(found, "fget", None) or getattr(found, "func", None) or getattr(found, "__wrapped__", None)
    if getter is not None:
        return _sentence(getdoc(getter) or "")
    entry = re.search(rf"^    (?:\w+, )*{last}(?:, \w+)*: (.*(?:\n        .*)*)", getdoc(kind) or "", re.MULTILINE)
    return _sentence(entry[1]) if entry else ""


def _sentence(doc: str) -> str:
    """The first paragraph of a docstring, as JSON has its values."""
    text = re.sub(r"\bNone\b", "null", " ".join(doc.partition("\n\n")[0].split()))
    return text[:1].upper() + text[1:]


class _Maker:
    """Makes a schema.

    Attributes:
        definitions: of the classes met on the way.
    """

    def __init__(self) -> None:
        self.definitions: dict[str, Any] = {}

    def object_of(self, kind: Any) -> dict[str, Any]:
        """An object of a class that has a form."""
        properties: dict[str, Any] = {}
        required: list[str] = []
        for key in keys_of(kind):
            properties[key.name] = self._property(kind, key)
            if key.number:
                properties[f"{key.name}_interval"] = {"type": "array", "items": {"type": "number"}, "minItems": 2,
                                                      "maxItems": 2}  # fmt: skip
                properties[f"{key.name}_exact"] = {"type": ["string", "null"]}
            if not key.optional:
                required.append(key.name)
        about = _sentence(getdoc(kind) or "")
        return {"description": about, "type": "object", "required": required, "additionalProperties": False,
                "properties": properties}  # fmt: skip

    def typed(self, kind: Any) -> dict[str, Any]:
        """An object of a `TypedDict`."""
        hints = {name: _hint(kind, name) for name in kind.__annotations__}
        properties = {
            name: {"description": about, **self.of(hint)} if (about := _meaning(kind, name)) else self.of(hint)
            for name, hint in hints.items()
        }
        required = [name for name, hint in hints.items() if kind.__total__ and get_origin(hint) is not NotRequired]
        return {"description": _sentence(getdoc(kind) or ""), "type": "object", "required": required,
                "additionalProperties": False, "properties": properties}  # fmt: skip

    def _row(self, columns: Columns) -> dict[str, Any]:
        """A row of a grid."""
        properties = {key: {"description": _meaning(Row, key), **self.of(_hint(Row, key))} for key in columns.keys}
        return {"type": "object", "required": list(columns.keys), "additionalProperties": False,
                "properties": properties}  # fmt: skip

    def _defined(self, kind: Any, make: Callable[[Any], dict[str, Any]]) -> dict[str, Any]:
        """A reference to what is made of a class once."""
        if kind.__name__ not in self.definitions:
            self.definitions[kind.__name__] = {}
            self.definitions[kind.__name__] = make(kind)
        return {"$ref": f"#/$defs/{kind.__name__}"}

    def _property(self, kind: Any, key: Key) -> dict[str, Any]:
        function = COMPUTED.get(f"{kind.__name__}.{key.name}")
        if function is None:
            hint, about = _type_at(kind, key.path), _meaning(kind, key.path)
        else:
            hint, about = _hint(function, "return"), _sentence(getdoc(function) or "")
        if key.optional and get_origin(hint) in (Union, UnionType):
            hint = Union[tuple(part for part in get_args(hint) if part is not NoneType)]  # noqa: UP007
        told = self.of(hint)
        return {"description": about, **told} if about else told

    def of(self, hint: Any) -> dict[str, Any]:
        """A value of a type."""
        if isinstance(hint, str):  # an alias within another type
            return self.of(eval(hint, {}, _Names(__name__)))
        if hint is Any:
            return {}
        if hint in PLAIN:
            return {"type": PLAIN[hint]}
        if is_typeddict(hint):
            return self._defined(hint, self.typed)
        origin, parts = get_origin(hint), get_args(hint)
        if origin is Annotated:  # rows with some of their columns, and text that is one of several words
            return self._row(parts[1]) if isinstance(parts[1], Columns) else self._annotated(*parts)
        if hint is float or hint == Real:
            return {"type": ["number", "null"]}
        if origin is Literal:
            return {"enum": list(parts)}
        if origin is NotRequired:
            return self.of(parts[0])
        if origin in (Union, UnionType):
            if NoneType not in parts:
                return {"anyOf": [self.of(part) for part in parts]}
            others = [self.of(part) for part in parts if part is not NoneType]
            return self._nullable(others[0]) if len(others) == 1 else {"anyOf": [*others, {"type": "null"}]}
        if isinstance(origin, type) and issubclass(origin, Mapping):
            return {"type": "object", "additionalProperties": self.of(parts[1])}
        if origin is tuple and parts[-1:] != (Ellipsis,):
            return self._tuple(parts)
        if isinstance(origin, type):
            return {"type": "array", "items": self.of(parts[0])}
        if issubclass(hint, Enum):
            open_list = hint.__name__ in BY_VALUE
            return {"type": "string"} if open_list else {"enum": [each.name.lower() for each in hint]}
        if keys_of(hint):
            return self._defined(hint, self.object_of)
        if issubclass(hint, tuple):
            return self._tuple(tuple(_hint(hint, name) for name in hint.__annotations__))
        return {"type": "string"}

    def _annotated(self, kind: Any, more: Any) -> dict[str, Any]:
        """A value of a type with what a schema says of it besides; with a `name` it stands among the definitions."""
        if not isinstance(more, InSchema):
            return self.of(more)
        if more.name is None:
            return {**self.of(kind), **more.words}
        if more.name not in self.definitions:
            self.definitions[more.name] = {}
            self.definitions[more.name] = {**self.of(kind), **more.words}
        return {"$ref": f"#/$defs/{more.name}"}

    def _tuple(self, parts: Sequence[Any]) -> dict[str, Any]:
        if not parts:
            return {"type": "array", "maxItems": 0}
        return {"type": "array", "prefixItems": [self.of(part) for part in parts], "items": False,
                "minItems": len(parts)}  # fmt: skip

    def _nullable(self, told: dict[str, Any]) -> dict[str, Any]:
        if "enum" in told:
            return {"enum": [*told["enum"], None]}
        if isinstance(told.get("type"), str):
            return {**told, "type": [told["type"], "null"]}
        if told.get("type") == ["number", "null"] or not told:
            return told
        return {"anyOf": [told, {"type": "null"}]}


def main() -> None:
    """Writes the schemas that are made of classes."""
    for name in DOCUMENTS:
        (FOLDER / f"{name}.json").write_text(text(name), encoding="utf-8")


if __name__ == "__main__":
    main()
