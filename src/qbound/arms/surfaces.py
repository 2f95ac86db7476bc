"""The boundary of a region of three joints as a surface, each of its triangles named.

Marching cubes give triangles on a grid of margins; Newton's method puts every vertex onto the
boundary function that is active there, and where two or three meet onto all of them, so that edges
and corners are as sharp as they are. The paper announces such surfaces in its last section.

What is smaller than a step of the grid may be missed, as by every grid.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray

from qbound.arms.links import link_pair
from qbound.arms.surface_forms import (
    BLOCK,
    TIED,
    Axis,
    SurfaceForms,
    axis_of,
    first_least,
    settled,
    surface_forms,
)
from qbound.arms.surface_grid import grid_values
from qbound.arms.surface_mesh import Mesh, refined
from qbound.arrays import Floats
from qbound.extras import require
from qbound.model.robot import Held, Robot, refuse_no_robot
from qbound.printable import printable

Ints = NDArray[np.intp]

RESOLUTION: Final = 40
"""Steps of the grid along each joint."""

FINEST: Final = 256
"""Steps at most: the grid is held in memory."""


@dataclass(frozen=True, eq=False)
class Surface:
    """Where safe values of three joints end.

    Attributes
    ----------
    robot : Robot
    axes : tuple of Axis
        The three joints, ascending, and their ranges: the limits; of a joint that turns a turn or
        more, one turn.
    held : dict of int to float
        Values of the other joints, rad or length.
    resolution : int
        Steps of the grid along each axis.
    capped : bool
        Whether limits are part of the surface. Else it is open there, and at the seam of a joint
        that turns all the way round always: the curves on both sides of the seam are the same.
    vertices : ndarray, shape (v, 3)
        rad or length.
    triangles : ndarray of int, shape (t, 3)
        Counter-clockwise seen from the side where the arm is in contact.
    active : ndarray of int, shape (t,)
        The boundary that each lies on, a number of `boundaries`.
    boundaries : tuple of str
        Those that may be active within the ranges; then the limits, as ``elbow.lower``, if it is
        capped.
    exact : ndarray of bool, shape (v,)
        Whether a vertex is on its boundary, within 1e-12 of the size of its function. Where a
        surface has no slope it stays where the grid has it.
    feasible_part : float
        Part of the grid's places that are feasible.
    """

    robot: Robot
    axes: tuple[Axis, ...]
    held: dict[int, float]
    resolution: int
    capped: bool
    vertices: Floats
    triangles: Ints
    active: Ints
    boundaries: tuple[str, ...]
    exact: NDArray[np.bool_]
    feasible_part: float

    @cached_property
    def pairs(self) -> tuple[str, ...]:
        """What the triangles lie on by name, pairs of links in one: the largest area first."""
        area = np.bincount(self._pair_of[self.active], self.areas, len(self._pair_names))
        seen = np.unique(self._pair_of[self.active])
        return tuple(self._pair_names[k] for k in sorted(seen, key=lambda k: (-area[k], k)))

    @cached_property
    def pair(self) -> Ints:
        """The number in `pairs` of each triangle, shape (t,)."""
        number = {name: k for k, name in enumerate(self.pairs)}
        of_name = np.array([number.get(name, -1) for name in self._pair_names], dtype=np.intp)
        return of_name[self._pair_of[self.active]]

    @property
    def areas(self) -> Floats:
        """Areas of the triangles, each axis in parts of its range, shape (t,)."""
        wide = np.array([axis.ends[1] - axis.ends[0] for axis in self.axes])
        return np.asarray(np.linalg.norm(_normals(self.vertices / wide, self.triangles), axis=1))

    @property
    def volume(self) -> float | None:
        """Volume of what is feasible, in the product of the joints' units; of a capped surface.

        None where it is open, or all three joints turn all the way round.
        """
        walls = [k for k, axis in enumerate(self.axes) if not axis.around]
        if not self.capped or not walls:
            return None
        axis = walls[0]  # the flux of x e_x: through the seams of other axes it is 0
        heights = self.vertices[self.triangles, axis].mean(axis=1)
        return float(heights @ _normals(self.vertices, self.triangles)[:, axis])

    @cached_property
    def _pair_names(self) -> tuple[str, ...]:
        return tuple(dict.fromkeys(self._named))

    @cached_property
    def _pair_of(self) -> Ints:
        number = {name: k for k, name in enumerate(self._pair_names)}
        return np.array([number[name] for name in self._named], dtype=np.intp)

    @cached_property
    def _named(self) -> list[str]:
        known = {boundary.name: boundary for boundary in self.robot.used}
        return [link_pair(self.robot, known[n]) if n in known else n for n in self.boundaries]


def find_surface(
    robot: Robot,
    joints: Sequence[int | str],
    held: Held | None = None,
    *,
    resolution: int = RESOLUTION,
    caps: bool = False,
) -> Surface:
    """Find the surface that bounds the safe values of three joints (eqs. 9-12).

    Parameters
    ----------
    robot : Robot
        Of three joints or more; its boundaries are about points and balls.
    joints : sequence of int or str
        Three joints, by index or name.
    held : mapping of int or str to float, optional
        Values of other joints, rad or length; those that are not named are at home.
    resolution : int
        Steps of the grid along each joint.
    caps : bool
        Whether joint limits are part of the surface: then it encloses what is feasible.

    Raises
    ------
    ValueError
        If these are not three joints, one of them is held, a held value is beyond its limits, a
        boundary is about bodies, or the grid is too coarse or too fine.
    ModuleNotFoundError
        If scikit-image is missing.

    Examples
    --------
    A hand that slides along three axes, 1 m each way, and a ball of 0.75 m that it must not touch:

    >>> import numpy as np
    >>> from qbound.model.robot import Pair, Point, Prismatic, Robot
    >>> slide = [
    ...     Prismatic(
    ...         f"q{k}", str(k), str(k + 1), np.zeros(3), np.eye(3), np.eye(3)[k], (-1.0, 1.0)
    ...     )
    ...     for k in range(3)
    ... ]
    >>> points = (Point("hand", "3", np.zeros(3)), Point("ball", "0", np.zeros(3), 0.75))
    >>> apart = (Pair("apart", ("hand", "ball")),)
    >>> robot = Robot("hand", tuple(slide), points, apart, np.ones(3), "hand", "m", "rad")
    >>> surface = find_surface(robot, ["q0", "q1", "q2"], caps=True)
    >>> round(surface.volume, 1), round(8 - np.pi * 4 / 3 * 0.75**3, 1)
    (6.2, 6.2)
    >>> [name for name in surface.pairs if "." not in name]
    ['apart']
    """
    require("skimage", "a surface")
    refuse_no_robot("find_surface", robot)
    if not 4 <= resolution <= FINEST:
        raise ValueError(f"a resolution of {resolution}; from 4 to {FINEST} steps are possible")
    axes = [axis_of(robot, joint) for joint in _three(robot, joints)]
    rest = _rest(robot, [axis.joint for axis in axes], held or {})
    forms = surface_forms(robot, rest, axes, caps=caps)
    grid = [_places(axis, caps, resolution) for axis in axes]
    forms, values = grid_values(forms, grid)
    mesh = _marched(forms, values, grid)
    if len(mesh.triangles):
        mesh = refined(forms, mesh, np.array([places[1] - places[0] for places in grid]))
    return Surface(
        robot=robot,
        axes=tuple(axes),
        held=rest,
        resolution=resolution,
        capped=caps,
        vertices=mesh.vertices,
        triangles=mesh.triangles,
        active=mesh.active,
        boundaries=forms.names,
        exact=mesh.exact,
        feasible_part=float((values >= 0).mean()),
    )


def _three(robot: Robot, joints: Sequence[int | str]) -> list[int]:
    axes = sorted({robot.joint_index(joint) for joint in joints})
    if len(axes) != 3 or len(joints) != 3:
        raise ValueError(f"a surface has three different joints as its axes; found {len(joints)}")
    return axes


def _rest(robot: Robot, axes: list[int], held: Held) -> dict[int, float]:
    """Return the values of all joints that are no axes: as given, else home."""
    given = robot.held_indices(held)
    names = [printable(robot.joints[j].name) for j in given if j in axes]
    if names:
        raise ValueError(f"{', '.join(names)}: an axis of the surface is not held")
    rest = {j: float(robot.home[j]) for j in range(len(robot.joints)) if j not in axes} | given
    for j, value in given.items():
        limits = robot.joints[j].limits
        if limits is not None and not limits[0] <= value <= limits[1]:
            name = printable(robot.joints[j].name)
            raise ValueError(f"{name}: held at {value:g}, beyond its limits {limits}")
    return dict(sorted(rest.items()))


def _places(axis: Axis, caps: bool, steps: int) -> Floats:
    """Return the places of the grid along an axis; beyond limits that are caps by half a step."""
    low, high = axis.ends
    closed = caps and not axis.around
    half = (high - low) / steps / 2 if closed else 0.0
    return np.linspace(low - half, high + half, steps + (2 if closed else 1))


def _marched(forms: SurfaceForms, values: Floats, grid: list[Floats]) -> Mesh:
    """Return marching cubes' triangles, counter-clockwise seen from where values are negative.

    A vertex lies on an edge of the grid. It is put where, from the feasible end on, the first
    function vanishes, as a straight line between both ends: the least of several is no line.
    """
    if not values.min() < 0 < values.max():
        return Mesh.empty()
    from skimage.measure import marching_cubes

    places, triangles, _, _ = marching_cubes(  # type: ignore[no-untyped-call]
        values, 0.0, gradient_direction="ascent", allow_degenerate=False
    )
    ends = np.stack([np.floor(places), np.ceil(places)]).astype(np.intp)
    signs = values[tuple(np.moveaxis(ends, -1, 0))]
    first = (signs[0] >= signs[1])[:, None]
    within = _at(grid, np.where(first, ends[0], ends[1]))
    beyond = _at(grid, np.where(first, ends[1], ends[0]))
    vertices, nearest = _first_roots(forms, within, beyond)
    last = np.array(values.shape) - 1
    return Mesh(
        vertices=vertices,
        triangles=triangles.astype(np.intp),
        active=np.zeros(len(triangles), dtype=np.intp),
        exact=np.zeros(len(vertices), dtype=np.bool_),
        held=(places == 0) | (places == last),
        nearest=nearest,
    )


def _at(grid: list[Floats], index: Ints) -> Floats:
    return np.column_stack([places[k] for places, k in zip(grid, index.T, strict=True)])


def _first_roots(forms: SurfaceForms, within: Floats, beyond: Floats) -> tuple[Floats, Ints]:
    """Return where each edge leaves what is feasible, and by which function, as straight lines."""
    part, which = np.empty(len(within)), np.empty(len(within), dtype=np.intp)
    for start in range(0, len(within), BLOCK):
        rows = slice(start, start + BLOCK)
        a, b = (settled(forms.relative(ends[rows])) for ends in (within, beyond))
        a = np.maximum(a, 0)
        root = np.divide(a, a - b, out=np.ones_like(a), where=b < 0)
        root = np.where(b <= 0, root, 2.0)
        which[rows] = first_least(root, TIED)
        part[rows] = np.minimum(root.min(axis=1), 1.0)
    return within + part[:, None] * (beyond - within), which


def _normals(vertices: Floats, triangles: Ints) -> Floats:
    """Return normals of the triangles as long as their areas, shape (t, 3)."""
    a, b, c = np.moveaxis(vertices[triangles], 1, 0)
    return np.asarray(np.cross(b - a, c - a) / 2)
