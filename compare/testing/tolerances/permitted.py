"""What the laws permit at any instant, wherever a history has got to: things that touch push each other apart."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...foreign.runs.impulses import SOLVED, Impacts, least

if TYPE_CHECKING:
    from ....scenarios.event import Contact, Event
    from ....scenarios.scene import Scene
    from ...foreign.runs.impulses import Indices, Normal, Row
    from .local_error import LocalError

TURNS = 4.0
"""A line of centres is taken at the end of a step; the push may have been along that of another time within the step,
before or after which both circles fly on."""


class Room(NamedTuple):
    """How far off a place may be.

    Attributes:
        rounding: by the numbers that an engine counts in.
        late: by contacts that are found late.
    """

    rounding: float
    late: float


class PermittedImpulses:
    """Holds instants of a run against what every order of impulses has in common.

    However many contacts an instant has, and in whichever order they are resolved: each is between things that touch,
    and pushes them apart along their line of centres. So what an instant does to all velocities is a sum of such
    pushes, none of which pulls. With energy kept, that is the elastic impact of a single contact; of several, it is
    the most that can be said of all orders at once.

    Args:
        local: what one contact may cost.
    """

    def __init__(self, scene: Scene, local: LocalError) -> None:
        self.scene, self.local = scene, local
        self.impacts = Impacts(scene)
        self.places = {name: k for k, name in enumerate(scene.ids)}
        self.radii = np.array([float(c.r) for c in scene.circles])

    def broken(
        self, events: Sequence[Event], before: NDArray[np.float64], after: NDArray[np.float64], room: Room, share: float
    ) -> str | None:
        """What the events of one instant do that no order of impulses does, in words; None if they are permitted.

        Args:
            before: shape (circles, 2), the velocities that they found.
            after: shape (circles, 4), places and velocities that they left.
            room: how far off a place may be.
            share: of a velocity, by which it may be off.
        """
        links = sorted({self._link(pair) for event in events for pair in (*event.contacts, *event.impulses)})
        rows: list[Row] = [(row[0], row[1], row[2], row[3]) for row in after.tolist()]
        lines = [(link, self.impacts.normal(link, rows)) for link in links]
        for link, line in lines:
            most = room.rounding * self._far(link, rows) + room.late
            if line.gap > most:
                return f"{self._names(link)} meet while they are {line.gap:.3g} apart; {most:.3g} may be"
        left, size, pushes = self._left(lines, after[:, 2:] - before, before)
        turned = np.array([self._turned(link, before, rows, room.rounding) for link in links])
        taken = [k for link in links for k in link if self.impacts.moves(k)]
        if len(taken) > len(set(taken)):  # pushes that cancel each other do not show
            pushes = np.full(len(links), 2 * size * sum(len(event.impulses) for event in events))
        may = (share + SOLVED) * size + float(turned @ pushes)
        if left > may and size:
            told = "; ".join(self._names(link) for link in links)
            return (
                f"what the meeting of {told} does to velocities is no push apart along lines of centres: "
                f"{left / size:.3g} of them is something else, {may / size:.3g} may be"
            )
        return None

    def _left(
        self, lines: Sequence[tuple[Indices, Normal]], change: NDArray[np.float64], before: NDArray[np.float64]
    ) -> tuple[float, float, NDArray[np.float64]]:
        """What no pushes explain of a change, how fast things are, and the pushes; in velocity by root of mass."""
        weights = self.impacts.weights
        roots = np.divide(1.0, np.sqrt(weights), out=np.zeros_like(weights), where=weights > 0)
        wanted = (change * roots[:, None]).reshape(-1)
        size = float(np.linalg.norm(before * roots[:, None]))
        matrix = self.impacts.matrix(lines)
        strengths = least(matrix @ matrix.T, matrix @ wanted)
        left = float(np.linalg.norm(wanted - matrix.T @ strengths))
        return left, size, np.linalg.norm(matrix, axis=1) * strengths

    def _turned(self, link: Indices, before: NDArray[np.float64], rows: Sequence[Row], off: float) -> float:
        """By how much the line of centres may be another."""
        i, j = link
        if j >= self.impacts.count:
            return 0.0
        reach = float(self.radii[i] + self.radii[j])
        speeds = [float(np.hypot(*(before[j] - before[i]))), float(np.hypot(*np.subtract(rows[j][2:], rows[i][2:])))]
        return (off + TURNS * max(speeds) * self.local.lateness) / reach if reach else 1.0

    def _far(self, link: Indices, rows: Sequence[Row]) -> float:
        """How much more the gap of two circles is off where they are small beside their coordinates."""
        i, j = link
        if j >= self.impacts.count or not self.radii[i] + self.radii[j]:
            return 1.0
        return 1.0 + max(abs(x) for x in rows[i][:2] + rows[j][:2]) / float(self.radii[i] + self.radii[j])

    def askew(self, pair: Contact, room: Room) -> float:
        """The share of all energy that a push of two circles may gain or lose, as their places are off by rounding.

        With d for the line of centres, taken to be R long, a push is as (d.v) d / R**2: where d is longer by e, energy
        is off by 4 e/R of the mass that they move, times their speed squared; that is 8 e/R of their energy at most.
        """
        i, j = self._link(pair)
        reach = 0.0 if j >= self.impacts.count else float(self.radii[i] + self.radii[j])
        return 8 * room.rounding / reach if reach else 0.0

    def _link(self, pair: Contact) -> Indices:
        i, j = (self.places[name] for name in pair)
        return (i, j) if i < j else (j, i)

    def _names(self, link: Indices) -> str:
        ids = self.scene.ids
        return f"{ids[link[0]]} and {ids[link[1]]}"
