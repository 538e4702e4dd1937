"""What two walls hold between them: it lies there, bounces there straight up and down, and is struck there."""

from __future__ import annotations

import sys
from collections import Counter
from dataclasses import replace
from fractions import Fraction
from typing import Any

import pytest
from settle_campaign import cornered, examined

from truebreak.compare import compare
from truebreak.compare.certificate import CertificateError, certificate_json, certificate_of
from truebreak.compare.files.saved import run_of, saved_run
from truebreak.compare.report.sentences import settled_phrase
from truebreak.exact import ExactEngine
from truebreak.exact.isometry import scene_data
from truebreak.exact.replay.contact import AtWall, Sides
from truebreak.exact.simulation import arc_meetings, endings
from truebreak.exact.simulation.arc_meetings import borne, held_between
from truebreak.floating import DoubleEngine, PymunkEngine, QuadEngine, RoundedEngine, SingleEngine
from truebreak.scenarios import Circle, Polygon, Quantity, Scene, Segment, Wall
from truebreak.scenarios.trajectory import StopReason, Trajectory
from truebreak.tools.verify import weighed

SQUARE = [Wall(0, 0, -1, 1, id="left"), Wall(0, 0, 1, 1, id="right")]
FLAT = [Wall(0, 0, -4, 3, id="left"), Wall(0, 0, 4, 3, id="right")]
FACES = [Segment(-4, 3, 0, 0, id="left"), Segment(0, 0, 4, 3, id="right")]
RAMP = [Wall(0, 0, 4, -3, id="ramp"), Wall(1, 0, 1, 1, id="end")]
LIES = Circle(0, "5/4", id="a")
FLOOR = Wall(0, 0, 1, 0, id="floor")


def scene(circles: list[Circle], things: list[Any], e: object = 0, *, settle: bool = True) -> Scene:
    """Under gravity of 10; walls, segments or polygons."""
    of = {
        kind: [thing for thing in things if type(thing) is made]
        for kind, made in (("walls", Wall), ("segments", Segment), ("polygons", Polygon))
    }
    return Scene(circles, gravity=(0, -10), restitution=e, settle=settle, **of)  # pyright: ignore[reportArgumentType]


def ran(circles: list[Circle], things: list[Any], e: object = 0, until: object = 9) -> Trajectory:
    """The certified run of these."""
    return ExactEngine().run(scene(circles, things, e), until=until)  # pyright: ignore[reportArgumentType]


def is_verified(run: Trajectory) -> bool:
    """Whether the checker proves it."""
    digits = sys.get_int_max_str_digits()
    try:
        return weighed(certificate_json(certificate_of(run)).encode())[0] == 0
    finally:
        sys.set_int_max_str_digits(digits)


def rests(run: Trajectory) -> list[tuple[str, str]]:
    """Who lies where."""
    return [(rest.circle, rest.where) for rest in run.settlings]


@pytest.mark.parametrize("things", [FLAT, FACES, RAMP], ids=["walls", "faces", "ramp"])
@pytest.mark.parametrize("e", [0, "1/2", 1])
def test_a_disc_lies_between_two_walls(things: list[Any], e: object) -> None:
    one, other = (str(thing.id) for thing in things)
    run = ran([LIES], things, e)
    assert (rests(run), run.stop.reason, run.slides) == ([("a", f"between {one} and {other}")], StopReason.HORIZON, {})
    assert (run.final["a"].x.text(), run.final["a"].y.text(), run.final["a"].vy.text()) == ("0", "5/4", "0")
    stopped = ExactEngine().run(scene([LIES], things, e, settle=False), until=9).stop
    assert stopped.reason is StopReason.REST
    assert "slides" not in stopped.message


def test_two_slopes_that_lean_the_same_way_hold_nothing() -> None:
    """It slides along the less steep one, and that alone is said."""
    walls = [Wall(0, 0, 3, -4, id="steep"), Wall(0, 0, 4, -3, id="shallow")]
    stopped = ran([Circle("5/7", "5/7", id="a")], walls).stop
    assert stopped.reason is StopReason.REST
    assert "a and shallow, a slope, along which it slides" in stopped.message
    assert "steep" not in stopped.message


def test_which_pairs_of_walls_hold_a_disc_is_told_by_the_sides_of_gravity() -> None:
    """Against the solution of -g = p a + q b by division, for lines through a point all around."""
    ways = [(4, 3), (3, 4), (0, 1), (-3, 4), (-4, 3), (-1, 0), (1, 0), (5, -12), (12, 5)]
    held = 0
    for k, (ux, uy) in enumerate(ways):
        for wx, wy in ways[k + 1 :]:
            turn = ux * wy - uy * wx
            for x, y in ((1, 7), (7, 1), (-7, 2), (2, -7)):
                if not turn or 0 in (ux * y - uy * x, wx * y - wy * x):
                    continue
                walls = [Wall(0, 0, ux, uy), Wall(0, 0, wx, wy)]
                sides = Sides(Scene([Circle(x, y, "1/9")], walls, gravity=(0, -10)))
                normals = [(-v, u) if u * y - v * x > 0 else (v, -u) for u, v in ((ux, uy), (wx, wy))]
                (ax, ay), (bx, by) = normals
                p, q = -bx / (ax * by - ay * bx), ax / (ax * by - ay * bx)  # (0, 1) = p a + q b
                assert held_between(sides, 0, 0, 1) == (p > 0 and q > 0), (ux, uy, wx, wy, x, y)
                held += p > 0 and q > 0
    assert held == 12


@pytest.mark.parametrize("things", [SQUARE, FLAT, FACES], ids=["square", "flat", "faces"])
def test_dropped_into_the_middle_it_bounces_straight_and_settles(things: list[Any]) -> None:
    high = Quantity.of("5/4") if things is not SQUARE else Quantity.of("sqrt(2)")
    first = ((6 - high) / 5).sqrt()
    run = ran([Circle(0, 6, id="a")], things, "1/2", 20)
    (rest,) = run.settlings
    assert rest.where == "between left and right"
    assert Quantity.of(rest.time.text()) == 3 * first
    assert all({*map(tuple, event.impulses)} == {("a", "left"), ("a", "right")} for event in run.events)
    times = [Quantity.of(event.time.text()) for event in run.events]
    assert all(time == first * Quantity.of(n) for time, n in zip(times, (1, 2, "5/2", "11/4"), strict=False))
    speed = 10 * first * Quantity.of("1/2") ** len(times)
    then, lag = (
        times[-1] + speed / 10 / 2,
        speed / 10 / 2,
    )  # as it is highest
    assert Quantity.of(run.at(then)["a"].y.text()) == high + speed * lag - 5 * lag * lag
    assert (run.final["a"].y.text(), run.final["a"].vy.text()) == (high.text(), "0")
    named = ExactEngine().run(scene([Circle(0, 6, id="a")], things, "1/2", settle=False))
    assert named.stop.reason is StopReason.ACCUMULATION
    assert named.ending is not None
    assert Quantity.of(named.ending.text()) == 3 * first
    assert "a and left as well as a and right" in named.stop.message


@pytest.mark.parametrize("engine", [DoubleEngine, SingleEngine, QuadEngine, RoundedEngine], ids=lambda e: e.__name__)
def test_engines_of_finite_precision_hold_it_too(engine: Any) -> None:
    given = scene([Circle(0, 6, id="a")], SQUARE, "1/2")
    exact, run = ExactEngine().run(given, until=20), engine().run(given, until=20)
    assert rests(run) == rests(exact)
    assert float(run.settlings[0].time) == pytest.approx(float(exact.settlings[0].time), rel=1e-6)
    for time in (1.1, 2.5, 2.87, 9.0):
        assert float(run.at(time)["a"].y) == pytest.approx(float(exact.at(str(time))["a"].y), abs=1e-5)


def test_steps_push_it_in_each_and_that_is_no_collision() -> None:
    """A solver pushes it at both walls in each step, at one that is upright with no speed of its own too."""
    for circles, things, e in (([LIES], RAMP, 0), ([LIES], FLAT, "1/2"), ([Circle(0, 6, id="a")], SQUARE, 0)):
        given = scene(circles, things, e)
        comparison = compare(given, ["double", "pymunk"], until=4)
        assert [c.alignment.verdict for c in comparison.candidates] == ["agree", "agree"], things
        assert "otherwise" not in settled_phrase(comparison)
        (rest,) = PymunkEngine().run(given, until=4).settlings
        assert {rest.wall, rest.other} == {str(thing.id) for thing in things}


@pytest.mark.parametrize("things", [FLAT, FACES], ids=["walls", "faces"])
def test_struck_there_it_is_pushed_against_both(things: list[Any]) -> None:
    given = scene([LIES, Circle("1/10", 8, id="b")], things, "1/2")
    run, own = (engine.run(given, until=1) for engine in (ExactEngine(), DoubleEngine()))
    assert {tuple(pair) for pair in run.events[0].impulses} == {("a", "b"), ("a", "left"), ("a", "right")}
    assert [event.impulses for event in own.events] == [event.impulses for event in run.events]
    assert compare(given, ["double"], until=1).candidates[0].laws.kept is True  # pyright: ignore[reportOptionalMemberAccess]


def test_a_disc_that_lies_on_a_floor_leans_on_what_it_touches() -> None:
    """A slope at its side is one of the contacts of a blow, though the floor alone bears it."""
    walls = [Wall(0, 0, 1, 0, id="floor"), Wall("3/5", "1/5", "23/5", "16/5", id="up")]
    run = ran([Circle(0, 1, id="a"), Circle("-1/2", 5, id="b")], walls, "1/2", 1)
    assert rests(run)[0] == ("a", "on floor")
    assert {tuple(pair) for pair in run.events[0].contacts} == {("a", "b"), ("a", "floor"), ("a", "up")}


@pytest.mark.parametrize("end", ["wall", "post", "ell"])
def test_a_disc_settles_beside_an_upright_face_that_it_touches(end: str) -> None:
    """Its other side, which is the same line, is none that it could meet."""
    floor, shelf = Wall(0, 0, 1, 0, id="floor"), Segment(0, 0, 6, 0, id="floor")
    post, wall = Segment(6, 0, 6, 4, id="post"), Wall(6, 0, 6, 1, id="post")
    things = {"wall": [floor, wall], "post": [floor, post], "ell": [shelf, post]}[end]
    run = ran([Circle(5, 3, id="b")], things, "1/2", 12)
    assert rests(run) == [("b", "on floor")]
    assert run.settlings[0].time.text() == "3/5*sqrt(10)"


def test_a_landing_is_told_where_what_lands_slides_to_an_end() -> None:
    ledge = [Segment(-5, 0, 5, 0, id="ledge")]
    run = ran([Circle(0, 3, vx=1, id="a")], ledge, 0, 12)
    assert [tuple(map(tuple, event.impulses)) for event in run.events] == [(("a", "ledge"),)]
    assert run.stop.reason is StopReason.REST
    assert run.stop.message.endswith("a and ledge, a face, along which it slides: it would come to its end")
    with pytest.raises(CertificateError, match="slides along a face, to its end"):
        certificate_of(run)


def test_runs_and_what_is_told_of_them_keep_both_walls() -> None:
    run = ran([Circle(0, 6, id="a")], SQUARE, "1/2", 20)
    again = run_of(saved_run(run))
    assert again is not None
    assert (rests(again), again.settlings[0].time.text()) == (rests(run), run.settlings[0].time.text())
    assert again.at("28730/10000")["a"].y.digits(30) == run.at("28730/10000")["a"].y.digits(30)
    assert is_verified(run)


CROOKED = [Polygon([(-4, 4), (-4, -1), (4, -1), (4, 4), (0, 0)], id="block")]


def test_a_polygon_holds_what_lies_in_its_corner() -> None:
    run = ran([Circle(0, 6, id="a")], CROOKED, "1/2", 20)
    assert rests(run) == [("a", "in a corner of block")]


@pytest.mark.parametrize(
    ("where", "name", "fault"),
    [
        (endings, "held_between", lambda *_: False),
        (arc_meetings, "held_between", lambda *_: True),
        (endings, "are_square", lambda *_: False),
    ],
    ids=["none held", "all held", "none square"],
)
def test_planted_faults_are_found(where: Any, name: str, fault: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    def told() -> list[object]:
        walls = [Wall(0, 0, 3, -4, id="steep"), Wall(0, 0, 4, -3, id="shallow")]
        slides = ExactEngine().run(scene([Circle("5/7", "5/7", id="a")], walls, settle=False), until=1)
        one_by_one = scene([Circle(0, 6, id="a")], SQUARE, "1/2").with_changes(tie_policy="sequential")
        return [
            rests(ran([LIES], FLAT)),
            slides.stop.message,
            rests(ExactEngine().run(one_by_one, until=9, events=22)),  # as many as it needs: a fault may have no end
            borne(Sides(scene([LIES], FLAT)), 0, [0, 1]),
        ]

    true = told()
    assert true[2] == [("a", "between left and right")]
    monkeypatch.setattr(where, name, fault)
    assert told() != true


# -- mirror images, one of which is carried as the other is


def mirrored(e: object) -> Scene:
    """Two discs that lie, on which two others fall, as seen in a mirror."""
    discs = [Circle(x, 1, id=f"lies{x}") for x in (-6, 6)] + [Circle(x, 8, id=f"falls{x}") for x in ("-11/2", "11/2")]
    return scene(discs, [Wall(0, 0, 1, 0, id="floor")], e)


def _image(name: str) -> str:
    kind, sign, place = name.partition("-")
    return kind + place if sign else name.replace("lies", "lies-").replace("falls", "falls-")


@pytest.mark.parametrize("e", ["1/2", "1/5", 1])
def test_mirror_images_meet_together_though_walls_have_carried_them(e: object) -> None:
    run = ExactEngine().run(mirrored(e), until=6)
    assert run.stop.reason is StopReason.HORIZON
    assert len(run.events) > 3
    for event in run.events:
        images = {tuple(sorted(_image(name) for name in pair)) for pair in event.impulses}
        assert images == {tuple(sorted(pair)) for pair in event.impulses}
    if e == 1:
        assert is_verified(run)


def test_a_flaw_in_the_mirror_image_is_seen() -> None:
    discs = [c if c.id != "falls11/2" else Circle("11/2 + 1/10**60", 8, id=c.id) for c in mirrored(1).circles]
    run = ExactEngine().run(mirrored(1).with_changes(circles=discs), until=6)
    assert len(run.events[0].impulses) * 2 == len(ExactEngine().run(mirrored(1), until=6).events[0].impulses)


# -- what falls straight onto the middle of something round


AXIS = [Circle(0, 9, id="ball"), Circle(0, 2, m="oo", id="peg")]


def test_what_falls_onto_the_middle_of_a_peg_has_closed_numbers() -> None:
    """1 later it bounces, and comes back after 2 more; a ball over a floor does the same, and one below a ceiling."""
    floor = Wall(0, 0, 1, 0, id="floor")
    run = ExactEngine().run(Scene([*AXIS, Circle(10, 6, id="other")], [floor], gravity=(0, -10)), until=20)
    assert [event.time.text() for event in run.events] == [str(n) for n in range(1, 20, 2)]
    assert all(len(event.impulses) == 2 for event in run.events)
    assert is_verified(run)
    grazed = Scene(AXIS, [Wall(0, 10, 1, 10, id="ceiling")], gravity=(0, -10))
    run = ExactEngine().run(grazed, until=20)
    assert [event.time.text() for event in run.events] == [str(n) for n in range(1, 20, 2)]
    assert is_verified(run)
    two = [Circle(0, "4 + 5*sqrt(2)", "1/2", id="a"), Circle(0, 4, "1/2", m="oo", id="p")]
    two += [Circle(6, "4 + 5*sqrt(2)", "1/4", id="b"), Circle(6, 4, "3/4", m="oo", id="q")]
    run = ExactEngine().run(Scene(two, gravity=(0, -10)), events=6)
    assert all(len(event.impulses) == 2 for event in run.events)


def test_from_below_and_aslant_they_are_closed_too() -> None:
    """A ball thrown up against the middle of a peg, and gravity along (3, 4)."""
    up = [Circle(0, 0, "1/2", vy=9, id="ball"), Circle(0, 3, "1/2", m="oo", id="peg")]
    first = ExactEngine().run(Scene(up, gravity=(0, -10)), events=1).events[0].time
    assert first.text() == "-1/10*sqrt(41) + 9/10"
    slant = [Circle(0, 0, id="ball"), Circle(6, 8, m="oo", id="peg")]
    first = ExactEngine().run(Scene(slant, gravity=(3, 4)), events=1).events[0].time
    assert first.text() == "4/5*sqrt(5)"


def test_a_disc_that_lies_is_struck_straight_at_restitution_1_again_and_again() -> None:
    run = ran([Circle(0, 1, id="low"), Circle(0, 8, id="x")], [Wall(0, 0, 1, 0, id="floor")], 1, 20)
    assert [event.time.text() for event in run.events] == [str(n) for n in range(1, 20, 2)]
    assert is_verified(run)


# -- what an attack found


@pytest.mark.parametrize("vx", [0, 1])
@pytest.mark.parametrize("kind", ["wall", "face"])
@pytest.mark.parametrize("e", ["1/2", 1])
def test_what_slides_under_a_ceiling_that_it_touches_is_pushed_against_that_too(vx: int, kind: str, e: object) -> None:
    """There is no room for it to move up: a push from below at an angle is taken against both, or has no end."""
    floor, ceiling = Wall(0, 0, 1, 0, id="floor"), Segment(-9, 2, 9, 2, id="ceiling")
    things = [floor, Wall(0, 2, 1, 2, id="ceiling") if kind == "wall" else ceiling]
    struck = [Circle(0, 1, vx=vx, id="a"), Circle(6, "1/2", "1/2", vx=-3, id="s")]
    run = ExactEngine(work=100_000).run(scene(struck, things, e), until=2)
    assert run.events or "may have no end" in run.stop.message
    assert all(("a", "ceiling") in map(tuple, event.contacts) for event in run.events)
    assert float(run.at(run.final_time)["a"].y) == 1
    out = ran([Circle(0, 1, vx=1, id="a"), Circle(9, "1/2", "1/2", vx=-3, id="s")],
              [floor, Segment(-9, 2, 1, 2, id="ceiling")], e, 2)  # fmt: skip
    assert [tuple(pair) for pair in out.events[0].contacts] == [("a", "s"), ("s", "floor")]


def test_times_that_were_proved_exactly_are_told_in_as_many_bits_as_they_need() -> None:
    """No bits are lost on the way of exact numbers, so that too few are tried first."""
    run = ran([Circle(0, "1/2", "1/2", id="p"), Circle(0, "1/2 + 19/3", "1/3", vy="-1/2", id="a")],
              [Wall(0, 0, 1, 0, id="floor")], "1/2", 9)  # fmt: skip
    assert run.events[0].time.digits(30)
    assert run.settlings
    assert run.at("3/2")["a"].y.digits(20)


def test_runs_in_corners_are_those_of_a_referee_of_their_own(monkeypatch: pytest.MonkeyPatch) -> None:
    """`python tests/settle_campaign.py --corners` has more; without the second wall it would find that at once."""
    counts = Counter[str]()
    assert [told for seed in range(20) if (told := examined(seed, counts, cornered))] == []
    assert counts["compared"] >= 15
    assert counts["settlings"] >= 8
    monkeypatch.setattr(endings, "held_between", lambda *_: False)
    assert any(examined(seed, Counter(), cornered) for seed in range(8))


def test_of_two_surfaces_on_one_line_one_carries() -> None:
    """What settled on both fell through them, by the fall of the frame once more."""
    box = Polygon([(-2, 0), (-2, -3), (2, -3), (2, 0)], id="box")
    run = ran([Circle(0, 6, id="d")], [Wall(0, 0, 1, 0, id="floor"), box], 0, 5)
    assert [(rest.circle, rest.wall) for rest in run.settlings] == [("d", "floor")]
    assert run.final["d"].y.text() == "1"
    two = [Wall(0, 0, 1, 0, id="floor"), Wall(2, 0, 3, 0, id="again")]
    run = ran([Circle(0, 6, id="d"), Circle(-6, 1, vx=1, id="b")], two, 0, 20)
    assert [tuple(event.contacts[0]) for event in run.events][1:] == [("d", "b")]
    assert is_verified(run)


BESIDE = {
    "a fixed circle": Circle("3/4", 2, "1/4", m="oo", id="peg"),
    "an end": Segment("3/5", "9/5", 5, 9, id="peg"),
    "a corner": Polygon([("3/5", "9/5"), (4, 3), (3, 4)], id="peg"),
}


@pytest.mark.parametrize("beside", BESIDE)
def test_what_lies_beside_something_round_is_pushed_against_that_too(beside: str) -> None:
    """As seen without gravity, of which nothing acts within an instant."""
    peg = BESIDE[beside]
    discs = [Circle(0, 1, id="b"), Circle(6, 1, vx=-2, id="e"), Circle(-2, 1, m=100, id="c")]
    discs += [peg] if isinstance(peg, Circle) else []
    things = [Wall(0, 0, 1, 0, id="floor"), *([] if isinstance(peg, Circle) else [peg])]
    run = ran(discs, things, "9/10", 3)
    assert ("b", "peg") in map(tuple, run.events[0].contacts)
    light = scene(discs, things, "9/10").with_changes(gravity=(0, 0), settle=False)
    free = ExactEngine().run(light, until=3)
    assert [list(map(tuple, run.events[0].contacts))] == [list(map(tuple, free.events[0].contacts))]
    assert run.events[0].impulses == free.events[0].impulses
    assert is_verified(run)


@pytest.mark.parametrize("more", [Wall(0, 0, -2, 2, id="again"), Wall(0, 0, 3, 3, id="again")], ids=["left", "right"])
def test_of_three_walls_the_first_two_that_hold_it_are_told(more: Wall) -> None:
    run = ran([Circle(0, "sqrt(2)", id="a")], [*SQUARE, more], 0, 5)
    assert rests(run) == [("a", "between left and right")]
    assert is_verified(run)


@pytest.mark.parametrize("pull", ["0", "1"])
def test_a_corner_beside_an_upright_wall_is_certified_on_its_own_side(pull: str) -> None:
    """Which side of the upright wall it is on says its normal, and not which way is down."""
    walls = [Wall(0, 0, 0, 1, id="up"), Wall(0, 0, 4, 3, id="slope")]
    law = {"gravity": (pull, -10), "restitution": 0, "settle": True}
    run = ExactEngine().run(Scene([Circle(1, 2, id="a")], walls, **law), until=5)  # pyright: ignore[reportArgumentType]
    assert rests(run) == [("a", "between up and slope")]
    assert run.final["a"].x.text() == "1"
    assert is_verified(run)


@pytest.mark.parametrize("short", [9, 30])
def test_a_limit_amid_infinitely_many_bounces_lists_those_before_it(short: int) -> None:
    # let fall from 6 it lands at 1 and is back 1, 1/2, 1/4, ... later: the hits are at 3 - 2**(1 - n)
    until = 3 - Fraction(1, 10**short)
    run = ExactEngine().run(scene([Circle(0, 6, id="ball")], [FLOOR], "1/2"), until=until)
    hits = [3 - Fraction(2, 2**n) for n in range(200)]
    assert [event.time.text() for event in run.events] == [str(time) for time in hits if time <= until]
    assert (run.stop.reason, run.settlings) == (StopReason.HORIZON, ())
    kept = ExactEngine().run(scene([Circle(0, 6, id="ball")], [FLOOR], "1/2"), until=3)
    assert [settling.time.text() for settling in kept.settlings] == ["3"]
    stops = scene([Circle(0, 6, id="ball")], [FLOOR], "1/2", settle=False)
    assert ExactEngine().run(stops, until=until).stop.reason is StopReason.HORIZON
    assert ExactEngine().run(stops, until=3).stop.reason is StopReason.ACCUMULATION


def test_at_a_hit_of_another_that_is_a_bounce_not_listed_both_leave() -> None:
    block = Polygon([("-5/2", 0), ("7/2", 0), ("7/2", -1), ("-5/2", -1)], id="block")
    twins = [Circle(x, 1, vy="1/2", id=name) for name, x in (("on", 0), ("end", "7/2"))]
    law = {"gravity": (0, -1), "restitution": "1/2", "settle": True}
    run = ExactEngine().run(Scene(twins, polygons=[block], **law), until=12)
    assert [tuple(pair) for pair in run.events[-1].contacts] == [("end", "block")]
    speeds = [run.final[name].vy.text() for name in ("on", "end")]
    assert speeds == [str(Fraction(1, 2 ** (len(run.events) + 1)))] * 2


def test_contacts_with_one_line_are_one_without_a_proof_in_roots() -> None:
    ledge = Segment(-3, 0, 3, 0, id="ledge")
    turned = Segment(3, 0, -3, 0, id="turned")
    for same in ([FLOOR, ledge], [turned, FLOOR], [ledge, FLOOR]):
        run = ExactEngine().run(scene([Circle(0, 1, "1/2", vx="1/2", vy=1, id="ball")], same, "1/2"), events=30)
        assert {len(event.contacts) for event in run.events} == {2}
        assert "tower" not in run.plan
        assert run.plan["symmetry"] > 50


def test_two_sides_of_one_line_are_not_one() -> None:
    ball, back = Circle(0, 3, 1, id="ball"), Segment(-3, 0, 3, 0, id="ledge")
    data = scene_data(Scene([ball], [FLOOR], segments=[back], gravity=(0, -10)).surfaces)
    lines = [data.line_of(AtWall(0, k)) for k in range(3)]
    assert sorted(lines.count(line) for line in lines) == [1, 2, 2]


@pytest.mark.parametrize(("start", "end", "events"), [(1, 90, 2), (1, 30, 1), (40, 90, 1)])
def test_what_falls_along_an_upright_face_passes_its_ends_and_leans_on_it_between_them(start, end, events) -> None:
    # it rises along x = 3/2 and is struck at 3, at a height of 63/2, towards the face, which it touches all along
    bar = Segment("1/2", start, "1/2", end, id="bar")
    ball = Circle("3/2", 0, vy=12, id="ball")
    side = Circle("19/2", 0, vx=-2, vy=12, id="side")
    run = ExactEngine().run(Scene([ball, side], segments=[bar], gravity=(0, -1)), until="7/2")
    (hit,) = run.events
    assert hit.time.text() == "3"
    assert len(hit.contacts) == events
    speeds = [run.final[name].vx.text() for name in ("ball", "side")]
    assert speeds == (["0", "2"] if events == 2 else ["-2", "0"])


@pytest.mark.parametrize("speed", ["0", "1"])
def test_what_falls_goes_from_what_lies_though_they_have_one_velocity(speed: str) -> None:
    # they touch side by side; one lies, the other falls by 1/2, and was pushed apart from it at its landing
    low = Circle(1, 1, 1, vx=speed, id="lies")
    fall = Circle("5/2", 1, "1/2", vx=speed, id="falls")
    law = {"gravity": (0, -1), "restitution": 1, "settle": True}
    run = ExactEngine().run(Scene([fall, low], [FLOOR], **law), until=6)
    assert [tuple(event.contacts[0]) for event in run.events] == [("falls", "floor")] * 3
    assert [event.time.text() for event in run.events] == ["1", "3", "5"]
    assert run.final["falls"].vx.text() == speed


def test_between_a_wall_and_the_line_of_a_face_beyond_its_ends_nothing_is_crushed() -> None:
    top, ball = Wall(0, 6, 1, 6, id="top"), Circle(0, 1, vy=1, id="ball")
    beside = Segment(-4, 0, "-7/2", 0, vy=1, id="face")
    run = ExactEngine().run(Scene([ball], [top], segments=[beside]), until=6)
    assert (run.stop.reason, [event.time.text() for event in run.events]) == (StopReason.HORIZON, ["4"])
    below = Segment(-4, 0, 4, 0, vy=1, id="face")
    assert ExactEngine().run(Scene([ball], [top], segments=[below]), until=6).stop.reason is StopReason.CRUSHED


def test_what_parts_by_a_fourfold_zero_has_no_certificate_and_says_so() -> None:
    peg, ball = Circle(0, 0, 1, m="oo", id="peg"), Circle(2, 0, 1, id="ball")
    run = ExactEngine().run(Scene([ball, peg], gravity=(0, -1)), until=1)
    with pytest.raises(CertificateError, match="fourth fold"):
        certificate_of(run)
    faster = ExactEngine().run(Scene([replace(ball, vy=1), peg], gravity=(0, -1)), until=1)
    assert is_verified(faster)


def test_what_lies_beside_something_round_touches_it_on_while_others_bounce() -> None:
    peg, lies = Circle(2, 1, m="oo", id="peg"), Circle(0, 1, id="lies")
    other, blow = Circle(9, 2, id="other"), Circle(-6, 1, vx=1, id="blow")
    run = ExactEngine().run(scene([peg, lies, other, blow], [FLOOR], "1/2"), until=5)
    hit = run.events[-1]
    assert hit.time.text() == "4"
    assert {frozenset(pair) for pair in hit.contacts} >= {frozenset(("lies", "blow")), frozenset(("lies", "peg"))}
    assert len(run.events) > 5


@pytest.mark.parametrize("v", [-1, 0, 1])
@pytest.mark.parametrize("corner", [False, True])
@pytest.mark.parametrize(
    ("u", "n"), [((1, 0), (0, -1)), (("3/5", "4/5"), ("4/5", "-3/5")), (("-4/5", "3/5"), ("-3/5", "-4/5"))]
)
def test_what_hangs_below_an_end_falls_off_it(u: tuple[Any, Any], n: tuple[Any, Any], corner: bool, v: int) -> None:
    """It touches the end, from which a face begins, and gravity pulls it away from both: all of it ended undecided."""
    (ux, uy), (nx, ny) = ([Quantity.of(part) for part in each] for each in (u, n))
    ball = Circle(nx, ny, 1, vx=ux * v, vy=uy * v, id="ball")
    far = [(ux * 2, uy * 2), (ux * 2 - nx, uy * 2 - ny), (-nx, -ny)]
    bar = {"polygons": [Polygon([(0, 0), *far])]} if corner else {"segments": [Segment(0, 0, ux * 2, uy * 2)]}
    floor = Wall(-9, -8, 9, -8, id="floor")
    run, alone = (ExactEngine().run(Scene([ball], [floor], gravity=(0, -2), **things), until=4) for things in (bar, {}))
    assert run.stop.reason is StopReason.HORIZON
    assert [event.time.text() for event in run.events[:1]] == [event.time.text() for event in alone.events[:1]]
    assert len(run.events) > 0
    held = ExactEngine().run(Scene([ball], gravity=(0, 2), **bar), until=1)  # it is pressed onto the face
    along = ExactEngine().run(Scene([ball], gravity=(ux * 2, uy * 2), **bar), until=1)  # it may go along the face
    assert held.stop.reason is along.stop.reason is StopReason.UNDECIDED
