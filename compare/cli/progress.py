"""What a command says besides its result: the exit code, and progress on stderr."""

from __future__ import annotations

import sys
import threading
import time as clock
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from enum import IntEnum
from typing import TYPE_CHECKING, NamedTuple, TypeVar

from ...scenarios.errors import printable

if TYPE_CHECKING:
    from rich.status import Status

    from ...scenarios.scene import Scene
    from ...scenarios.trajectory import OnProgress, Progress, Stop
    from ..comparison import Comparison


class ExitCode(IntEnum):
    """The codes; a shell reads 128 + n as ended by signal n."""

    DONE = 0
    DIVERGED = 1
    USAGE = 2
    INTERNAL = 3
    UNDECIDED = 4
    INTERRUPTED = 130
    PIPE_CLOSED = 141


DONE = ExitCode.DONE


def of_stop(stop: Stop) -> ExitCode:
    """The code of a single run: 4 where the engine could not go on, else 0."""
    from ...scenarios.trajectory import StopReason

    if stop.reason is StopReason.INTERRUPTED:
        return ExitCode.INTERRUPTED
    return ExitCode.UNDECIDED if stop.reason in (StopReason.UNDECIDED, StopReason.BUDGET) else ExitCode.DONE


def of_comparison(comparison: Comparison) -> ExitCode:
    """The code of a comparison.

    1 if any engine diverged, or does not keep the laws; else 4 if anything is not settled or undecided, else 0.
    """
    if any(candidate.lawless for candidate in comparison.candidates):
        return ExitCode.DIVERGED
    codes = {"agree": ExitCode.DONE, "diverged": ExitCode.DIVERGED}
    return codes.get(comparison.verdict, ExitCode.UNDECIDED)


# ----------------------------------------
# Progress of a run on stderr, if that is a terminal: done, total, rate, and the time left.

S = TypeVar("S")

UNTOTALLED = ("why", "orders")
"""First words of notes on work that has limits of its own."""


class RunEnd(NamedTuple):
    """Where a run will end: after so many events, or at a time; neither, where it is not known."""

    events: int | None = None
    until: float | None = None


class Pace:
    """Tells progress in words; the rate is that of the engine at work.

    Args:
        title: what is run.
        goal: where it will end.
        now: a clock, in seconds.
    """

    def __init__(self, title: str, goal: RunEnd | None = None, now: Callable[[], float] = clock.monotonic) -> None:
        self.title, self.goal, self.now = title, goal or RunEnd(), now
        self._phase: str | None = None
        self._began = 0.0, 0, 0.0

    def line(self, progress: Progress) -> str:
        """One line: done, total, rate, and the seconds left as far as they can be told.

        >>> from truebreak.scenarios.trajectory import Progress
        >>> seconds = iter([0.0, 2.0])
        >>> pace = Pace("gas", RunEnd(events=200), lambda: next(seconds))
        >>> pace.line(Progress(0, 0.0, "exact"))
        'gas: exact: 0 of 200 events, time 0'
        >>> pace.line(Progress(50, 36.2, "exact, 256 bits"))
        'gas: exact, 256 bits: 50 of 200 events, time 36.2, 25 a second, 6 s left'
        """
        phase, now = progress.note.partition(",")[0], self.now()
        if phase != self._phase or progress.events < self._began[1]:
            self._phase, self._began = phase, (now, progress.events, progress.time)
        whose = f" {progress.note}:" if progress.note else ""
        total = None if phase.startswith(UNTOTALLED) else self.goal.events
        of = f" of {total:,}" if total is not None and progress.events <= total else ""
        parts = [f"{self.title}:{whose} {progress.events:,}{of} events", f"time {progress.time:.6g}"]
        began, events, time = self._began
        seconds = now - began
        if seconds >= LEAST_SECONDS and progress.events > events:
            parts.append(f"{(progress.events - events) / seconds:.3g} a second")
            left = self._left(progress, seconds, events, time) if not phase.startswith(UNTOTALLED) else None
            if left is not None:
                parts.append(f"{duration(left)} left")
        return ", ".join(parts)

    def _left(self, progress: Progress, seconds: float, events: int, time: float) -> float | None:
        """Seconds to the end that comes first, at the rate so far."""
        ends = []
        if self.goal.events is not None and events < progress.events <= self.goal.events:
            ends.append(seconds * (self.goal.events - progress.events) / (progress.events - events))
        if self.goal.until is not None and time < progress.time <= self.goal.until:
            ends.append(seconds * (self.goal.until - progress.time) / (progress.time - time))
        return min(ends, default=None)


LEAST_SECONDS = 1.0
"""Before so many seconds a rate says little."""


def duration(seconds: float) -> str:
    """A time to wait.

    >>> duration(6.2), duration(600), duration(7300)
    ('6 s', '10 min', '2 h 2 min')
    """
    if seconds < 100:
        return f"{seconds:.0f} s"
    minutes = round(seconds / 60)
    return f"{minutes} min" if minutes < 60 else f"{minutes // 60} h {minutes % 60} min"


def goal_of(scene: Scene, until: str | None, events: int | None) -> RunEnd:
    """Where a run with these limits will end: the scene's own limits hold where none is given."""
    from ...scenarios.errors import SceneError
    from ...scenarios.numbers.quantity import Quantity

    if until is None and events is None:
        return RunEnd(scene.events, None if scene.until is None else float(scene.until))
    try:
        return RunEnd(events, None if until is None else float(Quantity.of(until)))
    except (SceneError, OverflowError):  # an engine that is asked will say what is wrong with it
        return RunEnd(events)


QUIET_SECONDS = 0.25
"""What takes less shows no line."""


@contextmanager
def showing(title: str) -> Iterator[Callable[[str], None] | None]:
    """A line on stderr that is written anew with each text; None, and no output, where stderr is not a terminal."""
    if not sys.stderr.isatty():
        yield None
        return
    line = ProgressLine(title)
    timer = threading.Timer(QUIET_SECONDS, line.begin)
    timer.daemon = True
    timer.start()
    try:
        yield line.write
    finally:
        timer.cancel()
        line.end()


class ProgressLine:
    """The line; what is over before it begins shows nothing, and needs no rich."""

    def __init__(self, title: str) -> None:
        self._text, self._over = title, False
        self._status: Status | None = None
        self._lock = threading.Lock()

    def begin(self) -> None:
        """Shows it from now on."""
        from rich.console import Console
        from rich.text import Text

        with self._lock:
            if not self._over:
                self._status = Console(stderr=True).status(Text(printable(self._text)))
                self._status.start()

    def write(self, text: str) -> None:
        """Another text."""
        self._text = text
        if self._status is not None:
            from rich.text import Text

            self._status.update(Text(printable(text)))

    def end(self) -> None:
        """Takes it away."""
        with self._lock:
            self._over = True
            if self._status is not None:
                self._status.stop()


@contextmanager
def showing_progress(title: str, goal: RunEnd | None = None) -> Iterator[OnProgress | None]:
    """A line on stderr that follows a run; None, and no output, where stderr is not a terminal."""
    pace = Pace(title, goal)
    with showing(title) as show:
        yield None if show is None else lambda progress: show(pace.line(progress))


@contextmanager
def showing_search(title: str, told: Callable[[S, float], str]) -> Iterator[Callable[[S], None] | None]:
    """A line on stderr that tells how far a search is; None where stderr is no terminal.

    Args:
        told: the line, from what the search says of itself and the seconds since it began.
    """
    began = clock.monotonic()
    with showing(title) as show:
        yield None if show is None else lambda state: show(f"{title}: {told(state, clock.monotonic() - began)}")
