"""A browser, and the pages that the tests of the report look at, as files."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from browser import Browser
from pages import Files


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> Files:
    return Files(tmp_path_factory.mktemp("pages"))


@pytest.fixture(scope="module")
def running() -> Iterator[Browser]:
    with Browser() as browser:
        yield browser


@pytest.fixture
def browser(running: Browser) -> Browser:
    """The browser as it starts: a wide window, scripts on, light, with motion."""
    running.script(True)
    running.media()
    running.size(1200)
    return running
