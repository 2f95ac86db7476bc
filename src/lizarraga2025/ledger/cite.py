"""How to cite the paper, this package, and one entry of the ledger, in BibTeX.

A citation names the state of the sources: a commit, and what Software Heritage calls its tree.
Between releases the version alone does not tell one state from the next. Committed files cannot
hold the commit that they are part of, so it is asked of git when a page or a citation is made.
"""

import json
import re
import subprocess
import tomllib
import unicodedata
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib import resources
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
    "windows": "Region by the windows of Table 6",
    "clearance": "Region by the least distances of eq. (11)",
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


ON_THE_PAPER: Final = "On Lizarraga et al. 2025, doi:10.3390/app15105383"

TITLE = "qbound: feasible joint and geometric workspaces of robots through boundary functions"


@cache
def published() -> Mapping[str, Any]:
    """Return who signs, where the book is read, and the DOI, as far as there are any.

    ``[tool.qbound]`` of pyproject.toml has them; a wheel holds a copy of it.
    """
    copied = resources.files("lizarraga2025") / "pyproject.toml"
    file = copied if copied.is_file() else ROOT / "pyproject.toml"
    if not file.is_file():
        return {}
    stated = tomllib.loads(file.read_text(encoding="utf-8"))["tool"]["qbound"]
    return {name: stated[name] for name in ("authors", "pages", "doi") if stated.get(name)}


def _entry(kind: str, key: str, title: str, anchor: str, note: str, **more: str) -> str:
    """Return a BibTeX entry: only fields for which there is something to say."""
    known = published()
    fields = {"author": escaped(" and ".join(known.get("authors", []))), "title": title}
    fields |= more | {"year": str(YEAR), "doi": known.get("doi", "")}
    fields["url"] = f"{known['pages'].rstrip('/')}/{anchor}" if "pages" in known else ""
    fields["note"] = note if "doi" in known else f"Unpublished. {note}".strip()
    width = max(map(len, fields))
    lines = [f"  {name:<{width}} = {{{value}}}" for name, value in fields.items() if value]
    return f"@{kind}{{{key},\n" + ",\n".join(lines) + "\n}"


def package() -> str:
    """Return the BibTeX entry of this state of the package; `swhid` is of biblatex-software."""
    here = state()
    swhid = {"swhid": here.swhid} if here is not None and here.swhid else {}
    note = "" if here is None else here.text[0].upper() + here.text[1:]
    return _entry("software", "qbound", TITLE, "", note, version=__version__, **swhid)


def _version(number: str = __version__) -> str:
    """Return what a citation calls this package: its version, and the commit where it is known."""
    return f"qbound {number}" + ("" if (here := state()) is None else f", {here.text}")


def entry(claim: Claim) -> str:
    """Return the BibTeX entry of one claim: its place in the paper, verdicts, reading, version."""
    note = f"{_version()}. {escaped(_judged(claim))} {ON_THE_PAPER}"
    title = f"{{Claim {claim.id}: {escaped(claim.where)}}}"
    return _entry("misc", f"qbound-{claim.id}", title, f"{PAGE}\\#{claim.anchor}", note)


def _judged(claim: Claim) -> str:
    """Return both verdicts, the reading under which they hold, and what holds instead, if any."""
    verdict = f"Likeliest reading: {claim.likeliest}"
    if claim.most_favourable != claim.likeliest:
        verdict += f"; most favourable reading: {claim.most_favourable}"
    holds = f" Holds: {claim.corrected}" if claim.corrected else ""
    return f"{verdict}. Read so: {claim.reading}{holds}".replace("$", "")


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
    name = anchor(recorded["id"])
    note = f"{_version(recorded['version'])}. {escaped('. '.join(words))}. {ON_THE_PAPER}"
    title = f"{{Result {escaped(recorded['id'])}}}"
    return _entry("misc", f"qbound-{name}", title, f"results.html\\#{name}", note)


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
    "⁻": "$^{-}$",
    "¹": "$^1$",
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
