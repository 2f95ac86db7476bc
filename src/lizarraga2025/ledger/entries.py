"""What a claim is, how a computation's outcome becomes a verdict, and the list of all claims.

An entry is a function without arguments that computes and returns a `Finding`; `entry` puts it on
the list under its id. No entry types its verdict: it hands outcomes to `judge` or `undetermined`.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable, Iterable, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Final, Literal, get_args

from lizarraga2025.results import write_json

Kind = Literal["equation", "bound", "table", "figure", "sentence"]
Verdict = Literal[
    "confirmed",
    "confirmed with a condition",
    "misprint",
    "refuted",
    "not determined by the paper",
]

KINDS: Final[tuple[Kind, ...]] = get_args(Kind)
VERDICTS: Final[tuple[Verdict, ...]] = get_args(Verdict)
SCHEMA: Final = "qbound/claims/1"
MODULES: Final = (
    "labels",
    "theorem_1",
    "theorem_2",
    "bounds",
    "tables",
    "figures",
    "sentences_method",
    "sentences_region",
    "sentences_workspace",
    "sentences_outlook",
)
"""Modules of this package whose functions are the entries, in the order of the ledger."""


@dataclass(frozen=True)
class Evidence:
    """Where a claim is tested and shown.

    Attributes
    ----------
    test : str
        A test of the computation, such as ``test_circle.py::test_every_case_of_theorem_2``.
    chapter : str
        Page and anchor in the book, such as ``06_theorem_2#equation-eq-34``.
    """

    test: str
    chapter: str


@dataclass(frozen=True)
class Finding:
    """What an entry's computation gives: the verdict that follows, and a sentence with numbers."""

    verdict: Verdict
    found: str


@dataclass(frozen=True)
class Claim:
    """One statement of the paper, judged.

    Attributes
    ----------
    id : str
        ``E-34``, ``B-2.1.2`` (the bound ``beta_{2,1,2}``), ``T-4.2`` (a row), ``F-4``, ``S-12``.
    kind : str
        One of `KINDS`.
    where : str
        Its place in the paper, such as "eq. (34), proof of Theorem 2".
    says : str
        A short paraphrase; formulas in plain text.
    verdict : str
        One of `VERDICTS`.
    found : str
        What was computed, with its numbers.
    evidence : Evidence
    mended : str
        What would hold in its place; empty where nothing is to be mended.
    """

    id: str
    kind: Kind
    where: str
    says: str
    verdict: Verdict
    found: str
    evidence: Evidence
    mended: str = ""

    @property
    def anchor(self) -> str:
        """Anchor on the page What holds, such as ``e-34`` or ``b-2-1-2``."""
        return self.id.lower().replace(".", "-")

    def content(self) -> dict[str, Any]:
        """Return the entry as ``results/claims.json`` holds it."""
        return asdict(self)


_ENTRIES: dict[str, Callable[[], Claim]] = {}


def entry(
    name: str, kind: Kind, where: str, says: str, *, test: str, chapter: str, mended: str = ""
) -> Callable[[Callable[[], Finding]], Callable[[], Finding]]:
    """Put a function that returns a `Finding` on the list of claims.

    Parameters are the fields of `Claim` and `Evidence` that no computation gives.

    Raises
    ------
    ValueError
        If the id is taken.
    """

    def add(compute: Callable[[], Finding]) -> Callable[[], Finding]:
        def judged() -> Claim:
            finding = compute()
            fields = (name, kind, where, says, finding.verdict, finding.found)
            return Claim(*fields, Evidence(test, chapter), mended)

        if name in _ENTRIES:
            raise ValueError(f"the claim {name} is there already")
        judged.__module__ = compute.__module__
        _ENTRIES[name] = judged
        return compute

    return add


def judge(*, holds: bool, under: bool = False, mended: bool = False) -> Verdict:
    """Turn the outcome of a computation into a verdict.

    Parameters
    ----------
    holds : bool
        Whether the statement held, as printed, wherever it claims to.
    under : bool
        Whether it held everywhere under a condition that was computed (asked where `holds` is
        false: a counterexample lies outside the condition).
    mended : bool
        Whether a mended statement held where the printed one did not: a slip of the pen.
    """
    if holds:
        return "confirmed"
    if under:
        return "confirmed with a condition"
    return "misprint" if mended else "refuted"


def undetermined(readings: Mapping[str, bool]) -> Verdict:
    """Turn the readings that the print allows, and whether each fits all of it, into a verdict.

    One reading alone fits: confirmed under that reading. Several fit: the print does not decide.
    None fits: refuted.
    """
    fitting = sum(readings.values())
    if fitting > 1:
        return "not determined by the paper"
    return judge(holds=False, under=fitting == 1)


def require(outcome: bool, statement: str) -> None:
    """Stop where a mended statement is not proved: it may not stand in the ledger.

    Raises
    ------
    ArithmeticError
        If the outcome is false.
    """
    if not outcome:
        raise ArithmeticError(f"not proved: {statement}")


def identifiers() -> tuple[str, ...]:
    """Return every id, in the order of the ledger, without computing anything."""
    modules = [importlib.import_module(f"lizarraga2025.ledger.{name}").__name__ for name in MODULES]
    return tuple(sorted(_ENTRIES, key=lambda name: modules.index(_ENTRIES[name].__module__)))


def claim(name: str) -> Claim:
    """Compute one claim.

    Raises
    ------
    ValueError
        If there is no such id.
    """
    if name not in identifiers():
        raise ValueError(f"no claim {name!r}; `qbound claims` lists all")
    return _ENTRIES[name]()


def from_content(content: Mapping[str, Any]) -> Claim:
    """Return the claim of an entry of ``results/claims.json``."""
    return Claim(**{**content, "evidence": Evidence(**content["evidence"])})


def save(ledger: Iterable[Claim], folder: str | Path | None = None) -> Path:
    """Write ``claims.json`` where `Results.save` writes, complete or not at all."""
    content = {"schema": SCHEMA, "claims": [one.content() for one in ledger]}
    return write_json("claims", content, folder)


def claims() -> tuple[Claim, ...]:
    """Compute every claim, in the order of the ledger; needs the extra ``notebooks``."""
    return tuple(claim(name) for name in identifiers())
