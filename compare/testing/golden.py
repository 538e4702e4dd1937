"""Golden runs: a run as JSON beside the test that made it, written once and compared ever after."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from ...scenarios.trajectory import Trajectory
from ..cli.writing import write_whole
from ..files.documents import trajectory_json

GOLDEN_SCHEMA = "truebreak/golden-1"

LEFT_OUT = frozenset({"schema", "plan", "notes"})
"""What may change without another history: how decisions were reached, and what is said of it."""

SHOWN = 5
"""Differences that are told."""


class Golden:
    """A stored run, which a run equals if it has the same scene, events, times, contacts, stop and final state.

    Times and coordinates of a certified run are the nearest doubles, which are the same on every machine. Where the
    file is missing, or is to be written anew, the run that it is compared with is written; a missing one is unequal
    all the same, so that nobody takes it for tested.
    """

    def __init__(self, path: Path, *, regenerate: bool = False) -> None:
        self.path, self.regenerate = path, regenerate
        self._told: tuple[Trajectory, list[str]] | None = None

    def __str__(self) -> str:
        return f"the golden run {self.path.name}"

    __repr__ = __str__

    __hash__ = object.__hash__

    def __eq__(self, run: object) -> bool:
        if not isinstance(run, Trajectory):
            return NotImplemented
        return not self._differences(run)

    def truebreak_differences(self, run: object) -> list[str]:
        """What differs, in words."""
        return list(self._differences(run)) if isinstance(run, Trajectory) else []

    def _differences(self, run: Trajectory) -> list[str]:
        """Of the run that was asked for last: a missing file stays missing for it, though it is written."""
        if self._told is None or self._told[0] is not run:
            self._told = run, self._compared(run)
        return self._told[1]

    def _compared(self, run: Trajectory) -> list[str]:
        data = golden_json(run)
        if self.regenerate or not self.path.exists():
            missing = not self.path.exists()
            self.path.parent.mkdir(parents=True, exist_ok=True)
            write_whole(self.path, json.dumps(data, indent=1) + "\n")
            told = f"{self.path} was missing; it is written now: look at it, commit it, and run the test again"
            return [told] if missing and not self.regenerate else []
        try:
            stored = json.loads(self.path.read_text(encoding="utf-8"))
            version = stored["schema"]
        except (OSError, ValueError, KeyError, TypeError, RecursionError) as error:
            return [f"{self.path} is damaged ({type(error).__name__}: {error}); write it anew: --truebreak-regen"]
        if version != GOLDEN_SCHEMA:
            return [f"{self.path} is {version!r}, this version has {GOLDEN_SCHEMA!r}; write it anew: --truebreak-regen"]
        found = list(differences(stored, data, ""))
        more = [f"... and {len(found) - SHOWN} more"] if len(found) > SHOWN else []
        return [*found[:SHOWN], *more, *(["if the change is right: --truebreak-regen"] if found else [])]


def golden_json(run: Trajectory) -> dict[str, Any]:
    """A run as a golden file has it."""
    data = {key: value for key, value in trajectory_json(run).items() if key not in LEFT_OUT}
    return json.loads(json.dumps({"schema": GOLDEN_SCHEMA, **data}))


def differences(stored: Any, data: Any, place: str) -> list[str]:
    """Where two JSON values differ, in words.

    >>> differences({"a": [1, 2]}, {"a": [1, 3]}, "")
    ['a[1]: 3, the golden run has 2']
    """
    if isinstance(stored, dict) and isinstance(data, dict):
        keys = sorted(stored.keys() | data.keys())
        inner = [(f"{place}.{key}".lstrip("."), stored.get(key), data.get(key)) for key in keys]
    elif isinstance(stored, list) and isinstance(data, list) and len(stored) == len(data):
        inner = [(f"{place}[{k}]", one, other) for k, (one, other) in enumerate(zip(stored, data, strict=True))]
    elif isinstance(stored, list) and isinstance(data, list):
        return [f"{place}: {len(data)} of them, the golden run has {len(stored)}"]
    else:
        return [] if stored == data else [f"{place}: {data!r}, the golden run has {stored!r}"]
    return [told for where, one, other in inner for told in differences(one, other, where)]
