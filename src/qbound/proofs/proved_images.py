"""Areas in the plane of the tool, as balls: the image of each aspect of a region of two joints.

det J depends on the second joint alone, so it is a boundary like any other: the region of one sign
is proved with it as one more form, and its image has the area of the integral of abs(det J), which
Green's theorem turns into one of q1 det J dq2 along the proved arcs. Not in the paper, which
samples.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from qbound.boundary.functions import position
from qbound.forms.harmonic import HarmonicForm, Kind
from qbound.model.robot import Robot
from qbound.proofs.balls import ball, derivative, precision, values
from qbound.proofs.exact import BITS, ExactProblem
from qbound.proofs.proved_region import BITS as AREA_BITS
from qbound.proofs.proved_region import ProvedComponent, prove_region
from qbound.proofs.runs import area_under
from qbound.region import Problem, solve

if TYPE_CHECKING:
    from flint import arb

Array = NDArray[Any]

SINGULAR = "det J"
"""Name of the singular curve among the boundaries of an aspect."""


@dataclass(frozen=True, eq=False)
class ProvedImage:
    """A part of a region on which det J keeps its sign, and what the tool sweeps over it.

    Attributes
    ----------
    part : ProvedComponent
    side : int
        Sign of det J.
    swept : arb
        Integral of abs(det J), length squared: the area of the image, a place that is reached on
        two full turns of a joint counted twice.
    """

    part: ProvedComponent
    side: int
    swept: arb


def jacobian_determinant(exact: Robot) -> HarmonicForm:
    """Return det J of the tool in the plane of x and z, in exact numbers: a form of two joints.

    Parameters
    ----------
    exact : Robot
        From `exact_robot`, of two joints.

    Raises
    ------
    ValueError
        If the tool leaves the plane of x and z, or det J depends on the first joint.
    """
    with precision(BITS):
        tool = position(exact, exact.tool)
        if any(not ball(c).contains(0) for c in derivative(tool[1], 0).coefficients.ravel()) or any(
            not ball(c).contains(0) for c in derivative(tool[1], 1).coefficients.ravel()
        ):
            raise ValueError(f"{exact.name}: the tool leaves the plane of x and z")
        one, other = (derivative(tool, j) for j in (0, 1))
        low, middle, high = (_determinant(one, other, (0, k)) for k in (0, 1, 2))
        table = np.zeros((3, 3), dtype=object)
        mean, half = (low + high) / 2, (low - high) / 2
        revolute = exact.kinds[1] == "revolute"  # places 0, pi / 2, pi; else 0, 1, 2
        curve = high - 2 * middle + low
        table[0] = (
            [mean, half, middle - mean] if revolute else [low, middle - low - curve / 2, curve / 2]
        )
        form = HarmonicForm(table, exact.kinds)
        for place in product(range(5), repeat=2):
            q = [ball(p) * 6 / 5 for p in place]
            if not (_at(one, other, q) - values(form, q)[()]).contains(0):
                raise ValueError(f"{exact.name}: det J depends on the first joint")
    return form


def proved_images(
    exact: ExactProblem, problem: Problem, home: ArrayLike, determinant: HarmonicForm
) -> list[ProvedImage]:
    """Prove the parts of a region on which det J has one sign, and enclose what each sweeps.

    Parameters
    ----------
    exact, problem : ExactProblem and Problem
        The same region, in exact numbers and in floats.
    home : array_like, shape (2,)
    determinant : HarmonicForm
        From `jacobian_determinant`.

    Raises
    ------
    Unproved
        As `prove_region`.
    ValueError
        If a part goes round the first joint.
    """
    found = []
    for side in (1, -1):
        one, other = _with(exact, determinant, side), _with_floats(problem, determinant, side)
        for part in prove_region(one, solve(other, home)).components:
            with precision(AREA_BITS):
                found.append(ProvedImage(part, side, _swept(one, part)))
    return found


def _swept(problem: ExactProblem, part: ProvedComponent) -> arb:
    total = ball(0)
    for loop in part.loops:
        (p1, p2), (q1, q2) = loop[0].start, loop[-1].end
        if not ((q1 - p1).contains(0) and (q2 - p2).contains(0)):
            raise ValueError("a part of the region goes round a joint: its image is not proved")
        weight = [ball(c) for c in problem.forms.coefficients[-1, 0]]
        total += sum((area_under(problem, run, weight) for run in loop), start=ball(0))
    return total


def _with(problem: ExactProblem, determinant: HarmonicForm, side: int) -> ExactProblem:
    table = np.concatenate([problem.forms.coefficients, side * determinant.coefficients[None]])
    forms = HarmonicForm(table, problem.kinds)
    return replace(problem, forms=forms, names=(*problem.names, SINGULAR))


def _with_floats(problem: Problem, determinant: HarmonicForm, side: int) -> Problem:
    row = np.vectorize(lambda c: float(ball(c)), otypes=[float])(side * determinant.coefficients)
    return problem.with_form(SINGULAR, row)


def _determinant(one: HarmonicForm, other: HarmonicForm, place: tuple[int, int]) -> Any:
    """Return det J where the joints are at 0, 1 or 2 quarter turns, or units: exactly."""
    factors = [np.array(_factor(k, p), dtype=object) for k, p in zip(one.kinds, place, strict=True)]
    (x1, _, z1), (x2, _, z2) = ((f.coefficients @ factors[1]) @ factors[0] for f in (one, other))
    return x1 * z2 - z1 * x2


def _factor(kind: Kind, place: int) -> tuple[int, int, int]:
    if kind == "revolute":
        return ((1, 1, 0), (1, 0, 1), (1, -1, 0))[place]
    return 1, place, place**2


def _at(one: HarmonicForm, other: HarmonicForm, q: list[arb]) -> arb:
    (x1, _, z1), (x2, _, z2) = values(one, q), values(other, q)
    determinant: arb = x1 * z2 - z1 * x2
    return determinant
