"""Scenes for tests: names in families, such as `gas:n=3..8`, and strategies of hypothesis."""

from __future__ import annotations

import re
from fractions import Fraction
from itertools import product
from typing import TYPE_CHECKING, Any

from ...scenarios.errors import SceneError
from ...scenarios.numbers.quantity import Quantity
from ...scenarios.scene import Scene
from ...scenarios.things import Circle, Wall

if TYPE_CHECKING:
    from hypothesis.strategies import DrawFn, SearchStrategy

RANGE = re.compile(r"(?P<first>\d+)\.\.(?P<last>\d+)")

MOST = 1_000
"""The most scenes that one text may stand for."""


def truebreak_scenes(*specs: str) -> list[str]:
    """Names of scenes, for `pytest.mark.parametrize("scene", truebreak_scenes("cradle", "gas:n=3..8"))`.

    A range `FIRST..LAST` in a setting stands for every whole number in it; several ranges for all their combinations.

    Raises:
        SceneError: for a name that the catalogue does not have, and for a range that is empty or too long.

    >>> truebreak_scenes("lee", "gas:n=3..4,seed=1..2")
    ['lee', 'gas:n=3,seed=1', 'gas:n=3,seed=2', 'gas:n=4,seed=1', 'gas:n=4,seed=2']
    """
    from ...scenarios.catalogue.scene_table import entry
    from ...scenarios.errors import SceneError
    from ..scene_argument import FILE_SUFFIXES

    found: list[str] = []
    for spec in specs:
        if not spec.lower().endswith(FILE_SUFFIXES):
            entry(spec.partition(":")[0].strip())
        parts = RANGE.split(spec)
        ranges = [range(int(a), int(b) + 1) for a, b in zip(parts[1::3], parts[2::3], strict=True)]
        count = 1
        for numbers in ranges:
            count *= len(numbers)
        if not 0 < count <= MOST:
            raise SceneError(f"scenes {spec!r}: stands for {count} scenes; 1 to {MOST} are possible")
        for numbers in product(*ranges):
            texts = [*map(str, numbers), ""]
            found.append("".join(word for pair in zip(parts[0::3], texts, strict=True) for word in pair))
    return found


# ----------------------------------------
# Strategies of hypothesis: scenes that shrink to ones that a person can read.

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
