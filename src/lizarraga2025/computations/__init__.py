"""The computation of every entry of the ledger: a function for each, found by its id.

`registry` collects them. Equations: `labels` (1) to (8), `constraints` to (12), `theorem_1` to
(29), `theorem_2` to (39). Table 6: `bounds`; all rows: `tables`. Captions: `figures_region`,
`figures_workspace`. Text: `sentences_method`, `sentences_region`, `sentences_workspace`,
`sentences_outlook`. Entries for which the engine is needed stand in `beyond`.
"""
