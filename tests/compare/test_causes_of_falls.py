"""Causes of games' physics: what each kind of error adds under gravity, below restitution 1, and among moving walls."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from decimal import Decimal
from itertools import pairwise
from random import Random
from typing import Any, ClassVar

import other_runs
import pytest
from drawn_falls import edged, fallen, pegged, shifting
from flint import arb
from other_runs import comes_to, outlines_of
from refuting import refute

from truebreak.compare import compare
from truebreak.compare.audit.audit import audit_run
from truebreak.compare.candidate import Candidate
from truebreak.compare.causes import continuation, decision, free_flights, given_scene
from truebreak.compare.causes.diagnosis import CauseName
from truebreak.compare.engines import engine as engine_named
from truebreak.floating import PymunkEngine
from truebreak.scenarios import Circle, Scene, Segment, Wall, catalogue
from truebreak.scenarios.surfaces import parts_of

FLOOR = Wall(0, 0, 1, 0, id="floor")


def told(scene: Scene, chosen: Any, events: int = 40) -> Candidate:
    return compare(scene, [chosen], events=events).candidates[0]


def sizes(found: Candidate) -> Mapping[str, float]:
    assert found.diagnosis is not None
    return {row.cause.name: row.displacement or 0.0 for row in found.diagnosis.shares}


def adds_up(found: Candidate) -> None:
    """Shares are of the displacement, and all of it."""
    assert found.diagnosis is not None
    assert found.diagnosis.closed
    assert sum(row.share or 0.0 for row in found.diagnosis.shares) == pytest.approx(1.0, abs=1e-9)
    assert sum(sizes(found).values()) == pytest.approx(found.diagnosis.displacement, rel=1e-6)


@pytest.mark.parametrize("bias", [0.9**60, 0.0])
def test_what_pymunk_gains_at_restitution_1_is_position_correction(bias: float) -> None:
    """It hits a ceiling that the exact ball does not reach: how high it comes without the ceiling is measured apart."""
    ball, top = Circle(0, 2, id="ball"), Wall(0, "3001/1000", 1, "3001/1000", id="top")
    chosen = PymunkEngine(dt=1 / 64, collision_bias=bias)
    free = chosen.run(Scene([ball], [FLOOR], gravity=(0, -1)), until=4)
    gained = float(free.sample([k / 64 for k in range(96, 250)])[:, 0, 1].max()) - 2
    found = told(Scene([ball], [FLOOR, top], gravity=(0, -1)), chosen, 4)
    assert found.verdict == "diverged"
    adds_up(found)
    assert sizes(found)["CORRECTION"] == pytest.approx(-gained, rel=1e-9)
    assert abs(sizes(found)["INTEGRATOR"] + sizes(found)["LATENESS"]) < 0.2 * gained
    assert found.margin is not None
    assert found.margin.distance is not None
    assert found.margin.distance[0] == pytest.approx(1 / 1000)


def test_without_position_correction_it_comes_as_high_and_no_higher() -> None:
    scene = Scene([Circle(0, 2)], [FLOOR, Wall(0, "3001/1000", 1, "3001/1000", id="top")], gravity=(0, -1))
    assert told(scene, PymunkEngine(dt=1 / 64, collision_bias=1.0), 4).verdict == "agree"


def test_a_fall_half_a_step_late_is_of_the_integrator() -> None:
    """A ball that falls by h meets the floor at T = sqrt(2 h), a disc that comes from aside a little later.

    Up to the last step at n dt pymunk has it g dt n dt / 2 behind, from where the exact law brings it to the floor at
    another time, which is known in closed form. The disc, which falls alike, is not moved by that.
    """
    dt, late = 1 / 15, 1.5 / 300
    time = 30 * dt - 2 * late  # of the ball at the floor; the disc is there `late` later, both within one step
    height = time * time / 2
    meets = time + late
    scene = Scene(
        [Circle(0, repr(1 + height), id="ball"), Circle(repr(2 + meets), repr(1 + height), vx=-1, id="disc")],
        [FLOOR], gravity=(0, -1),
    )  # fmt: skip
    chosen = PymunkEngine(dt=dt)
    found = told(scene, chosen, 3)
    assert found.verdict == "diverged"
    adds_up(found)
    steps = 29
    fallen_by, speed = dt * dt * steps * (steps - 1) / 2, steps * dt
    wait = -speed + (speed * speed + 2 * (height - fallen_by)) ** 0.5
    behind = steps * dt + wait - time
    assert behind == pytest.approx(dt / 2, rel=0.1)
    assert abs(sizes(found)["INTEGRATOR"]) == pytest.approx(behind, rel=1e-6)
    assert found.diagnosis is not None
    assert {row.cause.name for row in found.diagnosis.shares if row.suffices} == {"INTEGRATOR"}


def accounts_that_close(drawn: Callable[[int], Scene], seeds: int, name: str) -> int:
    """How many divergences have an account; each closes, and no other run refutes it."""
    left = 0
    for seed in range(seeds):
        scene = drawn(seed)
        found = told(scene, engine_named(name), 60)
        if found.verdict != "diverged" or found.diagnosis is None or not found.diagnosis.shares:
            continue
        left += 1
        adds_up(found)
        assert "where no contact explains it" not in str([row.result for row in found.diagnosis.experiments])
        assert not refute(scene, engine_named(name), found), seed
    return left


@pytest.mark.parametrize("name", ["double", "single", "pymunk:dt=1/64"])
def test_the_account_closes_under_gravity_and_among_moving_walls(name: str) -> None:
    """What is carried on by the exact law, with all defects, is the engine's own run; no claim is refuted."""
    left = accounts_that_close(fallen, 24, name)
    assert left >= {"double": 0, "single": 2}.get(name, 8)


@pytest.mark.parametrize(("name", "least"), [("double", 2), ("single", 6), ("pymunk:dt=1/64", 6)])
def test_the_account_closes_among_pegs_under_gravity(name: str, least: int) -> None:
    """Where a contact is a zero of a quartic: what is carried on with all defects is the engine's own run."""
    assert accounts_that_close(pegged, 8, name) >= least


@pytest.mark.parametrize(("name", "least"), [("double", 1), ("single", 3), ("rounded:bits=12", 3)])
def test_the_account_closes_among_segments_polygons_and_arcs_under_gravity(name: str, least: int) -> None:
    """Of those that close none is refuted; what a contact that no exact law has leaves is not determined."""
    closed = 0
    for seed in (1, 3, 5, 8, 11):
        scene = edged(seed)
        found = told(scene, engine_named(name), 60)
        assert found.diagnosis is None or not refute(scene, engine_named(name), found), seed
        if found.verdict == "diverged" and found.diagnosis is not None and found.diagnosis.shares:
            adds_up(found)
            closed += 1
    assert closed >= least


@pytest.mark.parametrize(("name", "least"), [("single", 1), ("rounded:bits=12", 4)])
def test_the_account_closes_among_segments_and_polygons_that_move(name: str, least: int) -> None:
    """What is carried on from the engine's states is its own run, of faces and ends that move too."""
    closed = 0
    for seed in (0, 2, 4, 6, 8, 12):
        found = told(shifting(seed), engine_named(name))
        assert found.laws is not None
        assert found.laws.kept is True, (seed, found.laws.sentence)
        if found.diagnosis is not None and found.diagnosis.shares:
            adds_up(found)
            assert "where no contact explains it" not in str([row.result for row in found.diagnosis.experiments])
            closed += 1
    assert closed >= least


def test_an_audit_ends_where_a_flight_is_nearest_to_an_end_to_the_last_place() -> None:
    """In doubles the flight comes nearer still, by 1e-16, at the very time at which it is nearest."""
    chosen = engine_named("rounded:bits=12")
    assert audit_run(chosen.run(shifting(23), events=40), chosen).kept is True


def test_a_face_that_moves_is_where_the_rounded_scene_has_it() -> None:
    """A disc flies past the end of a bar that comes from aside; in 8 bits the end begins at 96, and it does not.

    Seen from the bar it flies with the velocity (1/8, -1), so that its line passes the end at |dx + 1/2| / |v|.
    """
    bar = Segment("9601/100", 0, 99, 0, id="bar", vx="-1/8")
    disc = Circle(95, 4, "1/2", id="disc", vy=-1)
    floor = Wall(0, -20, 1, -20, id="floor")
    found = told(Scene([disc], [floor], segments=[bar]), engine_named("rounded:bits=8"), 3)
    assert found.verdict == "diverged"
    adds_up(found)
    exact, own = ((place - 95 - 0.5) / (65 / 64) ** 0.5 - 0.5 for place in (96.01, 96.0))
    assert exact > 0 > own
    assert found.diagnosis is not None
    assert str(found.diagnosis) == "input rounding"
    assert sizes(found)["INPUT"] == pytest.approx(own - exact, rel=1e-6)
    assert found.margin is not None
    assert found.margin.distance is not None
    assert found.margin.distance[0] == pytest.approx(exact)


@pytest.mark.parametrize("spec", ["platforms", "plinko", "galton"])
def test_causes_among_what_a_level_is_made_of(spec: str) -> None:
    found = told(catalogue.build(spec), PymunkEngine(dt=1 / 256), 60)
    assert found.verdict == "diverged"
    adds_up(found)


@pytest.mark.parametrize("name", ["double", "single"])
def test_the_faces_of_something_thick_that_is_exact_are_rounded_by_the_engine(name: str) -> None:
    """A level whose numbers all are small integers: it is its own rounding, all together, that changes the decision."""
    found = told(catalogue.build("platforms"), engine_named(name), 60)
    adds_up(found)
    assert found.diagnosis is not None
    assert "INPUT" not in {k for k, size in sizes(found).items() if size}
    together = {row.cause.name: row.suffices for row in found.diagnosis.experiments}
    assert together["ARITHMETIC"] is True


def seen_otherwise(seeds: range, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """What looking at 20,000 places of a flight sees of a thing, and `ThingFall` does not say, of thrown discs."""
    monkeypatch.setattr(other_runs, "LOOKS", 20_001)
    found: list[str] = []
    for seed in seeds:
        scene = edged(seed).with_changes(gravity=(0, -1))
        draw, outlines = Random(seed), outlines_of(scene)
        for _ in range(6):
            numbers = draw.uniform(0, 8), draw.uniform(7, 9), draw.uniform(-2, 2), draw.uniform(-2, 3)
            state = given_scene.RoundedState(scene, None)
            for place, parts in parts_of(scene).items():
                fall = free_flights.ThingFall(state, 0, (arb(0), *map(arb, numbers)), parts)
                wait, margin, name = fall.wait(), fall.margin(), scene.ids[place]
                gap, late = comes_to(outlines[name], [Decimal(v) for v in numbers], (0, -1), Decimal("0.4"))
                if margin is not None and 0 < abs(float(margin.mid())) < 1e-5:
                    continue  # too near a graze to be seen
                if (late is None) is not (wait is None) or (wait is not None and abs(float(wait) - late) > 1e-9):  # type: ignore[operator]
                    found.append(f"{seed} {name} {numbers}: {wait} or {late}")
                elif late is not None and not (margin is not None and float(margin) < 0.0):
                    found.append(f"{seed} {name} {numbers}: hit, {margin}")
                elif gap is not None and gap < 1 and not (margin is not None and abs(float(margin) - gap) < 1e-6):
                    found.append(f"{seed} {name} {numbers}: {margin} or {gap}")
    return found


def test_when_a_thing_is_met_and_how_near_it_is_passed_is_what_looking_sees(monkeypatch: pytest.MonkeyPatch) -> None:
    assert seen_otherwise(range(36), monkeypatch) == []


def test_how_far_a_hit_is_from_a_miss_is_nothing_where_the_two_meet(monkeypatch: pytest.MonkeyPatch) -> None:
    """Between two flights beside each other, of which one hits, halving finds one that hits by as little as wanted."""
    turns = 0
    for seed in range(6):
        scene = edged(seed).with_changes(gravity=(0, -1))
        state, draw = given_scene.RoundedState(scene, None), Random(seed)
        speed = draw.uniform(-1, 1), draw.uniform(0, 2)
        for parts in parts_of(scene).values():

            def margin(x: float, parts: Any = parts, state: Any = state, speed: Any = speed) -> float | None:
                found = free_flights.ThingFall(state, 0, (arb(0), *map(arb, (x, 8, *speed))), parts).margin()
                return None if found is None else float(found)

            places = [k / 4 for k in range(-4, 37)]
            for low, high in pairwise(places):
                one, two = margin(low), margin(high)
                if one is None or two is None or one * two > 0:
                    continue
                turns += 1
                for _ in range(30):
                    middle = margin((low + high) / 2)
                    assert middle is not None
                    if middle * one > 0:
                        low = (low + high) / 2
                    else:
                        high = (low + high) / 2
                ends = margin(low), margin(high)
                assert max(map(abs, ends)) < 1e-6, (seed, parts, low)  # type: ignore[arg-type]
    assert turns > 20


@pytest.mark.parametrize("fault", ["range", "arc", "face", "end", "behind", "clear", "aside"])
def test_a_fault_in_how_things_are_met_is_seen(fault: str, monkeypatch: pytest.MonkeyPatch) -> None:
    within, side, wait, turns = (getattr(free_flights, n) for n in ("_faces", "_side_wait", "fall_wait", "_turns"))
    thing = free_flights.ThingFall
    face, aside, seen = thing._face_wait, thing._aside, thing._face

    def late(found: Any) -> Any:
        return None if found is None else found * 1.001

    if fault == "range":
        monkeypatch.setattr(free_flights, "_faces", lambda *of: not within(*of))
    elif fault == "arc":
        monkeypatch.setattr(free_flights, "_side_wait", lambda *of: late(side(*of)))
    elif fault == "face":
        monkeypatch.setattr(thing, "_face_wait", lambda self, k: late(face(self, k)))
    elif fault == "end":
        monkeypatch.setattr(free_flights, "fall_wait", lambda fall: late(wait(fall)))
    elif fault == "behind":
        monkeypatch.setattr(thing, "_face", lambda self, k: (*seen(self, k)[:3], not seen(self, k)[3]))
    elif fault == "clear":
        monkeypatch.setattr(free_flights, "_turns", lambda fall, sign: turns(fall, -sign))
    else:
        monkeypatch.setattr(thing, "_aside", lambda self, there: -aside(self, there))
    assert seen_otherwise(range(12), monkeypatch)


def test_contacts_of_one_instant_that_do_not_hang_together_are_told_apart() -> None:
    """Two that fall as each other's mirror image: each impulse is one through one contact, and none is `several`."""
    found = told(catalogue.build("peg-mirror"), engine_named("double"), 60)
    assert found.verdict == "diverged"
    adds_up(found)
    assert {"INPUT", "ARITHMETIC"} == {*sizes(found)}  # rounding of flights adds as much as of impulses


def test_a_rounded_gravity_and_a_rounded_restitution_are_input() -> None:
    """The scene as an engine is given it falls, and bounces, by doubles."""
    scene = Scene([Circle(0, 3)], [Wall(0, 0, 1, 0, id="floor", vy="1/3")], gravity=("1/7", "-1/3"), restitution="1/3")
    again = given_scene.rounded(scene)
    assert again.gravity is not None
    assert (float(again.gravity[1]), float(again.restitution)) == (-1 / 3, 1 / 3)
    assert again.gravity[1] != scene.gravity[1]  # type: ignore[index]
    assert again.restitution != scene.restitution
    assert again.walls[0].vy != scene.walls[0].vy
    assert given_scene.rounded(again) == again


def unexplained(found: Candidate) -> float:
    """What is of neither steps nor input: of flights and impulses that keep the law it is rounding."""
    assert found.diagnosis is not None
    names = {"FLIGHTS", "IMPACTS", "SOLVER"}
    return sum(abs(size) for name, size in sizes(found).items() if name in names)


@pytest.mark.parametrize("fault", ["gravity", "restitution", "drift"])
def test_an_engine_of_another_gravity_restitution_or_wall_is_seen(fault: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """What its steps do not explain is rounding of the engine, and far more where the account takes another law."""

    class Wrong(given_scene.RoundedState):
        def __init__(self, scene: Scene, bits: int | None) -> None:
            super().__init__(scene, bits)
            if fault == "gravity" and self.falling is not None:
                self.falling = self.falling._replace(hy=self.falling.hy * 1.01)
            elif fault == "restitution":
                self.share = (self.one if self.share is None else self.share) * 0.99
            else:
                self.drifts = {wall: (ux * 1.01, uy) for wall, (ux, uy) in self.drifts.items()}

    chosen = PymunkEngine(dt=1 / 64, collision_bias=1.0 if fault == "drift" else 0.0)
    scene = fallen(2) if fault == "drift" else ALONE
    right = told(scene, chosen, 60)
    adds_up(right)
    assert unexplained(right) < 1e-10
    for module in (continuation, decision):
        monkeypatch.setattr(module, "RoundedState", Wrong)
    assert unexplained(told(scene, chosen, 60)) > 1e-4


@pytest.mark.parametrize("fault", ["gravity", "wait"])
def test_a_peg_that_is_met_elsewhere_is_seen(fault: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """What steps do not explain is rounding, and far more where the account takes pegs to be met otherwise."""
    chosen, scene = PymunkEngine(dt=1 / 64), pegged(3)
    right = told(scene, chosen, 60)
    adds_up(right)
    assert unexplained(right) < 1e-10
    onto, wait = free_flights.fall_onto, free_flights.fall_wait

    def elsewhere(*of: Any) -> Any:
        fall = onto(*of)
        return fall._replace(hy=fall.hy * 1.01)

    def late(fall: Any) -> Any:
        found = wait(fall)
        return None if found is None else found * 1.01

    for module in (free_flights, continuation, decision, given_scene):
        if fault != "wait" and hasattr(module, "fall_onto"):
            monkeypatch.setattr(module, "fall_onto", elsewhere)
        if fault == "wait" and hasattr(module, "fall_wait"):
            monkeypatch.setattr(module, "fall_wait", late)
    wrong = told(scene, chosen, 60)
    assert wrong.diagnosis is not None
    lumped = "where no contact explains it" in str([row.result for row in wrong.diagnosis.experiments])
    assert lumped or not wrong.diagnosis.closed or unexplained(wrong) > 1e-4


ALONE = Scene([Circle(0, 2)], [FLOOR, Wall(0, "3001/1000", 1, "3001/1000", id="top")], gravity=(0, -1))


@pytest.mark.parametrize("spec", ["drop-pair", "wedge:slope=2", "falling-line", "gas-under-gravity"])
def test_a_report_has_every_kind_with_shares_that_add_up(spec: str) -> None:
    found = told(catalogue.build(spec), PymunkEngine(dt=1 / 64, collision_bias=0.9**60), 30)
    assert found.verdict == "diverged"
    adds_up(found)
    assert {"INTEGRATOR", "LATENESS", "CORRECTION"} <= {k for k, size in sizes(found).items() if abs(size) > 1e-3}
    assert abs(sizes(found)["FLIGHTS"]) + abs(sizes(found)["IMPACTS"]) < 1e-9  # which are rounding


def sticking(seed: int) -> Scene:
    """Four to nine discs in a box of which two walls are aslant, with gravity or without, at restitution 0."""
    draw = Random(seed)
    discs = [
        Circle(
            f"{2 * (k % 3) + 1} + {draw.randint(0, 90)}/100", f"{2 * (k // 3) + 2} + {draw.randint(0, 90)}/100", "2/5",
            f"{draw.randint(-300, 300)}/100", f"{draw.randint(-300, 300)}/100", draw.choice((1, 2, "1/3")),
        )
        for k in range(4 + seed % 6)
    ]  # fmt: skip
    walls = [FLOOR, Wall(0, 0, 0, 1, id="left"), Wall(9, 0, "19/2", 8, id="right"), Wall(0, 10, 1, "21/2", id="top")]
    return Scene(discs, walls, gravity=draw.choice((None, None, (0, -1), ("1/7", -1))), restitution=0)


@pytest.mark.parametrize("seed", [1, 9])
def test_the_account_closes_where_what_has_met_stays_closed(seed: int) -> None:
    """In numbers of 9 bits."""
    scene, chosen = sticking(seed), engine_named("rounded:bits=9")
    found = told(scene, chosen)
    assert found.verdict == "diverged"
    assert found.laws is not None
    assert found.laws.kept is True
    adds_up(found)
    assert not refute(scene, chosen, found)
    assert {row.cause.name for row in found.diagnosis.shares} <= {"INPUT", "FLIGHTS", "IMPACTS", "ARITHMETIC"}  # type: ignore[union-attr]


def test_without_an_account_a_finer_step_is_tried_alone() -> None:
    """A disc passes between two that close: steps of 1/8 find no gap, and shut it; those of 1/16 find one."""
    scene = Scene([Circle(0, 0, vx=2), Circle(4, "1/3"), Circle(8, 1)], restitution=0, gravity=(0, -1))
    found = compare(scene, [PymunkEngine(dt=1 / 8)], events=9).candidates[0]
    assert found.verdict == "diverged"
    assert found.diagnosis is not None
    assert found.diagnosis.name is CauseName["STEP"]
    assert not found.diagnosis.shares


class Soft(PymunkEngine):
    """Bounces too little, and says so of what is slower than its threshold."""

    allows: ClassVar[Mapping[str, float]] = {"threshold": 0.5}

    def run(self, scene: Scene, **limits: Any) -> Any:
        return replace(super().run(scene.with_changes(restitution="1/10"), **limits), scene=scene)


@pytest.mark.parametrize("slow", [True, False])
def test_a_bounce_below_a_declared_speed_is_of_the_threshold_and_a_faster_one_breaks_the_law(slow: bool) -> None:
    """Disc a comes back from the wall at .9 of its speed, and passes b; at .1 of it b hits it."""
    u = "1/4" if slow else "1"
    discs = [Circle(3, 0, vx=f"-{u}", id="a"), Circle("11/4", 7, vy=f"-{u} * 7/20", id="b")]
    scene = Scene(discs, [Wall(0, 0, 0, 1, id="left")], restitution="9/10")
    assert told(scene, PymunkEngine(dt=1 / 64), 6).verdict == "agree"
    found = told(scene, Soft(dt=1 / 64), 6)
    assert found.verdict == "diverged"
    assert found.diagnosis is not None
    if slow:
        adds_up(found)
        shares = {row.cause.name: row for row in found.diagnosis.shares}
        assert shares["THRESHOLD"].suffices
        assert shares["THRESHOLD"].share == pytest.approx(1, abs=0.01)
        assert "SOLVER" not in shares
    assert [cause.name for cause in found.diagnosis.causes] == ["THRESHOLD" if slow else "LAW"]


# -- the audit, where walls move


MOVING = [scene for scene in map(fallen, range(60)) if scene.moving_walls]


@pytest.mark.parametrize("name", ["double", "single", "quad", "rounded:bits=12", "pymunk:dt=1/64"])
def test_engines_keep_the_laws_among_walls_that_move(name: str) -> None:
    found = []
    for k, scene in enumerate(MOVING[:8]):
        floor = Wall(0, 0, 1, 0, id="floor", vy="1/50" if k % 2 else 0)
        chosen, whole = engine_named(name), scene.with_changes(walls=[floor, *scene.walls[1:]])
        found.append(audit_run(chosen.run(whole, events=40), chosen))
    assert [audit.sentence for audit in found if audit.kept is not True] == []
    assert sum(audit.impacts for audit in found) > 160


class Misreads(PymunkEngine):
    """Takes walls that move for slower ones."""

    def run(self, scene: Scene, **limits: Any) -> Any:
        return replace(super().run(slower(scene), **limits), scene=scene)


def slower(scene: Scene) -> Scene:
    walls = [Wall(w.x0, w.y0, w.x1, w.y1, id=w.id, vx=w.vx * "24/25", vy=w.vy) for w in scene.walls]
    return scene.with_changes(walls=walls)


@pytest.mark.parametrize("steps", [False, True])
def test_an_engine_that_takes_a_wall_for_a_slower_one_is_found(steps: bool) -> None:
    for scene in MOVING[:6]:
        chosen = Misreads(dt=1 / 64) if steps else engine_named("double")
        run = chosen.run(scene if steps else slower(scene), events=40)
        assert any("right" in pair for event in run.events for pair in event.impulses)
        assert audit_run(replace(run, scene=scene), chosen).kept is False


# -- the restitution that bounces have


def test_the_audit_says_the_restitution_that_bounces_have() -> None:
    """Of doubles it is the one asked for; what pymunk's have under gravity is computed from its states, apart."""
    scene = catalogue.build("bounce")
    exact = audit_run(engine_named("double").run(scene, events=6), engine_named("double")).bounces
    assert exact is not None
    assert (exact.low, exact.high) == pytest.approx((0.9, 0.9), abs=1e-12)
    chosen = PymunkEngine(dt=1 / 60)
    run = chosen.run(scene, events=6)
    found = audit_run(run, chosen).bounces
    assert found is not None
    ratios = [  # of the speed with which a step of g dt more brings it there, and with which it leaves
        -float(run.after(event.index)["ball"].vy) / (float(run.at(float(event.time) - 1 / 120)["ball"].vy) - 10 / 60)
        for event in run.events
    ]
    assert found.count == len(ratios)
    assert (found.low, found.high) == pytest.approx((min(ratios), max(ratios)), rel=1e-6)
    assert found.high < 0.899
    assert f"; asked for restitution 0.9, its {len(ratios)} bounces have" in audit_run(run, chosen).sentence


def test_an_elastic_scene_has_no_word_of_restitution() -> None:
    chosen = engine_named("double")
    assert audit_run(chosen.run(catalogue.build("wedge"), events=6), chosen).bounces is None
