"""Whether taking the contacts of one instant in some order, one at a time, would have changed the outcome."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ..scenarios.trajectory import Contact, State, Trajectory

SAME_VELOCITY = 2.0**-26
"""Velocities closer than this share of the largest speed are the same. Both come from one state by a handful of
operations in doubles (2**-53 each), while a different order of coupled impulses changes them in their first
digits: half of a double's digits lies far from both."""


def order_reproduces(trajectory: Trajectory, index: int, order: Sequence[Contact]) -> bool:
    """Whether the impulses of `order`, one at a time, lead from the state before an event to the state after it.

    A run that took an instant's contacts apart (or took two instants as one) has not changed what happened if
    the order in which it took them leads to the same velocities.

    Args:
        trajectory: the run that took the contacts as one instant.
        index: the event in that run.
        order: the pairs in the order in which the other run took them.
    """
    event = trajectory.events[index]
    before, after = _velocities_before(trajectory, index), trajectory.at(event.time)
    places = {c.id: (float(c.x), float(c.y)) for c in after.circles}
    velocities = dict(before)
    scale = max((math.hypot(*v) for v in velocities.values()), default=0.0)
    for first, second in order:
        if not _bounce(trajectory, places, velocities, first, second):
            return False
    touched = {name for pair in (*order, *event.impulses) for name in pair if name in velocities}
    return all(
        abs(velocities[c.id][0] - float(c.vx)) <= SAME_VELOCITY * scale
        and abs(velocities[c.id][1] - float(c.vy)) <= SAME_VELOCITY * scale
        for c in after.circles
        if c.id in touched
    )


def _velocities_before(trajectory: Trajectory, index: int) -> dict[str, tuple[float, float]]:
    """Velocities as an event comes: those that the event before it left."""
    reversal = trajectory.reversal
    if reversal is not None and reversal.after == index:
        middle = (float(reversal.time) + float(trajectory.events[index].time)) / 2
        return _velocities(trajectory.at(middle))
    if index == 0:
        return {str(c.id): (float(c.vx), float(c.vy)) for c in trajectory.scene.circles}
    return _velocities(trajectory.at(trajectory.events[index - 1].time))


def _velocities(state: State) -> dict[str, tuple[float, float]]:
    return {c.id: (float(c.vx), float(c.vy)) for c in state.circles}


def _bounce(
    trajectory: Trajectory,
    places: dict[str, tuple[float, float]],
    velocities: dict[str, tuple[float, float]],
    first: str,
    second: str,
) -> bool:
    """One elastic impulse in doubles; False if the two do not approach, so that there is no such impulse."""
    scene = trajectory.scene
    weights = {str(c.id): float(c.inverse_mass) for c in scene.circles}
    if second in places:
        nx, ny = (b - a for a, b in zip(places[first], places[second], strict=True))
        w1, w2, (ux, uy) = weights[first], weights[second], velocities[second]
    else:
        wall = next(w for w in scene.walls if w.id == second)
        nx, ny = (float(n) for n in wall.normal)
        px, py = places[first]
        side = nx * (float(wall.x0) - px) + ny * (float(wall.y0) - py)
        nx, ny = (nx, ny) if side >= 0 else (-nx, -ny)
        w1, w2, (ux, uy) = weights[first], 0.0, (0.0, 0.0)
    vx, vy = velocities[first]
    length2, weight = nx * nx + ny * ny, w1 + w2
    approach = (vx - ux) * nx + (vy - uy) * ny
    if length2 == 0.0 or weight == 0.0 or approach <= 0.0:
        return False
    impulse = 2 * approach / (length2 * weight)
    velocities[first] = (vx - impulse * w1 * nx, vy - impulse * w1 * ny)
    if w2:
        velocities[second] = (ux + impulse * w2 * nx, uy + impulse * w2 * ny)
    return True


def impulses_among(events: Iterable[Sequence[Contact]], pairs: Sequence[Contact]) -> list[Contact]:
    """The impulses of some events, in order, that are between the given pairs."""
    wanted = {frozenset(pair) for pair in pairs}
    return [pair for impulses in events for pair in impulses if frozenset(pair) in wanted]
