"""Why, on the page: the account, the gap that decides, the permitted patterns."""

from __future__ import annotations

from dataclasses import replace
from xml.etree import ElementTree

from pages import comparison, page

from truebreak.compare.picture import gap_values
from truebreak.compare.report.orders_page import gallery, met
from truebreak.compare.report.page import minimise_command
from truebreak.compare.report.player import recording
from truebreak.compare.report.sentences import headline, verdict_sentence


def test_the_account_of_the_page_adds_up_and_what_changes_nothing_is_folded() -> None:
    text = page("gas")
    section = text.partition('id="account"')[2].partition('<details class="engine"')[0]
    told = comparison("gas")["pymunk"].diagnosis
    assert told is not None
    for kind in ("time step", "overlap", "lateness"):
        assert kind in section
    table, _, folded = section.partition("<details")
    assert "tunnelling" not in table
    assert "tunnelling" in folded


def test_the_gap_that_decides_is_a_miss_in_one_run_and_a_hit_in_the_other() -> None:
    candidate = comparison("gas")["pymunk"]
    values = gap_values(candidate)
    assert values is not None
    exact, own = values
    assert candidate.margin is not None and candidate.margin.distance is not None and own is not None
    assert candidate.margin.distance[0] <= exact <= candidate.margin.distance[1]
    assert exact > 0 > own
    assert gap_values(comparison("near-tie")["double"]) is None, "an order of two meetings is no gap"
    assert f"exact {exact:+.3g} (a miss), pymunk {own:+.3g} (a hit)" in page("gas")


def test_permitted_patterns_are_drawn_with_the_engines_own_marked() -> None:
    found = gallery(comparison("rack"))
    assert found is not None
    assert found.drawn[0].label == "the policy's own"
    assert found.drawn[0].note == ""
    permitted = comparison("rack").permitted
    assert permitted is not None
    marked = {name for drawn in found.drawn for _, name in drawn.engines}
    assert marked == {c.engine for c in comparison("rack").candidates if c.verdict == "diverged"}
    for drawn in found.drawn:
        picture = ElementTree.fromstring(drawn.picture)
        lines = [e.get("class") for e in picture.iter("line")]
        assert ("more" in lines or "fewer" in lines) <= bool(drawn.note)
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
