"""The adapter of billiards, Markus Ebke's event-driven engine of hard discs."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ...scenarios.engine import SCENE_KEYS
from .adapter import Adapted, package, sides

if TYPE_CHECKING:
    from ...scenarios.scene import Scene
    from ..foreign.impulses import Row
    from ..foreign.recording import Recording


@dataclass(frozen=True)
class BilliardsEngine(Adapted):
    """Plays scenes in `billiards` 0.5: doubles, from event to event.

    Its collisions are elastic and without friction as they are. Of several at one instant it does one after the other,
    in its own order; two balls that already overlap by more than 1e-10 of a unit of time do not collide.

    >>> BilliardsEngine().bits
    53
    """

    distribution = "billiards"
    name = "billiards"
    bits = 53

    @property
    def scene_keys(self) -> frozenset[str]:
        """All but `capture`, as its balls never leave play, and `tie_policy`."""
        return SCENE_KEYS - {"capture", "tie_policy", "segment", "restitution"}

    def play(self, scene: Scene, recording: Recording) -> None:
        """Goes from collision to collision.

        Raises:
            NotInstalled: without billiards.
        """
        rows = [(float(c.x), float(c.y), float(c.vx), float(c.vy)) for c in scene.circles]
        table, names = table_of(scene, rows, 0.0)
        turn, turned = math.inf if scene.reverse_at is None else float(scene.reverse_at), False
        while recording.open:
            soonest = min(table.toi_next[0], table.obstacles_next[0])
            if soonest > turn and not turned:
                table, names = _turned(scene, table, turn)
                turned = True
                continue
            if soonest == math.inf:
                return
            try:
                if table.toi_next[0] <= table.obstacles_next[0]:
                    time, i, j = table.bounce_ballball()
                    touched, other = (i, j), scene.ids[j]
                else:
                    time, i, obstacle = table.bounce_ballobstacle()
                    touched, other = (i,), names[obstacle]
            except AssertionError:
                recording.spent("billiards fails an assertion of its own after this event")
                return
            states = {scene.ids[k]: (*table.balls_position[k], *table.balls_velocity[k]) for k in touched}
            recording.hit(float(time), scene.ids[i], other, states)
            if recording.reversal is not None and not turned:
                table, names = _turned(scene, table, float(table.time))
                turned = True


def table_of(scene: Scene, rows: Sequence[Row], time: float) -> tuple[Any, dict[Any, str]]:
    """A table with the scene's balls where rows say, at a time; and whose wall each of its obstacles is.

    Raises:
        NotInstalled: without billiards.
    """
    billiards = package("billiards", "billiards")
    names: dict[Any, str] = {}
    found = sides(scene)
    for place, wall in enumerate(scene.walls):
        start, end = (float(wall.x0), float(wall.y0)), (float(wall.x1), float(wall.y1))
        for side in {row[place] for row in found}:
            names[billiards.InfiniteWall(start, end, inside="left" if side > 0 else "right")] = str(wall.id)
    table = billiards.Billiard(obstacles=list(names))
    table.time = time
    for circle, (x, y, vx, vy) in zip(scene.circles, rows, strict=True):
        table.add_ball((x, y), (vx, vy), float(circle.r), math.inf if circle.fixed else float(circle.m))
    return table, names


def _turned(scene: Scene, table: Any, time: float) -> tuple[Any, dict[Any, str]]:
    """The table at a time, every velocity negated."""
    places = table.balls_position + table.balls_velocity * (time - table.time)
    rows = [(x, y, -vx, -vy) for (x, y), (vx, vy) in zip(places, table.balls_velocity, strict=True)]
    return table_of(scene, rows, time)
