"""The log itself: pasts compared block by block, and what that costs."""

from __future__ import annotations

from collections import Counter
from typing import Any

import pytest
from flint import fmpq  # type: ignore[attr-defined]
from test_log_symmetry import COPIES, mapped, row, run, same
from touch import assert_all_touch

from truebreak.exact.log_symmetry import IDENTITY, LogSymmetry, Past
from truebreak.exact.question import Approach, Moment, RelativeSpeed, Sooner
from truebreak.exact.replay.contact import Pair
from truebreak.exact.replay.state import Go, Kick, Take
from truebreak.scenarios import Circle, Pocket, Scene, Wall, catalogue

pytestmark = pytest.mark.usefixtures("long_balls")

# -- the log itself


def logged(scene: Scene, *steps: Any) -> LogSymmetry:
    """What the form of a log proves."""
    past = Past([not circle.fixed for circle in scene.circles], list(steps))
    past.catch_up()
    return LogSymmetry(scene, past)


def hit(i: int, j: int) -> list[Any]:
    link = Pair(i, j)
    return [Go(link, link), Kick((link,), (link,))]


PAIRS = Scene([*row(3), *mapped(row(3), same, 0, 50)])
LATER = Sooner(Moment(Pair(1, 2)), Moment(Pair(4, 5)))


def test_pasts_are_compared_block_by_block() -> None:
    assert logged(PAIRS).proves_zero(Sooner(Moment(Pair(0, 1)), Moment(Pair(3, 4))))
    assert logged(PAIRS).proves_zero(LATER)
    assert logged(PAIRS, *hit(0, 1), *hit(3, 4)).proves_zero(LATER)
    assert not logged(PAIRS, *hit(0, 1)).proves_zero(LATER)
    assert not logged(PAIRS, *hit(0, 1), *hit(3, 4), *hit(3, 4)).proves_zero(LATER)
    assert not logged(PAIRS, *hit(0, 1), *hit(4, 5)).proves_zero(LATER)
    both = Kick((Pair(0, 1), Pair(3, 4)), (Pair(0, 1), Pair(3, 4)))
    assert logged(PAIRS, both).proves_zero(LATER)


def test_a_graze_is_no_image_of_a_hit() -> None:
    assert not logged(PAIRS).proves_zero(Sooner(Moment(Pair(0, 1), graze=True), Moment(Pair(3, 4))))
    assert logged(PAIRS).proves_zero(Sooner(Moment(Pair(0, 1), graze=True), Moment(Pair(3, 4), graze=True)))


def test_velocities_are_equal_by_a_shift_only() -> None:
    turned = Scene([*row(3), *mapped(row(3), COPIES["mirrored"][0], 0, -50)])
    log = logged(PAIRS, *hit(0, 1), *hit(3, 4))
    assert log.proves_zero(RelativeSpeed(Pair(1, 4)))
    assert log.proves_zero(Approach(Pair(1, 4)))
    assert not log.proves_zero(RelativeSpeed(Pair(1, 3)))
    assert not logged(PAIRS, *hit(0, 1)).proves_zero(RelativeSpeed(Pair(1, 4)))
    assert not logged(turned, *hit(0, 1), *hit(3, 4)).proves_zero(RelativeSpeed(Pair(1, 4)))


def test_a_past_with_a_captured_circle_is_no_image_of_any() -> None:
    """Which of several pockets takes a circle, and when, is no part of the log."""
    scene = PAIRS.with_changes(pockets=[Pocket(90, 0, 2), Pocket(90, 50, 2)], capture=True)
    steps = [*hit(0, 1), *hit(3, 4)]
    for log, alike in ((logged(scene, *steps), True), (logged(scene, *steps, Take(1), Take(4)), False)):
        assert log.proves_zero(LATER) == alike
        g = log.isometry(IDENTITY, (fmpq(0), fmpq(0)), (fmpq(0), fmpq(50)))
        assert log.follows(g, 0)
        assert log.follows(g, 1) == alike


def test_captures_in_both_copies_leave_ties_that_are_ties() -> None:
    """Two tables, in each of which one disc falls into a pocket."""
    discs = [Circle(0, 0, 1, 1), Circle(4, 1), Circle(9, "-1/2"), Circle(14, 1)]
    walls = [Wall(30, 0, 30, 1), Wall(-9, 0, -9, 1), *(Wall(0, y, 1, y) for y in (-9, 9, 51, 69))]
    pockets = [Pocket(20, 3, 3), Pocket(20, 63, 3)]
    scene = Scene([*discs, *mapped(discs, same, 0, 60)], walls, pockets=pockets, capture=True)
    trajectory = run(scene, events=40)
    assert trajectory.certified
    assert len(trajectory.pocketings) >= 2
    assert_all_touch(trajectory)
    entries = Counter(float(entry.time) for entry in trajectory.pocketings)
    assert set(entries.values()) == {2}


# -- cost


def test_matching_costs_the_same_for_each_event(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each isometry compares each block once, however long the log is by then."""
    calls = Counter[str]()
    before = LogSymmetry._before

    def counted(self: LogSymmetry, *args: Any) -> Any:
        calls["blocks"] += 1
        return before(self, *args)

    monkeypatch.setattr(LogSymmetry, "_before", counted)
    each = {}
    for events in (100, 300):
        calls.clear()
        trajectory = run(catalogue.build("inscribed:n=8"), events=events)
        assert (len(trajectory.events), trajectory.certified) == (events, True)
        each[events] = calls["blocks"] / events
    assert each[300] < 1.25 * each[100]
    assert each[300] < 400
