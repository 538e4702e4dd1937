"""Other people's engines, given our scenes, so that a benchmark can time them beside ours."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from ...scenarios.event import Contact

if TYPE_CHECKING:
    from ...scenarios.scene import Scene
    from ...scenarios.things import Wall


class MissingPackage(Exception):
    """A package that only benchmarks need is not installed; the message says how to get it."""

    def __init__(self, package: str) -> None:
        super().__init__(f"needs {package}: pip install 'truebreak[bench]' (in a checkout: pip install -e '.[bench]')")


def optional(module: str, package: str) -> Any:
    """The module, imported now.

    Raises:
        MissingPackage: if it, or something that it imports, is not installed.
    """
    try:
        return import_module(module)
    except ImportError as error:
        raise MissingPackage(package) from error


def run_billiards(scene: Scene, collisions: int) -> list[Contact]:
    """Runs a scene of moving circles in `billiards` (float64, event-driven) for a number of collisions.

    The same loop as that package's own `Billiard.evolve`, ended by a count instead of a time. Returns who met
    whom, in order.

    Source: https://github.com/markus-ebke/python-billiards

    Raises:
        MissingPackage: if `billiards` is not installed.
    """
    billiards = optional("billiards", "billiards")
    first = scene.circles[0]
    names = {_one_sided(billiards, wall, first): str(wall.id) for wall in scene.walls}
    table = billiards.Billiard(obstacles=list(names))
    for c in scene.circles:
        mass = float("inf") if isinstance(c.m, str) else float(c.m)
        table.add_ball((float(c.x), float(c.y)), (float(c.vx), float(c.vy)), float(c.r), mass)
    met: list[Contact] = []
    while len(met) < collisions and min(table.toi_next[0], table.obstacles_next[0]) < float("inf"):
        if table.toi_next[0] <= table.obstacles_next[0]:
            _, i, j = table.bounce_ballball()
            met.append(Contact(scene.ids[i], scene.ids[j]))
        else:
            _, i, wall = table.bounce_ballobstacle()
            met.append(Contact(scene.ids[i], names[wall]))
    return met


def _one_sided(billiards: Any, wall: Wall, circle: Any) -> Any:
    """Its walls act from one side only: the side on which the circles are."""
    side = "left" if wall.height(circle.x, circle.y).sign() > 0 else "right"
    start, end = (float(wall.x0), float(wall.y0)), (float(wall.x1), float(wall.y1))
    return billiards.InfiniteWall(start, end, inside=side)


def run_perfect_physics(scene: Scene, collisions: int) -> list[tuple[Any, Any]]:
    """Runs a scene in `perfect-physics` (SymPy throughout) for a number of instants.

    Returns the velocities at the end, circle by circle.

    Source: https://pypi.org/project/perfect-physics/

    Raises:
        MissingPackage: if `perfect-physics`, or something that it imports, is not installed.
    """
    theirs = optional("perfect_physics", "perfect-physics, cloudpickle and seaborn")
    circles = [
        theirs.Circle(*(getattr(c, key).sympy() for key in ("x", "y", "r", "vx", "vy", "m")), id=c.id)
        for c in scene.circles
    ]
    walls = [theirs.Wall(*(getattr(w, key).sympy() for key in ("x0", "y0", "x1", "y1")), id=w.id) for w in scene.walls]
    theirs.World(circles, walls).run_in_place(collisions, show=False)
    return [(circle.vx, circle.vy) for circle in circles]
