"""Runs engines that are not truebreak's own: what they raise is told in one line, and one that hangs is ended."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...scenarios.errors import SceneError, TimeIsUp
from ..validation import EngineError

if TYPE_CHECKING:
    from ...scenarios.engine import Engine
    from ...scenarios.numbers.quantity import QuantityLike
    from ...scenarios.scene import Scene
    from ...scenarios.trajectory import OnProgress, Trajectory

OWN = __name__.partition(".compare")[0]

ADAPTERS = f"{OWN}.compare.adapters."
"""Where other people's engines are adapted: what happens in those is not truebreak's doing."""


def is_own(engine: Engine) -> bool:
    """Whether an engine is one of truebreak's own, which may go beyond the doubles; adapters are not.

    >>> from truebreak.floating import DoubleEngine
    >>> is_own(DoubleEngine())
    True
    """
    home = type(engine).__module__
    return home.startswith(f"{OWN}.") and not home.startswith(ADAPTERS)


def run_guarded(
    engine: Engine,
    scene: Scene,
    *,
    until: QuantityLike | None = None,
    events: int | None = None,
    progress: OnProgress | None = None,
) -> Trajectory:
    """A run of an engine. One of truebreak's own is left to itself.

    Raises:
        EngineError: if somebody else's raises what is neither a `SceneError` nor an interruption.
        TimeIsUp: where the seconds of a `time_limit` around it are over, and it has no end of its own.
    """
    if is_own(engine):
        return engine.run(scene, until=until, events=events, progress=progress)
    return _run_of_another(engine, scene, until, events, progress)


def _run_of_another(
    engine: Engine, scene: Scene, until: QuantityLike | None, events: int | None, progress: OnProgress | None
) -> Trajectory:
    """Somebody else's run. Apart from `run_guarded`, since a function that names `TimeIsUp` is one to be ended."""
    try:
        return engine.run(scene, until=until, events=events, progress=progress)
    except TimeIsUp:
        raise
    except SceneError:
        raise
    except (Exception, SystemExit) as error:
        line = error.__traceback__
        while line is not None and line.tb_next is not None:
            line = line.tb_next
        place = "" if line is None else f" ({line.tb_frame.f_code.co_filename}:{line.tb_lineno})"
        reason = " ".join(str(error).split())
        raise EngineError(f"engine {engine.name!r}: run raised {type(error).__name__}: {reason}{place}") from error
