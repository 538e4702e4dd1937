"""How much work a number close to zero may take before it is refused."""

from __future__ import annotations

import pytest
import sympy

from truebreak.scenarios import Quantity, SceneError
from truebreak.scenarios.numbers import quantity


def test_a_number_that_takes_too_much_work_is_refused_and_with_enough_it_is_not(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    text = "sqrt(5 + 2*sqrt(6)) - sqrt(2) - sqrt(3)"
    monkeypatch.setattr(quantity, "PATIENCE", 1_000)
    with pytest.raises(SceneError, match=r"too close to zero to be distinguished from it within 1,000 units of work$"):
        Quantity.of(text).sign()
    monkeypatch.setattr(quantity, "PATIENCE", 10_000)
    assert Quantity.of(text).sign() == 0


def test_the_tower_of_a_number_that_doubles_with_each_root_is_left() -> None:
    roots = " + ".join(f"sqrt({sympy.prime(i)})" for i in range(1, 16))
    zero = Quantity.of(f"1/({roots}) - 1/({roots} + sqrt(2)*sqrt(2) - 2)")
    with pytest.raises(SceneError, match="units of work"):
        zero.sign()
