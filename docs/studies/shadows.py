"""How far shadows can be carried over gases.

`python docs/studies/shadows.py` prints the table of the docs.
"""

from __future__ import annotations

import argparse
import sys
from statistics import median

from truebreak.compare.shadowing.shadows import Shadow, longest
from truebreak.scenarios import catalogue

DISCS = (2, 3, 4, 6, 8, 10)
SEEDS = range(1, 6)
ENGINES = ("double", "single", "pymunk:dt=1/256")
EVENTS = 500


def row(n: int, engine: str, carried: list[tuple[Shadow, Shadow | None]]) -> str:
    """One line of the table: an engine over the gases of n discs."""
    whole = [found for found, _ in carried if found.proof is not None]
    reached = sorted(0 if best is None else best.events for _, best in carried)
    left = sorted(found.divergence.event for found, _ in carried if found.divergence is not None)
    sizes = [best.proof.run_distance.position for _, best in carried if best is not None and best.proof is not None]
    blocked = sorted({found.blocked.obstacle.value for found, _ in carried if found.blocked is not None})
    return (
        f"| {n} | {engine} | {f'{left[0]} to {left[-1]}' if left else '-'} | {len(whole)} of {len(carried)} "
        f"| {reached[0]} | {f'{median(sizes):.1e}' if sizes else '-'} | {', '.join(blocked) or '-'} |"
    )


def main(arguments: list[str] | None = None) -> int:
    """Prints the table; the exit status."""
    parser = argparse.ArgumentParser(prog="python docs/studies/shadows.py", description=__doc__)
    parser.add_argument("--events", type=int, default=EVENTS, help=f"how many events ({EVENTS})")
    parser.add_argument("--seeds", type=int, default=len(SEEDS), help=f"how many gases of each size ({len(SEEDS)})")
    parser.add_argument("--discs", type=int, action="append", metavar="N", help="only gases of N discs")
    parser.add_argument("--engine", action="append", metavar="E", help="only this engine")
    options = parser.parse_args(arguments)
    print("| discs | engine | diverges at event | shadowed over all | least carried | median distance | blocked by |")
    print("|---|---|---|---|---|---|---|")
    for n in options.discs or DISCS:
        for engine in options.engine or ENGINES:
            scenes = (catalogue.build(f"gas:n={n},seed={seed}") for seed in SEEDS[: options.seeds])
            print(row(n, engine, [longest(scene, engine, events=options.events) for scene in scenes]), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
