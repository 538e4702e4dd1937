"""An engine of one's own, of which only the playing has to be written."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import fields, is_dataclass, replace
from typing import TYPE_CHECKING, Any, Protocol

from ...scenarios.engine import SCENE_KEYS, Engine, Unchangeable, endable, horizon
from ...scenarios.errors import SceneError, TimeIsUp
from .recording import Recording

if TYPE_CHECKING:
    from ...scenarios.numbers.quantity import QuantityLike
    from ...scenarios.scene import Scene
    from ...scenarios.trajectory import OnProgress, Trajectory


class Player(Engine, Protocol):
    """An engine that plays into a recording."""

    @property
    def parameters(self) -> dict[str, Any]:
        """What reports say of its settings."""
        ...

    @property
    def falls(self) -> Any:
        """See `Playing.falls`."""
        ...

    def play(self, scene: Scene, recording: Recording) -> None:
        """See `Playing.play`."""
        ...


class Playing(Unchangeable, ABC):
    """What plays a scene into a `Recording`, in the place of `Engine.run`.

    What it declares follows `Engine`, and may be stated by a class attribute, a field or a property.
    """

    name: str = "mine"
    bits: Any = 53
    rounds_input: Any = True
    scene_keys: Any = SCENE_KEYS
    falls: Any = None
    """How an engine of steps falls under gravity, a `StepFall`; None: its states say."""

    @abstractmethod
    def play(self, scene: Scene, recording: Recording) -> None:
        """Plays a scene while `recording.open`. To return before that is to say that nothing is left to happen."""

    @property
    def parameters(self) -> dict[str, Any]:
        """What reports say of its settings: its fields."""
        return {key: value for key, value in vars(self).items() if not key.startswith("_")}

    def run(
        self: Player,
        scene: Scene,
        *,
        until: QuantityLike | None = None,
        events: int | None = None,
        progress: OnProgress | None = None,
    ) -> Trajectory:
        """The history of `scene` as `play` reports it (see `Engine.run`).

        Raises:
            EngineError: for what cannot be judged; and whatever `play` raises of its own accord.
            SceneError: for arcs, where it does not follow them, and for segments or polygons that move.
        """
        if scene.arcs and "arc" not in self.scene_keys:
            raise SceneError(
                f"{scene.name!r}: has arcs, which engine {self.name!r} does not follow; use another engine, or a chain "
                "of segments, which is another scene"
            )
        if scene.moving_solid is not None:
            told = f"{scene.moving_solid} moves, and no recording is judged there; write walls"
            raise SceneError(f"{scene.name!r}: {told}")
        turns = scene.reverse_at is not None or scene.reverse_after is not None
        returns = turns and until is None and events is None
        time, count = (None, None) if returns else horizon(scene, until, events)
        recording = Recording(
            scene,
            self.name,
            bits=self.bits,
            step=self.step,
            until=time,
            events=count,
            parameters=self.parameters,
            returns=returns,
            progress=progress,
            fall=self.falls,
        )
        try:
            with endable():
                self.play(scene, recording)
        except TimeIsUp as outcome:
            recording.spent(str(outcome))
        if recording.open:
            recording.end(quiet=True)
        return recording.trajectory()


class RecordedEngine(Playing):
    """An engine that plays a scene into a `Recording`; all that an engine owes besides is done here.

    A subclass writes `play`, and sets what it is as class attributes: `name`, `bits`, `step`, `rounds_input`,
    `scene_keys` (see `scenarios.Engine`). One whose parameters are fields of a frozen dataclass takes them on the
    command line; where `step` is such a field, it is made finer by itself.

    >>> from truebreak.scenarios import Circle, Scene
    >>> class Once(RecordedEngine):
    ...     name = "once"
    ...
    ...     def play(self, scene, recording):
    ...         recording.hit(2.0, "a", "b")
    >>> Once().run(Scene([Circle(0, 0, vx=1, id="a"), Circle(4, 0, id="b")])).stop.reason.name
    'QUIET'
    """

    step: Any = None

    def finer(self) -> Engine | None:
        """The same with half the time step, where `step` is a field of a dataclass; else None."""
        if self.step is None or not is_dataclass(self) or "step" not in {f.name for f in fields(self)}:
            return None
        finer: Any = replace(self, step=self.step / 2)
        return finer
