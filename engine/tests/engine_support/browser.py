"""The system's Chromium, without a network, pages of the built book in it, and three families of
letters, the same on every machine.
"""

import base64
import os
import re
import shutil
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from functools import cache
from io import BytesIO
from pathlib import Path
from typing import Any

import matplotlib as mpl
import pytest
from fontTools import subset

from engine_support.pages import HTML
from lizarraga2025 import recorded

CHROMIUM_NAMES = ("chromium", "chromium-browser", "google-chrome")
HOW_TO_GET_CHROMIUM = (
    "The browser tests need Chromium: install it from your system's packages "
    "(apt-get install chromium, brew install --cask chromium, ...)."
)
FLAGS = [
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]
PATIENCE = 180_000  # ms: a ceiling for a page that hangs, far above what a busy machine needs
UNLESS_SAID = {
    "viewport": {"width": 1280, "height": 720},
    "color_scheme": "light",
    "reduced_motion": "no-preference",
}
"""What a new page is like, of all that can be changed on an old one."""

REMOTE = re.compile(r"^(?!(file|data|blob):)")


def chapter_page(name: str) -> str:
    """The built page of a chapter, by its name: its number is its place in the book."""
    return f"chapters/{recorded.file_stem(name)}.html"


FAMILIES = {
    "narrow": ("STIXGeneral", "STIXGeneralBol"),
    "DejaVu Sans": ("DejaVuSans", "DejaVuSans-Bold"),
    "wide": ("DejaVuSansMono", "DejaVuSansMono-Bold"),
}
"""Plain and bold files of a face like Times, of the widest that systems set pages in, and of one
that is wider than any. A layout must hold for all; which of them a machine has is chance, so they
come from matplotlib and are handed to the page."""

LETTERS = [*range(0x20, 0x250), *range(0x370, 0x400), *range(0x2000, 0x2300)]
"""Latin, Greek, punctuation, arrows and signs: the files shrink to a sixth."""

HAS_FACES = """[...document.fonts].some((face) => face.family.includes("test wide"))"""
ADD_FACES = """async (faces) => {
  for (const [family, weight, text] of faces) {
    const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
    document.fonts.add(await new FontFace(family, bytes, { weight }).load());
  }
}"""
WEAR = """(family) => {
  const { style } = document.documentElement;
  const faces = ["--book-serif", "--book-sans", "font-family"];
  for (const name of faces) style.setProperty(name, family);
  window.explorer?.redraw?.(); // an explorer's pictures are drawn for the letters that it finds
}"""
UNDRESS = """() => {
  for (const name of ["--book-serif", "--book-sans", "font-family"])
    document.documentElement.style.removeProperty(name);
}"""


def chromium() -> str:
    """Return the path of the system's Chromium; without one skip, or fail where it is required."""
    path = next(filter(None, map(shutil.which, CHROMIUM_NAMES)), None)
    if path is None and os.environ.get("QBOUND_REQUIRE_BROWSER") == "1":
        pytest.fail(HOW_TO_GET_CHROMIUM)
    return path or pytest.skip(HOW_TO_GET_CHROMIUM)


@pytest.fixture(scope="session")
def browser() -> Iterator[Any]:
    from playwright import sync_api as playwright

    path = chromium()
    with playwright.sync_playwright() as run:
        browser = run.chromium.launch(executable_path=path, args=FLAGS, timeout=PATIENCE)
        browser.on("context", lambda context: context.set_default_timeout(PATIENCE))
        yield browser
        browser.close()


@dataclass
class Tab:
    """A page that goes from one address to the next: a new one would take longer than most tests.

    It refuses whatever leaves the machine, and notes it, and what the page complains of.
    """

    page: Any
    requests: list[str] = field(default_factory=list)
    complaints: list[tuple[str, str]] = field(default_factory=list)

    def __post_init__(self) -> None:
        refuse_remote(self.page, self.requests)
        self.page.on("pageerror", lambda error: self.complaints.append(("error", str(error))))
        self.page.on("console", lambda said: self.complaints.append((said.type, said.text)))

    def said(self, *kinds: str) -> list[str]:
        """Return what the page complained of."""
        return [text for kind, text in self.complaints if kind in kinds]


class Tabs:
    """The tabs of a worker: who takes one has it alone, and finds nothing of who had it before."""

    def __init__(self, browser: Any) -> None:
        self.browser = browser
        self.free: dict[frozenset[Any], list[Tab]] = {}

    @contextmanager
    def lent(self, **options: Any) -> Iterator[Tab]:
        """Lend an empty tab; of the options of a new page, three can be changed on an old one."""
        look: dict[str, Any] = {name: options.pop(name, UNLESS_SAID[name]) for name in UNLESS_SAID}
        free = self.free.setdefault(frozenset(options.items()), [])
        tab = free.pop() if free else Tab(self.browser.new_page(**options))
        tab.page.set_viewport_size(look.pop("viewport"))
        tab.page.emulate_media(media="null", **look)
        yield tab
        self.clear(tab)
        free.append(tab)

    @staticmethod
    def clear(tab: Tab) -> None:
        if tab.page.url.startswith("file:"):
            tab.page.evaluate("localStorage.clear()")
        tab.page.goto("about:blank")
        tab.page.mouse.move(0, 0)
        tab.requests.clear()
        tab.complaints.clear()


@pytest.fixture(scope="session")
def tabs(browser: Any) -> Tabs:
    return Tabs(browser)


@contextmanager
def opening(tabs: Tabs, *excused: str) -> Iterator[Callable[..., Any]]:
    """Open pages by their address; at the end none has complained or asked for anything.

    Excused are complaints with one of these words.
    """
    with ExitStack() as taken:
        used: list[Tab] = []

        def open_one(address: str, **options: Any) -> Any:
            tab = taken.enter_context(tabs.lent(**options))
            used.append(tab)
            tab.page.goto(address)
            settle(tab.page)
            return tab.page

        yield open_one
        said = [text for tab in used for text in tab.said("error", "warning")]
        assert [text for text in said if not any(words in text for words in excused)] == []
        assert [address for tab in used for address in tab.requests] == []


@pytest.fixture
def open_quietly(tabs: Tabs) -> Iterator[Callable[..., Any]]:
    """Open pages; at the end none has complained of anything, or asked for anything."""
    with opening(tabs) as open_one:
        yield open_one


@cache
def faces() -> list[tuple[str, str, str]]:
    """Return family, weight and base64 of each file."""
    folder = Path(mpl.get_data_path(), "fonts/ttf")
    found = []
    for family, files in FAMILIES.items():
        for weight, file in zip(("400", "700"), files, strict=True):
            options = subset.Options(hinting=False, drop_tables=["FFTM"])
            font = subset.load_font(str(folder / f"{file}.ttf"), options)
            small, letters = BytesIO(), subset.Subsetter(options)
            letters.populate(unicodes=LETTERS)
            letters.subset(font)
            font.save(small)
            text = base64.b64encode(small.getvalue()).decode()
            found.append((f"test {family}", weight, text))
    return found


def in_every_family(page: Any, families: Iterable[str] = FAMILIES) -> Iterator[str]:
    """Set the page in one family after the other; code and signs keep their own."""
    if not page.evaluate(HAS_FACES):
        page.evaluate(ADD_FACES, faces())
    for family in families:
        page.evaluate(WEAR, f"'test {family}'")
        settle(page)
        yield family


def in_its_own_family(page: Any) -> None:
    """Set the page in its own letters again."""
    page.evaluate(UNDRESS)
    settle(page)


def refuse_remote(page: Any, requests: list[str]) -> None:
    """Record every request that leaves the machine, and let none pass."""

    def refuse(route: Any) -> None:
        requests.append(route.request.url)
        route.abort()

    page.route(REMOTE, refuse)


def settle(page: Any) -> None:
    """Wait for two frames: by then a new width is laid out."""
    page.evaluate("() => new Promise((f) => requestAnimationFrame(() => requestAnimationFrame(f)))")


def middle(part: Any) -> tuple[float, float]:
    """Return the place in the window at which the middle of a part of the page stands."""
    box = part.bounding_box()
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


def drag(page: Any, start: tuple[float, float], end: tuple[float, float], steps: int = 12) -> None:
    """Drag the mouse from a place to another, in steps, and wait until that is laid out."""
    page.mouse.move(*start)
    page.mouse.down()
    page.mouse.move(*end, steps=steps)
    page.mouse.up()
    settle(page)


FINGERS = {"has_touch": True, "is_mobile": True}
"""Options of a page on a device that fingers hold."""


def touch_drag(
    page: Any, start: tuple[float, float], end: tuple[float, float], steps: int = 9
) -> None:
    """Drag a finger from a place to another: real touches, which the browser may take to scroll."""
    client = page.context.new_cdp_session(page)

    def touch(kind: str, *places: tuple[float, float]) -> None:
        points = [{"x": x, "y": y} for x, y in places]
        client.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})

    touch("touchStart", start)
    for k in range(1, steps + 1):
        part = k / steps
        touch("touchMove", tuple(a + part * (b - a) for a, b in zip(start, end, strict=True)))
    touch("touchEnd")
    client.detach()
    settle(page)


def wait_until(page: Any, expression: str, then: str = "") -> None:
    """Wait for a frame in which the page says so, and do something in that frame.

    Playwright's own way needs an `eval` in the page, which the explorer's policy forbids.
    """
    came = page.evaluate(f"""() => new Promise((end) => {{
      const begun = performance.now();
      const look = () => {{
        if ({expression}) {{ {then}; end(true); }}
        else if (performance.now() - begun > {PATIENCE}) end(false);
        else requestAnimationFrame(look);
      }};
      look();
    }})""")
    assert came, f"never came true: {expression}"


def eventually(page: Any, question: Callable[[], bool]) -> None:
    """Ask again, two frames later each time, until the answer is yes."""
    end = time.monotonic() + PATIENCE / 1000
    while not question():
        assert time.monotonic() < end, "the answer stays no"
        settle(page)


COLOURS = ["color-contrast", "link-in-text-block"]
BUT_COLOURS = {"rules": {rule: {"enabled": False} for rule in COLOURS}}
"""Options of axe: most of its time goes into colours, and they alone hang on the theme."""


def rules_in(theme: str) -> dict[str, Any]:
    """Return axe's options for a page that it is asked about in the light and in the dark."""
    return {} if theme == "light" else {"runOnly": COLOURS}


def broken_rules(page: Any, context: Any = None, **options: Any) -> list[tuple[str, list[str]]]:
    """Ask axe; return the rules of accessibility that a page breaks, and where it does.

    What a page keeps to is not written out: that takes longer than to find it.
    """
    from axe_playwright_python.sync_playwright import Axe

    options = {"resultTypes": ["violations"], "preload": False} | options
    answer = Axe().run(page, context=context, options=options).response
    assert answer["passes"] or answer["incomplete"], answer
    return [
        (rule["id"], [node["html"][:120] for node in rule["nodes"]])
        for rule in answer["violations"]
    ]


def open_page(page: Any, name: str) -> None:
    """Open a page of the book and wait until its formulas are typeset."""
    file = HTML / name
    assert file.exists(), "run `python3 run.py book` first"
    page.goto(file.as_uri())
    page.evaluate("() => window.MathJax?.startup?.promise.then(() => {})")
    settle(page)
