"""Runs that end before their time: at a step of the log, or at a question that is too dear."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import pytest

from truebreak.exact.certified.certified_decider import CertifiedDecider
from truebreak.floating.plain import PlainDecider


def unlike_twins(n: int) -> dict[str, Any]:
    """Two rows of discs that differ in the mass of the last: its hit is a tie that no isometry tells."""
    rows = [
        {"id": f"{name}{k}", "x": 4 * k, "y": f"{k}/7 + {y}", "r": 1, "vx": int(k == 0), "vy": 0}
        for name, y in (("a", 0), ("b", 500))
        for k in range(n)
    ]
    rows[-1]["m"] = 2
    return {"name": "unlike twins", "circle": rows}


@contextmanager
def ended_at(step: int, before: bool, error: BaseException, monkeypatch: pytest.MonkeyPatch) -> Iterator[list[int]]:
    """Raises an error before or after so many steps of the log have been carried out; counts them."""
    count = [0]
    with monkeypatch.context() as patch:
        for decider in (CertifiedDecider, PlainDecider):
            patch.setattr(decider, "do", _ending(decider.do, count, step, before, error))
        yield count


def _ending(do: Any, count: list[int], step: int, before: bool, error: BaseException) -> Any:
    def counted(self: Any, made: Any) -> None:
        count[0] += 1
        if count[0] == step and before:
            raise error
        do(self, made)
        if count[0] == step:
            raise error

    return counted
