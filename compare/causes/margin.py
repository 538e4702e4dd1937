"""The margin of a decision, beside the engine's error: how close it was, and how many bits decide it."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from ...exact.laws.formulas import pair_approach, pair_discriminant
from ...exact.numbers import ball
from ...exact.replay.ball_state import BallState
from ...exact.replay.steps import Flip, Step
from ...exact.results.motion import motion_of, steps_through
from ...exact.simulation.limits import run_limits
from ...exact.simulation.loop import Loop
from ...floating.plain.decider import PlainDecider
from ...scenarios.trajectory import StopReason
from ..deadline import NO_TIME, OutOfTime, time_limit
from .decision import MOST_BITS, DecidingNumber
from .reader import FlightBalls, RunReader

if TYPE_CHECKING:
    from ...scenarios.numbers.quantity import Quantity
    from ...scenarios.scene import Scene
    from ...scenarios.trajectory import OnProgress, Stop, Trajectory
    from .decision import OwnFlight, Pairing
    from .laboratory import Laboratory

Bounds = tuple[float, float]
"""Doubles around a number that is known exactly."""


@dataclass(frozen=True)
class BitsEnough:
    """The fewest bits that decide what a divergence turns on.

    Attributes:
        bits: them; None where none was found.
        short: one less, which was seen not to do; None where there is none so few.
        by: what was seen to decide with so many bits: a whole run in balls, or the log of the exact run carried out in
            balls, of which no decision but the one in question is asked.
        told: where no number of bits is given, why.
    """

    bits: int | None = None
    short: int | None = None
    by: Literal["run", "replay"] | None = None
    told: str = ""


@dataclass(frozen=True)
class Margin:
    """How close the decision was in the exact motion, and how far off the engine was by then.

    Attributes:
        gap: the time between the two meetings, each taken as if nothing hindered it; None for hit or miss.
        distance: for hit or miss, the least distance of the surfaces in free flight, negative for the depth of a hit;
            for an order, how far apart the pair that comes second is when the first one meets.
        ulps: `gap` in units of a double's spacing at that time.
        error: the largest distance between the engine's place and the exact one of the circles in question, at the
            earlier of the two events.
        growth: bits an event by which a small error grows along the exact run up to there; None if not known.
        enough: the bits that would have been enough.
        cut: whether the user's seconds were over before all of this was measured.
    """

    gap: Bounds | None
    distance: Bounds | None
    ulps: float | None
    error: float | None = None
    growth: float | None = None
    enough: BitsEnough = BitsEnough()
    cut: bool = False

    @property
    def ratio(self) -> float | None:
        """The error over the distance: above about 1, the error explains the divergence."""
        if self.error is None or self.distance is None:
            return None
        middle = abs(self.distance[0] + self.distance[1]) / 2
        return self.error / middle if middle else math.inf if self.error else None


def margin_of(lab: Laboratory) -> Margin:
    """The margin of a candidate's divergence: as much of it as the user's seconds leave time for."""
    from ..tangent.growth import error_growth

    divergence = lab.divergence
    gap = distance = None
    ulps: float | None = None
    if lab.decision is not None and lab.margin is not None:
        if lab.decision.kind == "hit":
            distance = ball.double_bounds(lab.margin)
        else:
            gap = (0.0, 0.0) if lab.tied else ball.double_bounds(lab.margin)
            ulps = max(abs(gap[0] + gap[1]) / 2, 0.0) / math.ulp(max(abs(divergence.time), math.ulp(0.0)))
            distance = lab.tried(lambda: _second_gap(lab), None)
    elif lab.decision is None and lab.tied:
        gap = distance = (0.0, 0.0)
    error = lab.tried(lambda: _error(lab), None)
    growth = lab.tried(lambda: error_growth(lab.reference, divergence.expected_event), None)
    enough = lab.tried(lambda: bits_enough(lab), BitsEnough(told=NO_TIME))
    return Margin(gap, distance, ulps, error, growth, enough, cut=enough.told == NO_TIME)


def _second_gap(lab: Laboratory) -> Bounds | None:
    """How far the pair that meets second is apart when the first one meets."""
    assert lab.decision is not None and lab.decision.second is not None
    if lab.tied:
        return 0.0, 0.0
    one, other = lab.decision.first, lab.decision.second
    with ball.precision(4096):
        times = lab.truth.hit_time(one, 1024), lab.truth.hit_time(other, 1024)
        if times[0] is None or times[1] is None:
            return None
        later, time = (other, times[0]) if ball.sign_of(times[1] - times[0]) != -1 else (one, times[1])
        found = lab.truth.gap_at(later, time, 1024)
    return None if found is None else ball.double_bounds(found)


def _error(lab: Laboratory) -> float | None:
    """The engine's position error at the earlier of the two events, over the circles in question."""
    run, reference, time = lab.candidate.trajectory, lab.reference, lab.divergence.time
    last = min(float(run.final_time), float(reference.final_time), time)
    if not last > 0:
        return 0.0 if lab.divergence.time == 0 else None
    at = math.nextafter(last, 0.0)
    names = {lab.divergence.body, lab.divergence.expected, lab.divergence.got}
    rows = [k for k, c in enumerate(lab.study.scene.circles) if c.id in names and not c.fixed]
    mine, theirs = reference.sample([at])[0], run.sample([at])[0]
    return max((math.dist(mine[k][:2], theirs[k][:2]) for k in rows), default=None)


# -- the fewest bits that decide it, found by runs and replays in balls

FEWEST, MOST = 24, 1 << 17
"""The bits that are tried: from those of a single on."""

MOST_EVENTS = 1 << 11
"""Events of the longest run that is tried: with a dozen circles a fourth of a second, for each of about 15 runs."""

MOST_WORK = 1 << 26
"""Steps of a log times bits (`STEP_BITS` at least) of one replay: about a second, for each of about 15."""

STEP_BITS = 512
"""Up to so many bits a step in balls takes the same time."""

FARTHER = 8
"""A run that does not do with this many times the bits of a replay is not stopped by a lack of bits."""


def bits_enough(lab: Laboratory) -> BitsEnough:
    """The fewest bits that decide what a divergence turns on; one bit less is tried too, and does not.

    The log of the exact run is carried out in balls of so many bits, and the decision asked of them. Then a whole run
    in balls, which is told nothing beforehand, is asked to come past it; where none does, since an earlier instant is
    an exact tie, or since it takes too many events, it is the replay that is told.

    Raises:
        OutOfTime: if the user's seconds are over.
    """
    study, decision = lab.study, lab.decision
    if lab.tied:
        return BitsEnough(told="no number of bits tells an exact zero")
    if decision is None or lab.margin is None:
        return BitsEnough(told="not searched: no contact can be named")
    motion = motion_of(lab.reference)
    if motion is None:
        return BitsEnough(told=f"not searched: {study.truth.name} keeps no log that balls could carry out")
    sign = ball.sign_of(lab.margin)
    if sign == 0:
        return BitsEnough(told="no number of bits tells an exact zero")
    if sign is None:
        return BitsEnough(told=f"none of up to {MOST_BITS:,} bits decide it, and it is not proved to be zero")
    most = min(MOST, MOST_WORK // max(len(motion.log.steps), 1))
    if most < STEP_BITS:
        return BitsEnough(told=f"not searched: the run has more than {MOST_WORK // STEP_BITS:,} steps")
    replayed = fewest(lambda bits: _replays(lab, decision, bits), FEWEST, most)
    if replayed is None:
        return BitsEnough(told=f"none of up to {most:,} bits do")
    bits, short = replayed
    if lab.divergence.expected_event < MOST_EVENTS:
        ran = fewest(lambda bits: _runs(lab, bits), bits, FARTHER * bits)
        if ran is not None:
            return BitsEnough(*ran, "run")
    return BitsEnough(bits, short, "replay")


def _replays(lab: Laboratory, decision: DecidingNumber, bits: int) -> bool:
    """Whether the log in balls of so many bits tells the decision."""
    lab.check_time()
    return Replay(lab.reference, decision, bits, lab.turned).decides


def _runs(lab: Laboratory, bits: int) -> bool:
    """Whether a run in balls of so many bits comes past the divergence."""
    study, event = lab.study, lab.divergence.expected_event
    until = max(study.until_event(event), study.past(lab.divergence.time))
    with time_limit(study.watch.left(study.share), study.watch.seconds) as watch:
        done, stop = BallRun(bits).run(study.scene, until, event + 1, watch.watched(lab.progress))
    if stop.reason is StopReason.BUDGET:
        raise OutOfTime(stop.message)
    if stop.reason is StopReason.INTERRUPTED:
        raise KeyboardInterrupt
    return done > event or stop.reason is not StopReason.UNDECIDED


def fewest(does: Callable[[int], bool], guess: int, most: int) -> tuple[int, int | None] | None:
    """The fewest bits that do, and one less, which do not; None if as many as `most` do not.

    Found by doubling from a guess, or halving, and then by bisection, so that both are tried.

    >>> fewest(lambda bits: bits >= 77, 24, 1000), fewest(lambda bits: True, 99, 1000)
    ((77, 76), (24, None))
    """
    low, high = None, guess
    while not does(high):
        if high >= most:
            return None
        low, high = high, min(2 * high, most)
    while low is None:
        if high <= FEWEST:
            return high, None
        tried = max(high - 1 if high == guess else high // 2, FEWEST)
        if does(tried):
            high = tried
        else:
            low = tried
    while high - low > 1:
        middle = (low + high) // 2
        if does(middle):
            high = middle
        else:
            low = middle
    return high, low


@dataclass(frozen=True)
class BallRun:
    """The event loop in balls of a fixed number of bits, each sign taken where a ball tells it.

    Where one does not, the run stops: every event that it comes to is certain.
    """

    bits: int

    def run(
        self, scene: Scene, until: Quantity | float | None, events: int, progress: OnProgress | None = None
    ) -> tuple[int, Stop]:
        """How many events it comes to, and why it ends.

        >>> from truebreak.scenarios import Circle, Scene
        >>> scene = Scene([Circle(0, 0, vx=1), Circle(4, 1), Circle(4, "-1 - 1/10**40")])
        >>> [BallRun(bits).run(scene, 9, 5)[0] for bits in (128, 256)]
        [0, 2]
        """
        with ball.precision(self.bits):
            decider = PlainDecider(scene, BallState(scene), ball.BALLS)
            stop = Loop(scene, decider, run_limits(scene, until, events), progress).run()
        return len(decider.history.records), stop


class Replay(RunReader):
    """Reads a decision off the exact run's log, carried out in balls of a fixed number of bits.

    No decision of the history is asked again: only the one in question.

    Args:
        run: the exact run.
        decision: what is asked.
        bits: of the balls.
        turned_after: see `RunReader`.
    """

    def __init__(self, run: Trajectory, decision: DecidingNumber, bits: int, turned_after: int | None) -> None:
        super().__init__(run, turned_after=turned_after)
        self.decision = decision
        self.bits = bits
        self._numbers = self._replayed()

    def _replayed(self) -> Mapping[tuple[str, int], FlightBalls]:
        """t, x, y, vx, vy of each circle in question, after the steps of its last event."""
        steps, place = steps_of(self.run), {str(c.id): k for k, c in enumerate(self.run.scene.circles)}
        wanted: dict[int, set[str]] = {}
        for pairing in self.decision.pairings:
            for name in (pairing.body, pairing.partner):
                if name in place:
                    wanted.setdefault(self._upto(pairing, name), set()).add(name)
        found: dict[tuple[str, int], FlightBalls] = {}
        with ball.precision(self.bits):
            state = BallState(self.run.scene)
            for done in range(max(wanted) + 1):
                for name in wanted.get(done, ()):
                    flight = state.bodies[place[name]].flight
                    found[name, done] = (flight.t, flight.x, flight.y, flight.vx, flight.vy)
                if done < len(steps):
                    state.do(steps[done])
        return found

    def _upto(self, pairing: Pairing, name: str) -> int:
        """How many steps lead to a circle's flight."""
        if self._turned(pairing):
            return 1 + next(k for k, step in enumerate(steps_of(self.run)) if isinstance(step, Flip))
        anchor = pairing.anchors.get(name)
        return 0 if anchor is None else steps_through(self.run.events[anchor])

    def numbers(self, pairing: Pairing, name: str, bits: int) -> FlightBalls:
        """As `RunReader.numbers`, at the replay's bits."""
        return self._numbers[name, self._upto(pairing, name)]

    def _proves(self, is_zero: Callable[[OwnFlight, OwnFlight, Quantity], bool], pairing: Pairing) -> bool:
        """Balls do not tell."""
        return False

    @property
    def decides(self) -> bool:
        """Whether the balls tell the answer, and all that it rests on: that the circles come nearer, and meet."""
        with ball.precision(self.bits):
            if not all(self._clear(pairing) for pairing in self.decision.pairings):
                return False
            value = self._value(self.decision, self.bits)
            return value is not None and ball.sign_of(value) in (-1, 1)

    def _clear(self, pairing: Pairing) -> bool:
        if self.is_wall(pairing):
            told = self._wall(pairing, self.bits)
            return told is not None and ball.sign_of(told[2]) in (-1, 1)
        relative = self._relative(pairing, self.bits)
        assert relative is not None
        _, dx, dy, vx, vy, reach = relative
        nearer = ball.sign_of(pair_approach(dx, dy, vx, vy))
        if self.decision.kind == "hit":
            return nearer is not None
        return nearer == -1 and ball.sign_of(pair_discriminant(dx, dy, vx, vy, reach)) == 1


def steps_of(run: Trajectory) -> Sequence[Step]:
    """The log of an exact run."""
    motion = motion_of(run)
    assert motion is not None
    return motion.log.steps
