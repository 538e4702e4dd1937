"""How late a meeting may be and still be the same meeting: a rule that knows nothing of the span compared."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ...scenarios.scene import Scene

SLOWER = 2.0
"""A run that takes this many times as long to come to a meeting does not come to it."""


@dataclass(frozen=True)
class Patience:
    """How long one run is waited for where the other has a meeting.

    The rule is a function of the meeting's own time. If it depended on the end of the span, a longer span could
    turn a missing meeting into a late one, and take a divergence back.

    Attributes:
        slack: time granted on top of `SLOWER` times the meeting's own.
    """

    slack: float = 0.0

    def latest(self, time: float) -> float:
        """The last time at which another run may have the meeting that one has at `time`.

        >>> Patience(0.5).latest(3.0)
        6.5
        """
        return SLOWER * time + self.slack


def patience_for(scene: Scene, step: float | None) -> Patience:
    """What a scene's own measures grant: the time in which its fastest circle crosses it, and two time steps.

    >>> from truebreak.scenarios import Circle, Scene
    >>> patience_for(Scene([Circle(0, 0, vx=2), Circle(6, 8)]), None).slack
    6.0
    """
    xs, ys = [float(c.x) for c in scene.circles], [float(c.y) for c in scene.circles]
    across = math.hypot(max(xs) - min(xs), max(ys) - min(ys)) + 2 * max(float(c.r) for c in scene.circles)
    fastest = max(math.hypot(float(c.vx), float(c.vy)) for c in scene.circles)
    return Patience((across / fastest if fastest else 1.0) + 2 * (step or 0.0))
