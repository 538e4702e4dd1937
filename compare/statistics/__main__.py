"""`python -m truebreak.compare.statistics`: runs the ladder; its tables go to the screen and to docs/statistics.md."""

from __future__ import annotations

import argparse
import math
import sys
from pathlib import Path

from ...scenarios.errors import SceneError
from ..writing import write_whole
from .boltzmann import CELLS
from .ladder import approximate, bias, certified, power
from .page import HEAD, figure, placed, row
from .quantities import QUANTITIES

LADDER = (
    *(f"rounded:bits={bits}" for bits in (8, 10, 12, 16, 20)), "single",
    *(f"rounded:bits={bits}" for bits in (28, 32, 40, 48)), "double", "pymunk:dt=1/256",
)  # fmt: skip
"""The rungs, from 8 bits to 53, and a time-stepped engine."""


def measured(number: int, engines: list[str], count: int | None = None) -> tuple[str, dict[str, str]]:
    """What is said of a quantity's certified ensemble, and the row of each engine, which are printed as they come."""
    quantity, tests = QUANTITIES[number - 1], len(QUANTITIES) * len(LADDER)
    scenes = quantity.scenes(count or quantity.count)
    exact, events = certified(quantity, scenes)
    values = [value for value in exact.values if value is not None]
    mean = sum(values) / len(values)
    margin = quantity.margin * (abs(mean) or math.log(CELLS))
    told = (
        f"**{quantity.name}**: {mean:.4g} in {len(values)} certified runs of {sum(events):,} events; "
        f"margin {margin:.2g}, power {power(exact, margin, tests):.2f}."
    )
    print(f"\n{told.replace('**', f'**{number}. ', 1)}\n\n{HEAD}", end="", flush=True)
    rows: dict[str, str] = {}
    for name in engines:
        found = bias(exact, approximate(quantity, scenes, events, name), margin)
        lost = f"{found.lost}, {found.endless} without end" if found.endless else f"{found.lost}"
        rows[name] = row([name, figure(found.value, "+.2g"), figure(found.error, ".2g"), lost, found.verdict(tests)])
        print(rows[name], flush=True)
    return told, rows


def main(arguments: list[str] | None = None) -> int:
    """Runs and prints; the exit status."""
    parser = argparse.ArgumentParser(prog="python -m truebreak.compare.statistics", description=__doc__)
    parser.add_argument("--scenes", type=int, help="starts of each ensemble, in place of its own number")
    parser.add_argument("--only", type=int, action="append", choices=range(1, len(QUANTITIES) + 1), metavar="K",
                        help="only quantity K, from 1 on")  # fmt: skip
    parser.add_argument("--engines", default=",".join(LADDER), help="the ladder")
    parser.add_argument("--page", help="put the rows into the tables of this page, such as docs/statistics.md")
    options = parser.parse_args(arguments)
    engines = options.engines.split(",")
    if options.page and (options.scenes or not set(engines) <= set(LADDER)):
        parser.error("--page: the page has its own numbers of starts and its own ladder")
    for number in options.only or range(1, len(QUANTITIES) + 1):
        try:
            told, rows = measured(number, engines, options.scenes)
        except SceneError as error:
            parser.error(str(error))
        if options.page:
            page = Path(options.page).read_text(encoding="utf-8")
            write_whole(options.page, placed(page, number, told, rows, LADDER))
    return 0


if __name__ == "__main__":
    sys.exit(main())
