"""The JSON Schemas of what the command line prints, by name."""

from __future__ import annotations

import json
from importlib.resources import files
from typing import Any

NAMES = (
    "trajectory-1",
    "comparison-4",
    "orders-1",
    "certificate-3",
    "chaos-1",
    "diff-1",
    "sweep-2",
    "shadow-1",
    "stress-2",
    "advice-2",
    "bench-4",
    "suite-2",
    "run-1",
    "saved-comparison-1",
)


def schema(name: str) -> dict[str, Any]:
    """The schema of `truebreak/NAME`.

    Raises:
        KeyError: if there is none of that name.

    >>> schema("trajectory-1")["$id"]
    'truebreak/trajectory-1'
    """
    if name not in NAMES:
        raise KeyError(name)
    return json.loads(files(__package__ or __name__).joinpath(f"{name}.json").read_text(encoding="utf-8"))
