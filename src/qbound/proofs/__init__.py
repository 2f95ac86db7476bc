"""Proofs: exact numbers, balls, cells, and certificates that a checker accepts. Optional.

Every prover answers with a `Verdict`.

- `exact`: a robot as its file writes it (`problem`, `bodies`), `numbers` with a proved error,
  `bounds` of forms over cells, where curves cross (`crossings`), the pieces between (`runs`),
  regions and their areas (`region`), and how many components of how many loops there are
  (`components`, from cells on which what is free is connected: `stars`);
- `subpaving`: cells that are feasible, infeasible or undecided (`paving`), stacks of which one
  joint is solved for (`stacks`, by `sectors`), what is joined and what is not (`connection`),
  values of one joint that nothing passes (`forbidden`);
- `certificates`: what is claimed (`statements`, whose `loops` are filled with triangles), the one
  `inequality`, a direction for each leaf (`search`), what refutes and places of two hulls that
  are too near (`witness`), that no path leads over (`no_path`), and the file (`certify`);
- `subdivide`: boxes and simplices, their halves, and the search that cuts them;
- `second`: the second checker, which shares nothing with `qbound.check` nor with the provers.
"""

from __future__ import annotations

from enum import StrEnum


class Verdict(StrEnum):
    """What is known of a statement."""

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
    """Something about a region could not be proved; the message says what."""
