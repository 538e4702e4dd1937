"""What an engine's arithmetic does by itself, beside the rounding of its input.

At the contact in question the exact run of the scene in the engine's numbers may have left the history long before, or
be so far off that what the engine adds to it says nothing of what it would add to the exact motion. But while all three
runs still lie close together, displacements add up. The exact run is stopped at such a moment, displaced by the
difference between the engine and the exact run of what it was given, and run on: exactly, whatever becomes of the
displacement.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction
from math import inf
from typing import TYPE_CHECKING

from ....scenarios.errors import SceneError
from ....scenarios.numbers.precision import Double
from ....scenarios.numbers.quantity import Quantity, real
from ....scenarios.things import Circle
from ...alignment.align import align
from ...alignment.streams import history
from ..decision.decision import DecidingNumber, Pairing
from ..decision.reader import RunReader

if TYPE_CHECKING:
    from ....scenarios.scene import Scene
    from ....scenarios.trajectory import State, Trajectory
    from .laboratory import Laboratory

SMALL = 2.0**-26
"""Share of the scene's measures up to which displacements add up: what is neglected is that share of them."""

LARGE = 2.0**-36
"""Share that the engine's displacement has to have come to, so that what it rounds later on is small beside it."""

DIGITS = 80
"""Digits with which the exact run is taken up again. What they leave out grows as any displacement does, and so stays
10**-69 of the engine's; that the run goes on as before is looked at."""


@dataclass(frozen=True)
class Displaced:
    """The exact run taken up at a moment, displaced by an engine's arithmetic, and the decision in question in it.

    Attributes:
        after: number of the reference's events before that moment.
        decision: the same decision, with anchors among the events from there on.
        truth: reads the run that was not displaced.
        own: reads the one that was.
        small: makes a run displaced by a share only, and reads it.
    """

    after: int
    decision: DecidingNumber
    truth: RunReader
    own: RunReader
    small: Callable[[Quantity], RunReader]


def arithmetic_alone(lab: Laboratory, entered: RunReader) -> Displaced | None:
    """The exact run with the displacement of the engine's arithmetic alone; None where there is no such moment.

    Args:
        entered: reads the exact run of the scene as the engine is given it.
    """
    scene, decision = lab.study.scene, lab.decision
    if decision is None or scene.capture or scene.reverse_at is not None or scene.reverse_after is not None:
        return None
    moment = _moment(lab, entered.run)
    if moment is None:
        return None
    after, time = moment
    exact, given, own = (run.at(time) for run in (lab.reference, entered.run, lab.candidate.trajectory))
    until = lab.until(None) - float(time)

    def ran(share: Quantity) -> Trajectory | None:
        try:
            taken_up = _displaced(scene, exact, given, own, share)
        except SceneError:
            return None
        return lab.run(lab.study.truth, taken_up, until)

    plain = ran(Quantity.of(0))
    if plain is None or not _goes_on(lab, plain, after):
        return None

    def read(share: Quantity) -> RunReader | None:
        run = ran(share)
        return None if run is None else RunReader(run, align(plain, run, instants=False).walks)

    moved = read(Quantity.of(1))
    if moved is None:
        return None
    return Displaced(after, _rebased(decision, after), RunReader(plain), moved, lambda share: read(share) or moved)


def _moment(lab: Laboratory, given: Trajectory) -> tuple[int, Fraction] | None:
    """The last moment between two events at which all three runs lie close together, and how many events come before.

    None if there is no such moment at which the engine's arithmetic has come to anything.
    """
    events = lab.reference.events
    low, high, found = 0, min(lab.divergence.expected_event, len(events) - 1), None
    while low < high:  # displacements grow, by and large; what is found is looked at
        middle = (low + high) // 2
        time = Fraction((float(events[middle].time) + float(events[middle + 1].time)) / 2)
        sizes = _sizes(lab, given, time)
        if max(sizes) <= SMALL * lab.scale:
            found, low = (middle + 1, time, sizes[1]), middle + 1
        else:
            high = middle
    if found is None or found[2] < LARGE * lab.scale:
        return None
    past = [_past(run, found[1]) for run in (lab.reference, given, lab.candidate.trajectory)]
    return found[:2] if past[0] == past[1] == past[2] else None


def _sizes(lab: Laboratory, given: Trajectory, time: Fraction) -> tuple[float, float]:
    """How far the exact run of the scene in doubles lies from that of the scene, and the engine from the former.

    Infinitely far where one of them does not get to that time.
    """
    at, runs = [float(time)], (lab.reference, given, lab.candidate.trajectory)
    if any(float(run.final_time) < at[0] for run in runs):
        return inf, inf
    exact, entered, own = (run.sample(at)[0] for run in runs)
    return float(abs(entered - exact).max()), float(abs(own - entered).max())


def _past(run: Trajectory, time: Fraction) -> dict[str, list[str]]:
    """Whom each circle met before a moment, in order."""
    told = history(run)
    return {
        name: [other for meeting in met if told.times[meeting.event] < time for other in meeting.partners]
        for name, met in told.meetings.items()
    }


def _displaced(scene: Scene, exact: State, given: State, own: State, share: Quantity) -> Scene:
    """The scene as the exact run has it at a moment, displaced by a share of what the engine's arithmetic has come to.

    Raises:
        SceneError: if circles then overlap.
    """
    circles = []
    for circle, here, there, got in zip(scene.circles, exact.circles, given.circles, own.circles, strict=True):
        values = {
            key: _number(getattr(here, key)) + share * (_number(getattr(got, key)) - _number(getattr(there, key)))
            for key in ("x", "y", "vx", "vy")
        }
        circles.append(
            Circle(
                **(values if not circle.fixed else {"x": circle.x, "y": circle.y}),  # pyright: ignore[reportArgumentType]
                r=circle.r,
                m=circle.m,
                id=circle.id,
                point=circle.point,
            )
        )
    return scene.with_changes(circles=circles, until=None, events=None)


def _number(value: object) -> Quantity:
    """A number of a run to `DIGITS` digits."""
    told = real(value)
    return Quantity.of(Fraction(float(told))) if isinstance(told, Double) else Quantity.of(told.digits(DIGITS))


def _goes_on(lab: Laboratory, run: Trajectory, after: int) -> bool:
    """Whether a run taken up after some events has those that follow, up to the one in question."""
    last = max([a for p in lab.pairings for a in p.anchors.values() if a is not None], default=-1)
    wanted = [event.impulses for event in lab.reference.events[after : max(last + 1, lab.divergence.expected_event)]]
    return [event.impulses for event in run.events[: len(wanted)]] == wanted


def _rebased(decision: DecidingNumber, after: int) -> DecidingNumber:
    """A decision with its anchors counted from a moment on."""

    def rebased(pairing: Pairing) -> Pairing:
        anchors = {name: None if a is None or a < after else a - after for name, a in pairing.anchors.items()}
        return replace(pairing, anchors=anchors)

    second = None if decision.second is None else rebased(decision.second)
    return replace(decision, first=rebased(decision.first), second=second)
