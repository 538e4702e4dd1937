"""Golden runs and logs: written once beside a test, and compared ever after."""

from __future__ import annotations

import json
import os
import tempfile
from math import inf, nextafter
from pathlib import Path
from typing import Any

from ...scenarios.trajectory import Trajectory
from ..logdiff.desync import Desync, diff
from ..logdiff.log_format import FORMAT
from ..report.documents import trajectory_json
from ..writing import write_whole

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


# ----------------------------------------
# Two runs that are to be the same: a log, or a run, compared with a golden log.

REGENERATE = "TRUEBREAK_REGEN"
"""Set in the environment, golden logs are written anew; the pytest plugin does so with `--truebreak-regen`."""


class NotTheSame(AssertionError):
    """A run differs from its golden one; the message is the report of `truebreak diff`.

    Attributes:
        desync: the comparison; None where there is no golden run yet.
    """

    def __init__(self, message: str, desync: Desync | None = None) -> None:
        super().__init__(message)
        self.desync = desync


def same(
    run: Trajectory | str | Path, golden: str | Path, *, regenerate: bool | None = None, ignore: tuple[str, ...] = ()
) -> Desync | None:
    """Requires that a run is the same as a golden one: to the last bit, but for the order of independent events.

    Args:
        run: a log, in any form that `truebreak diff` reads, or a run of truebreak.
        golden: the log that it is to be the same as. Where there is none it is written, and the check fails all the
            same, so that nobody takes it for tested.
        regenerate: writes the golden log anew; by default where pytest runs with `--truebreak-regen`.
        ignore: free fields that are not compared.

    Returns:
        The comparison; None where the golden log was written anew.

    Raises:
        NotTheSame: with the report: where they part, how it grew, and whether it began as rounding.
        EngineError: for a log that cannot be read.

    >>> import truebreak as tb
    >>> folder = Path(tempfile.mkdtemp())
    >>> run = tb.run(tb.scene("cradle:n=3"), events=4)
    >>> same(run, folder / "cradle.jsonl", regenerate=True)
    >>> same(run, folder / "cradle.jsonl").verdict.line
    'identical'
    """
    __tracebackhide__ = True
    path = Path(golden)
    text = Path(run).read_text("utf-8") if isinstance(run, str | Path) else log_of(run)
    again = REGENERATE in os.environ if regenerate is None else regenerate
    if again or not path.exists():
        missing = not path.exists()
        path.parent.mkdir(parents=True, exist_ok=True)
        write_whole(path, text)
        if missing and not again:
            raise NotTheSame(f"{path} was missing; it is written now: look at it, commit it, and run the test again")
        return None
    if isinstance(run, str | Path):
        found = diff(path, run, ignore=ignore)
    else:
        with tempfile.TemporaryDirectory() as folder:
            log = Path(folder) / "run.jsonl"
            log.write_text(text, encoding="utf-8")
            found = diff(path, log, ignore=ignore)
    if not found.verdict.same:
        raise NotTheSame(f"{found}\nif the change is right: --truebreak-regen", found)
    return found


def log_of(run: Trajectory) -> str:
    """A run of truebreak as a log: its events, with the states that each leaves."""
    places = {str(c.id): k for k, c in enumerate(run.scene.circles)}
    lines: list[dict[str, Any]] = [
        {"log": FORMAT, "engine": run.engine, "scene": run.scene.name, "fields": ["x", "y", "vx", "vy"]}
    ]
    times = [float(event.time) for event in run.events]
    end = float(run.final_time)
    after = [nextafter(time, inf) for time in times]  # a time is rounded: just after it is what the event leaves
    rows = list(run.sample([time for time in after if time < end]))
    rows += [run.final.array()] * (len(times) - len(rows))
    for event, time, row in zip(run.events, times, rows, strict=True):
        pairs = [[str(name) for name in pair] for pair in event.impulses]
        states = {i: row[places[i]].tolist() for pair in pairs for i in pair if i in places}
        lines.append({"time": time, "contacts": pairs, "states": states})
    return "".join(json.dumps(line) + "\n" for line in [*lines, {"end": float(run.final_time)}])
