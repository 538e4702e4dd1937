"""What one contact may cost an honest engine, and what that has grown to at each event of the true run."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...scenarios.errors import SceneError
from ..foreign.guard import run_guarded
from ..study import finer_by, series_steps
from ..tangent.growth import Displacements
from ..tangent.impacts import NoTangentMap, moving, rounds

if TYPE_CHECKING:
    from ...scenarios.engine import Engine
    from ...scenarios.trajectory import Contact, Trajectory
    from ..tangent.impacts import Impact

ROUNDINGS = 64
"""k: roundings of one contact. To predict it, fly to it and bounce takes 57 operations of two circles in the plain
formulas, 25 of a circle and a wall, each off by half a unit in the last place (`test_tolerance.py` counts them);
engines write them in other ways, with a few more."""

HALVINGS = (0, 1, 2, 3)
"""How often a time step is halved to see with which order an engine's lateness falls."""

FALLING = 0.5
"""The slope of lateness over the step below which it does not fall, if at the finest step it is still longer than the
coarsest: a first order has slope 1, and rounding, which does not fall, is shorter."""

UNSEEN = 4.0
"""Steps of lateness that are granted at most where the step cannot be halved: an engine that finds an overlap at the
end of one step, and pushes in the next, is late by two, and twice what is seen is granted."""

FIRST_EVENTS = 24
"""Events of the true run among which each circle's first meeting is looked for: before it, nothing has grown."""


@dataclass(frozen=True)
class LocalError:
    """What one contact may cost.

    Attributes:
        unit: 2**-p for numbers of p bits, times `ROUNDINGS`: a share of the largest number that enters. 0: exact.
        input_unit: 2**-p where the scene is rounded, else 0.
        lateness: c * h**q, by how much time an engine of step h may be late to a contact; 0 without a step.
        order: q; None without a step.
    """

    unit: float
    input_unit: float
    lateness: float = 0.0
    order: float | None = None

    @property
    def told(self) -> str:
        """In words."""
        if self.order is None:
            return f"{self.unit:.3g} of the largest number at each contact"
        late = f"up to {self.lateness:.3g} late, of order {self.order:g} in the step"
        return f"{self.unit:.3g} of the largest number at each contact, which comes {late}"


def local_error(engine: Engine, reference: Trajectory, bits: int | None) -> LocalError:
    """The local error of an engine with so many bits.

    An engine with a time step is run on the first events with its step halved again and again. Each circle's first
    meeting is then compared with the true one, when nothing has grown yet: how far off it is after that, divided by
    the change of its velocity, is how late the push was; or, if that is more, how late the meeting is told, as by an
    engine that finds it at the end of one step and tells it at that of the next. q is the slope of the latest over
    the step, rounded to whole numbers from 1; c is twice the largest lateness / h**q, and at least 1 for q = 1, since
    a contact that is found at the end of a step may be late by a whole one. Lateness that does not fall as h is halved
    is no matter of the step: then, and where nothing is seen, q = 1 and c = 1. Where no step can be halved, q = 1 and
    c is at most `UNSEEN`.
    """
    unit = 0.0 if bits is None else 2.0**-bits
    rounding = LocalError(ROUNDINGS * unit, unit if engine.rounds_input else 0.0)
    if engine.step is None:
        return rounding
    seen = [(e.step, late) for e, late in _series(engine, reference) if e.step is not None and late > 0]
    order = 1.0
    if len(seen) > 1:
        (first, one), (last, other) = seen[0], seen[-1]
        slope = math.log(one / other) / math.log(first / last)
        if slope < FALLING and other > first:
            seen = []
        order = max(1.0, float(round(slope)))
    factor = max((2 * late / step**order for step, late in seen), default=0.0)
    if len(seen) == 1:
        factor = min(factor, UNSEEN)
    factor = max(factor, 1.0) if order == 1.0 else factor
    late = factor * engine.step**order
    return LocalError(rounding.unit, rounding.input_unit, late, order)


def _series(engine: Engine, reference: Trajectory) -> list[tuple[Engine, float]]:
    """An engine at finer and finer steps, each with its largest lateness at a circle's first meeting."""
    found: list[tuple[Engine, float]] = []
    events = reference.events[:FIRST_EVENTS]
    if not events:
        return found
    for halvings in HALVINGS:
        finer = finer_by(engine, halvings)
        if finer is None or finer.step is None:
            break
        until = float(events[-1].time) + 4 * (engine.step or 0.0)
        if until > series_steps(finer) * finer.step:
            break
        try:
            run = run_guarded(finer, reference.scene, until=until, events=4 * len(events) + 64)
        except SceneError:
            break
        late = [value for name in _alone(reference) if (value := _late(reference, run, name)) is not None]
        if late:
            found.append((finer, max(late)))
    return found


def _alone(reference: Trajectory) -> list[str]:
    """Circles whose first meeting is among the first events, and with one other thing, which has met nothing before."""
    met: set[str] = set()
    circles = {str(c.id) for c in reference.scene.circles if not c.fixed}
    found: list[str] = []
    for event in reference.events[:FIRST_EVENTS]:
        for pair in event.impulses:
            movers = [name for name in pair if name in circles]
            if len(event.impulses) == 1 and not met & set(movers):
                found += movers
            met.update(movers)
    return found


def _late(reference: Trajectory, run: Trajectory, name: str) -> float | None:
    """How late a circle's first meeting is; None if it is another, or changes nothing."""
    mine = next(e for e in reference.events if any(name in pair for pair in e.impulses))
    theirs = next((e for e in run.events if any(name in pair for pair in e.impulses)), None)
    if theirs is None or set(theirs.contacts) != set(mine.contacts):
        return None
    start = next(c for c in reference.scene.circles if c.id == name)
    after, got = reference.after(mine.index)[name], run.after(theirs.index)[name]
    kick = math.hypot(float(after.vx) - float(start.vx), float(after.vy) - float(start.vy))
    lag = float(theirs.time) - float(mine.time)
    off = math.hypot(
        float(got.x) - float(after.x) - lag * float(after.vx), float(got.y) - float(after.y) - lag * float(after.vy)
    )
    return max(off / kick, abs(lag)) if kick else None


# ----------------------------------------
# What contacts of one circle that push together do to displacements: the derivative of one round of impulses.


@dataclass(frozen=True)
class Pushed:
    """A round of impulses upon displaced circles.

    Attributes:
        columns: shape (circles, 4, k), the displacements after it.
        waits: shape (contacts, k): by how much each displacement delays each contact.
    """

    columns: NDArray[np.float64]
    waits: NDArray[np.float64]


def push_together(
    columns: NDArray[np.float64], row: Mapping[int, int], weights: NDArray[np.float64], struck: Sequence[Impact]
) -> Pushed | None:
    """Displacements after a round in which contacts push together, each at its own displaced time.

    With J v for the speeds at which the contacts open, and W for the inverse masses, the round adds W J' s to the
    velocities, where J W J' s = -2 J v. Its derivative, to the first order: J turns with the lines of centres, as
    they are when each contact comes, and v changes with its displacement; a contact that comes later by tau leaves
    what it pushes tau times the change of velocity behind. One contact alone gives `pair_tangent`.

    Args:
        columns: shape (circles, 4, k), displacements at the instant, of the circles that can move.
        row: the row of each of those circles, by index.
        weights: inverse masses, by row.
        struck: the contacts, all with the velocities that the round finds.

    Returns:
        None where the impulses are not unique: then they have no derivative.
    """
    count, errors = len(weights), columns.shape[2]
    lines, turned = np.zeros((len(struck), count, 2)), np.zeros((len(struck), 2, errors))
    opening, waits = np.zeros(len(struck)), np.zeros((len(struck), errors))
    for k, hit in enumerate(struck):
        a, b, reach = row.get(hit.a), None if hit.b is None else row.get(hit.b), float(hit.reach)
        normal, speed = np.array([float(hit.dx), float(hit.dy)]) / reach, np.array([float(hit.vx), float(hit.vy)])
        between = np.zeros((2, errors))
        for place, side in ((a, 1.0 if hit.b is None else -1.0), (b, 1.0)):
            if place is not None:
                lines[k, place] += side * normal
                between += side * columns[place, :2]
        opening[k] = normal @ speed
        waits[k] = -(normal @ between) / opening[k]
        if hit.b is not None:
            turned[k] = (between + speed[:, None] * waits[k]) / reach
    system = np.einsum("kmx,m,lmx->kl", lines, weights, lines)
    if np.linalg.matrix_rank(system) < len(struck):
        return None
    strengths = -2 * np.linalg.solve(system, opening)
    kicks = np.einsum("m,kmx,k->kmx", weights, lines, strengths)
    aside = np.zeros((count, 2, errors))
    faster = np.einsum("kmx,mxe->ke", lines, columns[:, 2:])
    for k, hit in enumerate(struck):
        for name, side in ((hit.a, -1.0), (hit.b, 1.0)):
            place = None if name is None or hit.b is None else row.get(name)
            if place is not None:
                aside[place] += side * weights[place] * strengths[k] * turned[k]
                faster[k] += side * kicks[:, place].sum(axis=0) @ turned[k] / 2
        faster[k] += np.array([float(hit.vx), float(hit.vy)]) @ turned[k]
    stronger = np.linalg.solve(system, -2 * faster - np.einsum("kmx,mxe->ke", lines, aside))
    after = columns.copy()
    after[:, 2:] += aside + np.einsum("m,kmx,ke->mxe", weights, lines, stronger)
    after[:, :2] -= np.einsum("kmx,ke->mxe", kicks, waits)
    return Pushed(after, waits)


# ----------------------------------------
# What has become of an engine's local errors at each event of the true run: carried along by the tangent map.


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
        self._left, self._after, self._read = start[:, :2].copy(), start.copy(), -1
        self.radii = np.array([float(c.r) for c in scene.circles])
        self.weights = np.array([float(c.inverse_mass) for c in scene.circles])
        self.since = np.zeros(self.count)
        self.walls = [tuple(float(v) for v in (w.x0, w.y0, w.x1, w.y1)) for w in scene.walls]
        sizes = local.input_unit * np.abs(start)
        self._row = {k: row for row, k in enumerate(moving(scene))}
        movable = sizes[list(self._row)].reshape(-1)
        self._carried = Displacements(scene, np.diag(movable).reshape(len(self._row), 4, -1))
        self._rounds = _rounds(run)

    def take(self, run: Trajectory) -> None:
        """Goes on along a longer run, whose beginning is the one so far."""
        self.run, self._rounds = run, _rounds(run)

    def _read_off(self, index: int) -> NDArray[np.float64]:
        """Shape (circles, 4): all circles as an event leaves them; those that met nothing in it fly on in doubles."""
        if self._read != index:
            event = self.run.events[index]
            met = {k for contact in event.contacts for name in contact if (k := self.places[name]) < self.count}
            time = float(event.time)
            self._after[:, :2] = self._left + (time - self.since)[:, None] * self.velocity
            self._after[:, 2:] = self.velocity
            for k in met:
                c = self.run.circle(self.run.scene.ids[k], event.time)
                self._after[k] = float(c.x), float(c.y), float(c.vx), float(c.vy)
            self._read = index
        return self._after

    def come_to(self, index: int) -> None:
        """Adds what flying to an event and predicting it may cost; positions are those at the event from then on."""
        event = self.run.events[index]
        state, time = self._read_off(index), float(event.time)
        self.position = state[:, :2].copy()
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
        state = self._read_off(index)
        after = state[:, 2:]
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
            self.velocity[k], self.since[k], self._left[k] = after[k], float(event.time), state[k, :2]

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
