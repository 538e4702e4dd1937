"""A comparison whose seconds are over says what it does not know, and claims nothing of what was cut short."""

from __future__ import annotations

import math
import time
from typing import Any

import pytest
from flint import arb, ctx  # type: ignore[attr-defined]

from truebreak.compare import comparison, comparison_json, engine
from truebreak.compare.candidate import Candidate
from truebreak.compare.causes import laboratory
from truebreak.compare.causes.diagnosis import CauseName
from truebreak.compare.causes.laboratory import Laboratory
from truebreak.compare.comparison import Comparison, compare
from truebreak.compare.deadline import NO_TIME, Clock, OutOfTime, time_to_read
from truebreak.compare.study import Study
from truebreak.scenarios import catalogue

ROOM = "truebreak.compare.causes"


def over(*args: Any, **kwargs: Any) -> Any:
    """The seconds are over here."""
    raise OutOfTime("now")


def told(name: str = "double") -> tuple[Comparison, Candidate]:
    found = compare(catalogue.build("near-tie:k=4" if name == "pymunk" else "gas"), [name], events=165)
    assert found.verdict == "diverged"
    return found, found.candidates[0]


def results(candidate: Candidate) -> dict[CauseName, str]:
    assert candidate.diagnosis is not None
    return {e.cause: e.result for e in candidate.diagnosis.experiments}


def test_whatever_is_read_is_ended() -> None:
    bits = ctx.prec
    with pytest.raises(OutOfTime), time_to_read(Clock(0.05)):
        ctx.prec = 1000
        while True:
            arb(2).sqrt()
    assert ctx.prec == bits


def test_what_begins_too_late_is_not_begun() -> None:
    clock = Clock(1e-9)
    while not clock.over:
        pass
    with pytest.raises(OutOfTime), time_to_read(clock):
        raise AssertionError


def test_without_a_limit_nothing_is_ended() -> None:
    with time_to_read(Clock(None)):
        pass


DROPPING = """
def dropped(past):
    try:
        while not past():
            pass
    except:
        return True
    return False
"""


def test_seconds_that_are_over_do_not_ring_in_code_that_drops_exceptions():
    """mpmath drops whatever is raised while it converts a number, and goes on: that ended as an error of types."""
    names: dict[str, Any] = {"__name__": "mpmath.ctx_iv"}
    exec(DROPPING, names)
    watch = Clock(0.05)
    late = time.monotonic() + 0.3
    with pytest.raises(OutOfTime), time_to_read(watch):
        assert not names["dropped"](lambda: time.monotonic() > late)
        while True:
            pass


def test_a_run_cut_short_is_no_evidence(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Study, "cap", 10**9)
    scene = catalogue.build("gas")
    study = Study(scene, engine("exact"), engine("exact").run(scene, events=5), Clock(0.4))
    with pytest.raises(OutOfTime):
        study.whole_run(engine("double"), scene, 1e7)


def test_an_account_without_time_is_not_tried(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(f"{ROOM}.evidence.shares", over)
    found, candidate = told()
    assert candidate.diagnosis is not None
    assert results(candidate)[CauseName.INPUT] == NO_TIME
    assert candidate.diagnosis.name is CauseName.UNKNOWN
    assert found.cut == ("part of why double",)
    assert candidate.margin is not None
    assert candidate.margin.distance is not None


@pytest.mark.parametrize(
    ("where", "cause"),
    [("step", CauseName.STEP), ("tunnelling", CauseName.TUNNELLING), ("iterations", CauseName.ITERATIONS)],
)
def test_what_of_a_step_was_not_tried_says_so(where: str, cause: CauseName, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(f"{ROOM}.other_settings.{where}", over)
    found, candidate = told("pymunk")
    assert candidate.diagnosis is not None
    assert results(candidate)[cause] == NO_TIME
    assert (candidate.diagnosis.name is CauseName.STEP) == (where != "step")
    assert found.cut == ("part of why pymunk",)


@pytest.mark.parametrize("where", ["_second_gap", "_error"])
def test_a_margin_is_measured_as_far_as_there_is_time(where: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(laboratory, where, over)
    _, candidate = told()
    assert candidate.diagnosis is not None
    assert candidate.diagnosis.name is CauseName.INPUT
    assert candidate.margin is not None
    if where == "_error":
        assert candidate.margin.error is None


def test_a_comparison_without_time_for_causes_has_none(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Laboratory, "_decision", over)
    found, candidate = told()
    assert (candidate.diagnosis, found.cut) == (None, ("why double",))


def test_a_distance_that_was_not_measured_is_told_as_none(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(comparison, "separation", over)
    found, candidate = told()
    assert math.isnan(candidate.separation.final)
    assert found.cut == ("the position error of double",)
    error = comparison_json(found)["candidates"][0]["position_error"]
    assert (error["final"], error["largest"]) == (None, None)
