"""A sweep for people."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from .output import console, counted, grid, say

if TYPE_CHECKING:
    from ..grids.survival import Summary, Uncertainty


def print_sweep(
    settings: Mapping[str, Any], scenes: int, told: Sequence[Summary], unsure: Mapping[str, Uncertainty]
) -> None:
    """One row an engine, and a line for each outcome that displacements of several sizes change."""
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
