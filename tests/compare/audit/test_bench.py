"""The bench itself is right: its honest engines are honest, its bugs do something, its truth is known otherwise."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from audit.bench import attack, bugs_in_reports
from audit.bench.bugs import BUGS, coarse
from audit.bench.honest import HONEST, triples
from audit.bench.residuals import residuals
from audit.bench.scenes import CASES, scene_of
from audit.bench.truth import BETWEEN, INVISIBLE, VISIBLE, classify
from audit.bench.worlds import PRECISE, precisely
from truebreak.floating import DoubleEngine
from truebreak.scenarios import Circle, Scene

GENTLE = ("gas-3", "gas-mixed", "polygon-5", "cradle")
"""Scenes whose first events no honest engine of events, and no step of theirs, takes in another order."""

EARLY = 6
"""Events of a gentle scene that are held against the double engine."""

SMALL = ("gas-3", "masses-1e4", "cradle-touching", "corner-60", "polygon-5", "lee", "reversal", "gas-mixed")
"""Scenes in some of which every bug has something to spoil."""


@cache
def run_of(name: str, scene: str, bug: bool = False) -> Any:
    """A run of an engine of the bench."""
    engine = BUGS[name].engine if bug else HONEST[name]
    return engine.run(scene_of(scene), **CASES[scene].span(engine))


@pytest.mark.parametrize("name", HONEST)
@pytest.mark.parametrize("scene", GENTLE)
def test_honest_engines_tell_the_history_of_the_double_engine(name: str, scene: str) -> None:
    truth = DoubleEngine().run(scene_of(scene), events=EARLY)
    engine, case = HONEST[name], CASES[scene]
    told = run_of(name, scene)
    until = case.until if engine.step else None
    wanted = [e for e in truth.events if until is None or float(e.time) < until - 0.25]
    lists = [[sorted(map(str, pair)) for e in events for pair in e.impulses] for events in (told.events, wanted)]
    assert lists[0][: len(lists[1])] == lists[1]
    loose = engine.step * 8 if engine.step else 1e-4 if engine.bits == 24 else 1e-12
    for mine, theirs in zip(told.events, wanted, strict=False):
        assert float(mine.time) == pytest.approx(float(theirs.time), abs=loose * (1 + float(theirs.time)))


def test_there_is_what_was_asked_for() -> None:
    assert len(HONEST) >= 14 and len(BUGS) >= 40 and len(CASES) >= 24
    assert len({type(engine) for engine in HONEST.values()}) == len(HONEST)
    assert all(bug.sentence and bug.engine.name == name for name, bug in BUGS.items())
    assert bugs_in_reports.__doc__


@pytest.mark.parametrize("name", BUGS)
def test_a_bug_differs_from_its_parent_on_some_scene(name: str) -> None:
    bug = BUGS[name]
    for scene in SMALL:
        case = CASES[scene]
        if not case.takes(bug.engine):
            continue
        wrong, right = run_of(name, scene, True), bug.parent.run(scene_of(scene), **case.span(bug.engine))
        if wrong.motion.knots != right.motion.knots or triples(wrong) != triples(right):
            return
    pytest.fail(f"{name} does nothing on {SMALL}")


@pytest.mark.parametrize(
    ("name", "scene", "kind"),
    [
        ("restitution-0.98", "gas-3", VISIBLE),
        ("restitution-1e-17", "gas-3", INVISIBLE),  # below half an ulp, by construction
        ("nudge-1e-20", "gas-3", INVISIBLE),
        ("half-turn", "gas-3", INVISIBLE),  # the same line of centres
        ("masses-equal", "gas-3", INVISIBLE),  # they are equal
        ("masses-equal", "masses-1e4", VISIBLE),
        ("first-radius", "gas-3", INVISIBLE),  # so are the radii
        ("turned-but-one", "gas-3", INVISIBLE),  # nothing turns back
        ("turned-but-one", "reversal", VISIBLE),
        ("tie-doubled", "gas-3", INVISIBLE),  # no two at one time
        ("tie-doubled", "cradle-touching", VISIBLE),
        ("larger-part", "gas-3", INVISIBLE),  # walls along the axes
        ("larger-part", "polygon-5", VISIBLE),
        ("radius-1e-9", "gas-3", VISIBLE),
        ("time-of-40-bits", "gas-3", BETWEEN),  # 2^13 u, over the distance flown
        ("left-out", "gas-3", VISIBLE),
        ("missed-once", "gas-3", VISIBLE),
        ("phantom-once", "gas-3", VISIBLE),
        ("another-id", "gas-3", VISIBLE),
        ("times-restitution-0.98", "gas-3", VISIBLE),
        ("steps-0.98", "gas-3", VISIBLE),
        ("steps-masses", "gas-3", INVISIBLE),
    ],
)
def test_what_a_bug_does_is_known_otherwise(name: str, scene: str, kind: str) -> None:
    assert classify(BUGS[name], CASES[scene]).kind == kind


def test_the_effect_of_a_restitution_is_what_the_formula_says() -> None:
    small, large = (classify(BUGS[name], CASES["galperin"]).units for name in ("restitution-1e-6", "restitution-0.9"))
    assert large / small == pytest.approx(1e5, rel=0.5)


def test_residuals_of_a_contact_done_by_hand() -> None:
    scene = Scene([Circle(0, 0, vx=1, id="a"), Circle(4, 0, id="b")])
    for e in (1.0, 0.5):
        rows = {"a": (2.0, 0.0, (1 - e) / 2, 0.0), "b": (4.0, 0.0, (1 + e) / 2, 0.0)}

        class Told(type(HONEST["naive"])):  # type: ignore[misc]
            name = "told"

            def play(self, scene: Any, recording: Any, rows: Any = rows) -> None:
                recording.hit(2.0, "a", "b", rows)

        found = {(r.kind, float(r.value)) for r in residuals(Told().run(scene, events=1))}
        assert ("strength", (1 - e) / 2) in found and ("told gap", 0.0) in found
        assert {value for kind, value in found if kind in ("flight", "direction")} == {0.0}


@pytest.mark.parametrize("name", [n for n, e in HONEST.items() if e.step is None and e.tells != "nothing"])
@pytest.mark.parametrize("scene", ["gas-3", "graze-1e-15", "far-1e6", "masses-1e8", "reversal", "points"])
def test_residuals_of_honest_engines_are_a_few_units_of_rounding(name: str, scene: str) -> None:
    if CASES[scene].takes(HONEST[name]):
        said = attack.own(HONEST[name], scene_of(scene), **CASES[scene].span(HONEST[name]))
        assert said.kept is True, said.finding


@pytest.mark.parametrize("name", [n for n, b in BUGS.items() if b.engine.step is None and b.engine.tells != "nothing"])
def test_residuals_see_what_the_truth_calls_visible(name: str) -> None:
    seen = classify(BUGS[name], CASES["gas-mixed"])
    if seen.kind == BETWEEN or seen.what in ("missed", "quiet"):  # of contacts not told there are no residuals
        return
    said = attack.own(BUGS[name].engine, scene_of("gas-mixed"), **CASES["gas-mixed"].span(BUGS[name].engine))
    assert said.kept is (seen.kind == INVISIBLE), (seen, said)


def test_coarse_numbers_have_24_bits_in_every_type() -> None:
    assert coarse(0.1) == 0.10000000149011612 == float(coarse(precisely(0.1)))
    assert coarse(PRECISE.mpf(2) ** -900 / 3) > 0


def test_a_run_that_was_stopped_goes_on_where_it_was(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "rows.jsonl"
    words = ["--out", str(out), "--only", "restitution-0.98", "--scenes", "gas-3", "--judge", "own"]
    assert attack.main(words) == 1  # the bench's own judge says nothing of logs without states
    rows = out.read_text().splitlines()
    assert attack.main(words) == 1 and out.read_text().splitlines() == rows
    assert [attack.outcome(json.loads(row)) for row in rows] == ["bug, seen", "missed"]
    assert "missed: 1 of 2" in capsys.readouterr().out


def test_judges_that_are_wrong_are_counted(tmp_path: Path) -> None:
    case, honest = CASES["lee"], HONEST["naive"]
    cry = attack.row_of("honest", "naive", honest, case, lambda *a, **k: SimpleNamespace(kept=False, finding="wolf"))
    fall = attack.row_of("honest", "naive", honest, case, lambda *a, **k: 1 / 0)
    sleep = attack.row_of(
        "bug", "restitution-0.9", BUGS["restitution-0.9"].engine, case, lambda *a, **k: attack.Judged(True, "")
    )
    assert [attack.outcome(row) for row in (cry, fall, sleep)] == ["false alarm", "error", "missed"]
    assert "0 of 300, below 0.01 at 95 %" in attack.told(0, 300)
