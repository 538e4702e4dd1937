"""Scenes that are ready to run, each with its source and with what is known of it by other means."""

from .entry import Parameter, SceneEntry
from .table import build, entry, names

__all__ = ["Parameter", "SceneEntry", "build", "entry", "names"]
