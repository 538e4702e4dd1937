"""Balls long enough for what is compared to many digits."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from flint import ctx


@pytest.fixture
def long_balls() -> Iterator[None]:
    """Numbers are compared in balls of 2,000 bits."""
    saved = ctx.prec
    ctx.prec = 2000
    yield
    ctx.prec = saved
