"""The literal engine: limits, reversal, and where it gives up."""

from __future__ import annotations

import numpy as np
import pytest
from referee import compare_to_referee, load
from test_symbolic import C, Q, lee, run

from truebreak.exact import ExactEngine
from truebreak.exact.literal import symbolic_contacts, symbolic_sign
from truebreak.scenarios import Pocket, Scene, SceneError, StopReason, Wall

# -- limits and reversal

BOX = [Wall(9, 0, 9, 1), Wall(-3, 0, -3, 1), Wall(0, 5, 1, 5), Wall(0, -6, 1, -6)]
SLANTED = [C(0, 0, vx=2, vy="1/3"), C(4, 1, vx=-1), C(5, -3, vy="1/2")]


def test_time_limit_counts_an_event_that_falls_on_it():
    scene = Scene([C(0, 0, vx=2), C(4, 0)])
    assert len(run(scene, until=1).events) == 1
    assert len(run(scene, until="999/1000").events) == 0
    late = run(scene, until=7)
    assert late.stop.reason is StopReason.HORIZON
    assert late.final_time == 7
    assert late.final["c2"].x == 16


def test_limit_on_instants():
    trajectory = run(Scene([C(0, 0, vx=1)], BOX), events=3)
    assert len(trajectory.events) == 3
    assert trajectory.stop.reason is StopReason.EVENTS


@pytest.mark.parametrize("when", [{"reverse_after": 3}, {"reverse_at": 5}])
def test_reversed_run_comes_back_exactly(when):
    scene = Scene(SLANTED, BOX, **when)
    turned = run(scene, until=10, events=40) if "reverse_at" in when else None
    if turned is None:
        third = run(scene, events=3).events[2].time
        turned = run(scene, until=third + third)
    assert turned.reversal is not None
    last = turned.final
    for circle in scene.circles:
        there = last[circle.id]
        assert (there.x, there.y, there.vx, there.vy) == (circle.x, circle.y, -circle.vx, -circle.vy)
    contacts = [event.contacts for event in turned.events]
    assert contacts[turned.reversal.after :] == contacts[: turned.reversal.after][::-1]


def test_momentum_and_energy_are_kept_exactly():
    scene = Scene([C(0, 0, vx=2, vy="1/3", m=3), C(4, 1, vx=-1), C(5, -3, vy="1/2", m="7/2")])
    trajectory = run(scene)
    masses = [Q(3), Q(1), Q("7/2")]
    assert trajectory.events

    def totals(state):
        rows = list(zip(masses, state.circles, strict=True))
        return (
            sum((m * c.vx for m, c in rows), Q(0)),
            sum((m * c.vy for m, c in rows), Q(0)),
            sum((m * (c.vx**2 + c.vy**2) for m, c in rows), Q(0)),
        )

    assert totals(trajectory.at(0)) == totals(trajectory.final)


@pytest.mark.parametrize("name", ["gas5-equal", "gas5-mixed"])
def test_agrees_with_the_referee(name):
    scene, history = load(name)
    trajectory = run(scene, events=3)
    shortened = type(history)(history.events[:3], "events", {}, *list(vars(history).values())[3:])
    compare_to_referee(trajectory, shortened)


def test_motion_between_events():
    trajectory = run(Scene([C(0, 0, vx=2), C(4, 0)]), until=3)
    assert trajectory.at("1/2")["c1"].x == 1
    assert trajectory.at(1)["c1"].vx == 0
    assert np.array_equal(trajectory.sample([0.5, 1.0, 2.0])[:, 1, 0], [4.0, 4.0, 6.0])
    for outside in (-1, 4):
        with pytest.raises(ValueError, match="not between"):
            trajectory.at(outside)


def test_undecided_sign_ends_the_run_and_says_so(monkeypatch):
    monkeypatch.setattr(symbolic_sign, "MAX_TERMS", 1)
    trajectory = run(Scene([C(0, 0, vx=1), C(4, 1)]))
    assert trajectory.stop.reason is StopReason.UNDECIDED
    assert "terms" in trajectory.stop.message


def test_unending_impulses_end_the_run_as_a_spent_budget(monkeypatch):
    monkeypatch.setattr(symbolic_contacts, "MAX_IMPULSES", 2)
    trajectory = run(lee("sequential"))
    assert trajectory.stop.reason is StopReason.BUDGET


HOLE, AT_9 = Pocket(4, 0, 1, id="hole"), Wall(9, 0, 9, 1)
ENTRIES = {
    "there and back": (Scene([C(0, 0, vx=2)], [AT_9], pockets=[HOLE]), {"until": 8}, ["3/2", "11/2"]),
    "none that is fixed": (Scene([C(0, 0, fixed=True), C(0, 5, vx=1)], pockets=[HOLE]), {"until": 8}, []),
    "right at the end": (Scene([C(0, 0, vx=2)], pockets=[HOLE]), {"until": "3/2"}, ["3/2"]),
    "just after it": (Scene([C(0, 0, vx=2)], pockets=[HOLE]), {"until": "149/100"}, []),
    "a graze": (Scene([C(0, 1, vx=2)], pockets=[HOLE]), {"until": 8}, []),
    "nothing else": (Scene([C(0, 0, vx=2)], pockets=[HOLE, Pocket(9, 0, 1)]), {}, ["3/2", "4"]),
    "from the rim": (Scene([C(3, 0, vx=2)], pockets=[HOLE]), {"until": 8}, ["0"]),
    "from within": (Scene([C(4, 0, vx=2)], [AT_9], pockets=[HOLE]), {"until": 8}, ["7/2"]),
    "turned away at the rim": (Scene([C(0, 0, vx=2)], [Wall(4, 0, 4, 1)], pockets=[HOLE]), {"until": 8}, []),
    "after a hit": (Scene([C(0, 0, vx=2), C(3, 3, vy=-2)], [AT_9], pockets=[HOLE]), {"events": 1}, []),
}


@pytest.mark.parametrize("scene, limit, times", ENTRIES.values(), ids=ENTRIES)
def test_entries_into_pockets_are_those_of_the_exact_engine(scene, limit, times):
    found, exact = run(scene, **limit), ExactEngine().run(scene, **limit)
    assert [entry.time.text() for entry in found.pocketings] == times
    assert [(entry.circle, entry.pocket) for entry in found.pocketings] == [
        (entry.circle, entry.pocket) for entry in exact.pocketings
    ]
    assert [entry.time.text() for entry in exact.pocketings] == times
    assert float(found.final_time) == float(exact.final_time)


def test_capture_by_pockets_is_refused():
    with pytest.raises(SceneError, match="capture"):
        run(Scene([C(0, 0)], capture=True))


def test_progress_tells_instants_and_time():
    seen = []
    run(Scene([C(0, 0, vx=2), C(4, 0)]), until=3, progress=seen.append)
    assert [(p.events, p.time) for p in seen] == [(0, 1.0), (1, 3.0)]
