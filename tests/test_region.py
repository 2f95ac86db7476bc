"""The region of two joints: random robots against grids and symmetries, and the paper's robot.

By hand, for many more robots than the suite takes: `python tests/test_region.py 10000`.
"""

import sys
import warnings
from dataclasses import replace
from functools import partial
from math import atan2, pi

import numpy as np
import pytest
from numpy.testing import assert_allclose
from oracles import circle_zeros, equation_29
from scipy.ndimage import label
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from test_decomposition import PP, PR, RP, RR, TURN, forms, pieces

from qbound import load_robot
from qbound.boundary.functions import clearance
from qbound.forms.harmonic import HarmonicForm, basis, basis_slope
from qbound.model.robot import HalfSpace, Joint, Pair, Point, Robot
from qbound.region import Problem, Region, find_region, paper_rule, solve, violated

MINERVA = load_robot("minervabot-v2")
LIMITS = (("q1.lower", "q1.upper"), ("q2.lower", "q2.upper"))
GRID = 160
SMALL = 1e-5
"""Area under which a component may be left out of a comparison: two ways round it differently."""

# --- random robots -------------------------------------------------------------------------------


def random_robot(seed: int) -> Robot:
    """A planar chain of two joints, eight points, up to four pairs and three walls."""
    rng = np.random.default_rng(seed)
    kinds = (RR, RP, PR, PP)[seed % 4]
    points = [Point(f"p{i}", str(rng.integers(0, 3)), in_plane(rng)) for i in range(8)]
    joints = tuple(random_joint(rng, j, kind) for j, kind in enumerate(kinds))
    boundaries = [random_pair(rng, i, points) for i in range(rng.integers(0, 5))]
    boundaries += [random_wall(rng, i, points) for i in range(rng.integers(0, 4))]
    home = np.array([rng.uniform(*(joint.limits or (-pi, pi))) for joint in joints])
    return Robot("r", joints, tuple(points), tuple(boundaries), home, "p0", "m", "rad")


def in_plane(rng) -> np.ndarray:
    x, z = rng.uniform(-2, 2, 2)
    return np.array([x, 0, z])


def random_joint(rng, j: int, kind: str) -> Joint:
    angle = rng.uniform(0, TURN)
    low, high = np.sort(rng.uniform(-4, 4, 2)) + np.array([-0.3, 0.3])
    limits = None if kind == "revolute" and rng.random() < 0.6 else (low, high)
    slide = np.array([np.cos(angle), 0, np.sin(angle)])
    axis = np.array([0.0, 1, 0]) if kind == "revolute" else slide
    return Joint(f"q{j + 1}", kind, str(j), str(j + 1), in_plane(rng), np.eye(3), axis, limits)


def random_pair(rng, i: int, points: list[Point]) -> Pair:
    one = points[rng.integers(0, 8)]
    others = [p for p in points if p.frame != one.frame] or [Point("p0", "0", np.zeros(3))]
    other = others[rng.integers(0, len(others))]
    return Pair(f"B{i}", (one.name, other.name), rng.uniform(0.2, 1.5))


def random_wall(rng, i: int, points: list[Point]) -> HalfSpace:
    angle = rng.uniform(0, TURN)
    normal = np.array([np.cos(angle), 0, np.sin(angle)])
    return HalfSpace(f"W{i}", points[rng.integers(0, 8)].name, normal, rng.uniform(-3, 1))


def drawn_robot(seed: int) -> Robot:
    """A robot as an engineer draws it: small whole numbers, points in line, walls along the axes.

    Here curves touch, coincide, are parallel and meet three at a time.
    """
    rng = np.random.default_rng(seed)
    kinds, whole = (RR, RP, PR, PP)[seed % 4], partial(rng.integers, endpoint=True)
    places = [np.array([whole(-2, 2), 0.0, whole(-2, 2) * rng.integers(0, 2)]) for _ in range(8)]
    points = [Point(f"p{i}", str(rng.integers(0, 3)), place) for i, place in enumerate(places)]
    joints = tuple(drawn_joint(rng, j, kind) for j, kind in enumerate(kinds))
    pairs = [random_pair(rng, i, points) for i in range(rng.integers(0, 5))]
    pairs = [replace(pair, clearance=whole(1, 4) / 2) for pair in pairs]
    axes = np.array([[1.0, 0, 0], [-1, 0, 0], [0, 0, 1], [0, 0, -1]])
    walls = [
        HalfSpace(f"W{i}", f"p{rng.integers(0, 8)}", axes[rng.integers(0, 4)], float(whole(-4, 0)))
        for i in range(rng.integers(0, 4))
    ]
    home = np.array([rng.uniform(*(joint.limits or (-pi, pi))) for joint in joints])
    return Robot("d", joints, tuple(points), (*pairs, *walls), home, "p0", "m", "rad")


def drawn_joint(rng, j: int, kind: str) -> Joint:
    limits = (-pi / 2, pi / 2) if kind == "revolute" else (-2.0, 2.0)
    if kind == "revolute" and rng.random() < 0.6:
        limits = None
    axis = [0.0, 1, 0] if kind == "revolute" else [[1.0, 0, 0], [0, 0, 1.0]][rng.integers(0, 2)]
    origin = np.array([rng.integers(0, 3), 0.0, rng.integers(0, 2)])
    return Joint(f"q{j + 1}", kind, str(j), str(j + 1), origin, np.eye(3), np.array(axis), limits)


# --- what is checked of each ---------------------------------------------------------------------


def check(robot: Robot) -> None:
    """Everything that must hold of one robot."""
    region = find_region(robot)
    check_arcs(region)
    check_home(robot, region)
    check_grid(region)
    check_polygons(region)
    check_roles(region)
    check_symmetries(robot, region)


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


def check_home(robot: Robot, region: Region) -> None:
    """There is a home component exactly where nothing is violated at home."""
    margin = relative(region.problem, robot.home[None])[0]
    if np.abs(margin).min(initial=1) > 1e-6:
        assert (region.home is None) == bool(violated(robot, robot.home))


def sure_masks(problem: Problem, n: int = GRID):
    """Cells of a grid that are feasible for sure, cells that may be, and the cells' sides.

    A form moves from the middle of a cell by its gradient and a bound on its second derivatives.
    """
    ends = [side or (-pi, pi) for side in problem.ranges]
    h = np.array([(high - low) / n for low, high in ends])
    q = [low + (np.arange(n) + 0.5) * step for (low, _), step in zip(ends, h, strict=True)]
    table, kinds = problem.forms.coefficients, problem.forms.kinds
    value = [basis(kind, x) for kind, x in zip(kinds, q, strict=True)]
    slope = [basis_slope(kind, x) for kind, x in zip(kinds, q, strict=True)]
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


def check_polygons(region: Region) -> None:
    """Area and centroid of the polygons through the arcs' points, where nothing goes round."""
    for component in region.components:
        if any(component.wraps):
            assert component.centroid is None
            continue
        sums = sum((shoelace(loop) for loop in component.loops), np.zeros(3))
        length = sum(
            np.hypot(*np.diff(a.points, axis=0).T).sum() for p in component.loops for a in p
        )
        assert abs(sums[0] - component.area) < 5e-3 * (length**2 + 1e-6) / 4
        if component.area > 0.05:
            assert_allclose(sums[1:] / sums[0], component.centroid, atol=0.1)


def shoelace(loop) -> np.ndarray:
    """Area and first moments of one closed walk, by Green."""
    x, y = np.concatenate([arc.points for arc in loop]).T
    x2, y2 = np.roll(x, -1), np.roll(y, -1)
    cross = x * y2 - x2 * y
    return np.array([cross.sum() / 2, ((x + x2) * cross).sum() / 6, ((y + y2) * cross).sum() / 6])


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
        found = pieces(problem.forms, problem.ranges, base)
        same_pieces([row for row in found if row[0] > SMALL], summary(region))


def check_symmetries(robot: Robot, region: Region) -> None:
    turn = 0.7
    swapped = swap_joints(region.problem)
    same_pieces(summary(solve(swapped, robot.home[::-1]), swap=True), summary(region))
    sign = np.array([-1.0 if kind == "revolute" else 1.0 for kind in robot.kinds])
    compare(region, find_region(mirror(robot)), robot, sign, np.zeros(2))
    length = np.array([1.0 if kind == "revolute" else 100.0 for kind in robot.kinds])
    compare(region, find_region(in_centimetres(robot)), robot, length, np.zeros(2))
    for j in (j for j, kind in enumerate(robot.kinds) if kind == "revolute"):
        compare(
            region, find_region(turned(robot, j, turn)), robot, np.ones(2), -turn * np.eye(2)[j]
        )


def compare(region: Region, other: Region, robot: Robot, factor, shift) -> None:
    """The other region is this one with every q replaced by factor q + shift."""
    scale = abs(factor.prod())
    ours = [c for c in region.components if c.area > SMALL]
    theirs = [c for c in other.components if c.area > SMALL * scale]
    rows = [[(c.area, c.wraps, len(c.loops)) for c in found] for found in (theirs, ours)]
    same_pieces(*(sorted(r, reverse=True) for r in rows), scale)
    round_joints = np.array([joint.limits is None for joint in robot.joints])
    for one in ours:
        (*rest,) = (c for c in theirs if abs(c.area - one.area * scale) < 1e-6 * scale)
        if len(rest) == 1 and one.centroid is not None:
            gap = rest[0].centroid - (one.centroid * factor + shift)
            gap = np.where(round_joints, (gap + pi) % TURN - pi, gap)
            assert_allclose(gap / np.abs(factor), 0, atol=1e-6)


def swap_joints(problem: Problem) -> Problem:
    table = np.swapaxes(problem.forms.coefficients, 1, 2)
    turned_round = HarmonicForm(table, problem.forms.kinds[::-1])
    return Problem(turned_round, problem.names, problem.ranges[::-1], problem.limits[::-1])


FLIP = np.array([-1.0, 1, 1])


def mirror(robot: Robot) -> Robot:
    """Send x to -x: turns change their sense, slides their axis."""
    points = tuple(replace(p, at=p.at * FLIP) for p in robot.points)
    walls = tuple(
        replace(b, normal=b.normal * FLIP) if isinstance(b, HalfSpace) else b
        for b in robot.boundaries
    )
    joints = tuple(mirrored(joint) for joint in robot.joints)
    return replace(robot, joints=joints, points=points, boundaries=walls)


def mirrored(joint: Joint) -> Joint:
    moved = replace(joint, origin=joint.origin * FLIP)
    if joint.kind == "prismatic":
        return replace(moved, axis=joint.axis * FLIP)
    limits = joint.limits and (-joint.limits[1], -joint.limits[0])
    return replace(moved, limits=limits)


def in_centimetres(robot: Robot) -> Robot:
    points = tuple(replace(p, at=100 * p.at) for p in robot.points)
    boundaries = tuple(
        replace(b, offset=100 * b.offset)
        if isinstance(b, HalfSpace)
        else replace(b, clearance=100 * b.clearance)
        for b in robot.boundaries
    )
    joints = tuple(longer(joint) for joint in robot.joints)
    return replace(robot, joints=joints, points=points, boundaries=boundaries)


def longer(joint: Joint) -> Joint:
    moved = replace(joint, origin=100 * joint.origin)
    if joint.kind == "revolute" or joint.limits is None:
        return moved
    return replace(moved, limits=(100 * joint.limits[0], 100 * joint.limits[1]))


def turned(robot: Robot, j: int, angle: float) -> Robot:
    """Mount joint j turned by an angle about its own axis: what was q is now q - angle."""
    c, s = np.cos(angle), np.sin(angle)
    joint = replace(robot.joints[j], mount=np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]]))
    if joint.limits:
        joint = replace(joint, limits=(joint.limits[0] - angle, joint.limits[1] - angle))
    return replace(robot, joints=(*robot.joints[:j], joint, *robot.joints[j + 1 :]))


@pytest.mark.parametrize("seed", range(60))
def test_random_robots(seed):
    check(random_robot(seed))


@pytest.mark.parametrize("seed", range(60))
def test_robots_drawn_in_whole_numbers(seed):
    check(drawn_robot(seed))


# --- the paper's robot ---------------------------------------------------------------------------


def windows_by_hand() -> list[list[tuple[float, float]]]:
    """For each joint the two windows between the pairs' forbidden arcs, the one with home first."""
    limits = []
    for names, joint in ((("1", "2"), 0), (("3", "4"), 1)):
        ends = []
        for name in names:
            d_min = MINERVA.boundary(f"B{name}").clearance
            ends += circle_zeros(
                lambda q, i=name, d=d_min, j=joint: pair_by_hand(i, q, j, d), 200000
            )
        ends = sorted(ends)
        gaps = [(a, b) for a, b in zip(ends, [*ends[1:], ends[0] + TURN], strict=True)]
        free = [g for g in gaps if all(pair_by_hand(n, sum(g) / 2, joint, 0.1) > 0 for n in names)]
        limits.append(
            sorted((g for g in free if g[1] - g[0] > 0.1), key=lambda g: not g[0] < 0 < g[1])
        )
    return limits


def pair_by_hand(name: str, q, joint: int, d_min: float):
    beta = equation_29(q if joint == 0 else 0.0, q if joint == 1 else 0.0)
    return beta[f"beta_{{{name},1}}"] ** 2 + beta[f"beta_{{{name},3}}"] ** 2 - d_min**2


def above_floor(first: tuple[float, float], second: tuple[float, float], n: int = 400001):
    """Height along q2 of {sin(q1 + q2) <= m(q1)} within the second window, over the first."""
    q1 = np.linspace(*first, n)
    q1 = (q1[1:] + q1[:-1]) / 2
    at = equation_29(q1, -q1)["beta_{7,3}"]  # the last link lies flat: no x23 in it
    bend = np.arcsin(np.clip(at / 25.0, -1, 1))
    height = np.zeros(n - 1)
    for k in range(-3, 4):
        low = np.maximum(q1 + second[0], pi - bend + TURN * k)
        high = np.minimum(q1 + second[1], TURN + bend + TURN * k)
        height += np.maximum(high - low, 0)
    return q1, height, (first[1] - first[0]) / (n - 1)


def areas_by_hand() -> list[float]:
    """The home component first: one a pair of windows, two where the floor cuts a strip in two."""
    (near_1, far_1), (near_2, far_2) = windows_by_hand()
    areas = []
    for first, second in ((near_1, near_2), (near_1, far_2), (far_1, far_2), (far_1, near_2)):
        _, height, step = above_floor(first, second)
        labels, count = label(height > 0)
        areas += [height[labels == k + 1].sum() * step for k in range(count)]
    return areas


def test_the_papers_robot_has_five_components_with_these_areas():
    region = find_region(MINERVA)
    found = [c.area for c in region.components]
    # Midpoint rule over 400,000 strips; the square root at a fold costs about 1e-8.
    assert_allclose(found, sorted(areas_by_hand(), reverse=True), atol=1e-6)
    assert [c.wraps for c in region.components] == [(False, False)] * 5


def test_the_papers_areas_lie_between_sure_and_possible_cells():
    region = find_region(MINERVA)
    sure, possible, h, _ = sure_masks(region.problem, 1000)
    assert sure.sum() * h.prod() <= region.area <= possible.sum() * h.prod()
    assert possible.sum() - sure.sum() < 0.03 * possible.sum()  # so fine that it says something


def test_the_papers_home_component_has_six_named_vertices():
    home = find_region(MINERVA).home
    assert home is not None
    meeting = [{*vertex.boundaries} for vertex in home.vertices]
    assert len(meeting) == 6
    around = [{"B2", "B7"}, {"B7", "B4"}, {"B4", "B1"}, {"B1", "B7"}, {"B7", "B3"}, {"B3", "B2"}]
    start = meeting.index(around[0])
    assert meeting[start:] + meeting[:start] == around
    for vertex in home.vertices:
        for name in vertex.boundaries:
            assert abs(clearance(MINERVA, MINERVA.boundary(name))(vertex.q)) < 1e-10


def test_only_the_first_component_holds_home():
    region = find_region(MINERVA)
    assert [c.contains_home for c in region.components] == [True] + [False] * 4
    (loop,) = region.home.loops
    x, y = np.concatenate([arc.points for arc in loop]).T
    angles = np.unwrap(np.arctan2(y - MINERVA.home[1], x - MINERVA.home[0]))
    assert round((angles[-1] - angles[0]) / TURN) == 1  # unrolled around home, anticlockwise


def test_the_papers_rule_comes_out_of_the_same_engine():
    box = paper_rule.box(MINERVA)
    used = [b for b in MINERVA.boundaries if isinstance(b, HalfSpace) and b.used]
    stack = HarmonicForm(
        np.stack([clearance(MINERVA, b).coefficients for b in used]), MINERVA.kinds
    )
    names = tuple(
        (low.label, high.label)
        for low, high in zip(box.lower_bounds, box.upper_bounds, strict=True)
    )
    ranges = tuple(zip(box.lower.tolist(), box.upper.tolist(), strict=True))
    region = solve(Problem(stack, tuple(b.name for b in used), ranges, names), MINERVA.home)
    found = sorted((v.q for v in region.home.vertices), key=lambda q: atan2(q[1] + 1, q[0] + 0.5))
    printed = sorted(
        (v.q for v in paper_rule.vertices(MINERVA)), key=lambda q: atan2(q[1] + 1, q[0] + 0.5)
    )
    assert len(found) == 6
    assert_allclose(found, printed, atol=1e-12, rtol=0)


# --- home at the edges ---------------------------------------------------------------------------


def problem_of(kinds, ranges, *terms) -> Problem:
    stack = forms(kinds, *terms)
    return Problem(stack, tuple(f"f{m}" for m in range(len(terms))), ranges, LIMITS)


DIAMOND = problem_of(RR, (None, None), {"10": 1, "01": 1})


def test_home_outside_belongs_to_no_component():
    region = solve(DIAMOND, (pi, pi))
    assert region.home is None
    assert len(region.components) == 1


def test_home_at_a_touching_point_belongs_to_no_component():
    saddle = problem_of(PP, ((-1.0, 1.0), (-1.0, 1.0)), {"20": 1, "02": -1})
    region = solve(saddle, (0, 0))
    assert region.home is None
    assert len(region.components) == 2


@pytest.mark.parametrize("home", [(0.0, 0.0), (0.0, 1.0), (1.0, 0.0)])
def test_home_on_a_critical_line_is_found(home):
    # The diamond's fibres open, close and are widest at these places.
    assert solve(DIAMOND, home).home is not None


@pytest.mark.parametrize("turns", [(1, 0), (0, -1), (2, 3)])
def test_home_some_turns_away_shifts_the_component(turns):
    disc = problem_of(RR, (None, None), {"00": -1.5, "10": 1, "01": 1})
    here, there = solve(disc, (0, 0)).home, solve(disc, TURN * np.array(turns)).home
    assert_allclose(there.centroid - here.centroid, TURN * np.array(turns), atol=1e-12)


def test_home_beyond_a_limit_is_outside_though_a_turn_away_is_inside():
    region = solve(problem_of(RR, ((-1.0, 1.0), (-1.0, 1.0))), (TURN, 0))
    assert region.home is None


def test_every_component_of_an_empty_region_is_none():
    region = solve(problem_of(RR, (None, None), {"00": -1}), (0, 0))
    assert region.components == ()
    assert region.area == 0


@pytest.mark.parametrize("angles", [(0.0, 0.0), (0.7, 0.0), (0.7, -1.1)])
def test_a_touching_point_is_no_hole(angles):
    """2 - cos(q1 - a) - cos(q2 - b) vanishes at one point of the torus, which bounds nothing."""
    a, b = angles
    one = {"00": 2, "01": -np.cos(b), "02": -np.sin(b), "10": -np.cos(a), "20": -np.sin(a)}
    (component,) = solve(problem_of(RR, (None, None), one), (2.0, 2.0)).components
    assert component.loops == ()
    assert component.wraps == (True, True)
    assert_allclose(component.area, TURN**2, rtol=1e-12)


@pytest.mark.parametrize("radius", [1e-4, 1e-5])
def test_a_small_hole_is_one(radius):
    one = {"00": 2 - radius**2 / 2, "01": -1, "10": -1}
    (component,) = solve(problem_of(RR, (None, None), one), (2.0, 2.0)).components
    (loop,) = component.loops
    assert_allclose(np.ptp([x for arc in loop for x in arc.points], axis=0), 2 * radius, rtol=1e-3)


def test_a_hole_is_a_clockwise_loop():
    region = solve(problem_of(PP, ((-1.0, 1.0),) * 2, {"00": -0.25, "20": 1, "02": 1}), (1, 1))
    (component,) = region.components
    signs = sorted(shoelace(loop)[0] for loop in component.loops)
    assert signs[0] < 0 < signs[1]


def main(kind: str, count: int) -> None:
    """Check that many robots of one kind, random or drawn; say the seeds and what failed."""
    make, failed = {"random": random_robot, "drawn": drawn_robot}[kind], []
    for seed in range(count):
        try:
            check(make(seed))
        except Exception as error:
            failed.append(seed)
            sys.stdout.write(f"{seed}: {type(error).__name__} {str(error).strip()[:300]}\n")
    sys.stdout.write(f"{kind}, seeds 0 to {count - 1}: {len(failed)} of {count} wrong {failed}\n")


if __name__ == "__main__":
    warnings.simplefilter("error", RuntimeWarning)
    main(sys.argv[1], int(sys.argv[2]))
