"""What is taken for a zero: proof alone, or the user's own word where proof fails."""

from __future__ import annotations

from ...scenarios.errors import SceneError
from ...scenarios.lazy import frozen

MAX_ASSUMED = 1_000_000
"""Most bits that agreement may be asked to."""


@frozen
class TieRule:
    """What is taken for a zero once every proof has failed.

    Attributes:
        bits: agreement to so many bits; None: nothing.
    """

    bits: int | None = None

    @staticmethod
    def parse(text: str) -> TieRule:
        """The rule of a setting `proved` or `assume:BITS`.

        Raises:
            SceneError: for any other text.

        >>> TieRule.parse("assume:512")
        TieRule(bits=512)
        >>> TieRule.parse("probable")
        Traceback (most recent call last):
          ...
        truebreak.scenarios.errors.SceneError: ties = 'probable' is no longer known: evidence modulo random primes \
proved nothing that more bits do not; choose proved, or assume:BITS (such as assume:512) for your own word
        """
        if text == "proved":
            return TieRule()
        head, _, bits = text.partition("assume:")
        if head == "" and bits.isascii() and bits.isdigit() and 0 < int(bits[:7]) <= MAX_ASSUMED:
            return TieRule(int(bits))
        if text == "probable":
            raise SceneError(
                "ties = 'probable' is no longer known: evidence modulo random primes proved nothing that more bits "
                "do not; choose proved, or assume:BITS (such as assume:512) for your own word"
            )
        raise SceneError(f"ties = {text!r} is not known; choose proved or assume:BITS (such as assume:512)")
