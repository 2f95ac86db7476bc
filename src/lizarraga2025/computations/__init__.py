"""The computation of every entry of the ledger: a function for each, found by its id.

`registry` collects them. `theorem_1`: labels, Theorem 1, and eqs. (1) to (8) and (13) to (29).
`theorem_2`: eqs. (30) to (39). Table 6: `bounds`; all rows: `tables`. `region`: the joint region,
Figures 1 to 6 and eqs. (9) to (12). `workspace`: the tool, Figures 7 to 11, sampling and outlook.
Entries for which the engine is needed stand in `beyond`.
"""
