"""A run looks whether doubles are rounded to the nearest and kept near zero, as its filters take for granted."""

from __future__ import annotations

import ctypes
import os
import struct
import sys
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from truebreak.exact import ExactEngine
from truebreak.exact.simulation import loop
from truebreak.scenarios import Disturbed, catalogue
from truebreak.scenarios.numbers.precision import check_doubles


@contextmanager
def rounding(mode: int) -> Iterator[None]:
    libm = ctypes.CDLL("libm.so.6")
    before = libm.fegetround()
    assert libm.fesetround(mode) == 0
    try:
        yield
    finally:
        libm.fesetround(before)


@contextmanager
def flushing(bits: int) -> Iterator[None]:
    """Sets bits of the register that tells SSE what to do with doubles near zero."""
    libm = ctypes.CDLL("libm.so.6")
    before, after = ctypes.create_string_buffer(32), ctypes.create_string_buffer(32)
    libm.fegetenv(before)
    libm.fegetenv(after)
    (mxcsr,) = struct.unpack_from("<I", after.raw, 28)
    struct.pack_into("<I", after, 28, mxcsr | bits)
    libm.fesetenv(after)
    try:
        yield
    finally:
        libm.fesetenv(before)


on_x86 = pytest.mark.skipif(
    not (sys.platform == "linux" and os.uname().machine == "x86_64"), reason="the modes are those of x86 and glibc"
)


@on_x86
@pytest.mark.parametrize("mode", [0x400, 0x800, 0xC00], ids=["down", "up", "to zero"])
def test_another_rounding_mode_is_found_out(mode: int) -> None:
    scene = catalogue.build("gas:n=3")
    with rounding(mode), pytest.raises(Disturbed, match="not rounded to the nearest"):
        ExactEngine().run(scene, events=5)
    check_doubles()


@on_x86
@pytest.mark.parametrize("bits", [0x8000, 0x40], ids=["results", "operands"])
def test_flushing_of_doubles_near_zero_is_found_out(bits: int) -> None:
    scene = catalogue.build("gas:n=3")
    with flushing(bits), pytest.raises(Disturbed, match="flushed to zero"):
        ExactEngine().run(scene, events=5)
    check_doubles()


@on_x86
def test_doubles_are_looked_at_at_both_ends_of_a_run(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(loop, "PROGRESS_EVERY", 0.0)
    libm = ctypes.CDLL("libm.so.6")
    scene = catalogue.build("gas:n=10")
    try:
        with pytest.raises(Disturbed, match="not rounded to the nearest"):
            ExactEngine().run(scene, events=300, progress=lambda _: libm.fesetround(0x800))
    finally:
        libm.fesetround(0)
