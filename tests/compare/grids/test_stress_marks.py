"""What a mark says: a cell is what `compare` says of its scene, and the exact engine is told by others than itself."""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import pytest

from truebreak.compare.certificate.certified import Certified
from truebreak.compare.certificate.writer import certificate_of, plain_certificate
from truebreak.compare.cli import main
from truebreak.compare.cli.commands.stress import code_of
from truebreak.compare.cli.progress import ExitCode
from truebreak.compare.grids import stress_map as witnessing
from truebreak.compare.grids.row import Row
from truebreak.compare.grids.stress_families import MapPlace, stress_family
from truebreak.compare.grids.stress_map import MapMark, StressJob, weighed, witness
from truebreak.exact import ExactEngine
from truebreak.floating import DoubleEngine
from truebreak.scenarios import Scene, SceneError, Trajectory

ENGINES = ("single", "double", "quad", "interval", "pymunk:max_steps=300000")

CODES = {"right": {0}, "wrong": {1, 2}, "undecided": {4}, "unsettled": {4}, "refused": {4}}
"""With which exit codes `compare` says so; 2 where an engine hands back what can be no history."""


def call(arguments: list[str]) -> int:
    with pytest.raises(SystemExit) as stop:
        main(arguments)
    return int(stop.value.code or 0)


@pytest.mark.parametrize(
    "place",
    [
        MapPlace("near-ties", 16, "left"),
        MapPlace("grazes", 18, "miss"),
        MapPlace("unstable", 16, "right"),
        MapPlace("moved", 9, "along", 1),
        MapPlace("scaled", 12, "down", 2),
        MapPlace("touching", 2, "row"),
        MapPlace("pi", 3, "wall"),
    ],
    ids=lambda place: f"{place.family}-{place.k}",
)
def test_a_cell_is_what_compare_says_of_the_scene_that_it_shows(
    place: MapPlace, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    exact, *rows = StressJob(0, place, ENGINES).rows()
    assert call(place.show.split()[1:]) == 0
    file = tmp_path / "scene.toml"
    file.write_text(capsys.readouterr().out, "utf-8")
    for engine, row in zip(ENGINES, rows, strict=True):
        code = call(["compare", str(file), "--engines", engine, "--json"])
        told = capsys.readouterr()
        mark = str(row.mark)
        assert code in CODES[mark], (engine, told.err)
        if code == 2:
            assert str(row.note) in told.err
            continue
        data = json.loads(told.out)
        assert data["scene"]["digest"] == row.digest == exact.digest
        (candidate,) = data["candidates"]
        assert candidate["verdict"] == {"right": "agree", "wrong": "diverged"}.get(mark, mark)
        if mark == "wrong":
            assert candidate["first_divergence"]["event"] == row.event
            assert candidate["changed_outcomes"] == row.changed


# -- engines


@dataclass(frozen=True)
class Stops(DoubleEngine):
    """Doubles that give up after one event."""

    def run(self, scene: Scene, **limits: Any) -> Trajectory:
        from truebreak.scenarios import StopReason
        from truebreak.scenarios.trajectory import Stop

        told = super().run(scene, events=1)
        return replace(told, stop=Stop(StopReason.UNDECIDED, "it gave up"))


@dataclass(frozen=True)
class Raises(DoubleEngine):
    """Doubles that raise."""

    def run(self, scene: Scene, **limits: Any) -> Trajectory:
        raise StopIteration


@dataclass(frozen=True)
class Refuses(DoubleEngine):
    """Doubles that take no scene."""

    def run(self, scene: Scene, **limits: Any) -> Trajectory:
        raise SceneError("not this one")


@dataclass(frozen=True)
class Before(DoubleEngine):
    """Doubles whose first event comes before the start."""

    def run(self, scene: Scene, **limits: Any) -> Trajectory:
        told = super().run(scene, **limits)
        return replace(told, events=(replace(told.events[0], time=-1.0), *told.events[1:]))


@dataclass(frozen=True)
class Unchanged(DoubleEngine):
    """Doubles under another name."""


@pytest.mark.parametrize(
    ("name", "mark"),
    [("Stops", "undecided"), ("Raises", "failed"), ("Refuses", "refused"), ("Before", "wrong"), ("Unchanged", "right")],
)
def test_an_engine_s_end_is_a_mark_and_never_the_end_of_the_map(name: str, mark: str) -> None:
    _, told = StressJob(0, MapPlace("near-ties", 3, "left"), (f"{__name__}:{name}",)).rows()
    assert told.mark == mark


def test_where_the_reference_does_not_know_nothing_is_right(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(witnessing, "ExactEngine", lambda: ExactEngine(max_bits=256))
    exact, *others = StressJob(0, MapPlace("near-ties", 200, "left"), ("double", "quad")).rows()
    assert exact.mark == "undecided"
    assert {told.mark for told in others} <= {"undecided", "unsettled", "wrong"}
    assert code_of([exact, *others]) is ExitCode.UNDECIDED


# -- the exact engine


def marked(code: int) -> MapMark:
    """The mark of a right run if the checker ended with a code."""
    one = stress_family("long-runs")
    place = one.place(3)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(witnessing, "weighed", lambda told: Certified("{}", code, "its sentence"))
        patch.setattr(witnessing, "MOST_TIMES", 1)
        told = witness(ExactEngine().run(one.scene(place)), one, place)
    assert told.note == "its sentence"
    return told.mark


def test_the_exact_engine_is_right_only_where_the_checker_says_so() -> None:
    assert [marked(code) for code in (0, 1, 2, 4)] == [
        MapMark.RIGHT,
        MapMark.WRONG,
        MapMark.UNCHECKED,
        MapMark.UNCHECKED,
    ]


def test_the_history_of_another_scene_is_refuted() -> None:
    """The run in which the right pair goes first, held out as that of the scene in which the left one does."""
    one = stress_family("near-ties")
    mine, other = one.place(20, "left"), one.place(20, "right")
    run = ExactEngine().run(one.scene(other))
    assert witness(run, one, other).mark is MapMark.RIGHT
    told = witness(replace(run, scene=one.scene(mine)), one, mine)
    assert told.mark is MapMark.WRONG
    assert told.closed_form is False


def test_a_certificate_of_too_few_bits_is_checked_with_more(monkeypatch: pytest.MonkeyPatch) -> None:
    """Refuted it is not, and right only once the checker has proved it."""
    one = stress_family("near-ties")
    place = one.place(30)
    run = ExactEngine().run(one.scene(place))
    rough = {**certificate_of(run), "bits": 80}
    assert weighed(rough).code == 4
    monkeypatch.setattr(witnessing, "plain_certificate", lambda run: None)
    monkeypatch.setattr(witnessing, "certificate_of", lambda run: rough)
    told = witness(run, one, place)
    assert told.mark is MapMark.RIGHT
    assert told.note.startswith("verified: 4 events, to the end: quiet; ")
    assert told.note.endswith(" (with 2 times its bits)")
    monkeypatch.setattr(witnessing, "MOST_TIMES", 1)
    assert witness(run, one, place).mark is MapMark.UNCHECKED


def test_a_closed_form_that_says_otherwise_refutes() -> None:
    one = replace(stress_family("long-runs"), known=lambda run, k, side, seed: False)
    place = one.place(3)
    assert witness(ExactEngine().run(one.scene(place)), one, place).mark is MapMark.WRONG


@pytest.mark.parametrize(
    ("error", "mark"),
    [
        (SceneError("it is too long for a certificate"), MapMark.UNCHECKED),
        (OverflowError("numbers that certificates do not reach"), MapMark.UNCHECKED),
        (AssertionError("its witness proves nothing"), MapMark.WRONG),
    ],
)
def test_a_run_without_a_certificate_is_not_right(
    error: Exception, mark: MapMark, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Nor is one whose certificate the writer itself refutes."""

    def refused(run: Trajectory) -> dict[str, Any]:
        raise error

    one = stress_family("near-ties")
    place = one.place(20)
    run = ExactEngine().run(one.scene(place))
    monkeypatch.setattr(witnessing, "plain_certificate", lambda run: None)
    monkeypatch.setattr(witnessing, "certificate_of", refused)
    assert witness(run, one, place).mark is mark


def test_single_meetings_are_checked_without_being_followed(monkeypatch: pytest.MonkeyPatch) -> None:
    """The checker compares each of the run's own numbers: one that is off by two units of its last place is refuted."""
    one = stress_family("near-ties")
    place = one.place(20)
    run = ExactEngine().run(one.scene(place))
    told = plain_certificate(run)
    assert told is not None and weighed(told).sentence == weighed(certificate_of(run)).sentence
    (x, *row), *rows = told["final"]["circles"]
    for off in (-2, 2):
        other = f"{int(x.replace('.', '')) + off:0{len(x) - 1}d}"
        final = {**told["final"], "circles": [[f"{other[:-17]}.{other[-17:]}", *row], *rows]}
        assert weighed({**told, "final": final}).code == 1
    for k in range(1, len(told["instants"])):
        missing = [entry for j, entry in enumerate(told["instants"]) if j != k]
        assert weighed({**told, "instants": missing}).code in (1, 4)
    monkeypatch.setattr(witnessing, "certificate_of", None)
    assert witness(run, one, place).mark is MapMark.RIGHT


def test_what_is_not_proved_at_once_is_followed() -> None:
    """At the start the ball touches a wall: a meeting without an event, for which the checker wants a zero."""
    one = stress_family("walls")
    place = one.place(16, "closing")
    run = ExactEngine().run(one.scene(place))
    told = plain_certificate(run)
    assert told is not None and weighed(told).code == 1
    assert witness(run, one, place).mark is MapMark.RIGHT


@pytest.mark.parametrize(
    ("marks", "code"),
    [
        (["right", "right"], ExitCode.DONE),
        (["right", "unchecked"], ExitCode.UNDECIDED),
        (["undecided", "right"], ExitCode.UNDECIDED),
        (["unchecked", "wrong"], ExitCode.DIVERGED),
    ],
)
def test_the_exit_code_tells_of_the_exact_engine(marks: list[str], code: ExitCode) -> None:
    assert code_of([Row(0, "s", "exact", mark=mark) for mark in marks]) is code
