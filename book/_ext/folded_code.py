"""What a page shows of a chapter's code: one "Show the code" a section, no unanswered exercise.

A chapter folds the cells that a reader can do without (the tag ``hide-input``). On a page all
folded code of a section stands in one box at the section's end, in the order in which it runs; what
the cells show stays in its place. A page cannot run a cell, so an exercise's "Not filled in yet" is
left out there, and the section says where its cells run.
"""

from __future__ import annotations

from typing import Any

from docutils import nodes
from ledger_links import parent_of, title_of
from sphinx.application import Sphinx
from sphinx.transforms.post_transforms import SphinxPostTransform
from sphinx.util.typing import ExtensionMetadata

from lizarraga2025.exercises import UNFILLED

WHERE = (
    "Predict first, then open the solution. The cells of these exercises run in this chapter's "
    "notebook, which the foot of the page offers: there a cell says whether your value is right."
)


class OneCodeBox(SphinxPostTransform):
    """Gather the folded code of each section, and tidy its exercises."""

    default_priority = 198  # myst-nb folds at 199
    formats = ("html",)

    def run(self, **kwargs: Any) -> None:
        cells = [one for one in self.document.findall(nodes.container) if is_part(one, "cell_code")]
        for section in list(self.document.findall(nodes.section)):
            own = [cell for cell in cells if parent_of(cell, (nodes.section,)) is section]
            if own and title_of(section) == "Exercises":
                for cell in own:
                    leave_out_unfilled(cell)
                section.insert(1, nodes.paragraph("", WHERE, classes=["exercises-where"]))
            folded = [cell for cell in own if cell.get("hide_mode") == "input"]
            if folded := [cell for cell in folded if is_part(cell[0], "cell_code_source")]:
                whole = box(folded)  # first: it takes emptied cells out of the section
                below = (k for k, part in enumerate(section) if isinstance(part, nodes.section))
                section.insert(next(below, len(section)), whole)


def is_part(node: nodes.Node, kind: str) -> bool:
    """Tell whether a node is a cell, its source or its output."""
    return isinstance(node, nodes.container) and node.get("nb_element") == kind


def box(cells: list[nodes.Element]) -> nodes.container:
    """Take the code of cells out of them and return it as one folded cell."""
    whole, source = cells[0].copy(), cells[0][0].copy()
    for cell in cells:
        source += cell[0].children
        del cell[0]
        cell["classes"] = [name for name in cell["classes"] if not name.startswith("tag_")]
        if not cell.children:
            cell.parent.remove(cell)
    whole += source
    return whole


def leave_out_unfilled(cell: nodes.Element) -> None:
    """Remove what a cell says of an exercise that nobody has filled in."""
    for said in list(cell.findall(nodes.literal_block)):
        if UNFILLED in said.astext():
            left: nodes.Node = said
            while left.parent is not cell and len(left.parent) == 1:
                left = left.parent  # what held nothing else goes with it
            other = said.astext().replace(UNFILLED, "").strip()
            left.parent.replace(left, [nodes.literal_block(other, other)] if other else [])


def setup(app: Sphinx) -> ExtensionMetadata:
    """Register the transform with Sphinx."""
    app.add_post_transform(OneCodeBox)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
