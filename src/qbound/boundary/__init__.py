"""How far is a configuration from contact? Boundary functions, as named harmonic forms.

- `functions`: from a robot's points and boundaries to forms and margins, one boundary at a time;
- `evaluator`: all of them compiled once, for one configuration or for millions.
"""
