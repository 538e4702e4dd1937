"""The derivative of a round in which contacts of one circle push together."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from truebreak.compare.tangent.growth import Displacements, push_together, unit_displacements
from truebreak.compare.tangent.impacts import Impact, NoTangentMap, rounds
from truebreak.exact import ExactEngine
from truebreak.scenarios import Circle, Scene, catalogue

PLACES = np.array([[0.0, 0.0], [3.0**0.5, 1.0], [3.0**0.5, -1.0]])
SPEEDS = np.array([[1.0, 0.1], [0.0, 0.2], [-0.3, 0.0]])
WEIGHTS = np.array([1.0, 1 / 2, 1 / 3])
LINKS = ((0, 1), (0, 2))
ROWS = {0: 0, 1: 1, 2: 2}


def impact(i: int, j: int) -> Impact:
    return Impact(0.0, i, j, *(PLACES[j] - PLACES[i]), *(SPEEDS[j] - SPEEDS[i]), 2.0, WEIGHTS[i], WEIGHTS[j])


def pushed(places: NDArray[np.float64], speeds: NDArray[np.float64]) -> NDArray[np.float64]:
    """The impulses by their law: each contact's line is that of the moment at which it comes."""
    lines, waits = np.zeros((len(LINKS), 3, 2)), np.zeros(len(LINKS))
    for k, (i, j) in enumerate(LINKS):
        d, v = places[j] - places[i], speeds[j] - speeds[i]
        waits[k] = (d @ d - 4) / (-(d @ v) + np.sqrt((d @ v) ** 2 - v @ v * (d @ d - 4)))
        lines[k, j], lines[k, i] = (d + waits[k] * v) / 2, -(d + waits[k] * v) / 2
    system = np.einsum("kmx,m,lmx->kl", lines, WEIGHTS, lines)
    strengths = np.linalg.solve(system, -2 * np.einsum("kmx,mx->k", lines, speeds))
    kicks = np.einsum("m,kmx,k->kmx", WEIGHTS, lines, strengths)
    return np.hstack([places - np.einsum("kmx,k->mx", kicks, waits), speeds + kicks.sum(axis=0)])


def test_it_is_the_derivative_of_the_law() -> None:
    columns, step = np.eye(12).reshape(3, 4, 12), 2.0**-20
    found = push_together(columns, ROWS, WEIGHTS, [impact(*link) for link in LINKS])
    assert found is not None
    for k in range(12):
        ends = [pushed(PLACES + s * columns[:, :2, k], SPEEDS + s * columns[:, 2:, k]) for s in (step, -step)]
        assert np.abs((ends[0] - ends[1]) / (2 * step) - found.columns[:, :, k]).max() < 1e-8


def test_contacts_that_share_no_circle_are_as_if_one_by_one() -> None:
    scene = Scene([Circle(0, 0, vx=1), Circle(10, 1, m=2), Circle(20, 2, m=3)])
    struck = [impact(0, 1), Impact(0.0, 2, None, 3.0, 4.0, -1.0, 0.2, 5.0, 0.0, 0.0)]
    carried = Displacements(scene, unit_displacements(scene))
    carried.through(struck)
    found = push_together(unit_displacements(scene), ROWS, WEIGHTS, struck)
    assert found is not None
    assert np.abs(found.columns - carried.columns).max() < 1e-15


def test_impulses_that_are_not_unique_have_no_derivative() -> None:
    assert push_together(np.eye(12).reshape(3, 4, 12), ROWS, WEIGHTS, [impact(0, 1), impact(0, 1)]) is None


def test_rounds_are_those_of_the_log() -> None:
    run = ExactEngine().run(catalogue.build("rack:rows=2"), events=1)
    told = [[(hit.a, hit.b) for hit in struck] for struck in rounds(run, 1)[0]]
    assert told == [[(0, 1)], [(1, 2), (1, 3)], [(0, 1)]]
    turned = ExactEngine().run(catalogue.build("reversal:n=3,after=5"))
    with pytest.raises(NoTangentMap, match="turn back, or a circle leaves play, after 5 events"):
        rounds(turned, 8)
    assert len(rounds(turned, 5)) == 5
