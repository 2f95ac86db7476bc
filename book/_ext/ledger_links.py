"""Link the book and the table of claims both ways, and show that table.

An id such as E-34 in the text becomes a link to its row. A chapter that claims name as their
evidence has a folded box of these claims with their verdicts, at the end of its section "Against
the print" or, without one, at its own end. All come from results/claims.json, which the chapters
have written when the pages are built.
"""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.transforms.post_transforms import SphinxPostTransform
from sphinx.util.docutils import SphinxDirective
from sphinx.util.typing import ExtensionMetadata

from lizarraga2025.ledger import cite
from lizarraga2025.ledger.claims import from_content
from lizarraga2025.ledger.page import ledger_table

PAGE = cite.PAGE.removesuffix(".html")
AUDIT = "Against the print"
ID = re.compile(r"(\b(?:E|B|T|F|S|TH)-\d+(?:\.\d+)*\b)")
NO_TEXT = (nodes.literal, nodes.literal_block, nodes.reference, nodes.title, nodes.raw, nodes.math)


class LedgerLinks(SphinxPostTransform):
    """Turn ids into links, and name the claims that rest on a chapter."""

    default_priority = 950
    formats = ("html",)

    def run(self, **kwargs: Any) -> None:
        ledger = {entry["id"]: entry for entry in read_ledger(self.app)}
        if not ledger or PAGE not in self.env.found_docs:
            return
        page = self.app.builder.get_relative_uri(self.env.docname, PAGE)
        for text in list(self.document.findall(nodes.Text)):
            parts = ID.split(text)
            if len(parts) > 1 and parent_of(text, NO_TEXT) is None:
                linked = [link(p, page) if p in ledger else nodes.Text(p) for p in parts]
                text.parent.replace(text, linked)
        chapter = re.sub(r"^chapters/\d\d_", "", self.env.docname)
        evidence = ((one, one["evidence"]["chapter"].partition("#")[0]) for one in ledger.values())
        if own := [one for one, place in evidence if place == chapter]:
            sections = list(self.document.findall(nodes.section))
            audits = [part for part in sections if title_of(part) == AUDIT]
            [*audits, sections[0]][0].append(box(own, page))


def read_ledger(app: Sphinx) -> list[dict[str, Any]]:
    """Return the recorded entries; none where no ledger has been written."""
    file = Path(app.confdir).parent / "results" / "claims.json"
    return json.loads(file.read_text(encoding="utf-8"))["claims"] if file.is_file() else []


def parent_of(node: nodes.Node | None, kinds: tuple[type[nodes.Element], ...]) -> Any:
    """Return the nearest node of one of the kinds that is this one or holds it, if there is one."""
    while node is not None and not isinstance(node, kinds):
        node = node.parent
    return node


def title_of(section: nodes.section) -> str:
    """Return the title of a section; the text of a theorem is a section without one."""
    first = section.next_node()
    return first.astext() if isinstance(first, nodes.title) else ""


def link(name: str, page: str) -> nodes.reference:
    anchor = name.lower().replace(".", "-")
    return nodes.reference("", name, internal=True, refuri=f"{page}#{anchor}")


def box(entries: list[dict[str, Any]], page: str) -> nodes.admonition:
    """Return the folded box: "E-34, eq. (34), proof of Theorem 2: confirmed with a condition"."""
    number = "One statement" if len(entries) == 1 else f"{len(entries)} statements"
    items = nodes.bullet_list()
    for one in entries:
        verdict = one["likeliest"]
        badge = nodes.inline("", verdict, classes=["verdict", f"verdict-{nodes.make_id(verdict)}"])
        where = nodes.Text(f", {one['where']}: ")
        line = nodes.paragraph("", "", link(one["id"], page), where, badge, classes=["in-ledger"])
        items += nodes.list_item("", line)
    title = nodes.title("", f"{number} of the paper, judged")
    return nodes.admonition("", title, items, classes=["dropdown", "claims-box"])


class ClaimsTable(SphinxDirective):
    """Show every claim, ``{claims}``: what is said, how it is read, the verdict and the numbers."""

    def run(self) -> list[nodes.Node]:
        self.env.note_dependency(str(Path(self.env.app.confdir).parent / "results" / "claims.json"))
        ledger = [from_content(content) for content in read_ledger(self.env.app)]
        return [nodes.raw("", ledger_table(ledger), format="html")]


def setup(app: Sphinx) -> ExtensionMetadata:
    """Register links and directive with Sphinx."""
    app.add_post_transform(LedgerLinks)
    app.add_directive("claims", ClaimsTable)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
