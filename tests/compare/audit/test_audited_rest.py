"""The audit of scenes in which walls carry what comes to rest: engines pass, and planted faults are found."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from itertools import pairwise
from typing import Any

import pytest
from settle_campaign import bouncing, drawn

from truebreak.compare import engine
from truebreak.compare.audit.audit import Audit, audit_run
from truebreak.compare.audit.fits import with_bounces
from truebreak.compare.audit.residuals import Laws
from truebreak.compare.audit.transcript import Transcript
from truebreak.exact import ExactEngine
from truebreak.floating import DoubleEngine, plain
from truebreak.floating.knots import EndlessBounces, FallingMotion
from truebreak.scenarios import Circle, Quantity, Scene, Segment, Trajectory, Wall, catalogue

ENGINES = ("double", "single", "quad", "rounded:bits=40", "interval", "interval:bits=200")
FLOOR = Wall(0, 0, 1, 0, id="floor")


def audited(run: Trajectory) -> Audit:
    return audit_run(run, DoubleEngine())


@pytest.mark.parametrize("name", ENGINES)
def test_engines_that_keep_the_law_pass(name: str) -> None:
    """Discs settle, slide, are struck and carried again in these scenes, on level floors and with gravity aslant."""
    chosen, settled, scenes = engine(name), 0, [drawn(seed) for seed in range(18)]
    scenes += [catalogue.build("landing"), catalogue.build("struck"), *(bouncing(seed) for seed in range(6))]
    ends = 0
    for scene in filter(None, scenes):
        run = chosen.run(scene, until=12, events=40)
        found = audit_run(run, chosen)
        assert found.kept, (scene, found.sentence)
        settled += len(run.settlings)
        ends += sum(settling.since is not None for settling in run.settlings)
    assert settled > 15
    assert ends > 5 or name == "interval"  # of so few bits they hold all that may be before


def test_the_exact_engine_passes() -> None:
    run = ExactEngine().run(catalogue.build("landing"))
    assert len(run.settlings) == 2
    assert audit_run(run, ExactEngine()).kept


def aslant(vx: int) -> Scene:
    """A disc that falls onto a floor of slope 3/4 across gravity, and slides along it."""
    return Scene(
        [Circle(0, 4, vx=vx, vy=1, id="a"), Circle(9, "27/4 + 5/4", id="b")],
        [Wall(0, 0, 4, 3, id="floor")], gravity=(3, -4), restitution=0, settle=True,
    )  # fmt: skip


def test_a_floor_aslant_carries() -> None:
    run = DoubleEngine().run(aslant(1), until=9)
    assert [s.circle for s in run.settlings] == ["b", "a"]  # as large as each other, they leave each other on it
    assert audited(run).kept


@pytest.mark.parametrize("name", ["double", "quad", "interval"])
def test_what_is_carried_as_something_collides_at_time_0(name: str) -> None:
    discs = [Circle(0, 1, id="a"), Circle(3, 1, vx=1, id="b"), Circle(5, 1, id="c"), Circle("1/4", 8, id="falls")]
    scene = Scene(discs, [FLOOR], gravity=(0, -2), restitution="1/2", settle=True)
    run = engine(name).run(scene, until="27/10")
    assert [float(e.time) for e in run.events][:1] == [0.0]
    assert {*run.events[1].contacts[0]} == {"a", "falls"}
    assert audit_run(run, engine(name)).kept


def test_rounding_has_the_room_of_a_fall_where_what_falls_meets_what_is_carried() -> None:
    """A place is off by more, for an error in time, the faster the one falls: the two do not pass on a straight way."""
    run = DoubleEngine().run(Scene(FALLS.circles[1:], [FLOOR], gravity=(0, -2), settle=True), until="27/10")
    transcript = Transcript(run, True, 2.0**-53)
    laws = Laws(run.scene, 2.0**-53, True, fall=transcript.fall)
    instant = next(told for told in transcript.instants() if told.impulses)
    room = laws.meeting((0, 1), instant, 0).room
    instant.before[0] = instant.before[0]._replace(carried=False)
    assert laws.meeting((0, 1), instant, 0).room < room


# -- faults of an engine that goes on from them by the law

SLIDES = Scene([Circle(0, 3, vx=1, id="a"), Circle(9, 1, id="b")], [FLOOR], gravity=(0, -2), restitution=0, settle=True)


@pytest.fixture
def state(monkeypatch: pytest.MonkeyPatch) -> type[plain.PlainState[Any]]:
    """A state in which what is carried can be made otherwise by `by(flight)`."""

    class Wrong(plain.PlainState[Any]):
        by: Any = staticmethod(lambda flight: flight)

        def settle(self, index: int, wall: int, slides: bool, bounces: bool = False, other: int = -1) -> None:
            super().settle(index, wall, slides, bounces, other)
            if index == 0:
                self.bodies[0].flight = self.by(self.bodies[0].flight)

    monkeypatch.setattr(plain, "PlainState", Wrong)
    return Wrong


FAULTS = {
    "nothing": (lambda f: f, {}),
    "slides faster": (lambda f: f._replace(vx=f.vx * (1 + 1e-9)), {"impulse", "depth"}),
    "is braked": (lambda f: f._replace(vx=f.vx * 0.5), {"impulse"}),
    "stops": (lambda f: f._replace(vx=0.0), {"impulse"}),
    "sinks": (lambda f: f._replace(vy=-1e-6), {"impulse"}),
    "rises": (lambda f: f._replace(vy=1e-6), {"impulse"}),
    "hovers": (lambda f: f._replace(y=f.y + 1e-9), {"flight", "gap", "support"}),
    "is in the floor": (lambda f: f._replace(y=f.y - 1e-9), {"flight", "gap", "support"}),
    "is put aside": (lambda f: f._replace(x=f.x + 1e-9), {"flight"}),
}  # fmt: skip


@pytest.mark.parametrize("what", FAULTS)
def test_a_disc_that_is_carried_otherwise_is_found(what: str, state: Any) -> None:
    by, kinds = FAULTS[what]
    state.by = staticmethod(by)
    found = audited(DoubleEngine().run(SLIDES, until=12))
    assert found.kept == (not kinds), found.sentence
    assert {v.kind for v in found.violations} >= set(kinds) - {"depth"}, found.violations
    drifts = {"flight", "depth", "support"} if what in ("sinks", "rises") else set[str]()
    assert {v.kind for v in found.violations} <= {*kinds, *drifts, "gap", "impulse"}, found.violations


# -- infinitely many bounces, of which the first alone are reported

LONE = Scene([Circle(0, 3, vx=1, id="a")], [FLOOR], gravity=(0, -2), restitution="1/2", settle=True)
LISTED = 2


def early(scene: Scene = LONE, **changes: float) -> Trajectory:
    """A run of the one disc that reports two of its bounces, with something changed; of another scene, as it says.

    The second is at 2 sqrt(2), and sends it up at sqrt(2)/2 to a height of 1/8; all have happened at 3 sqrt(2).
    """
    run = DoubleEngine().run(LONE, until=9)
    assert isinstance(run.motion, FallingMotion)
    (knots,), ((end,),) = run.motion.knots, (row.values() for row in run.motion.bounced.values())
    listed = [*knots[: LISTED + 1]]
    t, x, y, vx, vy = listed[-1]
    until = end.until + changes.get("until", 0.0)
    ends = EndlessBounces(t, until, 0.0, 1.0, vy + changes.get("speed", 0.0), 0.5 + changes.get("e", 0.0))
    rest = (
        t,
        x + changes.get("x", 0.0),
        y + changes.get("y", 0.0),
        vx + changes.get("vx", 0.0),
        changes.get("vy", 0.0),
    )
    still = [[(0.0, float(c.x), float(c.y), 0.0, 0.0)] for c in scene.circles[1:]]
    motion = replace(
        run.motion, knots=[[*listed, rest], *still], carried={0: frozenset({LISTED + 1})},
        bounced={0: {LISTED + 1: ends}}, pegs=range(1, len(scene.circles)),
    )  # fmt: skip
    settling = replace(run.settlings[0], time=until, since=t)
    return replace(run, scene=scene, events=run.events[:LISTED], motion=motion, settlings=(settling,))


def test_bounces_that_nothing_reports_are_followed_by_the_law() -> None:
    run = early()
    assert audited(run).kept
    transcript = Transcript(run, True, 2.0**-53)
    laws = Laws(run.scene, 2.0**-53, True, fall=transcript.fall)
    (row,) = transcript.flights(partial(with_bounces, laws))
    times = [t for t, *_ in row]
    assert times[3:5] == pytest.approx([2.5 * 2**0.5, 2.75 * 2**0.5])
    assert len(times) > 20
    assert transcript.carried == {0: {len(times) - 2, len(times) - 1}}
    for (t, x, y, vx, vy, *_), after in pairwise(row):
        span = min(after[0] - t, 0.1) / 2
        fall = 0.0 if t > times[-3] else 1.0
        told = run.motion.state(t + span)[0]
        assert told == pytest.approx(
            (x + vx * span, y + vy * span - fall * span**2, vx, vy - 2 * fall * span), abs=1e-6
        )


WRONG_ENDS: dict[str, tuple[dict[str, float], set[str]]] = {
    "too early": ({"until": -1e-9}, {"flight", "bystander", "support"}),
    "too late": ({"until": 1e-9}, {"flight", "bystander", "support"}),
    "too high": ({"speed": 1e-9}, {"flight"}),
    "by another restitution": ({"e": 1e-3}, {"flight", "bystander"}),
    "aside": ({"x": 1e-9}, {"flight"}),
    "above": ({"y": 1e-9}, {"flight", "support"}),
    "sliding faster": ({"vx": 1e-9}, {"flight", "bystander"}),
    "rising": ({"vy": 1e-9}, {"flight", "bystander", "support"}),
}


@pytest.mark.parametrize("what", WRONG_ENDS)
def test_bounces_that_end_otherwise_are_found(what: str) -> None:
    changes, kinds = WRONG_ENDS[what]
    found = audited(early(**changes))
    assert {violation.kind for violation in found.violations} == kinds, found.violations


@pytest.mark.parametrize("gap", ["1/50", "1/25"])
def test_what_stands_in_their_way_is_hit(gap: str) -> None:
    """Over the top of the third flight that nothing reports, which is 1/32 high: too low, or not."""
    peg = Circle("389/100", Quantity.of("9/4") + Quantity.of(gap), "1/4", fixed=True, id="peg")
    found = audited(early(LONE.with_changes(circles=(*LONE.circles, peg))))
    assert {violation.kind for violation in found.violations} == ({"depth"} if gap == "1/50" else set())


def test_too_many_of_them_are_not_determined() -> None:
    """With e = .9999 they come lower than rounding after some 170,000."""
    run = early()
    found = audited(replace(run, scene=LONE.with_changes(restitution="9999/10000")))
    assert not found.kept
    transcript = Transcript(replace(run, scene=LONE.with_changes(restitution="9999/10000")), True, 2.0**-53)
    laws = Laws(transcript.scene, 2.0**-53, True, fall=transcript.fall)
    with pytest.raises(ValueError, match=r"it bounces 1\d\d,\d{3} times that no event tells of, more than 2,000"):
        transcript.flights(partial(with_bounces, laws))


# -- faults in what is reported: flights of other runs, and events left out


def reported(
    run: Trajectory, knots: dict[int, list[tuple[float, ...]]], carried: dict[int, set[int]], events: int
) -> Audit:
    """The audit of a run some of whose circles fly otherwise, with its first events."""
    motion: Any = run.motion
    assert isinstance(motion, FallingMotion)
    rows = [knots.get(k, list(row)) for k, row in enumerate(motion.knots)]
    told = {**motion.carried, **{k: frozenset(v) for k, v in carried.items()}}
    changed = FallingMotion(rows, motion.end, motion.halves, motion.pegs, told)  # pyright: ignore[reportArgumentType]
    return audited(replace(run, motion=changed, events=run.events[:events]))


FALLS = Scene(
    [Circle(0, 1, vx=1, id="slider"), Circle(3, 1, id="sitter"), Circle("13/4", 9, id="falls")], [FLOOR],
    gravity=(0, -2), restitution="1/2", settle=True,
)  # fmt: skip


def lone(name: str, until: float) -> list[tuple[float, ...]]:
    """The knots of a disc that has nothing but the floor."""
    scene = Scene([c for c in FALLS.circles if c.id == name], [FLOOR], gravity=(0, -2), restitution="1/2", settle=True)
    motion: Any = DoubleEngine().run(scene, until=until).motion
    return list(motion.knots[0])


def test_what_falls_on_one_at_rest_has_to_strike_it() -> None:
    scene = Scene(FALLS.circles[1:], [FLOOR], gravity=(0, -2), restitution="1/2", settle=True)
    run = DoubleEngine().run(scene, until="27/10")
    assert sorted(run.events[0].contacts[0]) == ["falls", "sitter"]
    assert audited(run).kept
    through = lone("falls", 2.7)
    found = reported(run, {0: lone("sitter", 2.7), 1: through}, {0: {1}, 1: set()}, 0)
    assert found.kept is False
    assert {(v.kind, v.bodies) for v in found.violations} == {("depth", ("sitter", "falls"))}, found.violations


def test_what_slides_into_one_at_rest_has_to_strike_it() -> None:
    scene = Scene(FALLS.circles[:2], [FLOOR], gravity=(0, -2), restitution="1/2", settle=True)
    run = DoubleEngine().run(scene, until=2)
    assert len(run.events) == 1
    assert audited(run).kept
    found = reported(run, {0: lone("slider", 2), 1: lone("sitter", 2)}, {0: {1}, 1: {1}}, 0)
    assert {(v.kind, v.bodies) for v in found.violations} == {("depth", ("slider", "sitter"))}, found.violations


def test_what_slides_under_one_that_falls_has_to_be_struck() -> None:
    """The one slides away from under where the other comes down: where it was, nothing is met any more."""
    falls = Circle(2, 8, id="falls")
    scene = Scene([Circle(0, 1, vx=1, id="slider"), falls], [FLOOR], gravity=(0, -2), restitution="1/2", settle=True)
    run = DoubleEngine().run(scene, until="5/2")
    assert sorted(run.events[0].contacts[0]) == ["falls", "slider"]
    assert audited(run).kept
    motion: Any = DoubleEngine().run(scene.with_changes(circles=[falls]), until="5/2").motion
    found = reported(run, {0: lone("slider", 2.5), 1: list(motion.knots[0])}, {0: {1}, 1: set()}, 0)
    assert {(v.kind, v.bodies) for v in found.violations} == {("depth", ("slider", "falls"))}, found.violations
    away = scene.with_changes(circles=[scene.circles[0], replace(falls, x="-1/2")])
    run = DoubleEngine().run(away, until="5/2")
    assert not run.events
    assert audited(run).kept


def test_what_is_at_rest_does_not_leave_by_itself() -> None:
    scene = Scene(FALLS.circles[1:2], [FLOOR], gravity=(0, -2), restitution="1/2", settle=True)
    run, at = DoubleEngine().run(scene, until=4), (0.0, 3.0, 1.0, 0.0, 0.0)
    assert audited(run).kept
    leaves = [at, at, (2.0, 3.0, 1.0, 0.0, 1.0)]
    kinds = {v.kind for v in reported(run, {0: leaves}, {0: {1}}, 0).violations}
    assert kinds == {"bystander", "depth"}  # and comes down again
    let_fall = [at, at, (2.0, 3.0, 1.0, 0.0, 0.0)]
    kinds = {v.kind for v in reported(run, {0: let_fall}, {0: {1}}, 0).violations}
    assert kinds == {"depth"}
    creeps = [at, at, (2.0, 3.0, 1.0, 1e-9, 0.0)]
    kinds = {v.kind for v in reported(run, {0: creeps}, {0: {1, 2}}, 0).violations}
    assert kinds == {"bystander"}
    for speed in (1e-9, -1e-9):
        drifts = reported(run, {0: [at, (0.0, 3.0, 1.0, 0.0, speed)]}, {0: {1}}, 0)
        assert {v.kind for v in drifts.violations} >= {"bystander", "support"}, drifts.violations
    comes = reported(run, {0: [(0.0, 3.0, 1.5, 0.0, -0.125)]}, {0: {0}}, 0)
    assert "support" in {v.kind for v in comes.violations}, comes.violations
    never = reported(run, {0: [at]}, {0: set()}, 0)
    assert {v.kind for v in never.violations} == {"depth"}


def test_what_is_struck_gets_no_more_than_the_impulse() -> None:
    scene = Scene(FALLS.circles[:2], [FLOOR], gravity=(0, -2), restitution="1/2", settle=True)
    run = DoubleEngine().run(scene, until=2)
    motion: Any = run.motion
    t, x, y, vx, vy = motion.knots[1][-1]
    more = reported(run, {1: [*motion.knots[1][:-1], (t, x, y, 1.5 * vx, vy)]}, {}, 1)
    assert {v.kind for v in more.violations} == {"impulse"}
    gained = reported(run, {1: [*motion.knots[1][:-1], (t, x, y, vx, 0.25)]}, {1: {1}}, 1)
    assert {v.kind for v in gained.violations} == {"impulse", "depth"}


@pytest.mark.parametrize(
    ("x", "y", "walls"),
    [
        (0, 1, [Wall(0, 2, 1, 2, id="ceiling")]),
        (0, 1, [Wall(-1, 0, -1, 1, id="side")]),
        ("-3/5", "4/5", [Wall(0, 0, 4, 3, id="slope")]),
        (0, 1, []),
        (4, 1, []),
        ("5/4", 1, []),
    ],
)  # fmt: skip
def test_only_a_wall_across_gravity_carries(x: Any, y: Any, walls: list[Wall]) -> None:
    """No ceiling, no wall aslant or upright, no air, and no face beyond its ends."""
    faces = [] if walls or not x else [Segment(-1, 0, 1, 0, id="shelf")]
    disc = Circle(x, y, id="a")
    scene = Scene([disc], walls, segments=faces, gravity=(0, -2), settle=True)
    run = DoubleEngine().run(scene, until="1/100")
    row = (0.0, float(disc.x), float(disc.y), 0.0, 0.0)
    found = reported(run, {0: [row, row]}, {0: {1}}, 0)
    assert {v.kind for v in found.violations} == {"support"}, found.violations


def test_a_face_carries_up_to_its_end() -> None:
    scene = Scene([Circle(0, 1, id="a")], segments=[Segment(-1, 0, 1, 0, id="shelf")], gravity=(0, -2), settle=True)
    run = DoubleEngine().run(scene, until=4)
    assert audited(run).kept
    run = replace(run, scene=scene.with_changes(circles=[replace(scene.circles[0], vx="1/2")]))
    slides = (0.0, 0.0, 1.0, 0.5, 0.0)
    off = reported(run, {0: [slides, slides]}, {0: {1}}, 0)
    assert [(v.kind, v.size, v.time) for v in off.violations] == [("support", 1.0, 4.0)]
    assert "a and shelf are 1 from touching as the one is carried by the other" in str(off.first)


def test_steps_and_motions_that_do_not_say_are_named() -> None:
    class Stepped(DoubleEngine):
        step = 0.5

    class Silent:
        end = 1.0

        def state(self, time: Any) -> list[tuple[float, float, float, float]]:
            return [(0.0, 3.0, 1.0, -2.0 * float(time)), (9.0, 1.0, 0.0, 0.0)]

    run = DoubleEngine().run(SLIDES, until=1)
    assert audit_run(run, Stepped()).reason == "what walls carry is not audited yet in steps"
    assert audited(replace(run, motion=Silent())).reason == "its motion does not say what walls carry"
