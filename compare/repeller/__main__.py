"""`python -m truebreak.compare.repeller`: escape rate, exponent and entropy of the pinball of three discs."""

from __future__ import annotations

import argparse
import sys

from ...scenarios.errors import SceneError
from ...scenarios.numbers.quantity import Quantity
from .escape import escape
from .expansion import ladder, settled

DIGITS = 32
"""Decimals of a line of the table: one more than are published."""


def table(distance: Quantity, order: int) -> str:
    """The averages by cycles of up to 1, 2, ... letters, and the digits that the last two orders agree on.

    >>> print(table(Quantity.of(6), 4).splitlines()[-1])
    The last two orders agree on: escape rate 0.410338, exponent 0.577552, entropy 0.167214
    """
    rungs = list(ladder(distance, order))
    lines = ["| letters | orbits | escape rate | mean exponent | entropy |", "|---|---|---|---|---|"]
    for told in rungs:
        figures = (value.str(DIGITS, radius=False) for value in (told.escape, told.exponent, told.entropy))
        lines.append(f"| {told.order} | {told.orbits} | {' | '.join(figures)} |")
    if len(rungs) > 1:
        one, two = rungs[-2:]
        lines += ["", f"The last two orders agree on: escape rate {settled(one.escape, two.escape)}, "
                      f"exponent {settled(one.exponent, two.exponent)}, "
                      f"entropy {settled(one.entropy, two.entropy)}"]  # fmt: skip
    return "\n".join(lines)


def main(arguments: list[str] | None = None) -> int:
    """Prints the table and, asked for, the experiment; the exit status."""
    parser = argparse.ArgumentParser(prog="python -m truebreak.compare.repeller", description=__doc__)
    parser.add_argument("--distance", default="6", metavar="D", help="of the discs' centres, in radii (6)")
    parser.add_argument("--letters", type=int, default=12, metavar="N", help="cycles of up to N bounces (12)")
    parser.add_argument("--runs", type=int, metavar="N", help="let N certified runs escape too")
    options = parser.parse_args(arguments)
    try:
        if options.letters < 1 or (options.runs is not None and options.runs < 1):
            raise SceneError("--letters and --runs: must be whole numbers from 1")
        distance = _distance(options.distance)
        print(table(distance, options.letters))
        if options.runs is not None:
            told = escape(distance, options.runs, _progress if sys.stderr.isatty() else None)
            print(f"\n{told.runs:,} certified runs: {', '.join(f'{n:,}' for n in told.survivors)} bounce once, twice, "
                  f"...; escape rate {told.rate:.5f} +- {told.room:.5f}")  # fmt: skip
    except SceneError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    return 0


def _distance(text: str) -> Quantity:
    try:
        return Quantity.of(text)
    except SceneError as error:
        raise SceneError(f"--distance: {error}") from None


def _progress(done: int, total: int) -> None:
    if done % 100 == 0 or done == total:
        print(f"\r{done:,} of {total:,} runs", end="\n" if done == total else "", file=sys.stderr, flush=True)


if __name__ == "__main__":
    sys.exit(main())
