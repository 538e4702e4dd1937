"""`python -m truebreak.exact.laws`: derives the laws and their tangent map, proves their forms, writes them."""

from __future__ import annotations

import argparse
import sys

from . import tangent
from .derivation import LawError
from .verification import FORMULAS, derive_and_prove, functions, is_current, write


def main(arguments: list[str] | None = None) -> int:
    """Derive, prove, and write or check `formulas.py` and `tangent_formulas.py`; the exit status."""
    parser = argparse.ArgumentParser(
        prog="python -m truebreak.exact.laws",
        description="Derive the laws of motion and collision with SymPy, show them, prove that the stable "
        "forms are equal to them, and write these to formulas.py; the same for how displacements go through a "
        "collision, in tangent_formulas.py. Takes some ten seconds. "
        "The laws go to standard output, the progress to standard error.",
        epilog="To change a formula: edit its stable form in exact/laws/stable_forms.py, then run this again. "
        "To change the physics: edit a statement in exact/laws/derivation.py; the proofs then fail until the "
        "stable forms agree. Exit status: 0 done, 1 not current (--check) or not proved.",
    )
    check = "write nothing; exit with 1 if a file is not current"
    parser.add_argument("--check", action="store_true", help=check)
    options = parser.parse_args(arguments)

    try:
        texts = {FORMULAS: derive_and_prove(sys.stdout, sys.stderr), tangent.FORMULAS: tangent.text()}
        written = functions(texts[tangent.FORMULAS], tangent.FORMS)
        tangent.prove(written, functions(texts[FORMULAS])["wall_bounce"])
    except (LawError, ValueError) as error:
        print(f"not proved: {error}", file=sys.stderr)
        return 1
    if options.check:
        stale = [path.name for path, text in texts.items() if not is_current(text, path)]
        for path in texts:
            verdict = "not current: run without --check" if path.name in stale else "current"
            print(f"{path.name} is {verdict}", file=sys.stderr)
        return 1 if stale else 0
    for path, text in texts.items():
        print(f"wrote {write(text, path)}", file=sys.stderr)
    return 0


if __name__ == "__main__":
    sys.exit(main())
