"""What lies on a wall in an engine of steps: there a solver pushes in every step, and that is no collision."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from itertools import combinations

from ..scenarios.numbers.precision import Double
from ..scenarios.scene import Scene
from ..scenarios.trajectory import Settling

# -- A solver takes from what lies on a wall, in each step, the speed that gravity gives it in that step, g dt. It
# cannot tell a slower approach from rest. So a contact with a wall or a face to which gravity pulls a circle is no
# collision where the circle came to it, before the step's own g dt, no faster than that; or, where it lies there
# already, than twice that: what a bounce of the first leaves may come back a step's g dt faster. It is one of the
# contacts of a collision where something else hits the circle at that step, and presses it to the wall by more than
# lying there would take. Two circles that have pushed each other just before, and come to each other no faster than by
# what gravity gives along their line of centres, and rounding, still touch, as where one pushes another along a floor.
# Two walls that hold a circle between them bear each a share of g dt, and a solver that pushes one after the other
# gives more: a contact with one of them counts as one across gravity would.

ROUNDED = 1 + 2.0**-20
"""By what factor rounding, and what a solver leaves undone, may raise a speed."""

NEXT = 2.0**-40
"""A share of a speed by which rounding may change it while a circle lies still, or slides along a wall."""

HOPS = 8
"""Steps after which a circle that was not pushed has left its wall: one that is let bounce there hops for a few."""

SLANT = 2.0**-20
"""Share of gravity that each of two walls must bear to hold a circle between them: less is rounding of normals."""

Indices = tuple[int, int]
"""Two things by their places in `scene.ids`: a wall, a segment or a polygon is last."""


class Resting:
    """What lies on walls and faces in a run that goes by time steps.

    Args:
        scene: what runs.
        dt: the time step.

    Attributes:
        settlings: where circles came to lie on something, in order.
    """

    def __init__(self, scene: Scene, dt: float) -> None:
        self.settlings: list[Settling] = []
        self._dt, self._count, self._ids = dt, len(scene.circles), scene.ids
        self._gravity = (0.0, 0.0) if scene.gravity is None else (float(scene.gravity[0]), float(scene.gravity[1]))
        self._e = float(scene.restitution)
        self._shares = [float(circle.inverse_mass) for circle in scene.circles]
        self._between: set[int] = set()  # circles that two walls hold between them
        self._lying: dict[int, list[float]] = {}  # by circle: the wall's place, since when, when last pushed there
        self._spans: dict[int, list[tuple[float, float]]] = {}
        self._bounced: dict[int, tuple[int, float]] = {}
        self._pushed: dict[Indices, float] = {}
        self._held: tuple[list[Indices], dict[int, tuple[float, float]]] | None = None
        self._level = {
            place
            for place, wall in enumerate(scene.walls, self._count)
            if scene.gravity is not None and all(part.sign() == 0 for part in wall.along(*scene.gravity))
        }

    def collisions(
        self,
        time: float,
        pairs: Iterable[Indices],
        before: Callable[[int], tuple[float, float]],
        after: Callable[[int], tuple[float, float]],
        normal: Callable[[Indices], tuple[float, float]],
        impulse: Callable[[Indices], float],
    ) -> list[Indices]:
        """Those contacts of a step that are collisions.

        Args:
            time: of the step's end.
            pairs: who was pushed in it.
            before: the velocity of a circle with the step's gravity, without its impulses.
            after: the velocity at the end of the step.
            normal: the direction of a contact, of length 1, to its first circle.
            impulse: how strong a contact's is.

        >>> from truebreak.scenarios import Circle, Scene, Wall
        >>> floor = Scene([Circle(0, 1)], [Wall(0, 0, 1, 0)], gravity=(0, -10), settle=True)
        >>> resting = Resting(floor, 1 / 100)
        >>> for speed in (-0.1, -0.4):  # what gravity gives in a step; four times that
        ...     resting.collisions(
        ...         1.0, [(0, 1)], lambda _: (0.0, speed), lambda _: (0.0, 0.0), lambda _: (0.0, 1.0), lambda _: -speed
        ...     )
        []
        [(0, 1)]
        """
        pairs, self._held = list(pairs), None
        still: dict[Indices, tuple[float, float]] = {}
        cradles = self._cradles(pairs, normal)
        for pair in pairs:
            k, wall = pair
            if wall >= self._count:
                nx, ny = normal(pair)
                (vx, vy), (gx, gy) = before(k), self._gravity
                pull, approach = -(nx * gx + ny * gy) * self._dt, -(nx * vx + ny * vy)
                lying = self._lying.get(k)
                hops = lying is not None and lying[0] == wall and time - lying[2] <= HOPS * self._dt
                if wall in cradles.get(k, ()):
                    pull = math.hypot(gx, gy) * self._dt
                if pull > 0.0 and approach <= (3 if hops else 2) * pull * ROUNDED:
                    still[pair] = pull, approach
            elif (room := self._lasts(time, pair, before, normal(pair))) is not None:
                still[pair] = room, room
        self._pushed.update(dict.fromkeys(pairs, time))
        struck = {k for pair in pairs if pair not in still for k in pair}
        found = [
            pair
            for pair in pairs
            if pair not in still
            or (struck & {*pair} and self._pressed(*still[pair], impulse(pair) * self._shares[pair[0]]))
        ]
        for pair in pairs:
            k, wall = pair
            if wall < self._count:
                continue
            nx, ny = normal(pair)
            (ux, uy), (gx, gy) = after(k), self._gravity
            pull = -(nx * gx + ny * gy) * self._dt
            if pair in found:
                self._bounced[k] = wall, time
            if pull > 0.0 and nx * ux + ny * uy <= pull * ROUNDED:
                known = self._lying.get(k)
                if known is None or known[0] == wall or (k, known[0]) not in pairs:  # of two it keeps the first
                    both = cradles.get(k, ())
                    held = wall in both and all((k, other) not in found for other in both)
                    self._lies(k, wall, time, next((other for other in both if held and other != wall), None))
            elif pair in found:
                self._leaves(k)
        for k in struck - {k for k, wall in pairs if wall >= self._count}:
            self._bounced.pop(k, None)
        if not found and all(k in self._lying for k, _ in pairs):
            self._held = pairs, {k: after(k) for pair in pairs for k in pair if k < self._count}
        return found

    def holds(self, time: float, pairs: Sequence[Indices] | None, after: Callable[[int], tuple[float, float]]) -> bool:
        """Whether a step is as the one before: the same contacts, none a collision, and the same velocities.

        Then nothing has to be told of it: what lies on something goes straight on while it is pushed there. Without
        `pairs` the contacts are known to be the same.
        """
        if self._held is None or (pairs is not None and self._held[0] != pairs):
            return False
        room = NEXT * math.hypot(*self._gravity) * self._dt
        for k, (vx, vy) in self._held[1].items():
            ux, uy = after(k)
            if abs(ux - vx) + abs(uy - vy) > room + NEXT * (abs(vx) + abs(vy)):
                return False
        for k, _ in self._held[0]:
            self._lying[k][2] = time
        self._pushed.update(dict.fromkeys(self._held[0], time))
        return True

    def pushed(self, k: int, since: float) -> float:
        """Up to when a circle, as it lies on something, has gone straight on since a time; that where it does not."""
        lying = self._lying.get(k)
        return since if lying is None or since < lying[1] else max(since, lying[2])

    def _lasts(
        self, time: float, pair: Indices, before: Callable[[int], tuple[float, float]], line: tuple[float, float]
    ) -> float | None:
        """How fast two circles that touch since a step before may come to each other; None of two that hit anew."""
        if time - self._pushed.get(pair, -math.inf) > HOPS * self._dt:
            return None
        (nx, ny), (gx, gy), (vx, vy), (ux, uy) = line, self._gravity, *map(before, pair)
        room = self.room((math.hypot(vx, vy), math.hypot(ux, uy)))
        room += 2 * abs(nx * gx + ny * gy) * self._dt
        return room if nx * (ux - vx) + ny * (uy - vy) <= room else None

    def _pressed(self, pull: float, approach: float, gain: float) -> bool:
        """Whether a wall gives a circle more speed than it takes to lie or bounce there, by more than a step's."""
        return gain > (1 + self._e) * max(approach, pull) + pull

    def _cradles(
        self, pairs: Iterable[Indices], normal: Callable[[Indices], tuple[float, float]]
    ) -> dict[int, tuple[int, int]]:
        """For each circle that two walls push, which hold it between them: those."""
        walls: dict[int, list[int]] = {}
        for k, wall in pairs:
            if wall >= self._count:
                walls.setdefault(k, []).append(wall)
        (gx, gy), found = self._gravity, dict[int, tuple[int, int]]()
        least = SLANT * math.hypot(gx, gy)
        for k, row in walls.items():
            for one, other in combinations(row, 2):
                (ax, ay), (bx, by) = normal((k, one)), normal((k, other))
                turn = ax * by - ay * bx
                if turn and min((gy * bx - gx * by) / turn, (gx * ay - gy * ax) / turn) > least:
                    found[k] = one, other
        return found

    def _lies(self, k: int, wall: int, time: float, other: int | None) -> None:
        lying = self._lying.get(k)
        if lying is not None and lying[0] == wall and (other is None or k in self._between):
            lying[2] = time
            return
        if other is not None and lying is not None and lying[0] in (wall, other):  # it comes to be held where it lies
            place = max(n for n, rest in enumerate(self.settlings) if rest.circle == self._ids[k])
            ids = sorted((self._ids[wall], self._ids[other]), key=self.settlings[place].wall.__ne__)
            self.settlings[place] = replace(self.settlings[place], other=ids[1])
            lying[2] = time
            self._between.add(k)
            return
        self._leaves(k)
        bounced = self._bounced.get(k)
        since = None if bounced is None or bounced[0] not in (wall, other) or not self._e else Double(bounced[1])
        name = None if other is None else self._ids[other]
        self.settlings.append(Settling(self._ids[k], self._ids[wall], Double(time), since, name))
        self._lying[k] = [wall, time, time]
        if other is not None:
            self._between.add(k)

    def _leaves(self, k: int) -> None:
        self._between.discard(k)
        lying = self._lying.pop(k, None)
        if lying is not None:
            self._spans.setdefault(k, []).append((lying[1], lying[2]))

    def room(self, speeds: Iterable[float]) -> float:
        """How fast two may come to each other by what a solver leaves of rest: a share of the greatest speed."""
        return (ROUNDED - 1) * max(math.hypot(*self._gravity) * self._dt, *speeds)

    def all_lie(self, time: float) -> bool:
        """Whether every circle that moves lies on a level wall, which has no end, or between two that hold it."""
        return all(
            share == 0.0 or ((lying := self._lying.get(k)) is not None and self._stays(k, lying, time))
            for k, share in enumerate(self._shares)
        )

    def _stays(self, k: int, lying: Sequence[float], time: float) -> bool:
        return (lying[0] in self._level or k in self._between) and time - lying[2] <= HOPS * self._dt

    def stays(self) -> None:
        """Nothing happens any more: what lies now does so for ever."""
        for lying in self._lying.values():
            lying[2] = math.inf

    def spans(self, end: float) -> Mapping[int, Sequence[tuple[float, float]]]:
        """From when to when each circle lies on something, up to the end of a run; to infinity if it does so then."""
        found = {k: list(row) for k, row in self._spans.items()}
        for k, (_, since, pushed) in self._lying.items():
            found.setdefault(k, []).append((since, math.inf if end - pushed <= HOPS * self._dt else pushed))
        return found
