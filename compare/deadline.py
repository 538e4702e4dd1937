"""Ends runs for which the user allowed no more seconds, or pressed Ctrl-C."""

from __future__ import annotations

import signal
import sys
import threading
import time as clock
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import TYPE_CHECKING

from ..exact.numbers import ball
from ..scenarios.errors import SceneError, TimeIsUp

if TYPE_CHECKING:
    from ..scenarios.trajectory import OnProgress, Progress, Trajectory

AGAIN_SECONDS = 0.05
"""Once the seconds are over, how often a place is looked for at which a run can be ended."""

NO_TIME = "not tried: the seconds (--max-seconds) are over"
"""What an experiment says for which there was no time."""

_ROOT = __name__.rpartition(".compare")[0]

ENGINES = (f"{_ROOT}.exact.", f"{_ROOT}.floating.", f"{_ROOT}.compare.foreign.")
"""Where engines are: a function there that names `TimeIsUp` is a loop that catches it."""

RECORDING = f"{_ROOT}.compare.foreign.runs.recording"
"""What takes down a run must not be stopped in the middle of an event."""

HOLDING = f"{_ROOT}.scenarios.numbers.precision"
"""What holds flint's precision, and gives it back, must not be stopped on the way."""

DROPPING = "mpmath."
"""Whose code drops whatever is raised in some places (a bare `except`), and goes on with something else."""


class OutOfTime(Exception):
    """A run went past its deadline, and nothing of it is to be had."""


def uninterrupted(trajectory: Trajectory) -> Trajectory:
    """The same, for whoever needs a run's result and not just what there is of it.

    Raises:
        KeyboardInterrupt: if the user interrupted the run.
    """
    from ..scenarios.trajectory import StopReason

    if trajectory.stop.reason is StopReason.INTERRUPTED:
        raise KeyboardInterrupt
    return trajectory


def checked_seconds(seconds: float | None) -> float | None:
    """A number of seconds that can be waited for; None means no limit.

    Raises:
        SceneError: for any other.
    """
    number = isinstance(seconds, int | float) and not isinstance(seconds, bool)
    if seconds is not None and not (number and 0 < seconds <= threading.TIMEOUT_MAX):
        raise SceneError(f"max_seconds = {seconds!r}: must be a number of seconds above zero")
    return seconds


class Clock:
    """The seconds of one `time_limit`.

    Attributes:
        seconds: how many; None: no limit.
        told: what a message says instead: the user's seconds, of which these are a part.
    """

    def __init__(self, seconds: float | None, told: float | None = None) -> None:
        self.seconds = seconds
        self.told = seconds if told is None else told
        self._deadline = None if seconds is None else clock.monotonic() + seconds

    @property
    def over(self) -> bool:
        """Whether they have gone by."""
        return self._deadline is not None and clock.monotonic() >= self._deadline

    def left(self, share: float = 1.0) -> float | None:
        """Seconds that are left, or a share of them; None: no limit. A moment is left always, to end in good order."""
        if self._deadline is None:
            return None
        return max(share * (self._deadline - clock.monotonic()), AGAIN_SECONDS)

    def is_up(self) -> TimeIsUp:
        """What ends a run then."""
        return TimeIsUp(f"{self.told:g} second{'' if self.told == 1 else 's'} (--max-seconds)")

    def watched(self, progress: OnProgress | None) -> OnProgress | None:
        """A callback that ends a run once they are over, and hands progress on until then."""
        if self.seconds is None:
            return progress

        def checked(state: Progress) -> None:
            if self.over:
                raise self.is_up()
            if progress is not None:
                progress(state)

        return checked


@contextmanager
def time_limit(seconds: float | None, told: float | None = None) -> Iterator[Clock]:
    """Ends the runs of engines in its body after so many seconds, all told: they come back with a stop for BUDGET.

    In the main thread, where the platform has timers, a run ends wherever it is. Elsewhere, and in pymunk, it ends
    when it next tells its progress, for which it must be given `Clock.watched`.

    Raises:
        OutOfTime: if the seconds are over and there is no partial result, which is unlikely.
        SceneError: for seconds that are not above zero.
    """
    watch = Clock(checked_seconds(seconds), told)
    try:
        with _alarm(watch, _can_end):
            yield watch
    except TimeIsUp as outcome:
        raise OutOfTime(str(outcome)) from None


@contextmanager
def time_to_read(watch: Clock) -> Iterator[None]:
    """Ends what its body reads off runs once the seconds are over, wherever it is: there is no partial result of that.

    In the main thread, where the platform has timers; elsewhere where the body looks at the clock itself.

    Raises:
        OutOfTime: then.
    """
    bits = ball.bits_in_use()
    try:
        if watch.over:
            raise watch.is_up()
        with _alarm(watch, _can_drop):
            yield
    except TimeIsUp as outcome:
        ball.use_bits(bits)
        raise OutOfTime(str(outcome)) from None


@contextmanager
def _alarm(watch: Clock, ends: Callable[[FrameType | None], bool]) -> Iterator[None]:
    """Raises `TimeIsUp` in its body when the seconds are over, at a place that can be ended."""
    timers = hasattr(signal, "setitimer") and threading.current_thread() is threading.main_thread()
    seconds = watch.left()
    if seconds is None or not timers:
        yield
        return

    def ring(number: int, frame: FrameType | None) -> None:
        if watch.over and ends(frame):
            raise watch.is_up()

    began = clock.monotonic()
    handler = signal.signal(signal.SIGALRM, ring)
    left, interval = signal.setitimer(signal.ITIMER_REAL, seconds, AGAIN_SECONDS)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, handler)
        if left:  # another timer was at work: pytest's, say
            signal.setitimer(signal.ITIMER_REAL, max(left - (clock.monotonic() - began), 0.001), interval)


def _can_drop(frame: FrameType | None) -> bool:
    """Whether nothing is under way in a frame that must be whole (an import, what C calls), or drops exceptions."""
    while frame is not None:
        module = str(frame.f_globals.get("__name__"))
        if "pymunk" in module or module == HOLDING or module.startswith(("importlib", DROPPING)):
            return False
        frame = frame.f_back
    return True


def _can_end(frame: FrameType | None) -> bool:
    """Whether `TimeIsUp`, raised in a frame, reaches the loop of an engine that catches it, and is not caught yet.

    Of what is outside of a loop there is no partial result. What C calls must not raise, for C code goes on, so
    pymunk's engine is left to tell its progress.
    """
    handled = sys.exc_info()[1]
    while handled is not None:
        if isinstance(handled, TimeIsUp):
            return False
        handled = handled.__context__
    while frame is not None:
        module = str(frame.f_globals.get("__name__"))
        if "pymunk" in module or module in (RECORDING, HOLDING) or module.startswith(DROPPING):
            return False
        if module.startswith(ENGINES) and "TimeIsUp" in frame.f_code.co_names and frame.f_code.co_name != "<module>":
            return True
        frame = frame.f_back
    return False
