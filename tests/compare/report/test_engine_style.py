"""Engines are told apart by colour and dash, whatever their number."""

from __future__ import annotations

import colorsys
import math
import re
from itertools import combinations

import pytest
from pages import comparison, page

from truebreak.compare.picture import engine_style


def lab(colour: str) -> tuple[float, float, float]:
    """An `hsl(...)` of CSS in CIELAB, in which distances are differences that are seen."""
    hue, saturation, lightness = map(float, re.findall(r"[\d.]+", colour))
    channels = colorsys.hls_to_rgb(hue / 360, lightness / 100, saturation / 100)
    red, green, blue = (c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in channels)
    white = (0.95047, 1.0, 1.08883)
    rows = ((0.4124, 0.3576, 0.1805), (0.2126, 0.7152, 0.0722), (0.0193, 0.1192, 0.9505))
    shares = [(r * red + g * green + b * blue) / w for (r, g, b), w in zip(rows, white, strict=True)]
    x, y, z = (s ** (1 / 3) if s > 0.008856 else 7.787 * s + 16 / 116 for s in shares)
    return 116 * y - 16, 500 * (x - y), 200 * (y - z)


@pytest.mark.parametrize(("count", "alike", "other"), [(6, math.inf, 35), (12, 49, 14), (24, 31, 0)])
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
