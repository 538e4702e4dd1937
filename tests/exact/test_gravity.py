"""Uniform gravity: against a referee in true coordinates, its laws, and faults that must be found."""

from __future__ import annotations

from random import Random

import edge_campaign
import pytest
import segment_referee
from falling_campaign import FALLING
from gravity_referee import DIGITS, GravityReferee, TieMet
from mpmath import mpf, workdps

from truebreak.exact import ExactEngine, exact_motion
from truebreak.exact.replay import wall_flights
from truebreak.exact.replay.state import Flights
from truebreak.exact.simulation import prediction
from truebreak.scenarios import Circle, Quantity, Scene, SceneError, StopReason, Wall

UNTIL, EVENTS = 12, 14

LOSSES = ("1", "1", "1", "9/10", "1/2", "99/100", "sqrt(2)/2")

PULLS = ((0, -10), (0, -1), ("1/3", "-1/2"), (3, 0), ("-sqrt(2)", "1/7"), (0, "1/100"), ("1/1000", "-9"))


def _draw(rng: Random, low: int, high: int, under: int) -> Quantity:
    return Quantity.of(f"{rng.randint(low * under, high * under)}/{under}")


def scene_of(seed: int) -> Scene | None:
    """Discs off any grid, under gravity between walls, some of them oblique; None where what it draws is refused."""
    rng = Random(f"gravity {seed}")
    discs = [
        Circle(
            3 * (k % 3) - 3 + _draw(rng, -1, 1, 97) / 2,
            3 * (k // 3) - 2 + _draw(rng, -1, 1, 89) / 2,
            r=f"{rng.randint(30, 100)}/101",
            m=rng.choice(("1", "2", "1/3")),
            vx=rng.choice((0, _draw(rng, -3, 3, 31))),
            vy=rng.choice((0, _draw(rng, -3, 3, 37))),
            id=f"c{k}",
        )
        for k in range(rng.randint(1, 5))
    ]
    floor = rng.choice(([0, -6, 1, -6], [-9, -8, 9, -7], [-9, -6, 9, "-13/2"]))
    kinds = {
        "floor": [Wall(*floor, id="floor")],
        "box": [
            Wall(*floor, id="floor"),
            Wall(0, 6, 1, 6, id="top"),
            Wall(-7, 0, -7, 1, id="left"),
            Wall(7, 0, "29/4" if rng.random() < 0.5 else 7, 9, id="right"),
        ],
        "wedge": [Wall(0, -9, 5, -4, id="up"), Wall(0, -9, -4, -4, id="down")],
        "shaft": [Wall(-6, 0, -6, 1, id="left"), Wall(6, 0, 6, 1, id="right")],
    }
    try:
        return Scene(
            discs,
            kinds[rng.choice(("floor", "box", "box", "wedge", "shaft"))],
            gravity=rng.choice(PULLS),
            restitution=rng.choice(LOSSES),
            name=f"gravity {seed}",
        )
    except SceneError:
        return None


def differs(scene: Scene, events: int = EVENTS, until: int = UNTIL) -> str | None:
    """How the exact engine and the referee part; empty where they agree, None where the referee does not take it."""
    try:
        told = GravityReferee(scene).run(mpf(until), events)
    except TieMet:
        return None
    run = ExactEngine().run(scene, until=until, events=events)
    if not run.certified:
        return run.stop.message
    with workdps(60):
        for mine, theirs in zip(told.hits, run.events, strict=False):
            if [tuple(pair) for pair in theirs.contacts] != [mine.pair]:
                return f"event {theirs.index}: {theirs.contacts}, not {mine.pair}"
            if abs(mpf(theirs.time.digits(60)) - mine.time) > mpf(10) ** -40:
                return f"event {theirs.index} at {float(theirs.time)}, not {float(mine.time)}"
        if len(told.hits) != len(run.events):
            return f"{len(run.events)} events, not {len(told.hits)}: {run.stop.message}"
        for circle, disc in zip(run.final.circles, told.bodies, strict=True):
            pairs = zip((circle.x, circle.y, circle.vx, circle.vy), (disc.x, disc.y, disc.vx, disc.vy), strict=True)
            if any(abs(mpf(a.digits(60)) - b) > mpf(10) ** -35 for a, b in pairs):
                return f"{circle.id} ends elsewhere"
    return ""


SEEDS = range(120)


def test_scenes_agree_with_the_referee():
    found = {seed: told for seed in SEEDS if (scene := scene_of(seed)) and (told := differs(scene)) is not None}
    assert len(found) > 100
    assert {seed: told for seed, told in found.items() if told} == {}


# -- Faults that the comparison must find.


def _made(change):
    """A change of every state as it is made."""

    def spoil(monkeypatch):
        known = Flights.__init__

        def made(self, scene, numbers, only=None):
            known(self, scene, numbers, only)
            change(self)

        monkeypatch.setattr(Flights, "__init__", made)

    return spoil


def _gravity(change):
    """Another gravity than the scene's."""

    def changed(flights):
        if flights.falling is not None:
            flights.falling = flights.falling._replace(**change(flights.falling))

    return _made(changed)


def _loss_squared(flights):
    """(1 + e^2) / 2 for (1 + e) / 2."""
    if flights.share is not None:
        e = flights.share + flights.share - flights.one
        flights.share = (flights.one + e * e) / (flights.one + flights.one)


def _form(place, name, other):
    """Another form than the proved one, in one module."""

    def spoil(monkeypatch):
        monkeypatch.setattr(place, name, other)

    return spoil


def _earlier_zero(monkeypatch):
    """Of two zeros the one at which the gap grows."""
    monkeypatch.setattr(prediction, "fall_time_back", lambda approach, half, root: (root - approach) / (half + half))
    monkeypatch.setattr(wall_flights, "fall_time_back", lambda approach, half, root: (root - approach) / (half + half))


FAULTS = {
    "half of gravity": _gravity(lambda f: {"hx": f.hx / 2, "hy": f.hy / 2}),
    "gravity upwards": _gravity(lambda f: {"hx": -f.hx, "hy": -f.hy}),
    "gravity along y alone": _gravity(lambda f: {"hx": f.hx - f.hx}),
    "gravity off by 1e-9": _gravity(lambda f: {"hy": f.hy + f.hy / 10**9}),
    "the other zero": _earlier_zero,
    "a bounce at the speed of the falling frame": _form(wall_flights, "fall_speed", lambda v, half, dt: v),
    "a bounce at half of the speed fallen": _form(wall_flights, "fall_speed", lambda v, half, dt: v + half * dt),
    "a wall that does not fall": _form(wall_flights, "sag", lambda x, v, half, dt: x + v * dt),
    "a wall that falls twice as far": _form(
        wall_flights, "sag", lambda x, v, half, dt: x + v * dt + (half + half) * dt * dt
    ),
    "a zero off by a sign": _form(
        wall_flights, "fall_time", lambda gap, approach, root: (gap + gap) / (root + approach)
    ),
    "e squared": _made(_loss_squared),
    "places in the falling frame": _form(exact_motion, "sunk", lambda x, half, time: x),
    "speeds in the falling frame": _form(exact_motion, "fall_speed", lambda v, half, dt: v),
}


@pytest.mark.usefixtures("unfiltered")
@pytest.mark.parametrize("fault", FAULTS)
def test_a_planted_fault_is_found(fault: str, monkeypatch: pytest.MonkeyPatch):
    FAULTS[fault](monkeypatch)
    assert any(_found(scene) for seed in range(60) if (scene := scene_of(seed)))


def _found(scene: Scene) -> bool:
    try:
        return bool(differs(scene, events=8))
    except (AssertionError, ArithmeticError):
        return True


@pytest.fixture
def at_length(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(segment_referee, "DIGITS", FALLING.digits[0])
    monkeypatch.setattr(segment_referee, "SAME", FALLING.digits[1])


@pytest.mark.usefixtures("at_length")
def test_with_every_older_ingredient_a_referee_agrees() -> None:
    """The campaign in short: gravity, walls that move and a restitution with everything else, by chance."""
    rows = [row for seed in range(40) if (row := edge_campaign.verdict(seed, FALLING))]
    assert [row for row in rows if row["outcome"] == "failure"] == []
    assert sum(row["outcome"] == "ok" for row in rows) > 26
    assert len({name for row in rows for name in row["ingredients"]}) == len(FALLING.ingredients) + 5 + 2


@pytest.mark.usefixtures("at_length", "unfiltered")
@pytest.mark.parametrize("fault", ["e squared", "a bounce at half of the speed fallen"])
def test_the_campaign_finds_planted_faults(fault: str, monkeypatch: pytest.MonkeyPatch) -> None:
    FAULTS[fault](monkeypatch)
    rows = (edge_campaign.verdict(seed, FALLING) for seed in range(60))
    assert any(row["outcome"] == "failure" for row in rows if row)


def test_late_times_cost_bits_once() -> None:
    """Up to time 1,000,000 the referee agrees, and an event loses as many bits at the end as at the start."""
    walls = [Wall(0, 0, 1, 0, id="floor"), Wall(-9, 0, -9, 1, id="left"), Wall(9, 0, 9, 1, id="right")]
    scene = Scene([Circle(0, "20000*sqrt(2)", vx="1/700", id="ball")], walls, gravity=(0, -1))
    runs = [ExactEngine().run(scene, until=until) for until in (100_000, 900_000, 1_000_000)]
    course = GravityReferee(scene).run(mpf(1_000_000), 10_000)
    assert [hit.pair for hit in course.hits] == [tuple(event.impulses[0]) for event in runs[2].events]
    with workdps(DIGITS):
        for name in ("x", "y", "vx", "vy"):
            value, theirs = getattr(runs[2].final["ball"], name).ball(256), getattr(course.bodies[0], name)
            assert abs(mpf(value.mid().str(80, radius=False)) - theirs) < mpf(10) ** -60
    (first, lost), (late, before), (end, after) = [(len(run.events), run.motion.log.lost) for run in runs]
    assert end > 2000
    assert abs((after - before) / (end - late) - lost / first) < 0.1 * lost / first


def test_a_fixed_disc_on_the_floor_is_none_that_has_come_to_rest():
    discs = [Circle(0, 1, 1, m="oo", id="post"), Circle(5, 7, 1, -2, 0, id="ball")]
    run = ExactEngine().run(Scene(discs, [Wall(0, 0, 1, 0, id="floor")], gravity=(0, -10)), events=3)
    assert run.stop.reason is StopReason.EVENTS, run.stop
