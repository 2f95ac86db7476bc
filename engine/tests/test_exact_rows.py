# ruff: noqa: E501  (rows of robot files, one a line)
"""The forms of a problem in exact numbers, and how far those in floats are from them."""

import tomllib
from collections import Counter
from dataclasses import replace
from decimal import Decimal

import numpy as np
import pytest
from flint import arb, ctx, fmpq
from numpy.testing import assert_allclose

from cspace import load_robot, packaged_robots, region
from cspace.boundary.contacts import body_contacts
from cspace.design import varied
from cspace.model.exact import written_numbers
from cspace.model.robot import Capsule, Disc, HalfSpace, Polygon
from cspace.model.robotfile import parse_robot
from cspace.region import Problem, window_problem
from cspace.region.rows import BITS, ExactRows
from engine_support import body_scenes
from engine_support.arms import palletizer, three_joints
from engine_support.forms import LIMITS, RR
from engine_support.oracles import packaged_table, row_of
from qbound import load_robot as load_small
from qbound import pair_vector, window_region
from qbound.forms import HarmonicForm
from qbound.frames import roll_pitch_yaw

ENOUGH = 1152


def clearance_problem(robot, held=None):
    """The problem with the features of all pairs of parts, also of those that never meet."""
    problem = region.clearance_problem(robot, held)
    return replace(problem, contacts=body_contacts(robot, problem.held, problem.bodies))


def rows_of(robot, held=None):
    problem = clearance_problem(robot, held)
    return problem, ExactRows(problem)


def pairs(problem):
    """Each row of a problem: exact, float, and the stated errors of the float."""
    rows, contacts = ExactRows(problem), problem.contacts
    for k in range(len(problem.names)):
        yield rows.form(k), problem.forms.coefficients[k], problem.errors[k]
    for k in range(len(contacts.forms)):
        form, sides = rows.feature(k)
        yield form, contacts.forms[k], contacts.errors[k]
        yield from zip(sides, contacts.sides[k], contacts.side_errors[k], strict=True)
        missing = [not errors.any() for errors in contacts.side_errors[k]]
        one = np.tile(np.eye(1, 9, dtype=int).reshape(3, 3), (sum(missing), 1, 1))
        assert np.array_equal(contacts.sides[k, missing], one)
        assert (sides[missing] == one).all()


def scaled(exact, table):
    """An exact row times the positive number that makes it as large as that in floats."""
    exact = np.array([[float(x) for x in row] for row in exact])
    largest = np.unravel_index(np.abs(table).argmax(), (3, 3))
    if table[largest] == 0:
        return exact
    assert exact[largest] / table[largest] > 0
    return exact * (table[largest] / exact[largest])


def assert_close(problem):
    count = 0
    for exact, table, errors in pairs(problem):
        assert (np.abs(scaled(exact, table) - table) <= errors).all()
        count += 1
    assert count


def same(one, other):
    return one == other if isinstance(one, fmpq) else one.overlaps(other)


def is_zero(x):
    return x == 0 and (not isinstance(x, arb) or x.is_exact())


def assert_zeros_are_exact(problem):
    for exact, table, _ in pairs(problem):
        assert all(is_zero(x) for x in exact[table == 0])


# --- near to the floats -------------------------------------------------------------------------


@pytest.mark.parametrize("name", packaged_robots())
def test_packaged_robots(name):
    robot = load_robot(name)
    assert_close(clearance_problem(robot, {j: 0.3 - j for j in range(2, len(robot.joints))}))


def whole(seed):
    """An arm among obstacles in whole numbers, as its file has them."""
    return parse_robot(body_scenes.scene(seed))


@pytest.mark.parametrize("seed", [12, 14, 15, 16, 32, 35, 52, 53])
def test_scenes_in_whole_numbers_have_rational_rows_and_exact_zeros(seed):
    problem = clearance_problem(whole(seed))
    assert_close(problem)
    assert_zeros_are_exact(problem)
    if not any(isinstance(b, HalfSpace) for b in problem.bodies):
        sides = [side for k in range(len(problem.contacts.names)) for side in
                 ExactRows(problem).feature(k)[1]]  # fmt: skip
        assert all(isinstance(x, fmpq) for side in sides for x in side.flat)


@pytest.mark.parametrize("seed", range(4))
def test_scenes_at_random(seed):
    assert_close(clearance_problem(body_scenes.robot(body_scenes.scene(seed))))


@pytest.mark.parametrize("plane", body_scenes.PLANES)
@pytest.mark.parametrize("kinds", ["RR", "RP", "PR", "PP"])
def test_files_in_any_plane(plane, kinds):
    problem = clearance_problem(parse_robot(body_scenes.ordinary(3, kinds, plane)))
    assert_close(problem)
    assert_zeros_are_exact(problem)


def tilted(robot, turn):
    """The same arm with all that stands on the base turned by a matrix."""
    first = robot.joints[0]
    first = replace(first, origin=turn @ first.origin, mount=turn @ first.mount)
    walls = [replace(b, normal=turn @ b.normal) if isinstance(b, HalfSpace) else b
             for b in robot.boundaries]  # fmt: skip
    return replace(
        robot,
        joints=(first, *robot.joints[1:]),
        boundaries=tuple(walls),
        bodies=tuple(turned(b, turn) if b.frame == robot.base else b for b in robot.bodies),
        obstacles=tuple(turned(b, turn) for b in robot.obstacles),
    )


def turned(body, turn):
    shape, places = body.shape, body.shape.places @ turn.T
    if isinstance(shape, Polygon):
        return replace(body, shape=Polygon(places))
    if isinstance(shape, Capsule):
        return replace(body, shape=Capsule(*places, shape.radius))
    return replace(body, shape=Disc(places[0], shape.radius))


@pytest.mark.parametrize("seed", [32, 34, 35, 52])
@pytest.mark.parametrize("angles", [(0.3, -0.8, 2.0), (2.5, 0.1, -1.0)])
def test_a_tilted_plane_of_motion(seed, angles):
    robot = tilted(whole(seed), roll_pitch_yaw(*angles))
    assert np.abs(robot.plane.normal).max() < 0.999
    assert_close(clearance_problem(robot))


def test_short_edges_far_from_the_base():
    """Their directions are as uncertain as their corners' coordinates beside their length."""
    robot, turn = whole(15), roll_pitch_yaw(0.3, -0.8, 2.0)
    edges = Polygon(np.array([[300, 1, 0], [300.001, 1, 0], [300, 1.002, 0]]))
    small = replace(robot.obstacles[0], shape=edges)
    assert_close(clearance_problem(tilted(replace(robot, obstacles=(small,)), turn)))


def test_held_joints_of_each_kind():
    scene, slide = whole(35), whole(12).joints[1]
    for joint, value in ((scene.joints[1], 0.7), (slide, -1.3)):
        extra = replace(joint, name="extra", parent="L2", frame="L3")
        body = replace(scene.bodies[-1], name="further", frame="L3")
        robot = replace(
            scene,
            joints=(*scene.joints, extra),
            bodies=(*scene.bodies, body),
            home=np.zeros(3),
            clearance=0.25,
        )
        for held in ({2: value}, {1: value}, {0: value}):
            assert_close(clearance_problem(robot, held))


@pytest.mark.parametrize("held", [{0: 0.4}, {1: -0.7}, {2: 0.2}])
def test_held_joints_of_parallelograms_too(held):
    for robot in (three_joints(), palletizer()):
        assert_close(clearance_problem(robot, held))


# --- the decimals of the file -------------------------------------------------------------------


def arm(scale="1", angle="40"):
    """A planar arm of two turns beside an obstacle; all lengths times a power of ten."""

    def times(*lengths):
        return f"[{', '.join(str(Decimal(x) * Decimal(scale)) for x in lengths)}]"

    return f"""
schema = 1
name = "arm"
length_unit = "m"
angle_unit = "deg"
home = {{ q1 = 0, q2 = 0 }}
tool = "tip"
collisions = "all"
clearance = {times("0.001")[1:-1]}
allowed = [["2", "1"]]
joint = [
  {{ name = "q1", type = "revolute", parent = "0", frame = "1", origin = {times("0.1", "0", "0.2")}, axis = [0, 1, 0], limits = [-{angle}, 90] }},
  {{ name = "q2", type = "revolute", parent = "1", frame = "2", origin = {times("0.3", "0", "0")}, axis = [0, 1, 0] }},
]
point = [
  {{ name = "tip", frame = "2", at = {times("0.1", "0", "0")}, radius = {times("0.01")[1:-1]} }},
  {{ name = "post", frame = "0", at = {times("0.1", "0", "0.3")} }},
]
boundary = [
  {{ name = "gap", type = "pair", points = ["tip", "post"] }},
  {{ name = "floor", type = "half-space", point = "tip", normal = [0, 0.6, 0.8], offset = 0 }},
]
body = [
  {{ frame = "1", capsule = {{ from = {times("0", "0")}, to = {times("0.3", "0")}, radius = {times("0.02")[1:-1]} }} }},
  {{ frame = "2", polygon = [{times("0", "0")}, {times("0.1", "0")}, {times("0", "0.1")}] }},
]
obstacle = [
  {{ name = "post", polygon = [{times("0.7", "0.1")}, {times("0.8", "0.1")}, {times("0.7", "0.3")}] }},
]
"""


def test_decimals_of_the_file_are_rationals():
    problem, rows = rows_of(parse_robot(arm()))
    floor = rows.form(problem.names.index("floor"))
    # z = 0.2 - 0.3 sin q1 - 0.1 sin(q1 + q2), times 0.8, less the radius 0.01
    assert floor[0, 0] == fmpq(16, 100) - fmpq(1, 100)
    assert floor[2, 0] == fmpq(-24, 100)
    assert floor[1, 2] == floor[2, 1] == fmpq(-8, 100)
    gap = rows.form(problem.names.index("gap"))
    # 0.3^2 + 0.1^2 + 0.1^2 - 0.01^2, and 2 times 0.3 times 0.1 for the bend between the links
    assert gap[0, 0] == fmpq(9, 100) + fmpq(2, 100) - fmpq(1, 10000)
    assert gap[0, 1] == fmpq(6, 100)


def test_a_file_that_is_scaled_has_proportional_rows():
    (one, rows), (other, larger) = (rows_of(parse_robot(arm(scale))) for scale in ("1", "1000"))
    for k, distance in enumerate(one.distances):
        factor = 1000 if distance is None else 1000**2
        assert np.all(rows.form(k) * fmpq(factor) == larger.form(k))
    assert len(one.contacts.names) == len(other.contacts.names) > 0
    for k in range(len(one.contacts.names)):
        (form, sides), (large, more) = rows.feature(k), larger.feature(k)
        for row, far in ((form, large), *zip(sides, more, strict=True)):
            place = next(i for i in np.ndindex(3, 3) if row[i] != 0)
            with ctx.workprec(BITS):
                rest = far * row[place] - row * far[place]
                small = abs(far[place] * row[place]) * arb("1e-300")
            assert all(x == 0 if isinstance(x, fmpq) else abs(x) < small for x in rest.flat)


def test_a_tilted_plane_in_whole_numbers_has_the_rows_of_the_same_arm_upright():
    """The plane of x and (0, -0.8, 0.6), and that of x and z."""
    text = body_scenes.whole(5, "RR", "xz", 3, "deg")
    upright = parse_robot(text)
    table, c, s = body_scenes.read(text), Decimal("0.6"), Decimal("0.8")

    def moved(place):
        x, y, z = [place[0], 0, place[1]] if len(place) == 2 else place
        return [x, c * y - s * z, s * y + c * z]

    rows = [row for kind in table.values() if isinstance(kind, list) for row in kind]
    rows = [row for row in rows if isinstance(row, dict)]
    for row in [*rows, *(row[key] for row in rows for key in ("capsule", "disc") if key in row)]:
        for key in ("origin", "axis", "at", "from", "to", "normal"):
            if key in row:
                row[key] = moved(row[key])
        if "polygon" in row:
            row["polygon"] = [*map(moved, row["polygon"])]
    leaning = parse_robot(body_scenes.written(table))
    assert np.abs(leaning.plane.normal).max() == pytest.approx(0.8)
    one, other = clearance_problem(upright), clearance_problem(leaning)
    assert len(one.contacts.names) == len(other.contacts.names) > 0
    assert_close(other)
    assert_zeros_are_exact(other)
    assert rational_features(one) == rational_features(other)
    assert rational_features(one).total() > len(one.contacts.names) / 2


def rational_features(problem):
    """Form and side conditions of each feature in rationals, each to the largest coefficient 1."""
    rows, found = ExactRows(problem), Counter()
    for k in range(len(problem.contacts.names)):
        form, sides = rows.feature(k)
        tables = [form, *sides]
        if all(isinstance(x, fmpq) for table in tables for x in table.flat):
            unit = [table / (max(abs(x) for x in table.flat) or 1) for table in tables]
            found[tuple(sorted(str(table.tolist()) for table in unit))] += 1
    return found


def test_axes_that_are_written_with_another_length_leave_exact_zeros():
    """About (0, 1, 1): its unit vector is no rational, and no feature needs it to be."""
    text = arm().replace("axis = [0, 1, 0]", "axis = [0, 1, 1]").replace('collisions = "all"\n', "")
    text = text.replace('allowed = [["2", "1"]]\n', "").replace("clearance = 0.001\n", "")
    text = text[: text.index("]\nbody = [")]
    text += """
  { name = "apart", type = "bodies", bodies = ["link", "post"] },
]
body = [
  { name = "link", frame = "2", polygon = [[0, 0, 0], [0.3, 0, 0], [0.3, 0.1, -0.1], [0, 0.1, -0.1]] },
  { name = "post", frame = "0", polygon = [[0.7, 0.2, 0], [0.8, 0.2, 0], [0.8, 0, 0.2]] },
]
"""
    problem = clearance_problem(parse_robot(text))
    assert len(problem.contacts.names) == 4 * 3 + 3 * 4
    assert_close(problem)
    assert_zeros_are_exact(problem.without([0, 1]))


def test_degrees_are_rationals_times_pi_and_a_limit_that_was_replaced_is_its_double():
    robot = parse_robot(arm())
    first = replace(robot.joints[0], limits=(-0.5, robot.joints[0].limits[1]))
    rows = ExactRows(clearance_problem(replace(robot, joints=(first, robot.joints[1]))))
    low, high = rows.range(0)
    assert low == -fmpq(1, 2)
    with ctx.workprec(BITS):
        assert (high - arb.pi() / 2).contains(0)
    assert high.rel_accuracy_bits() > ENOUGH
    assert rows.range(1) is None


def test_numbers_that_were_replaced_are_their_doubles_and_the_others_are_the_files():
    robot = varied(parse_robot(arm()), {"joint.q2.origin.0": 0.35})
    problem, rows = rows_of(robot)
    floor = rows.form(problem.names.index("floor"))
    assert floor[2, 0] == -fmpq(*(0.35).as_integer_ratio()) * fmpq(8, 10)
    assert floor[1, 2] == fmpq(-8, 100)


def test_a_table_has_whole_quarter_turns():
    table = tomllib.loads(arm())
    table["joint"][0]["rpy"] = [0, 90, 0]
    mount = written_numbers(parse_robot(table)).joint(parse_robot(table).joints[0]).mount
    assert all(x in (-1, 0, 1) for x in mount.flat)


NO_DECIMALS = {
    "a table": lambda: parse_robot(tomllib.loads(arm())),
    "no file": lambda: replace(parse_robot(arm()), source=None),
    "a number beyond all doubles": lambda: parse_robot(arm().replace("0, 0.2]", "1e-999, 0.2]")),
}  # fmt: skip


@pytest.mark.parametrize("made", NO_DECIMALS.values(), ids=NO_DECIMALS)
def test_what_has_no_decimals_counts_as_its_doubles(made):
    problem, rows = rows_of(made())
    floor = rows.form(problem.names.index("floor"))
    assert floor[2, 0] == -fmpq(*(0.3).as_integer_ratio()) * fmpq(*(0.8).as_integer_ratio())


def test_balls_have_digits_enough():
    text = arm().replace("axis = [0, 1, 0], limits", "rpy = [0, 33, 0], axis = [0, 1, 0], limits")
    problem, rows = rows_of(parse_robot(text))
    found = [rows.form(k) for k in range(len(problem.names))]
    found += [rows.feature(k)[0] for k in range(len(problem.contacts.names))]
    bits = [
        x.rel_accuracy_bits() for row in found for x in row.flat if isinstance(x, arb) and x != 0
    ]
    assert len(bits) > 100
    assert min(bits) > ENOUGH


# --- other problems -----------------------------------------------------------------------------


def test_rows_stay_those_of_their_boundaries_when_others_are_left_out():
    problem, rows = rows_of(parse_robot(arm()))
    assert problem.names == ("gap", "floor")
    table = np.arange(9.0).reshape(3, 3) / 7
    fewer = problem.with_form("own", table).without([0])
    own = ExactRows(fewer)
    assert np.all(own.form(0) == rows.form(1))
    assert np.all(own.form(1) == np.vectorize(lambda x: fmpq(*x.as_integer_ratio()))(table))
    assert np.array_equal(fewer.errors, [problem.errors[1], np.zeros((3, 3))])
    first = problem.contacts.boundaries[0]
    less = problem.without_bodies([first])
    kept = np.flatnonzero(np.array(problem.contacts.boundaries)[problem.contacts.pair] != first)
    assert 0 < len(kept) == len(less.contacts.names) < len(problem.contacts.names)
    assert np.array_equal(less.contacts.errors, problem.contacts.errors[kept])
    other = ExactRows(less)
    for k, row in enumerate(kept.tolist()):
        (form, sides), (again, more) = other.feature(k), rows.feature(row)
        assert all(map(same, form.flat, again.flat))
        assert all(map(same, sides.flat, more.flat))


def test_arrays_are_exact_as_they_are():
    table = np.random.default_rng(2).normal(size=(2, 3, 3))
    problem = Problem(HarmonicForm(table, RR), ("a", "b"), ((-0.1, 0.3), None), LIMITS)
    rows = ExactRows(problem)
    assert not problem.errors.any()
    for k in range(2):
        assert all(
            x == fmpq(*float(y).as_integer_ratio())
            for x, y in zip(rows.form(k).flat, table[k].flat, strict=True)
        )
    assert rows.range(0) == (arb(-0.1), arb(0.3))
    assert rows.range(1) is None


def test_cuts_and_limits_of_a_region_by_windows_are_exact_and_ends_of_windows_are_doubles():
    table = packaged_table()
    table["joint"][1]["limits"] = [-100, 60]
    robot = parse_robot(table)
    region, whole = window_region(robot), clearance_problem(robot)
    problem, from_file = window_problem(region), ExactRows(whole)
    rows = ExactRows(problem)
    assert problem.limits == (("B2", "B1"), ("q2.lower", "B3"))
    assert_close(problem)
    floor = from_file.form(whole.names.index("B7"))
    assert all(map(same, rows.form(0).flat, floor.flat))
    limit, window = rows.range(1)
    assert limit.overlaps(from_file.range(1)[0])
    assert not limit.overlaps(arb(region.box.lower[1]))
    assert window == arb(region.box.upper[1])
    component = pair_vector(robot, robot.boundary("B1"))[0]  # not the clearance of B1
    more = window_problem(region.with_cut("B1", component, 1))
    assert more.origins == (robot.boundary("B7"), None)
    assert not more.errors[1].any()


def test_a_robot_of_the_small_library_has_no_decimals_for_the_engine():
    with pytest.raises(TypeError, match=r"region\.robot: wanted a Robot of cspace\.load_robot"):
        window_problem(window_region(load_small("minervabot-v2")))


@pytest.mark.parametrize(
    ("change", "name"),
    [
        (lambda table: row_of(table, "point", "3").update(radius=0.5), "B7"),
        (lambda table: table.update(collisions="all"), "0, 1"),
    ],
)
def test_what_the_small_library_passes_over_is_refused(change, name):
    table = packaged_table()
    change(table)
    region = window_region(parse_robot(table))
    with pytest.raises(ValueError, match=f"^{name}: qbound knows points only"):
        window_problem(region)


# --- what was wrong with the floats ---------------------------------------------------------------


def test_side_conditions_of_tiny_arms_are_not_taken_for_rounding():
    """A length below 1e-15 was zero beside an edge, whatever the size of the arm."""
    text = body_scenes.scene(32)
    usual, tiny = (
        clearance_problem(body_scenes.robot(each)).contacts
        for each in (text, body_scenes.shifted(text, -18))
    )
    asked = usual.side_errors.any(axis=(2, 3)) & ~usual.corners[:, None]  # the others are 1
    edges = asked & [True, True, False, False]
    wanted = usual.sides[edges]
    assert len(wanted) > 99
    assert_allclose(1e18 * tiny.sides[edges], wanted, rtol=1e-12, atol=1e-14 * np.abs(wanted).max())
