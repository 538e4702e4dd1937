"""What the page is answered: the comparison's own words, within its seconds, and nothing for what is no scene."""

from __future__ import annotations

import json
import math
import subprocess
import sys
from itertools import count
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from truebreak.compare import Comparison, compare
from truebreak.compare.play import messages
from truebreak.compare.play.messages import (
    KINDS,
    MOST_CIRCLES,
    ONE_BIT_OFF,
    READING_SHARE,
    WITHOUT_NUMPY,
    answer,
    beside,
    one_bit_off,
    python_of,
)
from truebreak.compare.report.answers import answers, verdict_line
from truebreak.compare.report.player import recording
from truebreak.scenarios import Circle, Scene, catalogue
from truebreak.scenarios.files import loads_toml


def asked(**message: Any) -> dict[str, Any]:
    """The last answer to a message, as it goes over a wire."""
    told: list[dict[str, Any]] = []
    answer(message, told.append)
    assert all(one["kind"] == "progress" for one in told[:-1])
    return json.loads(json.dumps(told[-1], allow_nan=False))


NAMES = [name for name in catalogue.names() if len(catalogue.build(name).circles) <= MOST_CIRCLES]


@pytest.mark.parametrize("name", [name for name in NAMES if name != "beads"])  # undecided before its first event
def test_a_run_is_the_comparison_that_a_report_shows(name: str) -> None:
    scene = catalogue.build(name)
    found = asked(kind="run", scene=scene.data(), events=30, seconds=60, why=True)
    true = compare(scene, ["double"], events=30, alternatives=False)
    assert (found["verdict"], found["tone"]) == (verdict_line(true), true.verdict)
    told = answers(true)
    assert (found["why"]["where"], found["why"]["why"]) == (told.where, told.why)
    shown = json.loads(json.dumps(recording(true)))
    assert (shown is None) == (name == "article")
    assert shown is not None or found["recording"] is None
    assert found["exact"]["proved"] and found["exact"]["events"] == len(true.reference.events)
    if shown is None:
        return
    assert found["recording"]["runs"][0] == shown["runs"][0]
    assert found["recording"]["runs"][1]["knots"] == shown["runs"][1]["knots"]


def test_every_scene_of_the_catalogue_is_offered_with_its_picture() -> None:
    rows = asked(kind="names")["names"]
    assert [row["name"] for row in rows] == NAMES and len(NAMES) >= 24
    for row in rows:
        assert row["picture"].startswith("<svg") and row["scene"] == catalogue.build(row["name"]).data()
    assert asked(kind="scene", name="galperin:n=2")["scene"] == catalogue.build("galperin:n=2").data()


@pytest.mark.parametrize(
    ("message", "part"),
    [
        ({"kind": "run"}, "scene"),
        ({"kind": "run", "scene": []}, "scene"),
        ({"kind": "run", "scene": {"circle": 3}}, "not a list"),
        ({"kind": "run", "scene": {"circle": [{"id": "a", "x": "0", "y": "0", "r": "1"}] * 10_000}}, "10,000"),
        ({"kind": "run", "scene": {"circle": [{"id": "a", "x": "9" * 1000, "y": "0", "r": "1"}]}}, "400 characters"),
        ({"kind": "run", "scene": {"circle": [{"id": "a", "x": "9**9**9", "y": "0", "r": "1"}]}}, "power"),
        ({"kind": "run", "scene": {"circle": [{"id": "a", "x": "1+" * 150 + "(" * 90, "y": "0", "r": "1"}]}}, "x ="),
        ({"kind": "run", "scene": {"circle": [{"id": "a", "x": 0.5, "y": 0, "r": 1}]}}, "not a number"),
        ({"kind": "run", "scene": {"circle": [{"id": "<script>", "x": "0", "y": "0", "r": "-1"}]}}, "positive"),
        ({"kind": "run", "scene": {"circle": [{"id": "a", "x": "0", "y": "0", "r": "1"}], "gravity": "1"}}, "gravity"),
        ({"kind": "run", "scene": catalogue.build("lee").data(), "engines": ["os:system"]}, "does not run here"),
        ({"kind": "run", "scene": catalogue.build("lee").data(), "engines": []}, "one to three"),
        ({"kind": "run", "scene": catalogue.build("lee").data(), "events": 10**9}, "5,000"),
        ({"kind": "run", "scene": catalogue.build("lee").data(), "seconds": 1e9}, "60"),
        ({"kind": "run", "scene": catalogue.build("reversal").data(), "back": 3}, "turns back by itself"),
        (
            {"kind": "run", "scene": catalogue.build("lee").data(), "back": 300},
            "and the run has 1; ask for 2 at most",
        ),
        (
            {"kind": "run", "scene": catalogue.build("bounce").data(), "back": 3},
            "9/10: each hit loses energy",
        ),
        ({"kind": "run", "scene": catalogue.build("beads").data()}, "push each other without end"),
        ({"kind": "run", "scene": Scene([Circle(0, 0)]).data()}, "nothing happens: no further collision"),
        ({"kind": "scene", "name": "../../etc/passwd"}, "passwd"),
        ({"kind": "scene", "name": "gas:n=5000"}, "at most"),
        ({"kind": ["run"]}, "not known"),
        ({}, "not known"),
    ],
)
def test_what_is_no_message_is_refused_in_one_line(message: dict[str, Any], part: str) -> None:
    found = asked(**message)
    assert found["kind"] == "refused"
    assert part in found["error"] and "\n" not in found["error"]


def test_the_seconds_are_one_budget_over_all_that_a_run_is_made_of(monkeypatch: pytest.MonkeyPatch) -> None:
    """By a clock that goes on by a tenth whenever it is looked at: what is given on is what is left then."""
    looked, given = count(), list[float]()

    def measured(*args: Any, **options: Any) -> Comparison:
        given.append(options["max_seconds"])
        return compare(*args, **{**options, "max_seconds": None, "progress": None})

    def after(found: Comparison, seconds: float) -> Comparison:
        given.append(seconds)
        return beside(found, 60)

    monkeypatch.setattr(messages, "clock", SimpleNamespace(perf_counter=lambda: next(looked) / 10))
    monkeypatch.setattr(messages, "compare", measured)
    monkeypatch.setattr(messages, "beside", after)
    for seconds in (1, 10):
        told = asked(kind="run", scene=catalogue.build("gas").data(), events=20, seconds=seconds, ulp=True)
        assert told["kind"] == "ran"
        room = (1 - READING_SHARE) * seconds
        assert given[-2:] == pytest.approx([room - 0.1, room - 0.2])
        assert told["seconds"] == pytest.approx(0.3)
    asked(kind="run", scene=catalogue.build("gas").data(), events=20, seconds=0.05, ulp=True)
    assert given[-2:] == [0.1, 0.1], "a moment is given always"


def test_a_run_is_cut_when_its_seconds_are_over() -> None:
    found = asked(kind="run", scene=catalogue.build("echo").data(), events=5000, seconds=0.02)
    cut_short(found)


def cut_short(found: dict[str, Any]) -> None:
    """Fewer events than were asked for, all of them proved; or none in time, which is said."""
    if found["kind"] == "refused":
        assert "in time" in found["error"]
    else:
        assert found["kind"] == "ran" and found["exact"]["proved"]
        assert found["exact"]["events"] < 5000


def test_one_bit_is_one_bit() -> None:
    scene = catalogue.build("gas")
    near = one_bit_off(scene)
    apart = [
        (key, float(getattr(a, key)), float(getattr(b, key)))
        for a, b in zip(scene.circles, near.circles, strict=True)
        for key in ("x", "y", "r", "vx", "vy")
        if getattr(a, key) != getattr(b, key)
    ]
    assert [(key, b) for key, _, b in apart] == [("x", math.nextafter(apart[0][1], math.inf))]
    found = asked(kind="run", scene=scene.data(), events=300, ulp=True)
    assert [run["name"] for run in found["recording"]["runs"]] == ["exact", "double", ONE_BIT_OFF]
    double, other = found["recording"]["runs"][1:]
    assert double["errors"][0][1] == 0 or double["errors"][0][1] != other["errors"][0][1]
    assert other["divergence"] is not None


@pytest.mark.parametrize("count", [20, 150])
def test_the_exact_run_comes_home_and_doubles_do_as_long_as_their_digits_last(count: int) -> None:
    found = asked(kind="run", scene=catalogue.build("gas").data(), back=count, seconds=30)
    assert found["home"] == 0
    (double,) = found["others"]
    assert double["home"] > 0
    assert (double["home"] < 1e-6) == (count == 20)


@pytest.mark.parametrize("name", NAMES)
def test_what_is_taken_away_is_the_scene(name: str) -> None:
    scene = catalogue.build(name)
    found = asked(kind="texts", scene=scene.data(), events=5)
    assert loads_toml(found["toml"]).digest == scene.digest
    space: dict[str, Any] = {}
    exec(python_of(scene, ["double"], 5).rpartition("\nprint")[0], space)
    assert space["scene"].digest == scene.digest
    assert found["command"] == f"truebreak compare {name} --engines double --events 5"


def test_the_certificate_is_verified() -> None:
    from truebreak.compare.certificate.certified import verdict

    found = asked(kind="certificate", scene=catalogue.build("gas").data(), events=40, seconds=20)
    assert found["events"] == 40
    assert verdict(found["text"])[0] == 0


def test_every_kind_of_message_is_answered() -> None:
    scene = catalogue.build("lee").data()
    assert {kind: asked(kind=kind, scene=scene, name="lee")["kind"] for kind in KINDS} == {
        **{kind: kind for kind in KINDS},
        "run": "ran",
    }


# -- Where there is nothing but python-flint, as in a browser.

ABSENT = ("numpy", "pymunk", "jinja2", "markupsafe", "click", "rich", "sympy", "mpmath", "platformdirs")

ALONE = f"""
import json, sys

class Absent:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in {ABSENT!r}:
            raise ModuleNotFoundError(f"No module named {{name!r}}", name=name)

sys.meta_path.insert(0, Absent())
from truebreak.compare.play import messages
messages.util.find_spec = lambda name: None
told = []
for line in sys.stdin:
    messages.answer(json.loads(line), told.append)
print(json.dumps([one for one in told if one["kind"] != "progress"], allow_nan=False))
"""


def test_without_numpy_and_the_rest_it_is_the_same(tmp_path: Path) -> None:
    """Histories, divergences and words; numbers as far as doubles carry them."""
    made = [{"kind": "run", "scene": catalogue.build(name).data(), "events": 40, "why": True} for name in NAMES]
    made += [{"kind": "run", "scene": catalogue.build("gas").data(), "events": 200, "ulp": True}]
    made += [{"kind": "certificate", "scene": catalogue.build("lee").data()}, {"kind": "names"}]
    done = subprocess.run(
        [sys.executable, "-c", ALONE],
        input="\n".join(map(json.dumps, made)),
        capture_output=True,
        text=True,
        cwd=tmp_path,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    alone = json.loads(done.stdout)
    assert alone[-1]["engines"] == list(WITHOUT_NUMPY)
    for message, mine in zip(made[:-1], alone, strict=False):
        theirs = asked(**message)
        assert mine["kind"] == theirs["kind"], mine
        if mine["kind"] != "ran":
            assert mine == theirs
            continue
        assert mine["verdict"] == theirs["verdict"]
        assert (mine["recording"] is None) == (theirs["recording"] is None)
        both = [(one["recording"] or {"runs": []})["runs"] for one in (mine, theirs)]
        for one, other in zip(*both, strict=True):
            assert one["events"] == other["events"] and one.get("divergence") == other.get("divergence")
            assert one["times"] == other["times"]
            assert one["knots"] == [pytest.approx(row, rel=3e-7, abs=3e-7) for row in other["knots"]]
            for (t, a), (u, b) in zip(one.get("errors") or (), other.get("errors") or (), strict=True):
                assert t == u and (a == b or abs(a - b) < 1e-13 + 1e-3 * abs(b))
        if message.get("why"):
            said, full = (one["why"]["why"] for one in (mine, theirs))
            said = said.removesuffix(" Whether errors grow on the way is not known.")
            assert full.startswith(said), "all but how fast errors grow, which takes NumPy"
            assert mine["why"]["where"] == theirs["why"]["where"]
