"""Flights under gravity as the exact engine has them: `python docs/studies/parabolas.py FILE.svg`."""

from __future__ import annotations

import argparse
from pathlib import Path

from truebreak.compare.writing import write_whole
from truebreak.exact import ExactEngine
from truebreak.scenarios import catalogue

SCENES = ("bounce:e=9/10", "wedge:vx=1/5")
SPANS = (9.0, 40.0)
"""How long each scene is drawn."""

SIZE, ROOM, POINTS = 320.0, 20.0, 1500


def panel(spec: str, span: float, left: float, across: bool) -> list[str]:
    """One scene: the way of its disc, over time where it falls straight down (`across`), else in the plane."""
    scene = catalogue.build(spec)
    run = ExactEngine().run(scene, until=str(span))
    times = [span * k / POINTS for k in range(POINTS)]
    rows = run.sample(times)[:, 0]
    places = [(t if across else float(x), float(y)) for t, (x, y, _, _) in zip(times, rows, strict=True)]
    xs, ys = [x for x, _ in places], [y for _, y in places]
    scale = (SIZE - 2 * ROOM) / max(max(xs) - min(xs), 1e-9), (SIZE - 2 * ROOM) / max(ys)
    points = " ".join(
        f"{left + ROOM + (x - min(xs)) * scale[0]:.1f},{SIZE - ROOM - y * scale[1]:.1f}" for x, y in places
    )
    return [
        f'<polyline points="{points}" fill="none" stroke="#2563eb"/>',
        f'<text x="{left + ROOM}" y="14" font-size="12" font-family="sans-serif">{spec}, to t = {span:g}</text>',
    ]


def picture() -> str:
    """Both panels as an SVG."""
    parts = [
        part
        for k, (spec, span) in enumerate(zip(SCENES, SPANS, strict=True))
        for part in panel(spec, span, k * SIZE, k == 0)
    ]
    head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {2 * SIZE:g} {SIZE:g}" width="{2 * SIZE:g}">'
    made = "<!-- made by: python docs/studies/parabolas.py docs/gravity.svg -->"
    return "\n".join([head, made, *parts, "</svg>"]) + "\n"


def main() -> None:
    """The command line."""
    parser = argparse.ArgumentParser(
        prog="python docs/studies/parabolas.py", description="Draw flights under gravity as the exact engine has them."
    )
    parser.add_argument("file", metavar="FILE.svg", type=Path)
    write_whole(str(parser.parse_args().file), picture())


if __name__ == "__main__":
    main()
