"""How to cite the paper, this package, and one entry of the ledger, in BibTeX."""

from __future__ import annotations

import tomllib
from importlib import resources
from typing import Final

from lizarraga2025.ledger.claims import Claim
from qbound import __version__

YEAR: Final = 2026
"""Of the release; a test compares it with CITATION.cff."""

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
    return str(tomllib.loads(file.read_text(encoding="utf-8"))["page"])


def package() -> str:
    """Return the BibTeX entry of this version of the package."""
    return f"""@software{{qbound,
  author  = {{{{qbound maintainers}}}},
  title   = {{qbound: feasible joint and geometric workspaces through boundary functions}},
  version = {{{__version__}}},
  year    = {{{YEAR}}}
}}"""


def entry(claim: Claim) -> str:
    """Return the BibTeX entry of one claim: its place in the paper, verdict, anchor, version."""
    return f"""@misc{{qbound-{claim.id},
  author       = {{{{qbound maintainers}}}},
  title        = {{{{What holds, entry {claim.id}: {_escaped(claim.where)}}}}},
  howpublished = {{qbound {__version__}, {_escaped(page())}\\#{claim.anchor}}},
  year         = {{{YEAR}}},
  note         = {{Verdict: {claim.verdict}. On Lizarraga et al. 2025, doi:10.3390/app15105383}}
}}"""


def _escaped(text: str) -> str:
    """Keep TeX's special characters as they are read."""
    return "".join(f"\\{c}" if c in "_#%&$" else c for c in text)
