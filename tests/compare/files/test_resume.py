"""A run that goes on from what was saved is the run that was never interrupted."""

from __future__ import annotations

import json
import random
from collections.abc import Callable
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from command_line import said
from ended import ended_at
from test_run_file import MANY_ROOTS, RUNS, assumed, pocketed

import truebreak as tb
from truebreak.compare import trajectory_json
from truebreak.compare.files.saved import run_of, saved_run
from truebreak.compare.report.schema import schema
from truebreak.exact import ExactEngine
from truebreak.exact.certified import certified_decider as precision
from truebreak.exact.numbers import ball
from truebreak.exact.replay.contact import KINDS, Pair
from truebreak.exact.simulation.loop import Loop
from truebreak.scenarios import Circle, Pocket, Scene, SceneError, StopReason, Trajectory, Wall, catalogue


def all_but_plan(run: Trajectory) -> tuple[str, str]:
    """What a run is, as JSON and as saved, without what it counted on the way."""
    told = trajectory_json(run)
    saved = json.loads(saved_run(run))
    for data in (told, saved, saved["tape"]):
        data.pop("plan")
    saved.pop("digest")
    return json.dumps(told), json.dumps(saved)


class Counted:
    """Counts how often a run sets the precision, from where its loop begins to where it ends.

    Args:
        limit: at which of them Ctrl-C comes: anywhere, also within an instant.
    """

    def __init__(self, monkeypatch: pytest.MonkeyPatch, limit: int = 0) -> None:
        self.patch = monkeypatch
        self.limit = limit
        self.calls = self.whole = 0
        self.armed = False

    def run(self, run: Callable[[], Trajectory]) -> Trajectory:
        """What comes of a run."""
        use_bits, first, loop = ball.use_bits, Loop._first_knots, Loop.run

        def counted(bits: int) -> None:
            self.calls += self.armed
            if self.armed and self.calls == self.limit:
                raise KeyboardInterrupt
            use_bits(bits)

        def begun(self_: Loop) -> None:
            first(self_)
            self.armed = True

        def ended(self_: Loop) -> Any:
            stop = loop(self_)
            self.armed, self.whole = False, self.calls
            return stop

        with self.patch.context() as patched:
            patched.setattr(ball, "use_bits", counted)
            patched.setattr(Loop, "_first_knots", begun)
            patched.setattr(Loop, "run", ended)
            return run()


def interrupted_after(calls: int, run: Callable[[], Trajectory], monkeypatch: pytest.MonkeyPatch) -> Trajectory:
    """A run that Ctrl-C ends."""
    return Counted(monkeypatch, calls).run(run)


def calls_of(run: Callable[[], Trajectory], monkeypatch: pytest.MonkeyPatch) -> int:
    """How often a run sets the precision."""
    counted = Counted(monkeypatch)
    counted.run(run)
    return counted.whole


def drawn_pockets() -> Trajectory:
    """Many circles, drawn orders, pockets, a reversal by count and lasting contacts."""
    circles = [Circle(2 * k, 2, r=1, vx=1 if k == 1 else 0, id=f"c{k}") for k in range(1, 4)]
    walls = (Wall(0, 0, 0, 1), Wall(12, 0, 12, 1), Wall(0, 0, 1, 0), Wall(0, 9, 1, 9))
    more = [Circle(10, 4, vy=-1, vx="1/3", id="d"), Circle(10, 8, vx="-1/2", id="e")]
    scene = Scene([*circles, *more], walls, pockets=[Pocket(6, 5, 1)], reverse_after=8)
    return ExactEngine().run(scene.with_changes(tie_policy="sequential:seed=5"), events=30)


CASES: dict[str, Callable[[], Trajectory]] = {
    **{name: RUNS[name] for name in RUNS if name not in ("undecided", "assumed", "long numbers")},
    "drawn": drawn_pockets,
    "disc in a disc": lambda: ExactEngine().run(catalogue.build("inscribed"), events=12),
    "tennis": lambda: ExactEngine().run(catalogue.build("tennis"), events=20),
    "the way back": lambda: ExactEngine().run(catalogue.build("gas:n=4").with_changes(reverse_after=12)),
    "rack with a cue": lambda: ExactEngine().run(catalogue.build("rack:rows=3"), events=25),
    "rising": lambda: ExactEngine().run(catalogue.build("gas:n=3"), events=1200),
}


@pytest.mark.parametrize("kind", CASES)
def test_a_run_that_was_interrupted_anywhere_goes_on_as_if_it_had_not_been(
    kind: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = CASES[kind]()
    calls = calls_of(CASES[kind], monkeypatch)
    draw = random.Random(kind)
    told = all_but_plan(whole)
    for place in sorted({2, calls, *(draw.randrange(1, calls + 1) for _ in range(6))}):
        part = interrupted_after(place, CASES[kind], monkeypatch)
        assert part.stop.reason is StopReason.INTERRUPTED
        again = ExactEngine().resume(run_of(saved_run(part)))
        assert all_but_plan(again) == told, place


def test_a_run_that_keeps_its_deviations_in_a_set_goes_on_as_well(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(precision, "LONG_BITS", 512)

    def run() -> Trajectory:
        return ExactEngine().run(catalogue.build("gas:n=4,seed=2"), events=500)

    whole, calls, draw = run(), calls_of(run, monkeypatch), random.Random(1)
    assert saved_run(whole) == saved_run(run())
    assert '"centred": true' in saved_run(whole).replace('":true', '": true')
    for place in (calls - 1, calls - 2, *(draw.randrange(calls // 2, calls) for _ in range(4))):
        part = interrupted_after(place, run, monkeypatch)
        assert all_but_plan(ExactEngine().resume(run_of(saved_run(part)))) == all_but_plan(whole), place


def test_what_goes_on_can_be_interrupted_again(monkeypatch: pytest.MonkeyPatch) -> None:
    run = CASES["the way back"]
    calls = calls_of(run, monkeypatch)
    part = interrupted_after(calls // 3, run, monkeypatch)
    more = interrupted_after(2 * calls // 3, lambda: ExactEngine().resume(part), monkeypatch)
    assert len(part.events) < len(more.events)
    assert all_but_plan(ExactEngine().resume(run_of(saved_run(more)))) == all_but_plan(run())


def test_what_is_interrupted_before_it_is_where_it_was_keeps_what_there_is(monkeypatch: pytest.MonkeyPatch) -> None:
    part = ExactEngine().run(catalogue.build("gas:n=4"), events=40)
    kept = interrupted_after(20, lambda: ExactEngine().resume(part, events=50), monkeypatch)
    assert kept.stop.reason is StopReason.INTERRUPTED
    assert kept.events == part.events
    assert len(ExactEngine().resume(kept, events=50).events) == 50


@pytest.mark.parametrize("kind", ["gas", "rack", "point", "drawn", "roots", "many roots", "pocketed"])
def test_to_farther_limits_it_is_the_run_to_those(kind: str) -> None:
    whole = CASES[kind]()
    for events in range(1, len(whole.events) + 1, 1 + len(whole.events) // 6):
        part = run_of(saved_run(ExactEngine().run(whole.scene, events=events)))
        again = ExactEngine().resume(part, events=len(whole.events))
        told = trajectory_json(ExactEngine().run(whole.scene, events=len(whole.events)))
        mine = trajectory_json(again)
        assert mine.pop("plan").keys() >= {"bits"}
        told.pop("plan")
        assert json.dumps(mine) == json.dumps(told)


@pytest.mark.parametrize("seed", [0, 2, 4, 6])
def test_ties_and_grazes_are_told_as_in_one_run(seed: int) -> None:
    """Which of many meetings at one instant was queued first, and when a graze was proved, is another thing there."""
    draw = random.Random(seed)
    circles = [Circle(4 * i, 4 * j, vx=draw.randint(-1, 1), vy=draw.randint(-1, 1)) for i in range(5) for j in range(4)]
    walls = [Wall(-4, 0, -4, 1), Wall(20, 0, 20, 1), Wall(0, -4, 1, -4), Wall(0, 16, 1, 16)]
    scene = Scene(circles, walls)
    whole = json.loads(saved_run(ExactEngine().run(scene, events=40)))
    for place in (3, 9, 17, 25):
        part = run_of(saved_run(ExactEngine().run(scene, events=place)))
        again = json.loads(saved_run(ExactEngine().resume(part, events=40)))
        assert again["events"] == whole["events"], place
        assert again["tape"]["grazes"] == whole["tape"]["grazes"], place


def test_to_nearer_limits_too() -> None:
    whole = CASES["gas"]()
    assert all_but_plan(ExactEngine().resume(whole, events=7)) == all_but_plan(ExactEngine().run(whole.scene, events=7))
    half = float(whole.final_time) / 2
    assert all_but_plan(ExactEngine().resume(whole, until=half)) == all_but_plan(
        ExactEngine().run(whole.scene, until=half)
    )


def test_what_was_undecided_goes_on_with_more_work() -> None:
    part = RUNS["undecided"]()
    assert part.stop.reason is StopReason.UNDECIDED
    again = ExactEngine().resume(run_of(saved_run(part)))
    assert all_but_plan(again)[0] == all_but_plan(ExactEngine().run(part.scene))[0]


def test_the_rule_of_ties_stays() -> None:
    part = assumed()
    with pytest.raises(SceneError, match="go on with the same"):
        ExactEngine().resume(part)
    again = ExactEngine(ties="assume:200", work=2000).resume(run_of(saved_run(part)))
    assert all_but_plan(again) == all_but_plan(part)
    assert again.assumptions == part.assumptions


def test_a_log_of_another_scene_is_told() -> None:
    part = ExactEngine().run(MANY_ROOTS, events=9)
    data = json.loads(saved_run(part))
    assert [row for row in data["tape"]["instants"] if isinstance(row, list)]
    other = ExactEngine().run(MANY_ROOTS.with_changes(tie_policy="sequential:order=scene"), events=9)
    other.motion.tape.found[3] = Pair(0, 1)  # type: ignore[attr-defined]
    with pytest.raises(SceneError, match="the log is not what its scene does"):
        ExactEngine().resume(other, events=20)


def test_pockets_are_among_the_cases() -> None:
    assert pocketed().pocketings
    assert drawn_pockets().reversal is not None


# -- the command line


def test_the_command_line_goes_on(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    """In place of the file that it reads, and to the byte."""
    file = str(tmp_path / "run.json")
    plain = said(capsys, "run", "rack:rows=2", "--events", "12", "--json", "--exact")
    said(capsys, "run", "rack:rows=2", "--events", "5", "--save", file)
    words = ("run", "--resume", file, "--events", "12", "--json", "--exact", "--save", file)
    assert without_plan(said(capsys, *words)) == without_plan(plain)
    assert without_plan(said(capsys, "run", "--resume", file, "--json", "--exact")) == without_plan(plain)


def without_plan(told: tuple[Any, str, str]) -> tuple[Any, str, str]:
    code, out, err = told
    data = json.loads(out)
    data.pop("plan")
    return code, json.dumps(data), err


def test_ctrl_c_on_the_way_loses_nothing(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    file = str(tmp_path / "run.json")
    said(capsys, "run", "rack:rows=2", "--events", "8", "--save", file)
    words = ("run", "--resume", file, "--events", "12", "--json", "--save", file)
    with ended_at(0, True, KeyboardInterrupt(), monkeypatch) as counted:
        said(capsys, *words)
    said(capsys, "run", "rack:rows=2", "--events", "8", "--save", file)
    had = 8
    for k in range(1, counted[0] + 1, 5):
        with ended_at(k, k % 2 == 0, KeyboardInterrupt(), monkeypatch):
            code, out, _ = said(capsys, *words)
        kept = tb.load_run(file)
        assert (code, kept.stop.reason) == (130, StopReason.INTERRUPTED)
        assert trajectory_json(kept) == json.loads(out)
        assert len(kept.events) >= had
        had = len(kept.events)
    whole = said(capsys, "run", "rack:rows=2", "--events", "12", "--json")
    assert without_plan(said(capsys, *words)) == without_plan(whole)


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["gas"], "SCENE is in the file that --resume reads"),
        (["--tie-policy", "simultaneous"], "--tie-policy is in the file"),
        (["--reverse-after", "3"], "--reverse-after is in the file"),
        (["--engine", "double"], "--engine is in the file"),
        (["--ties", "assume:99"], "go on with the same"),
        (["--resume", "none.json"], "no such file"),
        (["--events", "0"], "whole number from 1"),
    ],
)
def test_what_cannot_be_gone_on_with_is_refused(
    words: list[str], told: str, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    file = str(tmp_path / "run.json")
    said(capsys, "run", "lee", "--save", file)
    code, out, err = said(capsys, "run", "--resume", file, *words)
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert told in err


def test_no_scene_and_nothing_to_go_on_from(capsys: pytest.CaptureFixture[str]) -> None:
    code, out, err = said(capsys, "run")
    assert (code, out) == (2, "")
    assert "SCENE" in err


def test_in_python(tmp_path: Path) -> None:
    run = tb.run(tb.scene("gas:n=4"), events=5)
    tb.save_run(run, tmp_path / "run.json")
    for earlier in (run, tmp_path / "run.json"):
        assert len(tb.resume(earlier, events=9).events) == 9
    with pytest.raises(SceneError, match="only runs of the exact engine"):
        tb.resume(tb.run(tb.scene("gas:n=4"), "double", events=5))


# -- the schema


@pytest.mark.parametrize("kind", [*CASES, "assumed", "undecided"])
def test_what_is_saved_is_what_its_schema_says(kind: str) -> None:
    run = {**CASES, **RUNS}[kind]()
    jsonschema.Draft202012Validator(schema("run-1")).validate(json.loads(saved_run(run)))


@pytest.mark.parametrize("name", ["stadium", "round-table", "wedge", "ghost", "cradle:e=9/10"])
def test_what_is_saved_of_the_larger_world_is_too(name: str) -> None:
    run = ExactEngine().run(catalogue.build(name), events=12)
    jsonschema.Draft202012Validator(schema("run-1")).validate(json.loads(saved_run(run)))


def test_the_schema_has_every_reason_to_stop_and_every_kind_of_contact() -> None:
    told = schema("run-1")
    assert set(told["properties"]["stop"]["prefixItems"][0]["enum"]) == {reason.name for reason in StopReason}
    assert {"", *told["$defs"]["link"]["anyOf"][1]["prefixItems"][2]["enum"]} == set(KINDS)


@pytest.mark.parametrize("key", ["steps", "events", "knots", "entries"])
def test_the_schema_tells_what_it_is_not(key: str) -> None:
    data = json.loads(saved_run(pocketed()))
    data[key][0] = [*data[key][0], 7]
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.Draft202012Validator(schema("run-1")).validate(data)
