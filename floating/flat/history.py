"""The history of a flat run: a contact alone is noted in one stroke, and told in the general loop's terms when read."""

from __future__ import annotations

from typing import TypeAlias, cast

from ...exact.simulation.history import History, Mark, Noted, Record
from .flights import FlatFlight, FlatFlights

Lone: TypeAlias = tuple[float, FlatFlight, FlatFlight | None, int]
"""A contact that stood alone at its instant: the time, the flights of the two from then on (of a wall there is none),
and the place of the second."""


class FlatHistory(History[float]):
    """See `History`. A lone contact is one item, so that an interruption leaves it out or lets it in, whole.

    Args:
        flights: of the run.
    """

    def __init__(self, flights: FlatFlights) -> None:
        self._flights = flights
        self._mark: Mark[float] | None = None
        self._marked = 0
        self._rows_of = 0
        super().__init__()

    @property
    def items(self) -> list[Record[float] | Lone]:
        """The records as they are in a flat run: contacts alone are not unfolded yet."""
        return cast("list[Record[float] | Lone]", self.records)

    @property
    def last(self) -> Mark[float] | None:
        """See `History`."""
        return self._newest(self.items[self._marked :]) or self._mark

    @last.setter
    def last(self, mark: Mark[float] | None) -> None:
        self._mark = mark
        self._marked = len(self.records)

    def _newest(self, items: list[Record[float] | Lone]) -> Mark[float] | None:
        """The mark of the last of some records, if it is a lone contact."""
        return self._mark_of(items[-1]) if items and not isinstance(items[-1], Record) else None

    def add(self, note: Noted[float]) -> None:
        """See `History`."""
        self._add_rows()
        super().add(note)

    def drop_unfinished(self) -> None:
        """See `History`; a lone contact is whole."""
        number = -1 if self._mark is None else self._mark.number
        since = self.items[self._marked :]
        newest = self._newest([one for one in since if not isinstance(one, Record) or one.mark.number <= number])
        self.unfold()
        super().drop_unfinished()
        self._mark, self._marked = newest or self._mark, len(self.records)

    def unfold(self) -> None:
        """Puts every lone contact into the general loop's terms."""
        self._add_rows()
        for place, one in enumerate(self.items):
            if not isinstance(one, Record):
                links = (self._flights.link(one[1][-1], one[3]),)
                self.records[place] = Record(self._mark_of(one), links, links, (), False)

    def _add_rows(self) -> None:
        """The knots of lone contacts that are not among the rows yet."""
        for one in self.items[self._rows_of :]:
            if not isinstance(one, Record):
                for flight in one[1:3]:
                    if flight is not None:
                        x, y, vx, vy, t, _, i = flight
                        self.knots[i].append((t, x, y, vx, vy, 0, -1))
        self._rows_of = len(self.records)

    def _mark_of(self, lone: Lone) -> Mark[float]:
        number = -1 if self._mark is None else self._mark.number
        return Mark(number, lone[0], len(self.steps), lone[1][-1])
