"""A run that is saved, or pickled, is had again: the same events, proofs and states, and any digit of any number."""

from __future__ import annotations

import json
import pickle
import random
from pathlib import Path
from typing import Any

import pytest
from command_line import interrupted, said
from ended import ended_at, unlike_twins
from flint import arb

import truebreak as tb
from truebreak.compare import comparison_json, engine, trajectory_json
from truebreak.compare.files.saved import run_of, saved_run
from truebreak.exact import ExactEngine
from truebreak.exact.numbers import ball
from truebreak.exact.numbers.ball import from_parts, parts_of
from truebreak.exact.replay.state import Flip, Go, Take
from truebreak.scenarios import Circle, Pocket, Quantity, Scene, SceneError, StopReason, Trajectory, Wall, catalogue
from truebreak.scenarios.disk import digest
from truebreak.scenarios.files import loads_json

BOX = (Wall(0, 0, 0, 1), Wall(9, 0, 9, 1), Wall(0, 0, 1, 0), Wall(0, 7, 1, 7))


MANY_ROOTS = Scene(
    [
        Circle(3, 3, vx="sqrt(2)"),
        Circle(8, 3, m="sqrt(3)"),
        Circle(5, 6, vx="-sqrt(11)", vy="sqrt(13)", m="sqrt(5) + sqrt(7)"),
    ],
    BOX,
)


def roots() -> Trajectory:
    """Numbers in a field of roots, nested ones among them."""
    nested = Quantity.of("sqrt(2 + sqrt(3)) + sqrt(5)")
    circles = [Circle(0, 0, vx="sqrt(2)"), Circle("3 + sqrt(3)", 0), Circle(20, nested, vx=-1)]
    return ExactEngine().run(Scene(circles, [Wall(9, 0, 9, 1)]), until="sqrt(7)*3")


def pocketed() -> Trajectory:
    """Captures at a meeting and at a rim, and a reversal at a set time with roots."""
    circles = [Circle(2, 2, r="1/2", vx=1, id="a"), Circle(5, "9/4", r="1/2", vx="1/7", vy=1, id="b")]
    return ExactEngine().run(
        Scene(circles, BOX, pockets=[Pocket(7, 2, 1, id="p")], capture=True, reverse_at="2*sqrt(2)"), until=20
    )


def assumed() -> Trajectory:
    """Rests on a zero that is not proved."""
    twins = loads_json(json.dumps(unlike_twins(5)))
    return ExactEngine(ties="assume:200", work=2000).run(twins)


def undecided() -> Trajectory:
    return ExactEngine(work=2000).run(loads_json(json.dumps(unlike_twins(5))))


def named(name: str, **limits: Any) -> Trajectory:
    return ExactEngine().run(catalogue.build(name), **limits)


RUNS = {
    "gas": lambda: named("gas:n=4", events=40),
    "long numbers": lambda: named("gas:n=3", events=700),
    "there and back": lambda: named("reversal"),
    "rack": lambda: named("rack:rows=2", events=12),
    "cradle": lambda: named("cradle:n=3", until=4),
    "point": lambda: named("point", events=6),
    "grazing": lambda: named("grazing"),
    "nothing happens": lambda: ExactEngine().run(Scene([Circle(0, 0, vx=1)]), until="sqrt(2)"),
    "quiet at once": lambda: ExactEngine().run(Scene([Circle(0, 0, vx=1)])),
    "random orders": lambda: ExactEngine().run(
        catalogue.build("rack:rows=2").with_changes(tie_policy="sequential:seed=3"), events=8
    ),
    "roots": roots,
    "many roots": lambda: ExactEngine().run(MANY_ROOTS, events=30),
    "pocketed": pocketed,
    "assumed": assumed,
    "undecided": undecided,
}


def test_the_runs_are_what_they_are_for() -> None:
    """Every kind of step, stop and number is among them."""
    numbers = {type(k[1]).__name__ for name in ("gas", "roots") for row in RUNS[name]().motion.knots for k in row}  # type: ignore[attr-defined]
    assert numbers == {"fmpq", "Element", "arb"}
    steps = pocketed().motion.log.steps  # type: ignore[attr-defined]
    assert {Flip, Take} <= {type(step) for step in steps}
    assert any(isinstance(step, Go) and isinstance(step.source, Quantity) for step in steps)
    assert not assumed().certified
    assert undecided().stop.reason is StopReason.UNDECIDED
    assert pocketed().pocketings
    assert RUNS["there and back"]().motion.returned  # type: ignore[attr-defined]


@pytest.mark.parametrize("way", ["file", "pickle"])
@pytest.mark.parametrize("kind", RUNS)
def test_a_run_is_had_again(kind: str, way: str) -> None:
    run = RUNS[kind]()
    text = saved_run(run)
    again: Trajectory = run_of(text) if way == "file" else pickle.loads(pickle.dumps(run))
    exact = len(run.events) <= 50
    assert json.dumps(trajectory_json(again, exact=exact)) == json.dumps(trajectory_json(run, exact=exact))
    assert saved_run(again) == text
    assert again.scene.data() == run.scene.data()
    for mine, its in zip(run.events[-2:], again.events[-2:], strict=True):
        assert its.time.digits(300) == mine.time.digits(300)
        assert [c.x.digits(60) for c in again.at(its.time).circles] == [
            c.x.digits(60) for c in run.at(mine.time).circles
        ]
    end = float(run.final_time)
    times = [end * k / 7 for k in range(7)]
    assert (again.sample(times) == run.sample(times)).all()
    with pytest.raises(ValueError, match="after the end"):
        again.at(Quantity.of(end) + 1)


def test_what_is_known_comes_from_the_log() -> None:
    """The digits of a loaded run are those that its scene and log give, whatever numbers are at hand beside them."""
    run = RUNS["gas"]()
    data = json.loads(saved_run(run))
    data["events"] = [[[*when[:3], []], *rest] for when, *rest in data["events"]]
    bare = run_of(resealed(data))
    assert [e.time.digits(200) for e in bare.events] == [e.time.digits(200) for e in run.events]


def test_a_normal_form_too_long_to_be_read_is_kept_as_a_ball(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its exact value is then the log's."""
    run = roots()
    monkeypatch.setattr("truebreak.compare.files.codec.MAX_LENGTH", 5)
    again = run_of(saved_run(run))
    assert isinstance(again.events[1].time.near, arb)  # type: ignore[attr-defined]
    assert trajectory_json(again, exact=True) == trajectory_json(run, exact=True)
    assert [e.time.digits(200) for e in again.events] == [e.time.digits(200) for e in run.events]


def resealed(data: dict[str, Any]) -> str:
    """The text of a file whose contents were changed, with the digest that belongs to them."""
    data.pop("digest", None)
    return json.dumps({**data, "digest": digest(data)})


@pytest.mark.parametrize("name", ["double", "interval", "pymunk", "sympy"])
def test_the_runs_of_every_engine_pickle(name: str) -> None:
    run = engine(name).run(catalogue.build("tennis"), events=2)
    assert trajectory_json(pickle.loads(pickle.dumps(run))) == trajectory_json(run)


@pytest.mark.parametrize("scene", ["gas:n=4", "rack:rows=2", "near-tie:k=40"])
def test_comparisons_pickle(scene: str) -> None:
    found = tb.comparison(tb.scene(scene), ["double", "interval", "pymunk"], until=6)
    again = pickle.loads(pickle.dumps(found))
    assert comparison_json(again) == comparison_json(found)
    assert [e.time.digits(100) for e in again.reference.events] == [e.time.digits(100) for e in found.reference.events]


def test_balls_are_kept_bit_for_bit() -> None:
    draw = random.Random(5)
    for _ in range(2000):
        middle = draw.getrandbits(draw.choice((1, 60, 400))) * draw.choice((1, -1)), draw.randint(-3000, 3000)
        radius = draw.getrandbits(draw.choice((1, 5, 30, 60))), draw.randint(-500, 300)
        number = arb(middle, radius)
        with ball.precision(draw.choice((53, 1000))):
            assert parts_of(from_parts(*parts_of(number))) == parts_of(number)
            assert parts_of(pickle.loads(pickle.dumps(number))) == parts_of(number)
    assert parts_of(from_parts(*parts_of(arb.nan()))) == ()


def test_only_what_can_be_had_again_is_saved(tmp_path: Path) -> None:
    """The other engines have no log; a limit whose text is longer than a number may be is not read."""
    file = tmp_path / "run.json"
    scene = catalogue.build("lee")
    with pytest.raises(SceneError, match="only runs of the exact engine"):
        tb.save_run(tb.run(scene, "double"), file)
    with pytest.raises(SceneError, match="too long for one number"):
        tb.save_run(tb.run(scene, until=10**30000), file)
    assert list(tmp_path.iterdir()) == []
    tb.save_run(tb.run(scene), file)
    assert tb.load_run(file).final["left"].x.text() == tb.run(scene).final["left"].x.text()


# -- the command line


def test_a_run_is_saved_beside_what_it_prints(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    file = tmp_path / "run.json"
    words = ("run", "gas:n=4", "--events", "20", "--json", "--exact")
    plain = said(capsys, *words)
    assert said(capsys, *words, "--save", str(file)) == plain
    assert list(tmp_path.iterdir()) == [file]
    assert trajectory_json(tb.load_run(file), exact=True) == json.loads(plain[1])
    assert tb.load_run(str(file)).events[7].time.digits(90) == named("gas:n=4", events=20).events[7].time.digits(90)


def test_ctrl_c_keeps_what_was_done(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Interrupted at any step: the file holds the whole instants up to there."""
    whole = named("rack:rows=2", events=12)
    with ended_at(0, True, KeyboardInterrupt(), monkeypatch) as counted:
        named("rack:rows=2", events=12)
    file = tmp_path / "run.json"
    for k in range(1, counted[0] + 1, 5):
        with ended_at(k, k % 2 == 0, KeyboardInterrupt(), monkeypatch):
            code, out, _ = said(capsys, "run", "rack:rows=2", "--events", "12", "--json", "--save", str(file))
        kept = tb.load_run(file)
        assert (code, kept.stop.reason) == (130, StopReason.INTERRUPTED)
        assert trajectory_json(kept) == json.loads(out)
        assert [e.time.digits(50) for e in kept.events] == [e.time.digits(50) for e in whole.events[: len(kept.events)]]


def test_ctrl_c_from_outside_keeps_what_was_done(tmp_path: Path) -> None:
    file = tmp_path / "run.json"
    code, out, err = interrupted("run", "gas", "--events", "10000000", "--json", "--save", str(file))
    assert (code, err) == (130, "")
    assert trajectory_json(tb.load_run(file)) == json.loads(out)
    assert list(tmp_path.iterdir()) == [file]


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--engine", "double"], "only runs of the exact engine are saved"),
        (["--save", "no/such/folder/run.json"], "there is no folder"),
        (["--save", "."], "is a folder"),
    ],
)
def test_what_cannot_be_saved_is_refused_before_the_run(
    words: list[str], told: str, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    file = tmp_path / "run.json"
    code, out, err = said(capsys, "run", "gas", "--events", "10000000", "--save", str(file), *words)
    assert (code, out, err.count("\n"), file.exists()) == (2, "", 1, False)
    assert told in err


# -- files that are none


def refused(path: Path) -> str:
    """What is said of a file; one line that names it."""
    with pytest.raises(SceneError) as error:
        tb.load_run(path)
    told = str(error.value)
    assert "\n" not in told
    assert path.name in told
    return told


def test_a_file_that_is_none_is_told(tmp_path: Path) -> None:
    file = tmp_path / "x.json"
    assert "no such file" in refused(file)
    assert "is a directory; give the path of a saved run" in refused(tmp_path)
    for content in (b"", b"\xff\x00", b"[]", b"{}", b"nonsense", b"[" * 10**6, b'{"schema": "truebreak/trajectory-1"}'):
        file.write_bytes(content)
        assert "is not a saved run" in refused(file)


def test_another_version_is_told(tmp_path: Path) -> None:
    data = json.loads(saved_run(roots()))
    file = tmp_path / "x.json"
    for version in ("0.0.1", None, 3, "9" * 5000):
        file.write_text(resealed({**data, "version": version}), encoding="utf-8")
        told = refused(file)
        assert f"and this is {tb.__version__}" in told
        assert len(told) < 500


def test_damage_is_told(tmp_path: Path) -> None:
    """A file cut off anywhere, or with any one character another, is refused."""
    text = saved_run(pocketed())
    file = tmp_path / "x.json"
    start = text.index('"engine"')
    for k in [*range(start, len(text) - 2, 41), len(text) - 3]:
        file.write_text(text[:k], encoding="utf-8")
        assert "is damaged" in refused(file)
        other = "7" if text[k] != "7" else "8"
        file.write_text(text[:k] + other + text[k + 1 :], encoding="utf-8")
        if text[k] not in "\n":
            assert "is damaged" in refused(file)


@pytest.mark.parametrize("wrong", [None, [["leap", 3]], {"a": 1}, "x"])
@pytest.mark.parametrize("key", ["scene", "steps", "events", "knots", "end", "stop"])
def test_contents_that_fit_no_run_are_told(key: str, wrong: object, tmp_path: Path) -> None:
    """Even with the digest that belongs to them."""
    file = tmp_path / "x.json"
    file.write_text(resealed({**json.loads(saved_run(pocketed())), key: wrong}), encoding="utf-8")
    assert "is damaged" in refused(file)
