"""What a page shows of a chapter's code: one "Show the code" a section, no unanswered exercise.

A chapter folds the cells that a reader can do without (the tag ``hide-input``). On a page all
folded code of a section stands in one box at the section's end, in the order in which it runs; what
the cells show stays in its place. A page cannot run a cell, so an exercise's "Not filled in yet" is
left out there, and the section says where its cells run.
"""

from __future__ import annotations

from typing import Any

from docutils import nodes
from ledger_links import parent_of
from sphinx.application import Sphinx
from sphinx.transforms.post_transforms import SphinxPostTransform
from sphinx.util.typing import ExtensionMetadata

from lizarraga2025.exercises import UNFILLED

CELL, SOURCE, OUTPUT = "cell_code", "cell_code_source", "cell_code_output"
EXERCISES = "Exercises"
WHERE = (
    "Predict first, then open the solution. The cells of these exercises run in this chapter's "
    "notebook, which the foot of the page offers: there a cell says whether your value is right."
)


class OneCodeBox(SphinxPostTransform):
    """Gather the folded code of each section, and tidy its exercises."""

    default_priority = 198  # myst-nb folds at 199
    formats = ("html",)

    def run(self, **kwargs: Any) -> None:
        for section in list(self.document.findall(nodes.section)):
            cells = [cell for cell in section.findall(is_cell) if section_of(cell) is section]
            if title_of(section) == EXERCISES and cells:
                for cell in cells:
                    leave_out_unfilled(cell)
                section.insert(1, nodes.paragraph("", WHERE, classes=["exercises-where"]))
            folded = [cell for cell in cells if is_folded(cell)]
            if folded:
                whole = box(folded)  # first: it takes emptied cells out of the section
                section.insert(end_of_own_text(section), whole)


def is_cell(node: nodes.Node) -> bool:
    return isinstance(node, nodes.container) and node.get("nb_element") == CELL


def title_of(section: nodes.section) -> str:
    """Return the title of a section; the text of a theorem is a section without one."""
    first = section.next_node()
    return first.astext() if isinstance(first, nodes.title) else ""


def is_folded(cell: nodes.Element) -> bool:
    """Tell whether a cell hides its input, and has one."""
    source = bool(cell.children) and cell[0].get("nb_element") == SOURCE
    return source and cell.get("hide_mode") == "input"


def section_of(node: nodes.Node) -> Any:
    return parent_of(node, (nodes.section,))


def box(cells: list[nodes.Element]) -> nodes.container:
    """Take the code of cells out of them and return it as one folded cell."""
    source = cells[0][0].copy()
    whole = cells[0].copy()
    for cell in cells:
        source += cell[0].children
        del cell[0]
        cell["classes"] = [name for name in cell["classes"] if not name.startswith("tag_")]
        if not cell.children:
            cell.parent.remove(cell)
    whole += source
    return whole


def end_of_own_text(section: nodes.section) -> int:
    """Return the place before a section's first subsection, or its end."""
    below = (i for i, child in enumerate(section.children) if isinstance(child, nodes.section))
    return next(below, len(section.children))


def leave_out_unfilled(cell: nodes.Element) -> None:
    """Remove what a cell says of an exercise that nobody has filled in."""
    for output in [one for one in cell.children if one.get("nb_element") == OUTPUT]:
        for said in list(output.findall(nodes.literal_block)):
            lines = [line for line in said.astext().splitlines() if line.strip() != UNFILLED]
            said.rawsource = "\n".join(lines)
            said.children = []
            said.append(nodes.Text(said.rawsource))
            if not said.rawsource.strip():
                said.parent.remove(said)
        if not output.astext().strip():
            cell.remove(output)


def setup(app: Sphinx) -> ExtensionMetadata:
    """Register the transform with Sphinx."""
    app.add_post_transform(OneCodeBox)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
