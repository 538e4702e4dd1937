"""Files whose digest is right and whose contents are not: each is refused in one line, or is taken for what it says."""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from command_line import said
from mutated import mutated

import truebreak as tb
from truebreak.compare import compare
from truebreak.compare.files.saved import GoingOn, run_of, saved_run
from truebreak.compare.grids.suite_file import parsed_suite, read_report, run_suite, since, suite_json
from truebreak.compare.report.grid_tables import print_suite
from truebreak.compare.saved_comparisons import comparison_of, saved_comparison
from truebreak.scenarios import SceneError, catalogue
from truebreak.scenarios.disk import digest

RUNS: dict[str, Callable[[], Any]] = {
    "gas": lambda: tb.run(tb.scene("gas:n=4"), events=12),
    "pockets": lambda: tb.run(tb.scene("rack:rows=2,pockets=yes"), events=6),
    "there and back": lambda: tb.run(tb.scene("gas:n=3").with_changes(reverse_after=3, until=None, events=None)),
}

SEEDS = 60
"""Mutations of each file in the ordinary tests; tens of thousands behind `slow`."""


@cache
def run_data(kind: str) -> dict[str, Any]:
    return json.loads(saved_run(RUNS[kind]()))


@cache
def comparison_data(scene: str) -> dict[str, Any]:
    found = compare(catalogue.build(scene), ["double", "interval", "pymunk:dt=1/64"], events=4)
    return {key: part for key, part in json.loads(saved_comparison(found)).items() if key != "comparison"}


def sealed(data: dict[str, Any]) -> str:
    """The text of a file with the digest that belongs to its contents."""
    inner = {key: part for key, part in data.items() if key != "digest"}
    return json.dumps({**inner, "digest": digest(inner)})


def taken_up(text: str) -> None:
    """Reads a run, and goes on from it."""
    run = run_of(text, "forged.json")
    GoingOn.after(run, "forged.json").run(run.scene, events=len(run.events) + 3)


def outcome(read: Callable[[str], Any], text: str) -> str | None:
    """What is said of a forged file, in one line; None where it is taken. Anything else is a failure."""
    try:
        read(text)
    except SceneError as error:
        assert "\n" not in str(error)
        return str(error)
    return None


def assert_none_is_a_crash(read: Callable[[str], Any], data: dict[str, Any], seeds: range) -> None:
    told = [outcome(read, sealed(mutated(data, seed)[1])) for seed in seeds]
    assert sum(line is not None for line in told) > len(told) / 4  # the mutations do something


@pytest.mark.parametrize("kind", RUNS)
def test_a_forged_run_is_refused_or_gone_on_with(kind: str) -> None:
    assert_none_is_a_crash(taken_up, run_data(kind), range(SEEDS))


@pytest.mark.parametrize("scene", ["near-tie:k=40", "gas:n=3"])
def test_a_forged_comparison_is_refused_or_read(scene: str) -> None:
    assert_none_is_a_crash(comparison_of, comparison_data(scene), range(SEEDS))


@pytest.mark.slow
@pytest.mark.parametrize("kind", RUNS)
def test_many_forged_runs(kind: str) -> None:
    assert_none_is_a_crash(taken_up, run_data(kind), range(SEEDS, 5_000))


@pytest.mark.slow
@pytest.mark.parametrize("scene", ["near-tie:k=40", "gas:n=3"])
def test_many_forged_comparisons(scene: str) -> None:
    assert_none_is_a_crash(comparison_of, comparison_data(scene), range(SEEDS, 10_000))


@pytest.mark.parametrize(
    "change",
    [
        lambda data: data["knots"].append([]),
        lambda data: data["tape"].update(assumed="x"),
        lambda data: data["tape"].update(limits=[3, None, False]),
        lambda data: data["events"][5][0].__setitem__(3, ["ff", 0, 0, 0]),
        lambda data: data["plan"].update(bits=[]),
        lambda data: data["engine"].update(more=1),
    ],
    ids=["flights of a circle too many", "a count that is text", "a limit", "another time", "a plan", "a setting"],
)
def test_what_no_run_has_written_is_one_line(
    change: Callable[[Any], None], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """On the command line too, which says which file it is."""
    data = json.loads(json.dumps(run_data("gas")))
    change(data)
    file = tmp_path / "forged.json"
    file.write_text(sealed(data), encoding="utf-8")
    code, out, err = said(capsys, "run", "--resume", str(file), "--events", "14")
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert "forged.json" in err
    assert "save the run again" in err


def nested(value: Any, depth: int) -> Any:
    for _ in range(depth):
        value = [value]
    return value


@pytest.mark.parametrize(
    "objects",
    [
        nested(1, 400),
        {},
        {"array": [0], "type": "U400000000"},
        {"array": [], "type": "O"},
        {"is": "compare.comparison:Comparison", "has": {"__class__": 1}},
        {"call__": 1},
        {"roots": 1},
    ],
    ids=["nested", "empty", "an array of long texts", "an array of objects", "a class", "a method", "no form"],
)
def test_hostile_objects_are_one_line(objects: Any) -> None:
    data = {**comparison_data("gas:n=3"), "objects": objects}
    told = outcome(comparison_of, sealed(data))
    assert told is not None
    assert "is damaged" in told


SUITE = 'engines = ["single"]\nevents = 3\n[[scene]]\nname = "gas:n=3"\n[[scene]]\nname = "lee"\n'


def test_a_forged_report_of_a_suite_is_refused_or_compared(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    report = run_suite(parsed_suite(SUITE, "mine.toml"))
    file, refused = tmp_path / "earlier.json", 0
    for seed in range(300):
        told, data = mutated(json.loads(json.dumps(suite_json(report))), seed)
        file.write_text(json.dumps(data), encoding="utf-8")
        try:
            print_suite(report, since(read_report(str(file))[1], report))
        except SceneError as error:
            refused += 1
            assert "earlier.json" in str(error), told
            assert "\n" not in str(error), told
        shown = capsys.readouterr().out
        assert "\u202e" not in shown, told
    assert refused > 60
