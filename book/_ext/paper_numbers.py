"""Number equations, figures, tables and theorems as the paper does.

A label that names an object of the paper carries the paper's own number: ``eq:15`` is (15),
``fig:7`` is Figure 7, ``tab:6`` is Table 6, ``thm:2`` is Theorem 2. A letter marks a part:
``fig:8a`` is Figure 8a. Everything else is the book's own and is numbered N1, N2, ... within its
kind, in reading order. Two objects with one number stop the build.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator
from typing import Any

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.environment import BuildEnvironment
from sphinx.errors import ExtensionError
from sphinx.transforms import SphinxTransform
from sphinx.util.typing import ExtensionMetadata

KINDS = {"eq": "displaymath", "fig": "figure", "tab": "table", "thm": "theorem"}
PAPER_LABEL = re.compile(rf"({'|'.join(KINDS)}):(\d+[a-z]?)")

# Sphinx numbers what it finds at priority 500 of this event; the paper's numbers come after.
AFTER_SPHINX = 900


class table_figure(nodes.figure):
    """A table that a code cell prints: in the source a figure, labelled ``tab:...``."""


class TablesFromCells(SphinxTransform):
    """Give a figure labelled ``tab:...`` the number and the name of a table.

    MyST-NB can wrap the output of a code cell in a figure only.
    """

    default_priority = 200  # before Sphinx gives ids to what it will number (210)

    def apply(self, **kwargs: Any) -> None:
        for figure in list(self.document.findall(nodes.figure)):
            if any(label.startswith("tab:") for label in labels_of(figure)):
                table = table_figure(figure.rawsource, *figure.children, **figure.attributes)
                table["classes"].append("table-figure")  # the style sheet puts its caption on top
                figure.replace_self(table)
                self.document.ids.update(dict.fromkeys(table["ids"], table))


def labels_of(node: nodes.Element) -> list[str]:
    """Return the labels of a node, those that docutils has set aside as duplicates too."""
    own = [node["label"]] if node.get("label") else []
    return [*own, *node["names"], *node["dupnames"]]


def paper_numbers(doctree: nodes.document) -> Iterator[tuple[str, str, str]]:
    """Yield every label of the paper on a page with the id of its object and its number."""
    for node in doctree.findall(nodes.Element):
        if node["ids"] and not isinstance(node, nodes.target):
            for label in dict.fromkeys(labels_of(node)):
                if match := PAPER_LABEL.fullmatch(label):
                    yield label, node["ids"][0], match[2]


def use_paper_numbers(app: Sphinx, env: BuildEnvironment) -> list[str]:
    """Replace Sphinx's numbers by the paper's, or by N1, N2, ... for the book's own."""
    own: Counter[str] = Counter()
    home: dict[str, str] = {}
    for page, numbered in env.toc_fignumbers.items():  # in reading order
        paper: dict[tuple[str, str], str] = {}
        for label, node_id, number in paper_numbers(env.get_doctree(page)):
            kind = KINDS[label.partition(":")[0]]
            if label in home:
                raise ExtensionError(f"{label} appears twice: in {home[label]} and in {page}")
            if node_id not in numbered.get(kind, {}):  # fig:7 on a table, say
                problem = f"labels no numbered {kind} (is a caption missing?)"
                raise ExtensionError(f"{label} in {page} {problem}")
            home[label] = page
            paper[kind, node_id] = number
        for kind, numbers in numbered.items():
            for node_id in numbers:
                own[kind] += (kind, node_id) not in paper
                numbers[node_id] = (paper.get((kind, node_id), f"N{own[kind]}"),)
    return list(env.found_docs)  # any page may refer to a number that has changed


def setup(app: Sphinx) -> ExtensionMetadata:
    """Register the numbering with Sphinx."""
    as_figure = (
        lambda translator, node: translator.visit_figure(node),
        lambda translator, node: translator.depart_figure(node),
    )
    app.add_enumerable_node(table_figure, "table", html=as_figure)
    app.add_transform(TablesFromCells)
    app.connect("env-get-updated", use_paper_numbers, priority=AFTER_SPHINX)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
