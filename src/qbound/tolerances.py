"""Every tolerance of the package, each with its cause. None is global state."""

from typing import Final

TANGENT: Final = 4.0 * 2.0**-52
"""Relative distance of ``|c|`` from ``d`` under which two roots count as one double root (eq. 36).

``hypot`` and one quotient are each right to about one unit in the last place, so a tangency in
exact numbers comes out within a few units of ``|c| = d``."""

ZERO_AMPLITUDE: Final = 2.0**-40
"""An amplitude ``d`` this small beside the constant of its form is rounding, not motion.

It separates coefficients that cancel (left at 1e-16 of the terms they come from) from offsets that
a drawing could state (1e-6 of a robot's length at the least)."""

ON_BOUNDARY: Final = 1e-9
"""Value of a form, relative to its coefficients, under which a point counts as on the boundary.

A root of Theorem 2 put back into its form leaves 1e-16 of the coefficients where the root is simple
and 1e-8 in the angle where it is double, that is 1e-16 in the value again; 1e-9 leaves room for
the sums of many joints."""
