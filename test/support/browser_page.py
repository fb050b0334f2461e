"""A page in a browser, for tests: what it shows, and what a user does with it."""

import base64
import contextlib
import json
import re
from typing import Any, Dict, List, Tuple

import cv2
import numpy as np
import support

EVENTS = "Network.requestWillBeSent", "Network.dataReceived", "Network.webSocketCreated"
CALL = "return (async () => { %s })()"


KEEP_NOTICES = """
const area = document.getElementById("notices");
if (area && !window.keptNotices) {
  window.keptNotices = [];
  new MutationObserver((changes) => {
    for (const change of changes) {
      for (const notice of change.addedNodes) window.keptNotices.push(notice.textContent);
    }
  }).observe(area, { childList: true });
}
"""  # which go by themselves after some seconds


class Page:
    """A window of the browser.

    Attributes:
        expected: regular expressions of the console's errors that the test means to cause.
    """

    def __init__(self, browser: Any):
        self.browser = browser
        self.expected: List[str] = []
        self._handle = browser.driver.current_window_handle

    def front(self) -> "Page":
        """Makes this the window that commands go to, if there are several."""
        self.browser.driver.switch_to.window(self._handle)
        return self

    def command(self, name: str, **arguments: Any) -> Dict[str, Any]:
        """A command of the DevTools protocol."""
        return self.browser.driver.execute_cdp_cmd(name, arguments)

    def open(self, address: str) -> "Page":
        self.browser.origins.add("/".join(address.split("/")[:3]))
        self.browser.driver.get(address)
        self.run(KEEP_NOTICES)
        return self

    def reload(self) -> None:
        self.browser.driver.refresh()
        self.run(KEEP_NOTICES)

    def run(self, script: str, *arguments: Any) -> Any:
        """Runs statements in the page, which may await; returns what they return as JSON."""
        return self.browser.driver.execute_script(CALL % script, *arguments)

    def value(self, expression: str, *arguments: Any) -> Any:
        return self.run(f"return {expression};", *arguments)

    def wait(self, expression: str, *arguments: Any, seconds: float = support.DEADLINE) -> Any:
        """Waits until an expression is true in the page; returns its value."""

        def met() -> Any:
            with contextlib.suppress(_script_error()):
                return self.value(expression, *arguments)

        try:
            return support.wait_for(met, f"in the page: {expression} {arguments or ''}", seconds)
        except AssertionError as error:
            raise AssertionError(f"{error}; the page says:\n{self.text()[:3000]}") from None

    def text(self) -> str:
        return self.value("document.body.innerText")

    def wait_for_text(self, text: str, selector: str = "body") -> None:
        self.wait(
            "[...document.querySelectorAll(arguments[0])]"
            ".some((one) => one.innerText.includes(arguments[1]))",
            selector,
            text,
        )

    def wait_for_notice(self, text: str, selector: str = "") -> None:
        """Waits for a notice, which may be gone by now; or for the text in the selector's."""
        self.wait(
            """window.keptNotices.some((one) => one.includes(arguments[0])) ||
            (arguments[1] && [...document.querySelectorAll(arguments[1])]
             .some((one) => one.innerText.includes(arguments[0])))""",
            text,
            selector,
        )

    def count(self, selector: str) -> int:
        return self.value("document.querySelectorAll(arguments[0]).length", selector)

    def box(self, selector: str) -> Tuple[float, float, float, float]:
        """x, y, width and height of an element that is seen and at rest, CSS px of the window."""
        return tuple(
            self.wait(
                """(async () => {
                  const one = document.querySelector(arguments[0]);
                  if (!one) return null;
                  one.scrollIntoView({block: "nearest", inline: "nearest", behavior: "instant"});
                  const place = () => {
                    const box = one.getBoundingClientRect();
                    return [box.x, box.y, box.width, box.height];
                  };
                  const before = place();
                  const drawn = (done) => requestAnimationFrame(() => requestAnimationFrame(done));
                  const later = (done) => setTimeout(done, 1000);  // a hidden window draws nothing
                  await Promise.race([new Promise(drawn), new Promise(later)]);
                  const now = place();
                  return now[2] && now[3] && String(now) === String(before) && now;
                })()""",
                selector,
            )
        )

    def click(self, selector: str) -> None:
        """Clicks into the middle of an element, by the mouse."""
        x, y, width, height = self.box(selector)
        self.drag([(x + width / 2, y + height / 2)])

    def drag(self, points: List[Tuple[float, float]], touch: bool = False) -> None:
        """Presses at the first point, moves to the others and lets go; CSS px of the window."""
        send = self._touch if touch else self._mouse
        send("begin", *points[0])
        for x, y in points[1:]:
            send("move", x, y)
        send("end", *points[-1])

    def _mouse(self, what: str, x: float, y: float) -> None:
        kind = {"begin": "mousePressed", "move": "mouseMoved", "end": "mouseReleased"}[what]
        pressed = {"button": "left", "buttons": 0 if what == "end" else 1, "clickCount": 1}
        if what == "begin":
            self.command("Input.dispatchMouseEvent", type="mouseMoved", x=x, y=y)
        self.command("Input.dispatchMouseEvent", type=kind, x=x, y=y, **pressed)

    def _touch(self, what: str, x: float, y: float) -> None:
        kind = {"begin": "touchStart", "move": "touchMove", "end": "touchEnd"}[what]
        points = [] if what == "end" else [{"x": x, "y": y}]
        self.command("Input.dispatchTouchEvent", type=kind, touchPoints=points)

    def wheel(self, x: float, y: float, turned: float, ctrl: bool = False) -> None:
        """Turns the wheel by so many px, towards the user if positive."""
        turn = {"deltaX": 0, "deltaY": turned, "modifiers": 2 if ctrl else 0}
        self.command("Input.dispatchMouseEvent", type="mouseWheel", x=x, y=y, **turn)

    def keys(self, text: str) -> None:
        """Types into what has the focus; selenium's Keys are known."""
        from selenium.webdriver.common.action_chains import ActionChains

        ActionChains(self.browser.driver, duration=0).send_keys(text).perform()

    def fill(self, selector: str, text: Any) -> None:
        """Gives a field a value, or a menu its choice, as a user does."""
        self.wait("document.querySelector(arguments[0])", selector)
        self.run(
            """const field = document.querySelector(arguments[0]);
            field.focus();
            if (field.type === "checkbox") field.checked = arguments[1];
            else field.value = arguments[1];
            for (const kind of ["input", "change"]) {
              field.dispatchEvent(new Event(kind, {bubbles: true}));
            }""",
            selector,
            text,
        )

    def size(self, width: int, height: int, touch: bool = False, scale: float = 1.0) -> None:
        """Gives the window a size in CSS px; with `touch` it is a phone's."""
        self.command(
            "Emulation.setDeviceMetricsOverride",
            width=width,
            height=height,
            deviceScaleFactor=scale,
            mobile=touch,
        )
        touches = {"maxTouchPoints": 2} if touch else {}
        self.command("Emulation.setTouchEmulationEnabled", enabled=touch, **touches)

    def scheme(self, name: str) -> None:
        """What the user's system prefers, "dark" or "light"."""
        features = [{"name": "prefers-color-scheme", "value": name}]
        self.command("Emulation.setEmulatedMedia", features=features)

    def forget_emulation(self) -> None:
        """Has the window be again as if size() and scheme() had not been called."""
        self.command("Emulation.clearDeviceMetricsOverride")
        self.command("Emulation.setTouchEmulationEnabled", enabled=False)
        self.command("Emulation.setEmulatedMedia", features=[])

    def canvas(self, selector: str) -> np.ndarray:
        """The pixels of a canvas, (height, width, 3), BGR."""
        address = self.value("document.querySelector(arguments[0]).toDataURL()", selector)
        return decoded(address.partition(",")[2])

    def screenshot(self) -> np.ndarray:
        """What the window shows, (height, width, 3), BGR."""
        return decoded(self.command("Page.captureScreenshot", format="png")["data"])

    def halt(self) -> None:
        """Has the page wait for the user: it keeps its socket and reads nothing."""
        self.run("setTimeout(() => alert('halted'));")
        support.wait_for(self._alert, "the page's dialog")

    def resume(self) -> None:
        """Lets a page go on that was halted."""
        self.front()._alert().accept()

    def _alert(self) -> Any:
        from selenium.common.exceptions import NoAlertPresentException

        with contextlib.suppress(NoAlertPresentException):
            return self.browser.driver.switch_to.alert

    def traffic(self) -> Tuple[List[str], float]:
        """What this window has asked for since the last call: addresses, and bytes that came.

        Only of a browser that keeps its traffic. Sockets are among the addresses; neither what
        comes by them counts nor heads of answers.
        """
        logged = [json.loads(entry["message"]) for entry in self.browser.logs("performance")]
        events = [one["message"] for one in logged if self._handle.endswith(one["webview"])]
        told = {kind: [one["params"] for one in events if one["method"] == kind] for kind in EVENTS}
        sent, received, sockets = (told[kind] for kind in EVENTS)
        addresses = [one["request"]["url"] for one in sent] + [one["url"] for one in sockets]
        return addresses, sum(one["encodedDataLength"] for one in received)

    def check(self) -> None:
        """Fails if an error has come to the console that the test did not expect."""
        errors = [one["message"] for one in self.browser.logs("browser") if _is_error(one)]
        unexpected = [
            text for text in errors if not any(re.search(one, text) for one in self.expected)
        ]
        assert not unexpected, "the browser's console:\n" + "\n".join(unexpected)


def decoded(text: str) -> np.ndarray:
    """The image of a file in base64, (height, width, 3), BGR."""
    data = np.frombuffer(base64.b64decode(text), np.uint8)
    return cv2.imdecode(data, cv2.IMREAD_COLOR)


def _is_error(entry: Dict[str, Any]) -> bool:
    return entry["level"] == "SEVERE" or "Content Security Policy" in entry["message"]


def _script_error() -> Any:
    from selenium.common.exceptions import JavascriptException

    return JavascriptException
