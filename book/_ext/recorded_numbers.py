"""The role ``{result}``: a number that a chapter has recorded, in a page of text; ``{choices}``.

``{result}`region:largest_scale.area | .3f``` writes that entry of results/region.json as 0.964, and
``{result}`region:vertex.1[0] | .1f``` the first entry of a vector with its unit, −94.1°. The format
``±`` adds what the printed digits leave open: 11.75 ± 0.02 rad²; with the other digit 11.86. The
chapters have written results/ when pages are built; a name that is not there, or a format that does
not fit its value, stops the build.

The directive ``{choices}`` shows the book's choices (`lizarraga2025.choices`) as a table; its
content is the caption.
"""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any, ClassVar

from docutils import nodes
from docutils.parsers.rst import directives
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective, SphinxRole
from sphinx.util.typing import ExtensionMetadata

from lizarraga2025.choices import CHOICES, Choice
from lizarraga2025.recorded import with_uncertainty

WANTED = re.compile(
    r"(?P<file>\w+):(?P<id>[^\[|]+?)(?:\[(?P<index>\d+)\])?(?:\s*\|\s*(?P<format>\S+))?"
)
UNITS = {"1": "", "deg": "°", "rad^2": "\u00a0rad²", "deg^2": "\u00a0deg²", "cm^2": "\u00a0cm²"}


class ResultRole(SphinxRole):
    """Write a recorded number, rounded as asked, with its unit."""

    def run(self) -> tuple[list[nodes.Node], list[nodes.system_message]]:
        folder = Path(self.env.app.confdir).parent / "results"
        try:
            text = recorded(self.text, folder)
        except (LookupError, OSError, TypeError, ValueError) as error:
            problem = f"no result {self.text!r}: {error}"
            return [], [self.inliner.reporter.error(problem, line=self.lineno)]
        self.env.note_dependency(str(folder / f"{self.text.partition(':')[0]}.json"))
        return [nodes.inline(self.rawtext, text, classes=["result"])], []


class ChoicesTable(SphinxDirective):
    """Show what the text leaves open, what is chosen and why, and what another choice gives."""

    has_content = True
    option_spec: ClassVar = {"name": directives.unchanged_required}

    def run(self) -> list[nodes.Node]:
        head = ("open in the text", "chosen here", "because", "another choice")
        rows = [head, *map(self.row, CHOICES)]
        lines = ["```{list-table} " + " ".join(self.content), ":header-rows: 1"]
        lines += [f":name: {self.options['name']}"]
        lines += ["* - " + "\n  - ".join(row) for row in rows]
        return self.parse_text_to_nodes("\n".join([*lines, "```"]))

    def row(self, choice: Choice) -> tuple[str, ...]:
        """Return the cells of a choice; what it gives stands in brackets."""
        ours, theirs = (
            (f" ({choice.compared}: {{result}}`{name} | .5g`)" for name in choice.results)
            if choice.results
            else ("", "")
        )
        return choice.about, choice.chosen + ours, choice.reason, choice.other + theirs


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
        return with_uncertainty(entry, unit).replace("-", "−")
    return format(value, match["format"] or "").replace("-", "−") + unit


def setup(app: Sphinx) -> ExtensionMetadata:
    """Register the role with Sphinx."""
    app.add_role("result", ResultRole())
    app.add_directive("choices", ChoicesTable)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
