"""The audit under gravity and with a restitution: engines that keep the law pass, and planted faults are found."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from random import Random
from typing import Any

import pytest
from drawn_falls import pegged

from audit.faulty import Faulty
from audit.planted import PlantedSteps
from truebreak.compare import engine
from truebreak.compare.audit.audit import Audit, audit_run
from truebreak.exact import ExactEngine
from truebreak.floating import PymunkEngine
from truebreak.scenarios import Circle, Polygon, Quantity, Scene, SceneError, Segment, Wall, catalogue

FLOOR = Wall(0, 0, 1, 0, id="floor")


def scene_of(seed: int) -> Scene:
    """One to four discs of sizes off any grid, under gravity, in a box, a wedge or a shaft, some walls aslant."""
    draw = Random(f"audited fall {seed}")

    def part(low: int, high: int, of: int) -> str:
        return f"{draw.randint(low * of, high * of)}/{of}"

    discs = [
        Circle(
            f"{3 * (k % 2)} - 1 + {part(-1, 1, 97)}/3", f"{3 * (k // 2)} - 1 + {part(-1, 1, 89)}/3",
            r=f"{draw.randint(40, 90)}/101", m=draw.choice(("1", "2", "1/3")),
            vx=part(-3, 3, 31), vy=part(-3, 3, 37), id=f"c{k}",
        )
        for k in range(draw.randint(1, 4))
    ]  # fmt: skip
    floor = draw.choice((Wall(0, -6, 1, -6, id="floor"), Wall(-9, -8, 9, -7, id="floor")))
    sides = [Wall(-7, 0, -7, 1, id="left"), Wall(7, 0, "29/4", 9, id="right")]
    walls = draw.choice(
        ([floor, *sides], [floor, *sides, Wall(0, 6, 1, 6, id="top")],
         [Wall(0, -9, 5, -4, id="up"), Wall(0, -9, -4, -4, id="down")], [floor])
    )  # fmt: skip
    pull = draw.choice(((0, -1), (0, -10), ("1/7", -3)))
    return Scene(discs, walls, gravity=pull, restitution=draw.choice((1, 1, "9/10", "1/2")), name=f"fall {seed}")


SCENES = [scene_of(seed) for seed in range(40)]


@pytest.mark.parametrize(("seed", "bits"), [(75, 16), (66, 10)])
def test_bounces_that_take_no_time_by_the_clock_keep_the_law(seed: int, bits: int) -> None:
    """The last bounces take less than a last bit of the clock; gravity changes velocities in them all the same."""
    scene, chosen = pegged(seed), engine(f"rounded:bits={bits}")
    run = chosen.run(scene, until=40, events=60)
    assert len({float(event.time) for event in run.events}) < len(run.events)
    found = audit_run(run, chosen)
    assert found.kept, found.sentence


def among_pegs(seed: int) -> Scene | None:
    """The same discs among pegs, a point, a shelf, a blade and a hill; None where they do not fit in."""
    scene, draw = scene_of(seed), Random(f"pegs {seed}")

    def at(low: int, high: int) -> str:
        return f"{draw.randint(low * 71, high * 71)}/71"

    try:
        pegs = [Circle(at(-6, 6), at(-5, -2), r=f"{draw.randint(9, 60)}/73", m="oo", id=f"peg{k}") for k in range(3)]
        pegs.append(Circle(at(-5, 5), at(-5, -2), r=0, m="oo", id="point", point=True))
        bars = [
            Segment(at(-6, 6), at(-5, -2), at(-6, 6), at(-5, -2), r=draw.choice(("0", "1/9")), id=f"bar{k}")
            for k in range(2)
        ]
        x = draw.randint(-5, 3)
        hill = Polygon([(x, "-11/2"), (x + 2, "-11/2"), (x + 1, "-9/2")], r=draw.choice(("0", "1/10")), id="hill")
        return scene.with_changes(circles=[*scene.circles, *pegs], segments=bars, polygons=[hill])
    except SceneError:
        return None


AMONG = [scene for scene in map(among_pegs, range(200)) if scene is not None][:30]


def audited(chosen: Any, scene: Scene, events: int = 30) -> Audit:
    return audit_run(chosen.run(scene, events=events), chosen)


@pytest.mark.parametrize(
    ("name", "count"),
    [("double", 40), ("single", 40), ("quad", 12), ("rounded:bits=40", 12), ("interval", 12), ("exact", 8)],
)
def test_engines_of_events_keep_the_laws_under_gravity(name: str, count: int) -> None:
    chosen = engine(name)
    found = [audited(chosen, scene) for scene in SCENES[:count]]
    assert [audit.sentence for audit in found if not audit.kept] == []
    assert sum(audit.impacts for audit in found) > 10 * count


@pytest.mark.parametrize(
    ("name", "count"),
    [("double", 30), ("single", 30), ("quad", 8), ("rounded:bits=40", 8), ("interval", 8), ("exact", 6)],
)
def test_so_they_do_among_pegs_points_and_faces(name: str, count: int) -> None:
    chosen = engine(name)
    found = [audited(chosen, scene) for scene in AMONG[:count]]
    assert [audit.sentence for audit in found if not audit.kept] == []
    assert sum(audit.impacts for audit in found) > 5 * count


@pytest.mark.parametrize("text", ["axis", "ramp", "ski-jump", "platforms", "peg-mirror", "galton", "plinko"])
@pytest.mark.parametrize("name", ["double", "single", "pymunk:dt=1/1024", "pymunk"])
def test_so_they_do_on_the_boards_of_the_catalogue(text: str, name: str) -> None:
    chosen = engine(name)
    found = audited(chosen, catalogue.build(text), 60)
    assert found.kept is True, found.sentence
    assert found.impacts >= 4
    if chosen.step is not None:
        assert {defect.kind for defect in found.defects} >= {"integrator", "lateness"}


@pytest.mark.parametrize("name", ["double", "single", "quad", "exact"])
@pytest.mark.parametrize("falls", [True, False])
def test_they_keep_them_where_what_has_met_stays_closed(name: str, falls: bool) -> None:
    """At restitution 0 circles slide along walls and each other, or rest; of steps nothing is said under gravity."""
    chosen, impacts = engine(name), 0
    for scene in SCENES[:20]:
        closed = scene.with_changes(restitution=0, gravity=scene.gravity if falls else None)
        found = audited(chosen, closed)
        assert found.kept is True, (scene.name, found.sentence)
        impacts += found.impacts
    assert impacts > 20
    assert ("restitution 0" in audit_run(PymunkEngine().run(closed, until=1), PymunkEngine()).reason) == falls


@pytest.mark.parametrize("fault", [("restitution", 0.05), ("mass", 2.0), ("friction", 0.99), ("missed once", 0.0)])
def test_a_fault_is_found_at_restitution_0(fault: tuple[str, float]) -> None:
    told = "restitution 0.05 fits" if fault[0] == "restitution" else ""
    box = [FLOOR, Wall(-7, 0, -7, 1, id="left"), Wall(7, 0, 7, 1, id="right")]
    discs = [Circle(-3, "43/7", 1, "13/11", "1/5"), Circle(2, "19/3", "4/5", -1, "-1/7", 3), Circle("1/2", 9, "1/2", 1)]
    for pull in ("-1", "-1/1000"):
        for events in (3, 25):
            scene, chosen = Scene(discs, box, gravity=(0, pull), restitution=0), Faulty(*fault)
            found = audit_run(chosen.run(scene, events=events, until=60), chosen)
            assert found.kept is False, fault
            assert told in found.sentence, found.sentence


@pytest.mark.parametrize("bias", [1.0, 0.9**60, 0.0])
def test_steps_keep_the_laws_under_gravity(bias: float) -> None:
    """Whether an overlap is pushed out or not, in rest too."""
    chosen = PymunkEngine(dt=1 / 128, collision_bias=bias)
    found = [audited(chosen, scene, 24) for scene in SCENES[:14]]
    assert [audit.sentence for audit in found if audit.kept is not True] == []
    kinds = {defect.kind for audit in found for defect in audit.defects}
    assert {"integrator", "lateness"} <= kinds
    assert ("correction" in kinds) == (bias < 1)


def test_what_is_of_the_integrator_is_half_a_step_of_the_fall() -> None:
    """From rest at 10 the first flight, of 45 steps of 1/32, is 10 dt t / 2 behind that of a fall."""
    scene = Scene([Circle(0, 11)], [FLOOR], gravity=(0, -10))
    sizes = []
    for dt in (1 / 32, 1 / 64):
        chosen = PymunkEngine(dt=dt)
        found = audited(chosen, scene, 1)
        [late] = [defect for defect in found.defects if defect.kind == "integrator"]
        time = float(chosen.run(scene, events=1).events[0].time)
        assert late.size == pytest.approx(10 * dt * time / 2, rel=1e-9)
        assert (found.kept, late.order, late.of_step) == (True, None, True)
        sizes.append(late.size)
    assert sizes[0] / sizes[1] == pytest.approx(2, rel=0.05)


def test_the_energy_of_the_integrator_is_kept_where_nothing_is_pushed_out() -> None:
    """v**2/2 + g y + g dt v_y/2 at every knot; pymunk's own default pushes an overlap out, and lifts it."""
    scene, dt = Scene([Circle(0, "21/10", vx="1/3")], [FLOOR], gravity=(0, -1)), 1 / 64

    def energies(bias: float) -> list[float]:
        motion = PymunkEngine(dt=dt, collision_bias=bias).run(scene, until=12).motion
        return [vy * vy / 2 + y + dt * vy / 2 for _, _, y, _, vy in motion.knots[0]]  # pyright: ignore[reportAttributeAccessIssue]

    assert max(energies(1.0)) - min(energies(1.0)) < 1e-12
    assert max(energies(0.0)) - 2.1 > 0.02


Change = Callable[[Scene], Any]


class Otherwise:
    """An engine that is given another scene than the one that it says it ran."""

    def __init__(self, inner: Any, key: str, change: Change) -> None:
        self.inner, self.key, self.change = inner, key, change

    def __getattr__(self, name: str) -> Any:
        return getattr(self.inner, name)

    def finer(self) -> Otherwise:
        return Otherwise(self.inner.finer(), self.key, self.change)

    def firmer(self) -> Otherwise:
        return Otherwise(self.inner.firmer(), self.key, self.change)

    def run(self, scene: Scene, **limits: Any) -> Any:
        told = self.inner.run(scene.with_changes(**{self.key: self.change(scene)}), **limits)
        return replace(told, scene=scene)


def _times(text: str) -> Change:
    factor = Quantity.of(text)
    return lambda scene: scene.gravity and tuple(part * factor for part in scene.gravity)


FAULTS: dict[str, tuple[str, Change, str]] = {
    "gravity of the other sign": ("gravity", _times("-1"), ""),
    "gravity more by a millionth": ("gravity", _times("1 + 1/10**6"), "an acceleration of -1e-06 along y"),
    "no gravity": ("gravity", lambda scene: None, ""),
    "gravity aslant": (
        "gravity",
        lambda scene: (Quantity.of("1/10**6"), scene.gravity and scene.gravity[1]),
        "an acceleration of 1e-06 along x",
    ),
    "a restitution of 999 in 1,000": (
        "restitution",
        lambda scene: scene.restitution * Quantity.of("999/1000"),
        "restitution 0.999 fits",
    ),
}


ON_BOARDS = {
    ("galton", "gravity more by a millionth"): "an acceleration of -1e-05 along y",
    ("galton", "a restitution of 999 in 1,000"): "restitution 0.6993 fits",
    ("platforms", "gravity more by a millionth"): "an acceleration of -0.001 along y",
}
"""What the same faults are where g is 10, or 1,000, and the restitution .7."""


@pytest.mark.parametrize("fault", FAULTS)
@pytest.mark.parametrize("text", ["falling-line", "wedge", "gas-under-gravity", "galton", "platforms"])
@pytest.mark.parametrize("name", ["double", "pymunk"])
def test_a_planted_fault_is_found(fault: str, text: str, name: str) -> None:
    key, change, told = FAULTS[fault]
    found = audited(Otherwise(engine(name), key, change), catalogue.build(text), 40)
    assert found.kept is False
    told = ON_BOARDS.get((text, fault), told)
    assert told in found.sentence or name == "pymunk"
    assert name == "double" or key == "gravity" or told in found.sentence


def test_a_fault_of_a_trillionth_of_gravity_is_found_in_doubles() -> None:
    for text in ("falling-line", "wedge", "gas-under-gravity", "bounce"):
        assert (
            audited(Otherwise(engine("double"), "gravity", _times("1 + 1/10**12")), catalogue.build(text)).kept is False
        )


def _moved(what: str, place: int, by: str) -> Change:
    """Puts a segment elsewhere than the scene has it; or makes a peg smaller, by no more than nearly all of it."""
    off = Quantity.of(by)

    def circles(scene: Scene) -> Any:
        peg = scene.circles[place]
        r = peg.r + off if (peg.r + off).sign() > 0 else peg.r / 1000
        return [*scene.circles[:place], Circle(peg.x, peg.y, r, m="oo", id=peg.id), *scene.circles[place + 1 :]]

    def segments(scene: Scene) -> Any:
        return [
            Segment(s.x0, s.y0 + off, s.x1, s.y1 + off, r=s.r, id=s.id) if k == place else s
            for k, s in enumerate(scene.segments)
        ]

    return circles if what == "circles" else segments


@pytest.mark.parametrize("by", ["-1000", "-1/10**3", "-1/10**9"])
@pytest.mark.parametrize("name", ["double", "single", "pymunk"])
def test_what_stands_elsewhere_than_the_scene_says_is_found(by: str, name: str) -> None:
    """By much: what should have been hit is flown into. By a billionth only doubles show it, and steps by no length."""
    for text, what in (("axis", "circles"), ("ramp", "segments"), ("platforms", "segments"), ("plinko", "circles")):
        scene = catalogue.build(text)
        met = ExactEngine().run(scene, events=1).events[0].contacts[0].second
        things = scene.circles if what == "circles" else scene.segments
        place = next(k for k, thing in enumerate(things) if thing.id == met)
        found = audited(Otherwise(engine(name), what, _moved(what, place, by)), scene, 12)
        if by == "-1000" or name == "double" or (name == "single" and by == "-1/10**3" and text != "platforms"):
            assert found.kept is False, (text, found.sentence)
        if by == "-1000":
            assert any(met in violation.bodies for violation in found.violations), (text, found.sentence)


@pytest.mark.parametrize("name", ["double", "pymunk"])
@pytest.mark.parametrize("gravity", [None, (0, -1)])
def test_a_circle_that_an_engine_reports_elsewhere_from_the_start_is_found(name: str, gravity: Any) -> None:
    """It says itself where the circle is, so that nothing passes through it; the scene says something else."""
    scene = Scene(
        [Circle(0, 3, "1/2", vy=-1, id="a"), Circle("1/10", 0, "1/2", m="oo", id="peg")],
        [Wall(0, -3, 1, -3, id="floor")],
        gravity=gravity,
    )

    def aside(scene: Scene) -> Any:
        return [scene.circles[0], Circle(1000, 0, "1/2", m="oo", id="peg")]

    own = audited(Otherwise(engine(name), "circles", lambda scene: scene.circles), scene, 3)
    assert own.kept is True
    found = audited(Otherwise(engine(name), "circles", aside), scene, 3)
    assert found.kept is False and found.finding.count("peg begins 1e+03 from where") == 1, found.finding


def test_a_disc_that_falls_through_a_face_or_a_peg_is_found_when_it_comes_to_it_the_second_time() -> None:
    """Beside a platform it rises above its line and falls on it; straight up past a peg it falls back on it."""
    bar = Segment(-2, 0, 2, 0, id="bar")
    beside = Scene([Circle(-4, -2, "1/2", vx=2, vy=8, id="ball")], [], segments=[bar], gravity=(0, -8))
    past = Scene(
        [Circle("3/2", -4, "1/2", vx="-3/4", vy=8, id="ball"), Circle(0, 0, m="oo", id="peg")], gravity=(0, -8)
    )
    for scene, met, far in (
        (beside, "bar", beside.with_changes(segments=[])),
        (past, "peg", past.with_changes(circles=[past.circles[0], Circle(0, 0, "1/10**6", m="oo", id="peg")])),
    ):
        assert [met] == [event.contacts[0].second for event in ExactEngine().run(scene, events=1).events]
        run = replace(engine("double").run(far, until=9), scene=scene)
        assert not run.events
        found = audit_run(run, engine("double"))
        assert found.kept is False and f"ball and {met} fly" in found.finding, found.sentence


@pytest.mark.parametrize(("name", "seed"), [("double", 17), ("single", 17), ("rounded:bits=14", 197)])
def test_no_engine_of_events_falls_through_what_a_push_has_left_it_at(name: str, seed: int) -> None:
    """Where bounces on an end grow small, rounding left one that still approached, and it fell through: by .135."""
    scene = among_pegs(seed)
    assert scene is not None
    found = audited(engine(name), scene, 60)
    assert not {"gap", "depth"} & found.counts.keys(), found.sentence
    assert found.impacts > 40


def test_with_a_restitution_another_one_is_named_by_its_value() -> None:
    found = audited(Otherwise(engine("double"), "restitution", lambda scene: "89/100"), catalogue.build("bounce"))
    assert "restitution 0.89 fits 30 of 30 impacts" in found.sentence
    assert audited(engine("double"), catalogue.build("cooling")).kept is True
    lossless = audited(Otherwise(engine("double"), "restitution", lambda scene: 1), catalogue.build("cooling"))
    assert lossless.kept is False
    assert "restitution 1 fits" in lossless.sentence


def test_a_circle_that_is_left_to_fall_for_ever_through_a_floor_is_found() -> None:
    """The run says that nothing is left to happen, and has neither an impact nor a flight."""
    floor = Scene([Circle(0, 5)], [FLOOR], gravity=(0, -1))
    run = replace(engine("double").run(floor.with_changes(walls=())), scene=floor)
    assert not run.events and math.isfinite(float(run.final_time))
    found = audit_run(run, engine("double"))
    assert found.kept is False
    assert "c1 and floor fly" in found.finding


def test_every_time_is_a_number_where_bounces_come_to_an_end_within_rounding() -> None:
    """A single that is in its wall for all of its way up once made one that is none."""
    short = 0
    for seed in range(40):
        scene = scene_of(seed).with_changes(restitution="1/2")
        for name in ("single", "rounded:bits=12"):
            run = engine(name).run(scene, events=60)
            assert all(math.isfinite(float(event.time)) for event in run.events)
            short += len(run.events) < 60
    assert short > 20


@pytest.mark.parametrize("name", ["exact", "double"])
def test_energy_of_several_contacts_is_seen_from_an_end_that_moves(name: str) -> None:
    """Its push adds energy, as the ground sees it; seen from the end that pushes, all that collide lose some."""
    discs = [
        Circle("-1/5", "-3/20", "1/4", vx="-4/5", vy="19/10", id="disc"),
        Circle("-23/25", "3/50", "1/2", vx="-3/25", vy="33/50", m="1/2", id="other"),
    ]
    bar = Segment(0, 0, "9/5", "-12/5", vx="1/5", vy="-11/10", id="bar")
    scene = Scene(discs, [], segments=[bar], restitution="1/2", tie_policy="simultaneous")
    run = engine(name).run(scene, until=1)
    assert len(run.events[0].impulses) == 2
    assert audit_run(run, engine(name)).kept


@pytest.mark.parametrize("name", ["exact", "double", "interval:bits=200"])
def test_a_point_that_comes_to_a_thin_segment_from_below_falls_back(name: str) -> None:
    """Its place at the impact may be on either side by rounding; where it goes is no way through."""
    for k in range(1, 40, 3):
        point = Circle("5/2", "-7/2", 0, vy=Quantity.of(9) + Quantity.of(k) / 7, point=True, id="point")
        bar = Segment(-2, -2, 4, Quantity.of(2) - Quantity.of(k) / 11, id="bar")
        scene = Scene([point], [Wall(0, -4, 1, -4, id="floor")], segments=[bar], gravity=("1/3", -4))
        run = engine(name).run(scene, until=5, events=6)
        assert run.events[0].impulses[0].second == "bar"
        assert audit_run(run, engine(name)).kept, k


SHAFT = [FLOOR, Wall(-4, 0, -4, 1, id="left"), Wall(4, 0, 4, 1, id="right")]
FALLING = {
    "ground": Scene([Circle(0, 3, vx=1, id="a")], SHAFT, gravity=(0, -1), until=12),
    "discs": Scene([Circle(-3, 3, vx=1, id="a"), Circle(3, "7/2", vx=-1, id="b")], [FLOOR], gravity=(0, -1), until=6),
}


@pytest.mark.parametrize("step", [1 / 64, 1 / 60, 1 / 256])
@pytest.mark.parametrize("what", FALLING)
def test_what_falls_through_another_step_by_step_misses_it_however_short_the_steps(what: str, step: float) -> None:
    """A flight is one step there, and how much deeper two come in it falls with the step."""
    scene, blind = FALLING[what], "floor" if what == "ground" else what
    honest = audit_run(PlantedSteps(step).run(scene, until=scene.until), PlantedSteps(step))
    assert honest.kept is True, honest.sentence
    chosen = PlantedSteps(step, blind)
    found = audit_run(chosen.run(scene, until=scene.until), chosen)
    assert found.kept is False, found.sentence
    assert {violation.kind for violation in found.violations} == {"depth"}
    assert found.first is not None and "a" in found.first.bodies and "do not collide" in found.sentence
