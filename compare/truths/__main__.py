"""`python -m truebreak.compare.truths`: measures the published numbers, and writes docs/truths.md."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path

from ...scenarios.errors import SceneError
from ...scenarios.numbers.quantity import Quantity
from ..repeller.__main__ import table as repeller
from ..writing import check_writable, write_whole
from .convergence import table as convergence
from .exactly import EXACT, LETTERS, siam
from .statistically import STATISTICAL
from .truth import NotReproduced, Truth

HEAD = """# Published truths, reproduced

Numbers that others have published, and some that this project has measured before, with what comes out now. Every run
that a number is read off is certified; where doubles are judged, it is against such a run. Made by

```sh
python -m truebreak.compare.truths docs/truths.md
```

which measures all of them, and writes nothing if one does not come out. With `--only WORDS` in place of the file it
prints those in whose title the words are. "Recalled" marks a source not at hand. Ensembles are of
`point:size=1,disc=R`, `two-in-a-box` and `hexagon:d=D`, each from many starts.

"""

COLUMNS = "| what | published | ours | difference | source | to see it |\n|---|---|---|---|---|---|"

TAIL = """
A difference in brackets is in standard errors: that of ours, and that of what was measured before, together.

ChaosBook's figure is quoted from memory: it was looked for in what public text is at hand, twice, and not seen in print
(of Gaspard and Rice, of P. Gaspard and D. Alonso Ramirez, Phys. Rev. A 45 (1992), 8383, and of A. Wirzba,
chao-dyn/9712015, there are the abstracts, without a figure). Ours does not rest on it: the expansion below gives all
of its digits, and six more.

## Three discs

The repeller of the pinball, the starts that never escape, is told by its periodic orbits. Each of them is proved to
exist, by an interval Newton step, and its multiplier is read off the tangent map of the laws, in balls. What is summed
up over the orbits is an expansion: the digits that the next order does not change are its answer, and no proof.
`python -m truebreak.compare.repeller` prints

{repeller}

## Beyond what is published

The SIAM photon to 150 digits at t = 10, ours beyond the first 79:

```text
{digits}
```

## Slow convergence

The same runs, cut off at ever later times (`python -m truebreak.compare.truths.convergence`), each estimate with its
standard error:

{convergence}

- A point that flies in a corridor between the copies of the disc meets none for long, and two discs in a box may pass
  each other for long: these times have a heavy tail.
- Dahlqvist's formula is the beginning of an expansion in R: the difference that stays falls with R, and is not one of
  the measurement.

## What cannot be reproduced here

- Periodic boundaries: there is no torus. Where a lattice has mirror lines, walls fold it exactly (`hexagon`).
- The stadium and other curved walls: walls are straight lines.
- Orban and Bellemans' own numbers, and Colonna's 192 and 336 particles: their starts are not at hand. That H returns in
  a certified run and not in floats is shown by a gas of our own: see [statistics](statistics.md).
- Five free discs: no published number was at hand; `free-discs:n=5` collides 15 times, a witness of our own.
- The numbers of Cross's experiment: no source was at hand; `cross` is the scene alone.
"""

PARTS: Mapping[str, Callable[[], str]] = {
    "digits": lambda: siam(10, 150),
    "repeller": lambda: repeller(Quantity.of(6), LETTERS),
    "convergence": convergence,
}
"""What the page has below its first table, each measured by itself."""


def line(truth: Truth) -> str:
    """A row of the table: the truth measured.

    Raises:
        NotReproduced: naming the truth.
    """
    try:
        ours, difference = truth.measure()
    except NotReproduced as error:
        raise NotReproduced(f"{truth.title}: {error}") from None
    return f"| {truth.title} | {truth.published} | {ours} | {difference} | {truth.source} | `{truth.command}` |"


def page() -> str:
    """The whole of docs/truths.md."""
    return put_together(lines((*EXACT, *STATISTICAL)), {name: part() for name, part in PARTS.items()})


def put_together(rows: Iterable[str], parts: Mapping[str, str]) -> str:
    """The page of the rows of its first table, and of the parts below it, by name."""
    table = "\n".join(rows)
    return f"{HEAD}{COLUMNS}\n{table}\n{TAIL.format(**parts)}"


def lines(truths: Sequence[Truth]) -> Iterator[str]:
    """The rows of truths, one after the other; a terminal is told which is being measured."""
    for done, truth in enumerate(truths):
        if sys.stderr.isatty():
            print(f"{done} of {len(truths)} done; {truth.title}", file=sys.stderr)
        yield line(truth)


def main(arguments: list[str] | None = None) -> int:
    """Measures and writes, or checks; the exit status."""
    parser = argparse.ArgumentParser(prog="python -m truebreak.compare.truths", description=__doc__)
    parser.add_argument("file", nargs="?", help="where to write the page, such as docs/truths.md")
    parser.add_argument("--only", metavar="WORDS", help="print the truths with these words in the title, and no page")
    parser.add_argument("--check", action="store_true", help="write nothing; exit with 1 if the file is not current")
    options = parser.parse_args(arguments)
    if (options.only is None) == (options.file is None):
        parser.error("give a file to write, or --only WORDS")
    try:
        if options.only is not None:
            return _print(options.only)
        if not options.check:
            check_writable(options.file)
        text = page()
    except NotReproduced as error:
        print(f"not reproduced: {error}", file=sys.stderr)
        return 1
    except SceneError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    if options.check:
        return 0 if Path(options.file).read_text(encoding="utf-8") == text else 1
    write_whole(options.file, text)
    return 0


def _print(words: str) -> int:
    chosen = [truth for truth in (*EXACT, *STATISTICAL) if words.casefold() in truth.title.casefold()]
    if not chosen:
        print(f"error: --only {words!r}: is in no title; docs/truths.md has them", file=sys.stderr)
        return 2
    print(COLUMNS)
    for row in lines(chosen):
        print(row, flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
