"""The scene as an engine is given it: every number rounded to its bits, whether that is a scene or not."""

from __future__ import annotations

import math
from functools import cached_property
from typing import Any

from flint import arb

from ...exact.numbers import ball
from ...exact.replay.contact import Flight, Gravity, Round
from ...exact.replay.state import ReplayState
from ...exact.replay.wall_flights import SeenWall
from ...scenarios.errors import SceneError
from ...scenarios.numbers.quantity import Quantity
from ...scenarios.scene import Scene
from ...scenarios.surfaces import SegmentFace, sides_of
from ...scenarios.things import Arc, Circle, Pocket, Polygon, Segment
from ..alignment.instants import DOUBLE_BITS
from .free_flights import round_wait, row_of

SINGLE_BITS, PAIR_BITS = 24, 106
"""Of a single, and of a pair of doubles: formats of which more is known than how many bits they have."""

LEAST_SINGLE = -149
"""log2 of the least single above zero."""

DIGITS = 1
"""Decimals that are looked at for each bit: three times as many as it is worth."""


def _thickness_and_pace(solid: Segment | Polygon, bits: int) -> dict[str, Quantity]:
    """Its r, vx and vy, each the nearest number of so many bits."""
    return {key: nearest(getattr(solid, key), bits) for key in ("r", "vx", "vy")}


def nearest(value: Quantity, bits: int = DOUBLE_BITS) -> Quantity:
    """The nearest number of so many bits, ties to even.

    Of 53 bits are doubles, of 24 singles, with the exponents that they have. Of 106 is a pair of doubles: the nearest
    one, and the one nearest to what it leaves.

    Raises:
        SceneError: beyond the doubles.

    >>> nearest(Quantity.of("1/3"), 2).text(), nearest(Quantity.of("3/8 - 1/10**40"), 1).text()
    ('3/8', '1/4')
    """
    from fractions import Fraction

    double = _double(value)
    if bits == DOUBLE_BITS:
        return Quantity.of(Fraction(double))
    if bits == PAIR_BITS:
        high = Quantity.of(Fraction(double))
        return high + Quantity.of(Fraction(_double(value - high)))
    exponent = math.frexp(double)[1] - bits
    spacing = Fraction(2) ** (max(exponent, LEAST_SINGLE) if bits == SINGLE_BITS else exponent)
    scaled = value / Quantity.of(spacing)
    below = math.floor(Fraction(scaled.digits(DIGITS * bits)))
    side = (scaled - Quantity.of(below + Fraction(1, 2))).sign()
    return Quantity.of((below + (below % 2 if side == 0 else side > 0)) * spacing)


def rounded(scene: Scene, bits: int = DOUBLE_BITS) -> Scene:
    """The scene with every length, velocity, mass, gravity and restitution replaced by the nearest of so many bits.

    Raises:
        SceneError: if the rounded circles overlap, sides of a rounded polygon cross, or a number is beyond the doubles.

    >>> scene = Scene([Circle("1/3", 0)])
    >>> rounded(scene).circles[0].x == scene.circles[0].x, rounded(rounded(scene)) == rounded(scene)
    (False, True)
    """
    circles = [
        Circle(
            *(nearest(value, bits) for value in (c.x, c.y, c.r, c.vx, c.vy)),
            m=c.m if isinstance(c.m, str) else nearest(c.m, bits),
            id=c.id,
            point=c.point,
        )
        for c in scene.circles
    ]
    walls = [
        type(w)(
            *(nearest(value, bits) for value in (w.x0, w.y0, w.x1, w.y1)), id=w.id,
            **{"vx": nearest(w.vx, bits), "vy": nearest(w.vy, bits)} if w.moves else {},
        )
        for w in scene.walls
    ]  # fmt: skip
    segments = [
        Segment(*(nearest(value, bits) for value in (s.x0, s.y0, s.x1, s.y1)), id=s.id, **_thickness_and_pace(s, bits))
        for s in scene.segments
    ]
    polygons = [
        Polygon([(nearest(x, bits), nearest(y, bits)) for x, y in g.points], g.id, **_thickness_and_pace(g, bits))
        for g in scene.polygons
    ]
    arcs = [
        Arc(
            *(nearest(value, bits) for value in (a.x, a.y, a.r)), id=a.id, full=a.full,
            **{} if a.full else {key: nearest(getattr(a, key), bits) for key in ("x0", "y0", "x1", "y1")},
        )
        for a in scene.arcs
    ]  # fmt: skip
    pockets = [Pocket(*(nearest(value, bits) for value in (p.x, p.y, p.r)), id=p.id) for p in scene.pockets]
    others: dict[str, Any] = {"segments": segments, "polygons": polygons, "arcs": arcs, "pockets": pockets}
    if scene.gravity is not None:
        others["gravity"] = tuple(nearest(part, bits) for part in scene.gravity)
    if not scene.elastic:
        others["restitution"] = nearest(scene.restitution, bits)
    return scene.with_changes(circles=circles, walls=walls, **{key: things for key, things in others.items() if things})


def _double(value: Quantity) -> float:
    try:
        return float(value)
    except OverflowError:
        raise SceneError(f"{value.text()[:40]}: is beyond the doubles") from None


class RoundedState(ReplayState[arb]):
    """The scene's circles and surfaces with every number rounded to so many bits, whether that is a scene or not.

    Faces of something thick are those of what is rounded: what an engine rounds of them besides is its own arithmetic.

    Args:
        scene: as it is given, or its `surfaces` where nothing is rounded.
        bits: None: nothing is rounded.
    """

    def __init__(self, scene: Scene, bits: int | None) -> None:
        self._solids = scene if bits is not None and (scene.segments or scene.polygons) else None
        scene = scene.surfaces
        super().__init__(scene, ball.BALLS)
        self._bits = bits
        if bits is None:
            return
        for circle, body in zip(scene.circles, self.bodies.values(), strict=True):
            x, y, vx, vy, r = map(self._near, (circle.x, circle.y, circle.vx, circle.vy, circle.r))
            body.r = r
            body.flight = Flight(x, y, vx, vy, self.zero, self.zero, rest=circle.fixed)
            if isinstance(circle.m, Quantity):
                body.w = 1 / self._near(circle.m)
        for thing, body in zip((*scene.arc_sides, *scene.pockets), (*self.arcs, *self.pockets), strict=True):
            body.r = self._near(thing.r)
            body.flight = self._still_at(self._near(thing.x), self._near(thing.y))
        if scene.gravity is not None:
            hx, hy = (self._near(part) / 2 for part in scene.gravity)
            self.falling = Gravity(hx, hy, self.bends)
        for wall in self.drifts:
            self.drifts[wall] = self._near(scene.walls[wall].vx), self._near(scene.walls[wall].vy)
        for end in self.paces:
            ux, uy = scene.moving_ends[end].drift
            self.paces[end] = self._near(ux), self._near(uy)
        if self.share is not None:
            self.share = (1 + self._near(scene.restitution)) / 2

    def _still_at(self, x: arb, y: arb) -> Flight[arb]:
        zero = self.zero
        return Flight(x, y, zero, zero, zero, zero, rest=True)

    def _near(self, value: Quantity) -> arb:
        return ball.constant(value if self._bits is None else nearest(value, self._bits))

    def peg_hit(self, link: Round) -> tuple[arb, arb]:
        """As `RoundFalls.peg_hit`: not a number where there is no such time."""
        body = self.faller(link)
        wait = round_wait(self, link, row_of(body.flight))
        return body.flight.t, arb("nan") if wait is None else wait

    def line(self, circle: int, wall: int) -> SeenWall[arb]:
        """As `Flights.line`, of the rounded wall."""
        if self._bits is not None and wall not in self._lines:
            face = None if wall not in self.scene.faces else self._faces[wall - self.scene.faces.start]
            if face is not None:
                self._see(wall, *map(ball.constant, (face.x0, face.y0, *face.normal)))
            else:
                exact = self.scene.walls[wall]
                x0, y0, x1, y1 = map(self._near, (exact.x0, exact.y0, exact.x1, exact.y1))
                self._see(wall, x0, y0, y0 - y1, x1 - x0)  # as `Wall.normal`
        return super().line(circle, wall)

    @cached_property
    def _faces(self) -> list[SegmentFace]:
        """The faces of what is rounded; of a side that rounding leaves no length, as it is."""
        assert self._solids is not None and self._bits is not None
        found: list[SegmentFace] = []
        for side, back in [
            *((segment, back) for segment in self._solids.segments for back in (False, True)),
            *((side, False) for polygon in self._solids.polygons for side in sides_of(polygon)),
        ]:
            x0, y0, x1, y1 = (nearest(value, self._bits) for value in (side.x0, side.y0, side.x1, side.y1))
            if (x0, y0) == (x1, y1):
                x0, y0, x1, y1 = side.x0, side.y0, side.x1, side.y1
            found.append(SegmentFace.of(Segment(x0, y0, x1, y1, side.id, nearest(side.r, self._bits)), back))
        return found

    def _see(self, wall: int, x0: arb, y0: arb, nx: arb, ny: arb) -> None:
        nn = nx * nx + ny * ny
        length = nn.sqrt()
        self._lines[wall] = SeenWall(x0, y0, nx, ny, nn, length), SeenWall(x0, y0, -nx, -ny, nn, length)

    def towards(self, other: RoundedState, share: arb) -> RoundedState:
        """The state a share of the way to another one of the same scene: of all that is rounded."""

        def between(a: arb, b: arb) -> arb:
            return a + share * (b - a)

        made = RoundedState(self.scene, None)
        if self.falling is not None and other.falling is not None:
            mine, theirs = self.falling, other.falling
            made.falling = Gravity(between(mine.hx, theirs.hx), between(mine.hy, theirs.hy), self.bends)
        if self.share is not None and other.share is not None:
            made.share = between(self.share, other.share)
        for told, mine, theirs in (
            (made.drifts, self.drifts, other.drifts),
            (made.paces, self.paces, other.paces),
        ):
            told.update({k: (between(ux, theirs[k][0]), between(uy, theirs[k][1])) for k, (ux, uy) in mine.items()})
        for k, body in made.bodies.items():
            one, two = self.bodies[k], other.bodies[k]
            x, y, vx, vy = (a + share * (b - a) for a, b in zip(one.flight[:4], two.flight[:4], strict=True))
            body.flight = Flight(x, y, vx, vy, self.zero, self.zero, rest=one.flight.rest)
            body.r, body.w = one.r + share * (two.r - one.r), one.w + share * (two.w - one.w)
        for mine, one, two in zip(*((*state.arcs, *state.pockets) for state in (made, self, other)), strict=True):
            x, y = (a + share * (b - a) for a, b in zip(one.flight[:2], two.flight[:2], strict=True))
            mine.flight = self._still_at(x, y)
            mine.r = one.r + share * (two.r - one.r)
        for wall in range(len(self.scene.walls)):
            one, two = self.line(0, wall)[:4], other.line(0, wall)[:4]
            made._see(wall, *(a + share * (b - a) for a, b in zip(one, two, strict=True)))
            if self.sides.negative(0, wall):
                made._lines[wall] = made._lines[wall][1], made._lines[wall][0]
        return made
