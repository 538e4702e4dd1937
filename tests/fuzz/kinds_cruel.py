"""Kinds of scenes aimed at what decides near zero: hairs at the doubles, brinks at the proofs of zero."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from random import Random

from fuzz.draft import (
    HEX,
    PYTHAGOREAN,
    ROOT3,
    Body,
    Draft,
    F,
    Number,
    Vector,
    directions,
    flaw,
    has_room,
    mass,
    reversal,
    size,
    span,
    speed,
    velocity,
)
from fuzz.kinds_contacts import cluster, graze_blow
from fuzz.kinds_pockets import entry_ties, on_rim, pressed, rim_instant
from fuzz.kinds_rooms import near_ties, slide
from fuzz.kinds_symmetry import mirrored, neighbours, onto_pair, ring

TINY = F(1, 10**100)
EDGE = (66, 70, 72, 73, 74, 75, 76, 77, 100)
"""Powers of ten about the precision at which the engine begins, 2**-256: told at first, and no more some events on."""


def edge(draw: Random) -> Fraction:
    """A flaw at the edge of what balls tell, of either sign."""
    return draw.choice([1, -1]) * F(1, 10 ** draw.choice(EDGE))


def hair(draw: Random) -> Fraction:
    """A relative number about the rounding of doubles, of either sign; sometimes zero."""
    return draw.choice([1, -1, 1, -1, 0]) * F(
        draw.randrange(1, 10), 10 ** draw.choice([12, 13, 14, 15, 16, 17, 18, 18])
    )


def hairs(draw: Random) -> Draft:
    """Meetings a hair from a graze, a rim, or each other's time, at huge and tiny scales, with late clocks."""
    if draw.random() < 0.5:
        return draw.choice([_far_off, _far_off, _far_walls, _shallow])(draw)
    unit = F(10) ** draw.choice([-7, -3, 0, 0, 0, 4, 9])
    time = draw.choice([1, F(7, 3), F(7, 3), F(1000, 7), F(10**6, 3), F(10**9, 7)])
    draft, between = Draft([]), 60 * unit * draw.choice([1, 1, 10**6])
    for k in range(draw.choice([1, 2, 2, 3])):
        vx, vy = velocity(draw)
        swift, start = unit * draw.choice([0, 0, 0, 1, 10**3, 10**6, 10**6]), len(draft.bodies)
        _meeting(draft, draw, (0, k * between), (vx * swift, vy * swift), unit, time)
        if draw.random() < 0.7 and not draft.walls and not draft.pockets:  # from near the origin to far away
            for body in draft.bodies[start:]:
                body.x, body.y = body.x + vx * swift * time, body.y + vy * swift * time
    draft.capture = draw.random() < 0.5
    if draw.random() < 0.4:
        draft.until = time * (1 + draw.choice([0, hair(draw), 1]))
    if draw.random() < 0.15:
        draft.reverse_at = time * (1 + draw.choice([0, hair(draw), F(1, 2)]))
    return draft


def _far_off(draw: Random) -> Draft:
    """Coincidences with a flaw or without, as another kind makes them, far from the origin."""
    draft = draw.choice([rim_instant, rim_instant, on_rim, entry_ties, slide, pressed, near_ties, graze_blow])(draw)
    c, s = draw.choice([(1, 0), (F(3, 5), F(4, 5)), (F(5, 13), F(12, 13))])
    return draft.moved(c, s, F(10) ** draw.choice([3, 6, 9]) / 7, -(F(10) ** draw.choice([0, 6, 8])) / 13)


def _far_walls(draw: Random) -> Draft:
    """Ties and flaws at walls that are given by points far away."""
    draft = draw.choice([entry_ties, pressed, slide, rim_instant, near_ties])(draw)
    c, s = draw.choice([(F(3, 5), F(4, 5)), (F(5, 13), F(12, 13)), (F(1, 2), ROOT3 / 2)])
    draft, far = draft.moved(c, s, 0, 0), draw.choice([10**6, 10**9, -(10**9)]) / F(7)
    draft.walls = [(a + far * (p - a), b + far * (q - b), p + far * (p - a), q + far * (q - b))
                   for a, b, p, q in draft.walls]  # fmt: skip
    return draft


def _shallow(draw: Random) -> Draft:
    """Pairs that barely hit, at one time or a hair apart."""
    time, draft = draw.choice([1, F(1, 3), F(1, 7)]), Draft([])
    for k in range(draw.choice([2, 3])):
        (nx, ny), r, q, s = draw.choice(PYTHAGOREAN + HEX), size(draw), size(draw), speed(draw)
        t, late = draw.choice([1, -1]) * s * 10 ** draw.choice([3, 4, 4, 5]), draw.choice([0, 0, hair(draw)])
        vx, vy = velocity(draw)
        pair = [Body(0, 40 * k, r, vx, vy, mass(draw))]
        ux, uy = vx - nx * s - ny * t, vy - ny * s + nx * t
        pair.append(Body(nx * (r + q), 40 * k + ny * (r + q), q, ux, uy, mass(draw)))
        draft.bodies += [b.back(time * (1 + late)) for b in pair]
    draft.events = draw.randrange(1, 4)
    return draft


def _meeting(draft: Draft, draw: Random, at: Vector, drift: Vector, unit: Number, time: Number) -> None:
    """One meeting near a place, led back."""
    (nx, ny), r, q = draw.choice(directions(draw)), size(draw) * unit, size(draw) * unit
    s = speed(draw) * unit * draw.choice([1, 1, 1, F(1, 1000), 10**3])
    x, y = at
    t = draw.choice([0, s, -s, 10**4 * s, -(10**4) * s, 10**6 * s])
    kind = draw.choice(["graze", "graze", "tie", "tie", "tie", "rim", "rim", "wall", "close"])
    late = time * hair(draw) if kind in ("tie", "wall") or draw.random() < 0.3 else 0
    if kind in ("rim", "wall"):
        drift = 0, 0
    a = Body(x, y, r, *drift, mass(draw))
    bodies = [a]
    if kind == "graze":
        far, way = (r + q) * (1 + hair(draw)), draw.choice([1, -1])
        vx, vy = drift[0] - ny * s * way, drift[1] + nx * s * way
        bodies.append(Body(x + nx * far, y + ny * far, q, vx, vy, mass(draw)))
    elif kind == "tie":
        vx, vy = drift[0] - nx * s - ny * t, drift[1] - ny * s + nx * t
        bodies.append(Body(x + nx * (r + q), y + ny * (r + q), q, vx, vy, mass(draw)))
    elif kind == "close":
        pass
    elif kind == "rim":
        inward = draw.choice([0, 0, s])
        a.vx, a.vy = nx * inward - ny * s, ny * inward + nx * s
        hole = q * draw.choice([1, 3])
        away = hole * (1 + (hair(draw) if inward == 0 else 0))
        draft.pockets.append((x + nx * away, y + ny * away, hole))
    else:
        a.vx, a.vy = s, 0
        if not draft.walls:
            draft.walls.append((x + r, y - 10 * time * unit, x + r, y + unit))
    if kind == "close":  # next to each other at time 0, and a little nearer every moment
        far, s = (r + q) * (1 + F(1, 10**40)), s * draw.choice([1, -1])
        towards = abs(s) / 10 ** draw.choice([15, 16, 17, 18])
        vx, vy = drift[0] - nx * towards - ny * s, drift[1] - ny * towards + nx * s
        draft.bodies += [a, Body(x + nx * far, y + ny * far, q, vx, vy, mass(draw))]
        return
    for body in bodies:
        _lead_back(draft, draw, body, time + late)


def _lead_back(draft: Draft, draw: Random, body: Body, time: Number) -> None:
    """Straight back, or by way of a fixed circle that it bounces off before."""
    if draw.random() < 0.6 or (body.vx == 0 and body.vy == 0):
        draft.bodies.append(body.back(time))
        return
    since = time * draw.choice([F(1, 2), F(1, 3), F(1, 1000), F(999, 1000)])
    ways = [(x, y) for x, y in [*PYTHAGOREAN, *HEX] if float(x * body.vx + y * body.vy) > 0]
    (mx, my), struck = draw.choice(ways), body.back(since)
    along = 2 * (mx * body.vx + my * body.vy)
    r = body.r * draw.choice([1, 1, F(1, 3)])
    draft.bodies.append(Body(struck.x - mx * (struck.r + r), struck.y - my * (struck.r + r), r, m="oo"))
    struck.vx, struck.vy = struck.vx - along * mx, struck.vy - along * my
    draft.bodies.append(struck.back(time - since))


def brinks(draw: Random) -> Draft:
    """Symmetric scenes of many roots, spoilt by next to nothing: what is nearly zero lies beyond the balls at hand."""
    makers = [couple, couple, couple, boxes, boxes, boxes, _spoilt, _spoilt, again, rims, rims]
    draft = draw.choice(makers)(draw)
    if draw.random() < 0.2 and not draft.pockets:  # all the way there and back
        draft.reverse_after, draft.reverse_at = None, draw.choice([5, 10, F(49, 3), 25, 40])
        draft.until, draft.events, draft.endless = None, None, True
    draft.endless = draft.endless and not draft.pockets  # a rim at the return is beyond the engine's proofs
    return draft


def _spoilt(draw: Random) -> Draft:
    draft = draw.choice([mirrored, neighbours, neighbours, ring, onto_pair])(draw)
    return spoil(draft, draw)


def spoil(draft: Draft, draw: Random, start: int = 0) -> Draft:
    """A flaw in one number of one circle from `start` on, of a pocket, or of a wall."""
    tiny = edge(draw)
    kind = draw.choice(["body", "body", "body", "pocket", "wall"])
    if kind == "pocket" and draft.pockets:
        x, y, r = draft.pockets[-1]
        draft.pockets[-1] = draw.choice([(x + tiny, y, r), (x, y + tiny, r), (x, y, r + tiny)])
        return draft
    if kind == "wall" and draft.walls:
        a, b, p, q = draft.walls[-1]
        draft.walls[-1] = draw.choice([(a + tiny, b, p + tiny, q), (a, b + tiny, p, q + tiny), (a + tiny, b, p, q)])
        return draft
    body = draw.choice([b for b in draft.bodies[start:] if b.m != "oo"] or draft.bodies)
    if body.m != "oo":
        key = draw.choice(["x", "y", "vx", "vy", "m", "r"])
        setattr(body, key, getattr(body, key) + tiny)
    return draft


def couple(draw: Random) -> Draft:
    """A scene on the left of its own wall, and its image on the right of another, whole or spoilt."""
    one = draw.choice([graze_blow, cluster, onto_pair, _striker, _striker])(draw)
    one = Draft([replace(b) for b in one.bodies[:4]], endless=False)
    vx, vy = draw.choice([(1, 0), (1, F(1, 3)), (2, F(-1, 2)), (0, 0)])
    one.bodies = [replace(b, x=b.x - 30, vx=b.vx + vx, vy=b.vy + vy) if b.m != "oo" else b for b in one.bodies]
    if any(b.m == "oo" for b in one.bodies):
        one.bodies = [replace(b, x=b.x - 30, vx=b.vx - vx, vy=b.vy - vy) if b.m != "oo" else replace(b, x=b.x - 30)
                      for b in one.bodies]  # fmt: skip
    if draw.random() < 0.6:
        b, hole = draw.choice(one.bodies), draw.choice([1, 2, 5])
        far = draw.choice([1, 2, 3])
        one.pockets.append((b.x + b.vx * far + hole, b.y + b.vy * far + draw.choice([0, 0, hole]), hole))
    one.walls = [draw.choice([(-14, 0, -14, 1), (-18, 0, -18, 1), (-10, 0, -12, 40)])]
    c, mirror = draw.choice([(-1, False), (1, True), (-1, False)])
    other = one.moved(c, 0, 0, draw.choice([0, 7]), mirror=mirror) if not mirror else _across(one)
    kind = draw.choice(["none", "spoil", "spoil", "spoil", "stretch", "role"])
    if kind == "spoil":
        other = spoil(other, draw)
    elif kind == "stretch":
        radii = [b.r for b in other.bodies]
        other = other.moved(1, 0, 0, 0, stretch=1 + edge(draw))
        other.bodies = [replace(b, r=r) for b, r in zip(other.bodies, radii, strict=True)]
        other.walls, other.pockets = _across(one).walls if mirror else other.walls, other.pockets
    elif kind == "role" and len(other.bodies) > 1:
        other.bodies[-1].m = F(7, 3)
    both = replace(one, bodies=one.bodies + other.bodies, walls=one.walls + other.walls)
    both.pockets = one.pockets + other.pockets
    both.capture = draw.random() < 0.5
    return reversal(both, draw, 0.3)


def _across(draft: Draft) -> Draft:
    """Left and right exchanged."""
    return replace(
        draft,
        bodies=[replace(b, x=-b.x, vx=-b.vx) for b in draft.bodies],
        walls=[(-a, b, -p, q) for a, b, p, q in draft.walls],
        pockets=[(-x, y, r) for x, y, r in draft.pockets],
    )


def boxes(draw: Random) -> Draft:
    """A few circles in a box, and their image in another, whole or spoilt: ties after more roots than are nested."""
    one = Draft([])
    for _ in range(draw.choice([2, 3, 3, 4])):
        r = F(draw.randrange(4, 12), 10)
        x, y = -F(draw.randrange(30, 110), 10) - F(draw.randrange(50), 97), F(draw.randrange(-40, 40), 10)
        if has_room(one.bodies, x, y, r):
            vx, vy = F(draw.randrange(-20, 21), 7), F(draw.randrange(-20, 21), 9)
            one.bodies.append(Body(x, y, r, vx, vy, mass(draw)))
    one.walls = [(-13, 0, -13, 1), (-1, 0, -1, 1)]
    if draw.random() < 0.3:
        one.pockets.append((-F(draw.randrange(2, 13)), F(draw.randrange(-6, 6)), F(1, 2)))
    other = _across(one) if draw.random() < 0.6 else one.moved(-1, 0, 0, 0)
    if draw.random() < 0.6:
        other = spoil(other, draw)
    elif draw.random() < 0.5:  # two things exchanged: alike at first sight only
        a, b = other.bodies[0], other.bodies[-1]
        key = draw.choice(["m", "m", "r", "vx"])
        mine, theirs = getattr(a, key), getattr(b, key)
        setattr(a, key, theirs)
        setattr(b, key, mine)
    both = replace(one, bodies=one.bodies + other.bodies, pockets=one.pockets + other.pockets)
    both.walls = [*one.walls, *other.walls, (0, 6, 1, 6), (0, -6, 1, -6)]
    both.capture = draw.random() < 0.5
    both.events = draw.randrange(4, 17)
    return reversal(both, draw, 0.15)


def _striker(draw: Random) -> Draft:
    """A pair that strikes a third from both sides, so that it moves on along the axis with roots in its speed."""
    h, m = draw.choice([F(1, 2), 1, F(3, 4)]), mass(draw)
    slope = draw.choice([F(1, 3), F(1, 5), F(1, 2)])
    pair = [Body(-5, 1 + h, 1, 1, -slope, m), Body(-5, -1 - h, 1, 1, slope, m)]
    return Draft([*pair, Body(0, 0, 1, 0, 0, mass(draw))])


def rims(draw: Random) -> Draft:
    """A circle is struck onto the axis of a symmetric scene, and comes to rims at it just as it comes to a wall."""
    draft = _striker(draw)
    wall, tiny = draw.choice([9, 12, 20]), edge(draw)
    draft.walls.append((wall, 0, wall, 1))
    for side in draw.choice([(1,), (1,), (-1,), (1, -1)]):
        reach, h, r = draw.choice([(4, 3, 5), (12, 5, 13), (0, 5, 5), (0, 5, 5), (F(3, 5), F(4, 5), 1)])
        late, lower, far = draw.choice([0, tiny, tiny]), draw.choice([0, 0, tiny]), draw.choice([0, 0, 2])
        if reach == 0:  # a rim that the axis grazes; perhaps behind the wall
            lower, far = draw.choice([0, tiny, tiny]), draw.choice([0, 2, 2])
        draft.pockets.append((wall - 1 + reach + late + far, side * (h + lower), r))
    if draw.random() < 0.3:
        draft.bodies.append(Body(-2, 60, 1, 1, 0, mass(draw)))
    draft.capture = draw.random() < 0.5
    draft.events = draw.randrange(2, 7)
    return reversal(draft, draw, 0.15)


def again(draw: Random) -> Draft:
    """Struck onto the axis with roots in its speed, a circle grazes a fixed one, and again after a wall askew."""
    draft = _striker(draw)
    q, tiny = draw.choice([1, 2]), draw.choice([0, edge(draw), edge(draw)])
    draft.bodies.append(Body(draw.choice([6, 7]), draw.choice([1, -1]) * (1 + q), q, m="oo"))
    draft.walls.append((15, 0, 15 + tiny, 1))
    if draw.random() < 0.5:
        draft.bodies.append(Body(12, draw.choice([2, -2]) + draw.choice([0, tiny]), 1, m="oo"))
    if draw.random() < 0.4:
        draft.pockets.append((10, draw.choice([3, -3]) + draw.choice([0, tiny]), 3))
    draft.events = draw.randrange(3, 9)
    draft.until = draw.choice([None, 3 * span(draw) + 40])
    return reversal(draft, draw, 0.25)


def home(draw: Random) -> Draft:
    """A box in which things touch, tie, or nearly do, early on; after more collisions all is turned back, and ends at
    the return: what was one instant is to be known as one again, at any depth."""
    draft = Draft([], [(0, 0, 1, 0), (0, 14, 1, 14), (0, 0, 0, 1), (15, 0, 15, 1)])
    time = draw.choice([F(1, 2), F(1, 3), 1])
    pairs = draw.choice([1, 2, 2])
    for k in range(pairs):
        (nx, ny), r = draw.choice(PYTHAGOREAN), draw.choice([F(1, 2), F(3, 4), 1])
        x, y, s = F(4 + draw.randrange(2)), F(4 + 6 * k), speed(draw)
        late = draw.choice([0, 0, 0, time, time, time, TINY, time + TINY])
        aside = draw.choice([0, s, -s]) if draw.random() < 0.4 else 0
        s = draw.choice([s, s, s, 0])
        vx, vy = draw.choice([(F(1, 3), F(-1, 2)), (0, 0), (1, F(2, 7)), (F(-2, 5), 1)])
        one = Body(x, y, r, vx, vy, mass(draw))
        ux, uy = vx - nx * s - ny * aside, vy - ny * s + nx * aside
        if late == 0:  # they part at time 0, or graze, or last
            part = draw.choice([-1, -1, 0])
            ux, uy = vx - part * nx * s - ny * aside, vy - part * ny * s + nx * aside
        other = Body(x + 2 * r * nx, y + 2 * r * ny, r, ux, uy, mass(draw))
        draft.bodies += [one.back(late), other.back(late)]
        if draw.random() < 0.6:  # a third meets one of them at that instant, at right angles or not
            beside = draw.choice([one, other])
            mx, my = draw.choice([(-ny, nx), (ny, -nx), draw.choice(PYTHAGOREAN)])
            there, speed_on = (beside.x + mx * (r + F(1, 2)), beside.y + my * (r + F(1, 2))), draw.choice([s, s, -s, 0])
            if has_room([one, other], *there, F(1, 2)):
                third = Body(*there, F(1, 2), beside.vx - mx * speed_on, beside.vy - my * speed_on, mass(draw))
                draft.bodies.append(third.back(late + draw.choice([0, 0, 0, TINY])))
    for _ in range(draw.choice([1, 1, 2])):
        x, y = F(draw.randrange(80, 140), 10), F(draw.randrange(10, 130), 10)
        if has_room(draft.bodies, x, y, F(2, 3)):
            vx, vy = F(draw.randrange(-9, -2), 4), F(draw.randrange(-9, 9), 5)
            draft.bodies.append(Body(x, y, F(2, 3), vx, vy, mass(draw)))
    if draw.random() < 0.2:
        draft.pockets.append((F(draw.randrange(2, 13)), F(draw.randrange(2, 13)), F(1, 2)))
        draft.capture = draw.random() < 0.6
    draft.reverse_after = draw.randrange(3, 11)
    draft.endless = True
    return draft


def apart(draw: Random) -> Draft:
    """Two or three clusters far from each other whose contacts come at one instant, some of them touching at time 0."""
    if draw.random() < 0.2:
        return sent_back(draw)
    time = draw.choice([0, 0, span(draw)])
    draft = Draft([])
    for k in range(draw.choice([2, 2, 3])):
        draft.bodies += [b.back(time) for b in _struck(draw, 40 * k)]
    if time == 0 and draw.random() < 0.6:  # a wall that a circle leaves, or comes to, at once
        body = draw.choice(draft.bodies)
        side = draw.choice([1, -1])
        draft.walls.append((body.x + side * body.r, 0, body.x + side * body.r, 1))
        draft.bodies = [b for b in draft.bodies if float(side * (b.x - body.x)) < float(body.r - b.r) + 1e-9]
        body.vx = draw.choice([-side * speed(draw), -side * speed(draw), body.vx])
        if draw.random() < 0.7:  # and one that sends it back there
            away = body.x - side * (body.r + 1 + speed(draw))
            if has_room(draft.bodies, away, body.y, 1):
                draft.bodies.append(Body(away, body.y, 1, side * speed(draw), 0, draw.choice([1, 2, 5])))
                body.vy = 0
    if time and draw.random() < 0.3:
        draft.reverse_at = time + draw.choice([0, flaw(draw)])
    return reversal(draft, draw, 0.3)


def sent_back(draw: Random) -> Draft:
    """A blow from two sides on a circle that others touch aside, or graze; all is turned back at its very instant."""
    m, s, v = mass(draw), speed(draw), speed(draw)
    (c, h), time = draw.choice([(F(4, 5), F(3, 5)), (F(3, 5), F(4, 5)), (F(12, 13), F(5, 13))]), span(draw)
    bodies = [Body(0, 0, 1, 0, 0, mass(draw))]
    bodies += [Body(-c * F(3, 2), side * h * F(3, 2), F(1, 2), s, 0, m) for side in (1, -1)]
    if not has_room(bodies[1:2], bodies[2].x, bodies[2].y, bodies[2].r):
        bodies[2:] = []
    for nx, ny in draw.sample(PYTHAGOREAN, 5):
        r = draw.choice([F(1, 4), F(1, 8)])
        if nx < 0 and has_room(bodies, nx * (1 + r), ny * (1 + r), r):
            bodies.append(Body(nx * (1 + r), ny * (1 + r), r, 0, 0, mass(draw)))
    for ny in draw.choice([(1,), (-1,), (1, -1)]):
        if has_room(bodies, 0, ny * F(3, 2), F(1, 2)):
            bodies.append(Body(0, ny * F(3, 2), F(1, 2), draw.choice([v, -v]), 0, mass(draw)))
    draft = Draft([b.back(time) for b in bodies])
    if draw.random() < 0.5:
        draft.reverse_after = 1
    else:
        draft.reverse_at = time
    return draft


def _struck(draw: Random, y: Number) -> list[Body]:
    """A circle with others around it, hard upon it, slow, lasting or parting; and on these some that graze or last."""
    ways, middle = draw.choice([PYTHAGOREAN, PYTHAGOREAN, HEX]), Body(0, y, 1, *velocity(draw), mass(draw))
    bodies = [middle]
    for nx, ny in draw.sample(ways, draw.choice([2, 2, 3])):
        r, s = draw.choice([1, F(1, 2), F(1, 3)]), draw.choice([speed(draw), speed(draw), F(1, 10), 0, 0, -speed(draw)])
        if has_room(bodies, nx * (1 + r), y + ny * (1 + r), r):
            there = nx * (1 + r), y + ny * (1 + r)
            bodies.append(Body(*there, r, middle.vx - nx * s, middle.vy - ny * s, mass(draw)))
    for beside in bodies[1:]:
        (nx, ny), r, s = draw.choice(ways), draw.choice([1, F(1, 2)]), draw.choice([0, 1, -1]) * speed(draw)
        x, far = beside.x + nx * (beside.r + r), beside.y + ny * (beside.r + r)
        if draw.random() < 0.4 and has_room(bodies, x, far, r):
            bodies.append(Body(x, far, r, beside.vx - ny * s, beside.vy + nx * s, mass(draw)))
    return bodies


def _points(draw: Random) -> Draft:
    """Points that meet in one place of one or two walls, or at a fixed circle, at one instant."""
    time, (c, s) = span(draw), draw.choice(PYTHAGOREAN[4:])
    ways = [v for v in (velocity(draw) for _ in range(6)) if float(v[0]) > 0][: draw.choice([2, 3])]
    draft = Draft([Body(0, 0, 0, *v, mass(draw), True).back(time + draw.choice([0, 0, 0, flaw(draw)])) for v in ways])
    draft.walls = draw.choice([[(0, 0, 0, 1)], [(0, 0, 0, 1), (0, 0, s, c)], []])
    if not draft.walls:
        draft.bodies.append(Body(1, 0, 1, m=draw.choice([1, 3, "oo"])))
    draft.policy = draw.choice(["simultaneous", "sequential:order=scene", "sequential:seed=1", "sequential:seed=1"])
    if draft.policy.endswith("seed=1"):
        draft.policy = f"sequential:seed={draw.randrange(100)}"
    draft.events = draw.randrange(1, 5)
    return reversal(draft, draw, 0.2)


def pits(draw: Random) -> Draft:
    """One or two circles that meet more fixed circles, walls and partners at once than they can move in directions."""
    if draw.random() < 0.3:
        return _points(draw)
    ways = draw.choice([PYTHAGOREAN, PYTHAGOREAN, HEX])
    time, (vx, vy) = draw.choice([0, span(draw), span(draw)]), draw.choice(PYTHAGOREAN)
    first = Body(0, 0, 1, vx, vy, mass(draw))
    movers, rest = [first], []
    if draw.random() < 0.5:
        nx, ny = draw.choice(ways)
        movers.append(Body(2 * nx, 2 * ny, 1, vx, vy, mass(draw)))
    for _ in range(draw.choice([2, 3, 4, 5])):
        on, (nx, ny) = draw.choice(movers), draw.choice(ways)
        r = draw.choice([F(1, 3), F(1, 4), 1])
        x, y = on.x + nx * (1 + r), on.y + ny * (1 + r)
        if float(nx * vx + ny * vy) < 0.05 or not has_room([*movers, *rest], x, y, r):
            continue
        if draw.random() < 0.25:
            rest.append(Body(x, y, r, draw.choice([0, -nx]), draw.choice([0, -ny]), mass(draw)))
        else:
            rest.append(Body(x, y, r, m="oo"))
    draft = Draft([b.back(time) for b in [*movers, *rest]])
    ahead = [b for b in movers if all(float(vx * (b.x - o.x) + vy * (b.y - o.y)) > -1e-9 for o in movers)]
    if draw.random() < 0.5 and ahead:
        b = ahead[0]
        x, y = b.x + vx * b.r, b.y + vy * b.r
        if all(float((x - o.x) * vx + (y - o.y) * vy) > float(o.r) - 1e-9 for o in rest):
            draft.walls.append((x, y, x - vy, y + vx))
    draft.events = draw.randrange(1, 4)
    return reversal(draft, draw, 0.2)
