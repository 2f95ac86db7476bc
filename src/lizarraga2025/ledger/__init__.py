"""The ledger: a verdict on every statement of the paper, derived from a computation."""

from lizarraga2025.ledger.entries import Claim, Finding, claims, entry, judge, require, undetermined

__all__ = ["Claim", "Finding", "claims", "entry", "judge", "require", "undetermined"]
