"""The typed outcome of a comparison that a number system cannot answer."""

from __future__ import annotations


class Undecided(Exception):
    """A sign that is not known. The message says which, at which event, to how many bits."""


class BudgetSpent(Exception):
    """A limit that the user set on effort was reached before an answer was."""
