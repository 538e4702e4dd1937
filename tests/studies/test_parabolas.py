"""The picture of flights under gravity is what its command draws."""

from __future__ import annotations

from pathlib import Path

from parabolas import picture


def test_the_picture_of_the_docs_is_current(root: Path) -> None:
    assert (root / "docs" / "gravity.svg").read_text("utf-8") == picture()
