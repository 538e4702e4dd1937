"""Engines that hang, fork, exit, crash, eat memory or print are run in a process of their own, and are ended there."""

from __future__ import annotations

import ctypes
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import pytest
from command_line import done

import truebreak as tb
from truebreak.compare.cli.entry import PLACES, Commands
from truebreak.compare.deadline import Clock, OutOfTime, time_limit
from truebreak.compare.foreign import RecordedEngine, isolation
from truebreak.compare.foreign.guard import run_guarded
from truebreak.compare.foreign.isolation import EngineWarning, isolated
from truebreak.compare.validation import EngineError
from truebreak.floating import DoubleEngine
from truebreak.scenarios import SceneError, StopReason
from truebreak.scenarios.trajectory import Progress, Trajectory

SCENE = tb.Scene([tb.Circle(0, 0, vx=1, id="a"), tb.Circle(4, 0, id="b")])

LINUX = pytest.mark.skipif(sys.platform != "linux", reason="memory is limited there only")


@pytest.fixture(params=["a copy", "anew"], autouse=True)
def how(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> Iterator[str]:
    """Both ways to begin such a process, each of which some system has."""
    if request.param == "a copy" and not isolation.FORKS:
        pytest.skip("this system makes no copies of processes")
    monkeypatch.setattr(isolation, "FORKS", request.param == "a copy")
    monkeypatch.setattr(isolation, "_warned", set())
    yield request.param


@dataclass(frozen=True)
class Does(DoubleEngine):
    """Does something, and is then as `double`."""

    what: str = "nothing"
    place: str = ""

    @property
    def name(self) -> str:
        return "mine"

    def run(self, scene: Any, **limits: Any) -> Trajectory:
        DEEDS[self.what](self)
        run = super().run(scene, **limits)
        if self.what == "gives what cannot be pickled":
            return replace(run, plan={"f": lambda: None})
        return run


def hang(engine: Does) -> None:
    Path(engine.place).write_text(str(os.getpid()), "utf-8")
    while True:
        try:
            time.sleep(60)
        except BaseException:
            continue


def hang_in_c(engine: Does) -> None:
    Path(engine.place).write_text(str(os.getpid()), "utf-8")
    sum(range(10**15))


def eat(engine: Does) -> None:
    eaten: list[bytearray] = []
    while True:
        eaten.append(bytearray(1 << 20))


def speak(engine: Does) -> None:
    print("so many\nlines \x1b[31m")
    os.write(1, b"raw")
    os.write(2, b"raw")


def leave_a_child(engine: Does) -> None:
    child = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(600)"])
    Path(engine.place).write_text(str(child.pid), "utf-8")


DEEDS: dict[str, Callable[[Does], Any]] = {
    "nothing": lambda engine: None,
    "gives what cannot be pickled": lambda engine: None,
    "hangs": hang,
    "hangs in C": hang_in_c,
    "eats": eat,
    "prints": speak,
    "leaves a child": leave_a_child,
    "forks": lambda engine: os.fork(),
    "exits": lambda engine: os._exit(3),
    "exits well": lambda engine: os._exit(0),
    "leaves": lambda engine: sys.exit(3),
    "crashes": lambda engine: ctypes.string_at(0),
    "kills itself": lambda engine: os.kill(os.getpid(), signal.SIGKILL),
    "raises": lambda engine: list[int]()[1],
    "interrupts": lambda engine: exec("raise KeyboardInterrupt"),
}


def lives(number: int) -> bool:
    """Whether a process is there, and no zombie."""
    try:
        os.kill(number, 0)
        return "Z" not in Path(f"/proc/{number}/stat").read_text("ascii").rpartition(")")[2].split()[0]
    except OSError:
        return False


ENDS = {
    "exits": "run ended its process, with exit code 3",
    "exits well": "run ended its process, with exit code 0",
    "leaves": "run raised SystemExit: 3 (",
    "crashes": "run ended its process, by SIGSEGV",
    "kills itself": "run ended its process, by SIGKILL",
    "raises": "run raised IndexError: list index out of range (",
    "interrupts": "KeyboardInterrupt",
    "gives what cannot be pickled": "what run gave cannot be pickled: ",
}


@pytest.mark.parametrize("what", ENDS)
def test_an_engine_that_comes_to_an_end_is_told_in_one_line(what: str) -> None:
    with isolated(), pytest.raises(EngineError) as error:
        run_guarded(Does(what), SCENE)
    assert str(error.value).startswith(f"engine 'mine': {ENDS[what]}")
    assert "\n" not in str(error.value)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="nothing forks there")
def test_an_engine_that_forks_is_refused() -> None:
    with isolated(), pytest.raises(EngineError, match="run began another process by fork, which is refused"):
        run_guarded(Does("forks"), SCENE)


def run_for(seconds: float, engine: Does) -> Trajectory:
    with time_limit(seconds):
        return run_guarded(engine, SCENE)


@LINUX
@pytest.mark.parametrize("what", ["hangs", "hangs in C"])
def test_an_engine_that_hangs_is_ended_without_being_asked(what: str, tmp_path: Path) -> None:
    """Seconds isolate it by themselves: it is ended even where it drops every exception, or is in C."""
    place = tmp_path / "number"
    with pytest.raises(OutOfTime, match=r"2 seconds \(--max-seconds\); engine 'mine' did not end by itself"):
        run_for(2, Does(what, str(place)))
    assert not lives(int(place.read_text("utf-8")))


@LINUX
def test_an_engine_that_eats_memory_is_ended() -> None:
    with isolated(max_memory=100), pytest.raises(EngineError) as error:
        run_guarded(Does("eats"), SCENE)
    assert str(error.value) == "engine 'mine': run needed more than 100 MB of memory (--max-memory)"


def test_what_an_engine_prints_is_left_out_and_said_once(capfd: pytest.CaptureFixture[str]) -> None:
    told = r"engine 'mine' printed 2 lines that are left out: 'so many lines"
    with isolated(), pytest.warns(EngineWarning, match=told) as warned:
        runs = [run_guarded(Does("prints"), SCENE) for _ in range(2)]
    assert capfd.readouterr() == ("", "")
    assert len([w for w in warned if w.category is EngineWarning]) == 1
    assert [len(run.events) for run in runs] == [1, 1]


@LINUX
def test_what_an_engine_leaves_behind_ends_with_it(tmp_path: Path) -> None:
    place = tmp_path / "number"
    with isolated():
        run_guarded(Does("leaves a child", str(place)), SCENE)
    late = time.monotonic() + 20
    while lives(int(place.read_text("utf-8"))) and time.monotonic() < late:
        time.sleep(0.01)
    assert not lives(int(place.read_text("utf-8")))


def test_a_run_apart_is_the_run_itself() -> None:
    """The same events, states and stop, of the very scene that was asked for."""
    scene = tb.scene("gas:n=4")
    here = run_guarded(Does(), scene, events=40)
    with isolated():
        apart = run_guarded(Does(), scene, events=40)
    assert apart.scene is scene
    assert apart.stop == here.stop
    assert [(e.time, e.contacts) for e in apart.events] == [(e.time, e.contacts) for e in here.events]
    assert (apart.sample([0.1, 0.5]) == here.sample([0.1, 0.5])).all()


class Slow(RecordedEngine):
    """Goes on for ever, by steps."""

    name = "slow"
    step = 1 / 64

    def play(self, scene: Any, recording: Any) -> None:
        now = 0.0
        while recording.open:
            now += self.step
            recording.state(now, [(float(c.x) + now * float(c.vx), 0.0, float(c.vx), 0.0) for c in scene.circles])
            time.sleep(0.002)


def test_what_a_run_has_when_its_seconds_are_over_comes_back() -> None:
    apart = tb.Scene([tb.Circle(0, 0, vx=1), tb.Circle(10**9, 0)])
    for seconds in (3, 12, 48):  # for a machine that has much else to do
        try:
            with time_limit(seconds) as watch:
                run = run_guarded(Slow(), apart, until=10**6, progress=watch.watched(None))
        except OutOfTime:
            continue
        assert run.stop.message == f"the budget is spent: {seconds} seconds (--max-seconds)"
        if float(run.final_time):
            assert float(run.final_time) < 10**6
            return
    raise AssertionError


def test_progress_comes_through_and_may_end_a_run() -> None:
    apart = tb.Scene([tb.Circle(0, 0, vx=1), tb.Circle(10**9, 0)])
    seen: list[Progress] = []

    def enough(state: Progress) -> None:
        seen.append(state)
        if len(seen) == 3:
            raise KeyboardInterrupt

    with isolated(), pytest.raises(KeyboardInterrupt):
        run_guarded(Slow(), apart, until=10**6, progress=enough)
    assert 0 < seen[0].time < seen[2].time


def test_in_a_thread_an_engine_that_hangs_is_ended_too(tmp_path: Path) -> None:
    """Where no alarm can ring."""
    found: list[str] = []

    def work() -> None:
        try:
            run_for(2, Does("hangs", str(tmp_path / "number")))
        except OutOfTime as outcome:
            found.append(str(outcome))

    thread = threading.Thread(target=work)
    thread.start()
    thread.join(120)
    assert found
    assert "did not end by itself" in found[0]


def test_an_engine_that_cannot_be_pickled_says_so(how: str) -> None:
    class Local(Does):
        pass

    with isolated():
        if how == "a copy":  # which needs none of that
            assert len(run_guarded(Local(), SCENE).events) == 1
            return
        with pytest.raises(
            EngineError, match=r"engine 'mine': cannot be sent to a process of its own: .*Local"
        ) as error:
            run_guarded(Local(), SCENE)
    assert "use classes at the top of a module" in str(error.value)


def test_engines_of_truebreaks_own_stay_where_they_are(monkeypatch: pytest.MonkeyPatch) -> None:
    def none(*_: object) -> None:
        raise AssertionError

    monkeypatch.setattr(isolation, "IsolatedProcess", none)
    with isolated(), time_limit(60):
        assert run_guarded(DoubleEngine(), SCENE).stop.reason is StopReason.QUIET


def test_without_limits_nothing_is_isolated() -> None:
    assert isolation.Apart.wanted() is None
    with isolated():
        assert isolation.Apart.wanted() is not None
        with isolated(max_memory=5) if isolation.LIMITS_MEMORY else isolated():
            assert isolation.Apart.wanted() is not None
    assert isolation.Apart.wanted() is None
    with time_limit(5):
        assert isolation.Apart.wanted() is not None
    assert isolation.Apart.wanted() is None


@LINUX
@pytest.mark.parametrize("megabytes", [0, -1, True, 1.5, "5", 1 << 40])
def test_a_limit_that_is_none(megabytes: Any) -> None:
    with pytest.raises(SceneError, match="must be a whole number of megabytes"), isolated(max_memory=megabytes):
        pass


def test_a_limit_in_the_environment_that_is_none(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(isolation.MEMORY, "much")
    with pytest.raises(SceneError, match="TRUEBREAK_MAX_MEMORY = 'much': must be a whole number of megabytes"):
        run_guarded(Does(), SCENE)


def test_no_time_is_left_for_what_has_not_begun() -> None:
    clock = Clock(1e-9)
    while not clock.over:
        pass
    request = isolation.Apart(clock, None, False)
    with pytest.raises(BaseException, match="1e-09 seconds"):
        isolation.run_apart(lambda _: None, "mine", SCENE, None, request)


# -- the doors


@pytest.mark.parametrize("name", sorted(PLACES))
def test_every_command_that_runs_engines_can_isolate_them(name: str) -> None:
    if name in ("bench", "orders"):  # which run truebreak's own alone, or what the bench names
        return
    options = {option for parameter in Commands(PLACES)[name].params for option in parameter.opts}
    runs = options & {"--engine", "--engines", "--reference"} or name == "suite"
    assert {"--isolate", "--max-memory"} <= options if runs else "--isolate" not in options


HOSTILE = """\
import os
from truebreak.floating import DoubleEngine
class Leaves(DoubleEngine):
    name = "leaves"
    def run(self, scene, **limits):
        os._exit(3)
class Prints(DoubleEngine):
    name = "prints"
    def run(self, scene, **limits):
        print("hello")
        return super().run(scene, **limits)
"""

DOORS = {
    "run": ["run", "galperin:n=0", "--engine", "hostile:Leaves"],
    "compare": ["compare", "galperin:n=0", "--engines", "hostile:Leaves"],
    "judge": ["compare", "galperin:n=0", "--engines", "double", "--reference", "hostile:Leaves"],
    "minimise": ["minimise", "galperin:n=0", "--engine", "hostile:Leaves"],
    "shadow": ["shadow", "gas:n=3", "--events", "3", "--engine", "hostile:Leaves"],
    "stress": ["stress", "near-ties", "--levels", "3..4", "--engines", "hostile:Leaves", "--jobs", "1"],
    "advise": ["advise", "galperin:n=0", "--engine", "hostile:Leaves"],
    "suite": ["suite", "suite.toml", "--jobs", "1"],
    "sweep": ["sweep", "galperin", "--vary", "n=0..0", "--engines", "hostile:Leaves", "--jobs", "1"],
}

REPORTED = {"stress": "wrong", "sweep": "1 refused"}
"""What is said where an engine that hands nothing back is a row like any other."""


def test_at_no_door_does_such_an_engine_end_truebreak(
    how: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    if how != "a copy":  # in a process of the tests' own there is but one way
        return
    monkeypatch.chdir(tmp_path)
    (tmp_path / "hostile.py").write_text(HOSTILE, "utf-8")
    suite = 'engines = ["hostile:Leaves"]\n[[scene]]\nname = "galperin:n=0"\n'
    (tmp_path / "suite.toml").write_text(suite, "utf-8")
    for name, words in DOORS.items():
        said = done(*words, "--isolate")
        told = said.stdout + said.stderr
        expected = REPORTED.get(name, "run ended its process, with exit code 3")
        assert expected in " ".join(told.split()), (name, told)
        assert "Traceback" not in told
    said = done("run", "galperin:n=0", "--engine", "hostile:Prints", "--isolate", "--json")
    assert said.stdout.startswith("{")
    assert said.stderr == "truebreak: warning: engine 'prints' printed 1 line that is left out: 'hello'\n"


HANGING = """
import ctypes, os, sys
from dataclasses import dataclass
import truebreak as tb
from truebreak.compare.foreign import isolated
from truebreak.scenarios import Declared

@dataclass(frozen=True)
class Hanging(Declared):
    name: str = "hanging"
    bits = 53

    def run(self, scene, **limits):
        with open(sys.argv[1], "w") as file:
            file.write(f"{os.getpid()}\\n")
        ctypes.PyDLL(None).sleep(600)

with isolated():
    tb.run(tb.scene("cradle"), Hanging())
"""


@pytest.mark.skipif(sys.platform != "linux", reason="a thread looks for the parent elsewhere, and is held up")
def test_an_engine_that_hangs_in_c_ends_with_a_parent_that_is_killed(tmp_path: Path) -> None:
    told = tmp_path / "pid"
    parent = subprocess.Popen([sys.executable, "-c", HANGING, str(told)])
    while not (told.exists() and told.read_text().endswith("\n")):
        assert parent.poll() is None
        time.sleep(0.05)
    pid = int(told.read_text())
    parent.kill()
    parent.wait()
    for _ in range(600):
        try:
            state = Path(f"/proc/{pid}/stat").read_text().split()[2]
        except FileNotFoundError:
            return
        if state == "Z":
            return
        time.sleep(0.1)
    raise AssertionError(f"process {pid} goes on")
