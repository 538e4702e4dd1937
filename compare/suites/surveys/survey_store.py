"""The rows of a survey in a file of JSON lines, each written as soon as it is made."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ....scenarios.disk import Lines
from ....scenarios.errors import SceneError
from ....scenarios.lazy import VERSION
from ....scenarios.scene import Scene
from ...scene_argument import scene_from
from ..survey import SCENES, SURVEYED, Surveyed, SurveyEntry, installed_version
from .recorded_survey import advised_of, cell_of_row

FORMAT = "truebreak/survey-rows-1"


def survey_settings(causes: bool, advice: bool, max_seconds: float | None) -> dict[str, Any]:
    """What a file of rows was made for.

    >>> survey_settings(True, False, None)["advice"]
    False
    """
    return {"truebreak": VERSION, "causes": causes, "advice": advice, "max_seconds": max_seconds}


class SurveyStore:
    """A file with rows of a survey, to which more are added.

    A row is taken from it where the engine, its version, its settings and the scene are what they are today; one that
    is damaged is made again, and what a kill left of a line is written over. One process writes at a time.

    Args:
        path: the file; made if it is not there.
        settings: what the survey asks for; the file must have been made for the same.

    Attributes:
        entries: the rows that are taken from it, by label and engine.

    Raises:
        SceneError: for a file that is none of these, or of another survey, or that cannot be written.
    """

    def __init__(self, path: str, settings: Mapping[str, Any]) -> None:
        self.path = path
        self.entries: dict[tuple[str, str], SurveyEntry] = {}
        head = _line({"schema": FORMAT, **settings})
        try:
            self._lines = Lines(Path(path))
            lines = [line.decode("utf-8", "replace") for line in self._lines.whole]
            if not lines and head.startswith(self._lines.rest):
                self._lines.add(head)
                return
        except BlockingIOError as error:
            raise self._refused(str(error)) from None
        except OSError as error:
            raise self._refused(f"{error.strerror}; choose another place") from None
        self._check(lines[0] if lines else "", settings)
        scenes = {label: scene_from(task.scene) for label, task in SCENES.items()}
        for line in lines[1:]:
            entry = _entry_of(line, path, scenes)
            if entry is not None:
                self.entries[entry.label, entry.name] = entry

    def add(self, entry: SurveyEntry) -> None:
        """Writes a row: it is on disk when this returns.

        Raises:
            SceneError: if the file cannot be written.
        """
        (one,) = (one for one in SURVEYED if one.name == entry.name)
        row = {
            "label": entry.label,
            "engine": entry.name,
            "version": installed_version(one),
            "settings": one.texts,
            "cells": [cell.data() for cell in entry.tried],
            "advice": None if entry.advice is None else entry.advice.data(),
        }
        try:
            self._lines.add(_line(row))
        except OSError as error:
            raise self._refused(f"{error.strerror}; make room: what is in it stays") from None
        self.entries[entry.label, entry.name] = entry

    def _check(self, line: str, settings: Mapping[str, Any]) -> None:
        head = _object(line)
        if head is None or head.get("schema") != FORMAT:
            raise self._refused("holds no rows of a survey; choose another file")
        for key, value in settings.items():
            if head.get(key) != value:
                raise self._refused(
                    f"its survey has {key} = {head.get(key)!r}, here it is {value!r}; choose another file"
                )

    def _refused(self, told: str) -> SceneError:
        return SceneError(f"--store {self.path!r}: {told}")


def _line(data: Mapping[str, Any]) -> bytes:
    return json.dumps(data, allow_nan=False).encode("utf-8") + b"\n"


def _entry_of(line: str, path: str, scenes: Mapping[str, Scene]) -> SurveyEntry | None:
    """The row of a line, if it is whole and holds today."""
    row = _object(line)
    if row is None or row.get("label") not in scenes:
        return None
    one: Surveyed | None = next((one for one in SURVEYED if one.name == row.get("engine")), None)
    if one is None or row.get("version") != installed_version(one) or row.get("settings") != one.texts:
        return None
    try:
        cells = tuple(cell_of_row(path, cell) for cell in row["cells"])
        advice = None if row["advice"] is None else advised_of(path, row["advice"])
    except (SceneError, KeyError, TypeError):
        return None
    if not cells or any(cell.digest != scenes[row["label"]].digest for cell in cells):
        return None
    return SurveyEntry(row["label"], one.name, cells, advice)


def _object(line: str) -> dict[str, Any] | None:
    try:
        found: Any = json.loads(line)
    except (ValueError, RecursionError):
        return None
    return found if isinstance(found, dict) else None
