"""How fast a ball becomes on an idealised Galton board: certified runs, beside the law that is proved for long times.

    python docs/studies/idealised_board.py    # about two minutes

A ball falls without loss among equal pegs on a triangular lattice that has no end and no free lane. N. Chernov and
D. Dolgopyat, The Galton board: limit theorems and recurrence, J. Amer. Math. Soc. 22, 821 (2009): its speed grows as
t**(1/3), and how far it has fallen as t**(2/3), in the limit of long times. The lattice has mirrors through each column
of pegs: a strip between two of them, whose sides reflect the ball's middle, gives the heights and speeds of the whole.

What is held against it besides, for times that can be afforded: while the speed v changes little from peg to peg, the
height diffuses by D v, where D is the diffusion along y of a ball of speed 1 without gravity, and what volume of phase
space each height has does not depend on it (in the plane). So d<f>/dt = <d/dh (D v df/dh)> with v**2 = 2 g h, and for
f = v**3 the right side is the constant 6 g**2 D: <v**3> grows linearly, from any speed at first.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

from truebreak.exact import ExactEngine
from truebreak.scenarios.catalogue.scene_entry import Draw
from truebreak.scenarios.scene import Scene
from truebreak.scenarios.things import Circle, Wall

if TYPE_CHECKING:
    from numpy.typing import NDArray

ROW = Fraction(7, 4)
"""How far a row is below the one before; pegs of a row are 2 apart."""

PEG, BALL = Fraction(2, 5), Fraction(1, 2)
"""Radii. Pegs that stop the ball's middle at 9/10 leave no lane free: from 7/8, half of `ROW`, on."""

GRAVITY, SPEED = 10, 6
"""Of the boards; the speed at first."""

TIMES = (2.5, 5.0, 10.0, 20.0, 40.0)
FREE = (10.0, 40.0)
"""Times at which balls are looked at; the growth of squares between the two of `FREE` gives D."""

FALLEN, LEVEL = range(-45, 4), range(-13, 14)
"""Rows of pegs, upwards, under gravity, where 2 above the start is beyond a ball's energy, and without."""

SURE = 1.96
"""Standard errors on each side of an interval of 95 %."""


def board(draw: Draw, speed: int, gravity: int, rows: range) -> Scene:
    """A ball between two rows, and a column of pegs on each side of it, in turns.

    >>> scene = board(Draw(1), 6, 10, range(-1, 2))
    >>> [(str(peg.x), str(peg.y)) for peg in scene.circles[1:]], scene.circles[0].vx ** 2 + scene.circles[0].vy ** 2
    ([('1', '-7/4'), ('0', '0'), ('1', '7/4')], Quantity('36'))
    """
    x = Fraction(draw.between(450_000, 550_000), 10**6)
    p, q, turns = draw.between(1, 999), draw.between(1, 999), draw.between(0, 3)
    vx, vy = Fraction(speed * (p * p - q * q), p * p + q * q), Fraction(speed * 2 * p * q, p * p + q * q)
    for _ in range(turns):
        vx, vy = -vy, vx
    ball = Circle(x, ROW / 2, r=BALL, vx=vx, vy=vy, id="ball")
    pegs = (Circle(row % 2, ROW * row, r=PEG, fixed=True, id=f"peg {row}") for row in rows)
    sides = [Wall(at, 0, at, 1, id=name) for at, name in ((-BALL, "left"), (1 + BALL, "right"))]
    return Scene([ball, *pegs], sides, gravity=(0, -gravity))


def flown(count: int, seed: int, speed: int, gravity: int, times: Sequence[float]) -> tuple[NDArray[np.float64], int]:
    """Rise and speed of each ball at each time, [ball, time, 2], and the events of all; every run is certified."""
    draw, events = Draw(seed), 0
    rows = FALLEN if gravity else LEVEL
    found = np.empty((count, len(times), 2))
    for row in found:
        run = ExactEngine().run(board(draw, speed, gravity, rows), until=str(times[-1]))
        if not run.certified:
            raise RuntimeError(f"ball is not certified to t = {times[-1]}: {run.stop.message}")
        states = run.sample(times)[:, 0]
        row[:, 0] = states[:, 1] - float(ROW / 2)
        row[:, 1] = np.hypot(states[:, 2], states[:, 3])
        if not ROW * rows[0] < states[-1, 1] < ROW * rows[-1]:  # what leaves never comes back, upwards nor down
            raise RuntimeError(f"ball has left the board by t = {times[-1]}; give it more rows")
        events += len(run.events)
    return found, events


def jackknife(
    balls: NDArray[np.float64], tell: Callable[[NDArray[np.float64]], NDArray[np.float64]]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """What balls say together, and its standard error: every ball is left out once.

    B. Efron, The Jackknife, the Bootstrap and Other Resampling Plans, SIAM (1982).

    >>> value, error = jackknife(np.array([1.0, 2.0, 3.0]), lambda balls: balls.mean(0))
    >>> float(value), round(float(error), 6), round(1 / 3**0.5, 6)
    (2.0, 0.57735, 0.57735)
    """
    without = np.array([tell(np.delete(balls, k, axis=0)) for k in range(len(balls))])
    return tell(balls), without.std(axis=0) * (len(balls) - 1) ** 0.5


def growth(speeds: NDArray[np.float64]) -> NDArray[np.float64]:
    """By how much the mean of v**3 has grown, at each time."""
    grown: NDArray[np.float64] = (speeds**3).mean(axis=0) - SPEED**3
    return grown


def slope(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """The power of the time that values at `TIMES` grow as, by least squares of logarithms.

    >>> round(float(slope(np.array(TIMES) ** 0.5)), 9)
    0.5
    """
    return np.array(np.polyfit(np.log(TIMES), np.log(values), 1)[0])


def table(balls: int, free: int) -> Iterator[str]:
    """The table and what follows from it, line by line."""
    rows, events = flown(balls, 1, SPEED, GRAVITY, TIMES)
    speeds, times = rows[..., 1], np.array(TIMES)
    yield f"{balls} balls, certified, {events / balls:,.0f} events each; standard errors"
    yield "| t | mean speed | mean fall | growth of the mean of v**3, over t |\n|---|---|---|---|"
    columns = (
        jackknife(speeds, lambda v: v.mean(axis=0)),
        jackknife(-rows[..., 0], lambda fall: fall.mean(axis=0)),
        jackknife(speeds, lambda v: growth(v) / times),
    )
    for k, t in enumerate(TIMES):
        cells = (f"{value[k]:.{n}f} +- {error[k]:.{n}f}" for (value, error), n in zip(columns, (2, 1, 0), strict=True))
        yield f"| {t:g} | {' | '.join(cells)} |"
    for name, tell in (
        ("of the cube root of that growth", lambda v: slope(growth(v)) / 3),
        ("of the mean speed itself", lambda v: slope(v.mean(axis=0))),
    ):
        value, error = jackknife(speeds, tell)
        yield f"exponent {name}: {value:.3f}, 95 % {value - SURE * error:.3f} to {value + SURE * error:.3f}"
    spread, _ = flown(free, 2, 1, 0, FREE)
    value, error = jackknife(spread[..., 0], lambda rise: np.array(np.diff((rise**2).mean(axis=0))[0]))
    d, unsure = value / 2 / (FREE[1] - FREE[0]), error / 2 / (FREE[1] - FREE[0])
    form = f"6 g**2 D = {6 * GRAVITY**2 * d:.0f} +- {6 * GRAVITY**2 * unsure:.0f}"
    yield f"without gravity, {free} balls: D = {d:.3f} +- {unsure:.3f}, {form}"


def main(arguments: Sequence[str] | None = None) -> int:
    """The command line."""
    parser = argparse.ArgumentParser(
        prog="python docs/studies/idealised_board.py", description=(__doc__ or "").partition("\n")[0]
    )
    parser.add_argument("--balls", type=int, default=100, help="under gravity (%(default)s)")
    parser.add_argument("--free", type=int, default=1500, help="without it (%(default)s)")
    options = parser.parse_args(arguments)
    if min(options.balls, options.free) < 2:
        parser.error("--balls, --free: two at least; one ball has no standard error")
    for line in table(options.balls, options.free):
        print(line, flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
