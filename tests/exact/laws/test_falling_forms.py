"""Walls that fall and move, as the engines' code has them, are what the law says in true coordinates; faults are found.

The code runs on SymPy's symbols, or on rational numbers where it asks for signs, and is compared with the gap of a
parabola and a wall that moves, written down here and differentiated by SymPy.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from random import Random
from typing import Any

import pytest
from sympy import Expr, Rational, diff, expand, sign, simplify, sqrt, symbols

from truebreak.exact.laws import formulas, tangent_formulas
from truebreak.exact.laws.tangent_formulas import fall_turn
from truebreak.exact.replay import wall_flights
from truebreak.exact.replay.contact import Gravity

X, Y, VX, VY, CLOCK, LATER = symbols("X Y V_x V_y t s", real=True)
GX, GY, UX, UY = symbols("g_x g_y u_x u_y", real=True)
X0, Y0, NX, NY, R = symbols("x_0 y_0 n_x n_y r", real=True)
E = symbols("e", positive=True)
LENGTH = sqrt(NX**2 + NY**2)
WALL = wall_flights.SeenWall(X0, Y0, NX, NY, NX**2 + NY**2, LENGTH)


def true_flight(bent: bool) -> tuple[Any, Any, Any, Any]:
    """x, y, vx, vy at the clock: as they are given, or given in the frame that falls."""
    if bent:
        return X, Y, VX, VY
    return X + GX * CLOCK**2 / 2, Y + GY * CLOCK**2 / 2, VX + GX * CLOCK, VY + GY * CLOCK


def true_gap(bent: bool) -> Expr:
    """The distance times |n| a time s after the clock."""
    x, y, vx, vy = true_flight(bent)
    then = CLOCK + LATER
    x, y = x + vx * LATER + GX * LATER**2 / 2, y + vy * LATER + GY * LATER**2 / 2
    return NX * (x - X0 - UX * then) + NY * (y - Y0 - UY * then) - R * LENGTH


def gaps() -> Iterator[Expr]:
    """Gap, its rate and half of its pull, in the frame that falls and in true coordinates."""
    for bent in (False, True):
        told = wall_flights.fall_of(
            Gravity(GX / 2, GY / 2, bent), (X, Y, VX, VY, CLOCK), WALL, R * LENGTH, (UX, UY), Rational(0)
        )
        gap = true_gap(bent)
        yield told.gap - gap.subs(LATER, 0)
        yield told.approach - diff(gap, LATER).subs(LATER, 0)
        yield 2 * told.half - diff(gap, LATER, 2)


def alongs() -> Iterator[Expr]:
    """Where along a face a circle is, how fast that grows, and half of the pull along it."""
    for bent in (False, True):
        x, y, vx, vy = true_flight(bent)
        place = (
            formulas.face_along(X, Y, X0, Y0, NX, NY),
            formulas.face_along(VX, VY, Rational(0), Rational(0), NX, NY),
        )
        along, slide, half = wall_flights.along_of(Gravity(GX / 2, GY / 2, bent), place, WALL, CLOCK, Rational(0))
        yield along - (NY * (x - X0) - NX * (y - Y0))
        yield slide - (NY * vx - NX * vy)
        yield 2 * half - (NY * GX - NX * GY)


def meetings() -> Iterator[Expr]:
    """At the time told the true gap is 0 and falls as fast as told; then the push turns the speed into -e of it."""
    rng = Random(7)
    at = lambda low, high: Rational(rng.randint(low, high), rng.randint(1, 9))  # noqa: E731
    kinds: set[tuple[int, bool]] = set()
    while len(kinds) < 4:  # where gravity pulls to the wall, rising and falling; else falling alone
        values = {X: at(-9, 9), Y: at(1, 60), VX: at(-9, 9), VY: at(-30, 30), CLOCK: at(0, 9)}
        values |= {X0: at(-9, 9), Y0: at(-9, 9)}
        values |= {NX: Rational(3 * rng.choice((-1, 1))), NY: Rational(4), R: at(0, 3), UX: at(-4, 4), UY: at(-4, 4)}
        values |= {GX: at(-9, 9), GY: at(-9, 9)}
        if rng.random() < 0.3:
            values[GX] = -values[NY] * values[GY] / values[NX]
        across = values[NX] * values[GX] + values[NY] * values[GY]
        pull = int(sign(across))
        seen = wall_flights.SeenWall(*(values.get(q, 0) for q in (X0, Y0, NX, NY)), Rational(25), Rational(5))
        e, zero = at(1, 9) / 10, Rational(0)
        wall = wall_flights.falling_wall(
            seen, values[R], Gravity(values[GX] / 2, values[GY] / 2, False), pull, (values[UX], values[UY]),
            lambda change, e=e: change * (1 + e) / 2, zero,
        )  # fmt: skip
        met = wall.met(*(values[q] for q in (X, Y, VX, VY, CLOCK)), zero, sqrt)
        if met is None:
            continue
        wait, speed = met
        gap = true_gap(False).subs(values)
        kinds.add((pull, bool(diff(gap, LATER).subs(LATER, 0) < 0)))
        yield gap.subs(LATER, wait)
        rate = diff(gap, LATER).subs(LATER, wait)
        yield rate + speed
        turned = rate + values[NX] * wall.turn_x * speed + values[NY] * wall.turn_y * speed  # a wall takes no impulse
        yield turned + e * rate
        yield values[NY] * wall.turn_x - values[NX] * wall.turn_y


def displacements() -> Iterator[Expr]:
    """Who comes later by tau to a wall that moves meets it as one that stands, in the frame of the wall."""
    px, py, qx, qy, h = symbols("p_x p_y q_x q_y h", real=True)
    vx, vy = VX - UX, VY - UY
    tau = -(NX * px + NY * py) / (NX * vx + NY * vy)
    normal, square = (NX, NY), NX**2 + NY**2

    def after(speed: tuple[Any, Any]) -> tuple[Any, Any]:
        push = (1 + E) * (NX * speed[0] + NY * speed[1]) / square
        return speed[0] - push * NX, speed[1] - push * NY

    came = after((vx + h * (qx + GX * tau), vy + h * (qy + GY * tau)))
    left = after((vx, vy))
    slow = [diff(part, h).subs(h, 0) - pull * tau for part, pull in zip(came, (GX, GY), strict=True)]
    place = [p + (before - later) * tau for p, before, later in zip((px, py), (vx, vy), left, strict=True)]
    moved = formulas.wall_bounce(px, py, *normal, square)
    told = [formulas.damped(p, m, (1 + E) / 2) for p, m in zip((px, py), moved, strict=True)]
    yield from (one - other for one, other in zip(told, place, strict=True))
    fallen = tangent_formulas.fall_turn(*normal, square, NX * vx + NY * vy, NX * GX + NY * GY, px, py)
    mirrored = formulas.wall_bounce(qx, qy, *normal, square)
    for q, turned, more, expected in zip((qx, qy), mirrored, fallen, slow, strict=True):
        yield formulas.damped(q, turned + more, (1 + E) / 2) - expected


@pytest.mark.parametrize("lemma", [gaps, alongs, meetings, displacements], ids=lambda lemma: lemma.__name__)
def test_what_falls_and_moves_is_as_the_law_has_it(lemma: Callable[[], Iterator[Expr]]) -> None:
    differences = list(lemma())
    assert len(differences) >= 4
    assert all(is_nothing(difference) for difference in differences)


def is_nothing(difference: Expr) -> bool:
    return bool(expand(difference) == 0 or simplify(difference) == 0)


TEN = Rational(11, 10)


def turned_by(share: Any) -> Callable[..., Any]:
    """So much of what the fall turns a displacement by."""
    return lambda *args: tuple(share * part for part in fall_turn(*args))


FAULTS: dict[str, tuple[Callable[[], Iterator[Expr]], Any, str, Callable[..., Any]]] = {
    "a rate of the wrong sign": (gaps, wall_flights, "fall_speed", lambda v, half, t: v - 2 * half * t),
    "a rate off by a tenth": (gaps, wall_flights, "fall_speed", lambda v, half, t: v + 2 * TEN * half * t),
    "a rate that is missing": (gaps, wall_flights, "fall_speed", lambda v, half, t: v),
    "a fall of the wrong sign": (gaps, wall_flights, "sag", lambda x, v, half, t: x + v * t - half * t**2),
    "a wall that stands": (gaps, wall_flights, "advance", lambda x, v, t: x),
    "a wall that moves back": (gaps, wall_flights, "advance", lambda x, v, t: x - v * t),
    "a place off by a tenth": (alongs, wall_flights, "sag", lambda x, v, half, t: x + v * t + TEN * half * t**2),
    "a slide without the fall": (alongs, wall_flights, "fall_speed", lambda v, half, t: v),
    "the other zero": (meetings, wall_flights, "fall_time_back", lambda v, half, root: (-v + root) / (2 * half)),
    "a discriminant off": (meetings, wall_flights, "fall_discriminant", lambda g, v, h: v**2 - 4 * TEN * g * h),
    "a mirror halved": (meetings, wall_flights, "speed_change", lambda v: v),
    "a mirror of the wrong sign": (meetings, wall_flights, "speed_change", lambda v: -2 * v),
    "a drift that is missing": (meetings, wall_flights, "wall_approach", lambda vx, vy, nx, ny: nx * vx),
    "no turn by the fall": (displacements, tangent_formulas, "fall_turn", turned_by(0)),
    "half of the turn": (displacements, tangent_formulas, "fall_turn", turned_by(Rational(1, 2))),
    "a turn of the wrong sign": (displacements, tangent_formulas, "fall_turn", turned_by(-1)),
    "a turn off by a tenth": (displacements, tangent_formulas, "fall_turn", turned_by(TEN)),
}  # fmt: skip


@pytest.mark.parametrize("name", FAULTS)
def test_a_fault_is_found(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    lemma, module, form, wrong = FAULTS[name]
    monkeypatch.setattr(module, form, wrong)
    assert not all(is_nothing(difference) for difference in lemma())
