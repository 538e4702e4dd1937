"""Whether taking the contacts of one instant as another run took them leads to the same velocities."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

if TYPE_CHECKING:
    from ...scenarios.trajectory import Contact, State, Trajectory

Velocities: TypeAlias = "dict[str, tuple[float, float]]"

SAME_VELOCITY = 2.0**-26
"""Velocities closer than this share of the largest speed are the same. Both come from one state by a
handful of operations in doubles (2**-53 each), while a different order of coupled impulses changes them in
their first digits: half of a double's digits lies far from both."""


def order_reproduces(trajectory: Trajectory, index: int, groups: Sequence[Sequence[Contact]]) -> bool:
    """Whether the impulses of `groups`, in order, lead from the state before an event to the state after it.

    A run that took an instant's contacts apart (or took several instants as one) has not changed what
    happened if the way in which it took them leads to the same velocities. Contacts of one group that
    approach together get their impulses together, unless the scene's tie policy is sequential.

    Args:
        trajectory: the run that took the contacts as one instant.
        index: the event in that run.
        groups: the pairs as the other run took them: a group for each of its instants.
    """
    event = trajectory.events[index]
    before, after = _velocities_before(trajectory, index), trajectory.at(event.time)
    impact = _Impact(trajectory, {c.id: (float(c.x), float(c.y)) for c in after.circles}, before)
    scale = max((math.hypot(*v) for v in before.values()), default=0.0)
    room = SAME_VELOCITY * scale
    at_once = trajectory.scene.tie_policy.name == "simultaneous"
    if not all(impact.take(group, at_once) for group in groups):
        return False
    touched = {name for pair in (*event.impulses, *(p for g in groups for p in g)) for name in pair}
    return all(
        math.hypot(impact.velocities[c.id][0] - float(c.vx), impact.velocities[c.id][1] - float(c.vy)) <= room
        for c in after.circles
        if c.id in touched
    )


def merging_changes(trajectory: Trajectory, indices: Sequence[int], groups: Sequence[Sequence[Contact]]) -> float:
    """By how much velocities differ if the impulses of several instants are given at once; 0 if by no law.

    Args:
        trajectory: the run that has the instants one after the other.
        indices: the events.
        groups: their impulses.
    """
    before = _velocities_before(trajectory, indices[0])
    first, last = trajectory.events[indices[0]].time, trajectory.events[indices[-1]].time
    places = {c.id: (float(c.x), float(c.y)) for c in trajectory.at(first).circles}
    one, other = _Impact(trajectory, places, before), _Impact(trajectory, places, before)
    everything = [*dict.fromkeys(pair for group in groups for pair in group)]
    in_turn = all(one.take([pair], False) for group in groups for pair in group)
    at_once = other.take([pair for pair in everything if other.closing(pair) > 0], True)
    scale = max((math.hypot(*v) for v in before.values()), default=0.0)
    if not (in_turn and at_once):
        return scale
    apart = max(math.dist(one.velocities[name], other.velocities[name]) for name in before)
    way = scale * (float(last) - float(first))
    return apart if apart > SAME_VELOCITY * scale + 4 * len(everything) * scale * way / one.least_reach else 0.0


def impulses_among(events: Iterable[Sequence[Contact]], pairs: Sequence[Contact]) -> list[list[Contact]]:
    """For each of some events, its impulses that are between the given pairs; events without any left out."""
    wanted = {frozenset(pair) for pair in pairs}
    groups = [[pair for pair in impulses if frozenset(pair) in wanted] for impulses in events]
    return [group for group in groups if group]


def _velocities_before(trajectory: Trajectory, index: int) -> Velocities:
    """Velocities as an event comes: those that the event before it left."""
    reversal = trajectory.reversal
    if reversal is not None and reversal.after == index:
        middle = (float(reversal.time) + float(trajectory.events[index].time)) / 2
        return _velocities(trajectory.at(middle))
    if index == 0:
        return {str(c.id): (float(c.vx), float(c.vy)) for c in trajectory.scene.circles}
    return _velocities(trajectory.at(trajectory.events[index - 1].time))


def _velocities(state: State) -> Velocities:
    return {c.id: (float(c.vx), float(c.vy)) for c in state.circles}


class _Impact:
    """Circles at fixed places whose velocities change by impulses, in doubles."""

    def __init__(self, trajectory: Trajectory, places: Velocities, velocities: Velocities) -> None:
        scene = trajectory.scene
        self.places = places
        self.velocities = dict(velocities)
        self.weights = {str(c.id): float(c.inverse_mass) for c in scene.circles}
        self.walls = {str(w.id): w for w in scene.walls}
        self.least_reach = min((r for c in scene.circles if (r := float(c.r)) > 0), default=1.0)

    def take(self, group: Sequence[Contact], at_once: bool) -> bool:
        """Applies the impulses of a group in rounds; False if one of them could not have come about."""
        left = list(group)
        while left:
            count = 1 if at_once else 0
            while at_once and count < len(left) and left[count] not in left[:count] and self.closing(left[count]) > 0:
                count += 1
            together, left = left[: max(count, 1)], left[max(count, 1) :]
            if not self._kick(together):
                return False
        return True

    def _normal(self, pair: Contact) -> tuple[float, float]:
        """The unit vector from the first to the second, or to the wall."""
        x, y = self.places[pair.first]
        if pair.second in self.places:
            nx, ny = (self.places[pair.second][0] - x, self.places[pair.second][1] - y)
        else:
            wall = self.walls[pair.second]
            nx, ny = (float(n) for n in wall.normal)
            if nx * (float(wall.x0) - x) + ny * (float(wall.y0) - y) < 0:
                nx, ny = -nx, -ny
        length = math.hypot(nx, ny)
        return (nx / length, ny / length) if length else (0.0, 0.0)

    def closing(self, pair: Contact) -> float:
        """The speed at which two approach."""
        nx, ny = self._normal(pair)
        vx, vy = self.velocities[pair.first]
        ux, uy = self.velocities.get(pair.second, (0.0, 0.0))
        return (vx - ux) * nx + (vy - uy) * ny

    def _kick(self, pairs: Sequence[Contact]) -> bool:
        """Impulses along each pair's normal such that all separate as fast as they approached."""
        closing = np.array([self.closing(pair) for pair in pairs])
        if not (closing > 0).all():
            return False
        normals = [self._normal(pair) for pair in pairs]
        pushes = [
            {name: (sign * self.weights[name] * n[0], sign * self.weights[name] * n[1])
             for name, sign in ((pair.first, -1.0), (pair.second, 1.0)) if name in self.weights}
            for pair, n in zip(pairs, normals, strict=True)
        ]  # fmt: skip
        matrix = np.array(
            [[_opening(pair, normal, push) for push in pushes] for pair, normal in zip(pairs, normals, strict=True)]
        )
        sizes = np.linalg.lstsq(matrix, 2 * closing, rcond=None)[0]
        if not (sizes > -SAME_VELOCITY * np.abs(sizes).max()).all():
            return False
        for size, push in zip(sizes, pushes, strict=True):
            for name, (px, py) in push.items():
                vx, vy = self.velocities[name]
                self.velocities[name] = (vx + float(size) * px, vy + float(size) * py)
        return True


def _opening(pair: Contact, normal: tuple[float, float], push: Velocities) -> float:
    """How much faster a pair separates along its normal after a unit of an impulse."""
    (ax, ay), (bx, by) = push.get(pair.first, (0.0, 0.0)), push.get(pair.second, (0.0, 0.0))
    return (bx - ax) * normal[0] + (by - ay) * normal[1]
