"""The ledger as a table of a web page: whole without a script, filtered and searched with one."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from html import escape

from lizarraga2025.ledger import cite
from lizarraga2025.ledger.claims import Claim
from lizarraga2025.ledger.entries import KINDS
from lizarraga2025.verdicts import VERDICTS

WORDS = '<input type="search" name="words" autocomplete="off"'
HEADER = ("Entry", "What the paper says", "Verdict", "What was found")


def ledger_table(ledger: Sequence[Claim]) -> str:
    """Return the ledger as HTML: a form that the page's script shows, and the table with all rows.

    Each row has the entry's anchor as its id and carries its kind and verdict, a link to the
    chapter that shows the evidence, the test, and the BibTeX entry to unfold.
    """
    rows = "\n".join(_row(one) for one in ledger)
    head = "".join(f'<th scope="col">{name}</th>' for name in HEADER)
    return (
        f'<div class="ledger">\n{_controls()}\n<table class="ledger-table">\n'
        f"<caption>The ledger: {len(ledger)} statements of the paper.</caption>\n"
        f"<thead><tr>{head}</tr></thead>\n<tbody>\n{rows}\n</tbody>\n</table>\n</div>"
    )


def errata_table(ledger: Iterable[Claim]) -> str:
    """Return printed, proposed and why for some entries, each with the command that repeats it."""
    rows = "\n".join(_erratum(one) for one in ledger)
    names = ("Entry", "Printed", "Proposed", "Why")
    head = "".join(f'<th scope="col">{name}</th>' for name in names)
    return (
        f'<table class="ledger-table errata-table">\n<thead><tr>{head}</tr></thead>\n'
        f"<tbody>\n{rows}\n</tbody>\n</table>"
    )


def badge(verdict: str) -> str:
    """Return a verdict as the book shows it."""
    return f'<span class="verdict verdict-{verdict.replace(" ", "-")}">{verdict}</span>'


def link_to_chapter(one: Claim) -> str:
    """Return a link to the place in the book that shows the evidence."""
    chapter, _, anchor = one.evidence.chapter.partition("#")
    return f'<a href="{chapter}.html#{escape(anchor)}">Chapter {int(chapter[:2])}</a>'


def typeset(text: str) -> str:
    """Return plain text as HTML: β_{1,1} and q_1 with subscripts, a minus sign for a hyphen."""
    text = re.sub(r"(?<=[\s(\[])-(?=[\s\w(])", "\N{MINUS SIGN}", text)
    return re.sub(r"(?<=\w)_(?:\{([^}]*)\}|([A-Za-z0-9]+))", r"<sub>\1\2</sub>", escape(text))


def _row(one: Claim) -> str:
    cells = (
        f'<th scope="row"><a href="#{one.anchor}">{one.id}</a></th>',
        f'<td><span class="ledger-where">{typeset(one.where)}</span> {typeset(one.says)}</td>',
        f"<td>{badge(one.verdict)}</td>",
        f"<td>{typeset(one.found)}{_corrected(one)}{_evidence(one)}{_citation(one)}</td>",
    )
    data = f'data-kind="{one.kind}" data-verdict="{one.verdict}"'
    return f'<tr id="{one.anchor}" {data}>{"".join(cells)}</tr>'


def _corrected(one: Claim) -> str:
    if not one.corrected:
        return ""
    return f'<p class="ledger-corrected"><b>Holds:</b> {typeset(one.corrected)}</p>'


def _evidence(one: Claim) -> str:
    test = escape(one.evidence.test).replace("::", "::<wbr>").replace("_", "_<wbr>")
    return f'<p class="ledger-evidence">{link_to_chapter(one)}; <code>{test}</code></p>'


def _citation(one: Claim) -> str:
    return (
        f"<details><summary>Cite {one.id}</summary><pre>{escape(cite.entry(one))}</pre></details>"
    )


def _erratum(one: Claim) -> str:
    ledger = f'<a href="{cite.page().rpartition("/")[2]}#{one.anchor}">{one.id}</a>'
    words = (f"qbound claims {one.id}", "--recompute")
    again = " ".join(f'<span class="unbroken">{word}</span>' for word in words)
    repeat = f"{link_to_chapter(one)}; <code>{again}</code>"
    why = f'{typeset(one.found)}<p class="ledger-evidence">{repeat}</p>'
    return (
        f'<tr><th scope="row">{ledger}<br>{badge(one.verdict)}</th>'
        f'<td><span class="ledger-where">{typeset(one.where)}</span> {typeset(one.says)}</td>'
        f"<td>{typeset(one.corrected)}</td>"
        f"<td>{why}</td></tr>"
    )


def _controls() -> str:
    return (
        '<form class="ledger-controls" role="search" aria-label="Filter the ledger" hidden>\n'
        f"{_choice('verdict', 'Verdict', VERDICTS)}\n{_choice('kind', 'Kind', KINDS)}\n"
        f"{_labelled('words', 'Search', WORDS)}</div>\n"
        '<button type="reset">Show all</button>\n'
        '<output class="ledger-count" aria-live="polite"></output>\n</form>'
    )


def _choice(name: str, label: str, values: Sequence[str]) -> str:
    options = "".join(f'<option value="{value}">{value}</option>' for value in ("", *values))
    options = options.replace('value=""></option>', 'value="">all</option>')
    select = _labelled(name, label, f'<select name="{name}"')
    return f"{select}{options}</select></div>"


def _labelled(name: str, label: str, control: str) -> str:
    """Return a label and the control that it is for, up to the control's first tag."""
    return f'<div><label for="ledger-{name}">{label}</label>{control} id="ledger-{name}">'
