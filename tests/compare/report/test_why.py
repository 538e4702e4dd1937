"""Why, on the page: the margin beside the error, what would have been enough, the permitted patterns."""

from __future__ import annotations

from dataclasses import replace
from xml.etree import ElementTree

from pages import comparison, page

from truebreak.compare.report.html import amounts, enough, foreseen_bits
from truebreak.compare.report.orders_page import gallery, met
from truebreak.compare.report.page import minimise_command
from truebreak.compare.report.player import recording
from truebreak.compare.report.sentences import headline, verdict_sentence


def test_the_margin_stands_beside_the_error_on_one_scale() -> None:
    candidate = comparison("gas")["pymunk"]
    close, off = amounts(candidate)
    margin = candidate.margin
    assert margin is not None
    assert margin.distance is not None
    assert margin.error is not None
    assert off.share == 1.0
    assert close.share == abs(sum(margin.distance)) / 2 / margin.error
    assert (close.own, off.own) == (False, True)
    assert f"{margin.error:.3g}" in off.text
    assert off.name in page("gas")


def test_a_near_tie_is_seen_on_a_scale_of_powers() -> None:
    close, off = amounts(comparison("near-tie")["double"])
    assert close.text == "1e-40"
    assert off.text == "less than double resolution"
    assert off.share == 0


def test_what_would_have_been_enough_is_told() -> None:
    told = dict(enough(comparison("gas")["pymunk"]))
    assert "agrees" in told["time step"]
    assert "bits, foreseen" not in told


def test_bits_are_foreseen_only_where_all_is_known() -> None:
    assert foreseen_bits(1.0, 10, (0.25, 0.25), 1.0) == 12
    assert foreseen_bits(None, 10, (0.25, 0.25), 1.0) is None
    assert foreseen_bits(1.0, 10, (0.0, 0.0), 1.0) is None
    assert foreseen_bits(1.0, 10, None, 1.0) is None


def test_permitted_patterns_are_drawn_with_the_engines_own_marked() -> None:
    found = gallery(comparison("rack"))
    assert found is not None
    assert found.drawn[0].label == "the policy's own"
    assert found.drawn[0].told == ""
    permitted = comparison("rack").permitted
    assert permitted is not None
    marked = {name for drawn in found.drawn for _, name in drawn.engines}
    assert marked == {c.engine for c in comparison("rack").candidates if c.verdict == "diverged"}
    for drawn in found.drawn:
        picture = ElementTree.fromstring(drawn.picture)
        lines = [e.get("class") for e in picture.iter("line")]
        assert ("more" in lines or "fewer" in lines) <= bool(drawn.told)
    assert "What the physics permits" in page("rack")


def test_where_no_order_matters_no_patterns_are_drawn() -> None:
    assert comparison("gas").permitted is not None
    assert gallery(comparison("gas")) is None
    assert "What the physics permits" not in page("gas")


def test_pairs_that_met_are_counted_once() -> None:
    assert met({"a": {"met": ["b"]}, "b": {"met": ["a"]}}) == {frozenset("ab")}


def test_the_player_starts_with_the_engine_that_the_verdict_is_about() -> None:
    found = comparison("gas")
    lead = headline(found)
    data = recording(found)
    assert lead is not None
    assert data is not None
    assert data["lead"] == 2
    assert data["runs"][2]["name"] == lead.engine == "pymunk"
    assert "pymunk first differs" in verdict_sentence(found)


def test_the_page_tells_how_to_find_the_smallest_scene_where_the_command_can() -> None:
    found = comparison("gas")
    events = len(found.reference.events)
    told = f"truebreak minimise gas.toml --engine pymunk --events {events}"
    assert found["pymunk"].verdict == "diverged"
    assert minimise_command(found, found["pymunk"]) == told
    assert f"<code>{told}</code>" in page("gas").replace('<span class="word-whole">', "").replace("</span>", "")
    assert minimise_command(found, replace(found["pymunk"], engine="log.jsonl")) is None
    other = replace(found, reference=replace(found.reference, engine="quad"))
    assert minimise_command(other, found["pymunk"]) is None
