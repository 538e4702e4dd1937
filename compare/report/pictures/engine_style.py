"""How engines are told apart: one colour and one dash for each, the same in every figure, for any number of them."""

from __future__ import annotations

from typing import NamedTuple

REFERENCE_HUE, APART = 211.0, 24.0
"""The reference's blue, and how far from it the hue of an engine stays, in degrees."""

REFERENCE = "#2b6cb0"
"""The reference on a light page."""

FIRST, TURN = 0.471, 0.367
"""The first engine is orange, as a share of the hues that are left; each further one is turned by another such share.
This turn keeps apart what has the same dash: by 49 units of CIELAB among 12 engines, by 31 among 24."""

DASHES = ("7 4", "2 3", "11 3 2 3", "18 5", "11 3 2 3 2 3", "5 2 5 7")
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
    EngineStyle(light='hsl(21.95 72% 36%)', dark='hsl(21.95 80% 68%)', dash='7 4')
    >>> len({engine_style(k)[:2] for k in range(100)})
    100
    """
    share = (FIRST + TURN * number) % 1
    hue = f"{(REFERENCE_HUE + APART + (360 - 2 * APART) * share) % 360:.4g}"
    return EngineStyle(f"hsl({hue} 72% 36%)", f"hsl({hue} 80% 68%)", DASHES[number % len(DASHES)])


def engine_css(count: int) -> str:
    """Style sheet for engines: the class `eK` sets `--engine` and `--dash`."""
    styles = [engine_style(number) for number in range(count)]
    light = "".join(f".e{k} {{ --engine: {s.light}; --dash: {s.dash}; }}\n" for k, s in enumerate(styles))
    dark = "".join(f"  .e{k} {{ --engine: {s.dark}; }}\n" for k, s in enumerate(styles))
    return f"{light}@media screen and (prefers-color-scheme: dark) {{\n{dark}}}\n"


def plain_css(count: int) -> str:
    """The same for a picture that is a file of its own, on white: without variables, which few other programs read.

    >>> print(plain_css(1), end="")
    .e0 { stroke: hsl(21.95 72% 36%); stroke-dasharray: 7 4; } .dot.e0 { fill: hsl(21.95 72% 36%); stroke: none; }
    """
    styles = [engine_style(number) for number in range(count)]
    return "".join(
        f".e{k} {{ stroke: {s.light}; stroke-dasharray: {s.dash}; }} .dot.e{k} {{ fill: {s.light}; stroke: none; }}\n"
        for k, s in enumerate(styles)
    )
