"""Causes and margins of divergences, on scenes whose cause is known beforehand."""

from __future__ import annotations

import pytest

from truebreak.compare import compare
from truebreak.compare.causes.decision.rounding import rounded
from truebreak.compare.causes.diagnosis import CauseName
from truebreak.compare.comparison import Comparison
from truebreak.scenarios import Circle, Scene, SceneError, catalogue


def cause(comparison: Comparison, engine: str) -> CauseName:
    found = comparison[engine].diagnosis
    assert found is not None
    assert found.evidence
    return found.name


def test_a_near_tie_lost_in_the_doubles_of_the_scene_is_input_rounding() -> None:
    comparison = compare(catalogue.build("near-tie:k=40"), ["double"])
    assert comparison.verdict == "diverged"
    assert cause(comparison, "double") is CauseName.INPUT
    close = comparison["double"].margin
    assert close is not None
    assert close.gap == pytest.approx((1e-40, 1e-40), rel=1e-12)
    assert close.ulps == pytest.approx(1e-40 / 2**-52, rel=1e-12)
    assert (close.enough.bits, close.enough.short) == (137, 136)


def test_an_exact_tie_that_rounding_breaks_is_a_tie() -> None:
    comparison = compare(catalogue.build("rack:rows=3"), ["double"], events=6)
    assert cause(comparison, "double") is CauseName.TIE
    divergence = comparison["double"].alignment.divergence
    assert divergence is not None
    assert divergence.expected == "b4 + b6"
    close = comparison["double"].margin
    assert close is not None
    assert (close.gap, close.distance) == ((0.0, 0.0), (0.0, 0.0))


def test_a_scene_of_whole_numbers_has_no_input_rounding() -> None:
    scene = catalogue.build("gas")
    comparison = compare(rounded(scene), ["double"])
    assert comparison["double"].verdict == "diverged"
    assert cause(comparison, "double") is CauseName.ARITHMETIC


def test_a_divergence_that_moves_with_the_step_is_the_time_step() -> None:
    comparison = compare(catalogue.build("gas"), ["pymunk"], events=40)
    assert comparison["pymunk"].verdict == "diverged"
    assert cause(comparison, "pymunk") is CauseName.STEP


def test_an_interval_that_wider_numbers_would_decide_is_too_wide() -> None:
    comparison = compare(catalogue.build("cradle"), ["interval"])
    assert comparison.verdict == "undecided"
    assert cause(comparison, "interval") is CauseName.WIDTH


def test_no_width_of_intervals_decides_a_graze() -> None:
    comparison = compare(catalogue.build("grazing"), ["interval"])
    assert cause(comparison, "interval") is CauseName.ZERO


def test_a_touching_scene_that_rounds_to_an_overlap_is_input_rounding() -> None:
    touching = Scene([Circle("1/10", 0, r="1/10"), Circle("3/10", 0, r="1/10", vx=-1)])
    with pytest.raises(SceneError, match="overlaps"):
        rounded(touching)


def test_causes_can_be_left_out() -> None:
    comparison = compare(catalogue.build("near-tie"), ["double"], causes=False)
    assert comparison["double"].diagnosis is None
    assert comparison["double"].verdict == "diverged"
