"""What is the robot? Joints, points and boundaries as data, and the files that hold them.

- `robot`: the robot; `joints`, `shapes`, `boundaries`: what it is made of, a class for each type;
- `exact`: its numbers as they are written, as rationals and balls;
- `plane`: the plane in which a planar arm moves;
- `frames`: vector labelling (eqs. 1-8); `values`: joint values as they come in;
- `robotfile`: files read and written; `robotcheck`, `bodycheck`, `rows`, `schema`: what they may
  say, and the sentence where they say something else.
"""
