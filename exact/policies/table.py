"""The table of tie policies."""

from __future__ import annotations

from importlib import import_module

from ...scenarios import settings
from ...scenarios.settings import TiePolicy
from .policy import Policy


def policy_for(choice: TiePolicy) -> Policy:
    """A fresh policy, at the start of its random order if it has one."""
    module, _, name = settings.POLICIES[choice.name].partition(":")
    make = getattr(import_module(module, settings.__package__), name)
    return make() if choice.seed is None else make(choice.seed)
