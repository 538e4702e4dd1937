"""A sweep's pictures, tables, uncertainty, and a real Dask cluster."""

from __future__ import annotations

import gc
import json
import subprocess
import sys
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import jsonschema
import pytest

from truebreak.compare.cli import main
from truebreak.compare.grids import executors
from truebreak.compare.grids.executors import do, executor_named
from truebreak.compare.grids.family_sweep import COLUMNS, SweepJob, SweepWarning, sweep
from truebreak.compare.grids.row import Row
from truebreak.compare.grids.store import Store
from truebreak.compare.grids.survival import ChangedShare, proportion, slope, summaries, uncertainty
from truebreak.compare.picture import engine_styles
from truebreak.compare.report.pictures.sweep_figures import (
    plot_changed,
    plot_law,
    plot_survival,
    to_pandas,
    write_parquet,
)
from truebreak.compare.report.pictures.sweep_plots import law_svg, survival_svg
from truebreak.compare.report.schema import schema
from truebreak.scenarios import SceneError


def call(arguments: list[str]) -> int:
    with pytest.raises(SystemExit) as stop:
        main(arguments)
    return int(stop.value.code or 0)


@pytest.fixture(scope="module")
def rows() -> Store:
    with ThreadPoolExecutor(1) as one:
        return sweep("gas:n=3", ["seed=1..5"], ["single", "double"], events=110, outcomes=["collisions"], executor=one,
                     forecast=True)  # fmt: skip


# -- pictures


def test_the_plot_of_survival_has_the_steps_of_the_estimate(rows: Store) -> None:
    pytest.importorskip("matplotlib")
    ax = plot_survival(rows)
    told = summaries(rows)
    assert [line.get_label() for line in ax.get_lines()] == ["single", "double"]
    for line, summary in zip(ax.get_lines(), told, strict=True):
        assert list(line.get_xdata()) == [0, *(s.event for s in summary.survival)]
        assert list(line.get_ydata()) == [1.0, *(s.share for s in summary.survival)]


def test_plots_draw_on_the_axes_that_they_are_given(rows: Store) -> None:
    pytest.importorskip("matplotlib")
    from matplotlib.figure import Figure

    for draw in (plot_survival, plot_law, plot_changed):
        ax = Figure().add_subplot()
        assert draw(rows, ax) is ax
        assert ax.has_data()


def test_the_plot_of_the_law_has_its_line_and_a_point_for_each_scene(rows: Store) -> None:
    pytest.importorskip("matplotlib")
    ax = plot_law(rows)
    for summary, points, line in zip(summaries(rows), ax.collections, ax.get_lines(), strict=True):
        assert summary.law is not None and summary.law.scenes == len(points.get_offsets())
        (x0, x1), (y0, y1) = line.get_xdata(), line.get_ydata()
        assert (y1 - y0) / (x1 - x0) == pytest.approx(summary.law.slope)


def test_the_plot_of_outcomes_has_exact_intervals(rows: Store) -> None:
    pytest.importorskip("matplotlib")
    ax = plot_changed(rows)
    for summary, bar in zip(summaries(rows), ax.containers, strict=True):
        assert summary.changed is not None
        low, high = proportion(*summary.changed[:2])
        (segment,) = bar.lines[2][0].get_segments()
        assert sorted(y for _, y in segment) == pytest.approx([low, high], abs=1e-12)


def test_svg_needs_no_matplotlib(rows: Store, tmp_path: Path) -> None:
    for text in (survival_svg(summaries(rows)), law_svg(rows, summaries(rows))):
        root = ElementTree.fromstring(text)
        assert root.tag.endswith("svg")
        assert "single" in text and "double" in text
    assert law_svg(rows, summaries(rows)).count('class="dot') == sum(row.event is not None for row in rows)
    code = "import sys; import truebreak.compare.report.pictures.sweep_plots; assert 'matplotlib' not in sys.modules"
    subprocess.run([sys.executable, "-P", "-c", code], check=True)
    file = tmp_path / "s.svg"
    assert call(["sweep", "gas:n=2", "--vary", "seed=1..2", "--events", "20", "--jobs", "1", "--svg", str(file)]) == 0
    assert ElementTree.parse(file).getroot().tag.endswith("svg")


def test_any_number_of_engines_is_told_apart_and_no_label_is_cut(rows: Store) -> None:
    """Each has one class in curve, points and legend, whose style is the report's; the legend is inside the picture."""
    names = [f"pymunk:dt=1/{2**k},iterations={10**k}" for k in range(18)]
    many = [replace(row, engine=name) for name in names for row in rows if row.engine == "double"]
    for text in (survival_svg(summaries(many)), law_svg(many, summaries(many))):
        root = ElementTree.fromstring(text)
        labels = {e.text: e for e in root.iter() if e.tag.endswith("}text") and e.text in names}
        assert list(labels) == names
        wide, tall = float(root.get("width", "")), float(root.get("height", ""))
        for name, label in labels.items():
            assert float(label.get("x", "")) + 6 * len(name) < wide
            assert float(label.get("y", "")) < tall
        for k, style in enumerate(engine_styles(names)):
            assert f".e{k} {{ stroke: {style.light}; stroke-dasharray: {style.dash}; }}" in text
            assert f'class="series e{k}"' in text
    clouds = [e for e in root.iter() if str(e.get("class")).startswith("dot e")]
    assert len(clouds) == sum(row.event is not None for row in many)


# -- tables


def test_pandas_and_parquet_have_the_rows(rows: Store, tmp_path: Path) -> None:
    pandas, _ = pytest.importorskip("pandas"), pytest.importorskip("pyarrow")
    frame = to_pandas(rows)
    assert list(frame.columns) == [c if c != "parameters" else "seed" for c in COLUMNS]
    assert list(frame["event"]) == [row.event for row in rows]
    assert json.loads(frame["work"][0]) == rows[0].work
    write_parquet(rows, tmp_path / "t.parquet")
    again = pandas.read_parquet(tmp_path / "t.parquet")
    pandas.testing.assert_frame_equal(again, frame)
    assert [path.name for path in tmp_path.iterdir()] == ["t.parquet"]
    with pytest.raises(SceneError, match="choose another place"):
        write_parquet(rows, tmp_path / "nowhere" / "t.parquet")


# -- uncertainty


def test_the_exponent_is_that_of_the_shares() -> None:
    shares = [ChangedShare(10.0**-k, round(4000 * 10 ** (-0.3 * k)), 4000, 0, 1) for k in range(1, 6)]
    value, low, high = slope(shares)
    assert value == pytest.approx(0.3, abs=0.01)
    assert low is not None and high is not None and low < 0.3 < high
    assert slope(shares[:2]) == (None, None, None)
    assert slope([ChangedShare(1.0, 5, 5, 0, 1)] * 4) == (None, None, None)


def test_where_most_scenes_change_already_the_line_is_not_drawn() -> None:
    """Shares that reach all, as they must, and fall as a power before that."""
    small = [ChangedShare(10.0**-k, round(6000 * 10 ** (1.2 - 0.4 * k)), 6000, 0, 1) for k in range(5, 9)]
    large = [ChangedShare(10.0**-k, count, 6000, 0, 1) for k, count in ((2, 5999), (3, 5900), (4, 4000))]
    assert slope([*small, *large]) == slope(small)
    assert slope(small)[0] == pytest.approx(0.4, abs=0.01)


def test_larger_displacements_change_more_outcomes() -> None:
    with ThreadPoolExecutor(1) as one:
        told = sweep("three-disc:distance=5/2", ["seed=1..30"], [], perturb=["1/3", "1/30", "1/300"],
                     outcomes=["collisions"], executor=one)  # fmt: skip
    found = uncertainty(told, "collisions")
    assert [share.size for share in found.shares] == pytest.approx([1 / 300, 1 / 30, 1 / 3])
    counts = [share.count for share in found.shares]
    assert counts == sorted(counts) and counts[0] < counts[-1]
    assert all(share.total == 30 and share.low <= share.count / 30 <= share.high for share in found.shares)
    brute = {r.index for r in told if r.engine == "perturbed:1/3" and "collisions" in (r.changed or ())}
    assert len(brute) == counts[-1]


def test_the_command_tells_the_exponent(capsys: pytest.CaptureFixture[str]) -> None:
    line = ["sweep", "three-disc:distance=5/2", "--vary", "seed=1..40", "--engines", "double", "--outcome",
            "collisions", "--jobs", "1"]  # fmt: skip
    line += [word for size in ("1/20", "1/60", "1/200") for word in ("--perturb", size)]
    assert call([*line, "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    jsonschema.Draft202012Validator(schema("sweep-2")).validate(data)
    told = data["uncertainty"]["collisions"]
    assert told["exponent"] == pytest.approx(slope([ChangedShare(**share) for share in told["shares"]])[0])
    assert call(line) == 0
    assert "goes as d**a" in capsys.readouterr().out


# -- executors


class Leaver:
    """Notes in a file that it has gone."""

    def __init__(self, path: Path) -> None:
        self._path, self._self = path, self

    def __del__(self) -> None:
        self._path.write_text("collected", "utf-8")


def test_a_worker_does_not_look_for_garbage_as_it_ends(tmp_path: Path) -> None:
    with executors.pool(1) as workers:
        assert workers.submit(_leaves, tmp_path / "gone").result() > 700
    assert not (tmp_path / "gone").exists()


def _leaves(path: Path) -> int:
    """Leaves something in a circle to the collector, and says how seldom that looks."""
    Leaver(path)
    return gc.get_threshold()[0]


def test_jobs_in_threads_of_one_process_do_not_change_each_other() -> None:
    """Balls have one precision for a process; a lock keeps jobs apart."""
    args: dict[str, Any] = {"events": 100}
    with ThreadPoolExecutor(1) as one, ThreadPoolExecutor(4) as four:
        alone = sweep("gas:n=3", ["seed=1..6"], ["double"], executor=one, **args)
        together = sweep("gas:n=3", ["seed=1..6"], ["double"], executor=four, **args)
    assert alone == together


def test_the_lock_is_held_while_a_job_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[bool] = []
    monkeypatch.setattr(SweepJob, "rows", lambda job: seen.append(executors.ONE_AT_A_TIME.locked()) or [])
    do(SweepJob(0, "lee", {}, ("double",)))
    assert seen == [True] and not executors.ONE_AT_A_TIME.locked()


@pytest.fixture(scope="module")
def cluster() -> Iterator[str]:
    distributed = pytest.importorskip("distributed")
    local = distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None, host="127.0.0.1"
    )
    try:
        yield local.scheduler_address.replace("tcp://", "dask://")
    finally:
        local.close()


def test_a_dask_cluster_makes_the_same_table(cluster: str, rows: Store, tmp_path: Path) -> None:
    with executor_named(cluster) as (executor, slots):
        assert slots == 2
        told = sweep("gas:n=3", ["seed=1..5"], ["single", "double"], events=110, outcomes=["collisions"],
                     executor=executor, jobs=slots, forecast=True)  # fmt: skip
    assert told == rows
    here, there = tmp_path / "here.csv", tmp_path / "there.csv"
    line = ["sweep", "gas:n=2", "--vary", "seed=1..6", "--events", "30", "--csv"]
    assert call([*line, str(there), "--executor", cluster]) == 0
    assert call([*line, str(here), "--jobs", "1"]) == 0
    assert here.read_bytes() == there.read_bytes()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["gas", "--executor", "spark://a:1"], "is not dask://HOST:PORT"),
        (["gas", "--executor", "dask://a"], "is not dask://HOST:PORT"),
        (["gas", "--executor", "dask://127.0.0.1:1", "--jobs", "2"], "leave --jobs out"),
        (["--store", "x.db", "--executor", "dask://127.0.0.1:1"], "give a SCENE"),
        (["gas", "--svg", "/nowhere/s.svg"], "no folder"),
    ],
)
def test_bad_input_is_one_line(arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert call(["sweep", *arguments]) == 2
    error = capsys.readouterr().err
    assert message in error and len(error.splitlines()) == 1


def test_no_scheduler_is_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("distributed")
    monkeypatch.setattr("truebreak.compare.grids.executors.PATIENCE", 1)
    with pytest.raises(SceneError, match="no scheduler answers"), executor_named("dask://127.0.0.1:9"):
        pass


# -- in a script

SCRIPT = """\
from truebreak.compare.grids.family_sweep import sweep
{guard}rows = sweep("gas:n=3", ["seed=1..2"], ["single"], events=5, jobs=1)
{guard}print(len(rows))
"""


@pytest.mark.parametrize("guard", ["", "if __name__ == '__main__': "])
def test_a_script_without_its_guard_is_told_what_to_write(guard: str, tmp_path: Path) -> None:
    """In one error, by the parent alone: no worker says anything."""
    script = tmp_path / "mine.py"
    script.write_text(SCRIPT.format(guard=guard), "utf-8")
    done = subprocess.run([sys.executable, str(script)], capture_output=True, text=True, check=False)
    if guard:
        assert (done.returncode, done.stdout, done.stderr) == (0, "2\n", "")
        return
    assert (done.returncode, done.stdout) == (1, "")
    assert done.stderr.count("Traceback") == 1
    last = done.stderr.splitlines()[-1]
    assert last.startswith("truebreak.scenarios.errors.SceneError: sweep: no worker process can be started; each")
    assert '`if __name__ == "__main__":`' in last


def test_scenes_that_come_to_nothing_are_warned_of(monkeypatch: pytest.MonkeyPatch) -> None:
    """Rows that are not there would else be missed by nobody."""

    real = SweepJob.rows

    def dying(job: SweepJob) -> list[Row]:
        if job.index == 1:
            raise MemoryError("too much")
        return real(job)

    monkeypatch.setattr(SweepJob, "rows", dying)
    with (
        ThreadPoolExecutor(1) as one,
        pytest.warns(SweepWarning, match="1 scene came to nothing.*scene 1: MemoryError"),
    ):
        rows = sweep("gas:n=3", ["seed=1..3"], ["single"], events=5, executor=one)
    assert [row.index for row in rows] == [0, 2]
