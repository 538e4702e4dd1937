"""The restitution that an engine's bounces have, beside the one that a scene asks for."""

from __future__ import annotations

import math
import statistics
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np

from ...scenarios.engine import Engine
from ...scenarios.errors import SceneError
from ...scenarios.scene import Scene
from ...scenarios.things import Circle, Wall
from ...scenarios.trajectory import StopReason
from ..deadline import uninterrupted
from ..engines import engine
from ..validation import unsupported
from .engine_survey import SURVEYED, chosen, installed, installed_version

ASKED = ("1/2", "4/5", "9/10", "19/20", "1")
"""The restitutions that are asked for."""

CONTACTS = ("wall", "discs", "drop")
"""What is hit: a wall, another disc at rest, or a floor under gravity, from a height."""

SAMPLES = 4096
"""Times between the first bounce and the next at which the height is looked at, of an engine that has no time step."""

BOUNCES = 16
"""Bounces for each of them: as many speeds, each at another phase of a time step."""


@dataclass(frozen=True)
class Bounces:
    """The bounces of one engine at one restitution.

    Attributes:
        engine: with its settings.
        asked: the restitution of the scene.
        contact: `wall`: a disc hits a wall; `discs`: a disc hits another of its mass, at rest; `drop`: a disc
            falls on a floor from a height.
        bounces: how many had an impact.
        missed: how many had none: the disc flew through.
        mean: of speed after over speed before, along the normal; of a drop, of the root of the height that it comes
            back to over that from which it fell. Null where none bounced.
        spread: their standard deviation over speeds and phases.
        least: the smallest of them.
        greatest: the largest of them.
        refused: why the engine does not take such a scene; null where it does.
    """

    engine: str
    asked: str
    contact: str
    bounces: int = 0
    missed: int = 0
    mean: float | None = None
    spread: float | None = None
    least: float | None = None
    greatest: float | None = None
    refused: str | None = None


def bounce_scene(contact: str, asked: str, number: int) -> tuple[Scene, Fraction, float]:
    """One bounce, head on: the scene, the speed of approach or the height, and the time at which it comes.

    Speeds go from 1/4 to 7/2, and times from 1/2 to 5/8, spread evenly (by the golden ratio), so that a time step of
    any usual length is met at all of its phases. Heights go from 1/2 to 17/4, with gravity 1: their times have no
    pattern.

    >>> scene, speed, time = bounce_scene("wall", "1/2", 0)
    >>> str(scene.restitution), speed, time, [str(c.x) for c in scene.circles]
    ('1/2', Fraction(1, 4), 0.5, ['-9/8'])
    """
    if contact == "drop":
        height = Fraction(2 + number, 4)
        floor, disc = Wall(-1, 0, 1, 0, id="floor"), Circle(0, 1 + height, id="ball")
        scene = Scene([disc], [floor], name="drop", restitution=asked, gravity=(0, -1))
        return scene, height, math.sqrt(2 * height)
    speed = Fraction(4 + number % 4, 4) * Fraction(2) ** (number // 4 - 2)
    time = Fraction(1, 2) + Fraction(number * 159 % 257, 257) / 8
    gap = speed * time
    ball = Circle(-1 - gap, 0, vx=speed, id="ball")
    if contact == "wall":
        scene = Scene([ball], [Wall(0, -1, 0, 1, id="wall")], name="bounce", restitution=asked)
    else:
        scene = Scene([ball, Circle(1, 0, id="target")], name="bounce", restitution=asked)
    return scene, speed, float(time)


def bounces_of(runner: Engine, contact: str, asked: str) -> Bounces:
    """What an engine makes of the bounces of one restitution.

    >>> from truebreak.floating import DoubleEngine
    >>> found = bounces_of(DoubleEngine(), "discs", "9/10")
    >>> found.bounces, round(found.mean, 12), found.spread < 1e-12
    (16, 0.9, True)
    """
    shares: list[float] = []
    for number in range(BOUNCES):
        scene, size, time = bounce_scene(contact, asked, number)
        key = unsupported(runner, scene)
        if key is not None:
            return Bounces(runner.name, asked, contact, refused=f"takes no scene with {key!r}")
        try:
            share = _share(runner, scene, contact, float(size), time)
        except SceneError as error:
            return Bounces(runner.name, asked, contact, refused=str(error))
        if share is not None:
            shares.append(share)
    missed = BOUNCES - len(shares)
    if not shares:
        return Bounces(runner.name, asked, contact, missed=missed)
    mean, spread = statistics.fmean(shares), statistics.pstdev(shares)
    return Bounces(runner.name, asked, contact, len(shares), missed, mean, spread, min(shares), max(shares))


def _share(runner: Engine, scene: Scene, contact: str, size: float, time: float) -> float | None:
    """The restitution that one bounce shows; None where there was none."""
    back = 1 + 1.99 * float(scene.restitution) if contact == "drop" else 2  # just before it is on the floor again
    run = uninterrupted(runner.run(scene, until=back * time))
    if run.stop.reason is StopReason.UNDECIDED:
        raise SceneError(run.stop.message)
    if not run.collisions:
        return None
    if contact == "drop":
        first, last = float(run.events[0].time), float(run.final_time)
        step = runner.step
        times = np.linspace(first, last, SAMPLES) if step is None else np.arange(first, last, step)
        return math.sqrt(max(float(run.sample(times.tolist())[:, 0, 1].max()) - 1, 0.0) / size)
    speeds = [float(circle.vx) for circle in run.final.circles]
    return (speeds[1] - speeds[0] if contact == "discs" else -speeds[0]) / size


@dataclass(frozen=True)
class BounceSurvey:
    """The restitution that the bounces of installed engines have, beside the one that a scene asks for.

    Attributes:
        versions: of the engines, by name; nothing for truebreak's own.
        rows: by engine, restitution and kind of contact.
    """

    versions: dict[str, str]
    rows: tuple[Bounces, ...]


def survey_of_restitution(engines: Sequence[str] = (), progress: Callable[[str], None] | None = None) -> BounceSurvey:
    """Every installed engine, or some, at each restitution of `ASKED`, on a wall, on another disc, and on a floor.

    Args:
        engines: names as in the survey, with settings if wanted (`pymunk:dt=1/60`); all by default, as they come.
        progress: is called with what is at work.

    Raises:
        SceneError: for an unknown name.
    """
    texts = list(engines) or [one.first for one in installed()]
    names = chosen([text.partition(":")[0] for text in texts], [one.name for one in SURVEYED], "engine")
    rows: list[Bounces] = []
    for text in texts:
        runner = engine(text)
        for asked in ASKED:
            for contact in CONTACTS:
                if progress is not None:
                    progress(f"{text}, e = {asked}, {contact}")
                rows.append(replace(bounces_of(runner, contact, asked), engine=text))
    return BounceSurvey({one.name: installed_version(one) for one in SURVEYED if one.name in names}, tuple(rows))
