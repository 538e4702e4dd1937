"""What every experiment on one divergence needs: the decision, and how each run has it; and the walk through causes."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from functools import cached_property, partial
from importlib import import_module
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

from flint import arb

from ...exact.numbers import ball
from ...scenarios.errors import SceneError
from ..alignment.align import Span, align
from ..alignment.instants import DOUBLE_BITS, Kind, instants
from ..deadline import NO_TIME, OutOfTime, time_to_read
from ..foreign.guard import allowances, run_guarded
from ..study import SERIES_MORE
from .decision import DecidingNumber, Pairing, RunReader, answer, decides_by_speed
from .diagnosis import CAUSES, LAW_RANK, Bounds, CauseName, Diagnosis, Experiment, Margin, diagnosed
from .given_scene import rounded

if TYPE_CHECKING:
    from ...scenarios.engine import Engine
    from ...scenarios.scene import Scene
    from ...scenarios.trajectory import Contact, OnProgress, Trajectory
    from ..alignment.align import Alignment
    from ..alignment.instants import Divergence
    from ..alignment.walk import Walk
    from ..candidate import Candidate
    from ..study import Study
    from .continuation import Continuation
    from .diagnosis import Account, Diagnosis


# -- what was decided


def decisions(reference: Trajectory, candidate: Trajectory, alignment: Alignment) -> list[DecidingNumber]:
    """What may have been decided otherwise at the first divergence, likeliest first.

    Of the meeting that one run has and the one that the other has instead, the earlier: whatever comes after it, its
    being there or not has changed the history.
    """
    divergence = alignment.divergence
    assert divergence is not None
    if divergence.kind is Kind.TIE:
        return _of_tie(reference, candidate, alignment, divergence)
    if taken := takings(reference, candidate, alignment):
        return [decision for one in taken for decision in one.decisions()]
    mine, theirs = _met_in_one(reference, alignment, divergence)
    found = _of_two((mine, divergence.expected_time or 0.0), (theirs, divergence.got_time or 0.0))
    return found if theirs is None else [*_of_partner(reference, alignment, theirs), *found]


def _of_partner(reference: Trajectory, alignment: Alignment, got: Pairing) -> list[DecidingNumber]:
    """Whether the partner of what only the other run has meets what it meets next in the reference before that."""
    anchor = got.anchors.get(got.partner)
    own = _own_events(reference, got.partner) if got.partner in got.anchors else []
    event = next((e for e in own if anchor is None or e > anchor), None)
    if event is None:
        return []
    pairs = [p for p in reference.events[event].impulses if got.partner in p and got.body not in p]
    return [DecidingNumber("order", _at_event(reference, alignment, pair, event), got) for pair in pairs[:1]]


def _met_in_one(
    reference: Trajectory, alignment: Alignment, divergence: Divergence
) -> tuple[Pairing | None, Pairing | None]:
    """The meeting that the reference has at a divergence, and the one that the other run has."""
    walks, body = alignment.walks, divergence.body
    expected = got = None
    if divergence.expected is not None:
        expected = _pairing(reference, walks, body, divergence.expected, divergence.expected_event, None)
    if divergence.got is not None and divergence.candidate_event is not None:
        got = _pairing(reference, walks, body, divergence.got, None, divergence.candidate_event)
    return expected, got


class Taking(NamedTuple):
    """A pocket takes a circle in one run that has a meeting, from the same flight on, in the other.

    Attributes:
        entry, meeting: what the one run has, and what the other.
        entered, met: when.
        of_reference: whether it is the reference that takes it.
    """

    entry: Pairing
    meeting: Pairing
    entered: float
    met: float
    of_reference: bool

    def decisions(self) -> list[DecidingNumber]:
        """As `decisions`."""
        mine, theirs = (self.entry, self.entered), (self.meeting, self.met)
        return _of_two(*((mine, theirs) if self.of_reference else (theirs, mine)))


def takings(reference: Trajectory, candidate: Trajectory, alignment: Alignment) -> list[Taking]:
    """The entries that one run has in place of what the other has at the first divergence, the earliest first."""
    divergence, found = alignment.divergence, list[Taking]()
    if divergence is None or divergence.kind is Kind.TIE or not reference.scene.capture:
        return found
    expected, got = _met_in_one(reference, alignment, divergence)
    times = divergence.expected_time or 0.0, divergence.got_time or 0.0
    for meeting, (met, other), run in ((expected, times, candidate), (got, times[::-1], reference)):
        if meeting is None:
            continue
        for name, anchor in meeting.anchors.items():
            pairs, of_reference = alignment.walks[name].pairs, run is reference
            theirs = max((c for m, c in pairs if m == anchor), default=None)
            after = anchor if of_reference else theirs
            entry = next((entry for entry in run.pocketings if entry.circle == name), None)
            if entry is None or (after is None) is not (anchor is None) or _has_more(run, name, after):
                continue
            time, meets = float(entry.time), expected if of_reference else got
            if meets is None or time <= other:  # else what the body meets before has been decided
                entered = Pairing(name, entry.pocket, {name: anchor})
                found.append(Taking(entered, meeting, time, met, of_reference))
    return sorted(found, key=lambda one: min(one.entered, one.met))


def _has_more(run: Trajectory, name: str, after: int | None) -> bool:
    """Whether a circle meets anything after an event; None: the start."""
    return any(e > (-1 if after is None else after) for e in _own_events(run, name))


def _of_two(mine: tuple[Pairing | None, float], theirs: tuple[Pairing | None, float]) -> list[DecidingNumber]:
    """What may have been decided where the reference has one meeting and the other run another, if any."""
    (expected, _), (got, _), hits = mine, theirs, (theirs, mine)
    found: list[DecidingNumber] = []
    for (pairing, _), (rival, instead) in sorted(zip(hits, hits[::-1], strict=True), key=lambda both: both[0][1]):
        if pairing is not None:
            found.append(DecidingNumber("hit", pairing, None, rival, instead))
    if expected is not None and got is not None:
        found.append(DecidingNumber("order", expected, got))
    return found


def _pairing(
    reference: Trajectory, walks: Mapping[str, Walk], body: str, partner: str, event: int | None, theirs: int | None
) -> Pairing | None:
    """Both as their last matched meetings before an event of either run left them."""
    anchors: dict[str, int | None] = {}
    for name in (body, partner):
        if name not in walks:
            continue
        pairs = walks[name].pairs
        if event is not None and name != body:
            before = [m for m in _own_events(reference, name) if m < event]
            anchors[name] = before[-1] if before else None
            continue
        known = [m for m, c in pairs if (m < event if event is not None else theirs is None or c < theirs)]
        if name == body:
            known = [m for m, c in pairs if (event is None or m < event) and (theirs is None or c < theirs)]
        elif theirs is not None and _parted_before(walks[name], theirs):
            return None
        anchors[name] = max(known, default=None)
    return Pairing(body, partner, anchors)


def _parted_before(walked: Walk, theirs: int) -> bool:
    return walked.mismatch is not None and walked.mismatch.theirs is not None and walked.mismatch.theirs < theirs


def _own_events(run: Trajectory, name: str) -> list[int]:
    return [e.index for e in run.events if any(name in pair for pair in e.impulses)]


def _of_tie(
    reference: Trajectory, candidate: Trajectory, alignment: Alignment, divergence: Divergence
) -> list[DecidingNumber]:
    """The order of the first two partners that the body meets at the instant, or in the instants taken as one.

    Where it meets but one of them, the first two of several instants taken as one, of which one leads to the other.
    """
    told = divergence.expected or ""
    if " then " not in told:
        following = _next_of_group(reference, alignment, divergence)
        if following is not None:
            return [following]
        told = divergence.got or ""
    names = list(dict.fromkeys(told.replace(" + ", " then ").split(" then ")))
    pairings = [
        _pairing(reference, alignment.walks, divergence.body, name, divergence.expected_event, None)
        for name in names[:2]
    ]
    if len(pairings) < 2 or pairings[0] is None or pairings[1] is None:
        return []
    return [DecidingNumber("order", pairings[0], pairings[1])]


def _next_of_group(reference: Trajectory, alignment: Alignment, divergence: Divergence) -> DecidingNumber | None:
    """The order of the first of several instants taken as one and of the one after it, to which it leads."""
    group = next((g for g in instants(alignment.walks) if divergence.expected_event in g.mine), None)
    if group is None or len(group.mine) < 2:
        return None
    first = reference.events[group.mine[0]]
    met = {name for pair in first.impulses for name in pair if name in alignment.walks}
    for event in group.mine[1:]:
        pair = next((p for p in reference.events[event].impulses if met & {*p}), None)
        if pair is not None:
            earlier = next(p for p in first.impulses if {*p} & {*pair})
            return DecidingNumber(
                "order",
                _at_event(reference, alignment, earlier, first.index),
                _at_event(reference, alignment, pair, event),
            )
    return None


def _at_event(reference: Trajectory, alignment: Alignment, pair: Contact, event: int) -> Pairing:
    """A contact of an event of the reference, each of the two as its last event before left it."""
    anchors: dict[str, int | None] = {}
    for name in pair:
        if name in alignment.walks:
            anchors[name] = max((m for m in _own_events(reference, name) if m < event), default=None)
    return Pairing(pair.first, pair.second, anchors)


# -- what experiments need


Answer = TypeVar("Answer")


class Laboratory:
    """What every experiment on one divergence needs.

    Attributes:
        bits: of the numbers to which the scene is rounded, where it is; `numbers` names them.
        given: the scene as the engine is given it; None if rounding makes it invalid.
        decision: what was decided; None where no contact could be named.
        truth, own: the reference and the candidate at it.
        margin, got: the number that decides, in each.
        taken: the entries into pockets that only one of the two runs has, in place of a meeting.
        first_time, last_time: when the first and the last of the meetings in question come, in either run.
        accounted: what the displacement is made of, or why that is not known, once it has been asked for.
        account: it, where causes are told by it.
        displacement: it, with what the decision itself is rounded by.
        chosen_before: whether the exact law resolves a tie as the candidate does, from its own state before.
    """

    def __init__(self, study: Study, candidate: Candidate, judged: Engine, progress: OnProgress | None) -> None:
        divergence = candidate.alignment.divergence
        assert divergence is not None
        self.study, self.candidate, self.engine, self.progress = study, candidate, judged, progress
        self.divergence = divergence
        self.reference = study.longest or study.reference
        self.name = candidate.engine
        self.bits = judged.bits or DOUBLE_BITS
        self.given = rounded_or_none(study.scene, self.bits) if judged.rounds_input else study.scene
        turned = self.reference.reversal
        self._rounds_to = self.bits if judged.rounds_input else None
        times = [t for t in (divergence.time, divergence.expected_time, divergence.got_time) if t is not None]
        self.taken = takings(self.reference, candidate.trajectory, candidate.alignment)
        times += [time for one in self.taken for time in (one.entered, one.met)]
        self.first_time, self.last_time = min(times), max(times)
        self.turned = None if turned is None or turned.after > divergence.expected_event else turned.after
        self.truth = RunReader(self.reference, turned_after=self.turned)
        self.own = RunReader(
            candidate.trajectory, candidate.alignment.walks, self._rounds_to, self.turned, self.first_time
        )
        self.decision = self._decision()
        self.margin = None if self.decision is None else arb(0) if self.tied else self.truth.value(self.decision)
        self.got = None if self.decision is None else self.own.value(self.decision)
        self.accounted: Account | str | None = None
        self.account: Account | None = None
        self.displacement: float | None = None
        self.chosen_before = False

    def _decision(self) -> DecidingNumber | None:
        """The decision that the candidate has otherwise; where its own flights have none, the closest.

        Two that part in both, as after their last meeting, decide nothing, whatever the candidate reports of them.
        """
        found = decisions(self.reference, self.candidate.trajectory, self.candidate.alignment)
        found = [d for d in found if not self.carried & {n for p in _all_of(d) for n in (p.body, p.partner)}]
        self.truth.read_ahead(found)
        asked = [d for d in found if d.kind == "order" or not (self.truth.parts(d.first) and self.own.parts(d.first))]
        known = [(d, v) for d in asked if (v := self.truth.value(d)) is not None]
        for decision, value in known:
            other = self.own.value(decision)
            if other is not None and answer(decision, other) != answer(decision, value):
                return decision
        return min(known, key=lambda pair: abs(float(pair[1].mid())), default=(None, None))[0]

    @cached_property
    def carried(self) -> frozenset[str]:
        """The circles that a wall has carried in either run up to the decision: they do not fly as others do."""
        runs = self.reference, self.candidate.trajectory
        return frozenset(s.circle for run in runs for s in run.settlings if float(s.time) <= self.last_time)

    def _leads_over_carried(self) -> frozenset[str]:
        """Those of them that may have led to the decision: that hang together with it by contacts before."""
        assert self.decision is not None
        walks, names = self.candidate.alignment.walks, {n for p in _all_of(self.decision) for n in (p.body, p.partner)}
        for event in reversed(self.reference.events[: self.divergence.expected_event + 1]):
            names |= {name for pair in event.contacts if names & walks.keys() & {*pair} for name in pair}
        return self.carried & names

    @property
    def numbers(self) -> str:
        """What the scene is rounded to, in words."""
        return "doubles" if self.bits == DOUBLE_BITS else f"numbers of {self.bits} bits"

    @property
    def pairings(self) -> list[Pairing]:
        """What the decision is between."""
        return [] if self.decision is None else self.decision.pairings

    def run(self, judged: Engine, scene: Scene, until: float) -> Trajectory:
        """A run that no want of time has cut short.

        Raises:
            OutOfTime: if the user's seconds are over before it ends.
        """
        return self.study.whole_run(judged, scene, until, self.progress)

    def run_some(self, scene: Scene, until: float, events: int) -> Trajectory:
        """A run of the reference's engine from another start, for a few events."""
        return run_guarded(self.study.truth, scene, until=until, events=events, progress=None)

    @property
    def input_rounded(self) -> bool:
        """Whether the engine is given another scene."""
        return self.engine.rounds_input and (self.given is None or self.given.digest != self.study.scene.digest)

    @cached_property
    def continued(self) -> Continuation | str:
        """What continues the engine's run to the decision; or why nothing does."""
        from .continuation import Continuation, NoContinuation

        if self.decision is None or self.margin is None:
            return "no contact can be named"
        if carried := self._leads_over_carried():
            return f"a wall carries {' and '.join(sorted(carried))} on the way there"
        try:
            return Continuation(
                self.reference, self.candidate.trajectory, self.candidate.alignment.walks, self.decision, self.turned,
                self._rounds_to, 2.0**-self.bits if self.engine.step is not None else None, self.first_time,
                allowances(self.engine, self.study.scene).get("threshold", 0.0), self.engine.step or 0.0,
            )  # fmt: skip
        except NoContinuation as why:
            return str(why)

    @cached_property
    def comes_late(self) -> bool:
        """Whether the exact flights lead to what the engine has hit, too, but later than a meeting is waited for."""
        if self.divergence.kind is not Kind.EXTRA or self.decision is None or self.decision.kind != "hit":
            return False
        return answer(self.decision, self.margin) == -1 == answer(self.decision, self.got)

    @cached_property
    def given_run(self) -> Trajectory:
        """The reference's engine on the scene as the candidate is given it."""
        assert self.given is not None
        return self.run(self.study.truth, self.given, self.until(None))

    @property
    def tied(self) -> bool:
        """Whether what is in question is an order of meetings that the reference has at one instant."""
        events, event, divergence = self.reference.events, self.divergence.expected_event, self.divergence
        if event >= len(events) or self.study.truth.rounds_input:  # its instants are of doubles
            return False
        pairs = {frozenset(pair) for pair in events[event].contacts}
        if self.decision is not None:
            asked = {frozenset((p.body, p.partner)) for p in self.pairings}
        else:
            known = {*divergence.partners} & {*self.study.scene.ids}
            asked = {frozenset((divergence.body, name)) for name in known if divergence.kind is Kind.TIE}
        return len(asked) > 1 and asked <= pairs

    def tried(self, experiment: Callable[[], Answer], otherwise: Answer) -> Answer:
        """What an experiment gives; something else once the user's seconds are over."""
        try:
            with time_to_read(self.study.watch):
                return experiment()
        except OutOfTime:
            return otherwise

    @property
    def scale(self) -> float:
        """The largest coordinate or radius of the scene."""
        return max(max(abs(float(c.x)), abs(float(c.y)), float(c.r)) for c in self.study.scene.circles)

    @property
    def span(self) -> Span:
        """Up to the divergence."""
        return Span(min(self.divergence.expected_event + 1, len(self.reference.events)), self.divergence.time)

    @property
    def passing(self) -> Span:
        """Up to where another step has to agree: a contact too many may come later then, up to the reference's next."""
        span, events, event = self.span, self.reference.events, self.divergence.expected_event
        if self.divergence.kind is not Kind.EXTRA:
            return span
        next_time = float(events[event].time if event < len(events) else self.reference.final_time)
        return Span(span.events, max(span.time, next_time))

    def until(self, step: float | None) -> float:
        """How far an experiment has to run: past both meetings, by what an error may delay them."""
        times = (self.passing.time, self.divergence.expected_time or 0.0)
        return max(times) * 1.125 + SERIES_MORE * (step or 0.0) + self.study.patience(None).slack / 8

    def changes(self, value: arb | None) -> bool:
        """Whether a value of the decision is another answer than the exact one."""
        found = None if self.decision is None else answer(self.decision, value)
        return self.decision is not None and found is not None and found != answer(self.decision, self.margin)

    def as_engine(self, value: arb | None) -> bool:
        """Whether a value of the decision is another answer than the exact one, and the one that the engine has."""
        if self.decision is None or not self.changes(value):
            return False
        return not self.changes(self.got) or answer(self.decision, value) == answer(self.decision, self.got)


def _all_of(decision: DecidingNumber) -> list[Pairing]:
    """The pairings of a decision, with the meeting that the other run has instead."""
    return [*decision.pairings, *([] if decision.rival is None else [decision.rival])]


FARTHER = 8
"""Times the decision's own time up to which a run is carried on to see whether two histories agree up to there."""


def given_does(lab: Laboratory) -> bool:
    """Whether the exact run of the scene as the engine is given it has the engine's contacts, past the divergence.

    Or whether it has the contact itself that the engine has there and the reference lacks, whatever comes of it.
    """
    if lab.given is None or lab.given.digest == lab.study.scene.digest:
        return False
    run, parted = lab.given_run, lab.divergence
    event = parted.candidate_event if parted.kind in (Kind.DIFFERENT, Kind.EXTRA) else None
    while True:
        span = Span(len(run.events), lab.last_time)
        found = align(run, lab.candidate.trajectory, span=span, bits=lab.engine.bits)
        walked = found.walks[parted.body]
        at_once = [mine for mine, theirs in walked.pairs if theirs == parted.candidate_event]
        if parted.kind is Kind.TIE and parted.got != parted.expected and len(at_once) > len({*at_once}) == 1:
            return True  # both have at once what the reference has one after the other
        if event is not None and parted.got is not None and any(theirs == event for _, theirs in walked.pairs):
            lacked = lab.candidate.alignment.walks[parted.body].left(event, parted.got)
            if walked.left(event, parted.got) < lacked:
                return True
        if found.divergence is not None or not found.unsettled:
            return found.divergence is None or found.divergence.time > lab.last_time
        until, more = float(run.final_time), found.wanted.reference
        if more is None or not until < more <= FARTHER * lab.last_time:
            return False
        run = lab.run(lab.study.truth, lab.given, 1.125 * more)


def given_keeps(lab: Laboratory) -> bool:
    """Whether the exact run of the scene as the engine is given it has the reference's contacts past the decision."""
    if lab.given is None:
        return False
    span = Span(len(lab.reference.events), lab.last_time * (1 + 2.0**-20))
    return align(lab.reference, lab.given_run, span=span).verdict == "agree"


def rounded_or_none(scene: Scene, bits: int) -> Scene | None:
    """The scene in numbers of so many bits; None if it is no longer valid."""
    try:
        return rounded(scene, bits)
    except SceneError:
        return None


def diagnosis_of(lab: Laboratory) -> Diagnosis:
    """Why two histories part: what a run shows to suffice, or the shares of the displacement.

    A law that the engine has broken by then outranks all else, and only laws are looked at then. Then come runs:
    contacts whose impulse is below rounding, a finer time step that passes the event, a tie that another run resolves
    alike. Shares of the displacement stand beside them. What the user's seconds leave no time for is not tried, and
    says so.
    """
    rows: list[Experiment] = []
    for name, cause in CAUSES.items():
        lawless = any(row.suffices is True and row.cause.entry.rank == LAW_RANK for row in rows)
        if cause.experiment is not None and not (lawless and cause.rank > LAW_RANK):
            function, late = _function(cause.experiment), Experiment(CauseName[name], NO_TIME)
            rows += lab.tried(partial(function, lab, rows), [late])
    margin = None if lab.margin is None else float(lab.margin.mid())
    account = lab.account
    return diagnosed(rows, margin, lab.displacement, 0 if account is None else account.runs)


def _function(path: str) -> Callable[..., list[Experiment]]:
    """The function of that name, imported now."""
    module, _, name = path.partition(":")
    function: Any = getattr(import_module(f".{module}", __package__), name)
    return function


# -- the margin, beside the engine's error: how close the decision was, and how far off the engine was by then


def margin_of(lab: Laboratory, found: Diagnosis) -> Margin:
    """The margin of a candidate's divergence: as much of it as the user's seconds leave time for.

    A contact below rounding has none: no two flights are close to another decision.
    """
    from ..tangent.growth import error_growth

    divergence = lab.divergence
    gap = distance = speed = None
    ulps: float | None = None
    if found.name in (CauseName["PHANTOM"], CauseName["PARTING"]):
        pass
    elif lab.decision is not None and lab.margin is not None:
        if lab.decision.kind == "hit" and decides_by_speed(lab.truth, lab.decision.first):
            if found.name is not CauseName["LAW"]:  # with another law it is not the speed that decides
                speed = ball.double_bounds(lab.margin)
        elif lab.decision.kind == "hit":
            distance = None if _part_for_good(lab, lab.decision.first) else ball.double_bounds(lab.margin)
        else:
            gap = (0.0, 0.0) if lab.tied else ball.double_bounds(lab.margin)
            ulps = max(abs(gap[0] + gap[1]) / 2, 0.0) / math.ulp(max(abs(divergence.time), math.ulp(0.0)))
            distance = lab.tried(lambda: _second_gap(lab), None)
    elif lab.decision is None and lab.tied:
        gap = distance = (0.0, 0.0)
    error = lab.tried(lambda: _error(lab), None)
    growth = lab.tried(lambda: error_growth(lab.reference, divergence.expected_event), None)
    entry = next((p for p in lab.pairings if any(p == one.entry for one in lab.taken)), None)
    named = None if entry is None else (entry.body, entry.partner)
    return Margin(gap, distance, speed, ulps, error, growth, lab.study.watch.over, named)


def _part_for_good(lab: Laboratory, pairing: Pairing) -> bool:
    """Whether two circles part, in the exact motion, from a touch of theirs, and neither stands under gravity.

    They never come near each other again, so that no distance is a margin.
    """
    met, pegs = {*pairing.anchors.values()}, lab.study.scene.surfaces.pegs
    names = pairing.body, pairing.partner
    if len(met) != 1 or None in met or len(pairing.anchors) < 2 or any(lab.truth.places[n] in pegs for n in names):
        return False
    return any({*contact} == {*names} for event in met for contact in lab.reference.events[event or 0].contacts)


def _second_gap(lab: Laboratory) -> Bounds | None:
    """How far the pair that meets second is apart when the first one meets."""
    assert lab.decision is not None and lab.decision.second is not None
    if lab.tied:
        return 0.0, 0.0
    one, other = lab.decision.first, lab.decision.second
    with ball.precision(4096):
        times = lab.truth.hit_time(one), lab.truth.hit_time(other)
        if times[0] is None or times[1] is None:
            return None
        later, time = (other, times[0]) if ball.sign_of(times[1] - times[0]) != -1 else (one, times[1])
        found = lab.truth.gap_at(later, time)
    return None if found is None else ball.double_bounds(found)


def _error(lab: Laboratory) -> float | None:
    """The engine's position error at the earlier of the two events, over the circles in question."""
    run, reference = lab.candidate.trajectory, lab.reference
    time = lab.first_time if lab.taken else lab.divergence.time  # what a pocket has taken does not fly on
    last = min(float(run.final_time), float(reference.final_time), time)
    if not last > 0:
        return 0.0 if lab.divergence.time == 0 else None
    at = math.nextafter(last, 0.0)
    names = {lab.divergence.body, lab.divergence.expected, lab.divergence.got}
    rows = [k for k, c in enumerate(lab.study.scene.circles) if c.id in names and not c.fixed]
    mine, theirs = ([(float(c.x), float(c.y)) for c in each.at(at).circles] for each in (reference, run))
    return max((math.dist(mine[k], theirs[k]) for k in rows), default=None)
