"""Whether a planted bug changes what a run reports by more than rounding, decided without any rounding.

The engine with the bug runs in its own numbers. Before each step its state is taken over into 60 digits, exactly; from
there the engine with the bug and its honest parent make one step each. What the two report then differs by the bug
alone. The difference is told in units of u times the sizes by which honest rounding is measured (`residuals`).
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from .bugs import Bug
from .honest import Events
from .residuals import Bodies, impact_residuals
from .scenes import Case, scene_of
from .worlds import MP, PRECISE, World, precisely

VISIBLE, INVISIBLE, BETWEEN = "visible", "invisible", "between"

SEEN, UNSEEN = 1000.0, 1.0
"""Units of rounding above which a step is wrong beyond doubt, and below which nobody can tell."""

ALIKE = 1e-4
"""Share of the largest speed within which a step in an engine's own numbers is that of 60 digits."""

MEASURED = {
    "flight": "clock*age",
    "told gap": "clock+d2/R",
    "strength": "with clock/R",
    "direction": "with clock/R",
}
"""By which size each residual is told."""


class Seen(NamedTuple):
    """How far a bug shows on a scene.

    Attributes:
        kind: visible, invisible, or in between.
        units: the largest effect of a step, in units of rounding.
        event: of which reported event it is; of the first that is beyond doubt.
        what: flight, gap, strength, direction, missed, untold.
    """

    kind: str
    units: float
    event: int
    what: str


def classify(bug: Bug, case: Case) -> Seen:
    """How far a bug shows on a scene within its span."""
    if bug.engine.step is not None:
        return _of_steps(bug, case)
    if bug.engine.tells == "nothing":
        return _of_times(bug, case)
    best = Seen(INVISIBLE, 0.0, -1, "")
    for event, what, units in _effects(bug, case):
        if units > best.units:
            kind = VISIBLE if units > SEEN else BETWEEN if units > UNSEEN else INVISIBLE
            best = Seen(kind, units, event, what)
        if best.kind == VISIBLE:
            break
    return best


def _effects(bug: Bug, case: Case) -> Iterator[tuple[int, str, float]]:
    """(event, what, units) of every step of the run with the bug."""
    scene, engine, parent = scene_of(case.name), bug.engine, bug.parent
    u = precisely(2.0**-engine.bits)
    world, fresh = engine.world(scene), parent.world(scene)
    pristine = {key: getattr(fresh, key) for key in ("r", "m", "w", "walls", "sides")}
    bodies = Bodies.of_world(fresh.lifted(), Bodies(scene))
    since, ages, pending, told_events = [0.0] * world.n, [0] * world.n, {}, 0
    while told_events < case.events:
        wrong, right = world.lifted(), world.copied()
        vars(right).update(pristine)
        right = right.lifted()
        if "queue" in right.more:  # what was predicted with the bug, in the engine's numbers, is predicted anew
            right.more["queue"] = []
            parent.predict(right, MP, list(parent.pairs(right)))
        start = wrong.copied()
        with np.errstate(all="ignore"):
            said = engine.go_on(world, engine.numbers)
            bad, good = engine.go_on(wrong, MP), parent.go_on(right, MP)
        if bad is None or said is None:
            if good is not None:
                yield told_events, "quiet", 2 * UNSEEN
            return
        alike = _alike(said, bad)
        state = _Step(bodies, u, start, engine, since, ages, told_events)
        expected = list(state.of(good, quietly=True)) if good else []
        same = good is not None and [t.pairs for t in bad] == [t.pairs for t in good]
        base: dict[tuple[str, int], float] = {}
        for key, units in expected:
            base[key] = max(units, base.get(key, 0.0))
        for (what, body), units in state.of(bad) if alike else ():
            yield told_events, what, max(0.0, units - (base.get((what, body), 0.0) if same else 0.0))
        if good and bad and alike and not same:
            yield told_events, "missed", state.missed(good[0], bad[0].time)
        named = {name for one in said for name in one.states or {}}
        for k in range(world.n):
            if world.ids[k] in named and k in pending:
                yield told_events, "untold", pending.pop(k)
        _untold(state, wrong, bad, pending)
        for k in range(world.n):
            ages[k] = 0 if world.ids[k] in named else ages[k] + 1
            if world.ids[k] in named:
                since[k] = float(world.t)
        if world.turn == world.count:
            since[:] = [float(world.t)] * world.n
        told_events += len(said)


def _alike(said: Any, precise: Any) -> bool:
    """Whether the engine does in its own numbers what it does in 60 digits: near a threshold it may do otherwise."""
    if [t.pairs for t in said] != [t.pairs for t in precise]:
        return False
    for one, other in zip(said, precise, strict=True):
        rows = one.states or {}
        top = max((abs(float(v)) for row in rows.values() for v in row[2:]), default=0.0)
        for name, row in rows.items():
            if any(
                abs(float(a) - float(b)) > ALIKE * top for a, b in zip(row[2:], other.states[name][2:], strict=True)
            ):
                return False
    return True


def _untold(state: _Step, after: World, reports: Any, pending: dict[int, float]) -> None:
    """Velocities that are others than the reports say, or changed and were not reported."""
    told = {name: row for one in reports for name, row in (one.states or {}).items()}
    sign = -1 if after.turn is not None and after.turn == after.count and state.start.count != after.count else 1
    for k in range(after.n):
        row = told.get(after.ids[k])
        vx, vy = (row[2], row[3]) if row is not None else (state.start.vx[k], state.start.vy[k])
        off = PRECISE.hypot(after.vx[k] - sign * vx, after.vy[k] - sign * vy)
        size = PRECISE.hypot(vx, vy) + PRECISE.hypot(after.vx[k], after.vy[k])
        if off > 0:
            pending[k] = max(pending.get(k, 0.0), float(off / size / state.u))


class _Step:
    """One step from a start in 60 digits, and what is wrong with reports of it."""

    def __init__(self, bodies: Any, u: Any, start: World, engine: Any, since: Any, ages: Any, event: int) -> None:
        self.bodies, self.u, self.start, self.event = bodies, u, start, event
        self.places = [engine.place(start, k) for k in range(start.n)]
        self.since, self.ages = [precisely(t) for t in since], ages

    def flown(self, k: int, time: Any) -> tuple[Any, Any]:
        """Where a circle is at a time, by its flight."""
        (x, y), w, dt = self.places[k], self.start, time - self.start.t
        return x + w.vx[k] * dt, y + w.vy[k] * dt

    def of(self, reports: Any, quietly: bool = False) -> Iterator[tuple[tuple[str, int], float]]:
        """((what, body), units) of reports, one after the other."""
        w, bodies = self.start, self.bodies
        now = {k: [self.since[k], *self.places[k], w.vx[k], w.vy[k]] for k in range(w.n)}
        at = dict.fromkeys(range(w.n), w.t)
        for time, pairs, states in reports:
            new, flown = {}, {}
            for k in range(w.n):
                old, dt = now[k], time - at[k]
                flown[k] = (old[1] + old[3] * dt, old[2] + old[4] * dt)
                row = (states or {}).get(w.ids[k])
                new[k] = [time, *(flown[k] if row is None or bodies.w[k] == 0 else row[:2]), *(row or old[1:])[2:]]
                if bodies.w[k] == 0:
                    new[k] = [time, *self.places[k], old[3], old[4]]
                if row is None or bodies.w[k] == 0:
                    continue
                for axis in (0, 1):
                    size = abs(old[1 + axis]) + abs(new[k][1 + axis])
                    size += (abs(old[3 + axis]) + abs(new[k][3 + axis])) * abs(time)
                    off = abs(new[k][1 + axis] - flown[k][axis])
                    if off > 0:
                        yield ("flight", k), float(off / (size * self.u * (1 + self.ages[k])))
            for a, b in pairs:
                i, j = sorted((bodies.ids[a], bodies.ids[b]))
                for r in impact_residuals(bodies, self.event, i, j, time, now, new, flown):
                    if r.kind in MEASURED:
                        yield (r.kind, i), r.units(MEASURED[r.kind], self.u)
            for k in range(w.n):
                if w.ids[k] in (states or {}):
                    now[k], at[k] = new[k], time

    def missed(self, good: Any, until: Any) -> float:
        """How deep two sink into each other that should have collided, up to a time, in units of rounding."""
        w, bodies = self.start, self.bodies
        a, b = good.pairs[0]
        i, j = sorted((bodies.ids[a], bodies.ids[b]))
        if until <= good.time:
            return 0.0
        xi, yi = self.flown(i, until)
        clock = (PRECISE.hypot(w.vx[i], w.vy[i])) * abs(until)
        if j >= w.n:
            x0, y0, nx, ny, bad = bodies.walls[j - w.n]
            side = bodies.sides[i][j - w.n]
            depth = bodies.r[i] - side * (nx * (xi - x0) + ny * (yi - y0))
            far = PRECISE.hypot(xi - x0, yi - y0)
            return float(depth / (self.u * (max(abs(xi), abs(yi), abs(x0), abs(y0)) + clock + far * (1 + bad))))
        (px, py), (qx, qy) = self.places[i], self.places[j]
        dx, dy, vx, vy = qx - px, qy - py, w.vx[j] - w.vx[i], w.vy[j] - w.vy[i]
        reach = bodies.r[i] + bodies.r[j]
        best = min(until - w.t, -(dx * vx + dy * vy) / (vx * vx + vy * vy))
        depth = reach - PRECISE.hypot(dx + vx * best, dy + vy * best)
        back = w.t - max(self.since[i], self.since[j])
        away = PRECISE.hypot(dx - vx * back, dy - vy * back)
        clock += PRECISE.hypot(w.vx[j], w.vy[j]) * abs(until)
        size = max(abs(v) for v in (xi, yi, px, py, qx, qy, reach)) + clock + away * away / reach
        return max(0.0, float(depth / (size * self.u)))


def _of_times(bug: Bug, case: Case) -> Seen:
    """Of a log without states: times, held against those of the honest engine in 60 digits, while they hold at all."""
    scene = scene_of(case.name)
    runs = [list(_told(engine, scene, numbers, case.events)) for engine, numbers in (
        (bug.engine, bug.engine.numbers), (bug.parent, bug.parent.numbers), (bug.parent, MP))]  # fmt: skip
    best = Seen(INVISIBLE, 0.0, -1, "")
    for event, (wrong, right, true) in enumerate(zip(*runs, strict=False)):
        time = float(true[0])
        honest = abs(float(right[0] - true[0]))
        if right[1] != true[1] or honest > 1e-9 * time:
            break
        off = abs(float(wrong[0] - true[0]))
        units = off / max(honest, 2.0**-53 * time)
        if wrong[1] != true[1] or (off > 1e-5 * time and units > 1e6):
            return Seen(VISIBLE, units, event, "time")
        if units > max(best.units, 64.0):
            best = Seen(BETWEEN, units, event, "time")
    return best


def _told(engine: Events, scene: Any, numbers: Any, events: int) -> Iterator[Any]:
    world = engine.world(scene)
    if numbers is MP:
        world = world.lifted()
    for _ in range(events):
        told = engine.go_on(world, numbers)
        if told is None:
            return
        for one in told:
            yield precisely(one.time), one.pairs


STRONG, OFTEN = 1e-3, 5
"""Share of the relative velocity by which an impulse in a stepper is wrong, and how often, to be a law not kept."""


def _of_steps(bug: Bug, case: Case) -> Seen:
    """Of a stepper: how many impulses are others than its parent's law gives at the same places and velocities."""
    scene = scene_of(case.name)
    law, right = bug.engine.law(), bug.parent.law()
    fresh = right.world(scene)
    pristine = {key: getattr(fresh, key) for key in ("r", "m", "w", "walls", "sides")}
    wrong: list[float] = []

    class Watched(type(law)):
        """The law, each of whose impulses is held against the honest one."""

        def collide(self, w: World, n: Any, i: int, j: int) -> None:
            twin = w.copied()
            vars(twin).update(pristine)
            super().collide(w, n, i, j)
            before = [(twin.vx[k], twin.vy[k]) for k in (i, j) if k < w.n]
            right.collide(twin, n, i, j)
            speed = sum(abs(vx) + abs(vy) for vx, vy in before)
            off = max(abs(w.vx[k] - twin.vx[k]) + abs(w.vy[k] - twin.vy[k]) for k in (i, j) if k < w.n)
            wrong.append(off / speed if speed else 0.0)

    engine = type("Watching", (type(bug.engine),), {"law": lambda self: Watched()})()
    try:
        run = engine.run(scene, **case.span(engine))
    except Exception as error:
        return Seen(BETWEEN, 0.0, -1, f"raises {type(error).__name__}")
    strong = sum(off > STRONG for off in wrong)
    if bug.engine.law is not bug.parent.law and type(bug.engine).__dict__.get("move") is not None:
        strong = len(run.events)  # its flights are wrong, all of them
    kind = VISIBLE if strong >= OFTEN else BETWEEN if any(wrong) or strong else INVISIBLE
    return Seen(kind, float(strong), -1, "impulses")
