"""Proofs that the stable forms, as written, are the laws that SymPy derives: `python docs/studies/law_proofs.py`.

What is proved is the text itself: the functions as written are run on the article's symbols, and
what they return must equal, identically, what `derivation.py` derived.
"""

from __future__ import annotations

import argparse
import sys
import textwrap
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, TextIO

from law_forms import (
    FORMS,
    TANGENT_FORMS,
    R,
    StableForm,
    approach,
    dx,
    dy,
    e,
    gap,
    px,
    py,
    qx,
    qy,
    render,
    share,
    tangent_text,
    tau,
    vx,
    vy,
    wa,
    wb,
)
from sympy import Expr, Integer, diff, solve, sqrt, symbols, together

from truebreak.exact.laws.derivation import (
    LawError,
    Statement,
    a_m,
    a_r,
    a_vx,
    a_vy,
    a_x,
    a_y,
    aprime_x,
    aprime_y,
    b_m,
    b_r,
    b_vx,
    b_vy,
    b_x,
    b_y,
    bprime_x,
    bprime_y,
    falling_flight,
    fixed_circle_velocities,
    gravity,
    is_zero,
    pair_instant_speed,
    pair_restitution_velocities,
    pair_times,
    pair_touch,
    pair_velocities,
    restitution,
    t,
    w_x0,
    w_x1,
    w_y0,
    w_y1,
    wall_aim_point,
    wall_instant_speed,
    wall_restitution_velocities,
    wall_times,
    wall_velocities,
    x0,
    x1,
    y0,
    y1,
)

LAWS = Path(__file__).resolve().parents[2] / "exact" / "laws"
FORMULAS, TANGENT_FORMULAS = LAWS / "formulas.py", LAWS / "tangent_formulas.py"


@dataclass(frozen=True)
class Proof:
    """A stable form and what it must equal: `difference` of the functions as written must vanish.

    Attributes:
        name: the law, in words.
        law: the function of `derivation.py` that derives it.
        difference: from the written functions by name to expressions that must be zero.
    """

    name: str
    law: Callable[[], Any]
    difference: Callable[[Mapping[str, Callable[..., Any]]], tuple[Expr, ...]]


_d = (b_x - a_x, b_y - a_y)
_v = (b_vx - a_vx, b_vy - a_vy)
_radii = a_r + b_r
_distance = sqrt(_d[0] ** 2 + _d[1] ** 2)
_normal = (y0 - y1, x1 - x0)
_length = sqrt(_normal[0] ** 2 + _normal[1] ** 2)


def _pair_times(formulas: Mapping[str, Callable[..., Any]]) -> tuple[Expr, ...]:
    earlier, later = pair_times()
    discriminant = formulas["pair_discriminant"](*_d, *_v, _radii)
    gap, approach = formulas["pair_gap"](*_d, _radii), formulas["pair_approach"](*_d, *_v)
    speed2 = _v[0] ** 2 + _v[1] ** 2
    return (
        formulas["pair_hit_time"](gap, approach, sqrt(discriminant)) - earlier,
        later - earlier - 2 * sqrt(discriminant) / speed2,  # so the earlier one is the earlier one
    )


def _pair_turned(formulas: Mapping[str, Callable[..., Any]]) -> tuple[Expr, ...]:
    """d.v as approaching circles have it, and d x v, whose square is what Lagrange's identity leaves."""
    along, cross = formulas["pair_turned"](*_d, *_v)
    approach, square = formulas["pair_approach"](*_d, *_v), _v[0] ** 2 + _v[1] ** 2
    return (
        along + pair_instant_speed() * _distance,
        cross - _d[0] * _v[1] + _d[1] * _v[0],
        cross**2 + approach**2 - square * _distance**2,
    )


def _pair_nearest(formulas: Mapping[str, Callable[..., Any]]) -> tuple[Expr, ...]:
    """Half-way between the two times of touch, which are one where the circles graze."""
    earlier, later = pair_times()
    approach = formulas["pair_approach"](*_d, *_v)
    return (2 * formulas["pair_nearest_time"](approach, *_v) - earlier - later,)


def _pair_meeting(formulas: Mapping[str, Callable[..., Any]]) -> tuple[Expr, ...]:
    """The earlier time of touch, d after a flight of that duration, and the impulse that d and d.v then give."""
    approach, cross = formulas["pair_approach"](*_d, *_v), _d[0] * _v[1] - _d[1] * _v[0]
    square = _v[0] ** 2 + _v[1] ** 2
    root = sqrt(formulas["pair_discriminant"](*_d, *_v, _radii))
    wait, *there = formulas["pair_meeting"](approach, cross, square, root, *_v)
    masses = (1 / a_m, 1 / b_m)
    strength = formulas["pair_strength"](root, _radii, *masses)
    impulse = formulas["pair_impulse"](*there, *_v, _radii, *masses)
    return (
        wait - pair_times()[0],
        *(ours - (d + wait * v) for ours, d, v in zip(there, _d, _v, strict=True)),
        *(strength * d - j for d, j in zip(there, impulse, strict=True)),
    )


def _last_meeting(formulas: Mapping[str, Callable[..., Any]]) -> tuple[Expr, ...]:
    """With the other sign of the root: the later time of touch, d after a flight of that duration, and the impulse."""
    approach, cross = formulas["pair_approach"](*_d, *_v), _d[0] * _v[1] - _d[1] * _v[0]
    square = _v[0] ** 2 + _v[1] ** 2
    root = sqrt(formulas["pair_discriminant"](*_d, *_v, _radii))
    wait, *there = formulas["pair_meeting"](approach, cross, square, -root, *_v)
    masses = (1 / a_m, Integer(0))
    strength = formulas["pair_strength"](-root, _radii, *masses)
    impulse = formulas["pair_impulse"](*there, *_v, _radii, *masses)
    return (
        wait - pair_times()[1],
        formulas["pair_last_time"](approach, root, square) - wait,
        *(ours - (d + wait * v) for ours, d, v in zip(there, _d, _v, strict=True)),
        *(strength * d - j for d, j in zip(there, impulse, strict=True)),
    )


def _arc_range(formulas: Mapping[str, Callable[..., Any]]) -> tuple[Expr, ...]:
    """The height of where two circles touch over the chord of an arc of the second, from an end in direction e."""
    root = sqrt(formulas["pair_discriminant"](*_d, *_v, _radii))
    found: list[Expr] = []
    for wait, signed in zip(pair_times(), (root, -root), strict=True):
        approach, cross = formulas["pair_approach"](*_d, *_v), _d[0] * _v[1] - _d[1] * _v[0]
        there = formulas["pair_meeting"](approach, cross, _v[0] ** 2 + _v[1] ** 2, signed, *_v)[1:]
        nx, ny, ex, ey = _normal[0], _normal[1], x1, y1
        height = sum(
            -n * (d + wait * v) - n * e * _radii for n, d, v, e in zip((nx, ny), _d, _v, (ex, ey), strict=True)
        )
        found.append(formulas["arc_range"](*there, nx, ny, (nx * ex + ny * ey) * _radii) - height)
    return tuple(found)


def _head_on(formulas: Mapping[str, Callable[..., Any]]) -> tuple[Expr, ...]:
    """For d = b_x u and v = t u, with u of length 1 and t > 0, the meeting with d x v = 0 and the root R |v|."""
    length = sqrt(a_vx**2 + a_vy**2)
    u = (a_vx / length, a_vy / length)
    d, v = (b_x * u[0], b_x * u[1]), (t * u[0], t * u[1])
    cross = d[0] * v[1] - d[1] * v[0]
    general = formulas["pair_meeting"](formulas["pair_approach"](*d, *v), cross, t**2, t * _radii, *v)
    return (cross, *(a - b for a, b in zip(formulas["pair_head_on"](*d, *u, t, _radii), general, strict=True)))


def _touch_equation(formulas: Mapping[str, Callable[..., Any]]) -> tuple[Expr, ...]:
    """At the position a', b' after `advance`, the gap is the fifth equation's difference."""
    *flights, touch = pair_touch().equations
    there: dict[Any, Any] = {flight.lhs: flight.rhs for flight in flights}
    advance = formulas["advance"]
    dx = advance(b_x, b_vx, t) - advance(a_x, a_vx, t)
    dy = advance(b_y, b_vy, t) - advance(a_y, a_vy, t)
    gap = formulas["pair_gap"](dx, dy, _radii)
    return (gap - (touch.lhs - touch.rhs).subs(there),)


def _pair_speed(formulas: Mapping[str, Callable[..., Any]]) -> tuple[Expr, ...]:
    return (formulas["pair_approach"](*_d, *_v) + pair_instant_speed() * _distance,)


def _pair_velocities(formulas: Mapping[str, Callable[..., Any]]) -> tuple[Expr, ...]:
    wa, wb = 1 / a_m, 1 / b_m
    jx, jy = formulas["pair_impulse"](*_d, *_v, _distance, wa, wb)
    after = (a_vx - wa * jx, a_vy - wa * jy, b_vx + wb * jx, b_vy + wb * jy)
    return tuple(ours - theirs for ours, theirs in zip(after, pair_velocities()[1], strict=True))


def _pair_mixed(formulas: Mapping[str, Callable[..., Any]]) -> tuple[Expr, ...]:
    """The mixed velocities, and mixed lines that still meet the old ones where the circles touch, at time t."""
    axx, axy, ayy, ka, bxx, bxy, byy, kb = formulas["pair_mix"](*_d, _distance, 1 / a_m, 1 / b_m)
    after = (
        a_vx + axx * _v[0] + axy * _v[1],
        a_vy + axy * _v[0] + ayy * _v[1],
        b_vx - bxx * _v[0] - bxy * _v[1],
        b_vy - bxy * _v[0] - byy * _v[1],
    )
    early = (_d[0] - t * _v[0], _d[1] - t * _v[1])
    shifts = (
        axx * early[0] + axy * early[1] - ka * _d[0],
        axy * early[0] + ayy * early[1] - ka * _d[1],
        kb * _d[0] - bxx * early[0] - bxy * early[1],
        kb * _d[1] - bxy * early[0] - byy * early[1],
    )
    before = (a_vx, a_vy, b_vx, b_vy)
    return (
        *(ours - theirs for ours, theirs in zip(after, pair_velocities()[1], strict=True)),
        *(shift + t * (new - old) for shift, new, old in zip(shifts, after, before, strict=True)),
    )


def _fixed_circle(formulas: Mapping[str, Callable[..., Any]]) -> tuple[Expr, ...]:
    wa = 1 / a_m
    jx, jy = formulas["pair_impulse"](*_d, -a_vx, -a_vy, _distance, wa, Integer(0))
    after = (a_vx - wa * jx, a_vy - wa * jy)
    return tuple(ours - theirs for ours, theirs in zip(after, fixed_circle_velocities(), strict=True))


def _wall_times(formulas: Mapping[str, Callable[..., Any]]) -> tuple[Expr, ...]:
    """For the normal on either side of the wall, the time at which the center is at +r|n| on that side."""

    def hit(sign: int) -> Expr:
        normal = (sign * _normal[0], sign * _normal[1])
        gap = formulas["wall_gap"](a_x, a_y, x0, y0, *normal, a_r * _length)
        return formulas["wall_hit_time"](gap, formulas["wall_approach"](a_vx, a_vy, *normal))

    one, other = wall_times()
    x, y = a_x + a_vx * one, a_y + a_vy * one
    height = _normal[0] * (x - x0) + _normal[1] * (y - y0)
    side = 1 if is_zero(height - a_r * _length) else -1
    return height - side * a_r * _length, hit(side) - one, hit(-side) - other


def _face_foot(formulas: Mapping[str, Callable[..., Any]]) -> tuple[Expr, ...]:
    """Where along the wall, from its first point, a circle is as it touches either side: (p + v t - p0).(p1 - p0)."""
    found: list[Expr] = []
    for sign in (1, -1):
        normal = (sign * _normal[0], sign * _normal[1])
        gap = formulas["wall_gap"](a_x, a_y, x0, y0, *normal, a_r * _length)
        approach = formulas["wall_approach"](a_vx, a_vy, *normal)
        along = formulas["face_along"](a_x, a_y, x0, y0, *normal)
        slide = formulas["face_along"](a_vx, a_vy, Integer(0), Integer(0), *normal)
        wait = formulas["wall_hit_time"](gap, approach)
        place = (a_x + a_vx * wait - x0) * (x1 - x0) + (a_y + a_vy * wait - y0) * (y1 - y0)
        found.append(sign * place + formulas["face_foot"](along, slide, gap, approach) / approach)
    return tuple(found)


def _wall_speed(formulas: Mapping[str, Callable[..., Any]]) -> tuple[Expr, ...]:
    """The point aimed at is p + v (-g/approach), so the speed toward it is -sign(g approach) |v|,
    where g = n.(p - p0) is positive on the side that n points to."""
    g = formulas["wall_gap"](a_x, a_y, x0, y0, *_normal, Integer(0))
    approach = formulas["wall_approach"](a_vx, a_vy, *_normal)
    aim_x, aim_y = wall_aim_point()
    away = sqrt((a_x - aim_x) ** 2 + (a_y - aim_y) ** 2)
    return (
        (aim_x - a_x) * approach + g * a_vx,
        (aim_y - a_y) * approach + g * a_vy,
        wall_instant_speed() * away * approach + g * (a_vx**2 + a_vy**2),
    )


def _wall_velocities(formulas: Mapping[str, Callable[..., Any]]) -> tuple[Expr, ...]:
    normal = (w_y0 - w_y1, w_x1 - w_x0)
    square = normal[0] ** 2 + normal[1] ** 2
    ours = formulas["wall_bounce"](a_vx, a_vy, *normal, square)
    change = formulas["speed_change"](formulas["wall_approach"](a_vx, a_vy, *normal))
    written = (a_vx - change * normal[0] / square, a_vy - change * normal[1] / square)
    return tuple(mine - law for side in (ours, written) for mine, law in zip(side, wall_velocities(), strict=True))


def _wall_mirrored(formulas: Mapping[str, Callable[..., Any]]) -> tuple[Expr, ...]:
    """The mirrored velocity, and a mirrored line that meets the old one at the wall, at time t."""
    normal = (w_y0 - w_y1, w_x1 - w_x0)
    nn = normal[0] ** 2 + normal[1] ** 2
    xx, xy, yy = formulas["wall_mirror"](*normal, nn)
    ours = (xx * a_vx + xy * a_vy, xy * a_vx + yy * a_vy)
    offset = normal[0] * a_x + normal[1] * a_y  # n.p0 + r |n| of a circle that touches the wall at (a_x, a_y)
    early = (a_x - t * a_vx, a_y - t * a_vy)
    line = (
        xx * early[0] + xy * early[1] + 2 * offset * normal[0] / nn,
        xy * early[0] + yy * early[1] + 2 * offset * normal[1] / nn,
    )
    return (
        *(a - b for a, b in zip(ours, wall_velocities(), strict=True)),
        line[0] + t * ours[0] - a_x,
        line[1] + t * ours[1] - a_y,
    )


def _damped(formulas: Mapping[str, Callable[..., Any]]) -> tuple[Expr, ...]:
    before, share = (a_vx, a_vy, b_vx, b_vy), (1 + restitution) / 2
    ours = (formulas["damped"](u, v, share) for u, v in zip(before, pair_velocities()[1], strict=True))
    return tuple(mine - law for mine, law in zip(ours, pair_restitution_velocities(), strict=True))


def _wall_damped(formulas: Mapping[str, Callable[..., Any]]) -> tuple[Expr, ...]:
    before, share = (a_vx, a_vy), (1 + restitution) / 2
    ours = (formulas["damped"](u, v, share) for u, v in zip(before, wall_velocities(), strict=True))
    return tuple(mine - law for mine, law in zip(ours, wall_restitution_velocities(), strict=True))


def _falling_flight(formulas: Mapping[str, Callable[..., Any]]) -> tuple[Expr, ...]:
    place, speed = falling_flight()
    half = gravity / 2
    return formulas["sag"](a_x, a_vx, half, t) - place, formulas["fall_speed"](a_vx, half, t) - speed


def _falling_zeros(formulas: Mapping[str, Callable[..., Any]]) -> tuple[Expr, ...]:
    """At either form's time the gap is 0, and its derivative is -root: it is where the gap falls."""
    place, speed = falling_flight()
    at = {a_x: gap, a_vx: approach}
    root = sqrt(formulas["fall_discriminant"](gap, approach, gravity / 2))
    waits = formulas["fall_time"](gap, approach, root), formulas["fall_time_back"](approach, gravity / 2, root)
    found = [
        (place.subs(at | {t: wait}, simultaneous=True), speed.subs(at | {t: wait}, simultaneous=True) + root)
        for wait in waits
    ]
    return tuple(difference for pair in found for difference in pair)


PROOFS = (
    Proof("straight flight, and two circles touch", pair_touch, _touch_equation),
    Proof("time until two circles touch", pair_times, _pair_times),
    Proof("time until two circles graze", pair_times, _pair_nearest),
    Proof("where two circles touch, and the impulse there", pair_times, _pair_meeting),
    Proof("where a circle meets an arc from within", pair_times, _last_meeting),
    Proof("the range of an arc", pair_times, _arc_range),
    Proof("two circles meet head on", pair_times, _head_on),
    Proof("two circles approach", pair_instant_speed, _pair_speed),
    Proof("two circles approach, and turn about each other", pair_instant_speed, _pair_turned),
    Proof("velocities after two circles collide", pair_velocities, _pair_velocities),
    Proof("velocities after two circles collide, by matrices", pair_velocities, _pair_mixed),
    Proof("velocity off a circle of infinite mass", fixed_circle_velocities, _fixed_circle),
    Proof("time until a circle touches a wall", wall_times, _wall_times),
    Proof("where along a face a circle touches it", wall_times, _face_foot),
    Proof("a circle approaches a wall", wall_instant_speed, _wall_speed),
    Proof("velocity off a wall of infinite mass", wall_velocities, _wall_velocities),
    Proof("velocity off a wall, by a matrix", wall_velocities, _wall_mirrored),
    Proof("two circles collide with a restitution", pair_restitution_velocities, _damped),
    Proof("a circle bounces off a wall with a restitution", wall_restitution_velocities, _wall_damped),
    Proof("flight under gravity", falling_flight, _falling_flight),
    Proof("time until a circle under gravity touches a wall", falling_flight, _falling_zeros),
)


def functions(text: str, forms: Sequence[StableForm] = FORMS) -> dict[str, Callable[..., Any]]:
    """The functions of these forms that a text of this room defines, by name."""
    namespace: dict[str, Any] = {"__name__": "formulas", "__package__": "truebreak.exact.laws"}
    exec(compile(text, "formulas.py", "exec"), namespace)
    return {form.name: namespace[form.name] for form in forms}


def prove(proof: Proof, formulas: Mapping[str, Callable[..., Any]]) -> None:
    """Proves that functions agree with the derived law.

    Raises:
        LawError: naming the law, if a difference is not identically zero.
    """
    for number, difference in enumerate(proof.difference(formulas), start=1):
        if not is_zero(difference):
            raise LawError(
                f"{proof.name}: component {number} of what law_forms.py states is not what "
                f"derivation.{proof.law.__name__} derives; correct the one that is wrong"
            )


def derive_and_prove(shown: TextIO, progress: TextIO) -> str:
    """Derives every law, shows it, proves the stable forms; the text for `formulas.py`.

    Args:
        shown: where the laws are written, for reading.
        progress: where one line a step is written.

    Raises:
        LawError: if a stable form does not equal the derived law.
    """
    text = render()
    written = functions(text)
    begun = time.perf_counter()
    for proof in PROOFS:
        law = proof.law()
        shown.write(f"{proof.name} (derivation.{proof.law.__name__}):\n{_readable(law)}\n\n")
        prove(proof, written)
        progress.write(f"{time.perf_counter() - begun:5.1f} s  proved: {proof.name}\n")
        progress.flush()
    shown.write(text.split("N = TypeVar", 1)[1].split("\n", 1)[1].strip() + "\n")
    return text


def _readable(law: Any) -> str:
    if isinstance(law, Statement):
        return "\n".join(f"  {equation.lhs} = {equation.rhs}" for equation in law.equations)
    if isinstance(law, Expr):
        law = (law,)
    if isinstance(law[0], tuple):
        law = law[-1]
    return "\n".join(textwrap.fill(str(part), initial_indent="  ", subsequent_indent="    ") for part in law)


# -- The tangent map of a collision: how small displacements before it become displacements after it.
#
# Derived from the laws of `derivation.py`, not stated: two runs that differ by e * p in position and e * q in velocity
# are followed through the contact, and compared at one time after it, to the first order in e. Which of the two touches
# first costs it the time between.
# The result is that of Dellago, Posch and Hoover, Phys. Rev. E 53, 1485 (1996), for any masses.


gx, gy = symbols("gx, gy")


@cache
def pair_displacement(lossy: bool = False, falls: bool = False) -> tuple[Any, Any, Any, Any]:
    """What b's displacement gains, per inverse mass: position x, y and velocity x, y, at contact, where |d| is R.

    Args:
        lossy: with a restitution e, told by `share`, which is (1 + e) / 2.
        falls: with g, by which v changes in a unit of time: of one that falls and one that stands. Two that fall do so
            alike. What comes later has until then a velocity of g more, and after it of as much less.

    Raises:
        LawError: if the time by which the displaced pair touches later is not one.
    """
    hit = pair_velocities()[1]
    if lossy:
        hit = tuple(part.subs(restitution, 2 * share - 1) for part in pair_restitution_velocities())
    at_rest = {a_x: 0, a_y: 0, b_x: dx, b_y: dy, a_vx: 0, a_vy: 0, b_vx: vx, b_vy: vy, a_m: 1 / wa, b_m: 1 / wb}
    impulse = tuple(((after - before) / wb).subs(at_rest) for after, before in ((hit[2], b_vx), (hit[3], b_vy)))
    pull = (gx, gy) if falls else (0, 0)
    moved = {dx: dx + e * (px + vx * tau), dy: dy + e * (py + vy * tau)}
    moved |= {vx: vx + e * (qx + pull[0] * tau), vy: vy + e * (qy + pull[1] * tau)}
    distance = pair_touch().equations[-1].lhs.subs({aprime_x: 0, aprime_y: 0})
    grown = diff(distance.subs({bprime_x: moved[dx], bprime_y: moved[dy]}), e).subs(e, 0)
    delays = solve(grown, tau)
    if len(delays) != 1:
        raise LawError(f"the displaced pair touches later by {delays}")
    shift_x, shift_y = (-delays[0] * part for part in impulse)
    turn_x, turn_y = (diff(part.subs(moved, simultaneous=True), e).subs(e, 0).subs(tau, delays[0]) for part in impulse)
    return together(shift_x), together(shift_y), together(turn_x), together(turn_y)


@cache
def wall_displacement() -> tuple[Any, Any, Any, Any]:
    """A displacement of position and velocity after a bounce off a wall, with a restitution e and under gravity.

    `share` is (1 + e) / 2. The displaced circle comes later, with the velocity that it has then; both are compared at
    one time.

    >>> from truebreak.exact.laws.derivation import w_x0, w_y0, w_x1, w_y1
    >>> floor = {w_x0: 0, w_y0: 0, w_x1: 1, w_y1: 0, a_vx: 3, a_vy: -1, px: 5, py: 7, qx: 1, qy: 2, share: 1}
    >>> [part.subs(floor).subs({gx: 0, gy: -2}) for part in wall_displacement()]
    [5, -7, 1, 26]
    """
    after = tuple(part.subs(restitution, 2 * share - 1) for part in wall_restitution_velocities())
    nx, ny = w_y0 - w_y1, w_x1 - w_x0
    delay = -(nx * px + ny * py) / (nx * a_vx + ny * a_vy)
    late_x, late_y = qx + delay * gx, qy + delay * gy
    shift_x, shift_y = px + delay * (a_vx - after[0]), py + delay * (a_vy - after[1])
    turn_x, turn_y = (
        diff(part, a_vx) * late_x + diff(part, a_vy) * late_y - delay * pull
        for part, pull in zip(after, (gx, gy), strict=True)
    )
    return together(shift_x), together(shift_y), together(turn_x), together(turn_y)


def prove_tangent(formulas: Mapping[str, Callable[..., Any]], bounce: Callable[..., Any]) -> None:
    """Proves that the written functions are what is derived here, identically.

    Args:
        formulas: the functions of `tangent_formulas.py` by name.
        bounce: `formulas.wall_bounce`, which a displacement undergoes like a velocity.

    Raises:
        LawError: naming what differs.
    """
    contact = {R**2: dx**2 + dy**2}
    written = formulas["pair_tangent"](dx, dy, vx, vy, R, wa, wb, px, py, qx, qy)
    for name, one, other in zip(("x", "y", "vx", "vy"), written, pair_displacement(), strict=True):
        if not is_zero(_joined(one - other).subs(contact)):
            raise LawError(f"pair_tangent: its {name} is not what the laws lead to")
    for name, one, other in zip(("x", "y", "vx", "vy"), written, pair_displacement(lossy=True), strict=True):
        if not is_zero(_joined(one * share - other).subs(contact)):
            raise LawError(f"pair_tangent: a restitution does not damp its {name} like an impulse")
    turned = formulas["fall_turn"](dx, dy, R**2 * (wa + wb), dx * vx + dy * vy, dx * gx + dy * gy, px, py)
    pulled = (*written[:2], *(one + more for one, more in zip(written[2:], turned, strict=True)))
    for name, one, other in zip(("x", "y", "vx", "vy"), pulled, pair_displacement(lossy=True, falls=True), strict=True):
        if not is_zero(_joined(one * share - other).subs(contact)):
            raise LawError(f"fall_turn: its {name} onto a circle that stands is not what the laws lead to")
    blocks = (dx * vx + dy * vy, dx * vy - dy * vx, vx**2 + vy**2, -2 / (R**2 * (wa + wb)))
    xx, xy, yy, *a = formulas["pair_tangent_blocks"](dx, dy, *blocks)
    b = (xx, xy, xy, yy)
    mapped = (
        *_times(b, px, py),
        *(one + other for one, other in zip(_times(a, px, py), _times(b, qx, qy), strict=True)),
    )
    for name, one, other in zip(("x", "y", "vx", "vy"), mapped, pair_displacement(), strict=True):
        if not is_zero(_joined(one - other).subs(contact)):
            raise LawError(f"pair_tangent_blocks: its {name} is not what the laws lead to")
    normal = w_y0 - w_y1, w_x1 - w_x0
    nn = normal[0] ** 2 + normal[1] ** 2
    closing, pull = normal[0] * a_vx + normal[1] * a_vy, normal[0] * gx + normal[1] * gy
    place, turned = bounce(px, py, *normal, nn), bounce(qx, qy, *normal, nn)
    fallen = formulas["fall_turn"](*normal, nn, closing, pull, px, py)
    elastic = (*place, *(one + more for one, more in zip(turned, fallen, strict=True)))
    lossy = (before + share * (after - before) for before, after in zip((px, py, qx, qy), elastic, strict=True))
    for name, one, other in zip(("x", "y", "vx", "vy"), lossy, wall_displacement(), strict=True):
        if not is_zero(_joined(one - other)):
            raise LawError(
                f"wall_bounce, fall_turn: a displacement's {name} is not mirrored like a velocity that falls"
            )


def _joined(value: Any) -> Any:
    """Over one denominator; SymPy's own type for it is too wide."""
    return together(value)


def _times(matrix: Sequence[Any], x: Any, y: Any) -> tuple[Any, Any]:
    xx, xy, yx, yy = matrix
    return xx * x + xy * y, yx * x + yy * y


def is_current(text: str, path: Path) -> bool:
    """Whether the file holds exactly this text."""
    return path.exists() and path.read_text(encoding="utf-8") == text


def write(text: str, path: Path) -> Path:
    """Writes the file in one step, so that no reader sees half of it; its path."""
    part = path.with_suffix(".part")
    part.write_text(text, encoding="utf-8")
    return part.replace(path)


def main(arguments: list[str] | None = None) -> int:
    """Derive, prove, and write or check `formulas.py` and `tangent_formulas.py`; the exit status."""
    parser = argparse.ArgumentParser(
        prog="python docs/studies/law_proofs.py",
        description="Derive the laws of motion and collision with SymPy, show them, prove that the stable "
        "forms are equal to them, and write these to formulas.py; the same for how displacements go through a "
        "collision, in tangent_formulas.py. Takes some ten seconds. "
        "The laws go to standard output, the progress to standard error.",
        epilog="To change a formula: edit its stable form in docs/studies/law_forms.py, then run this again. "
        "To change the physics: edit a statement in exact/laws/derivation.py; the proofs then fail until the "
        "stable forms agree. Exit status: 0 done, 1 not current (--check) or not proved.",
    )
    check = "write nothing; exit with 1 if a file is not current"
    parser.add_argument("--check", action="store_true", help=check)
    options = parser.parse_args(arguments)

    try:
        texts = {FORMULAS: derive_and_prove(sys.stdout, sys.stderr), TANGENT_FORMULAS: tangent_text()}
        written = functions(texts[TANGENT_FORMULAS], TANGENT_FORMS)
        prove_tangent(written, functions(texts[FORMULAS])["wall_bounce"])
    except (LawError, ValueError) as error:
        print(f"not proved: {error}", file=sys.stderr)
        return 1
    if options.check:
        stale = [path.name for path, text in texts.items() if not is_current(text, path)]
        for path in texts:
            verdict = "not current: run without --check" if path.name in stale else "current"
            print(f"{path.name} is {verdict}", file=sys.stderr)
        return 1 if stale else 0
    for path, text in texts.items():
        print(f"wrote {write(text, path)}", file=sys.stderr)
    return 0


if __name__ == "__main__":
    sys.exit(main())
