"""Every example runs: those of the docstrings, and the code blocks of the README and of docs/."""

from __future__ import annotations

import doctest
import importlib
import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

import pytest

from truebreak.compare.cli import main

ROOT = Path(__file__).resolve().parent.parent
FOLDERS = ("scenarios", "tools", "exact", "floating", "compare")
MODULES = ["truebreak", "truebreak.testing", "truebreak.pymunk"] + [
    "truebreak." + ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")
    for folder in FOLDERS
    for path in sorted((ROOT / folder).rglob("*.py"))
]
STUDIES = [path.stem for path in sorted((ROOT / "docs" / "studies").glob("*.py"))]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
BLOCK = re.compile(r"^```(?P<language>[\w-]*)(?P<info>[^\n]*)\n(?P<text>.*?)^```\s*$", re.MULTILINE | re.DOTALL)
SHELLS = ("sh", "bash", "shell", "console")
FILE = re.compile(r"(?:#|//) (?P<name>[\w-]+\.(?:toml|py|c))\n")
COMMAND = re.compile(r"^(?:\$ )?(?:\.venv/bin/)?(?P<command>truebreak .+)$")
NOT_RUN = ("truebreak bench", "truebreak survey")
"""Commands whose examples take minutes."""

SHELL = re.compile(r"[|&;<>*?$`~]")
"""What a shell does for a command, beside splitting it into words."""

RESULTS = (0, 1, 4)
"""Exit codes of a command that did its work: agree, diverged, undecided."""


class Example(NamedTuple):
    """Code of one language on one page, with the line that it starts at."""

    page: str
    line: int
    text: str

    def __str__(self) -> str:
        return f"{self.page}:{self.line}"

    @property
    def name(self) -> str:
        """What a test of it is called: its first line, so that `durations.json` knows it wherever it stands."""
        return f"{self.page}: {self.text.partition(chr(10))[0]}"


def blocks(*languages: str, session: bool = False) -> list[Example]:
    """The code blocks of all pages in these languages; those marked `session`, which run in order, or the others."""
    found = []
    for page in PAGES:
        text = page.read_text("utf-8")
        for match in BLOCK.finditer(text):
            if match["language"] in languages and (match["info"].strip() == "session") == session:
                line = text.count("\n", 0, match.start("text")) + 1
                found.append(Example(page.relative_to(ROOT).as_posix(), line, match["text"]))
    return found


def commands() -> list[Example]:
    """The lines of shell blocks that call truebreak, with continued lines joined."""
    found = []
    for block in blocks(*SHELLS):
        for number, line in enumerate(block.text.replace("\\\n", " ").splitlines()):
            match = COMMAND.match(line.partition(" #")[0].strip())
            if match and not match["command"].startswith(NOT_RUN):
                found.append(Example(block.page, block.line + number, match["command"]))
    return found


def write_files(page: str, folder: Path) -> None:
    """Writes the page's blocks that begin with a file's name, `# name.toml`, where its other examples can read them."""
    for example in blocks("toml", "python", "c"):
        if example.page == page and (match := FILE.match(example.text)):
            (folder / match["name"]).write_text(example.text, "utf-8")


@pytest.mark.parametrize("module", [*MODULES, *STUDIES])
def test_docstring_examples_give_what_they_show(module: str) -> None:
    failed, _ = doctest.testmod(importlib.import_module(module))
    assert failed == 0


@pytest.mark.parametrize("page", [path.relative_to(ROOT).as_posix() for path in PAGES])
def test_python_blocks_of_a_page_run_in_order(page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A page's blocks share their names; a block with prompts must also print what it shows."""
    monkeypatch.chdir(tmp_path)
    write_files(page, tmp_path)
    names: dict[str, object] = {"__name__": "example"}
    for example in blocks("python", "pycon"):
        if example.page != page:
            continue
        if ">>> " in example.text:
            test = doctest.DocTestParser().get_doctest(example.text, names, str(example), page, example.line)
            assert doctest.DocTestRunner().run(test, clear_globs=False).failed == 0, str(example)
            names = test.globs
        else:
            exec(compile(example.text, str(example), "exec", dont_inherit=True), names)


@pytest.mark.parametrize("example", commands(), ids=lambda example: example.name)
def test_commands_of_the_pages_do_their_work(
    example: Example, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    """In this process, as importing takes longer than most of them; what needs a shell has one."""
    write_files(example.page, tmp_path)
    monkeypatch.chdir(tmp_path)
    text = example.text.replace("--count 100000", "--count 2000")  # vectors: minutes, and nothing else
    if SHELL.search(text):
        path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
        monkeypatch.setenv("PATH", path)
        code = subprocess.run(text, shell=True, stdin=subprocess.DEVNULL, check=False).returncode
    else:
        with pytest.raises(SystemExit) as stop:
            main(shlex.split(text)[1:])
        code = int(stop.value.code or 0)
    errors = capfd.readouterr().err
    assert code in RESULTS, f"{text}\nexit code {code}\n{errors}"
    assert "Traceback" not in errors


@pytest.mark.parametrize("example", blocks(*SHELLS, session=True), ids=lambda example: example.name)
def test_sessions_of_the_pages_do_their_work(example: Example, tmp_path: Path) -> None:
    """Line by line in one folder, in which the page's files lie."""
    write_files(example.page, tmp_path)
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
    for line in example.text.replace("\\\n", " ").splitlines():
        if line.startswith("cc ") and shutil.which("cc") is None:
            pytest.skip("there is no C compiler")
        done = subprocess.run(
            line,
            shell=True,
            cwd=tmp_path,
            env={**os.environ, "PATH": path},
            capture_output=True,
            text=True,
            stdin=subprocess.DEVNULL,
            check=False,
        )
        assert done.returncode in (RESULTS if line.startswith("truebreak ") else (0,)), f"{line}\n{done.stderr}"
        assert "Traceback" not in done.stderr


def test_acceptance_runs_the_readme_s_test_command() -> None:
    shell = "\n".join(block.text for block in blocks(*SHELLS) if block.page == "README.md")
    if not shell:
        pytest.skip("the README shows no command")
    (command,) = re.findall(r"^python3 -m venv .*pytest.*$", (ROOT / ".ci" / "run").read_text("utf-8"), re.MULTILINE)
    assert command in shell.replace("$ ", ""), f"the README must show the command that .ci/run runs: {command}"


UNLOCKS = re.compile(r"skipif\(found\(\) is None|find_spec\((PACKAGES|OPTIONAL)\[|find_spec\(\"Box2D|in installed\(\)")
"""How a module of tests says that it needs other people's engines or a browser."""


def test_acceptance_runs_all_that_engines_and_a_browser_unlock_with_them_and_once() -> None:
    script = (ROOT / ".ci" / "run").read_text("utf-8")
    listed = re.search(r"^unlocked=\((.*?)^\)", script, re.MULTILINE | re.DOTALL)
    assert listed is not None
    assert '-m long "${unlocked[@]/#/--ignore=}"\n' in script
    assert "-m 'not slow' \"${unlocked[@]}\"\n" in script.partition("the tests that they unlock")[2]
    modules = {path.relative_to(ROOT): path.read_text("utf-8") for path in (ROOT / "tests").rglob("test_*.py")}
    unlocked = {
        path.as_posix() for path, text in modules.items() if UNLOCKS.search(text) and path.name != "test_docs.py"
    }
    assert {*re.findall(r"tests/\S*test_\w+\.py", listed[1])} == unlocked


def test_make_and_the_readme_run_the_same_tests() -> None:
    script = (ROOT / ".ci" / "run").read_text("utf-8")
    makefile = (ROOT / "Makefile").read_text("utf-8")
    (arguments,) = re.findall(r"^python3 -m venv .*\.venv/bin/(python -m pytest.*)$", script, re.MULTILINE)
    assert f"test: .venv/ready\n\t$(BIN)/{arguments}\n" in makefile
