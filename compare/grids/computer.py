"""What a measurement needs to know of its machine: a loop to count in, whether something else ran, and memory."""

from __future__ import annotations

import os
import platform
import statistics
import time as clock
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

STATUS, CLEAR = Path("/proc/self/status"), Path("/proc/self/clear_refs")

LOOPS = 20_000
"""Rounds of the loop: some milliseconds."""


class Took(NamedTuple):
    """Seconds of the processor, and of the clock on the wall."""

    cpu: float
    wall: float


def timed(action: object) -> Took:
    """How long a call takes."""
    assert callable(action)
    cpu, wall = clock.process_time(), clock.perf_counter()
    action()
    return Took(clock.process_time() - cpu, clock.perf_counter() - wall)


def loop() -> float:
    """A fixed piece of work of Python's own, in which run times are counted.

    What is faster by a better clock, or a better interpreter, is faster in both.

    >>> loop() == loop()
    True
    """
    x, y = 0.5, {}
    for k in range(LOOPS):
        x = 3.7 * x * (1.0 - x)
        y[k & 255] = x
    return x + len(y)


def calibration(times: int = 3) -> list[Took]:
    """The loop, so many times."""
    return [timed(loop) for _ in range(times)]


SHARED = 1.05
"""A machine that gives a process less than 20 of 21 seconds has something else to do."""

UNEVEN = 1.10
"""Of the loop: the median over the least. Of a row: how far its two best processes are apart."""


@dataclass(frozen=True)
class Idleness:
    """Whether a machine was idle while it was measured.

    Attributes:
        wall: seconds on the wall for each of the processor, over all that was timed.
        uneven: the median time of the loop over its least.
        unsteady: rows whose two fastest processes differ by more than `UNEVEN`, or that no two were measured of.
    """

    wall: float
    uneven: float
    unsteady: tuple[str, ...] = ()

    @property
    def idle(self) -> bool:
        """Whether all of that is as it is where nothing else runs.

        >>> Idleness(1.01, 1.02).idle, Idleness(1.4, 1.02).idle
        (True, False)
        """
        return self.wall <= SHARED and self.uneven <= UNEVEN and not self.unsteady

    def __str__(self) -> str:
        counted = f"{len(self.unsteady):,} rows differ between processes, or were"
        if len(self.unsteady) == 1:
            counted = "1 row differs between processes, or was"
        verdict = "The machine was idle" if self.idle else "The machine was not idle"
        rows = f"; {counted} measured once" if self.unsteady else ""
        return (
            f"{verdict}: {self.wall:.3f} s on the wall for each of the processor (at most {SHARED} where nothing else "
            f"runs), the loop's median {self.uneven:.3f} of its least (at most {UNEVEN:.2f}){rows}."
        )


def idleness(took: Iterable[Took], loops: Sequence[Took], unsteady: Sequence[str] = ()) -> Idleness:
    """From all that was timed, and from the loops among it.

    >>> idleness([Took(1.0, 1.5)], [Took(0.1, 0.1), Took(0.1, 0.1)]).idle
    False
    """
    every = [*took, *loops]
    cpu = sum(t.cpu for t in every)
    wall = sum(t.wall for t in every) / cpu if cpu else 1.0
    least = min((t.cpu for t in loops), default=0.0)
    uneven = statistics.median(t.cpu for t in loops) / least if least else 1.0
    return Idleness(wall, uneven, tuple(unsteady))


def computer() -> dict[str, str | int]:
    """What tells one machine from another, as far as its speed goes."""
    from ...exact.compiled import predictions

    return {
        "processor": _processor(),
        "cores": os.cpu_count() or 1,
        "system": platform.system(),
        "python": platform.python_version() + ("" if predictions else " (nothing compiled)"),
    }


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text("utf-8").splitlines()
    except OSError:
        lines = []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor() or platform.machine()


def reset_peak() -> None:
    """Forgets this process's peak of memory, where the system can."""
    try:
        CLEAR.write_text("5", encoding="ascii")
    except OSError:
        return


def memory() -> tuple[int, int] | None:
    """Bytes of memory that this process holds, and its peak; None where the system does not tell.

    Linux tells both of the process alone; what `getrusage` gives begins with the peak of the parent.
    """
    try:
        lines = dict(line.split(":", 1) for line in STATUS.read_text("utf-8").splitlines() if ":" in line)
        return 1024 * int(lines["VmRSS"].split()[0]), 1024 * int(lines["VmHWM"].split()[0])
    except (OSError, KeyError, ValueError):
        return None


LEAST_PROCESSES, MOST_PROCESSES = 2, 4
