"""Input or arithmetic, or both: what each does alone, judged by plain histories without compare's own code."""

from __future__ import annotations

import math
from fractions import Fraction
from itertools import pairwise
from typing import Any, NamedTuple

import pytest

from truebreak.compare import compare
from truebreak.compare.alignment.align import align
from truebreak.compare.causes.diagnosis import CauseName
from truebreak.compare.causes.given_scene import rounded
from truebreak.exact import ExactEngine
from truebreak.floating import DoubleEngine
from truebreak.scenarios import Circle, Scene, Trajectory, Wall, catalogue

SOME = (1, 4, 9, 14, 21, 29)
"""Of thirty gases: input alone, both only together, and either alone, the exact run of the rounded scene coming to the
contact or leaving before."""

EVENTS = 230

Histories = dict[str, list[tuple[str, float]]]


def of_circle(circle: Circle, **changes: Any) -> Circle:
    """A circle with other numbers."""
    values = {key: getattr(circle, key) for key in ("x", "y", "r", "vx", "vy", "m", "id", "point")}
    return Circle(**{**values, **changes})


def in_doubles(scene: Scene) -> Scene:
    """Every number of a scene replaced by its nearest double."""
    circles = [
        of_circle(c, **{key: Fraction(float(getattr(c, key))) for key in ("x", "y", "r", "vx", "vy", "m")})
        for c in scene.circles
    ]
    walls = [
        Wall(*(Fraction(float(getattr(w, key))) for key in ("x0", "y0", "x1", "y1")), id=w.id) for w in scene.walls
    ]
    return scene.with_changes(circles=circles, walls=walls)


def histories(run: Trajectory) -> Histories:
    """Whom each circle meets, and when."""
    met: Histories = {str(c.id): [] for c in run.scene.circles}
    for event in run.events:
        for one, other in event.impulses:
            for name, partner in ((one, other), (other, one)):
                if name in met:
                    met[name].append((partner, float(event.time)))
    return met


def leads_to(met: Histories, seeds: dict[str, int]) -> dict[str, int]:
    """How many meetings of each circle lead to so many meetings of some: their causal past."""
    needed = dict.fromkeys(met, 0)
    todo = list(seeds.items())
    while todo:
        name, count = todo.pop()
        if count <= needed[name]:
            continue
        for place in range(needed[name], count):
            partner, time = met[name][place]
            if partner in met:
                todo.append((partner, 1 + next(k for k, (_, t) in enumerate(met[partner]) if t == time)))
        needed[name] = count
    return needed


class Contact(NamedTuple):
    """The contact in question: of the expected meeting and of the one in its place, the earlier.

    Attributes:
        body, partner: whose it is.
        places: how many meetings each of the two has before, if it can move.
        missed: whether the exact motion has it.
        needed: for each circle, how many meetings lead to it.
    """

    body: str
    partner: str
    places: dict[str, int]
    missed: bool
    needed: dict[str, int]

    def changed(self, truth: Histories, other: Histories) -> bool:
        """Whether another run lacks what leads to it, or has it where the exact motion has not, or the other way."""
        for name, count in self.needed.items():
            if [p for p, _ in truth[name][:count]] != [p for p, _ in other[name][:count]]:
                return True
        both = {self.body: self.partner, self.partner: self.body}
        meet = all(other[name][place][0] == both[name] for name, place in self.places.items())
        return meet != self.missed


def displaced(scene: Scene, runs: tuple[Trajectory, Trajectory, Trajectory], size: float) -> tuple[float, Scene]:
    """The exact motion at a moment, moved by the last run's distance from the middle one: by about that size."""
    for one, other in pairwise(runs[0].events):
        time = (float(one.time) + float(other.time)) / 2
        states = [run.at(Fraction(time)).circles for run in runs]
        apart = max(
            math.hypot(float(a.x) - float(b.x), float(a.y) - float(b.y))
            for a, b in zip(states[1], states[2], strict=True)
        )
        if apart < size:
            continue
        circles = []
        for circle, exact, entered, got in zip(scene.circles, *states, strict=True):
            numbers = {}
            for key in ("x", "y", "vx", "vy"):
                here, there = (Fraction(getattr(state, key).digits(60)) for state in (exact, entered))
                numbers[key] = here + Fraction(float(getattr(got, key))) - there
            circles.append(of_circle(circle, **numbers))
        return time, scene.with_changes(circles=circles)
    raise AssertionError("the engine never comes so far")


def test_a_causal_past_is_followed_through_partners() -> None:
    assert leads_to({"a": [("b", 1.0), ("w", 2.0)], "b": [("c", 0.5), ("a", 1.0)], "c": [("b", 0.5)]}, {"a": 2}) == {
        "a": 2,
        "b": 2,
        "c": 1,
    }


@pytest.mark.parametrize(
    "seed", [seed if seed in SOME else pytest.param(seed, marks=pytest.mark.slow) for seed in range(1, 31)]
)
def test_each_rounding_is_judged_as_an_experiment_by_hand_has_it(seed: int) -> None:
    scene = catalogue.build(f"gas:seed={seed}")
    candidate = compare(scene, ["double"], events=EVENTS).candidates[0]
    divergence, found = candidate.alignment.divergence, candidate.diagnosis
    assert divergence is not None
    assert found is not None
    runs = (
        ExactEngine().run(scene, events=EVENTS),
        ExactEngine().run(in_doubles(scene), events=EVENTS),
        DoubleEngine().run(scene, events=EVENTS),
    )
    truth, entered, own = map(histories, runs)

    # The engine leaves where it is said to.
    body, expected, got = divergence.body, str(divergence.expected), str(divergence.got)
    assert divergence.expected_time is not None
    assert divergence.got_time is not None
    place = sum(time < divergence.expected_time for _, time in truth[body])
    assert (truth[body][place][0], own[body][place][0]) == (expected, got)
    assert [p for p, _ in own[body][:place]] == [p for p, _ in truth[body][:place]]

    missed = divergence.expected_time < divergence.got_time
    partner = expected if missed else got
    seeds = {body: place}
    if partner in truth:
        met, time = (truth, divergence.expected_time) if missed else (own, divergence.got_time)
        seeds[partner] = next(k for k, meeting in enumerate(met[partner]) if meeting == (body, time))
    contact = Contact(body, partner, seeds, missed, leads_to(truth, seeds))
    assert contact.changed(truth, own)
    assert not contact.changed(truth, truth)

    time, moved = displaced(scene, (runs[0], runs[1], runs[2]), 2.0**-28)
    alone = histories(ExactEngine().run(moved, events=EVENTS))
    before = {name: [meeting for meeting in met if meeting[1] < time] for name, met in truth.items()}
    arithmetic = {name: before[name] + met for name, met in alone.items()}
    by_input, by_arithmetic = contact.changed(truth, entered), contact.changed(truth, arithmetic)
    rows = {row.cause: row for row in found.experiments}
    row = rows[CauseName.INPUT]
    if row.suffices is None:  # it moves the decision the other way, and so is not run alone
        assert row.share is not None and row.share < 0 and not by_input
    else:
        assert row.suffices is by_input
    if by_input and not by_arithmetic:
        assert CauseName.INPUT in found.causes
    if by_arithmetic and not by_input:
        assert found.causes != (CauseName.INPUT,)
    if not by_input and not by_arithmetic:
        assert len(found.causes) > 1
    assert found.closed
    assert sum(row.displacement or 0.0 for row in found.shares) == pytest.approx(found.displacement)


def test_a_hit_that_comes_too_late_changes_the_decision_as_a_miss_does() -> None:
    """c1 hits c3 in the exact run, and the wall first in singles. On the scene in 24 bits the exact law still has a
    hit of c3 in free flight, less deep and so later, after the wall: rounding of the input alone makes the difference.
    """
    scene = catalogue.build("gas:n=3,seed=1490")
    found = compare(scene, ["single"], events=60, alternatives=False)["single"]
    parted = found.alignment.divergence
    assert parted is not None and (parted.event, parted.body, parted.expected, parted.got) == (35, "c1", "c3", "bottom")
    given = align(ExactEngine().run(scene, events=60), ExactEngine().run(rounded(scene, 24), events=60)).divergence
    assert given is not None and (given.event, given.body, given.got) == (35, "c1", "bottom")
    assert found.diagnosis is not None and CauseName.INPUT in found.diagnosis.sufficient
    row = next(e for e in found.diagnosis.experiments if e.cause is CauseName.INPUT)
    assert found.margin is not None and found.margin.distance is not None and row.displacement is not None
    assert found.margin.distance[1] + row.displacement < 0, "by its depth alone it is a hit still"
    assert "c1 meets bottom first" in row.result
