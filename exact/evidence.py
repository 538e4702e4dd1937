"""What is known of a zero beyond balls: proofs in nested roots and by symmetry, evidence by residues."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum

from ..scenarios.errors import SceneError
from ..scenarios.scene import Scene
from ..scenarios.tower import Tower, TowerLimit, sign_of_root_sum
from ..scenarios.trajectory import TieProof
from .machine import Link, Machine, Step
from .program import causal_past, replay
from .questions import Question
from .residue_search import residue_evidence
from .symmetry import Projection, projections, symmetries

MAX_DEPTH = 7
"""Levels of nested roots that a proof may build: on a chain of collisions of short numbers six take a tenth of a
second and seven half of one; longer numbers take more, so `SECONDS` bounds them."""

SECONDS = 2.0
"""Time that one proof in nested roots may take."""

RESIDUE_SECONDS = 10.0
"""Time that one search for residues may take: true ties with 60 roots in their past take about one second."""

MAX_ASSUMED = 1_000_000
"""Most bits that agreement may be asked to."""


@dataclass(frozen=True)
class Evidence:
    """How a zero is known; `bound` as in `Tie`."""

    proof: TieProof
    bound: int | None = None


@dataclass(frozen=True)
class Found:
    """What was found out of a number that balls could not tell from zero.

    Attributes:
        sign: the sign, to be taken as decided by `evidence`; None if it is not decided.
        evidence: how the sign is known.
        nonzero: whether the number is known not to be zero, so that more bits must decide it.
        told: what a person should hear if it stays undecided.
    """

    sign: int | None = None
    evidence: Evidence | None = None
    nonzero: bool = False
    told: str = ""


class Rule(Enum):
    """What is taken for a zero."""

    PROVED = "proved"
    PROBABLE = "probable"
    ASSUME = "assume"


class Prover:
    """Answers whether a number is exactly zero, where balls cannot.

    Args:
        scene: the scene that runs.
        rule: what is taken for a zero: proof only, residue evidence too, or agreement to `bits` bits.
        bits: for ASSUME.
    """

    def __init__(self, scene: Scene, rule: Rule = Rule.PROVED, bits: int = 0) -> None:
        self.scene = scene
        self.rule = rule
        self.bits = bits
        self._symmetries = symmetries(scene)
        self._hopeless: list[frozenset[int]] = []

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
        return self.rule is Rule.ASSUME and bits >= self.bits

    def prove(self, question: Question, steps: Sequence[Step]) -> Found:
        """What nested square roots prove of a number, or residues make probable."""
        sign, why = self._tower(question, steps)
        if sign is not None:
            return Found(sign, Evidence(TieProof.TOWER))
        return self._residue(question, steps, why)

    def _tower(self, question: Question, steps: Sequence[Step]) -> tuple[int | None, str]:
        n = len(self.scene.circles)
        needed, bodies = causal_past(steps, question.bodies(n), n)
        past = frozenset(needed)
        if any(hopeless <= past for hopeless in self._hopeless):
            return None, f"its past is too deep for nested square roots (of {MAX_DEPTH} levels, in {SECONDS:g} s)"
        tower = Tower(max_depth=MAX_DEPTH, deadline=time.monotonic() + SECONDS)
        try:
            machine = Machine(self.scene, lambda q: q.in_tower(tower), tower.sqrt, only=bodies)
            replay(machine, steps, needed)
            return sign_of_root_sum(*question.root_sum(machine)), ""
        except TowerLimit as limit:
            self._hopeless.append(past)
            return None, f"nested square roots: {limit}"

    def _residue(self, question: Question, steps: Sequence[Step], why: str) -> Found:
        verdict = residue_evidence(self.scene, steps, question, seconds=RESIDUE_SECONDS)
        if verdict.zero is None:
            return Found(told=f"{why}; residues: {verdict.why}")
        if not verdict.zero:
            return Found(nonzero=True, told=f"{why}; residues: not zero")
        if self.rule is Rule.PROBABLE:
            return Found(0, Evidence(TieProof.PROBABLE, verdict.log2_error))
        return Found(
            told=f"{why}; zero modulo a random prime of {verdict.bits} bits, which is wrong with a chance of at most "
            f"2**{verdict.log2_error}: --ties probable takes that for a tie",
            evidence=Evidence(TieProof.PROBABLE, verdict.log2_error),
        )


def prover_for(scene: Scene, ties: str) -> Prover:
    """The prover of a setting `proved`, `probable` or `assume:BITS`.

    Raises:
        SceneError: for any other text.
    """
    if ties == "proved":
        return Prover(scene)
    if ties == "probable":
        return Prover(scene, Rule.PROBABLE)
    head, _, bits = ties.partition("assume:")
    if head == "" and bits.isascii() and bits.isdigit() and 0 < int(bits[:7]) <= MAX_ASSUMED:
        return Prover(scene, Rule.ASSUME, int(bits))
    raise SceneError(f"ties = {ties!r} is not known; choose proved, probable or assume:BITS (such as assume:512)")
