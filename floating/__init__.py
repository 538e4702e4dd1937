"""Engines of finite precision: doubles, mpmath intervals, and pymunk."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .double import DoubleEngine
    from .interval import IntervalEngine
    from .pymunk.engine import PymunkEngine
    from .quad import QuadEngine
    from .rounded import RoundedEngine
    from .single import SingleEngine

_HOMES = {
    "DoubleEngine": ".double",
    "IntervalEngine": ".interval",
    "PymunkEngine": ".pymunk.engine",
    "QuadEngine": ".quad",
    "RoundedEngine": ".rounded",
    "SingleEngine": ".single",
}

__all__ = ["DoubleEngine", "IntervalEngine", "PymunkEngine", "QuadEngine", "RoundedEngine", "SingleEngine"]


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(_HOMES[name], __name__), name)
