"""Cells that fill the ranges of joints, each proved feasible, infeasible, or left undecided.

`paving`: boxes of any number of joints. `connection`: joined or separated configurations.
`forbidden`: values of one joint that the arm cannot pass.
"""
