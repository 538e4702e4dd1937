"""Further alterations: of policy, reversal, things that there are, how instants are cut, what witnesses speak of."""

from __future__ import annotations

from copy import deepcopy
from pathlib import Path
from random import Random

import pytest

from certificate.checkers import needs_node
from certificate.test_tampering import Told, altered, parts, refused


def other_policy(told: Told, draw: Random) -> None:
    """Another tie policy."""
    policies = {"simultaneous", "sequential", "sequential:seed=1", "sequential:seed=2"}
    told["scene"]["tie_policy"] = draw.choice(sorted(policies - {told["scene"]["tie_policy"]}))


def other_reversal(told: Told, draw: Random) -> None:
    """The reversal comes at another time, or not at all."""
    scene, choice = told["scene"], draw.randrange(3)
    scene.pop("reverse_at", None)
    scene.pop("reverse_after", None)
    if choice == 0:
        scene["reverse_at"] = draw.choice(["1/7", "3", "20", "1000"])
    elif choice == 1:
        scene["reverse_after"] = draw.randrange(1, 9)


def swap_data(told: Told, draw: Random) -> None:
    """Two circles exchange a number, or one takes on the other's."""
    one, other = (draw.choice(told["scene"]["circles"]) for _ in "ab")
    key = draw.choice(["x", "y", "vx", "vy", "r", "w"])
    one[key], other[key] = other[key], draw.choice([one[key], other[key]])


def nudge(told: Told, draw: Random) -> None:
    """A number of the scene changes by very little."""
    kind = draw.choice([kind for kind in ("circles", "walls", "pockets") if told["scene"].get(kind)])
    row = draw.choice(told["scene"][kind])
    key = draw.choice([key for key in row if key not in ("id", "length")])
    row[key] = f"{row[key]}{draw.choice('+-')}1/{10 ** draw.choice([3, 12, 25, 40, 90])}"


def fewer_things(told: Told, draw: Random) -> None:
    """A wall or pocket is gone, or captures what it did not, or there is a wall more."""
    scene = told["scene"]
    kind = draw.choice([kind for kind in ("walls", "pockets") if scene.get(kind)] or ["none"])
    if kind != "none" and draw.random() < 0.6:
        scene[kind].pop(draw.randrange(len(scene[kind])))
    elif kind == "pockets":
        scene["capture"] = not scene.get("capture", False)
    else:
        x = draw.choice(["3", "1000"])
        scene.setdefault("walls", []).append({"id": "more", "x0": x, "y0": "0", "x1": x, "y1": "1", "length": "1"})


def merge(told: Told, draw: Random) -> None:
    """Two instants become one, or one becomes two."""
    place = draw.randrange(len(told["instants"]))
    first, second = told["instants"][place], told["instants"][(place + 1) % len(told["instants"])]
    if len(first.get("met", ())) > 1:
        rest = deepcopy(first)
        first["met"], rest["met"] = first["met"][:1], first["met"][1:]
        first["rounds"], rest["rounds"] = [first["met"]], [rest["met"]]
        told["instants"].insert(place + 1, rest)
    elif first is not second:
        first["rounds"] = first.get("rounds", []) + second.get("rounds", [])
        first["met"] = first.get("met", []) + second.get("met", [])
        told["instants"].remove(second)


def other_list(told: Told, draw: Random) -> None:
    """A contact comes twice, moves to another instant, or another becomes the clock."""
    entry, other = (draw.choice([entry for entry in told["instants"] if "met" in entry]) for _ in "ab")
    choice = draw.randrange(3)
    if choice == 0:
        entry["met"].append(list(draw.choice(entry["met"])))
    elif choice == 1 and len(entry["met"]) > 1:
        other["met"].append(entry["met"].pop())
    else:
        draw.shuffle(entry["met"])


def cut_short(told: Told, draw: Random) -> None:
    """The run ends sooner, and says that nothing more happens."""
    del told["instants"][draw.randrange(1, len(told["instants"]) + 1) :]
    told["end"] = {"reason": draw.choice(["quiet", "stopped", "return"])}


def other_rounds(told: Told, draw: Random) -> None:
    """All rounds at once, or one contact at a time, or the other way round."""
    entry = draw.choice([part for part in parts(told) if part.get("met") or part.get("rounds")])
    rounds = entry.get("rounds", [entry.get("met", [])])
    choice = draw.randrange(3)
    if choice == 0:
        entry["rounds"] = [[contact] for group in rounds for contact in group]
    else:
        entry["rounds"] = [[contact for group in rounds for contact in group]] if choice == 1 else rounds[::-1]


def false_witness(told: Told, draw: Random) -> None:
    """A witness of what nobody asked for, or one moved to another instant, or of another isometry."""
    n, part = len(told["scene"]["circles"]), draw.choice(parts(told))
    holding = [part for part in parts(told) if part.get("zeros")]
    how = draw.choice(["back", 0, 1])
    if not holding or draw.random() < 0.5:
        question = draw.choice(["gap", "closing", "disc", "speed", "slack", "until", "reverse"])
        part.setdefault("zeros", []).insert(0, [question, sorted(draw.sample(range(n + 1), 2)), how])
    else:
        zeros = draw.choice(holding)["zeros"]
        zero = zeros.pop(draw.randrange(len(zeros)))
        part.setdefault("zeros", []).append([*zero[:2], how] if draw.random() < 0.5 else zero)


def false_isometry(told: Told, draw: Random) -> None:
    """An isometry becomes a well-known one, or maps otherwise."""
    if not told["isometries"]:
        false_witness(told, draw)
        return
    motion = draw.choice(told["isometries"])
    if draw.random() < 0.5:
        images = [image for _, image in motion["map"]]
        draw.shuffle(images)
        motion["map"] = [[k, image] for (k, _), image in zip(motion["map"], images, strict=True)]
    else:
        motion["matrix"] = draw.choice([["1", "0", "0", "1"], ["-1", "0", "0", "-1"], ["3/5", "4/5", "-4/5", "3/5"]])


def by_units(told: Told, draw: Random) -> None:
    """The last digit of a decimal is off by more than one."""
    row = draw.choice([*told["final"]["circles"], *([told["final"]["time"]] for _ in "a")])
    k = draw.randrange(len(row))
    digit = (int(row[k][-1]) + draw.choice([2, 3, 5, 8])) % 10
    if len(row) > 1:
        row[k] = row[k][:-1] + str(digit)
    else:
        told["final"]["time"] = row[0][:-1] + str(digit)


WAYS = (
    other_policy, other_reversal, swap_data, nudge, fewer_things, merge, other_list, cut_short, other_rounds,
    false_witness, false_isometry, by_units,
)  # fmt: skip


@needs_node
@pytest.mark.parametrize("count", [72, pytest.param(840, marks=pytest.mark.slow)])
def test_otherwise_altered_certificates_are_refused_or_shown_to_be_true(count: int, tmp_path: Path) -> None:
    assert refused(altered(count, WAYS, "other"), tmp_path) > count // 3
