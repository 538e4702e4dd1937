"""The laws in the form that loses no digits, and how they are written as Python.

`law_proofs.py` proves each form equal to the law that `exact/laws/derivation.py` derives.
"""

from __future__ import annotations

import textwrap
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from sympy import Add, Expr, Integer, Mul, Pow, Symbol, fraction, symbols

x, y, v, dt, dx, dy, vx, vy, R, wa, wb = symbols("x, y, v, dt, dx, dy, vx, vy, R, wa, wb")
nx, ny, nn, rL, x0, y0 = symbols("nx, ny, nn, rL, x0, y0")
gap, approach, root, cross, scale, square = symbols("gap, approach, root, cross, scale, square")
ux, uy, speed, mixed = symbols("ux, uy, speed, mixed")
along, slide, edge = symbols("along, slide, edge")
share_a, share_b, xx, xy, yy = symbols("share_a, share_b, xx, xy, yy")
px, py, qx, qy = symbols("px, py, qx, qy")
e, tau, wait, mx, my, weight, turn, push, shift = symbols("e, tau, wait, mx, my, weight, turn, push, shift")
before, after, share = symbols("before, after, share")
half, depth, pull = symbols("half, depth, pull")
c, slope, bxx, bxy, byy, spin = symbols("c, slope, bxx, bxy, byy, spin")


CHANGE = 1 + Integer(1)
"""The law of impacts: 1 + e, by which the speed of approach is multiplied to change it; e, the restitution, is 1.

Forms that hold for this e alone, as that of a mirror, do not pass their proof at another."""


@dataclass(frozen=True)
class StableForm:
    """One function of `formulas.py`.

    Attributes:
        name: the function's name.
        parameters: its parameters, in order; terms and factors are written in this order too.
        steps: local names and their values, each used more than once or named to be read.
        results: what it returns; several make a tuple.
        doc: what it computes and which law it is the form of.
        example: a call and what it gives, for the doctest.
    """

    name: str
    parameters: tuple[Symbol, ...]
    steps: tuple[tuple[Symbol, Expr], ...]
    results: tuple[Expr, ...]
    doc: str
    example: tuple[str, str]


FORMS = (
    StableForm(
        "pair_approach",
        (dx, dy, vx, vy),
        (),
        (dx * vx + dy * vy,),
        """d.v, negative while the circles come nearer.

        Stable form of `derivation.pair_instant_speed`, which it equals up to the factor -1/|d|: the
        sign needs no square root.""",
        ("pair_approach(Q(4), Q(0), Q(-2), Q(1))", "Fraction(-8, 1)"),
    ),
    StableForm(
        "pair_turned",
        (dx, dy, vx, vy),
        ((mixed, vx * (dx + dy)),),
        (mixed - dy * (vx - vy), dx * (vx + vy) - mixed),
        """d.v, which is `pair_approach`, and d x v, in three products of long numbers in place of four.

        The product of d and the mirror image of v, as complex numbers, by Gauss's three products.""",
        ("pair_turned(Q(4), Q(1), Q(-2), Q(1))", "(Fraction(-7, 1), Fraction(6, 1))"),
    ),
    StableForm(
        "pair_gap",
        (dx, dy, R),
        (),
        (dx**2 + dy**2 - R**2,),
        """|d|^2 - R^2, positive while the circles are apart and 0 when they touch.

        The last equation of `derivation.pair_touch`, at time 0.""",
        ("pair_gap(Q(4), Q(0), Q(2))", "Fraction(12, 1)"),
    ),
    StableForm(
        "pair_discriminant",
        (dx, dy, vx, vy, R),
        ((cross, dx * vy - dy * vx),),
        ((vx**2 + vy**2) * R**2 - cross**2,),
        """|v|^2 R^2 - (d x v)^2: positive if the paths bring the circles to a hit, 0 if they graze.

        Equals the radicand in `derivation.pair_times`, which as (d.v)^2 - |v|^2 (|d|^2 - R^2) would
        cancel for distant circles; the two are equal by Lagrange's identity.""",
        ("pair_discriminant(Q(4), Q(0), Q(-2), Q(0), Q(2))", "Fraction(16, 1)"),
    ),
    StableForm(
        "pair_hit_time",
        (gap, approach, root),
        (),
        (gap / (root - approach),),
        """Time until two approaching circles touch.

        Equals the earlier of `derivation.pair_times`, freed from the cancellation in -d.v - root.
        `gap` is `pair_gap`, `approach` is `pair_approach` (negative), `root` is the square
        root of `pair_discriminant`.""",
        ("pair_hit_time(Q(12), Q(-8), Q(4))", "Fraction(1, 1)"),
    ),
    StableForm(
        "pair_nearest_time",
        (approach, vx, vy),
        (),
        (-approach / (vx**2 + vy**2),),
        """Time until two circles are nearest, which is when they touch if they graze.

        The mean of the two of `derivation.pair_times`, which are equal where the discriminant is 0.""",
        ("pair_nearest_time(Q(-8), Q(-2), Q(0))", "Fraction(2, 1)"),
    ),
    StableForm(
        "pair_last_time",
        (approach, root, square),
        (),
        ((root - approach) / square,),
        """Time until what is within a circle, or comes to be, leaves it: the hollow side of an arc is met then.

        Equals the later of `derivation.pair_times`; `root` is the square root of `pair_discriminant`,
        `square` |v|^2. Right after a bounce from within, root is -d.v, and this is -2 d.v / |v|^2.""",
        ("pair_last_time(Q(-8), Q(4), Q(4))", "Fraction(3, 1)"),
    ),
    StableForm(
        "pair_meeting",
        (approach, cross, square, root, vx, vy),
        (),
        (-(approach + root) / square, (cross * vy - root * vx) / square, -(cross * vx + root * vy) / square),
        """Time until two circles that approach touch, and their d then, which no time enters.

        `approach` is d.v, `cross` d x v, `square` |v|^2, `root` the square root of
        `pair_discriminant`. The time equals the earlier of `derivation.pair_times`; d then has the
        d x v of before, and d.v = -root. Sharp in absolute terms, and in balls beside the
        circles' positions that is what counts.""",
        (
            "pair_meeting(Q(-8), Q(0), Q(4), Q(4), Q(-2), Q(0))",
            "(Fraction(1, 1), Fraction(2, 1), Fraction(0, 1))",
        ),
    ),
    StableForm(
        "pair_head_on",
        (dx, dy, ux, uy, speed, R),
        (),
        (-(dx * ux + dy * uy + R) / speed, -R * ux, -R * uy),
        """`pair_meeting` where d and v are parallel: u is the direction of v, of length 1.

        There d x v = 0, and the root is R |v|.""",
        (
            "pair_head_on(Q(4), Q(0), Q(-1), Q(0), Q(2), Q(2))",
            "(Fraction(1, 1), Fraction(2, 1), Fraction(0, 1))",
        ),
    ),
    StableForm(
        "pair_strength",
        (root, R, wa, wb),
        (),
        (CHANGE * root / (R**2 * (wa + wb)),),
        """The impulse on b of an elastic collision, as a multiple of d at contact.

        `root` is -d.v then, as `pair_meeting` has it. Equals `pair_impulse` there.""",
        ("pair_strength(Q(2), Q(2), Q(1), Q(1))", "Fraction(1, 2)"),
    ),
    StableForm(
        "pair_impulse",
        (dx, dy, vx, vy, R, wa, wb),
        ((approach, dx * vx + dy * vy), (scale, -CHANGE * approach / (R**2 * (wa + wb)))),
        (scale * dx, scale * dy),
        """The impulse on b of an elastic collision; a takes the opposite one.

        So b's velocity gains wb times this, a's loses wa times this. Valid at contact, where
        |d| is R. With an inverse mass of 0 it is the impulse off a fixed circle. Equals the change
        of velocities in `derivation.pair_velocities` and `derivation.fixed_circle_velocities`.""",
        ("pair_impulse(Q(2), Q(0), Q(-1), Q(-2), Q(2), Q(1), Q(1))", "(Fraction(1, 1), Fraction(0, 1))"),
    ),
    StableForm(
        "pair_mix",
        (dx, dy, R, wa, wb),
        (
            (share_a, CHANGE * wa / (wa + wb)),
            (share_b, CHANGE * wb / (wa + wb)),
            (xx, dx**2 / R**2),
            (xy, dx * dy / R**2),
            (yy, dy**2 / R**2),
        ),
        (share_a * xx, share_a * xy, share_a * yy, share_a, share_b * xx, share_b * xy, share_b * yy, share_b),
        """The elastic collision as matrices: A (xx, xy, yy) and its factor for a, then for b.

        Valid at contact, where |d| is R. The velocity of a becomes (I - A) va + A vb, and the line
        on which it flies, told by its point at any one time, goes through (I - A) pa + A pb - k d,
        k the factor; for b with the roles exchanged, and + k d. In interval arithmetic these lose
        less than `pair_impulse`. Equals `derivation.pair_velocities`.""",
        (
            "pair_mix(Q(2), Q(0), Q(2), Q(1), Q(1))[:4]",
            "(Fraction(1, 1), Fraction(0, 1), Fraction(0, 1), Fraction(1, 1))",
        ),
    ),
    StableForm(
        "wall_gap",
        (x, y, x0, y0, nx, ny, rL),
        (),
        (nx * (x - x0) + ny * (y - y0) - rL,),
        """n.(p - p0) - r |n|: |n| times the distance between circle and wall, 0 when they touch.

        (x0, y0) is any point of the wall; rL is the radius times the length of n.
        The numerator of `derivation.wall_times`.""",
        ("wall_gap(Q(0), Q(5), Q(0), Q(0), Q(0), Q(2), Q(2))", "Fraction(8, 1)"),
    ),
    StableForm(
        "wall_approach",
        (vx, vy, nx, ny),
        (),
        (vx * nx + vy * ny,),
        """n.v, negative while the circle comes nearer to the wall.

        Has the sign opposite to that of `derivation.wall_instant_speed` on the side that n points to.""",
        ("wall_approach(Q(3), Q(-2), Q(0), Q(2))", "Fraction(-4, 1)"),
    ),
    StableForm(
        "wall_hit_time",
        (gap, approach),
        (),
        (-gap / approach,),
        """Time until a circle touches the wall that it approaches.

        Equals the one of `derivation.wall_times` that lies on the side that n points to. `gap` is
        `wall_gap`, `approach` is `wall_approach` (negative).""",
        ("wall_hit_time(Q(8), Q(-4))", "Fraction(2, 1)"),
    ),
    StableForm(
        "wall_bounce",
        (vx, vy, nx, ny, nn),
        ((approach, vx * nx + vy * ny), (scale, CHANGE * approach / nn)),
        (vx - scale * nx, vy - scale * ny),
        """The velocity after a bounce off a wall; nn is |n|^2.

        Equals `derivation.wall_velocities`, the limit of a wall of infinite mass.""",
        ("wall_bounce(Q(3), Q(-2), Q(0), Q(2), Q(4))", "(Fraction(3, 1), Fraction(2, 1))"),
    ),
    StableForm(
        "wall_mirror",
        (nx, ny, nn),
        ((xx, (nx**2 + ny**2 - CHANGE * nx**2) / nn), (xy, -CHANGE * nx * ny / nn)),
        (xx, xy, -xx),
        """The bounce off a wall as a symmetric matrix (xx, xy, yy): v' = H v, H = I - 2 n n^T / |n|^2.

        The line on which the circle flies is mirrored too: its point p at any one time becomes
        H p + 2 (n.p0 + r |n|) n / |n|^2. Equals `derivation.wall_velocities`.""",
        ("wall_mirror(Q(0), Q(2), Q(4))", "(Fraction(1, 1), Fraction(0, 1), Fraction(-1, 1))"),
    ),
    StableForm(
        "face_along",
        (x, y, x0, y0, nx, ny),
        (),
        ((x - x0) * ny - (y - y0) * nx,),
        """Where along a face a point is, from its start (x0, y0), times its length |n|: (p - p0).u, u = (ny, -nx).

        Of a velocity, with 0 for the start, how fast that grows.""",
        ("face_along(Q(3), Q(7), Q(1), Q(0), Q(0), Q(2))", "Fraction(4, 1)"),
    ),
    StableForm(
        "face_foot",
        (along, slide, gap, approach),
        (),
        (slide * gap - along * approach,),
        """Where along a face a circle touches it, times its length and -n.v, which is positive while it comes nearer.

        `along` and `slide` are `face_along` of its place and velocity, `gap` is `wall_gap`, `approach`
        `wall_approach`. Equals what `derivation.wall_times` gives, freed from the division.""",
        ("face_foot(Q(4), Q(1), Q(8), Q(-4))", "Fraction(24, 1)"),
    ),
    StableForm(
        "arc_range",
        (dx, dy, nx, ny, edge),
        (),
        (-(nx * dx + ny * dy) - edge,),
        """How far a circle at an arc is beyond the arc's chord, moved out to its centre: positive within the range.

        d leads from the circle to the arc's centre; n is the chord's normal, away from that; `edge` is n.e |R|, with e
        the direction of an end and |R| as far as the centres are apart at the contact: n.(D - e |R|), with D = -d.""",
        ("arc_range(Q(-3), Q(-4), Q(1), Q(1), Q(5))", "Fraction(2, 1)"),
    ),
    StableForm(
        "speed_change",
        (approach,),
        (),
        (CHANGE * approach,),
        """(1 + e) u: by how much an impact changes a speed u of approach; e, the restitution, is 1.

        The law of every contact, wherever its form does not have it written out: from u < 0 it makes -e u.""",
        ("speed_change(Q(-3))", "Fraction(-6, 1)"),
    ),
    StableForm(
        "damped",
        (before, after, share),
        (),
        (before + share * (after - before),),
        """A velocity after an impact of restitution e, which an elastic one would take from `before` to `after`.

        `share` is (1 + e) / 2: as every law is linear in 1 + e, it is the part of an elastic impulse that there is.
        Equals `derivation.pair_restitution_velocities` and `derivation.wall_restitution_velocities`.""",
        ("damped(Q(-2), Q(2), Q(3, 4))", "Fraction(1, 1)"),
    ),
    StableForm(
        "advance",
        (x, v, dt),
        (),
        (x + v * dt,),
        """A coordinate after a flight of duration dt.

        The first equation of `derivation.pair_touch`.""",
        ("advance(Q(1), Q(-2), Q(3))", "Fraction(-5, 1)"),
    ),
    StableForm(
        "sag",
        (x, v, half, dt),
        (),
        (x + (v + half * dt) * dt,),
        """A coordinate after a flight of duration dt under gravity, of which `half` is half of the part along it.

        So too the gap of a circle and a wall, with gravity along n. Equals `derivation.falling_flight`.""",
        ("sag(Q(1), Q(2), Q(-2), Q(3))", "Fraction(-11, 1)"),
    ),
    StableForm(
        "fall_speed",
        (v, half, dt),
        (),
        (v + 2 * half * dt,),
        """The speed after a flight of duration dt under gravity, of which `half` is half of the part along it.

        The derivative of `sag` by dt. Equals `derivation.falling_flight`.""",
        ("fall_speed(Q(2), Q(-2), Q(3))", "Fraction(-10, 1)"),
    ),
    StableForm(
        "fall_discriminant",
        (gap, approach, half),
        ((pull, 2 * half), (depth, 2 * gap * pull)),
        (approach * approach - depth,),
        """The square of the speed at which a circle under gravity comes to a wall: positive if it does, 0 if it grazes.

        `gap` and `approach` are `wall_gap` and `wall_approach`, `half` is half of n.g.""",
        ("fall_discriminant(Q(3), Q(-4), Q(1))", "Fraction(4, 1)"),
    ),
    StableForm(
        "fall_time",
        (gap, approach, root),
        (),
        (2 * gap / (root - approach),),
        """Time until a circle under gravity, which approaches a wall, touches it; `root` as in `fall_time_back`.

        The same zero as `fall_time_back`, freed from its cancellation where `approach` is negative.""",
        ("fall_time(Q(3), Q(-4), Q(2))", "Fraction(1, 1)"),
    ),
    StableForm(
        "fall_time_back",
        (approach, half, root),
        ((pull, 2 * half),),
        (-(approach + root) / pull,),
        """Time until the gap of a circle and a wall under gravity is 0 and falls, whatever the sign of n.g.

        `root` is the square root of `fall_discriminant`: the gap then changes at the speed -root. Of the two zeros
        it is the later one where gravity pulls towards the wall, and the earlier one where it pulls away.""",
        ("fall_time_back(Q(-4), Q(1), Q(2))", "Fraction(1, 1)"),
    ),
)

TANGENT_FORMS = (
    StableForm(
        "pair_tangent",
        (dx, dy, vx, vy, R, wa, wb, px, py, qx, qy),
        (
            (approach, dx * vx + dy * vy),
            (wait, -(dx * px + dy * py) / approach),
            (mx, px + vx * wait),
            (my, py + vy * wait),
            (weight, R * R * (wa + wb)),
            (push, -CHANGE * approach / weight),
            (turn, -CHANGE * (mx * vx + my * vy + dx * qx + dy * qy) / weight),
            (shift, -CHANGE * (dx * px + dy * py) / weight),
        ),
        (dx * shift, dy * shift, mx * push + dx * turn, my * push + dy * turn),
        """What a collision does to a displacement (p, q) of b's position and velocity less a's.

        b's displacement gains wb times this, a's loses wa times it; d and v are those of the instant before the
        impulse, |d| is R. Equals `law_proofs.pair_displacement`, the derivative of the impulse and of the instant
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
        c is -2 / (R^2 (wa + wb)). Equals `law_proofs.pair_displacement`.""",
        ("pair_tangent_blocks(Q(2), Q(0), Q(-2), Q(0), Q(1), Q(-1, 2))",
         "(Fraction(-2, 1), Fraction(0, 1), Fraction(0, 1), Fraction(0, 1), "
         "Fraction(0, 1), Fraction(0, 1), Fraction(1, 1))"),
    ),
    StableForm(
        "fall_turn",
        (nx, ny, nn, approach, pull, px, py),
        ((turn, CHANGE * pull * (nx * px + ny * py) / (nn * approach)),),
        (nx * turn, ny * turn),
        """What gravity adds to the displacement of a circle's velocity at a bounce off a wall.

        (p, q) is the circle's displacement, `approach` is n.v before the bounce, `pull` is n.g, and nn is |n|^2.
        Who comes later by -n.p / n.v falls for longer before the bounce, and for less after it. The rest is
        `wall_bounce` of p and of q. Equals `law_proofs.wall_displacement`. Between one that falls and a circle that
        stands it is added to the velocity of `pair_tangent`: with d and v for n and the speed, g by which v changes in
        a unit of time, and R^2 (wa + wb) for nn. Equals `law_proofs.pair_displacement`.""",
        ("fall_turn(Q(0), Q(1), Q(1), Q(-2), Q(-3), Q(5), Q(7))", "(Fraction(0, 1), Fraction(21, 1))"),
    ),
)  # fmt: skip

HEADER = '''\
"""The laws of motion and collision in their stable form, for any type of number.

Generated by `python docs/studies/law_proofs.py`, which derives each law afresh and proves that
the form written here equals it. To change a form, change it in `law_forms.py`.

Conventions, the same in every function:
  d = position of b minus position of a     v = velocity of b minus velocity of a
  R = sum of the radii                      w = inverse mass, 0 for a fixed circle
  n = a normal of the wall, of any length, that points to the side the circle is on
An approach is negative while the two come nearer. Examples use Q = Fraction.
"""

from typing import Protocol, Self, TypeVar


class Number(Protocol):
    """What a type of number must be able to do: these five operators, no more."""

    def __add__(self, other: Self, /) -> Self: ...
    def __sub__(self, other: Self, /) -> Self: ...
    def __mul__(self, other: Self, /) -> Self: ...
    def __truediv__(self, other: Self, /) -> Self: ...
    def __neg__(self) -> Self: ...


N = TypeVar("N", bound=Number)
'''

TANGENT_HEADER = '''"""The tangent map of a collision, for any type of number.

Generated by `python docs/studies/law_proofs.py`, which derives it from the laws and proves that the form written
here equals it. Conventions as in `formulas.py`; (p, q) is the displacement
of position and velocity of b less that of a.
"""

from .formulas import N
'''


def python(expression: Expr, order: Mapping[Symbol, int]) -> str:
    """An expression as Python source, in + - * / alone; terms and factors follow `order`.

    A square is written as a product, and twice a symbol as a sum, so that no power
    and no number of another type occurs.

    Raises:
        ValueError: for an expression that needs more than these operators.

    >>> python(2 * x / (v - dt**2), {x: 0, v: 1, dt: 2})
    '(x + x) / (v - dt * dt)'
    """

    def rank(part: Any) -> list[int]:
        return sorted(order[symbol] for symbol in part.free_symbols)

    def factor(part: Expr, first: bool = True) -> str:
        loose = part.is_Add or (part.is_Pow and not first)
        return f"({python(part, order)})" if loose else python(part, order)

    if isinstance(expression, Symbol):
        return expression.name
    if isinstance(expression, Pow) and expression.exp == 2:
        return f"{factor(expression.base)} * {factor(expression.base)}"
    if isinstance(expression, Add):
        terms = sorted(expression.args, key=lambda term: (term.could_extract_minus_sign(), rank(term)))
        first, *rest = terms
        signed = (
            f" - {python(-term, order)}" if term.could_extract_minus_sign() else f" + {python(term, order)}"
            for term in rest
        )
        return python(first, order) + "".join(signed)
    if isinstance(expression, Mul):
        coefficient, product = expression.as_coeff_Mul()
        over, under = fraction(product)
        factors = sorted(Mul.make_args(over), key=rank)
        if abs(coefficient) == 2:
            text = f"{factor(factors[0])} + {factor(factors[0])}"
            rest = [factor(part, first=False) for part in factors[1:]]
            text = f"({text})" if rest or under != 1 or coefficient < 0 else text
            text = " * ".join([text, *rest])
        elif abs(coefficient) == 1:
            text = " * ".join(factor(part, first=part == factors[0]) for part in factors)
        else:
            raise ValueError(f"no form for the number {coefficient} in {expression}")
        if under != 1:
            divisor = python(under, order)
            text += f" / {divisor}" if isinstance(under, Symbol) else f" / ({divisor})"
        return f"-{text}" if coefficient < 0 else text
    raise ValueError(f"{expression}: only + - * / can be written")


def render(forms: tuple[StableForm, ...] = FORMS) -> str:
    """The whole text of `formulas.py`."""
    return HEADER + "".join(f"\n\n{_render_one(form)}" for form in forms)


def _render_one(form: StableForm) -> str:
    names = (*form.parameters, *(name for name, _ in form.steps))
    order = {symbol: rank for rank, symbol in enumerate(names)}
    parameters = ", ".join(f"{symbol}: N" for symbol in form.parameters)
    returns = "N" if len(form.results) == 1 else f"tuple[{', '.join('N' for _ in form.results)}]"
    summary, _, rest = form.doc.partition("\n")
    call, result = form.example
    example = f">>> from fractions import Fraction as Q\n>>> {call}\n{result}"
    doc = f'"""{summary}\n{textwrap.dedent(rest)}\n\n{example}\n"""'
    steps = "".join(f"{name} = {python(value, order)}\n" for name, value in form.steps)
    results = ", ".join(python(result, order) for result in form.results)
    body = textwrap.indent(f"{doc}\n{steps}return {results}\n", "    ", lambda line: line.strip() != "")
    return f"def {form.name}({parameters}) -> {returns}:\n{body}"


def tangent_text() -> str:
    """The whole text of `tangent_formulas.py`."""
    functions = render(TANGENT_FORMS).partition("\n\n\ndef ")
    return TANGENT_HEADER.rstrip("\n") + functions[1] + functions[2]
