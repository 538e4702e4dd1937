"""Shadows under gravity, of what falls onto things that stand, and of what meets things that move."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest
from drawn_falls import edged, pegged, shifting
from flint import arb

from truebreak.compare import engine as engine_named
from truebreak.compare.shadowing.obstacle import Obstacle, margin
from truebreak.compare.shadowing.pseudo_orbit import FixedOrder, Node, in_the_frame, recorded, segments
from truebreak.compare.shadowing.shadows import shadow
from truebreak.exact import ExactEngine
from truebreak.exact.numbers import ball
from truebreak.floating import DoubleEngine
from truebreak.scenarios import Arc, Circle, Scene, Segment, Trajectory, Wall, catalogue
from truebreak.scenarios.engine import Declared


def streams(run: Trajectory, count: int) -> dict[str, list[Any]]:
    """Whom each circle meets, in order, of the first contacts of a run."""
    told = [pair for event in run.events for pair in event.impulses][:count]
    return {name: [pair for pair in told if name in pair] for name in run.scene.ids}


@pytest.mark.parametrize("drawn", [pegged, edged, shifting])
@pytest.mark.parametrize(("engine", "near"), [("double", 1e-11), ("single", 1e-2)])
def test_what_falls_onto_what_stands_or_moves_has_a_shadow(
    drawn: Callable[[int], Scene], engine: str, near: float
) -> None:
    """Pegs, ends, corners and arcs, met at zeros of quartics; faces; a bar and a block that move."""
    proved = left = 0
    for seed in range(4):
        scene = drawn(seed)
        found = shadow(scene, engine, events=20)
        left += found.divergence is not None
        if found.proof is None:
            continue
        proved += 1
        assert found.proof.run.certified
        assert found.proof.run_distance.position < near
        mine = engine_named(engine).run(scene, events=20)
        count = sum(len(event.impulses) for event in mine.events)
        assert streams(mine, count) == streams(found.proof.run, count)
        late = found.proof.run_distance.time * 1.01 + 1e-13
        for one, other in zip(mine.events, found.proof.run.events, strict=False):
            assert abs(float(one.time) - float(other.time)) <= late
        end = min(float(run.events[-1].time) for run in (mine, found.proof.run))
        times = [end * k / 301 for k in range(301)]
        apart = (mine.sample(times) - found.proof.run.sample(times))[:, :, :2]
        seen = float(((apart**2).sum(axis=2) ** 0.5).max())
        assert found.proof.run_distance.position / 100 < seen <= found.proof.run_distance.position * 1.01 + 1e-13
    assert proved >= 3
    assert left or engine == "double" or drawn is shifting


@pytest.mark.parametrize("name", ["galton", "plinko", "ramp", "ski-jump", "platforms", "bowl", "pinball-table"])
def test_scenes_of_the_catalogue_have_shadows(name: str) -> None:
    found = shadow(catalogue.build(name), "double", events=20)
    assert found.proof is not None, found.blocked
    assert found.proof.run_distance.position < 1e-11


def test_no_node_stands_between_contacts_that_are_all_but_one_instant() -> None:
    """Of a board that is its own mirror image: what a correction puts behind a node is not met from there."""
    scene = catalogue.build("peg-mirror")
    chain = segments(recorded(DoubleEngine().run(scene, events=30), 30), 1, falls=True)
    assert min(one.end - one.begin for one in chain) > 1e-6
    found = shadow(scene, "double", events=30)
    assert found.divergence is not None
    assert found.proof is not None, found.blocked


class Elsewhere(Declared):
    """An engine whose scene differs from the one that it is given."""

    name = "elsewhere"
    scene_keys = DoubleEngine.scene_keys

    def __init__(self, **changes: Any) -> None:
        self.changes = changes

    def run(self, scene: Scene, **limits: Any) -> Trajectory:
        return replace(DoubleEngine().run(scene.with_changes(**self.changes), **limits), scene=scene, engine=self.name)


FALLS = Scene(
    [Circle(0, 6, r="1/2", vx="1/7", id="a"), Circle("3/4", 2, r="1/2", m="oo", id="peg")],
    [Wall(-4, 0, -4, 1), Wall(4, 0, 4, 1), Wall(0, 9, 1, 9)],
    segments=[Segment(-5, 0, 5, "1/2", id="floor", vy="1/9")], gravity=(0, -2),
)  # fmt: skip


@pytest.mark.parametrize(
    "changes",
    [
        {"segments": [Segment(-5, 0, 5, "1/2", id="floor", vy="1/10")]},
        {"segments": [Segment(-5, 0, 5, "1/3", id="floor", vy="1/9")]},
        {"circles": [FALLS.circles[0], Circle("3/4", 2, r="1/3", m="oo", id="peg")]},
        {"gravity": (0, "-21/10")},
    ],
    ids=["its speed", "its slope", "a smaller peg", "gravity"],
)  # fmt: skip
def test_the_shadow_of_another_world_is_far_or_there_is_none(changes: dict[str, Any]) -> None:
    near, far = (shadow(FALLS, engine, events=14).proof for engine in ("double", Elsewhere(**changes)))
    assert near is not None
    assert near.run_distance.position < 1e-11
    assert {name for event in near.run.events for pair in event.impulses for name in pair} >= {"peg", "floor"}
    assert far is None or far.run_distance.position > 1e-3


@pytest.mark.parametrize(("x", "face"), [(-2, True), (-1, True), ("-1/2", False)])
def test_the_parts_of_what_moves_are_told_apart_where_they_are_then(x: Any, face: bool) -> None:
    """A bar comes from the left; as the disc falls onto it, at 2.12, it reaches from -4.76 to -0.76."""
    bar = Segment(-9, 0, -5, 0, id="bar", vx=2)
    scene = Scene([Circle(x, 5, r="1/2", id="disc")], segments=[bar], gravity=(0, -2))
    for engine in ExactEngine(), DoubleEngine():
        [(_, place)] = recorded(engine.run(scene, events=1), 1).links
        assert (place - len(scene.surfaces.circles) in scene.surfaces.faces) is face
        assert (place in scene.surfaces.ends) is not face


def test_a_certified_run_that_ends_early_says_so() -> None:
    """Of a ball that bounces to its end in a bowl no more is known there: it is not said to meet nothing more."""
    bowl = Arc(0, 0, 2, -2, 0, 2, 0, id="bowl")
    scene = Scene([Circle("1/7", 0, r="1/4", id="ball")], arcs=[bowl], gravity=(0, -10), restitution="1/5")
    found = shadow(scene, "double", events=13)
    assert found.blocked is not None
    assert found.blocked.obstacle is Obstacle.ORDER
    assert "the certified run of the start that was found ends after" in found.blocked.message
    assert "accumulation suspected" in found.blocked.message


# -- the map from node to node


def orbit(scene: Scene, contacts: int, events: int) -> tuple[FixedOrder, list[Node]]:
    """The map of a run of doubles in so many events a segment, and its nodes."""
    record = recorded(DoubleEngine().run(scene, events=contacts), contacts)
    order = FixedOrder(scene.surfaces, segments(record, events))
    nodes, done = list[Node](), dict.fromkeys(record.flights, 0)
    for segment in order.chain:
        node: Node = []
        for i, flights in record.flights.items():
            t, x, y, vx, vy = in_the_frame(scene, flights[done[i]])
            node += [arb(value) for value in (x + vx * (segment.begin - t), y + vy * (segment.begin - t), vx, vy)]
        nodes.append(node)
        for i in (i for link in segment.links for i in link if i in done):
            done[i] += 1
    return order, nodes


@pytest.mark.parametrize("scene", [FALLS, pegged(1), edged(2), shifting(1), shifting(2)], ids=lambda scene: scene.name)
def test_the_tangent_map_is_the_derivative_of_the_map(scene: Scene) -> None:
    """By differences, at 2**-90, in numbers of 256 bits."""
    with ball.precision(256):
        order, nodes = orbit(scene, 9, 3)
        small = arb(2) ** -90
        for k, node in enumerate(nodes):
            image, struck = order.image(k, node)
            tangent = order.tangent(k, struck)
            for column in range(len(node)):
                moved = order.image(k, [v + small * (place == column) for place, v in enumerate(node)])[0]
                by_differences = [float((a - b).mid() / small) for a, b in zip(moved, image, strict=True)]
                assert by_differences == pytest.approx(tangent[:, column].tolist(), rel=1e-9, abs=1e-9)


def test_the_map_keeps_nothing_of_what_it_did_before() -> None:
    """What a circle touched in one segment is not what it touches in the next."""
    with ball.precision(256):
        for seed in range(4):
            order, nodes = orbit(pegged(seed), 16, 3)
            used = [order.image(k, node)[0] for k, node in enumerate(nodes)]
            for k, node in enumerate(nodes):
                fresh = FixedOrder(order.scene, order.chain).image(k, node)[0]
                assert all(a == b or a.overlaps(b) for a, b in zip(used[k], fresh, strict=True))


def test_what_touches_at_the_start_falls_back_more_than_once() -> None:
    peg = Circle(0, 0, m="oo", id="peg")
    scene = Scene([Circle("1/100", 3, vy=3, r="sqrt(90001)/100 - 1", id="ball"), peg], gravity=(0, -2))
    assert scene.touching
    order, nodes = orbit(scene, 3, 1)
    assert len(nodes) == 3
    with ball.precision(256):
        assert all(order.image(k, node)[1] for k, node in enumerate(nodes))


def test_the_margin_at_an_end_that_moves() -> None:
    bar = Segment(-9, 0, -5, 0, id="bar", vx=2)
    scene = Scene([Circle(0, "1/4", r="1/2", id="disc")], segments=[bar])
    record = recorded(DoubleEngine().run(scene, events=1), 1)
    assert margin(scene.surfaces, record, 0) == pytest.approx(0.25)
