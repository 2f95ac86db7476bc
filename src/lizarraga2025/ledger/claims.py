"""The verdict on each statement: what an entry says, and what its computation finds."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass
from functools import cache
from pathlib import Path
from typing import Any, Final

from lizarraga2025.computations import registry
from lizarraga2025.computations.registry import Computation
from lizarraga2025.ledger.entries import Entry, Evidence, entries
from lizarraga2025.results import write_json
from lizarraga2025.verdicts import VERDICTS, Verdict

SCHEMA: Final = "qbound/claims/3"
KEYS: Final = (
    "id",
    "kind",
    "where",
    "says",
    "reading",
    "verdict",
    "finding",
    "found",
    "evidence",
    "corrected",
)
"""The keys of a claim in ``results/claims.json``, in their order."""


@dataclass(frozen=True, kw_only=True)
class Claim(Entry):
    """One statement of the paper, judged: an entry of the ledger with its verdict.

    Attributes
    ----------
    verdict : str
        One of `lizarraga2025.verdicts.VERDICTS`.
    found : str
        What was computed, with its numbers.
    """

    verdict: Verdict
    found: str

    @property
    def anchor(self) -> str:
        """Anchor on the page What holds, such as ``e-34`` or ``b-2-1-2``."""
        return self.id.lower().replace(".", "-")

    def content(self) -> dict[str, Any]:
        """Return the claim as ``results/claims.json`` holds it."""
        content = asdict(self)
        return {key: content[key] for key in KEYS}


def from_content(content: Mapping[str, Any]) -> Claim:
    """Return the claim of an entry of ``results/claims.json``."""
    return Claim(**{**content, "evidence": Evidence(**content["evidence"])})


@dataclass(frozen=True)
class Count:
    """How many entries have a verdict, and on how many findings they rest (`findings`)."""

    entries: int
    findings: int


def counts(ledger: Iterable[Claim]) -> dict[Verdict, Count]:
    """Count the entries and the findings of every verdict.

    A finding that entries with different verdicts share counts once for each of these verdicts.
    """
    by_verdict: dict[Verdict, list[Claim]] = {verdict: [] for verdict in VERDICTS}
    for one in ledger:
        by_verdict[one.verdict].append(one)
    return {v: Count(len(named), len(findings(named))) for v, named in by_verdict.items()}


def findings(ledger: Iterable[Claim]) -> set[str]:
    """Return the findings on which entries rest; what is given is none."""
    return {one.finding for one in ledger if one.kind != "given"}


def identifiers() -> tuple[str, ...]:
    """Return every id, in the order of the ledger, without computing anything."""
    return tuple(_computable())


def claim(name: str) -> Claim:
    """Compute one claim.

    Raises
    ------
    ValueError
        If there is no such id.
    """
    if name not in _computable():
        raise ValueError(f"no claim {name!r}; `qbound claims` lists all")
    entry, computation = _computable()[name]
    return Claim(**vars(entry), **vars(computation()))


def claims() -> tuple[Claim, ...]:
    """Compute every claim, in the order of the ledger; needs the extra ``notebooks``."""
    return tuple(claim(name) for name in identifiers())


def save(ledger: Iterable[Claim], folder: str | Path | None = None) -> Path | None:
    """Write ``claims.json`` where and if `Results.save` writes, complete or not at all."""
    content = {"schema": SCHEMA, "claims": [one.content() for one in ledger]}
    return write_json("claims", content, folder)


@cache
def _computable() -> Mapping[str, tuple[Entry, Computation]]:
    return join(entries(), registry.by_id())


def join(
    said: Mapping[str, Entry], computed: Mapping[str, Computation]
) -> dict[str, tuple[Entry, Computation]]:
    """Put each entry beside its function.

    Raises
    ------
    ValueError
        If an entry has no function, or a function no entry.
    """
    for name in said:
        if name not in computed:
            raise ValueError(f"no function computes the entry {name} of the ledger")
    for name in computed:
        if name not in said:
            raise ValueError(f"a function computes {name}, which is no entry of the ledger")
    return {name: (entry, computed[name]) for name, entry in said.items()}
