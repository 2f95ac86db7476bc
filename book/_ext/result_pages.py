"""The directive ``{results}``: every recorded number, with an anchor and its citation to copy.

It reads results/ as the chapters have written it. The page is whole without a script; with one,
each citation gets a button.
"""

from __future__ import annotations

import json
from html import escape
from itertools import groupby
from pathlib import Path
from typing import Any

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective
from sphinx.util.typing import ExtensionMetadata

from cspace import figures
from lizarraga2025 import recorded
from lizarraga2025.ledger import cite

HEADER = ("Result", "Value", "Unit", "Numerical error", "Input uncertainty", "About")


class ResultTables(SphinxDirective):
    """Show the results of every chapter in a table of its own."""

    def run(self) -> list[nodes.Node]:
        folder = Path(self.env.app.confdir).parent / "results"
        for file in folder.glob("*.json"):
            self.env.note_dependency(str(file))
        entries = recorded.distinct(recorded.results())  # a result of two chapters: at the first
        by_chapter = groupby(entries, lambda entry: recorded.chapter_of(entry["chapter"]))
        return [self.section(chapter, list(own)) for chapter, own in by_chapter]

    def section(self, chapter: str, entries: list[dict[str, Any]]) -> nodes.section:
        """Return the section of a chapter, under the title that its own page has."""
        file = Path(self.env.srcdir, "chapters", f"{recorded.file_stem(chapter)}.ipynb")
        self.env.note_dependency(str(file))
        first = json.loads(file.read_text(encoding="utf-8"))["cells"][0]["source"]
        title = "".join(first).partition("\n")[0].removeprefix("# ")
        part = nodes.section(ids=[f"results-{chapter.replace('_', '-')}"], names=[title])
        part += [nodes.title("", title), nodes.raw("", table(entries), format="html")]
        return part


def table(entries: list[dict[str, Any]]) -> str:
    """Return a chapter's results behind one line: a browser lays out what is unfolded only."""
    count = f"{len(entries)} results" if len(entries) > 1 else "One result"
    head = "".join(f'<th scope="col">{name}</th>' for name in HEADER)
    rows = "\n".join(map(row, entries))
    return (
        f'<details class="results-of-chapter"><summary>{count}</summary>'
        '<div class="pst-scrollable-table-container"><table class="ledger-table results-table">\n'
        f"<thead><tr>{head}</tr></thead>\n<tbody>\n{rows}\n</tbody>\n</table></div></details>"
    )


def row(entry: dict[str, Any]) -> str:
    """Return a result as a row whose id is its anchor."""
    anchor, name = cite.anchor(entry["id"]), escape(entry["id"])
    unit = "" if entry["unit"] == "1" else entry["unit"].replace("^2", "²")
    error = f"{entry['numerical_error']:g}" if entry["numerical_error"] else "exact"
    open_ = "–" if (bound := entry["input_uncertainty"]) is None else f"{bound:g}"
    drawn = figures.minus_signs("; ".join(recorded.left_open(entry)))
    return (
        f'<tr id="{anchor}"><th scope="row"><a href="#{anchor}">{name}</a></th>'
        f"<td>{escape(figures.minus_signs(cite.value_text(entry['value'])))}</td><td>{escape(unit)}</td>"
        f"<td>{error}</td><td>{open_}</td>"
        f"<td>{escape(recorded.sentence(entry['id']))} {escape(recorded.about(entry))}"
        f"{f'<p>Printed digits: {escape(drawn)}.</p>' if drawn else ''}{citation(entry)}</td></tr>"
    )


def citation(entry: dict[str, Any]) -> str:
    """Return the BibTeX entry to unfold and to copy.

    It is no ``pre``: the theme measures each of these in turn, and hundreds take seconds.
    """
    label = f"Cite {escape(entry['id'])}"
    return (
        f'<details class="citation"><summary>{label}</summary>'
        f'<div class="bibtex">{escape(cite.result(entry))}</div></details>'
    )


def setup(app: Sphinx) -> ExtensionMetadata:
    """Register the directive with Sphinx."""
    app.add_directive("results", ResultTables)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
