"""What the cells of the book print: signs and units as a reader of print expects them."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).resolve().parents[2]
EXECUTED = sorted((ROOT / "book" / "chapters").glob("*.ipynb")) or [Path("no executed chapter")]

HYPHEN_FOR_MINUS = re.compile(r"(?<![\w)\].^{}-])-(?=\.?\d)")
NOT_PRINT = re.compile(r"`[^`]*`|\$[^$]*\$")  # code and formulas

chapters = pytest.mark.parametrize("chapter", EXECUTED, ids=lambda path: path.stem)


def outputs(chapter: Path, kind: str) -> list[str]:
    """Return the text of all outputs of a kind: "stream", or a media type."""
    cells = json.loads(chapter.read_text(encoding="utf-8"))["cells"]
    found: list[dict[str, Any]] = [o for cell in cells for o in cell.get("outputs", [])]
    texts = [o["text"] if kind == "stream" else o["data"][kind] for o in found if holds(o, kind)]
    return ["".join(text) for text in texts]


def holds(output: dict[str, Any], kind: str) -> bool:
    return output["output_type"] == "stream" if kind == "stream" else kind in output.get("data", {})


@chapters
def test_a_table_writes_minus_signs(chapter: Path) -> None:
    lines = [line for text in outputs(chapter, "text/markdown") for line in text.splitlines()]
    rows = [line for line in lines if line.startswith("|")]  # the text of a robot file is no table
    printed = [NOT_PRINT.sub("", row) for row in rows if not set(row) <= set("|- ")]
    assert [row for row in printed if HYPHEN_FOR_MINUS.search(row)] == []


@chapters
def test_nothing_shows_how_numpy_or_a_file_writes_a_number(chapter: Path) -> None:
    kinds = ("stream", "text/markdown", "text/plain")
    texts = [text for kind in kinds for text in outputs(chapter, kind)]
    assert [text for text in texts if re.search(r"np\.(float|int)\d+\(|\d deg\b", text)] == []


def test_the_search_for_hyphens_finds_them() -> None:
    assert all(HYPHEN_FOR_MINUS.search(x) for x in ("at -1.5°", "(-3, 4)", "| -2 |", "[-.5"))
    assert not any(HYPHEN_FOR_MINUS.search(x) for x in ("eqs. 1-5", "N-1", "x-1", "−1", "1e-9"))
