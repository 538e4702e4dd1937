"""The version of this project: what `pyproject.toml` says, without looking among installed packages for it."""

VERSION = "0.1.0"
