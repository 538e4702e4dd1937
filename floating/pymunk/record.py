"""What is kept of a run in pymunk: an event a step with impulses, a knot for each body that it touched."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import pymunk

from ...scenarios.numbers.precision import Double
from ...scenarios.scene import Scene
from ...scenarios.trajectory import Contact, Event, Tie, TieProof
from ..knots import DoubleKnot
from .space import PymunkSpace


class Recorder:
    """The events and knots of a run, taken down step by step.

    Attributes:
        touched: the pairs that overlap in the step just made, as places in `scene.ids`; empty after `step`.
        settling: circles that an overlap's correction moves once more in the step to come; empty unless the
            space corrects overlaps.
        failures: what was raised while pymunk reported a contact. C code in between prints an exception and
            goes on, so it is kept here for the run to raise.
        events, knots: as in the trajectory.
        contact_steps: number of steps in which something touched.
        resting_contacts: number of times that a pair overlapped without an impulse.
    """

    def __init__(self, scene: Scene, world: PymunkSpace) -> None:
        self.touched: list[tuple[int, int]] = []
        self.settling: set[int] = set()
        self.failures: list[BaseException] = []
        self.events: list[Event] = []
        self.knots: list[list[DoubleKnot]] = [
            [(0.0, body.position.x, body.position.y, body.velocity.x, body.velocity.y)] for body in world.bodies
        ]
        self.contact_steps = self.resting_contacts = 0
        self._pushed: list[tuple[int, int]] = []
        self._world = world
        self._corrects = world.space.collision_bias < 1
        self._ids = scene.ids
        self._moving = {
            place: (body, self.knots[place])
            for place, body in enumerate(world.bodies)
            if body.body_type == pymunk.Body.DYNAMIC
        }
        self._singles: dict[tuple[int, int], tuple[Contact]] = {}
        self._listen()

    def _listen(self) -> None:
        """Has pymunk report every pair that overlaps in a step, once its impulse is known."""
        places, touched, pushed, failures = self._world.places, self.touched, self._pushed, self.failures

        def after_contact(arbiter: pymunk.Arbiter, space: pymunk.Space, data: Any) -> None:
            try:
                first, second = arbiter.shapes
                i, j = places[first], places[second]
                pair = (i, j) if i < j else (j, i)
                if arbiter.total_impulse != (0.0, 0.0):
                    pushed.append(pair)
                touched.append(pair)
            except BaseException as error:
                failures.append(error)

        self._world.space.on_collision(post_solve=after_contact)

    def tie_knots(self, time: float) -> None:
        """Notes where every circle is and how it goes on."""
        self._tie(time, self._moving, all_of_them=True)

    def _tie(self, time: float, places: Iterable[int], all_of_them: bool) -> None:
        """A knot for all of the circles at these places, or only for those whose velocity has changed."""
        moving = self._moving
        for place in places:
            if place in moving:
                body, knots = moving[place]
                vx, vy = body.velocity
                if all_of_them or knots[-1][3:] != (vx, vy):
                    x, y = body.position
                    knots.append((time, x, y, vx, vy))

    def step(self, time: float) -> bool:
        """Notes what the step that ended at `time` did; whether that was an event."""
        touched, pushed = self.touched, self._pushed
        collided = bool(pushed)
        if len(touched) == 1 and not self._corrects:
            self._tie(time, touched[0], all_of_them=False)
        else:
            places = {place for pair in touched for place in pair}
            self._tie(time, places | self.settling, all_of_them=self._corrects)
            self.settling.clear()
            if self._corrects:
                self.settling.update(places)
        if len(pushed) == 1:
            contacts = self._single(pushed[0])
            self.events.append(Event(len(self.events), Double(time), contacts, contacts))
        elif pushed:
            self.events.append(self._several(time))
        self.contact_steps += bool(touched)
        self.resting_contacts += len(touched) - len(pushed)
        touched.clear()
        pushed.clear()
        return collided

    def raise_failure(self) -> None:
        """Raises what a report of a contact raised, if one did."""
        if self.failures:
            raise self.failures[0]

    def _single(self, pair: tuple[int, int]) -> tuple[Contact]:
        contact = self._singles.get(pair)
        if contact is None:
            contact = self._singles[pair] = (Contact(self._ids[pair[0]], self._ids[pair[1]]),)
        return contact

    def _several(self, time: float) -> Event:
        pairs = sorted(self._pushed)
        impulses = tuple(self._single(pair)[0] for pair in self._pushed)
        contacts = tuple(self._single(pair)[0] for pair in pairs)
        tie = Tie(contacts, TieProof.FLOAT)
        return Event(len(self.events), Double(time), contacts, impulses, (tie,), self._coupled(pairs))

    def _coupled(self, pairs: list[tuple[int, int]]) -> bool:
        """Whether a moving circle has two of the contacts, not at right angles in pymunk's own numbers."""
        normals: dict[int, list[tuple[float, float]]] = {}
        for pair in pairs:
            nx, ny = self._normal(pair)
            for place in self._moving.keys() & pair:
                others = normals.setdefault(place, [])
                if any(nx * ox + ny * oy != 0 for ox, oy in others):
                    return True
                others.append((nx, ny))
        return False

    def _normal(self, pair: tuple[int, int]) -> tuple[float, float]:
        first, second = pair
        bodies = self._world.bodies
        if second >= len(bodies):
            nx, ny, _ = self._world.walls[second - len(bodies)]
            return nx, ny
        return bodies[second].position - bodies[first].position
