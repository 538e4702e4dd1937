"""What the rows of one lane say of one engine: from which k on it is wrong, and where it is not."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import groupby

from .family import MapPlace
from .rows.cell import StressRow
from .rows.marks import MapMark


@dataclass(frozen=True)
class Ladder:
    """The marks of one engine along one lane.

    Attributes:
        family, side, seed: the lane.
        engine: its label; `exact` for the exact engine, whose marks are those of its witness.
        levels: the k, ascending.
        marks: one for each.
    """

    family: str
    side: str
    seed: int
    engine: str
    levels: tuple[int, ...]
    marks: tuple[MapMark, ...]

    @property
    def lane(self) -> str:
        """As `MapPlace.lane`."""
        return MapPlace(self.family, self.levels[0], self.side, self.seed).lane

    @property
    def first_wrong(self) -> int | None:
        """The first k at which it is wrong; None if it is at none."""
        return next((k for k, mark in zip(self.levels, self.marks, strict=True) if mark is MapMark.WRONG), None)

    @property
    def right_again(self) -> tuple[int, ...]:
        """The k after the first wrong one at which it is right."""
        first = self.first_wrong
        told = zip(self.levels, self.marks, strict=True)
        return () if first is None else tuple(k for k, mark in told if k > first and mark is MapMark.RIGHT)

    @property
    def first_told(self) -> str:
        """The first wrong k, and where after it the engine is right; "none" if it is wrong at none.

        >>> R, W = MapMark.RIGHT, MapMark.WRONG
        >>> Ladder("walls", "opening", 0, "double", (1, 2, 3, 4, 5, 6), (R, W, R, R, W, R)).first_told
        '2, but right at 3 to 4, 6'
        """
        first = self.first_wrong
        if first is None:
            return "none"
        again = [_ends(low, high) for mark, low, high in self.stretches if mark is MapMark.RIGHT and low > first]
        return f"{first}, but right at {', '.join(again)}" if again else str(first)

    @property
    def signs(self) -> str:
        """One letter for each k."""
        return "".join(mark.sign for mark in self.marks)

    @property
    def stretches(self) -> tuple[tuple[MapMark, int, int], ...]:
        """Equal marks in a row: the mark, the first k and the last.

        >>> marks = (MapMark.RIGHT, MapMark.RIGHT, MapMark.WRONG)
        >>> ladder = Ladder("near-ties", "left", 0, "double", (1, 2, 3), marks)
        >>> [(mark.value, *ends) for mark, *ends in ladder.stretches]
        [('right', 1, 2), ('wrong', 3, 3)]
        """
        found: list[tuple[MapMark, int, int]] = []
        for mark, group in groupby(zip(self.marks, self.levels, strict=True), key=lambda pair: pair[0]):
            ks = [k for _, k in group]
            found.append((mark, ks[0], ks[-1]))
        return tuple(found)

    def told(self) -> str:
        """The whole ladder in words.

        >>> marks = (MapMark.RIGHT, MapMark.WRONG, MapMark.RIGHT, MapMark.WRONG, MapMark.WRONG)
        >>> Ladder("near-ties", "left", 0, "double", (1, 2, 3, 4, 5), marks).told()
        'right 1; wrong 2; right 3; wrong 4 to 5'
        """
        return "; ".join(f"{mark.value} {_ends(low, high)}" for mark, low, high in self.stretches)


def _ends(low: int, high: int) -> str:
    return str(low) if low == high else f"{low} to {high}"


def ladders(rows: Iterable[StressRow], engines: Sequence[str]) -> list[Ladder]:
    """The ladders of a map: lane by lane, the exact engine first."""
    found: list[Ladder] = []
    for (family, side, seed), group in groupby(rows, key=lambda row: (row["family"], row["side"], row["seed"])):
        lane = list(group)
        levels = tuple(row["k"] for row in lane)
        columns = {"exact": [row["exact"]["mark"] for row in lane]}
        columns |= {label: [row["engines"][label]["mark"] for row in lane] for label in engines}
        found += [
            Ladder(family, side, seed, label, levels, tuple(map(MapMark, marks))) for label, marks in columns.items()
        ]
    return found
