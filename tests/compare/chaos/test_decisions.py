"""What overturns a decision: margins, errors by their direction, and what comes of it on a line."""

from __future__ import annotations

import numpy as np
import pytest

from truebreak.compare.chaos.certified_chaos import chaos
from truebreak.compare.tangent.hazard import Course, margins, shares
from truebreak.compare.tangent.impacts import impacts
from truebreak.exact import ExactEngine
from truebreak.scenarios import Circle, Quantity, Scene, Wall, catalogue


def test_margins_are_what_it_takes_to_turn_a_decision_over() -> None:
    """Displaced by a little less than the margin a circle meets the same thing first; by a little more, another."""
    corner = Scene([Circle(0, 0, vx=1, vy=1)], [Wall(10, 0, 10, 1), Wall(0, "101/10", 1, "101/10")])
    pair = Scene([Circle(0, 0, vx=1), Circle(6, "1/2", m="oo"), Circle(20, 0, r=5, m="oo")])
    assert deciding(corner) == pytest.approx([1 / 20])
    assert [meets(corner, f"-{d}", d) for d in ("49/1000", "51/1000")] == ["w1", "w2"]
    order, miss = deciding(pair)
    assert miss == pytest.approx(1.5) and order > miss
    assert [meets(pair, "0", f"-{d}") for d in ("149/100", "151/100")] == ["c2", "c3"]


def deciding(scene: Scene) -> list[float]:
    ((_, told),) = margins(scene, impacts(ExactEngine().run(scene, events=1), 1), [0])[0]
    return told.tolist()


def meets(scene: Scene, dx: str, dy: str) -> str:
    ball, *rest = scene.circles
    moved = Circle(ball.x + Quantity.of(dx), ball.y + Quantity.of(dy), vx=ball.vx, vy=ball.vy)
    return ExactEngine().run(scene.with_changes(circles=[moved, *rest]), events=1).events[0].contacts[0].second


@pytest.mark.parametrize(
    ("dx", "dy", "share"),
    [("-1", "1", 1), ("1", "-1", 1), ("1", "1", 0), ("-1", "0", "1/2"), ("0", "1", "1/2"), ("0", "-3", "3/2")],
)
def test_an_error_counts_by_its_direction(dx: str, dy: str, share: str) -> None:
    """A ball flies into a corner, at one wall 1/10 before it would be at the other; errors of 1/20."""
    scene = Scene([Circle(0, 0, vx=1, vy=1)], [Wall(10, 0, 10, 1), Wall(0, "101/10", 1, "101/10")])
    [event] = impacts(ExactEngine().run(scene, events=1), 1)
    course, errors = Course(scene), np.zeros((1, 4, 1))
    course.fly(float(event[0].time))
    errors[0, :2, 0] = [float(dx) / 20, float(dy) / 20]
    told = shares(course, event, event[0], errors, lambda i: True, lambda n: np.zeros((n, 1)))
    assert told == pytest.approx([float(Quantity.of(share)), 0.0])
    if share == 1:
        first = "w2" if dx == "-1" else "w1"
        assert meets(scene, f"{dx}*51/1000", f"{dy}*51/1000") == first
        assert meets(scene, f"{dx}*49/1000", f"{dy}*49/1000") == "w1"


def test_contacts_of_one_instant_that_commute_are_no_decision() -> None:
    """A ball comes to two walls at once, and nothing else is in its way."""
    scene = Scene([Circle(3, 3, vx=-1, vy=-1)], [Wall(0, 0, 0, 1), Wall(0, 0, 1, 0)])
    [event] = impacts(ExactEngine().run(scene, events=1), 1)
    assert len(event) == 2
    course = Course(scene)
    course.fly(float(event[0].time))
    assert [len(course.instead(event, 0).waits) for _ in event] == [0, 0]


def test_balls_on_a_line_pass_nobody_by() -> None:
    """However late a step finds a contact, the order is kept; few bits fail at the last of 314 collisions."""
    told = chaos(catalogue.build("galperin:n=2"), ["rounded:bits=12", "pymunk:dt=1/256"])
    few_bits, stepped = told.horizons
    assert few_bits.seen is not None and few_bits.seen.place is not None
    assert few_bits.seen.place.event == 313 and few_bits.holds(few_bits.seen.place)
    assert stepped.seen is not None and stepped.seen.verdict == "agree" and stepped.seen.place is None
    assert few_bits.low.event is not None and few_bits.low.event > 250
    assert stepped.low.event is not None and stepped.low.event > 60
