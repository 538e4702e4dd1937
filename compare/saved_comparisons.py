"""Comparisons saved to files: the report for any reader, and all that they are made of."""

from __future__ import annotations

import hashlib
import json
import os
from pathlib import Path
from typing import Any

from ..scenarios.errors import SceneError
from ..scenarios.showing import cut
from ..scenarios.version import VERSION
from .cli.writing import write_whole
from .comparison import Comparison
from .documents.comparison import comparison_json
from .documents.objects import Reader, Writer

SCHEMA = "truebreak/saved-comparison-1"


def save_comparison(comparison: Comparison, path: str | os.PathLike[str]) -> None:
    """Writes a comparison to a file that `load_comparison` reads: all of it, or nothing.

    Raises:
        SceneError: if it holds what no file can, such as settings or outcomes of classes of your own, or if the place
            cannot be written to.
    """
    write_whole(os.fspath(path), saved_comparison(comparison))


def saved_comparison(comparison: Comparison) -> str:
    """The text of such a file.

    >>> from truebreak.compare import compare
    >>> from truebreak.scenarios import catalogue
    >>> found = compare(catalogue.build("near-tie:k=40"), ["double"], events=2)
    >>> again = comparison_of(saved_comparison(found))
    >>> again.verdict, again.reference.events[1].time.text() == found.reference.events[1].time.text()
    ('diverged', True)
    """
    writer = Writer()
    data = {
        "schema": SCHEMA,
        "version": VERSION,
        "comparison": comparison_json(comparison),
        "objects": writer(comparison),
    }
    data = json.loads(json.dumps({**data, "roots": writer.roots}))
    return json.dumps({**data, "digest": _digest(data)}) + "\n"


def load_comparison(path: str | os.PathLike[str]) -> Comparison:
    """The comparison in a file that `truebreak compare --save FILE` wrote, exact values and logs included.

    The digest in the file tells damage, not forgery; only objects of truebreak's own are made of it.

    Raises:
        SceneError: one line, for a file that is not there, is none of these, is damaged or is of another version.
    """
    where = os.fspath(path)
    try:
        text = Path(where).read_bytes().decode("utf-8", errors="replace")
    except OSError as error:
        raise SceneError(f"{where}: cannot be read: {error.strerror or error}; check the path") from None
    return comparison_of(text, where)


def comparison_of(text: str, where: str = "the text") -> Comparison:
    """The comparison in the text of such a file; `where` names it in errors.

    Raises:
        SceneError: as `load_comparison`.
    """
    damaged = SceneError(f"{where}: is damaged; save the comparison again")
    try:
        data: Any = json.loads(text)
    except (ValueError, RecursionError):
        data = None
        if text.startswith(f'{{"schema": "{SCHEMA}"'):
            raise damaged from None
    if not isinstance(data, dict) or data.get("schema") != SCHEMA:  # type: ignore[reportUnknownMemberType]
        raise SceneError(f"{where}: is not a saved comparison; write one with `truebreak compare SCENE --save FILE`")
    known: dict[str, Any] = data
    if known.get("version") != VERSION:
        raise SceneError(
            f"{where}: was saved by truebreak {cut(known.get('version'))}, and this is {VERSION}; "
            "save the comparison again, or install that version"
        )
    if known.pop("digest", None) != _digest(known):
        raise damaged
    try:
        found = Reader(known["roots"])(known["objects"])
    except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError):
        raise damaged from None
    if not isinstance(found, Comparison):
        raise damaged
    return found


def _digest(data: dict[str, Any]) -> str:
    return hashlib.sha256(json.dumps(data, sort_keys=True).encode()).hexdigest()
