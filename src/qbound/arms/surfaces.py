"""The boundary of a region of three joints as a surface, each of its triangles named.

Marching cubes give triangles on a grid of margins. Newton's method moves every vertex onto the
boundary function that is active there. Where two or three functions meet, it moves the vertex onto
all of them, so edges and corners stay sharp. The paper announces such surfaces in its last section.

A feature that is smaller than a step of the grid may be missed. Files for other programs are PLY
and glTF, by trimesh.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import combinations
from typing import Any, Final, Self

import numpy as np
from numpy.typing import NDArray

from qbound.arms.links import link_pair
from qbound.arms.surface_forms import (
    BLOCK,
    ON_FORM,
    TIED,
    Axis,
    SurfaceForms,
    axis_of,
    first_least,
    grid_values,
    settled,
    surface_forms,
)
from qbound.arrays import Bools, Floats
from qbound.extras import require
from qbound.geometry.isosurface import marching_cubes
from qbound.model.robot import Held, Robot, refuse_no_robot
from qbound.printable import printable
from qbound.proofs.subdivide import Rows

Ints = NDArray[np.intp]

RESOLUTION: Final = 40
"""Steps of the grid along each joint."""

FINEST: Final = 256
"""Steps at most: the grid is held in memory."""


@dataclass(frozen=True, eq=False)
class Surface:
    """The surface at which the safe values of three joints end.

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
        Whether limits are part of the surface. If not, the surface is open there. It is always open
        at the seam of a joint that turns all the way round, where the curves on both sides are
        equal.
    vertices : ndarray, shape (v, 3)
        rad or length.
    triangles : ndarray of int, shape (t, 3)
        Counter-clockwise seen from the side where the arm is in contact.
    active : ndarray of int, shape (t,)
        The boundary that each triangle lies on, an index into `boundaries`.
    boundaries : tuple of str
        Names of the boundaries that may be active within the ranges; then of the limits, such as
        ``elbow.lower``, if the surface is capped.
    exact : ndarray of bool, shape (v,)
        Whether a vertex is on its boundary, within 1e-12 of the size of its function. A vertex at
        which the function has no slope stays where the grid has it.
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
        """Names of the boundaries with triangles, one for each pair of links, by falling area."""
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
        """Volume of the feasible set, product of the joints' units; only for a capped surface.

        None if the surface is open, or all three joints turn all the way round.
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
        Whether joint limits are part of the surface, so that it encloses the feasible set.

    Raises
    ------
    ValueError
        If these are not three joints, one of them is held, a held value is beyond its limits, a
        boundary is about bodies, or the grid is too coarse or too fine.

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
    """Return the values of all joints that are not axes: as given, else at home."""
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
    """Return the grid's places along an axis; where limits are caps they go half a step beyond."""
    low, high = axis.ends
    closed = caps and not axis.around
    half = (high - low) / steps / 2 if closed else 0.0
    return np.linspace(low - half, high + half, steps + (2 if closed else 1))


def _marched(forms: SurfaceForms, values: Floats, grid: list[Floats]) -> Mesh:
    """Return marching cubes' triangles, counter-clockwise seen from where values are negative.

    A vertex lies on an edge of the grid. Each function is taken as linear between both ends, and
    the vertex is where the first one vanishes, counted from the feasible end. The functions are
    taken one by one, because their minimum is not linear.
    """
    if not values.min() < 0 < values.max():
        return Mesh.empty()
    places, triangles = marching_cubes(values)
    ends = np.stack([np.floor(places), np.ceil(places)]).astype(np.intp)
    signs = values[tuple(np.moveaxis(ends, -1, 0))]
    first = (signs[0] >= signs[1])[:, None]
    within = _at(grid, np.where(first, ends[0], ends[1]))
    beyond = _at(grid, np.where(first, ends[1], ends[0]))
    vertices, nearest = _first_roots(forms, within, beyond)
    last = np.array(values.shape) - 1
    return Mesh(
        vertices=vertices,
        triangles=triangles,
        active=np.zeros(len(triangles), dtype=np.intp),
        exact=np.zeros(len(vertices), dtype=np.bool_),
        held=(places == 0) | (places == last),
        nearest=nearest,
    )


def _at(grid: list[Floats], index: Ints) -> Floats:
    return np.column_stack([places[k] for places, k in zip(grid, index.T, strict=True)])


def _first_roots(forms: SurfaceForms, within: Floats, beyond: Floats) -> tuple[Floats, Ints]:
    """Return where each edge leaves the feasible set and by which function, taken as linear."""
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


# --- triangles put onto the zeros of the functions ------------------------------------------------


MOST: Final = 3
"""Functions that meet in a corner of three joints; more only by chance."""

VIOLATED: Final = 4 * ON_FORM
"""A function, by its size, that is less than minus this is violated; above, it may vanish."""

CUTS: Final = 3
"""Rounds of cutting: between two functions a third may come up."""

FAR: Final = 10.0
"""Steps that no place is moved by."""

WELDED: Final = 9
"""Digits of a step in which the places of one vertex agree."""

NONE: Final = -1
"""Stands for a function in a set that has fewer."""


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles in space.

    Attributes
    ----------
    vertices : ndarray, shape (v, 3)
    triangles : ndarray of int, shape (t, 3)
    active : ndarray of int, shape (t,)
        The function that each triangle lies on.
    exact : ndarray of bool, shape (v,)
        Whether a vertex is on a function that is active there.
    held : ndarray of bool, shape (v, 3)
        Coordinates of vertices on the border of the grid, which stay there.
    nearest : ndarray of int, shape (v,)
        The function that the search for a vertex begins with.
    """

    vertices: Floats
    triangles: Ints
    active: Ints
    exact: Bools
    held: Bools
    nearest: Ints

    @classmethod
    def empty(cls) -> Self:
        """Return the mesh of no triangles."""
        none, number = np.empty((0, 3)), np.empty(0, dtype=np.intp)
        return cls(none, none.astype(np.intp), number, number == 0, none == 0, number)


@dataclass(frozen=True, eq=False)
class Placed(Rows):
    """Vertices on their functions.

    Attributes
    ----------
    vertices : ndarray, shape (v, 3)
    sets : ndarray of int, shape (v, MOST)
        The functions of each vertex, in the order in which they were met; `NONE` after the last.
    exact : ndarray of bool, shape (v,)
    held : ndarray of bool, shape (v, 3)
        As in `Mesh`.
    """

    vertices: Floats
    sets: Ints
    exact: Bools
    held: Bools


def refined(forms: SurfaceForms, mesh: Mesh, step: Floats) -> Mesh:
    """Move a mesh onto its functions, and cut it where they meet.

    Parameters
    ----------
    step : ndarray, shape (3,)
        Of the grid.
    """
    placed = _onto_active(forms, mesh.vertices, mesh.nearest[:, None], mesh.held, step)
    triangles, before = mesh.triangles, 0
    for _ in range(CUTS):
        triangles, placed, before = *_cut(forms, triangles, placed, step), len(triangles)
        if len(triangles) == before:
            break
    number, kept = _welded(placed.vertices / step)
    triangles = number[triangles]
    real = (triangles != np.roll(triangles, 1, axis=1)).all(axis=1)
    vertices, triangles = placed.vertices[kept], triangles[real]
    return replace(
        mesh,
        vertices=vertices,
        triangles=triangles,
        active=_labels(forms, vertices, triangles, placed.sets[kept]),
        exact=placed.exact[kept],
        held=placed.held[kept],
        nearest=placed.sets[kept, 0],
    )


def _welded(places: Floats) -> tuple[Ints, Ints]:
    """Return a number for each place, the same for equal places, and one place for each number."""
    _, kept, number = np.unique(
        places.round(WELDED), axis=0, return_index=True, return_inverse=True
    )
    return number.ravel(), kept


def _cut(forms: SurfaceForms, triangles: Ints, placed: Placed, step: Floats) -> tuple[Ints, Placed]:
    """Cut edges whose ends have no function in common, and triangles whose corners have none."""
    edges, of_triangle = _edges(triangles)
    one, other = placed.sets[edges[:, 0]], placed.sets[edges[:, 1]]
    cut = ~_shares(one, other)
    ends = edges[cut]
    on_edges = _onto_active(
        forms,
        placed.vertices[ends].mean(axis=1),
        np.column_stack([one[cut, 0], other[cut, 0]]),
        np.asarray(placed.held[ends].all(axis=1)),
        step,
    )
    number = np.full(len(edges), NONE, dtype=np.intp)
    number[cut] = len(placed.vertices) + np.arange(len(ends))
    cuts = number[of_triangle]  # (t, 3): the vertex on the edge after each corner
    missing = (cuts != NONE).sum(axis=1)
    in_three = (missing == 3) | ((missing == 0) & ~_common(placed.sets[triangles]).any(axis=1))
    corners = triangles[in_three]
    in_corners = _onto_active(
        forms,
        placed.vertices[corners].mean(axis=1),
        _triples(placed.sets[corners]),
        np.asarray(placed.held[corners].all(axis=1)),
        step,
    )
    centre = np.full(len(triangles), NONE, dtype=np.intp)
    centre[in_three] = len(placed.vertices) + len(ends) + np.arange(len(corners))
    return _divided(triangles, cuts, centre), Placed.joined((placed, on_edges, in_corners))


def _triples(sets: Ints) -> Ints:
    """Return three functions of the corners of triangles, shape (k, 3, MOST) to (k, MOST)."""
    rows = [list(dict.fromkeys(row.T[row.T != NONE].tolist()))[:MOST] for row in sets]
    padded = [row + [NONE] * (MOST - len(row)) for row in rows]
    return np.array(padded, dtype=np.intp).reshape(-1, MOST)


def _onto_active(
    forms: SurfaceForms, start: Floats, wanted: Ints, held: Bools, step: Floats
) -> Placed:
    """Move places onto wanted functions; if another function is then negative, onto that one too.

    If the functions do not meet, a place goes onto some of them, because a strip of a third
    function, narrower than a step, may lie between two others. If that fails too, the place stays.
    """
    count = len(start)
    sets = np.full((count, MOST), NONE, dtype=np.intp)
    sets[:, : wanted.shape[1]] = wanted
    vertices, exact = start.copy(), np.zeros(count, dtype=np.bool_)
    violated = np.full(count, NONE, dtype=np.intp)
    left = np.arange(count)
    for _ in range(MOST + 1):
        place, found = _by_size(forms, start[left], sets[left], held[left], step)
        which, least = forms.least(place)
        safe = least >= -VIOLATED
        done = found & safe
        vertices[left[done]], exact[left[done]] = place[done], True
        violated[left] = which
        full = sets[left, MOST - 1] != NONE
        more = found & ~safe & ~full & ~(sets[left] == which[:, None]).any(axis=1)
        left, which = left[more], which[more]
        sets[left, (sets[left] != NONE).sum(axis=1)] = which
    rest = np.flatnonzero(~exact)
    active, _ = forms.least(start[rest])
    known = np.column_stack([violated[rest], active, sets[rest]])
    vertices[rest], sets[rest], exact[rest] = _onto_some(
        forms, start[rest], known, held[rest], step
    )
    return Placed(vertices, sets, exact, held)


def _onto_some(
    forms: SurfaceForms, start: Floats, known: Ints, held: Bools, step: Floats
) -> tuple[Floats, Ints, Bools]:
    """Move places onto the zero of some of their functions at which no function is negative.

    The nearest such zero is taken, the first of equally near ones. A zero on the first function is
    preferred, because that function lies between the others.

    Parameters
    ----------
    known : ndarray of int, shape (N, k)
        The functions to choose from; a place for which none will do stays, with the second.
    """
    best = np.full(len(start), np.inf)
    place, sets = start.copy(), np.full((len(start), MOST), NONE, dtype=np.intp)
    sets[:, 0] = known[:, 1]
    repeated = [(known[:, :k] == known[:, [k]]).any(axis=1) for k in range(known.shape[1])]
    usable = (known != NONE) & ~np.column_stack(repeated)
    for size in range(1, MOST + 1):
        for chosen in map(list, combinations(range(known.shape[1]), size)):
            here = np.flatnonzero(usable[:, chosen].all(axis=1))
            wanted = known[here][:, chosen]
            moved, found = forms.onto(start[here], wanted, held[here], step)
            away = np.linalg.norm((moved - start[here]) / step, axis=1) + FAR * (0 not in chosen)
            better = found & (away < best[here] - TIED)
            better[better] = forms.least(moved[better])[1] >= -VIOLATED
            at = here[better]
            best[at], place[at], sets[at, :size] = away[better], moved[better], wanted[better]
            sets[at, size:] = NONE
    return place, sets, np.isfinite(best)


def _by_size(
    forms: SurfaceForms, start: Floats, sets: Ints, held: Bools, step: Floats
) -> tuple[Floats, Bools]:
    """Move places onto the functions of their sets; sets of one size are solved together."""
    place, found = start.copy(), np.zeros(len(start), dtype=np.bool_)
    sizes = (sets != NONE).sum(axis=1)
    for size in range(1, MOST + 1):
        here = np.flatnonzero(sizes == size)
        for part in np.split(here, range(BLOCK, len(here), BLOCK)):
            moved = forms.onto(start[part], sets[part, :size], held[part], step)
            place[part], found[part] = moved
    return place, found


def _edges(triangles: Ints) -> tuple[Ints, Ints]:
    """Return the edges of a mesh, (e, 2), and those after each corner of a triangle, (t, 3)."""
    ends = np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=-1).reshape(-1, 2)
    edges, number = np.unique(np.sort(ends, axis=1), axis=0, return_inverse=True)
    return edges, number.reshape(-1, 3)


def _shares(one: Ints, other: Ints) -> Bools:
    """Tell which sets have a function in common."""
    same = (one[:, :, None] == other[:, None, :]) & (one[:, :, None] != NONE)
    return np.asarray(same.any(axis=(1, 2)))


def _divided(triangles: Ints, cuts: Ints, centre: Ints) -> Ints:
    """Divide triangles along cuts of their edges; a triangle with three cuts gets a centre.

    The sense of the triangles stays.
    """
    parts = []
    for count in range(4):
        here = (cuts != NONE).sum(axis=1) == count
        corner, on = triangles[here], cuts[here]
        if count in (1, 2):  # turn it so that the cuts begin with the first edge
            first = (on != NONE) & ((count == 1) | (np.roll(on, -1, axis=1) != NONE))
            turn = (np.arange(3) + first.argmax(axis=1)[:, None]) % 3
            corner, on = (np.take_along_axis(x, turn, axis=1) for x in (corner, on))
        (a, b, c), (ab, bc, ca), m = corner.T, on.T, centre[here]
        parts += {
            0: [(a[m == NONE], b[m == NONE], c[m == NONE]), *_about(a, b, c, m)],
            1: [(a, ab, c), (ab, b, c)],
            2: [(ab, b, bc), (a, ab, bc), (a, bc, c)],
            3: [(a, ab, m), (ab, b, m), (b, bc, m), (bc, c, m), (c, ca, m), (ca, a, m)],
        }[count]
    return np.concatenate([np.stack(part, axis=1) for part in parts])


def _about(a: Ints, b: Ints, c: Ints, m: Ints) -> list[tuple[Ints, Ints, Ints]]:
    """Divide each triangle that has a centre into three around the centre."""
    a, b, c, m = (x[m != NONE] for x in (a, b, c, m))
    return [(a, b, m), (b, c, m), (c, a, m)]


def _common(sets: Ints) -> Bools:
    """Tell which functions of the first corner all corners of a triangle share, (t, MOST)."""
    one, *others = (sets[:, k] for k in range(3))
    found = one != NONE
    for other in others:
        found = found & (one[:, :, None] == other[:, None]).any(axis=2)
    return np.asarray(found)


def _labels(forms: SurfaceForms, vertices: Floats, triangles: Ints, sets: Ints) -> Ints:
    """Return the function that all corners of a triangle share, else the active one inside."""
    common = _common(sets[triangles])
    labels = sets[triangles[:, 0]][np.arange(len(triangles)), common.argmax(axis=1)]
    unclear = np.flatnonzero(common.sum(axis=1) != 1)
    labels[unclear] = forms.least(vertices[triangles[unclear]].mean(axis=1))[0]
    return np.asarray(labels)


# --- files: PLY and glTF --------------------------------------------------------------------------


COLOURS: Final = (
    "#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#D55E00", "#F0E442",
)  # fmt: skip
"""Of the pairs of links with the largest areas (Okabe and Ito, for colour-blind readers)."""

OTHERS: Final = "#8C8C8C"
"""Of all further pairs."""


def colour_of(pair: int) -> str:
    """Return the colour of a number of `Surface.pairs`."""
    return COLOURS[pair] if pair < len(COLOURS) else OTHERS


def ply_bytes(surface: Surface) -> bytes:
    """Return binary PLY: vertices in rad or length, a colour on every triangle.

    Raises
    ------
    ValueError
        If the surface has no triangle.
    ModuleNotFoundError
        If trimesh is missing.
    """
    trimesh = _trimesh(surface)
    mesh = trimesh.Trimesh(surface.vertices, surface.triangles, process=False)
    mesh.visual.face_colors = _rgba()[np.minimum(surface.pair, len(COLOURS))]
    return bytes(mesh.export(file_type="ply"))


def glb_bytes(surface: Surface) -> bytes:
    """Return binary glTF: a mesh for every pair of links, named and coloured as in the page.

    Errors as in `ply_bytes`.
    """
    trimesh = _trimesh(surface)
    scene = trimesh.Scene()
    for k, name in enumerate(surface.pairs):
        used, triangles = np.unique(surface.triangles[surface.pair == k], return_inverse=True)
        mesh = trimesh.Trimesh(surface.vertices[used], triangles.reshape(-1, 3), process=False)
        mesh.visual.face_colors = _rgba()[min(k, len(COLOURS))]
        scene.add_geometry(mesh, node_name=printable(name), geom_name=printable(name))
    return bytes(scene.export(file_type="glb"))


def _rgba() -> NDArray[np.uint8]:
    """Return the colours, shape (k, 4); the last is for all other pairs."""
    rows = [bytes.fromhex(colour[1:]) for colour in (*COLOURS, OTHERS)]
    return np.array([[*row, 255] for row in rows], dtype=np.uint8)


def _trimesh(surface: Surface) -> Any:
    if not len(surface.triangles):
        raise ValueError("no boundary is active within these ranges: there is no surface to write")
    require("trimesh", "PLY or glTF")
    import trimesh

    return trimesh
