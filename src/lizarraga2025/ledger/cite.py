"""How to cite the paper, this package, and one entry of the ledger, in BibTeX.

A citation names the state of the sources: a commit, and what Software Heritage calls its tree.
Between releases the version alone does not tell one state from the next. Committed files cannot
hold the commit that they are part of, so it is asked of git when a page or a citation is made.
"""

from __future__ import annotations

import json
import re
import subprocess
import unicodedata
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, Final

from lizarraga2025 import __version__
from lizarraga2025.ledger.claims import Claim
from lizarraga2025.recorded import left_open, robots_of, sentence

PAGE: Final = "claims.html"
"""The page of the book that shows all claims."""

YEAR: Final = 2026
"""Of the release; a test compares it with CITATION.cff."""

READINGS: Final = {
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


TITLE = "qbound: feasible joint and geometric workspaces of robots through boundary functions"


def package() -> str:
    """Return the BibTeX entry of this state of the package; `swhid` is of biblatex-software."""
    fields = {
        "author": "{qbound maintainers}",
        "title": TITLE,
        "version": __version__,
        "year": str(YEAR),
    }
    if (here := state()) is not None:
        fields["note"] = here.text[0].upper() + here.text[1:]
        fields |= {"swhid": here.swhid} if here.swhid else {}
    lines = ",\n".join(f"  {name:<7} = {{{value}}}" for name, value in fields.items())
    return f"@software{{qbound,\n{lines}\n}}"


def _version(number: str = __version__) -> str:
    """Return what a citation calls this package: its version, and the commit where it is known."""
    return f"qbound {number}" + ("" if (here := state()) is None else f", {here.text}")


def entry(claim: Claim) -> str:
    """Return the BibTeX entry of one claim: its place in the paper, verdict, anchor, version."""
    return f"""@misc{{qbound-{claim.id},
  author       = {{{{qbound maintainers}}}},
  title        = {{{{Claim {claim.id}: {escaped(claim.where)}}}}},
  howpublished = {{{_version()}, {PAGE}\\#{claim.anchor}}},
  year         = {{{YEAR}}},
  note         = {{Verdict: {claim.verdict}. On Lizarraga et al. 2025, doi:10.3390/app15105383}}
}}"""


def result(recorded: Mapping[str, Any]) -> str:
    """Return the BibTeX entry of a recorded result: what it is, value, error, robots, state."""
    robots = "; ".join(f"{name}, sha256 {sha}" for name, sha in robots_of(recorded).items())
    unit = "" if recorded["unit"] == "1" else f" {recorded['unit']}"
    bounds = {
        "error of the arithmetic at most": recorded["numerical_error"],
        "left open by the printed digits up to": recorded["input_uncertainty"],
    }
    error = "".join(f", {words} {bound:g}{unit}" for words, bound in bounds.items() if bound)
    error += "".join(f"; {words}" for words in left_open(recorded))
    about = [recorded["reference"], READINGS[recorded["reading"]]]
    about += [f"Robots: {robots}"] if robots else []
    value = f"{value_text(recorded['value'])}{unit}{error}"
    words = [sentence(recorded["id"]).removesuffix("."), value, *filter(None, about)]
    return f"""@misc{{qbound-{anchor(recorded["id"])},
  author       = {{{{qbound maintainers}}}},
  title        = {{{{Result {escaped(recorded["id"])}}}}},
  howpublished = {{{_version(recorded["version"])}, results.html\\#{anchor(recorded["id"])}}},
  year         = {{{YEAR}}},
  note         = {{{escaped(". ".join(words))}. On Lizarraga et al. 2025, doi:10.3390/app15105383}}
}}"""


def anchor(name: str) -> str:
    """Return a result's anchor on the page of results."""
    return "result-" + "-".join(re.findall(r"[a-z0-9]+|(?<![a-z0-9])-(?=[0-9])", name.lower()))


def value_text(value: Any) -> str:
    """Return a value as it is printed: numbers with the digits recorded, lists in brackets."""
    return json.dumps(value, ensure_ascii=False) if not isinstance(value, str) else value


# --- text for BibTeX ------------------------------------------------------------------------------


SIGNS: Final = {
    **{c: f"\\{c}" for c in "_#%&$"},
    "\\": r"\textbackslash{}",
    "{": r"\textbraceleft{}",
    "}": r"\textbraceright{}",
    "~": r"\textasciitilde{}",
    "^": r"\textasciicircum{}",
    "<": r"\textless{}",
    ">": r"\textgreater{}",
    '"': "''",
    "°": r"\textdegree{}",
    "−": "$-$",
    "–": "--",
    "’": "'",
    "²": "$^2$",
    "³": "$^3$",
    "·": r"$\cdot$",
    "±": r"$\pm$",
    "×": r"$\times$",
    "≤": r"$\leq$",
    "≥": r"$\geq$",
    "≠": r"$\neq$",
    "≈": r"$\approx$",
    "√": r"$\surd$",
    "∞": r"$\infty$",
}
"""Signs that LaTeX would take for its own, or that no plain BibTeX file holds."""

ACCENTS: Final = {"ACUTE ACCENT": "'", "GRAVE ACCENT": "`", "DIAERESIS": '"', "TILDE": "~"}


def escaped(text: str) -> str:
    """Return a text as LaTeX source in ASCII.

    Raises
    ------
    ValueError
        If it holds a character that is not known here: nothing is dropped in silence.
    """
    return "".join(SIGNS.get(c, c) if c in SIGNS or c.isascii() else _letter(c) for c in text)


def _letter(c: str) -> str:
    """Return a Greek letter as a symbol, an accented one as its letter under the accent."""
    name = unicodedata.name(c, "")
    if name.startswith("GREEK"):
        letter = name.rpartition("LETTER ")[2].lower()
        letter = {"lamda": "lambda"}.get(letter, letter)
        return f"$\\{letter if 'SMALL' in name else letter.capitalize()}$"
    parts = unicodedata.normalize("NFD", c)
    base, mark = parts[0], unicodedata.name(parts[-1]).removeprefix("COMBINING ")
    if base.isascii() and mark in ACCENTS:
        return f"{{\\{ACCENTS[mark]}{base}}}"
    raise ValueError(f"no LaTeX known for {c!r} ({name})")


# --- the state of the sources ---------------------------------------------------------------------


ROOT = Path(__file__).resolve().parents[3]


@dataclass(frozen=True)
class State:
    """A state of the repository.

    Attributes
    ----------
    commit : str
        Its hash, 40 digits.
    swhid : str
        The tree's identifier at softwareheritage.org, the same wherever the tree lies; empty if
        files were changed since that commit.
    """

    commit: str
    swhid: str

    @property
    def text(self) -> str:
        """Words for a citation.

        Examples
        --------
        >>> State("0" * 40, "").text
        'commit 000000000000 with changes'
        """
        return f"commit {self.commit[:12]}" + ("" if self.swhid else " with changes")


@cache
def state(root: Path = ROOT) -> State | None:
    """Return the state of the repository around this package.

    None where there is none: an installed package, a copy without git.
    """
    if not (root / ".git").exists():
        return None
    try:
        commit, tree = _git(root, "rev-parse", "HEAD", "HEAD^{tree}").split()
        changed = _git(root, "status", "--porcelain", "--untracked-files=no")
    except (OSError, ValueError, subprocess.CalledProcessError):
        return None
    return State(commit, "" if changed else f"swh:1:dir:{tree}")


def _git(root: Path, *words: str) -> str:
    command = ["git", *words]
    done = subprocess.run(command, cwd=root, check=True, capture_output=True, encoding="utf-8")
    return done.stdout
