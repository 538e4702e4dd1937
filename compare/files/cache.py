"""What is kept between calls: certified runs and what is computed of them, each found by all that decides it."""

from __future__ import annotations

import contextlib
import os
import sys
import time as clock
import warnings
import zlib
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ...exact.exact_engine import ExactEngine
from ...exact.exact_motion import ExactMotion
from ...exact.simulation.decider import run_limits
from ...scenarios.errors import SceneError
from ...scenarios.lazy import VERSION, frozen
from ...scenarios.trajectory import StopReason
from ..engines import engine as engine_named

if TYPE_CHECKING:
    from ...exact.simulation.decider import Limits
    from ...scenarios.engine import Engine
    from ...scenarios.numbers.quantity import QuantityLike
    from ...scenarios.scene import Scene
    from ...scenarios.trajectory import OnProgress, Trajectory

FOLDER = "TRUEBREAK_CACHE"
"""The environment variable that names another folder, or, empty, none."""

LEAST_SECONDS = 1.0
"""Processor time of a run from which on it is kept: below, keeping costs a user's patience nothing."""

LOAD_SECONDS = 1e-4
"""Processor time in which an event of a kept run is read: 80 to 90 microseconds, measured on gases of 3 to 40 discs."""

SHARE = 4
"""How many times what reading takes a run must have taken to be kept."""

MOST_BYTES = 256 << 20
"""Size of all kept runs; the longest unused go first."""

LARGEST_SHARE = 8
"""A run that takes more than this part of it is not kept."""

DAMAGE = (OSError, EOFError, UnicodeDecodeError, zlib.error)


class CacheWarning(UserWarning):
    """A kept run was damaged, or could not be kept; the run is made all the same.

    Attributes:
        in_one_line: tells the command line to show it as such.
    """

    in_one_line = True


def cache_folder() -> Path | None:
    """Where runs are kept; None: nowhere."""
    named = os.environ.get(FOLDER)
    if named is not None:
        return Path(named) if named else None
    if sys.platform == "linux":  # what platformdirs says too, whose import takes longer than a short run
        home, base = os.environ.get("HOME", ""), os.environ.get("XDG_CACHE_HOME", "")
        if base.startswith("/"):
            return Path(base, "truebreak")
        if not base and home.startswith("/"):
            return Path(home, ".cache", "truebreak")
    from platformdirs import user_cache_path

    return user_cache_path("truebreak", appauthor=False)


def cached(engine: Engine) -> Engine:
    """An engine that looks for kept runs first, if it is the exact one; else the engine itself."""
    if type(engine) is not ExactEngine or cache_folder() is None:
        return engine
    return CachedEngine(engine.max_bits, engine.ties, engine.work)


def reference_named(text: str, *, cache: bool) -> Engine:
    """The engine that a text names, which looks for kept runs first if that is wanted."""
    return cached(engine_named(text)) if cache else engine_named(text)


@frozen
class CachedEngine(ExactEngine):
    """The exact engine, which keeps runs that cost something, and gives them again.

    A kept run is the run itself: events, proofs, log. One that Ctrl-C or the user's seconds ended is not kept.
    """

    def run(
        self,
        scene: Scene,
        *,
        until: QuantityLike | None = None,
        events: int | None = None,
        progress: OnProgress | None = None,
    ) -> Trajectory:
        """As `ExactEngine.run`."""
        folder = cache_folder()
        if folder is None:
            return super().run(scene, until=until, events=events, progress=progress)
        if _some(folder, _start(scene, run_limits(scene, until, events))):
            kept = _kept(self._path(folder, scene, until, events), scene)
            if kept is not None:
                return kept
        began = clock.process_time()
        run = super().run(scene, until=until, events=events, progress=progress)
        cost = clock.process_time() - began
        ended = run.stop.reason not in (StopReason.INTERRUPTED, StopReason.BUDGET)
        if ended and cost >= max(LEAST_SECONDS, SHARE * LOAD_SECONDS * len(run.events)):
            _keep(self._path(folder, scene, until, events), run)
        return run

    def _path(self, folder: Path, scene: Scene, until: QuantityLike | None, events: int | None) -> Path:
        return folder / f"{self.key(scene, until, events)}.json.gz"

    def key(self, scene: Scene, until: QuantityLike | None = None, events: int | None = None) -> str:
        """What tells a run from every other: scene, policy, limits, settings and version.

        >>> from truebreak.scenarios import catalogue
        >>> lee = catalogue.build("lee")
        >>> CachedEngine().key(lee, events=2) == CachedEngine().key(lee.with_changes(name="other"), events=2)
        True
        >>> CachedEngine().key(lee, events=2) == CachedEngine().key(lee, events=3)
        False
        """
        import json
        from hashlib import sha256

        limits = run_limits(scene, until, events)
        told = [
            VERSION,
            scene.digest,
            str(scene.tie_policy),
            None if limits.until is None else limits.until.text(),
            limits.events,
            limits.to_return,
            [self.max_bits, self.ties, self.work],
        ]
        return f"{_start(scene, limits)}{sha256(json.dumps(told).encode()).hexdigest()}"


def _start(scene: Scene, limits: Limits) -> str:
    """What a key begins with: told without the scene's digest, so that most short runs need none."""
    return f"{len(scene.circles)}-{len(scene.walls)}-{limits.events}-"


def _some(folder: Path, start: str) -> bool:
    """Whether some kept run has a key that begins so."""
    try:
        return any(path.name.startswith(start) for path in folder.iterdir())
    except (FileNotFoundError, NotADirectoryError):
        return False
    except OSError:
        return True


def _kept(path: Path, scene: Scene) -> Trajectory | None:
    """A kept run, for a scene that may bear another name; None if there is none, or none that is whole."""
    try:
        packed = path.read_bytes()
    except (FileNotFoundError, NotADirectoryError):
        return None
    except OSError as error:
        return _damaged(path, str(error))
    import gzip

    from .saved import run_of

    try:
        text = gzip.decompress(packed).decode()
    except DAMAGE as error:
        return _damaged(path, str(error))
    try:
        run = run_of(text, str(path))
    except SceneError:
        return _damaged(path, "its digest is not that of what it holds")
    if run.scene.digest != scene.digest:
        return _damaged(path, "it is of another scene")
    with contextlib.suppress(OSError):
        os.utime(path)
    assert isinstance(run.motion, ExactMotion)
    run.motion.log.scene = scene.surfaces
    return replace(run, scene=scene)


def _damaged(path: Path, why: str) -> None:
    warnings.warn(f"{path}: a kept run is damaged ({why}); it is made again", CacheWarning, stacklevel=2)
    with contextlib.suppress(OSError):
        path.unlink()


def _keep(path: Path, run: Trajectory) -> None:
    """Writes a run beside its place and moves it there; makes room first."""
    import gzip

    from .saved import saved_run

    try:
        data = gzip.compress(saved_run(run).encode(), compresslevel=1, mtime=0)
    except SceneError:  # a scene that no file can hold
        return
    if len(data) <= MOST_BYTES // LARGEST_SHARE:
        _write(path, data)


def _write(path: Path, data: bytes) -> None:
    from ...scenarios.disk import write_file

    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        _make_room(path.parent, len(data))
        write_file(path, data, lasting=False)  # one that a power cut damages is told by its digest, and made again
    except OSError as error:
        warnings.warn(f"{path.parent}: a run cannot be kept: {error.strerror or error}", CacheWarning, stacklevel=2)


def _make_room(folder: Path, size: int) -> None:
    """Removes the longest unused runs until a new one fits."""
    found: list[tuple[float, int, Path]] = []
    for path in folder.iterdir():
        with contextlib.suppress(OSError):
            told = path.stat()
            if path.name.endswith(".json.gz"):
                found.append((told.st_mtime, told.st_size, path))
    taken = size + sum(each for _, each, _ in found)
    for _, each, path in sorted(found):
        if taken <= MOST_BYTES:
            return
        with contextlib.suppress(OSError):
            path.unlink()
        taken -= each


# -- What is computed of a certified run: JSON values, kept and found by a key.

VALUE_SECONDS = 0.02
"""Processor time from which on a value is kept: reading one takes 2 to 4 milliseconds."""

CODE = ("scenarios", "exact", "floating", "compare")
"""Folders whose files decide such a value; where one of them is changed, nothing that was kept before is found."""


def kept_value(key: Sequence[Any], compute: Callable[[], Any]) -> Any:
    """A JSON value, as it was kept under a key; else computed, and kept if that cost something.

    Args:
        key: all that decides the value, beside the code: JSON values, a scene's digest among them.
    """
    folder = cache_folder()
    if folder is None:
        return compute()
    import gzip
    import json
    from hashlib import sha256

    told = json.dumps([VERSION, _code(), *key])
    path = folder / f"value-{sha256(told.encode()).hexdigest()}.json.gz"
    try:
        kept = json.loads(gzip.decompress(path.read_bytes()))
        if kept["key"] == told:
            with contextlib.suppress(OSError):
                os.utime(path)
            return kept["value"]
    except (FileNotFoundError, NotADirectoryError):
        pass
    except (*DAMAGE, ValueError, KeyError, TypeError) as error:
        _damaged(path, str(error))
    began = clock.process_time()
    value = compute()
    if clock.process_time() - began >= VALUE_SECONDS:
        _write(path, gzip.compress(json.dumps({"key": told, "value": value}).encode(), compresslevel=1, mtime=0))
    return value


@lru_cache(maxsize=1)
def _code() -> str:
    """Which files compute values: their names, sizes and times."""
    from hashlib import sha256

    top = Path(__file__).parents[2]
    files = sorted(path for name in CODE for path in (top / name).rglob("*") if path.suffix in (".py", ".so", ".pyd"))
    found = [(str(path.relative_to(top)), (told := path.stat()).st_size, told.st_mtime_ns) for path in files]
    return sha256(repr(found).encode()).hexdigest()
