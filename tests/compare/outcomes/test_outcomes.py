"""Outcomes: what a history comes to."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from truebreak.compare import compare, engine
from truebreak.compare.outcomes import matched
from truebreak.compare.outcomes.outcome import OUTCOMES, changed_outcomes, mirror, outcomes_of, symmetry, table
from truebreak.exact import ExactEngine
from truebreak.scenarios import Circle, Pocket, Polygon, Scene, Segment, Trajectory, Wall, catalogue


def box(*circles: Circle, **more: Any) -> Scene:
    """Circles in a box of 8 by 4."""
    walls = [
        Wall(0, 0, 0, 1, id="left"),
        Wall(8, 0, 8, 1, id="right"),
        Wall(0, 0, 1, 0, id="floor"),
        Wall(0, 4, 1, 4, id="top"),
    ]
    return Scene(circles, walls, **more)


def ran(scene: Scene, name: str = "exact", **limits: Any) -> Trajectory:
    return engine(name).run(scene, **limits)


def test_collisions_are_counted_by_impulse_ball_and_pair() -> None:
    run = ran(box(Circle(1, 1, r="1/2", vx=1, id="a"), Circle(4, 1, r="1/2", id="b")), events=3)
    values = outcomes_of(run)
    assert values["collisions"] == 3
    assert values["who_hit_whom"] == {"a-b": 2, "b-right": 1}
    assert values["collisions_per_ball"] == {"a": 2, "b": 3}
    assert values["moved"] == ["a", "b"]


def test_a_ball_that_nobody_meets_does_not_move() -> None:
    run = ran(box(Circle(1, 1, r="1/2", vx=1, id="a"), Circle(4, 3, r="1/2", id="b")), events=2)
    assert outcomes_of(run)["moved"] == ["a"]


def test_a_break_pattern_names_partners_and_cells() -> None:
    run = ran(box(Circle(1, 1, r="1/2", vx=1, id="a"), Circle(4, 1, r="1/2", id="b")), until=3)
    both = box(Circle(1, 1, r="1/2", vx=1, id="a"), Circle(4, 1, r="1/2", vx="1/9", id="b"))
    assert "break_pattern" not in outcomes_of(ran(both, until=3))
    assert outcomes_of(run)["break_pattern"] == {
        "a": {"met": ["b"], "ended": "B1"},
        "b": {"met": ["a"], "ended": "D1"},
    }
    assert table(Scene([Circle(0, 0)])) is None


def test_a_ball_that_enters_a_pocket_is_reported_with_the_instant() -> None:
    pocket = Pocket(6, 1, "1/4", id="p")
    scene = box(Circle(1, 1, r="1/2", vx=1, id="a"), Circle(1, 3, r="1/2", id="b"), pockets=[pocket])
    values = outcomes_of(ran(scene, until=6))
    assert values["pocketed"] == {"a": {"pocket": "p", "time": pytest.approx(4.75)}}
    assert values["break_pattern"]["a"]["ended"] == "p"


def test_outcomes_that_say_nothing_are_left_out() -> None:
    values = outcomes_of(ran(Scene([Circle(0, 0, vx=1)]), until=1))
    assert "pocketed" not in values
    assert "symmetry" not in values
    assert "break_pattern" not in values


def test_symmetry_is_kept_by_exact_numbers_and_lost_by_doubles() -> None:
    scene = catalogue.build("rack:rows=3")
    comparison = compare(scene, ["double"], events=20, causes=False)
    assert comparison.outcomes["symmetry"]["kept"]
    lost = comparison["double"].outcomes["symmetry"]
    assert not lost["kept"]
    assert lost["lost_at"] > 0


def test_a_mirror_must_be_exact() -> None:
    near = Scene([Circle(0, 2, id="a"), Circle(0, "-2 - 10**-30", id="b"), Circle(5, 0, id="c")])
    assert mirror(near, "y") is None
    assert mirror(Scene([Circle(0, 2, id="a"), Circle(0, -2, id="b"), Circle(5, 0, id="c")]), "y") is not None


def test_users_add_their_own_outcomes() -> None:
    def last_partner(trajectory: Trajectory) -> str:
        return trajectory.events[-1].contacts[0].second

    scene = box(Circle(1, 1, r="1/2", vx=1, id="a"))
    comparison = compare(scene, ["double"], events=3, outcomes={"last_partner": last_partner})
    assert comparison.outcomes["last_partner"] == "right"
    assert comparison["double"].outcomes["last_partner"] == "right"
    assert "last_partner" not in OUTCOMES


def test_arrays_are_compared_to_their_last_number() -> None:
    long = np.zeros(5000)
    other = long.copy()
    other[2500] = 1.0
    assert changed_outcomes({"a": long, "b": long}, {"a": long.copy(), "b": other}) == ["b"]


def test_changed_outcomes_are_named() -> None:
    assert changed_outcomes({"a": 1, "b": 2}, {"a": 1, "b": 3, "c": 4}) == ["b", "c"]


def test_a_mirror_line_among_segments_and_polygons() -> None:
    """Things map to things; where they share an end, of which one has the name, nothing is said."""
    discs = [Circle(5, 2, vx=-1, vy="-1/9", id="a"), Circle(5, -2, vx=-1, vy="1/9", id="b")]
    wedges = [Polygon([(-3, 1), (-1, 1), (-1, 4)], "up"), Polygon([(-3, -1), (-1, -1), (-1, -4)], "down")]
    bars = [Segment(-6, 1, -7, 3, id="s"), Segment(-7, -3, -6, -1, id="t")]
    scene = Scene(discs, polygons=wedges, segments=bars, until=30)
    found = mirror(scene, "y")
    assert found is not None
    assert found[1] == {"a": "b", "b": "a", "up": "down", "down": "up", "s": "t", "t": "s"}
    run = ExactEngine().run(scene)
    assert {pair.second for event in run.events for pair in event.contacts} >= {"up", "down"}
    assert symmetry(run) == {"line": "y = 0", "kept": True, "lost_at": None}
    assert mirror(scene.with_changes(polygons=[wedges[0], Polygon(wedges[1].points, "down", "1/9")]), "y") is None
    joined = [Segment(-6, 0, -7, 3, id="s"), Segment(-6, 0, -7, -3, id="t")]
    assert mirror(scene.with_changes(segments=joined), "y") is None


def test_what_has_settled_stays_where_it_is_in_the_part_that_a_shorter_run_is_held_to() -> None:
    """It was taken to fall on from its last meeting."""
    run = ExactEngine().run(catalogue.build("landing"))
    known = {event.index: event.impulses for event in run.events[:2]}
    part = matched._part(run, known, (), 1.25)
    assert [float(circle.y) for circle in part.at(1.25).circles] == [1.0, 1.0]
