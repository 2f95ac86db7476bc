r"""Map of reach: voxels that the tool of an arm reaches, and their volume with an error estimate.

All joints but one are sampled: first evenly as scrambled Sobol points, then near configurations
that led to the edge of the map. The travel of the last joint is exact (`fibres`), and so are the
voxels on its circle or line. So a marked voxel is reached; a voxel without a mark may be reached
too, because the other joints are sampled. Directions are those half-way through a voxel.

Voxels that a body touches have more volume than the body. Averaged over the position of the grid,
the surplus is proportional to the edge h, except for terms of second order. So the volume is
:math:`2 V_h - V_{2h}`. Every scramble has a grid of its own.

Not in the paper, whose workspaces are planar.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import product
from math import floor, log10, tau
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from qbound.arguments import number_above_zero
from qbound.arms.fibres import fibres
from qbound.arrays import Bools, Floats, Indices
from qbound.boundary.chain import Chain
from qbound.export.formats import heading, npz_bytes
from qbound.extras import require
from qbound.model.robot import Robot, refuse_no_robot
from qbound.model.rows import unit_vector
from qbound.printable import printable
from qbound.sampling import joint_ranges
from qbound.units import counted

BANDS, SECTORS = 6, 12
"""Directions are told apart by so many bands of equal height, each with so many sectors."""

MOST_CELLS = 64_000_000
"""Voxels of a grid, times directions where these are told apart."""

WORKING = 8
"""Bytes a voxel beside those: the map of a scramble, its copies with an edge, coarser ones."""

LONGEST_EDGE = 4
"""Edge of a voxel at most, in lengths of the arm."""

ROWS = 512
"""Fibres a block."""

CONFIDENCE = 0.95
"""How often chance alone changes a volume by no more than is said."""

SPREADS = (0.1, 0.03, 0.01, 0.1, 0.03, 0.01)
"""Standard deviations, as parts of a joint's range or a turn, of what is drawn about the edge."""

PILOT = 256
"""Fibres by which the joint is chosen that carries the tool farthest."""


@dataclass(frozen=True, eq=False)
class Reach:
    """The places of a robot's tool over all feasible configurations.

    Attributes
    ----------
    robot : Robot
    grid : Grid
    reached : ndarray of bool, shape grid.shape
    index : ndarray or None, shape grid.shape
        Reachability index: the part of all directions that the tool's axis was found to have within
        a voxel.
    joint : int
        The joint whose travel is exact.
    fibres : int
        Number of fibres that were computed.
    seed : int
    volumes : ndarray, shape (scrambles, 3)
        For each scramble three volumes, length cubed: the final one, the one a round before, and
        the one from voxels twice as long.
    """

    robot: Robot
    grid: Grid
    reached: Bools
    index: Floats | None
    joint: int
    fibres: int
    seed: int
    volumes: Floats

    def __repr__(self) -> str:
        """Say in a line how much is reached."""
        edge = f"{self.grid.edge:g} {self.robot.length_unit}"
        return (
            f"<Reach of {printable(self.robot.name)}: {int(self.reached.sum())} voxels of {edge}>"
        )

    @property
    def volume(self) -> float:
        """Mean of the scrambles' volumes; 0 where the extrapolation falls below it."""
        return max(0.0, float(self.volumes[:, 0].mean()))

    @property
    def standard_error(self) -> float:
        """Standard error of that mean, over the scrambles, which are independent."""
        return float(self.volumes[:, 0].std(ddof=1) / np.sqrt(len(self.volumes)))

    @property
    def chance(self) -> float:
        """Half width of the 95 % confidence interval of that mean.

        By Student's t: 3.18 standard errors for four scrambles.
        """
        from scipy.special import stdtrit

        return float(stdtrit(len(self.volumes) - 1, (1 + CONFIDENCE) / 2)) * self.standard_error

    @property
    def error(self) -> float:
        """Estimate of the volume's error: chance, voxels not found yet, and the edge of the voxels.

        The sum of `chance`, of what the last round added, and of half the change from voxels twice
        as long. The last term is cautious: a third of the change is enough if the remaining error
        is of second order in the edge.
        """
        last, before, coarse = self.volumes.mean(axis=0)
        return float(self.chance + abs(last - before) + abs(last - coarse) / 2)

    @property
    def marked_volume(self) -> float:
        """Volume of all voxels that are reached, in whole or in part."""
        return float(self.reached.sum() * self.grid.edge**3)

    @property
    def box(self) -> Floats | None:
        """Lowest and highest corner of the reached voxels, shape (2, 3); None if there are none."""
        if not self.reached.any():
            return None
        found = np.argwhere(self.reached)
        ends = np.stack([found.min(axis=0), found.max(axis=0) + 1])
        return np.asarray(self.grid.origin + self.grid.edge * ends)

    def section(self, axis: int, value: float) -> Floats:
        """Return the layer of voxels at a coordinate: index, or 1 where reached; NaN where not.

        Raises
        ------
        ValueError
            If the grid does not come to that value.
        """
        layer = floor((value - self.grid.origin[axis]) / self.grid.edge)
        if not 0 <= layer < self.grid.shape[axis]:
            low = float(self.grid.origin[axis])
            high = low + self.grid.edge * self.grid.shape[axis]
            raise ValueError(f"{'xyz'[axis]} = {value:g} is not within {low:g} and {high:g}")
        shown = self.reached.astype(float) if self.index is None else self.index
        return np.asarray(np.take(np.where(self.reached, shown, np.nan), layer, axis=axis))


def reach(
    robot: Robot,
    voxel: float | None = None,
    *,
    seed: int = 0,
    points: int = 4096,
    scrambles: int = 4,
    joint: int | str | None = None,
    axis: ArrayLike | None = None,
    progress: Callable[[int], None] | None = None,
) -> Reach:
    """Map the voxels that the tool reaches.

    Parameters
    ----------
    voxel : float, optional
        Edge of a voxel, length; default: some twentieth of the arm's reach.
    seed : int
        The same seed gives the same map.
    points : int
        Points that each scramble draws evenly, a power of two.
    scrambles : int
        At least 2, because the error is computed from their spread.
    joint : int or str, optional
        The joint whose travel is exact; default: the one that carries the tool farthest.
    axis : array_like, shape (3,), optional
        A direction fixed to the tool's frame. If given, the map also records which directions are
        reached in each voxel.
    progress : callable, optional
        Told how many scrambles are done.

    Raises
    ------
    ValueError
        If a number is out of range, the joint does not carry the tool, or a boundary is about
        bodies.

    Examples
    --------
    The gantry's tool moves in a plane, so it reaches voxels but has no volume.

    >>> from qbound import load_robot
    >>> found = reach(load_robot("pr-gantry-arm"), 0.2, points=64, scrambles=2)
    >>> bool(found.reached.any()), found.volume
    (True, 0.0)
    """
    refuse_no_robot("reach", robot)
    require("scipy", "a map of reach")
    _refuse_numbers(points, scrambles, seed)
    bins = 1 if axis is None else BANDS * SECTORS
    grid = _grid(robot, voxel, bins)
    paths = ToolPaths(robot, np.array([0.0, 0, 1]) if axis is None else unit_vector(_three(axis)))
    if not paths.depth:
        raise ValueError(f"{robot.tool}: the tool is fixed in the base")
    one = _farthest(robot, paths, seed) if joint is None else _carrying(robot, joint, paths.depth)
    survey = _Survey(robot, one, paths, grid, bins)
    found = []
    for scramble in range(scrambles):
        rng = np.random.default_rng([seed, scramble])
        shifted = Grid(grid.origin - rng.uniform(0, grid.edge, 3), grid.edge, grid.shape)
        found.append(survey.volumes(shifted, points, rng))
        if progress is not None:
            progress(scramble + 1)
    volumes = np.array(found)
    index = None if axis is None else survey.marked.mean(axis=1).reshape(grid.shape)
    reached: Bools = survey.marked.any(axis=1).reshape(grid.shape)
    return Reach(robot, grid, reached, index, one, survey.fibres, seed, volumes)


def map_bytes(robot: Robot, voxel: float | None, *, directions: bool = False) -> int:
    """Estimate the memory of a map: marks of each voxel, and the configuration that led there.

    Raises
    ------
    ValueError
        If the edge of the voxels is out of range.

    Examples
    --------
    >>> from qbound import load_robot
    >>> map_bytes(load_robot("ur5"), 0.02) // 10**6  # megabytes
    114
    """
    bins = BANDS * SECTORS if directions else 1
    cells = math.prod(_grid(robot, voxel, bins).shape)
    return cells * (8 * len(robot.joints) + bins + WORKING + 8 * directions)


class _Survey:
    """The state of a survey: voxels reached so far, and the number of fibres."""

    def __init__(self, robot: Robot, joint: int, paths: ToolPaths, grid: Grid, bins: int) -> None:
        self.robot, self.joint, self.paths, self.grid = robot, joint, paths, grid
        self.marked = np.zeros((int(np.prod(grid.shape)), bins), dtype=np.bool_)
        self.fibres = 0

    def volumes(self, grid: Grid, points: int, rng: np.random.Generator) -> list[float]:
        """Return three volumes on one grid: final, one round before, with voxels twice as long.

        Points are drawn evenly first. Then they are drawn near configurations that led to voxels at
        the edge, until a round finds no new voxel or the rounds are over.
        """
        touched = np.zeros(len(self.marked), dtype=np.bool_)
        leads = np.zeros((len(self.marked), len(self.robot.joints)))
        for q in _drawn(self.robot, self.joint, points, rng):
            self._look(q, grid, touched, leads)
        before = now = enclosed_volume(touched.reshape(grid.shape), grid.edge)
        for spread in SPREADS:
            known, before = touched.sum(), now
            about = leads[grid.at_edge(touched)]
            for k in range(0, len(about), ROWS):
                q = _near(self.robot, about[k : k + ROWS], spread, rng)
                self._look(q, grid, touched, leads)
            now = enclosed_volume(touched.reshape(grid.shape), grid.edge)
            if touched.sum() == known:
                break
        whole = touched.reshape(grid.shape)
        coarse = [enclosed_volume(each, 2 * grid.edge) for each in coarsened(whole)]
        return [now, before, float(np.mean(coarse))]

    def _look(self, q: Floats, grid: Grid, touched: Bools, leads: Floats) -> None:
        """Mark where the tool gets along the fibres of some configurations."""
        found = fibres(self.robot, self.joint, q)
        along = self.paths.along(self.joint, q.T)[found.rows]
        bins = self.marked.shape[1]
        here = crossed(self.grid, along, found.low, found.high)
        which = _bin(along[here.path].directions(here.q)) if bins > 1 else 0
        self.marked[here.voxel, which] = True
        here = crossed(grid, along, found.low, found.high)
        new = np.flatnonzero(~touched[here.voxel])
        voxel = here.voxel[new]
        leads[voxel] = q[found.rows[here.path[new]]]
        leads[voxel, self.joint] = here.q[new]
        touched[voxel] = True
        self.fibres += len(q)


def _refuse_numbers(points: int, scrambles: int, seed: int) -> None:
    if points < 2 or points & (points - 1):
        raise ValueError(f"points: {points} is no power of two, from 2 on")
    if scrambles < 2:
        raise ValueError(f"scrambles: {scrambles}; an error takes at least 2")
    if seed < 0:
        raise ValueError(f"seed {seed}: a seed is 0 or above")


def _three(axis: ArrayLike) -> list[float]:
    values = np.asarray(axis, dtype=float)
    if values.shape != (3,) or not np.isfinite(values).all() or not values.any():
        raise ValueError("axis: three finite numbers are wanted, not all zero")
    return [float(value) for value in values]


def _carrying(robot: Robot, joint: int | str, depth: int) -> int:
    one = robot.joint_index(joint)
    if one >= depth:
        raise ValueError(f"joint {robot.joints[one].name!r} does not carry the tool")
    return one


def _grid(robot: Robot, voxel: float | None, bins: int) -> Grid:
    """Return a grid that holds all places of the tool, with one more voxel on every side."""
    centre = np.asarray(robot.joints[0].origin, dtype=float)
    length = robot.stretched(robot.tool) - float(np.linalg.norm(centre))
    edge = _round_below(length / 20) if voxel is None else number_above_zero("voxel", voxel)
    if edge > LONGEST_EDGE * max(length, 1.0):
        raise ValueError(f"voxel: an edge of {edge:g} is too long for an arm of {length:g}")
    half = float(np.ceil(length / edge)) + 1.0
    if (2 * half) ** 3 * bins > MOST_CELLS:
        count = f"{(2 * half) ** 3:.3g} voxels" + f" of {bins} directions" * (bins > 1)
        raise ValueError(f"voxel: an edge of {edge:g} makes {count}; take a longer one")
    return Grid(centre - half * edge, edge, (int(2 * half),) * 3)


def _round_below(length: float) -> float:
    """Return the next of 1, 2, 5, 10, ... below a length."""
    if length <= 0:
        return 1.0
    power = 10.0 ** floor(log10(length))
    return float(max(step for step in (1, 2, 5) if step * power <= length) * power)


def _farthest(robot: Robot, paths: ToolPaths, seed: int) -> int:
    """Return the joint whose feasible travel carries the tool farthest, on the mean of a few."""
    lengths = []
    for j in range(paths.depth):
        q = next(_drawn(robot, j, PILOT, np.random.default_rng(seed)))
        along = paths.along(j, q.T)
        speed = np.sqrt(np.square(along.place[1]).sum(axis=0))
        lengths.append(float(np.mean(fibres(robot, j, q).length * speed)))
    return int(np.argmax(lengths))


def _drawn(robot: Robot, joint: int, points: int, rng: np.random.Generator) -> Iterator[Floats]:
    """Yield configurations with all joints but one drawn over their ranges; that one is at 0."""
    from scipy.stats import qmc

    others = [j for j in range(len(robot.joints)) if j != joint]
    low, high = joint_ranges(robot)[others].T
    sobol = qmc.Sobol(len(others), rng=rng) if others else None
    rows = min(ROWS, points)
    for _ in range(points // rows):
        q = np.zeros((rows, len(robot.joints)))
        if sobol is not None:
            q[:, others] = low + (high - low) * sobol.random(rows)
        yield q


def _near(robot: Robot, q: Floats, spread: float, rng: np.random.Generator) -> Floats:
    """Draw configurations near others, within the limits."""
    low, high = joint_ranges(robot).T
    drawn = q + rng.normal(0, spread, q.shape) * np.minimum(high - low, 2 * np.pi)
    endless = [joint.limits is None for joint in robot.joints]
    return np.asarray(np.where(endless, drawn, np.clip(drawn, low, high)))


def _bin(directions: Floats) -> Indices:
    """Return the number of the bin of unit vectors; all bins are as large on the sphere."""
    x, y, z = directions
    band = np.clip(np.floor((z + 1) / 2 * BANDS), 0, BANDS - 1)
    sector = np.mod(np.floor(np.arctan2(y, x) / (2 * np.pi) * SECTORS), SECTORS)
    return np.asarray(band * SECTORS + sector, dtype=np.intp)


# --- the circle or line along which a joint carries the tool --------------------------------------


@dataclass(frozen=True, eq=False)
class Paths:
    """Vectors as forms of one joint, seen from the base: n paths.

    Attributes
    ----------
    place : ndarray, shape (3, 3, n)
        Coefficients of (1, cos q, sin q) or (1, q, 0), by coordinates; length.
    direction : ndarray, shape (3, 3, n)
        The coefficients of a unit vector fixed to the tool's frame.
    turns : bool
        Whether the joint turns.
    """

    place: Floats
    direction: Floats
    turns: bool

    def __getitem__(self, which: NDArray[np.intp]) -> Paths:
        """Take some of the paths."""
        return Paths(self.place[..., which], self.direction[..., which], self.turns)

    def places(self, q: Floats) -> Floats:
        """Return the place on each path at one joint value each, shape (3, n)."""
        return self._at(self.place, q)

    def directions(self, q: Floats) -> Floats:
        """Return the direction on each path at one joint value each, shape (3, n)."""
        return self._at(self.direction, q)

    def _at(self, form: Floats, q: Floats) -> Floats:
        if self.turns:
            return np.asarray(form[0] + np.cos(q) * form[1] + np.sin(q) * form[2])
        return np.asarray(form[0] + q * form[1])


class ToolPaths:
    """The paths of a robot's tool along each joint.

    Parameters
    ----------
    axis : array_like, shape (3,)
        A direction fixed to the tool's frame.
    """

    def __init__(self, robot: Robot, axis: Floats) -> None:
        tool = robot.point(robot.tool)
        self.robot, self.depth = robot, robot.depth(tool.frame)
        self._chain = Chain(robot, [tool])
        self._frame = self._chain.depth(tool.frame)
        self._axis = self._chain.seen(axis, self._frame)

    def along(self, joint: int, q: Floats) -> Paths:
        """Return the paths along a joint that carries the tool.

        Parameters
        ----------
        q : ndarray, shape (joints, n)
            Configurations as columns; the joint's own value is not read.
        """
        poses = self._chain.poses(q, joint)
        (base, origin), (tool_axes, _) = poses[0], poses[self._frame]
        x, u = self._chain.places(poses)[:, 0], self._axis @ tool_axes
        x, u, origin = (np.broadcast_to(each, (3, q.shape[1])) for each in (x, u, origin))
        zero = np.zeros(q.shape[1])
        if self.robot.joints[joint].turns:
            crank = self._chain.crank(joint)
            if crank is not None and self._chain.groups(joint)[0] == 2:
                (a, b), turning = crank[:2, 0] + zero, zero
                ahead = x - origin - np.array([a, b, zero])
            else:
                (a, b), turning = x[:2], zero + 1
                ahead = np.array([zero, zero, x[2]]) - origin
            place = [list(ahead), [a, b, zero], [-b, a, zero]]
            about = [[u[0], u[1], zero], [-u[1], u[0], zero]]
            direction = [list(u - turning * about[0]), *(turning * np.array(about))]
        else:
            place = [list(x - origin), [zero, zero, zero + 1], [zero, zero, zero]]
            direction = [list(u), [zero] * 3, [zero] * 3]
        places, directions = (
            np.einsum("ijn,kin->kjn", base, np.array(each)) for each in (place, direction)
        )
        return Paths(places, directions, self.robot.joints[joint].turns)


# --- the voxels on such a path --------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Grid:
    """Cubes of one edge.

    Attributes
    ----------
    origin : ndarray, shape (3,)
        The lowest corner; length.
    edge : float
        Length.
    shape : tuple of int
        How many along x, y, z.
    """

    origin: Floats
    edge: float
    shape: tuple[int, int, int]

    def flat_index(self, places: Floats) -> Indices:
        """Return the number of the voxel of each place, shape (3, m) to (m,)."""
        index = np.floor((places - self.origin[:, None]) / self.edge).astype(np.intp)
        index = np.clip(index, 0, np.array(self.shape)[:, None] - 1)  # rounding at the last face
        return np.asarray(np.ravel_multi_index(tuple(index), self.shape))

    def at_edge(self, touched: Bools) -> Indices:
        """Return the numbers of voxels, of those touched, that have a face to one that is not."""
        padded = np.pad(touched.reshape(self.shape), 1)
        inner = padded.copy()
        for axis in range(3):
            inner &= np.roll(padded, 1, axis) & np.roll(padded, -1, axis)
        return np.flatnonzero((padded & ~inner)[1:-1, 1:-1, 1:-1])


def enclosed_volume(touched: Bools, edge: float) -> float:
    r"""Return the volume of a body that touches these voxels and no others, shape (n, n, n).

    The result is the volume of the voxels less their surplus. The surplus is proportional to the
    edge, except for terms of second order, so the result is :math:`2 V_h - V_{2h}`, averaged over
    the eight positions of the coarse grid.
    """
    coarse = np.mean([each.sum() for each in coarsened(touched)])
    return float((2 * touched.sum() - 8 * coarse) * edge**3)


def coarsened(touched: Bools) -> Iterator[Bools]:
    """Yield which voxels of twice the edge are touched, as they lie in each of eight ways."""
    for shift in product((0, 1), repeat=3):
        ends = [(s, (n + s) % 2) for n, s in zip(touched.shape, shift, strict=True)]
        padded = np.pad(touched, ends)
        pairs = padded.reshape([part for size in padded.shape for part in (size // 2, 2)])
        yield np.asarray(pairs.any(axis=(1, 3, 5)))


class Crossed(NamedTuple):
    """Voxels that paths go through, one after the other; one may come several times.

    Attributes
    ----------
    voxel : ndarray of int, shape (m,)
        Number of `Grid.flat_index`.
    path : ndarray of int, shape (m,)
    q : ndarray, shape (m,)
        Joint value half-way through the voxel.
    """

    voxel: Indices
    path: Indices
    q: Floats


def crossed(grid: Grid, paths: Paths, low: Floats, high: Floats) -> Crossed:
    """Return the voxels that paths go through.

    Parameters
    ----------
    paths : Paths
    low, high : ndarray, shape (n,)
        From where to where the joint moves along each.
    """
    if paths.turns:
        high = np.minimum(high, low + tau)
    number = np.arange(len(low))
    cuts = [(number, low), (number, high)]
    for coordinate in range(3):
        cuts += _at_faces(grid, coordinate, paths, low, high)
    path, q = (np.concatenate(each) for each in zip(*cuts, strict=True))
    order = np.lexsort((q, path))
    path, q = path[order], q[order]
    inside = np.flatnonzero(path[1:] == path[:-1])
    path, q = path[inside], (q[inside] + q[inside + 1]) / 2
    return Crossed(grid.flat_index(paths[path].places(q)), path, q)


def _at_faces(
    grid: Grid, coordinate: int, paths: Paths, low: Floats, high: Floats
) -> list[tuple[Indices, Floats]]:
    """Return the paths and joint values at which one coordinate is that of a face."""
    c, a, b = paths.place[:, coordinate]
    start, edge = grid.origin[coordinate], grid.edge
    size = np.hypot(a, b)
    if paths.turns:
        lowest, highest = c - size, c + size
    else:
        lowest, highest = (pick(c + a * low, c + a * high) for pick in (np.minimum, np.maximum))
    first = np.ceil((lowest - start) / edge)
    count = np.maximum(np.floor((highest - start) / edge) - first + 1, 0).astype(np.intp)
    path = np.repeat(np.arange(len(c)), count)
    face = first[path] + np.arange(len(path)) - np.repeat(np.cumsum(count) - count, count)
    rise = start + edge * face - c[path]
    moves = size[path] > 0
    path, rise = path[moves], rise[moves]
    if not paths.turns:
        return [(path, np.clip(rise / a[path], low[path], high[path]))]
    half = np.arccos(np.clip(rise / size[path], -1, 1))
    theta = np.arctan2(b, a)[path]
    return [_within(path, theta + side * half, low, high) for side in (-1, 1)]


def _within(path: Indices, q: Floats, low: Floats, high: Floats) -> tuple[Indices, Floats]:
    """Bring angles into a path's range by full turns; leave out angles that cannot lie in it."""
    q = low[path] + np.mod(q - low[path], tau)
    kept = q < high[path]
    return path[kept], q[kept]


# --- as others read it: JSON and sentences --------------------------------------------------------


def reach_document(found: Reach) -> dict[str, Any]:
    """Return the JSON form of a map, schema qbound/reach/1; its voxels are in `reach_npz`."""
    robot = found.robot
    box = found.box
    return {
        **heading("qbound/reach/1", robot),
        "length_unit": robot.length_unit,
        "seed": found.seed,
        "voxel": found.grid.edge,
        "exact_joint": robot.joints[found.joint].name,
        "fibres": found.fibres,
        "voxels": int(found.reached.sum()),
        "box": None if box is None else box.tolist(),
        "volume": {
            "value": found.volume,
            "error": found.error,
            "standard_error": found.standard_error,
            "scrambles": found.volumes[:, 0].tolist(),
            "before_last_round": float(found.volumes[:, 1].mean()),
            "voxels_twice_as_long": float(found.volumes[:, 2].mean()),
            "all_voxels": found.marked_volume,
        },
        "index": None if found.index is None else _index(found),
    }


def reach_lines(found: Reach) -> Iterator[str]:
    """Yield the size of the map, and what is exact in it."""
    robot, unit = found.robot, found.robot.length_unit
    if (box := found.box) is None:
        yield "no feasible configuration was found"
        return
    low, high = (", ".join(f"{x:.4g}" for x in corner) for corner in box)
    times = found.chance / found.standard_error if found.standard_error else 0.0
    chance = f"chance alone: {found.chance:.2g}, {times:.3g} standard errors"
    if (box[1] - box[0]).min() < 1.5 * found.grid.edge:  # one layer of voxels
        yield "the tool stays in a plane: it has an area there, which qbound workspace measures"
    else:
        yield f"volume {found.volume:.4g} +- {found.error:.2g} {unit}^3 ({chance})"
        yield "  an estimate, no bound: chance, places that are not found yet, and the voxels' edge"
    yield f"{counted(int(found.reached.sum()), 'voxel')} of {found.grid.edge:g} {unit}"
    yield f"  from ({low}) to ({high}) {unit}"
    if found.index is not None:
        index = _index(found)
        yield f"  reachability index: mean {index['mean']:.3g}, greatest {index['greatest']:.3g}"
    name = robot.joints[found.joint].name
    yield f"{found.fibres} fibres: exact along {name}, the other joints drawn (seed {found.seed})"


def reach_npz(found: Reach) -> bytes:
    """Return the arrays reached and index, with the grid's origin and edge."""
    index = {} if found.index is None else {"index": found.index}
    unit = np.array(found.robot.length_unit)
    grid = {"origin": found.grid.origin, "edge": np.array(found.grid.edge), "unit": unit}
    return npz_bytes({"reached": found.reached, **index, **grid})


def _index(found: Reach) -> dict[str, float]:
    values = np.zeros(1) if found.index is None else found.index[found.reached]
    return {"mean": float(values.mean()), "greatest": float(values.max())}
