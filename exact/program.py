"""The event log as a program: replay it in any number system, and ask for any of its numbers, exactly."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from ..scenarios.numbers.quantity import Quantity
from .machine import Go, Kick, Machine, Step, Take


def causal_past(steps: Sequence[Step], bodies: Iterable[int], n: int) -> tuple[list[int], list[int]]:
    """The steps on which the states of some bodies depend, in order, and all bodies in them.

    Args:
        steps: the log.
        bodies: indices of the circles asked about.
        n: number of circles; greater indices in contacts are walls.
    """
    wanted = set(bodies)
    needed: list[int] = []
    for k in range(len(steps) - 1, -1, -1):
        step = steps[k]
        if isinstance(step, Go):
            touched = set(step.bodies)
            if wanted & touched:
                needed.append(k)
                if isinstance(step.source, tuple):
                    wanted.update(i for i in step.source if 0 <= i < n)
                elif isinstance(step.source, int) and not isinstance(step.source, Quantity):
                    wanted.add(step.source)
        elif isinstance(step, Kick):
            touched = {i for link in step.links for i in link if i < n}
            if wanted & touched:
                needed.append(k)
                wanted |= touched
        elif isinstance(step, Take):
            if step.body in wanted:
                needed.append(k)
        else:
            needed.append(k)
    needed.reverse()
    return needed, sorted(wanted)


def replay(machine: Machine, steps: Sequence[Step], needed: Iterable[int]) -> None:
    """Carries out the needed steps of a log on a machine that may hold only some of the bodies."""
    held = set(machine.bodies) if isinstance(machine.bodies, dict) else None
    for k in needed:
        step = steps[k]
        if held is not None and isinstance(step, Go):
            step = Go(step.source, tuple(i for i in step.bodies if i in held))
        machine.steps_done = k
        machine.do(step)
