"""What the physics permits: all orders against a brute force, and the four classes."""

from __future__ import annotations

import math
from pathlib import Path
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
from truebreak.scenarios import Circle, Scene, Wall, catalogue
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
