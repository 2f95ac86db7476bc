"""The verdict on each statement: what an entry says, and what its computation finds.

A file in ``statements`` is a list of tables ``[[entry]]``, in the order of the ledger; their keys
are the fields of `Entry`. What an entry comes to is computed (`computations`, `beyond`).
"""

import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, replace
from functools import cache
from importlib import resources
from importlib.resources.abc import Traversable
from pathlib import Path
from typing import Any, Final, Literal, TypeVar, get_args

from lizarraga2025.computations import registry
from lizarraga2025.computations.registry import Computation
from lizarraga2025.results import write_json
from lizarraga2025.verdicts import VERDICTS, Verdict

Kind = Literal["equation", "bound", "table", "figure", "sentence", "given"]
Severity = Literal["region", "formula", "wording"]
Column = Literal["likeliest", "most_favourable"]

KINDS: Final[tuple[Kind, ...]] = get_args(Kind)
SEVERITIES: Final[tuple[Severity, ...]] = get_args(Severity)
"""What hangs on a statement, the gravest first: the region or the workspace, a formula, words."""
COLUMNS: Final[tuple[Column, ...]] = get_args(Column)
FILES: Final = ("equations", "bounds", "tables", "figures", "sentences")
"""Names of the files, in the order of the ledger."""


@dataclass(frozen=True)
class Evidence:
    """Where a claim is tested, file and function, and shown, page and anchor of the book."""

    test: str
    chapter: str


@dataclass(frozen=True, kw_only=True)
class Entry:
    """One statement of the paper, before it is judged.

    Attributes
    ----------
    id : str
        ``E-34``, ``B-2.1.2`` (the bound ``beta_{2,1,2}``), ``T-4.2`` (a row), ``F-4``, ``S-12``.
    kind : str
        One of `KINDS`. What is ``given``, a definition or a number of the robot, is no finding:
        only broken mathematics could violate it.
    severity : str
        One of `SEVERITIES`: what changes where the statement does not hold as printed. Where none
        is given, the wording for figures and sentences, a formula for all else.
    where : str
        Its place in the paper, such as "eq. (34), proof of Theorem 2".
    says : str
        A short paraphrase; formulas in plain text.
    reading : str
        How it is taken before it is judged.
    evidence : Evidence
    finding : str
        The id of the entry that carries the finding; its own where none is given.
    corrected : str
        What would hold in its place; empty where nothing is to be corrected.
    """

    id: str
    kind: Kind
    severity: str = ""
    where: str
    says: str
    reading: str
    finding: str = ""
    corrected: str = ""
    evidence: Evidence

    def __post_init__(self) -> None:
        """Let an entry that names no other carry its finding itself, and set its severity.

        Raises
        ------
        ValueError
            If a field is no text, the kind none of `KINDS` or the severity none of `SEVERITIES`.
        """
        texts = {k: v for k, v in vars(self).items() if k != "evidence"} | vars(self.evidence)
        for name, value in texts.items():
            if not isinstance(value, str):
                raise ValueError(f"{self.id}: {name} is no text")
        if self.kind not in KINDS:
            raise ValueError(f"{self.id}: the kind {self.kind!r} is none of {', '.join(KINDS)}")
        if not self.finding:
            object.__setattr__(self, "finding", self.id)
        if not self.severity:
            words = self.kind in ("figure", "sentence")
            object.__setattr__(self, "severity", "wording" if words else "formula")
        if self.severity not in SEVERITIES:
            raise ValueError(
                f"{self.id}: the severity {self.severity!r} is none of {', '.join(SEVERITIES)}"
            )


@cache
def entries() -> Mapping[str, Entry]:
    """Return every entry by its id, in the order of the ledger."""
    folder = resources.files("lizarraga2025") / "ledger" / "statements"
    return read(folder / f"{name}.toml" for name in FILES)


def read(files: Iterable[Traversable]) -> Mapping[str, Entry]:
    """Read the entries of some files.

    Raises
    ------
    ValueError
        If a key is unknown, missing or no text, a kind is none of `KINDS`, an id stands twice, or
        a finding is no entry that carries its own.
    """
    found: dict[str, Entry] = {}
    for file in files:
        try:
            content = tomllib.loads(file.read_text(encoding="utf-8"))
            rows = [_of(Entry, row) for row in content.pop("entry")]
            if content:
                raise ValueError(f"the file has {', '.join(content)} beside its entries")
        except (TypeError, AttributeError, KeyError, ValueError) as error:
            raise ValueError(f"{file.name}: {error}") from None
        for entry in rows:
            if entry.id in found:
                raise ValueError(f"{file.name}: the id {entry.id} stands twice in the ledger")
            found[entry.id] = entry
    for entry in found.values():
        carrier = found.get(entry.finding)
        if carrier is None or carrier.finding != carrier.id:
            raise ValueError(
                f"{entry.id}: the finding {entry.finding!r} is no entry that carries its own"
            )
    return found


Found = TypeVar("Found", bound=Entry)


def _of(kind: type[Found], content: Mapping[str, Any]) -> Found:
    """Return a table as a record; a TypeError names a key that is unknown or missing."""
    return kind(**{**content, "evidence": Evidence(**content["evidence"])})


# --- the verdicts ---------------------------------------------------------------------------------


SCHEMA: Final = "qbound/claims/4"


@dataclass(frozen=True, kw_only=True)
class Claim(Entry):
    """One statement of the paper, judged: an entry of the ledger with its verdicts.

    Attributes
    ----------
    likeliest, most_favourable : str
        Verdicts of two readings (`lizarraga2025.verdicts.Outcome`).
    computed : str
        What was computed, with its numbers.
    """

    likeliest: Verdict
    most_favourable: Verdict
    computed: str

    @property
    def stands(self) -> bool:
        """Whether it is confirmed in its likeliest reading: nothing in the paper is to change."""
        return self.likeliest == "confirmed"

    @property
    def anchor(self) -> str:
        """Anchor on the page What holds, such as ``e-34`` or ``b-2-1-2``."""
        return self.id.lower().replace(".", "-")

    def content(self) -> dict[str, Any]:
        """Return the claim as ``results/claims.json`` holds it."""
        return asdict(self)


def from_content(content: Mapping[str, Any]) -> Claim:
    """Return the claim of an entry of ``results/claims.json``."""
    return _of(Claim, content)


@dataclass(frozen=True)
class Count:
    """How many entries have a verdict, and on how many findings they rest (`findings`)."""

    entries: int
    findings: int

    def __str__(self) -> str:
        """Tell both numbers in words."""
        entries = "entry" if self.entries == 1 else "entries"
        findings = "finding" if self.findings == 1 else "findings"
        return f"{self.entries} {entries}, {self.findings} {findings}"


def counts(ledger: Iterable[Claim], column: Column = "likeliest") -> dict[Verdict, Count]:
    """Count the entries and the findings of every verdict of a column.

    A finding that entries with different verdicts share counts once for each of these verdicts.
    """
    by_verdict: dict[Verdict, list[Claim]] = {verdict: [] for verdict in VERDICTS}
    for one in ledger:
        by_verdict[getattr(one, column)].append(one)
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
        raise ValueError(f"no claim {name!r}; `lizarraga2025 claims` lists all")
    entry, computation = _computable()[name]
    found = computation()
    text = found.computed or f"As {entry.finding}."
    return Claim(**vars(entry), **vars(replace(found, computed=text)))


def refuse_replacing(file: Path) -> None:
    """Refuse a place where `save` would replace what is no file of claims.

    Raises
    ------
    ValueError
        If a file is there and holds no claims.
    """
    if file.exists() and b'"qbound/claims/' not in file.read_bytes()[:100]:
        raise ValueError(f"{file} is there already and holds no claims: it is not replaced")


def save(ledger: Iterable[Claim], file: Path) -> None:
    """Write claims as ``results/claims.json`` has them, complete or not at all."""
    write_json(file, {"schema": SCHEMA, "claims": [one.content() for one in ledger]})


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
