"""Kinds of scenes aimed at the doubles, at sets of contacts far apart, and at circles hemmed in on all sides."""

from __future__ import annotations

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
from fuzz.kinds.contacts import graze_blow
from fuzz.kinds.pockets import entry_ties, on_rim, pressed, rim_instant
from fuzz.kinds.rooms import near_ties, slide


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
