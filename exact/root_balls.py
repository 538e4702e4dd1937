"""Balls that tell the signs of what is known not to be zero."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence

from .machine import Number
from .numbers import ball
from .root_past import Past, RootMachine
from .root_survey import GaveUp

FIRST_BALL_BITS, MOST_BALL_BITS = 512, 1 << 17
"""Precisions at which balls tell the signs of numbers that are known not to be zero."""


class RootBalls:
    """A past in balls, computed again with more bits until a sign shows."""

    def __init__(self, past: Past, deadline: float) -> None:
        self.past = past
        self.deadline = deadline
        self._bits = 0

    def _at(self, bits: int) -> None:
        """Replays with so many bits, unless that has been done."""
        if bits == self._bits:
            return
        self._bits = bits
        self._along: list[tuple[Number, ...]] = []

        def root(index: int, value: Number, along: tuple[Number, ...]) -> Number:
            self._along.append(along)
            return ball.root(value)

        past = self.past
        with ball.precision(bits):
            machine = RootMachine(past.scene, ball.constant, root, past.bodies)
            for place in range(len(past.steps)):
                past.carry_out(machine, place)
            self._parts = past.root_sum(machine)

    def _rising(self) -> Iterator[int]:
        bits = FIRST_BALL_BITS
        while bits <= MOST_BALL_BITS and time.monotonic() < self.deadline:
            try:
                self._at(bits)
            except ZeroDivisionError:
                self._bits = 0
            else:
                yield bits
            bits *= 2
        raise GaveUp(f"balls of {bits // 2} bits do not tell the sign of a number that is not zero")

    def speed_sign(self, index: int, name: str) -> int:
        """The sign of a component of the velocity that went with a root; it is not zero."""
        for _ in self._rising():
            sign = ball.sign_of(self._along[index][name == "vy"])
            if sign is not None:
                return sign
        raise AssertionError("the loop ends by itself")

    def is_zero_one(self, signs: Sequence[tuple[int, int]]) -> bool:
        """Whether A + B*sqrt(D1) + C*sqrt(D2) is the zero among numbers A + s B*sqrt(D1) + r C*sqrt(D2).

        Args:
            signs: pairs (s, r), of which exactly one makes a zero; (1, 1) comes first. s or r is 0 where
                the term is zero.
        """
        for bits in self._rising():
            with ball.precision(bits):
                a, b, d1, c, d2 = self._parts
                p, q = (
                    x * ball.root(d) if any(pair[i] for pair in signs) else ball.ZERO
                    for i, x, d in ((0, b, d1), (1, c, d2))
                )
                known = [ball.sign_of(a + s * p + r * q) for s, r in signs]
            if known[0] is not None and known[0] != 0:
                return False
            if all(sign is not None and sign != 0 for sign in known[1:]):
                return True
        raise AssertionError("the loop ends by itself")
