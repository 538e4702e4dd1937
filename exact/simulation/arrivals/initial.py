"""Which circles, walls and rims of a scene touch at time 0, decided exactly."""

from __future__ import annotations

from functools import lru_cache

from ....scenarios.scene import Scene
from ...laws.formulas import pair_gap
from ...replay.contact import Entry, Touch, touch_of


@lru_cache(maxsize=8)
def touching_at_start(scene: Scene) -> tuple[Touch, ...]:
    """The contacts at gap zero at time 0, in scene order.

    >>> from truebreak.scenarios import Circle, Scene
    >>> touching_at_start(Scene([Circle(0, 0), Circle("sqrt(2)", "sqrt(2)"), Circle(5, 5)]))
    (Pair(a=0, b=1),)
    """
    circles = scene.circles
    fixed = [circle.fixed for circle in circles]
    return tuple(touch_of(scene, i, j) for i, j in scene.touching if not (fixed[i] and j < len(circles) and fixed[j]))


@lru_cache(maxsize=8)
def rims_at_start(scene: Scene) -> tuple[Entry, ...]:
    """The centres of movable circles on the rim of a pocket at time 0.

    >>> from truebreak.scenarios import Circle, Pocket, Scene
    >>> rims_at_start(Scene([Circle(0, 0, vx=1)], pockets=[Pocket(2, 0, 2)]))
    (Entry(circle=0, pocket=0, kind='pocket'),)
    """
    found: list[Entry] = []
    for i, circle in enumerate(scene.circles):
        for k, pocket in enumerate(scene.pockets):
            dx, dy = pocket.x - circle.x, pocket.y - circle.y
            if not circle.fixed and pair_gap(dx, dy, pocket.r).sign() == 0:
                found.append(Entry(i, k))
    return tuple(found)
