"""Proofs with exact numbers: boundary functions, bounds over cells, areas of two joints.

`problem`: boundary functions of a robot as its file writes it.  `bodies`: tests that separate them.
`numbers`: balls, cosines and sines with a proved error.  `bounds`: of forms over dyadic cells.
`region`: the cells of a region by exact numbers, areas and vertices as balls.
"""
