"""One published number, where it is from, and how it is measured here."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

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
    'python -m truebreak.compare.truths --only "onto two"'
    """
    return f'python -m truebreak.compare.truths --only "{words}"'


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
