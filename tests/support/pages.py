"""The pages of the built book, each parsed once in a process."""

from functools import cache
from pathlib import Path

from bs4 import BeautifulSoup

HTML = Path(__file__).resolve().parents[2] / "book" / "_build" / "html"


@cache
def read(page: str) -> BeautifulSoup:
    """Return a page by its path in the book."""
    file = HTML / page
    assert file.exists(), "run `python3 run.py book` first"
    return BeautifulSoup(file.read_text(encoding="utf-8"), "html.parser")


@cache
def ids(page: str) -> frozenset[str]:
    """Return the names that a link to the page may lead to."""
    return frozenset(tag["id"] for tag in read(page).find_all(id=True))
