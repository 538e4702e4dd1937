"""The formulas of the laws as the flat loop runs them: written by hand, inlined by a program, and compiled.

`pairs` and `walls` are those of `inlined.py`, or of flying.c where there was a compiler when truebreak was installed:
the same operations in the same order (see `truebreak.exact.compiled`).
"""

from __future__ import annotations

from collections.abc import Container, Iterable
from typing import Protocol, cast

from ....exact.compiled import loaded
from ..flights import FlatFlight, FlatFlights, FlatLine
from . import inlined


class Flying(Protocol):
    """See flying.py."""

    def walls(self, f: FlatFlights, i: int, lines: Iterable[FlatLine], standing: Container[int], /) -> None:
        """Queues the next hits of a circle with some walls, up to the first."""
        ...

    def pairs(self, f: FlatFlights, i: int, others: Iterable[FlatFlight], standing: Container[int], /) -> None:
        """Queues the next meetings of a circle, whose flight is new, with circles whose flights are older."""
        ...


compiled = cast("Flying | None", loaded(f"{__name__}._flying"))
walls = inlined.walls if compiled is None else compiled.walls
pairs = inlined.pairs if compiled is None else compiled.pairs
