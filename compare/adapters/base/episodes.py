"""Collisions that take several steps, told as events: what presses together is one, at the step at which it began."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from .stepped import OutOfRoom, Teller, glided

if TYPE_CHECKING:
    from ....scenarios.scene import Scene
    from ...foreign.runs.impulses import Row
    from ...foreign.runs.recording import Recording

LASTING = 64
"""Contacts of two in a row, by time, after which things that still press on each other are not taken for colliding."""


@dataclass
class Episode:
    """Things that press on each other, directly or through others.

    Attributes:
        start: the time of the step in which the first pressed.
        pairs: who pressed on whom, in the order in which they began; who parts and meets again is there twice.
        members: the circles among them that move.
        rows: of the members, as the episode left them at its `end`; None while it lasts.
    """

    start: float
    pairs: list[tuple[str, str]]
    members: set[str]
    end: float = 0.0
    rows: dict[str, Row] | None = None


class Episodes(Teller):
    """Gathers the steps of each collision.

    The event's time is that of the first step in which something pressed, and the states that it leaves are those of
    the flights on which circles leave, followed back to that time. An event at which the scene reverses is told at its
    end instead: the engine goes back from there.

    Args:
        longest: how long an episode may last.
    """

    def __init__(self, scene: Scene, recording: Recording, longest: float) -> None:
        super().__init__(scene, recording)
        self._moving = {str(circle.id) for circle in scene.circles if not circle.fixed}
        self._longest = longest
        self._pressing: set[tuple[str, str]] = set()
        self._open: list[Episode] = []
        self._last, self._events = 0.0, 0

    @property
    def waiting(self) -> bool:
        """Whether an episode is not told yet."""
        return bool(self._open)

    def contacts(self, now: float, pairs: Sequence[tuple[str, str]], rows: Sequence[Row]) -> None:
        """A step at whose end these pairs press on each other.

        Raises:
            OutOfRoom: where an episode lasts too long to be a collision.
        """
        for pair in pairs:
            if pair not in self._pressing:
                self._begin(now, pair)
        self._pressing = set(pairs)
        states = dict(zip(self.circles, rows, strict=True))
        for episode in self._open:
            if episode.rows is None and not self._pressing.intersection(episode.pairs):
                episode.end = now
                episode.rows = {name: states[name] for name in episode.members}
            elif episode.rows is None and now - episode.start > self._longest:
                first, second = next(pair for pair in episode.pairs if pair in self._pressing)
                raise OutOfRoom(f"{first!r} and {second!r} press on each other for longer than a collision takes")
        while self._open and self._open[0].rows is not None:
            self._tell(self._open.pop(0))

    def at_rest(self, now: float, rows: Sequence[Row]) -> None:
        """A time at which nothing touches; while something does, nothing is told of it."""
        if not self._open:
            self._last = now
            super().at_rest(now, rows)

    def _begin(self, now: float, pair: tuple[str, str]) -> None:
        """A pair begins to press: on its own, or with those that it touches."""
        joined = Episode(now, [], self._moving.intersection(pair))
        apart: list[Episode] = []
        for episode in self._open:
            if episode.rows is None and joined.members & episode.members:
                joined = Episode(
                    min(joined.start, episode.start), joined.pairs + episode.pairs, joined.members | episode.members
                )
            else:
                apart.append(episode)
        joined.pairs.append(pair)
        self._open = sorted([*apart, joined], key=lambda episode: episode.start)

    def _tell(self, episode: Episode) -> None:
        assert episode.rows is not None
        recording, time = self.recording, max(episode.start, self._last)
        if recording.reversal is None and self.scene.reverse_after == self._events + (time > self._last):
            time = max(episode.end, self._last)
        rows = {name: glided([row], time - episode.end)[0] for name, row in episode.rows.items()}
        self._events += time > self._last
        self._last = time
        recording.hits(time, episode.pairs, rows)
