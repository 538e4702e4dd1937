"""Engines of doubles that take segments for other than they are: each a fault that has to be found."""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass, replace
from typing import Any, ClassVar

from truebreak.floating import DoubleEngine
from truebreak.scenarios import Circle, Scene, Segment
from truebreak.scenarios.surfaces import SegmentFace

AWAY = 10**6
"""Where an end is put that nothing is to meet."""


def lowered(scene: Scene, circles: tuple[Circle, ...] | None = None, walls: Any = None) -> Scene:
    """A scene which engines see otherwise: with other faces, or other ends."""
    found, seen = copy(scene), copy(scene.surfaces)
    for name, value in (("circles", circles), ("walls", walls)):
        if value is not None:
            object.__setattr__(seen, name, value)
    for name in ("_hash", "ids"):
        vars(seen).pop(name, None)
    vars(found)["surfaces"] = seen
    return found


def _without_ends(scene: Scene) -> Scene:
    seen = scene.surfaces
    ends = [Circle(AWAY + 9 * k, AWAY, r=1, m="oo", id=seen.circles[k].id) for k in seen.ends]
    return lowered(scene, (*scene.circles, *ends))


def _range_turned(scene: Scene) -> Scene:
    """Each face runs on from its end, and not from its start."""
    faces = []
    for k in scene.surfaces.faces:
        face = scene.surfaces.walls[k]
        faces.append(
            SegmentFace(face.x1, face.y1, face.x1 + face.x1 - face.x0, face.y1 + face.y1 - face.y0, id=face.id)
        )
    return lowered(scene, walls=(*scene.walls, *faces))


def _thin(scene: Scene) -> Scene:
    return scene.with_changes(segments=[Segment(s.x0, s.y0, s.x1, s.y1, s.id) for s in scene.segments])


def _one_sided(scene: Scene) -> Scene:
    """The faces that are met from the right are somewhere else."""
    seen = scene.surfaces
    faces = [
        SegmentFace(AWAY + k, AWAY, AWAY + k, AWAY + 1, id=seen.walls[k].id) if (k - seen.faces.start) % 2 else
        seen.walls[k]
        for k in seen.faces
    ]  # fmt: skip
    return lowered(scene, walls=(*scene.walls, *faces))


def _endless(scene: Scene) -> Scene:
    """Each face is twice as long as it is, to both sides."""
    faces = []
    for k in scene.surfaces.faces:
        f = scene.surfaces.walls[k]
        ux, uy = f.x1 - f.x0, f.y1 - f.y0
        faces.append(SegmentFace(f.x0 - ux, f.y0 - uy, f.x1 + ux, f.y1 + uy, id=f.id))
    return lowered(scene, walls=(*scene.walls, *faces))


SEEN = {
    "no ends": _without_ends,
    "the range on the wrong side": _range_turned,
    "no thickness": _thin,
    "one side only": _one_sided,
    "faces too long": _endless,
}


@dataclass(frozen=True)
class SegmentFault(DoubleEngine):
    """The engine of doubles with one fault, by name."""

    fault: str = "no ends"
    stateless: ClassVar[bool] = True

    @property
    def name(self) -> str:
        """`faulty`."""
        return "faulty"

    def run(self, scene: Scene, **limits: Any) -> Any:
        """A run of the scene as the fault has it, handed back as one of the scene."""
        return replace(super().run(SEEN[self.fault](scene), **limits), scene=scene)
