"""JSON values with one part changed: what a forger, or a program with a fault, may write into a file."""

from __future__ import annotations

import copy
import random
from collections.abc import Iterator
from typing import Any

NONSENSE: tuple[Any, ...] = (
    *(
        None,
        True,
        False,
        0,
        1,
        -1,
        3,
        2**70,
        -(2**70),
        0.5,
        1e308,
        "",
        "x",
        "0",
        "1/3",
        "-7",
        "1/0",
        "sqrt(2)",
        "\u202e",
    ),
    *(
        [],
        [[]],
        [0, 1],
        [0, 99],
        ["a", "b"],
        {},
        {"a": 1},
        [1, 2, 3, 4],
        ["ff", 0, 1, 2],
        ["1", 10**12, 1, 0],
        "9" * 200,
    ),
)
"""What takes the place of a part."""


def places(value: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """The path of every part of a value, its own left out."""
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, part in items:
        yield (*path, key)
        yield from places(part, (*path, key))


def mutated(data: Any, seed: int) -> tuple[str, Any]:
    """A copy with one part changed, left out, doubled or exchanged with another, and what was done.

    Half of the parts are drawn by their key at the top, so that the short ones have their share.
    """
    draw = random.Random(seed)
    changed = copy.deepcopy(data)
    key = draw.choice(sorted(data))
    within = [(key, *path) for path in places(data[key])] or [(key,)]
    path = draw.choice(within if draw.random() < 0.5 else list(places(data)))
    holder = changed
    for step in path[:-1]:
        holder = holder[step]
    last, what = path[-1], draw.choice(("other", "other", "other", "gone", "twice", "nested"))
    if what == "gone":
        del holder[last]
    elif what == "twice" and isinstance(holder, list):
        holder.insert(last, copy.deepcopy(holder[last]))
    elif what == "nested":
        holder[last] = [holder[last]]
    else:
        holder[last] = copy.deepcopy(draw.choice(NONSENSE))
    return f"{seed}: {what} at {'/'.join(map(str, path))}", changed
