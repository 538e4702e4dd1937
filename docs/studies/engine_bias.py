"""Does floating point change statistics? Ensembles in few bits compared with certified ones of the same starts.

`python docs/studies/engine_bias.py` runs the ladder of engines; its tables go to the screen, and with `--page` to
docs/statistics.md. `--picture docs/echo.svg` draws Boltzmann's H of a gas that is turned back.
"""

from __future__ import annotations

import argparse
import math
import re
import sys
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from statistics import NormalDist, fmean, stdev
from typing import TYPE_CHECKING

import averages

from truebreak.compare.chaos.spectrum import spectrum
from truebreak.compare.engines import engine as engine_named
from truebreak.compare.foreign.guard import run_guarded
from truebreak.compare.report.charts import Curve, plot
from truebreak.compare.report.pictures.sweep_plots import standalone
from truebreak.compare.tangent.impacts import NoTangentMap, impacts
from truebreak.compare.writing import write_whole
from truebreak.exact.exact_engine import ExactEngine
from truebreak.scenarios import catalogue
from truebreak.scenarios.engine import DEFAULT_EVENTS
from truebreak.scenarios.errors import SceneError
from truebreak.scenarios.numbers.quantity import Quantity
from truebreak.scenarios.things import Circle
from truebreak.scenarios.trajectory import StopReason

if TYPE_CHECKING:
    from truebreak.scenarios.engine import Engine
    from truebreak.scenarios.scene import Scene
    from truebreak.scenarios.trajectory import Trajectory

CELLS = 8
"""Cells of speed, each of which holds the same share of discs in equilibrium."""


def h_value(speeds: Sequence[tuple[float, float]]) -> float:
    """The sum of f ln(f) over the cells, f the share of discs in a cell by that of equilibrium: 0 there, else above.

    In equilibrium v**2 is distributed exponentially about its mean (Maxwell, in the plane), so that
    exp(-v**2 / mean) is uniform.

    Args:
        speeds: (vx, vy) of discs of equal mass.

    >>> round(h_value([(1.0, 0.0)] * 100), 4) == round(math.log(CELLS), 4)
    True
    """
    squares = [vx * vx + vy * vy for vx, vy in speeds]
    mean = sum(squares) / len(squares)
    cells = Counter(min(CELLS - 1, int(CELLS * math.exp(-square / mean))) for square in squares)
    shares = [count / len(squares) for count in cells.values()]
    return sum(share * math.log(share * CELLS) for share in shares)


def h_curve(run: Trajectory, points: int) -> list[tuple[float, float]]:
    """(time, H) at so many times of a run, from 0 to its end."""
    end = float(run.final_time)
    times = [min(end, end * k / (points - 1)) for k in range(points)]
    return [(time, h_value([(float(vx), float(vy)) for vx, vy in rows]))
            for time, rows in zip(times, run.sample(times)[:, :, 2:], strict=True)]  # fmt: skip


def h_returned(run: Trajectory) -> float:
    """By how much H at the end of a run is above or below what it was at the start.

    >>> from truebreak.exact import ExactEngine
    >>> from truebreak.scenarios import catalogue
    >>> h_returned(ExactEngine().run(catalogue.build("echo:rows=3,after=20")))
    0.0
    """
    states = [run.at(time).array()[:, 2:] for time in (0, run.final_time)]
    first, last = (h_value([(float(vx), float(vy)) for vx, vy in rows]) for rows in states)
    return last - first


@dataclass(frozen=True)
class Measured:
    """A quantity, as the page on statistics names it before anything is run.

    Attributes:
        name: on the page and in tables.
        margin: a bias of less than this share (or, of H, of its first value) does no harm.
        count: how many starts.
        scenes: the first N of the ensemble.
        until: the time until which each runs; None: to the end of its own.
        tell: its value in one run; None where the run does not tell.
    """

    name: str
    margin: float
    count: int
    scenes: Callable[[int], Sequence[Scene]]
    until: int | None
    tell: Callable[[Trajectory], float | None]


def _rate(run: Trajectory) -> float | None:
    time = float(run.final_time)
    return len(averages.met(run)) / time if time > 0 else None


def _exponent(run: Trajectory) -> float | None:
    try:
        return spectrum(run.scene, impacts(run, len(run.events)), 1).per_time().value if run.events else None
    except NoTangentMap:
        return None


def _bounces(run: Trajectory) -> float | None:
    return float(len(averages.met(run))) if run.stop.reason is StopReason.QUIET else None


def _points(count: int) -> list[Scene]:
    return [catalogue.build(f"point:size=1,disc=1/5,{way}") for way in averages.directions(count, 11)]


def _boxes(count: int) -> list[Scene]:
    return [catalogue.build(f"two-in-a-box:seed={seed}") for seed in range(2001, 2001 + count)]


def _hexagons(count: int) -> list[Scene]:
    return [catalogue.build(f"hexagon:d=21/10,{way}") for way in averages.directions(count, 13)]


@cache
def _escapes(count: int) -> list[Scene]:
    """Starts that hit a disc at all: the others tell nothing of escape."""
    found: list[Scene] = []
    seed = 3001
    while len(found) < count:
        scene = catalogue.build(f"three-disc:distance=5/2,seed={seed}")
        if ExactEngine().run(scene, events=1).events:
            found.append(scene)
        seed += 1
    return found


WINDOW = Quantity.of("10**-6")
"""Width of the window of directions from which escape is watched: the tangent of half an angle."""

LONG_LIVED = 12
"""Bounces of the start about which the window lies."""


@cache
def _window(count: int) -> list[Scene]:
    """Starts in a narrow window of directions about one that stays long."""
    seed = 4001
    while len(ExactEngine().run(catalogue.build(f"three-disc:distance=5/2,seed={seed}")).events) < LONG_LIVED:
        seed += 1
    scene = catalogue.build(f"three-disc:distance=5/2,seed={seed}")
    ball, *discs = scene.circles
    found: list[Scene] = []
    for k in range(count):
        t = WINDOW * (2 * k - count + 1) / (2 * count)
        c, s = (1 - t * t) / (1 + t * t), 2 * t / (1 + t * t)
        turned = Circle(ball.x, ball.y, ball.r, c * ball.vx - s * ball.vy, s * ball.vx + c * ball.vy, m=ball.m,
                        id=ball.id, point=True)  # fmt: skip
        found.append(scene.with_changes(circles=[turned, *discs]))
    return found


def _echoes(count: int) -> list[Scene]:
    return [catalogue.build(f"echo:rows=5,after=60,seed={seed}") for seed in range(5001, 5001 + count)]


QUANTITIES = (
    Measured("hits of the disc a unit of time (free path)", 0.10, 160, _points, 120, _rate),
    Measured("meetings of two discs a unit of time", 0.10, 160, _boxes, 40, _rate),
    Measured("Lyapunov exponent of the Lorentz gas", 0.05, 80, _hexagons, 40, _exponent),
    Measured("bounces before escape (escape rate)", 0.10, 400, _escapes, None, _bounces),
    Measured("bounces before escape, from a narrow window", 0.10, 200, _window, None, _bounces),
    Measured("H after a reversal, less H at the start", 0.05, 40, _echoes, None, h_returned),
)
"""In the order of the hypotheses."""


LEVEL = 0.05
"""Of each test, before it is shared out among all tests of a table."""

LOST = 0.05
"""Share of runs that an ensemble may lose: with more, what is left is no sample of it."""

MORE_EVENTS = 10
"""A run with so many times the events of the certified one has stuck: it no longer gets on in time."""

ENDS = (StopReason.HORIZON, StopReason.QUIET)
"""Of a run that tells something."""

NORMAL = NormalDist()


@dataclass(frozen=True)
class Ensemble:
    """One quantity over the scenes of an ensemble.

    Attributes:
        values: for each scene; None where the run is lost: it stuck, or was refused.
        endless: how many of the lost ones stopped by themselves, in rounds without end.
    """

    values: tuple[float | None, ...]
    endless: int = 0

    @property
    def lost(self) -> int:
        """Runs that tell nothing."""
        return sum(value is None for value in self.values)


@dataclass(frozen=True)
class Bias:
    """How far an engine's ensemble is from the certified one.

    Attributes:
        value: mean of the differences, start by start.
        error: its standard error.
        margin: what does no harm, in the quantity's own unit.
        lost: runs that tell nothing.
        endless: those of them that stopped by themselves, in rounds without end.
        runs: all of them.
        p_differs: of no bias at all, by the mean's normal distribution.
        p_harms: of a bias of the margin or more, of either sign (two one-sided tests, Schuirmann 1987).
    """

    value: float
    error: float
    margin: float
    lost: int
    endless: int
    runs: int
    p_differs: float
    p_harms: float

    def verdict(self, tests: int) -> str:
        """`unharmed` (the bias is proved to be below the margin), `biased` (it is proved not to be nothing), both, or
        `not told`; each at the level shared out among so many tests (Bonferroni). `runs lost` comes first, and excludes
        `unharmed`."""
        level, lost = LEVEL / tests, self.lost > LOST * self.runs
        words = ["runs lost"] if lost else ["unharmed"] if self.p_harms < level else []
        words += ["biased"] if self.p_differs < level else []
        return ", ".join(words) or "not told"


def bias(exact: Ensemble, other: Ensemble, margin: float) -> Bias:
    """The bias of an ensemble against the certified one of the same starts.

    >>> told = bias(Ensemble((1.0, 2.0, 3.0, 4.0)), Ensemble((1.1, 2.2, 3.1, 4.2)), 1.0)
    >>> round(told.value, 3), told.verdict(1)
    (0.15, 'unharmed, biased')
    """
    pairs = [(a, b) for a, b in zip(exact.values, other.values, strict=True) if a is not None and b is not None]
    runs = other.lost, other.endless, len(other.values)
    if len(pairs) < 2:
        return Bias(math.nan, math.nan, margin, *runs, 1.0, 1.0)
    gaps = [b - a for a, b in pairs]
    value, error = fmean(gaps), stdev(gaps) / math.sqrt(len(gaps))
    if error == 0:
        return Bias(value, error, margin, *runs, float(value == 0), float(abs(value) >= margin))
    differs = 2 * (1 - NORMAL.cdf(abs(value) / error))
    harms = 1 - NORMAL.cdf((margin - abs(value)) / error)
    return Bias(value, error, margin, *runs, differs, harms)


def power(exact: Ensemble, margin: float, tests: int) -> float:
    """The chance that an unbiased engine is proved unharmed: foreseen from the certified ensemble alone.

    Chaos makes the two runs of a start independent, so a difference scatters by sqrt(2) times what a value does.

    >>> round(power(Ensemble((1.0, 2.0, 3.0, 4.0)), 5.0, 1), 2)
    1.0
    """
    values = [value for value in exact.values if value is not None]
    error = math.sqrt(2 / len(values)) * stdev(values)
    if error == 0:
        return 1.0
    return max(0.0, 2 * NORMAL.cdf(margin / error - NORMAL.inv_cdf(1 - LEVEL / tests)) - 1)


def certified(quantity: Measured, scenes: Sequence[Scene]) -> tuple[Ensemble, list[int]]:
    """The quantity in certified runs, and how many events each has.

    Raises:
        SceneError: if a run is not certified to its end.
    """
    values: list[float | None] = []
    events: list[int] = []
    for scene in scenes:
        run = _run(ExactEngine(), scene, quantity.until, None)
        if not run.certified or run.stop.reason not in ENDS:
            raise SceneError(f"{scene.name!r}: its run is not certified ({run.stop.message})")
        values.append(quantity.tell(run))
        events.append(len(run.events))
    return Ensemble(tuple(values)), events


def approximate(quantity: Measured, scenes: Sequence[Scene], events: Sequence[int], name: str) -> Ensemble:
    """The quantity in an engine's runs of the same starts; a run that sticks tells nothing.

    Raises:
        SceneError: for an engine that there is not.
    """
    engine = engine_named(name)
    values: list[float | None] = []
    endless = 0
    for scene, count in zip(scenes, events, strict=True):
        most = MORE_EVENTS * max(count, MORE_EVENTS)
        try:
            run = _run(engine, scene, quantity.until, most)
        except SceneError:
            values.append(None)
            continue
        endless += run.stop.reason is StopReason.BUDGET
        value = quantity.tell(run) if run.stop.reason in ENDS else None
        values.append(value if value is not None and math.isfinite(value) else None)
    return Ensemble(tuple(values), endless)


def _run(engine: Engine, scene: Scene, until: int | None, events: int | None) -> Trajectory:
    """A run to a time; or, without one, to its quiet end or its return; with at most so many events."""
    if scene.reverse_after is None:
        return run_guarded(
            engine, scene, until=until, events=DEFAULT_EVENTS if until is None and events is None else events
        )
    if events is None:
        return run_guarded(engine, scene)
    turned = run_guarded(engine, scene, events=scene.reverse_after + 1).reversal
    if turned is None:
        raise SceneError(f"{scene.name!r}: engine {engine.name!r} does not turn back")
    return run_guarded(engine, scene, until=2 * float(turned.time), events=events)


HEAD = "| engine | bias | standard error | runs lost | verdict |\n|---|---|---|---|---|\n"


def row(cells: Sequence[str]) -> str:
    """One line of a table.

    >>> row(["double", "+0"])
    '| double | +0 |'
    """
    return f"| {' | '.join(cells)} |"


def figure(value: float, form: str) -> str:
    """A number in a form such as `+.2g`; a dash where there is none, since every run was lost.

    >>> figure(0.0312, "+.2g"), figure(math.nan, "+.2g")
    ('+0.031', '-')
    """
    return "-" if math.isnan(value) else format(value, form)


def placed(page: str, number: int, told: str, rows: Mapping[str, str], order: Sequence[str]) -> str:
    """The page with new rows in the table of a quantity; rows that are not new stay.

    Args:
        page: all of it.
        number: of the quantity.
        told: the paragraph above the table, without the number.
        rows: the new rows, by engine.
        order: all engines of the table, in order.

    Raises:
        ValueError: if the page has no such table.

    >>> page = "**1. a**: old.\\n\\n" + HEAD + "| single | 1 |\\n| double | 2 |\\n\\nmore\\n"
    >>> page = placed(page, 1, "**a**: new.", {"double": "| double | 3 |"}, ["single", "double"])
    >>> print(page.replace(HEAD, "...\\n"), end="")
    **1. a**: new.
    <BLANKLINE>
    ...
    | single | 1 |
    | double | 3 |
    <BLANKLINE>
    more
    """
    found = re.search(rf"^\*\*{number}\. .*\n\n\|.*\n\|[-|]+\n((?:\|.*\n)*)", page, re.MULTILINE)
    if found is None:
        raise ValueError(f"no table of quantity {number}")
    old = {line.split("|")[1].strip(): line for line in found[1].splitlines()}
    lines = [{**old, **rows}[name] for name in order if name in old or name in rows]
    table = HEAD + "".join(f"{line}\n" for line in lines)
    return f"{page[: found.start()]}{told.replace('**', f'**{number}. ', 1)}\n\n{table}{page[found.end() :]}"


SCENE = "echo:after=1200"

DRAWN = ("exact", "double", "single")

POINTS = 241
"""Points of a curve, an odd number: one of them stands at the moment of the reversal."""


def picture(scene: Scene, engines: Sequence[str] = DRAWN) -> tuple[str, dict[str, float]]:
    """The SVG, and for each engine by how much H at the return is above or below H at the start.

    >>> text, told = picture(catalogue.build("echo:rows=2,after=5"), ["exact"])
    >>> text.startswith("<svg"), told
    (True, {'exact': 0.0})
    """
    curves: list[Curve] = []
    told: dict[str, float] = {}
    for number, name in enumerate(engines):
        run = engine_named(name).run(scene)
        curves.append(Curve(name, h_curve(run, POINTS), f"e{number - 1}" if number else "reference"))
        told[name] = h_returned(run)
    drawn = plot(f"Boltzmann's H of {scene.name}, turned back once", "time", "H", curves)
    return standalone(drawn, list(engines[1:])), told


LADDER = (
    *(f"rounded:bits={bits}" for bits in (8, 10, 12, 16, 20)), "single",
    *(f"rounded:bits={bits}" for bits in (28, 32, 40, 48)), "double", "pymunk:dt=1/256",
)  # fmt: skip
"""The rungs, from 8 bits to 53, and a time-stepped engine."""


def measured(number: int, engines: list[str], count: int | None = None) -> tuple[str, dict[str, str]]:
    """What is said of a quantity's certified ensemble, and the row of each engine, which are printed as they come."""
    quantity, tests = QUANTITIES[number - 1], len(QUANTITIES) * len(LADDER)
    scenes = quantity.scenes(count or quantity.count)
    exact, events = certified(quantity, scenes)
    values = [value for value in exact.values if value is not None]
    mean = sum(values) / len(values)
    margin = quantity.margin * (abs(mean) or math.log(CELLS))
    told = (
        f"**{quantity.name}**: {mean:.4g} in {len(values)} certified runs of {sum(events):,} events; "
        f"margin {margin:.2g}, power {power(exact, margin, tests):.2f}."
    )
    print(f"\n{told.replace('**', f'**{number}. ', 1)}\n\n{HEAD}", end="", flush=True)
    rows: dict[str, str] = {}
    for name in engines:
        found = bias(exact, approximate(quantity, scenes, events, name), margin)
        lost = f"{found.lost}, {found.endless} without end" if found.endless else f"{found.lost}"
        rows[name] = row([name, figure(found.value, "+.2g"), figure(found.error, ".2g"), lost, found.verdict(tests)])
        print(rows[name], flush=True)
    return told, rows


def main(arguments: list[str] | None = None) -> int:
    """Runs and prints; the exit status."""
    parser = argparse.ArgumentParser(prog="python docs/studies/engine_bias.py", description=__doc__)
    parser.add_argument("--scenes", type=int, help="starts of each ensemble, in place of its own number")
    parser.add_argument("--only", type=int, action="append", choices=range(1, len(QUANTITIES) + 1), metavar="K",
                        help="only quantity K, from 1 on")  # fmt: skip
    parser.add_argument("--engines", default=",".join(LADDER), help="the ladder")
    parser.add_argument("--picture", metavar="FILE", help=f"draw H of {SCENE} into this file, and nothing else")
    parser.add_argument("--page", help="put the rows into the tables of this page, such as docs/statistics.md")
    options = parser.parse_args(arguments)
    if options.picture:
        text, returned = picture(catalogue.build(SCENE))
        write_whole(options.picture, text)
        for name, value in returned.items():
            print(f"{name}: H at the return less H at the start: {value:+.4f}")
        return 0
    engines = options.engines.split(",")
    if options.page and (options.scenes or not set(engines) <= set(LADDER)):
        parser.error("--page: the page has its own numbers of starts and its own ladder")
    for number in options.only or range(1, len(QUANTITIES) + 1):
        try:
            told, rows = measured(number, engines, options.scenes)
        except SceneError as error:
            parser.error(str(error))
        if options.page:
            page = Path(options.page).read_text(encoding="utf-8")
            write_whole(options.page, placed(page, number, told, rows, LADDER))
    return 0


if __name__ == "__main__":
    sys.exit(main())
