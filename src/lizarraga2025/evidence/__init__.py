"""Arms, regions and proofs on which several computations rest, each made once and cached.

`arms`: the paper's robot and its variants.  `joint_region`: its regions and the scaled polygon.
`tool_paths`: traversals and the workspace.  `effort`: what an area costs by each method.
`proofs`: identities.  `rounding`: how far printed digits may be off, and where the third components
of eq. (9) are positive.  `certainty`: the paper's rule and the areas of images, proved, and bounds
to compare with that of certificates.
"""
