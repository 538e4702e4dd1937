"""Runs the fuzz for as long as you like: resumable, watched, counted.

python tests/fuzz/stress.py --scenes 100000 --jobs 2 --out fuzz.jsonl   # a second call goes on
python tests/fuzz/stress.py --report --out fuzz.jsonl                   # the counts so far
python tests/fuzz/stress.py --replay instant 17                         # one case, and what differs
"""

from __future__ import annotations

import sys
from importlib import import_module
from pathlib import Path

if __name__ == "__main__":
    sys.path[0] = str(Path(__file__).resolve().parents[1])
    sys.exit(import_module("fuzz.longrun").main())
