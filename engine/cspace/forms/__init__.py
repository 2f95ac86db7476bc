"""Harmonic forms, the one algebraic object of the library, and Theorem 2 for their roots.

- `factors`: the factor of each kind of joint, a row of a table; full turns; monomials;
- `harmonic`: the form: evaluation, gradient, restriction; of floats, SymPy expressions and balls;
  the form as a sum of waves;
- `bending`: a bound of the second derivative of a form over a simplex;
- `circle`: Theorem 2 for one joint.
"""
