"""The bins of a Galton board: a file of rows, to which a second call adds, and tables that count them."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from galton import main, report


def test_rows_are_added_and_counted(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "rows.jsonl"
    words = ["--rows", "2", "--engines", "exact,double,single", "--out", str(out)]
    assert main([*words, "--balls", "2"]) == 0
    assert main([*words, "--balls", "5"]) == 0
    rows = [json.loads(line) for line in out.read_text("utf-8").splitlines()]
    assert [row["seed"] for row in rows] == [1, 2, 3, 4, 5]
    assert all(row[name] in (1, 2, 3) for row in rows for name in ("exact", "double"))
    told = capsys.readouterr().out.splitlines()
    assert "5 balls, 2 rows" in told
    assert [line.split("|")[2].strip() for line in told if line.startswith("| 2 |")] == ["1.0", "2.5"]
    assert main([*words, "--report"]) == 0
    assert capsys.readouterr().out.splitlines() == told[-len(list(report(2, rows))) :]


def test_another_bin_and_none_are_counted_apart() -> None:
    rows: list[dict[str, int | str]] = [
        {"seed": 1, "exact": 1, "double": 2},
        {"seed": 2, "exact": 1, "double": "lost"},
        {"seed": 3, "exact": "accumulation suspected", "double": 2},
        {"seed": 4, "exact": 2, "double": 2},
    ]
    told = list(report(1, rows))
    assert told[-1] == "double: another bin than the certified one 1 of 3 times, none 1 times"
    assert "| accumulation suspected | | 1 | 0 |" in told


def test_without_balls_there_is_no_report(tmp_path: Path) -> None:
    with pytest.raises(SystemExit):
        main(["--out", str(tmp_path / "none.jsonl"), "--report"])
