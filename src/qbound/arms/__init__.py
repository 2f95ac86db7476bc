"""Arms of more than two joints whose links are covered by spheres, as imported arms are.

- `fibres`: the exact feasible intervals of one joint, for thousands of configurations at once;
  `gaps`: the gaps that intervals leave, on a line or round a circle;
- contacts of links: `links` (their spheres), `pair_forms` (distance of two links), `closest` (where
  they are nearest), `everywhere` (proofs over all cells), `allowed` (links that meet never, or
  always), `allowed_report` (as JSON, a table, and the SRDF of planners);
- `surfaces`: boundaries of safe values of three joints; `surface_forms` (the functions),
  `surface_grid` (on a grid), `surface_mesh` (triangles put onto them), `surface_files` (PLY, glTF);
- `separations`: ranges of one joint that something blocks, whatever the other joints do; `why`:
  whether the arm gets from one configuration to another (by separations, a proved path, a paving);
  `search`: a path, looked for in doubles; `answers`: the answer in sentences and as JSON;
- `reach`: the voxels that the tool goes through, and their volume; `paths`: the circle or line
  along which a joint carries the tool; `voxels`: the voxels on such a path;
- `reports`: fibres and maps of reach as JSON and in words.
"""
