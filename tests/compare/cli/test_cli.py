"""The command line: what it prints where, and its exit codes."""

from __future__ import annotations

import json
import os
import shlex
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from counted import wait_for_work

from truebreak.compare.cli import main
from truebreak.compare.engines import engine, split_engines
from truebreak.compare.files import cache as certified_cache
from truebreak.scenarios import SceneError, catalogue

COMMAND = [sys.executable, "-P", "-m", "truebreak.compare.cli"]


class Said:
    """What one call printed, and its code."""

    def __init__(self, code: int, out: str, err: str) -> None:
        self.code, self.out, self.err = code, out, err


@pytest.fixture
def truebreak(capsys: pytest.CaptureFixture[str]) -> Any:
    """Calls the command line in this process."""

    def call(*words: str) -> Said:
        with pytest.raises(SystemExit) as stop:
            main(list(words))
        captured = capsys.readouterr()
        assert isinstance(stop.value.code, int)
        return Said(stop.value.code, captured.out, captured.err)

    return call


@pytest.fixture
def scene_file(tmp_path: Path) -> Path:
    """Two circles that meet head-on."""
    path = tmp_path / "two.json"
    circles = [
        {"id": "a", "x": 0, "y": 0, "r": 1, "vx": 1, "vy": 0, "m": 1},
        {"id": "b", "x": "7/2", "y": "1/3", "r": 1, "vx": 0, "vy": 0, "m": 1},
    ]
    path.write_text(json.dumps({"name": "two", "circle": circles}), encoding="utf-8")
    return path


def test_help_teaches_and_loads_no_engine() -> None:
    code = (
        "import sys\n"
        "from truebreak.compare.cli import main\n"
        "try:\n    main(['--help'])\n"
        "except SystemExit as stop:\n    assert stop.code == 0\n"
        "heavy = {'sympy', 'pymunk', 'numpy', 'flint', 'mpmath', 'jinja2', 'rich'} & set(sys.modules)\n"
        "assert not heavy, heavy\n"
    )
    done = subprocess.run([sys.executable, "-P", "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "Examples:" in done.stdout
    assert "Exit codes:" in done.stdout


@pytest.mark.parametrize(
    "words", [["--help"], ["run", "--help"], ["compare", "-h"], ["--version"], ["bench", "--help"]]
)
def test_help_is_done(truebreak: Any, words: list[str]) -> None:
    said = truebreak(*words)
    assert (said.code, said.err) == (0, "")
    assert said.out


def test_nothing_asked_for_is_usage(truebreak: Any) -> None:
    said = truebreak()
    assert (said.code, said.out) == (2, "")
    assert said.err.startswith("Usage:")


def test_scenes_lists_the_catalogue(truebreak: Any) -> None:
    said = truebreak("scenes")
    assert said.code == 0
    assert all(name in said.out for name in catalogue.names())
    told = json.loads(truebreak("scenes", "--json").out)
    assert [row["name"] for row in told["scenes"]] == list(catalogue.names())


def test_show_prints_exact_numbers_and_draws(truebreak: Any, scene_file: Path, tmp_path: Path) -> None:
    said = truebreak("show", str(scene_file), "--plot", str(tmp_path / "two.svg"))
    assert said.code == 0
    assert "7/2" in said.out
    assert (tmp_path / "two.svg").read_text(encoding="utf-8").startswith("<svg")
    assert json.loads(truebreak("show", str(scene_file), "--json").out)["circle"][1]["x"] == "7/2"


@pytest.mark.parametrize("name", ["exact", "double", "interval", "pymunk", "sympy"])
def test_run_prints_one_object(truebreak: Any, scene_file: Path, name: str) -> None:
    said = truebreak("run", str(scene_file), "--engine", name, "--until", "5", "--json", "--exact")
    assert (said.code, said.err) == (0, "")
    told = json.loads(said.out)
    assert told["engine"]["name"] == name
    assert told["events"][0]["contacts"] == [["a", "b"]]
    assert told["events"][0]["time"] == pytest.approx(1.5279806, abs=0.01)


def test_run_for_people(truebreak: Any, scene_file: Path) -> None:
    said = truebreak("run", str(scene_file), "--exact", "--reverse-after", "1", "--tie-policy", "sequential")
    assert said.code == 0
    assert "sqrt" in said.out
    assert "\x1b" not in said.out


def test_limits_hold(truebreak: Any) -> None:
    told = json.loads(truebreak("run", "galperin:n=1", "--events", "5", "--json").out)
    assert len(told["events"]) == 5
    assert told["stop"]["reason"] == "events"
    told = json.loads(truebreak("run", "galperin:n=1", "--json").out)
    assert told["collisions"] == 31
    assert told["stop"]["reason"] == "quiet"


@pytest.mark.parametrize(
    ("words", "code", "verdict"),
    [
        (["cradle:gap=0", "--engines", "double"], 0, "agree"),
        (["near-tie:k=40", "--engines", "double"], 1, "diverged"),
        (["cradle", "--engines", "double,interval"], 4, "undecided"),
        (["cradle", "--engines", "interval:bits=200"], 0, "agree"),
    ],
)
def test_compare_says_it_by_exit_code(truebreak: Any, words: list[str], code: int, verdict: str) -> None:
    said = truebreak("compare", *words, "--json")
    assert (said.code, said.err) == (code, "")
    assert json.loads(said.out)["verdict"] == verdict


def test_run_that_cannot_decide_says_so(truebreak: Any) -> None:
    said = truebreak("run", "cradle", "--engine", "interval")
    assert said.code == 4
    assert "undecided" in said.out


def test_compare_leads_with_the_verdict(truebreak: Any) -> None:
    said = truebreak("compare", "near-tie:k=40", "--engines", "double", "-v")
    lines = said.out.splitlines()
    assert lines[0] == "Floating point changed what happened: double diverges at event 0 of 4."
    assert (
        "double first differs at event 0 (t = 1): circle middle meets left and right at once where it should meet "
        "left, then right."
    ) in lines
    assert "margin: in the exact motion, had the first not happened, the second came 1e-40 later" in said.out
    assert "\x1b" not in said.out


BAD = [
    (["run", "nonesuch"], "nonesuch"),
    (["run", "galperin:m=1"], "m"),
    (["run", "missing.toml"], "missing.toml"),
    (["run", "galperin", "--engine", "exakt"], "did you mean 'exact'"),
    (["run", "galperin", "--engine", "pymunk:td=1"], "td"),
    (["run", "galperin", "--engine", "pymunk:dt=0"], "dt"),
    (["run", "galperin", "--engine", "pymunk:iterations=many"], "iterations"),
    (["run", "galperin", "--engine", "pymunk:dt"], "dt"),
    (["run", "galperin", "--events", "0"], "--events"),
    (["run", "galperin", "--events", "-3"], "--events"),
    (["run", "galperin", "--events", "ten"], "--events"),
    (["run", "galperin", "--until", "-1"], "until"),
    (["run", "galperin", "--until", "__import__('os')"], "until"),
    (["run", "galperin", "--until", "9**9**9"], "until"),
    (["run", "galperin", "--until", "nan"], "until"),
    (["run", "galperin", "--reverse-after", "0"], "--reverse-after"),
    (["run", "galperin", "--tie-policy", "fair"], "fair"),
    (["run", "galperin", "--ties", "maybe"], "maybe"),
    (["run", "galperin", "--ties", "assume:0"], "assume:0"),
    (["run", "galperin", "--ties", "probable"], "choose proved, or assume:BITS"),
    (["compare", "galperin", "--ties", "probable"], "choose proved, or assume:BITS"),
    (["run", "galperin", "--work", "0"], "--work"),
    (["run", "galperin", "--engine", "double", "--work", "9"], "work"),
    (["orders", "galperin", "--engine", "double", "--work", "9"], "work"),
    (["run", "galperin", "--max-seconds", "0"], "--max-seconds"),
    (["compare", "galperin", "--max-seconds", "-1"], "--max-seconds"),
    (["orders", "galperin", "--max-seconds", "nan"], "--max-seconds"),
    (["run", "galperin", "--engine", "double", "--ties", "proved"], "ties"),
    (["compare", "galperin", "--engines", ""], "engine"),
    (["compare", "galperin", "--engines", "double,dubble"], "dubble"),
    (["compare", "galperin", "--html", "no/such/folder/report.html"], "no/such/folder"),
    (["show", "galperin", "--plot", "picture.png"], ".svg"),
    (["show", "galperin", "--plot", "no/such/folder/picture.svg"], "no/such/folder"),
    (["frobnicate"], "frobnicate"),
    (["run"], "SCENE"),
    (["run", "galperin", "--frob"], "--frob"),
]


@pytest.mark.parametrize(("words", "named"), BAD, ids=[" ".join(words) for words, _ in BAD])
def test_bad_input_is_one_line_and_code_2(truebreak: Any, words: list[str], named: str) -> None:
    said = truebreak(*words)
    assert (said.code, said.out) == (2, "")
    assert said.err.startswith("truebreak: error: ")
    assert len(said.err.splitlines()) == 1
    assert named in said.err


@pytest.mark.parametrize("content", [b"", b"\x00\xff\xfe", b"{", b"[]", b'{"circle": 3}'])
@pytest.mark.parametrize("suffix", [".toml", ".json"])
def test_bad_files_are_named(truebreak: Any, tmp_path: Path, content: bytes, suffix: str) -> None:
    path = tmp_path / f"bad{suffix}"
    path.write_bytes(content)
    said = truebreak("run", str(path))
    assert (said.code, said.out) == (2, "")
    assert str(path) in said.err
    assert len(said.err.splitlines()) == 1


def test_an_internal_error_is_one_line_without_debug(truebreak: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(text: str) -> Any:
        raise RuntimeError("a bug\nin two lines")

    monkeypatch.setattr(certified_cache, "engine_named", broken)
    said = truebreak("run", "galperin")
    assert said.code == 3
    assert said.err == ("truebreak: internal error: RuntimeError: a bug in two lines (add --debug for the traceback)\n")
    assert "Traceback" in truebreak("run", "galperin", "--debug").err


def test_a_written_report_is_whole(truebreak: Any, tmp_path: Path) -> None:
    path = tmp_path / "report.html"
    assert truebreak("compare", "lee", "--engines", "double", "--html", str(path)).code == 0
    assert path.read_text(encoding="utf-8").rstrip().endswith("</html>")
    assert [p.name for p in tmp_path.iterdir()] == ["report.html"]


def test_an_interruption_is_130_and_leaves_no_file(tmp_path: Path) -> None:
    path = tmp_path / "report.html"
    words = ["compare", "gas:n=10", "--events", "40000", "--html", str(path)]
    running = subprocess.Popen(
        [*COMMAND, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True
    )
    try:
        wait_for_work(running, 1.5)
        running.send_signal(signal.SIGINT)
        out, err = running.communicate(timeout=30)
    finally:
        running.kill()
    assert running.returncode == 130, err
    assert out == ""
    assert err == "truebreak: interrupted\n"
    assert list(tmp_path.iterdir()) == []


def test_a_closed_pipe_is_no_error() -> None:
    read, write = os.pipe()
    os.close(read)
    done = subprocess.run([*COMMAND, "scenes"], stdout=write, stderr=subprocess.PIPE, text=True, check=False)
    os.close(write)
    assert (done.returncode, done.stderr) == (141, "")


def test_engines_are_built_from_text() -> None:
    built: Any = engine("pymunk:dt=1/1000,iterations=30")
    assert (built.dt, built.iterations) == (0.001, 30)
    assert split_engines("double, pymunk:dt=1/100,iterations=3 ,interval:bits=80") == [
        "double",
        "pymunk:dt=1/100,iterations=3",
        "interval:bits=80",
    ]
    with pytest.raises(SceneError, match="set twice"):
        engine("pymunk:dt=1,dt=2")


def test_the_python_of_the_command_line() -> None:
    import truebreak.compare

    comparison = truebreak.compare.compare(catalogue.build("lee"), ["double"])
    assert comparison["double"].verdict == "agree"
    assert "compare" in dir(truebreak.compare)
    with pytest.raises(AttributeError):
        truebreak.compare.nonesuch  # noqa: B018
    with pytest.raises(KeyError):
        comparison["pymunk"]


@pytest.mark.parametrize("words", [["scenes"], ["run", "lee", "--json"], ["compare", "lee", "--engines", "double"]])
def test_a_full_disk_is_one_line(words: list[str]) -> None:
    full = Path("/dev/full")
    if not full.exists():
        pytest.skip("no /dev/full here")
    with full.open("w", encoding="utf-8") as out:
        done = subprocess.run([*COMMAND, *words], stdout=out, stderr=subprocess.PIPE, text=True, check=False)
    assert done.returncode == 2
    assert done.stderr == "truebreak: error: standard output: No space left on device; write to another place\n"


@pytest.mark.parametrize("closed", [">&-", "2>&-", ">&- 2>&-"])
@pytest.mark.parametrize(("words", "code"), [("run lee", 0), ("run lee --json", 0), ("run nonesuch", 2)])
def test_a_closed_stream_does_not_change_the_code(words: str, closed: str, code: int) -> None:
    command = f"{shlex.quote(sys.executable)} -P -m truebreak.compare.cli {words} {closed}"
    done = subprocess.run(["sh", "-c", command], capture_output=True, text=True, check=False)
    assert done.returncode == code
    assert "Traceback" not in done.stderr
    assert "Exception" not in done.stderr


@pytest.mark.parametrize("engine_name", ["double", "interval", "pymunk"])
def test_a_time_beyond_the_doubles_is_refused(truebreak: Any, engine_name: str) -> None:
    for words in (["run", "lee", "--engine", engine_name], ["compare", "lee", "--engines", engine_name]):
        said = truebreak(*words, "--until", "1e400")
        assert said.code == 2
        assert "beyond" in said.err
    assert truebreak("run", "lee", "--until", "1e400").code == 0


def test_the_code_of_what_is_not_settled() -> None:
    from dataclasses import replace

    from truebreak.compare import compare
    from truebreak.compare.cli.progress import ExitCode, of_comparison
    from truebreak.scenarios import catalogue

    comparison = compare(catalogue.build("lee"), ["double"])
    assert of_comparison(comparison) is ExitCode.DONE
    (candidate,) = comparison.candidates
    open_end = replace(candidate, alignment=replace(candidate.alignment, unsettled=True))
    unsettled = replace(comparison, candidates=(open_end,))
    assert unsettled.verdict == "unsettled"
    assert of_comparison(unsettled) is ExitCode.UNDECIDED


FAINT = """
[[circle]]
id = "a"
x = 0
y = "10**-330"
r = 1

[[circle]]
id = "b"
x = 0
y = 5
r = 1
vy = "-10**-330"

[[circle]]
id = "c"
x = 50
y = "sqrt(2 + sqrt(3))*10**-900"
r = 1
vx = "sqrt(2)*10**400"
"""


def test_0_is_printed_of_proved_zeros_alone(truebreak: Any, tmp_path: Path) -> None:
    path = tmp_path / "faint.toml"
    path.write_text(FAINT)
    said = truebreak("run", str(path))
    assert said.code == 0
    rows = [line.split() for line in said.out.splitlines()]
    lines = {row[0]: row[1:] for row in rows if row and row[0] in ("a", "b", "c")}
    assert lines == {
        "a": ["0", "1e-330", "0", "-1e-330"],
        "b": ["0", "2", "0", "0"],
        "c": ["4.24264068712e+730", "1.93185165258e-900", "1.41421356237e+400", "0"],
    }


@pytest.mark.parametrize("engine_name", ["double", "single", "quad", "rounded", "pymunk"])
def test_a_scene_beyond_the_doubles_is_refused(truebreak: Any, tmp_path: Path, engine_name: str) -> None:
    path = tmp_path / "vast.toml"
    path.write_text(FAINT)
    said = truebreak("run", str(path), "--engine", engine_name, "--until", "3")
    assert said.code == 2
    assert "beyond 1e308" in said.err
