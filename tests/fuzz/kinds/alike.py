"""Kinds of scenes with two parts that are alike but for one tiny thing, or alike at any depth."""

from __future__ import annotations

from dataclasses import replace
from random import Random

from fuzz.draft import AXES, PYTHAGOREAN, Body, Draft, F, has_room, mass, reversal, size, span, speed
from fuzz.kinds.brinks import faint, in_long_numbers, without_a_field


def row(draw: Random, n: int, m: object = 1) -> list[Body]:
    """A disc that runs into others, each a little off the line: every blow adds a root to those before it."""
    off = draw.choice([F(1, 7), F(1, 7), F(-1, 9), F(1, 11)])
    return [Body(4 * k, k * off, 1, 0 if k else 1, 0, m) for k in range(n)]


def alike(draw: Random) -> Draft:
    """A row of discs and its image, which differ in one tiny thing: in data, on the way, or in what they come to."""
    ways = ["wall", "walls", "bounce", "glance", "push", "stretch", "pocket", "data", "data", "turn"]
    kind, mirror = draw.choice(ways), draw.random() < 0.5
    n, tiny = draw.choice([2, 2, 3, 4]) if kind != "glance" else draw.choice([1, 2, 3]), faint(draw)
    one, far = Draft(row(draw, n, mass(draw))), 4 * n + draw.choice([2, 5, F(17, 3)])
    other = one.moved(1, 0, 0, 60, mirror=mirror)
    walls = [(far, 0, far, 1)] if draw.random() < 0.7 else []
    first, striker, last = one.bodies[0], other.bodies[0], other.bodies[-1]
    if kind == "wall":  # the image stands a little nearer to a wall that both come to
        other = other.moved(1, 0, tiny, 0)
        walls = [(far, 0, far, 1)]
    elif kind == "walls":  # back to back, each towards a wall of its own
        other = one.moved(-1, 0, -30, draw.choice([0, 60]), mirror=mirror)
        walls = [(far, 0, far, 1), (-30 - far - tiny, 0, -30 - far - tiny, 1)]
    elif kind == "bounce":  # the first discs come back from fixed ones at a little other places
        first.x = striker.x = -5
        first.vx = striker.vx = -1
        one.bodies.append(Body(-9, first.y, 1, m="oo"))
        other.bodies.append(Body(-9 + tiny, striker.y, 1, m="oo"))
    elif kind == "glance":  # the image's first disc brushes past a fixed one
        depth, r, side = F(1, 10 ** draw.choice([145, 150, 160, 180])), size(draw), draw.choice([1, -1])
        first.x = striker.x = -5
        other.bodies.append(Body(-3, striker.y + side * (1 + r - depth), r, m="oo"))
    elif kind == "push":  # a light disc gives the image's first one a little push from behind
        first.x = striker.x = -5
        other.bodies.append(Body(-9, striker.y, F(1, 2), 3, 0, abs(tiny)))
    elif kind == "stretch":  # places and speeds a little larger, the discs not
        radii = [b.r for b in one.bodies]
        other = one.moved(1, 0, 0, 60, mirror=mirror, stretch=1 + tiny)
        other.bodies = [replace(b, r=r) for b, r in zip(other.bodies, radii, strict=True)]
    elif kind == "pocket":  # each has one, a little nearer
        hole = draw.choice([2, 3])
        one.pockets = [(far + hole, one.bodies[-1].y, hole)]
        other.pockets = [(far + hole + tiny, last.y, hole)]
        walls = []
    elif kind == "data":
        key = draw.choice(["x", "vx", "vy", "m", "m", "r", "r"])
        setattr(last, key, getattr(last, key) + tiny)
    else:  # a drift that the mirror should turn round
        other = one.moved(1, 0, 0, 60, mirror=True)
        one.bodies[-1].vy = other.bodies[-1].vy = tiny
    both = replace(one, bodies=one.bodies + other.bodies, walls=walls, pockets=one.pockets + other.pockets)
    both.capture = draw.random() < 0.5
    both.events = draw.randrange(n, 2 * n + 3)
    return reversal(both, draw, 0.15)


def abreast(draw: Random) -> Draft:
    """Two equal rows side by side, each disc touching its like: they fly on together after every blow, at any depth."""
    n = draw.choice([3, 4, 9])
    one = Draft(row(draw, n, mass(draw)))
    nx, ny = draw.choice([(0, 1), (0, -1), (F(3, 5), F(4, 5)), (F(-3, 5), F(4, 5))])
    both = replace(one, bodies=one.bodies + one.moved(1, 0, 2 * nx, 2 * ny).bodies)
    both.events = n - 1
    return both


def lanes(draw: Random) -> Draft:
    """A large disc slides along a wall and strikes pair after pair from both sides at once: it stays at the wall."""
    pairs, heavy, drift = draw.choice([2, 2, 3, 8]), draw.choice([40, 50]), F(1, draw.choice([500, 1000]))
    draft = Draft([Body(0, 0, 10, 1, 0, heavy)], [(0, -10, 1, -10)])
    for k in range(pairs):
        h = draw.choice([3, 4, 5])
        draft.bodies += [Body(12 + 60 * k, side * h, F(1, 2), 0, -side * drift, 1) for side in (1, -1)]
    draft.events = 2 * pairs
    c, s = draw.choice([*AXES, *PYTHAGOREAN[4:12]])
    return draft.moved(c, s, 0, 0)


def strokes(draw: Random) -> Draft:
    """Head-on blows at round times, or next to nothing before or after, in balls that cannot tell."""
    draft = Draft([])
    for k in range(draw.choice([1, 1, 2])):
        time, s, late = draw.choice([F(1, 2), 1, 2, 4, 16]), draw.choice([1, 2]), draw.choice([0, 1, 1, -1])
        way = s * (time + late * F(1, 10 ** draw.choice([80, 90, 100, 120])))
        draft.bodies.append(Body(0, 10 * k, 1, s, 0))
        if k == 0 and draw.random() < 0.4:
            draft.walls.append((way + 1, 0, way + 1, 1))
            break
        draft.bodies.append(Body(way + 2, 10 * k, 1, 0, 0, draw.choice([1, 1, "oo"])))
    draft.until = draw.choice([20, 32])
    return draw.choice([without_a_field, without_a_field, in_long_numbers])(draft)


def dips(draw: Random) -> Draft:
    """A centre that dips into a pocket by next to nothing, grazes it or misses it; and what comes shortly before."""
    time, s, r, hole = span(draw) + 1, speed(draw), draw.choice([1, F(1, 2)]), draw.choice([1, 2, 3])
    depth = draw.choice([0, 1, 1, 1, -1]) * F(1, 10 ** draw.choice([77, 80, 100, 150]))
    draft = Draft([Body(0, 0, r, s, 0, mass(draw))], pockets=[(s * time, hole - depth, hole)])
    early = time * draw.choice([F(1, 2), F(3, 4), F(9, 10), F(99, 100), 1, F(3, 2)])
    for kind in draw.sample(
        ["struck", "struck", "pair", "entry", "wall", "limit", "turn", "dip"], draw.choice([1, 2, 2])
    ):
        if kind == "struck":
            (nx, ny), q, t = draw.choice([(1, 0), *PYTHAGOREAN]), F(1, 2), speed(draw)
            there = Body(s * early + nx * (r + q), ny * (r + q), q, s - nx * t, -ny * t, mass(draw))
            draft.bodies.append(there.back(early))
        elif kind == "pair":
            draft.bodies += [Body(0, 30, 1, 1, 0), Body(2 + early, 30, 1, 0, 0, mass(draw))]
        elif kind == "entry":
            draft.bodies.append(Body(0, -30, 1, 1, 0))
            draft.pockets.append((early + 2, -30, 2))
        elif kind == "wall":
            draft.walls = [(s * early + r, 0, s * early + r, 1)]
        elif kind == "limit":
            draft.until = early
        elif kind == "turn":
            draft.reverse_at = early
        else:
            other = Body(0, 60, r, s, 0)
            draft.bodies.append(other)
            draft.pockets.append((s * early, 60 + hole - abs(depth), hole))
    draft.capture = draw.random() < 0.5
    return draft


def belated(draw: Random) -> Draft:
    """Late in the day a circle bounces, strikes one at rest, and pushes it towards another that it almost touches."""
    power = draw.choice([6, 9, 12])
    time, gap = 10**power, F(1, 10 ** (77 - power + draw.choice([0, 1, 2, 3, 5])))
    (nx, ny), s, q = draw.choice(PYTHAGOREAN[4:]), draw.choice([1, 2, F(1, 2)]), draw.choice([1, F(1, 2)])
    if nx * s < 0:
        nx = -nx
    struck = Body(-5, F(1, draw.randrange(3, 9)), 1, s, 0, mass(draw))
    fixed = Body(struck.x - nx * (1 + q), struck.y - ny * (1 + q), q, m="oo")
    along = 2 * nx * s
    struck.vx, struck.vy = s - along * nx, -along * ny
    bodies, r = [fixed, struck.back(time), Body(0, 0, 1, 0, 0, mass(draw))], draw.choice([1, F(1, 2)])
    mx, my = draw.choice([(1, 0), (F(4, 5), F(3, 5)), (F(4, 5), F(-3, 5)), (F(12, 13), F(-5, 13))])
    away = 1 + r + gap
    bodies.append(Body(mx * away, my * away, r, 0, 0, draw.choice(["oo", mass(draw)])))
    return Draft(bodies, events=draw.randrange(2, 5))


def brushed(draw: Random) -> Draft:
    """A fast circle brushes past a light one just before, when or after it meets another, a wall or a rim."""
    time, s, light = span(draw), draw.choice([1, 10**3, 10**5]), draw.choice([1, F(1, 10**3), F(1, 10**6)])
    late = draw.choice([0, 1, 1, 1, 1, -1]) * F(1, 10 ** draw.choice([40, 74, 76, 77, 78, 79, 80, 82, 100]))
    draft, lead = Draft([Body(0, 0, 1, s, 0, mass(draw))]), s * late
    (nx, ny), r = draw.choice([w for w in PYTHAGOREAN if w[0] > 0 and w[1] != 0]), draw.choice([F(1, 4), F(1, 8)])
    draft.bodies.append(Body(nx * (1 + r), ny * (1 + r), r, 0, 0, light))
    kind = draw.choice(["circle", "circle", "fixed", "wall", "pocket"])
    if kind == "wall":
        draft.walls.append((1 + lead, 0, 1 + lead, 1))
    elif kind == "pocket":
        draft.pockets.append((2 + lead, 0, 2))
    else:
        mx, my = draw.choice([(1, 0), (F(4, 5), F(-3, 5)), (F(4, 5), F(3, 5))])
        other = Body(mx * F(3, 2) + lead, my * F(3, 2), F(1, 2), 0, 0, "oo" if kind == "fixed" else mass(draw))
        if has_room(draft.bodies[1:], other.x, other.y, other.r):
            draft.bodies.append(other)
    draft.bodies = [b.back(time) for b in draft.bodies]
    draft.capture = draw.random() < 0.5
    if kind == "wall":
        draft.bodies = [b for b in draft.bodies if b.x + b.r <= 1 + lead]
    draft.events = draw.randrange(2, 6)
    return in_long_numbers(reversal(draft, draw, 0.2))


def undone(draw: Random) -> Draft:
    """A circle that has bounced grazes another just as that is struck away from it; after more collisions among fixed
    circles all is turned back: the graze and the blow fall on one instant again, behind many roots."""
    draft = Draft([], [(0, 0, 1, 0), (0, 20, 1, 20), (0, 0, 0, 1), (20, 0, 20, 1)])
    time, (s, t) = draw.choice([1, F(3, 2)]), draw.choices([F(1, 2), F(-1, 2), 1, -1, F(2, 3)], k=2)
    nx, ny = draw.choice(PYTHAGOREAN)
    vx, vy = draw.choice([(F(1, 3), F(-1, 2)), (0, 0), (F(-2, 5), F(1, 4))])
    middle = Body(10, 10, F(3, 4), vx, vy, mass(draw))
    blow = Body(10 - nx * F(3, 2), 10 - ny * F(3, 2), F(3, 4), vx + nx * abs(s), vy + ny * abs(s), mass(draw))
    bodies = [middle, blow]
    for mx, my in draw.sample(PYTHAGOREAN, len(PYTHAGOREAN)):
        there = 10 + mx, 10 + my
        if -F(7, 10) < mx * nx + my * ny <= 0 and has_room(bodies, *there, F(1, 4)):
            grazing = Body(*there, F(1, 4), vx - my * t, vy + mx * t, mass(draw))
            bodies.append(grazing)
            break
    since = time / 2
    draft.bodies = [b.back(time) for b in bodies[:2]]
    for b in bodies[2:]:
        ways = [w for w in PYTHAGOREAN if w[0] * b.vx + w[1] * b.vy > 0]
        if not ways:
            continue
        (mx, my), place = draw.choice(ways), b.back(since)
        along = 2 * (mx * b.vx + my * b.vy)
        draft.bodies.append(Body(place.x - mx / 2, place.y - my / 2, F(1, 4), m="oo"))
        place.vx, place.vy = place.vx - along * mx, place.vy - along * my
        draft.bodies.append(place.back(time - since))
    for x, y in [(5, 5), (5, 15), (15, 5), (15, 15)]:
        if has_room(draft.bodies, x, y, 3):
            draft.bodies.append(Body(x, y, 3, m="oo"))
    draft.reverse_after, draft.endless = draw.randrange(8, 14), True
    return in_long_numbers(draft)
