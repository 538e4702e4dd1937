"""Whether times and places of matched events, and the time of a tie, are near enough to the true ones."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import accumulate
from typing import TYPE_CHECKING

from ....exact.numbers import ball
from ....scenarios.errors import SceneError
from ....scenarios.numbers.quantity import real
from ....scenarios.settings import positive_count
from ....scenarios.trajectory import StopReason
from ...report.counting import counted

if TYPE_CHECKING:
    from ....scenarios.numbers.quantity import Real
    from ....scenarios.trajectory import Event, Trajectory
    from ...candidate import Candidate
    from .reach import OutOfReach, Reach

BITS = 512
"""Precision at which a difference of times is taken."""


@dataclass(frozen=True)
class Demand:
    """What is asked of numbers beside the tolerance that honest errors give.

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

    @property
    def told(self) -> list[str]:
        """In words."""
        words = [] if self.digits is None else [f"{self.digits} digits of every event's time"]
        if self.atol is not None or self.rtol is not None:
            words.append(f"times and places within {self.atol or 0:g} + {self.rtol or 0:g} times the true value")
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
        if not places:
            continue
        then = latest[pair.theirs].time
        true, told = reference.at(event.time)[pair.body], run.at(then)[pair.body]
        lag = float(then) - time
        apart = math.hypot(
            float(told.x) - lag * float(told.vx) - float(true.x), float(told.y) - lag * float(told.vy) - float(true.y)
        )
        turned = math.hypot(float(told.vx) - float(true.vx), float(told.vy) - float(true.vy))
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


HONEST = "what honest errors can grow to"

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
