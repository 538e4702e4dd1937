"""An independent referee: plays a scene twice by brute force in long numbers, and keeps what agrees.

Nothing here is shared with the engines under test but the scene. Numbers are whole multiples of 2**-bits
(`flint.fmpz`), plain points without enclosures. Every step:

1. predicts every pair and every wall anew: t = (-b - sqrt(b*b - a*c)) / a;
2. moves every circle to the first of these times;
3. turns the two velocities into the frame of the impact, applies the one-dimensional law, turns them back.

A scene is played at `bits` and at `2*bits`, the second time as its mirror image, moved aside, with circles
and walls listed backwards. The instants on which both agree are the refereed history.

    python tests/referee.py            # plays every scene of tests/data/referee/ again and says what differs
    python tests/referee.py --write    # makes these scenes and histories anew
"""

from __future__ import annotations

import json
import sys
import time as clock
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import mpmath
from mpmath import mpf
from referee_play import Instant, play
from referee_scenes import MERGED, SCENES

from truebreak.scenarios import Circle, Scene, Trajectory, Wall

DATA = Path(__file__).parent / "data" / "referee"
DIGITS = 25
"""Significant digits of the committed times and states."""
AGREED_BITS = 100
"""Two plays agree on a time if its relative difference is below 2**-AGREED_BITS."""
TOLERANCE = 1e-12
"""Error allowed to an engine's times, relative, and to its final state, relative to the largest there."""


# -- two plays, one history


@dataclass(frozen=True)
class History:
    """What two plays agree on.

    Attributes:
        events: the instants.
        stop: as in `Play`, or "precision" where the two plays part.
        final: x, y, vx, vy of every circle as the last of the events leaves it.
        bits: the lower of the two precisions.
        agreed_bits: the fewest bits on which the two agree, over all times and the final state.
        least_gap: the smallest gap to a competing contact, in units of the time, and the index of its event.
    """

    events: tuple[Instant, ...]
    stop: str
    final: dict[str, tuple[mpf, ...]]
    bits: int
    agreed_bits: int
    least_gap: tuple[mpf, int | None]


def referee(scene: Scene, events: int, bits: int = 1000, merge_ties: bool = False) -> History:
    """The history of `scene` as far as plays at `bits` and at `2*bits` agree, up to `events` instants."""
    low = play(scene, events, bits, merge_ties)
    high = play(scene, events, 2 * bits, merge_ties, mirrored=True)
    agreed = bits
    count = 0
    for one, other in zip(low.instants, high.instants, strict=False):
        same = _agreement(one.time, other.time)
        if one.contacts != other.contacts or same < AGREED_BITS:
            break
        agreed = min(agreed, same)
        count += 1
    stop = low.stop if count == len(low.instants) else "precision"
    if stop == "quiet" and high.stop != "quiet":
        stop = "precision"
    if 0 < count < len(low.instants):
        low = play(scene, count, bits, merge_ties)
    if 0 < count < len(high.instants):
        high = play(scene, count, 2 * bits, merge_ties, mirrored=True)
    for name, row in high.final.items():
        agreed = min([agreed, *(_agreement(a, b) for a, b in zip(low.final[name], row, strict=True))])
    least = min(((gap, index) for index, gap in enumerate(high.gaps[:count])), default=(mpf("inf"), None))
    return History(tuple(high.instants[:count]), stop, high.final, bits, agreed, least)


def _agreement(one: mpf, other: mpf) -> int:
    """Bits on which two numbers agree: relative above 1, absolute below."""
    with mpmath.workprec(20_000):
        difference = abs(one - other) / max(1, abs(other))
    return 20_000 if not difference else int(-mpmath.log(difference, 2))


def settled(scene: Scene, events: int, merge_ties: bool = False, bits: int = 1000) -> History:
    """A history that no lack of precision cuts short: the precision is doubled until it does not.

    Raises:
        RuntimeError: where 32,000 bits leave a tie, or do not suffice.
    """
    while bits <= 32_000:
        history = referee(scene, events, bits, merge_ties)
        if history.stop in ("events", "quiet") and history.agreed_bits >= AGREED_BITS:
            return history
        bits *= 2
    count = len(history.events)
    raise RuntimeError(f"{scene.name}: {history.stop} after {count} events at {history.bits} bits")


# -- judging an engine


def compare_to_referee(trajectory: Trajectory, history: History) -> None:
    """Holds an engine's history against the referee's, event by event, then the state after the last.

    A trajectory may go on longer, unless the referee found that nothing further happens.

    Raises:
        AssertionError: at the first wrong contact, or number that is off by more than `TOLERANCE`.
    """
    label = f"{trajectory.engine} on {trajectory.scene.name!r}"
    rank = {name: place for place, name in enumerate(trajectory.scene.ids)}
    for index, expected in enumerate(history.events):
        when = f"event {index} (time {mpmath.nstr(expected.time, 15)})"
        assert index < len(trajectory.events), (
            f"{label}: stops before {when}, where {_pairs(expected.contacts)} collide: "
            f"{trajectory.stop.reason.name}, {trajectory.stop.message}"
        )
        event = trajectory.events[index]
        contacts = tuple(sorted(map(tuple, event.contacts), key=lambda pair: [rank[name] for name in pair]))
        assert contacts == expected.contacts, (
            f"{label}: {when}: has {_pairs(contacts)} at {float(event.time)!r}, the referee {_pairs(expected.contacts)}"
        )
        error = abs(mpf(float(event.time)) - expected.time)
        assert error <= TOLERANCE * abs(expected.time), (
            f"{label}: {when}, {_pairs(contacts)}: has the time {float(event.time)!r}, off by {mpmath.nstr(error, 3)}"
        )
    if history.stop == "quiet":
        extra = trajectory.events[len(history.events) :]
        assert not extra, f"{label}: {_pairs(extra[0].contacts)} collide after the referee's last event"
    if history.events and history.final:
        _compare_states(label, trajectory, history)


def _compare_states(label: str, trajectory: Trajectory, history: History) -> None:
    state = trajectory.at(trajectory.events[len(history.events) - 1].time)
    for columns in (("x", "y"), ("vx", "vy")):
        places = [("x", "y", "vx", "vy").index(column) for column in columns]
        largest = max(abs(row[place]) for row in history.final.values() for place in places)
        for name, row in history.final.items():
            for column, place in zip(columns, places, strict=True):
                value = float(getattr(state[name], column))
                assert abs(mpf(value) - row[place]) <= TOLERANCE * largest, (
                    f"{label}: after event {len(history.events) - 1}: {name}.{column} is {value!r}, "
                    f"the referee has {mpmath.nstr(row[place], 17)}"
                )


def _pairs(contacts: Any) -> str:
    return ", ".join(f"{first}-{second}" for first, second in contacts)


# -- the files


def scene_from(data: dict[str, Any]) -> Scene:
    """The scene that `Scene.data()` wrote."""
    rest = {key: value for key, value in data.items() if key not in ("circle", "wall")}
    circles, walls = [Circle(**row) for row in data["circle"]], [Wall(**row) for row in data.get("wall", ())]
    return Scene(circles, walls, **rest)


def make(name: str) -> Scene:
    """The scene of that name, made anew."""
    maker, events = SCENES[name]
    return maker().with_changes(name=name, events=events, source=f"tests/referee.py, SCENES[{name!r}]")


def written(history: History) -> str:
    """A history as compact JSON, one event a line."""

    def digits(number: mpf) -> str:
        return mpmath.nstr(number, DIGITS)

    head = {
        "stop": history.stop,
        "bits": history.bits,
        "agreed_bits": history.agreed_bits,
        "least_gap": [mpmath.nstr(history.least_gap[0], 3), history.least_gap[1]],
        "final": {name: [digits(value) for value in row] for name, row in history.final.items()},
    }
    rows = [json.dumps([digits(e.time), *e.contacts], separators=(",", ":")) for e in history.events]
    lines = [f"{json.dumps(key)}: {json.dumps(value)}" for key, value in head.items()]
    return "{\n" + ",\n".join(lines) + ',\n"events": [\n' + ",\n".join(rows) + "\n]}\n"


def names() -> list[str]:
    """The committed scenes."""
    return sorted(path.name.removesuffix(".scene.json") for path in DATA.glob("*.scene.json"))


def load(name: str) -> tuple[Scene, History]:
    """A committed scene and its refereed history, times and final state to `DIGITS` digits."""
    scene = scene_from(json.loads((DATA / f"{name}.scene.json").read_text()))
    told = json.loads((DATA / f"{name}.events.json").read_text())
    with mpmath.workprec(128):
        return scene, History(
            tuple(Instant(mpf(time), tuple((a, b) for a, b in pairs)) for time, *pairs in told["events"]),
            told["stop"],
            {key: tuple(mpf(value) for value in row) for key, row in told["final"].items()},
            told["bits"],
            told["agreed_bits"],
            (mpf(told["least_gap"][0]), told["least_gap"][1]),
        )


def texts(name: str) -> tuple[str, str]:
    """What the two files of a scene should hold: the scene, the events."""
    scene = make(name)
    history = settled(scene, SCENES[name][1], merge_ties=name in MERGED)
    return json.dumps(scene.data(), indent=1) + "\n", written(history)


def main(write: bool) -> int:
    stale = 0
    for name in SCENES:
        start = clock.perf_counter()
        told = dict(zip(("scene", "events"), texts(name), strict=True))
        seconds = clock.perf_counter() - start
        for kind, text in told.items():
            path = DATA / f"{name}.{kind}.json"
            if write:
                path.write_text(text)
            elif not path.exists() or path.read_text() != text:
                stale += 1
                print(f"{path.name} is not current")
        head = json.loads(told["events"])
        print(
            f"{name:20} {len(head['events']):4} events  {head['stop']:7}"
            f"{head['bits']:5} and {2 * head['bits']:5} bits, agreed to {head['agreed_bits']:5}"
            f"  least gap {head['least_gap'][0]:>9}  {seconds:6.1f} s"
            f"  {sum(map(len, told.values())) / 1000:5.1f} kB"
        )
    return stale


if __name__ == "__main__":
    sys.exit(bool(main("--write" in sys.argv[1:])))
