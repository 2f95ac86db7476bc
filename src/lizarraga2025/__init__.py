"""The companion of J. A. Lizarraga et al., Appl. Sci. 2025, 15, 5383: what it prints, what holds.

`printed`: tables and formulas as printed.  `ledger`: each statement and its verdict.
`computations`: the function that judges each.  `evidence`: arms, regions and proofs they share.
`verdicts`: from outcome to verdict.  `collisions`: what a red point of Figure 11 may mean.
`results`, `recorded`: numbers of the book, written and read.  `commands`: `qbound claims`, `results`.
"""
