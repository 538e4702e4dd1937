"""Engines of finite precision: doubles, mpmath intervals, and pymunk."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..scenarios.lazy import handed_on

if TYPE_CHECKING:
    from .double import DoubleEngine
    from .interval import IntervalEngine
    from .pymunk_engine import PymunkEngine
    from .quad import QuadEngine
    from .rounded import RoundedEngine
    from .single import SingleEngine

__all__ = ["DoubleEngine", "IntervalEngine", "PymunkEngine", "QuadEngine", "RoundedEngine", "SingleEngine"]

_HOMES = {
    "DoubleEngine": "double",
    "IntervalEngine": "interval",
    "PymunkEngine": "pymunk_engine",
    "QuadEngine": "quad",
    "RoundedEngine": "rounded",
    "SingleEngine": "single",
}

__getattr__, __dir__ = handed_on(__name__, _HOMES)
