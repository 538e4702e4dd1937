"""Kinds of scenes with a symmetry or a twin, whole or spoilt by a flaw."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from random import Random

from fuzz.draft import AXES, HEX, Body, Draft, F, directions, flaw, mass, reversal, size, speed, velocity

Maker = Callable[[Random], Draft]


def spoil(draft: Draft, draw: Random, start: int = 0) -> Draft:
    """A flaw in one number of one thing, the circles before `start` left alone."""
    tiny = flaw(draw)
    if draft.pockets and draw.random() < 0.4:
        x, y, r = draft.pockets[-1]
        draft.pockets[-1] = draw.choice([(x + tiny, y, r), (x, y + tiny, r), (x, y, r + tiny)])
        return draft
    movable = [b for b in draft.bodies[start:] if b.m != "oo"]
    if movable:
        b = draw.choice(movable)
        key = draw.choice(["x", "y", "vx", "vy"])
        setattr(b, key, getattr(b, key) + tiny)
    return draft


def twins(draw: Random, makers: Sequence[Maker]) -> Draft:
    """A small scene and its copy, shifted, mirrored or turned, with or without a flaw in the copy."""
    one = draw.choice(makers)(draw)
    one.walls = []
    one.bodies = one.bodies[:4]
    far = draw.choice([100, 60])
    c, s = draw.choice([(1, 0), (1, 0), (-1, 0), (0, 1), (F(3, 5), F(4, 5))])
    other = one.moved(c, s, 0, far, mirror=draw.random() < 0.4)
    both = replace(one, bodies=one.bodies + other.bodies, pockets=one.pockets + other.pockets)
    if draw.random() < 0.6:
        both = spoil(both, draw, len(one.bodies))
    if draw.random() < 0.3:  # walls that both can reach
        both.walls = [(-30, 0, -30, 1), (31, 0, 31, 1)]
    return both


def mirrored(draw: Random) -> Draft:
    """Pairs above and below an axis, a striker or a target on it; perhaps a flaw."""
    draft = Draft([])
    r = draw.choice([F(1, 2), 1, F(2, 5)])
    for k in range(draw.choice([1, 1, 2])):
        x, y = -5 + 4 * k + draw.choice([0, F(1, 2)]), r + draw.choice([0, 0, 1, 2, 3])
        vx, vy = draw.choice([(1, 0), (1, F(-1, 3)), (1, -1), (0, 0), (2, F(-1, 2))])
        m = mass(draw)
        draft.bodies += [Body(x, y, r, vx, vy, m), Body(x, -y, r, vx, -vy, m)]
    x, radius, vx = draw.choice([0, 4, 6]), draw.choice([r, r, size(draw)]), draw.choice([0, 0, -1])
    draft.bodies.append(Body(x, 0, radius, vx, 0, draw.choice([1, 2, "oo"])))
    if draft.bodies[-1].m == "oo":
        draft.bodies[-1].vx = 0
    if draw.random() < 0.5:
        draft.walls.append((draw.choice([10, 12]), 0, 10, 1))
        draft.walls[0] = (draft.walls[0][0], 0, draft.walls[0][0], 1)
    if draw.random() < 0.5:
        draft.walls += [(0, 8, 1, 8), (0, -8, 1, -8)]
    if draw.random() < 0.4:
        draft.pockets += [(9, 3, 5), (9, -3, 5)] if draw.random() < 0.5 else [(13, 3, 5)]
        draft.capture = draw.random() < 0.5
    if draw.random() < 0.5:
        draft = spoil(draft, draw)
    return reversal(draft, draw, 0.25)


def neighbours(draw: Random) -> Draft:
    """A mirrored pair that strikes a ball, beside a flawed pocket, a flawed wall, or a flawed pair of its own."""
    draft = Draft([Body(-6, 3, 1, 1, F(-1, 3)), Body(-6, -3, 1, 1, F(1, 3)), Body(0, 0, 1, 0, 0, mass(draw))])
    wall, tiny = draw.choice([9, 10, 20]), flaw(draw)
    draft.walls.append((wall, 0, wall, 1))
    r, h = draw.choice([(5, 3), (5, 5), (13, 5), (1, 0)])
    reach = {3: 4, 5: 12, 0: 1}.get(h, 0) if r != h else 0
    draft.pockets.append((wall - 1 + reach + tiny, h, r + draw.choice([0, 0, tiny])))
    if draw.random() < 0.5:
        draft.bodies.append(Body(-2, 60, 1, 1, draw.choice([0, tiny])))
    if draw.random() < 0.4:
        draft.bodies += [Body(-6, 33, 1, 1, F(-1, 3)), Body(-6 + draw.choice([0, tiny]), 27, 1, 1, F(1, 3))]
        draft.bodies.append(Body(draw.choice([0, tiny]), 30, 1))
    draft.capture = draw.random() < 0.5
    return reversal(draft, draw, 0.15)


def ring(draw: Random) -> Draft:
    """Circles around a centre that fall in, fly out, or circle, all alike: symmetric under turns; perhaps a flaw."""
    ways = draw.choice([AXES, AXES, HEX, HEX[::2]])
    far, v, w, r = draw.choice([3, 4, 5]), speed(draw), draw.choice([0, 0, F(1, 3), 1]), draw.choice([1, F(1, 2)])
    draft = Draft([Body(x * far, y * far, r, -x * v - y * w, -y * v + x * w) for x, y in ways])
    if draw.random() < 0.6:
        m = draw.choice([1, 2, "oo"])
        draft.bodies.append(Body(0, 0, draw.choice([r, 1, F(1, 3)]), 0, 0, m))
    if draw.random() < 0.3:
        draft.pockets = [(x * 7, y * 7, 2) for x, y in ways[: draw.choice([1, 2, len(ways)])]]
        draft.capture = draw.random() < 0.6
    if draw.random() < 0.3:
        draft.walls = [(9 * x, 9 * y, 9 * x - y, 9 * y + x) for x, y in ways[:4]]
    if draw.random() < 0.45:
        draft = spoil(draft, draw)
    return reversal(draft, draw, 0.25)


def onto_pair(draw: Random) -> Draft:
    """One circle onto two that touch or not, straight or a flaw aside, and what stands behind."""
    (nx, ny), r = draw.choice(directions(draw)), 1
    gap = draw.choice([0, 0, 1])
    bodies = [Body(-ny * (r + gap), nx * (r + gap), r), Body(ny * (r + gap), -nx * (r + gap), r)]
    far = draw.choice([4, 5, 7])
    s = speed(draw)
    cue = Body(-nx * far, -ny * far, draw.choice([1, 1, F(1, 2)]), nx * s, ny * s, mass(draw))
    if draw.random() < 0.5:
        tiny = flaw(draw)
        cue.x, cue.y = cue.x - ny * tiny, cue.y + nx * tiny
    bodies.append(cue)
    draft = Draft(bodies)
    if draw.random() < 0.5:
        vx, vy = velocity(draw)
        draft.bodies.append(Body(nx * 6, ny * 6, 1, vx, vy))
    if draw.random() < 0.4:
        draft.walls.append((nx * 11, ny * 11, nx * 11 - ny, ny * 11 + nx))
    return reversal(draft, draw, 0.2)
