"""Sentences on other joints and dimensions, at the end of Section 4, and of Section 5."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import sympy as sp

from lizarraga2025 import printed as paper
from lizarraga2025.choices import SCALE
from lizarraga2025.computations.registry import computes
from lizarraga2025.computations.sentences_workspace import pass_keeps_bounds
from lizarraga2025.evidence.arms import robot, symbolic_robot, symmetric
from lizarraga2025.evidence.joint_region import largest_scale, scaled
from lizarraga2025.evidence.proofs import general, vanishes
from lizarraga2025.evidence.rounding import SMALL
from lizarraga2025.evidence.tool_paths import (
    asymmetry,
    asymmetry_about_the_middle,
    det_jacobian,
    feasible_neighbours,
    is_cut_by_the_singular_line,
    neighbour_sequences,
    path_through,
    reach,
    scale_without_singular_poses,
    structured_neighbours,
)
from lizarraga2025.verdicts import Outcome, judge, of_readings
from qbound import components, position
from qbound.symbols import joint_symbols


@computes("S-51")
def explicit_constraints() -> Outcome:
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
    return of_readings(
        "paths that meet none",
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


@computes("S-4")
@computes("S-34")
@computes("S-54")
def strong_dependence() -> Outcome:
    ends = np.array([path_through(o).q[-1] for o in neighbour_sequences()])
    final = np.array([reach(o)[-1] for o in neighbour_sequences()])
    spread = np.degrees(np.ptp(ends, axis=0))
    return Outcome(
        judge(holds=bool(spread.min() > 90 and np.ptp(final) / final.max() > 0.2)),
        f"At scale {SCALE:g}, over the {len(final)} sequences of neighbours, the final joint values"
        " spread over"
        f" {spread[0]:.2f}° and {spread[1]:.2f}° and the final reach from {final.min():.4f} to"
        f" {final.max():.4f} cm.",
    )


@computes("S-36.2")
@computes("S-55")
def causes_of_asymmetry() -> Outcome:
    exact = {s: asymmetry(symmetric(), s) for s in (1.0, SCALE, 0.8)}
    printed = {s: asymmetry(robot(), s) for s in exact}
    alone = {"nonlinearity": exact[1.0] > SMALL, "scaling": max(exact.values()) > SMALL}
    needed = printed[1.0] < SMALL < printed[SCALE]
    added = printed[SCALE] > printed[1.0]
    about_it = asymmetry_about_the_middle()
    text = "; ".join(f"{s:g}: {off:.3f}" for s, off in printed.items())
    return of_readings(
        "no mirror images, by either alone",
        {
            "no mirror images, by either alone": judge(
                holds=all(alone.values()), under=any(alone.values())
            ),
            "no mirror images, and without the scaling they would be": judge(holds=needed),
            "less of mirror images by the scaling": judge(holds=added),
            "less of mirror images about the centroid than about the centre of symmetry": judge(
                holds=False, under=printed[SCALE] > about_it + SMALL
            ),
        },
        "The symmetric arm is scaled and as nonlinear, and its two paths are"
        f" {'no ' if any(alone.values()) else ''}mirror images. The printed arm's paths are no"
        f" mirror images without scaling either, and {'more' if added else 'less'} apart with it"
        f" (cm, by scale: {text}). About the pose that is its own mirror image they would be"
        f" {about_it:.3f} cm apart at scale {SCALE:g}, so the centre adds"
        f" {100 * (printed[SCALE] / about_it - 1):.0f} %. That they are not mirror images comes"
        " from the digits, or from the two sequences chosen; neither scaling nor nonlinearity"
        " causes it. What the nonlinearity does break, point reflections, is in F-10.3.",
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
