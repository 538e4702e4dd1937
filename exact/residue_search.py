"""Is a number of a run zero? Replayed modulo random primes: never a proof of zero, but a bound on the doubt.

The number lies in a field K that grows root by root: K_0 holds the scene's numbers and every root that the tower
recognises, K_k = K_(k-1)(s_k) with s_k = +sqrt(D_k) for each further root that the history takes (a *free* root).
A homomorphism from K_(k-1) to the integers modulo p goes on to K_k if the image of D_k is a square that is not
zero, with either of its roots as the image of s_k, *provided that D_k is not a square in K_(k-1)*: then x^2 - D_k
is irreducible, and p's place below splits in two. An image that is not a square proves just that.

1. `Survey`, without a prime: bounds on heights, and the roots that the tower knows.
2. Scouting modulo primes of about 128 bits. Every free root must be seen without a root modulo p at some place;
   both signs of the others are tried, depth first. About half of all radicands have a root and each root two signs,
   so the search neither dies out nor grows, on the average. A radicand that is a small rational times an earlier
   one, or times the square of a component of the relative velocity (hits on an axis of symmetry), is *tied* to it.
   If the number is not zero at some place that passes, it is not zero.
3. If it is zero at all of them: once more, modulo a prime long enough for the bound below.

The bound. Let z != 0 in K, of degree d and height h. Primes p over 2**(b - 1) with a place where z is zero number
at most d h / (b - 1), for their product divides the numerator of the norm of z. Each candidate for p is drawn
uniformly from a set of 2**s numbers, and at most `CANDIDATES` are drawn; so the chance that any of them is such a
prime is at most CANDIDATES * d * h / 2**s. The choice of signs does not matter: all places above p are counted.
h is the sum over all numbers of which being zero is assumed: the parts of the root sum, its norm, and the ties.
That p is prime is known from random Miller-Rabin rounds, up to 2**-160.

Non-zero is a proof where no root is tied; a tie that held by chance at every place scouted could only make
a zero pass for non-zero, which costs bits of precision, not truth.
"""

from __future__ import annotations

import random
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from operator import attrgetter
from typing import Any

from flint import ctx, fmpq, fmpz  # type: ignore[attr-defined]

from ..scenarios.quantity import Quantity
from ..scenarios.scene import Scene
from ..scenarios.tower import Element, Tower, TowerLimit
from .machine import Go, Machine, Number, Relation, Step
from .numbers import ball
from .numbers.field import FieldNumber
from .numbers.heights import Measured, masks_of
from .numbers.residue import (
    Candidates,
    Residue,
    Residues,
    nested_radicands,
    passes_witnesses,
    products,
    residues_of,
    small_ratio,
)
from .program import causal_past
from .questions import Question, RootSum

TARGET = -140
"""log2 of the chance of a wrong zero that is aimed at: beyond any number of runs."""

CANDIDATES = 1 << 24
"""Most random numbers drawn in search of the last prime. The search ends by time long before."""

WITNESS_ERROR = -160
"""log2 of the chance that a composite number passes for a prime (see `residue.WITNESSES`)."""

SCOUT_BITS = 128
"""log2 of the number of candidates in scouting: two words, and no tie holds by chance twice."""

RATIO_BITS = 24
"""Longest numerator and denominator of the rational factor of a tie."""

TRIES = 48
"""Visits without a non-square after which a radicand is taken for a square that was not recognised."""

TRIES_A_PRIME = 4
"""Visits counted modulo one prime: its conjugate places may share a symbol."""

NODES = 4096
"""Visits modulo one prime in scouting: a radicand that is always a square lets the search grow without end."""

MAX_CONSTANT_DEPTH = 4
"""Levels of nested roots that the scene's own numbers may need."""

FIRST_BALL_BITS, MOST_BALL_BITS = 512, 1 << 17
"""Precisions at which balls tell the signs of numbers that are known not to be zero."""


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


class GaveUp(Exception):  # noqa: N818 - an outcome, not an error
    """Residues cannot tell; the message says why."""


class _Dead(Exception):  # noqa: N818 - an outcome, not an error
    """A radicand has no root modulo the prime."""


class _Grown(Exception):  # noqa: N818 - an outcome, not an error
    """K_0 has gained a root; what was certified over the smaller field is to be certified again."""


class _Spent(Exception):  # noqa: N818 - an outcome, not an error
    """Enough was visited modulo one prime."""


@dataclass(frozen=True)
class Tie:
    """A root known from an earlier number: sqrt(D) = factor * |base|, where D = factor**2 * base**2.

    Attributes:
        source: index of an earlier root; "vx" or "vy", a component of the relative velocity; or "1".
        factor: the square root of the rational ratio, in K_0.
        ratio: its square.
        sign: the sign of a velocity; +1 for a root.
    """

    source: int | str
    factor: FieldNumber
    ratio: fmpq
    sign: int = 1


@dataclass
class Root:
    """One square root of the history, in the order of replay.

    Attributes:
        place: the step that takes it, as an index into the causal past; its length for the question itself.
        height: of the radicand.
        speeds: heights of the components of the relative velocity that went with it, if any.
        exact: the root as a number of K_0, if it is one.
        tie: set when it is found to be one.
        examined, certified: whether ties were looked for; whether the radicand is proved not to be a square.
        tries: visits without a non-square.
    """

    place: int
    height: int
    speeds: tuple[int, ...]
    exact: FieldNumber | None
    tie: Tie | None = None
    examined: bool = False
    certified: bool = False
    tries: int = 0
    last_modulus: fmpz | None = None
    tries_here: int = 0

    @property
    def free(self) -> bool:
        """Whether its sign is chosen."""
        return self.exact is None and self.tie is None


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


def _snapshot(machine: RootMachine) -> tuple[Any, ...]:
    assert isinstance(machine.bodies, dict)
    bodies = {i: _of_body(body) for i, body in machine.bodies.items()}
    return _of_machine(machine), dict(machine._lines), bodies


def _restore(machine: RootMachine, saved: tuple[Any, ...]) -> None:
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


class Survey:
    """What can be said of a past without a prime: its roots, heights of its numbers, and the field K_0.

    Attributes:
        roots: the square roots, in order.
        weight: sum of the heights of the numbers that a verdict takes for zero, without ties.
        tower: the tower that holds K_0.

    Raises:
        GaveUp: if the scene's own numbers are nested too deeply, or time is up.
    """

    def __init__(self, past: Past, deadline: float) -> None:
        self.past = past
        self.tower = Tower(max_depth=MAX_CONSTANT_DEPTH, deadline=deadline)
        self._constants: dict[str, Measured] = {}
        try:
            while True:
                before = len(self.tower.generators)
                self.roots: list[Root] = []
                self._go()
                if len(self.tower.generators) == before:
                    return
        except TowerLimit as limit:
            raise GaveUp(f"the scene's own numbers: {limit}") from limit

    def _go(self) -> None:
        past = self.past
        self._place = 0
        machine = RootMachine(past.scene, self._constant, self._root, past.bodies)
        for self._place in range(len(past.steps)):
            past.carry_out(machine, self._place)
        self._place = len(past.steps)
        parts = past.root_sum(machine)
        self.weight = sum(part.height for part in (*parts, norm(*parts)))

    def _constant(self, q: Quantity) -> Measured:
        if q.rational is not None:
            return Measured.of(q.rational)
        text = q.text()
        known = self._constants.get(text)
        if known is None:
            known = self._constants[text] = Measured(height_of(q), q.in_tower(self.tower))
        return known

    def constant(self, q: Quantity) -> FieldNumber:
        """A constant of the past as a number of K_0."""
        return q.rational if q.rational is not None else self._constant(q).exact

    def _root(self, index: int, value: Measured, along: tuple[Measured, ...]) -> Measured:
        exact = None if value.exact is None else self.exact_root(value.exact)
        speeds = tuple(speed.height for speed in along)
        self.roots.append(Root(self._place, value.height, speeds, exact))
        if exact is None:
            return value.root()
        return Measured.of(exact, value.root().height)

    def exact_root(self, value: FieldNumber) -> FieldNumber | None:
        """The root of a positive number of K_0, by new roots of whole numbers if need be; None if it nests deeper."""
        tower = self.tower
        if isinstance(value, fmpq):
            value = tower.rational(value)
        deepest, tower.max_depth = tower.max_depth, max(1, tower.depth)
        try:
            root = tower.sqrt(value)
        except TowerLimit:
            if tower.deadline is not None and time.monotonic() > tower.deadline:
                raise
            return None
        finally:
            tower.max_depth = deepest
        fraction = root.fraction()
        return root if fraction is None else fraction

    def masks(self) -> list[int]:
        """The roots of whole numbers that K_0 is made of, as masks of the tower's base."""
        numbers = [root.exact for root in self.roots]
        numbers += [root.tie.factor for root in self.roots if root.tie is not None]
        numbers += [constant.exact for constant in self._constants.values()]
        numbers += nested_radicands(self.tower)
        masks = {mask for number in numbers if isinstance(number, Element) for mask in masks_of(number)}
        return sorted(masks - {0})

    @property
    def degree(self) -> int:
        """log2 of an upper bound on the degree of K over the rationals."""
        base = min(len(self.masks()), sum(isinstance(g.num, dict) for g in self.tower.generators))
        return base + len(nested_radicands(self.tower)) + sum(root.free for root in self.roots)

    @property
    def tie_weight(self) -> int:
        """Sum of the heights of the numbers that ties take for zero."""
        total = 0
        for root in self.roots:
            if root.tie is not None:
                source = root.tie.source
                base = self.roots[source].height if isinstance(source, int) else 2 * max(root.speeds, default=0)
                total += root.height + base + 2 * RATIO_BITS + 1
        return total


def height_of(q: Quantity) -> int:
    """A bound on the height of a constant, from the expression that it is."""
    if q.rational is not None:
        return Measured.of(q.rational).height
    heights = [height_of(argument) for argument in q.args]
    if q.op == "sqrt":
        return (heights[0] + 1) // 2
    return sum(heights) + (q.op in "+-")


def norm(a: Number, b: Number, d1: Number, c: Number, d2: Number) -> Number:
    """The product of the four numbers A +- B*sqrt(D1) +- C*sqrt(D2).

    It is E^2 - F^2 D1 with E = A^2 + B^2 D1 - C^2 D2 and F = 2 A B.

    >>> norm(3, 1, 4, -1, 25)
    0
    """
    e = a * a + b * b * d1 - c * c * d2
    f = (a + a) * b
    return e * e - f * f * d1


class Descent:
    """The homomorphisms to one ring of residues, by depth-first search over the signs of the free roots.

    Args:
        survey: the past and its roots.
        residues: the numbers of K_0 modulo a prime.
        deadline: when to give up, as `time.monotonic()`.
        scout: what is told of each radicand on the way (see `Scout`); None if nothing is to be learned.
    """

    def __init__(
        self, survey: Survey, residues: Residues, deadline: float, scout: Scout | None = None
    ) -> None:
        self.survey = survey
        self.deadline = deadline
        self.roots = survey.roots
        self.residues = residues
        self.scout = scout
        self.values: list[tuple[Residue, Residue]] = []
        self._chosen: dict[int, tuple[Residue, bool]] = {}
        self._saved: dict[int, tuple[Any, ...]] = {}

    def leaves(self) -> Iterator[RootSum]:
        """The parts of the number asked for, at each place where every radicand has a root.

        Raises:
            ZeroDivisionError: if the prime divides a denominator or a radicand.
            GaveUp: if time is up.
        """
        past, residues = self.survey.past, self.residues
        machine = RootMachine(
            past.scene, lambda q: residues.number(self.survey.constant(q)), self._root, past.bodies
        )
        branching = {root.place for root in self.roots if root.exact is None}
        end = len(past.steps)
        place = 0
        while True:
            try:
                while place < end:
                    if place in branching:
                        self._saved[place] = _snapshot(machine)
                    past.carry_out(machine, place)
                    place += 1
                if end in branching:
                    self._saved[end] = _snapshot(machine)
                yield past.root_sum(machine)
            except _Dead:
                pass
            if time.monotonic() > self.deadline:
                raise GaveUp(f"time was up on the way through {len(self.roots)} square roots")
            while self._chosen:
                index, (root, flipped) = self._chosen.popitem()
                if not flipped:
                    self._chosen[index] = (-root, True)
                    place = self.roots[index].place
                    _restore(machine, self._saved[place])
                    break
            else:
                return

    def _root(self, index: int, value: Residue, along: tuple[Residue, ...]) -> Residue:
        plan = self.roots[index]
        if plan.exact is not None:
            root = self.residues.number(plan.exact)
        else:
            if self.scout is not None and not plan.examined:
                plan.examined = True
                self.scout.examine(self, index, value, along)
            root = self._tied(plan.tie, value, along) if plan.tie is not None else self._free(index, value)
        del self.values[index:]
        self.values.append((value, root))
        return root

    def _tied(self, tie: Tie, value: Residue, along: tuple[Residue, ...]) -> Residue:
        square, base = self.base(tie.source, along)
        if value != self.residues.number(tie.ratio) * square:
            raise GaveUp("two radicands agreed modulo one prime by chance")
        root = self.residues.number(tie.factor) * base
        return root if tie.sign > 0 else -root

    def base(self, source: int | str, along: tuple[Residue, ...]) -> tuple[Residue, Residue]:
        """base**2 and base of a tie."""
        if isinstance(source, int):
            return self.values[source]
        if source == "1":
            one = self.residues.number(fmpq(1))
            return one, one
        speed = along[source == "vy"]
        return speed * speed, speed

    def _free(self, index: int, value: Residue) -> Residue:
        chosen = self._chosen.get(index)
        if chosen is not None:
            return chosen[0]
        root = self.residues.root(value)
        if self.scout is not None:
            self.scout.note(index, self.residues.modulus, root is not None)
        if root is None:
            raise _Dead
        self._chosen[index] = (root, False)
        return root


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
        self.balls = _Balls(survey.past, deadline)
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
                    f"the radicand of square root {index + 1} of {len(self.survey.roots)} seems to be a square, "
                    f"of a number that was not recognised"
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
    survey: Survey, candidates: Candidates, masks: Sequence[int], deadline: float, scout: Scout | None
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


class _Balls:
    """The past in balls, to tell the signs of numbers that are not zero."""

    def __init__(self, past: Past, deadline: float) -> None:
        self.past = past
        self.deadline = deadline
        self._bits = 0

    def _at(self, bits: int) -> None:
        """Replays with so many bits, unless that has been done."""
        if bits == self._bits:
            return
        self._bits = bits
        self._along: list[tuple[Number, ...]] = []

        def root(index: int, value: Number, along: tuple[Number, ...]) -> Number:
            self._along.append(along)
            return ball.root(value)

        past = self.past
        with ball.precision(bits):
            machine = RootMachine(past.scene, ball.constant, root, past.bodies)
            for place in range(len(past.steps)):
                past.carry_out(machine, place)
            self._parts = past.root_sum(machine)

    def _rising(self) -> Iterator[int]:
        bits = FIRST_BALL_BITS
        while bits <= MOST_BALL_BITS and time.monotonic() < self.deadline:
            try:
                self._at(bits)
            except ZeroDivisionError:
                self._bits = 0
            else:
                yield bits
            bits *= 2
        raise GaveUp(f"balls of {bits // 2} bits do not tell the sign of a number that is not zero")

    def speed_sign(self, index: int, name: str) -> int:
        """The sign of a component of the velocity that went with a root; it is not zero."""
        for _ in self._rising():
            sign = ball.sign_of(self._along[index][name == "vy"])
            if sign is not None:
                return sign
        raise AssertionError("the loop ends by itself")

    def is_zero_one(self, signs: Sequence[tuple[int, int]]) -> bool:
        """Whether A + B*sqrt(D1) + C*sqrt(D2) is the zero among numbers A + s B*sqrt(D1) + r C*sqrt(D2).

        Args:
            signs: pairs (s, r), of which exactly one makes a zero; (1, 1) comes first. s or r is 0 where the term
                is zero.
        """
        for bits in self._rising():
            with ball.precision(bits):
                a, b, d1, c, d2 = self._parts
                p, q = (
                    x * ball.root(d) if any(pair[i] for pair in signs) else ball.ZERO
                    for i, x, d in ((0, b, d1), (1, c, d2))
                )
                known = [ball.sign_of(a + s * p + r * q) for s, r in signs]
            if known[0] is not None and known[0] != 0:
                return False
            if all(sign is not None and sign != 0 for sign in known[1:]):
                return True
        raise AssertionError("the loop ends by itself")


def conjugates(parts: RootSum) -> list[tuple[int, int]]:
    """Pairs (s, r): of the numbers A + s B*sqrt(D1) + r C*sqrt(D2), exactly one is zero if their product is.

    Two of them are zero together only if a term is zero, or if A is and both signs change; neither is in the list.

    >>> conjugates((5, 1, 2, 0, 0))
    [(1, 0), (-1, 0)]
    >>> conjugates((0, 1, 2, 3, 4))
    [(1, 1), (1, -1)]
    """
    a, b, d1, c, d2 = parts
    has_b, has_c = b != 0 and d1 != 0, c != 0 and d2 != 0
    signs_b = (1, -1) if has_b and not (has_c and a == 0) else (int(has_b),)
    signs_c = (1, -1) if has_c else (0,)
    return [(s, r) for s in signs_b for r in signs_c]


def residue_evidence(
    scene: Scene, steps: Sequence[Step], question: Question, *, seconds: float, seed: int | None = None
) -> ResidueVerdict:
    """Tells whether a number of a run is zero, by residues modulo random primes.

    A zero is evidence, wrong with a chance of at most 2**log2_error over the random choice of primes, whatever
    the scene. Of the conjugates A +- B*sqrt(D1) +- C*sqrt(D2), balls tell which one is the zero.

    Args:
        scene: the scene.
        steps: the log up to the question.
        question: the number.
        seconds: when to give up.
        seed: for tests, to have the same primes again; None draws them from the system, so that no scene can be
            made to fit them.

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
