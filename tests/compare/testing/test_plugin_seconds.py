"""Seconds that a check may take."""

from __future__ import annotations

import pytest

pytest_plugins = ["pytester"]


def test_an_engine_that_hangs_is_a_test_that_fails(pytester: pytest.Pytester) -> None:
    """One that plays into a recording, and one that hands its own run over: both are ended, and undecided."""
    pytester.makepyfile(
        """
        import pytest
        from truebreak.compare.foreign import RecordedEngine
        from truebreak.scenarios import Declared

        class Hangs(RecordedEngine):
            name = "hangs"

            def play(self, scene, recording):
                while recording.open:
                    pass

        class Stuck(Declared):
            name, bits = "stuck", 53

            def run(self, scene, **limits):
                while True:
                    pass

        @pytest.mark.parametrize("asked", [{}, {"events": 2}, {"permitted": True}])
        @pytest.mark.parametrize("engine", [Hangs(), Stuck()])
        def test_hangs(truebreak, engine, asked):
            truebreak.check(engine, "near-tie:k=4", **asked)
        """
    )
    done = pytester.runpytest_subprocess("--truebreak-max-seconds=0.3", "-p", "no:cacheprovider")
    done.assert_outcomes(failed=6)
    done.stdout.fnmatch_lines(["E *hangs: *0.3 seconds (--max-seconds)*"])
    done.stdout.fnmatch_lines(["E *stuck: *0.3 seconds (--max-seconds)*"])
    pytester.makeini("[pytest]\ntruebreak_max_seconds = soon\n")
    told = pytester.runpytest_subprocess("-p", "no:cacheprovider").stdout.str()
    assert "max_seconds = 'soon'; must be a number of seconds" in told
