"""Proofs with exact numbers: crossings, regions, areas and components of two joints.

`problem`: boundary functions of a robot as its file writes it.  `bodies`: tests that separate them.
`numbers`: balls, cosines and sines with a proved error.
`bounds`: of forms over dyadic cells.  `crossings`: where two curves meet, none left out.
`runs`: the pieces between them.  `region`: regions and their areas.
`stars`: cells whose free part is connected. `components`: numbers of components and loops.
"""
