"""What does a joint do to a length? The one algebraic object, the harmonic form, and Theorem 2.

- `factors`: what each kind of joint puts into a form, a row of a table;
- `harmonic`: the form: evaluation, gradient, restriction; of floats, SymPy expressions and balls;
- `waves`, `bending`: the form as a sum of waves, and how far it may bend within a simplex;
- `circle`: Theorem 2 for one joint; `angles`: full turns.
"""
