"""`truebreak verify --scene`: the scene of a certificate is the one meant, number by number, or it is refuted."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from command_line import said

from certificate.samples import built
from truebreak.compare.certificate import certificate_json, certificate_of
from truebreak.compare.certificate.certified import difference
from truebreak.exact import ExactEngine
from truebreak.scenarios import Circle, Pocket, Scene, Wall

CIRCLES = [Circle(0, 0, vx=1, vy="sqrt(2)", id="a"), Circle(9, "sqrt(3)", m=2, id="b"), Circle(0, 9, m="oo", id="c")]
SETTINGS = {
    "walls": [Wall(50, 0, 50, 1, id="w")], "pockets": [Pocket(30, 0, 1, id="p")], "capture": True, "reverse_at": "7/2",
}  # fmt: skip


def scene(first: Circle = CIRCLES[0], second: Circle = CIRCLES[1], **settings: object) -> Scene:
    """A scene of all kinds of things, with some changes."""
    return Scene([first, second, CIRCLES[2]], **{**SETTINGS, **settings})  # type: ignore[arg-type]


BLOCK = certificate_of(ExactEngine().run(scene()))["scene"]
OTHERS: dict[str, tuple[Scene, str]] = {
    "a place": (scene(Circle(0, "1/10**50", vx=1, vy="sqrt(2)", id="a")), "circle 'a': y is 0, not "),
    "a root": (scene(Circle(0, 0, vx=1, vy="sqrt(5)/sqrt(2)", id="a")), "circle 'a': vy is 1*r1, not "),
    "a mass": (scene(second=Circle(9, "sqrt(3)", m="2000001/10**6", id="b")), "circle 'b': w is 1/2, and not one over"),
    "a name": (scene(second=Circle(9, "sqrt(3)", m=2, id="d")), "circle 'b' is not 'd'"),
    "a wall": (scene(walls=[Wall(50, 0, 50, 2, id="w")]), "wall 'w': y1 is 1, not 2"),
    "a wall less": (scene(walls=[]), "it has 1 walls, not 0"),
    "a pocket": (scene(pockets=[Pocket(30, 0, 2, id="p")]), "pocket 'p': r is 1, not 2"),
    "capture": (scene(capture=False), "capture is True, not False"),
    "a reversal": (scene(reverse_at="7/2 + 1/10**40"), "reverse_at is 7/2, not "),
    "no reversal": (scene(reverse_at=None), "reverse_at is 7/2, not None"),
    "another reversal": (scene(reverse_at=None, reverse_after=2), "reverse_after is None, not 2"),
    "a policy": (scene(tie_policy="sequential"), "its tie policy is simultaneous, not "),
}


def test_a_scene_is_its_own_however_its_numbers_are_written() -> None:
    assert difference(BLOCK, scene()) is None
    assert difference(BLOCK, scene(Circle("sqrt(8) - 2*sqrt(2)", 0, vx=1, vy="2/sqrt(2)", id="a"))) is None
    short = certificate_of(ExactEngine().run(Scene([Circle(0, 0)], tie_policy="sequential")))["scene"]
    assert difference({**short, "tie_policy": "sequential"}, Scene([Circle(0, 0)], tie_policy="sequential")) is None


@pytest.mark.parametrize("name", OTHERS)
def test_another_scene_is_told_from_it(name: str) -> None:
    other, words = OTHERS[name]
    assert (difference(BLOCK, other) or "").startswith(words)


def test_the_command_line_compares_and_says_so(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "lee.json"
    text = certificate_json(certificate_of(built("lee")))
    path.write_text(text, encoding="utf-8")
    code, out, _ = said(capsys, "verify", str(path))
    assert code == 0 and out.endswith("; no scene was given\n")
    code, out, _ = said(capsys, "verify", str(path), "--scene", "lee")
    assert code == 0 and out.startswith("verified: ") and out.endswith("; its scene is lee\n")
    code, out, _ = said(capsys, "verify", str(path), "--scene", "lee:tie=sequential")
    assert code == 1 and out.startswith("refuted: its scene is not lee:tie=sequential: its tie policy is simultaneous")
    moved = json.loads(text)
    moved["scene"]["circles"][2] |= {"y": "1000"}
    moved["scene"]["circles"][2]["id"] = "another"
    path.write_text(json.dumps(moved), encoding="utf-8")
    assert said(capsys, "verify", str(path), "--scene", "lee")[0] != 0
    code, out, err = said(capsys, "verify", str(path), "--scene", "lea")
    assert (code, out) == (2, "") and "lea" in err


def test_what_costs_too_much_is_declined(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "lee.json"
    path.write_text(certificate_json(certificate_of(built("lee"))), encoding="utf-8")
    code, out, _ = said(capsys, "verify", str(path), "--work", "1000")
    assert code == 4 and out == "declined: in the scene: costs more than 1000 units of work; --work=N\n"
