"""What is measured of each run of an ensemble, and over which scenes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

from ...exact.exact_engine import ExactEngine
from ...scenarios import catalogue
from ...scenarios.numbers.quantity import Quantity
from ...scenarios.things import Circle
from ...scenarios.trajectory import StopReason
from ..chaos.growth.spectrum import spectrum
from ..tangent.impacts import NoTangentMap, impacts
from ..truths.ensembles import directions, met
from .boltzmann import h_returned

if TYPE_CHECKING:
    from ...scenarios.scene import Scene
    from ...scenarios.trajectory import Trajectory


@dataclass(frozen=True)
class Measured:
    """A quantity, as the page on statistics names it before anything is run.

    Attributes:
        name: on the page and in tables.
        margin: a bias of less than this share (or, of H, of its first value) does no harm.
        count: how many starts.
        scenes: the first N of the ensemble.
        until: the time until which each runs; None: to the end of its own.
        tell: its value in one run; None where the run does not tell.
    """

    name: str
    margin: float
    count: int
    scenes: Callable[[int], Sequence[Scene]]
    until: int | None
    tell: Callable[[Trajectory], float | None]


def _rate(run: Trajectory) -> float | None:
    time = float(run.final_time)
    return len(met(run)) / time if time > 0 else None


def _exponent(run: Trajectory) -> float | None:
    try:
        return spectrum(run.scene, impacts(run, len(run.events)), 1).per_time().value if run.events else None
    except NoTangentMap:
        return None


def _bounces(run: Trajectory) -> float | None:
    return float(len(met(run))) if run.stop.reason is StopReason.QUIET else None


def _points(count: int) -> list[Scene]:
    return [catalogue.build(f"point:size=1,disc=1/5,{way}") for way in directions(count, 11)]


def _boxes(count: int) -> list[Scene]:
    return [catalogue.build(f"two-in-a-box:seed={seed}") for seed in range(2001, 2001 + count)]


def _hexagons(count: int) -> list[Scene]:
    return [catalogue.build(f"hexagon:d=21/10,{way}") for way in directions(count, 13)]


@cache
def _escapes(count: int) -> list[Scene]:
    """Starts that hit a disc at all: the others tell nothing of escape."""
    found: list[Scene] = []
    seed = 3001
    while len(found) < count:
        scene = catalogue.build(f"three-disc:distance=5/2,seed={seed}")
        if ExactEngine().run(scene, events=1).events:
            found.append(scene)
        seed += 1
    return found


WINDOW = Quantity.of("10**-6")
"""Width of the window of directions from which escape is watched: the tangent of half an angle."""

LONG_LIVED = 12
"""Bounces of the start about which the window lies."""


@cache
def _window(count: int) -> list[Scene]:
    """Starts in a narrow window of directions about one that stays long."""
    seed = 4001
    while len(ExactEngine().run(catalogue.build(f"three-disc:distance=5/2,seed={seed}")).events) < LONG_LIVED:
        seed += 1
    scene = catalogue.build(f"three-disc:distance=5/2,seed={seed}")
    ball, *discs = scene.circles
    found: list[Scene] = []
    for k in range(count):
        t = WINDOW * (2 * k - count + 1) / (2 * count)
        c, s = (1 - t * t) / (1 + t * t), 2 * t / (1 + t * t)
        turned = Circle(ball.x, ball.y, ball.r, c * ball.vx - s * ball.vy, s * ball.vx + c * ball.vy, m=ball.m,
                        id=ball.id, point=True)  # fmt: skip
        found.append(scene.with_changes(circles=[turned, *discs]))
    return found


def _echoes(count: int) -> list[Scene]:
    return [catalogue.build(f"echo:rows=5,after=60,seed={seed}") for seed in range(5001, 5001 + count)]


QUANTITIES = (
    Measured("hits of the disc a unit of time (free path)", 0.10, 160, _points, 120, _rate),
    Measured("meetings of two discs a unit of time", 0.10, 160, _boxes, 40, _rate),
    Measured("Lyapunov exponent of the Lorentz gas", 0.05, 80, _hexagons, 40, _exponent),
    Measured("bounces before escape (escape rate)", 0.10, 400, _escapes, None, _bounces),
    Measured("bounces before escape, from a narrow window", 0.10, 200, _window, None, _bounces),
    Measured("H after a reversal, less H at the start", 0.05, 40, _echoes, None, h_returned),
)
"""In the order of the hypotheses."""
