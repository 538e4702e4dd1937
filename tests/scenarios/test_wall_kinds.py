"""Walls of kinds of their own: every engine runs them by what they say of themselves; others refuse them by name."""

from __future__ import annotations

from dataclasses import dataclass
from math import hypot
from random import Random

import pytest

import truebreak as tb
from truebreak.compare.certificate import CertificateError, certificate_of
from truebreak.compare.report.floats import floats_json
from truebreak.compare.shadowing.shadows import shadow
from truebreak.compare.tangent.impacts import NoTangentMap, impacts
from truebreak.exact import ExactEngine
from truebreak.floating import DoubleEngine
from truebreak.scenarios import Circle, Engine, Quantity, Scene, SceneError, Trajectory, Wall
from truebreak.scenarios.files import loads_toml


@dataclass(frozen=True, init=False)
class Valve(Wall):
    """What comes from its left bounces; what comes from its right passes."""

    kind = "valve"

    def side(self, x: Quantity, y: Quantity) -> int:
        return 1

    def is_met(self, gap: int) -> bool:
        return gap > 0


BOX = [Wall(-8, 0, -8, 1, id="w"), Wall(8, 0, 8, 1, id="e"), Wall(0, -8, 1, -8, id="s"), Wall(0, 8, 1, 8, id="n")]


def drawn(seed: int) -> Scene | None:
    """Some circles and points in a box that a valve divides, or two that cross."""
    draw = Random(seed)
    walls = [*BOX, Valve(draw.randint(-2, 2), -1, draw.randint(-2, 2), 3, id="valve")]
    if draw.random() < 0.4:
        walls.append(Valve(-1, draw.randint(-4, 4), 2, draw.randint(-4, 4), id="other"))
    draw.shuffle(walls)
    circles: list[Circle] = []
    for _ in range(draw.randint(1, 3)):
        r = draw.choice(["1/2", "1", "3/4", 0])
        x, y, vx, vy = (f"{draw.randint(-5000, 5000)}/1000" for _ in range(4))
        circles.append(Circle(x, y, vx=vx, vy=vy, r=r, point=r == 0, m=draw.choice([1, 1, 2])))
    try:
        return Scene(circles, walls, events=10)
    except SceneError:
        return None


SCENES = [scene for seed in range(60) if (scene := drawn(seed)) is not None]


def passed(run: Trajectory) -> int:
    """How often a circle has come through a valve, by where one event leaves it and where the next does.

    What was clear of it on its left is never behind it.
    """
    count, before = 0, dict[tuple[str, str], float]()
    for event in run.events:
        after = run.after(event.index)
        for c in run.scene.circles:
            for v in run.scene.other_walls:
                state, key = after[str(c.id)], (str(c.id), str(v.id))
                nx, ny = map(float, v.normal)
                height = nx * (float(state.x) - float(v.x0)) + ny * (float(state.y) - float(v.y0))
                was, before[key] = before.get(key, height), height
                assert not (was > float(c.r) * hypot(nx, ny) and height < -1e-9)
                count += was < 0 < height
    return count


def test_what_comes_from_behind_passes_and_nothing_comes_back() -> None:
    runs = [ExactEngine().run(scene) for scene in SCENES]
    assert sum(map(passed, runs)) > 20
    bounces = [pair for run in runs for event in run.events for pair in event.impulses if pair.second == "valve"]
    assert len(bounces) > 20


@pytest.mark.parametrize("name", ["interval", "double", "quad", "sympy"])
def test_every_engine_has_the_exact_history(name: str) -> None:
    several = 0
    for scene in SCENES[: 6 if name == "sympy" else None]:
        exact, other = ExactEngine().run(scene), tb.run(scene, engine=name)
        several += len(other.events)
        for one, two in zip(exact.events, other.events, strict=False):
            assert one.contacts == two.contacts
            assert float(one.time) == pytest.approx(float(two.time))
    assert several > 40


def test_one_that_touches_it_from_behind_at_the_start_flies_on() -> None:
    valve = Valve(0, 0, 0, 1, id="valve")  # its left is where x < 0
    scene = Scene([Circle(1, 0, vx=-1)], [valve, *BOX], events=3)
    for engine in ("exact", "sympy", "interval", "double"):
        met = [pair.second for event in tb.run(scene, engine=engine).events for pair in event.contacts]
        assert met[:2] == ["w", "valve"], engine


def test_one_that_is_turned_back_within_it_goes_back() -> None:
    """A circle half way through from behind is hit by another, and leaves to where it came from."""
    valve = Valve(0, 0, 0, 1, id="valve")
    scene = Scene([Circle(2, 0, vx=-1), Circle(-5, 0, vx=2)], [valve, *BOX], events=3)
    for engine in ("exact", "sympy", "interval", "double"):
        events = tb.run(scene, engine=engine).events
        first, then = events[0].contacts[0], events[1].contacts
        assert tuple(first) == ("c1", "c2"), engine
        assert "valve" not in {name for pair in then for name in pair if "c1" in pair}, engine


@pytest.mark.parametrize(
    ("changes", "named"),
    [({"gravity": (0, -1)}, "gravity"), ({"reverse_after": 3}, "reverse_after"), ({"reverse_at": 3}, "reverse_at"),
     ({"walls": [Valve(0, 0, 0, 1), Wall(9, 0, 9, 1, vx=-1)]}, "walls that move")],
)  # fmt: skip
def test_what_it_does_not_go_with_is_named(changes: dict[str, object], named: str) -> None:
    scene = Scene([Circle(2, 0)], [Valve(0, 0, 0, 1, id="v")])
    with pytest.raises(SceneError, match=f"a valve does not go with {named}; leave one of them out"):
        scene.with_changes(**changes)


def test_what_knows_nothing_of_it_says_so() -> None:
    scene = Scene([Circle(2, 0, vx=-1), Circle(5, 3, vy=1)], [Valve(0, 0, 0, 1, id="v"), *BOX], events=4)
    run = ExactEngine().run(scene)
    with pytest.raises(CertificateError, match="kind 'valve'"):
        certificate_of(run)
    with pytest.raises(NoTangentMap, match="kind 'valve'"):
        impacts(run, 2)
    with pytest.raises(SceneError, match="kind 'valve'"):
        shadow(scene, "double")
    engine: Engine = DoubleEngine()
    audit = tb.audit(engine.run(scene), engine)
    assert (audit.kept, audit.sentence) == (
        None,
        "whether it keeps the law is not determined: a wall of kind 'valve' is not audited",
    )
    assert floats_json(scene)["walls"][0]["kind"] == "valve"
    found = tb.comparison(scene, ["pymunk"])
    assert "does not follow 'wall kinds'" in (found.candidates[0].trajectory.stop.message)


def test_a_kind_that_is_not_there_is_refused_with_those_that_are() -> None:
    text = (
        '[[circle]]\nid = "a"\nx = 3\ny = 0\nr = 1\n[[wall]]\nid = "v"\nx0 = 0\ny0 = 0\nx1 = 0\ny1 = 1\nkind = "door"'
    )
    with pytest.raises(SceneError, match=r"wall 'v': kind = 'door' is not known; choose wall$"):
        loads_toml(text)
