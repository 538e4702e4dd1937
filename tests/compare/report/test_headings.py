"""Every heading of the pages of chaos, of all orders, of grids and of two logs has a "?" of two sentences."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from truebreak.compare.chaos.certified_chaos import chaos
from truebreak.compare.grids.row import Row
from truebreak.compare.logdiff.desync import diff
from truebreak.compare.orders.all_orders import all_orders
from truebreak.compare.report.chaos_page import chaos_html
from truebreak.compare.report.desync_page import desync_html
from truebreak.compare.report.grid_page import grid_page
from truebreak.compare.report.orders_page import orders_html
from truebreak.exact import ExactEngine
from truebreak.scenarios import catalogue

HELP = r'<details class="help"[^>]*>.*?</details>'
HEADING = re.compile(rf'<div class="heading"><h[23][^>]*>.*?</h[23]>({HELP})?</div>', re.DOTALL)


def pages(folder: Path) -> dict[str, str]:
    """One page of each kind."""
    paths = [folder / name for name in ("a.jsonl", "b.jsonl")]
    for path, drift in zip(paths, (0.0, 1e-9), strict=True):
        lines = [
            {"time": k / 8, "contact": ["a", "b"], "states": {"a": [k + drift * 2**k, 0.0], "b": [0.0, 1.0 * k]}}
            for k in range(1, 12)
        ]
        path.write_text("".join(json.dumps(line) + "\n" for line in lines), "utf-8")
    scene = catalogue.build("lee")
    return {
        "chaos": chaos_html(chaos(catalogue.build("gas:n=3"), ["double"], events=60)),
        "orders": orders_html(scene, all_orders(ExactEngine(), scene)),
        "grid": grid_page("One", [Row(0, "lee", "double", "agree", agreed=1, events=1)]),
        "logs": desync_html([diff(*paths)], command="truebreak diff a.jsonl b.jsonl"),
    }


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    return pages(tmp_path_factory.mktemp("logs"))


@pytest.mark.parametrize("kind", ["chaos", "orders", "grid", "logs"])
def test_every_heading_has_a_mark_with_two_sentences(written: dict[str, str], kind: str) -> None:
    text = written[kind]
    found = [match[1] or "" for match in HEADING.finditer(text)]
    assert len(found) == len(re.findall(r"<h[23][ >]", text)) > 1
    for help in found:
        told = re.search(r"<p>(.*?)</p>", help, re.DOTALL)
        assert told is not None, text
        assert len(re.findall(r"[.!?](?= |$)", told[1].strip())) >= 2, told[1]
