"""A comparison that is saved, or pickled, is had again: every verdict, number and report."""

from __future__ import annotations

import json
import pickle
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from command_line import said

import truebreak as tb
from truebreak.compare import Comparison, compare, comparison_json
from truebreak.compare.foreign.log_engine import LogEngine
from truebreak.compare.report.html import html_report
from truebreak.compare.report.schema import schema
from truebreak.compare.saved_comparisons import comparison_of, saved_comparison
from truebreak.scenarios import Circle, Scene, SceneError, Wall, catalogue
from truebreak.scenarios.disk import digest


def of(name: str, *engines: Any, **limits: Any) -> Comparison:
    return compare(catalogue.build(name), list(engines), **limits)


def with_a_log() -> Comparison:
    scene = catalogue.build("near-tie:k=2")
    log = LogEngine.of([(1.0, "left", "middle"), (1.005, "middle", "right")], scene)
    return compare(scene, [log], events=2)


def there_and_back() -> Comparison:
    return compare(catalogue.build("gas:n=3").with_changes(reverse_after=4), ["double"])


def closing() -> Comparison:
    walls = [Wall(0, 0, 0, 1, id="left"), Wall(9, 0, 9, 1, id="right", vx=-2)]
    return compare(Scene([Circle(3, 0, vx=1, id="ball")], walls), ["double", "pymunk"])


CASES = {
    "near-tie": lambda: of("near-tie:k=40", "double", "interval", events=4),
    "gas": lambda: of("gas:n=3", "single", "quad", "pymunk:dt=1/64", events=18),
    "roots": lambda: of("rack:rows=2", "double", "interval:bits=30", events=4),
    "patterns": lambda: of("lee", "pymunk", "double"),
    "there and back": there_and_back,
    "a log": with_a_log,
    "bounces to an end": lambda: of("bounce", "double", "pymunk"),
    "walls that close": closing,
    "pegs under gravity": lambda: of("plinko", "double", events=20),
    "segments under gravity": lambda: of("platforms", "double", "pymunk", events=20),
    "arcs, and an engine that has none": lambda: of("stadium", "double", "pymunk", events=20),
}


@pytest.mark.parametrize("way", ["file", "pickle"])
@pytest.mark.parametrize("kind", CASES)
def test_a_comparison_is_had_again(kind: str, way: str) -> None:
    found = CASES[kind]()
    text = saved_comparison(found)
    again: Comparison = comparison_of(text) if way == "file" else pickle.loads(pickle.dumps(found))
    assert comparison_json(again) == comparison_json(found)
    assert html_report(again) == html_report(found)
    for mine, its in zip(again.reference.events, found.reference.events, strict=True):
        assert mine.time.digits(200) == its.time.digits(200)
        assert mine.time.text() == its.time.text()
    mine, its = again.reference.ending, found.reference.ending
    assert (mine is None and its is None) or mine.digits(200) == its.digits(200)
    for mine, its in zip(again.candidates, found.candidates, strict=True):
        end = float(its.trajectory.final_time)
        times = [end * k / 5 for k in range(5)]
        assert (mine.trajectory.sample(times) == its.trajectory.sample(times)).all()
        assert [float(e.time) for e in mine.trajectory.events] == [float(e.time) for e in its.trajectory.events]
    if way == "file":
        assert saved_comparison(again) == text


def test_the_file_holds_the_report_for_any_reader() -> None:
    found = CASES["near-tie"]()
    data = json.loads(saved_comparison(found))
    assert data["comparison"] == json.loads(json.dumps(comparison_json(found)))
    jsonschema.Draft202012Validator(schema("saved-comparison-1")).validate(data)
    jsonschema.Draft202012Validator(schema("comparison-5")).validate(data["comparison"])


def test_the_reference_goes_on_from_there() -> None:
    again = comparison_of(saved_comparison(of("gas:n=3", "double", events=5)))
    assert len(tb.resume(again.reference, events=9).events) == 9


def test_the_command_line(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    file = tmp_path / "found.json"
    words = ("compare", "near-tie:k=40", "--engines", "double", "--events", "2", "--json")
    code, out, _ = said(capsys, *words, "--save", str(file))
    told, kept = json.loads(out), comparison_json(tb.load_comparison(file))
    assert code == 1
    assert told == json.loads(json.dumps(kept))
    assert list(tmp_path.iterdir()) == [file]
    code, out, err = said(capsys, *words, "--save", str(tmp_path / "no" / "found.json"))
    assert (code, out, err.count("\n")) == (2, "", 1)


def test_what_no_file_can_hold_is_told() -> None:
    found = compare(catalogue.build("lee"), ["double"], outcomes={"odd": lambda _: Path("x")})
    with pytest.raises(SceneError, match="cannot be saved as JSON; pickle it"):
        saved_comparison(found)
    with pytest.raises(SceneError, match="cannot be saved as JSON"):
        saved_comparison(of("point", "sympy", events=1, causes=False))


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("", "is not a saved comparison"),
        ('{"schema": "truebreak/saved-comparison-1", "ver', "is damaged"),
        ('{"schema": "truebreak/run-1"}', "is not a saved comparison"),
        ('{"schema": "truebreak/saved-comparison-1", "version": "0.0.1"}', "was saved by truebreak '0.0.1'"),
        ("[" * 100_000, "is not a saved comparison"),
    ],
)
def test_what_is_none_is_refused_in_one_line(text: str, told: str) -> None:
    with pytest.raises(SceneError, match=told) as error:
        comparison_of(text)
    assert "\n" not in str(error.value)


def test_one_changed_letter_is_told() -> None:
    text = saved_comparison(CASES["near-tie"]())
    place = text.index("middle")
    with pytest.raises(SceneError, match="is damaged"):
        comparison_of(f"{text[:place]}M{text[place + 1 :]}")


def test_nothing_else_is_made_of_a_file() -> None:
    data = json.loads(saved_comparison(CASES["near-tie"]()))
    data.pop("digest")
    data["objects"] = {"is": "os:system", "of": ["true"]}
    with pytest.raises(SceneError, match="is damaged"):
        comparison_of(json.dumps({**data, "digest": digest(data)}))


def test_a_file_is_read_whatever_room_a_class_was_in_when_it_was_written() -> None:
    text = saved_comparison(CASES["near-tie"]())
    data = json.loads(text.replace("scenarios.trajectory:", "scenarios.runs.elsewhere:"))
    assert data != json.loads(text)
    data.pop("digest")
    assert saved_comparison(comparison_of(json.dumps({**data, "digest": digest(data)}))) == text


def test_no_file_at_all(tmp_path: Path) -> None:
    for path in (tmp_path / "none.json", tmp_path):
        with pytest.raises(SceneError, match=r"no such file|is a directory") as error:
            tb.load_comparison(path)
        assert "\n" not in str(error.value)
