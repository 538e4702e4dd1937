"""The pytest plugin: a fixture, a marker, options, golden runs, one line of summary. Imports nothing but pytest."""

from __future__ import annotations

import os
import re
from collections.abc import Generator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from .check import Checked
    from .golden import Golden

MARKER = (
    "truebreak(horizon=None, undecided='fail', require_history=False, work=None, max_seconds=None): how the fixture "
    "`truebreak` checks engines in this test: whose errors are granted (such as 'float32', or bits), what becomes of a "
    "check that cannot be decided (fail or skip), whether one that can require no event of the history fails, what one "
    "question may cost the exact engine, and after how many seconds a check is not decided."
)

SETTINGS = {
    "horizon": "whose errors are granted: bits, or float32, double, quad; else what the engine declares",
    "undecided": "what becomes of a check that cannot be decided: fail (default) or skip",
    "work": "what one question may cost the exact engine, in counted units",
    "require_history": "true: a check that can require no event of the history fails",
    "max_seconds": "seconds after which a check is not decided, as where an engine hangs; else there is no limit",
}

REGENERATE = "TRUEBREAK_REGEN"
"""Set in the environment with `--truebreak-regen`, for `truebreak.same`, which has no fixture."""

PROPERTY = "truebreak"
"""Name of the property of a test (JUnit's too) that says what was asserted; its value begins with the verdict."""


def pytest_addoption(parser: pytest.Parser) -> None:
    """Options and ini settings; a marker goes before the command line, and that before the ini file."""
    group = parser.getgroup("truebreak", "physics engines compared with the exact one")
    for name, told in SETTINGS.items():
        group.addoption(f"--truebreak-{name.replace('_', '-')}", metavar=name.upper(), help=told)
        parser.addini(f"truebreak_{name}", help=told)
    group.addoption("--truebreak-report", metavar="DIR", help="write an HTML report of every check that fails to DIR")
    group.addoption("--truebreak-regen", action="store_true", help="write golden runs anew instead of comparing them")


def pytest_configure(config: pytest.Config) -> None:
    """Makes the marker known, and refuses a place for reports that is none."""
    config.addinivalue_line("markers", MARKER)
    if config.getoption("truebreak_regen"):
        os.environ[REGENERATE] = "1"
        config.add_cleanup(_regenerated)
    folder = config.getoption("truebreak_report")
    if folder is not None and Path(folder).exists() and not Path(folder).is_dir():
        raise pytest.UsageError(f"--truebreak-report {folder}: is a file; name a folder")


def _regenerated() -> None:
    """Golden runs are written anew for as long as these tests run."""
    os.environ.pop(REGENERATE, None)


class Truebreak:
    """What the fixture `truebreak` gives a test."""

    def __init__(self, request: pytest.FixtureRequest) -> None:
        self._request = request
        self._settings = settings_of(request.node)

    def check(self, engine: Any, scene: Any, **demands: Any) -> Checked:
        """Requires that an engine, or a log, tells a scene's true history (see `compare.testing.check.check`)."""
        __tracebackhide__ = True
        from ...scenarios.errors import SceneError
        from .check import CheckFailed, NotDecided, check

        for key in ("horizon", "require_history", "work", "max_seconds"):
            if self._settings[key] is not None:
                demands.setdefault(key, self._settings[key])
        try:
            checked = check(engine, scene, **demands)
        except NotDecided as outcome:
            skip = self._settings["undecided"] == "skip"
            self._note("skipped" if skip else "undecided", str(outcome))
            if skip:
                pytest.skip(f"truebreak: {str(outcome).splitlines()[0]}")
            self._report(outcome.comparison)
            raise CheckFailed(f"{outcome}\n  (undecided='skip' skips such a check)", outcome.comparison) from None
        except CheckFailed as outcome:
            self._note("failed", str(outcome))
            self._report(outcome.comparison)
            raise CheckFailed(str(outcome), outcome.comparison) from None
        except SceneError as error:
            self._note("refused", str(error))
            raise CheckFailed(f"truebreak: {error}") from None
        self._note("passed", str(checked))
        return checked

    def golden(self, name: str) -> Golden:
        """The golden run of a name, in the folder `golden` beside the test: `assert run == truebreak.golden(name)`."""
        from .golden import Golden

        folder = Path(self._request.path).parent / "golden"
        return Golden(folder / f"{name}.json", regenerate=bool(self._request.config.getoption("truebreak_regen")))

    def _note(self, verdict: str, told: str) -> None:
        self._request.node.user_properties.append((PROPERTY, f"{verdict}: {told}"))

    def _report(self, comparison: Any) -> None:
        """Writes the report of a failing comparison, and has pytest-html link it."""
        folder = self._request.config.getoption("truebreak_report")
        if folder is None or comparison is None:
            return
        from ...scenarios.errors import SceneError
        from ..report.html import html_report
        from ..writing import write_whole

        plain = re.sub(r"[^\w.=,-]+", "-", self._request.node.nodeid)
        number = sum(name == REPORT for name, _ in self._request.node.user_properties)
        path = Path(folder) / f"{plain[-200:]}{'' if not number else f'-{number + 1}'}.html"
        try:
            Path(folder).mkdir(parents=True, exist_ok=True)
            write_whole(path, html_report(comparison))
        except (OSError, SceneError) as error:  # the failure itself is what is to be told
            self._request.node.warn(pytest.PytestWarning(f"truebreak: no report: {error}"))
            return
        self._request.node.user_properties.append((REPORT, str(path)))


REPORT = "truebreak-report"
"""Name of the property of a test that says where the report of a failing check lies."""


@pytest.fixture
def truebreak(request: pytest.FixtureRequest) -> Truebreak:
    """Checks engines against the exact one: `truebreak.check(engine, "gas:n=10")`; `truebreak.golden("name")`."""
    return Truebreak(request)


def settings_of(node: pytest.Item) -> dict[str, Any]:
    """The settings that hold for a test: the marker's, else the command line's, else the ini file's."""
    marks: dict[str, Any] = {}
    for mark in node.iter_markers("truebreak"):
        strange = sorted(mark.kwargs.keys() - SETTINGS.keys())
        if mark.args or strange:
            what = strange[0] if strange else mark.args[0]
            raise pytest.UsageError(f"marker truebreak: {what!r} is not known; it has {', '.join(SETTINGS)}")
        marks = {**mark.kwargs, **marks}
    found: dict[str, Any] = {}
    for name in SETTINGS:
        given = node.config.getoption(f"truebreak_{name}"), node.config.getini(f"truebreak_{name}")
        found[name] = marks[name] if name in marks else next((value for value in given if value), None)
    if found["undecided"] not in (None, "fail", "skip"):
        raise pytest.UsageError(f"truebreak: undecided = {found['undecided']!r}; must be fail or skip")
    if isinstance(found["require_history"], str):
        words = {"true": True, "1": True, "yes": True, "false": False, "0": False, "no": False}
        if found["require_history"].lower() not in words:
            raise pytest.UsageError(f"truebreak: require_history = {found['require_history']!r}; must be true or false")
        found["require_history"] = words[found["require_history"].lower()]
    for name, kind, told in (("work", int, "a whole number"), ("max_seconds", float, "a number of seconds")):
        if isinstance(found[name], str):
            try:
                found[name] = kind(found[name])
            except ValueError:
                raise pytest.UsageError(f"truebreak: {name} = {found[name]!r}; must be {told}") from None
    return found


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(
    item: pytest.Item, call: pytest.CallInfo[Any]
) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """Attaches the report of a failing check where pytest-html is at work."""
    report = yield
    paths = [str(value) for name, value in item.user_properties if name == REPORT]
    html = item.config.pluginmanager.getplugin("html")
    if report.when == "call" and paths and html is not None:
        from importlib import import_module

        extras = import_module("pytest_html").extras
        shown: Any = report
        shown.extras = [*getattr(report, "extras", []), *(extras.url(path, name="truebreak") for path in paths)]
    return report


def pytest_terminal_summary(terminalreporter: Any, config: pytest.Config) -> None:
    """One line; with -v what each check asserted."""
    told = [
        (report.nodeid, str(value))
        for reports in terminalreporter.stats.values()
        for report in reports
        if getattr(report, "when", None) == "call" and hasattr(report, "user_properties")
        for name, value in report.user_properties
        if name == PROPERTY
    ]
    if not told:
        return
    counts: dict[str, int] = {}
    for _, text in told:
        verdict = text.partition(":")[0]
        counts[verdict] = counts.get(verdict, 0) + 1
    if config.get_verbosity() > 0:
        terminalreporter.section("truebreak: what was asserted")
        for nodeid, text in sorted(told):
            first, *rest = text.splitlines()
            terminalreporter.write_line(f"{nodeid}: {first}{' ...' if rest else ''}")
    checks = "1 check" if len(told) == 1 else f"{len(told)} checks"
    terminalreporter.write_line(
        f"truebreak: {checks}: {', '.join(f'{count} {verdict}' for verdict, count in sorted(counts.items()))}"
    )


def pytest_assertrepr_compare(op: str, left: object, right: object) -> list[str] | None:
    """What differs between a run and a golden one."""
    for one, other in ((left, right), (right, left)):
        explained = getattr(type(one), "truebreak_differences", None)
        if op == "==" and explained is not None:
            return [str(one), *explained(one, other)]
    return None
