"""The rows of a grid as tables: CSV, and for people."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, Any

from ..documents.values.amounts import no_formula
from .family_sweep import COLUMNS

if TYPE_CHECKING:
    from .row import Row
    from .store import Store


def csv_parts(rows: Store | Iterable[Row], keys: Sequence[str]) -> Iterator[str]:
    """The rows of a sweep as CSV, a line at a time, each varied parameter in a column of its own; equal rows give
    equal bytes.

    >>> from truebreak.compare.grids.row import Row
    >>> lines = list(csv_parts([Row(3, "gas:n=5", "double", parameters={"n": "5"}, changed=["collisions"])], ["n"]))
    >>> lines[1].split(",")[:4]
    ['3', 'gas:n=5', '', '5']
    """
    heads: list[str] = []
    for column in COLUMNS:
        heads += [*keys] if column == "parameters" else [column]
    yield _line(heads)
    for row in rows.objects() if hasattr(rows, "objects") else (one.data() for one in rows):  # type: ignore[union-attr]
        cells: list[Any] = []
        for column in COLUMNS:
            value = row.get(column)
            if column == "parameters":
                cells += [no_formula((value or {}).get(key, "")) for key in keys]
            else:
                cells.append(_cell(value))
        yield _line(cells)


def _line(cells: Sequence[Any]) -> str:
    out = io.StringIO()
    csv.writer(out, lineterminator="\n").writerow(cells)
    return out.getvalue()


def _cell(value: Any) -> Any:
    if value is None:
        return ""
    if isinstance(value, float):
        return repr(value)
    return json.dumps(value, separators=(",", ":")) if isinstance(value, dict | list) else no_formula(value)
