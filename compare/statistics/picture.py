"""H of a gas that is turned back, in several engines, as one SVG.

`python -m truebreak.compare.statistics.picture FILE` draws it.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING

from ...scenarios import catalogue
from ..engines import engine as engine_named
from ..report.curves import Curve, plot
from ..report.pictures.sweep_plots import standalone
from ..writing import write_whole
from .boltzmann import h_curve, h_returned

if TYPE_CHECKING:
    from ...scenarios.scene import Scene

SCENE = "echo:after=1200"

ENGINES = ("exact", "double", "single")

POINTS = 241
"""Points of a curve, an odd number: one of them stands at the moment of the reversal."""


def picture(scene: Scene, engines: Sequence[str] = ENGINES) -> tuple[str, dict[str, float]]:
    """The SVG, and for each engine by how much H at the return is above or below H at the start.

    >>> text, told = picture(catalogue.build("echo:rows=2,after=5"), ["exact"])
    >>> text.startswith("<svg"), told
    (True, {'exact': 0.0})
    """
    curves: list[Curve] = []
    told: dict[str, float] = {}
    for number, name in enumerate(engines):
        run = engine_named(name).run(scene)
        curves.append(Curve(name, h_curve(run, POINTS), f"e{number - 1}" if number else "reference"))
        told[name] = h_returned(run)
    drawn = plot(f"Boltzmann's H of {scene.name}, turned back once", "time", "H", curves)
    return standalone(drawn, len(curves) - 1), told


def main(arguments: list[str] | None = None) -> int:
    """Draws, writes, and prints what has returned; the exit status."""
    parser = argparse.ArgumentParser(prog="python -m truebreak.compare.statistics.picture", description=__doc__)
    parser.add_argument("file", help="where to write the picture, such as docs/echo.svg")
    parser.add_argument("--scene", default=SCENE, help=f"the scene ({SCENE})")
    options = parser.parse_args(arguments)
    text, told = picture(catalogue.build(options.scene))
    write_whole(options.file, text)
    for name, value in told.items():
        print(f"{name}: H at the return less H at the start: {value:+.4f}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
