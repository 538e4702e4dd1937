"""The laws of motion derived by SymPy, the number systems, and the exact engine."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .engine import ExactEngine
    from .literal.engine import SymbolicEngine

_HOMES = {"ExactEngine": ".engine", "SymbolicEngine": ".literal.engine"}

__all__ = ["ExactEngine", "SymbolicEngine"]


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(_HOMES[name], __name__), name)
