"""Laws of the causal comparison, on histories written down by hand."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from truebreak.compare import compare, engine
from truebreak.compare.alignment.align import VERDICTS, Span, Wanted, align
from truebreak.compare.alignment.instants import Kind, follows_the_law, order_reproduces, same_velocity
from truebreak.compare.alignment.walk import Patience, history
from truebreak.scenarios import Circle, Contact, Event, Scene, Stop, StopReason, Trajectory, Wall, catalogue

WALL = "w"


def scene(n: int = 4) -> Scene:
    """Circles a, b, c, ... far apart, beside a wall; nothing here is ever run."""
    circles = [Circle(10 * k, 0, id=chr(ord("a") + k)) for k in range(n)]
    return Scene(circles, [Wall(0, -9, 1, -9, id=WALL)])


class Still:
    """A motion that nobody should ask."""

    def state(self, time: Any) -> Any:
        raise AssertionError

    def sample(self, times: Sequence[float]) -> Any:
        return np.zeros((len(times), 4, 4))


def told(
    *events: tuple[float, str],
    end: float = 100.0,
    stop: StopReason = StopReason.HORIZON,
    coupled: bool = False,
) -> Trajectory:
    """A history from (time, pairs), such as (1.0, "ab cw")."""
    rows = []
    for index, (time, text) in enumerate(events):
        pairs = tuple(Contact(*sorted(pair)) for pair in text.split())
        rows.append(Event(index, time, tuple(dict.fromkeys(pairs)), pairs, coupled=coupled and len(pairs) > 1))
    return Trajectory(
        scene=scene(),
        engine="told",
        parameters={},
        events=tuple(rows),
        stop=Stop(stop, stop.value),
        final_time=end,
        motion=Still(),
    )


def test_a_history_agrees_with_itself() -> None:
    run = told((1.0, "ab"), (2.0, "bc"), (3.0, "cw"))
    alignment = align(run, run)
    assert (alignment.verdict, alignment.agreed, alignment.reordered) == ("agree", 3, 0)


def test_a_swap_of_independent_events_is_harmless_and_counted() -> None:
    alignment = align(told((1.0, "ab"), (2.0, "cd"), (3.0, "bc")), told((1.9, "cd"), (2.0, "ab"), (3.0, "bc")))
    assert (alignment.verdict, alignment.agreed, alignment.reordered) == ("agree", 3, 1)


def test_bounces_off_one_wall_are_independent() -> None:
    alignment = align(told((1.0, "aw"), (1.1, "bw")), told((1.0, "bw"), (1.1, "aw")))
    assert (alignment.verdict, alignment.reordered) == ("agree", 1)


def test_another_partner_is_a_divergence_at_the_earlier_time() -> None:
    alignment = align(told((1.0, "ab"), (2.0, "bc")), told((1.0, "ab"), (1.5, "bd")))
    first = alignment.divergence
    assert first is not None
    assert (first.body, first.expected, first.got, first.kind) == ("b", "c", "d", Kind.DIFFERENT)
    assert (first.event, first.time, first.expected_time, first.got_time) == (1, 1.5, 2.0, 1.5)
    assert alignment.agreed == 1


def test_a_dependent_swap_is_a_divergence() -> None:
    alignment = align(told((1.0, "ab"), (2.0, "bc")), told((1.0, "bc"), (2.0, "ab")))
    assert alignment.divergence is not None
    assert (alignment.divergence.body, alignment.divergence.expected, alignment.divergence.got) == (
        "b",
        "a",
        "c",
    )


def test_a_missing_meeting_is_one_well_before_the_end_only() -> None:
    missing = align(told((1.0, "ab"), (2.0, "cd")), told((1.0, "ab")), patience=Patience())
    assert missing.divergence is not None
    assert (missing.divergence.kind, missing.divergence.expected, missing.divergence.got) == (
        Kind.MISSING,
        "d",
        None,
    )
    late = align(told((1.0, "ab"), (100.0, "cd")), told((1.0, "ab"), end=100.0), patience=Patience())
    assert (late.verdict, late.wanted) == ("unsettled", Wanted(None, 200.0))
    late = align(told((1.0, "ab"), (100.0, "cd")), told((1.0, "ab"), end=200.0), patience=Patience())
    assert late.divergence is not None
    assert late.divergence.kind is Kind.MISSING


def test_a_meeting_twice_as_late_is_another_one() -> None:
    run = told((1.0, "ab"), (10.0, "cd"), end=50.0)
    assert align(run, told((1.0, "ab"), (20.0, "cd"), end=50.0), patience=Patience()).verdict == "agree"
    late = align(run, told((1.0, "ab"), (20.5, "cd"), end=50.0), patience=Patience()).divergence
    assert late is not None
    assert (late.kind, late.expected, late.got) == (Kind.MISSING, "d", None)
    early = align(told((1.0, "ab"), (20.5, "cd"), end=50.0), run, patience=Patience()).divergence
    assert early is not None
    assert (early.kind, early.expected, early.got) == (Kind.EXTRA, None, "d")


def test_a_history_that_is_over_has_no_late_meeting() -> None:
    over = told((1.0, "ab"), end=1.0, stop=StopReason.QUIET)
    extra = align(over, told((1.0, "ab"), (9.0, "cw"), end=9.0, stop=StopReason.QUIET), patience=Patience())
    assert extra.divergence is not None
    assert (extra.divergence.kind, extra.divergence.time) == (Kind.EXTRA, 9.0)
    assert align(over, told((1.0, "ab"), end=50.0), patience=Patience()).wanted.candidate == math.inf


def test_an_extra_meeting_is_one_unless_beyond_the_span() -> None:
    extra = align(told((1.0, "ab")), told((1.0, "ab"), (2.0, "cw")), patience=Patience())
    assert extra.divergence is not None
    assert (extra.divergence.kind, extra.divergence.expected, extra.divergence.got) == (Kind.EXTRA, None, "w")
    assert align(told((1.0, "ab")), told((1.0, "ab"), (101.0, "cw"), end=103.0)).verdict == "agree"


def test_a_reference_that_runs_on_settles_the_end() -> None:
    candidate = told((1.0, "ab"), (99.99999999, "cw"), end=103.0)
    assert align(told((1.0, "ab")), candidate, patience=Patience()).wanted.reference == 199.99999998
    longer = told((1.0, "ab"), (100.00000001, "cw"), end=110.0)
    alignment = align(longer, candidate, span=Span(1, 100.0))
    assert (alignment.verdict, alignment.unsettled) == ("agree", False)
    other = told((1.0, "ab"), (100.00000001, "cd"), end=110.0)
    found = align(other, candidate, span=Span(1, 100.0)).divergence
    assert found is not None
    assert (found.time, found.expected, found.got) == (99.99999999, "d", "w")


def test_a_meeting_matched_across_the_end_counts_in_both() -> None:
    reference = told((1.0, "ab"), (100.0, "cd"), end=100.0)
    late = told((1.0, "ab"), (100.00000000000001, "cd"), end=103.0)
    alignment = align(reference, late, span=Span(2, 100.0))
    assert (alignment.verdict, alignment.agreed) == ("agree", 2)
    early = told((1.0, "ab"), (99.99999999999999, "cd"), end=103.0)
    beyond = told((1.0, "ab"), (100.0, "cd"), end=110.0)
    alignment = align(beyond, early, span=Span(1, 100.0))
    assert (alignment.verdict, alignment.agreed) == ("agree", 1)


def test_a_candidate_that_does_not_reach_the_end_is_not_settled() -> None:
    alignment = align(told((1.0, "ab")), told((1.0, "ab"), end=50.0))
    assert (alignment.verdict, alignment.wanted) == ("unsettled", Wanted(None, 201.0)), (
        "what is near the end may be late"
    )


def test_verdicts_come_in_order_of_precedence() -> None:
    assert VERDICTS == ("diverged", "unsettled", "undecided", "agree")


@pytest.mark.parametrize("stop", [StopReason.UNDECIDED, StopReason.BUDGET])
def test_a_candidate_cut_short_is_undecided_where_it_agrees(stop: StopReason) -> None:
    reference = told((1.0, "ab"), (2.0, "bc"), (3.0, "cd"))
    alignment = align(reference, told((1.0, "ab"), end=1.0, stop=stop))
    assert (alignment.verdict, alignment.agreed) == ("undecided", 1)
    assert align(reference, told((1.0, "ac"), end=1.0, stop=stop)).verdict == "diverged"


def test_contacts_of_one_instant_may_come_apart_if_their_order_cannot_matter() -> None:
    reference = told((1.0, "ab aw cd"))
    alignment = align(reference, told((1.0, "cd"), (1.0000001, "aw"), (1.0000002, "ab")))
    assert (alignment.verdict, alignment.agreed) == ("agree", 1)
    assert alignment.split == 1


def test_several_events_may_come_at_one_instant() -> None:
    alignment = align(told((1.0, "ab"), (1.001, "bc"), (1.002, "aw")), told((1.0, "ab bc aw")))
    assert (alignment.verdict, alignment.agreed) == ("agree", 3)


def test_rounds_of_impulses_are_partners_in_order() -> None:
    reference = told((1.0, "ab bc ab"))
    assert [m.partners for m in history(reference).meetings["b"]] == [("a", "c", "a")]
    assert align(reference, told((1.0, "ab bc"))).divergence is not None
    assert align(reference, told((1.0, "ab bc")), step=0.01).verdict == "agree"
    several = told((1.0, "ab"), (1.1, "bc"), (1.2, "ab"), (5.0, "bw"))
    assert align(told((1.0, "ab bc ab"), (5.0, "bw")), several, step=0.01).verdict == "agree"
    assert align(told((1.0, "ab bc"), (5.0, "bw")), several, step=0.01).verdict == "diverged"


@pytest.mark.parametrize(("name", "bits"), [("single", 24), ("double", 53), ("quad", 106)])
def test_an_engine_s_own_order_leads_to_its_own_velocities(name: str, bits: int) -> None:
    run = engine(name).run(catalogue.build("rack:rows=2"), events=1)
    assert run.events[0].coupled
    impulses = run.events[0].impulses
    assert order_reproduces(run, 0, impulses, [impulses], same_velocity(bits))
    assert not order_reproduces(run, 0, impulses, [[pair] for pair in impulses], same_velocity(bits))


def test_an_engine_with_a_step_may_report_a_contact_twice_within_it() -> None:
    reference = told((1.0, "ab"), (1.001, "bc"), (1.002, "ab"), (5.0, "bw"))
    assert align(reference, told((1.01, "ab bc"), (5.0, "bw")), step=0.01).verdict == "agree"
    assert align(reference, told((1.01, "ab bc"), (5.0, "bd")), step=0.01).verdict == "diverged"


def test_two_meetings_near_each_other_are_not_one_where_the_candidate_has_two_as_well() -> None:
    """It may be several steps off by then: what comes next tells which of them belong together."""
    reference = told((5.617, "ab"), (5.645, "bc"), (5.665, "ab"), (9.011, "ad"))
    late = told((5.5, "ab"), (5.633, "bc"), (5.767, "ab"), (9.033, "ad"))
    assert align(reference, late, step=1 / 30).verdict == "agree"
    other = align(reference, told((5.5, "ab"), (5.633, "bc"), (5.767, "ab"), (9.033, "ac")), step=1 / 30)
    assert other.divergence is not None and other.divergence.expected == "d"
    twice = told((1.0, "ab"), (1.01, "ab"), (5.0, "ab"), (9.0, "ad"))
    assert align(twice, told((1.02, "ab"), (5.02, "ab"), (9.02, "ad")), step=1 / 30).verdict == "agree"
    much_later = align(
        told((1.0, "ab"), (1.01, "ab"), (9.0, "ad")), told((1.0, "ab"), (6.0, "ab"), (9.0, "ad")), step=1 / 30
    )
    assert much_later.verdict == "diverged"


def test_the_first_of_several_divergences_is_reported() -> None:
    reference = told((1.0, "ab"), (2.0, "cd"), (3.0, "bc"), (4.0, "aw"))
    candidate = told((1.0, "ab"), (2.5, "cw"), (2.6, "dw"), (3.0, "bd"), (4.0, "ac"))
    first = align(reference, candidate).divergence
    assert first is not None
    assert (first.event, first.body, first.expected, first.got) == (1, "c", "d", "w")


def test_fixed_circles_have_no_history_of_their_own() -> None:
    fixed = Scene([Circle(0, 0, m="oo", id="o"), Circle(5, 0, vx=-1, id="a"), Circle(-5, 0, vx=1, id="b")])
    assert set(history(Trajectory(fixed, "told", {}, (), Stop(StopReason.QUIET, ""), 0.0, Still())).meetings) == {
        "a",
        "b",
    }


def test_long_histories_are_compared_in_linear_time() -> None:
    pairs = ["ab", "cd", "bc", "ad", "aw", "dw"]
    events = [(float(k), pairs[(k * k + k // 3) % 6]) for k in range(1, 100_000)]
    run = told(*events, end=200_000.0)
    assert align(run, run).agreed == 99_999


def test_event_n_is_the_first_that_the_reference_has_alone_by_its_own_count() -> None:
    """Two circles meet too early in the other run; of the reference, an earlier event of others is missing already."""
    (candidate,) = compare(catalogue.build("gas:seed=341"), ["single"], causes=False).candidates
    divergence = candidate.alignment.divergence
    assert divergence is not None
    assert (divergence.event, divergence.own_event, candidate.alignment.agreed) == (58, 73, 58)
    assert (divergence.body, divergence.expected, divergence.got) == ("c5", "c8", "c9")
    assert divergence.got_time == divergence.time < float(candidate.trajectory.events[59].time)


@pytest.mark.parametrize("spec", ["drop-pair", "falling-line", "struck", "gas-under-gravity", "bounce"])
def test_an_impact_under_gravity_is_looked_at_with_the_velocity_fallen_to(spec: str) -> None:
    """`single` was said to end with other velocities, where its last impact kept the law."""
    run = engine("single").run(catalogue.build(spec), events=12)
    for k in range(len(run.events)):
        assert follows_the_law(run, k, 24), k
    alone = [k for k, event in enumerate(run.events) if len(event.impulses) == 1]
    last = alone[-1]
    other = run.scene.with_changes(restitution="1/3")
    assert not follows_the_law(replace(run, scene=other), last, 24)


@pytest.mark.parametrize("spec", ["paddle", "drop-pair", "galton"])
def test_rounding_of_last_velocities_under_gravity_is_no_other_outcome(spec: str) -> None:
    (found,) = compare(catalogue.build(spec), ["single"], events=10).candidates
    assert found.alignment.verdict == "agree"
    assert found.changed == ()
