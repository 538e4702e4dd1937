"""What a sweep costs beside a loop over `compare`, and what a second processor gains.

`python docs/studies/sweep_costs.py` measures 500 gases of ten discs; `--scenes N` fewer.
"""

from __future__ import annotations

import argparse
import resource
import sys
import time as clock
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from statistics import median

from truebreak.compare import compare
from truebreak.compare.grids.executors import do, pool
from truebreak.compare.grids.family_sweep import SweepJob, sweep
from truebreak.scenarios import catalogue

SCENES, EVENTS = 500, 300

ENGINES = ("double", "pymunk:dt=1/256")

TURNS = 5
"""Times that the ways are gone through, each with its share of the gases; ratios are medians over the turns, so that a
machine that is slow for a while says nothing."""


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


def loop(seeds: range) -> None:
    """A comparison of each gas, one after the other."""
    for seed in seeds:
        compare(catalogue.build(f"gas:seed={seed}"), list(ENGINES), events=EVENTS)


def swept(seeds: range, jobs: int) -> None:
    """The same by a sweep."""
    sweep("gas", [f"seed={seeds[0]}..{seeds[-1]}"], ENGINES, events=EVENTS, jobs=jobs)


def apart(seeds: range, processes: int) -> None:
    """The jobs of the sweep without it: each process is handed its part at once, and nobody waits for another.

    What two such processes gain over one is what the machine's second processor gives, and no sweep gains more.
    """
    jobs = [SweepJob(seed, f"gas:seed={seed}", {}, ENGINES, EVENTS) for seed in seeds]
    with pool(processes) as workers:
        list(workers.map(_carry_out, [jobs[k::processes] for k in range(processes)]))


def _carry_out(jobs: list[SweepJob]) -> None:
    for job in jobs:
        do(job)


WAYS: dict[str, Callable[[range], None]] = {
    "a loop over compare": loop,
    "a sweep, one worker": lambda seeds: swept(seeds, 1),
    "a sweep, two workers": lambda seeds: swept(seeds, 2),
    "one process, no sweep": lambda seeds: apart(seeds, 1),
    "two processes, no sweep": lambda seeds: apart(seeds, 2),
}


def table(scenes: int) -> str:
    """The ways, in turns, and their ratios."""
    turns = min(TURNS, scenes)
    ends = [1 + scenes * k // turns for k in range(turns + 1)]
    told: dict[str, list[Cost]] = {name: [] for name in WAYS}
    for first, stop in pairwise(ends):
        for name, work in WAYS.items():
            told[name].append(cost(lambda work=work, seeds=range(first, stop): work(seeds)))
    looped, one, two, alone, both = told.values()
    lines = [f"{scenes} gases of ten discs, {EVENTS} events, {', '.join(ENGINES)}, in {turns} turns", "",
             "| way | seconds | seconds of processors |", "|---|---|---|"]  # fmt: skip
    lines += [
        f"| {name} | {sum(mine.wall for mine in costs):.1f} | {sum(mine.processor for mine in costs):.1f} |"
        for name, costs in told.items()
    ]
    return "\n".join([
        *lines,
        "",
        f"The sweep takes {ratio(two, looped):.2f} of the loop's time by the clock, "
        f"{ratio(one, looped, 'processor'):.2f} of its processor time. Two workers are {ratio(one, two):.2f} times as "
        f"fast as one, two separate processes {ratio(alone, both):.2f} times as fast as one: two workers reach "
        f"{100 * ratio(both, two):.0f} % of what two separate processes reach.",
    ])  # fmt: skip


def ratio(costs: Sequence[Cost], others: Sequence[Cost], of: str = "wall") -> float:
    """The median over the turns of what one way costs as a share of another.

    >>> ratio([Cost(1, 1), Cost(9, 9), Cost(3, 3)], [Cost(2, 2), Cost(1, 1), Cost(3, 3)])
    1.0
    """
    return median(getattr(a, of) / getattr(b, of) for a, b in zip(costs, others, strict=True))


def main(arguments: list[str] | None = None) -> int:
    """Measures and prints; the exit status."""
    parser = argparse.ArgumentParser(prog="python docs/studies/sweep_costs.py", description=__doc__)
    parser.add_argument("--scenes", type=int, default=SCENES, metavar="N", help=f"how many gases ({SCENES})")
    options = parser.parse_args(arguments)
    if options.scenes < 1:
        parser.error(f"--scenes {options.scenes}: must be a whole number from 1")
    print(table(options.scenes))
    return 0


if __name__ == "__main__":
    sys.exit(main())
