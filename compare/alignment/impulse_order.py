"""Whether taking the contacts of one instant as another run took them leads to the same velocities."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, TypeAlias

from ...exact.replay import state as exact_state
from ...exact.replay.contact import touch_of
from ...exact.simulation.policies import pushing_contacts

if TYPE_CHECKING:
    from ...exact.replay.contact import Touch
    from ...scenarios.trajectory import Contact, State, Trajectory

Velocities: TypeAlias = "dict[str, tuple[float, float]]"


def same_velocity(bits: int | None) -> float:
    """The share of the largest speed up to which velocities are the same: half of the digits that they have.

    Both come from one state by some operations, each rounded to so many bits (53 at the most, for they are done again
    in doubles), while another order of coupled impulses changes them by the coupling, in their first digits unless the
    contacts are at right angles but for as little as that share. Half of the digits lies as far from the one as from
    the other.

    >>> same_velocity(None) == same_velocity(106) == 2.0**-26, same_velocity(24) == 2.0**-12
    (True, True)
    """
    return 2.0 ** -(min(bits or DOUBLE_BITS, DOUBLE_BITS) // 2)


DOUBLE_BITS = 53
"""Bits of a double."""


def order_reproduces(
    trajectory: Trajectory,
    index: int,
    impulses: Sequence[Contact],
    groups: Sequence[Sequence[Contact]],
    same: float,
) -> bool:
    """Whether the impulses of `groups`, in order, lead from the state before an event to the state after it.

    A run that took an instant's contacts apart (or took several instants as one) has not changed what
    happened if the way in which it took them leads to the same velocities. Contacts of one group that
    approach together get their impulses together, unless the scene's tie policy is sequential.

    Args:
        trajectory: the run that took the contacts as one instant.
        index: the event in that run.
        impulses: those of its impulses that are meant: they have no circle that can move in common with the others.
        groups: the pairs as the other run took them: a group for each of its instants.
        same: see `same_velocity`.
    """
    before, after = _velocities_before(trajectory, index), trajectory.after(index)
    impact = _Impact(trajectory, {c.id: (float(c.x), float(c.y)) for c in after.circles}, before)
    scale = max((math.hypot(*v) for v in before.values()), default=0.0)
    room = same * scale
    at_once = trajectory.scene.tie_policy.name == "simultaneous"
    if not all(impact.take(group, at_once) for group in groups):
        return False
    touched = {name for pair in (*impulses, *(p for g in groups for p in g)) for name in pair}
    return all(
        math.hypot(impact.velocities[c.id][0] - float(c.vx), impact.velocities[c.id][1] - float(c.vy)) <= room
        for c in after.circles
        if c.id in touched
    )


def merging_changes(
    trajectory: Trajectory, indices: Sequence[int], groups: Sequence[Sequence[Contact]], same: float
) -> float:
    """By how much velocities differ if the impulses of several instants are given at once; 0 if by no law.

    Args:
        trajectory: the run that has the instants one after the other.
        indices: the events.
        groups: their impulses.
        same: see `same_velocity`.
    """
    before = _velocities_before(trajectory, indices[0])
    first, last = (float(trajectory.events[index].time) for index in (indices[0], indices[-1]))
    places = {c.id: (float(c.x), float(c.y)) for c in trajectory.after(indices[0]).circles}
    one, other = _Impact(trajectory, places, before), _Impact(trajectory, places, before)
    everything = [*dict.fromkeys(pair for group in groups for pair in group)]
    in_turn = all(one.take([pair], False) for group in groups for pair in group)
    at_once = other.take([pair for pair in everything if other.closing(pair) > 0], True)
    scale = max((math.hypot(*v) for v in before.values()), default=0.0)
    if not (in_turn and at_once):
        return scale
    apart = max(math.dist(one.velocities[name], other.velocities[name]) for name in before)
    way = scale * (last - first)
    return apart if apart > same * scale + 4 * len(everything) * scale * way / one.least_reach else 0.0


def follows_the_law(trajectory: Trajectory, index: int, bits: int | None) -> bool:
    """Whether an event of one contact leaves its circles as the law of elastic impact does, from the run's own state.

    What rounding to so many bits makes of places and velocities is granted; a contact that approaches no faster than
    that may do nothing.
    """
    event = trajectory.events[index]
    if len(event.impulses) != 1:
        return True
    pair = event.impulses[0]
    before, after = _velocities_before(trajectory, index), trajectory.after(index)
    places = {c.id: (float(c.x), float(c.y)) for c in after.circles}
    impact = _Impact(trajectory, places, before)
    speed = max((math.hypot(*v) for v in before.values()), default=0.0)
    far = max(abs(x) for place in places.values() for x in place) + speed * float(event.time)
    turned = 2.0 ** -min(bits or DOUBLE_BITS, DOUBLE_BITS) * far / impact.least_reach
    room = speed * (same_velocity(bits) + TURNS * turned)
    if impact.closing(pair) > 0:
        impact.take([pair], True)
    told = _velocities(after)
    return all(math.dist(impact.velocities[name], told[name]) <= room for name in pair if name in told)


TURNS = 64
"""How many roundings of its place an impact may be turned by: some for each operation that leads to the contact."""


def impulses_among(events: Iterable[Sequence[Contact]], pairs: Sequence[Contact]) -> list[list[Contact]]:
    """For each of some events, its impulses that are between the given pairs; events without any left out."""
    wanted = {frozenset(pair) for pair in pairs}
    groups = [[pair for pair in impulses if frozenset(pair) in wanted] for impulses in events]
    return [group for group in groups if group]


def _velocities_before(trajectory: Trajectory, index: int) -> Velocities:
    """Velocities as an event comes: those that the event before it left."""
    if index == 0:
        left = {str(c.id): (float(c.vx), float(c.vy)) for c in trajectory.scene.circles}
    else:
        left = _velocities(trajectory.after(index - 1))
    turned = trajectory.reversal is not None and trajectory.reversal.after == index
    return {name: (-vx, -vy) for name, (vx, vy) in left.items()} if turned else left


def _velocities(state: State) -> Velocities:
    return {c.id: (float(c.vx), float(c.vy)) for c in state.circles}


class _Impact:
    """The circles of a scene at one instant, in doubles, and the exact engine's laws upon them."""

    def __init__(self, trajectory: Trajectory, places: Velocities, velocities: Velocities) -> None:
        from ...floating.double import DOUBLES  # here, since it loads numpy, which a listing does without
        from ...floating.plain import PlainDecider

        scene = trajectory.scene
        self.least_reach = min((r for c in scene.circles if (r := float(c.r)) > 0), default=1.0)
        self._places = {name: place for place, name in enumerate(scene.ids)}
        self._state = exact_state.ReplayState(scene, DOUBLES)
        self._names = [str(c.id) for c in scene.circles]
        for name, body in zip(self._names, self._state.bodies.values(), strict=True):
            (x, y), (vx, vy) = places[name], velocities[name]
            body.flight = body.flight._replace(x=x, y=y, vx=vx, vy=vy)
        self._decider = PlainDecider(scene, self._state, DOUBLES)

    @property
    def velocities(self) -> Velocities:
        """(vx, vy) of every circle."""
        return {name: b.flight[2:4] for name, b in zip(self._names, self._state.bodies.values(), strict=True)}

    def take(self, group: Sequence[Contact], at_once: bool) -> bool:
        """Applies the impulses of a group in rounds; False if one of them could not have come about."""
        left = list(group)
        while left:
            count = 1 if at_once else 0
            while at_once and count < len(left) and left[count] not in left[:count] and self.closing(left[count]) > 0:
                count += 1
            together, left = left[: max(count, 1)], left[max(count, 1) :]
            if not all(self.closing(pair) > 0 for pair in together):
                return False
            self._state.kick(pushing_contacts([self._link(pair) for pair in together], self._decider.ask))
        return True

    def closing(self, pair: Contact) -> float:
        """Positive while two approach."""
        return -self._link(pair).approach(self._state)

    def _link(self, pair: Contact) -> Touch:
        return touch_of(self._state.scene, self._places[pair.first], self._places[pair.second])
