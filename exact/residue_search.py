"""Is a number of a run zero? Replayed modulo random primes: never a proof of zero, but a bound on the doubt.

The number lies in a field K that grows root by root: K_0 holds the scene's numbers and every root that the
tower recognises, K_k = K_(k-1)(s_k) with s_k = +sqrt(D_k) for each further root that the history takes (a
*free* root). A homomorphism from K_(k-1) to the integers modulo p goes on to K_k if the image of D_k is a
square that is not zero, with either of its roots as the image of s_k, *provided that D_k is not a square in
K_(k-1)*: then x^2 - D_k is irreducible, and p's place below splits in two. An image that is not a square
proves just that.

1. `Survey`, without a prime: bounds on heights, and the roots that the tower knows.
2. Scouting modulo primes of about 128 bits. Every free root must be seen without a root modulo p at some
   place; both signs of the others are tried, depth first. About half of all radicands have a root and each
   root two signs, so the search neither dies out nor grows, on the average. A radicand that is a small
   rational times an earlier one, or times the square of a component of the relative velocity (hits on an
   axis of symmetry), is *tied* to it. If the number is not zero at some place that passes, it is not zero.
3. If it is zero at all of them: once more, modulo a prime long enough for the bound below.

The bound. Let z != 0 in K, of degree d and height h. Primes p over 2**(b - 1) with a place where z is zero
number at most d h / (b - 1), for their product divides the numerator of the norm of z. Each candidate for p
is drawn uniformly from a set of 2**s numbers, and at most `CANDIDATES` are drawn; so the chance that any of
them is such a prime is at most CANDIDATES * d * h / 2**s. The choice of signs does not matter: all places
above p are counted. h is the sum over all numbers of which being zero is assumed: the parts of the root
sum, its norm, and the ties. That p is prime is known from random Miller-Rabin rounds, up to 2**-160.

Non-zero is a proof where no root is tied; a tie that held by chance at every place scouted could only make
a zero pass for non-zero, which costs bits of precision, not truth.
"""

from __future__ import annotations

import random
import time
from collections.abc import Sequence
from dataclasses import dataclass

from flint import ctx  # type: ignore[attr-defined]

from ..scenarios.scene import Scene
from .machine import Step
from .numbers.residue import Candidates, passes_witnesses, products
from .questions import Question
from .residue_scout import CANDIDATES, SCOUT_BITS, Scout, next_descent
from .root_past import Past
from .root_sums import conjugates, norm
from .root_survey import GaveUp, Survey

TARGET = -140
"""log2 of the chance of a wrong zero that is aimed at: beyond any number of runs."""

WITNESS_ERROR = -160
"""log2 of the chance that a composite number passes for a prime (see `residue.WITNESSES`)."""


@dataclass(frozen=True)
class ResidueVerdict:
    """What residues tell of a number.

    Attributes:
        zero: True: zero, up to `log2_error`. False: not zero. None: not found out, see `why`.
        log2_error: for a zero: the chance that it is wrong is at most 2**log2_error.
        bits: length of the prime of the last homomorphism.
        roots: square roots that were chosen modulo it, one at a time.
        why: for None, the reason.
    """

    zero: bool | None
    log2_error: int = 0
    bits: int = 0
    roots: int = 0
    why: str = ""


def residue_evidence(
    scene: Scene, steps: Sequence[Step], question: Question, *, seconds: float, seed: int | None = None
) -> ResidueVerdict:
    """Tells whether a number of a run is zero, by residues modulo random primes.

    A zero is evidence, wrong with a chance of at most 2**log2_error over the random choice of primes,
    whatever the scene. Of the conjugates A +- B*sqrt(D1) +- C*sqrt(D2), balls tell which one is the zero.

    Args:
        scene: the scene.
        steps: the log up to the question.
        question: the number.
        seconds: when to give up.
        seed: for tests, to have the same primes again; None draws them from the system, so that no scene
            can be made to fit them.

    >>> from truebreak.scenarios import Circle
    >>> from truebreak.exact.questions import Sooner
    >>> left = [Circle(0, 0, vx=1), Circle(4, 1)]
    >>> right = [Circle(100, 0, vx=-1), Circle(96, 1)]
    >>> residue_evidence(Scene([*left, *right]), [], Sooner((0, 1), (2, 3)), seconds=1).zero
    True
    """
    rng = random.SystemRandom() if seed is None else random.Random(seed)
    deadline = time.monotonic() + seconds
    saved = ctx.prec
    try:
        return _evidence(Past.of(scene, steps, question), rng, deadline)
    except GaveUp as reason:
        return ResidueVerdict(None, why=str(reason))
    finally:
        ctx.prec = saved


def _evidence(past: Past, rng: random.Random, deadline: float) -> ResidueVerdict:
    survey = Survey(past, deadline)
    scout = Scout(survey, rng, deadline)
    probably = scout.run()
    roots = sum(root.free for root in survey.roots)
    if not probably:
        return ResidueVerdict(False, bits=SCOUT_BITS, roots=roots)
    masks = survey.masks()
    weight = CANDIDATES.bit_length() + survey.degree + (survey.weight + survey.tie_weight).bit_length()
    candidates = Candidates(products(survey.tower, masks), weight + 1 - TARGET, rng)
    while True:
        descent = next_descent(survey, candidates, masks, deadline, None)
        try:
            parts = next(descent.leaves(), None)
        except ZeroDivisionError:
            continue
        if parts is not None:
            break
    modulus = descent.residues.modulus
    bits = modulus.bit_length()
    if norm(*parts) != 0:
        return ResidueVerdict(False, bits=bits, roots=roots)
    if not passes_witnesses(modulus, rng):
        raise GaveUp("the last prime was not one")
    signs = conjugates(parts)
    zero = len(signs) == 1 or scout.balls.is_zero_one(signs)
    if not zero:
        return ResidueVerdict(False, bits=bits, roots=roots)
    return ResidueVerdict(True, max(weight - candidates.log2_size, WITNESS_ERROR) + 1, bits, roots)
