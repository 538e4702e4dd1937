"""What contacts of one circle that push together do to displacements: the derivative of one round of impulses."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from ...tangent.impacts import Impact


@dataclass(frozen=True)
class Pushed:
    """A round of impulses upon displaced circles.

    Attributes:
        columns: shape (circles, 4, k), the displacements after it.
        waits: shape (contacts, k): by how much each displacement delays each contact.
    """

    columns: NDArray[np.float64]
    waits: NDArray[np.float64]


def push_together(
    columns: NDArray[np.float64], row: Mapping[int, int], weights: NDArray[np.float64], struck: Sequence[Impact]
) -> Pushed | None:
    """Displacements after a round in which contacts push together, each at its own displaced time.

    With J v for the speeds at which the contacts open, and W for the inverse masses, the round adds W J' s to the
    velocities, where J W J' s = -2 J v. Its derivative, to the first order: J turns with the lines of centres, as
    they are when each contact comes, and v changes with its displacement; a contact that comes later by tau leaves
    what it pushes tau times the change of velocity behind. One contact alone gives `pair_tangent`.

    Args:
        columns: shape (circles, 4, k), displacements at the instant, of the circles that can move.
        row: the row of each of those circles, by index.
        weights: inverse masses, by row.
        struck: the contacts, all with the velocities that the round finds.

    Returns:
        None where the impulses are not unique: then they have no derivative.
    """
    count, errors = len(weights), columns.shape[2]
    lines, turned = np.zeros((len(struck), count, 2)), np.zeros((len(struck), 2, errors))
    opening, waits = np.zeros(len(struck)), np.zeros((len(struck), errors))
    for k, hit in enumerate(struck):
        a, b, reach = row.get(hit.a), None if hit.b is None else row.get(hit.b), float(hit.reach)
        normal, speed = np.array([float(hit.dx), float(hit.dy)]) / reach, np.array([float(hit.vx), float(hit.vy)])
        between = np.zeros((2, errors))
        for place, side in ((a, 1.0 if hit.b is None else -1.0), (b, 1.0)):
            if place is not None:
                lines[k, place] += side * normal
                between += side * columns[place, :2]
        opening[k] = normal @ speed
        waits[k] = -(normal @ between) / opening[k]
        if hit.b is not None:
            turned[k] = (between + speed[:, None] * waits[k]) / reach
    system = np.einsum("kmx,m,lmx->kl", lines, weights, lines)
    if np.linalg.matrix_rank(system) < len(struck):
        return None
    strengths = -2 * np.linalg.solve(system, opening)
    kicks = np.einsum("m,kmx,k->kmx", weights, lines, strengths)
    aside = np.zeros((count, 2, errors))
    faster = np.einsum("kmx,mxe->ke", lines, columns[:, 2:])
    for k, hit in enumerate(struck):
        for name, side in ((hit.a, -1.0), (hit.b, 1.0)):
            place = None if name is None or hit.b is None else row.get(name)
            if place is not None:
                aside[place] += side * weights[place] * strengths[k] * turned[k]
                faster[k] += side * kicks[:, place].sum(axis=0) @ turned[k] / 2
        faster[k] += np.array([float(hit.vx), float(hit.vy)]) @ turned[k]
    stronger = np.linalg.solve(system, -2 * faster - np.einsum("kmx,mxe->ke", lines, aside))
    after = columns.copy()
    after[:, 2:] += aside + np.einsum("m,kmx,ke->mxe", weights, lines, stronger)
    after[:, :2] -= np.einsum("kmx,ke->mxe", kicks, waits)
    return Pushed(after, waits)
