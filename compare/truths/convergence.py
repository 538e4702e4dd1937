"""How slowly averages come to their closed forms: `python -m truebreak.compare.truths.convergence` prints the table."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from fractions import Fraction

from . import ensembles
from .ensembles import Record, estimate
from .statistically import ANY_PATH, PATH, boxes, dahlqvist, points, sinai, two_disc_rate

HALVINGS = 8
"""The shortest beginnings are so many times halved: down to a handful of hits a run."""

HEAD = "| average | time of each run | hits | estimate | difference from the closed form |\n|---|---|---|---|---|"


def rows(name: str, records: Sequence[Record], tell: Callable[[Sequence[Record]], float], form: float) -> list[str]:
    """One ensemble over ever longer beginnings of its runs, as far as each run hits at all, against the closed form."""
    told: list[str] = []
    for halvings in range(HALVINGS, -1, -2):
        until = records[0].until / 2**halvings
        part = [mine.cut(until) for mine in records]
        if not all(len(mine.hits) for mine in part):
            continue
        found = estimate(part, tell)
        hits = sum(len(mine.hits) for mine in part)
        off = f"{found.value / form - 1:+.1%} +- {found.error / form:.1%}".replace("%", " %")
        told.append(f"| {name} | {until:.4g} | {hits:,} | {found.value:.4g} +- {found.error:.2g} | {off} |")
    return told


def table() -> str:
    """The averages that have closed forms (exponents of the Sinai billiard: the beginning of an expansion in R)."""
    lines = [HEAD]
    lines += rows("path between disc hits", points(), ensembles.path, PATH)
    lines += rows("path between hits of anything", points(), ensembles.any_path, ANY_PATH)
    lines += rows("meetings of two discs", boxes(), ensembles.rate, two_disc_rate(1.0, 0.1, 0.98))
    for r, until in (("1/5", 100), ("1/20", 400)):
        form = dahlqvist(float(Fraction(r)))
        lines += rows(f"exponent per hit, R = {r}", sinai(r, until), ensembles.exponent_per_hit, form)[-3:]
    return "\n".join(lines)


if __name__ == "__main__":
    print(table())
    sys.exit(0)
