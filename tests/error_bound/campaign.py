"""The long run behind `bound.py`."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator, Sequence

from error_bound.scenes import CATALOGUE, KINDS, scene_of
from error_bound.watch import Tally, watched

EVENTS = 100
"""Of each scene."""

LATER = (150, 128)
"""Bits from which on there are sets, and of the state at first: a set from the start, of about as many bits as it
takes."""

PILOT = (100, 98)
"""The same, with so few bits that the first set is a pilot, of a tenth of the bits that the run needs."""


def tallies(kinds: Sequence[str], checks: int) -> Iterator[tuple[str, Tally]]:
    """The catalogue's scenes, then rooms of each kind in turn, until sets have held so many numbers.

    Args:
        kinds: of rooms; the catalogue's are left out where these are not all.
        checks: how many numbers that a set held.
    """
    done, seed = 0, 0
    while done < checks:
        names = [f"{kind} {seed}" for kind in kinds]
        if seed == 0 and len(kinds) == len(KINDS):
            names = [*CATALOGUE, *names]
        for name in names:
            for place, (long_bits, first_bits) in enumerate((LATER, PILOT)):
                scene = scene_of(name)
                _, tally = watched(
                    scene, EVENTS, long_bits=long_bits, first_bits=first_bits, matrices=place == seed % 2
                )
                done += tally.in_set
                yield name, tally
        seed += 1


def told(all_: Tally) -> str:
    """The figures, as a person reads them."""
    count = len(all_.first)
    lines = [
        f"{all_.checks:,} numbers of circles and {all_.instants:,} instants against 4,096 bits: "
        f"{'every one inside its bound' if not all_.faults else 'FAULTS'}",
        f"{all_.in_set:,} of them of circles in {all_.sets:,} sets, with {all_.blocks:,} blocks "
        f"and {all_.at_once:,} contacts in one go",
        f"worst: a midpoint was off by {all_.worst:.4f} of its bound",
        f"{all_.bounds:,} bounds against the same sets in plain matrices: "
        f"the largest hull was 1 - {1.0 - all_.tightest:.1e} of its bound",
    ]
    if count:
        later = sum(all_.more) / max(1, len(all_.more))
        lines += [
            f"after a first block its box is {sum(all_.first) / count:.1f} bits too large, in the mean, along the edge",
            f"where it is least so; each of {len(all_.more):,} later blocks adds {later:.2f}",
        ]
    return "\n".join(lines)


def main(arguments: Sequence[str] | None = None) -> int:
    """The command; 1 if a bound did not hold."""
    parser = argparse.ArgumentParser(prog="bound.py", description=__doc__)
    parser.add_argument(
        "--checks", type=int, default=100_000, help="numbers of circles in sets to be checked, at least"
    )
    parser.add_argument("--kinds", help=f"comma-separated, of {', '.join(KINDS)}; all if left out")
    options = parser.parse_args(arguments)
    kinds = options.kinds.split(",") if options.kinds else list(KINDS)
    if unknown := [kind for kind in kinds if kind not in KINDS]:
        parser.error(f"there is no kind {unknown[0]}; there are {', '.join(KINDS)}")
    total = Tally()
    for name, tally in tallies(kinds, options.checks):
        total += tally
        for fault in tally.faults:
            print(f"{name}: {fault}", flush=True)
        print(f"\r{total.in_set:,} of {options.checks:,} checks, {name}    ", end="", file=sys.stderr, flush=True)
    print(file=sys.stderr)
    print(told(total))
    return 1 if total.faults else 0
