"""What of the exact engine is compiled, where there was a compiler when truebreak was installed.

Each function here does in C what one of Python does in doubles: the same operations in the same order, so the same
bits. The Python stays: it has the derivations, it runs where there is no compiler, and tests hold the two against each
other (tests/exact/compiled). It also runs where the environment has `TRUEBREAK_PURE_PYTHON` set to anything.
"""

from __future__ import annotations

from collections.abc import Sequence
from importlib import import_module
from os import environ
from typing import Any, Protocol, TypeAlias, cast

PURE = "TRUEBREAK_PURE_PYTHON"
"""The environment variable by which all runs in Python."""

Doubles: TypeAlias = tuple[float, ...]


class Predictions(Protocol):
    """See predictions.c; flights, lines and bounds are those of `DoubleFilter`."""

    def pairs(
        self, flight: Doubles, others: Sequence[Any], reaches: Sequence[float], bounds: Doubles, /
    ) -> tuple[list[tuple[float, float, Any]], list[Any]]:
        """`DoubleFilter.pairs`, of a circle that has doubles."""
        ...

    def walls(
        self, flight: Doubles, lines: Sequence[Any], flat: float, far: float, /
    ) -> tuple[list[tuple[float, float, int]], list[int]]:
        """`DoubleFilter.walls`, of a circle that has doubles."""
        ...

    def predict(
        self,
        moved: Sequence[Any],
        others: list[list[Any]],
        lines: list[Any],
        reaches: list[list[float]],
        bounds: Doubles,
        slopes: tuple[float, float],
        standing: Any,
        heap: list[Any],
        order: int,
        /,
    ) -> int | None:
        """`FilteredPredictor.predict` of one or two circles, into the heap of an `ArrivalQueue`.

        Gives the last order that it used; None, with nothing changed, where something is not told by doubles, or not
        ordinary.
        """
        ...


def _loaded(name: str) -> object:
    """A compiled module; None where there is none, or Python is wished for."""
    if environ.get(PURE):
        return None
    try:
        return import_module(f"{__name__}.{name}")
    except ImportError:
        return None


predictions = cast("Predictions | None", _loaded("_predictions"))
"""None where Python runs."""
