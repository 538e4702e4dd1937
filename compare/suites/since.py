"""What changed from one report of a suite to the next: after a change of an engine, a compiler, a machine."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ...scenarios.disk import fits, text_of
from ...scenarios.errors import SceneError, cut
from .document import SUITE_SCHEMA

if TYPE_CHECKING:
    from .cell import Cell
    from .running import SuiteReport


MOST_BYTES = 64 << 20
"""The longest report that is read: some 100,000 cells."""

KINDS: dict[str, frozenset[type | None]] = {
    "scene": frozenset({str}),
    "engine": frozenset({str}),
    "digest": frozenset({str}),
    "verdict": frozenset({str}),
    "agreed": frozenset({int}),
    "events": frozenset({int}),
    "divergence": frozenset({dict, None}),
    "changed": frozenset({list}),
}
"""What a cell of a report has that is read again, and of which types."""

PARTED = {"event": int, "body": str, "expected": frozenset({str, None}), "got": frozenset({str, None})}
"""What is shown of a divergence."""


@dataclass(frozen=True)
class Since:
    """What became of one cell.

    Attributes:
        scene, engine: which.
        what: "verdict", "laws", "divergence", "outcomes", "scene" (its definition), "new" or "gone".
        sentence: in words.
    """

    scene: str
    engine: str
    what: str
    sentence: str

    def data(self) -> dict[str, Any]:
        """As JSON."""
        return {"scene": self.scene, "engine": self.engine, "what": self.what, "sentence": self.sentence}


def read_report(path: str) -> dict[str, Any]:
    """A report that was written with `--json`; its cells are what they are to be.

    Raises:
        SceneError: naming the file and the remedy.
    """
    where = f"file {path!r}"
    text = text_of(path, MOST_BYTES, "name a report of `truebreak suite --json`")
    try:
        data: Any = json.loads(text)
    except (ValueError, RecursionError):
        raise SceneError(f"{where}: is not JSON; name a report of `truebreak suite --json`") from None
    if not isinstance(data, dict) or data.get("schema") != SUITE_SCHEMA or not isinstance(data.get("cells"), list):
        raise SceneError(f"{where}: is no {SUITE_SCHEMA}; write one with `truebreak suite FILE.toml --json`")
    for number, cell in enumerate(data["cells"]):
        if not isinstance(cell, dict):
            raise SceneError(f"{where}: cell {number} is no object; write the report again")
        for key, kinds in KINDS.items():
            if key not in cell:
                raise SceneError(f"{where}: cell {number} lacks {key!r}; write the report again")
            if not fits(cell[key], kinds):
                raise SceneError(f"{where}: cell {number}: {key} = {cut(cell[key])}; write the report again")
        first = cell["divergence"]
        if first is not None and not all(key in first and fits(first[key], kind) for key, kind in PARTED.items()):
            raise SceneError(f"{where}: cell {number}: divergence has no event; write the report again")
        laws = cell.get("laws")
        if laws is not None and not (isinstance(laws, dict) and laws.keys() == {"kept", "told"}):
            raise SceneError(f"{where}: cell {number}: laws is not what it is to be; write the report again")
        if not fits(cell["changed"], [str]):
            raise SceneError(f"{where}: cell {number}: changed is no list of names; write the report again")
    return data


def since(earlier: dict[str, Any], report: SuiteReport) -> list[Since]:
    """Every cell of which something changed, first those that there are, then those that are gone."""
    before = {(cell["scene"], cell["engine"]): cell for cell in earlier["cells"]}
    found = [change for cell in report.cells if (change := _change(before.get(cell.key), cell)) is not None]
    now = {cell.key for cell in report.cells}
    gone = [
        Since(scene, name, "gone", f"{name} on {scene}: was in the earlier report, and is not in this suite")
        for scene, name in before
        if (scene, name) not in now
    ]
    return found + gone


def _change(earlier: dict[str, Any] | None, cell: Cell) -> Since | None:
    label = f"{cell.engine} on {cell.scene}"
    if earlier is None:
        return Since(*cell.key, "new", f"{label}: is new, {told(cell.data())}")
    if earlier["digest"] != cell.digest:
        return Since(*cell.key, "scene", f"{label}: the scene itself is another, and so nothing is compared")
    now = cell.data()
    if earlier["verdict"] != now["verdict"]:
        return Since(*cell.key, "verdict", f"{label}: {told(earlier)} before, {told(now)} now")
    if "laws" in earlier and _lawless(earlier) != _lawless(now):
        kept = [
            f"does not keep the law ({c['laws']['told']})" if _lawless(c) else "breaks no law" for c in (earlier, now)
        ]
        return Since(*cell.key, "laws", f"{label}: same verdict, but {kept[0]} before, {kept[1]} now")
    if _place(earlier) != _place(now):
        return Since(*cell.key, "divergence", f"{label}: {told(earlier)} before, {told(now)} now")
    if earlier.get("until") == now["until"] and sorted(earlier["changed"]) != sorted(now["changed"]):
        names = ", ".join(sorted(set(earlier["changed"]) ^ set(now["changed"])))
        return Since(*cell.key, "outcomes", f"{label}: same verdict, but other outcomes are wrong: {names}")
    return None


def _lawless(cell: dict[str, Any]) -> bool:
    """Whether a cell is of an engine that is known to break a law."""
    return bool(cell["laws"]) and cell["laws"].get("kept") is False


def _place(cell: dict[str, Any]) -> tuple[Any, ...]:
    """Where a history parts, whatever the last digits of its times."""
    first = cell["divergence"] or {}
    return (cell["agreed"], *(first.get(key) for key in ("event", "body", "expected", "got", "kind")))


def told(cell: dict[str, Any]) -> str:
    """A cell's verdict in a few words.

    >>> told({"verdict": "diverged", "divergence": {"event": 7}, "agreed": 7, "events": 9})
    'diverged at event 7'
    """
    if cell["divergence"] is not None:
        return f"diverged at event {cell['divergence']['event']:,}"
    word = {"agree": "agreed", "unsettled": "not settled", "undecided": "undecided"}.get(
        cell["verdict"], cell["verdict"]
    )
    return f"{word}, {cell['agreed']:,} of {cell['events']:,} events"
