"""Link words of the glossary in the chapters, at their first mention in each section.

Words that the chapters also use in another sense are left to their authors: {term}`arc <Arc>`.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

from docutils import nodes
from ledger_links import parent_of
from sphinx.application import Sphinx
from sphinx.transforms.post_transforms import SphinxPostTransform
from sphinx.util.nodes import make_refnode
from sphinx.util.typing import ExtensionMetadata

# A component of a boundary function, the arc of an inequality, the branch of an arctangent.
AMBIGUOUS = {"allowed", "arc", "branch", "claim", "component", "configuration", "margin", "safe"}

# Words that mean the paper's robot: in chapters on other robots and programs they mean others.
OF_THE_ROBOT = {"floor", "tool", "vertex"}
OTHER_ROBOTS = ("obstacles", "your_own_robot", "three_joints", "real_arm", "many_robots", "by_side")

PLURALS = {"vertex": "vertices"}
NO_PROSE = (
    nodes.caption,
    nodes.emphasis,
    nodes.literal,
    nodes.literal_block,
    nodes.math,
    nodes.raw,
    nodes.reference,
    nodes.rubric,
    nodes.table,
    nodes.title,
)


class GlossaryLinks(SphinxPostTransform):
    """Turn the first mention of each word in a section of a chapter into a link."""

    default_priority = 960  # after the ledger's ids have become links
    formats = ("html",)

    def run(self, **kwargs: Any) -> None:
        homes = dict(self.words())
        if self.env.docname.endswith(OTHER_ROBOTS):
            homes = {word: home for word, home in homes.items() if word not in OF_THE_ROBOT}
        if not homes or not self.env.docname.startswith("chapters/"):
            return
        forms = sorted((form for word in homes for form in forms_of(word)), key=len, reverse=True)
        pattern = re.compile(rf"\b(?:{'|'.join(forms)})\b", re.IGNORECASE)
        seen: dict[nodes.section, set[str]] = {}
        for text in list(self.document.findall(nodes.Text)):
            if is_prose(text):
                section = section_of(text)
                known = seen.setdefault(section, self.linked_in(section))
                if parts := list(self.split(text, pattern, homes, known)):
                    text.parent.replace(text, parts)

    def words(self) -> Iterator[tuple[str, tuple[str, str]]]:
        """Yield every word that may be linked with its page and anchor."""
        terms = self.env.domains.standard_domain.objects
        for (kind, name), home in terms.items():
            for word in name.lower().replace("’", "'").split(", ") if kind == "term" else ():
                if word not in AMBIGUOUS:
                    yield word, home

    def linked_in(self, section: nodes.section) -> set[str]:
        """Return the anchors of the words that an author has linked in a section's own text."""
        links = [link for link in section.findall(nodes.reference) if section_of(link) is section]
        anchors = (link.get("refuri", "").partition("#")[2] for link in links)
        return {anchor for anchor in anchors if anchor.startswith("term-")}

    def split(
        self,
        text: nodes.Text,
        pattern: re.Pattern[str],
        homes: dict[str, tuple[str, str]],
        known: set[str],
    ) -> Iterator[nodes.Node]:
        """Yield the parts of a text with a new word, that word as a link."""
        done = 0
        for match in pattern.finditer(text.astext().replace("’", "'")):
            page, anchor = homes[word_of(match[0], homes)]
            if anchor not in known:
                known.add(anchor)
                yield nodes.Text(text[done : match.start()])
                yield self.link(text[match.start() : match.end()], page, anchor)
                done = match.end()
        if done:
            yield nodes.Text(text[done:])

    def link(self, shown: str, page: str, anchor: str) -> nodes.reference:
        words = nodes.inline("", shown, classes=["std", "std-term"])
        reference = make_refnode(self.app.builder, self.env.docname, page, anchor, words)
        reference["classes"].append("glossary-word")
        return reference


def forms_of(word: str) -> list[str]:
    """Return a word as a pattern, and its plural."""
    if word in PLURALS:
        return [word, PLURALS[word]]
    return [re.escape(word)] if word.endswith(("rule", "pose")) else [re.escape(word) + "s?"]


def word_of(found: str, words: dict[str, tuple[str, str]]) -> str:
    """Return the word of the glossary whose singular or plural was found."""
    lower = found.lower()
    singular = {plural: word for word, plural in PLURALS.items()}.get(lower, lower)
    return singular if singular in words else singular.removesuffix("s")


def is_prose(text: nodes.Text) -> bool:
    """Tell whether a text stands in a paragraph of an author's, not in a line of links."""
    paragraph = parent_of(text, (nodes.paragraph,))
    ours = paragraph is None or "in-ledger" in paragraph["classes"]
    return not ours and parent_of(text, NO_PROSE) is None


def section_of(node: nodes.Node) -> Any:
    return parent_of(node, (nodes.section,))


def setup(app: Sphinx) -> ExtensionMetadata:
    """Register the links with Sphinx."""
    app.add_post_transform(GlossaryLinks)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
