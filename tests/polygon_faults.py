"""Engines of doubles that take polygons for other than they are: each a fault that has to be found."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, ClassVar

from segment_faults import AWAY, lowered

from truebreak.floating import DoubleEngine
from truebreak.scenarios import Circle, Polygon, Scene, Segment
from truebreak.scenarios.surfaces import SegmentFace


def _solids(scene: Scene) -> range:
    """The faces of the polygons, by index: one for each side, after those of the segments."""
    faces = scene.surfaces.faces
    return range(faces.start + 2 * len(scene.segments), faces.stop)


def _with_faces(scene: Scene, changed: dict[int, SegmentFace]) -> Scene:
    seen = scene.surfaces
    return lowered(scene, walls=tuple(changed.get(k, wall) for k, wall in enumerate(seen.walls)))


def _without_corners(scene: Scene) -> Scene:
    seen = scene.surfaces
    ends = [Circle(AWAY + 9 * k, AWAY, r=1, m="oo", id=seen.circles[k].id) for k in seen.ends]
    return lowered(scene, (*scene.circles, *ends))


def _open(scene: Scene) -> Scene:
    """The longest side is not there, and what comes in meets the others from within, too: an outline."""
    made = [*scene.segments]
    for k, polygon in enumerate(scene.polygons):
        sides = sorted(
            polygon.sides(), key=lambda side: float((side[0][0] - side[1][0]) ** 2 + (side[0][1] - side[1][1]) ** 2)
        )
        made += [Segment(*a, *b, id=f"{polygon.id}.{k}.{n}", r=polygon.r) for n, (a, b) in enumerate(sides[:-1])]
    return scene.with_changes(segments=made, polygons=[])


def _thin(scene: Scene) -> Scene:
    return scene.with_changes(polygons=[Polygon(p.points, p.id) for p in scene.polygons])


def _inside_out(scene: Scene) -> Scene:
    """Each face looks the other way."""
    walls = scene.surfaces.walls
    turned = {k: SegmentFace(w.x1, w.y1, w.x0, w.y0, id=w.id) for k in _solids(scene) if (w := walls[k])}
    return _with_faces(scene, turned)


def _one_side_lost(scene: Scene) -> Scene:
    walls = scene.surfaces.walls
    gone = {_solids(scene).start: SegmentFace(AWAY, AWAY, AWAY, AWAY + 1, id=walls[_solids(scene).start].id)}
    return _with_faces(scene, gone)


def _endless(scene: Scene) -> Scene:
    """Faces go on for their length beyond both ends."""
    long: dict[int, SegmentFace] = {}
    for k in _solids(scene):
        f = scene.surfaces.walls[k]
        ux, uy = f.x1 - f.x0, f.y1 - f.y0
        long[k] = SegmentFace(f.x0 - ux, f.y0 - uy, f.x1 + ux, f.y1 + uy, id=f.id)
    return _with_faces(scene, long)


SEEN = {
    "no corners": _without_corners,
    "an open outline": _open,
    "no thickness": _thin,
    "inside out": _inside_out,
    "a side lost": _one_side_lost,
    "faces too long": _endless,
}


@dataclass(frozen=True)
class PolygonFault(DoubleEngine):
    """The engine of doubles with one fault, by name."""

    fault: str = "no corners"
    stateless: ClassVar[bool] = True

    @property
    def name(self) -> str:
        """`faulty`."""
        return "faulty"

    def run(self, scene: Scene, **limits: Any) -> Any:
        """A run of the scene as the fault has it, handed back as one of the scene."""
        run = replace(super().run(SEEN[self.fault](scene), **limits), scene=scene)
        if self.fault != "an open outline":
            return run
        whole = {str(bar): str(bar).split(".")[0] for event in run.events for _, bar in event.contacts}
        events = tuple(
            replace(
                event,
                contacts=tuple(dict.fromkeys(type(pair)(pair[0], whole[pair[1]]) for pair in event.contacts)),
                impulses=tuple(type(pair)(pair[0], whole[pair[1]]) for pair in event.impulses),
                ties=(),
            )
            for event in run.events
        )
        return replace(run, events=events)
