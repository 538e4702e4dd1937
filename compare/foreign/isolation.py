"""Runs somebody else's engine in a process of its own, which is ended if it hangs, forks, exits, prints or eats memory.

What such an engine hands back comes over a pipe, pickled; what it declares is read here. This keeps accidents away, not
malice: a module that is imported, and a pickle that is read, can do anything.

Where there is `fork` the process is a copy of this one, so that the engine may be of any class. Elsewhere it is begun
anew, and the engine is pickled too: see `FORKS`.
"""

from __future__ import annotations

import contextlib
import faulthandler
import io
import os
import pickle
import queue
import signal
import struct
import subprocess
import sys
import threading
import time as clock
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import partial
from math import inf
from pathlib import Path
from typing import Any, BinaryIO, ClassVar, NoReturn, cast

from ...scenarios.errors import SceneError, TimeIsUp
from ...scenarios.numbers import precision
from ...scenarios.scene import Scene
from ...scenarios.trajectory import OnProgress, Progress
from ..deadline import AGAIN_SECONDS, Clock, OutOfTime, clock_at_work, time_limit
from ..side_by_side import FORKS, end_with_parent
from ..validation import EngineError

ISOLATE = "TRUEBREAK_ISOLATE"
"""The environment variable that has every run of somebody else's engine isolated; worker processes inherit it."""

MEMORY = "TRUEBREAK_MAX_MEMORY"
"""The environment variable that says how many megabytes (of 2**20 bytes) such a process may take; it implies that."""

LIMITS_MEMORY = sys.platform == "linux"
"""Whether the system can limit the memory of a process; macOS accepts a limit, and does not mind it."""

MEMORY_SHARE = 2
"""Without a number, such a process may take this part of the machine's memory: one over it."""

GRACE_SECONDS = 2.0
"""What an engine is left to end by itself, once its seconds are over, before it is ended."""

SENDING_SECONDS = 30.0
"""What a run that has ended may take to be sent, and as long again as it took itself."""

LOOK_SECONDS = 0.1
"""How often a process that says nothing is looked for."""

PROGRESS_SECONDS = 0.1
"""How often an engine's progress is sent on, at most."""

PRINTED = 60
"""Characters of what an engine printed that are shown."""

PICKLABLE = "use classes at the top of a module, and no open files, locks or functions without a name in what they hold"

FORKED = "run began another process by fork, which is refused: begin it with subprocess, or leave out the limits"

ENDS: dict[str, type[BaseException]] = {"time": TimeIsUp, "engine": EngineError, "scene": SceneError}
"""What is raised here for what a run came to there."""

HEADER = struct.Struct("<Q")
"""What stands before each thing that is sent: how many bytes it has."""


_warned: set[str] = set()
"""Engines of which this process has said that they print: once is enough."""


class EngineWarning(UserWarning):
    """An engine that was run apart printed something.

    Attributes:
        in_one_line: tells the command line to show it as such.
    """

    in_one_line = True


def checked_megabytes(megabytes: Any) -> int | None:
    """A limit of memory that can be set; None: none.

    Raises:
        SceneError: for any other, and where the system has no such limits.
    """
    if megabytes is None:
        return None
    if not isinstance(megabytes, int) or isinstance(megabytes, bool) or not 0 < megabytes < 1 << 40:
        raise SceneError(f"max_memory = {megabytes!r}: must be a whole number of megabytes from 1")
    if not LIMITS_MEMORY:
        raise SceneError("max_memory: this system cannot limit the memory of a process; leave it out")
    return megabytes


@contextmanager
def isolated(*, max_memory: int | None = None) -> Iterator[None]:
    """Every run of somebody else's engine in the body is made in a process of its own, also those of worker processes.

    Args:
        max_memory: megabytes that it may take; None: half of the machine's.

    Raises:
        SceneError: for a limit that cannot be set.

    >>> from truebreak.compare import compare
    >>> from truebreak.compare.foreign import RecordedEngine
    >>> from truebreak.scenarios import Circle, Scene
    >>> class Leaves(RecordedEngine):
    ...     __module__ = "mine"
    ...
    ...     def play(self, scene, recording):
    ...         import os
    ...         os._exit(3)
    >>> with isolated():
    ...     compare(Scene([Circle(0, 0, vx=1), Circle(4, 0)]), [Leaves()])
    Traceback (most recent call last):
      ...
    truebreak.compare.validation.EngineError: engine 'mine': run ended its process, with exit code 3
    """
    given = {ISOLATE: "1", **({} if max_memory is None else {MEMORY: str(checked_megabytes(max_memory))})}
    before = {name: os.environ.get(name) for name in given}
    os.environ.update(given)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value


@dataclass(frozen=True)
class Apart:
    """How a run that is made in a process of its own is limited.

    Attributes:
        watch: the seconds that are at work; None: no limit.
        megabytes: of memory; None: no limit.
        asked: whether the user named the megabytes.
        inside: whether this is such a process: an engine that runs others there does so without further ones.
    """

    inside: ClassVar[bool] = False

    watch: Clock | None
    megabytes: int | None
    asked: bool

    @classmethod
    def wanted(cls) -> Apart | None:
        """What is asked for here and now; None: that runs be made in this process.

        Raises:
            SceneError: for a limit of memory in the environment that is none.
        """
        told, watch = os.environ.get(MEMORY, ""), clock_at_work()
        if cls.inside:
            return None
        if not told and watch is None and os.environ.get(ISOLATE, "") in ("", "0"):
            return None
        try:
            megabytes = checked_megabytes(int(told)) if told else None
        except ValueError:
            raise SceneError(f"{MEMORY} = {told!r}: must be a whole number of megabytes from 1") from None
        if megabytes is None and LIMITS_MEMORY:
            return cls(watch, os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE") // MEMORY_SHARE >> 20, False)
        return cls(watch, megabytes, megabytes is not None)

    @property
    def words(self) -> str:
        """The limit of memory."""
        return f"{self.megabytes:,} MB of memory ({'--max-memory' if self.asked else 'half of what the machine has'})"


@dataclass(frozen=True)
class Request:
    """What the other process has to do.

    Attributes:
        run: the run, given what is to be called with its progress.
        engine: whose it is, as errors name it.
        scene: what is run; it is not sent back.
        late: when the run is to end by itself, by the machine's monotonic clock; None: no limit.
        told: what a message says of them.
        memory: the limits of memory.
        noted: whether progress is to be sent.
    """

    run: Callable[[OnProgress | None], Any]
    engine: str
    scene: Scene
    late: float | None
    told: float | None
    memory: Apart
    noted: bool

    def error(self, what: str) -> EngineError:
        """An error that names the engine."""
        return EngineError(f"engine {self.engine!r}: {what}")


def run_apart(
    run: Callable[[OnProgress | None], Any], name: str, scene: Scene, progress: OnProgress | None, apart: Apart
) -> Any:
    """What a run of an engine of that name hands back, made in a process of its own.

    Raises:
        EngineError: if the process ends before, or does what it must not.
        SceneError: as the run itself.
        TimeIsUp: if the seconds are over, and it handed nothing back.
    """
    watch = apart.watch
    if watch is not None and watch.over:
        raise watch.is_up()
    seconds = None if watch is None else watch.left()
    late, told = (None, None) if watch is None or seconds is None else (clock.monotonic() + seconds, watch.asked)
    request = Request(run, name, scene, late, told, replace(apart, watch=None), progress is not None)
    process = IsolatedProcess(request)
    try:
        return process.outcome(progress, watch)
    finally:
        process.end()


# -- this side


class _Copy:
    """A copy of this process, as `subprocess.Popen` shows one that is begun anew."""

    def __init__(self, request: Request) -> None:
        mine, its = os.pipe()
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DeprecationWarning)  # that this one has threads: see `_work`
            self.pid = os.fork()
        if self.pid == 0:
            os.setsid()
            os.close(mine)
            _work(request, os.fdopen(its, "wb", buffering=0))
        os.close(its)
        self.stdout = os.fdopen(mine, "rb")
        self._code: int | None = None

    def poll(self) -> int | None:
        """The exit code, negative for a signal; None: it has not ended yet."""
        if self._code is None:
            found, status = os.waitpid(self.pid, os.WNOHANG)
            if found:
                self._code = os.waitstatus_to_exitcode(status)
        return self._code


def _begun_anew(request: Request) -> Any:
    """A process that is given the engine as a pickle.

    Raises:
        EngineError: if the engine cannot be pickled.
    """
    try:
        packed = pickle.dumps(request)
    except Exception as error:
        reason = " ".join(str(error).split())
        raise request.error(f"cannot be sent to a process of its own: {reason}; {PICKLABLE}") from None
    if b"__main__" in packed:
        raise request.error(
            f"cannot be sent to a process of its own: it is not picklable, being of the script that runs; {PICKLABLE}"
        )
    where = [path or str(Path.cwd()) for path in sys.path]
    child = subprocess.Popen(
        [sys.executable, "-c", f"from {__name__} import main; main()"],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        start_new_session=True,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(where)},
    )
    assert child.stdin is not None
    with contextlib.suppress(OSError), child.stdin:  # it may have died, which is seen later
        child.stdin.write(packed)
    return child


class IsolatedProcess:
    """The process that carries a request out, as it is seen from here."""

    def __init__(self, request: Request) -> None:
        self.request = request
        self._process: Any = _Copy(request) if FORKS else _begun_anew(request)
        # no SimpleQueue: one whose wait a signal ends just as it is over waits for ever (CPython 3.11)
        self._said: queue.Queue[bytes | None] = queue.Queue()
        threading.Thread(target=_listen, args=(self._process.stdout, self._said), daemon=True).start()

    def outcome(self, progress: OnProgress | None, watch: Clock | None) -> Any:
        """What it hands back.

        Raises:
            EngineError, SceneError, TimeIsUp: see `run_apart`.
        """
        request = self.request
        began, late = clock.monotonic(), None if request.late is None else request.late + GRACE_SECONDS
        while True:
            if watch is not None and late is not None and clock.monotonic() >= late:
                raise TimeIsUp(f"{watch.is_up()}; engine {request.engine!r} did not end by itself, and was ended")
            over = self._process.poll() is not None
            try:
                packed = self._said.get(timeout=LOOK_SECONDS)
            except queue.Empty:
                if not over:
                    continue
                packed = None
            if packed is None:
                raise request.error(f"run ended its process, {self._how}")
            kind, told = self._read(packed)
            if kind == "progress" and progress is not None:
                with contextlib.suppress(*([] if watch is None else [TimeIsUp])):  # it ends by itself, with what it has
                    progress(told)
            elif kind == "ran":
                late = 2 * clock.monotonic() + SENDING_SECONDS - began
            elif kind == "printed":
                if request.engine not in _warned:
                    _warned.add(request.engine)
                    warnings.warn(f"engine {request.engine!r} printed {told}", EngineWarning, stacklevel=2)
            elif kind == "handed":
                return told
            elif kind in ENDS:
                raise ENDS[kind](told)

    def _read(self, packed: bytes) -> Any:
        try:
            return _Reader(io.BytesIO(packed), self.request.scene).load()
        except Exception as error:
            reason = " ".join(str(error).split())
            raise self.request.error(f"what run gave cannot be read here: {type(error).__name__}: {reason}") from None

    @property
    def _how(self) -> str:
        """How it ended, in words."""
        late = clock.monotonic() + GRACE_SECONDS
        while (code := self._process.poll()) is None and clock.monotonic() < late:
            clock.sleep(AGAIN_SECONDS)
        if code is None:
            return "as it closed all that it had open"
        if code >= 0:
            return f"with exit code {code}"
        with contextlib.suppress(ValueError):
            return f"by {signal.Signals(-code).name}"
        return f"by signal {-code}"

    def end(self) -> None:
        """Ends it, and all that it has started."""
        self._kill()  # first of all, whatever comes in between
        while self._process.poll() is None:
            clock.sleep(AGAIN_SECONDS / 50)
        self._kill()

    def _kill(self) -> None:
        with contextlib.suppress(OSError):
            if hasattr(os, "killpg"):
                os.killpg(self._process.pid, signal.SIGKILL)
            else:
                os.kill(self._process.pid, signal.SIGTERM)


def _listen(pipe: BinaryIO, said: queue.Queue[bytes | None]) -> None:
    """Takes in what the other process says, until it says nothing more: None."""
    with contextlib.suppress(OSError, ValueError), pipe:
        while len(header := pipe.read(HEADER.size)) == HEADER.size:
            (size,) = HEADER.unpack(header)
            packed = pipe.read(size)
            if len(packed) < size:
                break
            said.put(packed)
    said.put(None)


# -- the other side


def main() -> NoReturn:
    """Carries out the request on standard input, in a process that was begun anew."""
    pipe = os.fdopen(os.dup(1), "wb", buffering=0)
    _work(pickle.load(sys.stdin.buffer), pipe)


def _work(request: Request, pipe: BinaryIO) -> NoReturn:
    """All that the other process does.

    It may be a copy of one that has threads: locks that they hold stay shut here, so truebreak's own is made anew, and
    what is printed goes another way.
    """
    channel = _Channel(pipe, request)
    try:
        Apart.inside = True
        precision.without_other_threads()
        _alone()
        printed = _Printed()
        kept = sys.stdout, sys.stderr  # whose buffers are those of the process of which this is a copy
        sys.stdout = sys.stderr = io.TextIOWrapper(
            cast(BinaryIO, printed), encoding="utf-8", errors="replace", write_through=True
        )
        if hasattr(os, "register_at_fork"):
            os.register_at_fork(before=partial(channel.last, "engine", f"engine {request.engine!r}: {FORKED}"))
        free = _limit_memory(request.memory.megabytes)
        kind, told = _outcome(request, channel)
        channel.say("ran", None)
        if printed.some:
            channel.say("printed", printed.told)
        try:
            channel.say(kind, told)
        except MemoryError:
            free()
            channel.say("engine", _too_much(request))
        except Exception as error:
            reason = " ".join(str(error).split())
            channel.say("engine", f"engine {request.engine!r}: what run gave cannot be pickled: {reason}; {PICKLABLE}")
        del kept
    except BaseException as error:
        with contextlib.suppress(BaseException):
            channel.say("engine", f"engine {request.engine!r}: {type(error).__name__}: {error}")
    finally:
        os._exit(0)


def _outcome(request: Request, channel: _Channel) -> tuple[str, Any]:
    """What comes of the run: a word for what it is, and the thing itself."""
    try:
        seconds = None if request.late is None else max(request.late - clock.monotonic(), AGAIN_SECONDS)
        with time_limit(seconds, request.told) as watch:
            return "handed", request.run(watch.watched(channel.progress if request.noted else None))
    except (OutOfTime, TimeIsUp) as outcome:
        return "time", str(outcome)
    except EngineError as error:
        if isinstance(error.__cause__, MemoryError):
            return "engine", _too_much(request)
        return "engine", str(error)
    except SceneError as error:
        return "scene", str(error)


def _too_much(request: Request) -> str:
    return f"engine {request.engine!r}: run needed more than {request.memory.words}"


class _Channel:
    """What the other process says to this one, by one pipe."""

    def __init__(self, pipe: BinaryIO, request: Request) -> None:
        self._pipe, self._request = pipe, request
        self._number, self._last = os.getpid(), -inf

    def say(self, kind: str, told: Any) -> None:
        """Sends one thing. What a fork of C code has made says nothing, and ends."""
        packed = io.BytesIO()
        _Packer(packed, self._request.scene).dump((kind, told))
        if os.getpid() != self._number:
            os._exit(0)
        view = memoryview(HEADER.pack(packed.tell()) + packed.getvalue())
        while view:
            view = view[self._pipe.write(view) :]

    def last(self, kind: str, told: Any) -> None:
        """Sends one thing, and ends."""
        try:
            self.say(kind, told)
        finally:
            os._exit(0)

    def progress(self, state: Progress) -> None:
        """Sends how far the run is, now and then."""
        now = clock.monotonic()
        if now >= self._last + PROGRESS_SECONDS:
            self._last = now
            self.say("progress", state)


class _Packer(pickle.Pickler):
    """Leaves the scene out, which is there on the other side."""

    def __init__(self, file: BinaryIO, scene: Scene) -> None:
        super().__init__(file, protocol=pickle.HIGHEST_PROTOCOL)
        self._scene = scene

    def persistent_id(self, obj: Any) -> str | None:
        """As `pickle.Pickler.persistent_id`."""
        return "scene" if obj is self._scene else None


class _Reader(pickle.Unpickler):
    """Puts the scene in again."""

    def __init__(self, file: BinaryIO, scene: Scene) -> None:
        super().__init__(file)
        self._scene = scene

    def persistent_load(self, pid: Any) -> Scene:
        """As `pickle.Unpickler.persistent_load`."""
        return self._scene


class _Printed(io.RawIOBase):
    """Counts what is printed, and keeps how it begins."""

    def __init__(self) -> None:
        self._begins, self._lines, self._open = b"", 0, False

    def writable(self) -> bool:
        """As `io.RawIOBase.writable`."""
        return True

    def write(self, data: Any, /) -> int:
        """As `io.RawIOBase.write`."""
        data = bytes(data)
        self._begins += data[: 4 * PRINTED - len(self._begins)]
        self._lines += data.count(b"\n")
        self._open = not data.endswith(b"\n") if data else self._open
        return len(data)

    @property
    def some(self) -> bool:
        """Whether anything was printed."""
        return bool(self._begins)

    @property
    def told(self) -> str:
        """How much it was, and how it begins."""
        begins = " ".join(self._begins.decode("utf-8", "replace").split())[:PRINTED]
        lines = self._lines + self._open
        return f"{lines:,} line{' that is' if lines == 1 else 's that are'} left out: {begins!r}"


def _alone() -> None:
    """Gives a process what is its own: no signals but those that end it, no streams, and an end with its parent's."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    for name in ("SIGTERM", "SIGHUP"):
        if hasattr(signal, name):
            signal.signal(getattr(signal, name), signal.SIG_DFL)
    faulthandler.disable()  # whose words would go where this process's parent writes
    nowhere = os.open(os.devnull, os.O_RDWR)
    for stream in range(3):
        os.dup2(nowhere, stream)
    end_with_parent(os.getppid(), group=True)


def _limit_memory(megabytes: int | None) -> Callable[[], None]:
    """Limits what this process may take from now on; gives what lifts that."""
    if megabytes is None or not LIMITS_MEMORY:
        return lambda: None
    import resource

    taken = int(Path("/proc/self/statm").read_text("ascii").split()[0]) * resource.getpagesize()
    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    wanted = taken + (megabytes << 20)
    if hard not in (-1, resource.RLIM_INFINITY):
        wanted = min(wanted, hard)
    resource.setrlimit(resource.RLIMIT_AS, (wanted, hard))
    return lambda: resource.setrlimit(resource.RLIMIT_AS, (soft, hard))
