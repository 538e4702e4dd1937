"""The tables of docs/statistics.md: each quantity a paragraph of what was run, and a row for each engine."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence

HEAD = "| engine | bias | standard error | runs lost | verdict |\n|---|---|---|---|---|\n"


def row(cells: Sequence[str]) -> str:
    """One line of a table.

    >>> row(["double", "+0"])
    '| double | +0 |'
    """
    return f"| {' | '.join(cells)} |"


def figure(value: float, form: str) -> str:
    """A number in a form such as `+.2g`; a dash where there is none, since every run was lost.

    >>> figure(0.0312, "+.2g"), figure(math.nan, "+.2g")
    ('+0.031', '-')
    """
    return "-" if math.isnan(value) else format(value, form)


def placed(page: str, number: int, told: str, rows: Mapping[str, str], order: Sequence[str]) -> str:
    """The page with new rows in the table of a quantity; rows that are not new stay.

    Args:
        page: all of it.
        number: of the quantity.
        told: the paragraph above the table, without the number.
        rows: the new rows, by engine.
        order: all engines of the table, in order.

    Raises:
        ValueError: if the page has no such table.

    >>> page = "**1. a**: old.\\n\\n" + HEAD + "| single | 1 |\\n| double | 2 |\\n\\nmore\\n"
    >>> page = placed(page, 1, "**a**: new.", {"double": "| double | 3 |"}, ["single", "double"])
    >>> print(page.replace(HEAD, "...\\n"), end="")
    **1. a**: new.
    <BLANKLINE>
    ...
    | single | 1 |
    | double | 3 |
    <BLANKLINE>
    more
    """
    found = re.search(rf"^\*\*{number}\. .*\n\n\|.*\n\|[-|]+\n((?:\|.*\n)*)", page, re.MULTILINE)
    if found is None:
        raise ValueError(f"no table of quantity {number}")
    old = {line.split("|")[1].strip(): line for line in found[1].splitlines()}
    lines = [{**old, **rows}[name] for name in order if name in old or name in rows]
    table = HEAD + "".join(f"{line}\n" for line in lines)
    return f"{page[: found.start()]}{told.replace('**', f'**{number}. ', 1)}\n\n{table}{page[found.end() :]}"
