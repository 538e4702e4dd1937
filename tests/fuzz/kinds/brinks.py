"""Kinds of scenes in which zeros lie behind many roots, or what is no zero lies beyond the balls at hand."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from random import Random

from fuzz.draft import PYTHAGOREAN, TRIPLES, Body, Draft, F, has_room, mass, reversal, span, speed
from fuzz.kinds.contacts import cluster, graze_blow
from fuzz.kinds.symmetry import mirrored, neighbours, onto_pair, ring
from truebreak.scenarios import Quantity

TINY = F(1, 10**100)
EDGE = (66, 70, 72, 73, 74, 75, 76, 77, 100)
"""Powers of ten about the precision at which the engine begins, 2**-256: told at first, and no more some events on."""
DEEP = Quantity.of("sqrt(2 + sqrt(3 + sqrt(5 + sqrt(7 + sqrt(11)))))")
"""A number of roots too deep for a field."""
FAINT = (70, 75, 76, 77, 78, 80, 90)
"""Powers of ten below what those balls tell, or a little above."""


def edge(draw: Random) -> Fraction:
    """A flaw at the edge of what balls tell, of either sign."""
    return draw.choice([1, -1]) * F(1, 10 ** draw.choice(EDGE))


def faint(draw: Random) -> Fraction:
    """A difference that balls do not tell at first, of either sign."""
    return draw.choice([1, -1]) * F(1, 10 ** draw.choice(FAINT))


def in_long_numbers(draft: Draft) -> Draft:
    """The same elsewhere, so that no number stays in the scene's field for long: all is decided by balls and proofs."""
    return draft.moved(1, 0, F(1, 3**510), F(-1, 7**290))


def without_a_field(draft: Draft) -> Draft:
    """The same, and far off a fixed circle with a number of roots too deep for a field: all is in balls at once."""
    far = Body(F(1, 2), 5000 + DEEP, 1, m="oo")
    return replace(draft, bodies=[*draft.bodies, far])


def there_and_back(draft: Draft, draw: Random) -> Draft:
    """Sometimes turned back at a late time, to run until it is where it began."""
    if draw.random() < 0.2 and not draft.pockets:
        draft.reverse_after, draft.reverse_at = None, draw.choice([5, 10, F(49, 3), 25, 40])
        draft.until, draft.events, draft.endless = None, None, True
    draft.endless = draft.endless and not draft.pockets  # a rim at the return is beyond the engine's proofs
    return draft


def spoilt(draw: Random) -> Draft:
    """A symmetric scene, spoilt by next to nothing."""
    draft = draw.choice([mirrored, neighbours, neighbours, ring, onto_pair])(draw)
    return there_and_back(spoil(draft, draw), draw)


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


def couples(draw: Random) -> Draft:
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
    return there_and_back(reversal(both, draw, 0.3), draw)


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
    return there_and_back(reversal(both, draw, 0.15), draw)


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
    return there_and_back(reversal(draft, draw, 0.15), draw)


def again(draw: Random) -> Draft:
    """A circle grazes a fixed one, and again after a wall askew: with roots in its speed, or in long numbers."""
    q, tiny = draw.choice([1, 2]), draw.choice([0, edge(draw), faint(draw), faint(draw)])
    long = draw.random() < 0.6
    if long:
        draft = Draft([Body(0, 0, 1, draw.choice([1, -1, -2]), 0, mass(draw))], [(-3, 0, -3, 1)])
    else:
        draft = _striker(draw)
    draft.bodies.append(Body(draw.choice([6, 7]), draw.choice([1, -1]) * (1 + q), q, m="oo"))
    draft.walls.append((15, 0, 15 + tiny, 1))
    if draw.random() < 0.5:
        draft.bodies.append(Body(12, draw.choice([2, -2]) + draw.choice([0, tiny]), 1, m="oo"))
    if draw.random() < 0.4:
        draft.pockets.append((10, draw.choice([3, -3]) + draw.choice([0, tiny]), 3))
    draft.events = draw.randrange(3, 9)
    draft.until = draw.choice([None, 3 * span(draw) + 40])
    draft = there_and_back(reversal(draft, draw, 0.25), draw)
    return in_long_numbers(draft) if long else draft


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


def strayed(draw: Random) -> Draft:
    """A circle leaves a large one, and a corner one wall after the other; sent back it leaves the corner otherwise, and
    meets the large one elsewhere: it has not come home."""
    (c, s), r, m = (
        draw.choice([(F(4, 5), F(3, 5)), (F(12, 13), F(5, 13)), (F(3, 5), F(4, 5))]),
        1,
        draw.choice([3, 5, 50]),
    )
    tip, big = r / s, draw.choice([4, 8])
    far, start = draw.choice([12, 20]), draw.choice([1, 2, 5])
    draft = Draft([Body(tip + far + big + r, 0, big, 0, 0, m), Body(tip + start, 0, r, draw.choice([1, 2]), 0)])
    if s * draft.bodies[0].x < big:
        draft.bodies[0].x = big / s + far
    draft.walls = [(0, 0, c, s), (0, 0, c, -s)]
    draft.policy, draft.endless = draw.choice(["sequential:order=scene", "sequential:seed=3"]), True
    if draw.random() < 0.5:
        draft.reverse_after = 2
    else:
        draft.reverse_at = draw.choice([60, 90])
    return draft


def late(draw: Random) -> Draft:
    """Circles far apart for long, then close together between walls: times are large, waits are short.

    There a clock, of few bits at a late time, stands beside its instant by more than the instant's radius.
    """
    return draw.choice([late_blow, late_wedge])(draw)


def late_blow(draw: Random) -> Draft:
    """A circle from afar, and two others between walls."""
    far = 10 ** draw.choice([3, 6, 9, 12])
    bodies = [
        Body(-far, F(draw.randrange(1, 99), 100), vx=1),
        Body(0, 0, vx=F(1, 10 * far)),
        Body(4, F(draw.randrange(-99, 99), 100), m=draw.choice([1, F(3, 7), 2])),
    ]
    walls = [(20, -1, 20, 1), (-1, 3, 1, 3), (-1, -3, 1, draw.choice([-3, F(-29, 10)]))]
    return Draft(bodies, walls, events=draw.randrange(4, 14))


def late_wedge(draw: Random) -> Draft:
    """A circle from afar sends another head on into a wedge: no place is rounded before a wall, every clock is."""
    far, tip = 2 ** draw.choice([20, 30, 40]), 4 + F(draw.randrange(1, 100), 101)
    floor = -F(draw.randrange(200, 300), 103)
    walls = [(tip - 3, 3, tip + 3, -3), (-9, floor, 20, floor)]
    return Draft([Body(-far, 0, vx=1), Body(0, 0)], walls, events=draw.randrange(5, 14))


def nearest(draw: Random) -> Draft:
    """One circle flies past another and is nearest to it, all but touching, about when a third one strikes it.

    In plain coordinates with the struck circle at the origin when the blow falls, thrust along x: the swift one stands
    then at d, its way past the struck one at a right angle to d, `ahead` short of its nearest point or beyond it. There
    the gap is below the square of `ahead`: they meet if they are still to come nearest, and are past each other if
    not. The numbers are too long for a field, so balls decide, whose clocks stand beside the instant.
    """
    thrust, time = draw.choice([1, F(7, 5), 3]), F(draw.randrange(1, 40), draw.choice([3, 7, 11]))
    cosine, sine = draw.choice(TRIPLES)
    swift = thrust * 10 ** draw.randrange(6, 16)
    reach, ahead = F(5, 4), draw.choice([1, -1]) * swift / 2 ** (draw.choice([248, 506, 1020]) + draw.randrange(30))
    apart = reach - ahead**2 / (2 * reach) * (1 - F(1, 256))
    vx, vy = thrust - swift * sine, -swift * cosine
    x, y = -cosine * apart + sine * ahead, sine * apart + cosine * ahead
    bodies = [
        Body(-2, 0, m="oo"),
        Body(thrust * time, 0, vx=-thrust),
        Body(x, y, F(1, 4), vx, vy, draw.choice([1, F(1, 3), 5])).back(time),
    ]
    return Draft(bodies, events=draw.randrange(2, 6)).moved(1, 0, DEEP, 0)
