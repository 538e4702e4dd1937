"""Exact values of a document as text: written out where they are shallow, by shared definitions where not."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from flint import arb

from ...exact.exact_motion import ExactValue
from ...exact.texts import definitions
from ...scenarios.numbers.quantity import Real
from ..deadline import Clock

NORMAL_WORK = 5_000_000
"""What one document may spend on normal forms, in units of about a microsecond that are counted, not timed, so that
it is the same on every machine. Values get deeper with every collision, and soon none has a normal form that could be
written; those left are given by definitions, which costs little."""

NORMAL_LENGTH = 4_000
"""Characters beyond which a normal form is longer than anyone would read."""

VALUE_UNITS, CHARACTER_UNITS = 1_000, 2
"""What a normal form is taken to cost, for itself and for each character."""

STEP_UNITS = 150
"""What each step of the log before a value is taken to cost, where the value is not at hand."""

FAILED_UNITS = 200_000
"""What a value is taken to cost that turns out to have none; the search for it is bounded too."""


@dataclass
class ExactTexts:
    """Collects the exact values of a document and writes them out, those first that come first.

    Attributes:
        work: units left for normal forms.
        watch: the user's seconds: once they are over, values are given by definitions, which is quick.
        deep: rows, keys and values to be given by definitions.
    """

    work: int = NORMAL_WORK
    watch: Clock = field(default_factory=lambda: Clock(None))
    deep: list[tuple[dict[str, Any], str, ExactValue]] = field(default_factory=list)
    _failed: dict[tuple[int, ...], int] = field(default_factory=dict)

    def put(self, row: dict[str, Any], key: str, value: Real) -> None:
        """Puts the text of a value into a row under `KEY_exact`, now or in `finish`.

        >>> row = {}
        >>> from truebreak.scenarios.numbers.quantity import real
        >>> ExactTexts().put(row, "x", real(0.375))
        >>> row
        {'x_exact': '3/8'}
        """
        if not isinstance(value, ExactValue):
            row[f"{key}_exact"] = value.text()
            return
        row[f"{key}_exact"] = text = self._normal_form(value)
        if text is None:
            self.deep.append((row, f"{key}_exact", value))

    def _normal_form(self, value: ExactValue) -> str | None:
        """The normal form of a value of an exact run; None if it is too long, or too much work.

        A circle whose state had none earlier has none later.
        """
        if (
            self.work <= 0
            or self.watch.over
            or any(value.upto >= upto and set(bodies) <= set(value.bodies) for bodies, upto in self._failed.items())
        ):
            return None
        text = value.normal_form()
        if text is None:
            self.work -= FAILED_UNITS
            self._failed[value.bodies] = min(value.upto, self._failed.get(value.bodies, value.upto))
            return None
        steps = value.upto if isinstance(value.near, arb) else 0
        self.work -= VALUE_UNITS + STEP_UNITS * steps + CHARACTER_UNITS * len(text)
        return text if len(text) <= NORMAL_LENGTH else None

    def finish(self) -> dict[str, str]:
        """Fills in the values put off, and gives the definitions that their texts refer to, in order."""
        if not self.deep:
            return {}
        found = definitions([value for _, _, value in self.deep])
        for (row, key, _), text in zip(self.deep, found.values, strict=True):
            row[key] = text
        return dict(found.names)
