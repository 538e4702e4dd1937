"""Tie policies: which of several approaching contacts at one instant get their impulses, and in what order."""

from .policy import Policy
from .table import policy_for

__all__ = ["Policy", "policy_for"]
