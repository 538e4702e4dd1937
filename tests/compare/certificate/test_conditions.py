"""Conditions of the checker, one by one: a forgery that a checker without it would verify, and that both refuse."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from certificate.checkers import TOOLS
from certificate.forging import SAME, TINY, Told, refused_by_both, told
from certificate.test_loopholes import (
    an_entry_hidden_by_the_leaving,
    nothing_told_up_to_a_horizon,
)
from truebreak.compare.certificate import certificate_json
from truebreak.scenarios import Circle, Pocket, Scene, Wall

SOURCE = (TOOLS / "verify.py").read_text(encoding="utf-8")
PAIR = [Circle(0, 0, vx=1), Circle(9, 0)]


def lax(condition: str, instead: str) -> Any:
    """The first checker with one condition replaced."""
    assert SOURCE.count(condition) == 1, condition
    module = ModuleType("lax")
    exec(compile(SOURCE.replace(condition, instead), "lax", "exec"), module.__dict__)
    return module


def completed(cert: Told, checker: Any) -> Told:
    """A certificate with the times and the final state that a checker would have."""
    values: list[str] = []

    class Telling(checker.Checker):
        def said(self, value: Any, text: str) -> None:
            nearest = (2 * value.m * 10**12 + (1 << checker.Ball.bits)) >> (checker.Ball.bits + 1)
            values.append(f"{'-' if nearest < 0 else ''}{abs(nearest) // 10**12}.{abs(nearest) % 10**12:012d}")

    Telling(cert, 1).check()
    told_values = iter(values)
    for entry in cert["instants"]:
        entry["time"] = next(told_values)
    circles = len(cert["scene"]["circles"])
    time = next(told_values)
    cert["final"] = {"time": time, "circles": [[next(told_values) for _ in range(4)] for _ in range(circles)]}
    return cert


def of(scene: Scene, *instants: Told, end: Told | None = None, **values: Any) -> Told:
    """A scene's certificate with other instants after time 0, another end and other values of the scene."""
    cert = told(scene)
    if instants:
        cert["instants"][1:] = [{"time": "0", **instant} for instant in instants]
    cert["end"] = end or cert["end"]
    cert["scene"] |= values
    return cert


def into_two_points() -> Told:
    """A disc that touches two points, of which the one alone pushes: with both, the other would pull."""
    points = [Circle(x, y, r=0, point=True, m="oo") for x, y in ((10, 0), (8, 6))]
    cert = of(Scene([Circle(0, 0, r=10, vx=1, vy="-1/2"), *points]))
    assert [[push[:2] for push in one] for one in cert["instants"][0]["rounds"]] == [[[0, 1]]]
    cert["instants"][0]["rounds"] = [[[0, 1], [0, 2]]]
    return cert


def held_to_a_floor() -> Told:
    """A disc flies into a floor, by very little; that it is mapped to itself is no sign that it does not."""
    cert = told(Scene([Circle(0, 0, vx=1)], [Wall(0, -1, 1, -1)]))
    cert["scene"]["circles"][0]["vy"] = f"-{TINY}"
    cert["isometries"] = [{**SAME, "map": [[0, 0]]}]
    cert["instants"][0]["zeros"] = [["closing", [0, 1], 0]]
    return cert


def nearly_turned() -> Told:
    """Two that touch, the one's velocity the other's turned by very little: no shift maps the one to the other."""
    cert = told(Scene([Circle(0, 0, vx=1), Circle(0, 2, vx=1)]))
    large = 10**70
    a, b = f"{large * large - 1}/{large * large + 1}", f"{2 * large}/{large * large + 1}"
    cert["scene"]["circles"][1] |= {"vx": a, "vy": f"-{b}"}
    cert["isometries"] = [{"matrix": [a, b, f"-{b}", a], "shift": ["0", "2"], "map": [[0, 1]]}]
    cert["instants"][0]["zeros"] = [["closing", [0, 1], 0], ["speed", [0, 1], 0]]
    cert["end"] = {"reason": "stopped"}
    return cert


def touching_again() -> Told:
    """Two that touch all the time are said to come to it when another strikes."""
    cert = told(Scene([*PAIR, Circle(11, 0)]))
    cert["instants"][1]["met"].append([1, 2])
    return cert


def taken_and_yet_there() -> Told:
    """What a pocket has taken is met by another later on."""
    scene = Scene([Circle(0, 0, vx=1), Circle(-9, 0, vx=1)], pockets=[Pocket(9, 0, 1)], capture=True)
    entry = {"met": [[0, -1]], "enter": [[0, -1]]}
    return of(scene, entry, {"met": [[0, 1]], "rounds": [[[0, 1]]]}, end={"reason": "stopped"})


def through_each_other() -> Told:
    """Two meet and are reversed at once: on the way back they meet again, which is not told."""
    cert = told(Scene(PAIR, reverse_after=1))
    del cert["instants"][2]["rounds"]
    return cert


STOPPED = {"reason": "stopped"}
MEET = {"met": [[0, 1]], "rounds": [[[0, 1]]]}
TURN = ({"exact": "12"}, {"turn": True})
CONDITIONS: dict[str, tuple[str, str, Callable[[], Told]]] = {
    "there is an instant": (' or not told["instants"]', "", nothing_told_up_to_a_horizon),
    "a pocket is left by what was in it": (
        "if age and self.met[c] > 0: self.clear(c, last=True)", "pass", an_entry_hidden_by_the_leaving,
    ),
    "what lasts does not come again": (" - self.lasting.keys()", "", touching_again),
    "flights end at the reversal": (
        "if turn: self.settle(self.movable)", "pass", lambda: of(Scene(PAIR, reverse_at=12), *TURN, end=STOPPED),
    ),
    "flights end where they are taken": (
        "            self.settle(taken)\n", "",
        lambda: of(
            Scene(PAIR, pockets=[Pocket(30, 0, 1)], capture=True), {"met": [[0, -1]], "enter": [[0, -1]]}, end=STOPPED
        ),
    ),
    "the reversal comes when it is due": (
        "due != turn or ", "", lambda: of(Scene([*PAIR, Circle(20, 0)]), reverse_after=1),
    ),
    "nothing comes after the last event": (
        " or self.count == self.last:", ":",
        lambda: of(
            Scene(PAIR, pockets=[Pocket(30, 0, 1)]), MEET, {"met": [[1, -1]], "enter": [[1, -1]]},
            end={"reason": "events", "limit": 1},
        ),
    ),
    "no instant is after the set time": ("if sign < 0: raise", "if 0: raise", lambda: of(
        Scene(PAIR), MEET, end=STOPPED, reverse_at="5")),
    "no end is before the set time": (
        'if reason not in ("events", "stopped") and', "if reason == 0 and", lambda: of(Scene(PAIR), reverse_at="50"),
    ),
    "signs turn with the velocities": (
        "{c: -sign for c, sign in self.known.items()} if turn", "dict(self.known) if turn", through_each_other,
    ),
    "impulses push": ("for impulse in balls:", "for impulse in ():", into_two_points),
    "impulses turn the closing speed round": (
        "if s and any(self.form.rest[c] for c in push):", "if 0:",
        lambda: of(Scene(PAIR), {"exact": "7", "met": [[0, 1]], "rounds": [[[0, 1, "2"]]]}),
    ),
    "one after the other is one after the other": (
        'if self.policy != "simultaneous":', "if 0:",
        lambda: of(Scene([Circle(-3, 0, vx=1), Circle(0, 0), Circle(3, 0, vx=-1)]), tie_policy="sequential"),
    ),
    "only the mirror holds to a wall": (
        "return not (a * nx + b * ny + nx or d * nx + e * ny + ny) and", "return", held_to_a_floor,
    ),
    "only a shift holds two together": (" and not any((a - ONE, b, d, e - ONE))", "", nearly_turned),
    "what is taken is met no more": (
        "if not taken & {*c}}\n        self.known", "if c[1] >= 0 or not taken & {*c}}\n        self.known",
        taken_and_yet_there,
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", CONDITIONS)
def test_no_condition_is_idle(name: str, tmp_path: Path) -> None:
    condition, instead, forged = CONDITIONS[name]
    checker = lax(condition, instead)
    cert = completed(forged(), checker)
    path = tmp_path / "lax.json"
    path.write_text(certificate_json(cert), encoding="utf-8")
    code, sentence = checker.verdict(path)
    assert code == 0, sentence
    refused_by_both(cert, tmp_path / "forged.json")
