"""Small books: of one chapter with the real configuration and extensions, or of any source."""

import shutil
from copy import deepcopy
from pathlib import Path
from typing import Any
from unittest import mock

import nbformat
from sphinx.config import Config
from sphinx.testing.util import SphinxTestApp

from engine_support.scripts import importable

ROOT = Path(__file__).resolve().parents[2]
BOOK = ROOT / "book"

PYPROJECT = """
[project]
name = "qbound"
version = "1.2.3"
authors = [{{ name = "qbound maintainers" }}]
[project.urls]
Repository = "{repository}"
[tool.qbound]
title = "Feasible workspaces"
"""
TRIAL_INDEX = "# Trial\n\n{verdict}`misprint`\n\n```{toctree}\nchapters/01_trial\n```\n"


def build_trial(
    folder: Path, repository: str, index: str = TRIAL_INDEX, chapter: str = "# Trial chapter"
) -> Path:
    """Build a book of one chapter with the real configuration and an address of our choice."""
    book = folder / "book"
    for name in ("_ext", "_static", "_templates"):
        shutil.copytree(BOOK / name, book / name)
    for name in ("conf.py", "references.bib"):
        shutil.copy(BOOK / name, book)
    (folder / "pyproject.toml").write_text(PYPROJECT.format(repository=repository), "utf-8")
    (book / "index.md").write_text(index, "utf-8")
    (book / "chapters").mkdir()
    output = [nbformat.v4.new_output("stream", text="2")]
    cells = [
        nbformat.v4.new_markdown_cell(chapter),
        nbformat.v4.new_code_cell("1 + 1", outputs=output, execution_count=7),
    ]
    python = {"language_info": {"name": "python"}}
    notebook = nbformat.v4.new_notebook(cells=cells, metadata=python)
    nbformat.write(notebook, book / "chapters" / "01_trial.ipynb")
    outdir, warnings = build_book(book, book / "_ext", builddir=folder)
    assert warnings == ""
    return outdir


def build_book(
    source: Path, extensions: Path, builder: str = "html", **options: Any
) -> tuple[Path, str]:
    """Build the pages of a book in this process; return their folder and the warnings.

    Sphinx keeps the defaults of its settings for the process, and changes some of them.
    """
    fresh = deepcopy(Config.config_values)
    with importable(extensions), mock.patch.object(Config, "config_values", fresh):
        app = SphinxTestApp(builder, srcdir=source, **options)
        try:
            app.build()
            return Path(app.outdir), app.warning.getvalue()
        finally:
            app.cleanup()
