"""`truebreak judge` and `truebreak export`."""

from __future__ import annotations

import json
import re
from fractions import Fraction
from pathlib import Path

import jsonschema
import pytest
from command_line import said
from logs import lines_of, triples, without_limits, written

from truebreak.compare import compare
from truebreak.compare.foreign import LogEngine
from truebreak.compare.foreign import log_engine as log_module
from truebreak.compare.report.floats import floats_csv, floats_json
from truebreak.compare.report.schema import schema
from truebreak.floating import DoubleEngine, PymunkEngine
from truebreak.scenarios import Circle, Quantity, Scene, SceneError, Trajectory, Wall, catalogue
from truebreak.scenarios.files import loads_json


@pytest.fixture(scope="module")
def gas() -> Trajectory:
    return DoubleEngine().run(without_limits(catalogue.build("gas")), events=200)


@pytest.mark.parametrize("states", [True, False])
def test_a_log_is_judged_as_its_engine_is(states: bool, gas: Trajectory, tmp_path: Path) -> None:
    path = written(tmp_path / "log.jsonl", lines_of(gas, states=states))
    scene = gas.scene
    own = compare(scene, ["double"], events=180)["double"]
    mine = compare(scene, [LogEngine.of(path, scene, "mine")], events=180)["mine"]
    assert own.alignment.divergence == mine.alignment.divergence
    assert own.verdict == mine.verdict == "diverged"
    assert str(own.diagnosis) == str(mine.diagnosis)
    assert own.margin is not None
    assert mine.margin is not None
    assert own.margin.distance == mine.margin.distance
    if states:
        assert mine.margin.error == pytest.approx(own.margin.error, rel=1e-6)
        assert mine.separation.maximum == pytest.approx(own.separation.maximum, rel=1e-6)


def test_the_json_is_that_of_compare(gas: Trajectory, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = written(tmp_path / "log.jsonl", lines_of(gas))
    code, out, _ = said(capsys, "judge", "gas", path, "--events", "50", "--json")
    assert code == 0
    data = json.loads(out)
    jsonschema.Draft202012Validator(schema("comparison-5")).validate(data)
    assert data["verdict"] == "agree"
    assert data["candidates"][0]["engine"] == path


def test_csv_says_the_same(gas: Trajectory, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "log.csv"
    rows = [f"{time!r},{a},{b}" for time, a, b in triples(gas)]
    path.write_text("\n".join(["time,a,b", *rows]) + "\n", "utf-8")
    assert LogEngine.of(path, gas.scene).last.events == LogEngine.of(triples(gas), gas.scene).last.events
    code, out, _ = said(capsys, "judge", "gas", str(path), "--events", "180")
    assert code == 1
    assert "diverges at event 161" in " ".join(out.split())


def test_csv_has_states_and_an_end(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_text("time,a,b,xa,ya,vxa,vya,xb,yb,vxb,vyb\n4,c1,w1,3,0,-2,0,,,,\n9,,,,,,,,,,\n", "utf-8")
    scene = Scene([Circle(0, 0, vx=1)], [Wall(5, 0, 5, 1)])
    run = LogEngine.of(path, scene).last
    assert (run.final["c1"].vx, float(run.final_time), run.final["c1"].x) == (-2.0, 9.0, 3.0 - 2.0 * 5)


def test_as_far_as_the_log_goes_unless_asked_for_more(
    gas: Trajectory, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = written(tmp_path / "log.jsonl", [*lines_of(gas)[:40], {"end": float(gas.events[40].time) - 1e-3}])
    code, out, _ = said(capsys, "judge", "gas", path)
    assert code == 0
    assert "all 40 events" in out
    for far in (60, 150):
        _what_is_enough(far, path, gas, tmp_path, capsys)


def _what_is_enough(far: int, path: str, gas: Trajectory, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A log of 40 events is held against so many: how far it says to record settles it."""
    code, out, _ = said(capsys, "judge", "gas", path, "--events", str(far))
    assert code == 4
    end, enough = float(gas.events[40].time) - 1e-3, float(gas.events[far - 1].time)
    assert f"Not settled: these runs do not show whether {path} diverges from the exact run near its end" in " ".join(
        out.replace("\n", " ").split()
    )
    assert f"is known up to t = {end:.9g} only: record it farther" in " ".join(out.split())
    told = float(out.replace("\n", " ").split("(t = ")[1].split()[0])
    assert told > enough
    lines = [*lines_of(DoubleEngine().run(gas.scene, until=told)), {"end": told}]
    code, *_ = said(capsys, "judge", "gas", written(tmp_path / "more.jsonl", lines), "--events", str(far))
    assert code == 0, "what it says is enough is enough"


def test_a_quiet_scene_wants_the_word_of_the_log(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    lines = lines_of(DoubleEngine().run(catalogue.build("near-tie:k=4")))
    open_end = written(tmp_path / "open.jsonl", [*lines, {"end": 50}])
    quiet = written(tmp_path / "quiet.jsonl", [*lines, {"end": 50, "quiet": True}])
    code, out, _ = said(capsys, "judge", "near-tie:k=4", open_end, "--events", "20")
    assert code == 4
    assert "record it until nothing is left to happen, and say so at its end" in " ".join(out.split())
    assert said(capsys, "judge", "near-tie:k=4", open_end)[0] == 0
    code, out, _ = said(capsys, "judge", "near-tie:k=4", quiet)
    assert code == 0
    assert "for all time" in out


def test_two_logs_say_whether_a_change_changed_a_verdict(
    gas: Trajectory, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    lines = lines_of(gas)[:60]
    old = written(tmp_path / "old.jsonl", lines)
    same = written(tmp_path / "same.jsonl", [{**line, "time": line["time"] + 1e-12} for line in lines])
    dropped = written(tmp_path / "dropped.jsonl", lines[:30] + lines[31:])
    code, out, _ = said(capsys, "judge", "gas", old, same)
    assert code == 0
    assert "The change changed no verdict" in out
    assert "ends" not in out
    long, short = written(tmp_path / "long.jsonl", lines), written(tmp_path / "short.jsonl", lines[:20])
    told = f"up to time {lines[19]['time']:.9g}, where {short} ends"
    for logs in ((long, short), (short, long), (long, short, old)):
        code, out, _ = said(capsys, "judge", "gas", *logs)
        assert code == 0
        assert f"All logs are judged {told}; judge one by itself" in out.replace("\n", " ")
        code, out, _ = said(capsys, "judge", "gas", *logs, "--json")
        assert told in json.loads(out)["changes"][0]["sentence"]
    code, out, _ = said(capsys, "judge", "gas", long, short, "--events", "5")
    assert "All logs are judged" not in out
    code, out, _ = said(capsys, "judge", "gas", old, dropped, "--events", "50", "--json")
    assert code == 1
    data = json.loads(out)
    jsonschema.Draft202012Validator(schema("comparison-5")).validate(data)
    (change,) = data["changes"]
    assert change["verdict_changed"]
    assert change["divergence_changed"]
    assert "dropped.jsonl diverges at event" in change["sentence"]


@pytest.mark.parametrize("digits", [6, 9, 12])
def test_a_log_with_few_digits_says_so_and_keeps_the_law_in_them(
    digits: int, gas: Trajectory, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    lines = json.loads(
        json.dumps(lines_of(gas, states=True)[:12]), parse_float=lambda text: float(f"{float(text):.{digits}g}")
    )
    log = written(tmp_path / "few.jsonl", lines)
    code, out, _ = said(capsys, "judge", "gas", log)
    assert code == 1
    hint = re.search(rf"no place in it has more than {digits} digits: write 17, or judge it with --bits (\d+)", out)
    assert hint is not None, out
    code, out, _ = said(capsys, "judge", "gas", log, "--bits", hint[1])
    assert code == 0 and "no place in it" not in out


def test_a_log_of_steps_is_judged_with_its_step(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    run = PymunkEngine().run(catalogue.build("tennis"), until=20)
    path = written(tmp_path / "log.jsonl", lines_of(run, states=True))
    assert said(capsys, "judge", "tennis", path, "--step", "1/256", "--events", "3")[0] == 0


WRONG = [
    ('{"time": 1, "contact": ["c1", "c2"]', 'line 2: \'{"time": 1, "contact": ["c1", "c2"]\' is not a whole JSON'),
    ("[1, 2]", "line 2: '[1, 2]' is no object"),
    ('{"time": 0.1, "contact": ["c1", "c2"]}', "line 2: time = 0.1 comes before 0.5"),
    ('{"time": NaN, "contact": ["c1", "c2"]}', "line 2: time = nan; must be finite"),
    ('{"time": 1, "contact": ["c1", "zz"]}', "line 2: contacts has 'zz', which is not in the scene"),
    ('{"time": 1, "contact": ["c1"]}', "line 2: contact = ['c1']; must be two ids"),
    ('{"time": 1, "contacts": []}', "line 2: contacts = []; must be a list"),
    ('{"time": 1}', "line 2: has neither a contact nor states"),
    ('{"contact": ["c1", "c2"]}', "line 2: has no time"),
    ('{"time": 1, "contact": ["c1", "c2"], "sates": {}}', "line 2: has 'sates'; a line may have"),
    ('{"end": 0.2}', "line 2: time = 0.2 comes before 0.5"),
    ('{"end": 2, "contact": ["c1", "c2"]}', "line 2: an end is"),
    ('{"end": 2}\n{"time": 3, "contact": ["c1", "c2"]}', "line 3: comes after the end"),
    ('{"time": 1, "time": 2, "contact": ["c1", "c2"]}', "line 2: has 'time' twice; keep one"),
    ('{"time": 1, "states": {"c1": [0, 0, 0, 0], "c1": [1, 0, 0, 0]}}', "line 2: has 'c1' twice"),
    ("\udcff", "is not text in UTF-8"),
    ("9" * 5000, "is not a whole JSON object"),
    ("[" * 100_000, "is not a whole JSON object"),
]


@pytest.mark.parametrize(("line", "told"), WRONG, ids=[told[:40] for _, told in WRONG])
def test_a_log_that_cannot_be_judged_is_one_line(
    line: str, told: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "log.jsonl"
    path.write_bytes(f'{{"time": 0.5, "contact": ["c1", "c2"]}}\n{line}\n'.encode("utf-8", "surrogateescape"))
    code, out, err = said(capsys, "judge", "gas", str(path))
    assert (code, out) == (2, "")
    assert told in err
    assert err.startswith("truebreak: error: file ")
    assert err.count("\n") == 1


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("", "says nothing"),
        ("time,a\n", "does not name the columns"),
        ("time,a,b\n1,c1\n", "line 2: has 2 cells, and 3 columns"),
        ("time,a,b\nx,c1,c2\n", "line 2: time = 'x'; must be a number"),
        ("time,a,b\n1_0,c1,c2\n", "line 2: time = '1_0'; must be a number"),
        ("time,a,b\n1,c1,\n", "line 2: contacts has ''"),
    ],
)
def test_so_is_a_csv_log(text: str, told: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "log.csv"
    path.write_text(text, "utf-8")
    code, _, err = said(capsys, "judge", "gas", str(path))
    assert code == 2
    assert told in err


def test_a_log_too_long_or_missing_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "log.jsonl"
    path.write_text("x" * (log_module.MOST_LINE + 1), "utf-8")
    assert "is longer than 1,048,576 bytes" in said(capsys, "judge", "gas", str(path))[2]
    path.write_text('{"time": 0.5, "contact": ["c1", "c2"]}\n' * 100, "utf-8")
    monkeypatch.setattr(log_module, "MOST_BYTES", 1000)
    code, _, err = said(capsys, "judge", "gas", str(path))
    assert code == 2
    assert "log.jsonl': the log is longer than 1,000 bytes; judge its beginning" in err
    assert "No such file" in said(capsys, "judge", "gas", str(tmp_path / "none.jsonl"))[2]
    assert "--lacks: 'wnd' is no key" in said(capsys, "judge", "gas", str(path), "--lacks", "wnd")[2]


def test_export_gives_the_nearest_doubles_with_their_errors() -> None:
    scene = catalogue.build("inscribed:n=5")
    for row, circle in zip(floats_json(scene)["circles"], scene.circles, strict=True):
        for key in ("x", "y", "vx", "vy", "r"):
            exact: Quantity = getattr(circle, key)
            left = exact - Quantity.of(Fraction(row[key])) - Quantity.of(Fraction(row["error"][key]))
            assert row[key] == float(exact)
            assert abs(float(left)) <= 2.0**-52 * abs(row["error"][key])
    rows = floats_csv(scene).splitlines()
    assert len(rows) == len(scene.circles) + len(scene.walls)
    assert [float(cell) for cell in rows[0].split(",")[2:8]] == [
        float(getattr(scene.circles[0], key)) for key in ("x", "y", "r", "vx", "vy", "m")
    ]


def test_a_fixed_circle_has_no_mass_in_doubles() -> None:
    scene = catalogue.build("pinball")
    fixed = next(k for k, c in enumerate(scene.circles) if c.fixed)
    assert floats_json(scene)["circles"][fixed]["m"] is None
    assert floats_csv(scene).splitlines()[fixed].split(",")[7] == "inf"


def test_export_without_floats_is_the_scene(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    _, out, _ = said(capsys, "export", "inscribed:n=5")
    assert loads_json(out).digest == catalogue.build("inscribed:n=5").digest
    path = tmp_path / "scene.json"
    assert said(capsys, "export", "lee", "--floats", "--out", str(path))[0] == 0
    assert json.loads(path.read_text("utf-8"))["schema"] == "truebreak/floats-1"
    assert "add --floats" in said(capsys, "export", "lee", "--csv")[2]


def test_a_log_is_of_one_scene(gas: Trajectory) -> None:
    log = LogEngine.of(triples(gas), gas.scene, "mine")
    other: Scene = catalogue.build("gas:seed=2")
    with pytest.raises(SceneError, match="'mine' is a log of 'gas', not of 'gas:seed=2'"):
        log.run(other)
