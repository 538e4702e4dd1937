"""The bench of what a verdict costs: what it prints and keeps, in small sizes, not how many seconds anything takes."""

from __future__ import annotations

import json
import time
from collections.abc import Callable
from pathlib import Path

import pytest
import verdict_costs
from verdict_costs import HEAD, NAMES, Cost, Subject, changes, drawn, finer_steps, kept, main, measured

from truebreak.compare.engines import engine
from truebreak.compare.grids.store import Store
from truebreak.compare.study import Study
from truebreak.scenarios import catalogue
from truebreak.scenarios.errors import SceneError


@pytest.fixture(autouse=True)
def _small(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(
        verdict_costs.SUBJECTS, "tiny", lambda: Subject("tiny", 1e9, lambda: sum(range(9_000)), lambda: sum(range(90)))
    )
    monkeypatch.setattr(verdict_costs, "NAMES", [*NAMES, "tiny"])


def test_every_row_of_what_a_verdict_may_cost_has_a_name() -> None:
    wanted = {"compare-gas", "compare-rack-5", "check-cold", "check-warm", "sweep-audit", "sweep-no-audit", "shadow"}
    assert wanted | {"chaos", "advise", "stress", "start-up", "imports"} <= set(NAMES)
    assert {"shadow-10000", "chaos-10000", "jobs", "long-run", "long-run-memory"} <= set(NAMES)
    assert {f"compare-{name}" for name in catalogue.names()} <= set(NAMES)


def test_a_cost_is_the_command_over_the_runs_that_it_needs() -> None:
    found = measured("compare-lee", 1)
    assert found.what == "compare lee" and found.seconds > found.base > 0 and found.ratio > 1


def test_runs_at_finer_steps_are_gathered_apart() -> None:
    scene, exact, pymunk = catalogue.build("gas:n=3"), engine("exact"), engine("pymunk")
    study = Study(scene, exact, exact.run(scene, events=5))
    with finer_steps() as taken:
        study.run(pymunk, scene, 1.0)
        study.run(engine("double"), scene, 1.0)
        assert taken == []
        study.run(engine(f"pymunk:dt={(pymunk.step or 0) / 2!r}"), scene, 1.0)
    assert len(taken) == 1 and taken[0] > 0
    study.run(engine(f"pymunk:dt={(pymunk.step or 0) / 2!r}"), scene, 1.0)
    assert len(taken) == 1


def test_a_long_run_is_measured_by_what_it_takes_more_than_a_short_one(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(verdict_costs, "LONG", 300)
    seconds, megabytes = measured("long-run", 1), measured("long-run-memory", 1)
    assert seconds.seconds > 0 and seconds.base > 0 and seconds.unit == "s"
    assert megabytes.base > 1 and megabytes.seconds < megabytes.base and megabytes.figure[1] == 80
    assert verdict_costs.long_run(300) is verdict_costs.long_run(300)


def test_workers_are_measured_by_the_time_on_the_wall(monkeypatch: pytest.MonkeyPatch) -> None:
    """Their processor time is not that of this process."""

    def sleeps(seconds: float) -> Callable[[], None]:
        return lambda: time.sleep(seconds)

    monkeypatch.setitem(
        verdict_costs.SUBJECTS, "tiny", lambda: Subject("tiny", 0.9, sleeps(0.01), sleeps(0.1), wall=True)
    )
    found = measured("tiny", 2)
    assert found.seconds >= 0.01 and found.base >= 0.1


def test_what_takes_minutes_is_measured_less_often(monkeypatch: pytest.MonkeyPatch) -> None:
    called: list[int] = []
    subject = Subject("tiny", 9, lambda: called.append(1), lambda: sum(range(9)), most_repeats=1)
    monkeypatch.setitem(verdict_costs.SUBJECTS, "tiny", lambda: subject)
    measured("tiny", 3)
    assert called == [1]
    assert verdict_costs.shadowed(10_000).most_repeats == verdict_costs.measured_chaos(10_000).most_repeats == 1


def test_a_sweep_by_two_workers_has_the_rows_of_one_by_one() -> None:
    subject = verdict_costs.side_by_side(2)
    assert subject.wall and subject.most == pytest.approx(1 / 1.7, rel=1e-3)
    two, one = (action() for action in (subject.command, subject.base))
    assert isinstance(two, Store) and isinstance(one, Store)
    assert [(row.index, row.verdict) for row in two] == [(row.index, row.verdict) for row in one] != []


def test_figures_are_added_to_the_file_and_a_change_is_named(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file, picture = tmp_path / "costs.jsonl", tmp_path / "costs.svg"
    words = ["tiny", "--append", str(file), "--draw", str(picture)]
    assert main(words, 1) == 0
    first = capsys.readouterr().out
    assert first.startswith(HEAD) and first.count("\n") == 3
    (row,) = kept(str(file))
    value, most = row["costs"]["tiny"]
    assert most == 1e9 and value > 1
    row["costs"]["tiny"][0] = 1e-9
    file.write_text(json.dumps(row) + "\n", "utf-8")
    assert main(words, 1) == 0
    assert f"tiny: 1e-09 at {row['commit']}, " in capsys.readouterr().out
    assert len(kept(str(file))) == 2
    assert "tiny" in picture.read_text("utf-8") and drawn(kept(str(file))).count("<polyline") == 1


def test_a_change_within_a_tenth_is_none() -> None:
    before = {"commit": "a", "costs": {"x": [1.0, 2]}}
    assert changes(before, {"costs": {"x": [1.09, 2]}}) == []
    assert changes(before, {"costs": {"x": [0.8, 2]}}) == ["x: 1 at a, 0.8 now (-20 %)"]


def test_a_target_that_is_missed_is_exit_code_1(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(verdict_costs, "measured", lambda name, repeats: Cost(name, "slow", 3.0, 1.0, 0.0, 2))
    assert main(["tiny"]) == 1
    assert "| slow | 3 | <= 2: MISSED |" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "told"),
    [(["tinny"], "'tinny' is not known; "), (["tiny", "--draw", "x.svg"], "give it with --append FILE")],
)
def test_what_cannot_be_asked_is_refused(words: list[str], told: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as stop:
        main(words)
    assert stop.value.code == 2
    assert told in capsys.readouterr().err


def test_a_file_of_something_else_is_refused_before_anything_is_measured(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "other.jsonl"
    file.write_text("[]\n", "utf-8")
    with pytest.raises(SystemExit):
        main(["tiny", "--append", str(file)])
    told = capsys.readouterr()
    assert "is no file of figures" in told.err and not told.out
    with pytest.raises(SceneError):
        kept(str(file))
