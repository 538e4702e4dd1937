"""All orders: exactly the outcomes that following every sequence, one by one, would find; no more, no fewer."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from random import Random
from typing import Any

import pytest

from truebreak.compare.orders.all_orders import OrderTree, Scripted, all_orders, equality
from truebreak.exact import ExactEngine
from truebreak.exact.replay.contact import Touch
from truebreak.exact.simulation.policies import Ask, Policy
from truebreak.floating import DoubleEngine
from truebreak.scenarios import Circle, Scene, SceneError, Trajectory, Wall, catalogue

C = Circle
ROOT3 = "sqrt(3)"
ENGINE = ExactEngine()


def velocities(run: Trajectory) -> tuple[str, ...]:
    """The final velocities, exactly; equal just if the texts are, since these are in normal form."""
    return tuple(value.text() for c in run.final.circles for value in (c.vx, c.vy))


def found(tree: OrderTree) -> list[tuple[str, ...]]:
    return [velocities(outcome.trajectory) for outcome in tree.outcomes]


def speeds(tree: OrderTree) -> set[tuple[str, ...]]:
    """The velocities along x."""
    return {row[::2] for row in found(tree)}


# -- every sequence, one by one


class Spelled(Policy):
    """Kicks the contacts that a list of places spells, then always the first; no sequence is left out."""

    chooses_order = True

    def __init__(self, places: Sequence[int]) -> None:
        self.places = tuple(places)
        self.made: list[tuple[int, int]] = []

    def choose(self, approaching: Sequence[Touch], ask: Ask) -> tuple[Touch, ...]:
        """The contact at the next place of the list."""
        if len(approaching) == 1:
            return (approaching[0],)
        number = len(self.made)
        place = self.places[number] if number < len(self.places) else 0
        self.made.append((place, len(approaching)))
        return (approaching[place],)


def every_sequence(scene: Scene, **limits: Any) -> tuple[set[tuple[str, ...]], int]:
    """The final velocities of every sequence, and how many sequences there are."""
    outcomes: set[tuple[str, ...]] = set()
    stack: list[tuple[int, ...]] = [()]
    count = 0
    while stack:
        places = stack.pop()
        policy = Spelled(places)
        outcomes.add(velocities(ENGINE.run_with(scene, policy, **limits)))
        count += 1
        for number in range(len(places), len(policy.made)):
            before = tuple(place for place, _ in policy.made[:number])
            stack += [(*before, other) for other in range(1, policy.made[number][1])]
    return outcomes, count


SMALL: dict[str, tuple[Scene, dict[str, Any], int]] = {
    "lee": (catalogue.build("lee"), {"events": 3}, 2),
    "one onto two": (Scene([C(0, 0, vx=1), C("3+sqrt(3)", 1), C("3+sqrt(3)", -1)]), {"events": 3}, 2),
    "two pairs far apart": (
        Scene([C(0, 0, vx=2), C(4, 0), C(0, 9, vx=2), C(4, 9), C(8, 9, vx=-2, m=3)]),
        {"events": 2},
        2,
    ),
    "lee twice": (
        Scene(
            [
                *(C(-3, y, vx=1) for y in (0, 20)),
                *(C(0, y) for y in (0, 20)),
                *(C(4, y, 2, -1, m=4) for y in (0, 20)),
            ]
        ),
        {"events": 2},
        4,
    ),
    "a heavy ball onto three that touch": (
        Scene([C(-5, 0, vx=1, m=3), C(0, 0), C(ROOT3, 1), C(ROOT3, -1)]),
        {"events": 2},
        4,
    ),
    "onto a square": (
        Scene([C(-5, 0, vx=1, m=3), C(0, 1), C(0, -1), C(2, 1), C(2, -1)]),
        {"events": 2},
        4,
    ),
    "from both sides": (
        Scene([C(-5, 0, vx=1, m=2), C(-1, 0, m=3), C(1, 0, m=5), C(5, 0, vx=-1, m=7)]),
        {"events": 3},
        2,
    ),
    "five on a line": (
        Scene([C(x, 0, vx=v, m=m) for x, v, m in ((-6, 1, 2), (-2, 0, 3), (0, 0, 5), (2, 0, 1), (6, -1, 7))]),
        {"events": 2},
        12,
    ),
    "a corner": (catalogue.build("corner:angle=60,skew=1/3"), {"events": 4}, 1),
    "rack of two rows": (catalogue.build("rack:rows=2"), {"events": 2}, 2),
    "rack of three rows": (catalogue.build("rack:rows=3"), {"events": 1}, 24),
    "cradle": (catalogue.build("cradle:gap=0"), {"events": 6}, 1),
}
"""A scene, the limits of its runs, and its number of distinct outcomes."""


@pytest.mark.parametrize("name", SMALL)
def test_the_outcomes_are_those_of_every_sequence(name: str) -> None:
    scene, limits, count = SMALL[name]
    naive, _ = every_sequence(scene, **limits)
    tree = all_orders(ENGINE, scene, **limits)
    assert tree.complete
    assert set(found(tree)) == naive
    assert len(naive) == count


@pytest.mark.parametrize("name", ["lee twice", "onto a square", "five on a line", "a corner", "rack of three rows"])
def test_signs_known_of_another_branch_are_those_that_would_be_asked(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    scene, limits, _ = SMALL[name]
    true, kept = Scripted.signs, list[bool]()

    def watched(self: Scripted, ask: Callable[[], dict[Touch, int]]) -> dict[Touch, int]:
        asked: list[dict[Touch, int]] = []

        def once() -> dict[Touch, int]:
            asked.append(ask())
            return asked[0]

        told = true(self, once)
        kept.append(not asked)
        assert told == (asked[0] if asked else ask())
        return told

    monkeypatch.setattr(Scripted, "signs", watched)
    tree = all_orders(ENGINE, scene, **limits)
    assert tree.complete
    assert any(kept)


@pytest.mark.parametrize("seed", range(8))
def test_the_outcomes_are_those_of_every_sequence_for_masses_drawn_from_a_seed(seed: int) -> None:
    """Three touching balls that two more hit in one instant, from two sides."""
    draw = Random(seed)
    places = draw.choice([[(0, 0), (2, 0), (4, 0)], [(0, 0), (ROOT3, 1), (ROOT3, -1)], [(0, 0), (0, 2), (2, 2)]])
    balls = [C(x, y, m=draw.randrange(1, 6)) for x, y in places]
    strikers = [C(-4, 0, vx=1, m=draw.randrange(1, 9)), C(0, -6, vy=2, m=draw.randrange(1, 9))]
    scene = Scene([*balls, *strikers])
    naive, sequences = every_sequence(scene, events=1)
    tree = all_orders(ENGINE, scene, events=1)
    assert set(found(tree)) == naive
    assert len(tree.outcomes) + tree.merged + tree.reordered <= sequences


def test_sequences_that_only_swap_independent_contacts_are_followed_once() -> None:
    """Three far pairs that collide in one instant: one outcome, found by one run."""
    scene = Scene([C(x, y, vx=1 - x // 4) for y in (0, 9, 18) for x in (0, 4)])
    tree = all_orders(ENGINE, scene)
    assert (len(tree.outcomes), tree.merged) == (1, 0)


# -- outcomes that are known


def test_lee_has_two_outcomes() -> None:
    assert speeds(all_orders(ENGINE, catalogue.build("lee"))) == {
        ("-11/5", "-8/25", "-3/25"),
        ("-8/5", "-39/25", "1/25"),
    }


def test_one_onto_two_has_two_outcomes_that_mirror_each_other() -> None:
    first, second = found(all_orders(ENGINE, SMALL["one onto two"][0]))
    assert first[0] == second[0] == "-1/8"
    assert (first[2:4], second[4:6]) == (("3/4", "1/4*sqrt(3)"), ("3/4", "-1/4*sqrt(3)"))
    assert (first[4:6], second[2:4]) == (("3/8", "-1/8*sqrt(3)"), ("3/8", "1/8*sqrt(3)"))


@pytest.mark.parametrize("balls", [2, 5, 20])
def test_a_cradle_has_one_outcome(balls: int) -> None:
    tree = all_orders(ENGINE, catalogue.build(f"cradle:gap=0,n={balls}"), events=3)
    assert (len(tree.outcomes), tree.complete) == (1, True)


@pytest.mark.parametrize(("rows", "outcomes"), [(1, 1), (2, 2), (3, 24)])
def test_the_outcomes_of_a_rack(rows: int, outcomes: int) -> None:
    tree = all_orders(ENGINE, catalogue.build(f"rack:rows={rows}"), events=1)
    assert len(set(found(tree))) == len(tree.outcomes) == outcomes
    simultaneous = velocities(ENGINE.run(catalogue.build(f"rack:rows={rows}"), events=1))
    assert (simultaneous in found(tree)) == (rows == 1)


def test_orders_that_lead_to_one_state_are_merged() -> None:
    """In a corner of 60 degrees both orders take three bounces, and end the same."""
    scene = catalogue.build("corner:angle=60")
    tree = all_orders(ENGINE, scene, events=9)
    assert (len(tree.outcomes), tree.merged > 0) == (1, True)


SMALL_ENDS: dict[str, tuple[Scene, int]] = {
    "corner and two": (
        Scene(
            [C(1, 1, m=2, id="a"), C(3, 1, id="b"), C(8, "3/2", vx=-1, m=3, id="s")],
            [Wall(0, 0, 0, 1, id="w"), Wall(0, 0, 1, 0, id="v")],
        ),
        17,
    ),
    "star": (Scene([C(-6, "1/3", vx=1), C(0, 0, 2, m=3), C("9/5", "12/5"), C("12/5", "-9/5", m=5)]), 1),
}


@pytest.mark.parametrize("name", SMALL_ENDS)
def test_histories_that_end_in_one_state_are_one_outcome(name: str) -> None:
    """Of many orders of one instant few ends are distinct; every sequence, one by one, says how many."""
    scene, count = SMALL_ENDS[name]
    tree, every = (all_orders(ENGINE, scene, events=1, ends=ends) for ends in (True, False))
    assert len(tree.outcomes) == len(set(found(every))) == count
    assert {*found(tree)} == {*found(every)} == every_sequence(scene, events=1)[0]
    assert len(tree.outcomes) + tree.merged == len(every.outcomes) + every.merged
    assert (tree.complete, tree.unproved) == (True, 0)


def test_numbers_too_deep_for_a_normal_form_are_not_proved_equal() -> None:
    run = ENGINE.run(catalogue.build("gas:n=3"), events=12)
    value = next(v for c in run.final.circles for v in (c.x, c.y) if v.exact() is None)
    other = next(v for c in ENGINE.run(catalogue.build("gas:n=3"), events=12).final.circles for v in (c.x, c.y)
                 if float(v) == float(value))  # fmt: skip
    assert equality(value, other) is None
    assert equality(value, run.final_time) is False
    assert equality(run.scene.circles[0].x, run.scene.circles[0].x) is True


def test_a_decision_tells_what_was_offered_and_chosen() -> None:
    left, right = all_orders(ENGINE, catalogue.build("lee")).outcomes
    pairs = (("left", "middle"), ("middle", "right"))
    assert [decision.offered for decision in (*left.decisions[:1], *right.decisions[:1])] == [pairs, pairs]
    assert [left.decisions[0].chosen, right.decisions[0].chosen] == list(pairs)
    assert left.decisions[0].instant == 0
    assert left.seed is None
    assert left.trajectory.events[0].impulses[0] == pairs[0]


def test_doubles_follow_the_same_orders() -> None:
    tree = all_orders(DoubleEngine(), catalogue.build("lee"))
    ends = sorted([round(float(c.vx), 12) for c in outcome.trajectory.final.circles] for outcome in tree.outcomes)
    assert ends == [[-2.2, -0.32, -0.12], [-1.6, -1.56, 0.04]]


# -- the cap


def test_a_cap_that_is_hit_is_reported_and_a_sample_drawn() -> None:
    scene = catalogue.build("rack:rows=3")
    tree = all_orders(ENGINE, scene, events=1, cap=5, samples=10, seed=3)
    assert (tree.complete, tree.cap, tree.sampled) == (False, 5, 10)
    enumerated = [outcome for outcome in tree.outcomes if outcome.seed is None]
    drawn = [outcome for outcome in tree.outcomes if outcome.seed is not None]
    assert len(enumerated) == 5
    assert drawn
    everything = set(found(all_orders(ENGINE, scene, events=1)))
    assert set(found(tree)) <= everything
    for outcome in drawn:
        assert outcome.seed in range(3, 13)
        again = ENGINE.run(scene.with_changes(tie_policy=f"sequential:seed={outcome.seed}"), events=1)
        assert [e.impulses for e in again.events] == [e.impulses for e in outcome.trajectory.events]


def test_the_sample_is_the_same_each_time_and_another_for_another_seed() -> None:
    scene = catalogue.build("rack:rows=4")

    def sample(seed: int) -> list[Any]:
        tree = all_orders(ENGINE, scene, events=1, cap=2, samples=6, seed=seed)
        return [outcome.trajectory.events[0].impulses for outcome in tree.outcomes if outcome.seed is not None]

    assert sample(1) == sample(1) != sample(100)


def test_a_cap_that_just_suffices_is_not_hit() -> None:
    tree = all_orders(ENGINE, catalogue.build("lee"), cap=2)
    assert (tree.complete, tree.sampled) == (True, 0)


@pytest.mark.parametrize(
    ("setting", "message"),
    [
        ({"cap": 0}, "cap = 0: must be a whole number from 1"),
        ({"cap": -1}, "cap = -1: must be a whole number from 1"),
        ({"cap": True}, "cap = True: must be a whole number from 1"),
        ({"cap": 1.5}, "cap = 1.5: must be a whole number from 1"),
        ({"samples": -1}, "samples = -1: must be a whole number from 0"),
    ],
)
def test_a_cap_that_cannot_be_is_refused(setting: dict[str, Any], message: str) -> None:
    with pytest.raises(SceneError) as error:
        all_orders(ENGINE, catalogue.build("lee"), **setting)
    assert str(error.value) == message
