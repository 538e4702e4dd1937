"""Runs in doubles on flat flights are those of the general loop, to the last bit, and of the formulas as called."""

from __future__ import annotations

import pickle
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType
from typing import Any

import pytest
from joint_scenes import scene_of as joints
from polygon_scenes import scene_of as polygons
from segment_scenes import scene_of as segments

from truebreak.floating import DoubleEngine
from truebreak.floating.flat import flat_loop, flat_meetings, flying
from truebreak.floating.flat.flat_loop import follows
from truebreak.floating.plain import EventEngine
from truebreak.scenarios import Circle, Polygon, Scene, Segment, Trajectory, Wall, catalogue
from truebreak.scenarios.errors import TimeIsUp
from truebreak.scenarios.trajectory import StopReason


def box(width: int, height: int) -> list[Wall]:
    return [Wall(0, 0, 0, 1), Wall(width, 0, width, 1), Wall(0, 0, 1, 0), Wall(0, height, 1, height)]


def lattice(columns: int, rows: int, **more: Any) -> Scene:
    """Many instants of several contacts."""
    circles = [
        Circle(3 * i + 2, 3 * j + 2, vx=(7 * i + j) % 5 - 2, vy=(i + 3 * j) % 5 - 2)
        for i in range(columns)
        for j in range(rows)
    ]
    return Scene(circles, box(3 * columns + 4, 3 * rows + 3), **more)


def at_rest(columns: int, rows: int) -> Scene:
    """One that flies into many that do not."""
    circles = [Circle(3 * i + 2, 3 * j + 2) for i in range(columns) for j in range(rows)]
    return Scene([*circles, Circle(2, 3 * rows + 4, vx="1/3", vy=-2)], box(3 * columns + 9, 3 * rows + 9))


def named(text: str, **limits: Any) -> Callable[[], tuple[Scene, dict[str, Any]]]:
    return lambda: (catalogue.build(text), limits)


def made(make: Callable[[], Scene], **limits: Any) -> Callable[[], tuple[Scene, dict[str, Any]]]:
    return lambda: (make(), limits)


def turned(text: str, **when: Any) -> Callable[[], tuple[Scene, dict[str, Any]]]:
    return lambda: (catalogue.build(text).with_changes(until=None, events=None, **when), {})


OBLIQUE = [Wall(-5, 0, 0, -7), Wall(0, -7, 9, 0), Wall(9, 0, 1, 9), Wall(1, 9, -5, 0)]
LINE = [Circle(0, 0, vx=1), Circle(4, 0)]
SIDES = [Wall(9, 0, 9, 1), Wall(-2, 0, -2, 1)]
FAR = [Wall(20, 0, 20, 1), Wall(-5, 0, -5, 1)]
ROW = [*(Circle(2 * i + 5, 5) for i in range(6)), Circle(1, 5, vx=2)]
SLIDING = [Circle(1, 1, vx=1), Circle(7, 1, vx=-1), Circle(4, 5, vy=-1)]
FIXED = [Circle(5, 5, 2, m="oo"), Circle(1, 1, vx=2, vy=1), Circle(9, 2, vy=2)]
ROOTS = [Circle("sqrt(2)", "sqrt(3)", 1, "sqrt(5)", 1), Circle(7, "sqrt(7)", vx=-1)]
POINTS = [Circle(1, 1, 0, 2, 1, point=True), Circle(5, 5, 0, -1, 1, point=True), Circle(3, 6, vx=1)]
PASSING = [Circle(0, 0, vx=1), Circle(5, 2)]
HUGE = [Circle("10**150", 0, "10**149", "-10**150"), Circle("-10**150", "10**148", "10**149", "10**150", 1)]

BARS = [Segment(3, 5, 4, 9), Segment(11, 4, 14, "11/2", r="1/4"), Segment(13, 14, "33/2", "29/2")]
SPARSE = [Segment(*at) for at in [
    (32, 2, 33, 3), (15, 38, 15, 39), (25, 44, 25, 45), (2, 34, 2, 35), (32, 36, 32, 37), (19, 2, 20, 2),
]]  # fmt: skip
BLOCK = [Polygon([(8, 14), (10, 14), ("19/2", 15), (10, 17)], id="block")]


def among(text: str, **more: Any) -> Callable[[], tuple[Scene, dict[str, Any]]]:
    """A gas, with segments in it."""
    return lambda: (catalogue.build(text).with_changes(segments=BARS, until=None, events=None), more)


def fence(columns: int, **more: Any) -> Scene:
    """Many discs on a grid, among segments of which some are along their flights: what slides, and many ties."""
    circles = [
        Circle(3 * i + 2, 3 * j + 2, vx=(7 * i + j) % 3 - 1, vy=(i + 3 * j) % 3 - 1)
        for i in range(columns)
        for j in range(columns)
    ]
    bars = [Segment(f"{6 * i} + 7/2", 6 * j + 1, f"{6 * i} + 7/2", 6 * j + 3) for i in range(2) for j in range(2)]
    floor = Segment(1, "1/2", 9, "1/2", r="1/2", id="floor")
    return Scene(circles, box(3 * columns + 4, 3 * columns + 3), segments=[*bars, floor], **more)


SCENES: dict[str, Callable[[], tuple[Scene, dict[str, Any]]]] = {
    "gas": named("gas:n=10", events=600),
    "mixed": named("gas:n=20,seed=3,mixed=yes", events=200),
    "until": named("gas:n=10", until="7/2"),
    "crowd": named("gas:n=70,seed=3", events=200),
    "mixed crowd": named("gas:n=70,seed=4,mixed=yes", events=200),
    "galperin": named("galperin:n=2", events=400),
    "cradle": named("cradle", events=60),
    "tied rack": made(lambda: catalogue.build("rack:rows=4,gap=0").with_changes(pockets=[]), events=60),
    "inscribed": named("inscribed", events=60),
    "near tie": named("near-tie"),
    "lorentz": named("lorentz", events=60),
    "pinball": named("pinball"),
    "tennis": named("tennis", events=80),
    "lee": named("lee"),
    "point": named("point", events=60),
    "sizes": named("sizes", events=60),
    "corner": named("corner", events=60),
    "lattice": made(lambda: lattice(5, 4), events=200),
    "lattice in order": made(lambda: lattice(5, 4, tie_policy="sequential"), events=120),
    "lattice at random": made(lambda: lattice(5, 4, tie_policy="sequential:seed=5"), events=120),
    "lattice crowd": made(lambda: lattice(10, 7), events=120),
    "at rest": made(lambda: at_rest(3, 3), events=200),
    "crowd at rest": made(lambda: at_rest(9, 8), events=200),
    "touching": made(lambda: Scene(ROW, box(30, 10)), events=60),
    "sliding": made(lambda: Scene(SLIDING, box(20, 10)), events=60),
    "fixed": made(lambda: Scene(FIXED, box(12, 10)), events=120),
    "oblique": made(lambda: Scene([Circle(0, 0, 1, 2, 1), Circle(3, 1, 1, -1, 1)], OBLIQUE), events=120),
    "irrational": made(lambda: Scene(ROOTS, box(12, 9)), events=120),
    "points": made(lambda: Scene(POINTS, box(10, 9)), events=60),
    "graze": made(lambda: Scene([*PASSING, Circle(12, 0)], FAR), events=30),
    "graze and tie": made(lambda: Scene([*PASSING, Circle(7, 0)], FAR), events=30),
    "at the limit": made(lambda: Scene(LINE, SIDES), until=2),
    "just before": made(lambda: Scene(LINE, SIDES), until="2 - 1/10**30"),
    "just after": made(lambda: Scene(LINE, SIDES), until="2 + 1/10**30"),
    "there and back": turned("gas:n=6", reverse_after=30),
    "turned at a time": turned("gas:n=6", reverse_at=2),
    "turned at a hit": made(lambda: Scene(LINE, SIDES, reverse_at=2)),
    "crowd there and back": turned("gas:n=70,seed=2", reverse_after=40),
    "one": made(lambda: Scene([Circle(3, 3, vx=1, vy="1/3")], box(10, 10)), events=50),
    "nothing": made(lambda: Scene([Circle(0, 0, vx=-1), Circle(5, 0, vx=1)])),
    "huge": made(lambda: Scene(HUGE), events=9),
    "segments": among("gas:n=10", events=600),
    "segments in a crowd": made(lambda: catalogue.build("gas:n=70,seed=3").with_changes(segments=SPARSE), events=300),
    "polygons": made(
        lambda: Scene([Circle(3, 3, vx=1, vy="1/3"), Circle(9, 9, vx=-1, vy="2/7")], box(20, 20), polygons=BLOCK),
        events=200,
    ),
    "segments with loss": made(
        lambda: Scene([Circle(3, 12, vx=3, vy=-2)], box(18, 18), segments=BARS, restitution="9/10"), events=60
    ),
    "segments there and back": made(
        lambda: Scene(
            [Circle(6, 12, vx=3, vy=-2), Circle(9, 2, vy=1, vx="1/9")], box(18, 18), segments=BARS, reverse_after=30
        )
    ),
    "a point among segments": made(
        lambda: Scene([Circle(6, 12, r=0, vx=3, vy="-19/10", point=True)], box(18, 18), segments=BARS), events=200
    ),
    "fence": made(lambda: fence(4), events=200),
    "fence of a crowd": made(lambda: fence(9), events=200),
}


def general(scene: Scene, **limits: Any) -> Trajectory:
    """The run of the general loop."""
    return EventEngine.run_with(DoubleEngine(), scene, None, **limits)


def told(run: Trajectory) -> list[Any]:
    """All that a run says, to the last bit."""
    return [
        [(e.index, float(e.time).hex(), e.contacts, e.impulses, e.ties, e.coupled) for e in run.events],
        [[tuple(number.hex() for number in knot) for knot in row] for row in run.motion.knots],
        [tuple(float(q).hex() for q in (c.x, c.y, c.vx, c.vy)) for c in run.final.circles],
        (float(run.final_time).hex(), run.stop, run.reversal, run.pocketings, run.plan),
    ]


@pytest.mark.parametrize("name", SCENES)
def test_a_flat_run_is_the_general_one(name: str) -> None:
    scene, limits = SCENES[name]()
    assert follows(scene, None)
    assert told(DoubleEngine().run(scene, **limits)) == told(general(scene, **limits))


@pytest.mark.parametrize("kind", [segments, polygons, joints])
def test_flat_runs_among_edges_are_the_general_ones(kind: Callable[[int], Scene | None]) -> None:
    """Of scenes made to meet ends, joints and corners, to slide, and to hit much at once."""
    events = 0
    for seed in range(400, 470):
        scene = kind(seed)
        if scene is not None:
            assert follows(scene, None)
            run = DoubleEngine().run(scene, until=40, events=40)
            assert told(run) == told(general(scene, until=40, events=40)), seed
            events += len(run.events)
    assert events > 300


def test_what_is_not_flat() -> None:
    scene = catalogue.build("rack:rows=3")
    assert scene.pockets
    assert not follows(scene, None)


AMONG = ["segments", "segments in a crowd", "polygons", "fence", "a point among segments"]


@pytest.mark.parametrize(
    "name", ["gas", "mixed crowd", "fixed", "oblique", "lattice", "sliding", "graze", "huge", *AMONG]
)
def test_the_formulas_in_python_give_the_same(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    scene, limits = SCENES[name]()
    run = DoubleEngine().run(scene, **limits)
    for module in (flat_meetings, flat_loop):
        for function in ("walls", "pairs", "strike", "rebound"):
            if hasattr(module, function):
                monkeypatch.setattr(module, function, getattr(flying, function))
    assert told(DoubleEngine().run(scene, **limits)) == told(run)


def test_most_instants_of_a_gas_are_ordinary(monkeypatch: pytest.MonkeyPatch) -> None:
    """So the general loop resolves but few: none, after that at time 0, where nothing falls together."""
    assert _resolved(monkeypatch, catalogue.build("gas:n=10")) == 1


def test_most_instants_among_segments_are_ordinary(monkeypatch: pytest.MonkeyPatch) -> None:
    scene, _ = SCENES["segments"]()
    assert _resolved(monkeypatch, scene) == 1


def _resolved(monkeypatch: pytest.MonkeyPatch, scene: Scene) -> int:
    """How many instants of 600 the general loop resolves."""
    resolved: list[object] = []
    from truebreak.exact.simulation.instant import Resolver

    resolve = Resolver.resolve
    monkeypatch.setattr(Resolver, "resolve", lambda self, *given: resolved.append(self) or resolve(self, *given))
    assert len(DoubleEngine().run(scene, events=600).events) == 600
    return len(resolved)


def test_a_run_pickles_read_or_not() -> None:
    scene, limits = SCENES["lattice"]()
    run = DoubleEngine().run(scene, **limits)
    again = pickle.loads(pickle.dumps(run))
    assert told(again) == told(run)
    assert isinstance(again.events, tuple)
    assert again.events == run.events == tuple(run.events)


FLAT = str(Path(flat_loop.__file__).parent)


@contextmanager
def ended_at(line: int, error: BaseException) -> Iterator[list[int]]:
    """Raises an error before so many lines of a stride have been run; counts them."""
    count = [0]

    def trace(frame: FrameType, event: str, _: Any) -> Any:
        if not frame.f_code.co_filename.startswith(FLAT) or not _in_stride(frame):
            return None
        if event == "line":
            count[0] += 1
            if count[0] == line:
                raise error
        return trace

    before = sys.gettrace()
    sys.settrace(trace)
    try:
        yield count
    finally:
        sys.settrace(before)


def _in_stride(frame: FrameType | None) -> bool:
    while frame is not None:
        if frame.f_code.co_filename == flat_loop.__file__ and frame.f_code.co_name == "__call__":
            return True
        frame = frame.f_back
    return False


@pytest.mark.parametrize("name", ["gas", "lattice", "crowd", "there and back", "crowd there and back"])
def test_a_stride_that_is_ended_anywhere_ends_at_a_whole_instant(name: str) -> None:
    scene, limits = SCENES[name]()
    if "events" in limits:
        limits = {"events": 60}
    with ended_at(0, KeyboardInterrupt()) as counted:
        whole = DoubleEngine().run(scene, **limits)
    assert counted[0] > 100
    knots = told(whole)[1]
    for k in range(24):
        error = TimeIsUp("enough") if k % 2 else KeyboardInterrupt()
        with ended_at(1 + counted[0] * k // 24 + k, error):
            part = DoubleEngine().run(scene, **limits)
        assert part.stop.reason is (StopReason.BUDGET if k % 2 else StopReason.INTERRUPTED)
        done = len(part.events)
        assert list(part.events) == list(whole.events[:done])
        assert part.reversal is None or part.reversal == whole.reversal
        last = [float(e.time) for e in part.events[-1:]]
        end = max([0.0, *last, *([] if part.reversal is None else [float(part.reversal.time)])])
        assert float(part.final_time) == end
        for mine, theirs in zip(told(part)[1], knots, strict=True):
            assert mine == theirs[: len(mine)]
            assert all(float.fromhex(knot[0]) <= end for knot in mine)
            assert all(float.fromhex(knot[0]) >= end for knot in theirs[len(mine) :])
