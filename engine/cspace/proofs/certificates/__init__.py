"""Certificates: the claim, the search for a proof or a witness, and the file.

`statements`: sets, in the decimals that are written. `loops`: loops of polygons, and triangles.
`inequality`: the one inequality, in doubles.  `search`: a direction for each leaf.
`witness`: configurations that refute, and places of two hulls that are too near.
`no_path`: proofs that no path exists.  `certify`: prove, refute, and write the file.
"""
