"""Engines of doubles that take arcs for other than they are: each a fault that has to be found."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, ClassVar

from segment_faults import AWAY, lowered

from truebreak.floating import DoubleEngine
from truebreak.scenarios import Arc, Circle, Quantity, Scene


def _sides(scene: Scene, change: Any) -> Scene:
    """The scene with some sides of arcs put in the place of its own."""
    found = lowered(scene)
    vars(found.surfaces)["arc_sides"] = tuple(
        map(change, range(len(scene.surfaces.arc_sides)), found.surfaces.arc_sides)
    )
    return found


def _without_ends(scene: Scene) -> Scene:
    seen = scene.surfaces
    ends = [Circle(AWAY + 9 * k, AWAY, r=1, m="oo", id=seen.circles[k].id) for k in seen.ends]
    return lowered(scene, (*scene.circles, *ends))


def _outside_only(scene: Scene) -> Scene:
    """The hollow sides are somewhere else."""
    return _sides(scene, lambda k, side: replace(side, x=side.x + AWAY) if k % 2 else side)


def _complement(scene: Scene) -> Scene:
    """Each arc is what it leaves of its circle."""
    arcs = [
        Arc(a.x, a.y, a.r, full=True, id=a.id) if a.full else Arc(a.x, a.y, a.r, a.x1, a.y1, a.x0, a.y0, id=a.id)
        for a in scene.arcs
    ]
    return scene.with_changes(arcs=arcs)


def _rangeless(scene: Scene) -> Scene:
    return _sides(scene, lambda k, side: replace(side, full=True))


def _wide_within(scene: Scene) -> Scene:
    """From within each arc has a radius that is a tenth larger."""
    wide: Any = lambda side: side.r * Quantity.of("11/10")  # noqa: E731
    return _sides(scene, lambda k, side: replace(side, r=wide(side)) if k % 2 else side)


def _chord_as_half(scene: Scene) -> Scene:
    """The range of each arc is taken for a half-turn."""
    half: Any = lambda side: replace(side, h=Quantity.of(0))  # noqa: E731
    return _sides(scene, lambda k, side: side if side.full else half(side))


SEEN = {
    "no ends": _without_ends,
    "outside only": _outside_only,
    "the rest of the circle": _complement,
    "no range": _rangeless,
    "too wide within": _wide_within,
    "half-turns": _chord_as_half,
}


@dataclass(frozen=True)
class ArcFault(DoubleEngine):
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
