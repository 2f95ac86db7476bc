"""What a prover answers: one enumeration for all of them, and one refusal of those of regions."""

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
