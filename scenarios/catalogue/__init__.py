"""Scenes that are ready to run, each with its source and with what is known of it by other means."""

from .scene_entry import Parameter, SceneEntry
from .scene_table import build, entry, names

__all__ = ["Parameter", "SceneEntry", "build", "entry", "names"]
