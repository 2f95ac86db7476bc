r"""The paper's printed data: tables and formulas as they stand in print. No mathematics reads this.

J. A. Lizarraga et al., Appl. Sci. 2025, 15, 5383, doi:10.3390/app15105383. Labels follow the paper:
:math:`x_{a,b}` is the x component of :math:`r_{a,b}`. Formulas are written in plain text;
``arctan(n, d)`` stands for the printed :math:`\tan^{-1}(n / d)`, so that both readings of it,
arctan and atan2, can be computed.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, Literal

if TYPE_CHECKING:
    import sympy


Reading = Literal["arctan", "atan2"]


@dataclass(frozen=True)
class Offset:
    """A length as printed: its label, value, unit and table."""

    label: str
    value: float
    unit: Literal["cm", "mm"]
    table: int


OFFSETS: Final = (
    Offset("z_{0,1}", 22.5, "cm", 1),
    Offset("z_{1,2}", 25.98, "cm", 1),
    Offset("x_{1,2}", 15.0, "cm", 1),
    Offset("x_{2,3}", 25.0, "cm", 1),
    Offset("x_{0,6}", 7.5, "cm", 3),
    Offset("z_{0,6}", 12.5, "cm", 3),
    Offset("x_{1,7}", 11.5, "cm", 3),
    Offset("z_{1,7}", 4.91, "cm", 3),
    Offset("x_{0,8}", -7.5, "cm", 3),
    Offset("z_{0,8}", 12.5, "cm", 3),
    Offset("x_{1,9}", -1.5, "cm", 3),
    Offset("z_{1,9}", 12.41, "cm", 3),
    Offset("x_{1,10}", 17.82, "cm", 3),
    Offset("z_{1,10}", 15.87, "cm", 3),
    Offset("x_{2,11}", 9.09, "cm", 3),
    Offset("z_{2,11}", -5.25, "cm", 3),
    Offset("x_{1,12}", 4.83, "mm", 4),
    Offset("z_{1,12}", 23.37, "mm", 4),
    Offset("x_{2,13}", 9.00, "mm", 4),
    Offset("z_{2,13}", 5.25, "mm", 4),
    Offset("x_{min,1}", 15.0, "mm", 5),
    Offset("x_{min,2}", -15.0, "mm", 5),
    Offset("z_{min,1}", 11.32, "mm", 5),
)
"""Tables 1 and 3-5, in the printed units."""

HALF_DIGIT: Final = 0.005
"""Largest error of an offset rounded to two decimals, in its unit."""

TABLE_1: Final = (
    ("0", "1", "Offset z (base to joint 1)", "z_{0,1}"),
    ("1", "2", "Offset z (joint 1 to joint 2)", "z_{1,2}"),
    ("1", "2", "Offset x (joint 1 to joint 2)", "x_{1,2}"),
    ("2", "3", "Offset x (joint 2 to joint 3)", "x_{2,3}"),
)
"""Rows of Table 1 as printed; frames a and b, parameter, label. The values are in `OFFSETS`."""

TABLE_2: Final = (
    ("0", "0", r"[0\ 0\ 0]^T", "I"),
    ("0", "1", r"[0\ 0\ z_{0,1}]^T", "R_y(q_1)"),
    ("1", "2", r"[x_{1,2}\ 0\ z_{1,2}]^T", "R_y(q_2)"),
    ("2", "3", r"[x_{2,3}\ 0\ 0]^T", "I"),
    ("0", "2", r"\mathbf{r}_{0,1} + R_{0,1}\mathbf{r}_{1,2}", "R_{0,1}R_{1,2}"),
    ("0", "3", r"\mathbf{r}_{0,2} + R_{0,2}\mathbf{r}_{2,3}", "R_{0,2}R_{2,3}"),
)
"""Rows of Table 2 as printed; frames a and b, position and orientation of b seen from a (LaTeX)."""

SELECTION: Final = {
    "S_x": ((1, 0, 0), (0, 0, 0), (0, 0, 0)),
    "S_z": ((0, 0, 0), (0, 0, 0), (0, 0, 1)),
}
"""The matrices of Table 5."""

TABLE_5: Final = {5: ("S_x", "x_{min,1}"), 6: ("S_x", "x_{min,2}"), 7: ("S_z", "z_{min,1}")}
"""``B_i = S r_{0,3}`` less a vector with one limit, where S selects: S and limit, by i."""

OBSERVERS: Final = {3: "right", 6: "left", 7: "left"}
"""The equations that mark an observer, and on which side of the symbol."""

THEOREM_1: Final = {
    14: "x**2 + y**2 + z**2",
    15: "r_ab + R_ab @ r_bm - r_an",
    16: "r_ab + R_ab @ r_bm - r_an",
    18: "r_1 + R_1 @ r_2",
    19: "r_0bm - r_0an",
    20: "r_0a + R_0a @ r_an",
    21: "r_0b + R_0b @ r_bm",
    22: "(r_0b + R_0b @ r_bm) - (r_0a + R_0a @ r_an)",
    23: "(r_0b - r_0a) + R_0b @ r_bm - R_0a @ r_an",
    24: "R_0a @ r_ab + R_0a @ R_ab @ r_bm - R_0a @ r_an",
    25: "R_0a @ (r_ab + R_ab @ r_bm - r_an)",
    26: "r_ab + R_ab @ r_bm - r_an",
    27: "r_ab + R_ab @ r_bm - r_an",
}
"""Right sides of eqs. (15) to (27), and the square of the norm in eq. (14).

The points a+n and b+m are written by their last letter (``r_an``, ``r_0an``). Eq. (18) adds a step:
its vector and matrix up to b-1 are ``r_1`` and ``R_1``, the step from there is ``r_2``.
"""

ROTATIONS_IN_A_ROW: Final = "R_0a @ R_ab"
"""What ``R_{0,b}`` is rewritten as, before eq. (24)."""

UNIT_VECTOR: Final = "r/sqrt(x**2 + y**2 + z**2)"
"""Right side of eq. (8)."""

THEOREM_2: Final = {
    "30": "a*cos(q) + b*sin(q)",
    "31 upper": "arctan(b, a) + acos(c/sqrt(a**2 + b**2)) + 2*pi*k",
    "31 lower": "arctan(b, a) - acos(c/sqrt(a**2 + b**2)) + 2*pi*k - 2*pi",
    "33": "d*cos(q - theta)",
    "34 d": "sqrt(a**2 + b**2)",
    "34 theta": "arctan(b, a)",
    "35": "c/d",
    "36 lower": "-1",
    "36 upper": "1",
    "37": "+acos(c/d) + 2*pi*k",
    "38": "arctan(b, a) + acos(c/d) + 2*pi*k",
    "39 lower": "arctan(b, a) + acos(c/d) + 2*pi*k - 2*pi",
    "39 upper": "arctan(b, a) + acos(c/d) + 2*pi*k",
}
"""Sides of the equations of Theorem 2 and its proof; a sign of both values is ``pm``."""

EQUATION_29: Final = {
    "beta_{1,1}": "x_1_7*cos(q1) - x_0_6 + z_1_7*sin(q1)",
    "beta_{1,3}": "z_0_1 - z_0_6 + z_1_7*cos(q1) - x_1_7*sin(q1)",
    "beta_{2,1}": "x_1_9*cos(q1) - x_0_8 + z_1_9*sin(q1)",
    "beta_{2,3}": "z_0_1 - z_0_8 + z_1_9*cos(q1) - x_1_9*sin(q1)",
    "beta_{3,1}": "x_1_2 - x_1_10 + x_2_11*cos(q2) + z_2_11*sin(q2)",
    "beta_{3,3}": "z_1_2 - z_1_10 + z_2_11*cos(q2) - x_2_11*sin(q2)",
    "beta_{4,1}": "x_1_2 - x_1_12 + x_2_13*cos(q2) + z_2_13*sin(q2)",
    "beta_{4,3}": "z_1_2 - z_1_12 + z_2_13*cos(q2) - x_2_13*sin(q2)",
    "beta_{5,1}": (
        "x_2_3*(cos(q1)*cos(q2) - sin(q1)*sin(q2)) - x_min_1 + x_1_2*cos(q1) + z_1_2*sin(q1)"
    ),
    "beta_{6,1}": (
        "x_2_3*(cos(q1)*cos(q2) - sin(q1)*sin(q2)) - x_min_2 + x_1_2*cos(q1) + z_1_2*sin(q1)"
    ),
    "beta_{7,3}": (
        "z_0_1 - z_min_1 - x_2_3*(cos(q1)*sin(q2) + cos(q2)*sin(q1))"
        " + z_1_2*cos(q1) - x_1_2*sin(q1)"
    ),
}
"""The eleven components of eq. (29)."""

TABLE_6: Final = {
    "beta_{1,1,1}": "arctan(z_1_7, x_1_7) + acos(x_0_6/sqrt(x_1_7**2 + z_1_7**2))",
    "beta_{1,1,2}": "acos(x_0_6/sqrt(x_1_7**2 + z_1_7**2)) + arctan(z_1_7, x_1_7) - 2*pi",
    "beta_{1,3,1}": "pi + arctan(-x_1_7, z_1_7) - acos((z_0_1 - z_0_6)/sqrt(x_1_7**2 + z_1_7**2))",
    "beta_{1,3,2}": "-pi + arctan(-x_1_7, z_1_7) - acos((z_0_1 - z_0_6)/sqrt(x_1_7**2 + z_1_7**2))",
    "beta_{2,1,1}": "arctan(z_1_9, x_1_9) + acos(x_0_8/sqrt(x_1_9**2 + z_1_9**2))",
    "beta_{2,1,2}": "acos(x_0_8/sqrt(x_1_9**2 + z_1_9**2)) + arctan(z_1_9, x_1_9) - 2*pi",
    "beta_{2,3,1}": "pi + arctan(-x_1_9, z_1_9) - acos((z_0_1 - z_0_8)/sqrt(x_1_9**2 + z_1_9**2))",
    "beta_{2,3,2}": "-pi + arctan(-x_1_9, z_1_9) - acos((z_0_1 - z_0_8)/sqrt(x_1_9**2 + z_1_9**2))",
    "beta_{3,1,1}": (
        "pi + arctan(z_2_11, x_2_11) - acos((x_1_2 - x_1_10)/sqrt(x_2_11**2 + z_2_11**2))"
    ),
    "beta_{3,1,2}": (
        "-pi + arctan(z_2_11, x_2_11) - acos((x_1_2 - x_1_10)/sqrt(x_2_11**2 + z_2_11**2))"
    ),
    "beta_{3,3,1}": (
        "pi + arctan(-x_2_11, z_2_11) - acos((z_1_2 - z_1_10)/sqrt(x_2_11**2 + z_2_11**2))"
    ),
    "beta_{3,3,2}": (
        "-pi + arctan(-x_2_11, z_2_11) - acos((z_1_2 - z_1_10)/sqrt(x_2_11**2 + z_2_11**2))"
    ),
    "beta_{4,1,1}": (
        "pi + arctan(z_2_13, x_2_13) - acos((x_1_2 - x_1_12)/sqrt(x_2_13**2 + z_2_13**2))"
    ),
    "beta_{4,1,2}": (
        "-pi + arctan(z_2_13, x_2_13) - acos((x_1_2 - x_1_12)/sqrt(x_2_13**2 + z_2_13**2))"
    ),
    "beta_{4,3,1}": (
        "pi + arctan(-x_2_13, z_2_13) - acos((z_1_2 - z_1_12)/sqrt(x_2_13**2 + z_2_13**2))"
    ),
    "beta_{4,3,2}": (
        "-pi + arctan(-x_2_13, z_2_13) - acos((z_1_2 - z_1_12)/sqrt(x_2_13**2 + z_2_13**2))"
    ),
    "beta_{5,1,1}": "pi - q1 - acos((x_1_2*cos(q1) - x_min_1 + z_1_2*sin(q1))/x_2_3)",
    "beta_{5,1,2}": "-q1 - pi - acos((x_1_2*cos(q1) - x_min_1 + z_1_2*sin(q1))/x_2_3)",
    "beta_{6,1,1}": "pi - q1 - acos((x_1_2*cos(q1) - x_min_2 + z_1_2*sin(q1))/x_2_3)",
    "beta_{6,1,2}": "-q1 - pi - acos((x_1_2*cos(q1) - x_min_2 + z_1_2*sin(q1))/x_2_3)",
    "beta_{7,3,1}": "asin((z_0_1 - z_min_1 + z_1_2*cos(q1) - x_1_2*sin(q1))/x_2_3) - q1",
    "beta_{7,3,2}": "-q1 - pi - asin((z_0_1 - z_min_1 + z_1_2*cos(q1) - x_1_2*sin(q1))/x_2_3)",
}
"""Bounds of Table 6; k = 1 is the right (upper) bound, k = 2 the left (lower) one."""

CAPTIONS_AS_PRINTED: Final = {
    7: "Trajectory of the six intersection points in the geometric space, including the simplified"
    " diagram of the planar robot in its final pose.",
    8: "Nonclosed trajectory consisting of five points. The first plot represents the joint space"
    " sequence, while the second illustrates the planar robot in its final pose after completing"
    " the trajectory. Despite following an ordered sequence, the trajectory remains open.",
    9: "Alternative feasible trajectory. The first plot depicts a five-point joint space path,"
    " while the second shows its corresponding geometric trajectory.",
    10: "Overlay of the feasible geometric regions from Figures 8 and 9, highlighting their"
    " asymmetry due to centroid-based scaling and trajectory nonlinearities.",
    11: "Numerical collision detection results. The first plot shows joint space sampling with red"
    " points for collisions and blue points for noncollisions. The second plot illustrates the"
    " corresponding geometric space, highlighting overlapping regions and the lateral shapes of the"
    " feasible workspace.",
}
"""Captions of Section 4's last figures, quoted."""

ON_NUMERICAL_METHODS: Final = (10, ("numerical", "collision", "red point", "blue point"))
"""The figure named where the text turns to numerical methods, and words that say what it shows."""

FIGURE_4_BOUNDS: Final = (
    "beta_{1,3,1}",
    "beta_{2,1,2}",
    "beta_{3,3,2}",
    "beta_{4,1,2}",
    "beta_{7,3,1}",
    "beta_{7,3,2}",
)
"""The six bounds that the caption of Figure 4 names."""


CAPTIONS: Final = {
    2: "a kinematic chain, a simplified example of a planar robot",
    3: "the kinematic chain of MinervaBotV2",
    7: "the path of six points",
    8: "a path of five points",
    9: "a path of five points",
    10: "an overlay of two paths",
    11: "random configurations",
}
"""What captions announce."""

NAMED_VIEW: Final = (2, "isometric")
"""The figure that the case study's first paragraph names, and the view that it announces."""


ORDERS: Final[Mapping[int, tuple[int, ...] | None]] = {6: None, 7: None, 8: None, 9: None}
"""In which order a figure visits the points, from 1: what the text says of it, nothing."""

SCALING: Final[Mapping[str, float | str | None]] = {"factor": None, "centroid": None}
"""By what, and about which centroid, Figure 6 is scaled: what the text says of it, nothing."""

COMPARED: Final[str | None] = None
"""With which planning of paths the last sentence of the abstract compares: with none."""

SAMPLES: Final[Mapping[str, int | str | None]] = {"number": None, "range": None, "test": None}
"""How the configurations of Figure 11 are drawn and judged: what the text says of it, nothing."""


def offsets_in_cm(*, mm_means: Literal["cm", "mm"] = "cm") -> dict[str, float]:
    """Return every offset by its label, in cm; converted here and nowhere else.

    Parameters
    ----------
    mm_means : {"cm", "mm"}
        How to read the "mm" printed in Tables 4 and 5: as the slip it is (default), or literally.
    """
    scale = {"cm": 1.0, "mm": 0.1 if mm_means == "mm" else 1.0}
    return {o.label: o.value * scale[o.unit] for o in OFFSETS}


def expression(text: str, *, arctan: Reading = "arctan") -> sympy.Expr:
    r"""Turn a printed formula of this module into a SymPy expression.

    Parameters
    ----------
    text : str
        An entry of `THEOREM_2`, `EQUATION_29` or `TABLE_6`.
    arctan : {"arctan", "atan2"}
        How to read the printed :math:`\tan^{-1}` of a quotient.
    """
    import sympy

    readings = {"arctan": lambda n, d: sympy.atan(n / d), "atan2": sympy.atan2}
    names: dict[str, Any] = {
        name: sympy.Symbol(label(name), real=True)
        for name in re.findall(r"\b(?:[xz]_\w+|q\d?|[abcdk]|theta|pm)\b", text)
    }
    return sympy.parse_expr(text, local_dict=names | {"arctan": readings[arctan]})


def greek(label: str) -> str:
    """Write the name of a component or bound with its Greek letter."""
    return label.replace("beta", "β")


def work_out(text: str, values: Mapping[str, Any]) -> Any:
    """Work out an entry of `THEOREM_1` with numbers, symbols or arrays of them for its names."""
    import sympy

    return sympy.parse_expr(text, local_dict=dict(values))


def indices(label: str) -> tuple[int, ...]:
    """Return the indices of a label, such as (2, 1, 2) of ``beta_{2,1,2}``."""
    return tuple(map(int, re.findall(r"\d+", label)))


def label(name: str) -> str:
    """Return the paper's label of a name in a formula, such as ``x_{1,10}`` of ``x_1_10``."""
    if re.fullmatch(r"q\d", name):
        return f"q_{name[1:]}"
    if "_" not in name:
        return name
    letter, a, b = name.split("_")
    return f"{letter}_{{{a},{b}}}"
