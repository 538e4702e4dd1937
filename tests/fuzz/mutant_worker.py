"""Examines cases, one a line, with the packages of one copy: `python -m fuzz.mutant_worker COPY`."""

from __future__ import annotations

import json
import sys
from dataclasses import asdict
from pathlib import Path

WORK = 150_000
"""Work for a question: with all that a run may have, it takes a minute to give up a proof that a fault spoils."""


def main() -> int:
    """Reads "kind seed" lines, and writes a verdict on each."""
    copy = Path(sys.argv[1]).resolve()
    sys.path.insert(0, str(copy.parent))
    import truebreak.compare  # every package must come from the copy, none from the checkout
    import truebreak.exact
    import truebreak.floating
    import truebreak.scenarios

    for package in (truebreak.compare, truebreak.exact, truebreak.floating, truebreak.scenarios):
        if not Path(str(package.__file__)).resolve().is_relative_to(copy):
            raise SystemExit(f"{package.__file__} is not in {copy}")
    from fuzz.examine import examine

    print(json.dumps("ready"), flush=True)
    for line in sys.stdin:
        kind, seed = line.split()
        print(json.dumps(asdict(examine(kind, int(seed), work=WORK))), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
