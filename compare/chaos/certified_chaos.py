"""Chaos along one certified run: growth, exponents, and the horizon of each engine."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from ...exact.exact_engine import ExactEngine
from ...scenarios.errors import SceneError
from ..deadline import uninterrupted
from ..engines import engine as engine_named
from ..tangent.growth import CertifiedGrowth, Displacements, certified_growth, in_doubles, unit_displacements
from ..tangent.impacts import NoTangentMap, impacts
from ..validation import check_engine
from .horizon import Forecaster, Horizon
from .spectrum import Spectrum, spectrum

if TYPE_CHECKING:
    from ...scenarios.engine import Engine
    from ...scenarios.scene import Scene
    from ...scenarios.trajectory import OnProgress, Trajectory
    from ..tangent.impacts import Impact

DEFAULT_ENGINES = ("single", "double", "quad", "interval", "pymunk")

WHOLE_MAP = 160
"""Coordinates up to which the whole tangent map is carried, in doubles and in balls: forty discs."""

POINTS = 200
"""Points of the curve of growth: as many as a plot of ordinary width can show apart."""


@dataclass(frozen=True)
class Grown:
    """By how many bits displacements of time 0 have grown just after an event."""

    event: int
    time: float
    bits: float


@dataclass(frozen=True)
class Chaos:
    """What one certified run says of chaos.

    Attributes:
        scene, reference: what was run, and the certified run.
        events: how many of its events were taken.
        growth: the growth of errors over time, in doubles: the norm of the tangent map from time 0 on; of a scene
            with more than `WHOLE_MAP` coordinates, that of one displacement.
        certified: that norm at the end, enclosed; None for so large a scene.
        spectrum: Lyapunov exponents: estimates, since one orbit certifies no limit.
        horizons: where each engine is expected to diverge.
        exact: engines that have no horizon, as their numbers are exact.
    """

    scene: Scene
    reference: Trajectory = field(repr=False)
    events: int
    growth: tuple[Grown, ...] = field(repr=False)
    certified: CertifiedGrowth | None
    spectrum: Spectrum = field(repr=False)
    horizons: tuple[Horizon, ...]
    exact: tuple[str, ...] = ()

    @property
    def time(self) -> float:
        """The time of the last event."""
        return float(self.spectrum.times[-1])


def chaos(
    scene: Scene,
    engines: Sequence[str | Engine] | str = DEFAULT_ENGINES,
    *,
    events: int | None = None,
    exponents: int | None = None,
    run: bool = True,
    progress: OnProgress | None = None,
) -> Chaos:
    """Measures chaos along the certified run of a scene, and foresees how long engines can be trusted.

    Args:
        engines: whose horizons are foreseen: names as in `compare`, or engines.
        events: how many; by default as many as the scene's own limit.
        exponents: how many Lyapunov exponents; by default all, or the largest of a scene of many discs.
        run: whether the engines are run too, to show what happens beside what was foreseen.
        progress: called now and then with how far the certified run is.

    Raises:
        SceneError: for a scene without collisions, for one whose run has no tangent map, and for an unknown engine.

    >>> from truebreak.scenarios import catalogue
    >>> told = chaos(catalogue.build("gas:n=4"), ["double"], events=120)
    >>> told.spectrum.per_time().value > 0, told.horizons[0].holds(told.horizons[0].seen.place)
    (True, True)
    """
    if exponents is not None and exponents < 1:
        raise SceneError(f"exponents = {exponents}: must be a whole number from 1")
    names: list[str | Engine] = [engines] if isinstance(engines, str) else list(engines)
    chosen = [(e if isinstance(e, str) else e.name, check_engine(engine_named(e) if isinstance(e, str) else e))
              for e in names]  # fmt: skip
    reference = uninterrupted(ExactEngine().run(scene, events=events, progress=progress))
    struck = mapped(reference, len(reference.events))
    rough = [[in_doubles(impact) for impact in event] for event in struck]
    found = spectrum(scene, rough, exponents)
    forecaster, rate = Forecaster(reference, rough), found.per_time().value if found.chaotic else 0.0
    horizons: list[Horizon] = []
    exact: list[str] = []
    for label, engine in chosen:
        horizon = forecaster.foresee(label, engine, rate)
        if horizon is None:
            exact.append(label)
        else:
            horizons.append(replace(horizon, seen=forecaster.watch(horizon, engine)) if run else horizon)
    whole = found.dimension <= WHOLE_MAP
    return Chaos(
        scene,
        reference,
        len(struck),
        tuple(_growth(scene, rough, found, whole)),
        certified_growth(reference, len(struck), struck) if whole and reference.certified else None,
        found,
        tuple(horizons),
        tuple(exact),
    )


def mapped(trajectory: Trajectory, events: int) -> list[list[Impact]]:
    """The impacts of a run; what it lacks is told as an error of the scene, with the remedy.

    Raises:
        SceneError: for a run without an event, and where it has no tangent map.
    """
    name = trajectory.scene.name
    if events == 0:
        raise SceneError(f"{name!r}: nothing collides ({trajectory.stop.message}); chaos is measured along collisions")
    if all(circle.fixed for circle in trajectory.scene.circles):
        raise SceneError(f"{name!r}: no circle can move; nothing can be displaced")
    try:
        return impacts(trajectory, events)
    except NoTangentMap as error:
        good = error.events
        remedy = f"; measure it up to there: --events {good}" if good else ""
        raise SceneError(f"{name!r} has no tangent map: {error}{remedy}") from None


def _growth(scene: Scene, struck: Sequence[Sequence[Impact]], found: Spectrum, whole: bool) -> list[Grown]:
    keep = {round((len(struck) - 1) * k / (POINTS - 1)) for k in range(POINTS)}
    if not whole:
        bits = found.gains[:, 0].cumsum() / math.log(2)
        return [Grown(k, float(found.times[k]), float(bits[k])) for k in sorted(keep)]
    carried, told = Displacements(scene, unit_displacements(scene)), []
    for index, event in enumerate(struck):
        carried.through(event)
        if index in keep:
            bits = carried.scale + math.log2(float(np.linalg.norm(carried.matrix, 2)))
            told.append(Grown(index, float(carried.time), bits))
    return told
