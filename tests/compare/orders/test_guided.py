"""Laws of the guided policy: a permitted history is followed to its end, an impossible one is left."""

from __future__ import annotations

import dataclasses

import pytest

from truebreak.compare.orders.guided import Guided
from truebreak.exact import ExactEngine
from truebreak.scenarios import Contact, catalogue

SCENE = catalogue.build("rack:rows=3")
BALLS = [str(circle.id) for circle in SCENE.circles]


def history(run):
    return [event.impulses for event in run.events]


@pytest.mark.parametrize("seed", range(6))
def test_a_permitted_history_is_followed(seed):
    told = ExactEngine().run(SCENE.with_changes(tie_policy=f"sequential:seed={seed}"), events=12)
    guided = ExactEngine().run_with(SCENE, Guided(SCENE, told), events=12)
    partners = [{b: [c for c in e if b in c] for b in BALLS} for e in history(told)]
    assert [{b: [c for c in e if b in c] for b in BALLS} for e in history(guided)] == partners
    assert guided.final.array().tolist() == told.final.array().tolist()


def test_an_impossible_history_is_left():
    told = ExactEngine().run(SCENE, events=5)
    first = told.events[0]
    absurd = dataclasses.replace(first, impulses=(Contact("cue", "b6"), *first.impulses))
    guided = ExactEngine().run_with(
        SCENE, Guided(SCENE, dataclasses.replace(told, events=(absurd, *told.events[1:]))), events=5
    )
    assert Contact("cue", "b6") not in guided.events[0].impulses
