"""Proofs that the stable forms, as written, are the laws that SymPy derives.

What is proved is the text itself: the functions as written are run on the article's symbols, and
what they return must equal, identically, what `laws.py` derived.
"""

from __future__ import annotations

import textwrap
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TextIO

from sympy import Expr, Integer, sqrt

from . import laws
from .elimination import is_zero
from .stable_forms import FORMS, render

FORMULAS = Path(__file__).with_name("formulas.py")


@dataclass(frozen=True)
class Proof:
    """A stable form and what it must equal: `difference` of the functions as written must vanish.

    Attributes:
        name: the law, in words.
        law: the function of `laws.py` that derives it.
        difference: from the written functions by name to expressions that must be zero.
    """

    name: str
    law: Callable[[], Any]
    difference: Callable[[Mapping[str, Callable[..., Any]]], tuple[Expr, ...]]


_d = (laws.b_x - laws.a_x, laws.b_y - laws.a_y)
_v = (laws.b_vx - laws.a_vx, laws.b_vy - laws.a_vy)
_radii = laws.a_r + laws.b_r
_distance = sqrt(_d[0] ** 2 + _d[1] ** 2)
_normal = (laws.y0 - laws.y1, laws.x1 - laws.x0)
_length = sqrt(_normal[0] ** 2 + _normal[1] ** 2)


def _pair_times(formulas: Mapping[str, Callable[..., Any]]) -> tuple[Expr, ...]:
    earlier, _later = laws.pair_times()
    discriminant = formulas["pair_discriminant"](*_d, *_v, _radii)
    gap, approach = formulas["pair_gap"](*_d, _radii), formulas["pair_approach"](*_d, *_v)
    return (formulas["pair_hit_time"](gap, approach, sqrt(discriminant)) - earlier,)


def _touch_equation(formulas: Mapping[str, Callable[..., Any]]) -> tuple[Expr, ...]:
    """At the position a', b' after `advance`, the gap is the fifth equation's difference."""
    *flights, touch = laws.pair_touch().equations
    there: dict[Any, Any] = {flight.lhs: flight.rhs for flight in flights}
    advance = formulas["advance"]
    a_x, a_y = advance(laws.a_x, laws.a_vx, laws.t), advance(laws.a_y, laws.a_vy, laws.t)
    b_x, b_y = advance(laws.b_x, laws.b_vx, laws.t), advance(laws.b_y, laws.b_vy, laws.t)
    gap = formulas["pair_gap"](b_x - a_x, b_y - a_y, _radii)
    return (gap - (touch.lhs - touch.rhs).subs(there),)


def _pair_speed(formulas: Mapping[str, Callable[..., Any]]) -> tuple[Expr, ...]:
    return (formulas["pair_approach"](*_d, *_v) + laws.pair_instant_speed() * _distance,)


def _pair_velocities(formulas: Mapping[str, Callable[..., Any]]) -> tuple[Expr, ...]:
    wa, wb = 1 / laws.a_m, 1 / laws.b_m
    jx, jy = formulas["pair_impulse"](*_d, *_v, _distance, wa, wb)
    after = (laws.a_vx - wa * jx, laws.a_vy - wa * jy, laws.b_vx + wb * jx, laws.b_vy + wb * jy)
    return tuple(ours - theirs for ours, theirs in zip(after, laws.pair_velocities()[1], strict=True))


def _fixed_circle(formulas: Mapping[str, Callable[..., Any]]) -> tuple[Expr, ...]:
    wa = 1 / laws.a_m
    jx, jy = formulas["pair_impulse"](*_d, -laws.a_vx, -laws.a_vy, _distance, wa, Integer(0))
    after = (laws.a_vx - wa * jx, laws.a_vy - wa * jy)
    return tuple(ours - theirs for ours, theirs in zip(after, laws.fixed_circle_velocities(), strict=True))


def _wall_times(formulas: Mapping[str, Callable[..., Any]]) -> tuple[Expr, ...]:
    """One time for the normal on either side of the wall, in the order that SymPy gives."""

    def hit(sign: int) -> Expr:
        normal = (sign * _normal[0], sign * _normal[1])
        gap = formulas["wall_gap"](laws.a_x, laws.a_y, laws.x0, laws.y0, *normal, laws.a_r * _length)
        return formulas["wall_hit_time"](gap, formulas["wall_approach"](laws.a_vx, laws.a_vy, *normal))

    one, other = laws.wall_times()
    if is_zero(hit(1) - one):
        return hit(1) - one, hit(-1) - other
    return hit(-1) - one, hit(1) - other


def _wall_speed(formulas: Mapping[str, Callable[..., Any]]) -> tuple[Expr, ...]:
    """The point aimed at is p + v (-g/approach), so the speed toward it is -sign(g approach) |v|,
    where g = n.(p - p0) is positive on the side that n points to."""
    g = formulas["wall_gap"](laws.a_x, laws.a_y, laws.x0, laws.y0, *_normal, Integer(0))
    approach = formulas["wall_approach"](laws.a_vx, laws.a_vy, *_normal)
    aim_x, aim_y = laws.wall_aim_point()
    away = sqrt((laws.a_x - aim_x) ** 2 + (laws.a_y - aim_y) ** 2)
    return (
        (aim_x - laws.a_x) * approach + g * laws.a_vx,
        (aim_y - laws.a_y) * approach + g * laws.a_vy,
        laws.wall_instant_speed() * away * approach + g * (laws.a_vx**2 + laws.a_vy**2),
    )


def _wall_velocities(formulas: Mapping[str, Callable[..., Any]]) -> tuple[Expr, ...]:
    normal = (laws.w_y0 - laws.w_y1, laws.w_x1 - laws.w_x0)
    ours = formulas["wall_bounce"](laws.a_vx, laws.a_vy, *normal, normal[0] ** 2 + normal[1] ** 2)
    return tuple(a - b for a, b in zip(ours, laws.wall_velocities(), strict=True))


PROOFS = (
    Proof("straight flight, and two circles touch", laws.pair_touch, _touch_equation),
    Proof("time until two circles touch", laws.pair_times, _pair_times),
    Proof("two circles approach", laws.pair_instant_speed, _pair_speed),
    Proof("velocities after two circles collide", laws.pair_velocities, _pair_velocities),
    Proof("velocity off a circle of infinite mass", laws.fixed_circle_velocities, _fixed_circle),
    Proof("time until a circle touches a wall", laws.wall_times, _wall_times),
    Proof("a circle approaches a wall", laws.wall_instant_speed, _wall_speed),
    Proof("velocity off a wall of infinite mass", laws.wall_velocities, _wall_velocities),
)


def functions(text: str) -> dict[str, Callable[..., Any]]:
    """The functions that a text of `formulas.py` defines, by name."""
    namespace: dict[str, Any] = {"__name__": "formulas"}
    exec(compile(text, "formulas.py", "exec"), namespace)
    return {form.name: namespace[form.name] for form in FORMS}


def prove(proof: Proof, formulas: Mapping[str, Callable[..., Any]]) -> None:
    """Proves that functions agree with the derived law.

    Raises:
        LawError: naming the law, if a difference is not identically zero.
    """
    for number, difference in enumerate(proof.difference(formulas), start=1):
        if not is_zero(difference):
            raise laws.LawError(
                f"{proof.name}: component {number} of what stable_forms.py states is not what "
                f"laws.{proof.law.__name__} derives; correct the one that is wrong"
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
    start = time.perf_counter()
    for proof in PROOFS:
        law = proof.law()
        shown.write(f"{proof.name} (laws.{proof.law.__name__}):\n{_readable(law)}\n\n")
        prove(proof, written)
        progress.write(f"{time.perf_counter() - start:5.1f} s  proved: {proof.name}\n")
        progress.flush()
    shown.write(text.split("N = TypeVar", 1)[1].split("\n", 1)[1].strip() + "\n")
    return text


def _readable(law: Any) -> str:
    if isinstance(law, laws.Statement):
        return "\n".join(f"  {equation.lhs} = {equation.rhs}" for equation in law.equations)
    if isinstance(law, Expr):
        law = (law,)
    if isinstance(law[0], tuple):
        law = law[-1]
    return "\n".join(textwrap.fill(str(part), initial_indent="  ", subsequent_indent="    ") for part in law)


def is_current(text: str, path: Path = FORMULAS) -> bool:
    """Whether the file holds exactly this text."""
    return path.exists() and path.read_text(encoding="utf-8") == text


def write(text: str, path: Path = FORMULAS) -> Path:
    """Writes the file in one step, so that no reader sees half of it; its path."""
    part = path.with_suffix(".part")
    part.write_text(text, encoding="utf-8")
    return part.replace(path)
