"""What all tests share: where the project lies, and how hypothesis draws its examples."""

from __future__ import annotations

import json
import os
import signal
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import settings

ROOT = Path(__file__).resolve().parent.parent

# Exact arithmetic has no steady pace, so no deadline; on CI the same examples on every run.
settings.register_profile("local", deadline=None)
settings.register_profile("ci", deadline=None, derandomize=True)
settings.load_profile("ci" if os.environ.get("CI") else "local")

# A shell starts what runs in the background deaf to Ctrl-C; what the tests interrupt must hear it.
signal.signal(signal.SIGINT, signal.default_int_handler)


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
LONG = 0.3
"""Seconds of CPU: of a test, of what it is the first to set up, and of the processes that it starts. The others,
nine of ten, take four minutes on two cores."""


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


class Durations:
    """Measures every test, in each worker, and writes the file at the end."""

    def __init__(self, config: pytest.Config) -> None:
        self.config, self.seconds, self.began = config, dict[str, float](), 0.0

    def pytest_runtest_logstart(self) -> None:
        self.began = sum(os.times()[:4])

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_makereport(self, item: pytest.Item) -> Iterator[None]:
        """A report carries this from a worker to the process that gathers them."""
        others = [pair for pair in item.user_properties if pair[0] != "cpu"]
        item.user_properties = [*others, ("cpu", sum(os.times()[:4]) - self.began)]
        return (yield)

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        if report.when == "teardown":
            self.seconds[report.nodeid] = float(str(dict(report.user_properties)["cpu"]))

    def pytest_sessionfinish(self) -> None:
        if not hasattr(self.config, "workerinput"):
            long = {name: round(s, 1) for name, s in sorted(self.seconds.items()) if s > LONG}
            about = {"by": "make durations", "tests": len(self.seconds), "cpu": round(sum(self.seconds.values()))}
            DURATIONS.write_text(json.dumps({**about, "seconds": long}, indent=1) + "\n", "utf-8")
