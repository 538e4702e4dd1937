"""The laws: each derivation has its known solutions, each stable form equals it, and the file is current."""

from __future__ import annotations

import subprocess
import sys
from fractions import Fraction
from functools import cache
from io import StringIO

import law_forms
import law_proofs as proofs
import pytest
from sympy import Eq, I, Rational, nonlinsolve, sqrt, symbols

from truebreak.exact.laws import derivation as laws
from truebreak.exact.laws import formulas
from truebreak.exact.laws.derivation import NotEliminable, eliminate, is_zero, quadratic_roots

F = Fraction
TEXT = law_forms.render()
"""What `formulas.py` should hold."""


def numbers(*pairs):
    """Article symbols, by name, and their values."""
    return {getattr(laws, name): value for name, value in pairs}


def circles(a, b):
    """Substitution of two circles given as (x, y, r, vx, vy[, m])."""
    names = ("x", "y", "r", "vx", "vy", "m")
    given = [(f"a_{name}", value) for name, value in zip(names, a, strict=False)]
    return numbers(*given, *((f"b_{name}", value) for name, value in zip(names, b, strict=False)))


def wall(x0, y0, x1, y1):
    """Substitution of a wall, in both spellings of the article."""
    return {
        laws.x0: x0, laws.y0: y0, laws.x1: x1, laws.y1: y1,
        laws.w_x0: x0, laws.w_y0: y0, laws.w_x1: x1, laws.w_y1: y1,
    }  # fmt: skip


# -- the article's own examples


def test_head_on_circles_touch_at_one_and_three():
    at = circles((0, 0, 1, 2, 0), (4, 0, 1, 0, 0))
    assert [time.subs(at) for time in laws.pair_times()] == [1, 3]


def test_parting_circles_touched_in_the_past():
    at = circles((2, 2, 1, 1, 1), (0, 0, 1, 0, 0))
    assert [time.subs(at) for time in laws.pair_times()] == [-2 - sqrt(2), -2 + sqrt(2)]


def test_circles_whose_paths_never_cross_touch_at_complex_times():
    at = circles((0, 0, 1, 1, 0), (4, 4, 1, 0, 0))
    assert all(time.subs(at).has(I) for time in laws.pair_times())


def test_circles_without_relative_motion_touch_at_nan():
    at = circles((0, 0, 1, 1, 0), (4, 0, 1, 1, 0))
    assert not any(time.subs(at).is_finite for time in laws.pair_times())


def test_circle_touches_a_wall_from_either_side():
    at = numbers(("a_x", 0), ("a_y", 5), ("a_r", 1), ("a_vx", 0), ("a_vy", -2)) | wall(0, 0, 1, 0)
    assert {time.subs(at) for time in laws.wall_times()} == {2, 3}


def test_straight_hit_swaps_velocities_along_the_impact_only():
    at = circles((0, 0, 1, 1, 2, 1), (2, 0, 1, 0, 0, 1))
    assert [velocity.subs(at) for velocity in laws.pair_velocities()[1]] == [0, 2, 1, 0]


def test_slanted_hit_shares_the_velocity():
    at = circles((0, 0, 1, 1, 0, 1), (sqrt(2), sqrt(2), 1, 0, 0, 1))
    half = Rational(1, 2)
    assert [velocity.subs(at) for velocity in laws.pair_velocities()[1]] == [half, -half, half, half]


def test_big_circle_is_almost_a_wall():
    at = circles((0, 1, 1, 1, -1, 1), (0, -20, 20, 0, 0, 1000))
    expected = [1, Rational(999, 1001), 0, Rational(-2, 1001)]
    assert [velocity.subs(at) for velocity in laws.pair_velocities()[1]] == expected


def test_wall_reflects_at_the_angle_of_incidence():
    at = wall(-1, 0, 1, 0) | {laws.a_vx: 1, laws.a_vy: -1}
    assert [velocity.subs(at) for velocity in laws.wall_velocities()] == [1, 1]


@pytest.mark.parametrize(("vx", "speed"), [(1, 1), (-1, -1)])
def test_instant_speed_tells_toward_from_away(vx, speed):
    assert laws.pair_instant_speed().subs(circles((0, 0, 1, vx, 0), (2, 0, 1, 0, 0))) == speed


def test_instant_speed_toward_a_slanted_wall():
    at = wall(-1, -1, 1, 1) | numbers(("a_x", -sqrt(2) / 2), ("a_y", sqrt(2) / 2), ("a_vx", 2), ("a_vy", 1))
    assert laws.wall_instant_speed().subs(at).equals(sqrt(5))


# -- the derivations


@pytest.mark.parametrize(
    ("statement", "equations"),
    [
        (laws.pair_touch, 5),
        (laws.wall_touch, 6),
        (laws.pair_collision, 4),
        (laws.wall_collision, 4),
        (laws.wall_aim, 4),
    ],
)
def test_statement_has_an_equation_for_each_unknown(statement, equations):
    assert len(statement().equations) == len(statement().unknowns) == equations


@pytest.mark.parametrize(
    ("derivation", "solutions"),
    [
        (laws.pair_times, 2),
        (laws.wall_times, 2),
        (laws.pair_velocities, 2),
        (laws.finite_wall_velocities, 2),
        (laws.wall_velocities, 2),
        (laws.fixed_circle_velocities, 2),
        (laws.wall_aim_point, 2),
    ],
)
def test_derivation_has_its_known_number_of_solutions(derivation, solutions):
    assert len(set(derivation())) == solutions


def test_elimination_agrees_with_nonlinsolve_on_the_wall_of_finite_mass():
    statement = laws.wall_collision()
    theirs = set(nonlinsolve(list(statement.equations), *statement.unknowns))
    ours = laws.finite_wall_velocities()
    assert len(theirs) == len(ours) == 2
    for solution in ours:
        assert any(all(is_zero(a - b) for a, b in zip(solution, other, strict=True)) for other in theirs)


@pytest.mark.slow
@pytest.mark.parametrize("statement", [laws.pair_touch, laws.wall_touch, laws.pair_collision])
def test_elimination_agrees_with_nonlinsolve(statement):
    theirs = list(nonlinsolve(list(statement().equations), *statement().unknowns))
    ours = eliminate(statement().equations, statement().unknowns)
    assert len(theirs) == len(ours) == 2
    for solution in ours:
        assert any(is_zero(solution[0] - other[0]) for other in theirs)


def test_masses_and_momentum_are_what_makes_the_hit_unique():
    """Without the law of no change at right angles there are fewer equations than unknowns."""
    statement = laws.pair_collision()
    with pytest.raises(NotEliminable):
        eliminate(statement.equations[:3], statement.unknowns)


def test_elimination_refuses_a_cubic():
    t = symbols("t")
    with pytest.raises(NotEliminable, match="degree 3"):
        quadratic_roots(t**3 - t - 1, t)


def test_elimination_refuses_what_is_nowhere_linear():
    x, y = symbols("x y")
    with pytest.raises(NotEliminable, match="linear"):
        eliminate([Eq(x**2 + y**2, 1), Eq(x**2 - y**2, 2)], [x, y])


# -- the stable forms


class Watched(dict):
    """The written forms, of which it is noted by name which ones a proof takes."""

    def __init__(self):
        super().__init__({form.name: getattr(formulas, form.name) for form in law_forms.FORMS})
        self.used = set()

    def __getitem__(self, name):
        self.used.add(name)
        return super().__getitem__(name)


@cache
def used_by(name):
    """The forms that a proof takes, by its name; the proof is gone through, once."""
    watched = Watched()
    (proof,) = (proof for proof in proofs.PROOFS if proof.name == name)
    proofs.prove(proof, watched)
    return watched.used


@pytest.mark.parametrize("proof", proofs.PROOFS, ids=lambda proof: proof.name)
def test_stable_form_equals_the_derived_law(proof):
    assert used_by(proof.name)


def test_every_form_is_used_in_a_proof():
    assert set().union(*(used_by(proof.name) for proof in proofs.PROOFS)) == {form.name for form in law_forms.FORMS}


MUTATIONS = [
    ("return dx * vx + dy * vy", "return dx * vx - dy * vy"),
    ("return dx * dx + dy * dy - R * R", "return dx * dx + dy * dy + R * R"),
    ("cross = dx * vy - dy * vx", "cross = dx * vy + dy * vx"),
    ("* (R * R) - cross", "* R - cross"),
    ("return gap / (root - approach)", "return gap / (-root - approach)"),
    ("scale = -(approach + approach) / (R * R", "scale = -(approach) / (R * R"),
    ("scale = -(approach + approach) / (R * R * (wa + wb))", "scale = -(approach + approach) / (R * R * (wa * wb))"),
    ("return (-approach - root) / square", "return (-approach + root) / square"),
    ("(cross * vy - root * vx) / square", "(cross * vy + root * vx) / square"),
    ("return (-dx * ux - dy * uy - R) / speed", "return (-dx * ux - dy * uy + R) / speed"),
    ("return (root + root) / (R * R * (wa + wb))", "return root / (R * R * (wa + wb))"),
    ("(y - y0) * ny - rL", "(y - y0) * ny + rL"),
    ("return vx * nx + vy * ny\n", "return vx * ny + vy * nx\n"),
    ("return -gap / approach", "return gap / approach"),
    ("scale = (approach + approach) / nn", "scale = approach / nn"),
    ("return x + v * dt", "return x - v * dt"),
]


@pytest.mark.parametrize(("right", "wrong"), MUTATIONS)
def test_no_wrong_form_passes_the_proofs(right, wrong):
    assert TEXT.count(right) == 1, f"{right!r} is not in formulas.py once; write this mutation anew"
    mutant = proofs.functions(TEXT.replace(right, wrong))
    with pytest.raises(laws.LawError):
        for proof in proofs.PROOFS:
            proofs.prove(proof, mutant)


def test_file_is_what_the_forms_render_to():
    assert proofs.is_current(TEXT, proofs.FORMULAS), "run: python docs/studies/law_proofs.py"


def test_check_tells_a_stale_file_from_a_current_one(tmp_path):
    path = tmp_path / "formulas.py"
    assert not proofs.is_current(TEXT, path)
    assert proofs.write(TEXT, path) == path
    assert proofs.is_current(TEXT, path)
    path.write_text(TEXT.replace("x + v * dt", "x - v * dt"))
    assert not proofs.is_current(TEXT, path)
    assert [file.name for file in tmp_path.iterdir()] == ["formulas.py"]


def test_derivation_shows_every_law_and_every_proof():
    shown, progress = StringIO(), StringIO()
    assert proofs.derive_and_prove(shown, progress) == TEXT
    for proof in proofs.PROOFS:
        assert proof.name in shown.getvalue()
        assert f"proved: {proof.name}" in progress.getvalue()


def test_command_reports_a_wrong_form_and_writes_nothing(monkeypatch, capsys):
    wrong = TEXT.replace("return x + v * dt", "return x - v * dt")
    command = proofs
    monkeypatch.setattr(proofs, "render", lambda: wrong)
    assert command.main([]) == 1
    assert "straight flight" in capsys.readouterr().err
    assert proofs.is_current(TEXT, proofs.FORMULAS)


def test_help_teaches_how_to_change_a_formula():
    command = [sys.executable, proofs.__file__, "--help"]
    text = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    assert "--check" in text
    assert "law_forms.py" in text


def test_check_exits_with_zero_on_the_current_file():
    command = [sys.executable, proofs.__file__, "--check"]
    done = subprocess.run(command, check=False, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert "current" in done.stderr


def test_formulas_import_nothing_but_typing():
    imports = [line for line in TEXT.splitlines() if line.startswith(("import ", "from "))]
    assert imports == ["from typing import Protocol, Self, TypeVar"]
    assert "sqrt" not in TEXT
    assert "**" not in TEXT
