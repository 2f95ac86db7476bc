"""Sentences on other joints and dimensions, at the end of Section 4, and of Section 5."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np

from cspace.forms.harmonic import restrict
from cspace.geometry.isosurface import marching_cubes
from cspace.region import clearance_problem, solve
from lizarraga2025 import printed as paper
from lizarraga2025.computations.registry import computes
from lizarraga2025.computations.sentences_workspace import pass_keeps_bounds
from lizarraga2025.evidence.arms import (
    of_points,
    of_slides,
    pairs,
    robot,
    sliding,
    symbolic_robot,
    symmetric,
)
from lizarraga2025.evidence.joint_region import SCALE, largest_scale, scaled
from lizarraga2025.evidence.proofs import general, vanishes
from lizarraga2025.evidence.rounding import SMALL
from lizarraga2025.evidence.tool_paths import (
    asymmetry,
    det_jacobian,
    feasible_neighbours,
    is_cut_by_the_singular_line,
    neighbour_sequences,
    path_through,
    scale_without_singular_poses,
    structured_neighbours,
)
from lizarraga2025.verdicts import Outcome, judge, strongest
from qbound.boundary import clearance, closest_approach, components, position
from qbound.symbols import joint_symbols, with_symbols


@computes("S-43")
def slides_enter_linearly() -> Outcome:
    import sympy as sp

    arm = with_symbols(sliding())
    q = joint_symbols(arm)
    curvature = [sp.diff(x, q[2], 2) for x in position(arm, "3").symbolic(q)]
    return Outcome(
        judge(holds=all(sp.simplify(x) == 0 for x in curvature)),
        "The second derivative of the tool's place along a slide is zero by identity, with lengths"
        " as symbols.",
    )


@computes("S-44")
def same_structure() -> Outcome:
    forms = [components(sliding(), b) for b in of_points(sliding()).boundaries]
    shapes = {form.stack for form in forms}
    depend = sum(2 in form.joints() for form in forms)
    return Outcome(
        judge(holds=shapes == {(3,)} and depend > 0),
        f"All {len(forms)} boundary functions of the arm with a slide are again vectors of three"
        f" forms in the same basis; {depend} of them depend on the slide.",
    )


@computes("S-45")
def affine_constraints() -> Outcome:
    import sympy as sp

    arm = with_symbols(sliding())
    q = joint_symbols(arm)
    height = clearance(arm, arm.boundary("B7")).symbolic(q)
    pair = sp.expand(clearance(arm, arm.boundary("B8")).symbolic(q))
    along = sp.simplify(sp.diff(height, q[2], 2)) == 0
    mixed = sp.simplify(sp.diff(height, q[0], q[2]))
    square = sp.simplify(sp.diff(pair, q[2], 2) / 2)
    flat = clearance(of_slides(), of_slides().boundary("B7")).coefficients
    jointly = not flat[1:, 1:].any() and not flat[2].any() and not flat[:, 2].any()
    return strongest(
        {
            "the components β of an arm of slides": judge(holds=jointly),
            "the components β of an arm that turns and slides": judge(
                holds=bool(mixed == 0), under=along
            ),
            "the distances of eq. (11)": judge(holds=bool(square == 0)),
        },
        "With slides alone a component is affine in all of them together. With a turning joint"
        " before it, it is affine along the slide, but not in both joints: the mixed derivative is"
        " not zero. The square of a distance between points with a slide between them is quadratic"
        f" in the slide, with leading coefficient {square}.",
    )


@cache
def surface(n: int) -> tuple[np.ndarray, np.ndarray]:
    """Return vertices (rad, rad, cm) and triangles of B7 = 0 on an n by n by n grid."""
    low, high = np.array([-np.pi, -np.pi, -10.0]), np.array([np.pi, np.pi, 10.0])
    axes = [np.linspace(a, b, n) for a, b in zip(low, high, strict=True)]
    q = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    values = clearance(sliding(), sliding().boundary("B7"))(q)
    if values.min() > 0 or values.max() < 0:
        return np.empty((0, 3)), np.empty((0, 3), int)
    points, triangles = marching_cubes(values)
    return low + points * (high - low) / (n - 1), triangles


@computes("S-46")
def hypersurfaces() -> Outcome:
    places = surface(41)[0]
    height = clearance(sliding(), sliding().boundary("B7"))
    steep = np.linalg.norm(height.gradient(places), axis=-1).min(initial=np.inf)
    both = closest_approach(robot(), pairs()[0]).gap
    return strongest(
        {
            "each component by itself": judge(holds=len(places) > 0 and bool(steep > 0.5)),
            "the components of a pair together": judge(holds=both < SMALL),
        },
        f"The gradient of B7 vanishes at none of {len(places)} places of its zero set in the arm"
        " with a slide, so it is a surface there. The vector of a point pair is zero where all"
        " its components are, which is a smaller set, and empty with the printed digits.",
    )


@computes("S-47")
def isosurfaces() -> Outcome:
    height = clearance(sliding(), sliding().boundary("B7"))
    off = {n: float(np.abs(height(surface(n)[0])).max(initial=0.0)) for n in (21, 41, 81)}
    second_order = off[81] > 0 and off[41] / off[81] > 2**1.5
    return Outcome(
        judge(holds=second_order),
        "Marching cubes on the arm with a slide: the vertices of the surface miss B7 = 0 by at most"
        f" {off[21]:.3f}, {off[41]:.3f} and {off[81]:.3f} cm on grids of 21, 41 and 81 points a"
        " joint, as the square of the step.",
    )


@computes("S-48")
@computes("S-49.1")
def slices_are_enough() -> Outcome:
    held = {2: 4.0}
    whole = solve(clearance_problem(sliding(), held), [0.0, 0.0])
    q = np.random.default_rng(8).uniform(-np.pi, np.pi, (200_000, 2))
    three = np.insert(q, 2, held[2], axis=1)
    used = [clearance(sliding(), b) for b in of_points(sliding()).used]
    part = float(np.all([form(three) > 0 for form in used], axis=0).mean())
    exact = whole.area / (2 * np.pi) ** 2
    error = np.sqrt(part * (1 - part) / len(q))
    return Outcome(
        judge(holds=bool(abs(part - exact) < 3 * error)),
        "With the slide held at 4 cm the slice is a region of two joints, found exactly and without"
        f" a sample: {len(whole.components)} pieces of {whole.area:.6f} rad² together, which is"
        f" {100 * exact:.4f} % of the square. Of {len(q)} random configurations {100 * part:.1f} %"
        " are free.",
    )


@computes("S-49")
def slices_stay_symbolic() -> Outcome:
    import sympy as sp

    form = clearance(sliding(), sliding().boundary("B7"))
    q = joint_symbols(sliding())
    held = restrict(form, {2: 4.0}).symbolic(q[:2])
    difference = sp.expand(form.symbolic(q).subs(q[2], sp.Float(4.0)) - held)
    left = max((abs(float(c)) for c in difference.as_coefficients_dict().values()), default=0.0)
    return Outcome(
        judge(holds=left < SMALL),
        "The form with the slide held is a form of two joints in closed form, equal to the whole"
        " with the value put in.",
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
    scales = (0.96, 0.95, 0.9)
    inside = [is_cut_by_the_singular_line(scaled(s)) for s in scales]
    passing = [
        is_cut_by_the_singular_line(path_through(o, s).q)
        for s in scales
        for o in neighbour_sequences()
    ]
    least = {s: float(np.abs(det_jacobian(scaled(s))).min()) for s in (1.0, *scales)}
    return strongest(
        {
            "a path that passes the pose with every bound kept (S-32)": pass_keeps_bounds(),
            "a region without singular poses": judge(holds=not any(inside)),
            "paths that meet none": judge(holds=not any(passing)),
            "points farther from them": judge(holds=min(least.values()) == least[1.0]),
        },
        f"The region keeps its singular poses at every scale above"
        f" {scale_without_singular_poses():.6f}, and {sum(passing) // len(scales)} of"
        f" {len(neighbour_sequences())} sequences of neighbours pass one, as any five of the six"
        " points lie on both sides of the singular line. The points come no farther from it: the"
        f" least |det J| of them is {least[1.0]:.2f} cm² unscaled and {least[0.95]:.2f} cm² at"
        " scale 0.95. What the scaling does is to make the pass feasible.",
    )


@computes("S-53")
def structured_paths_come_from_scaling() -> Outcome:
    number = {s: len(structured_neighbours(s)) for s in (1.0, 0.97, 0.96, 0.95)}
    feasible = {s: len(feasible_neighbours(s)) for s in number}
    text = "; ".join(f"{s:g}: {feasible[s]} and {number[s]}" for s in number)
    return Outcome(
        judge(
            holds=number[1.0] == 0 < number[0.97],
            under=number[1.0] == 0 < min(number[0.96], number[0.95]),
        ),
        f"Of {len(neighbour_sequences())} sequences of neighbours, by scale, those that are"
        f" feasible, and of these those that do not cross themselves: {text}. The limit is scale"
        f" {largest_scale().scale:.6f}.",
    )


@computes("S-54")
def strong_dependence() -> Outcome:
    ends = np.array([path_through(o).final_pose for o in neighbour_sequences()])
    reach = np.array([path_through(o).reach[-1] for o in neighbour_sequences()])
    spread = np.degrees(np.ptp(ends, axis=0))
    return Outcome(
        judge(holds=bool(spread.min() > 90 and np.ptp(reach) / reach.max() > 0.2)),
        f"At scale {SCALE:g}, over the {len(reach)} sequences of neighbours, the final joint values"
        " spread over"
        f" {spread[0]:.2f}° and {spread[1]:.2f}° and the final reach from {reach.min():.4f} to"
        f" {reach.max():.4f} cm.",
    )


@computes("S-36.2")
@computes("S-55")
def causes_of_asymmetry() -> Outcome:
    exact = {s: asymmetry(symmetric(), s) for s in (1.0, SCALE, 0.8)}
    printed = {s: asymmetry(robot(), s) for s in exact}
    alone = {"nonlinearity": exact[1.0] > SMALL, "scaling": max(exact.values()) > SMALL}
    needed = printed[1.0] < SMALL < printed[SCALE]
    added = printed[SCALE] > printed[1.0]
    text = "; ".join(f"{s:g}: {off:.4f}" for s, off in printed.items())
    return strongest(
        {
            "no mirror images, by either alone": judge(
                holds=all(alone.values()), under=any(alone.values())
            ),
            "no mirror images, and without the scaling they would be": judge(holds=needed),
            "less of mirror images by the scaling": judge(holds=added),
        },
        "The symmetric arm is scaled and as nonlinear, and its two paths are"
        f" {'no ' if any(alone.values()) else ''}mirror images. The printed arm's paths are no"
        f" mirror images without scaling either, and {'more' if added else 'less'} apart with it"
        f" (cm, by scale: {text}). That they are not mirror images comes from the digits, or from"
        " the two sequences chosen; neither scaling nor nonlinearity causes it. What the"
        " nonlinearity does break, point reflections, is in F-10.3.",
    )


@computes("S-56")
def spatial_manipulators() -> Outcome:
    g = general()
    seen = vanishes(g.chain.position("a+n", "b+m", "0") - g.R_0a @ g.B)
    first = replace(robot().joints[0], axis=np.array([0.0, 0.0, 1.0]))
    arm = replace(robot(), joints=(first, robot().joints[1]))
    q = np.radians(np.stack(np.meshgrid(*[np.arange(-180, 180, 10)] * 2), axis=-1))
    leaves = float(np.abs(position(arm, "3")(q)[..., 1]).max())
    return Outcome(
        judge(holds=seen and leaves > 1),
        "Eq. (16) is an identity in two general rotations of space, so its norm is the distance of"
        " the points in any chain. With the first joint of the arm turned about z, for example,"
        f" the tool leaves its plane by {leaves:.0f} cm.",
    )
