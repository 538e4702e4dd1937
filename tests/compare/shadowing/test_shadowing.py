"""Shadows of engines' runs: proved by certified runs, refused where there is none, and the distances checked."""

from __future__ import annotations

import json
from collections import Counter
from dataclasses import replace
from pathlib import Path
from typing import Any

import jsonschema
import numpy as np
import pytest
from flint import arb

from truebreak.compare.cli import main
from truebreak.compare.engines import engine
from truebreak.compare.report.schema import schema
from truebreak.compare.report.search_text import at_most, shadow_sentences
from truebreak.compare.shadowing import shadows
from truebreak.compare.shadowing.obstacle import Obstacle, distance, margin
from truebreak.compare.shadowing.pseudo_orbit import (
    FIRST_BITS,
    GUARD_BITS,
    FixedOrder,
    ShortestCorrections,
    recorded,
    refined,
    segments,
)
from truebreak.compare.shadowing.shadows import longest, shadow
from truebreak.compare.tangent.impacts import NoTangentMap
from truebreak.exact import ExactEngine
from truebreak.exact.numbers import ball
from truebreak.floating.knots import DoubleMotion
from truebreak.scenarios import Circle, Contact, Event, Scene, SceneError, Wall, catalogue
from truebreak.scenarios.engine import Declared
from truebreak.scenarios.trajectory import Stop, StopReason, Trajectory


def call(arguments: list[str]) -> int:
    with pytest.raises(SystemExit) as stop:
        main(arguments)
    return int(stop.value.code or 0)


SHADOWED = [
    ("gas", "double", 260, 1e-11),
    ("gas:n=5", "single", 100, 1e-3),
    ("gas:n=3,mixed=yes,seed=2", "double", 150, 1e-10),
    ("gas:n=3", "pymunk:dt=1/1024", 30, 1e-2),
    ("pinball:r=0", "double", 40, 1e-12),
    ("hexagon", "double", 120, 1e-12),
    ("two-in-a-box", "double", 150, 1e-11),
    ("wedge:slope=2", "single", 60, 1e-3),
    ("falling-line", "single", 80, 1e-3),
    ("gas-under-gravity", "single", 120, 1e-2),
    ("cooling:n=6", "double", 120, 1e-11),
    ("piston", "single", 80, 1e-3),
]


@pytest.mark.parametrize(("spec", "name", "events", "near"), SHADOWED)
def test_a_run_past_its_divergence_is_the_true_history_of_a_start_nearby(
    spec: str, name: str, events: int, near: float
) -> None:
    scene = catalogue.build(spec)
    told = shadow(scene, name, events=events)
    assert told.divergence is not None and told.divergence.event < events
    assert told.proof is not None and told.blocked is None
    proof = told.proof
    assert proof.run.certified
    assert 0 < proof.start.position <= proof.run_distance.position < near

    # By other means: the start runs as the engine's run does, contact for contact, and stays by it at sampled times.
    again = ExactEngine().run(proof.scene, events=told.events)
    theirs = engine(name).run(scene, events=told.events)
    assert [e.impulses for e in again.events] == [e.impulses for e in theirs.events]
    end = min(float(again.events[-1].time), float(theirs.events[-1].time))
    times = [end * k / 701 for k in range(701)]
    apart = again.sample(times)[:, :, :2] - theirs.sample(times)[:, :, :2]
    seen = float(np.sqrt((apart**2).sum(axis=2)).max())
    assert seen <= proof.run_distance.position * 1.01 + 1e-13
    assert seen > proof.run_distance.position / 100
    gaps = [abs(float(a.time) - float(b.time)) for a, b in zip(again.events, theirs.events, strict=False)]
    assert max(gaps) <= proof.run_distance.time * 1.01 + 1e-13


def test_a_start_with_numbers_that_are_next_to_nothing_is_one() -> None:
    """On a line the corrections across it are rounding alone, 10**-80 and less."""
    told = shadow(catalogue.build("cradle"), "double", events=60)
    assert told.proof is not None and told.proof.run_distance.position < 1e-13


def test_flights_that_miss_are_told(capsys: pytest.CaptureFixture[str]) -> None:
    assert call(["shadow", "inscribed", "--engine", "single", "--events", "25"]) == 4
    told = capsys.readouterr().out
    assert "What stands in the way: a graze" in told
    assert "meet 0 of a diameter from missing each other, and by the flights that the engine reports they" in told


def test_the_exact_engine_shadows_itself() -> None:
    told = shadow(catalogue.build("gas:n=3"), "exact", events=60)
    assert told.divergence is None
    assert told.proof is not None and told.proof.run_distance.position < 1e-13


@pytest.mark.parametrize(
    ("spec", "engine", "events", "obstacle"),
    [
        ("lee", "double", 1, Obstacle.SIMULTANEOUS),
        ("rack:rows=2,gap=1/50", "double", 8, Obstacle.SIMULTANEOUS),
        ("tennis", "double", 1, Obstacle.SIMULTANEOUS),
        ("cradle:n=3", "single", 4, Obstacle.TOUCHING),
        ("reversal:n=3,after=5", "double", 8, Obstacle.SIMULTANEOUS),
        ("grazing", "double", 20, Obstacle.GRAZE),
    ],
)
def test_where_there_is_no_smooth_map_nothing_is_claimed(
    spec: str, engine: str, events: int, obstacle: Obstacle
) -> None:
    told = shadow(catalogue.build(spec), engine, events=events)
    assert told.proof is None
    assert told.blocked is not None and told.blocked.obstacle is obstacle


def test_a_coarse_step_is_carried_as_far_as_it_can_be_and_no_farther() -> None:
    scene = catalogue.build("gas:n=2")
    whole, best = longest(scene, "pymunk:dt=1/16", events=60)
    assert whole.proof is None and whole.blocked is not None
    assert best is not None and best.proof is not None
    assert 0 < best.events < whole.events
    assert shadow(scene, "pymunk:dt=1/16", events=best.events + 1).proof is None


class Damped(Declared):
    """A disc between two walls that leaves each with four fifths of its speed: no true orbit does that."""

    name = "damped"

    def run(
        self, scene: Scene, *, until: object = None, events: int | None = None, progress: object = None
    ) -> Trajectory:
        knots, told = [(0.0, 0.0, 0.0, 1.0, 0.0)], []
        for k in range(events or 0):
            t, x, y, vx, vy = knots[-1]
            place = 9.0 if vx > 0 else -9.0
            knots.append((t + (place - x) / vx, place, y, -0.8 * vx, vy))
            wall = Contact("c1", "right" if vx > 0 else "left")
            told.append(Event(k, knots[-1][0], (wall,), (wall,)))
        stop = Stop(StopReason.EVENTS, "reached the limit on instants")
        end = knots[-1][0]
        return Trajectory(scene, self.name, {}, tuple(told), stop, end, DoubleMotion([knots], end))


def test_an_engine_that_loses_energy_is_not_shadowed_and_the_drift_is_named() -> None:
    scene = Scene([Circle(0, 0, vx=1)], [Wall(10, 0, 10, 1, id="right"), Wall(-10, 0, -10, 1, id="left")])
    told = shadow(scene, Damped(), events=12)
    assert told.proof is None and told.blocked is not None
    assert told.drift == pytest.approx(1 - 0.64**12)
    assert told.blocked.obstacle is Obstacle.DRIFT, told.blocked


def test_an_ulp_of_one_state_is_no_drift_of_the_energy() -> None:
    scene = Scene([Circle(0, 0, vx=1, vy="1/7"), Circle(5, "1/3")])
    told = shadow(scene, "double", events=1)
    assert told.drift is not None and 0.0 < told.drift < 2.0**-51
    assert shadow_sentences(told)[-1] == "The engine's energy stays what it was, but for the rounding of its states."
    assert "drifts by 1e-14" in shadow_sentences(replace(told, drift=1e-14))[-1]


def test_a_proof_is_not_given_for_another_order() -> None:
    """A start whose true history is another one is refused, whatever the search made of it."""
    from truebreak.compare.shadowing.obstacle import other_history

    scene = catalogue.build("gas:n=3")
    left = engine("single").run(scene, events=90)
    truth = ExactEngine().run(scene, events=90)
    wrong = other_history(scene, recorded(left, 90), truth, recorded(truth, 90))
    assert wrong is not None and wrong.event is not None and wrong.event > 10
    assert other_history(scene, recorded(truth, 90), truth, recorded(truth, 90)) is None


def test_the_shortest_correction_closes_the_misfits_and_is_the_shortest() -> None:
    draw = np.random.default_rng(3)
    maps = [draw.standard_normal((4, 4)) for _ in range(5)]
    residuals = draw.standard_normal((5, 4))
    found = np.concatenate(ShortestCorrections(maps)(list(residuals)))
    matrix = np.zeros((20, 24))
    for k, block in enumerate(maps):
        matrix[4 * k : 4 * k + 4, 4 * k : 4 * k + 4] = block
        matrix[4 * k : 4 * k + 4, 4 * k + 4 : 4 * k + 8] = -np.eye(4)
    wanted = np.linalg.lstsq(matrix, -residuals.ravel(), rcond=None)[0]
    assert found == pytest.approx(wanted, rel=1e-9, abs=1e-12)


def test_corrections_are_as_exact_as_doubles_where_the_maps_stretch() -> None:
    """Elimination alone, which squares the condition of the equations, is good for half of the digits."""
    draw = np.random.default_rng(5)
    maps = [np.diag([2.0**13, 1.0, 1.0, 2.0**-13]) + draw.standard_normal((4, 4)) for _ in range(6)]
    residuals = draw.standard_normal((6, 4))
    solver = ShortestCorrections(maps)
    left = {}
    for name, steps in (("once", solver._least([-row for row in residuals])), ("mended", solver(list(residuals)))):
        rest = [row + m @ s - t for row, m, s, t in zip(residuals, maps, steps, steps[1:], strict=False)]
        left[name] = max(float(np.abs(row).max()) for row in rest)
    assert left["mended"] < 1e-14
    assert left["once"] > 1e-12


def test_where_long_segments_do_not_close_short_ones_are_tried(monkeypatch: pytest.MonkeyPatch) -> None:
    tried: list[int] = []
    true = shadows.refined

    def watched(order: FixedOrder, *rest: Any) -> Any:
        tried.append(len(order.chain))
        found = true(order, *rest)
        return replace(found, closed=False) if len(tried) == 1 else found

    monkeypatch.setattr(shadows, "refined", watched)
    assert shadow(catalogue.build("gas:n=3"), events=24).proof is not None
    assert tried == [3, 24]


@pytest.mark.parametrize("spec", ["gas:n=3,mixed=yes", "gas-under-gravity:n=3", "cooling:n=3", "piston:n=3", "lifted"])
def test_the_map_of_a_fixed_order_has_the_tangent_of_its_differences(spec: str) -> None:
    scene = LIFTED if spec == "lifted" else catalogue.build(spec)
    record = recorded(engine("double").run(scene, events=12), 12)
    chain = segments(record)
    assert [s.begin for s in chain[1:]] == [s.end for s in chain[:-1]]
    with ball.precision(300):
        order = FixedOrder(scene, chain)
        node = [arb(v) for i in order.free for v in record.flights[i][0][1:]]
        for k in range(4):
            image, struck = order.image(k, node)
            tangent = order.tangent(k, struck)
            step = arb(2) ** -100
            for column in range(len(node)):
                near = [v + step if c == column else v for c, v in enumerate(node)]
                slope = [float((a - b) / step) for a, b in zip(order.image(k, near)[0], image, strict=True)]
                assert tangent[:, column] == pytest.approx(slope, rel=1e-9, abs=1e-9)
            node = [value.mid() for value in image]


@pytest.mark.parametrize("spec", ["gas:n=3,mixed=yes", "gas-under-gravity:n=6,g=1/10", "peg-mirror:e=1", "stadium"])
def test_a_start_is_traced_back_from_a_node(spec: str) -> None:
    scene = catalogue.build(spec)
    record = recorded(engine("double").run(scene, events=12), 12)
    with ball.precision(400):
        order = FixedOrder(scene.surfaces, segments(record, 3))
        assert order.reversible
        start = [arb(v) for i in order.free for v in record.flights[i][0][1:]]
        node = start
        for k in range(3):
            node = [value.mid() for value in order.image(k, node)[0]]
        back = order.traced_back(3, node)
        assert all(value.is_exact() for value in back)
        assert max(abs(a - b) for a, b in zip(back, start, strict=True)) < arb(2) ** -300


@pytest.mark.parametrize("spec", ["cooling:n=3", "piston:n=3", "closing-wall"])
def test_no_start_is_traced_back_where_energy_is_lost_or_walls_move(spec: str) -> None:
    scene = catalogue.build(spec)
    with ball.precision(64):
        assert not FixedOrder(scene.surfaces, []).reversible


@pytest.mark.parametrize(("reversible", "most"), [(True, 0.72), (False, 0.68)])
def test_a_search_looks_at_fewer_segments_each_round(
    reversible: bool, most: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Those whose misfits are small enough for what is left of them where they count are let be."""
    looked = Counter[int]()
    true = FixedOrder.image

    def watched(order: FixedOrder, k: int, *rest: Any) -> Any:
        looked[len(order.chain)] += 1
        return true(order, k, *rest)

    monkeypatch.setattr(FixedOrder, "image", watched)
    monkeypatch.setattr(FixedOrder, "reversible", reversible)
    found = shadow(catalogue.build("gas"), events=1600)
    assert found.proof is not None and found.refinement is not None
    rounds, count = len(found.refinement.misfits), max(looked)
    assert looked[count] < most * rounds * count
    lost = found.refinement.bits - FIRST_BITS - GUARD_BITS
    assert rounds < 5 + lost / (80 if reversible else 40)


LIFTED = Scene(
    [Circle(0, 3, vx="1/3", id="a"), Circle("1/4", 6, id="b")],
    [Wall(0, 0, 5, 1, vy="1/2", id="floor"), Wall(-3, 0, -3, 1, id="l"), Wall(3, 0, 3, 1, vx="1/9", id="r")],
    gravity=(0, -2),
    restitution="9/10",
)
"""Two discs on a slope that rises, between walls that part."""


class OtherLaw(Declared):
    """An engine whose scene differs from the one that it is given."""

    name = "other-law"
    scene_keys = engine("double").scene_keys

    def __init__(self, changes: dict[str, Any]) -> None:
        self.changes = changes

    def run(self, scene: Scene, **limits: Any) -> Trajectory:
        other = scene.with_changes(**self.changes)
        return replace(engine("double").run(other, **limits), scene=scene, engine=self.name)


@pytest.mark.parametrize(
    "changes",
    [{"restitution": "89/100"}, {"gravity": (0, "-21/10")}, {"gravity": ("1/20", -2)}, {"walls": None}],
    ids=["restitution", "gravity", "its direction", "walls"],
)
def test_the_shadow_of_a_run_under_another_law_is_far_or_there_is_none(changes: dict[str, Any]) -> None:
    if "walls" in changes:
        slow = Wall(0, 0, 5, 1, vy="9/20", id="floor")
        changes = {"walls": [slow, *LIFTED.walls[1:]]}
    near = shadow(LIFTED, "double", events=24).proof
    far = shadow(LIFTED, OtherLaw(changes), events=24).proof
    assert near is not None and near.run_distance.position < 1e-11
    assert far is None or far.run_distance.position > 1e-3


def test_what_falls_by_steps_is_refused_in_one_line() -> None:
    with pytest.raises(SceneError, match="falls by steps, which is no flight of the law"):
        shadow(LIFTED, "pymunk:dt=1/64", events=4)


def test_the_energy_of_a_run_under_gravity_counts_its_fall_and_one_that_no_law_keeps_has_no_drift() -> None:
    falls = catalogue.build("falling-line")
    told = shadow(falls, "double", events=40)
    assert told.drift is not None and told.drift < 1e-13
    stronger = OtherLaw({"gravity": tuple(2 * part for part in falls.gravity or ())})
    lost = shadow(falls, stronger, events=10)
    assert lost.drift is not None and lost.drift > 1e-2
    assert shadow(LIFTED, "double", events=8).drift is None


def test_nodes_that_are_an_orbit_stay() -> None:
    scene = Scene([Circle(0, 0, vx=1), Circle(4, "1/2")], [Wall(9, 0, 9, 1)])
    run = engine("double").run(scene, events=2)
    chain = segments(recorded(run, 2))
    with ball.precision(256):
        order = FixedOrder(scene, chain)
        nodes = [[0.0, 0.0, 1.0, 0.0, 4.0, 0.5, 0.0, 0.0]]
        for k in range(len(chain)):
            image = order.image(k, [arb(v) for v in nodes[-1]])[0]
            nodes.append([float(v) for v in image])
    found = refined(order, nodes, [1.0] * 8)
    assert found.closed
    assert max(found.corrections) < -50


def test_a_distance_is_nothing_between_equal_runs_and_a_displacement_between_displaced_ones() -> None:
    scene = Scene([Circle(0, 0, vx=1)], [Wall(10, 0, 10, 1, id="a"), Wall(-10, 0, -10, 1, id="b")])
    run = ExactEngine().run(scene, events=6)
    told = distance(recorded(run, 6), run)
    assert told is not None and (told.position, told.velocity, told.time) == (0.0, 0.0, 0.0)
    moved = ExactEngine().run(Scene([Circle("1/8", "1/16", vx=1)], scene.walls), events=6)
    apart = distance(recorded(moved, 6), run)
    assert apart is not None
    assert apart.position == pytest.approx((1 / 64 + 1 / 256) ** 0.5)
    assert apart.time == pytest.approx(1 / 8)


def test_contacts_closer_to_each_other_than_the_runs_are_refused() -> None:
    walls = [Wall(1, 0, 1, 1, id="a"), Wall(-1, 0, -1, 1, id="b")]
    run = ExactEngine().run(Scene([Circle(0, 0, r="9/10", vx=1)], walls), events=4)
    late = ExactEngine().run(Scene([Circle("-1/10", 0, r="9/10", vx="1/4")], walls), events=4)
    assert distance(recorded(late, 4), run) is None


def test_the_margin_of_a_contact_is_what_is_left_to_a_miss() -> None:
    run = engine("double").run(Scene([Circle(0, 0, vx=1), Circle(4, "3/2")]), events=1)
    assert margin(run.scene, recorded(run, 1), 0) == pytest.approx(0.25)


def test_a_record_refuses_several_contacts_of_one_circle() -> None:
    run = engine("double").run(catalogue.build("lee"), events=1)
    with pytest.raises(NoTangentMap, match="middle has several contacts at one instant"):
        recorded(run, 1)


@pytest.mark.parametrize("value", [3.7643e-13, 0.0, 1.0, 9.999e-7, 123456.0])
def test_a_bound_is_never_told_too_small(value: float) -> None:
    assert value <= float(at_most(value)) <= value * 1.01


def test_a_scene_without_collisions_is_refused() -> None:
    with pytest.raises(SceneError, match="nothing collides"):
        shadow(Scene([Circle(0, 0, vx=1)]))


# -- the command


def test_the_command_proves_and_writes_the_start(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    near = tmp_path / "near.toml"
    assert call(["shadow", "gas:n=3", "--events", "120", "--write", str(near)]) == 0
    out = capsys.readouterr().out
    assert "Proved: a start within" in out and "diverges from the certified history" in out
    assert call(["run", str(near), "--events", "120", "--json"]) == 0
    history = [e["impulses"] for e in json.loads(capsys.readouterr().out)["events"]]
    assert call(["run", "gas:n=3", "--engine", "double", "--events", "120", "--json"]) == 0
    assert history == [e["impulses"] for e in json.loads(capsys.readouterr().out)["events"]]


@pytest.mark.parametrize("line", ["gas:n=3 --events 90", "lee", "cradle:n=3",
                                  "gas:n=2 --engine pymunk:dt=1/16 --events 60 --longest"])  # fmt: skip
def test_json_is_what_its_schema_says(line: str, capsys: pytest.CaptureFixture[str]) -> None:
    code = call(["shadow", *line.split(), "--json"])
    told = json.loads(capsys.readouterr().out)
    jsonschema.Draft202012Validator(schema("shadow-2")).validate(told)
    assert (told["proof"] is None) == (told["obstacle"] is not None) == (code == 4)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["gas", "--engine", "duoble"], "did you mean 'double'?"),
        (["gaz"], "did you mean 'gas'?"),
        (["gas", "--events", "0"], "too small"),
        (["gas", "--write", "/nowhere/near.toml"], "there is no folder"),
    ],
)
def test_bad_input_is_one_line(arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert call(["shadow", *arguments]) == 2
    told = capsys.readouterr().err
    assert message in told and len(told.splitlines()) == 1
