"""The two checkers say the same of what has the wrong shape, names what is not there, or stands in the wrong place."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from copy import deepcopy
from pathlib import Path
from random import Random
from typing import Any

import jsonschema
import pytest

from certificate.checkers import by_node, by_python, needs_node
from certificate.samples import built
from certificate.test_tampering import Told, altered, parts, shown_true
from truebreak.compare.certificate import certificate_json, certificate_of
from truebreak.compare.report.schema import schema
from truebreak.exact import ExactEngine
from truebreak.scenarios import Circle, Scene

VERIFIED, REFUTED, NO_CERTIFICATE, UNDECIDED = 0, 1, 2, 4

SCHEMA = jsonschema.Draft202012Validator(schema("certificate-3"))
LEE = certificate_of(built("lee"))
MIRROR = {"matrix": ["1", "0", "0", "-1"], "shift": ["0", "0"], "map": [[0, 1]]}


PAIRS = certificate_of(ExactEngine().run(Scene([Circle(0, 0, vx=1), Circle(4, 1), Circle(0, 9, vx=1), Circle(4, 10)])))
"""Two pairs that meet at once, at 4 - sqrt(3): shown in exact numbers."""

BY_SHIFT = {
    **PAIRS,
    "isometries": [{"matrix": ["1", "0", "0", "1"], "shift": ["0", "9"], "map": [[0, 2], [1, 3]]}],
    "instants": [
        PAIRS["instants"][0],
        {
            "time": PAIRS["instants"][1]["time"],
            "met": [[2, 3], [0, 1]],
            "rounds": [[[0, 1]], [[2, 3]]],
            "zeros": [["gap", [0, 1], 0]],
        },
    ],
    "end": {"reason": "quiet", "zeros": [["closing", [0, 2], 0], ["closing", [1, 3], 0]]},
}
"""The same, shown by an isometry."""


def with_first(told: Told = LEE, **values: Any) -> Told:
    """A certificate with other values in its first instant."""
    start, first, *others = told["instants"]
    return {**told, "instants": [start, {**first, **values}, *others]}


def with_scene(**values: Any) -> Told:
    """The same with other values in its scene."""
    return {**LEE, "scene": {**LEE["scene"], **values}}


def with_circle(circle: int, **values: Any) -> Told:
    """The same with other values of a circle."""
    circles = deepcopy(LEE["scene"]["circles"])
    circles[circle] |= values
    return with_scene(circles=circles)


RUNS_ON = [*LEE["instants"], {"met": [[0, 1]], "time": "9.0"}]

CASES: dict[str, tuple[int, Told | str]] = {
    "a contact that there is not": (REFUTED, with_first(met=[[0, 7]])),
    "a pocket that there is not": (REFUTED, with_first(met=[[0, -1]])),
    "a contact the wrong way round": (REFUTED, with_first(met=[[1, 0]])),
    "a round of what there is not": (REFUTED, with_first(rounds=[[[0, 7]]])),
    "an entry of what there is not": (REFUTED, with_first(enter=[[0, -3]])),
    "no witness where one is needed": (UNDECIDED, with_first(BY_SHIFT, zeros=[])),
    "another witness beside a false one": (
        VERIFIED, with_first(BY_SHIFT, zeros=[["gap", [0, 1], "back"], ["gap", [0, 1], 0]]),
    ),
    "a needed witness by a false way": (UNDECIDED, with_first(BY_SHIFT, zeros=[["gap", [0, 1], "back"]])),
    "a needed witness by an isometry that there is not": (
        NO_CERTIFICATE, with_first(BY_SHIFT, zeros=[["gap", [0, 1], 5]]),
    ),
    "a witness that nothing needs, by an isometry that there is not": (
        NO_CERTIFICATE, with_first(zeros=[["gap", [0, 1], len(LEE["isometries"])]]),
    ),
    "a name": (NO_CERTIFICATE, with_scene(name="lee")),
    "a digest": (NO_CERTIFICATE, with_scene(digest="0" * 64)),
    "roots of the scene's own": (VERIFIED, with_scene(roots=["2"])),
    "a number of the scene in a root that is not the scene's": (
        NO_CERTIFICATE, {**with_circle(0, x="-3+0*r1"), "roots": ["2"]},
    ),
    "a time in a root of the scene": (
        VERIFIED, {**with_first(exact="1+1*r1-1*r1"), "scene": {**LEE["scene"], "roots": ["2"]}},
    ),
    "a needed witness by a contact that there is not": (
        UNDECIDED, with_first(BY_SHIFT, zeros=[["gap", [0, 1], 0, [0, 7]]]),
    ),
    "a time that is not the one": (REFUTED, with_first(exact="2")),
    "a time of two long rows of digits": (
        VERIFIED, {**LEE, "instants": [{"time": f"{'0' * 100_000}.{'0' * 99_000}"}, *LEE["instants"][1:]]},
    ),
    "a time that is the one": (VERIFIED, with_first(exact="1")),
    "a time in a root that there is not": (NO_CERTIFICATE, with_first(exact="1*r1")),
    "impulses that are not so": (REFUTED, with_first(rounds=[[[0, 1, "1/9"], [1, 2, "3/2"]]])),
    "impulses of some": (NO_CERTIFICATE, with_first(rounds=[[[0, 1, "1/9"], [1, 2]]])),
    "a false isometry that nothing needs": (REFUTED, {**LEE, "isometries": [*LEE["isometries"], MIRROR]}),
    "an isometry of what there is not": (
        NO_CERTIFICATE, {**LEE, "isometries": [*LEE["isometries"], {**MIRROR, "map": [[0, 70]]}]},
    ),
    "an instant after the last event": (
        REFUTED, {**LEE, "end": {"reason": "events", "limit": 1}, "instants": RUNS_ON},
    ),
    "a contact of text": (NO_CERTIFICATE, with_first(met=[["0", "1"]])),
    "a contact of three": (NO_CERTIFICATE, with_first(met=[[0, 1, 2]])),
    "a contact before all circles": (NO_CERTIFICATE, with_first(met=[[-1, 1]])),
    "nothing arrives": (NO_CERTIFICATE, with_first(met=[])),
    "a round of none": (NO_CERTIFICATE, with_first(rounds=[[]])),
    "a question that nobody knows": (NO_CERTIFICATE, with_first(zeros=[["why", [0, 1], "back"]])),
    "a witness without a how": (NO_CERTIFICATE, with_first(zeros=[["gap", [0, 1]]])),
    "a policy with a seed that takes none": (NO_CERTIFICATE, with_scene(tie_policy="simultaneous:seed=2")),
    "two reversals": (NO_CERTIFICATE, with_scene(reverse_at="1", reverse_after=1)),
    "a horizon without a time": (NO_CERTIFICATE, {**LEE, "end": {"reason": "horizon"}}),
    "no events as a limit": (NO_CERTIFICATE, {**LEE, "end": {"reason": "events", "limit": 0}}),
    "an end without a name": (NO_CERTIFICATE, {**LEE, "end": {"reason": "boredom"}}),
    "an end that is not asked": (VERIFIED, {**LEE, "end": {"reason": "quiet", "until": "1/1000"}}),
    "no instant at all": (NO_CERTIFICATE, {**LEE, "instants": []}),
    "an id that comes twice": (NO_CERTIFICATE, with_circle(0, id=LEE["scene"]["circles"][1]["id"])),
    "an id that is a number": (NO_CERTIFICATE, with_circle(0, id=1)),
    "a circle without an id": (NO_CERTIFICATE, with_scene(circles=[{"x": "0"}, *LEE["scene"]["circles"][1:]])),
    "capture that is text": (NO_CERTIFICATE, with_scene(capture="no")),
    "a count that is truth": (NO_CERTIFICATE, {**LEE, "end": {"reason": "events", "limit": True}}),
    "bits that are truth": (NO_CERTIFICATE, {**LEE, "bits": True}),
    "a reversal after no event": (NO_CERTIFICATE, with_scene(reverse_after=0)),
    "a reversal after an event in words": (NO_CERTIFICATE, with_scene(reverse_after="1")),
    "roots that are a text": (NO_CERTIFICATE, {**LEE, "roots": "23"}),
    "walls that are a text": (NO_CERTIFICATE, with_scene(walls="")),
    "walls that are an object": (NO_CERTIFICATE, with_scene(walls={})),
    "isometries that are an object": (NO_CERTIFICATE, {**LEE, "isometries": {}}),
    "a matrix that is a text": (NO_CERTIFICATE, {**LEE, "isometries": [{**MIRROR, "matrix": "1001"}]}),
    "a map of truth": (NO_CERTIFICATE, {**LEE, "isometries": [{**MIRROR, "map": [[True, 1]]}]}),
    "a map of one number": (NO_CERTIFICATE, {**LEE, "isometries": [{**MIRROR, "map": [[12]]}]}),
    "a map that is an object": (NO_CERTIFICATE, {**LEE, "isometries": [{**MIRROR, "map": {"0": 1}}]}),
    "a final state of too many": (
        NO_CERTIFICATE,
        {**LEE, "final": {**LEE["final"], "circles": [*LEE["final"]["circles"], ["0", "0", "0", "0"]]}},
    ),
    "an instant without a time": (NO_CERTIFICATE, {**LEE, "instants": [*LEE["instants"], {}]}),
    "an instant that is a text": (NO_CERTIFICATE, {**LEE, "instants": [*LEE["instants"], "time"]}),
    "instants that are an object": (NO_CERTIFICATE, {**LEE, "instants": LEE["instants"][0]}),
    "a final state that is a list": (NO_CERTIFICATE, {**LEE, "final": [LEE["final"]]}),
    "an end that is a list": (NO_CERTIFICATE, {**LEE, "end": [LEE["end"]]}),
    "a scene that is a list": (NO_CERTIFICATE, {**LEE, "scene": [LEE["scene"]]}),
    "a turn that is none": (NO_CERTIFICATE, with_first(turn=False)),
    "no meeting": (NO_CERTIFICATE, with_first(met=None)),
    "a root without a number": (NO_CERTIFICATE, with_circle(0, x="1*r0")),
    "a root with a nought before": (NO_CERTIFICATE, {**with_circle(0, x="-3+0*r01"), "roots": ["2"]}),
    "a root that is there": (
        VERIFIED, {**LEE, "scene": {**with_circle(0, x="-3+0*r1")["scene"], "roots": ["2"]}},
    ),
    "a circle of a name": (NO_CERTIFICATE, with_circle(0, name="left")),
    "a key that there is not": (NO_CERTIFICATE, {**LEE, "more": "text"}),
    "a key that there is, and a question mark": (NO_CERTIFICATE, {**LEE, "end": {**LEE["end"], "limit?": 1}}),
    "a long id": (VERIFIED, with_circle(0, id="left" * 100_000)),
    "an id of other letters": (VERIFIED, with_circle(0, id="\u00e9\U0001f41d\u007f\u2028\n\"\\/")),
    "an id of half a letter": (NO_CERTIFICATE, with_circle(0, id="\ud800")),
    "many digits": (VERIFIED, with_circle(0, x="-" + "0" * 99_999 + "3")),
    "too many digits": (NO_CERTIFICATE, with_circle(0, x="-" + "0" * 100_000 + "3")),
    "too many digits of a decimal": (
        NO_CERTIFICATE, {**LEE, "final": {**LEE["final"], "time": "1." + "0" * 100_001}},
    ),
    "a limit that nothing asks": (VERIFIED, {**LEE, "end": {**LEE["end"], "limit": 7}}),
    "a limit that nothing asks, and is none": (NO_CERTIFICATE, {**LEE, "end": {**LEE["end"], "limit": 0}}),
    "events without a limit": (NO_CERTIFICATE, {**LEE, "end": {"reason": "events"}}),
    "a mark before the text": (NO_CERTIFICATE, "\ufeff" + certificate_json(LEE)),
    "a fraction of JSON where nothing is read": (NO_CERTIFICATE, json.dumps({**LEE, "more": 0.5})),
    "a long number where nothing is read": (NO_CERTIFICATE, json.dumps({**LEE, "more": 10**15})),
    "no number where nothing is read": (NO_CERTIFICATE, json.dumps({**LEE, "more": float("nan")})),
}  # fmt: skip


@needs_node
def test_both_checkers_give_the_exit_code_that_the_page_says(tmp_path: Path) -> None:
    paths = []
    for number, (_, told) in enumerate(CASES.values()):
        paths.append(tmp_path / f"{number}.json")
        paths[-1].write_text(told if isinstance(told, str) else certificate_json(told), encoding="utf-8")
    for (name, (code, _)), path, second in zip(CASES.items(), paths, by_node(paths), strict=True):
        first = by_python(path)
        assert (first[0], second[0]) == (code, code), f"{name}: {first[1]}; {second[1]}"


@pytest.mark.parametrize("name", [name for name, (_, told) in CASES.items() if isinstance(told, dict)])
def test_what_the_schema_does_not_take_is_no_certificate(name: str) -> None:
    code, told = CASES[name]
    assert code == NO_CERTIFICATE or SCHEMA.is_valid(told)


def lists_of(value: Any) -> Iterator[list[Any]]:
    """All lists in a value of JSON."""
    if isinstance(value, list):
        yield value
    for item in value.values() if isinstance(value, dict) else value if isinstance(value, list) else ():
        yield from lists_of(item)


def log_of(told: Told) -> list[list[Any]]:
    """The lists of all but the scene and the final state."""
    return list(lists_of({key: told[key] for key in ("isometries", "instants", "end")}))


def other_index(told: Told, draw: Random) -> None:
    """A whole number of the log, the bits or an isometry becomes another."""
    places = [(row, k) for row in log_of(told) for k, value in enumerate(row) if isinstance(value, int)]
    row, k = draw.choice(places)
    row[k] += draw.choice([-3, -2, -1, 1, 2, 3, 50, -50])


def other_length(told: Told, draw: Random) -> None:
    """A part of a list goes, or comes twice."""
    places = [(row, k) for row in log_of(told) for k, value in enumerate(row) if isinstance(value, list | dict)]
    row, k = draw.choice(places)
    if draw.random() < 0.5:
        row.pop(k)
    else:
        row.insert(k, deepcopy(row[k]))


def other_keys(told: Told, draw: Random) -> None:
    """A part of the log loses a key, or takes one over from another part."""
    part, other = (draw.choice(parts(told)) for _ in "ab")
    if part and draw.random() < 0.5:
        part.pop(draw.choice(sorted(part)))
    elif other:
        key = draw.choice(sorted(other))
        part[key] = deepcopy(other[key])


def other_setting(told: Told, draw: Random) -> None:
    """The scene's settings or the end change, or there is one isometry more."""
    scene, choice = told["scene"], draw.randrange(6)
    if choice == 0:
        scene["reverse_after"] = draw.choice([1, 2, 3])
    elif choice == 1:
        scene["capture"] = not scene.get("capture", False)
    elif choice == 2:
        told["end"] |= {"limit": draw.choice([1, 2, 3]), "until": draw.choice(["1", "5"])}
    elif choice == 3:
        told["end"] = {"reason": "events", "limit": draw.choice([0, 1, 2, len(told["instants"])])}
    elif choice == 4:
        scene["tie_policy"] = draw.choice(
            ["sequential", "sequential:seed=5", "simultaneous:seed=2", "sequential:seed="]
        )
    else:
        matrix = [draw.choice(["1", "-1", "0"]) for _ in range(4)]
        told["isometries"].append({"matrix": matrix, "shift": ["0", "0"], "map": [[0, 0]]})


WAYS: tuple[Callable[[Told, Random], None], ...] = (other_index, other_length, other_keys, other_setting)


@needs_node
@pytest.mark.parametrize("count", [80, pytest.param(1000, marks=pytest.mark.slow)])
def test_certificates_of_another_structure_are_told_alike(count: int, tmp_path: Path) -> None:
    tried = altered(count, WAYS, "structure")
    paths = []
    for number, (_, told) in enumerate(tried):
        paths.append(tmp_path / f"{number}.json")
        paths[-1].write_text(certificate_json(told), encoding="utf-8")
    found = []
    for (name, told), path, (second, other) in zip(tried, paths, by_node(paths), strict=True):
        first, sentence = by_python(path)
        alike = first == second or {first, second} == {REFUTED, UNDECIDED}
        assert alike or ({first, second} == {VERIFIED, UNDECIDED} and shown_true(told)), f"{name}: {sentence}; {other}"
        assert first == NO_CERTIFICATE or SCHEMA.is_valid(json.loads(path.read_text(encoding="utf-8"))), name
        found.append(first)
    assert set(found) == {VERIFIED, REFUTED, NO_CERTIFICATE, UNDECIDED}
