"""The one algebraic object: harmonic forms, and Theorem 2 for one joint of them."""
