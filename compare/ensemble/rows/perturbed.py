"""Scenes beside a scene: circles displaced a little, which tells what an exact observer errs by, or nudged a little."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from ....exact.exact_engine import ExactEngine
from ....scenarios.catalogue.scene_entry import Draw
from ....scenarios.engine import Declared
from ....scenarios.errors import SceneError
from ....scenarios.numbers.quantity import Quantity
from ....scenarios.things import Circle

if TYPE_CHECKING:
    from ....scenarios.numbers.quantity import QuantityLike
    from ....scenarios.scene import Scene
    from ....scenarios.trajectory import OnProgress, Trajectory

GRAIN = 1000
"""Displacements are drawn in thousandths of their size."""


def displaced(scene: Scene, size: Quantity, seed: int) -> Scene:
    """The scene with every circle that can move displaced by up to `size` in x and in y.

    Raises:
        SceneError: if circles overlap then.

    >>> from truebreak.scenarios import catalogue
    >>> near = displaced(catalogue.build("gas:n=3"), Quantity.of("10**-12"), 1)
    >>> abs(float(near.circles[0].x - catalogue.build("gas:n=3").circles[0].x)) <= 1e-12
    True
    """
    draw = Draw(seed)
    circles: list[Circle] = []
    for c in scene.circles:
        if c.fixed:
            circles.append(c)
            continue
        dx, dy = (size * draw.between(-GRAIN, GRAIN) / GRAIN for _ in range(2))
        circles.append(Circle(c.x + dx, c.y + dy, c.r, c.vx, c.vy, m=c.m, id=c.id, point=c.point))
    return scene.with_changes(circles=circles)


def nudged(scene: Scene, size: Quantity, seed: int) -> Scene:
    """The scene with every velocity changed a little, and nothing else: what touches goes on touching.

    A component of a velocity changes by up to `size` times the larger component of it. Circles at rest stay at rest.

    >>> from truebreak.scenarios import catalogue
    >>> near = nudged(catalogue.build("cradle"), Quantity.of("1/1000"), 1)
    >>> [(str(c.vx), str(c.vy)) for c in near.circles[:2]], near.circles[0].x == catalogue.build("cradle").circles[0].x
    ([('1000133/1000000', '123/250000'), ('0', '0')], True)
    """
    draw = Draw(seed)
    circles: list[Circle] = []
    for c in scene.circles:
        room = size * max(abs(c.vx), abs(c.vy))
        vx, vy = (v + room * draw.between(-GRAIN, GRAIN) / GRAIN for v in (c.vx, c.vy))
        circles.append(Circle(c.x, c.y, c.r, vx, vy, m=c.m, id=c.id, point=c.point))
    return scene.with_changes(circles=circles, name=f"{scene.name}, perturbed {seed}")


@dataclass(frozen=True)
class Perturbed(Declared):
    """The exact engine, given the scene displaced: every decision is proved, of another scene.

    Attributes:
        size: the largest displacement of a coordinate.
        seed: of the displacements.
    """

    size: Quantity
    seed: int = 1

    def __post_init__(self) -> None:
        if self.size.sign() <= 0:
            raise SceneError(f"--perturb {self.size}: must be above zero")

    @property
    def name(self) -> str:
        """`perturbed`."""
        return "perturbed"

    def run(
        self,
        scene: Scene,
        *,
        until: QuantityLike | None = None,
        events: int | None = None,
        progress: OnProgress | None = None,
    ) -> Trajectory:
        """The certified history of the displaced scene, given as that of the scene asked for."""
        near = displaced(scene, self.size, self.seed)
        told = ExactEngine().run(near, until=until, events=events, progress=progress)
        return replace(told, scene=scene, engine=self.name)
