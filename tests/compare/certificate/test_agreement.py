"""The two checkers say the same of what has the wrong shape, names what is not there, or stands in the wrong place."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from copy import deepcopy
from pathlib import Path
from random import Random
from typing import Any

import pytest

from certificate.checkers import by_node, by_python, needs_node
from certificate.samples import built
from certificate.test_tampering import Told, altered, parts
from truebreak.compare.certificate import certificate_json, certificate_of
from truebreak.exact import ExactEngine
from truebreak.scenarios import Circle, Scene

VERIFIED, REFUTED, NO_CERTIFICATE, UNDECIDED = 0, 1, 2, 4

LEE = certificate_of(built("lee"))
MIRROR = {"matrix": ["1", "0", "0", "-1"], "shift": ["0", "0"], "map": [[0, 1]]}


PAIRS = certificate_of(ExactEngine().run(Scene([Circle(0, 0, vx=1), Circle(4, 1), Circle(0, 9, vx=1), Circle(4, 10)])))
"""Two pairs that meet at once, at 4 - sqrt(3)."""


def with_first(told: Told = LEE, **values: Any) -> Told:
    """A certificate with other values in its first instant."""
    return {**told, "instants": [{**told["instants"][0], **values}, *told["instants"][1:]]}


def with_scene(**values: Any) -> Told:
    """The same with other values in its scene."""
    return {**LEE, "scene": {**LEE["scene"], **values}}


RUNS_ON = [*LEE["instants"], {"arrive": [[0, 1]], "time": "9.0"}]

CASES: dict[str, tuple[int, Told | str]] = {
    "a contact that there is not": (REFUTED, with_first(arrive=[[0, 7]])),
    "a pocket that there is not": (REFUTED, with_first(arrive=[[0, -1]])),
    "a contact the wrong way round": (REFUTED, with_first(arrive=[[1, 0]])),
    "a graze that there is not": (REFUTED, with_first(grazes=[[0, 7]])),
    "a round of what there is not": (REFUTED, with_first(rounds=[[[0, 7]]])),
    "an entry of what there is not": (REFUTED, with_first(entries=[[0, 3]])),
    "no witness where one is needed": (UNDECIDED, with_first(PAIRS, zeros=[])),
    "another witness beside a false one": (
        VERIFIED, with_first(PAIRS, zeros=[["tie", [2, 3], 5], ["tie", [2, 3], "exact"]]),
    ),
    "a needed witness by an isometry that there is not": (REFUTED, with_first(PAIRS, zeros=[["tie", [2, 3], 5]])),
    "a needed witness by a contact that there is not": (
        REFUTED, with_first(PAIRS, zeros=[["tie", [2, 3], "exact", [0, 7]]]),
    ),
    "a false isometry that nothing needs": (REFUTED, {**LEE, "isometries": [*LEE["isometries"], MIRROR]}),
    "an isometry of what there is not": (
        NO_CERTIFICATE, {**LEE, "isometries": [*LEE["isometries"], {**MIRROR, "map": [[0, 70]]}]},
    ),
    "an instant after the last event": (
        REFUTED, {**LEE, "end": {"reason": "events", "limit": 1}, "instants": RUNS_ON},
    ),
    "a contact of text": (NO_CERTIFICATE, with_first(arrive=[["0", "1"]])),
    "a contact of three": (NO_CERTIFICATE, with_first(arrive=[[0, 1, 2]])),
    "a contact before all circles": (NO_CERTIFICATE, with_first(arrive=[[-1, 1]])),
    "nothing arrives": (NO_CERTIFICATE, with_first(arrive=[])),
    "a rim that grazes": (NO_CERTIFICATE, with_first(grazes=[[0, -1]])),
    "a round of none": (NO_CERTIFICATE, with_first(rounds=[[]])),
    "a question that nobody knows": (NO_CERTIFICATE, with_first(zeros=[["why", [0, 1], "exact"]])),
    "a witness without a how": (NO_CERTIFICATE, with_first(zeros=[["tie", [0, 1]]])),
    "a policy with a seed that takes none": (NO_CERTIFICATE, with_scene(tie_policy="simultaneous:seed=2")),
    "two reversals": (NO_CERTIFICATE, with_scene(reverse_at="1", reverse_after=1)),
    "a horizon without a time": (NO_CERTIFICATE, {**LEE, "end": {"reason": "horizon"}}),
    "no events as a limit": (NO_CERTIFICATE, {**LEE, "end": {"reason": "events", "limit": 0}}),
    "an end without a name": (NO_CERTIFICATE, {**LEE, "end": {"reason": "boredom"}}),
    "an end that is not asked": (VERIFIED, {**LEE, "end": {"reason": "quiet", "until": "1/1000"}}),
    "a start with what only instants have": (VERIFIED, {**LEE, "start": {**LEE["start"], "arrive": [[0, 1]]}}),
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


def lists_of(value: Any) -> Iterator[list[Any]]:
    """All lists in a value of JSON."""
    if isinstance(value, list):
        yield value
    for item in value.values() if isinstance(value, dict) else value if isinstance(value, list) else ():
        yield from lists_of(item)


def log_of(told: Told) -> list[list[Any]]:
    """The lists of all but the scene and the final state."""
    return list(lists_of({key: told[key] for key in ("isometries", "bits", "start", "instants", "end")}))


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
    for (name, _), path, (second, other) in zip(tried, paths, by_node(paths), strict=True):
        first, sentence = by_python(path)
        assert first == second or {first, second} == {REFUTED, UNDECIDED}, f"{name}: {sentence}; {other}"
        found.append(first)
    assert set(found) == {VERIFIED, REFUTED, NO_CERTIFICATE, UNDECIDED}
