"""A small solver of round things by steps, what is done to it, and how its log is cut: a world of `desync_pairs.py`."""

from __future__ import annotations

import base64
import copy
import hashlib
import itertools
import json
import math
import random
import struct
from collections.abc import Callable
from functools import cache
from typing import Any

from desync_worlds import Lines

Log = Lines | str
HEAD = {"log": "truebreak/log-1", "engine": "sketch 1"}


def single(x: float) -> float:
    """The nearest number of 24 bits."""
    return struct.unpack("f", struct.pack("f", x))[0]


class Sketch:
    """Round things of radius 1 in a box, by steps."""

    def __init__(self, kind: str, dims: int = 2, seed: int = 1, count: int = 7, *, dt: float = 1 / 60, bits: int = 53,
                 order: int = 0, iterations: int = 6, bounce: float | None = None, pull: float = -9.8,
                 wind: float = 0.0) -> None:  # fmt: skip
        rng = random.Random(seed)
        self.dims, self.dt, self.bits, self.iterations, self.wind = dims, dt, bits, iterations, wind
        self.size = 10.0
        self.pull = 0.0 if kind == "gas" else pull
        self.bounce = (1.0 if kind == "gas" else 0.3) if bounce is None else bounce
        speed = 12.0 if kind == "gas" else 1.0
        self.at = [
            [2.0 + 2.6 * ((k // 3**q) % 3) + rng.uniform(-0.25, 0.25) for q in range(dims)] for k in range(count)
        ]
        self.v = [[rng.uniform(-speed, speed) for _ in range(dims)] for _ in range(count)]
        self.mass = [1.0 + 0.5 * (k % 3) for k in range(count)]
        self.ids = [f"n{k}" for k in range(count)]
        self.alive = list(range(count))
        self.sequence = list(range(count))
        random.Random(order).shuffle(self.sequence) if order else None
        if bits == 24:
            self.at, self.v = ([[*map(single, row)] for row in rows] for rows in (self.at, self.v))
        self.cache: dict[tuple[int, int], float] = {}
        self.lost: set[tuple[int, int]] = set()
        self.asleep: set[int] = set()
        self.ulps = False

    def step(self) -> list[list[str]]:
        """One step; who was pushed."""
        dt, at, v = self.dt, self.at, self.v
        awake = [k for k in self.sequence if k in self.alive and k not in self.asleep]
        for k in awake:
            v[k][-1] += self.pull * dt
            v[k][0] += self.wind * dt
        meetings = []
        present = [k for k in self.sequence if k in self.alive]
        for a, b in itertools.combinations(present, 2):
            d = [q - p for p, q in zip(at[a], at[b], strict=True)]
            far = math.sqrt(sum(q * q for q in d))
            if 0 < far < 2.0 and (a, b) not in self.lost and not (a in self.asleep and b in self.asleep):
                n = [q / far for q in d]
                near = sum((vb - va) * q for va, vb, q in zip(v[a], v[b], n, strict=True))
                meetings.append((a, b, n, 2.0 - far, near))
        for k in awake:
            for q in range(self.dims):
                for side, gap in ((0, at[k][q] - 1.0), (1, self.size - 1.0 - at[k][q])):
                    if gap < 0 and (k, -1 - 2 * q - side) not in self.lost:
                        n = [0.0] * self.dims
                        n[q] = 1.0 if side else -1.0
                        meetings.append((k, -1 - 2 * q - side, n, -gap, -v[k][q] * n[q]))
        pushes = {}
        for a, b, *_ in meetings:
            pushes[a, b] = 0.8 * self.cache.get((a, b), 0.0) if self.pull else 0.0

        def give(a: int, b: int, n: list[float], amount: float) -> None:
            for q in range(self.dims):
                v[a][q] -= amount * n[q] / self.mass[a]
                if b >= 0:
                    v[b][q] += amount * n[q] / self.mass[b]

        for a, b, n, *_ in meetings:
            give(a, b, n, pushes[a, b])
        for _ in range(self.iterations):
            for a, b, n, deep, near in meetings:
                now = sum(((v[b][q] if b >= 0 else 0.0) - v[a][q]) * n[q] for q in range(self.dims))
                goal = -self.bounce * min(near + 0.5, 0.0) if self.pull else -min(near, 0.0)
                goal += 2.0 * max(deep - 0.01, 0.0) if self.pull else 0.0
                weight = 1 / self.mass[a] + (1 / self.mass[b] if b >= 0 else 0.0)
                total = max(0.0, pushes[a, b] + (goal - now) / weight)
                give(a, b, n, total - pushes[a, b])
                pushes[a, b] = total
        for k in awake:
            for q in range(self.dims):
                at[k][q] += v[k][q] * dt
            if self.ulps:
                v[k][0] = math.nextafter(v[k][0], math.inf)
            if self.bits == 24:
                at[k][:], v[k][:] = map(single, at[k]), map(single, v[k])
        self.cache = {key: value for key, value in pushes.items() if value > 0}
        walls = ("left", "right", "floor", "roof", "front", "back")
        if self.dims == 2:
            walls = ("left", "right", "floor", "roof")
        return [[self.ids[a], self.ids[b] if b >= 0 else walls[-1 - b]] for a, b in self.cache]

    def states(self) -> dict[str, list[float]]:
        """Of all that is there."""
        return {self.ids[k]: [*self.at[k], *self.v[k]] for k in sorted(self.alive)}


Hook = Callable[[Sketch, int], dict[str, Any] | None]


def played(kind: str = "pile", steps: int = 110, hook: Hook | None = None, **settings: Any) -> Lines:
    """A log of everything. A hook is called before each step k, with 0 before the start; what it gives is logged."""
    world = Sketch(kind, **settings)
    extra = hook(world, 0) if hook else None
    names = [*"xyz"[: world.dims], *(f"v{q}" for q in "xyz"[: world.dims])]
    lines: Lines = [{**HEAD, "fields": names}]
    lines.append({"step": 0, "time": 0.0, "contacts": [], "states": world.states(), **(extra or {})})
    for k in range(1, steps + 1):
        extra = hook(world, k) if hook else None
        pairs = world.step()
        lines.append({"step": k, "time": k * world.dt, "contacts": pairs, "states": world.states(), **(extra or {})})
    return json.loads(json.dumps(lines))


@cache
def _plain(kind: str, dims: int, seed: int, bits: int) -> str:
    return json.dumps(played(kind, dims=dims, seed=seed, bits=bits))


def plain(kind: str = "pile", dims: int = 2, seed: int = 1, bits: int = 53) -> Lines:
    """The run without a fault."""
    return json.loads(_plain(kind, dims, seed, bits))


def when(at: int, do: Callable[[Sketch], object]) -> Hook:
    """Does something before one step."""

    def hook(world: Sketch, k: int) -> None:
        if k == at:
            do(world)

    return hook


# What is done to a world.


def shove(k: int, amount: float) -> Callable[[Sketch], None]:
    def do(world: Sketch) -> None:
        world.v[k][0] += amount

    return do


def ulp(k: int) -> Callable[[Sketch], None]:
    def do(world: Sketch) -> None:
        x = world.at[k][0]
        world.at[k][0] = math.nextafter(x, 99) if world.bits == 53 else single(x * (1 + 2**-23))

    return do


def place(k: int, amount: float) -> Callable[[Sketch], None]:
    def do(world: Sketch) -> None:
        world.at[k][0] = single(world.at[k][0] + amount) if world.bits == 24 else world.at[k][0] + amount

    return do


def stale(world: Sketch) -> None:
    world.cache = {key: 3.0 * value + 0.5 for key, value in world.cache.items()}


def forget(world: Sketch) -> None:
    world.cache = {}


def heavier(k: int, factor: float) -> Callable[[Sketch], None]:
    def do(world: Sketch) -> None:
        world.mass[k] *= factor

    return do


def through_text(form: str) -> Callable[[Sketch], None]:
    """A saved game, loaded."""

    def do(world: Sketch) -> None:
        for rows in (world.at, world.v):
            for row in rows:
                row[:] = [single(x) if form == "single" else float(form % x) for x in row]

    return do


def value(k: int, x: float) -> Callable[[Sketch], None]:
    def do(world: Sketch) -> None:
        world.v[k][0] = x

    return do


def lose(after: int) -> Hook:
    """The first contact of two from one step on is not seen, once."""

    def hook(world: Sketch, k: int) -> None:
        if k == after:
            trial = copy.deepcopy(world)
            while True:
                before = set(trial.cache)
                trial.step()
                if new := sorted(key for key in trial.cache if key not in before and key[1] >= 0):
                    world.lost = {new[0]}
                    return

    return hook


def jumps(*without: int, late: int | None = None, twice: int | None = None, hidden: bool = False) -> Hook:
    """An input every 15 steps."""

    def hook(world: Sketch, k: int) -> dict[str, Any] | None:
        due = k % 15 == 10 and k not in without and k != late
        if due or (late is not None and k == late + 1):
            for _ in range(2 if k == twice else 1):
                world.v[k % 7][-1] += 2.5
            return None if hidden else {"input": {"jump": world.ids[k % 7]}}
        return None

    return hook


def dice(seed: int, logged: bool) -> Hook:
    """A random shove every 20 steps."""
    rng = random.Random(seed)

    def hook(world: Sketch, k: int) -> dict[str, Any] | None:
        if k and k % 20 == 0:
            drawn = rng.random()
            world.v[3][0] += drawn
            return {"rng": drawn} if logged else None
        return None

    return hook


def first(do: Callable[[Sketch], None], then: Hook) -> Hook:
    """Something before the start, and then another hook."""

    def hook(world: Sketch, k: int) -> dict[str, Any] | None:
        if k == 0:
            do(world)
        return then(world, k)

    return hook


def absent(first: int, last: int, k: int = 4) -> Hook:
    """A body is taken out, and put in again as it was."""

    def hook(world: Sketch, step: int) -> None:
        if step == first:
            world.alive.remove(k)
        if step == last:
            world.alive.append(k)

    return hook


def sleeps(world: Sketch, k: int) -> None:
    """What is slow is put to sleep."""
    for b in world.alive:
        if b not in world.asleep and k > 20 and sum(q * q for q in world.v[b]) < 0.05:
            world.asleep.add(b)
            world.v[b] = [0.0] * world.dims


def woken(world: Sketch, k: int) -> None:
    """All are woken at step 100, and one is moved."""
    if k == 100:
        world.asleep.clear()
        world.v[0][0] = 0.4
    else:
        sleeps(world, k)


def jitter(size: float, first: int = 1) -> Hook:
    """Steps of lengths that vary."""
    rng = random.Random(5)

    def hook(world: Sketch, k: int) -> None:
        if k >= first:
            world.dt = (1 / 60) * (1 + size * rng.uniform(-1, 1))

    return hook


def sloppy(world: Sketch, k: int) -> None:
    """Contacts are solved in an order that is another in each step, as by threads."""
    random.Random(k).shuffle(world.sequence)


# How a log is cut.


def styled(keys: set[str], n: int = 1) -> Callable[[Lines], Lines]:
    def cut(lines: Lines) -> Lines:
        kept = [line for line in lines[1:] if line["step"] % n == 0]
        return [lines[0], *({k: v for k, v in line.items() if k in keys} for line in kept)]

    return cut


def hash_of(line: dict[str, Any]) -> str:
    return hashlib.sha1(json.dumps(line["states"]).encode()).hexdigest()[:12]


def hash_lines(lines: Lines) -> str:
    return "".join(hash_of(line) + "\n" for line in lines[1:])


def hashes_with(n: int) -> Callable[[Lines], Lines]:
    """A hash of every step, states of every n-th."""

    def cut(lines: Lines) -> Lines:
        return [lines[0], *(
            {"step": line["step"], "hash": hash_of(line), **({} if line["step"] % n else {"states": line["states"]})}
            for line in lines[1:]
        )]  # fmt: skip

    return cut


def shown(form: str) -> Callable[[Lines], Lines]:
    """Numbers printed by a format of C."""

    def cut(lines: Lines) -> Lines:
        for line in lines[1:]:
            line["states"] = {i: [float(form % x) for x in row] for i, row in line["states"].items()}
        return lines

    return cut


def each(change: Callable[[dict[str, Any]], dict[str, Any]]) -> Callable[[Lines], Lines]:
    return lambda lines: [lines[0], *map(change, lines[1:])]


def rows(change: Callable[[str, list[float]], list[float]]) -> Callable[[Lines], Lines]:
    return each(lambda line: {**line, "states": {i: change(i, row) for i, row in line["states"].items()}})


def turned(turn: Callable[[int], list[float]]) -> Lines:
    """The plain run, with numbers of its own for each step in every state."""
    return each(lambda x: {**x, "states": {i: row + turn(x["step"]) for i, row in x["states"].items()}})(plain())


def csv_of(lines: Lines) -> str:
    text = ["step,id," + ",".join(lines[0]["fields"])]
    for line in lines[1:]:
        text += [",".join([str(line["step"]), i, *map(repr, row)]) for i, row in line["states"].items()]
    return "\n".join(text) + "\n"


def hexed(lines: Lines) -> Lines:
    return [lines[0], *({**line, "states": {i: [x.hex() for x in row] for i, row in line["states"].items()}}
                        for line in lines[1:])]  # fmt: skip


def packed(lines: Lines) -> Lines:
    ids = list(lines[1]["states"])
    found: Lines = [lines[0], {"order": ids}]
    for line in lines[1:]:
        numbers = [x for i in ids for x in line["states"][i]]
        found.append({k: v for k, v in line.items() if k != "states"}
                     | {"packed": base64.b64encode(struct.pack(f"<{len(numbers)}d", *numbers)).decode()})  # fmt: skip
    return found


def renamed(names: Callable[[str], str], after: int = 0) -> Callable[[Lines], Lines]:
    def change(line: dict[str, Any]) -> dict[str, Any]:
        if line["step"] < after:
            return line
        return {**line, "contacts": [[*map(names, p)] for p in line["contacts"]],
                "states": {names(i): row for i, row in line["states"].items()}}  # fmt: skip

    return each(change)


def shuffled(line: dict[str, Any]) -> dict[str, Any]:
    rng, line = random.Random(line["step"]), copy.deepcopy(line)
    rng.shuffle(line["contacts"])
    items = list(line["states"].items())
    rng.shuffle(items)
    return {**line, "states": dict(items)}


def bare(lines: Lines) -> Lines:
    """Events without states."""
    return [lines[0], *({k: v for k, v in line.items() if k != "states"} for line in lines[1:])]


def untimed(lines: Lines) -> Lines:
    """Events by their number alone."""
    return [lines[0], *({"step": k, "contact": line["contact"]} for k, line in enumerate(lines[1:]))]


def floats(lines: Lines, keys: tuple[str, ...] = ("time", "states")) -> Lines:
    """Times, and states, to 24 bits."""
    found = copy.deepcopy(lines)
    for line in found[1:]:
        if "time" in keys:
            line["time"] = single(line["time"])
        if "states" in keys:
            line["states"] = {i: [*map(single, row)] for i, row in line["states"].items()}
    return found


def rounded(lines: Lines) -> Lines:
    """Times with four decimals, and no states."""
    return [lines[0], *({**line, "time": round(line["time"], 4)} for line in bare(lines)[1:])]


def swapped(lines: Lines) -> Lines:
    """Neighbours that share no body change places."""
    found, k = [lines[0]], 1
    while k < len(lines):
        if k + 1 < len(lines) and not {*lines[k]["contact"]} & {*lines[k + 1]["contact"]}:
            found += [lines[k + 1], lines[k]]
            k += 2
        else:
            found.append(lines[k])
            k += 1
    return found
