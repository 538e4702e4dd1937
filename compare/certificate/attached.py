"""The certificates that a comparison is handed out with."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from ...scenarios.errors import SceneError
from .certified import certified

if TYPE_CHECKING:
    from ..comparison import Comparison
    from ..outcomes.permitted import Witness


def with_certificates(comparison: Comparison) -> Comparison:
    """A comparison with the certificate of its reference, and of each nearby scene that some engine's pattern has.

    A nearby scene's run without a certificate is left as it is.

    Raises:
        SceneError: if the reference has none.
    """
    permitted = comparison.permitted
    if permitted is not None:
        told = [candidate.pattern for candidate in comparison.candidates if candidate.verdict == "diverged"]
        witnesses = (_with_certificate(w) if w.pattern in told else w for w in permitted.witnesses)
        permitted = replace(permitted, witnesses=tuple(witnesses))
    return replace(comparison, certificate=certified(comparison.reference), permitted=permitted)


def _with_certificate(witness: Witness) -> Witness:
    try:
        return replace(witness, certificate=certified(witness.run))
    except SceneError:
        return witness
