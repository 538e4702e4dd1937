"""`check` grants what rounding a wall's two points makes of it where a disc meets it, far from both."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import pytest

from truebreak.compare.testing.check import CheckFailed, check
from truebreak.floating import SingleEngine
from truebreak.scenarios import Circle, Scene, Wall

if TYPE_CHECKING:
    from truebreak.scenarios.trajectory import Trajectory


def box(north: Wall) -> Scene:
    """Two discs among four walls that lie across, of which one is given."""
    walls = [
        Wall(0, -5, "499/490", "-2383/490", id="south"),
        Wall(5, 0, "1258/245", "-213/245", id="east"),
        Wall(-5, 0, "-144/35", "276/35", id="west"),
    ]
    discs = [
        Circle("-17/10", "9/5", "1/2", "-9/5", "5/7", id="a"),
        Circle("3/2", "4/5", "2/3", "9/5", "-3/7", id="b"),
    ]
    return Scene(discs, [*walls, north], events=4)


FAR = box(Wall("274988999/45", "-59241553/90", "2694892750/441", "-290283670/441", id="north"))
"""The points of the wall to the north are 6 million away: in 24 bits it is up to half a unit off."""

NEAR = box(Wall(0, 5, "9/2", "32/7", id="north"))


class OtherWall(SingleEngine):
    """`single`, which takes one wall for a thousandth farther away."""

    def run(self, scene: Scene, **limits: Any) -> Trajectory:
        south, w, *walls = scene.walls
        other = Wall(w.x0 + "1/1000", w.y0, w.x1 + "1/1000", w.y1, id=w.id)
        return replace(super().run(scene.with_changes(walls=[south, other, *walls]), **limits), scene=scene)


@pytest.mark.parametrize("scene", [FAR, NEAR])
@pytest.mark.parametrize("name", ["single", "double", "quad"])
def test_a_wall_that_rounding_moves_is_no_fault_of_the_engine(name: str, scene: Scene) -> None:
    """`single` was said to take the wrong wall."""
    assert check(name, scene).asserted


def test_a_wall_in_another_place_is_found_all_the_same() -> None:
    """Numbers of `single` are off by 6e-8 of themselves, and the wall by a thousandth."""
    with pytest.raises(CheckFailed):
        check(OtherWall(), NEAR)
