"""What the physics permits: all orders against a brute force, and the four classes."""

from __future__ import annotations

import math
from pathlib import Path
from random import Random
from typing import Any, TypeAlias

import jsonschema
import pytest

from truebreak.compare import compare
from truebreak.compare.certificate.attached import with_certificates
from truebreak.compare.orders.all_orders import all_orders
from truebreak.compare.outcomes.outcome import pattern
from truebreak.compare.outcomes.permitted import NEARBY, ORDER_SIGNS, PatternRelation, nearby, permitted_patterns
from truebreak.compare.report.documents import comparison_json
from truebreak.compare.report.schema import schema
from truebreak.compare.report.sentences import pattern_phrase
from truebreak.compare.study import Study
from truebreak.exact import ExactEngine
from truebreak.scenarios import Circle, Scene, Segment, Wall, catalogue
from truebreak.scenarios.files import load_scene

Velocities: TypeAlias = tuple[tuple[float, float], ...]

DIGITS = 7

LAST = load_scene(Path(__file__).parents[2] / "data" / "verdict" / "impossible.json")


def brute_force(places: list[tuple[float, float]], start: Velocities, radii: list[float], masses: list[float]) -> set:
    """Every outcome of kicking one approaching contact at a time, by trying all, in doubles."""
    touching = [
        (i, j)
        for i in range(len(places))
        for j in range(i + 1, len(places))
        if abs(math.dist(places[i], places[j]) - radii[i] - radii[j]) < 1e-9
    ]
    ends: set[Velocities] = set()
    seen: set[Velocities] = set()
    waiting = [start]
    while waiting:
        now = waiting.pop()
        key = rounded(now)
        if key in seen:
            continue
        seen.add(key)
        onward = [kicked(now, places, masses, i, j) for i, j in touching if closing(now, places, i, j) < -1e-9]
        waiting += onward
        if not onward:
            ends.add(key)
    return ends


def rounded(velocities: Velocities) -> Velocities:
    return tuple((round(x, DIGITS) + 0.0, round(y, DIGITS) + 0.0) for x, y in velocities)


def closing(velocities: Velocities, places: list[tuple[float, float]], i: int, j: int) -> float:
    d = (places[j][0] - places[i][0], places[j][1] - places[i][1])
    v = (velocities[j][0] - velocities[i][0], velocities[j][1] - velocities[i][1])
    return (d[0] * v[0] + d[1] * v[1]) / math.hypot(*d)


def kicked(velocities: Velocities, places: Any, masses: list[float], i: int, j: int) -> Velocities:
    n = (places[j][0] - places[i][0], places[j][1] - places[i][1])
    length = math.hypot(*n)
    n = (n[0] / length, n[1] / length)
    push = -2 * closing(velocities, places, i, j) / (1 / masses[i] + 1 / masses[j])
    found = list(velocities)
    for k, sign in ((i, -1), (j, 1)):
        vx, vy = found[k]
        found[k] = (vx + sign * push * n[0] / masses[k], vy + sign * push * n[1] / masses[k])
    return tuple(found)


def outcomes_of_orders(scene: Scene, cap: int = 4000) -> set[Velocities]:
    """The velocities that the exact engine's tree of orders ends the first instant with."""
    tree = all_orders(ExactEngine(), scene, events=1, cap=cap)
    assert tree.complete
    return {velocities(outcome.trajectory.final) for outcome in tree.outcomes}


def velocities(state: Any) -> Velocities:
    return rounded(tuple((float(c.vx), float(c.vy)) for c in state.circles))


def by_force(scene: Scene) -> set[Velocities]:
    """The same by brute force, from the state at the first instant."""
    run = ExactEngine().run(scene, events=1)
    state = run.final
    start = tuple((float(c.vx), float(c.vy)) for c in scene.circles)
    places = [(float(c.x), float(c.y)) for c in state.circles]
    masses = [math.inf if isinstance(c.m, str) else float(c.m) for c in scene.circles]
    return brute_force(places, start, [float(c.r) for c in scene.circles], masses)


@pytest.mark.parametrize(("rows", "count"), [(1, 1), (2, 2), (3, 24)])
def test_every_order_of_a_rack_is_followed(rows: int, count: int) -> None:
    scene = catalogue.build(f"rack:rows={rows},speed=100,pockets=no")
    found = outcomes_of_orders(scene)
    assert found == by_force(scene)
    assert len(found) == count


def line(*circles: tuple[str, str, str, str]) -> Scene:
    """Circles on a line: x, r, vx, m."""
    return Scene([Circle(x, 0, r, vx, m=m) for x, r, vx, m in circles])


CLUSTERS = {
    "three balls of Lee": line(("-3", "1", "1", "1"), ("0", "1", "0", "1"), ("4", "2", "-1", "4")),
    "masses 1, 1/2, 1": line(("-3", "1", "1", "1"), ("0", "1", "0", "1/2"), ("3", "1", "-1", "1")),
    "masses 1, 1/5, 1": line(("-3", "1", "1", "1"), ("0", "1", "0", "1/5"), ("3", "1", "-1", "1")),
    "1/cos(pi/3) - 1": line(("-3", "1", "1", "1"), ("0", "1", "0", "1"), ("3", "1", "-1", "1")),
    "1/cos(pi/4) - 1": line(("-3", "1", "1", "1"), ("0", "1", "0", "sqrt(2) - 1"), ("3", "1", "-1", "1")),
    "a cradle of four": line(("-3", "1", "1", "1"), ("0", "1", "0", "1"), ("2", "1", "0", "1"), ("4", "1", "0", "1")),
    "a heavy end": line(("-3", "1", "1", "1"), ("0", "1", "0", "1"), ("2", "1", "0", "3"), ("4", "1", "0", "1")),
    "struck from both ends": line(
        ("-3", "1", "1", "1"), ("0", "1", "0", "2"), ("2", "1", "0", "1"), ("5", "1", "-1", "3")
    ),
    "one onto two": Scene([Circle(-4, 0, vx=1), Circle("sqrt(3)", 1), Circle("sqrt(3)", -1)]),
    "one onto two of other masses": Scene([Circle(-4, 0, vx=1), Circle("sqrt(3)", 1, m=2), Circle("sqrt(3)", -1)]),
    "one onto three that touch": Scene(
        [Circle(-5, 0, vx=1), Circle(0, 0), Circle("sqrt(3)", 1), Circle("sqrt(3)", -1)]
    ),
    "two onto one, at a right angle": Scene([Circle(-4, 0, vx=1), Circle(0, -4, vy=1), Circle(0, 0)]),
    "three onto one": Scene([Circle(-4, 0, vx=1), Circle(4, 0, vx=-1), Circle(0, -4, vy=1), Circle(0, 0, m=2)]),
}


@pytest.mark.parametrize("name", CLUSTERS)
def test_every_order_of_a_cluster_is_followed(name: str) -> None:
    scene = CLUSTERS[name]
    assert outcomes_of_orders(scene) == by_force(scene)


@pytest.mark.parametrize("k", [3, 4])
def test_masses_for_which_no_order_matters(k: int) -> None:
    assert len(outcomes_of_orders(CLUSTERS[f"1/cos(pi/{k}) - 1"])) == 1
    assert len(outcomes_of_orders(CLUSTERS["masses 1, 1/2, 1"])) == 2
    assert len(outcomes_of_orders(CLUSTERS["masses 1, 1/5, 1"])) == 2


def test_nearby_scenes_do_few_of_the_orders_and_never_the_default_policy() -> None:
    scene = catalogue.build("rack:rows=3,speed=100,pockets=no")
    orders = outcomes_of_orders(scene)
    own = velocities(ExactEngine().run(scene, events=1).final)
    seen: set[Velocities] = set()
    after = float(ExactEngine().run(scene, events=1).final_time) + 0.001
    for seed in range(60):
        run = ExactEngine().run(nearby(scene, seed), until=str(after))
        assert run.certified
        seen.add(velocities(run.final))
    assert seen <= orders
    assert own not in seen
    assert 1 < len(seen) <= 6


def test_nearby_is_near() -> None:
    scene = catalogue.build("rack:rows=2")
    for before, after in zip(scene.circles, nearby(scene, 5).circles, strict=True):
        assert abs(float((after.x - before.x) / NEARBY)) <= 1
        assert abs(float((after.y - before.y) / NEARBY)) <= 1


def study(scene: Scene, **limits: Any) -> Study:
    truth = ExactEngine()
    return Study(scene, truth, truth.run(scene, **limits))


FLOOR = Wall(0, 0, 1, 0, id="floor")


def sliders(seed: int) -> Scene:
    """Two discs that slide on a floor, and meet one that lies there at once; a fourth lies farther on, perhaps."""
    rng = Random(f"permitted {seed}")
    d, v = rng.randint(1, 4), rng.choice(("1", "1/3", "2"))
    masses = [rng.choice(("1", "2", "1/3", "3", "1/5")) for _ in range(4)]
    circles = [
        Circle(-2 - d, 1, vx=v, m=masses[0], id="l"),
        Circle(0, 1, m=masses[1], id="m"),
        Circle(2 + d, 1, vx=f"-{v}", m=masses[2], id="r"),
    ]
    circles += [Circle(rng.randint(9, 11), 1, m=masses[3], id="far")] if rng.random() < 0.5 else []
    walls = [FLOOR, Wall(-9, 0, -9, 1, id="left"), Wall(14, 0, 14, 1, id="right")]
    policy, e = rng.choice(("simultaneous", "sequential")), rng.choice(("1", "1", "1/2"))
    return Scene(circles, walls, tie_policy=policy, restitution=e, gravity=(0, -10), settle=True)


def without_gravity(scene: Scene) -> Scene:
    """The same scene, in which nothing falls: what slides goes on as it would."""
    return scene.with_changes(gravity=None, settle=False)


def test_what_walls_carry_is_permitted_what_it_is_without_gravity() -> None:
    """All that slides on one level is as without gravity: the orders, whether these are all, what nearby scenes do."""
    several = witnessed = 0
    for seed in range(14):
        scene = sliders(seed)
        told = [study(one, events=7) for one in (scene, without_gravity(scene))]
        assert any(event.coupled for event in told[0].reference.events)
        mine, plain = (permitted_patterns(one, wanted=[{}]) for one in told)
        assert mine is not None and plain is not None
        assert (mine.exact, mine.by_policy) == (plain.exact, plain.by_policy)
        assert mine.complete and plain.complete and mine.followed == plain.followed
        assert all(found in plain.orders for found in mine.orders) and len(mine.orders) == len(plain.orders)
        several += len(mine.orders) > 1
        for witness in mine.witnesses:
            witnessed += 1
            span = str(float(told[0].reference.final_time))
            run = ExactEngine().run(without_gravity(witness.scene), until=span)
            assert pattern(run) in (witness.pattern, pattern(ExactEngine().run(witness.scene, until=span)))
    assert several and witnessed > 9


def test_what_lies_lies_nearby() -> None:
    """On floors and shelves, also aslant, and what slides: each is carried from the start, and parted from others."""
    law: dict[str, Any] = {"restitution": "1/2", "settle": True}
    shelf, slope = Segment(-3, 4, 3, 4, "shelf", "1/8"), Wall(0, 0, 4, 3, id="slope")
    on_it = Circle("-3/5*sqrt(2)", "4/5*sqrt(2)", "sqrt(2)", id="a")
    scenes = [
        sliders(3),
        Scene([Circle(1, "41/8", id="a"), *sliders(3).circles[:2]], [FLOOR], segments=[shelf], gravity=(0, -10), **law),
        Scene([on_it, Circle(9, 90, vy=-1, id="b")], [slope], gravity=("3", "-4"), **law),
    ]  # fmt: skip
    leaves, under = Circle(9, 1, vy=3, id="leaves"), Wall(1, 0, 0, 0, id="turned round")
    scenes.append(Scene([Circle(0, 1, id="a"), leaves], [under], gravity=(0, -10), **law))
    assert not nearby(scenes[-1], 1).with_changes(circles=nearby(scenes[-1], 1).circles[1:]).touching
    for scene in scenes:
        lying = [(s.circle, s.wall) for s in ExactEngine().run(scene, events=1).settlings if s.time.text() == "0"]
        assert lying
        for seed in range(4):
            other = nearby(scene, seed)
            assert not other.touching or {j for _, j in other.touching} <= {*range(len(scene.circles), 99)}
            run = ExactEngine().run(other, events=1)
            assert [(s.circle, s.wall) for s in run.settlings if s.time.text() == "0"] == lying
            for before, after in zip(scene.circles, other.circles, strict=True):
                assert abs(float((after.x - before.x) / NEARBY)) < 4
                assert abs(float((after.y - before.y) / NEARBY)) < 4


def test_the_four_classes() -> None:
    scene = catalogue.build("rack:rows=2,speed=100")
    told = study(scene, events=4)
    histories = [(ExactEngine().run(nearby(scene, seed), events=4), False) for seed in range(3)]
    first = permitted_patterns(told, histories)
    assert first is not None
    assert first.complete
    assert first.relation(first.exact) is PatternRelation.OWN
    for found in first.orders:
        assert first.relation(found) in (PatternRelation.REALISABLE, PatternRelation.SOME_ORDER, PatternRelation.OWN)
    assert first.relation({}) is PatternRelation.NO_ORDER
    witness = first.witnesses[0]
    run = ExactEngine().run(witness.scene, until=str(float(told.reference.final_time)))
    assert run.certified
    assert pattern(run) == witness.pattern


def test_a_pattern_that_was_not_looked_for_to_the_end_is_not_found() -> None:
    from dataclasses import replace

    found = permitted_patterns(study(catalogue.build("rack:rows=2,speed=100"), events=2))
    assert found is not None
    assert replace(found, complete=False).relation({}) is PatternRelation.NOT_FOUND


@pytest.mark.parametrize("events", [1, 2, 3, 4, 6])
@pytest.mark.parametrize("policy", ["simultaneous", "sequential:order=scene", "sequential:seed=3"])
def test_a_sequential_policy_s_own_pattern_is_among_all_orders(events: int, policy: str) -> None:
    scene = catalogue.build("rack:rows=2,speed=100").with_changes(tie_policy=policy)
    found = permitted_patterns(study(scene, events=events))
    assert found is not None
    assert found.complete
    for name, other in found.by_policy.items():
        if name.startswith("sequential"):
            assert other in found.orders, name


def test_the_scene_s_own_pattern_is_in_a_complete_set() -> None:
    scene = catalogue.build("rack:rows=2").with_changes(tie_policy="sequential:order=scene")
    found = permitted_patterns(study(scene, events=4))
    assert found is not None
    assert found.complete
    assert found.exact in found.orders
    assert found.relation(found.exact) is PatternRelation.OWN


def test_the_span_is_exact_for_every_order() -> None:
    for limits in ({"events": 2}, {"until": 6}):
        comparison = compare(LAST, ["double"], **limits)  # type: ignore[arg-type]
        found = comparison.permitted
        assert comparison["double"].pattern != pattern(comparison.reference)
        assert found is not None
        told = comparison["double"].pattern
        assert told is not None
        assert found.relation(told) is PatternRelation.REALISABLE, limits
        witness = found.witness(told)
        assert witness is not None
        # On the end of the span falls an event, which a scene of smaller circles has a little later.
        again = ExactEngine().run(witness.scene, until=str(comparison.span + 1e-9))
        assert pattern(again) == told


def test_a_nearby_scene_has_a_certificate_of_its_own() -> None:
    comparison = with_certificates(compare(LAST, ["double"], until=6))
    told, found = comparison["double"].pattern, comparison.permitted
    assert told is not None and found is not None and found.relation(told) is PatternRelation.REALISABLE
    witness = found.witness(told)
    assert witness is not None and witness.certificate is not None and witness.certificate.checked
    document = comparison_json(comparison)
    jsonschema.Draft202012Validator(schema("comparison-5")).validate(document)
    attached = document["candidates"][0]["pattern"]["witness_certificate"]
    assert attached["independently_checked"] and attached["certificate"]["scene"]["circles"]
    assert "certified, and independently checked" in str(pattern_phrase(comparison, comparison["double"]))


def test_where_no_order_matters_only_the_own_pattern_is_permitted() -> None:
    box = [Wall(0, 0, 0, 1), Wall(8, 0, 8, 1), Wall(0, 0, 1, 0), Wall(0, 4, 1, 4)]
    scene = Scene([Circle(1, 1, r="1/2", vx=1, id="a"), Circle(4, "4/3", r="1/2", id="b")], box)
    found = permitted_patterns(study(scene, events=3))
    assert found is not None
    assert found.orders == (found.exact,)


def test_orders_whose_proofs_are_dear_are_followed_as_far_as_counted_signs_allow(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    signs: list[int] = []
    true = ExactEngine.run_with

    def counted(self: ExactEngine, *told: Any, **named: Any) -> Any:
        run = true(self, *told, **named)
        if named.get("policy", told[1] if len(told) > 1 else None) is not None:
            signs.append(int(run.plan.get("tower", 0)))
        return run

    scene, engine = catalogue.build("inscribed"), ExactEngine()
    study = Study(scene, engine, engine.run(scene))
    monkeypatch.setattr(ExactEngine, "run_with", counted)
    found = permitted_patterns(study)
    assert found is not None and not found.complete and found.followed
    assert 0 < sum(signs) <= ORDER_SIGNS + max(signs)


AT_A_TIE = Scene(
    [Circle("-68/3", "-85/3", "1/2", 4, 5, m=10, id="c")],
    [Wall("12/25", "7/50", "1/5", "11/10", id="a"), Wall("1/2", 0, "1/2", 1, id="b"),
     Wall("7/50", "12/25", "-41/50", "19/25", id="d")],
    restitution="9/10",
)  # fmt: skip
"""One disc meets three walls at t = 17/3; `single` meets the second of them an ulp later, past the end of one event."""

LATE_FOR_ONE = Scene(
    [
        Circle("70/3", "-70/3", "1/2", -2, 2, id="c"),
        Circle("-4/5", "7/30", "1/3", m="oo", id="peg"),
        Circle("-127/3", -9, 2, "7/2", "3/5", m=7, id="d"),
    ],
    [Wall(60, -60, 60, 60, id="east"), Wall(60, 60, -60, 60, id="north")],
    restitution="1/50",
)
"""After a tie one order comes to the north wall first, and to the east wall past the end of three events."""


@pytest.mark.parametrize(("scene", "events"), [(AT_A_TIE, 1), (LATE_FOR_ONE, 3)])
def test_an_order_is_found_though_its_last_meetings_fall_beside_the_end(scene: Scene, events: int) -> None:
    """It was said of both that no order of the impulses leads to them."""
    comparison = compare(scene, ["single"], events=events, sampled=False, audited=False)
    (candidate,) = comparison.candidates
    assert comparison.permitted is not None and candidate.pattern is not None
    assert comparison.permitted.complete
    assert comparison.permitted.relation(candidate.pattern) is PatternRelation.REALISABLE
