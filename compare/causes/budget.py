"""The account of a displacement: what each kind of error adds to the number that decides.

An engine's run to the decision is a chain of states: the scene, the scene as the engine is given it, and its own state
after each contact. Continued from each of them by the exact law, the decision's number has a value; from the first it
is the exact margin, from the last the engine's own value. The contribution of a step is the difference between the
values after and before it, so that all contributions together are the displacement: the account closes (a telescoping
sum, "Lady Windermere's fan": Hairer, Norsett and Wanner, *Solving Ordinary Differential Equations I*, 2nd edition 1993,
section II.3).

Kinds of error within a group of steps are told apart by adding the defects of one kind after the other in that group
alone. Two orders in which they are added give two answers where errors act on each other; a group whose answers differ
by more than a tenth is cut in two, and their mean is taken in the end. Where the rounded scene alone does not lead to
the decision, or kinds of errors of steps act on each other too much for that, all errors are let grow together instead.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from contextlib import suppress
from typing import TYPE_CHECKING

from flint import arb

from ...exact.numbers import ball
from ..alignment.instants import Kind
from ..validation import falls
from .continuation import (
    CORRECTION,
    FLIGHTS,
    IMPACTS,
    INTEGRATOR,
    KINDS,
    LATENESS,
    MERGED,
    OVERLAP,
    SEVERAL,
    SOLVER,
    THRESHOLD,
    Continuation,
    NoContinuation,
    Stretch,
)
from .diagnosis import Account, CauseName, Contribution, Experiment

if TYPE_CHECKING:
    from ..audit.audit import Audit
    from ..audit.residual import Violation
    from .continuation import Rows
    from .laboratory import Laboratory

TENTH = 0.1
"""Two answers that differ by so much of a group's contribution are not taken as one."""

SMALL = 0.1
"""Groups that contribute less than this share of the displacement are not cut."""

FAINT = 0.01
"""Contributions below this share of the displacement act on each other by a hundredth of themselves; steps that miss a
law and add less than this share of the margin are told from rounding."""

ALONE = 0.1
"""Share of the margin up to which a kind is not run alone: it changes nothing. Above it, what a kind does alone need
not be what it adds, as kinds act on each other."""

MOST_RUNS = 24
"""Continuations after which no group is cut any more."""

GAUSS_3 = (
    ("0.11270166537925831148207346002176", "5/18"),
    ("0.5", "4/9"),
    ("0.88729833462074168851792653997824", "5/18"),
)
GAUSS_5 = (
    ("0.046910077030668003601186560850304", "0.11846344252809454375713202035996"),
    ("0.2307653449471584544818427896499", "0.23931433524968323402064575741782"),
    ("0.5", "0.28444444444444444444444444444444"),
    ("0.7692346550528415455181572103501", "0.23931433524968323402064575741782"),
    ("0.9530899229693319963988134391497", "0.11846344252809454375713202035996"),
)
"""Nodes and weights of Gauss and Legendre on 0 to 1 (Abramowitz and Stegun, table 25.4)."""

TINY = 60
"""Halvings of a share by which a derivative is taken."""

CLOSE = 0.02
"""Share of the displacement by which integrals may miss it; what they miss is spread over them."""

CANCELS = 2.0**20
"""Times the displacement from which on contributions that cancel are not told apart: where errors grow so fast,
differences by 2**-60 are no derivatives."""

CLOSED = 2.0**-40
"""Share of a displacement up to which an account is closed: what is left is of the enclosures."""

LOST = "neither with only that nor without it do the contacts that lead to the decision exist"
"""Why it is not determined what steps that miss a law come to."""

Group = tuple[CauseName, tuple[str, ...]]
"""A kind of error that is told, and the kinds of defects that it holds."""

OF_EVENTS: tuple[Group, ...] = (
    (CauseName["FLIGHTS"], (FLIGHTS, LATENESS, OVERLAP, CORRECTION)),
    (CauseName["IMPACTS"], (IMPACTS, SEVERAL, MERGED)),
)
"""Of an engine of events, the time of a contact is rounded where a flight ends."""

OF_STEPS: tuple[Group, ...] = (
    (CauseName["FLIGHTS"], (FLIGHTS,)),
    (CauseName["INTEGRATOR"], (INTEGRATOR,)),
    (CauseName["LATENESS"], (LATENESS,)),
    (CauseName["OVERLAP"], (OVERLAP,)),
    (CauseName["IMPACTS"], (IMPACTS,)),
    (CauseName["SOLVER"], (SOLVER,)),
    (CauseName["THRESHOLD"], (THRESHOLD,)),
    (CauseName["SEVERAL"], (SEVERAL,)),
    (CauseName["MERGED"], (MERGED,)),
    (CauseName["CORRECTION"], (CORRECTION,)),
)


class _Sum:
    """Contributions as they are found."""

    def __init__(self, run: Continuation, groups: Sequence[Group], whole: arb) -> None:
        self.run, self.kinds, self.whole = run, groups, whole
        self.found: dict[CauseName, arb] = {}
        self.groups = 0
        self.loose = 0.0  # by how much contributions are not told apart
        self._slopes: dict[tuple[str, tuple[str, ...] | None], arb] = {}
        self._on_the_way: dict[str, arb | None] = {}

    def add(self, cause: CauseName, value: arb) -> None:
        self.found[cause] = self.found.get(cause, arb(0)) + value

    def split(self, begin: int, end: int, first: arb, last: arb) -> None:
        """Accounts for the steps from one to another, between which the value goes from `first` to `last`.

        Raises:
            NoContinuation: where single kinds of errors do not lead to the decision.
        """
        present = [group for group in self.kinds if self._has(group, begin, end)]
        if len(present) <= 1:
            self.groups += 1
            self.add(present[0][0] if present else self.kinds[0][0], last - first)
            return
        found = self._both_ways(present, begin, end, self.run.state_before(begin), first, last)
        large, ends = max(_size(last - first), SMALL * _size(self.whole)), end
        while (found is None or found[1] > TENTH * large) and end - begin > 1 and self.run.runs < MOST_RUNS:
            middle = (begin + end) // 2
            value = self.run.value(middle, self.run.state_before(middle))
            if value is None:
                break
            if _size(last - value) > FAINT * _size(self.whole):
                self.split(begin, middle, first, value)
                self.split(middle, end, value, last)
                return
            self.split(middle, end, value, last)  # so little that the first half is as the whole
            end, last = middle, value
        if found is not None and end != ends:
            found = self._both_ways(present, begin, end, self.run.state_before(begin), first, last)
        if found is None:
            raise NoContinuation("with some of its errors alone, the contacts that lead to the decision do not exist")
        self.loose += found[1]
        if self.loose > TENTH * max(map(_size, (self.whole, *self.found.values()))):
            raise NoContinuation("its kinds of error act on each other too much to be distinguished")
        self.groups += 1
        for cause, value in found[0].items():
            self.add(cause, value)

    def along(self, margin: arb) -> None:
        """Accounts for all errors, the input's too, as they grow together from none to what they are.

        A kind's contribution is the integral of the derivative by it, along the straight way from the exact motion to
        the engine's (Aumann and Shapley, *Values of Non-Atomic Games*, 1974): no order of the kinds is preferred, and
        all together are the displacement. Derivatives are differences of continuations.

        Raises:
            NoContinuation: where some motion on the way does not exist, or the integral is not found.
        """
        present = [group for group in self.kinds if self._has(group, 0, len(self.run.stretches))]
        *groups, last = (CauseName["INPUT"], ()), *present
        every = tuple(kind for _, kinds in present for kind in kinds)
        for nodes in (GAUSS_3, GAUSS_5):
            rest = sum((arb(weight) * self._slope(node, every, None) for node, weight in nodes), arb(0))
            if _size(rest - self.whole) > CLOSE * _size(self.whole):
                continue
            found: list[arb] = []
            for _, kinds in groups:
                found.append(sum((arb(weight) * self._slope(node, every, kinds) for node, weight in nodes), arb(0)))
            found.append(rest - sum(found, arb(0)))
            if max(map(_size, found)) > CANCELS * _size(rest):
                break
            for (cause, _), value in zip((*groups, last), found, strict=True):
                self.add(cause, value * (self.whole / rest))
            self.groups += 1
            return
        raise NoContinuation("its errors act on each other too much to be distinguished")

    def _slope(self, node: str, every: tuple[str, ...], kinds: tuple[str, ...] | None) -> arb:
        """The derivative at a share of all errors, by some kinds; by the input's for none; by all together for None."""
        if (node, kinds) not in self._slopes:
            at, more = arb(node), arb(node) + arb(2) ** -TINY
            if node not in self._on_the_way:
                self._on_the_way[node] = self.run.value_at(at, {every: at})
            growing = every if kinds is None else kinds
            shares = {growing: more, tuple(kind for kind in every if kind not in growing): at}
            here, beside = self._on_the_way[node], self.run.value_at(at if kinds else more, shares)
            if here is None or beside is None:
                raise NoContinuation("with a part of its errors, contacts that lead to the decision do not exist")
            self._slopes[node, kinds] = (beside - here) * arb(2) ** TINY
        return self._slopes[node, kinds]

    def _both_ways(
        self, present: Sequence[Group], begin: int, end: int, rows: Rows | None, first: arb, last: arb
    ) -> tuple[dict[CauseName, arb], float] | None:
        """Contributions, the mean of two orders in which kinds are added, and how far the two are apart.

        Where all are faint one order is enough: the other differs by their product, as a share of the whole.
        """
        there = self._in_turn(present, begin, end, rows, first, last)
        if there is not None and all(_size(value) <= FAINT * _size(self.whole) for value in there.values()):
            sizes = sorted(map(_size, there.values()))
            whole = _size(self.whole)
            return there, sizes[-1] * sizes[-2] / whole if whole else 0.0
        back = None if there is None else self._in_turn(present[::-1], begin, end, rows, first, last)
        if there is None or back is None:
            return None
        apart = max((_size(there[cause] - back[cause]) for cause, _ in present), default=0.0)
        return {cause: (there[cause] + back[cause]) / 2 for cause, _ in present}, apart

    def _has(self, group: Group, begin: int, end: int) -> bool:
        """Whether any step has a defect of a kind."""
        return any(stretch.of(group[1]) for stretch in self.run.stretches[begin:end])

    def _in_turn(
        self, groups: Sequence[Group], begin: int, end: int, rows: Rows | None, first: arb, last: arb
    ) -> dict[CauseName, arb] | None:
        """Contributions where the kinds are added in an order; from the exact scene where no state is given."""
        found: dict[CauseName, arb] = {}
        before, kinds = first, list[str]()
        for cause, of in groups[:-1]:
            kinds += of
            value = self.run.value(begin, rows, kinds, range(begin, end), exact=rows is None)
            if value is None:
                return None
            found[cause], before = value - before, value
        if groups:
            found[groups[-1][0]] = last - before
        return found


def account_of(run: Continuation, margin: arb, own: arb | None, stepped: bool, input_rounded: bool) -> Account:
    """Accounts for the displacement of a decision.

    Args:
        run: continues the engine's run.
        margin: the exact value.
        own: the engine's own value, by its own flights.
        stepped: whether the engine takes time steps.
        input_rounded: whether rounding has changed the scene.

    Raises:
        NoContinuation: where the account cannot be closed.
    """
    groups = OF_STEPS if stepped else OF_EVENTS
    rest = CauseName["STEPS" if stepped else "ARITHMETIC"]
    with ball.precision(run.bits):
        whole, apart, unlike, along = run.value(kinds=KINDS), "", False, False
        if own is not None and (whole is None or _apart(whole, own, margin) > CLOSED):
            whole, apart, unlike = own, "its flights change where no contact explains it", True
        if whole is None:
            raise NoContinuation("the engine's own contacts do not lead to the decision by the exact law")
        displacement = whole - margin
        total = _Sum(run, groups, displacement)
        entered = run.value() if input_rounded else margin
        alone: dict[CauseName, arb] = {}
        late: dict[CauseName, bool | None] = {CauseName["INPUT"]: run.forestalled} if input_rounded else {}
        hits = run.decision.rival is not None and ball.sign_of(margin) == -1  # less deep, they may come to it late
        if entered is None:
            if apart:
                raise NoContinuation(apart)
            total.along(margin)
            along = True
        else:
            if input_rounded:
                total.add(CauseName["INPUT"], entered - margin)
                alone[CauseName["INPUT"]] = entered
            try:
                if apart:
                    raise NoContinuation(apart)
                total.split(0, len(run.stretches), entered, whole)
            except NoContinuation as why:
                apart = str(why)
                total.found = {CauseName["INPUT"]: entered - margin, rest: whole - entered}
                if stepped and not unlike:  # steps err by much: their kinds, grown together, may yet be told apart
                    grown = _Sum(run, groups, displacement)
                    with suppress(NoContinuation):
                        grown.along(margin)
                        total, apart, along = grown, "", True
        together = sum((value for cause, value in total.found.items() if cause is not CauseName["INPUT"]), arb(0))
        for cause, kinds in (*groups, (rest, KINDS)):
            value = together if cause is rest else total.found.get(cause)
            if value is None:
                continue
            if (
                _size(value) > ALONE * _size(margin)
                or _flips(margin, margin + value)
                or (hits and ball.sign_of(value) == 1)
            ):
                if unlike:  # what is carried on is not the engine's run: it is known where it alone has erred
                    found = whole if total.found.get(CauseName["INPUT"], arb(0)).contains(0) else None
                else:
                    found = run.value(kinds=kinds, exact=True)
                    late[cause] = run.forestalled
                if found is not None:
                    alone[cause] = found
        return Account(
            _near(displacement),
            tuple(Contribution(c, _near(value), alone.get(c), late.get(c, False)) for c, value in total.found.items()),
            Contribution(rest, _near(together), alone.get(rest), late.get(rest, False)),
            run.runs,
            total.groups,
            apart,
            along,
        )


def accounted(lab: Laboratory) -> Account | str:
    """What a displacement is made of; or why there is no such account."""
    if lab.accounted is None:
        run, margin = lab.continued, lab.margin
        try:
            lab.accounted = (
                account_of(run, margin, lab.got, lab.engine.step is not None, lab.input_rounded)
                if not isinstance(run, str) and margin is not None
                else str(run)
            )
        except NoContinuation as why:
            lab.accounted = str(why)
    return lab.accounted


def _flips(margin: arb, value: arb) -> bool:
    """Whether two values may have different signs."""
    return ball.sign_of(margin) != ball.sign_of(value)


def _apart(value: arb, other: arb, margin: arb) -> float:
    """How far two values are apart, as a share of their distance from the margin."""
    most = max(_size(value - margin), _size(other - margin))
    return _size(value - other) / most if most else 0.0


def _near(value: arb) -> float:
    """The double nearest to a number; 0 where it cannot be told from 0."""
    return 0.0 if value.contains(0) else float(value.mid())


def _size(value: arb) -> float:
    return abs(float(value.mid()))


# -- laws


def law(lab: Laboratory, rows: Sequence[Experiment]) -> list[Experiment]:
    """A row where steps that miss a law lead to the divergence, and whether what they miss changes it.

    A step leads there through the circles that it moves and the contacts that these have from then on. Whether it
    changes the decision is told by a continuation, in which only these steps err; where the contacts that lead to the
    decision do not exist then, by one in which all others do.
    """
    laws = lab.candidate.laws
    if laws is None or laws.kept is not False:
        return []
    cause = CauseName["LAW"]
    if not laws.missed:
        return [Experiment(cause, laws.finding, None, True)]
    way = _on_the_way(lab, laws)
    if not way:
        return []
    found = laws.finding if laws.fit is not None else str(way[0])
    run, margin = lab.continued, lab.margin
    if isinstance(run, str) or margin is None or any(_decides(lab, missed) for missed in way):
        return [Experiment(cause, found, None, True)]
    broken = [place for place, stretch in enumerate(run.stretches) if any(_is_of(run, stretch, v) for v in way)]
    value = run.value(kinds=KINDS, among=broken, exact=True)
    changes = lab.changes(value)
    with ball.precision(run.bits):
        shift = None if value is None else _near(value - margin)
    if not changes:
        rest = run.value(kinds=KINDS, among=[place for place in range(len(run.stretches)) if place not in broken])
        if rest is None and value is None:
            return [Experiment(cause, f"{found}; not determined: {LOST}")]
        if rest is not None and not lab.changes(rest):
            return [Experiment(cause, f"{found}; without that the decision is the exact one", shift, True)]
        size = float(margin.mid())
        if shift and size and -shift / size > FAINT:  # what steps miss by less than rounding is not told from it
            return [Experiment(cause, f"{found}; that adds {shift:+.3g} to the margin of {size:.3g}", shift, True)]
        found = f"{found}; that does not change the decision by itself"
    return [Experiment(cause, found, shift, changes)]


def _on_the_way(lab: Laboratory, laws: Audit) -> list[Violation]:
    """The steps that miss a law and lead to the divergence, by the engine's own contacts."""
    parted, walks, run = lab.divergence, lab.candidate.alignment.walks, lab.candidate.trajectory
    latest, got = lab.last_time, parted.got_time
    if got is not None and got < (math.inf if parted.expected_time is None else parted.expected_time):
        latest = max(got, parted.time)  # what it has too much is there by then
    asked = {parted.body, parted.expected, parted.got} | {n for p in lab.pairings for n in (p.body, p.partner)}
    needed = dict.fromkeys(asked & {*walks}, latest)
    for event in reversed(run.events):
        time = float(event.time)
        if time > latest:
            continue
        pairs = [{*pair} & {*walks} for pair in event.contacts]
        while more := [p for p in pairs if any(needed.get(n, -1.0) >= time for n in p) and not p <= needed.keys()]:
            needed.update((n, time) for p in more for n in p if n not in needed)
    return [missed for missed in laws.missed if _leads(lab, missed, needed, latest)]


def _leads(lab: Laboratory, missed: Violation, needed: Mapping[str, float], latest: float) -> bool:
    """Whether a step that misses a law is one of some circles, each up to a time, or misses what is expected."""
    if any(not falls(missed.time, needed[n], lab.engine.bits) for n in missed.bodies if n in needed):
        return True
    parted = lab.divergence
    both = {parted.body, parted.expected}
    if missed.kind != "depth" or {*missed.bodies} != both:
        return False
    # how deep they fly into each other is known when they are deepest, later: unless they meet others before
    met = {c for m, c in lab.candidate.alignment.walks[parted.body].pairs if m == parted.expected_event}
    events = [e for k, e in enumerate(lab.candidate.trajectory.events) if k not in met]
    times = [float(e.time) for e in events if any(both & {*pair} for pair in e.contacts)]
    return not any(latest < time < missed.time for time in times)


def _decides(lab: Laboratory, missed: Violation) -> bool:
    """Whether a step that misses a law is the divergence itself: a contact too many or too few, or a tie's impulses."""
    parted = lab.divergence
    if missed.kind == "depth":
        return {*missed.bodies} == {parted.body, parted.expected}
    if missed.kind == "bystander" and parted.candidate_event is None:  # it has the impulse, and tells no contact
        return parted.body in missed.bodies and not falls(parted.time, missed.time, lab.engine.bits)
    return missed.event == parted.candidate_event and (missed.kind == "gap" or parted.kind is Kind.TIE)


def _is_of(run: Continuation, stretch: Stretch, missed: Violation) -> bool:
    """Whether a step that misses a law is one of a stretch."""
    places = {run.places[name] for name in missed.bodies} & {*stretch.bodies}
    if stretch.links or not places:  # two may fly into each other just before they meet, or after
        events = {missed.event, missed.event - (missed.kind == "depth")}
        return bool(places) and not events.isdisjoint(stretch.own)
    if missed.kind == "start":
        return stretch is run.stretches[0]
    return any(stretch.before[k][0] < missed.time <= stretch.after[k][0] for k in places)
