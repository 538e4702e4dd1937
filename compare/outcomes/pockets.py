"""Which balls enter a pocket, and when."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ...scenarios.trajectory import Trajectory


def pocketed(trajectory: Trajectory) -> dict[str, Any] | None:
    """For each circle whose centre enters a pocket, the first pocket and the instant, to a double's precision.

    None for a scene without pockets.
    """
    scene = trajectory.scene
    if not scene.pockets:
        return None
    end = float(trajectory.final_time)
    entered = [(p.circle, p.pocket, float(p.time)) for p in trajectory.pocketings]
    first = {circle: {"pocket": p, "time": t} for circle, p, t in reversed(entered) if t <= end}
    return {str(c.id): first[str(c.id)] for c in scene.circles if str(c.id) in first}
