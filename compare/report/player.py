"""The player of a report: what it is given, and the same as a widget for notebooks."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from importlib import resources
from typing import TYPE_CHECKING, Any

from ...scenarios.errors import SceneError
from ...scenarios.pictures import DrawnDisc, arc_line, polygon_outline, segment_line, view_of, wall_line
from ...scenarios.trajectory import StopReason
from ..alignment.align import rows_of
from ..picture import instant_of, names_of, pulls
from .charts import COASTING, errors_shown, predictions
from .sentences import headline
from .terminal import later

if TYPE_CHECKING:
    from ...scenarios.scene import Scene
    from ...scenarios.things import Polygon, Segment, Wall
    from ...scenarios.trajectory import Event, Trajectory
    from ..alignment.instants import Divergence
    from ..candidate import Candidate
    from ..chaos.foreseen import Foreseen
    from ..comparison import Comparison

MOST_EVENTS = 2_400
"""Events of all runs together that a page carries: at some 180 bytes each they leave it well under 1 MB."""

MOST_STATES = 100_000
"""States, of circles times events, that are computed for one run: a second or two of the exact engine's time."""

BEFORE = 0.75
"""Share of the events shown that lies before the first divergence, where not all can be shown."""

NONE = -1
"""Where an event of the first run is none of another."""

VIEW_REACH = 1.5
"""How far the view follows circles that leave, in sizes of the scene at the start, on each side."""

JUMP = 1e-6
"""Share of the scene's size by which a place must differ from straight flight to be told anew: below what one sees."""

DIGITS = 7
"""Digits of velocities, and of places in the scene's size: finer than `JUMP`."""


@dataclass(frozen=True)
class Played:
    """A run that is shown beside the first.

    Attributes:
        number: its style's place among the engines.
        name: what it is called.
        run: its trajectory.
        told: what else the player tells of it, as far as there is such: `verdict`, `errors`, `scale`, `growth`,
            `divergence`, and `stopped`, when it ended without an answer.
        parted: when it leaves the first run; None if it does not.
        pairs: for events of the first run, which of its events they are; None where that is not asked.
    """

    number: int
    name: str
    run: Trajectory
    told: Mapping[str, Any]
    parted: float | None = None
    pairs: Mapping[int, int] | None = None


def recording(comparison: Comparison, foreseen: Foreseen | None = None) -> dict[str, Any] | None:
    """The runs of a comparison as plain data for the player; None where there is nothing to play.

    Args:
        foreseen: when each engine is predicted to diverge.
    """
    shown = [(k, c) for k, c in enumerate(comparison.candidates) if not c.unable and c.trajectory.scene.circles]
    if not shown:
        return None
    bands = {band.number: [band.low, band.high] for band in predictions(comparison, foreseen)}
    others = [
        Played(
            number,
            c.engine,
            c.trajectory,
            _told(comparison, c, bands.get(number)),
            _parted(c.alignment.divergence),
            _pairs(c),
        )
        for number, c in shown
    ]
    lead = next((k for k, (_, c) in enumerate(shown, 1) if c is headline(comparison)), 1)
    name = comparison.reference.engine
    title = f"{name} (reference)"
    return played(comparison.scene, comparison.reference, others, name=name, title=title, lead=lead)


def played(
    scene: Scene, first: Trajectory, others: Sequence[Played], *, name: str, title: str, lead: int = 1
) -> dict[str, Any] | None:
    """Runs of one scene as plain data for the player; None where there is nothing to play.

    Args:
        first: the run in the left pane, with its name, and the title of its pane.
        others: those that can be shown in the right pane, if any; `lead` is the place of the one shown at the start.

    Returns:
        `bodies` (id, radius, whether fixed), `walls`, `pockets`, `view`, `begin` and `end` of the clock, `total` events
        of the first run, `lead`, and `runs`, the first one first. A run has `times`, the instants at which anything
        changes; `knots`, [place in `times`, body, x, y, vx, vy], from the start on; under gravity `still`, the places
        of those from which on nothing falls: a wall carries it, or it is out of play; `slides`, [place, x, y] of those
        from which on one slides down a slope, with what there is of gravity along it; `events`, [index, time, pairs],
        and how much later than the one before, where a double does not tell; `matches`, for each event of the first
        run, which of its own that is, -1 for none.
    """
    if not float(first.final_time) > 0 or not scene.circles:
        return None
    count = max(1, min(MOST_EVENTS // (len(others) + 1), MOST_STATES // len(scene.circles)))
    begin, end = _window(first, [other.parted for other in others if other.parted is not None], count)
    truth = _run(first, begin, end, count)
    runs = [{**truth, "name": name, "title": title, "number": None}]
    for other in others:
        pairs = other.pairs or {}
        matches = [pairs.get(event.index, NONE) for event in first.events if begin <= float(event.time) <= truth["end"]]
        run = _run(other.run, begin, end, count, {*matches})
        runs.append({**run, "name": other.name, "title": other.name, "number": other.number, **other.told})
        if other.pairs is not None:
            runs[-1]["matches"] = matches
    return {
        "bodies": [[str(c.id), float(c.r), c.fixed] for c in scene.circles],
        "walls": [[*wall_line(w), str(w.id), *_pace(w)] for w in scene.walls],
        "pockets": [[float(p.x), float(p.y), float(p.r)] for p in scene.pockets],
        **({"segments": [(*segment_line(s), *_pace(s)) for s in scene.segments]} if scene.segments else {}),
        **({"arcs": [arc_line(a) for a in scene.arcs]} if scene.arcs else {}),
        **({"polygons": [(*polygon_outline(p), *_pace(p)) for p in scene.polygons]} if scene.polygons else {}),
        **({"gravity": [*map(float, scene.gravity)]} if scene.gravity is not None else {}),
        "view": _view(scene, _passed(scene, truth)),
        "begin": begin,
        "end": end,
        "total": len(first.events),
        "lead": lead,
        "runs": runs,
    }


def _parted(divergence: Divergence | None) -> float | None:
    return None if divergence is None else divergence.time


def _window(reference: Trajectory, parted: list[float], count: int) -> tuple[float, float]:
    """The times shown: all, or as many events as fit, most of them before the first divergence."""
    times = [float(event.time) for event in reference.events]
    end = float(reference.final_time)
    if reference.stop.reason is StopReason.QUIET:
        end *= 1 + COASTING
    if len(times) <= count:
        return 0.0, end
    first = min(parted, default=0.0)
    place = next((k for k, time in enumerate(times) if time >= first), len(times))
    start = min(max(0, place - int(BEFORE * count)), len(times) - count)
    return (times[start - 1] if start else 0.0), times[start + count] if start + count < len(times) else end


def _run(run: Trajectory, begin: float, end: float, count: int, matched: Collection[int] = ()) -> dict[str, Any]:
    """One run between two times, and those of its events a little later that the other has before."""
    last = end if run.stop.reason is StopReason.QUIET else min(end, float(run.final_time))
    inside = [e for e in run.events if begin <= (time := float(e.time)) and (time <= last or e.index in matched)]
    events = inside[:count]
    if len(inside) > count:
        last = min(last, float(inside[count].time))
    others = [mark.time for mark in (*run.pocketings, *run.settlings, *([run.reversal] if run.reversal else ()))]
    marks = {min(float(event.time), last) for event in events} | {t for t in map(float, others) if begin <= t <= last}
    times = sorted({begin, *marks})
    knots, still, slides = _knots(run, times, last)
    return {
        "times": times,
        "knots": knots,
        **({"still": still} if still else {}),
        **({"slides": slides} if slides else {}),
        "events": [_event(e, before) for e, before in zip(events, [None, *events], strict=False)],
        "end": last,
        "stop": run.stop.message,
    }


def _event(event: Event, before: Event | None) -> list[Any]:
    """Its index, time and pairs; and, where its time is the same double as that of the one before, how much later."""
    row: list[Any] = [event.index, float(event.time), [list(pair) for pair in event.impulses]]
    if before is not None and float(before.time) == row[1]:
        row.append(later(before, event))
    return row


def _knots(
    run: Trajectory, times: list[float], last: float
) -> tuple[list[list[float]], list[int], list[tuple[float, ...]]]:
    """Place and velocity of each circle from each time on, where they change; taken from the middle of each flight.

    With the places of the knots from which on a circle does not fall, where others do, and of those from which on it
    slides.
    """
    final = float(run.final_time)
    middles = [min(a + (b - a) / 2, final) for a, b in zip(times, [*times[1:], last], strict=True)]
    flights = [(k, a, m) for k, (a, m) in enumerate(zip(times, middles, strict=True)) if m > a]
    knots: list[list[float]] = []
    known: dict[int, tuple[float, ...]] = {}
    rows = [*rows_of(run, [middle for _, _, middle in flights])] if flights else []
    if last > final or not flights:  # what follows the last event: the state that it leaves
        flights.append((len(times) - 1, times[-1], max(final, times[-1])))
        rows.append(run.final.rows())
    size = _size(run.scene, rows)
    room, decimals = JUMP * size, DIGITS - math.floor(math.log10(size))
    gravities = _gravities(run.scene)
    now, still, slides = gravities, list[int](), list[tuple[float, ...]]()
    for (k, begin, middle), row in zip(flights, rows, strict=True):
        before, now = now, pulls(run, middle) if run.scene.gravity is not None else now
        for i, ((x, y, vx, vy), gravity) in enumerate(zip(row, now, strict=True)):
            same = gravity == before[i]
            if i in known and same and _follows(known[i], middle, (x, y, vx, vy), room, gravity):
                continue
            known[i] = (begin, *_flown((x, y, vx, vy), begin - middle, gravity))
            if gravity == (0.0, 0.0) != gravities[i]:
                still.append(len(knots))
            elif gravity != gravities[i]:
                slides.append((len(knots), *gravity))
            _, *place, vx, vy = known[i]
            knots.append(
                [k, i, *(round(value, decimals) for value in place), *(float(f"{v:.{DIGITS}g}") for v in (vx, vy))]
            )
    return knots, still, slides


def _size(scene: Scene, rows: Sequence[Sequence[Sequence[float]]]) -> float:
    """How far apart circles come to be, across or up, with the largest of them: wherever in the plane that is."""
    apart = [max(places) - min(places) for places in zip(*(state[:2] for row in rows for state in row), strict=True)]
    return max(*apart, *(2 * float(c.r) for c in scene.circles), 1e-300)


def _gravity(scene: Scene) -> tuple[float, float]:
    gx, gy = scene.gravity or (0, 0)
    return float(gx), float(gy)


def _gravities(scene: Scene) -> list[tuple[float, float]]:
    """What pulls each circle: nothing one that is fixed."""
    return [(0.0, 0.0) if circle.fixed else _gravity(scene) for circle in scene.circles]


def _flown(state: Sequence[float], since: float, gravity: tuple[float, float]) -> tuple[float, float, float, float]:
    """x, y, vx, vy of a flight so much later."""
    (x, y, vx, vy), (gx, gy) = state, gravity
    return (
        x + vx * since + gx * since * since / 2,
        y + vy * since + gy * since * since / 2,
        vx + gx * since,
        vy + gy * since,
    )


def _follows(
    knot: tuple[float, ...], time: float, state: tuple[float, ...], room: float, gravity: tuple[float, float]
) -> bool:
    """Whether a state is the flight from a knot: under gravity, whose velocities are rounded, by its place alone."""
    begin, *start = knot
    x, y, vx, vy = _flown(start, time - begin, gravity)
    same = (
        (vx, vy) == state[2:]
        if gravity == (0.0, 0.0)
        else math.isclose(vx, state[2], abs_tol=room) and math.isclose(vy, state[3], abs_tol=room)
    )
    return same and math.hypot(x - state[0], y - state[1]) <= room


PIECES = 8
"""Places of each flight under gravity by which it is told how far to look."""


def _pace(thing: Wall | Segment | Polygon) -> tuple[float, ...]:
    """The velocity of what moves."""
    return (float(thing.vx), float(thing.vy)) if thing.moves else ()


def _passed(scene: Scene, run: Mapping[str, Any]) -> list[list[float]]:
    """The knots of a run; under gravity with places on the way from each to the end of its flight."""
    gravities, knots, times = _gravities(scene), run["knots"], run["times"]
    if _gravity(scene) == (0.0, 0.0):
        return knots
    ends, slides = [*times[1:], run["end"]], {n: (x, y) for n, x, y in run.get("slides", ())}
    bent = dict.fromkeys(run.get("still", ()), (0.0, 0.0)) | slides
    bends = [bent.get(n, gravities[int(i)]) for n, (_, i, *_) in enumerate(knots)]
    return [
        [k, i, *_flown(state, (ends[int(k)] - times[int(k)]) * piece / PIECES, pull)]
        for (k, i, *state), pull in zip(knots, bends, strict=True)
        for piece in range(PIECES + 1)
    ]


def _told(comparison: Comparison, candidate: Candidate, predicted: list[float] | None) -> dict[str, Any]:
    """What else is told of an engine: its error, and where it leaves the reference, or was to be expected to."""
    scene = comparison.scene
    places = {str(c.id): k for k, c in enumerate(scene.circles)}
    separation, divergence = errors_shown(comparison, candidate), candidate.alignment.divergence
    told: dict[str, Any] = {
        "errors": [
            [float(f"{t:.9g}"), float(f"{e:.4g}") if math.isfinite(e) else None]
            for t, e in zip(separation.times, separation.largest, strict=True)
        ],
        "scale": separation.scale or 1.0,
        "predicted": predicted,
        "divergence": None,
        "verdict": candidate.verdict,
    }
    if candidate.verdict in ("undecided", "unsettled"):
        told["stopped"] = float(candidate.trajectory.final_time)
    if divergence is not None:
        names = names_of((divergence.body, divergence.expected, divergence.got))
        told["divergence"] = {
            "time": instant_of(divergence),
            "expected": divergence.expected_event if divergence.expected is not None else None,
            "got": divergence.candidate_event,
            "bodies": [places[name] for name in names if name in places],
            "walls": [k for k, wall in enumerate(scene.walls) if wall.id in names],
        }
    return told


def _pairs(candidate: Candidate) -> dict[int, int]:
    """For events of the reference, the engine's event that it is. The two of the divergence stand in one row."""
    known: dict[int, int] = {}
    for walk in candidate.alignment.walks.values():
        for mine, theirs in walk.pairs:
            known.setdefault(mine, theirs)
    parted = candidate.alignment.divergence
    if parted is not None and parted.expected is not None and parted.candidate_event is not None:
        known[parted.expected_event] = parted.candidate_event
    return known


def _view(scene: Scene, knots: list[list[float]]) -> list[float]:
    """Left, bottom, width and height of what is shown: where circles go, as far as they stay near."""
    start = view_of([_disc(i, float(c.x), float(c.y), scene) for i, c in enumerate(scene.circles)], scene)
    reach = VIEW_REACH * max(start.width, start.height)
    left, right = start.left - reach, start.left + start.width + reach
    bottom, top = start.bottom - reach, start.bottom + start.height + reach
    places: dict[int, list[tuple[float, float]]] = {}
    for _, i, x, y, _, _ in knots:
        places.setdefault(int(i), []).append((min(max(x, left), right), min(max(y, bottom), top)))
    went = [_disc(i, float(c.x), float(c.y), scene) for i, c in enumerate(scene.circles)]
    for i, row in places.items():
        xs, ys = zip(*row, strict=True)
        went += [_disc(i, x, y, scene) for x in (min(xs), max(xs)) for y in (min(ys), max(ys))]
    view = view_of(went, scene)
    return [view.left, view.bottom, view.width, view.height]


def _disc(i: int, x: float, y: float, scene: Scene) -> DrawnDisc:
    return DrawnDisc("", x, y, float(scene.circles[i].r), 0.0, 0.0, "")


# ----------------------------------------
# The player of a report as a widget for notebooks (`anywidget`; the extra `notebook`).

HEIGHT = 860
"""Pixels: the player with its lists, at the width of a notebook's cell."""


def player(comparison: Comparison, *, height: int = HEIGHT) -> Any:
    """A widget that plays a comparison: reference and engine side by side on one clock.

    Its `time`, in the scene's units, can be read and set, and follows the player; `height` is in pixels.

    Raises:
        ImportError: without anywidget, with the remedy.
        SceneError: for a comparison in which there is nothing to play, and for a height below 1.

    >>> from truebreak.compare import compare
    >>> from truebreak.scenarios import catalogue
    >>> shown = player(compare(catalogue.build("lee"), ["double"]))
    >>> shown.time, shown.height
    (0.0, 860)
    """
    if height < 1:
        raise SceneError(f"height = {height}: must be a whole number from 1")
    return _widget_class()(page=player_page(comparison), height=height)


def player_page(comparison: Comparison) -> str:
    """The page of the player alone, which tells the page around it its time, and takes one from there.

    Raises:
        SceneError: for a comparison in which there is nothing to play.
    """
    from .page import (  # here, since a page that is filled in a browser needs no templates
        COMPARED,
        provenance,
        rendered,
    )

    data = recording(comparison)
    if data is None:
        raise SceneError(f"{comparison.scene.name!r}: there is nothing to play; compare over a longer span")
    return rendered(
        "widget.html.jinja",
        recording={**data, "embedded": True},
        engines=[candidate.engine for candidate in comparison.candidates],
        title=f"{comparison.scene.name}: player",
        provenance=provenance(comparison),
        player=COMPARED,
        footnote="Solid and blue: the reference.",
    )


@cache
def _widget_class() -> Any:
    try:
        import anywidget
        import traitlets
    except ImportError:
        raise ImportError(
            "the player in a notebook needs anywidget, which is not installed: pip install '.[notebook]'"
        ) from None

    class Player(anywidget.AnyWidget):
        """The player; `page` is its document."""

        _esm = resources.files(__package__ or "").joinpath("templates", "widget.js").read_text("utf-8")
        page = traitlets.Unicode().tag(sync=True)
        time = traitlets.Float(0.0).tag(sync=True)
        height = traitlets.Int(HEIGHT).tag(sync=True)

    return Player
