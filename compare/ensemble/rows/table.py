"""The rows of a sweep as a table: CSV, and for people."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterable, Sequence
from typing import Any

from ...files.amounts import no_formula
from .row import COLUMNS, SweepRow


def csv_text(rows: Iterable[SweepRow], keys: Sequence[str]) -> str:
    """The rows as CSV, each varied parameter in a column of its own; equal rows give equal bytes.

    >>> row = dict.fromkeys(COLUMNS) | {"index": 3, "parameters": {"n": "5"}, "changed": ["collisions"]}
    >>> csv_text([row], ["n"]).splitlines()[1].split(",")[:4]
    ['3', '', '', '5']
    """
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    heads: list[str] = []
    for column in COLUMNS:
        heads += [*keys] if column == "parameters" else [column]
    writer.writerow(heads)
    for row in rows:
        cells: list[Any] = []
        for column in COLUMNS:
            if column == "parameters":
                cells += [no_formula(row["parameters"].get(key, "")) for key in keys]
            else:
                cells.append(_cell(row[column]))
        writer.writerow(cells)
    return out.getvalue()


def _cell(value: Any) -> Any:
    if value is None:
        return ""
    if isinstance(value, float):
        return repr(value)
    return json.dumps(value, separators=(",", ":")) if isinstance(value, dict | list) else no_formula(value)
