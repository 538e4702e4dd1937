"""How engines are told apart: one colour and one dash for each, the same in every figure, for any number of them."""

from __future__ import annotations

from itertools import count, islice
from typing import NamedTuple

FIRST_HUE, GOLDEN_ANGLE = 22.0, 137.508
"""The first engine is orange; each further one is turned by the golden angle, which keeps hues apart for any number."""

REFERENCE_HUE, APART = 211.0, 24.0
"""The reference's blue, and how far from it the hue of an engine stays, in degrees."""

DASHES = ("7 4", "2 3", "11 3 2 3", "5 2", "12 5", "2 2 6 2", "9 3 2 3 2 3")
"""Dashes of the engines compared. A solid line is the reference's alone."""


class EngineStyle(NamedTuple):
    """The look of one engine.

    Attributes:
        light, dark: colours as CSS, on a light and on a dark page.
        dash: lengths of dashes and gaps in pixels, as SVG has them.
    """

    light: str
    dark: str
    dash: str


def engine_style(number: int) -> EngineStyle:
    """The style of the engine compared at a place, from 0.

    >>> engine_style(0)
    EngineStyle(light='hsl(22 72% 36%)', dark='hsl(22 80% 68%)', dash='7 4')
    >>> len({engine_style(k)[:2] for k in range(100)})
    100
    """
    hues = ((FIRST_HUE + GOLDEN_ANGLE * turn) % 360 for turn in count())
    apart = (hue for hue in hues if abs(hue - REFERENCE_HUE) >= APART)
    hue = f"{next(islice(apart, number, None)):.4g}"
    return EngineStyle(f"hsl({hue} 72% 36%)", f"hsl({hue} 80% 68%)", DASHES[number % len(DASHES)])


def engine_css(count: int) -> str:
    """Style sheet for engines: the class `eK` sets `--engine` and `--dash`."""
    styles = [engine_style(number) for number in range(count)]
    light = "".join(f".e{k} {{ --engine: {s.light}; --dash: {s.dash}; }}\n" for k, s in enumerate(styles))
    dark = "".join(f"  .e{k} {{ --engine: {s.dark}; }}\n" for k, s in enumerate(styles))
    return f"{light}@media screen and (prefers-color-scheme: dark) {{\n{dark}}}\n"
