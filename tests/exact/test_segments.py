"""Segments: against a referee in plain coordinates, the laws that hold of them, and faults that must be found."""

from __future__ import annotations

import pytest
from mpmath import mpf
from segment_referee import Referee
from segment_scenes import scene_of

from truebreak.exact import ExactEngine
from truebreak.exact.certified.filtered import DoubleFilter
from truebreak.exact.replay import state as states
from truebreak.exact.simulation import prediction
from truebreak.exact.simulation.instant import Resolver
from truebreak.scenarios import Scene, Segment, surfaces

UNTIL, EVENTS = 20, 10
SEEDS = range(260)


def differs(scene: Scene) -> str:
    """How the exact engine and the referee part; empty where they agree."""
    run = ExactEngine().run(scene, until=UNTIL, events=EVENTS)
    told = Referee(scene).run(mpf(UNTIL), EVENTS)
    for mine, theirs in zip(told.events, run.events, strict=False):
        if abs(mpf(theirs.time.digits(80)) - mine.time) > mpf(10) ** -50:
            return f"event {theirs.index} at {float(theirs.time)}, not {float(mine.time)}"
        names = {tuple(pair) for pair in theirs.contacts}
        if not mine.approaching <= names <= mine.touching:
            return f"event {theirs.index}: {names}, not {mine.approaching}"
    if len(told.events) != len(run.events):
        return f"{len(run.events)} events, not {len(told.events)}"
    if "no normal" in run.stop.message or told.blunt is not None:
        return "" if "no normal" in run.stop.message and told.blunt is not None else "a corner"
    if not run.certified:
        return run.stop.message
    for circle, disc in zip(run.final.circles, told.discs, strict=True):
        pairs = zip((circle.x, circle.y, circle.vx, circle.vy), (disc.x, disc.y, disc.vx, disc.vy), strict=True)
        if any(abs(mpf(a.digits(70)) - b) > mpf(10) ** -45 for a, b in pairs):
            return f"{circle.id} ends elsewhere"
    return ""


def test_scenes_agree_with_the_referee():
    scenes = [(seed, scene) for seed in SEEDS if (scene := scene_of(seed)) is not None]
    assert len(scenes) > 150
    assert {seed: told for seed, scene in scenes if (told := differs(scene))} == {}


def _always(value):
    def said(*_):
        return value

    return said


def _wrong_foot(monkeypatch):
    def flipped(along, slide, gap, approach):
        return -slide * gap - along * approach

    monkeypatch.setattr(prediction, "face_foot", flipped)
    monkeypatch.setattr(states, "face_foot", flipped)


def _no_range(monkeypatch):
    monkeypatch.setattr(DoubleFilter, "faces", DoubleFilter.walls)


def _no_range_in_balls(monkeypatch):
    monkeypatch.setattr(states.Flights, "face_foot", lambda self, *_: self.one)
    monkeypatch.setattr(prediction, "face_foot", lambda along, slide, gap, approach: gap * 0 + 1)
    monkeypatch.setattr(DoubleFilter, "faces", lambda self, a, lines: ([], [line.wall for line in lines]))


def _far_end_not_met(monkeypatch):
    known = surfaces.ends_of
    monkeypatch.setattr(surfaces, "ends_of", lambda segments: known(segments)[:-1])


def _one_side(monkeypatch):
    known = surfaces.Face.of
    monkeypatch.setattr(surfaces.Face, "of", classmethod(lambda _, segment, back: known(segment, False)))


def _thin(monkeypatch):
    known = surfaces.Face.of
    bare = lambda segment: Segment(segment.x0, segment.y0, segment.x1, segment.y1, segment.id)  # noqa: E731
    monkeypatch.setattr(surfaces.Face, "of", classmethod(lambda _, segment, back: known(bare(segment), back)))


def _slides_forgotten(monkeypatch):
    monkeypatch.setattr(Resolver, "_keep_lasting", _always(None))


def _faces_never_left(monkeypatch):
    monkeypatch.setattr(Resolver, "_left_faces", _always([]))


def _closed_faces(monkeypatch):
    monkeypatch.setattr(states.Flights, "face_foot", lambda self, link, far: self.one)


FAULTS = {
    "the sign of the way along a face": _wrong_foot,
    "no range in doubles": _no_range,
    "no range in balls": _no_range_in_balls,
    "an end that is not met": _far_end_not_met,
    "one side only": _one_side,
    "no thickness": _thin,
    "slides forgotten": _slides_forgotten,
    "a slide has no end": _faces_never_left,
}


@pytest.mark.parametrize("fault", FAULTS)
def test_planted_faults_are_found(fault, monkeypatch):
    FAULTS[fault](monkeypatch)
    for seed in SEEDS:
        scene = scene_of(seed)
        if scene is None:
            continue
        try:
            told = differs(scene)
        except (AssertionError, KeyError, IndexError, ValueError):
            told = "it fell"
        if told:
            return
    raise AssertionError(f"nothing finds {fault}")
