"""The survey as a page of the docs."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..grids.engine_survey import BUDGET, MOST_STEPS, PERTURBED, SCENES
from ..scene_argument import scene_from
from .grid_tables import advice_sentence, columns

if TYPE_CHECKING:
    from ..grids.engine_survey import Survey, Surveyed, SurveyEntry
    from ..grids.row import Row


INTRODUCTION = """# Survey of engines

Which engine reproduces the certified history of which scene? {engines} engines on {scenes} scenes, each compared
with the certified run. This page is made by two commands:

```sh
truebreak survey --store rows.db --json > survey.json
truebreak survey --from survey.json --page survey.md
```

The first may be ended and called again, or called for one engine after the other (`--engines`): it goes on from the
rows in its store. Every row is bounded by counted work, not by seconds: an engine of time steps ends its run after
`max_steps`, and a series of finer steps, which shows causes, goes no farther than some steps, the fewer the more one
costs. What that leaves open says so in its row: a cause is *not determined* where the series would take more.

It is a table of what suits what, not a ranking. Most of these engines were not made for perfectly elastic,
frictionless, hard discs: a game wants no drift, no sinking and 60 frames a second; a robot wants forces that can be
differentiated. What each is made for stands beside it.

How each was brought to restitution 1 without friction, sleep or a cap of speeds, and what it cannot do, is in
[Other people's engines](other-engines.md). Every engine is run as it comes (with the defaults of its adapter), and,
where it diverges, at finer settings too, as far as {steps:,} time steps. The tables have the setting that agreed the
farthest, of several the first tried, and below it how it comes, where that is another.

**Advised** is what [`truebreak advise`](advice.md) names, with `--perturbed {perturbed} --budget {budget}`: the
cheapest of a ladder of settings that reproduces the whole history of the scene and of {perturbed} beside it, so that
it is not right by luck, as one that is tried on the scene alone may be. Where it names none, there may be one for a
greater budget.

**Authors of an engine**: better settings are one line (`SURVEYED` in `compare/grids/engine_survey.py`), a better
adapter is one file (`compare/adapters/`). Send them, and the page is made again.

| column | what it says |
|---|---|
| engine | with the settings used; without, as it comes |
| agreed | events of the certified run before the first that differs |
| differs at | whom a disc meets instead, at that event |
| cause | why, by experiment: see [Comparison](comparison.md) |
| outcome | whether counts of collisions, who met whom, final velocities and such are right, over what was compared |
| energy | what it gained by the end of its run, as a share |
| law | whether every step keeps the laws, and what explains it if not; given where any row was audited |
| time | processor time of its run alone, as a multiple of the certified run's just before it in the same process |

Times are ratios, and a hint, since other programs ran on the machine that made this page. Each engine has played a
scene of two discs before, so that loading and compiling it do not count. Where there is no time, none was measured.
"""

OWN = "truebreak's own"


def page_text(found: Survey) -> str:
    """The page in Markdown."""
    labels = list(dict.fromkeys(entry.label for entry in found.entries))
    text = INTRODUCTION.format(
        engines=len(found.engines), scenes=len(labels), steps=MOST_STEPS, perturbed=PERTURBED, budget=BUDGET
    )
    if found.max_seconds is not None:
        text += (
            f"\nEach run had {found.max_seconds:g} seconds, and so had the search for its causes; what was cut short "
            "by that says so.\n"
        )
    if any(row.cause is None and row.verdict == "diverged" for entry in found.entries for row in entry.shown):
        text += "\nWhere a cause was not looked for, the row was made with `--no-causes`.\n"
    text += "\n## The engines\n\n| engine | version | made for |\n|---|---|---|\n"
    text += "".join(_engine_row(one, found.versions.get(one.name, "version unknown")) for one in found.engines)
    if found.missing:
        text += f"\nNot installed where this page was made: {', '.join(found.missing)}.\n"
    text += "\n## In short\n\n" + _matrix(found, labels)
    for label in labels:
        text += _scene_part(label, [entry for entry in found.entries if entry.label == label])
    return text


def _engine_row(one: Surveyed, version: str) -> str:
    name = f"[{one.name}]({one.home})" if one.home else one.name
    return f"| {name} | {version or OWN} | {one.made_for} |\n"


def _matrix(found: Survey, labels: list[str]) -> str:
    """Events agreed of each engine on each scene, at its best setting."""
    by_key = {(entry.label, entry.name): entry.best for entry in found.entries}
    rows = [
        "Events agreed, at the best of the settings tried; **bold**: the whole history, and no law known to be broken.",
        "",
    ]
    rows.append(f"| scene | events | {' | '.join(one.name for one in found.engines)} |")
    rows.append(f"|---|---|{'---|' * len(found.engines)}")
    for label in labels:
        best = [by_key.get((label, one.name)) for one in found.engines]
        most = max(row.events or 0 for row in best if row is not None)
        rows.append(f"| {label} | {most} | {' | '.join(map(_agreed, best))} |")
    return "\n".join(rows) + "\n"


def _agreed(row: Row | None) -> str:
    if row is None:
        return "not run"
    if row.verdict == "refused":
        return "cannot"
    return f"**{row.agreed or 0}**" if row.agrees else f"{row.agreed or 0}"


def _scene_part(label: str, entries: list[SurveyEntry]) -> str:
    task = SCENES[label]
    limit = f", {task.events} events" if task.events is not None else ""
    heading = f"\n## {label[0].upper()}{label[1:]}\n\n{scene_from(task.scene).description}\n(`{task.scene}`{limit})\n\n"
    audited = any(row.laws is not None for entry in entries for row in entry.shown)
    heads = ["engine", "verdict", "agreed", "differs at", "cause", "outcome", "energy", *["law"] * audited, "time"]
    table = f"| {' | '.join(heads)} |\n|{'---|' * len(heads)}\n"
    for entry in entries:
        for row in entry.shown:
            mark = ", advised" if row.right else ""
            times = "" if row.times is None else f"{row.times:.2g}" if row.times < 100 else f"{row.times:,.0f}"
            told = [f"`{row.engine}`{mark}", *columns(row)[: len(heads) - 2], times]
            table += f"| {' | '.join(part.replace('|', '/') for part in told)} |\n"
    return heading + table + "".join(f"\n{told}\n" for told in advice_sentence(entries))
