"""Numbers of contacts that no flight changes, in balls: made once for a precision."""

from __future__ import annotations

from typing import NamedTuple

from flint import arb

from ...numbers import ball
from ..ball_state import BallState
from ..body import Body
from ..contact import AtWall, Pair


class Partners(NamedTuple):
    """Of two circles: R^2, 2 w / (R^2 (wa + wb)) for each, and whether their masses are one."""

    square: arb
    share_a: arb
    share_b: arb
    alike: bool


class Shares(NamedTuple):
    """Of two circles on one line: R, 2 w / (wa + wb) for each, and what these leave of 1."""

    reach: arb
    a: arb
    b: arb
    rest_a: arb
    rest_b: arb


class Upright(NamedTuple):
    """A wall along an axis, to a circle: the coordinate at which the circle touches it, twice that, and which it is."""

    touch: arb
    twice: arb
    level: bool


class Oblique(NamedTuple):
    """Any other wall, to a circle.

    Attributes:
        x0, y0, nx, ny, offset: a point on it, the normal to the circle's side, and r |n|.
        xx, xy, yy: the matrix that mirrors (see `wall_mirror`).
        shift_x, shift_y: what it moves a place by.
    """

    x0: arb
    y0: arb
    nx: arb
    ny: arb
    offset: arb
    xx: arb
    xy: arb
    yy: arb
    shift_x: arb
    shift_y: arb


class Unchanging:
    """The numbers of a state's contacts, at one precision.

    Args:
        state: whose circles and walls.
    """

    def __init__(self, state: BallState) -> None:
        self._state = state
        self._bits = 0
        self._partners: dict[Pair, Partners] = {}
        self._alike: dict[tuple[int, int, int, int], Partners] = {}
        self._shares: dict[Pair, Shares] = {}
        self._walls: dict[AtWall, Upright | Oblique] = {}

    def at(self, bits: int) -> None:
        """At so many bits from now on."""
        if bits != self._bits:
            self._bits = bits
            self._partners.clear()
            self._alike.clear()
            self._shares.clear()
            self._walls.clear()

    def partners(self, link: Pair) -> Partners:
        """Those of two circles."""
        return self._partners.get(link) or self._become_partners(link)

    def shares(self, link: Pair) -> Shares:
        """Those of two circles on one line."""
        return self._shares.get(link) or self._share(link)

    def wall(self, link: AtWall) -> Upright | Oblique:
        """Those of a circle and a wall."""
        return self._walls.get(link) or self._face(link)

    def _become_partners(self, link: Pair) -> Partners:
        a, b = link.ends(self._state)
        kinds = id(a.r), id(a.w), id(b.r), id(b.w)  # circles of one radius and mass have the same two numbers
        found = self._alike.get(kinds)
        if found is None:
            ball.use_bits(self._bits)
            reach = self._state.reach(a, b)
            square = reach * reach
            whole = square * (a.w + b.w)
            shares = (a.w + a.w) / whole, (b.w + b.w) / whole
            found = self._alike[kinds] = Partners(square, *shares, self._are_alike(a, b))
        self._partners[link] = found
        return found

    def _are_alike(self, a: Body[arb], b: Body[arb]) -> bool:
        """Whether two circles have one mass: told by the balls of their inverse masses where these are exact."""
        if a.w.is_exact() and b.w.is_exact():
            return (a.w - b.w).is_zero()
        circles = self._state.scene.circles
        return circles[a.index].m == circles[b.index].m

    def _share(self, link: Pair) -> Shares:
        ball.use_bits(self._bits)
        a, b = link.ends(self._state)
        whole, one = a.w + b.w, self._state.one
        share_a, share_b = (a.w + a.w) / whole, (b.w + b.w) / whole
        found = self._shares[link] = Shares(self._state.reach(a, b), share_a, share_b, one - share_a, one - share_b)
        return found

    def _face(self, link: AtWall) -> Upright | Oblique:
        """A wall as a circle comes to it.

        Along an axis the centre keeps r from it, on its side, and the mirror is x' = 2 touch - x: `wall_gap` and
        `wall_mirror` for a normal of one component n, of which r |n| / n is r or -r.
        """
        ball.use_bits(self._bits)
        r = self._state.bodies[link.circle].r
        x0, y0, nx, ny, nn, length = self._state.line(link.circle, link.wall)
        for level, across, along, start in ((True, ny, nx, y0), (False, nx, ny, x0)):
            sign = ball.sign_of(across)
            if along.is_zero() and sign:
                touch = start + r if sign > 0 else start - r
                found = self._walls[link] = Upright(touch, touch + touch, level)
                return found
        offset = r * length
        shift = nx * x0 + ny * y0 + offset
        shift = (shift + shift) / nn
        mirror = self._state.mirror_of(link)
        found = self._walls[link] = Oblique(x0, y0, nx, ny, offset, *mirror, shift * nx, shift * ny)
        return found
