"""The figures that `truebreak bench` measures: each is a ratio of two things timed in one run."""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

from ...deadline import uninterrupted
from ...engines import engine
from .rivals import run_billiards, run_perfect_physics

if TYPE_CHECKING:
    from ....scenarios.scene import Scene


@dataclass(frozen=True)
class Target:
    """What a figure has to reach."""

    of: Literal["ratio", "seconds"]
    bound: Literal["at most", "at least"]
    value: float

    def __str__(self) -> str:
        unit = " s" if self.of == "seconds" else ""
        return f"{'<=' if self.bound == 'at most' else '>='} {self.value:,g}{unit}"


@dataclass(frozen=True)
class Figure:
    """One result: two things timed side by side.

    Attributes:
        name: what the command line calls it.
        what: what is divided by what.
        numerator: seconds of the first thing (median of the repeats).
        denominator: seconds of the second.
        target: what to reach, if anything; `seconds` means the numerator.
        answer: how right the peer's answer is, where it is somebody else's.
    """

    name: str
    what: str
    numerator: float
    denominator: float
    target: Target | None = None
    answer: str = ""

    @property
    def ratio(self) -> float:
        """Numerator / denominator.

        >>> Figure("x", "this / that", 3.0, 2.0).ratio
        1.5
        """
        return self.numerator / self.denominator

    @property
    def met(self) -> bool | None:
        """Whether the target is reached; None without one.

        >>> Figure("x", "this / that", 3.0, 2.0, Target("ratio", "at most", 2)).met
        True
        """
        if self.target is None:
            return None
        value = self.ratio if self.target.of == "ratio" else self.numerator
        return value <= self.target.value if self.target.bound == "at most" else value >= self.target.value

    def data(self) -> dict[str, Any]:
        """The figure as JSON has it."""
        return {**asdict(self), "ratio": self.ratio, "met": self.met}


@dataclass(frozen=True)
class Workload:
    """How much work each figure does.

    Attributes:
        repeats: interleaved repeats of which the median counts; three times as many of what is short.
        gas: collisions of the short gas.
        long_gas: collisions of the long gas.
        digits: Galperin's n for the engines of this project.
        rival_digits: Galperin's n for perfect-physics (n = 2 takes it about a minute).
        steps: time steps of pymunk.
        crowd, large_crowd: discs of two crowds.
    """

    repeats: int = 5
    gas: int = 1_000
    long_gas: int = 10_000
    digits: int = 4
    rival_digits: int = 1
    steps: int = 100_000
    crowd: int = 1_000
    large_crowd: int = 10_000


SHORT = Workload()
FULL = Workload(rival_digits=2)
TINY = Workload(repeats=1, gas=5, long_gas=10, digits=0, rival_digits=0, steps=20, crowd=20, large_crowd=70)

GAS = "gas:n=10,seed=1"
"""Ten equal discs in a box: chaotic, so that nothing can be guessed ahead."""


def interleaved(
    first: Callable[[], object], second: Callable[[], object], repeats: int, once: bool = False
) -> tuple[float, float]:
    """Median seconds of two actions, timed in turns so that a slow moment of the machine meets both.

    With `once` the first, a slow one, is timed a single time.
    """
    times: tuple[list[float], list[float]] = ([], [])
    for repeat in range(repeats):
        for action, spent in ((first, times[0]), (second, times[1])):
            if once and repeat and action is first:
                continue
            start = time.perf_counter()
            action()
            spent.append(time.perf_counter() - start)
    return statistics.median(times[0]), statistics.median(times[1])


def scene_of(text: str) -> Scene:
    """A scene of the catalogue."""
    from ....scenarios.catalogue import build

    return build(text)


def running(name: str, scene: Scene, events: int) -> Callable[[], object]:
    """A run of one engine, ready to be timed; it must reach the number of instants asked for."""
    runner = engine(name)

    def run() -> None:
        reached = len(uninterrupted(runner.run(scene, events=events)).events)
        if reached != events:
            raise RuntimeError(f"{name} reached {reached} of {events} instants of {scene.name}")

    return run


def gas_against_billiards(size: Workload) -> Figure:
    """Certified, against plain double precision in another project's engine, in Python both."""
    scene = scene_of(GAS)
    told = run_billiards(scene, size.gas)
    pair = interleaved(running("exact", scene, size.gas), lambda: run_billiards(scene, size.gas), 3 * size.repeats)
    what = f"10 discs, {size.gas:,} collisions: exact / billiards (float64)"
    return Figure("gas-billiards", what, *pair, Target("ratio", "at most", 0.7), _agreed("billiards", scene, told))


def gas_against_double(size: Workload) -> Figure:
    """What certainty costs over this project's own double engine."""
    scene = scene_of(GAS)
    pair = interleaved(running("exact", scene, size.gas), running("double", scene, size.gas), size.repeats)
    return Figure("gas-double", f"10 discs, {size.gas:,} collisions: exact / double", *pair)


def double_against_billiards(size: Workload) -> Figure:
    """Doubles against doubles: this project's engine and another project's, in Python both."""
    scene = scene_of(GAS)
    pair = interleaved(running("double", scene, size.gas), lambda: run_billiards(scene, size.gas), 3 * size.repeats)
    what = f"10 discs, {size.gas:,} collisions: double / billiards (float64)"
    return Figure("double-billiards", what, *pair, Target("ratio", "at most", 0.2))


def long_gas(size: Workload) -> Figure:
    """A long chaotic run, where the precision must keep growing."""
    scene = scene_of(GAS)
    pair = interleaved(running("exact", scene, size.long_gas), running("double", scene, size.long_gas), 1)
    what = f"10 discs, {size.long_gas:,} collisions: exact / double"
    return Figure("gas-long", what, *pair, Target("seconds", "at most", 60))


def long_gas_against_billiards(size: Workload) -> Figure:
    """A long certified run, whose numbers are long, against plain double precision in another project's engine."""
    scene = scene_of(GAS)
    pair = interleaved(
        running("exact", scene, size.long_gas), lambda: run_billiards(scene, size.long_gas), size.repeats
    )
    what = f"10 discs, {size.long_gas:,} collisions: exact / billiards (float64)"
    return Figure("gas-long-billiards", what, *pair, Target("ratio", "at most", 0.8))


def galperin_against_perfect_physics(size: Workload) -> Figure:
    """The article's own engine on the scene whose collisions count the digits of pi."""
    scene, collisions = galperin(size.rival_digits)
    told: list[tuple[Any, Any]] = []

    def play() -> None:
        told[:] = run_perfect_physics(scene, collisions)

    pair = interleaved(
        play,
        running("exact", scene, collisions),
        size.repeats,
        once=True,
    )
    what = f"Galperin mass {100**size.rival_digits:,}, {collisions:,} collisions: perfect-physics / exact"
    final = uninterrupted(engine("exact").run(scene, events=collisions)).final.circles
    right = [(float(vx), float(vy)) for vx, vy in told] == [(float(c.vx), float(c.vy)) for c in final]
    answer = f"perfect-physics ends with {'the exact' if right else 'OTHER'} velocities"
    return Figure("galperin-perfect-physics", what, *pair, Target("ratio", "at least", 1_000), answer)


def _agreed(name: str, scene: Scene, told: list[Any]) -> str:
    """How far a peer's list of collisions is that of the certified run."""
    events = uninterrupted(engine("exact").run(scene, events=len(told))).events
    right = [pair for event in events for pair in event.impulses]
    same = next((k for k, (a, b) in enumerate(zip(told, right, strict=False)) if a != b), len(told))
    return f"{name} has {'all' if same == len(told) else f'the first {same:,}'} of {len(told):,} collisions in order"


def long_galperin(size: Workload) -> Figure:
    """Tens of thousands of collisions between two bodies and a wall."""
    scene, collisions = galperin(size.digits)
    pair = interleaved(running("exact", scene, collisions), running("double", scene, collisions), 1)
    what = f"Galperin mass {100**size.digits:,}, {collisions:,} collisions: exact / double"
    return Figure("galperin-long", what, *pair, Target("seconds", "at most", 60))


def galperin(digits: int) -> tuple[Any, int]:
    """The scene and its number of collisions, floor(pi * 10**n)."""
    return scene_of(f"galperin:n={digits}"), int("31415926535"[: digits + 1])


def pymunk_overhead(size: Workload) -> Figure:
    """The pymunk engine, with all that it records, against the bare loop of time steps that it wraps."""
    from ....floating.pymunk_engine import PymunkEngine

    scene, runner = scene_of(GAS), PymunkEngine()
    until = size.steps * runner.dt

    def bare() -> None:
        step, dt = runner.space(scene).space.step, runner.dt
        for _ in range(size.steps):
            step(dt)

    pair = interleaved(lambda: uninterrupted(runner.run(scene, until=until)), bare, 3 * size.repeats)
    what = f"10 discs, {size.steps:,} time steps: pymunk engine / bare space.step"
    return Figure("pymunk-overhead", what, *pair, Target("ratio", "at most", 1.2))


def start_up(size: Workload) -> Figure:
    """What the shortest of runs takes, over what an interpreter takes that does nothing: processor time, in turns.

    Modules are compiled before, as those of an installed package are.
    """
    package = __name__.partition(".compare")[0]
    run, nothing = ["-P", "-m", package, "run", "gas", "--events", "5"], ["-P", "-c", "pass"]
    processor_time(run)
    taken = [(processor_time(run), processor_time(nothing)) for _ in range(4 * size.repeats + 1)]
    ours, least = (statistics.median(each) for each in zip(*taken, strict=True))
    what = f"{package} run gas --events 5 / python -c pass, processor time"
    return Figure("start-up", what, ours, least, Target("ratio", "at most", 6))


def processor_time(words: list[str]) -> float:
    """Seconds that an interpreter with these words takes of the processor, its own and the system's for it.

    >>> processor_time(["-c", "pass"]) > 0
    True
    """
    from resource import RUSAGE_CHILDREN, getrusage

    told = {key: value for key, value in os.environ.items() if key != "PYTHONDONTWRITEBYTECODE"}
    before = getrusage(RUSAGE_CHILDREN)
    subprocess.run([sys.executable, *words], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env=told)
    after = getrusage(RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


Benchmark: TypeAlias = Callable[[Workload], Figure]

BENCHMARKS: dict[str, Benchmark] = {
    "gas-billiards": gas_against_billiards,
    "gas-double": gas_against_double,
    "double-billiards": double_against_billiards,
    "gas-long": long_gas,
    "gas-long-billiards": long_gas_against_billiards,
    "galperin-perfect-physics": galperin_against_perfect_physics,
    "galperin-long": long_galperin,
    "pymunk-overhead": pymunk_overhead,
    "start-up": start_up,
}
"""Every figure of few discs, by name. A new one adds its function and one line here."""
