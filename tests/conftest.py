"""What all tests share: where the project lies, and how hypothesis draws its examples."""

from __future__ import annotations

import gc
import json
import os
import signal
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

# Tests start hundreds of processes, which import the whole: Python keeps what it compiles, whatever the shell asks for.
# Before hypothesis, whose every module pytest compiles for its asserts.
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
sys.dont_write_bytecode = False

import pytest  # noqa: E402
from hypothesis import settings  # noqa: E402

ROOT = Path(__file__).resolve().parent.parent

# Exact arithmetic has no steady pace, so no deadline; on CI the same examples on every run.
settings.register_profile("local", deadline=None)
settings.register_profile("ci", deadline=None, derandomize=True)
settings.load_profile("ci" if os.environ.get("CI") else "local")

# A shell starts what runs in the background deaf to Ctrl-C; what the tests interrupt must hear it.
signal.signal(signal.SIGINT, signal.default_int_handler)
if hasattr(signal, "SIGHUP"):  # and `nohup` to that its terminal is gone
    signal.signal(signal.SIGHUP, signal.SIG_DFL)


# Half a gigabyte of collected tests is looked through for garbage as seldom as the command line does.
gc.set_threshold(50_000, *gc.get_threshold()[1:])

# No test touches the user's kept runs, nor does what tests start.
os.environ["TRUEBREAK_CACHE"] = ""


@pytest.fixture(scope="session")
def root() -> Path:
    """The project's top folder."""
    return ROOT


@pytest.fixture(autouse=True)
def _no_columns(monkeypatch: pytest.MonkeyPatch) -> None:
    """As wide as without the variable, which workers of xdist are given."""
    monkeypatch.delenv("COLUMNS", raising=False)


# What a test costs. Those over `LONG` seconds of CPU are marked `long`, by a file that `make durations` writes.

DURATIONS = Path(__file__).parent / "durations.json"
LONG = 0.4
"""Seconds of CPU: of a test, of what it is the first to set up, and of the processes that it starts."""

WAITING = 1 / 8
"""What a second of waiting counts as CPU, as for an engine that hangs; on a busy machine all tests wait a little."""

MOST_LONG = 0.099
"""The part of all tests that is marked, at most: those that take longest. A slower machine has more over `LONG`."""


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--keep-durations", action="store_true", help="write durations.json anew")


def pytest_configure(config: pytest.Config) -> None:
    if config.getoption("--keep-durations"):
        config.pluginmanager.register(Durations(config))


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    kept = json.loads(DURATIONS.read_text("utf-8"))["seconds"] if DURATIONS.exists() else {}
    for item in items:
        if item.nodeid in kept:
            item.add_marker("long")


def pytest_collection_finish() -> None:
    """What is collected stays to the end: no collector looks through it again, and no copy of the process copies it."""
    gc.freeze()


# What a module or a session makes once, each worker makes again for the tests that it is handed: they go by halves, and
# not a few at a time in turns, which is a sixth less to compute in `tests/compare/audit`.


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> Any:
    """Each worker begins with neighbours, and takes from the other's end when its own are done."""
    if config.getoption("dist") != "load":  # what `-n` asks for, where nothing else is said
        return None
    from xdist.scheduler import WorkStealingScheduling

    return WorkStealingScheduling(config, log)


def cpu() -> float:
    """Seconds of CPU of this process, and of those below it, also of those that have not ended."""
    return sum(os.times()[:4]) + sum(_cpu_of(child) for child in _children(Path("/proc/self")))


def _children(process: Path) -> list[Path]:
    try:
        found = [file.read_text("ascii").split() for file in process.glob("task/*/children")]
    except OSError:  # it has ended, or this is no Linux
        return []
    return [Path("/proc", pid) for pids in found for pid in pids]


def _cpu_of(process: Path) -> float:
    try:
        fields = (process / "stat").read_text("utf-8").rpartition(")")[2].split()
    except OSError:
        return 0.0
    return sum(map(int, fields[11:15])) / os.sysconf("SC_CLK_TCK") + sum(map(_cpu_of, _children(process)))


class Durations:
    """Measures every test, in each worker, and brings the file up to date at the end.

    What a fixture of a module or a session takes counts for each test that uses it: where those that take long are
    left out, another pays for it. A run of some adds to what the file has of others.
    """

    def __init__(self, config: pytest.Config) -> None:
        self.config, self.seconds, self.began, self.since = config, dict[str, float](), 0.0, 0.0
        self.shared, self.inside, self.new = dict[tuple[str, ...], float](), 0.0, 0.0

    def pytest_runtest_logstart(self) -> None:
        self.began, self.new, self.since = cpu(), 0.0, time.perf_counter()

    @pytest.hookimpl(wrapper=True)
    def pytest_fixture_setup(self, fixturedef: pytest.FixtureDef[Any], request: pytest.FixtureRequest) -> Any:
        began, inside, self.inside = cpu(), self.inside, 0.0
        try:
            return (yield)
        finally:
            took = cpu() - began
            own, self.inside = took - self.inside, inside + took
            if fixturedef.scope != "function":
                self.shared[self._key(request.node.nodeid, fixturedef.argname, getattr(request, "param", None))] = own
                self.new += own

    @staticmethod
    def _key(*parts: object) -> tuple[str, ...]:
        return tuple(map(repr, parts))

    def _fixtures(self, item: pytest.Item) -> float:
        """What the fixtures took that it shares with others."""
        given: dict[str, object] = getattr(getattr(item, "callspec", None), "params", {})
        above = {node.nodeid for node in item.listchain()}
        names: list[str] = getattr(item, "fixturenames", [])
        wanted = {self._key(node, name, given.get(name)) for node in above for name in names}
        return sum(self.shared[key] for key in wanted & self.shared.keys())

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_makereport(self, item: pytest.Item) -> Iterator[None]:
        """A report carries this from a worker to the process that gathers them."""
        others = [pair for pair in item.user_properties if pair[0] != "cpu"]
        own, waited = cpu() - self.began - self.new, time.perf_counter() - self.since
        item.user_properties = [*others, ("cpu", max(own, WAITING * waited) + self._fixtures(item))]
        return (yield)

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        if report.when == "teardown":
            self.seconds[report.nodeid] = float(str(dict(report.user_properties)["cpu"]))

    def pytest_sessionfinish(self) -> None:
        if hasattr(self.config, "workerinput"):
            return
        kept: dict[str, Any] = json.loads(DURATIONS.read_text("utf-8")) if DURATIONS.exists() else {"seconds": {}}
        others = {name: s for name, s in kept["seconds"].items() if name not in self.seconds}
        long = others | {name: round(s, 1) for name, s in self.seconds.items() if s > LONG}
        most = int(MOST_LONG * max(kept.get("tests", 0), len({**others, **self.seconds})))
        long = dict(sorted(long.items(), key=lambda row: -row[1])[:most])
        about = {"tests": len(self.seconds), "cpu": round(sum(self.seconds.values()))}
        about = {"by": "make durations", **{key: kept.get(key, value) for key, value in about.items()}}
        DURATIONS.write_text(json.dumps({**about, "seconds": dict(sorted(long.items()))}, indent=1) + "\n", "utf-8")
