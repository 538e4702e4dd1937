"""A benchmark's report for people."""

from __future__ import annotations

import math
from itertools import groupby
from typing import TYPE_CHECKING

from ...report.output import grid
from ..subjects import SUBJECTS
from ..tradeoff import told_digits

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ...report.output import TextTable
    from ..tradeoff import Tradeoff
    from .report import Report


def tables(report: Report) -> Iterator[TextTable]:
    """The figures, then one table for each scene."""
    if report.figures:
        yield _figures(report)
    for scene, rows in groupby(report.tradeoffs, key=lambda row: row.scene):
        yield _scene(scene, list(rows))


def _figures(report: Report) -> TextTable:
    right = ("first (s)", "second (s)", "ratio")
    title = "Ratios, each of two things timed in one run"
    table = grid("first / second", *right, "target", title=title, whole=right, right=right)
    for figure in report.figures:
        table.add_row(
            f"{figure.what}\n{figure.answer}" if figure.answer else figure.what,
            f"{figure.numerator:.4g}",
            f"{figure.denominator:.4g}",
            f"{figure.ratio:,.4g}",
            "" if figure.met is None else f"{figure.target}: {'met' if figure.met else 'MISSED'}",
        )
    return table


def _scene(name: str, rows: list[Tradeoff]) -> TextTable:
    spec = next((f" ({subject.spec})" for subject in SUBJECTS if subject.name == name), "")
    title = f"{name}{spec}, {rows[0].events:,} events; * is Pareto's front"
    table = grid("", "engine", "/ exact", "seconds", "agreed", "largest error", "digits", "outcomes", "memory",
                 title=title, whole=("engine", "/ exact", "seconds", "agreed", "digits", "memory"))  # fmt: skip
    for row in rows:
        if row.refused is not None:
            table.add_row("", row.engine, "", "", "", "", "", row.refused, "")
            continue
        digits = told_digits(row.digits)
        table.add_row(
            "*" if row.front else "",
            row.engine,
            f"{row.ratio:.3g}",
            f"{row.seconds:.3g}",
            f"{row.agreed:,}",
            f"{row.error:.2g}" if math.isfinite(row.error) else "infinite",
            "" if digits is None else str(digits),
            _outcomes(row),
            "" if row.memory is None else f"{row.memory / 2**20:.1f} MiB",
        )
    return table


def _outcomes(row: Tradeoff) -> str:
    if row.changed is None:
        return str(row.verdict)
    return f"wrong: {', '.join(row.changed)}" if row.changed else "right"
