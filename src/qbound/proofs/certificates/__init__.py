"""Certificates: what is claimed, the search for a proof or a witness, and the file.

`statements`: sets, in the decimals that are written.  `loops`: of polygons, filled with triangles.
`inequality`: the one inequality, in doubles.  `search`: a direction for each leaf.
`witness`: what refutes, and places of two hulls that are too near.
`no_path`: that no path leads from start to goal.  `certify`: prove, refute, and write the file.
"""
