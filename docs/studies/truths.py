"""Published numbers, reproduced: `python docs/studies/truths.py docs/truths.md` measures them and writes the page."""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from itertools import takewhile
from pathlib import Path

import averages
import pinball

from truebreak.compare.chaos.horizon import follow
from truebreak.compare.chaos.spectrum import spectrum
from truebreak.compare.engines import engine
from truebreak.compare.orders.all_orders import all_orders
from truebreak.compare.tangent.growth import Displacements, certified_growth, unit_displacements
from truebreak.compare.tangent.impacts import impacts
from truebreak.compare.writing import check_writable, write_whole
from truebreak.exact.exact_engine import ExactEngine
from truebreak.exact.numbers import ball
from truebreak.scenarios import catalogue
from truebreak.scenarios.catalogue.article import EE_AND_LEE, MURPHY
from truebreak.scenarios.catalogue.billiard_tables import CHALLENGE, FOLDED, IN_A_BOX, PINBALL
from truebreak.scenarios.errors import SceneError
from truebreak.scenarios.numbers.quantity import Quantity
from truebreak.scenarios.scene import Scene
from truebreak.scenarios.settings import TiePolicy
from truebreak.scenarios.things import Circle, Wall

OURS = "none: measured by this project before"
"""The source of a number that others have not published."""

ERRORS = 3.0
"""Standard errors that an estimate may be off: one in 370 is, by chance, where errors are distributed normally."""

Measured = tuple[str, str]
"""What came out, as text, and its difference from what is published."""


@dataclass(frozen=True)
class Truth:
    """A published number.

    Attributes:
        title: what it is of.
        published: the number, as text.
        source: where it is printed.
        command: what shows it, or the run that it comes from.
        measure: gives what comes out here, and the difference. It raises `NotReproduced` if that is more than allowed.
        long: whether that takes more than a few seconds.
    """

    title: str
    published: str
    source: str
    command: str
    measure: Callable[[], Measured]
    long: bool = False


def only(words: str) -> str:
    """The command that measures the truths in whose title these words are.

    >>> only("onto two")
    'python docs/studies/truths.py --only "onto two"'
    """
    return f'python docs/studies/truths.py --only "{words}"'


class NotReproduced(AssertionError):
    """What came out is not what is published."""


def same(ours: str, published: str) -> Measured:
    """Equal, letter by letter.

    Raises:
        NotReproduced: if they are not.

    >>> same("4", "4")
    ('4', 'none')
    """
    if ours != published:
        raise NotReproduced(f"{ours} is not {published}")
    return ours, "none"


def within(value: float, error: float, published: float, room: float, stated: float = 0.0, digits: int = 4) -> Measured:
    """An estimate no farther off than three standard errors, its own and the one that is stated with the number.

    Args:
        error: the standard error of the estimate; it may be `room` of the number at most, else it would say nothing.
        stated: the share by which what is published may be off.

    Raises:
        NotReproduced: if the error is larger, or the estimate is farther off.

    >>> within(1.02, 0.01, 1.0, 0.05)
    ('1.020 +- 0.010', '+2.0 % (2.0 errors)')
    """
    if error > room * abs(published):
        raise NotReproduced(f"the standard error {error:.3g} is more than {room:.1%} of {published:.10g}")
    scale = math.hypot(error, stated * published)
    off = (value - published) / scale
    if abs(off) > ERRORS:
        raise NotReproduced(
            f"{value:.10g} is {off:+.1f} standard errors off {published:.10g}, and {ERRORS:g} are allowed"
        )
    places = digits - 1 - math.floor(math.log10(abs(value)))
    share = f"{value / published - 1:+.1%}".replace("%", " %")
    return f"{value:.{places}f} +- {error:.{places}f}", f"{share} ({abs(off):.1f} errors)"


def near(ours: float, published: float, room: float, digits: int = 5, error: float | None = None) -> Measured:
    """Within a share of the published number.

    Args:
        error: the standard error, to be told beside an estimate.

    Raises:
        NotReproduced: if it is farther off.

    >>> near(1.02, 1.0, 0.05)
    ('1.02', '+2.0 %')
    """
    share = ours / published - 1
    if abs(share) > room:
        raise NotReproduced(f"{ours:.10g} is {share:+.2%} off {published:.10g}, and {room:.2%} is allowed")
    told = "none" if share == 0 else f"{share:+.1%}".replace("%", " %") if abs(share) >= 5e-4 else f"{share:+.0e}"
    return f"{ours:.{digits}g}" + ("" if error is None else f" +- {error:.2g}"), told


SIAM_DIGITS = "0.9952629194433541608903118094267216210294669227341543498032088580729861796228306"

ESCAPE_RATE = "0.4103384077693464893384613078192"

LETTERS = 12
"""Cycles of so many bounces settle the escape rate of three discs at distance 6 to more digits than are published."""

REPELLER = "python docs/studies/pinball.py"
CHAOSBOOK = (
    "P. Cvitanovic and others, ChaosBook (recalled); the method: P. Cvitanovic, B. Eckhardt, Symmetry decomposition of "
    "chaotic dynamics, Nonlinearity 6 (1993), 277"
)
GALPERIN = "G. Galperin, Playing pool with pi, Regular and Chaotic Dynamics 8 (2003), 375"
IMAGES = "the method of images"
ONTO_TWO = "-1/5, 0; 3/5, 1/5*sqrt(3); 3/5, -1/5*sqrt(3) / -1/8, -1/8*sqrt(3); 3/4, 1/4*sqrt(3); 3/8, -1/8*sqrt(3)"
LEE = "E. A. Lee, Fundamental limits of cyber-physical systems modeling, ACM Trans. Cyber-Phys. Syst. 1 (2016), 3"


def siam(t: int = 10, digits: int = 79) -> str:
    """The photon's distance from the origin at time t, to so many decimals, cut off.

    >>> siam(10, 12)
    '0.995262919443'
    """
    run = ExactEngine().run(catalogue.build("siam", t=t))
    photon = run.final["photon"]
    bits = int((digits + 10) * math.log2(10)) + 64
    with ball.precision(bits):
        x, y = photon.x.ball(bits), photon.y.ball(bits)
        text = (x * x + y * y).sqrt().str(digits + 5, radius=False)
    whole, _, decimals = text.partition(".")
    return f"{whole}.{decimals[:digits]}"


def _siam() -> Measured:
    return same(siam(digits=len(SIAM_DIGITS) - 2), SIAM_DIGITS)


def _galperin() -> Measured:
    counts = [ExactEngine().run(catalogue.build("galperin", n=n)).collisions for n in range(4)]
    return same(", ".join(map(str, counts)), "3, 31, 314, 3141")


def _ratios() -> Measured:
    counts = []
    for ratio in (2, 3, 5, 7, 10, 50):
        circles = [Circle(2, 0, id="small"), Circle(6, 0, r=2, vx=-1, m=ratio, id="big")]
        counts.append(ExactEngine().run(Scene(circles, [Wall(0, 0, 0, 1)])).collisions)
    return same(", ".join(map(str, counts)), "5, 5, 7, 8, 10, 22")


def _onto_two() -> Measured:
    far = Quantity.of("3 + sqrt(3)")
    circles = [Circle(0, 0, vx=1, id="cue"), Circle(far, 1, id="up"), Circle(far, -1, id="down")]
    told: list[str] = []
    for policy in (TiePolicy(), TiePolicy("sequential")):
        run = ExactEngine().run(Scene(circles, tie_policy=policy), events=1)
        told.append("; ".join(f"{c.vx.text()}, {c.vy.text()}" for c in run.final.circles))
    return same(" / ".join(told), ONTO_TWO)


def _magic() -> Measured:
    outcomes = []
    for a in ("1", "sqrt(2) - 1", "sqrt(5) - 2", "1/2", "1/5"):
        tree = all_orders(ExactEngine(), catalogue.build("magic-masses", a=a))
        if not tree.complete:
            raise NotReproduced(f"not all orders were followed for a = {a}")
        outcomes.append(str(len(tree.outcomes)))
    return same(", ".join(outcomes), "1, 1, 1, 2, 2")


def _whole_momentum() -> Measured:
    run = ExactEngine().run(catalogue.build("magic-masses:start=one"))
    ends = ", ".join(str(circle.vx.text()) for circle in run.final.circles)
    return same(f"{run.collisions} collisions, then {ends}", "4 collisions, then 0, 0, 1")


def _free(n: int, collisions: int) -> Measured:
    run = ExactEngine().run(catalogue.build("free-discs", n=n))
    if run.stop.reason.name != "QUIET":
        raise NotReproduced(f"the run is not over: {run.stop.message}")
    return same(str(run.collisions), str(collisions))


def multiplier(scene: str, bounces: int = 40) -> float:
    """The factor by which one bounce more lengthens the worst displacement, along an unstable periodic orbit."""
    run = ExactEngine().run(catalogue.build(scene), events=bounces + 1)
    one, two = (certified_growth(run, events) for events in (bounces, bounces + 1))
    return 2.0 ** ((two.low + two.high - one.low - one.high) / 2)


def _two_discs() -> Measured:
    return near(multiplier("pinball:r=0"), 5 + 2 * math.sqrt(6), 1e-9, 11)


def _triangle() -> Measured:
    told = pinball.orbit(pinball.pinball(Quantity.of(6)), "1")
    with ball.precision(pinball.BITS):
        return same(abs(told.multiplier).str(20, radius=False), "11.771455196385560606")


@cache
def _repeller() -> dict[str, str]:
    """Digits of the repeller's averages, cut off where the last two orders of the cycle expansion part."""
    *_, before, told = pinball.ladder(Quantity.of(6), LETTERS)
    names = ("escape", "exponent", "entropy")
    return {name: pinball.settled(getattr(before, name), getattr(told, name)) for name in names}


def _averages(name: str, published: str) -> Measured:
    """Every published digit; the last may be rounded."""
    ours = _repeller()[name]
    digits = len(published) - 2
    if len(ours) <= len(published):
        raise NotReproduced(f"{ours} has fewer digits than {published}")
    same(str(round(Fraction(ours), digits)), str(Fraction(published)))
    return ours, "none"


def _lee() -> Measured:
    outcomes = all_orders(ExactEngine(), catalogue.build("lee")).outcomes
    ends = sorted(", ".join(str(c.vx.text()) for c in outcome.trajectory.final.circles) for outcome in outcomes)
    return same("; ".join(ends), "-11/5, -8/25, -3/25; -8/5, -39/25, 1/25")


def _corner() -> Measured:
    counts = []
    for angle in (90, 60, 45, 36):
        run = ExactEngine().run(catalogue.build(f"corner:angle={angle},skew=1/10,tie=sequential"))
        impulses = [pair.second for event in run.events for pair in event.impulses]
        counts.append(str(len(list(takewhile(lambda wall: wall != "end", impulses)))))
    return same(", ".join(counts), "2, 3, 4, 5")


EXACT = (
    Truth("SIAM 100-Digit Challenge, problem 2: distance at t = 10", SIAM_DIGITS, CHALLENGE, only("100-Digit"),
          _siam),
    Truth("Galperin: collisions for a mass ratio of 100**n, n = 0 to 3", "3, 31, 314, 3141", GALPERIN,
          "truebreak run galperin:n=2", _galperin),
    Truth("Collisions for mass ratios 2, 3, 5, 7, 10, 50: ceil(pi/arctan(1/sqrt(ratio))) - 1", "5, 5, 7, 8, 10, 22",
          f"{GALPERIN} (recalled)", only("mass ratios"), _ratios),
    Truth("Masses 1, a, 1: outcomes of all orders for a = 1/cos(pi/k) - 1, k = 3, 4, 5, and for a = 1/2, 1/5",
          "1, 1, 1, 2, 2", EE_AND_LEE, "truebreak orders magic-masses", _magic),
    Truth("Masses 1, sqrt(5) - 2, 1: one ball hands on all of its momentum", "4 collisions, then 0, 0, 1",
          OURS, "truebreak run magic-masses:start=one --exact", _whole_momentum),
    Truth("Three equal discs in the open: collisions of a witness", "4", MURPHY, "truebreak run free-discs",
          lambda: _free(3, 4)),
    Truth("Four equal discs in the open: collisions of a witness", "10", OURS,
          "truebreak run free-discs:n=4", lambda: _free(4, 10)),
    Truth("Two fixed discs at distance 6: multiplier of a bounce, 5 + 2 sqrt(6)", "9.8989794856", PINBALL,
          "truebreak chaos pinball:r=0", _two_discs),
    Truth("Three fixed discs at distance 6: multiplier of a bounce on the triangle", "11.771455196385560606", PINBALL,
          only("bounce on the triangle"), _triangle),
    Truth("Three fixed discs at distance 6: escape rate, by cycle expansion", ESCAPE_RATE, CHAOSBOOK, REPELLER,
          lambda: _averages("escape", ESCAPE_RATE)),
    Truth("Three fixed discs at distance 6: mean Lyapunov exponent of the repeller", "0.5775525788", OURS, REPELLER,
          lambda: _averages("exponent", "0.5775525788")),
    Truth("Three fixed discs at distance 6: entropy, the exponent less the escape rate", "0.1672141710", OURS, REPELLER,
          lambda: _averages("entropy", "0.1672141710")),
    Truth("Lee's three balls: final velocities under both orders", "-11/5, -8/25, -3/25; -8/5, -39/25, 1/25", LEE,
          "truebreak orders lee", _lee),
    Truth("A ball onto two that touch: velocities, simultaneous / sequential", ONTO_TWO, OURS, only("onto two"),
          _onto_two),
    Truth("Corner of pi/n: bounces for n = 2, 3, 4, 5", "2, 3, 4, 5", IMAGES,
          "truebreak run corner:angle=60,skew=1/10,tie=sequential", _corner),
)  # fmt: skip
"""Items that hold exactly, or to the last digit of a double."""


CHERNOV = "N. Chernov, Entropy, Lyapunov exponents, and mean free path for billiards, J. Stat. Phys. 88 (1997), 1"
DAHLQVIST = "P. Dahlqvist, Lyapunov exponent of the Sinai billiard, chao-dyn/9601007"
STATED = 0.003
"""Share by which the exponents of the Lorentz gas that were measured before may be off."""

LONG = 16_000
"""Events along which the exponent of the gas is measured."""

SOUGHT = 20_000
"""Certified runs of the experiment on escape."""


def _free_path() -> Measured:
    told = averages.estimate(averages.points(), averages.path)
    return within(told.value, told.error, averages.PATH, 0.015)


def _any_path() -> Measured:
    told = averages.estimate(averages.points(), averages.any_path)
    return within(told.value, told.error, averages.ANY_PATH, 0.015)


def _two_in_a_box() -> Measured:
    told = averages.estimate(averages.boxes(), averages.rate)
    return within(told.value, told.error, averages.two_disc_rate(1.0, 0.1, 0.98), 0.015)


def _sinai(r: str, until: int, room: float) -> Measured:
    told = averages.estimate(averages.sinai(r, until), averages.exponent_per_hit)
    return near(told.value, averages.dahlqvist(float(Fraction(r))), room, 4, told.error)


def _hexagon(d: str, until: int, runs: int, published: float) -> Measured:
    records = averages.recorded((f"hexagon:d={d},{way}" for way in averages.directions(runs, 3)), until, growth=True)
    told = averages.estimate(records, averages.exponent)
    return within(told.value, told.error, published, 0.005, STATED)


def _gas_exponent() -> Measured:
    run = ExactEngine().run(catalogue.build("gas"), events=LONG)
    told = spectrum(run.scene, impacts(run, LONG), 1).per_time()
    assert told.low is not None and told.high is not None
    return within(told.value, (told.high - told.low) / 4, 0.3208, 0.01)


def _gas_growth() -> Measured:
    run = ExactEngine().run(catalogue.build("gas"), events=200)
    carried = Displacements(run.scene, unit_displacements(run.scene)[:, :, :1])
    for index, struck in enumerate(impacts(run, 200)):
        carried.through(struck)
        if carried.scale + math.log2(float((carried.matrix**2).sum())) / 2 >= 53:
            return near(index, 173, 0.05, 4)
    return same("not in 200 events", "173")


def _left(scene: str, published: int) -> Measured:
    told = follow(ExactEngine().run(catalogue.build(scene), events=300), engine("double"))
    assert told.alignment.divergence is not None
    return same(str(told.alignment.divergence.event), str(published))


def _escape() -> Measured:
    told = pinball.escape(Quantity.of(6), SOUGHT)
    return within(told.rate, told.room, float(ESCAPE_RATE), 0.01)


STATISTICAL = (
    Truth("Unit square with a disc of radius 1/5: mean path between hits of anything, pi area/perimeter",
          f"{averages.ANY_PATH:.5f}", CHERNOV, only("hits of anything"), _any_path, True),
    Truth("Unit square with a disc of radius 1/5: mean path between disc hits, area/(2 R)",
          f"{averages.PATH:.5f}", CHERNOV, only("between disc hits"), _free_path, True),
    Truth("Two discs of radius 1/10 in a unit square: how often they meet", "0.485268", IN_A_BOX,
          only("how often they meet"), _two_in_a_box, True),
    *(Truth(f"Sinai billiard, R = {r}: exponent per hit of the disc, up to O(R ln(R)**2)",
            f"{averages.dahlqvist(float(Fraction(r))):.3f}", DAHLQVIST,
            only(f"R = {r}:"), lambda r=r, u=u, room=room: _sinai(r, u, room), True)
      for r, u, room in (("1/5", 100, 0.07), ("1/10", 200, 0.06), ("1/20", 400, 0.05))),
    Truth("Three fixed discs at distance 6: escape rate, by escaping", ESCAPE_RATE, CHAOSBOOK,
          f"{REPELLER} --runs {SOUGHT}", _escape, True),
    *(Truth(f"Triangular Lorentz gas, spacing {d}: exponent per unit time", told, source,
            only(f"spacing {d}:"), lambda d=d, u=until, n=runs, value=value: _hexagon(d, u, n, value), True)
      for d, until, runs, value, told, source in (
          ("21/10", 120, 80, 2.669, "2.669 +- 0.3 %", OURS), ("11/5", 120, 80, 2.105, "2.105 +- 0.3 %", OURS),
          ("2*sqrt(3)", 400, 400, 0.636, "0.636 +- 0.3 %; 0.62 to 0.68", f"{OURS}; {FOLDED}"))),
    Truth("Ten discs in a box: exponent per unit time", "0.3208", OURS,
          f"truebreak chaos gas --events {LONG} --engines none", _gas_exponent, True),
    Truth("Ten discs in a box: the event at which a displacement has grown by 2**53", "173",
          OURS, only("grown by 2**53"), _gas_growth),
    Truth("Ten discs in a box: the event at which doubles diverge", "161", OURS,
          "truebreak compare gas --engines double", lambda: _left("gas", 161)),
    Truth("Two-disc pinball: the bounce at which doubles diverge, predicted 53 ln(2)/ln(5 + 2 sqrt(6)) = 16.03", "16",
          PINBALL, "truebreak compare pinball:r=0 --engines double", lambda: _left("pinball:r=0", 16)),
)  # fmt: skip
"""Items that hold up to the scatter of an ensemble, or up to the next order of an expansion."""


HEAD = """# Published truths, reproduced

Numbers that others have published, and some that this project has measured before, with what comes out now. Every run
that a number is read off is certified; where doubles are judged, it is against such a run. Made by

```sh
python docs/studies/truths.py docs/truths.md
```

which measures all of them, and writes nothing if one does not come out. With `--only WORDS` in place of the file it
prints those in whose title the words are. "Recalled" marks a source that was not available. Ensembles are of
`point:size=1,disc=R`, `two-in-a-box` and `hexagon:d=D`, each from many starts.

"""

COLUMNS = "| what | published | ours | difference | source | to see it |\n|---|---|---|---|---|---|"

TAIL = """
A difference in brackets is in standard errors: that of ours, and that of what was measured before, together.

ChaosBook's figure is quoted from memory: it was looked for in what public text is at hand, twice, and not seen in print
(of Gaspard and Rice, of P. Gaspard and D. Alonso Ramirez, Phys. Rev. A 45 (1992), 8383, and of A. Wirzba,
chao-dyn/9712015, there are the abstracts, without a figure). Ours does not rest on it: the expansion below gives all
of its digits, and six more.

## Three discs

The repeller of the pinball, the starts that never escape, is described by its periodic orbits. Each is proved to
exist, by an interval Newton step, and its multiplier is read off the tangent map of the laws, in balls. What is summed
up over the orbits is an expansion: the digits that the next order does not change are its answer, and no proof.
`python docs/studies/pinball.py` prints

{repeller}

## Beyond what is published

The SIAM photon to 150 digits at t = 10, ours beyond the first 79:

```text
{digits}
```

## Slow convergence

The same runs, cut off at ever later times (`python docs/studies/averages.py`), each estimate with its
standard error:

{convergence}

- A point that flies in a corridor between the copies of the disc meets none for long, and two discs in a box may pass
  each other for long: these times have a heavy tail.
- Dahlqvist's formula is the beginning of an expansion in R: the difference that stays falls with R, and is not one of
  the measurement.

## What cannot be reproduced here

- Periodic boundaries: there is no torus. Where a lattice has mirror lines, walls fold it exactly (`hexagon`).
- Orban and Bellemans' own numbers, and Colonna's 192 and 336 particles: their starts are not at hand. That H returns in
  a certified run and not in floats is shown by a gas of our own: see [statistics](statistics.md).
- Five free discs: no published number was at hand; `free-discs:n=5` collides 15 times, a witness of our own.
- The numbers of Cross's experiment: no source was at hand; `cross` is the scene alone.
"""

PARTS: Mapping[str, Callable[[], str]] = {
    "digits": lambda: siam(10, 150),
    "repeller": lambda: pinball.table(Quantity.of(6), LETTERS),
    "convergence": averages.table,
}
"""What the page has below its first table, each measured by itself."""


def line(truth: Truth) -> str:
    """A row of the table: the truth measured.

    Raises:
        NotReproduced: naming the truth.
    """
    try:
        ours, difference = truth.measure()
    except NotReproduced as error:
        raise NotReproduced(f"{truth.title}: {error}") from None
    return f"| {truth.title} | {truth.published} | {ours} | {difference} | {truth.source} | `{truth.command}` |"


def page() -> str:
    """The whole of docs/truths.md."""
    rows = [*lines((*EXACT, *STATISTICAL))]  # first: what is not reproduced is said before the rest is measured
    return put_together(rows, {name: part() for name, part in PARTS.items()})


def put_together(rows: Iterable[str], parts: Mapping[str, str]) -> str:
    """The page of the rows of its first table, and of the parts below it, by name."""
    table = "\n".join(rows)
    return f"{HEAD}{COLUMNS}\n{table}\n{TAIL.format(**parts)}"


def lines(truths: Sequence[Truth]) -> Iterator[str]:
    """The rows of truths, one after the other; a terminal is told which is being measured."""
    for done, truth in enumerate(truths):
        if sys.stderr.isatty():
            print(f"{done} of {len(truths)} done; {truth.title}", file=sys.stderr)
        yield line(truth)


def main(arguments: list[str] | None = None) -> int:
    """Measures and writes, or checks; the exit status."""
    about = "Measure the published numbers, and write docs/truths.md."
    parser = argparse.ArgumentParser(prog="python docs/studies/truths.py", description=about)
    parser.add_argument("file", nargs="?", help="where to write the page, such as docs/truths.md")
    parser.add_argument("--only", metavar="WORDS", help="print the truths with these words in the title, and no page")
    parser.add_argument("--check", action="store_true", help="write nothing; exit with 1 if the file is not current")
    options = parser.parse_args(arguments)
    if (options.only is None) == (options.file is None):
        parser.error("give a file to write, or --only WORDS")
    try:
        if options.only is not None:
            return _print(options.only)
        if not options.check:
            check_writable(options.file)
        text = page()
    except NotReproduced as error:
        print(f"not reproduced: {error}", file=sys.stderr)
        return 1
    except SceneError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    if options.check:
        return 0 if Path(options.file).read_text(encoding="utf-8") == text else 1
    write_whole(options.file, text)
    return 0


def _print(words: str) -> int:
    chosen = [truth for truth in (*EXACT, *STATISTICAL) if words.casefold() in truth.title.casefold()]
    if not chosen:
        print(f"error: --only {words!r}: is in no title; docs/truths.md has them", file=sys.stderr)
        return 2
    print(COLUMNS)
    for row in lines(chosen):
        print(row, flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
