"""Lines of text files that other programs wrote: what a log, and a line of JSON or CSV in it, is read by."""

from __future__ import annotations

import csv
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from ..validation import EngineError

MARK = "\ufeff"
"""The mark of byte order that some editors write first; it is none of the text."""


def text_lines(path: Path, shown: str, most: int, whole: int | None = None) -> Iterator[tuple[int, str]]:
    """The lines of a file that are not empty, without the space around them, with their numbers.

    Args:
        shown: what the file is called.
        most, whole: bytes of one line, and of all, beyond which it is refused.

    Raises:
        EngineError: naming the file and the line.
    """
    long = f"the log is longer than {whole or 0:,} bytes; judge its beginning, or leave out states"
    try:
        with path.open("rb") as file:
            if whole is not None and os.fstat(file.fileno()).st_size > whole:
                raise EngineError(f"file {shown!r}: {long}")
            number, read = 1, 0
            while raw := file.readline(most + 1):
                read += len(raw)
                if len(raw) > most:
                    raise EngineError(f"file {shown!r}, line {number}: is longer than {most:,} bytes; is it a log?")
                if whole is not None and read > whole:  # of a pipe, whose length is not known before
                    raise EngineError(f"file {shown!r}, line {number}: {long}")
                text = raw.decode("utf-8").strip()
                if number == 1:
                    text = text.removeprefix(MARK).strip()
                if text:
                    yield number, text
                number += 1
    except UnicodeDecodeError:
        raise EngineError(f"file {shown!r}: is not text in UTF-8; is it a log?") from None
    except OSError as error:
        raise EngineError(f"file {shown!r}: {error.strerror or error}; name a log that can be read") from None


def once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """An object of JSON, each key of which is there once.

    Raises:
        KeyError: for one that is there again.

    >>> once([("a", 1), ("b", 2)])
    {'a': 1, 'b': 2}
    """
    found: dict[str, Any] = {}
    for key, value in pairs:
        if key in found:
            raise KeyError(key[:60])
        found[key] = value
    return found


def cells_of(text: str, where: str) -> list[str]:
    """The cells of a row of CSV.

    Raises:
        EngineError: for a row that is none.

    >>> cells_of('1, 0.5,"a,b"', "line 2")
    ['1', '0.5', 'a,b']
    """
    try:
        return [cell.strip() for cell in next(csv.reader([text]))]
    except csv.Error as error:
        raise EngineError(f"{where}: {text[:60]!r} is no row of CSV: {error}") from None
