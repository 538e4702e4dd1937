"""What the command line prints as JSON is what the schemas say."""

from __future__ import annotations

import importlib
import json
from pathlib import Path
from typing import Any

import jsonschema
import pytest

from truebreak.compare import compare, comparison_json, engine, trajectory_json
from truebreak.compare.deadline import Clock
from truebreak.compare.report.documents import COMPUTED, FORMS, keys_of
from truebreak.compare.report.schema import DOCUMENTS, NAMES, schema, text
from truebreak.scenarios import Scene, catalogue


def check(data: dict[str, Any]) -> None:
    """Raises unless the object is what its schema says."""
    name = data["schema"].removeprefix("truebreak/")
    jsonschema.Draft202012Validator(schema(name)).validate(data)


@pytest.mark.parametrize("name", NAMES)
def test_schemas_are_schemas(name: str) -> None:
    jsonschema.Draft202012Validator.check_schema(schema(name))
    assert schema(name)["$id"] == f"truebreak/{name}"


def test_an_unknown_schema_is_an_error() -> None:
    with pytest.raises(KeyError):
        schema("../trajectory-1")


def short(text: str) -> Scene:
    return catalogue.build(text).with_changes(events=8, until=None)


@pytest.mark.parametrize("name", ["exact", "double", "interval", "pymunk", "sympy"])
@pytest.mark.parametrize("exact", [False, True])
def test_every_engine_prints_a_trajectory(name: str, exact: bool) -> None:
    scene = short("tennis")
    data = trajectory_json(engine(name).run(scene, events=2), exact=exact)
    check(data)
    assert data["scene"] == {"name": scene.name, "digest": scene.digest, "tie_policy": "simultaneous"}
    assert [event["index"] for event in data["events"]] == list(range(len(data["events"])))
    assert ("vx_exact" in data["final"]["circles"][0]) == (exact and name != "interval")
    assert ("vx_interval" in data["final"]["circles"][0]) == (name == "interval")


def test_exact_text_is_read_back_to_the_same_double() -> None:
    from truebreak.scenarios import Quantity

    data = trajectory_json(engine("exact").run(short("lorentz"), events=2), exact=True)
    for event in data["events"]:
        assert float(Quantity.of(event["time_exact"])) == event["time"]
    for circle in data["final"]["circles"]:
        for key in ("x", "y", "vx", "vy"):
            assert float(Quantity.of(circle[f"{key}_exact"])) == circle[key]


def test_deep_values_are_given_by_definitions() -> None:
    import re

    import mpmath

    data = trajectory_json(engine("exact").run(catalogue.build("gas"), events=40), exact=True)
    check(data)
    with mpmath.workdps(100):
        known: dict[str, Any] = {"sqrt": mpmath.sqrt, "mpf": mpmath.mpf}

        def value(text: str) -> Any:
            return eval(re.sub(r"(?<!\w)(\d+)", r"mpf('\1')", text), {"__builtins__": {}}, known)

        for name, text in data["definitions"].items():
            known[name] = value(text)
        for event in data["events"]:
            assert float(value(event["time_exact"])) == event["time"]
        for circle in data["final"]["circles"]:
            assert float(value(circle["vx_exact"])) == circle["vx"]


def test_once_the_seconds_are_over_every_exact_value_is_given_by_definitions() -> None:
    watch = Clock(1e-9)
    while not watch.over:
        pass
    run = engine("exact").run(catalogue.build("gas"), events=5)
    hurried, whole = trajectory_json(run, exact=True, watch=watch), trajectory_json(run, exact=True)
    check(hurried)
    assert "definitions" not in whole
    assert hurried["definitions"]
    assert all(event["time_exact"] for event in hurried["events"])
    assert [event["time"] for event in hurried["events"]] == [event["time"] for event in whole["events"]]


def test_entries_into_pockets_are_printed() -> None:
    data = trajectory_json(engine("exact").run(catalogue.build("rack:rows=2"), events=20), exact=True)
    check(data)
    assert {entry["circle"] for entry in data["pocketed"]} == {"b2", "b3"}


def test_ties_and_reversals_are_printed() -> None:
    tied = trajectory_json(engine("exact").run(catalogue.build("lee")))
    check(tied)
    assert tied["events"][0]["ties"]
    assert tied["events"][0]["coupled"]
    back = trajectory_json(engine("exact").run(catalogue.build("gas").with_changes(reverse_after=3, events=None)))
    check(back)
    assert back["reversal"]["after"] == 3
    assert back["notes"]


@pytest.mark.parametrize("text", ["cradle", "rack:rows=3", "near-tie", "grazing", "galperin"])
def test_a_comparison_is_printed(text: str) -> None:
    data = comparison_json(compare(short(text)))
    check(data)
    assert [row["engine"] for row in data["candidates"]] == ["double", "interval", "pymunk"]
    for row in data["candidates"]:
        assert (row["first_divergence"] is not None) == (row["verdict"] == "diverged")
        assert len(row["position_error"]["times"]) == len(row["position_error"]["max"]) <= 50


@pytest.mark.parametrize("scene", ["lee", "rack:rows=3"])
def test_orders_are_what_their_schema_says(scene: str) -> None:
    from truebreak.compare.orders.all_orders import all_orders
    from truebreak.compare.report.documents import orders_json
    from truebreak.exact import ExactEngine

    tree = all_orders(ExactEngine(), catalogue.build(scene), events=1, cap=3, samples=2)
    data = orders_json(catalogue.build(scene), tree)
    check(data)
    assert data["complete"] == (scene == "lee")
    assert data["sampled"] == (0 if scene == "lee" else 2)


def test_what_rests_on_less_than_proof_says_so() -> None:
    from truebreak.exact import ExactEngine

    scene = catalogue.build("inscribed:n=4")
    data = trajectory_json(ExactEngine(ties="assume:100").run(scene, events=40))
    check(data)
    if data.get("assumptions"):
        first = data["assumptions"][0]["event"]
        assert all(("rests_on" in event) == (event["index"] >= first) for event in data["events"])
        assert data["certified"] is False


@pytest.mark.parametrize("name", DOCUMENTS)
def test_a_schema_is_what_its_classes_say(name: str, root: Path) -> None:
    written = (root / "compare" / "report" / "schemas" / f"{name}.json").read_text("utf-8")
    assert written == text(name), "run: python -m truebreak.compare.report.schema"


@pytest.mark.parametrize("place", FORMS)
def test_every_key_of_a_form_has_a_meaning_or_its_class_one(place: str) -> None:
    """And no computed key is of a class, or of a form, that does not have it."""
    module, _, name = place.partition(":")
    kind = getattr(importlib.import_module(f"truebreak.{module}"), name)
    assert kind.__doc__ and not kind.__doc__.startswith(f"{name}(")
    mine = {key.partition(".")[2] for key in COMPUTED if key.partition(".")[0] == name}
    assert mine <= {key.name for key in keys_of(kind)}
    assert name in {place.partition(":")[2] for place in FORMS} and {key.partition(".")[0] for key in COMPUTED} <= {
        place.partition(":")[2] for place in FORMS
    }


def test_a_schema_refuses_what_its_document_does_not_have() -> None:
    good = trajectory_json(engine("exact").run(catalogue.build("lee")))
    check(good)
    for path, value in (
        (("events", 0, "time"), "1"),
        (("events", 0, "contacts", 0), ["left"]),
        (("events", 0, "more"), 1),
        (("stop", "reason"), "tired"),
        (("final", "circles"), None),
        (("certified",), 1),
    ):
        wrong = json.loads(json.dumps(good))
        place = wrong
        for part in path[:-1]:
            place = place[part]
        place[path[-1]] = value
        with pytest.raises(jsonschema.ValidationError):
            check(wrong)
    del good["plan"]
    with pytest.raises(jsonschema.ValidationError):
        check(good)
