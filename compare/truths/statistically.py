"""Published rates and exponents, measured over certified ensembles."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from fractions import Fraction

from ...exact.engine import ExactEngine
from ...exact.results.growth import Displacements, unit_displacements
from ...exact.results.impacts import impacts
from ...scenarios import catalogue
from ...scenarios.catalogue.draw import Draw
from ...scenarios.catalogue.scenes.billiards import FOLDED, IN_A_BOX, PINBALL
from ...scenarios.trajectory import Trajectory
from ..chaos.following import follow
from ..chaos.spectrum import spectrum
from ..engines import engine
from .truth import OURS, Measured, Truth, near, same

CHERNOV = "N. Chernov, Entropy, Lyapunov exponents, and mean free path for billiards, J. Stat. Phys. 88 (1997), 1"
DAHLQVIST = "P. Dahlqvist, Lyapunov exponent of the Sinai billiard, chao-dyn/9601007"
APERY = 1.2020569031595942
"""zeta(3)."""


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


@dataclass(frozen=True)
class Rates:
    """What an ensemble of certified runs comes to.

    Attributes:
        time: of all runs together.
        hits: impacts between circles in it.
        exponent: the largest exponent per unit time, as the growth over all runs.
    """

    time: float
    hits: int
    exponent: float


def hits(run: Trajectory) -> int:
    """Impacts between circles."""
    names = {str(circle.id) for circle in run.scene.circles}
    return sum(pair.second in names for event in run.events for pair in event.impulses)


def ensemble(specs: Iterable[str], until: int, exponent: bool = False) -> Rates:
    """Certified runs of scenes up to a time."""
    time, met, gain, length = 0.0, 0, 0.0, 0.0
    for spec in specs:
        run = ExactEngine().run(catalogue.build(spec), until=until)
        time += until
        met += hits(run)
        if exponent:
            told = spectrum(run.scene, impacts(run, len(run.events)), 1)
            gain += float(told.gains[told.skipped :, 0].sum())
            length += float(told.lengths[told.skipped :].sum())
    return Rates(time, met, gain / length if length else math.nan)


def _free_path() -> Measured:
    told = ensemble((f"point:size=1,disc=1/5,{way}" for way in directions(12, 5)), 1000)
    return near(told.time / told.hits, (1 - math.pi / 25) / (2 / 5), 0.03, 4)


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


def _two_in_a_box() -> Measured:
    told = ensemble((f"two-in-a-box:seed={seed}" for seed in range(1001, 1021)), 1000)
    return near(told.hits / told.time, two_disc_rate(1.0, 0.1, 0.98), 0.03, 4)


def dahlqvist(r: float) -> float:
    """The exponent of Sinai's billiard per hit of the disc, up to O(R ln(R)**2).

    >>> round(dahlqvist(0.2), 3)
    3.091
    """
    return -2 * math.log(r) + 1 - 4 * math.log(2) + 27 * APERY / (2 * math.pi**2)


def _sinai(r: str, until: int, room: float) -> Measured:
    told = ensemble((f"point:size=1,disc={r},{way}" for way in directions(30, 7)), until, exponent=True)
    return near(told.exponent * told.time / told.hits, dahlqvist(float(Fraction(r))), room, 4)


def _hexagon(d: str, until: int, published: float) -> Measured:
    told = ensemble((f"hexagon:d={d},{way}" for way in directions(40, 3)), until, exponent=True)
    return near(told.exponent, published, 0.03, 4)


def _gas_exponent() -> Measured:
    run = ExactEngine().run(catalogue.build("gas"), events=4000)
    return near(spectrum(run.scene, impacts(run, 4000), 1).per_time().value, 0.3208, 0.04, 4)


def _gas_growth() -> Measured:
    run = ExactEngine().run(catalogue.build("gas"), events=200)
    carried = Displacements(run.scene, unit_displacements(run.scene)[:, :, :1])
    for index, struck in enumerate(impacts(run, 200)):
        carried.through(struck)
        if carried.scale + math.log2(float((carried.matrix**2).sum())) / 2 >= 53:
            return near(index, 173, 0.05, 4)
    return same("not in 200 events", "173")


def _left(scene: str, published: int) -> Measured:
    told = follow(ExactEngine().run(catalogue.build(scene), events=300), engine("double"))
    assert told.alignment.divergence is not None
    return same(str(told.alignment.divergence.event), str(published))


def _triangle_escape() -> Measured:
    """gamma with exp(4 g)/9.899 + exp((6 - sqrt(3)) g)/11.771 = 1, by bisection."""
    lengths, factors = (4.0, 6 - math.sqrt(3)), (5 + 2 * math.sqrt(6), 11.771455196385560606)
    low, high = 0.0, 1.0
    for _ in range(60):
        middle = (low + high) / 2
        total = sum(math.exp(middle * length) / factor for length, factor in zip(lengths, factors, strict=True))
        low, high = (middle, high) if total < 1 else (low, middle)
    return near(low, 0.4103384077693464893384613078192, 0.01, 5)


STATISTICAL = (
    Truth("Unit square with a disc of radius 1/5: mean path between disc hits, area/(2 R)", "2.18584", CHERNOV,
          "truebreak run point:size=1,disc=1/5", _free_path, True),
    Truth("Two discs of radius 1/10 in a unit square: how often they meet", "0.485268", IN_A_BOX,
          "truebreak run two-in-a-box", _two_in_a_box, True),
    *(Truth(f"Sinai billiard, R = {r}: exponent per hit of the disc, up to O(R ln(R)**2)",
            f"{dahlqvist(float(Fraction(r))):.3f}", DAHLQVIST,
            f"truebreak chaos point:size=1,disc={r}", lambda r=r, u=u, room=room: _sinai(r, u, room), True)
      for r, u, room in (("1/5", 100, 0.07), ("1/10", 200, 0.06), ("1/20", 400, 0.05))),
    Truth("Three fixed discs at distance 6: escape rate; here the first order of its cycle expansion, from the "
          "multipliers above", "0.4103384077693464893384613078192", "P. Cvitanovic et al., ChaosBook (recalled)",
          "truebreak chaos pinball:discs=3,r=0", _triangle_escape),
    *(Truth(f"Triangular Lorentz gas, spacing {d}: exponent per unit time", told, source,
            f"truebreak chaos hexagon:d={d}", lambda d=d, until=until, value=value: _hexagon(d, until, value), True)
      for d, until, value, told, source in (
          ("21/10", 120, 2.669, "2.669", OURS), ("11/5", 120, 2.105, "2.105", OURS),
          ("2*sqrt(3)", 400, 0.636, "0.636; 0.62 to 0.68", f"{OURS}; {FOLDED}"))),
    Truth("Ten discs in a box: exponent per unit time", "0.3208", OURS,
          "truebreak chaos gas --events 4000 --engines none", _gas_exponent, True),
    Truth("Ten discs in a box: the event at which a displacement has grown by 2**53", "173",
          OURS, "truebreak chaos gas", _gas_growth),
    Truth("Ten discs in a box: the event at which doubles leave the history", "161", OURS,
          "truebreak compare gas --engines double", lambda: _left("gas", 161)),
    Truth("Two-disc pinball: the bounce at which doubles are lost, foreseen 53 ln(2)/ln(5 + 2 sqrt(6)) = 16.03", "16",
          PINBALL, "truebreak compare pinball:r=0 --engines double", lambda: _left("pinball:r=0", 16)),
)  # fmt: skip
"""Items that hold up to the scatter of an ensemble, or up to the next order of an expansion."""
