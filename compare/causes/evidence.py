"""What is seen of each cause at a divergence: laws, phantom contacts, ties, and the shares of the displacement."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from flint import arb

from ...exact.exact_motion import ExactMotion, ExactValue
from ...exact.numbers import ball
from ...exact.replay.contact import is_pair
from ...exact.replay.state import Kick
from ...floating.knots import DoubleMotion, EventMotion
from ...scenarios.errors import SceneError
from ...scenarios.numbers.quantity import ZERO, Quantity, real
from ...scenarios.surfaces import parts_of
from ...scenarios.things import Circle, Polygon, Segment, Wall
from ...scenarios.trajectory import Event
from ..alignment.align import align
from ..alignment.walk import history
from ..audit.residual import AUDIT_BITS
from ..audit.residuals import Laws
from ..audit.transcript import Transcript
from .budget import ALONE, accounted
from .decision import RunReader, answer
from .diagnosis import CauseName, Experiment
from .free_flights import short_quantity
from .laboratory import given_does, given_keeps

if TYPE_CHECKING:
    from ...scenarios.scene import Scene
    from ...scenarios.trajectory import Contact, Trajectory
    from ..alignment.align import Alignment
    from .diagnosis import Account, Contribution
    from .free_flights import OwnFlight
    from .laboratory import Laboratory

LATER, LATER_UNITS = 2.0**-30, 2.0**4
"""Share of a time by which the exact law may be later than the engine at an instant that it is run for; and the same in
units in the last place of the engine's numbers, where that is more."""

REORDERED = 2.0**16
"""Units in the last place by which rounding may move a decision in whatever order of operations: the discriminant as
(d.v)^2 - |v|^2 (|d|^2 - R^2) loses (|d| / R)^2 against its stable form, so much at 256 radii."""

MOST_ROUNDED = 2.0**-10
"""Share of the largest size up to which that is said of engines of few bits."""

ALIKE, ALIKE_UNITS = 2.0**-12, 2.0**6
"""Share of the largest speed by which velocities may differ that two resolutions of one instant have in common; and the
same in units in the last place of the engine's numbers, where that is more."""

DIGITS = 80
"""Digits of a number whose exact text is long."""

ORDERS = 6
"""Orders drawn from seeds that are tried beside the named policies."""

MOST_INSTANTS = 64
"""Events for which the exact law is run from an engine's own state before a tie."""


# -- contacts whose impulse is below rounding


def phantom(lab: Laboratory, rows: Sequence[Experiment]) -> list[Experiment]:
    """Contacts whose impulse is below rounding, where nothing else differs without them.

    Of engines of steps at restitution 0 alone, where what has met stays closed, and is solved again at every step.
    """
    run, parted = lab.candidate.trajectory, lab.divergence
    bounces = lab.engine.step is not None and lab.study.scene.restitution.sign()
    if lab.engine.bits is None or parted.candidate_event is None or bounces:
        return []
    if lab.got is not None and lab.changes(lab.got):
        return []  # in its own flights the two do meet, or pass
    if not (faint := _faint(lab)):
        return []

    def without(among: Collection[tuple[int, int]]) -> Alignment:
        return align(lab.reference, _without(run, among), span=lab.study.span, bits=lab.engine.bits)

    event, place = named = min(faint, key=lambda at: abs(at[0] - (parted.candidate_event or 0)))
    more, found = 0, without({named})
    if found.verdict != "agree" and len(faint) > 1:  # what is said is what was tried
        more, found = len(faint) - 1, without(faint)
    later = found.divergence
    if found.verdict != "agree" and (later.expected_event if later else found.agreed - 1) <= parted.expected_event:
        return []
    pair, (approach, speed) = run.events[event].impulses[place], faint[named]
    others = f"without it{f' and {more:,} more below rounding' if more else ''}"
    rest = f"{others} nothing else differs" if found.verdict == "agree" else f"{others} the two agree for longer"
    meet = f"approach by {approach:.3g}" if approach else "do not approach"
    told = f"{pair.first} and {pair.second} {meet} there; rounding of speeds of {speed:.3g} comes to more"
    if approach < 0.0:
        told = f"{pair.first} and {pair.second} part there, by {-approach:.3g}, and nothing pushes them"
    finer = any(row.suffices and row.cause is CauseName["STEP"] for row in rows)  # that comes before it
    cause = CauseName["PARTING" if approach < 0.0 else "PHANTOM"]
    return [Experiment(cause, f"{told}; {rest}", None, None if finer else True)]


def _faint(lab: Laboratory) -> dict[tuple[int, int], tuple[float, float]]:
    """The impulses below rounding up to the divergence, or of steps, by event and place: approach, speed of the two."""
    from ..audit.audit import unit_of

    run = lab.candidate.trajectory
    transcript = Transcript(run, encloses=True)
    found: dict[tuple[int, int], tuple[float, float]] = {}
    latest, made = lab.last_time if lab.engine.step is None else math.inf, 0
    with ball.precision(AUDIT_BITS):
        laws = Laws(run.scene, unit_of(lab.engine, transcript), lab.engine.rounds_input)
        for instant in transcript.instants():
            if instant.time > latest:
                break
            if len(instant.events) == 1 and not instant.turned:
                for place, approach, speed in laws.faint(instant, made):
                    if place < len(run.events[instant.events[0]].impulses):  # one contact may be of several faces
                        found[instant.events[0], place] = approach, speed
            made += len(instant.events)
    return found


def _without(run: Trajectory, faint: Collection[tuple[int, int]]) -> Trajectory:
    """A run as if some of its impulses were not reported."""
    kept: list[Event] = []
    for event in run.events:
        pushed = tuple(pair for place, pair in enumerate(event.impulses) if (event.index, place) not in faint)
        if pushed:
            pairs = {*pushed}
            contacts = tuple(pair for pair in event.contacts if pair in pairs)
            kept.append(Event(len(kept), event.time, contacts, pushed, event.ties, event.coupled and len(pairs) > 1))
    motion = run.motion
    return replace(run, events=tuple(kept), motion=motion if len(kept) == len(run.events) else _states_alone(motion))


def _states_alone(motion: Any) -> Any:
    """The motion of a run whose events are numbered anew: flights without the events that each is of."""
    return DoubleMotion(motion.knots, motion.end) if isinstance(motion, EventMotion) else motion


# -- ties


def tie(lab: Laboratory, rows: Sequence[Experiment]) -> list[Experiment]:
    """Contacts of one exact instant, where what chose between them is shown by runs of the exact law.

    Of the scene as the engine is given it; and for one instant from the engine's own state before it.
    """
    for row in rows:
        if row.suffices and row.cause in (CauseName["STEP"], CauseName["ITERATIONS"]):
            what = "at a finer step" if row.cause is CauseName["STEP"] else "with more iterations"
            return [Experiment(CauseName["TIE"], f"{what} it resolves the instant as the policy does", None, False)]
    if shared := _one_end(lab):
        return [shared]
    together = _together(lab)
    touches = lab.margin is not None and ball.sign_of(lab.margin) == 0
    if len(together) < 2 and not touches:
        return [Experiment(CauseName["TIE"], "no contacts of one exact instant are in question", None, False)]
    if lab.engine.step is not None:
        if len(together) > 1:
            return [_resolved_otherwise(lab, together)]
        told = "no order is in question: in the exact motion the two touch, so that any error decides"
        return [Experiment(CauseName["TIE"], told, None, False)]
    return _by_runs(lab, together)


def _one_end(lab: Laboratory) -> Experiment | None:
    """A row where the exact run meets an end that two things have in common, and the engine names the other of them.

    Such an end is one thing, named by the first; by which name a history has it changes no flight. Shown by the run
    with the names changed: up to there nothing else differs.
    """
    parted, run, ids = lab.divergence, lab.candidate.trajectory, lab.study.scene.ids
    event, body, mine, theirs = parted.candidate_event, parted.body, parted.expected, parted.got
    if mine is None or theirs is None or mine not in ids or theirs not in ids:
        return None
    if event is None or parted.expected_event >= len(lab.reference.events):
        return None
    parts = parts_of(lab.study.scene)
    one, other = (parts.get(ids.index(name)) for name in (mine, theirs))
    if one is None or other is None or not _met(lab, ids.index(body), {*one.ends} & {*other.ends}):
        return None
    renamed: list[Event] = []
    for each in run.events:
        if each.index == event:
            lists = [tuple(dict.fromkeys(_named_as(pair, body, theirs, mine) for pair in pairs))
                     for pairs in (each.contacts, each.impulses)]  # fmt: skip
            each = replace(each, contacts=lists[0], impulses=lists[1])
        renamed.append(each)
    again = replace(run, events=tuple(renamed))
    found = align(lab.reference, again, span=lab.study.span, bits=lab.engine.bits).divergence
    if found is not None and found.expected_event <= parted.expected_event:
        return None
    rest = "nothing differs" if found is None else "nothing differs up to there"
    told = f"{mine} and {theirs} share the point that {body} meets: one end, which {lab.name} names by {theirs}"
    return Experiment(CauseName["TIE"], f"{told}; with the other name {rest}", None, True)


def _named_as(pair: Contact, body: str, before: str, now: str) -> Contact:
    """A contact of a body, with its partner's name changed if it is that one."""
    return type(pair)(*(now if name == before else name for name in pair)) if body in pair else pair


def _met(lab: Laboratory, body: int, ends: Collection[int]) -> bool:
    """Whether a circle meets one of some ends at the reference's event in question: as its log has it."""
    motion, event = lab.reference.motion, lab.reference.events[lab.divergence.expected_event]
    if not ends or not isinstance(motion, ExactMotion) or not isinstance(event.time, ExactValue):
        return False
    step = motion.log.steps[event.time.upto - 1]
    return isinstance(step, Kick) and any(is_pair(link) and link.a == body and link.b in ends for link in step.among)


def _by_runs(lab: Laboratory, together: Sequence[Contact]) -> list[Experiment]:
    """What chose, for an engine of events."""
    name, cause = lab.name, CauseName["TIE"]
    if given_does(lab):
        told = f"the exact law on the scene in {lab.numbers} has the contacts that {name} has; arithmetic adds nothing"
        return [Experiment(CauseName["INPUT"], told, None, True)]
    before = OwnState.of(lab)
    own = f"from {name}'s own state before the instant, the exact law"
    does = None if before is None else before.leads_to_the_same(lab, str(lab.study.scene.tie_policy))
    if before is None or does is None:
        why = "walls carry circles of it" if lab.carried else "rounding has made circles overlap"
        if len(together) > 1 and "tie_policy" not in lab.engine.scene_keys:
            return [_resolved_otherwise(lab, together)]
        return [Experiment(cause, f"{own} cannot be run: {why}")]
    if does:
        lab.chosen_before = True
        return [Experiment(cause, f"{own} has the contacts that {name} has: rounding before it chose", None, False)]
    laws = lab.candidate.laws
    if len(before.times) > 1 and laws is not None and laws.kept:
        told = f"{own} has other contacts; {name} computes times that differ: rounding of contact times chose"
        return [Experiment(CauseName["FLIGHTS"], told, None, True)]
    for policy in ("simultaneous", "sequential", *(f"sequential:seed={seed}" for seed in range(ORDERS))):
        if before.leads_to_the_same(lab, policy):
            return [Experiment(cause, f"{own} does as {name} does under another policy, {policy}", None, True)]
    if len(together) > 1 and "tie_policy" not in lab.engine.scene_keys:
        return [_resolved_otherwise(lab, together)]
    if laws is not None and laws.kept:
        told = f"{own} has other contacts, while each impulse keeps the law: rounding from there on chose"
        return [Experiment(CauseName["ARITHMETIC"], told, None, True)]
    return [Experiment(cause, f"{own} has other contacts, under every policy that was tried")]


def _resolved_otherwise(lab: Laboratory, together: Sequence[Contact]) -> Experiment:
    policy = lab.study.scene.tie_policy
    own = "" if "tie_policy" in lab.engine.scene_keys else f"; {lab.name} does not follow the tie policy {policy}"
    told = f"{len(together)} contacts fall on exactly one instant, the order of their impulses matters"
    return Experiment(CauseName["TIE"], f"{told}, and {lab.name} has another{own}", None, True)


def _together(lab: Laboratory) -> list[Contact]:
    """The contacts of one exact instant that are in question; none, or one, where there are not several."""
    divergence, events = lab.divergence, lab.reference.events
    if lab.decision is not None and lab.decision.second is not None:
        names = {lab.decision.first.partner, lab.decision.second.partner}
    else:
        names = {*divergence.partners} & {*lab.study.scene.ids}
    here = events[divergence.expected_event] if divergence.expected_event < len(events) else None
    cluster = _cluster(lab, [] if here is None or not here.coupled else here.contacts)
    among = {name for pair in cluster for name in pair}
    return cluster if len(cluster) > 1 and names and names <= among else []


def _cluster(lab: Laboratory, contacts: Sequence[Contact]) -> list[Contact]:
    """Those contacts of an instant that hang together with the body in question through circles that can move."""
    movable = lab.candidate.alignment.walks
    names, found = {lab.divergence.body}, [pair for pair in contacts if lab.divergence.body in pair]
    while True:
        names |= {name for pair in found for name in pair if name in movable}
        more = [pair for pair in contacts if names & {*pair}]
        if len(more) == len(found):
            return found
        found = more


@dataclass(frozen=True)
class OwnState:
    """An engine's own state just before the instant in question.

    Attributes:
        scene: the circles that take part, the fixed ones and the walls, as the engine has them at time `last`.
        last: a time after which none of those that take part meets anything before the instant.
        end: the end of the instant.
        late: by how much the exact law may be later.
        partners: whom each meets from then on, in the engine's run.
        left: how the engine leaves each: vx, vy; under gravity less what it has brought since `last`.
        times: of the engine's contacts from then on.
    """

    scene: Scene
    last: float
    end: float
    late: float
    partners: Mapping[str, Sequence[str]]
    left: Mapping[str, tuple[float, float]]
    times: frozenset[float]

    @staticmethod
    def of(lab: Laboratory) -> OwnState | None:
        """That of a candidate; None where rounding has made circles overlap, so that there is no such scene, and where
        a wall has carried one of them."""
        parted, walks, scene = lab.divergence, lab.candidate.alignment.walks, lab.given or lab.study.scene
        names = {*parted.partners, parted.body} & {*walks}
        names |= {name for pair in _cluster(lab, _near_contacts(lab)) for name in pair if name in walks}
        if names & lab.carried:
            return None
        flights: dict[str, OwnFlight] = {}
        known: dict[str, int] = {}
        for name in names:
            # some of that event may be matched
            pairs = [pair for pair in walks[name].pairs if pair[1] != parted.candidate_event]
            before = [pair for pair in pairs if pair[0] < parted.expected_event]
            flight = lab.own.flight(name, max((m for m, _ in before), default=None), turned=False)
            if flight is None:
                return None
            flights[name], known[name] = flight, max((c for _, c in before), default=-1)
        last = max((float(real(flight.t)) for flight in flights.values()), default=0.0)
        end = max(lab.last_time, last)
        late = max(LATER, LATER_UNITS * 2.0**-lab.bits) * max(end, lab.scale)
        end += LATER * max(end, lab.scale)
        circles: list[Circle] = []
        for circle in scene.circles:
            if circle.fixed:
                circles.append(circle)
            elif str(circle.id) in names:
                own = flights[str(circle.id)]
                t, x, y, vx, vy = map(_exact, (own.t, own.x, own.y, own.vx, own.vy))
                lag, (gx, gy) = Quantity.of(Fraction(last)) - t, scene.gravity or (ZERO, ZERO)
                place = x + (vx + gx * lag / 2) * lag, y + (vy + gy * lag / 2) * lag
                speed = vx + gx * lag, vy + gy * lag
                circles.append(Circle(*place, circle.r, *speed, m=circle.m, id=circle.id, point=circle.point))
        try:
            here = scene.with_changes(
                circles=circles, **_moved(scene, Quantity.of(Fraction(last))),
                until=None, events=None, reverse_at=None, reverse_after=None,
            )  # fmt: skip
        except SceneError:
            return None
        told = history(lab.candidate.trajectory)
        past = {
            name: [m for m in told.meetings[name] if m.event > known[name] and told.times[m.event] <= end]
            for name in names
        }
        run = lab.candidate.trajectory
        left = {name: run.after(met[-1].event) for name, met in past.items() if met}
        velocities = {
            name: _at_last(scene, float(state[name].vx), float(state[name].vy), float(state.time) - last)
            for name, state in left.items()
        }
        return OwnState(
            here, last, end, late, {name: [p for m in met for p in m.partners] for name, met in past.items()},
            velocities,
            frozenset(told.times[m.event] for met in past.values() for m in met),
        )  # fmt: skip

    def leads_to_the_same(self, lab: Laboratory, policy: str) -> bool | None:
        """Whether the exact law from here, under a policy, has the engine's contacts and leaves the circles as it does.

        Returns:
            None where there is no exact run.
        """
        try:
            scene = self.scene.with_changes(tie_policy=policy)
            exact = lab.run_some(scene, self.end + self.late - self.last, MOST_INSTANTS)
        except SceneError:
            return None
        there = history(exact)
        done = -1  # the event with which it has all of the engine's contacts
        for name, partners in self.partners.items():
            met = [(p, m.event) for m in there.meetings[name] for p in m.partners]
            if [p for p, _ in met[: len(partners)]] != [*partners]:
                return False
            done = max(done, max((event for _, event in met[: len(partners)]), default=-1))
        for name, partners in self.partners.items():
            more = [m.event for m in there.meetings[name] for _ in m.partners][len(partners) :]
            if any(event <= done or self.last + there.times[event] <= self.end - self.late for event in more):
                return False
        speed = max((math.hypot(*velocity) for velocity in self.left.values()), default=0.0)
        room = max(ALIKE, ALIKE_UNITS * 2.0**-lab.bits) * speed
        final = exact.after(done) if done >= 0 else exact.at(0)
        now = {
            name: _at_last(self.scene, float(final[name].vx), float(final[name].vy), float(final.time))
            for name in self.left
        }
        return all(math.dist(now[name], velocity) <= room for name, velocity in self.left.items())


def _at_last(scene: Scene, vx: float, vy: float, since: float) -> tuple[float, float]:
    """A velocity less what gravity has brought in a time."""
    gx, gy = map(float, scene.gravity or (0, 0))
    return vx - gx * since, vy - gy * since


def _moved(scene: Scene, time: Quantity) -> dict[str, list[Any]]:
    """Walls, segments and polygons where they are at a time, by the key of a scene."""

    def line(thing: Wall | Segment) -> Any:
        if not thing.moves:
            return thing
        sx, sy = thing.vx * time, thing.vy * time
        more = {"r": thing.r} if isinstance(thing, Segment) else {}
        ends = thing.x0 + sx, thing.y0 + sy, thing.x1 + sx, thing.y1 + sy
        return type(thing)(*ends, id=thing.id, vx=thing.vx, vy=thing.vy, **more)

    def solid(thing: Polygon) -> Polygon:
        points = [(x + thing.vx * time, y + thing.vy * time) for x, y in thing.points]
        return Polygon(points, id=thing.id, r=thing.r, vx=thing.vx, vy=thing.vy) if thing.moves else thing

    found = {"walls": list(map(line, scene.walls)), "segments": list(map(line, scene.segments))}
    return {**found, "polygons": list(map(solid, scene.polygons))}


def _near_contacts(lab: Laboratory) -> Sequence[Contact]:
    events = lab.reference.events
    event = lab.divergence.expected_event
    return events[event].contacts if event < len(events) else ()


def _exact(value: Any) -> Quantity:
    """A number of a run, exactly where it is short; else to so many digits that only a tie would tell."""
    known = short_quantity(value)
    return known if known is not None else Quantity.of(Fraction(real(value).digits(DIGITS)))


# -- shares


def shares(lab: Laboratory, rows: Sequence[Experiment]) -> list[Experiment]:
    """The account of the displacement: what rounding the input, and each kind of error of the engine's own, add."""
    shown = (
        CauseName["PHANTOM"],
        CauseName["PARTING"],
        CauseName["INPUT"],
        CauseName["ARITHMETIC"],
        CauseName["FLIGHTS"],
    )
    if any(row.suffices and row.cause in shown for row in rows):
        return []
    if lab.engine.bits is None and lab.engine.step is None:
        return [Experiment(CauseName["ARITHMETIC"], "its numbers are exact", 0.0, False)]
    if lab.decision is None or lab.margin is None:
        if lab.carried:
            return _by_runs_alone(lab, "a wall has carried one of those that meet")
        return [Experiment(CauseName["ARITHMETIC"], "not determined: no contact can be named")]
    account = accounted(lab)
    if isinstance(account, str) and lab.carried:
        return _by_runs_alone(lab, account)
    if isinstance(account, str):
        chose = "; rounding before the instant chose" if lab.chosen_before else ""
        told = f"its share is not determined: {account}{chose}"
        return [*_input_by_run(lab), Experiment(CauseName["ARITHMETIC"], told, None, lab.chosen_before or None)]
    if any(row.suffices and row.cause is CauseName["ITERATIONS"] for row in rows):
        named = {CauseName["SOLVER"]: CauseName["ITERATIONS"]}
        parts = tuple(replace(part, cause=named.get(part.cause, part.cause)) for part in account.contributions)
        account = replace(account, contributions=parts)
    lab.account = account
    return _rows(lab, account)


def _by_runs_alone(lab: Laboratory, why: str) -> list[Experiment]:
    """Input rounding by a run; the engine's own, where each step keeps the law and the input's does not suffice.

    Args:
        why: there is no account of a displacement.
    """
    cause, laws = CauseName["ARITHMETIC"], lab.candidate.laws
    (given,) = _input_by_run(lab)
    if given.suffices is None and given_keeps(lab):
        told = f"the exact law on the scene in {lab.numbers} has the contacts of the exact run up to there"
        given = Experiment(given.cause, told, None, False)
    if given.suffices is False and laws is not None and laws.kept:
        told = f"each step of {lab.name} keeps the law, and input rounding by itself changes nothing"
        told = f"{told}, so its own rounding does; no displacement is known: {why}"
        return [given, Experiment(cause, told, None, True)]
    return [given, Experiment(cause, f"its share is not determined: {why}")]


def _rows(lab: Laboratory, account: Account) -> list[Experiment]:
    assert lab.margin is not None
    found: list[Experiment] = []
    total: float = account.displacement
    itself = None
    if lab.engine.step is None and lab.got is not None and not lab.changes(lab.got):
        itself = _rounded_away(lab)
        if itself is None:
            told = f"{lab.name}'s own flights decide as the exact ones do, by more than rounding"
            return [Experiment(CauseName["ARITHMETIC"], f"not determined: {told}", suffices=False)]
        total += itself
    elif lab.got is not None and not lab.changes(lab.got) and abs(float(lab.got.mid())) > 0 and not lab.comes_late:
        itself = -float(lab.got.mid())
        total += itself
    if itself is not None and total == 0.0:
        told = f"{lab.name}'s own flights decide as the exact ones do, by {abs(itself):.3g}, and its answer differs"
        return [Experiment(CauseName["UNKNOWN"], f"the exact margin is 0, so that any error decides; {told}")]
    lab.displacement = total
    order = [*CauseName]
    parts = sorted(account.contributions, key=lambda part: order.index(part.cause))
    if lab.engine.step is None and not _audited(lab):
        parts = [part for part in parts if part.cause is CauseName["INPUT"]] + [
            replace(account.own, cause=CauseName["OWN"])
        ]
    if sum(part.cause is not CauseName["INPUT"] and part.size != 0.0 for part in parts) > 1:
        parts.append(account.own)
    for part in parts:
        flips, earlier, free, does = _alone(lab, part, account.along), None, "", False
        if part.cause is CauseName["INPUT"] and lab.engine.step is None and part.size:
            tied = part.alone is not None and part.alone.contains(0)  # the two contacts become simultaneous
            if lab.given is None and (tied if flips is False else flips and _by_its_contacts_alone(lab)):
                does_it = "changes" if flips else "does not change"
                free = (
                    f"it {does_it} the decision alone; in {lab.numbers} the circles overlap, so that no run can say so"
                )
                flips = None
            elif flips and _by_its_contacts_alone(lab):
                if not given_does(lab):
                    flips, free = False, "it changes the decision alone; run freely, it does not"
            elif flips is False and (tied or _by_its_contacts_alone(lab)) and given_does(lab):
                flips = does = True  # by other parts of the same things, too
            if flips is None and not free:
                flips = does = given_does(lab) or None
            earlier = None if flips else _left_before(lab)
        alone = {True: "alone it changes the decision", False: "alone it does not", None: "not run alone"}[flips]
        if part.late is not False and lab.decision is not None and lab.decision.rival is not None:
            first = f"{lab.decision.rival.body} meets {lab.decision.rival.partner} first"
            alone = f"{alone}: {first}" if part.late else f"alone it may change the decision or not, if {first}"
        if does:
            alone = f"run freely, the exact law on it decides as {lab.name} does"
        if free:
            alone = f"with the exact run's contacts {free}"
        told = f"{_what(lab, part.cause)} adds {part.size:.3g} to the margin; {alone}"
        if earlier is not None:
            told = f"{told}; run freely, the exact law on it differs at event {earlier} already"
            rest = [] if abs(part.size) > abs(total) / 2 else [other for other in parts if other is not part]
            flips = None if any(_alone(lab, other, account.along) is None for other in rest) else True
        if part is account.own:
            whole = "both" if lab.engine.step is None else "all"
            if itself is not None and lab.engine.step is not None:
                told = (
                    f"{_what(lab, part.cause)} adds {part.size + itself:.3g} to the margin, {itself:.3g} of it in its"
                )
                told, flips = f"{told} answer alone; that changes the decision", True
            found.append(Experiment(part.cause, f"{whole} together: {told}", None, flips))
            continue
        if part.cause is CauseName["OWN"]:
            laws = lab.candidate.laws
            why = "" if laws is None else f": {laws.reason}"
            adds = f"{_what(lab, part.cause)} adds {part.size:.3g} to the margin"
            flips, told = None, f"{adds}; whether that is rounding or another law is not determined{why}"
        if account.lumped and part.cause is account.own.cause:
            told += f"; its kinds cannot be distinguished: {account.lumped}"
        found.append(Experiment(part.cause, told, part.size, flips, part.size / total if total else None))
    if not lab.input_rounded and lab.engine.rounds_input:
        told = f"the scene is exact in {lab.numbers}, so no input was rounded"
        found.insert(0, Experiment(CauseName["INPUT"], told, 0.0, False))
    if itself is not None:
        told = f"{lab.name}'s own flights decide as the exact ones do, by {abs(itself):.3g}; its answer differs"
        cause = CauseName["DECISION"]
        if lab.engine.step is not None:  # of two meetings within one step it has both at the end of it
            cause = CauseName["LATENESS" if lab.decision is not None and lab.decision.kind == "order" else "STEPS"]
            meet = lab.decision is not None and answer(lab.decision, lab.got) == -1
            told += ", and it looks at the ends of steps only" if meet or cause is CauseName["LATENESS"] else ""
        size = itself + sum(row.displacement or 0.0 for row in found if row.cause is cause)
        found = [row for row in found if row.cause is not cause or row.share is None]
        little = abs(total - size) <= abs(size) / 100  # it is what the others leave to zero
        nearly = True if little and cause is not CauseName["STEPS"] else None
        found.append(Experiment(cause, told, size, nearly, size / total if total else None))
    return found


def _alone(lab: Laboratory, part: Contribution, grown: bool) -> bool | None:
    """Whether a kind alone changes the decision as the engine has it; None where no run says so.

    A hit that comes after what the other run has instead is as good as a miss. With `grown`, contributions are
    integrals along the way, and no differences of runs.
    """
    assert lab.decision is not None and lab.margin is not None
    if lab.comes_late and lab.engine.step is not None:  # it is sooner by all of them together, as its run shows
        return True if part.cause is CauseName["STEPS"] else None
    rival, hit = lab.decision.rival is not None, answer(lab.decision, lab.margin) == -1
    if part.alone is None:
        small = abs(part.size) <= ALONE * abs(float(lab.margin.mid())) and not (rival and hit and part.size > 0)
        return False if small and not grown else None
    if rival and answer(lab.decision, part.alone) == -1 and part.late is not False:
        return None if part.late is None else lab.as_engine(arb(1))
    return lab.as_engine(part.alone)


def _by_its_contacts_alone(lab: Laboratory) -> bool:
    """Whether a run that has the exact run's contacts may have others when it is free.

    Off an instant, several contacts that hang together are not what they are on it; and what hits a face of a thing may
    hit its end, or another face, when it comes there a little aside.
    """
    before = lab.reference.events[: lab.divergence.expected_event]
    return lab.study.scene.surfaces is not lab.study.scene or any(event.coupled for event in before)


def _audited(lab: Laboratory) -> bool:
    """Whether every step up to the divergence is known to keep the law, so that what it misses is rounding."""
    laws = lab.candidate.laws
    return laws is not None and laws.kept is not None  # of one that breaks it before, nothing but that is said


def _rounded_away(lab: Laboratory) -> float | None:
    """What rounding of the decision itself has to come to, at least; None where it is more than rounding."""
    laws = lab.candidate.laws
    if lab.got is None or laws is None or laws.kept is not True:
        return None
    size = -float(lab.got.mid())
    return size if abs(size) <= min(REORDERED * 2.0**-lab.bits, MOST_ROUNDED) * max(lab.scale, lab.last_time) else None


def _what(lab: Laboratory, cause: CauseName) -> str:
    """The subject of a sentence about one kind of error."""
    return {
        "INPUT": f"rounding the scene to {lab.numbers}",
        "FLIGHTS": f"rounding in {lab.name}'s flights and contact times",
        "IMPACTS": f"rounding in {lab.name}'s impulses",
        "ARITHMETIC": f"{lab.name}'s own rounding",
        "OWN": f"what {lab.name}'s own steps miss",
        "INTEGRATOR": f"the way in which {lab.name} falls by steps",
        "THRESHOLD": f"what bounces below the speed at which {lab.name} lets anything bounce lack",
        "LATENESS": "an impulse after the contact, at the end of a step,",
        "OVERLAP": "a line of centres that overlap has turned",
        "STEPS": f"what {lab.name}'s steps miss",
        "SOLVER": f"what {lab.name}'s impulses are off the law by, more than rounding,",
        "ITERATIONS": f"what the iterations of {lab.name}'s solver leave of its impulses",
        "SEVERAL": "what it leaves of the impulses at several contacts",
        "MERGED": "an instant taken in several steps, or several in one,",
        "CORRECTION": "a change of flight without a contact",
    }[cause.name]


def _input_by_run(lab: Laboratory) -> list[Experiment]:
    """Input rounding by a run of the exact law on the scene in the engine's numbers, without a displacement."""
    cause = CauseName["INPUT"]
    if not lab.engine.rounds_input:
        return [Experiment(cause, "no input is rounded", 0.0, False)]
    if lab.given is None:
        return [Experiment(cause, f"not determined: in {lab.numbers} the circles overlap, so there is no exact run")]
    if lab.given.digest == lab.study.scene.digest:
        return [Experiment(cause, f"the scene is exact in {lab.numbers}, so no input was rounded", 0.0, False)]
    if lab.engine.step is None and given_does(lab):
        told = f"the exact law on the scene in {lab.numbers} decides as {lab.name} does"
        return [Experiment(cause, told, None, True)]
    earlier = _left_before(lab)
    if earlier is not None:
        told = f"the exact law on the scene in {lab.numbers} differs from the reference at event {earlier} already"
        return [Experiment(cause, f"{told}; its share of this one is not determined")]
    return [Experiment(cause, "its share is not determined")]


def _left_before(lab: Laboratory) -> int | None:
    """The event at which the exact run of the scene as the engine is given it lacks what leads to the decision."""
    if lab.given is None or lab.given.digest == lab.study.scene.digest or not lab.pairings:
        return None
    found = align(lab.reference, lab.given_run, span=lab.span, instants=False)
    reader = RunReader(lab.given_run, found.walks)
    if found.divergence is None or all(reader.follows(pairing) for pairing in lab.pairings):
        return None
    return found.divergence.event
