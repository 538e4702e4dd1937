"""First falling zeros of many polynomials in doubles, in balls and exactly, compared with Sturm's chains: counted.

python tests/quartic_campaign.py 1000 2000                # the polynomials of these numbers, and what is wrong
python tests/quartic_campaign.py 0 1000000 --known        # made of zeros that are known; in doubles, as compiled
python tests/quartic_campaign.py 0 100000 --known python  # the same, as written in Python
"""

from __future__ import annotations

import random
import sys
from collections import Counter
from collections.abc import Callable, Iterator
from fractions import Fraction
from math import ldexp
from typing import Any, NamedTuple

from flint import arb, fmpq
from quartic_referee import Poly, first_fall

from truebreak.exact.numbers import ball
from truebreak.exact.numbers.ball import sharpened
from truebreak.exact.replay import round_falls
from truebreak.exact.replay.round_falls import (
    PRIMES,
    ExactZero,
    Isolated,
    Unclear,
    falling_zero,
    falling_zero_exactly,
    falling_zero_in_balls,
    gap_quartic,
    horner,
    horner_slope,
)

WIDTH = Fraction(1, 2**220)
KINDS = (
    "free", "zeros", "double", "close", "graze", "short", "ends", "negative", "cubic", "many", "parted", "faint", "far",
)  # fmt: skip
"""free: any coefficients; zeros: any zeros; double: two are one; close: two are 10**-9 to 10**-60 apart; graze: such
two, or none; short: leading coefficients are 0; ends: the first zero is all but 0, the last all but infinite; negative:
of the leading coefficient; cubic: after a contact; many: three or four zeros are one, or two pairs; parted: zeros where
intervals end or are halved; faint: the leading coefficient all but vanishes; far: the first zero is far off."""


def product(*zeros: Fraction, lead: Fraction = Fraction(1)) -> Poly:
    """The polynomial with these zeros."""
    found = [lead]
    for zero in zeros:
        found = [Fraction(0), *found]
        for k in range(len(found) - 1):
            found[k] -= zero * found[k + 1]
    return found


def drawn(rng: random.Random, kind: str) -> Poly | None:
    """A polynomial that is positive at 0; None for one that is not."""

    def number(low: int, high: int) -> Fraction:
        return Fraction(rng.randint(low * 1000, high * 1000), rng.choice([1000, 1024, 997]))

    some = number(0, 4) + Fraction(1, 1000)
    tiny = Fraction(1, 10 ** rng.choice([9, 16, 30, 60]))
    match kind:
        case "free":
            c = [some, *(number(-4, 4) for _ in range(4))]
        case "zeros":
            c = product(*(number(-2, 3) for _ in range(4)), lead=number(0, 2) + 1)
        case "double":
            c = product(some, some, number(-3, 6), number(-3, 6)) if rng.random() < 0.5 else product(some, some, -some)
        case "close":
            c = product(some, some + tiny, number(-3, 6), some + number(0, 1))
        case "graze":
            c = product(some, some, -some, -number(0, 3))
            c[0] += tiny * rng.choice([-1, 1])
        case "short":
            c = [some, *(number(-4, 4) for _ in range(rng.randint(1, 3))), Fraction(0)]
        case "ends":
            c = product(tiny, 1 / tiny, number(1, 3), number(1, 3))
        case "negative":
            c = [some, number(-4, 4), number(-4, 4), number(-4, 4), -number(1, 4)]
        case "many":
            c = product(
                *rng.choice([(some,) * 3, (some,) * 4, (some, some, 2 * some, 2 * some), (some,) * 3 + (-some,)])
            )
        case "parted":
            zeros = [Fraction(ldexp(rng.choice(PRIMES) * rng.randint(1, 16), rng.randint(-14, -4))) for _ in range(3)]
            c = product(*zeros, rng.choice([number(-3, 3), zeros[0] * rng.choice([1, 2])]))
        case "faint":
            c = [some, *(number(-4, 4) for _ in range(rng.randint(1, 3))), rng.choice([-1, 1]) * tiny]
        case "far":
            c = product(1 / tiny, some / tiny, -number(0, 3), rng.choice([2, -1]) / tiny)
        case _:
            d, v, h = [(number(-4, 4), number(-4, 4)) for _ in range(3)]
            c = list(gap_quartic(*d, *v, *h, Fraction(0)))[1:]
    c = c if c[0] >= 0 else [-x for x in c]
    return c if c[0] > 0 and any(c[1:]) else None


def polynomials(many: int, seed: int, first: int = 0) -> Iterator[tuple[str, Poly]]:
    """Of every kind in turn, from one on."""
    rng, k = random.Random(seed), first
    many += first
    while k < many:
        kind = KINDS[k % len(KINDS)]
        c = drawn(rng, kind)
        if c is not None:
            k += 1
            yield kind, c


def exact(x: Any) -> Fraction:
    """A double or a fraction as Python's."""
    return Fraction(x) if isinstance(x, float) else Fraction(int(x.p), int(x.q))


def is_wrong(found: Any, truth: tuple[Fraction, Fraction] | None) -> bool:
    """Whether an answer contradicts the truth; to say nothing is not wrong."""
    if isinstance(found, Unclear):
        return truth is not None and truth[1] < Fraction(found.since)
    if found is None or truth is None:
        return (found is None) != (truth is None)
    return not (exact(found.low) < truth[1] and truth[0] < exact(found.high))


def in_doubles(c: Poly) -> Any:
    """Decided in doubles."""
    mids = [float(x) for x in c]
    return falling_zero(mids, [float(abs(Fraction(m) - x)) * 1.001 for m, x in zip(mids, c, strict=True)])


def in_balls(c: Poly, bits: int = 300) -> Any:
    """Decided in balls of so many bits."""
    with ball.precision(bits):
        return falling_zero_in_balls([arb(fmpq(x.numerator, x.denominator)) for x in c])


def in_fractions(c: Poly) -> Any:
    """Decided exactly."""
    found = falling_zero_exactly([fmpq(x.numerator, x.denominator) for x in c])
    return Isolated(found.low, found.high) if isinstance(found, ExactZero) else None


def by_newton(c: Poly, bits: int = 300) -> Any:
    """Where balls isolate it, sharpened to their precision."""
    found = in_balls(c, bits)
    if not isinstance(found, Isolated):
        return found
    with ball.precision(bits):
        b = [arb(fmpq(x.numerator, x.denominator)) for x in c]
        low, high = (arb(fmpq(*exact(end).as_integer_ratio())) for end in found)
        zero = sharpened(low, high, lambda t: horner(b, t), lambda t: horner_slope(b, t))
        if zero is None:
            return Unclear(float(exact(found.low)) * (1 - 2.0**-40))
        return Isolated(*(ball_end.fmpq() for ball_end in (zero.lower(), zero.upper())))


WAYS: dict[str, Callable[[Poly], Any]] = {
    "doubles": in_doubles,
    "balls": in_balls,
    "fractions": in_fractions,
    "Newton": by_newton,
}


def campaign(low: int, high: int) -> Counter[str]:
    """Of the polynomials of some numbers: how many of each kind, what each way leaves open, and what is wrong."""
    counts: Counter[str] = Counter()
    for number in range(low, high):
        kind, c = next(polynomials(1, number, number))
        truth = first_fall(c, WIDTH)
        counts["polynomials"] += 1
        counts[f"{kind}: falls" if truth is not None else f"{kind}: does not fall"] += 1
        for way, decide in WAYS.items():
            found = decide(c)
            counts[f"{way}: open"] += isinstance(found, Unclear)
            if way == "Newton" and isinstance(found, Isolated):  # two zeros 10**-30 apart cost 100 bits
                counts["Newton: fewer than 180 bits of 300"] += (
                    exact(found.high) - exact(found.low) > exact(found.high) / 2**180
                )
            if is_wrong(found, truth):
                counts[f"{way}: WRONG"] += 1
                print(number, kind, way, found, truth, c, flush=True)
        if not (number + 1) % 1000:
            print(number + 1, dict(counts), flush=True)
    return counts


# -- Polynomials made of zeros that are known: nothing is left to find, so that a million of them take a minute or two.


class Made(NamedTuple):
    """A polynomial in whole numbers, the time in units of 1 / `unit`; and its first falling zero in those."""

    kind: str
    unit: int
    c: list[int]
    fall: int | None


def made(number: int) -> Made:
    """The polynomial of a number: factors t - z and (t - a)^2 + b^2, a whole number of units each."""
    rng = random.Random(number)
    kind = rng.choice(("free", "double", "close", "graze", "triple", "ends", "short", "negative"))
    digits = 3 if kind not in ("close", "graze", "ends") else rng.choice((9, 16, 30, 60))
    unit = 10**digits

    def place(low: int, high: int) -> int:
        return rng.randint(low * 1000, high * 1000) * unit // 1000 or 1

    def pair(a: int, b: int) -> list[int]:
        return [a * a + b * b, -2 * a, 1]

    some = place(0, 4) + unit // 1000
    zeros: list[int] = []
    rest: list[int] = [1]
    match kind:
        case "double":
            zeros = [some, some, place(-3, 6), place(-3, 6)]
        case "close":
            zeros = [some, some + 1, place(-3, 6), some + place(0, 1)]
        case "graze":  # all but a double zero
            zeros, rest = [place(-3, 6), place(-3, 6)], pair(some, 1)
        case "triple":
            zeros = [some] * rng.choice((3, 4)) if rng.random() < 0.5 else [some, some, 2 * some, 2 * some]
        case "ends":
            zeros = [1, unit * unit, place(1, 3), place(1, 3)]
        case "short":
            zeros = [place(-2, 4) for _ in range(rng.randint(1, 3))]
        case "negative":
            zeros = [place(-4, -1), place(-4, -1), place(-2, 3), place(-2, 3)]
        case _ if rng.random() < 0.5:
            zeros = [place(-3, 4) for _ in range(4)]
        case _:
            zeros, rest = [place(-3, 4), place(-3, 4)], pair(place(-3, 4), place(-2, 2))
    c = rest
    for zero in zeros:
        c = [(low if k else 0) - zero * high for k, (low, high) in enumerate(zip([0, *c], [*c, 0], strict=True))]
    if c[0] < 0:
        c = [-x for x in c]
    odd = [zero for zero in set(zeros) if zero > 0 and zeros.count(zero) % 2]
    return Made(kind, unit, c, min(odd, default=None))


def known(low: int, high: int) -> Counter[str]:
    """In doubles, of the polynomials of some numbers: how many, what is left open, and what is wrong."""
    counts: Counter[str] = Counter()
    for number in range(low, high):
        kind, unit, c, fall = made(number)
        scale, size = unit ** (len(c) - 1), len(c) - 1
        mids = [x * unit**k / scale for k, x in enumerate(c)]  # rounded once each
        found = falling_zero(mids, [2.0**-53 * abs(mid) for mid in mids])
        truth = None if fall is None else (Fraction(fall, unit),) * 2
        counts["polynomials"] += 1
        counts[f"of degree {size}"] += 1
        counts[f"{kind}: {'falls' if fall is not None else 'does not fall'}"] += 1
        counts[f"{kind}: open"] += isinstance(found, Unclear)
        if is_wrong(found, truth) and not _at_an_end(found, truth):
            counts["WRONG"] += 1
            print(number, kind, found, truth, c, unit, flush=True)
    return counts


def _at_an_end(found: Any, truth: tuple[Fraction, Fraction] | None) -> bool:
    """Whether the zero is an end of the interval said."""
    return truth is not None and isinstance(found, Isolated) and truth[0] in (exact(found.low), exact(found.high))


def main() -> int:
    """Counts; the exit status, 1 where something is wrong."""
    low, high, *more = sys.argv[1:]
    if "python" in more:
        round_falls.predictions = None
    counts = known(int(low), int(high)) if "--known" in more else campaign(int(low), int(high))
    for name, count in sorted(counts.items()):
        print(f"{count:>8} {name}")
    return int(any("WRONG" in name for name in counts))


if __name__ == "__main__":
    sys.exit(main())
