"""flint's working precision, which is global: no other file touches it."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager
from typing import Final

from flint import ctx

at_bits: Final[Callable[[int], AbstractContextManager[None]]] = ctx.workprec
"""`with at_bits(n)`: what is computed in balls inside is rounded to n bits; afterwards all is as it was."""


def use_bits(bits: int) -> None:
    """Sets the precision, until it is set again."""
    if ctx.prec != bits:  # asking costs a tenth of setting
        ctx.prec = bits


def bits_in_use() -> int:
    """The precision."""
    return ctx.prec
