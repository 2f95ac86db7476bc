"""What does each statement come to? A function for every entry of the ledger, found by its id.

`registry` collects them. Equations: `labels` (1) to (8), `theorem_1` to (29), `theorem_2` to (39).
`bounds` of Table 6, rows of all `tables`, captions of `figures`. Sentences of the text:
`sentences_method`, `sentences_region`, `sentences_workspace`, `sentences_outlook`.
"""
