"""Single and double-double numbers: right roundings, known accuracy, and how far each carries a chaotic history."""

from __future__ import annotations

import random
from fractions import Fraction

import arc_scenes
import joint_scenes
import mpmath
import numpy as np
import polygon_scenes
import pytest
from hypothesis import given
from hypothesis import strategies as st

from truebreak.compare.grids.stress_families import FAMILIES, stress_family
from truebreak.compare.grids.stress_map import stress_plan
from truebreak.exact import ExactEngine
from truebreak.exact.numbers.double_pairs import quick_two_sum, two_product, two_sum
from truebreak.exact.numbers.system import SYSTEMS, number_system
from truebreak.exact.simulation.prediction import Predictor
from truebreak.floating import DoubleEngine, QuadEngine, SingleEngine
from truebreak.floating.quad import QUADS, DoubleDouble, QuadDecider, QuadMotion, QuadPredictor
from truebreak.floating.single import SINGLES
from truebreak.scenarios import Circle, Scene, catalogue
from truebreak.scenarios.errors import SceneError
from truebreak.scenarios.numbers.quantity import Quantity


@given(st.integers(-(2**60), 2**60), st.integers(1, 2**40))
def test_a_single_is_the_nearest_one(p, q):
    value = Fraction(p, q)
    single = SINGLES.constant(Quantity.of(value))
    error = abs(Fraction(float(single)) - value)
    for end in (-np.inf, np.inf):
        other = Fraction(float(np.nextafter(single, np.float32(end))))
        assert error <= abs(other - value)


@pytest.mark.parametrize("side", [-1, 0, 1])
@pytest.mark.parametrize("base", [1.0, 1.0 + 2.0**-23])
def test_rounding_twice_does_not_move_a_single(base, side):
    """Beside a half-way point by less than a double can tell: rounding to a double first would forget the side."""
    middle = Fraction(base) + Fraction(1, 2**24)
    single = float(SINGLES.constant(Quantity.of(middle + side * Fraction(1, 2**80))))
    low, high = base, base + 2.0**-23
    even = low if base == 1.0 else high
    assert single == (high if side > 0 else low if side < 0 else even)


def test_what_singles_cannot_hold_is_refused():
    with pytest.raises(SceneError, match="beyond single precision"):
        SingleEngine().run(Scene([Circle(10**39, 0, vx=1), Circle(0, 0)]))


def parts(value: DoubleDouble) -> tuple[str, str]:
    return value.hi.hex(), value.lo.hex()


@pytest.mark.parametrize("scale", [1.0, 1e150, 1e-150])
def test_operations_of_quads_are_those_of_their_parts(scale):
    """What is written out in one gives the bits of `two_sum`, `two_product` and `quick_two_sum` in turn."""
    draw = random.Random(6)

    def number() -> DoubleDouble:
        high = draw.choice([0.0, -0.0, 1.0, np.inf, np.nan]) if draw.random() < 0.1 else draw.uniform(-2, 2) * scale
        return DoubleDouble(high, high * draw.uniform(-1, 1) * 2.0**-53)

    for _ in range(5000):
        a, b = number(), number()
        high, low = two_sum(a.hi, b.hi)
        rest, least = two_sum(a.lo, b.lo)
        high, low = quick_two_sum(high, low + rest)
        total = DoubleDouble(*quick_two_sum(high, low + least))
        assert parts(a + b) == parts(total)
        assert parts(a - DoubleDouble(-b.hi, -b.lo)) == parts(total)
        high, low = two_product(a.hi, b.hi)
        assert parts(a * b) == parts(DoubleDouble(*quick_two_sum(high, low + (a.hi * b.lo + a.lo * b.hi))))


def followed(scene: Scene, events: int) -> list[object]:
    run = QuadEngine().run(scene, events=events)
    motion = run.motion
    assert isinstance(motion, QuadMotion)
    told: list[object] = [(parts(e.time.value), e.contacts, e.impulses, e.ties, e.coupled) for e in run.events]
    return [*told, repr(list(motion.knots)), run.stop, run.plan, run.pocketings, run.reversal]


def places() -> list[Scene]:
    """Of each family of scenes that are hard for floats, the worst that its levels have."""
    plan = stress_plan(list(FAMILIES))
    ends = {(place.family, place.side): place for place in plan.places}
    return [stress_family(place.family).scene(place) for place in ends.values()]


@pytest.mark.parametrize(
    "scenes",
    [
        [catalogue.build(name) for name in catalogue.names()],
        [catalogue.build(f"gas:n={n},seed={seed}") for n in (3, 12, 80) for seed in range(4)],
        [catalogue.build(f"rack:rows={n}") for n in (2, 3, 4)],
        places(),
        [scene for seed in range(150) if (scene := joint_scenes.scene_of(seed)) is not None],
        [scene for seed in range(40) if (scene := polygon_scenes.scene_of(seed)) is not None],
        [scene for seed in range(40) if (scene := arc_scenes.scene_of(seed)) is not None],
        [arc_scenes.falls_to_arcs(seed) for seed in range(10)],
    ],
    ids=["catalogue", "gases", "racks", "families", "joints", "polygons", "arcs", "falls"],
)
def test_what_doubles_exclude_changes_no_bit_of_a_run(scenes, monkeypatch):
    with_them = [followed(scene, 60) for scene in scenes]
    monkeypatch.setattr(QuadDecider, "predictor", Predictor)
    assert with_them == [followed(scene, 60) for scene in scenes]


def test_doubles_exclude_most_of_what_is_far(monkeypatch):
    """Counted: faces that are asked for in 106 bits, of a wall of bricks."""
    asked = []
    plain = QuadPredictor.face
    monkeypatch.setattr(QuadPredictor, "face", lambda *of: (asked.append(of[2]), plain(*of)))
    QuadEngine().run(catalogue.build("breakout"), events=60)
    with_them = len(asked)
    monkeypatch.setattr(QuadPredictor, "_near", lambda self, a, walls: walls)
    QuadEngine().run(catalogue.build("breakout"), events=60)
    assert 0 < 50 * with_them < len(asked) - with_them


def exact(value: DoubleDouble) -> Fraction:
    return Fraction(value.hi) + Fraction(value.lo)


def test_operations_of_quads_are_good_to_two_units_of_their_104_bits():
    draw = random.Random(5)

    def number() -> DoubleDouble:
        high = draw.uniform(-4, 4)
        return DoubleDouble(high) + DoubleDouble(high * draw.uniform(-1, 1) * 2.0**-54)

    for _ in range(3000):
        a, b = number(), number()
        results = [(a * b, exact(a) * exact(b)), (a / b, exact(a) / exact(b))]
        total = exact(a) + exact(b)
        if abs(total) > 2.0**-40:
            results.append((a + b, total))
        for found, wanted in results:
            assert abs(exact(found) - wanted) <= abs(wanted) * Fraction(2, 2**104)
            assert abs(found.lo) <= abs(found.hi) * 2.0**-53
        root = (a * a).sqrt()
        with mpmath.workprec(300):
            square = exact(a * a)
            wanted = mpmath.sqrt(mpmath.mpf(square.numerator) / square.denominator)
            assert abs(mpmath.mpf(root.hi) + root.lo - wanted) <= wanted * mpmath.mpf(2) ** -103


def test_a_constant_of_a_quad_is_good_to_106_bits():
    for text in ("1/3", "sqrt(2)", "1e-20", "123456789/1000003"):
        quantity = Quantity.of(text)
        left = quantity - Quantity.of(exact(QUADS.constant(quantity)))
        assert abs(float(left)) <= abs(float(quantity)) * 2.0**-106


def first_difference(engine, scene, truth) -> int:
    run = engine.run(scene, events=len(truth.events))
    pairs = enumerate(zip(run.events, truth.events, strict=True))
    return next((k for k, (ours, theirs) in pairs if ours.contacts != theirs.contacts), len(truth.events))


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_twice_the_bits_carry_about_twice_as_far(seed):
    """In a gas every event costs about the same bits, so the events until the history differs grow with the bits."""
    scene = catalogue.build(f"gas:n=10,seed={seed}")
    truth = ExactEngine().run(scene, events=700)
    single, double, quad = (first_difference(e, scene, truth) for e in (SingleEngine(), DoubleEngine(), QuadEngine()))
    assert 0.25 < single / double < 0.8
    assert 1.4 < quad / double < 3.0


@pytest.mark.parametrize("engine", [SingleEngine(), DoubleEngine(), QuadEngine()], ids=lambda engine: engine.name)
def test_a_state_at_an_event_is_as_the_event_leaves_it(engine):
    run = engine.run(Scene([Circle(0, 0, vx=1), Circle(4, 1)]))
    before, after = run.at(float(run.events[0].time) - 0.001), run.at(run.events[0].time)
    assert float(before.circles[1].vx) == 0.0
    assert float(after.circles[1].vx) > 0.1


@pytest.mark.parametrize("name", SYSTEMS)
def test_every_system_of_the_table_can_be_had(name):
    assert hasattr(number_system(name), "constant")


def test_a_limit_that_is_rounded_up_lets_its_event_in() -> None:
    """A run ends with the event that the limit, in singles, does not exclude: it is part of what may be asked for."""
    scene = catalogue.build("three-disc")
    exact = ExactEngine().run(scene, events=1).events[0].time
    run = SingleEngine().run(scene, until=float(exact))
    assert len(run.events) == 1
    assert float(run.events[0].time) > float(exact)
    assert float(run.final_time) == float(run.events[0].time)
    assert run.at(run.events[0].time)["ball"].vx != scene.circles[0].vx
