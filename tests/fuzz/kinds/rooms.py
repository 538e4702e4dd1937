"""Kinds of scenes with floors, corners, gaps and boxes, with obstacles and points."""

from __future__ import annotations

from random import Random

from fuzz.draft import (
    AXES,
    PYTHAGOREAN,
    Body,
    Draft,
    F,
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
from truebreak.scenarios.catalogue.scene_entry import cosine, sine


def slide(draw: Random) -> Draft:
    """Circles that roll on a floor between two ends, some in a heap, some in the air above."""
    draft, x = Draft([], [(0, 0, 1, 0)]), F(0)
    for _ in range(draw.choice([1, 2, 3, 3])):
        r = size(draw)
        x += r
        draft.bodies.append(Body(x, r, r, draw.choice([0, 1, -1, 2, F(3, 7), F(-5, 11)]), 0, mass(draw)))
        x += r + draw.choice([0, 0, 1, F(1, 3), 2])
    if draw.random() < 0.6:
        draft.walls += [(-draw.choice([0, 1, 2]), 0, -draw.choice([0, 1, 2]), 1), (x + 1, 0, x + 1, 1)]
        draft.walls[1] = (draft.walls[1][0], 0, draft.walls[1][0], 1)
    if draw.random() < 0.3:
        draft.walls.append((0, 12, 1, 12))
    for _ in range(draw.randrange(3)):
        r, x, y = size(draw), draw.randrange(0, 8), draw.choice([4, 5, 6, F(9, 2)])
        if has_room(draft.bodies, x, y, r):
            draft.bodies.append(Body(x, y, r, *draw.choice([(0, -1), (0, -1), (1, -1), (-1, -2), (0, 0)]), mass(draw)))
    if draw.random() < 0.2:  # barely not on the floor
        b = draw.choice(draft.bodies)
        b.y += abs(flaw(draw))
    if draw.random() < 0.2:
        b = draw.choice(draft.bodies)
        b.vy += flaw(draw)
    return reversal(draft, draw, 0.25)


def corner(draw: Random) -> Draft:
    """Two walls at 90, 60, 45 or 36 degrees; a circle in their corner or on its way there, and who strikes it."""
    angle = draw.choice([90, 90, 60, 60, 45, 36])
    c, s = cosine(angle), sine(angle)  # the walls lie half the angle to each side
    r = draw.choice([1, 1, F(1, 2)])
    walls = [(0, 0, c, s), (0, 0, c, -s)]
    bodies = []
    time = draw.choice([0, 1, 2, 3])
    kind = draw.choice(["into", "into", "struck", "slide"])
    if kind == "into":
        bodies.append(Body(r / s + time, 0, r, -1, 0, mass(draw)))
        if draw.random() < 0.5:
            bodies.append(Body(r / s + time + 2 * r + draw.choice([0, 0, 1, flaw(draw) ** 2]), 0, r, -1))
    elif kind == "struck":
        bodies += [Body(r / s, 0, r, 0, 0, mass(draw)), Body(r / s + 4 + time, 0, r, -1, 0, mass(draw))]
    else:  # along one wall into the other
        v = draw.choice([1, 2])
        bodies.append(Body(r / s + c * v * time, s * v * time, r, -c * v, -s * v))
    if draw.random() < 0.3:
        k = draw.randrange(len(bodies))
        bodies[k].y += flaw(draw)
    if draw.random() < 0.3:
        walls.append((12, 0, 12, 1))
    if draw.random() < 0.2:
        bodies.append(Body(9, draw.choice([0, 1]), 1, draw.choice([-1, 0, 1]), 0))
    return reversal(Draft(bodies, walls), draw, 0.3)


def wedged(draw: Random) -> Draft:
    """A column that just fills the gap between two walls, at rest or sliding, and a circle that strikes it."""
    radii = [size(draw) for _ in range(draw.choice([1, 2, 2, 3]))]
    tall, y = sum(2 * r for r in radii), F(0)
    draft = Draft([], [(0, 0, 1, 0), (0, tall, 1, tall)])
    v = draw.choice([0, 0, 1, 2])
    for r in radii:
        draft.bodies.append(Body(0, y + r, r, v, 0, mass(draw)))
        y += 2 * r
    for _ in range(draw.choice([1, 1, 2])):
        r = draw.choice([F(1, 2), F(1, 4), radii[0]])
        x, y = draw.choice([-7, -5, 6, 8]), draw.choice([r, tall / 2, tall - r, radii[0]])
        if y >= r and tall - y >= r and has_room(draft.bodies, x, y, r):
            vx = draw.choice([1, 2, 3]) * (1 if x < 0 else -1)
            draft.bodies.append(Body(x, y, r, vx, draw.choice([0, 0, F(1, 2), -1]), mass(draw)))
    if draw.random() < 0.4:
        draft.walls += [(-10, 0, -10, 1), (11, 0, 11, 1)]
    if draw.random() < 0.2:
        draft.walls[1] = (0, tall + 1 / F(10**40), 1, tall + 1 / F(10**40))
    if draw.random() < 0.15:
        draft.bodies[0].vx += flaw(draw)
    return reversal(draft, draw, 0.15)


def gas(draw: Random) -> Draft:
    """Circles anywhere in a box, with speeds of any small fractions."""
    draft = Draft([], [(0, 0, 1, 0), (0, 12, 1, 12), (0, 0, 0, 1), (12, 0, 12, 1)])
    for _ in range(draw.choice([2, 3, 4, 5, 6])):
        r = F(draw.randrange(3, 14), 10)
        x, y = (F(draw.randrange(14, 106), 10) + F(draw.randrange(100), 997) for _ in "xy")
        if has_room(draft.bodies, x, y, r):
            vx, vy = (F(draw.randrange(-20, 21), draw.randrange(3, 12)) for _ in "xy")
            draft.bodies.append(Body(x, y, r, vx, vy, F(draw.randrange(1, 9), draw.randrange(1, 4))))
    if draw.random() < 0.3:
        draft.walls = draft.walls[:2]
    return reversal(draft, draw, 0.2)


def grid(draw: Random) -> Draft:
    """Circles on a grid with speeds of few values."""
    side, r = draw.choice([3, 4, 5]), draw.choice([F(1, 2), F(1, 2), F(1, 4), F(1, 3), F(2, 5)])
    cells = [(x, y) for x in range(side) for y in range(side)]
    draft = Draft([])
    for x, y in draw.sample(cells, draw.choice([2, 3, 3, 4, 4, 5, 6, 7])):
        m = draw.choice([1, 1, 1, 1, 2, 3, "oo"])
        vx, vy = (0, 0) if m == "oo" else (draw.choice([-1, 0, 0, 1, 2]), draw.choice([-1, 0, 0, 1]))
        draft.bodies.append(Body(F(x), F(y), r, vx, vy, m))
    if draw.random() < 0.6:
        low, high = -draw.choice([1, 2]), side + draw.choice([1, 2, F(1, 2)])
        draft.walls = [(low, 0, low, 1), (high, 0, high, 1), (0, low, 1, low), (0, high, 1, high)]
    return reversal(draft, draw, 0.3)


def near_ties(draw: Random) -> Draft:
    """Pairs that meet far from each other, at one time, or a flaw apart; then they may meet each other."""
    draft, time = Draft([]), span(draw)
    for k in range(draw.choice([2, 3])):
        (nx, ny), r = draw.choice(directions(draw)), draw.choice([1, F(1, 2)])
        late = draw.choice([0, 0, flaw(draw), F(1, 10**9)])
        off = draw.choice([0, 0, r])
        left, right = Body(0, 40 * k, r, speed(draw), 0), Body(0, 40 * k, r, -speed(draw), 0, mass(draw))
        left.x, right.x = nx * r, -nx * r
        left.y, right.y = 40 * k + ny * r, 40 * k - ny * r
        left.vx, left.vy, right.vx, right.vy = -nx, -ny + off, nx * 2, ny * 2
        draft.bodies += [left.back(time + late), right.back(time + late)]
    if draw.random() < 0.4:
        wall = draw.choice([10, 20])
        draft.walls = [(-wall, 0, -wall, 1), (wall, 0, wall, 1)]
    draft.until = draw.choice([None, None, time, time + flaw(draw)])
    if draw.random() < 0.2:
        draft.reverse_at = time + draw.choice([0, flaw(draw)])
    return draft


def points(draw: Random) -> Draft:
    """Points among circles and walls: they pass through each other, and bounce off everything else."""
    draft = Draft([])
    if draw.random() < 0.4:  # two points that meet, perhaps exactly
        time, (vx, vy) = span(draw), velocity(draw)
        draft.bodies += [Body(-vx * time, -vy * time, 0, vx, vy, 1, True)]
        (ux, uy), late = velocity(draw), draw.choice([0, 0, flaw(draw)])
        draft.bodies += [Body(-ux * time, -uy * time + late, 0, ux, uy, mass(draw), True)]
    for _ in range(draw.choice([1, 2, 3])):
        x, y = draw.randrange(-7, 8), draw.randrange(-7, 8)
        if has_room(draft.bodies, x, y, F(1, 8)):
            draft.bodies.append(Body(x, y, 0, *velocity(draw), mass(draw), True))
    for _ in range(draw.choice([1, 2, 3])):
        x, y, r = draw.randrange(-7, 8), draw.randrange(-7, 8), size(draw)
        if has_room(draft.bodies, x, y, r):
            m = draw.choice([1, 1, 2, "oo"])
            draft.bodies.append(Body(x, y, r, *((0, 0) if m == "oo" else velocity(draw)), m))
    if draw.random() < 0.7:
        draft.walls = [(-9, 0, -9, 1), (9, 0, 9, 1), (0, -9, 1, -9), (0, 9, 1, 9)]
    return reversal(draft, draw, 0.2)


def obstacles(draw: Random) -> Draft:
    """Balls among fixed circles, some of them touching, some held between two."""
    draft = Draft([])
    ways = directions(draw)
    for _ in range(draw.choice([1, 2, 3])):
        if draft.bodies and draw.random() < 0.5:
            beside, (nx, ny) = draw.choice(draft.bodies), draw.choice(ways)
            r = size(draw)
            gap = beside.r + r + draw.choice([0, 1, 2])
            x, y = beside.x + nx * gap, beside.y + ny * gap
        else:
            x, y, r = draw.randrange(-4, 5), draw.randrange(-4, 5), size(draw)
        if has_room(draft.bodies, x, y, r):
            draft.bodies.append(Body(x, y, r, m="oo"))
    for _ in range(draw.choice([1, 2, 3])):
        beside, (nx, ny), r = draw.choice(draft.bodies), draw.choice(ways), size(draw)
        gap = beside.r + r + draw.choice([0, 0, 1, 3])
        x, y = beside.x + nx * gap, beside.y + ny * gap
        if has_room(draft.bodies, x, y, r):
            s = speed(draw)
            vx, vy = draw.choice([(-nx * s, -ny * s), (-ny * s, nx * s), (0, 0), velocity(draw)])
            draft.bodies.append(Body(x, y, r, vx, vy, mass(draw)))
    if draw.random() < 0.5:
        draft.walls = draw.sample([(-11, 0, -11, 1), (12, 0, 12, 1), (0, -11, 1, -11), (0, 12, 1, 12)], 2)
    return reversal(draft, draw, 0.25)


def swift(draw: Random) -> Draft:
    """Slow circles in lanes as wide as a radius, so that they graze those beside them and meet those ahead at about one
    time, and one so swift that doubles tell the times of the others loosely, but tell them."""
    draft, last = Draft([]), -1
    for lane in range(draw.choice([6, 9, 12])):
        places = sorted(draw.sample([k for k in range(5) if k != last], draw.choice([1, 2, 2])))
        last = draw.choice(places)
        for k in places:
            x = 9 * k + F(draw.randrange(-20, 20), 10)
            if has_room(draft.bodies, x, 2 * lane, F(11, 10)):
                pace = draw.choice([1, 1, F(1, 2), 1 + F(draw.randrange(-30, 30), 1000)])
                draft.bodies.append(Body(x, 2 * lane, 1, draw.choice([-1, 0, 1]) * pace, 0, mass(draw)))
    pace = F(10) ** 12 * draw.choice([1, 2, 5, 10, 20])
    draft.bodies.append(Body(-20, 0, 1, -pace, 0, mass(draw)))
    draft.events = draw.randrange(4, 12)
    return reversal(draft, draw, 0.1)


def loose(draw: Random) -> Draft:
    """Pairs that meet about when one grazes, slow ones and fast ones, beside a circle so swift that doubles tell the
    times of the slow ones loosely: what comes first is among those whose bounds begin after the graze, or comes from
    another cell meanwhile."""
    time, draft = F(draw.randrange(8, 40), 4), Draft([])
    draft.bodies += [b.back(time) for b in (Body(0, 0, 1, 1, 0, mass(draw)), Body(0, 2, 1, 0, 0, mass(draw)))]
    slow, fast = [F(1, 32), F(1, 16), F(1, 8), F(1, 4)], [F(1, 2), 1, 2, 4, 8, 16, 32]
    for k in range(draw.randrange(2, 7)):
        s = draw.choice(fast if k % 2 else slow)
        r = draw.choice([F(1, 4), 1, 1, 4])
        late = F(draw.randrange(1, 100), draw.choice([100, 100, 1000])) if draw.random() < 0.9 else 0
        pair = Body(0, 10 * k + 10, r, s, 0, mass(draw)), Body(2 * r, 10 * k + 10, r, 0, 0, mass(draw))
        draft.bodies += [b.back(time + late) for b in pair]
    pace = F(10) ** draw.choice([11, 12, 12, 13]) * draw.choice([1, 2, 5])
    draft.bodies.insert(draw.randrange(len(draft.bodies)), Body(-20, -30, 1, -pace, 0, mass(draw)))
    draft.events = draw.randrange(2, 7)
    return draft.moved(*draw.choice([*AXES, *PYTHAGOREAN[4:8]]), 0, 0)
