"""The pages of the built book, each parsed once in a process."""

import re
from functools import cache
from pathlib import Path

from bs4 import BeautifulSoup

HTML = Path(__file__).resolve().parents[3] / "book" / "_build" / "html"


@cache
def text_of(page: str) -> str:
    """Return the text of a page by its path in the book."""
    file = HTML / page
    assert file.exists(), "run `python3 run.py book` first"
    return file.read_text(encoding="utf-8")


@cache
def read(page: str) -> BeautifulSoup:
    """Return a page by its path in the book."""
    return BeautifulSoup(text_of(page), "html.parser")


@cache
def ids(page: str) -> frozenset[str]:
    """Return the names that a link to the page may lead to.

    They are read off the text: links lead to all pages, and to parse these takes long.
    """
    return frozenset(re.findall(r'\sid="([^"]+)"', text_of(page)))
