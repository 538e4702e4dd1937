"""The filter of pairs against its naive twin, which weighs every partner by bounds of its own.

What the filter may do beyond its twin is to drop a partner that its twin calls unclear, where the paths surely miss
each other; every hit that it tells is told in the same doubles.
"""

from __future__ import annotations

from fractions import Fraction as Q
from math import isfinite, sqrt
from random import Random

import pytest
from flint import arb

from truebreak.exact.certified.filtered import ROUND_DOWN, ROUND_UP, UNIT, DoubleFilter
from truebreak.exact.replay.contact import Body, Flight

ROWS, PARTNERS = 2_500, 20


def second_is_younger(fa: tuple, fb: tuple) -> bool:
    """Whether the clock of the second is not surely the earlier one."""
    return not fa[4] - fb[4] > 4 * UNIT * fa[4]


def naive(filter_: DoubleFilter, fa: tuple, fb: tuple, reach: float, late: float) -> tuple[float, float] | str:
    """Bounds of the time at which two hit; "miss" or "unclear"."""
    ax, ay, avx, avy, at, _ = fa
    bx, by, bvx, bvy, bt, _ = fb
    near = 4.0 * 64 * UNIT * (filter_.largest + filter_.fastest * filter_.latest)
    slack = 8 * UNIT * filter_.fastest
    lag, vx, vy = at - bt, bvx - avx, bvy - avy
    if second_is_younger(fa, fb):
        at, dx, dy = bt, bx - (ax - avx * lag), by - (ay - avy * lag)
    else:
        dx, dy = bx + bvx * lag - ax, by + bvy * lag - ay
    approach = dx * vx + dy * vy
    wide = abs(vx) + abs(vy)
    off = near * wide + 10.0 * slack * (abs(dx) + abs(dy))
    square = vx * vx + vy * vy
    loose = 6.0 * slack * wide
    early = off + 2.0 * (square + loose) * late
    if approach > early:
        return "miss"
    if not (approach < -early and square > 100.0 * loose):
        return "unclear"
    cross = abs(dx * vy - dy * vx)
    if cross > off and (cross - off) * (cross - off) > (square + loose) * (reach * reach) * ROUND_UP:
        return "miss"
    if (cross + off) * (cross + off) > (square - loose) * (reach * reach) * ROUND_DOWN or reach == 0.0:
        return "unclear"
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
    time = at + wait
    off_time = 2.0 * off_wait + 8 * UNIT * (at + abs(wait))
    if not wait > off_time + late or not isfinite(time):
        return "unclear"
    return time - off_time, time + off_time


def surely_misses(fa: tuple, fb: tuple, reach: float) -> bool:
    """Whether two that are as their doubles say never come as near as their radii, in rational numbers."""
    ax, ay, avx, avy, at = map(Q, fa[:5])
    bx, by, bvx, bvy, bt = map(Q, fb[:5])
    dx, dy, vx, vy = bx + bvx * (at - bt) - ax, by + bvy * (at - bt) - ay, bvx - avx, bvy - avy
    return (dx * vy - dy * vx) ** 2 > (vx * vx + vy * vy) * Q(reach) ** 2


def flight(rng: Random, place: float, speed: float, now: float) -> tuple:
    """A flight in doubles: often on a grid, or at rest along an axis, so that hairs and zeros occur."""

    def number(scale: float) -> float:
        kind = rng.random()
        if kind < 0.1:
            return 0.0
        return scale * (rng.randint(-8, 8) / 4 if kind < 0.3 else rng.uniform(-2.0, 2.0))

    return number(place), number(place), number(speed), number(speed), now, 0.0


@pytest.mark.parametrize("place, speed", [(1.0, 1.0), (1e3, 1e-3), (1e45, 1e45), (1e-45, 1e-45), (1e45, 1e-45)])
def test_the_filter_tells_what_its_naive_twin_tells(place: float, speed: float) -> None:
    rng = Random(f"{place} {speed}")
    told = dict.fromkeys(("hit", "miss", "unclear", "spared"), 0)
    for _ in range(ROWS):
        filter_ = DoubleFilter()
        now = place / speed * rng.choice([0.0, 1.0, 40.0])
        if not now < 1e50:
            now = 0.0
        reaches = [place * rng.uniform(0.05, 2.0) * rng.choice([1.0, 1.0, 1e-7]) for _ in range(3)]
        row = [Body(i, Flight(*[arb(0)] * 6), arb(1), arb(1)) for i in range(PARTNERS + 1)]
        for body in row:
            body.f = flight(rng, place, speed, now if body is row[0] else now * rng.choice([0.0, 0.5, 1.0, 1.25]))
            body.kind = rng.randrange(3)
            if body is not row[0] and rng.random() < 0.1:
                body.f = (*body.f[:5], 1e-25 * place / speed)
        if rng.random() < 0.3:
            row[0].f = (*row[0].f[:5], rng.choice([1e-17, 1e-25]) * place / speed)
        filter_.largest = max(abs(x) for body in row for x in body.f[:2])
        filter_.fastest = max(abs(v) for body in row for v in body.f[2:4])
        filter_.latest = max(body.f[4] for body in row)
        found, unclear = filter_.pairs(row[0], row[1:], reaches)
        hits = {b.index: (low, high) for low, high, b in found}
        left = {b.index for b in unclear}
        late = row[0].f[5]
        for b in row[1:]:
            late = max(late, b.f[5]) if second_is_younger(row[0].f, b.f) else late
            expected = naive(filter_, row[0].f, b.f, reaches[b.kind], late)
            if isinstance(expected, tuple):
                told["hit"] += 1
                assert hits.get(b.index) == expected
            elif expected == "unclear" and b.index not in left:
                told["spared"] += 1
                assert surely_misses(row[0].f, b.f, reaches[b.kind])
            else:
                told[expected] += 1
                assert b.index not in hits
                assert (b.index in left) == (expected == "unclear")
    assert sum(told.values()) == ROWS * PARTNERS
    assert min(told["hit"], told["miss"]) > 1_000
    assert told["unclear"] > 10
