"""The scene that circles, walls and pockets make: frozen, exact, validated."""

from __future__ import annotations

from collections.abc import Iterable
from copy import copy
from dataclasses import field, fields
from typing import TYPE_CHECKING, Any, TypeVar

from .errors import SceneError
from .lazy import frozen, kept
from .neighbours import check_apart
from .numbers.quantity import Quantity, QuantityLike
from .settings import (
    ELASTIC,
    TiePolicy,
    checked_gravity,
    checked_restitution,
    checked_truth,
    positive_count,
    positive_time,
)
from .things import Arc, Circle, MovingEnd, Pocket, Polygon, Segment, Squeeze, Wall

if TYPE_CHECKING:
    from .arcs import ArcSide

MAX_CIRCLES = 100_000
"""A gas of so many is built in some seconds, and its first event comes in some twenty; each has nine near it."""

THINGS = frozenset({"circles", "walls", "pockets", "segments", "polygons", "arcs"})


@frozen
class Scene:
    """Circles and walls at time 0, with the tie policy and, optionally, a reversal and a default horizon.

    Attributes:
        circles: the circles, in the order that names contacts and breaks sequential ties.
        walls: the walls, after the circles in that order.
        name: what reports call the scene.
        tie_policy: see `TiePolicy`; text is parsed.
        reverse_after: negate every velocity once, right after this many instants.
        reverse_at: negate every velocity once, at this time (not both).
        until: default time limit of a run.
        events: default limit on the number of instants of a run.
        pockets: round pockets; where a centre enters one is reported with the trajectory's outcome.
        capture: whether a circle that enters a pocket leaves play.
        description, source: what the scene shows and where it comes from.
        segments: straight segments, after the walls in that order.
        polygons: solid polygons, after the segments in that order.
        arcs: parts of circles, after the polygons in that order.
        restitution: e of every contact, 0 <= e <= 1: what approaches with speed u parts with e u; 1 keeps the energy.
        gravity: (gx, gy), a uniform acceleration of every circle; None without.
        settle: whether a circle that comes to rest on a wall across gravity, or slides along it, goes on so, and down a
            slope where nothing can meet it any more; else a run ends there.
        touching: the contacts at gap zero at time 0, in scene order, by index in `ids`.
        surfaces: the same scene as engines see it: faces, sides and ends of segments, polygons and arcs.

    Raises:
        SceneError: for overlapping circles, a circle across a wall, duplicate ids, limits that are not positive, a
            restitution out of its range, and one below 1, or a wall that moves, together with a reversal; for gravity
            beside a reversal where a circle is fixed or something has ends or is round; for a circle that two walls
            crush at time 0; for settle without gravity, and beside a reversal, walls that move, arcs or pockets.

    >>> scene = Scene([Circle(0, 0, vx=1), Circle(4, 0)], [Wall(7, 0, 7, 1)])
    >>> [c.id for c in scene.circles], scene.walls[0].id
    (['c1', 'c2'], 'w1')
    """

    circles: tuple[Circle, ...]
    walls: tuple[Wall, ...] = ()
    name: str = "scene"
    tie_policy: TiePolicy = field(default_factory=TiePolicy)
    reverse_after: int | None = None
    reverse_at: Quantity | None = None
    until: Quantity | None = None
    events: int | None = None
    pockets: tuple[Pocket, ...] = ()
    capture: bool = False
    description: str = ""
    source: str = ""
    segments: tuple[Segment, ...] = ()
    polygons: tuple[Polygon, ...] = ()
    restitution: Quantity = ELASTIC
    arcs: tuple[Arc, ...] = ()
    gravity: tuple[Quantity, Quantity] | None = None
    settle: bool = False
    touching: tuple[tuple[int, int], ...] = field(init=False, repr=False, compare=False)

    def __init__(
        self,
        circles: Iterable[Circle],
        walls: Iterable[Wall] = (),
        name: str = "scene",
        tie_policy: str | TiePolicy = "simultaneous",
        reverse_after: int | None = None,
        reverse_at: QuantityLike | None = None,
        until: QuantityLike | None = None,
        events: int | None = None,
        pockets: Iterable[Pocket] = (),
        capture: bool = False,
        description: str = "",
        source: str = "",
        segments: Iterable[Segment] = (),
        polygons: Iterable[Polygon] = (),
        restitution: QuantityLike = 1,
        arcs: Iterable[Arc] = (),
        gravity: tuple[QuantityLike, QuantityLike] | None = None,
        settle: bool = False,
    ) -> None:
        put = object.__setattr__
        put(self, "circles", tuple(_named(circles, "c")))
        put(self, "walls", tuple(_named(walls, "w")))
        put(self, "pockets", tuple(_named(pockets, "p")))
        put(self, "segments", tuple(_named(segments, "s")))
        put(self, "polygons", tuple(_named(polygons, "g")))
        put(self, "arcs", tuple(_named(arcs, "a")))
        self._settle(
            name=name,
            tie_policy=tie_policy,
            reverse_after=reverse_after,
            reverse_at=reverse_at,
            until=until,
            events=events,
            capture=capture,
            description=description,
            source=source,
            restitution=restitution,
            gravity=gravity,
            settle=settle,
        )
        _check_things(self)
        _check_kinds(self)
        touching = check_apart(self.circles, self.walls)
        if self.moving_walls:
            _check_moving(self)
        if self.segments or self.polygons or self.arcs:
            from .surfaces import check_surfaces

            outer, inner = check_surfaces(self.circles, self.walls, self.segments, self.polygons, self._ends)
            n = len(self.circles)
            if self.arcs:
                from .arcs import check_arcs

                thing = len(self.ids) - len(self.arcs)
                side = n + len(self._ends) + len(self.surfaces.walls)
                with_arcs, with_sides = check_arcs(self.circles, self.arcs, self._ends)
                outer += [(i, thing + k) for i, k in with_arcs]
                inner += [(i, n + k if is_end else side + k) for i, k, is_end in with_sides]
            inner += [(i, j if j < n else j + len(self._ends)) for i, j in touching]
            touching = tuple(sorted([*touching, *outer]))
            put(self, "_lowered_touching", tuple(sorted(set(inner))))
            vars(self).pop("surfaces", None)
        put(self, "touching", touching)

    def _settle(
        self,
        *,
        name: object,
        tie_policy: str | TiePolicy,
        reverse_after: object,
        reverse_at: QuantityLike | None,
        until: QuantityLike | None,
        events: object,
        capture: object,
        description: str,
        source: str,
        restitution: QuantityLike,
        gravity: tuple[QuantityLike, QuantityLike] | None,
        settle: object,
    ) -> None:
        """Sets all but the circles, walls and pockets."""
        put = object.__setattr__
        put(self, "tie_policy", TiePolicy.parse(tie_policy))
        put(self, "description", description)
        put(self, "source", source)
        put(self, "reverse_after", positive_count("reverse_after", reverse_after))
        put(self, "events", positive_count("events", events))
        put(self, "reverse_at", positive_time("reverse_at", reverse_at))
        put(self, "until", positive_time("until", until))
        put(self, "capture", checked_truth("capture", capture))
        put(self, "restitution", checked_restitution(restitution))
        put(self, "gravity", checked_gravity(gravity))
        put(self, "settle", checked_truth("settle", settle))
        if not isinstance(name, str) or not name:
            raise SceneError(f"name = {name!r} is not text; give the scene a name")
        put(self, "name", name)
        if self.reverse_after is not None and self.reverse_at is not None:
            raise SceneError("reverse_after and reverse_at are both set; keep one of them")
        if not self.elastic and (self.reverse_after is not None or self.reverse_at is not None):
            key = "reverse_at" if self.reverse_after is None else "reverse_after"
            raise SceneError(
                f"restitution = {self.restitution.brief()}: cannot be turned back, as energy is lost; leave {key} out"
            )
        if self.gravity is not None:
            _check_falling(self)
        if self.settle:
            _check_settling(self)

    @kept
    def moving_walls(self) -> bool:
        """Whether a wall moves, or a segment or polygon."""
        return any(wall.moves for wall in self.walls) or self.moving_solid is not None

    @kept
    def moving_solid(self) -> str | None:
        """The first segment or polygon that moves, as errors name it; of `surfaces` None."""
        kinds: tuple[tuple[str, tuple[Segment | Polygon, ...]], ...]
        kinds = ("segment", self.segments), ("polygon", self.polygons)
        return next((f"{kind} {solid.id!r}" for kind, solids in kinds for solid in solids if solid.moves), None)

    @kept
    def other_walls(self) -> tuple[Wall, ...]:
        """The walls of kinds of their own, added to `WALL_KINDS`."""
        return tuple(wall for wall in self.walls if wall.kind != Wall.kind and not wall.is_face)

    @kept
    def closing(self) -> tuple[Squeeze, ...]:
        """The circles between two walls that close, and when these leave no room: the earliest of each, in order."""
        if not self.moving_walls:
            return ()
        from .neighbours import closing_of

        return closing_of(self.circles, self.walls[: self.faces.start])

    def __eq__(self, other: object) -> bool:
        """By what it is made of."""
        if not isinstance(other, Scene):
            return NotImplemented
        return self is other or _ingredients(self) == _ingredients(other)

    @kept
    def _hash(self) -> int:
        return hash(_ingredients(self))

    def __hash__(self) -> int:
        """Taken once: what is known of a scene is looked up by it in every run."""
        return self._hash

    @property
    def elastic(self) -> bool:
        """Whether contacts keep the energy: its restitution is 1."""
        return self.restitution == ELASTIC

    @kept
    def pegs(self) -> frozenset[int]:
        """Under gravity, the circles that stand: when another falls onto one is a zero of a quartic. Else none."""
        return frozenset(i for i, circle in enumerate(self.circles) if circle.fixed and self.gravity is not None)

    @kept
    def moving_ends(self) -> dict[int, MovingEnd]:
        """The ends that move, by index among the circles: none but in `surfaces`."""
        return {i: circle for i, circle in enumerate(self.circles) if isinstance(circle, MovingEnd)}

    @kept
    def ids(self) -> tuple[str, ...]:
        """Ids of the circles, then of the walls, the segments, the polygons and the arcs: the scene order."""
        things = (*self.circles, *self.walls, *self.segments, *self.polygons, *self.arcs, *self.arc_sides)
        return tuple(str(thing.id) for thing in things)

    @kept
    def _ends(self) -> tuple[Circle, ...]:
        """The ends of segments and arcs and the corners of polygons, as fixed circles."""
        from .surfaces import ends_of

        return ends_of(self.segments, self.polygons, any(circle.r.sign() == 0 for circle in self.circles), self.arcs)

    @kept
    def surfaces(self) -> Scene:
        """The same scene as engines see it: segments and polygons as faces, after the walls, and ends, after circles.

        Arcs are the two sides of each. Itself where it has none of them. Where an end moves, there is a gravity, of 0
        if of no more: what is met is told from where it moves, as of what stands from where it falls.
        """
        if not self.segments and not self.polygons and not self.arcs:
            return self
        from .surfaces import faces_of

        found = copy(self)
        kept_values = vars(found)
        for name in (
            *("_hash", "ids", "surfaces", "faces", "_ends", "arc_sides", "closing", "pegs"),
            *("moving_walls", "moving_solid", "moving_ends"),
        ):
            kept_values.pop(name, None)
        kept_values["ends"] = range(len(self.circles), len(self.circles) + len(self._ends))
        kept_values["two_sided"] = range(len(self.walls), len(self.walls) + 2 * len(self.segments))
        put = object.__setattr__
        put(found, "circles", (*self.circles, *self._ends))
        put(found, "walls", (*self.walls, *faces_of(self.segments, self.polygons)))
        if self.moving_solid is not None and self.gravity is None:
            put(found, "gravity", Circle.drift)
        put(found, "segments", ())
        put(found, "polygons", ())
        if self.arcs:
            from .arcs import arc_sides

            kept_values["arc_sides"] = tuple(arc_sides(self.arcs))
            put(found, "arcs", ())
        put(found, "touching", kept_values.get("_lowered_touching", ()))
        return found

    @kept
    def ends(self) -> range:
        """Which of the circles are ends of segments, or corners: the last of them, and none but in `surfaces`."""
        return range(len(self.circles), len(self.circles))

    @kept
    def faces(self) -> range:
        """Which of the walls are faces of segments and polygons: the last of them, and none but in `surfaces`."""
        return range(
            next((k for k, wall in enumerate(self.walls) if wall.is_face), len(self.walls)),
            len(self.walls),
        )

    @kept
    def arc_sides(self) -> tuple[ArcSide, ...]:
        """The sides of arcs, two of each, the hollow one second: none but in `surfaces`."""
        return ()

    @kept
    def two_sided(self) -> range:
        """Which of the faces are of segments: each with the other side of its segment beside it."""
        return range(0)

    def with_changes(self, **changes: Any) -> Scene:
        """A copy with some attributes replaced.

        >>> Scene([Circle(0, 0)]).with_changes(name="lonely").name
        'lonely'
        """
        values = {key.name: getattr(self, key.name) for key in fields(self) if key.init}
        if changes.keys() & THINGS:
            return Scene(**{**values, **changes})
        twin = copy(self)
        for name in ("_hash", "surfaces", "pegs"):
            vars(twin).pop(name, None)
        twin._settle(**{key: value for key, value in {**values, **changes}.items() if key not in THINGS})
        _check_kinds(twin)
        if twin.moving_walls:
            _check_moving(twin)
        return twin

    def data(self) -> dict[str, Any]:
        """The scene as plain text and whole numbers, in the form of the scene files."""
        data: dict[str, Any] = {"name": self.name, "tie_policy": str(self.tie_policy)}
        if self.description:
            data["description"] = self.description
        if self.source:
            data["source"] = self.source
        for key in ("reverse_after", "events"):
            if getattr(self, key) is not None:
                data[key] = getattr(self, key)
        for key in ("reverse_at", "until"):
            if getattr(self, key) is not None:
                data[key] = getattr(self, key).text()
        if self.capture:
            data["capture"] = True
        if not self.elastic:
            data["restitution"] = self.restitution.text()
        if self.gravity is not None:
            data["gravity"] = [part.text() for part in self.gravity]
        if self.settle:
            data["settle"] = True
        data["circle"] = [_texts(c, ("x", "y", "r", "vx", "vy", "m")) for c in self.circles]
        for circle, row in zip(self.circles, data["circle"], strict=True):
            if circle.point:
                row["point"] = True
        if self.walls:
            data["wall"] = [_texts(w, ("x0", "y0", "x1", "y1")) for w in self.walls]
            for wall, row in zip(self.walls, data["wall"], strict=True):
                if wall.kind != Wall.kind:
                    row["kind"] = wall.kind
                row.update(_pace(wall))
        if self.segments:
            data["segment"] = [_texts(s, ("x0", "y0", "x1", "y1", "r")) for s in self.segments]
            for segment, row in zip(self.segments, data["segment"], strict=True):
                if row["r"] == "0":
                    del row["r"]
                row.update(_pace(segment))
        if self.polygons:
            data["polygon"] = [
                {"id": p.id, "points": [[x.text(), y.text()] for x, y in p.points]} for p in self.polygons
            ]
            for polygon, row in zip(self.polygons, data["polygon"], strict=True):
                if polygon.r.sign() != 0:
                    row["r"] = polygon.r.text()
                row.update(_pace(polygon))
        if self.arcs:
            data["arc"] = [
                {**_texts(a, ("x", "y", "r")), "full": True} if a.full else
                _texts(a, ("x", "y", "r", "x0", "y0", "x1", "y1"))
                for a in self.arcs
            ]  # fmt: skip
        if self.pockets:
            data["pocket"] = [_texts(p, ("x", "y", "r")) for p in self.pockets]
        return data

    def _repr_html_(self) -> str:
        """The circles as a table, and a picture of them at time 0, for a notebook."""
        from .errors import shortened
        from .pictures import html_table, scene_picture, shown

        keys = ("x", "y", "r", "vx", "vy", "m")
        rows = ([shortened(text) for text in _texts(circle, keys).values()] for circle in self.circles)
        table = html_table(f"{self.name}: {made_of(self)}; {self.tie_policy}", ("id", *keys), rows, len(self.circles))
        return shown(table, self, lambda: scene_picture(self, standalone=True), f"{self.name} at time 0")

    def __str__(self) -> str:
        """Its name, and of how many things it is made."""
        return f"{self.name}: {made_of(self)}"

    @property
    def digest(self) -> str:
        """SHA-256 of what decides the history: everything but name, description, source and default horizon."""
        import json
        from hashlib import sha256

        told = {"name", "description", "source", "until", "events"}
        data = {key: value for key, value in self.data().items() if key not in told}
        return sha256(json.dumps(data, sort_keys=True).encode()).hexdigest()


def _ingredients(scene: Scene) -> tuple[object, ...]:
    """What scenes are told apart by; of `surfaces` the sides of arcs too, which are no field."""
    return *(getattr(scene, item.name) for item in fields(scene) if item.compare), scene.arc_sides


def made_of(scene: Scene) -> str:
    """Of how many things a scene is made.

    >>> made_of(Scene([Circle(0, 0)], [Wall(0, -2, 1, -2), Wall(0, 2, 1, 2)]))
    '1 circle, 2 walls'
    """
    kinds = (
        *(("circle", scene.circles), ("wall", scene.walls), ("segment", scene.segments)),
        *(("polygon", scene.polygons), ("arc", scene.arcs), ("pocket", scene.pockets)),
    )
    return ", ".join(f"{len(things):,} {kind}{'s' * (len(things) != 1)}" for kind, things in kinds if things)


Thing = TypeVar("Thing", Circle, Wall, Pocket, Segment, Polygon, Arc)


def _named(things: Iterable[Thing], letter: str) -> list[Thing]:
    """The things, those without an id named by letter and number."""
    named = list(things)
    for k, thing in enumerate(named):
        if thing.id is None:
            named[k] = copy(thing)
            object.__setattr__(named[k], "id", f"{letter}{k + 1}")
    return named


def _texts(thing: Any, keys: tuple[str, ...]) -> dict[str, Any]:
    row: dict[str, Any] = {"id": thing.id}
    for key in keys:
        value = getattr(thing, key)
        row[key] = value if isinstance(value, str) else value.text()
    return row


def _pace(thing: Wall | Segment | Polygon) -> dict[str, str]:
    """The parts of its velocity that are not zero."""
    return {key: value.text() for key in ("vx", "vy") if (value := getattr(thing, key)).sign()}


# -- what is refused


def _check_falling(scene: Scene) -> None:
    """Refuses what is met under gravity in ways that are not there yet."""
    fixed = next((circle for circle in scene.circles if circle.fixed), None)
    if scene.reverse_after is not None or scene.reverse_at is not None:
        key = "reverse_at" if scene.reverse_after is None else "reverse_after"
        found = "" if fixed is None else f"circle {fixed.id!r} is fixed"
        for kind, things in (
            ("segment", scene.segments),
            ("polygon", scene.polygons),
            ("arc", scene.arcs),
            ("pocket", scene.pockets),
        ):
            found = found or (f"{kind} {things[0].id!r} is there" if things else "")
        if found:
            raise SceneError(f"gravity: {found}, and no run is turned back there; leave {key} out")


def _check_settling(scene: Scene) -> None:
    """Refuses what settling has no meaning for, and what it is not followed beside."""
    if scene.gravity is None:
        raise SceneError(
            "settle = true: without gravity nothing is at rest on a wall; write gravity, or leave settle out"
        )
    for key in ("reverse_after", "reverse_at"):
        if getattr(scene, key) is not None:
            raise SceneError(f"settle = true: cannot be turned back, as what has settled stays; leave {key} out")
    moving = next((f"wall {wall.id!r}" for wall in scene.walls if wall.moves), scene.moving_solid)
    found = "" if moving is None else f"{moving} moves"
    for kind, things in (("arc", scene.arcs), ("pocket", scene.pockets)):
        found = found or (f"{kind} {things[0].id!r} is round" if things else "")
    if found:
        raise SceneError(f"settle = true: {found}, and what has settled is not followed beside it; leave settle out")


def _check_kinds(scene: Scene) -> None:
    """Refuses what walls of other kinds are not known to be right with."""
    hindrances = {
        "gravity": scene.gravity is not None,
        "reverse_after": scene.reverse_after is not None,
        "reverse_at": scene.reverse_at is not None,
        "walls that move": scene.moving_walls,
    }
    found = next((name for name, there in hindrances.items() if there), None)
    if scene.other_walls and found:
        wall = scene.other_walls[0]
        raise SceneError(f"wall {wall.id!r}: a {wall.kind} does not go with {found}; leave one of them out")


def _check_moving(scene: Scene) -> None:
    """Refuses what cannot be beside walls that move: a reversal, and a circle for which they leave no room."""
    moving = next((f"wall {wall.id!r}" for wall in scene.walls if wall.moves), scene.moving_solid)
    if scene.reverse_after is not None or scene.reverse_at is not None:
        key = "reverse_at" if scene.reverse_after is None else "reverse_after"
        raise SceneError(f"{moving}: moves: cannot be turned back, as walls go on; leave {key} out")
    for crushed in scene.closing:
        if crushed.time.sign() == 0:
            one, other = (scene.ids[len(scene.circles) + k] for k in crushed.walls)
            raise SceneError(
                f"circle {scene.ids[crushed.circle]!r}: walls {one!r} and {other!r} touch it and close at time 0; "
                "move them apart"
            )


def _check_things(scene: Scene) -> None:
    if not scene.circles:
        raise SceneError("the scene has no circle; add at least one circle")
    if len(scene.circles) > MAX_CIRCLES:
        raise SceneError(f"the scene has {len(scene.circles)} circles; at most {MAX_CIRCLES}")
    seen: set[str | None] = set()
    for thing in (*scene.circles, *scene.walls, *scene.pockets, *scene.segments, *scene.polygons, *scene.arcs):
        if thing.id in seen:
            raise SceneError(f"id {thing.id!r} is used twice; give everything an id of its own")
        seen.add(thing.id)
