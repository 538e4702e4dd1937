"""Segments and polygons under gravity: against a referee in true coordinates, and what ends by name."""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Callable
from typing import Any

import pytest
from face_referee import FaceReferee, NotForThis, TieMet
from mpmath import mpf, workdps

from truebreak.exact import ExactEngine
from truebreak.exact.replay import state, wall_flights
from truebreak.exact.simulation import arc_meetings
from truebreak.scenarios import Circle, Polygon, Scene, SceneError, Segment, Wall
from truebreak.scenarios.trajectory import StopReason

FLOOR = Wall(0, -4, 1, -4, id="floor")
SIDES = [Wall(-6, 0, -6, 1, id="left"), Wall(6, 0, 6, 1, id="right")]
DART = [(0, 0), (2, -1), ("1/2", "1/4"), (1, 2)]
BOX = [(0, 0), (2, 0), (2, 1), (0, 1)]
TRIANGLE = [(0, 0), (3, 0), (0, "3/2")]


def drawn(seed: int) -> Scene:
    """One to three discs or points, segments, polygons, fixed discs, walls."""
    rng = random.Random(seed)

    def some(low: int, high: int, parts: int = 100) -> str:
        return f"{rng.randint(low * parts, high * parts)}/{parts}"

    def radius() -> str:
        return rng.choice(["1/2", "1/4", "3/10", "sqrt(2)/4"])

    while True:
        circles = [
            Circle(some(-4, 4), some(1, 8), radius(), some(-4, 4), some(-4, 4), rng.choice([1, 2, "1/3"]), id=f"b{k}")
            for k in range(rng.randint(1, 3))
        ]
        if rng.random() < 0.15:
            circles.append(Circle(some(-4, 4), some(1, 8), "0", some(-4, 4), some(-4, 4), point=True, id="point"))
        circles += [Circle(some(-4, 4), some(-3, 5), radius(), m="oo", id=f"p{k}") for k in range(rng.randint(0, 2))]
        parts = rng.choice([100, 100, 2, 1])
        segments: list[Segment] = []
        for k in range(rng.randint(1, 4)):
            x, y = some(-5, 5, parts), some(-3, 5, parts)
            if segments and rng.random() < 0.4:
                x, y = segments[-1].x1.text(), segments[-1].y1.text()
            way = rng.choice(["free", "level", "upright"])
            end = (x if way == "upright" else some(-5, 5, parts)), (y if way == "level" else some(-3, 5, parts))
            try:
                segments.append(Segment(x, y, *end, r=rng.choice(["0", "0", "1/10", "1/3"]), id=f"s{k}"))
            except SceneError:
                continue
        polygons: list[Polygon] = []
        for k in range(rng.randint(0, 2)):
            x, y, corners = rng.randint(-4, 3), rng.randint(-3, 4), rng.choice([DART, BOX, TRIANGLE])
            turned = rng.random() < 0.5
            points = [(f"{x}-({b})", f"{y}+({a})") if turned else (f"{x}+({a})", f"{y}+({b})") for a, b in corners]
            polygons.append(Polygon(points, r=rng.choice(["0", "0", "1/5"]), id=f"g{k}"))
        walls = [*SIDES, FLOOR] if rng.random() < 0.8 else SIDES
        gravity = rng.choice([(0, -10), (0, "-981/100"), ("1/3", -4), ("sqrt(2)", -3)])
        try:
            return Scene(
                circles,
                walls,
                segments=segments,
                polygons=polygons,
                gravity=gravity,
                restitution=rng.choice([1, "9/10", "1/2"]),
            )
        except SceneError:
            continue


def differs(scene: Scene, events: int) -> str | None:
    """What is otherwise than the referee has it; empty where all is as it has it, None where it has nothing."""
    run = ExactEngine(max_bits=2000, work=1_000_000).run(scene, events=events)
    count = len(run.events)
    quiet = run.stop.reason is StopReason.QUIET
    try:
        course = FaceReferee(scene).run(mpf(10) ** 9, count + quiet)
    except (TieMet, NotForThis):
        return None
    with workdps(60):
        if len(course.hits) != count:
            return "number of events"
        for k, (hit, event) in enumerate(zip(course.hits, run.events, strict=True)):
            if sorted(sorted((c.first, c.second)) for c in event.contacts) != [sorted(hit.pair)]:
                return f"who meets at event {k}"
            if abs(mpf(event.time.digits(40)) - hit.time) > mpf(10) ** -30 * (1 + hit.time):
                return f"time of event {k}"
        if run.events and not quiet:
            at = run.at(run.events[-1].time)
            for body, circle in zip(course.bodies, [c for c in scene.circles if not c.fixed], strict=True):
                mine = at[str(circle.id)]
                theirs = (body.x, body.y, body.vx, body.vy)
                for own, other in zip((mine.x, mine.y, mine.vx, mine.vy), theirs, strict=True):
                    if abs(mpf(own.digits(40)) - other) > mpf(10) ** -25 * (1 + abs(other)):
                        return f"state of {circle.id}"
    return ""
