"""Least distance of two bodies while the joints stay in a polygon, by halving simplices.

A signed distance is the maximum over features: for an edge the least height of the other core's
corners, for two corners that are the nearest places their distance. Bounds of the forms bound each
of these from below over a simplex. So no simplex that contains the least value is left out.
"""

from __future__ import annotations

import numpy as np

from qbound.arrays import Floats
from qbound.boundary.body_contacts import body_contacts
from qbound.boundary.contacts import Contacts
from qbound.boundary.parts import bounded_bodies
from qbound.boundary.separation import Separation, largest_speeds
from qbound.forms.bending import second_order
from qbound.forms.harmonic import HarmonicForm
from qbound.geometry.simplices import edges, halved
from qbound.measures.conditions import conditions
from qbound.model.robot import BodyPair, Boundary, Robot

MOST_CELLS = 200_000
"""Simplices looked at before what is left is said to be undecided."""


def least_margin_over(
    robot: Robot, boundary: Boundary, cells: Floats, tolerance: float = 1e-6
) -> tuple[float, Floats]:
    """Return the least margin of a boundary about bodies over simplices, and where.

    Parameters
    ----------
    cells : ndarray, shape (N, k, 2)
        Corners, rad or length.
    tolerance : float
        Beside the largest length that the margin is made of: no margin is lower by more. Where two
        features decide, bounds are of first order, and less would cost too many simplices.

    Raises
    ------
    ArithmeticError
        If that takes more simplices than there may be.
    """
    exact, speeds = Separation(robot, None, [boundary]), largest_speeds(robot, boundary)
    size = float(speeds @ np.abs(cells).reshape(-1, 2).max(axis=0)) + float(speeds.max())
    bound = _Bound(robot, boundary, size)
    slack, best, where, looked = tolerance * size, np.inf, cells[0, 0], 0
    while len(cells):
        looked += len(cells)
        if looked > MOST_CELLS:
            raise ArithmeticError(f"{boundary.name}: {MOST_CELLS} simplices do not settle it")
        centres = cells.mean(axis=1)
        values = exact.margins(centres)[:, 0]
        corners = exact.margins(cells)[..., 0]
        for value, place in ((values, centres), (corners, cells)):
            at = np.unravel_index(value.argmin(), value.shape)
            if value[at] < best:
                best, where = float(value[at]), place[at]
        # First by speeds, then by what costs more.
        reach = np.abs((cells - centres[:, None]) @ np.diag(speeds)).sum(axis=2).max(axis=1)
        cells = cells[values - reach < best - slack]
        cells = cells[bound(cells) < best - slack]
        steps = np.abs(edges(cells)) @ speeds
        cells = halved(cells, steps.argmax(axis=1))
    return best, np.asarray(where)


class _Bound:
    """The lower bound over simplices.

    More is asked than the boundary does: with a distance to keep corners are features, too.
    """

    def __init__(self, robot: Robot, boundary: Boundary, more: float) -> None:
        asked = boundary.with_extra_clearance(more)
        contacts = body_contacts(robot, {}, [asked])
        self.more = more
        self.conditions = conditions(HarmonicForm(np.zeros((0, 3, 3)), robot.kinds), contacts)
        self.clauses = self.conditions.clauses
        self.squared = _squared(robot, asked, contacts, self.conditions.forms)
        of_corners = np.maximum.reduceat(self.squared, self.clauses) > 0
        sizes = np.diff(np.append(self.clauses, len(self.squared)))
        self.sides = np.repeat(of_corners, sizes) & (self.squared == 0)

    def __call__(self, cells: Floats) -> Floats:
        if not len(cells):
            return np.zeros(0)
        low, kept, starts = second_order(self.conditions.forms, cells), self.squared, self.clauses
        lengths = np.where(kept > 0, np.sqrt(np.maximum(low + kept**2, 0)) - kept, low)
        # Two corners that are not everywhere the nearest places say nothing.
        held = np.minimum.reduceat(np.where(self.sides, low, np.inf), starts, axis=1) >= 0
        least = np.minimum.reduceat(np.where(self.sides, np.inf, lengths), starts, axis=1)
        least = np.where(held, least, -np.inf)
        pairs = np.maximum.reduceat(least, self.conditions.starts, axis=1)
        return np.asarray(pairs.min(axis=1) + self.more)


def _squared(robot: Robot, asked: Boundary, contacts: Contacts, rows: HarmonicForm) -> Floats:
    """Return for each row the length whose square was taken from a square, 0 where it is none."""
    kept = np.zeros(len(rows.coefficients))
    if isinstance(asked, BodyPair):
        radii = [body.parts[0].radius for body in bounded_bodies(robot, asked)]
        # Rows are the features, each two corners followed by its side conditions.
        forms = {form.tobytes() for form in contacts.forms[contacts.corners]}
        squares = [row.tobytes() in forms for row in rows.coefficients]
        kept[squares] = sum(radii) + asked.clearance
    return kept
