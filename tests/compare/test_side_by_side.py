"""Tasks in copies of this process: results, errors, output and progress are those of one after the other."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import textwrap
import time as clock
import warnings
from pathlib import Path
from typing import Any

import pytest

from truebreak.compare import compare
from truebreak.compare.cli import main
from truebreak.compare.grids.goals import HistoryGoal
from truebreak.compare.grids.setting_search import advise
from truebreak.compare.report.documents import comparison_json
from truebreak.compare.report.search_text import advice_json
from truebreak.compare.side_by_side import FORKS, SideBySide
from truebreak.scenarios import SceneError, catalogue
from truebreak.scenarios.trajectory import Progress

TIMES = {"seconds", "processor", "times", "exact_seconds", "alternatives"}  # which are listed by measured cost

copies = pytest.mark.skipif(not FORKS, reason="processes are not copied here")


def without_times(told: Any) -> Any:
    if isinstance(told, dict):
        return {key: without_times(value) for key, value in told.items() if key not in TIMES}
    return [without_times(value) for value in told] if isinstance(told, list) else told


@copies
def test_tasks_are_carried_out_elsewhere_and_at_once() -> None:
    def task(progress: Any) -> tuple[int, float, float]:
        began = clock.monotonic()
        clock.sleep(0.5)
        return os.getpid(), began, clock.monotonic()

    with SideBySide(2) as tasks:
        for name in "ab":
            tasks.add(name, task)
        (one, begin, end), (other, begun, ended) = tasks.result("a"), tasks.result("b")
    assert len({one, other, os.getpid()}) == 3
    assert max(begin, begun) < min(end, ended)


def test_one_that_is_alone_is_done_here() -> None:
    with SideBySide(2) as tasks:
        for name in "ab":
            tasks.add(name, lambda progress: os.getpid())
            assert tasks.result(name) == os.getpid()


@copies
@pytest.mark.parametrize("jobs", [2, 3])
@pytest.mark.parametrize("count", [1, 2, 3, 7])
def test_any_number_of_tasks_comes_to_its_end_in_any_order(jobs: int, count: int) -> None:
    with SideBySide(jobs) as tasks:
        for k in range(count):
            tasks.add(k, lambda progress, k=k: k)
        assert [tasks.result(k) for k in reversed(range(count))] == list(reversed(range(count)))
        tasks.add("late", lambda progress: 1)
        assert tasks.result("late") == 1


def test_one_job_is_done_here() -> None:
    with SideBySide(1) as tasks:
        tasks.add("a", lambda progress: os.getpid())
        assert tasks.result("a") == os.getpid()


@pytest.mark.parametrize("jobs", [0, -1, 1.5, True, "2"])
def test_jobs_are_a_whole_number(jobs: Any) -> None:
    with pytest.raises(SceneError, match=r"jobs = .*: must be a whole number from 1"):
        SideBySide(jobs)


def children() -> set[str]:
    """The processes that this one has made, where the system lists them."""
    return {pid for task in Path("/proc/self/task").glob("*/children") for pid in task.read_text("ascii").split()}


@pytest.mark.parametrize("jobs", [1, 3])
def test_the_first_error_is_raised_and_nothing_stays_behind(jobs: int) -> None:
    def bad(name: str) -> Any:
        def task(progress: Any) -> None:
            raise SceneError(f"{name}: bad")

        return task

    def hangs(progress: Any) -> None:
        clock.sleep(60)

    before = children()
    with pytest.raises(SceneError, match=r"^one: bad$"), SideBySide(jobs) as tasks:
        tasks.add(0, lambda progress: 7)
        tasks.add(1, bad("one"))
        tasks.add(2, bad("two"))
        tasks.add(3, hangs)
        assert tasks.result(0) == 7
        tasks.result(1)
    assert children() <= before


@copies
def test_what_is_printed_and_warned_of_comes_with_the_result(capsys: pytest.CaptureFixture[str]) -> None:
    def task(name: str) -> Any:
        def told(progress: Any) -> str:
            print(f"out {name}")
            print(f"err {name}", file=sys.stderr)
            warnings.warn(f"beware of {name}", UserWarning, stacklevel=1)
            return name

        return told

    with SideBySide(2) as tasks, warnings.catch_warnings(record=True) as warned:
        warnings.simplefilter("always")
        for name in "abc":
            tasks.add(name, task(name))
        assert [tasks.result(name) for name in "abc"] == ["a", "b", "c"]
    assert [str(each.message) for each in warned] == ["beware of a", "beware of b", "beware of c"]
    assert capsys.readouterr() == ("out a\nout b\nout c\n", "err a\nerr b\nerr c\n")


@copies
def test_what_cannot_be_sent_and_whose_copy_dies_is_done_here() -> None:
    here = os.getpid()

    def dies(progress: Any) -> str:
        if os.getpid() != here:
            os.kill(os.getpid(), signal.SIGKILL)
        return "here"

    def nameless(progress: Any) -> Any:
        return lambda number=here: number

    with SideBySide(2) as tasks:
        tasks.add(0, dies)
        tasks.add(1, nameless)
        tasks.add(2, lambda progress: bytes(1 << 20))
        assert tasks.result(0) == "here"
        assert tasks.result(1)() == here
        assert len(tasks.result(2)) == 1 << 20


@copies
def test_known_objects_are_the_same_and_progress_is_that_of_the_one_asked_for() -> None:
    known = object()

    def task(name: str) -> Any:
        def told(progress: Any) -> tuple[str, object]:
            for count in range(4):
                progress((name, count))
                clock.sleep(0.15)
            return name, known

        return told

    heard: list[tuple[str, int]] = []
    with SideBySide(2, [known]) as tasks:
        tasks.add("a", task("a"))
        tasks.add("b", task("b"))
        assert tasks.result("a", heard.append)[1] is known
        assert {name for name, _ in heard} == {"a"}
        assert [count for _, count in heard] == sorted(count for _, count in heard)
        assert tasks.result("b")[1] is known


@copies
@pytest.mark.parametrize("spec", ["near-tie:k=40", "cradle:n=3", "gas:n=4"])
def test_a_comparison_is_the_same_with_any_number_of_jobs(spec: str) -> None:
    scene, engines = catalogue.build(spec), ["double", "interval", "pymunk", "single"]
    notes: list[str] = []

    def noted(state: Progress) -> None:
        notes.append(state.note)

    one, three = (compare(scene, engines, events=90, jobs=jobs, progress=noted) for jobs in (1, 3))
    assert without_times(comparison_json(one)) == without_times(comparison_json(three))
    assert all(c.trajectory.scene is three.scene for c in three.candidates)


@copies
def test_an_engine_that_cannot_be_judged_ends_a_comparison_as_one_after_the_other() -> None:
    scene = catalogue.build("gas:n=3")
    for jobs in (1, 2):
        with pytest.raises(SceneError, match="no-such"):
            compare(scene, ["double", "no-such"], jobs=jobs)


@copies
@pytest.mark.parametrize(("spec", "events", "budget"), [("gas:n=4", 9, None), ("gas:n=4", 60, 400_000)])
def test_advice_is_the_same_with_any_number_of_jobs(spec: str, events: int, budget: int | None) -> None:
    found = [
        advise(catalogue.build(spec), HistoryGoal(events), perturbed=3, budget=budget, jobs=jobs) for jobs in (1, 2)
    ]
    one, two = (without_times(advice_json(each)) for each in found)
    assert one == two


def test_the_command_takes_jobs(capsys: pytest.CaptureFixture[str]) -> None:
    told: list[Any] = []
    for jobs in ("1", "2"):
        with pytest.raises(SystemExit):
            main(["compare", "near-tie:k=40", "--engines", "double,single", "--json", "--jobs", jobs])
        told.append(without_times(json.loads(capsys.readouterr().out)))
    assert told[0] == told[1]


SCRIPT = """
import os, sys, time
from truebreak.compare.side_by_side import SideBySide
def task(progress):
    os.write(2, f"{os.getpid()}\\n".encode())  # a line at once: another process writes there too
    time.sleep(60)
with SideBySide(2) as tasks:
    for k in range(2):
        tasks.add(k, task)
    tasks.result(0)
"""


@copies
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGKILL])
def test_copies_end_with_the_process_that_made_them(number: int) -> None:
    """A plain script without a guard around its main part; interrupted, and killed."""
    process = subprocess.Popen([sys.executable, "-P", "-c", textwrap.dedent(SCRIPT)], stderr=subprocess.PIPE, text=True)
    assert process.stderr is not None
    pids = [int(process.stderr.readline()) for _ in range(2)]
    process.send_signal(number)
    process.wait(timeout=60)
    deadline = clock.monotonic() + 30
    while any(_runs(pid) for pid in pids) and clock.monotonic() < deadline:
        clock.sleep(0.05)
    assert not any(_runs(pid) for pid in pids)


def _runs(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    try:
        return Path(f"/proc/{pid}/stat").read_text("ascii").rpartition(")")[2].split()[0] != "Z"
    except FileNotFoundError:
        return False
