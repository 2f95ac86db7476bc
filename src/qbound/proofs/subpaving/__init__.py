"""Cells that fill the ranges of joints, each proved feasible, infeasible, or left undecided.

`paving`: boxes of any number of joints.  `stacks`: pavings of which one joint is solved for.
`sectors`: of that joint, over cells.  `connection`: what is joined, and what is not.
`forbidden`: values of one joint that nothing passes.
"""
