"""The motion of a run that did not begin."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from ..scenarios.scene import Scene


@dataclass(frozen=True)
class Still:
    """The start of a scene, at any time."""

    scene: Scene

    def state(self, time: Any) -> list[tuple[Any, Any, Any, Any]]:
        """(x, y, vx, vy) of every circle, exactly."""
        return [(c.x, c.y, c.vx, c.vy) for c in self.scene.circles]

    def sample(self, times: Sequence[float]) -> Any:
        """Shape (times, circles, 4): the same as doubles."""
        row = [[float(value) for value in values] for values in self.state(0)]
        return np.array([row for _ in times])
