"""Arms of more than two joints whose links are covered by spheres, as imported arms are.

- `fibres`: the exact feasible intervals of one joint, for thousands of configurations at once;
- `links`: the spheres of each link; `allowed`: the links that meet never, or always;
- `separations`: ranges of one joint that something blocks, whatever the other joints do; `why`:
  whether the arm gets from one configuration to another (by separations, a proved path, a paving);
  `search`: a path, looked for in doubles.

What commands write, JSON and sentences, is the last section of each module.
"""
