"""One published number, where it is from, and how it is measured here."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

OURS = "none: measured by this project before"
"""The source of a number that others have not published."""

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


def near(ours: float, published: float, room: float, digits: int = 5) -> Measured:
    """Within a share of the published number.

    Raises:
        NotReproduced: if it is farther off.

    >>> near(1.02, 1.0, 0.05)
    ('1.02', '+2.0 %')
    """
    share = ours / published - 1
    if abs(share) > room:
        raise NotReproduced(f"{ours:.10g} is {share:+.2%} off {published:.10g}, and {room:.2%} is allowed")
    told = "none" if share == 0 else f"{share:+.1%}".replace("%", " %") if abs(share) >= 5e-4 else f"{share:+.0e}"
    return f"{ours:.{digits}g}", told
