"""What a recording has taken down: events, and the flights between them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from ....floating.knots import DoubleKnot
from ....scenarios.numbers.precision import Double
from ....scenarios.trajectory import Contact, Event, Tie, TieProof
from ...validation import EngineError

if TYPE_CHECKING:
    from ....scenarios.scene import Scene
    from .impulses import Impacts, Indices, Row

MOST_EVENTS = 1_000_000
"""Events of one recording: a few hundred megabytes."""


class Course:
    """The events of a run so far, and where every circle is.

    Args:
        scene: what is run.
        impacts: its laws.
        rows: x, y, vx, vy of every circle at the start.

    Attributes:
        times: of the events.
        knots: for each circle, from when on it flies straight, from where and how fast.
        left: for each event its time, and how many knots each circle has once it is over.
        reckoned: the events that came without states.
    """

    def __init__(self, scene: Scene, impacts: Impacts, rows: Sequence[Row]) -> None:
        self.scene, self._impacts = scene, impacts
        self.times: list[float] = []
        self.knots: list[list[DoubleKnot]] = [[(0.0, *row)] for row in rows]
        self.left: list[tuple[float, tuple[int, ...]]] = []
        self.reckoned: set[int] = set()
        self._links: list[list[Indices]] = []
        self._coupled: list[bool] = []

    def __len__(self) -> int:
        return len(self.times)

    def event(self, index: int) -> Event:
        """One of the events."""
        ids, links = self.scene.ids, self._links[index]
        impulses = tuple(Contact(ids[i], ids[j]) for i, j in links)
        contacts = tuple(Contact(ids[i], ids[j]) for i, j in sorted(set(links)))
        ties = (Tie(contacts, TieProof.FLOAT),) if len(contacts) > 1 else ()
        return Event(index, Double(self.times[index]), contacts, impulses, ties, self._coupled[index])

    def add(self, where: str, now: float, links: Sequence[Indices], rows: Sequence[Row], together: bool) -> None:
        """Notes an event, of which `leave` is to tell how it leaves the circles.

        Args:
            where: what an error begins with.
            rows: where the circles are.
            together: whether what comes at one time is one.

        Raises:
            EngineError: if there are too many.
        """
        if together and self.times and self.times[-1] == now:
            links = [*self._links[-1], *links]
            for told in (self.times, self._links, self._coupled):
                told.pop()
        if len(self.times) >= MOST_EVENTS:
            raise EngineError(f"{where}: more than {MOST_EVENTS:,} events; end the run before that")
        self.times.append(now)
        self._links.append(list(links))
        self._coupled.append(len(set(links)) > 1 and self._impacts.coupled(sorted(set(links)), rows))

    def fly(self, now: float, rows: Mapping[int, Row]) -> None:
        """Circles fly on from a time as told."""
        for k, row in rows.items():
            if self._impacts.moves(k):
                self.knots[k].append((now, *row))

    def leave(self, now: float) -> None:
        """The last event, if it is of this time, is over."""
        if self.times and self.times[-1] == now:
            self.left[len(self.times) - 1 :] = [(now, tuple(map(len, self.knots)))]

    def rows(self, now: float) -> list[Row]:
        """Where every circle is by its last flight."""
        last = (row[-1] for row in self.knots)
        return [(x + vx * (now - t), y + vy * (now - t), vx, vy) for t, x, y, vx, vy in last]
