"""Benchmarks measure what they say, in tiny sizes: what they print, not how many seconds they take."""

from __future__ import annotations

import json
import math
from importlib.util import find_spec

import click
import jsonschema
import pytest

from truebreak.compare.adapters import adapter as package
from truebreak.compare.bench import command as bench
from truebreak.compare.bench.command import TRADEOFFS, measure
from truebreak.compare.bench.ratios import rivals
from truebreak.compare.bench.ratios.figures import GAS, TINY, Figure, Target, _agreed, interleaved
from truebreak.compare.bench.ratios.table import BENCHMARKS
from truebreak.compare.documents.schemas import schema
from truebreak.exact import ExactEngine
from truebreak.scenarios import SceneError
from truebreak.scenarios.catalogue import build

OPTIONAL = {
    "gas-billiards": "billiards",
    "double-billiards": "billiards",
    "gas-long-billiards": "billiards",
    "crowd-exact": "billiards",
    "crowd-double": "billiards",
    "galperin-perfect-physics": "perfect_physics",
}
"""The benchmarks that need an extra, with the package that it brings."""


@pytest.mark.parametrize(
    ("bound", "value", "met"),
    [("at most", 3, True), ("at most", 1, False), ("at least", 1, True), ("at least", 3, False)],
)
def test_target_is_met_on_its_own_side(bound: str, value: float, met: bool) -> None:
    figure = Figure("x", "this / that", 4.0, 2.0, Target("ratio", bound, value))  # type: ignore[arg-type]
    assert figure.met is met


def test_target_in_seconds_regards_the_numerator() -> None:
    assert Figure("x", "this / that", 4.0, 1.0, Target("seconds", "at most", 4)).met is True
    assert Figure("x", "this / that", 4.0, 1.0).met is None


def test_repeats_are_interleaved_and_a_slow_first_runs_once() -> None:
    calls: list[str] = []
    interleaved(lambda: calls.append("a"), lambda: calls.append("b"), 2)
    assert calls == ["a", "b", "a", "b"]
    calls.clear()
    interleaved(lambda: calls.append("a"), lambda: calls.append("b"), 3, once=True)
    assert calls == ["a", "b", "b", "b"]


@pytest.mark.parametrize("name", BENCHMARKS)
def test_every_figure_is_a_positive_ratio_or_says_what_to_install(name: str) -> None:
    report = measure(TINY, only=[name])
    if name in OPTIONAL and find_spec(OPTIONAL[name]) is None:
        assert "pip install" in report.skipped[name]
        return
    (figure,) = report.figures
    assert figure.name == name
    assert figure.numerator > 0 < figure.denominator
    assert math.isclose(figure.ratio * figure.denominator, figure.numerator)
    assert " / " in figure.what


def test_billiards_plays_the_same_gas_from_the_start() -> None:
    pytest.importorskip("billiards")
    scene = build(GAS)
    exact = ExactEngine().run(scene, events=50)
    assert rivals.run_billiards(scene, 50) == [event.contacts[0] for event in exact.events]


def test_a_peer_s_answer_is_checked_beside_its_time() -> None:
    pytest.importorskip("billiards")
    (figure,) = measure(TINY, only=["gas-billiards"]).figures
    assert figure.answer == "billiards has all of 5 collisions in order"


def test_a_wrong_answer_of_a_peer_is_told() -> None:
    scene = build(GAS)
    right = [event.contacts[0] for event in ExactEngine().run(scene, events=4).events]
    assert _agreed("it", scene, right) == "it has all of 4 collisions in order"
    wrong = [*right[:2], right[0], right[3]]
    assert _agreed("it", scene, wrong) == "it has the first 2 of 4 collisions in order"


def test_perfect_physics_ends_with_the_same_exact_velocities() -> None:
    pytest.importorskip("perfect_physics")
    scene = build("galperin:n=0")
    exact = ExactEngine().run(scene, events=3).final
    ends = rivals.run_perfect_physics(scene, 3)
    assert [float(vx) for vx, _ in ends] == [float(circle.vx) for circle in exact.circles]


@pytest.fixture
def fresh(monkeypatch: pytest.MonkeyPatch) -> None:
    """A machine without any extra."""

    def missing(name: str) -> None:
        raise ModuleNotFoundError(name)

    monkeypatch.setattr(package, "import_module", missing)


@pytest.mark.usefixtures("fresh")
@pytest.mark.parametrize("name", BENCHMARKS)
def test_every_benchmark_that_needs_an_extra_is_listed(name: str) -> None:
    assert ({*measure(TINY, only=[name]).skipped} == {name}) == (name in OPTIONAL)


@pytest.mark.usefixtures("fresh")
def test_missing_packages_are_named_with_the_command_that_installs_them(capsys: pytest.CaptureFixture[str]) -> None:
    report, _ = bench.run(only=list(OPTIONAL), size=TINY)
    assert report.figures == ()
    assert set(report.skipped) == set(OPTIONAL)
    notes = capsys.readouterr().err
    assert "'.[billiards]'" in notes
    assert "perfect-physics" in notes


def test_json_is_one_object_on_stdout(capsys: pytest.CaptureFixture[str]) -> None:
    bench.run(as_json=True, only=["gas-double"], size=TINY)
    data = json.loads(capsys.readouterr().out)
    jsonschema.Draft202012Validator(schema("bench-2")).validate(data)
    (figure,) = data["figures"]
    assert figure["name"] == "gas-double"
    assert data["tradeoffs"] == []


def test_tables_show_each_figure(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setenv("COLUMNS", "200")
    bench.run(only=["gas-double"], size=TINY)
    assert "exact / double" in capsys.readouterr().out


def test_unknown_figures_are_refused_with_a_suggestion() -> None:
    with pytest.raises(SceneError, match="did you mean 'gas-double'"):
        measure(TINY, only=["gas-duoble"])


def test_help_names_every_figure(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(click.exceptions.Exit) as stop:
        bench.main(["--help"])
    assert stop.value.exit_code == 0
    shown = capsys.readouterr().out
    assert all(name in shown for name in (*BENCHMARKS, TRADEOFFS))
