"""While others change what exact numbers rest on, a run is the same, or it says what was disturbed."""

from __future__ import annotations

import locale
import os
import random
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


@pytest.fixture(autouse=True)
def quiet_afterwards() -> Iterator[None]:
    """What a noisy thread has set is as it was for other tests."""
    precise, bits = mpmath.mp.prec, flint.ctx.prec
    yield
    mpmath.mp.prec, flint.ctx.prec = precise, bits


def test_a_noisy_thread_disturbs_runs_or_leaves_them_the_same() -> None:
    assert stress(5, noise)["disturbed"] > 0


@pytest.mark.slow
def test_a_noisy_thread_disturbs_runs_or_leaves_them_the_same_for_ten_minutes() -> None:
    outcomes = stress(600, noise)
    assert min(outcomes["disturbed"], outcomes["same"]) > 0


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
