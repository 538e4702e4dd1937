"""`python -m truebreak.compare.statistics`: runs the ladder and prints the tables of docs/statistics.md."""

from __future__ import annotations

import argparse
import math
import sys

from .boltzmann import CELLS
from .ladder import approximate, bias, certified, power
from .quantities import QUANTITIES

LADDER = (
    *(f"rounded:bits={bits}" for bits in (8, 10, 12, 16, 20)), "single",
    *(f"rounded:bits={bits}" for bits in (28, 32, 40, 48)), "double", "pymunk:dt=1/256",
)  # fmt: skip
"""The rungs, from 8 bits to 53, and a time-stepped engine."""


def main(arguments: list[str] | None = None) -> int:
    """Runs and prints; the exit status."""
    parser = argparse.ArgumentParser(prog="python -m truebreak.compare.statistics", description=__doc__)
    parser.add_argument("--scenes", type=int, help="starts of each ensemble, in place of its own number")
    parser.add_argument("--only", type=int, action="append", metavar="K", help="only quantity K, from 1 on")
    parser.add_argument("--engines", default=",".join(LADDER), help="the ladder")
    options = parser.parse_args(arguments)
    engines = options.engines.split(",")
    tests = len(QUANTITIES) * len(LADDER)
    for number, quantity in enumerate(QUANTITIES, 1):
        if options.only and number not in options.only:
            continue
        scenes = quantity.scenes(options.scenes or quantity.count)
        exact, events = certified(quantity, scenes)
        told = [value for value in exact.values if value is not None]
        mean = sum(told) / len(told)
        margin = quantity.margin * (abs(mean) or math.log(CELLS))
        chance = power(exact, margin, tests)
        print(f"\n{number}. {quantity.name}: {mean:.4g} in {len(told)} certified runs of {sum(events):,} events; "
              f"margin {margin:.2g}, power {chance:.2f}.\n")  # fmt: skip
        print("| engine | bias | standard error | runs lost | verdict |\n|---|---|---|---|---|")
        for name in engines:
            found = bias(exact, approximate(quantity, scenes, events, name), margin)
            print(
                f"| {name} | {found.value:+.2g} | {found.error:.2g} | {found.lost} | {found.verdict(tests)} |",
                flush=True,
            )
    return 0


if __name__ == "__main__":
    sys.exit(main())
