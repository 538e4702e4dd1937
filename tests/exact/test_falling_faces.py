"""Segments and polygons under gravity: against a referee in true coordinates, and what ends by name."""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Callable
from fractions import Fraction
from typing import Any

import pytest
from face_referee import FaceReferee, NotForThis, TieMet
from mpmath import mpf, workdps

from truebreak.exact import ExactEngine
from truebreak.exact.simulation import arc_meetings
from truebreak.floating import DoubleEngine, PymunkEngine, QuadEngine, RoundedEngine, SingleEngine
from truebreak.scenarios import Circle, Polygon, Scene, SceneError, Segment, Trajectory, Wall
from truebreak.scenarios.trajectory import StopReason

FLOOR = Wall(0, -4, 1, -4, id="floor")
SIDES = [Wall(-6, 0, -6, 1, id="left"), Wall(6, 0, 6, 1, id="right")]
DART = [(0, 0), (2, -1), ("1/2", "1/4"), (1, 2)]
BOX = [(0, 0), (2, 0), (2, 1), (0, 1)]
TRIANGLE = [(0, 0), (3, 0), (0, "3/2")]


def drawn(seed: int) -> Scene:
    """One to three discs or points, segments, polygons, fixed discs, walls."""
    rng = random.Random(seed)

    def some(low: int, high: int, parts: int = 100) -> str:
        return f"{rng.randint(low * parts, high * parts)}/{parts}"

    def radius() -> str:
        return rng.choice(["1/2", "1/4", "3/10", "sqrt(2)/4"])

    while True:
        circles = [
            Circle(some(-4, 4), some(1, 8), radius(), some(-4, 4), some(-4, 4), rng.choice([1, 2, "1/3"]), id=f"b{k}")
            for k in range(rng.randint(1, 3))
        ]
        if rng.random() < 0.15:
            circles.append(Circle(some(-4, 4), some(1, 8), "0", some(-4, 4), some(-4, 4), point=True, id="point"))
        circles += [Circle(some(-4, 4), some(-3, 5), radius(), m="oo", id=f"p{k}") for k in range(rng.randint(0, 2))]
        parts = rng.choice([100, 100, 2, 1])
        segments: list[Segment] = []
        for k in range(rng.randint(1, 4)):
            x, y = some(-5, 5, parts), some(-3, 5, parts)
            if segments and rng.random() < 0.4:
                x, y = segments[-1].x1.text(), segments[-1].y1.text()
            way = rng.choice(["free", "level", "upright"])
            end = (x if way == "upright" else some(-5, 5, parts)), (y if way == "level" else some(-3, 5, parts))
            try:
                segments.append(Segment(x, y, *end, r=rng.choice(["0", "0", "1/10", "1/3"]), id=f"s{k}"))
            except SceneError:
                continue
        polygons: list[Polygon] = []
        for k in range(rng.randint(0, 2)):
            x, y, corners = rng.randint(-4, 3), rng.randint(-3, 4), rng.choice([DART, BOX, TRIANGLE])
            turned = rng.random() < 0.5
            points = [(f"{x}-({b})", f"{y}+({a})") if turned else (f"{x}+({a})", f"{y}+({b})") for a, b in corners]
            polygons.append(Polygon(points, r=rng.choice(["0", "0", "1/5"]), id=f"g{k}"))
        walls = [*SIDES, FLOOR] if rng.random() < 0.8 else SIDES
        gravity = rng.choice([(0, -10), (0, "-981/100"), ("1/3", -4), ("sqrt(2)", -3)])
        try:
            return Scene(
                circles,
                walls,
                segments=segments,
                polygons=polygons,
                gravity=gravity,
                restitution=rng.choice([1, "9/10", "1/2"]),
            )
        except SceneError:
            continue


def differs(scene: Scene, events: int) -> str | None:
    """What is otherwise than the referee has it; empty where all is as it has it, None where it has nothing."""
    run = ExactEngine(max_bits=2000, work=1_000_000).run(scene, events=events)
    count = len(run.events)
    quiet = run.stop.reason is StopReason.QUIET
    if run.events and float(run.events[0].time) == 0.0:
        return None  # the referee looks for what comes to a gap of zero, and not for what begins there
    try:
        course = FaceReferee(scene).run(mpf(10) ** 9, count + quiet)
    except (TieMet, NotForThis):
        return None
    with workdps(60):
        if len(course.hits) != count:
            return "number of events"
        for k, (hit, event) in enumerate(zip(course.hits, run.events, strict=True)):
            if sorted(sorted((c.first, c.second)) for c in event.contacts) != [sorted(hit.pair)]:
                return f"who meets at event {k}"
            if abs(mpf(event.time.digits(40)) - hit.time) > mpf(10) ** -30 * (1 + hit.time):
                return f"time of event {k}"
        if run.events and not quiet:
            at = run.at(run.events[-1].time)
            for body, circle in zip(course.bodies, [c for c in scene.circles if not c.fixed], strict=True):
                mine = at[str(circle.id)]
                theirs = (body.x, body.y, body.vx, body.vy)
                for own, other in zip((mine.x, mine.y, mine.vx, mine.vy), theirs, strict=True):
                    if abs(mpf(own.digits(40)) - other) > mpf(10) ** -25 * (1 + abs(other)):
                        return f"state of {circle.id}"
    return ""


def goes_otherwise(scene: Scene, more: int = 24) -> str | None:
    """Where a run ends as infinitely many bounces, what the circle meets besides by then; empty for nothing.

    None where it ends otherwise, or the referee has nothing.
    """
    run = ExactEngine(max_bits=2000, work=1_000_000).run(scene, events=80)
    if run.stop.reason is not StopReason.ACCUMULATION or run.ending is None:
        return None
    (last,) = run.events[-1].contacts
    try:
        course = FaceReferee(scene).run(mpf(10) ** 9, len(run.events) + more)
    except (TieMet, NotForThis):
        return None
    with workdps(60):
        end = mpf(run.ending.digits(40))
        row = [hit for hit in course.hits[len(run.events) :] if hit.time < end and last.first in hit.pair]
    others = {hit.pair for hit in row if sorted(hit.pair) != sorted(last)}
    return f"{others}" if others else "" if row else "no further bounce"


@pytest.mark.parametrize("seed", [1, 4, 12, 14])
def test_bounces_that_are_said_to_end_meet_nothing_else(seed: int) -> None:
    assert goes_otherwise(drawn(seed)) == ""


@pytest.mark.parametrize("seed", range(6))
def test_the_history_is_that_of_the_referee(seed: int) -> None:
    assert differs(drawn(seed), 10) == ""


@pytest.mark.slow
@pytest.mark.parametrize("block", range(20))
def test_many_histories_are_those_of_the_referee(block: int) -> None:
    found = Counter(differs(drawn(1000 + 50 * block + k), 25) for k in range(50))
    assert set(found) <= {"", None}
    assert found[""] > 40


# -- Planted faults: each is found.


def wrong_zero(approach: Any, half: Any, root: Any) -> Any:
    """The other zero, at which the gap rises."""
    return BACK(approach, half, -root)


def straight_along(falling: Any, place: Any, line: Any, clock: Any, zero: Any) -> Any:
    """Gravity along a face is left out."""
    return (*ALONG(falling, place, line, clock, zero)[:2], zero)


def everywhere(falling: Any, place: Any, line: Any, clock: Any, zero: Any) -> Any:
    """A face has no ends."""
    _, _, half = ALONG(falling, place, line, clock, zero)
    return line.nn / 2, zero, half * 0


def no_gravity(*args: Any, **kwargs: Any) -> Any:
    """The gap does not bend."""
    fall = FALL(*args, **kwargs)
    return fall._replace(half=fall.half / 2)


BACK, ALONG, FALL = arc_meetings.fall_time_back, arc_meetings.along_of, arc_meetings.fall_of


@pytest.mark.usefixtures("unfiltered")
@pytest.mark.parametrize(
    ("name", "fault"),
    [
        ("fall_time_back", wrong_zero),
        ("along_of", straight_along),
        ("along_of", everywhere),
        ("fall_of", no_gravity),
    ],
)
def test_the_referee_finds_planted_faults(
    monkeypatch: pytest.MonkeyPatch, name: str, fault: Callable[..., Any]
) -> None:
    monkeypatch.setattr(arc_meetings, name, fault)

    def is_found(seed: int) -> bool:
        try:
            return differs(drawn(seed), 8) not in ("", None)
        except AssertionError:
            return True

    assert any(is_found(seed) for seed in range(8))


# -- Which zero, and where along the face: single cases.

BAR = Segment(-2, 0, 2, 0, id="bar")


def met(run: Trajectory) -> list[str]:
    """What the ball meets, in order."""
    return [event.contacts[0].second for event in run.events]


def test_a_ball_from_beside_and_below_rises_and_lands_on_top() -> None:
    scene = Scene([Circle(-4, -2, "1/2", vx=2, vy=8, id="ball")], segments=[BAR], gravity=(0, -8))
    run = ExactEngine().run(scene, events=1)
    assert run.events[0].time.digits(12) == "1.61237243570"  # 1 + sqrt(6)/4
    at = run.at(run.events[0].time)["ball"]
    assert at.y.text() == "1/2"
    assert float(at.vy) > 0


def test_a_ball_below_is_met_from_below_and_never_from_above() -> None:
    scene = Scene([Circle(0, -2, "1/2", vy=8, id="ball")], [FLOOR], segments=[BAR], gravity=(0, -8))
    run = ExactEngine().run(scene, events=6)
    assert met(run) == ["bar", "floor"] * 3
    assert all(float(run.at(event.time)["ball"].y) < 0 for event in run.events)


def test_gravity_along_a_face_decides_where_it_is_met() -> None:
    # straight on, the ball would pass above the upright face; falling, it meets it
    upright = Segment(4, -3, 4, 0, id="upright")
    high = Scene([Circle(0, 1, "1/2", vx=1, id="ball")], segments=[upright], gravity=(0, "-1/4"))
    assert met(ExactEngine().run(high, events=1)) == ["upright"]
    run = ExactEngine().run(high, events=1)
    assert run.events[0].time.text() == "7/2"
    light = high.with_changes(gravity=(0, "-1/100"))
    assert met(ExactEngine().run(light, events=1)) == []


def test_a_corner_belongs_to_its_end() -> None:
    for segments in ([BAR], [BAR, Segment(2, 0, 5, 0, id="next")]):
        scene = Scene([Circle(2, 3, 1, id="ball")], segments=segments, gravity=(0, -10))
        run = ExactEngine().run(scene, events=5)
        assert met(run) == ["bar"] * 5
        assert abs(float(run.at(run.events[4].time)["ball"].x) - 2) < 1e-15


def test_rest_and_accumulation_on_a_face_end_by_name() -> None:
    still = ExactEngine().run(Scene([Circle(0, 1, id="ball")], segments=[BAR], gravity=(0, -10)))
    assert still.stop.reason is StopReason.REST
    for vx, x in ((0, 0), ("1/4", -1)):
        scene = Scene([Circle(x, 6, vx=vx, id="ball")], segments=[BAR], gravity=(0, -10), restitution="1/2")
        run = ExactEngine().run(scene)
        assert run.stop.reason is StopReason.ACCUMULATION
        assert run.ending is not None
        assert run.ending.text() == "3"
    box = Polygon([(-3, -2), (3, -2), (3, 0), (-3, 0)], id="box")
    scene = Scene([Circle(-2, 6, vx="1/4", id="ball")], polygons=[box], gravity=(0, -10), restitution="1/2")
    assert ExactEngine().run(scene).stop.reason is StopReason.ACCUMULATION


def test_bounces_that_may_pass_the_end_are_not_said_to_end_on_the_face() -> None:
    # by 3 it would be at x = 2 + 1/100, beyond the end, if its bounces ended there
    leaving = Scene([Circle(0, 6, vx="67/100", id="ball")], segments=[BAR], gravity=(0, -10), restitution="1/2")
    run = ExactEngine(max_bits=4000).run(leaving, events=200)
    assert run.stop.reason is not StopReason.ACCUMULATION
    assert run.stop.reason is not StopReason.REST


def test_a_ball_that_falls_along_an_upright_face_is_pressed_to_it() -> None:
    wall = Segment(0, -5, 0, 3, id="upright")
    two = [Circle(1, 1, vy=1, id="ball"), Circle(5, "3/2", vx=-5, vy=1, id="other")]
    run = ExactEngine().run(Scene(two, [FLOOR], segments=[wall], gravity=(0, -10)), events=1)
    assert {tuple(contact) for contact in run.events[0].contacts} == {("ball", "other"), ("ball", "upright")}


def test_finite_precision_has_the_same_first_events() -> None:
    for seed in (1, 2, 4):
        exact = ExactEngine().run(drawn(seed), events=4)
        wanted = [e.contacts for e in exact.events[:3]]
        for engine in (DoubleEngine(), SingleEngine(), QuadEngine(), RoundedEngine(bits=30)):
            run = engine.run(drawn(seed), events=4)
            assert [e.contacts for e in run.events[:3]] == wanted, engine.name


def test_pymunk_bounces_on_a_bar_and_a_box() -> None:
    box = Polygon([(3, -2), (5, -2), (5, 0), (3, 0)], id="box")
    balls = [Circle(0, 3, id="ball"), Circle(4, 4, id="other")]
    scene = Scene(balls, segments=[BAR], polygons=[box], gravity=(0, -10))
    exact, run = ExactEngine().run(scene, events=4), PymunkEngine(dt=1 / 4096).run(scene, events=4)
    assert [e.contacts for e in run.events] == [e.contacts for e in exact.events]
    assert all(abs(float(a.time) - float(b.time)) < 0.002 for a, b in zip(run.events, exact.events, strict=True))


def test_two_bits_may_leave_it_open_and_are_never_wrong() -> None:
    scene = drawn(3)
    sharp = ExactEngine().run(scene, events=12)
    for bits in (256, 300, 1000):
        run = ExactEngine(max_bits=bits).run(scene, events=12)
        assert [e.contacts for e in run.events] == [e.contacts for e in sharp.events[: len(run.events)]]


def test_no_run_is_turned_back_where_something_has_ends() -> None:
    with pytest.raises(SceneError, match="segment 'bar' is there, and no run is turned back there; leave reverse_at"):
        Scene([Circle(0, 6)], segments=[BAR], gravity=(0, -10), reverse_at=3)


def above_a_joint(e: str, turned: bool, mirrored: bool, high: Fraction, fast: str = "0", **changes: Any) -> Scene:
    """A disc straight above where one segment goes on as another, across gravity, which is 10."""
    c, s = (Fraction(3, 5), Fraction(4, 5)) if turned else (Fraction(1), Fraction(0))

    def at(x: Fraction, y: Fraction) -> tuple[Fraction, Fraction]:
        x = -x if mirrored else x
        return c * x - s * y, s * x + c * y

    zero, long = Fraction(0), Fraction(4)
    (vx, vy), g = at(Fraction(fast), zero), (10 * s, -10 * c)
    bars = [
        Segment(*at(-long, zero), *at(zero, zero), id="left"),
        Segment(*at(long, zero), *at(zero, zero), id="right"),
    ]
    disc = Circle(*at(zero, 1 + high), vx=vx, vy=vy, id="disc")
    return Scene([disc], segments=bars, gravity=g, restitution=e, until=30, **changes)


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("mirrored", [False, True])
def test_two_faces_on_one_line_are_one_at_their_joint(turned: bool, mirrored: bool) -> None:
    five = Fraction(5)
    for e, end in (("1/2", 3), ("1/5", Fraction(3, 2))):
        run = ExactEngine().run(above_a_joint(e, turned, mirrored, five))
        assert run.stop.reason is StopReason.ACCUMULATION
        assert run.ending is not None
        assert run.ending.text() == str(end)
        times = [Fraction(event.time.text()) for event in run.events]
        assert times == [end - 2 * Fraction(e) ** (k + 1) / (1 - Fraction(e)) for k in range(len(times))]
    for scene, many in (
        (above_a_joint("0", turned, mirrored, five), 1),
        (above_a_joint("0", turned, mirrored, five, "1/3"), 1),
        (above_a_joint("0", turned, mirrored, Fraction(0), settle=True), 0),
    ):
        run = ExactEngine().run(scene)
        assert run.stop.reason is StopReason.REST
        assert len(run.events) == many
    assert len(ExactEngine().run(above_a_joint("1", turned, mirrored, five)).events) == 15


def test_where_two_faces_are_not_on_one_line_nothing_rests_on_both() -> None:
    scene = above_a_joint("0", False, False, Fraction(5))
    for low in ("-1/10**9", "-1"):
        bars = [scene.segments[0], Segment(0, 0, 4, low, id="right")]
        assert ExactEngine().run(scene.with_changes(segments=bars)).stop.reason is StopReason.UNDECIDED


def test_bounces_on_a_joint_end_by_proof_alone() -> None:
    scene = above_a_joint("1/2", False, False, Fraction(5))
    near = Circle("2", "1 + 1/10**8", fixed=True, id="near")
    run = ExactEngine().run(scene.with_changes(circles=[*scene.circles, near]))
    assert run.stop.reason is not StopReason.ACCUMULATION


@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize("beside", ["peg", "end"])
@pytest.mark.parametrize(("e", "second"), [("0", None), ("1/2", 2), ("9/10", Fraction(14, 5)), ("1", 3)])
def test_what_lands_as_it_grazes_what_is_beside_it_goes_on_as_if_alone(
    e: str, second: Fraction | None, beside: str, mirrored: bool
) -> None:
    side = -1 if mirrored else 1
    floor, disc = Wall(0, 0, 1, 0, id="floor"), Circle(0, 6, id="disc")
    peg = Circle(2 * side, 1, fixed=True, id="peg")
    bars = [Segment(side, 1, 5 * side, 1, id="bar")]
    scene = Scene(
        [disc, peg] if beside == "peg" else [disc], [floor], gravity=(0, -10), restitution=e, events=2, until=9
    )
    run = ExactEngine().run(scene if beside == "peg" else scene.with_changes(segments=bars))
    assert [event.time.text() for event in run.events] == (["1"] if second is None else ["1", str(second)])
    assert {tuple(pair) for event in run.events for pair in event.impulses} == {("disc", "floor")}
    assert run.stop.reason is (StopReason.REST if second is None else StopReason.EVENTS)
