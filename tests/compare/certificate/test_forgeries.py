"""Certificates forged by hand, by someone who knows how the checkers work: both refuse every one."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from certificate.checkers import NODE, by_node, by_python
from certificate.forging import SAME, TINY, UPSIDE_DOWN, Told, added, refused_by_both, row, told, witness
from truebreak.compare.certificate import certificate_json
from truebreak.scenarios import Circle, Pocket, Quantity, Scene, Wall

# -- ties


def copies_of_which_one_is_flawed(key: str, circle: int) -> Told:
    """Two rows tied by an isometry, one of them then flawed: data that its map must compare."""
    cert = told(Scene([*row(0), *row(50, name="b")]), events=2)
    added(cert, circle, key)
    return cert


def rows_apart(*circles: int) -> Told:
    """The motion that takes the second row to the first."""
    return {"matrix": SAME["matrix"], "shift": ["0", "-50"], "map": [[k + 3, k] for k in circles]}


def pasts_of_unequal_length() -> Told:
    """A pair's copy of which one has been struck before, from the side and by something very light: the times differ
    by the square of what it weighs, which intervals do not tell."""
    pairs = [Circle(x, y, vx=0 if x else 1) for y in (0, 50) for x in (0, 5)]
    light = Circle(0, "95/2", r="1/2", vx=1, vy=1, m=TINY)
    cert = told(Scene([*pairs, light]), events=3)
    assert [entry["met"] for entry in cert["instants"][1:]] == [[[2, 4]], [[0, 1]], [[2, 3]]]
    both = {**cert["instants"][2], "met": [[0, 1], [2, 3]], "rounds": [[[0, 1]], [[2, 3]]]}
    both.pop("exact", None)
    cert["instants"][2:], cert["end"], cert["bits"] = [both], {"reason": "stopped"}, 300
    witness(cert, both, "gap", [2, 3], motion={**rows_apart(), "map": [[2, 0], [3, 1]]})
    return cert


def a_map_of_fewer_circles_than_the_past_has() -> Told:
    """The last tie of two rows, by a map that leaves a circle of their past out, which is not alike."""
    cert = told(Scene([*row(0), *row(50, name="b")]), events=2)
    added(cert, 3, "w")
    cert["roots"], cert["isometries"] = ["195"], [rows_apart(1, 2)]
    first, last = cert["instants"][1:]
    first |= {"exact": "4-1/7*r1", "zeros": []}
    last |= {"met": [[1, 2], [4, 5]], "zeros": [["gap", [4, 5], 0]]}
    return cert


def a_mirror_that_maps_both_to_themselves() -> Told:
    """Of two circles that hit two others a hair apart: the identity maps a contact to itself, not to the other."""
    circles = [Circle(0, 0, vx=1), Circle(5, 0), Circle(0, 9, vx=1), Circle(Quantity.of(f"5+{TINY}"), 9)]
    cert = told(Scene(circles), events=1)
    cert["end"], cert["bits"] = {"reason": "stopped"}, 160
    entry = cert["instants"][1]
    entry["met"], entry["rounds"] = [[0, 1], [2, 3]], [[[0, 1]], [[2, 3]]]
    witness(cert, entry, "gap", [2, 3], motion={**SAME, "map": [[k, k] for k in range(4)]})
    return cert


def a_tie_with_itself() -> Told:
    """As before, tied to itself."""
    cert = a_mirror_that_maps_both_to_themselves()
    cert["instants"][1]["zeros"] = [["gap", [2, 3], 0, [2, 3]]]
    return cert


def two_instants_at_one_time() -> Told:
    """Two tied contacts far apart are told one after the other."""
    cert = told(Scene([*row(0, 2), *row(50, 2, name="b")]))
    entry = cert["instants"].pop(1)
    parts = [{"time": entry["time"], "met": [contact], "rounds": [[contact]]} for contact in entry["met"]]
    cert["instants"][1:1] = parts
    return cert


def a_tied_contact_left_out() -> Told:
    """One of two tied contacts is not told."""
    cert = told(Scene([*row(0, 2), *row(50, 2, name="b")]), events=1)
    entry = cert["instants"][1]
    entry["met"], entry["rounds"] = entry["met"][:1], [entry["met"][:1]]
    entry.pop("zeros", None)
    return cert


# -- zeros


def nearly_abreast(question: str) -> Told:
    """Two that touch fly abreast, but for very little."""
    fast = Quantity.of(f"1-{TINY}")
    scene = Scene([Circle(0, 0, vx=1, vy=1), Circle(0, 2, vx=1, vy=1), Circle(100, 0, r=50, m="oo")])
    cert = told(scene, events=1)
    cert["end"] = {"reason": "stopped"}
    cert["scene"]["circles"][1]["vy"] = str(fast)
    shift = {"matrix": SAME["matrix"], "shift": ["0", "2"], "map": [[0, 1]]}
    witness(cert, cert["instants"][0], question, [0, 1], motion=shift)
    return cert


def a_slide_that_is_none() -> Told:
    """A circle on a floor leaves it by very little; the mirror along the floor is said to hold it."""
    cert = told(Scene([Circle(0, 0, vx=1), Circle(9, 0)], [Wall(0, -1, 1, -1)]), events=1)
    cert["scene"]["circles"][0]["vy"] = f"-{TINY}"
    mirror = {**UPSIDE_DOWN, "map": [[0, 0]]}
    witness(cert, cert["instants"][0], "closing", [0, 2], motion=mirror)
    return cert


def a_turn_for_a_mirror() -> Told:
    """Half a turn takes a floor's normal to its negative, and the circle's velocity too."""
    scene = Scene([Circle(0, 0, vx=0, vy=-1), Circle(9, 0)], [Wall(0, -1, 1, -1)])
    cert = told(scene, events=1)
    cert["instants"], cert["end"] = [{"time": "0", "met": [[0, 2]]}], {"reason": "quiet"}
    half = {"matrix": ["-1", "0", "0", "-1"], "shift": ["0", "0"], "map": [[0, 0]]}
    witness(cert, cert["instants"][0], "closing", [0, 2], motion=half)
    return cert


def a_near_graze(offset: str, how: str | int) -> Told:
    """Two that miss or hit by very little are said to graze."""
    cert = told(Scene([Circle(0, 0, vx=1), Circle(9, 2), Circle(40, 0)]), events=1)
    cert["scene"]["circles"][1]["y"] = f"2{offset}{TINY}"
    cert["isometries"].append({**SAME, "map": [[0, 0], [1, 1]]})
    for part in cert["instants"]:
        part["zeros"] = [["disc", [0, 1], how]]
    return cert


def a_graze_for_a_hit() -> Told:
    """Two that graze are said to meet, and to push."""
    cert = told(Scene([Circle(0, 0, vx=1), Circle(9, 2)]))
    cert["instants"].append({"time": "9", "exact": "9", "met": [[0, 1]], "rounds": [[[0, 1]]]})
    return cert


def a_hit_for_a_graze() -> Told:
    """Two that are yet to meet are said to graze, and so nothing happens any more."""
    cert = told(Scene([Circle(0, 0, vx=1), Circle(9, 1), Circle(0, 50, vx=1), Circle(9, 50)]), events=1)
    cert["isometries"].append({**SAME, "map": [[0, 0], [1, 1]]})
    cert["end"] = {"reason": "quiet", "zeros": [["disc", [0, 1], 0]]}
    return cert


def a_graze_among_impulses() -> Told:
    """A graze of a circle that is struck at that very instant is not told, so that what it does to it is not."""
    cert = told(Scene([Circle(0, 0, vx=1), Circle(9, 2), Circle(11, 0)]), events=1)
    assert [0, 1] in cert["instants"][1]["met"]
    cert["instants"][1]["met"].remove([0, 1])
    return cert


# -- rounds


def lee(**settings: Any) -> Scene:
    """Three balls on a line, the middle one struck from both sides at one instant."""
    balls = [Circle(-3, 0, vx=1), Circle(0, 0), Circle(4, 0, r=2, vx=-1, m=4)]
    return Scene(balls, **settings)


def other_rounds(*rounds: list[list[int]]) -> Told:
    """The rounds of three balls on a line are others."""
    cert = told(lee())
    cert["instants"][1]["rounds"] = list(rounds)
    return cert


def another_final_state() -> Told:
    """The history of three balls by one policy, said to be by another."""
    cert = told(lee(tie_policy="sequential:order=scene"))
    cert["scene"]["tie_policy"] = "simultaneous"
    return cert


def back_after_rounds_that_do_not_go_back() -> Told:
    """Two copies of three balls and walls, one contact after the other; on the way back in the same order, not the
    reverse one. What comes then is no way back, though the copies stay tied."""

    def copy(y: int) -> list[Circle]:
        return [Circle(-3, y, vx=-1), Circle(0, y), Circle(20, y, r=2, vx=-1, m=4)]

    walls = [Wall(x, 0, x, 1) for x in (-12, 40)]
    scene = Scene([*copy(0), *copy(50)], walls, reverse_at=18, tie_policy="sequential:order=scene")
    cert = told(scene, events=8)
    cert["end"], cert["instants"] = {"reason": "stopped"}, cert["instants"][:7]
    last = cert["instants"][-1]
    assert last["met"] == [[0, 6], [3, 6]]
    last["zeros"] = [["gap", [3, 6], "back"]]
    return cert


# -- pockets


def into_a_hole(**settings: Any) -> Scene:
    """A circle flies through a pocket, and another is at hand."""
    return Scene([Circle(0, 0, vx=1), Circle(40, 0)], pockets=[Pocket(9, 0, 1)], **settings)


def an_entry_left_out() -> Told:
    """A centre enters a pocket on the way, and nobody says so."""
    cert = told(into_a_hole(), events=1)
    cert["instants"] = [part for part in cert["instants"] if "enter" not in part]
    return cert


def an_entry_twice() -> Told:
    """One entry is told twice."""
    cert = told(into_a_hole(), events=1)
    cert["instants"][1]["enter"] *= 2
    return cert


def no_entry_on_the_way_back() -> Told:
    """On the way back the centre enters the pocket again; it is left out."""
    cert = told(into_a_hole(reverse_at=20))
    cert["instants"].pop()
    return cert


def captured_and_yet_struck() -> Told:
    """A captured circle meets another later on."""
    cert = told(into_a_hole(), events=1)
    cert["scene"]["capture"] = True
    return cert


# -- ends and numbers


def quiet_too_soon() -> Told:
    """Nothing happens any more, but for a meeting in a million years."""
    cert = told(Scene([Circle(0, 0, vx="1/10**9"), Circle(10**9, 0)]))
    cert["instants"], cert["end"] = cert["instants"][:1], {"reason": "quiet"}
    cert["final"] = {"time": "0", "circles": [["0", "0", "0.000000001", "0"], ["1000000000", "0", "0", "0"]]}
    return cert


def quiet_before_the_reversal() -> Told:
    """Nothing happens any more, but for a reversal at a set time."""
    cert = told(Scene([Circle(0, 0, vx=1), Circle(-9, 0)], reverse_at=5), until=1)
    cert["end"] = {"reason": "quiet"}
    return cert


def ended(**values: Any) -> Told:
    """One meeting, ended otherwise."""
    cert = told(Scene([Circle(0, 0, vx=1), Circle(9, 0), Circle(20, 0)]), events=1)
    cert["end"] = values
    return cert


def numbers(circle: int, **values: str) -> Told:
    """One meeting, with other numbers of one circle."""
    cert = told(Scene([Circle(0, 0, vx=1), Circle(9, 0), Circle(20, 50)]), events=1)
    cert["scene"]["circles"][circle] |= values
    return cert


def few_bits() -> Told:
    """Bits so few that no interval tells anything."""
    return {**told(lee()), "bits": 1}


def roots(*texts: str, y: str) -> Told:
    """A place that looks like that of a graze: of sums of roots that coincide, or nearly do."""
    cert = told(Scene([Circle(0, 0, vx=1), Circle(9, 2), Circle(40, 0)]), events=1)
    cert["roots"] = list(texts)
    cert["scene"]["circles"][1]["y"] = y
    return cert


NEAR_ROOT_2 = "665857/470832"
FORGERIES: dict[str, Callable[[], Told]] = {
    **{f"a flaw in {key} of {i}": lambda i=i, key=key: copies_of_which_one_is_flawed(key, i)
       for key, i in (("x", 4), ("y", 1), ("r", 5), ("w", 3), ("vx", 0), ("x", 2), ("vy", 3))},
    "nearly abreast, closing": lambda: nearly_abreast("closing"),
    "nearly abreast, speed": lambda: nearly_abreast("speed"),
    **{f"a near graze, {how}": lambda how=how: a_near_graze("-", how) for how in (0, "back")},
    "one contact pushes": lambda: other_rounds([[0, 1]]),
    "one after the other": lambda: other_rounds([[0, 1]], [[1, 2]]),
    "one pushes twice": lambda: other_rounds([[0, 1], [0, 1]]),
    "both, and again": lambda: other_rounds([[0, 1], [1, 2]], [[0, 1]]),
    "no rounds": other_rounds,
    "a round of none": lambda: other_rounds([]),
    "a contact that is none pushes": lambda: other_rounds([[0, 1], [1, 2], [0, 2]]),
    "one from behind": lambda: other_rounds([[1, 0], [1, 2]]),
    "two events of one": lambda: ended(reason="events", limit=2),
    "quiet, and it is not": lambda: ended(reason="quiet"),
    "the return of nothing": lambda: ended(reason="return"),
    "a horizon beyond": lambda: ended(reason="horizon", until="1000"),
    "a horizon before": lambda: ended(reason="horizon", until="1"),
    "a horizon of minus one": lambda: ended(reason="horizon", until="-1"),
    "a negative radius": lambda: numbers(0, r="-1"),
    "two negative radii": lambda: numbers(2, r="-1-1"),
    "a mass below zero": lambda: numbers(1, w="-1"),
    "a mass of no weight": lambda: numbers(1, w="1-1"),
    "infinitely heavy, and moves": lambda: numbers(0, w="0"),
    "a circle as large as the world": lambda: numbers(2, r="9" * 300),
    "a place out of all bounds": lambda: numbers(1, x="9" * 300),
    "a mass out of all bounds": lambda: numbers(1, w="9" * 300),
    "a speed out of all bounds": lambda: numbers(2, vy="-" + "9" * 300),
    "a denominator out of all bounds": lambda: numbers(1, x="9+1/" + "9" * 100_001),
    "a root that is nearly there": lambda: roots("2", y=f"2+1*r1-{NEAR_ROOT_2}"),
    "roots that coincide, and a hair": lambda: roots("2", "8", y=f"2+1*r2-2*r1+{TINY}"),
    "roots of roots, and a hair": lambda: roots("2", "3+2*r1", y=f"1+1*r2-1*r1+{TINY}"),
    **{made.__name__: made for made in (
        pasts_of_unequal_length, a_map_of_fewer_circles_than_the_past_has, a_mirror_that_maps_both_to_themselves,
        a_tie_with_itself, two_instants_at_one_time, a_tied_contact_left_out, a_slide_that_is_none,
        a_turn_for_a_mirror, a_graze_for_a_hit, a_hit_for_a_graze, a_graze_among_impulses, another_final_state,
        back_after_rounds_that_do_not_go_back, an_entry_left_out, an_entry_twice, no_entry_on_the_way_back,
        captured_and_yet_struck, quiet_too_soon, quiet_before_the_reversal, few_bits,
    )},
}  # fmt: skip


@pytest.mark.parametrize("name", FORGERIES)
def test_a_forgery_is_refused_by_both(name: str, tmp_path: Path) -> None:
    refused_by_both(FORGERIES[name](), tmp_path / "forged.json")


@pytest.mark.parametrize("how", [0, "back"])
def test_a_near_miss_that_is_said_to_graze_is_not_refuted(how: str | int, tmp_path: Path) -> None:
    """The history is true, and the witness of no use: a checker that tells the miss at these bits verifies it."""
    path = tmp_path / "near.json"
    path.write_text(certificate_json(a_near_graze("+", how)), encoding="utf-8")
    assert by_python(path)[0] == 4
    assert NODE is None or by_node([path])[0][0] in (0, 4)
