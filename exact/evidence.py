"""What is known of a zero beyond balls: proofs in nested roots and by symmetry, evidence by residues."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass

from ..scenarios.scene import Scene
from ..scenarios.tower import Tower, TowerLimit, sign_of_root_sum
from ..scenarios.trajectory import TieProof
from .machine import Link, Machine, Step
from .program import causal_past, replay
from .questions import Question
from .symmetry import Projection, projections, symmetries

MAX_DEPTH = 7
"""Levels of nested roots that a proof may build: on a chain of collisions of short numbers six take a tenth of a
second and seven half of one; longer numbers take more, so `SECONDS` bounds them."""

SECONDS = 2.0
"""Time that one proof in nested roots may take."""


@dataclass(frozen=True)
class Evidence:
    """How a zero is known; `bound` as in `Tie`."""

    proof: TieProof
    bound: int | None = None


@dataclass(frozen=True)
class Found:
    """A sign and how it is known."""

    sign: int
    evidence: Evidence


class Prover:
    """Answers whether a number is exactly zero, where balls cannot.

    Args:
        scene: the scene that runs.
        assume_bits: accept agreement to so many bits as a zero (an assumption, marked as such); None does not.
    """

    def __init__(self, scene: Scene, assume_bits: int | None = None) -> None:
        self.scene = scene
        self.assume_bits = assume_bits
        self._symmetries = symmetries(scene)
        self._hopeless: list[frozenset[int]] = []
        self._tried: list[str] = []

    def projections(self) -> dict[int, Projection]:
        """Circles that the scene's symmetries hold to a line or a point."""
        return projections(self.scene, symmetries(self.scene))

    def drop_symmetries(self) -> None:
        """From here on the history need not respect the scene's symmetries: an order was chosen."""
        self._symmetries = ()

    def symmetric(self, first: Link, second: Link) -> bool:
        """Whether a symmetry of the history maps one contact to the other."""
        return any(symmetry.image(first) == second for symmetry in self._symmetries)

    def accepts(self, bits: int) -> bool:
        """Whether agreement to so many bits is to be taken for equality."""
        return self.assume_bits is not None and bits >= self.assume_bits

    def tried(self) -> str:
        """What was tried for the last question, as the end of a sentence."""
        return "; " + "; ".join(self._tried) if self._tried else ""

    def prove(self, question: Question, steps: Sequence[Step]) -> Found | None:
        """The sign if it can be had from nested square roots, else None."""
        self._tried = []
        return self._tower(question, steps)

    def _tower(self, question: Question, steps: Sequence[Step]) -> Found | None:
        n = len(self.scene.circles)
        needed, bodies = causal_past(steps, question.bodies(n), n)
        past = frozenset(needed)
        if any(hopeless <= past for hopeless in self._hopeless):
            self._tried.append(f"its past needs more than {MAX_DEPTH} nested square roots or {SECONDS:g} s")
            return None
        tower = Tower(max_depth=MAX_DEPTH, deadline=time.monotonic() + SECONDS)
        try:
            machine = Machine(
                self.scene, lambda q: q.in_tower(tower), lambda value: tower.sqrt(value), only=bodies
            )
            replay(machine, steps, needed)
            sign = sign_of_root_sum(*question.root_sum(machine))
        except TowerLimit as limit:
            self._hopeless.append(past)
            self._tried.append(f"nested square roots: {limit}")
            return None
        return Found(sign, Evidence(TieProof.TOWER))
