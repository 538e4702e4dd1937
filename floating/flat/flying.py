"""Meetings predicted and contacts carried out, on flat flights: the laws' formulas, in the order of the general loop.

`walls` and `pairs` are also in C, in flying.c, which runs where there was a compiler: what changes here changes there.
"""

from __future__ import annotations

from collections.abc import Container, Iterable
from heapq import heappush
from math import sqrt

from ...exact.laws.formulas import (
    advance,
    damped,
    face_along,
    face_foot,
    pair_approach,
    pair_discriminant,
    pair_gap,
    pair_hit_time,
    pair_impulse,
    wall_approach,
    wall_bounce,
    wall_gap,
    wall_hit_time,
)
from .flat_flights import FlatFlight, FlatFlights, FlatLine


def walls(f: FlatFlights, i: int, lines: Iterable[FlatLine], standing: Container[int]) -> None:
    """Queues the next hits of a circle with some walls and faces, up to the first.

    A face is met from its own side, strictly between its ends; what stands or flies behind it, or along its line but
    not at it, does not meet it.
    """
    x, y, vx, vy, t, _, _ = f.flights[i]
    untils, heap, serial = f.until, f.heap, f.serial[i]
    for k, x0, y0, nx, ny, offset, nn, is_face in lines:
        approach = wall_approach(vx, vy, nx, ny)
        if approach > 0.0 or (approach == 0.0 and not is_face):
            continue
        gap = wall_gap(x, y, x0, y0, nx, ny, offset)
        if is_face:
            if approach == 0.0 and (gap < 0.0 or gap > 0.0):
                continue
            along = face_along(x, y, x0, y0, nx, ny)
            if gap < 0.0 and (gap + offset <= 0.0 or along <= 0.0 or nn - along <= 0.0):
                continue
        else:
            along = 0.0
        if k in standing:
            continue
        if is_face and approach < 0.0 and gap > 0.0:
            foot = face_foot(along, face_along(vx, vy, 0.0, 0.0, nx, ny), gap, approach)
            beyond = -((nx * nx + ny * ny) * approach) - foot
            if foot < 0.0 or beyond < 0.0:
                continue
            if not (foot > 0.0 and beyond > 0.0):
                f.unsure(i, k)
                continue
        if approach < 0.0 and gap > 0.0:
            wait = wall_hit_time(gap, approach)
            time = t + wait
            if time > untils[i]:
                continue
            untils[i] = min(untils[i], time)
            heappush(heap, (time, f.tick(), i, k, serial, 0, wait, False))
        else:
            f.unsure(i, k)


def pairs(f: FlatFlights, i: int, others: Iterable[FlatFlight], standing: Container[int]) -> None:
    """Queues the next meetings of a circle, whose flight is new, with circles whose flights are older.

    Args:
        others: their flights.
        standing: places not to be met: those that touch it without approach, those predicted already, its own.
    """
    ax, ay, avx, avy, at, ar, _ = f.flights[i]
    untils, heap, serials = f.until, f.heap, f.serial
    until = untils[i]
    for bx, by, bvx, bvy, bt, br, j in others:
        lag = at - bt
        dx = advance(bx, bvx, lag) - ax
        dy = advance(by, bvy, lag) - ay
        vx = bvx - avx
        vy = bvy - avy
        approach = pair_approach(dx, dy, vx, vy)
        if approach >= 0.0:
            continue
        reach = ar + br
        disc = pair_discriminant(dx, dy, vx, vy, reach)
        if disc < 0.0:
            continue
        gap = pair_gap(dx, dy, reach)
        if disc > 0.0 and approach < 0.0 and gap > 0.0:
            wait = pair_hit_time(gap, approach, sqrt(disc))
            time = at + wait
            if time > until or time > untils[j] or j in standing:
                continue
            heappush(heap, (time, f.tick(), i, j, serials[i], serials[j], wait, False))
        elif j not in standing:
            f.unsure(i, j)


def strike(f: FlatFlights, i: int, j: int, time: float, wait: float) -> None:
    """Carries out the contact of two circles that stands alone at its instant.

    Args:
        i, j: the two, the first that from whose clock `wait` is reckoned.
        time: the instant.
    """
    flights = f.flights
    base = flights[i][4]
    if i > j:
        i, j = j, i
    ax, ay, avx, avy, at, ar, _ = flights[i]
    bx, by, bvx, bvy, bt, br, _ = flights[j]
    if avx or avy:
        lag = wait if at is base else time - at
        ax = advance(ax, avx, lag)
        ay = advance(ay, avy, lag)
    if bvx or bvy:
        lag = wait if bt is base else time - bt
        bx = advance(bx, bvx, lag)
        by = advance(by, bvy, lag)
    (wa, a_fixed), (wb, b_fixed) = f.weights[i], f.weights[j]
    dx = bx - ax
    dy = by - ay
    vx = bvx - avx
    vy = bvy - avy
    reach = ar + br
    jx, jy = pair_impulse(dx, dy, vx, vy, reach, wa, wb)
    if f.share is not None:
        jx, jy = jx * f.share, jy * f.share
    if not a_fixed:
        avx = avx + wa * -jx
        avy = avy + wa * -jy
    if not b_fixed:
        bvx = bvx + wb * jx
        bvy = bvy + wb * jy
    flights[i] = (ax, ay, avx, avy, time, ar, i)
    flights[j] = (bx, by, bvx, bvy, time, br, j)
    f.last[i] = f.last[j] = f.steps + 1
    f.steps += 2
    f.serial[i] += 1
    f.serial[j] += 1


def rebound(f: FlatFlights, i: int, wall: int, time: float, wait: float) -> None:
    """Carries out the contact of a circle and a wall that stands alone at its instant (see `strike`)."""
    x, y, vx, vy, _, r, _ = f.flights[i]
    _, _, _, nx, ny, _, nn, _ = f.lines(i)[wall - f.n]
    if vx or vy:
        x = advance(x, vx, wait)
        y = advance(y, vy, wait)
    wx, wy = wall_bounce(vx, vy, nx, ny, nn)
    vx, vy = (wx, wy) if f.share is None else (damped(vx, wx, f.share), damped(vy, wy, f.share))
    f.flights[i] = (x, y, vx, vy, time, r, i)
    f.last[i] = f.steps + 1
    f.steps += 2
    f.serial[i] += 1
