"""Names that scenes bear are text wherever they go: no formula in a spreadsheet, no command on a terminal."""

from __future__ import annotations

import contextlib
import csv
import io
import json
import sqlite3
from pathlib import Path

import pytest
from command_line import said

import truebreak as tb
from truebreak.compare.grids.family_sweep import csv_parts
from truebreak.compare.grids.row import Row
from truebreak.scenarios.errors import printable

EVIL = ("=1+1", "@SUM(A1)", "+cmd|' /C calc'!A0", "-2+3+cmd|' /C calc'!A0")
ORDERS = "\u202e", "\u2066", "\x9b2J", "\x1b[2J", "\x07", "\U000e0041"
"""Marks that turn text around, clear the screen, ring, and cannot be seen."""


@pytest.mark.parametrize("name", EVIL)
def test_a_name_is_no_formula_in_csv(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    scene = tb.Scene([tb.Circle(0, 0, vx=1, id=name), tb.Circle(4, 0, id="b")], events=1)
    for what in ("events", "states"):
        for row in csv.reader(io.StringIO(tb.table(tb.run(scene), what).csv())):
            assert not any(cell.startswith(("=", "@", "+")) or cell.startswith("-2+3") for cell in row)
    lines = "".join(csv_parts([Row(0, name, name, parameters={"n": name})], ["n"])).splitlines()
    assert set(next(csv.reader(io.StringIO(lines[1])))) == {"0", "", "undecided", f"'{name}"}
    path = tmp_path / "x.json"
    path.write_text(json.dumps(scene.data()), encoding="utf-8")
    code, out, err = said(capsys, "export", str(path), "--floats", "--csv")
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert "takes an id that begins so for a formula" in err
    assert said(capsys, "export", str(path), "--floats")[0] == 0


def test_numbers_stay_what_they_are() -> None:
    scene = tb.Scene([tb.Circle(0, 0, vx=-1, id="-1"), tb.Circle(-4, 0, id="a=b")], events=1)
    text = tb.table(tb.run(scene), "states").csv()
    assert "'" not in text
    assert "-1,0.0,0.0" in text or "-1.0" in text


@pytest.mark.parametrize("mark", ORDERS)
def test_a_terminal_is_given_no_orders(mark: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Names, descriptions and errors show what they hold, and read back as that in JSON and TOML."""
    scene = tb.Scene([tb.Circle(0, 0, vx=1)], name=f"a{mark}b", description=f"c{mark}d", until=1)
    path = tmp_path / "x.json"
    path.write_text(json.dumps(scene.data()), encoding="utf-8")
    for words in (["show", str(path)], ["run", str(path)], ["show", str(path), "--json"], ["export", str(path)],
                  ["run", str(path), "--json"], ["compare", str(path), "--engines", "double"]):  # fmt: skip
        code, out, err = said(capsys, *words)
        assert code == 0
        assert mark[0] not in out + err
        if words[0] in ("show", "export") and out.startswith("{"):
            assert json.loads(out)["name"] == scene.name
    code, out, err = said(capsys, "run", f"no{mark}such")
    assert (code, out) == (2, "")
    assert mark[0] not in err
    path.write_text(json.dumps({"schema": "truebreak/suite-1", "cells": [{"scene": f"x{mark}"}]}), encoding="utf-8")
    suite = tmp_path / "s.toml"
    suite.write_text('engines = ["double"]\n[[scene]]\nname = "lee"', encoding="utf-8")
    assert mark[0] not in said(capsys, "suite", str(suite), "--against", str(path))[2]


def test_a_store_of_a_sweep_gives_a_terminal_no_orders(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """What went wrong with a scene is read from a file that may come from anyone."""
    path = str(tmp_path / "s.db")
    said(capsys, "sweep", "galperin", "--vary", "n=0..0", "--store", path, "--jobs", "1")
    for mark in ORDERS:
        with contextlib.closing(sqlite3.connect(path)) as base, base:
            base.execute("DELETE FROM failures")
            base.execute("INSERT INTO failures VALUES (0, ?, ?)", (f"x{mark}", f"a{mark}b"))
        code, out, err = said(capsys, "sweep", "--store", path)
        assert code == 0, mark
        assert "came to nothing: a" in err, mark
        assert mark[0] not in out + err, mark
        assert err.count("\n") == 1, mark


def test_what_can_be_read_is_left_as_it_is() -> None:
    for text in ("plain", "Zürich, 東京, ½ π", "two\nlines", "no\u00a0break", "\U0001f3b1"):
        assert printable(text) == text
