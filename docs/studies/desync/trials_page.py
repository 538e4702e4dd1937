"""What `truebreak diff` names of pairs of logs of which it is known what came between them: docs/desync-trials.md.

`python docs/studies/desync/trials_page.py` makes all pairs, compares them and writes the page (two minutes, and other
people's engines: `pip install -e '.[engines]'`); `--check` says which of its rows are no longer so, and writes nothing.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from desync_pairs import pairs
from desync_trials import trials
from desync_worlds import Trial

from truebreak.compare.logdiff.desync import diff
from truebreak.compare.logdiff.growing import NEVER
from truebreak.compare.logdiff.verdict import Finding, Verdict

FILE = Path(__file__).resolve().parents[2] / "desync-trials.md"

FAINT = 8.0
"""Bits above one ulp that no more than rounding comes to, in a run that is not chaotic."""


@dataclass(frozen=True)
class Outcome:
    """What came of a trial."""

    trial: Trial
    verdict: Verdict
    largest: float

    @property
    def mark(self) -> str:
        """`right`, `wrong` or `open`.

        A fault that never makes a difference beyond rounding, as a mass that only meets walls, is rounding; one that
        makes none at all, as a contact lost of two that part already, leaves the runs identical.
        """
        if self.verdict.name is Finding.OPEN:
            return "open"
        faint = self.verdict.name is Finding.GREW and self.largest < FAINT
        nothing = self.verdict.same and self.largest == NEVER and bool(self.trial.true)
        return "right" if self.verdict.name in self.trial.true or faint or nothing else "wrong"

    @property
    def row(self) -> str:
        """Its row of a table."""
        return f"| {self.trial.world} | {self.trial.what} | {self.verdict.line} | {self.mark} |"


def tried(trial: Trial) -> Outcome:
    """Makes a pair and has it compared."""
    with tempfile.TemporaryDirectory() as folder:
        paths = [Path(folder) / f"{name}{trial.suffix}" for name in "ab"]
        for path, log in zip(paths, trial.make(), strict=True):
            text = log if isinstance(log, str) else "".join(json.dumps(line) + "\n" for line in log)
            path.write_text(text, encoding="utf-8")
        found = diff(*paths)
        return Outcome(trial, found.verdict, found.found.growing.largest)


SETS = {
    "The pairs that the thresholds were chosen with": (
        "Pymunk, Box2D, Rapier and MuJoCo, truebreak's own engines, and an engine in C built with other flags. Where a "
        "fault strikes, and how hard, is drawn by a seed. Which contact of Box2D is the one that is lost depends on "
        "where its memory lies, so that these rows may be others in another run.",
        lambda: trials(0),
    ),
    "The same faults in other worlds": (
        "At other steps, of other sizes. No threshold was changed after they were made.",
        lambda: trials(100),
    ),
    "Pairs by another author": (
        "A small solver in Python in 2D and 3D, an event-driven gas, pymunk with joints, and a chain of pendulums in C "
        "(`desync_pairs.py`): written from the docs alone, most of them before the code that decides was looked at. Of "
        "these pairs that code, as it was then, named 210, 197 of them rightly (93.8 %), one of these with its event "
        "five steps late, and refused 3. What was wrong: 15 digits in one log taken for rounding, or for a change; "
        "times that are floats, or have four decimals, taken for a change; noise and denormals in the first record "
        "taken for another start; another time step, in logs without steps, and another start, where one log begins "
        "later, taken for a change. The table is of the code that was mended.",
        pairs,
    ),
}
"""The sets: their titles, what is said of them, and their pairs."""

INTRODUCTION = """# Trials of `truebreak diff`

Pairs of logs of which it is known what came between them, and what `truebreak diff` named of each.
`python docs/studies/desync/trials_page.py` makes them and writes this page; `--check` says what is no longer so.

{summary}

How pairs are counted (`Outcome.mark` in that file, `TRUE_NAMES` and the pairs' own lists beside it):

- *right*: the first line is one of those that the fault allows. Run twice, renamed, clocks shifted: identical. One
  ulp at a start, another build: grew from rounding. A start moved, another step or gravity: different from the start.
  A lost contact, memory, input, a number overwritten: changed; another mass: changed, or different from the start.
  Bodies added in another order, and threads: anything but different from the start, as they change what a solver does
  that has not converged, or only the rounding, or nothing. A fault that never came to more than 2**8 ulps may be
  called rounding, and one that changed no bit identical.
- *wrong*: any other verdict, except "not determined". The event that is named is not judged here; the tests require
  it for faults of which the step is known.
- *open*: "not determined", which is never wrong. Of logs cut short, or with a line lost or twice, nothing else is
  right.
"""

HEAD = "| engine and world | what came between | named | |\n|---|---|---|---|"


def page(sets: Iterable[tuple[str, str, Sequence[Outcome]]]) -> str:
    """The page, of titles, texts and outcomes."""
    summary = ["| set | pairs | named right | named wrong | not determined | right of those named |", "|" + "---|" * 6]
    parts: list[str] = []
    for title, text, outcomes in sets:
        counts = Counter(o.mark for o in outcomes)
        named = counts["right"] + counts["wrong"]
        numbers = f"{len(outcomes)} | {counts['right']} | {counts['wrong']} | {counts['open']}"
        summary.append(f"| {title} | {numbers} | {100 * counts['right'] / max(1, named):.1f} % |")
        parts.append(f"\n## {title}\n\n{text}\n\n{HEAD}\n" + "".join(f"{o.row}\n" for o in outcomes))
    return INTRODUCTION.format(summary="\n".join(summary)) + "".join(parts)


def main(arguments: Sequence[str] | None = None) -> int:
    """Makes all pairs; writes the page, or compares with it; the exit status."""
    parser = argparse.ArgumentParser(prog="python docs/studies/desync/trials_page.py", description=__doc__)
    parser.add_argument("--check", action="store_true", help="say what is no longer so, and write nothing")
    options = parser.parse_args(arguments)
    sets: list[tuple[str, str, list[Outcome]]] = []
    for title, (text, make) in SETS.items():
        sets.append((title, text, []))
        for trial in make():
            outcome = tried(trial)
            sets[-1][2].append(outcome)
            if outcome.mark == "wrong":
                print(f"wrong: {outcome.row} {outcome.verdict.why}", file=sys.stderr)
    text = page(sets)
    if not options.check:
        FILE.write_text(text, encoding="utf-8")
        return 0
    before = FILE.read_text("utf-8").splitlines()
    changed = [line for line in text.splitlines() if line not in set(before)]
    print("\n".join(changed) or "the page is as it comes out now")
    return 1 if changed else 0


if __name__ == "__main__":
    sys.exit(main())
