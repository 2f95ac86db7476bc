"""How to cite the paper, this package, and one entry of the ledger, in BibTeX."""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Mapping
from importlib import resources
from typing import Any, Final

from lizarraga2025.ledger.claims import Claim
from lizarraga2025.ledger.latex import escaped
from lizarraga2025.recorded import file_stem
from qbound import __version__

YEAR: Final = 2026
"""Of the release; a test compares it with CITATION.cff."""

RULES: Final = {
    "paper": "Region by the paper's rule",
    "clearance": "Region by the clearance rule",
    "none": "",
}

PAPER: Final = r"""@article{Lizarraga2025,
  author  = {Lizarraga, J. A. and Navarro, D. M. and Mata-Romero, M. E. and Luque-Vega, L. F. and
             Gonz{\'a}lez-Jim{\'e}nez, L. E. and Carrasco-Navarro, R. and Castro-Tapia, S. and
             Guerrero-Osuna, H. A. and L{\'o}pez-Neri, E.},
  title   = {Defining Feasible Joint and Geometric Workspaces Through Boundary Functions},
  journal = {Applied Sciences},
  year    = {2025},
  volume  = {15},
  number  = {10},
  pages   = {5383},
  doi     = {10.3390/app15105383}
}"""


def page() -> str:
    """Return the page of the book that shows the ledger."""
    file = resources.files("lizarraga2025") / "ledger" / "book.toml"
    chapter = tomllib.loads(file.read_text(encoding="utf-8"))["chapter"]
    return f"chapters/{file_stem(chapter)}.html"


TITLE = "qbound: feasible joint and geometric workspaces of robots through boundary functions"


def package() -> str:
    """Return the BibTeX entry of this version of the package."""
    return f"""@software{{qbound,
  author  = {{{{qbound maintainers}}}},
  title   = {{{TITLE}}},
  version = {{{__version__}}},
  year    = {{{YEAR}}}
}}"""


def entry(claim: Claim) -> str:
    """Return the BibTeX entry of one claim: its place in the paper, verdict, anchor, version."""
    return f"""@misc{{qbound-{claim.id},
  author       = {{{{qbound maintainers}}}},
  title        = {{{{What holds, entry {claim.id}: {escaped(claim.where)}}}}},
  howpublished = {{qbound {__version__}, {escaped(page())}\\#{claim.anchor}}},
  year         = {{{YEAR}}},
  note         = {{Verdict: {claim.verdict}. On Lizarraga et al. 2025, doi:10.3390/app15105383}}
}}"""


def result(recorded: Mapping[str, Any]) -> str:
    """Return the BibTeX entry of a recorded result: value, error, robots, version, place."""
    robots = "; ".join(f"{name}, sha256 {sha}" for name, sha in recorded["robots"].items())
    unit = "" if recorded["unit"] == "1" else f" {recorded['unit']}"
    error = f", error at most {recorded['error']:g}{unit}" if recorded["error"] else ""
    about = [recorded["reference"], RULES[recorded["rule"]], f"Robots: {robots}" if robots else ""]
    words = [f"{value_text(recorded['value'])}{unit}{error}", *filter(None, about)]
    return f"""@misc{{qbound-{anchor(recorded["id"])},
  author       = {{{{qbound maintainers}}}},
  title        = {{{{Result {escaped(recorded["id"])}}}}},
  howpublished = {{qbound {recorded["version"]}, results.html\\#{anchor(recorded["id"])}}},
  year         = {{{YEAR}}},
  note         = {{{escaped(". ".join(words))}. On Lizarraga et al. 2025, doi:10.3390/app15105383}}
}}"""


def anchor(name: str) -> str:
    """Return a result's anchor on the page of results."""
    return "result-" + "-".join(re.findall(r"[a-z0-9]+|(?<![a-z0-9])-(?=[0-9])", name.lower()))


def value_text(value: Any) -> str:
    """Return a value as it is printed: numbers with the digits recorded, lists in brackets."""
    return json.dumps(value, ensure_ascii=False) if not isinstance(value, str) else value
