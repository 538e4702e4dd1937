"""Runs every honest engine and every planted bug on every scene through the audit, and counts what it gets wrong.

    python -m audit.bench.attack --out found.jsonl              # in tests/compare, or with it on the path
    python -m audit.bench.attack --out found.jsonl --judge own  # the bench's own residuals, in the place of the audit

A row a line, appended as it comes: a run that is stopped goes on where it was. Two things are wrong: an honest engine
of which the law is said not to be kept (a false alarm; a bug that no number of its engine can tell is honest, too), and
a bug that is visible beyond doubt and of which it is not said (missed). What is in between is run, and not counted.
"""

from __future__ import annotations

import argparse
import importlib
import json
import time
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

from truebreak.compare.validation import EngineError

from .bugs import BUGS
from .honest import HONEST
from .residuals import residuals
from .scenes import CASES, Case, scene_of
from .truth import INVISIBLE, MEASURED, VISIBLE, classify
from .worlds import PRECISE

HONEST_CONSTANT = 64.0
"""Units of rounding that the bench's own judge grants each residual."""


class Judged(NamedTuple):
    """What a judge says of a run."""

    kept: bool | None
    finding: str


def audit(engine: Any, scene: Any, **span: Any) -> Any:
    """The audit that is judged here: an object with `kept` and `finding`. This is the one place that names it."""
    from truebreak.compare.audit.audit import audit_run

    return audit_run(engine.run(scene, **span), engine)


def own(engine: Any, scene: Any, **span: Any) -> Judged:
    """The bench's own residuals, with `HONEST_CONSTANT`: for engines of events with states; else not determined."""
    if engine.step is not None or engine.tells == "nothing":
        return Judged(None, "no states, or steps")
    run, u = engine.run(scene, **span), PRECISE.mpf(2) ** -engine.bits
    for residual in residuals(run):
        size = MEASURED.get(residual.kind)
        if size is not None and residual.units(size, u) > HONEST_CONSTANT:
            told = f"{residual.kind} of {residual.units(size, u):.3g} u"
            return Judged(False, f"event {residual.event}: {told}")
    return Judged(True, "")


def jobs(only: str, scenes: str, group: str) -> Iterator[tuple[str, str, Any, Case]]:
    """("honest" or "bug", name, engine, case) of all that there is to do."""
    groups = {"honest": HONEST, "bug": {name: bug.engine for name, bug in BUGS.items()}}
    for kind, engines in groups.items():
        for name, engine in engines.items():
            for case in CASES.values():
                if group not in (kind, "all") or only not in name or scenes not in case.name:
                    continue
                if case.takes(engine):
                    yield kind, name, engine, case


def row_of(kind: str, name: str, engine: Any, case: Case, judge: Callable[..., Any] | None) -> dict[str, Any]:
    """One row: what is true, and what the judge says."""
    row: dict[str, Any] = {"kind": kind, "engine": name, "scene": case.name}
    if kind == "bug":
        began = time.perf_counter()
        try:
            seen = classify(BUGS[name], case)
            row.update(truth=seen.kind, units=seen.units, event=seen.event, what=seen.what)
        except ZeroDivisionError:  # the fault puts two centres in one place: what is true is not measured
            row.update(truth="between", units=0.0, event=-1, what="")
        row["truth_seconds"] = round(time.perf_counter() - began, 3)
    else:
        row.update(truth="honest")
    if judge is None:
        return row
    began = time.perf_counter()
    try:
        said = judge(engine, scene_of(case.name), **case.span(engine))
        row.update(kept=said.kept, finding=str(said.finding)[:300])
    except EngineError as error:  # what cannot be judged is refused, with a reason: that is a finding
        row.update(kept=False, finding=f"refused: {error}"[:300], refused=True)
    except Exception as error:  # a judge that raises is wrong, whatever it judges
        row.update(kept="error", finding=f"{type(error).__name__}: {error}"[:300])
    row["seconds"] = round(time.perf_counter() - began, 3)
    return row


def outcome(row: dict[str, Any]) -> str:
    """Whether a row is right, a false alarm, missed, an error, or not counted."""
    if row.get("kept") == "error":
        return "error"
    if row["truth"] in ("honest", INVISIBLE):
        return "false alarm" if row["kept"] is False else "honest, passed"
    if row["truth"] == VISIBLE:
        return "bug, seen" if row["kept"] is False else "missed"
    return "not counted"


def told(count: int, of: int) -> str:
    """How often something went wrong; none of N is below 3/N at 95 % (Hanley and Lippman-Hand, JAMA 249, 1983, 1743).

    >>> told(0, 300)
    '0 of 300, below 0.01 at 95 %'
    """
    return f"{count} of {of}" + (f", below {3 / of:.2g} at 95 %" if of and not count else "")


def summary(rows: list[dict[str, Any]]) -> str:
    """What a run of the bench comes to."""
    judged = [row for row in rows if "kept" in row]
    by = Counter(outcome(row) for row in judged)
    quiet = by["false alarm"] + by["honest, passed"]
    seen = by["bug, seen"] + by["missed"]
    undetermined = sum(row["kept"] is None for row in judged if row["truth"] in ("honest", INVISIBLE))
    lines = [
        f"false alarms: {told(by['false alarm'], quiet)} ({undetermined} of them not determined)",
        f"missed: {told(by['missed'], seen)}",
        f"errors of the judge: {by['error']}; in between, not counted: {by['not counted']}; rows: {len(rows)}",
    ]
    for row in judged:
        if outcome(row) in ("false alarm", "missed", "error"):
            truth = "" if row["truth"] == "honest" else f" ({row['units']:.3g} u, {row['what']} at {row['event']})"
            finding = row["finding"] or row["kept"]
            lines.append(f"  {outcome(row)}: {row['engine']} on {row['scene']}{truth}: {finding}"[:240])
    return "\n".join(lines)


def judge_named(name: str) -> Callable[..., Any] | None:
    """The judge: `audit`, `own`, `none`, or MODULE:FUNCTION."""
    if ":" in name:
        module, _, function = name.partition(":")
        return getattr(importlib.import_module(module), function)
    return {"audit": audit, "own": own, "none": None}[name]


def main(words: list[str] | None = None) -> int:
    """The command; 1 where something is wrong."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--out", type=Path, required=True, help="rows, one a line; those that are there are kept")
    parser.add_argument("--judge", default="audit", help="audit, own, none (truth alone), or MODULE:FUNCTION")
    parser.add_argument("--only", default="", help="engines and bugs whose names have this in them")
    parser.add_argument("--scenes", default="", help="scenes whose names have this in them")
    parser.add_argument("--group", default="all", choices=("honest", "bug", "all"))
    parser.add_argument("--truth", type=Path, help="rows of an earlier run, from which the truth is taken")
    given = parser.parse_args(words)
    lines = given.out.read_text("utf-8").splitlines() if given.out.exists() else []
    rows = [json.loads(line) for line in lines]
    done = {(row["kind"], row["engine"], row["scene"]) for row in rows}
    if given.truth:
        _remember(given.truth)
    judge = judge_named(given.judge)
    with given.out.open("a", encoding="utf-8") as out:
        for kind, name, engine, case in jobs(given.only, given.scenes, given.group):
            if (kind, name, case.name) in done:
                continue
            row = row_of(kind, name, engine, case, judge)
            rows.append(row)
            out.write(json.dumps(row) + "\n")
            out.flush()
    print(summary(rows))
    wrong = {"false alarm", "missed", "error"}
    return int(any(outcome(row) in wrong for row in rows if "kept" in row))


def _remember(path: Path) -> None:
    """Takes truths from the rows of an earlier run: they do not depend on the judge."""
    from .truth import Seen

    known = {
        (row["engine"], row["scene"]): Seen(row["truth"], row["units"], row["event"], row["what"])
        for row in map(json.loads, path.read_text("utf-8").splitlines())
        if row["kind"] == "bug"
    }
    anew = globals()["classify"]
    globals()["classify"] = lambda bug, case: known.get((bug.name, case.name)) or anew(bug, case)


if __name__ == "__main__":
    raise SystemExit(main())
