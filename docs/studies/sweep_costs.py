"""What a sweep costs beside a loop over `compare`, what a second processor gains, and what a large store takes.

`python docs/studies/sweep_costs.py` measures 500 gases of ten discs; `--scenes N` fewer. With `--store N` it makes
a store of N rows instead, in which the last scene is missing, and measures going on with it and reading it: for
1,000,000 rows some minutes, and 800 MB in a folder that is removed.
"""

from __future__ import annotations

import argparse
import json
import resource
import shutil
import subprocess
import sys
import tempfile
import time as clock
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path
from statistics import median

from truebreak.compare import compare
from truebreak.compare.grids.executors import do, pool
from truebreak.compare.grids.family_sweep import SweepJob, plan, sweep
from truebreak.compare.grids.store import Store
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


# -- a large store, of rows made for it


REAL = 8
"""Scenes that are carried out; their rows, with the number and the seed of each scene, are those of all others."""


def filled(path: str, rows: int) -> list[str]:
    """Makes a store of so many rows, two a scene, without its last scene; the arguments of the sweep that it is of."""
    scenes = max(REAL, rows // 2) + 1
    asked = plan("gas:n=3", [f"seed=1..{scenes}"], ["double", "single"], events=60)
    store = Store(path, asked.settings)
    told = [asked.job(k).rows() for k in range(REAL)]
    for k in range(scenes - 1):
        job = asked.job(k)
        mine = [replace(row, index=k, scene=job.scene, parameters=dict(job.parameters)) for row in told[k % REAL]]
        store.add(k, asked.key(k), mine, 0.01)
    store.keep()
    store.close()
    return ["gas:n=3", "--vary", f"seed=1..{scenes}", "--engines", "double,single", "--events", "60", "--yes"]


GONE_ON = """
    from truebreak.compare.grids.family_sweep import plan
    from truebreak.compare.grids.grid import carry_out
    from truebreak.compare.grids.store import Store
    scene, _, vary, _, engines, _, events, *_, path = sys.argv[1:]
    asked = plan(scene, [vary], engines.split(","), events=int(events))
    carry_out(asked, Store(path, asked.settings), jobs=1)
"""
COMMAND = """
    from truebreak.compare.cli import main
    main(["sweep", *sys.argv[1:]])
"""
MEASURED = """
import json, re, resource, sys
from pathlib import Path
code = 0
try:{what}
except SystemExit as ended:
    code = ended.code
used = resource.getrusage(resource.RUSAGE_SELF)
status = Path("/proc/self/status")  # `ru_maxrss` knows also of the process that started this one
most = re.search(r"VmHWM:\\s+(\\d+)", status.read_text())[1] if status.exists() else used.ru_maxrss
print(json.dumps([used.ru_utime + used.ru_stime, int(most) / 1024, code]), file=sys.stderr)
"""
"""One of these, and at last its processor seconds, its most megabytes, and its exit code."""


def store_table(rows: int) -> str:
    """What going on with a store of so many rows takes, and what reading it does."""
    with tempfile.TemporaryDirectory() as folder:
        path = str(Path(folder, "rows.db"))
        asked = filled(path, rows)
        size = Path(path).stat().st_size / 1e6
        whole = str(Path(folder, "whole.db"))
        shutil.copy(path, whole)
        pages = ["--csv", f"{folder}/rows.csv", "--svg", f"{folder}/rows.svg"]
        ways = {
            "going on, until the one scene that was missing is kept": (GONE_ON, [*asked, path]),
            "the whole command that goes on, its table too": (COMMAND, [*asked, "--store", whole, "--jobs", "1"]),
            "table, CSV and figure": (COMMAND, ["--store", whole, *pages]),
        }
        lines = [
            f"A store of {rows:,} rows, {size:,.0f} MB",
            "",
            "| what | seconds of processors | MB |",
            "|---|---|---|",
        ]
        for name, (what, words) in ways.items():
            script = MEASURED.replace("{what}", what)
            done = subprocess.run([sys.executable, "-c", script, *words], capture_output=True, text=True, check=True)
            seconds, megabytes, code = json.loads(done.stderr.splitlines()[-1])
            if code not in (None, 0, 1):  # 1: some engine diverged
                raise RuntimeError(f"sweep {' '.join(words)}: {done.stderr}")
            lines.append(f"| {name} | {seconds:.1f} | {megabytes:.0f} |")
    return "\n".join(lines)


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
    parser.add_argument("--store", type=int, metavar="N", help="measure a store of N rows instead")
    options = parser.parse_args(arguments)
    for key in ("scenes", "store"):
        if getattr(options, key) is not None and getattr(options, key) < 1:
            parser.error(f"--{key} {getattr(options, key)}: must be a whole number from 1")
    print(table(options.scenes) if options.store is None else store_table(options.store))
    return 0


if __name__ == "__main__":
    sys.exit(main())
