"""What it costs to write a certificate, and to check it, beside the run that it is of.

`python docs/studies/certificate_costs.py` measures `gas` over 1,000 and 3,000 events; `--events N,...` others.
"""

from __future__ import annotations

import argparse
import json
import resource
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from typing import TypeVar

from truebreak.compare.certificate.certified import verdict_on, write_certificate
from truebreak.compare.foreign.guard import run
from truebreak.scenarios import catalogue
from truebreak.tools import verify

T = TypeVar("T")

SCENE = "gas"

EVENTS = (1_000, 3_000)

RUNS = 5
"""Times that a run is made, which is short beside the rest: the median is told, so that one stall says nothing."""

WARM = 20
"""Events of a run that is made first, so that loading modules is no part of what is measured."""

SECOND = Path(verify.__file__).with_name("verify.mjs")
"""The checker for node; its row is left out where there is no node."""


@dataclass(frozen=True)
class Checking:
    """What one certificate cost.

    Attributes:
        events: of the run.
        run: seconds of this process for a run, the median of several.
        write: for the certificate.
        check, second: seconds of the two checkers' own processes; None of one that there is no program for.
        size: bytes of the certificate.
        bits: what it asks a checker to begin with.
    """

    events: int
    run: float
    write: float
    check: float
    second: float | None
    size: int
    bits: int


def checking(events: int, scene: str = SCENE) -> Checking:
    """Runs a scene, writes the certificate, and has it checked.

    Raises:
        SceneError: for a run without a certificate.
        RuntimeError: if a checker does not verify it.

    >>> told = checking(3, "lee")
    >>> told.size > 0, told.bits >= 160
    (True, True)
    """
    built = catalogue.build(scene)
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "certificate.json"
        runs = [_timed(lambda: run(built, events=events), resource.RUSAGE_SELF) for _ in range(RUNS)]
        ran, trajectory = median(spent for spent, _ in runs), runs[-1][1]
        written, _ = _timed(lambda: write_certificate(trajectory, str(file)), resource.RUSAGE_SELF)
        checked, (code, told) = _timed(lambda: verdict_on(str(file)), resource.RUSAGE_CHILDREN)
        if code:
            raise RuntimeError(f"{scene}, {events} events: {told}")
        text = file.read_bytes()
        second = _second(file)
    return Checking(events, ran, written, checked, second, len(text), json.loads(text)["bits"])


def _timed(work: Callable[[], T], whose: int) -> tuple[float, T]:
    """Seconds of the processor, of this process or of those that it waited for, and what came out."""
    before = resource.getrusage(whose)
    done = work()
    after = resource.getrusage(whose)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, done


def _second(file: Path) -> float | None:
    """Seconds of the second checker; None without node."""
    node = shutil.which("node")
    if node is None:
        return None
    command = [node, str(SECOND), str(file)]
    spent, done = _timed(
        lambda: subprocess.run(command, capture_output=True, text=True, check=False), resource.RUSAGE_CHILDREN
    )
    if done.returncode:
        raise RuntimeError(f"{SECOND.name}: {done.stdout}{done.stderr}")
    return spent


def table(measured: Sequence[Checking]) -> str:
    """Seconds of the processor, and in brackets how many times the run that is; a column for each run.

    >>> print(table([Checking(10, 0.5, 1.0, 2.0, None, 2_345, 700)]))
    | events of `gas` | 10 |
    |---|---|
    | run | 0.50 |
    | write the certificate | 1.0 (2) |
    | check, `verify.py` | 2.0 (4) |
    | the certificate | 2 kB, 700 bits |
    """
    rows = [
        ("events of `gas`", [f"{m.events:,}" for m in measured]),
        ("run", [_seconds(m.run) for m in measured]),
        ("write the certificate", [_times(m.write, m.run) for m in measured]),
        ("check, `verify.py`", [_times(m.check, m.run) for m in measured]),
        ("check, `verify.mjs`", [_times(m.second, m.run) for m in measured if m.second is not None]),
        ("the certificate", [f"{m.size / 1000:.0f} kB, {m.bits:,} bits" for m in measured]),
    ]
    head, *lines = (f"| {' | '.join([name, *cells])} |" for name, cells in rows if cells)
    return "\n".join([head, "|---" * (len(measured) + 1) + "|", *lines])


def _times(spent: float, of: float) -> str:
    return f"{_seconds(spent)} ({spent / of:.0f})"


def _seconds(spent: float) -> str:
    return f"{spent:.2f}" if spent < 1 else f"{spent:.1f}" if spent < 10 else f"{spent:.0f}"


def main(arguments: list[str] | None = None) -> int:
    """Measures and prints; the exit status."""
    parser = argparse.ArgumentParser(prog="python docs/studies/certificate_costs.py", description=__doc__)
    told = ",".join(map(str, EVENTS))
    parser.add_argument("--events", default=told, metavar="N,...", help=f"over how many events ({told})")
    options = parser.parse_args(arguments)
    words = options.events.split(",")
    if not all(word.isdecimal() and int(word) for word in words):
        parser.error(f"--events {options.events}: must be whole numbers from 1, with commas between them")
    checking(WARM)
    print(table([checking(int(word)) for word in words]))
    return 0


if __name__ == "__main__":
    sys.exit(main())
