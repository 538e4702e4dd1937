"""The past of a question, step by step, on machines that number its square roots and can go back."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from operator import attrgetter
from typing import Any

from ..scenarios.quantity import Quantity
from ..scenarios.scene import Scene
from .machine import Go, Machine, Number, Relation, Step
from .program import causal_past
from .questions import Question, RootSum


class RootMachine(Machine):
    """A machine that numbers its square roots, and knows the relative velocity that goes with each.

    Args:
        scene, constant, only: see `Machine`.
        root: takes the index of the root, the radicand, and (vx, vy) of the latest relation or ().
    """

    def __init__(
        self,
        scene: Scene,
        constant: Callable[[Quantity], Number],
        root: Callable[[int, Number, tuple[Number, ...]], Number],
        only: Sequence[int],
    ) -> None:
        self.count = 0
        self.along: tuple[Number, ...] = ()
        self._take = root
        super().__init__(scene, constant, self._numbered, only)

    def _numbered(self, value: Number) -> Number:
        index, along = self.count, self.along
        self.count += 1
        self.along = ()
        return self._take(index, value, along)

    def relation(self, i: int, j: int) -> Relation:
        """See `Machine.relation`."""
        state = super().relation(i, j)
        self.along = (state.vx, state.vy)
        return state


_STATE = ("x", "y", "vx", "vy", "t", "instant", "late", "rest", "last")
_of_machine = attrgetter("count", "flip_time", "instant", "late", "met")
_of_body = attrgetter(*_STATE)


def snapshot(machine: RootMachine) -> tuple[Any, ...]:
    """The state of a machine, for `restore`."""
    assert isinstance(machine.bodies, dict)
    bodies = {i: _of_body(body) for i, body in machine.bodies.items()}
    return _of_machine(machine), dict(machine._lines), bodies


def restore(machine: RootMachine, saved: tuple[Any, ...]) -> None:
    """Puts a machine back into a state."""
    (machine.count, machine.flip_time, machine.instant, machine.late, machine.met), lines, bodies = saved
    machine._lines = dict(lines)
    assert isinstance(machine.bodies, dict)
    for i, state in bodies.items():
        body = machine.bodies[i]
        for name, value in zip(_STATE, state, strict=True):
            setattr(body, name, value)


@dataclass
class Past:
    """The part of a log that a question depends on.

    Attributes:
        scene, question: as asked.
        steps: the steps, each with its place in the whole log.
        bodies: the circles in them.
    """

    scene: Scene
    question: Question
    steps: list[tuple[int, Step]]
    bodies: list[int]

    @staticmethod
    def of(scene: Scene, steps: Sequence[Step], question: Question) -> Past:
        """The causal past of a question."""
        n = len(scene.circles)
        needed, bodies = causal_past(steps, question.bodies(n), n)
        held = set(bodies)
        kept: list[tuple[int, Step]] = []
        for k in needed:
            step = steps[k]
            if isinstance(step, Go):
                step = Go(step.source, tuple(i for i in step.bodies if i in held))
            kept.append((k, step))
        return Past(scene, question, kept, bodies)

    def carry_out(self, machine: RootMachine, place: int) -> None:
        """One step of it."""
        machine.steps_done, step = self.steps[place]
        machine.along = ()
        machine.do(step)

    def root_sum(self, machine: RootMachine) -> RootSum:
        """The question's number, after all steps."""
        machine.along = ()
        return self.question.root_sum(machine)
