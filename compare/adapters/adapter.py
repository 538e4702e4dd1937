"""What the adapters of other people's engines share: packages, settings, time steps, walls."""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from importlib import import_module
from importlib.metadata import PackageNotFoundError, version
from typing import TYPE_CHECKING, Any, ClassVar, Protocol

from ...floating.pymunk_space import QUICKENED, Point, clipped
from ...scenarios.errors import SceneError
from ...scenarios.surfaces import sides_of
from ..foreign.recorded import Playing
from ..validation import EngineError

if TYPE_CHECKING:
    from ...scenarios.scene import Scene
    from ...scenarios.things import Segment
    from ..foreign.impulses import Row
    from ..foreign.recording import Recording


class NotInstalled(EngineError):
    """An engine's package is not installed; the message says how to get it."""


def package(module: str, extra: str) -> Any:
    """The module of an engine's package, imported now.

    Args:
        extra: the extra of truebreak that installs it.

    Raises:
        NotInstalled: if it, or something that it imports, is not installed.

    >>> package("math", "box2d").floor(1.5)
    1
    """
    try:
        return import_module(module)
    except ImportError as error:
        raise NotInstalled(f"engine {extra!r}: {error}; pip install '.[{extra}]' in truebreak's folder") from error


# ----------------------------------------
# What every adapter has: the version of its package among its settings, and checks of its parameters.


class Adapted(Playing):
    """An engine of others, adapted. `name` is that of its extra, too.

    Attributes:
        distribution: what the package index calls its package.
        pair_microseconds: what an event costs it for each pair of circles, where it looks at all of them; measured.
    """

    distribution: ClassVar[str]
    pair_microseconds: ClassVar[float] = 0.0

    @property
    def step(self) -> float | None:
        """No time step, but for a `SteppedAdapter`."""
        return None

    @property
    def parameters(self) -> dict[str, Any]:
        """The fields, and the version of the package."""
        return {**super().parameters, self.distribution: version_of(self.distribution)}

    def check_positive(self, key: str) -> None:
        """Refuses a parameter that is not above zero, or not finite."""
        if not 0 < getattr(self, key) < math.inf:
            raise SceneError(f"engine {self.name!r}: {key} = {getattr(self, key)!r}: must be above zero, and finite")

    def check_count(self, key: str) -> None:
        """Refuses a parameter that is no whole number from 1."""
        value = getattr(self, key)
        if isinstance(value, bool) or not isinstance(value, int) or value < 1:
            raise SceneError(f"engine {self.name!r}: {key} = {value!r}: must be a whole number from 1")


def version_of(distribution: str) -> str:
    """The version of a package, such as `2.3.10`; "not installed" where there is none.

    >>> version_of("no-such-package")
    'not installed'
    """
    try:
        return version(distribution)
    except PackageNotFoundError:
        return "not installed"


# ----------------------------------------
# What the adapters of engines that go by time steps share: the loop, the reversal, the budget.

LOOK = 64
"""Steps between two reports of a flight in which nothing happens."""

ENERGY_MARGIN = 2.0
"""Factor on the speed that a scene's energy allows: a solver that has not settled may gain some."""


class OutOfRoom(Exception):
    """A circle has left the part of the plane that the engine's world is made for; the run ends there."""


class EngineWorld(Protocol):
    """A scene in the engine's own terms, ready to step."""

    def step(self) -> Sequence[tuple[str, str]]:
        """One time step; the pairs between which the engine had an impulse, by ids."""
        ...

    def rows(self) -> list[Row]:
        """x, y, vx, vy of every circle, in the scene's units."""
        ...

    def place(self, rows: Sequence[Row]) -> None:
        """Puts every circle that moves where a row says."""
        ...


@dataclass(frozen=True)
class SteppedAdapter(Adapted):
    """An engine that goes by time steps, adapted: `world` is what a subclass writes.

    An event's time is that of the end of the step that had the impulse; all impulses of one step are one event.

    Attributes:
        dt: the time step, in the scene's unit of time.
        max_steps: steps after which a run stops with `StopReason.BUDGET`.
        step_microseconds: what a step costs, measured: the more, the fewer steps are taken to tell a series.

    Raises:
        SceneError: for a parameter out of its range.
    """

    dt: float = 1 / 256
    max_steps: int = 2_000_000
    step_microseconds: ClassVar[float]

    def __post_init__(self) -> None:
        self.check_positive("dt")
        self.check_count("max_steps")

    @property
    def step(self) -> float:
        """`dt`."""
        return self.dt

    @property
    def scene_keys(self) -> frozenset[str]:
        """Walls, segments and polygons, gravity, turning back; no `tie_policy`: a step solves its contacts at once."""
        return frozenset({"wall", "segment", "polygon", "pocket", "reverse_at", "reverse_after", "gravity", "fixed"})

    def finer(self) -> SteppedAdapter:
        """Half the time step, and room for twice the steps."""
        return replace(self, dt=self.dt / 2, max_steps=2 * self.max_steps)

    def firmer(self) -> SteppedAdapter | None:
        """Twice the solver's iterations, if it has a field of that name."""
        settings: Any = {f.name: 2 * getattr(self, f.name) for f in fields(self) if f.name == "iterations"}
        return replace(self, **settings) if settings else None

    @abstractmethod
    def world(self, scene: Scene) -> EngineWorld:
        """The scene in the engine's own terms.

        Raises:
            SceneError: for a scene that it cannot hold.
        """

    def play(self, scene: Scene, recording: Recording) -> None:
        """Steps on while the recording is open; ends it where the world has no more room.

        Raises:
            SceneError: for a scene that is turned back under gravity: no fall by steps goes back the way that it came.
        """
        if scene.gravity is not None and (scene.reverse_at is not None or scene.reverse_after is not None):
            told = f"{scene.name!r}: has gravity and a reversal, which engine {self.name!r} does not follow together"
            raise SceneError(f"{told}; leave reverse_at and reverse_after out")
        try:
            self._steps(scene, recording)
        except OutOfRoom as error:
            recording.spent(str(error))

    def _steps(self, scene: Scene, recording: Recording) -> None:
        world, told = self.world(scene), self.teller(scene, recording)
        turn = math.inf if scene.reverse_at is None else float(scene.reverse_at)
        base, base_step, turned = 0.0, 0, False
        for number in range(1, self.max_steps + 1):
            now = base + (number - base_step) * self.dt
            if now > turn and not turned:
                rows = glided(world.rows(), turn - (now - self.dt))
                told.at_rest(turn, rows)
                world.place([(x, y, -vx, -vy) for x, y, vx, vy in rows])
                base, base_step, turned = turn, number - 1, True
                now = base + self.dt
            pairs = [*dict.fromkeys(world.step())]  # a polygon has several sides
            if pairs or told.waiting:
                told.contacts(now, pairs, world.rows())
                if recording.reversal is not None and not turned:
                    turned = True
                    world.place([(x, y, -vx, -vy) for x, y, vx, vy in world.rows()])
            elif number % LOOK == 0:
                told.at_rest(now, world.rows())
            else:
                continue
            if not recording.open:
                return
        if recording.open:
            recording.spent(f"{self.max_steps:,} steps of {self.dt!r}; raise max_steps, or dt")

    def teller(self, scene: Scene, recording: Recording) -> Teller:
        """What tells the recording of a step with contacts."""
        return Teller(scene, recording)


class Teller:
    """Tells a recording what each step brought, of an engine whose collisions take one step."""

    def __init__(self, scene: Scene, recording: Recording) -> None:
        self.scene, self.recording = scene, recording

    @property
    def waiting(self) -> bool:
        """Whether something is still to be told, though nothing touches."""
        return False

    def contacts(self, now: float, pairs: Sequence[tuple[str, str]], rows: Sequence[Row]) -> None:
        """A step at whose end things are so, and in which these pairs had an impulse."""
        self.recording.hits(now, pairs, dict(zip(self.circles, rows, strict=True)))

    def at_rest(self, now: float, rows: Sequence[Row]) -> None:
        """A time at which nothing touches."""
        self.recording.state(now, rows)

    @property
    def circles(self) -> list[str]:
        """The circles' ids."""
        return [str(circle.id) for circle in self.scene.circles]


def glided(rows: Sequence[Row], time: float) -> list[Row]:
    """Rows after straight flight of so long.

    >>> glided([(0.0, 0.0, 1.0, -2.0)], 0.5)
    [(0.5, -1.0, 1.0, -2.0)]
    """
    return [(x + vx * time, y + vy * time, vx, vy) for x, y, vx, vy in rows]


def gravity_of(scene: Scene) -> tuple[float, float]:
    """A scene's gravity in doubles; none is 0.

    >>> from truebreak.scenarios import Circle, Scene
    >>> gravity_of(Scene([Circle(0, 0)])), gravity_of(Scene([Circle(0, 0)], gravity=(0, "-1/2")))
    ((0.0, 0.0), (0.0, -0.5))
    """
    return (0.0, 0.0) if scene.gravity is None else (float(scene.gravity[0]), float(scene.gravity[1]))


def fallen_row(row: Row, time: float, gravity: tuple[float, float]) -> Row:
    """A row after a fall of so long, or before it.

    >>> fallen_row((0.0, 0.0, 1.0, 0.0), -2.0, (0.0, -1.0))
    (-2.0, -2.0, 1.0, 2.0)
    """
    (x, y, vx, vy), (gx, gy) = row, gravity
    return x + (vx + gx * time / 2) * time, y + (vy + gy * time / 2) * time, vx + gx * time, vy + gy * time


FALLING_FOR = 64.0
"""For how long a circle may fall until it is as fast as an engine's world is made for."""


def top_speed(scene: Scene) -> float:
    """What the lightest circle would do with all of the energy, times `ENERGY_MARGIN`; and what a long fall adds, and
    walls that move.

    >>> from truebreak.scenarios import Circle, Scene
    >>> top_speed(Scene([Circle(0, 0, vx=3, m=4), Circle(9, 0)]))
    12.0
    """
    moving = [circle for circle in scene.circles if not circle.fixed]
    shares = [float(circle.inverse_mass) for circle in moving]
    squares = [(float(c.vx) ** 2 + float(c.vy) ** 2) / w for c, w in zip(moving, shares, strict=True)]
    fallen = math.hypot(*gravity_of(scene)) * FALLING_FOR
    pushed = QUICKENED * max((math.hypot(float(wall.vx), float(wall.vy)) for wall in scene.walls), default=0.0)
    return ENERGY_MARGIN * math.sqrt(max(shares, default=0.0) * sum(squares)) + fallen + pushed


def power_of_two(value: float) -> float:
    """The greatest power of two that is not above a number: scaling by it rounds nothing.

    >>> power_of_two(0.3), power_of_two(4.0)
    (0.25, 4.0)
    """
    return 2.0 ** math.floor(math.log2(value))


# ----------------------------------------
# Collisions that take several steps, told as events: what presses together is one, at the step at which it began.

LASTING = 64
"""Contacts of two in a row, by time, after which things that still press on each other are not taken for colliding."""


@dataclass
class Episode:
    """Things that press on each other, directly or through others.

    Attributes:
        start: the time of the step in which the first pressed.
        pairs: who pressed on whom, in the order in which they began; who parts and meets again is there twice.
        members: the circles among them that move.
        rows: of the members, as the episode left them at its `end`; None while it lasts.
    """

    start: float
    pairs: list[tuple[str, str]]
    members: set[str]
    end: float = 0.0
    rows: dict[str, Row] | None = None


class Episodes(Teller):
    """Gathers the steps of each collision.

    The event's time is that of the first step in which something pressed, and the states that it leaves are those of
    the flights on which circles leave, followed back to that time. An event at which the scene reverses is told at its
    end instead: the engine goes back from there.

    Args:
        longest: how long an episode may last.
    """

    def __init__(self, scene: Scene, recording: Recording, longest: float) -> None:
        super().__init__(scene, recording)
        self._moving = {str(circle.id) for circle in scene.circles if not circle.fixed}
        self._longest, self._gravity = longest, gravity_of(scene)
        self._pressing: set[tuple[str, str]] = set()
        self._open: list[Episode] = []
        self._last, self._events = 0.0, 0

    @property
    def waiting(self) -> bool:
        """Whether an episode is not told yet."""
        return bool(self._open)

    def contacts(self, now: float, pairs: Sequence[tuple[str, str]], rows: Sequence[Row]) -> None:
        """A step at whose end these pairs press on each other.

        Raises:
            OutOfRoom: where an episode lasts too long to be a collision.
        """
        for pair in pairs:
            if pair not in self._pressing:
                self._begin(now, pair)
        self._pressing = set(pairs)
        states = dict(zip(self.circles, rows, strict=True))
        for episode in self._open:
            if episode.rows is None and not self._pressing.intersection(episode.pairs):
                episode.end = now
                episode.rows = {name: states[name] for name in episode.members}
            elif episode.rows is None and now - episode.start > self._longest:
                first, second = next(pair for pair in episode.pairs if pair in self._pressing)
                raise OutOfRoom(f"{first!r} and {second!r} press on each other for longer than a collision takes")
        while self._open and self._open[0].rows is not None:
            self._tell(self._open.pop(0))

    def at_rest(self, now: float, rows: Sequence[Row]) -> None:
        """A time at which nothing touches; while something does, nothing is told of it."""
        if not self._open:
            self._last = now
            super().at_rest(now, rows)

    def _begin(self, now: float, pair: tuple[str, str]) -> None:
        """A pair begins to press: on its own, or with those that it touches."""
        joined = Episode(now, [], self._moving.intersection(pair))
        apart: list[Episode] = []
        for episode in self._open:
            if episode.rows is None and joined.members & episode.members:
                joined = Episode(
                    min(joined.start, episode.start), joined.pairs + episode.pairs, joined.members | episode.members
                )
            else:
                apart.append(episode)
        joined.pairs.append(pair)
        self._open = sorted([*apart, joined], key=lambda episode: episode.start)

    def _tell(self, episode: Episode) -> None:
        assert episode.rows is not None
        recording, time = self.recording, max(episode.start, self._last)
        if recording.reversal is None and self.scene.reverse_after == self._events + (time > self._last):
            time = max(episode.end, self._last)
        rows = {name: fallen_row(row, time - episode.end, self._gravity) for name, row in episode.rows.items()}
        self._events += time > self._last
        self._last = time
        recording.hits(time, episode.pairs, rows)


# ----------------------------------------
# Walls for engines that want them in doubles, from one side, or of a finite length.

REACH = 64.0
"""How far a wall goes on, in extents of the scene, where no other wall ends it."""


@dataclass(frozen=True)
class WallLine:
    """A wall in doubles: where nx * x + ny * y = height; (nx, ny) has length 1."""

    nx: float
    ny: float
    height: float

    def distance(self, x: float, y: float) -> float:
        """Of a point, signed."""
        return self.nx * x + self.ny * y - self.height


@dataclass(frozen=True)
class WallStretch:
    """The part of a wall beside which the circles of a scene can be, at time 0, and its velocity."""

    start: Point
    end: Point
    pace: Point = (0.0, 0.0)

    def beside(self, x: float, y: float, time: float = 0.0) -> bool:
        """Whether a point is between the two lines that cross the wall at its ends, at a time.

        >>> WallStretch((0.0, 0.0), (2.0, 0.0)).beside(1.0, 5.0), WallStretch((0.0, 0.0), (2.0, 0.0)).beside(3.0, 0.0)
        (True, False)
        """
        (x0, y0), (x1, y1) = self.start, self.end
        x, y = x - self.pace[0] * time, y - self.pace[1] * time
        ux, uy = x1 - x0, y1 - y0
        return 0.0 <= ux * (x - x0) + uy * (y - y0) <= ux * ux + uy * uy


def bars(scene: Scene) -> list[Segment]:
    """The segments of a scene, and the sides of its polygons, by the names of these.

    A polygon has the surface of its sides: nothing is inside of it.

    >>> from truebreak.scenarios import Circle, Polygon, Scene
    >>> [bar.id for bar in bars(Scene([Circle(0, 9)], polygons=[Polygon([(0, 0), (2, 0), (1, 1)], "wedge")]))]
    ['wedge', 'wedge', 'wedge']
    """
    return [*scene.segments, *(side for polygon in scene.polygons for side in sides_of(polygon))]


def bar_ends(bar: Segment) -> tuple[Point, Point]:
    """The two points of a segment."""
    return (float(bar.x0), float(bar.y0)), (float(bar.x1), float(bar.y1))


def lines(scene: Scene) -> list[WallLine]:
    """Every wall as a line.

    >>> from truebreak.scenarios import Circle, Scene, Wall
    >>> lines(Scene([Circle(0, 2)], [Wall(0, 0, 4, 0)]))
    [WallLine(nx=0.0, ny=1.0, height=0.0)]
    """
    found: list[WallLine] = []
    for wall in scene.walls:
        nx, ny = (float(part) for part in wall.normal)
        length = math.hypot(nx, ny)
        found.append(WallLine(nx / length, ny / length, (nx * float(wall.x0) + ny * float(wall.y0)) / length))
    return found


def sides(scene: Scene) -> list[list[int]]:
    """For each circle and each wall, on which side of it the circle is: 1 where its normal points, else -1."""
    return [[1 if w.height(c.x, c.y).sign() >= 0 else -1 for w in scene.walls] for c in scene.circles]


def stretches(scene: Scene) -> list[WallStretch]:
    """For each wall, as much of it as circles can meet: to where other walls that stand end it, or `REACH`.

    >>> from truebreak.scenarios import Circle, Scene, Wall
    >>> floor = stretches(Scene([Circle(2, 2)], [Wall(0, 0, 1, 0), Wall(0, 0, 0, 1), Wall(9, 0, 9, 1)]))[0]
    >>> round(floor.start[0], 9), round(floor.end[0], 9)
    (-1.0, 10.0)
    """
    walls, biggest = lines(scene), max(float(circle.r) for circle in scene.circles)
    centres = [(float(c.x), float(c.y)) for c in scene.circles]
    xs, ys = [x for x, _ in centres], [y for _, y in centres]
    apart = [abs(wall.distance(x, y)) for wall in walls for x, y in centres]
    spread = REACH * max(max(xs) - min(xs), max(ys) - min(ys), 2 * biggest, *apart)
    corners = (
        (min(xs) - spread, min(ys) - spread),
        (max(xs) + spread, min(ys) - spread),
        (max(xs) + spread, max(ys) + spread),
        (min(xs) - spread, max(ys) + spread),
    )
    room: list[Point] = []
    for side in {tuple(row) for row in sides(scene)}:
        region: list[Point] = list(corners)
        for sign, wall, told in zip(side, walls, scene.walls, strict=True):
            if not told.moves:
                region = clipped(region, sign * wall.nx, sign * wall.ny, sign * wall.height)
        room += region
    found: list[WallStretch] = []
    for wall, told in zip(walls, scene.walls, strict=True):
        along = [wall.ny * x - wall.nx * y for x, y in room]
        low, high = min(along) - biggest, max(along) + biggest
        start, end = ((wall.nx * wall.height + wall.ny * s, wall.ny * wall.height - wall.nx * s) for s in (low, high))
        found.append(WallStretch(start, end, (float(told.vx), float(told.vy))))
    return found
