"""The tree of all orders of one instant, for people."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .output import console, counted, grid, say

if TYPE_CHECKING:
    from ...scenarios.scene import Scene
    from ...scenarios.trajectory import Stop
    from ..orders.all_orders import Leaf, OrderTree


def print_orders(scene: Scene, tree: OrderTree, stop: Stop | None = None) -> None:
    """The outcomes, one a row, with the choices that lead to each and the velocities at the end."""
    out = console()
    say(out, orders_sentence(scene, tree, stop), "bold")
    say(out, f"merged into an equal state: {tree.merged}; swaps of independent contacts left out: {tree.swapped}")
    table = grid("outcome", "first among several", "collisions", "velocities at the end")
    for number, outcome in enumerate(tree.outcomes):
        cells = (str(number), choices_phrase(outcome), str(outcome.trajectory.collisions), velocities_phrase(outcome))
        table.add_row(*cells)
    out.print(table)


def orders_sentence(scene: Scene, tree: OrderTree, stop: Stop | None = None) -> str:
    """How many outcomes there are, and whether these are all."""
    found = counted(len(tree.outcomes), "outcome")
    if tree.complete and tree.unproved:
        return (
            f"{scene.name}: at least {found}, over all orders of simultaneous impulses; of "
            f"{counted(tree.unproved, 'more order')} it is not proved that the end is one of these."
        )
    if tree.complete:
        return f"{scene.name}: {found}, over all orders of simultaneous impulses."
    if stop is not None:
        drawn = f", {counted(tree.sampled, 'order')} drawn at random among them" if tree.sampled else ""
        return f"{scene.name}: {found} so far{drawn}: {stop.message}. There may be more."
    return (
        f"{scene.name}: {found} so far: the cap of {tree.cap} was hit, and {counted(tree.sampled, 'order')} "
        "drawn at random beyond it. There are more."
    )


def choices_phrase(outcome: Leaf) -> str:
    """Which contact came first, instant by instant; or the policy that draws the order."""
    if outcome.seed is not None:
        return f"sequential:seed={outcome.seed}"
    return " ".join(f"{first}-{second}" for first, second in (d.chosen for d in outcome.decisions))


def velocities_phrase(outcome: Leaf) -> str:
    """The velocity of each circle at the end."""
    return " ".join(f"{c.id} ({float(c.vx):.6g}, {float(c.vy):.6g})" for c in outcome.trajectory.final.circles)
