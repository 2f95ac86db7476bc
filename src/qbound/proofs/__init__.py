"""What is proved? Exact numbers, balls, cells, and certificates that a checker accepts.

- answers: `verdict` (proved, refuted, undecided: of every prover);
- numbers: `exact` (a robot as its file writes it), `balls` (python-flint's, and their precision);
- boundaries: `crossings` (where two curves meet, none left out), `runs` (pieces between them),
  `proved_region` (regions and their areas), `proved_images` (areas of the tool's plane),
  `exact_windows` (the paper's rule, Table 6);
- cells: `dyadic` (cells and bounds over them), `paving` (feasible, infeasible, undecided),
  `connection` (what is joined, and what is not);
- certificates: `statements` (what is claimed), `points` (read from files), `triangulation` (of
  which polygon), `minorant` (lower bounds), `certify` (the search), `witness` (what refutes),
  `check_arb` (the second checker, after `qbound.check`);
- `reports`: what was proved, as JSON and in words.
"""
