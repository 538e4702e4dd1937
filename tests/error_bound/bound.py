"""Holds the error bound against the truth: prints how many checks, the worst, and how loose the bound is.

python tests/error_bound/bound.py                  # 100,000 checks of numbers that a set held, and more
python tests/error_bound/bound.py --checks 5000 --kinds flat,heavy
"""

from __future__ import annotations

import sys
from importlib import import_module
from pathlib import Path

if __name__ == "__main__":
    sys.path[0] = str(Path(__file__).resolve().parents[1])
    sys.exit(import_module("error_bound.campaign").main())
