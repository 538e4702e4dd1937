"""Builds distributions: all packages that there are, the same bytes from the same sources, and a wheel without compiled
parts is tagged so.

setuptools takes these commands from pyproject.toml. With SOURCE_DATE_EPOCH, which setuptools minds in wheels, what is
archived bears that time; with TRUEBREAK_PURE_PYTHON nothing is compiled.
"""

from __future__ import annotations

import gzip
import os
import tarfile
from collections.abc import Mapping
from io import BytesIO
from pathlib import Path
from typing import Any

from setuptools.command.bdist_wheel import bdist_wheel
from setuptools.command.build_ext import build_ext
from setuptools.command.build_py import build_py
from setuptools.command.sdist import sdist

COMPILED = (".so", ".pyd")


class Extensions(build_ext):
    """The compiled parts, or none where Python is wished for."""

    def run(self) -> None:
        """As `build_ext.run`."""
        if os.environ.get("TRUEBREAK_PURE_PYTHON"):
            self.extensions = []
        super().run()


class Packages(build_py):
    """Every package that there is: a new folder needs to be listed nowhere."""

    def finalize_options(self) -> None:
        """As `build_py.finalize_options`."""
        self.distribution.packages = packages(self.distribution.package_dir or {})
        super().finalize_options()


def packages(folders: Mapping[str, str]) -> list[str]:
    """The names of the folders that hold an `__init__.py`, in order.

    Args:
        folders: where packages lie whose names do not say it, as `[tool.setuptools.package-dir]` has them.
    """
    return sorted(
        ".".join([name, *path.parent.relative_to(folder).parts])
        for name, folder in folders.items()
        for path in Path(folder).rglob("__init__.py")
    )


class Wheel(bdist_wheel):
    """A wheel whose name says of what platform it is: of any, where no compiler was there for the optional parts."""

    def get_tag(self) -> tuple[str, str, str]:
        """As `bdist_wheel.get_tag`, by what has been built."""
        built = Path(str(self.bdist_dir))
        if built.is_dir() and not any(path.suffix in COMPILED for path in built.rglob("*")):
            self.root_is_pure = True
        return super().get_tag()


class Sources(sdist):
    """Sources in an archive that tells nothing of who packed it, and when."""

    def make_archive(self, *given: Any, **named: Any) -> str:
        """As `sdist.make_archive`."""
        path = super().make_archive(*given, **named)
        epoch = os.environ.get("SOURCE_DATE_EPOCH")
        if epoch and path.endswith(".tar.gz"):
            Path(path).write_bytes(repacked(Path(path).read_bytes(), int(epoch)))
        return path


def repacked(archive: bytes, time: int) -> bytes:
    """A .tar.gz in order of names, all of one time and nobody's, a program still a program."""
    plain = BytesIO()
    with (
        tarfile.open(fileobj=BytesIO(archive), mode="r:gz") as old,
        tarfile.open(fileobj=plain, mode="w", format=tarfile.PAX_FORMAT) as new,
    ):
        for member in sorted(old.getmembers(), key=lambda one: one.name):
            member.mtime, member.uid, member.gid, member.uname, member.gname = time, 0, 0, "", ""
            member.mode = 0o755 if member.isdir() or member.mode & 0o100 else 0o644
            member.pax_headers = {}
            new.addfile(member, old.extractfile(member) if member.isfile() else None)
    return gzip.compress(plain.getvalue(), mtime=time)
