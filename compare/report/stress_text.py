"""A stress map as the JSON object `truebreak/stress-2`, and for people."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from itertools import groupby
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ..grids.row import Row
    from ..grids.store import Store
    from ..grids.stress_map import Ladder

STRESS_SCHEMA = "truebreak/stress-2"


def stress_json(settings: Mapping[str, Any], rows: Iterable[Row], told: Sequence[Ladder]) -> dict[str, Any]:
    """The object that `truebreak stress --json` prints: what was asked, where each engine turns wrong, and every row.

    Args:
        settings: what the map is of.
        rows: of its places, in order.
        told: the ladders of the rows.
    """
    from ..grids.stress_map import COLUMNS

    return {
        "schema": STRESS_SCHEMA,
        "settings": dict(settings),
        "exact": exact_counts(rows),
        "ladders": [_ladder(ladder) for ladder in told],
        "rows": [row.data(COLUMNS) for row in rows],
    }


def exact_counts(rows: Iterable[Row]) -> dict[str, int]:
    """At how many places the exact engine bears each mark, those that it bears at any, and to how many a closed form
    agrees.

    >>> from truebreak.compare.grids.row import Row
    >>> exact_counts([Row(0, "near-ties-left-1", "exact", "agree", mark="right", closed_form=True)])
    {'places': 1, 'closed_form': 1, 'right': 1}
    """
    exact = [row for row in rows if row.engine == "exact"]
    marks = [str(row.mark) for row in exact]
    counts = {mark: marks.count(mark) for mark in dict.fromkeys(marks)}
    return {"places": len(exact), "closed_form": sum(row.closed_form is True for row in exact), **counts}


def _ladder(ladder: Ladder) -> dict[str, Any]:
    return {
        "family": ladder.family,
        "side": ladder.side,
        "seed": ladder.seed,
        "engine": ladder.engine,
        "levels": list(ladder.levels),
        "first_wrong": ladder.first_wrong,
        "right_again": list(ladder.right_again),
        "stretches": [{"mark": mark.value, "from": low, "to": high} for mark, low, high in ladder.stretches],
    }


def exact_sentence(rows: Iterable[Row]) -> str:
    """What the witnesses say of the exact engine, with nothing left out.

    >>> from truebreak.compare.grids.row import Row
    >>> exact_sentence([Row(0, "near-ties-left-1", "exact", "agree", mark="right")])
    'The exact engine: right at 1 of 1 places, each proved again by the independent checker.'
    """
    counts = exact_counts(rows)
    others = [f"{count} {mark}" for mark, count in counts.items() if mark not in ("places", "closed_form", "right")]
    told = f"The exact engine: right at {counts.get('right', 0)} of {counts['places']} places, each proved again by the"
    closed = f"; at {counts['closed_form']} of all a closed form agrees" if counts["closed_form"] else ""
    return f"{told} independent checker{closed}{'; ' + ', '.join(others) if others else ''}."


def print_stress(rows: Store, told: Sequence[Ladder]) -> None:
    """One table a family, a row for each engine and lane, a letter for each k, in tens."""
    from ..grids.stress_families import stress_family
    from ..grids.stress_map import MapMark, place_of
    from .output import console, grid, say

    out = console()
    for name, group in groupby(told, key=lambda ladder: ladder.family):
        lanes, one = list(group), stress_family(name)
        say(out, f"{name}: {one.summary} {one.grows}.", "bold")
        levels = lanes[0].levels
        table = grid("engine", "scene", "wrong at", f"k = {levels[0]} to {levels[-1]}")
        for ladder in lanes:
            wrong = "" if ladder.first_wrong is None else ladder.first_told
            tens = [ladder.signs[k : k + 10] for k in range(0, len(ladder.signs), 10)]
            table.add_row(ladder.engine, ladder.lane, wrong, " ".join(tens))
        out.print(table)
    for mark in MapMark:
        say(out, f"{mark.sign}  {mark.meaning}")
    say(out, "")
    say(out, exact_sentence(rows), "bold")
    if len(rows):
        say(out, f"Any of the scenes: {place_of(rows[-1]).show} > scene.toml")
        say(out, "and then: truebreak compare scene.toml --engines ENGINE")
