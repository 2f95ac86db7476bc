"""Which balls cover a link? Each shape by its own kind of cover, seen from the link's frame."""

from __future__ import annotations

from collections.abc import Sequence
from functools import singledispatch

from qbound.geometry.covering import Cover, joined
from qbound.geometry.mesh_covers import mesh_cover
from qbound.geometry.solid_covers import ball_cover, box_cover, capsule_cover, cylinder_cover
from qbound.urdf.poses import Pose
from qbound.urdf.shapes import Box, Capsule, Collision, Cylinder, Solid, Sphere, Triangles


def link_cover(shapes: Sequence[Collision], pose: Pose, excess: float) -> Cover:
    """Cover all shapes of a link, whose frame stands so in the frame asked for.

    Raises
    ------
    qbound.model.robotcheck.RobotFileError
        If a shape cannot be covered to that excess.
    """
    covers = []
    for shape in shapes:
        try:
            cover = solid_cover(shape.solid, excess)
        except ValueError as error:
            shape.element.fault(str(error))
        centres = pose.then(shape.pose).places(cover.centres)
        covers.append(Cover(centres, cover.radii, cover.excess))
    return joined(covers)


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
