"""What every HTML page has: templates, style, scripts and data inside, and where the report comes from."""

from __future__ import annotations

import base64
import csv
import gzip
import io
import json
import os
import platform
import re
import shlex
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from functools import cache
from importlib import metadata
from typing import TYPE_CHECKING, Any

import jinja2
from markupsafe import Markup, escape

from ...scenarios.errors import SceneError
from ...scenarios.files import dump_json, dump_toml
from ...scenarios.pictures import STYLE
from ..engines import ENGINES
from ..picture import engine_css
from .answers import limits_of, stem_of
from .documents import comparison_json
from .listing import laid_out

if TYPE_CHECKING:
    from ...scenarios.scene import Scene
    from ..candidate import Candidate
    from ..comparison import Comparison


@cache
def _environment() -> jinja2.Environment:
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader(__package__ or "", "templates"),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["longest_word"] = longest_word
    environment.filters["unbroken"] = unbroken
    environment.filters["breakable"] = breakable
    environment.filters["in_cell"] = in_cell
    return environment


def rendered(template: str, *, recording: Mapping[str, Any] | None, engines: Sequence[str], **values: Any) -> str:
    """One offline page.

    Args:
        template: the name of its template, which extends `page.html.jinja`.
        recording: what the player shows; None for a page without one.
        engines: those whose styles the page needs, by their texts.
        values: what the template tells.
    """
    environment = _environment()
    loader = environment.loader
    assert loader is not None

    def inlined(name: str) -> Markup:
        return Markup(loader.get_source(environment, name)[0])

    return environment.get_template(template).render(
        **values,
        recording=None if recording is None else embedded(recording),
        inlined=inlined,
        style=Markup(STYLE + engine_css(engines)),
    )


def embedded(data: Mapping[str, Any]) -> Markup:
    """Data as JSON that no text in it can end the script with.

    >>> print(embedded({"name": "</script>"}))
    {"name":"\\u003c/script>"}
    """
    text = json.dumps(data, allow_nan=False, separators=(",", ":"))
    return Markup(text.replace("<", "\\u003c"))


NUMBER = re.compile(r"[-−]?\d[\d.]*e[-+]?\d+")
"""A number with an exponent, whose minus would let a line end."""

VECTOR = re.compile(r"\([-\d.e+]+, [-\d.e+]+\)")


LONG_WORD = re.compile(r"\S{11,}")

JOINT = re.compile(r"(?<=[:=,_])(?=.)")
"""Where a long name of an engine may go on in the next line."""


def breakable(text: str) -> str:
    """A text whose long words may be parted where their parts join, with no sign.

    >>> breakable("pymunk:max_steps=100000 agrees").split("\u200b")
    ['pymunk:', 'max_', 'steps=', '100000 agrees']
    """
    return LONG_WORD.sub(lambda word: JOINT.sub("\u200b", word[0]), text)


def unbroken(text: str) -> Markup:
    """A text of which no line ends within `t = 12`, `1e-40` or `(0, 1)`.

    >>> print(unbroken("<a> is off by 1e-40"))
    &lt;a&gt; is off by <span class="whole">1e-40</span>
    >>> print(unbroken("v = (0, 1)"))
    v = <span class="vector">(0, 1)</span>
    >>> unbroken("event 3, t = 12") == "event 3, t\u00a0=\u00a012"
    True
    """
    told = str(escape(text.replace("t = ", "t\u00a0=\u00a0")))
    told = VECTOR.sub(lambda vector: f'<span class="vector">{vector[0]}</span>', told)
    return Markup(NUMBER.sub(lambda number: f'<span class="whole">{number[0]}</span>', told))


def in_cell(text: str) -> Markup:
    """`unbroken`, for a narrow column: a long name of an engine ends a line where its parts join.

    >>> print(in_cell("pymunk:iterations=64"))
    pymunk:<wbr>iterations=<wbr>64
    """
    return unbroken(breakable(text)).replace("\u200b", Markup("<wbr>"))


def longest_word(text: str) -> int:
    """Letters of the longest part in which no line ends: a cell of short ones is never broken elsewhere.

    >>> longest_word("not tried"), longest_word(""), longest_word("pymunk:dt=1/2048")
    (5, 0, 7)
    """
    return max(map(len, breakable(text).replace("\u200b", " ").split()), default=0)


COMPARED = {
    "title": "What happened, side by side",
    "choice": "engine",
    "note": "Both runs on one clock; outlines in the engine's pane are the reference's circles, tied to the engine's "
    "by a line where they are apart. The circles of the first divergence are ringed; past it the engine is in another "
    "history.",
}
"""What the player says of itself where an engine is compared with a reference."""


# ----------------------------------------
# Where a report comes from: versions, settings, the command that makes it again, and its data as files.

LIBRARIES = ("python-flint", "sympy", "mpmath", "numpy", "pymunk")
"""Distributions whose version can decide what a report says."""

MOST_BYTES = 300_000
"""Largest file that a page carries as it is; a longer one is carried compressed, if that makes it short enough. So a
page of all of them stays well under 1 MB."""


@dataclass(frozen=True)
class Download:
    """A file that the page carries with it.

    Attributes:
        name: what the browser saves it as.
        label: what it holds, in words.
        address: its contents as a `data:` address; empty if it is too large to be carried.
        remedy: how to get it otherwise.
    """

    name: str
    label: str
    address: str
    remedy: str = ""


@dataclass(frozen=True)
class Provenance:
    """What it takes to make a report again.

    Attributes:
        written: the day, in UTC.
        versions: of truebreak, Python, the machine and the libraries that counted.
        scene: the scene by name, with all of its parameters.
        command: the command line.
        engines: each engine as asked for, and every setting that it ran with.
        files: what can be saved from the page.
        digest: of all that decides the history.
    """

    written: str
    versions: tuple[tuple[str, str], ...]
    scene: str
    command: str
    engines: tuple[tuple[str, str], ...]
    files: tuple[Download, ...]
    digest: str


def provenance(comparison: Comparison, command: str = "") -> Provenance:
    """The provenance of a comparison.

    Args:
        command: the command line that it came from; without one, a command that makes it from the scene's file.
    """
    runs = [(comparison.reference.engine, comparison.reference.parameters)]
    runs += [(c.engine, c.trajectory.parameters) for c in comparison.candidates]
    return provenance_of(comparison.scene, runs, command or _command(comparison), downloads(comparison))


def provenance_of(
    scene: Scene, runs: Iterable[tuple[str, Mapping[str, Any]]], command: str, files: Iterable[Download]
) -> Provenance:
    """The provenance of what a scene, engines with their settings, and a command led to."""
    engines = tuple((name, settings_phrase(settings)) for name, settings in runs)
    return Provenance(day(), versions(), whole_name(scene), command, engines, tuple(files), scene.digest)


def day() -> str:
    """Today in UTC, or the day that SOURCE_DATE_EPOCH sets, so that a page can be made again letter for letter."""
    epoch = os.environ.get("SOURCE_DATE_EPOCH", "")
    moment = datetime.fromtimestamp(int(epoch), UTC) if epoch.isdecimal() else datetime.now(UTC)
    return moment.strftime("%Y-%m-%d")


def versions() -> tuple[tuple[str, str], ...]:
    """Names and versions of what computed."""
    import flint
    import pymunk

    rows = [("truebreak", metadata.version("truebreak")), ("Python", platform.python_version())]
    rows += [(name, metadata.version(name)) for name in LIBRARIES]
    rows.append(("FLINT", flint.__FLINT_VERSION__))
    rows.append(("Chipmunk", pymunk.chipmunk_version.partition("-")[0]))
    rows.append(("machine", f"{platform.system()} {platform.machine()}"))
    return tuple(rows)


def whole_name(scene: Scene) -> str:
    """A catalogue scene's name with every parameter, seed and defaults too; of another scene, its name.

    >>> from truebreak.scenarios import catalogue
    >>> whole_name(catalogue.build("near-tie:k=7"))
    'near-tie:k=7,first=left'
    >>> whole_name(catalogue.build("galperin"))
    'galperin:n=2'
    """
    from ...scenarios import catalogue

    name, _, given = scene.name.partition(":")
    if name not in catalogue.names():
        return scene.name
    try:
        if catalogue.build(scene.name).digest != scene.digest:
            return scene.name
    except SceneError:
        return scene.name
    chosen = dict(part.split("=", 1) for part in given.split(",") if part)
    every = [f"{p.name}={chosen.get(p.name, p.default)}" for p in catalogue.entry(name).parameters]
    return f"{name}:{','.join(every)}" if every else name


def settings_phrase(settings: Mapping[str, Any]) -> str:
    """Settings in words.

    >>> settings_phrase({"dt": 0.5, "iterations": 3}), settings_phrase({})
    ('dt = 0.5, iterations = 3', 'none')
    """
    return ", ".join(f"{key} = {value}" for key, value in settings.items()) or "none"


def _command(comparison: Comparison) -> str:
    """A command that runs the scene, saved from the page, to where this run ended."""
    words = ["truebreak", "compare", file_name(comparison.scene)]
    words += ["--engines", ",".join(c.engine for c in comparison.candidates)]
    words += ["--reference", comparison.reference.engine, *limits_of(comparison.reference)]
    return shlex.join(words)


def minimise_command(comparison: Comparison, candidate: Candidate) -> str | None:
    """A command that looks for the smallest scene on which the engine diverges, from the scene saved from the page.

    None for an engine that is not in the table of engines, and where the exact engine is not the reference: the
    command would be another question.
    """
    if candidate.engine.partition(":")[0] not in ENGINES or comparison.reference.engine != "exact":
        return None
    words = ["truebreak", "minimise", file_name(comparison.scene), "--engine", candidate.engine]
    return shlex.join([*words, *limits_of(comparison.reference)])


def scene_file(scene: Scene) -> Download | None:
    """The scene as a file: in TOML where that is possible, else in JSON; None where it can be written in neither."""
    for kind, write in (("toml", dump_toml), ("json", dump_json)):
        try:
            text = write(scene)
        except SceneError:
            continue
        again = f"truebreak show {shlex.quote(scene.name)} --json"
        name, label = f"{stem_of(scene)}.{kind}", f"the scene ({kind.upper()})"
        return download(name, label, f"application/{kind}", text, again)
    return None


def file_name(scene: Scene) -> str:
    """What the page's file of the scene is saved as.

    >>> from truebreak.scenarios import catalogue
    >>> file_name(catalogue.build("lee"))
    'lee.toml'
    """
    file = scene_file(scene)
    return f"{stem_of(scene)}.toml" if file is None else file.name


def downloads(comparison: Comparison) -> Iterator[Download]:
    """The scene, the results and the events as files in the page."""
    file, stem = scene_file(comparison.scene), stem_of(comparison.scene)
    if file is not None:
        yield file
    told = comparison_json(comparison)
    for part in (told["reference"], *told["candidates"]):
        del part["seconds"]  # the machine's: with them, no page could be made again letter for letter
    yield download(
        f"{stem}-comparison.json",
        "all results (JSON)",
        "application/json",
        laid_out(told) + "\n",
        "the command above, with --json",
    )
    yield download(
        f"{stem}-events.csv",
        "every event of every engine (CSV)",
        "text/csv",
        events_csv(comparison),
        "truebreak run SCENE --engine E --json",
    )
    if comparison.certificate is not None:
        yield download(
            f"{stem}-certificate.json",
            "the certificate of the reference's run, which `truebreak verify FILE` checks",
            "application/json",
            comparison.certificate.text,
            "truebreak run SCENE --certificate FILE",
        )


def download(name: str, label: str, kind: str, text: str, remedy: str) -> Download:
    """A text as a file in the page, compressed if it is long; if it is too long for a page, how to get it otherwise."""
    data, kind = text.encode(), f"{kind};charset=utf-8"
    if len(data) > MOST_BYTES:
        packed = gzip.compress(data, mtime=0)
        if len(packed) > MOST_BYTES:
            return Download(name, label, "", f"{len(data):,} bytes, too many for a page: {remedy}")
        name, label, data, kind = f"{name}.gz", f"{label}, compressed", packed, "application/gzip"
    return Download(name, label, f"data:{kind};base64,{base64.b64encode(data).decode()}")


def events_csv(comparison: Comparison) -> str:
    """One line an impulse: engine, event, time as the nearest double, and the pair."""
    text = io.StringIO()
    table: Any = csv.writer(text, lineterminator="\n")
    table.writerow(("engine", "event", "time", "first", "second"))
    runs = [(comparison.reference.engine, comparison.reference)]
    runs += [(c.engine, c.trajectory) for c in comparison.candidates]
    for name, run in runs:
        for event in run.events:
            table.writerows((name, event.index, repr(float(event.time)), *pair) for pair in event.impulses)
    return text.getvalue()
