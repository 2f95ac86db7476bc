"""The exact region scaled about a point, whether it is star-shaped, and polygons inside it.

A region that is star-shaped about its centroid contains every copy of itself that is scaled down
about it. Then the largest feasible scale is 1, and smaller scales leave more clearance.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cspace.arrays import Floats
from cspace.geometry.arcs import last_before
from cspace.geometry.polygon import tangent_corners
from cspace.measures.scaling import conditions, first_exit, violation
from cspace.order import ordered_by
from cspace.region import Component, Problem
from cspace.region.arcs import Arc
from cspace.tolerances import ON_BOUNDARY, PROVED_SCALE, SAME_PLACE
from qbound.forms import HarmonicForm

PLACES, ROUNDS = 129, 12

BESIDE = 1e-5
"""A part of an arc so short, in its parameter, is none."""


@dataclass(frozen=True, eq=False)
class ExactScale:
    """The largest feasible scale of a component itself, arcs and all.

    Attributes
    ----------
    scale : float
        1 where the component is star-shaped about the centre.
    q : ndarray, shape (2,)
        Where the scaled component touches first; at scale 1 a point of its own boundary.
    arc : Arc or None
        The arc whose scaled copy touches there; None at scale 1.
    boundary : str
        The boundary that it touches; empty at scale 1, where it touches every boundary.
    hidden : tuple of Arc
        The arcs with a part that cannot be seen from the centre; empty if star-shaped.
    """

    scale: float
    q: Floats
    arc: Arc | None
    boundary: str
    hidden: tuple[Arc, ...]

    @property
    def star_shaped(self) -> bool:
        """Whether every point of the component is seen from the centre."""
        return not self.hidden


def exact_scale(problem: Problem, component: Component, centre: ArrayLike) -> ExactScale:
    """Return the largest scale up to which a component, scaled about a point, stays in itself.

    Computed on exact arcs but not proved: see the notes.

    Parameters
    ----------
    centre : array_like, shape (2,)
        A point of the component; rad or length.

    Raises
    ------
    ValueError
        If the component goes round a joint, or the centre violates a boundary.

    Notes
    -----
    Rays go from the centre to `PLACES` points on each piece of an arc. Each ray is followed without
    jumping over a root, and the worst one is refined. A part of an arc between two of these points
    may turn away from the centre unseen, so the result is a computation and not a proof.
    """
    g = np.asarray(centre, dtype=float)
    if any(component.wraps):
        raise ValueError("a component that goes round a joint has no centre to scale it about")
    asked = conditions(problem.forms, problem.contacts)
    if not (asked.together(asked.forms(g)) > 0).all():
        raise ValueError("a boundary is violated at the centre already")
    arcs = [arc for loop in component.loops for arc in loop]
    found = [_least(problem, arc, g) for arc in arcs]
    hidden = tuple(
        arc for arc, (scale, _, _) in zip(arcs, found, strict=True) if scale < 1 - PROVED_SCALE
    )
    best = ordered_by(range(len(found)), [lambda k: (found[k][0], PROVED_SCALE * found[k][0])])[0]
    scale, s, form = found[best]
    q = arcs[best].at([s])[0]
    if not hidden:
        return ExactScale(1.0, q, None, "", ())
    names = (*problem.names, *problem.contacts.boundaries)
    return ExactScale(scale, g + scale * (q - g), arcs[best], names[form], hidden)


def _least(problem: Problem, arc: Arc, g: Floats) -> tuple[float, float, int]:
    """Least scale at which a ray to the arc is stopped, the arc's parameter there, and the form."""
    low, high = 0.0, 1.0
    n = (PLACES - 1) * len(arc.pieces) + 1
    for _ in range(ROUNDS):
        s = np.linspace(low, high, n)
        scales, stopped = first_exit(problem.forms, g, arc.at(s) - g, contacts=problem.contacts)
        i = int(scales.argmin())
        low, high, n = s[max(i - 1, 0)], s[min(i + 1, len(s) - 1)], 17
        if scales[i] >= 1 - PROVED_SCALE or high - low < 1e-12:
            break
    return float(scales[i]), float(s[i]), int(stopped[i])


# --- polygons inside ------------------------------------------------------------------------------


def inner_polygon(problem: Problem, component: Component, n: int) -> list[Floats]:
    """Return polygons that stay inside a component: the first remedy (Section 4), corrected.

    Where an arc bends into the region, its tangents are inside, and neighbouring tangents are
    intersected. Where an arc bends outwards, its chords are inside. Inflections separate the two
    cases.

    Parameters
    ----------
    n : int
        Number of points on each part of an arc, both ends included; at least 2. Parts end where the
        arc turns back along a joint, and at inflections: they are the same over either joint, in
        any unit, and mirrored.

    Returns
    -------
    list of ndarray, shape (m, 2)
        One polygon a loop, anticlockwise; a hole is clockwise. Joint values.

    Raises
    ------
    ValueError
        If the component goes round a joint, `n` is below 2, or an edge leaves the component because
        there are too few tangents. Every edge is checked along its whole length.
    """
    if any(component.wraps):
        raise ValueError("a component that goes round a joint has no polygon")
    if n < 2:
        raise ValueError(f"a piece has at least its 2 ends, found {n}")
    rings = [
        np.concatenate([corners for arc in loop for corners in _corners(arc, n)])
        for loop in component.loops
    ]
    if not all(_within(problem, ring) for ring in rings):
        raise ValueError(f"{n} points a piece are too few for a polygon inside: take more")
    return rings


def _within(problem: Problem, ring: Floats) -> bool:
    """Show that no edge of a polygon leaves the forms' closed region or the ranges."""
    for limits, values in zip(problem.ranges, ring.T, strict=True):
        if limits is not None and not (
            limits[0] - SAME_PLACE <= values.min() and values.max() <= limits[1] + SAME_PLACE
        ):
            return False
    found = conditions(problem.forms, problem.contacts)
    coefficients = found.forms.coefficients
    slack = ON_BOUNDARY * np.abs(coefficients).max(axis=(1, 2), initial=0.0)
    lifted = replace(found, forms=found.forms + slack)
    return violation(lifted, np.stack([ring, np.roll(ring, -1, axis=0)], axis=1)) is None


def _corners(arc: Arc, n: int) -> Iterator[Floats]:
    """Yield the start of an arc, then the corners of its tangents or its points."""
    form = arc.form
    if form is None:
        yield arc.points[:1]
        return
    for low, high in pairwise(_marks(form, arc)):
        q = arc.at(_spread(arc, low, high, n))
        yield q[:1]
        inside = _bends_in(form, arc.at([(low + high) / 2]))[0]
        yield tangent_corners(q, form.gradient(q)) if inside else q[1:-1]


def _spread(arc: Arc, low: float, high: float, n: int) -> Floats:
    """Return n parameters of a part of an arc, both ends included.

    Along the first joint they are middle + half sin(angle), of equal angles: densest at folds.
    """
    start, end = arc.at([low, high])[:, 0]
    part = (1 + np.sin(np.linspace(-math.pi / 2, math.pi / 2, n)[1:-1])) / 2
    if abs(end - start) <= SAME_PLACE:  # along a fibre
        return np.concatenate([[low], low + (high - low) * part, [high]])
    wanted, way = start + (end - start) * part, np.sign(end - start)
    inner, _ = last_before(
        lambda s: (arc.at(s)[:, 0] - wanted) * way <= 0,
        np.full(n - 2, low),
        np.full(n - 2, high),
    )
    return np.concatenate([[low], inner, [high]])


def _bends_in(form: HarmonicForm, q: Floats) -> NDArray[np.bool_]:
    """Tell where the tangent of a level curve stays on the side on which the form is larger.

    There the form's second derivative along the curve is positive.
    """
    slope = form.gradient(q)
    tangent = np.stack([-slope[..., 1], slope[..., 0]], axis=-1)
    tangent /= np.maximum(np.linalg.norm(tangent, axis=-1, keepdims=True), 1e-300)
    hessian = form.hessian(q)
    return np.asarray(np.einsum("...i,...ij,...j", tangent, hessian, tangent) > 0)


def _marks(form: HarmonicForm, arc: Arc) -> Floats:
    """Parameters at which an arc bends to the other side, or turns back along a joint; 0 and 1."""
    s = np.linspace(0, 1, (PLACES - 1) * len(arc.pieces) + 1)
    moves = np.ptp(arc.at(s), axis=0) > SAME_PLACE
    tells: list[Callable[[HarmonicForm, Floats], NDArray[np.bool_]]] = [_bends_in]
    tells += [partial(_grows, joint=j) for j in (0, 1) if moves[1 - j]]
    found = []
    for told in tells:
        sides = told(form, arc.at(s))
        changes = np.flatnonzero(sides[1:] != sides[:-1])
        own = sides[changes]
        as_before = lambda x, told=told, own=own: told(form, arc.at(x)) == own  # noqa: E731
        found.append(last_before(as_before, s[changes], s[changes + 1])[0])
    inner = np.unique(np.concatenate(found))
    # Beside an end at which an arc turns back, the slope is rounding.
    return np.concatenate([[0.0], inner[(inner > BESIDE) & (inner < 1 - BESIDE)], [1.0]])


def _grows(form: HarmonicForm, q: Floats, joint: int) -> NDArray[np.bool_]:
    """Tell where a form grows with a joint; where that changes, an arc turns along the other."""
    return np.asarray(form.gradient(q)[..., joint] > 0)
