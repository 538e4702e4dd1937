"""The table of tie policies."""

from __future__ import annotations

from ...scenarios.tie_policy import TiePolicy
from .policy import Policy
from .sequential import Sequential
from .simultaneous import Simultaneous


def policy_for(choice: TiePolicy) -> Policy:
    """A fresh policy, at the start of its random order if it has one."""
    if choice.name == "sequential":
        return Sequential(choice.seed)
    return Simultaneous()
