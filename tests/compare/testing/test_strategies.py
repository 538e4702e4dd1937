"""Families of scenes as parameters, and scenes that hypothesis draws."""

from __future__ import annotations

import pytest

from truebreak.testing import check

pytest_plugins = ["pytester"]

LOADED = check
"""Loaded before the runs within this process: they drop what they import, and numpy cannot be loaded twice."""


def test_families_and_strategies(pytester: pytest.Pytester) -> None:
    pytester.makepyfile(
        """
        import pytest
        from hypothesis import given, settings
        from truebreak.testing import scenes, truebreak_scenes

        @pytest.mark.parametrize("scene", truebreak_scenes("lee", "near-tie:k=3..5"))
        def test_family(truebreak, scene):
            truebreak.check("double", scene)

        @settings(max_examples=10, deadline=None, derandomize=True)
        @given(scene=scenes(circles=(2, 3), walls=2))
        def test_drawn(scene):
            from truebreak.testing import check
            check("double", scene.with_changes(events=6))
        """
    )
    done = pytester.runpytest_subprocess("-v", "-p", "no:cacheprovider")
    done.assert_outcomes(passed=5)
    done.stdout.fnmatch_lines(["*test_family?near-tie:k=4? PASSED*"])


def test_strategies_shrink_to_scenes_that_can_be_read() -> None:
    from hypothesis import find, settings

    from truebreak.scenarios import Scene
    from truebreak.testing import scenes

    quick = settings(max_examples=2_000, database=None, deadline=None)
    small = find(scenes(circles=(1, 6), walls=(0, 4)), lambda s: len(s.circles) >= 2, settings=quick)
    assert (len(small.circles), len(small.walls)) == (2, 0)
    assert all(c.at_rest and c.x.text() in ("0", "4") and c.y.text() == "0" for c in small.circles)
    touching = find(scenes(circles=(1, 6), touching=True), lambda s: bool(s.touching), settings=quick)
    assert isinstance(touching, Scene)
    assert len(touching.circles) == 2
