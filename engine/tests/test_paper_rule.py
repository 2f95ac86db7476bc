"""The paper's rule: the 22 bounds, the box, the six vertices, and what other readings give."""

import re
from dataclasses import replace
from math import degrees, pi

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from cspace import clearance, load_robot
from cspace.model.robot import Boundary, Robot
from cspace.model.robotfile import parse_robot
from cspace.region.paper_rule import (
    LOWER,
    UPPER,
    Bound,
    box,
    feasible,
    problem,
    windows,
)
from engine_support.oracles import (
    Table,
    angle_gap,
    arctan_of_quotient,
    circle_zeros,
    equation_29,
    feasible_by_paper,
    in_unit,
    packaged_table,
    point_seen_from,
    row_of,
    table_6,
)
from lizarraga2025 import printed as paper
from lizarraga2025.closed_form import bound_curves, geometric_bounds, refined, vertices
from qbound.boundary import closest_approach

MINERVA = load_robot("minervabot-v2")
BOUNDS = table_6(np.arctan2)
POINT_BOUNDS = [label for label in BOUNDS if label[6] in "1234"]

# The six vertices in degrees, anticlockwise, and the curves that meet there.
VERTICES = [
    (-94.0734, -162.3032, {"beta_{4,1,2}", "beta_{7,3,2}"}),
    (76.2241, -162.3032, {"beta_{4,1,2}", "beta_{1,3,1}"}),
    (76.2241, -69.7981, {"beta_{1,3,1}", "beta_{7,3,1}"}),
    (33.7187, 44.3813, {"beta_{3,3,1}", "beta_{7,3,1}"}),
    (-136.2393, 44.3813, {"beta_{3,3,1}", "beta_{2,1,2}"}),
    (-136.2393, -50.1707, {"beta_{2,1,2}", "beta_{7,3,2}"}),
]
NAMED = {
    "beta_{1,3,1}",
    "beta_{2,1,2}",
    "beta_{3,3,1}",
    "beta_{4,1,2}",
    "beta_{7,3,1}",
    "beta_{7,3,2}",
}


def window_bounds(robot: Robot) -> dict[str, float]:
    """Every end of a window by the paper's label."""
    return {
        Bound(w.boundary, w.component, k).label: value
        for w in windows(robot)
        for k, value in ((UPPER, w.upper), (LOWER, w.lower))
    }


def polygon_of(robot: Robot) -> np.ndarray:
    return np.array([vertex.q for vertex in vertices(robot)])


# --- Table 6 -------------------------------------------------------------------------------------


def test_windows_are_the_sixteen_bounds_of_the_point_pairs() -> None:
    """Rows 1-4 of Table 6, both k, read with atan2: the same numbers, not only modulo a turn."""
    found = window_bounds(MINERVA)
    assert sorted(found) == sorted(POINT_BOUNDS)
    for label in POINT_BOUNDS:
        assert found[label] == pytest.approx(BOUNDS[label], abs=1e-13)


def test_windows_move_the_joint_between_their_points() -> None:
    assert {w.boundary: w.joint for w in windows(MINERVA)} == {"B1": 0, "B2": 0, "B3": 1, "B4": 1}


def test_every_window_is_one_turn_that_holds_home() -> None:
    for w in windows(MINERVA):
        assert w.upper - w.lower == pytest.approx(2 * pi)
        assert w.lower <= 0 <= w.upper


@pytest.mark.parametrize("label", POINT_BOUNDS)
def test_a_bound_is_a_root_of_its_component(label) -> None:
    """Found again by bisection of eq. (29)."""
    component = label[:9] + "}"
    roots = circle_zeros(lambda q: equation_29(q, q)[component])
    assert angle_gap(np.array(roots), window_bounds(MINERVA)[label]).min() < 1e-12


@pytest.mark.parametrize("boundary", ["B5", "B6", "B7"])
def test_geometric_bounds_are_both_roots_of_their_component(boundary) -> None:
    """Row by row of q1, against bisection; NaN exactly where there is no root."""
    component = {"B5": "beta_{5,1}", "B6": "beta_{6,1}", "B7": "beta_{7,3}"}[boundary]
    q1 = np.linspace(-3, 3, 31)
    found = geometric_bounds(MINERVA, boundary, np.stack([q1, q1], axis=-1))
    for x, ends in zip(q1, found.T, strict=True):
        roots = circle_zeros(lambda q2, x=x: equation_29(x, q2)[component])
        if not roots:
            assert np.isnan(ends).all()
            continue
        assert_allclose([angle_gap(np.array(roots), end).min() for end in ends], 0, atol=1e-10)
        assert angle_gap(*ends) > 1e-6


@pytest.mark.parametrize("label", [label for label in BOUNDS if label[6] in "567"])
def test_printed_rows_5_to_7_are_among_the_derived_roots(label) -> None:
    """Table 6 with k: 1 is theta + arccos; in rows 5 and 6 k = 2 is the same root a turn before."""
    q1 = np.linspace(-pi, pi, 201)
    printed = table_6(np.arctan2, q1)[label]
    lower, upper = geometric_bounds(MINERVA, f"B{label[6]}", np.stack([q1, q1], axis=-1))
    assert_array_equal(np.isnan(printed), np.isnan(lower))
    kept = lower if label == "beta_{7,3,2}" else upper
    real = ~np.isnan(printed)
    assert real.any()
    assert_allclose(angle_gap(printed[real], kept[real]), 0, atol=1e-7)  # 1e-8 near a fold


def test_rows_5_and_6_of_table_6_lack_a_root() -> None:
    """Departure from the print: k = 1 and k = 2 are one root, and theta - arccos is not there."""
    for row in ("5", "6"):
        bounds = table_6(np.arctan2, 0.5 if row == "5" else -0.5)
        one, two = bounds[f"beta_{{{row},1,1}}"], bounds[f"beta_{{{row},1,2}}"]
        assert one - two == pytest.approx(2 * pi)


def test_ten_rows_of_table_6_are_one_root_a_turn_apart_and_one_row_has_both_roots() -> None:
    q1 = np.linspace(-pi, pi, 721)
    bounds = table_6(np.arctan2, q1)
    apart = {}
    for label in list(bounds)[::2]:
        upper, lower = (bounds[label[:-2] + f"{k}}}"] for k in (1, 2))
        length = np.atleast_1d(upper - lower)
        apart[label[6:9]] = length[np.isfinite(length)]
    assert len(apart) == 11
    assert all((length > 0).all() for length in apart.values()), "k = 1 is the upper bound"
    turns = [row for row, length in apart.items() if np.allclose(length, 2 * pi)]
    assert set(apart) - set(turns) == {"7,3"}
    assert apart["7,3"].max() < 2 * pi


def test_all_22_bounds_are_computed() -> None:
    assert len(BOUNDS) == 22 == len(paper.TABLE_6)
    named = {bound.label for bound, _ in bound_curves(MINERVA, [[-2 * pi, 2 * pi]] * 2)}
    assert named == set(BOUNDS)


# --- the region ----------------------------------------------------------------------------------


def test_box_is_bound_by_the_named_bounds() -> None:
    region = box(MINERVA)
    assert [b.label for b in region.lower_bounds] == ["beta_{2,1,2}", "beta_{4,1,2}"]
    assert [b.label for b in region.upper_bounds] == ["beta_{1,3,1}", "beta_{3,3,1}"]
    assert_allclose(np.degrees(region.lower), [-136.2393, -162.3032], atol=1e-4)
    assert_allclose(np.degrees(region.upper), [76.2241, 44.3813], atol=1e-4)
    assert_allclose(region.lower, [BOUNDS["beta_{2,1,2}"], BOUNDS["beta_{4,1,2}"]], atol=1e-13)
    assert_allclose(region.upper, [BOUNDS["beta_{1,3,1}"], BOUNDS["beta_{3,3,1}"]], atol=1e-13)


@pytest.mark.parametrize("i", range(6))
def test_vertex_lies_on_both_named_curves_and_in_every_window(i) -> None:
    q1, q2, names = VERTICES[i]
    vertex = vertices(MINERVA)[i]
    assert_allclose(np.degrees(vertex.q), [q1, q2], atol=1e-4)
    assert {bound.label for bound in vertex.bounds} == names
    on = table_6(np.arctan2, vertex.q[0])
    for bound in vertex.bounds:
        joint = 0 if bound.boundary in ("B1", "B2") else 1
        assert on[bound.label] == pytest.approx(vertex.q[joint], abs=1e-12)
    assert equation_29(*vertex.q)["beta_{7,3}"] >= -1e-12
    for w in windows(MINERVA):
        assert w.lower - 1e-12 <= vertex.q[w.joint] <= w.upper + 1e-12


def test_six_vertices_use_six_curves_each_twice() -> None:
    labels = [bound.label for vertex in vertices(MINERVA) for bound in vertex.bounds]
    assert len(labels) == 12
    assert {label: labels.count(label) for label in labels} == dict.fromkeys(NAMED, 2)


def test_caption_of_figure_4_names_one_bound_a_turn_away() -> None:
    """Departure from the print: beta_{3,3,2} is printed, beta_{3,3,1} bounds the region."""
    assert set(paper.FIGURE_4_BOUNDS) ^ NAMED == {"beta_{3,3,2}", "beta_{3,3,1}"}
    top = max(vertex.q[1] for vertex in vertices(MINERVA))
    assert top == pytest.approx(BOUNDS["beta_{3,3,1}"], abs=1e-12)
    assert degrees(BOUNDS["beta_{3,3,2}"]) < -300  # a turn below: outside every other window


def test_region_holds_home_and_is_the_one_computed_by_hand() -> None:
    q = np.random.default_rng(4).uniform(-pi, pi, (200_000, 2))
    assert feasible(MINERVA, MINERVA.home)
    assert_array_equal(feasible(MINERVA, q), feasible_by_paper(*q.T))
    assert feasible(MINERVA, q[:6].reshape(3, 2, 2)).shape == (3, 2)


@pytest.mark.parametrize("q", [[np.nan, 0.0], [0.0, np.nan], [np.inf, 0.0]])
def test_what_is_no_number_is_refused(q) -> None:
    with pytest.raises(ValueError, match="not a finite number"):
        feasible(MINERVA, [q, [0.0, 0.0]])


def test_vertices_go_round_the_region() -> None:
    """Anticlockwise; a step inwards from each is feasible, a step outwards is not."""
    p = polygon_of(MINERVA)
    x, y = p.T
    assert (x * np.roll(y, -1) - y * np.roll(x, -1)).sum() > 0
    inwards = np.roll(p, 1, axis=0) + np.roll(p, -1, axis=0) - 2 * p
    assert feasible(MINERVA, p + 1e-6 * inwards).all()
    assert not feasible(MINERVA, p - 1e-6 * inwards).any()


# --- what is drawn -------------------------------------------------------------------------------


def test_bound_curves_lie_on_their_components_and_in_the_range() -> None:
    """Every point of every curve of Figure 4 solves its component of eq. (29)."""
    ranges = np.array([[-2 * pi, pi], [-pi, 1.5 * pi]])
    for bound, curve in bound_curves(MINERVA, ranges):
        q1, q2 = curve[~np.isnan(curve).any(axis=1)].T
        assert len(q1) > 0
        component = f"beta_{{{bound.boundary[1]},{bound.component}}}"
        assert_allclose(equation_29(q1, q2)[component], 0, atol=1e-6)
        if bound.boundary > "B4":
            assert ((q2 >= ranges[1, 0]) & (q2 <= ranges[1, 1])).all()


@pytest.mark.parametrize("ranges", [[[-pi, pi], [-pi, pi]], [[-1, 2], [2, 9]]])
def test_no_root_of_a_half_space_in_range_is_left_out(ranges) -> None:
    """At each of 13 values of q1 the curves of B7 meet it as often as bisection does."""
    curves = [c for b, c in bound_curves(MINERVA, ranges, n=121) if b.boundary == "B7"]
    low, high = ranges[1]
    for q1 in np.linspace(*ranges[0], 13):
        rows = [c[np.abs(c[:, 0] - q1).argmin()] for c in curves]
        assert_allclose([row[0] for row in rows], q1, atol=1e-12)
        drawn = sorted(q2 for _, q2 in rows if not np.isnan(q2))
        roots = circle_zeros(lambda q2, q1=q1: equation_29(q1, q2)["beta_{7,3}"])
        turned = [r + 2 * pi * k for r in roots for k in range(-3, 4)]
        assert_allclose(drawn, sorted(r for r in turned if low <= r <= high), atol=1e-9)


def test_a_bound_has_the_papers_label() -> None:
    assert Bound("B1", 3, UPPER).label == "beta_{1,3,1}"
    assert Bound("B7", 3, LOWER).label == "beta_{7,3,2}"
    assert Bound("elbow", 1, UPPER).label == "beta_{elbow,1,1}"


# --- other readings of the print -----------------------------------------------------------------


def test_arctan_gives_another_box() -> None:
    """E-34: with arctan for tan^-1(b/a), two rows of Table 6 are no roots: another box."""
    read = table_6(arctan_of_quotient)
    wrong = [b for b in POINT_BOUNDS if angle_gap(read[b], BOUNDS[b]) > 1e-9]
    assert wrong == ["beta_{2,1,1}", "beta_{2,1,2}", "beta_{3,3,1}", "beta_{3,3,2}"]
    for label in wrong:
        assert abs(equation_29(read[label], read[label])[label[:9] + "}"]) > 10  # cm, not 0
    lower = [
        max(read[b] for b in POINT_BOUNDS if b[6] in row and b[10] == "2") for row in ("12", "34")
    ]
    upper = [
        min(read[b] for b in POINT_BOUNDS if b[6] in row and b[10] == "1") for row in ("12", "34")
    ]
    assert_allclose(np.degrees(lower), [-209.98, -135.62], atol=0.01)
    assert_allclose(np.degrees(upper), [43.76, 44.41], atol=0.01)
    assert np.abs(np.degrees(lower - box(MINERVA).lower)).min() > 26


def test_floor_read_in_millimetres_leaves_no_six_vertices() -> None:
    """11.32 mm = 1.132 cm: B7 no longer cuts the box where the caption's curves meet."""
    table = packaged_table()
    row_of(table, "boundary", "B7")["offset"] = 1.132
    with pytest.raises(ValueError, match="neighbouring vertices share no bound: beta_"):
        vertices(parse_robot(table))


def test_floor_read_in_millimetres_leaves_six_corners_of_its_component() -> None:
    """Going round the box, the sign changes four times and two corners keep the limit."""
    of = box(MINERVA)
    (a, b), (c, d) = of.lower, of.upper
    for height in (11.32, 1.132):
        table = packaged_table()
        row_of(table, "boundary", "B7")["offset"] = height
        robot = parse_robot(table)
        corners = np.array([[a, b], [c, b], [c, d], [a, d]])
        sides = np.linspace(corners, np.roll(corners, -1, axis=0), 5001, axis=1).reshape(-1, 2)
        keeps = clearance(robot, robot.boundary("B7"))(sides) > 0
        crossings = int((np.diff(keeps.astype(int)) != 0).sum())
        assert crossings + int(keeps[::5001].sum()) == 6


def test_table_4_read_in_millimetres_leaves_beta_4_without_a_root() -> None:
    """Points 12 and 13 a tenth as far out: neither component of B_4 reaches zero."""
    table = packaged_table()
    for name in ("12", "13"):
        row = row_of(table, "point", name)
        row["at"] = [x / 10 for x in row["at"]]
    robot = parse_robot(table)
    assert {w.boundary for w in windows(robot)} == {"B1", "B2", "B3"}
    assert closest_approach(robot, robot.boundary("B4")).gap > 20
    assert degrees(box(robot).lower[1]) < -300  # only B3 is left to bound q2 from below


# --- any robot -----------------------------------------------------------------------------------


def with_contacts(table: Table) -> Table:
    """The nearer point of each pair put where the farther one comes closest: pairs that do meet."""
    for near, far, name in (
        ("6", "7", "B1"),
        ("8", "9", "B2"),
        ("10", "11", "B3"),
        ("12", "13", "B4"),
    ):
        q = closest_approach(MINERVA, MINERVA.boundary(name)).q
        row = row_of(table, "point", near)
        row["at"] = point_seen_from(table, far, row["frame"], [q, q]).tolist()
    return table


def mirrored(table: Table) -> Table:
    """Left and right exchanged: x -> -x of every offset."""
    for row in table["joint"]:
        row["origin"] = [-row["origin"][0], *row["origin"][1:]]
    for row in table["point"]:
        row["at"] = [-row["at"][0], *row["at"][1:]]
    return table


@pytest.mark.parametrize(("unit", "scale"), [("mm", 10.0), ("m", 0.01)])
def test_region_does_not_depend_on_the_unit(unit, scale) -> None:
    robot = parse_robot(in_unit(packaged_table(), unit, scale))
    assert_allclose(polygon_of(robot), polygon_of(MINERVA), atol=1e-11)
    q = np.random.default_rng(5).uniform(-pi, pi, (1000, 2))
    assert_array_equal(feasible(robot, q), feasible(MINERVA, q))


def test_angles_in_radians_give_the_same_region() -> None:
    table = packaged_table() | {"angle_unit": "rad"}
    assert_array_equal(polygon_of(parse_robot(table)), polygon_of(MINERVA))


def test_mirrored_robot_has_the_mirrored_region() -> None:
    """q -> -q, when the points do meet."""
    robot = parse_robot(with_contacts(packaged_table()))
    mirror = parse_robot(mirrored(with_contacts(packaged_table())))
    expected = sorted((-polygon_of(robot)).tolist())
    assert_allclose(sorted(polygon_of(mirror).tolist()), expected, atol=1e-8)


def test_symmetric_robot_has_a_symmetric_region() -> None:
    """q1 -> -60 - q1, q2 -> -120 - q2 degrees: the region that the printed offsets almost have."""
    p = np.degrees(polygon_of(load_robot("minervabot-v2-symmetric")))
    assert_allclose(sorted(([-60, -120] - p).tolist()), sorted(p.tolist()), atol=1e-9)
    assert_allclose(p, np.degrees(polygon_of(MINERVA)), atol=2.2)


def test_printed_offsets_have_no_mirror_image() -> None:
    """E-37: with one root kept, x windows mirror and z windows do not; 0.4 degrees at most here."""
    mirror = parse_robot(mirrored(packaged_table()))
    ends, image = ({(w.boundary, w.component): w for w in windows(r)} for r in (MINERVA, mirror))
    for key, w in ends.items():
        gap = angle_gap(image[key].upper, -w.upper)
        assert (gap < 1e-12) == (key[1] == 1)
    gaps = np.degrees(box(mirror).upper + box(MINERVA).lower)
    assert 0.001 < np.abs(gaps).max() < 0.4


def test_a_turned_mount_changes_no_region() -> None:
    """A full turn of the mount leaves rounding in the y components; rounding is no window."""
    table = packaged_table()
    table["joint"][0]["rpy"] = [360, 0, 0]
    robot = parse_robot(table)
    assert {w.component for w in windows(robot)} == {1, 3}
    assert_allclose(polygon_of(robot), polygon_of(MINERVA), atol=1e-12)


def test_home_elsewhere_chooses_the_turns_around_it() -> None:
    """One turn further on, everything is one turn further on."""
    table = packaged_table()
    table["home"] = {"q1": 360.0, "q2": -720.0}
    shifted = polygon_of(parse_robot(table)) - [2 * pi, -4 * pi]
    assert_allclose(shifted, polygon_of(MINERVA), atol=1e-12)


def test_unused_boundaries_do_not_bound() -> None:
    table = packaged_table()
    row_of(table, "boundary", "B7")["used"] = False
    robot = parse_robot(table)
    region = box(MINERVA)
    corners = {
        (x, y)
        for x in (region.lower[0], region.upper[0])
        for y in (region.lower[1], region.upper[1])
    }
    assert {tuple(v.q) for v in vertices(robot)} == corners
    row_of(table, "boundary", "B1")["used"] = False
    assert "B1" not in {w.boundary for w in windows(parse_robot(table))}


def test_a_region_that_the_floor_takes_whole_has_no_vertices() -> None:
    table = packaged_table()
    row_of(table, "boundary", "B7")["offset"] = 1000.0
    robot = parse_robot(table)
    assert vertices(robot) == []
    assert not feasible(robot, [[0.0, 0.0], [1.0, 1.0]]).any()


def three_joints() -> Table:
    table = packaged_table()
    wrist = {"name": "q3", "type": "revolute", "parent": "2", "frame": "4", "origin": [25, 0, 0]}
    table["joint"].append(wrist | {"axis": [0, 1, 0]})
    table["point"].append({"name": "14", "frame": "2", "at": [20, 0, 3]})
    table["point"].append({"name": "15", "frame": "4", "at": [-4, 0, 4]})
    table["boundary"].append(
        {"name": "B8", "type": "pair", "points": ["14", "15"], "clearance": 0.1}
    )
    table["home"]["q3"] = 0.0
    return table


def test_three_joints_have_a_box_and_no_polygon() -> None:
    robot = parse_robot(three_joints())
    region = box(robot)
    assert_allclose(region.lower[:2], box(MINERVA).lower, atol=1e-13)
    assert region.lower.shape == (3,)
    assert feasible(robot, robot.home)
    with pytest.raises(ValueError, match="draws two joints; MinervaBotV2 has 3"):
        vertices(robot)


@pytest.mark.parametrize(
    ("change", "points", "says"),
    [
        (
            {"type": "prismatic", "limits": [0, 1]},
            ["6", "7"],
            "needs one joint between its points, and a revolute one",
        ),
        ({}, ["6", "13"], "needs one joint"),
        ({}, ["7", "9"], "needs one joint"),
    ],
    ids=["a slide", "two joints", "no joint"],
)
def test_pairs_that_the_rule_says_nothing_about_are_refused(change, points, says) -> None:
    table = packaged_table()
    table["joint"][0] |= change
    row_of(table, "boundary", "B1")["points"] = points
    with pytest.raises(ValueError, match=f"^B1: the paper's rule {says}"):
        windows(parse_robot(table))


# --- joint limits (eq. 10) ------------------------------------------------------------------------


def limited(low: float, high: float) -> Robot:
    """The paper's robot with limits of q2, degrees."""
    one, other = MINERVA.joints
    ends = np.radians([low, high]).tolist()
    return replace(MINERVA, joints=(one, replace(other, limits=(ends[0], ends[1]))))


def test_a_limit_that_binds_is_a_side_of_the_box_and_of_the_region() -> None:
    """Passing over it would call free what the joint cannot reach."""
    arm = limited(-100, 60)
    sides = box(arm)
    assert degrees(sides.lower[1]) == pytest.approx(-100)
    assert sides.upper[1] == box(MINERVA).upper[1]
    assert sides.lower_bounds[1].label == "q2.lower"
    assert feasible(arm, np.radians([[0, -99], [0, -101]])).tolist() == [True, False]
    names = {bound.label for vertex in vertices(arm) for bound in vertex.bounds}
    assert names == NAMED - {"beta_{4,1,2}"} | {"q2.lower"}
    assert polygon_of(arm)[:, 1].min() == sides.lower[1]


def test_a_limit_beyond_the_windows_changes_nothing() -> None:
    assert_array_equal(box(limited(-170, 60)).lower, box(MINERVA).lower)
    assert_array_equal(polygon_of(limited(-170, 60)), polygon_of(MINERVA))


def test_a_limit_needs_no_points_on_its_side() -> None:
    arm = limited(-100, 60)
    assert len(refined(arm, 2, tangents=False)) == len(vertices(arm))
    assert refined(arm, 3, tangents=True)[:, 1].min() == pytest.approx(box(arm).lower[1])


def test_limits_and_windows_without_a_common_value_are_refused() -> None:
    with pytest.raises(
        ValueError, match=r"^q2: no room between q2.lower at 50° and beta_{3,3,1} at "
    ):
        box(limited(50, 90))


def test_a_joint_without_a_window_is_refused() -> None:
    table = packaged_table()
    table["boundary"] = [row_of(table, "boundary", name) for name in ("B1", "B2", "B7")]
    with pytest.raises(ValueError, match=re.escape("no point pair bounds joint 'q2'")):
        box(parse_robot(table))


@pytest.mark.parametrize("ask", [windows, problem, lambda robot: feasible(robot, robot.home)])
def test_a_boundary_of_another_type_is_refused_where_it_is_in_use(ask) -> None:
    """Passing over it would call free what it forbids."""
    other = type("Ring", (Boundary,), dict.fromkeys(Boundary.__abstractmethods__))
    drawn, used = (replace(MINERVA, boundaries=(*MINERVA.boundaries, other("ring"))) for _ in "12")
    ask(drawn)  # which it is not asked of again: a robot knows what it uses
    other.used = True
    with pytest.raises(ValueError, match=r"^ring: the paper's rule has no bounds for a Ring$"):
        ask(used)
