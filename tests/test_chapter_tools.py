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

from lizarraga2025 import recorded
from support.pages import HTML, read
from support.scripts import load_script

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


def apply(folder: Path, *words: str) -> subprocess.CompletedProcess[str]:
    """Run a copy's own tool."""
    command = [sys.executable, folder / "tools" / "renumber.py", *words]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def contents(folder: Path) -> dict[str, bytes]:
    found = [
        path for path in folder.rglob("*") if path.is_file() and "__pycache__" not in str(path)
    ]
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in found}


# --- first cells ----------------------------------------------------------------------------------


def test_every_chapter_has_the_same_first_cell() -> None:
    script = tool("renumber")
    code = script.first_cell((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    for chapter in CHAPTERS:
        first = next(c for c in jupytext.read(chapter).cells if c.cell_type == "code")
        assert (first.source, first.metadata["tags"]) == (code, script.TAGS), chapter.name


def test_the_first_cell_is_put_before_the_imports_once(scratch: Path) -> None:
    stem = CHAPTERS[6].stem
    path = scratch / f"notebooks/{stem}.md"
    cells = jupytext.read(path)
    own = [c for c in cells.cells if "first-cell" in c.metadata.get("tags", [])]
    cells.cells = [cell for cell in cells.cells if cell not in own]
    path.write_text(jupytext.writes(cells, fmt="md:myst"), encoding="utf-8")
    assert apply(scratch, "--check").returncode == 1
    assert apply(scratch).returncode == 0
    once = contents(scratch)
    assert apply(scratch).returncode == 0
    assert apply(scratch, "--check").returncode == 0
    assert contents(scratch) == once
    text, notebook = (jupytext.read(scratch / f"notebooks/{stem}{s}") for s in (".md", ".ipynb"))
    compare_notebooks(notebook, text, fmt="md:myst")
    codes = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert "first-cell" in codes[0].metadata["tags"]
    assert "first-cell" not in codes[1].metadata.get("tags", [])


@pytest.mark.parametrize("address", ["", "https://example.org/group/qbound"])
def test_the_first_cell_says_what_to_install(monkeypatch: pytest.MonkeyPatch, address: str) -> None:
    """It is nothing where qbound is there; where it is not, it asks for it, or on Colab gets it."""
    script = tool("renumber")
    urls = f'Repository = "{address}"' if address else ""
    code = script.first_cell(f"[project.urls]\n{urls}\n")
    exec(code, {})
    monkeypatch.setattr("importlib.util.find_spec", lambda _: None)
    with pytest.raises(ModuleNotFoundError, match=re.escape("[notebooks]")):
        exec(code, {})
    called: list[list[str]] = []
    monkeypatch.setitem(sys.modules, "google.colab", ModuleType("google.colab"))
    monkeypatch.setattr(subprocess, "run", lambda words, **_: called.append(words))
    if address:
        exec(code, {})
        assert called[0][-1] == f"qbound[notebooks] @ git+{address}"


# --- references -----------------------------------------------------------------------------------


def test_roles_become_links_with_numbers() -> None:
    known = {"fig:5": "5", "eq:31": "31", "thm:2": "2", "tab:signs": "N4", "thm-arc": "N1"}
    written = tool("renumber").with_numbers
    for before, after in {
        "{numref}`fig:5`": "[Figure 5](#fig:5)",
        "{numref}`Figures %s <fig:5>`": "[Figures 5](#fig:5)",
        "{numref}`%s <fig:5>`": "[5](#fig:5)",
        "{numref}`tab:signs`": "[Table N4](#tab:signs)",
        "[Table N3](#tab:signs)": "[Table N4](#tab:signs)",
        "eq. {eq}`eq:31`": "eq. [(31)](#eq:31)",
        "{prf:ref}`thm:2`": "{prf:ref}`Theorem 2 <thm:2>`",
        "{prf:ref}`Theorem N3 <thm-arc>`": "{prf:ref}`Theorem N1 <thm-arc>`",
        "{prf:ref}`the arc <thm-arc>`": "{prf:ref}`the arc <thm-arc>`",
        "{numref}`fig:nowhere`": "{numref}`fig:nowhere`",
        "[why](#six-points), [2 to 3](#fig:5)": "[why](#six-points), [2 to 3](#fig:5)",
    }.items():
        assert written(before, known) == written(after, known) == after


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
    script = tool("workbook")
    assert script.main([str(tmp_path)]) == 0
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


def test_a_readers_work_is_left_alone(tmp_path: Path) -> None:
    script = tool("workbook")
    mine = tmp_path / f"{CHAPTERS[0].stem}.ipynb"
    mine.write_text("mine")
    assert script.main([str(tmp_path)]) == 0
    assert mine.read_text() == "mine"


# --- the list of chapters -------------------------------------------------------------------------


def test_nothing_is_left_to_do_in_the_committed_chapters() -> None:
    assert tool("renumber").main(["--check"]) == 0


def test_the_order_of_the_chapters_is_the_same_wherever_it_stands() -> None:
    index = (ROOT / "book/index.md").read_text(encoding="utf-8")
    stems = re.findall(r"^chapters/(\w+)$", index, re.M)
    assert stems == [chapter.stem for chapter in CHAPTERS]
    assert [int(stem[:2]) for stem in stems] == list(range(1, len(stems) + 1))
    assert tuple(stem[3:] for stem in stems) == recorded.CHAPTERS
    appended = index.partition(":caption: Appendices")[2]
    assert tuple(re.findall(r"^chapters/\d\d_(\w+)$", appended, re.M)) == recorded.APPENDICES


def test_every_link_to_a_chapter_leads_to_it_and_says_its_number() -> None:
    """Or its letter: those below the caption Appendices are called so."""
    first = len(CHAPTERS) - len(recorded.APPENDICES)
    calls = {
        c.stem: str(k + 1) if k < first else chr(ord("A") + k - first)
        for k, c in enumerate(CHAPTERS)
    }
    for chapter in CHAPTERS:
        text = chapter.read_text(encoding="utf-8")
        assert re.search(rf"^# {calls[chapter.stem]}\. ", text, re.M), chapter.name
    link = re.compile(r"\[([^\[\]]*)\]\((?:chapters/)?(\d\d_\w+)\.(?:ipynb|md)")
    said = re.compile(r"(?<=[Cc]hapter )\d+|(?<=[Aa]ppendix )[A-Z]|^\w+(?=\. )")
    for page in [*(ROOT / "notebooks").glob("*.md"), *(ROOT / "book").glob("*.md")]:
        for words, stem in link.findall(page.read_text(encoding="utf-8")):
            assert said.findall(words) in ([], [calls.get(stem)]), f"{page.name}: {words}"


def test_the_list_names_every_chapter_and_every_item_with_the_chapter_that_holds_it() -> None:
    text = (ROOT / "notebooks" / "README.md").read_text(encoding="utf-8")
    listed, table = text.split("## By item")
    assert re.findall(r"^- .*\((\w+)\.ipynb\)$", listed, re.M) == [c.stem for c in CHAPTERS]
    rows = dict(
        re.findall(r"^\| ((?:Theorem|Table|Figure) \d+) \|.*\((\w+)\.ipynb\) \|$", table, re.M)
    )
    kinds = {"Theorem": ("thm", 2), "Table": ("tab", 6), "Figure": ("fig", 11)}
    wanted = {f"{kind} {n}" for kind, (_, last) in kinds.items() for n in range(1, last + 1)}
    assert set(rows) == wanted
    for item, stem in rows.items():
        kind, number = item.split()
        label = f"{kinds[kind][0]}:{number}"
        chapter = (ROOT / "notebooks" / f"{stem}.md").read_text(encoding="utf-8")
        assert re.search(rf"(?:name: |label: ){label}$", chapter, re.M), item
    assert "| Equations (1) to (8) |" in table
