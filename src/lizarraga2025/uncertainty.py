"""What the printed digits leave open: every offset may be off by half a unit of its last place.

The results of chapters 2 to 9 are computed again, with `qbound`, for arms whose offsets are drawn
within that; `lizarraga2025.beyond.uncertainty` does so for chapters 11 to 13 and writes the record.
The error of the arithmetic (`numerical_error`) is smaller by many orders.
"""

from collections import Counter
from collections.abc import Callable
from functools import cache
from itertools import product
from typing import Any, Final, NamedTuple, TypeVar, cast

import numpy as np
from numpy.typing import ArrayLike

from lizarraga2025 import printed as paper
from lizarraga2025.choices import LEFT, RIGHT, SCALE
from lizarraga2025.evidence import arms, rounding
from lizarraga2025.recorded import DRAWS
from lizarraga2025.results import rounded_up
from qbound import polygon
from qbound.boundary import Approach, clearance, closest_approach, pair_vector, position
from qbound.circle import TURN, circle_arc, circle_roots, nearest_turn, roots_along
from qbound.region import Region, clearance_region, window_region
from qbound.robot import Pair, Robot
from qbound.scaling import largest_scale, least_along, least_on_edges
from qbound.symbols import offset_values, with_symbols, with_values
from qbound.traversal import asymmetry, neighbour_orders, simple_orders, traverse
from qbound.windows import joint_windows
from qbound.workspace import PLANE, Workspace, planar_arm

SEED: Final = 1
STEP: Final = 1e-5
"""Half the step of the derivatives, cm: less than the distance of the printed arm from any kink."""

COARSE: Final = 0.02
"""Step of paths, rad: four times that of the chapters."""

ROUNDING: Final = 1e-9
"""A change that the arithmetic may have made, in any unit of the results."""

MISPRINT: Final = "x_{2,13}"
SLIP: Final = 0.09
"""The digit that is probably a misprint: 9.00 cm for 9.09 (chapter 5)."""

BY_CHOICE: Final = (
    *("labels.length", "r_ab_from_c", "r_ab_from_a", "r_ab_from_b", "labels.miss"),
    *("plane_from_0", "plane_from_a", "q_turned", "q_folded", "d_min", "scale", "bounds"),
    *("picture.n", "contour.evaluations", "equal", "scales", "worst.scales", "worst.scale"),
    *("reach.minervabot-v2-symmetric", "areas.minervabot-v2-symmetric", "symmetric.contacts"),
    *("symmetric.area.points", "second.opinion"),
)
"""Results that no printed digit enters: examples and choices of the book, counts of what is
printed, and the symmetric arm."""


class Value(NamedTuple):
    """A result, and the names of what decides it: where these change, it has a kink."""

    value: Any
    decided_by: tuple[str, ...] = ()


Values = dict[str, Value]
Numbers = dict[str, Any]
"""Results by their ids, as numbers or, with what decides them, as `Value`."""

Arm = TypeVar("Arm", bound=Robot)


def chapters_2_to_9(robot: Robot) -> Values:
    """Return the results of chapters 2 to 9 that the offsets enter, by their ids."""
    region = window_region(robot)
    sides = tuple(bound.label for corner in region.corners for bound in corner.bounds)
    found = as_values(_arm(robot) | _pairs(robot) | _bounds(robot))
    for part in (_corners, _polygon, _workspace, _shares):
        found |= as_values(part(robot, region), sides)
    return found


def as_values(numbers: Numbers, decided_by: tuple[str, ...] = ()) -> Values:
    """Return numbers as values that the same names decide, where nothing else is said of them."""
    return {k: x if isinstance(x, Value) else Value(x, decided_by) for k, x in numbers.items()}


def arm_with(robot: Arm, offsets: ArrayLike) -> Arm:
    """Return the robot with other printed offsets, in the order of `offset_values`."""
    numbers = dict(zip(offset_values(robot), np.asarray(offsets), strict=True))
    return cast(Arm, with_values(with_symbols(robot), numbers))


def drawn_arms(robot: Arm) -> list[Arm]:
    """Return the arms whose offsets are drawn within half a unit of their last printed digit."""
    printed = np.array(list(offset_values(robot).values()))
    shifts = np.random.default_rng(SEED).uniform(-1, 1, (DRAWS, len(printed))) * paper.HALF_DIGIT
    return [arm_with(robot, printed + by) for by in shifts]


def corrected(robot: Arm) -> Arm:
    """Return the robot without the likely misprint."""
    has_slip = robot.point("13").at[0] < robot.point("11").at[0] - SLIP / 2
    offsets = offset_values(robot).items()
    return arm_with(robot, [x + SLIP * (has_slip and str(s) == MISPRINT) for s, x in offsets])


# --- the results ----------------------------------------------------------------------------------


def _arm(robot: Robot) -> Numbers:
    (x12, _y, z12), x23 = robot.joints[1].origin, robot.point("3").at[0]
    home_x, _, home_z = position(robot)(robot.home)
    length, angle = np.hypot(x12, z12), np.degrees(np.arctan2(z12, x12))
    turned, folded = np.radians([60.0, -40.0]), np.radians([-60.0, -150.0])
    found: Numbers = {"home.x": home_x, "home.z": home_z}
    found |= {"link1.length": length, "link1.angle": angle}
    found |= {"reach.stretched": length + x23, "singular.q2": -angle}
    found |= {f"B3_from_{o}": robot.frames(turned).position("10", "11", observer=o) for o in "10"}
    for pose, q in (("home", robot.home), ("folded", folded)):
        found[f"components_{pose}"] = [pair_vector(robot, p)(q) for p in robot.used_pairs]
    along_link_1 = np.array([[x12, z12], [z12, -x12]]) / length
    for name in ("7", "9", "10", "12"):
        found[f"corner.{name}"] = along_link_1 @ robot.point(name).at[PLANE]
    found |= {f"corner.{name}": robot.point(name).at[PLANE] for name in ("11", "13")}
    limits = {name: robot.boundary(name).offset for name in ("B5", "B6", "B7")}
    floor = robot.joints[0].origin[2] - limits["B7"]
    walls = {"beta_{5,1}": -limits["B5"], "beta_{6,1}": -limits["B6"], "beta_{7,3}": floor}
    for name, h in walls.items():
        low, high = (circle_arc(length, 0, c - h).half_width for c in (-x23, x23))
        found[f"{name}.defined"] = 100 * (low - high) / np.pi
    return found


def _pairs(robot: Robot) -> Numbers:
    found: Numbers = {}
    for pair in robot.used_pairs:
        nearest = closest_approach(robot, pair)
        found[f"{pair.name}.closest.q"] = np.degrees(nearest.q)
        found[f"{pair.name}.closest.gap"] = Value(nearest.gap, _longer(pair, nearest))
        found[f"{pair.name}.radii"] = nearest.radii
    B4, gap, in_mm = robot.boundary("B4"), nearest.gap, arms.in_millimetres(robot)
    without_slip = closest_approach(corrected(robot), B4)
    decided = _longer(B4, without_slip)
    found["B4.gap.mended"] = Value(without_slip.gap, decided)
    found["B4.gap.ratio"] = Value(gap / without_slip.gap, decided)
    found["B4.gap.rounding"] = rounding.contact(B4, robot)
    found["B4.radii.mm"] = closest_approach(in_mm, B4).radii
    roots = [roots_along(pair_vector(in_mm, B4)[j], 1, robot.home) for j in (0, 2)]
    found["B4.roots.mm"] = int(np.isfinite(roots).sum())
    x_min, z_min = (robot.boundary(name).offset / 10 for name in ("B5", "B7"))
    (x12, _y, z12), z01 = robot.joints[1].origin, robot.joints[0].origin[2]
    hangs = circle_roots(z12, -x12, z_min + robot.point("3").at[0] - z01).q[1]
    highest = 90 - np.degrees(hangs)
    return found | {"floor.mm.highest": highest, "x_min.mm": x_min, "z_min.mm": z_min}


def _longer(pair: Pair, nearest: Approach) -> tuple[str, ...]:
    """Return the point of a pair that is farther from the joint between them."""
    return (pair.points[int(np.argmax(nearest.radii))],)


OF_PAIRS: Final = [label for label in paper.TABLE_6 if paper.indices(label)[0] <= 4]


@cache
def _table_6(symbols: tuple[Any, ...]) -> dict[str, Callable[..., list[float]]]:
    """Return the bounds of the pairs as functions of the offsets, for each reading of arctan."""
    import sympy

    readings: tuple[paper.Reading, ...] = ("atan2", "arctan")
    return {
        arctan: sympy.lambdify(
            symbols, [paper.expression(paper.TABLE_6[x], arctan=arctan) for x in OF_PAIRS], "math"
        )
        for arctan in readings
    }


def _bounds(robot: Robot) -> Numbers:
    offsets = offset_values(robot)
    by_reading = {
        arctan: dict(zip(OF_PAIRS, np.degrees(bounds(*offsets.values())), strict=True))
        for arctan, bounds in _table_6(tuple(offsets)).items()
    }
    of, misread = by_reading["atan2"], by_reading["arctan"]
    found: Numbers = {**of}
    for window in joint_windows(robot):
        name = window.bound(1).label[:-3] + "}"
        poses = np.zeros((2, 2))
        poses[:, window.joint] = window.upper, window.other_root
        apart = pair_vector(robot, robot.boundary(window.boundary))(poses)
        there, other = np.linalg.norm(apart, axis=-1)
        found |= {f"{name}.distance": there, f"{name}.left_out.distance": other}
        found[f"{name}.left_out"] = np.degrees(window.other_root)
    one, two = (misread[f"beta_{{3,3,{k}}}"] for k in (1, 2))
    apart = pair_vector(robot, robot.boundary("B3"))(np.radians([0, one]))
    found |= {"beta_{3,3,1}.arctan": one, "beta_{3,3,2}.arctan": two}
    found["beta_{3,3}.arctan.distance"] = np.linalg.norm(apart)
    found["beta_{3,3,1}.plus_pi"] = two + 540
    found["arctan.differs"] = sum(not np.isclose(of[x], misread[x]) for x in of)
    for arctan, ends in by_reading.items():
        sides = []
        for numbers in ("12", "34"):
            own = [label for label in ends if label[6] in numbers]
            sides.append(max((x for x in own if x.endswith("2}")), key=ends.__getitem__))
            sides.append(min((x for x in own if x.endswith("1}")), key=ends.__getitem__))
        found[f"box.{arctan}"] = Value([ends[label] for label in sides], tuple(sides))
    signs, names = [], []
    for joint, pairs in enumerate((("B1", "B2"), ("B3", "B4"))):
        positive = {}
        for name, j in product(pairs, (0, 2)):
            c0, a, b = pair_vector(robot, robot.boundary(name))[j].along(joint, robot.home)
            arc = circle_arc(a, b, -c0)
            middle = nearest_turn(arc.centre, 0)
            positive[f"{name} {j}"] = middle - arc.half_width, middle + arc.half_width
        names.append(max(positive, key=lambda name: positive[name][0]))
        names.append(min(positive, key=lambda name: positive[name][1]))
        signs += [positive[names[-2]][0], positive[names[-1]][1]]
    return found | {"box.signs": Value(np.degrees(signs), tuple(names))}


def _corners(_: Robot, region: Region) -> Numbers:
    found: Numbers = {}
    for i, corner in enumerate(region.corners, start=1):
        names = tuple(bound.label for bound in corner.bounds)
        found[f"vertex.{i}"] = Value(np.degrees(corner.q), names)
        found[f"vertex.{i}.bounds"] = Value(", ".join(names))
    if len(region.corners) != 6:
        raise ArithmeticError(f"{len(region.corners)} corners")
    return found


def _polygon(robot: Robot, region: Region) -> Numbers:
    hexagon, floor = region.polygon, clearance(robot, robot.boundary("B7"))
    centre, mean, area = polygon.centroid(hexagon), hexagon.mean(axis=0), polygon.area(hexagon)
    deg2 = np.degrees(1) ** 2
    found: Numbers = {"polygon.area": area, "polygon.area.deg": area * deg2}
    found["polygon.centroid"] = np.degrees(centre)
    found["polygon.centroid.vertices"] = np.degrees(mean)
    found |= {"paper.area": region.area, "paper.area.deg": region.area * deg2}
    found["paper.centroid"] = np.degrees(region.centroid)
    for i in (3, 6):
        found[f"edge.{i}.depth"] = -least_along(floor, *hexagon[[i - 1, i % 6]]).value
    chords = [region.with_points(n, tangents=False) for n in (2, 3, 5, 9, 17, 33)]
    found["chords.depths"] = [-least_on_edges(floor, chord).value for chord in chords]
    for n in (2, 3, 5):
        inner = region.with_points(n, tangents=True)
        found[f"tangents.{len(inner)}.area"] = 100 * polygon.area(inner) / area
    largest = largest_scale(floor, hexagon, centre)
    found |= {"largest_scale.area": largest.scale, "largest_scale.touches": np.degrees(largest.q)}
    found["largest_scale.vertices"] = largest_scale(floor, hexagon, mean).scale
    for s in (1.0, 0.97, 0.96, 0.95, 0.9, 0.8):
        smaller = polygon.scaled(hexagon, s, centre)
        margins = [least_on_edges(floor, smaller).value]
        for pair in robot.used_pairs:
            least = least_on_edges(clearance(robot, pair), smaller).value
            margins.append(np.sqrt(least + pair.clearance**2))
        found[f"scale.{s}.margins"] = margins
    mended = window_region(corrected(robot)).polygon
    found["mended.shift"] = np.degrees(np.abs(mended - hexagon)).max(axis=0)
    return found | {"mended.q2.lower": np.degrees(mended[0, 1])}


def _workspace(robot: Robot, region: Region) -> Numbers:
    hexagon, arm, tool = region.polygon, planar_arm(robot), position(robot)
    centre = polygon.centroid(hexagon)
    found: Numbers = {}
    for s in (1.0, SCALE):
        for i, q in enumerate(polygon.scaled(hexagon, s, centre), start=1):
            found[f"tool.{i}.scale.{s}"] = tool(q)[PLANE]
    points = polygon.scaled(hexagon, SCALE, centre)
    for i in (1, 4):
        found[f"pose.{i}.scale.{SCALE}"] = np.degrees(points[i - 1])
        found[f"reach.{i}.scale.{SCALE}"] = arm.reach(points[i - 1])
    reaches = arm.reach(points)
    found["sequences.final_reach"] = [reaches.min(), reaches.max()]
    simple = simple_orders(robot, points, 5, step=COARSE)
    free = sum(order in simple or order[::-1] in simple for order in neighbour_orders(6, 5))
    found |= {"orders.simple": len(simple), "sequences.free": free}
    around = traverse(robot, points, closed=True, step=COARSE)
    found["six.crossings"] = len(polygon.self_crossings(around.tool))
    lowest = hexagon[:, 1].min()
    found["scale.nonsingular"] = (arm.stretched - centre[1]) / (lowest - centre[1])
    reached = Workspace(region)
    whole, twice = reached.area, reached.covered_twice
    found |= {"workspace.area.paper": whole, "workspace.covered_twice.paper": twice}
    found["workspace.covered_once.paper"] = whole - twice
    found["workspace.share"] = 100 * (whole - twice) / whole
    for name, one in (("minervabot-v2", robot), ("minervabot-v2-corrected", corrected(robot))):
        six = window_region(one).polygon
        for s in (1.0, SCALE, 0.8):
            p = polygon.scaled(six, s, polygon.centroid(six))
            apart = asymmetry(one, p[list(RIGHT)], p[list(LEFT)], step=COARSE)
            found[f"asymmetry.{name}.{s}"] = apart
            if s == SCALE and one is not robot:
                found[f"reach.{name}"] = planar_arm(one).reach(p[[3, 0]])
    return found


def _shares(robot: Robot, region: Region) -> Numbers:
    whole, positive = region.area, region
    for pair, j in product(robot.used_pairs, (0, 2)):
        positive = positive.with_cut(f"{pair.name} {j}", pair_vector(robot, pair)[j])
    found: Numbers = {"share_with_a_negative": 1 - positive.area / whole}
    for name in ("B5", "B6", "B7"):
        above = region.with_cut(f"{name} positive", clearance(robot, robot.boundary(name)))
        found[f"share_{name}_negative"] = abs(100 * (1 - above.area / whole))
    alone, clear = clearance_region(robot, ["B7"]).area, clearance_region(robot).area
    part, percent = whole / TURN**2, 100 / TURN**2
    found |= {"free.exact": percent * whole, "free.feasible": percent * whole}
    found |= {"free.keeps_geometric": percent * alone, "free.keeps_clear": percent * clear}
    found["free.keeps_components_positive"] = percent * positive.area
    found["pairs.cost"] = 100 * (alone - clear) / TURN**2
    errors = [abs(region.area_by_nodes(n) / whole - 1) for n in range(1, 99)]
    for k in (2, 3, 6, 9, 12):
        found[f"effort.samples.{k}"] = (1 - part) / part * 10.0 ** (2 * k)
        if k < 12:
            nodes = next(n for n, error in enumerate(errors, start=1) if error < 10.0**-k)
            found[f"effort.closed.{k}"] = 12 + 2 * nodes
    q = np.random.default_rng(11).uniform(-np.pi, np.pi, (20_000, 2))
    allowed, other = (region.contains(x) for x in (q, planar_arm(robot).other_posture(q)))
    found["free.other_collides"] = 100 * (~other[allowed]).mean()
    found["colliding.other_free"] = 100 * other[~allowed].mean()
    apart = all(closest_approach(robot, pair).gap > 0 for pair in robot.used_pairs)
    return found | {"free.misses_points": 100.0 if apart else np.nan}


# --- draws, derivatives, and the record -----------------------------------------------------------


def study(
    robot: Arm, quantities: Callable[[Arm], Values], run: Callable[..., Any] = map
) -> list[dict[str, Any]]:
    """Return what the printed digits leave open of each quantity, in the order of `quantities`.

    Parameters
    ----------
    robot : Robot
        With the printed offsets.
    quantities : callable
        The results of an arm, by their ids; the same ids for every arm.
    run : callable
        `map`, or that of a pool of processes.
    """
    offsets = offset_values(robot)
    names, printed = [str(symbol) for symbol in offsets], np.array(list(offsets.values()))
    steps = STEP * np.concatenate([np.eye(len(printed)), -np.eye(len(printed))])
    arms = [*drawn_arms(robot), *(arm_with(robot, printed + by) for by in steps)]
    here, slipless, *there = run(quantities, [robot, corrected(robot), *arms])
    drawn, up, down = there[:DRAWS], there[DRAWS : -len(names)], there[-len(names) :]
    found = []
    for name, (value, decided_by) in here.items():
        entry: dict[str, Any] = {"id": name}
        others = [one[name].value for one in drawn]
        if isinstance(value, int | str):
            entry["shares"] = {str(x): n / DRAWS for x, n in Counter(others).most_common()}
        if not isinstance(value, str):
            low, high = np.min(others, axis=0), np.max(others, axis=0)
            entry |= {"draws_from": np.asarray(low), "draws_to": np.asarray(high)}
            slopes = [
                np.subtract(a[name].value, b[name].value) for a, b in zip(up, down, strict=True)
            ]
            entry["first_order"] = np.abs(slopes).sum(axis=0) * paper.HALF_DIGIT / (2 * STEP)
            change = float(np.max([high - value, np.subtract(value, low)]))
            entry["input_uncertainty"] = rounded_up(change) if change > ROUNDING else 0.0
            without = np.asarray(slipless[name].value)
            if ((without < low - ROUNDING) | (without > high + ROUNDING)).any():
                entry["without_misprint"] = without
        elif set(others) == {value}:
            entry["input_uncertainty"] = 0.0
        changed = np.mean([one[name].decided_by != decided_by for one in drawn])
        if changed and entry.get("input_uncertainty") != 0:
            entry["another_boundary"] = float(changed)
        found.append({key: _written(item) for key, item in entry.items()})
    return found


def _written(item: Any) -> Any:
    """Return numbers with nine digits, more than the draws mean; all else as it is."""
    if isinstance(item, np.ndarray):
        return [_written(one) for one in item] if item.ndim else _written(float(item))
    if not isinstance(item, float):
        return item
    return float(f"{item:.9g}") if abs(item) > ROUNDING else 0.0
