"""What a history comes to in numbers: collisions, who hit whom, who moved, and how fast all are at the end."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ...scenarios.trajectory import Trajectory


def collisions(trajectory: Trajectory) -> int:
    """Number of collisions: of pairwise impulses."""
    return trajectory.collisions


def collisions_per_ball(trajectory: Trajectory) -> dict[str, int]:
    """Number of impulses that each circle took part in, in scene order; circles without any are left out."""
    counts = Counter(name for event in trajectory.events for pair in event.impulses for name in pair)
    return {str(c.id): counts[str(c.id)] for c in trajectory.scene.circles if counts[str(c.id)]}


def who_hit_whom(trajectory: Trajectory) -> dict[str, int]:
    """Number of impulses between each pair, under `first-second` in scene order."""
    place = {name: number for number, name in enumerate(trajectory.scene.ids)}
    counts = Counter(pair for event in trajectory.events for pair in event.impulses)
    ordered = sorted(counts.items(), key=lambda item: (place[item[0][0]], place[item[0][1]]))
    return {f"{first}-{second}": count for (first, second), count in ordered}


def moved(trajectory: Trajectory) -> list[str]:
    """Ids of the circles that moved: those that did at the start, and those that were hit."""
    hit = {name for event in trajectory.events for pair in event.impulses for name in pair}
    return [str(c.id) for c in trajectory.scene.circles if not c.at_rest or (str(c.id) in hit and not c.fixed)]


def final_velocities(trajectory: Trajectory) -> dict[str, list[float]]:
    """The velocity (vx, vy) with which each circle that can move ends, as doubles."""
    movable = {str(c.id) for c in trajectory.scene.circles if not c.fixed}
    return {c.id: [float(c.vx), float(c.vy)] for c in trajectory.final.circles if c.id in movable}
