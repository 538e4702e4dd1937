"""Sweeps: families, rows, statistics, and the command."""

from __future__ import annotations

import csv
import io
import json
import math
from collections.abc import Iterator
from concurrent.futures import Executor, ThreadPoolExecutor
from pathlib import Path

import jsonschema
import numpy as np
import pytest

from truebreak.compare import compare
from truebreak.compare.cli import main
from truebreak.compare.grids.family_sweep import COLUMNS, SweepJob, sweep
from truebreak.compare.grids.row import Row
from truebreak.compare.grids.scene_family import Perturbed, displaced, family, shard_of, varied
from truebreak.compare.grids.survival import fitted, proportion, summaries, survival
from truebreak.compare.report.schema import schema
from truebreak.scenarios import Circle, Quantity, Scene, SceneError, catalogue

GAS = ["gas:n=3", "--vary", "seed=1..6", "--engines", "single,double", "--events", "60"]


def rows_of(job: SweepJob) -> list[Row]:
    return job.rows()


def call(arguments: list[str]) -> int:
    with pytest.raises(SystemExit) as stop:
        main(arguments)
    return int(stop.value.code or 0)


@pytest.fixture
def thread() -> Iterator[Executor]:
    with ThreadPoolExecutor(1) as executor:
        yield executor


# -- families


def test_a_grid_has_the_last_parameter_fastest_and_builds_nothing() -> None:
    told = family("gas:mixed=yes", ["n=3..20", "seed=1..1000000"])
    assert len(told) == 18_000_000
    assert told.spec(0) == "gas:mixed=yes,n=3,seed=1"
    assert told.spec(1_000_001) == "gas:mixed=yes,n=4,seed=2"
    assert told.spec(len(told) - 1) == "gas:mixed=yes,n=20,seed=1000000"


@pytest.mark.parametrize("shards", [1, 3, 7, 40])
def test_shards_share_the_scenes_out(shards: int) -> None:
    told = family("gas", ["n=3..5", "seed=1..9"])
    parts = [list(told.indices((k, shards))) for k in range(1, shards + 1)]
    assert sorted(index for part in parts for index in part) == list(range(27))


@pytest.mark.parametrize(
    ("scene", "vary", "message"),
    [
        ("gas", ["m=1..3"], "has no parameter 'm'"),
        ("gas", ["sed=1..3"], "did you mean 'seed'?"),
        ("gas", ["n=5..3"], "the range is empty, as 3 is below 5"),
        ("gas", ["n=1..9:0"], "a step of 0"),
        ("gas", ["n"], "is not KEY=VALUES"),
        ("gas", ["n=1.."], "is no range and no list"),
        ("gas", ["n=1,,2"], "is no range and no list"),
        ("gas", ["n=1,1"], "a value comes twice"),
        ("gas", ["n=0..3"], "n = '0': must be a whole number from 1 to 10000"),
        ("gas:n=3", ["n=4..5"], "n is set twice"),
        ("gas", ["n=3..4", "n=5..6"], "n is set twice"),
        ("lee", ["k=1..2"], "has no parameter 'k'"),
        ("gaz", ["n=3..4"], "is no catalogue scene"),
        ("gaz", [], "did you mean 'gas'?"),
    ],
)
def test_a_bad_family_is_refused(scene: str, vary: list[str], message: str) -> None:
    with pytest.raises(SceneError, match=message.replace("(", r"\(").replace("?", r"\?")):
        family(scene, vary)


@pytest.mark.parametrize("text", ["0/3", "4/3", "3", "1/0", "a/b", "-1/2"])
def test_a_bad_shard_is_refused(text: str) -> None:
    with pytest.raises(SceneError, match="is not K/N"):
        shard_of(text)


def test_a_range_may_have_a_step() -> None:
    assert list(varied("seed=0..90:30").values) == [0, 30, 60, 90]
    assert varied("seed=0..90:30").text() == "seed=0..90:30"
    assert varied("gap=0, 1/10").text() == "gap=0,1/10"


# -- rows


@pytest.mark.parametrize("spec", ["gas:n=4,seed=3", "lorentz", "rack:rows=2,gap=1/50", "near-tie:k=40", "cradle:n=3"])
def test_a_row_says_what_a_comparison_over_the_whole_run_says(spec: str) -> None:
    """Though engines are run no further than it takes to see them leave."""
    engines = ("double", "interval", "pymunk:dt=1/64")
    found = compare(catalogue.build(spec), engines, events=80, causes=False)
    for row in rows_of(SweepJob(0, spec, {}, engines, 80)):
        candidate = found[row.engine]
        assert row.verdict == candidate.verdict
        divergence = candidate.alignment.divergence
        assert row.event == (None if divergence is None else divergence.event)
        if divergence is not None:
            assert (row.at, row.body, row.expected, row.got) == (
                divergence.time, divergence.body, divergence.expected, divergence.got)  # fmt: skip


def test_outcomes_are_compared_over_the_whole_run() -> None:
    spec = "gas:n=4,seed=3"
    found = compare(catalogue.build(spec), ["double"], events=150, causes=False)["double"]
    (row,) = rows_of(SweepJob(0, spec, {}, ("double",), 150, ("collisions", "who_hit_whom", "moved")))
    assert row.changed == [n for n in ("collisions", "who_hit_whom", "moved") if n in found.changed]
    assert row.changed


@pytest.mark.parametrize("audit", [True, False])
@pytest.mark.parametrize(
    ("spec", "cause"),
    [("near-tie:k=40", "input rounding"), ("gas:seed=14", "arithmetic rounding"), ("lorentz", "arithmetic in flights")],
)
def test_causes_are_those_of_a_comparison(spec: str, cause: str, audit: bool) -> None:
    """With the audit of the run: without one, what its own steps miss may be another law."""
    (row,) = rows_of(SweepJob(0, spec, {}, ("double",), None, (), True, audit=audit))
    found = compare(catalogue.build(spec), ["double"])["double"]
    assert found.diagnosis is not None and found.diagnosis.name.value == cause
    assert row.cause == cause
    assert row.margin is not None
    assert (row.laws is None) is not audit


def test_what_cannot_be_run_is_a_row() -> None:
    (row,) = rows_of(SweepJob(0, "gas:n=50,size=10", {"n": "50"}, ("double",)))
    assert (row.verdict, row.digest) == ("refused", None)
    assert "no room for disc" in row.note


def test_a_scene_without_a_tangent_map_has_no_horizon_and_a_verdict() -> None:
    (row,) = rows_of(SweepJob(0, "lee", {}, ("double",), forecast=True))
    assert row.lyapunov is None and row.predicted is None
    assert row.verdict == "agree"


def test_a_displaced_scene_leaves_the_later_the_less_it_is_displaced() -> None:
    labels = ("perturbed:1e-6", "perturbed:1e-12", "perturbed:10**-40")
    rows = rows_of(SweepJob(0, "gas:n=4", {}, labels, 200, forecast=True))
    events = [row.event for row in rows]
    assert events[0] < events[1] < (events[2] or 200)
    assert all(row.by_exponent > 0 for row in rows)


def test_a_displacement_is_of_the_size_asked_for_and_drawn_from_its_seed() -> None:
    scene = catalogue.build("lorentz")
    size = Quantity.of("10**-9")
    near = displaced(scene, size, 3)
    assert near.circles[1:] == scene.circles[1:]  # fixed
    assert 0 < abs(float(near.circles[0].x - scene.circles[0].x)) <= 1e-9
    assert displaced(scene, size, 3) == near != displaced(scene, size, 4)
    with pytest.raises(SceneError, match="overlaps"):
        for seed in range(20):
            displaced(Scene([Circle(0, 0), Circle(2, 0)]), Quantity.of(1), seed)
    with pytest.raises(SceneError, match="above zero"):
        Perturbed(Quantity.of(0))


def test_rows_are_the_same_text_each_time() -> None:
    job = SweepJob(5, "gas:n=3", {}, ("double", "pymunk", "perturbed:1e-9"), 60, forecast=True)
    assert [row.text() for row in rows_of(job)] == [row.text() for row in rows_of(job)]


# -- statistics


def test_survival_is_that_of_a_known_law() -> None:
    """Exponential departures at rate 1/20 an event, a third of them censored at random."""
    draw = np.random.default_rng(3)
    left, censored = draw.exponential(20, 3000), draw.exponential(40, 3000)
    told = survival([(int(min(a, b)), bool(a <= b)) for a, b in zip(left, censored, strict=True)])
    for event in (5, 10, 20, 40):
        step = [s for s in told if s.event <= event][-1]
        assert step.share == pytest.approx(math.exp(-(event + 1) / 20), abs=0.02)
        assert step.low < step.share < step.high


def test_a_summary_counts_what_was_audited_and_what_left_with_a_prediction() -> None:
    """One kept, two broken, three not determined, four not audited; an exponent without a departure is no point."""
    laws = [{"kept": kept, "finding": ""} for kept in (True, False, False, None, None, None)] + [None] * 4
    rows = [
        Row(k, "gas", "double", "diverged", agreed=3, event=3 + k, at=1.0 + k, by_exponent=2.0 + k, laws=each)
        for k, each in enumerate(laws)
    ]
    rows += [
        Row(10, "gas", "double", "agree", agreed=9, by_exponent=5.0),
        Row(11, "gas", "double", "diverged", agreed=3, event=3, at=1.0),
    ]
    (told,) = summaries(rows)
    assert told.laws == (1, 2, 3)
    assert told.law is not None
    assert (told.law.scenes, told.law.slope) == (10, pytest.approx(1.0))
    assert told.verdicts == {"agree": 1, "diverged": 11}


def test_survival_without_departures_is_whole() -> None:
    assert survival([(10, False), (20, False)]) == []


def test_the_interval_of_a_share_holds_it_in_nineteen_of_twenty_and_more() -> None:
    """By counting all that can come out: exact intervals are never too narrow."""
    for total, share in ((60, 0.3), (200, 0.1), (25, 0.5), (9, 0.97), (40, 0.002)):
        held = 0.0
        for count in range(total + 1):
            low, high = proportion(count, total)
            if low <= share <= high:
                held += math.comb(total, count) * share**count * (1 - share) ** (total - count)
        assert held >= 0.95
    for total in (1, 5, 9, 100):
        assert proportion(0, total) == pytest.approx((0, 1 - 0.025 ** (1 / total)))
        assert proportion(total, total) == pytest.approx((0.025 ** (1 / total), 1))
    for count, total in ((3, 17), (1, 40), (39, 40)):  # each end leaves a fortieth of what can come out
        low, high = proportion(count, total)
        tail = sum(math.comb(total, k) * low**k * (1 - low) ** (total - k) for k in range(count, total + 1))
        head = sum(math.comb(total, k) * high**k * (1 - high) ** (total - k) for k in range(count + 1))
        assert (tail, head) == pytest.approx((0.025, 0.025))


def test_survival_without_censoring_has_the_interval_of_a_share() -> None:
    steps = survival([(event, True) for event in (1, 1, 2, 3, 5, 8)])
    for step, left in zip(steps, (4, 3, 2, 1, 0), strict=True):
        assert (step.share, step.low, step.high) == pytest.approx((left / 6, *proportion(left, 6)))


def test_the_interval_of_survival_holds_it_in_nineteen_of_twenty() -> None:
    """Scenes that leave at random times, some lost from sight before: early, in the middle, late."""
    draw, held, runs = np.random.default_rng(5), np.zeros(3), 400
    for _ in range(runs):
        leave, lost = draw.geometric(0.1, 30), draw.geometric(0.04, 30)
        steps = survival([(int(min(a, b)), bool(a <= b)) for a, b in zip(leave, lost, strict=True)])
        for place, event in enumerate((2, 8, 20)):
            step = max((s for s in steps if s.event <= event), key=lambda s: s.event, default=None)
            low, high = (1 - 0.025 ** (1 / 30), 1.0) if step is None else (step.low, step.high)
            held[place] += low <= 0.9**event <= high or step is None
    assert (held / runs >= 0.93).all(), held


def test_the_line_is_that_of_least_squares() -> None:
    draw = np.random.default_rng(11)
    xs = draw.uniform(0, 9, 40)
    ys = 1.5 * xs + 2 + draw.normal(0, 1, 40)
    law = fitted(list(zip(xs.tolist(), ys.tolist(), strict=True)))
    assert law is not None
    slope, intercept = np.polyfit(xs, ys, 1)
    assert (law.slope, law.intercept) == pytest.approx((slope, intercept))
    assert law.correlation == pytest.approx(np.corrcoef(xs, ys)[0, 1])
    assert fitted([(1.0, 1.0), (1.0, 2.0), (1.0, 3.0)]) is None


def test_the_time_of_divergence_follows_the_logarithm_of_the_error(thread: Executor) -> None:
    """Over displacements from 1e-4 to 1e-16 of one gas: t = a ln(1/eps)/lambda + b with a about 1."""
    sizes = [f"1e-{k}" for k in range(4, 17, 2)]
    told = sweep("gas:n=6", ["seed=1..3"], [], perturb=sizes, events=220, forecast=True, executor=thread)
    law = fitted([(row.by_exponent, row.at) for row in told if row.at is not None])
    assert law is not None
    assert law.scenes >= 18
    assert law.correlation > 0.85
    assert 0.7 < law.slope < 1.3


def test_what_is_undecided_or_agrees_is_censored(thread: Executor) -> None:
    told = sweep("gas:n=3", ["seed=1..3"], ["interval", "double"], events=60, executor=thread)
    interval, double = summaries(told)
    assert interval.verdicts == {"undecided": 3}
    assert interval.survival == () and interval.median is None
    assert sum(double.verdicts.values()) == 3


# -- the command


def test_the_command_runs_stores_and_reads(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    store, table = str(tmp_path / "s.db"), tmp_path / "t.csv"
    assert call(["sweep", *GAS, "--store", store, "--jobs", "1", "--csv", str(table), "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    jsonschema.Draft202012Validator(schema("sweep-2")).validate(data)
    assert data["scenes"] == 6
    assert call(["sweep", "--store", store, "--csv", "-"]) == 0
    told = capsys.readouterr().out
    assert told == table.read_text("utf-8")
    read = list(csv.DictReader(io.StringIO(told)))
    assert [(row["seed"], row["engine"]) for row in read[:3]] == [("1", "single"), ("1", "double"), ("2", "single")]
    assert len(read) == 12
    assert list(read[0]) == [column if column != "parameters" else "seed" for column in COLUMNS]
    assert call(["sweep", "--store", store]) == 0
    assert "6 scenes" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["gas", "--vary", "m=1..3"], "has no parameter 'm'"),
        (["gas", "--vary", "n=3..1"], "the range is empty"),
        (["gas", "--vary", "seed=1..1000000000"], "1,000,000,000 scenes are to be run; add --yes"),
        (["gas", "--engines", "dobule"], "did you mean 'double'?"),
        (["gas", "--engines", "double,double"], "named twice"),
        (["gas", "--perturb", "0"], "must be above zero"),
        (["gas", "--perturb", "x"], "is not an exact number"),
        (["gas", "--outcome", "colisions"], "did you mean 'collisions'?"),
        (["gas", "--shard", "3/2"], "is not K/N"),
        (["gas", "--csv", "/nowhere/t.csv"], "no folder"),
        (["gas", "--csv", "-", "--json"], "both want stdout"),
        (["gas", "--store", "a", "--store", "b"], "give one --store"),
        (["--store", "/nowhere.db"], "there is no such file"),
        ([], "give a SCENE to run, or a --store to read"),
    ],
)
def test_bad_input_is_one_line_and_exit_code_2(
    arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert call(["sweep", *arguments]) == 2
    error = capsys.readouterr().err
    assert message in error
    assert len(error.splitlines()) == 1
