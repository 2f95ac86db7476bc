"""What `run.py renumber` does to chapters, their order and list, and a reader's copies."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import jupytext
import nbformat
import pytest
from jupytext.compare import compare_notebooks

from engine_support.pages import HTML, read
from engine_support.scripts import load_script
from lizarraga2025 import recorded

ROOT = Path(__file__).resolve().parent.parent
TOOLS = ROOT / "tools"
CHAPTERS = sorted((ROOT / "notebooks").glob("[0-9]*.md"))


def tool(name: str) -> ModuleType:
    return load_script(f"tools/{name}.py")


@pytest.fixture
def scratch(tmp_path: Path) -> Path:
    """A copy of what the tools read and write, as a repository of its own."""
    for name in ("notebooks", "tools"):
        skip = shutil.ignore_patterns("__pycache__", ".ipynb_checkpoints")
        shutil.copytree(ROOT / name, tmp_path / name, ignore=skip)
    shutil.copy(ROOT / "pyproject.toml", tmp_path)
    (tmp_path / "book").mkdir()
    for page in (ROOT / "book").glob("*.md"):
        shutil.copy(page, tmp_path / "book")
    return tmp_path


def apply(folder: Path, *words: str) -> int:
    """Run a copy's own tool."""
    command = [sys.executable, folder / "tools" / "renumber.py", *words]
    return subprocess.run(command, capture_output=True, check=False).returncode


def test_nothing_is_left_to_do_in_the_committed_chapters() -> None:
    assert tool("renumber").main(["--check"]) == 0


def test_a_missing_first_cell_and_a_wrong_number_are_found_and_put_right(scratch: Path) -> None:
    path = scratch / "notebooks" / CHAPTERS[6].name
    right = path.read_text(encoding="utf-8")
    cell = tool("renumber").FIRST_CELL.findall(right)[0]
    for wrong in (right.replace(cell, ""), right.replace("[Table 6]", "[Table 0]")):
        assert wrong != right
        path.write_text(wrong, encoding="utf-8")
        assert apply(scratch, "--check") == 1
        assert path.read_text(encoding="utf-8") == wrong
        assert apply(scratch) == 0
        assert path.read_text(encoding="utf-8") == right
        assert apply(scratch, "--check") == 0
    text, notebook = jupytext.read(path), jupytext.read(path.with_suffix(".ipynb"))
    compare_notebooks(notebook, text, fmt="md:myst")


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("[Figures 0](#fig:5), [(0)](#eq:31)", "[Figures 5](#fig:5), [(31)](#eq:31)"),
        ("[Table N3](#tab:signs)", "[Table N4](#tab:signs)"),
        ("{prf:ref}`Theorem N3 <thm-arc>`", "{prf:ref}`Theorem N1 <thm-arc>`"),
        ("[why](#fig:5), {prf:ref}`the arc <thm-arc>`",) * 2,
        ("[2 to 3](#fig:5), [Figure 3](#nowhere)",) * 2,
    ],
)
def test_a_reference_says_its_number(before: str, after: str) -> None:
    known = {"fig:5": "5", "eq:31": "31", "tab:signs": "N4", "thm-arc": "N1"}
    assert tool("renumber").with_numbers(before, known) == after


def test_the_numbers_are_those_of_the_built_book() -> None:
    """The book's own, too: they are counted here as Sphinx counts them."""
    if not (HTML / "index.html").is_file():
        pytest.skip("the book has not been made")
    known = tool("renumber").numbers()
    built = {}
    for page in [*HTML.glob("*.html"), *(HTML / "chapters").glob("*.html")]:
        for number in read(page.relative_to(HTML).as_posix()).select(
            "span.caption-number, span.eqno"
        ):
            holder = number.find_parent(lambda tag: tag.get("id") and tag.name != "span")
            found = re.search(r"N?\d+[a-z]?", number.get_text())
            built[holder["id"].removeprefix("equation-")] = found and found[0]
    ids = {label.replace(":", "-"): number for label, number in known.items()}
    assert len(ids) > 100
    theorems = {name for name in ids if name.startswith("thm-")}
    assert {name: built.get(name) for name in ids.keys() - theorems} == {
        name: ids[name] for name in ids.keys() - theorems
    }


def test_a_readers_copy_carries_numbers_and_captions(tmp_path: Path) -> None:
    """And a copy that is there, which may hold the reader's work, is left alone."""
    mine = tmp_path / f"{CHAPTERS[0].stem}.ipynb"
    mine.write_text("mine")
    assert tool("workbook").main([str(tmp_path)]) == 0
    assert mine.read_text() == "mine"
    mine.unlink()
    assert tool("workbook").main([str(tmp_path)]) == 0
    copies = sorted(tmp_path.iterdir())
    assert [copy.stem for copy in copies] == [chapter.stem for chapter in CHAPTERS]
    text = ""
    for copy in copies:
        notebook = nbformat.read(copy, as_version=4)
        nbformat.validate(notebook)
        assert notebook.cells[0].source.startswith("---\nnumbering:")
        text += "\n".join(c.source for c in notebook.cells if c.cell_type == "markdown")
    assert not re.search(r"\{(numref|eq|cite(:\w)?)\}`", text)
    assert "\\tag{31}\n$$ (eq:31)" in text
    assert "**Figure 5.** " in text
    assert ":label: thm:2\n:enumerator: 2\n" in text


def test_the_order_of_the_chapters_is_the_same_wherever_it_stands() -> None:
    contents = [page.stem for page in tool("renumber").pages() if page.parent.name == "notebooks"]
    stems = sorted(contents)
    assert stems == [chapter.stem for chapter in CHAPTERS]
    assert stems == [recorded.file_stem(name) for name in recorded.CHAPTERS]
    numbers = list(recorded.CHAPTERS.values())
    assert numbers == sorted(set(numbers))
    assert tuple(stem[3:] for stem in contents[: len(recorded.PAPER)]) == recorded.PAPER
    assert contents[len(recorded.PAPER) :] == sorted(contents[len(recorded.PAPER) :])
    listed = (ROOT / "notebooks/README.md").read_text(encoding="utf-8").split("## By item")[0]
    assert re.findall(r"^- .*\((\w+)\.ipynb\)$", listed, re.M) == stems


def test_every_link_to_a_chapter_leads_to_it_and_says_its_number() -> None:
    """Or its letter: those below the caption Appendices are called so."""
    calls = {c.stem: recorded.called(c.stem[3:]).split()[1] for c in CHAPTERS}
    for chapter in CHAPTERS:
        text = chapter.read_text(encoding="utf-8")
        assert re.search(rf"^# {calls[chapter.stem]}\. ", text, re.M), chapter.name
    link = re.compile(r"\[([^\[\]]*)\]\((?:chapters/)?(\d\d_\w+)\.(?:ipynb|md)")
    said = re.compile(r"(?<=[Cc]hapter )\d+|(?<=[Aa]ppendix )[A-Z]|^\w+(?=\. )")
    for page in [*(ROOT / "notebooks").glob("*.md"), *(ROOT / "book").glob("*.md")]:
        for words, stem in link.findall(page.read_text(encoding="utf-8")):
            assert said.findall(words) in ([], [calls.get(stem)]), f"{page.name}: {words}"
