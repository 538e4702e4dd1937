"""The break pattern: for each ball, whom it met and where on the table it ended."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from .pockets import pocketed

if TYPE_CHECKING:
    from ...scenarios.scene import Scene
    from ...scenarios.trajectory import Trajectory

COLUMNS, ROWS = 5, 3
"""The cells of a table. Both numbers are odd, so that no mirror line of a table parts two cells: a ball on
it would be in one or the other by rounding alone."""


class WallTable(NamedTuple):
    """The rectangle that the axis-parallel walls of a scene enclose."""

    left: float
    bottom: float
    right: float
    top: float

    def cell(self, x: float, y: float) -> str:
        """The cell of a place: a letter from the left and a number from the bottom.

        >>> WallTable(0, 0, 4, 2).cell(0.5, 0.5), WallTable(0, 0, 4, 2).cell(3.5, 1.5)
        ('A1', 'E3')
        """
        column = int((x - self.left) / (self.right - self.left) * COLUMNS)
        row = int((y - self.bottom) / (self.top - self.bottom) * ROWS)
        return f"{chr(ord('A') + min(max(column, 0), COLUMNS - 1))}{min(max(row, 0), ROWS - 1) + 1}"


def table(scene: Scene) -> WallTable | None:
    """The rectangle between the outermost axis-parallel walls; None unless there are two of each
    direction."""
    upright = [float(w.x0) for w in scene.walls if w.x0 == w.x1]
    level = [float(w.y0) for w in scene.walls if w.y0 == w.y1]
    if len(set(upright)) < 2 or len(set(level)) < 2:
        return None
    return WallTable(min(upright), min(level), max(upright), max(level))


def is_break(scene: Scene) -> bool:
    """Whether a scene is one of a break: it has pockets, or a table on which all balls but one are at rest.

    >>> from truebreak.scenarios import catalogue
    >>> is_break(catalogue.build("rack:rows=2,pockets=no")), is_break(catalogue.build("gas"))
    (True, False)
    """
    movable = [c for c in scene.circles if not c.fixed]
    struck = [c for c in movable if not c.at_rest]
    return len(movable) > 1 and table(scene) is not None and (bool(scene.pockets) or len(struck) == 1)


def break_pattern(trajectory: Trajectory) -> dict[str, Any] | None:
    """For each circle that can move, the partners that it met and the cell (or pocket) that it ended in.

    Cells are those of a grid of 5 by 3 on the table, A1 at the lower left. None unless the scene is one of a break.
    """
    return pattern(trajectory) if is_break(trajectory.scene) else None


def pattern(trajectory: Trajectory) -> dict[str, Any]:
    """For each circle that can move, the partners that it met; on a table, where it ended too."""
    scene = trajectory.scene
    bounds = table(scene)
    met: dict[str, set[str]] = {str(c.id): set() for c in scene.circles if not c.fixed}
    for event in trajectory.events:
        for first, second in event.impulses:
            if first in met:
                met[first].add(second)
            if second in met:
                met[second].add(first)
    pockets = pocketed(trajectory) or {}
    found: dict[str, Any] = {}
    for circle in trajectory.final.circles:
        if circle.id not in met:
            continue
        found[circle.id] = {"met": [name for name in scene.ids if name in met[circle.id]]}
        if bounds is not None:
            entry = pockets.get(circle.id)
            place = bounds.cell(float(circle.x), float(circle.y))
            found[circle.id]["ended"] = entry["pocket"] if entry else place
    return found
