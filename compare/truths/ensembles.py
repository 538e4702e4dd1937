"""Ensembles of certified runs, and what they tell with its standard error, over all of their time or over a part."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from ...exact.exact_engine import ExactEngine
from ...scenarios import catalogue
from ...scenarios.catalogue.scene_entry import Draw
from ..chaos.growth.spectrum import TURNING, spectrum
from ..tangent.impacts import impacts

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ...scenarios.trajectory import Trajectory


def directions(count: int, seed: int = 1) -> Iterator[str]:
    """Settings of unit speeds in rational numbers, drawn from a seed: `vx=...,vy=...`.

    >>> next(directions(1))
    'vx=-236160/876872,vy=844472/876872'
    """
    draw = Draw(seed)
    for _ in range(count):
        p, q = draw.between(1, 999), draw.between(1, 999)
        norm = p * p + q * q
        yield f"vx={p * p - q * q}/{norm},vy={2 * p * q}/{norm}"


def met(run: Trajectory) -> list[float]:
    """The times of impacts between circles."""
    names = {str(circle.id) for circle in run.scene.circles}
    return [float(event.time) for event in run.events for pair in event.impulses if pair.second in names]


@dataclass(frozen=True)
class Record:
    """One certified run, as far as averages need it.

    Attributes:
        until: the time that it covers.
        hits: times of impacts between circles.
        times: of all impacts.
        gains: logarithm of the growth at each event of a displacement that has turned into the direction that grows
            most; and `ends`, the times of the events. Both empty where no growth was asked for.
    """

    until: float
    hits: NDArray[np.float64]
    times: NDArray[np.float64]
    gains: NDArray[np.float64]
    ends: NDArray[np.float64]

    def cut(self, until: float) -> Record:
        """Its beginning."""
        kept = self.ends <= until
        return replace(self, until=until, hits=self.hits[self.hits <= until], times=self.times[self.times <= until],
                       gains=self.gains[kept], ends=self.ends[kept])  # fmt: skip

    def growth(self) -> tuple[float, float]:
        """Growth and the time that it took, without the events in which the displacement turns."""
        skipped = int(TURNING * len(self.gains))
        begin = float(self.ends[skipped - 1]) if skipped else 0.0
        return float(self.gains[skipped:].sum()), float(self.ends[-1]) - begin


def recorded(specs: Iterable[str], until: int, growth: bool = False) -> list[Record]:
    """Certified runs of scenes up to a time."""
    told: list[Record] = []
    for spec in specs:
        run = ExactEngine().run(catalogue.build(spec), until=until)
        assert run.certified, spec
        all_times = [float(event.time) for event in run.events for _ in event.impulses]
        gains, ends = np.zeros(0), np.zeros(0)
        if growth:
            found = spectrum(run.scene, impacts(run, len(run.events)), 1)
            gains, ends = found.gains[:, 0], found.times
        told.append(Record(until, np.array(met(run)), np.array(all_times), gains, ends))
    return told


@dataclass(frozen=True)
class Estimate:
    """What an ensemble says, and its standard error, from the scatter between its runs."""

    value: float
    error: float


def estimate(records: Sequence[Record], tell: Callable[[Sequence[Record]], float]) -> Estimate:
    """A ratio of sums over the runs, with the error of the jackknife: every run is left out once.

    B. Efron, The Jackknife, the Bootstrap and Other Resampling Plans, SIAM (1982).

    >>> runs = [Record(10.0, np.arange(n) + 1.0, np.zeros(0), np.zeros(0), np.zeros(0)) for n in (4, 5, 6)]
    >>> told = estimate(runs, rate)
    >>> told.value, round(told.error, 4)
    (0.5, 0.0577)
    """
    without = [tell([*records[:k], *records[k + 1 :]]) for k in range(len(records))]
    count = len(records)
    return Estimate(tell(records), float(np.std(without)) * (count - 1) ** 0.5)


def rate(records: Sequence[Record]) -> float:
    """Impacts between circles a unit of time."""
    return sum(len(mine.hits) for mine in records) / sum(mine.until for mine in records)


def path(records: Sequence[Record]) -> float:
    """Time between two impacts with circles: at speed 1 the free path between hits of a disc."""
    return 1 / rate(records)


def any_path(records: Sequence[Record]) -> float:
    """Time between two impacts of any kind."""
    return sum(mine.until for mine in records) / sum(len(mine.times) for mine in records)


def exponent(records: Sequence[Record]) -> float:
    """The largest Lyapunov exponent per unit time."""
    gains, lengths = zip(*(mine.growth() for mine in records), strict=True)
    return sum(gains) / sum(lengths)


def exponent_per_hit(records: Sequence[Record]) -> float:
    """The largest Lyapunov exponent per impact between circles."""
    return exponent(records) * path(records)
