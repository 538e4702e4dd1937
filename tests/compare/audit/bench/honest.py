"""Honest engines, each in a formulation of its own: whatever they do wrong is rounding, or their step.

All are written for any number type (`worlds.Numbers`). An engine of events is a `go_on` from a world to the next one,
which says what it reports; `play` hands the reports to a `Recording`.
"""

from __future__ import annotations

import heapq
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from truebreak.compare.foreign import RecordedEngine

from .worlds import F32, F64, LONG, Numbers, Told, World

FOLLOWS = frozenset({"wall", "pocket", "reverse_after"})


class Events(RecordedEngine):
    """Doubles, every pair at every event, t = (-b - sqrt(b^2 - ac))/a; only the two that collide are told.

    Times are absolute, a flight lasts from the one to the next.
    """

    name = "naive"
    bits = 53
    scene_keys = FOLLOWS
    numbers: Numbers = F64
    tells = "pair"

    # -- the loop

    def world(self, scene: Any) -> World:
        """What the engine starts from."""
        return World(scene, self.numbers)

    def play(self, scene: Any, recording: Any) -> None:
        """Plays a scene; see `RecordedEngine`."""
        world = self.world(scene)
        with np.errstate(all="ignore"):
            while recording.open:
                told = self.go_on(world, self.numbers)
                if told is None:
                    return
                for time, pairs, states in told:
                    if recording.open:
                        given = states and {key: tuple(map(float, row)) for key, row in states.items()}
                        recording.hits(float(time), list(pairs), given)

    def go_on(self, w: World, n: Numbers) -> list[Told] | None:
        """From one contact to just after the next; None if there is none."""
        found = self.next_contact(w, n)
        if found is None:
            return None
        wait, i, j = found
        self.fly(w, wait)
        self.collide(w, n, i, j)
        w.count += 1
        told = self.report(w, i, j)
        if w.turn == w.count:
            self.turn_back(w)
        return told

    def next_contact(self, w: World, n: Numbers) -> tuple[Any, int, int] | None:
        """How long until the next contact, and of which two (a wall comes after all circles)."""
        best = None
        for i, j in self.pairs(w):
            wait = self.meets(w, n, i, j)
            if wait is not None and (best is None or wait < best[0]):
                best = (wait, i, j)
        return best

    def pairs(self, w: World) -> Iterator[tuple[int, int]]:
        """All that can ever collide, in the order of asking."""
        moving = [k for k in range(w.n) if w.w[k] > 0]
        for i in range(w.n):
            for j in range(i + 1, w.n + len(w.walls)) if w.w[i] > 0 else [k for k in moving if k > i]:
                yield i, j

    def meets(self, w: World, n: Numbers, i: int, j: int) -> Any:
        """How long until two collide, or None."""
        if j >= w.n:
            return None if w.w[i] == 0 else self.wall_wait(w, n, i, j - w.n)
        (xi, yi), (xj, yj) = self.place(w, i), self.place(w, j)
        return self.root(n, xj - xi, yj - yi, w.vx[j] - w.vx[i], w.vy[j] - w.vy[i], self.reach(w, i, j))

    def reach(self, w: World, i: int, j: int) -> Any:
        """The distance of the centres at contact."""
        return w.r[i] + w.r[j]

    # -- the formulas

    def root(self, n: Numbers, dx: Any, dy: Any, vx: Any, vy: Any, reach: Any) -> Any:
        """When two meet, by the formula of school."""
        a, b, c = vx * vx + vy * vy, dx * vx + dy * vy, dx * dx + dy * dy - reach * reach
        disc = b * b - a * c
        if not (b < 0 and disc > 0):
            return None
        wait = (-b - n.sqrt(disc)) / a
        return wait if wait > 0 else wait * 0

    def wall_wait(self, w: World, n: Numbers, i: int, k: int) -> Any:
        """When a circle meets a wall."""
        wall, side = w.walls[k], w.sides[i][k]
        x, y = self.place(w, i)
        speed = side * (wall.nx * w.vx[i] + wall.ny * w.vy[i])
        if not speed < 0:
            return None
        gap = side * (wall.nx * (x - wall.x) + wall.ny * (y - wall.y)) - w.r[i]
        return gap / -speed if gap > 0 else gap * 0

    def place(self, w: World, k: int) -> tuple[Any, Any]:
        """Where a circle is now."""
        return w.x[k], w.y[k]

    def fly(self, w: World, wait: Any) -> None:
        """All fly on, to a time that is an absolute number."""
        then = w.t + wait
        dt = then - w.t
        for k in range(w.n):
            w.x[k], w.y[k] = w.x[k] + w.vx[k] * dt, w.y[k] + w.vy[k] * dt
        w.t = then

    def collide(self, w: World, n: Numbers, i: int, j: int) -> None:
        """The impulse of two that touch."""
        if j >= w.n:
            self.reflect(w, n, i, j - w.n)
        else:
            self.bounce(w, n, i, j)

    def bounce(self, w: World, n: Numbers, i: int, j: int) -> None:
        """Two circles: the impulse is 2 (d.v)/(d.d)/(wi + wj) d, with no unit vector."""
        (xi, yi), (xj, yj) = self.place(w, i), self.place(w, j)
        dx, dy, vx, vy = xj - xi, yj - yi, w.vx[j] - w.vx[i], w.vy[j] - w.vy[i]
        push = 2 * (dx * vx + dy * vy) / (dx * dx + dy * dy) / (w.w[i] + w.w[j])
        self.kick(w, i, w.w[i] * push * dx, w.w[i] * push * dy)
        self.kick(w, j, -w.w[j] * push * dx, -w.w[j] * push * dy)

    def reflect(self, w: World, n: Numbers, i: int, k: int) -> None:
        """A circle and a wall: v - 2 (v.n) n."""
        wall = w.walls[k]
        speed = 2 * (w.vx[i] * wall.nx + w.vy[i] * wall.ny)
        self.kick(w, i, -speed * wall.nx, -speed * wall.ny)

    def kick(self, w: World, k: int, gx: Any, gy: Any) -> None:
        """The velocity of a circle changes."""
        w.vx[k], w.vy[k] = w.vx[k] + gx, w.vy[k] + gy

    def turn_back(self, w: World) -> None:
        """Every velocity is negated."""
        w.vx, w.vy = [-v for v in w.vx], [-v for v in w.vy]

    def report(self, w: World, i: int, j: int) -> list[Told]:
        """What is told of a contact."""
        pair = ((w.ids[i], w.ids[j]),)
        if self.tells == "nothing":
            return [Told(w.t, pair, None)]
        circles = [k for k in range(w.n) if w.m[k] is not None] if self.tells == "all" else [i, j]
        return [Told(w.t, pair, {w.ids[k]: self.row(w, k) for k in circles if k < w.n})]

    def row(self, w: World, k: int) -> tuple[Any, Any, Any, Any]:
        """The state of a circle, as told."""
        return (*self.place(w, k), w.vx[k], w.vy[k])


class Stable(Events):
    """The root without cancellation: the discriminant is a R^2 - (d x v)^2, t = c/(-b + sqrt(disc))."""

    name = "stable"

    def root(self, n: Numbers, dx: Any, dy: Any, vx: Any, vy: Any, reach: Any) -> Any:
        """When two meet."""
        b, cross = dx * vx + dy * vy, dx * vy - dy * vx
        disc = (vx * vx + vy * vy) * (reach * reach) - cross * cross
        if not (b < 0 and disc > 0):
            return None
        far = n.hypot(dx, dy)
        c = (far - reach) * (far + reach)
        return c / (n.sqrt(disc) - b) if c > 0 else c * 0


class Single(Events):
    """The naive formula with every number in 24 bits, and told in them."""

    name = "single"
    bits = 24
    numbers = F32


class SingleStable(Stable):
    """The stable formula in 24 bits."""

    name = "single-stable"
    bits = 24
    numbers = F32


class Angles(Events):
    """Trigonometry: the impact parameter by an angle, velocities turned into the line of centres and back."""

    name = "angles"

    def root(self, n: Numbers, dx: Any, dy: Any, vx: Any, vy: Any, reach: Any) -> Any:
        """When two meet, by the angle between where the other is and where it goes."""
        far, speed = n.hypot(dx, dy), n.hypot(vx, vy)
        if speed == 0:
            return None
        angle = n.atan2(dy, dx) - n.atan2(-vy, -vx)
        along, aside = far * n.cos(angle), abs(far * n.sin(angle))
        if not (along > 0 and aside < reach):
            return None
        wait = (along - n.sqrt((reach - aside) * (reach + aside))) / speed
        return wait if wait > 0 else wait * 0

    def bounce(self, w: World, n: Numbers, i: int, j: int) -> None:
        """Rotate, exchange along one axis, rotate back."""
        angle = n.atan2(w.y[j] - w.y[i], w.x[j] - w.x[i])
        c, s = n.cos(angle), n.sin(angle)
        ui, uj = c * w.vx[i] + s * w.vy[i], c * w.vx[j] + s * w.vy[j]
        ti, tj = c * w.vy[i] - s * w.vx[i], c * w.vy[j] - s * w.vx[j]
        both = w.w[i] + w.w[j]
        ni = ((w.w[j] - w.w[i]) * ui + 2 * w.w[i] * uj) / both
        nj = ((w.w[i] - w.w[j]) * uj + 2 * w.w[j] * ui) / both
        for k, normal, across in ((i, ni, ti), (j, nj, tj)):
            if w.m[k] is not None:
                w.vx[k], w.vy[k] = c * normal - s * across, s * normal + c * across


class CentreOfMass(Stable):
    """In the frame of the pair's centre of mass an impact only mirrors."""

    name = "centre-of-mass"

    def bounce(self, w: World, n: Numbers, i: int, j: int) -> None:
        """To the frame, mirrored, and back."""
        if w.m[i] is None or w.m[j] is None:
            ux, uy = w.t * 0, w.t * 0  # a fixed circle's frame is the table's
        else:
            both = w.m[i] + w.m[j]
            ux, uy = (w.m[i] * w.vx[i] + w.m[j] * w.vx[j]) / both, (w.m[i] * w.vy[i] + w.m[j] * w.vy[j]) / both
        dx, dy = w.x[j] - w.x[i], w.y[j] - w.y[i]
        far = n.hypot(dx, dy)
        nx, ny = dx / far, dy / far
        for k in (i, j):
            if w.m[k] is not None:
                rx, ry = w.vx[k] - ux, w.vy[k] - uy
                speed = 2 * (rx * nx + ry * ny)
                w.vx[k], w.vy[k] = ux + (rx - speed * nx), uy + (ry - speed * ny)


class ReducedMass(Events):
    """The impulse by the reduced mass and the normal speed: J = 2 mu (v.n), dv = J/m n."""

    name = "reduced-mass"

    def bounce(self, w: World, n: Numbers, i: int, j: int) -> None:
        """Momentum handed over along a unit vector."""
        dx, dy = w.x[j] - w.x[i], w.y[j] - w.y[i]
        far = n.sqrt(dx * dx + dy * dy)
        nx, ny = dx / far, dy / far
        speed = (w.vx[j] - w.vx[i]) * nx + (w.vy[j] - w.vy[i]) * ny
        mi, mj = w.m[i], w.m[j]
        mu = mj if mi is None else mi if mj is None else mi * mj / (mi + mj)
        impulse = 2 * mu * speed
        if mi is not None:
            self.kick(w, i, impulse / mi * nx, impulse / mi * ny)
        if mj is not None:
            self.kick(w, j, -(impulse / mj * nx), -(impulse / mj * ny))


class Textbook(Stable):
    """The formula of encyclopaedias: v1 - 2 m2/(m1 + m2) <v1 - v2, x1 - x2>/|x1 - x2|^2 (x1 - x2)."""

    name = "textbook"

    def bounce(self, w: World, n: Numbers, i: int, j: int) -> None:
        """Each of the two by the same formula."""
        before = [(w.vx[k], w.vy[k]) for k in (i, j)]
        for k, o, (vx, vy), (ux, uy) in ((i, j, before[0], before[1]), (j, i, before[1], before[0])):
            if w.m[k] is None:
                continue
            share = w.t * 0 + 2 if w.m[o] is None else 2 * w.m[o] / (w.m[k] + w.m[o])
            dx, dy = w.x[k] - w.x[o], w.y[k] - w.y[o]
            part = share * (((vx - ux) * dx + (vy - uy) * dy) / (dx * dx + dy * dy))
            w.vx[k], w.vy[k] = vx - part * dx, vy - part * dy


class AllTold(Stable):
    """All bodies are flown, and told, at every event."""

    name = "all-told"
    tells = "all"


class RelativeTime(Events):
    """Time begins anew at each event; what has passed is summed. Places take the wait, not the summed times."""

    name = "relative-time"

    def fly(self, w: World, wait: Any) -> None:
        """By the wait itself."""
        for k in range(w.n):
            w.x[k], w.y[k] = w.x[k] + w.vx[k] * wait, w.y[k] + w.vy[k] * wait
        w.t = w.t + wait


class AbsoluteTime(Stable):
    """Places are x0 + vx (t - t0), with x0 and t0 those of the body's last impulse: nothing is added up."""

    name = "absolute-time"

    def world(self, scene: Any) -> World:
        """Each body has a time of its own."""
        world = super().world(scene)
        world.more["since"] = [world.t] * world.n
        return world

    def place(self, w: World, k: int) -> tuple[Any, Any]:
        """By the flight since the last impulse."""
        dt = w.t - w.more["since"][k]
        return w.x[k] + w.vx[k] * dt, w.y[k] + w.vy[k] * dt

    def fly(self, w: World, wait: Any) -> None:
        """Only the clock goes on."""
        w.t = w.t + wait

    def collide(self, w: World, n: Numbers, i: int, j: int) -> None:
        """The two are put where they are, and their flights begin anew."""
        for k in (i, j):
            if k < w.n:
                w.x[k], w.y[k] = self.place(w, k)
                w.more["since"][k] = w.t
        super().collide(w, n, i, j)

    def turn_back(self, w: World) -> None:
        """All flights begin anew."""
        for k in range(w.n):
            w.x[k], w.y[k] = self.place(w, k)
            w.more["since"][k] = w.t
        super().turn_back(w)


class Intercept(Events):
    """Each flight is the line x = a + vx t of the absolute time: what is kept is where it would have been at time 0."""

    name = "intercept"

    def place(self, w: World, k: int) -> tuple[Any, Any]:
        """By the line; x and y are where it cuts the axis."""
        return w.x[k] + w.vx[k] * w.t, w.y[k] + w.vy[k] * w.t

    def fly(self, w: World, wait: Any) -> None:
        """Only the clock goes on."""
        w.t = w.t + wait

    def collide(self, w: World, n: Numbers, i: int, j: int) -> None:
        """New lines through where the two are."""
        circles = [k for k in (i, j) if k < w.n]
        places = [self.place(w, k) for k in circles]
        super().collide(w, n, i, j)
        for k, (x, y) in zip(circles, places, strict=True):
            w.x[k], w.y[k] = x - w.vx[k] * w.t, y - w.vy[k] * w.t

    def turn_back(self, w: World) -> None:
        """New lines for all."""
        places = [self.place(w, k) for k in range(w.n)]
        super().turn_back(w)
        for k, (x, y) in enumerate(places):
            w.x[k], w.y[k] = x - w.vx[k] * w.t, y - w.vy[k] * w.t


class Backwards(ReducedMass):
    """Bodies and walls asked in the opposite order, the contact told with its ids the other way round."""

    name = "backwards"

    def pairs(self, w: World) -> Iterator[tuple[int, int]]:
        """The last first."""
        yield from reversed(list(super().pairs(w)))

    def collide(self, w: World, n: Numbers, i: int, j: int) -> None:
        """The second hits the first."""
        super().collide(w, n, *((i, j) if j >= w.n else (j, i)))

    def report(self, w: World, i: int, j: int) -> list[Told]:
        """Ids the other way round."""
        return [Told(t, tuple((b, a) for a, b in pairs), states) for t, pairs, states in super().report(w, i, j)]


class LongDouble(Events):
    """Kept in 64 bits, told in doubles."""

    name = "long-double"
    numbers = LONG


class Householder(Stable):
    """Walls mirror by the matrix 1 - 2 n n^T; walls along an axis by a change of sign."""

    name = "householder"

    def reflect(self, w: World, n: Numbers, i: int, k: int) -> None:
        """The matrix times the velocity."""
        _, _, nx, ny = w.walls[k]
        if nx == 0:
            w.vy[i] = -w.vy[i]
        elif ny == 0:
            w.vx[i] = -w.vx[i]
        else:
            across, vx, vy = -2 * nx * ny, w.vx[i], w.vy[i]
            w.vx[i] = (1 - 2 * nx * nx) * vx + across * vy
            w.vy[i] = across * vx + (1 - 2 * ny * ny) * vy


class Bisected(Events):
    """The time of contact by halving, on the square of the distance; no formula for the root."""

    name = "bisected"

    def root(self, n: Numbers, dx: Any, dy: Any, vx: Any, vy: Any, reach: Any) -> Any:
        """Halves until nothing lies between."""
        b, a = dx * vx + dy * vy, vx * vx + vy * vy
        if not b < 0:
            return None
        low, high = b * 0, -b / a

        def apart(t: Any) -> Any:
            x, y = dx + vx * t, dy + vy * t
            return x * x + y * y - reach * reach

        if apart(low) <= 0:
            return low
        if apart(high) >= 0:
            return None
        for _ in range(1100):
            middle = (low + high) / 2
            if not low < middle < high:
                break
            low, high = (middle, high) if apart(middle) > 0 else (low, middle)
        return high


class LazyQueue(Stable):
    """A queue of predicted contacts, a clock for each body: a body is flown only when it is hit."""

    name = "lazy-queue"

    def world(self, scene: Any) -> World:
        """Everything is predicted once."""
        world = super().world(scene)
        world.more.update(clock=[world.t] * world.n, hits=[0] * world.n, queue=[])
        self.predict(world, self.numbers, list(self.pairs(world)))
        return world

    def predict(self, w: World, n: Numbers, pairs: list[tuple[int, int]]) -> None:
        """Puts into the queue when pairs will meet, as things are."""
        hits = w.more["hits"]
        for i, j in pairs:
            wait = self.meets(w, n, i, j)
            if wait is not None:
                heapq.heappush(w.more["queue"], (w.t + wait, i, j, hits[i], hits[j] if j < w.n else 0))

    def place(self, w: World, k: int) -> tuple[Any, Any]:
        """By its own clock."""
        dt = w.t - w.more["clock"][k]
        return w.x[k] + w.vx[k] * dt, w.y[k] + w.vy[k] * dt

    def stale(self, w: World, entry: Any) -> bool:
        """Whether one of the two has been hit since the contact was predicted."""
        _, i, j, hi, hj = entry
        return w.more["hits"][i] != hi or (j < w.n and w.more["hits"][j] != hj)

    def next_contact(self, w: World, n: Numbers) -> tuple[Any, int, int] | None:
        """The first of the queue that still holds; here its time, not a wait."""
        queue = w.more["queue"]
        while queue:
            entry = heapq.heappop(queue)
            if not self.stale(w, entry):
                return entry[:3]
        return None

    def fly(self, w: World, wait: Any) -> None:
        """The clock goes to a time."""
        w.t = max(w.t, wait)

    def collide(self, w: World, n: Numbers, i: int, j: int) -> None:
        """The two are flown, collide, and are predicted anew."""
        circles = [k for k in (i, j) if k < w.n]
        for k in circles:
            w.x[k], w.y[k] = self.place(w, k)
            w.more["clock"][k] = w.t
            w.more["hits"][k] += 1
        super().collide(w, n, i, j)
        if w.turn != w.count + 1:
            self.predict(w, n, [pair for pair in self.pairs(w) if any(k in pair for k in circles)])

    def turn_back(self, w: World) -> None:
        """All are flown, and predicted anew."""
        for k in range(w.n):
            w.x[k], w.y[k] = self.place(w, k)
            w.more["clock"][k] = w.t
        super().turn_back(w)
        w.more["queue"] = []
        self.predict(w, self.numbers if isinstance(w.t, float) else _of_world(w), list(self.pairs(w)))


def _of_world(w: World) -> Numbers:
    from .worlds import MP

    return MP if type(w.t).__name__ == "mpf" else F64


class TimesOnly(Events):
    """Tells who and when, and never where: all that follows from it is reckoned by whoever judges."""

    name = "times-only"
    tells = "nothing"


class TimesOnlyStable(Stable):
    """The same by another root; `triples` makes a plain list of (time, a, b) of its run."""

    name = "triples"
    tells = "nothing"


def triples(trajectory: Any) -> list[tuple[float, str, str]]:
    """A run as a list of (time, a, b)."""
    return [(float(event.time), a, b) for event in trajectory.events for a, b in event.impulses]


@dataclass(frozen=True)
class OverlapSteps(RecordedEngine):
    """Moves by a fixed step, and gives those that overlap and approach their impulse where they are.

    Attributes:
        step: the time step.
        tells: "pair": the contacts of a step, with the states of those that took part; "states": where all are.
    """

    step: float = 1 / 256
    tells: str = "pair"
    name = "overlap-steps"
    scene_keys = frozenset({"wall"})

    def play(self, scene: Any, recording: Any) -> None:
        """Plays a scene; see `RecordedEngine`."""
        law = self.law()
        w, number = law.world(scene), 0
        while recording.open:
            number += 1
            told = self.advance(w, F64, law, number)
            if self.tells == "states":
                recording.state(float(w.t), [w.row(k) for k in range(w.n)])
            elif told is not None:
                recording.hits(float(told.time), list(told.pairs), told.states)
            if number % 64 == 0 and self.over(w, law):
                return

    def law(self) -> Events:
        """Whose impulses it takes."""
        return ReducedMass()

    def over(self, w: World, law: Events) -> bool:
        """Whether nothing will ever meet."""
        return law.next_contact(w, F64) is None and not any(self.touching(w, F64, i, j) for i, j in law.pairs(w))

    def move(self, w: World, number: int) -> None:
        """All fly for a step."""
        for k in range(w.n):
            w.x[k], w.y[k] = w.x[k] + w.vx[k] * self.step, w.y[k] + w.vy[k] * self.step
        w.t = w.t * 0 + number * self.step

    def advance(self, w: World, n: Numbers, law: Events, number: int) -> Told | None:
        """One step: what it reports."""
        self.move(w, number)
        pairs: list[tuple[str, str]] = []
        hit: set[int] = set()
        for i, j in law.pairs(w):
            if self.touching(w, n, i, j):
                law.collide(w, n, i, j)
                pairs.append((w.ids[i], w.ids[j]))
                hit.update(k for k in (i, j) if k < w.n)
        w.count += len(pairs)
        return Told(w.t, tuple(pairs), {w.ids[k]: w.row(k) for k in sorted(hit)}) if pairs else None

    def touching(self, w: World, n: Numbers, i: int, j: int) -> bool:
        """Whether two overlap and approach."""
        if j >= w.n:
            wall, side = w.walls[j - w.n], w.sides[i][j - w.n]
            height = side * (wall.nx * (w.x[i] - wall.x) + wall.ny * (w.y[i] - wall.y))
            return bool(height < w.r[i] and side * (wall.nx * w.vx[i] + wall.ny * w.vy[i]) < 0)
        dx, dy = w.x[j] - w.x[i], w.y[j] - w.y[i]
        near = dx * (w.vx[j] - w.vx[i]) + dy * (w.vy[j] - w.vy[i]) < 0
        return bool(near and dx * dx + dy * dy < (w.r[i] + w.r[j]) * (w.r[i] + w.r[j]))


@dataclass(frozen=True)
class StateSteps(OverlapSteps):
    """The same, told as where everything is after each step; what hit what is left to whoever judges."""

    tells: str = "states"
    name = "state-steps"


@dataclass(frozen=True)
class ImpactSteps(RecordedEngine):
    """A fixed step, divided at each time of impact in it; the contact is told at its own time and place."""

    step: float = 1 / 64
    name = "impact-steps"
    scene_keys = frozenset({"wall"})

    def play(self, scene: Any, recording: Any) -> None:
        """Plays a scene; see `RecordedEngine`."""
        law = self.law()
        w, number = law.world(scene), 0
        while recording.open:
            number += 1
            for told in self.advance(w, F64, law, number):
                if recording.open:
                    recording.hits(float(told.time), list(told.pairs), told.states)
            if number % 64 == 0 and law.next_contact(w, F64) is None:
                return

    def law(self) -> Events:
        """Whose times and impulses it takes."""
        return Textbook()

    def advance(self, w: World, n: Numbers, law: Events, number: int) -> list[Told]:
        """One step, contact by contact."""
        start, left, told = w.t * 0 + (number - 1) * self.step, w.t * 0 + self.step, []
        while True:
            found = law.next_contact(w, n)
            if found is None or found[0] > left:
                break
            wait, i, j = found
            left = left - wait
            law.fly(w, wait)
            w.t = start + (self.step - left)
            law.collide(w, n, i, j)
            w.count += 1
            told += law.report(w, i, j)
        law.fly(w, left)
        w.t = start + self.step
        return told


@dataclass(frozen=True)
class FineSteps(OverlapSteps):
    """The overlapping stepper at a finer step, its impulses by angles."""

    step: float = 1 / 2048
    name = "fine-steps"

    def law(self) -> Events:
        """By angles."""
        return Angles()


HONEST: dict[str, Any] = {
    engine.name: engine
    for engine in (
        *(Events(), Stable(), Single(), SingleStable(), Angles(), CentreOfMass(), ReducedMass(), Textbook(), AllTold()),
        *(RelativeTime(), AbsoluteTime(), Intercept(), Backwards(), LongDouble(), Householder(), Bisected()),
        *(LazyQueue(), TimesOnly(), TimesOnlyStable(), OverlapSteps(), StateSteps(), ImpactSteps(), FineSteps()),
    )
}
"""Every honest engine by its name."""
