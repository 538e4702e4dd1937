"""What is no certificate is refused in one line, with exit code 2, in bounded time and memory."""

from __future__ import annotations

import json
import os
import resource
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from command_line import said

from certificate.checkers import NODE, TOOLS, by_node, by_program, by_python
from certificate.samples import built
from truebreak.compare.certificate import certificate_json, certificate_of
from truebreak.tools.verify import BYTES

LEE = json.dumps(certificate_of(built("lee")))


VERIFIED = "verified: 1 event, to the end: quiet; 3 circles, 0 walls, 0 pockets; scene sha256:"
ONE_POINT = {"id": "w", "x0": "9", "y0": "0", "x1": "9", "y1": "0", "length": "0"}


def changed(**values: Any) -> str:
    """The certificate of `lee` with other values at its first level."""
    return json.dumps({**json.loads(LEE), **values})


def scene(**values: Any) -> str:
    """The same with other values of its first circle."""
    told = json.loads(LEE)
    told["scene"]["circles"][0] |= values
    return json.dumps(told)


BAD = {
    "nothing": "",
    "no JSON": "certificate",
    "cut off": LEE[: len(LEE) // 2],
    "another kind": '{"schema": "truebreak/trajectory-1"}',
    "a list": "[]",
    "a number": "7",
    "nan": "NaN",
    "another version": changed(format="truebreak/certificate-1"),
    "deep": "[" * 100_000,
    "no scene": changed(scene=None),
    "no circle": changed(scene={"tie_policy": "simultaneous", "circles": []}),
    "a policy of its own": changed(scene=json.loads(LEE)["scene"] | {"tie_policy": "simultaneously"}),
    "bits beyond measure": changed(bits=10**12),
    "bits beyond all numbers": changed(bits=1001).replace("1001", "1e999"),
    "bits that are not a number": changed(bits=[[0, float("nan")]]),
    "bits that are a fraction": changed(bits=160.5),
    "bits that fall": changed(bits=[[0, 160], [1, 150]]),
    "bits that are none": changed(bits="many"),
    "no bits": changed(bits=0),
    "roots without end": changed(roots=["2"] * 100_000),
    "a root of itself": changed(roots=["1+1*r1"]),
    "a whole number of JSON without end": LEE[:-1] + ', "more": ' + "9" * 5_000_000 + "}",
    "a seed without end": LEE.replace('"simultaneous"', f'"sequential:seed={"9" * 5_000_000}"'),
    "a long number": scene(x="9" * 1_000_000),
    "a decimal": scene(x="0.5"),
    "a power": scene(x="10**10**10"),
    "a zero divides": scene(x="1/0"),
    "code": scene(x="__import__('os')"),
    "a number of JSON": scene(x=1),
    "a negative radius": scene(r="-1"),
    "a negative weight": scene(w="-1"),
    "a wall of another length": changed(scene={**json.loads(LEE)["scene"], "walls": [{**ONE_POINT, "y1": "2"}]}),
    "a wall of one point": changed(scene={**json.loads(LEE)["scene"], "walls": [ONE_POINT]}),
    "a root of what is negative": changed(roots=["-2"]),
    "a key that comes twice": LEE.replace('"writer"', '"roots": ["2"], "writer"'),
    "an infinite limit": changed(end={"reason": "events", "limit": float("inf")}).replace('"events"', '"evens"'),
    "truth for a number": scene(x=True),
    "a list for a scene": changed(scene=[]),
    "a number for an instant": changed(instants=[7]),
    "a fixed circle that moves": scene(w="0"),
    "a final state of too few": changed(final={"time": "1.0", "circles": []}),
    "instants of something else": changed(instants=[{"met": 7}]),
    "a time that is none": changed(instants=[{**json.loads(LEE)["instants"][0], "time": "soon"}]),
}


@pytest.mark.parametrize("name", sorted(BAD))
def test_no_certificate(name: str, tmp_path: Path) -> None:
    path = tmp_path / "bad.json"
    path.write_text(BAD[name], encoding="utf-8")
    code, sentence = by_python(path)
    assert code == 2 and sentence.startswith("no certificate: ") and "\n" not in sentence and len(sentence) < 300
    if NODE is not None:
        assert by_node([path])[0][0] == 2


@pytest.mark.parametrize("name", ["a key that comes twice", "a long number", "deep"])
def test_the_program_says_of_a_bad_file_what_its_function_does(name: str, tmp_path: Path) -> None:
    path = tmp_path / "bad.json"
    path.write_text(BAD[name], encoding="utf-8")
    assert by_program(path) == by_python(path)


def test_a_file_of_200_megabytes_is_not_read(tmp_path: Path) -> None:
    path = tmp_path / "large.json"
    with path.open("wb") as file:
        file.truncate(200 << 20)

    def little_memory() -> None:
        resource.setrlimit(resource.RLIMIT_AS, (300 << 20, 300 << 20))

    done = subprocess.run(
        [sys.executable, "-I", str(TOOLS / "verify.py"), str(path)],
        capture_output=True, text=True, check=False, preexec_fn=little_memory,
    )  # fmt: skip
    assert (done.returncode, done.stdout) == (2, f"no certificate: Malformed: it is longer than {BYTES} bytes\n")


@pytest.mark.parametrize(
    ("name", "reason"), [("missing", "No such file or directory"), ("m" * 5000, "File name too long")]
)
def test_a_file_that_cannot_be_read(name: str, reason: str, tmp_path: Path) -> None:
    assert by_program(tmp_path / name) == (2, f"no certificate: it cannot be read: {reason}")
    if NODE is not None:
        assert by_node([tmp_path / name])[0][0] == 2


def test_the_command_line_writes_and_verifies(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "lee.json"
    assert said(capsys, "run", "lee", "--certificate", str(path))[0] == 0
    code, out, err = said(capsys, "verify", str(path))
    assert (code, err) == (0, "") and out.startswith(VERIFIED) and out.endswith("; no scene was given\n")
    told = json.loads(path.read_text(encoding="utf-8"))
    assert path.read_text(encoding="utf-8") == certificate_json(told)
    told["instants"][1]["rounds"] = [[[0, 1]]]
    path.write_text(json.dumps(told), encoding="utf-8")
    code, out, err = said(capsys, "verify", str(path))
    assert (code, err) == (1, "") and out == "refuted: instant 1: (1, 2) push too\n"


def test_the_command_line_refuses_in_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    bad = tmp_path / "bad.json"
    bad.write_text("{", encoding="utf-8")
    code, out, err = said(capsys, "verify", str(bad))
    assert (code, out, err.count("\n")) == (2, "", 1) and err.startswith("no certificate: ")
    code, out, err = said(capsys, "run", "lee", "--engine", "double", "--certificate", str(bad))
    assert (code, out, err.count("\n")) == (2, "", 1) and "only runs of the exact engine" in err
    code, out, err = said(capsys, "run", "lee", "--certificate", str(tmp_path / "no" / "folder.json"))
    assert (code, out, err.count("\n")) == (2, "", 1) and "there is no folder" in err


def test_a_comparison_is_certified(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    code, out, _ = said(capsys, "compare", "lee", "--engines", "double", "--certify", "--json")
    reference = json.loads(out)["reference"]
    assert code == 0 and reference["certified"] and reference["independently_checked"]
    path = tmp_path / "attached.json"
    path.write_text(json.dumps(reference["certificate"]), encoding="utf-8")
    assert by_program(path)[0] == 0
    report = tmp_path / "report.html"
    said(capsys, "compare", "lee", "--engines", "double", "--certify", "--html", str(report))
    assert "Independently checked: verified" in report.read_text(encoding="utf-8")


@pytest.mark.parametrize("program", ["verify.py", "verify.mjs"])
@pytest.mark.parametrize("kind", ["fifo", "device"])
def test_what_is_no_file_is_not_read(program: str, kind: str, tmp_path: Path) -> None:
    path = Path("/dev/zero")
    if kind == "fifo":
        path = tmp_path / "fifo"
        os.mkfifo(path)
    runner = sys.executable if program.endswith("py") else NODE
    if runner is None:
        pytest.skip("node is not at hand")
    done = subprocess.run([runner, str(TOOLS / program), str(path)], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (2, "") and "no regular file" in done.stdout.replace("not a", "no")


def test_too_many_walls_are_not_gone_through(tmp_path: Path) -> None:
    told = json.loads(LEE)
    told["scene"]["walls"] = [
        {"id": f"w{k}", "x0": "9", "y0": "0", "x1": "9", "y1": "1", "length": "1"} for k in range(60_000)
    ]
    told["scene"]["circles"] = [told["scene"]["circles"][0] | {"id": f"c{k}"} for k in range(100)]
    told["final"]["circles"] *= 34
    del told["final"]["circles"][100:]
    path = tmp_path / "walls.json"
    path.write_text(json.dumps(told), encoding="utf-8")
    code, sentence = by_program(path)
    assert code == 2 and "too many" in sentence
    if NODE is not None:
        assert by_node([path])[0][0] == 2


def test_a_reference_without_certificates_is_refused_before_anything_runs(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def never(*_: Any, **__: Any) -> None:
        raise AssertionError("it ran")

    monkeypatch.setattr("truebreak.compare.comparison.compare", never)
    code, out, err = said(capsys, "compare", "lee", "--engines", "exact", "--reference", "double", "--certify")
    assert (code, out, err.count("\n")) == (2, "", 1) and "not those of double" in err
