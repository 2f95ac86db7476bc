"""Sentences on other joints and dimensions, at the end of Section 4, and of Section 5."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np

from lizarraga2025 import printed as paper
from lizarraga2025.computations.registry import computes
from lizarraga2025.evidence.arms import of_slides, pairs, robot, sliding, symbolic_robot, symmetric
from lizarraga2025.evidence.joint_region import SCALE, by_windows, scaled
from lizarraga2025.evidence.rounding import SMALL
from lizarraga2025.evidence.tool_paths import (
    LEFT,
    RIGHT,
    asymmetry,
    asymmetry_of_the_symmetric,
    is_cut_by_the_singular_line,
    neighbour_sequences,
    path_through,
    simple_neighbours,
    workspace,
)
from lizarraga2025.verdicts import Outcome, judge, require
from qbound import clearance, components
from qbound.boundary.functions import closest_approach, position
from qbound.region import clearance_problem, solve
from qbound.symbols import joint_symbols, with_symbols


@computes("S-43")
def slides_enter_linearly() -> Outcome:
    import sympy as sp

    arm, _ = with_symbols(sliding())
    q = joint_symbols(arm)
    curvature = [sp.diff(x, q[2], 2) for x in position(arm, "3").symbolic(q)]
    return Outcome(
        judge(holds=all(sp.simplify(x) == 0 for x in curvature)),
        "The second derivative of the tool's place along a slide is zero by identity, with lengths"
        " as symbols.",
    )


@computes("S-44")
def same_structure() -> Outcome:
    forms = [components(sliding(), b) for b in sliding().boundaries]
    shapes = {form.shape for form in forms}
    depend = sum(2 in form.joints() for form in forms)
    return Outcome(
        judge(holds=shapes == {(3,)} and depend > 0),
        f"All {len(forms)} boundary functions of the arm with a slide are again vectors of three"
        f" forms in the same basis; {depend} of them depend on the slide.",
    )


@computes("S-45")
def affine_constraints() -> Outcome:
    import sympy as sp

    arm, _ = with_symbols(sliding())
    q = joint_symbols(arm)
    height = clearance(arm, arm.boundary("B7")).symbolic(q)
    pair = sp.expand(clearance(arm, arm.boundary("B8")).symbolic(q))
    along = sp.simplify(sp.diff(height, q[2], 2)) == 0
    mixed = sp.simplify(sp.diff(height, q[0], q[2]))
    square = sp.simplify(sp.diff(pair, q[2], 2) / 2)
    flat = clearance(of_slides(), of_slides().boundary("B7")).coefficients
    jointly = not flat[1:, 1:].any() and not flat[2].any() and not flat[:, 2].any()
    require(square == 1, "the clearance is quadratic in a slide, with leading coefficient 1")
    return Outcome(
        judge(holds=bool(mixed == 0 and square == 0), under=along and jointly),
        "A component or a wall is affine in each slide by itself; with slides alone it is affine in"
        " all of them. With a turning joint before the slide the mixed derivative is not zero, and"
        " the clearance of a pair is quadratic in a slide between its points, with coefficient"
        f" {square} of the square.",
    )


@cache
def surface(n: int) -> tuple[np.ndarray, np.ndarray]:
    """Return vertices (rad, rad, cm) and triangles of B7 = 0 on an n by n by n grid."""
    from skimage.measure import marching_cubes

    low, high = np.array([-np.pi, -np.pi, -10.0]), np.array([np.pi, np.pi, 10.0])
    axes = [np.linspace(a, b, n) for a, b in zip(low, high, strict=True)]
    q = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    values = clearance(sliding(), sliding().boundary("B7"))(q)
    points, triangles, _, _ = marching_cubes(values, 0.0)  # type: ignore[no-untyped-call]
    return low + points * (high - low) / (n - 1), triangles


@computes("S-46")
def hypersurfaces() -> Outcome:
    places, _ = surface(41)
    height = clearance(sliding(), sliding().boundary("B7"))
    steep = float(np.linalg.norm(height.gradient(places), axis=-1).min())
    both = closest_approach(robot(), pairs()[0])[1]
    return Outcome(
        judge(holds=steep > 0 and both < SMALL, under=steep > 0),
        "True of one component or one wall: the gradient of B7 does not vanish on its zero set (at"
        f" least {steep:.3f} cm per unit of joint). A point pair's vector is zero where all"
        " components are, which is a smaller set, and with the printed digits it is empty (|B1| >="
        f" {both:.4f} cm).",
    )


@computes("S-47")
def isosurfaces() -> Outcome:
    height = clearance(sliding(), sliding().boundary("B7"))
    off = {n: float(np.abs(height(surface(n)[0])).max()) for n in (21, 41, 81)}
    order = float(np.log2(off[41] / off[81]))
    return Outcome(
        judge(holds=order > 1.5),
        "Marching cubes on the arm with a slide: the vertices of the surface miss B7 = 0 by at most"
        f" {off[21]:.3f}, {off[41]:.3f} and {off[81]:.3f} cm on grids of 21, 41 and 81 points a"
        f" joint, of order {order:.2f} in the step.",
    )


@computes("S-48")
def slices_are_enough() -> Outcome:
    held = {2: 4.0}
    whole = solve(clearance_problem(sliding(), held), [0.0, 0.0])
    q = np.random.default_rng(8).uniform(-np.pi, np.pi, (200_000, 2))
    three = np.insert(q, 2, held[2], axis=1)
    used = [clearance(sliding(), b) for b in sliding().boundaries if b.used]
    part = float(np.all([form(three) > 0 for form in used], axis=0).mean())
    exact = whole.area / (2 * np.pi) ** 2
    off = abs(part - exact) / np.sqrt(part * (1 - part) / len(q))
    return Outcome(
        judge(holds=bool(off < 3)),
        "With the slide held at 4 cm the slice is a region of two joints, found exactly and without"
        f" a sample: {len(whole.components)} pieces of {whole.area:.6f} rad² together; {len(q)}"
        f" random configurations agree within {off:.2f} standard errors.",
    )


@computes("S-49")
def slices_stay_symbolic() -> Outcome:
    import sympy as sp

    form = clearance(sliding(), sliding().boundary("B7"))
    q = joint_symbols(sliding())
    held = form.restrict({2: 4.0}).symbolic(q[:2])
    difference = sp.expand(form.symbolic(q).subs(q[2], sp.Float(4.0)) - held)
    left = max((abs(float(c)) for c in difference.as_coefficients_dict().values()), default=0.0)
    return Outcome(
        judge(holds=left < SMALL),
        "The form with the slide held is a form of two joints in closed form, equal to the whole"
        " with the value put in.",
    )


@computes("S-50")
def boundary_by_connecting_points() -> Outcome:
    areas, region = workspace(), by_windows()
    part = areas["enclosed"] / areas["union"]
    return Outcome(
        judge(holds=part > 0.999, under=len(region.loops) == 1 and len(region.vertices) == 6),
        f"Of the joint region it does: one closed curve through {len(region.vertices)} points. Of"
        f" the tool's places that curve's image encloses {100 * part:.2f} %; the rest, reached by"
        " both postures, ends outside at the stretched arm.",
    )


@computes("S-51")
def explicit_constraints() -> Outcome:
    import sympy as sp

    arm, _ = symbolic_robot()
    q = joint_symbols(arm)
    derived = [f for b in arm.boundaries for f in components(arm, b).symbolic(q) if f != 0]
    same = [
        sp.expand(f - paper.expression(text)) == 0
        for f, text in zip(derived, paper.EQUATION_29.values(), strict=True)
    ]
    return Outcome(
        judge(holds=all(same)),
        f"All {len(same)} components that are not zero are closed formulas of offsets and joint"
        " values, derived from the chain and equal to the print.",
    )


@computes("S-52")
def scaling_resolves_singularities() -> Outcome:
    through = [is_cut_by_the_singular_line(scaled(s)) for s in (SCALE, 0.5, 0.1, 0.01)]
    require(all(through), "stretched poses inside at scales down to 0.01")
    return Outcome(
        judge(holds=not any(through)),
        "The singular line crosses the scaled polygon at scales 0.95, 0.5, 0.1 and 0.01 alike: it"
        " passes within a degree of the point about which the region is scaled.",
    )


@computes("S-53")
def structured_without_scaling() -> Outcome:
    free = {s: simple_neighbours(s) for s in (1.0, SCALE, 0.9, 0.8)}
    require(len(set(map(tuple, free.values()))) == 1, "the same sequences at every scale")
    number = len(free[1.0])
    return Outcome(
        judge(holds=number == 0),
        f"The same {number} of {len(neighbour_sequences())} sequences of neighbours are free of"
        " crossings at scales 1, 0.95, 0.9 and 0.8: without scaling as with it.",
    )


@computes("S-54")
def strong_dependence() -> Outcome:
    ends = np.array([path_through(o).final_pose for o in neighbour_sequences()])
    reach = np.array([path_through(o).reach[-1] for o in neighbour_sequences()])
    spread = np.degrees(np.ptp(ends, axis=0))
    return Outcome(
        judge(holds=bool(spread.min() > 90 and np.ptp(reach) / reach.max() > 0.2)),
        f"Over the {len(reach)} sequences of neighbours the final joint values spread over"
        f" {spread[0]:.2f}° and {spread[1]:.2f}° and the final reach from {reach.min():.4f} to"
        f" {reach.max():.4f} cm.",
    )


@computes("S-55")
def causes_of_asymmetry() -> Outcome:
    exact = asymmetry_of_the_symmetric()
    printed = asymmetry(robot(), SCALE)
    other = [path_through(o, SCALE, symmetric()) for o in (RIGHT, LEFT[::-1])]
    require(exact < SMALL, "symmetric paths of the symmetric arm")
    return Outcome(
        judge(holds=exact > SMALL),
        f"The symmetric arm, scaled and nonlinear, has symmetric paths (to {SMALL:g} cm); the"
        f" printed offsets move them {printed:.4f} cm apart. A pair of sequences that are no mirror"
        f" images ends unlike on the symmetric arm too (reach {other[0].reach[-1]:.4f} and"
        f" {other[1].reach[-1]:.4f} cm).",
    )


@computes("S-56")
def spatial_manipulators() -> Outcome:
    first = replace(robot().joints[0], axis=np.array([0.0, 0.0, 1.0]))
    arm = replace(robot(), joints=(first, robot().joints[1]))
    q = np.random.default_rng(9).uniform(-3, 3, (200, 2))
    frames, worst = arm.frames(q), 0.0
    for pair in pairs():
        a, b = pair.points
        seen = frames.position(arm.base, b, arm.base) - frames.position(arm.base, a, arm.base)
        apart = np.sqrt(clearance(arm, pair)(q) + pair.clearance**2)
        worst = max(worst, float(np.abs(apart - np.linalg.norm(seen, axis=-1)).max()))
    leaves = float(np.abs(position(arm, "3")(q)[:, 1]).max())
    return Outcome(
        judge(holds=worst < 1e-6 and leaves > 1),
        f"With the first joint turned about z the tool leaves its plane by up to {leaves:.2f} cm;"
        " the clearances from eq. (16) still are the distances in space, to 1e-6 cm.",
    )
