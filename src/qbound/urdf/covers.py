"""Balls that cover a link: each shape by its own kind of cover, seen from the link's frame."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import singledispatch

import numpy as np

from qbound.geometry.covering import Cover, joined
from qbound.geometry.mesh_covers import mesh_cover
from qbound.geometry.solid_covers import ball_cover, box_cover, capsule_cover, cylinder_cover
from qbound.tolerances import OUTWARD
from qbound.urdf.poses import Pose
from qbound.urdf.shapes import Box, Capsule, Collision, Cylinder, Solid, Sphere, Triangles


def link_cover(shapes: Sequence[Collision], pose: Pose, excess: float) -> Cover:
    """Cover all shapes of a link, whose frame stands so in the frame asked for.

    Centres and radii come out as short decimals, to a thousandth of the excess or finer: a radius
    is so much larger that this, and the rounding of the poses, cost no cover.

    Raises
    ------
    qbound.model.robotcheck.RobotFileError
        If a shape cannot be covered to that excess.
    """
    digits = 3 - math.floor(math.log10(excess))
    covers = []
    for shape in shapes:
        try:
            cover = solid_cover(shape.solid, excess - 3 * 10.0**-digits)
        except ValueError as error:
            shape.element.fault(str(error))
        centres = pose.then(shape.pose).places(cover.centres)
        covers.append(_in_decimals(cover._replace(centres=centres), digits))
    return joined(covers)


def _in_decimals(cover: Cover, digits: int) -> Cover:
    """Move centres to decimals of so many places and enlarge the balls as that asks for."""
    centres = np.round(cover.centres, digits) + 0.0  # no -0.0
    moved = np.linalg.norm(centres - cover.centres, axis=1)
    needed = cover.radii + moved + OUTWARD * (np.abs(centres).sum(axis=1) + cover.radii)
    radii = np.round(np.ceil(needed * 10**digits) / 10**digits, digits)
    radii = np.where(radii < needed, np.round(radii + 10.0**-digits, digits), radii)
    more = float((radii - cover.radii + moved).max())
    return Cover(centres, radii, cover.excess + more * (1 + OUTWARD))


@singledispatch
def solid_cover(solid: Solid, excess: float) -> Cover:
    """Cover a shape by balls that stick out of it by an excess at most; lengths."""
    raise TypeError(f"no cover for a {type(solid).__name__}")


@solid_cover.register
def _(solid: Sphere, excess: float) -> Cover:
    return ball_cover(solid.radius)


@solid_cover.register
def _(solid: Capsule, excess: float) -> Cover:
    return capsule_cover(solid.radius, solid.length, excess)


@solid_cover.register
def _(solid: Cylinder, excess: float) -> Cover:
    return cylinder_cover(solid.radius, solid.length, excess)


@solid_cover.register
def _(solid: Box, excess: float) -> Cover:
    return box_cover(solid.size, excess)


@solid_cover.register
def _(solid: Triangles, excess: float) -> Cover:
    return mesh_cover(solid.corners, solid.closed, excess)
