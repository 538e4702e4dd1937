"""Several contacts at one instant, in SymPy numbers: who collides, in which order, with which impulses.

`simultaneous` solves, in each round, the complementarity problem of the approaching contacts by trying
sets of contacts that push: impulses j >= 0, each contact separates at least as fast as it approached, and
faster only where j = 0. The velocities that come of it are unique, since the problem's matrix is symmetric
and positive semidefinite (R. Cottle, J.-S. Pang, R. Stone, 'The Linear Complementarity Problem', 3.1).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from random import Random
from typing import Any

from sympy import Integer, Matrix

from ...scenarios.settings import TiePolicy
from .laws import Disc, Line, approach_sign, velocities_after
from .sign import SymbolicUndecided, normal, sign

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
        came: for a point and a wall: the circles as they were before the two touched, which alone tell on
            which side of the wall the point is.
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
        if sign(a.r) == 0:
            a = replace(a, x=self.came[pair][i].x, y=self.came[pair][i].y)
        return a, self.lines[j - n]

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


def collide(touching: Touching, policy: TiePolicy, draw: Random) -> Collided:
    """Applies impulses until no touching pair approaches, cluster by cluster.

    Args:
        touching: who touches.
        policy: all approaching contacts together, or one at a time, looking at all contacts again after each.
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
            touching, pushed = together(touching, approaching)
            impulses += pushed
            if len(impulses) > stop_at:
                raise UnendingCollision(f"over {MAX_IMPULSES} impulses at one instant")
            approaching = touching.approaching(cluster)
            contacts.update(approaching)
    return Collided(touching, tuple(first), tuple(sorted(contacts)), tuple(impulses))


def together(touching: Touching, pairs: Sequence[Indices]) -> tuple[Touching, list[Indices]]:
    """One round: the impulses of some approaching pairs at once, and which pairs got one."""
    pushed: list[Indices] = []
    for group in groups(touching, pairs):
        if len(group) > 1:
            touching, active = _complementary(touching, group)
            pushed += active
            continue
        (pair,) = group
        touching = touching.after(_single(touching, pair))
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


def _single(touching: Touching, pair: Indices) -> dict[int, tuple[Any, Any]]:
    """Velocities after one collision, from the derived law."""
    (i, j), (a, b) = pair, touching.things(pair)
    if isinstance(b, Disc) and a.m is None:
        (i, j), (a, b) = (j, i), (b, a)
    try:
        found = velocities_after(a, b)
    except ValueError as error:
        raise SymbolicUndecided(str(error)) from error
    if len(found) == 2:
        return {i: (found[0], found[1])}
    return {i: (found[0], found[1]), j: (found[2], found[3])}


def _complementary(touching: Touching, pairs: Sequence[Indices]) -> tuple[Touching, list[Indices]]:
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
    rates = [normal(sum((_dot(d, (discs[i].vx, discs[i].vy)) for i, d in push.items()), Integer(0))) for push in pushes]
    impulses = _solve(response, rates)
    changed: dict[int, tuple[Any, Any]] = {}
    for i, mass in masses.items():
        vx, vy = discs[i].vx, discs[i].vy
        for push, impulse in zip(pushes, impulses, strict=True):
            if i in push:
                vx, vy = vx + impulse * push[i][0] / mass, vy + impulse * push[i][1] / mass
        changed[i] = (normal(vx), normal(vy))
    active = [pair for pair, impulse in zip(pairs, impulses, strict=True) if sign(impulse)]
    return touching.after(changed), active


def _solve(response: list[list[Any]], rates: list[Any]) -> list[Any]:
    """Impulses j >= 0 with rate + response j >= -rate, equal where j > 0; largest sets of j > 0 first.

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
            cofactors = matrix.adjugate(method="berkowitz") * Matrix([-2 * rates[k] for k in active])
            determinant = matrix.det(method="berkowitz")
            impulses = [zero] * count
            for k, value in zip(active, cofactors, strict=True):
                impulses[k] = normal(value / determinant)
            excess = [
                normal(2 * rates[k] + sum(response[k][m] * impulses[m] for m in active))
                for k in range(count)
                if k not in active
            ]
            if all(sign(value) >= 0 for value in (*impulses, *excess)):
                return impulses
    raise SymbolicUndecided("no set of contacts satisfies the laws of a simultaneous collision")


def _dot(one: tuple[Any, Any], other: tuple[Any, Any]) -> Any:
    return one[0] * other[0] + one[1] * other[1]
