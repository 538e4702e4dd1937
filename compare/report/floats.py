"""A scene in plain doubles, each with its error: what a program in any language starts from."""

from __future__ import annotations

import csv
import io
import math
from typing import TYPE_CHECKING, Any

from ...scenarios.errors import SceneError
from ...scenarios.numbers.quantity import Quantity
from ..files.amounts import no_formula

if TYPE_CHECKING:
    from ...scenarios.scene import Scene
    from ...scenarios.things import Arc, Circle, Pocket, Polygon, Segment, Wall

FLOATS_SCHEMA = "truebreak/floats-1"

CIRCLE, WALL, POCKET = ("x", "y", "r", "vx", "vy", "m"), ("x0", "y0", "x1", "y1"), ("x", "y", "r")
SEGMENT = (*WALL, "r")

DRIFT = ("vx", "vy")
"""Of a wall, a segment or a polygon that moves: how fast."""


def floats_json(scene: Scene) -> dict[str, Any]:
    """The scene in the nearest doubles; each thing has an `error` for each number: the exact one less the double.

    A fixed circle has mass null. Times are doubles too.

    Raises:
        SceneError: for a number beyond the doubles.

    >>> from truebreak.scenarios import Circle, Scene
    >>> floats_json(Scene([Circle("1/3", 0)]))["circles"][0]["error"]["x"]
    1.850371707708594e-17
    """
    data: dict[str, Any] = {
        "schema": FLOATS_SCHEMA,
        "scene": {"name": scene.name, "digest": scene.digest, "tie_policy": str(scene.tie_policy)},
        "circles": [_thing(c, CIRCLE) for c in scene.circles],
        "walls": [
            {**_thing(w, (*WALL, *DRIFT) if w.moves else WALL), **({} if w.kind == "wall" else {"kind": w.kind})}
            for w in scene.walls
        ],
        "pockets": [_thing(p, POCKET) for p in scene.pockets],
    }
    if scene.segments:
        data["segments"] = [_thing(s, (*SEGMENT, *DRIFT) if s.moves else SEGMENT) for s in scene.segments]
    if scene.polygons:
        data["polygons"] = [_polygon(p) for p in scene.polygons]
    if scene.arcs:
        data["arcs"] = [{**_thing(a, _arc_keys(a)), "full": a.full} for a in scene.arcs]
    if not scene.elastic:
        data["restitution"], data["restitution_error"] = double_and_error(scene.restitution, "restitution")
    if scene.gravity is not None:
        pairs = [double_and_error(part, "gravity") for part in scene.gravity]
        data["gravity"], data["gravity_error"] = [double for double, _ in pairs], [error for _, error in pairs]
    for key in ("until", "reverse_at"):
        if getattr(scene, key) is not None:
            data[key], data[f"{key}_error"] = double_and_error(getattr(scene, key), key)
    for key in ("events", "reverse_after"):
        if getattr(scene, key) is not None:
            data[key] = getattr(scene, key)
    return data


def floats_csv(scene: Scene) -> str:
    """The same, a row for each thing: `circle,ID,x,y,r,vx,vy,m`, `wall,ID,x0,y0,x1,y1`, `segment,ID,x0,y0,x1,y1,r`,
    `polygon,ID,r,x,y,x,y,...`, `arc,ID,x,y,r,x0,y0,x1,y1`, `pocket,ID,x,y,r`.

    The errors follow in the same order. The mass of a fixed circle is `inf`, its error 0; a full arc has x, y, r alone.

    Raises:
        SceneError: for a number beyond the doubles, for an id that a spreadsheet would take for a formula, and for
            gravity, a restitution or walls that move, of which there is no row.
    """
    uses = {
        "gravity": scene.gravity is not None,
        "restitution": not scene.elastic,
        "walls that move": scene.moving_walls,
    }
    for key in (key for key, used in uses.items() if used):
        raise SceneError(f"{scene.name!r}: has {key}, which no row of a thing can say; leave out --csv")
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    rows: list[tuple[str, str | None, list[tuple[float, float]]]] = []
    for kind, things, keys in (("circle", scene.circles, CIRCLE), ("wall", scene.walls, WALL),
                               ("segment", scene.segments, SEGMENT)):  # fmt: skip
        rows += [(kind, thing.id, [_pair(thing, key) for key in keys]) for thing in things]
    rows += [
        ("polygon", p.id, [_pair(p, "r"), *(pair for place in _points(p) for pair in place)]) for p in scene.polygons
    ]
    rows += [("arc", a.id, [_pair(a, key) for key in _arc_keys(a)]) for a in scene.arcs]
    rows += [("pocket", p.id, [_pair(p, key) for key in POCKET]) for p in scene.pockets]
    for kind, name, pairs in rows:
        if no_formula(name) != name:
            told = f"{kind} {name!r}: a spreadsheet takes an id that begins so for a formula"
            raise SceneError(f"{told}; leave out --csv, or write another id")
        writer.writerow([kind, name, *(repr(d) for d, _ in pairs), *(repr(e) for _, e in pairs)])
    return out.getvalue()


def _arc_keys(arc: Arc) -> tuple[str, ...]:
    return POCKET if arc.full else (*POCKET, *WALL)


def _points(polygon: Polygon) -> list[tuple[tuple[float, float], tuple[float, float]]]:
    """Of each point x and y: the double, and the error."""
    where = [f"{polygon.id!r}: point {k}" for k in range(1, len(polygon.points) + 1)]
    return [
        (double_and_error(x, f"{label}: x"), double_and_error(y, f"{label}: y"))
        for label, (x, y) in zip(where, polygon.points, strict=True)
    ]


def _polygon(polygon: Polygon) -> dict[str, Any]:
    (r, error), points = _pair(polygon, "r"), _points(polygon)
    told = [[[value[k] for value in place] for place in points] for k in (0, 1)]
    paces = {key: _pair(polygon, key) for key in DRIFT} if polygon.moves else {}
    row = {"id": polygon.id, "points": told[0], "r": r, **{key: _finite(double) for key, (double, _) in paces.items()}}
    return {**row, "error": {"points": told[1], "r": error, **{key: off for key, (_, off) in paces.items()}}}


def _thing(thing: Circle | Wall | Segment | Arc | Pocket, keys: tuple[str, ...]) -> dict[str, Any]:
    pairs = {key: _pair(thing, key) for key in keys}
    row: dict[str, Any] = {"id": thing.id, **{key: _finite(double) for key, (double, _) in pairs.items()}}
    return {**row, "error": {key: error for key, (_, error) in pairs.items()}}


def _pair(thing: Circle | Wall | Segment | Polygon | Arc | Pocket, key: str) -> tuple[float, float]:
    value = getattr(thing, key)
    return double_and_error(value, f"{thing.id!r}: {key}") if isinstance(value, Quantity) else (math.inf, 0.0)


def _finite(double: float) -> float | None:
    return double if math.isfinite(double) else None


def double_and_error(value: Quantity, label: str) -> tuple[float, float]:
    """The nearest double, and the exact value less it, as a double.

    Raises:
        SceneError: beyond the doubles.
    """
    try:
        double = float(value)
        return double, float(value - Quantity.of(double))
    except OverflowError:
        raise SceneError(f"{label} is beyond the doubles; scale the scene down") from None
