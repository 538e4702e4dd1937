"""The checker, made to run by itself, lifts Python's limit on the digits of whole numbers; here it comes back."""

from __future__ import annotations

import sys
from collections.abc import Iterator

import pytest


@pytest.fixture(autouse=True)
def limit_on_digits() -> Iterator[None]:
    saved = sys.get_int_max_str_digits()
    yield
    sys.set_int_max_str_digits(saved)
