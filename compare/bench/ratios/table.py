"""Every figure that `truebreak bench` measures, by name."""

from __future__ import annotations

from . import figures
from .crowds import CROWDS

BENCHMARKS: dict[str, figures.Benchmark] = {**figures.BENCHMARKS, **CROWDS}
