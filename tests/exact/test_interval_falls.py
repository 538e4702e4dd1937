"""Intervals on what is round under gravity: every event that they report is the exact engine's, and is enclosed."""

from __future__ import annotations

from collections import Counter
from typing import Any

import pytest
from test_falling_faces import drawn as drawn_among_faces
from test_pegs import drawn as drawn_among_pegs

from truebreak.exact import ExactEngine
from truebreak.floating import IntervalEngine, interval
from truebreak.scenarios import Circle, Scene, Wall, catalogue
from truebreak.scenarios.trajectory import StopReason

EVENTS = 12


def wrong(scene: Scene, bits: int) -> str | None:
    """What an interval run reports that the exact one does not; None where it ended before, undecided; else empty."""
    exact = ExactEngine(max_bits=2000, work=1_000_000).run(scene, events=EVENTS)
    found = IntervalEngine(bits).run(scene, events=EVENTS)
    if len(found.events) > len(exact.events):
        return f"goes on where the exact run ends: {exact.stop.message}"
    for mine, theirs in zip(found.events, exact.events, strict=False):
        if mine.contacts != theirs.contacts:
            return f"contacts of event {mine.index}"
        if not mine.time.ball(0).overlaps(theirs.time.ball(200)):
            return f"time of event {mine.index}"
        pairs = zip(found.after(mine.index).circles, exact.after(mine.index).circles, strict=True)
        for a, b in pairs:
            for part in ("x", "y", "vx", "vy"):
                if not getattr(a, part).ball(0).overlaps(getattr(b, part).ball(200)):
                    return f"{part} of {a.id} after event {mine.index}"
    if len(found.events) < len(exact.events):
        return None if found.stop.reason is StopReason.UNDECIDED else f"stopped: {found.stop.message}"
    return ""


def counted(bits: int, low: int, high: int) -> Counter[str | None]:
    """What came of drawn scenes."""
    return Counter(
        wrong(draw(seed), bits) for seed in range(low, high) for draw in (drawn_among_pegs, drawn_among_faces)
    )


@pytest.mark.parametrize(("bits", "whole"), [(24, 0), (53, 12), (300, 24)])
def test_what_intervals_report_is_so(bits: int, whole: int) -> None:
    counts = counted(bits, 0, 12)
    assert set(counts) <= {"", None}
    assert counts[""] >= whole


def test_planted_faults_are_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """The middle of where the zero is for all of it; a flight that meets nothing where it is not known to."""

    def thin(self: Any, link: Any) -> Any:
        wait = whole(self, link)
        return None if wait is None else interval.ZERO + wait.mid

    def blind(self: Any, link: Any) -> Any:
        try:
            return whole(self, link)
        except interval.Unsharp:
            return None

    whole = interval.IntervalState.fall_wait
    for fault, bits in ((thin, 300), (blind, 24)):
        monkeypatch.setattr(interval.IntervalState, "fall_wait", fault)
        assert set(counted(bits, 0, 20)) - {"", None}, fault.__name__


def test_where_a_width_does_not_tell_a_hit_from_a_miss_it_says_so() -> None:
    """Upright beside a peg, at its very edge: a graze."""
    peg = Circle(0, 0, fixed=True, id="peg")
    scene = Scene([Circle(2, 5, id="ball"), peg], [Wall(0, -5, 1, -5, id="floor")], gravity=(0, -10))
    run = IntervalEngine().run(scene, events=3)
    assert run.stop.reason is StopReason.UNDECIDED
    assert "whether ball and peg hit, graze or miss, at a zero of a quartic" in run.stop.message
    assert len(run.events) == 0
    clear = IntervalEngine().run(
        Scene([Circle("2001/1000", 5, id="ball"), peg], scene.walls, gravity=(0, -10)), events=3
    )
    assert [tuple(event.contacts[0]) for event in clear.events] == [("ball", "floor")] * 3


def test_a_peg_stands_while_others_fall() -> None:
    run = IntervalEngine(200).run(catalogue.build("axis:k=30"))
    assert len(run.events) == 6
    rows = run.sample([0.0, 1.0, 3.0])
    assert rows[:, 1].tolist() == [[0.0, 0.0, 0.0, 0.0]] * 3
    assert run.at(1)["peg"].vy.ball(0) == 0
    assert rows[:, 0] == pytest.approx(ExactEngine().run(catalogue.build("axis:k=30")).sample([0.0, 1.0, 3.0])[:, 0])
