"""The command that shows a failed check again, or the Python, where no command has the same scene and engine."""

from __future__ import annotations

import dataclasses
import shlex
import sys
import sysconfig
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ...scenarios.errors import SceneError
from ...scenarios.trajectory import StopReason
from ..engines import ENGINES
from ..engines import engine as engine_named
from ..foreign.log_engine import LogEngine
from ..scene_argument import scene_from

if TYPE_CHECKING:
    from ...scenarios.engine import Engine
    from ...scenarios.scene import Scene
    from ..comparison import Comparison


def reproduction(comparison: Comparison, engine: Engine, text: str | None, where: str) -> str:
    """What shows a comparison of one engine again.

    Args:
        text: how the engine was asked for; None: as an object.
        where: what the scene is called; a command is told only where that is enough to have it again.
    """
    reference = comparison.reference
    limits: dict[str, Any] = {
        StopReason.EVENTS: {"events": len(reference.events)},
        StopReason.HORIZON: {"until": float(reference.final_time)},
    }.get(reference.stop.reason, {})
    return reproduction_of(comparison.scene, engine, text, where, limits)


def reproduction_of(scene: Scene, engine: Engine, text: str | None, where: str, limits: Mapping[str, Any]) -> str:
    """The command that runs an engine on a scene to some limits, or the Python.

    Args:
        text, where: as in `reproduction`.
        limits: `until` or `events`.
    """
    words = [word for key, value in limits.items() for word in (f"--{key}", repr(value))]
    named = _is_scene(where, scene)
    if named and isinstance(engine, LogEngine) and "log" in engine.recording.parameters:
        return " ".join(["truebreak judge", shlex.quote(where), shlex.quote(engine.name), *_declared(engine), *words])
    text = engine_text(engine) if text is None else text
    if named and text is not None:
        return " ".join(["truebreak compare", shlex.quote(where), "--engines", shlex.quote(text), *words])
    told = [f"truebreak.scene({where!r})" if named else "scene", f"[{'engine' if text is None else repr(text)}]"]
    return f"truebreak.comparison({', '.join([*told, *(f'{key}={value!r}' for key, value in limits.items())])})"


def check_again(engine: Engine, text: str | None, where: str, scene: Scene, demands: Mapping[str, Any]) -> str:
    """The check itself, in Python: what shows again that a number is off in a history that is right."""
    named = "log" if isinstance(engine, LogEngine) else "engine"
    text = engine_text(engine) if text is None and not isinstance(engine, LogEngine) else text
    if isinstance(engine, LogEngine) and "log" in engine.recording.parameters:
        text = engine.name
    told = [named if text is None else repr(text), repr(where) if _is_scene(where, scene) else "scene"]
    told += [f"{key}={value!r}" for key, value in demands.items() if value not in (None, False)]
    return f"truebreak.check({', '.join(told)})"


def _declared(engine: LogEngine) -> list[str]:
    """What was declared of a log, as options of `judge`."""
    words = [] if engine.bits in (None, 53) else ["--bits", str(engine.bits)]
    words += [] if engine.step is None else ["--step", repr(engine.step)]
    return words if engine.rounds_input else [*words, "--exact-input"]


def _is_scene(where: str, scene: Scene) -> bool:
    """Whether a scene is what the command line makes of a text."""
    try:
        return scene_from(where).digest == scene.digest
    except SceneError:
        return False


def engine_text(engine: Engine) -> str | None:
    """How the command line names an engine, in the folder where the user is; None where it cannot.

    >>> from truebreak.floating import PymunkEngine
    >>> engine_text(PymunkEngine()), engine_text(PymunkEngine(dt=1 / 64))
    ('pymunk', 'pymunk:dt=0.015625')
    """
    kind = type(engine)
    entry = ENGINES.get(engine.name)
    home = engine.name if entry is not None and entry.load() is kind else _class_text(kind)
    if home is None:
        return None
    for text in (home, f"{home}:{_settings(engine)}"):
        try:
            same = engine_named(text)
        except SceneError:
            continue
        if type(same) is kind and (same == engine or getattr(same, "__dict__", 0) == getattr(engine, "__dict__", 1)):
            return text
    return None


def _class_text(kind: type) -> str | None:
    """The class of a module that lies in the user's folder, or is installed."""
    top = sys.modules.get(kind.__module__.partition(".")[0])
    file = getattr(top, "__file__", None)
    if file is None or not kind.__qualname__.isidentifier() or kind.__module__ == "__main__":
        return None
    place = Path(file).parent.parent if Path(file).name == "__init__.py" else Path(file).parent
    known = {Path.cwd(), *map(Path, (sysconfig.get_path("purelib"), sysconfig.get_path("platlib")))}
    return f"{kind.__module__}:{kind.__qualname__}" if place in known else None


def _settings(engine: Engine) -> str:
    """The fields that are numbers and not at their default."""
    if not dataclasses.is_dataclass(engine):
        return ""
    values = {field.name: (getattr(engine, field.name), field.default) for field in dataclasses.fields(engine)}
    return ",".join(
        f"{key}={value!r}" for key, (value, usual) in values.items() if value != usual and type(value) in (int, float)
    )
