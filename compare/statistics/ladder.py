"""Ensembles in engines of ever more bits, held against the certified ensemble of the same starts."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from statistics import NormalDist, fmean, stdev
from typing import TYPE_CHECKING

from ...exact.exact_engine import ExactEngine
from ...scenarios.engine import DEFAULT_EVENTS
from ...scenarios.errors import SceneError
from ...scenarios.trajectory import StopReason
from ..engines import engine as engine_named
from ..foreign.guard import run_guarded

if TYPE_CHECKING:
    from ...scenarios.engine import Engine
    from ...scenarios.scene import Scene
    from ...scenarios.trajectory import Trajectory
    from .quantities import Measured

LEVEL = 0.05
"""Of each test, before it is shared out among all tests of a table."""

LOST = 0.05
"""Share of runs that an ensemble may lose: with more, what is left is no sample of it."""

MORE_EVENTS = 10
"""A run with so many times the events of the certified one has stuck: it no longer gets on in time."""

ENDS = (StopReason.HORIZON, StopReason.QUIET)
"""Of a run that tells something."""

NORMAL = NormalDist()


@dataclass(frozen=True)
class Ensemble:
    """One quantity over the scenes of an ensemble.

    Attributes:
        values: for each scene; None where the run is lost: it stuck, or was refused.
        endless: how many of the lost ones stopped by themselves, in rounds without end.
    """

    values: tuple[float | None, ...]
    endless: int = 0

    @property
    def lost(self) -> int:
        """Runs that tell nothing."""
        return sum(value is None for value in self.values)


@dataclass(frozen=True)
class Bias:
    """How far an engine's ensemble is from the certified one.

    Attributes:
        value: mean of the differences, start by start.
        error: its standard error.
        margin: what does no harm, in the quantity's own unit.
        lost: runs that tell nothing.
        endless: those of them that stopped by themselves, in rounds without end.
        runs: all of them.
        p_differs: of no bias at all, by the mean's normal distribution.
        p_harms: of a bias of the margin or more, of either sign (two one-sided tests, Schuirmann 1987).
    """

    value: float
    error: float
    margin: float
    lost: int
    endless: int
    runs: int
    p_differs: float
    p_harms: float

    def verdict(self, tests: int) -> str:
        """`unharmed` (the bias is proved to be below the margin), `biased` (it is proved not to be nothing), both, or
        `not told`; each at the level shared out among so many tests (Bonferroni). `runs lost` comes first, and excludes
        `unharmed`."""
        level, lost = LEVEL / tests, self.lost > LOST * self.runs
        words = ["runs lost"] if lost else ["unharmed"] if self.p_harms < level else []
        words += ["biased"] if self.p_differs < level else []
        return ", ".join(words) or "not told"


def bias(exact: Ensemble, other: Ensemble, margin: float) -> Bias:
    """The bias of an ensemble against the certified one of the same starts.

    >>> told = bias(Ensemble((1.0, 2.0, 3.0, 4.0)), Ensemble((1.1, 2.2, 3.1, 4.2)), 1.0)
    >>> round(told.value, 3), told.verdict(1)
    (0.15, 'unharmed, biased')
    """
    pairs = [(a, b) for a, b in zip(exact.values, other.values, strict=True) if a is not None and b is not None]
    runs = other.lost, other.endless, len(other.values)
    if len(pairs) < 2:
        return Bias(math.nan, math.nan, margin, *runs, 1.0, 1.0)
    gaps = [b - a for a, b in pairs]
    value, error = fmean(gaps), stdev(gaps) / math.sqrt(len(gaps))
    if error == 0:
        return Bias(value, error, margin, *runs, float(value == 0), float(abs(value) >= margin))
    differs = 2 * (1 - NORMAL.cdf(abs(value) / error))
    harms = 1 - NORMAL.cdf((margin - abs(value)) / error)
    return Bias(value, error, margin, *runs, differs, harms)


def power(exact: Ensemble, margin: float, tests: int) -> float:
    """The chance that an unbiased engine is proved unharmed: foreseen from the certified ensemble alone.

    Chaos makes the two runs of a start independent, so a difference scatters by sqrt(2) times what a value does.

    >>> round(power(Ensemble((1.0, 2.0, 3.0, 4.0)), 5.0, 1), 2)
    1.0
    """
    values = [value for value in exact.values if value is not None]
    error = math.sqrt(2 / len(values)) * stdev(values)
    if error == 0:
        return 1.0
    return max(0.0, 2 * NORMAL.cdf(margin / error - NORMAL.inv_cdf(1 - LEVEL / tests)) - 1)


def certified(quantity: Measured, scenes: Sequence[Scene]) -> tuple[Ensemble, list[int]]:
    """The quantity in certified runs, and how many events each has.

    Raises:
        SceneError: if a run is not certified to its end.
    """
    values: list[float | None] = []
    events: list[int] = []
    for scene in scenes:
        run = _run(ExactEngine(), scene, quantity.until, None)
        if not run.certified or run.stop.reason not in ENDS:
            raise SceneError(f"{scene.name!r}: its run is not certified ({run.stop.message})")
        values.append(quantity.tell(run))
        events.append(len(run.events))
    return Ensemble(tuple(values)), events


def approximate(quantity: Measured, scenes: Sequence[Scene], events: Sequence[int], name: str) -> Ensemble:
    """The quantity in an engine's runs of the same starts; a run that sticks tells nothing.

    Raises:
        SceneError: for an engine that there is not.
    """
    engine = engine_named(name)
    values: list[float | None] = []
    endless = 0
    for scene, count in zip(scenes, events, strict=True):
        most = MORE_EVENTS * max(count, MORE_EVENTS)
        try:
            run = _run(engine, scene, quantity.until, most)
        except SceneError:
            values.append(None)
            continue
        endless += run.stop.reason is StopReason.BUDGET
        value = quantity.tell(run) if run.stop.reason in ENDS else None
        values.append(value if value is not None and math.isfinite(value) else None)
    return Ensemble(tuple(values), endless)


def _run(engine: Engine, scene: Scene, until: int | None, events: int | None) -> Trajectory:
    """A run to a time; or, without one, to its quiet end or its return; with at most so many events."""
    if scene.reverse_after is None:
        return run_guarded(
            engine, scene, until=until, events=DEFAULT_EVENTS if until is None and events is None else events
        )
    if events is None:
        return run_guarded(engine, scene)
    turned = run_guarded(engine, scene, events=scene.reverse_after + 1).reversal
    if turned is None:
        raise SceneError(f"{scene.name!r}: engine {engine.name!r} does not turn back")
    return run_guarded(engine, scene, until=2 * float(turned.time), events=events)
