"""A longer span never takes a divergence back, and never names another as the first."""

from __future__ import annotations

from typing import Any

import pytest

from truebreak.compare import compare, engine
from truebreak.compare.comparison import Comparison
from truebreak.scenarios import Quantity, Scene, catalogue

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
ENGINES = ("double", "interval", "pymunk:dt=1/32", "pymunk")
EVENTS = 16


def told(comparison: Comparison, name: str) -> tuple[Any, ...] | None:
    """What is said of an engine's first divergence."""
    found = comparison[name].alignment.divergence
    return None if found is None else (found.event, found.time, found.body, found.expected, found.got, found.kind)


def held(scene: Scene, **limits: Any) -> Comparison:
    return compare(scene, ENGINES, causes=False, **limits)


def swept(comparisons: list[Comparison]) -> None:
    """Along ever longer spans, each engine's first divergence comes and stays as it is."""
    for name in ENGINES:
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
            if candidate.verdict == "agree":
                assert candidate.alignment.agreed == len(comparison.reference.events)
                assert not {"collisions", "who_hit_whom"} & set(candidate.changed)


@pytest.mark.parametrize("text", SCENES)
def test_sweeping_the_number_of_events(text: str) -> None:
    scene = catalogue.build(text).with_changes(until=None, events=None)
    most = len(engine("exact").run(scene, events=EVENTS).events)
    swept([held(scene, events=events) for events in range(1, most + 1)])


@pytest.mark.parametrize("text", SCENES)
def test_sweeping_the_end_over_each_event(text: str) -> None:
    scene = catalogue.build(text).with_changes(until=None, events=None)
    run = engine("exact").run(scene, events=EVENTS // 4)
    ends: list[Any] = []
    for event in run.events:
        time: Any = event.time
        exact = time.text()
        if exact is None or len(exact) > 200:
            exact = time.digits(60)
        ends += [Quantity.of(f"{exact} - 10**-60"), Quantity.of(exact), Quantity.of(f"{exact} + 10**-60")]
    swept([held(scene, until=end) for end in ends if end.sign() > 0])
