"""Scenes beside a scene, in which what falls on one instant there comes apart: witnesses of what is realisable."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from fractions import Fraction
from random import Random
from typing import TYPE_CHECKING, Any

from ...scenarios.errors import SceneError
from ...scenarios.things import Circle

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ...scenarios.scene import Scene
    from ...scenarios.trajectory import Trajectory
    from ..certificate.certified import Certified

NEARBY = Fraction(1, 10**20)
"""Largest displacement of a coordinate: far below what moves any later event noticeably."""

GRAIN = 1000
"""Displacements are drawn in steps of `NEARBY` divided by this."""

WITNESS_WORK = 3_000
"""Events times circles that trying nearby scenes may take."""

LEAST_TRIED, MOST_TRIED = 8, 32


@dataclass(frozen=True)
class Witness:
    """A nearby scene and the break pattern that the exact engine certifies for it.

    Attributes:
        run: the run that came to it.
        certificate: that of the run, if it was asked for and there is one.
    """

    scene: Scene
    pattern: Mapping[str, Any]
    run: Trajectory = field(repr=False, compare=False)
    certificate: Certified | None = field(default=None, repr=False, compare=False)


def nearby_scenes(scene: Scene, work: int) -> Iterator[Scene]:
    """Scenes whose circles are displaced by up to `NEARBY`, drawn from seeds 0, 1, ...; those that overlap left out.

    Radii are smaller by twice that, so that circles that touch come apart.

    Args:
        work: what one run takes, in events times circles.
    """
    for seed in range(max(LEAST_TRIED, min(MOST_TRIED, WITNESS_WORK // max(work, 1)))):
        try:
            yield nearby(scene, seed)
        except SceneError:
            continue


def nearby(scene: Scene, seed: int) -> Scene:
    """One nearby scene.

    Raises:
        SceneError: if its circles overlap.

    >>> from truebreak.scenarios import Scene
    >>> nearby(Scene([Circle(0, 0, id="a")]), 1).circles[0].r.text()
    '49999999999999999999/50000000000000000000'
    """
    draw = Random(seed)
    circles = []
    for c in scene.circles:
        moved = [NEARBY * draw.randint(-GRAIN, GRAIN) / GRAIN for _ in range(2)]
        x, y = (c.x, c.y) if c.fixed else (c.x + moved[0], c.y + moved[1])
        r = c.r if c.point else c.r - 2 * NEARBY
        circles.append(Circle(x, y, r, c.vx, c.vy, m=c.m, id=c.id, point=c.point))
    return scene.with_changes(circles=circles, name=f"{scene.name}, nearby {seed}")
