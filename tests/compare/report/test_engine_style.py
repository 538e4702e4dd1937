"""Engines are told apart by colour and dash, whatever their number."""

from __future__ import annotations

import colorsys
import math
import re
from collections.abc import Sequence
from itertools import combinations

import pytest
from pages import comparison, page

from truebreak.compare.picture import OWN, REFERENCE, engine_css, engine_style, engine_styles

SEEN = {
    "all cones": ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)),
    "protanope": ((0.152286, 1.052583, -0.204868), (0.114503, 0.786281, 0.099216), (-0.003882, -0.048116, 1.051998)),
    "deuteranope": ((0.367322, 0.860646, -0.227968), (0.280085, 0.672501, 0.047413), (-0.01182, 0.04294, 0.968881)),
    "tritanope": ((1.255528, -0.076749, -0.178779), (-0.078411, 0.930809, 0.147602), (0.004733, 0.691367, 0.3039)),
}
"""What is left of a colour in linear light, of full severity: Machado, Oliveira and Fernandes, 2009."""


def times(matrix: Sequence[Sequence[float]], vector: Sequence[float]) -> list[float]:
    return [sum(a * b for a, b in zip(row, vector, strict=True)) for row in matrix]


def lab(colour: str, eyes: str = "all cones") -> tuple[float, float, float]:
    """A colour of CSS in CIELAB, in which distances are differences that are seen."""
    if colour.startswith("#"):
        channels = [int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)]
    else:
        hue, saturation, lightness = map(float, re.findall(r"[\d.]+", colour))
        channels = list(colorsys.hls_to_rgb(hue / 360, lightness / 100, saturation / 100))
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in channels]
    told = [min(max(c, 0.0), 1.0) for c in times(SEEN[eyes], linear)]
    white = (0.95047, 1.0, 1.08883)
    rows = ((0.4124, 0.3576, 0.1805), (0.2126, 0.7152, 0.0722), (0.0193, 0.1192, 0.9505))
    shares = [value / w for value, w in zip(times(rows, told), white, strict=True)]
    x, y, z = (s ** (1 / 3) if s > 0.008856 else 7.787 * s + 16 / 116 for s in shares)
    return 116 * y - 16, 500 * (x - y), 200 * (y - z)


@pytest.mark.parametrize("eyes", SEEN)
@pytest.mark.parametrize(("scheme", "reference"), [("light", REFERENCE), ("dark", "#63b3ed")])
def test_engines_with_a_colour_of_their_own_differ_for_all_eyes(eyes: str, scheme: str, reference: str) -> None:
    colours = [reference, *(getattr(engine_style(k), scheme) for k in range(len(OWN)))]
    for one, two in combinations(colours, 2):
        assert math.dist(lab(one, eyes), lab(two, eyes)) >= 30, (one, two)


def test_an_engine_has_the_same_style_on_every_page() -> None:
    assert engine_styles(["pymunk:dt=1/64", "double", "quad"])[1:] == [engine_style(0), engine_style(4)]
    (line,) = re.findall(r"^\.e1 \{ --engine: (.*?);", engine_css(["mine", "double"]), re.MULTILINE)
    assert line == OWN["double"][0]
    styles = engine_styles(["double", "double:x=1", "other", "another", "pymunk", "pymunk:dt=1/2"])
    assert len(set(styles)) == len(styles)


@pytest.mark.parametrize(("count", "alike", "other"), [(6, math.inf, 30), (12, 49, 20), (24, 31, 0)])
def test_engines_with_the_same_dash_differ_in_colour(count: int, alike: float, other: float) -> None:
    """On light pages and on dark ones. Five units are a difference that anybody sees."""
    styles = [engine_style(k) for k in range(count)]
    for one, two in combinations(styles, 2):
        for scheme in ("light", "dark"):
            distance = math.dist(lab(getattr(one, scheme)), lab(getattr(two, scheme)))
            assert distance >= (alike if one.dash == two.dash else other), (one, two)


def test_every_engine_has_its_own_colour_and_dash_and_none_is_solid() -> None:
    styles = [engine_style(k) for k in range(60)]
    assert len({(s.light, s.dash) for s in styles}) == 60
    assert all(s.dash for s in styles)
    text = page("many-engines")
    for k, candidate in enumerate(comparison("many-engines").candidates):
        assert f".e{k} {{" in text
        assert text.count(f'series e{k}"') == 2
        assert candidate.engine in text
