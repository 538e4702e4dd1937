"""The command line: `truebreak scenes | show | run | compare | orders | chaos | sweep | bench`."""

from __future__ import annotations

from .entry import main

__all__ = ["main"]
