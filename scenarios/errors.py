"""What bad input raises: the errors, and how they show a bad value."""

from __future__ import annotations

import reprlib

# -- The one error that bad input raises: what is wrong, where, and what to do about it.


class SceneError(ValueError):
    """A scene, a number or a setting that cannot be used.

    The message is one line that names the thing, its value and the remedy, fit to be shown to a person as it
    stands.

    >>> str(SceneError("circle 'b3': r is 0; a radius must be positive"))
    "circle 'b3': r is 0; a radius must be positive"
    """


class Disturbed(RuntimeError):
    """Something that exact numbers rest on was changed from outside while they were computed, and nothing is given
    back: flint's working precision, the rounding mode of doubles, or that these are kept near zero. The message says
    which, and what to do."""


class NoClosedForm(ValueError):
    """A number of a run that square roots do not make, asked for in them. Its digits are to be had."""


class TimeIsUp(BaseException):
    """The seconds that the user allowed a whole run are over. Like an interruption, it may come anywhere; engines
    end their runs at what is whole by then."""


# -- How an error shows a bad value: quoted, on one line, and cut.

SHOWN = 60
"""How much of a bad value an error repeats, in characters."""


def printable(text: str, wide: str = "\\u{:04x}\\u{:04x}") -> str:
    """A text in which a terminal finds nothing to act on: control characters and marks of direction are spelled out.

    Ends of lines stay. What is spelled out reads back as what it was within a string of JSON.

    Args:
        wide: how a character beyond the first 65,536 is spelled, from the two halves of its pair.

    >>> printable("plain, \\u00e9"), printable("left\\u202eright"), printable("\\x1b[2J")
    ('plain, \u00e9', 'left\\\\u202eright', '\\\\u001b[2J')
    """
    if text.isprintable():
        return text
    if text.isprintable():
        return text
    from unicodedata import category

    return "".join(c if c == "\n" or c.isprintable() or category(c) == "Zs" else _spelled(c, wide) for c in text)


def _spelled(character: str, wide: str) -> str:
    code = ord(character)
    if code < 0x10000:
        return f"\\u{code:04x}"
    return wide.format(0xD7C0 + (code >> 10), 0xDC00 + (code & 0x3FF), code=code)


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
