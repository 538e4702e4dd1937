"""The exact engine against the independent referee, scene by scene: every contact and time."""

from __future__ import annotations

import pytest
from referee import compare_to_referee, load, names

from truebreak.exact import ExactEngine


@pytest.mark.parametrize("name", names())
def test_exact_engine_agrees_with_the_referee(name):
    scene, history = load(name)
    compare_to_referee(ExactEngine().run(scene, events=len(history.events)), history)
