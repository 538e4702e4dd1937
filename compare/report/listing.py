"""The catalogue, a scene and a single run, printed on stdout."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any, SupportsFloat, cast

from ...exact.numbers.system import Undecided
from ...scenarios.errors import printable
from ...scenarios.numbers.quantity import real
from ..files.amounts import bounds, counted, double, normal_form
from .output import TextTable, console, grid, say

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ...scenarios.catalogue import SceneEntry
    from ...scenarios.numbers.quantity import Real
    from ...scenarios.scene import Scene
    from ...scenarios.trajectory import Event, Trajectory
    from ..deadline import Clock

SHOWN_EVENTS = 40
"""Rows of events printed for people: three quarters of them from the start, the rest from the end."""

SHOWN_DIGITS = 60
"""Longest exact text in a table; of longer ones, which are in the JSON, the value and how long they are."""


DRIFT = ("vx", "vy")
"""Of walls, segments and polygons of which one moves."""

LEAST_NORMAL = 2.0**-1022
"""Below it a double has fewer bits than others have."""

LEAST_BITS = 64
"""Bits to which a number is enclosed that is not proved to be zero."""


def print_json(data: Mapping[str, Any]) -> None:
    """One object on stdout: a line for each key, and for each thing in a list of things."""
    sys.stdout.write(laid_out(data) + "\n")


def laid_out(data: Mapping[str, Any]) -> str:
    """JSON text with a line for each key of an object, and for each object in a list.

    >>> print(laid_out({"a": [1, 2], "b": [{"c": 1}, {"c": 2}]}))
    {
     "a": [1, 2],
     "b": [
      {"c": 1},
      {"c": 2}
     ]
    }
    """
    lines = []
    for key, value in data.items():
        if isinstance(value, list) and value and all(isinstance(item, dict) for item in value):
            rows = ",\n".join(f"  {_flat(item)}" for item in value)
            lines.append(f" {_flat(key)}: [\n{rows}\n ]")
        else:
            lines.append(f" {_flat(key)}: {_flat(value)}")
    return "{\n" + ",\n".join(lines) + "\n}"


def _flat(value: Any) -> str:
    import json

    return printable(json.dumps(value, allow_nan=False, ensure_ascii=False))


def print_catalogue(as_json: bool) -> None:
    """Every scene of the catalogue, with parameters and source."""
    from ...scenarios import catalogue

    entries = [catalogue.entry(name) for name in catalogue.names()]
    if as_json:
        from ..files.amounts import plain

        print_json({"scenes": [plain(catalogue_row(entry)) for entry in entries]})
        return

    out = console()
    for entry in entries:
        row = catalogue_row(entry)
        say(out, f"{row['name']}  {row['summary']}", "bold")
        for parameter in row["parameters"]:
            setting = f"{parameter['name']}={parameter['default']}"
            say(out, f"    {setting:<14} {parameter['help']}")
        for key in ("known", "source"):
            if row.get(key):
                say(out, f"    {key}: {row[key]}")
    say(out, "\nRun one with: truebreak compare NAME, or NAME:key=value,key=value")


def catalogue_row(entry: SceneEntry) -> dict[str, Any]:
    """What the catalogue tells of one scene."""
    return {
        "name": entry.name,
        "parameters": [{"name": p.name, "default": p.default, "help": p.help} for p in entry.parameters],
        "summary": entry.summary,
        "source": entry.source,
        "known": entry.known,
    }


def print_scene(scene: Scene, as_json: bool) -> None:
    """A scene's circles and walls, exactly."""
    if as_json:
        print_json(scene.data())
        return
    out = console()
    say(out, f"{scene.name}  {scene.description}", "bold")
    if scene.source:
        say(out, f"source: {scene.source}")
    facts = {"tie policy": str(scene.tie_policy), "digest": scene.digest[:16]}
    for key in ("reverse_after", "reverse_at", "until", "events"):
        value = getattr(scene, key)
        if value is not None:
            facts[key.replace("_", " ")] = str(value)
    if not scene.elastic:
        facts["restitution"] = str(scene.restitution)
    if scene.gravity is not None:
        facts["gravity"] = f"({', '.join(map(str, scene.gravity))})"
    say(out, ", ".join(f"{key}: {value}" for key, value in facts.items()))
    data = scene.data()
    for kind, keys in (
        ("circle", ("id", "x", "y", "r", "vx", "vy", "m")),
        ("wall", ("id", "x0", "y0", "x1", "y1", *(DRIFT if any(w.moves for w in scene.walls) else ()))),
        ("segment", ("id", "x0", "y0", "x1", "y1", "r", *(DRIFT if any(s.moves for s in scene.segments) else ()))),
        ("polygon", ("id", "points", "r", *(DRIFT if any(p.moves for p in scene.polygons) else ()))),
        ("arc", ("id", "x", "y", "r", "x0", "y0", "x1", "y1", "full")),
        ("pocket", ("id", "x", "y", "r")),
    ):
        rows = data.get(kind)
        if not rows:
            continue
        table = grid(*keys, title=counted(len(rows), kind))
        for row in rows:
            table.add_row(*(cut(_cell(row.get(key, "0"))) for key in keys))
        out.print(table)


def _cell(value: object) -> str:
    """A number or a name as it stands; points as (x, y) (x, y) ..."""
    points = cast("list[list[str]]", value) if isinstance(value, list) else None
    return str(value) if points is None else " ".join(f"({', '.join(point)})" for point in points)


def cut(text: str) -> str:
    """A text of at most `SHOWN_DIGITS` characters, the missing ones counted."""
    return text if len(text) <= SHOWN_DIGITS else f"{text[:SHOWN_DIGITS]}... ({len(text):,} characters)"


def print_trajectory(trajectory: Trajectory, *, exact: bool, watch: Clock) -> None:
    """A run: why it stopped, its events, its final state.

    Args:
        exact: whether numbers are told as exact text, as long as the user's seconds last.
    """
    out = console()
    name, scene = trajectory.engine, trajectory.scene
    say(
        out,
        f"{scene.name} in {name}: {counted(len(trajectory.events), 'event')}, "
        f"{counted(trajectory.collisions, 'collision')}, to time {number(trajectory.final_time, exact)}",
        "bold",
    )
    say(out, f"stopped: {trajectory.stop.message}")
    if trajectory.reversal is not None:
        when = number(trajectory.reversal.time, exact)
        say(out, f"reversed: after {counted(trajectory.reversal.after, 'event')}, at time {when}")
    for note in trajectory.notes:
        say(out, note)
    if scene.moving_walls:
        from ..grids.row import energy_gained

        what = "walls that move" if scene.moving_solid is None else "what moves and is no circle"
        less = "" if scene.elastic else ", less what contacts lost"
        say(out, f"energy: {what} brought in {energy_gained(trajectory):.9g}{less}")
    for settled in trajectory.settlings:
        told = f"settled: {settled.circle} {settled.where} at time {number(settled.time, exact)}"
        if settled.since is not None:
            told += f", after infinitely many bounces; none is listed after time {number(settled.since, exact)}"
        say(out, told)
    if trajectory.assumptions:
        for assumption in trajectory.assumptions[:1]:
            say(out, str(assumption), "bold yellow")
    out.print(events_table(trajectory, exact, watch))
    table = grid("circle", "x", "y", "vx", "vy", title="at the end")
    for circle in trajectory.final.circles:
        cells = [number(getattr(circle, key), exact and not watch.over) for key in ("x", "y", "vx", "vy")]
        table.add_row(circle.id, *cells)
    out.print(table)
    if trajectory.plan:
        told = ", ".join(f"{key}: {value}" for key, value in trajectory.plan.items())
        say(out, f"plan: {told}")


def events_table(trajectory: Trajectory, exact: bool, watch: Clock) -> TextTable:
    """The first and last events of a run."""
    table = grid("event", "time", "contacts", "impulses", whole=("event", *(() if exact else ("time",))))
    events = trajectory.events
    head = SHOWN_EVENTS * 3 // 4
    shown: list[Event | None] = list(events)
    if len(events) > SHOWN_EVENTS:
        shown = [*events[:head], None, *events[head - SHOWN_EVENTS :]]
    for event in shown:
        if event is None:
            table.add_row("...", f"{len(events) - SHOWN_EVENTS:,} more", "", "")
            continue
        contacts = " ".join(f"{a}-{b}" for a, b in event.contacts)
        impulses = " ".join(f"{a}-{b}" for a, b in event.impulses) if event.impulses != event.contacts else ""
        table.add_row(str(event.index), number(event.time, exact and not watch.over), contacts, impulses)
    return table


def number(value: SupportsFloat, exact: bool) -> str:
    """A number for people: exact text if asked for, bounds of an interval, else the nearest double.

    >>> number(0.5, True), number(0.1, False)
    ('1/2', '0.1')
    >>> from truebreak.scenarios.numbers.quantity import Quantity
    >>> number(Quantity.of(f"sqrt(2)/{10**30} + sqrt(3)/{10**30}"), True)
    '3.1462643699419723e-30 (81 characters)'
    >>> number(Quantity.of("10**-330"), False), number(Quantity.of("10**330"), False), number(Quantity.of(0), False)
    ('1e-330', '1e+330', '0')
    """
    ends = bounds(real(value))
    if ends is not None and ends[0] != ends[1]:
        return f"[{ends[0]:.17g}, {ends[1]:.17g}]"
    if exact:
        text = normal_form(real(value))
        if text is not None and len(text) <= SHOWN_DIGITS:
            return text
        if text is not None:
            return f"{real(value).digits(17)} ({len(text):,} characters)"
    nearest, places = double(value), 17 if exact else 12
    if nearest is not None and (abs(nearest) >= LEAST_NORMAL or isinstance(value, float)):
        return f"{nearest:.{places}g}"
    return out_of_doubles(real(value), places)


def out_of_doubles(value: Real, places: int) -> str:
    """A number that is zero, or that doubles tell badly or not at all: "0" stands for what is proved to be zero alone.

    >>> from truebreak.scenarios.numbers.quantity import Quantity
    >>> [out_of_doubles(Quantity.of(text), 3) for text in ("10**-330", "-10**400", "0")]
    ['1e-330', '-1e+400', '0']
    """
    try:
        told = value.digits(places)
    except Undecided:
        return f"{value.ball(LEAST_BITS).str(3)}, not proved to be 0"
    digits, e, power = told.partition("e")
    if "." in digits:
        digits = digits.rstrip("0").rstrip(".")
    return digits + e + power if told else "beyond the doubles"
