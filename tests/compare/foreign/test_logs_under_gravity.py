"""Logs and recordings under gravity, at restitutions below 1, among walls that move."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from truebreak.compare import compare
from truebreak.compare.cli import main
from truebreak.compare.foreign import LogEngine, RecordedEngine, Recording
from truebreak.compare.foreign.recording import step_fall
from truebreak.compare.logdiff.lawful import lawful_runs
from truebreak.compare.report.floats import floats_json
from truebreak.compare.validation import EngineError
from truebreak.exact import ExactEngine
from truebreak.floating import DoubleEngine, PymunkEngine, RoundedEngine, SingleEngine
from truebreak.floating.knots import FallingEvents, SteppedEvents, SteppedFall
from truebreak.scenarios import Circle, Pocket, Quantity, Scene, Segment, Wall, catalogue
from truebreak.scenarios.engine import ALL_KEYS
from truebreak.scenarios.files import dump_json

FLOOR, RIGHT = Wall(0, 0, 1, 0, id="floor"), Wall(4, 0, 4, 1, id="right")
PAIR = Scene(
    [Circle(0, 3, vx="1/3", id="a"), Circle("1/5", 6, id="b", m=2)],
    [FLOOR, Wall(-2, 0, -2, 1, id="left", vx="1/16"), RIGHT],
    gravity=(0, -1),
    restitution="9/10",
    name="pair",
)


def logged(run: Any, scene: Scene, *, states: bool = True, bits: int = 53, step: float | None = None) -> LogEngine:
    """What a run reports, as the log of a run of `scene`."""
    recording = Recording(scene, "log", bits=bits, step=step)
    for event in run.events:
        left = run.after(event.index)
        rows = {str(c.id): (float(c.x), float(c.y), float(c.vx), float(c.vy)) for c in left.circles}
        recording.hits(float(event.time), event.impulses, rows if states else None)
    recording.end(float(run.final_time))
    return LogEngine(recording, "log", bits, step)


def judged(scene: Scene, log: Any, until: float) -> Any:
    return compare(scene, [log], until=until).candidates[0]


@pytest.mark.parametrize("restitution", ["1", "999/1000", "9/10"])
@pytest.mark.parametrize("engine", [DoubleEngine(), SingleEngine()], ids=["double", "single"])
def test_a_log_of_an_engine_that_keeps_the_law_is_found_to_keep_it(restitution: str, engine: Any) -> None:
    scene = PAIR.with_changes(restitution=restitution)
    run = engine.run(scene, until=6)
    found = judged(scene, logged(run, scene, bits=engine.bits), 6)
    assert found.verdict == "agree" and len(run.events) >= 5
    assert found.laws.kept and found.laws.impacts == len(run.events)
    if restitution != "1":
        assert found.laws.bounces.mean == pytest.approx(float(scene.restitution), abs=1e-6)


@pytest.mark.parametrize("text", ["axis", "ramp", "ski-jump", "platforms", "peg-mirror", "galton", "plinko"])
@pytest.mark.parametrize("engine", [DoubleEngine(), SingleEngine()], ids=["double", "single"])
def test_so_is_one_among_pegs_faces_and_ends(text: str, engine: Any) -> None:
    scene = catalogue.build(text).with_changes(until=None)
    run = engine.run(scene, events=10)
    found = judged(scene, logged(run, scene, bits=engine.bits), float(run.events[-1].time) * 1.0001)
    assert found.laws.kept and found.laws.impacts >= len(run.events) > 3


@pytest.mark.parametrize("text", ["axis", "ramp", "platforms", "plinko"])
def test_a_log_of_other_pegs_and_faces_is_found_to_break_the_law(text: str) -> None:
    """What is hit first is smaller, or lower, by a millionth of the scene."""
    scene = catalogue.build(text).with_changes(until=None)
    run = ExactEngine().run(scene, events=1)
    met, off = run.events[0].contacts[0].second, Quantity.of("1/10**3" if text == "platforms" else "1/10**6")
    pegs = [Circle(c.x, c.y, c.r - off, m="oo", id=c.id) if c.id == met else c for c in scene.circles]
    bars = [Segment(s.x0, s.y0 - off, s.x1, s.y1 - off, r=s.r, id=s.id) if s.id == met else s for s in scene.segments]
    run = DoubleEngine().run(scene.with_changes(circles=pegs, segments=bars), events=8)
    found = judged(scene, logged(run, scene), float(run.events[-1].time) * 1.0001)
    assert found.laws.kept is False
    assert any(met in violation.bodies for violation in found.laws.violations)


def test_where_states_do_not_say_how_an_engine_falls_within_a_step_no_law_is_called_broken() -> None:
    """States at contacts alone: what pymunk's bounce lacks of the last g dt was called a restitution of .996."""
    ball, peg = Circle(0, 5, "1/2", id="ball"), Circle(0, 0, m="oo", id="peg")
    bar = Segment(-9, 0, 9, 0, id="bar")
    for scene in (
        Scene([ball], [FLOOR], gravity=(0, -10)),
        Scene([ball, peg], gravity=(0, -10)),
        Scene([ball], segments=[bar], gravity=(0, -10)),
    ):
        for dt in (1 / 256, 1 / 1024):
            run = PymunkEngine(dt=dt).run(scene, events=4, until=8)
            found = judged(scene, logged(run, scene, step=dt), float(run.events[-1].time) + dt)
            assert len(run.events) == 4
            assert found.laws.kept is None and "how it falls within a step" in found.laws.reason
            worse = PymunkEngine(dt=dt).run(scene.with_changes(restitution="9/10"), events=4, until=8)
            found = judged(scene, logged(worse, scene, step=dt), float(worse.events[-1].time) + dt)
            assert found.laws.kept is False, found.laws.sentence


def test_the_flights_of_a_log_are_parabolas_between_its_events() -> None:
    run = DoubleEngine().run(PAIR, until=6)
    motion = logged(run, PAIR).run(PAIR, until=6).motion
    assert isinstance(motion, FallingEvents)
    times = [6 * k / 97 for k in range(98)]
    assert float(abs(motion.sample(times) - run.sample(times)).max()) < 1e-12


def test_times_alone_lead_along_the_run_under_gravity() -> None:
    run = DoubleEngine().run(PAIR, until=6)
    log = logged(run, PAIR, states=False)
    assert float(abs(log.last.sample([1.0, 3.0, 5.9]) - run.sample([1.0, 3.0, 5.9])).max()) < 1e-9
    assert not log.last.notes


@pytest.mark.parametrize("states", [True, False])
def test_a_log_enters_pockets_along_its_parabolas(states: bool) -> None:
    scene = PAIR.with_changes(pockets=[Pocket(0, 2, 1, id="low"), Pocket(1, 4, "3/2", id="high")])
    run = DoubleEngine().run(scene, until=6)
    assert len(run.pocketings) > 4
    log = logged(run, scene, states=states)
    assert [(e.circle, e.pocket) for e in log.last.pocketings] == [(e.circle, e.pocket) for e in run.pocketings]
    for mine, theirs in zip(log.last.pocketings, run.pocketings, strict=True):
        assert float(mine.time) == pytest.approx(float(theirs.time), abs=1e-9)
    found = judged(scene, log, 6)
    assert found.verdict == "agree"
    assert found.laws.kept is (True if states else None)
    assert found.changed == ()


PLANTED = {
    "gravity": (PAIR.with_changes(gravity=("0", "-1.01")), "a is 0.0094 from where it flew to"),
    "restitution": (PAIR.with_changes(restitution="22/25"), "restitution 0.88 fits"),
    "floor": (
        PAIR.with_changes(walls=[Wall(0, 0, 1, 0, id="floor", vy="1/100"), *PAIR.walls[1:]]),
        "a and floor are",
    ),
    "left stands": (PAIR.with_changes(walls=[FLOOR, Wall(-2, 0, -2, 1, id="left"), RIGHT]), ""),
}


@pytest.mark.parametrize("what", PLANTED)
def test_a_log_of_another_physics_is_found_to_break_the_law(what: str) -> None:
    """The run of a scene whose gravity, restitution or walls are others, as the log of this one."""
    other, told = PLANTED[what]
    leftward = [PAIR.circles[0].__class__(0, 3, vx="-2/3", id="a"), PAIR.circles[1]]
    scene, other = PAIR.with_changes(circles=leftward), other.with_changes(circles=leftward)
    found = judged(scene, logged(DoubleEngine().run(other, until=6), scene), 6)
    assert found.laws.kept is False
    assert told in found.laws.sentence


@dataclass(frozen=True)
class Stepper(RecordedEngine):
    """A small solver by steps: gravity added before the places, after, or as the law has it; it says states alone."""

    name = "stepper"
    scene_keys = ALL_KEYS - {"wall kinds"}
    step: float = 1 / 256
    order: str = "before"
    pull: float = 1.0

    def play(self, scene: Scene, recording: Recording) -> None:
        dt, n, e = self.step, 0, float(scene.restitution)
        assert scene.gravity is not None
        gx, gy = (self.pull * float(part) * dt for part in scene.gravity)
        rows = [[float(v) for v in (c.x, c.y, c.vx, c.vy)] for c in scene.circles]
        while recording.open:
            n += 1
            for row in rows:
                share = {"before": 1.0, "after": 0.0, "half": 0.5}[self.order]
                row[0] += (row[2] + share * gx) * dt
                row[1] += (row[3] + share * gy) * dt
                row[2], row[3] = row[2] + gx, row[3] + gy
            self._collide(scene, rows, n * dt, e)
            recording.state(n * dt, [tuple(row) for row in rows])

    @staticmethod
    def _collide(scene: Scene, rows: list[list[float]], time: float, e: float) -> None:
        (ax, ay, au, av), (bx, by, bu, bv) = rows
        dx, dy = bx - ax, by - ay
        away = math.hypot(dx, dy)
        nears = ((bu - au) * dx + (bv - av) * dy) / away
        if away < 2 and nears < 0:
            push = -(1 + e) * nears / (1 + 1 / 2) / away
            rows[0][2:] = [au - push * dx, av - push * dy]
            rows[1][2:] = [bu + push / 2 * dx, bv + push / 2 * dy]
        for wall in scene.walls:
            nx, ny = map(float, wall.normal)
            size = math.hypot(nx, ny)
            nx, ny, ux, uy = nx / size, ny / size, float(wall.vx), float(wall.vy)
            for row in rows:
                height = nx * (row[0] - float(wall.x0) - ux * time) + ny * (row[1] - float(wall.y0) - uy * time)
                side = 1 if height > 0 else -1
                nears = side * (nx * (row[2] - ux) + ny * (row[3] - uy))
                if abs(height) < 1 and nears < 0:
                    row[2] -= (1 + e) * side * nears * nx
                    row[3] -= (1 + e) * side * nears * ny


@pytest.mark.parametrize(("order", "ahead"), [("before", 1.0), ("after", 0.0), ("half", 0.5)])
def test_states_say_how_an_engine_falls_and_what_it_met(order: str, ahead: float) -> None:
    """Contacts are inferred from velocities less g dt; a fall by steps is no position correction."""
    found = judged(PAIR, Stepper(order=order), 8)
    motion = found.trajectory.motion
    assert isinstance(motion, SteppedEvents if ahead != 0.5 else (FallingEvents, SteppedEvents))
    assert getattr(motion, "ahead", 0.5) == ahead
    assert found.verdict == "agree" and len(found.trajectory.events) >= 6
    assert found.laws.kept
    kinds = {defect.kind for defect in found.laws.defects}
    assert ("integrator" in kinds) == (ahead != 0.5)
    assert "correction" not in kinds


def test_a_fall_that_no_contact_explains_is_one_clear_error() -> None:
    with pytest.raises(
        EngineError, match=r"the velocity of 'a' is .*, where its flight has .*, and no contact near it explains how"
    ):
        Stepper(pull=1.25).run(PAIR, until=2)


def test_states_that_disagree_on_the_fall_say_nothing_of_it() -> None:
    falls = [SteppedFall([[(0.0, 0.0, 8.0, 1.0, 0.0)]], gravity=(0.0, -4.0), dt=0.5, ahead=a) for a in (0.0, 1.0)]
    rows = [[(t, *fall.state(t)[0]) for t in (0.0, 0.5, 1.0, 1.5, 2.0)] for fall in falls]
    assert step_fall(rows, (0.0, -4.0), 0.5, (), 1e-12) is None
    assert step_fall(rows[:1], (0.0, -4.0), 0.5, (), 1e-12) == (0.0, 1.0)
    assert step_fall(rows[1:], (0.0, -4.0), 0.5, (), 1e-12) == (1.0, 0.0)
    assert step_fall([rows[0][:3]], (0.0, -4.0), 0.5, (), 1e-12) is None  # too few


def test_a_log_of_pymunk_is_judged_as_pymunk_is() -> None:
    engine = PymunkEngine(dt=1 / 128)
    run = engine.run(PAIR, until=6)
    own, log = judged(PAIR, engine, 6), judged(PAIR, logged(run, PAIR, step=engine.dt), 6)
    assert (log.verdict, log.laws.kept) == (own.verdict, own.laws.kept) == ("agree", True)
    assert log.laws.bounces.mean < 0.9 - 1e-3
    assert log.laws.bounces.low == pytest.approx(own.laws.bounces.low, abs=1e-9)


def test_restitution_zero_goes_on_together_in_a_log_of_times() -> None:
    scene = Scene(
        [Circle(0, 0, vx=1, id="a"), Circle(3, 0, id="b"), Circle(6, 1, id="c")],
        [Wall(9, 0, 9, 1, id="w", vx="-1/8")],
        restitution=0,
    )
    run = DoubleEngine().run(scene, until=20)
    log = logged(run, scene, states=False)
    assert len(run.events) >= 5
    assert not log.last.notes
    assert float(abs(log.last.sample([9.0, 14.0, 20.0]) - run.sample([9.0, 14.0, 20.0])).max()) < 1e-9


def test_onto_what_stands_under_gravity_a_log_is_compared() -> None:
    scene = Scene(
        [Circle("1/7", 6, "1/2", id="ball")],
        [FLOOR],
        segments=[Segment(-2, 3, 2, "7/2", id="ramp")],
        gravity=(0, -8),
        restitution="3/4",
    )
    run = DoubleEngine().run(scene, until=3)
    assert len(run.events) >= 2
    assert judged(scene, logged(run, scene), 3).verdict == "agree"
    assert judged(scene, logged(run, scene, states=False), 3).verdict == "agree"


def test_a_run_is_over_under_gravity_only_where_nothing_is_pulled_together() -> None:
    recording = Recording(Scene([Circle(0, 3, vy=1, id="a")], [FLOOR], gravity=(0, -1)), step=1 / 4)
    recording.state(0.25, {"a": (0.0, 3.25, 0.0, 0.75)})
    assert recording.trajectory().stop.reason.name != "QUIET"
    away = Recording(Scene([Circle(0, 3, vy=1, id="a")], [FLOOR], gravity=(0, 1)), step=1 / 4)
    away.state(0.25, {"a": (0.0, 3.28125, 0.0, 1.25)})
    assert away.trajectory().stop.reason.name == "QUIET"


def test_judge_says_which_restitution_the_bounces_have(tmp_path: Any, capsys: Any) -> None:
    run = DoubleEngine().run(PAIR.with_changes(restitution="22/25"), until=6)
    (tmp_path / "scene.json").write_text(dump_json(PAIR))
    lines = [
        {
            "time": float(event.time),
            "contacts": [list(pair) for pair in event.impulses],
            "states": {str(c.id): [float(v) for v in (c.x, c.y, c.vx, c.vy)] for c in run.after(event.index).circles},
        }
        for event in run.events
    ]
    log = tmp_path / "log.jsonl"
    log.write_text("\n".join(map(json.dumps, [*lines, {"end": 6.0}])))
    with pytest.raises(SystemExit, match="1"):
        main(["judge", str(tmp_path / "scene.json"), str(log)])
    told = " ".join(capsys.readouterr().out.split())
    assert "asked for restitution 0.9, its" in told and "have 0.88 on average" in told


def test_doubles_of_a_scene_have_its_walls_that_move() -> None:
    walls = floats_json(PAIR)["walls"]
    assert walls[1]["vx"] == 1 / 16 and walls[1]["error"]["vx"] == 0.0
    assert "vx" not in walls[0]


@pytest.mark.parametrize(
    ("text", "growth"), [("galton", (23.9, 24.1)), ("platforms", (47.2, 47.3)), ("plinko", (87.9, 88.0)), ("lee", None)]
)
def test_two_logs_of_one_scene_are_compared_by_its_growth(text: str, growth: Any, tmp_path: Path) -> None:
    """Of a tie, which has no tangent map, nothing is said of growth: it ended as an internal error."""
    scene, logs = catalogue.build(text).with_changes(until=None), []
    for name, engine in (("a", DoubleEngine()), ("b", RoundedEngine(52))):
        run = engine.run(scene, events=40)
        log = tmp_path / f"{name}.jsonl"
        with log.open("w", encoding="utf-8") as lines:
            for event in run.events:
                left = {str(c.id): [float(v) for v in (c.x, c.y, c.vx, c.vy)] for c in run.after(event.index).circles}
                line = {"time": float(event.time), "contacts": [list(pair) for pair in event.contacts], "states": left}
                print(json.dumps(line), file=lines)
        logs.append(log)
    found = lawful_runs(*logs, scene)
    assert [audit.kept for audit in found.audits] == [True, True]
    if growth is None:
        assert found.growth is None and len([*found.lines()]) == 1
    else:
        assert found.growth is not None
        assert growth[0] <= found.growth[0] <= found.growth[1] <= growth[1]
