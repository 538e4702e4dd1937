"""Every bound of a set holds: against a log carried out with 4,096 bits, and against the same set in plain matrices."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from functools import cache
from math import cos, hypot, inf, sin
from random import Random
from typing import Any

import numpy as np
import pytest
from flint import arb

from error_bound.campaign import LATER, PILOT, tallies
from error_bound.oracle import Line, Plane, fallen, quartic, rebounded, value_at
from error_bound.scenes import KINDS, scene_of
from error_bound.watch import Tally, watched, watched_wide
from truebreak.exact.numbers import ball
from truebreak.exact.replay import centred_state, deviations, error_set
from truebreak.exact.replay import deviations as carrying
from truebreak.exact.replay.centred_state import CentredState
from truebreak.exact.replay.deviations import Deviations
from truebreak.exact.replay.error_bounds import (
    CARRIED,
    CLOSE,
    SMALL_WAIT,
    Bounds,
    fall_derivative,
    pair_derivative,
    wall_steepness,
)
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


Spoil = Callable[[pytest.MonkeyPatch], None]


def other_fall(factor: float) -> Spoil:
    """What gravity adds to a bounce off a wall is another part of it."""

    def spoil(monkeypatch: pytest.MonkeyPatch) -> None:
        real = error_set.fall_turn

        def turned(*given: Any) -> Any:
            return tuple(factor * part for part in real(*given))

        monkeypatch.setattr(error_set, "fall_turn", turned)

    return spoil


def halved_slope(monkeypatch: pytest.MonkeyPatch) -> None:
    """Half of a wall that falls is mirrored."""
    real = deviations.slope_of

    def halved(*given: Any) -> Any:
        slope = real(*given)
        return slope._replace(strength=slope.strength / 2)

    for module in (deviations, centred_state):
        monkeypatch.setattr(module, "slope_of", halved)


@cache
def unspoilt(name: str) -> Tally:
    """What is found of a scene where nothing is spoilt."""
    return watched_wide(scene_of(name), 40, at_once=True)


FALLS = [other_fall(-1.0), other_fall(0.0), other_fall(0.9), other_fall(1.1), halved_slope]


@pytest.mark.parametrize("spoil", FALLS, ids=["false sign", "missing", "10 % less", "10 % more", "mirror"])
@pytest.mark.parametrize("name", ["dropped 0", "dropped 1", "wedge:slope=2", "wedge"])
def test_a_false_derivative_at_a_wall_that_falls_is_seen(
    name: str, spoil: Spoil, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of one circle: what is spoilt shows as a block ends, after twenty contacts of each, or sooner."""
    scene = scene_of(name)
    plain = unspoilt(name)
    assert not plain.faults and plain.blocks and plain.at_once
    in_python(monkeypatch)
    spoil(monkeypatch)
    assert all(watched_wide(scene, 40, at_once=at_once).faults for at_once in (True, False))


def halved_turn(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a collision, what a place does to a velocity is half of it, but for what gravity adds."""
    real = error_set.pair_tangent_blocks

    def turned(*given: Any) -> Any:
        xx, xy, yy, *turn = real(*given)
        return xx, xy, yy, *(part / 2 for part in turn)

    monkeypatch.setattr(error_set, "pair_tangent_blocks", turned)


ROUND = [*FALLS[:4], halved_turn, other_turn]


@pytest.mark.parametrize("spoil", ROUND, ids=["false sign", "missing", "10 % less", "10 % more", "half", "turned"])
@pytest.mark.parametrize("name", ["peg_alone 0", "peg_alone 1", "ring_alone 0", "ring_alone 1"])
def test_a_false_derivative_onto_something_round_is_seen(
    name: str, spoil: Spoil, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of one circle that falls onto fixed ones, or within a ring."""
    scene = scene_of(name)
    plain = unspoilt(name)
    assert not plain.faults and plain.blocks and plain.at_once == 39
    spoil(monkeypatch)
    assert all(watched_wide(scene, 40, at_once=at_once).faults for at_once in (True, False))


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


def test_the_norm_of_a_bounce_off_a_wall_that_falls_is_that_of_its_matrix() -> None:
    """What a place adds to a velocity, at most, and how far the instant moves: no less, and no more than roundings."""
    draw, unit = Random(3), 0.25
    for _ in range(2_000):
        nx, ny = draw.uniform(-5, 5), draw.uniform(-5, 5)
        nn = nx * nx + ny * ny
        speed, pull, share = draw.uniform(0.01, 9), draw.uniform(-9, 9), draw.choice([1.0, 0.9, 0.5])
        hit = fall_derivative(nx, ny, speed, -2 * share / nn, pull, unit, 1e-30, 1e-30, CLOSE)
        assert hit is not None
        hits = np.array([[*error_set.STILL, *error_set.STILL, 1.0, 0.0, *hit[3:]]])
        *_, xx, xy, yx, yy = error_set._blocks(hits, unit)[:, 0].tolist()
        norm = np.linalg.norm([[xx, xy], [yx, yy]], 2)
        assert 1 - 1e-12 < 2.0 * hit.turn / norm < 1 + 1e-9
        assert 1 - 1e-12 < hit.steep * speed / nn**0.5 < 1 + 1e-9


def test_a_bounce_off_a_wall_that_falls_is_given_up_where_its_speed_is_not_told() -> None:
    """Its derivative has the speed in it: where a place or a velocity may change that by 2**-50, there is none."""
    at = {"place": 2.0**-52, "pace": 2.0**-52}
    for name, most in at.items():
        for over in (0.999, 1.001):
            errors = dict.fromkeys(at, 0.0) | {name: 2 * most * over}
            # n.v is 2, n.g -4, and |n| 2: the instant moves by the place, n.v by 4 times that, and by 2 of the velocity
            found = fall_derivative(0.0, 2.0, 2.0, -0.5, -4.0, 0.5, errors["place"], errors["pace"], CLOSE)
            assert (found is None) is (over > 1), (name, over)


def off_of_a_fall(draw: Random, over: float) -> tuple[float, float]:
    """By how much a bounce off a wall that falls differs from its derivative, beside the bounds of its place and its
    velocity, where a deviation is `over` times what may be: the textbook's lines, 400 bits, against doubles.

    Args:
        draw: decides.
        over: times the largest deviation.
    """
    unit, share, t = 2.0 ** draw.randrange(-3, 4), draw.choice([1.0, 0.95, 0.6]), draw.uniform(0.1, 90)
    nx, ny, pull, speed = (draw.uniform(-3, 3), draw.uniform(-3, 3), draw.uniform(-5, 5), draw.uniform(0.01, 5))
    nn = nx * nx + ny * ny
    with ball.precision(400):
        normal, half, n2 = (arb(nx), arb(ny)), arb(pull) / 2, arb(nx) ** 2 + arb(ny) ** 2
        plane = Plane(arb(1), arb(2), *normal, arb(draw.uniform(-1, 1)), half)
        across = (n2.sqrt() + plane.drift * t - half * t * t) / n2, (plane.drift - pull * arb(t) - speed) / n2
        slide = draw.uniform(-9, 9), draw.uniform(-9, 9)
        x, vx = (across[k] * normal[0] - slide[k] * normal[1] for k in range(2))
        y, vy = (across[k] * normal[1] + slide[k] * normal[0] for k in range(2))
        late = arb(unit * 2.0**-49 * draw.uniform(-1, 1)) / max(1.0, abs(pull) / speed * unit / 16)
        line = Line(x + 1 - vx * late, y + 2 - vy * late, vx, vy, arb(t) - late)
        place, pace = 10.0 ** draw.uniform(-4, 0), 10.0 ** draw.uniform(-4, 0)
        found = fall_derivative(nx, ny, speed, -2.0 * share / nn, pull, unit, place * 1e-30, pace * 1e-30, CLOSE)
        assert found is not None
        bend = abs(pull) / speed * found.steep * place
        most = CLOSE / max(found.steep * pace / unit + bend, found.steep * place * max(found.turn, 16) / (32 * unit))
        place, pace = place * most * over, pace * most * over
        ways = [draw.uniform(0, 7) for _ in range(2)]
        d = [size * part for size, a in zip((place, pace), ways, strict=True) for part in (cos(a), sin(a))]
        moved = Line(*(p + q / k for p, q, k in zip(line[:4], d, (1, 1, unit, unit), strict=True)), line.t)
        e = arb(2 * share) - 1
        after = [rebounded(one, plane, arb(1), 1, e, line.t)[:4] for one in (line, moved)]
        change = [(q - p) * k for p, q, k in zip(*after, (1, 1, unit, unit), strict=True)]
        hits = np.array([[*error_set.STILL, *error_set.STILL, 1.0, 0.0, *found[3:]]])
        (matrix,) = error_set._maps(hits, error_set._blocks(hits, unit))
        told = [sum((arb(m) * q for m, q in zip(row[:4], d, strict=True)), arb(0)) for row in matrix[:4]]
        off = [float(abs(p - q)) for p, q in zip(change, told, strict=True)]
    far = place + SMALL_WAIT * pace, pace + 2.0 * found.turn * place
    return hypot(*off[:2]) / far[0], hypot(*off[2:]) / far[1]


def test_what_the_derivative_of_a_fall_differs_by_is_less_than_a_step_leaves() -> None:
    """Up to the largest deviation that is carried at all; of one 2**12 times as large it is not so."""
    draw = Random(5)
    worst = max(max(off_of_a_fall(draw, 0.99)) for _ in range(1_000))
    assert CARRIED / 2**9 < worst < CARRIED / 2
    assert max(max(off_of_a_fall(draw, 2.0**12)) for _ in range(1_000)) > CARRIED


def bounced(draw: Random, bend: float) -> dict[str, Any]:
    """A collision with something round, at random: d and v at the hit, of a circle of weight 1, a, e, the unit.

    Args:
        draw: decides.
        bend: the most of a.
    """
    while True:
        size = draw.uniform(0.1, 4)
        dx, dy, vx, vy, ax, ay = (draw.uniform(-1, 1) * most for most in (size, size, 1, 1, bend, bend))
        along, d, v = dx * vx + dy * vy, hypot(dx, dy), hypot(vx, vy)
        if abs(along) > 0.03 * d * v and v > 0.05 and d > 0.05:
            unit, e = 2.0 ** draw.randrange(-3, 4), draw.choice([1.0, 0.9, 0.2])
            return {"d": (dx, dy), "v": (vx, vy), "a": (ax, ay), "along": along, "e": e, "unit": unit}


def derivative_of(met: dict[str, Any], place: float, pace: float) -> Any:
    """Its derivative, or None."""
    (dx, dy), (vx, vy), e = met["d"], met["v"], met["e"]
    strength = -(1.0 + e) / (dx * dx + dy * dy)
    return pair_derivative(dx, dy, vx, vy, -met["along"], strength, met["unit"], place, pace, CLOSE, *met["a"])


def test_the_norm_of_a_bounce_off_something_round_is_no_less_than_that_of_its_matrix() -> None:
    """With and without a pull; of a flat bounce, and a pull away from it, no more than a hundredth larger."""
    draw = Random(6)
    for _ in range(4_000):
        met, flat = bounced(draw, draw.choice([0.0, 0.3, 30.0])), draw.random() < 0.2
        if flat:
            (dx, dy), most = met["d"], draw.choice([0.0, 9.0])
            met |= {"v": (dy + dx / 30, dy / 30 - dx), "a": (dx * most, dy * most), "along": (dx * dx + dy * dy) / 30}
        hit = derivative_of(met, 1e-40, 1e-40)
        hits = np.array([[*error_set.STILL, *error_set.STILL, 1.0, 0.0, *hit[3:]]])
        *_, xx, xy, yx, yy = error_set._blocks(hits, met["unit"])[:, 0].tolist()
        share = (1 + met["e"]) * hit.turn / np.linalg.norm([[xx, xy], [yx, yy]], 2)
        assert share > 1 - 1e-12 and not (flat and share > 1.01)


def test_a_bounce_off_something_round_is_given_up_where_its_speed_is_not_told() -> None:
    """What gravity bends a flight by enters u: where a place may change that by 2**-50, there is no derivative."""
    for over in (0.999, 1.001):
        # |d| is 2, |v| 1, k 1: the instant moves by the place, d by twice that, and u by 10**6 of it
        place = 2.0**-50 / (1 + 10.0**6) * over
        found = pair_derivative(2.0, 0.0, -1.0, 0.0, 2.0, -0.5, 1.0, place, 0.0, CLOSE, 0.0, 10.0**6)
        assert (found is None) is (over > 1), over


def off_of_a_round(draw: Random, over: float) -> tuple[float, float]:
    """As `off_of_a_fall`, of a circle and something round that it falls onto, or is within."""
    met = bounced(draw, draw.choice([0.1, 1.0, 20.0]))
    (dx, dy), (vx, vy), (ax, ay), unit = met["d"], met["v"], met["a"], met["unit"]
    with ball.precision(400):
        t, (gx, gy) = arb(draw.uniform(0.1, 90)), (arb(ax), arb(ay))
        plain = derivative_of(met, 1e-40, 1e-40)
        late = arb(unit * 2.0**-49 * draw.uniform(-1, 1) * 16 / max(plain.turn, 16.0))
        x, y = arb(dx) - gx * t * t / 2, arb(dy) - gy * t * t / 2
        wx, wy = arb(vx) - gx * t, arb(vy) - gy * t
        line = Line(x - wx * late, y - wy * late, wx, wy, t - late)
        place, pace = 10.0 ** draw.uniform(-4, 0), 10.0 ** draw.uniform(-4, 0)
        d, v, a = hypot(dx, dy), hypot(vx, vy), hypot(ax, ay)
        k = v * plain.steep
        asked = k * ((1 + k) * place / d + pace / (unit * v) + k * a * place / v**2)
        most = CLOSE / max(asked, plain.steep * place * max(plain.turn, 16) / (32 * unit))
        place, pace = place * most * over, pace * most * over
        assert over > 1 or derivative_of(met, place, pace) is not None
        ways = [draw.uniform(0, 7) for _ in range(2)]
        off = [size * part for size, way in zip((place, pace), ways, strict=True) for part in (cos(way), sin(way))]
        moved = Line(*(p + q / n for p, q, n in zip(line[:4], off, (1, 1, unit, unit), strict=True)), line.t)
        still, reach = Line(*[arb(0)] * 5), (arb(dx) ** 2 + arb(dy) ** 2).sqrt()
        after = []
        for one in (line, moved):
            c, s = quartic(one, still, reach, (gx, gy)), late
            for _ in range(8):
                s = (s - value_at(c, s) / value_at([n * part for n, part in enumerate(c)][1:], s)).mid()
            after.append(fallen(one, still, arb(met["e"]), (gx, gy), one.t + s, one.t)[:4])
        change = [(q - p) * n for p, q, n in zip(*after, (1, 1, unit, unit), strict=True)]
        hits = np.array([[*error_set.STILL, *error_set.STILL, 1.0, 0.0, *plain[3:]]])
        (matrix,) = error_set._maps(hits, error_set._blocks(hits, unit))
        told = [sum((arb(m) * q for m, q in zip(row[:4], off, strict=True)), arb(0)) for row in matrix[:4]]
        beside = [float(abs(p - q)) for p, q in zip(change, told, strict=True)]
    far = place + SMALL_WAIT * pace, pace + 2.0 * plain.turn * place
    return hypot(*beside[:2]) / far[0], hypot(*beside[2:]) / far[1]


def test_what_the_derivative_onto_something_round_differs_by_is_less_than_a_step_leaves() -> None:
    """Up to the largest deviation that is carried at all; of one 2**12 times as large it is not so."""
    draw = Random(7)
    worst = max(max(off_of_a_round(draw, 0.99)) for _ in range(1_000))
    assert CARRIED / 2**9 < worst < CARRIED / 2
    assert max(max(off_of_a_round(draw, 2.0**12)) for _ in range(1_000)) > CARRIED
