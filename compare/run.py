"""Runs one scene in one engine, which may be given by its name."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .engines import engine as engine_named
from .foreign.guard import run_guarded

if TYPE_CHECKING:
    from ..scenarios.engine import Engine
    from ..scenarios.numbers.quantity import QuantityLike
    from ..scenarios.scene import Scene
    from ..scenarios.trajectory import OnProgress, Trajectory


def run(
    scene: Scene,
    engine: str | Engine = "exact",
    *,
    until: QuantityLike | None = None,
    events: int | None = None,
    progress: OnProgress | None = None,
) -> Trajectory:
    """The history of a scene in one engine.

    Args:
        engine: an engine, or its name with its parameters, as on the command line: `interval:bits=128`.
        until, events, progress: see `Engine.run`.

    Raises:
        SceneError: for an engine that is not known, for a limit that is not above zero, and for what somebody else's
            engine raises.

    >>> from truebreak.scenarios import Circle, Scene
    >>> scene = Scene([Circle(0, 0, vx=1), Circle(4, 1)])
    >>> run(scene).events[0].time.text(), float(run(scene, "double").events[0].time)
    ('-sqrt(3) + 4', 2.267949192431123)
    """
    chosen = engine_named(engine) if isinstance(engine, str) else engine
    return run_guarded(chosen, scene, until=until, events=events, progress=progress)
