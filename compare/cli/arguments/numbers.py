"""Numbers on the command line, with errors that say what to write instead."""

from __future__ import annotations

from typing import Any

import click

from ....scenarios.errors import shortened


class Whole(click.ParamType):
    """A whole number, perhaps no less than some other.

    >>> Whole(1).convert("12", None, None)
    12
    >>> Whole(1).convert("1e3", None, None)
    Traceback (most recent call last):
      ...
    click.exceptions.BadParameter: '1e3' is not a whole number; write digits alone: 1000
    >>> Whole(1).convert("0", None, None)
    Traceback (most recent call last):
      ...
    click.exceptions.BadParameter: '0' is too small; write a whole number from 1
    """

    name = "whole number"

    def __init__(self, least: int | None = None) -> None:
        self.least = least

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> int:
        text = str(value).strip()
        if not text.removeprefix("-").isdecimal() or not text.isascii() or len(text) > MOST_DIGITS:
            meant = _meant(text)
            wish = f"digits alone: {meant}" if meant is not None else "digits alone, such as 1000"
            raise click.BadParameter(f"{shortened(text)!r} is not a whole number; write {wish}", ctx=ctx, param=param)
        if self.least is not None and int(text) < self.least:
            told = f"{text!r} is too small; write a whole number from {self.least}"
            raise click.BadParameter(told, ctx=ctx, param=param)
        return int(text)


MOST_DIGITS = 18
"""Longest number taken: counts beyond it are never reached."""


def _meant(text: str) -> int | None:
    """The whole number that a text such as 1e3, 2.0 or 1_000 means; None if it means none."""
    try:
        value = float(text.replace(",", ""))
    except (ValueError, OverflowError):
        return None
    return int(value) if abs(value) < 10.0**MOST_DIGITS and value == int(value) else None


class Seconds(click.ParamType):
    """A number of seconds above zero.

    >>> Seconds().convert("2.5", None, None)
    2.5
    >>> Seconds().convert("soon", None, None)
    Traceback (most recent call last):
      ...
    click.exceptions.BadParameter: 'soon' is not a number of seconds above 0; write one such as 2.5
    """

    name = "seconds"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float:
        try:
            seconds = float(value)
        except (ValueError, OverflowError):
            seconds = 0.0
        if not 0 < seconds < float("inf"):
            told = f"{shortened(str(value))!r} is not a number of seconds above 0; write one such as 2.5"
            raise click.BadParameter(told, ctx=ctx, param=param)
        return seconds
