"""Other people's engines, given our scenes, so that a benchmark can time them beside ours: their loop, and no more."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ....scenarios.trajectory import Contact
from ...adapters.billiards import table_of
from ...adapters.perfect_physics import world_of

if TYPE_CHECKING:
    from ....scenarios.scene import Scene


def run_billiards(scene: Scene, collisions: int) -> list[Contact]:
    """Runs a scene of moving circles in `billiards` (float64, event-driven) for a number of collisions.

    The same loop as that package's own `Billiard.evolve`, ended by a count instead of a time. Returns who met
    whom, in order.

    Source: https://github.com/markus-ebke/python-billiards

    Raises:
        NotInstalled: if `billiards` is not installed.
    """
    rows = [(float(c.x), float(c.y), float(c.vx), float(c.vy)) for c in scene.circles]
    table, names = table_of(scene, rows, 0.0)
    met: list[Contact] = []
    while len(met) < collisions and min(table.toi_next[0], table.obstacles_next[0]) < float("inf"):
        if table.toi_next[0] <= table.obstacles_next[0]:
            _, i, j = table.bounce_ballball()
            met.append(Contact(scene.ids[i], scene.ids[j]))
        else:
            _, i, wall = table.bounce_ballobstacle()
            met.append(Contact(scene.ids[i], names[wall]))
    return met


def run_perfect_physics(scene: Scene, collisions: int) -> list[tuple[Any, Any]]:
    """Runs a scene in `perfect-physics` (SymPy throughout) for a number of instants.

    Returns the velocities at the end, circle by circle.

    Source: https://pypi.org/project/perfect-physics/

    Raises:
        NotInstalled: if `perfect-physics`, or something that it imports, is not installed.
    """
    world = world_of(scene)
    world.run_in_place(collisions, show=False)
    return [(circle.vx, circle.vy) for circle in world.circle_list]
