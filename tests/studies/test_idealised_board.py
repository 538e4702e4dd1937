"""The growth of speed on an idealised Galton board: what the table says of balls, and balls that leave the board."""

from __future__ import annotations

import idealised_board
import numpy as np
import pytest
from idealised_board import SPEED, TIMES, flown, growth, main, slope

from truebreak.exact.exact_engine import ExactEngine
from truebreak.scenarios.catalogue.scene_entry import Draw


def test_speeds_are_of_the_energy_that_a_fall_gives() -> None:
    rows, events = flown(3, 5, SPEED, 10, (1.0, 2.0))
    assert events > 3 * 20
    assert rows[..., 1] ** 2 == pytest.approx(SPEED**2 - 20 * rows[..., 0])
    level, _ = flown(2, 5, 1, 0, (4.0,))
    assert level[..., 1] == pytest.approx(1.0)
    assert abs(level[..., 0]).max() > 0.01


def test_no_lane_of_the_board_is_free() -> None:
    """Without gravity, a ball meets a peg on whatever way: by 6 at most, where lanes would let some go on."""
    draw = Draw(8)
    for _ in range(40):
        scene = idealised_board.board(draw, 1, 0, range(-12, 13))
        run = ExactEngine().run(scene, until=6)
        assert any(str(pair.second).startswith("peg") for event in run.events for pair in event.contacts)


def test_powers_are_found() -> None:
    """Every ball's v**3 grown by 90 t gives the exponent 1/3, whatever it was at first."""
    speeds = np.cbrt(SPEED**3 + 90 * np.array(TIMES)) * np.ones((4, 1))
    assert growth(speeds) == pytest.approx(90 * np.array(TIMES))
    assert float(slope(growth(speeds))) / 3 == pytest.approx(1 / 3)
    assert float(slope(speeds.mean(axis=0))) < 0.3


def test_a_ball_that_leaves_the_board_is_no_row(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(idealised_board, "FALLEN", range(-1, 4))
    with pytest.raises(RuntimeError, match="left the board by t = 10"):
        flown(3, 1, SPEED, 10, (10.0,))


def test_the_table_is_printed(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(idealised_board, "FREE", (2.0, 4.0))
    monkeypatch.setattr(idealised_board, "TIMES", (1.0, 2.0, 3.0))
    monkeypatch.setattr(idealised_board, "SPEED", 1)
    assert main(["--balls", "5", "--free", "4"]) == 0
    told = capsys.readouterr().out.splitlines()
    assert told[0].startswith("5 balls, certified, ")
    assert [line.split("|")[1].strip() for line in told[3:6]] == ["1", "2", "3"]
    assert "exponent of the mean speed itself" in told[-2]
    assert told[-1].startswith("without gravity, 4 balls: D = ")
    with pytest.raises(SystemExit):
        main(["--balls", "1"])
