"""Tasks carried out side by side, each in a copy of this process: what comes of them is as one after the other.

Where there is `fork` a task may be any function, and nothing that it works on is sent: a copy has it all. What it
gives comes back pickled. Elsewhere, and with one job, each task is carried out here when its result is asked for.
"""

from __future__ import annotations

import contextlib
import io
import os
import pickle
import select
import signal
import struct
import sys
import threading
import time as clock
import warnings
from collections import deque
from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass, field
from math import inf
from typing import Any, NamedTuple, NoReturn, TypeAlias

from ..scenarios.errors import SceneError

FORKS = hasattr(os, "fork") and sys.platform != "darwin"
"""Whether processes are copies of this one; frameworks of macOS do not survive that."""

HEADER = struct.Struct("<Q")
"""What stands before each thing that a copy sends: how many bytes it has."""

BLOCK = 1 << 16
"""Bytes that are read at once."""

PROGRESS_SECONDS = 0.1
"""How often a copy sends how far it is, at most."""

Task: TypeAlias = Callable[[Callable[[Any], None] | None], Any]
"""Is given what it reports its progress to, or None, and gives a result that can be pickled."""


def cores() -> int:
    """The processors that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


class _Told(NamedTuple):
    """What a copy says at its end: the value or what was raised, and what was printed and warned of meanwhile."""

    value: Any
    raised: BaseException | None
    printed: tuple[str, str]
    warned: tuple[tuple[Any, ...], ...]


@dataclass
class _Copy:
    """A copy at work, as it is seen from here."""

    pid: int
    pipe: int
    read: bytearray = field(default_factory=bytearray)
    progress: list[Any] = field(default_factory=list[Any])
    told: _Told | None = None
    over: bool = False

    def listen(self, known: Sequence[object]) -> None:
        """Reads what there is; `over` once there will be no more."""
        data = os.read(self.pipe, BLOCK)
        self.read += data
        while len(self.read) >= HEADER.size and len(self.read) >= HEADER.size + (
            size := HEADER.unpack_from(self.read)[0]
        ):
            packed = io.BytesIO(bytes(self.read[HEADER.size : HEADER.size + size]))
            del self.read[: HEADER.size + size]
            told = _Unpacker(packed, known).load()
            if isinstance(told, _Told):
                self.told = told
            else:
                self.progress = [told]
        if not data:
            self.end()

    def end(self, *, kill: bool = False) -> None:
        """Takes its leave."""
        if self.over:
            return
        self.over = True
        os.close(self.pipe)
        if kill:
            with contextlib.suppress(ProcessLookupError):
                os.kill(self.pid, signal.SIGKILL)
        with contextlib.suppress(ChildProcessError):
            os.waitpid(self.pid, 0)


class SideBySide:
    """Tasks by name, carried out in up to so many copies of this process; those added first begin first.

    Whoever asks for a result gets what the task gives, or what it raises, as if it were called there and then; what it
    prints and warns of comes with it. A task whose copy came to nothing, or whose result cannot be sent, is carried
    out here.

    Args:
        jobs: how many copies; None: one for each processor. 1: none, all is done here.
        known: objects that are not sent but are the same here and there.

    Raises:
        SceneError: for jobs that are no whole number from 1.

    >>> with SideBySide(2) as tasks:
    ...     for k in range(3):
    ...         tasks.add(k, lambda progress, k=k: k * k)
    ...     [tasks.result(k) for k in range(3)]
    [0, 1, 4]
    """

    inside = False
    """Whether this process is itself such a copy, which makes no more."""

    def __init__(self, jobs: int | None, known: Sequence[object] = ()) -> None:
        if jobs is not None and (isinstance(jobs, bool) or not isinstance(jobs, int) or jobs < 1):
            raise SceneError(f"jobs = {jobs!r}: must be a whole number from 1; None is one for each processor")
        self.jobs = (cores() if jobs is None else jobs) if FORKS and not SideBySide.inside else 1
        self.known = tuple(known)
        self._tasks: dict[Hashable, Task] = {}
        self._waiting: deque[Hashable] = deque()
        self._copies: dict[Hashable, _Copy] = {}
        self._warned: dict[Any, Any] = {}

    def __enter__(self) -> SideBySide:
        return self

    def __exit__(self, *error: object) -> None:
        self.end()

    def end(self) -> None:
        """Drops what nobody asked for."""
        for copy in self._copies.values():
            copy.end(kill=True)
        self._tasks.clear()
        self._waiting.clear()
        self._copies.clear()

    @property
    def together(self) -> bool:
        """Whether more than one task is carried out at once."""
        return self.jobs > 1

    def add(self, name: Hashable, task: Task) -> None:
        """One more."""
        self._tasks[name] = task
        self._waiting.append(name)

    def __contains__(self, name: Hashable) -> bool:
        return name in self._tasks

    def result(self, name: Hashable, progress: Callable[[Any], None] | None = None) -> Any:
        """What a task gives; the others go on meanwhile.

        Args:
            progress: called with what this one reports of its progress.

        Raises:
            BaseException: what the task raises.
        """
        if name in self._waiting:
            self._waiting.remove(name)
            self._waiting.appendleft(name)
        self._begin(progress is not None)
        copy = self._copies.get(name)
        while copy is None and self.together and name in self._waiting:
            self._listen()
            self._begin(progress is not None)
            copy = self._copies.get(name)
        while copy is not None and not copy.over:
            self._listen()
            self._begin(progress is not None)
            states, copy.progress = copy.progress, []
            for state in states:
                if progress is not None:
                    progress(state)
        task = self._tasks.pop(name)
        told = None if copy is None else self._copies.pop(name).told
        if told is None:
            with contextlib.suppress(ValueError):
                self._waiting.remove(name)
            return task(progress)
        for text, stream in zip(told.printed, (sys.stdout, sys.stderr), strict=True):
            if text:
                stream.write(text)
        for message, category, file, line in told.warned:
            warnings.warn_explicit(message, category, file, line, registry=self._warned)
        if told.raised is not None:
            raise told.raised
        return told.value

    def _begin(self, noted: bool) -> None:
        """Begins what there is room for, where it is worth it: one that is alone is done here."""
        if not self.together or (not self._copies and len(self._waiting) < 2):
            return
        while self._waiting and sum(not copy.over for copy in self._copies.values()) < self.jobs:
            name = self._waiting.popleft()
            self._copies[name] = self._copied(self._tasks[name], noted)

    def _listen(self) -> None:
        """Waits until some copy says something, and hears it."""
        waiting = {copy.pipe: copy for copy in self._copies.values() if not copy.over}
        poll = select.poll()
        for pipe in waiting:
            poll.register(pipe, select.POLLIN)
        for pipe, _ in poll.poll():
            waiting[pipe].listen(self.known)

    def _copied(self, task: Task, noted: bool) -> _Copy:
        """A copy that has begun with a task."""
        mine, its = os.pipe()
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DeprecationWarning)  # that this one may have threads: see `_work`
            parent, pid = os.getpid(), os.fork()
        if pid == 0:
            os.close(mine)
            for copy in self._copies.values():
                if not copy.over:
                    os.close(copy.pipe)
            _work(task, noted, its, self.known, parent)
        os.close(its)
        return _Copy(pid, mine)


# -- the other side

DEATH_SIGNAL = 1
"""PR_SET_PDEATHSIG of Linux: the signal that a process gets as its parent ends."""

LOOK_SECONDS = 0.1
"""How often a process looks whether its parent is there, where the system does not say so."""


def end_with_parent(parent: int, *, group: bool = False) -> None:
    """Ends this process as soon as its parent has ended, and its group with it if it has one of its own."""
    if sys.platform == "linux":  # what hangs in C leaves no thread a chance to look
        import ctypes

        ctypes.CDLL(None).prctl(DEATH_SIGNAL, int(signal.SIGKILL))
    threading.Thread(target=_end_with, args=(parent, group), daemon=True).start()


def _end_with(parent: int, group: bool) -> None:
    while os.getppid() == parent:
        clock.sleep(LOOK_SECONDS)
    if group and hasattr(os, "killpg"):
        os.killpg(0, signal.SIGKILL)
    os._exit(1)


def _work(task: Task, noted: bool, pipe: int, known: Sequence[object], parent: int) -> NoReturn:
    """All that a copy does.

    It may be a copy of a process that has threads: locks that they hold stay shut here, so truebreak's own is made
    anew, and what is printed goes another way.
    """
    from ..scenarios.numbers import precision

    try:
        SideBySide.inside = True
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        for name in ("SIGTERM", "SIGHUP"):
            signal.signal(getattr(signal, name), signal.SIG_DFL)
        precision.without_other_threads()
        end_with_parent(parent)
        kept = sys.stdout, sys.stderr  # whose buffers are those of the process of which this is a copy
        out, err = io.StringIO(), io.StringIO()
        sys.stdout, sys.stderr = out, err
        told = _outcome(task, _Reporter(pipe) if noted else None)
        _send(pipe, told._replace(printed=(out.getvalue(), err.getvalue())), known)
        del kept
    finally:
        os._exit(0)


class _Reporter:
    """Sends a task's progress on, now and then."""

    def __init__(self, pipe: int) -> None:
        self._pipe, self._last = pipe, -inf

    def __call__(self, state: Any) -> None:
        now = clock.monotonic()
        if now >= self._last + PROGRESS_SECONDS:
            self._last = now
            _send(self._pipe, state, ())


def _outcome(task: Task, progress: _Reporter | None) -> _Told:
    with warnings.catch_warnings(record=True) as warned:
        value, raised = None, None
        try:
            value = task(progress)
        except BaseException as error:
            raised = _sendable(error)
        return _Told(value, raised, ("", ""), tuple((w.message, w.category, w.filename, w.lineno) for w in warned))


def _sendable(error: BaseException) -> BaseException:
    """The same; what is no fault of the input has the place where it was raised as a note.

    Raises:
        Exception: where it would come back as something else.
    """
    import traceback

    same = pickle.loads(pickle.dumps(error))
    if type(same) is not type(error) or str(same) != str(error):
        raise ValueError("it cannot be sent")
    if not isinstance(error, SceneError):
        error.add_note("".join(traceback.format_exception(error)))
    return error


def _send(pipe: int, told: Any, known: Sequence[object]) -> None:
    packed = io.BytesIO()
    _Packer(packed, known).dump(told)
    view = memoryview(HEADER.pack(packed.tell()) + packed.getvalue())
    while view:
        view = view[os.write(pipe, view) :]


class _Packer(pickle.Pickler):
    """Leaves out what is there on the other side."""

    def __init__(self, file: io.BytesIO, known: Sequence[object]) -> None:
        super().__init__(file, protocol=pickle.HIGHEST_PROTOCOL)
        self._places = {id(each): place for place, each in enumerate(known)}

    def persistent_id(self, obj: Any) -> int | None:
        """As `pickle.Pickler.persistent_id`."""
        return self._places.get(id(obj))


class _Unpacker(pickle.Unpickler):
    """Puts it in again."""

    def __init__(self, file: io.BytesIO, known: Sequence[object]) -> None:
        super().__init__(file)
        self._known = known

    def persistent_load(self, pid: Any) -> Any:
        """As `pickle.Unpickler.persistent_load`."""
        return self._known[pid]
