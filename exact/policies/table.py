"""The table of tie policies."""

from __future__ import annotations

from importlib import import_module

from ...scenarios import tie_policy
from ...scenarios.tie_policy import TiePolicy
from .policy import Policy


def policy_for(choice: TiePolicy) -> Policy:
    """A fresh policy, at the start of its random order if it has one."""
    module, _, name = tie_policy.POLICIES[choice.name].partition(":")
    make = getattr(import_module(module, tie_policy.__package__), name)
    return make() if choice.seed is None else make(choice.seed)
