"""Of pairs of logs by another author what is named is right, and docs/desync-trials.md says what came out."""

from __future__ import annotations

from collections import Counter

import pytest
from desync_pairs import event_pairs, pairs, stepped_pairs
from desync_worlds import Trial
from trials_page import FILE, SETS, tried

from truebreak.compare.logdiff.verdict import Finding

PYTHON = [*stepped_pairs(), *event_pairs()]
"""Those whose worlds are in Python alone: the same on every machine."""

MENDED = {
    "15 digits in one log", "a body gone for five steps, in a gas of 3D", "denormals are flushed to zero",
    "a spin that is noise of 1e-17", "velocities alone left out in one log", "another step; times and states",
    "a start moved; the other log begins at step 30", "a shove at step 50; the other log printed by %.15g",
    "another step; the other log printed by %.15g", "a shove at step 50; the other log has x and vx",
    "times in floats in one log", "times with 4 decimals in both, and an ulp",
    "a sleeping body is not logged in one log",
    "one start moved by an ulp, times in floats, without states",
}  # fmt: skip
"""Those that were named wrongly, or refused, once."""

QUICK = [trial for k, trial in enumerate(PYTHON) if k % 6 == 0 or trial.what in MENDED]


def test_those_that_were_wrong_once_are_among_the_quick_ones() -> None:
    assert {trial.what for trial in QUICK} >= MENDED


def told(trial: Trial) -> str:
    return f"{trial.world}, {trial.what}"


def right(trial: Trial) -> None:
    """What is named is right, at its event, and stands in the page."""
    outcome = tried(trial)
    assert outcome.mark != "wrong", outcome.verdict
    if outcome.verdict.name in (Finding.CHANGED, Finding.START) and trial.at is not None:
        assert outcome.verdict.event == trial.at
    assert outcome.row in FILE.read_text("utf-8"), "run: python docs/studies/desync/trials_page.py"


@pytest.mark.parametrize("trial", QUICK, ids=told)
def test_a_pair_by_another_author_is_named_rightly(trial: Trial) -> None:
    right(trial)


@pytest.mark.slow
@pytest.mark.parametrize("trial", [trial for trial in PYTHON if trial not in QUICK], ids=told)
def test_every_pair_by_another_author_is_named_rightly(trial: Trial) -> None:
    right(trial)


@pytest.mark.slow
@pytest.mark.parametrize("trial", pairs()[len(PYTHON) :], ids=told)
def test_a_pair_of_pymunk_or_a_build_in_c_is_named_rightly(trial: Trial) -> None:
    """Their rows may be others in the page, by the version of pymunk and by the processor."""
    assert tried(trial).mark != "wrong"


def test_the_page_counts_its_rows_and_of_what_is_named_99_of_100_are_right() -> None:
    text = FILE.read_text("utf-8")
    for title, (about, _) in SETS.items():
        part = text.partition(f"\n## {title}\n")[2].partition("\n## ")[0]
        assert about in part
        marks = Counter(line.rpartition(" | ")[2].strip(" |") for line in part.splitlines() if line.startswith("| "))
        counts = [
            sum(marks[mark] for mark in ("right", "wrong", "open")),
            marks["right"],
            marks["wrong"],
            marks["open"],
        ]
        assert f"| {title} | {' | '.join(map(str, counts))} |" in text
        assert counts[0] > 200 and marks["wrong"] * 100 <= marks["right"] + marks["wrong"] > 0.7 * counts[0]
