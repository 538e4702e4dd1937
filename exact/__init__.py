"""The laws of motion derived by SymPy, the number systems, and the exact engine."""

from .engine import ExactEngine

__all__ = ["ExactEngine"]
