"""The restitution that an engine's bounces have, beside the one that a scene asks for."""

from __future__ import annotations

import statistics
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction

from ...scenarios.engine import Engine
from ...scenarios.errors import SceneError
from ...scenarios.scene import Scene
from ...scenarios.things import Circle, Wall
from ..deadline import uninterrupted
from ..engines import engine
from ..validation import unsupported
from .engine_survey import SURVEYED, chosen, installed, installed_version

ASKED = ("1/2", "4/5", "9/10", "19/20", "1")
"""The restitutions that are asked for."""

CONTACTS = ("wall", "discs")
"""What is hit."""

BOUNCES = 16
"""Bounces for each of them: as many speeds, each at another phase of a time step."""


@dataclass(frozen=True)
class Bounces:
    """The bounces of one engine at one restitution.

    Attributes:
        engine: as it comes.
        asked: the restitution of the scene.
        contact: `wall`: a disc hits a wall; `discs`: a disc hits another of its mass, at rest.
        bounces: how many had an impact.
        missed: how many had none: the disc flew through.
        mean: of speed after over speed before, along the normal; null where none bounced.
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


def bounce_scene(contact: str, asked: str, number: int) -> tuple[Scene, Fraction, Fraction]:
    """One bounce, head on: the scene, the speed of approach, and the time at which it comes.

    Speeds go from 1/4 to 7/2; times are 1/2 to 5/8, spread evenly (by the golden ratio), so that a time step of any
    usual length is met at all of its phases.

    >>> scene, speed, time = bounce_scene("wall", "1/2", 0)
    >>> str(scene.restitution), speed, time, [str(c.x) for c in scene.circles]
    ('1/2', Fraction(1, 4), Fraction(1, 2), ['-9/8'])
    """
    speed = Fraction(4 + number % 4, 4) * Fraction(2) ** (number // 4 - 2)
    time = Fraction(1, 2) + Fraction(number * 159 % 257, 257) / 8
    gap = speed * time
    ball = Circle(-1 - gap, 0, vx=speed, id="ball")
    if contact == "wall":
        return Scene([ball], [Wall(0, -1, 0, 1, id="wall")], name="bounce", restitution=asked), speed, time
    return Scene([ball, Circle(1, 0, id="target")], name="bounce", restitution=asked), speed, time


def bounces_of(runner: Engine, contact: str, asked: str) -> Bounces:
    """What an engine makes of the bounces of one restitution.

    >>> from truebreak.floating import DoubleEngine
    >>> found = bounces_of(DoubleEngine(), "discs", "9/10")
    >>> found.bounces, round(found.mean, 12), found.spread < 1e-12
    (16, 0.9, True)
    """
    shares: list[float] = []
    for number in range(BOUNCES):
        scene, speed, time = bounce_scene(contact, asked, number)
        key = unsupported(runner, scene)
        if key is not None:
            return Bounces(runner.name, asked, contact, refused=f"takes no scene with {key!r}")
        try:
            run = uninterrupted(runner.run(scene, until=2 * time))
        except SceneError as error:
            return Bounces(runner.name, asked, contact, refused=str(error))
        if run.collisions:
            speeds = [float(circle.vx) for circle in run.final.circles]
            shares.append((speeds[1] - speeds[0] if contact == "discs" else -speeds[0]) / float(speed))
    if not shares:
        return Bounces(runner.name, asked, contact, missed=BOUNCES)
    return Bounces(
        runner.name,
        asked,
        contact,
        len(shares),
        BOUNCES - len(shares),
        statistics.fmean(shares),
        statistics.pstdev(shares),
        min(shares),
        max(shares),
    )


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
    """Every installed engine, or some, as it comes, at each restitution of `ASKED`, on a wall and on another disc.

    Args:
        engines: names as in the survey; all by default.
        progress: is called with what is at work.

    Raises:
        SceneError: for an unknown name.
    """
    names = chosen(engines, [one.name for one in SURVEYED], "engine")
    there = [one for one in installed() if one.name in names]
    rows: list[Bounces] = []
    for one in there:
        runner = engine(one.first)
        for asked in ASKED:
            for contact in CONTACTS:
                if progress is not None:
                    progress(f"{one.name}, e = {asked}, {contact}")
                rows.append(bounces_of(runner, contact, asked))
    return BounceSurvey({one.name: installed_version(one) for one in there}, tuple(rows))
