"""The decision at which two histories part: which of two meetings comes first, or whether two circles meet at all."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

from flint import arb  # type: ignore[attr-defined]

from ...exact.formulas import (
    advance,
    pair_approach,
    pair_discriminant,
    pair_gap,
    pair_hit_time,
    wall_approach,
    wall_gap,
    wall_hit_time,
)
from ...exact.numbers import ball
from ...scenarios.quantity import Quantity
from ..alignment.divergence import Kind
from .numbers import enclosure

if TYPE_CHECKING:
    from ...scenarios.scene import Scene
    from ...scenarios.trajectory import Trajectory
    from ..alignment.align import Alignment
    from ..alignment.divergence import Divergence
    from ..alignment.walk import Walk

FIRST_BITS, MOST_BITS = 256, 1 << 14
"""Precision at which a decision is first looked at, and the most: beyond it is called zero to so many bits."""


@dataclass(frozen=True)
class Flight:
    """One circle from its last meeting on: x, y, vx, vy at time t, in the engine's own numbers."""

    t: Any
    x: Any
    y: Any
    vx: Any
    vy: Any


@dataclass(frozen=True)
class Pairing:
    """A body and a partner, each as its last meeting before the decision left it.

    Attributes:
        body, partner: ids; the partner may be a wall or a fixed circle.
        anchors: for each movable one of the two, the reference's event that is its last before; None: the start.
    """

    body: str
    partner: str
    anchors: Mapping[str, int | None]


@dataclass(frozen=True)
class Decision:
    """What was decided, as one number whose sign is the answer.

    Attributes:
        kind: `hit`: the least distance of the two surfaces in free flight, negative for the depth of a hit;
            `order`: the time of the second meeting less that of the first.
        first: the pairing whose hit is in question, or the meeting that comes first in the reference.
        second: for an order, the other meeting.
    """

    kind: Literal["hit", "order"]
    first: Pairing
    second: Pairing | None = None


def answer(decision: Decision, value: arb | None) -> int | None:
    """What a value decides: its sign; for a hit, a touch without depth is a miss. None if it is not known."""
    if value is None:
        return None
    sign = ball.sign_of(value)
    if decision.kind == "hit" and sign == 0:
        return 1
    return sign


class Reader:
    """Reads flights and decisions off one run.

    Args:
        run: the run.
        walks: how its meetings were matched with the reference's; None for the reference itself.
        scene: whose walls and radii it reckons with, if not those of the scene that it says.
        turned_after: number of the reference's events before its reversal, if that lies before the decision.
    """

    def __init__(
        self,
        run: Trajectory,
        walks: Mapping[str, Walk] | None = None,
        scene: Scene | None = None,
        turned_after: int | None = None,
    ) -> None:
        self.run = run
        self.scene = run.scene if scene is None else scene
        self.turned_after = turned_after
        self._events = None if walks is None else {name: dict(walked.pairs) for name, walked in walks.items()}
        self._states: dict[int, Any] = {}

    def follows(self, pairing: Pairing) -> bool:
        """Whether the run has every meeting that leads to a pairing."""
        return all(anchor is None or self._event(name, anchor) is not None for name, anchor in pairing.anchors.items())

    def _event(self, name: str, anchor: int) -> int | None:
        return anchor if self._events is None else self._events.get(name, {}).get(anchor)

    def flight(self, name: str, anchor: int | None, *, turned: bool) -> Flight | None:
        """A circle as its last meeting left it; None if the run does not have that meeting.

        Args:
            turned: whether the velocities were negated since.
        """
        index = None if anchor is None else self._event(name, anchor)
        if anchor is not None and index is None:
            return None
        reversal = self.run.reversal
        if turned and reversal is not None:
            time, key = reversal.time, -2
        else:
            time, key = (0, -1) if index is None else (self.run.events[index].time, index)
        if key not in self._states:
            self._states[key] = self.run.at(time)
        state = self._states[key][name]
        if key == -1:
            circle = next(c for c in self.scene.circles if c.id == name) if self._exact() else state
            return Flight(0, circle.x, circle.y, circle.vx, circle.vy)
        return Flight(time, state.x, state.y, state.vx, state.vy)

    def _exact(self) -> bool:
        """Whether the run's numbers at the start are those of the scene."""
        return hasattr(self.run.final_time, "ball") or hasattr(self.run.at(0).circles[0].x, "ball")

    def value(self, decision: Decision, bits: int = FIRST_BITS) -> arb | None:
        """The number that decides, as a ball of a sign that is known if it can be; None if the run does not come to it.

        A hit that the other meeting's pair does not have at all leaves an order without a value.
        """
        while True:
            with ball.precision(2 * bits):
                found = self._value(decision, bits)
            if found is None or ball.sign_of(found) is not None or not self._sharper(bits):
                return found
            bits *= 4

    def _sharper(self, bits: int) -> bool:
        return bits < MOST_BITS and self._exact()

    def _value(self, decision: Decision, bits: int) -> arb | None:
        if decision.kind == "hit":
            return self.least_gap(decision.first, bits)
        assert decision.second is not None
        one, other = self.hit_time(decision.first, bits), self.hit_time(decision.second, bits)
        return None if one is None or other is None else other - one

    # -- one pairing

    def _relative(self, pairing: Pairing, bits: int) -> tuple[arb, arb, arb, arb, arb, arb] | None:
        """t, d, v and R of two circles at the later of their flights' times."""
        flights = []
        for name in (pairing.body, pairing.partner):
            flight = self.flight(name, pairing.anchors.get(name), turned=self._turned(pairing))
            if flight is None:
                return None
            flights.append([enclosure(v, bits) for v in (flight.t, flight.x, flight.y, flight.vx, flight.vy)])
        (at, ax, ay, avx, avy), (bt, bx, by, bvx, bvy) = flights
        later = at if ball.sign_of(at - bt) in (0, 1) else bt
        ax, ay = advance(ax, avx, later - at), advance(ay, avy, later - at)
        bx, by = advance(bx, bvx, later - bt), advance(by, bvy, later - bt)
        radii = [enclosure(c.r, bits) for c in self.scene.circles if c.id in (pairing.body, pairing.partner)]
        return later, bx - ax, by - ay, bvx - avx, bvy - avy, radii[0] + radii[1]

    def _turned(self, pairing: Pairing) -> bool:
        """Whether the reversal lies between the last meetings and the decision."""
        reversal = self.run.reversal
        if reversal is None or self.turned_after is None:
            return False
        return all(anchor is None or anchor < self.turned_after for anchor in pairing.anchors.values())

    def _wall(self, pairing: Pairing, bits: int) -> tuple[arb, arb, arb, arb] | None:
        """t, the gap to a wall, the approach to it, and the length of its normal."""
        wall = next(w for w in self.scene.walls if w.id == pairing.partner)
        flight = self.flight(pairing.body, pairing.anchors.get(pairing.body), turned=self._turned(pairing))
        if flight is None:
            return None
        circle = next(c for c in self.scene.circles if c.id == pairing.body)
        nx, ny = wall.normal
        if wall.height(circle.x, circle.y).sign() < 0:
            nx, ny = -nx, -ny
        t, x, y, vx, vy = (enclosure(v, bits) for v in (flight.t, flight.x, flight.y, flight.vx, flight.vy))
        x0, y0, mx, my = (enclosure(v, bits) for v in (wall.x0, wall.y0, nx, ny))
        length = ball.root(mx * mx + my * my)
        gap = wall_gap(x, y, x0, y0, mx, my, enclosure(circle.r, bits) * length)
        return t, gap, wall_approach(vx, vy, mx, my), length

    def is_wall(self, pairing: Pairing) -> bool:
        """Whether the partner is a wall."""
        return any(w.id == pairing.partner for w in self.scene.walls)

    def hit_time(self, pairing: Pairing, bits: int = FIRST_BITS) -> arb | None:
        """When the two touch in free flight; None if they do not, or if it is not known."""
        if self.is_wall(pairing):
            told = self._wall(pairing, bits)
            if told is None or ball.sign_of(told[2]) != -1:
                return None
            return told[0] + wall_hit_time(told[1], told[2])
        relative = self._relative(pairing, bits)
        if relative is None:
            return None
        t, dx, dy, vx, vy, reach = relative
        approach, discriminant = pair_approach(dx, dy, vx, vy), pair_discriminant(dx, dy, vx, vy, reach)
        if ball.sign_of(approach) != -1 or ball.sign_of(discriminant) == -1:
            return None
        return t + pair_hit_time(pair_gap(dx, dy, reach), approach, ball.root(discriminant))

    def stay(self, pairing: Pairing) -> tuple[float, float] | None:
        """From when to when two circles, or a circle and a wall's line, would overlap if neither pushed."""
        enter = self.hit_time(pairing)
        if enter is None or self.is_wall(pairing):
            return None if enter is None else (float(enter), math.inf)
        relative = self._relative(pairing, FIRST_BITS)
        assert relative is not None
        _, dx, dy, vx, vy, reach = relative
        root = ball.root(pair_discriminant(dx, dy, vx, vy, reach))
        return float(enter), float(enter + (root + root) / (vx * vx + vy * vy))

    def least_gap(self, pairing: Pairing, bits: int = FIRST_BITS) -> arb | None:
        """The least distance between two surfaces in free flight; negative: how deep they would sink in.

        For a wall, which every approaching circle hits, the speed at which the circle leaves it.
        """
        if self.is_wall(pairing):
            told = self._wall(pairing, bits)
            return None if told is None else told[2] / told[3]
        relative = self._relative(pairing, bits)
        if relative is None:
            return None
        _, dx, dy, vx, vy, reach = relative
        if ball.sign_of(pair_approach(dx, dy, vx, vy)) in (0, 1):
            return ball.root(dx * dx + dy * dy) - reach
        cross = abs(dx * vy - dy * vx)
        if self._exactly_grazing(pairing):
            return arb(0)
        return cross / ball.root(vx * vx + vy * vy) - reach

    def gap_at(self, pairing: Pairing, time: arb, bits: int = FIRST_BITS) -> arb | None:
        """The distance between two surfaces at a time of their free flight."""
        if self.is_wall(pairing):
            told = self._wall(pairing, bits)
            return None if told is None else (told[1] + told[2] * (time - told[0])) / told[3]
        relative = self._relative(pairing, bits)
        if relative is None:
            return None
        t, dx, dy, vx, vy, reach = relative
        x, y = advance(dx, vx, time - t), advance(dy, vy, time - t)
        return ball.root(x * x + y * y) - reach

    def _exactly_grazing(self, pairing: Pairing) -> bool:
        """Whether the discriminant is proved to be zero, where the flights' exact values are short."""
        if not self._exact():
            return False
        numbers: list[list[Quantity]] = []
        for name in (pairing.body, pairing.partner):
            flight = self.flight(name, pairing.anchors.get(name), turned=self._turned(pairing))
            assert flight is not None
            texts = [exact_quantity(v) for v in (flight.t, flight.x, flight.y, flight.vx, flight.vy)]
            if any(q is None for q in texts):
                return False
            numbers.append([q for q in texts if q is not None])
        (at, ax, ay, avx, avy), (bt, bx, by, bvx, bvy) = numbers
        dx, dy = (bx - bvx * bt) - (ax - avx * at), (by - bvy * bt) - (ay - avy * at)
        radii = [c.r for c in self.scene.circles if c.id in (pairing.body, pairing.partner)]
        try:
            return pair_discriminant(dx, dy, bvx - avx, bvy - avy, radii[0] + radii[1]).sign() == 0
        except ValueError:
            return False


def exact_quantity(value: Any) -> Quantity | None:
    """An engine's number as a `Quantity`, if it is exact and short."""
    if isinstance(value, Quantity):
        return value
    if isinstance(value, int):
        return Quantity.of(value)
    text = value.text() if hasattr(value, "text") else None
    return None if text is None or len(text) > LONGEST_TEXT else Quantity.of(text)


LONGEST_TEXT = 400
"""Characters of an exact value that is still calculated with as text."""


def decisions(reference: Trajectory, candidate: Trajectory, alignment: Alignment) -> list[Decision]:
    """What may have been decided otherwise at the first divergence, likeliest first."""
    divergence = alignment.divergence
    assert divergence is not None
    walks, body = alignment.walks, divergence.body
    if divergence.kind is Kind.TIE:
        return _of_tie(reference, candidate, alignment, divergence)
    expected = got = None
    if divergence.expected is not None:
        expected = _pairing(reference, walks, body, divergence.expected, divergence.event, None)
    if divergence.got is not None and divergence.candidate_event is not None:
        got = _pairing(reference, walks, body, divergence.got, None, divergence.candidate_event)
    found: list[Decision] = []
    found += [Decision("hit", got)] if got is not None else []
    found += [Decision("hit", expected)] if expected is not None else []
    if expected is not None and got is not None:
        found.append(Decision("order", expected, got))
    return found


def _pairing(
    reference: Trajectory, walks: Mapping[str, Walk], body: str, partner: str, event: int | None, theirs: int | None
) -> Pairing | None:
    """Both as their last matched meetings before an event of either run left them."""
    anchors: dict[str, int | None] = {}
    for name in (body, partner):
        if name not in walks:
            continue
        pairs = walks[name].pairs
        if event is not None and name != body:
            before = [m for m in _own_events(reference, name) if m < event]
            anchors[name] = before[-1] if before else None
            continue
        known = [m for m, c in pairs if (m < event if event is not None else theirs is None or c < theirs)]
        if name == body:
            known = [m for m, c in pairs if (event is None or m < event) and (theirs is None or c < theirs)]
        elif theirs is not None and any(c < theirs for c in _unmatched(walks[name])):
            return None
        anchors[name] = max(known, default=None)
    return Pairing(body, partner, anchors)


def _unmatched(walked: Walk) -> list[int]:
    mismatch = walked.mismatch
    return [] if mismatch is None or mismatch.theirs is None else [mismatch.theirs]


def _own_events(reference: Trajectory, name: str) -> list[int]:
    return [e.index for e in reference.events if any(name in pair for pair in e.impulses)]


def _of_tie(
    reference: Trajectory, candidate: Trajectory, alignment: Alignment, divergence: Divergence
) -> list[Decision]:
    """The order of the first two partners that the body meets at the instant, or in the instants taken as one."""
    told = divergence.expected if divergence.expected and " then " in divergence.expected else divergence.got or ""
    names = list(dict.fromkeys(told.replace(" + ", " then ").split(" then ")))
    pairings = [
        _pairing(reference, alignment.walks, divergence.body, name, divergence.event, None) for name in names[:2]
    ]
    if len(pairings) < 2 or pairings[0] is None or pairings[1] is None:
        return []
    return [Decision("order", pairings[0], pairings[1])]
