"""What an engine declares, and what it hands back, is checked before it is judged."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence, Set
from itertools import pairwise
from typing import TYPE_CHECKING, Any, TypeAlias

from ..scenarios.engine import ALL_KEYS
from ..scenarios.errors import SceneError
from ..scenarios.scene import Scene
from ..scenarios.settings import positive_time
from ..scenarios.trajectory import Assumption, Contact, Event, Pocketing, Reversal, Stop, StopReason, Tie, Trajectory

if TYPE_CHECKING:
    from ..scenarios.engine import Engine
    from ..scenarios.numbers.quantity import QuantityLike


class EngineError(SceneError):
    """An engine declares, or hands back, what cannot be judged."""


DECLARATIONS = ("name", "step", "bits", "rounds_input", "scene_keys", "finer", "wider", "firmer", "run")

METHODS = ("finer", "wider", "firmer", "run")


def check_engine(engine: Any) -> Engine:
    """The engine, if it declares all that `Engine` asks for.

    Raises:
        EngineError: naming what is missing or wrong, and the remedy.

    >>> from truebreak.floating import DoubleEngine
    >>> check_engine(DoubleEngine()).bits
    53
    """
    if isinstance(engine, type):
        raise EngineError(f"engine {engine.__name__!r}: is a class; give an engine, such as {engine.__name__}()")
    name = getattr(engine, "name", type(engine).__name__)
    for key in DECLARATIONS:
        if not hasattr(engine, key):
            raise EngineError(
                f"engine {name!r}: declares no {key}; derive it from scenarios.Declared (see scenarios.Engine)"
            )
        if key in METHODS and not callable(getattr(engine, key)):
            raise EngineError(f"engine {name!r}: {key} = {_told(getattr(engine, key))}; must be a method")
    step, bits = engine.step, engine.bits
    if not isinstance(name, str) or not name.strip() or not name.isprintable():
        raise EngineError(f"engine {type(engine).__name__!r}: name = {_told(name)}; must be text of one line")
    if step is not None and (not isinstance(step, int | float) or isinstance(step, bool) or not 0 < step < math.inf):
        raise EngineError(f"engine {name!r}: step = {step!r}: must be a finite int or float above zero, or None")
    if bits is not None and (not isinstance(bits, int) or isinstance(bits, bool) or bits < 1):
        raise EngineError(f"engine {name!r}: bits = {bits!r}: must be a whole number (an int) from 1, or None")
    if not isinstance(engine.rounds_input, bool):
        raise EngineError(f"engine {name!r}: rounds_input = {_told(engine.rounds_input)}; must be True or False")
    keys = engine.scene_keys
    if not isinstance(keys, Set | Sequence) or isinstance(keys, str):
        raise EngineError(f"engine {name!r}: scene_keys = {_told(keys)}; must be a frozenset of keys")
    strange = sorted(str(key) for key in keys if not isinstance(key, str) or key not in ALL_KEYS)
    if strange:
        raise EngineError(f"engine {name!r}: scene_keys has {strange[0]!r}; choose from {', '.join(sorted(ALL_KEYS))}")
    return engine


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
        "segment": bool(scene.segments),
        "polygon": bool(scene.polygons),
        "arc": bool(scene.arcs),
        "pocket": bool(scene.pockets),
        "capture": scene.capture and bool(scene.pockets),
        "reverse_at": scene.reverse_at is not None,
        "reverse_after": scene.reverse_after is not None,
        "restitution": not scene.elastic,
        "gravity": scene.gravity is not None,
        "settle": scene.settle,
        "fixed": bool(scene.surfaces.pegs),
        "moving walls": scene.moving_walls,
        "wall kinds": bool(scene.other_walls),
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
    told = trajectory.scene
    if told is not scene and (
        not isinstance(told, Scene)
        or told.circles != scene.circles
        or told.walls != scene.walls
        or told.segments != scene.segments
        or told.polygons != scene.polygons
        or told.arcs != scene.arcs
        or told.restitution != scene.restitution
        or told.gravity != scene.gravity
    ):
        raise EngineError(
            f"{where}: its trajectory is of another scene, {_told(getattr(told, 'name', told))}; "
            "hand back the one asked for"
        )
    _check_fields(where, trajectory)
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
    _check_pocketings(where, trajectory, scene, end)
    _check_reversal(where, trajectory, scene, times, end)
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
    if not isinstance(event.index, int) or isinstance(event.index, bool) or event.index != place:
        raise EngineError(f"{where}: index = {event.index!r}; must be its place, {place}")
    if not isinstance(event.coupled, bool):
        raise EngineError(f"{where}: coupled = {_told(event.coupled)}; must be True or False")
    _check_list(f"{where}: ties", event.ties, Tie)
    time = checked_number(f"{where}: time", event.time)
    if time < 0:
        raise EngineError(f"{where}: time = {time!r} is before the start; times are from 0")
    if isinstance(event.impulses, Sequence) and not event.impulses:
        raise EngineError(f"{where}: impulses is empty; leave out an instant without an impulse")
    places = {name: number for number, name in enumerate(scene.ids)}
    circles = len(scene.circles)
    for field, pairs in (("contacts", event.contacts), ("impulses", event.impulses)):
        _check_list(f"{where}: {field}", pairs)
        for pair in pairs:
            try:
                first, second = pair
            except (TypeError, ValueError):
                raise EngineError(
                    f"{where}: {field} has {_told(pair)}; must be pairs of ids, such as Contact('a', 'b')"
                ) from None
            for name in (first, second):
                if not isinstance(name, str) or name not in places:
                    raise EngineError(f"{where}: {field} has {name!r}, which is not in the scene; use the scene's ids")
            if first == second or min(places[first], places[second]) >= circles:
                alone = "one thing" if first == second else "no circle"
                raise EngineError(f"{where}: {field} has ({first!r}, {second!r}), which is {alone}; leave it out")
            if places[first] > places[second]:
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


def _check_fields(where: str, trajectory: Trajectory) -> None:
    """What else a trajectory says of itself is of the kind that it has to be."""
    stop = trajectory.stop
    if not isinstance(stop, Stop) or not isinstance(stop.reason, StopReason) or not isinstance(stop.message, str):
        raise EngineError(f"{where}: stop = {_told(stop)}; must be a Stop with a StopReason and a message")
    if not isinstance(trajectory.engine, str):
        raise EngineError(f"{where}: engine = {_told(trajectory.engine)}; must be its name")
    for field in ("parameters", "plan"):
        value = getattr(trajectory, field)
        if not isinstance(value, Mapping):
            raise EngineError(f"{where}: {field} = {_told(value)}; must be a dict")
    _check_list(f"{where}: events", trajectory.events)
    _check_list(f"{where}: pocketings", trajectory.pocketings, Pocketing)
    _check_list(f"{where}: assumptions", trajectory.assumptions, Assumption)
    _check_list(f"{where}: notes", trajectory.notes, str)


def _check_list(where: str, value: Any, kind: type = object) -> None:
    """A tuple, or another sequence, of things of one kind."""
    if not isinstance(value, Sequence) or isinstance(value, str | bytes):
        raise EngineError(f"{where} = {_told(value)}; must be a tuple")
    if kind is object:
        return
    for item in value:
        if not isinstance(item, kind):
            raise EngineError(f"{where} has {_told(item)}; must hold things of the kind {kind.__name__} only")


def _check_pocketings(where: str, trajectory: Trajectory, scene: Scene, end: float) -> None:
    """Entries are of the scene's circles into its pockets, within the run."""
    circles, pockets = {c.id for c in scene.circles}, {p.id for p in scene.pockets}
    for place, entry in enumerate(trajectory.pocketings):
        told = f"{where}: pocketing {place}"
        for field, name, known in (("circle", entry.circle, circles), ("pocket", entry.pocket, pockets)):
            if not isinstance(name, str) or name not in known:
                raise EngineError(f"{told}: {field} = {_told(name)}, which is not in the scene; use the scene's ids")
        if not 0 <= checked_number(f"{told}: time", entry.time) <= end:
            raise EngineError(f"{told}: time = {float(entry.time)!r} is not within the run, which ends at {end!r}")


def _check_reversal(where: str, trajectory: Trajectory, scene: Scene, times: Sequence[float], end: float) -> None:
    reversal = trajectory.reversal
    if scene.reverse_at is None and scene.reverse_after is None:
        if reversal is not None:
            raise EngineError(f"{where}: reversal = {_told(reversal)}, but the scene has none; leave it out")
        return
    if reversal is not None:
        if not isinstance(reversal, Reversal):
            raise EngineError(f"{where}: reversal = {_told(reversal)}; must be a Reversal, or None")
        time, after = checked_number(f"{where}: reversal.time", reversal.time), reversal.after
        if not isinstance(after, int) or isinstance(after, bool) or not 0 <= after <= len(times):
            raise EngineError(f"{where}: reversal.after = {_told(after)}; must be the number of events before it")
        if not 0 <= time <= end:
            raise EngineError(f"{where}: reversal.time = {time!r} is not within the run, which ends at {end!r}")
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
    """The last state is there, and finite."""
    told = "the final state"
    try:
        state = trajectory.at(trajectory.final_time)
    except EngineError:
        raise
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
    if isinstance(value, str | bytes):
        raise EngineError(f"{where} = {_told(value)}; must be a number")
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


# ----------------------------------------
# What an engine reports of a run as it makes it: times, contacts, states.

Row: TypeAlias = tuple[float, float, float, float]
"""(x, y, vx, vy) of one circle."""

States: TypeAlias = "Mapping[str, Sequence[float]] | Sequence[Sequence[float]]"
"""x, y, vx, vy by the ids of circles; or of all circles, in scene order."""


class Reports:
    """Checks what is reported of a scene.

    Attributes:
        where: what an error begins with: the engine, or the line of a log.
    """

    def __init__(self, scene: Scene, where: str) -> None:
        self.where = where
        self._ids, self._settle = scene.ids, scene.settle
        self._places = {name: place for place, name in enumerate(scene.ids)}
        self._circles = [str(circle.id) for circle in scene.circles]

    def time(self, time: Any, last: float, bits: int | None) -> float:
        """A time that may follow the last one, of an engine of so many bits; the last one where it is less by rounding.

        Raises:
            EngineError: for one that is no finite number, or goes back by more than rounding.
        """
        now = self._number("time", time)
        if now < 0:
            raise EngineError(f"{self.where}: time = {now!r} is before the start; times are from 0")
        if falls(last, now, bits):
            raise EngineError(f"{self.where}: time = {now!r} comes before {last!r}, the one before it; sort them")
        return max(now, last)

    def contact(self, pair: Any) -> Contact:
        """A pair in scene order; unknown names are left for the check of the event.

        Raises:
            EngineError: if it is no pair of texts.
        """
        if not isinstance(pair, Sequence) or [type(name) for name in pair] != [str, str]:
            raise EngineError(f"{self.where}: contact = {str(pair)[:60]}; must be two ids, as text")
        first, second = pair
        swap = self._places.get(first, -1) > self._places.get(second, len(self._places))
        return Contact(second, first) if swap else Contact(first, second)

    def states(self, states: Any) -> dict[int, Row]:
        """States by the places of their circles.

        Raises:
            EngineError: for an unknown circle, and for a number that is none, or not finite.
        """
        if not isinstance(states, Mapping):
            try:
                states = dict(zip(self._circles, states, strict=True))
            except (TypeError, ValueError):
                raise EngineError(
                    f"{self.where}: states = {str(states)[:60]}; must be x, y, vx, vy by id, or of all "
                    f"{len(self._circles)} circles in scene order"
                ) from None
        found: dict[int, Row] = {}
        for name, row in states.items():
            place = self._places.get(name, len(self._circles))
            if place >= len(self._circles):
                raise EngineError(f"{self.where}: states has {name!r}, which is no circle of the scene; use its ids")
            try:
                x, y, vx, vy = row
            except (TypeError, ValueError):
                raise EngineError(f"{self.where}: states: {name!r} = {str(row)[:60]}; must be x, y, vx, vy") from None
            label = f"states: {name!r}: "
            found[place] = (
                self._number(f"{label}x", x),
                self._number(f"{label}y", y),
                self._number(f"{label}vx", vx),
                self._number(f"{label}vy", vy),
            )
        return found

    def carried(self, told: Any) -> dict[int, int]:
        """Who is carried by what, by places.

        Raises:
            EngineError: for what names no circle, or no wall, segment or polygon, and in scenes without `settle`.
        """
        if not self._settle:
            raise EngineError(f"{self.where}: carried: the scene has no settle = true; leave it out, or add that")
        if not isinstance(told, Mapping):
            raise EngineError(f"{self.where}: carried = {str(told)[:60]}; must be walls by the ids of circles")
        found: dict[int, int] = {}
        for name, wall in told.items():
            place, under = self._places.get(name, len(self._circles)), self._places.get(wall, -1)
            if place >= len(self._circles):
                raise EngineError(f"{self.where}: carried has {name!r}, which is no circle of the scene; use its ids")
            if under < len(self._circles):
                told = f"{name!r} = {str(wall)[:60]!r}; must be the id of a wall, segment or polygon"
                raise EngineError(f"{self.where}: carried: {told}")
            found[place] = under
        return found

    def check_all(self, wanted: set[int], given: Mapping[int, Row]) -> None:
        """Refuses states that leave out a circle which collides."""
        missing = wanted - given.keys()
        if missing:
            raise EngineError(
                f"{self.where}: states lacks {self._ids[min(missing)]!r}, which collides; "
                "give every circle that takes part, or no states at all"
            )

    def _number(self, label: str, value: Any) -> float:
        if isinstance(value, bool | str):
            raise EngineError(f"{self.where}: {label} = {value!r}; must be a number")
        return checked_number(f"{self.where}: {label}", value)
