"""A scene with every number rounded to the nearest double: what an engine of doubles is really given."""

from __future__ import annotations

from collections.abc import Callable

from ....scenarios.errors import SceneError
from ....scenarios.numbers.quantity import Quantity
from ....scenarios.scene import Scene
from ....scenarios.things import Circle, Wall


def rounded(scene: Scene) -> Scene:
    """The scene with every coordinate, radius, velocity and mass replaced by its nearest double.

    Raises:
        SceneError: if the rounded circles overlap, or a number is beyond the doubles.

    >>> scene = Scene([Circle("1/3", 0)])
    >>> rounded(scene).circles[0].x == scene.circles[0].x, rounded(rounded(scene)) == rounded(scene)
    (False, True)
    """
    return _with_numbers(scene, lambda value: Quantity.of(_double(value)))


def shifted(scene: Scene, share: Quantity) -> Scene:
    """The scene with every number a share of the way to its nearest double.

    Raises:
        SceneError: as `rounded`.

    >>> scene = Scene([Circle("1/3", 0)])
    >>> shifted(scene, Quantity.of(1)).circles == rounded(scene).circles
    True
    """
    return _with_numbers(scene, lambda value: value + (Quantity.of(_double(value)) - value) * share)


def _with_numbers(scene: Scene, changed: Callable[[Quantity], Quantity]) -> Scene:
    """The scene with every coordinate, radius, velocity and mass changed in one way."""
    circles = [
        Circle(
            *map(changed, (c.x, c.y, c.r, c.vx, c.vy)),
            m=c.m if isinstance(c.m, str) else changed(c.m),
            id=c.id,
            point=c.point,
        )
        for c in scene.circles
    ]
    walls = [Wall(*map(changed, (w.x0, w.y0, w.x1, w.y1)), id=w.id) for w in scene.walls]
    return scene.with_changes(circles=circles, walls=walls)


def _double(value: Quantity) -> float:
    try:
        return float(value)
    except OverflowError:
        raise SceneError(f"{value.text()[:40]}: is beyond the doubles") from None
