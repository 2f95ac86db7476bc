"""Tables 1 to 6, each row: offsets, their units and digits, kinematics, windows."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from functools import cache
from itertools import product
from math import prod
from typing import Any, Final

import numpy as np
import sympy as sp

from lizarraga2025 import printed as paper
from lizarraga2025.computations.bounds import (
    RESIDUAL,
    HalfSpaceBound,
    PairBound,
    half_space_bound,
    limit_of,
    pair_bound,
)
from lizarraga2025.computations.registry import computes, computes_each
from lizarraga2025.evidence.arms import (
    corrected,
    half_spaces,
    in_millimetres,
    pairs,
    robot,
    symbolic_robot,
)
from lizarraga2025.evidence.joint_region import by_windows, vertices
from lizarraga2025.evidence.rounding import (
    SMALL,
    contact,
    degrees,
    other_slips,
    radii,
)
from lizarraga2025.verdicts import (
    VERDICTS,
    Outcome,
    Verdict,
    judge,
    undetermined,
)
from qbound import Robot, closest_approach, components, pair_vector, position, window_region
from qbound.circle import TURN, circle_roots
from qbound.symbols import joint_symbols

# --- Table 1: offsets -----------------------------------------------------------------------------


@cache
def _tool_uses() -> dict[str, str]:
    """Return, for each offset of Table 1, its factors in the tool's coordinates."""
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
    arm, _ = symbolic_robot()
    place = sp.Matrix(position(arm, "3").symbolic(joint_symbols(robot())))
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
    return Outcome(judge(holds=_is_in_the_file(label)), _in_the_file(label))


def _is_in_the_file(label: str) -> bool:
    """Tell whether the robot file has a printed offset, and the tool's place depends on it."""
    in_file = {str(symbol): value for symbol, value in symbolic_robot()[1].items()}
    return in_file[label] == paper.offsets_in_cm()[label] and bool(_tool_uses()[label])


def _in_the_file(label: str) -> str:
    in_file = {str(symbol): value for symbol, value in symbolic_robot()[1].items()}
    factor = _tool_uses()[label].replace("*", " ")
    return f"{in_file[label]} cm in the robot file; its factor in the tool's place is {factor}."


@computes("T-1.4")
def offset_of_the_tool() -> Outcome:
    _, _, words, label = paper.TABLE_1[3]
    named = [int(number) for number in re.findall(r"joint (\d)", words)]
    number = len(robot().joints)
    exist = max(named) <= number
    return Outcome(
        judge(holds=exist and _is_in_the_file(label), corrected=_is_in_the_file(label)),
        f"The row names joint {max(named)}; the robot has {number} joints, q_1 and q_2, and frame 3"
        f" is that of the end effector, which Table 2 turns by no joint. {_in_the_file(label)}",
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
    equal = _agrees(*frames)
    return Outcome(
        judge(holds=equal),
        f"Vector (of {len(symbols)} symbols) and rotation {'equal' if equal else 'are not'} those"
        " derived from the chain, by identity.",
    )


# --- Tables 3 and 4: point pairs ------------------------------------------------------------------


@computes_each({"T-3.1": 1, "T-3.2": 2, "T-3.3": 3, "T-4.2": 4})
def offsets_of_a_pair(number: int) -> Outcome:
    """Judge whether the two points of a pair are equally far from the joint between them."""
    pair = pairs()[number - 1]
    first, second = radii(robot(), pair)
    with_9_09 = closest_approach(corrected(), pairs(corrected())[number - 1]).gap
    gap, limit = abs(first - second), contact(pair)
    slip = f" With x_{{2,13}} = 9.09, as x_{{2,11}}, it is {with_9_09:.4f} cm. {other_slips()}"
    slip += " All hangs on one digit of a converted text: where the page has 9.09, nothing is off."
    return Outcome(
        judge(holds=gap <= limit, corrected=with_9_09 <= limit),
        f"The points are {first:.4f} and {second:.4f} cm from the joint between them. The"
        f" difference of {gap:.4f} cm compares with {limit:.4f} cm that rounding to two decimals"
        f" can cause.{slip if gap > limit else ''}",
    )


@computes_each({"T-3.4": 1, "T-3.5": 2, "T-3.6": 3, "T-4.3": 4})
def vector_of_a_pair(number: int) -> Outcome:
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
    rows = [row(n) for row in (offsets_of_a_pair, vector_of_a_pair) for n in (1, 2, 3)]
    return Outcome(_of_a_table(rows), f"{_in_words(rows)}.")


def _of_a_table(rows: Iterable[Outcome]) -> Verdict:
    """Return the verdict on a table: the least favourable of its rows."""
    return max((row.most_favourable for row in rows), key=VERDICTS.index)


def _in_words(rows: Sequence[Outcome]) -> str:
    """Return how many rows have each verdict, such as "Of 3 rows 1 confirmed, 2 misprint"."""
    counts = Counter(row.most_favourable for row in rows)
    return f"Of {len(rows)} rows " + ", ".join(f"{counts[v]} {v}" for v in VERDICTS if counts[v])


def _roots_of_b4(of: Robot) -> int:
    """Count the roots of the two components of B_4."""
    count = 0
    for component in (0, 2):
        c0, a, b = pair_vector(of, pairs(of)[3])[component].along(1, of.home)
        count += int(circle_roots(a, b, -c0).count)
    return count


@computes("T-4")
def table_4() -> Outcome:
    rows = (unit_of_table_4(), offsets_of_a_pair(4), vector_of_a_pair(4))
    return Outcome(
        _of_a_table(rows),
        f"{_in_words(rows)}: the unit (T-4.1), one digit (T-4.2), the vector. {other_slips()}",
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


def _with_floor(height: float) -> Robot:
    floor = replace(half_spaces()[-1], offset=height)
    return replace(robot(), boundaries=(*robot().boundaries[:-1], floor))


@computes("T-5")
def table_5() -> Outcome:
    rows = [unit_of_the_floor(), unit_of_the_side_limits(), selection()]
    rows += [vector_of_a_half_space(number) for number in (5, 6, 7)]
    return Outcome(_of_a_table(rows), f"{_in_words(rows)}; the units are those of T-5.1 and T-5.2.")


@computes("T-5.1")
def unit_of_the_floor() -> Outcome:
    height = {unit: paper.offsets_in_cm(mm_means=unit)["z_{min,1}"] for unit in ("mm", "cm")}
    named = {unit: len(vertices(_with_floor(h))) for unit, h in height.items()}
    around = {unit: _corners_by_the_component(h) for unit, h in height.items()}
    return Outcome(
        undetermined({unit: number == 6 for unit, number in around.items()}),
        f"At {height['cm']} cm and at {height['mm']:.3f} cm the component β_{{7,3}} and the four"
        f" sides that Figure 4 names close a region round home, with {around['cm']} and"
        f" {around['mm']} corners. By the bounds as they stand in Table 6, without a turn added,"
        f" they meet in {named['cm']} points and in {named['mm'] or 'none'}: in mm one corner lies"
        " on β_{7,3,2} plus a turn, which a picture can show (F-4.2). The unit of all other lengths"
        " speaks for cm, as in T-5.2, and the robot file takes cm.",
    )


def _corners_by_the_component(height: float) -> int:
    """Count the corners of the box of windows cut by β_{7,3}, with the floor at a height, cm."""
    region = window_region(_with_floor(height))
    low, high, crossings = region.box.lower, region.box.upper, 0
    for held, free in ((0, 1), (1, 0)):
        ends = region.fibres(held, [low[held], high[held]]).end
        crossings += int(((low[free] < ends) & (ends < high[free])).sum())
    corners = list(product(*zip(low, high, strict=True)))
    return crossings + int(region.contains(corners).sum())


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
    base = abs(float(robot().point("6").at[0]))
    return Outcome(
        undetermined(fits),
        f"With {' and with '.join(seen)} the six points are the same, for neither wall bounds the"
        f" region. The unit of all other lengths and the base, whose corners stand at ±{base} cm,"
        " speak for cm.",
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
    arm, _ = symbolic_robot()
    derived = components(arm, arm.boundary(f"B{number}")).symbolic(joint_symbols(robot()))
    name, limit = paper.TABLE_5[number]
    S = sp.Matrix(paper.SELECTION[name])
    place, _ = _printed_kinematics()["0", "3"]
    printed = S * (place - sp.Symbol(limit, real=True) * sp.ones(3, 1))
    left = [sp.expand(d - p) for d, p in zip(derived, printed, strict=True)]
    zero = sum(d == 0 for d in derived)
    return Outcome(
        judge(holds=not any(left)),
        f"With the printed matrix and r_{{0,3}} of Table 2 the {len(left)} components are those"
        f" derived from the chain; {zero} of them are identically zero.",
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
        judge(holds=arctan + of_half_spaces == total, amended=atan2 + of_half_spaces == total),
        f"With arctan {arctan + of_half_spaces} of {total} bounds are roots of their components,"
        f" with atan2 all {atan2 + of_half_spaces}; those of the walls where eq. (36) lets them"
        " exist.",
    )


ROWS = {f"T-6.{row}": paper.indices(name) for row, name in enumerate(paper.EQUATION_29, start=1)}
"""The indices i and j of each row of Table 6."""


@computes_each({name: ij for name, ij in ROWS.items() if ij[0] < 5})
def window_of_a_pair(ij: tuple[int, ...]) -> Outcome:
    labels = [f"beta_{{{ij[0]},{ij[1]},{k}}}" for k in (1, 2)]
    upper, lower = map(pair_bound, labels)
    are_roots = max(upper.plain_residual, lower.plain_residual) < RESIDUAL
    as_printed = are_roots and _surrounds(ij[0], lower.plain, upper.plain)
    with_atan2 = _surrounds(ij[0], lower.value, upper.value)
    at_contact = upper.at_contact and lower.at_contact
    text = f"From {degrees(lower.value)} to {degrees(upper.value)}, a full turn. "
    text += _ends_of_a_window(upper, lower)
    if not are_roots:
        text += f" These are the values with atan2; arctan gives {degrees(lower.plain)} and"
        text += f" {degrees(upper.plain)}, which are no roots."
    if ij == (3, 3):  # the row with a < 0 that arctan + π moves by a turn against atan2
        shifted = [degrees(bound.plain + np.pi) for bound in (lower, upper)]
        text += f" With arctan + π where a < 0 it is {shifted[0]} to {shifted[1]}, without home."
    return Outcome(
        judge(
            holds=as_printed and at_contact,
            amended=with_atan2 and max(upper.residual, lower.residual) < RESIDUAL,
        ),
        text,
    )


def _surrounds(pair: int, low: float, high: float) -> bool:
    """Tell whether the region lies between two values of the joint that a pair bounds."""
    (joint,) = pair_vector(robot(), pairs()[pair - 1]).joints()
    box = by_windows().box
    return bool(low <= box.lower[joint] + SMALL and box.upper[joint] - SMALL <= high)


def _ends_of_a_window(upper: PairBound, lower: PairBound) -> str:
    if not upper.at_contact:
        copies = upper.contact + TURN * np.arange(-2, 3)
        inside = next(q for q in copies if lower.value < q < upper.value)
        return (
            "The region lies in between, but no end cuts anything off: both are the root at which"
            f" the points are {upper.distance:.2f} cm apart; they come closest at"
            f" {degrees(inside)}. The condition is to ask for roots by eq. (38) and no more."
        )
    text = "The region lies in between, and each end is the root next to the contact, where the"
    text += f" points are {upper.distance:.4f} cm apart"
    if upper.distance <= upper.allowed:
        return f"{text}, within the rounding."
    return f"{text}, for a digit is off (T-4.2)."


@computes_each({name: ij for name, ij in ROWS.items() if ij[0] > 4})
def window_of_a_half_space(ij: tuple[int, ...]) -> Outcome:
    i, j = ij
    upper, lower = (half_space_bound(f"beta_{{{i},{j},{k}}}") for k in (1, 2))
    are_roots = max(upper.residual, lower.residual) < RESIDUAL
    length = upper.q[:, 1] - lower.q[:, 1]
    form = components(robot(), robot().boundary(f"B{i}"))[j - 1]
    q2 = lower.q[:, 1] + (np.arange(200)[:, None] + 0.5) / 200 * length
    values = form(np.stack([np.broadcast_to(upper.q[:, 0], q2.shape), q2], -1))
    negative = float((values < 0).mean())
    are_bounds = are_roots and _region_is_between(lower, upper)
    text = limit_of(f"beta_{{{i},{j},2}}")
    text += f"It exists, by eq. (36), for {upper.part:.0f} % of a turn of q_1. There it"
    if np.ptp(length) < SMALL:
        text += " is a full turn long, one root twice: the region lies in it, and so does any pose"
        text += f" plus or minus a turn. The component is negative in {100 * negative:.0f} % of it."
        text += " The condition is to ask for roots, by the recipe of rows 1 to 8, and no more."
    else:
        text += f" runs from one root to the other, over {np.degrees(length.min()):.0f}° to"
        text += f" {np.degrees(length.max()):.0f}°; the region lies in it, and the component is"
        text += f" negative in {100 * negative:.0f} % of it."
    return Outcome(judge(holds=are_bounds and not negative, amended=are_bounds), text)


def _region_is_between(lower: HalfSpaceBound, upper: HalfSpaceBound) -> bool:
    """Tell whether a grid over the region lies between two bounds, where these exist."""
    box = by_windows().box
    q1, low, high = (x[::10, None] for x in (lower.q[:, 0], lower.q[:, 1], upper.q[:, 1]))
    q2 = np.linspace(box.lower[1], box.upper[1], 200)
    free = by_windows().contains(np.stack(np.broadcast_arrays(q1, q2), -1))
    return bool(((low <= q2 + SMALL) & (q2 - SMALL <= high))[free].all())
