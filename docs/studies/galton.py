"""Bins of many balls on a Galton board: certified, and in engines of finite precision; who came to another bin.

    python docs/studies/galton.py --balls 10000 --out galton.jsonl    # a second call goes on
    python docs/studies/galton.py --out galton.jsonl --report         # the tables

A ball's bin is that of the floor that it meets first. A certified run may end before by name; an engine's, by a limit.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections import Counter
from collections.abc import Iterator, Sequence
from math import comb
from pathlib import Path

from truebreak.exact import ExactEngine
from truebreak.floating import DoubleEngine, PymunkEngine, QuadEngine, SingleEngine
from truebreak.scenarios import catalogue
from truebreak.scenarios.engine import Engine
from truebreak.scenarios.trajectory import Trajectory

EVENTS = 100
"""Instants of a run: a ball that has come to no bin by then is counted as one that did not."""

ENGINES: dict[str, type[Engine]] = {
    "exact": ExactEngine,
    "double": DoubleEngine,
    "single": SingleEngine,
    "quad": QuadEngine,
    "pymunk": PymunkEngine,
}


def bin_of(run: Trajectory) -> int | str:
    """The bin, from 1; or why there is none, in the words of the run, without its numbers."""
    for event in run.events:
        for contact in event.contacts:
            if contact.second.startswith("bin "):
                return int(contact.second.removeprefix("bin "))
    return run.stop.reason.value if "accumulation suspected" not in run.stop.message else "accumulation suspected"


def balls(rows: int, e: str, low: int, high: int, names: Sequence[str]) -> Iterator[dict[str, int | str]]:
    """A row for each ball: its seed, and its bin in each engine."""
    for seed in range(low, high):
        scene = catalogue.build("galton", rows=rows, e=e, seed=seed)
        yield {"seed": seed, **{name: bin_of(ENGINES[name]().run(scene, events=EVENTS)) for name in names}}


def report(rows: int, found: Sequence[dict[str, int | str]]) -> Iterator[str]:
    """The tables, line by line."""
    names = [name for name in ENGINES if name in found[0]]
    counts = {name: Counter(row[name] for row in found) for name in names}
    yield f"{len(found)} balls, {rows} rows"
    yield "| bin | fair coins | " + " | ".join(names) + " |"
    yield "|---|---|" + "---|" * len(names)
    for k in range(rows + 1):
        coins = len(found) * comb(rows, k) / 2**rows
        yield f"| {k + 1} | {coins:.1f} | " + " | ".join(str(counts[name][k + 1]) for name in names) + " |"
    for why in sorted({x for count in counts.values() for x in count if isinstance(x, str)}):
        yield f"| {why} | | " + " | ".join(str(counts[name][why]) for name in names) + " |"
    sure = [row for row in found if isinstance(row["exact"], int)]
    for name in names[1:]:
        other = sum(isinstance(row[name], int) and row[name] != row["exact"] for row in sure)
        none = sum(not isinstance(row[name], int) for row in sure)
        yield f"{name}: another bin than the certified one {other} of {len(sure)} times, none {none} times"


def main(arguments: Sequence[str] | None = None) -> int:
    """The command line."""
    parser = argparse.ArgumentParser(
        prog="python docs/studies/galton.py", description=(__doc__ or "").partition("\n")[0]
    )
    parser.add_argument("--balls", type=int, default=100)
    parser.add_argument("--rows", type=int, default=10)
    parser.add_argument("--e", default="7/10", help="restitution")
    parser.add_argument("--engines", default=",".join(ENGINES))
    parser.add_argument("--out", type=Path, required=True, help="rows of one board; a second call goes on")
    parser.add_argument("--report", action="store_true", help="print the tables, run nothing")
    options = parser.parse_args(arguments)
    rows = [json.loads(line) for line in options.out.read_text("utf-8").splitlines()] if options.out.exists() else []
    if not options.report:
        names = options.engines.split(",")
        with options.out.open("a", encoding="utf-8") as file:
            for row in balls(options.rows, options.e, len(rows) + 1, options.balls + 1, names):
                rows.append(row)
                file.write(json.dumps(row) + "\n")
                file.flush()
    if not rows:
        parser.error(f"--report: {options.out} has no balls yet; run without it first")
    sys.stdout.write("\n".join(report(options.rows, rows)) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
