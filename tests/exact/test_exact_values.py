"""Laws of exact values: whatever way a value is asked for, it is one number."""

from __future__ import annotations

import math
from fractions import Fraction

import pytest
from flint import arb, ctx

from truebreak.exact import ExactEngine
from truebreak.exact.replay.state import replay
from truebreak.exact.simulation import decider
from truebreak.exact.texts import definitions
from truebreak.scenarios import Arc, Circle, Pocket, Quantity, Scene, catalogue
from truebreak.scenarios.trajectory import StopReason

SCENE = Scene([Circle(0, 0, 1, 1, 0), Circle(4, 1), Circle("9/2", -3)])


@pytest.fixture(scope="module")
def gas():
    return ExactEngine().run(catalogue.build("gas:n=6,seed=2"), events=40)


def evaluated(found, bits=400):
    """The texts of `definitions`, carried out in balls by nothing but Python's own arithmetic."""
    ctx.prec = bits
    names: dict[str, arb] = {"sqrt": lambda v: arb(v).sqrt()}
    for name, text in found.names:
        names[name] = arb_eval(text, names)
    return [arb_eval(text, names) for text in found.values]


def arb_eval(text, names):
    import ast

    def go(node):
        if isinstance(node, ast.BinOp):
            left, right = go(node.left), go(node.right)
            kind = type(node.op)
            if kind is ast.Add:
                return left + right
            if kind is ast.Sub:
                return left - right
            return left * right if kind is ast.Mult else left / right
        if isinstance(node, ast.UnaryOp):
            return -go(node.operand)
        if isinstance(node, ast.Call) and node.func.id == "zero":
            return only_zero([go(arg) for arg in node.args])
        if isinstance(node, ast.Call):
            return go(node.args[0]).sqrt()
        return names[node.id] if isinstance(node, ast.Name) else arb(node.value)

    return go(ast.parse(text, mode="eval").body)


def only_zero(told):
    """The zero of a polynomial between the last two numbers: by halves, once a derivative of one sign shows that it is
    the only one."""
    *parts, low, high = told

    def value(s):
        return sum((part * s**k for k, part in enumerate(parts)), arb(0))

    slope = sum((k * part * low.union(high) ** (k - 1) for k, part in enumerate(parts) if k), arb(0))
    assert not slope.contains(0)
    up = slope > 0
    assert not (value(low) > 0 if up else value(low) < 0)
    assert not (value(high) < 0 if up else value(high) > 0)
    while True:
        middle = ((low + high) / 2).mid()
        at = value(middle)
        if at.contains(0):
            return low.union(high)
        low, high = (middle, high) if (at < 0) == bool(up) else (low, middle)


def test_digits_text_sympy_and_float_agree():
    for event in ExactEngine().run(SCENE).events:
        text = event.time.text()
        assert float(Quantity.of(text)) == float(event.time)
        assert abs(float(event.time.sympy()) - float(event.time)) < 1e-12
        assert math.isclose(float(event.time.digits(30)), float(event.time))


def test_definitions_give_the_same_numbers_at_any_depth(gas):
    values = [event.time for event in gas.events] + [c.vx for c in gas.final.circles]
    for value, told in zip(values, evaluated(definitions(values)), strict=True):
        assert told.overlaps(value.ball(300))
        assert told.rad() < arb(2) ** -100


@pytest.mark.parametrize("name", ["axis", "bowl", "pinball-table", "galton", "peg-mirror"])
def test_definitions_go_on_after_zeros_of_quartics(name):
    run = ExactEngine().run(catalogue.build(name).with_changes(until=None, events=None), events=5)
    values = [event.time for event in run.events] + [c.vx for c in run.final.circles]
    found = definitions(values)
    assert any("zero(" in text for _, text in found.names)
    for value, told in zip(values, evaluated(found, 1_500), strict=True):
        assert told.overlaps(value.ball(300))
        assert told.rad() < arb(2) ** -60


def test_a_number_after_a_quartic_is_told_by_its_definition_and_any_other_is_not(gas):
    run = ExactEngine().run(catalogue.build("axis").with_changes(until=None, events=None), events=3)
    value = run.events[-1].time
    *names, last = value.text().split("; ")
    told = evaluated(type("Told", (), {"names": [name.split(" = ") for name in names], "values": [last]}))[0]
    assert value.normal_form() is None
    assert told.overlaps(value.ball(300))
    assert told.rad() < arb(2) ** -100
    assert all(any(name.split(" = ")[0] in other for other in [*names[k + 1 :], last]) for k, name in enumerate(names))
    assert gas.events[-1].time.text() is None


def test_definitions_grow_in_proportion_to_the_events(gas):
    found = definitions([event.time for event in gas.events])
    assert sum(len(text) for _, text in found.names) < 4_000 * len(gas.events)


def test_deep_sympy_expressions_are_the_values(gas):
    import sympy

    value = gas.events[6].time
    expression = value.sympy()
    assert isinstance(expression, sympy.Expr)
    assert abs(float(sympy.lambdify([], expression, "math", cse=True)()) - float(value)) < 1e-6


def test_a_hundred_digits_are_right(gas):
    value = gas.events[-1].time
    short, long = value.digits(100), value.digits(140)
    assert long.startswith(short[:-1])


def test_state_at_an_event_is_as_the_event_leaves_it():
    run = ExactEngine().run(SCENE)
    first = run.events[0].time
    before, at = run.at(Quantity.of(first.text()) - Quantity.of("1/1000000")), run.at(first)
    assert float(before["c2"].vx) == 0.0
    assert float(at["c2"].vx) != 0.0
    assert float(run.at(Quantity.of(first.text()))["c2"].vx) == float(at["c2"].vx)


@pytest.mark.parametrize("time", [-1, "10**9"])
def test_times_outside_the_run_are_refused(gas, time):
    with pytest.raises(ValueError, match=r"start|end"):
        gas.at(time)


def test_the_caller_keeps_its_precision():
    ctx.prec = 77
    run = ExactEngine().run(SCENE)
    float(run.events[-1].time)
    run.final["c1"].x.digits(50)
    assert ctx.prec == 77


def test_a_time_of_another_run_gives_no_wrong_digits() -> None:
    """What is at hand of it is right; what this run's log would have to compute of it is refused."""
    runs = [ExactEngine().run(Scene([Circle(0, 0, vx=1), Circle(x, y)])) for x, y in ((4, 1), (7, "1/2"))]
    time = runs[0].events[0].time
    circle = runs[1].at(time).circles[0]
    assert float(circle.x) == pytest.approx(float(time), abs=1e-15)
    with pytest.raises(ValueError, match="another run"):
        circle.x.digits(60)


def test_numbers_asked_for_in_any_order_and_precision_are_the_same() -> None:
    run = ExactEngine().run(catalogue.build("gas"), events=30)
    told = [event.time.digits(80) for event in run.events]
    again = ExactEngine().run(catalogue.build("gas"), events=30)
    for bits in (2000, 300, 900):
        for event in (again.events[20], again.events[5], again.events[29]):
            assert event.time.digits(80) == told[event.index]
            assert event.time.ball(bits).rel_accuracy_bits() >= bits


def test_samples_at_times_beyond_pairs_of_doubles() -> None:
    run = ExactEngine().run(Scene([Circle(0, 0, vx=1)]), until="10**308")
    assert run.sample([0.0, 1e305])[:, 0, 0].tolist() == [0.0, 1e305]


def numbers_at_the_end(scene):
    circles = ExactEngine().run(scene, events=3).final.circles
    return [value for c in circles for value in (c.x, c.y, c.vx, c.vy)]


def test_numbers_of_one_past_are_written_from_one_replay(monkeypatch):
    scene = catalogue.build("gas:n=3")
    alone = [numbers_at_the_end(scene)[k].text() for k in range(12)]  # each of a run of its own
    replays = []

    def counted(*given):
        replays.append(given)
        replay(*given)

    monkeypatch.setattr(decider, "replay", counted)
    assert [value.text() for value in numbers_at_the_end(scene)] == alone
    assert len(replays) == 3  # one for each disc


def met_at(time: Fraction, kind: str, mirrored: bool) -> tuple[Scene, Fraction]:
    """A disc that comes at a fraction to where (3, 4) of length 5 leads from a middle, and its height then."""
    hollow = kind in ("ring", "bowl")
    reach = Fraction(3, 2) if hollow else Fraction(5, 2)
    x, y = reach * Fraction(3, 5), reach * Fraction(4, 5) * (-1 if hollow else 1)
    x, toward = (-x if mirrored else x), 1 if mirrored else -1
    vx, vy = Fraction(toward, 3), Fraction(-3)
    disc = Circle(x - vx * time, y - vy * time - time * time, "1/2", vx=vx, vy=vy + 2 * time, id="disc")
    arcs = {
        "ring": [Arc(0, 0, 2, full=True)],
        "bowl": [Arc(0, 0, 2, -2, 0, 2, 0)],
        "outside": [Arc(0, 0, 2, full=True)],
        "dome": [Arc(0, 0, 2, 2, 0, -2, 0)],
    }.get(kind, [])
    pockets = [Pocket(0, 0, "5/2")] if kind == "rim" else []
    return Scene([disc], arcs=arcs, pockets=pockets, gravity=(0, -2)), y


@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize("kind", ["ring", "bowl", "outside", "dome", "rim"])
def test_what_comes_at_a_fraction_is_told_from_it(kind: str, mirrored: bool) -> None:
    time = Fraction(2, 3)
    scene, height = met_at(time, kind, mirrored)
    run = ExactEngine().run(scene, until=3)
    (first, *_) = [event.time for event in run.events] or [entry.time for entry in run.pocketings]
    assert first.text() == "2/3"
    (at,) = run.at(time).circles
    assert Fraction(at.y.text()) == height
    before, after = run.at(time - Fraction(1, 10**900)), run.at(time + Fraction(1, 10**900))
    assert float(before.circles[0].vy) == -3
    if kind != "rim":
        assert at.vy.digits(20) == after.circles[0].vy.digits(20) != "-3"
    ends = ExactEngine().run(scene, until=time)
    assert ends.stop.reason is StopReason.HORIZON
    assert len(ends.events) + len(ends.pocketings) == 1


def test_a_fraction_is_told_where_the_gap_has_other_numbers() -> None:
    peg = Circle(0, 0, fixed=True, id="peg")
    run = ExactEngine().run(Scene([Circle("sqrt(2)", "1 + sqrt(2)", id="disc"), peg], gravity=(0, -2)), until=1)
    assert [event.time.text() for event in run.events] == ["1"]
    assert run.at(1)["disc"].vx.text() == "2"


def test_a_rim_that_is_gone_through_twice_is_entered_at_both_fractions() -> None:
    disc = Circle("3/5", "-23/5", "1/2", vy="24/5", id="disc")
    run = ExactEngine().run(Scene([disc], pockets=[Pocket(0, 0, 1)], gravity=(0, -2)), until=4)
    assert [entry.time.text() for entry in run.pocketings] == ["1", "3"]
    assert [run.at(time)["disc"].y.text() for time in (1, 3)] == ["-4/5", "4/5"]
