"""What the chapters have recorded: ``{result}`` a number, ``{results}`` all, and ``{choices}``.

``{result}`region:largest_scale.area | .3f``` writes that entry of results/region.json as 0.964, and
``{result}`region:vertex.1[0] | .1f``` the first entry of a vector with its unit, −94.1°. The format
``±`` adds what the printed digits leave open: 11.75 ± 0.02 rad²; with the other digit 11.86. A
name that is not there, or a format that does not fit its value, stops the build.

The directive ``{choices}`` shows the book's choices (`lizarraga2025.choices`) as a table; its
content is the caption. The directive ``{results}`` shows every recorded number, with an anchor and
its citation to copy.
"""

from __future__ import annotations

import json
import re
from html import escape
from itertools import groupby
from pathlib import Path
from typing import Any, ClassVar

import nbformat
from docutils import nodes
from docutils.parsers.rst import directives
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective, SphinxRole
from sphinx.util.typing import ExtensionMetadata

from cspace import figures
from lizarraga2025 import recorded as record
from lizarraga2025.choices import CHOICES
from lizarraga2025.ledger import cite

WANTED = re.compile(
    r"(?P<file>\w+):(?P<id>[^\[|]+?)(?:\[(?P<index>\d+)\])?(?:\s*\|\s*(?P<format>\S+))?"
)
UNITS = {"1": "", "deg": "°", "rad^2": "\u00a0rad²", "deg^2": "\u00a0deg²", "cm^2": "\u00a0cm²"}

HEADER = ("Result", "Value", "Unit", "Numerical error", "Input uncertainty", "About")


class ResultRole(SphinxRole):
    """Write a recorded number, rounded as asked, with its unit."""

    def run(self) -> tuple[list[nodes.Node], list[nodes.system_message]]:
        folder = Path(self.env.app.confdir).parent / "results"
        try:
            text = recorded(self.text, folder)
        except (LookupError, OSError, TypeError, ValueError) as error:
            problem = f"no result {self.text!r}: {error}"
            return [], [self.inliner.reporter.error(problem, line=self.lineno)]
        return [nodes.inline(self.rawtext, text, classes=["result"])], []


class ChoicesTable(SphinxDirective):
    """Show what the text leaves open, what is chosen and why, and what another choice gives."""

    has_content = True
    option_spec: ClassVar = {"name": directives.unchanged_required}

    def run(self) -> list[nodes.Node]:
        rows = [("open in the text", "chosen here", "because", "another choice")]
        for one in CHOICES:
            given = [f" ({one.compared}: {{result}}`{name} | .5g`)" for name in one.results]
            ours, theirs = given or ("", "")
            rows.append((one.about, one.chosen + ours, one.reason, one.other + theirs))
        lines = ["```{list-table} " + " ".join(self.content), ":header-rows: 1"]
        lines += [f":name: {self.options['name']}"]
        lines += ["* - " + "\n  - ".join(row) for row in rows]
        return self.parse_text_to_nodes("\n".join([*lines, "```"]))


def recorded(wanted: str, folder: Path) -> str:
    """Return the text of ``FILE:ID[INDEX] | FORMAT``.

    Raises
    ------
    ValueError, LookupError, OSError
        If it is not written so, the format does not fit, or there is no such value or file.
    """
    match = WANTED.fullmatch(wanted)
    if match is None:
        raise ValueError("write FILE:ID | FORMAT, such as region:area | .3f")
    content = json.loads((folder / f"{match['file']}.json").read_text(encoding="utf-8"))
    entries: dict[str, Any] = {entry["id"]: entry for entry in content["results"]}
    if match["id"] not in entries:
        raise LookupError(f"{match['file']}.json has no {match['id']}")
    entry = entries[match["id"]]
    value = entry["value"][int(match["index"])] if match["index"] else entry["value"]
    unit = UNITS.get(entry["unit"], f"\u00a0{entry['unit']}")
    if match["format"] == "±":
        return record.with_uncertainty(entry, unit).replace("-", "−")
    return format(value, match["format"] or "").replace("-", "−") + unit


class ResultTables(SphinxDirective):
    """Show the results of every chapter in a table of its own."""

    def run(self) -> list[nodes.Node]:
        entries = record.distinct(record.results())  # a result of two chapters: at the first
        by_chapter = groupby(entries, lambda entry: record.chapter_of(entry["chapter"]))
        return [self.section(chapter, list(own)) for chapter, own in by_chapter]

    def section(self, chapter: str, entries: list[dict[str, Any]]) -> nodes.section:
        """Return the section of a chapter, under the title that its own page has."""
        file = Path(self.env.srcdir, "chapters", f"{record.file_stem(chapter)}.ipynb")
        first = nbformat.read(file, as_version=4).cells[0]
        title = first.source.partition("\n")[0].removeprefix("# ")
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
    """Return a result as a row whose id is its anchor; its citation can be unfolded and copied.

    The citation is no ``pre``: the theme measures each of these in turn, and hundreds take seconds.
    """
    anchor, name = cite.anchor(entry["id"]), escape(entry["id"])
    unit = "" if entry["unit"] == "1" else entry["unit"].replace("^2", "²")
    error = f"{entry['numerical_error']:g}" if entry["numerical_error"] else "exact"
    open_ = "–" if (bound := entry["input_uncertainty"]) is None else f"{bound:g}"
    drawn = figures.minus_signs("; ".join(record.left_open(entry)))
    return (
        f'<tr id="{anchor}"><th scope="row"><a href="#{anchor}">{name}</a></th>'
        f"<td>{escape(figures.minus_signs(cite.value_text(entry['value'])))}</td><td>{escape(unit)}</td>"
        f"<td>{error}</td><td>{open_}</td>"
        f"<td>{escape(record.sentence(entry['id']))} {escape(record.about(entry))}"
        f"{f'<p>Printed digits: {escape(drawn)}.</p>' if drawn else ''}"
        f'<details class="citation"><summary>Cite {name}</summary>'
        f'<div class="bibtex">{escape(cite.result(entry))}</div></details></td></tr>'
    )


def setup(app: Sphinx) -> ExtensionMetadata:
    """Register the role and both directives with Sphinx."""
    app.add_role("result", ResultRole())
    app.add_directive("choices", ChoicesTable)
    app.add_directive("results", ResultTables)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
