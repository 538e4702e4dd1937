"""Builds the distribution of sources, unpacks it, and runs its tests there against the wheel that is built from it.

`python tests/sdist.py FOLDER [TEST...]`, in an environment of its own in FOLDER; without tests, all of them. What the
project's folder holds beside the sources plays no part.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
import tarfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
LEFT = shutil.ignore_patterns(".git", ".venv", "build", "dist", "__pycache__", "node_modules", "*.egg-info", ".*_cache")


def build(folder: Path) -> Path:
    """The distribution, built from a copy of the project so that nothing is left in it; unpacked in the folder."""
    copy = folder / "copy"
    shutil.copytree(ROOT, copy, ignore=LEFT)
    code = "import sys; from setuptools.build_meta import build_sdist; build_sdist(sys.argv[1])"
    subprocess.run([sys.executable, "-c", code, str(folder)], cwd=copy, check=True, capture_output=True)
    shutil.rmtree(copy)
    (archive,) = folder.glob("truebreak-*.tar.gz")
    with tarfile.open(archive) as packed:
        if hasattr(tarfile, "data_filter"):  # from Python 3.11.4 on
            packed.extraction_filter = tarfile.data_filter
        packed.extractall(folder)
    (unpacked,) = (path for path in folder.glob("truebreak-*") if path.is_dir())
    return unpacked


def main(folder: str, *tests: str) -> int:
    """The command line; pytest's exit code."""
    place = Path(folder).resolve()
    shutil.rmtree(place, ignore_errors=True)
    place.mkdir(parents=True)
    unpacked = build(place)
    subprocess.run([sys.executable, "-m", "venv", str(place / "venv")], check=True)
    python = place / "venv" / "bin" / "python"
    subprocess.run([python, "-m", "pip", "install", "-q", f"{unpacked}[dev]"], check=True)
    command = [python.with_name("pytest"), "-n", "auto", "-m", "not slow", *tests]
    return subprocess.run(command, cwd=unpacked, check=False).returncode


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
