"""Scenes as files: TOML for people, JSON for machines, read and written exactly."""

from .reader import loads_json, loads_toml
from .scene_file import load_scene, save_scene
from .writer import dump_json, dump_toml

__all__ = ["dump_json", "dump_toml", "load_scene", "loads_json", "loads_toml", "save_scene"]
