"""Files with a digest of their contents, by which damage is told: what saved runs and comparisons have in common."""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass
from typing import Any, cast

from ..checks.showing import cut
from ..errors import SceneError
from ..lazy.version import VERSION


@dataclass(frozen=True)
class Seal:
    """One kind of saved file: a JSON object with its schema, the version that wrote it, and a digest of the rest.

    Attributes:
        schema: its name and number.
        kind: what is saved, in one word.
        command: what writes such a file.

    >>> seal = Seal("truebreak/run-1", "run", "truebreak run SCENE --save FILE")
    >>> data = seal.sealed({"roots": []})
    >>> seal.opened(json.dumps(data), "here")["roots"]
    []
    """

    schema: str
    kind: str
    command: str

    def sealed(self, data: dict[str, Any]) -> dict[str, Any]:
        """Contents with schema, version and digest."""
        whole = {"schema": self.schema, "version": VERSION, **data}
        return {**whole, "digest": digest(whole)}

    def opened(self, text: str, where: str) -> dict[str, Any]:
        """The contents of a file, checked; `where` names it in errors.

        Raises:
            SceneError: for what is none of these, is damaged or is of another version.
        """
        try:
            told: Any = json.loads(text)
        except (ValueError, RecursionError):
            told = None
            if text[:99].replace(" ", "").startswith(f'{{"schema":"{self.schema}"'):
                raise self.damaged(where) from None
        contents = cast("dict[str, Any]", told) if isinstance(told, dict) else {}
        if contents.get("schema") != self.schema:
            raise SceneError(f"{where}: is not a saved {self.kind}; write one with `{self.command}`")
        if contents.get("version") != VERSION:
            raise SceneError(
                f"{where}: was saved by truebreak {cut(contents.get('version'))}, and this is {VERSION}; "
                f"save the {self.kind} again, or install that version"
            )
        if contents.pop("digest", None) != digest(contents):
            raise self.damaged(where)
        return contents

    def damaged(self, where: str) -> SceneError:
        """What is said of a file whose contents are not what was written."""
        return SceneError(f"{where}: is damaged; save the {self.kind} again")


def fits(value: Any, shape: Any) -> bool:
    """Whether what was read as JSON has a shape.

    Args:
        shape: a type (bool is no int here), None, `Any`; a list with the shape of each item, a tuple with the shapes of
            just these items; a dict with the shape of each key's value, or `{str: shape}` for keys of any name; a
            frozenset of types and None, one of which it is.

    >>> fits([1, ["a", None]], (int, [frozenset({str, None})])), fits({"n": True}, {"n": int})
    (True, False)
    """
    if shape is Any:
        return True
    if isinstance(shape, list):
        return type(value) is list and all(fits(item, shape[0]) for item in cast("list[Any]", value))
    if isinstance(shape, tuple):
        parts, shapes = cast("list[Any]", value), cast("tuple[Any, ...]", shape)
        return type(value) is list and len(parts) == len(shapes) and all(map(fits, parts, shapes))
    if isinstance(shape, dict):
        if type(value) is not dict:
            return False
        told, wanted = cast("dict[str, Any]", value), cast("dict[Any, Any]", shape)
        if str in wanted:
            return all(fits(item, wanted[str]) for item in told.values())
        return told.keys() == wanted.keys() and all(fits(told[key], wanted[key]) for key in wanted)
    if isinstance(shape, frozenset):
        return (None if value is None else type(value)) in shape
    return value is None if shape is None else type(value) is shape


def digest(data: dict[str, Any]) -> str:
    """SHA-256 of contents, in hexadecimal."""
    return hashlib.sha256(json.dumps(data, sort_keys=True).encode()).hexdigest()
