"""Escape by experiment: certified runs from a fan of directions, and the rate at which they are lost."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

from ...exact.exact_engine import ExactEngine
from ...scenarios.errors import SceneError
from ...scenarios.numbers.quantity import Quantity
from ...scenarios.scene import Scene
from ...scenarios.things import Circle
from ...scenarios.trajectory import StopReason
from .orbits import pinball

FIRST = 2
"""Bounces after which a fan is all but forgotten: at distance 6 the rate from the second to the third bounce is 0.16 %
too low, from the third to the fourth 0.006 % (of 400,000 directions, in doubles)."""


@dataclass(frozen=True)
class Escape:
    """What a fan of certified runs says.

    Attributes:
        runs: how many.
        survivors: of them, how many bounce at least once, twice, ...
        rate: escape rate per unit time, from those of two bounces to those of three.
        room: what it may be off by because the fan tells the width of a window of directions to one direction only.
    """

    runs: int
    survivors: tuple[int, ...]
    rate: float
    room: float


def fan(distance: Quantity, count: int) -> Iterator[Scene]:
    """A point in the middle, in directions evenly spread in the tangent of half their angle.

    They reach from the middle of the first disc to its rim, or near it; the rest of the circle is their mirror image.

    >>> [scene.circles[0].vx**2 + scene.circles[0].vy**2 == 1 for scene in fan(Quantity.of(6), 2)]
    [True, True]
    """
    scene = pinball(distance)
    start, *discs = scene.circles
    last = Quantity.of("9/10") / distance
    for k in range(count):
        t = last * (2 * k + 1) / (2 * count)
        square = 1 + t * t
        flying = Circle(0, 0, r=0, vx=(1 - t * t) / square, vy=2 * t / square, id=start.id, point=True)
        yield scene.with_changes(circles=[flying, *discs])


def bounces(scene: Scene) -> list[float]:
    """When the point bounces, until it has escaped.

    Raises:
        SceneError: if its run is not certified to the end.
    """
    run = ExactEngine().run(scene)
    if not run.certified or run.stop.reason is not StopReason.QUIET:
        raise SceneError(f"{scene.name!r}: its run is not certified to its escape ({run.stop.message})")
    return [float(event.time) for event in run.events]


def rate_between(early: Sequence[float], late: Sequence[float]) -> float:
    """The rate g at which the sum of exp(g t) over the later times is that over the earlier ones.

    Among those that stay, a bounce later is as likely as it is short: where the starts are forgotten, this sum stays
    the same from bounce to bounce.

    Raises:
        SceneError: if nothing survives.

    >>> round(rate_between([1.0] * 8, [3.0] * 2), 6) == round(math.log(4) / 2, 6)
    True
    """
    if not late:
        raise SceneError("no run bounces often enough; take more of them")
    low, high = 0.0, 1.0
    while _surplus(high, early, late) < 0:
        high *= 2
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if _surplus(middle, early, late) < 0 else (low, middle)
    return low


def _surplus(rate: float, early: Sequence[float], late: Sequence[float]) -> float:
    return sum(math.exp(rate * time) for time in late) - sum(math.exp(rate * time) for time in early)


def escape(distance: Quantity, count: int, progress: Callable[[int, int], None] | None = None) -> Escape:
    """Runs the fan, each direction certified until it has escaped.

    Args:
        progress: called after each run with how many are done, of how many.

    Raises:
        SceneError: as `pinball`, `bounces` and `rate_between`.

    >>> told = escape(Quantity.of(6), 60)
    >>> told.survivors, abs(told.rate - 0.41034) < told.room
    ((59, 12, 2), True)
    """
    times: list[list[float]] = []
    for done, scene in enumerate(fan(distance, count), 1):
        times.append(bounces(scene))
        if progress is not None:
            progress(done, count)
    longest = max(map(len, times))
    survivors = tuple(sum(len(mine) > k for mine in times) for k in range(longest))
    early, late = ([mine[k - 1] for mine in times if len(mine) >= k] for k in (FIRST, FIRST + 1))
    rate = rate_between(early, late)
    apart = sum(late) / len(late) - sum(early) / len(early)
    windows = [2 ** max(k - 2, 0) for k in (FIRST, FIRST + 1)]
    return Escape(count, survivors, rate, (windows[0] / len(early) + windows[1] / len(late)) / apart)
