"""What must hold of every region: its arcs, its area and pieces on a grid, either joint as base."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from math import pi
from typing import Any
from unittest.mock import patch

import numpy as np
from numpy.testing import assert_allclose
from numpy.typing import NDArray
from scipy.ndimage import label
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from cspace.forms.factors import basis_and_slope
from cspace.region import Problem, Region, scene, solve
from cspace.region.places import CellMap
from engine_support.forms import LIMITS, Moved, Piece, Ranges
from qbound.forms import HarmonicForm, basis

SIDES = (("x.lower", "x.upper"), ("y.lower", "y.upper"))
GRID = 160
SMALL = 1e-5
"""Area under which a component may be left out of a comparison: two ways round it differently."""


def plate(*holes: tuple[float, float, float], ranges=((-3.0, 5.0), (-2.0, 4.0))) -> Problem:
    """A rectangle of two slides with round holes (x, y, radius)."""
    table = np.zeros((len(holes), 3, 3))
    for row, (x, y, r) in zip(table, holes, strict=True):
        row[0] = [x * x + y * y - r * r, -2 * y, 1]
        row[1, 0], row[2, 0] = -2 * x, 1
    names = tuple(f"hole {i}" for i in range(len(holes)))
    return Problem(HarmonicForm(table, ("prismatic", "prismatic")), names, ranges, SIDES)


# --- arcs ----------------------------------------------------------------------------------------


def relative(problem: Problem, q: np.ndarray) -> np.ndarray:
    """Value of every form beside the sum of its terms' sizes, shape (k, m)."""
    sizes = 1.0
    for j, kind in enumerate(problem.forms.kinds):
        factor = np.abs(basis(kind, q[:, j])).max(axis=-1)
        sizes = sizes * np.maximum(factor, 1)
    largest = np.abs(problem.forms.coefficients).max(axis=(1, 2))
    return problem.forms(q) / np.where(largest > 0, largest, 1) / np.asarray(sizes)[:, None]


def inside_limits(problem: Problem, q: np.ndarray, slack: float = 0.0) -> np.ndarray:
    held = np.ones(len(q), dtype=bool)
    for j, side in enumerate(problem.ranges):
        if side is not None:
            held &= (q[:, j] >= side[0] - slack) & (q[:, j] <= side[1] + slack)
    return held


def normal_of(problem: Problem, boundary: str, q: np.ndarray) -> np.ndarray:
    """Unit vector into the feasible side of a form or a limit, shape (2,); zero at a saddle."""
    for j, names in enumerate(problem.limits):
        if boundary in names:
            return np.eye(2)[j] * (1 if boundary == names[0] else -1)
    gradient = problem.forms[problem.names.index(boundary)].gradient(q)
    return gradient / max(np.linalg.norm(gradient), 1e-300)


def check_arcs(region: Region) -> None:
    problem = region.problem
    for component in region.components:
        for arc in (arc for loop in component.loops for arc in loop):
            values = relative(problem, arc.points)
            assert inside_limits(problem, arc.points, 1e-9).all()
            assert (values >= -1e-9).all()
            if arc.boundary in problem.names:
                assert np.abs(values[:, problem.names.index(arc.boundary)]).max() < 1e-9
            if component.area > SMALL:
                check_sides(problem, arc)


def check_sides(problem: Problem, arc) -> None:
    """The region lies on the left: a step to the left is feasible, to the right is not."""
    step = 1e-6
    k = len(arc.points) // 2
    before, after = arc.points[k - 1], arc.points[min(k + 1, len(arc.points) - 1)]
    q = arc.points[k] if len(arc.points) > 2 else (before + after) / 2
    along = after - before
    normal = normal_of(problem, arc.boundary, q)
    left = np.array([-along[1], along[0]])
    if np.linalg.norm(along) < 1e-3 or not normal.any() or crowded(problem, arc.boundary, q):
        return
    assert left @ normal > 0
    one, other = q[None] + step * normal, q[None] - step * normal
    assert inside_limits(problem, one).all()
    assert (problem.forms(one) > 0).all()
    assert not (inside_limits(problem, other).all() and (problem.forms(other) > 0).all())


def crowded(problem: Problem, boundary: str, q: np.ndarray) -> bool:
    """Whether another boundary passes within a few steps, or the form itself is flat here."""
    values = np.abs(relative(problem, q[None])[0])
    if boundary in problem.names:
        row = problem.names.index(boundary)
        scale = np.abs(problem.forms.coefficients[row]).max()
        if np.linalg.norm(problem.forms[row].gradient(q)) < 1e-2 * scale:
            return True
        values[row] = np.inf
    walls = [side for j, side in enumerate(problem.ranges) if side for side in np.abs(side - q[j])]
    near = sorted(walls)[(0 if boundary in problem.names else 1) :]
    return bool((values < 1e-3).any() or (np.array(near) < 1e-3).any())


# --- on a grid -----------------------------------------------------------------------------------


def sure_masks(problem: Problem, n: int = GRID):
    """Cells of a grid that are feasible for sure, cells that may be, and the cells' sides.

    A form moves from the middle of a cell by its gradient and a bound on its second derivatives.
    """
    ends = [side or (-pi, pi) for side in problem.ranges]
    h = np.array([(high - low) / n for low, high in ends])
    q = [low + (np.arange(n) + 0.5) * step for (low, _), step in zip(ends, h, strict=True)]
    table, kinds = problem.forms.coefficients, problem.forms.kinds
    both = [basis_and_slope(kind, x) for kind, x in zip(kinds, q, strict=True)]
    value, slope = ([each[:, k] for each in both] for k in (0, 1))
    middle, first, second = (
        np.einsum("mij,ai,bj->abm", table, one, other)
        for one, other in ((value[0], value[1]), (slope[0], value[1]), (value[0], slope[1]))
    )
    bend = np.einsum(
        "mij,i,j->m", np.abs(table), *(largest(k, e) for k, e in zip(kinds, ends, strict=True))
    )
    reach = np.abs(first) * h[0] / 2 + np.abs(second) * h[1] / 2 + bend * (h.sum() / 2) ** 2 / 2
    return (middle > reach).all(axis=-1), (middle >= -reach).all(axis=-1), h, q


def largest(kind: str, ends: tuple[float, float]) -> np.ndarray:
    """Bounds of 1, cos, sin (or 1, q, q^2) and of their first two derivatives over a range."""
    far = max(map(abs, ends))
    return np.ones(3) if kind == "revolute" else np.array([1, max(far, 1), max(far**2, 2 * far, 2)])


def flood(mask: np.ndarray, rounds: tuple[bool, bool], corners: bool) -> np.ndarray:
    """Label the pieces of a mask from 1, glued where a joint turns all the way round."""
    labels, count = label(mask, structure=np.ones((3, 3)) if corners else None)
    pairs = [np.zeros((2, 0), dtype=int)]
    for axis in (0, 1):
        if rounds[axis]:
            first, last = np.take(labels, 0, axis), np.take(labels, -1, axis)
            shifts = (-1, 0, 1) if corners else (0,)
            pairs += [np.stack([np.roll(first, s), last]) for s in shifts]
    one, other = np.concatenate(pairs, axis=1)
    both = (one > 0) & (other > 0)
    glue = coo_array((np.ones(both.sum()), (one[both], other[both])), shape=(count + 1,) * 2)
    return np.where(mask, connected_components(glue, directed=False)[1][labels] + 1, 0)


def check_grid(region: Region) -> None:
    """Area between that of the sure and of the possible cells; components by flood fill."""
    problem = region.problem
    sure, possible, h, q = sure_masks(problem)
    cell = h.prod()
    doubt = (possible & ~sure).sum() * cell
    assert sure.sum() * cell - 1e-9 <= region.area <= possible.sum() * cell + 1e-9
    rounds = tuple(side is None for side in problem.ranges)
    lots, lumps = flood(sure, rounds, corners=False), flood(possible, rounds, corners=True)
    n_lots, n_lumps = len(np.unique(lots[sure])), len(np.unique(lumps[sure]))
    areas = sorted((c.area for c in region.components), reverse=True)
    assert sum(area > doubt + 1e-9 for area in areas) <= n_lots
    assert len(areas) >= n_lumps
    if n_lots == n_lumps:  # the grid is fine enough to be sure of every piece
        sizes = np.sort(np.unique(lots[sure], return_counts=True)[1])[::-1] * cell
        assert (np.array(areas[:n_lots]) >= sizes - 1e-9).all()
    if not any(rounds):
        check_moments(region, sure, doubt, h, q)


def check_moments(region: Region, sure: np.ndarray, doubt: float, h, q) -> None:
    """First moments of the whole region, within what the doubtful cells can add."""
    moment = sum((c.area * c.centroid for c in region.components), np.zeros(2))
    counted = np.array([(sure * q[0][:, None]).sum(), (sure * q[1]).sum()]) * h.prod()
    far = np.array([np.abs(x).max() for x in q]) + h
    assert (np.abs(moment - counted) <= doubt * far + 1e-9).all()


# --- pieces, and either joint as the base --------------------------------------------------------


def problem_of(stack: HarmonicForm, ranges: Ranges) -> Problem:
    """The problem of forms that stand for themselves: their doubles are exact."""
    return Problem(stack, tuple(f"f{k}" for k in range(len(stack.coefficients))), ranges, LIMITS)


def pieces(stack: HarmonicForm, ranges: Ranges, base: int) -> list[Piece]:
    """Area, wraps and number of loops of what forms leave free, largest area first."""
    region = solve(problem_of(stack, ranges), base=base)
    assert region.base == base, "found over the other joint"
    return pieces_of(region)


def moved_pieces(moved: Moved, base: int) -> list[Piece]:
    """The same of forms whose doubles are only near what is meant."""
    with exactly(moved.exact, moved.ends, moved.errors):
        return pieces(moved.forms, moved.ranges, base)


@contextmanager
def exactly(exact: NDArray[Any], ends: Sequence[Any], errors: NDArray[Any]) -> Iterator[None]:
    """Within this, problems of `problem_of` have exact coefficients that are no doubles."""

    class Rows:
        """Exact rows of the forms that are left of a problem, and the ends of its ranges."""

        def __init__(self, problem: Problem) -> None:
            self.rows = rows_of(problem)

        def form(self, row: int) -> NDArray[Any]:
            return np.asarray(exact[self.rows[row]])

        def range(self, joint: int) -> Any:
            return ends[joint]

    def rows_of(problem: Problem) -> list[int]:
        return [int(name[1:]) for name in problem.names]

    off = property(lambda problem: errors[rows_of(problem)])
    with patch.object(Problem, "errors", off), patch.object(scene, "ExactRows", Rows):
        yield


def pieces_of(region: Region) -> list[Piece]:
    """The same of a region, with areas by a rule of its own."""
    cells, found = region.cells, []
    for k, component in enumerate(region.components):
        area = sum(area_of(cells, cell) for cell in np.flatnonzero(cells.owner == k))
        one, other = component.wraps
        found.append((area, (bool(one), bool(other)), len(component.loops)))
    return sorted(found, reverse=True)


def area_of(cells: CellMap, k: int, n: int = 20, panels: int = 120) -> float:
    """Gauss-Legendre in panels of the angle of t = middle + half sin(angle): no fold spoils it."""
    nodes, weights = np.polynomial.legendre.leggauss(n)
    start, end = cells.spans([k])[0]
    edges = np.linspace(-pi / 2, pi / 2, panels + 1)
    angle = (edges[:-1, None] + (nodes + 1) / 2 * pi / panels).ravel()
    t = (start + end) / 2 + (end - start) / 2 * np.sin(angle)
    lower, upper = cells.interval([k], t[None])[:, 0]
    steps = np.tile(weights, panels) * pi / panels / 2 * (end - start) / 2 * np.cos(angle)
    return ((upper - lower) * steps).sum()


def summary(region: Region, *, swap: bool = False) -> list[tuple[float, tuple[bool, bool], int]]:
    """Area, wraps and number of loops of the components that are not tiny."""
    rows = [(c.area, c.wraps[::-1] if swap else c.wraps, len(c.loops)) for c in region.components]
    return sorted((row for row in rows if row[0] > SMALL), reverse=True)


def same_pieces(found, expected, scale: float = 1.0) -> None:
    assert len(found) == len(expected)
    assert_allclose(
        [row[0] for row in found],
        [row[0] * scale for row in expected],
        rtol=1e-7,
        atol=1e-7 * scale,
    )
    assert [tuple(map(bool, row[1])) for row in found] == [tuple(map(bool, r[1])) for r in expected]
    assert [row[2] for row in found] == [row[2] for row in expected]


def check_roles(region: Region) -> None:
    """Either joint may be the base."""
    problem = region.problem
    for base in (0, 1):
        found = pieces_of(region if region.base == base else solve(problem, base=base))
        same_pieces([row for row in found if row[0] > SMALL], summary(region))
