"""Writes scenes as TOML and JSON text that reads back to the same scene."""

from __future__ import annotations

import json
import re
from typing import Any, cast

from ..checks.showing import cut, printable
from ..errors import SceneError
from ..numbers.quantity import Quantity
from ..scene import Scene
from .reader import MAX_JSON, MAX_TOML
from .table import HALF_PAIR

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

    >>> from ..things import Circle
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
        if not isinstance(value, list):
            lines.append(_toml_line(key, value))
            continue
        for row in cast("list[dict[str, Any]]", value):
            lines += ["", f"[[{key}]]", *(_toml_line(name, number) for name, number in row.items())]
    return _bounded(scene, "\n".join(lines) + "\n", MAX_TOML, "TOML; write it as JSON")


def dump_json(scene: Scene) -> str:
    """The scene as JSON text that reads back to the same scene; every number is text.

    Raises:
        SceneError: for a scene too large for a JSON file, or a number whose text is too long for one.

    >>> from ..things import Circle
    >>> print(dump_json(Scene([Circle(0, "1/3")])).splitlines()[4])
        {"id": "c1", "x": "0", "y": "1/3", "r": "1", "vx": "0", "vy": "0", "m": "1"}
    """
    items: list[str] = []
    for key, value in _data(scene).items():
        text = _json(value)
        if isinstance(value, list):
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
    for kind in ("circle", "wall", "pocket"):
        rows: list[dict[str, Any]] = data.get(kind, [])
        for row in rows:
            _check_table(f"{kind} {cut(row['id'])}: ", row)
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
    if isinstance(value, int) or (key in NUMBERS and BARE.fullmatch(value)):
        return f"{key} = {value}"
    quoted = json.dumps(value, ensure_ascii=False)  # TOML escapes what JSON does, and the character 7f
    return f"{key} = {printable(quoted, WIDE)}"
