"""What the ledger says of the paper's sentences, each checked in another way than it was computed.

Kinematics and components come from the formulas expanded by hand in `engine_support.oracles`,
regions from sampling, derivatives from differences.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
import shapely
from skimage.measure import marching_cubes

from cspace import clearance, find_region, load_robot
from cspace.geometry import polygon
from cspace.measures import bodies
from engine_support.oracles import OFFSETS, equation_29
from lizarraga2025 import printed as paper
from lizarraga2025.beyond.evidence import decomposed, enclosed
from lizarraga2025.beyond.slides import sliding
from lizarraga2025.evidence import effort, tool_paths
from qbound import window_region
from support.worlds import with_boundaries, with_joints

ROBOT = load_robot("minervabot-v2")
REGION = window_region(ROBOT)
CORNERS = REGION.polygon
STRETCHED = -np.arctan2(OFFSETS["z12"], OFFSETS["x12"])
DRAWN = np.random.default_rng(5).uniform(-np.pi, np.pi, (200_000, 2))


def tool(q):
    """Place of the tool in the plane, by the formulas of eq. (29)."""
    found = equation_29(q[..., 0], q[..., 1])
    x = found["beta_{5,1}"] + OFFSETS["xmin1"]
    return np.stack([x, found["beta_{7,3}"] + OFFSETS["zmin1"]], axis=-1)


def determinant(q, step=1e-6):
    """det J of the tool's place, by central differences."""
    columns = [(tool(q + step * e) - tool(q - step * e)) / (2 * step) for e in np.eye(2)]
    return columns[0][..., 0] * columns[1][..., 1] - columns[1][..., 0] * columns[0][..., 1]


def legs(order, scale):
    """Joint values along a walk through points of the polygon scaled about its centroid."""
    p = shapely.affinity.scale(
        shapely.Polygon(CORNERS), scale, scale, origin=shapely.Polygon(CORNERS).centroid
    )
    stops = np.array(p.exterior.coords)[list(order)]
    t = np.linspace(0, 1, 400)[:, None]
    return np.concatenate([a + t * (b - a) for a, b in pairwise(stops)])


# --- singular poses -------------------------------------------------------------------------------


def test_the_arm_is_singular_where_it_is_stretched() -> None:
    q1 = np.linspace(-3, 3, 50)
    assert np.abs(determinant(np.stack([q1, 0 * q1 + STRETCHED], -1))).max() < 1e-5
    assert np.abs(determinant(np.stack([q1, 0 * q1 + STRETCHED + 0.1], -1))).min() > 50


@pytest.mark.parametrize("scale", [1.0, 0.964, 0.95, 0.5, 0.1, 0.01])
def test_no_useful_scale_leaves_out_the_singular_poses(scale) -> None:
    det = determinant(legs(range(6), scale))
    assert det.min() < 0 < det.max()


def test_scaling_makes_the_pass_through_the_stretched_pose_safe() -> None:
    """The outline of the six points crosses the singular line below the floor, the scaled not."""
    lowest = {}
    for scale in (1.0, 0.95):
        q = legs((0, 1, 2, 3, 4, 5, 0), scale)
        sides = np.sign(determinant(q))
        at = np.flatnonzero(np.diff(sides))
        assert len(at) == 2
        lowest[scale] = equation_29(*q[at].T)["beta_{7,3}"]
    assert lowest[1.0].max() < 0
    assert lowest[0.95].min() > 4


def test_the_flipped_elbow_is_shut_at_points_1_and_4_alone() -> None:
    """From the other points the straight joint path to the second posture is feasible."""
    t = np.linspace(0, 1, 3001)[:, None]
    reached = []
    for point in range(6):
        q = legs((point, point), 0.95)[-1]
        (other,) = [p for p in postures(tool(q)) if np.abs(p - q).max() > 1e-6]
        if REGION.contains(q + t * (other - q)).all():
            reached.append(point + 1)
    assert reached == [2, 3, 5, 6]


# --- traversals -----------------------------------------------------------------------------------


def test_neighbour_sequences_become_feasible_by_scaling() -> None:
    """The floor decides, looked at in 400 poses a leg."""
    orders = [[(s + d * i) % 6 for i in range(5)] for s in range(6) for d in (1, -1)]
    free = {
        scale: sum(
            equation_29(*legs(order, scale).T)["beta_{7,3}"].min() > -1e-9 for order in orders
        )
        for scale in (1.0, 0.97, 0.964, 0.95)
    }
    assert free == {1.0: 0, 0.97: 0, 0.964: 12, 0.95: 12}


def test_a_straight_joint_path_bends_in_the_plane() -> None:
    places = tool(legs((0, 1), 0.95))
    chord = shapely.LineString(places[[0, -1]])
    assert max(chord.distance(shapely.Point(place)) for place in places) > 20


def test_right_and_left_reach_different_places() -> None:
    right, left = (tool(legs(order, 0.95)) for order in ((5, 0, 1, 2, 3), (2, 3, 4, 5, 0)))
    apart = np.linalg.norm(right[:, None] - left, axis=-1)
    assert max(apart.min(axis=0).max(), apart.min(axis=1).max()) == pytest.approx(15.1, abs=0.1)


def test_tangents_stay_inside_and_chords_do_not() -> None:
    t = np.linspace(0, 1, 500)
    for n in (2, 3, 5):
        for tangents in (True, False):
            edge = polygon.along_edges(REGION.with_points(n, tangents=tangents), t)
            height = equation_29(edge[..., 0], edge[..., 1])["beta_{7,3}"]
            assert (height.min() > -1e-9) == tangents


# --- the geometric workspace ----------------------------------------------------------------------


def postures(places):
    """Both configurations for each place, by the cosine rule; NaN out of reach."""
    l1, l2 = np.hypot(OFFSETS["x12"], OFFSETS["z12"]), OFFSETS["x23"]
    x, z = places[..., 0], places[..., 1] - OFFSETS["z01"]
    with np.errstate(invalid="ignore"):
        bend = np.arccos((x**2 + z**2 - l1**2 - l2**2) / (2 * l1 * l2))
    found = []
    for sign in (1, -1):
        q2 = STRETCHED + sign * bend  # angles from x towards -z, as the axis y turns them
        inner = np.arctan2(l2 * np.sin(sign * bend), l1 + l2 * np.cos(bend))
        q1 = np.arctan2(-z, x) - inner - STRETCHED
        found.append((np.stack([q1, q2], -1) + np.pi) % (2 * np.pi) - np.pi)
    return found


def test_the_overlap_is_where_one_posture_alone_is_safe() -> None:
    places = np.random.default_rng(6).uniform([-60, 0], [60, 80], (100_000, 2))
    both = postures(places)
    reachable = ~np.isnan(both[0][:, 0])
    assert tool(both[0][reachable]) == pytest.approx(places[reachable], abs=1e-9)
    safe = np.zeros(len(places))
    for q in both:
        safe[reachable] += REGION.contains(q[reachable])
    reached, cell = tool_paths.workspace(), 120 * 80 / len(places)
    assert cell * (safe > 0).sum() == pytest.approx(reached.area, rel=0.02)
    assert cell * (safe == 2).sum() == pytest.approx(reached.covered_twice, rel=0.02)
    assert cell * (safe == 1).sum() == pytest.approx(reached.area - reached.covered_twice, rel=0.04)


def test_the_image_of_the_boundary_encloses_a_part_of_the_workspace() -> None:
    """The tool at home is reached in the region and lies outside all that the path encloses."""
    steps = np.linspace(0, 1, 1501)[:-1]
    outline = np.concatenate([arc.at(steps) for arc in decomposed().loops[0]])
    faces = shapely.polygonize([shapely.node(shapely.LinearRing(tool(outline)))])
    inside = shapely.union_all(faces)
    stretched = tool(np.array([-0.5, STRETCHED]))
    assert not inside.contains(shapely.Point(stretched))
    assert not inside.contains(shapely.Point(tool(np.zeros(2))))
    assert REGION.contains(np.array([-0.5, STRETCHED]))
    assert inside.area == pytest.approx(enclosed().area, rel=1e-4)
    assert inside.area < 0.3 * tool_paths.workspace().area


# --- points, walls, bodies ------------------------------------------------------------------------


def test_clearances_allow_links_that_overlap() -> None:
    region = find_region(ROBOT)
    for component in region.components[1:]:
        q = component.centroid
        distances = [
            np.hypot(equation_29(*q)[f"beta_{{{i},1}}"], equation_29(*q)[f"beta_{{{i},3}}"])
            for i in (1, 2, 3, 4)
        ]
        assert min(distances) > 0.1
        assert equation_29(*q)["beta_{7,3}"] > 0
        a, b, c = (shapely.Polygon(bodies.outline(ROBOT, body, q)) for body in ROBOT.bodies)
        assert (a & b).area + (b & c).area + (a & c).area > 5


def test_pairs_depend_on_one_joint_and_the_walls_on_both() -> None:
    step = np.array([[0.0, 0.0], [0.4, 0.0], [0.0, 0.4]])
    values = equation_29(*(CORNERS[0] + step).T)
    for name, (at, first, second) in values.items():
        joints = {q for q, moved in (("q1", first), ("q2", second)) if abs(moved - at) > 1e-9}
        assert len(joints) == (2 if name[6] in "567" else 1), name


def test_with_a_distance_that_no_pair_comes_to_there_is_one_region() -> None:
    near = {name: {"clearance": 1e-4} for name in ("B1", "B2", "B3", "B4")}
    assert len(find_region(with_boundaries(ROBOT, **near)).components) == 1
    assert len(find_region(ROBOT).components) == 5


def test_walls_5_and_6_are_nested() -> None:
    found = equation_29(*DRAWN.T)
    signs = np.stack([found[f"beta_{{{name}}}"] >= 0 for name in ("5,1", "6,1", "7,3")], -1)
    assert not (signs[:, 0] & ~signs[:, 1]).any()
    assert len(np.unique(signs, axis=0)) == 6


def test_the_figure_meant_is_the_one_whose_caption_says_so() -> None:
    cited, words = paper.ON_NUMERICAL_METHODS
    assert cited == 10
    assert not any(word in paper.CAPTIONS_AS_PRINTED[10].lower() for word in words)
    assert all(word in paper.CAPTIONS_AS_PRINTED[11].lower() for word in words)


def test_limits_pairs_and_half_spaces_bound_one_region() -> None:
    limited = with_joints(ROBOT, q1={"limits": tuple(np.radians([-60, 60]))})
    names = {arc.boundary for loop in find_region(limited).home_component.loops for arc in loop}
    assert {"q1.lower", "q1.upper", "B7"} < names
    assert names & {"B3", "B4"}


def test_the_right_column_of_table_6_is_never_below_the_left() -> None:
    """Rows of one joint by a turn, the walls by the arccosine's range, all by hand."""
    first = [label for label in paper.TABLE_6 if label.endswith(",1}")]
    assert len(first) == 11
    rng = np.random.default_rng(3)
    for label in first:
        right, left = (
            paper.expression(paper.TABLE_6[label.replace(",1}", f",{k}}}")]) for k in (1, 2)
        )
        symbols = sorted(right.free_symbols, key=str)
        for _ in range(20):
            values = dict(zip(symbols, rng.uniform(0.5, 1.5, len(symbols)), strict=True))
            difference = complex((right - left).subs(values))
            if abs(difference.imag) < 1e-12:
                assert difference.real > -1e-12


def test_the_tool_stays_out_of_the_box_of_the_three_walls() -> None:
    q = DRAWN[REGION.contains(DRAWN)]
    found = equation_29(*q.T)
    between = (found["beta_{5,1}"] < 0) & (found["beta_{6,1}"] > 0)
    assert between.any()
    assert not (between & (found["beta_{7,3}"] < 0)).any()


def test_eq_31_leaves_no_angle_out_and_the_restated_interval_does() -> None:
    """Its length less a turn is twice the arccosine, which is never negative."""
    ends = [paper.expression(paper.THEOREM_2[f"31 {end}"]) for end in ("lower", "upper")]
    names = {str(symbol): symbol for end in ends for symbol in end.free_symbols}
    for c in np.linspace(-1, 1, 21):
        values = {names["a"]: 0.6, names["b"]: 0.8, names["c"]: c, names["k"]: 0}
        low, high = (float(end.subs(values)) for end in ends)
        assert high - low >= 2 * np.pi - 1e-9
    q = np.linspace(-np.pi, np.pi, 1001)
    assert (0.6 * np.cos(q) + 0.8 * np.sin(q) < 0.5).any()


def test_the_ends_of_eq_39_are_one_root_without_a_copy_between() -> None:
    ends = [paper.expression(paper.THEOREM_2[f"39 {end}"], arctan="atan2") for end in BOTH_ENDS]
    for a, b, c in ((3.0, 4.0, 2.0), (-3.0, 4.0, 2.0), (-3.0, -4.0, -4.5)):
        known = {"a": a, "b": b, "c": c, "d": 5.0, "k": 0.0}
        low, high = (float(end.subs({s: known[str(s)] for s in end.free_symbols})) for end in ends)
        q = np.linspace(low + 1e-6, high - 1e-6, 100_001)
        value = a * np.cos(q) + b * np.sin(q) - c
        assert value[0] < 0 < value[-1], "it falls through both ends, which are roots"
        assert (np.diff(np.sign(value)) != 0).sum() == 1, "and only the rising one lies between"


BOTH_ENDS = ("lower", "upper")


def test_open_paths_enclose_nothing_and_closed_ones_feasible_places() -> None:
    for order in ((5, 0, 1, 2, 3), (2, 3, 4, 5, 0)):
        assert shapely.LineString(tool(legs(order, 0.95))[::7]).is_simple
        ring = shapely.LinearRing(tool(legs((*order, order[0]), 0.95)))
        faces = shapely.union_all(shapely.polygonize([shapely.node(ring)]))
        assert faces.area > 1000
        low, high = np.reshape(faces.bounds, (2, 2))
        places = np.random.default_rng(9).uniform(low, high, (20_000, 2))
        places = places[shapely.contains_xy(faces, *places.T)]
        either = [REGION.contains(q) for q in postures(places)]
        assert np.any(either, axis=0).all()


# --- effort ---------------------------------------------------------------------------------------


def test_the_closed_form_needs_few_evaluations() -> None:
    """Its own area, by sampling: only three digits, but they share nothing."""
    part = REGION.contains(DRAWN).mean() * (2 * np.pi) ** 2
    assert REGION.area_by_nodes(8) == pytest.approx(part, rel=0.01)
    errors = [effort.closed_form_error(n) for n in (2, 4, 8, 16)]
    assert errors == sorted(errors, reverse=True)
    assert errors[-1] < 1e-8


def test_a_contour_on_a_grid_is_one_closed_curve_near_the_region() -> None:
    (ring,) = effort.contour_of_grid(200)
    assert np.allclose(ring[0], ring[-1])
    region = np.concatenate([arc.points for arc in decomposed().loops[0]])
    apart = shapely.Polygon(ring).symmetric_difference(shapely.Polygon(region)).area
    assert apart < 0.01 * shapely.Polygon(region).area
    with_margins = [effort.contour_error(n, margins=True) for n in (50, 100, 200, 400)]
    assert with_margins == sorted(with_margins, reverse=True)
    assert max(effort.contour_error(n) for n in (200, 400)) > 5 * with_margins[2]


# --- slides and surfaces --------------------------------------------------------------------------


def test_what_is_affine_in_a_slide_and_what_is_quadratic() -> None:
    """By differences along the slide, and across a turn and the slide."""
    robot = sliding()
    q = np.random.default_rng(7).uniform(-3, 3, (100, 3))
    step = np.array([0, 0, 0.5])
    for boundary in robot.boundaries:
        form = clearance(robot, boundary)
        second = (form(q + step) - 2 * form(q) + form(q - step)) / 0.25
        expected = 2.0 if boundary.name == "B8" else 0.0
        assert second == pytest.approx(np.full(len(q), expected), abs=1e-9)
    wall, turn = clearance(robot, robot.boundary("B7")), np.array([0.5, 0, 0])
    mixed = wall(q + turn + step) - wall(q + turn) - wall(q + step) + wall(q)
    assert np.abs(mixed).max() > 0.1


def test_marching_cubes_come_to_the_surface_as_the_square_of_the_step() -> None:
    form = clearance(sliding(), sliding().boundary("B7"))
    low, high = np.array([-1.5, -1.5, -10.0]), np.array([1.5, 1.5, 10.0])
    off = []
    for n in (16, 31, 61):
        axes = [np.linspace(a, b, n) for a, b in zip(low, high, strict=True)]
        grid = np.stack(np.meshgrid(*axes, indexing="ij"), -1)
        places = low + marching_cubes(form(grid), 0.0)[0] * (high - low) / (n - 1)
        off.append(np.abs(form(places)).max())
    assert all(3 < a / b < 5 for a, b in pairwise(off))
