"""Kinds of scenes in which a centre enters a pocket just as something else happens, or a flaw before or after."""

from __future__ import annotations

from random import Random

from fuzz.draft import AXES, Body, Draft, F, directions, flaw, mass, reversal, size, span, speed, velocity
from fuzz.kinds.contacts import cluster, led_back, raft, with_bystanders, with_walls
from fuzz.kinds.rooms import grid, slide


def rim_instant(draw: Random) -> Draft:
    """A cluster at whose instant centres stand on rims: going in, out, along, or sent in by a blow."""
    draft = with_walls(cluster(draw, most=4), draw, 0.35)
    for _ in range(draw.choice([1, 1, 2, 3])):
        b, (nx, ny) = draw.choice(draft.bodies), draw.choice(directions(draw))
        r = draw.choice([1, 2, 2, 3, F(1, 2)])
        tiny = draw.choice([0, 0, 0, flaw(draw)])
        draft.pockets.append((b.x + nx * (r + tiny), b.y + ny * (r + tiny), r))
    draft.capture = draw.random() < 0.5
    return reversal(led_back(with_bystanders(draft, draw, 1), draw, 0.2), draw, 0.1)


def entry_ties(draw: Random) -> Draft:
    """Entries of one or more circles into one or two pockets each, at one instant or a flaw apart, beside contacts."""
    draft, time = Draft([]), span(draw)
    for k in range(draw.choice([1, 2, 2, 3])):
        r, s = draw.choice([1, F(1, 2)]), speed(draw)
        y, late = 12 * k, draw.choice([0, 0, 0, flaw(draw)])
        draft.bodies.append(Body(0, y, r, s, 0, mass(draw)))
        rim = s * (time + late)
        kind = draw.choice(["one", "one", "two", "wall", "ball", "graze"])
        if kind == "one":
            draft.pockets.append((rim + 2, y, 2))
        elif kind == "two":
            x, h, hole = draw.choice([(4, 3, 5), (F(3, 5), F(4, 5), 1), (12, 5, 13)])
            draft.pockets += [(rim + x, y + h, hole), (rim + x, y - h, hole + draw.choice([0, 0, flaw(draw)]))]
        elif kind == "graze":
            draft.pockets.append((rim, y + 3, 3 + draw.choice([0, flaw(draw)])))
        elif kind == "wall" and not draft.walls:
            draft.walls.append((rim + r, 0, rim + r, 1))
            if draw.random() < 0.6:
                draft.pockets.append((rim + draw.choice([1, -1, flaw(draw) + 1]), y, 1))
        else:
            draft.bodies.append(Body(rim + 2 * r, y, r, 0, 0, mass(draw)))
            if draw.random() < 0.7:
                draft.pockets.append((rim + 2 * r + draw.choice([1, 1, flaw(draw) + 1]), y, 1))
    draft.capture = draw.random() < 0.5
    if draw.random() < 0.35:
        draft.until = time + draw.choice([0, 0, flaw(draw)])
    if draw.random() < 0.3:
        draft.reverse_at = time + draw.choice([0, 0, flaw(draw), F(1, 2)])
        draft.endless = draft.until is None and draw.random() < 0.3
    return reversal(draft, draw, 0.1)


def on_rim(draw: Random) -> Draft:
    """Circles that start on a rim, or inside, or graze one; walls and partners send them back."""
    draft = Draft([])
    for k in range(draw.choice([1, 2, 2])):
        (nx, ny), r, hole = draw.choice(directions(draw)), draw.choice([1, F(1, 2)]), draw.choice([1, 2, 3])
        y, s, tiny = 9 * k, speed(draw), draw.choice([0, 0, 0, flaw(draw)])
        vx, vy = draw.choice([(nx * s, ny * s), (-nx * s, -ny * s), (-ny * s, nx * s), velocity(draw), (0, 0)])
        draft.bodies.append(Body(0, y, r, vx, vy, mass(draw)))
        away = draw.choice([hole, hole, hole, hole / F(2), -hole])
        draft.pockets.append((nx * (away + tiny), y + ny * (away + tiny), hole))
        if draw.random() < 0.6:
            (px, py), gap = draw.choice([*AXES, (nx, ny), (-nx, -ny)]), draw.choice([0, 0, 1, 2])
            t = speed(draw)
            partner = Body(px * (2 * r + gap), y + py * (2 * r + gap), r, -px * t, -py * t, mass(draw))
            draft.bodies.append(partner)
    if draw.random() < 0.4:
        draft.walls.append(draw.choice([(6, 0, 6, 1), (-5, 0, -5, 1), (0, -3, 1, -3), (-1, 0, -1, 1)]))
    draft.capture = draw.random() < 0.5
    return reversal(draft, draw, 0.35)


def pocket_rafts(draw: Random) -> Draft:
    """Touching circles that move together, and pockets on their way: one is taken from the others' side."""
    draft = raft(draw) if draw.random() < 0.7 else slide(draw)
    for _ in range(draw.choice([1, 2])):
        b = draw.choice(draft.bodies)
        r, far = draw.choice([1, F(1, 2), 2]), draw.choice([1, 2, 3, 5 + F(1, 10**20)])
        draft.pockets.append((b.x + b.vx * far + draw.choice([0, r]), b.y + b.vy * far, r))
    draft.capture = draw.random() < 0.65
    return draft


def holes(draw: Random) -> Draft:
    """A grid of circles of few speeds, with pockets on the grid as well."""
    draft = grid(draw)
    for _ in range(draw.choice([1, 2, 3])):
        x, y = draw.randrange(-1, 7), draw.randrange(-1, 7)
        draft.pockets.append((x, y, draw.choice([F(1, 2), 1, F(1, 4), F(3, 2)])))
    draft.capture = draw.random() < 0.6
    return draft


def pressed(draw: Random) -> Draft:
    """A column in flight whose head hits a wall: the rear is pressed aside just before, at or after its entry."""
    s = size(draw)
    nx, ny = draw.choice(directions(draw))
    behind = Body(0, 0, s, 1, 0, mass(draw))
    head = Body(nx * 2 * s, ny * 2 * s, s, 1, 0, mass(draw))
    front = max(float(head.x), 0.0)
    lead = head if front > 0 else behind
    time = span(draw)
    wall = lead.x + s + time
    draft = Draft([behind, head], [(wall, 0, wall, 1)])
    for b in draft.bodies:
        if draw.random() < 0.7:
            late = draw.choice([0, flaw(draw), abs(flaw(draw)), F(1, 3)])
            draft.pockets.append((b.x + time + late + 1, b.y, 1))
    draft.capture = draw.random() < 0.6
    draft.until = draw.choice([None, None, time, time + 2])
    if draw.random() < 0.2:
        draft.reverse_at = time
    return with_bystanders(draft, draw, 1)
