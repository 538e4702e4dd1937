"""The README's figures: each is a ratio of two things timed in turns in one run.

`python docs/studies/speed_ratios.py [NAME]... [--full]` measures all, or those named, and prints them as a table.
"""

from __future__ import annotations

import argparse
import os
import statistics
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import count
from random import Random
from typing import TYPE_CHECKING, Any, Literal, TypeAlias
from unittest import mock

from truebreak.compare.adapters.adapter import NotInstalled
from truebreak.compare.adapters.billiards import table_of
from truebreak.compare.adapters.perfect_physics import world_of
from truebreak.compare.deadline import uninterrupted
from truebreak.compare.engines import engine, suggestion
from truebreak.compare.grids.computer import timed
from truebreak.exact.certified import certified_decider
from truebreak.scenarios import Circle, Quantity, Scene, Segment, Wall
from truebreak.scenarios.catalogue import build
from truebreak.scenarios.trajectory import Contact

if TYPE_CHECKING:
    from truebreak.scenarios.scene import Scene


def run_billiards(scene: Scene, collisions: int) -> list[Contact]:
    """Runs a scene of moving circles in `billiards` (float64, event-driven) for a number of collisions.

    The same loop as that package's own `Billiard.evolve`, ended by a count instead of a time. Returns who met
    whom, in order.

    Source: https://github.com/markus-ebke/python-billiards

    Raises:
        NotInstalled: if `billiards` is not installed.
    """
    rows = [(float(c.x), float(c.y), float(c.vx), float(c.vy)) for c in scene.circles]
    table, names = table_of(scene, rows, 0.0)
    met: list[Contact] = []
    while len(met) < collisions and min(table.toi_next[0], table.obstacles_next[0]) < float("inf"):
        if table.toi_next[0] <= table.obstacles_next[0]:
            _, i, j = table.bounce_ballball()
            met.append(Contact(scene.ids[i], scene.ids[j]))
        else:
            _, i, wall = table.bounce_ballobstacle()
            met.append(Contact(scene.ids[i], names[wall]))
    return met


def run_perfect_physics(scene: Scene, collisions: int) -> list[tuple[Any, Any]]:
    """Runs a scene in `perfect-physics` (SymPy throughout) for a number of instants.

    Returns the velocities at the end, circle by circle.

    Source: https://pypi.org/project/perfect-physics/

    Raises:
        NotInstalled: if `perfect-physics`, or something that it imports, is not installed.
    """
    world = world_of(scene)
    world.run_in_place(collisions, show=False)
    return [(circle.vx, circle.vy) for circle in world.circle_list]


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
    scene = build(GAS)
    told = run_billiards(scene, size.gas)
    pair = interleaved(running("exact", scene, size.gas), lambda: run_billiards(scene, size.gas), 3 * size.repeats)
    what = f"10 discs, {size.gas:,} collisions: exact / billiards (float64)"
    return Figure("gas-billiards", what, *pair, Target("ratio", "at most", 0.7), _agreed("billiards", scene, told))


def gas_against_double(size: Workload) -> Figure:
    """What certainty costs over this project's own double engine."""
    scene = build(GAS)
    pair = interleaved(running("exact", scene, size.gas), running("double", scene, size.gas), size.repeats)
    return Figure("gas-double", f"10 discs, {size.gas:,} collisions: exact / double", *pair)


def double_against_billiards(size: Workload) -> Figure:
    """Doubles against doubles: this project's engine and another project's, in Python both."""
    scene = build(GAS)
    pair = interleaved(running("double", scene, size.gas), lambda: run_billiards(scene, size.gas), 3 * size.repeats)
    what = f"10 discs, {size.gas:,} collisions: double / billiards (float64)"
    return Figure("double-billiards", what, *pair, Target("ratio", "at most", 0.2))


def long_gas(size: Workload) -> Figure:
    """A long chaotic run, where the precision must keep growing."""
    scene = build(GAS)
    pair = interleaved(running("exact", scene, size.long_gas), running("double", scene, size.long_gas), 1)
    what = f"10 discs, {size.long_gas:,} collisions: exact / double"
    return Figure("gas-long", what, *pair, Target("seconds", "at most", 60))


def long_gas_against_billiards(size: Workload) -> Figure:
    """A long certified run, whose numbers are long, against plain double precision in another project's engine."""
    scene = build(GAS)
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
    return build(f"galperin:n={digits}"), int("31415926535"[: digits + 1])


def pymunk_overhead(size: Workload) -> Figure:
    """The pymunk engine, with all that it records, against the bare loop of time steps that it wraps."""
    from truebreak.floating.pymunk_engine import PymunkEngine

    scene, runner = build(GAS), PymunkEngine()
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
    run, nothing = ["-P", "-m", "truebreak", "run", "gas", "--events", "5"], ["-P", "-c", "pass"]
    processor_time(run)
    taken = [(processor_time(run), processor_time(nothing)) for _ in range(4 * size.repeats + 1)]
    ours, least = (statistics.median(each) for each in zip(*taken, strict=True))
    what = "truebreak run gas --events 5 / python -c pass, processor time"
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


EVENTS_A_DISC = 2
"""Events that a run of a crowd has for each of its discs; what sets the run up is spread over them."""


def crowd_exact(size: Workload) -> Figure:
    """An event, certified, among 1,000 discs against one among ten in another project's engine."""
    return _against_billiards("exact", 1.5, size)


def crowd_double(size: Workload) -> Figure:
    """An event, in doubles, among 1,000 discs against one among ten in another project's engine."""
    return _against_billiards("double", 0.7, size)


def growth_exact(size: Workload) -> Figure:
    """An event, certified, among 10,000 discs against one among 1,000."""
    return _growth("exact", size)


def growth_double(size: Workload) -> Figure:
    """An event, in doubles, among 10,000 discs against one among 1,000."""
    return _growth("double", size)


def set_up_exact(size: Workload) -> Figure:
    """From the catalogue to the first certified event of 10,000 discs, and of 1,000."""
    return _set_up("exact", size)


def set_up_double(size: Workload) -> Figure:
    """From the catalogue to the first event in doubles of 10,000 discs, and of 1,000."""
    return _set_up("double", size)


def processor_times(actions: list[Callable[[], object]], repeats: int) -> list[float]:
    """Median seconds of the processor of some actions, timed in turns."""
    times = [[timed(action).cpu for action in actions] for _ in range(repeats)]
    return [statistics.median(column) for column in zip(*times, strict=True)]


def _against_billiards(engine: str, most: float, size: Workload) -> Figure:
    few, many, events = build(GAS), build(f"gas:n={size.crowd}"), EVENTS_A_DISC * size.crowd
    actions = [lambda: run_billiards(few, size.gas), running(engine, many, events)]
    theirs, ours = processor_times(actions, 2 * size.repeats + 1)
    what = f"an event, {engine} among {size.crowd:,} discs / billiards (float64) among 10; {EVENTS_A_DISC} a disc"
    return Figure(f"crowd-{engine}", what, ours / events, theirs / size.gas, Target("ratio", "at most", most))


EVENTS_AMONG_SEGMENTS = 20
"""As `EVENTS_A_DISC`; segments take longer to set up."""


def among_segments(size: Workload) -> Figure:
    """An event, certified, among 1,000 discs in a box with 200 segments of all directions, against one without."""
    side = int(size.crowd**0.5) + 1
    draw = Random(1)
    off = [[Quantity.of(draw.randint(-9, 9)) / 20 for _ in range(2)] for _ in range(size.crowd)]
    discs = [
        Circle(
            4 * (k % side) + x, 4 * (k // side) + y, vx=f"{draw.randint(-99, 99)}/50", vy=f"{draw.randint(-99, 99)}/50"
        )
        for k, (x, y) in enumerate(off)
    ]
    top = 4 * side - 1
    walls = [Wall(-3, 0, -3, 1), Wall(top, 0, top, 1), Wall(0, -3, 1, -3), Wall(0, top, 1, top)]
    segments: list[Segment] = []
    for place in draw.sample(range((side - 1) ** 2), size.crowd // 5):
        x, y = 4 * (place % (side - 1)) + 2, 4 * (place // (side - 1)) + 2
        dx, dy = (Quantity.of(draw.randint(-70, 70)) / 100 for _ in range(2))
        segments.append(Segment(x - dx, y - dy, x + dx + Quantity.of("1/1000"), y + dy))
    events = EVENTS_AMONG_SEGMENTS * size.crowd
    among, plain = Scene(discs, walls, segments=segments), Scene(discs, walls)
    ours, theirs = processor_times([running("exact", among, events), running("exact", plain, events)], size.repeats)
    what = f"an event, exact among {size.crowd:,} discs and {len(segments)} segments / without these"
    return Figure(
        "crowd-segments",
        f"{what}; {EVENTS_AMONG_SEGMENTS} a disc",
        ours / events,
        theirs / events,
        Target("ratio", "at most", 1.5),
    )


FEW_SEGMENTS = (Segment(3, 5, 4, 9), Segment(11, 4, 14, "11/2", r="1/4"), Segment(13, 14, "33/2", "29/2"))
"""Where no disc of the gas of ten begins."""


def few_segments(engine: str, size: Workload, events: int) -> Figure:
    """An event among ten discs with three segments, against one of the gas without; of so many."""
    plain = build(GAS).with_changes(until=None, events=None)
    among = plain.with_changes(segments=FEW_SEGMENTS)
    ours, theirs = processor_times([running(engine, among, events), running(engine, plain, events)], 3 * size.repeats)
    return Figure(
        f"gas-segments-{engine}",
        f"an event, {engine} among 10 discs and 3 segments / without these; of {events:,}",
        ours / events,
        theirs / events,
        Target("ratio", "at most", 1.3),
    )


def exact_among_few_segments(size: Workload) -> Figure:
    """Of the exact engine."""
    return few_segments("exact", size, size.gas)


def double_among_few_segments(size: Workload) -> Figure:
    """Of the double engine."""
    return few_segments("double", size, size.long_gas)


def gas_of_games(name: str, what: str, most: float, size: Workload, **physics: Any) -> Figure:
    """A certified event of the gas of ten with other keys, against one of the gas as it is."""
    plain = build(GAS).with_changes(until=None, events=None)
    other = plain.with_changes(**physics)
    ours, theirs = processor_times([running("exact", scene, size.gas) for scene in (other, plain)], size.repeats)
    told = f"an event, exact among 10 discs {what} / without; of {size.gas:,}"
    return Figure(name, told, ours / size.gas, theirs / size.gas, Target("ratio", "at most", most))


def gas_with_gravity(size: Workload) -> Figure:
    """With gravity, whose walls fall."""
    return gas_of_games("gas-gravity", "with gravity 1/10", 1.25, size, gravity=(0, "-1/10"))


def among_as_many(name: str, what: str, size: Workload, things: int, **physics: Any) -> Figure:
    """A certified event of the gas of ten with other keys, against one of a gas of as many discs as it has things."""
    other = build(GAS).with_changes(until=None, events=None, **physics)
    plain = build(f"gas:n={things},seed=1").with_changes(until=None, events=None)
    ours, theirs = processor_times([running("exact", scene, size.gas) for scene in (other, plain)], size.repeats)
    told = f"an event, exact among 10 discs {what} / among {things} discs; of {size.gas:,}"
    return Figure(name, told, ours / size.gas, theirs / size.gas, Target("ratio", "at most", 2.5))


def gas_onto_pegs(size: Workload) -> Figure:
    """With gravity, and a board of circles that stand: each is met at a zero of a quartic."""
    discs = build(GAS).circles
    pegs = [Circle(x, y, "1/4", m="oo", id=f"peg{x}-{y}") for x in range(3, 17) for y in range(3, 17)]
    clear = [p for p in pegs if all((p.x - c.x) ** 2 + (p.y - c.y) ** 2 > (p.r + c.r) ** 2 for c in discs)][::12]
    circles, what = [*discs, *clear], f"with gravity 1/10 and {len(clear)} pegs"
    return among_as_many("gas-pegs", what, size, len(circles), gravity=(0, "-1/10"), circles=circles)


def gas_onto_segments(size: Workload) -> Figure:
    """With gravity, and segments: faces that fall, and ends."""
    what = "with gravity 1/10 and 3 segments"
    return among_as_many("gas-segments-gravity", what, size, 13, gravity=(0, "-1/10"), segments=FEW_SEGMENTS)


def gas_with_restitution(size: Workload) -> Figure:
    """With a restitution of 9/10."""
    return gas_of_games("gas-restitution", "with restitution 9/10", 1.1, size, restitution="9/10")


def _growth(engine: str, size: Workload) -> Figure:
    counts = size.large_crowd, size.crowd
    events = [EVENTS_A_DISC * n for n in counts]
    runs = [running(engine, build(f"gas:n={n}"), most) for n, most in zip(counts, events, strict=True)]
    large, small = processor_times(runs, size.repeats)
    what = f"an event, {engine} among {counts[0]:,} discs / among {counts[1]:,}; {EVENTS_A_DISC} a disc"
    name, target = f"crowd-growth-{engine}", Target("ratio", "at most", 2)
    return Figure(name, what, large / events[0], small / events[1], target)


def _set_up(engine: str, size: Workload) -> Figure:
    counts, seed = (size.large_crowd, size.crowd), count(1).__next__

    def first_event(n: int) -> None:
        running(engine, build(f"gas:n={n},seed={seed()}"), 1)()  # each scene is a new one: nothing of it is known

    many, few = processor_times([lambda: first_event(counts[0]), lambda: first_event(counts[1])], size.repeats)
    what = f"catalogue to first event, {engine}: {counts[0]:,} discs / {counts[1]:,}"
    return Figure(f"crowd-set-up-{engine}", what, many, few, Target("seconds", "at most", 2))


def sets_from_the_start(name: str, size: Workload) -> Figure:
    """A run with the deviations of all midpoints in a set from the first rise of its bits on, against one on balls.

    Each takes the bits that it needs: balls more, at less for each event.
    """
    scene, events = build(name).with_changes(until=None, events=None), 3 * size.gas
    plain = running("exact", scene, events)

    def in_sets() -> None:
        with mock.patch.object(certified_decider, "LONG_BITS", 0):
            plain()

    ours, theirs = processor_times([in_sets, plain], size.repeats)
    told = f"{events:,} events of {name}: in sets from the first rise of bits / on balls until 8,000 bits"
    return Figure(f"sets-{scene.name.partition(':')[0]}", told, ours, theirs, Target("ratio", "at least", 1))


def gas_in_sets(size: Workload) -> Figure:
    """Of the gas."""
    return sets_from_the_start(GAS, size)


def mushroom_in_sets(size: Workload) -> Figure:
    """Of a table with an arc."""
    return sets_from_the_start("mushroom", size)


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
    "crowd-exact": crowd_exact,
    "crowd-double": crowd_double,
    "crowd-segments": among_segments,
    "gas-segments-exact": exact_among_few_segments,
    "gas-segments-double": double_among_few_segments,
    "gas-gravity": gas_with_gravity,
    "gas-restitution": gas_with_restitution,
    "gas-pegs": gas_onto_pegs,
    "gas-segments-gravity": gas_onto_segments,
    "sets-gas": gas_in_sets,
    "sets-mushroom": mushroom_in_sets,
    "crowd-growth-exact": growth_exact,
    "crowd-growth-double": growth_double,
    "crowd-set-up-exact": set_up_exact,
    "crowd-set-up-double": set_up_double,
}
"""Every figure, by name. A new one adds its function and one line here."""


def measured(names: Sequence[str], size: Workload) -> Iterator[Figure | str]:
    """Each figure, one after the other, or why it cannot be measured here."""
    for name in names:
        try:
            yield BENCHMARKS[name](size)
        except NotInstalled as missing:
            yield f"{name}: not measured: {missing}"


HEAD = "| figure | ratio | target | first, seconds | second, seconds |\n|---|---:|---|---:|---:|"


def row(figure: Figure) -> str:
    """A line of the table.

    >>> row(Figure("x", "this / that", 3.0, 2.0, Target("ratio", "at most", 2)))
    '| this / that | 1.5 | <= 2: met | 3 | 2 |'
    """
    what = f"{figure.what}; {figure.answer}" if figure.answer else figure.what
    goal = "" if figure.met is None else f"{figure.target}: {'met' if figure.met else 'MISSED'}"
    return f"| {what} | {figure.ratio:,.3g} | {goal} | {figure.numerator:.3g} | {figure.denominator:.3g} |"


def main(arguments: list[str] | None = None, size: Workload | None = None) -> int:
    """Measures and prints; the exit status, 1 if a target is missed."""
    parser = argparse.ArgumentParser(prog="python docs/studies/speed_ratios.py", description="Measure ratios of speed.")
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"some of {', '.join(BENCHMARKS)}; all without one")
    parser.add_argument("--full", action="store_true", help="give perfect-physics 314 collisions: about a minute")
    options = parser.parse_args(arguments)
    for name in options.names:
        if name not in BENCHMARKS:
            parser.error(f"figure {name!r} is not known; {suggestion(name, list(BENCHMARKS))}")
    print(HEAD)
    missed = False
    for figure in measured(options.names or list(BENCHMARKS), size or (FULL if options.full else SHORT)):
        if isinstance(figure, str):
            print(figure, file=sys.stderr)
        else:
            missed |= figure.met is False
            print(row(figure), flush=True)
    return int(missed)


if __name__ == "__main__":
    sys.exit(main())
