"""Link the book and the table of claims both ways, and show that table.

An id such as E-34 in the text becomes a link to its row. A chapter that claims name as their
evidence ends with a folded box of these claims with their verdicts. All come from
results/claims.json, which the chapters have written when the pages are built.
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
ID = re.compile(r"\b(?:E|B|T|F|S|TH)-\d+(?:\.\d+)*\b")
NO_TEXT = (nodes.literal, nodes.literal_block, nodes.reference, nodes.title, nodes.raw, nodes.math)


class LedgerLinks(SphinxPostTransform):
    """Turn ids into links, and name the claims that rest on a chapter at its end."""

    default_priority = 950
    formats = ("html",)

    def run(self, **kwargs: Any) -> None:
        ledger = read_ledger(self.app)
        if not ledger or PAGE not in self.env.found_docs:
            return
        page = self.app.builder.get_relative_uri(self.env.docname, PAGE)
        self.link_ids({entry["id"] for entry in ledger}, page)
        chapter = re.sub(r"^chapters/\d\d_", "", self.env.docname)
        own = [one for one in ledger if one["evidence"]["chapter"].partition("#")[0] == chapter]
        if own:
            next(self.document.findall(nodes.section)).append(box(own, page))

    def link_ids(self, known: set[str], page: str) -> None:
        for text in list(self.document.findall(nodes.Text)):
            if parent_of(text, NO_TEXT) is None and ID.search(text):
                text.parent.replace(text, with_links(text, known, page))


def read_ledger(app: Sphinx) -> list[dict[str, Any]]:
    """Return the recorded entries; none where no ledger has been written."""
    file = Path(app.confdir).parent / "results" / "claims.json"
    return json.loads(file.read_text(encoding="utf-8"))["claims"] if file.is_file() else []


def parent_of(node: nodes.Node | None, kinds: tuple[type[nodes.Element], ...]) -> Any:
    """Return the nearest node of one of the kinds that is this one or holds it, if there is one."""
    while node is not None and not isinstance(node, kinds):
        node = node.parent
    return node


def with_links(text: nodes.Text, known: set[str], page: str) -> list[nodes.Node]:
    """Split a text at the ids of entries."""
    parts: list[nodes.Node] = []
    done = 0
    for match in ID.finditer(text):
        if match[0] in known:
            parts += [nodes.Text(text[done : match.start()]), link(match[0], page)]
            done = match.end()
    return [*parts, nodes.Text(text[done:])]


def link(name: str, page: str) -> nodes.reference:
    anchor = name.lower().replace(".", "-")
    return nodes.reference("", name, internal=True, refuri=f"{page}#{anchor}")


def box(entries: list[dict[str, Any]], page: str) -> nodes.admonition:
    """Return the folded box of the claims of a chapter: where in the paper, and the verdict."""
    number = "One statement" if len(entries) == 1 else f"{len(entries)} statements"
    title = nodes.title("", f"{number} of the paper, judged")
    items = nodes.bullet_list("", *(nodes.list_item("", verdict(one, page)) for one in entries))
    return nodes.admonition("", title, items, classes=["dropdown", "claims-box"])


def verdict(entry: dict[str, Any], page: str) -> nodes.paragraph:
    """Return the line "E-34, eq. (34), proof of Theorem 2: confirmed with a condition"."""
    kind = nodes.make_id(entry["likeliest"])
    badge = nodes.inline("", entry["likeliest"], classes=["verdict", f"verdict-{kind}"])
    where = nodes.Text(f", {entry['where']}: ")
    name = link(entry["id"], page)
    return nodes.paragraph("", "", name, where, badge, classes=["in-ledger"])


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
