"""What the printed digits leave open: every offset may be off by half a unit of its last place.

The results of chapters 2 to 9 are computed again, with `qbound`, for arms whose offsets are drawn
within that; `lizarraga2025.beyond.uncertainty` does so for chapters 11 to 13 and writes the record.
The error of the arithmetic (`numerical_error`) is smaller by many orders.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cache
from typing import Any, Final, Literal, NamedTuple, TypeVar, cast

import numpy as np
from numpy.typing import ArrayLike

from lizarraga2025 import printed as paper
from lizarraga2025.choices import LEFT, RIGHT, SCALE
from lizarraga2025.recorded import DRAWS
from lizarraga2025.results import rounded_up
from qbound import (
    HarmonicForm,
    Region,
    Robot,
    Workspace,
    circle_arc,
    circle_roots,
    clearance,
    clearance_region,
    closest_approach,
    joint_windows,
    pair_vector,
    planar_arm,
    polygon,
    position,
    traverse,
    window_region,
)
from qbound.arrays import Floats
from qbound.circle import nearest_turn
from qbound.symbols import offset_values, with_symbols, with_values
from qbound.traversal import asymmetry, neighbour_orders, simple_orders
from qbound.workspace import PLANE

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
Arm = TypeVar("Arm", bound=Robot)


def chapters_2_to_9(robot: Robot) -> Values:
    """Return the results of chapters 2 to 9 that the offsets enter, by their ids."""
    region = window_region(robot)
    found: Values = {}
    for part in (_arm, _pairs, _bounds, _region, _workspace, _shares):
        found |= part(robot, region)
    return found


def _plain(numbers: Mapping[str, Any]) -> Values:
    return {name: Value(number) for name, number in numbers.items()}


def _of_region(numbers: Mapping[str, Any], region: Region) -> Values:
    sides = tuple(bound.label for corner in region.corners for bound in corner.bounds)
    return {name: Value(number, sides) for name, number in numbers.items()}


def _arm(robot: Robot, _: Region) -> Values:
    (x12, _y, z12), x23 = robot.joints[1].origin, robot.point("3").at[0]
    home_x, _, home_z = position(robot)(robot.home)
    length, angle = np.hypot(x12, z12), np.degrees(np.arctan2(z12, x12))
    turned, folded = np.radians([60.0, -40.0]), np.radians([-60.0, -150.0])
    found = {"home.x": home_x, "home.z": home_z, "link1.length": length, "link1.angle": angle}
    found |= {"reach.stretched": length + x23, "singular.q2": -angle}
    for o in ("1", "0"):
        found[f"B3_from_{o}"] = robot.frames(turned).position("10", "11", observer=o)
    for pose, q in (("home", robot.home), ("folded", folded)):
        found[f"components_{pose}"] = [pair_vector(robot, p)(q) for p in robot.used_pairs]
    for name in ("7", "9", "10", "12"):  # along link 1 and across it
        x, z = robot.point(name).at[PLANE]
        found[f"corner.{name}"] = np.array([x12 * x + z12 * z, z12 * x - x12 * z]) / length
    for name in ("11", "13"):
        found[f"corner.{name}"] = robot.point(name).at[PLANE]
    for name, h in (
        ("beta_{5,1}", -robot.boundary("B5").offset),
        ("beta_{6,1}", -robot.boundary("B6").offset),
        ("beta_{7,3}", robot.joints[0].origin[2] - robot.boundary("B7").offset),
    ):
        widths = (circle_arc(length, 0, c - h).half_width for c in (-x23, x23))
        found[f"{name}.defined"] = -100 * np.diff(list(widths))[0] / np.pi
    return _plain(found)


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


def _pairs(robot: Robot, _: Region) -> Values:
    found: Values = {}
    for pair in robot.used_pairs:
        nearest = closest_approach(robot, pair)
        longer = (pair.points[int(np.argmax(nearest.radii))],)
        found[f"{pair.name}.closest.q"] = Value(np.degrees(nearest.q))
        found[f"{pair.name}.closest.gap"] = Value(nearest.gap, longer)
        found[f"{pair.name}.radii"] = Value(nearest.radii)
    B4, gap = robot.boundary("B4"), found["B4.closest.gap"].value
    mended, in_mm = corrected(robot), _in_millimetres(robot)
    without_slip = closest_approach(mended, mended.boundary("B4"))
    decided = (B4.points[int(np.argmax(without_slip.radii))],)
    found["B4.gap.mended"] = Value(without_slip.gap, decided)
    found["B4.gap.ratio"] = Value(gap / without_slip.gap, decided)
    near, far = (robot.point(name).at for name in B4.points)
    first = near - robot.joints[1].origin
    slopes = [np.abs(arm).sum() / np.linalg.norm(arm) for arm in (first, first, far)]
    found["B4.gap.rounding"] = Value(paper.HALF_DIGIT * np.sum(slopes))
    found["B4.radii.mm"] = Value(closest_approach(in_mm, B4).radii)
    roots = 0
    for j in (0, 2):
        c0, a, b = pair_vector(in_mm, B4)[j].along(1, robot.home)
        roots += int(circle_roots(a, b, -c0).count)
    found["B4.roots.mm"] = Value(roots)
    x_min, z_min = (robot.boundary(name).offset / 10 for name in ("B5", "B7"))
    (x12, _y, z12), z01 = robot.joints[1].origin, robot.joints[0].origin[2]
    hangs = circle_roots(z12, -x12, z_min + robot.point("3").at[0] - z01).q[1]
    found |= _plain(
        {"floor.mm.highest": 90 - np.degrees(hangs), "x_min.mm": x_min, "z_min.mm": z_min}
    )
    return found


def _in_millimetres(robot: Robot) -> Robot:
    points = (replace(p, at=p.at / 10) if p.name in ("12", "13") else p for p in robot.points)
    return replace(robot, points=tuple(points))


OF_PAIRS: Final = [label for label in paper.TABLE_6 if paper.indices(label)[0] <= 4]


@cache
def _table_6(symbols: tuple[Any, ...]) -> dict[str, Callable[..., list[float]]]:
    """Return the bounds of the pairs as functions of the offsets, for each reading of arctan."""
    import sympy

    def bounds(reading: Literal["atan2", "arctan"]) -> Callable[..., list[float]]:
        forms = [paper.expression(paper.TABLE_6[label], arctan=reading) for label in OF_PAIRS]
        function: Callable[..., list[float]] = sympy.lambdify(symbols, forms, "math")
        return function

    return {"atan2": bounds("atan2"), "arctan": bounds("arctan")}


def _bounds(robot: Robot, region: Region) -> Values:
    offsets = offset_values(robot)
    by_reading = {
        reading: dict(zip(OF_PAIRS, np.degrees(bounds(*offsets.values())), strict=True))
        for reading, bounds in _table_6(tuple(offsets)).items()
    }
    of, misread = by_reading["atan2"], by_reading["arctan"]
    found = _plain(of)
    for window in joint_windows(robot):
        name = window.bound(1).label[:-3] + "}"
        poses = np.zeros((2, 2))
        poses[:, window.joint] = window.upper, window.other_root
        apart = pair_vector(robot, robot.boundary(window.boundary))(poses)
        there, other = np.linalg.norm(apart, axis=-1)
        found |= _plain({f"{name}.distance": there, f"{name}.left_out.distance": other})
        found[f"{name}.left_out"] = Value(np.degrees(window.other_root))
    one, two = (misread[f"beta_{{3,3,{k}}}"] for k in (1, 2))
    apart = pair_vector(robot, robot.boundary("B3"))(np.radians([0, one]))
    found |= _plain({"beta_{3,3,1}.arctan": one, "beta_{3,3,2}.arctan": two})
    found["beta_{3,3}.arctan.distance"] = Value(np.linalg.norm(apart))
    found["beta_{3,3,1}.plus_pi"] = Value(two + 540)
    found["arctan.differs"] = Value(sum(not np.isclose(of[x], misread[x]) for x in of))
    for reading, ends in by_reading.items():
        sides = []
        for numbers in ((1, 2), (3, 4)):
            own = [label for label in ends if paper.indices(label)[0] in numbers]
            sides.append(max((x for x in own if x.endswith("2}")), key=ends.__getitem__))
            sides.append(min((x for x in own if x.endswith("1}")), key=ends.__getitem__))
        found[f"box.{reading}"] = Value([ends[label] for label in sides], tuple(sides))
    signs, names = [], []
    for joint, pairs in ((0, ("B1", "B2")), (1, ("B3", "B4"))):
        lower, upper = [], []
        for j in (0, 2):
            for name in pairs:
                c0, a, b = pair_vector(robot, robot.boundary(name))[j].along(joint, robot.home)
                arc = circle_arc(a, b, -c0)
                middle = nearest_turn(arc.centre, 0)
                lower.append((middle - arc.half_width, f"{name} {j}"))
                upper.append((middle + arc.half_width, f"{name} {j}"))
        signs += [max(lower)[0], min(upper)[0]]
        names += [max(lower)[1], min(upper)[1]]
    found["box.signs"] = Value(np.degrees(signs), tuple(names))
    return found


def _least(form: HarmonicForm, corners: Floats) -> tuple[float, Floats]:
    """Return the least value of a form on the edges of a polygon, and where: by zooming in.

    All edges at once, because 247 arms take minutes with `qbound.scaling.least_on_edges`.
    """
    start, along = corners, np.roll(corners, -1, axis=0) - corners
    t, half = np.full(len(corners), 0.5), 0.5
    for _ in range(5):
        near = np.clip(t[:, None] + half * np.linspace(-1, 1, 65), 0, 1)
        q = start[:, None] + near[..., None] * along[:, None]
        values = form(q)
        chosen = np.arange(len(t)), values.argmin(axis=1)
        t, half = near[chosen], half / 16
    best = int(values[chosen].argmin())
    return float(values[chosen][best]), q[chosen][best]


def _largest_scale(form: HarmonicForm, corners: Floats, centre: Floats) -> tuple[float, Floats]:
    """Return the scale of a polygon at which a form first vanishes on it, and where: by secants."""
    s, last = 0.95, (1.0, _least(form, corners)[0])
    while abs(s - last[0]) > 1e-14:
        value, q = _least(form, polygon.scaled(corners, s, centre))
        if value == last[1]:
            break
        s, last = s - value * (s - last[0]) / (value - last[1]), (s, value)
    return s, q


def _region(robot: Robot, region: Region) -> Values:
    hexagon, floor = region.polygon, clearance(robot, robot.boundary("B7"))
    centre, mean, area = polygon.centroid(hexagon), hexagon.mean(axis=0), polygon.area(hexagon)
    deg2 = np.degrees(1) ** 2
    of_region: dict[str, Any] = {
        "polygon.area": area,
        "polygon.area.deg": area * deg2,
        "polygon.centroid": np.degrees(centre),
        "polygon.centroid.vertices": np.degrees(mean),
        "paper.area": region.area,
        "paper.area.deg": region.area * deg2,
        "paper.centroid": np.degrees(region.centroid),
    }
    found: Values = {}
    for i, corner in enumerate(region.corners, start=1):
        names = tuple(bound.label for bound in corner.bounds)
        found[f"vertex.{i}"] = Value(np.degrees(corner.q), names)
        found[f"vertex.{i}.bounds"] = Value(", ".join(names))
    if len(region.corners) != 6:
        raise ArithmeticError(f"{len(region.corners)} corners")
    for i in (3, 6):
        ends = hexagon[i - 1], hexagon[i % 6]
        of_region[f"edge.{i}.depth"] = -_least(floor, np.array(ends))[0]
    of_region["chords.depths"] = [
        -_least(floor, region.with_points(n, tangents=False))[0] for n in (2, 3, 5, 9, 17, 33)
    ]
    for n in (2, 3, 5):
        inner = region.with_points(n, tangents=True)
        of_region[f"tangents.{len(inner)}.area"] = 100 * polygon.area(inner) / area
    largest, touches = _largest_scale(floor, hexagon, centre)
    of_region |= {"largest_scale.area": largest, "largest_scale.touches": np.degrees(touches)}
    of_region["largest_scale.vertices"], _ = _largest_scale(floor, hexagon, mean)
    for s in (1.0, 0.97, 0.96, 0.95, 0.9, 0.8):
        smaller = polygon.scaled(hexagon, s, centre)
        margins = [_least(floor, smaller)[0]]
        for pair in robot.used_pairs:
            least, _ = _least(clearance(robot, pair), smaller)
            margins.append(np.sqrt(least + pair.clearance**2))
        of_region[f"scale.{s}.margins"] = margins
    mended = window_region(corrected(robot)).polygon
    of_region["mended.shift"] = np.degrees(np.abs(mended - hexagon)).max(axis=0)
    of_region["mended.q2.lower"] = np.degrees(mended[0, 1])
    return found | _of_region(of_region, region)


def _workspace(robot: Robot, region: Region) -> Values:
    hexagon = region.polygon
    centre, arm, tool = polygon.centroid(hexagon), planar_arm(robot), position(robot)
    found: dict[str, Any] = {}
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
    by_neighbours = neighbour_orders(6, 5)
    free = sum(order in simple or order[::-1] in simple for order in by_neighbours)
    found |= {"orders.simple": len(simple), "sequences.free": free}
    around = traverse(robot, points, closed=True, step=COARSE)
    found["six.crossings"] = len(polygon.self_crossings(around.tool))
    lowest = hexagon[:, 1].min()
    found["scale.nonsingular"] = (arm.stretched - centre[1]) / (lowest - centre[1])
    reached = Workspace(region)
    once = reached.area - reached.covered_twice
    found["workspace.area.paper"] = reached.area
    found["workspace.covered_twice.paper"] = reached.covered_twice
    found["workspace.covered_once.paper"] = once
    found["workspace.share"] = 100 * once / reached.area
    for name, one in (("minervabot-v2", robot), ("minervabot-v2-corrected", corrected(robot))):
        six = window_region(one).polygon
        for s in (1.0, SCALE, 0.8):
            p = polygon.scaled(six, s, polygon.centroid(six))
            found[f"asymmetry.{name}.{s}"] = asymmetry(
                one, p[list(RIGHT)], p[list(LEFT)], step=COARSE
            )
            if s == SCALE and name != "minervabot-v2":
                found[f"reach.{name}"] = planar_arm(one).reach(p[[3, 0]])
    return _of_region(found, region)


def _shares(robot: Robot, region: Region) -> Values:
    square, positive = (2 * np.pi) ** 2, region
    for pair in robot.used_pairs:
        for j in (0, 2):
            positive = positive.with_cut(f"{pair.name} {j}", pair_vector(robot, pair)[j])
    found: dict[str, Any] = {"share_with_a_negative": 1 - positive.area / region.area}
    for name in ("B5", "B6", "B7"):
        above = region.with_cut(f"{name} positive", clearance(robot, robot.boundary(name)))
        found[f"share_{name}_negative"] = abs(100 * (1 - above.area / region.area))
    alone, clear = clearance_region(robot, ["B7"]).area, clearance_region(robot).area
    p = region.area / square
    found |= {"free.exact": 100 * p, "free.feasible": 100 * p}
    found |= {
        "free.keeps_geometric": 100 * alone / square,
        "free.keeps_clear": 100 * clear / square,
    }
    found["free.keeps_components_positive"] = 100 * positive.area / square
    found["pairs.cost"] = 100 * (alone - clear) / square
    for k in (2, 3, 6, 9, 12):
        found[f"effort.samples.{k}"] = (1 - p) / p * 10.0 ** (2 * k)
        nodes = (
            n for n in range(1, 99) if abs(region.area_by_nodes(n) / region.area - 1) < 10.0**-k
        )
        if k < 12:
            found[f"effort.closed.{k}"] = 12 + 2 * next(nodes)
    q = np.random.default_rng(11).uniform(-np.pi, np.pi, (20_000, 2))
    allowed, other = (region.contains(x) for x in (q, planar_arm(robot).other_posture(q)))
    found["free.other_collides"] = 100 * (~other[allowed]).mean()
    found["colliding.other_free"] = 100 * other[~allowed].mean()
    apart = all(closest_approach(robot, pair).gap > 0 for pair in robot.used_pairs)
    found["free.misses_points"] = 100.0 if apart else np.nan
    return _of_region(found, region)


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
