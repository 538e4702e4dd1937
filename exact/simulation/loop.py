"""Predict, gather the next instant, resolve it, repeat: the event-driven loop, for every number system."""

from __future__ import annotations

import gc
import time as clock
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from math import inf
from threading import Lock
from types import TracebackType
from typing import Generic, NamedTuple, TypeAlias

from ...scenarios.engine import endable
from ...scenarios.errors import TimeIsUp
from ...scenarios.numbers.quantity import Quantity
from ...scenarios.scene import Scene
from ...scenarios.things import Squeeze
from ...scenarios.trajectory import OnProgress, Progress, Stop, StopReason
from ..numbers.system import BudgetSpent, N, Undecided
from ..question import Bend, Beside, Closing, Gap, Leans, Moment
from ..replay.contact import (
    AtArc,
    AtWall,
    Body,
    Link,
    Pair,
    Sides,
    Touch,
    can_push,
    contact_of,
    is_flat,
    is_pair,
    name_of,
    rims_at_start,
    touching_at_start,
)
from ..replay.landings import begins_at
from ..replay.state import Constant, Kick, Leave
from .arc_meetings import Joints
from .decider import Decider, History, K, Limits, Ordinary
from .endings import Carrier, Endings
from .instant import Gatherer, Instant, Resolved, Resolver
from .policies import Accumulating, Collapse, Outlasts, Policy, policy_for

# -- What a run leaves for one that goes on from it: its instants, and what it had counted by then.

Found: TypeAlias = Instant | Pair | AtWall | AtArc
"""What was gathered for one instant; of a contact alone, the contact."""


class Reached(NamedTuple):
    """How far a run was when it last began to look for an instant.

    Attributes:
        instants: how many it had carried out, besides that at time 0.
        plan: what it had counted.
        rises: how often its precision had risen.
        assumed: how many assumptions it had made.
    """

    instants: int
    plan: dict[str, int]
    rises: int
    assumed: int


_new = tuple.__new__
"""Makes a named tuple of all its fields: what its own constructor does, in a third of the time."""


@dataclass(repr=False, eq=False)
class Tape:
    """The instants of a run, in order, without that at time 0.

    Attributes:
        limits: where the run was to end.
        found: the instants.
        reached: how many of them are whole, with all that followed from them; None before the first look.
        rises: as the history has them.
        grazes: by the number of the instant at which the later of their flights begins: the pairs proved to graze.
    """

    limits: Limits
    found: list[Found] = field(default_factory=list)
    reached: Reached | None = None
    rises: list[tuple[int, bool]] = field(default_factory=list)
    grazes: dict[int, list[Link]] = field(default_factory=dict)

    def mark(self, history: History[K]) -> None:
        """Called before each look for an instant."""
        done = len(self.found)
        if self.reached is None or self.reached.instants != done:
            self.reached = _new(Reached, (done, dict(history.plan), len(history.rises), len(history.assumptions)))

    def add(self, instant: Instant, *, whole: bool) -> None:
        """An instant that was gathered; kept `whole`, or as its contact if that stands alone.

        Where strides may be taken a contact is what one carried out, so that it is carried out again like that.
        """
        link = instant.clock
        if not whole and can_push(link) and instant == Instant(instant.number, hits=(link,), clock=link):
            self.found.append(link)
        else:
            self.found.append(instant)

    def whole(self) -> list[Found]:
        """The instants up to where all that followed from them is known."""
        return [] if self.reached is None else self.found[: self.reached.instants]


def instant_of(found: Found, number: int) -> Instant:
    """An instant, from what a tape keeps of it and its number.

    >>> instant_of(Pair(0, 1), 2).hits
    (Pair(a=0, b=1),)
    """
    return found if isinstance(found, Instant) else Instant(number, hits=(found,), clock=found)


# -- Python's collector of cyclic garbage looks seldom while a run goes on, which makes tuples by the thousand, no
# cycles.
#
# It looks through what is new each time that 700 more objects have been made than freed, and through all that there
# is whenever a quarter has been added: among 1,000 discs, a tenth to a third of the exact engine's time. What keeps
# itself alive is found all the same, `SELDOM` objects later at most; all else goes when nobody holds it, as ever.

SELDOM = 100_000
"""Objects more made than freed, between two looks: some ten megabytes. An event makes about ten that last."""


class SeldomCollected:
    """While it is entered, by any number of runs in any number of threads, collections are seldom.

    A collector that is switched off, or that somebody has told to look still less often, stays as it is.

    >>> before = gc.get_threshold()
    >>> with SELDOM_COLLECTED:
    ...     gc.get_threshold()[0] >= SELDOM
    True
    >>> gc.get_threshold() == before
    True
    """

    def __init__(self) -> None:
        self._lock = Lock()
        self._entered = 0
        self._before = (0, 0, 0)

    def __enter__(self) -> None:
        with self._lock:
            self._entered += 1
            if self._entered == 1:
                self._before = gc.get_threshold()
                if 0 < self._before[0] < SELDOM:
                    gc.set_threshold(SELDOM, *self._before[1:])

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, traceback: TracebackType | None, /
    ) -> None:
        with self._lock:
            self._entered -= 1
            if not self._entered:
                gc.set_threshold(*self._before)


SELDOM_COLLECTED = SeldomCollected()
"""What every run enters."""


# -- Predict, gather the next instant, resolve it, repeat: the event-driven loop, written once for every number
# system.
#
# 1. Every pair's next meeting is predicted from the flights as they are, and put in a queue. 2. What falls on the
# next instant is gathered (`Gatherer`): what comes first, all that comes with it, and a limit. 3. The whole instant
# is resolved (`Resolver`), and only then noted. 4. The next meetings of the circles whose flights changed are
# predicted; on to 2.
#
# A run that has to stop within an instant, because a sign is not to be had or the user interrupts it, ends at the
# last whole one.

PROGRESS_EVERY = 0.2
"""Seconds between progress reports."""

EVENTS_A_LOOK = 64
"""Events between looks at the clock, at most."""


class Loop(Generic[N, K]):
    """The loop over one scene.

    Args:
        scene: what runs.
        decider: keeps its state in some numbers, and decides.
        limits: where it ends.
        progress: told now and then how far it is.
        policy: in place of the scene's own.

    A fixed circle flies on as it did when it is hit, so what is predicted of it holds; but in rounded numbers it is
    predicted anew, from where its clock then stands.

    Attributes:
        tape: what a run needs that goes on from this one.
        endings: looks for what ends a run under gravity, or with walls that move; None without.
    """

    def __init__(
        self,
        scene: Scene,
        decider: Decider[N, K],
        limits: Limits,
        progress: OnProgress | None,
        policy: Policy | None = None,
    ) -> None:
        self.scene = scene
        self.decider = decider
        self.limits = limits
        self.progress = progress
        self.history = decider.history
        self.resolver = Resolver(scene, decider, policy or policy_for(scene.tie_policy))
        self.gatherer = Gatherer(scene, decider, limits, self.resolver.touching)
        self.tape = Tape(limits)
        straight = scene.gravity is None and not scene.moving_walls
        self.endings = None if straight and scene.elastic else Endings(scene, not self.resolver.policy.chooses_order)
        self._loses = straight and not scene.elastic
        self._still = frozenset(i for i, c in enumerate(scene.circles) if c.fixed and decider.proves)
        self._ended: Stop | None = None
        self._pressed: dict[Link, bool] = {}
        falls = scene.gravity is not None
        self._joints = Joints(scene, decider.ask, decider.ask_cheaply) if falls and scene.ends else None
        self._instants = 0
        self._split = False
        self._next_report = clock.monotonic() + PROGRESS_EVERY

    def run(self) -> Stop:
        """Runs to the end and says why it ended."""
        taken_up = bool(self.history.knots)
        if not taken_up:
            self._first_knots()
        ended = self._run(taken_up)
        if isinstance(ended, Stop):
            return ended
        self.history.drop_unfinished()
        reason, told = ended
        return stopped(reason, len(self.history.records), told)

    def _run(self, taken_up: bool) -> Stop | tuple[StopReason, str]:
        """Runs to the end; where it is cut short, gives why. Alarms rise only below this."""
        try:
            with endable():
                if not taken_up:
                    standing = self._open()
                    if self._ended is None:
                        self._predict(list(self.decider.bodies.values()), standing)
                while True:
                    if self._ended is not None:
                        return self._ended
                    self._stride()
                    stop = self._limit_on_events()
                    if stop is not None:
                        return stop
                    self._look()
                    found = self.gatherer.gather(self._instants)
                    if isinstance(found, Stop):
                        return found
                    if found is not None:
                        self._take_slides(self.decider.meetings.slides)  # seen as cells were crossed
                        self.tape.add(found, whole=self._strides() is not None)
                        done = self._resolve(found)
                        if done.moved and self._ended is None:
                            moved = [self.decider.bodies[i] for i in sorted(done.moved - self._still)]
                            self._predict(moved, self._standing(done))
                    self._report()
        except Undecided as outcome:
            return StopReason.UNDECIDED, str(outcome)
        except (BudgetSpent, TimeIsUp) as outcome:
            return StopReason.BUDGET, str(outcome)
        except KeyboardInterrupt:
            return StopReason.INTERRUPTED, ""

    def _stride(self) -> None:
        """Instants of one contact that nothing comes near, as far as the decider carries them out by itself."""
        stride = self._strides()
        if stride is None:
            return
        before = self._instants
        most, until = self._most(), self.gatherer.clear_until()
        self._instants = stride(before, most, until, self._look, self._note_alone)
        self._take_slides(self.decider.meetings.slides)
        if self._instants != before:
            self._split = False
            if self._loses and self.endings is not None and self.history.last is not None and self.decider.proves:
                self.endings.glance(len(self.history.records), self.decider.reading.rough(self.history.last.time))
            self._report()

    def _strides(self) -> Ordinary | None:
        """What carries out ordinary instants, where it may."""
        endings = self.endings
        if endings is not None and (endings.closes or not (self.scene.elastic or self._loses)):
            return None
        if endings is not None and endings.lines is not None:
            return None
        if self.scene.restitution.sign() == 0:
            return None
        out = self.scene.pockets or self.resolver.touching or self.resolver.gone
        return None if out else self.decider.stride

    def _look(self) -> None:
        self.tape.mark(self.history)

    def _note_alone(self, link: Touch) -> None:
        self.tape.found.append(link)
        self.resolver.policy.note(link)

    def _most(self) -> float:
        """How many events may come before a limit on them, the reversal, or the next look at the clock."""
        records, due = len(self.history.records), self.scene.reverse_after
        most = inf if self.progress is None and not self._loses else EVENTS_A_LOOK
        if self.limits.events is not None:
            most = min(most, self.limits.events - records)
        if due is not None and self.history.reversal is None:
            most = min(most, due - records - 1)
        return most

    def take_up(self, instants: Iterable[Found], after: Callable[[int], None]) -> None:
        """Carries out again what a run gathered before it ended; then `run` goes on from there.

        Nothing is looked for but what comes next at the end: each meeting is predicted once, as it was at the instant
        at which the later of its two flights began.

        Args:
            instants: those after time 0, in order.
            after: called with the number of each instant that is done.
        """
        self._first_knots()
        begun = dict.fromkeys(self.decider.bodies, 0)
        spent: dict[Link, int] = {}  # entries and grazes leave flights as they are, and come no second time on them
        standing = {0: self._open()}
        after(0)
        for found in instants:
            stride = self._strides()
            if stride is not None and not isinstance(found, Instant):
                number = self._instants = self._instants + 2
                stride.again(found, number, self._note_alone)
                self._split = False
                begun.update(dict.fromkeys(set(found.circles) - self._still, number))
                standing[number] = (found,)
                after(number)
                self._report()
                continue
            instant = instant_of(found, self._instants + 2)
            self.tape.add(instant, whole=stride is not None)
            done = self._resolve(instant)
            begun.update(dict.fromkeys(done.moved - self._still, instant.number))
            spent.update(dict.fromkeys((*instant.touches, *instant.rims), instant.number))
            standing[instant.number] = self._standing(done)
            after(instant.number)
            self._report()
        for number in sorted(set(begun.values())):
            later = {i for i, other in begun.items() if other > number}
            moved = [body for body in self.decider.bodies.values() if begun[body.index] == number]
            self._predict(moved, {*standing[number], *(k for k, at in spent.items() if at > number)}, later)

    # -- the instants

    def _first_knots(self) -> None:
        bodies = list(self.decider.bodies.values())
        self.decider.refresh(bodies)
        history, reading = self.history, self.decider.reading
        history.knots += [history.row([(*reading.knot(body), 0, 0)]) for body in bodies]

    def _open(self) -> Collection[Link]:
        """The instant at time 0; what stands at gap zero after it."""
        decider = self.decider
        links = touching_at_start(self.scene)
        decider.begin(0)
        decider.gathered(links)
        signs = {link: decider.ask(Closing(link)) for link in links}
        rims = rims_at_start(self.scene)
        instant = Instant(
            0,
            hits=tuple(link for link, sign in signs.items() if sign < 0),
            touches={link: sign for link, sign in signs.items() if sign >= 0},
            arrivals=tuple(link for link in rims if decider.ask(Closing(link)) < 0),
            rims=frozenset(rims),
        )
        for link, sign in signs.items():
            self.resolver.admit(link, sign)
        done = self.resolver.resolve(instant, self.limits.events, self.scene.reverse_after)
        standing = {**signs, **done.standing}
        self._pressed = part_from_round(self.scene, decider, self.resolver.carrier, done, standing, 0, self._joints)
        self._note(instant, done)
        self._look_for_endings(instant, done, standing)
        return {*links, *rims, *self._standing(done)}

    def _predict(self, moved: Sequence[Body[N]], standing: Collection[Link], besides: Collection[int] = ()) -> None:
        """Predicts the next meetings of circles whose flights are new, with all in play but some."""
        gone = self.resolver.gone
        meetings = self.decider.meetings
        meetings.predict(moved, standing, gone.union(besides) if besides else gone)
        if meetings.slides:
            self._take_slides(meetings.slides)

    def _take_slides(self, slides: list[AtWall]) -> None:
        """Circles that predictions have seen to slide along the line of a face touch it from now on."""
        for link in slides:
            self.resolver.touching.add(link)
        slides.clear()

    def _standing(self, done: Resolved[K]) -> Collection[Link]:
        """The contacts and rims at gap zero that a prediction must leave out."""
        lasting = self.resolver.touching.all()
        return {*done.standing, *lasting} if lasting else done.standing

    def _resolve(self, instant: Instant) -> Resolved[K]:
        """Resolves an instant and notes it; one at which a circle is crushed is none."""
        if self.endings is not None and self.endings.closes:
            moment = None if instant.clock is None else Moment(instant.clock)
            lasting = between_ends(self.scene, self.decider, self.resolver.touching.all(), moment)
            found = self.endings.crushed((*instant.hits, *instant.touches, *lasting))
            if found is not None:
                self._crush(found)
                return Resolved(instant.number)
        decider, records = self.decider, len(self.history.records)
        decider.begin(instant.number)
        left = None if self.limits.events is None else self.limits.events - records
        due = self.scene.reverse_after
        reverse_in = None if due is None or self.history.reversal is not None else due - records
        begun = len(self.history.steps)
        done = self.resolver.resolve(instant, left, reverse_in)
        self._pressed = part_from_round(
            self.scene, decider, self.resolver.carrier, done, done.standing, begun, self._joints
        )
        self._note(instant, done)
        self._look_for_endings(instant, done, done.standing)
        return done

    def _crush(self, closing: Squeeze) -> None:
        """Ends the run: a circle is crushed."""
        assert self.endings is not None
        self.endings.found = Constant(closing.time)
        (who, one), (_, other) = (contact_of(self.scene, AtWall(closing.circle, wall)) for wall in closing.walls)
        told = f"{StopReason.CRUSHED.value}: {who} between {one} and {other} at {float(closing.time):.12g}"
        self._ended = Stop(StopReason.CRUSHED, told)

    def _calmed(self, link: AtWall, other: int, instant: Instant, done: Resolved[K]) -> bool:
        """Whether a wall, or one and another, carry a circle from now on that bounces there infinitely often, and meets
        nothing else."""
        carrier, more = self.resolver.carrier, Resolved[K](done.number, moved={link.circle})
        if carrier is None or not carrier.calm(link, other, self.decider.reading.fallen, self.history.steps):
            return False
        if link.circle in carrier.away:
            self.resolver.leave(link.circle, done)
        else:
            for wall in [link.wall, *([other] if other >= 0 else [])]:
                self.resolver.touching.add(AtWall(link.circle, wall))
                done.standing[AtWall(link.circle, wall)] = 0
        more.moved |= carrier.anchored(done.moved | done.advanced)
        assert self.history.last is not None
        last = self.history.last._replace(step=len(self.history.steps))  # kept if the run is cut short after it
        self._note(instant, more)
        self.history.last = last
        done.moved |= more.moved
        return True

    def _look_for_endings(self, instant: Instant, done: Resolved[K], standing: Mapping[Link, int]) -> None:
        """Notes where an instant under gravity leaves a circle at rest, or bouncing to an end."""
        endings = self.endings
        if endings is None or self._ended is not None:
            return
        resting = endings.at_rest(standing, self.resolver.carrier, self._pressed)
        if resting is not None:
            self._ended = Stop(StopReason.REST, f"{StopReason.REST.value}: {resting}")
            return
        for _, _, impulses, _, _ in done.events:
            joints = self._joints
            at = {joint.face: (k, joint) for k in impulses if joints and (joint := joints.at(k, surely=False))}
            ends_hit = {k: joint.face for k, joint in at.values()}
            for link, other in endings.bounced([ends_hit.get(k, k) for k in impulses]):
                if joints and link in at and not joints.stays(at[link][0]):
                    continue
                time, rows = self.decider.reading.fallen(link.circle)
                wait = self.decider.reading.bounces(Accumulating(link))
                lasting = self.resolver.touching.all()
                ends = endings.ends(link, other, time, wait, rows, lasting, at[link][1][1:3] if link in at else None)
                if ends and outlasts(self.decider, Accumulating(link), self.limits.until):
                    continue
                if ends and (link in at or not self._calmed(link, other, instant, done)):
                    endings.found, both = Accumulating(link), [link.wall, *([other] if other >= 0 else [])]
                    names = " as well as ".join(name_of(self.scene, AtWall(link.circle, wall)) for wall in both)
                    told = f"{StopReason.ACCUMULATION.value}: {names} by {float(time + wait):.12g}"
                    self._ended = Stop(StopReason.ACCUMULATION, told)
                    return
        if endings.lines is not None:
            for _, _, impulses, _, _ in done.events:
                found = endings.lines.note(impulses)
                self._ended = _collapse(self.scene, self.decider, endings, found, self.limits.until)
                if self._ended is not None:
                    return
        if endings.closes and done.events and self.history.last is not None:
            now = self.decider.reading.rough(self.history.last.time)
            for _, _, impulses, _, _ in done.events:
                for closing in endings.squeezed(impulses, now):
                    if self.limits.until is not None and self.limits.until < closing.time:
                        continue
                    if endings.crushes(closing, *self.decider.reading.fallen(closing.circle)):
                        self._crush(closing)
                        return
        if self.decider.proves and done.events and self.history.last is not None:
            links = [link for _, _, impulses, _, _ in done.events for link in impulses]
            endings.look(self.decider.reading.rough(self.history.last.time), links)

    def _note(self, instant: Instant, done: Resolved[K]) -> None:
        """Puts a whole instant into the history."""
        note, before, history = self.resolver.noted(done), done.before, self.history
        self._split = done.split
        self._instants = instant.number
        for i in done.moved - self._still:
            self.decider.bodies[i].serial += 1
        if before is not None:
            history.add(before)
        if note.reversal is not None:
            history.reversal = (len(history.records), note.reversal)
        history.add(note)
        if done.flipped:
            self.gatherer.forget()
        history.last = note.last or history.last

    def _limit_on_events(self) -> Stop | None:
        events = self.limits.events
        if events is None or len(self.history.records) < events:
            return None
        left_out = "; the reversal, which falls on the same instant, and what follows it are left out"
        return Stop(StopReason.EVENTS, f"{StopReason.EVENTS.value} ({events}){left_out if self._split else ''}")

    def _report(self) -> None:
        if self.progress is not None and clock.monotonic() >= self._next_report:
            self._next_report = clock.monotonic() + PROGRESS_EVERY
            last = self.history.last
            reached = 0.0 if last is None else self.decider.reading.rough(last.time)
            self.progress(Progress(len(self.history.records), reached, self.decider.reading.note()))


def part_from_round(
    scene: Scene,
    decider: Decider[N, K],
    carrier: Carrier | None,
    done: Resolved[K],
    standing: Mapping[Link, int],
    begun: int,
    joints: Joints | None,
) -> dict[Link, bool]:
    """Notes what touches something round that stands as its flight begins, and parts from it.

    The gap is c2 s^2 + c3 s^3 + c4 s^4 where the two neither approach nor part: the first of these that is not zero
    tells. An impulse of their own is noted already.

    Args:
        scene, decider, carrier: of the run.
        done: what the instant did.
        standing: contacts at gap zero at its end, with the sign of their closing speed.
        begun: how many steps there were before it.
        joints: knows where faces go on; None where none can.

    Returns:
        the contacts at which one presses on the other instead, and whether it slides along something round; at a joint
        that with the first of its faces.

    Raises:
        Undecided: where that is not told.
    """
    pressed: dict[Link, bool] = {}
    if scene.gravity is None:
        return pressed
    stands = scene.pegs.union(() if carrier is None else carrier.begun)
    steps = decider.history.steps
    pushed = {link for step in steps[begun:] if isinstance(step, Kick) for link in step.among}
    for link, sign in sorted(standing.items()):
        if not can_push(link) or is_flat(link) or (is_pair(link) and (link.a in stands) is (link.b in stands)):
            continue
        faller = next((i for i in link.circles if i not in stands), None)
        new = faller is not None and (done.number == 0 or faller in done.moved | done.advanced)
        if sign > 0 and new and done.number and link not in pushed:
            decider.do(Leave(link, 1))
        if sign or not (new or faller is None):
            continue
        fold, bend = 0, 0
        joint = None if faller is None or joints is None else joints.at(link)
        if joint is not None and joint.pull < 0:
            pressed[joint.face] = False
            continue
        alone = [other for other in standing if standing[other] == 0 and faller in other.circles] == [link]
        if faller is not None and (
            (joint is not None and joint.pull > 0) or not _leads_on(decider, scene, link, faller)
        ):
            fold, bend = next(((k, sign) for k in (2, 3, 4) if (sign := decider.ask(Bend(link, k)))), (0, 0))
        if bend > 0:
            decider.do(Leave(link, fold))
        elif bend and alone:
            pressed[link] = decider.ask(Leans(link)) > 0
        else:
            where = "beside ends that move" if scene.moving_ends else "under gravity"
            raise Undecided(
                f"{name_of(scene, link)} touch, and neither approach nor part, {where}: whether one "
                "rests on the other, slides along it or flies off is not followed"
            )
    return pressed


def _leads_on(decider: Decider[N, K], scene: Scene, link: Touch, faller: int) -> bool:
    """Whether a circle at an end may go onto a face, or a side of an arc, that begins there, or has no normal.

    Beside an end the face has the same normal, across which the circle does not move: where gravity pulls it away from
    the face that gap grows by the pull alone.
    """
    end = next((i for i in link.circles if i in scene.ends), None)
    if end is None:
        return False
    if (scene.circles[faller].r + scene.circles[end].r).sign() == 0:
        return True  # two points: there is no normal
    sides = Sides(scene)
    found = (AtWall(faller, k) for k in scene.faces if begins_at(scene.walls[k], scene.circles[end]))
    faces = (face for face in found if sides.pull(*face[:2]) <= 0)
    arcs = (AtArc(faller, k) for k in range(len(scene.arc_sides)))
    return any(decider.ask(Gap(other)) == 0 for other in (*faces, *arcs))


def between_ends(scene: Scene, decider: Decider[N, K], lasting: Iterable[Touch], moment: Moment | None) -> list[Touch]:
    """Of contacts that last those that are there: with a face's line a circle touches the face between its ends."""
    return [
        link
        for link in lasting
        if not (is_flat(link) and link.wall in scene.faces)
        or all(decider.ask(Beside(link, far, moment)) > 0 for far in (False, True))
    ]


def outlasts(decider: Decider[N, K], end: Accumulating, until: Quantity | None) -> bool:
    """Whether a limit on time comes before infinitely many hits have all happened: those by then are listed."""
    return until is not None and decider.ask(Outlasts(end, until)) > 0


def _collapse(
    scene: Scene,
    decider: Decider[N, K],
    endings: Endings,
    found: Iterable[Collapse],
    until: Quantity | None,
) -> Stop | None:
    """Why hits in turns on a line end a run, if they do: as they have no last one before a limit on time."""
    reading = decider.reading
    for collapse in found:
        time, rows = reading.fallen(collapse.link[0])
        end = Accumulating(collapse.link, collapse.other)
        wait = reading.bounces(end)
        if not wait > 0 or endings.lines is None or not endings.lines.lately(collapse, time, wait):
            continue
        if endings.collapses(collapse, wait, rows) and not outlasts(decider, end, until):
            endings.found = end
            names = " as well as ".join(name_of(scene, link) for link in (collapse.link, collapse.other))
            told = f"{StopReason.ACCUMULATION.value}: {names} by {float(time + wait):.12g}"
            return Stop(StopReason.ACCUMULATION, told)
    return None


def stopped(reason: StopReason, events: int, told: str = "") -> Stop:
    """Why a run ended before its limits; told nothing, with how many events."""
    return Stop(reason, f"{reason.value}: {told or f'after {events} events'}")
