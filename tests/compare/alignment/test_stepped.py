"""Engines with a time step, beside an alignment that follows from the definition alone.

A body's history is a word: its partners in order. The partners of one instant, or of one step, come in any order; a
round of an exact instant may be there or not. Two runs are the same as far as such words are. Nothing here shares a
line with what is tested: all words are followed at once.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from importlib.util import find_spec
from random import Random
from typing import Any, NamedTuple

import pytest

from truebreak.compare import compare, engine
from truebreak.compare.alignment.instants import Divergence, Kind
from truebreak.compare.foreign import RecordedEngine
from truebreak.scenarios import Circle, Engine, Scene, StopReason, Trajectory, Wall, catalogue

STEPS = (16, 32, 64, 128)
"""Steps a unit of time."""

EVENTS = (4, 9, 18)
"""Spans."""

LONGER = 2
"""Times as many events as the longest span has, for what lies beyond."""

FEW, MANY, BLOCKS = 30, 2000, 20
"""Runs in an ordinary run of the tests, and in a slow one."""

NEAR = 4
"""Steps at the end of a span that may belong to an instant within it."""

TOUCHING, ROUNDS = 2, 64
"""Steps within which a contact may be the one before, and within which a tie may have its rounds."""


# -- an engine of steps


@dataclass(frozen=True)
class Stepper(RecordedEngine):
    """Moves all discs by a step, then reflects every pair that overlaps and approaches.

    Attributes:
        passes: over all pairs in one step.
        backwards: whether the last pair comes first.
        fault: what it does wrong with its contact number `at`: "forgets" it in its report, reports it "again" 20 steps
            later, calls one of the two by "another" name, or lets the two "pass"; None: nothing.
    """

    step: float = 1 / 128
    passes: int = 1
    backwards: bool = False
    fault: str | None = None
    at: int = 0

    @property
    def name(self) -> str:
        """`stepper`."""
        return "stepper"

    def play(self, scene: Scene, recording: Any) -> None:
        """Until the recording is full."""
        ids, discs = [str(c.id) for c in scene.circles], scene.circles
        state = [[float(v) for v in (c.x, c.y, c.vx, c.vy)] for c in discs]
        mass = [0.0 if c.fixed else 1 / float(c.m) for c in discs]
        reach = [float(c.r) for c in discs]
        walls = [(str(w.id), *(float(v) for v in (w.x0, w.y0, w.x1, w.y1))) for w in scene.walls]
        links: list[tuple[int, int]] = [(a, b) for a in range(len(ids)) for b in range(a + 1, len(ids))]
        links += [(a, -1 - k) for k in range(len(walls)) for a in range(len(ids))]
        links = links[::-1] if self.backwards else links
        sides = {(a, k): self._height(state[a], walls[k])[0] < 0 for a in range(len(ids)) for k in range(len(walls))}
        steps, count, again, passing = 0, 0, dict[int, tuple[str, str]](), set[tuple[int, int]]()
        while recording.open:
            steps += 1
            for row in state:
                row[0] += self.step * row[2]
                row[1] += self.step * row[3]
            told: list[tuple[str, str]] = [again.pop(steps)] if steps in again else []
            hit = False
            for a, b in links * self.passes:
                if b < 0:
                    height, nx, ny = self._height(state[a], walls[-1 - b])
                    if sides[a, -1 - b]:
                        height, nx, ny = -height, -nx, -ny
                    depth, inverse = reach[a] - height, mass[a]
                    speed = state[a][2] * nx + state[a][3] * ny
                else:
                    nx, ny = state[a][0] - state[b][0], state[a][1] - state[b][1]
                    apart = math.hypot(nx, ny)
                    if not apart:  # centre upon centre: no direction to push in
                        continue
                    nx, ny, depth, inverse = nx / apart, ny / apart, reach[a] + reach[b] - apart, mass[a] + mass[b]
                    speed = (state[a][2] - state[b][2]) * nx + (state[a][3] - state[b][3]) * ny
                if depth <= 0:
                    passing.discard((a, b))
                if depth <= 0 or speed >= 0 or not inverse or (a, b) in passing:
                    continue
                count += 1
                if self.fault == "passes" and count == self.at:
                    passing.add((a, b))
                    continue
                for k, sign in ((a, 1), (b, -1)):
                    if k >= 0:
                        state[k][2] -= sign * 2 * speed / inverse * mass[k] * nx
                        state[k][3] -= sign * 2 * speed / inverse * mass[k] * ny
                pair = ids[a], ids[b] if b >= 0 else walls[-1 - b][0]
                hit = True
                if self.fault == "again" and count == self.at:
                    again[steps + 20] = pair
                if self.fault == "another" and count == self.at:
                    pair = pair[0], next(name for name in [*ids, *(w[0] for w in walls)] if name not in pair)
                if not (self.fault == "forgets" and count == self.at):
                    told.append(pair)
            where = {name: tuple(row) for name, row in zip(ids, state, strict=True)}
            if told:
                recording.hits(steps * self.step, told, where)
            elif not hit:
                recording.state(steps * self.step, where)

    @staticmethod
    def _height(row: list[float], wall: tuple[str, float, float, float, float]) -> tuple[float, float, float]:
        _, x0, y0, x1, y1 = wall
        length = math.hypot(x1 - x0, y1 - y0)
        nx, ny = (y0 - y1) / length, (x1 - x0) / length
        return (row[0] - x0) * nx + (row[1] - y0) * ny, nx, ny


# -- the alignment


class Met(NamedTuple):
    """The partners of a body in one event: how often each."""

    event: int
    time: float
    partners: tuple[tuple[str, int], ...]


def words(run: Trajectory) -> dict[str, list[Met]]:
    """What every disc that moves meets."""
    found: dict[str, list[Met]] = {str(c.id): [] for c in run.scene.circles if not c.fixed}
    for place, event in enumerate(run.events):
        for name, met in found.items():
            partners = Counter(b if a == name else a for a, b in event.impulses if name in (a, b))
            if partners:
                met.append(Met(place, float(event.time), tuple(sorted(partners.items()))))
    return found


class Place(NamedTuple):
    """A place in two words: what is still to come of either one's event, required (True) or a further round of it."""

    i: int
    mine: frozenset[tuple[str, bool, int]]
    j: int
    theirs: frozenset[tuple[str, bool, int]]


class Part(NamedTuple):
    """Where two words part: the event that the first comes to next, and that of the second; None at its end."""

    mine: Met | None
    theirs: Met | None


def opened(met: Met) -> frozenset[tuple[str, bool, int]]:
    """All of an event."""
    once = {(name, True, 0) for name, _ in met.partners}
    return frozenset(once | {(name, False, k) for name, often in met.partners for k in range(1, often)})


def closed(left: frozenset[tuple[str, bool, int]]) -> bool:
    return not any(required for _, required, _ in left)


def places(mine: list[Met], theirs: list[Met], step: float, absorbing: bool) -> list[Place]:
    """All places that two words lead to and no farther.

    With `absorbing`, a contact that a run has within `TOUCHING` steps of one with the same partner, or within `ROUNDS`
    of an event of several rounds, need not be in the other's word: more than any sensible rule would leave out.
    """
    start = Place(-1, frozenset(), -1, frozenset())
    todo, seen, last = [start], {start}, []

    def lag(met: list[Met], k: int, name: str) -> float:
        return next((met[k].time - m.time for m in reversed(met[:k]) if name in dict(m.partners)), math.inf)

    def free(met: list[Met], k: int, name: str) -> bool:
        if not absorbing or lag(met, k, name) > ROUNDS * step:
            return False
        several = any(often > 1 or len(m.partners) > 1 for m in met[max(0, k - 64) : k] for _, often in m.partners)
        return several or lag(met, k, name) <= TOUCHING * step

    while todo:
        place = todo.pop()
        following: list[Place] = []
        i, ours, j, others = place
        if closed(ours) and i + 1 < len(mine):
            following.append(Place(i + 1, opened(mine[i + 1]), j, others))
        if closed(others) and j + 1 < len(theirs):
            following.append(Place(i, ours, j + 1, opened(theirs[j + 1])))
        same = [(one, other) for one in ours for other in others if one[0] == other[0]]
        same = [(one, other) for one, other in same if one[1] or lag(theirs, j, one[0]) <= ROUNDS * step]
        following += [Place(i, ours - {one}, j, others - {other}) for one, other in same]
        following += [Place(i, ours - {one}, j, others) for one in ours if one[1] and free(mine, i, one[0])]
        following += [Place(i, ours, j, others - {one}) for one in others if one[1] and free(theirs, j, one[0])]
        if not following or (closed(ours) and i + 1 == len(mine)) or (closed(others) and j + 1 == len(theirs)):
            last.append(place)
        for one in following:
            if one not in seen:
                seen.add(one)
                todo.append(one)
    return last


def parted(mine: list[Met], theirs: list[Met], step: float, absorbing: bool) -> list[Part]:
    """How two words part: where none of the ways comes to an end of one, the farthest; else all that do."""
    ends, stuck = [], []
    for place in places(mine, theirs, step, absorbing):
        i = place.i if not closed(place.mine) else place.i + 1
        j = place.j if not closed(place.theirs) else place.j + 1
        over = i >= len(mine) or j >= len(theirs)
        part = Part(mine[i] if i < len(mine) else None, theirs[j] if j < len(theirs) else None)
        (ends if over else stuck).append((i + j, part))
    return [part for _, part in ends] if ends else [max(stuck, key=lambda one: one[0])[1]]


class Known(NamedTuple):
    """Where a body's words part: for certain, or only if a run that ends there does not come to it.

    Near: within the steps at the span's end; an instant that reaches into the span is compared as a whole.
    """

    body: str
    event: float
    inside: bool
    sure: bool
    near: bool


class Judge:
    """What is known of one run on one scene from the two long runs."""

    def __init__(self, reference: Trajectory, run: Trajectory, step: float, events: int, over: bool) -> None:
        self.reference, self.run, self.step, self.events = reference, run, step, events
        self.times = [float(event.time) for event in reference.events]
        self.end = math.inf if over else self.times[events - 1]
        self.mine, self.theirs = words(reference), words(run)

    def known(self, absorbing: bool) -> list[Known]:
        """Of every body whose words part, the way that parts last."""
        found = []
        for body, met in self.mine.items():
            ways = [self._of(body, part) for part in parted(met, self.theirs[body], self.step, absorbing)]
            if all(ways):
                found.append(max((w for w in ways if w), key=lambda w: (not w.inside, not w.sure, w.event)))
        return found

    def _of(self, body: str, part: Part) -> Known | None:
        mine, theirs = part
        if mine is None and theirs is None:
            return None
        inside = (mine is not None and mine.event < self.events) or (theirs is not None and theirs.time <= self.end)
        if mine is not None and (theirs is None or mine.time <= self.latest(theirs.time)):
            waits = self.run if theirs is None else None
            event = float(mine.event)
        else:  # the reference has nothing that this could be: where it would be, after all that the body has had
            assert theirs is not None
            waits = self.reference if mine is None else None
            own = [m.event for m in self.mine[body] if mine is None or m.event < mine.event]
            event = max([sum(t < theirs.time for t in self.times), *(e + 1 for e in own[-1:])])
        time = min(m.time for m in part if m is not None)
        sure = waits is None or waits.stop.reason is StopReason.QUIET or float(waits.final_time) >= self.latest(time)
        return Known(body, event, inside, sure, inside or time <= self.end + NEAR * self.step)

    def too_late(self, divergence: Divergence) -> bool:
        """Whether the contact said to be missing is one that the run has, later than a contact may be the same."""
        mine, theirs = self.mine[divergence.body], self.theirs[divergence.body]
        k = next(k for k, met in enumerate(mine) if met.event == divergence.expected_event)
        return divergence.kind is Kind.MISSING and theirs[k].time > self.latest(mine[k].time)

    def latest(self, time: float) -> float:
        """Twice its own time, and the time in which the fastest circle crosses the scene."""
        xs, ys = zip(*((float(c.x), float(c.y)) for c in self.reference.scene.circles), strict=True)
        speed = max(math.hypot(float(c.vx), float(c.vy)) for c in self.reference.scene.circles)
        across = math.hypot(max(xs) - min(xs), max(ys) - min(ys))
        across += 2 * max(float(c.r) for c in self.reference.scene.circles)
        return 2 * time + across / speed + 2 * self.step


def drawn(draw: Random) -> Scene:
    """A scene: chaos, long rows of one partner, passages, ties and what is all but a tie."""
    kind = draw.choice(["gas"] * 4 + ["pi", "pi", "pass", "rack", "tied", "near-tie"])
    if kind == "gas":
        text = f"gas:n={draw.randint(2, 6)},seed={draw.randrange(10**4)},mixed={draw.choice(['yes', 'no'])}"
    elif kind == "near-tie":
        text = f"near-tie:k={draw.randint(2, 20)}"
    elif kind == "rack":
        text = f"rack:rows={draw.randint(2, 3)},gap=1/7,jitter=1/1000,seed={draw.randrange(10**4)},offset=1/26,speed=20"
    elif kind == "tied":
        text = draw.choice(["rack:rows=2", "rack:rows=3", "cradle", "lee", "rack:rows=2,gap=0"])
    elif kind == "pi":
        mass = draw.choice([10, 30, 100, 300, 1000])
        circles = [
            Circle(3 + draw.randint(0, 40), 0, vx=-1 - draw.randint(0, 9) / 8, m=mass, id="big"),
            Circle(0, 0, id="small"),
        ]
        return Scene(circles, [Wall(-2 - draw.randint(0, 30) / 8, -9, -2 - draw.randint(0, 30) / 8, 9, id="w")])
    else:
        miss = f"{draw.choice(['-', ''])}{draw.randint(1, 9)}/10**{draw.randint(1, 8)}"
        circles = [
            Circle(-draw.randint(3, 9), f"1/3 + {miss}", vx=f"1 + {draw.randint(1, 99)}/1000", id="mover"),
            Circle(0, "7/3", m=draw.choice([1, "1/3", "oo"]), id="target"),
        ]
        walls = [Wall(-20, 0, -20, 1, id="left"), Wall(20, 0, 20, 1, id="right"), Wall(0, -11, 1, -11, id="low")]
        return Scene(circles, [*walls, Wall(0, "31/3", 1, "31/3", id="high")])
    return catalogue.build(text).with_changes(until=None, events=None)


FAULTS = ("forgets", "again", "another", "passes")


def engines(draw: Random) -> Iterator[Engine]:
    """Three or four for a scene."""
    yield engine(f"pymunk:dt=1/{draw.choice(STEPS)}")
    yield Stepper(1 / draw.choice(STEPS), draw.choice([1, 1, 4]), draw.random() < 0.5)
    yield Stepper(1 / draw.choice(STEPS), draw.choice([1, 4]), fault=draw.choice(FAULTS), at=draw.randint(1, 12))
    if find_spec("Box2D") is not None:
        yield engine(f"box2d:dt=1/{draw.choice(STEPS)}")


def judged(scene: Scene, chosen: Engine, reference: Trajectory, events: int) -> Iterator[str]:
    """What a comparison says of a run, beside what is known of it."""
    found = compare(scene, [chosen], events=events, causes=False)
    (candidate,) = found.candidates
    far = 4.0 if reference.stop.reason is StopReason.QUIET else 1.0
    until = max(float(reference.final_time) * far, float(candidate.trajectory.final_time))
    run, step = chosen.run(scene, until=until), float(chosen.step or 0)
    judge = Judge(reference, run, step, events, found.reference.stop.reason is StopReason.QUIET)
    strict, loose = judge.known(False), judge.known(True)
    divergence, where = candidate.alignment.divergence, (scene, chosen, events, candidate.alignment.divergence)
    tie = divergence is not None and divergence.kind is Kind.TIE
    if divergence is not None and tie and len(reference.events[divergence.event].contacts) > 1:  # of one exact instant
        yield "tie"
        return
    if not any(one.inside for one in strict):
        if any(one.near for one in strict):
            yield "at the end of the span"
            return
        if divergence is not None:  # of so small an impulse that the contact after it is more than twice as late
            assert judge.too_late(divergence), where
            yield "too late: parted"
            return
        yield "equal"
        return
    if tie and divergence is not None:  # several instants in one step, with a contact too many or too few
        least = min((one.event for one in strict if one.sure), default=math.inf)
        most = min((one.event for one in loose if one.sure), default=math.inf)
        assert divergence.event <= max(least, most), (where, least, most)
        assert candidate.alignment.agreed == min(divergence.event, events), where
        yield "tie of several instants" + ("" if least <= divergence.event else ", before partners differ")
        return
    if any(one.inside and one.sure for one in loose):
        assert divergence is not None, (where, candidate.verdict, loose)
        least = min(one.event for one in strict if one.sure)
        most = min(one.event for one in loose if one.sure)
        if all(one.sure for one in strict):
            assert least <= divergence.event <= most, (where, least, most)
            assert candidate.alignment.agreed == min(divergence.event, events), where
        yield "parted at one event" if least == most else "parted"
        return
    yield f"absorbed: {candidate.verdict}" if divergence is None else "absorbed: elsewhere"


def compared(seeds: Iterator[int], wanted: int) -> Counter[str]:
    """The answers on so many runs."""
    answers: Counter[str] = Counter()
    while answers.total() < wanted:
        draw = Random(next(seeds))
        scene = drawn(draw)
        reference = engine("exact").run(scene, events=LONGER * EVENTS[-1])
        if not reference.events:
            continue
        events = min(draw.choice(EVENTS), len(reference.events))
        for chosen in engines(draw):
            fault = f" that {chosen.fault}" if isinstance(chosen, Stepper) and chosen.fault else ""
            for answer in judged(scene, chosen, reference, events):
                answers[f"{chosen.name.partition(':')[0]}{fault}: {answer}"] += 1
    return answers


def counted(answers: Counter[str], what: str) -> int:
    return sum(count for text, count in answers.items() if what in text)


def test_a_run_of_equal_partners_never_diverges_and_others_do_at_the_first_event_that_is_not_had() -> None:
    answers = compared(iter(range(10**6)), FEW)
    assert counted(answers, ": equal") >= FEW // 6, answers
    assert counted(answers, ": parted") >= FEW // 6, answers


@pytest.mark.slow
@pytest.mark.timeout(7200)
@pytest.mark.parametrize("block", range(BLOCKS))
def test_two_thousand_stepped_runs(block: int) -> None:
    answers = compared(iter(range(10**6 * (block + 1), 10**6 * (block + 2))), MANY // BLOCKS)
    print(dict(sorted(answers.items())))
    assert counted(answers, ": equal") >= MANY // BLOCKS // 10, answers
    assert counted(answers, ": parted") >= MANY // BLOCKS // 10, answers
