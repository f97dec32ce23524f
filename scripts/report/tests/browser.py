# SPDX-License-Identifier: Apache-2.0
"""Headless Chromium for tests, controlled by the DevTools protocol over a pipe: no driver, library or port.

Plain `chromium --dump-dom` is not sufficient: its windows are at least 500 px wide, it accepts no keys, and it draws
no frames in virtual time.
"""

from __future__ import annotations

import json
import os
import select
import subprocess
import time
from pathlib import Path

WIDE, NARROW = (1400, 1000), (400, 800)

# Scripts evaluated in the page.
FITS = "document.documentElement.scrollWidth <= window.innerWidth"
# Elements that overflow the window or their own box sideways, except inside scrolling boxes.
STICKING_OUT = """[...document.body.querySelectorAll("*")]
    .filter((e) => e.getBoundingClientRect().right > document.documentElement.clientWidth + 0.5
        || (e.clientWidth && e.scrollWidth > e.clientWidth + 1))
    .map((e) => e.tagName + "#" + e.id)"""

# Sets a control, as a user does.
SET = """((name, value) => {
    const e = document.getElementById(name);
    e.value = value;
    for (const kind of ['input', 'change']) e.dispatchEvent(new Event(kind));
})"""

LIMIT = 60  # seconds per reply; a loaded computer may start a browser slowly


class Browser:
    """Chromium process; `pages` receive the events of their session."""

    def __init__(self, profile: Path):
        self.pages: dict[str, Page] = {}
        self._count = 0
        self._data = b""
        there, self._out = os.pipe()  # Chromium reads commands from descriptor 3 and writes replies to 4
        self._in, back = os.pipe()
        command = ["chromium", "--headless=new", "--no-sandbox", "--disable-gpu", "--no-first-run"]
        command += ["--disable-dev-shm-usage", "--disable-background-networking", f"--user-data-dir={profile}"]
        command += ["--remote-debugging-pipe", "about:blank"]
        shell = f'exec 8<&{there} 9>&{back}; exec 3<&8 4>&9 8<&- 9>&-; exec "$@"'  # moved twice: they may be 3 and 4
        quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        self._process = subprocess.Popen(["bash", "-c", shell, "bash", *command], pass_fds=(there, back), **quiet)
        os.close(there)
        os.close(back)

    def close(self) -> None:
        """End Chromium; in order, so that all processes end and the profile can be removed."""
        try:
            self.call("Browser.close")
            self._process.wait(LIMIT)
        except (AssertionError, OSError, subprocess.TimeoutExpired):
            self._process.kill()
            self._process.wait()
        os.close(self._in)
        os.close(self._out)

    def call(self, method: str, session: str | None = None, **parameters) -> dict:
        """Send a command and wait for its reply."""
        self._count += 1
        message = {"id": self._count, "method": method, "params": parameters}
        os.write(self._out, json.dumps(message | ({"sessionId": session} if session else {})).encode() + b"\0")
        while True:
            answer = self.read()
            if answer.get("id") == self._count:
                assert "error" not in answer, f"{method}: {answer['error']}"
                return answer["result"]

    def read(self) -> dict:
        """Return the next message; pass events to their page."""
        while b"\0" not in self._data:
            ready, _, _ = select.select([self._in], [], [], LIMIT)
            more = os.read(self._in, 1 << 20) if ready else b""
            assert more, "chromium gives no answer"
            self._data += more
        text, _, self._data = self._data.partition(b"\0")
        message = json.loads(text)
        if page := self.pages.get(message.get("sessionId")):
            page.record(message.get("method"), message.get("params", {}))
        return message


class Page:
    """Window of `width` x `height` CSS pixels with a profile of its own; `problems` collects console messages and
    uncaught errors."""

    def __init__(self, browser: Browser, width: int, height: int, **media: str):
        self.problems: list[str] = []
        self.requests: list[str] = []
        self.loaded = False
        self._browser = browser
        self._context = browser.call("Target.createBrowserContext")["browserContextId"]
        window = {"browserContextId": self._context, "newWindow": True}
        target = browser.call("Target.createTarget", url="about:blank", **window)["targetId"]
        self._session = browser.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        browser.pages[self._session] = self
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.call(f"{domain}.enable")
        self.resize(width, height, **media)

    def close(self) -> None:
        self._browser.call("Target.disposeBrowserContext", browserContextId=self._context)
        del self._browser.pages[self._session]

    def call(self, method: str, **parameters) -> dict:
        """Send a command to the page and wait for its reply."""
        return self._browser.call(method, self._session, **parameters)

    def resize(self, width: int, height: int, scale: int = 1, **media: str) -> None:
        """Set size, pixels per CSS pixel and media features, such as prefers_color_scheme."""
        size = {"width": width, "height": height, "deviceScaleFactor": scale, "mobile": False}
        self.call("Emulation.setDeviceMetricsOverride", **size)
        features = [{"name": name.replace("_", "-"), "value": value} for name, value in media.items()]
        self.call("Emulation.setEmulatedMedia", features=features)

    def record(self, event: str | None, about: dict) -> None:
        if event == "Runtime.exceptionThrown":
            details = about["exceptionDetails"]
            self.problems.append(details.get("exception", {}).get("description", details["text"]))
        elif event == "Runtime.consoleAPICalled":
            self.problems.append(f"console.{about['type']}: {about['args']}")
        elif event == "Log.entryAdded":
            self.problems.append(f"{about['entry']['level']}: {about['entry']['text']}")
        elif event == "Network.requestWillBeSent":
            self.requests.append(about["request"]["url"])
        elif event == "Page.loadEventFired":
            self.loaded = True

    def open(self, url: str) -> Page:
        """Load a page and wait until its script has run."""
        for address in ("about:blank", url):  # a change of only the #hash would not reload the page
            self.requests.clear()
            self.loaded = False
            self.call("Page.navigate", url=address)
            while not self.loaded:
                self._browser.read()
        return self

    def run(self, script: str):
        answer = self.call("Runtime.evaluate", expression=script, returnByValue=True, awaitPromise=True)
        assert "exceptionDetails" not in answer, f"{script}: {answer['exceptionDetails']}"
        return answer["result"].get("value")

    def wait_for(self, script: str, seconds: float = LIMIT) -> None:
        end = time.monotonic() + seconds
        while not self.run(script):
            assert time.monotonic() < end, f"never true: {script}"
            time.sleep(0.02)

    def choose(self, name: str, value: object) -> None:
        """Set the control with this id."""
        self.run(f"{SET}('{name}', '{value}')")

    def text(self, name: str) -> str:
        """Return the text of the element with this id."""
        return self.run(f"document.getElementById('{name}').textContent")

    def picture(self, name: str = "scene") -> str:
        """Return the picture of the canvas with this id."""
        return self.run(f"document.getElementById('{name}').toDataURL()")

    def press(self, key: str, *, shift: bool = False) -> None:
        code = "Space" if key == " " else key
        for kind in ("rawKeyDown", "keyUp"):
            number = {" ": 32, "ArrowLeft": 37, "ArrowRight": 39, "Home": 36, "End": 35}.get(key, 0)
            event = {"type": kind, "key": key, "code": code, "windowsVirtualKeyCode": number, "modifiers": 8 * shift}
            self.call("Input.dispatchKeyEvent", **event)

    def drag(self, start: tuple[float, float], end: tuple[float, float], *, touch: bool = False) -> None:
        """Press the mouse or a finger at one point and release it at another; the same point twice is a click."""
        middle = tuple((a + b) / 2 for a, b in zip(start, end, strict=True))
        if touch:
            for kind, points in (("Start", [start]), ("Move", [middle]), ("Move", [end]), ("End", [])):
                touched = [{"x": x, "y": y} for x, y in points]
                self.call("Input.dispatchTouchEvent", type=f"touch{kind}", touchPoints=touched)
            return
        moves = [("mousePressed", start), ("mouseMoved", middle), ("mouseMoved", end), ("mouseReleased", end)]
        for kind, (x, y) in moves:
            down = kind != "mouseReleased"
            self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", buttons=int(down), clickCount=1)

    def middle(self, selector: str) -> tuple[float, float]:
        """Scroll an element into view and return its centre."""
        self.run(f"document.querySelector('{selector}').scrollIntoView({{block: 'center'}})")
        box = self.run(f"document.querySelector('{selector}').getBoundingClientRect().toJSON()")
        return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2

    def click(self, selector: str) -> None:
        """Click the centre of an element."""
        point = self.middle(selector)
        self.drag(point, point)
