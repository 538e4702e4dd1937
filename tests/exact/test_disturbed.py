"""While others change what exact numbers rest on, a run is the same, or it says what was disturbed."""

from __future__ import annotations

import ctypes
import locale
import os
import random
import struct
import sys
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import flint
import mpmath
import pytest

from truebreak.exact import ExactEngine
from truebreak.exact.simulation import loop
from truebreak.scenarios import Disturbed, Quantity, Scene, Trajectory, catalogue
from truebreak.scenarios.numbers import precision
from truebreak.scenarios.numbers.precision import at_bits, use_bits

SCENES = {"gas:n=3": 25, "inscribed:n=3": 6, "cradle": 8, "rack:rows=2": 6}


def told(run: Trajectory) -> Any:
    """The history of a run, its proofs and its digits."""
    events = [
        (e.time.digits(25), sorted(map(tuple, e.contacts)), [tuple(c) for c in e.impulses], [t.proof for t in e.ties])
        for e in run.events
    ]
    final = [(c.x.digits(20), c.y.digits(20), c.vx.digits(20), c.vy.digits(20)) for c in run.final.circles]
    return events, final, run.stop.reason, run.certified


def history(name: str) -> Any:
    return told(ExactEngine().run(catalogue.build(name), events=SCENES[name]))


@pytest.fixture(autouse=True)
def _restored() -> Iterator[None]:
    before = flint.ctx.prec
    yield
    flint.ctx.prec = before


# -- flint's precision


def other_code(draw: random.Random, calls: int, times: int) -> Callable[..., None]:
    """Sets the precision at some of so many calls, as another thread would between them."""
    at = {draw.randrange(calls) for _ in range(times)}
    made = iter(range(1, 10**9))

    def called(*_: object) -> None:
        if next(made) in at:
            flint.ctx.prec = draw.choice([2, 3, 30, 53, 4000])

    return called


@pytest.mark.parametrize("name", ["gas:n=3", "inscribed:n=3"])
def test_the_precision_may_be_set_between_any_two_steps(name: str) -> None:
    home, calls, profiled = flint.ctx.prec, 0, sys.getprofile()

    def counting(*_: object) -> None:
        nonlocal calls
        calls += 1

    true = history(name)
    sys.setprofile(counting)
    history(name)
    sys.setprofile(profiled)
    outcomes: Counter[str] = Counter()
    for seed in range(12):
        flint.ctx.prec = home
        sys.setprofile(other_code(random.Random(seed), calls, 1 + seed % 2))
        try:
            found = history(name)
        except Disturbed:
            outcomes["disturbed"] += 1
            continue
        finally:
            sys.setprofile(profiled)
        assert found == true, seed
        outcomes["same"] += 1
    assert outcomes["disturbed"] > 0


def test_whoever_sets_the_precision_in_a_callback_is_told_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(loop, "PROGRESS_EVERY", 0.0)

    def spoil(_: object) -> None:
        flint.ctx.prec = 77

    with pytest.raises(Disturbed, match=r"set to 77 bits by other code.*run it again"):
        ExactEngine().run(catalogue.build("gas:n=10"), events=300, progress=spoil)
    assert flint.ctx.prec == 77  # as the other code wants it
    flint.ctx.prec = 53
    assert history("cradle") == history("cradle")


def test_the_precision_is_given_back_and_is_nobody_s_afterwards() -> None:
    flint.ctx.prec = 91
    with pytest.raises(ZeroDivisionError), at_bits(200), at_bits(300):
        use_bits(400)
        assert flint.ctx.prec == 400
        raise ZeroDivisionError
    assert flint.ctx.prec == 91
    assert not precision._holder.lock.locked()
    with pytest.raises(ValueError, match="prec"):
        at_bits(0).__enter__()
    assert not precision._holder.lock.locked()


# -- threads


def in_threads(count: int, work: Callable[[int], None], seconds: float, noise: Callable[[], None] | None) -> None:
    """Works in threads for so long, with a noisy one beside them; raises what any of them raised."""
    over, failed = threading.Event(), list[BaseException]()

    def at_it(k: int) -> None:
        try:
            while not over.is_set():
                work(k)
        except BaseException as raised:
            failed.append(raised)
            over.set()

    def noisy() -> None:
        while not over.is_set():
            assert noise is not None
            noise()

    threads = [threading.Thread(target=at_it, args=(k,)) for k in range(count)]
    if noise is not None:
        threads.append(threading.Thread(target=noisy))
    for thread in threads:
        thread.start()
    over.wait(seconds)
    over.set()
    for thread in threads:
        thread.join(60)
    assert not any(thread.is_alive() for thread in threads)
    if failed:
        raise failed[0]


def stress(seconds: float, noise: Callable[[], None] | None) -> Counter[str]:
    """Runs, and their numbers and exact scenes, in eight threads; how they came out."""
    true = {name: history(name) for name in SCENES}
    outcomes: Counter[str] = Counter()
    root = Quantity.of(2).sqrt().digits(30)

    def work(k: int) -> None:
        name = list(SCENES)[k % len(SCENES)]
        try:
            assert (Quantity.of("sqrt(5 + 2*sqrt(6))") - Quantity.of("sqrt(2) + sqrt(3)")).sign() == 0
            assert Quantity.of(2).sqrt().digits(30) == root
            assert float(Quantity.of(f"sqrt({k + 2})")) > 1
            assert history(name) == true[name]
        except Disturbed:
            outcomes["disturbed"] += 1
            return
        except RecursionError:
            outcomes["recursion"] += 1
            return
        outcomes["same"] += 1

    in_threads(8, work, seconds, noise)
    return outcomes


def test_runs_in_threads_take_turns() -> None:
    outcomes = stress(3, None)
    assert outcomes["same"] >= 8
    assert not outcomes["disturbed"]


def noise() -> None:
    flint.ctx.prec = random.choice([2, 3, 30, 53, 4000])
    mpmath.mp.prec = random.choice([10, 53, 200])
    time.sleep(random.choice([0.0005, 0.02, 0.2]))


class Noise:
    """Now and then changes one thing of all that a process or a thread has; what children of such a thread see."""

    def __init__(self, low: int) -> None:
        self.draw = random.Random(7)
        self.low = low
        self.true = history("gas:n=3")
        self.children: Counter[str] = Counter()
        self.made: Counter[str] = Counter()
        self.limit = sys.getrecursionlimit()
        self.names = [name for name in ("de_DE.UTF-8", "fr_FR.UTF-8", "C.UTF-8", "C") if _has(name)]

    def __call__(self) -> None:
        kind = self.draw.choice(["precision", "mpmath", "locale", "limit", "folder", "rounding", "flushing"])
        self.made[kind] += 1
        if kind == "precision":
            flint.ctx.prec = self.draw.choice([2, 3, 30, 53, 4000])
        elif kind == "mpmath":
            mpmath.mp.prec = self.draw.choice([10, 53, 200])
        elif kind == "locale":
            locale.setlocale(locale.LC_ALL, self.draw.choice(self.names))
        elif kind == "folder":
            os.chdir(self.draw.choice(["/", "/tmp", "/usr"]))
        elif kind == "limit":
            try:
                sys.setrecursionlimit(self.draw.choice([self.low, 5000]))
                time.sleep(0.005)
            finally:
                sys.setrecursionlimit(self.limit)
        else:
            self.with_other_doubles(kind)
        time.sleep(self.draw.choice([0.0005, 0.02, 0.1]))

    def with_other_doubles(self, kind: str) -> None:
        """Sets what this thread's doubles do, and sometimes starts a thread, which inherits that."""
        libm = ctypes.CDLL("libm.so.6")
        before, after = ctypes.create_string_buffer(32), ctypes.create_string_buffer(32)
        libm.fegetenv(before)
        libm.fegetenv(after)
        if kind == "rounding":
            libm.fesetround(self.draw.choice([0x400, 0x800, 0xC00]))
        else:
            (mxcsr,) = struct.unpack_from("<I", after.raw, 28)
            struct.pack_into("<I", after, 28, mxcsr | self.draw.choice([0x8000, 0x40]))
            libm.fesetenv(after)
        try:
            if self.draw.random() < 0.2:
                thread = threading.Thread(target=self.child)
                thread.start()
                thread.join()
        finally:
            libm.fesetenv(before)

    def child(self) -> None:
        """A run under other doubles, which must not have a history."""
        try:
            assert history("gas:n=3") == self.true
            self.children["answered"] += 1
        except Disturbed:
            self.children["disturbed"] += 1


@pytest.fixture(autouse=True)
def quiet_afterwards() -> Iterator[None]:
    """What a noisy thread has set is as it was for other tests."""
    precise, bits, limit, folder = mpmath.mp.prec, flint.ctx.prec, sys.getrecursionlimit(), Path.cwd()
    spoken = locale.setlocale(locale.LC_ALL)
    yield
    mpmath.mp.prec, flint.ctx.prec = precise, bits
    sys.setrecursionlimit(limit)
    locale.setlocale(locale.LC_ALL, spoken)
    os.chdir(folder)


def test_a_noisy_thread_disturbs_runs_or_leaves_them_the_same() -> None:
    assert stress(5, noise)["disturbed"] > 0


on_x86 = pytest.mark.skipif(
    not (sys.platform == "linux" and os.uname().machine == "x86_64"), reason="the modes are those of x86 and glibc"
)


@on_x86
@pytest.mark.slow
@pytest.mark.parametrize("low", [150, 20], ids=["too low for some", "too low for all"])
def test_a_noisy_thread_disturbs_runs_or_leaves_them_the_same_for_ten_minutes(low: int) -> None:
    noisy = Noise(low)
    outcomes = stress(300, noisy)
    assert min(outcomes["disturbed"], outcomes["same"], *noisy.made.values()) > 0
    assert noisy.children["disturbed"] > 0
    assert not noisy.children["answered"]


def test_whoever_cannot_even_give_the_precision_back_does_not_keep_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """A recursion limit that another thread lowers forbids the call that ends a block; others go on all the same."""
    monkeypatch.setattr(precision, "LOOK_AGAIN_SECONDS", 0.01)
    limit, inside, lowered, failed = sys.getrecursionlimit(), threading.Event(), [False], list[BaseException]()

    def deep(frames: int) -> None:
        if frames:
            deep(frames - 1)
            return
        with at_bits(100):
            inside.set()
            while not lowered[0]:  # without a call, which would fail here already
                pass

    def hold() -> None:
        try:
            deep(600)
        except RecursionError as raised:
            failed.append(raised)

    thread = threading.Thread(target=hold)
    thread.start()
    inside.wait(60)
    sys.setrecursionlimit(400)
    lowered[0] = True
    thread.join(60)
    sys.setrecursionlimit(limit)
    assert failed
    assert precision._holder.lock.locked()
    failed[0].__traceback__ = None
    before = flint.ctx.prec
    with at_bits(200):
        assert flint.ctx.prec == 200
    assert flint.ctx.prec != before == 100  # what was left there is undone
    assert not precision._holder.lock.locked()
    assert history("cradle") == history("cradle")


@pytest.mark.skipif(not hasattr(os, "fork"), reason="the platform has no fork")
@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")
def test_a_child_of_a_fork_waits_for_no_thread_of_its_parent() -> None:
    held, done = threading.Event(), threading.Event()

    def hold() -> None:
        with at_bits(100):
            held.set()
            done.wait(60)

    thread = threading.Thread(target=hold)
    thread.start()
    held.wait(60)
    child = os.fork()
    if not child:
        with at_bits(200):
            os._exit(0)
    for _ in range(600):
        ended, status = os.waitpid(child, os.WNOHANG)
        if ended:
            break
        time.sleep(0.05)
    else:
        os.kill(child, 9)
        os.waitpid(child, 0)
    done.set()
    thread.join()
    assert ended
    assert status == 0


# -- what a run does not rest on


def test_other_states_of_the_process_change_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    true = {name: history(name) for name in SCENES}
    limit, spoken = sys.getrecursionlimit(), locale.setlocale(locale.LC_ALL)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(flint.ctx, "unicode", True)
    names = [name for name in ("de_DE.UTF-8", "fr_FR.UTF-8", "C.UTF-8", "C") if _has(name)]
    here = iter(range(10**9))

    def noise() -> None:
        k = next(here)
        locale.setlocale(locale.LC_ALL, names[k % len(names)])
        sys.setrecursionlimit(limit + 100 * (k % 7))
        mpmath.mp.prec = 20 + k % 99
        os.chdir(("/", tmp_path)[k % 2])
        time.sleep(0.001)

    def work(k: int) -> None:
        name = list(SCENES)[k % len(SCENES)]
        assert history(name) == true[name]

    prec = mpmath.mp.prec
    try:
        in_threads(2, work, 2, noise)
    finally:
        locale.setlocale(locale.LC_ALL, spoken)
        sys.setrecursionlimit(limit)
        mpmath.mp.prec = prec


def _has(name: str) -> bool:
    try:
        locale.setlocale(locale.LC_ALL, name)
    except locale.Error:
        return False
    return True


def test_a_recursion_limit_that_is_too_low_is_an_error_that_says_so() -> None:
    scene: Scene = catalogue.build("inscribed:n=3")
    true, limit, depth = told(ExactEngine().run(scene, events=6)), sys.getrecursionlimit(), 0
    frame = sys._getframe()
    while frame is not None:
        depth, frame = depth + 1, frame.f_back
    outcomes: Counter[str] = Counter()
    for room in (12, 16, 20, 30, 60, 200):
        sys.setrecursionlimit(depth + room)
        try:
            found = told(ExactEngine().run(scene, events=6))
        except RecursionError:
            outcomes["told"] += 1
        else:
            assert found == true
            outcomes["same"] += 1
        finally:
            sys.setrecursionlimit(limit)
    assert outcomes["told"]
    assert outcomes["same"]
