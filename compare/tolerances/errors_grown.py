"""What one contact may cost an engine that keeps the law, and what that has grown to at each event of the true run."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...scenarios.arcs import NearSide
from ...scenarios.errors import SceneError
from ...scenarios.numbers.quantity import ZERO
from ...scenarios.surfaces import parts_of
from ..foreign.guard import run_guarded
from ..study import finer_by, series_steps
from ..tangent.growth import Displacements, push_together
from ..tangent.impacts import NoTangentMap, moving, rounds

if TYPE_CHECKING:
    from ...scenarios.engine import Engine
    from ...scenarios.numbers.quantity import Quantity
    from ...scenarios.things import Wall
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
# What has become of an engine's local errors at each event of the true run: carried along by the tangent map.


class GrownErrors:
    """Displacements that rounding errors may have made by now, one for each local error so far.

    A column is what one local error has become; the sum of their lengths, the tolerance, is what all of them can be
    together, whatever their signs.

    Args:
        run: the true run.
        local: what one contact may cost.
        in_rounds: whether errors are carried through instants with several contacts of one circle: of an engine that
            takes the contacts of each in the rounds in which the run has them.

    Attributes:
        scene: as engines see it: circles, with them ends of segments and arcs and corners of polygons; then walls, with
            them faces; then the sides of arcs. Places are in this order.
        places: of circles and walls, by name; of a segment, polygon or arc see `met`.
        parts: of these, by name.
        position, velocity: shape (circles, 2), where each is at the last event, and how fast, in true coordinates;
            of those that take part in it, as they come to it, until it is gone through.
        since: the time of each circle's last event.
        pull: gravity; `falls`, shape (circles, 2), of each circle.
        walls: (x0, y0, x1, y1) of each, where positions are; `paces` are their velocities.
        level: of each wall, whether gravity pulls along it.
        loose: by how much the first point of each wall is rounded, and by what angle rounding turns it; `own_column` is
            the first wall's own error.
    """

    def __init__(self, run: Trajectory, local: LocalError, in_rounds: bool = False) -> None:
        self.scene = scene = run.scene.surfaces
        self.run, self.local, self.in_rounds = run, local, in_rounds
        self.count, self.parts = len(scene.circles), {run.scene.ids[k]: own for k, own in parts_of(run.scene).items()}
        ids, more = run.scene.ids, len(scene.ends)
        own, walls = len(run.scene.circles), len(run.scene.walls)
        self.places = {name: k if k < own else k + more for k, name in enumerate(ids[: own + walls])}
        start = np.array([[float(c.x), float(c.y), float(c.vx), float(c.vy)] for c in scene.circles])
        self.position, self.velocity = start[:, :2].copy(), start[:, 2:].copy()
        self._left, self._sped = start[:, :2].copy(), start[:, 2:].copy()
        self._after, self._read = start.copy(), -1
        self.radii = np.array([float(c.r) for c in scene.circles])
        self.weights = np.array([float(c.inverse_mass) for c in scene.circles])
        self.since = np.zeros(self.count)
        self.pull = (0.0, 0.0) if scene.gravity is None else (float(scene.gravity[0]), float(scene.gravity[1]))
        self.falls = np.outer(self.weights > 0, self.pull)
        self.walls = self._begun = [tuple(float(v) for v in (w.x0, w.y0, w.x1, w.y1)) for w in scene.walls]
        self.paces = [(float(w.vx), float(w.vy)) for w in scene.walls]
        self.level = [self._is_level(wall) for wall in scene.walls]
        self.first_side = self.count + len(self.walls)
        self.sides = [side for arc in run.scene.arcs for side in NearSide.both(arc)]
        sizes = local.input_unit * np.abs(start)
        self._row = {k: row for row, k in enumerate(moving(scene))}
        movable = sizes[list(self._row)].reshape(-1)
        self.loose = [_loose(wall, local.input_unit) for wall in scene.walls[:walls]]
        self.own_column = len(movable)
        begun = np.hstack([np.diag(movable), np.zeros((len(movable), walls))])
        self._carried = Displacements(scene, begun.reshape(len(self._row), 4, -1))
        self._rounds = _rounds(run)

    def line_off(self, i: int, j: int) -> float:
        """By how much rounding the points of a wall moves it, where a circle is; of a face the contact has as much."""
        if not 0 <= j - self.count < len(self.loose):
            return 0.0
        off, turned = self.loose[j - self.count]
        return off + turned * math.dist(self.position[i], self.walls[j - self.count][:2])

    def _is_level(self, wall: Wall) -> bool:
        """Whether gravity pulls along a wall, exactly."""
        (nx, ny), (gx, gy) = wall.normal, self.scene.gravity or (ZERO, ZERO)
        return (nx * gx + ny * gy).sign() == 0

    def take(self, run: Trajectory) -> None:
        """Goes on along a longer run, whose beginning is the one so far."""
        self.run, self._rounds = run, _rounds(run)

    def _read_off(self, index: int) -> NDArray[np.float64]:
        """Shape (circles, 4): all circles as an event leaves them; those that met nothing in it fly on in doubles."""
        if self._read != index:
            event = self.run.events[index]
            met = {k for contact in event.contacts for name in contact if (k := self._circle(name)) is not None}
            time = float(event.time)
            late = (time - self.since)[:, None]
            self._after[:, :2] = self._left + late * (self._sped + late / 2 * self.falls)
            self._after[:, 2:] = self._sped + late * self.falls
            for k in met:
                c = self.run.circle(self.run.scene.ids[k], event.time)
                self._after[k] = float(c.x), float(c.y), float(c.vx), float(c.vy)
            self._read = index
        return self._after

    def come_to(self, index: int) -> None:
        """Adds what flying to an event and predicting it may cost; positions are those at the event from then on."""
        event = self.run.events[index]
        state, time = self._read_off(index), float(event.time)
        self.stand_at(time, state[:, :2].copy())
        for contact, pair in zip(event.contacts, self.met(index), strict=True):
            size = self.local.unit * self._size(pair, time) + self.line_off(*pair)
            for k in self.movers(contact):
                self._add(k, np.array([[size, 0.0, 0.0, 0.0], [0.0, size, 0.0, 0.0]]))

    def stand_at(self, time: float, position: NDArray[np.float64]) -> None:
        """Takes all to a time on their flights, where positions are known to be these."""
        self.position = position
        self.velocity = self._sped + (time - self.since)[:, None] * self.falls
        if self.scene.moving_walls:
            self.walls = [
                (x0 + ux * time, y0 + uy * time, x1 + ux * time, y1 + uy * time)
                for (x0, y0, x1, y1), (ux, uy) in zip(self._begun, self.paces, strict=True)
            ]

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
            for k, wall in [(k, hit.wall) for hit in together for k in (hit.a, hit.b) if k in self._row]:
                turned = 0.0 if wall is None or wall >= len(self.loose) else self.loose[wall][1]
                rounding = (self.local.unit + 2 * turned) * float(speeds[k])
                self._add(k, np.array([[0.0, 0.0, rounding, 0.0], [0.0, 0.0, 0.0, rounding]]))
        for k in [k for contact in event.contacts for k in self.movers(contact)]:
            self.velocity[k], self.since[k], self._left[k] = after[k], float(event.time), state[k, :2]
            self._sped[k] = after[k]

    def _through(self, struck: Sequence[Impact], index: int) -> None:
        """Carries all errors through a round; contacts that share a circle push together, some later than others."""
        taken = [k for hit in struck for k in (hit.a, hit.b) if k in self._row]
        if len(taken) == len(set(taken)):
            self._carried.through(struck)
            return
        self._carried.fly(float(struck[0].time))
        turn = 1 + float(self.scene.restitution)
        weights = self.weights[list(self._row)]
        pushed = push_together(self._carried.columns, self._row, weights, struck, turn, self.pull)
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

    def met(self, index: int) -> list[tuple[int, int]]:
        """Who meets at an event, by place: of a segment, polygon or arc the face, end or side that pushes.

        Raises:
            NoTangentMap: where none of its parts does.
        """
        struck = [hit for mine in self._rounds[index : index + 1] for together in mine for hit in together]
        pushing = [(hit.a, self._pushes(hit)) for hit in struck]
        found: list[tuple[int, int]] = []
        for first, second in self.run.events[index].contacts:
            i, j = self.places[first], self.places.get(second)
            if j is None:
                parts = self.parts[second]
                sides = (self.first_side + side for side in parts.sides)
                among = {*parts.ends, *(self.count + wall for wall in parts.faces), *sides}
                own = [k for a, k in pushing if a == i and k in among and k is not None and (i, k) not in found]
                if not own:
                    raise NoTangentMap(f"event {index}: which part of {second} {first} meets is not known", index)
                j = own[0]
            found.append((i, j))
        return found

    def since_both(self, i: int, j: int) -> float:
        """When both of two things had had their last event."""
        return max(float(self.since[i]), float(self.since[j]) if j < self.count else 0.0)

    def _pushes(self, hit: Impact) -> int | None:
        """The place of what an impact is at; of arcs it numbers the sides after the circles."""
        if hit.wall is not None:
            return self.count + hit.wall
        return hit.b if hit.b is None or hit.b < self.count else self.first_side + hit.b - self.count

    def _circle(self, name: str) -> int | None:
        """The place of a circle; None of anything else."""
        place = self.places.get(name, self.count)
        return place if place < self.count else None

    def _size(self, pair: tuple[int, int], time: float) -> float:
        """The largest number that enters a contact: coordinates at both ends of the flights, radii, the way so far."""
        found = [0.0]
        for k in [k for k in pair if k < self.count]:
            speed = float(np.linalg.norm(self.velocity[k]))
            late = time - float(self.since[k])
            way = speed * late + math.hypot(*self.falls[k]) * late * late
            found += [float(np.abs(self.position[k]).max()) + way, float(self.radii[k]), speed * time]
        if pair[1] >= self.first_side:
            side = self.sides[pair[1] - self.first_side]
            found += map(abs, (side.x, side.y, side.r))
        elif pair[1] >= self.count:
            wall = pair[1] - self.count
            found += map(abs, self.walls[wall])
            found += (abs(pace) * time for pace in self.paces[wall])
        return sum(sorted(found)[-2:])

    def movers(self, contact: Contact) -> list[int]:
        """The places of the circles of a contact that can move."""
        return [k for name in contact if (k := self._circle(name)) is not None and self.weights[k] > 0]

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


def _loose(wall: Wall, unit: float) -> tuple[float, float]:
    """By how much rounding the scene's numbers moves a wall's first point, and by what angle it turns the wall.

    Numbers that the engine has stay as they are, and two that are the same stay the same.
    """

    def off(value: Quantity) -> float:
        near = float(value)
        return (
            0.0 if not unit or (value == near and (math.frexp(near)[0] / unit).is_integer()) else 2 * unit * abs(near)
        )

    turned = [0.0 if one == other else off(one) + off(other) for one, other in ((wall.x0, wall.x1), (wall.y0, wall.y1))]
    length = math.hypot(float(wall.x1 - wall.x0), float(wall.y1 - wall.y0))
    return math.hypot(off(wall.x0), off(wall.y0)), math.hypot(*turned) / length


def _rounds(run: Trajectory) -> Sequence[Sequence[Sequence[Impact]]]:
    """The impacts of all events at the start that have a map to the next, by round."""
    try:
        return rounds(run, len(run.events))
    except NoTangentMap as none:
        return rounds(run, none.events)


# ----------------------------------------
# Two things near each other, and by how much errors move the one against the other.

TIGHT = 2.0**-36
"""A margin in doubles is off by some 2**-50 of the scene's measures; one of less than this share of them is taken from
the exact run instead."""


class Apex(NamedTuple):
    """Where a circle that gravity pulls away from a wall is nearest to it.

    Attributes:
        wait: how long after the event; below 0 before it.
        gap: how far it is from the wall then; below 0 where it meets it.
        room: by how much errors can move that.
        sooner: for how long before and after the two are not farther than that from it.
    """

    wait: float
    gap: float
    room: float
    sooner: float


class Nearby:
    """Pairs, at the event at which the positions of `grown` are, and their displacements, to the first order.

    Everything is named by its place in the scene as engines see it (`GrownErrors.scene`); of a pair with a wall, the
    face of a segment or polygon, or a side of an arc, that is second.

    Attributes:
        scale: the scene's largest coordinate or radius.
        rounding: what one decision is off by itself.
    """

    def __init__(self, grown: GrownErrors) -> None:
        self.grown = grown
        round_ones = [abs(value) for side in grown.sides for value in (side.x, side.y, side.r)]
        self.scale = max(float(np.abs(grown.position).max()), float(grown.radii.max()), *round_ones, 0.0)
        self.rounding = grown.local.unit * self.scale
        self.faces = range(grown.count + grown.scene.faces.start, grown.count + grown.scene.faces.stop)

    def is_line(self, j: int) -> bool:
        """Whether a place is that of a wall or a face."""
        return self.grown.count <= j < self.grown.first_side

    def side_of(self, j: int) -> NearSide | None:
        """The side of an arc that is at a place, if it is one."""
        return self.grown.sides[j - self.grown.first_side] if j >= self.grown.first_side else None

    def reach(self, i: int, j: int) -> float:
        """How far the centres of two round things are apart at a contact; below 0 where a circle does not fit in."""
        side = self.side_of(j)
        if side is None:
            return float(self.grown.radii[i] + self.grown.radii[j])
        return abs(side.r) + math.copysign(float(self.grown.radii[i]), side.r)

    def gap(self, i: int, j: int) -> float:
        """The distance of the two surfaces."""
        if self.is_line(j):
            return self.wall(i, j)[0]
        d, _ = self.relative(i, j)
        side, far = self.side_of(j), float(np.hypot(*d)) - self.reach(i, j)
        return -far if side is not None and side.r < 0.0 else far

    def speed(self, i: int, j: int) -> float:
        """How fast the two move against each other."""
        v = (
            self.grown.velocity[i] - self.grown.paces[j - self.grown.count]
            if self.is_line(j)
            else self.relative(i, j)[1]
        )
        return float(np.hypot(*v))

    def apart(self, columns: NDArray[np.float64], i: int, j: int) -> float:
        """By how much all errors can move the one against the other at the event."""
        return float(np.hypot(*self.between(columns, i, j, 0.0)).sum()) + self.rounding

    def relative(self, i: int, j: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """d and v of two round things, at the time of the event that positions are at."""
        grown, side = self.grown, self.side_of(j)
        if side is not None:
            return np.array([side.x, side.y]) - grown.position[i], -grown.velocity[i]
        return grown.position[j] - grown.position[i], grown.velocity[j] - grown.velocity[i]

    def between(self, columns: NDArray[np.float64], i: int, j: int, lag: float) -> NDArray[np.float64]:
        """Shape (2, errors): the displacement of j against i, so much later than the columns."""
        other = columns[j] if j < self.grown.count else np.zeros_like(columns[i])
        if off := self.grown.line_off(i, j):
            other[:2, self.grown.own_column + j - self.grown.count] = np.array(self.side(i, j)[:2]) * off
        between = other - columns[i]
        return between[:2] + lag * between[2:]

    def across(self, columns: NDArray[np.float64], i: int, j: int, near: float, time: float) -> float:
        """By how much all errors can move the least distance of two round things."""
        _, v = self.relative(i, j)
        across = np.array([-v[1], v[0]]) / math.sqrt(float(v @ v))
        return float(np.abs(across @ self.between(columns, i, j, near - time)).sum()) + self.rounding

    def wait(self, i: int, j: int) -> float | None:
        """How long after an event two would meet in free flight; None if they do not."""
        if self.is_line(j):
            gap, closing = self.wall(i, j)
            if j in self.faces and gap < -self.scale * TIGHT:  # behind it, or beside
                return None
            gap, pull = max(gap, 0.0), self.pull(i, j)
            if not pull:
                return gap / closing if closing > 0 else None
            square = closing * closing - 2 * pull * gap
            if square < 0 or (closing <= 0 and pull > 0):
                return None
            return 2 * gap / (closing + math.sqrt(square)) if closing > 0 else (closing - math.sqrt(square)) / pull
        d, v = self.relative(i, j)
        reach, side = self.reach(i, j), self.side_of(j)
        b, square = float(d @ v), float(v @ v)
        if not square:
            return None
        root = square * reach * reach - float(d[0] * v[1] - d[1] * v[0]) ** 2
        inside = reach * reach - float(d @ d)
        if side is not None and side.r < 0.0:  # where it goes out again; from outside it may come in by the opening
            if reach <= 0.0 or root < 0 or (b >= 0 and self.gap(i, j) < -self.scale * TIGHT):
                return None
            return max(inside, 0.0) / (b + math.sqrt(root)) if b > 0 else (-b + math.sqrt(root)) / square
        if b >= 0 or root < 0 or (side is not None and self.gap(i, j) < -self.scale * TIGHT):
            return None
        return max(-inside, 0.0) / (-b + math.sqrt(root))

    def wall(self, i: int, j: int) -> tuple[float, float]:
        """The gap between a circle and a wall, and the speed at which it closes."""
        nx, ny, side, height = self.side(i, j)
        vx, vy = self.grown.velocity[i] - self.grown.paces[j - self.grown.count]
        return side * height - float(self.grown.radii[i]), -side * float(nx * vx + ny * vy)

    def pull(self, i: int, j: int) -> float:
        """How fast gravity makes the gap between a circle and a wall grow ever faster: below 0 towards the wall."""
        if self.grown.level[j - self.grown.count]:
            return 0.0
        nx, ny, side, _ = self.side(i, j)
        gx, gy = self.grown.falls[i]
        return side * float(nx * gx + ny * gy)

    def apex(self, columns: NDArray[np.float64], i: int, j: int) -> Apex | None:
        """Where a circle that gravity pulls away from a wall is nearest to it; None of one that it does not."""
        pull = self.pull(i, j)
        if pull <= 0:
            return None
        gap, closing = self.wall(i, j)
        nx, ny, _, _ = self.side(i, j)
        aside = np.array([nx, ny]) @ self.between(columns, i, j, closing / pull)
        room = float(np.abs(aside).sum()) + self.rounding
        return Apex(closing / pull, gap - closing * closing / (2 * pull), room, math.sqrt(2 * room / pull))

    def side(self, i: int, j: int) -> tuple[float, float, float, float]:
        """The unit normal of a wall, the side on which a circle is, and its height above it."""
        x0, y0, x1, y1 = self.grown.walls[j - self.grown.count]
        nx, ny = y0 - y1, x1 - x0
        length = math.hypot(nx, ny)
        x, y = self.grown.position[i]
        height = float(nx * (x - x0) + ny * (y - y0)) / length
        return nx / length, ny / length, (1.0 if height >= 0 or j in self.faces else -1.0), height

    def foot(self, columns: NDArray[np.float64], i: int, j: int, wait: float, time: float) -> tuple[float, float]:
        """How far within its ends a circle meets the line of a face, or the circle of an arc; what errors move that by.

        Below 0 beyond the ends.
        """
        late = self.shift(columns, i, j, time + wait, time)
        if (side := self.side_of(j)) is not None:
            d, v = self.relative(i, j)
            dx, dy = -(d + wait * v)
            moved = self.between(columns, i, j, wait) + np.outer(v, late)
            return side.within(dx, dy, self.reach(i, j)), float(np.hypot(*moved).sum()) + self.rounding
        x0, y0, x1, y1 = self.grown.walls[j - self.grown.count]
        length = math.hypot(x1 - x0, y1 - y0)
        way = np.array([x1 - x0, y1 - y0]) / length
        slide = float(way @ self.grown.velocity[i])
        foot = float(way @ (self.grown.position[i] - (x0, y0))) + slide * wait
        room = float(np.abs(way @ self.between(columns, i, j, wait) + slide * late).sum()) + self.rounding
        return min(foot, length - foot), room

    def beside(self, i: int, end: int) -> float:
        """How far a circle at an end is from where that becomes a face or an arc: along those that begin there."""
        grown, r = self.grown, float(self.grown.radii[end])
        d, found = grown.position[i] - grown.position[end], math.inf
        for x0, y0, x1, y1 in grown.walls[self.faces.start - grown.count :]:
            starts = [math.hypot(*(grown.position[end] - place)) for place in ((x0, y0), (x1, y1))]
            if any(abs(away - r) <= TIGHT * self.scale for away in starts):
                found = min(found, abs(float(d @ (x1 - x0, y1 - y0))) / math.hypot(x1 - x0, y1 - y0))
        for side in grown.sides[::2]:
            for ex, ey in side.ends:
                place = side.x + side.r * ex, side.y + side.r * ey
                if float(np.hypot(*(grown.position[end] - place))) <= TIGHT * self.scale:
                    found = min(found, abs(float(d @ (-ey, ex))))
        return found

    def may_pass(self, columns: NDArray[np.float64], i: int, j: int, near: float, time: float) -> bool:
        """Whether a flight is nearest to a side of an arc from outside and within its range, as far as errors leave it.

        Of a hollow side nothing passes: what is within comes out by it, or by the opening, past the ends.
        """
        side = self.grown.sides[j - self.grown.first_side]
        d, v = self.relative(i, j)
        dx, dy = -(d + (near - time) * v)
        far, doubt = math.hypot(dx, dy), self.across(columns, i, j, near, time) + TIGHT * self.scale
        if side.r < 0.0 or far < side.r - doubt:
            return False
        turned = np.hypot(*self.between(columns, i, j, near - time)).sum() + doubt  # the place where it is nearest
        turned += far * float(np.hypot(*columns[i][2:]).sum()) / math.sqrt(float(v @ v))
        return side.within(dx, dy, far) > -float(turned)

    def stay(self, i: int, j: int, near: float, time: float) -> float:
        """For how long two round things would overlap if neither pushed; of an arc, until the line is behind."""
        d, v = self.relative(i, j)
        square, off, side = float(v @ v), float(d[0] * v[1] - d[1] * v[0]), self.side_of(j)
        if side is None:
            return 2 * (near - time)
        radii = abs(side.r) - float(self.grown.radii[i]), abs(side.r) + float(self.grown.radii[i])
        inner, outer = (math.sqrt(max(square * r * r - off * off, 0.0)) / square for r in radii)
        if side.r > 0.0 and (radii[0] <= 0.0 or not inner):
            return 2 * outer
        return outer - inner

    def shift(self, columns: NDArray[np.float64], i: int, j: int, meeting: float, time: float) -> NDArray[np.float64]:
        """By how much each error delays the meeting of two, at a time of the flights under way; a graze by any time."""
        if self.is_line(j):
            nx, ny, side, _ = self.side(i, j)
            closing = self.wall(i, j)[1] - self.pull(i, j) * (meeting - time)
            if not closing:
                return np.full(columns.shape[2], math.inf)
            normal = np.array([side * nx, side * ny])
            return -(normal @ self.between(columns, i, j, meeting - time)) / closing
        d, v = self.relative(i, j)
        there = d + (meeting - time) * v
        if not float(there @ v):
            return np.full(columns.shape[2], math.inf)
        return -(there @ self.between(columns, i, j, meeting - time)) / float(there @ v)

    def bent(self, columns: NDArray[np.float64], i: int, j: int) -> float:
        """What curvature adds to the delay of the meeting of two round things: all errors across it, to second order.

        Where the two fly head on, errors across their way delay it by nothing to the first order. At a wall it is that
        those of the velocity change how fast it comes, and the bend of a flight that falls.
        """
        if self.is_line(j):
            closing = abs(self.wall(i, j)[1])
            nx, ny, *_ = self.side(i, j)
            turned = float(np.abs(np.array([nx, ny]) @ columns[i][2:]).sum())
            late = self.apart(columns, i, j) / closing if closing else 0.0
            return late * (turned + abs(self.pull(i, j)) * late) / closing if closing else 0.0
        d, v = self.relative(i, j)
        reach = self.reach(i, j)
        closing = abs(float(d @ v)) / math.sqrt(float(d @ d))
        return self.apart(columns, i, j) ** 2 / (reach * closing) if reach and closing else 0.0
