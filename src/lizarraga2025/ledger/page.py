"""The claims as a table of a web page: whole without a script, filtered and searched with one."""

import re
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from html import escape

from lizarraga2025.ledger import cite, errata
from lizarraga2025.ledger.claims import KINDS, SEVERITIES, Claim, findings
from lizarraga2025.recorded import called, file_stem
from lizarraga2025.verdicts import VERDICTS

WORDS = '<input type="search" name="words" autocomplete="off"'
HEADER = (
    "Claim",
    "What the paper says",
    "Likeliest reading",
    "Most favourable reading",
    "What was computed",
)
ORDERS = ("severity", "place in the paper")


def ledger_table(ledger: Sequence[Claim]) -> str:
    """Return the claims as HTML: a form that the page's script shows, and the table with all rows.

    Findings come by severity, and among equals those first on which most rests; each is a body of
    the table, with the claim that carries it first. A row has the entry's anchor as its id and
    carries what can be filtered, links to the chapter that shows the evidence, the test, and the
    BibTeX entry to unfold.
    """
    by_finding = _by_finding(ledger)
    bodies = sorted(enumerate(by_finding.values()), key=lambda body: _rank(body[1]))
    rows = "\n".join(_body(sharing, place) for place, sharing in bodies)
    head = "".join(f'<th scope="col">{name}</th>' for name in HEADER)
    return (
        f'<div class="ledger">\n{_controls()}\n<table class="ledger-table">\n'
        f"<caption>{len(ledger)} statements of the paper,"
        f" {len(findings(ledger))} findings.</caption>\n"
        f"<thead><tr>{head}</tr></thead>\n{rows}\n</table>\n</div>"
    )


def _by_finding(ledger: Iterable[Claim]) -> Mapping[str, list[Claim]]:
    """Return the entries by the finding that they rest on, the one that carries it first."""
    sharing: dict[str, list[Claim]] = defaultdict(list)
    for one in ledger:
        sharing[one.finding].insert(0 if one.id == one.finding else len(sharing[one.finding]), one)
    return sharing


def _rank(sharing: Sequence[Claim]) -> tuple[int, int]:
    """Return where a finding comes: by what hangs on it, then by how many statements fall by it."""
    falling = [SEVERITIES.index(one.severity) for one in sharing if not one.stands]
    return (min(falling), -len(falling)) if falling else (len(SEVERITIES), 0)


def _body(sharing: Sequence[Claim], place: int) -> str:
    rows = "\n".join(_row(one, sharing[0]) for one in sharing)
    return f'<tbody data-place="{place}">\n{rows}\n</tbody>'


def errata_list(parts: Mapping[str, Sequence[Claim]]) -> str:
    """Return place, printed, proposed and why for parts of the `errata`, by the entry that leads.

    Each names the entries that it is about, and the command that repeats the computation.
    """
    shown = "\n".join(_erratum(leader, entries) for leader, entries in parts.items())
    return f'<div class="errata">\n{shown}\n</div>'


def badge(verdict: str) -> str:
    """Return a verdict as the book shows it."""
    return f'<span class="verdict verdict-{verdict.replace(" ", "-")}">{verdict}</span>'


def link_to_chapter(one: Claim, folder: str = "") -> str:
    """Return a link to the place in the book that shows the evidence."""
    chapter, _, anchor = one.evidence.chapter.partition("#")
    return f'<a href="{folder}{file_stem(chapter)}.html#{escape(anchor)}">{called(chapter)}</a>'


def typeset(text: str) -> str:
    """Return plain text as HTML: β_{1,1} and q_1 with subscripts, a minus sign for a hyphen.

    What stands between dollar signs is TeX, for the script that sets the book's formulas.
    """
    parts = text.split("$")
    parts[::2] = map(_plain, parts[::2])
    parts[1::2] = (f'<span class="math notranslate">\\({escape(p)}\\)</span>' for p in parts[1::2])
    return "".join(parts)


def _plain(text: str) -> str:
    text = re.sub(r"(?<=[\s(\[])-(?=[\s\w(])", "\N{MINUS SIGN}", text)
    return re.sub(r"(?<=\w)_(?:\{([^}]*)\}|([A-Za-z0-9]+))", r"<sub>\1\2</sub>", escape(text))


def _row(one: Claim, carrier: Claim) -> str:
    severity = "" if one.stands else one.severity
    shown = f'<p class="ledger-severity">Severity: {severity}</p>' if severity else ""
    cells = (
        f'<th scope="row"><a href="#{one.anchor}">{one.id}</a></th>',
        f"<td>{_statement(one)}</td>",
        f"<td>{badge(one.likeliest)}{shown}</td>",
        f"<td>{badge(one.most_favourable)}</td>",
        f"<td>{_computed(one, carrier)}{_corrected(one)}{_evidence(one)}{_citation(one)}</td>",
    )
    data = (
        f'data-kind="{one.kind}" data-severity="{severity}" data-likeliest="{one.likeliest}"'
        f' data-favourable="{one.most_favourable}"'
    )
    under = "" if one is carrier else ' class="ledger-under"'
    return f'<tr id="{one.anchor}"{under} {data}>{"".join(cells)}</tr>'


def _statement(one: Claim) -> str:
    return (
        f'<span class="ledger-where">{typeset(one.where)}</span> {typeset(one.says)}'
        f'<p class="ledger-reading"><b>Reading:</b> {typeset(one.reading)}</p>'
    )


def _computed(one: Claim, carrier: Claim) -> str:
    """Return what was computed, or where it stands already, and the finding that it rests on."""
    if one is carrier:
        return typeset(one.computed)
    same = one.computed in (carrier.computed, f"As {carrier.id}.")
    text = "" if same else f"{typeset(one.computed)} "
    return f'{text}<span class="ledger-finding">As {_links([carrier])}.</span>'


def _links(entries: Iterable[Claim], page: str = "") -> str:
    links = (f'<a class="unbroken" href="{page}#{one.anchor}">{one.id}</a>' for one in entries)
    return ", ".join(links)


def _corrected(one: Claim) -> str:
    if not one.corrected:
        return ""
    return f'<p class="ledger-corrected"><b>Holds:</b> {typeset(one.corrected)}</p>'


def _evidence(one: Claim) -> str:
    test = escape(one.evidence.test).replace("::", "::<wbr>").replace("_", "_<wbr>")
    chapter = link_to_chapter(one, "chapters/")
    return f'<p class="ledger-evidence">{chapter}; <code>{test}</code></p>'


def _citation(one: Claim) -> str:
    text = escape(cite.entry(one))
    return f'<details><summary>Cite {one.id}</summary><pre class="bibtex">{text}</pre></details>'


def _erratum(leader: str, entries: Sequence[Claim]) -> str:
    one = next(entry for entry in entries if entry.id == leader)
    printed, proposed = errata.change(leader) or (one.says, one.corrected)
    links = _links(entries, f"../{cite.PAGE}")
    words = (f"lizarraga2025 claims {leader}", "--recompute")
    command = " ".join(f'<span class="unbroken">{word}</span>' for word in words)
    return (
        f'<dl class="erratum"><dt class="erratum-place">{typeset(one.where)}</dt>\n'
        f"<dd>{badge(one.likeliest)} {links}</dd>\n"
        f"<dt>Printed</dt><dd>{_lines(printed)}</dd>\n"
        f"<dt>Proposed</dt><dd>{_lines(proposed)}</dd>\n"
        f"<dt>Why</dt><dd>{typeset(one.computed)}"
        f'<p class="ledger-evidence">{link_to_chapter(one)}; <code>{command}</code></p></dd></dl>'
    )


def _lines(text: str) -> str:
    return "".join(f"<div>{typeset(line)}</div>" for line in text.splitlines())


def _controls() -> str:
    return (
        '<form class="ledger-controls" role="search" aria-label="Filter the claims" hidden>\n'
        f"{_choice('likeliest', 'Likeliest reading', VERDICTS)}\n"
        f"{_choice('favourable', 'Most favourable reading', VERDICTS)}\n"
        f"{_choice('severity', 'Severity', SEVERITIES)}\n{_choice('kind', 'Kind', KINDS)}\n"
        f"{_choice('order', 'Order', ORDERS, whole='')}\n"
        f"{_labelled('words', 'Search', WORDS)}</div>\n"
        '<button type="reset">Show all</button>\n'
        '<output class="ledger-count" aria-live="polite"></output>\n</form>'
    )


def _choice(name: str, label: str, values: Sequence[str], whole: str = "all") -> str:
    options = "".join(f'<option value="{value}">{value}</option>' for value in values)
    every = f'<option value="">{whole}</option>' if whole else ""
    select = _labelled(name, label, f'<select name="{name}"')
    return f"{select}{every}{options}</select></div>"


def _labelled(name: str, label: str, control: str) -> str:
    """Return a label and the control that it is for, up to the control's first tag."""
    return f'<div><label for="ledger-{name}">{label}</label>{control} id="ledger-{name}">'
