"""Boundary functions: how far a configuration is from contact, as named harmonic forms.

- `functions`: from a robot's points and boundaries to forms and margins, one boundary at a time;
- `parts`, `poses`: the bodies of a boundary, and where they stand in the plane, at configurations
  or as forms;
- `contacts`: contact features of two convex parts, as forms, and all features of a robot;
  `exact_contacts`: one in exact numbers; `errors`: how far floats are from these;
- `separation`: signed distances of bodies, at millions of configurations; `nearest`: the nearest
  places;
- `evaluator`: all forms as one table, for one configuration or for millions; `monomials`: its
  columns; `screen`: the floating-point filter; `binding`: the rows that can decide;
- `lengths`: from the value of a form to a margin; `margins`: the margins of a robot, and whether a
  configuration is feasible;
- `compiled`, `machine`: the same answers from a compiled kernel, for hundreds of millions;
- `chain`, `balls`: the same for a sphere model of many joints, by distances in place of forms.
"""
