"""Reads scenes from TOML and JSON text, exactly, and fast even where the text is hostile."""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Callable
from typing import Any, cast

from ..checks.showing import SHOWN, Bare, cut
from ..errors import SceneError
from ..numbers.parsing import MAX_LENGTH
from ..scene import Scene
from .table import JSON_LIST, scene_from_table

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
