"""Two readers with a phone that has no network: Chromium by Playwright, Firefox by WebDriver BiDi.

Both do the same few things, so that one test is for both, and both keep a list of what a page asked
for elsewhere and of its errors. Firefox is Debian's own, which Playwright cannot drive; it speaks
BiDi itself, over a socket.
"""

from __future__ import annotations

import json
import re
import shutil
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import websocket

from engine_support.browser import FLAGS, chromium

PATIENCE = 600  # s: a ceiling for what hangs
PHONE = {"width": 390, "height": 844}
FIREFOX = ("firefox-esr", "firefox")
NOWHERE = (
    "--proxy-server=127.0.0.1:9"  # as PREFERENCES below; it is not asked for the machine itself
)
PREFERENCES = {
    "app.normandy.enabled": False,
    "browser.shell.checkDefaultBrowser": False,
    "datareporting.policy.dataSubmissionEnabled": False,
    "dom.w3c_touch_events.enabled": 1,
    "network.proxy.type": 1,
    "network.proxy.http": "127.0.0.1",
    "network.proxy.http_port": 9,
    "network.proxy.ssl": "127.0.0.1",
    "network.proxy.ssl_port": 9,
    "toolkit.telemetry.enabled": False,
}
"""Every request of a network goes to a port where nobody listens."""

HERE = ("file:", "blob:", "data:", "about:", "http://127.0.0.1:")
"""How an address begins that is no other place: files, and the server of the tests."""


class Reader:
    """What both can do; expressions are JavaScript."""

    def __init__(self) -> None:
        self.requests: list[str] = []
        self.complaints: list[str] = []

    def noted(self, address: str) -> None:
        """Keep an address that a page asked for, if it is elsewhere."""
        if not address.startswith(HERE):
            self.requests.append(address)

    def evaluate(self, expression: str) -> Any:
        raise NotImplementedError

    def open(self, address: str) -> None:
        raise NotImplementedError

    def tap(self, selector: str) -> None:
        raise NotImplementedError

    def give(self, selector: str, file: Path) -> None:
        raise NotImplementedError

    def until(self, expression: str, patience: float = PATIENCE) -> Any:
        """Ask until the answer is true, and return it."""
        end = time.monotonic() + patience
        while time.monotonic() < end:
            if found := self.evaluate(expression):
                return found
            time.sleep(0.2)
        raise AssertionError(f"in {patience} s never true: {expression}")

    def text(self, selector: str) -> str:
        found = self.evaluate(f"document.querySelector({json.dumps(selector)})?.textContent ?? ''")
        return str(found)


class Chromium(Reader):
    def __init__(self, page: Any) -> None:
        super().__init__()
        self.page = page
        page.on("request", lambda request: self.noted(request.url))
        page.on("pageerror", lambda error: self.complaints.append(str(error)))

    def evaluate(self, expression: str) -> Any:
        return self.page.evaluate(expression)

    def open(self, address: str) -> None:
        self.page.goto(address)

    def tap(self, selector: str) -> None:
        self.page.locator(selector).first.tap()

    def give(self, selector: str, file: Path) -> None:
        self.page.set_input_files(selector, file)


class Firefox(Reader):
    def __init__(self, socket: websocket.WebSocket) -> None:
        super().__init__()
        self.socket, self.asked = socket, 0
        self.ask("session.new", capabilities={})
        self.ask("session.subscribe", events=["network.beforeRequestSent", "log.entryAdded"])
        self.context = self.ask("browsingContext.create", type="tab")["context"]
        self.ask("browsingContext.setViewport", context=self.context, viewport=PHONE)

    def ask(self, method: str, **params: Any) -> Any:
        self.asked += 1
        self.socket.send(json.dumps({"id": self.asked, "method": method, "params": params}))
        while True:
            answer = json.loads(self.socket.recv())
            if answer["type"] == "event":
                self._event(answer["method"], answer["params"])
            elif answer.get("id") == self.asked:
                assert answer["type"] == "success", answer
                return answer["result"]

    def _event(self, method: str, params: Any) -> None:
        if method == "network.beforeRequestSent":
            self.noted(params["request"]["url"])
        elif params["type"] == "javascript" and params["level"] == "error":
            self.complaints.append(params["text"])

    def _asked(self, expression: str) -> Any:
        target = {"context": self.context}
        given = {"expression": expression, "target": target, "awaitPromise": True}
        return self.ask("script.evaluate", **given)

    def evaluate(self, expression: str) -> Any:
        found = self._asked(f"Promise.resolve({expression}).then((x) => JSON.stringify(x ?? null))")
        assert found["type"] == "success", found
        return json.loads(found["result"]["value"])

    def open(self, address: str) -> None:
        self.ask("browsingContext.navigate", context=self.context, url=address, wait="complete")

    def tap(self, selector: str) -> None:
        element = self._element(selector)
        self.evaluate(
            f"document.querySelector({json.dumps(selector)}).scrollIntoView({{block:'center'}})"
        )
        origin = {"type": "element", "element": element}
        finger = [
            {"type": "pointerMove", "x": 0, "y": 0, "origin": origin},
            {"type": "pointerDown", "button": 0},
            {"type": "pointerUp", "button": 0},
        ]
        touch = {"type": "pointer", "id": "finger", "parameters": {"pointerType": "touch"}}
        self.ask(
            "input.performActions", context=self.context, actions=[{**touch, "actions": finger}]
        )

    def give(self, selector: str, file: Path) -> None:
        chosen = {"context": self.context, "element": self._element(selector), "files": [str(file)]}
        self.ask("input.setFiles", **chosen)

    def _element(self, selector: str) -> dict[str, str]:
        found = self._asked(f"document.querySelector({json.dumps(selector)})")
        return {"sharedId": found["result"]["sharedId"]}


@contextmanager
def chromium_reader() -> Iterator[Chromium]:
    from playwright.sync_api import sync_playwright

    with sync_playwright() as run:
        browser = run.chromium.launch(executable_path=chromium(), args=[*FLAGS, NOWHERE])
        context = browser.new_context(viewport=PHONE, has_touch=True, is_mobile=True)
        context.set_default_timeout(PATIENCE * 1000)
        yield Chromium(context.new_page())
        browser.close()


@contextmanager
def firefox_reader(folder: Path) -> Iterator[Firefox]:
    program = next(filter(None, map(shutil.which, FIREFOX)))
    lines = [f"user_pref({json.dumps(k)}, {json.dumps(v)});" for k, v in PREFERENCES.items()]
    (folder / "user.js").write_text("\n".join(lines), encoding="utf-8")
    command = [program, "--headless", "--no-remote", "--profile", folder]
    log = folder / "said"
    with (
        log.open("w") as said,
        subprocess.Popen(
            [*command, "--remote-debugging-port", "0"], stderr=said, stdout=said
        ) as process,
    ):
        try:
            address = _address(log)
            options = {"timeout": PATIENCE, "suppress_origin": True}
            socket = websocket.create_connection(f"{address}/session", **options)
            yield Firefox(socket)
            socket.close()
        finally:
            process.terminate()


def _address(log: Path) -> str:
    end = time.monotonic() + 120
    while time.monotonic() < end:
        if found := re.search(r"ws://\S+", log.read_text(errors="replace")):
            return found[0]
        time.sleep(0.1)
    raise AssertionError("Firefox does not open its socket")
