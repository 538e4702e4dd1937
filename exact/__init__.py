"""The laws of motion derived by SymPy, the number systems, and the exact engine."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..scenarios.lazy import handed_on

if TYPE_CHECKING:
    from .exact_engine import ExactEngine
    from .literal.symbolic_engine import SymbolicEngine

__all__ = ["ExactEngine", "SymbolicEngine"]

__getattr__, __dir__ = handed_on(__name__, {"ExactEngine": "exact_engine", "SymbolicEngine": "literal.symbolic_engine"})
