# SPDX-License-Identifier: Apache-2.0
"""Browser windows for tests: headless Chromium, driven by Playwright."""

WIDE, NARROW = (1400, 1000), (400, 800)

# Scripts evaluated in the page.
FITS = "document.documentElement.scrollWidth <= window.innerWidth"
# Elements that overflow the window or their own box sideways, except inside scrolling boxes.
STICKING_OUT = """[...document.body.querySelectorAll("*")]
    .filter((e) => e.getBoundingClientRect().right > document.documentElement.clientWidth + 0.5
        || (e.clientWidth && e.scrollWidth > e.clientWidth + 1))
    .map((e) => e.tagName + "#" + e.id)"""

# Function that sets a control as a user does.
SET = """((name, value) => {
    const e = document.getElementById(name);
    e.value = value;
    for (const kind of ['input', 'change']) e.dispatchEvent(new Event(kind));
})"""

LIMIT = 60  # seconds per action; a loaded computer may start a browser slowly


class Page:
    """Window of `width` x `height` CSS pixels with its own browser profile. `problems` collects console messages and
    uncaught errors; `requests` collects the addresses that are loaded."""

    def __init__(self, browser, width: int, height: int, **media: str):
        self.problems: list[str] = []
        self.requests: list[str] = []
        self._context = browser.new_context()
        self._context.set_default_timeout(1000 * LIMIT)
        self._page = self._context.new_page()
        self._page.on("pageerror", lambda error: self.problems.append(str(error)))
        self._page.on("console", lambda message: self.problems.append(f"console.{message.type}: {message.text}"))
        self._page.on("request", lambda request: self.requests.append(request.url))
        self.call = self._context.new_cdp_session(self._page).send
        self.click, self.press, self.run = self._page.click, self._page.keyboard.press, self._page.evaluate
        self.close = self._context.close
        self.resize(width, height, **media)

    def resize(self, width: int, height: int, **media: str) -> None:
        self._page.set_viewport_size({"width": width, "height": height})
        self._page.emulate_media(**media)

    def open(self, url: str, before: str = "") -> "Page":
        """Load a page and wait until its scripts have run. The script `before` runs before them."""
        self._page.add_init_script(before)
        for address in ("about:blank", url):  # a change of only the #hash would not reload the page
            self.requests.clear()
            self._page.goto(address)
        return self

    def wait_for(self, script: str) -> None:
        self._page.wait_for_function(f"() => {script}")

    def choose(self, name: str, value: object) -> None:
        """Set the control with this id."""
        self.run(f"{SET}('{name}', '{value}')")

    def text(self, name: str) -> str:
        """Return the text of the element with this id."""
        return self._page.text_content(f"#{name}")

    def picture(self, name: str = "scene") -> str:
        """Return the picture of the canvas with this id."""
        return self.run(f"document.getElementById('{name}').toDataURL()")

    def drag(self, start: tuple[float, float], end: tuple[float, float], *, touch: bool = False) -> None:
        """Press the mouse or a finger at `start` and release it at `end`; with start == end it is a click."""
        middle = tuple((a + b) / 2 for a, b in zip(start, end, strict=True))
        if touch:
            for kind, points in (("Start", [start]), ("Move", [middle]), ("Move", [end]), ("End", [])):
                touched = [{"x": x, "y": y} for x, y in points]
                self.call("Input.dispatchTouchEvent", {"type": f"touch{kind}", "touchPoints": touched})
            return
        self._page.mouse.move(*start)
        self._page.mouse.down()
        self._page.mouse.move(*end, steps=2)
        self._page.mouse.up()

    def middle(self, selector: str) -> tuple[float, float]:
        """Scroll an element into view and return its centre."""
        element = self._page.locator(selector).first
        element.scroll_into_view_if_needed()
        box = element.bounding_box()
        return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
