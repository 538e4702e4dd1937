"""No decision is wrong at any precision: fewer bits than were asked for, or numbers that cancel, leave one open."""

from __future__ import annotations

import math
import random
from fractions import Fraction as Q
from typing import Any

import flint
import pytest

from truebreak.exact import ExactEngine
from truebreak.exact.certified import certified_decider as bits_of_a_run
from truebreak.exact.certified import filtered as prediction
from truebreak.exact.simulation.prediction import FloatLine
from truebreak.scenarios import Circle, Quantity, Scene, Trajectory, Wall, catalogue
from truebreak.scenarios.numbers import precision

SCENES = {
    "inscribed:n=3": 6,
    "gas:n=3": 25,
    "rack:rows=3": 6,
    "lorentz": 10,
    "siam": 10,
    "pinball": 10,
    "point": 10,
    "corner": 5,
    "cradle": 8,
}


class FewerBits:
    """Flint's context as `precision` sees it: now and then a setting has fewer bits than it was asked for."""

    def __init__(self, seed: int, share: float) -> None:
        self._draw = random.Random(seed)
        self._share = share
        self._told = flint.ctx.prec

    @property
    def prec(self) -> int:
        return self._told

    @prec.setter
    def prec(self, bits: int) -> None:
        self._told = bits
        few = self._draw.random() < self._share
        flint.ctx.prec = min(bits, self._draw.choice((2, 3, 10, 30, 53))) if few else bits


def story(run: Trajectory) -> tuple[list[Any], list[Any]]:
    return [sorted(map(tuple, e.contacts)) for e in run.events], [(p.circle, p.pocket) for p in run.pocketings]


def check(name: str, seeds: range, monkeypatch: pytest.MonkeyPatch, share: float) -> int:
    """How many events were decided, all as in the undisturbed run."""
    scene, events = catalogue.build(name), SCENES[name]
    true = ExactEngine().run(scene, events=events)
    contacts, entries = story(true)
    decided = 0
    for seed in seeds:
        with monkeypatch.context() as patched:
            patched.setattr(precision, "ctx", FewerBits(seed, share))
            run = ExactEngine(max_bits=1 << 14, work=200_000).run(scene, events=events)
        mine, entered = story(run)
        assert mine == contacts[: len(mine)], seed
        assert entered == entries[: len(entered)], seed
        for event, other in zip(run.events, true.events, strict=False):
            assert event.time.ball(200).overlaps(other.time.ball(200)), (seed, event.index)
        decided += len(mine)
    return decided


@pytest.fixture(autouse=True)
def _restored():
    before = flint.ctx.prec
    yield
    flint.ctx.prec = before


@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize("centred_from", [8_000, 300], ids=["balls", "midpoints"])
def test_no_decision_is_wrong_at_any_precision(name: str, centred_from: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bits_of_a_run, "LONG_BITS", centred_from)
    assert sum(check(name, range(5), monkeypatch, share) for share in (0.001, 0.01, 0.1)) > 0


@pytest.mark.slow
@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize("centred_from", [8_000, 300], ids=["balls", "midpoints"])
def test_no_decision_is_wrong_at_any_precision_at_length(
    name: str, centred_from: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(bits_of_a_run, "LONG_BITS", centred_from)
    assert sum(check(name, range(100, 300), monkeypatch, share) for share in (0.001, 0.01, 0.1)) > 0


def test_a_decision_that_trusts_few_bits_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """A wall of too few bits that is parted from by its doubles: what the law above once found."""
    sharp = prediction.float_line

    def trusting(wall: int, *numbers: flint.arb) -> FloatLine:
        told = sharp(wall, *numbers)
        return told._replace(norm=abs(told.nx) + abs(told.ny))

    monkeypatch.setattr(prediction, "float_line", trusting)
    with pytest.raises(AssertionError):
        for share in (0.001, 0.01, 0.1):
            check("inscribed:n=3", range(30), monkeypatch, share)


def below(n: int, bits: int) -> Quantity:
    """sqrt(n) less a fraction that is within 2**-bits of it."""
    return Quantity.of(n).sqrt() - Q(math.isqrt(n << (2 * bits)), 1 << bits)


@pytest.mark.parametrize("bits", [244, 250, 252, 254, 258, 300])
def test_a_wall_is_met_whatever_bits_cancel_in_its_normal(bits: int) -> None:
    nx, ny = below(2, bits), below(3, bits)
    angle = math.atan2(float(ny), float(nx)) + math.pi / 2
    x, y = round(600 * math.sin(angle)), -round(600 * math.cos(angle))
    for tilt in (-0.1, -0.001, 0.001, 0.02, 0.1):
        vx, vy = round(1e4 * math.cos(angle + tilt)), round(1e4 * math.sin(angle + tilt))
        comes = (nx * vx + ny * vy).sign() < 0
        run = ExactEngine().run(Scene([Circle(x, y, 1, vx, vy)], [Wall(0, 0, -ny, nx)]), events=1)
        assert (nx * x + ny * y).sign() > 0
        assert len(run.events) == comes


@pytest.mark.parametrize("bits", [90, 100, 110, 118])
@pytest.mark.parametrize("n", [2, 3, 5, 7])
def test_circles_meet_whatever_bits_cancel_in_their_radii(n: int, bits: int) -> None:
    r, unit = below(n, bits), Q(1, 2 << bits)
    for k in range(-8, 9):
        aside = Q(2 * float(r)) * (1 + Q(k, 1 << (128 - bits)))
        run = ExactEngine().run(Scene([Circle(0, 0, r, 1, 0), Circle(20 * unit, aside, r)]), events=1)
        assert len(run.events) == (2 * r - aside > 0)
