"""From the keys and values of a scene file to the scene; whatever does not fit is refused by name."""

from __future__ import annotations

import difflib
import re
from collections.abc import Callable, Iterable, Sequence
from typing import Any, TypeGuard, cast

from ..checks.showing import SHOWN, Bare, cut
from ..errors import SceneError
from ..numbers.parsing import MAX_LENGTH
from ..numbers.quantity import Quantity
from ..scene import MAX_CIRCLES, Scene
from ..things import FIXED, INFINITE, Circle, Pocket, Wall

HALF_PAIR = re.compile("[\ud800-\udfff]")
"""What no file can hold: half of the pair that spells a character beyond the first 65,536."""

TEXTS = ("name", "description", "source", "tie_policy")
COUNTS = ("reverse_after", "events")
TIMES = ("reverse_at", "until")
TOP = (*TEXTS, *COUNTS, *TIMES, "capture", "circle", "wall", "pocket")
CIRCLE = ("id", "x", "y", "r", "vx", "vy", "m", "point", "fixed")
WALL = ("id", "x0", "y0", "x1", "y1")
POCKET = ("id", "x", "y", "r")

ABSENT = frozenset(
    [
        *("acceleration", "angle", "angular_velocity", "arc", "bounce", "box", "capsule", "constraint", "damping"),
        *("drag", "elasticity", "field", "force", "friction", "gravity", "joint", "line", "motor", "mu", "omega"),
        *("period_x", "period_y", "polygon", "rectangle", "restitution", "rotation", "segment", "settle", "spin"),
        *("spring", "torque"),
    ]
)
"""Keys of other physics engines for what this world does not have: to be named as that, not as a slip of the pen."""

WORLD = "docs/scenes.md#what-the-world-has"
"""The page that says what it has."""


TOML_LIST, JSON_LIST = "write [[{kind}]] above each of them", 'write "{kind}": [{{...}}, {{...}}]'
"""How each kind of file writes a list of circles, walls or pockets."""


def scene_from_table(data: dict[str, Any], where: str, remedy: str = TOML_LIST) -> Scene:
    """The scene that the keys and values of a file describe; `where` names the file, `remedy` how it writes lists.

    Raises:
        SceneError: one line that names the file, the thing, its key and value, the reason and the remedy.

    >>> try:
    ...     scene_from_table({"circle": [{"id": "a", "x": 0, "y": 0, "R": 1}]}, "x.toml")
    ... except SceneError as error:
    ...     print(error)
    x.toml: circle 'a': key 'R' is not known; did you mean 'r'?
    """
    try:
        _check_physics(data)
        _check_keys("", data, TOP)
        values: dict[str, Any] = {key: _text(key, data[key]) for key in TEXTS if key in data}
        values |= {key: _count(key, data[key]) for key in COUNTS if key in data}
        values |= {key: _number("", key, data[key]) for key in TIMES if key in data}
        if "capture" in data:
            values["capture"] = _truth("capture", data["capture"])
        return Scene(
            circles=_things(data, "circle", _circle, remedy),
            walls=_things(data, "wall", _wall, remedy),
            pockets=_things(data, "pocket", _pocket, remedy),
            **values,
        )
    except SceneError as error:
        raise SceneError(f"{where}: {error}") from None


def _things(data: dict[str, Any], kind: str, make: Callable[[str, dict[str, Any]], Any], remedy: str) -> list[Any]:
    rows: object = data.get(kind, [])
    if not _are_tables(rows):
        raise SceneError(f"{kind} = {cut(rows)} is not a list of tables; {remedy.format(kind=kind)}")
    if len(rows) > MAX_CIRCLES:
        raise SceneError(f"the scene has {len(rows)} {kind}s; at most {MAX_CIRCLES}")
    return [make(_label(kind, number, row), row) for number, row in enumerate(rows, start=1)]


def _are_tables(value: object) -> TypeGuard[list[dict[str, Any]]]:
    return isinstance(value, list) and all(isinstance(row, dict) for row in cast("list[object]", value))


def _label(kind: str, number: int, row: dict[str, Any]) -> str:
    if "id" not in row:
        raise SceneError(f"{kind} {number}: id is missing; give every {kind} an id of its own")
    name = row["id"]
    if not isinstance(name, str) or isinstance(name, Bare):
        raise SceneError(f"{kind} {number}: id = {cut(name)} is not text; put it in quotes")
    return f"{kind} {cut(name)}"


def _circle(label: str, row: dict[str, Any]) -> Circle:
    _check_keys(label, row, CIRCLE)
    values: dict[str, Any] = _numbers(label, row, required=("x", "y", "r"), others=("vx", "vy"))
    if "m" in row:
        values["m"] = FIXED if _says_fixed(row["m"]) else _number(label, "m", row["m"])
    if "fixed" in row:
        values["fixed"] = _truth(f"{label}: fixed", row["fixed"])
    if "point" in row:
        values["point"] = _truth(f"{label}: point", row["point"])
    return Circle(id=row["id"], **values)


def _wall(label: str, row: dict[str, Any]) -> Wall:
    _check_keys(label, row, WALL)
    return Wall(id=row["id"], **_numbers(label, row, required=("x0", "y0", "x1", "y1")))


def _pocket(label: str, row: dict[str, Any]) -> Pocket:
    _check_keys(label, row, POCKET)
    return Pocket(id=row["id"], **_numbers(label, row, required=("x", "y", "r")))


def _says_fixed(m: Any) -> bool:
    return isinstance(m, str) and m.strip() in INFINITE


def _numbers(
    label: str, row: dict[str, Any], required: Sequence[str], others: Sequence[str] = ()
) -> dict[str, Quantity]:
    for key in required:
        if key not in row:
            raise SceneError(f"{label}: {key} is missing; write {key} = ...")
    return {key: _number(label, key, row[key]) for key in (*required, *others) if key in row}


def _number(label: str, key: str, value: Any) -> Quantity:
    place = f"{label}: {key}" if label else key
    if isinstance(value, Bare) and value.lower().lstrip("+-") in ("inf", "nan", "infinity"):
        hint = '; a fixed circle says m = "oo"' if key == "m" else ""
        raise SceneError(f"{place} = {value} is not a finite number{hint}")
    if isinstance(value, bool) or not isinstance(value, (str, int)):
        remedy = 'write a whole number or text such as "9/4"'
        raise SceneError(f"{place} = {cut(value)} is not a number; {remedy}")
    if isinstance(value, int) and value.bit_length() > 4 * MAX_LENGTH:
        raise SceneError(f"{place}: a number of {value.bit_length()} bits is too long; shorten it")
    try:
        return Quantity.of(value)
    except SceneError as error:
        raise SceneError(f"{place} = {error}") from None


def _count(key: str, value: Any) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or not 1 <= value < 10**18:
        raise SceneError(f"{key} = {cut(value)}: must be a whole number from 1")
    return value


def _truth(place: str, value: Any) -> bool:
    if not isinstance(value, bool):
        raise SceneError(f"{place} = {cut(value)} is not true or false")
    return value


def _text(key: str, value: Any) -> str:
    if not isinstance(value, str) or isinstance(value, Bare):
        raise SceneError(f"{key} = {cut(value)} is not text; put it in quotes")
    if HALF_PAIR.search(value):
        raise SceneError(f"{key} = {cut(value)} holds half a surrogate pair; write all of it")
    if key == "tie_policy" and len(value) > SHOWN:
        raise SceneError(f"tie_policy = {cut(value)} is not known; write simultaneous or sequential")
    return value


def _check_physics(data: dict[str, Any]) -> None:
    """Refuses, all at once, what is physics of another world.

    Raises:
        SceneError: naming each key, and the first thing that has it.
    """
    found = {key: "" for key in data if _is_physics(key)}
    for kind in ("circle", "wall", "pocket"):
        rows: object = data.get(kind)
        for row in rows if _few(rows) and _are_tables(rows) else []:
            for key in row:
                if _is_physics(key):
                    found.setdefault(key, f" (of {kind} {cut(row.get('id'))})")
    if found:
        told = ", ".join(f"{key}{whose}" for key, whose in sorted(found.items()))
        raise SceneError(
            f"{told}: physics that is not there; {WORLD} says what is: leave {'it' if len(found) == 1 else 'them'} out"
        )


def _few(rows: object) -> bool:
    return isinstance(rows, list) and len(cast("list[object]", rows)) <= MAX_CIRCLES


def _is_physics(key: str) -> bool:
    return key.lower() in ABSENT or key.lower().removesuffix("s") in ABSENT


def _check_keys(label: str, table: dict[str, Any], known: Iterable[str]) -> None:
    for key in table:
        if key not in known:
            near = difflib.get_close_matches(key[:SHOWN].lower(), known, n=1, cutoff=0.5)
            remedy = f"did you mean {near[0]!r}?" if near else f"known keys: {', '.join(known)}"
            raise SceneError(f"{label}{': ' if label else ''}key {cut(key)} is not known; {remedy}")
