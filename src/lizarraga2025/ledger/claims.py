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
from lizarraga2025.verdicts import Verdict

SCHEMA: Final = "qbound/claims/1"


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
        """Return the claim as ``results/claims.json`` holds it: there `corrected` is "mended"."""
        return {
            "id": self.id,
            "kind": self.kind,
            "where": self.where,
            "says": self.says,
            "verdict": self.verdict,
            "found": self.found,
            "evidence": asdict(self.evidence),
            "mended": self.corrected,
        }


def from_content(content: Mapping[str, Any]) -> Claim:
    """Return the claim of an entry of ``results/claims.json``."""
    rest = {key: value for key, value in content.items() if key not in ("evidence", "mended")}
    return Claim(**rest, evidence=Evidence(**content["evidence"]), corrected=content["mended"])


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


def save(ledger: Iterable[Claim], folder: str | Path | None = None) -> Path:
    """Write ``claims.json`` where `Results.save` writes, complete or not at all."""
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
