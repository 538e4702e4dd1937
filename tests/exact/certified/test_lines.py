"""A wall in the short numbers of predictions is the scene's own: its normal to the circle's side, and r |n|."""

from __future__ import annotations

import contextlib
from collections import Counter

import pytest

from truebreak.exact.certified import filtered as prediction
from truebreak.exact.certified.filtered import FilteredPredictor
from truebreak.exact.replay.refinable import RefinableState
from truebreak.exact.simulation.prediction import ArrivalQueue
from truebreak.scenarios import Circle, Quantity, Scene, Wall

WALLS = {
    "oblique": Wall(-8, -9, 9, -7),
    "of roots": Wall(-8, 0, "-8 + sqrt(2)", "sqrt(3)"),
    "level": Wall(-8, -9, 5, -9),
    "upright": Wall(-8, 3, -8, 11),
}


class Exact:
    """An exact number in the place of a ball."""

    def __init__(self, value: Quantity) -> None:
        self.value = value

    def __pos__(self) -> Exact:
        return self


@pytest.mark.parametrize("turned", [False, True], ids=["one side", "the other"])
@pytest.mark.parametrize("name", WALLS)
def test_a_line_is_the_wall_s_with_the_radius_in_the_scale_of_its_normal(name, turned, monkeypatch):
    wall = WALLS[name]
    if turned:
        wall = Wall(wall.x1, wall.y1, wall.x0, wall.y0)
    circle = Circle(20, 30, "sqrt(5)/3")
    scene = Scene([circle], [wall])
    state = RefinableState(scene, 128)
    predictor = FilteredPredictor(scene, state, ArrivalQueue(state.bodies), Counter(), lambda link: None)
    monkeypatch.setattr(prediction.ball, "constant", Exact)
    monkeypatch.setattr(prediction.ball, "precision", lambda bits: contextlib.nullcontext())
    x0, y0, nx, ny, offset = (number.value for number in predictor.line(state.bodies[0], 0))
    along = wall.x1 - wall.x0, wall.y1 - wall.y0
    assert nx * along[0] + ny * along[1] == 0
    assert along[0] * (y0 - wall.y0) - along[1] * (x0 - wall.x0) == 0
    assert nx * (circle.x - x0) + ny * (circle.y - y0) > 0
    assert offset > 0
    assert offset * offset == circle.r * circle.r * (nx * nx + ny * ny)
