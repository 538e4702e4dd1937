"""The collector of cyclic garbage is as it was once a run is over, and no run holds it back for good."""

from __future__ import annotations

import gc
import weakref
from collections.abc import Iterator

import pytest

from truebreak.compare import engine
from truebreak.exact.replay.contact import Body
from truebreak.exact.simulation.loop import SELDOM, SeldomCollected
from truebreak.scenarios import catalogue


@pytest.fixture(autouse=True)
def threshold() -> Iterator[tuple[int, int, int]]:
    before = gc.get_threshold()
    gc.set_threshold(701, 11, 12)
    yield gc.get_threshold()
    gc.set_threshold(*before)


@pytest.mark.parametrize("name", ["exact", "double", "interval"])
def test_a_run_leaves_the_collector_as_it_was(name: str, threshold: tuple[int, int, int]) -> None:
    engine(name).run(catalogue.build("gas:n=3"), events=5)
    assert gc.get_threshold() == threshold


@pytest.mark.parametrize("name", ["exact", "double"])
def test_nothing_of_a_run_awaits_the_collector(name: str) -> None:
    def alive() -> int:
        return sum(isinstance(found, Body) for found in gc.get_objects())

    scene = catalogue.build("gas:n=70")
    engine(name).run(scene, events=3)
    gc.collect()
    before = alive()
    gc.disable()
    try:
        engine(name).run(scene, events=300)
        assert alive() == before
    finally:
        gc.enable()


@pytest.mark.parametrize("name", ["exact", "double"])
def test_while_a_run_lasts_nobody_looks(name: str) -> None:
    within: list[int] = []

    def note(phase: str, _: dict[str, int]) -> None:
        if phase == "start":
            within.append(gc.get_threshold()[0])

    scene = catalogue.build("gas:n=70")
    engine(name).run(scene, events=3)
    gc.collect()
    gc.callbacks.append(note)
    try:
        engine(name).run(scene, events=300)
    finally:
        gc.callbacks.remove(note)
    assert SELDOM not in within


def test_the_last_of_several_runs_puts_it_back(threshold: tuple[int, int, int]) -> None:
    collected = SeldomCollected()
    with collected:
        assert gc.get_threshold() == (SELDOM, 11, 12)
        with pytest.raises(KeyboardInterrupt), collected:
            raise KeyboardInterrupt
        assert gc.get_threshold() == (SELDOM, 11, 12)
    assert gc.get_threshold() == threshold


@pytest.mark.parametrize("first", [0, 3 * SELDOM])
def test_one_that_is_off_or_looks_less_often_still_stays_so(first: int) -> None:
    gc.set_threshold(first, 11, 12)
    with SeldomCollected():
        assert gc.get_threshold() == (first, 11, 12)
    assert gc.get_threshold() == (first, 11, 12)


@pytest.mark.parametrize("name", ["exact", "double", "quad"])
@pytest.mark.parametrize("scene", ["gas:n=6", "gas:n=70", "pinball", "lorentz", "stadium", "bounce", "cradle"])
def test_no_part_of_a_run_is_left_in_a_circle(name: str, scene: str) -> None:
    built = catalogue.build(scene)
    engine(name).run(built, events=20)
    gc.collect()
    gc.set_debug(gc.DEBUG_SAVEALL)
    try:
        engine(name).run(built, events=20)
        gc.collect()
        left = {type(found).__name__ for found in gc.garbage if type(found).__module__.startswith("truebreak")}
    finally:
        gc.set_debug(0)
        gc.garbage.clear()
    assert not left


def test_garbage_that_others_make_between_runs_is_collected() -> None:
    """Another library's cycles, such as a pymunk space's, would else stay for as long as the process lives."""

    class Cyclic:
        def __init__(self) -> None:
            self.me = self

    alive: list[weakref.ref[Cyclic]] = []
    scene = catalogue.build("gas:n=3")
    for _ in range(60):
        alive += [weakref.ref(Cyclic()) for _ in range(300)]
        engine("exact").run(scene, events=1)
    assert sum(ref() is not None for ref in alive) < len(alive) / 2
