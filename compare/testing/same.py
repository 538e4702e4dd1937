"""Two runs that are to be the same: a log, or a run, compared with a golden log."""

from __future__ import annotations

import json
import os
import tempfile
from math import inf, nextafter
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..cli.writing import write_whole
from ..logdiff.desync import Desync, diff
from ..logdiff.log_format import FORMAT

if TYPE_CHECKING:
    from ...scenarios.trajectory import Trajectory


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
