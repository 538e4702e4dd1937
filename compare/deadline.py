"""Ends runs for which the user allowed no more seconds, or pressed Ctrl-C."""

from __future__ import annotations

import signal
import sys
import threading
import time as clock
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from types import FrameType
from typing import TYPE_CHECKING

from ..exact.numbers import ball
from ..scenarios.engine import endable
from ..scenarios.errors import SceneError, TimeIsUp

if TYPE_CHECKING:
    from ..scenarios.trajectory import OnProgress, Progress, Trajectory

AGAIN_SECONDS = 0.05
"""Once the seconds are over, how often a place is looked for at which a run can be ended."""

NO_TIME = "not tried: the seconds (--max-seconds) are over"
"""What an experiment says for which there was no time."""

WHOLE = tuple(
    f"{__name__.rpartition('.compare')[0]}.{module}"
    for module in ("compare.foreign.recording", "scenarios.numbers.precision", "scenarios.errors")
)
"""What must not be stopped in the middle: what takes down an event, what gives flint's precision back, and what notes
where a run can be ended."""

DROPPING = ("importlib", "mpmath.")
"""Whose code must not be stopped either, or drops whatever is raised in some places and goes on with something else."""


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
        asked: what a message says instead: the user's seconds, of which these are a part.
    """

    def __init__(self, seconds: float | None, asked: float | None = None) -> None:
        self.seconds = seconds
        self.asked = seconds if asked is None else asked
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
        return TimeIsUp(f"{self.asked:g} second{'' if self.asked == 1 else 's'} (--max-seconds)")

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


_AT_WORK: ContextVar[Clock | None] = ContextVar("seconds", default=None)


def clock_at_work() -> Clock | None:
    """The seconds that whatever is at work here may take; None: no limit."""
    return _AT_WORK.get()


@contextmanager
def time_limit(seconds: float | None, asked: float | None = None) -> Iterator[Clock]:
    """Ends the runs of engines in its body after so many seconds, all told: they come back with a stop for BUDGET.

    In the main thread, where the platform has timers, a run of truebreak's own ends wherever it can be (`endable`).
    Elsewhere, and in pymunk, it ends when it next tells its progress, for which it must be given `Clock.watched`. One
    of somebody else's engine ends in any case (`foreign.isolation`).

    Raises:
        OutOfTime: if the seconds are over and there is no partial result, which is unlikely.
        SceneError: for seconds that are not above zero.
    """
    watch = Clock(checked_seconds(seconds), asked)
    try:
        with _alarm(watch, reading=False):
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
        with _alarm(watch, reading=True):
            yield
    except TimeIsUp as outcome:
        ball.use_bits(bits)
        raise OutOfTime(str(outcome)) from None


@contextmanager
def _alarm(watch: Clock, *, reading: bool) -> Iterator[None]:
    """Raises `TimeIsUp` in its body when the seconds are over, at a place that can be ended."""
    seconds = watch.left()
    if seconds is None:
        yield
        return
    token = _AT_WORK.set(watch)
    try:
        if hasattr(signal, "setitimer") and threading.current_thread() is threading.main_thread():
            with _timer(watch, seconds, reading):
                yield
        else:
            yield
    finally:
        _AT_WORK.reset(token)


@contextmanager
def _timer(watch: Clock, seconds: float, reading: bool) -> Iterator[None]:
    def ring(number: int, frame: FrameType | None) -> None:
        if watch.over and _can_end(frame, anywhere=reading):
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


def _can_end(frame: FrameType | None, *, anywhere: bool) -> bool:
    """Whether `TimeIsUp`, raised in a frame, ends what is at work in good order.

    Where a run is at work, the loop of its engine has to catch it (`endable`), and not to be at that yet: of what is
    outside of a loop there is no partial result. Where something is read, any place will do. In neither may anything be
    under way that must be whole, or drops exceptions; what C calls must not raise, for C code goes on, so pymunk's
    engine is left to tell its progress.
    """
    handled = None if anywhere else sys.exc_info()[1]
    while handled is not None:
        if isinstance(handled, TimeIsUp):
            return False
        handled = handled.__context__
    while frame is not None:
        module = str(frame.f_globals.get("__name__"))
        if "pymunk" in module or module in WHOLE or module.startswith(DROPPING):
            return False
        if not anywhere and frame in endable.frames:
            return True
        frame = frame.f_back
    return anywhere
