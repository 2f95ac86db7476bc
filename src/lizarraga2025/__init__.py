"""The companion of J. A. Lizarraga et al., Appl. Sci. 2025, 15, 5383: what it prints, what holds.

`printed`: tables and formulas, as data.  `choices`: what the book chooses where the text is open.
`uncertainty`: what the printed digits leave open of the results.
`ledger`: every statement and its verdict.
`computations`: the function that judges each.  `verdicts`: from its outcome to the verdict.
`evidence`: arms, regions and proofs that they share.  `readings`: what Figure 11 may draw red.
`beyond`: the statements for which the engine is needed; all else needs the small library alone.
`results`, `recorded`: the book's numbers, written and read.  `commands`: `claims` and `results`.
`uncertainty`: what the printed digits leave open of them.
`measured`: times side by side with other tools, read.
`exercises`: a value that a reader filled in, right or wrong.
`typeset`: printed formulas as LaTeX, their terms in the order of the print.
"""

from importlib.metadata import version

__version__ = version("qbound")
