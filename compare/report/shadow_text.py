"""What came of looking for a shadow, on the terminal."""

from __future__ import annotations

from decimal import ROUND_CEILING, Context, Decimal
from typing import TYPE_CHECKING

from ..files.amounts import counted
from .output import console, say

if TYPE_CHECKING:
    from ..shadowing.shadows import Proof, Shadow


def sentences(told: Shadow) -> list[str]:
    """What was found, most important first."""
    left = told.divergence
    whose = f"{told.engine} over {counted(told.events, 'event')}"
    found: list[str] = []
    if told.proof is not None:
        found.append(f"Proved: {_claim(told.proof, whose)}.")
        if told.proof.swaps:
            found.append(
                f"In the whole order {counted(told.proof.swaps, 'contact')} stand elsewhere: independent ones, swapped."
            )
    elif told.blocked is not None:
        found.append(f"Not found: no shadow of {whose}. What stands in the way: {told.blocked.obstacle.value}.")
        found.append(f"{told.blocked.message[0].upper()}{told.blocked.message[1:]}.")
    if left is None:
        found.append("The run has not left the certified history of the scene's own start.")
    else:
        met, got = (name or "nothing" for name in (left.expected, left.got))
        beyond = told.events - left.event - 1 if told.proof is not None else 0
        more = f"; the shadow goes on for {counted(beyond, 'event')} more" if beyond > 0 else ""
        found.append(
            f"The run leaves the certified history of the scene's own start at event {left.event} ({left.body} meets "
            f"{got} instead of {met}){more}."
        )
    if told.drift is not None:
        found.append(f"The engine's energy drifts by {told.drift:.2g} of itself, that of a true orbit by nothing.")
    return found


UPWARDS = Context(prec=3, rounding=ROUND_CEILING)


def at_most(bound: float) -> str:
    """An upper bound in three digits, rounded up: it must not be told too small.

    >>> at_most(3.7643e-13)
    '3.77e-13'
    """
    return f"{UPWARDS.create_decimal(Decimal(bound)):.3g}"


def _claim(proof: Proof, whose: str) -> str:
    start, apart = proof.start, proof.run_distance
    return (
        f"a start within {at_most(start.position)} (velocities: {at_most(start.velocity)}) of the scene's has the "
        f"order of contacts of {whose}, and stays within {at_most(apart.position)} of it throughout (velocities: "
        f"{at_most(apart.velocity)}, times of contacts: {at_most(apart.time)})"
    )


def print_shadow(told: Shadow, best: Shadow | None = None) -> None:
    """Prints it on stdout; `best` is the shadow of a shorter beginning."""
    out = console()
    first, *others = sentences(told)
    say(out, f"{told.scene.name}: {first}", "bold")
    for sentence in others:
        say(out, sentence)
    if best is not None and best is not told:
        say(out, f"Of a shorter beginning: {sentences(best)[0]}", "bold")
