"""A browser, the page in it, and its engines: those of a server on this computer."""

from __future__ import annotations

import sys
import threading
from collections.abc import Iterator
from pathlib import Path

import pytest

sys.path.append(str(Path(__file__).resolve().parent.parent / "report"))  # the browser that the tests of reports drive

from browser import Browser
from playing import PagePlayed

from truebreak.compare.play.page_files import page_files
from truebreak.compare.play.play_server import PlayServer


@pytest.fixture(scope="module")
def play_server() -> Iterator[PlayServer]:
    with PlayServer(page_files("server")) as made:
        thread = threading.Thread(target=made.serve_forever, kwargs={"poll_interval": 0.05})
        thread.start()
        yield made
        made.shutdown()
        thread.join()


@pytest.fixture(scope="module")
def running() -> Iterator[Browser]:
    with Browser() as browser:
        yield browser


@pytest.fixture
def page(running: Browser, play_server: PlayServer) -> PagePlayed:
    """The page as it starts, ready: a wide window, light, without motion."""
    running.media(prefers_reduced_motion="reduce")
    running.size(1200)
    played = PagePlayed(running, play_server.address)
    played.open()
    return played
