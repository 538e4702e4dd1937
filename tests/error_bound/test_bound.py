"""Every bound of a set holds: against a log carried out with 4,096 bits, and against the same set in plain matrices."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from math import inf
from random import Random
from typing import Any

import pytest
from flint import arb

from error_bound.campaign import LATER, PILOT, tallies
from error_bound.scenes import KINDS, scene_of
from error_bound.watch import Tally, watched
from truebreak.exact.numbers import ball
from truebreak.exact.replay import centred_state, deviations, error_set
from truebreak.exact.replay import deviations as carrying
from truebreak.exact.replay.centred_state import CentredState
from truebreak.exact.replay.deviations import Deviations
from truebreak.exact.replay.error_bounds import CLOSE, Bounds, pair_derivative, wall_steepness
from truebreak.exact.replay.error_set import ErrorSet
from truebreak.scenarios import Circle, Scene, Wall

OF_THE_CATALOGUE = ("gas:n=3,seed=2", "gas:n=5,seed=1,mixed=yes", "rack:rows=3,gap=0", "lorentz", "stadium", "mushroom")


def bounds_of(name: str, events: int, sets: tuple[int, int] = LATER) -> Tally:
    """A scene's tally, with matrices."""
    long_bits, first_bits = sets
    return watched(scene_of(name), events, long_bits=long_bits, first_bits=first_bits, matrices=True)[1]


@pytest.mark.parametrize("name", [*(f"{kind} 0" for kind in KINDS), *OF_THE_CATALOGUE])
def test_every_number_lies_in_its_bound(name: str) -> None:
    """Sets from the start of a run, those that its replays begin, contacts in one go and in two steps."""
    tally = bounds_of(name, 40, PILOT if name in OF_THE_CATALOGUE else LATER)
    assert not tally.faults
    assert tally.checks > 100 and tally.sets > 0


@pytest.mark.parametrize("name", [*(f"{kind} 1" for kind in KINDS), *OF_THE_CATALOGUE])
def test_every_number_lies_in_its_bound_with_short_clocks(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """As of long numbers: clocks stand 2**-80 of their time beside the instants."""
    monkeypatch.setattr(centred_state, "LONG_NUMBERS", 0)
    monkeypatch.setattr(centred_state, "CLOCK_BITS", 80)
    tally = bounds_of(name, 40, PILOT if name in OF_THE_CATALOGUE else LATER)
    assert not tally.faults
    assert tally.checks > 100 and tally.sets > 0


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_100_000_numbers_lie_in_their_bounds() -> None:
    total = sum((tally for _, tally in tallies(list(KINDS), 100_000)), Tally())
    assert not total.faults
    assert total.in_set >= 100_000 and total.at_once > 3_000 and total.blocks > 300
    assert sum(total.more) / len(total.more) < 2.0


def in_python(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing that is compiled."""
    monkeypatch.setattr(carrying, "steps", None)
    monkeypatch.setattr(error_set, "steps", None)


@pytest.mark.parametrize("name", ["gas:n=3,seed=2", "oblique 0"])
def test_every_number_lies_in_its_bound_in_python_too(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    in_python(monkeypatch)
    assert not bounds_of(name, 40).faults


def halved_norm(monkeypatch: pytest.MonkeyPatch) -> None:
    """The derivative of a collision counts for half."""
    real = deviations.pair_derivative

    def halved(*given: float) -> Any:
        found = real(*given)
        return found and found._replace(turn=found.turn / 2)

    monkeypatch.setattr(deviations, "pair_derivative", halved)


def no_rounding(monkeypatch: pytest.MonkeyPatch) -> None:
    """What new midpoints drop is forgotten."""
    real = Deviations.recentre
    monkeypatch.setattr(Deviations, "recentre", lambda *given: (0.0, real(*given)[1]))


def no_lags(monkeypatch: pytest.MonkeyPatch) -> None:
    """Errors of velocity do not grow with the time of a flight."""
    fly, meet = Bounds.fly, Bounds.meet
    monkeypatch.setattr(Bounds, "fly", lambda bounds, i, lag, *rest: fly(bounds, i, 0.0, *rest))
    monkeypatch.setattr(Bounds, "meet", lambda bounds, i, j, lags, *rest: meet(bounds, i, j, (0.0, 0.0), *rest))


def lost_at_the_end(monkeypatch: pytest.MonkeyPatch) -> None:
    """What is beside the matrix is dropped at the end of a block."""
    real = ErrorSet.close

    def close(errors: ErrorSet) -> None:
        errors.bounds.beside = 0.0
        real(errors)

    monkeypatch.setattr(ErrorSet, "close", close)


def other_turn(monkeypatch: pytest.MonkeyPatch) -> None:
    """The matrix of a collision has the other sign of d x v."""
    real = error_set.pair_tangent_blocks

    def turned(dx: Any, dy: Any, approach: Any, cross: Any, square: Any, c: Any) -> Any:
        return real(dx, dy, approach, -cross, square, c)

    monkeypatch.setattr(error_set, "pair_tangent_blocks", turned)


def never_hollow(monkeypatch: pytest.MonkeyPatch) -> None:
    """What is met from within turns errors as what is met from without."""
    real = deviations.pair_derivative

    def outer(*given: float) -> Any:
        found = real(*given)
        return found and found._replace(speed=abs(found.speed))

    monkeypatch.setattr(deviations, "pair_derivative", outer)


def no_loss(monkeypatch: pytest.MonkeyPatch) -> None:
    """The matrix of a collision is that of an elastic one, whatever is lost."""
    real = Deviations.strength

    def elastic(held: Deviations, state: Any, link: Any) -> float:
        return real(held, state, link) / float(state.share or 1)

    monkeypatch.setattr(Deviations, "strength", elastic)


def whole_mirrors(monkeypatch: pytest.MonkeyPatch) -> None:
    """A wall turns errors around without loss."""
    real = Deviations.face

    def elastic(held: Deviations, state: Any, link: Any) -> Any:
        face = real(held, state, link)
        nx, ny, nn = face.nx, face.ny, face.nx**2 + face.ny**2
        return face._replace(
            mirror=face.mirror._replace(xx=1 - 2 * nx * nx / nn, xy=-2 * nx * ny / nn, yy=1 - 2 * ny * ny / nn)
        )

    monkeypatch.setattr(Deviations, "face", elastic)


@pytest.mark.parametrize("spoil", [no_loss, whole_mirrors])
def test_a_loss_that_the_set_forgets_is_seen(
    spoil: Callable[[pytest.MonkeyPatch], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    spoil(monkeypatch)
    assert any(bounds_of(f"{kind} {k}", 120).faults for kind in ("lossy", "level_and_lossy") for k in range(4))


@pytest.mark.parametrize(("spoil", "name"), [(never_hollow, "stadium"), (never_hollow, "ring 0")])
def test_an_arc_s_bound_that_is_too_small_is_seen(
    spoil: Callable[[pytest.MonkeyPatch], None], name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    spoil(monkeypatch)
    assert bounds_of(name, 120).faults


@pytest.mark.parametrize("spoil", [halved_norm, no_rounding, no_lags, lost_at_the_end, other_turn])
def test_a_bound_that_is_too_small_is_seen(
    spoil: Callable[[pytest.MonkeyPatch], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    in_python(monkeypatch)  # whose parts can be spoilt one by one
    spoil(monkeypatch)
    assert any(bounds_of(name, 120).faults for name in ("gas:n=3,seed=2", "oblique 0", "level 0"))


def test_a_number_near_0_is_off_by_its_own_radius() -> None:
    """Its bits tell nothing of it, and the others' nothing either."""
    with ball.precision(200):
        state = CentredState(Scene([Circle(3, 4, vx=1, vy=2)]))
        body = state.bodies[0]
        held = Deviations([body], [body])
        x, y, vx, vy, t, *_ = body.flight
        wide = arb(0, 2.0**-90)
        for four in ((x, wide, vx, vy), (wide, y, vx, vy), (x, y, vx, wide)):
            rounding, _ = held.recentre([(body, *four)], t, 1)
            unit = held.unit if four[3] is wide else 1.0
            assert 1.0 <= rounding * 2.0**held.errors.shift / (2.0**-90 * unit) < 1.001
        rounding, _ = held.recentre([(body, x, arb("nan"), vx, vy)], t, 1)
        assert rounding == inf


def test_a_derivative_is_that_of_other_units_or_is_not_given() -> None:
    """Lengths and speeds times powers of two: the same to the bit, and nothing beyond what doubles hold."""
    draw, given = Random(1), 0
    for _ in range(4000):
        dx, dy, vx, vy = (draw.uniform(-1, 1) for _ in range(4))
        speed = -(dx * vx + dy * vy)
        if speed < 0.1:
            continue
        plain = pair_derivative(dx, dy, vx, vy, speed, -2.0, 1.0, 1e-20, 1e-20, CLOSE)
        assert plain is not None
        p, shift = draw.randrange(-500, 500), draw.randrange(-60, 60)
        q = p + draw.randrange(-300, 300)
        lengths, speeds = 2.0**p, 2.0**q
        found = pair_derivative(
            dx * lengths, dy * lengths, vx * speeds, vy * speeds, speed * lengths * speeds, -2.0 ** (1 - 2 * p),
            2.0 ** (p - q), 1e-20 * 2.0**shift, 1e-20 * 2.0**shift, CLOSE * 2.0**shift / lengths,
        )  # fmt: skip
        if found is not None:
            given += 1
            assert found.turn == plain.turn and found.steep == plain.steep / speeds
    assert given > 100


def test_a_wall_s_steepness_is_a_bound_however_flat_the_flight() -> None:
    """n and v are known to a rounding each: n.v, where it is small, to many."""
    draw, flat, least = Random(2), 0, Fraction(0)
    for _ in range(6_000):
        nx, ny, vx = (Fraction(draw.randrange(10**25), 10**25) + 1 for _ in range(3))
        vy = -vx * nx / ny * (1 + Fraction(1, 10 ** draw.randrange(1, 10)) * draw.randrange(1, 10))
        told = wall_steepness(float(nx), float(ny), float(vx), float(vy))
        true = (nx + ny) / -(nx * vx + ny * vy)
        if told < inf:
            flat += told > 1e6
            least = min(least, Fraction(told) / true - 1)
    assert flat > 30 and least >= 0


@pytest.mark.parametrize("exponent", [-400, 400])
def test_numbers_beyond_doubles_are_carried_in_balls(exponent: int) -> None:
    """Lengths and speeds that no double holds, in a run that takes sets: none is carried, and nothing fails."""
    scale = Fraction(10) ** exponent
    circles = [Circle(3 * k * scale, k * scale / 7, r=scale, vx=scale * (3 - 2 * k), vy=scale / 3) for k in range(3)]
    walls = [Wall(x * scale, 0, x * scale, scale) for x in (-4, 12)]
    walls += [Wall(0, y * scale, scale, y * scale) for y in (-4, 5)]
    run, tally = watched(Scene(circles, walls), 30, long_bits=100, first_bits=98)
    assert run.motion.log.centred and not tally.faults and tally.in_set == 0
