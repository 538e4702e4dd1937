"""A sweep as the JSON object `truebreak/sweep-2`, and for people."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ..grids.survival import Summary, Uncertainty

SWEEP_SCHEMA = "truebreak/sweep-2"


def sweep_json(
    settings: Mapping[str, Any],
    scenes: int,
    told: Sequence[Summary],
    failures: Sequence[tuple[int, int, str]],
    unsure: Mapping[str, Uncertainty],
) -> dict[str, Any]:
    """The object that `truebreak sweep --json` prints: what was asked, and what the rows say together.

    Args:
        unsure: by outcome, how displacements of several sizes change it.
    """
    return {
        "schema": SWEEP_SCHEMA,
        "settings": dict(settings),
        "scenes": scenes,
        "engines": [_engine(summary) for summary in told],
        "uncertainty": {outcome: _uncertainty(found) for outcome, found in unsure.items()},
        "failures": [{"scene": scene, "attempt": attempt, "note": note} for scene, attempt, note in failures],
    }


def _engine(summary: Summary) -> dict[str, Any]:
    law, changed = summary.law, summary.changed
    return {
        "engine": summary.engine,
        "verdicts": summary.verdicts,
        "median": summary.median,
        "survival": [
            {"event": s.event, "share": s.share, "low": s.low, "high": s.high, "at_risk": s.at_risk}
            for s in summary.survival
        ],
        "band": {"inside": summary.inside[0], "left": summary.inside[1]},
        "law": None if law is None else vars(law),
        "changed": None if changed is None else dict(zip(("scenes", "of", "low", "high"), changed, strict=True)),
        "laws": dict(zip(("kept", "not_kept", "not_determined"), summary.laws, strict=True)),
    }


def _uncertainty(found: Uncertainty) -> dict[str, Any]:
    return {
        "shares": [vars(share) for share in found.shares],
        "exponent": found.exponent,
        "low": found.low,
        "high": found.high,
    }


def print_sweep(
    settings: Mapping[str, Any], scenes: int, told: Sequence[Summary], unsure: Mapping[str, Uncertainty]
) -> None:
    """One row an engine, and a line for each outcome that displacements of several sizes change."""
    from ..report.output import console, counted, grid, say

    out = console()
    asked = " ".join([settings["scene"], *settings["vary"]])
    say(out, f"{asked}: {counted(scenes, 'scene')}, each compared with its certified run.", "bold")
    asked_for = any(summary.changed is not None for summary in told)
    audited = any(any(summary.laws) for summary in told)
    foreseen = settings["forecast"]
    last = [*["outcomes changed"] * asked_for, *["law"] * audited]
    predicted = ["in the 90 % interval", "t = a ln(1/eps)/lambda + b"] * foreseen
    table = grid("engine", "verdicts", "median divergence", *predicted, *last)
    for summary in told:
        inside, left = summary.inside
        law, changed = summary.law, summary.changed
        cells = [
            summary.engine,
            ", ".join(f"{count} {verdict}" for verdict, count in summary.verdicts.items()),
            "" if summary.median is None else f"event {summary.median}",
        ]
        if foreseen:
            cells.append(f"{inside} of {left}" if left else "")
            line = "" if law is None else f"a = {law.slope:.3f}, b = {law.intercept:.3g}, r = {law.correlation:.2f}"
            cells.append(line)
        if asked_for:
            cells.append(
                "" if changed is None else f"{changed[0]} of {changed[1]} (95 %: {changed[2]:.3f} to {changed[3]:.3f})"
            )
        if audited:
            words = zip(summary.laws, ("kept", "not kept", "not determined"), strict=True)
            cells.append(", ".join(f"{count} {word}" for count, word in words if count))
        table.add_row(*cells)
    out.print(table)
    for outcome, found in unsure.items():
        if found.exponent is not None:
            say(out, f"{outcome}: a displacement of up to d changes it in a share of scenes that goes as d**a, "
                     f"a = {found.exponent:.3f} (95 %: {found.low:.3f} to {found.high:.3f}).")  # fmt: skip
