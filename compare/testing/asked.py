"""What a check is asked for: which engine or log, and whose errors are granted."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ...scenarios.errors import SceneError
from ..engines import engine as engine_named
from ..foreign.log_engine import LogEngine
from ..validation import check_engine

if TYPE_CHECKING:
    from ...scenarios.engine import Engine
    from ...scenarios.scene import Scene

LOGS = (".jsonl", ".csv", ".log", ".ndjson")
"""Suffixes by which a text is known for the path of a log."""

WIDTHS = {"float16": 11, "float32": 24, "single": 24, "float64": 53, "double": 53, "quad": 106, "float128": 113}
"""Horizons by name: bits of the numbers whose errors are granted."""


def engine_asked(engine: Any, scene: Scene, declared: dict[str, Any]) -> tuple[Engine, str]:
    """The engine to check, and what messages call it."""
    if isinstance(engine, Path) or (isinstance(engine, str) and engine.lower().endswith(LOGS)):
        log = LogEngine.of(engine, scene, **declared)
        return log, log.name
    if isinstance(engine, Iterable) and not isinstance(engine, str):
        return LogEngine.of(engine, scene, **declared), "log"
    if declared:
        raise SceneError(f"{next(iter(declared))}: is declared of a log only; an engine declares it itself")
    chosen = engine_named(engine) if isinstance(engine, str) else check_engine(engine)
    return chosen, engine if isinstance(engine, str) else chosen.name


def bits_asked(engine: Engine, horizon: str | int | None) -> int | None:
    """The width whose errors are granted."""
    if horizon is None:
        return engine.bits
    if isinstance(horizon, str) and horizon in WIDTHS:
        return WIDTHS[horizon]
    bits = int(horizon) if isinstance(horizon, str) and horizon.isascii() and horizon.isdigit() else horizon
    if isinstance(bits, bool) or not isinstance(bits, int) or bits < 1:
        raise SceneError(f"horizon = {horizon!r}: must be a number of bits, or one of {', '.join(WIDTHS)}")
    return bits
