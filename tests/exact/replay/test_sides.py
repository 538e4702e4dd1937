"""A side told in doubles is the true one: the code's roundings are counted, and signs held against exact sums."""

from __future__ import annotations

from collections import Counter
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from truebreak.exact.replay import contact as sides
from truebreak.exact.replay.contact import CLEAR, TINIEST, Sides
from truebreak.scenarios import Circle, Scene, Wall

UNIT, LEAST = Fraction(1, 2**53), Fraction(1, 2**1075)
"""What one rounding changes at most: as a share, and, of what is near underflow, half of the least double."""


class Rounded:
    """A sum of products of what is exact, as doubles have it: each product with a bound of how often it was rounded.

    Args:
        terms: how often each product of names occurs, and how often it was rounded at most. The name `least` is an
            underflow's error.
    """

    def __init__(self, terms: dict[tuple[str, ...], tuple[Fraction, int]]) -> None:
        self.terms = terms

    @staticmethod
    def of(name: str) -> Rounded:
        """A number of the scene, converted."""
        return Rounded({(name,): (Fraction(1), 1), ("least",): (Fraction(1), 0)})

    def _sum(self, other: Rounded | float, sign: int) -> Rounded:
        found = dict(self.terms)
        terms = other.terms if isinstance(other, Rounded) else {(): (Fraction(other), 0)}
        for key, (factor, times) in terms.items():
            old, most = found.get(key, (Fraction(0), 0))
            found[key] = old + sign * factor, max(most, times)
        return Rounded({key: (factor, times + 1) for key, (factor, times) in found.items()})

    def __add__(self, other: Rounded | float) -> Rounded:
        return self._sum(other, 1)

    __radd__ = __add__

    def __sub__(self, other: Rounded) -> Rounded:
        return self._sum(other, -1)

    def __mul__(self, other: Rounded | float) -> Rounded:
        found: dict[tuple[str, ...], tuple[Fraction, int]] = {("least",): (Fraction(1), 0)}
        terms = other.terms if isinstance(other, Rounded) else {(): (Fraction(other), 0)}
        for one, (factor, times) in self.terms.items():
            for two, (share, more) in terms.items():
                key = tuple(sorted((*one, *two)))
                old, most = found.get(key, (Fraction(0), 0))
                found[key] = old + factor * share, max(most, times + more + 1)
        return Rounded(found)

    __rmul__ = __mul__

    def __abs__(self) -> Rounded:
        """Bounded by the products' absolute values."""
        return Rounded({key: (abs(factor), times) for key, (factor, times) in self.terms.items()})

    def __lt__(self, other: float) -> bool:
        return True

    def __gt__(self, other: Rounded) -> bool:
        compared.append((self, other))
        return True


compared: list[tuple[Rounded, Rounded]] = []


class Named:
    def __init__(self, name: str) -> None:
        self.name = name


def at_most(terms: dict[tuple[str, ...], Fraction]) -> Counter[tuple[str, ...]]:
    """Bounds of products, underflow's errors put in, by the names that are left."""
    found: Counter[tuple[str, ...]] = Counter()
    for key, bound in terms.items():
        names = tuple(name for name in key if name != "least")
        found[names] += bound * LEAST ** (len(key) - len(names))
    return found


def test_what_is_lost_in_doubles_is_less_than_what_a_sign_is_told_beyond(monkeypatch: pytest.MonkeyPatch) -> None:
    """Product by product of the height that the wall states: after k roundings each is off by (1 + u)^k - 1 of it at
    most, and the bound, itself rounded k times, holds (1 - u)^k of it at least."""
    monkeypatch.setattr(sides, "float", lambda value: Rounded.of(value.name), raising=False)
    monkeypatch.setattr(sides, "isfinite", lambda value: True)
    asked = Sides.__new__(Sides)
    asked._walls = {0: tuple(map(Rounded.of, ("nx", "ny", "x0", "y0")))}
    asked.scene = type("", (), {"circles": [type("", (), {"x": Named("x"), "y": Named("y")})]})
    compared.clear()
    assert asked._in_doubles(0, 0) is True
    ((height, lost),) = compared
    exact = {key: factor for key, (factor, _) in height.terms.items() if "least" not in key}
    assert {key: abs(factor) for key, factor in exact.items()} == {
        ("nx", "x"): 1, ("nx", "x0"): 1, ("ny", "y"): 1, ("ny", "y0"): 1,
    }  # fmt: skip
    off = {
        key: abs(factor) * ((1 + UNIT) ** times - ("least" not in key)) for key, (factor, times) in height.terms.items()
    }
    told = {k: factor * (1 - UNIT) ** times for k, (factor, times) in lost.terms.items() if "least" not in k}
    for names, bound in at_most(off).items():
        assert bound < told[names], names
    assert max(times for _, times in height.terms.values()) * UNIT < Fraction(1, 2**49)
    assert (Fraction(CLEAR), Fraction(TINIEST)) > (Fraction(1, 2**49), LEAST)


small = st.integers(-(10**6), 10**6)
tiny = st.sampled_from([Fraction(0), *(Fraction(s, 10**e) for s in (1, -1) for e in (3, 12, 15, 16, 17, 30, 400))])


@given(small, small, small, small, st.fractions(-9, 9, max_denominator=97), tiny)
def test_a_side_is_that_of_the_exact_height(x0: int, y0: int, dx: int, dy: int, along: Fraction, off: Fraction) -> None:
    """Of points beside the wall by any distance, however little: told in doubles or not, never the wrong one."""
    if not (dx or dy) or not off:
        return
    wall = Wall(x0, y0, x0 + dx, y0 + dy)
    x, y = x0 + along * dx - off * dy, y0 + along * dy + off * dx
    asked = Sides(Scene([Circle(x, y, 0, point=True)], [wall]))
    nx, ny = (Fraction(int(n.rational.p), int(n.rational.q)) for n in wall.normal)
    height = nx * (x - x0) + ny * (y - y0)
    assert asked._in_doubles(0, 0) in (None, height < 0)
    assert asked.negative(0, 0) is (height < 0)
