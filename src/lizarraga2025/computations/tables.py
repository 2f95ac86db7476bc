"""Tables 1 to 6, each row: offsets, their units and digits, kinematics, windows."""

import re
from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from itertools import product
from math import prod
from typing import Any, Final

import numpy as np
import sympy as sp

from lizarraga2025 import printed as paper
from lizarraga2025.computations import bounds
from lizarraga2025.computations.registry import computes, computes_each
from lizarraga2025.computations.theorem_1 import components_are_derived
from lizarraga2025.evidence import arms
from lizarraga2025.evidence.arms import half_spaces, pairs, robot
from lizarraga2025.evidence.joint_region import by_windows, vertices
from lizarraga2025.evidence.rounding import SMALL, contact, degrees, other_slips
from lizarraga2025.verdicts import (
    Outcome,
    formula,
    judge,
    of_readings,
    of_rows,
    reading,
    undetermined,
)
from qbound import Robot, closest_approach, components, pair_vector, position, window_region
from qbound.circle import roots_along
from qbound.symbols import joint_symbols

# --- Table 1: offsets -----------------------------------------------------------------------------


@cache
def _factors() -> dict[str, str]:
    """Return the factors of each offset of Table 1 in the tool's x and z; "" for none."""
    arm, _ = arms.symbolic_robot()
    x, _, z = position(arm, "3").symbolic(joint_symbols(robot()))
    found = {}
    for label in (row[3] for row in paper.TABLE_1):
        factors = [sp.expand(c).coeff(sp.Symbol(label, real=True)) for c in (x, z)]
        told = [f"{sp.sstr(f)} in {c}" for f, c in zip(factors, "xz", strict=True) if f]
        found[label] = " and ".join(told).replace("*", " ")
    return found


@computes("T-1")
def offsets() -> Outcome:
    place = sp.Matrix(position(arms.symbolic_robot()[0], "3").symbolic(joint_symbols(robot())))
    used = {str(s) for s in place.free_symbols} - {"q_1", "q_2"}
    cm = paper.offsets_in_cm()
    x, z = cm["x_{1,2}"], cm["z_{1,2}"]
    rounded = max(abs(x - 30 * 0.5), abs(z - 30 * np.sqrt(0.75)))
    return Outcome(
        judge(holds=used == {row[3] for row in paper.TABLE_1} and rounded <= paper.HALF_DIGIT),
        f"The place of the tool depends on exactly these {len(used)} lengths. Link 1 measures"
        f" {np.hypot(x, z):.4f} cm at {np.degrees(np.arctan2(z, x)):.4f}°, thirty centimetres at"
        f" sixty degrees to within {rounded:.4f} cm, less than the rounding of two decimals.",
    )


@computes_each({f"T-1.{number}": row[3] for number, row in enumerate(paper.TABLE_1[:3], start=1)})
def offset(label: str) -> Outcome:
    """Judge whether the robot file has a printed offset, and the tool's place depends on it."""
    in_file = {str(symbol): value for symbol, value in arms.symbolic_robot()[1].items()}[label]
    return Outcome(
        judge(holds=in_file == paper.offsets_in_cm()[label] and bool(_factors()[label])),
        f"{in_file} cm in the robot file; its factor in the tool's place is {_factors()[label]}.",
    )


@computes("T-1.4")
def offset_of_the_tool() -> Outcome:
    _, _, words, label = paper.TABLE_1[3]
    named = max(int(number) for number in re.findall(r"joint (\d)", words))
    there = offset(label)
    is_there = there.most_favourable == "confirmed"
    return of_readings(
        f"The row names joint {named}; the robot has {len(robot().joints)} joints, and frame 3 is"
        f" that of the end effector, which Table 2 turns by no joint. {there.computed}",
        reading("joint 3", holds=is_there and named <= len(robot().joints), corrected=is_there),
        reading("frame 3, as joint stands for frame in the sentence on Table 2", holds=is_there),
    )


# --- Table 2: forward kinematics ------------------------------------------------------------------


Row = tuple[Any, Any]
"""The printed vector and matrix of a row of Table 2, as SymPy matrices."""


@cache
def _printed_kinematics(turn: int = 1) -> dict[tuple[str, str], Row]:
    """Return the rows of Table 2, worked out; the sense of R_y can be turned round."""
    rows: dict[tuple[str, str], Row] = {}
    for a, b, vector, matrix in paper.TABLE_2:
        rows[a, b] = _vector(vector, rows), _matrix(matrix, rows, turn)
    return rows


def _vector(text: str, rows: Mapping[tuple[str, str], Row]) -> Any:
    """Read a vector such as [0 0 z_{0,1}]^T, or a sum of earlier rows, each perhaps turned."""
    if text.startswith("["):
        entries = text.removeprefix("[").removesuffix("]^T").split(r"\ ")
        return sp.Matrix([0 if x == "0" else sp.Symbol(x, real=True) for x in entries])
    found = sp.zeros(3, 1)
    for sign, a, b, c, d in re.findall(_TERM, text):
        turned = rows[a, b][1] if a else sp.eye(3)
        found += (-1 if sign == "-" else 1) * turned * rows[c, d][0]
    return found


def _matrix(text: str, rows: Mapping[tuple[str, str], Row], turn: int) -> Any:
    """Read a rotation: I, R_y(q_1) or a product of earlier rows."""
    if of_joint := re.fullmatch(r"R_y\(q_(\d)\)", text):
        # R_y(q) carries z towards x; SymPy's rot_axis2 turns the other way.
        return sp.rot_axis2(-turn * joint_symbols(robot())[int(of_joint[1]) - 1])
    return prod((rows[a, b][1] for a, b in re.findall(r"R_\{(\d),(\d)\}", text)), start=sp.eye(3))


_TERM: Final = r"([+-]?) ?(?:R_\{(\d),(\d)\})?\\mathbf\{r\}_\{(\d),(\d)\}"
"""A term of a printed vector: sign, indices of a rotation if there is one, and of a vector."""


@cache
def _agrees(a: str, b: str, turn: int = 1) -> bool:
    frames = arms.symbolic_robot()[0].frames(np.array(joint_symbols(robot())))
    vector, matrix = _printed_kinematics(turn)[a, b]
    position_left = sp.simplify(sp.Matrix(frames.position(a, b, a)) - vector)
    rotation_left = sp.simplify(sp.Matrix(frames.rotation(a, b)) - matrix)
    return bool(position_left == sp.zeros(3, 1) and rotation_left == sp.zeros(3, 3))


@computes("T-2")
def kinematics() -> Outcome:
    rows = [_agrees(*row) for row in _printed_kinematics()]
    other = sum(_agrees(*row, turn=-1) for row in _printed_kinematics())
    return Outcome(
        judge(holds=all(rows)),
        f"{sum(rows)} of {len(rows)} rows agree by identity with the frames derived from the file,"
        f" if R_y(q) carries z towards x, as eq. (29) has it; with the other sense {other} would.",
    )


@computes_each({f"T-2.{number}": row[:2] for number, row in enumerate(paper.TABLE_2, start=1)})
def row_of_kinematics(frames: tuple[str, str]) -> Outcome:
    equal = _agrees(*frames)
    return Outcome(
        judge(holds=equal),
        f"Vector and rotation {'equal' if equal else 'are not'} those derived from the chain, by"
        " identity.",
    )


# --- Tables 3 and 4: point pairs ------------------------------------------------------------------


@computes_each(
    {"T-3.1": 1, "T-3.2": 2, "T-3.3": 3, "T-4.2": 4} | {f"E-17.{n}": n for n in (1, 2, 3, 4)}
)
def offsets_of_a_pair(number: int) -> Outcome:
    """Judge whether the two points of a pair meet: are as far from the joint between them."""
    pair = pairs()[number - 1]
    nearest, limit = closest_approach(robot(), pair), contact(pair)
    with_9_09 = closest_approach(arms.corrected(), pairs(arms.corrected())[number - 1]).gap
    text = f"The points are {nearest.radii[0]:.4f} and {nearest.radii[1]:.4f} cm from the joint"
    text += f" between them and come as close as {nearest.gap:.4f} cm, at {degrees(nearest.q)}."
    text += f" Rounding to two decimals can cause {limit:.4f} cm."
    if nearest.gap > limit:
        text += f" With x_{{2,13}} = 9.09, as x_{{2,11}}, it is {with_9_09:.4f} cm. {other_slips()}"
        text += " All hangs on one digit of a converted text."
    return Outcome(judge(holds=nearest.gap <= limit, corrected=with_9_09 <= limit), text)


@computes("T-3")
def table_3() -> Outcome:
    vectors = [components_are_derived(f"beta_{{{number},") for number in (1, 2, 3)]
    return of_rows([*map(offsets_of_a_pair, (1, 2, 3)), *vectors])


@computes("T-4")
def table_4() -> Outcome:
    rows = (unit_of_table_4(), offsets_of_a_pair(4), components_are_derived("beta_{4,"))
    return of_rows(rows, ": the unit (T-4.1), one digit (T-4.2), the vector")


@computes("T-4.1")
def unit_of_table_4() -> Outcome:
    in_mm, in_cm = (
        int(np.isfinite([roots_along(pair_vector(of, B4)[j], 1, of.home) for j in (0, 2)]).sum())
        for of in (arms.in_millimetres(robot()), robot())
        for B4 in pairs(of)[3:]
    )
    far, near = closest_approach(arms.in_millimetres(robot()), pairs()[3]).radii
    return Outcome(
        judge(holds=in_mm > 0, corrected=in_cm == 4),
        f"In mm the points are {far:.2f} and {near:.2f} cm from joint 2, and the two components of"
        f" B_4 have {in_mm} roots: the bounds of Table 6 and the β_{{4,1,2}} of Figure 4 would not"
        f" exist. In cm they have {in_cm}.",
    )


# --- Table 5: half-spaces -------------------------------------------------------------------------


@computes("T-5")
def table_5() -> Outcome:
    rows = [unit_of_the_floor(), unit_of_the_side_limits(), selection()]
    return of_rows([*rows, *map(vector_of_a_half_space, (5, 6, 7))])


@computes("T-5.1")
def unit_of_the_floor() -> Outcome:
    height = {unit: paper.offsets_in_cm(mm_means=unit)["z_{min,1}"] for unit in ("mm", "cm")}
    named, around = {}, {}
    for unit, h in height.items():
        floor = replace(half_spaces()[-1], offset=h)
        arm = replace(robot(), boundaries=(*robot().boundaries[:-1], floor))
        named[unit], around[unit] = len(vertices(arm)), _corners_by_the_component(arm)
    return Outcome(
        undetermined({unit: number == 6 for unit, number in around.items()}),
        f"At {height['cm']} cm and at {height['mm']:.3f} cm the component β_{{7,3}} and the four"
        f" sides that Figure 4 names close a region round home, with {around['cm']} and"
        f" {around['mm']} corners. By the bounds as they stand in Table 6, without a turn added,"
        f" they meet in {named['cm']} points and in {named['mm'] or 'none'}. The robot file takes"
        " cm, the unit of all other lengths.",
    )


def _corners_by_the_component(arm: Robot) -> int:
    """Count the corners of the box of windows cut by β_{7,3}."""
    region = window_region(arm)
    low, high, crossings = region.box.lower, region.box.upper, 0
    for held, free in ((0, 1), (1, 0)):
        ends = region.fibres(held, [low[held], high[held]]).end
        crossings += int(((low[free] < ends) & (ends < high[free])).sum())
    return crossings + int(region.contains([*product(*zip(low, high, strict=True))]).sum())


@computes("T-5.2")
def unit_of_the_side_limits() -> Outcome:
    region = vertices(replace(robot(), boundaries=(*pairs(), half_spaces()[-1])))
    fits, seen = {}, []
    for unit in ("mm", "cm"):
        cm = paper.offsets_in_cm(mm_means=unit)
        offsets = (cm["x_{min,1}"], cm["x_{min,2}"])
        sides = (replace(w, offset=x) for w, x in zip(half_spaces(), offsets, strict=False))
        corners = vertices(replace(robot(), boundaries=(*pairs(), *sides, half_spaces()[-1])))
        fits[unit] = len(corners) == len(region) and np.allclose(corners, region)
        seen.append(f"x = ±{cm['x_{min,1}']:g} cm")
    return Outcome(
        undetermined(fits),
        f"With {' and with '.join(seen)} the six points are the same, for neither wall bounds the"
        " region. The unit of all other lengths and the base, whose corners stand at"
        f" ±{abs(float(robot().point('6').at[0]))} cm, speak for cm.",
    )


@computes("T-5.3")
def selection() -> Outcome:
    S = {name: sp.Matrix(rows) for name, rows in paper.SELECTION.items()}
    selects = {"S_x": sp.diag(1, 0, 0), "S_z": sp.diag(0, 0, 1)}
    normals = [sp.Matrix([int(x) for x in w.normal]) for w in half_spaces()]
    of_walls = [S[name] for name, _ in paper.TABLE_5.values()]
    products = all(n * n.T == of_wall for n, of_wall in zip(normals, of_walls, strict=True))
    return Outcome(
        judge(holds=selects == S and products),
        "Each is zero but for a one in its place on the diagonal, a projection; it is n n^T with"
        f" the normal n of the wall, for all {len(normals)} walls of the robot file.",
    )


@computes_each({"T-5.4": 5, "T-5.5": 6, "T-5.6": 7})
def vector_of_a_half_space(number: int) -> Outcome:
    """Judge the product of the printed matrix with r_{0,3} of Table 2, less the printed vector."""
    arm, _ = arms.symbolic_robot()
    derived = components(arm, arm.boundary(f"B{number}")).symbolic(joint_symbols(robot()))
    name, limit = paper.TABLE_5[number]
    place, _ = _printed_kinematics()["0", "3"]
    limits = sp.Symbol(limit, real=True) * sp.ones(3, 1)
    printed = sp.Matrix(paper.SELECTION[name]) * (place - limits)
    return Outcome(judge(holds=(sp.Matrix(derived) - printed).expand() == sp.zeros(3, 1)))


# --- Table 6: windows -----------------------------------------------------------------------------


@computes("T-6")
def table_6() -> Outcome:
    arctan = atan2 = 0
    for label in paper.TABLE_6:
        if paper.indices(label)[0] < 5:
            bound = bounds.pair_bound(label)
            arctan += bound.plain_residual < bounds.RESIDUAL
            atan2 += bound.residual < bounds.RESIDUAL
        else:
            is_root = bounds.half_space_bound(label).residual < bounds.RESIDUAL
            arctan, atan2 = arctan + is_root, atan2 + is_root
    total = len(paper.TABLE_6)
    return formula(
        holds=arctan == total,
        amended=atan2 == total,
        computed=f"With arctan {arctan} of {total} bounds are roots of their components, with atan2"
        f" all {atan2}; those of the walls where eq. (36) lets them exist.",
    )


ROWS = {
    f"T-6.{row}": (i, j)
    for row, (i, j) in enumerate(map(paper.indices, paper.EQUATION_29), start=1)
}
"""The indices i and j of each row of Table 6."""


@computes_each({name: ij for name, ij in ROWS.items() if ij[0] < 5})
def window_of_a_pair(ij: tuple[int, int]) -> Outcome:
    upper, lower = map(bounds.pair_bound, bounds.labels_of(*ij))
    joint, box = closest_approach(robot(), pairs()[ij[0] - 1]).joint, by_windows().box
    as_printed, with_atan2 = (
        low <= box.lower[joint] + SMALL and box.upper[joint] - SMALL <= high
        for low, high in ((lower.plain, upper.plain), (lower.value, upper.value))
    )
    are_roots = max(upper.plain_residual, lower.plain_residual) < bounds.RESIDUAL
    text = f"From {degrees(lower.value)} to {degrees(upper.value)} with atan2, a full turn in which"
    text += (
        f" the region lies. At both ends the points are {upper.distance:.4f} cm apart; they come"
    )
    text += f" closest at {degrees(upper.contact)}"
    text += ", or a turn off." if upper.at_contact else ", in between, where no bound is."
    if not are_roots:
        text += (
            f" With arctan the ends are no roots: {degrees(lower.plain)}, {degrees(upper.plain)}."
        )
    return formula(
        holds=are_roots and bool(as_printed) and upper.at_contact and lower.at_contact,
        amended=bool(with_atan2) and max(upper.residual, lower.residual) < bounds.RESIDUAL,
        computed=text,
    )


@computes_each({name: ij for name, ij in ROWS.items() if ij[0] > 4})
def window_of_a_half_space(ij: tuple[int, int]) -> Outcome:
    upper, lower = map(bounds.half_space_bound, bounds.labels_of(*ij))
    form, box = bounds.component_of(bounds.labels_of(*ij)[0]), by_windows().box
    length = upper.q[:, 1] - lower.q[:, 1]
    q2 = lower.q[:, 1] + (np.arange(200)[:, None] + 0.5) / 200 * length
    q = np.stack([np.broadcast_to(upper.q[:, 0], q2.shape), q2], -1)
    negative = float((form(q) < 0).mean())
    # where the bounds exist, the region lies between them: tried on a grid
    q1, low, high = (x[::10, None] for x in (lower.q[:, 0], lower.q[:, 1], upper.q[:, 1]))
    q2 = np.linspace(box.lower[1], box.upper[1], 200)
    free = by_windows().contains(np.stack(np.broadcast_arrays(q1, q2), -1))
    between = bool(((low <= q2 + SMALL) & (q2 - SMALL <= high))[free].all())
    are_bounds = max(upper.residual, lower.residual) < bounds.RESIDUAL and between
    text = bounds.limit_of(bounds.labels_of(*ij)[0])
    text += f"It exists, by eq. (36), for {upper.part:.0f} % of a turn of q_1, over"
    ends = sorted({f"{x:.0f}°" for x in np.degrees([length.min(), length.max()])}, key=len)
    text += f" {' to '.join(ends)} of q_2, where the"
    text += f" region lies in it. The component is negative in {100 * negative:.0f} % of it."
    return formula(holds=are_bounds and not negative, amended=are_bounds, computed=text)


# --- "four tables" --------------------------------------------------------------------------------


@computes("S-17")
def four_tables() -> Outcome:
    tables = {o.table for o in paper.OFFSETS if o.table > 1 and "min" not in o.label}
    number = len(pairs())
    return of_readings(
        f"The offsets of the {number} pairs stand in {number} parts of {len(tables)} numbered"
        " tables, as the same section says two paragraphs on. The diagrams were not at hand.",
        reading("four tabulated functions, each with its offsets", holds=number == 4),
        reading("four tables with a number", holds=len(tables) == 4, corrected=number == 4),
    )
