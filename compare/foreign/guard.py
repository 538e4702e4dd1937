"""Asks engines that are not truebreak's own: what they raise is told in one line, and one that hangs is ended.

What such an engine says is checked where it is asked: its run here for errors and elsewhere (`validation`) for what it
holds, its motion at every reading, and the engines that it names as finer, wider and firmer.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any, SupportsFloat

from ...scenarios.errors import SceneError
from ...scenarios.trajectory import AT_AN_END, StopReason, Trajectory
from ..engines import engine as engine_named
from ..validation import EngineError, check_engine

if TYPE_CHECKING:
    from ...scenarios.engine import Engine
    from ...scenarios.numbers.quantity import QuantityLike
    from ...scenarios.scene import Scene
    from ...scenarios.trajectory import OnProgress

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

    Somebody else's is made in a process of its own where that is asked for, or where seconds or memory are limited.

    Raises:
        EngineError: if somebody else's raises what is neither a `SceneError` nor an interruption, or does not survive.
        TimeIsUp: where the seconds of a `time_limit` around it are over, and it has no end of its own.
    """
    if is_own(engine):
        return engine.run(scene, until=until, events=events, progress=progress)
    from .isolation import Apart, run_apart  # here, since runs of truebreak's own need none of what that imports

    apart = Apart.wanted()
    if apart is None:
        told = _run_of_another(engine, scene, until, events, progress)
    else:
        told = run_apart(partial(_run_of_another, engine, scene, until, events), engine.name, scene, progress, apart)
    if isinstance(told, Trajectory) and not _of_truebreak(type(told.motion)):
        return replace(told, motion=GuardedMotion(engine, told.motion, scene.ids[: len(scene.circles)]))
    return told


def cut_short(run: Trajectory, until: float) -> bool:
    """Whether an engine has ended a run before it was asked to, though it does not say that nothing is left to happen:
    what the run has not by then is evidence of nothing."""
    return float(run.final_time) < until and run.stop.reason not in (StopReason.QUIET, *AT_AN_END)


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


def _run_of_another(
    engine: Engine, scene: Scene, until: QuantityLike | None, events: int | None, progress: OnProgress | None
) -> Any:
    """What somebody else's run gives."""
    try:
        return engine.run(scene, until=until, events=events, progress=progress)
    except SceneError:
        raise
    except (Exception, SystemExit) as error:
        raise _raised(engine, "run", error) from error


def _of_truebreak(kind: type) -> bool:
    return kind.__module__.startswith(f"{OWN}.") and not kind.__module__.startswith(ADAPTERS)


READINGS = "; state(time) and sample(times) must answer from 0 to final_time"


def _raised(engine: Engine, what: str, error: BaseException, remedy: str = "") -> EngineError:
    """What an engine raised, in one line."""
    line = error.__traceback__
    while line is not None and line.tb_next is not None:
        line = line.tb_next
    place = "" if line is None else f" ({line.tb_frame.f_code.co_filename}:{line.tb_lineno})"
    reason = " ".join(str(error).split())
    return EngineError(f"engine {engine.name!r}: {what} raised {type(error).__name__}: {reason}{place}{remedy}")


class GuardedMotion:
    """Somebody else's motion, each reading of which is checked.

    Attributes:
        engine: whose it is.
        motion: what it handed back.
        circles: the ids of the circles of the scene.
    """

    def __init__(self, engine: Engine, motion: Any, circles: Sequence[str]) -> None:
        self.engine, self.motion, self.circles = engine, motion, circles

    def state(self, time: Any) -> list[tuple[Any, Any, Any, Any]]:
        """As `Motion.state`.

        Raises:
            EngineError: for what it raises, and for a state that is not four finite numbers for each circle.
        """
        what = f"motion.state at t = {float(time):.9g}"
        try:
            rows = [tuple(row) for row in self.motion.state(time)]
        except Exception as error:
            raise _raised(self.engine, what, error, READINGS) from error
        where = f"engine {self.engine.name!r}: {what}"
        if len(rows) != len(self.circles) or any(len(row) != 4 for row in rows):
            told = f"{where} gave rows of {[len(row) for row in rows]} numbers"
            raise EngineError(f"{told}; must be (x, y, vx, vy) of each of the {len(self.circles)} circles")
        for circle, row in zip(self.circles, rows, strict=True):
            for key, value in zip(("x", "y", "vx", "vy"), row, strict=True):
                if not (math.isfinite(value) if isinstance(value, float) else isinstance(value, SupportsFloat)):
                    raise EngineError(f"{where}: circle {circle!r}: {key} = {str(value)[:60]}; must be a finite number")
        return rows

    def sample(self, times: Sequence[float]) -> Any:
        """As `Motion.sample`.

        Raises:
            EngineError: for what it raises, and for an array of another shape, or of other than finite numbers.
        """
        import numpy as np  # here, since nothing else does at the start of a command

        try:
            told = np.asarray(self.motion.sample(times), dtype=float)
        except Exception as error:
            raise _raised(self.engine, "motion.sample", error, READINGS) from error
        shape = (len(times), len(self.circles), 4)
        where = f"engine {self.engine.name!r}: motion.sample"
        if told.shape != shape:
            raise EngineError(f"{where} gave an array of shape {told.shape}; must be {shape}: times, circles, 4")
        if not np.isfinite(told).all():
            k, circle, _ = np.argwhere(~np.isfinite(told))[0]
            at = f"circle {self.circles[circle]!r} at t = {times[k]:.9g}"
            raise EngineError(f"{where}: {at}: {told[k, circle].tolist()}; must be finite")
        return told

    def __getattr__(self, name: str) -> Any:
        """What else the motion has."""
        if name in ("engine", "motion", "circles") or name.startswith("__"):
            raise AttributeError(name)
        return getattr(self.motion, name)


def finer_of(engine: Engine) -> Engine | None:
    """`engine.finer()`, checked.

    Raises:
        EngineError: for what it raises, for what is no engine, and for a step that is not shorter.
    """
    told = _further(engine, "finer")
    if told is not None and not (engine.step and told.step and told.step < engine.step):
        raise EngineError(f"engine {engine.name!r}: finer gave a step of {told.step!r}; must be below {engine.step!r}")
    return told


def wider_of(engine: Engine) -> Engine | None:
    """`engine.wider()`, checked.

    Raises:
        EngineError: for what it raises, for what is no engine, and for numbers of no more bits.
    """
    told = _further(engine, "wider")
    if told is not None and told.bits is not None and not (engine.bits and told.bits > engine.bits):
        raise EngineError(f"engine {engine.name!r}: wider gave {told.bits!r} bits; must be above {engine.bits!r}")
    return told


def firmer_of(engine: Engine) -> Engine | None:
    """`engine.firmer()`, checked.

    Raises:
        EngineError: for what it raises, and for what is no engine.
    """
    return _further(engine, "firmer")


def _further(engine: Engine, what: str) -> Engine | None:
    try:
        told = getattr(engine, what)()
    except SceneError:  # it goes no further, and says so
        return None
    except Exception as error:
        raise _raised(engine, what, error) from error
    try:
        return None if told is None else check_engine(told)
    except EngineError as error:
        raise EngineError(f"engine {engine.name!r}: {what} gave what is no engine: {error}") from None


ALLOWANCES = ("slop", "margin", "threshold", "compliance", "deceleration")
"""What an engine may declare of its model, in `allows`: lengths by which contacts may overlap or be apart, a normal
speed below which nothing bounces, a share of each impulse, the speed that is lost in a unit of time."""


def allowances(engine: Any, scene: Scene) -> dict[str, float]:
    """What an engine declares that its contacts may do beyond rounding (`ALLOWANCES`), in its attribute `allows`.

    Lengths and speeds are in the scene's units; one whose own follow the scene has a method `allows` of the scene.
    """
    told: Any = getattr(engine, "allows", None)
    told = told(scene) if callable(told) else told
    if not isinstance(told, Mapping):
        return {}
    found: dict[str, float] = {}
    for key, value in told.items():
        if key in ALLOWANCES and isinstance(value, int | float) and value > 0:
            found[key] = float(value)
    return found
