"""Scores engines, and queries of physics libraries, by vectors: false meetings, missed ones, errors of times, cost."""

from __future__ import annotations

import math
import time as clock
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

from ...scenarios.errors import SceneError
from ...scenarios.trajectory import OnProgress, Progress, StopReason
from ..foreign.guard import run_guarded
from .first_meetings import KINDS, THINGS, MeetingQuestion, Vector

if TYPE_CHECKING:
    from ...scenarios.engine import Engine

Query = Callable[[MeetingQuestion], "float | None"]
"""When the two first meet; None: never. Raises `SceneError` for a question that it cannot take."""


@dataclass(frozen=True)
class Score:
    """How one engine or query answers some vectors.

    Attributes:
        thing, kind: of `THINGS` and `KINDS`; "" for all.
        vectors: how many.
        meet: of how many the two meet.
        refused: how many it cannot take, or leaves undecided.
        false_hits: meetings that there are not.
        missed: meetings that it does not find.
        worst: the largest error of a time, as a share of the certified one (of one at 0: the time itself); None
            where it finds no true meeting.
        worst_at: the vector's place.
        microseconds: of processor time a query, the harness's own included.
    """

    thing: str
    kind: str
    vectors: int
    meet: int
    refused: int
    false_hits: int
    missed: int
    worst: float | None
    worst_at: int | None
    microseconds: float


def scores(vectors: Sequence[Vector], query: Query, progress: OnProgress | None = None) -> list[Score]:
    """How a query answers vectors: a score for each thing and kind, then one for all.

    >>> from .first_meetings import vectors
    >>> all_of = scores([*vectors(50)], lambda question: None)[-1]
    >>> all_of.missed == all_of.meet, all_of.false_hits, all_of.worst
    (True, 0, None)
    """
    rows: dict[tuple[str, str], list[tuple[int, Vector, float | None, bool]]] = {}
    spent: dict[tuple[str, str], float] = {}
    for place, vector in enumerate(vectors):
        key = vector.question.thing, vector.question.kind
        begun, refused, found = clock.process_time(), False, None
        try:
            found = query(vector.question)
        except SceneError:
            refused = True
        spent[key] = spent.get(key, 0.0) + clock.process_time() - begun
        rows.setdefault(key, []).append((place, vector, found, refused))
        if progress is not None:
            progress(Progress(place + 1, 0.0))
    order = [(thing, kind) for thing in THINGS for kind in KINDS if (thing, kind) in rows]
    each = [_score(*key, rows[key], spent[key]) for key in order]
    whole = [row for key in order for row in rows[key]]
    return [*each, _score("", "", whole, sum(spent.values()))] if whole else []


def _score(thing: str, kind: str, rows: Sequence[tuple[int, Vector, float | None, bool]], seconds: float) -> Score:
    worst, worst_at, false_hits, missed = None, None, 0, 0
    for place, vector, found, refused in rows:
        if refused:
            continue
        false_hits += found is not None and not vector.meets
        missed += found is None and vector.meets
        if found is not None and vector.meets:
            off = error_of(vector, found)
            if worst is None or not off < worst:
                worst, worst_at = off, place
    return Score(
        thing, kind, len(rows), sum(row[1].meets for row in rows), sum(row[3] for row in rows), false_hits, missed,
        worst, worst_at, 1e6 * seconds / len(rows),
    )  # fmt: skip


def error_of(vector: Vector, found: float) -> float:
    """By how much a time is off, as a share of the certified one; of a meeting at time 0, the time itself."""
    if not math.isfinite(found):
        return math.inf
    off = abs(Fraction(found) - Fraction(vector.time) - Fraction(vector.rest))
    return float(off / (Fraction(vector.time) + Fraction(vector.rest))) if vector.time else float(off)


def by_engine(engine: Engine) -> Query:
    """The first meeting by an engine's own run.

    Raises:
        SceneError: for an engine of time steps, which needs an end to run to: score its library's query instead.
    """
    if engine.step is not None:
        raise SceneError(
            f"engine {engine.name!r}: takes time steps, and a vector has no end to run to; leave it out, "
            f"or score a query: {', '.join(QUERIES)}"
        )

    def query(question: MeetingQuestion) -> float | None:
        try:
            run = run_guarded(engine, question.scene, until=None, events=1, progress=None)
        except (OverflowError, ZeroDivisionError) as error:
            raise SceneError(f"{type(error).__name__}: {error}") from None
        if run.stop.reason not in (StopReason.EVENTS, StopReason.QUIET):
            raise SceneError(run.stop.message)
        return float(run.events[0].time) if run.events else None

    return query


# -- queries of physics libraries: a disc cast along its relative flight


@dataclass(frozen=True)
class _Cast:
    """A disc's flight relative to the other, up to well past every place where the two may meet."""

    x: float
    y: float
    to_x: float
    to_y: float
    time: float

    @staticmethod
    def of(question: MeetingQuestion) -> _Cast:
        if question.thing == "arc":
            raise SceneError("physics libraries have no arcs")
        x, y, r, vx, vy = question.disc
        if question.thing == "disc":
            vx, vy = vx - question.other[3], vy - question.other[4]
            far = math.hypot(question.other[0] - x, question.other[1] - y) + question.other[2]
        else:
            x0, y0, x1, y1, thick = question.other[:5]
            far = max(math.hypot(x0 - x, y0 - y), math.hypot(x1 - x, y1 - y)) + thick
        speed = math.hypot(vx, vy)
        time = 2 * (far + r) / speed if speed else 1.0
        if question.thing == "wall":  # a line goes on, and a slow approach takes long
            x0, y0, x1, y1 = question.other[:4]
            length = math.hypot(x1 - x0, y1 - y0)
            across = abs((x1 - x0) * vy - (y1 - y0) * vx) / length
            gap = abs((x1 - x0) * (y - y0) - (y1 - y0) * (x - x0)) / length
            time = max(time, 2 * gap / across) if across else time
        return _Cast(x, y, x + vx * time, y + vy * time, time)


def _line(question: MeetingQuestion, cast: _Cast) -> tuple[tuple[float, float], tuple[float, float]]:
    """The two points of a segment; of a wall, two far beyond the flight."""
    x0, y0, x1, y1 = question.other[:4]
    if question.thing == "segment":
        return (x0, y0), (x1, y1)
    length = math.hypot(x1 - x0, y1 - y0)
    far = 4 * (max(map(abs, (cast.x, cast.y, cast.to_x, cast.to_y, x0, y0, x1, y1))) + question.disc[2]) / length
    return (x0 - far * (x1 - x0), y0 - far * (y1 - y0)), (x1 + far * (x1 - x0), y1 + far * (y1 - y0))


def _pymunk_query() -> Query:
    """`pymunk.Space.segment_query_first`: a thick line from the start of a flight to its end."""
    import pymunk

    def query(question: MeetingQuestion) -> float | None:
        space: Any = pymunk.Space()
        cast = _Cast.of(question)
        if question.thing == "disc":
            x, y, r = question.other[:3]
            shape: Any = pymunk.Circle(space.static_body, r, (x, y))
        else:
            one, other = _line(question, cast)
            thick = question.other[4] if question.thing == "segment" else 0.0
            shape = pymunk.Segment(space.static_body, one, other, thick)
        space.add(shape)
        found: Any = space.segment_query_first(
            (cast.x, cast.y), (cast.to_x, cast.to_y), question.disc[2], pymunk.ShapeFilter()
        )
        return None if found is None else found.alpha * cast.time

    return query


def _box2d_query() -> Query:
    """Box2D's `b2TimeOfImpact`, in the singles that it has: to within its slop, which is a length."""
    import Box2D  # pyright: ignore[reportMissingImports]

    lib: Any = Box2D

    def query(question: MeetingQuestion) -> float | None:
        if question.thing == "segment" and question.other[4]:
            raise SceneError("Box2D's edges have no thickness")
        cast = _Cast.of(question)
        disc, at = question.thing == "disc", question.other[:2] if question.thing == "disc" else (0.0, 0.0)
        try:
            mine = lib.b2CircleShape(radius=question.disc[2])
            theirs = (
                lib.b2CircleShape(radius=question.other[2])
                if disc
                else lib.b2EdgeShape(vertices=[*_line(question, cast)])
            )
            still, flies = (
                lib.b2Sweep(c0=begin, c=end, a0=0.0, a=0.0, localCenter=(0, 0), alpha0=0.0)
                for begin, end in ((at, at), ((cast.x, cast.y), (cast.to_x, cast.to_y)))
            )
            state, alpha = lib.b2TimeOfImpact(
                shapeA=theirs, idxA=0, shapeB=mine, idxB=0, sweepA=still, sweepB=flies, tMax=1.0
            )
        except (OverflowError, AssertionError) as error:
            raise SceneError(f"{type(error).__name__}: {error}") from None
        return alpha * cast.time if state in (lib.b2TOIOutput.e_touching, lib.b2TOIOutput.e_overlapped) else None

    return query


QUERIES: Mapping[str, tuple[str, Callable[[], Query]]] = {
    "pymunk.segment_query": ("pymunk", _pymunk_query),
    "box2d.time_of_impact": ("Box2D", _box2d_query),
}
"""Queries by name, each with the module that it needs. A new one is its function and a line."""


def query_named(name: str) -> Query:
    """A query of `QUERIES`, or an engine's own run.

    Raises:
        SceneError: for a library that is not installed, and as `engine` for an unknown name.
    """
    if name in QUERIES:
        module, made = QUERIES[name]
        if find_spec(module) is None:
            raise SceneError(f"query {name!r}: needs {module}, which is not installed: pip install '.[engines]'")
        return made()
    from ..engines import engine

    return by_engine(engine(name))


def installed_queries() -> Iterable[str]:
    """The names of `QUERIES` whose library is installed."""
    return [name for name, (module, _) in QUERIES.items() if find_spec(module) is not None]
