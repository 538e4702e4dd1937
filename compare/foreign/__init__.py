"""Engines that are not truebreak's own: their logs, and what their runs are recorded with.

>>> from truebreak.compare.foreign import Recording
>>> from truebreak.scenarios import Circle, Scene
>>> recording = Recording(Scene([Circle(0, 0, vx=1, id="a"), Circle(4, 0, id="b")]))
>>> recording.hit(2.0, "a", "b")
>>> recording.trajectory().final["b"].vx
1.0
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...scenarios.lazy import handed_on

if TYPE_CHECKING:
    from .isolation import isolated
    from .log_engine import LogEngine, read_log
    from .recorded import RecordedEngine
    from .recording import Recording

__all__ = ["LogEngine", "RecordedEngine", "Recording", "isolated", "read_log"]

_HOMES = {
    "LogEngine": "log_engine",
    "RecordedEngine": "recorded",
    "Recording": "recording",
    "isolated": "isolation",
    "read_log": "log_engine",
}

__getattr__, __dir__ = handed_on(__name__, _HOMES)
