"""Proofs: exact numbers, balls, cells, and certificates that a checker accepts.

- answers: `verdict` (proved, refuted, undecided: of every prover);
- numbers: `exact` (a robot as its file writes it), `exact_bodies` (what separates its bodies),
  `balls` (python-flint's, and their precision);
- boundaries: `crossings` (where two curves meet, none left out), `runs` (pieces between them),
  `proved_region` (regions and their areas);
- components, with bodies or without: `stars` (cells on which what is free is connected) and
  `structure` (how many components, of how many loops);
- cells: `dyadic` (cells and bounds over them), `paving` (feasible, infeasible, undecided),
  `columns` (pavings of which one joint is solved for), `sectors` (of that joint, over cells),
  `trigonometry` (cosines and sines of arrays, with a proved error),
  `connection` (what is joined, and what is not), `blocked` (ranges of one joint that nothing
  passes);
- bodies: `parts` (convex parts of outlines);
- certificates: `statements` (what is claimed), `points` (read from files), `triangulation` (of
  which polygon), `unrolled` (what goes all the way round a joint, cut open), `certify` (prove,
  refute, and write the file), `inequality` (the one inequality, in floats), `subdivide` (cells,
  their halves, the search that cuts them), `safe` (a direction for each leaf), `contact` (places
  of two hulls that are too near), `witness` (what refutes), `no_path` (that nothing leads from
  start to goal), `separator` (few boxes that separate);
- `second`: the second checker, which shares nothing with `qbound.check` nor with the provers;
- `reports`: what was proved, as JSON and in words.
"""
