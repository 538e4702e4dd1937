"""One row's run in a process of its own: `python -m truebreak.compare.grids.measured`.

Reads one JSON object (`scene`, `engine`, `until`, `seconds`) and prints one: what each run took, the loop in turns with
the runs, and memory.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from .computer import Took, calibration, loop, memory, reset_peak, timed
from .executors import THREADS

if TYPE_CHECKING:
    from collections.abc import Mapping

SECONDS = 0.25
"""A run is repeated until all of it has taken so long."""

LEAST_RUNS, MOST_RUNS = 2, 60

ENOUGH_SECONDS = 4.0
"""A run that takes longer is not repeated: the loop's own steps say how even the machine was."""


@dataclass(frozen=True)
class MeasuredProcess:
    """What one process measured.

    Attributes:
        runs, loops: each run, and the loop in turns with the runs.
        memory: bytes of the peak while it ran first, above what the process held before; None where it is not told.
    """

    runs: tuple[Took, ...]
    loops: tuple[Took, ...]
    memory: int | None

    @property
    def ratio(self) -> float:
        """The fastest run, counted in the fastest loop.

        >>> MeasuredProcess((Took(3.0, 3.0), Took(2.0, 9.0)), (Took(0.5, 0.5),), None).ratio
        4.0
        """
        return min(t.cpu for t in self.runs) / min(t.cpu for t in self.loops)


def measure(spec: str, engine: str, until: str, seconds: float = SECONDS) -> MeasuredProcess:
    """Runs a scene in an engine in a process of its own.

    Raises:
        RuntimeError: if it comes to nothing, with what it said last.
    """
    asked = json.dumps({"scene": spec, "engine": engine, "until": until, "seconds": seconds})
    environment = {**os.environ, "PYTHONHASHSEED": "0", **dict.fromkeys(THREADS, "1")}
    done = subprocess.run(
        [sys.executable, "-P", "-m", __name__],
        input=asked,
        capture_output=True,
        text=True,
        check=False,
        env=environment,
    )
    if done.returncode:
        last = (done.stderr.strip().splitlines() or [f"exit code {done.returncode}"])[-1]
        raise RuntimeError(last)
    data = json.loads(done.stdout)
    runs, loops = (tuple(Took(*took) for took in data[key]) for key in ("runs", "loops"))
    return MeasuredProcess(runs, loops, data["memory"])


def answer(asked: Mapping[str, Any]) -> dict[str, Any]:
    """What the process prints."""
    from ...scenarios.numbers.quantity import Quantity
    from ..deadline import uninterrupted
    from ..engines import engine as engine_named
    from ..scene_argument import scene_from

    scene, runner, until = scene_from(asked["scene"]), engine_named(asked["engine"]), Quantity.of(asked["until"])

    def run() -> None:
        uninterrupted(runner.run(scene, until=until))

    uninterrupted(runner.run(scene, events=1, until=until))
    loop()
    reset_peak()
    before = memory()
    runs, loops = [timed(run)], calibration()
    after = memory()
    while len(runs) < MOST_RUNS and runs[0].cpu < ENOUGH_SECONDS:
        if len(runs) >= LEAST_RUNS and sum(t.cpu for t in runs) >= asked["seconds"]:
            break
        runs.append(timed(run))
        loops += calibration(1)
    grown = None if before is None or after is None else max(after[1] - before[0], 0)
    return {"runs": runs, "loops": loops, "memory": grown}


if __name__ == "__main__":
    print(json.dumps(answer(json.load(sys.stdin))))
