"""The tangent map: derived from the laws, proved as written, and equal to the difference of two exact runs."""

from __future__ import annotations

from fractions import Fraction as Q

import numpy as np
import pytest

from truebreak.exact import ExactEngine
from truebreak.exact.laws import tangent as tangent_laws
from truebreak.exact.laws.derivation import LawError
from truebreak.exact.laws.formulas import wall_bounce
from truebreak.exact.laws.tangent_formulas import pair_tangent
from truebreak.exact.results import growth
from truebreak.exact.results.growth import Displacements, error_growth, unit_displacements
from truebreak.scenarios import Circle, Quantity, Scene, Trajectory, Wall, catalogue

TEXT = tangent_laws.text()


def test_the_file_is_current() -> None:
    assert tangent_laws.FORMULAS.read_text("utf-8") == TEXT, "run: python -m truebreak.exact.laws.tangent"


def test_what_is_written_is_what_the_laws_lead_to() -> None:
    tangent_laws.prove(tangent_laws.written(TEXT), wall_bounce)


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ("return dx * shift,", "return -dx * shift,"),
        ("mx = vx * wait + px", "mx = px"),
        ("-(approach + approach) / weight", "(approach + approach) / weight"),
        ("wa + wb", "wa + wa"),
    ],
)
def test_a_wrong_form_is_not_proved(right: str, wrong: str) -> None:
    assert right in TEXT
    with pytest.raises(LawError):
        tangent_laws.prove(tangent_laws.written(TEXT.replace(right, wrong)), wall_bounce)


def test_a_displacement_that_is_not_mirrored_is_not_proved() -> None:
    with pytest.raises(LawError, match="mirrored"):
        tangent_laws.prove(tangent_laws.written(TEXT), lambda vx, vy, nx, ny, nn: (vx, vy))


def test_it_is_the_map_of_dellago_posch_and_hoover() -> None:
    """Their form, for unit masses: A = (a.n) n, B = (b.n) n + ((w.ac) n + (w.n) ac) / s."""
    d, w, a, b, s = (Q(3), Q(4)), (Q(-2), Q(1)), (Q(1, 7), Q(2)), (Q(5), Q(-1, 3)), Q(5)
    n = tuple(part / s for part in d)

    def dot(x: tuple[Q, ...], y: tuple[Q, ...]) -> Q:
        return x[0] * y[0] + x[1] * y[1]

    ac = tuple(p - dot(a, n) / dot(w, n) * q for p, q in zip(a, w, strict=True))
    first = tuple(dot(a, n) * part for part in n)
    second = tuple(dot(b, n) * k + (dot(w, ac) * k + dot(w, n) * c) / s for k, c in zip(n, ac, strict=True))
    told = pair_tangent(*d, *w, s, Q(1), Q(1), *a, *b)
    assert told == tuple(-part for part in (*first, *second))  # what b gains is what a loses


def moved(scene: Scene, amount: Quantity) -> Scene:
    first, *others = scene.circles
    shifted = Circle(first.x + amount, first.y, first.r, first.vx, first.vy, m=first.m, id=first.id)
    return scene.with_changes(circles=[shifted, *others])


def difference(scene: Scene, events: int) -> tuple[Trajectory, np.ndarray, np.ndarray]:
    """The exact difference quotient of a 10**-150 displacement of the first circle's x, and what the map tells."""
    small = Quantity.of("10**-150")
    run, other = (ExactEngine().run(s, events=events) for s in (scene, moved(scene, small)))
    time = run.events[-1].time.digits(80)
    before = Quantity.of(time) - Quantity.of("10**-60")
    rows = []
    for one, two in zip(run.at(before).circles, other.at(before).circles, strict=True):
        pairs = [(one.x, two.x), (one.y, two.y), (one.vx, two.vx), (one.vy, two.vy)]
        rows.append([float((b.ball(900) - a.ball(900)) / small.ball(900)) for a, b in pairs])
    start = np.zeros((len(scene.circles), 4, 1))
    start[0, 0, 0] = 1.0
    carried = Displacements(run, start)
    for index in range(len(run.events) - 1):
        carried.through(index)
    return run, np.array(rows), carried.at(float(before))[:, :, 0] * 2.0**carried.scale


@pytest.mark.parametrize("text", ["gas", "gas:n=5,seed=3,mixed=yes", "lorentz"])
def test_the_map_is_the_difference_of_two_exact_runs(text: str) -> None:
    _, exact, mapped = difference(catalogue.build(text).with_changes(until=None), 60)
    assert np.abs(mapped - exact).max() <= 1e-6 * np.abs(exact).max()


def test_a_wall_and_a_fixed_circle() -> None:
    scene = Scene(
        [Circle(0, 0, vx=1, vy="1/3", id="a"), Circle(9, 2, m="oo", id="o")],
        [Wall(-2, 0, -3, 1, id="slope"), Wall(0, 12, 1, 12, id="top"), Wall(0, -12, 1, -12, id="low")],
    )
    run, exact, mapped = difference(scene, 4)
    assert len(run.events) == 4
    assert np.abs(mapped - exact).max() <= 1e-9 * np.abs(exact).max()


def test_the_growth_of_errors_in_the_gas() -> None:
    run = ExactEngine().run(catalogue.build("gas"), events=161)
    rate = error_growth(run, 161)
    assert rate is not None
    assert 161 * rate == pytest.approx(53, abs=2)  # doubles leave the history at event 161
    assert error_growth(run, 40) is not None


def test_where_a_circle_has_several_contacts_there_is_no_map() -> None:
    run = ExactEngine().run(catalogue.build("lee"))
    assert error_growth(run, 1) is None
    with pytest.raises(ValueError, match="several contacts"):
        Displacements(run, unit_displacements(3)).through(0)
    assert error_growth(run, 0) is None


def test_large_displacements_are_scaled() -> None:
    run = ExactEngine().run(catalogue.build("gas"), events=20)
    plain, scaled = (Displacements(run, unit_displacements(10) * size) for size in (1.0, growth.RESCALED))
    for index in range(20):
        plain.through(index)
        scaled.through(index)
    assert scaled.scale > 0
    time = float(run.events[-1].time)
    assert np.allclose(plain.at(time) * growth.RESCALED / 2.0**scaled.scale, scaled.at(time), rtol=1e-9)
