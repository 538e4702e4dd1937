"""Two or more logs compared, as one HTML file: the runs in the player, growth by body, the first difference."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

from markupsafe import Markup

from ..logdiff.desync import Desync, gravest, report_json
from ..logdiff.log_format import LogRecord
from ..logdiff.sides import Side
from .curves import Curve as Line
from .curves import plot
from .listing import laid_out
from .page import day, download, rendered, versions

MOST_STATES = 30_000
"""States that a page carries of each run: some 60 bytes each."""

MOST_RECORDS = 1_500
"""Records that a page plays, most of them before the first difference."""

BEFORE = 0.6
"""Share of them that lies before the first difference."""

DOT = 0.01
"""Radius, as a share of the view, of a body whose shape is not logged."""

PLAYER = {
    "title": "Both runs, side by side",
    "choice": "log",
    "note": "Solid outlines in the right pane are the first log's bodies; those that differ first are ringed. Bodies "
    "are drawn where the logs have them, and between two records on the straight way from the one to the next.",
}


FLAT = " Of three dimensions x is drawn across and y up."


def desync_html(compared: Sequence[Desync], *, command: str = "") -> str:
    """The page; the player shows the pair whose verdict is the gravest, if its logs have states."""
    worst = gravest(compared)
    sections = [
        {
            "title": f"{one.found.a.name} and {one.found.b.name}",
            "line": one.line,
            "facts": list(one.facts()),
            "notes": [*one.verdict.notes, *(one.lawful.lines() if one.lawful else ())],
            "plot": growth_plot(one),
            "bodies": [
                (row["body"], row["told"]) for row in one.bodies()
            ],
            "numbers": one.numbers(),
            "around": [(*row, row[2] != row[3]) for row in one.around()],
        }
        for one in compared
    ]  # fmt: skip
    text = laid_out(report_json(compared)) + "\n"
    page = rendered(
        "desync.html.jinja",
        recording=played_logs(worst),
        engines=["log"] * max(1, len(worst.found.growing.by_body)),
        title=f"{worst.verdict.line}: truebreak diff",
        lead=worst.line,
        same=worst.verdict.same,
        sections=sections,
        player={**PLAYER, "note": PLAYER["note"] + (FLAT if "z" in (worst.found.growing.names or ()) else "")},
        command=command or "truebreak diff",
        file=download("diff.json", "all results (JSON)", "application/json", text, "the command above, with --json"),
        provenance={"versions": versions(), "written": day()},
        footnote="Solid and blue: the first log.",
    )
    return page.encode("utf-8", "backslashreplace").decode("utf-8")  # ids may have halves of letters in them


def growth_plot(one: Desync) -> Markup | None:
    """The growth by body: bits above one ulp over the records."""
    curves = [
        Line(body, [(float(n), max(bits, 0.0)) for n, _, bits in curve.points], f"e{k}")
        for k, (body, curve) in enumerate(one.curves()[:8])
        if len(curve.points) > 1
    ]
    if not curves:
        return None
    return Markup(plot("How the difference grew, by body", "record", "bits above one ulp", curves))


def played_logs(one: Desync) -> dict[str, Any] | None:
    """Both runs as data for the player, around the first difference; None where they have no states by time."""
    found, verdict = one.found, one.verdict
    first = verdict.first[0].number if verdict.first else 0
    sides = [_window(side, first) for side in found.again()]
    own = [{body for record in records for body in record.states} for records in sides]
    ids = sorted(own[0] & own[1])
    if not ids or any(len(records) < 2 for records in sides):
        return None
    axes = _axes(found.growing.names)
    runs = [_run(records, ids, axes) for records in sides]
    if any(run is None for run in runs):
        return None
    knots = [knot for run in runs if run is not None for knot in run["knots"]]
    xs, ys = ([knot[k] for knot in knots if math.isfinite(knot[k])] for k in (2, 3))
    if not xs or not ys:
        return None
    wide, high = max(max(xs) - min(xs), 1e-9), max(max(ys) - min(ys), 1e-9)
    room = 0.06 * max(wide, high)
    view = [min(xs) - room, min(ys) - room, max(wide, 0.2 * high) + 2 * room, max(high, 0.2 * wide) + 2 * room]
    if not all(
        math.isfinite(value) for value in (*view, *(t for run in runs if run is not None for t in run["times"]))
    ):
        return None
    outlines = {**found.b.outlines, **found.a.outlines}
    shapes = [outlines.get(body) for body in ids]
    dot = DOT * max(view[2], view[3])
    told = None
    if verdict.first:
        record = verdict.first[0]
        told = {
            "time": record.time if record.time is not None else float(record.number),
            "expected": record.number, "got": record.number,
            "bodies": [ids.index(d.body) for d in verdict.first[:6] if d.body in ids], "walls": [],
        }  # fmt: skip
    begin = min(run["times"][0] for run in runs if run is not None)
    end = max(run["end"] for run in runs if run is not None)
    heads = ({"name": found.a.name, "title": found.a.name, "number": None},
             {"name": found.b.name, "title": found.b.name, "number": 0, "divergence": told,
              "verdict": verdict.name.name.lower()})  # fmt: skip
    return {
        "bodies": [[body, _reach(shape, dot), False] for body, shape in zip(ids, shapes, strict=True)],
        "outlines": shapes,
        "walls": [], "pockets": [], "view": view, "begin": begin, "end": end,
        "total": max(found.a.count, found.b.count), "lead": 1,
        "runs": [{**(run or {}), **head} for run, head in zip(runs, heads, strict=True)],
    }  # fmt: skip


def _window(side: Side, first: int) -> list[LogRecord]:
    """Records of a log around the first difference."""
    found: list[LogRecord] = []
    states = 0
    least = max(0, first - int(BEFORE * MOST_RECORDS))
    while (record := side.next()) is not None:
        if record.number < least:
            continue
        states += len(record.states)
        found.append(record)
        if states > MOST_STATES and record.number > first + 20:
            break
        while states > MOST_STATES:
            states -= len(found.pop(0).states)
        if len(found) >= MOST_RECORDS:
            break
    return found


def _axes(names: list[str] | None) -> tuple[int, int, int | None]:
    """Which numbers of a state are drawn across and up, and which is an angle."""
    if names is None:
        return 0, 1, None
    place = {name.lower(): k for k, name in enumerate(names)}
    return place.get("x", 0), place.get("y", min(1, len(names) - 1)), place.get("angle")


def _run(records: list[LogRecord], ids: list[str], axes: tuple[int, int, int | None]) -> dict[str, Any] | None:
    """One run, as the player has it: knots from record to record."""
    times = [record.clock if record.clock is not None else float(record.number) for record in records]
    if any(later < earlier for earlier, later in pairwise(times)):
        return None
    x, y, turn = axes
    by_body: dict[str, list[tuple[int, list[float]]]] = {body: [] for body in ids}
    for k, record in enumerate(records):
        for body, row in record.states.items():
            if body in by_body and len(row) > max(x, y) and math.isfinite(row[x]) and math.isfinite(row[y]):
                by_body[body].append((k, row))
    knots: list[list[float]] = []
    for place, body in enumerate(ids):
        rows = by_body[body]
        if not rows:
            return None
        for (k, row), following in zip(rows, [*rows[1:], None], strict=True):
            span = 0.0 if following is None else times[following[0]] - times[k]
            to = row if following is None else following[1]
            rates = [(to[j] - row[j]) / span if span > 0 else 0.0 for j in (x, y)]
            knot = [k, place, row[x], row[y], *rates]
            if turn is not None:
                knot += [row[turn], (to[turn] - row[turn]) / span if span > 0 else 0.0]
            knots.append([value if math.isfinite(value) else 0.0 for value in knot])
    knots.sort(key=lambda knot: knot[0])
    events = [
        [r.number, t, [list(p) for p in r.contacts[:6]]] for r, t in zip(records, times, strict=True) if r.contacts
    ]
    return {"times": times, "knots": knots, "events": events, "end": times[-1], "stop": "the log ends here"}


def _reach(shape: Any, dot: float) -> float:
    """How far a shape reaches from its body's place."""
    reach = 0.0
    for part in shape if isinstance(shape, list) else [shape]:
        if not isinstance(part, dict):
            continue
        if isinstance(part.get("circle"), int | float):
            reach = max(reach, math.hypot(*part.get("at", (0, 0))) + part["circle"])
        for x, y in part.get("polygon") or part.get("segment") or ():
            reach = max(reach, math.hypot(x, y))
    return reach or dot
