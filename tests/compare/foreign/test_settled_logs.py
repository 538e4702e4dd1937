"""Logs of scenes in which walls carry what comes to rest: true ones pass, and planted faults are found."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
import pytest
from settle_campaign import drawn

from truebreak.compare import compare, engine
from truebreak.compare.audit.audit import Audit, audit_run
from truebreak.compare.cli import main
from truebreak.compare.foreign import LogEngine, Recording
from truebreak.compare.foreign.impulses import Supports
from truebreak.compare.logdiff.lawful import lawful_runs
from truebreak.compare.report.sentences import settled_phrase, verdict_sentence
from truebreak.compare.validation import EngineError
from truebreak.scenarios import Circle, Quantity, Scene, Segment, Trajectory, Wall, catalogue
from truebreak.scenarios.files import dump_json

FLOOR = Wall(0, 0, 1, 0, id="floor")

Lines: TypeAlias = "list[dict[str, Any]]"


def lines_of(run: Trajectory, *, states: bool = True, carried: bool = False) -> Lines:
    """The log of a run: its impulses, states of the circles that move, and which of them walls carry."""
    found: Lines = []
    walls = {s.circle: s.wall for s in run.settlings}
    for event in run.events:
        line: dict[str, Any] = {"time": float(event.time), "contacts": [list(pair) for pair in event.impulses]}
        left = [c for c in run.after(event.index).circles if not run.scene.circles[run.scene.ids.index(c.id)].fixed]
        if states:
            line["states"] = {c.id: [float(v) for v in (c.x, c.y, c.vx, c.vy)] for c in left}
        if carried:
            rests = [c.id for c in left if run.motion.carries(run.scene.ids.index(c.id), event.time)]  # type: ignore[attr-defined]
            now = float(event.time)
            bounce = {s.circle for s in run.settlings if s.since is not None and float(s.since) <= now < float(s.time)}
            line["carried"] = {name: walls[name] for name in rests if name not in bounce}
        found.append(line)
    for rest in run.settlings:
        if rest.since is not None:  # infinitely many bounces come to their end
            [state] = [s for s in run.at(rest.time).circles if s.id == rest.circle]
            row = [float(v) for v in (state.x, state.y, state.vx, state.vy)]
            line = {"time": float(rest.time), "states": {rest.circle: row}, "carried": {rest.circle: rest.wall}}
            found.insert(sum(float(other["time"]) <= line["time"] for other in found), line)
    return [*found, {"end": float(run.final_time)}]


def logged(lines: Lines, scene: Scene, path: Path, bits: int = 53) -> LogEngine:
    path.write_text("".join(json.dumps(line) + "\n" for line in lines))
    return LogEngine.of(path, scene, bits=bits)


def settled(run: Trajectory) -> list[tuple[str, str, float]]:
    return [(s.circle, s.wall, float(s.time)) for s in run.settlings]


@pytest.mark.parametrize("told", [{}, {"carried": True}, {"states": False}], ids=["states", "carried", "times alone"])
def test_logs_of_an_engine_that_keeps_the_law(told: Mapping[str, bool], tmp_path: Path) -> None:
    """Discs settle, slide, are struck and carried again; by times alone, where they are follows from the laws."""
    count = bounced = 0
    scenes = *map(drawn, (*range(14), 19, 34, 38)), catalogue.build("landing"), catalogue.build("struck")
    for scene in filter(None, scenes):
        run = engine("double").run(scene, until=12, events=16)
        log = logged(lines_of(run, **told), scene, tmp_path / "log.jsonl")
        found = compare(scene, [log], until=float(run.final_time)).candidates[0]
        assert found.verdict in ("agree", "unsettled"), scene
        assert found.laws is not None
        assert found.laws.kept is (None if run.events and not told.get("states", True) else True), found.laws.sentence
        assert [row[:2] for row in settled(log.last)] == [row[:2] for row in settled(run)]
        assert [row[2] for row in settled(log.last)] == pytest.approx([row[2] for row in settled(run)], abs=1e-12)
        for event in log.last.events:
            for mine, theirs in zip(log.last.after(event.index).circles, run.after(event.index).circles, strict=True):
                assert (mine.x, mine.y) == pytest.approx((float(theirs.x), float(theirs.y)), abs=1e-9)
        count += len(run.settlings)
        bounced += sum(rest.since is not None for rest in run.settlings)
    assert count > 15
    assert bounced > 3


def test_single_precision_has_its_own_rounding(tmp_path: Path) -> None:
    run = engine("single").run(catalogue.build("landing"))
    log = logged(lines_of(run), run.scene, tmp_path / "log.jsonl", bits=24)
    assert audit_run(log.last, log).kept
    assert settled(log.last) == settled(run)


def test_a_floor_aslant_carries(tmp_path: Path) -> None:
    """Its states are rounded, and so is the speed across it that they have."""
    discs = [Circle(0, 4, vx=1, vy=1, id="a"), Circle(9, "27/4 + 5/4", id="b")]
    scene = Scene(discs, [Wall(0, 0, 4, 3, id="floor")], gravity=(3, -4), restitution=0, settle=True)
    run = engine("double").run(scene, until=9)
    log = logged(lines_of(run), scene, tmp_path / "log.jsonl")
    assert settled(log.last) == settled(run)[:2]  # which has both let go and carried again as they collide
    assert audit_run(log.last, log).kept


def test_a_platform_carries_by_its_own_name(tmp_path: Path) -> None:
    shelf = Segment(-1, 0, 1, 0, r="1/4", id="shelf")
    scene = Scene([Circle(0, 4, id="a")], segments=[shelf], gravity=(0, -2), restitution=0, settle=True)
    run = engine("double").run(scene, until=9)
    log = logged(lines_of(run), scene, tmp_path / "log.jsonl")
    assert [row[:2] for row in settled(log.last)] == [("a", "shelf")] == [row[:2] for row in settled(run)]
    assert audit_run(log.last, log).kept
    under = [Supports(scene).under(0, (x, 1.25, 0.0, 0.0), 2.0**-40, 0.0) for x in (-1.5, -0.5, 0.5, 1.5)]
    assert under == [None, 1, 1, None], "beyond its ends nothing is carried"


def test_a_ceiling_carries_nothing() -> None:
    hangs = Scene([Circle(0, 1, id="a")], [Wall(0, 2, 1, 2, id="ceiling")], gravity=(0, -2), settle=True)
    recording = Recording(hangs)
    recording.end(1.0)
    run = recording.trajectory()
    assert not run.settlings
    assert run.at(1)["a"].y == 0.0


# -- planted faults

SLIDES = Scene([Circle(0, 3, vx=1, id="a"), Circle(9, 1, id="b")], [FLOOR], gravity=(0, -2), restitution=0, settle=True)


def changed(tmp_path: Path, change: Callable[[Lines], Any], scene: Scene = SLIDES) -> Audit:
    lines = lines_of(engine("double").run(scene, until=12), carried=True)
    change(lines)
    log = logged(lines, scene, tmp_path / "log.jsonl")
    return audit_run(log.last, log)


def at_landing(column: int, by: float) -> Callable[[Lines], Any]:
    def change(lines: Lines) -> None:
        lines[0]["states"]["a"][column] += by

    return change


FAULTS: dict[str, tuple[Callable[[Lines], Any], set[str]]] = {
    "nothing": (lambda _: None, set()),
    "hovers": (at_landing(1, 1e-9), {"flight", "gap", "support"}),
    "is in the floor": (at_landing(1, -1e-9), {"flight", "gap", "support"}),
    "sinks": (at_landing(3, -1e-6), {"impulse", "support"}),
    "rises": (at_landing(3, 1e-6), {"impulse", "support"}),
    "is braked": (at_landing(2, -0.5), {"impulse"}),
    "is never carried": (lambda lines: lines[0].update(carried={}), {"depth"}),
    "is carried in the air": (
        lambda lines: lines.insert(0, {"time": 0.5, "states": {}, "carried": {"a": "floor"}}),
        {"support"},
    ),
    "passes the other": (lambda lines: lines.__delitem__(slice(1, len(lines) - 1)), {"depth"}),
}


@pytest.mark.parametrize("what", FAULTS)
def test_a_fault_of_a_log_is_found(what: str, tmp_path: Path) -> None:
    change, kinds = FAULTS[what]
    found = changed(tmp_path, change)
    assert found.kept is not bool(kinds), found.sentence
    assert {v.kind for v in found.violations} >= kinds, found.violations


def test_by_times_alone_what_falls_on_one_that_lies_is_met_beside_its_floor(tmp_path: Path) -> None:
    """The one that lies is pushed against its wall within the instant, whether or not the log says so."""
    discs = [Circle(0, 1, id="lies"), Circle("1/2", 6, id="falls")]
    scene = Scene(discs, [FLOOR], gravity=(0, -2), restitution="1/2", settle=True)
    run = engine("double").run(scene, until=3, events=1)
    lines = [{"time": float(run.events[0].time), "contact": ["lies", "falls"]}]
    rows = logged(lines, scene, tmp_path / "log.jsonl").last.after(0)
    for mine, theirs in zip(rows.circles, run.after(0).circles, strict=True):
        assert (mine.vx, mine.vy) == pytest.approx((float(theirs.vx), float(theirs.vy)), abs=1e-12)
    assert float(rows["lies"].vy) >= 0.0


def test_a_line_may_say_it_of_a_circle_without_states() -> None:
    recording = Recording(SLIDES)
    recording.hit(2.0**0.5, "a", "floor", {"a": (2.0**0.5, 1.0, 1.0, 0.0)}, {"a": "floor", "b": "floor"})
    recording.end(2.0)
    knots = recording.trajectory().motion.carried  # type: ignore[attr-defined]
    assert knots == {0: frozenset({1}), 1: frozenset({1, 2})}


# -- what is asked, and what is refused


def test_judge_audits_such_a_log(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    scene, log = tmp_path / "scene.json", tmp_path / "log.jsonl"
    scene.write_text(dump_json(SLIDES))
    run = engine("double").run(SLIDES, until=12)
    logged(lines_of(run), SLIDES, log)
    with pytest.raises(SystemExit) as ended:
        main(["judge", str(scene), str(log)])
    assert ended.value.code == 0
    said = " ".join(capsys.readouterr().out.split())
    assert "settled: b on floor at time 0, a on floor at time 1.41421356; the same in" in said
    lines = lines_of(run, carried=True)
    lines[0]["states"]["a"][1] += 1e-6
    logged(lines, SLIDES, log)
    with pytest.raises(SystemExit) as ended:
        main(["judge", str(scene), str(log)])
    assert ended.value.code == 1
    assert "does not keep the law" in " ".join(capsys.readouterr().out.split())


def test_diff_audits_both(tmp_path: Path) -> None:
    run = engine("double").run(SLIDES, until=12)
    logged(lines_of(run), SLIDES, tmp_path / "a.jsonl")
    lines = lines_of(run, carried=True)
    at_landing(1, 1e-6)(lines)
    logged(lines, SLIDES, tmp_path / "b.jsonl")
    found = lawful_runs(tmp_path / "a.jsonl", tmp_path / "b.jsonl", SLIDES)
    assert [told.kept for told in found.audits] == [True, False]


def test_a_log_of_steps_is_followed_and_its_steps_are_not_audited() -> None:
    recording = Recording(SLIDES, step=1 / 8)
    recording.end(1.0)
    found = compare(SLIDES, [LogEngine(recording, step=1 / 8)], until=1).candidates[0]
    assert not found.unable
    assert found.laws is not None and (found.laws.kept, found.laws.reason) == (
        None,
        "what walls carry is not audited yet in steps",
    )


@pytest.mark.parametrize(
    ("carried", "words"),
    [
        ({"c": "floor"}, "carried has 'c', which is no circle of the scene; use its ids"),
        ({"a": "b"}, "carried: 'a' = 'b'; must be the id of a wall, segment or polygon"),
        ({"a": 3}, "carried: 'a' = '3'; must be the id of a wall, segment or polygon"),
        (["a"], "carried = ['a']; must be walls by the ids of circles"),
    ],
)  # fmt: skip
def test_what_cannot_be_carried_is_refused(carried: Any, words: str) -> None:
    recording = Recording(SLIDES)
    with pytest.raises(EngineError) as refused:
        recording.state(1.0, {"a": (1.0, 2.0, 1.0, -2.0)}, carried)
    assert words in str(refused.value)


def test_without_settle_nothing_is_carried(tmp_path: Path) -> None:
    with pytest.raises(
        EngineError, match=r"line 1: carried: the scene has no settle = true; leave it out, or add that"
    ):
        logged([{"time": 1, "carried": {"a": "floor"}}], SLIDES.with_changes(settle=False), tmp_path / "log.jsonl")
    with pytest.raises(EngineError, match="carried = None; must be walls by the ids of circles"):
        logged([{"time": 1, "carried": None}], SLIDES, tmp_path / "log.jsonl")


SLOPE = Wall(0, 0, 4, -3, id="slope")


@pytest.mark.parametrize("told", [{}, {"carried": True}, {"states": False}], ids=["states", "carried", "times alone"])
def test_logs_of_discs_that_slide_down_slopes(told: Mapping[str, bool], tmp_path: Path) -> None:
    """Where they are is followed, and no law is said to be broken."""
    discs = [Circle("3/5", "4/5", id="a"), Circle("27/5", "19/5", vx=1, id="b")]
    scene = Scene(discs, [SLOPE], gravity=(0, -10), restitution=0, settle=True)
    run = engine("double").run(scene, until=5)
    log = logged(lines_of(run, **told), scene, tmp_path / "log.jsonl")
    found = compare(scene, [log], until=5).candidates[0]
    assert (found.verdict, audit_run(found.trajectory, log).kept) == ("agree", None)
    assert settled(found.trajectory) == settled(run)
    assert np.abs(found.trajectory.at(4.5).array() - run.at(4.5).array()).max() < 1e-9
    assert found.trajectory.slides.keys() == {"a", "b"}


def test_states_on_the_way_down_a_slope_are_no_contacts(tmp_path: Path) -> None:
    """Of a segment that is one, too: the certified run ends as a disc comes to rest across it, the log goes on."""
    plank = Segment(0, 0, 40, -30, id="plank")
    for scene in (
        Scene([Circle("3/5", "4/5", id="a")], [SLOPE], gravity=(0, -10), restitution=0, settle=True),
        Scene([Circle("43/5", "-26/5", id="a")], segments=[plank], gravity=(0, -10), restitution=0, settle=True),
    ):
        x, y = (float(part) for part in (scene.circles[0].x, scene.circles[0].y))
        rows = [[x + 2.4 * t * t, y - 1.8 * t * t, 4.8 * t, -3.6 * t] for t in (0.5, 1.0, 1.5)]
        lines: Lines = [{"time": row[2] / 4.8, "states": {"a": row}} for row in rows]
        log = logged([*lines, {"end": 2.0}], scene, tmp_path / "log.jsonl")
        run = log.run(scene)
        assert not run.events
        assert run.at(1.75).rows()[0] == pytest.approx([x + 2.4 * 1.75**2, y - 1.8 * 1.75**2, 8.4, -6.3])
        assert audit_run(run, log).kept is None


@pytest.mark.parametrize(
    ("fault", "told"),
    [
        ("none", True),
        ("fewer bounces", True),
        ("left out", False),
        ("late", False),
        ("early", False),
        ("aside", False),
        ("speed", False),
    ],
)
def test_a_line_tells_when_infinitely_many_bounces_end(fault: str, told: bool, tmp_path: Path) -> None:
    disc = Circle(0, 3, vx="1/2", id="a")
    scene = Scene([disc], [FLOOR], gravity=(0, -2), restitution="1/2", settle=True)
    run = engine("double").run(scene, until=12, events=90)
    [rest] = run.settlings
    assert rest.since is not None
    lines = lines_of(run)
    [end] = [line for line in lines if "carried" in line]
    if fault == "left out":
        lines.remove(end)
    if fault == "fewer bounces":
        del lines[-8:-2]
    end["time"] += {"late": 1e-3, "early": -1e-6}.get(fault, 0.0)
    x, y, vx, vy = end["states"]["a"]
    x += vx * (end["time"] - float(rest.time)) + 1e-6 * (fault == "aside")
    end["states"]["a"] = [x, y, vx + 1e-6 * (fault == "speed"), vy]
    log = logged(lines, scene, tmp_path / "log.jsonl")
    found = audit_run(log.run(scene, until=11), log)
    assert found.kept is told, found.sentence
    if told:
        [mine] = log.last.settlings
        assert float(mine.time) == float(rest.time)
        assert float(mine.since or 0) == lines[-3]["time"]


def dropped(
    e: float, y: float, *, twice: bool = False, over: float = 1e-6, late: float = 0.0, to: float = 1.0
) -> Lines:
    """The log of an engine of one's own: a disc that bounces on a floor, and is put onto it where its bounces end."""
    gravity, reach, speed, time, x, vx, lines = 10.0, 1.0, 0.0, 0.0, 0.0, 0.3, list[dict[str, Any]]()
    while not lines or speed > over:
        rise = speed / gravity if lines else math.sqrt(2.0 * (y - reach) / gravity)
        wait = 2.0 * rise if lines else rise
        time, x = time + wait, x + vx * wait
        fall = gravity * wait - speed
        speed = e * e * fall if twice else e * fall
        row = [x, reach - 2.0**-53 * y * 4, vx, speed]
        lines.append({"time": time, "contact": ["ball", "floor"], "states": {"ball": row}, "carried": {}})
    left = 2.0 * speed / (gravity * (1.0 - e)) + late
    rest = {"time": time + left, "states": {"ball": [x + vx * left, to, vx, 0.0]}, "carried": {"ball": "floor"}}
    return [*lines, rest, {"end": 6.0}]


def drop(e: str, y: str) -> Scene:
    return Scene([Circle(0, y, 1, vx="0.3", id="ball")], [FLOOR], gravity=(0, -10), restitution=e, settle=True)


@pytest.mark.parametrize(
    ("e", "y"), [("1/2", "6.1"), ("1/4", "6.1"), ("1/10", "11.3"), ("1/20", "6.1"), ("3/10", "6.1")]
)
def test_an_engine_may_put_onto_its_wall_what_has_bounced_there_infinitely_often(
    e: str, y: str, tmp_path: Path
) -> None:
    """Or leave it where it bounced last, off the wall by rounding; how many bounces are listed is no outcome."""
    scene = drop(e, y)
    for over in (1e-6, 1e-3):
        lines = dropped(float(Quantity.of(e)), float(y), over=over)
        found = compare(scene, [logged(lines, scene, tmp_path / "log.jsonl")], until=6)
        [mine] = found.candidates
        assert mine.laws is not None and mine.laws.kept, mine.laws.sentence
        assert mine.verdict == "agree" and not mine.changed
        assert settled_phrase(found).endswith("; the same in " + mine.engine)


@pytest.mark.parametrize("fault", [{"twice": True}, {"late": 1e-3}, {"to": 1.0 + 1e-9}])
def test_bounces_that_end_at_another_time_or_place_are_said_to(fault: Mapping[str, Any], tmp_path: Path) -> None:
    scene = drop("1/2", "6.1")
    found = compare(scene, [logged(dropped(0.5, 6.1, **fault), scene, tmp_path / "log.jsonl")], until=6)
    [mine] = found.candidates
    assert mine.laws is not None and mine.laws.kept is False
    assert ("; at other times in " in settled_phrase(found)) == ("to" not in fault)


@pytest.mark.parametrize(
    ("name", "declared", "hint"),
    [
        ("single", {}, "judge it with --bits 24"),
        ("single", {"bits": 24}, ""),
        ("double", {}, ""),
        ("pymunk:dt=1/64", {}, "equal steps of 1/64: if it moves by steps, judge it with --step 1/64"),
        ("pymunk:dt=1/64", {"step": 1 / 64}, ""),
    ],
)
def test_what_was_not_declared_is_seen_by_states(name: str, declared: Mapping[str, Any], hint: str) -> None:
    scene = catalogue.build("gas-under-gravity:n=4" if "pymunk" in name else "gas:n=4,seed=2")
    run = engine(name).run(scene, until=20)
    recording = Recording(scene, "log")
    if "pymunk" in name:
        for step in range(1, 40):
            ids, states = scene.ids, run.at(step / 64).circles
            recording.state(step / 64, {str(i): (c.x, c.y, c.vx, c.vy) for i, c in zip(ids, states, strict=False)})
    else:
        for line in lines_of(run)[:-1]:
            recording.hits(line["time"], [tuple(pair) for pair in line["contacts"]])
            told = (
                line["states"]
                if name == "double"
                else {i: np.float32(row).tolist() for i, row in line["states"].items()}
            )
            recording.state(line["time"], told)
    recording.end(20.0)
    hints = [*LogEngine(recording, "log", **declared).undeclared()]
    assert len(hints) == bool(hint) and hint in "".join(hints)


def test_a_law_that_is_broken_is_said_first_where_the_histories_are_not_settled(tmp_path: Path) -> None:
    """Bounces that keep their height go on for longer than the log: how far it agrees is open, the law is not."""
    scene = drop("1/2", "6.1")
    lines = dropped(0.5, 6.1)[:2]
    for line in lines:
        line["states"]["ball"][3] *= 2.0
    lines[1]["time"] = 3.0 * lines[0]["time"]
    lines[1]["states"]["ball"][0] = 0.3 * lines[1]["time"]
    found = compare(scene, [logged([*lines, {"end": 3.5}], scene, tmp_path / "log.jsonl")], until=6)
    assert found.candidates[0].verdict == "unsettled"
    assert verdict_sentence(found).startswith(f"{found.candidates[0].engine} does not keep the law: restitution 1 ")
