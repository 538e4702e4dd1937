"""The compiled predictions of the flat loop against those of Python: the same entries of the queue, to the last bit."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import count
from math import inf, nan
from random import Random
from typing import Any

import pytest

from truebreak.floating.flat import flying
from truebreak.floating.flat.flat_meetings import compiled

pytestmark = pytest.mark.skipif(compiled is None, reason="nothing is compiled here")

SCALES = [(1.0, 1.0), (1e3, 1e-3), (1e150, 1e150), (1e-160, 1e-160), (1e155, 1e-5), (1e-300, 1e200)]


@dataclass
class Run:
    """As much of a `FlatFlights` as predictions take."""

    flights: list[Any]
    lines: list[Any]
    until: list[float]
    serial: list[int]
    heap: list[Any] = field(default_factory=list)
    unsure: Callable[[int, int], None] = lambda i, j: None

    def __post_init__(self) -> None:
        self.tick = count(1).__next__
        self.closer: list[object] = []
        self.unsure = self.look_closer

    def look_closer(self, i: int, j: int) -> None:
        """As a run does, it may queue something of its own, and end a flight."""
        self.closer.append((i, j, len(self.heap)))
        if j % 3 == 0:
            self.until[i] = min(self.until[i], 2.5)


def number(draw: Random, scale: float) -> float:
    kind = draw.random()
    if kind < 0.1:
        return 0.0 if kind < 0.05 else -0.0
    if kind < 0.11:
        return draw.choice([inf, -inf, nan, 5e-324, 1e308])
    return scale * (draw.randint(-8, 8) / 4 if kind < 0.35 else draw.uniform(-2.0, 2.0))


def run_of(draw: Random) -> Run:
    place, speed = draw.choice(SCALES)
    n, walls = draw.randint(1, 12), draw.randint(0, 6)
    flights = []
    for i in range(n):
        r = draw.choice([0.0, 0.25 * place, draw.uniform(0.0, 0.4) * place])
        x, y, vx, vy = number(draw, place), number(draw, place), number(draw, speed), number(draw, speed)
        flights.append((x, y, vx, vy, draw.choice([0.0, 1.0, 1.5]) * place / speed, r, i))
    lines = []
    for k in range(walls):
        nx, ny = draw.choice([(1.0, 0.0), (0.0, -1.0), (3.0, 4.0), (draw.uniform(-1, 1), draw.uniform(-1, 1))])
        at, offset = (number(draw, place), number(draw, place)), draw.choice([0.5, 0.0]) * place
        lines.append((n + k, *at, nx, ny, offset, nx * nx + ny * ny, draw.random() < 0.5))
    until = [draw.choice([inf, draw.uniform(0.0, 4.0) * place / speed]) for _ in range(n)] + [inf] * walls
    return Run(flights, lines, until, [draw.randrange(2**40) for _ in range(n + walls)])


def bits(value: object) -> object:
    if isinstance(value, float):
        return value.hex()
    return tuple(map(bits, value)) if isinstance(value, list | tuple) else value


@pytest.mark.parametrize("seed", range(60))
def test_both_queue_the_same(seed: int) -> None:
    queued = looked = 0
    for k in range(50):
        runs = [run_of(Random(1000 * seed + k)) for _ in range(2)]
        for run, code in zip(runs, (flying, compiled), strict=True):
            draw = Random(k)
            for i in range(len(run.flights)):
                places = range(len(run.until))
                standing = draw.choice([(), (i,), {i, draw.choice(places)}, tuple(draw.sample(places, 1))])
                assert code is not None
                code.walls(run, i, run.lines, standing)
                code.pairs(run, i, draw.choice([run.flights, map(run.flights.__getitem__, range(i))]), standing)
        one, other = runs
        assert bits([one.heap, one.until, one.closer]) == bits([other.heap, other.until, other.closer])
        queued += len(one.heap)
        looked += len(one.closer)
    assert queued > 50
    assert looked > 100


@pytest.mark.parametrize("name", ["pairs", "walls"])
def test_what_is_not_asked_rightly_is_refused(name: str) -> None:
    run = run_of(Random(4))
    code = getattr(compiled, name)
    for given in [
        (run, 99, [], ()), (run, -1, [], ()), (run, "", [], ()), (run, 0, 5, ()), (run, 0, [()], ()),
        (run, 0, [("",) * 8], ()), (run, 0, [("",) * 7], ()), (run, 0), (None, 0, [], ()),
        (Run([5], [], [inf], [0]), 0, [], ()),
    ]:  # fmt: skip
        with pytest.raises((TypeError, IndexError, AttributeError)):
            code(*given)
    far = Run([(0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0), (9.0, 0.0, -1.0, 0.0, 0.0, 1.0, 7)], [], [inf] * 2, [0] * 2)
    if name == "pairs":
        with pytest.raises(IndexError, match="place"):
            code(far, 0, far.flights, (0,))


def test_an_error_of_what_is_called_is_handed_on() -> None:
    assert compiled is not None
    two: Any = Run([(0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0), (1.0, 0.0, -1.0, 0.0, 0.0, 1.0, 1)], [], [inf] * 2, [0] * 2)

    def fails(*of: object) -> None:
        raise KeyError(of)

    two.unsure = fails
    with pytest.raises(KeyError, match="0, 1"):
        compiled.pairs(two, 0, two.flights, (0,))
    apart: Any = Run([(0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0), (9.0, 0.0, -1.0, 0.0, 0.0, 1.0, 1)], [], [inf] * 2, [0] * 2)
    apart.tick = fails
    with pytest.raises(KeyError):
        compiled.pairs(apart, 0, apart.flights, (0,))
    assert apart.heap == []
