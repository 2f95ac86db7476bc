"""What of arms with more than two joints? Answers about arms of balls, as imported ones are.

- `fibres`: the exact feasible intervals of one joint, for thousands of configurations at once;
  `gaps`: what intervals leave free, on a line or round a circle;
- contacts of links: `links` (their balls), `pair_forms` (how near two of them come), `closest`
  (where), `everywhere` (proofs over all cells), `allowed` (which never meet, which always do),
  `allowed_report` (as JSON, a table, and the SRDF of planners);
- `surfaces`: where safe values of three joints end; `surface_forms` (the functions), `surface_grid`
  (on a grid), `surface_mesh` (triangles put onto them), `surface_files` (PLY and glTF);
- `separations`: ranges of one joint that something blocks, whatever the other joints do; `why`: can
  it get from here to there (separations, a path, proved, a paving), `search` (a path, looked for
  in doubles), `answers` (what was found, in sentences and as JSON);
- `reach`: where the tool gets to; `paths` (its ways along fibres), `voxels`;
- `reach`: the voxels that the tool goes through, and their volume; `paths`: the circle or line
  along which a joint carries the tool; `voxels`: which ones a path goes through;
- `reports`: what was found, as JSON and in words.
"""
