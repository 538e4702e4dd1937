"""The restitution that bounces have: planted ones are found, whatever they depend on."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any

import jsonschema
import pytest

from truebreak.compare.cli import main
from truebreak.compare.grids.bounce_survey import ASKED, BOUNCES, CONTACTS, bounce_scene, bounces_of
from truebreak.compare.report.schema import schema
from truebreak.exact import ExactEngine
from truebreak.floating import DoubleEngine
from truebreak.scenarios import Quantity, Scene
from truebreak.scenarios.trajectory import Trajectory


def code(words: list[str]) -> int:
    """The exit code of a command."""
    with pytest.raises(SystemExit) as stop:
        main(words)
    return int(stop.value.code or 0)


@dataclass(frozen=True)
class Planted(DoubleEngine):
    """Takes for the restitution what a rule makes of it and of the fastest disc's speed."""

    rule: str = "square"

    def run(self, scene: Scene, **asked: Any) -> Trajectory:  # type: ignore[override]
        speed = max(float(circle.vx) for circle in scene.circles)
        changed = {"square": scene.restitution * scene.restitution,
                   "threshold": "1/1000" if speed < 1 else scene.restitution}[self.rule]  # fmt: skip
        return super().run(scene.with_changes(restitution=changed), **asked)


@pytest.mark.parametrize("contact", ["wall", "discs"])
@pytest.mark.parametrize("asked", ASKED)
def test_the_exact_engine_has_what_is_asked_for(contact: str, asked: str) -> None:
    scene, speed, time = bounce_scene(contact, asked, 3)
    run = ExactEngine().run(scene, until=2 * time)
    assert [float(event.time) for event in run.events] == pytest.approx([time], rel=1e-15)
    speeds = [Quantity.of(circle.vx.text()) for circle in run.final.circles]
    after = speeds[1] - speeds[0] if contact == "discs" else -speeds[0]
    assert after == scene.restitution * speed


@pytest.mark.parametrize("asked", ASKED)
def test_the_exact_engine_comes_back_to_the_share_of_a_height(asked: str) -> None:
    found = bounces_of(ExactEngine(), "drop", asked)
    assert (found.bounces, found.missed, found.refused) == (BOUNCES, 0, None)
    for share in (found.least, found.greatest):
        assert share == pytest.approx(float(Quantity.of(asked)), abs=1e-7)  # as heights are looked at 4096 times


@pytest.mark.parametrize("contact", CONTACTS)
def test_a_square_in_place_of_the_restitution_is_found(contact: str) -> None:
    found = bounces_of(Planted(rule="square"), contact, "9/10")
    assert (found.bounces, found.missed) == (BOUNCES, 0)
    assert found.mean == pytest.approx(0.81, abs=1e-7 if contact == "drop" else 1e-12)
    assert found.spread is not None
    assert found.spread < 1e-12


@pytest.mark.parametrize("contact", ["wall", "discs"])
def test_what_depends_on_the_speed_is_a_spread(contact: str) -> None:
    found = bounces_of(Planted(rule="threshold"), contact, "9/10")
    assert found.least == pytest.approx(0.001, abs=1e-9)
    assert found.greatest == pytest.approx(0.9, abs=1e-12)
    assert found.mean == pytest.approx((8 * 0.001 + 8 * 0.9) / 16, abs=1e-9)
    assert found.spread == pytest.approx(0.899 / 2, abs=1e-9)


def test_pymunk_s_heights_scatter_with_the_phase_of_its_step() -> None:
    """Its flight is half a step late, and a bounce begins from an overlap; a finer step scatters less."""
    from truebreak.floating.pymunk_engine import PymunkEngine

    found = bounces_of(PymunkEngine(dt=1 / 60), "drop", "9/10")
    assert found.least is not None
    assert found.greatest is not None
    assert found.least < 0.9 < found.greatest
    assert 0.0005 < found.greatest - found.least < 0.01
    finer = bounces_of(PymunkEngine(dt=1 / 240), "drop", "9/10")
    assert finer.spread is not None
    assert found.spread is not None
    assert finer.spread < found.spread / 2


def test_a_step_too_long_for_a_disc_to_be_seen_is_a_miss() -> None:
    from truebreak.floating.pymunk_engine import PymunkEngine

    found = bounces_of(PymunkEngine(dt=4.0), "discs", "1")
    assert found.missed > 0


def test_phases_of_every_usual_step_are_spread_over_it() -> None:
    for step in (1 / 60, 1 / 64, 1 / 256, 1 / 1024):
        phases = sorted(float(bounce_scene("wall", "1", k)[2]) / step % 1 for k in range(BOUNCES))
        gaps = [b - a for a, b in zip(phases, [*phases[1:], phases[0] + 1], strict=True)]
        assert max(gaps) < 0.3


def test_the_command_prints_a_table_or_json(capsys: pytest.CaptureFixture[str]) -> None:
    assert code(["survey", "--restitution", "--engines", "double"]) == 0
    told = capsys.readouterr().out
    assert "9/10" in told
    assert "0.81" in told
    assert code(["survey", "--restitution", "--engines", "double", "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    jsonschema.Draft202012Validator(schema("restitution-1")).validate(data)
    assert [row["asked"] for row in data["rows"]] == [asked for asked in ASKED for _ in CONTACTS]


@pytest.mark.parametrize("option", [["--html", "a.html"], ["--scenes", "gas"], ["--page", "a.md"]])
def test_what_does_not_go_with_it_is_refused(option: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert code(["survey", "--restitution", *option]) == 2
    assert f"leave {option[0]} out" in capsys.readouterr().err
