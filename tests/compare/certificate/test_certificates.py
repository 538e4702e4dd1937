"""Certificates of runs of every kind are verified by both checkers, and are what the schema says."""

from __future__ import annotations

import ast
import json
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import jsonschema
import pytest

from certificate.checkers import TOOLS, both_verify, by_program
from certificate.samples import built, coincidence, kinds, rows, samples, there_and_back
from truebreak.compare.certificate import CertificateError, certificate_json, certificate_of
from truebreak.compare.grids.stress_families import stress_family
from truebreak.compare.report.schema import schema
from truebreak.exact import ExactEngine
from truebreak.floating import DoubleEngine
from truebreak.scenarios import Circle, Scene, Wall
from truebreak.tools.verify import verdict

LINES, COLUMNS = 900, 100
"""Most lines of the checker, which is to be read in an hour: it may lose some, and not gain any."""

ORDINARY = 120
"""Most bytes of an event with its witness in the ordinary case."""


def hows(told: dict[str, Any]) -> set[str]:
    """The kinds of witness in a certificate."""
    entries = [*told["instants"], told["end"]]
    found = {
        "isometry" if isinstance(zero[2], int) else zero[2] for entry in entries for zero in entry.get("zeros", ())
    }
    return found | {"exact" for entry in entries if "exact" in entry}


def test_both_checkers_verify_runs_of_every_kind(tmp_path: Path) -> None:
    both_verify(samples().items(), tmp_path)


def test_samples_hold_every_kind_of_witness_and_question() -> None:
    told = samples().values()
    assert set.union(*map(hows, told)) == {"exact", "isometry", "back"}
    entries = [entry for t in told for entry in (*t["instants"], t["end"])]
    asked = {zero[0] for entry in entries for zero in entry.get("zeros", ())}
    assert asked >= {"gap", "closing", "speed", "until"}


@pytest.mark.parametrize("name", sorted(kinds()))
def test_certificates_are_what_the_schema_says(name: str) -> None:
    jsonschema.Draft202012Validator(schema("certificate-3")).validate(samples()[name])


def test_the_checker_is_a_program_of_its_own(tmp_path: Path) -> None:
    path = tmp_path / "lee.json"
    path.write_text(certificate_json(certificate_of(built("lee"))), encoding="utf-8")
    code, said = by_program(path)
    assert code == 0 and said.startswith("verified: 1 event, to the end: quiet; 3 circles, 0 walls, 0 pockets; scene ")


def test_the_checker_is_one_file_that_imports_the_standard_library_alone() -> None:
    assert [file.name for file in TOOLS.glob("*.py") if file.read_bytes() and file.name != "building.py"] == [
        "verify.py"
    ]
    text = (TOOLS / "verify.py").read_text(encoding="utf-8")
    assert len(text.splitlines()) <= LINES and max(map(len, text.splitlines())) <= COLUMNS
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import):
            assert {alias.name for alias in node.names} <= sys.stdlib_module_names
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0 and node.module in sys.stdlib_module_names


def test_an_ordinary_event_takes_few_bytes() -> None:
    for spec, events in (("gas", 300), ("rack:rows=3,gap=1/50", 30), ("galperin:n=1", 31)):
        told = certificate_of(built(spec, events))
        assert len(json.dumps(told["instants"], separators=(",", ":"))) <= ORDINARY * len(told["instants"]), spec


def test_there_and_back_rests_on_isometries_and_the_way_back() -> None:
    mirrored, heavier = certificate_of(there_and_back()), certificate_of(there_and_back(2))
    assert "isometry" in hows(mirrored) and hows(heavier) >= {"exact", "back"}
    assert mirrored["end"] == heavier["end"] == {"reason": "return"}


def test_a_run_that_stopped_is_certified_as_far_as_it_went(tmp_path: Path) -> None:
    run = ExactEngine(max_bits=256).run(built("gas").scene, events=400)
    told = certificate_of(run)
    assert run.stop.reason.name == "UNDECIDED" and told["end"] == {"reason": "stopped"} and len(told["instants"]) > 10
    both_verify([("stopped", told)], tmp_path)


def test_limits_and_the_reversal_on_one_instant(tmp_path: Path) -> None:
    pair = [Circle(0, 0, vx=1), Circle(4, 0)]
    walls = [Wall("-1/3", 3, "-1/3", 4)]
    runs = {
        "both at the contact": ExactEngine().run(Scene(pair, reverse_at=2), until=2),
        "events leave the reversal out": ExactEngine().run(Scene(pair, reverse_after=1), events=1),
        "nothing but two limits": ExactEngine().run(Scene([Circle(1, 0)], walls, reverse_at="1/3"), until="1/3"),
        "a hair after the end": ExactEngine().run(Scene(pair), until="2 - 10**-100"),
    }
    both_verify([(name, certificate_of(run)) for name, run in runs.items()], tmp_path)
    assert [len(run.events) for run in runs.values()] == [2, 1, 0, 0]


def test_numbers_of_thousands_of_digits(tmp_path: Path) -> None:
    scene = Scene([Circle(0, 0, vx=1), Circle("4 + 10**-5000", 1), Circle(0, 9, vx=1), Circle(4, 10)])
    run = ExactEngine().run(scene, events=2)
    told = certificate_of(run)
    assert [entry["met"] for entry in told["instants"][1:]] == [[[2, 3]], [[0, 1]]] and told["bits"] > 5000
    both_verify([("long", told)], tmp_path)


@pytest.mark.parametrize(
    ("family", "k"),
    [
        ("scaled", 76),
        ("scaled", 300),
        ("slow-fast", 32),
        ("slow-fast", 200),
        ("mass-ratios", 100),
        ("corners", 300),
        ("pi", 5),
        pytest.param("pi", 6, marks=pytest.mark.slow),
    ],
)
def test_numbers_of_every_size(family: str, k: int, tmp_path: Path) -> None:
    one = stress_family(family)
    told = {side: certificate_of(ExactEngine().run(one.scene(one.place(k, side)))) for side in one.sides}
    both_verify(told.items(), tmp_path)


def test_sizes_that_take_more_bits_than_are_said_are_not_called_none(tmp_path: Path) -> None:
    tiny = [Circle(0, 0, vx=1, r="10**-60", m="10**60"), Circle(4, 0, r="10**-60", m="10**-60")]
    told = certificate_of(ExactEngine().run(Scene(tiny)))
    both_verify([("tiny", told)], tmp_path)
    told["bits"] = 100
    path = tmp_path / "few bits.json"
    path.write_text(certificate_json(told), encoding="utf-8")
    assert verdict(path)[0] == 4


def test_more_digits_are_had_for_the_asking(tmp_path: Path) -> None:
    told = certificate_of(ExactEngine().run(Scene([Circle(0, 0, vx=1), Circle(4, 1)])), digits=40)
    assert told["instants"][1]["time"] == "2.2679491924311227064725536584941276330572"
    both_verify([("digits", told)], tmp_path)


def test_what_has_no_certificate() -> None:
    scene = Scene([Circle(0, 0, vx=1), Circle(4, 0)])
    with pytest.raises(CertificateError, match="only runs of the exact engine"):
        certificate_of(DoubleEngine().run(scene))
    assumed = ExactEngine(ties="assume:64", work=1000).run(rows(9, (1, 2)))
    assert not assumed.certified
    with pytest.raises(CertificateError, match="assumed"):
        certificate_of(assumed)
    with pytest.raises(CertificateError, match="too many roots"):
        certificate_of(ExactEngine().run(Scene([Circle("+".join(f"sqrt({p})" for p in PRIMES), 0)])))
    run = ExactEngine().run(Scene([Circle(0, 0, vx=1), Circle(4, 1)]))
    with pytest.raises(CertificateError, match="within 1310720 bits: it has too many"):
        certificate_of(replace(run, plan={**run.plan, "bits": 1 << 20}))
    with pytest.raises(CertificateError, match="within time 0"):
        certificate_of(coincidence("wedged", 11))


PRIMES = (2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41)


def test_too_few_bits_are_told_with_how_many_would_do(tmp_path: Path) -> None:
    told = certificate_of(built("gas", 60))
    told["bits"] = 90
    path = tmp_path / "gas.json"
    path.write_text(certificate_json(told), encoding="utf-8")
    code, sentence = verdict(path)
    assert code == 4 and "; with 180 bits it is verified: 60 events" in sentence
