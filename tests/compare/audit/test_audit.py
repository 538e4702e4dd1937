"""The audit: what keeps the laws passes, in any formulation, and a planted fault is found and described."""

from __future__ import annotations

import math
import random
import shlex
import subprocess
import sys
from dataclasses import dataclass, replace
from fractions import Fraction
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest

import truebreak
from audit.planted import FAULTS, Planted, PlantedSteps
from truebreak.compare import compare, engine
from truebreak.compare.audit.audit import Audit, audit_run
from truebreak.compare.audit.passages import FEW, passages
from truebreak.compare.audit.residual import AUDIT_BITS
from truebreak.compare.audit.residuals import Laws
from truebreak.compare.audit.transcript import Transcript
from truebreak.compare.cli.entry import main
from truebreak.compare.foreign import Recording
from truebreak.compare.foreign.impulses import strengths_of
from truebreak.compare.foreign.log_engine import LogEngine
from truebreak.compare.grids.stress_families import drift, kick, scaled
from truebreak.compare.scene_argument import scene_from
from truebreak.compare.testing.check import CheckFailed, NotDecided, check
from truebreak.exact.numbers import ball
from truebreak.floating import DoubleEngine
from truebreak.scenarios import Circle, Pocket, Quantity, Scene, Wall, catalogue

SCENES = [
    "gas", "gas:n=10,mixed=yes", "cradle", "cradle:gap=0", "tennis", "sizes", "galperin:n=3", "lee", "near-tie",
    "inscribed", "rack", "rack:rows=3,jitter=1/1000", "reversal", "echo", "pinball", "pinball:r=0", "article",
]  # fmt: skip


def audited(name: Any, scene: Scene, **limits: Any) -> Audit:
    chosen = engine(name) if isinstance(name, str) else name
    return audit_run(chosen.run(scene, **limits), chosen)


@pytest.mark.parametrize("name", ["double", "single", "quad", "rounded:bits=30", "interval", "pymunk"])
@pytest.mark.parametrize("scene", SCENES)
def test_every_step_of_our_engines_keeps_the_laws(name: str, scene: str) -> None:
    found = audited(name, scene_from(scene), events=120)
    assert found.kept is True, found.sentence


def test_the_exact_engine_keeps_the_laws_to_the_doubles_nearest_to_its_numbers() -> None:
    for scene in ("gas", "reversal", "rack:rows=3"):
        assert audited("exact", scene_from(scene), events=40).kept is True


@pytest.mark.parametrize("scene", ["gas", "gas:mixed=yes", "sizes", "galperin", "pinball", "rack:rows=3,jitter=1/1000"])
def test_another_formulation_keeps_them_too(scene: str) -> None:
    found = audited(Planted(), scene_from(scene), events=200)
    assert found.kept is True, found.sentence


@pytest.mark.parametrize("fault", FAULTS)
@pytest.mark.parametrize("scene", ["gas:mixed=yes", "gas:mixed=yes,seed=5"])
def test_a_planted_fault_is_found(scene: str, fault: str) -> None:
    found = audited(Planted(**FAULTS[fault]), scene_from(scene), events=60)
    assert found.kept is False, fault
    assert found.first is not None


@pytest.mark.parametrize(
    ("fault", "told"),
    [
        ("restitution 0.98", "restitution 0.98 fits 60 of 60 impacts"),
        ("restitution 0.999", "restitution 0.999 fits 60 of 60 impacts"),
        ("walls give 3 % less", "restitution 0.94 at walls (an impulse 3 % less) fits 26 of 26 impacts"),
        ("masses equal", "masses taken for equal fits 32 of 32 impacts"),
        ("one mass 1 % more", "the mass of c1 taken for 1.01 fits 4 of 4 impacts"),
        ("one radius 1e-9 more", "the radius of c1 taken for 1e-09 more fits 7 of 7 impacts"),
        ("one impact weak", "restitution 0.9 at event 7 alone (c1 and top) fits 1 of 1 impacts"),
        ("friction", "the speed across the contact becomes 0.999999 of what it was between circles fits 32"),
        ("pushed apart", "places moved by 1e-12, without a flight fits 28 of 28 flights"),
        ("gravity", "an acceleration of -1e-10 along y fits 90 of 90 flights"),
    ],
)
def test_a_fault_is_described_as_what_it_is(fault: str, told: str) -> None:
    found = audited(Planted(**FAULTS[fault]), scene_from("gas:mixed=yes"), events=60)
    assert told in found.finding


def test_a_fault_is_found_at_any_length() -> None:
    """Long after a history is lost: at event 3,000 of a run whose errors have filled the box by event 160."""
    once = Planted(once=(3000, 0.999))
    found = audited(once, scene_from("gas"), events=3010)
    assert found.kept is False
    assert found.first is not None
    assert (found.first.event, found.counts) == (3000, {"impulse": 1})


def test_a_missed_contact_is_a_depth_in_the_engines_own_flights() -> None:
    found = audited(Planted(missed=3), scene_from("gas"), until=40)
    assert "depth" in found.counts
    assert found.violations[0].kind == "depth"
    assert found.violations[0].bodies == ("c5", "c10")


@pytest.mark.parametrize(("dt", "kept"), [(1 / 60, False), (2.0, None)])
def test_a_log_of_steps_that_flies_through_a_disc_for_many_steps_breaks_the_law(dt: float, kept: bool | None) -> None:
    """Of a log no finer step can be run: where fewer steps end in the overlap than it takes to see it, all is open."""
    peg = Circle(0, "1/3", m="oo", id="peg")
    scene = Scene([Circle(-3, 0, vx=1, id="ball"), peg, Circle(0, 9, vx=1, id="other")])
    recording = Recording(scene, "log", step=dt)
    for n in range(1, int(9 / dt)):
        recording.state(n * dt, {"ball": (-3 + n * dt, 0.0, 1.0, 0.0), "other": (n * dt, 9.0, 1.0, 0.0)})
    recording.end(int(9 / dt) * dt)
    log = LogEngine(recording, step=dt)
    found = audit_run(log.run(scene), log)
    assert found.kept is kept, found.sentence
    assert ("ball and peg fly 1.67 into each other" if kept is False else "missed 1.67") in found.sentence


@pytest.mark.parametrize("name", ["hexagon", "breakout", "galton", "peg-mirror", "ski-jump"])
def test_steps_however_long_see_no_overlap_that_they_cannot_push_at(name: str) -> None:
    """The two part at the first end of a step in it, or another contact turns one of them at that end."""
    scene = catalogue.build(name)
    for dt in (1 / 2, 1 / 10):
        steps = engine(f"pymunk:dt={dt}")
        found = audit_run(steps.run(scene, until=min(20.0, float(scene.until or 20)), events=200), steps)
        assert found.kept is True, (dt, found.sentence)


@pytest.mark.parametrize("far", [10**6, 10**9])
@pytest.mark.parametrize("scale", [1, 2**200, -(2**200)])
def test_far_origins_and_other_units_break_no_law(far: int, scale: int) -> None:
    k = f"2**{200 if scale > 0 else -200}" if abs(scale) > 1 else "1"
    circles = [
        Circle(f"({far}) * {k}", 0, f"{k}", vx=f"-1 * {k}", vy=f"1/9 * {k}"),
        Circle(f"({far} - 9) * {k}", f"{k}", f"{k}"),
        Circle(f"({far} - 15) * {k}", 0, f"2 * {k}", m=5),
    ]
    walls = [Wall(f"({far} - 30) * {k}", 0, f"({far} - 30) * {k}", f"{k}"),
             Wall(f"({far} + 10) * {k}", 0, f"({far} + 10) * {k}", f"{k}"),
             Wall(0, f"-10 * {k}", f"{k}", f"-10 * {k}"), Wall(0, f"10 * {k}", f"{k}", f"10 * {k}")]  # fmt: skip
    for name in ("double", "quad"):
        found = audited(name, Scene(circles, walls), events=40)
        assert found.kept is True, (name, found.sentence)


@pytest.mark.parametrize("away", [3, 100, 2000])
def test_a_near_graze_is_missed_or_hit_within_the_room_of_the_textbooks_formula(away: int) -> None:
    """Its discriminant is off by u b**2: a gap, or a depth, of u d**2 / R, and a time off by the root of u."""
    draw = random.Random(away)
    for _ in range(100):
        off = 2 * (1 - draw.uniform(-1, 1) * 10.0 ** draw.randint(-17, -12))
        scene = Scene([Circle(0, 0, vx=1), Circle(away, off)])
        found = audited(Planted(), scene, until=2 * away)
        assert found.kept is True, found.sentence


LEE = catalogue.build("lee")


def recorded(scene: Scene, time: float, pairs: Any, **states: tuple[float, float, float, float]) -> Audit:
    recording = Recording(scene, "told")
    recording.hits(time, pairs, states)
    recording.end(quiet=True)
    run = recording.trajectory()
    return audit_run(run, LogEngine(recording, "told"))


@pytest.mark.parametrize(
    ("scene", "name"),
    [
        (drift(8, "in", 0), "pymunk"),  # a graze within one step, which halved steps do not tell
        (kick(10, "left", 0), "pymunk"),  # a change by 4e-10 of a velocity of 1
        (kick(7, "right", 0), "pymunk"),
        (scaled(11, "down", 1), "single"),  # fourth powers are below the least number of 32 bits
    ],
)
def test_what_an_honest_engine_cannot_help_breaks_no_law(scene: Scene, name: str) -> None:
    (candidate,) = compare(scene, [name], causes=False).candidates
    assert candidate.laws is not None
    assert candidate.laws.kept is True, candidate.laws.sentence


@pytest.mark.parametrize("velocities", [(-2.0, -1.0, 0.0), (-2.2, -0.32, -0.12), (-1.6, -1.56, 0.04)])
def test_any_order_of_simultaneous_impulses_is_permitted(velocities: tuple[float, float, float]) -> None:
    """Lee's three balls: all three outcomes of the one instant, and none that is turned, or gains energy."""
    (event,) = DoubleEngine().run(LEE).events
    places = [float(c.x) + float(c.vx) * float(event.time) for c in LEE.circles]
    ids = [str(c.id) for c in LEE.circles]
    rows = {name: (x, 0.0, v, 0.0) for name, x, v in zip(ids, places, velocities, strict=True)}
    assert recorded(LEE, float(event.time), event.impulses, **rows).kept is True
    turned = rows | {ids[0]: (places[0], 0.0, velocities[0], 0.1), ids[1]: (places[1], 0.0, velocities[1], -0.1)}
    assert set(recorded(LEE, float(event.time), event.impulses, **turned).counts) >= {"impulse"}
    faster = rows | {ids[0]: (places[0], 0.0, velocities[0] - 1e-6, 0.0), ids[2]: (places[2], 0.0, velocities[2], 0.0)}
    assert recorded(LEE, float(event.time), event.impulses, **faster).kept is False


def test_a_contact_does_not_pull() -> None:
    """Two that touch and part, and are drawn together."""
    scene = Scene([Circle(0, 0, vx=-1, id="a"), Circle(2, 0, vx=1, id="b")])
    found = recorded(scene, 0.0, [("a", "b")], a=(0.0, 0.0, 1.0, 0.0), b=(2.0, 0.0, -1.0, 0.0))
    assert "impulse" in found.counts


def test_a_contact_without_an_impulse_breaks_no_law_and_is_counted() -> None:
    scene = Scene([Circle(0, 0, vy=1, id="a"), Circle(2, 0, vy=1, id="b")])
    found = recorded(scene, 1.0, [("a", "b")], a=(0.0, 1.0, 0.0, 1.0), b=(2.0, 1.0, 0.0, 1.0))
    assert (found.kept, found.phantoms) == (True, (1, 0, 0.0))


def test_without_states_nothing_is_said_of_the_laws() -> None:
    log = LogEngine.of([(2.0, "a", "b")], Scene([Circle(0, 0, vx=1, id="a"), Circle(4, 0, id="b")]))
    found = audit_run(log.last, log)
    assert found.kept is None
    assert "no states" in found.reason


def test_what_an_engine_declares_is_its_model() -> None:
    class Spaced(Planted):
        allows = {"margin": 2e-9}  # noqa: RUF012

    found = audited(Spaced(nudge=1e-9), scene_from("gas"), events=40)
    assert found.kept is True
    assert found.declared["margin"] > 0
    assert audited(Spaced(nudge=1e-8), scene_from("gas"), events=40).kept is False


@pytest.mark.parametrize(("declared", "kept"), [(1e-6, True), (1e-8, False), (0.0, False)])
def test_a_declared_friction_is_its_model(declared: float, kept: bool) -> None:
    class Cloth(LogEngine):
        allows = {"deceleration": declared}  # noqa: RUF012

    scene, f = Scene([Circle(0, 0, vx=1, id="a"), Circle(4, 0, id="b")]), 1e-6
    time = (1 - math.sqrt(1 - 4 * f)) / f  # t - f t**2 / 2 = 2
    recording = Recording(scene, "told")
    recording.hits(time, [("a", "b")], {"a": (2.0, 0.0, 0.0, 0.0), "b": (4.0, 0.0, 1 - f * time, 0.0)})
    recording.end(quiet=True)
    found = audit_run(recording.trajectory(), Cloth(recording, "told"))
    assert found.kept is kept
    assert bool(found.declared) is kept


@pytest.mark.parametrize("dt", ["1/64", "1/256", "1/1024"])
def test_lateness_and_overlap_are_of_the_step(dt: str) -> None:
    found = audited(f"pymunk:dt={dt}", scene_from("gas"), events=40)
    assert found.kept is True
    (late,) = [defect for defect in found.defects if defect.kind == "lateness"]
    assert 0 < late.size <= 2 * eval(dt)


@pytest.mark.parametrize("elasticity", [0.98, 0.999])
def test_a_restitution_of_an_engine_of_steps_is_no_matter_of_its_step(
    elasticity: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    from truebreak.floating import pymunk_space as space

    monkeypatch.setattr(space, "ELASTICITY", math.sqrt(elasticity))  # the product of the two of a contact
    found = audited("pymunk", scene_from("gas"), events=25)
    assert found.kept is False
    assert f"restitution {elasticity} fits 25 of 25 impacts" in found.finding


@pytest.mark.parametrize("step", [1 / 64, 1 / 60])
@pytest.mark.parametrize("height", ["3/8", "3/4", "1", "11/8"])
def test_an_impulse_that_is_too_strong_at_every_step_is_no_matter_of_the_step(height: str, step: float) -> None:
    """The only one at that wall is the run's last, and comes a hair later in finer steps."""
    scene = Scene([Circle(-2, 0, vx=1, id="a"), Circle(2, height, id="b")], [Wall(0, 6, 1, 6, id="top")])
    for strong, kept in ((1.0, True), (1.1, False)):
        chosen = PlantedSteps(step, strong=("top", strong))
        found = audit_run(chosen.run(scene, until=30), chosen)
        assert found.kept is kept, found.sentence
    (defect,) = (defect for defect in found.defects if defect.kind == "impulse")
    assert defect.size == pytest.approx(0.2) and defect.finest == pytest.approx(0.2) and defect.of_step is False


@dataclass(frozen=True)
class Tired(PlantedSteps):
    """Ends its runs at some time, with a finer step or with more iterations, of which it says that it has some."""

    patience: float = math.inf
    says: bool = True
    given: bool = True

    def finer(self) -> Tired:
        return replace(self, step=self.step / 2, given=False)

    def firmer(self) -> Tired:
        return replace(self, given=False)

    def play(self, scene: Scene, recording: Recording) -> None:
        super().play(scene, recording if self.given else Ending(recording, self))  # pyright: ignore


class Ending:
    """Hands on what is reported until patience ends."""

    def __init__(self, told: Recording, engine: Tired) -> None:
        self.told, self.engine, self.hits = told, engine, told.hits

    @property
    def open(self) -> bool:
        return self.told.open

    def state(self, time: float, rows: Any) -> None:
        self.told.state(time, rows)
        if time >= self.engine.patience:
            _ = self.told.spent("patience") if self.engine.says else self.told.end(time)


@pytest.mark.parametrize("says", [True, False])
@pytest.mark.parametrize("patience", [1.0, 4.0, math.inf])
def test_a_run_that_ends_before_the_impact_is_evidence_of_nothing(patience: float, says: bool) -> None:
    """Too strong an impulse is not one of too few iterations, for a run with more that does not come to it."""
    scene = Scene([Circle(-2, 0, vx=1, id="a"), Circle(2, "3/4", id="b")], [Wall(0, 6, 1, 6, id="top")])
    chosen = Tired(strong=("top", 1.1), patience=patience, says=says)
    found = audit_run(chosen.run(scene, until=30), chosen)
    assert found.kept is (False if patience == math.inf else None), found.sentence
    assert "iterations" not in {defect.kind for defect in found.defects}


def test_cells_find_the_passages_that_pairs_find() -> None:
    """Sixty circles, none of which collides in the run that is audited: every pair that passes is deep."""
    draw = random.Random(5)
    circles = [
        Circle(10 * (k % 8), 10 * (k // 8), vx=draw.randint(-9, 9), vy=draw.randint(-9, 9)) for k in range(FEW + 12)
    ]
    scene = Scene(circles, until=4)
    recording = Recording(scene, "blind")
    recording.end(4.0)
    transcript = Transcript(recording.trajectory())
    found: list[set[tuple[float, tuple[int, ...]]]] = []
    with ball.precision(AUDIT_BITS):
        laws = Laws(scene, 2.0**-53)
        for few in (FEW, 1000):
            with pytest.MonkeyPatch.context() as patched:
                patched.setattr("truebreak.compare.audit.passages.FEW", few)
                told = passages(laws, transcript.flights(), 4.0, {}, {})
                found.append({(passage.time, passage.residual.bodies) for passage in told})
    assert found[0] == found[1]
    assert len(found[0]) > 10


def test_strengths_are_those_of_least_squares_and_never_pull() -> None:
    draw = random.Random(1)
    for _ in range(50):
        columns = [{k: (draw.gauss(0, 1), draw.gauss(0, 1)) for k in draw.sample(range(4), 2)} for _ in range(5)]
        wanted = {k: (draw.gauss(0, 1), draw.gauss(0, 1)) for k in range(4)}
        found = strengths_of(columns, wanted)

        def left(strengths: list[float], columns: Any = columns, wanted: Any = wanted) -> float:
            return sum(
                (wanted[k][axis] - sum(s * c[k][axis] for s, c in zip(strengths, columns, strict=True) if k in c)) ** 2
                for k in wanted
                for axis in (0, 1)
            )

        assert min(found) >= 0.0
        for place in range(5):
            for step in (1e-4, -1e-4):
                other = [max(0.0, s + step * (n == place)) for n, s in enumerate(found)]
                assert left(other) >= left(found) - 1e-12


def test_a_circle_out_of_play_is_audited_no_more() -> None:
    scene = scene_from("rack:rows=3")
    scene = scene.with_changes(capture=True)
    found = audited("double", scene, events=150)
    assert found.kept is True, found.sentence


@pytest.mark.parametrize("gravity", [None, (0, "-1/8")])
@pytest.mark.parametrize("within", ["1/2", "-1/100", "1/100"])
def test_what_meets_something_after_a_pocket_has_captured_it_breaks_a_law(within: str, gravity: Any) -> None:
    """The engine knows no pocket; one that is passed outside its rim takes nothing, whoever flies on."""
    ball = Circle(-3, 0, vx=1, vy=0 if gravity is None else "3/8", id="a")  # comes back to y = 0 at t = 6
    walls = [Wall(-7, 0, -7, 1, id="left"), Wall(7, 0, 7, 1, id="right")]
    x, high = (3, Fraction(0)) if gravity is None else (0, Fraction(9, 16))  # where the flight is highest
    hole = Pocket(x, high + 1 - Fraction(within), 1, id="hole")
    scene = Scene([ball], walls, pockets=[hole], capture=True, gravity=gravity)
    for name in ("double", "single", "rounded:bits=30"):
        run = engine(name).run(scene.with_changes(pockets=[], capture=False), until=30)
        found = audit_run(replace(run, scene=scene), engine(name))
        assert found.kept is (within == "-1/100"), (name, found.sentence)
        if found.first is not None:
            assert found.counts == {"capture": found.counts["capture"]}
            assert found.first.kind == "capture"
            assert found.first.size == pytest.approx(float(Fraction(within)), rel=1e-3)
            assert "a has come" in found.sentence and "within the rim of a pocket" in found.sentence
        assert audited(name, scene, until=30).kept is True


def test_the_audit_of_a_record_goes_no_farther_than_it_was_asked_for() -> None:
    chosen = Planted()
    whole = chosen.run(scene_from("gas"), events=50)
    part = replace(whole, events=whole.events[:3], final_time=whole.events[2].time)
    assert audit_run(part, chosen).kept is True


@pytest.mark.parametrize(
    ("fault", "scene", "demands"),
    [
        ({"e": 0.98}, "gas", {}),  # the histories part
        ({"e": 0.98}, "gas", {"events": 3}),  # the law, in a history that is right
        ({"masses": "equal"}, "sizes", {}),  # past a horizon of no event
        ({}, "gas", {"digits": 40}),  # a number
    ],
)
def test_what_a_failed_check_prints_to_reproduce_fails_as_it_did(
    fault: dict[str, Any], scene: str, demands: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A command exits with 1; a call of `truebreak.check` raises."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    source = Path(__file__).with_name("planted.py").read_text()
    name = f"mine{abs(hash((str(fault), scene, str(demands)))) % 10**8}"
    mine_of = "class Mine(Planted):\n    name = 'mine'\n    def __init__(self):\n        super().__init__"
    told = f"{source}\n\n{mine_of}(**{fault!r})\n"
    (tmp_path / f"{name}.py").write_text(told)
    mine = getattr(import_module(name), "Mine")()  # noqa: B009
    with pytest.raises(CheckFailed) as caught:
        check(mine, scene, **demands)
    (again,) = [line.partition(": ")[2] for line in str(caught.value).splitlines() if "reproduce: " in line]
    if again.startswith("truebreak compare"):
        words = shlex.split(again)[1:]
        with pytest.raises(SystemExit) as ended:
            main(words)
        assert ended.value.code == 1, again
    else:
        with pytest.raises(CheckFailed):
            eval(again, {"truebreak": truebreak})


def test_a_check_that_requires_nothing_of_the_history_says_so_and_may_fail() -> None:
    told = str(check("double", "lee"))
    assert "history: nothing required (an exact tie at event 0)" in told
    assert "2 impacts and 3 flights audited" in told
    with pytest.raises(NotDecided, match="nothing required"):
        check("double", "lee", require_history=True)


BLOCKED = """
import sys

class Blocker:
    def find_spec(self, name, path=None, target=None):
        if name.split(".")[0] in ("numpy", "sympy", "mpmath", "jinja2"):
            raise ImportError(name)

sys.meta_path.insert(0, Blocker())
from truebreak.compare.alignment.align import align
from truebreak.compare.audit.audit import audit_run
from truebreak.compare.tangent.growth import certified_growth
from truebreak.exact.exact_engine import ExactEngine
from truebreak.floating.double import DoubleEngine
from truebreak.scenarios.catalogue import build

engine = DoubleEngine()
run, exact = engine.run(build("gas"), events=50), ExactEngine().run(build("gas"), events=50)
print(audit_run(run, engine).kept, align(exact, run).verdict)
told = certified_growth(exact, 50)
print(0 < told.low <= told.high)
"""


def test_audit_alignment_tangent_map_and_the_two_engines_need_no_large_package() -> None:
    """A browser runs them: neither numpy nor SymPy, mpmath or jinja2 is imported."""
    told = subprocess.run([sys.executable, "-P", "-c", BLOCKED], capture_output=True, text=True, check=False)
    assert (told.stdout.strip(), told.returncode) == ("True agree\nTrue", 0), told.stderr


@pytest.mark.parametrize("name", ["interval:bits=106", "interval:bits=512"])
def test_contacts_that_push_together_are_judged_to_the_bits_of_an_engine(name: str) -> None:
    """Pushes are found in doubles: an engine of more bits keeps the law, and is seen to break it by less than these."""
    judged, scene = engine(name), catalogue.build("tennis")
    run = judged.run(scene, events=3)
    assert len(run.events[0].contacts) == 2
    assert audit_run(run, judged).kept is True
    heavier = [
        replace(c, m=c.m * (Quantity.of(1) + Quantity.of("10**-25"))) if c.id == "basketball" else c
        for c in scene.circles
    ]
    assert audit_run(replace(run, scene=scene.with_changes(circles=heavier)), judged).kept is False
