"""What an engine declares, and what it hands back, is checked before it is judged."""

from __future__ import annotations

import math
from collections.abc import Sequence, Set
from itertools import pairwise
from typing import TYPE_CHECKING, Any

from ..scenarios.engine import SCENE_KEYS
from ..scenarios.errors import SceneError
from ..scenarios.event import Event
from ..scenarios.limits import positive_time
from ..scenarios.trajectory import StopReason, Trajectory

if TYPE_CHECKING:
    from ..scenarios.engine import Engine
    from ..scenarios.numbers.quantity import QuantityLike
    from ..scenarios.scene import Scene


class EngineError(SceneError):
    """An engine declares, or hands back, what cannot be judged."""


DECLARATIONS = ("name", "step", "bits", "rounds_input", "scene_keys", "finer", "wider", "firmer", "run")


def check_engine(engine: Any) -> Engine:
    """The engine, if it declares all that `Engine` asks for.

    Raises:
        EngineError: naming what is missing or wrong, and the remedy.

    >>> from truebreak.floating import DoubleEngine
    >>> check_engine(DoubleEngine()).bits
    53
    """
    name = getattr(engine, "name", type(engine).__name__)
    if not isinstance(name, str) or not name.strip():
        raise EngineError(f"engine {type(engine).__name__}: name = {_told(name)}; must be text")
    for key in DECLARATIONS:
        if not hasattr(engine, key):
            raise EngineError(
                f"engine {name!r}: declares no {key}; derive it from scenarios.Declared (see scenarios.Engine)"
            )
    step, bits = engine.step, engine.bits
    if step is not None and not (isinstance(step, int | float) and step is not True and 0 < step < math.inf):
        raise EngineError(f"engine {name!r}: step = {step!r}: must be a finite number above zero, or None")
    if bits is not None and (not isinstance(bits, int) or isinstance(bits, bool) or bits < 1):
        raise EngineError(f"engine {name!r}: bits = {bits!r}: must be a whole number from 1, or None")
    if not isinstance(engine.scene_keys, Set):
        raise EngineError(f"engine {name!r}: scene_keys = {_told(engine.scene_keys)}; must be a set of keys of a scene")
    for key in ("finer", "wider", "firmer"):
        _check_made(engine, name, key)
    strange = sorted(map(str, engine.scene_keys - SCENE_KEYS))
    if strange:
        raise EngineError(
            f"engine {name!r}: scene_keys has {strange[0]!r}; choose from {', '.join(sorted(SCENE_KEYS))}"
        )
    return engine


def _check_made(engine: Any, name: str, key: str) -> None:
    """What an engine makes of itself is an engine, or None."""
    try:
        made = getattr(engine, key)()
    except SceneError:  # it goes no further, and says so when it is asked to
        return
    except Exception as error:
        raise EngineError(f"engine {name!r}: {key}() raised {type(error).__name__}: {error}") from error
    if made is not None and not all(hasattr(made, declared) for declared in DECLARATIONS):
        raise EngineError(f"engine {name!r}: {key}() gave {_told(made)}; it must give an engine, or None")


def check_until(engine: Engine, scene: Scene, until: QuantityLike | None) -> None:
    """Refuses a limit in time that an engine cannot count to.

    Raises:
        SceneError: for one that is not above zero, or, for an engine of a finite precision, beyond the doubles.
    """
    time = positive_time("until", until) or scene.until
    if time is None or engine.bits is None:
        return
    try:
        large = not math.isfinite(float(time))
    except OverflowError:
        large = True
    if large:
        raise SceneError(
            f"until: is beyond 1.8e308, and engine {engine.name!r} knows no such time; choose an earlier one"
        )


def unsupported(engine: Engine, scene: Scene) -> str | None:
    """The first key of a scene that an engine says it does not follow; a tie policy of its own is no hindrance."""
    uses = {
        "wall": bool(scene.walls),
        "pocket": bool(scene.pockets),
        "capture": scene.capture and bool(scene.pockets),
        "reverse_at": scene.reverse_at is not None,
        "reverse_after": scene.reverse_after is not None,
    }
    return next((key for key, used in uses.items() if used and key not in engine.scene_keys), None)


def check_trajectory(trajectory: Any, scene: Scene, name: str, bits: int | None = None) -> Trajectory:
    """What an engine handed back, if it can be judged.

    Args:
        bits: of the engine's numbers: times that fall by less than half of their digits are rounding, and may.

    Raises:
        EngineError: naming the engine, the event, the field and the remedy.
    """
    where = f"engine {name!r}"
    if not isinstance(trajectory, Trajectory):
        raise EngineError(f"{where}: run gave {_told(trajectory)}; it must give a scenarios.Trajectory")
    if trajectory.scene.ids != scene.ids:
        raise EngineError(
            f"{where}: its trajectory is of another scene, {trajectory.scene.name!r}; hand back the one asked for"
        )
    if not isinstance(getattr(trajectory.stop, "reason", None), StopReason):
        raise EngineError(f"{where}: stop = {_told(trajectory.stop)}; must be a Stop with a StopReason")
    if not isinstance(trajectory.events, Sequence):
        raise EngineError(f"{where}: events = {_told(trajectory.events)}; must be a tuple of scenarios.Event")
    times = []
    for place, event in enumerate(trajectory.events):
        times.append(checked_event(f"{where}: event {place}", event, place, scene))
    end = checked_number(f"{where}: final_time", trajectory.final_time)
    share = rounding_of_times(bits)
    for place, (before, after) in enumerate(pairwise(times)):
        if falls(before, after, bits):
            raise EngineError(
                f"{where}: event {place + 1}: time = {after!r} comes before {before!r}, the time of event {place}; "
                "sort the events"
            )
    if end < (1 - share) * max([0.0, *times]):
        raise EngineError(
            f"{where}: final_time = {end!r} is before its last event, at {max([0.0, *times])!r}; "
            "give the end of the run"
        )
    _check_reversal(where, trajectory, scene, end)
    _check_states(where, trajectory)
    return trajectory


def rounding_of_times(bits: int | None) -> float:
    """The share of a time by which a later one may lie before it: half of its digits are rounding in a long run."""
    return 0.0 if bits is None else 2.0 ** -(bits // 2)


def falls(before: float, after: float, bits: int | None) -> bool:
    """Whether a time that comes after another is earlier by more than rounding.

    >>> falls(2.0, 1.0, 53), falls(2.0, 2.0 - 2**-40, 53), falls(2.0, 2.0 - 2**-40, None)
    (True, False, True)
    """
    return after < before - rounding_of_times(bits) * before


def checked_event(where: str, event: Any, place: int, scene: Scene) -> float:
    """The time of an event that can be judged.

    Args:
        where: what an error begins with.
        place: what its index must be.

    Raises:
        EngineError: naming the field, its value and the remedy.
    """
    if not isinstance(event, Event):
        raise EngineError(f"{where}: is {_told(event)}; must be a scenarios.Event")
    if event.index != place:
        raise EngineError(f"{where}: index = {event.index!r}; must be its place, {place}")
    time = checked_number(f"{where}: time", event.time)
    if time < 0:
        raise EngineError(f"{where}: time = {time!r} is before the start; times are from 0")
    for field, pairs in (("contacts", event.contacts), ("impulses", event.impulses)):
        if not isinstance(pairs, Sequence):
            raise EngineError(f"{where}: {field} = {_told(pairs)}; must be a tuple of pairs of ids")
    if not event.impulses:
        raise EngineError(f"{where}: impulses is empty; leave out an instant without an impulse")
    places = {name: number for number, name in enumerate(scene.ids)}
    circles = len(scene.circles)
    for field, pairs in (("contacts", event.contacts), ("impulses", event.impulses)):
        for pair in pairs:
            try:
                first, second = pair
            except (TypeError, ValueError):
                raise EngineError(
                    f"{where}: {field} has {_told(pair)}; must be pairs of ids, such as Contact('a', 'b')"
                ) from None
            for name in (first, second):
                if name not in places:
                    raise EngineError(f"{where}: {field} has {name!r}, which is not in the scene; use the scene's ids")
            if not places[first] < places[second] or places[first] >= circles:
                raise EngineError(
                    f"{where}: {field} has ({first!r}, {second!r}); "
                    "put the circle that comes first in the scene first, a wall last"
                )
    missing = {frozenset(p) for p in event.impulses} - {frozenset(p) for p in event.contacts}
    if missing:
        raise EngineError(
            f"{where}: impulses has {sorted(next(iter(missing)))}, which contacts has not; "
            "list every contact that collides"
        )
    return time


def _check_reversal(where: str, trajectory: Trajectory, scene: Scene, end: float) -> None:
    if scene.reverse_at is None and scene.reverse_after is None:
        if trajectory.reversal is not None:
            raise EngineError(f"{where}: reversal = {trajectory.reversal}, but the scene has none; leave it out")
        return
    if trajectory.reversal is not None:
        checked_number(f"{where}: reversal.time", trajectory.reversal.time)
        return
    due = (scene.reverse_at is not None and float(scene.reverse_at) < end) or (
        scene.reverse_after is not None and len(trajectory.events) > scene.reverse_after
    )
    if due:
        raise EngineError(
            f"{where}: reversal = None, but the scene reverses within the run; "
            "negate the velocities there, or leave reverse_at and reverse_after out of scene_keys"
        )


def _check_states(where: str, trajectory: Trajectory) -> None:
    """The first and the last state are finite, one for each circle, and the first is the scene's."""
    for time, told in ((trajectory.final_time, "the final state"),):
        try:
            state = trajectory.at(time)
        except (ValueError, KeyError, TypeError, IndexError, AttributeError) as error:
            raise EngineError(
                f"{where}: {told} is not to be had ({error}); motion.state must answer from 0 to final_time"
            ) from None
        for circle in state.circles:
            for key in ("x", "y", "vx", "vy"):
                checked_number(f"{where}: {told}: circle {circle.id!r}: {key}", getattr(circle, key))


def checked_number(where: str, value: Any) -> float:
    """A number of an engine as a double; `where` is what an error begins with.

    Raises:
        EngineError: if it is none, or not finite.
    """
    try:
        number = float(value)
    except OverflowError:
        raise EngineError(f"{where} is beyond the doubles; end the run before that") from None
    except (TypeError, ValueError):
        raise EngineError(f"{where} = {_told(value)}; must be a number") from None
    if not math.isfinite(number):
        raise EngineError(f"{where} = {number!r}; must be finite")
    return number


def _told(value: Any) -> str:
    return repr(value)[:60]
