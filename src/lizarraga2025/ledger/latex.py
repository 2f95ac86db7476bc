"""Text for BibTeX: ASCII that LaTeX sets as the text reads."""

from __future__ import annotations

import unicodedata
from typing import Final

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
