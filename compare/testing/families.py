"""Names of scenes in families: `gas:n=3..8` is six of them."""

from __future__ import annotations

import re
from itertools import product

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
