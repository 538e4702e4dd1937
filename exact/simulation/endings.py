"""Where a run under gravity ends though time goes on: a circle at rest, infinitely many hits in finite time."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from math import ceil, log
from typing import TypeAlias

from flint import arb

from ...scenarios.scene import Scene
from ..laws.formulas import fall_speed, sag
from ..numbers import ball
from ..numbers.system import N, Undecided
from ..replay.contact import AtWall, Link, Sides, Touch, is_flat, is_pair, name_of
from ..replay.state import ReplayState

# -- A circle that stands at a wall to which gravity pulls it, and neither approaches nor parts, is at rest there. It is
# no straight flight in the falling frame: the run ends.
#
# A circle that bounces on such a wall with a restitution below 1, and meets nothing else, comes to rest there: with
# the normal speed v after a bounce it is back after 2 v / |n.g|, with the speed e v. So the bounces end 2 v / |n.g|
# (1 + e + e^2 + ...) = 2 v / (|n.g| (1 - e)) later, whichever bounce it is told from.
#
# That it meets nothing else until then is proved with a bound on all speeds. Collisions with e <= 1 add no kinetic
# energy K, and gravity does at most |g| sqrt(m) sqrt(2 K) a unit of time, m the mass of all circles: so sqrt(2 K) grows
# by at most |g| sqrt(m) a unit of time, and no circle of mass w is ever faster than sqrt(2 K / w). Of the circle itself
# that holds until it meets something else, and so for all of the time if nothing is near enough for that.

SHRUNK = 20
"""A bounce counts as one of the last once its speed is 2**-SHRUNK of the first one's: before that they are all told."""

WINDOW = 256
"""Events that are compared with as many before them, to see whether hits accumulate elsewhere."""

CROWDED = 2.0**-10
"""Share of the time of those before that WINDOW events take, where hits are suspected to accumulate."""

PROOF_BITS = 256
"""Precision of a proof that a circle meets nothing else."""


Rows: TypeAlias = Sequence[tuple[arb, arb, arb, arb]]
"""x, y, vx, vy of every circle at an instant, in true coordinates, in balls."""


@dataclass(frozen=True)
class Accumulating:
    """Computes when the bounces of a circle on a wall end, from the state after one of them."""

    link: AtWall

    @property
    def circles(self) -> tuple[int, ...]:
        """The circle."""
        return self.link.circles

    def __call__(self, state: ReplayState[N]) -> N:
        body = state.bodies[self.link.circle]
        return body.flight.instant + self.wait(state)

    def wait(self, state: ReplayState[N]) -> N:
        """How long after the bounce: 2 v / (|n.g| (1 - e))."""
        assert state.falling is not None
        speed, half = self.link.closing(state), state.fall(state.falling, self.link).half
        return -speed / (half * state.constant(1 - state.scene.restitution))


class Endings:
    """Looks for both, event by event.

    Args:
        scene: what runs, under gravity.

    Attributes:
        found: the bounces that were proved to end.
    """

    def __init__(self, scene: Scene) -> None:
        assert scene.gravity is not None
        self.scene = scene
        self.found: Accumulating | None = None
        self._sides = Sides(scene)
        self._rows: dict[int, tuple[int, int]] = {}
        self._times: list[float] = []
        e = float(scene.restitution)
        self._enough = ceil(SHRUNK * log(2.0) / -log(e)) if e < 1.0 else None

    def at_rest(self, standing: Mapping[Link, int]) -> str | None:
        """Who is at rest at the end of an instant, in words; None if nobody is.

        Args:
            standing: contacts at gap zero, with the sign of their closing speed.

        Raises:
            Undecided: where one stands on, or flies along, something round and fixed.
        """
        pegs = self.scene.pegs
        for link, sign in standing.items():
            if pegs and sign == 0 and not pegs.isdisjoint(link.circles) and is_pair(link):
                raise Undecided(
                    f"{name_of(self.scene, link)} touch, and neither approach nor part, under gravity: whether one "
                    "rests on the other, slides along it or flies off is not followed"
                )
        names = [
            name_of(self.scene, link)
            for link, sign in standing.items()
            if sign == 0 and is_flat(link) and self._sides.pull(*link[:2]) < 0
        ]
        return " as well as ".join(sorted(names)) or None

    def bounced(self, impulses: Iterable[Touch]) -> list[AtWall]:
        """Notes the impulses of an event; the contacts whose bounces have shrunk enough to be looked at."""
        links, rows = [*impulses], self._rows
        shares = Counter(i for link in links for i in link.circles)
        found: list[AtWall] = []
        for link in links:
            if is_flat(link) and shares[link.circle] == 1:
                wall, count = rows.get(link.circle, (link.wall, 0))
                rows[link.circle] = (link.wall, count + 1 if wall == link.wall else 1)
                shrunk = self._enough is not None and rows[link.circle][1] > self._enough
                if shrunk and self._sides.pull(*link[:2]) < 0:
                    found.append(link)
            else:
                for i in link.circles:
                    rows.pop(i, None)
        return found

    def ends(self, link: AtWall, wait: arb, rows: Rows) -> bool:
        """Whether the bounces of a circle surely end, so long after an instant, as it meets nothing else until then."""
        with ball.precision(PROOF_BITS):
            return self._meets_nothing(link, wait, rows)

    def _meets_nothing(self, link: AtWall, wait: arb, rows: Rows) -> bool:
        circles = self.scene.circles
        gx, gy = (ball.constant(part) for part in self.scene.gravity or ())
        radii, pegs = [ball.constant(c.r) for c in circles], self.scene.pegs
        masses = [arb(0) if k in pegs else 1 / ball.constant(c.inverse_mass) for k, c in enumerate(circles)]
        pull = (gx * gx + gy * gy).sqrt()
        doubled = sum((m * (vx * vx + vy * vy) for m, (_, _, vx, vy) in zip(masses, rows, strict=True)), arb(0))
        swing = doubled.sqrt() + pull * sum(masses, arb(0)).sqrt() * wait
        ways = [arb(0) if k in pegs else swing / m.sqrt() * wait for k, m in enumerate(masses)]
        i = link.circle
        x, y, vx, vy = rows[i]
        way = ((vx * vx + vy * vy).sqrt() + pull * wait) * wait
        for j, (px, py, _, _) in enumerate(rows):
            room = radii[i] + radii[j] + way + ways[j]
            if j != i and not (px - x) * (px - x) + (py - y) * (py - y) > room * room:
                return False
        for k, wall in enumerate(self.scene.walls):
            if k != link.wall:
                nx, ny, x0, y0 = (ball.constant(q) for q in (*wall.normal, wall.x0, wall.y0))
                if not abs(nx * (x - x0) + ny * (y - y0)) > (radii[i] + way) * (nx * nx + ny * ny).sqrt():
                    return False
        return True

    def look(self, time: float) -> None:
        """Notes the time of an event.

        Raises:
            Undecided: where hits come ever faster, though no proof is known that they accumulate.
        """
        if self._enough is None:
            return
        self._times.append(time)
        times = self._times
        if len(times) >= 2 * WINDOW and len(times) % WINDOW == 0:
            before, last = times[-WINDOW] - times[-2 * WINDOW], times[-1] - times[-WINDOW]
            if last < CROWDED * before:
                raise Undecided(
                    f"accumulation suspected: the last {WINDOW} events took less than a thousandth of the time of the "
                    f"{WINDOW} before, up to time {time:.9g}; end the run before, or raise the restitution"
                )


def true_rows(state: ReplayState[N], time: N) -> list[tuple[N, N, N, N]]:
    """(x, y, vx, vy) of every circle at a time, in true coordinates."""
    falling = state.falling
    assert falling is not None
    rows: list[tuple[N, N, N, N]] = []
    for body in state.bodies.values():
        x, y, vx, vy, t, *_ = body.flight
        if body.index in state.pegs:
            rows.append((x, y, vx, vy))
        elif falling.bent:
            rows.append(falling.flown((x, y, vx, vy), time - t))
        else:
            zero = state.zero
            rows.append(
                (
                    x + vx * (time - t) + sag(zero, zero, falling.hx, time),
                    y + vy * (time - t) + sag(zero, zero, falling.hy, time),
                    fall_speed(vx, falling.hx, time),
                    fall_speed(vy, falling.hy, time),
                )
            )
    return rows
