"""Certificates of false histories, each aimed at one condition of the checkers, without which it would be verified."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from certificate.checkers import both_verify
from certificate.forging import SAME, TINY, Told, refused_by_both, row, told, witness
from truebreak.scenarios import Circle, Pocket, Quantity, Scene, Segment, Wall

FLY = [Circle(0, 0, vx=1), Circle(9, 0)]
"""One flies at the other; they meet at 7, and fly on or not by what is beside them."""

BESIDE = [Circle(0, 50), Circle(2, 50)]
"""Two at rest that touch, all the time."""


def entry_of(cert: Told, *contact: int) -> Told:
    """The first instant at which two meet."""
    return next(entry for entry in cert["instants"] if list(contact) in entry.get("met", ()))


def without(cert: Told, *contact: int) -> Told:
    """A certificate that leaves that instant out."""
    cert["instants"].remove(entry_of(cert, *contact))
    return cert


# -- what is left out


def nothing_told_up_to_a_horizon() -> Told:
    """No instant, not even time 0: the end would be taken for it."""
    cert = told(Scene(FLY), until=100)
    cert["instants"] = []
    cert["final"] = {"time": "0.0", "circles": [["0.0", "0.0", "1.0", "0.0"], ["9.0", "0.0", "0.0", "0.0"]]}
    return cert


def an_entry_hidden_by_the_leaving() -> Told:
    """A circle flies through a pocket; only that it leaves it is told, among others who meet just then."""
    circles = [Circle(0, 0, vx=1), Circle(20, 50, vx=1), Circle(32, 50)]
    cert = told(Scene(circles, pockets=[Pocket(9, 0, 1)]))
    cert["instants"] = [part for part in cert["instants"] if "enter" not in part]
    cert["instants"][-1]["met"].append([0, -1])
    return cert


def through_what_another_hits_later(*things: Circle, **more: Any) -> Told:
    """A circle flies through something fixed; the flight of that ends only then, as another circle hits it."""
    through, hits = Circle(-4, -6, vx=4, id="through"), Circle(0, 10, vy=-1, id="hits")
    cert = told(Scene([through, hits, *things], **more), until=20)
    assert [part["rounds"] for part in cert["instants"][1:]]
    cert["scene"]["circles"][0]["y"] = cert["final"]["circles"][0][1] = "0"
    return cert


def a_time_of_its_own(place: int) -> Told:
    """Time 0, or the reversal, is told a time that is another one, and that nothing rests on."""
    cert = told(Scene(FLY, reverse_after=1))
    entry = cert["instants"][place]
    assert place == 0 or "turn" in entry
    entry["exact"] = "12345"
    return cert


def a_touch_at_time_0_left_out(**second: Any) -> Told:
    """Two touch at time 0, and then the one is struck, or they fly at each other."""
    cert = told(Scene([Circle(-9, 0, vx=1), Circle(0, 0), Circle(2, 0, **second)]), events=1)
    assert [1, 2] in cert["instants"][0]["met"]
    cert["instants"][0] = {"time": "0"}
    return cert


def on_the_rim_at_time_0() -> Told:
    """A centre on the rim flies inward."""
    cert = told(Scene([Circle(0, 0, vx=1)], pockets=[Pocket(1, 0, 1)]))
    cert["instants"][0] = {"time": "0"}
    return cert


def on_the_rim_at_the_reversal() -> Told:
    """A centre leaves a pocket at the very instant of the reversal, and so enters it again."""
    cert = told(Scene([Circle(0, 0, vx=1)], pockets=[Pocket(9, 0, 1)], reverse_at=10))
    for part in cert["instants"][2:]:
        part.pop("met", None)
        part.pop("enter", None)
    return cert


def in_a_row(*left_out: int, count: int = 4) -> Told:
    """A row passes a blow on; one meeting, or the rest from one on, is not told."""
    cert = told(Scene(row(0, count)), events=count - 1)
    first, *_ = left_out
    cert["instants"] = [part for k, part in enumerate(cert["instants"]) if k not in left_out]
    cert["end"] = {"reason": "quiet"} if first == count - 1 else {"reason": "stopped"}
    return cert


# -- what was not


def exchanged() -> Told:
    """Two independent meetings in the other order."""
    cert = told(Scene([*FLY, Circle(0, 50, vx=2), Circle(9, 50)]))
    cert["instants"][1:3] = cert["instants"][2:0:-1]
    return cert


def at_the_time(text: str) -> Told:
    """A meeting at another time, of two that touch all along."""
    cert = told(Scene([*FLY, *BESIDE]))
    cert["instants"].append({"time": text.partition("+")[0], "exact": text, "met": [[2, 3]], "rounds": [[[2, 3]]]})
    return cert


def fixed_circles_meet() -> Told:
    """Two fixed circles that touch, and are told to."""
    cert = told(Scene([*FLY, *(Circle(x, 50, m="oo") for x in (0, 2))]))
    cert["instants"][0]["met"] = [[2, 3]]
    return cert


def a_fixed_circle_gives_way() -> Told:
    """One that is fixed is said to weigh something, in the final state alone."""
    cert = told(Scene([Circle(0, 0, vx=1), Circle(9, 0, m="oo")]))
    cert["final"]["circles"] = [["7", "0", "0", "0"], ["9", "0", "1", "0"]]
    return cert


def through_a_wall() -> Told:
    """A wall is not there, as seen from its back."""
    return without(told(Scene([Circle(9, 0, vx=-1)], [Wall(0, 0, 0, 1)])), 0, 1)


def rounds(*told_rounds: list[list[Any]], policy: str = "simultaneous") -> Told:
    """Three touch in a row, the first and the last of which fly at the middle one; their rounds are others."""
    circles = [Circle(-2, 0, vx=2), Circle(0, 0, m=2), Circle(2, 0, vx=-1, m=3)]
    cert = told(Scene(circles, tie_policy=policy), events=1)
    cert["instants"][0]["rounds"], cert["end"] = list(told_rounds), {"reason": "stopped"}
    return cert


def another_seed() -> Told:
    """The order that seed 1 draws, said to be that of seed 5."""
    circles = [Circle(-2, 0, vx=2), Circle(0, 0, m=2), Circle(2, 0, vx=-1, m=3)]
    cert, other = (told(Scene(circles, tie_policy=f"sequential:seed={k}"), events=1) for k in (1, 5))
    assert cert["instants"][0]["rounds"] != other["instants"][0]["rounds"]
    cert["scene"]["tie_policy"] = "sequential:seed=5"
    return cert


# -- the reversal


def turned(change: Callable[[list[Told]], Any], **settings: Any) -> Told:
    """A run there and back, of which the instants are changed."""
    cert = told(Scene([*FLY, Circle(-20, 0)], **(settings or {"reverse_at": 10})))
    change(cert["instants"])
    return cert


def at_the_horizon() -> Told:
    """The reversal falls on the horizon, and is left out."""
    cert = told(Scene(FLY, reverse_at=5), until=5)
    del cert["instants"][1:]
    return cert


def captured_on_the_way_out() -> Told:
    """What a pocket has taken flies back all the same."""
    cert = told(Scene([Circle(0, 0, vx=1), Circle(9, 0, vx="1/2")], pockets=[Pocket(30, 0, 1)], reverse_at=60))
    cert["scene"]["capture"] = True
    return cert


# -- zeros


def back_by_what_lasts() -> Told:
    """On the way back a meeting is told a little late; that two touch all the time is no sign of when it is."""
    cert = told(Scene([*FLY, *BESIDE], reverse_at=20))
    last = cert["instants"][-1]
    assert last["met"] == [[0, 1]] and last["time"].startswith("33.0")
    last |= {"exact": f"33+{TINY}", "met": [[2, 3], [0, 1]], "zeros": [["gap", [0, 1], "back"]]}
    return cert


def back_before_the_reversal() -> Told:
    """Two are tied by the way back, before there is one."""
    apart = Quantity.of(f"9+{TINY}")
    cert = told(Scene([*FLY, Circle(0, 50, vx=1), Circle(apart, 50)], reverse_at=20), events=1)
    cert["bits"], cert["end"] = 160, {"reason": "stopped"}
    cert["instants"][1] |= {"met": [[0, 1], [2, 3]], "rounds": [[[0, 1]], [[2, 3]]], "zeros": [["gap", [2, 3], "back"]]}
    cert["instants"][1].pop("exact", None)
    return cert


def a_twin_that_was_taken(*contact: int) -> Told:
    """Of two pairs alike, one flies into a pocket that captures it; its meeting is told, or shown by its twin."""
    scene = Scene([*FLY, Circle(0, 50, vx=1), Circle(9, 50)], pockets=[Pocket(4, 50, 1)], capture=True)
    cert = told(scene)
    entry = entry_of(cert, 0, 1)
    entry |= {"met": [[0, 1], [2, 3]], "rounds": [[list(contact)]]}
    motion = {"matrix": SAME["matrix"], "shift": ["0", "-50"], "map": [[2, 0], [3, 1]]}
    witness(cert, entry, "gap", [2, 3], motion=motion)
    return cert


def a_closing_speed_by_an_image() -> Told:
    """Two that approach a little, by the image of two that do not: their data tell the isometry."""
    slow = Quantity.of(f"1-{TINY}")
    cert = told(Scene([Circle(0, 0, vx=1), Circle(2, 0, vx=1), Circle(0, 50, vx=1), Circle(2, 50, vx=1)]))
    cert["scene"]["circles"][3]["vx"] = str(slow)
    motion = {"matrix": SAME["matrix"], "shift": ["0", "-50"], "map": [[2, 0]]}
    witness(cert, cert["instants"][0], "closing", [2, 3], [0, 1], motion=motion)
    return cert


def told_outside_the_ring(key: str) -> Told:
    """A time or an impulse where the flights before it are not known exactly."""
    cert = told(Scene(row(0)), events=2)
    last = cert["instants"][2]
    last |= {"exact": "4"} if key == "exact" else {"rounds": [[[1, 2, "1/3"]]]}
    return cert


LOOPHOLES: dict[str, Callable[[], Told]] = {
    "through a fixed circle that is hit later": lambda: through_what_another_hits_later(Circle(0, 0, m="oo", id="peg")),
    "through an end that is hit later": lambda: through_what_another_hits_later(
        segments=[Segment(0, 0, 0, -4, r="1/4", id="post")]
    ),
    "a touch at time 0 of one that is struck": a_touch_at_time_0_left_out,
    "a touch at time 0 of two that approach": lambda: a_touch_at_time_0_left_out(vx=-1),
    **{f"meeting {k} of a row of four left out": lambda k=k: in_a_row(k) for k in (1, 2, 3)},
    "all but the first of a row of four left out": lambda: in_a_row(2, 3),
    **{f"a meeting at {text}": lambda text=text: at_the_time(text) for text in ("-1", "0", "7", f"7+{TINY}", "1e9")},
    **{f"a time of its own at instant {k}": lambda k=k: a_time_of_its_own(k) for k in (0, 2)},
    "the first alone": lambda: rounds([[0, 1]]),
    "the last alone": lambda: rounds([[1, 2]]),
    "one after the other": lambda: rounds([[0, 1]], [[1, 2]], [[0, 1]], [[1, 2]]),
    "impulses that are too small": lambda: rounds([[0, 1, "1/9"], [1, 2, "1/9"]]),
    "impulses that pull": lambda: rounds([[0, 1, "-1"], [1, 2, "1"]]),
    "no impulse": lambda: rounds([[0, 1, "0"], [1, 2, "0"]]),
    "the second first": lambda: rounds([[1, 2]], [[0, 1]], policy="sequential:order=scene"),
    "both at once": lambda: rounds([[0, 1], [1, 2]], policy="sequential:order=scene"),
    "one round too many": lambda: rounds([[0, 1]], [[1, 2]], [[0, 1]], [[1, 2]], policy="sequential:order=scene"),
    "no turn": lambda: turned(lambda parts: parts.pop(3)),
    "neither turn nor its time": lambda: turned(lambda parts: [parts.pop(3), parts.pop(2)]),
    "two turns": lambda: turned(lambda parts: parts.insert(4, parts[3])),
    "a turn before its time": lambda: turned(lambda parts: parts.insert(1, parts.pop(3))),
    "a turn at time 0": lambda: turned(lambda parts: parts.insert(0, parts.pop(3))),
    "a turn with a meeting": lambda: turned(lambda parts: parts[3].update(met=[[0, 1]])),
    "no way back": lambda: turned(lambda parts: parts.pop()),
    "no turn after an event": lambda: turned(lambda parts: parts.pop(2), reverse_after=1),
    "a turn after no event": lambda: turned(lambda parts: parts.insert(1, parts.pop(2)), reverse_after=1),
    "a twin that was taken meets": lambda: a_twin_that_was_taken(0, 1),
    "a twin that was taken pushes": lambda: a_twin_that_was_taken(2, 3),
    "a time outside the ring": lambda: told_outside_the_ring("exact"),
    "an impulse outside the ring": lambda: told_outside_the_ring("rounds"),
    **{made.__name__: made for made in (
        nothing_told_up_to_a_horizon, an_entry_hidden_by_the_leaving, on_the_rim_at_time_0, on_the_rim_at_the_reversal,
        exchanged, fixed_circles_meet, a_fixed_circle_gives_way, through_a_wall, another_seed, at_the_horizon,
        captured_on_the_way_out, back_by_what_lasts, back_before_the_reversal, a_closing_speed_by_an_image,
    )},
}  # fmt: skip


@pytest.mark.parametrize("name", LOOPHOLES)
def test_there_is_no_way_through(name: str, tmp_path: Path) -> None:
    refused_by_both(LOOPHOLES[name](), tmp_path / "forged.json")


def test_what_is_beyond_all_doubles_is_verified(tmp_path: Path) -> None:
    far = Quantity.of("10**400")
    rows = [Circle(x, Quantity.of(f"{y} + {x}/28"), vx=0 if x else 1) for y in (0, far) for x in (0, 4, 8)]
    scenes = {
        "far off": Scene([Circle(0, 0, vx=1), Circle(4, 1), Circle(far, 0)]),
        "a tie far off": Scene(rows, reverse_at=20),
        "a graze far off": Scene([Circle(0, far, vx=1), Circle(9, Quantity.of("10**400+2")), Circle(40, far)]),
    }
    both_verify([(name, told(scene)) for name, scene in scenes.items()], tmp_path)


@pytest.mark.parametrize("depth", ["10**-30", "10**-45", "10**-98", "10**-700"])
@pytest.mark.parametrize("capture", [False, True])
def test_a_centre_that_is_hardly_in_a_pocket_is_verified(depth: str, capture: bool, tmp_path: Path) -> None:
    """Few bits do not tell it from one outside, which would have to be seen to enter; it flies in deeper, and is hit or
    flies on for ever."""
    pocket = Pocket(3 - Quantity.of(depth), 0, 3)
    scenes = {
        "hit": Scene([Circle(0, 0, vx=1), Circle(5, 0)], pockets=[pocket], capture=capture),
        "alone": Scene([Circle(0, 0, vx=1), Circle(50, 9, vy=1)], pockets=[pocket], capture=capture),
        "turned": Scene([Circle(0, 0, vx=1), Circle(50, 0)], pockets=[pocket], reverse_at=2),
    }
    both_verify([(name, told(scene)) for name, scene in scenes.items()], tmp_path)
