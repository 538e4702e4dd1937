"""Planted bugs: each a small change of one honest engine, with a sentence that says what it is."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from .honest import (
    AbsoluteTime,
    AllTold,
    Angles,
    CentreOfMass,
    Events,
    Householder,
    LazyQueue,
    ReducedMass,
    Stable,
    Textbook,
    TimesOnly,
)
from .worlds import PRECISE, Line, Numbers, World

Methods = dict[str, Any]


@dataclass(frozen=True)
class Bug:
    """A planted bug.

    Attributes:
        name: of the bug, and of its engine.
        sentence: what it is.
        engine: the honest one with the bug.
        parent: the honest one.
    """

    name: str
    sentence: str
    engine: Any
    parent: Any


BUGS: dict[str, Bug] = {}
"""Every bug by its name."""


def plant(name: str, sentence: str, parent: type, methods: Methods) -> None:
    """A bug is a class derived from the honest one."""
    engine = type("Planted", (parent,), {**methods, "name": name, "__doc__": sentence, "__module__": __name__})
    BUGS[name] = Bug(name, sentence, engine(), parent())


# -- impulses that are too small, or too large

Loss = Callable[[World, int, int, list[tuple[Any, Any]]], float]
"""1 - e of a contact: the world before the change of velocities, the two, and how fast they were."""


def losing(parent: Any, loss: Loss) -> Methods:
    """Of each impulse, half of `loss` is left out."""

    def less(honest: Callable[..., None], w: World, n: Numbers, i: int, j: int, other: int) -> None:
        circles = [k for k in (i, other) if k < w.n]
        before = [(w.vx[k], w.vy[k]) for k in circles]
        by = loss(w, i, other, before) / 2
        honest(w, n, i, j)
        for k, (vx, vy) in zip(circles, before, strict=True):
            w.vx[k], w.vy[k] = w.vx[k] - (w.vx[k] - vx) * by, w.vy[k] - (w.vy[k] - vy) * by

    def bounce(self: Any, w: World, n: Numbers, i: int, j: int) -> None:
        less(lambda *args: parent.bounce(self, *args), w, n, i, j, j)

    def reflect(self: Any, w: World, n: Numbers, i: int, k: int) -> None:
        less(lambda *args: parent.reflect(self, *args), w, n, i, k, w.n + k)

    return {"bounce": bounce, "reflect": reflect}


def always(e: float) -> Loss:
    """The same loss everywhere."""
    return lambda w, i, j, before: e


def at_walls(e: float) -> Loss:
    return lambda w, i, j, before: e if j >= w.n else 0.0


def at_circles(e: float) -> Loss:
    return lambda w, i, j, before: 0.0 if j >= w.n else e


def at_one_pair(e: float) -> Loss:
    return lambda w, i, j, before: e if {i, j} == {0, 1} else 0.0


def _fast(e: float, above: float) -> Loss:
    return lambda w, i, j, before: e if max(vx * vx + vy * vy for vx, vy in before) > above * above else 0.0


def _once(e: float, at: int) -> Loss:
    return lambda w, i, j, before: e if w.count == at else 0.0


def _tied(w: World, i: int, j: int, before: Any) -> float:
    last, w.more["last"] = w.more.get("last"), w.t
    return -1.0 if last is not None and last == w.t else 0.0


for _name, _sentence, _parent, _loss in (
    ("restitution-0.999", "coefficient of restitution 0.999 everywhere", Events, always(1e-3)),
    ("restitution-0.98", "coefficient of restitution 0.98 everywhere", Stable, always(0.02)),
    ("restitution-0.9", "coefficient of restitution 0.9 everywhere", Textbook, always(0.1)),
    ("restitution-1e-6", "coefficient of restitution 1 - 1e-6", LazyQueue, always(1e-6)),
    ("restitution-1e-10", "coefficient of restitution 1 - 1e-10", ReducedMass, always(1e-10)),
    ("restitution-1e-17", "coefficient of restitution 1 - 1e-17, which no double can tell", Events, always(1e-17)),
    ("gains-1e-9", "impulses larger by a billionth", AbsoluteTime, always(-1e-9)),
    ("walls-0.98", "walls give back 0.98 of the normal speed", Events, at_walls(0.02)),
    ("walls-impulse-0.97", "a wall's impulse is 3 % less", Householder, at_walls(0.06)),
    ("circles-0.98", "circles among themselves give back 0.98", Angles, at_circles(0.02)),
    ("circles-1e-8", "circles among themselves give back 1 - 1e-8", AllTold, at_circles(1e-8)),
    ("one-pair-0.9", "the first two circles give back 0.9 when they meet", Events, at_one_pair(0.1)),
    ("above-speed-0.9", "0.9 is given back where one of the two is faster than 1.1", Stable, _fast(0.1, 1.1)),
    ("once-0.9", "0.9 is given back at the sixth contact, and only there", Events, _once(0.1, 5)),
    ("once-1e-9", "1 - 1e-9 is given back at the fourth contact, and only there", LazyQueue, _once(1e-9, 3)),
    ("tie-doubled", "the second contact of one time has twice its impulse", Events, _tied),
    ("times-restitution-0.98", "restitution 0.98, and no states are told", TimesOnly, always(0.02)),
):
    plant(_name, _sentence, _parent, losing(_parent, _loss))


# -- numbers of the scene that are taken wrong


def starting(parent: Any, change: Callable[[World], None]) -> Methods:
    """The world begins otherwise."""

    def world(self: Any, scene: Any) -> World:
        made = parent.world(self, scene)
        change(made)
        return made

    return {"world": world}


def heavier(share: float) -> Callable[[World], None]:
    def change(w: World) -> None:
        k = next((k for k in range(w.n) if w.m[k] is not None), 0)
        if w.m[k] is not None:
            w.m[k] = w.m[k] * (1 + share)
            w.w[k] = 1 / w.m[k]

    return change


def _radius(share: float) -> Callable[[World], None]:
    def change(w: World) -> None:
        w.r[0] = w.r[0] * (1 + share)

    return change


def equal_masses(w: World) -> None:
    w.m = [None if m is None else w.t + 1.0 for m in w.m]
    w.w = [w.t + (0.0 if m is None else 1.0) for m in w.m]


def _inverted(w: World) -> None:
    w.m, w.w = [m and 1 / m for m in w.m], [w.t if m is None else m for m in w.m]


def _unmoved(w: World) -> None:
    light = min((m for m in w.m if m is not None), default=None)
    if light is not None:
        for k, m in enumerate(w.m):
            if m is not None and m > 50 * light:
                w.w[k] = w.t


def _displaced(by: float) -> Callable[[World], None]:
    def change(w: World) -> None:
        if w.walls:
            q = w.walls[0]
            size = max(abs(q.x), abs(q.y), w.r[0])
            w.walls[0] = Line(q.x + by * size * q.nx, q.y + by * size * q.ny, q.nx, q.ny)

    return change


def _turned(by: float) -> Callable[[World], None]:
    def change(w: World) -> None:
        if w.walls:
            q = w.walls[-1]
            w.walls[-1] = Line(q.x, q.y, q.nx - by * q.ny, q.ny + by * q.nx)

    return change


for _name, _sentence, _parent, _change in (
    ("masses-equal", "all masses are taken for equal", Events, equal_masses),
    ("masses-inverted", "masses are taken for their inverses", Stable, _inverted),
    ("heavy-unmoved", "what is 50 times heavier than the lightest has no recoil", Events, _unmoved),
    ("mass-1e-2", "the first mass is 1 % too large", ReducedMass, heavier(1e-2)),
    ("mass-1e-6", "the first mass is 1e-6 too large", Textbook, heavier(1e-6)),
    ("mass-1e-10", "the first mass is 1e-10 too large", Events, heavier(1e-10)),
    ("radius-1e-6", "the first radius is 1e-6 too large", Events, _radius(1e-6)),
    ("radius-1e-9", "the first radius is 1e-9 too small", LazyQueue, _radius(-1e-9)),
    ("radius-1e-12", "the first radius is 1e-12 too large", AllTold, _radius(1e-12)),
    ("wall-displaced-1e-8", "the first wall stands 1e-8 of its distance aside", Events, _displaced(1e-8)),
    ("wall-displaced-1e-12", "the first wall stands 1e-12 of its distance aside", Stable, _displaced(1e-12)),
    ("wall-turned-1e-7", "the last wall's normal is turned by 1e-7", Events, _turned(1e-7)),
    ("times-mass-1e-2", "the first mass is 1 % too large, and no states are told", TimesOnly, heavier(1e-2)),
):
    plant(_name, _sentence, _parent, starting(_parent, _change))


# -- wrong formulas


def _along_velocity(self: Any, w: World, n: Numbers, i: int, j: int) -> None:
    vx, vy = w.vx[j] - w.vx[i], w.vy[j] - w.vy[i]
    push = 2 / (w.w[i] + w.w[j])
    self.kick(w, i, w.w[i] * push * vx, w.w[i] * push * vy)
    self.kick(w, j, -w.w[j] * push * vx, -w.w[j] * push * vy)


def _keeping(parent: Any) -> Methods:
    """The places before the flight are those of the line of centres."""

    def fly(self: Any, w: World, wait: Any) -> None:
        w.more["old"] = [(x, y) for x, y in zip(w.x, w.y, strict=True)]
        parent.fly(self, w, wait)

    def bounce(self: Any, w: World, n: Numbers, i: int, j: int) -> None:
        now = list(w.x), list(w.y)
        for k in (i, j):
            w.x[k], w.y[k] = w.more["old"][k]
        parent.bounce(self, w, n, i, j)
        w.x, w.y = now

    return {"fly": fly, "bounce": bounce}


def _mirrored(self: Any, w: World, n: Numbers, i: int, j: int) -> None:
    dx, dy = w.x[j] - w.x[i], w.y[j] - w.y[i]
    for k in (i, j):
        if w.w[k] > 0:
            part = 2 * (w.vx[k] * dx + w.vy[k] * dy) / (dx * dx + dy * dy)
            self.kick(w, k, -part * dx, -part * dy)


def _first_only(self: Any, w: World, n: Numbers, i: int, j: int) -> None:
    if w.w[i] > 0 and w.w[j] > 0 and w.w[i] != w.w[j]:
        vx, vy = w.vx[j], w.vy[j]
        w.vx[j] = w.vy[j] = w.t * 0
        Events.bounce(self, w, n, i, j)
        self.kick(w, j, vx, vy)
    else:
        Events.bounce(self, w, n, i, j)


def tangential(parent: Any, factor: float) -> Methods:
    """The relative velocity across the line of centres is multiplied, momentum being kept."""

    def bounce(self: Any, w: World, n: Numbers, i: int, j: int) -> None:
        parent.bounce(self, w, n, i, j)
        dx, dy = w.x[j] - w.x[i], w.y[j] - w.y[i]
        across = ((w.vy[j] - w.vy[i]) * dx - (w.vx[j] - w.vx[i]) * dy) / (dx * dx + dy * dy)
        push = (factor - 1) * across / (w.w[i] + w.w[j])
        self.kick(w, i, w.w[i] * push * dy, -w.w[i] * push * dx)
        self.kick(w, j, -w.w[j] * push * dy, w.w[j] * push * dx)

    return {"bounce": bounce}


def _sequential(self: Any, w: World, n: Numbers, i: int, j: int) -> None:
    for k, o in ((i, j), (j, i)):
        if w.m[k] is not None:
            share = w.t * 0 + 2 if w.m[o] is None else 2 * w.m[o] / (w.m[k] + w.m[o])
            dx, dy = w.x[k] - w.x[o], w.y[k] - w.y[o]
            part = share * (((w.vx[k] - w.vx[o]) * dx + (w.vy[k] - w.vy[o]) * dy) / (dx * dx + dy * dy))
            self.kick(w, k, -part * dx, -part * dy)


def _mean_frame(self: Any, w: World, n: Numbers, i: int, j: int) -> None:
    kept = w.m
    w.m = [None if m is None else w.t * 0 + 1 for m in kept]
    CentreOfMass.bounce(self, w, n, i, j)
    w.m = kept


def _half_turn(self: Any, w: World, n: Numbers, i: int, j: int) -> None:
    """atan where atan2 is due: the line of centres is the same, the other way round."""
    flipped = [-v for v in w.x], [-v for v in w.y]
    kept = w.x, w.y
    if w.x[j] < w.x[i]:
        w.x, w.y = flipped
    Angles.bounce(self, w, n, i, j)
    w.x, w.y = kept


def _larger_part(self: Any, w: World, n: Numbers, i: int, k: int) -> None:
    wall = w.walls[k]
    if abs(wall.nx) > abs(wall.ny):
        w.vx[i] = -w.vx[i]
    else:
        w.vy[i] = -w.vy[i]


def _skin(by: float) -> Methods:
    def reach(self: Any, w: World, i: int, j: int) -> Any:
        return (w.r[i] + w.r[j]) * (1 + by)

    return {"reach": reach}


def _first_radius(self: Any, w: World, i: int, j: int) -> Any:
    return w.r[i] * 2 if w.r[i] > 0 else w.r[i] + w.r[j]


def _pulled(parent: Any, at: float) -> Methods:
    """All fly in a constant field."""

    def fly(self: Any, w: World, wait: Any) -> None:
        parent.fly(self, w, wait)
        scale = _speed(w)
        for k in range(w.n):
            if w.w[k] > 0:
                w.vy[k] = w.vy[k] - at * wait * scale

    return {"fly": fly}


def _damped(parent: Any, by: float) -> Methods:
    """All slow down while they fly."""

    def fly(self: Any, w: World, wait: Any) -> None:
        parent.fly(self, w, wait)
        for k in range(w.n):
            w.vx[k], w.vy[k] = w.vx[k] - w.vx[k] * by * wait, w.vy[k] - w.vy[k] * by * wait

    return {"fly": fly}


def _speed(w: World) -> Any:
    return max(max(abs(vx), abs(vy)) for vx, vy in zip(w.vx, w.vy, strict=True))


for _name, _sentence, _parent, _methods in (
    ("along-velocity", "the impulse is along the relative velocity", Events, {"bounce": _along_velocity}),
    ("stale-line", "the line of centres is that of before the flight", Events, _keeping(Events)),
    ("energy-only", "each of two is mirrored by itself: energy is kept, momentum not", Events, {"bounce": _mirrored}),
    ("second-at-rest", "unequal masses: the second is taken to be at rest", Events, {"bounce": _first_only}),
    ("tangent-flipped", "the tangential part changes its sign too", Stable, tangential(Stable, -1.0)),
    ("friction-1e-2", "the tangential part loses 1 %", Events, tangential(Events, 0.99)),
    ("friction-1e-6", "the tangential part loses 1e-6", Textbook, tangential(Textbook, 1 - 1e-6)),
    ("updated-too-soon", "the second velocity is reckoned from the first's new one", Textbook, {"bounce": _sequential}),
    ("mean-frame", "the frame of the centre of mass is that of equal masses", CentreOfMass, {"bounce": _mean_frame}),
    ("half-turn", "atan in the place of atan2, which comes to the same", Angles, {"bounce": _half_turn}),
    ("larger-part", "walls change the sign of the larger part only", Events, {"reflect": _larger_part}),
    ("skin-1e-6", "circles collide at 1e-6 of their reach before they touch", Stable, _skin(1e-6)),
    ("skin-1e-3", "circles collide at 1e-3 of their reach after they touch", Events, _skin(-1e-3)),
    ("first-radius", "two circles touch at twice the first's radius", Stable, {"reach": _first_radius}),
    ("field-1e-10", "a field of 1e-10 of the largest speed a unit of time", AllTold, _pulled(AllTold, 1e-10)),
    ("damping-1e-9", "velocities fall by 1e-9 a unit of time", AllTold, _damped(AllTold, 1e-9)),
    (
        "damping-1e-6",
        "velocities fall by 1e-6 a unit of time, the pair alone being told",
        Events,
        _damped(Events, 1e-6),
    ),
):
    plant(_name, _sentence, _parent, _methods)


# -- places and speeds that are touched after the impact, and numbers that are too narrow


def after(parent: Any, change: Callable[[World, Numbers, int, int], None]) -> Methods:
    """Something is done to the world after each contact."""

    def collide(self: Any, w: World, n: Numbers, i: int, j: int) -> None:
        parent.collide(self, w, n, i, j)
        change(w, n, i, j)

    return {"collide": collide}


def coarse(value: Any, bits: int = 24) -> Any:
    """A number of any type rounded to few bits."""
    if value == 0:
        return value
    if isinstance(value, float):
        mantissa, exponent = math.frexp(value)
        return math.ldexp(round(math.ldexp(mantissa, bits)), exponent - bits)
    mantissa, exponent = PRECISE.frexp(value)
    return PRECISE.ldexp(PRECISE.nint(PRECISE.ldexp(mantissa, bits)), exponent - bits)


def _nudged(by: float) -> Callable[[World, Numbers, int, int], None]:
    def change(w: World, n: Numbers, i: int, j: int) -> None:
        w.x[i] = w.x[i] + by * max(abs(w.x[i]), abs(w.y[i]), w.r[i])

    return change


def _separated(by: float) -> Callable[[World, Numbers, int, int], None]:
    def change(w: World, n: Numbers, i: int, j: int) -> None:
        if j < w.n:
            dx, dy = w.x[j] - w.x[i], w.y[j] - w.y[i]
            for k, way in ((i, -1), (j, 1)):
                if w.w[k] > 0:
                    w.x[k], w.y[k] = w.x[k] + way * by * dx, w.y[k] + way * by * dy

    return change


def _clamped(below: float) -> Callable[[World, Numbers, int, int], None]:
    def change(w: World, n: Numbers, i: int, j: int) -> None:
        for k in (i, j):
            if k < w.n:
                w.vx[k] = w.vx[k] * 0 if abs(w.vx[k]) < below else w.vx[k]
                w.vy[k] = w.vy[k] * 0 if abs(w.vy[k]) < below else w.vy[k]

    return change


def _limited(top: float) -> Callable[[World, Numbers, int, int], None]:
    def change(w: World, n: Numbers, i: int, j: int) -> None:
        for k in (i, j):
            speed = n.hypot(w.vx[k], w.vy[k]) if k < w.n else 0
            if speed > top:
                w.vx[k], w.vy[k] = w.vx[k] * top / speed, w.vy[k] * top / speed

    return change


def _narrow_speeds(w: World, n: Numbers, i: int, j: int) -> None:
    for k in (i, j):
        if k < w.n:
            w.vx[k], w.vy[k] = coarse(w.vx[k]), coarse(w.vy[k])


def _narrow_places(w: World, n: Numbers, i: int, j: int) -> None:
    for k in (i, j):
        if k < w.n:
            w.x[k], w.y[k] = coarse(w.x[k]), coarse(w.y[k])


def _narrow_root(parent: Any) -> Methods:
    """The square root alone is narrow."""

    def root(self: Any, n: Numbers, *args: Any) -> Any:
        return parent.root(self, n._replace(sqrt=lambda value: coarse(n.sqrt(value))), *args)

    return {"root": root}


def _narrow_time(parent: Any, bits: int) -> Methods:
    def root(self: Any, n: Numbers, *args: Any) -> Any:
        wait = parent.root(self, n, *args)
        return wait if wait is None else coarse(wait, bits)

    return {"root": root}


def _narrow_line(self: Any, w: World, n: Numbers, i: int, j: int) -> None:
    """As the honest one, with a unit vector in 24 bits."""
    dx, dy = w.x[j] - w.x[i], w.y[j] - w.y[i]
    far = n.hypot(dx, dy)
    nx, ny = coarse(dx / far), coarse(dy / far)
    push = 2 * ((w.vx[j] - w.vx[i]) * nx + (w.vy[j] - w.vy[i]) * ny) / (w.w[i] + w.w[j])
    self.kick(w, i, w.w[i] * push * nx, w.w[i] * push * ny)
    self.kick(w, j, -w.w[j] * push * nx, -w.w[j] * push * ny)


for _name, _sentence, _parent, _methods in (
    ("nudge-1e-12", "the first of the two is put 1e-12 aside at each contact", Events, after(Events, _nudged(1e-12))),
    ("nudge-1e-20", "the same by 1e-20, which no double can tell", Events, after(Events, _nudged(1e-20))),
    ("separation-1e-9", "circles are put 1e-9 of their distance apart", Stable, after(Stable, _separated(1e-9))),
    ("clamp-1e-3", "parts of velocities below 1e-3 become 0", Events, after(Events, _clamped(1e-3))),
    ("clamp-1e-7", "parts of velocities below 1e-7 become 0", AllTold, after(AllTold, _clamped(1e-7))),
    ("top-speed-2", "nothing is faster than 2", Events, after(Events, _limited(2.0))),
    ("narrow-speeds", "velocities pass through 24 bits", Events, after(Events, _narrow_speeds)),
    ("narrow-places", "places pass through 24 bits", Events, after(Events, _narrow_places)),
    ("narrow-root", "the square root is one of 24 bits", Events, _narrow_root(Events)),
    ("narrow-time", "the time to a contact has 24 bits", Stable, _narrow_time(Stable, 24)),
    ("time-of-40-bits", "the time to a contact has 40 bits", Events, _narrow_time(Events, 40)),
    ("narrow-line", "the line of centres is a unit vector of 24 bits", ReducedMass, {"bounce": _narrow_line}),
):
    plant(_name, _sentence, _parent, _methods)
