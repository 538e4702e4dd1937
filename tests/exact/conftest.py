"""Balls long enough for what is compared to many digits."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from flint import ctx

from truebreak.exact.certified import filtered_falls


@pytest.fixture
def long_balls() -> Iterator[None]:
    """Numbers are compared in balls of 2,000 bits."""
    saved = ctx.prec
    ctx.prec = 2000
    yield
    ctx.prec = saved


@pytest.fixture
def unfiltered(monkeypatch: pytest.MonkeyPatch) -> None:
    """Under gravity nothing is clear in doubles: all is predicted in balls."""
    line, peg = filtered_falls.float_fall, filtered_falls.float_peg
    monkeypatch.setattr(
        filtered_falls, "float_fall", lambda *of: line(*of)._replace(norm=float("inf"), size=float("inf"))
    )
    monkeypatch.setattr(filtered_falls, "float_peg", lambda *of: peg(*of)._replace(reach=float("inf")))
