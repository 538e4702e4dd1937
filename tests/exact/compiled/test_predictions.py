"""What is compiled against the Python that it stands for: the same bits, the same entries in the same places."""

from __future__ import annotations

from collections import Counter
from random import Random
from typing import Any

import pytest
from flint import arb

from truebreak.exact import ExactEngine
from truebreak.exact.certified import filtered as double_filter
from truebreak.exact.certified import filtered_arcs, filtered_falls
from truebreak.exact.certified.filtered import DoubleFilter, FilteredPredictor
from truebreak.exact.certified.filtered_arcs import FallenSide, side_in_doubles
from truebreak.exact.certified.filtered_falls import FloatFall, FloatPeg, falls_in_doubles, peg_in_doubles
from truebreak.exact.compiled import predictions
from truebreak.exact.replay import round_falls
from truebreak.exact.replay.contact import Body, Flight
from truebreak.exact.simulation import prediction as queue
from truebreak.exact.simulation.prediction import FloatLine
from truebreak.scenarios import Circle, Polygon, Scene, Segment, Wall
from truebreak.scenarios.catalogue import build

pytestmark = pytest.mark.skipif(predictions is None, reason="nothing is compiled here")

ROWS = 3_000
SCALES = [(1.0, 1.0), (1e3, 1e-3), (1e45, 1e45), (1e-45, 1e-45), (1e45, 1e-45), (1e-20, 1e30)]


def in_python(patch: pytest.MonkeyPatch) -> None:
    for place in (double_filter, filtered_arcs, filtered_falls, round_falls):
        patch.setattr(place, "predictions", None)
    patch.setattr(queue, "predictions", None)


def flight(rng: Random, place: float, speed: float, now: float) -> tuple[float, ...]:
    """Often on a grid or along an axis, so that zeros and equal numbers occur."""

    def number(scale: float) -> float:
        kind = rng.random()
        if kind < 0.1:
            return 0.0 if kind < 0.05 else -0.0
        return scale * (rng.randint(-8, 8) / 4 if kind < 0.3 else rng.uniform(-2.0, 2.0))

    late = rng.choice([0.0, 0.0, 1e-25, 1e-17]) * place / speed
    return number(place), number(place), number(speed), number(speed), now, late


def filtered(rng: Random, place: float, speed: float, partners: int) -> tuple[DoubleFilter, list[Body[arb]]]:
    """A filter, and bodies whose doubles it has seen; some have none."""
    now = place / speed * rng.choice([0.0, 1.0, 40.0])
    bodies = [Body(i, Flight(*[arb(0)] * 6), arb(1), arb(1)) for i in range(partners)]
    for body in bodies:
        body.f = flight(rng, place, speed, now * rng.choice([0.0, 0.5, 1.0, 1.0, 1.25]))
        body.kind = rng.randrange(3)
    found = DoubleFilter()
    found.largest = max(abs(x) for body in bodies for x in body.f[:2])
    found.fastest = max(abs(v) for body in bodies for v in body.f[2:4])
    found.latest = max(body.f[4] for body in bodies)
    if rng.random() < 0.2:
        rng.choice(bodies).f = None
    return found, bodies


def bits(told: tuple[list, list]) -> list:
    """Lists of numbers, signs of zeros and all, and bodies."""
    return [[part.hex() if isinstance(part, float) else part for part in entry] for entry in told[0]] + [told[1]]


@pytest.mark.parametrize("place, speed", SCALES)
def test_pairs_are_told_in_the_same_bits(place: float, speed: float, monkeypatch: pytest.MonkeyPatch) -> None:
    rng, hits, open_ = Random(f"pairs {place} {speed}"), 0, 0
    for _ in range(ROWS):
        find, (a, *others) = filtered(rng, place, speed, 13)
        reaches = [place * rng.uniform(0.05, 2.0) * rng.choice([0.0, 1.0, 1.0, 1e-7]) for _ in range(3)]
        compiled = find.pairs(a, others, reaches)
        with monkeypatch.context() as patch:
            in_python(patch)
            assert bits(compiled) == bits(find.pairs(a, others, reaches))
        hits, open_ = hits + len(compiled[0]), open_ + len(compiled[1])
    assert min(hits, open_) > 1_000


@pytest.mark.parametrize("kind", ["walls", "faces"])
@pytest.mark.parametrize("place, speed", SCALES)
def test_walls_are_told_in_the_same_bits(
    place: float, speed: float, kind: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    rng, hits, open_ = Random(f"walls {place} {speed}"), 0, 0
    for _ in range(ROWS):
        find, (a, *_) = filtered(rng, place, speed, 3)
        lines = []
        for k in range(6):
            x0, y0, nx, ny, *_ = flight(rng, place, rng.choice([1.0, place]), 0.0)
            norm, fixed = abs(nx) + abs(ny), place * rng.uniform(0.0, 0.1)
            size = float("inf") if rng.random() < 0.05 else norm * (abs(x0) + abs(y0)) + fixed
            lines.append(FloatLine(k, x0, y0, nx, ny, fixed, norm, size))
        compiled = getattr(find, kind)(a, lines)
        with monkeypatch.context() as patch:
            in_python(patch)
            assert bits(compiled) == bits(getattr(find, kind)(a, lines))
        hits, open_ = hits + len(compiled[0]), open_ + len(compiled[1])
    assert open_ > 500
    assert hits > (500 if kind == "walls" else 20 if place in (1.0, 1e3) else -1)  # a face is as long as its normal


@pytest.mark.parametrize("place, speed", SCALES)
def test_what_falls_is_told_in_the_same_bits(place: float, speed: float, monkeypatch: pytest.MonkeyPatch) -> None:
    rng, hits, open_ = Random(f"falls {place} {speed}"), 0, 0
    for _ in range(ROWS):
        find, (a, *_) = filtered(rng, place, speed, 3)
        if a.f is None:
            continue
        lines = []
        for k in range(6):
            x0, y0, nx, ny, *_ = flight(rng, place, rng.choice([1.0, place]), 0.0)
            norm, fixed = abs(nx) + abs(ny), place * rng.uniform(0.0, 0.1)
            size = float("inf") if rng.random() < 0.05 else norm * (abs(x0) + abs(y0)) + fixed
            pulls = [speed * speed / place * rng.choice([0.0, -1.0, rng.uniform(-1.0, 1.0)]) for _ in range(3)]
            face, other = rng.random() < 0.5, rng.choice([-1, -1, 5])
            lines.append(FloatFall(k, other, face, x0, y0, nx, ny, fixed, norm, size, *pulls))
        stands = [rng.randrange(6)]
        compiled = falls_in_doubles(a.f, lines, *find.wall_bounds, stands)
        with monkeypatch.context() as patch:
            in_python(patch)
            assert bits(compiled) == bits(falls_in_doubles(a.f, lines, *find.wall_bounds, stands))
        hits, open_ = hits + len(compiled[0]), open_ + len(compiled[1])
    assert open_ > 500
    assert hits > 100


@pytest.mark.parametrize("place, speed", SCALES)
def test_pegs_are_told_in_the_same_bits(place: float, speed: float, monkeypatch: pytest.MonkeyPatch) -> None:
    rng, found = Random(f"pegs {place} {speed}"), Counter[object]()
    for _ in range(ROWS):
        _, (a, b, *_) = filtered(rng, place, speed, 3)
        if a.f is None:
            continue
        x, y, *_ = flight(rng, place, speed, 0.0)
        pull = speed * speed / place
        reach = place * rng.choice([0.0, rng.uniform(0.0, 3.0), float("inf")])
        peg = FloatPeg(b, x, y, reach, pull * rng.choice([0.0, rng.uniform(-1.0, 1.0)]), -pull * rng.random())
        until = a.f[4] + place / speed * rng.choice([float("inf"), rng.random(), 0.0])
        stood = rng.random() < 0.3
        compiled = peg_in_doubles(a.f, peg, until, stood)
        with monkeypatch.context() as patch:
            in_python(patch)
            assert repr(compiled) == repr(peg_in_doubles(a.f, peg, until, stood))
        found[compiled if isinstance(compiled, bool) else "met"] += 1
    assert min(found[True], found[False]) > 30
    assert found["met"] > (12 if place < 1e45 or speed > 1.0 else -1)  # times beyond 10**60 are left to balls


@pytest.mark.parametrize("place, speed", SCALES)
def test_sides_of_arcs_are_told_in_the_same_bits(place: float, speed: float, monkeypatch: pytest.MonkeyPatch) -> None:
    rng, found = Random(f"sides {place} {speed}"), Counter[object]()
    for _ in range(ROWS):
        _, (a, *_) = filtered(rng, place, speed, 3)
        if a.f is None:
            continue
        x, y, *_ = flight(rng, place, speed, 0.0)
        nx, ny, *_ = flight(rng, 1.0, 1.0, 0.0)
        pull, reach = speed * speed / place, place * rng.choice([-1.0, 1.0]) * rng.uniform(0.0, 3.0)
        half = pull * rng.choice([0.0, rng.uniform(-1.0, 1.0)]), -pull * rng.random()
        norm = rng.choice([float("inf"), *[abs(nx) + abs(ny)] * 9])
        edge = rng.uniform(-0.7, 0.7) * norm * abs(reach) if norm < float("inf") else 0.0
        side = FallenSide(2, rng.random() < 0.3, x, y, reach, *half, nx, ny, edge, norm)
        until = a.f[4] + place / speed * rng.choice([float("inf"), rng.random(), 0.0])
        stood = rng.random() < 0.3
        compiled = side_in_doubles(a.f, side, until, stood)
        with monkeypatch.context() as patch:
            in_python(patch)
            assert repr(compiled) == repr(side_in_doubles(a.f, side, until, stood))
        found[compiled if isinstance(compiled, bool) else "met"] += 1
    assert min(found[True], found[False]) > 30
    assert found["met"] > (12 if place < 1e45 or speed > 1.0 else -1)


def polynomial(rng: Random) -> list[float]:
    """Coefficients, the constant one first and above zero; often with zeros that are all but one, at many scales."""
    degree, kind = rng.choice([2, 3, 4, 4, 4]), rng.random()
    if kind < 0.4:
        return [rng.uniform(0.0, 3.0), *(rng.uniform(-4.0, 4.0) for _ in range(degree))]
    zeros = [rng.uniform(0.1, 3.0) * rng.choice([1.0, 1.0, -1.0]) for _ in range(degree)]
    if kind < 0.7:
        zeros[1] = zeros[0] * (1.0 + rng.choice([0.0, 2.0 ** -rng.randint(5, 52)]))
    found = [1.0]
    for zero in zeros:
        found = [low - zero * high for low, high in zip([0.0, *found], [*found, 0.0], strict=True)]
    scale = 2.0 ** rng.randint(-40, 40) * (-1.0 if found[0] < 0.0 else 1.0)
    return [scale * number for number in found]


def test_zeros_of_quartics_are_told_in_the_same_bits(monkeypatch: pytest.MonkeyPatch) -> None:
    rng, found = Random(5), Counter[str]()
    for _ in range(ROWS):
        c = polynomial(rng)
        off = [abs(number) * rng.choice([0.0, 2.0**-52, 2.0**-45]) for number in c]
        end = rng.choice([float("inf"), rng.uniform(0.1, 4.0)])
        compiled = round_falls.falling_zero(c, off, end)
        with monkeypatch.context() as patch:
            in_python(patch)
            assert repr(compiled) == repr(round_falls.falling_zero(c, off, end))
        found[type(compiled).__name__] += 1
    assert min(found[name] for name in ("NoneType", "Isolated", "Unclear")) > 100


OBLIQUE = Scene(
    [
        Circle(x, y, vx=v, vy=w, r="1/3")
        for x, y, v, w in [(1, 2, 1, 0), (3, 2, -1, "1/7"), (2, 4, "1/5", -1), (4, 4, 0, 0)]
    ],
    [Wall(0, 0, 6, 1), Wall(6, 1, 5, 7), Wall(5, 7, -1, 6), Wall(-1, 6, 0, 0), Wall(-1, 6, 6, 8)],
)

BOX = [Wall(0, 0, 0, 1), Wall(12, 0, 12, 1), Wall(0, 0, 1, 0), Wall(0, 12, 1, 12)]
BARS = [Segment(3, 5, 4, 9), Segment(11, 4, 14, "11/2", r="1/4"), Segment(13, 14, "33/2", "29/2")]
BLOCK = [Polygon([(3, 3), (5, 3), ("9/2", 4), (5, 6)])]
FLOOR = Segment(0, "1/2", 6, "1/2")

PEGS = [Circle(x, y, "1/2", m="oo") for x, y in ((4, 9), (6, 14), (13, 6))]


def falling(scene: Scene, **more: Any) -> Scene:
    """The same under gravity, of which a part goes along each wall."""
    return scene.with_changes(until=None, events=None, gravity=("1/30", "-1/10"), **more)


GAS = build("gas:n=10,seed=3")
MOVING = [*BOX[:3], Wall(0, 12, 1, 12, vx="1/9", vy="-1/999")]
SCENES = {
    "gravity": (falling(GAS), 300),
    "gravity, oblique": (falling(OBLIQUE), 200),
    "gravity, segments": (falling(GAS, segments=BARS), 200),
    "gravity, pegs": (falling(GAS, circles=[*GAS.circles, *PEGS]), 200),
    "gravity, arcs": (build("pinball-table").with_changes(events=None), 60),
    "moving": (Scene([Circle(1, 5, vx=1, vy="1/3"), Circle(5, 8, vy=-1, vx="2/7")], MOVING), 200),
    "moving, segments": (Scene([Circle(1, 5, vx=1, vy="1/3")], MOVING, segments=[FLOOR]), 100),
    "gas": (build("gas:n=10,seed=3"), 400),
    "sizes": (build("gas:n=12,seed=5"), 300),
    "rack": (build("rack:rows=3"), 40),
    "cradle": (build("cradle"), 20),
    "galperin": (build("galperin:n=2"), 314),
    "lorentz": (build("lorentz"), 60),
    "near-tie": (build("near-tie:k=40"), 10),
    "oblique": (OBLIQUE, 300),
    "back": (build("reversal"), 300),
    "segments": (build("gas:n=10").with_changes(segments=BARS), 300),
    "polygon": (Scene([Circle(1, 5, vx=1, vy="1/3"), Circle(5, 8, vy=-1, vx="2/7")], BOX, polygons=BLOCK), 200),
    "segment as it starts": (Scene([Circle(2, "3/2", vx=1, vy=1), Circle(7, 7, vx=-1)], BOX, segments=[FLOOR]), 100),
}


def state(of: FilteredPredictor, moved: list[Body[arb]]) -> str:
    """What a prediction changes, to the last bit: `repr` of doubles tells them apart, and balls are equal to none."""
    arrivals = of.queue
    return repr((arrivals._heap, arrivals._order, sorted(of.plan.items()), [body.until for body in moved]))


@pytest.mark.parametrize("name", SCENES)
def test_a_run_queues_the_same_arrivals(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """At each instant of a run: its heap, entry by entry in their places, and when walls end flights."""
    scene, events = SCENES[name]
    predict, told = FilteredPredictor.predict, 0
    push_all = queue.ArrivalQueue.push_all

    def counting(*args: object) -> bool:
        nonlocal told
        done = push_all(*args)  # type: ignore[arg-type]
        told += done
        return done

    def checked(self: FilteredPredictor, moved: list, standing: object, gone: object) -> None:
        arrivals = self.queue
        before, order, plan = list(arrivals._heap), arrivals._order, dict(self.plan)
        held = [body.until for body in moved]
        with monkeypatch.context() as patch:
            in_python(patch)
            predict(self, moved, standing, gone)  # type: ignore[arg-type]
        python = state(self, moved)
        arrivals._heap[:], arrivals._order = before, order
        self.plan.clear()
        self.plan.update(plan)
        for body, until in zip(moved, held, strict=True):
            body.until = until
        predict(self, moved, standing, gone)  # type: ignore[arg-type]
        assert state(self, moved) == python

    monkeypatch.setattr(queue.ArrivalQueue, "push_all", counting)
    monkeypatch.setattr(FilteredPredictor, "predict", checked)
    run = ExactEngine().run(scene, events=events)
    assert run.events
    if name in ("gas", "sizes", "oblique", "segments", "polygon") or name.startswith(("gravity", "moving")):
        assert told > 0.9 * len(run.events)


def test_what_is_not_ordinary_is_left_to_python() -> None:
    assert predictions is not None
    find, bodies = DoubleFilter(), [Body(i, Flight(*[arb(0)] * 6), arb(1), arb(1)) for i in range(4)]
    for i, body in enumerate(bodies):
        body.f = (4.0 * i, 0.0, 1.0 - 0.25 * i, 0.125, 0.0, 0.0)
    find.largest, find.fastest, find.latest = 12.0, 1.0, 1.0
    line = FloatLine(0, 99.0, 0.0, -1.0, 0.0, 1.0, 1.0, 100.0)
    heap: list[object] = []

    def told(moved: list[Body[arb]], standing: object = (), lines: list[FloatLine] | None = None) -> int | None:
        others = [[b for b in bodies if b not in moved[: k + 1]] for k in range(len(moved))]
        walls, reaches = [lines or [line]] * len(moved), [[1.0]] * len(moved)
        pegs: list[list[FloatPeg]] = [[] for _ in moved]
        return predictions.predict(
            moved, others, walls, reaches, pegs, find.pair_bounds, find.wall_bounds, standing, heap, len(heap), 1
        )

    assert told(bodies[:2]) == len(heap) > 0
    assert min(body.until for body in bodies[:2]) < bodies[2].until
    count, until = len(heap), bodies[0].until
    assert told(bodies[:3]) is None
    assert told([]) is None
    assert told(bodies[:1], standing=[(0, 1)]) is None  # an iterable of another kind
    assert told(bodies[:1], standing=((0, 0, "pocket"),)) is None
    assert told(bodies[:1], standing=((0, 0, "arc"), (0, 0, "pocket"))) is None
    assert told(bodies[:1], lines=[line._replace(size=float("inf"))]) is None
    bodies[0].f = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    assert told(bodies[:1]) is None
    bodies[0].f = None
    assert told(bodies[:1]) is None
    assert told(bodies[1:2]) is None  # another has no doubles
    assert (len(heap), bodies[0].until) == (count, until)


@pytest.mark.parametrize(
    "call",
    [
        lambda c: c.pairs((1.0,) * 6, [], [1.0]),
        lambda c: c.pairs((1.0,) * 5, [], [1.0], (1.0,) * 5),
        lambda c: c.pairs([1.0] * 6, [], [1.0], (1.0,) * 5),
        lambda c: c.pairs((1.0, "x", 1.0, 1.0, 1.0, 1.0), [], [1.0], (1.0,) * 5),
        lambda c: c.pairs((1.0,) * 6, 3, [1.0], (1.0,) * 5),
        lambda c: c.walls((1.0,) * 6, [(1, 2)], 1.0, 1.0),
        lambda c: c.walls((1.0,) * 6, [], "far", 1.0),
        lambda c: c.faces((1.0,) * 6, [(1, 2)], 1.0, 1.0),
        lambda c: c.falls((1.0,) * 6, [(1, 2)], 1.0, 1.0, ()),
        lambda c: c.falls((1.0,) * 6, [], 1.0, 1.0, []),
        lambda c: c.falls((1.0,) * 6, [], 1.0, 1.0, (), 1),
        lambda c: c.falling_zero([1.0, 2.0], [0.0], 1.0),
        lambda c: c.falling_zero([1.0] * 6, [0.0] * 6, 1.0),
        lambda c: c.falling_zero([], [], 1.0),
        lambda c: c.onto_peg((1.0,) * 6, (1.0,) * 6, 1.0),
        lambda c: c.onto_peg((1.0,) * 6, (1.0,) * 5, 1.0, False),
        lambda c: c.onto_peg((1.0,) * 5, (1.0,) * 6, 1.0, False),
        lambda c: c.onto_side((1.0,) * 6, (1.0,) * 11, 1.0),
        lambda c: c.onto_side((1.0,) * 6, (1.0,) * 10, 1.0, False),
        lambda c: c.onto_side((1.0,) * 5, (1.0,) * 11, 1.0, False),
        lambda c: c.onto_side((1.0,) * 6, (1, True, "x", *(1.0,) * 8), 1.0, False),
        lambda c: c.predict([], [], [], [], [], (1.0,) * 5, (1.0, 1.0), (), [], 0, "none"),
        lambda c: c.predict([], [], [], [], (), (), (), []),
        lambda c: c.first([], {}),
        lambda c: c.first((), {}, 1.0),
        lambda c: c.first([], {}, "late"),
        lambda c: c.predict([], [], [], [], [], (), (), (), [], 0),
    ],
)
def test_what_makes_no_sense_is_refused(call) -> None:
    with pytest.raises(TypeError):
        call(predictions)


def test_strange_bodies_raise_what_python_would() -> None:
    body = Body(0, Flight(*[arb(0)] * 6), arb(1), arb(1))
    body.f, body.kind = (0.0,) * 6, 7
    with pytest.raises(IndexError):
        predictions.pairs((1.0,) * 6, [body], [1.0], (1.0,) * 5)
    with pytest.raises(AttributeError):
        predictions.pairs((1.0,) * 6, [object()], [1.0], (1.0,) * 5)
