"""Logs and engines of an odd kind: each is one line, and a log that is merely unusual is read."""

from __future__ import annotations

import os
import threading
from pathlib import Path

import pytest
from command_line import said

from truebreak.compare.foreign import LogEngine
from truebreak.compare.foreign import log_engine as log_module
from truebreak.compare.validation import EngineError
from truebreak.scenarios import catalogue


def test_a_mark_of_byte_order_is_none_of_a_log(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "log.csv"
    path.write_text("time,a,b\n1,left,middle\n", "utf-8-sig")
    assert said(capsys, "judge", "near-tie:k=2", str(path), "--events", "1")[0] == 0


def test_a_cell_too_long_for_csv_is_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "log.csv"
    path.write_text("time,a,b\n1,c1," + "c" * 200_000, "utf-8")
    code, _, err = said(capsys, "judge", "gas", str(path))
    assert code == 2
    assert "is no row of CSV: field larger than field limit" in err


def test_a_pipe_too_long_is_refused_as_soon_as_it_is(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "log.jsonl"
    os.mkfifo(path)
    monkeypatch.setattr(log_module, "MOST_BYTES", 1000)
    lines = '{"time": 0.5, "contact": ["c1", "c2"]}\n' * 100
    writer = threading.Thread(target=path.write_text, args=(lines, "utf-8"))
    writer.start()
    assert "line 26: the log is longer than 1,000 bytes" in said(capsys, "judge", "gas", str(path))[2]
    writer.join()


@pytest.mark.parametrize("line", [(1.0, "left"), 7, (1.0, "left", "middle", 3)])
def test_a_list_of_something_else_is_no_log(line: object) -> None:
    with pytest.raises(EngineError, match=r"log, event 0: .*; must be \(time, a, b\)"):
        LogEngine.of([line], catalogue.build("near-tie:k=2"))  # type: ignore[list-item]


EXITS = """
from truebreak.scenarios import Declared

class Exits(Declared):
    name = "exits"
    def run(self, scene, **limits):
        raise SystemExit(3)
"""


@pytest.mark.parametrize(
    ("text", "module", "words"),
    [
        ("leaving:Exits", EXITS, "engine 'exits': run raised SystemExit: 3"),
        ("leaving_at_once:Mine", "raise SystemExit(4)", "engine 'leaving_at_once:Mine': SystemExit: 4"),
    ],
)
def test_an_engine_that_exits_does_not_end_the_command_unsaid(
    text: str,
    module: str,
    words: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    (tmp_path / f"{text.partition(':')[0]}.py").write_text(module, "utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    code, out, err = said(capsys, "compare", "lee", "--engines", text)
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert words in err


def test_a_log_with_a_header_steps_and_hashes_is_judged_by_its_events(tmp_path: Path) -> None:
    """What `truebreak diff` reads besides is passed over."""
    from truebreak.compare.foreign.log_engine import read_log
    from truebreak.scenarios import Circle, Scene

    path = tmp_path / "log.jsonl"
    path.write_text(
        '{"log": "truebreak/log-1", "engine": "mine"}\n'
        '{"body": "a", "outline": [{"circle": 1}]}\n'
        '{"step": 1, "time": 1.0, "hash": "ab", "input": 3}\n'
        '{"step": 2, "time": 2.0, "contact": ["a", "b"], "energy": 1.0, "hash": "cd"}\n'
        '{"end": 3.0}\n',
        encoding="utf-8",
    )
    run = read_log(path, Scene([Circle(0, 0, vx=1, id="a"), Circle(4, 0, id="b")])).trajectory()
    assert [float(event.time) for event in run.events] == [2.0]
