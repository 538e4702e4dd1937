"""What all tests share: where the project lies, and how hypothesis draws its examples."""

from __future__ import annotations

import os
import signal
from pathlib import Path

import pytest
from hypothesis import settings

ROOT = Path(__file__).resolve().parent.parent

# Exact arithmetic has no steady pace, so no deadline; on CI the same examples on every run.
settings.register_profile("local", deadline=None)
settings.register_profile("ci", deadline=None, derandomize=True)
settings.load_profile("ci" if os.environ.get("CI") else "local")

# A shell starts what runs in the background deaf to Ctrl-C; what the tests interrupt must hear it.
signal.signal(signal.SIGINT, signal.default_int_handler)


# No test touches the user's kept runs, nor does what tests start.
os.environ["TRUEBREAK_CACHE"] = ""


@pytest.fixture(scope="session")
def root() -> Path:
    """The project's top folder."""
    return ROOT


@pytest.fixture(autouse=True)
def _no_columns(monkeypatch: pytest.MonkeyPatch) -> None:
    """As wide as without the variable, which workers of xdist are given."""
    monkeypatch.delenv("COLUMNS", raising=False)
