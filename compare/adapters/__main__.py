"""`python -m truebreak.compare.adapters`: what one step of each installed engine of steps costs here."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from time import process_time

from ...scenarios.errors import SceneError
from ..engines import ENGINES, engine
from ..scene_argument import scene_from

SCENES = ("gas", "gas:n=3", "cradle", "cradle:gap=0", "rack:rows=3,pockets=no,speed=8")


def costs(steps: int) -> Iterator[tuple[str, str, float | None]]:
    """Engine, scene, and microseconds of processor time a step, of a run of so many steps; None: not possible.

    The run before it, of one step, is not counted: it loads and sets up.
    """
    for name in ENGINES:
        try:
            chosen = engine(name)
        except SceneError:
            continue
        if chosen.step is None:
            continue
        for text in SCENES:
            scene = scene_from(text)
            try:
                chosen.run(scene, until=chosen.step, events=steps)
                since = process_time()
                run = chosen.run(scene, until=steps * chosen.step, events=steps)
            except SceneError:
                yield name, text, None
                continue
            done = float(run.final_time) / chosen.step
            yield name, text, (process_time() - since) / done * 1e6 if done >= 1 else None


def main(arguments: list[str] | None = None) -> int:
    """Prints the table; the exit status."""
    parser = argparse.ArgumentParser(prog="python -m truebreak.compare.adapters", description=__doc__)
    parser.add_argument("--steps", type=int, default=20_000, metavar="N", help="of each run (20,000)")
    steps = parser.parse_args(arguments).steps
    if steps < 1:
        print(f"error: --steps = {steps}: must be a whole number from 1", file=sys.stderr)
        return 2
    print("| engine | scene | microseconds a step |\n|---|---|---|", flush=True)
    for name, scene, cost in costs(steps):
        print(f"| `{name}` | `{scene}` | {'not possible' if cost is None else f'{cost:.3g}'} |", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
