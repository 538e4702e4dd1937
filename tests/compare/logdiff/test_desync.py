"""What is named of two logs is right, and where they do not tell, that is said."""

from __future__ import annotations

import json
import math
import random
import struct
import tracemalloc
from collections.abc import Callable
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from command_line import done as truebreak
from desync_trials import (
    contacts_only,
    every,
    full,
    hashes,
    hashes_and_states,
    states_only,
    touching,
)
from desync_worlds import NONE, Fault, PymunkWorld, run

from truebreak.compare.logdiff import pairing
from truebreak.compare.logdiff.desync import diff, report_json
from truebreak.compare.logdiff.verdict import Finding
from truebreak.compare.report.desync_page import desync_html
from truebreak.compare.report.schema import schema
from truebreak.compare.testing.golden import log_of
from truebreak.compare.validation import EngineError
from truebreak.exact import ExactEngine
from truebreak.floating import DoubleEngine
from truebreak.scenarios import catalogue

Lines = list[dict[str, Any]]
FAULTS = {
    Fault("none"): Finding.IDENTICAL,
    Fault("ulp", 0, 3): Finding.GREW,
    Fault("moved", 0, 3, 1e-6): Finding.START,
    Fault("dt", 0, 0, 0.5): Finding.START,
    Fault("gravity", 0, 0, 1e-3): Finding.START,
    Fault("garbage", 60, 5, 0.37): Finding.CHANGED,
    Fault("push", 60, 5, 1e-7): Finding.CHANGED,
    Fault("warm", 70): Finding.CHANGED,
    Fault("nan", 60, 2): Finding.CHANGED,
}


def pile(fault: Fault = NONE, seed: int = 2) -> Any:
    return run(PymunkWorld, seed, 12, "pile", 100, fault)


@pytest.fixture
def compared(tmp_path: Path) -> Callable[..., Any]:
    def compare(one: Lines | str, other: Lines | str, **options: Any) -> Any:
        paths = [tmp_path / name for name in ("a.jsonl", "b.jsonl")]
        for path, lines in zip(paths, (one, other), strict=True):
            text = lines if isinstance(lines, str) else "".join(json.dumps(line) + "\n" for line in lines)
            path.write_text(text, encoding="utf-8")
        return diff(*paths, **options)

    return compare


@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: fault.kind)
def test_each_fault_of_a_pile_is_named(fault: Fault, compared: Any) -> None:
    found = compared(full(pile()), full(pile(fault)))
    assert found.verdict.name is FAULTS[fault], found.line
    if fault.at:
        assert found.verdict.event == fault.at
    jsonschema.validate(report_json([found]), schema("diff-1"))
    json.dumps(report_json([found]), allow_nan=False)


@pytest.mark.parametrize("style", [every(8), states_only, touching, hashes, hashes_and_states, contacts_only])
@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: fault.kind)
def test_a_log_of_less_names_the_same_or_nothing(style: Any, fault: Fault, compared: Any) -> None:
    one, other = style(pile()), style(pile(fault))
    found = compared(one, other)
    allowed = (Finding.IDENTICAL,) if one == other else (FAULTS[fault], Finding.OPEN)
    assert found.verdict.name in allowed, found.line


def test_order_names_and_clock_are_no_difference(compared: Any) -> None:
    told = full(pile())
    mixed = json.loads(json.dumps(told))
    for line in mixed:
        random.Random(1).shuffle(line.get("contacts", []))
    assert compared(told, mixed).verdict.name is Finding.HARMLESS
    renamed = json.loads(json.dumps(told).replace('"b', '"entity-').replace('"wall', '"side-'))
    found = compared(told, renamed)
    assert found.verdict.name is Finding.IDENTICAL and found.found.names["b3"] == "entity-3", found.line
    later = [{**line, "time": line["time"] + 50.0} if "time" in line else line for line in told]
    assert compared(told, later).verdict.name is Finding.IDENTICAL
    again = [{**line, "step": line["step"] - 60} if line.get("step", 0) >= 60 else line for line in told]
    assert compared(told, again).verdict.name is Finding.IDENTICAL


def test_the_two_of_a_contact_have_no_order(compared: Any) -> None:
    states = {"a": [1.0, 0.0, 0.5, 0.0], "b": [3.0, 0.0, 0.25, 0.0], "c": [5.0, 0.0, 0.75, 0.0]}
    lines = [{"time": float(k), "contact": pair, "states": states} for k, pair in enumerate(("ab", "bc", "ab"), 1)]
    one, other = ([{**line, "contact": list(line["contact"])} for line in lines] for _ in range(2))
    other[1]["contact"] = ["c", "b"]
    assert compared(one, other).verdict.name is Finding.IDENTICAL


def test_what_a_log_lacks_is_said(compared: Any) -> None:
    told = full(pile())
    for other, why in (
        (told[:50], "ends before the other"),
        (told[:40] + told[41:], "has nothing for step 39"),
        (told[:41] + told[40:], "line 41 of"),
    ):
        found = compared(told, other)
        assert found.verdict.name is Finding.OPEN and why in found.verdict.why, found.line
    text = "".join(json.dumps(line) + "\n" for line in told)
    assert "is cut off in line 102" in compared(text, text[:-50]).verdict.why


def test_hashes_tell_where_and_no_more(compared: Any) -> None:
    found = compared("aa\nbb\ncc\n", "aa\nbb\ncd\n")
    assert (found.verdict.name, found.verdict.event) == (Finding.OPEN, 2)
    assert compared("0 aa\n1 bb\n", "0 aa\n1 bb\n").verdict.name is Finding.IDENTICAL


def test_a_hash_that_differs_alone_is_something_that_is_not_logged(compared: Any) -> None:
    lines = [{"step": k, "hash": f"{k:x}", "states": {"a": [k / 3]}} for k in range(9)]
    other = [{**line, "hash": "f"} if line["step"] > 4 else line for line in lines]
    found = compared(lines, other)
    assert (found.verdict.name, found.verdict.event) == (Finding.OPEN, 5) and "not logged" in found.verdict.why


def test_a_dropped_input_is_named(compared: Any) -> None:
    one = run(PymunkWorld, 3, 12, "pile", 100, NONE, inputs=True)
    other = run(PymunkWorld, 3, 12, "pile", 100, Fault("input", 60), inputs=True)
    found = compared(full(one), full(other))
    assert (found.verdict.name, found.verdict.event) == (
        Finding.CHANGED,
        other.hit,
    ) and "inputs" in found.verdict.why


def test_free_fields_are_compared_by_name(compared: Any) -> None:
    lines = [{"step": k, "states": {"a": [k / 3]}, "ms": 1.5} for k in range(9)]
    other = [{**line, "ms": 2.5} for line in lines]
    assert "--ignore ms" in compared(lines, other).verdict.why
    assert compared(lines, other, ignore=["ms"]).verdict.name is Finding.IDENTICAL


def test_no_number_on_both_sides_is_the_same_and_is_told(compared: Any) -> None:
    lines = [{"step": k, "states": {"a": [k / 3, math.nan]}} for k in range(9)]
    found = compared(lines, lines)
    assert found.verdict.name is Finding.IDENTICAL and "NaN" in found.verdict.notes[0]


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("", "is empty"),
        ('{"time": 1, "contact": ["a"]}\n', "must be two ids"),
        ('{"time": 1, "contact": ["a", "b"]}\n{"time": 2, "contact"\n{"time": 3, "contact": ["a", "b"]}\n', "line 2"),
        ('{"time": 1, "time": 2, "contact": ["a", "b"]}\n', "has 'time' twice"),
        ('{"step": 1, "states": {"a": ["x"]}}\n', "is no number"),
        ('{"step": 5, "hash": "a"}\n{"step": 9, "hash": "b"}\n{"step": 7, "hash": "c"}\n', "comes after step 9"),
        ('{"log": "truebreak/log-9"}\n{"step": 1, "hash": "a"}\n', "this version reads"),
        ('{"contact": ["a", "b"]}\n', "neither a step nor a time"),
        ("one two three\n", "neither a JSON object nor a hash"),
        ("step,hash\n1\n2,b\n", "has 1 cells"),
    ],
)
def test_a_log_that_cannot_be_read_is_refused_in_a_line(text: str, why: str, tmp_path: Path) -> None:
    name = "log.csv" if text.startswith("step,") else "log.jsonl"
    (tmp_path / name).write_text(text, encoding="utf-8")
    with pytest.raises(EngineError, match=why) as error:
        diff(tmp_path / name, tmp_path / name)
    assert "\n" not in str(error.value)


def test_logs_with_nothing_in_common_are_refused(compared: Any) -> None:
    with pytest.raises(EngineError, match="there is nothing to compare"):
        compared("0 aa\n1 bb\n", [{"time": 1.0, "contact": ["a", "b"]}])


def test_csv_is_read(compared: Any, tmp_path: Path) -> None:
    rows = ["step,id,x,y", *(f"{k},{i},{k / 3!r},{k / 7!r}" for k in range(9) for i in "ab")]
    paths = tmp_path / "one.csv", tmp_path / "two.csv"
    paths[0].write_text("\n".join(rows), encoding="utf-8")
    paths[1].write_text("\n".join(rows).replace("5,b,1.66", "5,b,1.76"), encoding="utf-8")
    found = diff(*paths)
    assert (found.verdict.name, found.verdict.event, found.verdict.first[0].body) == (Finding.CHANGED, 5, "b")


def test_a_lost_contact_in_a_log_of_events_is_a_change(compared: Any) -> None:
    rng = random.Random(4)
    lines = [{"time": k + rng.random(), "contact": rng.sample("abcdefg", 2)} for k in range(60)]
    other = [*lines[:30], *({**line, "time": line["time"] + 0.1 * rng.random()} for line in lines[31:])]
    found = compared(lines, other)
    assert found.verdict.name in (Finding.CHANGED, Finding.OPEN), found.line
    lost = compared(lines, lines[:30] + lines[31:])
    assert lost.verdict.name is Finding.OPEN and "event 30" in lost.verdict.why, lost.line


def test_the_command_says_the_verdict_first_and_exits_with_it(tmp_path: Path) -> None:
    paths = [str(tmp_path / name) for name in ("a.jsonl", "b.jsonl", "c.jsonl")]
    for path, fault in zip(paths, (NONE, NONE, Fault("garbage", 60, 5, 0.4)), strict=True):
        Path(path).write_text("".join(json.dumps(line) + "\n" for line in full(pile(fault))), encoding="utf-8")
    finished = truebreak("diff", *paths[:2])
    assert finished.returncode == 0 and finished.stdout.startswith("identical: ")
    finished = truebreak("diff", *paths)
    assert finished.returncode == 1 and finished.stdout.startswith("changed at event 60 by more than rounding: ")
    finished = truebreak("diff", paths[0], paths[2], "--json", "--html", str(tmp_path / "page.html"))
    data = json.loads(finished.stdout)
    jsonschema.validate(data, schema("diff-1"))
    assert (finished.returncode, data["verdict"], data["pairs"][0]["event"]) == (1, "changed", 60)
    assert "changed at event 60" in (tmp_path / "page.html").read_text(encoding="utf-8")
    for words in (("diff", paths[0]), ("diff", paths[0], str(tmp_path / "none"))):
        finished = truebreak(*words)
        assert finished.returncode == 2 and finished.stderr.count("\n") == 1


def test_numbers_in_another_order_are_compared_by_their_names(compared: Any) -> None:
    lines = [{"step": k, "states": {"a": [k / 3, k / 7]}} for k in range(9)]
    heads = [{"log": "truebreak/log-1", "fields": names} for names in (["x", "y"], ["y", "x"])]
    assert compared([heads[0], *lines], [heads[1], *lines]).verdict.name is not Finding.IDENTICAL
    other = [{**line, "states": {"a": line["states"]["a"][::-1]}} for line in lines]
    assert compared([heads[0], *lines], [heads[1], *other]).verdict.name is Finding.IDENTICAL


def test_whole_numbers_of_any_length_are_numbers(compared: Any) -> None:
    lines = [{"step": k, "states": {"a": [k, 10**400]}} for k in range(9)]
    assert compared(lines, lines).verdict.name is Finding.IDENTICAL
    assert compared(lines, [{"step": k, "states": {"a": [k, -(10**400)]}} for k in range(9)]).verdict.event == 0


def test_logs_are_read_in_memory_that_does_not_grow_with_them(tmp_path: Path) -> None:
    """Equal logs, and such with independent events in another order throughout."""

    def peak(events: int, swapped: bool) -> int:
        rng, lines = random.Random(1), []
        for k in range(events):
            pair = ("abcd", "efgh")[k % 2]
            row = {i: [rng.random(), rng.random()] for i in rng.sample(pair, 2)}
            lines.append(json.dumps({"time": k + rng.random() / 2, "contact": list(row), "states": row}))
        one, other = tmp_path / "a.jsonl", tmp_path / "b.jsonl"
        one.write_text("\n".join(lines), encoding="utf-8")
        if swapped:
            lines = [lines[k ^ 1] for k in range(events)]
        other.write_text("\n".join(lines), encoding="utf-8")
        del lines
        tracemalloc.start()
        found = diff(one, other)
        most = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        assert found.verdict.name is (Finding.HARMLESS if swapped else Finding.IDENTICAL), found.line
        return most

    for swapped in (False, True):
        peak(1_000, swapped)  # loads what is loaded once
        assert peak(16_000, swapped) < 1.1 * peak(8_000, swapped) + 50_000


def drift(steps: int = 40, bodies: int = 5, push: float = 0.0) -> Lines:
    """States alone of bodies that drift apart, each number with all its digits."""
    return [
        {"step": k, "states": {f"b{i}": [i + k * math.pi / (i + 3), k / (i + 7) + push] for i in range(bodies)}}
        for k in range(steps)
    ]


def test_a_body_that_one_run_has_alone_is_no_identity(compared: Any) -> None:
    told = drift()
    gone = [
        {**line, "states": {i: v for i, v in line["states"].items() if i != "b3" or line["step"] < 20}} for line in told
    ]
    for one, other in ((told, gone), (gone, told)):
        found = compared(one, other)
        assert (found.verdict.name, found.verdict.event) == (Finding.CHANGED, 20), found.line
    touching = [{**line, "contacts": [["b3", "b1"]]} for line in told]
    found = compared(touching, [{**line, "contacts": [["b3", "b1"]]} for line in gone])
    assert (found.verdict.name, found.verdict.event) == (Finding.CHANGED, 20), found.line
    hidden = [{**line, "states": {i: v for i, v in line["states"].items() if i != "b3"}} for line in told]
    back = [
        {**line, "states": {i: v for i, v in line["states"].items() if i != "b3" or line["step"] != 20}}
        for line in told
    ]
    for other in (hidden, back):  # it may be there, and not logged
        found = compared(told, other)
        assert found.verdict.name is Finding.OPEN and "has no state of b3" in found.verdict.why, found.line


def test_a_number_that_one_run_lacks_is_no_identity(compared: Any) -> None:
    told = drift()
    found = compared(told, [{**line, "spawned": "b9"} if line["step"] == 7 else line for line in told])
    assert (found.verdict.name, found.verdict.event) == (
        Finding.OPEN,
        7,
    ) and "alone has 'spawned'" in found.verdict.why
    found = compared(told, [{**line, "spawned": "b9"} for line in told], ignore=["spawned"])
    assert found.verdict.name is Finding.IDENTICAL, found.line


@pytest.mark.parametrize("zero", ["-0.0", "-0"], ids=["Python's", "printf's"])
def test_zeros_of_other_signs_are_not_the_same_to_the_last_bit(zero: str, compared: Any) -> None:
    lines = "".join(f'{{"step": {k}, "states": {{"a": [{k / 3!r}, 0]}}}}\n' for k in range(9))
    found = compared(lines, lines.replace("[1.0, 0]", f"[1.0, {zero}]"))
    assert (found.verdict.name, found.verdict.event) == (Finding.OPEN, 3) and "signs of zeros" in found.verdict.why


@pytest.mark.parametrize("form", ["%.6f", "%.9g", "single"])
def test_fewer_digits_in_one_log_are_no_other_start(form: str, compared: Any) -> None:
    told = drift()

    def short(value: float) -> float:
        return struct.unpack("f", struct.pack("f", value))[0] if form == "single" else float(form % value)

    printed = [{**line, "states": {i: [*map(short, v)] for i, v in line["states"].items()}} for line in told]
    for one, other in ((told, printed), (printed, told)):
        found = compared(one, other)
        assert found.verdict.name is Finding.OPEN and "log both alike" in found.verdict.why, found.line
    moved = [{**line, "states": {i: [short(v[0] + 0.01), v[1]] for i, v in line["states"].items()}} for line in told]
    assert compared(told, moved).verdict.name is Finding.START


def test_who_was_met_before_says_nothing_of_the_start_of_another(compared: Any) -> None:
    times = [0.1234567890123, 0.2345678901234, 0.3456789012345, 0.4567890123456, 0.5678901234567]
    told = [
        {"time": t, "contact": p}
        for t, p in zip(times, (["a", "b"], ["c", "d"], ["a", "e"], ["b", "c"], ["d", "e"]), strict=True)
    ]
    later = [{**line, "time": line["time"] + 1e-3 * (k > 1)} for k, line in enumerate(told)]
    found = compared(told, later)  # a was faster, or e came from elsewhere
    assert found.verdict.name is Finding.OPEN and "nothing is logged of e before" in found.verdict.why, found.line


def test_records_far_apart_do_not_tell_a_start_from_a_change(compared: Any) -> None:
    apart = [{**line, "step": 100 * line["step"]} for line in drift()]
    found = compared(apart, [apart[0], *({**line, "step": 100 * line["step"]} for line in drift(push=0.01)[1:])])
    assert found.verdict.name is Finding.OPEN and "another start, or a change since" in found.verdict.why, found.line


def test_bodies_of_other_ids_and_an_ulp_are_the_same_bodies(compared: Any) -> None:
    rng = random.Random(3)
    told = [
        {"time": (k + rng.random()) / 7, "contact": [f"d{k % 7}", f"d{(k * 3 + 1) % 7}"]}
        for k in range(60) if k % 7 != (k * 3 + 1) % 7
    ]  # fmt: skip
    rows = {f"d{i}": [rng.random(), rng.random()] for i in range(7)}
    for line in told:
        line["states"] = {i: [rows[i][0], rows[i][1] + line["time"]] for i in line["contact"]}
    other = json.loads(json.dumps(told).replace('"d', '"entity'))
    for line in other:
        line["states"] = {i: [math.nextafter(v, 9) for v in row] for i, row in line["states"].items()}
    found = compared(told, other)
    assert (found.verdict.name, found.found.names["d4"]) == (Finding.GREW, "entity4"), found.line


@pytest.mark.parametrize(("off", "named"), [(1e-16, Finding.GREW), (0.01, Finding.START)])
def test_the_body_that_starts_elsewhere_is_known_by_the_others(off: float, named: Finding, compared: Any) -> None:
    told = drift()
    other = json.loads(json.dumps(told).replace('"b', '"entity'))
    for line in other:
        line["states"]["entity3"][1] += off * (line["states"]["entity3"][1] + 1)
    found = compared(told, other)
    assert (found.verdict.name, found.verdict.event, found.verdict.first[0].body) == (named, 0, "b3"), found.line


def test_a_clock_that_begins_anew_in_one_of_two_logs_of_events_is_counted_on(compared: Any) -> None:
    rng = random.Random(4)
    told = [
        {"time": k + rng.random() / 2, "contact": ["a", "wall"], "states": {"a": [rng.random()]}} for k in range(90)
    ]
    again = [{**line, "time": line["time"] - 50} if k >= 50 else line for k, line in enumerate(told)]
    assert compared(told, again).verdict.name is Finding.IDENTICAL


def test_what_waits_for_its_like_is_bounded(compared: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    for name, most in (("WAITING", 400), ("MOST_LETTERS", 40_000), ("MOST_FRAMES", 50)):
        monkeypatch.setattr(pairing, name, most)
    most = [0, 0, 0]
    plain = pairing.ByBodies.feed

    def feed(self: Any, *words: Any) -> None:
        plain(self, *words)
        now = self.waiting.count, self.waiting.letters, max(map(len, self.frames))
        most[:] = [max(pair) for pair in zip(most, now, strict=True)]

    monkeypatch.setattr(pairing.ByBodies, "feed", feed)
    bullets = [{"time": k / 8, "contact": [f"bullet{k}", "tank"]} for k in range(2_000)]
    other = [{**line, "contact": [f"shot{line['contact'][0]}", "tank"]} for line in bullets]
    compared(
        [{"time": 0.0, "contact": ["tank", "tank2"]}, *bullets], [{"time": 0.0, "contact": ["tank", "tank2"]}, *other]
    )
    frames = [{"time": k / 8, "states": {"a": [k / 3]}} for k in range(400)]
    compared(frames, [{**frames[0], "time": 0.0}, *({**line, "time": line["time"] * 1.3 + 999} for line in frames)])
    assert 100 < most[0] <= 402 and most[1] <= 40_200 and 20 < most[2] <= 51, most


@pytest.mark.parametrize("outline", ['"x"', '{"polygon": []}', '{"circle": 1e999}', '{"segment": [[0, 0]]}', "{}"])
def test_an_outline_that_is_none_is_refused(outline: str, compared: Any) -> None:
    lines = f'{{"body": "a", "outline": {outline}}}\n{{"step": 0, "states": {{"a": [0.5]}}}}\n'
    with pytest.raises(EngineError, match="line 1: outline of 'a'"):
        compared(lines, lines)


def test_pages_of_strange_ids_and_endless_numbers(compared: Any) -> None:
    lines = '{"step": 0, "states": {"\\ud800": [1e999, -1e308]}}\n{"step": 1, "states": {"\\ud800": [1e308, 1e308]}}\n'
    found = compared(lines, lines.replace("1e308]}}\n{", "1e307]}}\n{"))
    assert "ud800" in desync_html([found]).encode().decode()
    json.dumps(report_json([found]), allow_nan=False)


@pytest.mark.parametrize("drawn", [0.75, 5, "heads"])
def test_a_field_that_differs_by_far_more_than_the_states_is_not_of_their_rounding(drawn: Any, compared: Any) -> None:
    told = [{**line, "rng": 0.25, "energy": 1 / 3} for line in drift()]
    other = [
        {**line, "energy": math.nextafter(1 / 3, 1), "states": {
            i: [math.nextafter(x, 99) for x in row] for i, row in line["states"].items()}}
        for line in told
    ]  # fmt: skip
    assert compared(told, other).verdict.name is Finding.GREW
    found = compared(told, [{**line, "rng": drawn} if line["step"] > 19 else line for line in other])
    assert found.verdict.name is Finding.OPEN and "rng differs by more than that, first at step 20" in found.line


@pytest.mark.parametrize("times", [(1.0, 2.1), (1.0, 2.1, 3.0), (1.1, 2.0), (1.1, 2.0, 3.0)])
def test_one_time_that_differs_is_no_other_start_of_a_clock(times: tuple[float, ...], compared: Any) -> None:
    """The clock of a log may have been started at another time; where another contact has the same time, it was not."""
    pairs = (("a", "b"), ("a", "c"), ("a", "d"))
    one = [{"time": k + 1.0, "contact": [*pair]} for k, pair in zip(range(len(times)), pairs, strict=False)]
    other = [{**line, "time": time} for line, time in zip(one, times, strict=True)]
    assert compared(one, other).verdict.name is not Finding.IDENTICAL
    later = [{**line, "time": line["time"] + 0.5} for line in one]
    assert compared(one, later).verdict.name is Finding.IDENTICAL
    ends = [[*lines, {"end": end}] for lines in (one, later) for end in (5.0, 5.5)]
    assert compared(ends[0], ends[3]).verdict.name is Finding.IDENTICAL
    assert compared(ends[0], ends[2]).verdict.name is not Finding.IDENTICAL  # both end at one time: so is their start


def test_a_contact_that_is_left_out_early_is_a_change_where_all_before_is_the_same_to_the_last_bit(
    compared: Any,
) -> None:
    """Of the wall it is the second meeting; the bodies have the same states at three events before it."""
    whole, other = (DoubleEngine().run(catalogue.build(f"gas:n=3,seed={k}"), events=14) for k in (1, 2))

    def logged(run: Any, begin: int, end: int) -> Lines:
        return [
            {
                "time": float(event.time),
                "contact": [*map(str, event.impulses[0])],
                "states": {c.id: [c.x, c.y, c.vx, c.vy] for c in run.after(event.index).circles},
            }
            for event in run.events[begin:end]
        ]

    for k in (3, 4, 5):
        late = [line for line in logged(other, 0, 14) if line["time"] > float(whole.events[k].time)]
        late = [line for line in late if line["contact"] != [*map(str, whole.events[k].impulses[0])]]
        pair = compared(logged(whole, 0, 14), [*logged(whole, 0, k), *late])
        assert pair.verdict.name is Finding.CHANGED, (k, pair.verdict.line)


@pytest.mark.parametrize("name", ["lee", "rack:rows=2"])
def test_runs_that_part_at_a_tie_do_not_part_by_rounding(name: str, compared: Any) -> None:
    """Both keep the law, and no rounding has a part in it: one takes the contacts at once, the other in an order."""
    scene = catalogue.build(name)
    policies = ("simultaneous", "sequential:order=scene")
    runs = [DoubleEngine().run(scene.with_changes(tie_policy=policy), events=12) for policy in policies]
    found = compared(*map(log_of, runs), scene=scene)
    assert found.verdict.name is Finding.OPEN and "first states" not in str(found), found.line
    told = found.lawful.sentence
    assert told.startswith("both keep the law; they first differ at an instant of several contacts ("), told
    assert compared(log_of(runs[0]), log_of(runs[0]), scene=scene).lawful.sentence == "both keep the law"


def test_runs_that_part_by_rounding_are_said_to_do_so(compared: Any) -> None:
    scene = catalogue.build("gas:n=5")
    found = compared(
        log_of(DoubleEngine().run(scene, events=30)), log_of(ExactEngine().run(scene, events=30)), scene=scene
    )
    assert found.verdict.name is Finding.GREW
    assert found.lawful.sentence == "both keep the law; where they part, they part as runs do that round"


@pytest.mark.parametrize("steps", [1, 2])
def test_one_impulse_that_misses_the_law_is_not_said_to_miss_it_from_then_on(steps: int, compared: Any) -> None:
    scene = catalogue.build("gas:n=5").with_changes(until=None)
    run = DoubleEngine().run(scene, events=30)
    lines = [json.loads(line) for line in log_of(run).splitlines()]
    del lines[-1]  # what is pushed otherwise never comes to the contacts that are logged after it
    at = [k for k, line in enumerate(lines) if k > 8 and len(line.get("states", ())) == 1][:steps]
    lines = lines[: at[-1] + 1]
    for k in at:
        (row,) = lines[k]["states"].values()
        row[3] += 1e-3
    found = compared(log_of(run), lines, scene=scene).lawful.sentence
    assert "does not keep the law" in found and "on" not in found.split()[-3:], found
    assert ("2 steps miss it" in found) == (steps > 1), found


def test_one_state_that_differs_and_nothing_after_it_is_no_other_start(compared: Any) -> None:
    run = DoubleEngine().run(catalogue.build("gas:n=5"), events=60)
    lines = [json.loads(line) for line in log_of(run).splitlines()]
    first = next(iter(lines[1]["states"].values()))
    first[0] += 1e-3
    found = compared(log_of(run), lines)
    assert found.verdict.name is Finding.OPEN and "from the next record on" in found.line, found.line


def test_a_log_of_an_engine_in_single_is_not_told_to_log_more_digits(compared: Any) -> None:
    """Its numbers are not those of the other, rounded."""
    told = drift()

    def single(value: float) -> float:
        return struct.unpack("f", struct.pack("f", value * (1 + 2.0**-19)))[0]

    other = [{**line, "states": {i: [*map(single, v)] for i, v in line["states"].items()}} for line in told]
    why = compared(told, other).verdict.why
    assert "numbers of 24 bits" in why
    assert "17 digits" not in why
    assert "the two compute in different numbers" in why
