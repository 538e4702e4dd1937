"""A log in the place of an engine: it runs the one scene of which it is, as far as it goes."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from ...scenarios.engine import SCENE_KEYS, Unchangeable, horizon
from ...scenarios.errors import SceneError
from ...scenarios.trajectory import StopReason, Trajectory
from ..validation import EngineError
from .log import read_log
from .runs.recording import Recording

if TYPE_CHECKING:
    from pathlib import Path

    from ...scenarios.numbers.quantity import QuantityLike
    from ...scenarios.scene import Scene
    from ...scenarios.trajectory import OnProgress


@dataclass(frozen=True)
class LogEngine(Unchangeable):
    """An engine of which there is a log, and no more: it cannot be run on, nor made finer.

    Attributes:
        recording: what the log says.
        bits, step, rounds_input: what the engine that wrote it is (see `scenarios.Engine`).
        lacks: keys of a scene that it does not follow. A log cannot say who leaves play.

    >>> from truebreak.scenarios import Circle, Scene
    >>> scene = Scene([Circle(0, 0, vx=1, id="a"), Circle(4, 0, id="b")])
    >>> log = LogEngine.of([(2.0, "a", "b")], scene)
    >>> log.run(scene, until=5).stop.message
    'the record ends at time 2.0'
    """

    recording: Recording = field(repr=False, compare=False)
    name: str = "log"
    bits: int | None = 53
    step: float | None = None
    rounds_input: bool = True
    lacks: frozenset[str] = frozenset({"capture"})

    @classmethod
    def of(
        cls,
        log: str | Path | Iterable[tuple[float, str, str]],
        scene: Scene,
        name: str | None = None,
        *,
        bits: int | None = 53,
        step: float | None = None,
        rounds_input: bool = True,
        lacks: frozenset[str] = frozenset({"capture"}),
    ) -> LogEngine:
        """The engine of a log: a file, or (time, a, b) of each event.

        Raises:
            EngineError: naming the line, the field and the remedy.
        """
        if isinstance(log, Iterable) and not isinstance(log, str):
            shown = name or "log"
            recording = Recording(scene, shown, bits=bits, step=step)
            for number, line in enumerate(log):
                recording.where = f"{shown}, event {number}"
                try:
                    time, a, b = line
                except (TypeError, ValueError):
                    raise EngineError(f"{recording.where}: {str(line)[:60]}; must be (time, a, b)") from None
                recording.hit(time, a, b)
            recording.end()
        else:
            shown = name or str(log)
            recording = read_log(log, scene, name, bits=bits, step=step)
        return cls(recording, shown, bits, step, rounds_input, lacks)

    @property
    def scene_keys(self) -> frozenset[str]:
        """All but those that it lacks."""
        return SCENE_KEYS - self.lacks

    @property
    def last(self) -> Trajectory:
        """All that the log says."""
        return self.recording.trajectory()

    @property
    def over(self) -> bool:
        """Whether it says that nothing is left to happen."""
        return self.last.stop.reason is StopReason.QUIET

    def run(
        self,
        scene: Scene,
        *,
        until: QuantityLike | None = None,
        events: int | None = None,
        progress: OnProgress | None = None,
    ) -> Trajectory:
        """What the log says up to the limits; nothing beyond its end is known.

        Raises:
            SceneError: for another scene than that of which it is.
        """
        if scene.digest != self.recording.scene.digest:
            raise SceneError(f"{self.name!r} is a log of {self.recording.scene.name!r}, not of {scene.name!r}")
        time, count = horizon(scene, until, events)
        return self.recording.trajectory(until=time, events=count)
