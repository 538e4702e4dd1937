"""Comparisons whose answer is known otherwise: from whom each body meets in runs that last far longer.

Nothing here aligns, waits, or looks at velocities. A body's meetings in the longer runs are two plain lists; they
differ at a place or they do not. Scenes are drawn so that no two contacts fall on one instant of the exact motion: then
no order of impulses is in question, and a stepped engine alone has several in one of its steps.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator
from random import Random
from typing import Any, NamedTuple

import pytest

from truebreak.compare import ENGINES, compare, engine
from truebreak.compare.alignment.instants import Kind
from truebreak.compare.candidate import Candidate
from truebreak.scenarios import Circle, Scene, StopReason, Trajectory, Wall, catalogue

LONGER = 3
"""Times as many events as the longest span has: how much farther the runs go from which the answer is known."""

NAMES = (
    *("exact", "double", "single", "quad", "rounded:bits=40", "interval", "interval:bits=200"),
    *("pymunk:dt=1/64", "pymunk:dt=1/1024", "pymunk"),
)

LITERAL = ("gas:n=2,seed={}", "galperin:n=1", "near-tie:k=9")
"""Scenes that SymPy can run."""

FEW, MANY = 3, 40
"""Scenes drawn in an ordinary run of the tests, and in a slow one."""

SPANS = (6, 18, 45)
"""Events compared."""


class Meeting(NamedTuple):
    """Whom a body meets in one event, once each."""

    partners: frozenset[str]
    time: float
    event: int


class Parting(NamedTuple):
    """Where a body's two lists part: the reference's event, and the earlier of the two times."""

    time: float
    body: str
    mine: Meeting | None
    theirs: Meeting | None


def meetings(run: Trajectory) -> dict[str, list[Meeting]]:
    """Each body's meetings."""
    met: dict[str, list[Meeting]] = {str(c.id): [] for c in run.scene.circles}
    for event in run.events:
        for name in {name for pair in event.impulses for name in pair if name in met}:
            others = frozenset(b if a == name else a for a, b in event.impulses if name in (a, b))
            met[name].append(Meeting(others, float(event.time), event.index))
    return met


def parting(
    body: str, mine: list[Meeting], theirs: list[Meeting], step: float | None, ends: tuple[float, float] = (0.0, 0.0)
) -> Parting | None:
    """Where two lists part; None if one of them is the beginning of the other.

    A step may hold several of the exact meetings, in any order, and a contact may last for two steps. What one run has
    in the first half of the other's time (up to its end), and the other never, is missing from that.

    Args:
        ends: when each of the two runs ends; infinite for one that is known to be over.
    """
    ours, other = list(mine), list(theirs)
    last: Meeting | None = None
    while ours and other:
        got = other.pop(0)
        again = step is not None and last is not None and got.partners == last.partners
        if again and got.time - last.time <= 2 * step and ours[0].partners != got.partners:
            last = got
            continue
        expected, left = ours[0], set(got.partners)
        while left and ours and ours[0].partners <= left:
            left -= ours.pop(0).partners
        if left and ours:
            return Parting(min(ours[0].time, got.time), body, expected if left == got.partners else ours[0], got)
        last = got
    if ours and 2 * ours[0].time < ends[1]:
        return Parting(ours[0].time, body, ours[0], None)
    if other and 2 * other[0].time < ends[0]:
        return Parting(other[0].time, body, None, other[0])
    return None


class Known(NamedTuple):
    """What is known of one engine on one scene: where any body's lists part, the earliest first."""

    partings: list[Parting]
    stop: StopReason
    events: int

    def within(self, reference: Trajectory, events: int) -> Parting | None:
        """The first parting that one of the two has inside a span of so many of the reference's events."""
        end = float(reference.events[events - 1].time)
        inside = (
            p
            for p in self.partings
            if (p.mine is not None and p.mine.event < events) or (p.theirs is not None and p.theirs.time <= end)
        )
        return next(inside, None)


def known(reference: Trajectory, run: Trajectory, step: float | None) -> Known:
    """From the longer runs of both."""
    mine, theirs = meetings(reference), meetings(run)
    ends = tuple(
        math.inf if told.stop.reason is StopReason.QUIET else float(told.final_time) for told in (reference, run)
    )
    found = [p for body in mine if (p := parting(body, mine[body], theirs[body], step, ends)) is not None]
    return Known(sorted(found, key=lambda p: (p.time, p.body)), run.stop.reason, len(run.events))


def plain(reference: Trajectory) -> bool:
    """Whether no two contacts of a run fall on one instant."""
    return all(len(event.contacts) == 1 for event in reference.events)


def drawn(seed: int) -> Scene:
    """A scene."""
    draw = Random(seed)
    kind = draw.choice(["gas"] * 4 + ["rack", "near-tie", "pass", "pass", "bullet"])
    if kind == "gas":
        text = f"gas:n={draw.randint(2, 8)},seed={draw.randrange(10**4)},mixed={draw.choice(['yes', 'no'])}"
    elif kind == "near-tie":
        text = f"near-tie:k={draw.randint(2, 60)}"
    elif kind == "rack":
        jitter = draw.choice(["1/1000", "1/10**6", "1/10**9"])
        text = (
            f"rack:rows={draw.randint(2, 3)},gap=1/7,jitter={jitter},seed={draw.randrange(10**4)},offset=1/26,speed=20"
        )
    elif kind == "pass":
        return passing(draw)
    else:
        radius = f"1/{draw.choice([10, 100, 1000])}"
        place = draw.randint(10, 10**5)
        return Scene([Circle(0, 0, radius, vx=draw.randint(1, 20), id="b"), Circle(f"{place}/997", 0, radius, id="t")])
    return catalogue.build(text).with_changes(until=None, events=None)


def passing(draw: Random) -> Scene:
    """A circle that misses another by a little, or hits it by as little, in a box that brings it back."""
    miss = f"{draw.choice(['-', ''])}{draw.randint(1, 9)}/10**{draw.randint(1, 30)}"
    circles = [
        Circle(-draw.randint(3, 9), f"1/3 + {miss}", vx=f"1 + {draw.randint(1, 99)}/1000", id="mover"),
        Circle(0, "7/3", m=draw.choice([1, "1/3", "oo"]), id="target"),
    ]
    walls = [Wall(-20, 0, -20, 1, id="left"), Wall(20, 0, 20, 1, id="right"), Wall(0, -11, 1, -11, id="low")]
    return Scene(circles, [*walls, Wall(0, "31/3", 1, "31/3", id="high")])


def check(candidate: Candidate, parted: Parting | None, later: bool, what: Any) -> None:
    """That a verdict is what is known.

    Args:
        parted: the first parting inside the span.
        later: whether there is one at all.
    """
    divergence = candidate.alignment.divergence
    if divergence is not None and divergence.kind is Kind.TIE:
        # A step that takes several meetings as one: by the lists it shows only in what comes of it.
        assert later, (what, divergence)
        assert parted is None or divergence.time <= parted.time + 1e-9, (what, divergence, parted)
        return
    if parted is not None:
        assert candidate.verdict == "diverged", (what, candidate.verdict, parted)
        assert divergence is not None
        names = {name for m in (parted.mine, parted.theirs) if m is not None for name in m.partners} | {parted.body}
        assert divergence.time == pytest.approx(parted.time, abs=1e-9), (what, divergence, parted)
        assert divergence.body in names, (what, divergence, parted)
        return
    assert candidate.verdict in ("agree", "undecided"), (what, divergence)


def attack(seeds: Iterator[int], wanted: int) -> Counter[str]:
    """Compares so many scenes with all engines over several spans; what the answers were."""
    answers: Counter[str] = Counter()
    scenes = 0
    while scenes < wanted:
        seed = next(seeds)
        scene = drawn(seed)
        reference = engine("exact").run(scene, events=LONGER * SPANS[-1])
        if not plain(reference) or not reference.events:
            continue
        scenes += 1
        answers.update(attacked(f"{seed}: {scene.name}", scene, reference, NAMES, SPANS))
    return answers


def attacked(
    text: str, scene: Scene, reference: Trajectory, names: tuple[str, ...], spans: tuple[int, ...]
) -> Iterator[str]:
    """The answers on one scene, each checked."""
    runs = {}
    far = 4.0 if reference.stop.reason is StopReason.QUIET else 1 + 2**-40
    for name in names:
        chosen = engine(name)
        run = chosen.run(scene, until=float(reference.final_time) * far)
        runs[name] = known(reference, run, chosen.step)
    for events in dict.fromkeys(min(span, len(reference.events)) for span in spans):
        comparison = compare(scene, names, events=events, causes=False)
        assert len(comparison.reference.events) == events
        for name in names:
            candidate, told = comparison[name], runs[name]
            check(candidate, told.within(reference, events), bool(told.partings), (text, name, events))
            if candidate.verdict == "undecided":
                assert told.stop is StopReason.UNDECIDED, (text, name, events)
                assert told.events < events, (text, name, events)
            yield candidate.verdict


def test_the_referee_s_own_lists() -> None:
    def met(*names: str, step: float = 1.0) -> list[Meeting]:
        return [Meeting(frozenset(name.split("+")), step * k, k) for k, name in enumerate(names)]

    assert parting("a", met("b", "c"), met("b", "c", "d"), None) is None
    found = parting("a", met("b", "c"), met("b", "d"), None)
    assert found is not None
    assert (found.time, found.mine, found.theirs) == (1.0, met("b", "c")[1], met("b", "d")[1])
    assert parting("a", met("b", "c", "d"), met("b+c", "d"), 0.1) is None
    assert parting("a", met("b", "c"), met("b", "b", "c", step=0.1), 0.1) is None
    assert parting("a", met("b", "c"), met("b", "b", "c"), 0.1) is not None


def test_every_engine_is_attacked() -> None:
    assert {name.partition(":")[0] for name in NAMES} | {"sympy"} == {
        name for name, entry in ENGINES.items() if not entry.adapted
    }


def test_a_few_comparisons_are_right() -> None:
    answers = attack(iter(range(10**6)), FEW)
    assert answers.total() >= 50
    assert answers["diverged"] >= 10


@pytest.mark.slow
@pytest.mark.timeout(3600)
def test_hundreds_of_comparisons_are_right() -> None:
    answers = attack(iter(range(10**6)), MANY)
    print(dict(answers))
    assert answers.total() >= 600
    assert answers["diverged"] >= 150
    assert answers["unsettled"] == 0


@pytest.mark.parametrize("text", [LITERAL[0].format(1), *LITERAL[1:]])
def test_the_literal_engine_is_attacked(text: str) -> None:
    scene = catalogue.build(text).with_changes(until=None, events=None)
    reference = engine("exact").run(scene, events=4)
    told = known(reference, engine("sympy").run(scene, events=4), None)
    assert not told.partings
    for events in range(1, len(reference.events)):
        assert compare(scene, ["sympy"], events=events, causes=False).verdict == "agree"
