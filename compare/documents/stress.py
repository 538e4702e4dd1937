"""A stress map as the JSON object `truebreak/stress-1`, and for people."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import groupby
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ..stress.ladder import Ladder
    from ..stress.rows.cell import StressRow

STRESS_SCHEMA = "truebreak/stress-1"


def stress_json(settings: Mapping[str, Any], rows: Sequence[StressRow], told: Sequence[Ladder]) -> dict[str, Any]:
    """The object that `truebreak stress --json` prints: what was asked, where each engine turns wrong, and every place.

    Args:
        settings: what the map is of.
        rows: its places, in order.
        told: the ladders of the rows.
    """
    from ..stress.family import MapPlace

    places = [MapPlace(row["family"], row["k"], row["side"], row["seed"]) for row in rows]
    return {
        "schema": STRESS_SCHEMA,
        "settings": dict(settings),
        "exact": exact_counts(rows),
        "ladders": [_ladder(ladder) for ladder in told],
        "places": [{**row, "show": place.show} for row, place in zip(rows, places, strict=True)],
    }


def exact_counts(rows: Sequence[StressRow]) -> dict[str, int]:
    """At how many places the exact engine bears each mark, those that it bears at any, and to how many a closed form
    agrees.

    >>> exact_counts([{"exact": {"mark": "right", "closed_form": True}}])
    {'places': 1, 'closed_form': 1, 'right': 1}
    """
    marks = [row["exact"]["mark"] for row in rows]
    counts = {mark: marks.count(mark) for mark in dict.fromkeys(marks)}
    return {"places": len(rows), "closed_form": sum(row["exact"]["closed_form"] is True for row in rows), **counts}


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


def exact_sentence(rows: Sequence[StressRow]) -> str:
    """What the witnesses say of the exact engine, with nothing left out.

    >>> exact_sentence([{"exact": {"mark": "right", "closed_form": None}}])
    'The exact engine: right at 1 of 1 places, each proved again by the independent checker.'
    """
    counts = exact_counts(rows)
    others = [f"{count} {mark}" for mark, count in counts.items() if mark not in ("places", "closed_form", "right")]
    told = f"The exact engine: right at {counts.get('right', 0)} of {counts['places']} places, each proved again by the"
    closed = f"; at {counts['closed_form']} of all a closed form agrees" if counts["closed_form"] else ""
    return f"{told} independent checker{closed}{'; ' + ', '.join(others) if others else ''}."


def print_stress(rows: Sequence[StressRow], told: Sequence[Ladder]) -> None:
    """One table a family, a row for each engine and lane, a letter for each k, in tens."""
    from ..report.output import console, grid, say
    from ..stress.family import MapPlace
    from ..stress.rows.marks import MapMark
    from ..stress.table import family

    out = console()
    for name, group in groupby(told, key=lambda ladder: ladder.family):
        lanes, one = list(group), family(name)
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
    if rows:
        last = rows[-1]
        place = MapPlace(last["family"], last["k"], last["side"], last["seed"])
        say(out, f"Any of the scenes: {place.show} > scene.toml")
        say(out, "and then: truebreak compare scene.toml --engines ENGINE")
