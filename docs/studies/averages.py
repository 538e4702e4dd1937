"""Averages over ensembles of certified runs, with their standard errors, and the closed forms that some of them have.

`python docs/studies/averages.py` prints how slowly they come to these forms.
"""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from truebreak.compare.chaos.growth.spectrum import TURNING, spectrum
from truebreak.compare.tangent.impacts import impacts
from truebreak.exact.exact_engine import ExactEngine
from truebreak.scenarios import catalogue
from truebreak.scenarios.catalogue.scene_entry import Draw

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from truebreak.scenarios.trajectory import Trajectory


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


APERY = 1.2020569031595942
"""zeta(3)."""

PATH = (1 - math.pi / 25) / (2 / 5)
"""Free path between hits of a disc of radius R = 1/5 in a unit square: area / (2 R)."""

ANY_PATH = math.pi * (1 - math.pi / 25) / (4 + 2 * math.pi / 5)
"""The same between hits of anything: pi area / perimeter."""


@cache
def points() -> list[Record]:
    """A point in a unit square with a disc of radius 1/5."""
    return recorded((f"point:size=1,disc=1/5,{way}" for way in directions(50, 5)), 1000)


@cache
def boxes() -> list[Record]:
    """Two discs in a box."""
    return recorded((f"two-in-a-box:seed={seed}" for seed in range(1001, 1051)), 1000)


@cache
def sinai(r: str, until: int) -> list[Record]:
    """A point in a unit square with a disc, with the growth of a displacement."""
    return recorded((f"point:size=1,disc={r},{way}" for way in directions(60, 7)), until, growth=True)


def two_disc_rate(size: float, r: float, square: float) -> float:
    """How often two discs in a square meet, V**2 = square.

    >>> round(two_disc_rate(1.0, 0.1, 0.98), 6)
    0.485268
    """
    a = size - 2 * r
    s = 2 * r / a
    free = 1 - (math.pi * s**2 - 8 * s**3 / 3 + s**4 / 2)
    slope = 2 * math.pi * s - 8 * s**2 + 2 * s**3
    return 2 * math.sqrt(2) / (3 * math.pi) * math.sqrt(square) * slope / (a * free)


def dahlqvist(r: float) -> float:
    """The exponent of Sinai's billiard per hit of the disc, up to O(R ln(R)**2).

    >>> round(dahlqvist(0.2), 3)
    3.091
    """
    return -2 * math.log(r) + 1 - 4 * math.log(2) + 27 * APERY / (2 * math.pi**2)


HALVINGS = 8
"""The shortest beginnings are so many times halved: down to a handful of hits a run."""

HEAD = "| average | time of each run | hits | estimate | difference from the closed form |\n|---|---|---|---|---|"


def rows(name: str, records: Sequence[Record], tell: Callable[[Sequence[Record]], float], form: float) -> list[str]:
    """One ensemble over ever longer beginnings of its runs, as far as each run hits at all, against the closed form."""
    told: list[str] = []
    for halvings in range(HALVINGS, -1, -2):
        until = records[0].until / 2**halvings
        part = [mine.cut(until) for mine in records]
        if not all(len(mine.hits) for mine in part):
            continue
        found = estimate(part, tell)
        hits = sum(len(mine.hits) for mine in part)
        off = f"{found.value / form - 1:+.1%} +- {found.error / form:.1%}".replace("%", " %")
        told.append(f"| {name} | {until:.4g} | {hits:,} | {found.value:.4g} +- {found.error:.2g} | {off} |")
    return told


def table() -> str:
    """The averages that have closed forms (exponents of the Sinai billiard: the beginning of an expansion in R)."""
    lines = [HEAD]
    lines += rows("path between disc hits", points(), path, PATH)
    lines += rows("path between hits of anything", points(), any_path, ANY_PATH)
    lines += rows("meetings of two discs", boxes(), rate, two_disc_rate(1.0, 0.1, 0.98))
    for r, until in (("1/5", 100), ("1/20", 400)):
        form = dahlqvist(float(Fraction(r)))
        lines += rows(f"exponent per hit, R = {r}", sinai(r, until), exponent_per_hit, form)[-3:]
    return "\n".join(lines)


if __name__ == "__main__":
    argparse.ArgumentParser(prog="python docs/studies/averages.py", description=__doc__).parse_args()
    print(table())
    sys.exit(0)
