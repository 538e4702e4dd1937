"""`python -m truebreak.exact.laws`: derives the laws, proves the stable forms, and writes `formulas.py`."""

from __future__ import annotations

import argparse
import sys

from .derivation import LawError
from .verification import derive_and_prove, is_current, write


def main(arguments: list[str] | None = None) -> int:
    """Derive, prove, and write or check `formulas.py`; the exit status."""
    parser = argparse.ArgumentParser(
        prog="python -m truebreak.exact.laws",
        description="Derive the laws of motion and collision with SymPy, show them, prove that the stable "
        "forms are equal to them, and write these to formulas.py. Takes some ten seconds. "
        "The laws go to standard output, the progress to standard error.",
        epilog="To change a formula: edit its stable form in exact/laws/stable_forms.py, then run this again. "
        "To change the physics: edit a statement in exact/laws/derivation.py; the proofs then fail until the "
        "stable forms agree. Exit status: 0 done, 1 not current (--check) or not proved.",
    )
    check = "write nothing; exit with 1 if formulas.py is not current"
    parser.add_argument("--check", action="store_true", help=check)
    options = parser.parse_args(arguments)

    try:
        text = derive_and_prove(sys.stdout, sys.stderr)
    except (LawError, ValueError) as error:
        print(f"not proved: {error}", file=sys.stderr)
        return 1
    if options.check:
        current = is_current(text)
        verdict = "current" if current else "not current: run without --check"
        print(f"formulas.py is {verdict}", file=sys.stderr)
        return 0 if current else 1
    print(f"wrote {write(text)}", file=sys.stderr)
    return 0


if __name__ == "__main__":
    sys.exit(main())
