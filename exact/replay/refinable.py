"""The exact engine's state: each body in its field while that is short, in balls from then on.

A body is *exact* while its position, velocity and clock lie in the field of the scene (rationals, or the roots in
the scene's own numbers) and are short; else it is held in balls of `bits` bits. Every step carried out is logged,
so the balls can be computed again with more bits: that is how precision rises.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from typing import Any, TypeAlias

from flint import arb

from ...scenarios.scene import Scene
from ..numbers import ball
from ..numbers.ball import Field, FieldNumber, LeavesField, field_ball, height
from .centred_state import CentredState, lone_contacts
from .contact import Body, Flight, Link, Touch, can_push, is_pair
from .landings import Unsharp
from .state import Flights, Flip, Go, Kick, Lift, ReplayState, Settle, Step, Take, circles_of

FIELD_BITS = 768
"""Longest exact numbers kept. Rationals of this length cost about as much as balls; Galperin's, which grow by 27
bits a collision, would soon cost far more."""

Projection: TypeAlias = tuple[tuple[FieldNumber, ...], tuple[FieldNumber, FieldNumber]]
"""A linear part (a, b, c, d), which is its own square, about a centre: in exact numbers."""


class RefinableState:
    """Fields and balls side by side, under one log.

    Attributes:
        balls: the state in balls; a body that is exact is copied into it when asked for (`sync`).
        field: the state in the scene's field, of the bodies that are exact.
        exact: for each body, whether it is exact.
        steps: the log.
        held: tells, after a round of impulses, what is known to hold a circle to a line or a point.
        lone: carries out contacts that stand alone.
        lowest: the worst accuracy in bits of any event time since the last rise.
        length: bits of the longest number of the step carried out last, a whole number in the field or a ball.
    """

    def __init__(self, scene: Scene, bits: int) -> None:
        self.scene = scene
        self.n = len(scene.circles)
        self.bits = bits
        self.steps: list[Step] = []
        self._in_field = bytearray()
        self._left: dict[int, list[tuple[int, Flight[FieldNumber]]]] = {}
        self._stale = set(range(self.n))
        self.numbers = Field()
        ball.use_bits(bits)
        self.balls = CentredState(scene, centred=False)
        self.bodies = self.balls.bodies
        self.lone = lone_contacts(self.balls)
        self.lowest = bits
        self.length = bits
        self.held: Callable[[int], Projection | None] | None = None
        self._projected: dict[int, list[tuple[int, Projection]]] = {}
        self._tried = bytearray()
        self._touched: dict[int, dict[int, tuple[int, Mapping[Link, int]]]] = {}
        for body in self.bodies.values():
            body.acc = bits
        try:
            self.field: ReplayState[FieldNumber] | None = ReplayState(scene, self.numbers)
            self._admit_walls()
            self.numbers.tower.max_depth = self.numbers.tower.depth
            self.exact = [True] * self.n
            self.balls.outside.update(range(self.n))
            if self.numbers.tower.depth == 0:
                self._stale.clear()  # what is rational is the same in the balls already
        except LeavesField:
            self.field = None
            self.exact = [False] * self.n
            self._stale.clear()
        self._in_play = sum(self.exact)

    def _admit_walls(self) -> None:
        """Lets the walls' numbers, with their lengths, into the field before it is closed."""
        for wall in self.scene.walls:
            nx, ny = wall.normal
            for number in (wall.x0, wall.y0, nx, ny):
                self.numbers.constant(number)
            if wall.moves:
                for number in (wall.vx, wall.vy):
                    self.numbers.constant(number)
            with suppress(LeavesField):
                self.numbers.constant((nx * nx + ny * ny).sqrt())

    @property
    def flip_time(self) -> arb:
        """The moment of the reversal, as a ball."""
        return self.balls.flip_time

    def all_exact(self, bodies: tuple[int, ...]) -> bool:
        """Whether all of these bodies are exact."""
        return self._in_play > 0 and not [i for i in bodies if not self.exact[i]]

    # -- copies

    def sync_for(self, bodies: Iterable[Body[arb]]) -> None:
        """Brings the ball copies of some bodies up to date, at full precision."""
        if self._stale:
            ball.use_bits(self.bits)
            self.sync(tuple(body.index for body in bodies if not body.is_pocket))

    def sync(self, bodies: tuple[int, ...]) -> None:
        """Brings the ball copies of exact bodies up to date."""
        for i in bodies:
            if i in self._stale:
                self._copy(i)
                self._stale.discard(i)

    def _copy(self, i: int) -> None:
        assert self.field is not None
        bits = ball.bits_in_use()
        _enter(self.balls.bodies[i], self.field.bodies[i].flight, bits)

    def flight(self, i: int) -> Flight[FieldNumber] | Flight[arb]:
        """How a circle flies: in exact numbers if it is exact, else in balls."""
        if self.field is not None and self.exact[i]:
            return self.field.bodies[i].flight
        return self.balls.bodies[i].flight

    def _leave(self, i: int) -> None:
        """The body's exact life ends here; the log keeps its last exact state."""
        self.sync((i,))
        self.exact[i] = False
        self.balls.outside.discard(i)
        self._in_play -= 1
        assert self.field is not None
        self._left.setdefault(len(self.steps), []).append((i, self.field.bodies[i].flight))

    # -- steps

    def do(self, step: Step) -> None:
        """Carries out one step, in the field if its bodies stay there, and logs it."""
        taking_part = circles_of(step, self.n)
        in_field = self._in_play > 0 and self.all_exact(taking_part) and self._try_field(step, taking_part)
        if not in_field:
            if self._in_play:
                for i in taking_part:
                    if self.exact[i]:
                        self._leave(i)
            self.balls.steps_done = len(self.steps)
            self.length = self.bits
            self.lowest = min(self.lowest, self._step_in_balls(self.balls, step, taking_part, self.bits))
        self._carry(step, self.balls if in_field else self.field)
        self.steps.append(step)
        self._in_field.append(in_field)
        if self.held is not None and not in_field and isinstance(step, Kick):
            self._hold(taking_part)

    def _carry(self, step: Step, other: Flights[Any] | None) -> None:
        """Notes in a state that has not carried out a step whom it leaves standing, or carried by a wall."""
        if other is None or other.falling is None or not isinstance(step, Settle | Lift | Take):
            return
        other.pegs = other.pegs - {step.body} if isinstance(step, Lift) else other.pegs | {step.body}
        if isinstance(step, Settle) and step.other < 0 and not other.sides.level(step.wall):
            other.slopes = {**other.slopes, step.body: step.wall}

    def strike(self, link: Touch, steps: tuple[Go, Kick]) -> bool:
        """Carries out the two steps of a contact alone in one go, and logs them, if that can be done.

        Args:
            link: the contact.
            steps: to it, and its impulse.
        """
        self._tried += bytes(len(self.steps) + 1 - len(self._tried))
        self._tried[len(self.steps)] = True
        pegs = self.scene.pegs
        if self.balls.stands and is_pair(link) and self.balls.on_peg(link) and pegs.isdisjoint(link):
            return False
        if self._in_play and not self._all_leave(link):
            return False
        accuracy = self.lone.strike(link, self.bits, len(self.steps))
        if accuracy is None:
            return False
        self.lowest = min(self.lowest, accuracy)
        self.steps += steps
        self._in_field += bytes(2)
        if self.held is not None:
            self._hold(link.circles)
        return True

    def _all_leave(self, link: Touch) -> bool:
        """Ends the exact lives of those of a contact's bodies that have one; False, and nothing done, where it may be
        exact itself."""
        bodies = link.circles
        exact = [i for i in bodies if self.exact[i]]
        if len(exact) == len(bodies):
            if self.field is None or self.numbers.tower.depth or not is_pair(link):
                return False
            if self.field.stands and self.field.on_peg(link):
                return False
            if not self.numbers.leaves(self.field.discriminant(link)):
                return False
        ball.use_bits(self.bits)
        for i in exact:
            self._leave(i)
        return True

    def _hold(self, bodies: tuple[int, ...]) -> None:
        """Puts circles that something is known to hold to a line or a point there."""
        assert self.held is not None
        found = [(i, projection) for i in bodies if (projection := self.held(i)) is not None]
        if found:
            self._projected[len(self.steps)] = found
            _project_all(self.balls, found)

    def _try_field(self, step: Step, taking_part: tuple[int, ...]) -> bool:
        state = self.field
        assert state is not None
        state.steps_done = len(self.steps)
        try:
            state.do(step)
        except LeavesField:
            return False
        longest = 0
        for i in taking_part:
            body = state.bodies[i]
            x, y, vx, vy, t, *_ = body.flight
            longest = max(longest, height(x), height(y), height(vx), height(vy), height(t))
            if isinstance(step, Kick):
                body.flight = body.flight._replace(rest=vx == 0 and vy == 0)
        if isinstance(step, Go):
            self.balls.forget_contact()
        self._stale.update(taking_part)
        if state.stands:
            touched = {i: state.contacts[i] for i in taking_part if i in state.contacts}
            self._touched[len(self.steps)] = touched
            self.balls.contacts.update(touched)
        if isinstance(step, Flip):
            self.sync(taking_part)
            self.balls.flip_time = field_ball(state.flip_time, ball.bits_in_use())
        self.length = longest
        if longest > FIELD_BITS and isinstance(step, Kick):
            self.steps.append(step)
            for i in taking_part:
                self._leave(i)
            self.steps.pop()
        return True

    def _step_in_balls(self, state: CentredState, step: Step, taking_part: tuple[int, ...], bits: int) -> int:
        """One step, with no more bits than the bodies' accuracy deserves; gives the accuracy after it."""
        bodies = state.bodies
        accuracy = bits
        if type(step) is Go:
            worst = min([bodies[i].acc for i in taking_part if not bodies[i].flight.rest], default=bits)
            ball.use_bits(min(bits, worst + state.spare))
            try:
                state.do(step)
            except ZeroDivisionError:  # two all but graze: when they meet was told with all bits that there are
                if state.centred:  # where flights may be their centres by now
                    raise
                state.steps_done -= 1  # nothing else has been done
                ball.use_bits(bits)
                state.do(step)
            if taking_part:
                accuracy = max(0, min(bits, state.instant.rel_accuracy_bits()))
                for i in step.bodies:
                    bodies[i].acc = accuracy
        else:
            state.do(step)
            if isinstance(step, Kick):
                for i in taking_part:
                    flight = bodies[i].flight
                    rest = flight.vx.is_zero() and flight.vy.is_zero()
                    if rest is not flight.rest:
                        bodies[i].flight = flight._replace(rest=rest)
                if state.steps_done in self._projected:
                    _project_all(state, self._projected[state.steps_done])
        return accuracy

    # -- precision

    @property
    def centred(self) -> bool:
        """Whether the balls keep their deviations in a set."""
        return self.balls.centred

    def rise(self, bits: int, centred: bool = False) -> None:
        """Computes the balls again with `bits` bits, from the log; `centred` or not (see `CentredState`)."""
        self.bits = bits
        self.lowest = bits
        ball.use_bits(bits)
        state = CentredState(self.scene, centred)
        for body in state.bodies.values():
            body.acc = bits
        if self.field is not None:
            state.outside.update(range(self.n))
        lone = lone_contacts(state)
        k, count = 0, len(self.steps)
        while k < count:
            if k in self._left:
                self._arrive(state, k)
            link = self._alone(k)
            accuracy = None if link is None else lone.strike(link, bits, k)
            if accuracy is not None:
                self.lowest = min(self.lowest, accuracy)
                k += 2
                if k in self._projected:
                    ball.use_bits(bits)
                    _project_all(state, self._projected[k])
                continue
            ball.use_bits(bits)
            self._again(state, k, bits)
            k += 1
        ball.use_bits(bits)
        if len(self.steps) in self._left:
            self._arrive(state, len(self.steps))
        if self.field is not None and any(isinstance(step, Flip) for step in self.steps):
            last = next(k for k, step in enumerate(self.steps) if isinstance(step, Flip))
            if self._in_field[last]:
                state.flip_time = field_ball(self.field.flip_time, bits)
        self.balls.become(state)
        self.lone = lone_contacts(self.balls)
        self._stale = {i for i in range(self.n) if self.exact[i]}
        self.sync(tuple(self._stale))

    def _alone(self, k: int) -> Touch | None:
        """The contact of steps k and k + 1, where they were tried in one go, and carried out in balls; else None."""
        if k >= len(self._tried) or not self._tried[k] or self._in_field[k] or k + 1 in self._left:
            return None
        step = self.steps[k]
        assert isinstance(step, Go)
        assert isinstance(step.source, tuple)
        assert can_push(step.source)
        return step.source

    def _again(self, state: CentredState, k: int, bits: int) -> None:
        """Step k of a replay."""
        step = self.steps[k]
        state.contacts.update(self._touched.get(k, {}))
        if not self._in_field[k]:
            state.steps_done = k
            self.lowest = min(self.lowest, self._step_in_balls(state, step, circles_of(step, self.n), bits))
        elif isinstance(step, Go):
            state.forget_contact()
        elif isinstance(step, Flip):
            state.flip_time = self.balls.flip_time
        else:
            self._carry(step, state)

    def _arrive(self, state: CentredState, k: int) -> None:
        """Bodies whose exact life ended before step k enter the balls of a replay."""
        bits = ball.bits_in_use()
        for i, flight in self._left[k]:
            _enter(state.bodies[i], flight, bits)
            state.outside.discard(i)


def rises_in_sets(state: RefinableState, bits: int, most: int) -> bool:
    """Computes a state's balls again in sets (see `RefinableState.rise`); whether so many bits are lost, at most."""
    try:
        state.rise(bits, centred=True)
    except Unsharp:  # so much is lost that it is not told any more which zero of a quartic a step of the log is
        return False
    return state.bits - state.lowest <= most


def _project_all(state: CentredState, held: Iterable[tuple[int, Projection]]) -> None:
    """A circle on a mirror line, or at a centre of rotation, stays there: exactly, whatever the balls say."""
    state.loosen()
    bits = ball.bits_in_use()
    for i, ((a, b, c, d), (cx, cy)) in held:
        a, b, c, d, cx, cy = (field_ball(value, bits) for value in (a, b, c, d, cx, cy))
        body = state.bodies[i]
        x, y, vx, vy, t, instant, late, last, _ = body.flight
        x, y = x - cx, y - cy
        x, y, vx, vy = cx + a * x + b * y, cy + c * x + d * y, a * vx + b * vy, c * vx + d * vy
        body.flight = Flight(x, y, vx, vy, t, instant, late, last, vx.is_zero() and vy.is_zero())


def _enter(body: Body[arb], exact: Flight[FieldNumber], bits: int) -> None:
    """Gives a body in balls the flight that it has in exact numbers, whose clock is its instant."""
    x, y, vx, vy, t, _, _, last, rest = exact
    x, y, vx, vy, t = (field_ball(value, bits) for value in (x, y, vx, vy, t))
    body.flight = Flight(x, y, vx, vy, t, t, None, last, rest)
    body.acc = bits
