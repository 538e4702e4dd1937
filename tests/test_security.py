"""SECURITY.md is true: behind every promise stands a test that is there and has tests in it."""

from __future__ import annotations

import re
from pathlib import Path

PROOF = re.compile(r"\*\(`(tests/[\w/.]+)`[^)]*\)\*")


def test_every_promise_names_a_test_that_there_is(root: Path) -> None:
    page = (root / "SECURITY.md").read_text("utf-8")
    promised = page.partition("## Promised")[2].partition("## Not promised")[0]
    promises = re.split(r"\n- ", promised)[1:]
    assert len(promises) > 8
    for promise in promises:
        proofs = PROOF.findall(promise)
        assert proofs, promise
        for place in proofs:
            path = root / place
            files = [path] if path.is_file() else sorted(path.rglob("test_*.py"))
            assert any("\ndef test_" in file.read_text("utf-8") for file in files), place
