"""Scenes as files: TOML for people, JSON for machines, read and written exactly."""

from __future__ import annotations

import difflib
import json
import os
import re
import tomllib
from collections.abc import Callable, Iterable, Sequence
from importlib import import_module
from pathlib import Path
from typing import Any, TypeGuard, cast

from .disk import text_of, write_file
from .errors import SHOWN, Bare, SceneError, cut, printable
from .numbers.parsing import MAX_LENGTH
from .numbers.quantity import Quantity
from .scene import MAX_CIRCLES, Scene
from .settings import WALL_KINDS
from .things import FIXED, INFINITE, Arc, Circle, Pocket, Polygon, Segment, Wall

# -- From the keys and values of a scene file to the scene; whatever does not fit is refused by name.

HALF_PAIR = re.compile("[\ud800-\udfff]")
"""What no file can hold: half of the pair that spells a character beyond the first 65,536."""

TEXTS = ("name", "description", "source", "tie_policy")
COUNTS = ("reverse_after", "events")
TIMES = ("reverse_at", "until")
TRUTHS = ("capture", "settle")
TOP = (
    *(*TEXTS, *COUNTS, *TIMES, "restitution", "gravity", *TRUTHS),
    *("circle", "wall", "segment", "polygon", "arc", "pocket"),
)
CIRCLE = ("id", "x", "y", "r", "vx", "vy", "m", "point", "fixed")
LINE = ("id", "x0", "y0", "x1", "y1")
WALL = (*LINE, "vx", "vy", "kind")
SEGMENT = (*LINE, "r", "vx", "vy")
POLYGON = ("id", "points", "r", "vx", "vy")
ARC = ("id", "x", "y", "r", "x0", "y0", "x1", "y1", "full")
POCKET = ("id", "x", "y", "r")

ABSENT = frozenset(
    [
        *("acceleration", "angle", "angular_velocity", "bounce", "box", "capsule", "constraint", "damping"),
        *("drag", "elasticity", "field", "force", "friction", "joint", "line", "motor", "mu", "omega"),
        *("period_x", "period_y", "rectangle", "rotation", "spin"),
        *("spring", "torque"),
    ]
)
"""Keys of other physics engines for what this world does not have: to be named as that, not as a slip of the pen."""

WORLD = "docs/scenes.md#what-the-world-has"
"""The page that says what it has."""


TOML_LIST, JSON_LIST = "write [[{kind}]] above each of them", 'write "{kind}": [{{...}}, {{...}}]'
"""How each kind of file writes a list of circles, walls or others."""


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
        values |= {key: _number("", key, data[key]) for key in (*TIMES, "restitution") if key in data}
        if "gravity" in data:
            values["gravity"] = _gravity(data["gravity"])
        values |= {key: _truth(key, data[key]) for key in TRUTHS if key in data}
        return Scene(
            circles=_things(data, "circle", _circle, remedy),
            walls=_things(data, "wall", _wall, remedy),
            pockets=_things(data, "pocket", _pocket, remedy),
            segments=_things(data, "segment", _segment, remedy),
            polygons=_things(data, "polygon", _polygon, remedy),
            arcs=_things(data, "arc", _arc, remedy),
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
    kind = row.get("kind", Wall.kind)
    if kind not in WALL_KINDS:
        raise SceneError(f"{label}: kind = {cut(kind)} is not known; choose {', '.join(WALL_KINDS)}")
    module, _, name = WALL_KINDS[kind].partition(":")
    make = getattr(import_module(module, __package__), name)
    return make(id=row["id"], **_numbers(label, row, required=("x0", "y0", "x1", "y1"), others=("vx", "vy")))


def _segment(label: str, row: dict[str, Any]) -> Segment:
    _check_keys(label, row, SEGMENT)
    return Segment(id=row["id"], **_numbers(label, row, required=("x0", "y0", "x1", "y1"), others=("r", "vx", "vy")))


def _polygon(label: str, row: dict[str, Any]) -> Polygon:
    _check_keys(label, row, POLYGON)
    if "points" not in row:
        raise SceneError(f"{label}: points is missing; write points = [[x, y], [x, y], [x, y]]")
    points: object = row["points"]
    if not isinstance(points, list):
        raise SceneError(f"{label}: points = {cut(row['points'])} is not a list; write [[x, y], [x, y], [x, y]]")
    pairs: list[tuple[Quantity, Quantity]] = []
    for number, point in enumerate(cast("list[object]", points), start=1):
        shown, pair = cut(point), cast("list[object]", point) if isinstance(point, list) else []
        if len(pair) != 2:
            raise SceneError(f"{label}: point {number} = {shown} is not a pair; write [x, y]")
        place = f"{label}: point {number}"
        pairs.append((_number(place, "x", pair[0]), _number(place, "y", pair[1])))
    return Polygon(pairs, id=row["id"], **_numbers(label, row, required=(), others=("r", "vx", "vy")))


def _arc(label: str, row: dict[str, Any]) -> Arc:
    _check_keys(label, row, ARC)
    full, ends = _truth(f"{label}: full", row.get("full", False)), ("x0", "y0", "x1", "y1")
    numbers = _numbers(label, row, required=("x", "y", "r", *(() if full else ends)), others=ends if full else ())
    x, y, r = (numbers[key] for key in ("x", "y", "r"))
    return Arc(x, y, r, *(numbers.get(key) for key in ends), id=row["id"], full=full)


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


def _gravity(value: Any) -> list[Quantity]:
    shown, parts = cut(value), cast("list[object]", value) if isinstance(value, list) else []
    if len(parts) != 2:
        raise SceneError(f"gravity = {shown} is not a pair; write gravity = [0, -10]")
    return [_number("gravity", key, part) for key, part in zip("xy", parts, strict=True)]


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
    for kind in ("circle", "wall", "segment", "polygon", "arc", "pocket"):
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
        if key in ("vx", "vy") and label.startswith(("arc", "pocket")):
            raise SceneError(f"{label}: {key}: an arc or a pocket does not move; leave it out")
        if label and key in ("restitution", "gravity"):
            raise SceneError(f"{label}: {key}: one holds for the whole scene; write it above the first table")
        if key not in known:
            near = difflib.get_close_matches(key[:SHOWN].lower(), known, n=1, cutoff=0.5)
            remedy = f"did you mean {near[0]!r}?" if near else f"known keys: {', '.join(known)}"
            raise SceneError(f"{label}{': ' if label else ''}key {cut(key)} is not known; {remedy}")


# -- Reads scenes from TOML and JSON text, exactly, and fast even where the text is hostile.

MAX_TOML = 2_000_000
"""Largest TOML text, in bytes: a scene of 10,000 circles takes half of it. Python reads that in a second."""

MAX_JSON = 20_000_000
"""Largest JSON text, in bytes: JSON is read ten times faster."""

MAX_LINE = 100_000
"""Longest line of TOML, in characters: room for five numbers of the longest kind."""

MAX_DIGITS = 4_300
"""Longest bare whole number, in digits: Python's own limit. A longer one is put in quotes."""

PART = r"""(?:(?<![\w-])[\w-]++|"(?:[^"\\\n]|\\.)*+"|'[^'\n]*+')"""
DOTTED = re.compile(rf"{PART}(?:[ \t]*+\.[ \t]*+{PART}){{8}}")
"""A dotted key of nine parts or more. No scene has one, and Python's TOML reader takes time and memory that
grow with the square of their number: 50,000 parts take 5 seconds, 100,000 all the memory there is."""


def loads_toml(text: str, where: str = "TOML") -> Scene:
    """The scene that a TOML text describes; `where` names the text in errors.

    Raises:
        SceneError: one line that names the text, the thing, its key and value, the reason and the remedy.

    >>> loads_toml('[[circle]]\\nid = "a"\\nx = 0.1\\ny = "sqrt(2)"\\nr = 1').circles[0].x
    Quantity('1/10')
    """
    _check_size(text, where, MAX_TOML, "write it as JSON, or leave something out")
    return scene_from_table(toml_table(text, where, _bare), where)


def toml_table(text: str, where: str, number: Callable[[str], Any] = float) -> dict[str, Any]:
    """The keys and values of a TOML text, whatever it is of; `where` names the text in errors.

    Args:
        number: what becomes of a number with a point or an exponent.

    Raises:
        SceneError: for what is no TOML, and for what would hold up the reader.
    """
    _check_lines(text, where)
    try:
        return tomllib.loads(text, parse_float=number)
    except tomllib.TOMLDecodeError as error:
        raise SceneError(f"{where}: not TOML: {_one_line(error)}") from None
    except RecursionError:
        raise SceneError(f"{where}: nested too deeply; write [[circle]] tables") from None
    except ValueError as error:
        raise SceneError(f"{where}: {_not_toml(error)}") from None


def loads_json(text: str, where: str = "JSON") -> Scene:
    """The scene that a JSON text describes; `where` names the text in errors.

    Raises:
        SceneError: one line that names the text, the thing, its key and value, the reason and the remedy.

    >>> loads_json('{"circle": [{"id": "a", "x": 0, "y": 1e-40, "r": "9/8"}]}').circles[0].r
    Quantity('9/8')
    """
    _check_size(text, where, MAX_JSON, "leave something out")
    try:
        data = json.loads(text, parse_float=Bare, parse_int=_whole, parse_constant=Bare, object_pairs_hook=_unique_keys)
    except json.JSONDecodeError as error:
        place = f"(at line {error.lineno}, column {error.colno})"
        raise SceneError(f"{where}: not JSON: {error.msg} {place}") from None
    except RecursionError:
        raise SceneError(f"{where}: not a scene: nested too deeply; write a list of circles") from None
    except SceneError as error:
        raise SceneError(f"{where}: {error}") from None
    if not isinstance(data, dict):
        shown = "a list" if isinstance(data, list) else cut(data)
        raise SceneError(f'{where}: {shown} is not a scene; write an object such as {{"circle": [...]}}')
    return scene_from_table(cast("dict[str, Any]", data), where, JSON_LIST)


def _check_size(text: str, where: str, limit: int, remedy: str) -> None:
    if len(text) > limit:
        raise SceneError(f"{where}: has {len(text)} characters; at most {limit}: {remedy}")
    if not text.strip():
        raise SceneError(f"{where}: is empty; write at least one circle")


def _check_lines(text: str, where: str) -> None:
    """Refuses what would hold up the TOML reader."""
    for number, line in enumerate(text.split("\n"), start=1):
        if len(line) > MAX_LINE:
            limits = f"at most {MAX_LINE}, and {MAX_LENGTH} for a number"
            raise SceneError(f"{where}: line {number} has {len(line)} characters; {limits}")
    dotted = DOTTED.search(text)
    if dotted is not None:
        number = text.count("\n", 0, dotted.start()) + 1
        raise SceneError(f"{where}: line {number}: {cut(dotted[0])} is a dotted key; write a plain one")


def _bare(text: str) -> Bare:
    return Bare(text.replace("_", ""))


def _whole(text: str) -> int | Bare:
    return int(text) if len(text) <= MAX_DIGITS else Bare(text)


def _unique_keys(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    table: dict[str, Any] = {}
    for key, value in pairs:
        if key in table:
            raise SceneError(f"key {cut(key)} is written twice in one object; keep one")
        table[key] = value
    return table


def _one_line(error: Exception) -> str:
    text = " ".join(str(error).split())
    return text if len(text) <= 3 * SHOWN else f"{text[:SHOWN]} ... {text[-SHOWN:]}"


def _not_toml(error: ValueError) -> str:
    if "digits" in str(error):  # int() counts them before it reads them
        return f'a bare whole number has more than {MAX_DIGITS} digits; put it in quotes: "123..."'
    return f"not TOML: {_one_line(error)}"


# -- Writes scenes as TOML and JSON text that reads back to the same scene.

BARE = re.compile(r"-?(0|[1-9][0-9]{0,14})", re.ASCII)
"""A whole number below 10**15: every reader of TOML holds it exactly."""

WIDE = "\\U{code:08x}"
"""How TOML spells a character beyond the first 65,536."""

PLAIN = 100
"""A number's text of at most this many characters is within the limits of reading for certain, as
it has no power and fewer than `MAX_DEPTH` pairs of parentheses. Longer ones are tried."""

NUMBERS = ("x", "y", "r", "vx", "vy", "m", "x0", "y0", "x1", "y1", "reverse_at", "until")


def dump_toml(scene: Scene) -> str:
    """The scene as TOML text that reads back to the same scene.

    Raises:
        SceneError: for a scene too large for a TOML file, or a number whose text is too long for one.

    >>> from .things import Circle
    >>> print(dump_toml(Scene([Circle(0, "1/3", vx="sqrt(2)")], name="one")), end="")
    name = "one"
    tie_policy = "simultaneous"
    <BLANKLINE>
    [[circle]]
    id = "c1"
    x = 0
    y = "1/3"
    r = 1
    vx = "sqrt(2)"
    vy = 0
    m = 1
    """
    lines: list[str] = []
    for key, value in _data(scene).items():
        if not isinstance(value, list) or key == "gravity":
            lines.append(_toml_line(key, value))
            continue
        for row in cast("list[dict[str, Any]]", value):
            lines += ["", f"[[{key}]]", *(_toml_line(name, number) for name, number in row.items())]
    return _bounded(scene, "\n".join(lines) + "\n", MAX_TOML, "TOML; write it as JSON")


def dump_json(scene: Scene) -> str:
    """The scene as JSON text that reads back to the same scene; every number is text.

    Raises:
        SceneError: for a scene too large for a JSON file, or a number whose text is too long for one.

    >>> from .things import Circle
    >>> print(dump_json(Scene([Circle(0, "1/3")])).splitlines()[4])
        {"id": "c1", "x": "0", "y": "1/3", "r": "1", "vx": "0", "vy": "0", "m": "1"}
    """
    items: list[str] = []
    for key, value in _data(scene).items():
        text = _json(value)
        if isinstance(value, list) and key != "gravity":
            rows = ",\n".join(f"    {_json(row)}" for row in cast("list[object]", value))
            text = f"[\n{rows}\n  ]"
        items.append(f"  {json.dumps(key)}: {text}")
    return _bounded(scene, "{\n" + ",\n".join(items) + "\n}\n", MAX_JSON, "JSON; leave something out")


def _json(value: object) -> str:
    return printable(json.dumps(value, ensure_ascii=False))


def _bounded(scene: Scene, text: str, limit: int, remedy: str) -> str:
    if len(text.encode()) > limit:
        raise SceneError(f"scene {cut(scene.name)}: over {limit} bytes as {remedy}")
    return text


def _data(scene: Scene) -> dict[str, Any]:
    """The scene's keys and values, once it is sure that a file can hold them."""
    data = scene.data()
    _check_table("", data)
    _check_table("gravity: ", dict(zip("xy", data.get("gravity", ()), strict=False)))
    for kind in ("circle", "wall", "segment", "polygon", "arc", "pocket"):
        rows: list[dict[str, Any]] = data.get(kind, [])
        for row in rows:
            label = f"{kind} {cut(row['id'])}: "
            _check_table(label, row)
            for number, point in enumerate(row.get("points", ()), start=1):
                _check_table(f"{label}point {number}: ", dict(zip("xy", point, strict=True)))
    return data


def _check_table(place: str, table: dict[str, Any]) -> None:
    for key, value in table.items():
        if not isinstance(value, str):
            continue
        if HALF_PAIR.search(value):
            raise SceneError(f"{place}{key} = {cut(value)} holds half a surrogate pair; write all of it")
        if key in NUMBERS and len(value) > PLAIN:
            try:
                Quantity.of(value)
            except SceneError as error:
                raise SceneError(f"{place}{key} = {error}; a file cannot hold it") from None


def _toml_line(key: str, value: Any) -> str:
    if isinstance(value, bool):
        return f"{key} = {'true' if value else 'false'}"
    if key == "gravity":
        return f"{key} = [{', '.join(map(_toml_number, value))}]"
    if isinstance(value, list):
        pairs = [", ".join(_toml_number(part) for part in pair) for pair in cast("list[list[str]]", value)]
        text = ", ".join(f"[{pair}]" for pair in pairs)
        if len(text) > PLAIN:
            text = "".join(f"\n    [{pair}]," for pair in pairs) + "\n"
        return f"{key} = [{text}]"
    if isinstance(value, int) or (key in NUMBERS and BARE.fullmatch(value)):
        return f"{key} = {value}"
    quoted = json.dumps(value, ensure_ascii=False)  # TOML escapes what JSON does, and the character 7f
    return f"{key} = {printable(quoted, WIDE)}"


def _toml_number(text: str) -> str:
    """One number of a list: as it stands where every reader of TOML holds it exactly, else in quotes."""
    return text if BARE.fullmatch(text) else json.dumps(text)


# -- Scene files on disk: read whole, written all or nothing.

GIVE = "give the path of a scene file"


def load_scene(path: str | os.PathLike[str]) -> Scene:
    """The scene in a file: `.toml` or `.json`.

    Raises:
        SceneError: one line that names the file, the thing, its key and value, the reason and the remedy.
    """
    where = os.fspath(path)
    if _suffix(where) == ".toml":
        return loads_toml(text_of(where, MAX_TOML, GIVE), where)
    return loads_json(text_of(where, MAX_JSON, GIVE), where)


def save_scene(scene: Scene, path: str | os.PathLike[str]) -> None:
    """Writes the scene to a file, `.toml` or `.json`: all of it, or nothing.

    Raises:
        SceneError: if the scene cannot be written as such a file, or the file cannot be written.
    """
    where = os.fspath(path)
    text = dump_toml(scene) if _suffix(where) == ".toml" else dump_json(scene)
    try:
        write_file(Path(where), text.encode())
    except OSError as error:
        raise SceneError(f"{where}: cannot be written: {error.strerror or error}") from None
    except ValueError as error:  # a zero byte in the path
        raise SceneError(f"{where!r}: cannot be written: {error}") from None


def _suffix(where: str) -> str:
    suffix = Path(where).suffix.lower()
    if suffix not in (".toml", ".json"):
        raise SceneError(f"{where}: a scene file ends in .toml or .json, not in {cut(suffix)}; rename it")
    return suffix
