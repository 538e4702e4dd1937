"""Logs of the C header, the JavaScript module, the Python writer and the pymunk recorder are read as meant."""

from __future__ import annotations

import base64
import json
import math
import random
import shutil
import struct
import subprocess
from pathlib import Path

import desync_worlds as worlds
import pymunk
import pytest
from desync_trials import full

from truebreak.compare.logdiff.desync import diff
from truebreak.compare.logdiff.log_format import Log
from truebreak.compare.logdiff.log_writer import LogWriter
from truebreak.compare.logdiff.verdict import Finding
from truebreak.compare.validation import EngineError
from truebreak.pymunk import record

ROOM = worlds.HEADER.parent
needs_c = pytest.mark.skipif(worlds.compiler() is None, reason="no C compiler")


def test_the_header_is_short() -> None:
    assert len((ROOM / "truebreak_log.h").read_text("utf-8").splitlines()) <= 150


@needs_c
@pytest.mark.parametrize(
    "words", [["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic"], ["-xc++", "-Wall", "-Werror"]]
)
def test_what_the_header_writes_is_read(words: list[str], tmp_path: Path) -> None:
    shutil.copy(ROOM / "truebreak_log.h", tmp_path)
    (tmp_path / "log.c").write_text(
        '#include "truebreak_log.h"\n'
        "int main(void) {\n"
        "    double a[2] = {0.1, NAN}, b[2] = {1e300, -INFINITY};\n"
        '    tb_log *log = tb_open("run.jsonl", "say \\"hi\\"", "x,y", 53);\n'
        "    tb_step(log, 3, 0.1);\n"
        '    tb_input(log, "jump"); tb_contact(log, "a", "b"); tb_contact(log, "a", "c");\n'
        '    tb_state(log, "a", a, 2);\n'
        '    tb_contact(log, "b", "c"); tb_state(log, "b", b, 2);\n'
        '    tb_number(log, "energy", 0.25); tb_hash(log, "x", 1);\n'
        "    tb_step(log, 4, 0.2);\n"
        '    tb_step(NULL, 5, 1); tb_contact(NULL, "a", "b"); tb_hash(NULL, "x", 1);\n'
        "    return tb_close(log) || tb_close(NULL);\n"
        "}\n",
        encoding="utf-8",
    )
    subprocess.run([str(worlds.compiler()), *words, "-o", "log", "log.c", "-lm"], cwd=tmp_path, check=True)
    subprocess.run(["./log"], cwd=tmp_path, check=True)
    log = Log(tmp_path / "run.jsonl")
    first, second = log
    assert (log.header["engine"], log.header["bits"], log.names) == ('say "hi"', 53, ["x", "y"])
    assert (first.step, first.time, first.input) == (3, 0.1, "jump")
    assert first.contacts == [("a", "b"), ("a", "c"), ("b", "c")]
    assert first.states["a"][0] == 0.1 and str(first.states["a"][1]) == "nan"
    assert first.states["b"] == [1e300, float("-inf")]
    assert (first.fields, first.hash, second.step) == ({"energy": 0.25}, "af63f54c86021707", 4)


@needs_c
@pytest.mark.parametrize("real", ["double", "float"])
@pytest.mark.parametrize("kind", ["gas", "pile"])
def test_a_c_engine_built_otherwise_differs_by_rounding_or_not_at_all(real: str, kind: str, tmp_path: Path) -> None:
    """With and without fused multiply-add, at -O0 and -O3."""
    paths = []
    for k, flags in enumerate((("-O0",), ("-O3",), ("-O3", "-mfma"), ("-O0", "-mfma"))):
        contract = "-ffp-contract=fast" if "-mfma" in flags else "-ffp-contract=off"
        try:
            told = worlds.c_run((*flags, contract, f"-DREAL={real}"), kind, 1, 300)
        except subprocess.CalledProcessError:
            pytest.skip("this machine has no fused multiply-add")
        paths.append(tmp_path / f"{k}.jsonl")
        paths[-1].write_text("".join(json.dumps(line) + "\n" for line in full(told)), encoding="utf-8")
    names = [diff(paths[0], path).verdict.name for path in paths[1:]]
    assert names[0] is Finding.IDENTICAL and names[1] is Finding.GREW and names[2] in (Finding.IDENTICAL, Finding.GREW)


@pytest.mark.skipif(shutil.which("node") is None, reason="no node")
def test_the_javascript_module_and_the_python_writer_write_the_same_log(tmp_path: Path) -> None:
    (tmp_path / "run.mjs").write_text(
        f'import {{ collected }} from "{(ROOM / "truebreak_log.mjs").as_uri()}";\n'
        'import { writeFileSync } from "node:fs";\n'
        'const log = collected({ engine: "mine", fields: ["x", "y"] });\n'
        'log.outline("a", [{ circle: 0.5 }]);\n'
        "for (let k = 0; k < 50; k++)\n"
        '  log.step(k, k / 7, { contacts: k % 9 ? [] : [["a", "b"]], e: k,\n'
        "    states: { a: [k / 3, k === 9 ? NaN : -1e-7 * k] } });\n"
        'writeFileSync("js.jsonl", log.text());\n',
        encoding="utf-8",
    )
    subprocess.run(["node", "run.mjs"], cwd=tmp_path, check=True)
    with LogWriter(tmp_path / "py.jsonl", "mine", ["x", "y"]) as log:
        log.outline("a", [{"circle": 0.5}])
        for k in range(50):
            pairs = [] if k % 9 else [("a", "b")]
            log.step(k, k / 7, contacts=pairs, states={"a": [k / 3, float("nan") if k == 9 else -1e-7 * k]}, e=k)
    found = diff(tmp_path / "js.jsonl", tmp_path / "py.jsonl")
    assert found.verdict.name is Finding.IDENTICAL, found.line
    assert found.found.compared["states"] == 50 and found.found.a.outlines == {"a": [{"circle": 0.5}]}


def space(seed: int, count: int = 20) -> pymunk.Space:
    """Discs and boxes that fall into a box."""
    rng = random.Random(seed)
    made = pymunk.Space()
    made.gravity = 0, -900
    for ends in (((0, 0), (300, 0)), ((0, 0), (0, 900)), ((300, 0), (300, 900))):
        made.add(pymunk.Segment(made.static_body, *ends, 2))
    for k in range(count):
        body = pymunk.Body(1, 100)
        body.position = 30 + 60 * (k % 5) + rng.random(), 30 + 50 * (k // 5)
        made.add(body, pymunk.Circle(body, 15) if k % 2 else pymunk.Poly.create_box(body, (28, 28)))
    return made


def test_a_recorded_space_is_stepped_as_ever(tmp_path: Path) -> None:
    plain, logged = space(1), space(1)
    with record(logged, tmp_path / "a.jsonl"):
        for _ in range(200):
            logged.step(1 / 60)
            plain.step(1 / 60)
    assert [b.position for b in plain.bodies] == [b.position for b in logged.bodies]
    assert "step" not in vars(logged)


def test_two_recordings_of_one_space_are_identical_and_a_push_is_found(tmp_path: Path) -> None:
    names = [str(tmp_path / name) for name in ("a", "b", "c")]
    for name in names:
        made = space(1)
        with record(made, name) as log:
            for k in range(200):
                if name.endswith("c") and k == 120:
                    list(made.bodies)[7].velocity += (0.5, 0)
                if k == 50:
                    log.input("jump")
                made.step(1 / 60)
    assert diff(names[0], names[1]).verdict.name is Finding.IDENTICAL
    found = diff(names[0], names[2])
    assert found.verdict.name in (Finding.CHANGED, Finding.OPEN), found.line
    assert found.verdict.event in (121, 122, 123)  # a line is written every third step
    assert len(Log(names[0]).outlines) == 0  # known once it has been read
    log = Log(names[0])
    records = list(log)
    assert (
        len(log.outlines) == 21
        and [r.step for r in records if r.input == "jump"] == [51]
        and log.end == pytest.approx(200 / 60)
    )


def test_every_step_tells_whether_rounding_or_a_push_came_first(tmp_path: Path) -> None:
    names = [str(tmp_path / name) for name in ("a", "b")]
    for name in names:
        made = space(1)
        with record(made, name, every=1):
            for k in range(100):
                if name.endswith("b") and k == 60:
                    list(made.bodies)[7].velocity += (0.5, 0)
                made.step(1 / 60)
    found = diff(*names)
    assert (found.verdict.name, found.verdict.event) == (Finding.CHANGED, 61), found.line
    with pytest.raises(EngineError, match="every = 0"):
        record(space(1), tmp_path / "c", every=0)


@pytest.mark.parametrize("threads", [0, 1])
def test_an_example_of_pymunks_own_is_recorded_twice_alike(threads: int, tmp_path: Path) -> None:
    """Its pyramid of 325 boxes; with two threads it is another run each time, as the docs tell."""
    from pymunk.examples.threaded_space import PyramidDemo

    for name in ("a", "b"):
        demo = PyramidDemo(threads)
        with record(demo.space, tmp_path / name):
            demo.step(40)
    found = diff(tmp_path / "a", tmp_path / "b")
    assert found.verdict.name is Finding.IDENTICAL, found.line
    assert found.found.compared["hashes"] == 14  # a line every third step


def test_bodies_that_come_and_go_are_logged_where_they_do(tmp_path: Path) -> None:
    for name, place in (("a", 100.0), ("b", 120.0)):
        made = pymunk.Space()
        with record(made, tmp_path / name):
            for k in range(30):
                if k == 10:
                    body = pymunk.Body(1, 1)
                    body.position = place, 50
                    made.add(body, pymunk.Circle(body, 5))
                if k == 20:
                    made.remove(*made.shapes, *made.bodies)
                made.step(1 / 60)
    found = diff(tmp_path / "a", tmp_path / "b")
    assert (found.verdict.name, found.verdict.event) == (Finding.CHANGED, 12), found.line


def test_what_is_packed_is_doubles_in_the_order_that_is_told(tmp_path: Path) -> None:
    packed = base64.b64encode(struct.pack("<4d", 0.1, -0.0, math.nan, 1e300)).decode()
    log = tmp_path / "a.jsonl"
    head = json.dumps({"order": ["a", "b"]}) + "\n"
    log.write_text(head + json.dumps({"step": 1, "packed": packed}) + "\n", encoding="utf-8")
    (one,) = list(Log(log))
    assert str(one.states) == "{'a': [0.1, -0.0], 'b': [nan, 1e+300]}"
    for bad in ("?", packed[:-3], 5, ""):
        log.write_text(head + json.dumps({"step": 1, "packed": bad}) + "\n", encoding="utf-8")
        with pytest.raises(EngineError, match="line 2: packed = "):
            list(Log(log))
    log.write_text(json.dumps({"step": 1, "packed": packed}) + "\n", encoding="utf-8")
    with pytest.raises(EngineError, match="of an order"):
        list(Log(log))
