"""Templates made into one page each, with the style, the scripts and the data inside."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from functools import cache
from typing import Any

import jinja2
from markupsafe import Markup, escape

from ....scenarios.pictures import STYLE
from ..pictures.engine_style import engine_css


@cache
def _environment() -> jinja2.Environment:
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader(__package__ or "", ""), autoescape=True, trim_blocks=True, lstrip_blocks=True
    )
    environment.filters["longest_word"] = longest_word
    environment.filters["unbroken"] = unbroken
    environment.filters["breakable"] = breakable
    environment.filters["in_cell"] = in_cell
    return environment


def rendered(template: str, *, recording: Mapping[str, Any] | None, engines: int, **values: Any) -> str:
    """One offline page.

    Args:
        template: the name of its template, which extends `page.html.jinja`.
        recording: what the player shows; None for a page without one.
        engines: how many styles of engines the page needs.
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


LONG_WORD = re.compile(r"\S{17,}")

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
    """Letters of the longest word: a cell of short ones is never broken within a word.

    >>> longest_word("not tried"), longest_word("")
    (5, 0)
    """
    return max(map(len, text.split()), default=0)


COMPARED = {
    "title": "What happened, side by side",
    "choice": "engine",
    "note": "Solid outlines in the engine's pane are the reference's circles; the circles of the first divergence are "
    "ringed. With sound, the left ear hears the reference, the right one the engine. Events are numbered from 0 in "
    "each run; a divergence bears the number that its event has, or would have, in the reference.",
}
"""What the player says of itself where an engine is held against a reference."""
