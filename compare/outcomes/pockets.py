"""Which balls enter a pocket, and when."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import TYPE_CHECKING, Any

from ..engines import is_stepped

if TYPE_CHECKING:
    from ...scenarios.trajectory import Trajectory


def pocketed(trajectory: Trajectory) -> dict[str, Any] | None:
    """For each circle whose centre enters a pocket, the first pocket and the instant, to a double's
    precision.

    An event-driven engine notes the entries itself. For one by time steps they follow from its motion:
    between two events a centre flies straight, and enters a pocket (X, Y, R) when |p + v t - (X, Y)|^2 =
    R^2 has its smaller root within the flight. None for a scene without pockets.
    """
    scene = trajectory.scene
    if not scene.pockets:
        return None
    end = float(trajectory.final_time)
    if not is_stepped(trajectory.engine):
        entered = [(p.circle, p.pocket, float(p.time)) for p in trajectory.pocketings]
        first = {circle: {"pocket": p, "time": t} for circle, p, t in reversed(entered) if t <= end}
        return {str(c.id): first[str(c.id)] for c in scene.circles if str(c.id) in first}
    knots = sorted({0.0, end, *(t for e in trajectory.events if (t := float(e.time)) < end)})
    flights = [(a, b, (a + b) / 2) for a, b in pairwise(knots) if a < (a + b) / 2 < b]
    states = trajectory.sample([middle for _, _, middle in flights])  # an instant itself may be hard to place
    found: dict[str, Any] = {}
    for number, circle in enumerate(scene.circles):
        if circle.fixed:
            continue
        for (start, stop, middle), state in zip(flights, states, strict=True):
            x, y, vx, vy = (float(value) for value in state[number])
            x, y = x - vx * (middle - start), y - vy * (middle - start)
            entries = [
                (start + after, str(pocket.id))
                for pocket in scene.pockets
                if (after := _entry(x - float(pocket.x), y - float(pocket.y), vx, vy, float(pocket.r))) is not None
                and after <= stop - start
            ]
            if entries:
                time, name = min(entries)
                found[str(circle.id)] = {"pocket": name, "time": time}
                break
    return found


def _entry(dx: float, dy: float, vx: float, vy: float, r: float) -> float | None:
    """Time until a point comes within r of the origin; 0 if it is there already, None if it never does.

    >>> _entry(-3.0, 0.0, 1.0, 0.0, 1.0), _entry(-3.0, 2.0, 1.0, 0.0, 1.0)
    (2.0, None)
    """
    gap = dx * dx + dy * dy - r * r
    if gap <= 0:
        return 0.0
    approach, speed2 = dx * vx + dy * vy, vx * vx + vy * vy
    discriminant = speed2 * r * r - (dx * vy - dy * vx) ** 2
    if approach >= 0 or discriminant < 0:
        return None
    return gap / (-approach + math.sqrt(discriminant))
