"""What certificates cost: the command, and the page that has its table."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import certificate_costs as checking
import pytest


def test_the_command_prints_the_table_of_the_page(
    root: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The same rows, in the same form; seconds are the machine's."""
    monkeypatch.setattr(checking, "WARM", 1)
    assert checking.main(["--events", "2,12"]) == 0
    printed = capsys.readouterr().out.splitlines()
    page = (root / "docs" / "certificates.md").read_text("utf-8")
    assert "python docs/studies/certificate_costs.py" in page
    start = page.index("| events of `gas` |")
    shown = page[start : page.index("\n\n", start)].splitlines()
    if shutil.which("node") is None:
        shown = [line for line in shown if "verify.mjs" not in line]
    assert [head(line) for line in printed] == [head(line) for line in shown]
    assert printed[0].endswith("| 2 | 12 |")
    number = r"\d+(\.\d+)?"
    forms = [rf"{number}", *[rf"{number} \(\d+\)"] * (len(shown) - 4), r"\d+ kB, [\d,]+ bits"]
    for lines in (printed, shown):
        for form, line in zip(forms, lines[2:], strict=True):
            assert all(re.fullmatch(form, cell.strip()) for cell in line.split("|")[2:-1]), line


def head(line: str) -> str:
    """The first cell of a row."""
    return line.split("|")[1].strip()


@pytest.mark.parametrize("events", ["0", "1,x", "", "1,,2", "-3"])
def test_numbers_of_events_that_are_none_are_refused(events: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        checking.main([f"--events={events}"])
    assert ended.value.code == 2
    assert "must be whole numbers from 1" in capsys.readouterr().err


def test_a_certificate_that_is_refused_is_an_error_and_no_figure(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(checking, "verdict_on", lambda path: (1, "refuted: instant 3"))
    with pytest.raises(RuntimeError, match="lee, 1 events: refuted: instant 3"):
        checking.checking(1, "lee")
