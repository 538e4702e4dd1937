"""The files of the page: the same for the server of `truebreak play` and for a site without one."""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cache
from importlib import resources
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

import jinja2
from markupsafe import Markup

from ...scenarios.lazy import VERSION
from ...scenarios.pictures import STYLE
from ..picture import engine_css
from ..report.page import COMPARED, breakable, embedded, in_cell, longest_word, unbroken
from .messages import ENGINES_PLAYED, MOST_EVENTS, ONE_BIT_OFF, answer

if TYPE_CHECKING:
    from ...scenarios.scene import Scene

Transport: TypeAlias = Literal["server", "worker"]
"""Who runs the engines: a server on the same computer, or a worker of the browser."""

POLICY = (
    "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; worker-src 'self'; connect-src 'self'; "
    "style-src 'self'; img-src 'self' data:; base-uri 'none'; form-action 'none'"
)
"""What the page may load: its own files, and pictures that it carries."""

OWN = (
    "play.js",
    "scene.js",
    "editor.js",
    "address.js",
    "transport.js",
    "lessons.js",
    "replay.js",
    "check.js",
    "node_here.js",
    "play.css",
)
"""Files of `page/` that are handed out as they are."""

IN_BROWSER = ("worker.js", "offline.js")
"""What it takes besides where the engines run in the browser."""

PLAYER = ("stage.js", "player.js")
"""Files of the report, which draws and plays."""

TYPES = {"js": "text/javascript", "mjs": "text/javascript", "css": "text/css", "json": "application/json"}


@dataclass(frozen=True)
class PageFile:
    """A file of the page: its content, and its kind as a server says it."""

    content: bytes
    kind: str


def page_files(transport: Transport, scene: Scene | None = None) -> dict[str, PageFile]:
    """The files by path, `/` the page itself.

    Args:
        scene: what the page shows at first; without one, a scene of its own.

    >>> sorted(page_files("server"))[:3]
    ['/', '/address.js', '/check.js']
    """
    texts = {name: _own(name) for name in (OWN if transport == "server" else OWN + IN_BROWSER)}
    texts |= {name: _report(name) for name in PLAYER}
    texts |= _checker()
    texts["shell.html"] = _shell()
    texts["report.css"] = f"{STYLE}{engine_css([*ENGINES_PLAYED, ONE_BIT_OFF])}\n{_report('page.css')}"
    texts["scenes.json"] = _catalogue()
    found = {f"/{name}": PageFile(text.encode(), _kind(name)) for name, text in texts.items()}
    start = {
        "transport": transport,
        "scene": None if scene is None else scene.data(),
        "mostEvents": MOST_EVENTS,
        "oneBitOff": ONE_BIT_OFF,
    }
    page = _templates().get_template("index.html.jinja")
    html = page.render(version=VERSION, policy=POLICY, start=embedded(start), player=COMPARED, transport=transport)
    return {"/": PageFile(html.encode(), _kind("index.html")), **found}


@cache
def _catalogue() -> str:
    """The scenes to pick from, which the page has before any engine is there."""
    told: list[dict[str, Any]] = []
    answer({"kind": "names"}, told.append)
    return json.dumps(told[0]["names"], separators=(",", ":"))


def _checker() -> dict[str, str]:
    """The checker of certificates that is written for node, with what it takes from there taken from the page."""
    folder = resources.files(f"{(__package__ or '').rpartition('.compare')[0]}.tools")
    found = {"verify.mjs": folder.joinpath("verify.mjs").read_text("utf-8").replace("'node:fs'", "'./node_here.js'")}
    for file in folder.joinpath("second").iterdir():
        if file.name.endswith(".mjs"):
            found[f"second/{file.name}"] = file.read_text("utf-8").replace("'node:crypto'", "'../node_here.js'")
    return found


def _shell() -> str:
    """A report of what was played, with places that the page fills: it has no templates."""
    made_by = {"versions": [["truebreak", VERSION]], "written": "@@DAY@@"}
    style = Markup(STYLE + engine_css([*ENGINES_PLAYED, ONE_BIT_OFF]))
    return (
        _templates()
        .get_template("shell.html.jinja")
        .render(
            title="@@TITLE@@",
            provenance=made_by,
            style=style,
            inlined=lambda name: Markup(_report(name)),
            recording=Markup("@@RECORDING@@"),
            player=COMPARED,
            footnote="Solid and blue: the exact run.",
        )
    )


@cache
def _templates() -> jinja2.Environment:
    """The page's own template, and those of the report, whose player it has."""
    package = __package__ or ""
    loaders = [jinja2.PackageLoader(package, "page"), jinja2.PackageLoader(f"{package.rpartition('.')[0]}.report")]
    made = jinja2.Environment(
        loader=jinja2.ChoiceLoader(loaders), autoescape=True, trim_blocks=True, lstrip_blocks=True
    )
    made.filters |= {"breakable": breakable, "in_cell": in_cell, "longest_word": longest_word, "unbroken": unbroken}
    return made


def _kind(name: str) -> str:
    return f"{TYPES.get(name.rpartition('.')[2], 'text/html')}; charset=utf-8"


def _own(name: str) -> str:
    return resources.files(__package__ or "").joinpath("page", name).read_text("utf-8")


def _report(name: str) -> str:
    folder = resources.files(f"{(__package__ or '').rpartition('.')[0]}.report")
    return folder.joinpath("templates", name).read_text("utf-8")
