"""Commands that the companion adds to ``qbound``, by the entry-point group qbound.commands."""
