"""The run of any engine, built from what it reports: who hits whom and when, or where everything is."""

from __future__ import annotations

import math
from bisect import bisect_left
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

from ...floating.knots import (
    DoubleKnot,
    DoubleMotion,
    EndlessBounces,
    EventMotion,
    FallingEvents,
    FallingMotion,
    StepFall,
    SteppedEvents,
    SteppedFall,
    bent,
    step_fall,
)
from ...floating.pocket_entries import entering, entries, last_entry
from ...floating.resting import Resting
from ...scenarios.numbers.precision import Double
from ...scenarios.settings import positive_count, positive_time
from ...scenarios.trajectory import (
    Contact,
    Event,
    Progress,
    Reversal,
    Settling,
    Stop,
    StopReason,
    Tie,
    TieProof,
    Trajectory,
)
from ..validation import EngineError, Reports, States, checked_event
from .impulses import Impacts, Indices, Row, Supports

if TYPE_CHECKING:
    from ...scenarios.numbers.quantity import Quantity, QuantityLike
    from ...scenarios.scene import Scene
    from ...scenarios.trajectory import OnProgress

MOST_EVENTS = 1_000_000
"""Events of one recording: a few hundred megabytes."""


class Steps(NamedTuple):
    """An engine of so many bits, with its time step, if it has one, and how it falls, where that is known."""

    bits: int | None
    step: float | None
    fall: StepFall | None = None


class RunSoFar:
    """The events of a run so far, and where every circle is.

    Args:
        scene: what is run.
        impacts: its laws.
        rows: x, y, vx, vy of every circle at the start.
        steps: what the engine is.

    Attributes:
        times: of the events.
        knots: for each circle, from when on it flies straight, from where and how fast.
        left: for each event its time, and how many knots each circle has once it is over.
        reckoned: the events that came without states.
        carried: for each circle the knots from which on a wall carries it, by their place, with the place of the wall.
        slides: those of them from which on it slides down a slope, with half of what there is of gravity along that.
        bounced: those of them before which infinitely many bounces come, with these.
    """

    def __init__(self, scene: Scene, impacts: Impacts, rows: Sequence[Row], steps: Steps) -> None:
        self.supports = Supports(scene)
        self.scene, self._impacts, self._steps = scene, impacts, steps
        self._gravity = None if scene.gravity is None else (float(scene.gravity[0]), float(scene.gravity[1]))
        self._way = self._flights()
        self.times: list[float] = []
        self.knots: list[list[DoubleKnot]] = [[(0.0, *row)] for row in rows]
        self.left: list[tuple[float, tuple[int, ...]]] = []
        self.reckoned: set[int] = set()
        self.carried: list[dict[int, int]] = [{} for _ in rows]
        self.slides: list[dict[int, tuple[float, float]]] = [{} for _ in rows]
        self.bounced: list[dict[int, EndlessBounces]] = [{} for _ in rows]
        self._links: list[list[Indices]] = []
        self._coupled: list[bool] = []
        self._captured = set[int]()
        self._resting = Resting(scene, steps.step) if scene.settle and steps.step is not None else None

    def __len__(self) -> int:
        return len(self.times)

    def event(self, index: int) -> Event:
        """One of the events."""
        ids, links = self.scene.ids, self._links[index]
        impulses = tuple(Contact(ids[i], ids[j]) for i, j in links)
        contacts = tuple(Contact(ids[i], ids[j]) for i, j in sorted(set(links)))
        ties = (Tie(contacts, TieProof.FLOAT),) if len(contacts) > 1 else ()
        return Event(index, Double(self.times[index]), contacts, impulses, ties, self._coupled[index])

    def add(self, where: str, now: float, links: Sequence[Indices], rows: Sequence[Row], together: bool) -> None:
        """Notes an event, of which `leave` is to tell how it leaves the circles.

        Args:
            where: what an error begins with.
            rows: where the circles are.
            together: whether what comes at one time is one.

        Raises:
            EngineError: if there are too many.
        """
        if together and self.times and self.times[-1] == now:
            links = [*self._links[-1], *links]
            for told in (self.times, self._links, self._coupled):
                told.pop()
        if len(self.times) >= MOST_EVENTS:
            raise EngineError(f"{where}: more than {MOST_EVENTS:,} events; end the run before that")
        self.times.append(now)
        self._links.append(list(links))
        self._coupled.append(len(links) > 1 and self._impacts.coupled(sorted(links), rows, now))

    def collisions(
        self, now: float, links: list[Indices], rows: Sequence[Row], left: Mapping[int, Row]
    ) -> list[Indices]:
        """Those contacts that are collisions: what lies on a wall in an engine of steps is pushed in each.

        Args:
            rows: the circles as they come to them, with the gravity of the step.
            left: how they leave those that take part.
        """
        if self._resting is None:
            return links
        after = [left.get(k, row) for k, row in enumerate(rows)]
        normals = {link: self._impacts.normal(link, rows, now) for link in links}
        return self._resting.collisions(
            now, links, lambda k: rows[k][2:], lambda k: after[k][2:], lambda link: normals[link][:2],
            lambda link: self._impacts.strengths(links, rows, after, now)[link],
        )  # fmt: skip

    def holds(self, now: float, states: Mapping[str, Sequence[float]]) -> bool:
        """Whether a step leaves what lies on walls as the one before, in which nothing else was pushed."""
        if self._resting is None:
            return False
        ids = self.scene.ids
        return self._resting.holds(now, None, lambda k: (states[ids[k]][2], states[ids[k]][3]))

    def rests(self, now: float, rows: Sequence[Row]) -> bool:
        """Whether all circles lie on walls, in an engine of steps, and none comes nearer to another or to a wall."""
        if self._resting is None or not self._resting.all_lie(now):
            return False
        quiet = self._impacts.quiet(rows, now, self._resting.room(math.hypot(*row[2:]) for row in rows))
        if quiet:
            self._resting.stays()
        return quiet

    def fly(self, now: float, rows: Mapping[int, Row], carried: Mapping[int, int] | None = None) -> None:
        """Circles fly on from a time as told; `carried` by which walls, by their places in `scene.ids`."""
        for k, row in rows.items():
            if self._impacts.moves(k):
                if carried is not None and k in carried:
                    self.carried[k][len(self.knots[k])] = carried[k]
                    if (slope := self.supports.slope(k, carried[k], row)) is not None:
                        self.slides[k][len(self.knots[k])] = slope
                self.knots[k].append((now, *row))

    def bounce_out(self, k: int, wall: int, now: float) -> None:
        """What falls since it bounced on a wall, which carries it by now, has bounced there infinitely often."""
        knot = time, x, y, vx, vy = self.knots[k][-1]
        met = any((k, wall) in links for links in self._links[bisect_left(self.times, time) :])
        last = self.supports.bounces(k, wall, knot, now, float(self.scene.restitution))
        if met and last is not None and self.support(k) is None:
            self.bounced[k][len(self.knots[k])] = last
            self.fly(time, {k: (x, y, vx - last.nx * last.speed, vy - last.ny * last.speed)}, {k: wall})

    def support(self, k: int) -> int | None:
        """The place of the wall that carries a circle now; None where it falls."""
        return self.carried[k].get(len(self.knots[k]) - 1)

    def settlings(self, knots: Sequence[Sequence[DoubleKnot]]) -> tuple[Settling, ...]:
        """Where walls begin to carry circles, as far as these knots go; not at an instant at which they let go."""
        if self._resting is not None:
            return tuple(self._resting.settlings)
        found: list[tuple[float, int, int]] = []
        for k, (row, carried) in enumerate(zip(knots, self.carried, strict=True)):
            last = {knot[0]: carried.get(place) for place, knot in enumerate(row)} if carried else {}
            pairs = zip([None, *last.values()], last.items(), strict=False)
            found += [(time, k, wall) for before, (time, wall) in pairs if wall is not None and before is None]
        ids, ends = self.scene.ids, {(k, b.start): b.until for k, row in enumerate(self.bounced) for b in row.values()}
        rows = sorted((ends.get((k, time), time), k, wall, time) for time, k, wall in found)
        said = [(Double(time), None if time == since else Double(since)) for time, _, _, since in rows]
        return tuple(Settling(ids[k], ids[wall], *when) for (_, k, wall, _), when in zip(rows, said, strict=True))

    def leave(self, now: float) -> None:
        """The last event, if it is of this time, is over."""
        if self.times and self.times[-1] == now:
            self.left[len(self.times) - 1 :] = [(now, tuple(map(len, self.knots)))]

    def rows(self, now: float) -> list[Row]:
        """Where every circle is by its last flight."""
        straight, found = DoubleMotion(()), list[Row]()
        for k, row in enumerate(self.knots):
            slope = self.slides[k].get(len(row) - 1)
            way = self._way if self.support(k) is None else straight
            if self._resting is not None and (until := self._resting.pushed(k, row[-1][0])) > row[-1][0]:
                x, y, vx, vy = straight.flown(k, row[-1], min(now, until))
                found.append(way.flown(k, (until, x, y, vx, vy), now) if now > until else (x, y, vx, vy))
                continue
            found.append(way.flown(k, row[-1], now) if slope is None else bent(row[-1], now, slope))
        return found

    def rounds(self, now: float) -> float:
        """By what share of themselves numbers may be off a flight: each step adds to places, or to falling speeds."""
        bits, step, _ = self._steps
        if bits is None or (self._gravity is None and 2.0**-bits < FLIGHT):
            return FLIGHT
        span = now - min(row[-1][0] for row in self.knots)
        return max(FLIGHT, 4.0 * max(1.0, 1.0 if step is None else span / step) * 2.0**-bits)

    def _flights(self) -> DoubleMotion:
        """How circles fly, without knots."""
        if self._gravity is None:
            return DoubleMotion(())
        (gx, gy), (_, step, fall) = self._gravity, self._steps
        if fall is None or step is None:
            return FallingMotion((), halves=(gx / 2, gy / 2), pegs=self.scene.pegs)
        return SteppedFall((), math.inf, (gx, gy), step, self.scene.pegs, *fall)

    def in_play(
        self, given: Mapping[int, Row], rows: Sequence[Row], now: float, scale: float, links: Sequence[Indices] = ()
    ) -> dict[int, Row]:
        """States without those of circles at rest that a pocket has captured: that is no contact, and their entry is
        read off the flight to it, as where an engine says no more of them. What collides as it enters has been struck
        before: it leaves the contact as the laws have it.

        Args:
            rows: the circles as they come to the report; links: what collides in it.
            scale: the scene's largest coordinate.
        """
        if not self.scene.capture:
            return {**given}
        still, met = {k for k, row in given.items() if not any(row[2:])}, {k for link in links for k in link}
        self._captured -= (given.keys() - still) | met
        after = (self._impacts.bounce(links, rows, now) if still & met else None) or rows
        if new := {k for k in still - self._captured if any(after[k][2:])}:
            ids, room = self.scene.ids, self.rounds(now) * scale
            found = entries(self.scene, self.motion(self.knots, now, scale), now)
            last = {entry.circle: float(entry.time) for entry in found}
            flown = {k for k in new - met if last.get(ids[k], -1.0) >= self.knots[k][-1][0]}
            self._captured |= flown | {k for k in new if entering(self.scene, after[k], room)}
        struck = self._captured & met
        return {
            k: after[k] if k in struck else row for k, row in given.items() if k in struck or k not in self._captured
        }

    def motion(self, knots: Sequence[Sequence[DoubleKnot]], end: float, scale: float) -> EventMotion:
        """The flights between what was reported; of an engine of steps as its own states say that it falls."""
        left, reckoned = self.left, tuple(sorted(self.reckoned))
        if self._gravity is None:
            return EventMotion(knots, end, left, reckoned)
        (gx, gy), pegs, (bits, step, fall) = self._gravity, self.scene.pegs, self._steps
        if fall is None and step is not None and not reckoned:
            share = FLIGHT if bits is None else max(FLIGHT, 4.0 * 2.0**-bits)
            fall = step_fall(knots, self._gravity, step, pegs, share * scale, float(self.scene.restitution))
        if fall is None or step is None:
            carried = {k: frozenset(n for n in row if n < len(knots[k])) for k, row in enumerate(self.carried) if row}
            slides, bounced = dict(enumerate(self.slides)), dict(enumerate(self.bounced))
            halves = gx / 2, gy / 2
            return FallingEvents(knots, end, halves, pegs, carried, slides, bounced, left=left, reckoned=reckoned)
        rests = {} if self._resting is None else self._resting.spans(end)
        return SteppedEvents(knots, end, (gx, gy), step, pegs, *fall, rests, left, reckoned)


def rounded_to(value: float, bits: int | None) -> float:
    """A double rounded to fewer bits, ties to even; wider numbers stay doubles.

    >>> rounded_to(0.1, 24), rounded_to(0.1, 53)
    (0.10000000149011612, 0.1)
    """
    if bits is None or bits >= 53:
        return value
    mantissa, exponent = math.frexp(value)
    return math.ldexp(round(math.ldexp(mantissa, bits)), exponent - bits)


# ----------------------------------------
# Builds the run of any engine from what it reports: who hits whom and when, or where everything is.

RECORD_ENDS = "the record ends at time"
"""What the stop of a run says of which no more is known, before the time."""

MOST_STEPS = 10_000_000
"""States of one recording, as many as pymunk's default budget of steps."""

LOOK = 64
"""Steps in a row in which nothing but what lies on walls is pushed, after which it is seen whether all lie so."""

FLIGHT = 2.0**-40
"""A state that is off the flight from the last one by no more than this share of the scene's measures says nothing
new: adding up v dt over a thousand steps rounds by less. Others begin a flight of their own. A velocity that differs
from the last by no more than this share of the largest speed does by rounding, and not by a contact."""

UNEXPLAINED = 1 / 8
"""A change of velocities of which contacts leave more than this share is not of their making. Overlaps turn the lines
of centres, and so a step that keeps the law leaves some."""


class Recording:
    """Takes down the run of an engine, which reports either what happens or where everything is.

    An engine of events reports each `hit`, best with the states of the two as it leaves them. Without states, where
    circles are is reckoned in doubles from the times reported, by the laws of elastic impact. An engine of steps hands
    over its `state` after each step, and what hit what is inferred from the velocities that have changed, unless it
    reports that too. The scene's reversal is made by the recording; an engine of steps makes its own as well.

    Args:
        scene: what is run.
        name: the engine's.
        bits: of its numbers; None for exact ones.
        step: its time step, if it has one: all that it reports at one time is then one event.
        until, events: how far is asked for: `open` says whether there is more to do.
        parameters: its settings, for reports.
        returns: whether a run of a scene with a reversal is to end at the return, at twice the reversal's time.
        progress: called with how far the run is.
        fall: how an engine of steps falls, where that is known; otherwise it is told by its states.

    In a scene with `settle` a circle that walls carry flies straight. Where a report does not say which are carried,
    each is that touches a wall across gravity, and has no speed across it but for rounding.

    Attributes:
        reckoned: whether a hit came without states, so that places were reckoned from times.
        notes: what reports are to say of it.

    >>> from truebreak.scenarios import Circle, Scene
    >>> recording = Recording(Scene([Circle(0, 0, vx=1, id="a"), Circle(4, 0, id="b")]), step=1 / 8)
    >>> recording.state(2.125, {"a": (2.125, 0, 0, 0), "b": (4, 0, 1, 0)})
    >>> recording.trajectory().events[0].contacts
    (Contact(first='a', second='b'),)
    """

    def __init__(
        self,
        scene: Scene,
        name: str = "recording",
        *,
        bits: int | None = 53,
        step: float | None = None,
        until: QuantityLike | None = None,
        events: int | None = None,
        parameters: Mapping[str, Any] | None = None,
        returns: bool = False,
        progress: OnProgress | None = None,
        fall: StepFall | None = None,
    ) -> None:
        self.scene, self.name, self.bits, self.step = scene, name, bits, step
        self.parameters = dict(parameters or {})
        self.until, self.events = positive_time("until", until), positive_count("events", events)
        self.notes: list[str] = []
        self.reckoned = False
        self._returns, self._progress = returns, progress
        self.reversal: Reversal | None = None
        self._places = {name: place for place, name in enumerate(scene.ids)}
        self._impacts, self._reports = Impacts(scene), Reports(scene, f"engine {name!r}")
        numbers = [[rounded_to(float(v), bits) for v in (c.x, c.y, c.vx, c.vy)] for c in scene.circles]
        rows = [(x, y, vx, vy) for x, y, vx, vy in numbers]
        self._course = RunSoFar(scene, self._impacts, rows, Steps(bits, step, fall))
        self._scale = max(max(abs(float(c.x)), abs(float(c.y)), float(c.r)) for c in scene.circles)
        self._now, self._end, self._steps = 0.0, 0.0, 0
        self._unit = 4.0 * 2.0 ** -(53 if bits is None else bits)
        if carried := self._carried_by(0.0, dict(enumerate(rows)), rows):
            self._course.fly(0.0, {k: rows[k] for k in carried}, carried)
        self._budget: str | None = None
        self._held = 0
        self._lasting: Sequence[tuple[str, str]] | None = None
        self._quiet = self._reported = self._closed = False

    # -- what an engine reports

    @property
    def where(self) -> str:
        """What an error begins with: the engine, or the line of a log."""
        return self._reports.where

    @where.setter
    def where(self, told: str) -> None:
        self._reports.where = told

    @property
    def open(self) -> bool:
        """Whether the run is to go on: it has not come to its limits, nor to its end."""
        return not self._closed and self._stop_within(None, self.until, self.events) is None

    @property
    def rows(self) -> list[Row]:
        """x, y, vx, vy of every circle at the last time reported; at first the scene's, in the engine's bits."""
        return self._course.rows(self._now)

    def hit(
        self, time: float, a: str, b: str, states: States | None = None, carried: Mapping[str, str] | None = None
    ) -> None:
        """Two circles, or a circle and a wall, collide.

        Args:
            a, b: ids, in any order.
            states: x, y, vx, vy of circles as the collision leaves them; each that moves must be among them.
            carried: those of them that a wall carries from then on, with the wall; None: their states say it.

        Raises:
            EngineError: for an unknown id, a time that is not finite or goes back, a state that is not finite.
        """
        self.hits(time, [(a, b)], states, carried)

    def hits(
        self, time: float, pairs: Sequence[tuple[str, str]], states: States | None = None,
        carried: Mapping[str, str] | None = None,
    ) -> None:  # fmt: skip
        """Several contacts collide at one instant, together; otherwise as `hit`."""
        now = self._reports.time(time, self._now, self.bits)
        if pairs == self._lasting and isinstance(states, Mapping) and self._course.holds(now, states):
            self._rest(now)
            return
        contacts = [self._reports.contact(pair) for pair in pairs]
        index = len(self._course)
        event = Event(index, Double(now), tuple(dict.fromkeys(contacts)), tuple(contacts))
        checked_event(self.where, event, index, self.scene)
        links = [(self._places[a], self._places[b]) for a, b in contacts]
        if all(not self._impacts.moves(k) for link in links for k in link):
            raise EngineError(f"{self.where}: {contacts[0]} cannot collide: neither ever moves; leave it out")
        self._turn_before(now)
        rows = self._course.rows(now)
        if self._part_at_the_turn(now, links, rows):
            self._reverse(now)
            rows = self._course.rows(now)
        links = self._impacts.named(links, rows)
        given = None if states is None else self._reports.states(states)
        if given is not None:
            self._reports.check_all({k for link in links for k in link if self._impacts.moves(k)}, given)
            given = self._course.in_play(given, rows, now, self._scale, links)
            links = self._course.collisions(now, links, rows, given)
        if links:
            self._course.add(self.where, now, links, rows, self.step is not None)
        supports = None if carried is None else self._reports.carried(carried)
        if given is None:
            self._bounce(now, links, rows, supports)
        else:
            given = {k: rows[k] for k in supports or ()} | given
            self._course.fly(now, given, self._carried_by(now, given, rows, supports))
        self._leave(now)
        self._reported = True
        self._lasting, self._held = (None if links else list(pairs)), 0
        self._turn_after()
        self._tell()

    def _rest(self, now: float) -> None:
        """A step with no impulse but those of rest; every `LOOK` such steps, whether anything can still happen."""
        self._now = self._end = max(self._now, now)
        self._held += 1
        self._reported = True
        if self._held % LOOK == 0:
            self._quiet = self._course.rests(now, self._course.rows(now))
            self._closed = self._closed or (self._quiet and self.until is None)
        self._tell()

    def state(self, time: float, states: States, carried: Mapping[str, str] | None = None) -> None:
        """Where circles are at a time, and how fast they go; for an engine of steps, after each step.

        Where a velocity has changed since the last state, and no hit was reported, the contacts are inferred: of the
        pairs that touch, or have come nearer than a step takes them, those whose impulses explain the change. What is
        `carried` now, and has fallen since it bounced on that wall, has bounced there infinitely often meanwhile.

        Raises:
            EngineError: as `hit`, and for a change of velocity that no contact explains.
        """
        now = self._reports.time(time, self._now, self.bits)
        given = self._reports.states(states)
        way = self.step if self.step is not None else now - self._now
        self._turn_before(now)
        supports = None if carried is None else self._reports.carried(carried)
        for k, wall in (supports or {}).items():
            self._course.bounce_out(k, wall, now)
        before = self._course.rows(now)
        given = self._course.in_play(given, before, now, self._scale)
        rows = [given.get(k, row) for k, row in enumerate(before)]
        share, stands = self._course.rounds(now), self.scene.gravity is None
        fastest = max(math.hypot(*row[2:]) for row in [*rows, *before])
        if not stands:  # at the top of a flight a speed is what rounding has left of that with which it began
            fastest = max(fastest, *(math.hypot(*row[-1][3:]) for row in self._course.knots))
        small = share * fastest
        turned = [max(abs(vx - ux), abs(vy - uy)) for (*_, vx, vy), (*_, ux, uy) in zip(rows, before, strict=True)]
        changed = [k for k, by in enumerate(turned) if by > small]
        links: list[Indices] = []
        if changed and not self._reported:
            links = self._inferred(now, way, rows, before)
            links = self._course.collisions(now, links, before, dict(enumerate(rows)))
        if links:
            self._course.add(self.where, now, links, rows, self.step is not None)
        under = self._carried_by(now, given, before, supports)
        off = [
            k
            for k, by in enumerate(turned)
            if by > (0.0 if stands else small)
            or max(abs(rows[k][0] - before[k][0]), abs(rows[k][1] - before[k][1])) > share * self._scale
            or ((k in given or k in under) and under.get(k) != self._course.support(k))
        ]
        self._course.fly(now, {k: rows[k] for k in off}, under)
        self._leave(now)
        self._steps += 1
        happened = bool(changed) or self._reported or self._steps == 1
        self._reported = False
        if happened:
            self._turn_after()
            turns = self.scene.reverse_at is not None or self.scene.reverse_after is not None
            self._quiet = not (turns and self.reversal is None) and self._impacts.quiet(rows, now)
        if self._steps >= MOST_STEPS:
            self.spent(f"{MOST_STEPS:,} states")
        self._closed = self._closed or (self._quiet and self.until is None)
        self._tell()

    def end(self, time: float | None = None, *, quiet: bool = False) -> None:
        """The run ends: what comes later than this is not known.

        Args:
            time: by default that of the last report.
            quiet: whether nothing is left to happen, for ever.

        Raises:
            EngineError: for a time before the last report.
        """
        if time is not None:
            now = self._reports.time(time, self._now, self.bits)
            self._turn_before(now)
            self._end = max(self._end, now)
        at = self.scene.reverse_at
        if quiet and at is not None and self.reversal is None:  # after which nothing is left to happen either
            self._reverse(float(at))
            self._end = max(self._end, float(at))
        self._quiet, self._closed = quiet, True

    def spent(self, budget: str) -> None:
        """The run ends since a budget is spent; `budget` says which."""
        self._budget, self._closed = budget, True

    def trajectory(self, *, until: QuantityLike | None = None, events: int | None = None) -> Trajectory:
        """The run as reported, up to the limits given, or else to those of the recording."""
        limit, count = positive_time("until", until), positive_count("events", events)
        if limit is None and count is None:
            limit, count = self.until, self.events
        stop = self._stop_within(self._end, limit, count)
        assert stop is not None
        told = [k for k, time in enumerate(self._course.times) if limit is None or time <= float(limit)][:count]
        end: Any = Double(self._end)
        knots, turned = self._course.knots, self.reversal
        if stop.reason is StopReason.EVENTS:
            end = Double(self._course.times[told[-1]])
            knots = [row[:number] for row, number in zip(knots, self._course.left[told[-1]][1], strict=True)]
            turned = turned if turned and turned.after < len(told) else None
        elif stop.reason is StopReason.QUIET:
            whole = self._course.motion(knots, self._end, self._scale)
            end = Double(last_entry(self.scene, whole, self._end))
        elif stop.reason is StopReason.HORIZON and limit is not None and (self._quiet or float(limit) <= self._end):
            end, knots = limit, [[knot for knot in row if knot[0] <= float(limit)] for row in knots]
        turned = turned if turned and float(turned.time) <= float(end) else None
        motion = self._course.motion(knots, float(end), self._scale)
        return Trajectory(
            scene=self.scene,
            engine=self.name,
            parameters=self.parameters,
            events=tuple(self._course.event(k) for k in told),
            stop=stop,
            final_time=end,
            motion=motion,
            reversal=turned,
            pocketings=entries(self.scene, motion, float(end)) if self.scene.pockets else (),
            notes=tuple(self.notes),
            settlings=tuple(s for s in self._course.settlings(knots) if float(s.time) <= float(end)),
        )

    # -- what is made of it

    def _stop_within(self, end: float | None, limit: Quantity | None, count: int | None) -> Stop | None:
        """Why a run with such limits ends; with `end` None, None while it does not."""
        done = len(self._course)
        if limit is not None and end is not None:
            done = sum(time <= float(limit) for time in self._course.times)
        if count is not None and done >= count:
            return Stop(StopReason.EVENTS, f"{StopReason.EVENTS.value}: {count}")
        reached = self._now if end is None else end
        if limit is not None and (float(limit) <= reached or (self._quiet and end is not None)):
            told = limit.brief() if len(limit.text()) < 20 else repr(float(limit))  # of a double the fraction is long
            return Stop(StopReason.HORIZON, f"{StopReason.HORIZON.value} {told}")
        if end is None:
            return None
        if self._quiet:
            return Stop(StopReason.QUIET, StopReason.QUIET.value)
        if self._budget is not None:
            return Stop(StopReason.BUDGET, f"{StopReason.BUDGET.value}: {self._budget}")
        return Stop(StopReason.HORIZON, f"{RECORD_ENDS} {end!r}")

    def _carried_by(
        self, now: float, left: Mapping[int, Row], rows: Sequence[Row], told: Mapping[int, int] | None = None
    ) -> Mapping[int, int]:
        """Which circles walls carry from a report on: as told, or those that lie on a wall by their states.

        Args:
            left: how the report leaves circles.
            rows: all of them, as they come to it.
        """
        if self.step is not None:  # by steps nothing flies on along a wall: it is pushed in each
            return {}
        if told is not None or not self.scene.settle:
            return told or {}
        fastest = max(math.hypot(*row[2:]) for row in [*rows, *left.values()])
        under, share, still = self._course.supports.under, max(FLIGHT, self._unit), self._unit * fastest
        found = {k: under(k, row, share, still, fastest * now) for k, row in left.items()}
        return {k: wall for k, wall in found.items() if wall is not None and self._impacts.moves(k)}

    def _bounce(
        self, now: float, links: Sequence[Indices], rows: Sequence[Row], supports: Mapping[int, int] | None
    ) -> None:
        """Has the laws say how a hit without states leaves the circles, also by the walls that carry them."""
        self.reckoned = True
        self._course.reckoned.add(len(self._course) - 1)
        hit = {k for link in links for k in link if self._impacts.moves(k)}
        under = {k: wall for k in sorted(hit) if (wall := self._course.support(k)) is not None}
        after = self._impacts.bounce([*links, *(u for u in under.items() if u not in links)], rows, now)
        if after is None:
            if not self.notes:
                one, other = (self.scene.ids[k] for k in links[0])
                self.notes.append(
                    f"event {len(self._course) - 1}: with the times reported, the laws do not have {one} and {other} "
                    "approach there: from then on where circles are is not known; report states"
                )
            return
        left = {k: row for k, row in enumerate(after) if row[2:] != rows[k][2:]}
        self._course.fly(now, left, self._carried_by(now, left, rows, supports))

    def _inferred(self, now: float, way: float, rows: Sequence[Row], before: Sequence[Row]) -> list[Indices]:
        """The contacts of the last `way` of time."""
        room = 2 * way * max(math.hypot(*row[2:]) for row in [*rows, *before]) + FLIGHT * self._scale
        ago = [(x - vx * way, y - vy * way, vx, vy) for x, y, vx, vy in rows]  # of one that pushes before it moves
        for places in (rows, ago) if self.step else (rows,):
            links, left = self._impacts.inferred(places, before, room, now, None if self.step else way)
            if links and left <= UNEXPLAINED:
                return self._impacts.named(links, before)
        k = max(range(len(rows)), key=lambda k: math.dist(rows[k][2:], before[k][2:]))
        (ux, uy), (vx, vy), falls = rows[k][2:], before[k][2:], self.scene.gravity is not None
        remedy = "report the contacts by hit(time, a, b)" + (", or mend how it falls" if falls else "")
        shown = [[f"{x:.{n}g}, {y:.{n}g}" for x, y in ((ux, uy), (vx, vy))] for n in (6, 9, 13, 17)]
        given, flown = next((pair for pair in shown if pair[0] != pair[1]), shown[-1])
        raise EngineError(
            f"{self.where}: at time {now!r} the velocity of {self.scene.ids[k]!r} is ({given}), where its "
            f"flight has ({flown}), and no contact near it explains how; {remedy}"
        )

    def _turn_before(self, now: float) -> None:
        """The scene's reversal at a set time, if it is due before a report; and the clock goes on."""
        at = self.scene.reverse_at
        if at is not None and self.reversal is None and float(at) < now:
            self._reverse(float(at))
        self._now = self._end = max(self._now, now)

    def _part_at_the_turn(self, now: float, links: Sequence[Indices], rows: Sequence[Row]) -> bool:
        """Whether a hit at the very time of the reversal, to a double, comes after it: those that collide parted."""
        at = self.scene.reverse_at
        if at is None or self.reversal is not None or float(at) != now:
            return False
        return all(self._impacts.opening(link, rows, self._impacts.normal(link, rows, now)) > 0.0 for link in links)

    def _turn_after(self) -> None:
        """The scene's reversal after a number of events, if it is due."""
        if self.scene.reverse_after == len(self._course) and self.reversal is None:
            self._reverse(self._course.times[-1])

    def _reverse(self, time: float) -> None:
        self.reversal = Reversal(len(self._course), Double(time))
        self._course.fly(time, {k: (x, y, -vx, -vy) for k, (x, y, vx, vy) in enumerate(self._course.rows(time))})
        if self._returns:
            self.until, self.events = positive_time("until", 2 * time), None

    def _tell(self) -> None:
        if self._progress is not None:
            self._progress(Progress(len(self._course), self._now))

    def _leave(self, now: float) -> None:
        """The last event is over, if it is of this time; unless velocities have been reversed since."""
        if self.reversal is None or self.reversal.after < len(self._course):
            self._course.leave(now)
