"""H, the tests of bias and of harm, the ensembles of the page on statistics, and its picture."""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np
import pytest
from engine_bias import (
    CELLS,
    LADDER,
    LEVEL,
    QUANTITIES,
    SCENE,
    Ensemble,
    approximate,
    bias,
    certified,
    h_curve,
    h_returned,
    h_value,
    main,
    picture,
    power,
)

from truebreak.compare.engines import engine
from truebreak.exact import ExactEngine
from truebreak.scenarios import SceneError, catalogue

DOCS = Path(__file__).resolve().parents[2] / "docs"


def test_h_is_nothing_in_equilibrium_and_largest_where_all_speeds_are_one() -> None:
    draw = np.random.default_rng(1)
    spread = [(float(x), float(y)) for x, y in draw.normal(0, 3, (40_000, 2))]
    assert 0 <= h_value(spread) < 1e-3
    turned = [(math.cos(k), math.sin(k)) for k in range(100)]
    assert h_value(turned) == pytest.approx(math.log(CELLS))
    assert h_value([(7 * x, 7 * y) for x, y in spread]) == pytest.approx(h_value(spread), abs=1e-3)


def test_h_falls_and_comes_back_in_a_certified_run_and_not_in_few_bits() -> None:
    scene = catalogue.build("echo:rows=5,after=120")
    run = ExactEngine().run(scene)
    curve = h_curve(run, 41)
    assert curve[0][1] == curve[-1][1] == pytest.approx(math.log(CELLS))
    assert min(h for _, h in curve) < 0.5 * math.log(CELLS)
    assert h_returned(run) == 0.0
    assert h_returned(engine("rounded:bits=12").run(scene)) < -0.5


def test_an_ensemble_far_from_the_margin_is_unharmed_and_one_beyond_it_is_not() -> None:
    draw = np.random.default_rng(2)
    exact = Ensemble(tuple(draw.normal(10, 1, 400).tolist()))
    same = Ensemble(tuple(draw.normal(10, 1, 400).tolist()))
    off = Ensemble(tuple(draw.normal(11, 1, 400).tolist()))
    assert bias(exact, same, 1.0).verdict(48) == "unharmed"
    assert bias(exact, off, 0.5).verdict(48) == "biased"
    assert bias(exact, off, 5.0).verdict(48) == "unharmed, biased"
    assert bias(exact, same, 0.05).verdict(48) == "not determined"


def test_lost_runs_are_no_sample() -> None:
    exact = Ensemble(tuple(float(k % 7) for k in range(100)))
    some = Ensemble(tuple(None if k < 6 else float((k + 3) % 7) for k in range(100)))
    told = bias(exact, some, 100.0)
    assert told.lost == 6 and told.verdict(1).startswith("runs lost")
    assert "unharmed" not in told.verdict(1)
    nothing = bias(exact, Ensemble((None,) * 100), 1.0)
    assert math.isnan(nothing.value) and nothing.verdict(1) == "runs lost"


def test_the_levels_of_both_tests_are_kept() -> None:
    """Of ensembles without bias one in twenty is called biased; of such with the margin's, at most one is unharmed."""
    draw = np.random.default_rng(3)
    wrong, harmed = 0, 0
    for _ in range(600):
        exact = Ensemble(tuple(draw.normal(0, 1, 60).tolist()))
        wrong += bias(exact, Ensemble(tuple(draw.normal(0, 1, 60).tolist())), 9.0).p_differs < LEVEL
        harmed += bias(exact, Ensemble(tuple(draw.normal(0.7, 1, 60).tolist())), 0.7).p_harms < LEVEL
    assert 0.02 < wrong / 600 < 0.09
    assert harmed / 600 < 0.09


def test_the_power_is_the_share_of_unbiased_ensembles_that_are_called_unharmed() -> None:
    draw = np.random.default_rng(4)
    exact = Ensemble(tuple(draw.normal(0, 1, 60).tolist()))
    foreseen = power(exact, 0.55, 1)
    seen = [bias(Ensemble(tuple(draw.normal(0, 1, 60).tolist())), Ensemble(tuple(draw.normal(0, 1, 60).tolist())), 0.55)
            for _ in range(400)]  # fmt: skip
    share = sum(told.p_harms < LEVEL for told in seen) / 400
    assert share == pytest.approx(foreseen, abs=0.12)


@pytest.mark.parametrize("quantity", QUANTITIES, ids=lambda q: q.name)
def test_doubles_and_certified_runs_agree_where_runs_are_short(quantity) -> None:
    scenes = quantity.scenes(2)
    exact, events = certified(quantity, scenes)
    assert len(exact.values) == 2 and all(value is not None for value in exact.values)
    other = approximate(quantity, scenes, events, "quad")
    assert other.lost == 0
    if quantity.until is None:
        assert other.values == pytest.approx(exact.values)


def test_a_run_that_sticks_is_lost() -> None:
    quantity = QUANTITIES[2]
    scenes = quantity.scenes(2)
    assert approximate(quantity, scenes, [0, 0], "double").lost == 2


def test_a_run_without_end_is_lost_and_counted_apart() -> None:
    quantity = QUANTITIES[1]
    scenes = [catalogue.build(f"two-in-a-box:seed={seed}") for seed in (2004, 2005)]
    told = approximate(quantity, scenes, [120, 120], "rounded:bits=8")
    assert told.values[1] is None and told.endless == 1
    found = bias(Ensemble((1.0, 1.0)), told, 1.0)
    assert (found.lost, found.endless) == (told.lost, 1)


def test_what_is_not_certified_is_refused() -> None:
    scene = catalogue.build("rack:rows=2").with_changes(until=None)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("engine_bias.ExactEngine", lambda: engine("double"))
        with pytest.raises(SceneError, match="is not certified"):
            certified(QUANTITIES[3], [scene])


def test_the_page_has_the_sizes_and_margins_that_the_programs_have() -> None:
    page = (DOCS / "statistics.md").read_text("utf-8")
    rows = re.findall(r"^\| \d \| .* \| (.*) \| (\d+) %.* \|$", page, re.MULTILINE)
    assert len(rows) == len(QUANTITIES)
    for (scenes, margin), quantity in zip(rows, QUANTITIES, strict=True):
        assert re.search(rf"\b{quantity.count}\b", scenes), quantity.name
        assert float(margin) / 100 == quantity.margin
        if quantity.until is not None:
            assert f"to time {quantity.until}" in scenes
    assert f"all {len(QUANTITIES) * len(LADDER)} tests" in page


def test_the_command_prints_a_table(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--scenes", "2", "--only", "5", "--engines", "rounded:bits=8,double"]) == 0
    told = capsys.readouterr().out
    assert "| rounded:bits=8 |" in told and "| double | +0 | 0 | 0 | unharmed |" in told


def test_the_command_puts_rows_into_the_page(tmp_path: Path) -> None:
    """One row of a whole ensemble: the page has it, and nothing else moves."""
    page = tmp_path / "statistics.md"
    whole = (DOCS / "statistics.md").read_text("utf-8")
    page.write_text(re.sub(r"^\| single .*\n", "", whole, flags=re.MULTILINE), "utf-8")
    assert main(["--only", "4", "--engines", "single", "--page", str(page)]) == 0
    missing = [line for line in whole.splitlines() if line.startswith("| single ")]
    assert len(missing) == len(QUANTITIES)
    expected = whole
    for k, line in enumerate(missing, 1):
        expected = expected if k == 4 else expected.replace(f"{line}\n", "", 1)
    assert page.read_text("utf-8") == expected


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--page", "x.md", "--scenes", "3"], "its own numbers of starts"),
        (["--page", "x.md", "--engines", "quad"], "its own ladder"),
        (["--only", "7"], "invalid choice: 7"),
        (["--only", "5", "--scenes", "2", "--engines", "doubel"], "doubel"),
    ],
)
def test_what_cannot_be_measured_is_refused(arguments: list[str], words: str, capsys) -> None:
    with pytest.raises(SystemExit) as stop:
        main(arguments)
    assert stop.value.code == 2
    assert words in capsys.readouterr().err


def test_the_picture_of_the_page_is_current() -> None:
    text, told = picture(catalogue.build(SCENE))
    assert (DOCS / "echo.svg").read_text("utf-8") == text
    assert told["exact"] == 0.0
    assert told["double"] < -1.5 and told["single"] < -1.5
