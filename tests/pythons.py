"""Runs tests on every Python to be had: `python tests/pythons.py FOLDER TEST...`, each in an environment of its own.

Python is looked for on the PATH, as `python3.11` and so on, and among what pyenv has. `make pythons` calls this.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
LOWEST = 11
"""The lowest minor version that pyproject.toml asks for."""

HIGHEST = 20
EXTRAS = "[dask,docs,notebook,plots,tables]"
NEEDED = ("hypothesis", "jsonschema", "pytest", "pytest-timeout", "pytest-xdist", "setuptools>=77")


def pythons() -> dict[str, Path]:
    """Each version that there is, `3.12`, and one program of it.

    >>> all(path.is_file() for path in pythons().values())
    True
    """
    kept = Path(os.environ.get("PYENV_ROOT") or Path.home() / ".pyenv") / "versions"
    found: dict[str, Path] = {}
    for minor in range(LOWEST, HIGHEST):
        name = f"python3.{minor}"
        on_path = shutil.which(name)
        for path in [*([Path(on_path)] if on_path else []), *sorted(kept.glob(f"3.{minor}.*/bin/{name}"))]:
            if works(path):
                found.setdefault(f"3.{minor}", path)
    return found


def works(python: Path) -> bool:
    """Whether it starts and can make environments: a shim of pyenv may lead nowhere."""
    command = [python, "-c", "import ensurepip, venv"]
    return subprocess.run(command, capture_output=True, check=False).returncode == 0


def tried(python: Path, folder: Path, tests: list[str]) -> int:
    """Pytest's exit code, in an environment of its own."""
    subprocess.run([python, "-m", "venv", folder], check=True)
    own = folder / "bin" / "python"
    subprocess.run([own, "-m", "pip", "install", "-q", "-e", f"{ROOT}{EXTRAS}", *NEEDED], check=True)
    return subprocess.run(
        [own, "-m", "pytest", "-n", "auto", "-m", "not slow", *tests], cwd=ROOT, check=False
    ).returncode


def main(folder: str, *tests: str) -> int:
    """The command line: 0 if the tests pass on every Python."""
    codes = {}
    for version, python in pythons().items():
        print(f"Python {version}: {python}", flush=True)
        codes[version] = tried(python, Path(folder).resolve() / version, list(tests))
    for version, code in codes.items():
        print(f"Python {version}: {'passed' if code == 0 else f'pytest ended with {code}'}")
    return 1 if any(codes.values()) or not codes else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
