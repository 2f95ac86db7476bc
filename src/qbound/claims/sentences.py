"""Sentences: see `qbound.claims.ledger` for what an entry is."""
