"""Every handle of every figure is taken by a finger and dragged in every direction."""

from __future__ import annotations

from math import hypot

import pytest

from engine_support.browser import FINGERS, opening, settle, touch_drag
from support.play import opened

FIGURES = {
    "front page": ("traversals", "paper", "data-small"),
    "traversals": ("traversals", "paper", 'data-start="right"'),
    "postures": ("postures", "clearance", ""),
    "regions": ("regions", "clearance", ""),
    "bodies": ("bodies", "clearance", ""),
    "circle": ("circle", "clearance", ""),
    "explorer": ("explorer", "clearance", ""),
    "goals": ("goals", "clearance", ""),
    "contact": ("contact", "clearance", ""),
    "live": ("live", "clearance", ""),
    "wedge of live": ("live", "clearance", ""),
    "crate of live": ("live", "clearance", ""),
}
FREE = {"front page", "postures", "explorer"}
"""Figures whose dot goes wherever the finger goes; elsewhere walls, a line or an edge stop it."""

DIRECTIONS = {"left": (-1, 0), "right": (1, 0), "up": (0, -1), "down": (0, 1)}
FAR = 40  # pixels that a finger goes
BESIDE = (8.0, -8.0)  # of a handle's middle: within 24 pixels across
SMALLEST = 24  # pixels: the least that a finger can aim at (WCAG 2.5.8)

TALL = "document.body.style.padding = '900px 8px'"  # there is something to scroll
CENTRED = "(n) => document.querySelectorAll('.reach-me')[n].scrollIntoView({ block: 'center' })"
LISTEN = """() => {
  window.heard = { pointercancel: 0, pointermove: 0 };
  for (const name of Object.keys(heard))
    addEventListener(name, () => { heard[name] += 1 }, true);
}"""


def middle(page, n):
    box = page.locator(".reach-me").nth(n).bounding_box()
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


def visible_handles(page):
    all_of_them = page.locator(".reach-me")
    return [n for n in range(all_of_them.count()) if all_of_them.nth(n).is_visible()]


@pytest.fixture(scope="module", params=FIGURES)
def figure(tabs, tmp_path_factory, request):
    """A figure in one page, which a test after the other asks."""
    with opening(tabs) as open_one:
        open_play = opened(open_one, tmp_path_factory.mktemp("figure"))
        page = open_play(*FIGURES[request.param], width=360, reduced_motion="reduce", **FINGERS)
        page.evaluate(TALL)
        page.evaluate(LISTEN)
        settle(page)
        yield request.param, page


def begin_anew(name, page):
    """Bring the live page's scene back, in which a drag before may have hidden a handle."""
    if "live" in name:
        page.get_by_role("button", name="Reset").click()
    if name.endswith(" of live"):
        page.get_by_label("Obstacle", exact=True).select_option(name.split()[0])
    settle(page)


def test_every_handle_follows_a_finger_in_every_direction_and_the_page_rests(figure):
    kind, page = figure
    begin_anew(kind, page)
    page.evaluate("heard.pointercancel = heard.pointermove = 0")
    for n in visible_handles(page):
        gone = 0.0
        for dx, dy in DIRECTIONS.values():
            begin_anew(kind, page)
            page.evaluate(CENTRED, n)
            settle(page)
            scrolled = page.evaluate("scrollY")
            x, y = middle(page, n)
            name = page.locator(".reach-me").nth(n).evaluate("(one) => one.localName")
            start = (x + BESIDE[0], y + BESIDE[1]) if name == "circle" else (x, y)
            touch_drag(page, start, (start[0] + FAR * dx, start[1] + FAR * dy), steps=5)
            assert page.evaluate("[scrollY, heard.pointercancel]") == [scrolled, 0], (n, dx, dy)
            after = middle(page, n)
            gone += hypot(after[0] - x, after[1] - y)
            if n == 0 and kind in FREE:
                assert after == pytest.approx((x + FAR * dx, y + FAR * dy), abs=1.5)
        assert gone > FAR, n
    assert page.evaluate("heard.pointermove") > 0


def test_every_handle_is_large_enough_for_a_finger(figure):
    begin_anew(*figure)
    _, page = figure
    boxes = [page.locator(".reach-me").nth(n).bounding_box() for n in visible_handles(page)]
    assert boxes
    assert min(min(box["width"], box["height"]) for box in boxes) >= SMALLEST


def test_a_finger_beside_the_handles_scrolls_the_page(figure):
    _, page = figure
    page.evaluate("document.querySelector('.reach-me').ownerSVGElement.scrollIntoView()")
    settle(page)
    before = page.evaluate("scrollY")
    box = page.locator("svg:has(.reach-me)").first.bounding_box()
    free = page.evaluate(
        """([left, top, width, height]) => {
          for (const [s, t] of [[0.1, 0.9], [0.9, 0.9], [0.9, 0.5], [0.1, 0.5]]) {
            const [x, y] = [left + s * width, top + t * height];
            const all = [...document.querySelectorAll(".reach-me")].map((handle) => {
              const box = handle.getBoundingClientRect();
              return Math.hypot(box.x + box.width / 2 - x, box.y + box.height / 2 - y);
            });
            if (Math.min(...all) > 30) return [x, y];
          }
        }""",
        [box["x"], box["y"], box["width"], box["height"]],
    )
    touch_drag(page, free, (free[0], free[1] - 80))
    assert page.evaluate("scrollY") > before
