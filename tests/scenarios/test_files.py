"""Scene files: read and written exactly."""

from __future__ import annotations

import json
from fractions import Fraction
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from truebreak.scenarios import Circle, Pocket, Quantity, Scene, SceneError, Wall
from truebreak.scenarios.files import dump_json, dump_toml, load_scene, loads_json, loads_toml, save_scene

BALL = '[[circle]]\nid = "a"\nx = 0\ny = 0\nr = 1\n'
DUMPS = {".toml": dump_toml, ".json": dump_json}
LOADS = {".toml": loads_toml, ".json": loads_json}


def toml_refusal(text: str) -> str:
    with pytest.raises(SceneError) as error:
        loads_toml(text, "x.toml")
    return str(error.value)


def json_refusal(text: str) -> str:
    with pytest.raises(SceneError) as error:
        loads_json(text, "x.json")
    return str(error.value)


# -- what a file says


def test_a_file_says_what_its_keys_say() -> None:
    scene = loads_toml(
        """
        name = "lee"
        tie_policy = "sequential:seed=3"
        reverse_at = "sqrt(2)"
        until = 12.5
        events = 100
        capture = true

        [[circle]]
        id = "left"
        x = "-3"
        y = 0.1
        r = 1e-3
        vx = "sqrt(3)/2"
        m = "9/4"

        [[circle]]
        id = "peg"
        x = 4
        y = -1_000
        r = 2
        m = "oo"

        [[wall]]
        id = "floor"
        x0 = 0
        y0 = "-21/2"
        x1 = 1
        y1 = "-21/2"

        [[pocket]]
        id = "hole"
        x = 9
        y = 9
        r = 1
        """
    )
    left, peg = scene.circles
    assert (left.y, left.r, left.vx, left.vy) == (
        Fraction(1, 10),
        Fraction(1, 1000),
        Quantity.of("sqrt(3)/2"),
        0,
    )
    assert peg.fixed
    assert peg.y == -1000
    assert scene.until == Fraction(25, 2)
    assert scene.reverse_at == Quantity.of("sqrt(2)")
    assert (scene.name, str(scene.tie_policy), scene.events, scene.capture) == (
        "lee",
        "sequential:seed=3",
        100,
        True,
    )
    assert scene.walls[0].y0 == Fraction(-21, 2)
    assert scene.pockets[0].id == "hole"


@pytest.mark.parametrize("text", ["0.1", "1e-40", "123456789.123456789123", "-0.3000000000000004", "5E+3"])
def test_a_bare_decimal_is_the_decimal_that_it_spells(text: str) -> None:
    value = Quantity.of(text)
    assert loads_toml(BALL + f"vx = {text}").circles[0].vx == value
    row = f'{{"id": "a", "x": 0, "y": 0, "r": 1, "vx": {text}}}'
    assert loads_json(f'{{"circle": [{row}]}}').circles[0].vx == value


def test_mass_and_velocity_have_defaults() -> None:
    (circle,) = loads_toml(BALL).circles
    assert (circle.vx, circle.vy, circle.m, circle.point) == (0, 0, 1, False)


def test_a_byte_order_mark_is_passed_over(tmp_path: Path) -> None:
    path = tmp_path / "x.toml"
    path.write_bytes(b"\xef\xbb\xbf" + BALL.encode())
    assert load_scene(path).ids == ("a",)


# -- there and back


@st.composite
def numbers(draw: st.DrawFn) -> str:
    p, q = draw(st.integers(-(10**20), 10**20)), draw(st.integers(1, 10**6))
    s = draw(st.integers(2, 50))
    forms = ["{p}/{q}", "{p}", "sqrt({s})*({p}/{q})", "{p} - (sqrt({s}) - {q})", "{q} + ({p} + sqrt({s}))"]
    form = draw(st.sampled_from([*forms, "sqrt(2 + sqrt({s}))/({p} - sqrt({q}*{q} + 1)) - -sqrt({s})"]))
    return form.format(p=p, q=q, s=s)


TEXTS = st.text(st.characters(exclude_categories=["Cs"]), max_size=20)
IDS = st.text(st.characters(exclude_categories=["Cs"]), min_size=1, max_size=12).filter(str.isprintable)


@st.composite
def scenes(draw: st.DrawFn) -> Scene:
    ids = draw(st.lists(IDS, min_size=4, max_size=4, unique=True))
    step = 10**60
    circles = [
        Circle(
            Quantity.of(draw(numbers())) + step * k,
            draw(numbers()),
            r=draw(st.sampled_from(["1/3", "sqrt(2)", 5])),
            vx=draw(numbers()),
            vy=draw(numbers()),
            m=draw(st.sampled_from(["1/7", 1000, "sqrt(5)"])),
            id=ids[k],
        )
        for k in range(2)
    ]
    point = Circle(-step, 0, r=0, m="oo", point=True, id=ids[2])
    time = st.one_of(st.none(), st.sampled_from(["1/3", "sqrt(7)", 9]))
    return Scene(
        [*circles, point],
        [Wall(0, -step, draw(st.sampled_from([1, "sqrt(2)"])), -step, id=ids[3])],
        name=draw(TEXTS.filter(bool)),
        tie_policy=draw(st.sampled_from(["simultaneous", "sequential", "sequential:seed=12"])),
        reverse_at=draw(time),
        until=draw(time),
        events=draw(st.one_of(st.none(), st.integers(1, 10**9))),
        pockets=[Pocket(0, "1/2", "sqrt(2)", id="hole \N{SNOWMAN}")] if "hole \N{SNOWMAN}" not in ids else (),
        capture=draw(st.booleans()),
        description=draw(TEXTS),
        source=draw(TEXTS),
    )


@given(scenes(), st.sampled_from([".toml", ".json"]))
def test_a_scene_survives_writing_and_reading(scene: Scene, suffix: str) -> None:
    text = DUMPS[suffix](scene)
    again = LOADS[suffix](text)
    assert again == scene
    assert again.digest == scene.digest
    assert DUMPS[suffix](again) == text


@pytest.mark.parametrize("suffix", [".toml", ".json"])
def test_a_saved_scene_is_loaded_the_same(suffix: str, tmp_path: Path) -> None:
    scene = Scene([Circle("sqrt(2)", 0, id='"\\ #')], name='a "b"\n\x7f\x00\u2028')
    path = tmp_path / f"scene{suffix}"
    save_scene(scene, path)
    assert load_scene(path) == scene
    save_scene(scene.with_changes(name="other"), str(path))
    assert load_scene(str(path)).name == "other"
    assert [file.name for file in tmp_path.iterdir()] == [path.name]


def test_a_scene_that_cannot_be_written_leaves_the_old_file(tmp_path: Path) -> None:
    path = tmp_path / "x.toml"
    save_scene(Scene([Circle(0, 0)]), path)
    before = path.read_bytes()
    long = Quantity.of(10) ** 20_000
    with pytest.raises(SceneError, match=r"circle 'c1': x = .* too long for one number; .* cannot hold it"):
        save_scene(Scene([Circle(long, 0)]), path)
    assert path.read_bytes() == before
    with pytest.raises(SceneError, match=r"ends in \.toml or \.json, not in '\.txt'"):
        save_scene(Scene([Circle(0, 0)]), tmp_path / "x.txt")
    with pytest.raises(SceneError, match="cannot be written: No such file or directory"):
        save_scene(Scene([Circle(0, 0)]), tmp_path / "none" / "x.toml")
    assert [file.name for file in tmp_path.iterdir()] == ["x.toml"]


def test_half_a_surrogate_pair_is_refused() -> None:
    assert "half a surrogate pair" in json_refusal('{"name": "\\ud800", "circle": []}')
    with pytest.raises(SceneError, match="half a surrogate pair"):
        dump_toml(Scene([Circle(0, 0)], source="\ud800"))


def test_json_holds_every_number_as_text() -> None:
    (row,) = json.loads(dump_json(Scene([Circle(0, "1/3", vx="sqrt(2)")])))["circle"]
    assert row == {"id": "c1", "x": "0", "y": "1/3", "r": "1", "vx": "sqrt(2)", "vy": "0", "m": "1"}
