"""flint's working precision, which is global: set for as long as it is needed, and set back."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager
from typing import Final

from flint import ctx

at_bits: Final[Callable[[int], AbstractContextManager[None]]] = ctx.workprec
"""`with at_bits(n)`: what is computed in balls inside is rounded to n bits."""
