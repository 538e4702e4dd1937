"""Published rates and exponents, measured over certified ensembles."""

from __future__ import annotations

import math
from fractions import Fraction
from functools import cache

from ...exact.exact_engine import ExactEngine
from ...scenarios import catalogue
from ...scenarios.catalogue.billiards import FOLDED, IN_A_BOX, PINBALL
from ...scenarios.numbers.quantity import Quantity
from ..chaos.following import follow
from ..chaos.growth.spectrum import spectrum
from ..engines import engine
from ..repeller.escape import escape
from ..tangent.growth import Displacements, unit_displacements
from ..tangent.impacts import impacts
from . import ensembles
from .ensembles import Record, directions, estimate, recorded
from .exactly import CHAOSBOOK, ESCAPE_RATE, REPELLER
from .truth import OURS, Measured, Truth, near, only, same, within

CHERNOV = "N. Chernov, Entropy, Lyapunov exponents, and mean free path for billiards, J. Stat. Phys. 88 (1997), 1"
DAHLQVIST = "P. Dahlqvist, Lyapunov exponent of the Sinai billiard, chao-dyn/9601007"
APERY = 1.2020569031595942
"""zeta(3)."""

STATED = 0.003
"""Share by which the exponents of the Lorentz gas that were measured before may be off."""

LONG = 16_000
"""Events along which the exponent of the gas is measured."""

SOUGHT = 20_000
"""Certified runs of the experiment on escape."""

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


def _free_path() -> Measured:
    told = estimate(points(), ensembles.path)
    return within(told.value, told.error, PATH, 0.015)


def _any_path() -> Measured:
    told = estimate(points(), ensembles.any_path)
    return within(told.value, told.error, ANY_PATH, 0.015)


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
    told = estimate(boxes(), ensembles.rate)
    return within(told.value, told.error, two_disc_rate(1.0, 0.1, 0.98), 0.015)


def dahlqvist(r: float) -> float:
    """The exponent of Sinai's billiard per hit of the disc, up to O(R ln(R)**2).

    >>> round(dahlqvist(0.2), 3)
    3.091
    """
    return -2 * math.log(r) + 1 - 4 * math.log(2) + 27 * APERY / (2 * math.pi**2)


def _sinai(r: str, until: int, room: float) -> Measured:
    told = estimate(sinai(r, until), ensembles.exponent_per_hit)
    return near(told.value, dahlqvist(float(Fraction(r))), room, 4, told.error)


def _hexagon(d: str, until: int, runs: int, published: float) -> Measured:
    records = recorded((f"hexagon:d={d},{way}" for way in directions(runs, 3)), until, growth=True)
    told = estimate(records, ensembles.exponent)
    return within(told.value, told.error, published, 0.005, STATED)


def _gas_exponent() -> Measured:
    run = ExactEngine().run(catalogue.build("gas"), events=LONG)
    told = spectrum(run.scene, impacts(run, LONG), 1).per_time()
    assert told.low is not None and told.high is not None
    return within(told.value, (told.high - told.low) / 4, 0.3208, 0.01)


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


def _escape() -> Measured:
    told = escape(Quantity.of(6), SOUGHT)
    return within(told.rate, told.room, float(ESCAPE_RATE), 0.01)


STATISTICAL = (
    Truth("Unit square with a disc of radius 1/5: mean path between hits of anything, pi area/perimeter",
          f"{ANY_PATH:.5f}", CHERNOV, only("hits of anything"), _any_path, True),
    Truth("Unit square with a disc of radius 1/5: mean path between disc hits, area/(2 R)", f"{PATH:.5f}", CHERNOV,
          only("between disc hits"), _free_path, True),
    Truth("Two discs of radius 1/10 in a unit square: how often they meet", "0.485268", IN_A_BOX,
          only("how often they meet"), _two_in_a_box, True),
    *(Truth(f"Sinai billiard, R = {r}: exponent per hit of the disc, up to O(R ln(R)**2)",
            f"{dahlqvist(float(Fraction(r))):.3f}", DAHLQVIST,
            only(f"R = {r}:"), lambda r=r, u=u, room=room: _sinai(r, u, room), True)
      for r, u, room in (("1/5", 100, 0.07), ("1/10", 200, 0.06), ("1/20", 400, 0.05))),
    Truth("Three fixed discs at distance 6: escape rate, by escaping", ESCAPE_RATE, CHAOSBOOK,
          f"{REPELLER} --runs {SOUGHT}", _escape, True),
    *(Truth(f"Triangular Lorentz gas, spacing {d}: exponent per unit time", told, source,
            only(f"spacing {d}:"), lambda d=d, u=until, n=runs, value=value: _hexagon(d, u, n, value), True)
      for d, until, runs, value, told, source in (
          ("21/10", 120, 80, 2.669, "2.669 +- 0.3 %", OURS), ("11/5", 120, 80, 2.105, "2.105 +- 0.3 %", OURS),
          ("2*sqrt(3)", 400, 400, 0.636, "0.636 +- 0.3 %; 0.62 to 0.68", f"{OURS}; {FOLDED}"))),
    Truth("Ten discs in a box: exponent per unit time", "0.3208", OURS,
          f"truebreak chaos gas --events {LONG} --engines none", _gas_exponent, True),
    Truth("Ten discs in a box: the event at which a displacement has grown by 2**53", "173",
          OURS, only("grown by 2**53"), _gas_growth),
    Truth("Ten discs in a box: the event at which doubles leave the history", "161", OURS,
          "truebreak compare gas --engines double", lambda: _left("gas", 161)),
    Truth("Two-disc pinball: the bounce at which doubles are lost, foreseen 53 ln(2)/ln(5 + 2 sqrt(6)) = 16.03", "16",
          PINBALL, "truebreak compare pinball:r=0 --engines double", lambda: _left("pinball:r=0", 16)),
)  # fmt: skip
"""Items that hold up to the scatter of an ensemble, or up to the next order of an expansion."""
