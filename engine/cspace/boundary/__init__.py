"""Boundary functions: how far a configuration is from contact, as named harmonic forms.

- `functions`: from a robot's points and boundaries to forms and margins, one boundary at a time;
- `poses`: the chain in the plane of motion, at configurations or as forms, in numbers of any type;
  the bodies of a boundary;
- `contacts`: contact features of two convex parts, as rows for a pose: all features of a robot in
  doubles, one in exact numbers, all of any number of joints for proofs;
- `separation`: signed distances of bodies, at millions of configurations, and the nearest places;
- `evaluator`: all forms as one table, for one configuration or for millions: margins, and whether a
  configuration is feasible; `screen`: the floating-point filter, and the rows that can decide;
- `compiled`: the same answers from a compiled kernel, for hundreds of millions;
- `chain`, `balls`: the same for a sphere model of many joints, by distances in place of forms.
"""
