"""Scenes on which the engine once was wrong, crashed, hung or gave up, with the answers worked out by hand."""

from __future__ import annotations

import pytest
from flint import arb  # type: ignore[attr-defined]

from fuzz.check import GAVE_UP, check
from fuzz.draft import F
from fuzz.referee import referee
from truebreak.exact import ExactEngine
from truebreak.scenarios import Circle, Pocket, Scene, Trajectory, Wall

pytestmark = pytest.mark.timeout(120)


def played(scene: Scene, until=None, events: int | None = None) -> Trajectory:
    """The run, held against the referee as well."""
    check(scene, until, events)
    return ExactEngine().run(scene, until=until, events=events)


def told(run: Trajectory) -> list[tuple[float, list[tuple[str, str]]]]:
    """Time and contacts of the events."""
    return [(float(event.time), [tuple(contact) for contact in event.contacts]) for event in run.events]


def entries(run: Trajectory) -> list[tuple[str, str, float]]:
    """Circle, pocket and time of the entries."""
    return [(p.circle, p.pocket, float(p.time)) for p in run.pocketings]


def motion(run: Trajectory, name: str) -> tuple[float, ...]:
    """x, y, vx, vy at the end, as doubles."""
    circle = run.final[name]
    return tuple(float(value) for value in (circle.x, circle.y, circle.vx, circle.vy))


def stop(run: Trajectory) -> tuple[str, float]:
    """The reason to stop, and when."""
    return run.stop.reason.name, float(run.final_time)


# -- it ends, and does not crash


def test_progress_may_be_asked_where_times_are_rational():
    """Two equal masses on a line hand on their speeds, 3 and 2, for ever."""
    scene = Scene(
        [Circle(0, 0, vx=3, id="a"), Circle(4, 0, vx=-2, id="b")],
        [Wall(-2, 0, -2, 1, id="L"), Wall(20, 0, 20, 1, id="R")],
    )
    heard = []
    run = ExactEngine().run(scene, events=20_000, progress=heard.append)
    assert len(run.events) == 20_000
    assert sorted(abs(float(circle.vx)) for circle in run.final.circles) == [2, 3]
    assert all(isinstance(word.time, float) for word in heard)


def test_two_pockets_at_one_instant():
    """Both rims cross y = 0 at x = 6."""
    pockets = [Pocket(10, 3, 5, id="p"), Pocket(10, -3, 5, id="q")]
    run = played(Scene([Circle(0, 0, vx=1, id="a")], pockets=pockets))
    assert entries(run) == [("a", "p", 6), ("a", "q", 6)]
    assert stop(run) == ("QUIET", 6)


def test_a_tilted_floor_is_as_good_as_a_flat_one():
    def floor(c: F, s: F) -> Scene:
        def turn(x, y):
            return c * x - s * y, s * x + c * y

        def disc(x, v, m):
            return Circle(*turn(x, 0), 1, *turn(v, 0), m)

        discs = [disc(0, F(3, 7), 3), disc(4, -F(5, 11), 7), disc(9, F(2, 13), 11), disc(13, -1, F(5, 3))]
        lines = [(-2, 0, -2, 1), (20, 0, 20, 1), (0, -1, 1, -1)]
        return Scene(discs, [Wall(*turn(a, b), *turn(p, q)) for a, b, p, q in lines])

    flat, tilted = (ExactEngine().run(floor(*turn), events=500) for turn in ((F(1), F(0)), (F(3, 5), F(4, 5))))
    assert len(flat.events) == len(tilted.events) == 500
    for one, other in zip(flat.events, tilted.events, strict=True):
        assert one.contacts == other.contacts
        assert abs(one.time.ball(200) - other.time.ball(200)) < arb((1, -100))


def test_a_column_between_two_walls_is_struck():
    """The walls leave the column no room, so the blow runs up and down in it without end."""
    circles = [Circle(-6, -2, 2, vx=2), Circle(-6, -5, 1, vx=2, m=2), Circle(2, -4, 1, vy=1)]
    scene = Scene(circles, [Wall(0, -6, 1, -6), Wall(0, 0, 1, 0)])
    assert referee(scene, events=2).stop == "ENDLESS"
    run = played(scene, events=2)
    assert run.stop.reason.name in GAVE_UP
    assert not run.events


# -- limits, ends and reversals


def test_the_reversal_may_make_the_last_event_that_is_asked_for():
    """a leaves L at 1, is sent back into it at once, and that is the second event."""
    walls = [Wall(-2, 0, -2, 1, id="L"), Wall(2, 0, 2, 1, id="R")]
    run = played(Scene([Circle(0, 0, vx=-1, id="a")], walls, reverse_after=1), events=2)
    assert told(run) == [(1, [("a", "L")]), (1, [("a", "L")])]
    assert stop(run) == ("EVENTS", 1)
    assert run.reversal.after == 1


def test_an_event_that_is_the_last_leaves_the_reversal_out():
    walls = [Wall(-2, 0, -2, 1, id="L"), Wall(2, 0, 2, 1, id="R")]
    run = played(Scene([Circle(0, 0, vx=-1, id="a")], walls, reverse_after=1), events=1)
    assert stop(run) == ("EVENTS", 1)
    assert run.reversal is None
    assert motion(run, "a")[2] == 1


def test_a_quiet_run_ends_with_its_reversal():
    run = played(Scene([Circle(0, 0, vx=1, id="a")], reverse_at=2), events=5)
    assert stop(run) == ("QUIET", 2)
    assert motion(run, "a") == (2, 0, -1, 0)


def test_a_quiet_run_ends_with_its_last_entry():
    run = played(Scene([Circle(0, 0, vx=1, id="a")], pockets=[Pocket(4, 0, 2, id="p")], capture=True))
    assert stop(run) == ("QUIET", 2)
    assert motion(run, "a") == (2, 0, 0, 0)


def test_home_through_a_corner_at_the_reversal():
    """At 3 in the corner, turned back into it, out again, at 6 where it began."""
    walls = [Wall(0, 0, 0, 1, id="L"), Wall(0, 0, 1, 0, id="B")]
    ball = Circle(4, 4, vx=-1, vy=-1, id="a")
    run = played(Scene([ball], walls, tie_policy="sequential:order=scene", reverse_at=3))
    assert told(run) == [(3, [("a", "L"), ("a", "B")])] * 2
    assert motion(run, "a") == (4, 4, 1, 1)
    assert run.notes[0].startswith("came back")


def test_the_return_ends_with_what_happens_at_its_last_instant():
    """a and b part at once, turn at 5/2, and meet at 5, the end."""
    circles = [Circle(7, 0, vx=-1, id="a"), Circle(9, 0, vx=1, id="b")]
    for until in (None, 5):
        run = played(Scene(circles, reverse_at="5/2"), until)
        assert told(run) == [(5, [("a", "b")])]
        assert stop(run) == ("HORIZON", 5)
        assert [motion(run, name)[2] for name in "ab"] == [-1, 1]


# -- entries at and beside contacts


def test_a_blow_sends_a_centre_in_that_stands_on_the_rim():
    """b of half the mass at speed 1 leaves a with 2/3."""
    circles = [Circle(-4, 0, vx=1, m="1/2", id="b"), Circle(0, 0, id="a")]
    run = played(Scene(circles, pockets=[Pocket(2, 0, 2, id="p")]))
    assert entries(run) == [("a", "p", 2)]
    assert motion(run, "a")[2] == pytest.approx(2 / 3)


def test_an_entry_at_time_zero():
    run = played(Scene([Circle(0, 0, vx=1, id="a")], pockets=[Pocket(2, 0, 2, id="p")]))
    assert entries(run) == [("a", "p", 0)]
    assert stop(run) == ("QUIET", 0)


def test_points_pass_through_each_other():
    circles = [Circle(-4, 3, 0, 1, -1, point=True), Circle(-4, -3, 0, 1, 1, point=True)]
    for x in (-8, -3, 2, 7):
        circles += [Circle(x, 6, "3/2", m="oo"), Circle(x, -6, "3/2", m="oo")]
    walls = [Wall("-19/2", 0, "-19/2", 1), Wall(9, 0, 9, 1), Wall(0, 9, 1, 9), Wall(0, -9, 1, -9)]
    run = ExactEngine().run(Scene(circles, walls), events=40)
    assert (run.stop.reason.name, len(run.events)) == ("EVENTS", 40)
    played(Scene(circles, walls), events=15)


@pytest.mark.parametrize("pockets", [(), (Pocket("4 + 10**-20", 50, 2, id="p"),)], ids=["bare", "pocket"])
def test_an_entry_just_after_hides_no_contact(pockets):
    """a hits the wall at 2 exactly; b would enter 10**-20 later."""
    circles = [Circle(0, 0, vx=-1, id="a"), Circle(0, 50, vx=1, id="b")]
    walls = [Wall(-3, 0, -3, 1, id="w")]
    assert told(played(Scene(circles, walls, pockets=pockets), until=2)) == [(2, [("a", "w")])]
    run = played(Scene(circles, walls, pockets=pockets, reverse_at=2), until=3)
    assert told(run) == [(2, [("a", "w")])] * 2
    assert not run.pocketings


def test_entries_come_in_order_of_time():
    circles = [Circle(0, 0, vx=1, id="a"), Circle(0, 50, vx=1, id="b")]
    pockets = [Pocket(4, 0, 2, id="pa"), Pocket("4 - 10**-20", 50, 2, id="pb")]
    run = played(Scene(circles, pockets=pockets), until=5)
    assert [p.circle for p in run.pocketings] == ["b", "a"]


def test_what_was_captured_does_not_come_back():
    circles = [Circle(0, 0, vx=1, id="a"), Circle(0, 50, vx=1, id="b")]
    run = played(Scene(circles, pockets=[Pocket(4, 0, 2, id="p")], capture=True, reverse_at=5))
    assert motion(run, "a") == (2, 0, 0, 0)
    assert motion(run, "b") == (0, 50, -1, 0)
    assert not any(note.startswith("came back") for note in run.notes)


def test_all_turn_back_before_the_entry():
    """The bounce at 2 turns all around; a is sent into the wall once more at once, b never gets to its pocket."""
    circles = [Circle(0, 0, vx=-1, id="a"), Circle(0, 50, vx=1, id="b")]
    pockets = [Pocket("4 + 10**-20", 50, 2, id="p")]
    scene = Scene(circles, [Wall(-3, 0, -3, 1, id="w")], pockets=pockets, capture=True, reverse_after=1)
    run = played(scene, until=4)
    assert told(run) == [(2, [("a", "w")])] * 2
    assert not run.pocketings
    assert motion(run, "a") == (0, 0, 1, 0)
    assert motion(run, "b") == (0, 50, -1, 0)


@pytest.mark.parametrize("power", [20, 100])
def test_an_entry_just_before_a_contact_is_no_tie(power):
    """The pair drives b along y = 0; its centre is in the pocket at 19 - 10**-power and at the wall at 19."""
    circles = [Circle(-6, 3, vx=1, vy="-1/3", id="u"), Circle(-6, -3, vx=1, vy="1/3", id="d"), Circle(0, 0, id="b")]
    pockets = [Pocket(f"23 - 10**-{power}", 3, 5, id="p")]
    run = played(Scene(circles, [Wall(20, 0, 20, 1, id="w")], pockets=pockets), events=3)
    assert told(run)[0][1] == [("u", "b"), ("d", "b")]
    [entry] = run.pocketings
    [bounce] = [event for event in run.events if ("b", "w") in [tuple(contact) for contact in event.contacts]]
    assert entry.circle == "b"
    late = bounce.time.ball(600) - entry.time.ball(600)
    assert 0 < late < arb(10) ** (1 - power)


def test_no_entry_behind_a_wall():
    circles = [Circle(-6, 3, vx=1, vy="-1/3", id="u"), Circle(-6, -3, vx=1, vy="1/3", id="d"), Circle(0, 0, id="b")]
    circles.append(Circle(-2, 60, vx=1, id="z"))
    pockets = [Pocket(10, "5 - 10**-100", 5, id="p")]
    run = played(Scene(circles, [Wall(9, 0, 9, 1, id="w")], pockets=pockets, capture=True), until=30)
    assert not run.pocketings
    assert motion(run, "b")[0] <= 8


@pytest.mark.parametrize("capture", [True, False])
def test_a_touching_partner_is_pressed_aside_before_its_entry(capture):
    """At 4 b's bounce leaves a with (7/25, -24/25), so a is in 25/7 * 10**-20 later, not 10**-20."""
    circles = [Circle(0, 0, vx=1, id="a"), Circle("6/5", "8/5", vx=1, id="b")]
    pockets = [Pocket("5 + 10**-20", 0, 1, id="p")]
    run = played(Scene(circles, [Wall("31/5", 0, "31/5", 1, id="w")], pockets=pockets, capture=capture), until=6)
    assert told(run)[0] == (4, [("a", "b"), ("b", "w")])
    [entry] = run.pocketings
    late = (entry.time.ball(400) - 4) * arb(10) ** 20
    assert float(late) == pytest.approx(25 / 7)
    if capture:
        assert motion(run, "a")[2:] == (0, 0)
    else:
        assert motion(run, "b")[2:] == pytest.approx((-7 / 25, 24 / 25))


def test_two_entries_just_before_a_contact():
    pockets = [Pocket(10, 3, 5, id="p"), Pocket(10, -3, 5, id="q")]
    walls = [Wall("7 + 10**-20", 0, "7 + 10**-20", 1, id="w")]
    run = played(Scene([Circle(0, 0, vx=1, id="a")], walls, pockets=pockets), events=1)
    assert entries(run) == [("a", "p", 6), ("a", "q", 6)]


# -- grazes at blows


@pytest.mark.parametrize("policy", ["simultaneous", "sequential:order=scene"])
def test_who_grazes_at_the_blow_takes_part(policy):
    """a gives b (3/5, 4/5). Then b presses on k above with 4/5 and on c at (15/17, 8/17) with 77/85.

    Together: u = (-4/5, -77/85) and G = ((2, 8/17), (8/17, 2)). In order: (b, k) takes 4/5, then (b, c) 9/17.
    """
    a, b, k = Circle("-21/5", "-28/5", vx="3/5", vy="4/5", id="a"), Circle(0, 0, id="b"), Circle(-5, 2, vx=1, id="k")
    scene = Scene([a, b, k, Circle("30/17", "16/17", id="c")], tie_policy=policy)
    run = played(scene, events=1)
    contacts = {("a", "b"), ("b", "c"), ("b", "k")}
    assert {tuple(contact) for contact in run.events[0].contacts} == contacts
    g, one, two = F(8, 17), F(4, 5), F(77, 85)
    together = (2 * (2 * one - g * two) / (4 - g * g), 2 * (2 * two - g * one) / (4 - g * g))
    up, on = together if policy == "simultaneous" else (one, two - g * one)
    assert motion(run, "k")[2:] == pytest.approx((1, float(up)))
    assert motion(run, "c")[2:] == pytest.approx((float(on * F(15, 17)), float(on * F(8, 17))))


def test_who_arrives_at_a_graze_by_a_reversal_takes_part():
    circles = [Circle(6, 2, 2, vx=-1, id="c0"), Circle(0, 0, 2, vx=-1, m="1/2", id="c1")]
    walls = [Wall(0, -2, 1, -2, id="B"), Wall(0, 4, 1, 4, id="T")]
    walls += [Wall(-2, 0, -2, 1, id="L"), Wall(10, 0, 10, 1, id="R")]
    run = played(Scene(circles, walls, tie_policy="sequential:order=scene", reverse_at=3), until=6)
    assert len(run.events[6].impulses) == 4


# -- without a field, all is in balls from the start

FAR = Circle("1/2", "5000 + sqrt(2 + sqrt(3 + sqrt(5 + sqrt(7 + sqrt(11)))))", m="oo", id="far")
"""Its number is too deep for a field."""


def test_a_contact_at_time_0_needs_no_hit_time():
    """The hit time of two that touch at time 0 is a ball around zero, which no number of bits makes sharp."""
    scene = Scene([Circle(0, 0, "2/5", vy="-2/3", id="a"), Circle(0, "-7/5", m="oo", id="b"), FAR])
    run = played(scene, until=3)
    assert told(run) == [(0, [("a", "b")])]
    assert run.final["a"].vy.text() == "2/3"


def test_a_centre_stopped_on_a_rim_does_not_enter():
    """`struck` is hit and stopped at the rim of p where it stands, in balls: its speed is zero, and not known to be."""
    half = F(1, 2)
    circles = [Circle(3, 2, half, m="oo"), Circle(2, 1, half), Circle(1, 1, half, m=3)]
    circles += [Circle(3, 4, half, -1, 1, m=3), FAR, Circle(2, 2, half, id="struck")]
    walls = [Wall(0, -1, 1, -1), Wall(-1, 0, -1, 1), Wall(0, 6, 1, 6), Wall(6, 0, 6, 1)]
    run = played(Scene(circles, walls, pockets=[Pocket(2, -1, 1), Pocket(3, 2, 1, id="p")]), events=6)
    assert [float(event.time) for event in run.events] == [1.5, 3.5, 5, 6.5, 8, 9.5]
    assert entries(run) == []
