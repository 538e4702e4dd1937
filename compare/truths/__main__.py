"""`python -m truebreak.compare.truths`: measures the published numbers, and writes docs/truths.md."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from .exactly import EXACT, siam
from .statistically import STATISTICAL
from .truth import NotReproduced, Truth

HEAD = """# Published truths, reproduced

Numbers that others have published, and some that this project has measured before, with what comes out now. Every run
that a number is read off is certified; where doubles are judged, it is against such a run. Made by

```sh
python -m truebreak.compare.truths docs/truths.md
```

which measures all of them and stops at the first that does not come out. "Recalled" marks a source not at hand.

| what | published | ours | difference | source | to see it |
|---|---|---|---|---|---|
"""

TAIL = """
## Beyond what is published

The SIAM photon to 150 digits at t = 10, ours beyond the first 79:

```text
{digits}
```

## Slow convergence

- The mean path between two hits of a disc has a heavy tail: a point that flies in a corridor between the copies of the
  disc meets none for long. 100 runs to time 120 came to 2.095, 4 percent too low; the 12 runs to time 1,000 above, with
  hardly more hits, to what is shown.
- Two discs in a box may pass each other for long too: over 400 runs to time 100 the rate was 0.4759 (standard error
  0.0037), over 20 runs to time 1,000 it was 0.4922 (0.0056), on either side of the closed form.
- Dahlqvist's formula is the beginning of an expansion in R: the difference falls with R, and is not one of the
  measurement.

## What cannot be reproduced here

- Periodic boundaries: there is no torus. Where a lattice has mirror lines, walls fold it exactly (`hexagon`).
- The stadium and other curved walls: walls are straight lines.
- The escape rate of three discs to its 31 digits needs the periodic orbits of longer words; here only the first order
  of the cycle expansion is taken, from the two multipliers above.
- Orban and Bellemans' own numbers, and Colonna's 192 and 336 particles: their starts are not at hand. That H returns in
  a certified run and not in floats is shown by a gas of our own: see [statistics](statistics.md).
- Five free discs, and the numbers of Cross's experiment: no source was at hand; `cross` is the scene alone.
"""


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
    rows = "\n".join(line(truth) for truth in (*EXACT, *STATISTICAL))
    return HEAD + rows + "\n" + TAIL.format(digits=siam(10, 150))


def main(arguments: list[str] | None = None) -> int:
    """Measures and writes, or checks; the exit status."""
    parser = argparse.ArgumentParser(prog="python -m truebreak.compare.truths", description=__doc__)
    parser.add_argument("file", help="where to write the page, such as docs/truths.md")
    parser.add_argument("--check", action="store_true", help="write nothing; exit with 1 if the file is not current")
    options = parser.parse_args(arguments)
    try:
        text = page()
    except NotReproduced as error:
        print(f"not reproduced: {error}", file=sys.stderr)
        return 1
    if options.check:
        return 0 if Path(options.file).read_text(encoding="utf-8") == text else 1
    Path(options.file).write_text(text, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
