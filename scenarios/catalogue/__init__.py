"""Scenes that are ready to run, each with its source and with what is known of it by other means."""

from .build import build, entry, names
from .entry import Entry, Parameter

__all__ = ["Entry", "Parameter", "build", "entry", "names"]
