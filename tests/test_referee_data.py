"""The referee's committed scenes and histories: whole, small and current."""

from __future__ import annotations

import json

import pytest
import referee
from referee import load, texts
from referee_play import Instant
from referee_scenes import SCENES

SMALLEST = sorted(SCENES, key=lambda name: (referee.DATA / f"{name}.scene.json").stat().st_size)[:2]


def test_every_scene_is_committed_and_small():
    assert referee.names() == sorted(SCENES)
    assert all(path.stat().st_size < 60_000 for path in referee.DATA.iterdir())


@pytest.mark.parametrize("name", sorted(SCENES))
def test_committed_history_is_whole(name):
    scene, history = load(name)
    assert scene == referee.make(name)
    assert len(history.events) == scene.events == SCENES[name][1]
    assert history.stop == "events"
    assert history.agreed_bits >= referee.AGREED_BITS
    assert all(isinstance(event, Instant) for event in history.events)
    times = [event.time for event in history.events]
    assert times == sorted(times)


@pytest.mark.parametrize(
    "name", [name if name in SMALLEST else pytest.param(name, marks=pytest.mark.slow) for name in SCENES]
)
def test_committed_data_are_current(name):
    scene, events = texts(name)
    assert (referee.DATA / f"{name}.scene.json").read_text() == scene
    assert (referee.DATA / f"{name}.events.json").read_text() == events
    assert json.loads(events)["stop"] == "events"
