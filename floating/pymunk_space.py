"""A scene as a pymunk space: circles as bodies, infinite walls as thick segments long enough for the run.

A segment of the scene is pymunk's own: it is the same thing, its thickness too. So is a convex polygon; the sides of
another one are segments.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias

import pymunk

from ..scenarios.errors import SceneError
from ..scenarios.scene import Scene
from ..scenarios.things import Circle, Polygon, Segment, Wall

# -- Convex polygons, cut by lines: where walls leave room.

Point: TypeAlias = tuple[float, float]

Bar: TypeAlias = tuple[float, float, float, float]
"""A straight way from one point to another: x0, y0, x1, y1."""


def clipped(region: Sequence[Point], nx: float, ny: float, height: float) -> list[Point]:
    """The part of a convex polygon where nx * x + ny * y >= height (Sutherland and Hodgman, 1974).

    >>> clipped([(0.0, 0.0), (2.0, 0.0), (0.0, 2.0)], -1.0, 0.0, -1.0)
    [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 2.0)]
    """
    kept: list[Point] = []
    for (x0, y0), (x1, y1) in zip(region, [*region[1:], region[0]], strict=True):
        h0, h1 = nx * x0 + ny * y0 - height, nx * x1 + ny * y1 - height
        if h0 >= 0:
            kept.append((x0, y0))
        if (h0 < 0) != (h1 < 0):
            share = h0 / (h0 - h1)
            kept.append((x0 + share * (x1 - x0), y0 + share * (y1 - y0)))
    return kept


# -- A scene as a pymunk space: circles as bodies, infinite walls as thick segments long enough for the run.

GRAVITY = (0.0, 0.0)
"""Where a scene has none."""

FALLING_FOR = 64.0
"""Under gravity, or with walls that move: for how long walls reach far enough, until they are laid anew. A fall has no
bound, and a segment as long as all of it has no digits left."""

QUICKENED = 64
"""Where walls move, by how many times the speed of the fastest of them a circle may become faster."""

DAMPING = 1.0
"""Share of the velocity kept in a unit of time: all of it."""

ELASTICITY = 1.0
"""Of every shape, times the square root of the scene's restitution: pymunk multiplies the two of a contact."""

FRICTION = 0.0

COLLISION_PERSISTENCE = 1
"""Steps for which pymunk remembers a contact that is over. With its default of 3, a pair that meets again
within three steps starts from the impulse of its last meeting, which was never applied in this one. 0 would
drop the contacts of the step that is being solved."""

ENERGY_MARGIN = 2.0
"""Factor on the speed that the initial energy allows: a solver that has not settled may gain some."""

DEEP = 8
"""Steps at full speed that a circle may sink into a wall before its centre reaches the segment's core line.
It sinks for one step in a plain bounce, and for one more for each time that another circle presses it on."""

MAX_CELLS = 32
"""How many groups of shapes pymunk's 32-bit filters tell apart."""


@dataclass(frozen=True)
class Slab:
    """The thick segment behind a wall, as some circles meet it.

    Attributes:
        wall: its number.
        inmates: the circles.
        shape: the segment.
    """

    wall: int
    inmates: tuple[int, ...]
    shape: pymunk.Segment


@dataclass(frozen=True)
class PymunkSpace:
    """A pymunk space and what its parts are in the scene.

    Attributes:
        space: ready to step.
        bodies: one a circle, in scene order.
        moving: those of the circles that are not fixed.
        places: the index in `scene.ids` of each shape's circle, wall, segment or polygon.
        walls: (nx, ny, height) of each wall: it is where nx * x + ny * y = height; (nx, ny) has length 1.
        sides: for each circle and each wall, the sign of nx * x + ny * y - height.
        bars: (x0, y0, x1, y1) of each segment, at time 0.
        outlines: the same of all sides of each polygon.
        joints: of each end that segments share, with its velocity, the number of the segment that names it: the first
            of the thickest.
        speed: the greatest speed that a circle can have by energy, with `ENERGY_MARGIN`; under gravity, or where walls
            move, that up to which they reach far enough.
        slabs: the segments behind the walls, and which circles meet each.
        movers: the bodies of walls that move, by number.
        rides: those of segments and polygons that move, by place in `scene.ids`.
    """

    space: pymunk.Space
    bodies: tuple[pymunk.Body, ...]
    moving: tuple[pymunk.Body, ...]
    places: dict[pymunk.Shape, int]
    walls: tuple[tuple[float, float, float], ...]
    sides: tuple[tuple[int, ...], ...]
    bars: tuple[tuple[float, float, float, float], ...]
    outlines: tuple[tuple[Bar, ...], ...]
    joints: dict[tuple[float, float, float, float], int]
    speed: float
    slabs: tuple[Slab, ...]
    movers: Mapping[int, pymunk.Body]
    rides: Mapping[int, pymunk.Body]

    def laid_anew(self, dt: float, duration: float) -> PymunkSpace:
        """The same space, with walls that reach far enough for so long from where the circles are now."""
        radii = [float(shape.radius) for shape in self.places if isinstance(shape, pymunk.Circle)]
        moving = [(body.mass, body.velocity.x, body.velocity.y) for body in self.moving]
        drift = max((body.velocity.length for body in (*self.movers.values(), *self.rides.values())), default=0.0)
        speed = _top_speed(moving) + self.space.gravity.length * duration + QUICKENED * drift
        for inmates in dict.fromkeys(slab.inmates for slab in self.slabs):
            discs = [(self.bodies[i].position.x, self.bodies[i].position.y, radii[i]) for i in inmates]
            mine = {slab.wall: slab.shape for slab in self.slabs if slab.inmates == inmates}
            side = self.sides[inmates[0]]
            for index, start, stop, radius in _slabs(
                self.movers, discs, side, self.walls, speed * duration, speed * dt
            ):
                mine[index].unsafe_set_endpoints(start, stop)
                mine[index].unsafe_set_radius(radius)
                self.space.reindex_shape(mine[index])
        return replace(self, speed=speed)

    def named(self, pair: tuple[int, int]) -> tuple[int, int]:
        """A circle and a segment; by the segment that names the end, where it is nearest to one that is shared."""
        first = len(self.bodies) + len(self.walls)
        if pair[1] < first or pair[1] - first >= len(self.bars) or not self.joints:
            return pair
        (x0, y0, x1, y1), (x, y) = self.bars[pair[1] - first], self._beside(pair[1], *self.bodies[pair[0]].position)
        ux, uy = x1 - x0, y1 - y0
        foot = (x - x0) * ux + (y - y0) * uy
        end = (x0, y0) if foot <= 0 else (x1, y1) if foot >= ux * ux + uy * uy else None
        ride = self.rides.get(pair[1])
        pace = (0.0, 0.0) if ride is None else tuple(ride.velocity)
        number = None if end is None else self.joints.get((*end, pace[0], pace[1]))
        return pair if number is None else (pair[0], first + number)

    def from_bar(self, number: int, x: float, y: float) -> tuple[float, float]:
        """The way from the nearest point of a segment to a point."""
        place = len(self.bodies) + len(self.walls) + number
        return _from_bar(self.bars[number], *self._beside(place, x, y))

    def from_outline(self, number: int, x: float, y: float) -> tuple[float, float]:
        """The way from the nearest point of a polygon's sides to a point."""
        x, y = self._beside(len(self.bodies) + len(self.walls) + len(self.bars) + number, x, y)
        return min((_from_bar(bar, x, y) for bar in self.outlines[number]), key=lambda way: math.hypot(*way))

    def _beside(self, place: int, x: float, y: float) -> Point:
        """A point as seen from a thing that moves, in the coordinates that it has at time 0."""
        ride = self.rides.get(place)
        return (x, y) if ride is None else (x - ride.position.x, y - ride.position.y)

    def ways_from(self, x: float, y: float) -> Iterator[tuple[float, float]]:
        """The ways from the nearest points of all segments and sides, where none moves, to a point."""
        for bar in (*self.bars, *(bar for outline in self.outlines for bar in outline)):
            yield _from_bar(bar, x, y)


def _from_bar(bar: Bar, x: float, y: float) -> tuple[float, float]:
    x0, y0, x1, y1 = bar
    ux, uy = x1 - x0, y1 - y0
    share = min(1.0, max(0.0, ((x - x0) * ux + (y - y0) * uy) / (ux * ux + uy * uy)))
    return x - x0 - share * ux, y - y0 - share * uy


def build_space(scene: Scene, *, dt: float, duration: float, iterations: int, slop: float, bias: float) -> PymunkSpace:
    """The space of a scene, for a run of at most `duration` in steps of `dt`.

    Args:
        scene: what to build; circles that it fixes become static bodies, the others never rotate.
        dt: the time step, which decides how thick walls must be.
        duration: the longest time that the run may last, which decides how long walls must be.
        iterations: of pymunk's solver, a step.
        slop: overlap that pymunk leaves alone.
        bias: share of an overlap that is left after a unit of time; 1 leaves all of it.

    Raises:
        SceneError: if a number is beyond the range of doubles, or walls part the circles into more than
            `MAX_CELLS` groups.
    """
    space = pymunk.Space()
    gravity = GRAVITY if scene.gravity is None else (float(scene.gravity[0]), float(scene.gravity[1]))
    space.gravity = gravity
    space.damping = DAMPING
    space.iterations = iterations
    space.collision_slop = slop
    space.collision_bias = bias
    space.collision_persistence = COLLISION_PERSISTENCE
    try:
        paces = [(float(wall.vx), float(wall.vy)) for wall in scene.walls]
        solids = enumerate((*scene.segments, *scene.polygons), start=len(scene.circles) + len(scene.walls))
        carried = {place: (float(solid.vx), float(solid.vy)) for place, solid in solids if solid.moves}
        drift = max((math.hypot(*pace) for pace in (*paces, *carried.values())), default=0.0)
        moving = [(_mass(c), float(c.vx), float(c.vy)) for c in scene.circles if not c.fixed]
        speed = _top_speed(moving) + math.hypot(*gravity) * duration + QUICKENED * drift
        movers = {index: _mover(space, pace) for index, pace in enumerate(paces) if scene.walls[index].moves}
        rides = {place: _mover(space, pace) for place, pace in carried.items()}
        lines = tuple(_line(wall) for wall in scene.walls)
        sides = [tuple(wall.height(c.x, c.y).sign() for wall in scene.walls) for c in scene.circles]
        cells = _cells(scene.name, sides)
        places: dict[pymunk.Shape, int] = {}
        bodies: list[pymunk.Body] = []
        for place, circle in enumerate(scene.circles):
            body, shape = _disc(circle)
            shape.filter = _only(cells[place])
            space.add(body, shape)
            bodies.append(body)
            places[shape] = place
        laid: list[Slab] = []
        for cell in sorted(set(cells)):
            inmates = tuple(i for i, number in enumerate(cells) if number == cell)
            discs = [(float(c.x), float(c.y), float(c.r)) for c in (scene.circles[i] for i in inmates)]
            side = sides[inmates[0]]
            for index, start, stop, radius in _slabs(movers, discs, side, lines, speed * duration, speed * dt):
                segment = pymunk.Segment(movers.get(index, space.static_body), start, stop, radius)
                segment.filter = _only(cell)
                space.add(segment)
                places[segment] = len(scene.circles) + index
                laid.append(Slab(index, inmates, segment))
        for index, segment in enumerate(scene.segments, start=len(scene.circles) + len(scene.walls)):
            shape = _bar(rides.get(index, space.static_body), segment)
            space.add(shape)
            places[shape] = index
        for index, polygon in enumerate(scene.polygons, start=len(scene.ids) - len(scene.polygons)):
            for shape in _solid(rides.get(index, space.static_body), polygon):
                space.add(shape)
                places[shape] = index
    except OverflowError:
        raise SceneError(f"{scene.name!r}: a number is beyond 1e308; pymunk counts in doubles") from None
    elasticity = elasticity_of(scene)
    for shape in places:
        shape.elasticity = elasticity
        shape.friction = FRICTION
    dynamic = tuple(body for body in bodies if body.body_type == pymunk.Body.DYNAMIC)
    bars = tuple((float(s.x0), float(s.y0), float(s.x1), float(s.y1)) for s in scene.segments)
    outlines = tuple(tuple((*a, *b) for a, b in _sides(polygon)) for polygon in scene.polygons)
    joints = _joints(scene, bars)
    stand = lines, tuple(sides), bars, outlines, joints
    return PymunkSpace(space, tuple(bodies), dynamic, places, *stand, speed, tuple(laid), movers, rides)


def elasticity_of(scene: Scene) -> float:
    """What each shape is given: Chipmunk takes the product of the two for the restitution of a contact."""
    return ELASTICITY * math.sqrt(scene.restitution)


def _joints(scene: Scene, bars: Sequence[Bar]) -> dict[Bar, int]:
    """See `PymunkSpace.joints`."""
    at: dict[Bar, list[int]] = {}
    for number, (x0, y0, x1, y1) in enumerate(bars):
        pace = float(scene.segments[number].vx), float(scene.segments[number].vy)
        at.setdefault((x0, y0, *pace), []).append(number)
        at.setdefault((x1, y1, *pace), []).append(number)
    return {
        end: max(numbers, key=lambda number: (scene.segments[number].r, -number))
        for end, numbers in at.items()
        if len(numbers) > 1
    }


def _only(cell: int) -> pymunk.ShapeFilter:
    """Meets the shapes of its own cell, and no other."""
    return pymunk.ShapeFilter(categories=1 << cell, mask=1 << cell)


def _disc(circle: Circle) -> tuple[pymunk.Body, pymunk.Circle]:
    still = pymunk.Body(body_type=pymunk.Body.STATIC)
    body = still if circle.fixed else pymunk.Body(_mass(circle), math.inf)
    body.position = float(circle.x), float(circle.y)
    if not circle.fixed:
        body.velocity = float(circle.vx), float(circle.vy)
    return body, pymunk.Circle(body, float(circle.r))


def _bar(static: pymunk.Body, segment: Segment) -> pymunk.Segment:
    """A segment, which circles of every cell meet."""
    ends = (float(segment.x0), float(segment.y0)), (float(segment.x1), float(segment.y1))
    return pymunk.Segment(static, *ends, float(segment.r))


def _sides(polygon: Polygon) -> list[tuple[Point, Point]]:
    return [((float(a[0]), float(a[1])), (float(b[0]), float(b[1]))) for a, b in polygon.sides()]


def _solid(static: pymunk.Body, polygon: Polygon) -> list[pymunk.Shape]:
    """A polygon, which circles of every cell meet: one shape where it is convex, else its sides."""
    sides, r = _sides(polygon), float(polygon.r)
    if polygon.convex:
        return [pymunk.Poly(static, [a for a, _ in sides], radius=r)]
    return [pymunk.Segment(static, a, b, r) for a, b in sides]


def _mass(circle: Circle) -> float:
    return math.inf if isinstance(circle.m, str) else float(circle.m)


def _top_speed(moving: Sequence[tuple[float, float, float]]) -> float:
    """What the lightest of circles of mass, vx and vy would do with all of the energy, times `ENERGY_MARGIN`."""
    if not moving:
        return 0.0
    lightest = min(mass for mass, _, _ in moving)
    return ENERGY_MARGIN * math.sqrt(sum(mass / lightest * (vx**2 + vy**2) for mass, vx, vy in moving))


def _line(wall: Wall) -> tuple[float, float, float]:
    nx, ny = (float(part) for part in wall.normal)
    length = math.hypot(nx, ny)
    nx, ny = nx / length, ny / length
    return nx, ny, nx * float(wall.x0) + ny * float(wall.y0)


def _cells(name: str, sides: Sequence[tuple[int, ...]]) -> list[int]:
    """A number for each circle: the same for two circles if no wall is between them.

    Raises:
        SceneError: for more than `MAX_CELLS` numbers.
    """
    numbers: dict[tuple[int, ...], int] = {}
    cells = [numbers.setdefault(side, len(numbers)) for side in sides]
    if len(numbers) > MAX_CELLS:
        raise SceneError(
            f"{name!r}: walls part the circles into {len(numbers)} groups; pymunk's filters "
            f"distinguish {MAX_CELLS}; remove walls or circles, or run the groups as scenes of their own"
        )
    return cells


def _mover(space: pymunk.Space, pace: Point) -> pymunk.Body:
    """What moves with a velocity, whatever hits it."""
    body = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    body.velocity = pace
    space.add(body)
    return body


def _slabs(
    movers: Mapping[int, pymunk.Body],
    discs: Sequence[tuple[float, float, float]],
    sides: Sequence[int],
    lines: Sequence[tuple[float, float, float]],
    reach: float,
    stride: float,
) -> Iterator[tuple[int, Point, Point, float]]:
    """For each wall, by index, the thick segment behind it as the circles of one cell meet it: its ends and its radius.

    A circle is given by x, y and r. The ends of a wall that moves are as seen from its body.

    Each segment is as thick as it is long, in a power of two: a circle's distance from its core line and the
    direction from there then carry like shares of rounding, and the core line of a wall at a short binary
    coordinate is exact. The cell is the convex region that walls leave of where speed can take the circles,
    so that a box needs short segments however long the run; walls that move leave all of it, and go with `movers`.
    """
    xs, ys, radii = zip(*discs, strict=True)
    biggest = max(radii)
    spread = reach + biggest
    region: list[Point] = [
        (min(xs) - spread, min(ys) - spread),
        (max(xs) + spread, min(ys) - spread),
        (max(xs) + spread, max(ys) + spread),
        (min(xs) - spread, max(ys) + spread),
    ]
    for index, (side, (nx, ny, height)) in enumerate(zip(sides, lines, strict=True)):
        if index in movers:
            continue
        region = clipped(region, side * nx, side * ny, side * height) or region
    for index, (side, (nx, ny, height)) in enumerate(zip(sides, lines, strict=True)):
        px, py = movers[index].position if index in movers else (0.0, 0.0)
        along = [ny * (x - px) - nx * (y - py) for x, y in region]
        middle = (max(along) + min(along)) / 2
        half = (max(along) - min(along)) / 2 + biggest + DEEP * stride
        radius = 2.0 ** math.ceil(math.log2(half)) if half else 1.0
        core = height - side * radius
        start, stop = middle - radius, middle + radius
        ends = [(nx * core + ny * end, ny * core - nx * end) for end in (start, stop)]
        yield index, ends[0], ends[1], radius
