"""Kinds of scenes in which contacts coincide: built as they are at one instant, then led back to time 0."""

from __future__ import annotations

from random import Random

from fuzz.draft import (
    AXES,
    HEX,
    PYTHAGOREAN,
    Body,
    Draft,
    F,
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


def _relative(draw: Random, of: Body, towards: Vector) -> Vector:
    """A velocity beside another's: hitting, grazing, moving along with it, or anything."""
    (nx, ny), s = towards, speed(draw)
    kind = draw.choice(["hit", "hit", "graze", "graze", "along", "along", "skew", "any"])
    if kind == "hit":
        return of.vx - nx * s, of.vy - ny * s
    if kind == "graze":
        s = draw.choice([s, -s])
        return of.vx - ny * s, of.vy + nx * s
    if kind == "along":
        return of.vx, of.vy
    if kind == "skew":
        t = draw.choice([speed(draw), -speed(draw)])
        return of.vx - nx * s - ny * t, of.vy - ny * s + nx * t
    return velocity(draw)


def cluster(draw: Random, most: int = 6) -> Draft:
    """Circles that touch, each placed at an earlier one, with velocities that hit, graze or last."""
    ways = directions(draw)
    even = draw.random() < 0.5
    r0 = size(draw)
    first = Body(0, 0, r0, *velocity(draw), mass(draw))
    if draw.random() < 0.12:
        first = Body(0, 0, r0, m="oo")
    bodies = [first]
    for _ in range(draw.choice([1, 2, 2, 3, 3, 4, most - 1])):
        beside, (nx, ny) = draw.choice(bodies), draw.choice(ways)
        r = r0 if even else size(draw)
        x, y = beside.x + nx * (beside.r + r), beside.y + ny * (beside.r + r)
        if not has_room(bodies, x, y, r):
            continue
        if draw.random() < 0.07:
            bodies.append(Body(x, y, r, m="oo"))
        else:
            bodies.append(Body(x, y, r, *_relative(draw, beside, (nx, ny)), 1 if even else mass(draw)))
    return Draft(bodies)


def with_walls(draft: Draft, draw: Random, chance: float = 0.4) -> Draft:
    """Walls that touch a circle of the cluster."""
    while draw.random() < chance and len(draft.walls) < 3:
        b, (nx, ny) = draw.choice(draft.bodies), draw.choice(draw.choice([AXES, AXES, PYTHAGOREAN, HEX]))
        if b.m == "oo":
            continue
        x, y = b.x + nx * b.r, b.y + ny * b.r
        clear = all(
            (float(x) - float(c.x)) * float(nx) + (float(y) - float(c.y)) * float(ny) > float(c.r) - 1e-9
            for c in draft.bodies
        )
        if clear:
            draft.walls.append((x, y, x - ny, y + nx))
    return draft


def with_bystanders(draft: Draft, draw: Random, most: int = 2) -> Draft:
    """More circles anywhere."""
    for _ in range(draw.randrange(most + 1)):
        x, y, r = draw.randrange(-8, 9), draw.randrange(-8, 9), size(draw)
        if has_room(draft.bodies, x, y, r):
            draft.bodies.append(Body(x, y, r, *velocity(draw), mass(draw)))
    return draft


def led_back(draft: Draft, draw: Random, flawed: float = 0.3) -> Draft:
    """As it is so much earlier; or as it comes about again once all is turned back. Perhaps one thing a little late."""
    time = span(draw)
    if draw.random() < 0.1:
        time = 0
    if draw.random() < 0.3:  # the velocities are those after a reversal
        draft.reverse_at = span(draw)
        bodies = [Body(b.x, b.y, b.r, -b.vx, -b.vy, b.m, b.point).back(-time) for b in draft.bodies]
        instant = 2 * draft.reverse_at + time
        if time == 0 and draw.random() < 0.5:
            draft.endless = True
    else:
        bodies = [b.back(time) for b in draft.bodies]
        instant = time
        if time and draw.random() < 0.25:
            draft.reverse_at = instant + draw.choice([0, 0, 0, flaw(draw), F(-1, 2), 1])
    if draw.random() < flawed:
        k, tiny = draw.randrange(len(bodies)), flaw(draw)
        if bodies[k].m != "oo":
            x, y = draw.choice([(1, 0), (0, 1), (bodies[k].vx, bodies[k].vy)])
            bodies[k].x, bodies[k].y = bodies[k].x + x * tiny, bodies[k].y + y * tiny
    draft.bodies = bodies
    if instant and not draft.endless and draw.random() < 0.4:
        draft.until = instant + draw.choice([0, 0, 0, 0, flaw(draw), 1])
    return draft


def instant(draw: Random) -> Draft:
    """A cluster of hits, grazes and lasting contacts with walls and bystanders, led back."""
    draft = with_walls(cluster(draw), draw)
    return reversal(led_back(with_bystanders(draft, draw, 1), draw), draw, 0.1)


def graze_blow(draw: Random) -> Draft:
    """A blow on a circle that is grazed at that very instant, with chains of grazes and touching partners."""
    ways, r = directions(draw), size(draw)
    middle = Body(0, 0, r, *velocity(draw), mass(draw))
    bodies, chain = [middle], middle
    for k in range(draw.choice([2, 3, 3, 4, 5])):
        (nx, ny), s, radius = draw.choice(ways), speed(draw), draw.choice([r, r, size(draw)])
        x, y = chain.x + nx * (chain.r + radius), chain.y + ny * (chain.r + radius)
        if not has_room(bodies, x, y, radius):
            continue
        if k == 0:  # the blow
            bodies.append(Body(x, y, radius, chain.vx - nx * s, chain.vy - ny * s, mass(draw)))
            continue
        along = draw.choice([s, -s, s, -s, 0])
        bodies.append(Body(x, y, radius, chain.vx - ny * along, chain.vy + nx * along, mass(draw)))
        chain = draw.choice([middle, bodies[-1]])
    return led_back(with_walls(Draft(bodies), draw, 0.15), draw, 0.15)


def raft(draw: Random) -> Draft:
    """Touching circles that move as one, and hit a wall, a circle or another raft."""
    ways = draw.choice([AXES, AXES, HEX, PYTHAGOREAN])
    draft = Draft([])
    for side in range(draw.choice([1, 1, 2])):
        vx, vy = velocity(draw)
        r = draw.choice([F(1, 2), 1])
        bodies = [Body(side * 12, draw.choice([0, 0, 1, F(1, 2)]), r, vx, vy, mass(draw))]
        for _ in range(draw.choice([1, 2, 3, 3])):
            beside, (nx, ny) = draw.choice(bodies), draw.choice(ways)
            x, y = beside.x + nx * 2 * r, beside.y + ny * 2 * r
            if has_room(bodies, x, y, r):
                bodies.append(Body(x, y, r, vx, vy, draw.choice([1, 1, mass(draw)])))
        draft.bodies += bodies
    if draw.random() < 0.6:
        x, y = draw.choice([(8, 0), (-7, 0), (0, 7), (3, -7), (6, F(1, 2))])
        if has_room(draft.bodies, x, y, 1):
            draft.bodies.append(Body(x, y, 1, *velocity(draw), draw.choice([1, 2, "oo"])))
            if draft.bodies[-1].m == "oo":
                draft.bodies[-1].vx = draft.bodies[-1].vy = 0
    if draw.random() < 0.7:
        draft.walls += draw.sample([(-20, 0, -20, 1), (20, 0, 20, 1), (0, 9, 1, 9), (0, -9, 1, -9), (24, 0, 20, 3)], 2)
    if draw.random() < 0.25:
        k = draw.randrange(len(draft.bodies))
        if draft.bodies[k].m != "oo":
            draft.bodies[k].vx += flaw(draw)
    return reversal(draft, draw, 0.2)


def dyads(draw: Random) -> Draft:
    """A blow at a graze in small dyadic numbers, without a root: intervals of doubles know such ties exactly."""
    time, s = draw.choice([1, 2, F(1, 2)]), draw.choice([1, 2])
    middle = Body(0, 0, 1, *draw.choice([(0, 0), (0, 1), (1, 0)]))
    bodies, free = [middle], draw.sample(AXES, 4)
    (nx, ny) = free[0]
    bodies.append(Body(2 * nx, 2 * ny, 1, middle.vx - nx * s, middle.vy - ny * s))
    for mx, my in [(-nx, -ny), *free[1:]][: draw.choice([1, 1, 2, 3])]:
        along = draw.choice([s, -s, 2 * s, 0])
        if has_room(bodies, 2 * mx, 2 * my, 1):
            bodies.append(Body(2 * mx, 2 * my, 1, middle.vx - my * along, middle.vy + mx * along))
    draft = Draft([b.back(time) for b in bodies])
    draft.events = draw.choice([1, 2, 3])
    return draft
