"""The page Traceability: every row names what exists, and no object of the paper is left out."""

from __future__ import annotations

import re
from pathlib import Path
from pkgutil import resolve_name

import pytest

from engine_support.scripts import names_of_tests

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "book" / "traceability.md"
ROWS = [line for line in PAGE.read_text(encoding="utf-8").splitlines() if line.startswith("| {")]
LABEL = re.compile(r"`(?:eq|fig|tab|thm):\w+`")
OBJECTS = (
    [f"eq:{i}" for i in range(1, 40)]
    + [f"tab:{i}" for i in range(1, 7)]
    + [f"fig:{i}" for i in range(1, 12)]
    + ["thm:1", "thm:2"]
)
CHAPTERS = (ROOT / "notebooks").glob("[0-9]*.md")
BOOK = "\n".join(path.read_text(encoding="utf-8") for path in CHAPTERS)


def test_every_object_of_the_paper_has_one_row():
    assert [LABEL.search(row)[0].strip("`") for row in ROWS] == OBJECTS


@pytest.mark.parametrize("row", ROWS, ids=lambda row: LABEL.search(row)[0].strip("`"))
def test_an_object_stands_in_the_book_once_and_its_function_test_and_chapter_exist(row):
    label = LABEL.search(row)[0].strip("`")
    forms = [f"({label})\n", f"name: {label}\n", f":label: {label}\n"]
    assert sum(BOOK.count(form) for form in forms) == 1
    name = re.search(r"\{py:\w+\}`~?([\w.]+)`", row)[1]
    assert callable(resolve_name(name))
    file, test = re.search(r"`(test_\w+\.py)::(test_\w+)`", row).groups()
    assert test in names_of_tests(file)
    (chapter,) = re.findall(r"\(chapters/(\w+)\.ipynb\)", row)
    text = (ROOT / "notebooks" / f"{chapter}.md").read_text(encoding="utf-8")
    assert re.search(rf"(?:\(|name: |label: ){label}\)?$", text, re.M)
