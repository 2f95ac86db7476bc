"""Arms, regions and proofs on which several computations rest, each made once and cached.

All of it uses the small library alone. `arms`: the paper's robot and its variants.
`joint_region`: its region and the scaled polygon. `tool_paths`: traversals and postures.
`effort`: what an area costs by each method. `proofs`: identities. `rounding`: how far printed
digits may be off.
"""
