"""What has become of an engine's local errors at each event of the true run: carried along by the tangent map."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...tangent.growth import Displacements
from ...tangent.impacts import Impact, NoTangentMap, impacts, moving

if TYPE_CHECKING:
    from ....scenarios.event import Contact
    from ....scenarios.trajectory import Trajectory
    from .local_error import LocalError


class GrownErrors:
    """Displacements that honest errors may have made by now, one for each local error so far.

    A column is what one local error has become; the sum of their lengths, the tolerance, is what all of them can be
    together, whatever their signs.

    Args:
        run: the true run.
        local: what one contact may cost.

    Attributes:
        position, velocity: shape (circles, 2), where each is at the last event, and how it flies since its own last.
        since: the time of each circle's last event.
    """

    def __init__(self, run: Trajectory, local: LocalError) -> None:
        scene = run.scene
        self.run, self.local = run, local
        self.places = {name: k for k, name in enumerate(scene.ids)}
        self.count = len(scene.circles)
        start = np.array([[float(c.x), float(c.y), float(c.vx), float(c.vy)] for c in scene.circles])
        self.position, self.velocity = start[:, :2].copy(), start[:, 2:].copy()
        self.radii = np.array([float(c.r) for c in scene.circles])
        self.weights = np.array([float(c.inverse_mass) for c in scene.circles])
        self.since = np.zeros(self.count)
        self.walls = [tuple(float(v) for v in (w.x0, w.y0, w.x1, w.y1)) for w in scene.walls]
        sizes = local.input_unit * np.abs(start)
        self._row = {k: row for row, k in enumerate(moving(scene))}
        movable = sizes[list(self._row)].reshape(-1)
        self._carried = Displacements(scene, np.diag(movable).reshape(len(self._row), 4, -1))
        self._impacts = _impacts(run)

    def come_to(self, index: int) -> None:
        """Adds what flying to an event and predicting it may cost; positions are those at the event from then on."""
        event = self.run.events[index]
        state, time = self.run.at(event.time).array(), float(event.time)
        self.position = state[:, :2]
        for contact in event.contacts:
            size = self.local.unit * self._size(contact, time)
            for k in self.movers(contact):
                self._add(k, np.array([[size, 0.0, 0.0, 0.0], [0.0, size, 0.0, 0.0]]))

    def go_through(self, index: int) -> None:
        """Carries all errors through an event, and adds what its impulses may cost.

        Raises:
            ValueError: where a circle has several contacts at one instant: there is no tangent map.
        """
        event = self.run.events[index]
        before = self.velocity.copy()
        if index >= len(self._impacts):
            raise ValueError(f"event {index} has no tangent map")
        self._carried.through(self._impacts[index])
        after = self.run.at(event.time).array()[:, 2:]
        for contact in event.contacts:
            movers = self.movers(contact)
            fastest = max(float(np.linalg.norm(v[k])) for v in (before, after) for k in movers)
            for k in movers:
                rounding = self.local.unit * fastest
                self._add(k, np.array([[0.0, 0.0, rounding, 0.0], [0.0, 0.0, 0.0, rounding]]))
                self._add_late(k, contact, before, after)
                self.velocity[k], self.since[k] = after[k], float(event.time)

    def _add_late(self, k: int, contact: Contact, before: NDArray[np.float64], after: NDArray[np.float64]) -> None:
        """What a contact costs that comes late: the way flown too far, and the line of centres turned by then."""
        late = self.local.lateness
        if not late:
            return
        kick = after[k] - before[k]
        found = [[*(late * kick), 0.0, 0.0]]
        i, j = self.places[contact.first], self.places[contact.second]
        if j < self.count:
            speed = float(np.linalg.norm(before[j] - before[i]))
            reach, share = self.radii[i] + self.radii[j], self.weights[k] / (self.weights[i] + self.weights[j])
            turned = 2 * share * late * speed * speed / reach if reach else math.inf
            found += [[0.0, 0.0, turned, 0.0], [0.0, 0.0, 0.0, turned]]
        self._add(k, np.array(found))

    def _add(self, k: int, rows: NDArray[np.float64]) -> None:
        added = np.zeros((len(self._row), 4, len(rows)))
        added[self._row[k]] = rows.T
        self._carried.columns = np.concatenate([self._carried.columns, added], axis=2)

    def _size(self, contact: Contact, time: float) -> float:
        """The largest number that enters a contact: coordinates at both ends of the flights, radii, the way so far."""
        found = [0.0]
        for k in [self.places[name] for name in contact if self.places[name] < self.count]:
            speed = float(np.linalg.norm(self.velocity[k]))
            way = speed * (time - float(self.since[k]))
            found += [float(np.abs(self.position[k]).max()) + way, float(self.radii[k]), speed * time]
        if self.places[contact.second] >= self.count:
            found += map(abs, self.walls[self.places[contact.second] - self.count])
        return sum(sorted(found)[-2:])

    def movers(self, contact: Contact) -> list[int]:
        """The places of the circles of a contact that can move."""
        return [k for name in contact if (k := self.places[name]) < self.count and self.weights[k] > 0]

    def at(self, time: float) -> NDArray[np.float64]:
        """Shape (circles, 4, errors): what each local error has become at a time of the flights under way."""
        columns = self._carried.columns
        found = np.zeros((self.count, *columns.shape[1:]))
        found[list(self._row)] = columns
        found[:, :2] += (time - float(self._carried.time)) * found[:, 2:]
        return found

    def tolerance(self, place: int, time: float) -> tuple[float, float]:
        """How far off in position and in velocity a circle may be: the lengths of all its errors together."""
        columns = self.at(time)[place]
        return float(np.hypot(*columns[:2]).sum()), float(np.hypot(*columns[2:]).sum())


def _impacts(run: Trajectory) -> list[list[Impact]]:
    """The impacts of all events at the start that have a tangent map."""
    try:
        return impacts(run, len(run.events))
    except NoTangentMap as none:
        return impacts(run, none.events) if none.events else []
