"""The ledger: a verdict on every statement of the paper, derived from a computation."""

from qbound.claims.ledger import Claim, Finding, claims, entry, judge, require, undetermined

__all__ = ["Claim", "Finding", "claims", "entry", "judge", "require", "undetermined"]
