"""The fewest bits that decide what a divergence turns on, found by runs and replays in balls."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from ...exact.exact_motion import motion_of
from ...exact.numbers import ball
from ...scenarios.trajectory import StopReason
from ..deadline import OutOfTime, time_limit
from .decision.balls import BallRun, Replay
from .decision.decision import MOST_BITS, DecidingNumber
from .margin import BitsEnough

if TYPE_CHECKING:
    from .laboratory.laboratory import Laboratory

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
