"""Watches the exact engine as it carries a set of deviations, and holds every bound against the truth."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field, fields
from math import log2
from operator import add
from typing import Any
from unittest.mock import patch

from flint import arb, arb_mat

from error_bound.oracle import BITS, Line, Truth, table_of
from error_bound.zonotope import BITS as MATRIX_BITS
from error_bound.zonotope import Zonotope
from truebreak.exact import ExactEngine
from truebreak.exact.certified import certified_decider as decider
from truebreak.exact.certified import certified_decider as precision
from truebreak.exact.numbers import ball
from truebreak.exact.replay import centred_state as lone_centred
from truebreak.exact.replay import deviations as lone_carrying
from truebreak.exact.replay import refinable
from truebreak.exact.replay.centred_state import CentredState, LoneCentred, lone_contacts
from truebreak.exact.replay.contact import Body, Flight, Touch, can_push
from truebreak.exact.replay.deviations import Deviations, Moved
from truebreak.exact.replay.refinable import RefinableState
from truebreak.exact.replay.state import Flip, Go, Step, circles_of
from truebreak.scenarios import Scene
from truebreak.scenarios.trajectory import Trajectory

NUMBERS = ("x", "y", "vx", "vy")

FEWEST_BITS = 64
"""Length of exact numbers from which on circles are in balls here."""


@dataclass
class Tally:
    """What has been held against what.

    Attributes:
        checks: numbers of a circle after a step, each against its ball.
        in_set: those of them of a circle that a set held.
        at_once: contacts that were carried out in one go, with a set.
        instants: times of contacts, each against its ball.
        worst: the largest share of its ball's radius by which a midpoint was off.
        sets, blocks: how many were begun, and how many ended.
        bounds: bounds of a circle, each against the hull of the same set in plain matrices.
        tightest: the largest share of the bound that the hull was.
        first: of first blocks, by how many bits the box at the end was too large along each edge, at least.
        more: of later blocks, by how many bits that grew.
        faults: what did not hold.
    """

    checks: int = 0
    in_set: int = 0
    at_once: int = 0
    instants: int = 0
    worst: float = 0.0
    sets: int = 0
    blocks: int = 0
    bounds: int = 0
    tightest: float = 0.0
    first: list[float] = field(default_factory=list)
    more: list[float] = field(default_factory=list)
    faults: list[str] = field(default_factory=list)

    def __add__(self, other: Tally) -> Tally:
        return Tally(
            **{f.name: _MERGED.get(f.name, add)(getattr(self, f.name), getattr(other, f.name)) for f in fields(self)}
        )


_MERGED: dict[str, Any] = {"worst": max, "tightest": max}


class Watch:
    """Holds each state of a run, replays included, against the truth.

    Args:
        scene: what runs.
        truth: its log, carried out.
        matrices: whether sets are carried in plain matrices too.
    """

    def __init__(self, scene: Scene, truth: Truth, matrices: bool) -> None:
        self.tally = Tally()
        self._scene = scene
        self._truth = truth
        self._matrices = matrices
        self._link: Touch | None = None
        self._steps = 0
        self._ended = False
        self._loose: float | None = None
        self._twins: dict[int, tuple[Deviations, Zonotope]] = {}
        with ball.precision(MATRIX_BITS):
            self._table = table_of(scene)

    @contextmanager
    def watching(self) -> Iterator[None]:
        """While the engine runs."""
        begin, centre, kick, land, close = (
            Deviations.__init__, Deviations.recentre, CentredState.kick, CentredState._land, Deviations.close
        )  # fmt: skip
        watch, steps = self, RefinableState._step_in_balls

        class Lone:
            """Contacts alone, as the engine has them, each looked at."""

            def __init__(self, state: CentredState) -> None:
                self._state, self._lone = state, lone_contacts(state)

            def __getattr__(self, name: str) -> Any:
                return getattr(self._lone, name)

            def strike(self, link: Touch, bits: int, done: int) -> int | None:
                watch._link, watch._steps = link, done
                accuracy = self._lone.strike(link, bits, done)
                watch._link = None
                if accuracy is not None:
                    watch.tally.at_once += isinstance(self._lone, LoneCentred)
                    watch.look(self._state, link.circles, done + 2)
                return accuracy

        def began(held: Deviations, members: Any, *rest: Any) -> None:
            begin(held, members, *rest)
            watch.begin(held, members)

        def centred(held: Deviations, moved: Sequence[Moved], clock: arb, last: int) -> Any:
            watch.step(held, moved, clock)
            return centre(held, moved, clock, last)

        def carried(carry: Callable[..., Any], at: int) -> Callable[..., Any]:
            """What is compiled calls nothing of the above; its bodies and their clock are those from `at` on."""

            def carrying(held: Deviations, *given: Any) -> Any:
                told = carry(held, *given)
                if told is not None and lone_carrying.steps is not None:
                    moved, clock = given[at : at + 2]
                    watch.step(held, moved if isinstance(moved[0], tuple) else (moved,), clock)
                return told

            return carrying

        def kicked(state: CentredState, links: tuple[Touch, ...]) -> None:
            watch._link = links[0] if len(links) == 1 else None
            kick(state, links)
            watch._link = None

        def landed(state: CentredState) -> None:
            watch._link = None
            land(state)

        def closed(held: Deviations) -> bool:
            watch.tally.blocks += 1
            watch._ended = True
            return close(held)

        def stepped(state: RefinableState, balls: CentredState, step: Any, taking_part: Any, bits: int) -> int:
            watch._steps = balls.steps_done
            accuracy = steps(state, balls, step, taking_part, bits)
            watch.look(balls, taking_part, balls.steps_done, type(step) is Go)
            if type(step) is Flip:
                watch.hold_instant("reversal", balls.flip_time, balls.steps_done)
            return accuracy

        with ExitStack() as stack:
            for place, name, new in (
                (Deviations, "__init__", began), (Deviations, "recentre", centred), (Deviations, "close", closed),
                (CentredState, "kick", kicked), (CentredState, "_land", landed),
                (RefinableState, "_step_in_balls", stepped), (refinable, "lone_contacts", Lone),
                (lone_centred, "carry_pair", carried(lone_centred.carry_pair, 5)),
                (lone_centred, "carry_wall", carried(lone_centred.carry_wall, 5)),
                (lone_centred, "carry_fall", carried(lone_centred.carry_fall, 5)),
                (lone_centred, "carry_round", lone_centred.carry_round),  # Python, by `recentre`
            ):  # fmt: skip
                stack.enter_context(patch.object(place, name, new))
            yield

    def carry_out(self, steps: Sequence[Step], bits: int, wide: int | None = None, at_once: bool = False) -> None:
        """Carries out a log step by step, with sets.

        Args:
            steps: the log.
            bits: the precision.
            wide: the power of two that all numbers are known to at first; by default what the scene has them to. Where
                that is far more than roundings, all of a set is what derivatives make of it.
            at_once: whether contacts are carried out in one go where they can be.
        """
        with ball.precision(bits):
            state = CentredState(self._scene)
            for body in state.bodies.values():
                body.acc = bits
                if wide is not None and not self._scene.circles[body.index].fixed:
                    numbers = (number + arb(0, arb((1, wide))) for number in body.flight[:4])
                    body.flight = Flight(*numbers, *body.flight[4:])
            lone, done = refinable.lone_contacts(state), 0
            while done < len(steps):
                step = steps[done]
                link = step.source if at_once and isinstance(step, Go) and isinstance(step.source, tuple) else None
                if can_push(link) and lone.strike(link, bits, done) is not None:
                    done += 2
                    continue
                ball.use_bits(bits)
                self._steps = state.steps_done = done
                state.do(step)
                done += 1
                self.look(state, circles_of(step, state.n), done)

    # -- the truth

    def hold_instant(self, of: str, instant: arb, done: int) -> None:
        """Holds an instant against the truth."""
        self.tally.instants += 1
        with ball.precision(BITS):
            if not instant.overlaps(true := self._truth.times[done]):
                self._fault(f"after {done} steps the {of} is at {instant.str(20)}, not {true.str(20)}")

    def look(self, state: CentredState, circles: Any, done: int, went: bool = True) -> None:
        """After so many steps: the circles that have just moved, and the instant, if they went to it."""
        tally, held = self.tally, state._deviations
        if went:
            self.hold_instant("instant", state.instant, done)
        with ball.precision(BITS):
            for i in circles:
                if i in state.outside:
                    continue
                flight = state.bodies[i].flight
                true = self._truth.after(i, done).at(flight.t)
                for name, mine, theirs in zip(NUMBERS, flight, true, strict=False):
                    tally.checks += 1
                    tally.in_set += held is not None and i in held.place
                    off, radius = abs(mine.mid() - theirs.mid()), mine.rad()
                    if off - theirs.rad() > radius:
                        self._fault(f"after {done} steps {name} of circle {i} is {mine.str(20)}, not {theirs.str(20)}")
                    elif radius > 0:
                        tally.worst = max(tally.worst, float(off / radius))
        if held is not None and id(held) in self._twins:
            self._compare(held, done)

    def _fault(self, what: str) -> None:
        self.tally.faults.append(what)

    # -- the set in plain matrices

    def begin(self, held: Deviations, members: list[Body[arb]]) -> None:
        """A set begins."""
        self.tally.sets += 1
        self._twins.clear()
        self._ended, self._loose = False, None
        if self._matrices:
            lines = {b.index: Line(*(number.mid() for number in b.flight[:4]), b.flight.t) for b in members}
            radii = {b.index: [arb(number.rad()) for number in b.flight[:4]] for b in members}
            self._twins[id(held)] = held, Zonotope(lines, radii, self._table, self._truth.sides)

    def step(self, held: Deviations, flown: Sequence[Moved], clock: arb) -> None:
        """Circles get new midpoints at a clock, from balls around them."""
        if id(held) not in self._twins:
            return
        twin, link = self._twins[id(held)][1], self._link
        moved = [body.index for body, *_ in flown]
        after = {body.index: Line(*(number.mid() for number in four), clock) for body, *four in flown}
        radii = {body.index: [arb(number.rad()) for number in four] for body, *four in flown}
        ends = moved if link is None else link.circles
        twin.step(link, moved, after, {i: self._truth.after(i, self._steps) for i in ends}, radii)

    def _compare(self, held: Deviations, done: int) -> None:
        """Each circle's bound against the hull; after a block, the box too, along each of its edges."""
        twin, errors = self._twins[id(held)][1], held.errors
        with ball.precision(MATRIX_BITS):
            unit, scale = arb(held.unit), arb((1, errors.shift))
            for i, place in held.place.items():
                x, y, vx, vy = twin.hull(i)
                self._hold(x.max(y), arb(errors.bounds.place[place]) * scale, f"the place of circle {i}", done)
                self._hold(unit * vx.max(vy), arb(errors.bounds.pace[place]) * scale, f"circle {i}'s velocity", done)
            if self._ended:
                along = twin.along(arb_mat(errors._basis.tolist()), list(held.place), held.unit)
                box = [arb(edge) * scale for edge in errors._box.tolist()]
                shares = [self._hold(*both, f"edge {k}", done) for k, both in enumerate(zip(along, box, strict=True))]
                self._note(-log2(max(shares)))
        self._ended = False

    def _hold(self, least: arb, bound: arb, of: str, done: int) -> float:
        """Holds a bound against what it must be at least; gives the share."""
        self.tally.bounds += 1
        if not least.is_finite():
            self._fault(f"after {done} steps the hull of {of} is not to be had")
        elif least.lower() > bound:
            self._fault(f"after {done} steps the bound of {of} is {bound.str(9)}, less than {least.str(9)}")
        share = float((least / bound).mid())
        self.tally.tightest = max(self.tally.tightest, share)
        return share

    def _note(self, loose: float) -> None:
        """By how many bits the box is too large where it is least so."""
        if self._loose is None:
            self.tally.first.append(loose)
        else:
            self.tally.more.append(loose - self._loose)
        self._loose = loose


def watched(
    scene: Scene, events: int, *, long_bits: int, first_bits: int = 256, matrices: bool = False
) -> tuple[Trajectory, Tally]:
    """Runs a scene twice, as the engine does it and with sets from few bits on, watched; and carries out the log in two
    steps for each contact, as a finished run does to give its numbers. Gives the second run.

    Args:
        scene, events: what runs, and how far.
        long_bits: precision from which on there are sets.
        first_bits: of the state at first.
        matrices: see `Watch`.
    """
    plain = ExactEngine().run(scene, events=events)
    watch = Watch(scene, Truth(scene, plain.motion.log.steps), matrices)
    with (
        watch.watching(),
        patch.object(precision, "LONG_BITS", long_bits),
        patch.object(lone_centred, "FALLING_COSTS", 1),
        patch.object(lone_centred, "ROUND_COSTS", 1),
        patch.object(lone_centred, "CLOSING_COSTS", 1),
        patch.object(decider, "FIRST_BITS", first_bits),
        patch.object(refinable, "FIELD_BITS", FEWEST_BITS),
    ):
        run = ExactEngine().run(scene, events=events)
        watch.carry_out(run.motion.log.steps, int(run.plan["bits"]))
    if [event.contacts for event in run.events] != [event.contacts for event in plain.events]:
        watch.tally.faults.append("the history is another with sets")
    return run, watch.tally


def watched_wide(scene: Scene, events: int, *, at_once: bool, wide: int = -300) -> Tally:
    """Carries out the log of a run from numbers known to 2**wide, with 1,000 bits: roundings are nothing beside what
    derivatives make of that.

    Args:
        scene, events: what runs, and how far.
        at_once: whether contacts are carried out in one go.
        wide: see `Watch.carry_out`.
    """
    steps = ExactEngine().run(scene, events=events).motion.log.steps
    watch = Watch(scene, Truth(scene, steps), True)
    with watch.watching():
        watch.carry_out(steps, 1_000, wide, at_once)
    return watch.tally
