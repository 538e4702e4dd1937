"""Circles that slide down slopes: where nothing can meet them any more they go on, by gravity along those."""

from __future__ import annotations

from collections import Counter
from itertools import combinations, pairwise
from math import hypot
from random import Random

import mpmath
import numpy as np
import pytest
from settle_campaign import contradicts, strays

from truebreak.compare.audit.audit import audit_run
from truebreak.compare.certificate.writer import CertificateError, certificate_of
from truebreak.compare.files.saved import run_of, saved_run
from truebreak.compare.picture import states_at
from truebreak.compare.report.player import played
from truebreak.exact import ExactEngine
from truebreak.exact.exact_motion import ExactMotion
from truebreak.exact.literal.symbolic_engine import SymbolicEngine
from truebreak.exact.replay.contact import Gravity
from truebreak.exact.replay.state import ReplayState
from truebreak.exact.simulation.arc_meetings import Incline
from truebreak.floating import DoubleEngine, IntervalEngine, PymunkEngine, QuadEngine, RoundedEngine, SingleEngine
from truebreak.scenarios import Circle, Engine, Scene, SceneError, Segment, Wall
from truebreak.scenarios.numbers.quantity import Quantity
from truebreak.scenarios.trajectory import StopReason, Trajectory

DOWN = (0, -10)
SLOPE = Wall(0, 0, 4, -3, id="slope")
FINITE = DoubleEngine(), SingleEngine(), QuadEngine(), RoundedEngine(bits=40), IntervalEngine()


def sloped(circles: list[Circle], *walls: Wall, e: object = 0, g: object = DOWN, **more: object) -> Scene:
    """Some circles over a slope."""
    return Scene(circles, [SLOPE, *walls], gravity=g, restitution=e, settle=True, **more)  # pyright: ignore[reportArgumentType]


def lands_and_slides(x0: str, y0: str, vx: str, normal: tuple[str, str], g: str, time: str) -> tuple[float, ...]:
    """x, y, vx, vy of a disc of radius 1 that falls onto a slope through (0, 0) and slides, in closed form."""
    with mpmath.workdps(40):
        x, y, v, nx, ny, g, t = (mpmath.mpf(part) for part in (x0, y0, vx, *normal, g, time))
        length = mpmath.sqrt(nx * nx + ny * ny)
        nx, ny = nx / length, ny / length
        gap, closing, press = nx * x + ny * y - 1, nx * v, -ny * g
        hit = (closing + mpmath.sqrt(closing * closing - 2 * press * gap)) / -press
        tx, ty = ny, -nx
        at = tx * (x + v * hit) + ty * (y - g * hit * hit / 2)
        speed, pull, lag = tx * v - ty * g * hit, -ty * g, t - hit
        s, fast = at + speed * lag + pull * lag * lag / 2, speed + pull * lag
        return tuple(map(float, (tx * s + nx, ty * s + ny, tx * fast, ty * fast)))


def in_closed_form(engine: Engine, room: float) -> None:
    """Compares an engine's slides with that, down a slope whose normal has a square root for its length, too."""
    for x, y, vx, wall, normal in (
        ("0", "6", "1", SLOPE, ("3", "4")),
        ("1/3", "5", "-2", Wall(0, 0, 3, -1, id="slope"), ("1", "3")),
    ):
        scene = Scene([Circle(x, y, vx=vx, id="a")], [wall], gravity=DOWN, restitution=0, settle=True)
        run = engine.run(scene, until=9)
        assert [(s.circle, s.wall) for s in run.settlings] == [("a", "slope")]
        x = str(mpmath.mpf(1) / 3) if x == "1/3" else x
        for time in ("2", "9/2", "9"):
            told = lands_and_slides(x, y, vx, normal, "10", str(float(mpmath.mpf(eval(time)))))
            for rows in (run.at(float(eval(time))).rows()[0], run.sample([float(eval(time))])[0][0]):
                assert np.abs(np.subtract(list(map(float, rows)), told)).max() < room * max(map(abs, told))


def exactly(run: Trajectory, time: str) -> list[str | None]:
    """x, y, vx, vy of the first circle as exact text, which the numbers at hand are compared with."""
    circle = run.at(time).circles[0]
    found: list[str | None] = []
    for value in (circle.x, circle.y, circle.vx, circle.vy):
        text = value.text()
        assert text is not None
        assert abs(Quantity.of(text) - Quantity.of(value.digits(30))) < Quantity.of("1e-28")
        found.append(text)
    return found


@pytest.mark.parametrize("engine", [ExactEngine(), *FINITE], ids=lambda engine: engine.name)
def test_a_slide_is_what_the_closed_form_has(engine: Engine) -> None:
    in_closed_form(engine, {"single": 1e-5, "rounded": 1e-9}.get(engine.name, 1e-12))


def test_a_slide_from_the_start_is_exact_at_any_time() -> None:
    """Up the slope first, and down; with a floor along an axis under gravity that leans, it is the same."""
    run = ExactEngine().run(sloped([Circle("3/5", "4/5", vx="-8", vy="6", id="a")]), until=40)
    assert [(s.circle, s.wall, s.time.text()) for s in run.settlings] == [("a", "slope", "0")]
    assert exactly(run, "10/3") == ["3/5", "4/5", "8", "-6"]
    places = "-8*sqrt(2) + 27/5", "6*sqrt(2) - 14/5", "-8 + 24/5*sqrt(2)", "6 - 18/5*sqrt(2)"
    assert [*map(Quantity.of, exactly(run, "sqrt(2)"))] == [*map(Quantity.of, places)]  # pyright: ignore[reportArgumentType]
    assert run.slides == {"a": (0.0, (4.8, -3.6))}
    level = Scene([Circle(0, 1, id="a")], [Wall(0, 0, 1, 0, id="floor")], gravity=(3, -4), settle=True)
    for engine in (ExactEngine(), *FINITE):
        x, y, vx, vy = engine.run(level, until=9).at(8).rows()[0]
        assert (float(x), float(y), float(vx), float(vy)) == (96.0, 1.0, 24.0, 0.0)


def test_pymunk_comes_to_it_as_its_step_shrinks() -> None:
    scene = sloped([Circle(0, 6, vx=1, id="a")])
    true, falls = ExactEngine().run(scene, until=3).sample([3.0])[0][0], scene.with_changes(settle=False)
    off = [np.abs(PymunkEngine(dt=2.0**-k).run(falls, until=3).sample([3.0])[0][0] - true).max() for k in (4, 6, 8)]
    assert all(later < before / 2 for before, later in pairwise(off))
    assert off[-1] < 0.05


def test_those_that_part_go_on_and_those_that_come_near_end_the_run() -> None:
    low, high = Circle("27/5", "-2", id="low"), Circle("3/5", "4/5", id="high")
    apart = ExactEngine().run(sloped([low, high]), until=20)
    assert apart.stop.reason is StopReason.HORIZON
    assert [s.circle for s in apart.settlings] == ["high", "low"] or [s.circle for s in apart.settlings] == [
        "low",
        "high",
    ]
    near = sloped([low, Circle("3/5", "4/5", vx="4", vy="-3", id="high")])
    stop = ExactEngine().run(near, until=20).stop
    assert stop.reason is StopReason.REST
    told = "at rest: a circle stands on what gravity pulls it to: high and slope, a slope, along which it slides"
    assert told in stop.message
    assert stop.message.endswith(": it is not proved that nothing meets it there")
    for engine in (ExactEngine(), SymbolicEngine()):
        assert engine.run(near.with_changes(settle=False, circles=[high]), until=20).stop.message == told


@pytest.mark.parametrize(
    ("thing", "goes"),
    [
        ({"walls": [SLOPE, Wall(-9, 0, -9, 1, id="behind")]}, True),
        ({"walls": [SLOPE, Wall(9, 0, 9, 1, id="before")]}, False),
        ({"walls": [SLOPE, Wall(0, 9, 4, 6, id="ceiling")]}, True),
        ({"circles": [Circle("3/5", "4/5", id="a"), Circle(12, -3, fixed=True, id="peg")]}, True),
        ({"circles": [Circle("3/5", "4/5", id="a"), Circle(12, -7, fixed=True, id="peg")]}, False),
        ({"circles": [Circle("3/5", "4/5", id="a"), Circle(-12, 12, fixed=True, id="peg")]}, True),
        ({"segments": [Segment(8, -3, 20, -9, id="bar")]}, True),
        ({"segments": [Segment(8, -3, 20, -14, id="bar")]}, False),
        ({"segments": [Segment(8, -8, 12, -14, id="bar")]}, True),
    ],
)  # fmt: skip
def test_what_stands_in_its_way_ends_the_run_and_nothing_else(thing: dict[str, list[object]], goes: bool) -> None:
    scene = sloped([Circle("3/5", "4/5", id="a")]).with_changes(**thing)
    run = ExactEngine().run(scene, until=9)
    assert run.stop.reason is (StopReason.HORIZON if goes else StopReason.REST)
    assert intrudes(run) == ""


def test_what_is_behind_a_wall_may_do_what_it_likes() -> None:
    shut = Wall(-9, 0, -9, 1, id="shut")
    beyond = [Circle(-12, 30, vx=5, id="b"), Circle(-19, 31, vx=9, id="c")]
    run = ExactEngine().run(sloped([Circle("3/5", "4/5", id="a"), *beyond], shut, e=1), until=3)
    assert [s.circle for s in run.settlings] == ["a"]
    assert len(run.events) > 2
    other = ExactEngine().run(sloped([Circle("3/5", "4/5", id="a"), *beyond], e=1), until=3)
    assert other.stop.reason is StopReason.REST


def test_files_pages_and_pictures_keep_it() -> None:
    run = ExactEngine().run(sloped([Circle(0, 6, vx=1, id="a"), Circle(-9, 9, id="b")]), until=6)
    again = run_of(saved_run(run))
    assert again.at("11/2")["a"].x.digits(30) == run.at("11/2")["a"].x.digits(30)
    data = played(run.scene, run, (), name="exact", title="exact")
    assert data is not None
    (shown,) = data["runs"]
    assert [(shown["knots"][n][1], *pull) for n, *pull in shown["slides"]] in (
        [(0, 4.8, -3.6), (1, 4.8, -3.6)],
        [(1, 4.8, -3.6), (0, 4.8, -3.6)],
    )
    for n, gx, gy in shown["slides"]:
        k, i, x, y, vx, vy = shown["knots"][n]
        lag = 6 - shown["times"][k]
        there = x + (vx + gx * lag / 2) * lag, y + (vy + gy * lag / 2) * lag
        assert hypot(*np.subtract(there, run.final.array()[i][:2])) < 1e-4
    quiet = ExactEngine().run(run.scene)
    assert quiet.stop.reason is StopReason.QUIET
    assert np.abs(np.subtract(states_at(quiet, 6.0), run.final.array())).max() < 1e-9


def test_what_does_not_follow_it_says_so() -> None:
    scene = sloped([Circle(0, 6, vx=1, id="a")])
    run = ExactEngine().run(scene, until=6)
    with pytest.raises(CertificateError) as refused:
        certificate_of(run)
    assert "a slides down a slope from time " in str(refused.value)
    assert certificate_of(ExactEngine().run(scene, until="1/2"))
    told = audit_run(DoubleEngine().run(scene, until=6), DoubleEngine())
    assert (told.kept, told.sentence.split(": ")[1]) == (None, "what slides down a slope is not audited yet")


# -- Scenes of any kind, against a referee that looks whether anything is ever inside of anything.


def drawn(seed: int) -> Scene | None:
    """Discs on and over a slope, and what may stand in their way."""
    rng = Random(f"slides {seed}")
    p, q, c = rng.choice(((3, 4, 5), (5, 12, 13), (8, 15, 17), (4, 3, 5)))

    def some(low: int, high: int) -> str:
        return f"{rng.randint(low * 10, high * 10)}/10"

    circles: list[Circle] = []
    for k in range(rng.choice((1, 2, 2, 3))):
        r, s = rng.choice((1, 2)), rng.randint(-9, 9)
        up = r if rng.random() < 0.6 else rng.randint(2, 6)
        speed = rng.choice((0, 0, rng.randint(-2, 2)))
        fall = 0 if up == r else rng.randint(-2, 2)
        circles.append(
            Circle(
                f"{q * s + p * up}/{c}", f"{q * up - p * s}/{c}", f"{r}/2" if up != r else r,
                f"{q * speed + p * fall}/{c}", f"{q * fall - p * speed}/{c}", rng.choice((1, 2)), id=f"b{k}",
            )
        )  # fmt: skip
    if rng.random() < 0.3:
        circles.append(Circle(some(-14, 14), some(-9, 14), rng.choice(("1/2", "1")), fixed=True, id="peg"))
    walls = [Wall(0, 0, q, -p, id="slope")]
    if rng.random() < 0.4:
        turn, (x, y) = (
            rng.choice(((0, 1), (p, q), (q, p), (1, 0), (q, -p))),
            (rng.randint(-16, 16), rng.randint(-9, 12)),
        )
        walls.append(Wall(x, y, x + turn[0], y + turn[1], id="other"))
    bars = [
        Segment(some(-9, 20), some(-14, 9), some(-9, 20), some(-14, 9), f"s{k}", rng.choice(("0", "1/8")))
        for k in range(rng.choice((0, 0, 1)))
    ]
    try:
        return Scene(circles, walls, segments=bars, gravity=DOWN, restitution=rng.choice((0, 0, "1/2", 1)), settle=True)
    except SceneError:
        return None


def intrudes(run: Trajectory) -> str:
    """What overlaps by more than rounding, in a long row of states of a run."""
    scene, end = run.scene, float(run.final_time)
    times = np.linspace(0.0, end, 500)
    for time, rows in zip(times, run.sample(times.tolist()), strict=True):
        room = 1e-9 * (1 + np.abs(rows[:, :2]).max())
        for (i, a), (k, b) in combinations(enumerate(scene.circles), 2):
            gap = hypot(*(rows[i][:2] - rows[k][:2])) - float(a.r) - float(b.r)
            if gap < -room and not (a.fixed and b.fixed):
                return f"{a.id} and {b.id} at {time}: {gap}"
        for circle, (x, y, *_) in zip(scene.circles, rows, strict=True):
            if circle.fixed:
                continue
            for wall in scene.walls:
                nx, ny = map(float, wall.normal)
                gap = abs(nx * (x - float(wall.x0)) + ny * (y - float(wall.y0))) / hypot(nx, ny) - float(circle.r)
                if gap < -room:
                    return f"{circle.id} and {wall.id} at {time}: {gap}"
            for bar in scene.segments:
                dx, dy = float(bar.x1 - bar.x0), float(bar.y1 - bar.y0)
                ex, ey = x - float(bar.x0), y - float(bar.y0)
                share = min(1.0, max(0.0, (ex * dx + ey * dy) / (dx * dx + dy * dy)))
                gap = hypot(ex - share * dx, ey - share * dy) - float(bar.r) - float(circle.r)
                if gap < -room:
                    return f"{circle.id} and {bar.id} at {time}: {gap}"
    return ""


SEEDS = range(90)


def ran(seed: int) -> Trajectory | None:
    """The certified run of one scene."""
    scene = drawn(seed)
    return None if scene is None else ExactEngine(work=100_000).run(scene, until=14, events=25)


def test_nothing_is_ever_inside_of_anything() -> None:
    counts, found = Counter[str](), list[str]()
    for seed in SEEDS:
        run = ran(seed)
        if run is None:
            continue
        counts[run.stop.reason.name] += 1
        counts["slides"] += len(run.slides)
        counts["of several"] += len(run.slides) > 1
        counts["beside what stands"] += bool(run.slides) and len(run.scene.ids) > len(run.slides) + 1
        if what := intrudes(run):
            found.append(f"{seed}: {what}")
    assert not found
    assert counts["slides"] > 20, counts
    assert counts["of several"] > 3, counts
    assert counts["beside what stands"] > 5, counts
    assert counts["REST"] > 9, counts


@pytest.mark.parametrize("name", ["_part", "_is_clear"])
def test_one_that_may_be_met_and_is_let_go_is_found(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Incline, name, lambda *_, **__: True)
    assert any(run is not None and intrudes(run) for run in map(ran, SEEDS))


BEND = ReplayState.bend


def _uphill(self: ReplayState[object], index: int) -> object:
    found = BEND(self, index)
    return found._replace(hx=-found.hx, hy=-found.hy) if found is not None and index in self.slopes else found


def _unbent(self: ReplayState[object], index: int) -> object:
    found = BEND(self, index)
    return Gravity(self.zero, self.zero, True) if found is not None and index in self.slopes else found


@pytest.mark.parametrize("fault", [_uphill, _unbent])
def test_a_slide_with_a_wrong_pull_is_found(fault: object, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ReplayState, "bend", fault)
    for engine in (DoubleEngine(), QuadEngine(), IntervalEngine()):
        with pytest.raises(AssertionError):
            in_closed_form(engine, 1e-12)
    with pytest.raises(AssertionError):
        test_a_slide_from_the_start_is_exact_at_any_time()


def test_a_wrong_pull_of_the_numbers_at_hand_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """The exact engine has these from its knots, and exact text from its log."""
    true = ExactMotion._bend

    def uphill(self: ExactMotion, i: int, k: int) -> object:
        found = true(self, i, k)
        return found if found is None or found is self._halves else (-found[0], -found[1])

    monkeypatch.setattr(ExactMotion, "_bend", uphill)
    with pytest.raises(AssertionError):
        in_closed_form(ExactEngine(), 1e-12)


def test_a_run_that_goes_on_is_one_to_its_end() -> None:
    scene = sloped([Circle(0, 6, vx=1, id="a"), Circle(-9, 9, id="b"), Circle(9, 1, vx=2, id="c")])
    short, whole = ExactEngine().run(scene, until=1), ExactEngine().run(scene, until=9)
    long = ExactEngine().resume(short, until=9)
    assert 0 < len(short.settlings) < len(long.settlings) == 3
    assert [(s.circle, s.time.text()) for s in long.settlings] == [(s.circle, s.time.text()) for s in whole.settlings]
    assert [c.x.digits(30) for c in long.final.circles] == [c.x.digits(30) for c in whole.final.circles]


def test_engines_of_finite_precision_slide_as_the_certified_run_has_it() -> None:
    counts, found = Counter[str](), list[str]()
    for seed in range(40):
        true = ran(seed)
        if true is None or not true.slides:
            continue
        for engine in FINITE:
            run = engine.run(true.scene, until=14, events=25)
            differs = contradicts(run, true) if engine.name == "interval" else strays(run, true, 1e-5)
            if differs and engine.name != "single":
                found.append(f"{seed}: {engine.name}: {differs}")
            counts[engine.name] += len(run.slides)
    assert not found
    assert min(counts[engine.name] for engine in FINITE) > 5, counts
