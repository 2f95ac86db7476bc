"""What goes beyond the paper and needs the engine: bodies, all components, proofs, surfaces.

`evidence`: the arms with bodies, their regions and gaps.  `certainty`: the rule by windows and the
areas of images, proved.  `uncertainty`: what the printed digits leave open.  The other modules
compute entries of the ledger: `regions`, `bodies`, `workspace`, `slides`.
"""
