"""Equations (9) to (12): the sign of a component, joint limits, least distance, limits in space."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from lizarraga2025 import printed as paper
from lizarraga2025.computations.registry import computes
from lizarraga2025.evidence.arms import half_spaces, pairs, robot
from lizarraga2025.evidence.joint_region import square, vertices
from lizarraga2025.verdicts import Outcome, judge, require, undetermined
from qbound import clearance, pair_vector
from qbound.boundary.functions import closest_approach
from qbound.model.robot import Robot
from qbound.region import find_region, paper_rule


@computes("E-9")
def sign_of_a_component() -> Outcome:
    import sympy as sp

    q = np.array([-np.pi / 2, 0.0])  # cos and sin are 0 and -1: the values are exact
    cm = {name: sp.Rational(str(x)) for name, x in paper.offsets_in_cm().items()}
    exact = -cm["x_{0,6}"] - cm["z_{1,7}"]
    path = np.linspace(robot().home, q, 1001)
    free = all((clearance(robot(), b)(path) > 0).all() for b in robot().boundaries if b.used)
    inside = bool(paper_rule.feasible(robot(), q)) and free
    x = pair_vector(robot(), pairs()[0])(q)[0]
    allowed = square()[paper_rule.feasible(robot(), square())]
    vectors = np.stack([pair_vector(robot(), pair)(allowed) for pair in pairs()], axis=1)
    negative = (vectors < 0).mean(axis=0)
    share = 100 * (vectors < 0).any(axis=(1, 2)).mean()
    kinds = [
        f"β_{{{i + 1},{j + 1}}} ({100 * x:.0f} %)" for (i, j), x in np.ndenumerate(negative) if x
    ]
    B, d = sp.symbols("B d", nonnegative=True)
    require(sp.expand((B - d) * (B + d) - B**2 + d**2) == 0, "|B|² - d² = (|B| - d)(|B| + d)")
    return Outcome(
        judge(holds=not (inside and x < 0 and share > 0)),
        "At q = (-90°, 0°), which lies in the selected region and is reached freely from home,"
        f" β_{{1,1}} = -(x_{{0,6}} + z_{{1,7}}) = {float(exact):.2f} cm exactly. In {share:.1f} %"
        f" of the region some component is negative: {', '.join(kinds)}. The y components are zero"
        " everywhere.",
    )


@computes("E-9.1")
def sign_of_a_half_space() -> Outcome:
    allowed = square()[paper_rule.feasible(robot(), square())]
    below = {w.name: 100 * (clearance(robot(), w)(allowed) < 0).mean() for w in half_spaces()}
    used = [w.name for w in half_spaces() if w.used]
    shares = ", ".join(f"{name} in {share:.1f} %" for name, share in below.items())
    return Outcome(
        judge(holds=not any(below.values()), under=not any(below[name] for name in used)),
        f"Negative within the selected region: {shares}. So it holds for the wall that bounds it.",
    )


@computes("E-10")
def joint_limits() -> Outcome:
    printed = [o.label for o in paper.OFFSETS if o.label.startswith("q")]
    box = np.degrees([paper_rule.box(robot()).lower, paper_rule.box(robot()).upper])
    area = {}
    for name, limits in (("none", None), ("±180°", (-np.pi, np.pi)), ("±170°", (-2.967, 2.967))):
        joints = tuple(replace(joint, limits=limits) for joint in robot().joints)
        area[name], _ = _home(replace(robot(), joints=joints))
    same = {name: bool(np.isclose(a, area["none"])) for name, a in area.items()}
    verdict = undetermined({name: not printed and fits for name, fits in same.items()})
    return Outcome(
        verdict,
        f"{len(printed)} limits are printed. The windows of Table 6 end at {box[0, 0]:.2f}° and"
        f" {box[1, 0]:.2f}° for the first joint and at {box[0, 1]:.2f}° and {box[1, 1]:.2f}° for"
        " the second, so wide limits change nothing: area around home "
        + ", ".join(f"{a:.6f} rad² with limits {name}" for name, a in area.items())
        + ".",
    )


@computes("E-11")
def least_distance() -> Outcome:
    gaps = [closest_approach(robot(), pair)[1] for pair in pairs()]
    seen, fits = [], {}
    for d in (0.01, 0.1, 0.5):
        boundaries = tuple(
            replace(b, clearance=d) if b in pairs() else b for b in robot().boundaries
        )
        area, corners = _home(replace(robot(), boundaries=boundaries))
        bounding = sum(gap < d for gap in gaps)
        fits[str(d)] = bounding == len(gaps) and corners == 6
        seen.append(f"d_min = {d} cm: {bounding} walls, {corners} corners, {area:.6f} rad²")
    return Outcome(
        undetermined(fits),
        f"The pairs come as close as {min(gaps):.4f} to {max(gaps):.4f} cm, so d_min = 0 makes no"
        f" wall at all; every pair is a wall above {max(gaps):.4f} cm. {'; '.join(seen)}.",
    )


def _home(arm: Robot) -> tuple[float, int]:
    """Return area, rad^2, and number of vertices of the region around home; zeros for none."""
    home = find_region(arm).home
    return (0.0, 0) if home is None else (home.area, len(home.vertices))


@computes("E-12")
def limits_in_space() -> Outcome:
    least = {w.name: float(np.min(clearance(robot(), w)(vertices()))) for w in half_spaces()}
    inside = {name: x > -1e-9 for name, x in least.items()}
    depths = ", ".join(f"{name} {round(x, 9) + 0:.2f} cm" for name, x in least.items())
    upper = [o.label for o in paper.OFFSETS if "max" in o.label]
    return Outcome(
        judge(holds=all(inside.values()), under=inside["B7"]),
        f"{len(upper)} upper limits and two lower ones for x are printed. Least margins at the six"
        f" points of the region: {depths}. Only the floor is kept.",
    )
