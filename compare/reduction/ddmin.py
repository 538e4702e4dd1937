"""Delta debugging: which items of a list are needed for something to remain."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import chain, pairwise
from typing import TypeVar

Item = TypeVar("Item")


def ddmin(items: Sequence[Item], still: Callable[[Sequence[Item]], bool], parts: int = 2) -> list[Item]:
    """A part of `items` on which `still` holds, and from which no single item can be left out.

    The list is cut into parts; a part that is enough by itself is taken, else what is enough without one part; else
    the parts are halved. At the finest cut only what is left without one item is asked for. `still` is taken to hold
    on all of `items`; of n items it is asked n**2 + 3 n times at most.

    Args:
        parts: into how many the list is cut at first; as many as there are items: each is left out by itself.

    Source: A. Zeller and R. Hildebrandt, *Simplifying and isolating failure-inducing input*, IEEE Transactions on
    Software Engineering 28 (2002), 183-200: algorithm ddmin.

    >>> ddmin(range(1, 9), lambda kept: {1, 7, 8} <= {*kept})
    [1, 7, 8]
    >>> ddmin("abc", lambda kept: True)
    []
    """
    kept = list(items)
    if not kept or still([]):
        return []
    parts = max(2, min(parts, len(kept)))
    while len(kept) >= 2:
        pieces = cut(kept, parts)
        smaller = next((p for p in pieces if still(p)), None) if parts < len(kept) else None
        if smaller is not None:
            kept, parts = smaller, 2
            continue
        rests = ([*chain(*pieces[:k], *pieces[k + 1 :])] for k in range(parts))
        smaller = next((rest for rest in rests if still(rest)), None)
        if smaller is not None:
            kept, parts = smaller, max(parts - 1, 2)
        elif parts < len(kept):
            parts = min(2 * parts, len(kept))
        else:
            break
    return kept


def cut(items: Sequence[Item], parts: int) -> list[list[Item]]:
    """A list in so many runs of about the same length.

    >>> cut([1, 2, 3, 4, 5], 2)
    [[1, 2], [3, 4, 5]]
    """
    ends = [len(items) * k // parts for k in range(parts + 1)]
    return [list(items[low:high]) for low, high in pairwise(ends)]
