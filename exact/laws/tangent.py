"""The tangent map of a collision: how small displacements before it become displacements after it.

Derived from the laws of `derivation.py`, not stated: two runs that differ by e * p in position and e * q in velocity
are followed through the contact, and compared at one time after it, to the first order in e. Which of the two touches
first costs it the time between.

`python -m truebreak.exact.laws` derives it afresh, proves that the forms equal it, and writes `tangent_formulas.py`.
The result is that of Dellago, Posch and Hoover, Phys. Rev. E 53, 1485 (1996), for any masses.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

from sympy import diff, solve, symbols, together

from .derivation import (
    LawError,
    a_m,
    a_vx,
    a_vy,
    a_x,
    a_y,
    aprime_x,
    aprime_y,
    b_m,
    b_vx,
    b_vy,
    b_x,
    b_y,
    bprime_x,
    bprime_y,
    is_zero,
    pair_touch,
    pair_velocities,
    w_x0,
    w_x1,
    w_y0,
    w_y1,
    wall_velocities,
)
from .stable_forms import R, StableForm, dx, dy, render, vx, vy, wa, wb

px, py, qx, qy = symbols("px, py, qx, qy")
e, tau, approach, wait, mx, my, weight, turn, push, shift = symbols(
    "e, tau, approach, wait, mx, my, weight, turn, push, shift"
)
cross, square, c, slope, bxx, bxy, byy, spin = symbols("cross, square, c, slope, bxx, bxy, byy, spin")

FORMULAS = Path(__file__).with_name("tangent_formulas.py")

FORMS = (
    StableForm(
        "pair_tangent",
        (dx, dy, vx, vy, R, wa, wb, px, py, qx, qy),
        (
            (approach, dx * vx + dy * vy),
            (wait, -(dx * px + dy * py) / approach),
            (mx, px + vx * wait),
            (my, py + vy * wait),
            (weight, R * R * (wa + wb)),
            (push, -2 * approach / weight),
            (turn, -2 * (mx * vx + my * vy + dx * qx + dy * qy) / weight),
            (shift, -2 * (dx * px + dy * py) / weight),
        ),
        (dx * shift, dy * shift, mx * push + dx * turn, my * push + dy * turn),
        """What a collision does to a displacement (p, q) of b's position and velocity less a's.

        b's displacement gains wb times this, a's loses wa times it; d and v are those of the instant before the
        impulse, |d| is R. Equals `tangent.pair_displacement`, the derivative of the impulse and of the instant
        at which it comes.""",
        ("pair_tangent(Q(2), Q(0), Q(-1), Q(0), Q(2), Q(1), Q(1), Q(0), Q(1), Q(0), Q(0))",
         "(Fraction(0, 1), Fraction(0, 1), Fraction(0, 1), Fraction(1, 2))"),
    ),
    StableForm(
        "pair_tangent_blocks",
        (dx, dy, approach, cross, square, c),
        (
            (slope, square / approach),
            (bxx, c * dx * dx),
            (bxy, c * dx * dy),
            (byy, c * dy * dy),
            (push, c * approach),
            (spin, c * cross),
        ),
        (bxx, bxy, byy,
         push - slope * bxx, spin - slope * bxy, -spin - slope * bxy, push - slope * byy),
        """`pair_tangent` as a matrix: B by (xx, xy, yy), it is symmetric, and A by (xx, xy, yx, yy).

        A displacement (p, q) becomes (B p, A p + B q). d.v is the approach, d x v the cross, |v|^2 the square, and
        c is -2 / (R^2 (wa + wb)). Equals `tangent.pair_displacement`.""",
        ("pair_tangent_blocks(Q(2), Q(0), Q(-2), Q(0), Q(1), Q(-1, 2))",
         "(Fraction(-2, 1), Fraction(0, 1), Fraction(0, 1), Fraction(0, 1), "
         "Fraction(0, 1), Fraction(0, 1), Fraction(1, 1))"),
    ),
)  # fmt: skip


@cache
def pair_displacement() -> tuple[Any, Any, Any, Any]:
    """What b's displacement gains, per inverse mass: position x, y and velocity x, y, at contact, where |d| is R.

    Raises:
        LawError: if the time by which the displaced pair touches later is not one.
    """
    hit = pair_velocities()[1]
    at_rest = {a_x: 0, a_y: 0, b_x: dx, b_y: dy, a_vx: 0, a_vy: 0, b_vx: vx, b_vy: vy, a_m: 1 / wa, b_m: 1 / wb}
    impulse = tuple(((after - before) / wb).subs(at_rest) for after, before in ((hit[2], b_vx), (hit[3], b_vy)))
    moved = {dx: dx + e * (px + vx * tau), dy: dy + e * (py + vy * tau), vx: vx + e * qx, vy: vy + e * qy}
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
    """A displacement of position and velocity after a bounce off a wall.

    >>> from .derivation import w_x0, w_y0, w_x1, w_y1
    >>> floor = {w_x0: 0, w_y0: 0, w_x1: 1, w_y1: 0, a_vx: 3, a_vy: -1, px: 5, py: 7, qx: 1, qy: 2}
    >>> [part.subs(floor) for part in wall_displacement()]
    [5, -7, 1, -2]
    """
    after = wall_velocities()
    nx, ny = w_y0 - w_y1, w_x1 - w_x0
    delay = -(nx * px + ny * py) / (nx * a_vx + ny * a_vy)
    shift_x, shift_y = px + delay * (a_vx - after[0]), py + delay * (a_vy - after[1])
    turn_x, turn_y = (diff(part, a_vx) * qx + diff(part, a_vy) * qy for part in after)
    return together(shift_x), together(shift_y), together(turn_x), together(turn_y)


def prove(formulas: Mapping[str, Callable[..., Any]], bounce: Callable[..., Any]) -> None:
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
        if not is_zero(_expression(one - other).subs(contact)):
            raise LawError(f"pair_tangent: its {name} is not what the laws lead to")
    blocks = (dx * vx + dy * vy, dx * vy - dy * vx, vx**2 + vy**2, -2 / (R**2 * (wa + wb)))
    xx, xy, yy, *a = formulas["pair_tangent_blocks"](dx, dy, *blocks)
    b = (xx, xy, xy, yy)
    mapped = (
        *_times(b, px, py),
        *(one + other for one, other in zip(_times(a, px, py), _times(b, qx, qy), strict=True)),
    )
    for name, one, other in zip(("x", "y", "vx", "vy"), mapped, pair_displacement(), strict=True):
        if not is_zero(_expression(one - other).subs(contact)):
            raise LawError(f"pair_tangent_blocks: its {name} is not what the laws lead to")
    normal = w_y0 - w_y1, w_x1 - w_x0
    nn = normal[0] ** 2 + normal[1] ** 2
    mirrored = (*bounce(px, py, *normal, nn), *bounce(qx, qy, *normal, nn))
    for name, one, other in zip(("x", "y", "vx", "vy"), mirrored, wall_displacement(), strict=True):
        if not is_zero(_expression(one - other)):
            raise LawError(f"wall_bounce: a displacement's {name} is not mirrored like a velocity")


def _times(matrix: Sequence[Any], x: Any, y: Any) -> tuple[Any, Any]:
    xx, xy, yx, yy = matrix
    return xx * x + xy * y, yx * x + yy * y


def _expression(value: Any) -> Any:
    return together(value)


def text() -> str:
    """The whole text of `tangent_formulas.py`."""
    functions = render(FORMS).partition("\n\n\ndef ")
    return HEADER.rstrip("\n") + functions[1] + functions[2]


HEADER = '''"""The tangent map of a collision, for any type of number.

Generated by `python -m truebreak.exact.laws`, which derives it from the laws and proves that the form written
here equals it. Conventions as in `formulas.py`; (p, q) is the displacement
of position and velocity of b less that of a.
"""

from .formulas import N
'''
