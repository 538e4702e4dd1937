"""Engines with one planted fault: what they do is known without comparing, and so is what has to be said of them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cache
from typing import Any, TypeAlias

import pytest

from truebreak.compare import compare
from truebreak.compare.alignment.instants import Divergence, Kind
from truebreak.compare.causes.diagnosis import CauseName
from truebreak.compare.foreign import RecordedEngine, Recording
from truebreak.compare.report.sentences import verdict_sentence
from truebreak.exact import ExactEngine
from truebreak.scenarios import (
    Circle,
    Contact,
    Declared,
    Event,
    Quantity,
    Scene,
    StopReason,
    Trajectory,
    Wall,
    catalogue,
)
from truebreak.scenarios.trajectory import Stop

LONG = 40
"""Events of the whole histories."""

SPANS = (1, 3, 6, 7, 8, 12, 20, 29)

Fault: TypeAlias = "Callable[[Scene], Trajectory]"


@cache
def whole(scene: Scene) -> Trajectory:
    """A scene's exact history, far beyond every span."""
    return ExactEngine().run(scene, events=LONG)


@dataclass(frozen=True)
class Faulty(Declared):
    """An engine that tells a whole history as it was made, cut where it is asked to end."""

    fault: Fault
    name: str = "faulty"

    def run(self, scene: Scene, *, until: Any = None, events: int | None = None, progress: Any = None) -> Trajectory:
        told = self.fault(scene)
        kept = [e for e in told.events if until is None or float(e.time) <= float(until)][:events]
        reason, end = StopReason.BUDGET, told.final_time  # as it is: the nearest double may be past it
        if len(kept) == events:
            reason, end = StopReason.EVENTS, float(kept[-1].time)
        elif until is not None and float(until) <= float(told.final_time):
            reason, end = StopReason.HORIZON, float(until)
        cut = tuple(replace(event, index=k) for k, event in enumerate(kept))
        return replace(told, scene=scene, events=cut, stop=Stop(reason, "as it was made"), final_time=end)


def with_events(change: Callable[[list[Event]], list[Event]]) -> Fault:
    """A fault of the list of events; the motion stays as it is."""
    return lambda scene: replace(whole(scene), events=tuple(change([*whole(scene).events])))


def with_scene(change: Callable[[Scene], Scene]) -> Fault:
    """A fault of what the engine takes the scene for."""
    return lambda scene: whole(change(scene))


def heavy(scene: Scene) -> Scene:
    first, *others = scene.circles
    values = {key: getattr(first, key) for key in ("x", "y", "r", "vx", "vy", "id")}
    return scene.with_changes(circles=[Circle(**values, m=first.m * 2), *others])


def shifted(scene: Scene) -> Scene:
    first, *others = scene.circles
    values = {key: getattr(first, key) for key in ("x", "r", "vx", "vy", "id", "m")}
    return scene.with_changes(circles=[Circle(**values, y=first.y + Quantity.of("10**-3")), *others])


def swapped(events: list[Event]) -> list[Event]:
    """The first event, and the next of which a circle takes part in it, told in each other's place."""
    one = events[2]
    k = next(k for k in range(3, LONG) if {*events[k].impulses[0]} & {*one.impulses[0]})
    other = events[k]
    return [*events[:2], replace(other, time=one.time), *events[3:k], replace(one, time=other.time), *events[k + 1 :]]


def extra(events: list[Event]) -> list[Event]:
    """A meeting of the first two circles that did not take place."""
    time, pair = (float(events[5].time) + float(events[6].time)) / 2, Contact("a", "b")
    return [*events[:6], Event(0, time, (pair,), (pair,)), *events[6:]]


FAULTS = {
    "none": with_events(lambda events: events),
    "late by a share": with_events(lambda events: [replace(e, time=float(e.time) * (1 + 2**-30)) for e in events]),
    "a dropped contact": with_events(lambda events: [*events[:5], *events[6:]]),
    "an extra contact": with_events(extra),
    "a contact told twice": with_events(lambda events: [*events[:6], events[5], *events[6:]]),
    "another order": with_events(swapped),
    "a missed wall": with_scene(lambda scene: scene.with_changes(walls=scene.walls[1:])),
    "another mass": with_scene(heavy),
    "a little beside": with_scene(shifted),
}

BOX = [Wall(-4, 0, -4, 1, id="left"), Wall(32, 0, 32, 1, id="right"), Wall(0, -9, 1, -9), Wall(0, 9, 1, 9)]
SCENES = {
    # Numbers that doubles hold, contacts that fall on one instant: two that hang together, and two far apart.
    "line": Scene([Circle(0, 0, vx=2, id="a"), Circle(8, 0, id="b"), Circle(16, 0, vx=-1, id="c")], BOX[:2]),
    "box": Scene(
        [Circle(0, 1, vx=2, vy="1/3", id="a"), Circle(8, 0, id="b"), Circle(16, "1/7", vx=-1, m=3, id="c")], BOX
    ),
}


def partners(run: Trajectory) -> Iterator[tuple[str, list[tuple[list[str], Event]]]]:
    """Whom each circle meets, event by event."""
    for circle in run.scene.circles:
        name = str(circle.id)
        mine = [(sorted(b if a == name else a for a, b in e.impulses if name in (a, b)), e) for e in run.events]
        yield name, [(others, event) for others, event in mine if others]


def parting(reference: Trajectory, run: Trajectory) -> tuple[float, int | None, float | None] | None:
    """When two long histories part first: the earlier time, the reference's event, and the time of the other's."""
    found = []
    for (_, mine), (_, theirs) in zip(partners(reference), partners(run), strict=True):
        for (expected, event), (got, other) in zip(mine, theirs, strict=False):
            if expected != got:
                found.append((min(float(event.time), float(other.time)), event.index, float(other.time)))
                break
    return min(found, default=None)


@pytest.mark.parametrize("fault", FAULTS)
@pytest.mark.parametrize("name", SCENES)
def test_a_fault_is_told_where_it_lies_and_always_so(name: str, fault: str) -> None:
    scene, make = SCENES[name], FAULTS[fault]
    known = parting(whole(scene), make(scene))
    assert (known is None) == (fault in ("none", "late by a share"))
    told: set[Divergence] = set()
    for events in SPANS:
        found = compare(scene, [Faulty(make)], events=events, causes=False).candidates[0]
        end = float(whole(scene).events[events - 1].time)
        inside = known is not None and ((known[1] or 0) < events or (known[2] or 0.0) <= end)
        assert found.verdict == ("diverged" if inside else "agree"), (events, known, found.alignment.divergence)
        if found.alignment.divergence is not None:
            told.add(found.alignment.divergence)
    assert len(told) == (known is not None), told
    for divergence in told:
        assert known is not None
        assert divergence.time == pytest.approx(known[0], rel=1e-9)


@pytest.mark.parametrize("place", [5, 15])
def test_an_extra_contact_beside_a_tie_is_told_one_way(place: int) -> None:
    scene = catalogue.build("cradle").with_changes(until=None, events=None)
    told = whole(scene).events
    time, pair = (float(told[place].time) + float(told[place + 1].time)) / 2, told[0].impulses[0]
    make = with_events(lambda events: [*events[: place + 1], Event(0, time, (pair,), (pair,)), *events[place + 1 :]])
    runs = [compare(scene, [Faulty(make)], events=k, causes=False) for k in (place + 2, place + 5, 24, 30)]
    divergences = {run["faulty"].alignment.divergence for run in runs}
    assert len(divergences) == 1
    (first,) = divergences
    assert first is not None
    assert first.time == pytest.approx(time)


@dataclass(frozen=True)
class Damped(Declared):
    """The exact engine, which lets one circle leave its last contact a little slower than the law says."""

    share: float
    name: str = "damped"

    def run(self, scene: Scene, **limits: Any) -> Trajectory:
        run = ExactEngine().run(scene, **limits)
        return replace(run, motion=Slower(run.motion, self.share, float(run.events[-1].time)))


@dataclass(frozen=True)
class Slower:
    """A motion of which velocities are smaller from a time on."""

    motion: Any
    share: float
    since: float

    def state(self, time: Any) -> Any:
        share = self.share if float(time) >= self.since else 1.0
        return [(x, y, share * float(vx), share * float(vy)) for x, y, vx, vy in self.motion.state(time)]

    def sample(self, times: Any) -> Any:
        return self.motion.sample(times)


@pytest.mark.parametrize("share", [1.0, 1 - 1e-4, 0.5])
def test_velocities_against_the_law_are_no_error(share: float) -> None:
    """Nobody meets anybody else, so that the history agrees; but not what comes of it."""
    scene = Scene([Circle(0, 0, vx=1, id="a"), Circle(4, "1/3", id="b")])
    comparison = compare(scene, [Damped(share)], until=9)
    assert comparison.verdict == "agree"
    assert comparison["damped"].changed == (() if share == 1.0 else ("final_velocities",))
    assert verdict_sentence(comparison).startswith("Floating point did not change what happened") == (share == 1.0)


@pytest.mark.parametrize("text", ["gas", "gas:n=5,seed=3,mixed=yes", "galperin:n=2", "near-tie:k=4", "pinball"])
def test_error_that_has_grown_is_no_breach_of_the_law(text: str) -> None:
    names = ["double", "single", "rounded:bits=40", "quad"]
    for candidate in compare(catalogue.build(text), names, events=20, causes=False).candidates:
        if candidate.verdict == "agree":
            assert candidate.changed == (), candidate.engine


def test_a_tie_of_circles_at_rest_is_a_tie() -> None:
    """Circles that touch and rest have no time at which they meet; the blow that comes has."""
    scene = catalogue.build("rack:rows=2").with_changes(tie_policy="sequential:order=scene")
    found = compare(scene, ["pymunk"], events=1)["pymunk"]
    assert found.alignment.divergence is not None
    assert found.alignment.divergence.kind is Kind.TIE
    assert found.diagnosis is not None
    assert found.diagnosis.sufficient == (CauseName.TIE,)
    assert found.margin is not None
    assert found.margin.gap == (0.0, 0.0)


def test_one_order_told_twice_is_no_sentence() -> None:
    scene = catalogue.build("lee").with_changes(tie_policy="sequential:order=scene")
    said = verdict_sentence(compare(scene, ["pymunk"], until=10))
    assert "left and right at once where it should meet left and right at once" not in said
    assert "meets left and right at once, as it should, but the impulses lead to other velocities" in said


def test_what_differs_from_a_reference_that_rounds_may_be_the_reference_s_own() -> None:
    found = compare(catalogue.build("gas:n=4,seed=3"), ["exact"], reference="double", events=120)["exact"]
    assert found.verdict == "diverged"
    assert found.diagnosis is not None
    assert found.diagnosis.name is CauseName.UNKNOWN


class Forgetful(RecordedEngine):
    """Tells the exact run in doubles, and where one event leaves its two, nothing."""

    name = "forgetful"

    def __init__(self, forgotten: int) -> None:
        self._forgotten = forgotten

    def play(self, scene: Scene, recording: Recording) -> None:
        run = whole(scene)
        for event in run.events:
            state = run.at(event.time)
            moved = {str(c.id) for c in scene.circles if not c.fixed} & {name for p in event.impulses for name in p}
            rows = {name: tuple(float(getattr(state[name], key)) for key in ("x", "y", "vx", "vy")) for name in moved}
            if event.index != self._forgotten and recording.open:
                recording.hits(float(event.time), event.impulses, rows)


@pytest.mark.parametrize("forgotten", [1, 4, 5])
@pytest.mark.parametrize("text", ["pinball", "cradle", "gas:n=4"])
def test_a_contact_that_is_not_told_is_no_rounding(text: str, forgotten: int) -> None:
    """After its last contact a circle parts from its partner, in any numbers: that decides nothing."""
    found = compare(catalogue.build(text), [Forgetful(forgotten)], events=7)["forgetful"]
    assert found.verdict == "diverged"
    assert found.diagnosis is not None
    assert found.diagnosis.sufficient == (CauseName.LAW,)
