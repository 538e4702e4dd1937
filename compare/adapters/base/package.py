"""The packages of other engines, imported when they are needed."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from ...validation import EngineError


class NotInstalled(EngineError):
    """An engine's package is not installed; the message says how to get it."""


def package(module: str, extra: str) -> Any:
    """The module of an engine's package, imported now.

    Args:
        extra: the extra of truebreak that installs it.

    Raises:
        NotInstalled: if it, or something that it imports, is not installed.

    >>> package("math", "box2d").floor(1.5)
    1
    """
    try:
        return import_module(module)
    except ImportError as error:
        raise NotInstalled(f"engine {extra!r}: {error}; pip install '.[{extra}]' in truebreak's folder") from error
