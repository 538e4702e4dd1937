"""What helps at the command line: examples that hold, completion in three shells, progress with the time left."""

from __future__ import annotations

import gc
import io
import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import click
import pytest
from click.shell_completion import ShellComplete
from command_line import said

from truebreak.compare.cli import main, progress
from truebreak.compare.cli.entry import cli
from truebreak.compare.cli.options import LINES, command_of
from truebreak.compare.cli.progress import Pace, ProgressLine, RunEnd, goal_of, showing
from truebreak.scenarios import catalogue
from truebreak.scenarios.trajectory import Progress

COMMAND = "import sys; sys.argv[0] = 'truebreak'; from truebreak.compare.cli import main; main()"


def parent() -> click.Context:
    """The context that commands are read in: click keeps the first that it sees for the names of help."""
    return click.Context(cli, info_name="truebreak", **cli.context_settings)


def shown(command: click.Command) -> list[str]:
    """The examples at the end of a command's help, without what is said of them."""
    return re.findall(r"^  (truebreak .*?)(?:  .*)?$", command.epilog or "", re.MULTILINE)


EXAMPLES = [line for command in (cli, *cli.commands.values()) for line in shown(command)]


@pytest.mark.parametrize("line", EXAMPLES)
def test_examples_in_the_help_are_commands(line: str) -> None:
    """Each is read by the command line as it is run, up to the command's body."""
    _, name, *words = shlex.split(line.partition(" > ")[0])
    command = cli.commands[name]
    with command.make_context(name, words, parent=parent()) as context:
        scene = context.params.get("scene")
        assert scene is None or scene.endswith(".toml") or catalogue.build(scene)


def test_every_command_has_examples() -> None:
    assert LINES.keys() <= cli.commands.keys()
    for name, command in cli.commands.items():
        if name == "bench":  # whose own help is printed by another reader
            continue
        assert any(line.split()[1] == name for line in shown(command)), name
        assert all(line in shown(command) for line in LINES.get(name, ()))


@pytest.mark.parametrize("name", ["", *sorted(cli.commands)])
def test_help_is_whole_at_80_columns(
    name: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """No line is wider, and no summary of a command ends in dots."""
    monkeypatch.setenv("COLUMNS", "80")
    with pytest.raises(SystemExit) as stop:
        main([name, "--help"] if name else ["--help"])
    assert stop.value.code == 0
    usage, *lines = capsys.readouterr().out.splitlines()
    assert usage.startswith("Usage: truebreak")
    assert [line for line in lines if len(line) > 80] == []
    assert name or [line for line in lines if line.endswith("...")] == []


def test_a_command_is_told_again_as_it_was_given() -> None:
    words = ["rack:rows=2", "--events", "9", "--html", "a page.html", "--engines", "double,pymunk:dt=1/10", "--certify"]
    compare = cli.commands["compare"]
    with compare.make_context("compare", list(words), parent=parent()) as context:
        told = command_of(context)
    assert told.startswith("truebreak compare rack:rows=2 ")
    assert sorted(shlex.split(told)) == sorted(["truebreak", "compare", *words])
    with compare.make_context("compare", shlex.split(told)[2:], parent=parent()) as again:
        assert again.params == context.params


def completed(shell: str, words: str, word: str) -> str:
    """What a shell is offered for the last of some words."""
    told = {"COMP_WORDS": words, "COMP_CWORD": word, "_TRUEBREAK_COMPLETE": f"{shell}_complete"}
    done = subprocess.run(
        [sys.executable, "-P", "-c", COMMAND], env={**os.environ, **told}, capture_output=True, text=True, check=False
    )
    assert done.stderr == ""
    return done.stdout.replace("\\:", ":")  # zsh has a colon escaped


@pytest.mark.parametrize(("shell", "place"), [("bash", True), ("zsh", True), ("fish", False)])
def test_shells_complete_scenes_their_parameters_and_engines(shell: str, place: bool) -> None:
    def offered(*words: str) -> str:
        return completed(shell, " ".join(["truebreak", *words]), str(len(words)) if place else words[-1])

    assert "galperin" in offered("compare", "gal")
    assert "rack:rows=2,pockets=" in offered("show", "rack:rows=2,po")
    assert "rows=" not in offered("show", "rack:rows=2,ro")
    assert "double,pymunk:iterations=" in offered("compare", "gas", "--engines", "double,pymunk:it")
    assert "interval" in offered("run", "gas", "--engine", "int")


def test_every_command_completes_its_scene_and_its_engines() -> None:
    """Whatever takes a scene or an engine, under any command: a new one cannot be forgotten."""
    told = []
    for name, command in cli.commands.items():
        context = click.Context(command, info_name=name, parent=parent())
        for parameter in command.params:
            start = {"scene": "gal", "engine_text": "dou", "engines": "dou", "reference": "dou"}.get(
                parameter.name or ""
            )
            if start is None:
                continue
            offered = [item.value for item in parameter.shell_complete(context, start)]
            assert any(value.startswith(start) for value in offered), f"{name}: {parameter.name}"
            told.append((name, parameter.name))
    assert {("sweep", "scene"), ("sweep", "engines"), ("chaos", "engines"), ("judge", "reference")} <= set(told)


@pytest.mark.parametrize(
    ("words", "typed", "expected"),
    [
        ((), "trade", "tradeoffs"),
        ((), "--s", "--scenes"),
        (("tradeoffs", "--engines"), "double,py", "double,pymunk"),
        (("tradeoffs", "--scenes"), "gas,cra", "gas,cradle"),
        (("--svg",), "a", "a"),
    ],
)
def test_bench_is_completed_as_its_own_reader_has_it(words: tuple[str, ...], typed: str, expected: str) -> None:
    found = ShellComplete(cli, {}, "truebreak", "").get_completions(["bench", *words], typed)
    assert expected in [item.value for item in found]
    assert [item.type for item in found] == ["file"] or "--svg" not in words


FILES = re.compile(r"FILE|LOG\.\.\.|\S+\.json|DIR")


def test_every_file_is_completed() -> None:
    """Whatever is a file or a folder, under any command, is looked up by the shell."""
    told = 0
    for name, command in cli.commands.items():
        context = click.Context(command, info_name=name, parent=parent())
        for parameter in command.params:
            if FILES.fullmatch(parameter.metavar or ""):
                kinds = [item.type for item in parameter.shell_complete(context, "a")]
                assert kinds in (["file"], ["dir"]), f"{name}: {parameter.name}"
                told += 1
    assert told > 20


BASH = """
COMP_WORDBREAKS="${COMP_WORDBREAKS//[:=]/}"; eval "$(_TRUEBREAK_COMPLETE=bash_source truebreak)"
compopt() { echo "$@"; }
COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1))
_truebreak_completion truebreak
printf '%s\\n' "${COMPREPLY[@]}"
"""


@pytest.fixture
def path(tmp_path: Path) -> dict[str, str]:
    """An environment in which `truebreak` is this one."""
    command = tmp_path / "truebreak"
    command.write_text(f'#!/bin/sh\nexec {shlex.quote(sys.executable)} -P -c {shlex.quote(COMMAND)} "$@"\n', "utf-8")
    command.chmod(0o755)
    return {**os.environ, "PATH": f"{tmp_path}{os.pathsep}{os.environ['PATH']}"}


LINES_TO_COMPLETE = [
    (("compare", "galp"), "galperin"),
    (("compare", "rack:ro"), "rack:rows=4"),
    (("sweep", "gas", "--engines", "double,pymunk:it"), "double,pymunk:iterations=64"),
    (("adv",), "advise"),
]


@pytest.mark.skipif(shutil.which("bash") is None, reason="no bash here")
@pytest.mark.parametrize(("words", "expected"), [*LINES_TO_COMPLETE, (("verify", "a"), "-o default")])
def test_bash_itself_completes(words: tuple[str, ...], expected: str, path: dict[str, str]) -> None:
    """By the script that it is given: what it makes of the answers, too."""
    command = ["bash", "--norc", "-c", BASH, "bash", "truebreak", *words]
    done = subprocess.run(command, env=path, capture_output=True, text=True, check=True)
    assert expected in done.stdout.splitlines()


ZSH = """
compdef() { : }
_describe() { print -rl -- "${(@P)3}" }
compadd() { print -rl -- "${(@)${(@P)5}//:/\\\\:}" }
eval "$(_TRUEBREAK_COMPLETE=zsh_source truebreak)"
words=("$@"); CURRENT=$#
_truebreak_completion
"""


@pytest.mark.skipif(shutil.which("zsh") is None, reason="no zsh here")
@pytest.mark.parametrize(("words", "expected"), LINES_TO_COMPLETE)
def test_zsh_itself_completes(words: tuple[str, ...], expected: str, path: dict[str, str]) -> None:
    """By the script that it is given; what zsh shows then is printed in its place."""
    command = ["zsh", "-f", "-c", ZSH, "zsh", "truebreak", *words]
    done = subprocess.run(command, env=path, capture_output=True, text=True, check=True)
    offered = [re.split(r"(?<!\\):", line)[0].replace("\\:", ":") for line in done.stdout.splitlines()]
    assert expected in offered, done.stdout + done.stderr


@pytest.mark.skipif(shutil.which("fish") is None, reason="no fish here")
@pytest.mark.parametrize(("words", "expected"), LINES_TO_COMPLETE)
def test_fish_itself_completes(words: tuple[str, ...], expected: str, path: dict[str, str]) -> None:
    script = "_TRUEBREAK_COMPLETE=fish_source truebreak | source; complete -C $argv[1]"
    command = ["fish", "--no-config", "-c", script, " ".join(["truebreak", *words])]
    done = subprocess.run(command, env=path, capture_output=True, text=True, check=True)
    assert expected in [line.partition("\t")[0] for line in done.stdout.splitlines()]


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_shells_are_given_a_script(shell: str) -> None:
    told = {**os.environ, "_TRUEBREAK_COMPLETE": f"{shell}_source"}
    done = subprocess.run([sys.executable, "-P", "-c", COMMAND], env=told, capture_output=True, text=True, check=False)
    assert "_truebreak_completion" in done.stdout.replace("truebreak_completion", "_truebreak_completion")
    assert done.stdout.count("complet") > 3


def ticking(*seconds: float) -> Pace:
    """A pace whose clock shows these times in turn."""
    left = list(seconds)
    return Pace("gas", RunEnd(events=100, until=50.0), lambda: left.pop(0))


def test_the_time_left_is_that_of_the_end_that_comes_first() -> None:
    pace = ticking(0.0, 10.0, 10.0)
    pace.line(Progress(0, 0.0, "exact"))
    assert pace.line(Progress(20, 25.0, "exact")).endswith("20 of 100 events, time 25, 2 a second, 10 s left")
    assert pace.line(Progress(50, 10.0, "exact")).endswith("5 a second, 10 s left")


def test_work_with_limits_of_its_own_has_no_total() -> None:
    pace = ticking(0.0, 2.0)
    pace.line(Progress(0, 0.0, "why double"))
    assert pace.line(Progress(10, 5.0, "why double")) == "gas: why double: 10 events, time 5, 5 a second"


def test_each_engine_has_a_rate_of_its_own() -> None:
    pace = ticking(0.0, 10.0, 20.0, 22.0)
    pace.line(Progress(0, 0.0, "exact"))
    assert "9 a second" in pace.line(Progress(90, 40.0, "exact, 512 bits"))
    assert "a second" not in pace.line(Progress(5, 3.0, "double"))
    assert "10 a second" in pace.line(Progress(25, 13.0, "double"))


def test_beyond_the_total_no_total_is_told() -> None:
    pace = ticking(0.0, 2.0)
    pace.line(Progress(0, 0.0, ""))
    told = pace.line(Progress(110, 60.0, ""))
    assert "of 100" not in told
    assert "left" not in told


def test_the_goal_is_that_of_the_command_or_of_the_scene() -> None:
    gas = catalogue.build("gas")
    assert goal_of(gas, None, None) == RunEnd(gas.events, None if gas.until is None else float(gas.until))
    assert goal_of(gas, "9/4", 7) == RunEnd(7, 2.25)
    assert goal_of(gas, "nonsense", 7) == RunEnd(7)


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def test_a_line_on_a_terminal_comes_with_what_takes_its_time(monkeypatch: pytest.MonkeyPatch) -> None:
    """What is over at once writes nothing; what is not is told, with the last text, and taken away at its end."""
    monkeypatch.setenv("TERM", "xterm")
    quick, slow = Terminal(), Terminal()
    monkeypatch.setattr(sys, "stderr", quick)
    monkeypatch.setattr(progress, "QUIET_SECONDS", 3600.0)
    with showing("quick") as show:
        assert show is not None
        show("done")
    assert quick.getvalue() == ""
    monkeypatch.setattr(sys, "stderr", slow)
    line = ProgressLine("slow")
    line.write("half of it")
    line.begin()
    line.write("nearly [all] :snake:")
    line.end()
    line.begin()
    assert "nearly [all] :snake:" in slow.getvalue()
    assert slow.getvalue().count("\x1b[?25l") == slow.getvalue().count("\x1b[?25h") == 1


def test_no_line_where_nobody_looks(capsys: pytest.CaptureFixture[str]) -> None:
    with showing("quiet") as show:
        assert show is None
    assert capsys.readouterr().err == ""


COLLECTED = """
import atexit, gc, sys
from truebreak.compare.cli import main
seen = []
gc.callbacks.append(lambda phase, told: seen.append(len(sys.modules)) if phase == "start" else None)
atexit.register(lambda: print(len(seen), sum(many > 200 for many in seen), file=sys.stderr))
main()
"""
"""The command line as a program; how often garbage is looked for, and how often once most modules are there."""


def test_a_short_command_does_not_look_for_garbage_as_it_ends() -> None:
    words = [sys.executable, "-P", "-c", COLLECTED, "run", "gas", "--events", "5"]
    told = subprocess.run(words, capture_output=True, text=True, check=True).stderr
    assert int(told.split()[-1]) == 0, told


def test_called_from_python_it_leaves_the_collector_as_it_was(capsys: pytest.CaptureFixture[str]) -> None:
    before = gc.get_threshold()
    gc.set_threshold(777, 11, 12)
    try:
        assert said(capsys, "run", "gas", "--events", "5")[0] == 0
        assert gc.get_threshold() == (777, 11, 12)
    finally:
        gc.set_threshold(*before)
