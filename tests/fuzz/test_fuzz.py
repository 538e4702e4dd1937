"""A short run of the fuzz, and the witness itself on what is known by hand."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest
from flint import arb, fmpz  # type: ignore[attr-defined]

from fuzz.check import Difference, compare
from fuzz.draft import F
from fuzz.examine import examine
from fuzz.generators import KINDS, case_of
from fuzz.referee import Told, referee
from fuzz.table import Doubt, Table, TooLong
from truebreak.exact import ExactEngine
from truebreak.scenarios import Circle, Pocket, Scene, Wall, catalogue

SEEDS = 8
"""Cases of each kind: together about half a minute of one processor."""


@pytest.mark.parametrize("kind", KINDS)
def test_the_engine_is_right(kind):
    verdicts = [examine(kind, seed) for seed in range(SEEDS)]
    wrong = [f"--replay {v.kind} {v.seed}: {v.message}" for v in verdicts if v.outcome in ("failure", "hang")]
    assert not wrong, "\n".join(wrong)
    given_up = [v for v in verdicts if v.outcome in ("undecided", "budget") and not v.endless]
    assert len(given_up) <= 1, [v.message for v in given_up]
    assert sum(v.outcome == "skipped" for v in verdicts) <= SEEDS // 4


# -- the witness by hand


def speeds(told: Told) -> list[tuple[float, float]]:
    """vx, vy of every circle at the end."""
    return [(float(told.number(vx).mid()), float(told.number(vy).mid())) for _, _, vx, vy in told.final]


def times(told: Told) -> list[float]:
    """Times of the events."""
    return [float(told.number(event.time).mid()) for event in told.events]


@pytest.mark.parametrize(("policy", "expected"), [
    ("simultaneous", (-2, -1, 0)),
    ("sequential:order=scene", (F(-11, 5), F(-8, 25), F(-3, 25))),
    ("sequential:seed=0", (F(-8, 5), F(-39, 25), F(1, 25))),
])  # fmt: skip
def test_lee(policy, expected):
    scene = catalogue.build("lee").with_changes(tie_policy=policy)
    assert [vx for vx, _ in speeds(referee(scene, events=1))] == pytest.approx([float(v) for v in expected])


@pytest.mark.parametrize(("policy", "expected"), [
    ("simultaneous", [(-1 / 5, 0), (3 / 5, 3**0.5 / 5), (3 / 5, -(3**0.5) / 5)]),
    ("sequential", [(-1 / 8, -(3**0.5) / 8), (3 / 4, 3**0.5 / 4), (3 / 8, -(3**0.5) / 8)]),
])  # fmt: skip
def test_one_onto_two(policy, expected):
    circles = [Circle(0, 0, vx=1), Circle("3 + sqrt(3)", 1), Circle("3 + sqrt(3)", -1)]
    told = referee(Scene(circles, tie_policy=policy))
    assert [v for row in speeds(told) for v in row] == pytest.approx([v for row in expected for v in row])
    assert told.stop == "QUIET"


@pytest.mark.parametrize("policy", ["simultaneous", "sequential", "sequential:seed=3"])
def test_the_cradle(policy):
    told = referee(Scene([Circle(-4, 0, vx=1), *(Circle(2 * k, 0) for k in range(5))], tie_policy=policy))
    assert [vx for vx, _ in speeds(told)] == [0, 0, 0, 0, 0, 1]
    assert len(told.events[0].impulses) == 5
    assert times(told) == [2]


def test_a_corner_of_ninety_degrees():
    told = referee(Scene([Circle(4, 4, vx=-1, vy=-2)], [Wall(0, 0, 0, 1), Wall(0, 0, 1, 0)]))
    assert times(told) == [1.5, 3]
    told = referee(Scene([Circle(4, 4, vx=-1, vy=-1)], [Wall(0, 0, 0, 1), Wall(0, 0, 1, 0)]))
    assert times(told) == [3]
    assert speeds(told) == [(1, 1)]


@pytest.mark.parametrize("late", [F(0), F(1, 10**100), F(-1, 10**100)])
def test_a_flaw_is_no_zero(late):
    one, two = [Circle(0, 0, vx=1), Circle(4, 1)], [Circle(-late, 10, vx=1), Circle(4, 11)]
    told = referee(Scene(one + two))
    assert [len(event.contacts) for event in told.events] == ([2] if late == 0 else [1, 1])


@pytest.mark.parametrize("aside", [F(0), F(1, 10**100)])
def test_nor_is_its_square(aside):
    """Head-on, and 10**-100 aside: that blow comes 10**-200 / 4 later."""
    told = referee(Scene([Circle(0, 0, vx=1), Circle(4, aside), Circle(0, 10, vx=1), Circle(4, 10)]), until=3)
    assert len(told.events) == (1 if aside == 0 else 2)


def test_a_graze_is_no_contact_and_less_is():
    for offset, hits in ((F(2), 0), (2 - F(1, 10**100), 1), (2 + F(1, 10**100), 0)):
        assert len(referee(Scene([Circle(0, 0, vx=1), Circle(5, offset)])).events) == hits


def test_entries_of_one_instant():
    """Circle by circle, pocket by pocket; the wall turns c2 away from the rim that it just reaches."""
    circles = [Circle(0, 0, vx=1), Circle(0, 20, vx=1)]
    pockets = [Pocket(10, -3, 5), Pocket(10, 3, 5), Pocket(8, 20, 2)]
    told = referee(Scene(circles, [Wall(7, 0, 7, 1)], pockets=pockets))
    assert [(e.circle, e.pocket) for e in told.entries] == []
    told = referee(Scene(circles, pockets=pockets))
    assert [(e.circle, e.pocket) for e in told.entries] == [(0, 0), (0, 1), (1, 2)]
    assert (told.stop, times(told)) == ("QUIET", [])


def test_a_blow_may_send_in_what_grazes_or_leaves():
    pocket = Pocket(0, -5, 5)
    graze = Circle(-2, 0, vx=1)
    told = referee(Scene([graze, Circle(0, 6, vy=-2)], pockets=[pocket]))
    assert [(e.circle, float(told.number(e.time).mid())) for e in told.entries] == [(0, 2)]
    leaving = Circle(0, -2, vy=1)
    told = referee(Scene([leaving, Circle(0, 6, vy=-2)], pockets=[pocket]))
    assert [e.circle for e in told.entries] == [0]


def test_captured_circles_rest_and_nothing_meets_them():
    told = referee(Scene([Circle(0, 0, vx=1), Circle(-9, 0, vx=3)], pockets=[Pocket(3, 0, 2)], capture=True), until=9)
    assert [e.circle for e in told.entries] == [0, 1]
    assert not told.events
    assert speeds(told) == [(0, 0), (0, 0)]


def test_there_and_back():
    told = referee(Scene([Circle(0, 0, vx=1)], [Wall(3, 0, 3, 1)], reverse_at=5))
    assert (told.stop, times(told), float(told.number(told.final_time).mid())) == ("HORIZON", [2, 8], 10)
    assert speeds(told) == [(-1, 0)]


def test_a_disc_without_room_ends_the_history():
    scene = Scene([Circle(0, 0, vx=1, vy=1)], [Wall(0, 1, 1, 1), Wall(0, -1, 1, -1)])
    assert referee(scene, until=1).stop == "ENDLESS"


def test_doubt_is_said_and_more_bits_settle_it():
    scene = Scene([Circle(0, 0, vx=1), Circle(4, 0)])
    table = Table(scene, 768)
    with pytest.raises(Doubt):
        table.sign(fmpz(1) << 300)
    assert (table.sign(fmpz(1) << 100), table.sign(-fmpz(1) << 500)) == (0, -1)
    far = Scene([Circle(0, 0, vx=1), Circle(4, 2 - F(1, 10**180))])
    assert referee(far, bits=768).bits > 768


def test_rattling_without_end_is_too_long():
    scene = Scene([Circle(0, 0, vy=1)], [Wall(0, 1, 1, 1), Wall(0, F(-1) - F(1, 10**40), 1, F(-1) - F(1, 10**40))])
    with pytest.raises(TooLong):
        referee(scene, until=1)


def test_two_precisions_tell_the_same():
    for kind in KINDS:
        case = case_of(kind, 0)
        one, two = (referee(case.scene, case.until, case.events, bits) for bits in (2048, 3333))
        assert [(e.contacts, e.impulses) for e in one.events] == [(e.contacts, e.impulses) for e in two.events]
        for (when, _), (then, _) in zip(one.knots, two.knots, strict=True):
            assert abs(one.number(when) - two.number(then)) < arb((1, -200))


# -- the harness sees what is wrong


def test_a_wrong_history_is_told():
    scene = Scene([Circle(0, 0, vx=1), Circle(4, 1)])
    run, told = ExactEngine().run(scene, until=10), referee(scene, until=10)
    compare(run, told)
    others = [
        (scene.with_changes(circles=[Circle(0, 0, vx=1), Circle(4, 1 + F(1, 10**40))]), 10),
        (scene.with_changes(circles=[Circle(0, 0, vx=1, m=2), Circle(4, 1)]), 10),
        (scene.with_changes(reverse_at=9), 10),
        (scene.with_changes(pockets=[Pocket(1, 0, F(1, 2))]), 10),
        (scene, 11),
        (scene, 1),
    ]
    for other, until in others:
        with pytest.raises(Difference):
            compare(run, referee(other, until=until))


def test_cases_are_the_same_on_every_machine():
    for kind in KINDS:
        assert case_of(kind, 3).scene.digest == case_of(kind, 3).scene.digest
    assert len({case_of(kind, seed).scene.digest for kind in KINDS for seed in range(4)}) > 3 * len(KINDS)


def test_stress_goes_on_where_it_stopped(tmp_path):
    out = tmp_path / "fuzz.jsonl"
    command = [sys.executable, str(Path(__file__).with_name("stress.py")), "--kinds", "gas,grid", "--out", str(out)]
    subprocess.run([*command, "--scenes", "4"], capture_output=True, check=False)
    with out.open("a") as file:
        file.write('{"kind": "gas", "se')  # as if it had been killed while it wrote
    done = subprocess.run([*command, "--scenes", "8"], capture_output=True, text=True, check=False)
    rows = [json.loads(line) for line in out.read_text().splitlines() if line.endswith("}")]
    assert sorted((row["kind"], row["seed"]) for row in rows) == [(k, n) for k in ("gas", "grid") for n in range(4)]
    assert "4/4 scenes" in done.stderr
