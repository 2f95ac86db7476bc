"""Proofs: exact numbers, balls, cells, and certificates that a checker accepts. Optional.

Every prover answers with a `Verdict`.

- `exact`: a robot as its file writes it (`problem`, `bodies`), `numbers` with a proved error,
  `bounds` of forms over cells, the cells of a region by exact numbers, areas and vertices
  (`region`);
- `subpaving`: cells that are feasible, infeasible or undecided (`paving`), proofs that two
  configurations are joined or separated (`connection`), values of one joint that the arm cannot
  pass (`forbidden`);
- `certificates`: claims (`statements`, whose `loops` are filled with triangles), the one
  `inequality`, a direction for each leaf (`search`), configurations that refute and places of two
  hulls that are too near (`witness`), proofs that no path exists (`no_path`), and the file
  (`certify`);
- `subdivide`: boxes and simplices, their halves, and the search that cuts them.
"""

from __future__ import annotations

from enum import StrEnum


class Verdict(StrEnum):
    """Answer about a statement: proved, refuted or undecided."""

    PROVED = "proved"
    REFUTED = "refuted"
    UNDECIDED = "undecided"

    @classmethod
    def of(cls, proved: bool, refuted: bool) -> Verdict:
        """Return the verdict on a statement that is proved, or refuted, or neither."""
        if proved:
            return cls.PROVED
        return cls.REFUTED if refuted else cls.UNDECIDED


class Unproved(ValueError):
    """Error: a statement about a region could not be proved; the message names it."""
