"""What has become of an engine's local errors at each event of the true run: carried along by the tangent map."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...tangent.growth import Displacements
from ...tangent.impacts import NoTangentMap, moving, rounds
from .together import push_together

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ....scenarios.trajectory import Contact, Trajectory
    from ...tangent.impacts import Impact
    from .local_error import LocalError


class GrownErrors:
    """Displacements that honest errors may have made by now, one for each local error so far.

    A column is what one local error has become; the sum of their lengths, the tolerance, is what all of them can be
    together, whatever their signs.

    Args:
        run: the true run.
        local: what one contact may cost.
        in_rounds: whether errors are carried through instants with several contacts of one circle: of an engine that
            takes the contacts of each in the rounds in which the run has them.

    Attributes:
        position, velocity: shape (circles, 2), where each is at the last event, and how it flies since its own last.
        since: the time of each circle's last event.
    """

    def __init__(self, run: Trajectory, local: LocalError, in_rounds: bool = False) -> None:
        scene = run.scene
        self.run, self.local, self.in_rounds = run, local, in_rounds
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
        self._rounds = _rounds(run)

    def come_to(self, index: int) -> None:
        """Adds what flying to an event and predicting it may cost; positions are those at the event from then on."""
        event = self.run.events[index]
        state, time = self.run.after(index).array(), float(event.time)
        self.position = state[:, :2]
        for contact in event.contacts:
            size = self.local.unit * self._size(contact, time)
            for k in self.movers(contact):
                self._add(k, np.array([[size, 0.0, 0.0, 0.0], [0.0, size, 0.0, 0.0]]))

    def go_through(self, index: int) -> None:
        """Carries all errors through an event, and adds what its impulses may cost.

        Raises:
            NoTangentMap: where errors are not carried through it.
        """
        if index >= len(self._rounds):
            raise NoTangentMap(f"event {index} has no tangent map", index)
        event, struck = self.run.events[index], self._rounds[index]
        after = self.run.after(index).array()[:, 2:]
        meeting = [math.hypot(float(hit.vx), float(hit.vy)) for together in struck for hit in together]
        speeds = np.maximum(np.hypot(*self.velocity.T), np.hypot(*after.T))
        speeds = np.maximum(speeds, max(meeting, default=0.0)) if self.in_rounds else speeds
        for together in struck:
            self._through(together, index)
            self._add_late(together, self.local.lateness)
            for k in [k for hit in together for k in (hit.a, hit.b) if k in self._row]:
                rounding = self.local.unit * float(speeds[k])
                self._add(k, np.array([[0.0, 0.0, rounding, 0.0], [0.0, 0.0, 0.0, rounding]]))
        for k in [k for contact in event.contacts for k in self.movers(contact)]:
            self.velocity[k], self.since[k] = after[k], float(event.time)

    def _through(self, struck: Sequence[Impact], index: int) -> None:
        """Carries all errors through a round; contacts that share a circle push together, some later than others."""
        taken = [k for hit in struck for k in (hit.a, hit.b) if k in self._row]
        if len(taken) == len(set(taken)):
            self._carried.through(struck)
            return
        self._carried.fly(float(struck[0].time))
        pushed = push_together(self._carried.columns, self._row, self.weights[list(self._row)], struck)
        if pushed is None:
            raise NoTangentMap(f"event {index}: the impulses of contacts that push together are not unique", index)
        self._carried.columns = pushed.columns
        spread = np.abs(pushed.waits[:, None] - pushed.waits[None]).sum(axis=2).max()
        self._add_late(struck, float(spread))

    def _add_late(self, struck: Sequence[Impact], late: float) -> None:
        """What contacts cost that come late: the way flown too far, and the line of centres turned by then."""
        if not late:
            return
        for hit in struck:
            reach, speed = float(hit.reach), np.array([float(hit.vx), float(hit.vy)])
            normal = np.array([float(hit.dx), float(hit.dy)]) / reach
            for k in (hit.a, hit.b):
                if k is None or k not in self._row:
                    continue
                share = 1.0 if hit.b is None else float(self.weights[k]) / float(hit.wa + hit.wb)
                found = [[*(2 * share * late * float(normal @ speed) * normal), 0.0, 0.0]]
                if hit.b is not None:
                    turned = 2 * share * late * float(speed @ speed) / reach
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


def _rounds(run: Trajectory) -> Sequence[Sequence[Sequence[Impact]]]:
    """The impacts of all events at the start that have a map to the next, by round."""
    try:
        return rounds(run, len(run.events))
    except NoTangentMap as none:
        return rounds(run, none.events)
