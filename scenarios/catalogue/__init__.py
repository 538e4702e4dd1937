"""Scenes that are ready to run, each with its source and with what is known of it by other means."""

from .entry import Entry, Parameter
from .table import build, entry, names

__all__ = ["Entry", "Parameter", "build", "entry", "names"]
