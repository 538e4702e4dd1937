"""A survey that was written down, read again."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import MISSING, fields
from functools import partial
from typing import Any

from ....scenarios.disk import fits
from ....scenarios.errors import SceneError, cut
from ...alignment.align import VERDICTS
from ..cell import Cell
from ..since import read_report
from ..survey import SCENES, SURVEYED, Survey, SurveyEntry
from .advised import Advised

NUMBER = frozenset({int, float, None})

CELL = {
    "scene": str,
    "digest": str,
    "engine": str,
    "settings": dict,
    "verdict": str,
    "agreed": int,
    "events": int,
    "cause": frozenset({str, None}),
    "changed": [str],
    "drift": NUMBER,
    "stop": str,
    "unable": bool,
    "seconds": frozenset({int, float}),
    "times": NUMBER,
    "until": NUMBER,
}
"""What the parts of a cell are, but for its divergence."""

ADVICE = {"scene": str, "engine": str, "setting": frozenset({str, None}), "told": str}

SHAPE = {"versions": {str: str}, "missing": [str], "advice": list, "max_seconds": NUMBER}


def read_survey(paths: Sequence[str]) -> Survey:
    """The survey of one or more files that `truebreak survey --json` has written.

    Where several tell of an engine on a scene, the last of them is taken.

    Raises:
        SceneError: naming the file and the remedy.
    """
    versions: dict[str, str] = {}
    missing: set[str] = set()
    found: dict[tuple[str, str], list[Cell]] = {}
    advice: dict[tuple[str, str], Advised] = {}
    seconds = None
    for path in paths:
        data = read_report(path)
        if not isinstance(data.get("versions"), dict):
            raise SceneError(f"file {path!r}: is a report of a suite; name one of `truebreak survey --json`")
        for key, shape in SHAPE.items():
            if not fits(data.get(key, [] if key in ("missing", "advice") else None), shape):
                raise SceneError(f"file {path!r}: {key} = {cut(data.get(key))}; write the report again")
        versions |= data["versions"]
        missing |= set(data.get("missing", ()))
        seconds = data.get("max_seconds")
        mine: dict[tuple[str, str], list[Cell]] = {}
        for row in data["cells"]:
            cell = cell_of_row(path, row)
            mine.setdefault((cell.scene, cell.engine.partition(":")[0]), []).append(cell)
        found |= mine
        advice = {key: told for key, told in advice.items() if key not in mine}
        advice |= {(row.scene, row.engine): row for row in map(partial(advised_of, path), data.get("advice", ()))}
    entries = [
        SurveyEntry(label, one.name, tuple(found[task.scene, one.name]), advice.get((task.scene, one.name)))
        for label, task in SCENES.items()
        for one in SURVEYED
        if (task.scene, one.name) in found
    ]
    return Survey(versions, tuple(entries), tuple(sorted(missing)), seconds)


def cell_of_row(path: str, row: dict[str, Any]) -> Cell:
    """A cell from its JSON.

    Raises:
        SceneError: for one that lacks something.
    """
    try:
        wanted = [field.name for field in fields(Cell) if field.name in row or field.default is MISSING]
        values = {name: row[name] for name in wanted}
    except KeyError as error:
        raise SceneError(f"file {path!r}: a cell lacks {error}; write the report again") from None
    for name, shape in CELL.items():
        if not fits(values.get(name), shape):
            raise SceneError(f"file {path!r}: a cell has {name} = {cut(values.get(name))}; write the report again")
    if values["verdict"] not in VERDICTS:
        raise SceneError(f"file {path!r}: a cell has verdict = {cut(values['verdict'])}; write the report again")
    return Cell(**{**values, "changed": tuple(values["changed"])})


def advised_of(path: str, row: Any) -> Advised:
    """What is advised, from its JSON.

    Raises:
        SceneError: for what is not that.
    """
    if not fits(row, ADVICE):
        raise SceneError(f"file {path!r}: its advice is not what it is to be; write the report again")
    return Advised(**row)
