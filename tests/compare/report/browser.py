"""Drives a headless Chromium by the DevTools protocol over a pipe: the standard library is enough for it."""

from __future__ import annotations

import base64
import hashlib
import json
import os
import shutil
import struct
import subprocess
import sys
import tempfile
import zlib
from pathlib import Path
from typing import Any

NAMES = ("chromium", "chromium-browser", "google-chrome")
"""Names under which a Chromium is looked for."""

FLAGS = (
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--disable-dev-shm-usage",
    "--hide-scrollbars",
    "--force-device-scale-factor=1",
    "--remote-debugging-pipe",
)

KEYS = {
    "Space": (" ", 32),
    "ArrowLeft": ("", 37),
    "ArrowRight": ("", 39),
    "Home": ("", 36),
    "End": ("", 35),
    "Tab": ("", 9),
}
"""Keys by code: the text that one types, and its number."""


def found() -> str | None:
    """The path of a Chromium; None where there is none."""
    return next((path for name in NAMES if (path := shutil.which(name))), None)


class Browser:
    """One Chromium with one page. `with Browser() as browser: browser.open(path)`."""

    def __init__(self) -> None:
        path = found()
        assert path is not None
        self._profile = tempfile.mkdtemp(prefix="truebreak-browser-")
        out_read, self._write = os.pipe()
        self._read, in_write = os.pipe()
        script = f'exec "$0" "$@" 3<&{out_read} 4>&{in_write}'
        arguments = [*FLAGS, f"--user-data-dir={self._profile}", "about:blank"]
        self._process = subprocess.Popen(
            ["bash", "-c", script, path, *arguments],
            pass_fds=(out_read, in_write),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        os.close(out_read)
        os.close(in_write)
        self._buffer = b""
        self._number = 0
        self._session: str | None = None
        self.messages: list[str] = []
        """What the page wrote to the console, and the errors that it did not catch."""
        self.requests: list[str] = []
        """Every address that the page asked for."""
        target = self.send("Target.createTarget", url="about:blank")["targetId"]
        self._session = self.send("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Network", "Log"):
            self.send(f"{domain}.enable")

    def __enter__(self) -> Browser:
        return self

    def __exit__(self, *_: object) -> None:
        self._process.terminate()
        self._process.wait()
        os.close(self._write)
        os.close(self._read)
        shutil.rmtree(self._profile, ignore_errors=True)

    def send(self, method: str, **params: Any) -> dict[str, Any]:
        """One command, and its result.

        Raises:
            RuntimeError: if Chromium refuses it.
        """
        self._number += 1
        number = self._number
        message: dict[str, Any] = {"id": number, "method": method, "params": params}
        if self._session is not None:
            message["sessionId"] = self._session
        data = json.dumps(message).encode() + b"\0"
        while data:
            data = data[os.write(self._write, data) :]
        while True:
            answer = self._next()
            if answer.get("id") != number:
                continue
            if "error" in answer:
                raise RuntimeError(f"{method}: {answer['error']['message']}")
            return answer["result"]

    def _next(self) -> dict[str, Any]:
        """The next message; what events tell is kept."""
        while b"\0" not in self._buffer:
            chunk = os.read(self._read, 1 << 16)
            if not chunk:
                raise RuntimeError("Chromium has ended")
            self._buffer += chunk
        line, _, self._buffer = self._buffer.partition(b"\0")
        message = json.loads(line)
        told = message.get("params", {})
        match message.get("method"):
            case "Runtime.consoleAPICalled":
                self.messages.append(" ".join(str(a.get("value", a.get("description"))) for a in told["args"]))
            case "Runtime.exceptionThrown":
                details = told["exceptionDetails"]
                self.messages.append(details.get("exception", {}).get("description") or details["text"])
            case "Log.entryAdded":
                self.messages.append(told["entry"]["text"])
            case "Network.requestWillBeSent":
                self.requests.append(told["request"]["url"])
        return message

    def open(self, path: Path) -> None:
        """Shows a file, and waits until it is there."""
        self.messages.clear()
        self.requests.clear()
        self.send("Page.navigate", url=path.resolve().as_uri())
        while self._next().get("method") != "Page.loadEventFired":
            pass

    def size(self, width: int, height: int = 900) -> None:
        """Sets the size of the window in pixels."""
        self.send("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)

    def media(self, media: str = "", **features: str) -> None:
        """Sets the medium (print) and features such as `prefers_color_scheme="dark"`."""
        rows = [{"name": name.replace("_", "-"), "value": value} for name, value in features.items()]
        self.send("Emulation.setEmulatedMedia", media=media, features=rows)

    def script(self, on: bool) -> None:
        """Switches scripts on or off for the pages opened from now on."""
        self.send("Emulation.setScriptExecutionDisabled", value=not on)

    def ask(self, expression: str) -> Any:
        """The value of an expression of JavaScript in the page; promises are waited for.

        Raises:
            RuntimeError: if it throws.
        """
        answer = self.send("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in answer:
            raise RuntimeError(answer["exceptionDetails"].get("exception", {}).get("description", "error"))
        return answer["result"].get("value")

    def press(self, code: str) -> None:
        """Presses and lets go of a key, by its code."""
        text, number = KEYS[code]
        key = {"code": code, "key": text or code, "windowsVirtualKeyCode": number}
        self.send("Input.dispatchKeyEvent", type="keyDown", text=text, **key)
        self.send("Input.dispatchKeyEvent", type="keyUp", **key)

    def click(self, selector: str) -> None:
        """Clicks with the mouse in the middle of an element, scrolled to first, once the scrolled page is drawn: until
        then the mouse meets what stood there before."""
        x, y = self.ask(
            f"new Promise((done) => {{ const e = document.querySelector({json.dumps(selector)}); "
            "e.scrollIntoView({block: 'center'}); "
            "const told = () => { const b = e.getBoundingClientRect(); "
            "done([b.x + b.width / 2, b.y + b.height / 2]); }; "
            "requestAnimationFrame(() => requestAnimationFrame(told)); })"
        )
        for kind in ("mousePressed", "mouseReleased"):
            self.send("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", clickCount=1)

    def touch(self, selector: str, across: float = 0.5, swipe: float = 0.0) -> None:
        """Puts a finger on an element, scrolled to first, so far across it, drags it sideways, and lets go."""
        x, y = self.ask(
            f"new Promise((done) => {{ const e = document.querySelector({json.dumps(selector)}); "
            "e.scrollIntoView({block: 'center'}); requestAnimationFrame(() => requestAnimationFrame(() => { "
            f"const b = e.getBoundingClientRect(); done([b.x + b.width * {across}, b.y + b.height / 2]); }})); }})"
        )
        self.send("Input.dispatchTouchEvent", type="touchStart", touchPoints=[{"x": x, "y": y}])
        for step in range(1, 9 if swipe else 1):
            self.send("Input.dispatchTouchEvent", type="touchMove", touchPoints=[{"x": x + swipe * step / 8, "y": y}])
        self.send("Input.dispatchTouchEvent", type="touchEnd", touchPoints=[])
        self.ask("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")

    def picture(self, *, whole: bool = True) -> bytes:
        """The page as PNG: all of it, or the window."""
        shot = self.send("Page.captureScreenshot", format="png", captureBeyondViewport=whole)
        return base64.b64decode(shot["data"])

    def paper(self) -> bytes:
        """The page as PDF on A4."""
        shot = self.send("Page.printToPDF", paperWidth=8.27, paperHeight=11.69, printBackground=True)
        return base64.b64decode(shot["data"])


def main(page: str, picture: str, width: str = "1000", height: str = "0") -> None:
    """Takes a picture of a page, which says of what page it is; a height of 0 is all of it.

    `python tests/compare/report/browser.py PAGE PNG [WIDTH [HEIGHT]]`
    """
    with Browser() as browser:
        browser.size(int(width), int(height) or 900)
        browser.open(Path(page))
        shot = browser.picture(whole=height == "0")
    Path(picture).write_bytes(labelled(shot, shown_digest(Path(page).read_text("utf-8"))))


def shown_digest(page: str) -> str:
    """SHA-256 of what a report shows first, as text: verdict, answers, the moment's pictures and its table."""
    first = page.partition('<p class="verdict')[2].partition('<section id="player"')[0]
    return hashlib.sha256(first.encode()).hexdigest()


LABEL = b"tEXtpage\0"
"""Kind and keyword of the part of a PNG that says of what page it is."""


def labelled(png: bytes, digest: str) -> bytes:
    """A PNG with the digest of what the page shows first, before its end."""
    told = LABEL + digest.encode()
    part = struct.pack(">I", len(told) - 4) + told + struct.pack(">I", zlib.crc32(told))
    return png[:-12] + part + png[-12:]


if __name__ == "__main__":
    main(*sys.argv[1:])
