"""A run is the same as its golden one, or the report of `truebreak diff` says where it is not."""

from __future__ import annotations

from pathlib import Path

import pytest

import truebreak as tb
from truebreak.compare.testing.golden import NotTheSame, log_of, same


def test_a_golden_run_that_is_missing_is_written_and_fails(tmp_path: Path) -> None:
    run, golden = tb.run(tb.scene("gas:n=4"), events=20), tmp_path / "golden" / "gas.jsonl"
    with pytest.raises(NotTheSame, match="was missing; it is written now"):
        same(run, golden)
    found = same(run, golden)
    assert found is not None and found.verdict.line == "identical"


def test_another_run_fails_with_the_report(tmp_path: Path) -> None:
    golden, log = tmp_path / "gas.jsonl", tmp_path / "run.jsonl"
    same(tb.run(tb.scene("gas:n=4"), events=20), golden, regenerate=True)
    other = tb.run(tb.scene("gas:n=4,seed=2"), events=20)
    log.write_text(log_of(other), encoding="utf-8")
    for run in (other, log, str(log)):
        with pytest.raises(NotTheSame, match=r"(?s)different from the start: .*first other bits.*--truebreak-regen"):
            same(run, golden)


def test_golden_logs_are_written_anew_where_pytest_is_asked_to(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    run, golden = tb.run(tb.scene("gas:n=4"), events=20), tmp_path / "gas.jsonl"
    golden.write_text("stale", encoding="utf-8")
    monkeypatch.setenv("TRUEBREAK_REGEN", "1")
    assert same(run, golden) is None and golden.read_text("utf-8") == log_of(run)


def test_doubles_differ_from_the_certified_run_by_rounding(tmp_path: Path) -> None:
    scene = tb.scene("gas:n=5")
    for name, engine in (("one", "exact"), ("two", "double")):
        (tmp_path / name).write_text(log_of(tb.run(scene, engine, events=40)), encoding="utf-8")
    found = tb.diff(tmp_path / "one", tmp_path / "two", scene=scene)
    assert found.verdict.line.startswith("grew from rounding at event"), found.line
    assert found.lawful is not None and found.lawful.growth is not None
    low, high = found.lawful.growth
    assert 10 < low <= high < 40
