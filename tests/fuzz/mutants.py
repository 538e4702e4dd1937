"""Tests the fuzz itself: plants faults one at a time in a private copy, and sees after how many scenes each is found.

python tests/fuzz/mutants.py                          # every mutant
python tests/fuzz/mutants.py --only late_touches      # one, or several with commas
python tests/fuzz/mutants.py --out mutants.jsonl --report mutants.md

A mutant is found by the first scene on which the engine with the fault differs from the witness, crashes, hangs or
gives up, in the scene or in a relation of it, while the engine without it does not. The checkout is never touched.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time as clock
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass
from itertools import count, islice
from pathlib import Path
from queue import Empty, SimpleQueue
from threading import Thread, local
from typing import Any

TESTS = Path(__file__).resolve().parents[1]
TOP = TESTS.parent
if __name__ == "__main__":
    sys.path[0] = str(TESTS)

from fuzz.mutant import Mutant  # noqa: E402
from fuzz.mutants_fresh import FRESH  # noqa: E402
from fuzz.mutants_old import OLD  # noqa: E402
from fuzz.mutants_questions import LATEST  # noqa: E402

PACKAGES = ("scenarios", "tools", "exact", "floating", "compare")
MUTANTS: tuple[Mutant, ...] = (*OLD, *FRESH, *LATEST)
SCENES = 1200
PATIENCE = 20.0
"""Seconds for one scene; more is a hang."""
START = 120.0
"""Seconds for a worker to start."""
GAVE_UP = ("undecided", "budget")
WRONG = ("failure", "interval", "hang")
APPLY = {"cells", "deep", "form", "map", "midpoints", "past", "scale"}
"""Relations that apply to most scenes, unless one of their runs gives up."""
BESIDE = {"beside"}
"""That the scene of an older kind beside one by the covering array is decided."""


@dataclass(frozen=True)
class Result:
    """What came of one mutant.

    Attributes:
        outcome: "found", "survived", or "broken": it does not even start.
        how: the verdict on the scene that shows it.
        kind, seed: that scene.
        scenes, seconds: how many were played, and how long.
    """

    name: str
    outcome: str
    how: str
    kind: str
    seed: int
    scenes: int
    seconds: float
    message: str


def copy_packages(source: Path, top: Path) -> Path:
    """The packages in a folder of their own, as one regular package: no other place is searched for its parts.

    The fuzz stands beside them, so that a run may go on while the checkout is worked on.
    """
    home = top / "truebreak"
    home.mkdir(parents=True)
    for package in PACKAGES:
        shutil.copytree(source / package, home / package, ignore=shutil.ignore_patterns("__pycache__"))
    (home / "__init__.py").write_text("")
    fuzz = TESTS if source == TOP else source.parent
    shutil.copytree(fuzz / "fuzz", top / "fuzz", ignore=shutil.ignore_patterns("__pycache__"))
    return home


class Player:
    """A process that examines cases with one copy of the packages; started when first asked, and after a hang."""

    def __init__(self, home: Path) -> None:
        self.home = home
        self._process: subprocess.Popen[str] | None = None
        self._lines: SimpleQueue[str] = SimpleQueue()

    def start(self) -> str:
        """Starts it; what it says if it cannot."""
        command = [sys.executable, "-m", "fuzz.mutant_worker", str(self.home)]
        variables = {**os.environ, "PYTHONPATH": str(self.home.parent), "PYTHONDONTWRITEBYTECODE": "1"}
        variables["TRUEBREAK_PURE_PYTHON"] = "1"  # else the compiled twin of a mutant runs
        with (self.home.parent / "stderr").open("w") as errors:
            process = subprocess.Popen(
                command, cwd=self.home.parent, env=variables, text=True, stdin=-1, stdout=-1, stderr=errors, bufsize=1
            )
        self._process, self._lines = process, SimpleQueue()
        Thread(target=_pass_on, args=(process.stdout, self._lines), daemon=True).start()
        ready = self._line(START)
        if ready == '"ready"\n':
            return ""
        self.end()
        return (self.home.parent / "stderr").read_text().strip().splitlines()[-1:][0] if not ready else "no start"

    def examine(self, kind: str, seed: int, patience: float) -> dict[str, Any]:
        """The verdict on a case."""
        if self._process is None and (problem := self.start()):
            raise RuntimeError(problem)
        process = self._process
        assert process is not None and process.stdin is not None
        process.stdin.write(f"{kind} {seed}\n")
        line = self._line(patience)
        if line:
            return json.loads(line)
        self.end()
        outcome = ("hang", f"no end in {patience:g} seconds") if line is None else ("failure", "the process died")
        return {"outcome": outcome[0], "message": outcome[1]}

    def _line(self, patience: float) -> str | None:
        """The next line; empty where the process has ended, None where it takes too long."""
        try:
            return self._lines.get(timeout=patience)
        except Empty:
            return None

    def end(self) -> None:
        """Ends the process, whatever it does."""
        if self._process is not None:
            self._process.kill()
            self._process.wait()
            self._process = None


def _pass_on(lines: Any, queue: SimpleQueue[str]) -> None:
    for line in lines:
        queue.put(line)
    queue.put("")


def tasks(kinds: Sequence[str], rows: str, start: int) -> Iterator[tuple[str, int]]:
    """The kinds in turn; of scenes by the covering array only those in whose rows some ingredients are."""
    from fuzz.ingredients import row_of

    for seed in count(start):
        yield from ((kind, seed) for kind in kinds if kind != "mixed" or row_of(seed).issuperset(rows.split()))


def lacks(verdict: dict[str, Any]) -> set[str]:
    """The relations that should apply to a scene by the covering array, and did not: a run of theirs gave up."""
    from fuzz.ingredients import row_of
    from fuzz.relations import wanted_of

    if verdict.get("kind") != "mixed" or verdict["outcome"] != "ok":
        return set()
    seed = verdict["seed"]
    wanted = APPLY.intersection(wanted_of(row_of(seed), seed)) | BESIDE
    return wanted.difference(verdict["extra"].split())


def shows(verdict: dict[str, Any], original: Callable[[], dict[str, Any]], patience: float) -> str:
    """How a verdict shows a fault; empty where it does not, or where the engine without it does no better."""
    outcome, missing = verdict["outcome"], lacks(verdict)
    if outcome not in WRONG and outcome not in GAVE_UP and not missing:
        return ""
    right = original()
    if missing:
        return "undecided" if missing & set(right.get("extra", "").split()) else ""
    if right["outcome"] == outcome or right["outcome"] in WRONG:
        return ""
    return "" if outcome == "hang" and right["seconds"] > patience / 4 else outcome


def tried(mutant: Mutant, original: Player, cases: Iterator[tuple[str, int]], scenes: int, patience: float) -> Result:
    """Plants a mutant in a copy of the original, and looks for it."""
    start = clock.monotonic()
    with tempfile.TemporaryDirectory(prefix="mutant-") as folder:
        home = copy_packages(original.home, Path(folder))
        mutant.plant(home)
        player = Player(home)

        def result(outcome: str, how: str, kind: str, seed: int, played: int, message: str) -> Result:
            return Result(mutant.name, outcome, how, kind, seed, played, round(clock.monotonic() - start, 1), message)

        try:
            if problem := player.start():
                return result("broken", "", "", -1, 0, problem)
            for played, (kind, seed) in enumerate(islice(cases, scenes)):
                verdict = player.examine(kind, seed, patience)
                how = shows(verdict, lambda: original.examine(kind, seed, 3 * patience), patience)  # noqa: B023
                if how:
                    return result("found", how, kind, seed, played + 1, verdict["message"])
            return result("survived", "", "", -1, scenes, "")
        finally:
            player.end()


def run(mutants: Sequence[Mutant], options: argparse.Namespace) -> list[Result]:
    """Tries mutants, each beside an engine without it; the results in their order."""
    from fuzz.generators import KINDS

    kinds = options.kinds.split(",") if options.kinds else KINDS
    mine, originals = local(), []
    with tempfile.TemporaryDirectory(prefix="original-") as folder:
        home = copy_packages(TOP, Path(folder))

        def one(mutant: Mutant) -> Result:
            if not hasattr(mine, "original"):
                mine.original = Player(home)
                originals.append(mine.original)
            cases = tasks(kinds, options.rows, options.start)
            found = tried(mutant, mine.original, cases, options.scenes, options.patience)
            print(told(found), flush=True)
            if options.out:
                with Path(options.out).open("a") as file:
                    file.write(json.dumps(asdict(found)) + "\n")
            return found

        try:
            with ThreadPoolExecutor(options.jobs) as pool:
                return list(pool.map(one, mutants))
        finally:
            for player in originals:
                player.end()


def told(result: Result) -> str:
    """A line on one result."""
    where = f"{result.how} by {result.kind} {result.seed}" if result.outcome == "found" else ""
    line = f"{result.name:34}{result.outcome:10}{where:34}{result.scenes:6} scenes{result.seconds:8.1f} s"
    return f"{line}  {result.message[:150]}".rstrip()


def table(mutants: Sequence[Mutant], results: Sequence[Result]) -> str:
    """The results as a table in Markdown."""
    rows = ["| mutant | what it breaks | found by | after scenes |", "|---|---|---|---|"]
    for mutant, result in zip(mutants, results, strict=True):
        if result.outcome == "found":
            found, scenes = f"{result.kind} {result.seed} ({result.how})", str(result.scenes)
        else:
            found, scenes = mutant.why_it_survives or f"**{result.outcome}**", f"over {result.scenes}"
        rows.append(f"| `{mutant.name}` | {mutant.breaks} | {found} | {scenes} |")
    return "\n".join(rows) + "\n"


def summary(mutants: Sequence[Mutant], results: Sequence[Result]) -> str:
    """The counts, and who was missed."""
    counts = Counter(result.outcome for result in results)
    pairs = list(zip(mutants, results, strict=True))
    missed = [m.name for m, r in pairs if r.outcome != "found" and not m.why_it_survives]
    excused = [m.name for m, r in pairs if r.outcome == "survived" and m.why_it_survives]
    lines = [f"{len(results)} mutants: " + ", ".join(f"{n} {name}" for name, n in sorted(counts.items()))]
    lines += [f"no scene can show: {', '.join(excused)}"] if excused else []
    lines += [f"MISSED: {', '.join(missed)}"] if missed else []
    return "\n".join(lines)


def main() -> int:
    """The command; 1 if a mutant is missed that should be found, or no longer applies; 2 if there is none to try."""
    parser = argparse.ArgumentParser(description="Plants faults one at a time, and lets the fuzz look for them.")
    parser.add_argument("--only", help="names, or beginnings of names, with commas between; all if not given")
    parser.add_argument("--scenes", type=int, default=SCENES, help="scenes after which a mutant counts as surviving")
    parser.add_argument("--kinds", help="kinds, with commas between; all if not given")
    parser.add_argument("--rows", default="", help="of `mixed` only scenes in whose rows these ingredients are")
    parser.add_argument("--start", type=int, default=0, help="the first seed")
    parser.add_argument("--jobs", type=int, default=1, help="mutants at a time")
    parser.add_argument("--patience", type=float, default=PATIENCE, help="seconds until a scene counts as a hang")
    parser.add_argument("--out", help="a file to which each result is added as a line")
    parser.add_argument("--report", help="a file for the table in Markdown")
    options = parser.parse_args()
    wanted = tuple(options.only.split(",")) if options.only else ("",)
    named = [mutant for mutant in MUTANTS if mutant.name.startswith(wanted)]
    problems = [problem for mutant in named for problem in mutant.misplaced(TOP)]
    mutants = [mutant for mutant in named if not mutant.misplaced(TOP)]
    if not mutants:
        print("\n".join(problems) or "no mutant of that name", file=sys.stderr)
        return 2
    results = run(mutants, options)
    print(summary(mutants, results))
    if problems:
        print("\n".join([f"NO LONGER APPLY, and were not tried: {len(named) - len(mutants)}", *problems]))
    if options.report:
        Path(options.report).write_text(table(mutants, results))
    pairs = zip(mutants, results, strict=True)
    missed = any(result.outcome != "found" and not mutant.why_it_survives for mutant, result in pairs)
    return 1 if missed or problems else 0


if __name__ == "__main__":
    sys.exit(main())
