"""What it costs to compare long logs, and to record a pymunk space.

`python docs/studies/desync_costs.py` compares logs of 1,000,000 events of a gas of 100 discs, with states
(`--events N`: of others; it takes a C compiler and 250 bytes of disk an event, four times); `--record` measures
`truebreak.pymunk.record`.
"""

from __future__ import annotations

import argparse
import json
import math
import random
import shutil
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from time import process_time
from typing import Any

import truebreak.compare.logdiff
from truebreak.compare.logdiff.pymunk_record import record

EVENTS, BODIES, STEPS, BLOCKS = 1_000_000, 100, 320, 15

GAS = r"""
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include "truebreak_log.h"
enum { N = 100 };
static double x[N], y[N], vx[N], vy[N], at[N], due[N];
static int with[N];
static const double r = 0.5, size = 20;
static const char *walls[4] = {"left", "right", "floor", "roof"};
static void move(int i, double t) { x[i] += vx[i] * (t - at[i]); y[i] += vy[i] * (t - at[i]); at[i] = t; }
static double pair(int i, int j, double t) {
    double dx = x[j] + vx[j] * (t - at[j]) - x[i], dy = y[j] + vy[j] * (t - at[j]) - y[i];
    double ux = vx[j] - vx[i], uy = vy[j] - vy[i], b = dx * ux + dy * uy, c = dx * dx + dy * dy - 4 * r * r;
    double d = b * b - (ux * ux + uy * uy) * c;
    return b >= 0 || d < 0 ? INFINITY : t + c / (-b + sqrt(d));
}
static void predict(int i, double t) {
    due[i] = INFINITY;
    for (int k = 0; k < 4; k++) {
        double v = k < 2 ? vx[i] : vy[i], p = k < 2 ? x[i] : y[i];
        double s = (k % 2 ? v > 0 : v < 0) ? t + ((k % 2 ? size - r : r) - p) / v : INFINITY;
        if (s < due[i]) due[i] = s, with[i] = N + k;
    }
    for (int j = 0; j < N; j++) if (j != i) { double s = pair(i, j, t); if (s < due[i]) due[i] = s, with[i] = j; }
}
int main(int count, char **words) {
    long events = atol(words[1]), nudge = atol(words[2]);
    unsigned seed = 12345;
    double *all[4] = {x, y, vx, vy}, state[4];
    char names[N][8];
    tb_log *log = tb_open(words[3], "gas in C", "x,y,vx,vy", 53);
    for (int i = 0; i < N; i++) {
        for (int k = 0; k < 4; k++) seed = seed * 1103515245u + 12345u, all[k][i] = (seed >> 16) % 10000 / 10000.0;
        x[i] = 1 + 1.9 * (i % 10) + 0.5 * x[i], y[i] = 1 + 1.9 * (i / 10) + 0.5 * y[i];
        vx[i] = 2 * vx[i] - 1, vy[i] = 2 * vy[i] - 1;
        snprintf(names[i], 8, "d%d", i);
    }
    for (int i = 0; i < N; i++) predict(i, 0);
    for (long e = 0; e < events; e++) {
        int i = 0, j;
        for (int k = 1; k < N; k++) if (due[k] < due[i]) i = k;
        double t = due[i];
        j = with[i];
        move(i, t);
        if (j < N) {
            move(j, t);
            double dx = x[j] - x[i], dy = y[j] - y[i];
            double s = ((vx[j] - vx[i]) * dx + (vy[j] - vy[i]) * dy) / (dx * dx + dy * dy);
            vx[i] += s * dx, vy[i] += s * dy, vx[j] -= s * dx, vy[j] -= s * dy;
        } else if (j < N + 2) vx[i] = -vx[i]; else vy[i] = -vy[i];
        if (e == nudge) vx[i] = nextafter(vx[i], 9);
        tb_step(log, e, t);
        tb_contact(log, names[i], j < N ? names[j] : walls[j - N]);
        for (int q = 0; q < (j < N ? 2 : 1); q++) {
            for (int k = 0; k < 4; k++) {
                state[k] = all[k][q ? j : i];
                if (nudge == -2) state[k] = nextafter(state[k], (e + k) % 2 ? 99 : -99);
            }
            tb_state(log, names[q ? j : i], state, 4);
        }
        predict(i, t);
        if (j < N) predict(j, t);
        for (int k = 0; k < N; k++) {
            if (k == i || k == j) continue;
            if (with[k] == i || (j < N && with[k] == j)) move(k, t), predict(k, t);
            else {
                if (with[i] == k && due[i] < due[k]) due[k] = due[i], with[k] = i;
                if (j < N && with[j] == k && due[j] < due[k]) due[k] = due[j], with[k] = j;
            }
        }
    }
    return tb_close(log);
}
"""
"""A gas of discs, event by event; one velocity is moved by an ulp at one event, or each number that is written."""


def logs(folder: Path, events: int) -> Iterator[tuple[str, Path, Path]]:
    """Pairs of logs of a gas, made one after another: what came between them, and the two.

    Raises:
        OSError: without a C compiler.
    """
    source, program = folder / "gas.c", folder / "gas"
    source.write_text(GAS, encoding="utf-8")
    header = truebreak.compare.logdiff.__path__[0]
    compiler = next((name for name in ("cc", "gcc", "clang") if shutil.which(name)), "cc")
    words = [compiler, "-std=c99", "-O2", "-ffp-contract=off", f"-I{header}", "-o", str(program), str(source), "-lm"]
    subprocess.run(words, check=True, capture_output=True)
    one, other = folder / "a.jsonl", folder / "b.jsonl"

    def made(path: Path, nudge: int) -> None:
        plain = folder / "steps.jsonl"
        subprocess.run([str(program), str(events), str(nudge), str(plain)], check=True)
        with plain.open(encoding="utf-8") as lines, path.open("w", encoding="utf-8") as out:
            for line in lines:  # events have times, no steps
                out.write("{" + line.partition(", ")[2] if line.startswith('{"step"') else line)
        plain.unlink()

    made(one, -1)
    made(other, -1)
    yield "nothing", one, other
    made(other, events // 2)
    yield "one ulp, half way", one, other
    reorder(one, other)
    yield "independent events in another order", one, other
    made(other, -2)
    yield "one ulp in each number", one, other
    third = folder / "c.jsonl"
    reorder(other, third)
    yield "one ulp in each number, and another order", one, third


def reorder(source: Path, into: Path) -> None:
    """Writes a log whose independent neighbours have changed places."""
    with source.open(encoding="utf-8") as lines, into.open("w", encoding="utf-8") as out:
        for line in interleaved(lines):
            out.write(line)


def interleaved(lines: Iterator[str]) -> Iterator[str]:
    """Neighbouring events that share no body change places.

    >>> told = ['{"log": 1}', *('{"contacts": [["%s", "%s"]]}' % tuple(p) for p in ("ab", "cd", "de"))]
    >>> [line[15:-3] for line in interleaved(iter(told))][1:]
    ['"c", "d"', '"a", "b"', '"d", "e"']
    """
    waiting: tuple[str, set[str]] | None = None
    for line in lines:
        bodies = {body for pair in json.loads(line).get("contacts", ()) for body in pair}
        if waiting is None:
            if bodies:
                waiting = line, bodies
            else:
                yield line
        elif waiting[1] & bodies:
            yield waiting[0]
            waiting = line, bodies
        else:
            yield line
            yield waiting[0]
            waiting = None
    if waiting is not None:
        yield waiting[0]


def compared(events: int) -> Iterator[str]:
    """Rows of a table: seconds of the processor, and the peak of memory, each pair in its own process."""
    yield f"| what came between {events:,} events | first line | processor, s | memory, MB |"
    yield "|---|---|---|---|"
    program = (
        "import resource, sys; from truebreak.compare.logdiff.desync import diff;"
        "print(diff(*sys.argv[1:]).verdict.line);"
        "u = resource.getrusage(resource.RUSAGE_SELF); print(u.ru_utime + u.ru_stime, u.ru_maxrss / 1024)"
    )
    with tempfile.TemporaryDirectory() as folder:
        for what, one, other in logs(Path(folder), events):
            words = [sys.executable, "-c", program, str(one), str(other)]
            told = subprocess.run(words, check=True, capture_output=True, text=True).stdout.splitlines()
            spent, memory = map(float, told[1].split())
            yield f"| {what} | {told[0]} | {spent:.0f} | {memory:.0f} |"


def pile(count: int = BODIES) -> Any:
    """A pymunk space of discs that lie in a box."""
    import pymunk

    space, rng = pymunk.Space(), random.Random(1)
    space.gravity = (0, -900)
    for a, b in (((0, 0), (300, 0)), ((0, 0), (0, 900)), ((300, 0), (300, 900))):
        wall = pymunk.Segment(space.static_body, a, b, 3)
        wall.friction = 0.6
        space.add(wall)
    for k in range(count):
        body = pymunk.Body(1, pymunk.moment_for_circle(1, 0, 12))
        body.position = 20 + 26 * (k % 10) + rng.random(), 20 + 26 * (k // 10)
        disc = pymunk.Circle(body, 12)
        disc.friction = 0.6
        space.add(body, disc)
    return space


def recorded(every: int, blocks: int = BLOCKS, steps: int = STEPS) -> list[float]:
    """What recording costs, in percent of stepping: blocks of steps, each recorded between two that are not."""
    space, costs = pile(), []

    def stepped() -> float:
        begun = process_time()
        for _ in range(steps):
            space.step(1 / 60)
        return process_time() - begun

    stepped()
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(blocks):
            before = stepped()
            with record(space, Path(folder) / "run.jsonl", every=every):
                spent = stepped()
            costs.append(100 * (2 * spent / (before + stepped()) - 1))
    return sorted(costs)


def record_table() -> Iterator[str]:
    """Rows of a table of what recording costs."""
    yield f"| `every` | median of {BLOCKS} blocks | middle half of them |"
    yield "|---|---|---|"
    for every in (64, 1):
        costs = recorded(every)
        low, _, high = statistics.quantiles(costs, n=4)
        yield f"| {every} | {statistics.median(costs):.0f} % | {math.floor(low)} to {math.ceil(high)} % |"


def main(arguments: Sequence[str] | None = None) -> int:
    """Measures and prints; the exit status."""
    parser = argparse.ArgumentParser(prog="python docs/studies/desync_costs.py", description=__doc__)
    parser.add_argument("--events", type=int, default=EVENTS, metavar="N", help=f"events of each log ({EVENTS:,})")
    parser.add_argument("--record", action="store_true", help="measure truebreak.pymunk.record instead")
    options = parser.parse_args(arguments)
    if options.events < 10:
        parser.error(f"--events {options.events}: must be at least 10")
    for line in record_table() if options.record else compared(options.events):
        print(line, flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
