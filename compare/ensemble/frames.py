"""The rows of a sweep as a pandas table, and as Parquet (`pip install '.[tables]'`)."""

from __future__ import annotations

import contextlib
import json
import os
import tempfile
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ...scenarios.errors import SceneError
from .rows.row import COLUMNS

if TYPE_CHECKING:
    from .rows.row import SweepRow

TEXTS = ("margin", "changed", "laws", "work")
"""Columns of lists and of dicts: as JSON text, which every reader of tables takes."""


def to_pandas(rows: Iterable[SweepRow]) -> Any:
    """The rows as a `pandas.DataFrame`, each varied parameter in a column of its own.

    Raises:
        SceneError: without pandas.
    """
    try:
        import pandas
    except ImportError:
        raise SceneError("a table in pandas needs pandas; pip install '.[tables]', or write CSV") from None
    flat: list[dict[str, Any]] = []
    for row in rows:
        told: dict[str, Any] = {}
        for column in COLUMNS:
            if column == "parameters":
                told |= row["parameters"]
            else:
                value = row[column]
                told[column] = json.dumps(value) if column in TEXTS and value is not None else value
        flat.append(told)
    return pandas.DataFrame(flat)


def write_parquet(rows: Iterable[SweepRow], path: str | Path) -> None:
    """Writes the rows as a Parquet file, whole or not at all.

    Raises:
        SceneError: without pandas and pyarrow, and if the place cannot be written to.
    """
    frame, target = to_pandas(rows), Path(path)
    try:
        import pyarrow  # noqa: F401
    except ImportError:
        raise SceneError("Parquet needs pyarrow; pip install '.[tables]', or write CSV") from None
    try:
        descriptor, name = tempfile.mkstemp(prefix=f".{target.name}.", dir=target.parent)
        os.close(descriptor)
        try:
            frame.to_parquet(name)
            Path(name).replace(target)
        except BaseException:
            with contextlib.suppress(OSError):
                Path(name).unlink()
            raise
    except OSError as error:
        raise SceneError(f"file {str(path)!r}: {error.strerror or error}; choose another place to write to") from None
