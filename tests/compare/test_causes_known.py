"""The causes that a comparison names are those of engines whose error was made by hand."""

from __future__ import annotations

from fractions import Fraction

import pytest
from causes_known import (
    FAMILIES,
    WAY,
    budget,
    complaints,
    decided,
    gap,
    history,
    kicked,
    relay,
    shifted,
    sized,
)
from faults import Kick, Rounded, Run, Skip, fraction
from other_runs import rounded_scene
from refuting import FLIGHTS, IMPACTS, INPUT

from truebreak.exact import ExactEngine
from truebreak.scenarios import catalogue

SLOW = {"steps", "not of steps", "own engines", "several faults"}
"""Families in which engines of steps are run at many steps."""


@pytest.mark.parametrize("family", [pytest.param(f, marks=pytest.mark.slow if f in SLOW else ()) for f in FAMILIES])
def test_the_cause_is_the_one_that_was_made(family: str) -> None:
    wrong = {known.name: said for known in FAMILIES[family]() if (said := complaints(known))}
    assert not wrong, "\n".join(f"{name}: {'; '.join(said)}" for name, said in wrong.items())


@pytest.mark.slow
def test_there_are_sixty_cases_and_mixed_ones_among_them() -> None:
    made = [known for family in FAMILIES.values() for known in family()]
    assert len({known.name for known in made}) == len(made) >= 60
    assert sum(len(known.shares) > 1 for known in made) >= 20
    assert sum(len(known.all_of) > 1 for known in made) >= 5
    assert sum(any(share < 0 for _, share, _ in known.shares) for known in made) >= 5


# -- the judge's own engine


@pytest.mark.parametrize("spec", ["gas:n=4,seed=3", "gas:n=5,seed=3,mixed=yes", "galperin:n=1", "pinball:offset=1/7"])
def test_the_engine_without_faults_is_the_exact_one(spec: str) -> None:
    scene = catalogue.build(spec)
    exact, run = ExactEngine().run(scene, events=25), Run(scene).upto(25)
    assert [set(e.impulses[0]) for e in exact.events] == [set(m.pair) for m in run.meetings]
    for event, met in zip(exact.events, run.meetings, strict=True):
        assert abs(Fraction(event.time.digits(60)) - fraction(met.time)) < Fraction(1, 10**50)


def test_a_kick_moves_the_decision_by_what_geometry_says() -> None:
    """The second disc flies 64 at a speed of 4/5: off by e to the side, it passes 80 e further out."""
    scene, size = relay(24, 16), Fraction(1, 2**26)
    moved = decided(scene, [kicked(size)]) - decided(scene)
    speed = Fraction(4, 5)  # the share of the first one's that the second gets along the line of centres
    assert float(moved) == pytest.approx(float(-64 * size / speed), rel=1e-3)


def test_contributions_add_up_to_the_displacement() -> None:
    scene = relay(16, 30, Fraction(3, 8) / 2**16)
    faults = [Rounded(16), sized(scene, kicked, Fraction(1, 2**12)), sized(scene, shifted, Fraction(-1, 2**13))]
    shares, total, margin = budget(scene, faults, 1, gap("b", "c"))
    assert shares.keys() == {INPUT, FLIGHTS, IMPACTS}
    assert sum(share for share, _ in shares.values()) == pytest.approx(1)
    assert total == pytest.approx(float(decided(scene, faults) - decided(scene)))
    assert margin == pytest.approx(float(decided(scene)))


def test_faults_are_at_their_event_and_of_their_kind() -> None:
    scene = rounded_scene(catalogue.build("gas:n=4,seed=21"), 24)
    plain, off = Run(scene).upto(6), Run(scene, [Kick(3, history(scene, (), 4)[3][0], WAY)]).upto(6)
    assert plain.meetings[2] == off.meetings[2]
    assert plain.meetings[3].places == off.meetings[3].places
    assert plain.meetings[3].speeds != off.meetings[3].speeds
    event = next(k for k, pair in enumerate(history(scene, (), 20)) if not {*pair} & {"top", "bottom", "left", "right"})
    assert history(scene, (Skip(event),), event) == history(scene, (), event)
    assert history(scene, (Skip(event),), event + 1) != history(scene, (), event + 1)
