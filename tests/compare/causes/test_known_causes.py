"""Scenes whose cause is known by how they are made."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, NamedTuple

import pytest

from truebreak.compare import compare
from truebreak.compare.causes.diagnosis import CauseName, Diagnosis, Experiment, diagnosed
from truebreak.compare.causes.given_scene import rounded
from truebreak.compare.foreign import RecordedEngine, Recording
from truebreak.compare.report.sentences import verdict_sentence
from truebreak.exact import ExactEngine
from truebreak.floating import DoubleEngine, PymunkEngine
from truebreak.scenarios import Circle, Declared, Quantity, Scene, Wall, catalogue


@dataclass(frozen=True)
class Coarse(Declared):
    """The exact engine on a scene rounded by one amount, and then moved by another: both roundings by hand.

    Attributes:
        arithmetic: by how much the mover's height is off beyond the rounding of the scene.
    """

    arithmetic: str
    name: str = "coarse"

    @property
    def bits(self) -> int:
        return 53

    @property
    def rounds_input(self) -> bool:
        return True

    def run(self, scene: Scene, **limits: Any) -> Any:
        given = rounded(scene)
        first, *others = given.circles
        moved = replace_circle(first, y=first.y + Quantity.of(self.arithmetic))
        run = ExactEngine().run(given.with_changes(circles=[moved, *others]), **limits)
        return replace(run, scene=scene, engine=self.name)


def replace_circle(circle: Circle, **changes: Any) -> Circle:
    values = {key: getattr(circle, key) for key in ("x", "y", "r", "vx", "vy", "m", "id", "point")}
    return Circle(**{**values, **changes})


class Reordered(DoubleEngine):
    """Doubles that take a tie one contact after the other, the last one first."""

    def run(self, scene: Scene, **limits: Any) -> Any:
        run = super().run(scene.with_changes(tie_policy="sequential:order=scene"), **limits)
        return replace(run, scene=scene)


@dataclass(frozen=True)
class Heavy(Declared):
    """Doubles that take the first circle for three times as heavy: another law."""

    name: str = "heavy"

    @property
    def bits(self) -> int:
        return 53

    def run(self, scene: Scene, **limits: Any) -> Any:
        circles = [replace_circle(c, m=c.m * 3) if k == 0 else c for k, c in enumerate(scene.circles)]
        return replace(DoubleEngine().run(scene.with_changes(circles=circles), **limits), scene=scene)


@dataclass(frozen=True)
class Blind(Heavy):
    """Doubles that report nothing."""

    def run(self, scene: Scene, **limits: Any) -> Any:
        return replace(DoubleEngine().run(scene, **limits), events=())


def graze(miss: str, x: str = "-5") -> Scene:
    """A circle that passes another by a distance, and then meets a wall."""
    return Scene(
        [Circle(x, f"0.3 + {miss}", vx=1, id="mover"), Circle(0, "2.3", id="target")],
        [Wall(20, 0, 20, 1, id="wall")],
        until=40,
    )


def narrow(share: str) -> Scene:
    """A pass of 2**-51 + e: rounding takes e of it, for the nearest double to 1/2 - e is 1/2.

    An engine that then takes 2**-51 + 2**-57 takes less than the whole, and more than what rounding leaves.
    """
    circles = [Circle(-5, f"1/2 - {share} * 2**-56", vx=1, id="mover"), Circle(0, "5/2 + 2**-51", id="target")]
    return Scene(circles, [Wall(20, 0, 20, 1, id="wall")], until=40)


def bullet(place: str) -> Scene:
    """A small fast circle on its way to another."""
    return Scene([Circle(0, 0, "1/1000", vx=10, id="bullet"), Circle(place, 0, "1/1000", id="target")])


def onto_two(mass: str, other: str) -> Scene:
    """One circle onto two that touch: their impulses hang together."""
    return Scene([Circle(-4, 0, vx=1, m=mass), Circle("sqrt(3)", 1, m=other), Circle("sqrt(3)", -1, m=other)])


def row(turn: str) -> Scene:
    """A circle onto two in its way that touch, all on one line, turned about the second by twice atan(turn)."""
    t = Quantity.of(turn)
    x, y = (1 - t * t) / (1 + t * t), 2 * t / (1 + t * t)
    r = Quantity.of("1/20")
    places = {"A": Quantity.of("-31/100"), "B": Quantity.of(0), "C": Quantity.of("1/10")}
    speeds = {"A": Quantity.of(2)}
    circles = [
        Circle(x * at, y * at, r, x * speeds.get(name, 0), y * speeds.get(name, 0), id=name)
        for name, at in places.items()
    ]
    return Scene(circles, until=1)


def tied(shift: str) -> Scene:
    """Three balls on a line, of which the outer two arrive at once."""
    return Scene([Circle(f"-3 - {shift}", 0, vx=1), Circle(0, 0), Circle(f"4 + {shift}", 0, 2, vx=-1, m=4)])


def captured(text: str) -> Scene:
    """A scene of the catalogue in which pockets capture circles."""
    return catalogue.build(text).with_changes(capture=True, events=3)


class Known(NamedTuple):
    """A scene, an engine and limits, of which the cause is known."""

    causes: frozenset[CauseName]
    label: str
    scene: Callable[[], Scene]
    engine: Any
    limits: dict[str, int]


def known(
    cause: CauseName | set[CauseName], engine: Any, scenes: dict[str, Callable[[], Scene]], **limits: int
) -> list[Known]:
    """Several scenes of one engine, and of one cause, or of one out of some."""
    causes = frozenset(cause if isinstance(cause, set) else {cause})
    return [Known(causes, label, scene, engine, limits) for label, scene in scenes.items()]


def named(*texts: str) -> dict[str, Callable[[], Scene]]:
    """Scenes of the catalogue."""
    return {text: partial(catalogue.build, text) for text in texts}


def doubles(text: str) -> Scene:
    """A scene of the catalogue in doubles, so that no input is rounded."""
    return rounded(catalogue.build(text))


ARITHMETIC = {CauseName.FLIGHTS, CauseName.IMPACTS, CauseName.ARITHMETIC}
TURNS = ("-1", "-17/18", "-9/10", "-79/90", "-13/15")
SEEDS, PLACES = range(1, 6), ("-5", "-6", "-7", "-9", "-11")
FAR = ("10.0625", "20.0625", "30.0625", "50.0625", "100.0625")

KNOWN = [
    # Nearer than the rounding of the scene; a graze that doubles turn into a hit.
    *known(CauseName.INPUT, "double", named(*(f"near-tie:k={k}" for k in (20, 25, 30, 35, 40)))),
    *known(CauseName.INPUT, "double", {f"graze {x}": partial(graze, "0", x) for x in PLACES}),
    # Chaos in a scene that doubles hold exactly.
    *known(ARITHMETIC, "double", {f"gas {k}": partial(doubles, f"gas:n=6,seed={k}") for k in SEEDS}, events=500),
    # Three equal discs in a row, two of which touch: newton-physics #3233.
    *known(CauseName.PHANTOM, "double", {f"row turned by {t}": partial(row, t) for t in TURNS}),
    *known(
        {CauseName.INPUT, CauseName.FLIGHTS},
        Coarse("2**-51 + 2**-57"),
        {f"narrow {e}": partial(narrow, e) for e in ("0.6", "1", "1.2", "1.5", "1.9")},
    ),
    *known(CauseName.STEP, "pymunk:dt=1/64", named(*(f"gas:n=5,seed={k}" for k in SEEDS)), events=40),
    *(
        case
        for k in range(2, 7)
        for case in known(
            {CauseName.STEP, CauseName.LATENESS}, f"pymunk:dt=1/{4 * 8 ** (k - 1)}", named(f"near-tie:k={k}")
        )  # where no step that can be run is short enough, both come at the end of one
    ),
    # Overlap for 0.0004 time units, between two steps of 1/64.
    *known(CauseName.TUNNELLING, "pymunk:dt=1/64", {f"bullet {x}": partial(bullet, x) for x in FAR}, until=20),
    *known(
        CauseName.ITERATIONS,
        "pymunk:iterations=1",
        {
            f"onto two, {m} on {o}": partial(onto_two, m, o)
            for m, o in (("1", "1"), ("3", "1"), ("1/2", "1"), ("1", "2"), ("1", "1/2"))
        },
        until=5,
    ),
    # Doubles tell apart what a symmetric break has at one instant.
    *known(ARITHMETIC, "double", named("rack:rows=3"), events=6),
    *known(CauseName.TIE, "pymunk", named("lee:tie=sequential:order=scene"), events=6),
    *known(CauseName.TIE, Reordered(), {f"tied {x}": partial(tied, x) for x in ("1/2", "1/4", "3/4", "1/8", "5/8")}),
    # An engine that stops: too narrow, at a zero, at its budget, or before it begins.
    *known(
        CauseName.WIDTH, "interval", named("cradle", "gas", "gas:seed=2", "near-tie:k=20", "near-tie:k=40"), events=60
    ),
    *known(
        CauseName.WIDTH,
        "interval",
        {f"a miss by {miss}": partial(graze, miss) for miss in ("10**-30", "10**-300", "10**-3000", "10**-9000")},
    ),
    *known(CauseName.ZERO, "interval", {f"graze {x}": partial(graze, "0", x) for x in PLACES}),
    *known(
        CauseName.BUDGET,
        PymunkEngine(max_steps=20),
        named("cradle", "gas", "lee", "near-tie:k=4", "galperin:n=1"),
        events=10,
    ),
    *known(
        CauseName.UNABLE,
        "pymunk",
        {
            text: partial(captured, text)
            for text in ("rack:rows=1", "rack:rows=2", "rack:rows=3", "rack:rows=2,speed=10", "rack:rows=2,gap=1/9")
        },
    ),
    *known(CauseName.LAW, Heavy(), named(*(f"gas:n=5,seed={k}" for k in SEEDS)), events=40),
    *known(CauseName.LAW, Blind("blind"), named(*(f"gas:n=4,seed={k}" for k in SEEDS)), events=5),
]


def right(found: Diagnosis | None, causes: frozenset[CauseName]) -> bool:
    """Whether a diagnosis names some of these causes alone; "not determined" is none of them."""
    return found is not None and CauseName.UNKNOWN not in found.causes and {*found.causes} <= causes


@pytest.mark.parametrize("cause", CauseName)
def test_not_determined_is_never_right(cause: CauseName) -> None:
    untried = tuple(Experiment(each, "not tried") for each in CauseName)
    nothing = tuple(Experiment(each, "does not change it", 1.0, False) for each in CauseName)
    for rows in ((), untried, nothing):
        found = diagnosed([*rows], 1.0, None, 0)
        assert found.name is CauseName.UNKNOWN
        assert not right(found, frozenset({cause}))
    assert not right(None, frozenset({cause}))
    assert all(CauseName.UNKNOWN not in case.causes for case in KNOWN)


def label_of(case: Known) -> str:
    return f"{'+'.join(sorted(cause.name for cause in case.causes))}-{case.label}-{case.engine!s:.12}"


@pytest.mark.parametrize("case", KNOWN, ids=label_of)
def test_the_cause_is_found(case: Known) -> None:
    candidate = compare(case.scene(), [case.engine], **case.limits).candidates[0]
    assert candidate.verdict != "agree", candidate
    assert candidate.diagnosis is not None
    assert all(e.result for e in candidate.diagnosis.experiments)
    assert right(candidate.diagnosis, case.causes), candidate.diagnosis
    if candidate.diagnosis.closed:
        total = sum(e.share for e in candidate.diagnosis.shares)
        assert total == pytest.approx(1)


@pytest.mark.parametrize("case", [c for c in KNOWN if c.causes == {CauseName.ITERATIONS}], ids=lambda case: case.label)
def test_a_solver_that_is_not_stopped_early_agrees(case: Known) -> None:
    assert compare(case.scene(), ["pymunk"], **case.limits).verdict == "agree"


class OfItsOwnOrder(DoubleEngine):
    """Takes the contacts of an instant one after the other, in an order of its own, whatever the scene's policy."""

    scene_keys = Declared.scene_keys - {"tie_policy"}

    def run(self, scene: Scene, **limits: Any) -> Any:
        return replace(super().run(scene.with_changes(tie_policy="sequential:seed=77"), **limits), scene=scene)


def test_an_engine_that_follows_no_policy_resolves_a_tie_otherwise_and_no_rounding_chose() -> None:
    found = compare(catalogue.build("rack:rows=3,pockets=no,speed=8"), [OfItsOwnOrder()], events=3).candidates[0]
    assert found.verdict == "diverged"
    assert found.diagnosis is not None
    assert found.diagnosis.name is CauseName.TIE
    assert "does not follow the tie policy simultaneous" in found.diagnosis.finding


def beside(scene: Scene, far: str) -> Scene:
    """A scene with two discs elsewhere, of which one is the first, and soon strikes the other."""
    pair = [Circle(-100, 50, vx=1, id="heavy"), Circle(f"{far} - 100", "50.5", id="struck")]
    return scene.with_changes(circles=[*pair, *scene.circles])


@pytest.mark.parametrize("far", ["2.1", "10"])
@pytest.mark.parametrize("scene", [graze("0", "-5/3"), catalogue.build("near-tie:k=30")], ids=["graze", "near tie"])
def test_a_law_broken_elsewhere_is_no_cause(scene: Scene, far: str) -> None:
    comparison = compare(beside(scene, far), [Heavy()])
    (found,) = comparison.candidates
    assert found.lawless
    assert found.diagnosis is not None
    assert found.diagnosis.name in (CauseName.FLIGHTS, CauseName.INPUT)
    assert verdict_sentence(comparison).startswith("Floating point changed what happened")
    assert "heavy does not keep the law: event" in verdict_sentence(comparison)


@dataclass(frozen=True)
class Dull(Heavy):
    """Doubles that take contacts one after the other, at a restitution of 9/10."""

    scene_keys = Declared.scene_keys - {"tie_policy"}

    def run(self, scene: Scene, **limits: Any) -> Any:
        other = scene.with_changes(tie_policy="sequential:order=scene", restitution="9/10")
        return replace(DoubleEngine().run(other, **limits), scene=scene)


def test_a_law_broken_at_a_tie_outranks_the_order() -> None:
    (found,) = compare(tied("1/2"), [Dull()]).candidates
    assert found.diagnosis is not None
    assert found.diagnosis.name is CauseName.LAW, found.diagnosis


def test_a_law_broken_on_the_way_is_a_cause_only_if_it_changes_the_decision() -> None:
    """A disc bounces between two walls, too slowly by a share, and passes another at a distance that no speed changes.

    The distance is 1e-30, so that rounding hits: at whatever speed.
    """
    circles = [Circle(-5, "0.3", vx=-1, id="mover"), Circle(0, "2.3 + 1e-30", id="target")]
    scene = Scene(circles, [Wall(-9, 1, -9, 0, id="left"), Wall(20, 0, 20, 1, id="right")], until=60)
    (found,) = compare(scene, [Dull()]).candidates
    assert found.lawless
    assert found.diagnosis is not None
    (row,) = [row for row in found.diagnosis.experiments if row.cause is CauseName.LAW]
    assert row.suffices is False
    assert "does not change the decision by itself" in row.result
    assert found.diagnosis.name is not CauseName.LAW


def test_a_run_that_ends_too_early_to_tell_is_no_agreement() -> None:
    """The exact run of the pinball in pairs of doubles lacks event 34, which `quad` has: its input is not the cause."""
    found = compare(catalogue.build("pinball"), ["quad"], events=220).candidates[0]
    assert found.diagnosis is not None
    assert found.diagnosis.name is CauseName.UNKNOWN
    assert "its errors act on each other too much to be distinguished" in found.diagnosis.finding


# -- What a run that ends early tells.


@dataclass(frozen=True)
class Large(RecordedEngine):
    """Takes discs for larger than they are, pushes what overlaps at the end of a step, and ends after so many steps.

    Attributes:
        says: whether it says then that it has spent its budget, and not only that it knows no more.
    """

    step: float = 1 / 64
    most: int = 10**6
    says: bool = True
    name = "large"
    scene_keys = frozenset({"gravity", "restitution"})

    def play(self, scene: Scene, recording: Recording) -> None:
        """See `RecordedEngine.play`."""
        dt, ids = self.step, scene.ids
        place = [[float(c.x), float(c.y)] for c in scene.circles]
        speed = [[float(c.vx), float(c.vy)] for c in scene.circles]
        k = 0
        while recording.open and k < self.most:
            k += 1
            for p, v in zip(place, speed, strict=True):
                v[1] -= dt
                p[0], p[1] = p[0] + v[0] * dt, p[1] + v[1] * dt
            (ax, ay), (bx, by) = place
            dx, dy = bx - ax, by - ay
            far = math.hypot(dx, dy)
            closing = ((speed[1][0] - speed[0][0]) * dx + (speed[1][1] - speed[0][1]) * dy) / far
            if far < 2.1 and closing < 0:
                for v, sign in ((speed[0], 1), (speed[1], -1)):
                    v[0], v[1] = v[0] + sign * closing / 2 * dx / far, v[1] + sign * closing / 2 * dy / far
                rows = {name: (*p, *v) for name, p, v in zip(ids, place, speed, strict=True)}
                recording.hits(k * dt, [(ids[0], ids[1])], rows)
            recording.state(k * dt, [(*p, *v) for p, v in zip(place, speed, strict=True)])
        if recording.open and self.says:
            recording.spent(f"{self.most} steps")
        elif recording.open:
            recording.end(k * dt)


def test_a_finer_step_that_ends_before_the_event_is_evidence_of_nothing() -> None:
    discs = [Circle(0, 0, vx=2, id="a"), Circle(8, "2.03", id="b")]
    scene = Scene(discs, gravity=(0, -1), restitution=0)
    for most, says, told in (
        (10**6, True, "differs"),
        (325, True, "it ends at time 2.5"),
        (325, False, "ends at time"),
    ):
        (found,) = compare(scene, [Large(most=most, says=says)], until=5).candidates
        assert found.diagnosis is not None
        (row,) = [row for row in found.diagnosis.experiments if row.cause is CauseName["STEP"]]
        assert told in str(row)
        assert "agrees" not in str(row)
