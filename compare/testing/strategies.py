"""Strategies of hypothesis: scenes that shrink to ones that a person can read."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING, Any

from ...scenarios.errors import SceneError
from ...scenarios.numbers.quantity import Quantity
from ...scenarios.scene import Scene
from ...scenarios.things import Circle, Wall

if TYPE_CHECKING:
    from hypothesis.strategies import DrawFn, SearchStrategy

CELL = 4
"""Circles of radius 1 lie in cells this wide, less than a unit from the middle: none touches another."""

MOST_COLUMNS = 4
"""Cells side by side."""


def scenes(
    circles: int | tuple[int, int] = (2, 5), walls: int | tuple[int, int] = (0, 4), touching: bool = False
) -> SearchStrategy[Scene]:
    """Scenes of circles of radius 1 on a grid, within up to four walls round it; no circle is fixed.

    Numbers are fractions with denominators up to 8; masses 1 to 4. They shrink towards few circles at rest in the
    middle of their cells, whole numbers and no wall. Every scene is valid.

    Args:
        circles, walls: how many, or the least and the most.
        touching: circles may touch their neighbours in a row.

    Raises:
        SceneError: if hypothesis is not installed, or for numbers that cannot be.
    """
    try:
        from hypothesis import strategies as st
    except ImportError:
        raise SceneError("truebreak.testing.scenes: hypothesis is not installed; pip install hypothesis") from None
    few, many = _range("circles", circles, 1, 64)
    least, most = _range("walls", walls, 0, 4)
    fractions = st.fractions(min_value=-2, max_value=2, max_denominator=8)
    places = st.integers(-7, 7).map(lambda eighths: Fraction(eighths, 8))

    @st.composite
    def drawn(draw: DrawFn) -> Scene:
        count = draw(st.integers(few, many))
        found: list[Circle] = []
        for k in range(count):
            column, row = k % MOST_COLUMNS, k // MOST_COLUMNS
            dx, dy = draw(places), draw(places)
            x: Any = Quantity.of(CELL * column) + Quantity.of(dx)
            y: Any = Quantity.of(CELL * row) + Quantity.of(dy)
            if touching and column and draw(st.booleans()):
                x, y = found[-1].x + 2, found[-1].y
            vx, vy, m = draw(fractions), draw(fractions), draw(st.integers(1, 4))
            found.append(Circle(x, y, 1, vx, vy, m=m, id=f"c{k + 1}"))
        right = CELL * min(count, MOST_COLUMNS) + 2
        top = CELL * ((count - 1) // MOST_COLUMNS) + CELL + 2
        box = (
            Wall(-4, 0, -4, 1, id="left"),
            Wall(right, 0, right, 1, id="right"),
            Wall(0, -4, 1, -4, id="bottom"),
            Wall(0, top, 1, top, id="top"),
        )
        return Scene(found, box[: draw(st.integers(least, most))], name="drawn")

    return drawn()


def _range(key: str, value: int | tuple[int, int], lowest: int, highest: int) -> tuple[int, int]:
    low, high = (value, value) if isinstance(value, int) else value
    if not lowest <= low <= high <= highest:
        raise SceneError(f"scenes: {key} = {value!r}: must be within {lowest} to {highest}, the least first")
    return low, high
