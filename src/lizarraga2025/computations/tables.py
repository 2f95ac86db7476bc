"""Tables 1 to 6, each row: offsets, their units and digits, kinematics, windows."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np

from lizarraga2025 import closed_form
from lizarraga2025 import printed as paper
from lizarraga2025.computations.bounds import RESIDUAL, half_space_bound, pair_bound
from lizarraga2025.computations.registry import computes, computes_each
from lizarraga2025.evidence.arms import (
    corrected,
    half_spaces,
    in_millimetres,
    pairs,
    robot,
    symbolic_robot,
)
from lizarraga2025.evidence.joint_region import vertices
from lizarraga2025.evidence.rounding import HALF_DIGIT, contact, degrees, radii
from lizarraga2025.verdicts import Outcome, judge, undetermined
from qbound import circle_roots, components, pair_vector
from qbound.boundary.functions import closest_approach, position
from qbound.model.robot import Robot
from qbound.symbols import joint_symbols

# --- Table 1: offsets -----------------------------------------------------------------------------


@cache
def _tool_uses() -> dict[str, str]:
    """Return, for each offset of Table 1, its factors in the tool's coordinates."""
    import sympy as sp

    arm, _ = symbolic_robot()
    x, _, z = position(arm, "3").symbolic(joint_symbols(robot()))
    labels = [row[3] for row in paper.TABLE_1]
    factors = {
        label: [sp.expand(c).coeff(sp.Symbol(label, real=True)) for c in (x, z)] for label in labels
    }
    return {
        label: " and ".join(f"{sp.sstr(f)} in {c}" for f, c in zip(pair, "xz", strict=True) if f)
        for label, pair in factors.items()
    }


@computes("T-1")
def offsets() -> Outcome:
    import sympy as sp

    arm, _ = symbolic_robot()
    place = sp.Matrix(position(arm, "3").symbolic(joint_symbols(robot())))
    used = {str(s) for s in place.free_symbols} - {"q_1", "q_2"}
    cm = paper.offsets_in_cm()
    x, z = cm["x_{1,2}"], cm["z_{1,2}"]
    rounded = max(abs(x - 30 * 0.5), abs(z - 30 * np.sqrt(0.75)))
    return Outcome(
        judge(holds=used == {row[3] for row in paper.TABLE_1} and rounded <= HALF_DIGIT),
        f"The place of the tool depends on exactly these {len(used)} lengths. Link 1 measures"
        f" {np.hypot(x, z):.4f} cm at {np.degrees(np.arctan2(z, x)):.4f}°, thirty centimetres at"
        f" sixty degrees to within {rounded:.4f} cm, less than the rounding of two decimals.",
    )


@computes_each({f"T-1.{number}": row[3] for number, row in enumerate(paper.TABLE_1, start=1)})
def offset(label: str) -> Outcome:
    _, values = symbolic_robot()
    in_file = {str(symbol): value for symbol, value in values.items()}
    return Outcome(
        judge(holds=in_file[label] == paper.offsets_in_cm()[label] and bool(_tool_uses()[label])),
        f"{in_file[label]} cm in the robot file; the tool's place has it with the factor"
        f" {_tool_uses()[label].replace('*', ' ')}.",
    )


# --- Table 2: forward kinematics ------------------------------------------------------------------


@cache
def _printed_kinematics(turn: int = 1) -> dict[tuple[str, str], tuple[Any, Any]]:
    """Return the rows of Table 2, worked out; the sense of R_y can be turned round."""
    import sympy as sp

    z01, z12, x12, x23 = (sp.Symbol(label, real=True) for *_, label in paper.TABLE_1)
    # R_y(q) carries z towards x; SymPy's rot_axis2 turns the other way.
    R1, R2 = (sp.rot_axis2(-turn * q) for q in joint_symbols(robot()))
    r01, r12, r23 = sp.Matrix([0, 0, z01]), sp.Matrix([x12, 0, z12]), sp.Matrix([x23, 0, 0])
    r02 = r01 + R1 * r12
    return {
        ("0", "0"): (sp.zeros(3, 1), sp.eye(3)),
        ("0", "1"): (r01, R1),
        ("1", "2"): (r12, R2),
        ("2", "3"): (r23, sp.eye(3)),
        ("0", "2"): (r02, R1 * R2),
        ("0", "3"): (r02 + R1 * R2 * r23, R1 * R2),
    }


@cache
def _agrees(a: str, b: str, turn: int = 1) -> bool:
    import sympy as sp

    arm, _ = symbolic_robot()
    frames = arm.frames(np.array(joint_symbols(robot())))
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
    vector, _ = _printed_kinematics()[frames]
    symbols = {symbol for component in vector for symbol in component.free_symbols}
    return Outcome(
        judge(holds=_agrees(*frames)),
        f"Vector (of {len(symbols)} symbols) and rotation equal the derived ones; the differences"
        " simplify to zero.",
    )


# --- Tables 3 and 4: point pairs ------------------------------------------------------------------


@computes_each({"T-3.1": 1, "T-3.2": 2, "T-3.3": 3, "T-4.2": 4})
def offsets_of_a_pair(number: int) -> Outcome:
    pair = pairs()[number - 1]
    first, second = radii(robot(), pair)
    with_9_09 = closest_approach(corrected(), pairs(corrected())[number - 1])[1]
    gap, limit = abs(first - second), contact(pair)
    slip = f" With x_{{2,13}} = 9.09, as x_{{2,11}}, it is {with_9_09:.4f} cm."
    return Outcome(
        judge(holds=gap <= limit, corrected=with_9_09 <= limit),
        f"The points are {first:.4f} and {second:.4f} cm from the joint between them. The"
        f" difference of {gap:.4f} cm compares with {limit:.4f} cm that rounding to two decimals"
        f" can cause.{slip if number == 4 else ''}",
    )


@computes_each({"T-3.4": 1, "T-3.5": 2, "T-3.6": 3, "T-4.3": 4, "T-5.4": 5, "T-5.5": 6, "T-5.6": 7})
def vector_of_a_boundary(number: int) -> Outcome:
    import sympy as sp

    arm, _ = symbolic_robot()
    derived = components(arm, arm.boundary(f"B{number}")).symbolic(joint_symbols(robot()))
    printed = [
        paper.expression(paper.EQUATION_29.get(f"beta_{{{number},{j}}}", "0")) for j in (1, 2, 3)
    ]
    left = [sp.expand(d - p) for d, p in zip(derived, printed, strict=True)]
    zero = sum(d == 0 for d in derived)
    return Outcome(
        judge(holds=not any(left)),
        f"All {len(left)} components equal those derived from the chain; {zero} of them"
        f" {'is' if zero == 1 else 'are'} identically zero.",
    )


@computes("T-3")
def table_3() -> Outcome:
    rows = [row(n) for row in (offsets_of_a_pair, vector_of_a_boundary) for n in (1, 2, 3)]
    right = sum(row.verdict == "confirmed" for row in rows)
    return Outcome(
        judge(holds=right == len(rows)),
        f"{right} of {len(rows)} rows are confirmed: three pairs of points whose radii agree to the"
        " printed digits, and three vectors that follow from the chain.",
    )


def _roots_of_b4(of: Robot) -> int:
    """Count the roots of the two components of B_4."""
    count = 0
    for component in (0, 2):
        c0, a, b = pair_vector(of, pairs(of)[3])[component].along(1, of.home)
        count += int(circle_roots(a, b, -c0).count)
    return count


@computes("T-4")
def table_4() -> Outcome:
    rows = (unit_of_table_4(), offsets_of_a_pair(4), vector_of_a_boundary(4))
    slips = sum(row.verdict == "misprint" for row in rows)
    return Outcome(
        judge(holds=not slips, corrected=rows[2].verdict == "confirmed"),
        f"{slips} slips in {len(rows)} rows: the unit (T-4.1) and one digit (T-4.2). The vector"
        " itself follows from the chain (T-4.3).",
    )


@computes("T-4.1")
def unit_of_table_4() -> Outcome:
    in_mm, in_cm = _roots_of_b4(in_millimetres()), _roots_of_b4(robot())
    far, near = radii(in_millimetres(), pairs(in_millimetres())[3])
    return Outcome(
        judge(holds=in_mm > 0, corrected=in_cm == 4),
        f"In mm the points are {far:.2f} and {near:.2f} cm from joint 2, and the two components of"
        f" B_4 have {in_mm} roots: the bounds of Table 6 and the β_{{4,1,2}} of Figure 4 would not"
        f" exist. In cm they have {in_cm}.",
    )


# --- Table 5: half-spaces -------------------------------------------------------------------------


def _six_points(of: Robot) -> int:
    """Count the points of Figure 5 that exist; none where the rule names no polygon."""
    try:
        return len(closed_form.vertices(of))
    except ValueError:
        return 0


def _with_floor(height: float) -> Robot:
    floor = replace(half_spaces()[-1], offset=height)
    return replace(robot(), boundaries=(*robot().boundaries[:-1], floor))


@computes("T-5")
def table_5() -> Outcome:
    rows = [unit_of_the_floor(), unit_of_the_side_limits(), selection()]
    rows += [vector_of_a_boundary(number) for number in (5, 6, 7)]
    counts = {
        verdict: sum(row.verdict == verdict for row in rows)
        for verdict in ("confirmed", "misprint", "not determined by the text")
    }
    return Outcome(
        judge(holds=counts["confirmed"] == len(rows), corrected=counts["misprint"] > 0),
        f"Of {len(rows)} rows " + ", ".join(f"{n} {v}" for v, n in counts.items()) + ".",
    )


@computes("T-5.1")
def unit_of_the_floor() -> Outcome:
    height = {unit: paper.offsets_in_cm(mm_means=unit)["z_{min,1}"] for unit in ("mm", "cm")}
    points = {unit: _six_points(_with_floor(h)) for unit, h in height.items()}
    return Outcome(
        judge(holds=points["mm"] == 6, corrected=points["cm"] == 6),
        f"At {height['cm']} cm the six bounds that Figure 4 names meet in {points['cm']} points; at"
        f" {height['mm']:.3f} cm the curve of the floor turns back before it reaches the upper side"
        f" of the box, and {points['mm'] or 'no'} such points exist.",
    )


@computes("T-5.2")
def unit_of_the_side_limits() -> Outcome:
    fits, seen = {}, []
    for unit in ("mm", "cm"):
        cm = paper.offsets_in_cm(mm_means=unit)
        offsets = (cm["x_{min,1}"], cm["x_{min,2}"])
        sides = (replace(w, offset=x) for w, x in zip(half_spaces(), offsets, strict=False))
        moved = replace(robot(), boundaries=(*pairs(), *sides, half_spaces()[-1]))
        corners = np.array([vertex.q for vertex in closed_form.vertices(moved)])
        fits[unit] = bool(np.allclose(corners, vertices()))
        seen.append(f"x = ±{cm['x_{min,1}']:g} cm")
    base = abs(float(robot().point("6").at[0]))
    return Outcome(
        undetermined(fits),
        f"With {' and with '.join(seen)} the six points are the same, for neither wall bounds the"
        f" region. For cm speaks the base, whose corners stand at ±{base} cm, and the unit of all"
        " other lengths.",
    )


@computes("T-5.3")
def selection() -> Outcome:
    S_x, S_z = np.diag([1, 0, 0]), np.diag([0, 0, 1])
    projections = all(
        np.array_equal(S @ S, S) and np.array_equal(S, np.outer(n, n))
        for S, n in ((S_x, [1, 0, 0]), (S_z, [0, 0, 1]))
    )
    of_file = all(
        np.array_equal(np.outer(w.normal, w.normal), S)
        for w, S in zip(half_spaces(), (S_x, S_x, S_z), strict=True)
    )
    return Outcome(
        judge(holds=projections and of_file),
        "Both are projections, S S = S, the product n n^T of the wall's normal with itself; so are"
        f" those of the {len(half_spaces())} walls of the robot file.",
    )


# --- Table 6: windows -----------------------------------------------------------------------------


@computes("T-6")
def table_6() -> Outcome:
    points = [label for label in paper.TABLE_6 if paper.indices(label)[0] < 5]
    found = [pair_bound(label) for label in points]
    rest = [half_space_bound(label) for label in paper.TABLE_6 if label not in points]
    arctan = sum(bound.plain_residual < RESIDUAL for bound in found)
    atan2 = sum(bound.residual < RESIDUAL for bound in found)
    of_half_spaces = sum(bound.residual < RESIDUAL for bound in rest)
    total = len(paper.TABLE_6)
    return Outcome(
        judge(holds=arctan + of_half_spaces == total, under=atan2 + of_half_spaces == total),
        f"As printed, with arctan, {arctan + of_half_spaces} of {total} bounds are roots of their"
        f" components; with atan2 all {atan2 + of_half_spaces}, those of the walls where they"
        " exist.",
    )


ROWS = {f"T-6.{row}": paper.indices(name) for row, name in enumerate(paper.EQUATION_29, start=1)}
"""The indices i and j of each row of Table 6."""


@computes_each({name: ij for name, ij in ROWS.items() if ij[0] < 5})
def window_of_a_pair(ij: tuple[int, ...]) -> Outcome:
    upper, lower = (pair_bound(f"beta_{{{ij[0]},{ij[1]},{k}}}") for k in (1, 2))
    turn = float(np.degrees(upper.value - lower.value))
    inside = [] if upper.at_contact else _copies_inside(upper.contact, lower.value, upper.value)
    home = lower.value < 0 < upper.value
    plain = lower.plain < 0 < upper.plain and upper.plain_residual < RESIDUAL
    text = f"From {degrees(lower.value)} to {degrees(upper.value)}, {turn:.0f}°: one root twice."
    if inside:
        text += f" The points meet inside it, at {degrees(inside[0])}, so the window lets the"
        text += f" pair collide, and its ends are no contact ({upper.distance:.2f} cm apart)."
    else:
        text += " It holds home and runs from contact to contact."
    if not plain:
        text += f" With arctan it is {degrees(lower.plain)} to {degrees(upper.plain)}, no roots."
    if ij == (3, 3):
        shifted = [degrees(bound.plain + np.pi) for bound in (lower, upper)]
        text += f" With arctan + π where a < 0 it is {shifted[0]} to {shifted[1]}, without home."
    good = home and not inside
    met = upper.distance <= upper.allowed
    return Outcome(judge(holds=good and plain and met, under=good), text)


def _copies_inside(q: float, low: float, high: float) -> list[float]:
    """Return the copies of an angle, modulo full turns, that lie inside an interval."""
    copies = q + 2 * np.pi * np.arange(-3, 4)
    return [float(x) for x in copies if low < x < high]


@computes_each({name: ij for name, ij in ROWS.items() if ij[0] > 4})
def window_of_a_half_space(ij: tuple[int, ...]) -> Outcome:
    i, j = ij
    upper, lower = (half_space_bound(f"beta_{{{i},{j},{k}}}") for k in (1, 2))
    form = components(robot(), robot().boundary(f"B{i}"))[j - 1]
    s = (np.arange(200) + 0.5)[:, None] / 200
    q2 = lower.q[:, 1] + s * (upper.q[:, 1] - lower.q[:, 1])
    values = form(np.stack([np.broadcast_to(upper.q[:, 0], q2.shape), q2], -1))
    wrong = 100 * float((values < 0).mean())
    length = np.degrees(upper.q[:, 1] - lower.q[:, 1])
    return Outcome(
        judge(holds=not wrong and upper.part == 100, under=not wrong),
        f"Where it exists, {upper.part:.1f} % of a turn of q_1, it is {length.min():.0f}° to"
        f" {length.max():.0f}° long, and the component is negative in {wrong:.1f} % of it.",
    )
