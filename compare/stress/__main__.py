"""`python -m truebreak.compare.stress`: makes the full map, and writes it into docs/stress.md and docs/stress.svg."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from ...scenarios.errors import SceneError
from ..cli.commands.stress import how_far
from ..report.pictures.heat_map import heat_map
from ..writing import check_writable, write_whole
from .ladder import ladders
from .page import map_part, rewritten
from .plan import carry_out, plan
from .store import Store

TITLE = "Where each engine's answer turns wrong"


def main(arguments: list[str] | None = None) -> int:
    """Makes the map and writes it; the exit status."""
    parser = argparse.ArgumentParser(prog="python -m truebreak.compare.stress", description=__doc__)
    parser.add_argument("file", help="the page, such as docs/stress.md; the picture is written beside it")
    parser.add_argument("--store", help="keep the rows in this file, and resume from it")
    options = parser.parse_args(arguments)
    asked = plan()
    try:
        page = Path(options.file).read_text(encoding="utf-8")
        rewritten(page, "")
        check_writable(options.file)
        store = Store(options.store, asked.settings, list(asked.places()))
        carry_out(asked, store, progress=lambda done: print(how_far(done), file=sys.stderr))
    except (SceneError, OSError) as error:
        print(f"truebreak: error: {error}", file=sys.stderr)
        return 2
    told = ladders(store.rows, asked.engines)
    write_whole(Path(options.file).with_suffix(".svg"), heat_map(asked.families, told, TITLE))
    write_whole(options.file, rewritten(page, map_part(asked, told)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
