"""How far is a configuration from contact? Boundary functions, as named harmonic forms.

- `functions`: from a robot's points and boundaries to forms and margins, one boundary at a time;
- `parts`, `poses`: the bodies that a boundary is about, and where they stand in the plane;
- `contacts`: how two convex parts touch, as forms; `body_contacts`: all contacts of a robot;
  `exact_contacts`: one of them in exact numbers; `errors`: how far floats are from these;
- `separation`: how far bodies are apart, at millions of configurations; `nearest`: and where;
- `evaluator`: all of them as one table, for one configuration or for millions; `monomials`: what
  its columns stand for; `screen`: most signs in single precision, with a bound of its error, by
  the rows that can decide (`binding`);
- `lengths`: from the value of a form to a margin; `margins`: those of a robot, and whether it is
  feasible;
- `compiled`, `machine`: the same answers in machine code, for hundreds of millions;
- `chain`, `balls`: the same for an arm of many joints, by places and distances in place of forms.
"""
