"""Tables 1 to 6, each row: offsets, their units and digits, kinematics, windows."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np

from lizarraga2025 import printed as paper
from lizarraga2025.ledger.bounds import pair_bound, wall_bound
from lizarraga2025.ledger.entries import Finding, entry, judge, undetermined
from lizarraga2025.ledger.facts import degrees, lettered, mended, pairs, robot, vertices, walls
from lizarraga2025.ledger.rounding import HALF_DIGIT, contact, radii
from qbound import circle_roots, components, pair_vector
from qbound.boundary.functions import closest_approach, position
from qbound.model.robot import Robot, joint_symbols
from qbound.region import paper_rule

IN_FILE = "test_robotfile.py::test_the_packaged_robot_has_the_printed_offsets"
KINEMATICS = "test_robot.py::test_direct_kinematics_are_table_2"
COMPONENTS = "test_boundary.py::test_derived_component_is_the_printed_formula_by_identity"


# --- Table 1: offsets -----------------------------------------------------------------------------


@cache
def _tool_uses() -> dict[str, str]:
    """Return, for each offset of Table 1, its factors in the tool's coordinates."""
    import sympy as sp

    symbolic, _ = lettered()
    x, _, z = position(symbolic, "3").symbolic(joint_symbols(robot()))
    labels = [row[3] for row in paper.TABLE_1]
    factors = {
        label: [sp.expand(c).coeff(sp.Symbol(label, real=True)) for c in (x, z)] for label in labels
    }
    return {
        label: " and ".join(f"{sp.sstr(f)} in {c}" for f, c in zip(pair, "xz", strict=True) if f)
        for label, pair in factors.items()
    }


@entry(
    "T-1",
    "table",
    "Table 1",
    "Four offsets, in cm, lead from the base to the tool.",
    test=IN_FILE,
    chapter="04_planar_robot#tab-1",
)
def offsets() -> Finding:
    import sympy as sp

    symbolic, _ = lettered()
    place = sp.Matrix(position(symbolic, "3").symbolic(joint_symbols(robot())))
    used = {str(s) for s in place.free_symbols} - {"q_1", "q_2"}
    cm = paper.offsets_in_cm()
    x, z = cm["x_{1,2}"], cm["z_{1,2}"]
    rounded = max(abs(x - 30 * 0.5), abs(z - 30 * np.sqrt(0.75)))
    return Finding(
        judge(holds=used == {row[3] for row in paper.TABLE_1} and rounded <= HALF_DIGIT),
        f"The place of the tool depends on exactly these {len(used)} lengths. Link 1 measures"
        f" {np.hypot(x, z):.4f} cm at {np.degrees(np.arctan2(z, x)):.4f}°, thirty centimetres at"
        f" sixty degrees to within {rounded:.4f} cm, less than the rounding of two decimals.",
    )


def _offset(label: str) -> Callable[[], Finding]:
    def offset() -> Finding:
        _, values = lettered()
        in_file = {str(symbol): value for symbol, value in values.items()}
        printed = paper.offsets_in_cm()[label]
        return Finding(
            judge(holds=in_file[label] == printed and bool(_tool_uses()[label])),
            f"{in_file[label]} cm in the robot file; the tool's place has it with the factor"
            f" {_tool_uses()[label].replace('*', ' ')}.",
        )

    return offset


for _number, (_a, _b, _what, _label) in enumerate(paper.TABLE_1, start=1):
    entry(
        f"T-1.{_number}",
        "table",
        f"Table 1, row {_number}",
        f"{_what}: one component of the vector from frame {_a} to frame {_b}.",
        test=IN_FILE,
        chapter="04_planar_robot#tab-1",
    )(_offset(_label))


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

    symbolic, _ = lettered()
    frames = symbolic.frames(np.array(joint_symbols(robot())))
    vector, matrix = _printed_kinematics(turn)[a, b]
    position_left = sp.simplify(sp.Matrix(frames.position(a, b, a)) - vector)
    rotation_left = sp.simplify(sp.Matrix(frames.rotation(a, b)) - matrix)
    return bool(position_left == sp.zeros(3, 1) and rotation_left == sp.zeros(3, 3))


@entry(
    "T-2",
    "table",
    "Table 2",
    "The position and orientation of each frame follow recursively.",
    test=KINEMATICS,
    chapter="04_planar_robot#tab-2",
)
def kinematics() -> Finding:
    rows = [_agrees(*row) for row in _printed_kinematics()]
    other = sum(_agrees(*row, turn=-1) for row in _printed_kinematics())
    return Finding(
        judge(holds=all(rows)),
        f"{sum(rows)} of {len(rows)} rows agree by identity with the frames derived from the file,"
        " if R_y(q) carries z towards x, as eq. (29) has it; with the other sense"
        f" {other} would.",
    )


def _kinematics_row(a: str, b: str) -> Callable[[], Finding]:
    def row() -> Finding:
        vector, _ = _printed_kinematics()[a, b]
        terms = len(set().union(*(x.free_symbols for x in vector))) if vector.free_symbols else 0
        return Finding(
            judge(holds=_agrees(a, b)),
            f"Vector (of {terms} symbols) and rotation equal the derived ones; the differences"
            " simplify to zero.",
        )

    return row


for _number, (_a, _b, *_) in enumerate(paper.TABLE_2, start=1):
    entry(
        f"T-2.{_number}",
        "table",
        f"Table 2, row {_number}",
        f"Position and orientation of frame {_b} seen from frame {_a}.",
        test=KINEMATICS,
        chapter="04_planar_robot#table-2-row-by-row",
    )(_kinematics_row(_a, _b))


# --- Tables 3 and 4: point pairs ------------------------------------------------------------------


def _pair_offsets(number: int) -> Callable[[], Finding]:
    def offsets_of_a_pair() -> Finding:
        pair = pairs()[number - 1]
        first, second = radii(robot(), pair)
        with_9_09 = closest_approach(mended(), pairs(mended())[number - 1])[1]
        gap, limit = abs(first - second), contact(pair)
        slip = (
            f" With x_{{2,13}} = 9.09, as x_{{2,11}}, it is {with_9_09:.4f} cm."
            if number == 4
            else ""
        )
        return Finding(
            judge(holds=gap <= limit, mended=with_9_09 <= limit),
            f"The points are {first:.4f} and {second:.4f} cm from the joint between them. The"
            f" difference of {gap:.4f} cm compares with {limit:.4f} cm that rounding to two"
            f" decimals can cause.{slip}",
        )

    return offsets_of_a_pair


def _vector_of(name: str) -> Callable[[], Finding]:
    def vector() -> Finding:
        import sympy as sp

        symbolic, _ = lettered()
        derived = components(symbolic, symbolic.boundary(name)).symbolic(joint_symbols(robot()))
        printed = [
            paper.expression(paper.EQUATION_29.get(f"beta_{{{name[1:]},{j}}}", "0"))
            for j in (1, 2, 3)
        ]
        left = [sp.expand(d - p) for d, p in zip(derived, printed, strict=True)]
        zero = sum(d == 0 for d in derived)
        return Finding(
            judge(holds=not any(left)),
            f"All {len(left)} components equal those derived from the chain; {zero} of them"
            f" {'is' if zero == 1 else 'are'} identically zero.",
        )

    return vector


def _table_3() -> Finding:
    rows = [_pair_offsets(n)() for n in (1, 2, 3)] + [_vector_of(f"B{n}")() for n in (1, 2, 3)]
    right = sum(row.verdict == "confirmed" for row in rows)
    return Finding(
        judge(holds=right == len(rows)),
        f"{right} of {len(rows)} rows are confirmed: three pairs of points whose radii agree to the"
        " printed digits, and three vectors that follow from the chain.",
    )


entry(
    "T-3",
    "table",
    "Table 3",
    "Offsets in cm and vectors of the point boundary functions 1, 2 and 3.",
    test=COMPONENTS,
    chapter="05_boundary_functions#tab-3",
)(_table_3)

for _n in (1, 2, 3):
    entry(
        f"T-3.{_n}",
        "table",
        f"Table 3, offsets of B_{_n}",
        f"Offsets of the points {' and '.join(pairs()[_n - 1].points)}, which can meet.",
        test="test_boundary.py::test_points_of_the_siblings_come_as_close_as_their_digits",
        chapter="05_boundary_functions#where-the-points-come-closest",
    )(_pair_offsets(_n))

for _n in (1, 2, 3):
    entry(
        f"T-3.{_n + 3}",
        "table",
        f"Table 3, B_{_n}",
        f"The vector B_{_n} and its components.",
        test=COMPONENTS,
        chapter="05_boundary_functions#tab-3",
    )(_vector_of(f"B{_n}"))


def _roots_of_b4(of: Robot) -> int:
    """Count the roots of the two components of B_4."""
    count = 0
    for component in (0, 2):
        c0, a, b = pair_vector(of, pairs(of)[3])[component].along(1, of.home)
        count += int(circle_roots(a, b, -c0).count)
    return count


@cache
def _in_millimetres() -> Robot:
    """Return the robot with points 12 and 13 in millimetres, as Table 4 prints them."""
    points = (replace(p, at=p.at / 10) if p.name in ("12", "13") else p for p in robot().points)
    return replace(robot(), points=tuple(points))


@entry(
    "T-4",
    "table",
    "Table 4",
    "Offsets in mm and the vector of the point boundary function 4.",
    test="test_paper_rule.py::test_table_4_read_in_millimetres_leaves_beta_4_without_a_root",
    chapter="05_boundary_functions#tab-4",
    mended="cm for mm, and x_{2,13} = 9.09 for 9.00.",
)
def table_4() -> Finding:
    rows = (unit_of_table_4(), _pair_offsets(4)(), _vector_of("B4")())
    slips = sum(row.verdict == "misprint" for row in rows)
    return Finding(
        judge(holds=not slips, mended=rows[2].verdict == "confirmed"),
        f"{slips} slips in {len(rows)} rows: the unit (T-4.1) and one digit (T-4.2). The vector"
        " itself follows from the chain (T-4.3).",
    )


@entry(
    "T-4.1",
    "table",
    "Table 4, unit",
    "The offsets of points 12 and 13 are in mm.",
    test="test_paper_rule.py::test_table_4_read_in_millimetres_leaves_beta_4_without_a_root",
    chapter="05_boundary_functions#millimetres-or-centimetres",
    mended="cm.",
)
def unit_of_table_4() -> Finding:
    in_mm, in_cm = _roots_of_b4(_in_millimetres()), _roots_of_b4(robot())
    far, near = radii(_in_millimetres(), pairs(_in_millimetres())[3])
    return Finding(
        judge(holds=in_mm > 0, mended=in_cm == 4),
        f"In mm the points are {far:.2f} and {near:.2f} cm from joint 2, and the two components of"
        f" B_4 have {in_mm} roots: the bounds of Table 6 and the β_{{4,1,2}} of Figure 4 would not"
        f" exist. In cm they have {in_cm}.",
    )


entry(
    "T-4.2",
    "table",
    "Table 4, offsets of B_4",
    "Offsets of the points 12 and 13, which can meet; x_{2,13} = 9.00.",
    test="test_boundary.py::test_points_of_the_siblings_come_as_close_as_their_digits",
    chapter="05_boundary_functions#one-digit",
    mended="x_{2,13} = 9.09, the number of the opposite corner, x_{2,11}.",
)(_pair_offsets(4))
entry(
    "T-4.3",
    "table",
    "Table 4, B_4",
    "The vector B_4 and its components.",
    test=COMPONENTS,
    chapter="05_boundary_functions#tab-4",
)(_vector_of("B4"))


# --- Table 5: walls -------------------------------------------------------------------------------


def _six_points(of: Robot) -> int:
    """Count the points of Figure 5 that exist; none where the rule names no polygon."""
    try:
        return len(paper_rule.vertices(of))
    except ValueError:
        return 0


def _with_floor(height: float) -> Robot:
    floor = replace(walls()[-1], offset=height)
    return replace(robot(), boundaries=(*robot().boundaries[:-1], floor))


@entry(
    "T-5",
    "table",
    "Table 5",
    "Offsets in mm, selection matrices and vectors of the geometric functions 5, 6 and 7.",
    test="test_paper_rule.py::test_floor_read_in_millimetres_leaves_no_six_vertices",
    chapter="05_boundary_functions#tab-5",
    mended="cm for mm.",
)
def table_5() -> Finding:
    rows = {
        "T-5.1": unit_of_the_floor(),
        "T-5.2": unit_of_the_side_walls(),
        "T-5.3": selection(),
        **{f"T-5.{n - 1}": _vector_of(f"B{n}")() for n in (5, 6, 7)},
    }
    counts = {
        verdict: sum(row.verdict == verdict for row in rows.values())
        for verdict in ("confirmed", "misprint", "not determined by the paper")
    }
    return Finding(
        judge(holds=counts["confirmed"] == len(rows), mended=counts["misprint"] > 0),
        f"Of {len(rows)} rows " + ", ".join(f"{n} {v}" for v, n in counts.items()) + ".",
    )


@entry(
    "T-5.1",
    "table",
    "Table 5, z_{min,1}",
    "The floor is at 11.32 mm.",
    test="test_paper_rule.py::test_floor_read_in_millimetres_leaves_no_six_vertices",
    chapter="05_boundary_functions#millimetres-or-centimetres",
    mended="11.32 cm.",
)
def unit_of_the_floor() -> Finding:
    height = {unit: paper.offsets_in_cm(mm_means=unit)["z_{min,1}"] for unit in ("mm", "cm")}
    points = {unit: _six_points(_with_floor(h)) for unit, h in height.items()}
    return Finding(
        judge(holds=points["mm"] == 6, mended=points["cm"] == 6),
        f"At {height['cm']} cm the six bounds that Figure 4 names meet in {points['cm']} points; at"
        f" {height['mm']:.3f} cm the curve of the floor turns back before it reaches the upper side"
        f" of the box, and {points['mm'] or 'no'} such points exist.",
    )


@entry(
    "T-5.2",
    "table",
    "Table 5, x_{min,1} and x_{min,2}",
    "The side walls are at 15 mm and -15 mm.",
    test="test_paper_rule.py::test_unused_boundaries_do_not_bound",
    chapter="05_boundary_functions#millimetres-or-centimetres",
)
def unit_of_the_side_walls() -> Finding:
    fits, seen = {}, []
    for unit in ("mm", "cm"):
        cm = paper.offsets_in_cm(mm_means=unit)
        offsets = (cm["x_{min,1}"], cm["x_{min,2}"])
        sides = (replace(w, offset=x) for w, x in zip(walls(), offsets, strict=False))
        moved = replace(robot(), boundaries=(*pairs(), *sides, walls()[-1]))
        corners = np.array([vertex.q for vertex in paper_rule.vertices(moved)])
        fits[unit] = bool(np.allclose(corners, vertices()))
        seen.append(f"x = ±{cm['x_{min,1}']:g} cm")
    base = abs(float(robot().point("6").at[0]))
    return Finding(
        undetermined(fits),
        f"With {' and with '.join(seen)} the six points are the same, for neither wall bounds the"
        f" region. For cm speaks the base, whose corners stand at ±{base} cm, and the unit of all"
        " other lengths.",
    )


@entry(
    "T-5.3",
    "table",
    "Table 5, S_x and S_z",
    "Two matrices select the x and the z coordinate.",
    test="test_boundary.py::test_selection_by_a_normal_is_n_n_transposed",
    chapter="05_boundary_functions#the-tables",
)
def selection() -> Finding:
    S_x, S_z = np.diag([1, 0, 0]), np.diag([0, 0, 1])
    projections = all(
        np.array_equal(S @ S, S) and np.array_equal(S, np.outer(n, n))
        for S, n in ((S_x, [1, 0, 0]), (S_z, [0, 0, 1]))
    )
    of_file = all(
        np.array_equal(np.outer(w.normal, w.normal), S)
        for w, S in zip(walls(), (S_x, S_x, S_z), strict=True)
    )
    return Finding(
        judge(holds=projections and of_file),
        "Both are projections, S S = S, the product n n^T of the wall's normal with itself; so are"
        f" those of the {len(walls())} walls of the robot file.",
    )


for _n in (5, 6, 7):
    entry(
        f"T-5.{_n - 1}",
        "table",
        f"Table 5, B_{_n}",
        f"The vector B_{_n}: the selected coordinate of the tool minus its limit.",
        test=COMPONENTS,
        chapter="05_boundary_functions#tab-5",
    )(_vector_of(f"B{_n}"))


# --- Table 6: windows -----------------------------------------------------------------------------


@entry(
    "T-6",
    "table",
    "Table 6",
    "22 bounds: an upper and a lower one for each of the eleven components, at its roots.",
    test="test_paper_rule.py::test_all_22_bounds_are_computed",
    chapter="06_theorem_2#tab-6",
    mended="Read arctan(b / a) as atan2(b, a); for the rows see T-6.1 to T-6.11.",
)
def table_6() -> Finding:
    points = [label for label in paper.TABLE_6 if int(label[6]) < 5]
    found = [pair_bound(label) for label in points]
    rest = [wall_bound(label) for label in paper.TABLE_6 if label not in points]
    arctan = sum(bound.plain_residual < 1e-9 for bound in found)
    atan2 = sum(bound.residual < 1e-9 for bound in found)
    wall = sum(bound.residual < 1e-9 for bound in rest)
    total = len(paper.TABLE_6)
    return Finding(
        judge(holds=arctan + wall == total, under=atan2 + wall == total),
        f"As printed, with arctan, {arctan + wall} of {total} bounds are roots of their components;"
        f" with atan2 all {atan2 + wall}, those of the walls where they exist.",
    )


def _window_of_a_pair(i: int, j: int) -> Callable[[], Finding]:
    def window() -> Finding:
        upper, lower = (pair_bound(f"beta_{{{i},{j},{k}}}") for k in (1, 2))
        turn = float(np.degrees(upper.value - lower.value))
        inside = [] if upper.at_contact else _copies_inside(upper.contact, lower.value, upper.value)
        home = lower.value < 0 < upper.value
        plain = lower.plain < 0 < upper.plain and upper.plain_residual < 1e-9
        text = (
            f"From {degrees(lower.value)} to {degrees(upper.value)}, {turn:.0f}°: one root twice."
        )
        if inside:
            text += f" The points meet inside it, at {degrees(inside[0])}, so the window lets the"
            text += f" pair collide, and its ends are no contact ({upper.distance:.2f} cm apart)."
        else:
            text += " It holds home and runs from contact to contact."
        if not plain:
            text += (
                f" With arctan it is {degrees(lower.plain)} to {degrees(upper.plain)}, no roots."
            )
        if (i, j) == (3, 3):
            shifted = [degrees(bound.plain + np.pi) for bound in (lower, upper)]
            text += (
                f" With arctan + π where a < 0 it is {shifted[0]} to {shifted[1]}, without home."
            )
        good = home and not inside
        met = upper.distance <= upper.allowed
        return Finding(judge(holds=good and plain and met, under=good), text)

    return window


def _copies_inside(q: float, low: float, high: float) -> list[float]:
    """Return the copies of an angle, modulo full turns, that lie inside an interval."""
    copies = q + 2 * np.pi * np.arange(-3, 4)
    return [float(x) for x in copies if low < x < high]


def _window_of_a_wall(i: int, j: int) -> Callable[[], Finding]:
    def window() -> Finding:
        upper, lower = (wall_bound(f"beta_{{{i},{j},{k}}}") for k in (1, 2))
        form = components(robot(), robot().boundary(f"B{i}"))[j - 1]
        s = (np.arange(200) + 0.5)[:, None] / 200
        q2 = lower.q[:, 1] + s * (upper.q[:, 1] - lower.q[:, 1])
        values = form(np.stack([np.broadcast_to(upper.q[:, 0], q2.shape), q2], -1))
        wrong = 100 * float((values < 0).mean())
        length = np.degrees(upper.q[:, 1] - lower.q[:, 1])
        return Finding(
            judge(holds=not wrong and upper.part == 100, under=not wrong),
            f"Where it exists, {upper.part:.1f} % of a turn of q_1, it is {length.min():.0f}° to"
            f" {length.max():.0f}° long, and the component is negative in {wrong:.1f} % of it.",
        )

    return window


for _row, _name in enumerate(paper.EQUATION_29, start=1):
    _i, _j = int(_name[6]), int(_name[8])
    entry(
        f"T-6.{_row}",
        "table",
        f"Table 6, row {_row}",
        f"q_{1 if _i < 3 else 2} is feasible between β_{{{_i},{_j},2}} and β_{{{_i},{_j},1}}.",
        test="test_paper_rule.py::test_every_window_is_one_turn_that_holds_home"
        if _i < 5
        else "test_paper_rule.py::test_rows_5_and_6_of_table_6_lack_a_root",
        chapter="06_theorem_2#one-pose-two-names" if _i < 5 else "06_theorem_2#the-walls",
        mended="+ arccos in place of - arccos in the bounds that take the wrong root."
        if _row in (4, 8, 9, 10)
        else "",
    )((_window_of_a_pair if _i < 5 else _window_of_a_wall)(_i, _j))
