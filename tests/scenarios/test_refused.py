"""Scene files: every bad one is refused in one line, at once."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from counted import calls

from truebreak.scenarios import Circle, SceneError
from truebreak.scenarios.files import MAX_JSON, MAX_TOML, load_scene, loads_json, loads_toml
from truebreak.scenarios.numbers import parsing
from truebreak.scenarios.scene import MAX_CIRCLES

BALL_JSON = '{{"circle": [{{"id": "a", "x": 0, "y": 0, "r": 1, {}}}]}}'
BALL = '[[circle]]\nid = "a"\nx = 0\ny = 0\nr = 1\n'


def toml_refusal(text: str) -> str:
    with pytest.raises(SceneError) as error:
        loads_toml(text, "x.toml")
    return str(error.value)


def json_refusal(text: str) -> str:
    with pytest.raises(SceneError) as error:
        loads_json(text, "x.json")
    return str(error.value)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "x.toml: is empty; write at least one circle"),
        (" \n", "x.toml: is empty; write at least one circle"),
        ('name = "x"', "x.toml: the scene has no circle; add at least one circle"),
        ("x = = 1", "x.toml: not TOML: Invalid value (at line 1, column 5)"),
        (BALL + "x = 1\n", "x.toml: not TOML: Cannot overwrite a value (at line 6, column 6)"),
        (
            BALL.replace("x = 0", 'x = "1/0"'),
            "x.toml: circle 'a': x = '1/0' is not an exact number: division by zero",
        ),
        (BALL.replace("x = 0\n", ""), "x.toml: circle 'a': x is missing; write x = ..."),
        (BALL.replace("r = 1\n", ""), "x.toml: circle 'a': r is missing; write r = ..."),
        (
            BALL.replace('id = "a"\n', ""),
            "x.toml: circle 1: id is missing; give every circle an id of its own",
        ),
        (BALL.replace('"a"', "7"), "x.toml: circle 1: id = 7 is not text; put it in quotes"),
        (BALL.replace('"a"', "0.7"), "x.toml: circle 1: id = 0.7 is not text; put it in quotes"),
        (BALL + "vz = 1", "x.toml: circle 'a': key 'vz' is not known; did you mean 'vy'?"),
        (
            BALL + "colour = 1",
            "x.toml: circle 'a': key 'colour' is not known; known keys: id, x, y, r, vx, vy, m, point, fixed",
        ),
        ("[[circles]]\nx = 1", "x.toml: key 'circles' is not known; did you mean 'circle'?"),
        (
            "[circle]\nx = 1",
            "x.toml: circle = {'x': 1} is not a list of tables; write [[circle]] above each of them",
        ),
        (
            "circle = [1, 2]",
            "x.toml: circle = [1, 2] is not a list of tables; write [[circle]] above each of them",
        ),
        (BALL + "vx = nan", "x.toml: circle 'a': vx = nan is not a finite number"),
        (BALL + "vx = -inf", "x.toml: circle 'a': vx = -inf is not a finite number"),
        (
            BALL + "m = -inf",
            "x.toml: circle 'a': m = -inf is not a finite number; a fixed circle says m = \"oo\"",
        ),
        (
            BALL + "m = 2\nfixed = true",
            "x.toml: circle 'a': fixed = true with m = 2: a fixed circle has no finite mass; keep one of them",
        ),
        (
            BALL + 'm = "oo"\nfixed = false',
            "x.toml: circle 'a': fixed = false with m = 'oo': an infinite mass fixes it; keep one of them",
        ),
        (BALL + "fixed = 1", "x.toml: circle 'a': fixed = 1 is not true or false"),
        (
            "damping = 1\n" + BALL + "spin = 1\n" + BALL.replace('"a"', '"b"') + "spin = 1\n[[box]]",
            "x.toml: box, damping, spin (of circle 'a'): physics that is not there; "
            "docs/scenes.md#what-the-world-has says what is: leave them out",
        ),
        ("gravity = 10\n" + BALL, "x.toml: gravity = 10 is not a pair; write gravity = [0, -10]"),
        (
            BALL + "gravity = [0, 1]\n",
            "x.toml: circle 'a': gravity: one holds for the whole scene; write it above the first table",
        ),
        (
            "reverse_at = 3\ngravity = [0, -10]\n" + BALL + "fixed = true\n",
            "x.toml: gravity: circle 'a' is fixed, and no run is turned back there; leave reverse_at out",
        ),
        (
            BALL + "restitution = 1\n",
            "x.toml: circle 'a': restitution: one holds for the whole scene; write it above the first table",
        ),
        ("restitution = 2\n" + BALL, "x.toml: restitution = 2: is not in 0 to 1; write a number from 0 to 1"),
        (
            "[[joints]]\nx = 1\n" + BALL,
            "x.toml: joints: physics that is not there; docs/scenes.md#what-the-world-has says what is: leave it out",
        ),
        (
            BALL + "vx = true",
            "x.toml: circle 'a': vx = true is not a number; write a whole number or text such as \"9/4\"",
        ),
        (
            BALL + "vx = [1]",
            "x.toml: circle 'a': vx = [1] is not a number; write a whole number or text such as \"9/4\"",
        ),
        (
            BALL + "vx = 1979-05-27",
            "x.toml: circle 'a': vx = datetime.date(1979, 5, 27) is not a number; "
            'write a whole number or text such as "9/4"',
        ),
        (BALL + "point = 1", "x.toml: circle 'a': point = 1 is not true or false"),
        (
            BALL + "point = true",
            "x.toml: circle 'a': r = 1: a point ball has r = 0; leave out point, or set r = 0",
        ),
        ("capture = 0\n" + BALL, "x.toml: capture = 0 is not true or false"),
        ("name = 1\n" + BALL, "x.toml: name = 1 is not text; put it in quotes"),
        ("events = 1.0\n" + BALL, "x.toml: events = 1.0: must be a whole number from 1"),
        ("events = 0\n" + BALL, "x.toml: events = 0: must be a whole number from 1"),
        ("until = -1\n" + BALL, "x.toml: until = -1: must be above zero"),
        (
            "tie_policy = 'fair'\n" + BALL,
            "x.toml: tie_policy 'fair' is not known; choose simultaneous, sequential:order=scene or sequential:seed=N",
        ),
        (
            BALL + BALL,
            "x.toml: id 'a' is used twice; give everything an id of its own",
        ),
        (
            BALL + BALL.replace('"a"', '"b"'),
            "x.toml: circle 'b': overlaps 'a' by 2 at time 0; move it, or reduce r",
        ),
        (
            BALL + '[[wall]]\nid = "w"\nx0 = 5\ny0 = 0\nx1 = 5',
            "x.toml: wall 'w': y1 is missing; write y1 = ...",
        ),
        (BALL + '[[pocket]]\nid = "p"\nx = 5\ny = 0', "x.toml: pocket 'p': r is missing; write r = ..."),
        (
            BALL + "vx = " + "1" * 5000,
            'x.toml: a bare whole number has more than 4300 digits; put it in quotes: "123..."',
        ),
        ("a.b.c.d.e.f.g.h.i.j = 1", "x.toml: line 1: 'a.b.c.d.e.f.g.h.i' is a dotted key; write a plain one"),
    ],
)
def test_bad_toml_is_refused_with_the_reason(text: str, message: str) -> None:
    assert toml_refusal(text) == message


@pytest.mark.parametrize(
    "says", ['m = "oo"', 'm = "inf"', "m = inf", "m = +inf", "fixed = true", 'fixed = true\nm = "oo"']
)
def test_a_fixed_circle_may_be_said_in_the_words_of_other_engines(says: str) -> None:
    (circle,) = loads_toml(BALL + says).circles
    assert (circle.fixed, circle.m) == (True, "oo")
    assert loads_toml(BALL + "fixed = false").circles[0].m == Circle(0, 0, fixed=False).m == 1
    assert Circle(0, 0, fixed=True) == Circle(0, 0, m="inf") == Circle(0, 0, m="oo")
    assert loads_json(BALL_JSON.format('"m": Infinity')).circles[0].fixed
    with pytest.raises(SceneError, match="circle: fixed = true with m = 3"):
        Circle(0, 0, m=3, fixed=True)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "x.json: is empty; write at least one circle"),
        ("{", "x.json: not JSON: Expecting property name enclosed in double quotes (at line 1, column 2)"),
        ("[]", 'x.json: a list is not a scene; write an object such as {"circle": [...]}'),
        ("null", 'x.json: null is not a scene; write an object such as {"circle": [...]}'),
        ('"x"', "x.json: 'x' is not a scene; write an object such as {\"circle\": [...]}"),
        ("{}", "x.json: the scene has no circle; add at least one circle"),
        ('{"name": "a", "name": "b"}', "x.json: key 'name' is written twice in one object; keep one"),
        (
            '{"circle": {"id": "a"}}',
            "x.json: circle = {'id': 'a'} is not a list of tables; write \"circle\": [{...}, {...}]",
        ),
        (
            '{"circle": [{"id": "a", "x": NaN, "y": 0, "r": 1}]}',
            "x.json: circle 'a': x = NaN is not a finite number",
        ),
        (
            '{"circle": [{"id": "a", "x": -Infinity, "y": 0, "r": 1}]}',
            "x.json: circle 'a': x = -Infinity is not a finite number",
        ),
        (
            '{"circle": [{"id": "a", "x": null, "y": 0, "r": 1}]}',
            "x.json: circle 'a': x = null is not a number; write a whole number or text such as \"9/4\"",
        ),
        ('{"circle": [{"id": null}]}', "x.json: circle 1: id = null is not text; put it in quotes"),
        ('{"circle": [], "walls": []}', "x.json: key 'walls' is not known; did you mean 'wall'?"),
    ],
)
def test_bad_json_is_refused_with_the_reason(text: str, message: str) -> None:
    assert json_refusal(text) == message


JSON_BALL = '{{"circle": [{{"id": "a", "x": {}, "y": 0, "r": 1}}]}}'
LONG = 10_000_000

CALLS = 5_000_000
"""Far fewer than a square of any of these lengths, and no more than some for each character."""


@pytest.mark.parametrize(
    "text",
    [
        BALL.replace("x = 0", f'x = "{"1" * LONG}"'),
        BALL.replace("x = 0", f'x = "{"1" * 99_000}"'),
        BALL.replace("x = 0", f"x = {'1' * LONG}"),
        BALL.replace("x = 0", f"x = 0x{'f' * 90_000}"),
        BALL.replace("x = 0", f"x = 0.{'1' * 90_000}"),
        BALL.replace('"a"', f'"{"a" * 90_000}"'),
        BALL + "z" * 90_000 + " = 1",
        "tie_policy = '" + "z" * 90_000 + "'\n" + BALL,
        "events = 0x" + "f" * 90_000 + "\n" + BALL,
        "x = " + "[" * 90_000,
        "x = " + "[" * LONG,
        "x = " + "{a = " * 15_000,
        ".".join(["a"] * 40_000) + " = 1",
        ".".join(["1"] * 40_000) + " = 1",
        ".".join(['"\\""'] * 20_000) + " = 1",
        " . ".join(["'.'"] * 15_000) + " = 1",
        "'\"" * 45_000,
        "a " * 45_000,
        "a . " * 8 + " " * 90_000,
        ("[" + ".".join(["a"] * 40_000) + "]\n") * 20,
        "\x00" * 1000,
        "#" * LONG,
    ],
    ids=lambda text: f"{text[:12]!a} {len(text)}",
)
def test_hostile_toml_is_refused_at_once(text: str) -> None:
    told: list[str] = []
    assert calls(lambda: told.append(toml_refusal(text))) < CALLS
    (message,) = told
    assert len(message) < 300
    assert "\n" not in message


@pytest.mark.parametrize(
    "text",
    [
        JSON_BALL.format(f'"{"1" * LONG}"'),
        JSON_BALL.format("1" * LONG),
        JSON_BALL.format("1" * 6000 + "0" * 30_000),
        JSON_BALL.format("0." + "1" * LONG),
        JSON_BALL.format("1e" + "9" * LONG),
        JSON_BALL.format("[" * LONG),
        "[" * LONG,
        '{"a":' * 2_000_000,
        JSON_BALL.format("[" + "1," * 1_000_000 + "1]"),
        '{"circle": [' + "{}," * 1_000_000 + "{}]}",
        json.dumps({"x" * LONG: 1}),
        json.dumps({"circle": [{"id": "x" * LONG, "x": 0, "y": 0, "r": 1}]}),
        json.dumps({"name": "x", "tie_policy": "x" * LONG}),
    ],
    ids=lambda text: f"{text[:12]!a} {len(text)}",
)
def test_hostile_json_is_refused_at_once(text: str) -> None:
    told: list[str] = []
    assert calls(lambda: told.append(json_refusal(text))) < CALLS
    (message,) = told
    assert len(message) < 300
    assert "\n" not in message


def test_a_file_that_cannot_be_read_is_named(tmp_path: Path) -> None:
    def refusal(path: Path) -> str:
        with pytest.raises(SceneError) as error:
            load_scene(path)
        return str(error.value).replace(str(tmp_path), "DIR")

    folder, binary, empty, odd = (tmp_path / name for name in ("d.toml", "b.toml", "e.json", "x.yaml"))
    folder.mkdir()
    binary.write_bytes(b"name = \xff\xfe\x00")
    empty.write_bytes(b"")
    odd.write_text(BALL)
    large = tmp_path / "large.toml"
    with large.open("wb") as file:
        file.truncate(3_000_000_000)
    assert refusal(tmp_path / "none.toml") == "DIR/none.toml: no such file; check the path"
    assert refusal(folder) == "DIR/d.toml: is a directory; give the path of a scene file"
    assert refusal(binary) == "DIR/b.toml: is not UTF-8 text (at byte 7); save it as UTF-8"
    assert refusal(empty) == "DIR/e.json: is empty; write at least one circle"
    assert refusal(odd) == "DIR/x.yaml: a scene file ends in .toml or .json, not in '.yaml'; rename it"
    assert refusal(tmp_path / "none") == "DIR/none: a scene file ends in .toml or .json, not in ''; rename it"
    assert refusal(large) == "DIR/large.toml: has 3000000000 bytes; at most 2000000 for .toml"
    assert "cannot be read" in refusal(tmp_path / "a\0b.toml")
    assert "cannot be read" in refusal(tmp_path / ("a" * 500 + ".toml"))


@pytest.mark.skipif(sys.platform == "win32", reason="named pipes are a thing of POSIX")
def test_a_pipe_is_not_waited_for(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe.toml"
    os.mkfifo(pipe)
    with pytest.raises(SceneError, match="is not a regular file"):
        load_scene(pipe)


def test_the_limits_are_those_that_the_pages_promise(root: Path) -> None:
    promised = (root / "SECURITY.md").read_text("utf-8")
    assert f"{MAX_TOML // 10**6} MB of TOML, {MAX_JSON // 10**6} MB of JSON, {MAX_CIRCLES:,} circles" in promised
    page = (root / "docs" / "scenes.md").read_text("utf-8")
    told = f"at most {MAX_CIRCLES:,} circles, a TOML file {MAX_TOML // 10**6} MB, a JSON file {MAX_JSON // 10**6} MB"
    assert told in " ".join(page.split())
    for name in ("MAX_LENGTH", "MAX_DEPTH", "MAX_EXPONENT", "MAX_BITS", "MAX_TERMS"):
        assert f"| {getattr(parsing, name):,} | `{name}` |" in page


DOES = """\
import json, sys
from truebreak.scenarios.files import load_scene
from truebreak.scenarios import SceneError
def loaded(path):
    try:
        load_scene(path)
    except SceneError as error:
        assert "\\n" not in str(error)
for path in sys.argv[1:]:  # what is imported is imported now
    loaded(path)
seen = []
def hook(event, arguments):
    if event in ("open", "import", "exec", "compile") or event.startswith(("os.", "subprocess", "socket", "ctypes")):
        seen.append((event, str(arguments[0])))
sys.addaudithook(hook)
for path in sys.argv[1:]:
    loaded(path)
print(json.dumps(seen))
"""


def test_of_a_file_nothing_is_evaluated_imported_or_opened(tmp_path: Path) -> None:
    """Python itself says what is opened, imported, compiled, executed and asked of the system: each file, once."""
    mischief = [
        "__import__('os').system('true')",
        "open('/etc/passwd')",
        "exec('1')",
        "lambda: 1",
        "(1).__class__",
        "os",
    ]
    texts = [f'{BALL}vx = "{text}"\n' for text in mischief]
    texts += [f"name = \"{text}\"\ninclude = '/etc/passwd'\n{BALL}" for text in mischief]
    files = [tmp_path / f"{number}.toml" for number in range(len(texts))]
    for file, text in zip(files, texts, strict=True):
        file.write_text(text, "utf-8")
    good = tmp_path / "good.json"
    good.write_text(BALL_JSON.format('"vx": "sqrt(2)/3"'), "utf-8")
    done = subprocess.run([sys.executable, "-c", DOES, *map(str, [*files, good])], capture_output=True, check=True)
    assert json.loads(done.stdout) == [["open", str(file)] for file in [*files, good]]
