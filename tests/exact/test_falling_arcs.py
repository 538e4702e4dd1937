"""Arcs under gravity: against a referee in true coordinates, planted faults, and what ends by name."""

from __future__ import annotations

import random
from collections import Counter
from typing import Any

import edge_campaign
import pytest
import segment_referee
from arc_scenes import scene_of
from bow_referee import BowReferee, NotForThis, TieMet
from falling_campaign import FALLING
from flint import arb
from mpmath import mpf, workdps

from truebreak.compare.shadowing.shadows import shadow
from truebreak.compare.tangent.growth import error_growth
from truebreak.exact import ExactEngine
from truebreak.exact.literal.symbolic_engine import SymbolicEngine
from truebreak.exact.replay import landings, round_falls, wall_flights
from truebreak.exact.simulation import decider, instant
from truebreak.floating import DoubleEngine, IntervalEngine, PymunkEngine, QuadEngine, RoundedEngine, SingleEngine
from truebreak.floating.knots import FallingMotion
from truebreak.floating.pocket_entries import entries
from truebreak.scenarios import Arc, Circle, Pocket, Quantity, Scene, SceneError, Segment, Trajectory, Wall
from truebreak.scenarios.trajectory import Contact, StopReason, TieProof

FLOOR = Wall(0, -4, 1, -4, id="floor")
SIDES = [Wall(-6, 0, -6, 1, id="left"), Wall(6, 0, 6, 1, id="right")]
PULLS = [(0, -10), (0, "-981/100"), ("1/3", -4), ("sqrt(2)", -3)]


def drawn(seed: int) -> Scene:
    """One to three discs or points, arcs, and now and then fixed discs, segments and walls."""
    rng = random.Random(seed)
    if seed % 4 == 3:  # discs among arcs on a grid, in a box
        scene = scene_of(seed)
        if scene is not None:
            return scene.with_changes(gravity=rng.choice(PULLS))

    def some(low: int, high: int, parts: int = 100) -> str:
        return f"{rng.randint(low * parts, high * parts)}/{parts}"

    def radius() -> str:
        return rng.choice(["1/2", "1/4", "3/10", "sqrt(2)/4"])

    while True:
        arcs: list[Arc] = []
        for k in range(rng.choice([1, 1, 2, 3])):
            x, y, r = some(-3, 3), some(-3, 4), Quantity.of(rng.choice([some(1, 3), "2", "1", "3/2"]))
            ways = [(rng.randint(-9, 9), rng.randint(-9, 9)) for _ in range(2)]
            if arcs and rng.random() < 0.4:  # about the same middle; now and then as wide, too
                x, y = arcs[-1].x.text(), arcs[-1].y.text()
                r = arcs[-1].r if rng.random() < 0.5 else r
            cx, cy = Quantity.of(x), Quantity.of(y)
            begin, end = ((cx + ux, cy + uy) for ux, uy in ways)
            if arcs and not arcs[-1].full and arcs[-1].r == r and rng.random() < 0.5:  # where the one before ends
                begin = arcs[-1].ends[1]
                cx, cy = arcs[-1].x, arcs[-1].y
            try:
                full = rng.random() < 0.15
                arcs.append(Arc(cx, cy, r, id=f"a{k}", full=True) if full else Arc(cx, cy, r, *begin, *end, id=f"a{k}"))
            except SceneError:
                continue
        if not arcs:
            continue
        circles: list[Circle] = []
        for k in range(rng.randint(1, 3)):
            x, y = some(-4, 4), some(1, 8)
            if rng.random() < 0.5:  # within, or beside, an arc's circle
                bow = rng.choice(arcs)
                x, y = (bow.x + Quantity.of(x) / 4).text(), (bow.y + Quantity.of(y) / 8 - "1/2").text()
            vy = some(4, 12) if rng.random() < 0.3 else some(-4, 4)  # thrown up, to come back
            r, m = rng.choice([radius(), radius(), radius(), "0"]), rng.choice([1, 2, "1/3"])
            circles.append(Circle(x, y, r, some(-4, 4), vy, m, id=f"b{k}", point=r == "0"))
        circles += [Circle(some(-4, 4), some(-3, 5), radius(), m="oo", id=f"p{k}") for k in range(rng.randint(0, 1))]
        segments = [
            Segment(some(-4, 4), some(-3, 4), some(-4, 4), some(-3, 4), id=f"s{k}") for k in range(rng.randint(0, 1))
        ]
        walls = [*SIDES, FLOOR] if rng.random() < 0.8 else []
        e = rng.choice([1, 1, "9/10", "1/2"])
        try:
            return Scene(circles, walls, segments=segments, arcs=arcs, gravity=rng.choice(PULLS), restitution=e)
        except SceneError:
            continue


def pairs_of(run: Trajectory, k: int) -> list[list[str]]:
    """Who meets at an event."""
    return sorted(sorted((c.first, c.second)) for c in run.events[k].contacts)


def differs(scene: Scene, events: int) -> str | None:
    """What is otherwise than the referee has it; empty where all is as it has it, None where it has nothing."""
    run = ExactEngine(max_bits=2000, work=1_000_000).run(scene, events=events)
    count, quiet = len(run.events), run.stop.reason is StopReason.QUIET
    if run.events and float(run.events[0].time) == 0.0:
        return None  # the referee looks for what comes to a gap of zero, and not for what begins there
    try:
        course = BowReferee(scene).run(mpf(10) ** 9, count + quiet)
    except (TieMet, NotForThis):
        return None
    with workdps(60):
        if len(course.hits) != count:
            return "number of events"
        for k, (hit, event) in enumerate(zip(course.hits, run.events, strict=True)):
            if pairs_of(run, k) != [sorted(hit.pair)]:
                return f"who meets at event {k}"
            if abs(mpf(event.time.digits(40)) - hit.time) > mpf(10) ** -30 * (1 + hit.time):
                return f"time of event {k}"
        if run.events and not quiet:
            at = run.at(run.events[-1].time)
            for body, circle in zip(course.bodies, [c for c in scene.circles if not c.fixed], strict=True):
                mine = at[str(circle.id)]
                theirs = (body.x, body.y, body.vx, body.vy)
                for own, other in zip((mine.x, mine.y, mine.vx, mine.vy), theirs, strict=True):
                    told = mpf(own.ball(150).mid().str(40, radius=False))  # zero need not be proved
                    if abs(told - other) > mpf(10) ** -25 * (1 + abs(other)):
                        return f"state of {circle.id}"
    return ""


@pytest.mark.parametrize("seed", range(12))
def test_the_history_is_that_of_the_referee(seed: int) -> None:
    assert differs(drawn(seed), 10) == ""


@pytest.mark.slow
@pytest.mark.parametrize("block", range(20))
def test_many_histories_are_those_of_the_referee(block: int) -> None:
    found = Counter(differs(drawn(1000 + 50 * block + k), 15) for k in range(50))
    assert set(found) <= {"", None}
    assert found[""] > 40


# -- Planted faults: each is found.


def one_side(link: Any, fall: Any, stood: bool) -> Any:
    """The hollow side is met where the outside of as wide a circle would be."""
    return fall.polynomial(stood)


def mirrored(state: Any, link: Any, dx: Any, dy: Any) -> Any:
    """The rest of the circle is the arc."""
    found = WITHIN(state, link, dx, dy)
    return found if state.scene.arc_sides[link.arc].full else -found


def exchanged(state: Any, link: Any) -> Any:
    """Its one half is where the other is."""
    nx, ny, edge = CHORD(state, link)
    return -nx, -ny, edge


def first_alone(*of: Any) -> Any:
    """The first zero alone is looked at."""
    for found in ZEROS(*of):
        yield found
        return


def as_if_apart(self: Any, link: Any) -> bool:
    """The zero at 0 is not divided out."""
    return False


def narrow(self: Any, link: Any, other: Any) -> bool:
    """It is divided out of the side that was touched alone."""
    return link == other


def upside_down(self: Any, link: Any) -> Any:
    """Gravity pulls the other way."""
    found = FALL(self, link)
    return found._replace(hx=-found.hx, hy=-found.hy)


WITHIN, CHORD, ZEROS = landings.within_arc, landings.arc_chord, landings.falling_zeros
FALL = round_falls.RoundFalls.peg_fall_at_clock


@pytest.mark.parametrize(
    ("where", "name", "fault"),
    [
        (landings, "gap_of", one_side),
        (landings, "within_arc", mirrored),
        (landings, "arc_chord", exchanged),
        (landings, "falling_zeros", first_alone),
        (round_falls.RoundFalls, "stood", as_if_apart),
        (round_falls.RoundFalls, "_is_as_far", narrow),
        (round_falls.RoundFalls, "peg_fall_at_clock", upside_down),
    ],
)
def test_the_referee_finds_planted_faults(monkeypatch: pytest.MonkeyPatch, where: Any, name: str, fault: Any) -> None:
    sound = {seed: len(ExactEngine(max_bits=2000).run(drawn(seed), events=6).events) for seed in (*range(12), 58, 165)}
    monkeypatch.setattr(where, name, fault)

    def is_found(seed: int) -> bool:
        try:
            scene = drawn(seed)
            if len(ExactEngine(max_bits=600, work=100_000).run(scene, events=6).events) < sound[seed]:
                return True  # undecided, where all is decided
            return differs(scene, 6) not in ("", None)
        except AssertionError:
            return True

    assert any(is_found(seed) for seed in sound)


# -- What is told of fractions, and what ends by name.


def test_a_ring_and_a_floor_that_are_met_at_once_are_told_by_a_common_divisor() -> None:
    ring, floor = Arc(0, 0, "9/2", full=True, id="ring"), Wall(0, -5, 1, -5, id="floor")
    runs = [
        ExactEngine(max_bits=2000).run(
            Scene(
                [Circle(0, 0, "1/2", id="A"), Circle(10, f"-1/2+({off})", "1/2", vx=1, id="B")],
                [floor],
                arcs=[ring],
                gravity=(0, -2),
            ),
            events=1,
        )
        for off in ("0", "10**-30", "-10**-30")
    ]
    assert [len(run.events[0].contacts) for run in runs] == [2, 1, 1]
    assert [run.events[0].contacts[0].second for run in runs] == ["ring", "ring", "floor"]


def test_a_ball_that_grazes_a_ring_of_fractions_flies_on() -> None:
    counts = [
        len(
            ExactEngine(max_bits=2000)
            .run(
                Scene(
                    [Circle(0, 0, "1/2", vx=1, vy=1, id="ball")],
                    arcs=[Arc(1, f"3/2+({off})", "1/2", full=True)],
                    gravity=(0, -1),
                ),
                events=5,
            )
            .events
        )
        for off in ("0", "10**-30", "-10**-30")
    ]
    assert counts == [0, 0, 1]


def bowl(*balls: Circle, e: Any = 1) -> Scene:
    """A half-circle, open above."""
    return Scene(balls, arcs=[Arc(0, 0, 2, -2, 0, 2, 0, id="bowl")], gravity=(0, -10), restitution=e)


def test_a_ball_leaves_a_bowl_by_its_opening_and_comes_back_to_its_inside() -> None:
    run = ExactEngine().run(bowl(Circle(1, 0, "1/4", vx="-1/5", vy=10, id="ball")), events=1)
    assert run.at(1)["ball"].y.text() == "5"
    ball = run.at(run.events[0].time)["ball"]
    assert float(ball.y) < 0
    assert float(ball.x) ** 2 + float(ball.y) ** 2 == pytest.approx(1.75**2, abs=1e-12)


def test_a_ball_comes_to_a_bowl_from_below_and_from_above_its_rim() -> None:
    below = ExactEngine().run(bowl(Circle(0, -4, "1/4", vy=10, id="ball")), events=1)
    assert float(below.at(below.events[0].time)["ball"].y) == -2.25
    rim = ExactEngine().run(bowl(Circle("21/10", 3, "1/4", id="ball")), events=1)
    ball = rim.at(rim.events[0].time)["ball"]
    assert (float(ball.x) - 2) ** 2 + float(ball.y) ** 2 == pytest.approx(1 / 16, abs=1e-12)


def test_two_mirrored_balls_meet_a_bowl_at_the_same_instants() -> None:
    balls = [Circle(f"{s}4/5", "1/3", "1/4", id=name) for s, name in (("-", "left"), ("", "right"))]
    run = ExactEngine().run(bowl(*balls), events=8)
    assert run.certified
    assert len(run.events) == 8
    proofs = [event.ties[0].proof for event in run.events if len(event.contacts) > 1]
    assert len(proofs) >= 4
    assert set(proofs) == {TieProof.SYMMETRY}


def test_rest_in_a_bowl_and_bounces_that_shrink_in_it_end_by_name() -> None:
    resting = ExactEngine().run(bowl(Circle(0, "-7/4", "1/4", id="ball")))
    assert resting.stop.reason is StopReason.REST
    assert resting.stop.message.endswith(": ball and bowl")
    swinging = ExactEngine().run(bowl(Circle(0, "-7/4", "1/4", vx="1/2", id="ball")))
    assert swinging.stop.message.endswith(": ball and bowl, something round, along which it slides")
    shrinking = ExactEngine().run(bowl(Circle("1/10**9", -1, "1/4", id="ball"), e="1/2"), events=400)
    assert shrinking.stop.reason is StopReason.UNDECIDED
    assert "accumulation suspected: ball and bowl" in shrinking.stop.message


def test_what_comes_to_the_very_end_of_an_arc_is_undecided() -> None:
    quarter = Scene([Circle(0, 3, "1/4", id="ball")], arcs=[Arc(0, 0, 1, 0, 1, -1, 0, id="quarter")], gravity=(0, -10))
    run = ExactEngine(max_bits=600, work=100_000).run(quarter, events=3)
    assert run.stop.reason is StopReason.UNDECIDED
    assert "ball and quarter" in run.stop.message


def test_bounces_on_a_floor_are_not_said_to_end_where_an_arc_is_near() -> None:
    """Unless no arc is near, a run says nothing of bounces that end; the dome that it has is met by none of these."""
    floor = Wall(0, 0, 1, 0, id="floor")
    found = [
        ExactEngine()
        .run(
            Scene(
                [Circle(0, 2, "1/4", id="ball")],
                [floor],
                arcs=[Arc(0, 0, r, 1, 0, -1, 0, id="dome")],
                gravity=(0, -10),
                restitution="1/2",
            ),
            events=60,
        )
        .stop.reason
        for r in ("9", "1/4+1/4+10**-9")
    ]
    assert found[0] is StopReason.ACCUMULATION
    assert found[1] is not StopReason.ACCUMULATION


@pytest.mark.parametrize("seed", [0, 2, 5, 6])
def test_engines_of_finite_precision_have_the_same_first_events(seed: int) -> None:
    scene = drawn(seed)
    exact = ExactEngine().run(scene, events=5)
    for engine in (DoubleEngine(), SingleEngine(), QuadEngine(), RoundedEngine(bits=40), IntervalEngine(bits=200)):
        run = engine.run(scene, events=5)
        assert [e.contacts for e in run.events[:3]] == [e.contacts for e in exact.events[:3]], engine.name
        for mine, theirs in zip(run.events[:3], exact.events[:3], strict=True):
            assert float(mine.time) == pytest.approx(float(theirs.time), rel=1e-4)


def test_intervals_are_never_wrong() -> None:
    for seed in range(30):
        scene = drawn(seed)
        exact, run = ExactEngine().run(scene, events=10), IntervalEngine(bits=53).run(scene, events=10)
        count = len(run.events)
        assert [e.contacts for e in run.events] == [e.contacts for e in exact.events[:count]]
        for mine, theirs in zip(run.events, exact.events[:count], strict=True):
            assert mine.time.low <= float(theirs.time) <= mine.time.high  # pyright: ignore[reportAttributeAccessIssue]


def test_two_bits_may_leave_it_open_and_are_never_wrong() -> None:
    for seed in (1, 2, 9):
        sharp = ExactEngine().run(drawn(seed), events=12)
        for bits in (256, 300, 1000):
            run = ExactEngine(max_bits=bits).run(drawn(seed), events=12)
            assert [e.contacts for e in run.events] == [e.contacts for e in sharp.events[: len(run.events)]]


def test_no_run_is_turned_back_where_an_arc_stands_under_gravity() -> None:
    with pytest.raises(SceneError, match="arc 'bowl' is there, and no run is turned back there; leave reverse_at out"):
        bowl(Circle(0, 0, "1/4")).with_changes(reverse_at=3)


# -- Rims of pockets, which do not push.


def with_pockets(seed: int) -> Scene:
    """A scene with one to three pockets, in which some circles begin."""
    rng = random.Random(seed + 10**6)
    holes = [
        Pocket(f"{rng.randint(-40, 40)}/10", f"{rng.randint(-30, 60)}/10", rng.choice(["1", "1/2", "3/2"]), id=f"h{k}")
        for k in range(rng.randint(1, 3))
    ]
    return drawn(seed).with_changes(pockets=holes)


def enters_otherwise(scene: Scene, events: int) -> str | None:
    """What of the entries is otherwise than the referee has it; None where it has nothing."""
    run = ExactEngine(max_bits=2000, work=1_000_000).run(scene, events=events)
    if not run.events or float(run.events[0].time) == 0.0:
        return None
    try:
        course = BowReferee(scene).run(mpf(10) ** 9, len(run.events))
        if [pairs_of(run, k) for k in range(len(run.events))] != [[sorted(hit.pair)] for hit in course.hits]:
            return "who meets"
        last = course.hits[-1].time
        known = BowReferee(scene).entries(scene, course, last)
    except (TieMet, NotForThis):
        return None
    mine = [entry for entry in run.pocketings if float(entry.time) < float(last) * (1 - 1e-12)]
    with workdps(60):
        if [(e.circle, e.pocket) for e in mine] != [row[1:] for row in known]:
            return "who enters"
        for entry, (time, _, _) in zip(mine, known, strict=True):
            if abs(mpf(entry.time.ball(150).mid().str(40, radius=False)) - time) > mpf(10) ** -30 * (1 + time):
                return "when one enters"
    return "" if known else "none"


@pytest.mark.parametrize("block", range(3))
def test_centres_enter_pockets_as_the_referee_has_it(block: int) -> None:
    found = [enters_otherwise(with_pockets(4 * block + k), 8) for k in range(4)]
    assert set(found) <= {"", "none", None}
    assert "" in found


def test_a_ball_thrown_through_a_pocket_enters_it_twice() -> None:
    hole = Pocket(0, 2, 1, id="hole")
    scene = Scene([Circle(0, 0, "1/4", vy=10, id="ball")], [FLOOR], pockets=[hole], gravity=(0, -10))
    for engine in (
        ExactEngine(),
        DoubleEngine(),
        SingleEngine(),
        QuadEngine(),
        RoundedEngine(bits=40),
        IntervalEngine(),
    ):
        run = engine.run(scene, events=2)
        times = [float(entry.time) for entry in run.pocketings]
        up, down = (10 - 80**0.5) / 10, (10 + 40**0.5) / 10
        assert times[:2] == pytest.approx([up, down], abs=1e-5), engine.name
        assert len(times) == 4, engine.name
        place = run.at(run.pocketings[1].time)["ball"]
        assert float(place.y) == pytest.approx(3, abs=1e-5)


def test_finite_precision_enters_as_the_exact_run() -> None:
    for seed in (0, 4, 8):
        scene = with_pockets(seed)
        exact = ExactEngine().run(scene, events=4)
        for engine in (DoubleEngine(), QuadEngine(), IntervalEngine(bits=200)):
            run = engine.run(scene, events=4)
            assert [(e.circle, e.pocket) for e in run.pocketings] == [(e.circle, e.pocket) for e in exact.pocketings]


def never_again(self: Any, link: Any) -> bool:
    """The zero at a rim that has been entered is not divided out."""
    return STOOD(self, link) and link.pushes


def rises(link: Any, fall: Any, stood: bool) -> Any:
    """A pocket is entered where it is left."""
    found = fall.polynomial(stood)
    return found if link.pushes else tuple(-value for value in found)


STOOD = round_falls.RoundFalls.stood


@pytest.mark.parametrize(
    ("where", "name", "fault"),
    [(round_falls.RoundFalls, "stood", never_again), (landings, "gap_of", rises)],
)
def test_the_referee_finds_faults_of_rims(monkeypatch: pytest.MonkeyPatch, where: Any, name: str, fault: Any) -> None:
    monkeypatch.setattr(where, name, fault)

    def is_found(seed: int) -> bool:
        try:
            scene = with_pockets(seed)
            run = ExactEngine(max_bits=600, work=100_000).run(scene, events=5)
            return run.stop.reason is StopReason.UNDECIDED or enters_otherwise(scene, 5) not in ("", "none", None)
        except AssertionError:
            return True

    assert any(is_found(seed) for seed in range(12))


def test_square_roots_go_to_where_a_rim_may_come_first() -> None:
    floor = Wall(0, 0, 1, 0, id="floor")
    ball, hole = Circle(0, 5, 1, id="ball"), Pocket(20, 20, 1, id="hole")
    run = SymbolicEngine().run(Scene([ball], [floor], pockets=[hole], gravity=(0, -2)), events=3)
    assert [event.time.text() for event in run.events] == ["2", "6", "10"]
    lower = Scene([ball], [floor], pockets=[Pocket(0, "1/2", "1/4", id="hole")], gravity=(0, -2))
    assert len(SymbolicEngine().run(lower, events=3).events) == 3
    higher = lower.with_changes(pockets=(Pocket(0, 3, 1, id="hole"),))
    run = SymbolicEngine().run(higher, events=3)
    assert run.stop.reason is StopReason.UNDECIDED
    assert "whether and when ball enters hole is told by a zero of a quartic" in run.stop.message
    inside = lower.with_changes(pockets=(Pocket(0, 3, 9, id="hole"),))
    assert len(SymbolicEngine().run(inside, events=3).events) == 3


# -- Pockets that capture: what they take stands where it entered, in true coordinates.


def with_holes(seed: int) -> Scene:
    """Four discs in a box with two pockets that capture, under gravity."""
    rng = random.Random(seed)
    while True:
        discs = [
            Circle(rng.randint(2, 18), rng.randint(2, 18), f"{rng.randint(10, 90)}/200", f"{rng.randint(-9, 9)}/3",
                   f"{rng.randint(-9, 9)}/4", rng.randint(1, 3), id=f"c{k}")
            for k in range(4)
        ]  # fmt: skip
        holes = [
            Pocket(rng.randint(3, 17), rng.randint(1, 5), f"{rng.randint(20, 60)}/40", id=f"h{k}") for k in range(2)
        ]
        walls = [Wall(0, 0, 1, 0), Wall(0, 0, 0, 1), Wall(20, 0, 20, 1), Wall(0, 20, 1, 20)]
        pull, e = rng.choice([*PULLS, (0, -2)]), rng.choice([1, 1, "9/10"])
        try:
            return Scene(discs, walls, pockets=holes, capture=True, gravity=pull, restitution=e)
        except SceneError:  # two lie on each other
            continue


def takes_otherwise(seed: int) -> str:
    """What of a run the referee in true coordinates has otherwise: events, entries, or the state at the end."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(segment_referee, "DIGITS", FALLING.digits[0])
        patch.setattr(segment_referee, "SAME", FALLING.digits[1])
        aged = edge_campaign.Aged(with_holes(seed), Quantity.of(9))
        outcome, told, _ = edge_campaign.examined(aged, FALLING)
    return f"{outcome}: {told}" if outcome == "failure" else ""


HOLES = (0, 1, 4, 7)


@pytest.mark.parametrize("seed", HOLES)
def test_what_a_pocket_takes_stands_where_it_entered(seed: int) -> None:
    scene = with_holes(seed)
    assert ExactEngine().run(scene, until=9).pocketings
    assert not takes_otherwise(seed)


def in_its_frame(self: Any, body: Any) -> Any:
    """As it stands in the frame that falls."""
    return body.flight[:4]


@pytest.mark.parametrize(
    ("where", "name", "fault"),
    [
        (wall_flights.WallFlights, "true_row", in_its_frame),
        (decider.RunLog, "_carried", {}),
        (instant.Resolver, "_capture", lambda *_: None),
    ],
)
def test_the_referee_finds_faults_of_captures(
    monkeypatch: pytest.MonkeyPatch, where: Any, name: str, fault: Any
) -> None:
    monkeypatch.setattr(where, name, fault)
    assert any(map(takes_otherwise, HOLES))


@pytest.mark.parametrize("seed", range(6))
def test_every_engine_takes_what_a_pocket_captures_out_of_play(seed: int) -> None:
    scene = with_holes(seed)
    exact = ExactEngine().run(scene, until=9)
    shorter = ExactEngine().run(scene, events=max(1, len(exact.events) // 2))
    gone_on = ExactEngine().resume(shorter, until=9)
    assert [e.contacts for e in gone_on.events] == [e.contacts for e in exact.events]
    for engine in (DoubleEngine(), QuadEngine(), IntervalEngine(bits=300), RoundedEngine(bits=50)):
        run = engine.run(scene, until=9)
        assert [e.contacts for e in run.events] == [e.contacts for e in exact.events]
        assert [(e.circle, e.pocket) for e in run.pocketings] == [(e.circle, e.pocket) for e in exact.pocketings]
        for mine, theirs in zip(run.motion.state(8.75), exact.motion.state(8.75), strict=True):
            assert [*map(float, mine)] == pytest.approx([*map(float, theirs)], abs=1e-7)


def test_a_circle_that_a_segment_that_moves_would_meet_is_out_of_play() -> None:
    paddle = Segment(-2, -3, 2, -3, id="paddle", vy=2)
    discs = [Circle(0, 5, "1/2", id="falls"), Circle("3/2", 2, "1/4", id="waits", vy=5)]
    scene = Scene(discs, segments=[paddle], pockets=[Pocket(0, 2, 1, id="hole")], capture=True, gravity=(0, -10))
    for engine in (ExactEngine(), DoubleEngine()):
        run = engine.run(scene, until=3)
        assert [(e.circle, e.pocket) for e in run.pocketings] == [("falls", "hole")]
        assert "falls" not in {name for event in run.events for pair in event.contacts for name in pair}
        assert run.events
        assert float(run.at(3)["falls"].y) == pytest.approx(3)


# -- Entries of engines that know no pockets: found along their flights.


@pytest.mark.parametrize("seed", range(8))
def test_entries_along_flights_are_those_that_the_exact_run_has(seed: int) -> None:
    scene = with_holes(seed).with_changes(capture=False)
    exact, plain = ExactEngine().run(scene, events=12), DoubleEngine().run(scene.with_changes(pockets=[]), events=12)
    found = entries(scene, plain.motion, float(plain.final_time))
    assert [(e.circle, e.pocket) for e in found] == [(e.circle, e.pocket) for e in exact.pocketings]
    for mine, theirs in zip(found, exact.pocketings, strict=True):
        assert float(mine.time) == pytest.approx(float(theirs.time), abs=1e-9)


def test_a_parabola_enters_a_pocket_twice_or_once_or_grazes_it() -> None:
    def times(vy: float, reach: float, since: float = 0.0) -> list[float]:
        scene = Scene([Circle(0, 0, "1/4", id="ball")], pockets=[Pocket(0, 2, reach, id="hole")], gravity=(0, -10))
        motion = FallingMotion([[(since, 0.0, 0.0, 0.0, vy)]], 9.0, halves=(0.0, -5.0))
        return [float(entry.time) for entry in entries(scene, motion, 9.0)]

    assert times(10.0, 1.0) == pytest.approx([(10 - 80**0.5) / 10, (10 + 40**0.5) / 10])
    assert times(7.5, 1.0, 2.0) == pytest.approx([2 + (7.5 - 36.25**0.5) / 10])  # it turns within
    assert times(4.0, 1.0) == []


@pytest.mark.parametrize("seed", range(4))
def test_pymunk_enters_as_the_law_has_it_up_to_its_step(seed: int) -> None:
    scene = with_holes(seed).with_changes(capture=False, restitution=1)
    law = ExactEngine().run(scene, until=2)
    for dt in (1 / 256, 1 / 1024):
        run = PymunkEngine(dt=dt).run(scene, until=2)
        assert [(e.circle, e.pocket) for e in run.pocketings] == [(e.circle, e.pocket) for e in law.pocketings]
        for mine, theirs in zip(run.pocketings, law.pocketings, strict=True):
            assert abs(float(mine.time) - float(theirs.time)) < 12 * dt


def test_pockets_that_take_nothing_change_neither_errors_nor_shadows() -> None:
    scene = with_holes(0).with_changes(capture=False)
    bare = scene.with_changes(pockets=[])
    run, plain = (ExactEngine().run(each, events=12) for each in (scene, bare))
    assert run.pocketings
    assert error_growth(run, 12) == error_growth(plain, 12)
    one, other = (shadow(each, events=40).proof for each in (scene, bare))
    assert one is not None
    assert other is not None
    assert one.run_distance == other.run_distance


def test_a_fourfold_zero_where_a_range_begins_is_not_looked_for_without_end(monkeypatch: pytest.MonkeyPatch) -> None:
    """A disc that falls as a circle is bent that begins there: near the zero parts are many."""
    parted, asked = landings.parted, 0

    def counted(b: list[arb], share: arb) -> tuple[list[arb], list[arb]]:
        nonlocal asked
        asked += 1
        assert asked < 100_000
        return parted(b, share)

    monkeypatch.setattr(landings, "parted", counted)
    disc = Circle("283/312", "-11/26", r=1, vx="5/78", vy="2/13", id="disc")
    bow = Arc("-12/13", "5/13", 1, 0, 0, "-17/13", "-7/13", id="bow")
    run = ExactEngine().run(Scene([disc], arcs=[bow], gravity=("-5/39", "-4/13")), until=2)
    assert run.events == ()
    assert run.stop.reason is StopReason.HORIZON


@pytest.mark.parametrize("r", ["0", "1/4"])
def test_a_graze_of_an_end_where_a_face_begins_to_which_gravity_pulls_is_no_miss(r: str) -> None:
    """At its apex the disc touches the end where the face begins, and moves over it: it was certified to go through."""
    ball = Circle(2, Quantity.of(r) - Quantity.of("5/3"), "1/2", vx=-1, vy="1/3", id="ball")
    bar = Segment(0, -2, 1, -2, id="bar", r=r)
    run = ExactEngine().run(Scene([ball], segments=[bar], gravity=(0, "-1/3")), until=3)
    assert run.stop.reason is StopReason.UNDECIDED
    assert "ball and bar touch and stay so: the circle comes to an end of the face" in run.stop.message
    assert run.events == ()
    upright = Segment(1, -2, 1, -9, id="bar", r=r)  # no face begins there: it grazes the end, and goes on
    past = ExactEngine().run(Scene([ball], segments=[upright], gravity=(0, "-1/3")), until=3)
    assert past.stop.reason is StopReason.HORIZON


@pytest.mark.parametrize("floor", [-8, -7])
def test_what_falls_beside_a_peg_grazes_it_down_and_up_again(floor: int) -> None:
    """Two double zeros on the way up: after -8 of a quartic in fractions, after -7 not; nearer by 2**-99 it hits."""
    peg, ground = Circle(0, 0, r=1, m="oo", id="peg"), Wall(-9, floor, 9, floor, id="floor")

    def run(x: Quantity) -> Trajectory:
        ball = Circle(x, 9, r=1, id="ball")
        return ExactEngine().run(Scene([ball, peg], walls=[ground], gravity=(0, -2)), until=20)

    beside, far, near = (run(Quantity.of(2) + Quantity.of(by)) for by in ("0", f"1/{2**99}", f"-1/{2**99}"))
    assert beside.stop.reason is far.stop.reason is StopReason.HORIZON
    assert len(beside.events) >= 2
    assert {contact for event in beside.events for contact in event.contacts} == {Contact("ball", "floor")}
    assert [float(event.time) for event in far.events] == [float(event.time) for event in beside.events]
    assert near.events[0].contacts == (Contact("ball", "peg"),)


@pytest.mark.parametrize(
    ("y", "arc"),
    [
        ("9", Arc(0, 0, 2, 0, -2, 2, 0, id="bow")),
        ("9", Arc(3, -2, 3, 0, -2, 3, -5, id="bow")),
        ("9+sqrt(2)", Arc(3, -1, 3, 0, -1, 6, -1, id="bow")),
        ("1/3", Arc(3, -1, 3, 0, -1, 6, -1, id="bow")),
    ],
)
def test_a_disc_that_comes_to_an_arc_along_its_end_is_not_let_through(y: str, arc: Arc) -> None:
    """It falls straight, beside the middle of the circle as far as at a contact from within: it was certified to cross
    the arc."""
    floor = Wall(-9, -12, 9, -12, id="floor")
    run = ExactEngine().run(Scene([Circle(1, y, r=1, id="ball")], [floor], arcs=[arc], gravity=(0, -2)), until=9)
    assert run.stop.reason is StopReason.UNDECIDED
    assert run.events == ()


def test_what_slides_on_along_a_face_from_its_end_is_not_told_to_graze_it() -> None:
    bar = Segment(1, "1/2", 1, -5, id="bar")
    scene = Scene([Circle(0, "9+sqrt(2)", r=1, id="ball")], [], segments=[bar], gravity=(0, -2))
    run = ExactEngine().run(scene, until=9)
    assert (run.stop.reason, run.events) == (StopReason.HORIZON, ())
    assert run.final["ball"].y.text() == "sqrt(2) - 72"


@pytest.mark.parametrize("k", [100, 300])
def test_a_hit_that_all_but_grazes_is_carried_out_with_the_bits_that_told_it(k: int) -> None:
    """Beside it another end is grazed: the run raised an error at 200."""
    ends = [Segment("1/4", -2, 4, -2, id="graze"), Segment(Quantity.of(f"1/{2**k}") - "1/4", -2, -3, -2, id="hit")]
    run = ExactEngine().run(
        Scene([Circle(0, 2, r="1/4", id="ball")], segments=ends, gravity=(0, -2)), until=8, events=3
    )
    assert [event.contacts[0].second for event in run.events] == ["hit", "graze", "hit"]
