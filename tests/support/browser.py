"""The system's Chromium, without a network, and pages of the built book in it."""

import os
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

HTML = Path(__file__).resolve().parents[2] / "book" / "_build" / "html"
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
LOCAL = ("file:", "data:", "blob:")


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
        browser = run.chromium.launch(executable_path=path, args=FLAGS)
        yield browser
        browser.close()


def refuse_remote(page: Any, requests: list[str]) -> None:
    """Record every request that leaves the machine, and let none pass."""

    def handle(route: Any) -> None:
        if route.request.url.startswith(LOCAL):
            route.continue_()
        else:
            requests.append(route.request.url)
            route.abort()

    page.route("**/*", handle)


def settle(page: Any) -> None:
    """Wait for two frames: by then a new width is laid out."""
    page.evaluate("() => new Promise((f) => requestAnimationFrame(() => requestAnimationFrame(f)))")


def open_page(page: Any, name: str) -> None:
    """Open a page of the book and wait until its formulas are typeset."""
    file = HTML / name
    assert file.exists(), "run `python3 run.py book` first"
    page.goto(file.as_uri())
    page.evaluate("() => window.MathJax?.startup?.promise.then(() => {})")
    settle(page)
