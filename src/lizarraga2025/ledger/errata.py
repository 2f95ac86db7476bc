"""The errata: formulas exactly as printed, and as they would hold.

``statements/errata.toml`` has them by entry; those of Table 6 follow from the printed formulas.
"""

import re
import tomllib
from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from importlib import resources

from lizarraga2025 import printed as paper
from lizarraga2025.ledger.claims import Claim
from lizarraga2025.typeset import latex

Change = tuple[str, str]
"""What is printed and what is proposed: lines of text, TeX between dollar signs."""


def errata(ledger: Iterable[Claim]) -> dict[str, list[Claim]]:
    """Return what a second printing would change: the entries of each part, by the one that leads.

    They are misprints in their likeliest reading; and, in their most favourable one, misprints,
    refuted statements, statements that say nothing where another would, and conditions that a
    `change` would put into print. A part is a finding; a row of Table 6 that
    changes is a part of its own, with its bounds.
    """
    parts: dict[str, list[Claim]] = {}
    for one in ledger:
        if _is_erratum(one):
            parts.setdefault(_part(one), []).append(one)
    return {_leader(name, entries): entries for name, entries in parts.items()}


def _is_erratum(one: Claim) -> bool:
    if one.likeliest == "misprint" or one.most_favourable in ("misprint", "refuted"):
        return True
    if one.most_favourable == "vacuous":
        return bool(one.corrected)
    is_conditional = one.most_favourable == "confirmed with a condition"
    return is_conditional and change(one.finding) is not None


def _part(one: Claim) -> str:
    rows = {_row(label) for label in paper.TABLE_6 if one.id in (_bound(label), _row(label))}
    return rows.pop() if rows and _of_table_6(one.finding) else one.finding


def _leader(part: str, entries: Sequence[Claim]) -> str:
    """Return the entry after which a part is named, or its first where that one changes nothing."""
    return part if part in {one.id for one in entries} else entries[0].id


def change(name: str) -> Change | None:
    """Return what an entry would change, if it is a formula."""
    return _typed().get(name) or _of_table_6(name)


@cache
def _typed() -> Mapping[str, Change]:
    file = resources.files("lizarraga2025") / "ledger" / "statements" / "errata.toml"
    found = tomllib.loads(file.read_text(encoding="utf-8"))
    return {name: (entry["printed"], entry["proposed"]) for name, entry in found.items()}


def _of_table_6(row: str) -> Change | None:
    """Return the bounds of a row that change, with the other sign before the arccosine."""
    labels = [label for label in paper.TABLE_6 if row == _row(label)]
    if not labels:
        return None
    if paper.indices(labels[0])[0] > 4:
        labels = labels[1:]  # of a wall the upper bound stands
    printed = {label: paper.TABLE_6[label] for label in labels}
    other = {label: text.replace("- acos", "+ acos") for label, text in printed.items()}
    return _in_tex(printed), _in_tex(other)


def _in_tex(bounds: Mapping[str, str]) -> str:
    return "\n".join(rf"$\{label} = {latex(text)}$" for label, text in bounds.items())


def _bound(label: str) -> str:
    return "B-{}.{}.{}".format(*paper.indices(label))


def _row(label: str) -> str:
    """Return the entry of a bound's row, such as T-6.4 for the two bounds of beta_{2,3}."""
    component = re.sub(r",\d\}$", "}", label)
    return f"T-6.{list(paper.EQUATION_29).index(component) + 1}"
