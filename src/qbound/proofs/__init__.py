"""What is proved? Exact numbers, balls, cells, and certificates that a checker accepts.

- answers: `verdict` (proved, refuted, undecided: of every prover);
- numbers: `exact` (a robot as its file writes it), `exact_bodies` (what separates its bodies),
  `balls` (python-flint's, and their precision);
- boundaries: `crossings` (where two curves meet, none left out), `runs` (pieces between them),
  `proved_region` (regions and their areas), `proved_images` (areas of the tool's plane),
  `exact_windows` (the paper's rule, Table 6);
- components, with bodies or without: `stars` (cells on which what is free is connected) and
  `structure` (how many components, of how many loops);
- cells: `dyadic` (cells and bounds over them), `paving` (feasible, infeasible, undecided),
  `columns` (pavings of which one joint is solved for), `sectors` (of that joint, over cells),
  `trigonometry` (cosines and sines of arrays, with a proved error),
  `connection` (what is joined, and what is not), `blocked` (ranges of one joint that nothing
  passes);
- bodies: `parts` (of outlines), `features` (what separates them), `separating` (the search for one
  on each cell), `overlap` (places that refute);
- certificates: `statements` (what is claimed), `points` (read from files), `triangulation` (of
  which polygon), `unrolled` (what goes all the way round a joint, cut open), `minorant` (lower
  bounds), `boxes` (the search over a box) and `forest` (the cuts of a search), `certify` (the
  search, and the file), `no_path` (that nothing leads past a range), `separator` (few boxes that
  separate) and `disconnected` (that nothing leads round them), `witness` (what refutes);
- the second checker, after `qbound.check`: `grammar`, `grammar_robot` and `grammar_values` (what a
  file may say), `cells` (what makes up the set), `interpolation` (boundary functions), `flat_balls`
  (bodies in the plane of motion), `leaves` (bounds on leaves), `check_disconnected`, `check_arb`;
- `reports`: what was proved, as JSON and in words.
"""
