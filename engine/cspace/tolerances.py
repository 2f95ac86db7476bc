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

NEGLIGIBLE: Final = 1e-13
"""A coefficient this small beside the largest is rounding of a cancelled one."""

ROUNDING: Final = 16.0 * 2.0**-52
"""Error of a sum of three products beside the size of its terms, with that of its coefficients."""

UNCERTAIN_SIGN: Final = 1e-9
"""A bound on a form this near to zero, beside the size of the form's terms, proves no sign.

The bounds are sums of a few dozen products, right to 1e-14 of that size, and coefficients that come
from a longer chain are, too."""

NEAR_CIRCLE: Final = 0.03
"""Distance from the unit circle (or the real line) under which a computed root is kept.

A double root leaves it by 1e-5 and a fourfold by 1e-2; one too many costs time, a missed one the
answer."""

AGREE: Final = 1e-3
"""How far, in units of a slide, its value beside the end of an arc's piece may be from that end.

A value that is farther off is replaced by the end, because a root of a quadratic may go to infinity
there."""

SAME_CRITICAL: Final = 1e-10
"""Critical base values closer than this are one."""

TOUCH: Final = 1e-6
"""Joint values closer than this, in units of a joint, may be one place, or one end of a cell.

Near a fold a root moves with the square root of the base: 1e-15 there is 3e-8 here."""

SAME_POINT: Final = 1e-12
"""Joint values closer than this are one point of a drawn line, or of a cell that ends there."""

ROUNDED_AREA: Final = 1e-12
"""Part of a workspace's area below which the overlap of two of its pieces is rounding."""

QUADRATURE: Final = 1e-13
"""Relative change of a quadrature at doubled nodes under which it has converged.

Gauss-Legendre gains all its digits at once when the integrand is analytic, as it is between
two events; beside another event it needs more nodes, or shorter pieces, not another method."""

CONTACT: Final = 1e-14
"""Gap of two bodies, relative to the arm about their joint, under which they touch.

Conservative advancement comes closer by a fixed factor each step and ends in the rounding of the
corners' coordinates, a few 1e-16 of the arm."""

SAME_PLACE: Final = 1e-7
"""Parameters of a path closer than this are one place.

Newton, with slopes from central differences, ends within 1e-10 of a crossing; two that a reader
would tell apart are farther from each other than this."""

FLAT_ARC: Final = 1e-4
"""Distance of an arc's points from a chord, relative to the picture, that no eye can see.

A tenth of a pixel in a picture a thousand pixels wide."""

PROVED_SCALE: Final = 1e-9
"""Part of a scale by which what is proved stays below what touches.

A bound of second order needs triangles as small as the square root of what it is to resolve: 1e-9
takes triangles of 1e-5 rad beside the place of contact, and only there."""

CHORD: Final = 0.04
"""Angle between points of a circle in a drawn outline: a chord leaves the circle by 2e-4 of the
radius, less than a line is wide."""

OUTWARD: Final = 2.0**-44
"""Part of a shape's size by which the balls that cover it are larger than exact numbers ask.

A distance, and a corner halved sixty times, are each right to some 70 units in the last place of
the largest coordinate, 2**-46 of it; what covers by this much more covers in exact numbers."""

PARALLEL: Final = 1e-9
"""Cosine of the angle of two axes, beside 1, under which a file means them to be parallel.

Quarter turns are written with six digits or more: a cosine beside 1 is then right to 1e-12."""

UNIT: Final = 2.0**-52
"""Rounding of one operation on doubles; the measure of every error bound."""

ON_ARC: Final = 1e-8
"""Margin, beside the lengths that go into it, below which a place of an arc is on its boundary.

A place of an arc is a root in doubles: what it leaves is its rounding, 1e-14 of these lengths, and
where a small distance is kept the square root of that."""

TIED: Final = 1e-9
"""Part of a number, or of a joint's unit, by which two numbers may differ and count as equal where
things are put in order.

Areas and places from either base, in any unit and on any processor agree to 1e-12 of these."""

FARTHEST: Final = 1e6
"""Largest angle that a command takes, rad: of 1e16 rad, doubles know not even the turn.

The last digit of this one moves the tip of an arm by 1e-10 of its length."""
