"""Figures of crowds: what an event costs among many discs, and what it takes to get to the first."""

from __future__ import annotations

import statistics
from collections.abc import Callable
from itertools import count

from ..computer import timed
from .figures import GAS, Benchmark, Figure, Target, Workload, running, scene_of
from .rivals import run_billiards

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
    few, many, events = scene_of(GAS), scene_of(f"gas:n={size.crowd}"), EVENTS_A_DISC * size.crowd
    actions = [lambda: run_billiards(few, size.gas), running(engine, many, events)]
    theirs, ours = processor_times(actions, 2 * size.repeats + 1)
    what = f"an event, {engine} among {size.crowd:,} discs / billiards (float64) among 10; {EVENTS_A_DISC} a disc"
    return Figure(f"crowd-{engine}", what, ours / events, theirs / size.gas, Target("ratio", "at most", most))


def _growth(engine: str, size: Workload) -> Figure:
    counts = size.large_crowd, size.crowd
    events = [EVENTS_A_DISC * n for n in counts]
    runs = [running(engine, scene_of(f"gas:n={n}"), most) for n, most in zip(counts, events, strict=True)]
    large, small = processor_times(runs, size.repeats)
    what = f"an event, {engine} among {counts[0]:,} discs / among {counts[1]:,}; {EVENTS_A_DISC} a disc"
    name, target = f"crowd-growth-{engine}", Target("ratio", "at most", 2)
    return Figure(name, what, large / events[0], small / events[1], target)


def _set_up(engine: str, size: Workload) -> Figure:
    counts, seed = (size.large_crowd, size.crowd), count(1).__next__

    def first_event(n: int) -> None:
        running(engine, scene_of(f"gas:n={n},seed={seed()}"), 1)()  # each scene is a new one: nothing of it is known

    many, few = processor_times([lambda: first_event(counts[0]), lambda: first_event(counts[1])], size.repeats)
    what = f"catalogue to first event, {engine}: {counts[0]:,} discs / {counts[1]:,}"
    return Figure(f"crowd-set-up-{engine}", what, many, few, Target("seconds", "at most", 2))


CROWDS: dict[str, Benchmark] = {
    "crowd-exact": crowd_exact,
    "crowd-double": crowd_double,
    "crowd-growth-exact": growth_exact,
    "crowd-growth-double": growth_double,
    "crowd-set-up-exact": set_up_exact,
    "crowd-set-up-double": set_up_double,
}
"""Every figure of a crowd, by name."""
