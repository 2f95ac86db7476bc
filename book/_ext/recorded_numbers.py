"""The role ``{result}``: a number that a chapter has recorded, in a page of text.

``{result}`region:largest_scale.area | .3f``` writes that entry of results/region.json as 0.964, and
``{result}`region:vertex.1[0] | .1f``` the first entry of a vector with its unit, −94.1°. The format
``±`` adds what the printed digits leave open: 11.75 ± 0.02 rad²; with the other digit 11.86. The
chapters have written results/ when pages are built; a name that is not there, or a format that does
not fit its value, stops the build.
"""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxRole
from sphinx.util.typing import ExtensionMetadata

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
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
