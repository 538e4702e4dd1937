"""The player as a widget: what Python says of it, and what a browser makes of it with a model as notebooks have."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import pytest
from browser import Browser, found
from pages import comparison

from truebreak.compare import compare
from truebreak.compare.report import player as widget
from truebreak.compare.report.player import player, player_page
from truebreak.scenarios import Circle, Scene
from truebreak.scenarios.errors import SceneError

HOST = """<!DOCTYPE html><title>host</title><div id="cell"></div><script type="module">
const code = %s;
const values = %s;
const listeners = {};
globalThis.saved = [];
globalThis.model = {
  get: (name) => values[name],
  set: (name, value) => { values[name] = value; },
  save_changes: () => { saved.push(values.time); },
  on: (name, act) => { listeners[name] = act; },
};
globalThis.fromPython = (name, value) => { values[name] = value; listeners[`change:${name}`](); };
const { default: made } = await import(URL.createObjectURL(new Blob([code], { type: "text/javascript" })));
globalThis.end = made.render({ model, el: document.getElementById("cell") });
globalThis.ready = true;
</script>"""

UNTIL = "new Promise((done) => { const look = () => (%s ? done(true) : setTimeout(look, 20)); look(); })"


def test_the_widget_holds_the_page_and_takes_a_time() -> None:
    pytest.importorskip("anywidget")
    shown = player(comparison("gas"), height=500)
    assert shown.page == player_page(comparison("gas"))
    assert shown.height == 500
    shown.time = 3.5
    assert shown.time == 3.5
    assert "export default" in shown._esm


def test_what_cannot_be_shown_is_refused() -> None:
    with pytest.raises(SceneError, match="nothing to play"):
        player_page(compare(Scene([Circle(0, 0)]), ["double"]))
    with pytest.raises(SceneError, match="height = 0"):
        player(comparison("gas"), height=0)


def test_without_anywidget_the_remedy_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "anywidget", None)
    widget._widget_class.cache_clear()
    with pytest.raises(ImportError, match=r"pip install '\.\[notebook\]'"):
        player(comparison("gas"))
    widget._widget_class.cache_clear()


@pytest.mark.skipif(found() is None, reason="no chromium here: apt-get install chromium")
def test_the_player_s_clock_and_the_widget_s_time_are_one(tmp_path: Path) -> None:
    code = Path(widget.__file__).with_name("templates").joinpath("widget.js").read_text("utf-8")
    values = {"page": player_page(comparison("gas")), "time": 0.0, "height": 500}
    text = HOST % tuple(json.dumps(part).replace("<", "\\u003c") for part in (code, values))
    (tmp_path / "host.html").write_text(text, "utf-8")
    with Browser() as browser:
        browser.open(tmp_path / "host.html")
        assert browser.ask(UNTIL % "globalThis.ready && saved.length")
        divergence = comparison("gas")["pymunk"].alignment.divergence
        assert divergence is not None
        assert browser.ask("saved.at(-1)") == pytest.approx(divergence.time, rel=1e-9)
        browser.ask("fromPython('time', 3.5)")
        assert browser.ask(UNTIL % "saved.at(-1) === 3.5")
        browser.ask("fromPython('time', 1e9)")
        end = float(comparison("gas").reference.final_time)
        assert browser.ask(UNTIL % f"Math.abs(saved.at(-1) - {end!r}) < 1e-9")
        browser.ask("fromPython('height', 320)")
        assert browser.ask("document.querySelector('iframe').clientHeight") == 320
        assert browser.messages == []
        browser.ask("end()")
