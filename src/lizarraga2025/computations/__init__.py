"""What does each statement come to? One function an entry of the ledger, found by the entry's id.

`registry` collects them; `labels`, `theorem_1`, `theorem_2`, `bounds`, `tables` and `figures` follow
the paper's numbers, the four modules of `sentences_` its text.
"""
