"""What would a second printing change? Formulas exactly as printed, and as they would hold.

``statements/errata.toml`` has them by entry; those of Table 6 follow from the printed formulas.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterable, Mapping
from functools import cache
from importlib import resources

from lizarraga2025 import printed as paper
from lizarraga2025.ledger.claims import Claim
from lizarraga2025.typeset import latex

Change = tuple[str, str]
"""What is printed and what is proposed; TeX between dollar signs."""


def errata(ledger: Iterable[Claim]) -> list[Claim]:
    """Return the entries that a second printing would change, in the order of the ledger.

    They are misprints, refuted statements, statements that say nothing where another would, and all
    that rest on a finding for which ``errata.toml`` has a change.
    """
    return [one for one in ledger if _is_erratum(one)]


def _is_erratum(one: Claim) -> bool:
    if one.verdict in ("misprint", "refuted") or one.finding in _typed():
        return True
    return one.verdict == "true but says nothing" and bool(one.corrected)


def change(name: str) -> Change | None:
    """Return what an entry would change, if it is a formula."""
    return _typed().get(name) or _of_table_6(name)


@cache
def _typed() -> Mapping[str, Change]:
    file = resources.files("lizarraga2025") / "ledger" / "statements" / "errata.toml"
    found = tomllib.loads(file.read_text(encoding="utf-8"))
    return {name: (entry["printed"], entry["proposed"]) for name, entry in found.items()}


def _of_table_6(name: str) -> Change | None:
    """Return a bound, or those of a row that change, with the arccosine's sign turned round."""
    labels = [label for label in paper.TABLE_6 if name in (_bound(label), _row(label))]
    if name.startswith("T-") and labels and paper.indices(labels[0])[0] > 4:
        labels = labels[1:]  # of a wall the upper bound stands
    if not labels:
        return None
    printed = _in_tex({label: paper.TABLE_6[label] for label in labels})
    other = {label: paper.TABLE_6[label].replace("- acos", "+ acos") for label in labels}
    return printed, _in_tex(other)


def _in_tex(bounds: Mapping[str, str]) -> str:
    return "; ".join(rf"$\{label} = {latex(text)}$" for label, text in bounds.items())


def _bound(label: str) -> str:
    return "B-{}.{}.{}".format(*paper.indices(label))


def _row(label: str) -> str:
    """Return the entry of a bound's row, such as T-6.4 for the two bounds of beta_{2,3}."""
    component = re.sub(r",\d\}$", "}", label)
    return f"T-6.{list(paper.EQUATION_29).index(component) + 1}"
