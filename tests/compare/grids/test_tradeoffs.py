"""Run time against error: what a row says is true; two runs are held against each other. No test goes by seconds."""

from __future__ import annotations

import json
import math
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from tradeoff_page import main as page_main

from truebreak.compare import compare
from truebreak.compare.cli.commands.bench import _words
from truebreak.compare.cli.entry import main
from truebreak.compare.engines import ENGINES
from truebreak.compare.grids.computer import SHARED, UNEVEN, Idleness, Took, idleness, memory, reset_peak
from truebreak.compare.grids.measured import measure
from truebreak.compare.grids.row import Row
from truebreak.compare.grids.store import Store
from truebreak.compare.grids.tradeoffs import (
    COLUMNS,
    SETTINGS,
    SUBJECTS,
    Subject,
    TradeoffJob,
    TradeoffPlan,
    digest_of,
    in_exact,
    settings_of,
    steady,
    study_of,
    subjects,
    tradeoffs,
    with_front,
)
from truebreak.compare.report.pictures.tradeoff_plot import CIRCLE, tradeoff_plot
from truebreak.compare.report.schema import schema
from truebreak.compare.report.speed_report import (
    WITHIN,
    Against,
    RatioChange,
    Report,
    against,
    check_scenes,
    load,
    rows_of,
)
from truebreak.compare.report.speed_report import measure as measure_all
from truebreak.scenarios import SceneError, catalogue

ONCE = (1, 1)
DOCS = Path(__file__).resolve().parents[3] / "docs"
IDLE = Idleness(1.0, 1.0)


def row(scene: str, engine: str, loops: float, digits: float | None = 10.0) -> Row:
    digest = digest_of(subjects([scene])[0])
    return Row(
        0, scene, engine, "agree", digest=digest, agreed=4, events=4, digits=digits, changed=[], loops=loops, spread=1.0
    )


def report(*rows: Row, idle: Idleness = IDLE) -> Report:
    return Report(tuple(in_exact(rows)), idle)


def written(path: Path, told: Report) -> str:
    path.write_text(json.dumps(told.data()), "utf-8")
    return str(path)


@pytest.fixture(scope="module")
def rows() -> list[Row]:
    chosen_settings = ["double", "single", "interval:bits=24", "pymunk:dt=1/64", "sympy"]
    return tradeoffs(subjects(["near-tie"]), chosen_settings, processes=ONCE)


def test_a_row_says_what_a_comparison_says(rows: list[Row]) -> None:
    assert [r.engine for r in rows] == ["exact", "double", "single", "interval:bits=24", "pymunk:dt=1/64", "sympy"]
    subject = subjects(["near-tie"])[0]
    until = study_of(subject).reference.final_time
    for r in rows[1:]:
        found = compare(catalogue.build(subject.spec), [r.engine], until=str(until), causes=False).candidates[0]
        assert (r.verdict, r.agreed) == (found.verdict, found.alignment.agreed)
        assert r.changed == (None if found.verdict == "undecided" else list(found.changed))
        assert r.error == found.separation.maximum
    assert rows[0].digits == rows[-1].digits == 1000.0, "all that anybody asks for"
    assert {r.verdict for r in rows} >= {"agree", "diverged", "undecided"}
    assert all((r.seconds or 0) > 0 and (r.loops or 0) > 0 and (r.ratio or 0) > 0 and r.samples for r in rows)
    assert all(len(r.samples[kind]) >= 2 for r in rows if r.samples for kind in ("runs", "loops"))
    assert rows[0].ratio == 1.0


def test_memory_is_that_of_the_run_alone() -> None:
    if memory() is None:
        pytest.skip("this system does not tell a process its memory")
    few, many = (measure("gas:n=10", "double", until, seconds=0.0).memory for until in ("1", "4000"))
    assert few is not None
    assert many is not None
    assert many > few + 2**20, "thousands of events are kept"
    assert few < 2**22


def test_the_peak_is_forgotten_before_a_run() -> None:
    if memory() is None:
        pytest.skip("this system does not tell a process its memory")
    block = bytearray(1 << 26)
    block[:: 1 << 12] = b"x" * len(block[:: 1 << 12])
    high = memory()
    del block
    reset_peak()
    low = memory()
    assert high is not None
    assert low is not None
    assert low[1] < high[1]


def test_a_process_that_fails_says_why() -> None:
    with pytest.raises(RuntimeError, match="duoble"):
        measure("near-tie", "duoble", "2")


def test_what_would_take_minutes_is_left_out_and_says_so() -> None:
    found = tradeoffs([Subject("gas", "gas:n=10,seed=1", 3)], ["sympy", "pymunk:dt=1/67108864", "nonsense"],
                      processes=ONCE)  # fmt: skip
    told = {r.engine: r.refused or "" for r in found}
    assert told["exact"] == ""
    assert "expressions" in told["sympy"]
    assert "units of work" in told["pymunk:dt=1/67108864"]
    assert "not known" in told["nonsense"]
    assert all(not r.front for r in found[1:])


def test_a_scene_that_cannot_be_had_is_a_row_with_the_reason() -> None:
    found = tradeoffs([Subject("gas", "gas:n=10,seed=1,size=3", 3)], ["double"], processes=ONCE)
    assert [r.engine for r in found] == ["exact", "double"]
    assert all("no room" in (r.refused or "") for r in found)


def test_the_table_has_every_scene_engine_and_setting_asked_for() -> None:
    names = [subject.name for subject in SUBJECTS]
    assert names == ["gas", "mixed-gas", "rack-touching", "rack-loose", "galperin", "cradle", "pinball", "lorentz",
                     "near-tie", "thousand-discs"]  # fmt: skip
    assert {text.partition(":")[0] for text in settings_of(SUBJECTS[0])} >= set(ENGINES) - {"exact"}
    assert sum(text.startswith("pymunk:dt=1/1024") for text in SETTINGS) == 3
    assert len(catalogue.build(SUBJECTS[-1].spec).circles) == 1000


@pytest.mark.parametrize("subject", [s for s in SUBJECTS if s.name != "thousand-discs"], ids=lambda s: s.name)
def test_every_scene_ends_where_rounding_decides_nothing(subject: Subject) -> None:
    few = replace(subject, events=min(subject.events, 12))
    study = study_of(few)
    reference = study.reference
    assert 0 < len(reference.events) <= few.events
    assert float(reference.events[-1].time) < float(reference.final_time)
    assert reference.final_time.text() == str(reference.final_time)


def test_nothing_on_the_front_is_beaten_and_everything_else_is() -> None:
    mine = [row("gas", f"e{k}", t, d) for k, (t, d) in enumerate([(1, 5), (1, 5), (2, 4), (3, 9), (4, 9), (9, None)])]
    assert [r.front for r in with_front(mine)] == [True, True, False, True, False, False]


def test_idle_is_what_is_measured() -> None:
    even = [Took(0.1, 0.1)] * 5
    assert idleness(even, even).idle
    assert not idleness([Took(1.0, 1.5)], even).idle, "it got two thirds of a processor"
    assert not idleness(even, [Took(0.1, 0.1), *[Took(0.13, 0.13)] * 4]).idle, "the loop was slower most of the time"
    assert not idleness(even, even, ["gas, double"]).idle
    assert "not idle" in str(Idleness(1.0, UNEVEN * 1.1))
    assert Idleness(SHARED, UNEVEN).idle


def test_against_itself_every_ratio_agrees(tmp_path: Path) -> None:
    told = report(row("near-tie", "exact", 2.0), row("near-tie", "double", 1.0))
    held = against(told, load(written(tmp_path / "a.json", told), "--against"))
    assert [change.share for change in held.changes] == [0.0, 0.0]
    assert held.comparable
    assert not held.beyond
    assert held.sentences()[0] == "2 of 2 ratios agree within 15%."


def test_against_tells_what_differs_and_whether_that_says_something(tmp_path: Path) -> None:
    then = report(row("near-tie", "exact", 2.0), row("near-tie", "double", 1.0), row("near-tie", "quad", 5.0))
    now = report(row("near-tie", "exact", 2.0), row("near-tie", "double", 1.2), row("near-tie", "single", 1.0))
    data = load(written(tmp_path / "a.json", then), "--against")
    held = against(now, data)
    assert [change.name for change in held.beyond] == ["near-tie, double"]
    assert held.missing == ("near-tie, quad", "near-tie, single")
    assert held.comparable
    busy = against(replace(now, idleness=Idleness(2.0, 1.0)), data)
    assert not busy.comparable
    assert any("say nothing of the engines" in line for line in busy.sentences())
    other = against(now, {**data, "machine": {**data["machine"], "cores": 10**6}})
    assert not other.comparable
    assert any("another machine" in line for line in other.sentences())


@pytest.mark.parametrize(
    ("then", "now", "within"), [(1, 1.149, True), (1.149, 1, True), (1, 1.16, False), (2, 1, False)]
)
def test_ratios_agree_within_fifteen_percent_either_way(then: float, now: float, within: bool) -> None:
    assert WITHIN == 0.15
    assert RatioChange("x", then, now).within is within


def refused(capsys: pytest.CaptureFixture[str], *words: str) -> str:
    with pytest.raises(SystemExit) as stop:
        main(["bench", *words])
    assert stop.value.code == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.count("\n") == 1
    return err


def test_files_that_do_not_fit_are_refused_before_anything_runs(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    told = report(row("near-tie", "exact", 2.0), row("near-tie", "double", 1.0))
    path = tmp_path / "a.json"
    good = json.loads(Path(written(path, told)).read_text("utf-8"))

    def with_changes(**changes: Any) -> str:
        path.write_text(json.dumps({**good, **changes}), "utf-8")
        return str(path)

    ask = ("tradeoffs", "--scenes", "near-tie", "--against")
    assert "another set of scenes: 'gas' it has not" in refused(
        capsys, "tradeoffs", "--scenes", "gas,near-tie", *ask[3:], str(path)
    )
    assert "it has besides" in refused(capsys, "--scenes", "pinball", "--against", str(path))
    assert "'truebreak/bench-1'" in refused(capsys, *ask, with_changes(schema="truebreak/bench-1"))
    assert "version 0.0.1" in refused(capsys, *ask, with_changes(version="0.0.1"))
    strange = [{**one, "digest": "0" * 64} for one in good["tradeoffs"]]
    assert "is another one" in refused(capsys, *ask, with_changes(tradeoffs=strange))
    assert "is damaged" in refused(capsys, *ask, with_changes(tradeoffs=[{"scene": "near-tie"}]))
    assert "is damaged" in refused(capsys, *ask, with_changes(idle=None))
    for ratio in (0.0, -1.0, math.nan, math.inf, None, "1"):
        odd = [{**one, "ratio": ratio} for one in good["tradeoffs"]]
        assert "is damaged" in refused(capsys, *ask, with_changes(tradeoffs=odd)), ratio
    assert "is damaged" in refused(capsys, *ask, with_changes(tradeoffs=2 * good["tradeoffs"]))
    assert "is damaged" in refused(capsys, *ask, with_changes(idle={**good["idle"], "wall": math.nan}))
    for text in ("{", "[" * 100_000):
        path.write_text(text, "utf-8")
        assert "is not JSON" in refused(capsys, *ask, str(path))
    assert "No such file" in refused(capsys, *ask, str(tmp_path / "none.json"))
    assert "did you mean 'near-tie'" in refused(capsys, "tradeoffs", "--scenes", "neartie")
    assert "python docs/studies/speed_ratios.py" in refused(capsys, "gas-double")
    assert "too small" in refused(capsys, "tradeoffs", "--processes", "0")


@pytest.mark.parametrize(
    ("change", "idle", "code"),
    [(1.0, IDLE, 0), (1.5, IDLE, 1), (1.5, Idleness(2.0, 1.0), 4), (1.0, Idleness(2.0, 1.0), 0)],
)
def test_the_exit_code_says_what_came_out(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch,
    change: float, idle: Idleness, code: int,
) -> None:  # fmt: skip
    then = report(row("near-tie", "exact", 2.0), row("near-tie", "double", 1.0))
    now = report(row("near-tie", "exact", 2.0), row("near-tie", "double", change), idle=idle)
    monkeypatch.setattr("truebreak.compare.report.speed_report.measure", lambda *_, **__: now)
    path, plot = written(tmp_path / "a.json", then), tmp_path / "a.svg"
    with pytest.raises(SystemExit) as stop:
        main(["bench", "tradeoffs", "--scenes", "near-tie", "--against", path, "--svg", str(plot)])
    assert stop.value.code == code
    shown = capsys.readouterr().out
    assert "Pareto's front" in shown
    assert f"{2 if change == 1.0 else 1} of 2 ratios agree within 15%" in shown
    assert plot.read_text("utf-8") == tradeoff_plot(now.tradeoffs)


def test_nothing_in_common_is_no_agreement(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    then = report(row("near-tie", "exact", 2.0), row("near-tie", "double", 1.0))
    now = replace(
        then, tradeoffs=tuple(replace(one, verdict="refused", note="its process ended") for one in then.tradeoffs)
    )
    monkeypatch.setattr("truebreak.compare.report.speed_report.measure", lambda *_, **__: now)
    with pytest.raises(SystemExit) as stop:
        main(["bench", "tradeoffs", "--scenes", "near-tie", "--against", written(tmp_path / "a.json", then)])
    assert stop.value.code == 4
    assert "No ratio was measured both times" in capsys.readouterr().out


def test_what_a_store_has_is_not_measured_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    path, made = str(tmp_path / "rows.db"), list[str]()
    took = {"runs": [[0.3, 0.2], [0.3, 0.2]], "loops": [[0.1, 0.1]]}

    def rows(job: TradeoffJob) -> list[Row]:
        made.append(job.engine)
        return [replace(row("near-tie", job.engine, 1.0 + job.index), index=job.index, samples=took)]

    monkeypatch.setattr(TradeoffJob, "rows", rows)
    for _ in range(2):
        again = measure_all(scenes=["near-tie"], engines=["double"], store=path)
        assert [(r.engine, r.loops, r.ratio) for r in again.tradeoffs] == [("exact", 1.0, 1.0), ("double", 2.0, 2.0)]
    assert made == ["exact", "double"]
    words = ("tradeoffs", "--scenes", "near-tie", "--engines", "single", "--store", path)
    assert "holds another table of run time against error" in refused(capsys, *words)
    monkeypatch.setattr("truebreak.compare.grids.tradeoffs.computer", lambda: {"cores": 10**6})
    with pytest.raises(SceneError, match="its machine is "):
        Store(path, TradeoffPlan(subjects(["near-tie"]), ("double",)).settings)


def test_a_row_of_one_process_is_not_steady() -> None:
    assert [steady(replace(row("gas", "exact", 1.0), spread=spread)) for spread in (None, 1.0, 1.2)] == [
        False, True, False
    ]  # fmt: skip


def test_rows_survive_json(tmp_path: Path, rows: list[Row]) -> None:
    told = Report(tuple(rows), IDLE)
    jsonschema.Draft202012Validator(schema("bench-5")).validate(told.data())
    back = rows_of(load(written(tmp_path / "a.json", told), "--against"))
    assert [r.data(COLUMNS) for r in back] == [r.data(COLUMNS) for r in rows]
    check_scenes({"near-tie": digest_of(subjects(["near-tie"])[0])}, told.data(), "a.json")
    with pytest.raises(SceneError, match="another one"):
        check_scenes({"near-tie": "0"}, told.data(), "a.json")


def test_the_plot_has_a_point_for_each_row_that_got_to_the_end(rows: list[Row]) -> None:
    drawn = tradeoff_plot(rows)
    ended = [r for r in rows if r.digits is not None]
    engines = {r.engine.partition(":")[0] for r in ended}
    assert drawn.count("<title>") == 1 + len(ended) + len(engines)
    assert drawn.count('fill="#fff">') == sum(not r.front for r in ended)
    assert tradeoff_plot(rows) == drawn
    assert 'class="mark"' not in tradeoff_plot([replace(r, verdict="refused", note="why") for r in rows])


def test_engines_of_like_colours_have_other_marks() -> None:
    """The legend's marks and colours are all different, and exact alone is round."""
    names = ["exact", *(f"engine{k}" for k in range(14))]
    drawn = tradeoff_plot([Row(0, "gas", name, "agree", ratio=1.0, digits=3.0) for name in names])
    looks = re.findall(r' d="([^"]+)" stroke="([^"]+)".*?<title>(\w+)</title>', drawn)
    assert [name for *_, name in looks] == names
    assert len({look[:2] for look in looks}) == len(names)
    assert [name for mark, _, name in looks if mark == CIRCLE] == ["exact"]


def test_page_and_plot_of_the_docs_are_those_of_its_figures(tmp_path: Path) -> None:
    file = DOCS / "tradeoffs.json"
    assert page_main(["--check", str(file)]) == 0, f"run: python docs/studies/tradeoff_page.py docs/{file.name}"
    copy = tmp_path / file.name
    copy.write_text(file.read_text("utf-8"), "utf-8")
    assert page_main(["--check", str(copy)]) == 1
    assert page_main([str(copy)]) == 0
    assert page_main(["--check", str(copy)]) == 0
    copy.with_suffix(".svg").write_text("", "utf-8")
    assert page_main(["--check", str(copy)]) == 1


def test_the_figures_of_the_docs_are_of_the_table_as_it_is() -> None:
    data = load(str(DOCS / "tradeoffs.json"), "report")
    jsonschema.Draft202012Validator(schema("bench-5")).validate(data)
    told = rows_of(data)
    check_scenes({s.name: digest_of(s) for s in SUBJECTS}, data, "docs/tradeoffs.json")
    for subject in SUBJECTS:
        mine = [r for r in told if r.scene == subject.name]
        assert {r.engine for r in mine} >= {"exact", *subject.settings}
        assert [r.front for r in with_front(mine)] == [r.front for r in mine]


def test_words_of_the_command() -> None:
    assert _words(None, None, " gas, cradle ,") == ["gas", "cradle"]  # type: ignore[arg-type]
    assert isinstance(against(report(row("gas", "exact", 1.0)), report(row("gas", "exact", 1.0)).data()), Against)
