"""More planted bugs: contacts that are missed, made up or told wrong, queues and clocks that go wrong, and steppers."""

from __future__ import annotations

from typing import Any

from .bugs import (
    always,
    at_circles,
    at_one_pair,
    at_walls,
    equal_masses,
    heavier,
    losing,
    plant,
    starting,
    tangential,
)
from .honest import (
    AbsoluteTime,
    Events,
    ImpactSteps,
    LazyQueue,
    OverlapSteps,
    ReducedMass,
    Stable,
    StateSteps,
    Textbook,
)
from .worlds import Numbers, Told, World

# -- contacts missed, and made up


def _missing(self: Any, w: World, n: Numbers) -> Any:
    found = Events.next_contact(self, w, n)
    if w.count == 4 and found is not None and "missed" not in w.more:
        w.more["missed"] = list(found[1:])
    if w.count > 4 or found is None or list(found[1:]) != w.more.get("missed"):
        return found
    best = None
    for i, j in self.pairs(w):
        wait = None if [i, j] == w.more["missed"] else self.meets(w, n, i, j)
        if wait is not None and (best is None or wait < best[0]):
            best = (wait, i, j)
    return best


def _phantom(self: Any, w: World, n: Numbers) -> Any:
    found = Events.next_contact(self, w, n)
    if w.count != 5 or found is None:
        return found
    pair = next((p for p in self.pairs(w) if p != found[1:]), found[1:])
    return found[0] / 2, *pair


def _once_more(self: Any, w: World, n: Numbers, i: int, j: int) -> None:
    """At the fifth contact another of the circles is struck as well, and nothing is said of it."""
    Events.collide(self, w, n, i, j)
    others = [k for k in range(w.n) if k not in (i, j) and w.w[k] > 0]
    if w.count == 4 and others:
        w.vx[others[0]] = -w.vx[others[0]]


# -- reports


def telling(parent: Any, change: Any) -> dict[str, Any]:
    """What is told passes through `change(world, reports)`."""

    def go_on(self: Any, w: World, n: Numbers) -> Any:
        told = parent.go_on(self, w, n)
        return told if told is None else change(w, told)

    return {"go_on": go_on}


def _late(w: World, told: list[Told]) -> list[Told]:
    last, w.more["told"] = w.more.get("told", w.t * 0), told[0].time
    return [told[0]._replace(time=last)]


def _later(w: World, told: list[Told]) -> list[Told]:
    return [one._replace(time=one.time + 1e-9 * one.time) for one in told]


def _another_id(w: World, told: list[Told]) -> list[Told]:
    if w.count != 6:
        return told
    (a, b), states = told[0].pairs[0], dict(told[0].states or {})
    other = next((k for k in range(w.n) if w.ids[k] not in (a, b)), None)
    if other is None:
        return told
    return [told[0]._replace(pairs=((a, w.ids[other]),), states={**states, w.ids[other]: w.row(other)})]


def _next_wall(w: World, told: list[Told]) -> list[Told]:
    walls = w.ids[w.n :]
    (a, b) = told[0].pairs[0]
    if b not in walls or len(walls) < 2:
        return told
    return [told[0]._replace(pairs=((a, walls[(walls.index(b) + 1) % len(walls)]),))]


def _exchanged(w: World, told: list[Told]) -> list[Told]:
    states = told[0].states
    if w.count != 5 or states is None or len(states) != 2:
        return told
    (a, one), (b, other) = states.items()
    return [told[0]._replace(states={a: (*one[:2], *other[2:]), b: (*other[:2], *one[2:])})]


def _left_out(w: World, told: list[Told]) -> list[Told]:
    return [] if w.count == 6 else told


def _twice(w: World, told: list[Told]) -> list[Told]:
    return told * 2 if w.count == 5 else told


def _crossed(w: World, told: list[Told]) -> list[Told]:
    if w.count == 6:
        w.more["held"] = told
        return []
    if w.count == 7:
        (first,), (second,) = w.more["held"], told
        return [second._replace(time=first.time), first._replace(time=second.time)]
    return told


def before_impact(parent: Any, only: int | None) -> dict[str, Any]:
    """States are told as they were before the impulse."""

    def collide(self: Any, w: World, n: Numbers, i: int, j: int) -> None:
        w.more["before"] = [w.vx[:], w.vy[:]]
        parent.collide(self, w, n, i, j)

    def go_on(self: Any, w: World, n: Numbers) -> Any:
        told = parent.go_on(self, w, n)
        if told is None or (only is not None and w.count != only):
            return told
        vx, vy = w.more["before"]
        place = {name: k for k, name in enumerate(w.ids)}
        return [
            one._replace(states={a: (*row[:2], vx[place[a]], vy[place[a]]) for a, row in one.states.items()})
            for one in told
        ]

    return {"collide": collide, "go_on": go_on}


# -- queues and clocks


def _half_checked(self: Any, w: World, entry: Any) -> bool:
    return w.more["hits"][entry[1]] != entry[3]


def _unflown(self: Any, w: World, n: Numbers, i: int, j: int) -> None:
    """At the fourth contact of all, the first of the two is not brought to the time of its contact."""
    place = w.x[i], w.y[i]
    LazyQueue.collide(self, w, n, i, j)
    if w.count == 3:
        w.x[i], w.y[i] = place


def _same_clock(self: Any, w: World, n: Numbers, i: int, j: int) -> None:
    since = w.more["since"][i]
    AbsoluteTime.collide(self, w, n, i, j)
    if w.count == 3:
        w.more["since"][i] = since


def _all_but_one(self: Any, w: World) -> None:
    vx, vy = w.vx[0], w.vy[0]
    Events.turn_back(self, w)
    w.vx[0], w.vy[0] = vx, vy


def _centre_hits(self: Any, w: World, n: Numbers, i: int, k: int) -> Any:
    r, w.r[i] = w.r[i], w.r[i] * 0.999
    wait = Events.wall_wait(self, w, n, i, k)
    w.r[i] = r
    return wait


for _name, _sentence, _parent, _methods in (
    ("missed-once", "the fifth contact is missed", Events, {"next_contact": _missing}),
    ("phantom-once", "at the sixth contact two collide that are apart", Events, {"next_contact": _phantom}),
    ("silent-impulse", "at the fifth contact a stranger turns round, untold", Events, {"collide": _once_more}),
    ("time-of-the-last", "each contact is told with the time of the one before", Events, telling(Events, _late)),
    ("time-1e-9-late", "times are told a billionth too large", Stable, telling(Stable, _later)),
    ("another-id", "at the sixth contact another circle is named", Events, telling(Events, _another_id)),
    ("next-wall", "walls are told by the id of the next one", Stable, telling(Stable, _next_wall)),
    (
        "exchanged-states",
        "at the fifth contact the two have each other's velocity",
        Events,
        telling(Events, _exchanged),
    ),
    ("left-out", "the sixth contact is not told", Events, telling(Events, _left_out)),
    ("told-twice", "the fifth contact is told twice", ReducedMass, telling(ReducedMass, _twice)),
    ("crossed", "the sixth and seventh contacts are told with each other's time", Events, telling(Events, _crossed)),
    ("before-impact", "velocities are told as they were before the impulse", Events, before_impact(Events, None)),
    ("before-impact-once", "the same at the fifth contact only", Stable, before_impact(Stable, 5)),
    ("half-checked", "predictions hold though the second has been hit since", LazyQueue, {"stale": _half_checked}),
    ("unflown", "at the fourth contact the first is not flown to it", LazyQueue, {"collide": _unflown}),
    ("old-clock", "at the fourth contact the first keeps its old clock", AbsoluteTime, {"collide": _same_clock}),
    ("turned-but-one", "the reversal leaves out the first circle", Events, {"turn_back": _all_but_one}),
    ("into-the-wall", "circles sink into walls by a thousandth of their radius", Events, {"wall_wait": _centre_hits}),
):
    plant(_name, _sentence, _parent, _methods)


# -- steppers


def by_law(parent: Any, methods: dict[str, Any]) -> dict[str, Any]:
    """A stepper whose impulses are those of a planted law."""
    law = type("Law", (parent,), methods)()
    return {"law": lambda self: law}


def slowing(parent: Any, by: float) -> dict[str, Any]:
    """Velocities fall at every step, by so much a unit of time."""

    def move(self: Any, w: World, number: int) -> None:
        parent.move(self, w, number)
        for k in range(w.n):
            w.vx[k], w.vy[k] = w.vx[k] * (1 - by * self.step), w.vy[k] * (1 - by * self.step)

    return {"move": move}


for _name, _sentence, _parent, _methods in (
    ("steps-0.98", "restitution 0.98 in steps", OverlapSteps, by_law(ReducedMass, losing(ReducedMass, always(0.02)))),
    (
        "steps-0.9",
        "restitution 0.9 in states after steps",
        StateSteps,
        by_law(ReducedMass, losing(ReducedMass, always(0.1))),
    ),
    (
        "steps-walls-0.97",
        "walls give back 0.97 in steps",
        OverlapSteps,
        by_law(ReducedMass, losing(ReducedMass, at_walls(0.03))),
    ),
    (
        "steps-one-pair",
        "one pair gives back 0.9 in steps",
        OverlapSteps,
        by_law(ReducedMass, losing(ReducedMass, at_one_pair(0.1))),
    ),
    (
        "steps-masses",
        "all masses are taken for equal in steps",
        OverlapSteps,
        by_law(ReducedMass, starting(ReducedMass, equal_masses)),
    ),
    (
        "steps-mass",
        "the first mass is 10 % too large, in steps",
        OverlapSteps,
        by_law(ReducedMass, starting(ReducedMass, heavier(0.1))),
    ),
    (
        "steps-friction",
        "tangential parts lose 5 % in steps",
        OverlapSteps,
        by_law(ReducedMass, tangential(ReducedMass, 0.95)),
    ),
    (
        "impact-steps-0.99",
        "restitution 0.99 at times of impact",
        ImpactSteps,
        by_law(Textbook, losing(Textbook, at_circles(0.01))),
    ),
    ("steps-damped", "velocities fall by 1 % a unit of time, in steps", OverlapSteps, slowing(OverlapSteps, 0.01)),
):
    plant(_name, _sentence, _parent, _methods)
