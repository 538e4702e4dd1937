"""Scouting modulo primes of 128 bits: radicands certified as non-squares, and ties between them found."""

from __future__ import annotations

import random
import time
from collections.abc import Sequence

from flint import fmpq, fmpz  # type: ignore[attr-defined]

from .numbers.field import FieldNumber
from .numbers.heights import masks_of
from .numbers.residue import Candidates, Residue, products, residues_of, small_ratio
from .residue_descent import Descent, Watch
from .root_balls import RootBalls
from .root_sums import norm
from .root_survey import RATIO_BITS, GaveUp, Survey, Tie

CANDIDATES = 1 << 24
"""Most random numbers drawn in search of the last prime. The search ends by time long before."""

SCOUT_BITS = 128
"""log2 of the number of candidates in scouting: two words, and no tie holds by chance twice."""

TRIES = 48
"""Visits without a non-square after which a radicand is taken for a square that was not recognised."""

TRIES_A_PRIME = 4
"""Visits counted modulo one prime: its conjugate places may share a symbol."""

NODES = 4096
"""Visits modulo one prime: a radicand that is always a square lets the search grow without end."""


class _Grown(Exception):
    """K_0 has gained a root; what was certified over the smaller field is to be certified again."""


class _Spent(Exception):
    """Enough was visited modulo one prime."""


class Scout:
    """Certifies radicands as non-squares and finds ties, modulo primes of moderate length.

    Args:
        survey: the past and its roots; what is found is noted in them.
        rng: where primes come from.
        deadline: when to give up, as `time.monotonic()`.
    """

    def __init__(self, survey: Survey, rng: random.Random, deadline: float) -> None:
        self.survey = survey
        self.rng = rng
        self.deadline = deadline
        self.balls = RootBalls(survey.past, deadline)
        self._visits = 0
        self._reached = False

    def run(self) -> bool:
        """Whether the number is zero wherever it was computed.

        Raises:
            GaveUp: if a radicand was never seen as a non-square, or time is up.
        """
        while True:
            try:
                return self._over_field()
            except _Grown:
                continue

    def _over_field(self) -> bool:
        """`run` over the K_0 at hand.

        Raises:
            _Grown: if that has to grow.
        """
        survey = self.survey
        masks = survey.masks()
        candidates = Candidates(products(survey.tower, masks), SCOUT_BITS, self.rng)
        for root in survey.roots:
            root.certified, root.tries = False, 0
        self._reached, zero = False, True
        while not self.done():
            self._visits = 0
            descent = next_descent(survey, candidates, masks, self.deadline, self)
            try:
                for parts in descent.leaves():
                    self._reached = True
                    zero = zero and norm(*parts) == 0
                    if self.done():
                        break
            except (ZeroDivisionError, _Spent):
                continue
        return zero

    def done(self) -> bool:
        """Whether a place was reached and every free root is certified."""
        return self._reached and all(root.certified for root in self.survey.roots if root.free)

    def enough(self, index: int) -> bool:
        """Whether a root and those after it are certified, and a place was reached."""
        return self._reached and all(root.certified for root in self.survey.roots[index:] if root.free)

    @property
    def open(self) -> int:
        """What the radicands depend on that are not certified yet: free roots, as bits."""
        found = 0
        for root in self.survey.roots:
            if root.free and not root.certified:
                found |= root.needs
        return found

    def note(self, index: int, modulus: fmpz, residue: bool) -> None:
        """Takes down whether a radicand had a root.

        Raises:
            GaveUp: if it always has.
        """
        root = self.survey.roots[index]
        self._visits += 1
        if self._visits > NODES:
            raise _Spent
        if not residue:
            root.certified = True
        elif not root.certified:
            if root.last_modulus != modulus:
                root.last_modulus, root.tries_here = modulus, 0
            root.tries_here += 1
            root.tries += root.tries_here <= TRIES_A_PRIME
            if root.tries >= TRIES:
                raise GaveUp(
                    f"radicand {index + 1} of {len(self.survey.roots)} had a root modulo every prime tried: "
                    "it seems to be the square of a number that was not recognised"
                )

    def examine(self, descent: Descent, index: int, value: Residue, along: tuple[Residue, ...]) -> None:
        """Looks for a tie of a root.

        Raises:
            _Grown: if the tie needs a root that K_0 has not.
        """
        plan = self.survey.roots[index]
        speeds = [name for name, speed in zip(("vx", "vy"), along, strict=False) if speed != 0]
        earlier = [i for i in range(index) if self.survey.roots[i].free]
        modulus = descent.residues.modulus
        for source in ("1", *speeds, *earlier):
            square, _ = descent.base(source, along)
            ratio = small_ratio(value / square, modulus, RATIO_BITS)
            if ratio is None:
                continue
            generators = len(self.survey.tower.generators)
            known = set(self.survey.masks())
            factor = self._within(ratio) if isinstance(source, int) else self.survey.exact_root(ratio)
            if factor is None:
                continue
            sign = self.balls.speed_sign(index, source) if source in ("vx", "vy") else 1
            plan.tie = Tie(source, factor, ratio, sign)
            if len(self.survey.tower.generators) > generators or not set(self.survey.masks()) <= known:
                raise _Grown
            return

    def _within(self, ratio: fmpq) -> FieldNumber | None:
        """The root of a rational if it lies in K_0."""
        root = self.survey.tower.root_within(self.survey.tower.rational(ratio))
        if root is None or not set(masks_of(root)) <= {0, *self.survey.masks()}:
            return None
        fraction = root.fraction()
        return root if fraction is None else fraction


def next_descent(
    survey: Survey, candidates: Candidates, masks: Sequence[int], deadline: float, scout: Watch | None
) -> Descent:
    """A search modulo the next random prime to which K_0 has a homomorphism.

    Raises:
        GaveUp: if time or candidates run out.
    """
    while True:
        if time.monotonic() > deadline:
            raise GaveUp(f"no prime found in time that splits all {survey.degree} square roots")
        prime = candidates.prime(CANDIDATES)
        if prime is None:
            raise GaveUp(f"none of {CANDIDATES} candidates is a prime that splits all square roots")
        residues = residues_of(survey.tower, masks, prime)
        if residues is not None:
            return Descent(survey, residues, deadline, scout)
