"""Tables in HTML, each with a picture: what a notebook shows of a scene, a run, a comparison."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from html import escape
from itertools import islice

from .picture import PICTURED_CIRCLES, image
from .view import Pictured

MOST_ROWS = 20
"""Rows that a notebook shows; how many more there are is said."""


def shown(table: str, scene: Pictured, picture: Callable[[], str], title: str) -> str:
    """A table with a picture below it; of a scene of too many circles the table alone."""
    drawn = image(picture(), title) if 0 < len(scene.circles) <= PICTURED_CIRCLES else ""
    return f"<div>{table}{drawn}</div>"


def html_table(caption: str, headings: Sequence[str], rows: Iterable[Sequence[object]], count: int) -> str:
    """A table of at most `MOST_ROWS` of `count` rows, every text escaped.

    >>> html_table("a < b", ["id"], [["<x>"]], 1)[:48]
    '<table><caption>a &lt; b</caption><thead><tr><th'
    """
    head = "".join(f"<th>{escape(heading)}</th>" for heading in headings)
    body = "".join(
        f"<tr>{''.join(f'<td>{escape(str(cell))}</td>' for cell in row)}</tr>" for row in islice(rows, MOST_ROWS)
    )
    if count > MOST_ROWS:
        body += f'<tr><td colspan="{len(headings)}">and {count - MOST_ROWS:,} more</td></tr>'
    return f"<table><caption>{escape(caption)}</caption><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"
