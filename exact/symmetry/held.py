"""Circles that an isometry of their own past holds to a line or a point."""

from __future__ import annotations

from flint import arb

from ...scenarios.scene import Scene
from ..numbers.field import field_ball
from ..replay.body import Body
from ..replay.refinable import Projection
from .isometry import Isometry
from .log_symmetry import LogSymmetry
from .scene_symmetry import Symmetry, symmetries

AXIS_BITS = 256
"""Precision of a mirror line's place: where it is not exact in so many bits, circles are projected."""


class Held:
    """Tells, of a circle, the projection on what the symmetries of its past leave in place.

    The mirrors and rotations of the scene at time 0 are the candidates; that one maps a circle's past to itself is
    proved on the log each time (`LogSymmetry`), so neither an order chosen nor a flaw elsewhere makes it wrong. The
    circle's place and velocity then lie on the mirror line, or at the centre: in the image of the projection, which
    is the mean of the linear parts, those of a group.
    """

    def __init__(self, scene: Scene, log: LogSymmetry) -> None:
        self._log = log
        self._own: dict[int, list[tuple[Symmetry, Isometry]]] = {}
        self._means: dict[tuple[int, ...], Projection] = {}
        for symmetry in symmetries(scene):
            isometry = log.isometry_about(symmetry.matrix, symmetry.centre)
            for i, image in enumerate(symmetry.circles):
                if image == i and isometry is not None:
                    self._own.setdefault(i, []).append((symmetry, isometry))

        self._axes = {i: axis for i, own in self._own.items() if (axis := _axis(own)) is not None}

    def __bool__(self) -> bool:
        """Whether there is any circle that a symmetry of the scene leaves in place."""
        return bool(self._own)

    def stands(self, body: Body[arb]) -> bool:
        """Whether a body's balls have it exactly on its one mirror line, along an axis: there is nothing to hold."""
        axis = self._axes.get(body.index)
        if axis is None:
            return False
        (level, offset), flight = axis, body.flight
        if level:
            return flight.vy.is_zero() and (flight.y - offset).is_zero()
        return flight.vx.is_zero() and (flight.x - offset).is_zero()

    def __call__(self, i: int) -> Projection | None:
        """The projection for a circle, or None if nothing is known to hold it."""
        own = self._own.get(i)
        if own is None:
            return None
        kept = [symmetry for symmetry, isometry in own if self._log.follows(isometry, i)]
        if not kept:
            return None
        key = tuple(id(symmetry) for symmetry in kept)
        if key not in self._means:
            self._means[key] = _mean(kept)
        return self._means[key]


def _axis(own: list[tuple[Symmetry, Isometry]]) -> tuple[bool, arb] | None:
    """Whether the one mirror of a circle is level (else it may be upright), and the line's other coordinate."""
    (symmetry, _), *more = own
    if more or symmetry.matrix not in {(1, 0, 0, -1), (-1, 0, 0, 1)}:
        return None
    level = symmetry.matrix[0] == 1
    return level, field_ball(symmetry.centre[1 if level else 0], AXIS_BITS)


def _mean(kept: list[Symmetry]) -> Projection:
    """The mean of linear parts and the identity, and the centre."""
    totals = [sum((s.matrix[k] for s in kept[1:]), start=kept[0].matrix[k] + (k in (0, 3))) for k in range(4)]
    return tuple(total / (len(kept) + 1) for total in totals), kept[0].centre
