"""The history of a long run in little memory: short balls packed by the block, and given back bit for bit.

An object for each ball takes twice the memory of the ball itself, and the tuples that hold them as much again. What
cannot be packed, such as exact numbers, stays as it is.
"""

from __future__ import annotations

from abc import abstractmethod
from array import array
from bisect import bisect_left
from collections.abc import Callable, Iterable, Iterator
from typing import Any, ClassVar, Generic, TypeVar, cast, overload

from flint import arb, arb_mat

from ..numbers.ball import Known
from ..replay.contact import Touch
from .decider import KeptRows, Knot, Mark, Record

R = TypeVar("R")


class PackedRows(KeptRows[R], Generic[R]):
    """Rows that are only ever added to and dropped at the end; all but the last few are packed.

    Args:
        rows: those that are there from the start on.
    """

    __slots__ = ("_blocks", "_tail")

    block: ClassVar[int]
    """Rows that are packed together."""

    short: ClassVar[int]
    """Rows from which on they are packed at all: less is not worth the time."""

    def __init__(self, rows: Iterable[R] = ()) -> None:
        self._blocks: list[Any] = []
        self._tail: list[R] = []
        self += rows

    def __reduce__(self) -> tuple[Callable[..., PackedRows[R]], tuple[list[R]]]:
        return type(self), (list(self),)

    @abstractmethod
    def _packed(self, rows: list[R]) -> Any:
        """A block of them; the rows themselves where they cannot be packed."""

    @abstractmethod
    def _row(self, block: Any, k: int) -> R:
        """One of a block that is packed."""

    @abstractmethod
    def _rows(self, block: Any) -> Iterable[R]:
        """All of one that is packed."""

    def append(self, row: R) -> None:
        """One more."""
        self._tail.append(row)
        if len(self._tail) >= (self.block if self._blocks else self.short):
            for _ in range(len(self._tail) // self.block):
                self._blocks.append(self._packed(self._tail[: self.block]))
                del self._tail[: self.block]

    def pop(self) -> R:
        """Takes the last away."""
        if not self._tail:
            self._tail = [*self._of(self._blocks.pop())]
        return self._tail.pop()

    def __iadd__(self, rows: Iterable[R]) -> PackedRows[R]:
        for row in rows:
            self.append(row)
        return self

    def __len__(self) -> int:
        return self.block * len(self._blocks) + len(self._tail)

    @overload
    def __getitem__(self, k: int) -> R: ...

    @overload
    def __getitem__(self, k: slice) -> list[R]: ...

    def __getitem__(self, k: int | slice) -> R | list[R]:
        if isinstance(k, slice):
            return [self[place] for place in range(*k.indices(len(self)))]
        place = k + len(self) if k < 0 else k
        if not 0 <= place < len(self):
            raise IndexError(k)
        number, within = divmod(place, self.block)
        if number >= len(self._blocks):
            return self._tail[place - self.block * len(self._blocks)]
        found = self._blocks[number]
        return found[within] if isinstance(found, list) else self._row(found, within)

    def __iter__(self) -> Iterator[R]:
        for block in self._blocks:
            yield from self._of(block)
        yield from self._tail

    def _of(self, block: Any) -> Iterable[R]:
        return block if isinstance(block, list) else self._rows(block)


class PackedKnots(PackedRows[Knot[Known]]):
    """The knots of a circle.

    >>> rows = [(arb(k), arb(1), arb(2), arb(3), arb(4), 2 * k, k) for k in range(3000)]
    >>> knots = PackedKnots(rows)
    >>> len(knots), knots[70][0] == 70, knots[-1][5:], [*knots][150][5:]
    (3000, True, (5998, 2999), (300, 150))
    """

    __slots__ = ()
    block, short = 256, 2048

    def _packed(self, rows: list[Knot[Known]]) -> Any:
        values: list[Any] = [value for row in rows for value in row[:5]]
        if any(type(value) is not arb for value in values):
            return rows
        return arb_mat(len(rows), 5, values), array("q", [row[5] for row in rows]), array("q", [r[6] for r in rows])

    def _row(self, block: Any, k: int) -> Knot[Known]:
        balls, steps, instants = block
        return balls[k, 0], balls[k, 1], balls[k, 2], balls[k, 3], balls[k, 4], steps[k], instants[k]

    def _rows(self, block: Any) -> Iterable[Knot[Known]]:
        balls, steps, instants = block
        values = balls.entries()
        return (cast("Knot[Known]", (*values[5 * k : 5 * k + 5], steps[k], instants[k])) for k in range(len(steps)))


class PackedRecords(PackedRows[Record[Known]]):
    """The events of a run; those of one contact, which proves no tie, are packed.

    >>> from ..replay.contact import Pair
    >>> rows = [Record(Mark(2 * k, arb(k), 3 * k, 0), (Pair(0, 1),), (Pair(0, 1),), (), False) for k in range(9000)]
    >>> records = PackedRecords(rows)
    >>> records[70].mark.number, records[70].links, records[8999].mark.step
    (140, (Pair(a=0, b=1),), 26997)
    >>> float(records.time_at(140)), records.time_at(141).is_finite()
    (70.0, False)
    """

    __slots__ = ()
    block, short = 1024, 8192

    def _packed(self, rows: list[Record[Known]]) -> Any:
        if not all(map(_is_plain, rows)):
            return rows
        marks = [row.mark for row in rows]
        numbers = array("q", [each for mark in marks for each in (mark.number, mark.step, cast("int", mark.source))])
        times: list[Any] = [mark.time for mark in marks]
        links: list[tuple[Touch, ...]] = [row.links for row in rows]
        return links, arb_mat(len(marks), 1, times), numbers

    def time_at(self, instant: int) -> Known:
        """The time of an instant, by its number; a ball that says nothing, where no event falls on it."""
        k = bisect_left(self, instant, key=lambda record: record.mark.number)
        found = self[k].mark if k < len(self) else None
        return arb.nan() if found is None or found.number != instant else found.time

    def _row(self, block: Any, k: int) -> Record[Known]:
        links, times, numbers = block
        number, step, source = numbers[3 * k : 3 * k + 3]
        return Record(Mark(number, times[k, 0], step, source), links[k], links[k], (), False)

    def _rows(self, block: Any) -> Iterable[Record[Known]]:
        return (self._row(block, k) for k in range(len(block[0])))


def _is_plain(row: Record[Known]) -> bool:
    mark = row.mark
    plain = row.impulses is row.links or row.impulses == row.links
    return plain and not row.ties and not row.coupled and type(mark.time) is arb and type(mark.source) is int
