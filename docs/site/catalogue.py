"""A page for each scene of the catalogue, and the gallery of all: picture, what engines make of it, its report.

`python docs/site/catalogue.py` writes the verdicts of the gallery, `docs/site/verdicts.json`; tests hold them current.
"""

from __future__ import annotations

import json
import sys
from dataclasses import dataclass
from html import escape
from itertools import pairwise
from pathlib import Path

from truebreak.compare import compare, html_report
from truebreak.compare.report.answers import tone, verdict_line
from truebreak.compare.report.page import whole_name
from truebreak.compare.report.player import played
from truebreak.compare.report.sentences import proof_phrase, verdict_sentence
from truebreak.exact import ExactEngine
from truebreak.scenarios import catalogue
from truebreak.scenarios.errors import SceneError
from truebreak.scenarios.files import dump_json, dump_toml
from truebreak.scenarios.pictures import PICTURED_CIRCLES, View, draw, scene_picture
from truebreak.scenarios.scene import Scene

ENGINES = ("double", "pymunk")

MOST_EVENTS = 60
"""Events compared for a page: enough to see what a scene is about."""

MOST_LINES = 60
"""Lines of a scene's file that its page shows."""


@dataclass(frozen=True)
class Told:
    """What the comparison of a scene came to."""

    sentence: str
    proof: str
    command: str
    verdict: str
    tone: str


def report(name: str, folder: str | None = None) -> Told:
    """Compares a scene, and writes the report to play into a folder, if there is one."""
    scene = catalogue.build(name)
    events = MOST_EVENTS if scene.events is None else min(MOST_EVENTS, scene.events)
    command = f"truebreak compare {name} --engines {','.join(ENGINES)} --events {events} --html {name}.html"
    found = compare(scene, ENGINES, events=events)
    if folder is not None:
        Path(folder, f"{name}.html").write_text(html_report(found, command=command), encoding="utf-8")
    return Told(verdict_sentence(found), proof_phrase(found), command, verdict_line(found), tone(found))


VERDICTS = Path(__file__).resolve().parent / "verdicts.json"
"""The line and the colour of each scene in the gallery."""


def verdicts() -> dict[str, list[str]]:
    """What the gallery says of each scene: the verdict, and how it is coloured."""
    return json.loads(VERDICTS.read_text("utf-8"))


ROUND = 12.0
"""Seconds in which a small picture shows its scene, before it begins anew."""

MOST_KNOTS = 1_500
"""Changes of flight in a small picture; a scene of more events is shown as far as they go."""


def moving_picture(name: str) -> str:
    """A scene with its first events, exact, as an SVG file that moves."""
    scene = catalogue.build(name)
    if len(scene.circles) > PICTURED_CIRCLES:
        return picture(name)
    events = min(MOST_EVENTS, scene.events or MOST_EVENTS, max(1, (MOST_KNOTS - len(scene.circles)) // 2))
    ran = ExactEngine().run(scene, events=events)
    shown = played(scene, ran, [], name="exact", title=name)
    if shown is None:
        return picture(name)
    motion, view = shown["runs"][0], View(*shown["view"], across=320.0, up=220.0)
    gravity, end = shown.get("gravity", [0.0, 0.0]), motion["end"]
    flights: dict[int, list[list[float]]] = {}
    pieces = BENDS if any(gravity) else 1
    for k, body, *state in motion["knots"]:
        flights.setdefault(int(body), []).append([motion["times"][int(k)], *state])
    rules, bodies = list[str](), list[str]()
    for body, circle in enumerate(scene.circles):
        rows, steps = flights[body], list[tuple[float, str]]()
        for left, ((time, x, y, vx, vy), (after, *_)) in enumerate(pairwise([*rows, [end]]), start=1 - len(rows)):
            for k in range(pieces + (not left)):  # the last flight with its end
                since = (after - time) * k / pieces
                bent = [gravity[0] * since**2 / 2, gravity[1] * since**2 / 2]
                place = f"{view.x(x + vx * since + bent[0]):.1f}px,{view.y(y + vy * since + bent[1]):.1f}px"
                steps.append((time + since, place))
        kind, radius = "fixed" if circle.fixed else "circle", max(float(circle.r) * view.scale, 2.0)
        moves = len({place for _, place in steps}) > 1
        if moves:
            frames = "".join(f"{100 * time / end:.3f}%{{transform:translate({place})}}" for time, place in steps)
            rules.append(f"@keyframes b{body}{{{frames}}}")
        style = f"transform:translate({steps[0][1]})" + (f";animation:b{body} {ROUND:g}s linear infinite" * moves)
        bodies.append(f'<g style="{style}"><circle class="{kind}" r="{radius:.2f}"/></g>')
    title = f"{name}, its first {len(ran.events)} events"
    return draw(scene, [], title, standalone=True, style="\n".join(rules), view=view, over="\n".join(bodies))


BENDS = 6
"""Straight pieces in which a flight under gravity is shown."""


def gallery(names: list[str], playable: bool = False) -> str:
    """All scenes as pictures that move, with their verdicts: a name leads to its page, a picture to the page to play
    with, where there is one."""
    known, cards = verdicts(), []
    for name in names:
        verdict, colour = known[name]
        summary = escape(catalogue.entry(name).summary)
        page = f"catalogue/{name}.html"
        opened = f"play/index.html?scene={name}" if playable else page
        cards.append(
            f'<li class="{colour}"><a href="{opened}"><picture>'
            f'<source media="(prefers-reduced-motion: reduce)" srcset="pictures/still/{name}.svg">'
            f'<img src="pictures/{name}.svg" loading="lazy" alt="{"play with " if playable else ""}{escape(name)}">'
            f"</picture></a>"
            f'<b><a href="{page}">{escape(name)}</a></b><p>{summary}</p><p class="line">{escape(verdict)}</p></li>'
        )
    return "\n".join(['<ul class="gallery">', *cards, "</ul>"])


def picture(name: str) -> str:
    """A scene at time 0, as an SVG file."""
    return scene_picture(catalogue.build(name), standalone=True)


def scene_page(name: str, told: Told | None) -> str:
    """The page of a scene as MyST.

    Args:
        told: what its comparison came to; None for a page without a report.
    """
    entry, scene = catalogue.entry(name), catalogue.build(name)
    parts = [
        f"# {name}",
        f"{entry.summary} {entry.known}",
        f"![{name} at time 0]({name}.svg)",
        f"Source: {_text(entry.source)}.",
    ]
    if entry.parameters:
        rows = [f"| `{p.name}` | `{p.default}` | {_text(p.help)} |" for p in entry.parameters]
        parts.append("\n".join(["## Parameters", "", "| name | default | what it sets |", "|---|---|---|", *rows]))
    if told is not None:
        address, title = f"../reports/{name}.html", f"{escape(name)}: report"
        parts += [
            "## What engines make of it",
            f"{_text(told.sentence)} {_text(told.proof)}",
            f"```sh\n{told.command}\n```",
            f'<p><a href="{address}">The report, to play on a page of its own</a></p>',
            f'<iframe class="report" loading="lazy" src="{address}" title="{title}"></iframe>',
        ]
    parts += ["## The scene, exactly", f"`{whole_name(scene)}`, digest `{scene.digest}`", _file(scene)]
    return "\n\n".join(parts) + "\n"


def _file(scene: Scene) -> str:
    try:
        text, kind = dump_toml(scene), "toml"
    except SceneError:
        text, kind = dump_json(scene), "json"
    lines = text.strip().splitlines()
    shown = "\n".join(lines[:MOST_LINES])
    more = (
        f"\n\nAnd {len(lines) - MOST_LINES} more lines: `truebreak export` writes them all."
        if len(lines) > MOST_LINES
        else ""
    )
    return f"```{'text' if more else kind}\n{shown}\n```{more}"


def catalogue_page(names: list[str]) -> str:
    """The list of all scenes."""
    rows = [f"| [{name}]({name}.md) | {_text(catalogue.entry(name).summary)} |" for name in names]
    tree = "\n".join(["```{toctree}", ":hidden:", "", *names, "```"])
    table = "\n".join(["| scene | what it shows |", "|---|---|", *rows])
    told = "Every picture, verdict and report on these pages was made by the build, by the command printed beside it."
    return f"# Catalogue\n\n{told}\n\n{table}\n\n{tree}\n"


def _text(text: str) -> str:
    """Plain text, with what Markdown would take for its own made harmless."""
    for mark in ("\\", "*", "_", "|", "<", "[", "`"):
        text = text.replace(mark, f"\\{mark}")
    return text


if __name__ == "__main__":
    told = {name: report(name) for name in sys.argv[1:] or catalogue.names()}
    kept = verdicts() if VERDICTS.exists() else {}
    made = kept | {name: [one.verdict, one.tone] for name, one in told.items()}
    VERDICTS.write_text(json.dumps({name: made[name] for name in catalogue.names()}, indent=1) + "\n", "utf-8")
