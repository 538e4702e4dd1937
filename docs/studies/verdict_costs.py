"""What a verdict costs: processor time of each command over the runs that it cannot do without.

`python docs/studies/verdict_costs.py [NAME]...` measures all rows, or those named, and prints them as a table. A cost
is the time of the command in this process over that of *the reference's run and each engine's one run at its settings*,
loading of modules apart; both are medians, measured in turns. Of what two workers do side by side, it is the time on
the wall over that of one worker; of a long run, seconds and megabytes themselves. Runs at finer time steps, which tell
a step's errors from others and are bounded by counted steps, are a column of their own. `--append FILE` adds the
figures of this commit to a file and says what has changed by more than a tenth; `--draw FILE.svg` draws that file, each
figure as a share of its target.
"""

from __future__ import annotations

import argparse
import gc
import json
import os
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from copy import copy
from dataclasses import dataclass, replace
from functools import cache
from os import environ
from pathlib import Path
from typing import Any

from speed_ratios import processor_time

from truebreak.compare import compare
from truebreak.compare.audit.audit import audit_run
from truebreak.compare.chaos.certified_chaos import chaos
from truebreak.compare.deadline import uninterrupted
from truebreak.compare.engines import engine, suggestion
from truebreak.compare.files.cache import FOLDER
from truebreak.compare.grids import stress_map
from truebreak.compare.grids.computer import computer, timed
from truebreak.compare.grids.executors import RARELY
from truebreak.compare.grids.family_sweep import SweepJob, sweep
from truebreak.compare.grids.grid import carry_out
from truebreak.compare.grids.row import diagnosed, followed
from truebreak.compare.grids.setting_search import advise
from truebreak.compare.grids.store import Store
from truebreak.compare.report.charts import Curve, plot
from truebreak.compare.report.pictures.sweep_plots import standalone
from truebreak.compare.shadowing.shadows import shadow
from truebreak.compare.study import Study
from truebreak.compare.testing.check import check
from truebreak.compare.writing import check_writable, write_whole
from truebreak.scenarios import catalogue
from truebreak.scenarios.engine import Engine
from truebreak.scenarios.errors import SceneError
from truebreak.scenarios.scene import Scene
from truebreak.scenarios.trajectory import OnProgress, Trajectory

REPEATS = 5

LONG, WORKERS = 100_000, 2
"""Events of a long run; workers that do side by side what one does."""

CHANGE = 0.10
"""Share by which a figure has to differ from the one before to be named."""

ENOUGH = 0.5
"""Seconds that a comparison may take whatever the runs take."""

DEFAULTS = ("double", "interval", "pymunk")


@dataclass(frozen=True)
class Cost:
    """One row, measured.

    Attributes:
        seconds: of the command, without `finer`.
        base: of the runs that it cannot do without.
        finer: of runs at finer steps.
        most, enough: what the ratio has to reach, or the seconds; without `most`, the seconds alone.
        unit: of `seconds`, `base` and `enough`, where it is another.
    """

    name: str
    what: str
    seconds: float
    base: float
    finer: float
    most: float
    enough: float = 0.0
    unit: str = "s"

    @property
    def ratio(self) -> float:
        """How many times the base.

        >>> Cost("x", "this", 3.0, 1.5, 0.0, 3).ratio
        2.0
        """
        return self.seconds / self.base

    @property
    def figure(self) -> tuple[float, float]:
        """What is kept of it, and its target.

        >>> Cost("x", "this", 0.2, 0.1, 0.0, 0, 0.25).figure
        (0.2, 0.25)
        """
        return (self.ratio, self.most) if self.most else (self.seconds, self.enough)

    @property
    def met(self) -> bool:
        """Whether the target is reached.

        >>> Cost("x", "this", 3.0, 1.0, 0.0, 2).met, Cost("x", "this", 0.3, 0.1, 0.0, 2, 0.5).met
        (False, True)
        """
        return self.ratio <= self.most or self.seconds <= self.enough


@dataclass(frozen=True)
class Subject:
    """What is measured: a command, and what its cost is counted in; what both need is made before.

    Attributes:
        wall: whether the time on the wall is measured, of what several processes do.
        most_repeats: how often it is measured at most, of what takes minutes.
    """

    what: str
    most: float
    command: Callable[[], object]
    base: Callable[[], object]
    enough: float = 0.0
    wall: bool = False
    most_repeats: int = REPEATS


def runs(scene: Scene, engines: Sequence[str], events: int | None = None) -> Callable[[], object]:
    """The reference's run, and one of each engine to its end."""

    def once() -> None:
        reference = uninterrupted(engine("exact").run(scene, events=events))
        for name in engines:
            with suppress(SceneError):  # of an engine that does not take the scene
                engine(name).run(
                    scene, until=float(reference.final_time) or None, events=4 * len(reference.events) + 64
                )

    return once


def comparison(spec: str, most: float = 15.0, enough: float = ENOUGH) -> Subject:
    """`compare` at its defaults."""
    scene = catalogue.build(spec)
    command = lambda: compare(scene)  # noqa: E731
    return Subject(f"compare {spec}", most, command, runs(scene, DEFAULTS), enough)


def checked(cold: bool) -> Subject:
    """`check` of doubles on a gas, with nothing kept of it or with all."""
    scene = catalogue.build("gas")

    def command() -> None:
        if cold:
            for path in Path(environ[FOLDER]).glob("*"):
                path.unlink()
        check("double", scene)

    command()
    return Subject(f"check, {'cold' if cold else 'warm'}", 15 if cold else 6, command, runs(scene, ["double"]))


def swept(audit: bool) -> Subject:
    """A scene of a sweep."""
    spec, events = "gas:n=10,seed=3", 300
    job = SweepJob(0, spec, {}, ("double",), events, audit=audit)
    once = runs(catalogue.build(spec), ["double"], events)
    return Subject(f"a scene of a sweep{'' if audit else ', --no-audit'}", 4 if audit else 2, job.rows, once)


def shadowed(events: int, most: float = 25) -> Subject:
    """`shadow` of doubles on a gas."""
    scene = catalogue.build("gas")
    command = lambda: shadow(scene, "double", events=events)  # noqa: E731
    once = runs(scene, ["double"], events)
    return Subject(f"shadow gas, {events:,} events", most, command, once, most_repeats=_repeats(events))


def measured_chaos(events: int, most: float = 20) -> Subject:
    """`chaos` on a gas, with its engines."""
    scene = catalogue.build("gas")
    command = lambda: chaos(scene, ["double"], events=events)  # noqa: E731
    once = runs(scene, ["double"], events)
    return Subject(f"chaos gas, {events:,} events", most, command, once, most_repeats=_repeats(events))


def _repeats(events: int) -> int:
    """How often something of so many events is measured at most."""
    return REPEATS if events <= 1_000 else 1


def side_by_side(scenes: int) -> Subject:
    """A sweep of so many scenes by two workers, in one worker's time on the wall; idle cores are needed."""

    def swept_by(jobs: int) -> Callable[[], object]:
        return lambda: sweep("gas:n=10", [f"seed=1..{scenes}"], ["double"], events=300, jobs=jobs)

    what = f"sweep of {scenes} scenes, --jobs {WORKERS} / --jobs 1, on the wall"
    return Subject(what, 0.588, swept_by(WORKERS), swept_by(1), wall=True, most_repeats=3)


def advised() -> Subject:
    """`advise`, in reference runs alone."""
    scene = catalogue.build("gas")
    return Subject("advise gas", 150, lambda: advise(scene), runs(scene, []))


def stressed() -> Subject:
    """`stress` of a family, over each engine's run of each place."""
    plan = stress_map.stress_plan(["near-ties"])
    scenes = [stress_map.stress_family(place.family).scene(place) for place in plan.places]

    def command() -> None:
        rows = Store(":memory:", plan.settings)
        carry_out(plan, rows, jobs=1)
        rows.verify()

    def base() -> None:
        for scene in scenes:
            runs(scene, plan.engines)()

    return Subject("stress near-ties", 3, command, base)


def caused(spec: str) -> Subject:
    """The causes of a divergence of doubles, its run and its audit apart, in reference runs alone."""
    scene, double = catalogue.build(spec), engine("double")
    found = followed(uninterrupted(engine("exact").run(scene)), double)
    laws = audit_run(found.run, double)
    command = lambda: diagnosed(replace(found, study=copy(found.study)), "double", double, laws)  # noqa: E731
    return Subject(f"causes of double's divergence, {spec}", 10, command, runs(scene, []))


SUBJECTS: dict[str, Callable[[], Subject]] = {
    **{f"compare-{name}": lambda name=name: comparison(name) for name in catalogue.names()},
    "compare-gas": lambda: comparison("gas", 8, 0.0),
    "compare-rack-5": lambda: comparison("rack:rows=5", 6, 0.0),
    "check-cold": lambda: checked(True),
    "check-warm": lambda: checked(False),
    "causes": lambda: caused("gas"),
    "causes-under-gravity": lambda: caused("gas-under-gravity"),
    "sweep-audit": lambda: swept(True),
    "sweep-no-audit": lambda: swept(False),
    "shadow": lambda: shadowed(1_000),
    "shadow-10000": lambda: shadowed(10_000),
    "chaos": lambda: measured_chaos(1_000),
    "chaos-10000": lambda: measured_chaos(10_000),
    "advise": advised,
    "stress": stressed,
    "jobs": lambda: side_by_side(180),
}
"""What is measured in this process, by name."""

IMPORTED = [
    f"truebreak.compare.{name}"
    for name in ("comparison", "outcomes.permitted", "causes.laboratory", "causes.other_settings", "report.terminal")
]
"""What the command `compare` loads before its first line."""

START = {
    "start-up": (
        ["-P", "-m", "truebreak", "run", "gas", "--events", "5"],
        "run gas --events 5 / python -c pass",
        4.9,
        0.0,
    ),
    "imports": (["-P", "-c", f"import {', '.join(IMPORTED)}"], "what compare imports, over python -c pass", 0.0, 0.25),
}
"""What is measured in processes of its own."""

LONG_RUN = """
import sys, time
from truebreak.compare.engines import engine
from truebreak.compare.grids.computer import memory
from truebreak.scenarios import catalogue
scene, events = catalogue.build("gas:n=10,seed=1"), int(sys.argv[1])
began = time.process_time()
found = engine("exact").run(scene, events=events)
took = time.process_time() - began
assert len(found.events) == events
print(took, (memory() or (0, 0))[1] / 2**20)
"""
"""A certified run of so many events: its seconds, and the most megabytes that its process has held."""

GROWTH = {"long-run": ("seconds of the processor", "s", 17.0), "long-run-memory": ("megabytes at most", "MB", 80.0)}
"""What a long run takes more than one of ten events, each in a process of its own: what, its unit, its target."""


@cache
def long_run(events: int) -> tuple[float, float]:
    """Seconds and megabytes of a certified run, in a process of its own; once for both rows."""
    told = subprocess.run(
        [sys.executable, "-P", "-c", LONG_RUN, str(events)], capture_output=True, text=True, check=True
    )
    seconds, megabytes = map(float, told.stdout.split())
    return seconds, megabytes


def grown(name: str) -> Cost:
    """One of the rows of a long run."""
    what, unit, target = GROWTH[name]
    whole, least = (long_run(events)[name == "long-run-memory"] for events in (LONG, 10))
    return Cost(name, f"run gas, {LONG:,} events over 10: {what}", whole - least, least, 0.0, 0.0, target, unit)


NAMES = [*SUBJECTS, *START, *GROWTH]


@contextmanager
def finer_steps(scene_engines: Sequence[str] = DEFAULTS) -> Iterator[list[float]]:
    """Gathers the processor time of all runs whose time step is finer than those of these engines."""
    given = min((step for name in scene_engines if (step := engine(name).step) is not None), default=0.0)
    taken: list[float] = []
    true = Study._run

    def watched(
        self: Study,
        engine: Engine,
        scene: Scene,
        until: float,
        progress: OnProgress | None,
        events: int | None = None,
    ) -> tuple[Trajectory, bool]:
        found: list[tuple[Trajectory, bool]] = []
        took = timed(lambda: found.append(true(self, engine, scene, until, progress, events)))
        if engine.step is not None and engine.step < given:
            taken.append(took.cpu)
        return found[0]

    Study._run = watched
    try:
        yield taken
    finally:
        Study._run = true


def measured(name: str, repeats: int = REPEATS) -> Cost:
    """One row: medians of the command and of its base, in turns; finer steps apart."""
    if name in START:
        words, what, *target = START[name]
        processor_time(words)
        took = [(processor_time(words), processor_time(["-P", "-c", "pass"])) for _ in range(3 * repeats)]
        ours, least = (statistics.median(each) for each in zip(*took, strict=True))
        most, enough = (*target, 0.0)[:2]
        return Cost(name, what, ours - least if name == "imports" else ours, least, 0.0, most, enough)
    if name in GROWTH:
        return grown(name)
    subject = SUBJECTS[name]()
    subject.base()
    rows: list[tuple[float, float, float]] = []
    for _ in range(min(repeats, subject.most_repeats)):
        with finer_steps() as finer:
            took = timed(subject.command)[subject.wall]
        rows.append((took - sum(finer), timed(subject.base)[subject.wall], sum(finer)))
    seconds, base, apart = (statistics.median(each) for each in zip(*rows, strict=True))
    return Cost(name, subject.what, seconds, base, apart, subject.most, subject.enough)


HEAD = (
    "| what | times its runs | target | seconds | of the runs | finer steps, seconds |\n|---|---:|---|---:|---:|---:|"
)


def row(cost: Cost) -> str:
    """A line of the table.

    >>> row(Cost("x", "this", 3.0, 1.5, 0.25, 3))
    '| this | 2 | <= 3: met | 3 | 1.5 | 0.25 |'
    >>> row(Cost("x", "that", 90.0, 30.0, 0.0, 0, 80, "MB"))
    '| that | 3 | <= 80 MB: MISSED | 90 MB | 30 MB | 0 |'
    """
    bounds = [f"{cost.most:g}"] * bool(cost.most) + [f"{cost.enough:g} {cost.unit}"] * bool(cost.enough)
    goal = f"<= {' or '.join(bounds)}: {'met' if cost.met else 'MISSED'}"
    took, base = (f"{value:.3g}{'' if cost.unit == 's' else f' {cost.unit}'}" for value in (cost.seconds, cost.base))
    return f"| {cost.what} | {cost.ratio:.3g} | {goal} | {took} | {base} | {cost.finer:.2g} |"


# -- figures by commit


def commit() -> str:
    """The commit that is checked out, with a plus where files differ from it."""
    asked = (["rev-parse", "--short", "HEAD"], ["status", "--porcelain", "--untracked-files=no"])
    told = [subprocess.run(["git", *words], capture_output=True, text=True, check=False).stdout for words in asked]
    return f"{told[0].strip() or 'unknown'}{'+' if told[1].strip() else ''}"


def kept(path: str) -> list[dict[str, Any]]:
    """The figures of a file, oldest first; none where there is no file.

    Raises:
        SceneError: for what is no such file.
    """
    if not Path(path).exists():
        return []
    try:
        rows = [json.loads(line) for line in Path(path).read_text("utf-8").splitlines()]
        return [{"commit": str(row["commit"]), "machine": row["machine"], "costs": dict(row["costs"])} for row in rows]
    except (OSError, ValueError, KeyError, TypeError):
        raise SceneError(f"{path}: is no file of figures; name another, or one that --append has made") from None


def changes(before: dict[str, Any], now: dict[str, Any]) -> list[str]:
    """What has changed by more than `CHANGE`, the largest change first.

    >>> changes({"commit": "a", "costs": {"x": [4.0, 6], "y": [1, 2]}}, {"costs": {"x": [5.0, 6], "y": [1.05, 2]}})
    ['x: 4 at a, 5 now (+25 %)']
    """
    then, pairs = before["costs"], list[tuple[str, float, float]]()
    for name, (value, _) in now["costs"].items():
        if name in then and abs(value / then[name][0] - 1) > CHANGE:
            pairs.append((name, then[name][0], value))
    pairs.sort(key=lambda pair: -max(pair[1] / pair[2], pair[2] / pair[1]))
    told = f"at {before['commit']}"
    return [f"{name}: {old:.3g} {told}, {new:.3g} now ({100 * (new / old - 1):+.0f} %)" for name, old, new in pairs]


def drawn(rows: Sequence[dict[str, Any]]) -> str:
    """Every figure as a share of its target, over the commits."""
    names = dict.fromkeys(name for row in rows for name in row["costs"])
    curves = []
    for k, name in enumerate(names):
        known = [(float(x), row["costs"][name]) for x, row in enumerate(rows) if name in row["costs"]]
        curves.append(Curve(name, [(x, ratio / most) for x, (ratio, most) in known], f"e{k}"))
    across = f"commits, {rows[0]['commit']} to {rows[-1]['commit']}"
    return standalone(plot("What a verdict costs", across, "share of the target", curves, dots=curves), list(names))


def main(arguments: list[str] | None = None, repeats: int = REPEATS) -> int:
    """Measures and prints; the exit status, 1 if a target is missed."""
    parser = argparse.ArgumentParser(
        prog="python docs/studies/verdict_costs.py", description="Measure what a verdict costs."
    )
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"some of {', '.join(NAMES)}; all without one")
    parser.add_argument("--append", metavar="FILE", help="add the figures to FILE, and name what has changed")
    parser.add_argument("--draw", metavar="FILE.svg", help="draw the figures of --append's FILE, this commit's too")
    options = parser.parse_args(arguments)
    for name in options.names:
        if name not in NAMES:
            parser.error(f"row {name!r} is not known; {suggestion(name, NAMES)}")
    if options.draw and not options.append:
        parser.error("--draw draws a file of figures; give it with --append FILE")
    try:
        before = kept(options.append) if options.append else []
        for path in filter(None, (options.append, options.draw)):
            check_writable(path)
    except SceneError as error:
        parser.error(str(error))
    gc.set_threshold(RARELY)  # as the command line does, and its workers
    os.environ.pop("PYTHONDONTWRITEBYTECODE", None)  # what is loaded is compiled once, as it is for users
    found, now = list[Cost](), commit()  # the code that is loaded, whatever is committed meanwhile
    with tempfile.TemporaryDirectory() as folder:
        saved, environ[FOLDER] = environ.get(FOLDER), folder
        try:
            print(HEAD)
            for name in options.names or NAMES:
                found.append(measured(name, repeats))
                print(row(found[-1]), flush=True)
        finally:
            environ.pop(FOLDER)
            if saved is not None:
                environ[FOLDER] = saved
    if options.append:
        costs = {cost.name: [round(cost.figure[0], 4), cost.figure[1]] for cost in found}
        told = {"commit": now, "machine": computer(), "costs": costs}
        for line in changes(before[-1], told) if before else []:
            print(line)
        rows = [*before, told]
        write_whole(options.append, "".join(json.dumps(each) + "\n" for each in rows))
        if options.draw:
            write_whole(options.draw, drawn(rows))
    return int(not all(cost.met for cost in found))


if __name__ == "__main__":
    sys.exit(main())
