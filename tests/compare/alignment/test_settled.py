"""A longer span never takes a divergence back, and never names another as the first."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import pytest

from truebreak.compare import ENGINES, compare, engine
from truebreak.compare import comparison as comparison_room
from truebreak.compare.alignment.align import not_measured
from truebreak.compare.comparison import Comparison
from truebreak.scenarios import Event, Quantity, Scene, Trajectory, catalogue

SCENES = (
    "gas:n=4,seed=3",
    "gas:n=3,seed=5,mixed=yes",
    "rack:rows=2,gap=1/7,jitter=1/1000,seed=7,offset=1/26,speed=20",
    "rack:rows=2,speed=200",
    "lee",
    "lee:tie=sequential:order=scene",
    "near-tie:k=4",
    "near-tie:k=40",
    "grazing",
    "galperin:n=1",
)
QUICK = ("exact", "double", "single", "quad", "rounded:bits=30", "interval", "pymunk:dt=1/32", "pymunk")
LITERAL_SCENES = (
    "gas:n=2,seed=1",
    "lee",
    "lee:tie=sequential:order=scene",
    "near-tie:k=4",
    "near-tie:k=40",
    "galperin:n=1",
    "pinball",
    "corner",
    "corner:angle=45",
    "corner:angle=60,skew=1/3",
)
"""Scenes of few roots, which SymPy alone can run."""

EVENTS, TIMES, LITERAL = 12, 4, 3
"""Events of the sweeps, and those about whose times `until` is set; of the engine that takes the article literally."""

FAR, PART = 60, 10
"""Events of the long sweeps, in counts and in times alike, and how many of them one test takes. Each test compares the
whole as well, so that all of them have to name the same divergence."""

LASTS = {"lee": 1, "lee:tie=sequential:order=scene": 1, "near-tie:k=4": 4, "near-tie:k=40": 4, "galperin:n=1": 31}
"""Events of the scenes that have fewer: all that there are."""


def test_every_engine_is_swept() -> None:
    own = {name for name, entry in ENGINES.items() if not entry.adapted}
    assert {name.partition(":")[0] for name in QUICK} | {"sympy"} == own


def told(comparison: Comparison, name: str) -> tuple[Any, ...] | None:
    """What is said of an engine's first divergence."""
    found = comparison[name].alignment.divergence
    return None if found is None else (found.event, found.time, found.body, found.expected, found.got, found.kind)


def swept(scene: Scene, engines: Sequence[str], spans: Sequence[dict[str, Any]]) -> None:
    """Along ever longer spans, each engine's first divergence comes and stays as it is."""
    comparisons = [compare(scene, engines, causes=False, **limits) for limits in spans]
    assert comparisons
    for name in engines:
        seen = [told(comparison, name) for comparison in comparisons]
        known = [one for one in seen if one is not None]
        assert len(set(known)) <= 1, (name, known)
        if known:
            first = seen.index(known[0])
            assert all(one is not None for one in seen[first:]), (name, seen)
            time = known[0][1]
            for comparison, one in zip(comparisons, seen, strict=True):
                assert one is not None or comparison.span <= time, (name, comparison.span, time)
        for comparison in comparisons:
            candidate = comparison[name]
            assert candidate.verdict != "unsettled", (name, comparison.span)
            if candidate.verdict == "agree":
                assert candidate.alignment.agreed == len(comparison.reference.events)
                assert not {"collisions", "who_hit_whom"} & set(candidate.changed)
        if name in ("exact", "sympy"):
            assert {comparison[name].verdict for comparison in comparisons} == {"agree"}


def endless(text: str) -> Scene:
    """A scene of the catalogue without limits of its own."""
    return catalogue.build(text).with_changes(until=None, events=None)


def counts(scene: Scene, most: int) -> list[dict[str, Any]]:
    """Every number of events."""
    run = engine("exact").run(scene, events=most)
    return [{"events": events} for events in range(1, len(run.events) + 1)]


def ends(events: Sequence[Event]) -> Iterator[dict[str, Any]]:
    """The time of every event, exactly or to 60 digits, with one just before and one just after."""
    for event in events:
        exact = event.time.text()
        if exact is None or len(exact) > 200:
            exact = event.time.digits(60)
        around = [Quantity.of(f"{exact}{shift}") for shift in (" - 10**-60", "", " + 10**-60")]
        yield from ({"until": end} for end in around if end.sign() > 0)


@pytest.mark.parametrize("text", SCENES)
def test_sweeping_the_number_of_events(text: str) -> None:
    scene = endless(text)
    swept(scene, QUICK, counts(scene, EVENTS))


@pytest.mark.parametrize("text", SCENES)
def test_sweeping_the_end_over_each_event(text: str) -> None:
    scene = endless(text)
    swept(scene, QUICK, list(ends(engine("exact").run(scene, events=TIMES).events)))


@pytest.mark.parametrize("text", LITERAL_SCENES)
def test_sweeping_the_literal_engine(text: str) -> None:
    scene = endless(text)
    swept(scene, ["sympy"], counts(scene, LITERAL))
    swept(scene, ["sympy"], list(ends(engine("exact").run(scene, events=1).events)))


@pytest.fixture
def no_distances(monkeypatch: pytest.MonkeyPatch) -> None:
    """Leaves out the position error, half of the time of a comparison, which no sweep looks at."""
    monkeypatch.setattr(comparison_room, "separation", lambda reference, *_: not_measured(reference))


PARTS = [(text, first) for text in SCENES for first in range(0, min(FAR, LASTS.get(text, FAR)), PART)]
"""Each scene with the events of its long sweeps, some at a time."""


def part(text: str, first: int) -> tuple[Scene, Trajectory, range]:
    """A scene, its run to the end of the long sweep, and the events of a part of it."""
    scene = endless(text)
    run = engine("exact").run(scene, events=FAR)
    assert len(run.events) == min(FAR, LASTS.get(text, FAR))
    return scene, run, range(first, min(first + PART, len(run.events)))


@pytest.mark.slow
@pytest.mark.timeout(3600)
@pytest.mark.usefixtures("no_distances")
@pytest.mark.parametrize(("text", "first"), PARTS)
def test_sweeping_the_number_of_events_far(text: str, first: int) -> None:
    scene, run, events = part(text, first)
    swept(scene, QUICK, [*({"events": event + 1} for event in events), {"events": len(run.events)}])


@pytest.mark.slow
@pytest.mark.timeout(3600)
@pytest.mark.usefixtures("no_distances")
@pytest.mark.parametrize(("text", "first"), PARTS)
def test_sweeping_the_end_over_every_event(text: str, first: int) -> None:
    scene, run, events = part(text, first)
    swept(scene, QUICK, [*ends(run.events[events.start : events.stop]), {"events": len(run.events)}])


@pytest.mark.slow
@pytest.mark.timeout(3600)
@pytest.mark.parametrize("text", LITERAL_SCENES)
def test_sweeping_the_literal_engine_far(text: str) -> None:
    scene = endless(text)
    swept(scene, ["sympy"], counts(scene, 3 * LITERAL))
    swept(scene, ["sympy"], list(ends(engine("exact").run(scene, events=LITERAL).events)))
