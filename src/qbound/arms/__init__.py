"""What of arms with more than two joints? Answers about arms of balls, as imported ones are.

- `fibres`: the exact feasible intervals of one joint, for thousands of configurations at once;
  `gaps`: what intervals leave free, on a line or round a circle;
- `reach`: the voxels that the tool goes through, and their volume; `paths`: the circle or line
  along which a joint carries the tool; `voxels`: which ones a path goes through;
- `reports`: what was found, as JSON and in words.
"""
