"""Proofs that the stable forms, as written, are the laws that SymPy derives.

What is proved is the text itself: the functions as written are run on the article's symbols, and
what they return must equal, identically, what `derivation.py` derived.
"""

from __future__ import annotations

import textwrap
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TextIO

from sympy import Expr, Integer, sqrt

from .derivation import (
    LawError,
    Statement,
    a_m,
    a_r,
    a_vx,
    a_vy,
    a_x,
    a_y,
    b_m,
    b_r,
    b_vx,
    b_vy,
    b_x,
    b_y,
    fixed_circle_velocities,
    is_zero,
    pair_instant_speed,
    pair_times,
    pair_touch,
    pair_velocities,
    t,
    w_x0,
    w_x1,
    w_y0,
    w_y1,
    wall_aim_point,
    wall_instant_speed,
    wall_times,
    wall_velocities,
    x0,
    x1,
    y0,
    y1,
)
from .stable_forms import FORMS, StableForm, render

FORMULAS = Path(__file__).with_name("formulas.py")


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
    ours = formulas["wall_bounce"](a_vx, a_vy, *normal, normal[0] ** 2 + normal[1] ** 2)
    return tuple(a - b for a, b in zip(ours, wall_velocities(), strict=True))


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


PROOFS = (
    Proof("straight flight, and two circles touch", pair_touch, _touch_equation),
    Proof("time until two circles touch", pair_times, _pair_times),
    Proof("time until two circles graze", pair_times, _pair_nearest),
    Proof("where two circles touch, and the impulse there", pair_times, _pair_meeting),
    Proof("two circles meet head on", pair_times, _head_on),
    Proof("two circles approach", pair_instant_speed, _pair_speed),
    Proof("velocities after two circles collide", pair_velocities, _pair_velocities),
    Proof("velocities after two circles collide, by matrices", pair_velocities, _pair_mixed),
    Proof("velocity off a circle of infinite mass", fixed_circle_velocities, _fixed_circle),
    Proof("time until a circle touches a wall", wall_times, _wall_times),
    Proof("a circle approaches a wall", wall_instant_speed, _wall_speed),
    Proof("velocity off a wall of infinite mass", wall_velocities, _wall_velocities),
    Proof("velocity off a wall, by a matrix", wall_velocities, _wall_mirrored),
)


def functions(text: str, forms: Sequence[StableForm] = FORMS) -> dict[str, Callable[..., Any]]:
    """The functions of these forms that a text of this room defines, by name."""
    namespace: dict[str, Any] = {"__name__": "formulas", "__package__": __package__}
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
                f"{proof.name}: component {number} of what stable_forms.py states is not what "
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


def is_current(text: str, path: Path) -> bool:
    """Whether the file holds exactly this text."""
    return path.exists() and path.read_text(encoding="utf-8") == text


def write(text: str, path: Path) -> Path:
    """Writes the file in one step, so that no reader sees half of it; its path."""
    part = path.with_suffix(".part")
    part.write_text(text, encoding="utf-8")
    return part.replace(path)
