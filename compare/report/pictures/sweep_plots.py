"""Pictures of a sweep: SVG text, with nothing but the standard library."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from ...picture import REFERENCE, plain_css
from ..charts import Curve, plot

if TYPE_CHECKING:
    from ...grids.row import Row
    from ...grids.survival import Step, Summary

STYLE = f"""<style>
svg {{ background: #fff; font: 12px sans-serif; }} .gridline {{ stroke: #ddd; }}
.tick {{ text-anchor: middle; dominant-baseline: middle; fill: #333; }} .end {{ text-anchor: end; }}
.start {{ text-anchor: start; }} .series {{ fill: none; stroke-width: 2; }} .reference {{ stroke: {REFERENCE}; }}
</style>"""


def staircase(steps: Sequence[Step]) -> list[tuple[float, float]]:
    """The corners of a survival curve, from all at event 0 down.

    >>> from truebreak.compare.grids.survival import survival
    >>> staircase(survival([(2, True), (5, False)]))
    [(0.0, 1.0), (2.0, 1.0), (2.0, 0.5)]
    """
    points, share = [(0.0, 1.0)], 1.0
    for step in steps:
        points += [(float(step.event), share), (float(step.event), step.share)]
        share = step.share
    return points


MOST_POINTS = 5_000
"""Points of one engine in a picture; of more scenes, every so manyth is drawn."""


def law_points(rows: Iterable[Row]) -> dict[str, list[tuple[float, float]]]:
    """For each engine (ln(1/eps)/lambda, time of divergence) of every scene for which both are known, or of a share."""
    from ...grids.survival import stored

    store = stored(rows)
    asked = "FROM rows WHERE event IS NOT NULL AND by_exponent IS NOT NULL"
    found: dict[str, list[tuple[float, float]]] = {}
    for engine, count in store.sql(f"SELECT engine, count(*) {asked} GROUP BY engine ORDER BY min(place), min(job)"):
        each = -(-count // MOST_POINTS)
        points = f"SELECT by_exponent, at {asked} AND engine = ? AND job % ? = 0 ORDER BY job"
        found[engine] = store.sql(points, engine, each)
    return found


def standalone(svg: str, engines: Sequence[str] = ()) -> str:
    """An SVG element of a page as a file of its own, with the styles of these engines."""
    head, rest = svg.split("\n", 1)
    told = f"<style>\n{plain_css(engines)}</style>\n" if engines else ""
    return f"{head}\n{STYLE}\n{told}{rest}\n"


def survival_svg(told: Sequence[Summary]) -> str:
    """The share of scenes whose history still agrees, over events, an engine a curve."""
    curves = [Curve(summary.engine, staircase(summary.survival), f"e{k}") for k, summary in enumerate(told)]
    return standalone(
        plot("Share of scenes whose history still agrees", "event", "share", curves),
        [summary.engine for summary in told],
    )


def law_svg(rows: Iterable[Row], told: Sequence[Summary]) -> str:
    """The time of each scene's divergence over ln(1/eps)/lambda, with each engine's fitted line."""
    clouds = law_points(rows)
    engines = dict.fromkeys([*(summary.engine for summary in told), *clouds])
    styles = {engine: f"e{k}" for k, engine in enumerate(engines)}
    lines: list[Curve] = []
    for summary in told:
        if summary.law is not None and summary.engine in clouds:
            law = summary.law
            ends = (f(x for x, _ in clouds[summary.engine]) for f in (min, max))
            line = [(x, law.slope * x + law.intercept) for x in ends]
            lines.append(Curve(f"line {summary.engine}", line, styles[summary.engine]))
    dots = [Curve(engine, points, styles[engine]) for engine, points in clouds.items()]
    svg = plot("Time of divergence over ln(1/eps)/lambda", "ln(1/eps)/lambda", "time", lines, dots=dots)
    return standalone(svg, [*styles])
