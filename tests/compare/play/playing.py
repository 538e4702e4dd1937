"""What one does with the page: opens it, presses, drags, types, waits."""

from __future__ import annotations

import json
import time as clock
from typing import Any

from browser import Browser

PATIENCE = 60.0
"""Seconds that the page may take: a shared machine may stand still for some."""

CODES = {"PageDown": 34, "PageUp": 33, "Delete": 46, "Escape": 27, "ArrowUp": 38, "ArrowRight": 39, "z": 90, "y": 89}


class PagePlayed:
    """The page in a browser.

    Args:
        address: the page's, with the token of its server.
    """

    def __init__(self, browser: Browser, address: str) -> None:
        self.browser, self.address = browser, address

    def open(self, fragment: str = "", ready: str = "Ready.") -> None:
        """Opens the page anew, with more in the fragment, and waits until it is ready."""
        self.browser.send("Page.navigate", url="about:blank")
        self.browser.messages.clear()
        self.browser.requests.clear()
        own = self.address if "#" in self.address else f"{self.address}#"
        self.browser.send("Page.navigate", url=own + ("&" if "=" in own and fragment else "") + fragment)
        self.wait(f"document.getElementById('ready')?.textContent === {json.dumps(ready)}")

    def wait(self, expression: str) -> Any:
        """Waits until an expression of JavaScript is true."""
        until = clock.monotonic() + PATIENCE
        while clock.monotonic() < until:
            if found := self.browser.ask(expression):
                return found
            clock.sleep(0.05)
        raise AssertionError(f"{expression} never came true; the page says {self.text('progress')!r}")

    def text(self, name: str) -> str:
        """What an element says."""
        return self.browser.ask(self._text(name))

    def says(self, name: str, pattern: str) -> str:
        """Waits until an element says something, and hands it back."""
        return self.wait(f"((t) => new RegExp({json.dumps(pattern)}).test(t) && t)({self._text(name)})")

    @staticmethod
    def _text(name: str) -> str:
        return f"document.getElementById({json.dumps(name)}).textContent"

    def value(self, name: str, value: str) -> None:
        """Types a value into a field of its own."""
        self.browser.ask(
            f"((e) => {{ e.value = {json.dumps(value)}; e.dispatchEvent(new Event('change', {{bubbles: true}})); }})"
            f"(document.getElementById({json.dumps(name)}))"
        )

    def press(self, name: str) -> None:
        """Presses a button."""
        self.browser.ask(f"document.getElementById({json.dumps(name)}).click()")

    def run(self, button: str = "go") -> str:
        """Presses a button that runs the scene, waits for the verdict, and hands it back."""
        self.browser.ask("document.getElementById('verdict').textContent = ''")
        self.press(button)
        return self.wait("document.getElementById('verdict').textContent")

    def key(self, key: str, *, control: bool = False, shift: bool = False) -> None:
        """Presses a key on what has the focus."""
        told = {"key": key, "code": key, "windowsVirtualKeyCode": CODES[key], "modifiers": 2 * control + 8 * shift}
        self.browser.send("Input.dispatchKeyEvent", type="rawKeyDown", **told)
        self.browser.send("Input.dispatchKeyEvent", type="keyUp", **told)

    def thing(self, name: str) -> dict[str, str]:
        """The numbers of a thing, as its fields have them, by choosing it in the list."""
        self.browser.ask(
            "[...document.querySelectorAll('#things button')]"
            f".find((b) => b.textContent.includes({json.dumps(f' {name} ')})).click()"
        )
        return self.browser.ask(
            "Object.fromEntries([...document.querySelectorAll('#fields input')].map((e) => [e.name, e.value]))"
        )

    def place(self, x: float, y: float, view: tuple[float, float, float, float]) -> tuple[float, float]:
        """Where a place of the scene is in the window, the editor in its middle; `view` is what the editor shows."""
        box = self.browser.ask(
            "((e) => { e.scrollIntoView({block: 'center'}); const b = e.getBoundingClientRect(); "
            "return [b.x, b.y, e.clientWidth, e.clientHeight]; })(document.getElementById('editor'))"
        )
        left, bottom, width, height = view
        scale = min(box[2] / width, box[3] / height)
        across, up = (x - left - width / 2) * scale, (y - bottom - height / 2) * scale
        return box[0] + box[2] / 2 + across + 1, box[1] + box[3] / 2 - up + 1  # one pixel of border

    def drag(self, start: tuple[float, float], end: tuple[float, float], *, touch: bool = False) -> None:
        """From one place in the window to another, with the mouse or a finger."""
        steps = [tuple(a + (b - a) * k / 8 for a, b in zip(start, end, strict=True)) for k in range(9)]
        for k, (x, y) in enumerate(steps):
            if touch:
                self._touch("touchStart" if k == 0 else "touchMove", [{"x": x, "y": y}])
            else:
                kind = "mousePressed" if k == 0 else "mouseMoved"
                self.browser.send(
                    "Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", buttons=1, clickCount=1
                )
        if touch:
            self._touch("touchEnd", [])
        else:
            x, y = steps[-1]
            self.browser.send("Input.dispatchMouseEvent", type="mouseReleased", x=x, y=y, button="left", clickCount=1)

    def _touch(self, kind: str, points: list[dict[str, float]]) -> None:
        self.browser.send("Input.dispatchTouchEvent", type=kind, touchPoints=points)
