"""Ratios of speed measure what they say, in tiny sizes: what they print, not how many seconds they take."""

from __future__ import annotations

import math
import re
from importlib.util import find_spec
from pathlib import Path

import pytest
import speed_ratios
from speed_ratios import BENCHMARKS, GAS, HEAD, TINY, Figure, Target, _agreed, interleaved, main, measured

from truebreak.compare.adapters import adapter as package
from truebreak.exact import ExactEngine
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
    (figure,) = measured([name], TINY)
    if name in OPTIONAL and find_spec(OPTIONAL[name]) is None:
        assert isinstance(figure, str)
        assert "pip install" in figure
        return
    assert isinstance(figure, Figure)
    assert figure.name == name
    assert figure.numerator > 0 < figure.denominator
    assert math.isclose(figure.ratio * figure.denominator, figure.numerator)
    assert " / " in figure.what


def test_billiards_plays_the_same_gas_from_the_start() -> None:
    pytest.importorskip("billiards")
    scene = build(GAS)
    exact = ExactEngine().run(scene, events=50)
    assert speed_ratios.run_billiards(scene, 50) == [event.contacts[0] for event in exact.events]


def test_a_peer_s_answer_is_checked_beside_its_time() -> None:
    pytest.importorskip("billiards")
    (figure,) = measured(["gas-billiards"], TINY)
    assert isinstance(figure, Figure)
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
    ends = speed_ratios.run_perfect_physics(scene, 3)
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
    (figure,) = measured([name], TINY)
    assert isinstance(figure, str) == (name in OPTIONAL)


@pytest.mark.usefixtures("fresh")
def test_missing_packages_are_named_with_the_command_that_installs_them(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(list(OPTIONAL), TINY) == 0
    told = capsys.readouterr()
    assert told.out.strip() == HEAD
    assert [line.partition(":")[0] for line in told.err.splitlines()] == list(OPTIONAL)
    assert "'.[billiards]'" in told.err
    assert "perfect-physics" in told.err


def test_the_command_prints_a_row_of_markdown_for_each_figure(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["gas-double"], TINY) == 0
    shown = capsys.readouterr().out.strip().removeprefix(f"{HEAD}\n")
    assert re.fullmatch(r"\| 10 discs, 5 collisions: exact / double \| [\d.,e+-]+ \|  \|( [\d.e-]+ \|){2}", shown)


def test_a_target_that_is_missed_is_exit_code_1(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    slow = Figure("slow", "this / that", 3.0, 1.0, Target("ratio", "at most", 2))
    monkeypatch.setitem(BENCHMARKS, "slow", lambda size: slow)
    assert main(["slow"], TINY) == 1
    assert "| <= 2: MISSED |" in capsys.readouterr().out


def test_unknown_figures_are_refused_with_a_suggestion(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as stop:
        main(["gas-duoble"])
    assert stop.value.code == 2
    assert "did you mean 'gas-double'" in capsys.readouterr().err


def test_the_table_of_figures_has_none_that_is_not_measured(root: Path) -> None:
    """As many rows as figures, but for one of the two crowds' first events, and those among segments."""
    table = (root / "docs" / "figures.md").read_text("utf-8").partition("| figure | compiled |")[2].partition("\n\n")[0]
    assert len(table.splitlines()) - 2 == len(BENCHMARKS) - 4
