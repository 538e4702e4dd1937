"""Exact values of a document as text: written out where they are shallow, by shared definitions where not."""

from __future__ import annotations

import time as clock
from dataclasses import dataclass, field
from typing import Any

from .amounts import exact_text

NORMAL_SECONDS = 5.0
"""Time that one document may spend on normal forms. Values get deeper with every collision, and soon none
has one that could be written; those left are given by definitions, which costs little."""

NORMAL_LENGTH = 4_000
"""Characters beyond which a normal form is longer than anyone would read."""


@dataclass
class ExactTexts:
    """Collects the exact values of a document and writes them out.

    Attributes:
        seconds: time left for normal forms.
        deep: rows, keys and values to be given by definitions.
    """

    seconds: float = NORMAL_SECONDS
    deep: list[tuple[dict[str, Any], str, Any]] = field(default_factory=list)

    def put(self, row: dict[str, Any], key: str, value: Any) -> None:
        """Puts the text of a value into a row under `KEY_exact`, now or in `finish`.

        >>> row = {}
        >>> ExactTexts().put(row, "x", 0.375)
        >>> row
        {'x_exact': '3/8'}
        """
        text = None
        if self.seconds > 0:
            began = clock.perf_counter()
            text = exact_text(value)
            self.seconds -= clock.perf_counter() - began
        if hasattr(value, "formula") and (text is None or len(text) > NORMAL_LENGTH):
            self.deep.append((row, f"{key}_exact", value))
            text = None
        row[f"{key}_exact"] = text

    def finish(self) -> dict[str, str]:
        """Fills in the values put off, and gives the definitions that their texts refer to, in order."""
        if not self.deep:
            return {}
        from ..exact.export import definitions

        found = definitions([value for _, _, value in self.deep])
        for (row, key, _), text in zip(self.deep, found.values, strict=True):
            row[key] = text
        return dict(found.names)
