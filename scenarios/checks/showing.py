"""How an error shows a bad value: quoted, on one line, and cut."""

from __future__ import annotations

import reprlib

SHOWN = 60
"""How much of a bad value an error repeats, in characters."""


class Bare(str):
    """A number that a file spells without quotes: kept as it is spelled, never made a binary float."""

    __slots__ = ()


def shortened(text: str) -> str:
    """A long text cut, with its length.

    >>> shortened("1" * 100)[50:]
    '1111111111... (100 characters)'
    """
    return text if len(text) <= SHOWN else f"{text[:SHOWN]}... ({len(text)} characters)"


def cut(value: object) -> str:
    """A bad value as an error repeats it.

    >>> cut("5" * 1000)[:8], cut(Bare("0.5")), cut(None), cut([1, 2])
    ("'5555555", '0.5', 'null', '[1, 2]')
    """
    if isinstance(value, bool) or value is None:
        return {True: "true", False: "false", None: "null"}[value]
    if isinstance(value, str):
        text = shortened(value)
        return str(text) if isinstance(value, Bare) else repr(text)
    if isinstance(value, int) and value.bit_length() > 3 * SHOWN:
        return f"a whole number of {value.bit_length()} bits"
    text = reprlib.repr(value)
    return text if len(text) <= SHOWN else f"{text[:SHOWN]}..."
