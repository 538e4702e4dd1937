"""Causes and margins of divergences, on scenes whose cause is known beforehand."""

from __future__ import annotations

from fractions import Fraction
from time import process_time
from typing import Any

import pytest

from truebreak.compare import comparison as comparison_module
from truebreak.compare import study
from truebreak.compare.candidate import Candidate
from truebreak.compare.causes import budget, laboratory
from truebreak.compare.causes.diagnosis import CauseName, Experiment, diagnosed
from truebreak.compare.causes.given_scene import nearest, rounded
from truebreak.compare.comparison import Comparison, compare
from truebreak.compare.foreign import RecordedEngine, Recording
from truebreak.floating.quad import QUADS
from truebreak.floating.rounded import Rounding
from truebreak.floating.single import SINGLES
from truebreak.scenarios import Circle, Quantity, Scene, SceneError, Trajectory, Wall, catalogue
from truebreak.scenarios.engine import Engine


def cause(comparison: Comparison, engine: str) -> CauseName:
    found = comparison[engine].diagnosis
    assert found is not None
    assert found.finding
    return found.name


def test_a_near_tie_lost_in_the_doubles_of_the_scene_is_input_rounding() -> None:
    comparison = compare(catalogue.build("near-tie:k=40"), ["double"])
    assert comparison.verdict == "diverged"
    assert cause(comparison, "double") is CauseName.INPUT
    close = comparison["double"].margin
    assert close is not None
    assert close.gap == pytest.approx((1e-40, 1e-40), rel=1e-12)
    assert close.ulps == pytest.approx(1e-40 / 2**-52, rel=1e-12)


def test_an_exact_tie_that_rounding_breaks_is_no_other_policy() -> None:
    comparison = compare(catalogue.build("rack:rows=3"), ["double"], events=6)
    assert cause(comparison, "double") is CauseName.ARITHMETIC
    found = comparison["double"].diagnosis
    assert found is not None and found.closed
    assert next(e for e in found.experiments if e.cause is CauseName.INPUT).displacement == 0.0
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
    assert cause(comparison, "double") in (CauseName.FLIGHTS, CauseName.IMPACTS, CauseName.ARITHMETIC)


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


@pytest.mark.parametrize(
    "text",
    [
        "0",
        "1/3",
        "-sqrt(2)/7",
        "5 + 10**-20",
        "1 + 1/2**24",
        "1 + 3/2**24",
        "-1 - 1/2**24 - 10**-90",
        "2**-149 / 2",
        "2/3",
    ],
)
def test_the_nearest_number_is_the_one_that_engines_are_given(text: str) -> None:
    value = Quantity.of(text)
    assert nearest(value, 24) == Quantity.of(Fraction(float(SINGLES.constant(value))))
    assert nearest(value, 53) == Quantity.of(Fraction(float(value)))
    pair = QUADS.constant(value)
    assert nearest(value, 106) == Quantity.of(Fraction(pair.hi) + Fraction(pair.lo))
    for bits in (5, 30, 52):
        assert nearest(value, bits) == Quantity.of(Fraction(float(Rounding(bits).constant(value))))


@pytest.mark.parametrize(("text", "engine"), [("near-tie:k=10", "single"), ("near-tie:k=12", "rounded:bits=30")])
def test_input_is_rounded_to_the_engine_s_own_numbers(text: str, engine: str) -> None:
    """Doubles hold such a scene apart; numbers of fewer bits do not, before anything is computed."""
    found = compare(catalogue.build(text), [engine])[engine].diagnosis
    assert found is not None
    assert found.sufficient == (CauseName.INPUT,)
    assert all(e.displacement == 0.0 for e in found.experiments if e.cause in (CauseName.FLIGHTS, CauseName.IMPACTS))


def test_a_scene_of_doubles_is_not_exact_in_fewer_bits() -> None:
    scene = rounded(catalogue.build("gas:n=3"))
    found = compare(scene, ["double", "single"], events=60)
    assert found["single"].diagnosis is not None
    by_input = next(e for e in found["single"].diagnosis.experiments if e.cause is CauseName.INPUT)
    assert by_input.displacement != 0.0
    assert "24 bits" in by_input.result


@pytest.mark.parametrize("spec", ["pinball", "rack:rows=2"])
def test_no_law_is_blamed_where_an_account_says_what_the_steps_miss(spec: str) -> None:
    """In chaos no step that can be run settles it; what its steps miss is then the cause, by its share.

    Along the line between two discs no step displaces a ball to the side: there only the rounding of places does.
    """
    candidate = compare(catalogue.build(spec), ["pymunk"])["pymunk"]
    assert candidate.verdict == "diverged"
    assert candidate.diagnosis is not None
    assert CauseName.LAW not in candidate.diagnosis.causes
    assert candidate.diagnosis.closed
    assert candidate.diagnosis.name is (CauseName.FLIGHTS if spec == "pinball" else CauseName.MERGED)


def test_a_family_without_a_row_of_its_own_is_told_by_its_kinds() -> None:
    """One kind of arithmetic and the decision's own rounding, neither of which stands out."""
    rows = [
        Experiment(CauseName["FLIGHTS"], "flights", -1.0, False, 0.5),
        Experiment(CauseName["DECISION"], "the answer", -1.0, None, 0.5),
    ]
    found = diagnosed(rows, 1.5, -2.0, 3)
    assert (str(found), found.finding) == ("arithmetic rounding", "flights; the answer")


COSTLY = ["gas", "gas:n=12", "gas:n=12,seed=1", "point", "lorentz", "reversal", "rack:rows=5"]


@pytest.mark.parametrize("spec", COSTLY)
def test_causes_of_doubles_cost_at_most_ten_reference_runs(spec: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """By processor time, continuations from states of the engine and all; runs of an engine are two at most."""
    took: list[float] = []
    runs: list[str] = []
    run_guarded, explain = study.run_guarded, comparison_module.explained

    def run(engine: Engine, *given: Any, **limits: Any) -> Trajectory:
        runs.append(engine.name)
        return run_guarded(engine, *given, **limits)

    def explained(told: study.Study, *given: Any, **more: Any) -> Candidate:
        runs.clear()
        began = process_time()
        found = explain(told, *given, **more)
        took.append((process_time() - began) / told.processor)
        assert len(runs) <= 2, runs
        return found

    for module in (study, laboratory):
        monkeypatch.setattr(module, "run_guarded", run)
    monkeypatch.setattr(comparison_module, "explained", explained)
    for _ in range(3):  # the first loads what causes need
        found = compare(catalogue.build(spec), ["double"], alternatives=False)
        assert found["double"].diagnosis is not None and found["double"].diagnosis.name is not CauseName.UNKNOWN
    assert 0 < min(took) <= 10, took


def test_a_tie_broken_by_flights_of_few_bits_is_not_laid_on_its_impulses() -> None:
    """From its own state before the instant the exact law has the engine's contacts, and leaves the circles as it does
    but for some 20 units of its numbers: nothing within the instant chose.
    """
    found = compare(catalogue.build("rack:rows=4,speed=5"), ["rounded:bits=16"], events=8, alternatives=False)
    diagnosis = found["rounded:bits=16"].diagnosis
    assert diagnosis is not None and diagnosis.closed
    assert CauseName.FLIGHTS in diagnosis.sufficient and CauseName.IMPACTS not in diagnosis.sufficient
    tie = next(e for e in diagnosis.experiments if e.cause is CauseName.TIE)
    assert tie.suffices is False and "rounding before it chose" in tie.result


class OneTooMany(RecordedEngine):
    """Doubles that report contacts of one instant, and where circles are after it."""

    name, bits, rounds_input = "one too many", 53, True
    scene_keys = frozenset({"fixed", "wall", "restitution"})

    def __init__(self, pairs: list[tuple[str, str]], after: dict[str, tuple[float, float, float, float]]) -> None:
        self.pairs, self.after = pairs, after

    def play(self, scene: Scene, recording: Recording) -> None:
        """One event, at t = 3."""
        recording.hits(3.0, self.pairs, self.after)
        recording.end(quiet=True)


@pytest.mark.parametrize("again", [False, True])
def test_the_contact_itself_has_to_be_in_the_exact_run_of_the_rounded_scene(
    again: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It is not there where both have another contact in its instant; nor is it twice where A slides on from once."""
    apart = Circle("20 + 1/3", 9, id="apart")  # so that the input is rounded
    if again:
        sliding = Circle(0, 4, vx=1, vy=-1, id="A")
        scene = Scene([sliding, apart], [Wall(0, 0, 1, 0, id="B")], restitution=0)
        judged = OneTooMany([("A", "B"), ("A", "B")], {"A": (3, 1, 1, 0)})
    else:
        falling = [Circle(0, 4, vy=-1, id="A"), Circle(2, 4, vy=-1, id="D")]
        scene = Scene([*falling, Circle(0, -1, m="oo", id="B"), Circle(2, -1, m="oo", id="C"), apart])
        judged = OneTooMany([("A", "B"), ("C", "D"), ("A", "D")], {"A": (0, 1, 0, 1), "D": (2, 1, 0, 1)})
    seen: list[bool] = []

    def law(lab: Any, rows: Any) -> list[Experiment]:
        seen.append(laboratory.given_does(lab))
        return []

    monkeypatch.setattr(budget, "law", law)
    found = compare(scene, [judged]).candidates[0]
    assert seen == [False]
    assert found.alignment.divergence is not None and found.diagnosis is not None
    assert (found.alignment.divergence.body, found.alignment.divergence.got) == ("A", judged.pairs[-1][1])
    assert CauseName.INPUT not in found.diagnosis.sufficient
    assert not any("has the contacts that" in row.result for row in found.diagnosis.experiments)  # from its own state
