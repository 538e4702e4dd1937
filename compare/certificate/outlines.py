"""Polygons in certificates: each as the segments that are its sides, and the numbers that faces and ends then have."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...scenarios.surfaces import sides_of
from ...scenarios.things import Circle, Segment

if TYPE_CHECKING:
    from ...scenarios.scene import Scene

# -- Nothing is inside of a polygon, so that a disc meets of it what it meets of its sides, taken as segments as thick:
# docs/certificates.md proves that neither their inner faces nor the ends at concave corners are ever met.


def bars_of(scene: Scene) -> list[Segment]:
    """The segments of a scene's certificate: its own, then the sides of its polygons, each with a name of its own.

    >>> from truebreak.scenarios import Circle, Polygon, Scene
    >>> bars = bars_of(Scene([Circle(0, 9)], polygons=[Polygon([(0, 0), (2, 0), (1, 1)], "wedge")]))
    >>> [(bar.id, bar.x0.text(), bar.y0.text()) for bar in bars]
    [('wedge/1', '0', '0'), ('wedge/2', '1', '1'), ('wedge/3', '2', '0')]
    """
    taken = {*scene.ids, *(pocket.id for pocket in scene.pockets)}
    bars = list(scene.segments)
    for polygon in scene.polygons:
        for k, side in enumerate(sides_of(polygon), start=1):
            name = f"{polygon.id}/{k}"
            while name in taken:
                name += "/"
            taken.add(name)
            bars.append(Segment(side.x0, side.y0, side.x1, side.y1, name, side.r, side.vx, side.vy))
    return bars


def numbers_of(scene: Scene) -> dict[int, int]:
    """By the place of a thing among `Scene.surfaces`, circles first, its number in a certificate.

    >>> from truebreak.scenarios import Circle, Polygon, Scene
    >>> dart = Polygon([(0, 0), (2, 0), (1, 1), (1, 3)], "dart")  # four sides; three corners that are ends
    >>> numbers_of(Scene([Circle(0, 9)], polygons=[dart]))
    {0: 0, 1: 2, 2: 4, 3: 1, 4: 5, 5: 7, 6: 9, 7: 11}
    """
    seen, bars = scene.surfaces, bars_of(scene)
    count, walls = len(scene.circles), len(scene.walls)
    corners = (((x, y), (bar.vx, bar.vy)) for bar in bars for x, y in ((bar.x0, bar.y0), (bar.x1, bar.y1)))
    places = dict.fromkeys(corners)  # those at one place that move alike are one
    places |= dict.fromkeys((place, Circle.drift) for arc in scene.arcs for place in arc.ends)
    ends = {place: count + k for k, place in enumerate(places)}
    found = {k: k for k in range(count)}
    found |= {k: ends[(end.x, end.y), end.drift] for k, end in enumerate(seen.circles) if k in seen.ends}
    before, first = len(seen.circles), count + len(ends)
    found |= {before + k: first + k for k in range(walls)}
    both = 2 * len(scene.segments)
    for k in range(len(seen.faces)):  # of a segment both faces are there, of a side the one that looks outward
        found[before + walls + k] = first + walls + (k if k < both else both + 2 * (k - both))
    before, first = before + len(seen.walls), first + walls + 2 * len(bars)
    return found | {before + k: first + k for k in range(2 * len(scene.arcs))}
