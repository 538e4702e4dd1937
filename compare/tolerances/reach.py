"""How far an engine that keeps the law must reproduce the true history, and how near its numbers have to be."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import accumulate, takewhile
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...exact.numbers import ball
from ...exact.numbers.ball import double_bounds
from ...scenarios.errors import SceneError
from ...scenarios.numbers.quantity import real
from ...scenarios.settings import positive_count
from ...scenarios.trajectory import StopReason
from ..causes.decision import DecidingNumber, Pairing, RunReader
from ..files.amounts import counted
from ..tangent.impacts import NoTangentMap
from .errors_grown import TIGHT, GrownErrors, Nearby

if TYPE_CHECKING:
    from ...scenarios.numbers.quantity import Real
    from ...scenarios.trajectory import Event, Trajectory
    from ..candidate import Candidate
    from .errors_grown import LocalError

# ----------------------------------------
# How far an engine that keeps the law must reproduce the true history: while every decision's exact margin exceeds its
# errors.

FLOWN = 2.0**-48
"""Share of the way flown so far by which a place in doubles may be off besides."""

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
        tolerance: what rounding errors can move it by.
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
        grown = f"errors allowed by the rounding model may have grown to {self.tolerance:.3g} there"
        return f"{where}; its margin is {self.margin:.3g}, and {grown}"


@dataclass(frozen=True)
class Reach:
    """How far the history is required, and how far off an engine that keeps the law may be on the way.

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
    compared with what all local errors so far can move it by, to the first order.

    Args:
        in_rounds: whether the engine takes the contacts of each instant in the rounds in which the run has them, so
            that no tie is a decision, and errors are carried through it.
    """
    return ErrorWalk(run, local, in_rounds).walked()


class ErrorWalk:
    """Errors carried along a run, event by event; it goes on where a longer run of the same scene is at hand.

    Args: see `reach_of`.
    """

    def __init__(self, run: Trajectory, local: LocalError, in_rounds: bool = False) -> None:
        scene = run.scene
        beyond = {
            "walls of other kinds": bool(scene.other_walls), "segments or polygons that move": bool(scene.moving_solid),
            "restitution 0": scene.restitution.sign() == 0,
            "gravity and something round and fixed (a circle, an arc, an end or a corner)":
                bool(scene.surfaces.pegs or (scene.gravity and scene.arcs)),
            "gravity, and the engine falls by steps": scene.gravity is not None and local.order is not None,
        }  # fmt: skip
        for what in (name for name, there in beyond.items() if there):
            told = f"{scene.name!r}: has {what}, where what rounding may do is not bounded yet"
            raise SceneError(f"{told}; give a span: events=N, or until=T")
        self.run, self.local = run, local
        self.grown = GrownErrors(run, local, in_rounds)
        self.names = self.grown.scene.ids
        self.last: dict[str, int] = {}
        self.reader = RunReader(run)
        self.near = Nearby(self.grown)
        self.found = Reach(0, None, 0, [], [], [])
        self.linear: int | None = None
        self.done, self.come = 0, -1

    def goes_on(self, run: Trajectory, local: LocalError) -> bool:
        """Whether what is done is the beginning of a longer run's walk; if so, that run is taken on."""
        if local != self.local or self.done != len(self.run.events):
            return False
        self.run, self.reader = run, RunReader(run)
        self.grown.take(run)
        return True

    def walked(self) -> Reach:
        """How far the history is required: see `reach_of`."""
        run = self.run
        for index, event in enumerate(run.events[self.done :], start=self.done):
            try:
                limit = self._hindrance(index) or self._decided(index)
            except NoTangentMap as none:
                return self._ended(index, OutOfReach(index, float(event.time), f"{none}"))
            if limit is None:
                late = self._lateness(index)
                try:
                    self.grown.go_through(index)
                except NoTangentMap as none:
                    return self._ended(index, OutOfReach(index, float(event.time), f"{none}"))
                if self.local.order is not None and _tied(self, index) and self.linear is None:
                    self.linear = index  # an engine of steps solves a tie by iterations, of which the last is not told
                self.found.time.append(late)
                self._note_states(index)
            else:
                first = self._earliest(limit, float(event.time)) if self.come == index else limit
                return self._ended(index if first is None else first.event, first)
            self.last |= dict.fromkeys((name for pair in event.contacts for name in pair), index)
            self.done = index + 1
        limit = self._after_the_last()
        return self._ended(len(run.events) if limit is None else limit.event, limit)

    def _ended(self, events: int, limit: OutOfReach | None) -> Reach:
        linear = events if self.linear is None else min(self.linear, events)
        found = self.found
        return Reach(events, limit, linear, found.position[:events], found.velocity[:events], found.time[:events])

    def _hindrance(self, index: int) -> OutOfReach | None:
        """What errors are not carried through: a tie, a reversal, a circle out of play."""
        run, time = self.run, float(self.run.events[index].time)
        if _tied(self, index) and not self.grown.in_rounds:
            told = "several contacts of one circle fall on exactly one instant, and nearby runs part there"
            decided = self._decided(index)
            if decided is not None and decided.time < time:  # on the way there
                return decided
            known = decided is None and self.linear is None
            return OutOfReach(index, time, told, tie=True, late=self._lateness(index) if known else None)
        if run.reversal is not None and run.reversal.after <= index:
            return OutOfReach(index, time, "the velocities are reversed before it, and errors are carried no farther")
        if run.scene.capture and any(float(entry.time) <= time for entry in run.pocketings):
            return OutOfReach(index, time, "a circle has left play before it, and errors are carried no farther")
        return None

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
        found = self.grown.met(index)
        if len(found) == 1 or not _tied(self, index):
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
        self.come = index
        time, columns = float(event.time), self.grown.at(float(event.time))
        tied = {frozenset(pair) for pair in self.grown.met(index)}
        for i, j in self._flown_together(index):
            own = self.near.shift(columns, i, j, time, time)
            for body, partner in ((i, j), (j, i)):
                if body >= self.grown.count or not self.grown.weights[body]:
                    continue
                for other in range(len(self.names)):
                    if other == body or (other != partner and {body, other} in tied):
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
        if own is None and (found := self._on_part(index, columns, body, other, time)) is not None:
            return found
        if self.near.is_line(other):
            turning = _turning(self, index, columns, body, other, time, own is None)
            if own is None or turning is not None:
                return turning
            return self._order(index, columns, body, other, time, own)
        side = self.near.side_of(other)
        d, v = self.near.relative(body, other)
        square, reach = float(v @ v), self.near.reach(body, other)
        if not square or reach <= 0.0:
            return None
        near = time - float(d @ v) / square
        gap = abs(float(d[0] * v[1] - d[1] * v[0])) / math.sqrt(square) - reach
        if own is None:
            return self._hit(index, columns, body, other, near, -gap, time)
        if side is not None and self.near.wait(body, other) is not None:
            return self._order(index, columns, body, other, time, own)
        if side is None and gap < 0 and near > time:
            return self._order(index, columns, body, other, time, own)
        room = self.near.across(columns, body, other, near, time)
        if side is not None and not self.near.may_pass(columns, body, other, near, time):
            return None
        sooner = math.sqrt(2 * reach * 2 * room / square) if reach else 0.0
        since = self.grown.since_both(body, other)
        if since < near and near - sooner < time:
            return self._passed(index, body, other, gap, room, near - sooner)
        return None

    def _passed(self, index: int, i: int, j: int, gap: float, room: float, first: float) -> OutOfReach | None:
        """That one passes another, told by an event: nothing is required from when they may first have met."""
        events = self.run.events
        while index and float(events[index - 1].time) > first - self.local.lateness:
            index -= 1
        time = max(first, float(events[index - 1].time)) if index else first
        return self._told(index, time, i, j, "whether {} passes {}", gap, room, in_doubles=self.near.is_line(j))

    def _on_part(self, index: int, columns: NDArray[np.float64], i: int, j: int, time: float) -> OutOfReach | None:
        """That a circle meets a face between its ends, or an end beside its faces: the normal turns otherwise there."""
        if j in self.near.faces or self.near.side_of(j) is not None:
            margin, room = self.near.foot(columns, i, j, 0.0, time)
        elif j in self.grown.scene.ends:
            late = float(np.abs(self.near.shift(columns, i, j, time, time)).sum())
            margin, room = self.near.beside(i, j), self.near.apart(columns, i, j) + late * self.near.speed(i, j)
        else:
            return None
        room += self.local.lateness * self.near.speed(i, j)
        return self._told(index, time, i, j, "whether {} meets {} between its ends or at one", margin, room)

    def _hit(
        self, index: int, columns: NDArray[np.float64], i: int, j: int, near: float, depth: float, time: float
    ) -> OutOfReach | None:
        """That the two hit at all; and, of an engine with a time step, for long enough to be seen."""
        room = self.near.across(columns, i, j, near, time)
        found = self._told(index, time, i, j, "whether {} hits {}", depth, room)
        if found is None and self.local.lateness:
            stay, least = self.near.stay(i, j, near, time), 2 * self.local.lateness
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
            return self._slides(index, columns, i, j, time) if j in self.near.faces else None
        spare = float(np.abs(own).sum()) + 2 * self.local.lateness
        room = self.near.apart(columns, i, j) + spare * self.near.speed(i, j)
        if self.near.gap(i, j) > room:  # nowhere near each other yet, whenever they meet
            return None
        if j in self.near.faces or self.near.side_of(j) is not None:
            within, doubt = self.near.foot(columns, i, j, wait, time)
            if within < -doubt - self.local.lateness * self.near.speed(i, j):
                return None
        apart = self.near.shift(columns, i, j, time + wait, time) - own
        room = float(np.abs(apart).sum()) + self.local.unit * (time + wait) + 2 * self.local.lateness
        return self._told(index, time, i, j, "whether {} would meet {} first", wait, room, _meeting(self, index, i))

    def _slides(self, index: int, columns: NDArray[np.float64], i: int, j: int, time: float) -> OutOfReach | None:
        """That a circle at the line of a face which flies along it does not meet it."""
        gap, closing = self.near.wall(i, j)
        turned = float(np.hypot(*columns[i][2:]).sum()) + self.local.unit * self.near.speed(i, j)
        if abs(gap) > self.near.apart(columns, i, j) + TIGHT * self.near.scale or abs(closing) > turned:
            return None
        told = f"whether {self.names[i]}, which flies along {self.names[j]}, meets it"
        return OutOfReach(index, time, told, abs(closing), turned)

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
        in_doubles: bool = False,
    ) -> OutOfReach | None:
        """The decision, if its margin does not exceed what errors can move it by.

        Args:
            first: what comes before.
            in_doubles: whether the margin is known in doubles alone, as which part of a thing is met always is.
        """
        flown = float(np.hypot(*self.grown.velocity.T).max()) * time
        if in_doubles or {self.names[i], self.names[j]} & self.grown.parts.keys():
            room = max(room, TIGHT * self.near.scale + FLOWN * flown)
        elif abs(margin) < TIGHT * self.near.scale + FLOWN * flown:
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
        circles = {n for n, k in ((body, i), (partner, j)) if k < self.grown.count and k not in self.grown.scene.ends}
        return Pairing(body, partner, {n: self.last.get(n) for n in (body, partner) if n in circles})

    def _after_the_last(self) -> OutOfReach | None:
        """What is decided between the last event and the end: all that pass each other; for ever, in a quiet run."""
        run, grown = self.run, self.grown
        end = float(run.final_time)
        quiet = run.stop.reason is StopReason.QUIET
        if run.reversal is not None and not quiet:
            return None
        columns = grown.at(end)
        grown.stand_at(end, grown.position)
        grown.position[: len(run.scene.circles)] = run.at(run.final_time).array()[:, :2]
        for i in range(grown.count) if quiet else ():
            for j in range(grown.count, grown.first_side):
                if self.near.pull(i, j):  # it turns back, or comes for certain
                    continue
                moved, turned = self.near.wall(i, j)[1], float(np.hypot(*columns[i][2:]).sum())
                if grown.weights[i] and abs(moved) <= turned:
                    return self._earliest(_drift(self, end, i, j, abs(moved), turned), end, quiet)
        return self._earliest(None, end, quiet)

    def _earliest(self, limit: OutOfReach | None, time: float, quiet: bool = False) -> OutOfReach | None:
        """The earliest that is out of reach: what has been found, or that two pass each other, on flights under way."""
        columns, weights, count = self.grown.at(time), self.grown.weights, self.grown.count
        found = [] if limit is None else [limit]
        sides = range(self.grown.first_side, len(self.names))
        pairs = (
            (i, j)
            for i in range(count)
            for j in (*range(i + 1, count), *(sides if weights[i] else ()))
            if weights[i] or weights[j]
        )
        passing = (self._passing(columns, i, j, time, quiet) for i, j in pairs)
        found.extend(passed for passed in passing if passed is not None)
        walls = ((i, j) for i in range(count) for j in range(count, self.grown.first_side) if weights[i])
        turning = (_turned(self, columns, i, j, time, quiet) for i, j in walls)
        found.extend(turned for turned in turning if turned is not None)
        return min(found, key=lambda one: one.event, default=None)

    def _passing(self, columns: NDArray[np.float64], i: int, j: int, end: float, quiet: bool) -> OutOfReach | None:
        d, v = self.near.relative(i, j)
        other = columns[j] if j < self.grown.count else np.zeros_like(columns[i])
        speed, turned = math.sqrt(float(v @ v)), float(np.hypot(*(other - columns[i])[2:]).sum())
        if quiet and speed <= turned:
            return _drift(self, end, i, j, speed, turned)
        if not speed:
            return None
        near, reach = end - float(d @ v) / speed**2, self.near.reach(i, j)
        if near <= self.grown.since_both(i, j) or (near > end and not quiet):
            return None
        if self.near.side_of(j) is not None and not self.near.may_pass(columns, i, j, near, end):
            return None
        gap = abs(float(d[0] * v[1] - d[1] * v[0])) / speed - reach
        room = self.near.across(columns, i, j, near, end)
        return self._passed(len(self.run.events), i, j, gap, room, near - math.sqrt(4 * reach * room) / speed)


def _tied(walk: ErrorWalk, index: int) -> bool:
    """Whether a circle has several contacts at the instant of an event."""
    movers = [k for contact in walk.run.events[index].contacts for k in walk.grown.movers(contact)]
    return len(movers) != len(set(movers))


def _meeting(walk: ErrorWalk, index: int, body: int) -> Pairing:
    """Whom a circle meets at an event."""
    return walk._pairing(*next(pair for pair in walk.grown.met(index) if body in pair))


def _turning(
    walk: ErrorWalk, index: int, columns: NDArray[np.float64], i: int, j: int, time: float, meets: bool
) -> OutOfReach | None:
    """Of a wall that gravity pulls a circle away from: that it reaches it, or has turned back before it."""
    apex = walk.near.apex(columns, i, j)
    if apex is None:
        return None
    if meets:
        words = "whether {} reaches {}"
        return walk._told(index, time, i, j, words, -apex.gap, apex.room, in_doubles=True)
    if not float(walk.grown.since[i]) < time + apex.wait or apex.wait >= apex.sooner or apex.gap < -apex.room:
        return None
    return walk._passed(index, i, j, apex.gap, apex.room, time + apex.wait - apex.sooner)


def _turned(
    walk: ErrorWalk, columns: NDArray[np.float64], i: int, j: int, end: float, quiet: bool
) -> OutOfReach | None:
    """That a circle has turned back before a wall by the end, which gravity pulls it away from."""
    apex = walk.near.apex(columns, i, j)
    if apex is None or end + apex.wait <= float(walk.grown.since[i]):
        return None
    if apex.wait >= apex.sooner and not quiet:
        return None
    return walk._passed(len(walk.run.events), i, j, apex.gap, apex.room, end + apex.wait - apex.sooner)


def _drift(walk: ErrorWalk, end: float, i: int, j: int, speed: float, room: float) -> OutOfReach:
    what = f"whether {walk.names[i]} and {walk.names[j]} never meet, by their relative speed"
    return OutOfReach(len(walk.run.events), end, what, speed, room)


# ----------------------------------------
# Whether times and places of matched events, and the time of a tie, are near enough to the true ones.

BITS = 512
"""Precision at which a difference of times is taken."""


@dataclass(frozen=True)
class Demand:
    """What is asked of numbers beside the tolerance that rounding errors give.

    Attributes:
        digits: of every event's time: off by no more than half a unit in the last of them.
        atol, rtol: of times and places.

    Raises:
        SceneError: for what asks for nothing, or cannot be asked for.
    """

    digits: int | None = None
    atol: float | None = None
    rtol: float | None = None

    def __post_init__(self) -> None:
        positive_count("digits", self.digits)
        for key, value in (("atol", self.atol), ("rtol", self.rtol)):
            number = isinstance(value, int | float) and not isinstance(value, bool)
            if value is not None and not (number and 0 <= value < math.inf):
                raise SceneError(f"{key} = {value!r}: must be a finite number from 0")

    def told(self, places: bool) -> list[str]:
        """In words; `places`: whether the engine tells where circles are."""
        words = [] if self.digits is None else [f"{self.digits} digits of every event's time"]
        if self.atol is not None or self.rtol is not None:
            what = "times and places" if places else "times"
            words.append(f"{what} within {self.atol or 0:g} + {self.rtol or 0:g} times the true value")
        return words

    def room(self, value: float) -> float:
        """What `atol` and `rtol` grant a value."""
        if self.atol is None and self.rtol is None:
            return math.inf
        return (self.atol or 0.0) + (self.rtol or 0.0) * abs(value)


@dataclass(frozen=True)
class Matched:
    """One circle's meeting in both runs: the reference's event, and the candidate's last that was matched with it."""

    body: str
    mine: int
    theirs: int


def number_off(
    reference: Trajectory, candidate: Candidate, demand: Demand, reach: Reach | None, places: bool
) -> str | None:
    """The first number that is too far off, in words; None if there is none.

    Args:
        reference: the exact run with which the candidate is aligned.
        reach: whose tolerances are required too.
        places: whether the engine tells where circles are.
    """
    name, run = candidate.engine, candidate.trajectory
    gravity = reference.scene.gravity or (0, 0)
    latest = latest_so_far(run.events)
    for pair in _pairs(reference, candidate):
        event = reference.events[pair.mine]
        got = run.events[pair.theirs].time
        off, time = difference(event.time, got), float(event.time)
        where = f"{name}: event {pair.mine} ({' - '.join(event.contacts[0])}): time"
        known = reach is not None and pair.mine < reach.linear
        for room, why in _time_rooms(demand, reach if known else None, pair.mine, time):
            if off > room:
                shown, right = max(DIGITS, demand.digits or 0), digits_left(off, time)
                return (
                    f"{where} = {float(got)!r} where it should be {event.time.digits(shown)}: off by {off:.3g}, "
                    f"{room:.3g} is {why}; {counted(right, 'digit')} {'is' if right == 1 else 'are'} right"
                )
        then = latest[pair.theirs].time
        if not places or _is_met_again(run.events, pair.theirs, pair.body, float(then)):
            continue
        true, told = reference.circle(pair.body, event.time), run.circle(pair.body, then)
        lag = float(then) - time
        hx, hy = (lag * float(part) / 2 for part in gravity)  # both at one time, if need be by the law's flight
        apart = math.hypot(
            float(told.x) - lag * (float(told.vx) - hx) - float(true.x),
            float(told.y) - lag * (float(told.vy) - hy) - float(true.y),
        )
        turned = math.hypot(float(told.vx) - 2 * hx - float(true.vx), float(told.vy) - 2 * hy - float(true.vy))
        size, speed = math.hypot(float(true.x), float(true.y)), math.hypot(float(true.vx), float(true.vy))
        rooms = [("place", apart, demand.room(size), "asked for")]
        if reference.scene.reverse_after == pair.mine + 1:
            turned = 0.0  # the velocities are negated at that very instant: a time tells before or after
        if reach is not None and known:
            near = reach.position[pair.mine].get(pair.body, math.inf) + TOLD * (size + speed * time)
            slow = reach.velocity[pair.mine].get(pair.body, math.inf) + TOLD * speed
            rooms = [("place", apart, near, HONEST), ("velocity", turned, slow, HONEST), *rooms]
        for what, value, room, why in rooms:
            if value > room:
                return (
                    f"{name}: event {pair.mine} (t = {time:.9g}): the {what} of {pair.body} after it is off by "
                    f"{value:.3g}, {room:.3g} is {why}"
                )
    return None


def _is_met_again(events: Sequence[Event], number: int, body: str, time: float) -> bool:
    """Whether a circle has another event of a run by a time, after that of a number: its state between is not told."""
    later = takewhile(lambda k: float(events[k].time) <= time, range(number + 1, len(events)))
    return any(body in pair for k in later for pair in events[k].contacts)


def tie_off(reference: Trajectory, candidate: Candidate, tie: OutOfReach) -> str | None:
    """The first meeting of a tie that is too far off in time, in words; None if there is none, or nothing is known.

    Whatever order its impulses are taken in, circles fly freely up to the first of them: it is at the tie's time.
    """
    if tie.late is None:
        return None
    run, time, room = candidate.trajectory, float(reference.events[tie.event].time), tie.late + TOLD * tie.time
    for cluster in _clusters(reference, tie.event):
        walks = candidate.alignment.walks
        last = {body: max((c for r, c in walks[body].pairs if r < tie.event), default=-1) for body in cluster}
        later = (e for e in run.events if any(e.index > last.get(n, e.index) for pair in e.impulses for n in pair))
        first = next(later, None)
        told = f"{candidate.engine}: event {tie.event} ({', '.join(cluster)}): the first meeting of its tie"
        should = f"where it should be {reference.events[tie.event].time.digits(DIGITS)}"
        if first is None:
            if run.stop.reason is StopReason.QUIET or float(run.final_time) > time + room:
                return f"{told} is missing {should}"
        elif (off := difference(reference.events[tie.event].time, first.time)) > room:
            return f"{told} is at {float(first.time)!r} {should}: off by {off:.3g}, {room:.3g} is {HONEST}"
    return None


def _clusters(reference: Trajectory, event: int) -> list[tuple[str, ...]]:
    """The movable circles of an event, those that contacts join together, in scene order."""
    movable = [str(c.id) for c in reference.scene.circles if not c.fixed]
    clusters = [{body} for body in movable if any(body in pair for pair in reference.events[event].contacts)]
    for pair in reference.events[event].contacts:
        joined = [each for each in clusters if each.intersection(pair)]
        clusters = [each for each in clusters if each not in joined] + [set[str]().union(*joined)]
    return [tuple(body for body in movable if body in each) for each in clusters]


HONEST = "what errors allowed by the rounding model can grow to"

DIGITS = 17

TOLD = 2.0**-50
"""Times and states are told in doubles, whatever an engine counts in: a few roundings of each."""


def latest_so_far(events: Sequence[Event]) -> list[Event]:
    """For each event, the latest of all up to it: times may go back by rounding, and a state is left by all of them."""
    return [*accumulate(events, lambda one, other: other if float(other.time) >= float(one.time) else one)]


def _pairs(reference: Trajectory, candidate: Candidate) -> Iterator[Matched]:
    """Each circle's meetings that are matched within the span, by event."""
    total, found = len(reference.events), {}
    for body, walked in candidate.alignment.walks.items():
        for mine, theirs in walked.pairs:
            if mine < total:
                found[mine, body] = theirs
    for (mine, body), theirs in sorted(found.items()):
        yield Matched(body, mine, theirs)


def _time_rooms(demand: Demand, reach: Reach | None, event: int, time: float) -> Iterator[tuple[float, str]]:
    if demand.digits is not None and time:
        yield 0.5 * 10.0 ** (math.floor(math.log10(time)) - demand.digits + 1), f"{demand.digits} digits"
    yield demand.room(time), "asked for"
    if reach is not None:
        yield reach.time[event] + TOLD * time, HONEST


def difference(one: Real, other: Real) -> float:
    """How far two times are apart; doubles of their difference, not the difference of their doubles.

    >>> from truebreak.scenarios import Quantity
    >>> difference(Quantity.of("1 + 10**-40"), Quantity.of(1))
    1e-40
    """
    with ball.precision(BITS):
        return float(abs(real(one).ball(BITS) - real(other).ball(BITS)).mid())


def digits_left(off: float, value: float) -> int:
    """How many digits of a number are right that is off by so much.

    >>> digits_left(1e-6, 12.5), digits_left(3.0, 2.0)
    (7, 0)
    """
    if not off:
        return DIGITS
    return max(0, math.floor(math.log10(abs(value) / off / 2)) + 1) if value else 0
