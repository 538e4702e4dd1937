"""Restitution below 1: against a referee in plain coordinates, its laws, and faults that must be found."""

from __future__ import annotations

from fractions import Fraction as F
from itertools import pairwise
from random import Random

import pytest
from mpmath import mpf, workdps
from segment_referee import Referee
from segment_scenes import BOX
from segment_scenes import scene_of as with_segments

from truebreak.compare.orders.all_orders import all_orders
from truebreak.compare.report.search_text import print_orders
from truebreak.exact import ExactEngine
from truebreak.exact.literal.symbolic_engine import SymbolicEngine
from truebreak.exact.replay.ball_state import BallState
from truebreak.exact.replay.state import Flights, ReplayState
from truebreak.floating import (
    DoubleEngine,
    IntervalEngine,
    PymunkEngine,
    QuadEngine,
    RoundedEngine,
    SingleEngine,
)
from truebreak.scenarios import Circle, Quantity, Scene, SceneError, Wall
from truebreak.scenarios.files import dump_toml, loads_toml
from truebreak.scenarios.trajectory import StopReason

LOSSES = ("9/10", "1/2", "99/100", "1/7", "1/20", "sqrt(2)/2", "1 - 1/10**9", "3/4")
UNTIL, EVENTS = 30, 14


def row_of(rng: Random) -> Scene:
    """Discs on one line, some of which touch, at speeds that bring several together at one instant."""
    count, x, discs = rng.randint(2, 4), Quantity.of(-6), []
    for k in range(count):
        r = Quantity.of(rng.choice(("1/2", "1", "1/3")))
        x = x + r + (0 if k and rng.random() < 0.3 else Quantity.of(rng.choice(("1", "1/2"))))
        vx = rng.choice((0, 0, 1, -1, 2)) if k else 2
        discs.append(Circle(x, 0, r=r, vx=vx, m=rng.choice(("1", "1", "2", "1/3")), id=f"c{k}"))
        x = x + r
    return Scene(discs, BOX if rng.random() < 0.7 else [])


def room_of(rng: Random) -> Scene:
    """Discs off any grid, between walls of which some are oblique, some of them fixed."""
    discs = [
        Circle(
            3 * (k % 3) - 3 + Quantity.of(f"{rng.randint(-40, 40)}/97"),
            3 * (k // 3) - 3 + Quantity.of(f"{rng.randint(-40, 40)}/89"),
            r=f"{rng.randint(40, 100)}/101",
            m=rng.choice(("1", "2", "1/3")),
            vx=f"{rng.randint(-90, 90)}/31",
            vy=f"{rng.randint(-90, 90)}/37",
            id=f"c{k}",
        )
        for k in range(rng.randint(1, 5))
    ]
    if len(discs) > 3:
        discs[1] = Circle(0, -3, r="1/2", m="oo", id="c1")
    walls = [Wall(-9, -8, 9, -7, id="bottom"), *BOX[1:]] if rng.random() < 0.5 else BOX
    return Scene(discs, walls)


def scene_of(seed: int) -> Scene | None:
    """The scene of a seed; None where what it draws is refused."""
    rng = Random(f"restitution {seed}")
    try:
        scene = (row_of, room_of, lambda _: with_segments(seed))[seed % 3](rng)
        return scene and scene.with_changes(restitution=rng.choice(LOSSES))
    except SceneError:
        return None


def differs(scene: Scene, events: int = EVENTS) -> str:
    """How the exact engine and the referee part; empty where they agree."""
    run = ExactEngine().run(scene, until=UNTIL, events=events)
    told = Referee(scene).run(mpf(UNTIL), events)
    for mine, theirs in zip(told.events, run.events, strict=False):
        if abs(mpf(theirs.time.digits(80)) - mine.time) > mpf(10) ** -45:
            return f"event {theirs.index} at {float(theirs.time)}, not {float(mine.time)}"
        names = {tuple(pair) for pair in theirs.contacts}
        if not mine.approaching <= names <= mine.touching:
            return f"event {theirs.index}: {names}, not {mine.approaching}"
    if "collapse" in run.stop.message:  # the referee, whose numbers end, is through with it after many rounds
        return "" if told.events[len(run.events)].rounds > 20 else "no collapse"
    if run.stop.reason is StopReason.ACCUMULATION:  # the referee goes on, ever nearer to where they end
        end, more = mpf(run.ending.digits(60)), Referee(scene).run(mpf(UNTIL), len(run.events) + 20).events
        left = [end - each.time for each in (more[len(run.events) - 1], more[-1])]
        return "" if 0 < left[1] < left[0] / 100 else f"{left} before the end"
    if len(told.events) != len(run.events):
        return f"{len(run.events)} events, not {len(told.events)}: {run.stop.message}"
    if "no normal" in run.stop.message or told.blunt is not None:
        return "" if "no normal" in run.stop.message and told.blunt is not None else "a corner"
    if not run.certified:
        return run.stop.message
    for circle, disc in zip(run.final.circles, told.discs, strict=True):
        pairs = zip((circle.x, circle.y, circle.vx, circle.vy), (disc.x, disc.y, disc.vx, disc.vy), strict=True)
        if any(abs(mpf(a.digits(70)) - b) > mpf(10) ** -40 for a, b in pairs):
            return f"{circle.id} ends elsewhere"
    return ""


SEEDS = range(150)


def test_scenes_agree_with_the_referee():
    scenes = [(seed, scene) for seed in SEEDS if (scene := scene_of(seed)) is not None]
    assert len(scenes) > 100
    assert {seed: told for seed, scene in scenes if (told := differs(scene))} == {}


# -- Faults that the comparison must find.


def _whole_impulse(monkeypatch):
    """2 for 1 + e."""
    monkeypatch.setattr(Scene, "elastic", property(lambda _: True))


def _share(change):
    """Another share of the elastic impulse, wherever a state is made."""

    def spoil(monkeypatch):
        known = Flights.__init__

        def made(self, scene, numbers, only=None):
            known(self, scene, numbers, only)
            if not scene.elastic:
                self.share = numbers.constant(change(scene.restitution))

        monkeypatch.setattr(Flights, "__init__", made)

    return spoil


def _pairs_whole(monkeypatch):
    """Pairs lose nothing where their meeting tells the impulse."""
    known = BallState._bounce_first

    def whole(self, *told):
        share, self.share = self.share, None
        known(self, *told)
        self.share = share

    monkeypatch.setattr(BallState, "_bounce_first", whole)


def _walls_whole(monkeypatch):
    monkeypatch.setattr(BallState, "damping", lambda self, change: change)


def _together_whole(monkeypatch):
    known = ReplayState._kick_together

    def whole(self, links):
        share, self.share = self.share, None
        known(self, links)
        self.share = share

    monkeypatch.setattr(ReplayState, "_kick_together", whole)


FAULTS = {
    "2 for 1 + e": _whole_impulse,
    "e on the wrong side": _share(lambda e: (1 - e) / 2),
    "e squared": _share(lambda e: (1 + e * e) / 2),
    "e off by a billionth": _share(lambda e: (1 + e * (1 - Quantity.of("1/10**9"))) / 2),
    "pairs lose nothing": _pairs_whole,
    "walls and lone pairs lose nothing": _walls_whole,
    "several contacts lose nothing": _together_whole,
}


@pytest.mark.parametrize("fault", FAULTS)
def test_planted_faults_are_found(fault, monkeypatch):
    FAULTS[fault](monkeypatch)
    for seed in SEEDS:
        scene = scene_of(seed)
        if scene is None:
            continue
        try:
            told = differs(scene)
        except (AssertionError, KeyError, IndexError, ValueError):
            told = "it fell"
        if told:
            return
    raise AssertionError(f"nothing finds {fault}")


# -- Every engine.


def pushed_row(e="9/10", **values) -> Scene:
    """Three discs with gaps, off the axes."""
    discs = [Circle(3 * k, f"{k}/9", vx=1 if k == 0 else 0, m=k + 1, id=f"c{k}") for k in range(3)]
    return Scene(discs, [Wall(9, -5, 10, 5, id="w")], restitution=e, **values)


ENGINES = [DoubleEngine(), SingleEngine(), QuadEngine(), RoundedEngine(bits=40), IntervalEngine(), SymbolicEngine()]


@pytest.mark.parametrize("engine", ENGINES, ids=lambda engine: engine.name)
@pytest.mark.parametrize("policy", ["simultaneous", "sequential"])
def test_every_engine_has_the_exact_velocities(engine, policy):
    scene = pushed_row(tie_policy=policy)
    true, run = (each.run(scene, events=3) for each in (ExactEngine(), engine))
    assert [e.contacts for e in run.events] == [e.contacts for e in true.events]
    for ours, theirs in zip(run.final.circles, true.final.circles, strict=True):
        assert float(ours.vx) == pytest.approx(float(theirs.vx), abs=1e-5)
        assert float(ours.vy) == pytest.approx(float(theirs.vy), abs=1e-5)


@pytest.mark.parametrize("engine", [DoubleEngine(), SingleEngine(), SymbolicEngine()], ids=lambda engine: engine.name)
def test_several_contacts_of_one_instant_lose_energy_alike(engine):
    """One disc between two that touch it, struck at once from both sides and below."""
    discs = [Circle(0, 0, id="a"), Circle(2, 0, id="b"), Circle(1, 4, vy=-1, r="sqrt(10) - 1", id="c", m=2)]
    scene = Scene(discs, restitution="1/2")
    true, run = ExactEngine().run(scene, events=3), engine.run(scene, events=3)
    assert true.events[0].coupled and len(true.events[0].impulses) == 2
    assert [e.impulses for e in run.events] == [e.impulses for e in true.events]
    for ours, theirs in zip(run.final.circles, true.final.circles, strict=True):
        assert float(ours.vy) == pytest.approx(float(theirs.vy), abs=1e-5)


@pytest.mark.parametrize("e", ["9/10", "1/2", "1/20"])
def test_pymunk_multiplies_elasticities_to_the_restitution(e):
    scene = Scene([Circle(0, 0, vx=2), Circle(4, 0)], [Wall(9, -5, 9, 5)], restitution=e)
    final = PymunkEngine().run(scene, events=2).final
    first, second, loss = float(final["c1"].vx), float(final["c2"].vx), float(Quantity.of(e))
    assert first == pytest.approx(1 - loss, abs=1e-9)
    assert second == pytest.approx(-loss * (1 + loss), abs=1e-9)


# -- Laws.


def test_energy_never_rises_and_momentum_stays():
    """Rows along an axis, several contacts at one instant among them."""
    with workdps(80):
        _energy_falls_and_momentum_stays()


def _energy_falls_and_momentum_stays() -> None:
    events = together = 0
    for seed in range(40):
        scene = row_of(Random(seed)).with_changes(walls=[], restitution=Random(-seed).choice(LOSSES[:4]))
        run = ExactEngine().run(scene, events=8)
        rows = [scene.circles, *(run.after(event.index).circles for event in run.events)]
        speeds = [[mpf(now.vx.digits(60)) for now in row] for row in rows]
        masses = [mpf(Quantity.of(c.m).digits(60)) for c in scene.circles]
        energies = [sum(m * v * v for m, v in zip(masses, row, strict=True)) for row in speeds]
        momenta = [sum(m * v for m, v in zip(masses, row, strict=True)) for row in speeds]
        assert all(after < before for before, after in pairwise(energies))
        assert all(abs(momentum - momenta[0]) < mpf(10) ** -40 for momentum in momenta)
        events += len(run.events)
        together += sum(len(event.impulses) > 1 for event in run.events)
    assert events > 50 and together > 5


def test_a_restitution_of_one_is_not_written_and_changes_nothing():
    scene = Scene([Circle(0, 0, vx=1), Circle(4, 0)])
    same = Scene([Circle(0, 0, vx=1), Circle(4, 0)], restitution="9/9")
    assert scene == same and scene.digest == same.digest and "restitution" not in scene.data()
    lossy = scene.with_changes(restitution="9/10")
    assert lossy.digest != scene.digest
    assert loads_toml(dump_toml(lossy)).restitution == Quantity.of("9/10")


@pytest.mark.parametrize(
    ("values", "told"),
    [
        ({"restitution": "11/10"}, "restitution = 11/10: is not in 0 to 1; write a number from 0 to 1"),
        ({"restitution": -1}, "restitution = -1: is not in 0 to 1; write a number from 0 to 1"),
        ({"restitution": "x"}, "restitution = "),
        (
            {"restitution": "1/2", "reverse_at": 3},
            "restitution = 1/2: cannot be turned back, as energy is lost; leave rev",
        ),
        ({"restitution": "1/2", "reverse_after": 3}, "leave reverse_after out"),
    ],
)
def test_what_is_refused_is_named(values, told):
    with pytest.raises(SceneError, match="restitution") as error:
        Scene([Circle(0, 0)], **values)
    assert told in str(error.value)


# -- Collapse within one instant.


def touching_three(e, policy="simultaneous", m=1) -> Scene:
    return Scene([Circle(0, 0, vx=1), Circle(2, 0, m=m), Circle(4, 0)], restitution=e, tie_policy=policy)


@pytest.mark.parametrize("policy", ["simultaneous", "sequential"])
@pytest.mark.parametrize("e", ["1/20", "7-4*sqrt(3)", "7-4*sqrt(3)-1/10**20"])
def test_three_balls_collapse_up_to_the_known_restitution(e, policy):
    run = ExactEngine().run(touching_three(e, policy))
    assert not run.events
    assert "collapse: c1 and c2 as well as c2 and c3 push each other without end" in run.stop.message


CORNER = (Wall(0, 1, 0, 0, id="left"), Wall(0, 0, 1, 0, id="floor"))


def in_a_corner() -> Scene:
    circles = (Circle("1/4", "1/4", "1/4", id="a"), Circle("1/3", 3, "1/3", vy=-2, id="b"))
    return Scene(circles, CORNER, restitution=0)


def test_a_disc_pushed_into_a_corner_without_end_is_a_collapse():
    """The one that pushes slides along a wall, from which the pushes send it away: that contact only parts further."""
    run = ExactEngine(work=20_000).run(in_a_corner())
    told = "collapse: a and b as well as a and left as well as a and floor push each other without end"
    assert told in run.stop.message


def test_orders_without_end_are_given_up_and_said_to_be(capsys):
    tree = all_orders(ExactEngine(), in_a_corner(), cap=3, samples=2)
    assert len(tree.outcomes) == 3 and tree.sampled == 2
    assert all(
        ("without end" in (stop := leaf.trajectory.stop.message)) or "have no end" in stop for leaf in tree.outcomes
    )
    print_orders(in_a_corner(), tree)
    assert "3 of them stop before the end: " in " ".join(capsys.readouterr().out.split())


@pytest.mark.parametrize("speed", ["-1/10", "1/10"])
def test_contacts_that_part_and_are_held_back_are_no_proof_of_a_collapse(speed):
    """a, between b and a wall, halves the speed of b at every turn, until b no longer parts from c, which comes on."""
    circles = (Circle(1, 0, id="a"), Circle(3, 0, vx=-1, id="b"), Circle(5, 0, vx=speed, id="c"))
    run = ExactEngine(work=20_000).run(Scene(circles, (CORNER[0],), restitution=0))
    assert not run.events and run.stop.reason in (StopReason.UNDECIDED, StopReason.BUDGET)
    assert "collapse" not in run.stop.message or "b and c" in run.stop.message


def test_three_balls_part_above_it():
    run = ExactEngine().run(touching_three("1/10"))
    assert len(run.events) == 1 and len(run.events[0].impulses) > 2 and run.certified


def test_pushes_in_turns_follow_the_recurrence():
    """What the proof rests on: of unequal masses too, the pushes go on where it says so, and end where it does not."""
    ends = []
    for m, e in [(F(m), F(e)) for m in ("1/3", "1", "5") for e in ("1/100", "1/20", "1/9", "1/4", "1/2")]:
        weights, speeds, pushes = (F(1), 1 / m, F(1)), [F(1), F(0), F(0)], 0
        while pushes < 40:
            i = next((k for k in (0, 1) if speeds[k] > speeds[k + 1]), None)
            if i is None:
                break
            push = (1 + e) * (speeds[i] - speeds[i + 1]) / (weights[i] + weights[i + 1])
            speeds[i] -= weights[i] * push
            speeds[i + 1] += weights[i + 1] * push
            pushes += 1
        run = ExactEngine().run(touching_three(e, m=m))
        assert ("collapse" in run.stop.message) is (pushes == 40)
        assert pushes == 40 or len(run.events[0].impulses) == pushes
        ends.append(pushes)
    assert 40 in ends and min(ends) < 6
