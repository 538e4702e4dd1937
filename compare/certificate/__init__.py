"""What turns a run of the exact engine into a certificate that others can check; and what gets one in a comparison."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...scenarios.lazy import handed_on

if TYPE_CHECKING:
    from .writer import CertificateError, certificate_json, certificate_of

__all__ = ["CertificateError", "certificate_json", "certificate_of"]

__getattr__, __dir__ = handed_on(__name__, dict.fromkeys(__all__, "writer"))
