"""The first rung: predictions in doubles, with a bound on every rounding, that answer only where sure.

As the filters of exact geometry do (Bronnimann, Burnikel, Pion, *Interval arithmetic yields efficient dynamic
filters*, 2001; Shewchuk, *Adaptive precision floating-point arithmetic*, 1997), a quantity is computed in doubles
with a bound on its distance from the true value. A sign is told only beyond the bound; a time is told as two
doubles that enclose it. Everything else is UNCLEAR, and goes to balls.

Bounds. u = 2**-53 is the rounding unit. A state's doubles are off by at most 2u relatively: u by rounding the ball's
middle, and less than u/50 by its radius (`admit` sees to that). With S the largest coordinate, V the largest
speed component and T the latest clock that the run has seen:

- a coordinate of d is off by less than E = 64 u (S + V T): 2u S twice from the positions, 2u T twice and a rounding
  from the clocks, times V, 2u and a rounding from the product, three roundings of sums, together under
  2u (4 S + 6 V T);
- a component of v is off by less than F = 8 u V;
- d.v and d x v are off by less than 2 E W + 5 F D, with W and D the 1-norms of v and d: E W + F D + E F from the
  factors, and three roundings of at most 3 u D W <= 1.5 F D, as W <= 4 V;
- |v|^2 is off by less than 3 F W.

A flight begins at its instant, which its clock may miss by `late`; d.v there differs by at most |v|^2 times that, so a
pair surely parts only beyond that, and a hit counts only if it comes later than `late` after the clock. Most pairs that
part do so beyond one bound for all, with W <= 4 V, D <= 4 S + 2 V T and |v|^2 <= 8 V^2; most that miss each other do
so beyond such bounds of d x v and |v|^2.

All bounds are then taken at least twice as large as they come out, which covers the rounding of the bounds
themselves.

Where `compiled.predictions` is there, it does what `pairs` and `walls` do here.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import inf, isfinite, nan, sqrt
from typing import NamedTuple, TypeAlias

from flint import arb

from ..compiled import predictions
from ..replay.body import Body, Doubles

UNIT = 2.0**-53

ACCURATE_BITS = 60
"""A ball with this relative accuracy has a radius below 2**-58 of its middle: u/32 at most."""

BIG = 1e50
"""Beyond this, or its inverse, fourth powers and quotients of bounds might overflow or vanish: left to balls."""

TINY = 1 / BIG

AHEAD = 1.125
"""How far ahead of the latest clock bounds are taken, so that they hold for a while."""


class FloatLine(NamedTuple):
    """A wall as seen from a circle, in doubles: which it is, a point, a normal, r*|n|, the normal's 1-norm, and the
    size of the fixed terms of the gap."""

    wall: int
    x0: float
    y0: float
    nx: float
    ny: float
    offset: float
    norm: float
    size: float


def float_line(wall: int, x0: arb, y0: arb, nx: arb, ny: arb, offset: arb) -> FloatLine:
    """The doubles of a wall's short balls. Where these cannot tell the wall, its normal and its size are infinite, and
    nothing is ever clear: neither that a circle meets it nor that it flies away from it."""
    fx0, fy0, fnx, fny, fixed = (float(value) for value in (x0, y0, nx, ny, offset))
    norm = abs(fnx) + abs(fny)
    size = norm * (abs(fx0) + abs(fy0)) + abs(fixed)
    sharp = all(value.rel_accuracy_bits() > ACCURATE_BITS for value in (x0, y0, nx, ny, offset))
    if not (sharp and size < BIG and 1 / BIG < norm < BIG):
        norm = size = inf
    return FloatLine(wall, fx0, fy0, fnx, fny, fixed, norm, size)


PairBounds: TypeAlias = tuple[float, float, float, float, float]
"""4 E and F; of d.v and d x v, |v|^2 and what a `late` of 1 does to d.v: bounds that hold for any pair."""


class DoubleFilter:
    """Predictions in doubles.

    Attributes:
        largest: the largest coordinate seen (S).
        fastest: the largest speed component seen (V).
        latest: no less than the latest clock seen (T).
    """

    def __init__(self) -> None:
        self.largest = 0.0
        self.fastest = 0.0
        self.latest = 0.0
        self._clock: arb | None = None
        self._beside: arb | None = None
        self._at = self._late = 0.0
        self._bounds: PairBounds | None = None

    def admit(self, body: Body[arb]) -> None:
        """Sets a body's doubles from its short balls, or None if they are not accurate enough."""
        x, y, vx, vy, t = body.q
        beside = body.flight.late
        if t is not self._clock or beside is not self._beside:
            self._stand(t, beside)
        ft, late = self._at, self._late
        if not (
            x.rel_accuracy_bits() > ACCURATE_BITS
            and y.rel_accuracy_bits() > ACCURATE_BITS
            and vx.rel_accuracy_bits() > ACCURATE_BITS
            and vy.rel_accuracy_bits() > ACCURATE_BITS
            and ft < BIG
        ):
            body.f = None
            return
        fx, fy, fvx, fvy = float(x), float(y), float(vx), float(vy)
        if not (fx and fy and fvx and fvy) and any(
            told == 0.0 and not ball.is_zero() for told, ball in ((fx, x), (fy, y), (fvx, vx), (fvy, vy))
        ):  # below all doubles, which is not at rest
            body.f = None
            return
        self.take(body, (fx, fy, fvx, fvy, ft, late))

    def take(self, body: Body[arb], doubles: Doubles) -> None:
        """Sets a body's doubles, which are off by at most 2u, or None if they are too large or too small."""
        fx, fy, fvx, fvy, ft, late = doubles
        px, py, sx, sy = abs(fx), abs(fy), abs(fvx), abs(fvy)
        place = px if px > py else py
        speed = sx if sx > sy else sy
        if not (place < BIG and speed < BIG) or (
            not (px > TINY and py > TINY and sx > TINY and sy > TINY)
            and (0.0 < px < TINY or 0.0 < py < TINY or 0.0 < sx < TINY or 0.0 < sy < TINY)
        ):
            body.f = None
            return
        if not (ft < BIG and late < BIG) or 0.0 < ft < TINY:
            body.f = None
            return
        if place > self.largest or speed > self.fastest or ft > self.latest:
            self._widen(place, speed, ft)
        body.f = (fx, fy, fvx, fvy, ft, late)

    def _stand(self, t: arb, beside: arb | None) -> None:
        """Keeps the double of a clock and a bound of `late`, which the two of a contact share; not a number where
        doubles do not tell them."""
        self._clock, self._beside = t, beside
        ft = float(t)
        late = 0.0 if beside is None else float(beside.abs_upper()) * ROUND_UP
        plain = not 0.0 < ft < TINY and (ft != 0.0 or t.is_zero()) and late < BIG
        told = t.rel_accuracy_bits() > ACCURATE_BITS and plain
        self._at, self._late = ft if told else nan, late

    def _widen(self, place: float, speed: float, time: float) -> None:
        """Has the bounds cover what goes beyond them; clocks, which always do, by an eighth more than that."""
        self.largest = max(self.largest, place)
        self.fastest = max(self.fastest, speed)
        if time > self.latest:
            self.latest = time * AHEAD
        self._bounds = None

    @property
    def pair_bounds(self) -> PairBounds:
        """Those for all pairs, as things stand."""
        return self._bounds or self._bound()

    @property
    def wall_bounds(self) -> tuple[float, float]:
        """Bounds of what n.v, and n.x, is off by for a normal of 1."""
        return 16 * UNIT * self.fastest, 32 * UNIT * self.largest

    def _bound(self) -> PairBounds:
        fastest, latest = self.fastest, self.latest
        near = 4.0 * 64 * UNIT * (self.largest + fastest * latest)
        slack = 8 * UNIT * fastest
        largest = 4.0 * self.largest + 2.0 * fastest * latest
        any_off = 8.0 * near * fastest + 20.0 * slack * largest
        self._bounds = near, slack, any_off, 48.0 * slack * fastest, (32.0 * fastest + 96.0 * slack) * fastest
        return self._bounds

    def pairs(
        self, a: Body[arb], others: list[Body[arb]], reaches: list[float]
    ) -> tuple[list[tuple[float, float, Body[arb]]], list[Body[arb]]]:
        """Which of several bodies a hits, all keeping their velocities: bounds of the time, and the body; those that
        doubles cannot tell. A body that a surely misses is left out.

        All is reckoned at the later of two clocks. Where doubles do not tell which that is they differ by less than
        8u, which the bound of the time covers; then, as where b's is the later, a hit counts only if it is later than
        either `late`.

        Args:
            reaches: the sum of radii with a for each kind of body; not a number where doubles do not tell it.
        """
        fa = a.f
        found: list[tuple[float, float, Body[arb]]] = []
        unclear: list[Body[arb]] = []
        if fa is None:
            return found, list(others)
        if predictions is not None:
            return predictions.pairs(fa, others, reaches, self.pair_bounds)
        ax, ay, avx, avy, at, late = fa
        near, slack, any_off, any_loose, any_early = self.pair_bounds
        most = any_off + any_early * late
        close = 4 * UNIT * at
        for b in others:
            fb = b.f
            if fb is None:
                unclear.append(b)
                continue
            bx, by, bvx, bvy, bt, b_late = fb
            lag = at - bt
            if lag > close:
                now = at
                dx = bx + bvx * lag - ax
                dy = by + bvy * lag - ay
            else:
                now = bt
                dx = bx - (ax - avx * lag)
                dy = by - (ay - avy * lag)
                if b_late > late:
                    late = b_late
                    most = any_off + any_early * late
            vx = bvx - avx
            vy = bvy - avy
            approach = dx * vx + dy * vy
            if approach > most:
                continue
            cross = dx * vy - dy * vx
            if cross < 0.0:
                cross = -cross
            square = vx * vx + vy * vy
            reach = reaches[b.kind]
            clear = cross - any_off
            if clear > 0.0 and clear * clear > (square + any_loose) * (reach * reach) * ROUND_UP:
                continue
            wide = abs(vx) + abs(vy)
            off = near * wide + 10.0 * slack * (abs(dx) + abs(dy))
            loose = 6.0 * slack * wide
            early = off + 2.0 * (square + loose) * late
            if approach > early:
                continue
            if not (approach < -early and square > 100.0 * loose):
                unclear.append(b)
                continue
            if cross > off and (cross - off) * (cross - off) > (square + loose) * (reach * reach) * ROUND_UP:
                continue
            room = (square - loose) * (reach * reach) * ROUND_DOWN
            if (cross + off) * (cross + off) > room or reach == 0.0:
                unclear.append(b)
                continue
            speed = sqrt(square)
            doubt = loose / square + 8 * UNIT
            passing = cross / speed
            depth = sqrt(reach * reach - passing * passing)
            ahead = -approach / speed
            off /= speed
            off_passing = off + passing * doubt
            off_depth = (2.0 * passing * off_passing + off_passing * off_passing + 8 * UNIT * reach * reach) / depth
            wait = (ahead - depth) / speed
            off_wait = (off + off_depth + (ahead + depth) * (doubt + 4 * UNIT)) / speed + abs(wait) * doubt
            time = now + wait
            off_time = 2.0 * off_wait + 8 * UNIT * (now + abs(wait))
            if not (wait > off_time + late) or not isfinite(time):
                unclear.append(b)
            else:
                found.append((time - off_time, time + off_time, b))
        return found, unclear

    def apart(self, a: Body[arb], pocket: Body[arb], r: float) -> bool:
        """Whether a centre, at its clock, is surely not on the rim of a pocket of radius r.

        The clock may be `late` off the instant, by which a coordinate of d changes by V `late` at most.
        """
        fa, fb = a.f, pocket.f
        if fa is None or fb is None:
            return False
        dx, dy = fb[0] - fa[0], fb[1] - fa[1]
        near = 64 * UNIT * (self.largest + self.fastest * fa[4]) + self.fastest * fa[5]
        off = 8.0 * near * (abs(dx) + abs(dy) + near) + 32 * UNIT * r * r
        return abs(dx * dx + dy * dy - r * r) > off

    def walls(self, a: Body[arb], lines: Sequence[FloatLine]) -> tuple[list[tuple[float, float, int]], list[int]]:
        """Which of several walls a circle hits, which has just moved: bounds of the time, and the wall; the unclear."""
        fa = a.f
        found: list[tuple[float, float, int]] = []
        unclear: list[int] = []
        if fa is None:
            return found, [line.wall for line in lines]
        flat, far = self.wall_bounds
        if predictions is not None:
            return predictions.walls(fa, lines, flat, far)
        x, y, vx, vy, t, late = fa
        for k, x0, y0, nx, ny, offset, norm, size in lines:
            approach = nx * vx + ny * vy
            off = norm * flat
            if approach > off:
                continue
            gap = nx * (x - x0) + ny * (y - y0) - offset
            off_gap = 32 * UNIT * size + norm * far
            if not (approach < -8.0 * off and gap > off_gap):
                unclear.append(k)
                continue
            wait = -gap / approach
            off_wait = (off_gap + wait * off) / -approach + 8 * UNIT * wait
            time = t + wait
            off_time = 2.0 * off_wait + 8 * UNIT * (t + wait)
            if not (wait > off_time + late) or not isfinite(time):
                unclear.append(k)
            else:
                found.append((time - off_time, time + off_time, k))
        return found, unclear


ROUND_UP = 1 + 64 * UNIT
"""Covers the roundings of a comparison of squares: under ten units on each side."""

ROUND_DOWN = 1 - 64 * UNIT
"""As `ROUND_UP`, from the other side."""
