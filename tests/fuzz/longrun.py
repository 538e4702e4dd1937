"""The long run behind `stress.py`: resumable, watched, counted."""

from __future__ import annotations

import argparse
import faulthandler
import json
import math
import multiprocessing
import signal
import sys
import time as clock
from collections import Counter, defaultdict
from collections.abc import Iterator
from dataclasses import asdict
from itertools import combinations
from multiprocessing.connection import Connection, wait
from pathlib import Path
from typing import Any

from fuzz.check import shown
from fuzz.examine import Verdict, examine
from fuzz.generators import KINDS, case_of
from fuzz.ingredients import INGREDIENTS, PAIRS
from fuzz.referee import referee
from truebreak.exact import ExactEngine
from truebreak.scenarios.files import dump_toml

PATIENCE = 60.0
"""Seconds of processor time after which a scene counts as a hang: on a loaded machine no sooner than on an idle one."""
ASLEEP = 20
"""A scene that has not ended after so many times that, by the clock on the wall, waits: a hang as well."""
OFTEN = 30
"""So many scenes each pair of ingredients is to take part in together."""
OUTCOMES = ("ok", "undecided", "budget", "failure", "interval", "hang", "skipped")
BAD = ("failure", "interval", "hang")


def work(pipe: Connection, patience: float) -> None:
    """A worker: takes (kind, seed), gives back a verdict, until it is sent None; a hang ends it by a signal."""
    try:
        while (task := pipe.recv()) is not None:
            signal.setitimer(signal.ITIMER_PROF, patience)
            verdict = examine(*task)
            signal.setitimer(signal.ITIMER_PROF, 0)
            pipe.send(verdict)
    except (EOFError, KeyboardInterrupt):
        return


class Worker:
    """One process, what it does and since when."""

    def __init__(self, patience: float) -> None:
        self.pipe, end = multiprocessing.Pipe()
        self.process = multiprocessing.Process(target=work, args=(end, patience), daemon=True)
        self.process.start()
        end.close()
        self.task: tuple[str, int] | None = None
        self.since = 0.0

    def give(self, task: tuple[str, int]) -> None:
        """Starts on a case."""
        self.task, self.since = task, clock.monotonic()
        self.pipe.send(task)

    def died(self, patience: float) -> tuple[str, str]:
        """The outcome of a process that is no more, and what to say of it."""
        self.process.join()
        if self.process.exitcode == -signal.SIGPROF:
            return "hang", f"no end in {patience:g} seconds of processor time"
        return "failure", "the process died"

    def end(self) -> None:
        """Ends the process, whatever it does."""
        self.process.kill()
        self.process.join()


def stress(tasks: Iterator[tuple[str, int]], jobs: int, patience: float) -> Iterator[Verdict]:
    """The verdicts on all tasks as they come: too long is a hang, a worker that dies a failure."""
    workers = [Worker(patience) for _ in range(jobs)]
    try:
        for worker in workers:
            if (task := next(tasks, None)) is not None:
                worker.give(task)
        while busy := [worker for worker in workers if worker.task is not None]:
            ready = wait([worker.pipe for worker in busy], timeout=1.0)
            for place, worker in enumerate(workers):
                if worker.task is None:
                    continue
                verdict = None
                kind, seed = worker.task
                seconds = clock.monotonic() - worker.since
                if worker.pipe in ready:
                    try:
                        verdict = worker.pipe.recv()
                    except EOFError:
                        outcome, message = worker.died(patience)
                        verdict = Verdict(kind, seed, outcome, 0, seconds, message)
                elif seconds > ASLEEP * patience:
                    verdict = Verdict(kind, seed, "hang", 0, seconds, f"no end in {ASLEEP * patience:g} seconds")
                if verdict is None:
                    continue
                if verdict.outcome == "hang" or not worker.process.is_alive():
                    worker.end()
                    worker = workers[place] = Worker(patience)
                worker.task = None
                yield verdict
                if (task := next(tasks, None)) is not None:
                    worker.give(task)
    finally:
        for worker in workers:
            worker.end()


def past(out: Path) -> list[dict[str, Any]]:
    """The verdicts in a file; a line that was cut off while it was written is left out."""
    rows = []
    if out.exists():
        for line in out.read_text().splitlines():
            try:
                rows.append(json.loads(line))
            except ValueError:
                continue
    return rows


def report(rows: list[dict[str, Any]]) -> str:
    """The counts by kind; where no fault was seen, its rate is below 3/N with a confidence of 95%."""
    by: dict[str, list[dict[str, Any]]] = defaultdict(list)
    for row in rows:
        by[row["kind"]].append(row)
    head = f"{'kind':14}{'scenes':>8}{'events':>9}" + "".join(f"{name:>10}" for name in OUTCOMES)
    lines = [f"{head}{'endless':>9}{'ms':>7}{'3/N':>10}"]
    for kind, group in [*sorted(by.items()), ("all", rows)]:
        counts = Counter(row["outcome"] for row in group)
        judged = len(group) - counts["skipped"]
        bad = counts["failure"] + counts["hang"]
        bound = f"{3 / judged:.1e}" if judged and not bad else "-"
        milliseconds = 1000 * sum(row["seconds"] for row in group) / max(1, len(group))
        line = f"{kind:14}{len(group):8}{sum(row['events'] for row in group):9}"
        line += "".join(f"{counts[name]:10}" for name in OUTCOMES)
        lines.append(f"{line}{sum(row['endless'] for row in group):9}{milliseconds:7.0f}{bound:>10}")
    extras = Counter(name for row in rows for name in row["extra"].split())
    lines.append("further checks: " + (", ".join(f"{n} {name}" for name, n in sorted(extras.items())) or "none"))
    lines += covered([row["exercised"] for row in rows if row.get("exercised")])
    bad_rows = [row for row in rows if row["outcome"] in BAD]
    shortened = [(row["outcome"], f"{row['kind']} {row['seed']}: {row['message'][:160]}") for row in bad_rows[:40]]
    lines += [f"{outcome}: --replay {rest}" for outcome, rest in shortened]
    if len(bad_rows) > 40:
        lines.append(f"... and {len(bad_rows) - 40} more")
    return "\n".join(lines)


def covered(found: list[list[str]]) -> list[str]:
    """How often each ingredient took part, and pairs and triples of them: those of the scenes by the covering array."""
    if not found:
        return []
    names = list(INGREDIENTS)
    sets = [[name for name in names if name in row] for row in found]
    ones, pairs, triples = (Counter(t for row in sets for t in combinations(row, size)) for size in (1, 2, 3))
    rare = sorted(PAIRS, key=lambda pair: pairs[pair])[:8]
    often = sum(pairs[pair] >= OFTEN for pair in PAIRS)
    return [
        "took part: " + ", ".join(f"{name} {ones[name,]}" for name in sorted(names, key=lambda name: ones[name,])),
        f"pairs: {often} of {len(PAIRS)} at least {OFTEN} times; "
        + ", ".join(f"{a} with {b} {pairs[a, b]}" for a, b in rare),
        f"triples: {len(triples)} of {math.comb(len(names), 3)}, half of them at least "
        f"{sorted(triples[t] for t in combinations(names, 3))[math.comb(len(names), 3) // 2]} times",
    ]


def run(options: argparse.Namespace) -> int:
    """Runs as many scenes as are still to be done; 1 if something failed."""
    out = Path(options.out)
    rows = past(out)
    done = {(row["kind"], row["seed"]) for row in rows}
    kinds = options.kinds.split(",") if options.kinds else KINDS
    wanted = ((kinds[i % len(kinds)], options.start + i // len(kinds)) for i in range(options.scenes))
    tasks = [task for task in wanted if task not in done]
    start = last = clock.monotonic()
    count = bad = 0
    try:
        with out.open("a") as file:
            if out.stat().st_size and not out.read_bytes().endswith(b"\n"):
                file.write("\n")
            for verdict in stress(iter(tasks), options.jobs, options.patience):
                row = asdict(verdict)
                rows.append(row)
                file.write(json.dumps(row) + "\n")
                file.flush()
                count += 1
                bad += verdict.outcome in BAD
                if clock.monotonic() - last > 1 or count == len(tasks):
                    last = clock.monotonic()
                    rate = count / (last - start)
                    left = (len(tasks) - count) / rate
                    told = f"\r{count}/{len(tasks)} scenes, {bad} bad, {rate:.0f}/s, {left / 60:.0f} min left   "
                    print(told, end="", file=sys.stderr, flush=True)
    except KeyboardInterrupt:
        print("\nstopped; the same call goes on from here", file=sys.stderr)
    print(file=sys.stderr)
    print(report(rows))
    return 1 if bad else 0


def replay(kind: str, seed: int) -> int:
    """Shows one case: its scene, what the referee says, what the engine says, and the verdict."""
    case = case_of(kind, seed)
    print(dump_toml(case.scene))
    print(f"# until = {case.until}, events = {case.events}")
    told = referee(case.scene, case.until, case.events)
    ids = case.scene.ids
    for event in told.events:
        print(f"referee  {shown(event.time, told):26} {sorted((ids[i], ids[j]) for i, j in event.contacts)}")
    for entry in told.entries:
        names = case.scene.circles[entry.circle].id, case.scene.pockets[entry.pocket].id
        print(f"referee  {shown(entry.time, told):26} enters {names}")
    turned = told.reversal and (told.reversal[0], shown(told.reversal[1], told))
    print(f"referee  {shown(told.final_time, told):26} {told.stop}, reversal {turned}", flush=True)
    faulthandler.dump_traceback_later(PATIENCE, exit=True)
    mine = ExactEngine().run(case.scene, until=case.until, events=case.events)
    for event in mine.events:
        print(f"engine   {float(event.time):<26.20g} {[tuple(c) for c in event.contacts]}")
    for p in mine.pocketings:
        print(f"engine   {float(p.time):<26.20g} enters {(p.circle, p.pocket)}")
    turned = mine.reversal and (mine.reversal.after, float(mine.reversal.time))
    print(f"engine   {float(mine.final_time):<26.20g} {mine.stop.reason.name}: {mine.stop.message}, reversal {turned}")
    verdict = examine(kind, seed)
    print(f"{verdict.outcome}: {verdict.message or 'agrees'}")
    return 1 if verdict.outcome in BAD else 0


def main() -> int:
    """The command."""
    parser = argparse.ArgumentParser(prog="stress.py", description=__doc__)
    parser.add_argument("--scenes", type=int, default=2_000, help="how many in all, spread over the kinds")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--out", default="fuzz.jsonl", help="the verdicts, one a line; a second call goes on")
    parser.add_argument("--kinds", help="comma-separated; all if left out")
    parser.add_argument("--start", type=int, default=0, help="the first seed")
    parser.add_argument("--patience", type=float, default=PATIENCE, help="seconds of processor time until a hang")
    parser.add_argument("--report", action="store_true", help="only print the counts of --out")
    parser.add_argument("--replay", nargs=2, metavar=("KIND", "SEED"))
    options = parser.parse_args()
    if options.replay:
        return replay(options.replay[0], int(options.replay[1]))
    if options.report:
        print(report(past(Path(options.out))))
        return 0
    return run(options)
