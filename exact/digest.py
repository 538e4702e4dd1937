"""One digest of the histories of the catalogue, by which machines, versions and ways to run are compared.

`python -m truebreak.exact.digest` prints it; with `--each` it prints that of every scene too. It is the same with and
without compiled parts, whatever the hash seed, SymPy's numbers and the version of Python. The exact engine asks nothing
of SymPy while it runs; with `--sympy` it is the SymPy engine whose histories are taken, of scenes that it can follow.

`python tests/same_bytes.py FOLDER` runs it in all the ways that a machine has, WebAssembly among them.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator, Sequence
from hashlib import sha256

from ..scenarios import catalogue
from ..scenarios.engine import Engine
from ..scenarios.numbers.quantity import Real
from ..scenarios.trajectory import Trajectory
from .exact_engine import ExactEngine

EVENTS = 120
"""Instants of each scene: all kinds of proof that the catalogue has come up by then."""

LITERAL = ("lee", "cross", "pinball", "three-disc")
"""Scenes that the SymPy engine follows in some seconds, with square roots, a tie and a wall, in so many instants:"""

LITERAL_EVENTS = 3

DIGITS = 30
"""Of each number: more than doubles have, so that an enclosure of another kind would show."""


def history_lines(run: Trajectory) -> Iterator[str]:
    """What happened in a run of the exact engine, line by line: no counts of how it was decided, which may differ.

    >>> run = ExactEngine().run(catalogue.build("lee"), events=1)
    >>> next(history_lines(run))
    '0 1 left+middle middle+right; left+middle middle+right; RATIONAL'
    """
    for event in run.events:
        links = (" ".join(f"{a}+{b}" for a, b in part) for part in (event.contacts, event.impulses))
        ties = " ".join(tie.proof.name for tie in event.ties)
        yield f"{event.index} {_digits(event.time)} {'; '.join(links)}; {ties}".rstrip("; ")
    for entry in run.pocketings:
        yield f"{entry.circle} in {entry.pocket} at {_digits(entry.time)}"
    if run.reversal is not None:
        yield f"reversal after {run.reversal.after} at {_digits(run.reversal.time)}"
    yield f"{run.stop.reason.name}: {run.stop.message}"
    for circle in run.final.circles:
        yield " ".join([circle.id, *(_digits(number) for number in (circle.x, circle.y, circle.vx, circle.vy))])


def _digits(number: Real) -> str:
    return number.digits(DIGITS)


def scene_digest(spec: str, events: int = EVENTS, engine: Engine | None = None) -> tuple[int, str]:
    """How many events a scene has by then, and SHA-256 of its history, in the exact engine if no other is given."""
    scene = catalogue.build(spec)
    run = (engine or ExactEngine()).run(scene, until=scene.until, events=min(events, scene.events or events))
    return len(run.events), sha256("\n".join(history_lines(run)).encode()).hexdigest()


def main(arguments: Sequence[str] | None = None) -> int:
    """The command line."""
    parser = argparse.ArgumentParser(
        prog="python -m truebreak.exact.digest", description=(__doc__ or "").partition("\n")[0]
    )
    parser.add_argument("scenes", nargs="*", help="of these scenes; by default of all of the catalogue")
    parser.add_argument("--each", action="store_true", help="print the digest of every scene too")
    parser.add_argument("--sympy", action="store_true", help="by the SymPy engine, by default of a few scenes")
    options = parser.parse_args(arguments)
    specs, events, engine = options.scenes or catalogue.names(), EVENTS, None
    if options.sympy:
        from .literal.symbolic_engine import SymbolicEngine

        specs, events, engine = options.scenes or LITERAL, LITERAL_EVENTS, SymbolicEngine()
    whole, total = sha256(), 0
    for spec in specs:
        count, told = scene_digest(spec, events, engine)
        total += count
        whole.update(f"{spec} {told}\n".encode())
        if options.each:
            sys.stdout.write(f"{told}  {spec}: {count} events\n")
    sys.stdout.write(f"{whole.hexdigest()}  {len(specs)} scenes, {total:,} events\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
