"""What turns a run of the exact engine into a certificate that others can check."""

from .writer import CertificateError, certificate_json, certify

__all__ = ["CertificateError", "certificate_json", "certify"]
