"""Bugs that engines have had, planted into honest ones."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

from truebreak.compare.foreign import Recording
from truebreak.scenarios import Circle, Declared, Scene, Trajectory


@dataclass(frozen=True)
class Bug:
    """A bug, a scene that shows it, and what a failure must say."""

    name: str
    scene: str
    told: str
    given: Callable[[Scene], Scene] = lambda scene: scene
    made: Callable[[Trajectory], Trajectory] = lambda run: run


def heavier(scene: Scene) -> Scene:
    """The second circle has a tenth more mass."""
    circles = list(scene.circles)
    c = circles[1]
    assert not isinstance(c.m, str)
    circles[1] = Circle(c.x, c.y, c.r, c.vx, c.vy, m=c.m * "11/10", id=c.id)
    return scene.with_changes(circles=circles)


def without_a_wall(scene: Scene) -> Scene:
    """The last wall is not there."""
    return scene.with_changes(walls=scene.walls[:-1])


def late(run: Trajectory) -> Trajectory:
    """The clock goes wrong by a quarter from the second event on."""
    recording = Recording(run.scene, run.engine)
    for event in run.events:
        time = float(event.time)
        state = run.at(event.time)
        recording.hits(time * (1.25 if event.index else 1.0), event.impulses, _states(run.scene, state))
    recording.end()
    told = recording.trajectory()
    return replace(told, stop=run.stop, reversal=run.reversal)


def dropping(run: Trajectory) -> Trajectory:
    """The second event is not reported."""
    kept = [e for e in run.events if e.index != 1]
    return replace(run, events=tuple(replace(e, index=k) for k, e in enumerate(kept)))


def _states(scene: Scene, state: Any) -> dict[str, Any]:
    return {c.id: (float(c.x), float(c.y), float(c.vx), float(c.vy)) for c in state.circles}


BUGS = (
    Bug("wrong mass", "near-tie:k=1", "velocity of", given=heavier),
    Bug("missed wall", "gas", "wall top", given=without_a_wall),
    Bug("late clock", "cradle", "time = ", made=late),
    Bug("dropped contact", "gas", "first differs at event", made=dropping),
)


@dataclass(frozen=True)
class Planted(Declared):
    """An engine with a bug in it, which declares what the engine declares."""

    inner: Any
    bug: Bug

    @property
    def name(self) -> str:
        """The bug's."""
        return self.bug.name

    @property
    def step(self) -> float | None:
        """The engine's."""
        return self.inner.step

    @property
    def bits(self) -> int | None:
        """The engine's."""
        return self.inner.bits

    @property
    def rounds_input(self) -> bool:
        """The engine's."""
        return self.inner.rounds_input

    def finer(self) -> Any:
        """The engine's, with the bug."""
        finer = self.inner.finer()
        return None if finer is None else replace(self, inner=finer)

    def firmer(self) -> Any:
        """The engine's, with the bug."""
        firmer = self.inner.firmer()
        return None if firmer is None else replace(self, inner=firmer)

    def run(self, scene: Scene, **limits: Any) -> Trajectory:
        """The engine's run of what the bug leaves of the scene, and what the bug makes of it."""
        run = self.bug.made(self.inner.run(self.bug.given(scene), **limits))
        return replace(run, scene=scene, engine=self.name)
