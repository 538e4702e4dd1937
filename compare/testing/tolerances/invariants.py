"""What holds however far a history has left the true one: energy, momentum, no overlap, impulses that laws permit."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ....scenarios.trajectory import StopReason
from .local_error import energy, masses_of
from .numbers import latest_so_far
from .permitted import PermittedImpulses, Room

if TYPE_CHECKING:
    from ....scenarios.event import Event
    from ....scenarios.trajectory import Trajectory
    from .local_error import LocalError

OVERLAPS = 4.0
"""Two circles that are late to each other by a step sink in by the way that they make meanwhile; where a push of
another sends one on before they part, by some more."""

TOLD = 2.0**-47
"""States are told in doubles, and energies summed in them, whatever an engine counts in: 64 roundings of each."""


def broken_invariant(run: Trajectory, local: LocalError, until: float | None = None) -> str | None:
    """The first invariant that a run breaks by more than its contacts may cost, in words; None if it keeps them.

    Up to a time `until` what a run leaves at its end flies on, if nothing is left to happen.

    Momentum is that of the circles of an event in which no wall and no fixed circle takes part; circles that take no
    part keep their velocities; from one event to the next circles fly straight on; what meets touches, and is pushed
    apart (`PermittedImpulses`). Events that a run has at one time are looked at together. Where velocities are negated
    between two, or a circle leaves play, nothing is said of what happens from the one to the other but to energy.
    """
    scene = run.scene
    masses = masses_of(scene)
    places = {str(c.id): k for k, c in enumerate(scene.circles)}
    last, then = np.array([[float(q) for q in (c.x, c.y, c.vx, c.vy)] for c in scene.circles]), 0.0
    unit, laws = max(local.unit, TOLD), PermittedImpulses(scene, local)
    start, askew = energy(masses, last[:, 2:]), 0.0
    for group in _instants(run):
        event, last_time = group[-1], latest_so_far(group)[-1].time
        time = float(last_time)
        where = f"event {event.index} (t = {time:.9g})"
        state = run.at(last_time).array()
        before, after, share = last[:, 2:], state[:, 2:], unit * (event.index + 1)
        kept, room = energy(masses, after), _room(state, laws.radii, local, time)
        askew += sum(laws.askew(pair, room) for e in group for pair in e.impulses)
        off = share + askew + local.iterated
        if abs(kept - start) > off * start:
            return f"{where}: energy is {kept:.17g}, it was {start:.17g}: not kept within {off:.3g} of it"
        if not _turned(run, then, time):
            aside = np.hypot(*(state[:, :2] - last[:, :2] - (time - then) * before).T)
            if aside.max() > sum(room):
                k = int(np.argmax(aside))
                return (
                    f"{where}: {scene.ids[k]} is {aside[k]:.3g} from where it flew to since t = {then:.9g}; "
                    f"{sum(room):.3g} may be"
                )
            changed = np.hypot(*(after - before).T) > share * float(np.hypot(*before.T).max())
            part = {places[name] for e in group for pair in e.contacts for name in pair if name in places}
            others = [k for k in range(len(masses)) if k not in part and changed[k]]
            if others:
                return f"{where}: {scene.ids[others[0]]} takes no part, and its velocity has changed"
            every = [name for e in group for pair in e.contacts for name in pair]
            if all(name in places and masses[places[name]] for name in every):
                change = float(np.hypot(*(masses[:, None] * (after - before)).sum(axis=0)))
                size = float((masses * np.hypot(*before.T)).sum())
                if change > share * size:
                    return f"{where}: momentum has changed by {change:.3g}, of {size:.3g} in all"
            broken = laws.broken(group, before, state, room, share)
            if broken is not None:
                return f"{where}: {broken}"
        deep = _overlap(run, state, masses, room)
        if deep is not None:
            return f"{where}: {deep}"
        last, then = state, time
    return _broken_at_the_end(run, local, last, then, until)


def _broken_at_the_end(
    run: Trajectory, local: LocalError, last: NDArray[np.float64], then: float, until: float | None
) -> str | None:
    """What an engine that misses all that comes after its last event does: circles overlap, or are across walls."""
    end = float(run.final_time)
    if run.stop.reason is StopReason.QUIET:
        end = max(end, until or 0.0)
    elif run.stop.reason is not StopReason.HORIZON:
        return None
    if end <= then or _turned(run, then, end):
        return None
    flown = last.copy()
    flown[:, :2] += (end - then) * last[:, 2:]
    radii = np.array([float(c.r) for c in run.scene.circles])
    deep = _overlap(run, flown, masses_of(run.scene), _room(flown, radii, local, end))
    return None if deep is None else f"t = {end:.9g}, with no event since t = {then:.9g}: {deep}"


def _turned(run: Trajectory, then: float, time: float) -> bool:
    """Whether velocities were negated, or a circle left play, between two times, the ends included."""
    turns = [] if run.reversal is None else [float(run.reversal.time)]
    turns += [float(entry.time) for entry in run.pocketings] if run.scene.capture else []
    return any(then <= turn <= time for turn in turns)


def _instants(run: Trajectory) -> Iterator[list[Event]]:
    """The events, those at one time (or, by rounding, before it) together."""
    group: list[Event] = []
    latest = latest_so_far(run.events)
    for k, event in enumerate(run.events):
        if group and float(event.time) > float(latest[k - 1].time):
            yield group
            group = []
        group.append(event)
    if group:
        yield group


def _room(state: NDArray[np.float64], radii: NDArray[np.float64], local: LocalError, time: float) -> Room:
    """How far off places may be at a time."""
    fastest = float(np.hypot(*state[:, 2:].T).max(initial=0.0))
    size = float(np.abs(state[:, :2]).max()) + float(radii.max()) + fastest * time
    return Room(max(local.unit, TOLD) * size, OVERLAPS * 2 * fastest * local.lateness)


def _overlap(run: Trajectory, state: NDArray[np.float64], masses: NDArray[np.float64], most: Room) -> str | None:
    """Two circles that overlap, or a circle across a wall, by more than errors of one contact."""
    scene, place, room = run.scene, state[:, :2], sum(most)
    radii = np.array([float(c.r) for c in scene.circles])
    between = np.hypot(*(place[:, None] - place[None]).transpose(2, 0, 1)) - radii[:, None] - radii[None]
    np.fill_diagonal(between, math.inf)
    fixed = masses == 0
    between[np.ix_(fixed, fixed)] = math.inf
    i, j = np.unravel_index(int(np.argmin(between)), between.shape)
    if between[i, j] < -room:
        return f"{scene.ids[i]} and {scene.ids[j]} overlap by {-between[i, j]:.3g}, {room:.3g} may be"
    for wall in scene.walls:
        nx, ny = (float(n) for n in wall.normal)
        length = math.hypot(nx, ny)
        for k, circle in enumerate(scene.circles):
            side = 1.0 if wall.height(circle.x, circle.y).sign() >= 0 else -1.0
            height = side * (nx * (place[k, 0] - float(wall.x0)) + ny * (place[k, 1] - float(wall.y0))) / length
            if height - radii[k] < -room and not circle.fixed:
                return f"{circle.id} is across wall {wall.id} by {radii[k] - height:.3g}, {room:.3g} may be"
    return None
