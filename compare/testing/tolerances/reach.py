"""How far an honest engine must tell the true history: while the exact margin of every decision exceeds its errors."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ....exact.numbers.ball import double_bounds
from ....scenarios.trajectory import StopReason
from ...causes.decision import DecidingNumber, Pairing
from ...causes.reader import RunReader
from ...tangent.impacts import NoTangentMap
from .errors_grown import GrownErrors
from .nearby import Nearby

if TYPE_CHECKING:
    from ....scenarios.trajectory import Trajectory
    from .local_error import LocalError

TIGHT = 2.0**-36
"""A margin in doubles is off by some 2**-50 of the scene's measures; one of less than this share of them is taken from
the exact run instead."""

LINEAR = 16.0
"""Errors this many times smaller than what they decide bend no flight by much: beyond that the first order tells
whether a decision may be another, but no longer how far off a circle is."""


MOST_CIRCLES = 256
"""Circles up to which local errors are carried along: four columns a circle, and eight an event."""


@dataclass(frozen=True)
class OutOfReach:
    """The first decision that errors of the engine's size may change.

    Attributes:
        event: the reference's event by which it is made; the number of events, if after the last.
        time: when.
        told: the decision in words.
        margin: exact, in units of time or length; None where the instant has no tangent map.
        tolerance: what honest errors can move it by.
        tie: whether it is an exact tie of one circle's contacts, whose order is a choice.
        late: by how much the first meeting of each of a tie's clusters may be off; None where this is not known.
    """

    event: int
    time: float
    told: str
    margin: float | None = None
    tolerance: float | None = None
    tie: bool = False
    late: float | None = None

    def __str__(self) -> str:
        if self.margin is None:
            return f"event {self.event} (t = {self.time:.9g}): {self.told}"
        where = f"event {self.event} (t = {self.time:.9g}): {self.told}"
        return (
            f"{where}; its margin is {self.margin:.3g}, and honest errors may have grown to {self.tolerance:.3g} there"
        )


@dataclass(frozen=True)
class Reach:
    """How far the history is required, and how far off an honest engine may be on the way.

    Attributes:
        events: events of the reference that are required.
        limit: the first decision out of reach; None if there is none in the reference's run.
        linear: events up to which errors are small beside every margin, so that the first order tells their size: as
            far as that, times and places are required.
        position, velocity: for each required event, by circle, how far off it may be as the event leaves it.
        time: for each required event, how far off its time may be.
    """

    events: int
    limit: OutOfReach | None
    linear: int
    position: list[dict[str, float]] = field(repr=False)
    velocity: list[dict[str, float]] = field(repr=False)
    time: list[float] = field(repr=False)

    @property
    def whole(self) -> bool:
        """Whether all of the reference's run is required."""
        return self.limit is None


def reach_of(run: Trajectory, local: LocalError, in_rounds: bool = False) -> Reach:
    """Walks along a certified run, decision by decision, until one is out of reach.

    At each event, for each circle that takes part: its hit (how deep, if it is with a circle), every other thing that
    it would have met next (how much later), and everything that it has passed since (how far away). Each margin is
    held against what all local errors so far can move it by, to the first order.

    Args:
        in_rounds: whether the engine takes the contacts of each instant in the rounds in which the run has them, so
            that no tie is a decision, and errors are carried through it.
    """
    return _Walk(run, local, in_rounds).walked()


class _Walk:
    def __init__(self, run: Trajectory, local: LocalError, in_rounds: bool) -> None:
        self.run, self.local = run, local
        self.grown = GrownErrors(run, local, in_rounds)
        self.names = run.scene.ids
        self.last: dict[str, int] = {}
        self.reader = RunReader(run)
        self.near = Nearby(self.grown)
        self.found = Reach(0, None, 0, [], [], [])
        self.linear: int | None = None

    def walked(self) -> Reach:
        run = self.run
        for index, event in enumerate(run.events):
            limit = self._hindrance(index) or self._decided(index)
            if limit is None:
                late = self._lateness(index)
                try:
                    self.grown.go_through(index)
                except NoTangentMap as none:
                    return self._ended(index, OutOfReach(index, float(event.time), f"{none}"))
                if self.local.order is not None and self._tied(index) and self.linear is None:
                    self.linear = index  # an engine of steps solves a tie by iterations, of which the last is not told
                self.found.time.append(late)
                self._note_states(index)
            else:
                return self._ended(index, limit)
            self.last |= dict.fromkeys((name for pair in event.contacts for name in pair), index)
        return self._ended(len(run.events), self._after_the_last())

    def _ended(self, events: int, limit: OutOfReach | None) -> Reach:
        linear = events if self.linear is None else min(self.linear, events)
        return Reach(events, limit, linear, self.found.position, self.found.velocity, self.found.time)

    def _hindrance(self, index: int) -> OutOfReach | None:
        """What errors are not carried through: a tie, a reversal, a circle out of play."""
        run, time = self.run, float(self.run.events[index].time)
        if self._tied(index) and not self.grown.in_rounds:
            told = "several contacts of one circle fall on exactly one instant, and nearby runs part there"
            known = self._decided(index) is None and self.linear is None
            return OutOfReach(index, time, told, tie=True, late=self._lateness(index) if known else None)
        if run.reversal is not None and run.reversal.after <= index:
            return OutOfReach(index, time, "the velocities are reversed before it, and errors are carried no farther")
        if run.scene.capture and any(float(entry.time) <= time for entry in run.pocketings):
            return OutOfReach(index, time, "a circle has left play before it, and errors are carried no farther")
        return None

    def _tied(self, index: int) -> bool:
        """Whether a circle has several contacts at the instant of an event."""
        movers = [k for contact in self.run.events[index].contacts for k in self.grown.movers(contact)]
        return len(movers) != len(set(movers))

    def _lateness(self, index: int) -> float:
        """How far off an event's time may be."""
        time, worst = float(self.run.events[index].time), 0.0
        columns = self.grown.at(time)
        for i, j in self._flown_together(index):
            bent = self.near.bent(columns, i, j)
            worst = max(worst, float(np.abs(self.near.shift(columns, i, j, time, time)).sum()) + bent)
        return worst + self.local.unit * time + self.local.lateness

    def _flown_together(self, index: int) -> list[tuple[int, int]]:
        """The contacts of an event, without those that others' impulses at the same instant lead to."""
        contacts = self.run.events[index].contacts
        found = [(self.grown.places[first], self.grown.places[second]) for first, second in contacts]
        if len(found) == 1 or not self._tied(index):
            return found
        return [(i, j) for i, j in found if self.reader.hit_time(self._pairing(i, j)) is not None]

    def _note_states(self, index: int) -> None:
        event = self.run.events[index]
        time, tolerances = float(event.time), {}
        for contact in event.contacts:
            for k in self.grown.movers(contact):
                tolerances[self.names[k]] = self.grown.tolerance(k, time)
        self.found.position.append({name: position for name, (position, _) in tolerances.items()})
        self.found.velocity.append({name: velocity for name, (_, velocity) in tolerances.items()})

    # -- decisions

    def _decided(self, index: int) -> OutOfReach | None:
        """The first of the decisions by an event that is out of reach."""
        event = self.run.events[index]
        self.grown.come_to(index)
        time, columns = float(event.time), self.grown.at(float(event.time))
        tied = {frozenset(contact) for contact in event.contacts}
        for i, j in self._flown_together(index):
            own = self.near.shift(columns, i, j, time, time)
            for body, partner in ((i, j), (j, i)):
                if body >= self.grown.count or not self.grown.weights[body]:
                    continue
                for other in range(len(self.names)):
                    if other == body or (other != partner and {self.names[body], self.names[other]} in tied):
                        continue
                    found = self._one(index, columns, body, other, time, own if other != partner else None)
                    if found is not None:
                        return found
        return None

    def _one(
        self,
        index: int,
        columns: NDArray[np.float64],
        body: int,
        other: int,
        time: float,
        own: NDArray[np.float64] | None,
    ) -> OutOfReach | None:
        """One decision by an event: on the pair that meets (`own` None), or on another thing near the body."""
        if other >= self.grown.count:
            return None if own is None else self._order(index, columns, body, other, time, own)
        d, v = self.near.relative(body, other)
        square, reach = float(v @ v), float(self.grown.radii[body] + self.grown.radii[other])
        if not square:
            return None
        near = time - float(d @ v) / square
        gap = abs(float(d[0] * v[1] - d[1] * v[0])) / math.sqrt(square) - reach
        if own is None:
            return self._hit(index, columns, body, other, near, -gap, time)
        if gap < 0:
            return self._order(index, columns, body, other, time, own) if near > time else None
        room = self.near.across(columns, body, other, near, time)
        sooner = math.sqrt(2 * reach * 2 * room / square) if reach else 0.0
        since = max(float(self.grown.since[body]), float(self.grown.since[other]))
        if since < near and near - sooner < time:
            return self._told(index, time, body, other, "whether {} passes {}", gap, room)
        return None

    def _hit(
        self, index: int, columns: NDArray[np.float64], i: int, j: int, near: float, depth: float, time: float
    ) -> OutOfReach | None:
        """That the two hit at all; and, of an engine with a time step, for long enough to be seen."""
        room = self.near.across(columns, i, j, near, time)
        found = self._told(index, time, i, j, "whether {} hits {}", depth, room)
        if found is None and self.local.lateness:
            stay, least = 2 * (near - time), 2 * self.local.lateness
            if stay <= least:
                return OutOfReach(
                    index, time, f"whether a step ends while {self.names[i]} is in {self.names[j]}", stay, least
                )
        return found

    def _order(
        self, index: int, columns: NDArray[np.float64], i: int, j: int, time: float, own: NDArray[np.float64]
    ) -> OutOfReach | None:
        """That a pair which would meet later does not meet first."""
        wait = self.near.wait(i, j)
        if wait is None:
            return None
        spare = float(np.abs(own).sum()) + 2 * self.local.lateness
        room = self.near.apart(columns, i, j) + spare * self.near.speed(i, j)
        if self.near.gap(i, j) > room:  # nowhere near each other yet, whenever they meet
            return None
        apart = self.near.shift(columns, i, j, time + wait, time) - own
        room = float(np.abs(apart).sum()) + self.local.unit * (time + wait) + 2 * self.local.lateness
        return self._told(index, time, i, j, "whether {} would meet {} first", wait, room, self._meeting(index, i))

    def _meeting(self, index: int, body: int) -> Pairing:
        """Whom a circle meets at an event."""
        name = self.names[body]
        contact = next(pair for pair in self.run.events[index].contacts if name in pair)
        return self._pairing(*(self.grown.places[n] for n in contact))

    def _told(
        self,
        index: int,
        time: float,
        i: int,
        j: int,
        words: str,
        margin: float,
        room: float,
        first: Pairing | None = None,
    ) -> OutOfReach | None:
        """The decision, if its margin does not exceed what errors can move it by; `first` is what comes before."""
        if abs(margin) < TIGHT * self.near.scale:
            own = self._pairing(i, j)
            value = self.reader.value(
                DecidingNumber("hit", own) if first is None else DecidingNumber("order", first, own)
            )
            if value is not None:
                margin = min(map(abs, double_bounds(value)))
        if self.linear is None and abs(margin) < LINEAR * room:
            self.linear = index
        if abs(margin) > room:
            return None
        return OutOfReach(index, time, words.format(self.names[i], self.names[j]), abs(margin), room)

    def _pairing(self, i: int, j: int) -> Pairing:
        body, partner = self.names[i], self.names[j]
        anchors = {n: self.last.get(n) for n in (body, partner) if self.grown.places[n] < self.grown.count}
        return Pairing(body, partner, anchors)

    def _after_the_last(self) -> OutOfReach | None:
        """What is decided between the last event and the end: all that pass each other; for ever, in a quiet run."""
        run, grown = self.run, self.grown
        end = float(run.final_time)
        quiet = run.stop.reason is StopReason.QUIET
        if run.stop.reason is StopReason.EVENTS or (run.reversal is not None and not quiet):
            return None
        columns = grown.at(end)
        grown.position = run.at(run.final_time).array()[:, :2]
        for i in range(grown.count):
            for j in range(i + 1, len(self.names)):
                if j >= grown.count:
                    moved, turned = self.near.wall(i, j)[1], float(np.hypot(*columns[i][2:]).sum())
                    if quiet and grown.weights[i] and abs(moved) <= turned:
                        return self._drift(end, i, j, abs(moved), turned)
                    continue
                if not (grown.weights[i] or grown.weights[j]):
                    continue
                found = self._passing(columns, i, j, end, quiet)
                if found is not None:
                    return found
        return None

    def _passing(self, columns: NDArray[np.float64], i: int, j: int, end: float, quiet: bool) -> OutOfReach | None:
        d, v = self.near.relative(i, j)
        speed, turned = math.sqrt(float(v @ v)), float(np.hypot(*(columns[j] - columns[i])[2:]).sum())
        if quiet and speed <= turned:
            return self._drift(end, i, j, speed, turned)
        if not speed:
            return None
        near = end - float(d @ v) / speed**2
        since = max(float(self.grown.since[i]), float(self.grown.since[j]))
        if near <= since or (near > end and not quiet):
            return None
        gap = abs(float(d[0] * v[1] - d[1] * v[0])) / speed - float(self.grown.radii[i] + self.grown.radii[j])
        room = self.near.across(columns, i, j, near, end)
        return self._told(len(self.run.events), end, i, j, "whether {} passes {}", gap, room)

    def _drift(self, end: float, i: int, j: int, speed: float, room: float) -> OutOfReach:
        what = f"whether {self.names[i]} and {self.names[j]} never meet, by their relative speed"
        return OutOfReach(len(self.run.events), end, what, speed, room)
