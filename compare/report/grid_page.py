"""One page of a grid: scenes by engines, with filters, sorting, and each row's figures and report one click away."""

from __future__ import annotations

import re
import shlex
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence, Set
from pathlib import Path
from typing import TYPE_CHECKING, Any

from markupsafe import Markup

from ..files.amounts import counted
from ..grids.survival import proportion, stored, summaries
from .page import embedded, rendered

if TYPE_CHECKING:
    from ...scenarios.scene import Scene
    from ..files.amounts import counted
    from ..grids.row import Row
from ..grids.survival import Summary

MOST_ROWS = 20_000
"""Rows that a page holds; of more, the first, and the figures are of all."""

SHOWN = (
    "parameters", "mark", "verdict", "agreed", "events", "event", "at", "body", "expected", "got", "kind", "cause",
    "changed", "until", "drift", "laws", "predicted_low", "predicted", "predicted_high", "closed_form", "right",
    "ended", "note",
)  # fmt: skip
"""What a page has of a row."""

WORDS = {"agree": "agrees", "unsettled": "not settled", "refused": "cannot"}
"""Of verdicts and marks, where they are not their own."""


def grid_page(
    title: str,
    rows: Iterable[Row],
    *,
    commands: Mapping[str, str] | None = None,
    links: Mapping[tuple[str, str], str] | None = None,
    changes: Mapping[tuple[str, str], str] | None = None,
    pictures: Sequence[str] = (),
) -> str:
    """The page as HTML that needs nothing else.

    Args:
        title: what was run.
        rows: of the grid.
        commands: by scene what prints it as a file, where its name is not one that `truebreak compare` takes.
        links: by scene and engine the report of that row, beside the page; of others the page has the command.
        changes: by scene and engine what changed since an earlier report; None: none was given.
        pictures: SVG of figures.
    """
    store = stored(rows)
    listed = [_object(row, commands or {}, links or {}, changes or {}) for row in store[:MOST_ROWS]]
    names = list(dict.fromkeys(row["engine"] for row in listed))
    kinds = dict.fromkeys(row.get("mark") or row["verdict"] for row in listed)
    states = [(kind, WORDS.get(kind, kind)) for kind in kinds]
    return rendered(
        "grid.html.jinja",
        recording=None,
        engines=(),
        title=title,
        lead=lead(store),
        linked=bool(links),
        summaries=[_figures(summary) for summary in summaries(store)],
        pictures=[Markup(picture) for picture in pictures],
        cut=f"The first {MOST_ROWS:,} of {len(store):,} rows; the figures are of all."
        if len(store) > MOST_ROWS
        else "",
        states=states if changes is None else [*states, ("changed", "changed since")],
        names=names,
        changed=changes is not None,
        since="" if changes is None else since_words(changes, {row.pair for row in store}),
        data=embedded(
            {"rows": listed, "engines": names, "words": WORDS, "labels": LABELS, "changed": changes is not None}
        ),
    )


def since_words(changes: Mapping[tuple[str, str], str], there: Set[tuple[str, str]]) -> str:
    """Of how many rows something changed, and how many of before are not among the rows that there are.

    >>> since_words({("lee", "double"): "...", ("gas", "quad"): "..."}, {("lee", "double"), ("lee", "quad")})
    'Since the earlier grid 1 of 2 rows changed; 1 row of it is not here.'
    >>> since_words({}, {("lee", "double")})
    'Since the earlier grid nothing changed.'
    """
    changed = len(changes.keys() & there)
    gone = len(changes) - changed
    told = f"{changed:,} of {counted(len(there), 'row')} changed" if changed else "nothing changed"
    left = f"; {counted(gone, 'row')} of it {'is' if gone == 1 else 'are'} not here" if gone else ""
    return f"Since the earlier grid {told}{left}."


def lead(rows: Sequence[Row]) -> str:
    """How many scenes and engines, and what their rows came to.

    >>> from truebreak.compare.grids.row import Row
    >>> lead([Row(0, "lee", "double", "agree"), Row(1, "gas", "double", "diverged")])
    '2 scenes, 1 engine: 1 of 2 rows agrees, 1 diverged.'
    """
    counts = Counter(row.mark or row.verdict for row in rows)
    good = next((mark for mark in ("agree", "right") if mark in counts), "agree")
    verb = {"agree": ("agree", "agrees"), "right": ("are right", "is right")}[good][counts[good] == 1]
    others = "".join(f", {n:,} {WORDS.get(kind, kind)}" for kind, n in counts.items() if kind != good)
    things = counted(len({row.scene for row in rows}), "scene"), counted(len({row.engine for row in rows}), "engine")
    return f"{', '.join(things)}: {counts[good]:,} of {counted(len(rows), 'row')} {verb}{others}."


LABELS = {
    "at": "at time", "body": "circle", "expected": "should meet", "got": "meets", "kind": "kind of divergence",
    "events": "events of the exact run", "agreed": "events agreed", "event": "differs at event",
    "changed": "outcomes changed",
    "until": "outcomes known up to time", "drift": "energy gained", "laws": "laws", "finding": "finding",
    "predicted": "predicted to diverge at event", "predicted_low": "predicted not before event",
    "predicted_high": "predicted not after event", "closed_form": "as the closed form says", "mark": "result",
    "since": "changed since",
}  # fmt: skip
"""Of the figures of a row, in words."""


def _object(
    row: Row,
    commands: Mapping[str, str],
    links: Mapping[tuple[str, str], str],
    changes: Mapping[tuple[str, str], str],
) -> dict[str, Any]:
    found: dict[str, Any] = {"scene": row.scene, "engine": row.engine}
    found |= {key: value for key, value in row.data(SHOWN).items() if value is not None}
    if row.pair in changes:
        found["since"] = changes[row.pair]
    if row.pair in links:
        found["link"] = links[row.pair]
    elif row.engine != "exact" and not row.engine.startswith("perturbed:"):
        first = f"{commands[row.scene]} > scene.toml; " if row.scene in commands else ""
        words = ["truebreak", "compare", "scene.toml" if first else row.scene, "--engines", row.engine]
        found["command"] = f"{first}{shlex.join([*words, '--html', 'report.html'])}"
    return found


def _figures(summary: Summary) -> tuple[str, ...]:
    """One engine over all scenes: N, the share that agrees, and the median divergence, each with its interval."""
    total, agree = sum(summary.verdicts.values()), summary.verdicts.get("agree", 0)
    low, high = proportion(agree, total)
    kept, broken, _ = summary.laws
    return (
        summary.engine,
        f"{total:,}",
        f"{agree:,}: {agree / total:.1%} ({low:.1%} to {high:.1%})",
        median_shown(summary),
        f"{broken:,} of {kept + broken:,}" if kept + broken else "",
    )


def median_shown(summary: Summary) -> str:
    """The median divergence event, and its 95 % interval: where the survival curve's own interval crosses a half."""
    if summary.median is None:
        return "not reached"
    low = next(step.event for step in summary.survival if step.low <= 0.5)
    high = next((f" to {step.event:,}" for step in summary.survival if step.high <= 0.5), " or later")
    return f"{summary.median:,} ({low:,}{high})"


def write_reports(
    rows: Iterable[Row],
    page: str,
    limits: Mapping[int, tuple[Any, int | None]],
    scene: Callable[[Row], Scene] | None = None,
) -> dict[tuple[str, str], str]:
    """Writes the report of each row that does not agree into a folder beside a page, and gives the links.

    Args:
        page: the page's file; the folder has its name and `-reports`.
        limits: by the row's index `until` and `events` of its certified run; of others the scene's own hold.
        scene: the scene of a row, where its name is not one that `truebreak compare` takes.

    Raises:
        SceneError: if a file cannot be written.
    """
    from ..comparison import compare
    from ..scene_argument import scene_from
    from ..writing import write_whole
    from .html import html_report

    folder = Path(page).with_name(f"{Path(page).stem}-reports")
    found: dict[tuple[str, str], str] = {}
    for row in rows:
        if row.engine == "exact" or row.verdict not in ("diverged", "unsettled", "undecided") or not row.events:
            continue
        until, events = limits.get(row.index, (None, None))
        told = compare(
            scene(row) if scene is not None else scene_from(row.scene), [row.engine], until=until, events=events
        )
        folder.mkdir(exist_ok=True)
        name = f"{row.index}-{re.sub(r'[^A-Za-z0-9]+', '-', row.engine).strip('-')}.html"
        write_whole(folder / name, html_report(told))
        found[row.pair] = f"{folder.name}/{name}"
    return found
