"""The exact law, continued from any state of an engine's run to the decision at which the histories part.

The sequence of contacts that leads to the decision is the reference's, which the engine has too. Carried out by the
exact law from a state, it gives the number that decides as a function of that state: no decision is asked again. Each
contact of the engine's run adds *defects*: by what its own numbers differ from what the exact law makes of its own
numbers before. With all defects added, the continuation is the engine's run itself; with some kinds of them, in some of
the contacts, it is what these alone come to.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, cast

from flint import arb

from ...exact.exact_motion import motion_of, steps_through
from ...exact.laws.formulas import wall_approach
from ...exact.numbers import ball
from ...exact.replay.contact import Flight, Round, Touch, can_push, is_flat
from ...exact.replay.state import Flip, Go, Kick, ReplayState, Step, step_units
from ...floating.knots import NEXT_TO, SteppedFall
from ...scenarios.lazy import kept
from ..audit.transcript import Fall, ReportedInstant, Transcript
from ..audit.transcript import ReportedFlight as OwnRow
from .decision import CarriedReader, DecidingNumber, Pairing, RunReader
from .free_flights import (
    Row,
    Rows,
    added,
    bounce,
    fall_of_contact,
    fallen,
    falls_on,
    flown,
    last_step,
    less,
    plus,
    risen,
    row_of,
)
from .given_scene import RoundedState

if TYPE_CHECKING:
    from ...scenarios.scene import Scene
    from ...scenarios.trajectory import Trajectory
    from ..alignment.walk import Walk

BITS, BITS_AN_EVENT = 320, 2
"""Bits of a continuation: balls lose about one an event; what is left over tells contributions of 2**-100."""

MOST_UNITS = 60_000_000
"""Work that one continuation may take, about a minute; beyond it there is none."""


class NoContinuation(Exception):
    """The engine's run cannot be continued by the exact law; the message says why."""


@dataclass(frozen=True)
class Link:
    """What one component of an instant does, or the reversal: steps of the reference's log, and who takes part.

    Attributes:
        event: of the reference.
        bodies: the circles that can move, by place.
        pushed: those that get an impulse; at the reversal, all.
        steps: of the log.
        single: the contact, where it is one impulse through one.
    """

    event: int
    bodies: tuple[int, ...]
    pushed: tuple[int, ...]
    steps: tuple[Step, ...]
    single: Touch | None

    @kept
    def turns(self) -> bool:
        """Whether it is the reversal."""
        return isinstance(self.steps[-1], Flip)


@dataclass
class Stretch:
    """Contacts that the two runs have in common and that hang together, most often one, or a change without contact.

    Attributes:
        event: the reference's last event in it; of changes without contact, of the body's contact before, or -1.
        bodies: the circles by place; those whose flight changes.
        beside: others whose flights the exact law asks for.
        links: what the exact law does; none where the engine changes a flight without a contact.
        before, after: the engine's own flights.
        own: the engine's own events that it holds.
        at_once: whether the engine has it at one moment.
        changes: how many changes without contact it holds.
        defects: by kind, and by circle, what is added to (t, x, y, vx, vy).
    """

    event: int
    bodies: tuple[int, ...]
    beside: tuple[int, ...]
    links: tuple[Link, ...]
    before: Rows
    after: Rows
    own: frozenset[int] = frozenset()
    at_once: bool = True
    changes: int = 0
    defects: dict[str, Rows] = field(default_factory=dict[str, Rows])
    _sums: dict[tuple[str, ...], Rows] = field(default_factory=dict[tuple[str, ...], Rows])

    def of(self, kinds: tuple[str, ...]) -> Rows:
        """The defects of some kinds together, of the circles that have any."""
        if kinds not in self._sums:
            found = self._sums[kinds] = Rows()
            for kind in kinds:
                for k, row in self.defects.get(kind, {}).items():
                    if not all(number.is_zero() for number in row):
                        found[k] = plus(found[k], row, None) if k in found else row
        return self._sums[kinds]


FLIGHTS, LATENESS, OVERLAP, IMPACTS = "flights", "lateness", "overlap", "impacts"
"""Kinds of defects: a place that is not where the flight leads; a time at which the gap is not zero; a line of centres
that overlap has turned; an impulse."""

SOLVER, SEVERAL, MERGED, CORRECTION = "solver", "several", "merged", "correction"
"""More: of an engine of steps, an impulse that is off by more than rounding; the impulses of several contacts of
one instant; an instant taken apart, or several taken as one; a flight that changes without a contact."""

INTEGRATOR, THRESHOLD = "integrator", "threshold"
"""More, under gravity: how far a flight by steps is off the fall that it stands for, and what a bounce lacks of the
last step's gain in speed; and of an engine that says below which speed nothing bounces, an impulse below it."""

KINDS = (FLIGHTS, INTEGRATOR, LATENESS, OVERLAP, IMPACTS, SOLVER, THRESHOLD, SEVERAL, MERGED, CORRECTION)

ROUNDED = 2.0**10
"""Units in the last place of its speeds by which an impulse may be off by rounding, times the places over the radii."""


class Continuation:
    """Continues an engine's run, by the exact law, to a decision.

    Args:
        reference: the exact run.
        own: reads the engine's run.
        walks: how its meetings were matched with the reference's.
        decision: what is asked.
        turned: number of the reference's events before its reversal, if that lies before the decision.
        bits: to which the engine rounds its scene; None: it does not.
        unit: of its numbers, where it takes steps, so that its impulses may be off by more than rounding.
        until: when the decision comes; what the engine changes in flight up to then leads to it.
        threshold: the normal speed below which the engine says that nothing bounces.
        step: that it takes, if it takes any.

    Attributes:
        stretches: what leads to the decision, in order.
        places: of circles and walls, by id.
        runs: how many continuations were made, each from its state to the decision.
        forestalled: whether in the last of them the hit in question comes after the meeting that the other run has
            instead; None where that is not known.

    Raises:
        NoContinuation: where there is none.
    """

    def __init__(
        self,
        reference: Trajectory,
        own: Trajectory,
        walks: Mapping[str, Walk],
        decision: DecidingNumber,
        turned: int | None,
        bits: int | None,
        unit: float | None = None,
        until: float = 0.0,
        threshold: float = 0.0,
        step: float = 0.0,
    ) -> None:
        motion = motion_of(reference)
        if motion is None:
            raise NoContinuation(f"{reference.engine} keeps no log")
        self.reference, self.own, self.walks, self.decision = reference, own, walks, decision
        self.scene: Scene = reference.scene.surfaces  # whose places the log has
        self._turned, self._unit, self._until, self._threshold = turned, unit, until, threshold
        self._step, self._back, self._log = step, 0.0, motion.log.steps
        self.places = {name: k for k, name in enumerate(self.scene.ids)}
        self._moving = [not circle.fixed for circle in self.scene.circles]
        self.runs = 0
        self.forestalled: bool | None = False
        rival = [] if decision.rival is None else [decision.rival]
        try:
            self._lead_to([*decision.pairings, *rival], bits)
        except NoContinuation:
            if not rival:
                raise
            self._lead_to(decision.pairings, bits)

    def _lead_to(self, pairings: Sequence[Pairing], bits: int | None) -> None:
        """Finds what leads to some pairings, in both runs."""
        self._pairings = pairings
        links = self._needed(pairings)
        self.bits = BITS + BITS_AN_EVENT * len(links)
        if len(links) * step_units(self.bits) > MOST_UNITS:
            raise NoContinuation(f"{len(links):,} contacts lead to it, too many to be carried out again")
        with ball.precision(self.bits):
            whole = self.reference.scene
            self._exact, self._given = RoundedState(whole, None), RoundedState(whole, bits)
            self.start = {k: row_of(body.flight) for k, body in self._exact.bodies.items()}
            self.entered = {k: row_of(body.flight) for k, body in self._given.bodies.items()}
            transcript = Transcript(self.own, encloses=True)
            self._fall = transcript.fall if transcript.fall is not None and transcript.fall.step else None
            self.first = {k: self._told(row) for k, row in enumerate(transcript.first())}
            self._find_stretches(links)

    def _find_stretches(self, links: Sequence[Link]) -> None:
        """What leads to the decision, with defects, at the places where an engine of steps applies its impulses.

        An engine may push before it moves, and tell it a step later. It may stop circles, move them, and then let them
        bounce, which is as if pushed in between. Of the three times the one is kept that fits the engine's places.
        """
        moving = tuple(k for k, moves in enumerate(self._moving) if moves)
        share = self._exact.share  # (1 + e) / 2
        between = self._step / (2.0 if share is None else 2.0 * float(share.mid()))
        tries: list[tuple[int, float, float, list[Stretch]]] = []
        for back in (0.0, self._step, between):
            self._back = back
            self.stretches = [Stretch(-1, moving, (), (), self.entered, self.first), *self._matched(links)]
            for stretch in self.stretches:
                self._find_defects(stretch)
            alone = [stretch.defects for stretch in self.stretches if LATENESS in stretch.defects]
            if not tries and not (self._step and any(CORRECTION in kinds for kinds in alone)):
                return
            rows = [[*kinds.get(CORRECTION, {}).values()] for kinds in alone]
            moved = sorted(math.hypot(*(float(n.mid()) for row in mine for n in row[1:3])) for mine in rows)
            tries.append((moved.count(0.0), moved[len(moved) // 2], back, self.stretches))
        exact, off, *_ = tries[0]
        better = [found for found in tries if 2 * found[0] > exact + len(alone) or found[1] < off / 64]
        *_, self._back, self.stretches = min(better or tries[:1], key=lambda found: (-found[0], found[1]))

    @cached_property
    def _known_to_be_first(self) -> bool:
        """Whether the exact flights, too, seem to come to the other run's meeting first, which they do not have.

        So it is with a thing that a circle leaves just then: what an error makes of that says nothing.
        """
        if self.decision.rival is None:
            return False
        truth = RunReader(self.reference, turned_after=self._turned)
        mine, theirs = (truth.hit_time(pairing) for pairing in (self.decision.first, self.decision.rival))
        return mine is not None and theirs is not None and ball.sign_of(theirs - mine) != 1

    # -- states

    def _told(self, flight: OwnRow, pushed: bool = False) -> Row:
        """A flight of the engine's own, in the frame that falls as the scene does; `pushed` before it was told."""
        t, x, y, vx, vy = flight[:5]
        if pushed:
            back, fall = arb(self._back), self._fall
            if fall is not None:
                step = arb(self._step)
                vx, vy, way = vx - fall.gx * step, vy - fall.gy * step, fall.ahead * step * back
                x, y = x - fall.gx * way, y - fall.gy * way
            t, x, y = t - back, x - vx * back, y - vy * back
        return fallen(self._given.falling, (t, x, y, vx, vy))

    # -- what leads to the decision

    def _needed(self, pairings: Sequence[Pairing]) -> list[Link]:
        """The contacts in the causal past of some pairings, in the reference's order."""
        limits: dict[int, int] = {}
        for pairing in pairings:
            for name in (pairing.body, pairing.partner):
                place, anchor = self.places.get(name), pairing.anchors.get(name)
                if place is not None and anchor is not None:
                    limits[place] = max(limits.get(place, -1), anchor)
        flips = self._flip()
        turned = flips is not None and self._turned is not None
        last = max(limits.values(), default=-1)
        if turned and flips is not None:
            last = max(last, flips.event)
        found: list[Link] = []
        for event in range(last, -1, -1):
            if turned and flips is not None and event == flips.event:
                found.append(flips)
            for link in reversed(self._links(event)):
                if any(limits.get(k, -1) >= event for k in link.pushed):
                    found.append(link)
                    limits.update({k: max(limits.get(k, -1), event) for k in link.bodies})
        if turned and flips is not None and flips.event < 0:
            found.append(flips)
        found.reverse()
        return found

    def _flip(self) -> Link | None:
        """The reversal, if the decision lies after it; its event is that before it."""
        reversal = self.reference.reversal
        if reversal is None:
            return None
        place = next(k for k, step in enumerate(self._log) if isinstance(step, Flip))
        bodies = tuple(k for k, moves in enumerate(self._moving) if moves)
        return Link(reversal.after - 1, bodies, bodies, tuple(self._log[place - 1 : place + 1]), None)

    def _links(self, event: int) -> list[Link]:
        """The components of an event: each a set of contacts that hang together."""
        events = self.reference.events
        begin = steps_through(events[event - 1]) if event else 0
        found: list[tuple[set[int], list[Step]]] = []
        for step in self._log[begin : steps_through(events[event])]:
            if isinstance(step, Go) and isinstance(step.source, tuple):
                found.append(({*step.bodies, *step.source.circles}, [step]))
            elif isinstance(step, Kick):
                circles = {k for link in step.links for k in link.circles}
                group = next((g for g in reversed(found) if g[0] & circles), None)
                if group is None:
                    found.append((circles, [step]))
                else:
                    group[0].update(circles)
                    group[1].append(step)
        links: list[Link] = []
        for _, steps in found:
            kicks = [step for step in steps if isinstance(step, Kick)]
            if kicks:
                source = steps[0].source if isinstance(steps[0], Go) else None
                pushed = {k for step in kicks for at in step.links for k in at.circles if self._moving[k]}
                asked = set(source.circles) if isinstance(source, tuple) and can_push(source) else set[int]()
                bodies = tuple(k for k in sorted(pushed | asked) if self._moving[k])
                single = kicks[0].links[0] if len(kicks) == 1 and len(kicks[0].links) == 1 else None
                mine = tuple(
                    Go(step.source, tuple(k for k in step.bodies if k in bodies)) if isinstance(step, Go) else step
                    for step in steps
                )
                links.append(Link(event, bodies, tuple(sorted(pushed)), mine, single))
        return links

    def _matched(self, links: Sequence[Link]) -> list[Stretch]:
        """The same in the engine's run: its own flights before and after each."""
        told = [*Transcript(self.own, encloses=True).instants()]
        by_event: dict[int, ReportedInstant] = {index: instant for instant in told for index in instant.events}
        turned = next((instant for instant in told if instant.turned), None)
        groups: list[tuple[list[Link], set[int]]] = []
        of: dict[int, set[int]] = {}
        for link in links:
            if link.turns and turned is None:
                raise NoContinuation("its run does not turn back")
            mine = set(turned.events) & of.keys() if link.turns and turned is not None else _own_events(self, link)
            known = {
                p for c in mine for p in of.get(c, ()) if any({*one.bodies} & {*link.bodies} for one in groups[p][0])
            }
            if len({frozenset(groups[p][1]) for p in known}) > 1:
                raise NoContinuation("it takes several instants as one, in another order")
            place = min(known, default=len(groups))
            if place == len(groups):
                groups.append(([], set()))
            for other in known - {place}:  # what it joins, of one event, is told as one
                groups[place][0].extend(groups[other][0])
                groups[other][0].clear()
            groups[place][0].append(link)
            groups[place][1].update(mine)
            for c in mine:
                of.setdefault(c, set()).add(place)
        groups = [group for group in groups if group[0]]
        return self._with_changes(groups, by_event, turned, told)

    def _with_changes(
        self,
        groups: Sequence[tuple[list[Link], set[int]]],
        by_event: Mapping[int, ReportedInstant],
        turned: ReportedInstant | None,
        told: Sequence[ReportedInstant],
    ) -> list[Stretch]:
        """Stretches, with the changes of flights that no contact explains between them."""
        order = {id(instant): n for n, instant in enumerate(told)}
        changes: dict[int, list[tuple[int, Row, Row]]] = {}
        for n, instant in enumerate(told):
            for k, after in instant.after.items():
                mine = changes.setdefault(k, [])
                pushed = self._back and any(k in pair for pair in instant.impulses)
                mine.append((n, mine[-1][2] if mine else self.first[k], self._told(after, bool(pushed))))
        done: dict[int, int] = {}
        left: dict[int, int] = {}
        found: list[Stretch] = []

        def drifted(k: int, upto: int) -> None:
            """What happens to a circle's flight without a contact, before an instant."""
            mine, begin = changes.get(k, []), done.get(k, 0)
            end = next((n for n in range(begin, len(mine)) if mine[n][0] >= upto), len(mine))
            if end > begin:
                rows = {k: mine[begin][1]}, {k: mine[end - 1][2]}
                found.append(Stretch(left.get(k, -1), (k,), (), (), *rows, changes=end - begin))
            done[k] = end

        for links, events in groups:
            instants = {order[id(by_event[c])] for c in events}
            if any(link.turns for link in links) and turned is not None:
                instants.add(order[id(turned)])
            bodies = tuple(sorted({k for link in links for k in link.pushed}))
            beside = tuple(sorted({k for link in links for k in link.bodies} - {*bodies}))
            first, last = min(instants), max(instants)
            before, after = Rows(), Rows()
            event = max(link.event for link in links)
            for k in (*bodies, *beside):
                drifted(k, first)
                mine, at = changes.get(k, []), done[k]
                before[k] = after[k] = mine[at - 1][2] if at else self.first[k]
                while k in bodies and at < len(mine) and mine[at][0] <= last:
                    after[k] = mine[at][2]
                    at += 1
                done[k] = at
            left.update(dict.fromkeys(bodies, event))
            found.append(Stretch(event, bodies, beside, tuple(links), before, after, frozenset(events), first == last))
        for k in {self.places[name] for pairing in self._pairings for name in pairing.anchors}:
            drifted(k, next((n for n, instant in enumerate(told) if instant.time >= self._until), len(told)))
            mine = changes.get(k, [])[: done[k]]
            found += self._flown_by_steps(k, left.get(k, -1), mine[-1][2] if mine else self.first[k])
        return found

    def _flown_by_steps(self, k: int, event: int, row: Row) -> list[Stretch]:
        """The last flight of a circle up to the decision, of an engine that goes under gravity by steps."""
        motion = self.own.motion
        if not isinstance(motion, SteppedFall) or not self._moving[k]:
            return []
        begin = float(row[0].mid())
        at = last_step(motion, _end_of_step(begin, motion.dt) if self._back else begin, self._until)
        if at is None:
            return []
        x, y, vx, vy = map(arb, motion.state(at)[k])
        told = fallen(self._given.falling, (arb(at), x, y, vx, vy))
        return [Stretch(event, (k,), (), (), {k: row}, {k: told}, changes=1)]

    # -- the exact law, and what the engine's run adds to it

    def _law(self, state: ReplayState[arb], stretch: Stretch, rows: Mapping[int, Row], *, here: bool = False) -> Rows:
        """What the exact law makes of some flights; `here`: at the places where they are, whatever the gap."""
        mine = {k: rows[k] for k in (*stretch.bodies, *stretch.beside)}
        for link in stretch.links:
            first = link.steps[0]
            if link.single is not None and (here or (isinstance(first, Go) and first.source == link.single)):
                mine.update(bounce(state, link.single, mine, here))
                continue
            _load(state, mine)
            for step in link.steps:
                state.steps_done += 1
                if isinstance(step, Go) and not here:
                    state.go(step.source, step.bodies)
                elif isinstance(step, Kick):
                    state.kick(step.links)
                elif isinstance(step, Flip):
                    for k in link.bodies:
                        x, y, vx, vy, t, *_ = state.bodies[k].flight
                        vx, vy = -vx, -vy
                        if state.falling is not None:  # v = V + g t turns to -v = W + g t
                            vx, vy = vx - 4 * state.falling.hx * t, vy - 4 * state.falling.hy * t
                        state.bodies[k].flight = Flight(x, y, vx, vy, t, t, None, state.steps_done)
            mine.update({k: row_of(state.bodies[k].flight) for k in link.pushed})
        return {k: mine[k] for k in stretch.bodies}

    def _find_defects(self, stretch: Stretch) -> None:
        """The engine's own numbers after a stretch, less what the exact law makes of its own numbers before."""
        state, before, after = self._given, stretch.before, stretch.after
        if not stretch.links:
            moved: Rows = {k: flown(before[k], after[k][0]) for k in stretch.bodies}
            if self._fall is not None:
                meant: Rows = {
                    k: _fallen_by_steps(before[k], after[k][0], self._fall, self._back) for k in stretch.bodies
                }
                stretch.defects[INTEGRATOR] = less(meant, moved)
                moved = meant
            left = less({k: after[k] for k in stretch.bodies}, moved)
            begins = stretch is self.stretches[0]
            stretch.defects[FLIGHTS if begins or self._is_rounding(stretch, left) else CORRECTION] = left
            return
        exact = self._law(state, stretch, before)
        link, *others = stretch.links
        by_steps = exact
        if self._fall is not None and stretch.at_once:
            now = after[stretch.bodies[0]][0]
            before = {k: _fallen_by_steps(row, now, self._fall, self._back) for k, row in before.items()}
            by_steps = self._law(state, stretch, before)
            stretch.defects[INTEGRATOR] = less(by_steps, exact)
        if others or link.turns or not stretch.at_once:
            stretch.defects[MERGED] = less({k: after[k] for k in stretch.bodies}, by_steps)
            return
        there: Rows = {k: (*after[k][:3], *before[k][3:]) for k in stretch.bodies}
        there.update({k: before[k] for k in stretch.beside})
        met = self._law(state, stretch, there)
        late: Rows = {k: (*after[k][:3], *met[k][3:]) for k in stretch.bodies}
        ago = arb(self._step - self._back if self._back else 0)  # since it took the line of centres
        paces = {k: self._risen(row)[3:] for k, row in there.items()}
        lined: Rows = {
            k: (t, x - paces[k][0] * ago, y - paces[k][1] * ago, vx, vy) for k, (t, x, y, vx, vy) in there.items()
        }
        at_once = self._law(state, stretch, lined, here=True)
        pushed: Rows = {k: (*after[k][:3], *at_once[k][3:]) for k in stretch.bodies}
        stretch.defects[CORRECTION if self._is_displaced(there, before) else FLIGHTS] = less(met, by_steps)
        if link.single is not None and is_flat(link.single):  # whose normal nothing turns: it falls for longer
            late = pushed
        stretch.defects[LATENESS] = less(late, met)
        stretch.defects[OVERLAP] = less(pushed, late)
        if self._fall is not None and link.single is not None and _is_fixed(state, link.single):
            gained = _bounced_before_gain(state, link.single, pushed, self._fall, self._back > 0.0)
            stretch.defects[INTEGRATOR] = added(stretch.defects[INTEGRATOR], less(gained, pushed))
            pushed = gained
        left = less({k: after[k] for k in stretch.bodies}, pushed)
        kind = IMPACTS if self._is_rounding(stretch, left) else SOLVER
        if kind is SOLVER and link.single is not None and self._is_slow(state, there, pushed):
            kind = THRESHOLD
        stretch.defects[kind if link.single else SEVERAL] = left

    def _is_displaced(self, there: Rows, before: Rows) -> bool:
        """Whether an engine of steps has put a circle elsewhere than its flight leads, by more than rounding."""
        if self._unit is None:
            return False
        for k, row in there.items():
            old, new = self._risen(flown(before[k], row[0])), self._risen(row)
            speed = math.hypot(float(old[3]), float(old[4]))
            far = math.hypot(float(old[1]), float(old[2])) + speed * abs(float(row[0]))
            if math.hypot(*(float((a - b).mid()) for a, b in zip(new[1:3], old[1:3], strict=True))) > (
                ROUNDED * self._unit * far
            ):
                return True
        return False

    def _is_slow(self, state: ReplayState[arb], there: Rows, pushed: Rows) -> bool:
        """Whether two meet more slowly than the engine says that anything bounces."""
        change = sum(
            math.hypot(*(float((new - old).mid()) for old, new in zip(there[k][3:], row[3:], strict=True)))
            for k, row in pushed.items()
        )
        return change < self._threshold * (2.0 if state.share is None else 2.0 * float(state.share.mid()))

    def _is_rounding(self, stretch: Stretch, left: Rows) -> bool:
        """Whether what a flight or a single impulse misses is rounding; of engines of events the audit tells that."""
        if self._unit is None:
            return not stretch.changes
        for k in stretch.bodies:
            rows = [self._risen(row) for row in (stretch.before[k], stretch.after[k])]
            speed = max(math.hypot(float(row[3]), float(row[4])) for row in rows)
            far = max(math.hypot(float(row[1]), float(row[2])) + speed * abs(float(row[0])) for row in rows)
            r = float(self._given.bodies[k].r)
            unit = ROUNDED * self._unit * max(1, stretch.changes)
            x, y, vx, vy = (float(number.mid()) for number in left[k][1:])
            if math.hypot(vx, vy) > unit * speed * (1 + (far / r if r else 0.0)):
                return False
            if stretch.changes and math.hypot(x, y) > unit * far:
                return False
        return True

    def _risen(self, row: Row) -> Row:
        """A row in true coordinates."""
        return risen(self._given.falling, row)

    # -- values

    def state_before(self, place: int) -> Rows:
        """The engine's own flights before a stretch; before the first, the scene as it is given."""
        rows = dict(self.entered)
        for stretch in self.stretches[:place]:
            rows.update(stretch.after)
        return rows

    def value(
        self, begin: int = 0, rows: Rows | None = None, kinds: Collection[str] = (),
        among: Collection[int] | None = None, *, exact: bool = False,
    ) -> arb | None:  # fmt: skip
        """The number that decides, continued from a state, with some defects of some stretches added.

        Args:
            begin: the stretch before which the state is.
            rows: the state; None: the scene as the engine is given it.
            kinds: of defects, which are added; `among`: in which stretches; None: in all.
            exact: whether radii, masses and walls are the scene's, not those that the engine is given.

        Returns:
            None where the sequence does not exist from that state: a contact is missed.
        """
        with ball.precision(self.bits):
            state = self._exact if exact else self._given
            first = (self.start if exact else self.entered) if rows is None else rows
            return self._carried(state, first, begin, among, {tuple(kinds): None})

    def value_at(self, input_share: arb, shares: Mapping[tuple[str, ...], arb]) -> arb | None:
        """The number that decides, where the input is rounded by a share of what it is, and defects are scaled.

        Args:
            shares: of each group of kinds of defects.
        """
        with ball.precision(self.bits):
            state = self._exact.towards(self._given, input_share)
            first = {k: row_of(body.flight) for k, body in state.bodies.items()}
            return self._carried(state, first, 0, None, shares)

    def _carried(
        self,
        state: RoundedState,
        first: Mapping[int, Row],
        begin: int,
        among: Collection[int] | None,
        added: Mapping[tuple[str, ...], arb | None],
    ) -> arb | None:
        """The number that decides; see `value`. `added`: groups of defects, each with its scale; None: as they are."""
        self.runs, self.forestalled = self.runs + 1, False
        flying, seen, turned = dict(first), dict[tuple[int, int], Row](), Rows()
        for place in range(begin, len(self.stretches)):
            stretch = self.stretches[place]
            if stretch.links:
                flying.update(self._law(state, stretch, flying))
            if among is None or place in among:
                for kinds, scale in added.items():
                    for k, defect in stretch.of(kinds).items():
                        own = flying[k] if stretch.links else flown(flying[k], stretch.after[k][0])
                        flying[k] = plus(own, defect, scale)
            for k in stretch.bodies:
                if not flying[k][1].is_finite():
                    return None
            if not place:
                first = dict(flying)
            for k in stretch.bodies if stretch.changes else ():
                if stretch.event < 0:
                    first = {**first, k: flying[k]}
                if (k, stretch.event) in seen:
                    seen[k, stretch.event] = flying[k]
                if k in turned:
                    turned[k] = flying[k]
            for link in stretch.links:
                for k in link.pushed:
                    seen[k, link.event] = flying[k]
                if link.turns:
                    turned.update({k: flying[k] for k in link.pushed})
        reader = CarriedReader(self.reference, state, first, seen, turned, self._turned)
        found = reader.value_once(self.decision, self.bits)
        hits = self.decision.rival is not None and found is not None and ball.sign_of(found) == -1
        self.forestalled = hits and (None if self._known_to_be_first else reader.comes_late(self.decision))
        return found


def _load(state: ReplayState[arb], rows: Mapping[int, Row]) -> None:
    """Sets some circles' flights. Which clock is taken for the later does not matter to what is computed."""
    bodies = state.bodies
    for k, (t, x, y, vx, vy) in rows.items():
        bodies[k].flight = Flight(x, y, vx, vy, t, t, None, 1)
    state.steps_done, state.instant, state.late, state.met = 2, state.zero, None, None


def _own_events(run: Continuation, link: Link) -> set[int]:
    """The engine's events that are matched with a component."""
    found: set[int] = set()
    for k in link.pushed:
        walked = run.walks.get(str(run.scene.ids[k]))
        mine = set[int]() if walked is None else {c for m, c in walked.pairs if m == link.event}
        if not mine:
            raise NoContinuation("it does not have every contact that leads to the decision")
        found |= mine
    return found


def _fallen_by_steps(row: Row, time: arb, fall: Fall, back: float) -> Row:
    """Where an engine of steps has a circle at a time: `Fall.fallen` against t**2/2 and t of the exact fall.

    A flight may begin `back` before the end of a step, at which a circle gains g dt.
    """
    (t, x, y, vx, vy), span, way, gain = flown(row, time), time - row[0], arb(0), arb(0)
    wait = _end_of_step(float(row[0].mid()), fall.step) - row[0]
    if 0.0 < back < fall.step and NEXT_TO * fall.step < float(wait) <= float(span) + NEXT_TO * fall.step:
        way, gain, span = fall.step * (fall.ahead * wait + span - wait), arb(fall.step), span - wait
    (more, gained), span = fall.fallen(span), time - row[0]
    way, gain = way + more - span * span / 2, gain + gained - span
    return t, x + fall.gx * way, y + fall.gy * way, vx + fall.gx * gain, vy + fall.gy * gain


def _end_of_step(time: float, step: float) -> float:
    """The end of the step in which a time is."""
    return math.ceil(time / step - NEXT_TO) * step


def _is_fixed(state: ReplayState[arb], link: Touch) -> bool:
    """Whether one of the two of a contact does not fall, so that what a step adds to speeds matters to it."""
    return is_flat(link) or falls_on(state, link)


def _bounced_before_gain(state: ReplayState[arb], link: Touch, pushed: Rows, fall: Fall, first: bool) -> Rows:
    """After a bounce whose restitution has multiplied the speed that was there before the last g dt.

    An engine that pushes `first` does so at speeds that have the next g dt.
    """
    [(k, row)] = pushed.items()
    t, x, y, vx, vy = row
    if is_flat(link):
        line = state.line(link.circle, link.wall)
        nx, ny, nn = line.nx, line.ny, line.nn
    else:
        nx, ny, *_ = fall_of_contact(state, cast("Round", link), row)
        nn = nx * nx + ny * ny
    restitution = arb(1) if state.share is None else 2 * state.share - 1
    share = restitution * fall.early - (1 + restitution if first else 0)
    more = share * fall.step * wall_approach(fall.gx, fall.gy, nx, ny) / nn
    return {k: (t, x, y, vx + more * nx, vy + more * ny)}
