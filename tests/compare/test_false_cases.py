"""Comparisons that once said what is not so, each with the truth."""

from __future__ import annotations

import re
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from truebreak.compare import compare, engine
from truebreak.compare.alignment.instants import Kind
from truebreak.compare.candidate import Candidate
from truebreak.compare.causes import other_settings
from truebreak.compare.causes.diagnosis import CauseName
from truebreak.compare.cli.progress import of_comparison
from truebreak.compare.foreign.guard import wider_of
from truebreak.compare.report.sentences import margin_phrase, proof_phrase, verdict_sentence
from truebreak.compare.study import Study
from truebreak.floating import PymunkEngine
from truebreak.scenarios import Circle, Pocket, Quantity, Scene, StopReason, Wall, catalogue
from truebreak.scenarios.files import load_scene

DATA = Path(__file__).parents[1] / "data" / "verdict"
BULLET, GRAZE, LAST, TIED = (load_scene(DATA / f"{name}.json") for name in ("bullet", "graze", "impossible", "tied"))


def one(scene: Scene, name: str, *, causes: bool = False, **limits: Any) -> Candidate:
    """One engine held against the exact one."""
    return compare(scene, [name], causes=causes, **limits).candidates[0]


def test_a_run_that_loses_most_events_does_not_agree() -> None:
    comparison = compare(catalogue.build("galperin:n=3"), ["pymunk"])
    assert comparison.verdict == "diverged"
    assert verdict_sentence(comparison).startswith("The time step changed what happened: pymunk first differs")
    assert "did not change what happened" not in verdict_sentence(comparison)
    assert of_comparison(comparison) == 1
    found = comparison["pymunk"]
    assert len(comparison.reference.events) == 3141
    divergence = found.alignment.divergence
    assert divergence is not None
    assert found.alignment.agreed == divergence.event == 24  # of the two that a step has of the many from 22 on
    assert found.separation.maximum > 3
    assert {"collisions", "collisions_per_ball", "who_hit_whom"} <= set(found.changed)
    assert found.diagnosis is not None
    assert found.diagnosis.name is CauseName.STEP
    # A step takes several meetings as one as soon as they are nearer in time than that.
    step = PymunkEngine().step
    assert step is not None
    assert found.margin is not None
    assert found.margin.gap is not None
    assert 0 < found.margin.gap[0] < step


@pytest.mark.parametrize("events", [156, 157, 158, 159, 160, 161, 170])
def test_a_divergence_inside_the_span_is_told_however_long_the_span(events: int) -> None:
    found = one(catalogue.build("gas"), "double", events=events)
    if events < 157:
        assert found.verdict == "agree"
        assert found.changed == ()
        return
    assert {"collisions_per_ball", "who_hit_whom"} <= set(found.changed)
    divergence = found.alignment.divergence
    assert divergence is not None
    assert (divergence.event, divergence.body, divergence.expected, divergence.got) == (161, "c7", "bottom", "c1")


def test_a_missed_hit_is_not_a_late_one() -> None:
    found = one(BULLET, "pymunk:dt=1/64", causes=True, until=12)
    divergence = found.alignment.divergence
    assert divergence is not None
    assert (divergence.kind, divergence.expected) == (Kind.MISSING, "target")
    assert found.diagnosis is not None
    assert found.diagnosis.name is CauseName.TUNNELLING
    assert CauseName.STEP in found.diagnosis.sufficient


def test_a_quiet_reference_is_held_against_all_that_comes() -> None:
    comparison = compare(GRAZE, ["double"])
    divergence = comparison["double"].alignment.divergence
    assert divergence is not None
    assert (divergence.kind, divergence.got) == (Kind.EXTRA, "target")
    assert divergence.time == pytest.approx(5, abs=1e-6)
    assert comparison.span == float("inf")


def test_another_resolution_of_a_tie_is_a_divergence() -> None:
    found = one(catalogue.build("lee:tie=sequential:order=scene"), "pymunk", causes=True, until=10)
    assert found.verdict == "diverged"
    assert found.diagnosis is not None
    assert found.diagnosis.name is CauseName.TIE
    assert one(catalogue.build("lee"), "pymunk", until=10).verdict == "agree"


@pytest.mark.parametrize(("rows", "step"), [(2, ":dt=1/4096"), (2, ""), (3, ":dt=1/4096"), (3, "")])
def test_what_only_the_step_blurs_is_no_divergence(rows: int, step: str) -> None:
    scene = catalogue.build(f"rack:rows={rows}")
    comparison = compare(scene, [f"pymunk{step}"], until=50)
    found = comparison.candidates[0]
    assert (found.verdict, found.changed) == ("agree", ())
    assert "agrees with the exact run in its one event" in verdict_sentence(comparison)
    rounds = comparison.reference.events[0].impulses
    assert rounds.count(("cue", "b1")) == 2
    assert found.alignment.agreed == len(comparison.reference.events)
    # What differs is the step's alone: it shrinks with it.
    exact = comparison.reference.final.array()[:, 2:]
    steps = [1 / 4096, 1 / 16384, 1 / 65536]
    apart = [abs(PymunkEngine(dt=dt).run(scene, until=50).final.array()[:, 2:] - exact).max() for dt in steps]
    assert 0 < apart[0] < 1e-4
    assert all(finer == pytest.approx(coarser / 4, rel=0.05) for coarser, finer in pairwise(apart))


def test_rounds_of_one_instant_may_come_in_several_steps() -> None:
    found = one(catalogue.build("rack:rows=3"), "pymunk", events=2).alignment
    assert (found.verdict, found.agreed) == ("agree", 2)


def test_one_event_is_told_one_way() -> None:
    scene = catalogue.build("rack:rows=4,gap=1/7,jitter=1/1000,seed=7033,offset=1/26,speed=20")
    told = {one(scene, "double", events=events).alignment.divergence for events in (81, 84, 86)}
    assert len(told) == 1
    assert None not in told


class Renamed(PymunkEngine):
    """Pymunk under a name of its own."""

    @property
    def name(self) -> str:
        return "mine"


@pytest.mark.parametrize("text", ["near-tie:k=4", "gas:n=4,seed=2"])
def test_an_engine_is_judged_by_what_it_declares(text: str) -> None:
    scene = catalogue.build(text)
    mine, theirs = (compare(scene, [e], events=30) for e in (Renamed(), PymunkEngine()))
    assert verdict_sentence(mine).replace("mine", "pymunk") == verdict_sentence(theirs)
    assert mine["mine"].diagnosis is not None
    told = repr(mine["mine"].diagnosis).replace("mine", "pymunk")
    assert told == repr(theirs["pymunk"].diagnosis)
    assert mine["mine"].margin == theirs["pymunk"].margin
    assert mine["mine"].outcomes == theirs["pymunk"].outcomes


def test_what_was_not_tried_is_said_so() -> None:
    found = one(catalogue.build("near-tie:k=8"), "pymunk:dt=1/524288", causes=True)
    assert found.diagnosis is not None
    by_cause = {e.cause: e for e in found.diagnosis.experiments}
    assert by_cause[CauseName.STEP].suffices is None
    assert by_cause[CauseName.STEP].result.startswith("not tried: a finer step takes more than 1,000,000 steps")
    assert found.diagnosis.name is CauseName.LATENESS  # the two come within one step


@pytest.mark.parametrize("halvings", [13, 15, 17])
def test_a_step_is_told_by_the_steps_that_were_run(halvings: int) -> None:
    """Every step that the table names was run, and does what the table says."""
    scene = catalogue.build("near-tie:k=8")
    found = one(scene, f"pymunk:dt=1/{2**halvings}", causes=True)
    assert found.diagnosis is not None
    told = next(e for e in found.diagnosis.experiments if e.cause is CauseName.STEP)
    named = [(float(step), says) for step, says in re.findall(r"([0-9][0-9.e-]*) (agrees|differs)", told.result)]
    assert named
    for step, says in named:
        again = one(scene, f"pymunk:dt=1/{round(1 / step)}")
        assert (again.verdict == "agree") == (says == "agrees")
    passes = named[-1][1] == "agrees"
    assert found.diagnosis.name is (CauseName.STEP if passes else CauseName.LATENESS)


def test_a_step_that_is_small_enough_agrees() -> None:
    assert one(BULLET, "pymunk:dt=1/64", until=12).verdict == "diverged"
    assert one(BULLET, "pymunk:dt=1/131072", causes=True, until=12).verdict == "agree"


def beside(*others: Circle) -> Scene:
    """The bullet and its target, with circles far off."""
    return BULLET.with_changes(circles=[*BULLET.circles, *others])


HIT = "10.00605"
"""When the bullet meets its target."""

FAR_TIE = (
    Circle(f"500 - {HIT}", 500, vx=1, id="left"),
    Circle(502, 500, id="middle"),
    Circle(f"505 + {HIT}", 500, 2, vx=-1, m=4, id="right"),
)
"""Both outer circles meet the middle one when the bullet meets its target."""

FAR_NEAR_TIE = (
    Circle(f"499 - {HIT}", 500, vx=1, id="left"),
    Circle(502, 500, id="middle"),
    Circle(f"506 + {HIT} + 10**-10", 500, 2, vx=-1, m=4, id="right"),
)
"""They do so one time unit later, 10**-10 apart."""


@pytest.mark.parametrize("others", [(), FAR_TIE, FAR_NEAR_TIE])
def test_passing_through_is_told_whatever_falls_beside_it(others: tuple[Circle, ...]) -> None:
    scene = beside(*others)
    reference = engine("exact").run(scene, until=12).events[0]
    assert ("bullet", "target") in reference.contacts
    assert len(reference.contacts) == (3 if others is FAR_TIE else 1)
    found = one(scene, "pymunk:dt=1/64", causes=True, until=12)
    divergence = found.alignment.divergence
    assert divergence is not None
    assert (divergence.event, {divergence.body, divergence.expected}) == (0, {"bullet", "target"})
    assert found.diagnosis is not None
    assert found.diagnosis.name is CauseName.TUNNELLING
    assert set(found.diagnosis.sufficient) <= {CauseName.TUNNELLING, CauseName.STEP}


def test_a_near_tie_is_no_tie() -> None:
    found = one(catalogue.build("near-tie:k=4"), "pymunk", causes=True)
    assert found.diagnosis is not None
    assert found.diagnosis.name is CauseName.STEP
    assert CauseName.TIE not in found.diagnosis.sufficient
    assert found.margin is not None
    assert found.margin.gap == pytest.approx((1e-4, 1e-4))


def test_a_width_that_suffices_is_found() -> None:
    scene = catalogue.build("near-tie:k=40")
    found = compare(scene, ["interval"], bits=True).candidates[0]
    assert found.diagnosis is not None
    assert found.diagnosis.name is CauseName.WIDTH
    told = found.diagnosis.finding
    assert "with 212 bits it goes on past event 0, with 106 it does not" in told
    assert "with 212 it comes to the end, with 106 it does not" in told
    reasons = {bits: engine(f"interval:bits={bits}").run(scene).stop.reason for bits in (106, 212)}
    assert reasons == {106: StopReason.UNDECIDED, 212: StopReason.QUIET}


def test_how_many_bits_lead_to_the_end_is_read_off_a_wide_run_and_confirmed_by_another() -> None:
    scene = catalogue.build("gas")
    asked = compare(scene, ["interval"], bits=True, events=150).candidates[0]
    assert asked.diagnosis is not None
    match = re.search(r"with (\d+) it comes to the end, of which (\d+) are lost by then", asked.diagnosis.finding)
    assert match is not None, asked.diagnosis.finding
    enough, lost = int(match[1]), int(match[2])
    ends = {bits: engine(f"interval:bits={bits}").run(scene, events=150).stop for bits in (enough, lost - 24)}
    assert ends[enough].reason is not StopReason.UNDECIDED
    assert ends[lost - 24].reason is StopReason.UNDECIDED
    plain = compare(scene, ["interval"], events=150).candidates[0]
    assert plain.diagnosis is not None
    assert "--bits finds how many lead to the end" in plain.diagnosis.finding


def test_at_a_proved_tie_wider_numbers_are_tried_once(monkeypatch: pytest.MonkeyPatch) -> None:
    tried: list[object] = []
    monkeypatch.setattr(other_settings, "wider_of", lambda engine: tried.append(engine.bits) or wider_of(engine))
    found = compare(catalogue.build("rack:rows=3"), ["interval"]).candidates[0]
    assert found.diagnosis is not None
    assert found.diagnosis.name is CauseName.TIE
    assert "with 106 bits it stops there too" in found.diagnosis.finding
    assert set(tried) == {53}  # wider ones than 106 are not asked for


def test_at_a_proved_zero_one_much_wider_run_is_all_that_is_tried(monkeypatch: pytest.MonkeyPatch) -> None:
    ran: list[int | None] = []
    true = Study.whole_run
    monkeypatch.setattr(
        Study, "whole_run", lambda self, engine, *rest: ran.append(engine.bits) or true(self, engine, *rest)
    )
    found = compare(catalogue.build("grazing"), ["interval"]).candidates[0]
    assert found.diagnosis is not None
    assert found.diagnosis.name is CauseName.ZERO
    assert "graze" in found.diagnosis.finding
    assert "with 848 bits it stops there too" in found.diagnosis.finding
    assert ran == [106, 848]


def test_a_zero_that_is_there_is_not_blamed_for_what_wider_numbers_decide() -> None:
    """Two fly along a wall, which is exactly zero, and one of them misses a third by less than 106 bits can tell."""
    scene = Scene([Circle(0, 0, vx=1), Circle(4, "2 + 1/2**150")], [Wall(0, -5, 1, -5)], until=20)
    assert other_settings.exact_zero(engine("exact").run(scene), 0) is not None
    found = compare(scene, ["interval"]).candidates[0]
    assert found.diagnosis is not None
    assert found.diagnosis.name is CauseName.WIDTH
    assert "with 848 bits it goes on past event 0, with 106 it does not" in found.diagnosis.finding


def test_a_stop_beside_a_tie_is_not_called_one() -> None:
    """Two others meet at one instant while a near graze stops enclosures of 53 bits; and a tie of exact numbers."""
    apart = [Circle(0, y, vx=1) for y in (100, 200)] + [Circle(10, y) for y in (100, 200)]
    graze = Scene([Circle(0, 0, vx=1), Circle(4, "2 + 1/2**58"), *apart], until=20)
    place = "3 + 1/2**60"
    exact = Scene([Circle(place, 0, vx=-1), Circle(place, 10, vx=-1)], [Wall(0, -5, 0, 5)], until=20)
    for scene in (graze, exact):
        found = compare(scene, ["interval"]).candidates[0]
        assert found.verdict == "undecided"
        assert found.diagnosis is not None
        assert found.diagnosis.name is CauseName.WIDTH
        assert compare(scene, ["interval:bits=128"], causes=False).verdict == "agree"


def test_input_and_arithmetic_are_told_by_their_displacements() -> None:
    found = one(catalogue.build("gas:seed=14"), "double", causes=True, events=230)
    assert found.alignment.divergence is not None
    assert found.alignment.divergence.event == 154
    assert found.diagnosis is not None
    sizes = {e.cause: e.displacement for e in found.diagnosis.shares}
    assert found.margin is not None
    assert found.margin.distance is not None
    by_input = sizes.pop(CauseName.INPUT)
    assert by_input is not None
    by_arithmetic = sum(size or 0.0 for size in sizes.values())
    assert abs(by_input) < found.margin.distance[0] < abs(by_arithmetic)
    assert found.diagnosis.sufficient == (CauseName.ARITHMETIC,)


@pytest.mark.parametrize("seed", [1, 2, 3, 14])
def test_the_account_takes_the_decision_past_zero(seed: int) -> None:
    found = one(catalogue.build(f"gas:seed={seed}"), "double", causes=True, events=230)
    diagnosis, margin = found.diagnosis, found.margin
    assert diagnosis is not None and margin is not None
    assert diagnosis.closed and diagnosis.displacement is not None
    bounds = margin.distance if margin.gap is None else margin.gap
    assert bounds is not None
    assert (bounds[0] + diagnosis.displacement) * bounds[0] < 0
    assert sum(e.displacement or 0.0 for e in diagnosis.shares) == pytest.approx(diagnosis.displacement)
    assert sum(e.share or 0.0 for e in diagnosis.shares) == pytest.approx(1)


def test_one_graze_has_one_cause_and_no_margin() -> None:
    comparison = compare(catalogue.build("grazing"), ["double", "pymunk"])
    for candidate in comparison.candidates:
        assert candidate.diagnosis is not None
        assert len(candidate.diagnosis.causes) == 1
        assert candidate.margin is not None
        assert candidate.margin.distance == (0.0, 0.0)
        assert "the gap is exactly 0" in (margin_phrase(candidate) or "")


def test_the_margin_is_that_of_the_contact_in_question() -> None:
    found = one(catalogue.build("gas"), "double", causes=True, events=200)
    assert found.margin is not None
    assert found.margin.distance is not None
    assert found.margin.distance[0] == pytest.approx(0.0396, abs=1e-4)
    assert found.margin.error == pytest.approx(0.0641, abs=1e-3)
    assert found.margin.ratio == pytest.approx(1.62, abs=0.02)
    assert found.margin.growth == pytest.approx(0.325, abs=0.01)


def test_a_tie_that_the_rounding_of_the_input_breaks_is_input_rounding() -> None:
    """The exact law on the scene in doubles has the contacts that doubles have."""
    for scene in (TIED, LAST):
        found = one(scene, "double", causes=True, events=2)
        divergence = found.alignment.divergence
        assert divergence is not None
        assert (divergence.kind, divergence.event) == (Kind.TIE, 0)
        assert found.diagnosis is not None
        assert found.diagnosis.causes == (CauseName.INPUT,)
        assert "arithmetic adds nothing" in found.diagnosis.finding
        assert found.margin is not None
        assert found.margin.gap == (0.0, 0.0)


def test_only_an_engine_that_proves_is_said_to() -> None:
    comparison = compare(catalogue.build("gas"), ["exact"], reference="double", events=20)
    assert proof_phrase(comparison) == "double proves nothing: it is taken as the reference."


def test_what_a_run_has_before_its_end_does_not_depend_on_its_end() -> None:
    scene = catalogue.build("gas:n=5,seed=6819,mixed=yes")
    for a, b in ((20, 21), (33, 50), (150, 151)):
        one_run, other = (engine("pymunk").run(scene, until=until) for until in (a, b))
        count = len(one_run.events)
        assert one_run.events == other.events[:count]
        assert one_run.sample([a - 1.0]).tolist() == other.sample([a - 1.0]).tolist()


def test_final_velocities_are_a_consequence() -> None:
    found = one(catalogue.build("near-tie:k=40"), "double")
    assert "final_velocities" in found.changed


def test_a_break_pattern_is_told_of_racks_only() -> None:
    assert "break_pattern" not in compare(catalogue.build("gas"), ["double"], events=5).outcomes
    assert "break_pattern" in compare(catalogue.build("rack:rows=2"), ["double"], events=2).outcomes


def test_the_readme_s_cradle_agrees() -> None:
    assert compare(catalogue.build("cradle"), ["double", "pymunk"]).verdict == "agree"
    readme = Path(__file__).parents[2].joinpath("README.md").read_text("utf-8")
    assert "truebreak compare cradle --engines double,pymunk" in readme


def test_a_changed_outcome_never_stands_beside_no_change() -> None:
    comparison = compare(catalogue.build("gas"), ["double"], events=156)
    candidate = replace(comparison["double"], changed=("break_pattern",))
    assert comparison.verdict == "agree"
    assert not verdict_sentence(replace(comparison, candidates=(candidate,))).startswith("Floating point did not")


def test_an_entry_of_one_run_alone_is_no_matter_of_the_contact_after_it() -> None:
    """Rounded to 6 bits a flight that passes a rim by a thousandth goes in: that is decided, not what comes then."""
    ball, wall = Circle(0, "14/61", "1/4", vx=1, id="ball"), Wall(20, 0, 20, 1, id="wall")
    hole = Pocket(10, Quantity.of("14/61") + Quantity.of("1001/1000"), 1, id="hole")
    scene = Scene([ball], [wall], pockets=[hole], capture=True)
    found = compare(scene, [engine("rounded:bits=6")], until=30).candidates[0]
    assert found.verdict == "diverged"
    assert found.diagnosis is not None
    assert found.diagnosis.name is CauseName.INPUT
    assert found.margin is not None
    assert found.margin.entry == ("ball", "hole")
    assert found.margin.distance is not None
    assert found.margin.distance[0] <= 0.001 <= found.margin.distance[1]
