"""The reference set is what its builder builds now, and both checkers verify all of it."""

from __future__ import annotations

import hashlib
import json
import zipfile
from pathlib import Path

import pytest

from certificate.checkers import both_verify
from certificate.reference_set import ARCHIVE, DIGITS, certificate, digest, entries

TOLD = {Path(name).name: zipfile.ZipFile(ARCHIVE).read(name).decode() for name in zipfile.ZipFile(ARCHIVE).namelist()}
INDEX = json.loads(TOLD["index.json"])


def test_it_holds_a_hundred_histories_and_says_what_they_are() -> None:
    rows = INDEX["histories"]
    assert len(rows) == 100 == len(entries())
    assert [row["name"] for row in rows] == [name for name, _ in entries()]
    assert ARCHIVE.stat().st_size < 300_000
    for row in rows:
        text = TOLD[row["file"]]
        told = json.loads(text)
        assert row["sha256"] == hashlib.sha256(text.encode()).hexdigest() and row["digest"] == digest(told["scene"])
        assert all(len(x.partition(".")[2]) == DIGITS for circle in told["final"]["circles"] for x in circle)


@pytest.mark.parametrize("step", [9, pytest.param(1, marks=pytest.mark.slow)])
def test_it_is_current(step: int) -> None:
    """`make reference-set` writes it anew."""
    for (name, maker), row in list(zip(entries(), INDEX["histories"], strict=True))[::step]:
        assert certificate(maker) == TOLD[row["file"]], f"{name}: run make reference-set"


@pytest.mark.parametrize("step", [9, pytest.param(1, marks=pytest.mark.slow)])
def test_both_checkers_verify_it(step: int, tmp_path: Path) -> None:
    rows = INDEX["histories"][::step]
    both_verify([(row["file"], json.loads(TOLD[row["file"]])) for row in rows], tmp_path)
