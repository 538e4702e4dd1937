"""What of the exact engine is compiled, where there was a compiler when truebreak was installed.

Each function here does in C what one of Python does in doubles: the same operations in the same order, so the same
bits; but `carry` sums in another order, within the same bound. The Python stays: it has the derivations, it runs where
there is no compiler, or one that alters sums, and tests hold the two against each other (tests/exact/compiled). It also
runs where the environment has `TRUEBREAK_PURE_PYTHON` set to anything.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from importlib import import_module
from os import environ
from typing import Any, Protocol, TypeAlias, cast

PURE = "TRUEBREAK_PURE_PYTHON"
"""The environment variable by which all runs in Python."""

Doubles: TypeAlias = tuple[float, ...]


class CompiledPredictions(Protocol):
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

    def faces(
        self, flight: Doubles, lines: Sequence[Any], flat: float, far: float, /
    ) -> tuple[list[tuple[float, float, int]], list[int]]:
        """`DoubleFilter.faces`, of a circle that has doubles."""
        ...

    def falls(
        self, flight: Doubles, lines: Sequence[Any], flat: float, far: float, stands: tuple[int, ...], /
    ) -> tuple[list[tuple[float, float, int]], list[int]]:
        """`falls_in_doubles`."""
        ...

    def falling_zero(
        self, c: Sequence[float], off: Sequence[float], end: float, /
    ) -> tuple[float, float] | float | None:
        """`falling_zero`: an interval; where it is unclear, what no zero comes before; None where there is none."""
        ...

    def onto_peg(self, flight: Doubles, peg: Any, until: float, stood: bool, /) -> tuple[float, float] | bool:
        """`peg_in_doubles`."""
        ...

    def onto_side(self, flight: Doubles, side: Any, until: float, stood: bool, /) -> tuple[float, float] | bool:
        """`side_in_doubles`."""
        ...

    def predict(
        self,
        moved: Sequence[Any],
        others: list[list[Any]],
        lines: list[Any],
        reaches: list[list[float]],
        pegs: list[Any],
        bounds: Doubles,
        slopes: tuple[float, float],
        standing: Any,
        heap: list[Any],
        order: int,
        first_face: int,
        /,
    ) -> int | None:
        """`FilteredPredictor.predict` of one or two circles, into the heap of an `ArrivalQueue`; walls from
        `first_face` on are faces.

        Gives the last order that it used; None, with nothing changed, where something is not told by doubles, or not
        ordinary.
        """
        ...

    def first(self, heap: list[Any], bodies: Mapping[int, Any], before: float, /) -> Any:
        """`ArrivalQueue.alone`, where nothing but plain arrivals has a part: the arrival; None where that is not so."""
        ...


class CompiledSteps(Protocol):
    """See steps.c; sets are `ErrorSet`, and what is told of a contact is `Carried`."""

    def bounce(
        self,
        errors: Any,
        i: int,
        j: int,
        met: tuple[Any, ...],
        since_i: Any,
        since_j: Any,
        strength: float,
        weights: tuple[float, float],
        late: Any,
        near: float,
        one: tuple[Any, ...],
        other: tuple[Any, ...],
        clock: Any,
        last: int,
        least: int,
        /,
    ) -> Any:
        """`carry_pair`, where the circles stand at i and j in the set; False where that raises `Spent`."""
        ...

    def rebound(
        self,
        errors: Any,
        i: int,
        since: Any,
        velocity: tuple[Any, Any],
        face: Any,
        late: Any,
        near: float,
        one: tuple[Any, ...],
        clock: Any,
        last: int,
        least: int,
        /,
    ) -> Any:
        """`carry_wall`, likewise."""
        ...

    def fall(
        self,
        errors: Any,
        i: int,
        since: Any,
        speed: float,
        slope: Any,
        late: Any,
        near: float,
        one: tuple[Any, ...],
        clock: Any,
        last: int,
        least: int,
        /,
    ) -> Any:
        """`carry_fall`, likewise."""
        ...

    def carry(self, rows: Any, pairs: list[int], hits: Any, blocks: Any, pending: list[Any], /) -> None:
        """`ErrorSet._carried`: rows of fours, in place, through a block's collisions and the flights after them."""
        ...

    def constants(self) -> dict[str, float]:
        """The numbers of the Python that are written in C again, by name."""
        ...


class CellLists(Protocol):
    """The circles of a run in cells: see `Cells`, which has what each does."""

    @property
    def next_crossing(self) -> float:
        """When the next slice of time with crossings begins; infinite if there is none."""
        ...

    @property
    def early(self) -> float:
        """How much before a slice begins its crossings may be carried out."""
        ...

    @property
    def loose(self) -> set[int]:
        """The circles that are compared with all others, for now."""
        ...

    def enter(self, i: int, flight: tuple[float, float, float, float, float], /) -> bool:
        """Takes up a circle's new flight."""
        ...

    def enter_loose(self, i: int, /) -> None:
        """Takes up a circle's new flight that doubles do not tell to a rounding."""
        ...

    def remove(self, i: int, /) -> None:
        """Drops a circle."""
        ...

    def around(self, i: int, /) -> list[int]:
        """The circles that one whose flight is new may meet before another crossing."""
        ...

    def walls(self, i: int, /) -> tuple[int, ...]:
        """The walls that a circle may touch before another crossing, and that its flight does not know yet."""
        ...

    def cross(self, since: float = ..., /) -> list[tuple[int, list[int], tuple[int, ...]]]:
        """Carries out the crossings of the next slice of time."""
        ...


class CompiledCells(Protocol):
    """See cells.c."""

    def Cells(
        self,
        grid: tuple[float, float, float, int, int],
        ends: tuple[list[float], list[float], list[float], list[float]],
        last: tuple[float, float],
        margin: float,
        sharp: float,
        count: int,
        large: Collection[int],
        walls: Any,
        /,
    ) -> CellLists:
        """Cells of a `Frame` for so many circles, some of them too large for cells, and walls: a `WallCells`."""
        ...

    def constants(self) -> dict[str, float]:
        """The numbers of the Python that are written in C again, by name."""
        ...


def loaded(module: str) -> object:
    """A compiled module, by its whole name; None where there is none, or Python is wished for."""
    if environ.get(PURE):
        return None
    try:
        return import_module(module)
    except (ImportError, RuntimeWarning):  # a warning, made an error, where Python runs without its lock
        return None


predictions = cast("CompiledPredictions | None", loaded(f"{__name__}._predictions"))
steps = cast("CompiledSteps | None", loaded(f"{__name__}._steps"))
cells = cast("CompiledCells | None", loaded(f"{__name__}._cells"))
"""None where Python runs, as `predictions` and `steps`."""
