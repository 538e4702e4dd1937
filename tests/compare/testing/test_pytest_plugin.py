"""The pytest plugin, in pytest runs of its own."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import pytest

from truebreak.testing import check

pytest_plugins = ["pytester"]

ROOT = Path(__file__).resolve().parents[3]

LOADED = check
"""Loaded before the runs within this process: they drop what they import, and numpy cannot be loaded twice."""

SAMPLE = ROOT / "tests" / "data" / "sample_project"


def test_the_plugin_imports_nothing_but_pytest(tmp_path: Path) -> None:
    """Where no check is used, nothing is loaded beyond the plugin's own file and what finds its packages' names."""
    (tmp_path / "test_it.py").write_text(
        "import sys\n"
        "def test_it():\n"
        "    own = sorted(m for m in sys.modules if m == 'truebreak' or m.startswith('truebreak.'))\n"
        "    assert own == ['truebreak', 'truebreak.compare', 'truebreak.compare.testing',\n"
        "                   'truebreak.compare.testing.plugin', 'truebreak.scenarios',\n"
        "                   'truebreak.scenarios.lazy'], own\n"
        "    heavy = {'sympy', 'numpy', 'flint', 'mpmath', 'pymunk', 'click', 'rich', 'jinja2', 'hypothesis'}\n"
        "    assert not heavy & set(sys.modules), heavy & set(sys.modules)\n",
        "utf-8",
    )
    others = ["-p", "no:hypothesispytest", "-p", "no:html", "-p", "no:cacheprovider"]
    words = ["-m", "pytest", "-q", *others, "--strict-markers"]
    done = subprocess.run([sys.executable, *words], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


PASSING = """
    def test_double(truebreak):
        truebreak.check("double", "near-tie:k=4")
"""

FAILING = """
    def test_short(truebreak):
        truebreak.check("double", "near-tie:k=40", events=2)
"""

OPEN = """
    def test_open(truebreak):
        truebreak.check([(1.0, "left", "middle")], "near-tie:k=4", events=3)
"""


def test_a_passing_check_says_with_v_what_was_asserted(pytester: pytest.Pytester) -> None:
    pytester.makepyfile(PASSING)
    done = pytester.runpytest("-v")
    done.assert_outcomes(passed=1)
    done.stdout.fnmatch_lines(
        [
            "*truebreak: what was asserted*",
            "*test_double: passed: double on near-tie:k=4: the same history in 4 events; times and places of 4*",
            "truebreak: 1 check: 1 passed",
        ]
    )
    assert "what was asserted" not in pytester.runpytest().stdout.str()


def test_a_failure_tells_the_divergence_first(pytester: pytest.Pytester) -> None:
    pytester.makepyfile(FAILING)
    done = pytester.runpytest("--truebreak-report=reports", "--junitxml=out.xml")
    done.assert_outcomes(failed=1)
    done.stdout.fnmatch_lines(
        [
            "E *CheckFailed: double first differs at event 0 (t = 1): circle middle meets left and right at once *",
            "E * expected: middle meets left then right at t = 1",
            "E * got: *middle meets left + right at t = 1.0",
            "E * decision: margin 1e-40 beside an error of less than double resolution; *",
            "E * digits: *15 expected of 53 bits, 15 left of places by then",
            "E * cause: *input rounding: *",
            "E * required: 2 events; 0 agree",
            "E * reproduce: truebreak compare near-tie:k=40 --engines double --events 2",
            "truebreak: 1 check: 1 failed",
        ]
    )
    assert "def check(" not in done.stdout.str(), "the plugin's own frames are hidden"
    (report,) = Path(pytester.path, "reports").iterdir()
    assert "near-tie:k=40" in report.read_text("utf-8")
    properties = ElementTree.parse(pytester.path / "out.xml").findall(".//property")
    told = {p.get("name"): str(p.get("value")) for p in properties}
    assert told["truebreak"].startswith("failed: double first differs at event 0")
    assert told["truebreak-report"] == str(Path("reports", report.name))


def test_a_report_that_cannot_be_written_hides_no_failure(pytester: pytest.Pytester) -> None:
    pytester.makepyfile(FAILING)
    Path(pytester.path, "taken").touch()
    done = pytester.runpytest("--truebreak-report=taken")
    assert done.ret == pytest.ExitCode.USAGE_ERROR
    done.stderr.fnmatch_lines(["ERROR: --truebreak-report taken: is a file; name a folder"])
    done = pytester.runpytest("--truebreak-report=taken/reports")
    done.assert_outcomes(failed=1, warnings=1)
    done.stdout.fnmatch_lines(["E *CheckFailed: double first differs at event 0*", "*truebreak: no report: *"])


def test_undecided_fails_unless_it_is_to_skip(pytester: pytest.Pytester) -> None:
    pytester.makepyfile(OPEN)
    done = pytester.runpytest()
    done.assert_outcomes(failed=1)
    done.stdout.fnmatch_lines(["E *Not settled: *record it farther*", "*undecided='skip' skips such a check*"])
    pytester.runpytest("--truebreak-undecided=skip").assert_outcomes(skipped=1)
    pytester.makeini("[pytest]\ntruebreak_undecided = skip\n")
    pytester.runpytest().assert_outcomes(skipped=1)
    pytester.runpytest("--truebreak-undecided=fail").assert_outcomes(failed=1)
    marked = "import pytest\npytestmark = pytest.mark.truebreak(undecided='skip')\n"
    pytester.makepyfile(marked + OPEN.replace("\n    ", "\n"))
    pytester.runpytest("--truebreak-undecided=fail").assert_outcomes(skipped=1)


def test_the_marker_and_settings_are_checked(pytester: pytest.Pytester) -> None:
    pytester.makepyfile(
        """
        import pytest

        @pytest.mark.truebreak(horizn=24)
        def test_marker(truebreak):
            pass

        def test_name(truebreak):
            truebreak.check("duoble", "gas")

        @pytest.mark.truebreak(horizon="float32", work=10**6)
        def test_horizon(truebreak):
            assert truebreak.check("double", "gas").reach.events < 40
        """
    )
    done = pytester.runpytest("--strict-markers")
    done.assert_outcomes(errors=1, failed=1, passed=1)
    done.stdout.fnmatch_lines(
        ["*marker truebreak: 'horizn' is not known; it has horizon, undecided, work, require_history, max_seconds"]
    )
    done.stdout.fnmatch_lines(["E *truebreak: engine 'duoble' is not known; did you mean 'double'?"])
    assert "undecided = 'mabye'; must be fail or skip" in pytester.runpytest("--truebreak-undecided=mabye").stdout.str()
    assert "work = 'much'" in pytester.runpytest("--truebreak-work=much").stdout.str()
    assert "truebreak(horizon=None" in pytester.runpytest("--markers").stdout.str()
    assert "--truebreak-report=DIR" in pytester.runpytest("--help").stdout.str()


GOLDEN = """
    import truebreak as tb

    def test_golden(truebreak):
        run = tb.run(tb.scene("lee"), events=1)
        assert run == truebreak.golden("lee")
"""


def test_golden_runs(pytester: pytest.Pytester) -> None:
    pytester.makepyfile(GOLDEN)
    done = pytester.runpytest()
    done.assert_outcomes(failed=1)
    done.stdout.fnmatch_lines(["E *lee.json was missing; it is written now*"])
    pytester.runpytest().assert_outcomes(passed=1)
    path = pytester.path / "golden" / "lee.json"
    stored = json.loads(path.read_text("utf-8"))
    stored["events"][0]["time"] = 2.0
    path.write_text(json.dumps(stored), "utf-8")
    done = pytester.runpytest()
    done.assert_outcomes(failed=1)
    done.stdout.fnmatch_lines(["E *events?0?.time: 1.0, the golden run has 2.0", "E *--truebreak-regen"])
    pytester.runpytest("--truebreak-regen").assert_outcomes(passed=1)
    pytester.runpytest().assert_outcomes(passed=1)
    path.write_text(json.dumps({**stored, "schema": "truebreak/golden-0"}), "utf-8")
    pytester.runpytest().stdout.fnmatch_lines(["E *is 'truebreak/golden-0', this version has 'truebreak/golden-1'*"])
    path.write_text(path.read_text("utf-8")[:50], "utf-8")
    pytester.runpytest().stdout.fnmatch_lines(["E *lee.json is damaged*"])


def test_each_run_is_compared_with_a_golden_one(pytester: pytest.Pytester) -> None:
    """One golden run may stand beside several: what the first came to says nothing of the next."""
    pytester.makepyfile(
        """
        import truebreak as tb

        def test_golden(truebreak):
            golden = truebreak.golden("lee")
            assert tb.run(tb.scene("lee"), events=1) == golden
            assert tb.run(tb.scene("lee:tie=sequential"), events=1) != golden
            assert tb.run(tb.scene("lee"), events=1) == golden
        """
    )
    pytester.runpytest().assert_outcomes(failed=1)
    pytester.runpytest().assert_outcomes(passed=1)


def test_workers_of_xdist_tell_the_same(pytester: pytest.Pytester) -> None:
    pytest.importorskip("xdist")
    pytester.makepyfile(test_one=PASSING, test_two=FAILING, test_three=GOLDEN, test_four=GOLDEN)
    done = pytester.runpytest_subprocess("-n", "2", "-v", "--truebreak-report=reports", "--truebreak-regen")
    done.assert_outcomes(passed=3, failed=1)
    done.stdout.fnmatch_lines(["*test_double: passed: double on near-tie*", "truebreak: 2 checks: 1 failed, 1 passed"])
    assert len(list(Path(pytester.path, "reports").iterdir())) == 1
    assert [p.name for p in Path(pytester.path, "golden").iterdir()] == ["lee.json"]


def test_a_project_with_folders_of_the_same_names(pytester: pytest.Pytester) -> None:
    """It has its own `compare` and `scenarios`, and an engine with a bug, which is found and told."""
    import shutil

    shutil.copytree(SAMPLE, pytester.path / "project", ignore=shutil.ignore_patterns("__pycache__"))
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-v", "-p", "no:cacheprovider", "."],
        cwd=pytester.path / "project",
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 1, done.stdout + done.stderr
    told = done.stdout
    assert "test_pool.py::test_mended PASSED" in told
    assert "test_pool.py::test_with_a_bug FAILED" in told
    assert "heavy after it is off by" in told
    assert "truebreak: 2 checks: 1 failed, 1 passed" in told


def test_the_report_is_attached_to_pytest_html(pytester: pytest.Pytester) -> None:
    pytest.importorskip("pytest_html")
    pytester.makepyfile(FAILING)
    pytester.runpytest_subprocess("--html=all.html", "--truebreak-report=reports").assert_outcomes(failed=1)
    assert "reports/test_" in Path(pytester.path, "all.html").read_text("utf-8")


def test_without_any_extra(pytester: pytest.Pytester) -> None:
    """Neither xdist nor pytest-html nor hypothesis: checks work, and strategies say what is missing."""
    pytester.makeconftest(
        "import sys\nfor name in ('hypothesis', 'xdist', 'pytest_html'):\n    sys.modules[name] = None\n"
    )
    pytester.makepyfile(
        """
        import pytest
        from truebreak.scenarios import SceneError
        from truebreak.testing import scenes

        def test_double(truebreak):
            truebreak.check("double", "near-tie:k=4")

        def test_drawn():
            with pytest.raises(SceneError, match="hypothesis is not installed"):
                scenes()
        """
    )
    without = [
        word for name in ("hypothesispytest", "xdist", "xdist.looponfail", "html") for word in ("-p", f"no:{name}")
    ]
    done = pytester.runpytest_subprocess(*without, "-p", "no:cacheprovider", "--truebreak-report=reports")
    done.assert_outcomes(passed=2)
    done.stdout.fnmatch_lines(["truebreak: 1 check: 1 passed"])


def test_the_command_that_shows_it_again(pytester: pytest.Pytester) -> None:
    """An engine of one's own is named by its class where the command line finds it; else Python is told."""
    pytester.makepyfile(
        mine="""
            from dataclasses import dataclass
            from truebreak.floating import DoubleEngine

            @dataclass(frozen=True)
            class Mine(DoubleEngine):
                width: int = 3
            """,
        test_it="""
            import pytest
            import truebreak as tb
            from mine import Mine
            from truebreak.floating import PymunkEngine

            SCENE = tb.scene("near-tie:k=40")

            class Here(Mine):
                pass

            def made():
                class Local(Mine):
                    pass
                return Local()

            @pytest.mark.parametrize(
                "engine", [Mine(), Mine(4), PymunkEngine(dt=1 / 64), Here(), made()], ids=["a", "b", "c", "d", "e"]
            )
            def test_it(truebreak, engine):
                truebreak.check(engine, SCENE, events=2)

            def test_a_scene_of_its_own(truebreak):
                truebreak.check(Mine(), tb.Scene(SCENE.circles, events=2), events=2)
            """,
    )
    told = pytester.runpytest()
    told.assert_outcomes(failed=6)
    text = told.stdout.str()
    command = "reproduce: truebreak compare near-tie:k=40 --engines"
    for engine in ("mine:Mine", "mine:Mine:width=4", "pymunk:dt=0.015625", "test_it:Here"):
        assert f"{command} {engine} --events 2" in text
    assert "reproduce: truebreak.comparison(truebreak.scene('near-tie:k=40'), [engine], events=2)" in text
    assert "reproduce: truebreak.comparison(scene, ['mine:Mine'], events=2)" in text
    words = ["compare", "near-tie:k=40", "--engines", "mine:Mine:width=4", "--events", "2"]
    done = pytester.run(sys.executable, "-m", "truebreak", *words)
    assert done.ret == 1
