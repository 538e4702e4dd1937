"""The derived laws at SymPy numbers, nothing rearranged, and several contacts at one instant by them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from itertools import combinations
from random import Random
from typing import Any

from sympy import Expr, Integer, Matrix, Poly, Symbol

from ...scenarios.settings import TiePolicy
from ...scenarios.things import Arc, Circle, Pocket, Wall
from ..laws.derivation import (
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
    pair_instant_speed,
    pair_times,
    pair_velocities,
    w_x0,
    w_x1,
    w_y0,
    w_y1,
    wall_instant_speed,
    wall_times,
    wall_velocities,
    x0,
    x1,
    y0,
    y1,
)
from .symbolic_sign import Solution, SymbolicUndecided, above, below, normal, root, sign, smallest

_TIME = Symbol("t")


@dataclass(frozen=True)
class Disc:
    """A circle at one moment, in SymPy numbers; `m` is None for a fixed one, which flies as an end of what moves."""

    x: Any
    y: Any
    vx: Any
    vy: Any
    r: Any
    m: Any | None


@dataclass(frozen=True)
class Line:
    """A wall through two points, in SymPy numbers, as it is at one moment; `ux`, `uy`: its velocity."""

    x0: Any
    y0: Any
    x1: Any
    y1: Any
    ux: Any = field(default=Integer(0), kw_only=True)
    uy: Any = field(default=Integer(0), kw_only=True)

    def moved(self, time: Any) -> Line:
        """The same so much later."""
        if self.ux == 0 and self.uy == 0:
            return self
        dx, dy = self.ux * time, self.uy * time
        x0, y0, x1, y1 = (normal(q) for q in (self.x0 + dx, self.y0 + dy, self.x1 + dx, self.y1 + dy))
        return replace(self, x0=x0, y0=y0, x1=x1, y1=y1)

    def seen(self, a: Disc) -> Disc:
        """A circle with its velocity relative to this wall."""
        if self.ux == 0 and self.uy == 0:
            return a
        return replace(a, vx=normal(a.vx - self.ux), vy=normal(a.vy - self.uy))


@dataclass(frozen=True)
class Bar(Line):
    """A segment without its ends: its centre line, and half its thickness."""

    r: Any

    def beside(self, a: Disc, time: Any, g: tuple[Any, Any] = (Integer(0), Integer(0))) -> bool:
        """Whether the foot of a circle's centre, which falls with g, lies strictly between the ends, so much later."""
        a = self.seen(a)
        ux, uy = self.x1 - self.x0, self.y1 - self.y0
        x, y = (a.vx + g[0] * time / 2) * time, (a.vy + g[1] * time / 2) * time
        foot = normal(ux * (a.x + x - self.x0) + uy * (a.y + y - self.y0))
        return sign(foot) > 0 and sign(normal(ux**2 + uy**2 - foot)) > 0


@dataclass(frozen=True)
class Bow(Line):
    """An arc without its ends, which are its two points: its circle, whether it is all of that, the side at hand."""

    x: Any
    y: Any
    r: Any
    full: bool
    within: bool = False

    @property
    def disc(self) -> Disc:
        """All of its circle."""
        return Disc(self.x, self.y, Integer(0), Integer(0), self.r, None)

    def distances(self, a: Disc) -> list[Any]:
        """The squares of the distances of a circle's centre from the arc's at which the two touch."""
        inside = [(self.r - a.r) ** 2] if sign(normal(self.r - a.r)) > 0 else []
        return [(self.r + a.r) ** 2, *inside]

    def beside(self, a: Disc, time: Any) -> bool:
        """Whether a circle's centre lies in a direction strictly between those of the ends, so much later."""
        if self.full:
            return True
        ux, uy, wx, wy = self.x0 - self.x, self.y0 - self.y, self.x1 - self.x, self.y1 - self.y
        dx, dy = a.x + a.vx * time - self.x, a.y + a.vy * time - self.y
        after, before = sign(normal(ux * dy - uy * dx)) > 0, sign(normal(dx * wy - dy * wx)) > 0
        turn = sign(normal(ux * wy - uy * wx))
        return (after and before) if turn > 0 else (after or before) if turn < 0 else after

    def refuse_along(self, a: Disc, times: Sequence[Any]) -> None:
        """Sees to it that a circle does not touch the inside in passing and go into the arc: at an end, or from now on.

        Args:
            a: the circle.
            times: when it touches the inside of all the circle.

        Raises:
            SymbolicUndecided: if it may.
        """
        if len(times) < 2 or sign(normal(times[0] - times[1])) or sign(times[0]) < 0:
            return
        if sign(times[0]) == 0 and self.beside(a, times[0]):
            raise SymbolicUndecided("a circle touches an arc from within, and its flight is along the arc")
        if self.full:
            return
        dx, dy = a.x + a.vx * times[0] - self.x, a.y + a.vy * times[0] - self.y
        for x, y, way in ((self.x0, self.y0, 1), (self.x1, self.y1, -1)):
            ux, uy = x - self.x, y - self.y
            at_end = sign(normal(ux * dy - uy * dx)) == 0 and sign(normal(ux * dx + uy * dy)) > 0
            if at_end and (sign(times[0]) or way * sign(normal(ux * a.vy - uy * a.vx)) > 0):
                raise SymbolicUndecided("a path touches the hollow side of an arc at its end, along it")


def disc_of(circle: Circle) -> Disc:
    """A circle at time 0."""
    pace = circle.drift if circle.fixed else (circle.vx, circle.vy)
    x, y, vx, vy, r = (normal(q.sympy()) for q in (circle.x, circle.y, *pace, circle.r))
    return Disc(x, y, vx, vy, r, None if isinstance(circle.m, str) else normal(circle.m.sympy()))


def rim_of(pocket: Pocket) -> Disc:
    """The rim of a pocket."""
    return Disc(
        normal(pocket.x.sympy()), normal(pocket.y.sympy()), Integer(0), Integer(0), normal(pocket.r.sympy()), None
    )


def line_of(wall: Wall) -> Line:
    """A wall at time 0."""
    ux, uy = normal(wall.vx.sympy()), normal(wall.vy.sympy())
    return Line(*(q.sympy() for q in (wall.x0, wall.y0, wall.x1, wall.y1)), ux=ux, uy=uy)


def bow_of(arc: Arc) -> Bow:
    """An arc without its ends."""
    ends = arc.ends or ((arc.x, arc.y), (arc.x, arc.y))
    numbers = (*ends[0], *ends[1], arc.x, arc.y, arc.r)
    return Bow(*(normal(q.sympy()) for q in numbers), full=arc.full)


def touch_times(a: Disc, b: Disc | Line) -> list[Expr]:
    """All real times from now at which two things would just touch, not ordered, negative ones too.

    >>> from sympy import Integer as I
    >>> touch_times(Disc(I(0), I(0), I(2), I(0), I(1), I(1)), Disc(I(4), I(0), I(0), I(0), I(1), I(1)))
    [1, 3]
    """
    if isinstance(b, Bar):
        line = Line(b.x0, b.y0, b.x1, b.y1, ux=b.ux, uy=b.uy)
        return [time for time in touch_times(replace(a, r=a.r + b.r), line) if b.beside(a, time)]
    if isinstance(b, Bow):
        found, within = touch_times(a, b.disc), sign(normal(b.r - a.r)) > 0
        if within:
            b.refuse_along(a, inner := touch_times(replace(a, r=-a.r), b.disc))
            found += inner
        return [time for time in found if b.beside(a, time)]
    if isinstance(b, Line):
        a = b.seen(a)
    found = [
        solution.value(_at(a, b)) for solution in _solutions("wall touched" if isinstance(b, Line) else "pair touched")
    ]
    return [time for time in found if time is not None]


def fall_times(a: Disc, b: Line, g: tuple[Any, Any]) -> list[Expr]:
    """As `touch_times`, of a circle under gravity and a wall: n.(p + v t + g t**2/2 - p0) = r on its one side, and -r.

    >>> from sympy import Integer as I
    >>> floor = Line(I(0), I(0), I(1), I(0))
    >>> fall_times(Disc(I(0), I(3), I(0), I(0), I(1), I(1)), floor, (I(0), I(-4)))
    [1, -1, sqrt(2), -sqrt(2)]
    """
    if isinstance(b, Bar):
        line = Line(b.x0, b.y0, b.x1, b.y1, ux=b.ux, uy=b.uy)
        return [time for time in fall_times(replace(a, r=a.r + b.r), line, g) if b.beside(a, time, g)]
    ux, uy = b.x1 - b.x0, b.y1 - b.y0
    if sign(normal(ux * g[1] - uy * g[0])) == 0:
        return touch_times(a, b)
    a, length = b.seen(a), root(normal(ux**2 + uy**2))
    nx, ny = normal(-uy / length), normal(ux / length)
    square, linear = normal((nx * g[0] + ny * g[1]) / 2), normal(nx * a.vx + ny * a.vy)
    found: list[Expr] = []
    for side in (1, -1):
        rest = normal(nx * (a.x - b.x0) + ny * (a.y - b.y0) - side * a.r)
        radicand = normal(linear**2 - 4 * square * rest)
        if sign(radicand) >= 0:
            found += [normal((-linear - way * root(radicand)) / (2 * square)) for way in (1, -1)]
    return found


def is_within(a: Disc, b: Disc) -> bool:
    """Whether a centre is within a circle."""
    return sign(normal((a.x - b.x) ** 2 + (a.y - b.y) ** 2 - b.r**2)) < 0


def may_fall_onto(a: Disc, b: Disc, reach: Any, within: bool, g: tuple[Any, Any], wait: Any) -> bool:
    """Whether a circle under gravity may come to be so far from something round so soon; `wait` None: ever.

    The square of their distance, less that of the reach, is a quartic of the time; from within, the other way round.
    Where its coefficients are no fractions, fractions a little below them are taken, which make a polynomial below it;
    that this has no zero up to the time is told by Sturm's theorem.
    """
    vx, vy = a.vx - b.vx, a.vy - b.vy
    x, y = _TIME * (vx + g[0] * _TIME / 2) + a.x - b.x, _TIME * (vy + g[1] * _TIME / 2) + a.y - b.y
    gap: Any = Poly((x**2 + y**2 - reach**2) * (-1 if within else 1), _TIME)
    low: Any = Poly([below(c) for c in gap.all_coeffs()], _TIME, domain="QQ")
    return bool(low.eval(0) <= 0 or low.count_roots(0, None if wait is None else above(wait)))


def time_to_enter(a: Disc, rim: Disc) -> Any:
    """The time until a centre on a straight flight comes to be within a rim; None where it does not, or only touches.

    >>> from sympy import Integer as I
    >>> rim = Disc(I(4), I(0), I(0), I(0), I(1), None)
    >>> time_to_enter(Disc(I(0), I(0), I(2), I(0), I(1), I(1)), rim)
    3/2
    >>> time_to_enter(Disc(I(0), I(1), I(2), I(0), I(1), I(1)), rim)
    """
    times = touch_times(replace(a, r=Integer(0)), rim)
    if len(times) < 2 or sign(normal(times[0] - times[1])) == 0:
        return None
    first = smallest(times)
    return first if sign(first) >= 0 else None


def to_rim(a: Disc, rim: Disc) -> Any:
    """How far a centre is from a rim."""
    return abs(root(normal((a.x - rim.x) ** 2 + (a.y - rim.y) ** 2)) - rim.r)


def direction(line: Line) -> tuple[Any, Any]:
    """Along a wall, of length 1."""
    ux, uy = line.x1 - line.x0, line.y1 - line.y0
    length = root(normal(ux**2 + uy**2))
    return normal(ux / length), normal(uy / length)


def height(line: Line, disc: Disc) -> Any:
    """The height of a circle's centre over a wall, below 0 on its other side."""
    ux, uy = direction(line)
    return normal(ux * (disc.y - line.y0) - uy * (disc.x - line.x0))


def apart(line: Line, disc: Disc) -> Any:
    """How far a circle's centre is from a wall, from a segment at least, or from the circle of an arc."""
    if isinstance(line, Bow):
        return abs(root(normal((disc.x - line.x) ** 2 + (disc.y - line.y) ** 2)) - line.r)
    return abs(height(line, disc)) - (line.r if isinstance(line, Bar) else 0)


def to_ends(line: Line, disc: Disc) -> Any:
    """How far the foot of a circle's centre is from the nearer end of a segment, along it."""
    (ux, uy), far = direction(line), root(normal((line.x1 - line.x0) ** 2 + (line.y1 - line.y0) ** 2))
    foot = normal(ux * (disc.x - line.x0) + uy * (disc.y - line.y0))
    return foot if sign(normal(2 * foot - far)) < 0 else normal(far - foot)


def length(x: Any, y: Any) -> Any:
    """A fraction at or above the length of a vector."""
    return above(root(normal(x**2 + y**2)))


def approach_sign(a: Disc, b: Disc | Line) -> int:
    """The sign of the instant speed at which two things come nearer; 0 where that is nan."""
    if isinstance(b, Bow):
        return approach_sign(a, b.disc) * (-1 if b.within else 1)
    if isinstance(b, Line):
        a = b.seen(a)
    (solution,) = _solutions("wall speed" if isinstance(b, Line) else "pair speed")
    return solution.sign(_at(a, b)) or 0


def velocities_after(a: Disc, b: Disc | Line) -> tuple[Expr, ...]:
    """(vx, vy) of a after a collision with a wall or fixed circle b, or (vx, vy) of a and of b.

    Raises:
        ValueError: where the law has no value, as for two points at one place.
    """
    if isinstance(b, Bow):
        return velocities_after(a, b.disc)
    solutions = _solutions("wall" if isinstance(b, Line) else "fixed" if b.m is None else "pair")
    seen = b.seen(a) if isinstance(b, Line) else a
    if isinstance(b, Disc) and b.m is None:
        seen = replace(a, vx=normal(a.vx - b.vx), vy=normal(a.vy - b.vy))
    values = [solution.value(_at(seen, b)) for solution in solutions]
    if isinstance(b, Line) or b.m is None:
        pace = (b.ux, b.uy) if isinstance(b, Line) else (b.vx, b.vy)
        values = [None if v is None else normal(v + u) for v, u in zip(values, pace, strict=True)]
    found = tuple(value for value in values if value is not None)
    if len(found) != len(values):
        raise ValueError("the velocities after this collision have no value")
    return found


@cache
def _solutions(law: str) -> Sequence[Solution]:
    laws: dict[str, Callable[[], tuple[Any, ...]]] = {
        "pair touched": pair_times,
        "wall touched": wall_times,
        "pair speed": lambda: (pair_instant_speed(),),
        "wall speed": lambda: (wall_instant_speed(),),
        "pair": lambda: pair_velocities()[1],
        "fixed": fixed_circle_velocities,
        "wall": wall_velocities,
    }
    return tuple(map(Solution.of, laws[law]()))


def _at(a: Disc, b: Disc | Line) -> dict[Any, Any]:
    """The article's symbols and their numbers."""
    values: dict[Any, Any] = {
        a_x: a.x, a_y: a.y, a_vx: a.vx, a_vy: a.vy, a_r: a.r, a_m: a.m,
    }  # fmt: skip
    if isinstance(b, Line):
        return values | {
            x0: b.x0, y0: b.y0, x1: b.x1, y1: b.y1,
            w_x0: b.x0, w_y0: b.y0, w_x1: b.x1, w_y1: b.y1,
        }  # fmt: skip
    return values | {
        b_x: b.x, b_y: b.y, b_vx: b.vx, b_vy: b.vy, b_r: b.r, b_m: b.m,
    }  # fmt: skip


# -- Several contacts at one instant, in SymPy numbers: who collides, in which order, with which impulses.
#
# `simultaneous` solves, in each round, the complementarity problem of the approaching contacts by trying sets of
# contacts that push: impulses j >= 0, each contact separates at least as fast as it approached, and faster only where
# j = 0. The velocities that come of it are unique, since the problem's matrix is symmetric and positive semidefinite
# (R. Cottle, J.-S. Pang, R. Stone, 'The Linear Complementarity Problem', 3.1).

Indices = tuple[int, int]
"""Two touching things by place in the scene: circles first, then walls."""

MAX_IMPULSES = 1_000
"""Impulses allowed in one cluster at one instant. A chain of n equal balls needs about n**2 / 2."""


class UnendingCollision(ArithmeticError):
    """The impulses at one instant passed their limit, and some pair still approached."""


@dataclass(frozen=True)
class Touching:
    """The things that touch at one instant.

    Attributes:
        discs: all circles of the scene, with the velocities as the instant comes.
        lines: all walls of the scene.
        pairs: the touching pairs, in scene order.
        came: for a point and a wall: the circles as they were on the flight after which the two touch, which alone
            tell on which side of the wall the point is.
    """

    discs: tuple[Disc, ...]
    lines: tuple[Line, ...]
    pairs: tuple[Indices, ...]
    came: Mapping[Indices, tuple[Disc, ...]]

    def things(self, pair: Indices) -> tuple[Disc, Disc | Line]:
        """The two things of a pair; a point at a wall placed where it came from, with its velocity of now."""
        i, j = pair
        a, n = self.discs[i], len(self.discs)
        if j < n:
            return a, self.discs[j]
        line = self.lines[j - n]
        if isinstance(line, Bow):
            dx, dy = a.x - line.x, a.y - line.y
            if sign(a.r) == 0:  # a point is on the side from which it came
                out = self.came[pair][i].vx * dx + self.came[pair][i].vy * dy
                return a, replace(line, within=sign(normal(out)) > 0)
            return a, replace(line, within=sign(normal(dx**2 + dy**2 - line.r**2)) < 0)
        if sign(a.r) == 0 and not (isinstance(line, Bar) and sign(line.r)):
            a = replace(a, x=self.came[pair][i].x, y=self.came[pair][i].y)
        return a, line

    def approaching(self, pairs: Sequence[Indices]) -> list[Indices]:
        """Those of the pairs with a positive instant speed, in scene order."""
        return [pair for pair in sorted(pairs) if approach_sign(*self.things(pair)) > 0]

    def after(self, velocities: Mapping[int, tuple[Any, Any]]) -> Touching:
        """The same with some velocities changed."""
        discs = list(self.discs)
        for i, (vx, vy) in velocities.items():
            discs[i] = replace(discs[i], vx=vx, vy=vy)
        return replace(self, discs=tuple(discs))

    def directions(self, pair: Indices) -> dict[int, tuple[Any, Any]]:
        """For each circle of a pair that can move, the direction in which an impulse pushes it.

        The two of a pair have opposite directions of one length; a wall pushes to the circle's side.
        """
        a, b = self.things(pair)
        i, j = pair
        if isinstance(b, Bow):
            dx, dy = a.x - b.x, a.y - b.y
            return {i: (-dx, -dy) if b.within else (dx, dy)}
        if isinstance(b, Line):
            nx, ny = b.y0 - b.y1, b.x1 - b.x0
            side = sign(normal(nx * (a.x - b.x0) + ny * (a.y - b.y0)))
            return {i: (side * nx, side * ny)}
        dx, dy = b.x - a.x, b.y - a.y
        both = {i: (-dx, -dy), j: (dx, dy)}
        return {k: direction for k, direction in both.items() if self.discs[k].m is not None}


@dataclass(frozen=True)
class Collided:
    """What the impulses of one instant did.

    Attributes:
        touching: the same things with the velocities after.
        first: the contacts that approached as the instant came.
        contacts: these and the ones that came to approach in its rounds, in scene order.
        impulses: the pairs that got an impulse, in order.
    """

    touching: Touching
    first: tuple[Indices, ...]
    contacts: tuple[Indices, ...]
    impulses: tuple[Indices, ...]


def collide(touching: Touching, policy: TiePolicy, draw: Random, e: Any) -> Collided:
    """Applies impulses until no touching pair approaches, cluster by cluster.

    Args:
        touching: who touches.
        policy: all approaching contacts together, or one at a time, looking at all contacts again after each.
        e: the restitution.
        draw: for `sequential` with a seed, where the choices come from; nothing is drawn without a choice.

    Raises:
        UnendingCollision: after `MAX_IMPULSES` in one cluster.
        SymbolicUndecided: if a sign is.
    """
    first = touching.approaching(touching.pairs)
    contacts: set[Indices] = set(first)
    impulses: list[Indices] = []
    for cluster in clusters(touching, first):
        approaching = [pair for pair in first if pair in cluster]
        stop_at = len(impulses) + MAX_IMPULSES
        while approaching:
            if policy.name == "sequential":
                drawn = policy.seed is not None and len(approaching) > 1
                approaching = [draw.choice(approaching) if drawn else approaching[0]]
            touching, pushed = together(touching, approaching, e)
            impulses += pushed
            if len(impulses) > stop_at:
                raise UnendingCollision(f"over {MAX_IMPULSES} impulses at one instant")
            approaching = touching.approaching(cluster)
            contacts.update(approaching)
    return Collided(touching, tuple(first), tuple(sorted(contacts)), tuple(impulses))


def together(touching: Touching, pairs: Sequence[Indices], e: Any) -> tuple[Touching, list[Indices]]:
    """One round: the impulses of some approaching pairs at once, and which pairs got one."""
    pushed: list[Indices] = []
    for group in groups(touching, pairs):
        if len(group) > 1:
            touching, active = _complementary(touching, group, e)
            pushed += active
            continue
        (pair,) = group
        touching = touching.after(_single(touching, pair, e))
        pushed.append(pair)
    return touching, sorted(pushed)


def clusters(touching: Touching, first: Sequence[Indices]) -> list[list[Indices]]:
    """The touching pairs, those together that share a circle, fixed ones too.

    Only clusters that hold a pair of `first`, in the order of the earliest such pair.
    """
    found = _joined(touching.pairs, lambda pair: {k for k in pair if k < len(touching.discs)})
    led = [(min(set(first) & set(members)), members) for members in found if set(first) & set(members)]
    return [members for _, members in sorted(led)]


def groups(touching: Touching, pairs: Sequence[Indices]) -> list[list[Indices]]:
    """The pairs, those together that share a circle that can move, directly or through others."""
    return _joined(pairs, lambda pair: set(touching.directions(pair)))


def _joined(pairs: Sequence[Indices], bodies_of: Callable[[Indices], set[int]]) -> list[list[Indices]]:
    found: list[tuple[set[int], list[Indices]]] = []
    for pair in pairs:
        bodies, members = bodies_of(pair), [pair]
        apart = []
        for others, others_members in found:
            if others & bodies:
                bodies, members = bodies | others, others_members + members
            else:
                apart.append((others, others_members))
        found = [*apart, (bodies, members)]
    return [sorted(members) for _, members in found]


def coupled(touching: Touching, pairs: Sequence[Indices]) -> bool:
    """Whether two contacts share a circle that can move and are not at right angles."""
    for one, other in combinations(pairs, 2):
        pushes, others = touching.directions(one), touching.directions(other)
        for i in pushes.keys() & others.keys():
            if sign(normal(_dot(pushes[i], others[i]))):
                return True
    return False


def _single(touching: Touching, pair: Indices, e: Any) -> dict[int, tuple[Any, Any]]:
    """Velocities after one collision, from the derived law: all of the change for e = 1, none of it for e = -1."""
    (i, j), (a, b) = pair, touching.things(pair)
    if isinstance(b, Disc) and a.m is None:
        (i, j), (a, b) = (j, i), (b, a)
    try:
        found = velocities_after(a, b)
    except ValueError as error:
        raise SymbolicUndecided(str(error)) from error
    after: dict[int, tuple[Any, ...]] = {i: found[:2], j: found[2:]} if len(found) > 2 else {i: found}
    discs = touching.discs
    return {
        k: (normal(((1 - e) * discs[k].vx + (1 + e) * vx) / 2), normal(((1 - e) * discs[k].vy + (1 + e) * vy) / 2))
        for k, (vx, vy, *_) in after.items()
    }


def _complementary(touching: Touching, pairs: Sequence[Indices], e: Any) -> tuple[Touching, list[Indices]]:
    """The round's impulses on pairs that share circles."""
    discs = touching.discs
    pushes = [touching.directions(pair) for pair in pairs]
    masses: dict[int, Any] = {i: discs[i].m for push in pushes for i in push}
    response = [
        [
            normal(sum((_dot(one[i], other[i]) / masses[i] for i in one.keys() & other.keys()), Integer(0)))
            for other in pushes
        ]
        for one in pushes
    ]
    rates = [
        normal(sum((_dot(d, (discs[i].vx, discs[i].vy)) for i, d in push.items()), _drift(touching, pair, push)))
        for pair, push in zip(pairs, pushes, strict=True)
    ]
    impulses = _solve(response, rates, e)
    changed: dict[int, tuple[Any, Any]] = {}
    for i, mass in masses.items():
        vx, vy = discs[i].vx, discs[i].vy
        for push, impulse in zip(pushes, impulses, strict=True):
            if i in push:
                vx, vy = vx + impulse * push[i][0] / mass, vy + impulse * push[i][1] / mass
        changed[i] = (normal(vx), normal(vy))
    active = [pair for pair, impulse in zip(pairs, impulses, strict=True) if sign(impulse)]
    return touching.after(changed), active


def _drift(touching: Touching, pair: Indices, push: Mapping[int, tuple[Any, Any]]) -> Any:
    """What the velocity of a wall, or of an end that moves, adds to the rate at which it and a circle part."""
    number = pair[1] - len(touching.discs)
    if number < 0:
        end = next((touching.discs[k] for k in pair if k not in push), None)
        return Integer(0) if end is None else -_dot(next(iter(push.values())), (end.vx, end.vy))
    line = touching.lines[number]
    return -_dot(push[pair[0]], (line.ux, line.uy))


def _solve(response: list[list[Any]], rates: list[Any], e: Any) -> list[Any]:
    """Impulses j >= 0 with rate + response j >= -e rate, equal where j > 0; largest sets of j > 0 first.

    Raises:
        SymbolicUndecided: if no set fits, which the theory excludes.
    """
    count = len(rates)
    zero = rates[0] * 0
    for size in range(count, 0, -1):
        for active in combinations(range(count), size):
            matrix = Matrix(size, size, lambda r, c, active=active: response[active[r]][active[c]])
            if sign(normal(matrix.det(method="berkowitz"))) == 0:
                continue
            cofactors = matrix.adjugate(method="berkowitz") * Matrix([-(1 + e) * rates[k] for k in active])
            determinant = matrix.det(method="berkowitz")
            impulses = [zero] * count
            for k, value in zip(active, cofactors, strict=True):
                impulses[k] = normal(value / determinant)
            excess = [
                normal((1 + e) * rates[k] + sum(response[k][m] * impulses[m] for m in active))
                for k in range(count)
                if k not in active
            ]
            if all(sign(value) >= 0 for value in (*impulses, *excess)):
                return impulses
    raise SymbolicUndecided("no set of contacts satisfies the laws of a simultaneous collision")


def _dot(one: tuple[Any, Any], other: tuple[Any, Any]) -> Any:
    return one[0] * other[0] + one[1] * other[1]
