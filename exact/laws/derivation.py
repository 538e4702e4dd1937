"""The laws of motion and collision, stated as equations and solved by SymPy."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

from sympy import (
    QQ,
    Eq,
    Expr,
    Integer,
    Poly,
    Symbol,
    cancel,
    field,
    integrate,
    limit,
    linear_eq_to_matrix,
    linsolve,
    oo,
    sqf_list,
    sqrt,
    symbols,
)
from sympy.polys.fields import FracElement
from sympy.polys.matrices import DomainMatrix

# -- Solve a system of polynomial equations by eliminating the unknowns that occur linearly.
#
# SymPy's `nonlinsolve` gives the same answers for the article's systems, but takes 4 s for two circles and 25 s for a
# circle and a wall. Here each takes well under a second, because all but one of the unknowns occur linearly, and the
# last one in a quadratic.


class NotEliminable(ValueError):
    """The system is not linear in all but one unknown, or not quadratic in the last."""


def numerator(expression: Expr) -> Expr:
    """The numerator of an expression over one common denominator, in lowest terms.

    Args:
        expression: built of symbols, numbers, + - * / and unnested square roots.

    Returns:
        an expanded expression that is zero where `expression` is, denominators aside.

    >>> from sympy.abc import x, y
    >>> numerator(1/x - 1/y)
    -x + y
    """
    rational, roots = _name_roots(expression)
    values = {name: sqrt(radicand) for name, radicand in roots.items()}
    return _fraction(rational).numer.as_expr().subs(values)


def is_zero(expression: Expr) -> bool:
    """Whether an expression in rational operations and unnested square roots is identically zero.

    Each square root is replaced by a new symbol s, and even powers of s in the numerator by
    powers of the radicand. True is always a proof; False is one too if no product of the
    radicands is a square.

    >>> from sympy import sqrt
    >>> from sympy.abc import x
    >>> is_zero((x - 1) / (sqrt(x) - 1) - sqrt(x) - 1), is_zero(sqrt(x) - x)
    (True, False)
    """
    rational, roots = _name_roots(expression)
    remainder = _fraction(rational).numer.as_expr()
    for name, radicand in roots.items():
        even = odd = Integer(0)
        for (power,), coefficient in Poly(remainder, name).terms():
            reduced = coefficient * radicand ** (power // 2)
            even, odd = (even, odd + reduced) if power % 2 else (even + reduced, odd)
        remainder = _fraction(even + odd * name).numer.as_expr()
    return remainder == 0


def _fraction(rational: Expr) -> FracElement:
    """A rational function in lowest terms; SymPy's fields are many times as fast as `together`."""
    symbols = sorted(rational.free_symbols, key=str) or [Symbol("x")]
    return field(symbols, QQ)[0].from_expr(rational)


def _name_roots(expression: Expr) -> tuple[Expr, dict[Symbol, Expr]]:
    """The expression with each square root replaced by a symbol, and the symbols' radicands."""
    names: dict[Expr, Symbol] = {}

    def name_root(base: Expr, exponent: Expr) -> Expr:
        name = names.setdefault(_fraction(base).as_expr(), Symbol(f"root_{len(names)}"))
        return name ** (2 * exponent)

    def is_half_power(part: Any) -> bool:
        return part.is_Pow and part.exp.is_Rational and part.exp.q == 2

    rational: Any = expression.replace(is_half_power, lambda power: name_root(power.base, power.exp))
    return rational, {name: radicand for radicand, name in names.items()}


def quadratic_roots(polynomial: Expr, unknown: Symbol) -> list[Expr]:
    """The roots of a polynomial whose factors have degree 1 or 2 in the unknown.

    Square factors are drawn out of the discriminant: sqrt(f**2 g) becomes f sqrt(g), which is
    right up to a sign, and both signs are roots.

    Raises:
        NotEliminable: for a factor of higher degree.

    >>> from sympy.abc import t, g
    >>> quadratic_roots(t**2 - g, t)
    [-sqrt(g), sqrt(g)]
    """
    coefficients = Poly(polynomial, unknown).all_coeffs()
    if len(coefficients) == 2:
        slope, offset = coefficients
        return [cancel(-offset / slope)]
    if len(coefficients) != 3:
        raise NotEliminable(f"{unknown}: of degree {len(coefficients) - 1}; only 1 and 2 are solved here")
    a, b, c = coefficients
    square_free: Any = sqf_list(numerator(b**2 / 4 - a * c))
    content, factors = square_free
    outside, inside = Integer(1), content
    for base, exponent in factors:
        outside *= base ** (exponent // 2)
        inside *= base ** (exponent % 2)
    root = outside * sqrt(inside)
    return [cancel((-b / 2 + signed) / a) for signed in (-root, root)]


def eliminate(equations: Sequence[Any], unknowns: Sequence[Symbol]) -> list[tuple[Expr, ...]]:
    """Every generic solution of a system, in the order of the unknowns given.

    The unknowns are eliminated from the last to the first, so put the one that occurs
    quadratically first. Each solution is put back into every equation and must satisfy it.

    Args:
        equations: as many `sympy.Eq` as unknowns.
        unknowns: what to solve for.

    Returns:
        one tuple of values for each solution.

    Raises:
        NotEliminable: the system is not linear in all but the last unknown left,
            or what was found does not satisfy an equation.

    >>> from sympy import Eq
    >>> from sympy.abc import t, x, v
    >>> eliminate([Eq(x, v * t), Eq(x**2, 4)], [t, x])
    [(-2/v, -2), (2/v, 2)]
    """
    residuals = [numerator(equation.lhs - equation.rhs) for equation in equations]
    left = list(unknowns)
    steps: list[tuple[Symbol, Any]] = []
    while len(residuals) > 1:
        index, unknown, value = _linear_pivot(residuals, left)
        steps.append((unknown, value))
        left.remove(unknown)
        others = residuals[:index] + residuals[index + 1 :]
        residuals = [numerator(residual.subs(unknown, value)) for residual in others]
    if len(left) != 1:
        raise NotEliminable(f"{len(equations)} equations do not determine {len(unknowns)} unknowns")

    solutions: list[tuple[Expr, ...]] = []
    for root in quadratic_roots(residuals[0], left[0]):
        values: dict[Any, Any] = {left[0]: root}
        for unknown, value in reversed(steps):
            found = value.subs(values)
            values[unknown] = cancel(found) if found.is_rational_function() else found
        for equation in equations:
            if not is_zero((equation.lhs - equation.rhs).subs(values)):
                raise NotEliminable(f"a solution does not satisfy {equation}")
        solutions.append(tuple(values[unknown] for unknown in unknowns))
    return solutions


def _linear_pivot(residuals: Sequence[Expr], unknowns: Sequence[Symbol]) -> tuple[int, Symbol, Expr]:
    """The last unknown that some equation gives linearly: (index of it, unknown, its value)."""
    for unknown in reversed(unknowns):
        for index, residual in enumerate(residuals):
            polynomial = Poly(residual, unknown)
            if polynomial.degree() != 1:
                continue
            slope, offset = polynomial.all_coeffs()
            if not slope.has(*unknowns):
                return index, unknown, -offset / slope
    raise NotEliminable("no equation is linear in an unknown, with a coefficient that is known")


# -- The laws of motion and collision, stated as equations and solved by SymPy.
#
# The statements are those of Carl M. Kadie, 'Perfect, Infinite-Precision, Game Physics in Python (Part 3)', 2023
# (package perfect-physics on PyPI), in his symbols: circles a and b, a wall through (x_0, y_0) and (x_1, y_1), a
# prime for a position at time t, a hat for a velocity after a collision.
#
# `python docs/studies/law_proofs.py` derives them all afresh, proves that the stable forms of `law_forms.py` are
# equal to them, and writes `formulas.py`.

t, p = symbols("t, p")
a_x, a_y, a_vx, a_vy, a_r, a_m = symbols("a_x, a_y, a_vx, a_vy, a_r, a_m")
b_x, b_y, b_vx, b_vy, b_r, b_m = symbols("b_x, b_y, b_vx, b_vy, b_r, b_m")
aprime_x, aprime_y, bprime_x, bprime_y = symbols("a'_x, a'_y, b'_x, b'_y")
ahat_vx, ahat_vy, bhat_vx, bhat_vy = symbols("ahat_vx, ahat_vy, bhat_vx, bhat_vy")
x0, y0, x1, y1, x2, y2 = symbols("x_0, y_0, x_1, y_1, x_2, y_2")
restitution = symbols("e")
gravity = symbols("g")
w_x0, w_y0, w_x1, w_y1, w_m, what_vx, what_vy = symbols("w_x0, w_y0, w_x1, w_y1, w_m, what_vx, what_vy")


class LawError(ArithmeticError):
    """A derivation did not give what the physics demands."""


@dataclass(frozen=True)
class Statement:
    """A system of equations as the physics states it, and what to solve it for.

    Attributes:
        title: what the equations say, in words.
        equations: one `sympy.Eq` for each unknown.
        unknowns: the first is what is asked for.
    """

    title: str
    equations: tuple[Any, ...]
    unknowns: tuple[Symbol, ...]


def pair_touch() -> Statement:
    """Step 1: two circles, moving straight, just touch at time t.

    >>> len(pair_touch().equations)
    5
    """
    return Statement(
        "two circles just touch: the distance of the centers is the sum of the radii",
        (
            Eq(aprime_x, a_x + a_vx * t),
            Eq(aprime_y, a_y + a_vy * t),
            Eq(bprime_x, b_x + b_vx * t),
            Eq(bprime_y, b_y + b_vy * t),
            Eq((aprime_x - bprime_x) ** 2 + (aprime_y - bprime_y) ** 2, (a_r + b_r) ** 2),
        ),
        (t, aprime_x, aprime_y, bprime_x, bprime_y),
    )


def wall_touch() -> Statement:
    """Step 2: a circle just touches a wall at the point (x_2, y_2), at right angles to it.

    >>> len(wall_touch().equations)
    6
    """
    slope_0 = (y1 - y0) / (x1 - x0)
    slope_1 = (aprime_y - y2) / (aprime_x - x2)
    return Statement(
        "a circle just touches a wall: a point of the wall is one radius away, at a right angle",
        (
            Eq(aprime_x, a_x + a_vx * t),
            Eq(aprime_y, a_y + a_vy * t),
            Eq(x2, x0 + (x1 - x0) * p),
            Eq(y2, y0 + (y1 - y0) * p),
            Eq((x2 - aprime_x) ** 2 + (y2 - aprime_y) ** 2, a_r**2),
            Eq(slope_0, -1 / slope_1),
        ),
        (t, p, aprime_x, aprime_y, x2, y2),
    )


def pair_collision() -> Statement:
    """Step 3: energy, momentum, and the velocity at right angles to the impact stay.

    >>> len(pair_collision().equations)
    4
    """
    energy_before = a_m * (a_vx**2 + a_vy**2) / 2 + b_m * (b_vx**2 + b_vy**2) / 2
    energy_after = a_m * (ahat_vx**2 + ahat_vy**2) / 2 + b_m * (bhat_vx**2 + bhat_vy**2) / 2
    d = sqrt((b_x - a_x) ** 2 + (b_y - a_y) ** 2)
    ux = -(b_y - a_y) / d
    uy = (b_x - a_x) / d
    return Statement(
        "two circles collide: energy, momentum and the velocity at right angles to the impact stay",
        (
            Eq(energy_before, energy_after),
            Eq(a_m * a_vx + b_m * b_vx, a_m * ahat_vx + b_m * bhat_vx),
            Eq(a_m * a_vy + b_m * b_vy, a_m * ahat_vy + b_m * bhat_vy),
            Eq(
                (b_vx - a_vx) * ux + (b_vy - a_vy) * uy,
                (bhat_vx - ahat_vx) * ux + (bhat_vy - ahat_vy) * uy,
            ),
        ),
        (ahat_vx, ahat_vy, bhat_vx, bhat_vy),
    )


def wall_collision() -> Statement:
    """Step 4: the same for a wall at rest of finite mass, before its mass goes to infinity.

    >>> len(wall_collision().equations)
    4
    """
    energy_before = a_m * (a_vx**2 + a_vy**2) / 2 + w_m * 0
    energy_after = a_m * (ahat_vx**2 + ahat_vy**2) / 2 + w_m * (what_vx**2 + what_vy**2) / 2
    d = sqrt((w_x1 - w_x0) ** 2 + (w_y1 - w_y0) ** 2)
    ux = (w_x1 - w_x0) / d
    uy = (w_y1 - w_y0) / d
    return Statement(
        "a circle collides with a wall of finite mass: energy, momentum and the velocity along the wall stay",
        (
            Eq(energy_before, energy_after),
            Eq(a_m * a_vx + w_m * 0, a_m * ahat_vx + w_m * what_vx),
            Eq(a_m * a_vy + w_m * 0, a_m * ahat_vy + w_m * what_vy),
            Eq(a_vx * ux + a_vy * uy, (ahat_vx - what_vx) * ux + (ahat_vy - what_vy) * uy),
        ),
        (ahat_vx, ahat_vy, what_vx, what_vy),
    )


def pair_restitution() -> Statement:
    """Step 3 with Newton's restitution e in place of energy: what approaches with speed u parts with e u.

    >>> len(pair_restitution().equations)
    4
    """
    elastic = pair_collision()
    nx, ny = b_x - a_x, b_y - a_y
    speeds = ((b_vx - a_vx) * nx + (b_vy - a_vy) * ny, (bhat_vx - ahat_vx) * nx + (bhat_vy - ahat_vy) * ny)
    return Statement(
        "two circles collide with restitution e: momentum and the velocity at right angles to the impact stay",
        (Eq(-restitution * speeds[0], speeds[1]), *elastic.equations[1:]),
        elastic.unknowns,
    )


def wall_restitution() -> Statement:
    """Step 4 with Newton's restitution e, off a wall that stands.

    >>> len(wall_restitution().equations)
    2
    """
    ux, uy = w_x1 - w_x0, w_y1 - w_y0
    return Statement(
        "a circle bounces off a wall with restitution e: the velocity along the wall stays",
        (
            Eq(-restitution * (a_vy * ux - a_vx * uy), ahat_vy * ux - ahat_vx * uy),
            Eq(a_vx * ux + a_vy * uy, ahat_vx * ux + ahat_vy * uy),
        ),
        (ahat_vx, ahat_vy),
    )


def wall_aim() -> Statement:
    """Step 5: the point (x_2, y_2) of a wall where the circle's center would meet it.

    >>> len(wall_aim().equations)
    4
    """
    return Statement(
        "where the center of a circle would meet a wall",
        (
            Eq(x2, a_x + a_vx * t),
            Eq(y2, a_y + a_vy * t),
            Eq(x2, x0 + (x1 - x0) * p),
            Eq(y2, y0 + (y1 - y0) * p),
        ),
        (x2, y2, p, t),
    )


@cache
def pair_times() -> tuple[Expr, ...]:
    """The two times at which circles a and b just touch; the first is the earlier one.

    Times may come out negative, complex, or nan (no relative motion): see step 1 of the article.

    >>> head_on = {a_x: 0, a_y: 0, a_r: 1, a_vx: 2, a_vy: 0, b_x: 4, b_y: 0, b_r: 1, b_vx: 0, b_vy: 0}
    >>> [time.subs(head_on) for time in pair_times()]
    [1, 3]
    """
    return _first_of_each(pair_touch(), count=2)


@cache
def wall_times() -> tuple[Expr, ...]:
    """The two times at which circle a just touches a wall, from the one side and from the other.

    >>> fall = {a_x: 0, a_y: 5, a_r: 1, a_vx: 0, a_vy: -2, x0: 0, y0: 0, x1: 1, y1: 0}
    >>> sorted(time.subs(fall) for time in wall_times())
    [2, 3]
    """
    return _first_of_each(wall_touch(), count=2)


@cache
def pair_velocities() -> tuple[tuple[Expr, ...], tuple[Expr, ...]]:
    """(ahat_vx, ahat_vy, bhat_vx, bhat_vy) if the circles miss each other, and if they collide.

    Raises:
        LawError: unless there are these two solutions and the first changes nothing.

    >>> pair_velocities()[0]
    (a_vx, a_vy, b_vx, b_vy)
    """
    return _miss_and_hit(pair_collision(), (a_vx, a_vy, b_vx, b_vy))


@cache
def fixed_circle_velocities() -> tuple[Expr, Expr]:
    """(ahat_vx, ahat_vy) off a circle b at rest, in the limit of b's infinite mass.

    The article takes this limit for walls; here it is taken for an obstacle too.

    Raises:
        LawError: if the obstacle would move.

    >>> a = {a_x: 0, a_y: 0, b_x: 0, b_y: -2, a_vx: 3, a_vy: -1}
    >>> [velocity.subs(a) for velocity in fixed_circle_velocities()]
    [3, 1]
    """
    _, hit = pair_velocities()
    at_rest = {b_vx: 0, b_vy: 0}
    vx, vy, *obstacle = (limit(velocity.subs(at_rest), b_m, oo) for velocity in hit)
    if obstacle != [0, 0]:
        raise LawError(f"a circle of infinite mass moves off with {obstacle}")
    return cancel(vx), cancel(vy)


@cache
def finite_wall_velocities() -> tuple[tuple[Expr, ...], tuple[Expr, ...]]:
    """(ahat_vx, ahat_vy, what_vx, what_vy) for a wall of finite mass w_m: if missed, and if hit.

    Raises:
        LawError: unless there are these two solutions and the first changes nothing.
    """
    return _miss_and_hit(wall_collision(), (a_vx, a_vy, 0, 0))


@cache
def wall_velocities() -> tuple[Expr, Expr]:
    """(ahat_vx, ahat_vy) off a wall: the limit of the wall's infinite mass.

    Raises:
        LawError: if the wall would move.

    >>> floor = {w_x0: 0, w_y0: 0, w_x1: 1, w_y1: 0, a_vx: 1, a_vy: -1}
    >>> [velocity.subs(floor) for velocity in wall_velocities()]
    [1, 1]
    """
    vx, vy, *wall = (limit(velocity, w_m, oo) for velocity in finite_wall_velocities()[1])
    if wall != [0, 0]:
        raise LawError(f"a wall of infinite mass moves off with {wall}")
    return cancel(vx), cancel(vy)


@cache
def pair_restitution_velocities() -> tuple[Expr, ...]:
    """(ahat_vx, ahat_vy, bhat_vx, bhat_vy) after two circles collide with restitution e.

    >>> head_on = {a_x: 0, a_y: 0, a_vx: 1, a_vy: 0, a_m: 1, b_x: 2, b_y: 0, b_vx: 0, b_vy: 0, b_m: 1}
    >>> [velocity.subs(head_on) for velocity in pair_restitution_velocities()][::2]
    [1/2 - e/2, e/2 + 1/2]
    """
    return _linear(pair_restitution())


@cache
def wall_restitution_velocities() -> tuple[Expr, ...]:
    """(ahat_vx, ahat_vy) off a wall, with restitution e.

    >>> floor = {w_x0: 0, w_y0: 0, w_x1: 1, w_y1: 0, a_vx: 1, a_vy: -1}
    >>> [velocity.subs(floor) for velocity in wall_restitution_velocities()]
    [1, e]
    """
    return _linear(wall_restitution())


@cache
def falling_flight() -> tuple[Expr, Expr]:
    """(x, v) of circle a along an axis at time t, where it has the acceleration g from time 0 on.

    >>> falling_flight()[0].subs({a_x: 1, a_vx: 2, gravity: -4, t: 3})
    -11
    """
    s, u = symbols("s, u")
    speed = a_vx + integrate(gravity, (s, 0, u))
    return a_x + integrate(speed, (u, 0, t)), speed.subs(u, t)


@cache
def pair_instant_speed() -> Expr:
    """How fast the centers of a and b come nearer in the instant after time 0; negative if they part.

    >>> facing = {a_x: 0, a_y: 0, a_vx: 1, a_vy: 0, b_x: 2, b_y: 0, b_vx: 0, b_vy: 0}
    >>> pair_instant_speed().subs(facing)
    1
    """
    d0 = sqrt((a_x - b_x) ** 2 + (a_y - b_y) ** 2)
    d1 = sqrt((a_x + t * a_vx - (b_x + t * b_vx)) ** 2 + (a_y + t * a_vy - (b_y + t * b_vy)) ** 2)
    return limit((d0 - d1) / t, t, 0)


@cache
def wall_aim_point() -> tuple[Expr, Expr]:
    """The point (x_2, y_2) of a wall that the center of circle a is heading for, or is coming from."""
    statement = wall_aim()
    solutions: Any = linsolve(list(statement.equations), statement.unknowns)
    ((x, y, _p, _t),) = solutions
    return x, y


@cache
def wall_instant_speed() -> Expr:
    """How fast the center of circle a comes nearer to the point of the wall it is heading for.

    This is the whole speed of the circle, negative if it moves away from the wall.

    >>> slope = {x0: -1, y0: -1, x1: 1, y1: 1, a_x: -sqrt(2)/2, a_y: sqrt(2)/2, a_vx: 2, a_vy: 1}
    >>> wall_instant_speed().subs(slope).simplify()
    sqrt(5)
    """
    x, y = wall_aim_point()
    return pair_instant_speed().subs({b_x: x, b_y: y, b_vx: 0, b_vy: 0})


def _linear(statement: Statement) -> tuple[Expr, ...]:
    """The one solution of a system that is linear in its unknowns, in lowest terms; rational, but for denominators."""
    residuals = [numerator(equation.lhs - equation.rhs) for equation in statement.equations]
    matrix, right = linear_eq_to_matrix(residuals, *statement.unknowns)
    domain = QQ.frac_field(*sorted(matrix.free_symbols | right.free_symbols, key=str))
    rows = [[domain.from_sympy(x) for x in row] for row in matrix.row_join(right).tolist()]
    system = DomainMatrix([row[:-1] for row in rows], matrix.shape, domain)
    sides = DomainMatrix([row[-1:] for row in rows], right.shape, domain)
    return tuple(domain.to_sympy(x) for x in system.lu_solve(sides).to_list_flat())


def _first_of_each(statement: Statement, count: int) -> tuple[Expr, ...]:
    solutions = eliminate(statement.equations, statement.unknowns)
    if len(solutions) != count:
        raise LawError(f"{statement.title}: {len(solutions)} solutions, not {count}")
    return tuple(solution[0] for solution in solutions)


def _miss_and_hit(statement: Statement, before: tuple) -> tuple[tuple[Expr, ...], tuple[Expr, ...]]:
    solutions = eliminate(statement.equations, statement.unknowns)
    if len(solutions) != 2 or before not in solutions:
        raise LawError(f"{statement.title}: expected a miss and a hit, found {solutions}")
    (hit,) = (solution for solution in solutions if solution != before)
    return before, hit
