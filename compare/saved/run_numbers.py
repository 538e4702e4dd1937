"""The numbers and the log of a run as JSON, and back, digit for digit."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, TypeAlias

from flint import arb, fmpq, fmpz

from ...exact.exact_motion import Source
from ...exact.numbers.ball import Known, from_parts, parts_of
from ...exact.replay.contact import AtWall, Entry, Link, Pair, Touch
from ...exact.replay.state import Flip, Go, Kick, Step, Take
from ...scenarios.numbers.nested_roots import Tower
from ...scenarios.numbers.parsing import MAX_LENGTH
from ...scenarios.numbers.quantity import Quantity
from ...scenarios.numbers.tower_element import Element

Written: TypeAlias = Any
"""What JSON holds: whole numbers, text, lists."""

ELEMENT_BITS = 192
"""Accuracy of a number whose normal form is longer than the reader of numbers takes: the log has its exact value."""


class NumberWriter:
    """Writes numbers: exact ones as text, balls as four whole numbers, those with roots as ["text"].

    Attributes:
        roots: the roots that generate the field of those with roots, in their order.
    """

    def __init__(self) -> None:
        self._tower: Tower | None = None

    def __call__(self, number: Known) -> Written:
        """One number."""
        if isinstance(number, fmpq):
            return str(number)
        if isinstance(number, arb):
            return _ball_data(number)
        text = number.text()
        if len(text) > MAX_LENGTH:
            return _ball_data(number.ball(ELEMENT_BITS))
        assert self._tower in (None, number.tower), "the exact numbers of a run lie in one field"
        assert isinstance(number.tower, Tower)
        self._tower = number.tower
        return [text]

    @property
    def roots(self) -> list[str]:
        return [] if self._tower is None else [root.text() for root in self._tower.generators]


class NumberReader:
    """Reads what a `NumberWriter` wrote.

    Args:
        roots: its roots.
    """

    def __init__(self, roots: Sequence[str]) -> None:
        self._tower = Tower()
        self._known: dict[str, Element] = {}
        for root in roots:
            Quantity.of(root).in_tower(self._tower)
        if [root.text() for root in self._tower.generators] != list(roots):
            raise ValueError("the roots do not generate the field")

    def __call__(self, written: Written) -> Known:
        """One number.

        Raises:
            ValueError: if no writer wrote this.
        """
        if isinstance(written, str):
            return _rational(written)
        if len(written) != 1:
            return _ball_of(written)
        text = written[0]
        if text not in self._known:
            self._known[text] = Quantity.of(text).in_tower(self._tower)
            if self._known[text].text() != text:
                raise ValueError(f"{text} is not in normal form")
        return self._known[text]


def _rational(text: str) -> fmpq:
    p, _, q = text.partition("/")
    return fmpq(fmpz(p), fmpz(q or "1"))


def _ball_data(ball: arb) -> Written:
    """Its parts, the midpoint's digits in hexadecimal: of those Python reads and writes any number."""
    parts = parts_of(ball)
    return [f"{parts[0]:x}", *parts[1:]] if parts else []


def _ball_of(written: Written) -> arb:
    return from_parts(int(written[0], 16), *written[1:]) if written else from_parts()


# -- the log


def step_data(step: Step) -> Written:
    """A step of the log.

    >>> step_data(Go(Pair(0, 1), (0, 1))), step_data(Flip())
    (['go', [0, 1], [0, 1]], ['flip'])
    """
    if isinstance(step, Go):
        return ["go", source_data(step.source), list(step.bodies)]
    if isinstance(step, Kick):
        return ["kick", links_data(step.links), links_data(step.among)]
    return ["take", step.body] if isinstance(step, Take) else ["flip"]


def step_of(data: Written) -> Step:
    """What `step_data` wrote.

    Raises:
        ValueError: for what is no step.

    >>> step_of(["kick", [[0, 1]], [[0, 1]]])
    Kick(links=(Pair(a=0, b=1),), among=(Pair(a=0, b=1),))
    """
    match data:
        case ["go", str(text), bodies]:
            return Go(Quantity.of(text), tuple(bodies))
        case ["go", source, bodies]:
            clock = source_of(source)
            assert not isinstance(clock, str)
            return Go(clock, tuple(bodies))
        case ["kick", links, among]:
            return Kick(links_of(links), links_of(among))
        case ["take", int(body)]:
            return Take(body)
        case ["flip"]:
            return Flip()
        case _:
            raise ValueError(f"{data} is no step")


def source_data(source: Source | Quantity) -> Written:
    """Whose time it is: a meeting as a list, a circle as a number, anything else as text."""
    if isinstance(source, Quantity):
        return set_time_data(source)
    return list(source) if isinstance(source, tuple) else source


def set_time_data(time: Quantity) -> Written:
    """A set time as text.

    Raises:
        SceneError: if the reader of numbers does not take that text.
    """
    text = time.text()
    Quantity.of(text)
    return text


def source_of(data: Written) -> Source:
    """What `source_data` wrote, a set time left as text."""
    return link_of(data) if isinstance(data, list) else data


def links_data(links: Sequence[Link]) -> Written:
    """Contacts by index."""
    return [list(link) for link in links]


def links_of(data: Written) -> tuple[Touch, ...]:
    """What `links_data` wrote."""
    return tuple(link for link in map(link_of, data) if not isinstance(link, Entry))


def link_of(data: Written) -> Link:
    """One contact: its indices, and, of a wall or a pocket, which it is.

    Raises:
        ValueError: for what is none.
    """
    match data:
        case [int(a), int(b)]:
            return Pair(a, b)
        case [int(circle), int(wall), "wall"]:
            return AtWall(circle, wall)
        case [int(circle), int(pocket), "pocket"]:
            return Entry(circle, pocket)
        case _:
            raise ValueError(f"{data} is no contact")
