"""Link the book and the table of claims both ways; show verdicts and that table.

An id such as E-34 in the text becomes a link to its row. A chapter that claims name as their
evidence has a folded box of these claims with their verdicts, at the end of its section "Against
the print" or, without one, at its own end. All come from results/claims.json, which the chapters
have written when the pages are built.
"""

from __future__ import annotations

import re
from functools import cache
from typing import Any

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.transforms.post_transforms import SphinxPostTransform
from sphinx.util.docutils import SphinxDirective, SphinxRole
from sphinx.util.typing import ExtensionMetadata

from lizarraga2025 import recorded
from lizarraga2025.ledger import cite
from lizarraga2025.ledger.claims import Claim, from_content
from lizarraga2025.ledger.page import ledger_table
from lizarraga2025.verdicts import VERDICTS

PAGE = cite.PAGE.removesuffix(".html")
ID = re.compile(r"(\b(?:E|B|T|F|S|TH)-\d+(?:\.\d+)*\b)")
NO_TEXT = (nodes.literal, nodes.literal_block, nodes.reference, nodes.title, nodes.raw, nodes.math)


@cache
def ledger() -> list[Claim]:
    return [from_content(content) for content in recorded.claims()]


class LedgerLinks(SphinxPostTransform):
    """Turn ids into links, and name the claims that rest on a chapter."""

    default_priority = 950
    formats = ("html",)

    def run(self, **kwargs: Any) -> None:
        if PAGE not in self.env.found_docs:
            return
        page = self.app.builder.get_relative_uri(self.env.docname, PAGE)
        links = {claim.id: link(claim, page) for claim in ledger()}
        no_text = self.document.findall(lambda node: isinstance(node, NO_TEXT))
        left = {id(text) for node in no_text for text in node.findall(nodes.Text)}
        for text in list(self.document.findall(nodes.Text)):
            parts = ID.split(text)
            if len(parts) > 1 and id(text) not in left:
                linked = [links[p].deepcopy() if p in links else nodes.Text(p) for p in parts]
                text.parent.replace(text, linked)
        chapter = re.sub(r"^chapters/\d\d_", "", self.env.docname)
        if own := [one for one in ledger() if one.evidence.chapter.partition("#")[0] == chapter]:
            sections = list(self.document.findall(nodes.section))
            audits = [part for part in sections if "against-the-print" in part["ids"]]
            [*audits, sections[0]][0].append(box(own, page))


def link(claim: Claim, page: str) -> nodes.reference:
    return nodes.reference("", claim.id, internal=True, refuri=f"{page}#{claim.anchor}")


def badge(verdict: str) -> nodes.inline:
    return nodes.inline("", verdict, classes=["verdict", f"verdict-{nodes.make_id(verdict)}"])


def box(claims: list[Claim], page: str) -> nodes.admonition:
    """Return the folded box: "E-34, eq. (34), proof of Theorem 2: confirmed with a condition"."""
    number = "One statement" if len(claims) == 1 else f"{len(claims)} statements"
    items = nodes.bullet_list()
    for one in claims:
        where = nodes.Text(f", {one.where}: ")
        line = [link(one, page), where, badge(one.likeliest)]
        items += nodes.list_item("", nodes.paragraph("", "", *line, classes=["in-ledger"]))
    title = nodes.title("", f"{number} of the paper, judged")
    return nodes.admonition("", title, items, classes=["dropdown", "claims-box"])


class VerdictRole(SphinxRole):
    """Show one of the ledger's verdicts as a badge: {verdict}`confirmed`."""

    def run(self) -> tuple[list[nodes.Node], list[nodes.system_message]]:
        if self.text in VERDICTS:
            return [badge(self.text)], []
        problem = f"unknown verdict {self.text!r}: one of {', '.join(VERDICTS)}"
        return [], [self.inliner.reporter.error(problem, line=self.lineno)]


class ClaimsTable(SphinxDirective):
    """Show every claim, ``{claims}``: what is said, how it is read, the verdict and the numbers."""

    def run(self) -> list[nodes.Node]:
        return [nodes.raw("", ledger_table(ledger()), format="html")]


def setup(app: Sphinx) -> ExtensionMetadata:
    """Register links, role and directive with Sphinx."""
    app.add_post_transform(LedgerLinks)
    app.add_role("verdict", VerdictRole())
    app.add_directive("claims", ClaimsTable)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
