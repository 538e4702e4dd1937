"""How pymunk's outcome nears that of a tie policy as its step shrinks: `python docs/studies/impulse_policies.py`.

Prints a table: for each scene and step, the largest difference between pymunk's final velocities, and final
positions, and those of the exact engine under each policy.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from truebreak.compare.deadline import uninterrupted
from truebreak.exact.exact_engine import ExactEngine
from truebreak.floating.pymunk_engine import PymunkEngine
from truebreak.scenarios.catalogue import build
from truebreak.scenarios.scene import Scene
from truebreak.scenarios.things import Circle

POLICIES = ("simultaneous", "sequential:order=scene")

STEPS = tuple(Fraction(1, 2**power) for power in (6, 8, 10, 12, 14))
"""Powers of two, so that the times of steps are exact in doubles."""


@dataclass(frozen=True)
class PolicyDistance:
    """How far pymunk ends from the exact engine under one policy.

    Attributes:
        policy: the tie policy.
        velocity: largest difference of a component of a velocity.
        position: largest difference of a coordinate.
    """

    policy: str
    velocity: float
    position: float


@dataclass(frozen=True)
class PolicyScene:
    """A scene and the time at which outcomes are compared."""

    scene: Scene
    until: int


def subjects() -> tuple[PolicyScene, ...]:
    """Scenes whose outcome depends on the policy, and two in which rounding makes circles overlap."""
    two = Scene([Circle(0, 0, vx=1), Circle("3 + sqrt(3)", 1), Circle("3 + sqrt(3)", -1)], name="one onto two")
    three = Scene(
        [Circle(-5, 0, vx=1), Circle(0, 0), Circle("sqrt(3)", 1), Circle("sqrt(3)", -1)],
        name="one onto three that touch",
    )
    return (
        PolicyScene(build("lee"), 3),
        PolicyScene(two, 6),
        PolicyScene(build("rack:rows=2"), 60),
        PolicyScene(build("rack:rows=4"), 60),
        PolicyScene(build("rack:rows=4,gap=1/50"), 60),
        PolicyScene(three, 6),
        PolicyScene(build("cradle:gap=0,r=3/10"), 6),
    )


def distances(subject: PolicyScene, step: Fraction) -> Iterator[PolicyDistance]:
    """How far pymunk with one step ends from each policy's outcome.

    >>> lee = subjects()[0]
    >>> [distance.velocity < 1e-9 for distance in distances(lee, Fraction(1, 64))]
    [True, False]
    """
    played = uninterrupted(PymunkEngine(dt=float(step)).run(subject.scene, until=subject.until)).final.array()
    for policy in POLICIES:
        exact = uninterrupted(ExactEngine().run(subject.scene.with_changes(tie_policy=policy), until=subject.until))
        apart = np.abs(played - exact.final.array())
        yield PolicyDistance(policy, float(apart[:, 2:].max()), float(apart[:, :2].max()))


def rows(chosen: Sequence[PolicyScene], steps: Sequence[Fraction]) -> Iterator[str]:
    """The lines of the table."""
    ends = " | ".join(f"velocity, from `{policy}` | position" for policy in POLICIES)
    yield f"| scene, until | step | {ends} |"
    yield "|---|---|" + "---:|" * (2 * len(POLICIES))
    for subject in chosen:
        for step in steps:
            cells = [f"{amount:.1e}" for d in distances(subject, step) for amount in (d.velocity, d.position)]
            yield f"| {subject.scene.name}, {subject.until} | {step} | {' | '.join(cells)} |"


if __name__ == "__main__":
    argparse.ArgumentParser(prog="python docs/studies/impulse_policies.py", description=__doc__).parse_args()
    for line in rows(subjects(), STEPS):
        print(line, flush=True)
