"""The exact engine's decisions: short balls, then full balls, then proofs of zero, then more bits.

Every decision climbs only as far as it must. What a rung decides is certain; what none decides is Undecided.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Sequence
from math import inf
from typing import Any

from flint import arb, ctx, fmpq  # type: ignore[attr-defined]

from ..scenarios.scene import Scene
from ..scenarios.tower import sign_of_root_sum
from ..scenarios.trajectory import Assumption, OnProgress, Tie, TieProof
from .event_loop import Candidate, EventLoop, Limits
from .evidence import Evidence, Found, Prover, Rule
from .float_filter import MISS, Answer, FloatFilter, FloatLine, float_line
from .live import LiveMachine
from .machine import Body, Link, Number, Step
from .numbers import ball
from .numbers.field import LeavesField, field_sign, field_text
from .policies import Policy
from .questions import Approach, Discriminant, Gap, Question, Sooner
from .undecided import Undecided

QUICK_BITS = 128
"""Precision of predictions: two machine words, the most that flint keeps without a call for memory."""

FIRST_BITS = 256
"""Precision of the state at first: four words, twice the quick one, so the first rise comes late."""

SAFE_BITS = 96
"""When the times' accuracy falls below this, precision rises at once: predictions would soon be undecided, and
results should round to doubles without another look."""

FORESIGHT = 1.1
"""Share by which the bits foreseen for a whole run exceed the extrapolation, so that one rise mostly suffices."""

MOST_FORESIGHT = 16
"""Most by which one rise multiplies the precision: an extrapolation from a short past may be far off."""

TRY_BITS = 1024
"""Below this precision, more bits are cheaper than any attempt to prove a zero."""
DOUBT_FACTOR = 16
"""By how much precision still rises for a number that neither proof nor residues could tell from zero."""

LATER = object()
"""The time of a candidate whose doubles suffice so far: computed when they do not."""


class CertifiedLoop(EventLoop):
    """The loop on balls and fields, with the ladder.

    Args:
        max_bits: the precision beyond which an undecided sign stays so.
        prover: what proves zeros in nested roots, by symmetry, or gives evidence by residues.
    """

    def __init__(
        self,
        scene: Scene,
        limits: Limits,
        progress: OnProgress | None,
        max_bits: int,
        prover: Prover,
        policy: Policy | None = None,
    ) -> None:
        self.live = LiveMachine(scene, FIRST_BITS)
        super().__init__(scene, self.live, limits, progress, policy)  # type: ignore[arg-type]
        self.steps = self.history.steps = self.live.steps
        self.max_bits = max_bits
        self.prover = prover
        self.evidence: Evidence | None = None
        self.assumptions: list[Assumption] = []
        self.live.projections = prover.projections()
        self._reaches = self._quick_reaches()
        self._quick_lines: dict[tuple[int, int], tuple[arb, ...]] = {}
        self.quick_zero = ball.ZERO
        self.quick_root = arb.sqrt
        self.filter = FloatFilter()
        self._float_reaches = [[float(reach) for reach in row] for row in self._reaches]
        self._float_lines: dict[tuple[int, int], FloatLine] = {}

    # -- numbers for predictions

    def _quick_reaches(self) -> list[list[arb]]:
        """Sums of radii by kind of radius; each body's `kind` indexes it."""
        radii: dict[Any, int] = {}
        for body, circle in zip(self.bodies, self.scene.circles, strict=True):
            body.kind = radii.setdefault(circle.r, len(radii))
        kinds = len(radii)
        with ball.precision(QUICK_BITS):
            reaches = [[ball.constant(r + s) for s in radii] for r in radii]
            for k, pocket in enumerate(self.scene.pockets):
                self.live.bodies[-1 - k].kind = kinds + k
                for row in reaches:
                    row.append(ball.constant(pocket.r))
        return reaches

    def quick_reach(self, a: Body, b: Body) -> arb:
        """The sum of two radii as a short ball."""
        return self._reaches[a.kind][b.kind]

    def quick_line(self, body: Body, wall: int) -> tuple[arb, ...]:
        """A wall in short balls."""
        key = (body.index, wall)
        found = self._quick_lines.get(key)
        if found is None:
            with ball.precision(2 * QUICK_BITS):
                exact = self.scene.walls[wall]
                nx, ny = exact.normal
                length = (nx * nx + ny * ny).sqrt()
                if self.live.balls._sides.negative(body.index, wall):
                    nx, ny = -nx, -ny
                offset = self.scene.circles[body.index].r * length
                numbers = [ball.constant(q) for q in (exact.x0, exact.y0, nx, ny, offset)]
            with ball.precision(QUICK_BITS):
                found = self._quick_lines[key] = tuple(+number for number in numbers)
        return found

    def refresh(self, bodies: Iterable[Body]) -> None:
        """Short copies of the states."""
        live = self.live
        if live._stale:
            ctx.prec = live.bits
            live.sync(tuple(body.index for body in bodies if body.index >= 0))
        ctx.prec = QUICK_BITS
        clocks: dict[int, arb] = {}
        for body in bodies:
            t = clocks.setdefault(id(body.t), +body.t)
            body.q = (+body.x, +body.y, +body.vx, +body.vy, t)
            self.filter.admit(body)

    def do(self, step: Step) -> None:
        """Carries out a step; the live machine logs it."""
        self.live.do(step)

    def to_predict(self) -> None:
        """Short precision."""
        ctx.prec = QUICK_BITS

    def predict_pair(self, a: Body, b: Body, parted: frozenset[Link]) -> None:
        """In doubles where their error bound leaves no doubt, else in short balls."""
        found = self.filter.pair(a, b, self._float_reaches[a.kind][b.kind])
        if found is MISS:
            return
        if isinstance(found, Answer):
            self.plan["unclear in doubles"] += 1
            super().predict_pair(a, b, parted)
            return
        link = (b.index, a.index) if 0 <= b.index < a.index else (a.index, b.index)
        if link not in parted:
            self._queue(*found, LATER, link)

    def predict_wall(self, a: Body, wall: int, parted: frozenset[Link]) -> None:
        """In doubles where their error bound leaves no doubt, else in short balls."""
        line = self._float_lines.get((a.index, wall)) or self._float_line(a, wall)
        found = self.filter.wall(a, line)
        if found is MISS:
            return
        if isinstance(found, Answer):
            self.plan["unclear in doubles"] += 1
            super().predict_wall(a, wall, parted)
            return
        link = (a.index, self.n + wall)
        if link not in parted:
            self._queue(*found, LATER, link)

    def _float_line(self, a: Body, wall: int) -> FloatLine:
        line = float_line(*self.quick_line(a, wall))
        self._float_lines[a.index, wall] = line
        return line

    def prepare(self) -> None:
        """Full precision, raised first if accuracy has run low."""
        live = self.live
        if live.lowest < SAFE_BITS:
            self._rise("accuracy had run low", self._foreseen_bits())
        ctx.prec = live.bits

    def bounds(self, time: arb) -> tuple[float, float]:
        """Doubles around a ball."""
        return ball.double_bounds(time)

    def knot(self, body: Body) -> tuple[Any, ...]:
        """The state: exact numbers if the body is exact, else short balls; and the length of the log."""
        live = self.live
        if live.exact[body.index]:
            return (*live.state(body.index), len(live.steps))
        x, y, vx, vy, t = body.q
        return (t, x, y, vx, vy, len(live.steps))

    def now(self, body: Body) -> Number:
        """The instant of a body's last contact: exact if the body is, else a short ball."""
        if self.live.exact[body.index]:
            return self.live.state(body.index)[0]
        with ball.precision(QUICK_BITS):
            return +body.instant

    def entry_time(self, link: Link) -> Number:
        """The time of an entry as a short ball."""
        time = self._hit_time(link)
        with ball.precision(QUICK_BITS):
            return +time

    def note(self) -> str:
        """The precision at work."""
        return f"{self.live.bits} bits"

    # -- the ladder

    def _foreseen_bits(self) -> int:
        """The bits that the whole run will need if it goes on losing them as it has."""
        done = len(self.history.records)
        wholes = []
        if self.limits.events is not None:
            wholes.append(self.limits.events)
        if self.limits.until is not None and done:
            reached = float(self.history.records[-1].time)
            if reached > 0.0:
                wholes.append(done * float(self.limits.until) / reached)
        if not wholes or not done:
            return 0
        lost = self.live.bits - self.live.lowest
        return int(min(min(wholes) / done * lost * FORESIGHT + 2 * SAFE_BITS, MOST_FORESIGHT * self.live.bits))

    def _rise(self, why: str, foreseen: int = 0) -> None:
        bits = max(2 * self.live.bits, min(foreseen, self.max_bits))
        if bits > self.max_bits:
            raise Undecided(
                f"{why} at {self.live.bits} bits, and max_bits is {self.max_bits}; "
                f"{self._where()}; allow more bits to go on"
            )
        self.plan["precision raised"] += 1
        self.live.rise(bits)

    def _where(self) -> str:
        return f"after {len(self.history.records)} instants"

    def name(self, link: Link) -> str:
        """A contact as a person reads it."""
        ids = self.scene.ids
        other = ids[link[1]] if link[1] >= 0 else f"pocket {self.scene.pockets[-1 - link[1]].id}"
        return f"{ids[link[0]]} and {other}"

    def _ball_sign(self, question: Question) -> int | None:
        bodies = question.bodies(self.n)
        ctx.prec = self.live.bits
        self.live.sync(bodies)
        try:
            return ball.sign_of(question.value(self.live.balls))
        except ZeroDivisionError:
            return None

    def _field_sign(self, question: Question) -> int | None:
        """The sign in the scene's field, where all bodies concerned are exact."""
        if not self.live.all_exact(question.bodies(self.n)):
            return None
        machine = self.live.field
        assert machine is not None
        try:
            parts = question.root_sum(machine)
        except LeavesField:
            return None
        if parts[2] == 0 and parts[4] == 0:
            return field_sign(parts[0])
        return sign_of_root_sum(*(self.live.numbers.element(part) for part in parts))

    def ask(self, question: Question) -> int:
        """The sign of a question, by the ladder.

        Raises:
            Undecided: naming the question, the rungs tried and the bits.
        """
        self.evidence = None
        found: Found | None = None
        last_bits = self.max_bits
        while True:
            sign = self._ball_sign(question)
            if sign is not None:
                self.plan["full ball"] += 1
                if sign == 0 and self.live.all_exact(question.bodies(self.n)):
                    self.evidence = Evidence(self._kind_of_field(question))
                return sign
            sign = self._field_sign(question)
            if sign is not None:
                self.plan["field"] += 1
                self.evidence = Evidence(self._kind_of_field(question))
                return sign
            if isinstance(question, Sooner) and self.prover.symmetric(question.first, question.second):
                self.plan["symmetry"] += 1
                self.evidence = Evidence(TieProof.SYMMETRY)
                return 0
            if self.prover.accepts(self._agreed_bits(question)):
                return self._taken(question, 0, Evidence(TieProof.ASSUMED, self.prover.bits))
            if found is None and self.live.bits >= TRY_BITS:
                found = self.prover.prove(question, self.history.steps)
                if found.sign is not None and found.evidence is not None:
                    return self._taken(question, found.sign, found.evidence)
                if found.evidence is not None and self.prover.rule is not Rule.ASSUME:
                    raise Undecided(self._undecided_message(question, found.told))
                if not found.nonzero and self.prover.rule is not Rule.ASSUME:
                    last_bits = min(self.max_bits, DOUBT_FACTOR * self.live.bits)
            if 2 * self.live.bits > last_bits:
                raise Undecided(self._undecided_message(question, found.told if found else ""))
            self._rise("undecided")

    def _taken(self, question: Question, sign: int, evidence: Evidence) -> int:
        """A sign decided by the prover; what is less than proof is kept as an assumption."""
        self.evidence = evidence
        self.plan[evidence.proof.name.lower()] += 1
        if not evidence.proof.proved:
            event = len(self.history.records)
            self.assumptions.append(Assumption(event, question.describe(self.name), evidence.proof, evidence.bound))
        return sign

    def _agreed_bits(self, question: Question) -> int:
        """To how many bits, in absolute value, the number asked about agrees with zero."""
        if self.prover.rule is not Rule.ASSUME:
            return 0
        ctx.prec = self.live.bits
        size = question.value(self.live.balls).abs_upper()
        return 0 if not size.is_finite() else max(0, -int(size.log().__truediv__(arb(2).log()).upper().ceil().fmpz()))

    def _undecided_message(self, question: Question, tried: str) -> str:
        return (
            f"{question.describe(self.name)} is not proved, after {len(self.history.records)} instants, "
            f"with {self.live.bits} bits" + (f"; {tried}" if tried else "")
        )

    def _kind_of_field(self, question: Question) -> TieProof:
        numbers = [number for i in question.bodies(self.n) for number in self.live.state(i)]
        rational = all(isinstance(number, fmpq) for number in numbers)
        return TieProof.RATIONAL if rational else TieProof.FIELD

    # -- which comes first

    def earliest(self, rivals: list[Candidate]) -> tuple[list[Candidate], list[Candidate], list[Tie]]:
        """Settles doubtful hits, then finds the first, or those proved to coincide."""
        self.prepare()
        candidates = [c for c in map(self._settled, rivals) if c is not None]
        if not candidates:
            return [], [], []
        rest = []
        front = []
        for c in candidates:
            if any(other.time < c.time for other in candidates):
                rest.append(c)
            else:
                front.append(c)
        first, ties = front[0], []
        chosen = [first]
        for c in front[1:]:
            sign = self.ask(Sooner(c.link, first.link))
            if sign < 0:
                rest += chosen
                first, ties, chosen = c, [], [c]
            elif sign > 0:
                rest.append(c)
            else:
                ties.append(self.tie_of((first.link, c.link)))
                chosen.append(c)
        return chosen, rest, ties

    def tie_of(self, links: tuple[Link, ...]) -> Tie:
        """The tie that the last question found, and how it is known."""
        evidence = self.evidence or Evidence(TieProof.CONSTRUCTION)
        contacts = tuple(contact_of(self.scene.ids, link) for link in links)
        return Tie(contacts, evidence.proof, evidence.bound)

    def ask_cheaply(self, question: Question) -> int | None:
        """The sign if the first rungs tell it, else None."""
        sign = self._ball_sign(question)
        return self._field_sign(question) if sign is None else sign

    def exact_state(self, bodies: Sequence[int]) -> Hashable | None:
        """The bodies' numbers as text, where all are exact."""
        if not self.live.all_exact(tuple(bodies)):
            return None
        return tuple(str(field_text(number)) for i in bodies for number in self.live.state(i))

    def order_chosen(self) -> None:
        """From here on, the symmetries of the scene prove nothing."""
        self.prover.drop_symmetries()
        if self.live.projected_until is None:
            self.live.projected_until = len(self.live.steps)

    def _settled(self, candidate: Candidate) -> Candidate | None:
        """The candidate if it is certain to come, or made so; None if it will not come."""
        link = candidate.link
        if candidate.time is LATER:
            return candidate._replace(time=self._hit_time(link))
        if candidate.time is not None:
            return candidate
        self.plan["doubtful settled"] += 1
        if link[1] < self.n and self.ask(Discriminant(link)) <= 0:
            return None
        if self.ask(Approach(link)) >= 0:
            return None
        return candidate._replace(time=self._hit_time(link))

    def _hit_time(self, link: Link) -> arb:
        """The time of a hit that is certain, as a ball of full precision that excludes the past."""
        while True:
            ctx.prec = self.live.bits
            self.live.sync(tuple(i for i in link if i < self.n))
            t, wait = self.live.balls.hit(link)
            if wait > ball.ZERO:
                return t + wait
            self._rise(f"the time of {self.name(link)} is unsharp")

    def unsure(self, link: Link) -> None:
        """A prediction that short balls could not decide: full balls, and proofs where a gap may be zero."""
        self.plan["full predictions"] += 1
        self.prepare()
        pair = link[1] < self.n
        gap = self.ask(Gap(link))
        if link[1] < 0 and gap <= 0:
            if gap == 0 and self.ask(Approach(link)) < 0:
                self.push(self.live.bodies[link[0]].t, link)
            return
        if gap == 0:
            self.found_touching(link, self.tie_of((link,)))
            return
        ctx.prec = self.live.bits
        approach = self._ball_sign(Approach(link))
        if approach is not None and approach >= 0:
            return
        disc = self._ball_sign(Discriminant(link)) if pair else 1
        if disc is not None and (disc < 0 or (disc == 0)):
            return
        if approach is not None and disc is not None:
            self.push(self._hit_time(link), link)
            return
        ctx.prec = self.live.bits
        low = self.earliest_possible(link)
        if low < inf:
            self.push_doubtful(low, link)


def contact_of(ids: tuple[str, ...], link: Link) -> Any:
    """A contact by id."""
    from ..scenarios.trajectory import Contact

    return Contact(ids[link[0]], ids[link[1]] if link[1] >= 0 else "pocket")
