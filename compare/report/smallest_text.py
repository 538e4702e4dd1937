"""The smallest scene on which an engine diverges, or breaks a law, on the terminal."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..reduction.smallest import SceneSize
from .output import console, counted, grid, say
from .sentences import divergence_phrase
from .terminal import print_comparison

if TYPE_CHECKING:
    from ..reduction.smallest import Smallest


def print_smallest(found: Smallest) -> None:
    """Prints what was left out, step by step with the verdict on what was left, and the comparison of the last."""
    out = console()
    say(out, f"{found.original.name}: {size_phrase(SceneSize.of(found.original))}")
    say(out, f"still shown by: {size_phrase(SceneSize.of(found.scene))}", "bold")
    say(out, f"{counted(found.runs, 'comparison')}; {found.end.value}.", None if found.minimal else "yellow")
    if found.steps:
        table = grid("comparison", "left out", "on what is left", whole=("comparison",))
        for step in found.steps:
            candidate = step.comparison.candidates[0]
            broken = candidate.laws.finding if found.law and candidate.laws is not None else None
            phrase = broken or divergence_phrase(step.comparison, candidate)
            table.add_row(f"{step.runs:,}", step.told, phrase)
        out.print(table)
    print_comparison(found.comparison)


def size_phrase(size: SceneSize) -> str:
    """A size in words; the characters are those of the numbers.

    >>> size_phrase(SceneSize(2, 4, 0, None, 39))
    '2 circles, 4 walls, 39 characters'
    """
    things = [(size.circles, "circle"), (size.walls, "wall"), (size.pockets, "pocket"), (size.events, "event")]
    told = [counted(number, noun) for number, noun in things if number]
    return ", ".join([*told, counted(size.characters, "character")])
