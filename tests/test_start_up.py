"""What a short run of the command line loads: all that is loaded is paid for at every start."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from verdict_costs import IMPORTED

SHORT_RUN = {
    "compare": "deadline engines scene_argument validation cli.commands.run cli.completion cli.entry cli.options "
    "cli.progress files.amounts foreign.guard report.listing report.output files.cache",
    "scenarios": "engine errors lazy neighbours numbers.nested_roots numbers.parsing numbers.precision "
    "numbers.quantity numbers.tower_element numbers.tower_ring scene settings things trajectory work "
    "catalogue.article catalogue.gas catalogue.scene_entry catalogue.scene_table",
    "exact": "certified compiled exact_engine exact_motion flight_formulas isometry laws.formulas "
    "laws.tangent_formulas log_symmetry numbers question replay simulation",
    "floating": "double flat knots plain plain_meetings",
}
"""What a short run of the command line may load of each layer: modules, and rooms with all that is in them."""


@pytest.mark.parametrize("engine", ["exact", "double"])
def test_what_a_short_run_loads(engine: str, tmp_path: Path) -> None:
    """Of other people's packages, what reads words and counts; of Python's, nothing slow; here, what it uses."""
    script = (
        "import atexit, sys\n"
        "atexit.register(lambda: print('LOADED', *sys.modules))\n"
        f"from truebreak.compare.cli import main; main(['run', 'gas', '--events', '5', '--engine', {engine!r}])"
    )
    told = {**os.environ, "TRUEBREAK_CACHE": str(tmp_path)}
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, cwd=tmp_path, check=False, env=told
    )
    assert done.returncode == 0, done.stderr
    loaded = set(done.stdout.rpartition("LOADED")[2].split())
    tops = {name.partition(".")[0] for name in loaded} - {"sitecustomize", "usercustomize"}  # the machine's own
    strangers = {name for name in tops - sys.stdlib_module_names if not name.startswith("_")}
    assert strangers <= {"click", "cython_runtime", "flint", "org", "truebreak"}
    slow = "decimal difflib email fractions gzip hashlib html json multiprocessing shlex subprocess tempfile"
    assert not tops & {*slow.split(), "unittest", "zipfile"}
    for layer, allowed in SHORT_RUN.items():
        names = {name.removeprefix(f"truebreak.{layer}.") for name in loaded if name.startswith(f"truebreak.{layer}.")}
        listed = set(allowed.split())
        rooms = {name for name in names if any(one.startswith(f"{name}.") for one in listed)}
        within = {name for name in names if any(f"{name}.".startswith(f"{one}.") for one in listed)}
        assert names == rooms | within, f"{layer}: {sorted(names - rooms - within)}"


def test_what_a_comparison_loads_before_its_first_line(tmp_path: Path) -> None:
    """Not what draws, forecasts, or reads records of others: of runs that agree nothing asks for these, nor for
    what nearby scenes and finer steps are computed with."""
    script = f"import sys, {', '.join(IMPORTED)}; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, cwd=tmp_path, check=True)
    spared = "scenarios.pictures compare.chaos.horizon compare.foreign.recording"
    assert not {
        "decimal",
        "fractions",
        "html",
        "numpy",
        "random",
        *(f"truebreak.{name}" for name in spared.split()),
    } & {*done.stdout.split()}


@pytest.mark.parametrize("given", [None, "3"])
def test_matrices_are_computed_in_one_thread(given: str | None, tmp_path: Path) -> None:
    """They are small; but what the user says holds."""
    name = "OPENBLAS_NUM_THREADS"
    script = (
        f"import atexit, os; atexit.register(lambda: print('THREADS', os.environ[{name!r}]))\n"
        "from truebreak.compare.cli import main; main(['scenes'])"
    )
    others = {key: value for key, value in os.environ.items() if key != name}
    done = subprocess.run(
        [sys.executable, "-P", "-c", script],
        capture_output=True,
        text=True,
        cwd=tmp_path,
        check=True,
        env=others if given is None else {**others, name: given},
    )
    assert done.stdout.split()[-2:] == ["THREADS", given or "1"]
