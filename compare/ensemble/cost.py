"""What a sweep costs beside a loop over `compare`, and what a second processor gains.

`python -m truebreak.compare.ensemble.cost` measures 500 gases of ten discs; `--scenes N` fewer.
"""

from __future__ import annotations

import argparse
import resource
import sys
import time as clock
from collections.abc import Callable
from dataclasses import dataclass

from ...scenarios import catalogue
from ..comparison import compare
from .sweep import sweep

SCENES, EVENTS = 500, 300

ENGINES = ("double", "pymunk:dt=1/256")


@dataclass(frozen=True)
class Cost:
    """Seconds of one way to do it: by the clock, and of processors, workers counted."""

    wall: float
    processor: float


def cost(work: Callable[[], object]) -> Cost:
    """Carries something out and says what it cost.

    >>> cost(lambda: None).wall >= 0
    True
    """
    began, used = clock.perf_counter(), _processor()
    work()
    return Cost(clock.perf_counter() - began, _processor() - used)


def _processor() -> float:
    """Processor seconds of this process and of the workers that have ended."""
    usage = [resource.getrusage(whose) for whose in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(mine.ru_utime + mine.ru_stime for mine in usage)


def loop(scenes: int) -> None:
    """A comparison of each gas, one after the other."""
    for seed in range(1, scenes + 1):
        compare(catalogue.build(f"gas:seed={seed}"), list(ENGINES), events=EVENTS)


def swept(scenes: int, jobs: int) -> None:
    """The same by a sweep."""
    sweep("gas", [f"seed=1..{scenes}"], ENGINES, events=EVENTS, jobs=jobs)


def table(scenes: int) -> str:
    """The three ways, one after the other, and their ratios."""
    ways: dict[str, Callable[[], object]] = {
        "a loop over compare": lambda: loop(scenes),
        "a sweep, one worker": lambda: swept(scenes, 1),
        "a sweep, two workers": lambda: swept(scenes, 2),
    }
    told = {name: cost(work) for name, work in ways.items()}
    looped, one, two = told.values()
    lines = [f"{scenes} gases of ten discs, {EVENTS} events, {', '.join(ENGINES)}", "",
             "| way | seconds | seconds of processors |", "|---|---|---|"]  # fmt: skip
    lines += [f"| {name} | {mine.wall:.1f} | {mine.processor:.1f} |" for name, mine in told.items()]
    return "\n".join([
        *lines,
        "",
        f"The sweep takes {two.wall / looped.wall:.2f} of the loop's time by the clock, "
        f"{one.processor / looped.processor:.2f} of its processor time; two workers are {one.wall / two.wall:.2f} "
        f"times as fast as one, for {two.processor / one.processor:.2f} times its processor time.",
    ])  # fmt: skip


def main(arguments: list[str] | None = None) -> int:
    """Measures and prints; the exit status."""
    parser = argparse.ArgumentParser(prog="python -m truebreak.compare.ensemble.cost", description=__doc__)
    parser.add_argument("--scenes", type=int, default=SCENES, metavar="N", help=f"how many gases ({SCENES})")
    options = parser.parse_args(arguments)
    if options.scenes < 1:
        parser.error(f"--scenes {options.scenes}: must be a whole number from 1")
    print(table(options.scenes))
    return 0


if __name__ == "__main__":
    sys.exit(main())
