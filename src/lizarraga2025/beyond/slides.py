"""Sentences on arms that slide and on more dimensions, at the end of Section 4."""

from dataclasses import replace
from functools import cache

import numpy as np
import sympy as sp

from cspace.forms.harmonic import restrict
from cspace.geometry.isosurface import marching_cubes
from cspace.model.robot import HalfSpace, Pair, Prismatic, Robot
from cspace.region import clearance_problem, solve
from lizarraga2025.beyond.evidence import robot
from lizarraga2025.computations.registry import computes
from lizarraga2025.evidence.arms import every_component, pairs
from lizarraga2025.evidence.rounding import SMALL
from lizarraga2025.verdicts import Outcome, judge, of_readings, reading
from qbound import HarmonicForm, clearance, closest_approach, components, position
from qbound.symbols import joint_symbols, with_symbols


@cache
def sliding() -> Robot:
    """Return the paper's arm with a third joint that slides the tool out along link 2."""
    along = np.array([1.0, 0, 0])
    slide = Prismatic("q3", "2", "slide", np.zeros(3), along, limits=(-10.0, 10.0))
    points = tuple(replace(p, frame="slide") if p.name == "3" else p for p in robot().points)
    return replace(
        robot(),
        joints=(*robot().joints, slide),
        points=points,
        boundaries=(*robot().boundaries, Pair("B8", ("6", "3"), 5.0)),
        home=np.zeros(3),
    )


@cache
def of_slides() -> Robot:
    """Return the arm with two slides, along x and z, in place of its joints: a linear map."""
    joints = tuple(
        joint.as_type(Prismatic, axis=axis, limits=(-9.0, 9.0))
        for joint, axis in zip(robot().joints, np.eye(3)[[0, 2]], strict=True)
    )
    return replace(robot(), joints=joints)


def _height() -> HarmonicForm:
    """Return the height of the tool above its limit in the arm with a slide, cm (B7)."""
    return clearance(sliding(), sliding().boundary("B7"))


@computes("S-43")
def slides_enter_linearly() -> Outcome:
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
    of = [b for b in sliding().boundaries if isinstance(b, Pair | HalfSpace)]
    forms = [components(sliding(), boundary) for boundary in of]
    shapes = {form.stack for form in forms}
    depend = sum(2 in form.joints() for form in forms)
    return Outcome(judge(holds=shapes == {(3,)} and depend > 0))


@computes("S-45")
def affine_constraints() -> Outcome:
    arm = with_symbols(sliding())
    q = joint_symbols(arm)
    height = clearance(arm, arm.boundary("B7")).symbolic(q)
    pair = sp.expand(clearance(arm, arm.boundary("B8")).symbolic(q))
    along = sp.simplify(sp.diff(height, q[2], 2)) == 0
    mixed = sp.simplify(sp.diff(height, q[0], q[2]))
    square = sp.simplify(sp.diff(pair, q[2], 2) / 2)
    flat = clearance(of_slides(), of_slides().boundary("B7")).coefficients
    jointly = not flat[1:, 1:].any() and not flat[2].any() and not flat[:, 2].any()
    return of_readings(
        "With slides alone a component is affine in all of them together; after a turning joint it"
        " is affine along the slide. The square of a distance between points with a slide between"
        f" them is quadratic in the slide, with leading coefficient {square}.",
        reading("the components β of an arm of slides", holds=jointly),
        reading(
            "the components β of an arm that turns and slides", holds=bool(mixed == 0), under=along
        ),
        reading("the distances of eq. (11)", holds=bool(square == 0)),
    )


@cache
def surface(n: int) -> tuple[np.ndarray, np.ndarray]:
    """Return vertices (rad, rad, cm) and triangles of B7 = 0 on an n by n by n grid."""
    low, high = np.array([-np.pi, -np.pi, -10.0]), np.array([np.pi, np.pi, 10.0])
    axes = [np.linspace(a, b, n) for a, b in zip(low, high, strict=True)]
    q = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    values = _height()(q)
    if values.min() > 0 or values.max() < 0:
        return np.empty((0, 3)), np.empty((0, 3), int)
    points, triangles = marching_cubes(values)
    return low + points * (high - low) / (n - 1), triangles


@computes("S-46")
def hypersurfaces() -> Outcome:
    places = surface(41)[0]
    height = _height()
    steep = np.linalg.norm(height.gradient(places), axis=-1).min(initial=np.inf)
    both = closest_approach(robot(), pairs()[0]).gap
    forms = every_component()
    everywhere = sum(not form.coefficients.any() for form in forms)
    is_surface = len(places) > 0 and bool(steep > 0.5)
    return of_readings(
        f"The gradient of B7 vanishes at none of {len(places)} places of its zero set in the arm"
        f" with a slide. {everywhere} of the {len(forms)} components of the paper's arm are zero"
        " everywhere and bound nothing. The vector of a point pair is zero where all its components"
        " are, which is a smaller set, and empty with the printed digits.",
        reading("each component by itself", holds=is_surface and not everywhere, under=is_surface),
        reading("the components of a pair together", holds=both < SMALL),
    )


@computes("S-47")
def isosurfaces() -> Outcome:
    height = _height()
    off = {n: float(np.abs(height(surface(n)[0])).max(initial=0.0)) for n in (21, 41, 81)}
    second_order = off[81] > 0 and off[41] / off[81] > 2**1.5
    return Outcome(
        judge(holds=second_order),
        f"The vertices that marching cubes find miss B7 = 0 by at most {off[21]:.3f}, {off[41]:.3f}"
        f" and {off[81]:.3f} cm on grids of 21, 41 and 81 points a joint.",
    )


@computes("S-48")
def slices_are_enough() -> Outcome:
    held = {2: 4.0}
    whole = solve(clearance_problem(sliding(), held), [0.0, 0.0])
    q = np.random.default_rng(8).uniform(-np.pi, np.pi, (200_000, 2))
    three = np.insert(q, 2, held[2], axis=1)
    forms = [clearance(sliding(), pair) for pair in sliding().used_pairs]
    forms += [clearance(sliding(), half) for half in sliding().used_half_spaces]
    part = float(np.all([form(three) > 0 for form in forms], axis=0).mean())
    exact = whole.area / (2 * np.pi) ** 2
    error = np.sqrt(part * (1 - part) / len(q))
    return Outcome(
        judge(holds=bool(abs(part - exact) < 3 * error)),
        "With the slide held at 4 cm the slice is a region of two joints, found exactly and without"
        f" a sample: {len(whole.components)} pieces of {whole.area:.6f} rad² together, which is"
        f" {100 * exact:.4f} % of the square. Of {len(q)} random configurations {100 * part:.1f} %"
        " are free.",
    )


@computes("S-49.1")
def slices_grow_with_the_joints() -> Outcome:
    one = slices_are_enough().most_favourable
    numbers = "; ".join(f"{n + 2} joints: {20**n}" for n in (1, 2, 4))
    return Outcome(
        judge(holds=False, under=one == "confirmed"),
        "Each slice is found as a region of two joints, however many the arm has (S-48). Their"
        f" number grows exponentially with the joints held, with 20 values each: {numbers}.",
    )


@computes("S-49")
def slices_stay_symbolic() -> Outcome:
    form, q = _height(), joint_symbols(sliding())
    held = restrict(form, {2: 4.0}).symbolic(q[:2])
    difference = sp.expand(form.symbolic(q).subs(q[2], sp.Float(4.0)) - held)
    left = max((abs(float(c)) for c in difference.as_coefficients_dict().values()), default=0.0)
    return Outcome(
        judge(holds=left < SMALL),
        "The form with the slide held is a form of two joints in closed form, equal to the whole"
        " with the value put in.",
    )
