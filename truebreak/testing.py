"""For tests of engines: `truebreak_scenes` for parametrize, `check` outside of pytest, `scenes` for hypothesis.

>>> from truebreak.testing import truebreak_scenes
>>> truebreak_scenes("cradle", "gas:n=3..4")
['cradle', 'gas:n=3', 'gas:n=4']
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .compare.testing.check import Checked, CheckFailed, NotDecided, check
    from .compare.testing.plugin import Truebreak
    from .compare.testing.strategies import scenes, truebreak_scenes

__all__ = ["CheckFailed", "Checked", "NotDecided", "Truebreak", "check", "scenes", "truebreak_scenes"]

_HOMES = {
    "CheckFailed": "check",
    "Checked": "check",
    "NotDecided": "check",
    "Truebreak": "plugin",
    "check": "check",
    "scenes": "strategies",
    "truebreak_scenes": "strategies",
}


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f".compare.testing.{_HOMES[name]}", __package__), name)
