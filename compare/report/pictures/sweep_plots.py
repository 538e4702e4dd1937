"""Pictures of a sweep: SVG text, with nothing but the standard library."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from .curves import Curve, plot

if TYPE_CHECKING:
    from ...ensemble.rows.row import Row
    from ...ensemble.survival import Step, Summary

STYLE = """<style>
svg { background: #fff; font: 12px sans-serif; } .gridline { stroke: #ddd; } .series { fill: none; stroke-width: 2; }
.tick { text-anchor: middle; dominant-baseline: middle; fill: #333; } .end { text-anchor: end; }
.start { text-anchor: start; }
.s0 { stroke: #0072b2; } .s1 { stroke: #d55e00; } .s2 { stroke: #009e73; } .s3 { stroke: #cc79a7; }
.s4 { stroke: #6b5b00; }
.dot.s0 { fill: #0072b2; } .dot.s1 { fill: #d55e00; } .dot.s2 { fill: #009e73; } .dot.s3 { fill: #cc79a7; }
.dot.s4 { fill: #6b5b00; }
</style>"""
"""Colours that those who see few colours tell apart (Okabe and Ito)."""


def staircase(steps: Sequence[Step]) -> list[tuple[float, float]]:
    """The corners of a survival curve, from all at event 0 down.

    >>> from truebreak.compare.ensemble.survival import survival
    >>> staircase(survival([(2, True), (5, False)]))
    [(0.0, 1.0), (2.0, 1.0), (2.0, 0.5)]
    """
    points, share = [(0.0, 1.0)], 1.0
    for step in steps:
        points += [(float(step.event), share), (float(step.event), step.share)]
        share = step.share
    return points


def law_points(rows: Iterable[Row]) -> dict[str, list[tuple[float, float]]]:
    """For each engine (ln(1/eps)/lambda, time of divergence) of every scene for which both are told."""
    found: dict[str, list[tuple[float, float]]] = {}
    for row in rows:
        if row["event"] is not None and row["by_exponent"] is not None:
            found.setdefault(row["engine"], []).append((row["by_exponent"], row["at"]))
    return found


def standalone(svg: str) -> str:
    """An SVG element of a page as a file of its own."""
    head, rest = svg.split("\n", 1)
    return f"{head}\n{STYLE}\n{rest}\n"


def survival_svg(told: Sequence[Summary]) -> str:
    """The share of scenes whose history is still true, over events, an engine a curve."""
    curves = [Curve(summary.engine, staircase(summary.survival)) for summary in told]
    return standalone(plot("Share of scenes whose history is still true", "event", "share", curves))


def law_svg(rows: Iterable[Row], told: Sequence[Summary]) -> str:
    """The time at which each scene's history was left over ln(1/eps)/lambda, with each engine's fitted line."""
    clouds = law_points(rows)
    lines: list[Curve] = []
    for summary in told:
        if summary.law is not None and summary.engine in clouds:
            law = summary.law
            ends = (f(x for x, _ in clouds[summary.engine]) for f in (min, max))
            lines.append(Curve(f"line {summary.engine}", [(x, law.slope * x + law.intercept) for x in ends]))
    dots = [Curve(engine, points) for engine, points in clouds.items()]
    svg = plot("Time of divergence over ln(1/eps)/lambda", "ln(1/eps)/lambda", "time", lines, dots=dots)
    return standalone(svg)
