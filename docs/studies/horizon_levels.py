"""Measures at which hazard engines leave the history, over one set of scenes, and writes `levels.py`.

`python docs/studies/horizon_levels.py` runs the set and writes the file; `--check` compares only;
`--test N` says how often the band of the file holds in N other scenes, `--test N --foreign` in N scenes of other kinds
than those that are measured, and for other engines.
"""

from __future__ import annotations

import argparse
import random
import sys
from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction
from pathlib import Path

import numpy as np

from truebreak.compare.chaos.horizon import Forecaster
from truebreak.compare.engines import engine as engine_named
from truebreak.compare.tangent.hazard import ErrorModel
from truebreak.compare.tangent.impacts import impacts
from truebreak.exact.exact_engine import ExactEngine
from truebreak.scenarios import catalogue

FILE = Path(__file__).resolve().parents[2] / "compare" / "chaos" / "levels.py"

CALIBRATED = range(1000, 1100)
"""Seeds of the scenes that are measured; those of tests lie outside."""

EVENTS = 300

ENGINES = ("single", "double", "interval", "interval:bits=100", "pymunk:dt=1/64", "pymunk:dt=1/1024")

FOREIGN = ("rounded:bits=16", "rounded:bits=36", "quad", "interval:bits=36", "pymunk:dt=1/256")
"""Engines that the levels were not measured with."""

SHARES = (0.05, 0.5, 0.95)


def spec(seed: int) -> str:
    """The catalogue scene of a seed: mostly gases of 2 to 12 discs, wide or dense, and single balls among scatterers.

    >>> spec(1000), spec(1001)
    ('point:vx=157/200,vy=439/500,size=4', 'point:vx=439/500,vy=439/500,size=5')
    """
    draw = random.Random(seed)
    kind = draw.choice(["gas"] * 5 + ["mixed"] * 2 + ["dense"] * 2 + ["lorentz", "point"] * 2)
    n = draw.randint(2, 12)
    vx, vy = Fraction(draw.randint(100, 999), 1000), Fraction(draw.randint(100, 999), 1000)
    if kind == "lorentz":
        return f"lorentz:vx={vx},vy={vy},r={draw.choice(['0', '1/4', '1/2'])}"
    if kind == "point":
        return f"point:vx={vx},vy={vy},size={draw.randint(4, 9)}"
    if kind == "dense":
        n = max(n, 3)
        return f"gas:n={n},seed={seed},size={int((10 * n) ** 0.5) + 2}"
    return f"gas:n={n},seed={seed}" + (",mixed=yes" if kind == "mixed" else "")


def foreign_spec(seed: int) -> str:
    """A scene of a kind that the levels were not measured on: racks, many discs, few discs, foldings, heavy and light.

    >>> foreign_spec(2), foreign_spec(3)
    ('gas:n=7,mixed=yes,seed=2', 'hexagon:d=4,vx=9/25,vy=111/1000')
    """
    draw = random.Random(f"foreign {seed}")
    kind = draw.choice(("rack", "many", "tight", "hexagon", "two-in-a-box", "mixed"))
    vx, vy = Fraction(draw.randint(100, 999), 1000), Fraction(draw.randint(100, 999), 1000)
    return {
        "rack": f"rack:rows={draw.randint(2, 4)},jitter=1/1000,gap=1/100,seed={seed},pockets=no",
        "many": f"gas:n={draw.randint(16, 40)},seed={seed}",
        "tight": f"gas:n=2,size={draw.randint(5, 6)},seed={seed}",
        "hexagon": f"hexagon:d={draw.choice(('21/10', '5/2', '4'))},vx={vx},vy={vy}",
        "two-in-a-box": f"two-in-a-box:seed={seed}",
        "mixed": f"gas:n={draw.randint(3, 16)},mixed=yes,seed={seed}",
    }[kind]


def forecasters(specs: Iterable[str]) -> Iterator[Forecaster]:
    """Scenes, each with its certified run."""
    for text in specs:
        run = ExactEngine().run(catalogue.build(text), events=EVENTS)
        yield Forecaster(run, impacts(run, len(run.events)))


def measured(seeds: range) -> dict[str, tuple[float, float, float]]:
    """The levels of each model over the scenes of some seeds.

    An engine that leaves at event D lies inside a band from `low` to `high` if the hazard at D is `low` at least, and
    that at the event before below `high`; so the ends are quantiles of these two. It is foreseen too late where the
    hazard at D is below the middle level, and too early where that at the event before is not: as many are the one as
    are the other at the median of both together. (The hazard grows by leaps, and engines leave at these; the median of
    the first alone is late.)
    """
    at: dict[ErrorModel, list[float]] = {model: [] for model in ErrorModel}
    before: dict[ErrorModel, list[float]] = {model: [] for model in ErrorModel}
    for forecaster in forecasters(map(spec, seeds)):
        for name in ENGINES:
            engine = engine_named(name)
            horizon = forecaster.foresee(name, engine)
            seen = None if horizon is None else forecaster.watch(horizon, engine)
            if horizon is None or seen is None or seen.place is None or seen.place.event is None:
                continue
            hazard, event = forecaster.curve(horizon.model).hazard(horizon.unit), seen.place.event
            at[horizon.model].append(float(hazard[event]))
            before[horizon.model].append(float(hazard[event - 1]) if event else -1e3)
    return {
        model.name: (
            round(float(np.quantile(at[model], SHARES[0])), 2),
            round(float(np.quantile(at[model] + before[model], SHARES[1])), 2),
            round(float(np.quantile(before[model], SHARES[2])), 2),
        )
        for model in ErrorModel
    }


def held(specs: Iterable[str], engines: Sequence[str] = ENGINES) -> dict[str, tuple[int, int]]:
    """For each engine: in how many scenes it left inside the band, and in how many it left at all."""
    told: dict[str, tuple[int, int]] = dict.fromkeys(engines, (0, 0))
    for forecaster in forecasters(specs):
        for name in engines:
            engine = engine_named(name)
            horizon = forecaster.foresee(name, engine)
            if horizon is None or (seen := forecaster.watch(horizon, engine)) is None or seen.place is None:
                continue
            inside, left = told[name]
            told[name] = (inside + horizon.holds(seen.place), left + 1)
    return told


def late_by(specs: Iterable[str], name: str) -> list[int]:
    """By how many events one engine leaves before it is foreseen to; a run's end stands for what is beyond it."""
    found: list[int] = []
    for forecaster in forecasters(specs):
        engine = engine_named(name)
        horizon = forecaster.foresee(name, engine)
        if horizon is None or (seen := forecaster.watch(horizon, engine)) is None or seen.place is None:
            continue
        expected, event = horizon.expected.event, seen.place.event
        if event is not None:
            found.append((len(forecaster.struck) if expected is None else expected) - event)
    return found


def text(levels: dict[str, tuple[float, float, float]]) -> str:
    """The whole text of `levels.py`."""
    rows = "".join(f'    "{name}": {ends},\n' for name, ends in levels.items())
    return f'''"""Levels of the hazard at which engines left the history: 5, 50 and 95 in a hundred, by error model.

Generated by `python docs/studies/horizon_levels.py`, from {len(CALIBRATED)} scenes and {len(ENGINES)} engines.
"""

LEVELS = {{
{rows}}}
'''


def main(arguments: list[str] | None = None) -> int:
    """Measures and writes, checks, or tests; the exit status."""
    parser = argparse.ArgumentParser(prog="python docs/studies/horizon_levels.py", description=__doc__)
    parser.add_argument("--check", action="store_true", help="write nothing; exit with 1 if the file is not current")
    parser.add_argument("--test", type=int, metavar="N", help="say how often the band holds in N other scenes")
    parser.add_argument("--first", type=int, default=0, metavar="SEED", help="of these other scenes (0)")
    parser.add_argument("--foreign", action="store_true", help="other kinds of scenes, and other engines")
    options = parser.parse_args(arguments)
    if options.test is not None:
        seeds = range(options.first, options.first + options.test)
        if options.foreign:
            told = held(map(foreign_spec, seeds), FOREIGN)
        else:
            told = held(map(spec, (seed for seed in seeds if seed not in CALIBRATED)))
        for name, (inside, left) in told.items():
            print(f"{name}: {inside} of {left}")
        inside, left = (sum(pair[k] for pair in told.values()) for k in (0, 1))
        print(f"all: {inside} of {left}, {inside / left:.3f}")
        return 0
    written = text(measured(CALIBRATED))
    if options.check:
        return 0 if FILE.read_text(encoding="utf-8") == written else 1
    FILE.write_text(written, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
