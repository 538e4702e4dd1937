"""Engines by name, truebreak's own and others, built from text such as `pymunk:dt=1/1000,iterations=30`."""

from __future__ import annotations

import dataclasses
import functools
import re
import sys
import types
import typing
from collections.abc import Callable, Mapping
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from ..scenarios.errors import SceneError
from ..scenarios.lazy import frozen

if TYPE_CHECKING:
    from fractions import Fraction

    from ..scenarios.engine import Engine

GROUP = "truebreak.engines"
"""The group of entry points under which an installed package offers engines."""

PATH = (
    r"(?:(?P<label>[\w.-]+)=)?(?P<module>[^\W\d]\w*(?:\.[^\W\d]\w*)*):(?P<attribute>[^\W\d][\w.]*)(?=[:,]|$)"
    r"[:,]?(?P<settings>.*)"
)


class ClassPath(NamedTuple):
    """`LABEL=package.module:Class:key=value`, taken apart.

    Attributes:
        label: what reports call it; None: as it was asked for.
        settings: `key=value,key=value`, or nothing.
    """

    label: str | None
    module: str
    attribute: str
    settings: str

    @property
    def place(self) -> str:
        """Where it is."""
        return f"{self.module}:{self.attribute}"


def class_path(text: str) -> ClassPath | None:
    """A text that says where an engine's class is; None for a name with settings, such as `pymunk:dt=1/100`.

    >>> class_path("mine=pool.engines:Fast:dt=1/100")
    ClassPath(label='mine', module='pool.engines', attribute='Fast', settings='dt=1/100')
    >>> class_path("pymunk:dt=1/100") is class_path("double") is None
    True
    """
    match = re.fullmatch(PATH, text.strip(), re.DOTALL) if ":" in text else None
    if match is None:
        return None
    return ClassPath(match["label"], match["module"], match["attribute"], match["settings"])


def label_of(text: str) -> str:
    """What reports call an engine that was asked for by a text.

    >>> label_of("mine=pool.engines:Fast"), label_of(" double ")
    ('mine', 'double')
    """
    path = class_path(text)
    return text.strip() if path is None or path.label is None else path.label


def load_class(path: ClassPath) -> Any:
    """What a path names: an engine's class, or an engine. The folder where the user is counts as one of modules.

    Raises:
        SceneError: if there is no such module or name, or the module raises.
    """
    here = str(Path.cwd())
    if here not in sys.path and "" not in sys.path:
        sys.path.append(here)
    try:
        found: Any = import_module(path.module)
    except (Exception, SystemExit) as error:
        missing = isinstance(error, ModuleNotFoundError) and error.name and path.module.startswith(error.name)
        reason = " ".join(str(error).split())
        remedy = "; is it installed, or in this folder?" if missing else ""
        raise SceneError(f"engine '{path.place}': {type(error).__name__}: {reason}{remedy}") from None
    for part in path.attribute.split("."):
        if not hasattr(found, part):
            raise SceneError(f"engine '{path.place}': {path.module} has no {part!r}; name a class of that module")
        found = getattr(found, part)
    return found


def offered() -> dict[str, Any]:
    """The entry points by which installed packages offer engines, by name; nothing of them is imported."""
    from importlib.metadata import entry_points

    return {point.name: point for point in entry_points(group=GROUP)}


def load_offered(name: str) -> Any:
    """What an entry point names.

    Raises:
        SceneError: if it cannot be had.
    """
    point = offered()[name]
    try:
        return point.load()
    except Exception as error:
        reason = " ".join(str(error).split())
        raise SceneError(f"engine {name!r}, offered as {point.value}: {type(error).__name__}: {reason}") from None


# ----------------------------------------
# The table of engines by name, and engines built from text such as `pymunk:dt=1/1000,iterations=30`.

ROOT = __name__.rpartition(".compare")[0]


@frozen
class EngineEntry:
    """Where an engine lives and what it is, without importing it.

    Attributes:
        name: what the command line calls it.
        path: the module below `truebreak`, and the class: a frozen dataclass whose fields are the engine's parameters.
        summary: one line for a listing.
    """

    name: str
    path: str
    summary: str

    @property
    def adapted(self) -> bool:
        """Whether it is somebody else's, and comes with the extra of its name."""
        return self.path.startswith("compare.adapters.")

    def load(self) -> type[Any]:
        """The engine's class, imported now."""
        module, _, name = self.path.partition(":")
        return getattr(import_module(f"{ROOT}.{module}"), name)


ENGINES: dict[str, EngineEntry] = {
    "exact": EngineEntry("exact", "exact.exact_engine:ExactEngine", "certified: every decision proved, or it says so"),
    "sympy": EngineEntry(
        "sympy", "exact.literal.symbolic_engine:SymbolicEngine", "SymPy alone, literally: slow, an oracle"
    ),
    "double": EngineEntry("double", "floating.double:DoubleEngine", "event-driven in 53-bit floating point"),
    "single": EngineEntry("single", "floating.single:SingleEngine", "event-driven in 24-bit floating point"),
    "quad": EngineEntry("quad", "floating.quad:QuadEngine", "event-driven in pairs of doubles: 106 bits"),
    "rounded": EngineEntry("rounded", "floating.rounded:RoundedEngine", "event-driven, rounded to N bits each time"),
    "interval": EngineEntry("interval", "floating.interval:IntervalEngine", "in intervals; stops where unsure"),
    "pymunk": EngineEntry("pymunk", "floating.pymunk_engine:PymunkEngine", "the game engine Chipmunk, by time steps"),
    "box2d": EngineEntry("box2d", "compare.adapters.box2d:Box2DEngine", "the game engine Box2D 2.3, by time steps"),
    "rapier": EngineEntry("rapier", "compare.adapters.rapier:RapierEngine", "the game engine Rapier, by time steps"),
    "mujoco": EngineEntry("mujoco", "compare.adapters.mujoco:MujocoEngine", "MuJoCo: contacts are springs, by steps"),
    "billiards": EngineEntry("billiards", "compare.adapters.billiards:BilliardsEngine", "hard discs, by events"),
    "pooltool": EngineEntry("pooltool", "compare.adapters.pooltool:PooltoolEngine", "the pool simulator, by events"),
    "perfect-physics": EngineEntry(
        "perfect-physics", "compare.adapters.perfect_physics:PerfectPhysicsEngine", "the article's engine, in SymPy"
    ),
}
"""Every engine that the command line and `compare` know. A new engine adds its own file and one line here."""


def engine(text: str) -> Engine:
    """The engine that `text` names: `NAME`, or `NAME:key=value,key=value` with the engine's parameters.

    NAME is in `ENGINES`, or an entry point of the group `truebreak.engines`. Any other is `package.module:Class`,
    `LABEL=package.module:Class`, either with `:key=value,key=value`.

    Raises:
        SceneError: for an unknown engine, an unknown parameter, or a value of the wrong type.

    >>> engine("truebreak.floating:DoubleEngine").name
    'double'
    >>> engine("duoble")
    Traceback (most recent call last):
      ...
    truebreak.scenarios.errors.SceneError: engine 'duoble' is not known; did you mean 'double'?
    """
    from ..scenarios.errors import SceneError

    name, _, settings = text.strip().partition(":")
    if name in ENGINES:
        return _own(name, settings) if not ENGINES[name].adapted else _built(name, settings)

    path = class_path(text)
    if path is not None:
        return build(path.place, load_class(path), parsed_settings(f"engine '{path.place}'", path.settings))
    others = offered()
    if name in others:
        return build(name, load_offered(name), parsed_settings(f"engine {name!r}", settings))
    raise SceneError(f"engine {name!r} is not known; {suggestion(name, [*ENGINES, *others])}")


def _built(name: str, settings: str) -> Engine:
    """The engine of the table of that name, with settings."""
    return build(name, ENGINES[name].load(), parsed_settings(f"engine {name!r}", settings))


_own = functools.lru_cache(maxsize=32)(_built)
"""The same of truebreak's own, which are frozen and keep nothing of a run: a grid asks for one at every scene."""


def build(name: str, kind: Any, settings: Mapping[str, str]) -> Engine:
    """The engine of a class, with settings given as text read by the types of the engine's fields.

    Args:
        kind: a dataclass, whose fields are the parameters; or what has none: another class, a function, an engine.

    Raises:
        SceneError: for an unknown setting or a value of the wrong type.
    """
    from ..scenarios.errors import SceneError
    from .validation import check_engine

    if not (isinstance(kind, type) and dataclasses.is_dataclass(kind)):
        if settings:
            raise SceneError(f"engine {name!r}: takes no parameters; make its class a dataclass with fields")
        if isinstance(kind, type) or (callable(kind) and not hasattr(kind, "run")):
            kind = _made(name, kind, {})
        return check_engine(kind)
    known = _parameters(kind)
    values: dict[str, Any] = {}
    for key, value in settings.items():
        if key not in known:
            raise SceneError(f"engine {name!r} has no parameter {key!r}; {suggestion(key, list(known))}")
        values[key] = converted(f"engine {name!r}: {key}", value, known[key])
    return check_engine(_made(name, kind, values))


@functools.cache
def _parameters(kind: Any) -> Mapping[str, Any]:
    """The parameters of an engine's dataclass, and the type of each. A type written as text is read once."""
    hints = typing.get_type_hints(kind)
    return {f.name: hints.get(f.name, str) for f in dataclasses.fields(kind) if f.init and f.name != "name"}


def _made(name: str, kind: Any, values: Mapping[str, Any]) -> Any:
    """An object of an engine's class.

    Raises:
        SceneError: if it cannot be made.
    """
    from ..scenarios.errors import SceneError

    try:
        return kind(**values)
    except SceneError:
        raise
    except Exception as error:
        raise SceneError(f"engine {name!r}: cannot be made: {type(error).__name__}: {error}") from None


def split_engines(text: str) -> list[str]:
    """Splits a list of engines at the commas that do not separate parameters.

    >>> split_engines("double,pymunk:dt=1/1000,iterations=30,interval")
    ['double', 'pymunk:dt=1/1000,iterations=30', 'interval']
    """
    parts: list[str] = []
    for piece in (part.strip() for part in text.split(",")):
        if "=" in piece and ":" not in piece and parts and ":" in parts[-1]:
            parts[-1] += f",{piece}"
        elif piece:
            parts.append(piece)
    return parts


def parsed_settings(label: str, text: str) -> dict[str, str]:
    """`key=value,key=value` as a dict of text.

    Raises:
        SceneError: for a piece without `=`, or a key given twice.
    """
    from ..scenarios.errors import SceneError

    settings: dict[str, str] = {}
    for piece in filter(None, (part.strip() for part in text.split(","))):
        key, equals, value = piece.partition("=")
        key, value = key.strip(), value.strip()
        if not equals or not key or not value:
            raise SceneError(f"{label}: {piece!r} is not a setting; write key=value")
        if key in settings:
            raise SceneError(f"{label}: {key!r} is set twice; keep one")
        settings[key] = value
    return settings


def suggestion(word: str, known: list[str]) -> str:
    """The end of an error about an unknown word: the nearest known one, or all of them."""
    import difflib

    near = difflib.get_close_matches(word, known, n=1)
    if near:
        return f"did you mean {near[0]!r}?"
    return f"choose from: {', '.join(known)}" if known else "there are none"


def converted(label: str, text: str, hint: Any) -> Any:
    """A setting's text as a value of the type that the field's annotation asks for.

    Raises:
        SceneError: if the text is not such a value.

    >>> from fractions import Fraction
    >>> converted("dt", "1/1000", Fraction), converted("bits", "none", int | None)
    (Fraction(1, 1000), None)
    """
    from fractions import Fraction

    from ..scenarios.errors import SceneError
    from ..scenarios.numbers.quantity import Quantity
    from ..scenarios.settings import TiePolicy

    options = typing.get_args(hint) if typing.get_origin(hint) in (typing.Union, types.UnionType) else (hint,)
    if type(None) in options and text.lower() in ("none", "null"):
        return None
    readers: dict[Any, Callable[[str], Any]] = {
        bool: _boolean,
        int: int,
        float: lambda value: float(Quantity.of(value)),
        Fraction: _fraction,
        Quantity: Quantity.of,
        TiePolicy: TiePolicy.parse,
        str: str,
    }
    for kind, read in readers.items():
        if kind not in options:
            continue
        try:
            return read(text)
        except (ValueError, OverflowError) as error:
            reason = f"; {error}" if isinstance(error, SceneError) else ""
            raise SceneError(f"{label} = {text!r} is not {NOUNS.get(kind.__name__, 'usable')}{reason}") from None
    if typing.get_origin(hint) is typing.Literal and text not in typing.get_args(hint):
        raise SceneError(f"{label} = {text!r}: {suggestion(text, [str(a) for a in typing.get_args(hint)])}")
    return text


NOUNS = {"bool": "true or false", "int": "a whole number", "float": "a number", "Fraction": "a rational number"}
"""What each type is called in an error, by its name."""


def _boolean(text: str) -> bool:
    words = {"true": True, "yes": True, "1": True, "false": False, "no": False, "0": False}
    if text.lower() not in words:
        raise ValueError(text)
    return words[text.lower()]


def _fraction(text: str) -> Fraction:
    from ..scenarios.numbers.quantity import Quantity

    value = Quantity.of(text).fraction
    if value is None:
        raise ValueError(text)
    return value
