"""What comes amid infinitely many bounces, and where all are as these end."""

from __future__ import annotations

from collections import Counter

import pytest
from settle_campaign import bouncing, differs
from test_settling import ran, told

from truebreak.compare.files.saved import run_of, saved_run
from truebreak.exact import ExactEngine
from truebreak.exact.simulation import endings
from truebreak.floating import DoubleEngine
from truebreak.scenarios import Circle, Engine, Quantity, Scene, Segment, Wall
from truebreak.scenarios.trajectory import StopReason

FLOOR = Wall(0, 0, 1, 0, id="floor")
DOWN = (0, -10)


@pytest.mark.parametrize("until", [None, 50])
def test_where_it_is_as_its_bounces_end(until: object) -> None:
    """It slides on with speed 1 all the time, from x = 0: then it is where the clock stands."""
    scene = Scene([Circle(0, 3, vx=1, id="a")], [FLOOR], gravity=(0, -2), restitution="1/2", settle=True)
    run = ExactEngine().run(scene, until=until)  # pyright: ignore[reportArgumentType]
    end = run.settlings[0].time
    assert [value.text() for value in run.motion.circle(0, end)] == ["3*sqrt(2)", "1", "1", "0"]
    back = run_of(saved_run(run))
    assert [value.text() for value in back.motion.circle(0, back.settlings[0].time)] == ["3*sqrt(2)", "1", "1", "0"]


@pytest.mark.parametrize("seed", [12, 14, 17, 22])
def test_ends_of_bounces_are_told_apart(seed: int) -> None:
    """Discs are struck again and come to rest a second time: each time all are where they are a little later."""
    scene = bouncing(seed)
    assert scene is not None
    run = ExactEngine().run(scene, until=20, events=80)
    ends = [(settling.circle, settling.time) for settling in run.settlings if settling.since is not None]
    assert max(Counter(circle for circle, _ in ends).values()) == 2
    for _, time in ends:
        now, later = run.motion.state(time), run.motion.state(Quantity.of(float(time) * (1 + 2.0**-40)))
        for row, other in zip(now, later, strict=True):
            assert [float(value) for value in row] == pytest.approx([float(value) for value in other], abs=1e-9)


@pytest.mark.parametrize("engine", [ExactEngine(), DoubleEngine()], ids=lambda engine: engine.name)
def test_a_run_that_is_cut_short_keeps_where_its_last_bounces_leave_a_disc(engine: Engine) -> None:
    """Another disc falls on it, and the two push each other and the floor without end."""
    discs = [Circle(0, 1, "1/2", vx=1, id="a"), Circle("12/5", 20, "1/2", id="b")]
    run = engine.run(Scene(discs, [FLOOR], gravity=(0, -10), restitution="1/10", settle=True), until=20)
    assert run.stop.reason in (StopReason.UNDECIDED, StopReason.BUDGET)
    assert len(run.events) == 8
    time = float(run.final_time)
    speed = 10**0.5 / 10**8  # by a tenth less after each of eight bounces
    there = [float(value) for value in run.motion.state(run.final_time)[0]]
    assert there == pytest.approx([time, 0.5, 1.0, speed], rel=1e-9)


AMID = {
    "a peg in its way": ([Circle(0, 6, vx=3, id="ball"), Circle("41/5", "8/5", "1/2", fixed=True, id="that")], []),
    "a low peg in its way": ([Circle(0, 6, vx=3, id="ball"), Circle(8, "1/4", "1/4", fixed=True, id="that")], []),
    "a disc that lies in its way": ([Circle(0, 6, vx=3, id="ball"), Circle(8, "1/4", "1/4", id="that")], []),
    "a wall in its way": ([Circle(0, 6, vx=3, id="ball")], [Wall("33/4", 0, "33/4", 1, "that")]),
    "a tilted wall in its way": ([Circle(0, 6, vx=3, id="ball")], [Wall(8, 0, 9, 3, "that")]),
    "a still disc that another pushes into it": (
        [Circle(0, 6, id="ball"), Circle("201/100", 1, id="that"), Circle("12551/100", 1, vx=-100, id="fast")],
        [],
    ),
    "a disc that falls on it": ([Circle(0, 6, id="ball"), Circle("1/2", 9, vy=8, id="that")], []),
    "one that bounces beside it": (
        [Circle(0, 6, id="ball"), Circle("35/16", "61/25", "1/4", vx="-1/2", id="that")],
        [],
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", AMID)
def test_what_comes_amid_the_bounces_is_met(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing is proved there, though the speed of the bounces would long do for a wall to carry the disc."""
    monkeypatch.setattr(endings, "SHRUNK", 0.1)
    circles, walls = AMID[name]
    e, first, end = ("1/2", 2, 3) if "pushes" not in name else ("1/10", 1.2, 1.2 + 0.2 / 9)
    run = ran([*circles, Circle(-99, 9, id="far")], *walls, e=e, until=4)
    times = {tuple(event.contacts[0]): float(event.time) for event in run.events[::-1]}
    assert first < next(times[link] for link in times if {*link} == {"ball", "that"}) < end
    assert any(rest.since is not None for rest in run.settlings)
    assert differs(run, run.scene) == ""


def test_a_face_amid_the_bounces_is_met(monkeypatch: pytest.MonkeyPatch) -> None:
    """The ends of it are too far to be met; what it pushes leaves the end of the bounces as it is."""
    monkeypatch.setattr(endings, "SHRUNK", 0.1)
    upright = Segment("463/100", "1/100", "463/100", 9, id="upright")
    scene = Scene([Circle(0, 6, vx=3, id="ball")], [FLOOR], segments=[upright], gravity=DOWN, restitution="1/10",
                  settle=True)  # fmt: skip
    run = ExactEngine().run(scene, until=4)
    assert ("121/100", [("ball", "upright")]) in told(run)
    assert [rest.time.text() for rest in run.settlings] == ["11/9"]
    assert run.at("1215/1000")["ball"].y.text() == "8003/8000"


def test_rests_that_are_not_told_apart_are_told() -> None:
    """Both discs have met a peg, at zeros of quartics: that the one rests as the other does is not decided."""
    sides = (-1, 1)
    discs = [Circle(f"{side}*(5 + 1/3)", 6, "1/2", id=f"ball{side}") for side in sides]
    pegs = [Circle(5 * side, 3, "1/2", fixed=True, id=f"peg{side}") for side in sides]
    run = ran([*discs, *pegs], e="1/10")
    one, other = run.settlings
    assert run.stop.reason is StopReason.QUIET
    assert {one.circle, other.circle} == {"ball-1", "ball1"}
    assert float(one.time) == float(other.time) == float(run.final_time)
    with pytest.raises(ValueError, match="is not known"):
        run.motion._after(one.time, other.time)  # type: ignore[attr-defined]


@pytest.mark.parametrize("engine", [ExactEngine(), DoubleEngine()], ids=["exact", "double"])
def test_a_run_that_ends_amid_bounces_says_which_are_not_listed(engine: Engine) -> None:
    """A disc bounces on a floor until 3, at 3 - 2 / 2**k; another comes to a wall after the bounce of k = 21."""
    discs = [Circle(0, 6, id="a"), Circle("20 - 2.9999995", 100, vx=1, id="b")]
    walls = [Wall(0, 0, 1, 0, id="floor"), Wall(21, 1, 21, 0, id="side")]
    scene = Scene(discs, walls, gravity=(0, -10), restitution="1/2", settle=True)
    run = engine.run(scene, events=22)
    assert float(run.final_time) == pytest.approx(2.9999995, abs=1e-12)
    assert not run.settlings
    last = max(float(event.time) for event in run.events if "floor" in event.impulses[0])
    assert f"a bounces infinitely often on floor until time 3; no bounce of it after time {last:.9g}" in run.notes[0]
    whole = engine.run(scene, until="2.99999951")
    assert len(whole.events) == 23
    assert not whole.notes
    assert engine.run(scene, until=4).notes == ()
