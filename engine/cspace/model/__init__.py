"""The robot as data: joints, points, bodies, boundaries, and the files that hold them.

- `robot`: the robot; `joints`, `shapes`, `boundaries`: its elements, a class for each type;
- `source`: what a robot was read from, parsed once;
- `exact`: the numbers of a robot as its file writes them, as rationals and balls;
- `frames`: vector labelling (eqs. 1-8);
- `robotfile`: files read and written; `robotcheck`, `bodycheck`, `rows`, `schema`: the rules for
  files, and the sentence that names a fault.
"""
